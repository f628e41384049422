"""One job in three languages, worked out by hand from the manuals: the same, and what is not."""

from __future__ import annotations

from pathlib import Path

import pytest
from verify.translation.support import Shop

from gproof.ir.program import SpindleOutputs
from gproof.ir.translation_terms import SymbolMeaning, TranslationTerms
from gproof.ir.verdict import Verdict

EDING = """\
G21 G90 G17
M3 S8000
G4 P2
G0 Z5
M54 P1
G0 X10
G0 Y10
G1 Z-1 F100
G2 X20 Y20 I10 J0 F200
G1 X40 F100
G4 P0.5
M55 P1
G0 Z5
M5
M56 P3
IF [#5399 == 1] THEN
G0 X0
ENDIF
M0
G0 Y0
M30
"""
# G4 X: seconds; M11, M12: outputs; M17.1 skips the next line where the input is off; an F of arcs is theirs alone.
WINCNC = """\
G90
S8000
M11C2
G4X2
G0 Z5
M11C1
G0 X10
G0 Y10
G1 Z-1 F100
G2 X20 Y20 I10 J0 F200
G1 X40 F100
G4X0.5
M12C1
G0 Z5
M12C2
M17.1C3
G0 X0
G4
G0 Y0
"""
MCUWIN = """\
%1
G90 G71
S8000 M03
G04 2
F100
G00 Z5
M26 101
G04 0
G00 X10
G00 Y10
G01 Z-1
G02 X20 Y20 I10 J0 F200
G01 X40 F100
G04 0.5
M27 101
G00 Z5
M05
$if (X.digib.3) then begin
G00 X0
$end;
M00
G00 Y0
M30
"""
DIN = """
[din]
position_unit = "mm"
time_unit = "min"
absolute_centers = false
line_numbers = false
interpolation_axes = "XYZ"
pre_include = ""
post_include = ""
[din.task0]
M0 = "stop"
M3 = "spindle_cw"
M4 = "spindle_ccw"
M5 = "spindle_off"
M30 = "end"
S = "spindle_speed"
"""
AXES = "xyza"


def one_zero(*more: str) -> tuple[SymbolMeaning, ...]:
    """The one zero of a controller is what Eding adds of coordinate system and G92, and of the tool where it is so."""
    return tuple(
        SymbolMeaning(
            symbol=f"g92.{axis}",
            form=tuple(sorted([(f"g92.{axis}", 1), (f"work.0.{axis}", 1), *((s, 1) for s in more if s[-1] == axis)])),
        )
        for axis in AXES
    )


TO_WINCNC = TranslationTerms(
    source="Eding", target="WinCNC", target_symbols=one_zero(), target_outputs=SpindleOutputs(forward=(2,)),
    source_straight=True,
)  # fmt: skip
TO_MCUWIN = TranslationTerms(
    source="Eding", target="McuWIN", target_symbols=one_zero("tool.0.z"), outputs=((1, 101),), inputs=((3, 103),),
    source_straight=True, target_straight=False,
)  # fmt: skip


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Shop:
    return Shop(Path(tmp_path_factory.mktemp("shop")))


def test_eding_and_mcuwin(shop: Shop) -> None:
    answer = shop.compared(EDING, (MCUWIN, "mcuwin", DIN), TO_MCUWIN)
    assert answer.verdict is Verdict.SAFE, answer


def test_eding_and_wincnc(shop: Shop) -> None:
    answer = shop.compared(EDING, (WINCNC, "wincnc"), TO_WINCNC)
    assert answer.verdict is Verdict.SAFE, answer


@pytest.mark.parametrize(
    "pause, is_proven", [("", True), ("G4 P0.1\n", True), ("G4 P0.2\n", False), ("M54 P1\n", False)]
)
def test_a_loop_that_looks_all_the_time_is_a_wait(shop: Shop, pause: str, is_proven: bool) -> None:
    """One that looks rarely goes on late, and misses a pulse."""
    waits = "G22\nG90\nG1 X5 F9\nM17C3\nG1 X7\n"
    looks = f"G21 G90 G94\nG1 X5 F9\nM56 P3\nWHILE [#5399 == 0]\n{pause}M56 P3\nENDWHILE\nG1 X7\nM2\n"
    terms = TranslationTerms(source="WinCNC", target="Eding", source_symbols=one_zero(), target_straight=True)
    answer = shop.compared((waits, "wincnc"), looks, terms)
    assert (answer.verdict is Verdict.SAFE) == is_proven, answer


@pytest.mark.parametrize(
    "stop, is_proven", [("M0\nG1 X7\n", True), ("M1\nG1 X7\n", False), ("G1 X7\nM0\n", False), ("G1 X7\n", False)]
)
def test_a_message_that_waits_is_a_stop(shop: Shop, stop: str, is_proven: bool) -> None:
    """G5 of WinCNC shows a text until somebody answers it; M1 stops only where the switch is on (Eding CNC 3.5.1)."""
    waits = 'G22\nG90\nG1 X5 F9\nG5 M"oil the ways"\nG1 X7\n'
    terms = TranslationTerms(source="WinCNC", target="Eding", source_symbols=one_zero(), target_straight=True)
    answer = shop.compared((waits, "wincnc"), f"G21 G90 G94\nG1 X5 F9\n{stop}M2\n", terms)
    assert (answer.verdict is Verdict.SAFE) == is_proven, answer


BOTH_WAYS = SpindleOutputs(forward=(2,), backward=(1,), coolant=(3,))
TWO = SpindleOutputs(forward=(2, 5), coolant=(3,))


@pytest.mark.parametrize(
    "outputs, commands, other, is_proven",
    [
        # The other way is off already: both are off with the next one.
        (BOTH_WAYS, "M11C2\nG4\nM12C1\nM12C2\n", "M11C2\nG4\nM12C2\nM12C1\n", True),
        (BOTH_WAYS, "M11C2\nG4\nM12C1\n", "M11C2\nG4\n", False),
        (BOTH_WAYS, "M11C2\nG4\nM12C1\nM11C3\n", "M11C2\nG4\nM11C3\n", False),
        # One of two outputs of a spindle stays what it is, whatever is switched after it.
        (TWO, "M11C2\nM11C3\n", "M11C3\n", False),
    ],
)
def test_outputs_of_a_spindle_that_are_switched_one_by_one(
    shop: Shop, outputs: SpindleOutputs, commands: str, other: str, is_proven: bool
) -> None:
    head, rest = "G22\nG90\nS900\n", "G1 X5 F9\n"
    terms = TranslationTerms(source="WinCNC", target="WinCNC", source_outputs=outputs, target_outputs=outputs)
    answer = shop.compared((head + commands + rest, "wincnc"), (head + other + rest, "wincnc"), terms)
    assert (answer.verdict is Verdict.SAFE) == is_proven, answer


COOLANTS = SpindleOutputs(forward=(2,), mist=(4,), coolant=(3, 4))


@pytest.mark.parametrize(
    "commands, other, is_proven",
    [
        # M9 of a shop is both outputs off, whichever comes first.
        ("M11C3\nM11C4\nG1 X1 F9\nM12C3\nM12C4\n", "M11C3\nM11C4\nG1 X1 F9\nM12C4\nM12C3\n", True),
        ("M11C3\nM11C4\nG1 X1 F9\nM12C3\nM12C4\n", "M11C3\nM11C4\nG1 X1 F9\nM12C3\n", False),
        ("M11C3\nM11C4\nG1 X1 F9\nM12C3\nM12C4\n", "M11C3\nM11C4\nG1 X1 F9\nM12C4\n", False),
        ("M11C3\nM11C4\nG1 X1 F9\nM12C3\nM12C4\n", "M11C3\nM11C4\nG1 X1 F9\nM12C3\nM11C3\n", False),
        ("M11C3\nM11C4\nM12C3\nG1 X1 F9\nM12C4\n", "M11C3\nM11C4\nM12C3\nM12C4\nG1 X1 F9\n", False),
        ("M11C3\nM11C4\nM12C3\nG4 X1\nM12C4\n", "M11C3\nM11C4\nM12C3\nM12C4\nG4 X1\n", False),
        # After a stop, what a command does not name is as the operator has left it, on both machines.
        ("M11C3\nG4\nM11C4\n", "M11C3\nG4\nM11C4\n", True),
        ("M11C3\nG4\nM11C4\n", "M11C3\nG4\nM12C3\nM11C4\n", False),
        ("M11C3\nG4\nM11C4\n", "M11C3\nG4\nM11C3\n", False),
        ("M11C3\nG4\nM11C4\n", "M11C3\nG4\n", False),
        ("M11C2\nG4\nS800\n", "M11C2\nG4\n", False),
        ("M11C2\nG4\nS800\nM11C2\n", "M11C2\nG4\nS800\nM12C2\n", False),
    ],
)
def test_outputs_of_coolants_and_stops(shop: Shop, commands: str, other: str, is_proven: bool) -> None:
    head, rest = "G22\nG90\nS900\n", "G1 X5 F9\n"
    terms = TranslationTerms(source="WinCNC", target="WinCNC", source_outputs=COOLANTS, target_outputs=COOLANTS)
    answer = shop.compared((head + commands + rest, "wincnc"), (head + other + rest, "wincnc"), terms)
    assert (answer.verdict is Verdict.SAFE) == is_proven, answer


@pytest.mark.parametrize(
    "commands, other, is_proven",
    [
        ("S6000 M03\n", "S6000 M03\n", True),
        ("S6000 M03\n", "S6000 M04\n", False),
        ("S6000 M03\n", "S6000 M05\n", False),
        ("S6000 M03\n", "S6000\n", False),
        ("S6000 M03\n", "S6000\nG01 X1\nM03\n", False),
        ("S6000 M03\n", "S6000 M04\nS6000 M03\n", False),
    ],
)
def test_a_speed_after_a_stop_is_part_of_the_command_of_its_line(
    shop: Shop, commands: str, other: str, is_proven: bool
) -> None:
    """S before M03 in one line (McuWIN 5.4), while M04 may be on: one that turns the spindle so is not left out."""
    one, two = (f"%1\nG90 G71\nS900\nM04\nF100\nM00\n{words}G01 X2\nM30\n" for words in (commands, other))
    terms = TranslationTerms(source="McuWIN", target="McuWIN")
    answer = shop.compared((one, "mcuwin", DIN), (two, "mcuwin", DIN), terms)
    assert (answer.verdict is Verdict.SAFE) == is_proven, answer
