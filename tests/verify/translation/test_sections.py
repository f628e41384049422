"""Waits, questions and loops: both graphs are walked together."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from verify.translation.support import STRAIGHT, Shop

from gproof.ir.translation_terms import SymbolMeaning
from gproof.ir.verdict import Verdict

SAFE, UNSAFE, UNKNOWN = Verdict.SAFE, Verdict.UNSAFE, Verdict.UNKNOWN


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Shop:
    return Shop(Path(tmp_path_factory.mktemp("shop")))


STOPS = """\
G21 G90
G0 Z5
M0
G0 X10
M6 T2
G43
G0 X20
M56 P3 L1 Q5
G38.2 Z-10 F100
G92 Z0
G0 Z30
M30
"""
CHOICE = """\
G21 G90
G0 Z5
M56 P3
IF [#5399 == 1] THEN
G0 X10
ELSE
G0 X20
ENDIF
G0 Y5
M30
"""
TURNED = CHOICE.replace("== 1", "== 0").replace("X10", "X_").replace("X20", "X10").replace("X_", "X20")
LOOP = """\
G21 G90
G0 Z5
M56 P3
WHILE [#5399 == 1]
G1 X10 F100
X0
M0
M56 P3
ENDWHILE
M30
"""
PARTS = """\
G21 G90
G0 Z5
#1=0
WHILE [#1 < 3]
G91 G1 X5 F100
G90
#1=[#1+1]
ENDWHILE
M30
"""
UNROLLED = "G21 G90\nG0 Z5\n" + "G91 G1 X5 F100\nG90\n" * 3 + "M30\n"

PAIRS = {
    "stops": (STOPS, STOPS, SAFE, ""),
    "a stop that is lost": (STOPS, STOPS.replace("M0\n", ""), UNSAFE, "event"),
    "a stop before a move": (STOPS, STOPS.replace("M0\nG0 X10\n", "G0 X10\nM0\n"), UNSAFE, "move added"),
    "an optional stop": (STOPS, STOPS.replace("M0\n", "M1\n"), UNSAFE, "stop"),
    "another tool": (STOPS, STOPS.replace("T2", "T3"), UNSAFE, "tool"),
    "no tool length": (STOPS, STOPS.replace("G43\n", ""), UNSAFE, "place"),
    "another input": (STOPS, STOPS.replace("P3", "P4"), UNSAFE, "input"),
    "the input off": (STOPS, STOPS.replace("L1", "L2"), UNSAFE, "input"),
    "the probe goes less far": (STOPS, STOPS.replace("Z-10", "Z-9"), UNSAFE, "place"),
    "another height after the probe": (STOPS, STOPS.replace("Z30", "Z31"), UNSAFE, "place"),
    "an offset is left": (STOPS, STOPS.replace("M30", "G92 X0\nM30"), UNSAFE, "offset left"),
    "a suspended offset is left": (STOPS, STOPS.replace("M30", "G92.1\nM30"), UNSAFE, "offset left"),
    "another coordinate system is left": (STOPS, STOPS.replace("M30", "G55\nM30"), UNSAFE, "end state"),
    "a mode is left": (STOPS, STOPS.replace("M30", "G20\nM30"), UNSAFE, "end state"),
    "M2 leaves what M30 ends": ("G91 G0 X5\nM2\n", "G91 G0 X5\nM30\n", UNSAFE, "end state"),
    "a table is written": (STOPS, STOPS.replace("M30", "G10 L2 P3 X1\nM30"), UNSAFE, "offset left"),
    "choice": (CHOICE, CHOICE, SAFE, ""),
    "choice the other way round": (CHOICE, TURNED, SAFE, ""),
    "the wrong branch": (CHOICE, TURNED.replace("== 0", "== 1"), UNSAFE, "place"),
    "another channel asked": (CHOICE, CHOICE.replace("P3", "P4"), UNKNOWN, "condition"),
    "an answer that nobody matches": (CHOICE.replace("#5399", "#100"), CHOICE.replace("#5399", "#101"), UNKNOWN,
                                      "condition"),
    "one branch is lost": (CHOICE, CHOICE.replace("G0 X20\n", ""), UNSAFE, "place"),
    "a choice that is none": (CHOICE, "G21 G90\nG0 Z5\nM56 P3\nG0 X10\nG0 Y5\nM30\n", UNKNOWN, "one question"),
    "loop": (LOOP, LOOP, SAFE, ""),
    "a loop with a stop less": (LOOP, LOOP.replace("M0\n", ""), UNKNOWN, "one question"),
    "a loop that ends otherwise": (LOOP, LOOP.replace("== 1", "== 0"), UNSAFE, ""),
    "a loop with another move": (LOOP, LOOP.replace("X0\n", "X1\n"), UNSAFE, "place"),
    "a loop and its passes": (PARTS, UNROLLED, SAFE, ""),
    "a pass less": (PARTS, PARTS.replace("< 3", "< 2"), UNSAFE, "move lost"),
    "a pass more": (PARTS, PARTS.replace("< 3", "<= 3"), UNSAFE, ""),
    "an end before the end": (PARTS, PARTS.replace("ENDWHILE", "M30\nENDWHILE"), UNSAFE, "move lost"),
}  # fmt: skip


@pytest.mark.parametrize("name", PAIRS)
def test_pair(shop: Shop, name: str) -> None:
    one, other, verdict, kind = PAIRS[name]
    answer = shop.compared(one, other)
    assert answer.verdict is verdict, answer
    kept = answer.unknown if verdict is UNKNOWN else answer.differences
    assert not kind or kept[0].kind == kind, answer
    if verdict is not SAFE:
        assert shop.compared(other, one).verdict is not SAFE


def test_refused_lines_are_unknown(shop: Shop) -> None:
    """Nobody knows where the axes are after a line that was not understood: equal texts are no proof."""
    job = "G21 G90\nG0 Z5\nG99.9 X3\nG0 X5\nM30\n"
    assert shop.compared(job, job).verdict is not SAFE


def test_rapids_of_several_axes(shop: Shop) -> None:
    job = "G21 G90\nG0 Z5\nG0 X10 Y10\nM30\n"
    bent = dataclasses.replace(STRAIGHT, target_straight=None)
    assert shop.compared(job, job, bent).verdict is UNKNOWN
    assert shop.compared(job, job, bent).unknown[0].kind == "rapid"
    assumed = shop.compared(job, job, dataclasses.replace(bent, rapids_assumed=True))
    assert assumed.verdict is SAFE
    assert any("rapid" in sentence for sentence in assumed.assumptions)
    # One axis after the other is no question of the path; a cut of it is, where the path is not straight.
    one = "G21 G90\nG0 Z5\nG0 X10\nG0 Y10\nM30\n"
    assert shop.compared(one, one, bent).verdict is SAFE
    cut = job.replace("G0 X10 Y10", "G0 X5 Y5\nG0 X10 Y10").replace("G0 Z5", "G0 X0 Y0 Z5")
    whole = job.replace("G0 Z5", "G0 X0 Y0 Z5")
    assert shop.compared(whole, cut).verdict is SAFE
    assert shop.compared(whole, cut, dataclasses.replace(bent, rapids_assumed=True)).verdict is UNSAFE


def test_a_straight_rapid_may_be_a_feed_move_as_fast_as_its_axes(shop: Shop) -> None:
    """X and Y go 6000 mm/min, Z 3000: a feed move of X and Y is from 3000 to 6000, one with Z is 3000."""
    modes, end = "G21 G90\nG1 X1 Y0 F100\nG0 Z5\n", "G1 Z-1 F100\nM30\n"
    rates = (("x", 6000.0), ("y", 6000.0), ("z", 3000.0))
    terms = dataclasses.replace(STRAIGHT, target_straight=None, rapid_rates=rates)
    rapid = f"{modes}G0 X10 Y10\n{end}"
    for feed, verdict in ((6000, SAFE), (3000, SAFE), (6100, UNSAFE), (2900, UNSAFE), (100, UNSAFE)):
        fed = f"{modes}G1 X10 Y10 F{feed}\n{end}"
        assert shop.compared(rapid, fed, terms).verdict is verdict, feed
    wrong = (
        f"{modes}G1 X10 Y10.1 F6000\n{end}", f"{modes}G1 X10 F6000\nY10\n{end}",
        f"{modes}G1 X10 Y10 F6000\nG1 Z-1\nM30\n",
    )  # fmt: skip
    assert all(shop.compared(rapid, fed, terms).verdict is UNSAFE for fed in wrong)
    # A move with feed is no rapid, and without a straight source nothing is known.
    fed = f"{modes}G1 X10 Y10 F6000\n{end}"
    assert shop.compared(fed, rapid, terms).verdict is UNSAFE
    for other in (dataclasses.replace(terms, source_straight=None), STRAIGHT):
        assert shop.compared(rapid, fed, other).verdict is UNSAFE
    deep = f"{modes}G0 X10 Y10 Z9\n{end}"
    assert shop.compared(deep, f"{modes}G1 X10 Y10 Z9 F6000\n{end}", terms).verdict is UNSAFE
    assert shop.compared(deep, f"{modes}G1 X10 Y10 Z9 F3000\n{end}", terms).verdict is SAFE
    assert shop.compared(rapid, f"{modes}G1 X5.5 Y5 F6000\nX10 Y10\n{end}", terms).verdict is SAFE
    # An axis whose velocity nobody says: how fast it may go is not known.
    assert shop.compared(rapid, fed, dataclasses.replace(terms, rapid_rates=rates[:1])).verdict is UNKNOWN


POLLED = "G21 G90\nG0 Z5\nM56 P3\nWHILE [#5399 == 0]\nG4 P0.1\nM56 P3\nENDWHILE\nG0 X10\nM30\n"


def test_a_loop_that_only_waits_is_a_wait(shop: Shop) -> None:
    """WinCNC waits without a time limit (M17: until on, M18: until off); a loop that asks again and again does, too."""
    zero = tuple(
        SymbolMeaning(symbol=f"g92.{axis}", form=((f"g92.{axis}", 1), (f"work.0.{axis}", 1))) for axis in "xyza"
    )
    terms = dataclasses.replace(STRAIGHT, source="Eding", target="WinCNC", target_symbols=zero)
    wait = "G90\nG0 Z5\nM17C3\nG0 X10\n"
    answer = shop.compared(POLLED, (wait, "wincnc"), terms)
    assert answer.verdict is SAFE, answer
    assert any("again and again" in sentence for sentence in answer.assumptions)
    for old, new in (("M17", "M18"), ("C3", "C4"), ("M17C3\n", ""), ("M17C3\nG0 X10\n", "G0 X10\nM17C3\n")):
        assert shop.compared(POLLED, (wait.replace(old, new), "wincnc"), terms).verdict is not SAFE
    # One that moves is none.
    moving = POLLED.replace("G4 P0.1\n", "G1 X1 F100\nX0\n")
    assert shop.compared(moving, (wait, "wincnc"), terms).verdict is not SAFE


def test_a_probe_in_a_loop_is_open(shop: Shop) -> None:
    """Sections that come again name what the first pass has found; nobody says whether the other side does so, too."""
    job = "G21 G90\nG0 Z5\nM56 P3\nWHILE [#5399 == 1]\nG38.2 Z-10 F50\nG0 Z5\nM0\nM56 P3\nENDWHILE\nM30\n"
    assert shop.compared(job, job).verdict is not UNSAFE


def test_the_controller_changes_the_tool_or_somebody(shop: Shop) -> None:
    job = "G21 G90\nG0 Z5\nM6 T2\nG0 X10\nM30\n"
    loose = dataclasses.replace(STRAIGHT, tool_change_waits=False)
    assert shop.compared(job, job, loose).verdict is SAFE
    assert shop.compared(job, job.replace("T2", "T3"), loose).verdict is UNSAFE


def test_a_stop_that_names_a_tool(shop: Shop) -> None:
    """WinCNC without an automatic changer: G4 waits, L110 sets the number (L Codes, L110)."""
    zero = tuple(
        SymbolMeaning(symbol=f"g92.{axis}", form=((f"g92.{axis}", 1), (f"work.0.{axis}", 1))) for axis in "xyza"
    )
    job = "G21 G90\nG0 Z5\nM6 T2\nG0 X10\nM6 T3\nG0 X20\nM30\n"
    stop = "G90\nG0 Z5\nG4 [insert tool 2]\nL110 T2\nG0 X10\nG4 [insert tool 3]\nL110 T3\nG0 X20\n"
    terms = dataclasses.replace(
        STRAIGHT, source="Eding", target="WinCNC", target_symbols=zero, tool_by_stop=True,
        left_out=frozenset({"length", "zero"}),
    )  # fmt: skip
    for target in (stop, stop.replace("L110 T2\n", "").replace("L110 T3\n", "")):
        answer = shop.compared(job, (target, "wincnc"), terms)
        assert answer.verdict is SAFE, answer
        for old, new in (("T2\n", "T3\n"), ("G4 [insert tool 2]\n", ""), ("[insert tool 3]\nG0", "\nG0")):
            if old in target:
                wrong = shop.compared(job, (target.replace(old, new), "wincnc"), terms)
                assert wrong.verdict is not SAFE, (old, wrong)
    assert shop.compared(job, (stop, "wincnc"), dataclasses.replace(terms, tool_by_stop=False)).verdict is not SAFE
