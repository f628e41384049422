"""M90 to M97 against the Eding CNC manual 2.1.19, 2.1.20, 3.5.2 and 3.5.6."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from passes.interpret.core.programs import HEAD, codes_of, run_whole, shown

from gproof.ir.machine import NO_MACHINE, Spindle
from gproof.ir.setup import NOTHING, ZERO, Interval
from gproof.ir.trace import Frame, Trace

HEADS = dataclasses.replace(
    NO_MACHINE,
    spindles=(
        Spindle(number=0),
        Spindle(number=1, offset=(50.0, -10.0, 5.0)),
        Spindle(number=2, offset=(0.0, 30.0, 0.0)),
        Spindle(number=5, offset=(-40.0, 0.0, 0.0)),
    ),
)


def frames(trace: Trace) -> list[Frame]:
    return [trace.frames[k] for section in trace.sections for k in section.rows["frame"].tolist()]


def test_positions_shift_by_the_offset_of_the_head(tmp_path: Path) -> None:
    text = HEAD + "G0 X1 Y2 Z3\nM91\nG0 X1\nY2 Z3\nM92\nX1 Y2 Z3\nM90\nX1 Y2 Z3\nM97\nX1\nM30\n"
    trace, findings = run_whole(tmp_path, text, machine=HEADS)
    assert codes_of(findings) == []
    assert [row for row in shown(trace) if row[0] == "go"] == [
        ("go", 1, 2, 3), ("go", 51, 2, 3), ("go", 51, -8, 8), ("go", 1, 32, 3), ("go", 1, 2, 3), ("go", -39, 2, 3),
    ]  # fmt: skip


def test_m93_is_the_second_alternate_head_of_table_3_6(tmp_path: Path) -> None:
    texts = [HEAD + f"{code}\nG0 X1 Y2 Z3\nM30\n" for code in ("M92", "M93")]
    one, other = (shown(run_whole(tmp_path, text, machine=HEADS)[0]) for text in texts)
    assert one == other


def test_g53_and_g28_know_no_head(tmp_path: Path) -> None:
    trace, _ = run_whole(tmp_path, HEAD + "M91\nG53 G0 X1 Y2 Z3\nM30\n", machine=HEADS)
    assert ("go", 1, 2, 3) in shown(trace)


@pytest.mark.parametrize("line", ["G92 X0 Y0 Z0", "G10 L20 P1 X0 Y0 Z0"])
def test_zeroing_under_a_head_is_undone_by_no_head(tmp_path: Path, line: str) -> None:
    """The point under the head gets the numbers; the first spindle then goes there by the same numbers."""
    trace, _ = run_whole(
        tmp_path, HEAD + f"M91\nG0 X7 Y8 Z9\n{line}\nG0 X0 Y0 Z0\nM90\nG0 X0 Y0 Z0\nM30\n", machine=HEADS
    )
    assert [row for row in shown(trace) if row[0] == "go"] == [("go", 57, -2, 14)] * 2 + [("go", 7, 8, 9)]


def test_an_offset_that_nobody_stated_is_a_condition(tmp_path: Path) -> None:
    setup = dataclasses.replace(ZERO, default_offset=None, name="start known", work=ZERO.work)
    trace, findings = run_whole(tmp_path, HEAD + "M91\nG53 G0 X0\nG0 X5\nM30\n", setup=setup)
    assert codes_of(findings) == []
    assert ("head.1.x", 1) in frames(trace)[-1][0]


def test_an_offset_without_its_sign_is_not_stated(tmp_path: Path) -> None:
    spindle = Spindle(number=1, offset=(12.0, 0.0, 0.0), unsigned=True)
    machine = dataclasses.replace(NO_MACHINE, spindles=(spindle,))
    trace, findings = run_whole(tmp_path, HEAD + "M91\nG0 X5 Y5\nM30\n", machine=machine)
    assert codes_of(findings) == ["GP273"]
    assert frames(trace)[-1][:2] == ((("head.1.x", 1),), ())
    assert ZERO.interval("head.1.x") is None  # no check may take it for 0


def test_without_offsets_of_the_setup_zero(tmp_path: Path) -> None:
    trace, findings = run_whole(tmp_path, HEAD + "M91\nG0 X5\nM30\n")
    assert codes_of(findings) == []
    assert ("go", 5, 0, 0) in shown(trace)


@pytest.mark.parametrize("line", ["M97 P1", "M91 P1"])
def test_a_move_to_the_head_is_unknown(tmp_path: Path, line: str) -> None:
    trace, findings = run_whole(tmp_path, HEAD + f"G0 X1 Y2 Z3\n{line}\nM30\n", machine=HEADS)
    assert codes_of(findings) == ["GP272"]
    assert frames(trace)[-1][:3] == (((("?", 1),)),) * 3
    # ... and back: the same
    _, findings = run_whole(tmp_path, HEAD + "M91\nM90 P1\nM30\n", machine=HEADS)
    assert codes_of(findings) == ["GP272"]


@pytest.mark.parametrize("line", ["M90 P1", "M97 P0", "M90 Q0"])
def test_no_move_where_nothing_differs(tmp_path: Path, line: str) -> None:
    _, findings = run_whole(tmp_path, HEAD + f"G0 X1\n{line}\nM30\n", machine=HEADS)
    assert codes_of(findings) == []


def test_calibration_makes_the_offset_unknown(tmp_path: Path) -> None:
    trace, findings = run_whole(tmp_path, HEAD + "M95 Q1\nG0 X1\nM30\n", machine=HEADS)
    assert codes_of(findings) == ["GP272"]
    assert frames(trace)[-1][0] == (("?", 1),)


def test_a_change_while_a_spindle_turns(tmp_path: Path) -> None:
    _, findings = run_whole(tmp_path, HEAD + "S500 M3\nM91\nG33 Z-5 K1\nM30\n", machine=HEADS)
    assert codes_of(findings) == ["GP274", "GP266"]
    _, findings = run_whole(tmp_path, HEAD + "S500 M3\nM90\nG33 Z-5 K1\nM30\n", machine=HEADS)
    assert codes_of(findings) == []


def test_two_heads_on_a_line(tmp_path: Path) -> None:
    _, findings = run_whole(tmp_path, HEAD + "M90 M91\nM30\n", machine=HEADS)
    assert codes_of(findings) == ["GP110"]


def test_the_head_at_the_start_from_the_setup(tmp_path: Path) -> None:
    setup = dataclasses.replace(ZERO, parameters={5390: 1.0})
    trace, _ = run_whole(tmp_path, HEAD + "G0 X1\nM90\nG0 X1\nM30\n", machine=HEADS, setup=setup)
    assert [row[1] for row in shown(trace) if row[0] == "go"] == [51, 1]


def test_nothing_stated_at_all(tmp_path: Path) -> None:
    trace, findings = run_whole(tmp_path, HEAD + "M91\nG0 X5\nM90\nG0 X5\nM30\n", setup=NOTHING)
    assert codes_of(findings) == []
    assert ("head.1.x", 1) in frames(trace)[-4][0] or ("head.1.x", 1) in frames(trace)[-3][0]


def test_the_selected_head_is_a_parameter(tmp_path: Path) -> None:
    """3.1.1: #5390 is 0 for M90, 1 for M91, 2 for M92."""
    trace, _ = run_whole(
        tmp_path, HEAD + "G0 X[#5390]\nM91\nG53 G0 X[#5390]\nM92\nG53 G0 X[#5390]\nM30\n", machine=HEADS
    )
    assert [row[1] for row in shown(trace) if row[0] == "go"] == [0, 1, 2]


def test_a_change_while_the_cutter_is_compensated(tmp_path: Path) -> None:
    text = HEAD + "G0 X0 Y0\nG41.1 D4\nG1 X20 Y20 F100\nX40\nM91\nX60\nG40\nM30\n"
    _, findings = run_whole(tmp_path, text, machine=HEADS)
    assert codes_of(findings)[0] == "GP113"


def test_the_setup_s_offset_counts_before_the_machine_s(tmp_path: Path) -> None:
    """Measured today: [heads.1]; also where the machine's offset lacks its sign."""
    for unsigned in (False, True):
        spindle = Spindle(number=1, offset=(12.0, 7.0, 0.0), unsigned=unsigned)
        machine = dataclasses.replace(NO_MACHINE, spindles=(spindle,))
        measured = {(1, "x"): Interval(-12.5, -12.5), (1, "y"): Interval(7.0, 7.25)}
        setup = dataclasses.replace(ZERO, heads=measured)
        trace, findings = run_whole(tmp_path, HEAD + "M91\nG0 X5 Y5\nM30\n", machine=machine, setup=setup)
        assert codes_of(findings) == []
        assert [row[1] for row in shown(trace) if row[0] == "go"] == [-7.5]
        assert frames(trace)[-1][:2] == ((), (("head.1.y", 1),))


@pytest.mark.parametrize(
    ("spindles", "expected"),
    [
        ((), 0.0),
        ((Spindle(number=1, offset=(0.0, 0.0, 0.0)),), 0.0),
        ((Spindle(number=1, offset=(3.0, 0.0, 0.0)),), (-3.0, 3.0)),
        ((Spindle(number=1, offset=(3.0, 0.0, 0.0)), Spindle(number=2, offset=(-8.0, 0.0, 0.0))), (-8.0, 8.0)),
    ],
)
def test_the_offset_parameter_has_no_sign(
    tmp_path: Path, spindles: tuple[Spindle, ...], expected: float | tuple[float, float]
) -> None:
    """3.1.1: #5391 is the offset of "the" alternate spindle: of which of two, added or taken off, nothing says."""
    machine = dataclasses.replace(NO_MACHINE, spindles=spindles)
    trace, _ = run_whole(tmp_path, HEAD + "G0 X#5391\nM30\n", machine=machine)
    if isinstance(expected, float):
        assert [row[1] for row in shown(trace) if row[0] == "go"] == [expected]
    else:
        assert [(s.low, s.high) for s in trace.symbols.values()] == [expected]
    stated = dataclasses.replace(ZERO, parameters={5391: 2.5})
    trace, _ = run_whole(tmp_path, HEAD + "G0 X#5391\nM30\n", machine=machine, setup=stated)
    assert [row[1] for row in shown(trace) if row[0] == "go"] == [2.5]


def test_the_speeds_of_the_spindles(tmp_path: Path) -> None:
    """3.1.1: #5394 to #5396, the highest speeds in the order of the heads."""
    spindles = tuple(Spindle(number=n, max_rpm=100.0 * (n + 1)) for n in range(2))
    machine = dataclasses.replace(NO_MACHINE, spindles=spindles)
    trace, findings = run_whole(tmp_path, HEAD + "G0 X#5394 Y#5395\nM30\n", machine=machine)
    assert ("go", 100, 200, 0) in shown(trace)
    assert codes_of(findings) == []
    _, findings = run_whole(tmp_path, HEAD + "G0 X#5396\nM30\n", machine=machine)
    assert "GP229" not in codes_of(findings) and codes_of(findings) != []
