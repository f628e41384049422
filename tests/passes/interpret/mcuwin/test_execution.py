"""Lines of DIN blocks executed: places, units, modes. Expected values are worked out from the manual by hand."""

from __future__ import annotations

import dataclasses

import pytest
from passes.interpret.mcuwin.mcuwin_programs import labels, machine, moves, never_homed, run

from gproof.ir.dialects.mcuwin.settings import RadiusTool, TaskCode
from gproof.ir.setup import ZERO
from gproof.ir.trace import UNKNOWN, Op


def test_moves_go_on_until_another_command() -> None:
    trace, findings = run(["G90 G00 X10 Y20", "X30", "G01 X40 F100", "Y0", "G91 G01 X1"])
    assert moves(trace) == [
        ("TRAVERSE", 10, 20, 0), ("TRAVERSE", 30, 20, 0), ("FEED", 40, 20, 0), ("FEED", 40, 0, 0), ("FEED", 41, 0, 0),
    ]  # fmt: skip
    assert labels(findings) == []


def test_rapids_count_in_the_axis_unit_and_feeds_in_the_interpolation_unit() -> None:
    trace, findings = run(["G70", "G00 X10", "G01 X1 F10"])
    assert moves(trace) == [("TRAVERSE", 10, 0, 0), ("FEED", 25.4, 0, 0)]
    assert labels(findings) == []


def test_bare_words_without_a_command_are_refused() -> None:
    assert labels(run(["X10"])[1]) == ["GP202"]
    assert labels(run(["G00 X1", "G04 1", "X10"])[1]) == ["GP202"]
    assert labels(run(["G00 X1", "G90", "X10"])[1]) == ["GP113"]
    kept, findings = run(["G00 X1", "M8", "X10"])
    assert moves(kept)[-1] == ("TRAVERSE", 10, 0, 0)
    assert labels(findings) == []


def test_zero_offsets() -> None:
    trace, findings = run(["G90", "G54", "G00 X1 Y1 Z1", "G92 X100", "G00 X1", "G91 G92 X5", "G90 G00 X0", "G53",
                           "G00 X0 Y0"])  # fmt: skip
    assert [m[1:] for m in moves(trace)] == [(11, 21, 31), (101, 21, 31), (105, 21, 31), (0, 0, 31)]
    assert labels(findings) == []


def test_reflection_about_the_zero_offset() -> None:
    trace, findings = run(["G90", "G22", "G00 X5 Y5", "G39 X2", "G00 X5", "G91 G00 X1", "G24", "G00 X1"])
    assert [m[1:3] for m in moves(trace)] == [(-5, 5), (10, 5), (12, 5), (13, 5)]
    assert labels(findings) == []
    assert "GP276" in labels(run(["G22", "G39 X2", "G24", "G22", "G00 X5"])[1])


def test_mode_behind_g53_in_g91_is_open() -> None:
    assert labels(run(["G91", "G53", "G00 X5"])[1]) == ["GP113"]
    assert labels(run(["G91", "G53", "G91", "G00 X5"])[1]) == []


def test_task_codes() -> None:
    none = machine(tasks=None)
    assert labels(run(["M6", "G00 X1"], on=none)[1]) == ["GP514"]
    assert labels(run(["G74"], on=none)[1]) == ["GP514"]
    assert labels(run(["T3"], on=none)[1]) == ["GP514"]
    assert labels(run(["M3", "M8", "S100", "M5", "M9", "G00 X1"], on=none)[1]) == []
    assert labels(run(["G210 X5"], on=none)[1]) == ["GP514"]
    assert labels(run(["G210 X5"])[1]) == ["GP112"]


def _tools(*records: tuple[str, int, float, float]) -> tuple[RadiusTool, ...]:
    return tuple(RadiusTool(plane=p, number=n, radius=r, length=length) for p, n, r, length in records)


def test_radius_correction() -> None:
    plain = machine(tools=_tools(("xy", 0, 0.0, 0.0), ("xy", 1, 5.0, 0.0), ("zx", 0, 2.0, 0.0)))
    # Record 0, which counts before the first T, is no tool: told once, at the first move of the contour.
    assert labels(run(["G41", "G01 X5 F100", "G01 X7", "G40"], on=plain)[1]) == ["GP258"]
    assert labels(run(["T0", "G41", "G01 X5 F100", "G40"], on=plain)[1]) == []
    assert labels(run(["G41", "G00 X5", "G40", "G01 X5 Y5 F100"], on=plain)[1]) == []

    # A correction by nothing becomes one when the tool or the plane does.
    def is_exact(*lines: str) -> bool:
        trace, findings = run(list(lines), on=plain)
        assert labels(findings) == []
        return all(frame == ((),) * 6 for frame in trace.frames)

    assert not is_exact("T1", "G42", "G01 X5 F100")
    assert not is_exact("G41", "T1", "G01 X5 F100")
    assert not is_exact("G41", "G18", "G01 X5 F100")
    assert is_exact("G41", "G40", "T1", "G01 X5 F100")
    trace, _ = run(["T1", "G42", "G01 X5 Z3 F100", "G40", "G01 X7 Y7"], on=plain)
    rows = trace.sections[-1].rows
    frames = [trace.frames[int(rows["frame"][n])] for n in range(len(rows)) if rows["op"][n] == Op.FEED]
    assert [[form == () for form in frame[:3]] for frame in frames] == [[False, False, True]] * 2 + [[True] * 3]
    assert labels(run(["G41"], on=machine(tools=()))[1]) == ["GP285"]
    assert labels(run(["T1", "G41", "G54"], on=plain)[1]) == ["GP113"]


def test_lengths_of_tools() -> None:
    long = machine(tools=_tools(("xy", 0, 0.0, 0.0), ("xy", 1, 0.0, 7.0)))
    assert labels(run(["T1", "G00 Z5"], on=long)[1]) == ["GP113"]
    first = machine(tools=_tools(("xy", 0, 0.0, 7.0)))
    trace, _ = run(["G00 Z5"], on=first)
    rows = trace.sections[-1].rows
    assert trace.frames[int(rows["frame"][0])][2] == UNKNOWN


def test_what_ends_a_contour() -> None:
    def breaks(*lines: str, **din: object) -> list[str]:
        found = run(list(lines), on=machine(**din))[1].kept
        return [f.message.split()[0] for f in found if f.code.label == "GP513"]

    assert breaks("G01 X1 F100", "G54", "G01 X2", "G92 X0", "G01 X3", "S100", "G01 X4") == ["G54", "G92", "S"]
    assert breaks("G01 X1 F100", "M26 102", "F200", "G90 G01 X2", "G00 X5", "G53") == []
    assert breaks("CI600 := 0", "G01 X1 F100", "M98 L7", version="2.5.3.133") == []
    quiet = (TaskCode(code="M8", action="coolant_on", breaks=False),)
    assert breaks("G01 X1 F100", "M8", "G01 X2", tasks=quiet) == []
    trace, _ = run(["G01 X1 F100", "G92 X5", "G01 X2"])
    rows = trace.sections[0].rows
    assert [float(rows["arg"][n][1]) for n in range(len(rows)) if rows["op"][n] == Op.OFFSET] == [1.0]


def test_several_codes_in_a_line() -> None:
    trace, findings = run(["G00 G90 X5 M26 102", "M27 102 G01 X6 F100 M26 103"])
    rows = trace.sections[0].rows
    assert [Op(int(op)).name for op in rows["op"]] == [
        "TRAVERSE", "OUTPUT", "OUTPUT", "FEED", "OUTPUT", "END",
    ]  # fmt: skip
    assert labels(findings) == []
    assert labels(run(["G01 X5 F100 G91"])[1]) == ["GP113"]
    assert labels(run(["G01 X5 F100 G90"])[1]) == []
    assert labels(run(["G00 X5 G01"])[1]) == ["GP113"]
    assert labels(run(["G90 G91"])[1]) == ["GP113"]
    assert labels(run(["M30 G00 X5"])[1])[0] == "GP113"
    assert labels(run(["G00 X5 X6"])[1]) == ["GP109"]
    assert labels(run(["G00 X5 7"])[1]) == ["GP121"]
    assert labels(run(["G04"])[1]) == ["GP275"]
    assert labels(run(["G93 G01 X5 F10"])[1]) == ["GP112"]


def test_interpolation_axes() -> None:
    assert labels(run(["G60 X Y", "G01 X1 F100", "G00 Z1", "G01 Z2"])[1]) == ["GP129"]
    assert labels(run(["G60 X Y", "G00 X1", "G60 X Y Z", "G01 Z2 F100"], on=machine(g60="run"))[1]) == []
    assert labels(run(["G60 X Y", "G00 X1", "G60 X Y Z", "G01 Z2 F100"], on=machine(g60="once"))[1]) == ["GP129"]


@pytest.mark.parametrize("version", ["2.5.3.32", "2.5.3.133"])
@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        # 3.20 reads it once, when the program starts; 14 (2.5.3.78) where it runs: axes that both count in move.
        (["G60 X Y", "G60 X Y Z", "G01 X1 F100", "G01 Z2"], ["GP113"]),
        (["G60 X Y", "G00 X1", "G60 X Y Z", "G01 X2 F100"], []),
        (["G60 X Y Z", "G00 X1", "G60 X Y", "G01 Y1 F100"], []),
        (["G60 X Y Z", "G00 X1", "G60 X Y", "G01 Z1 F100"], ["GP113"]),
        # Those that neither counts in are an error in both.
        (["G60 X Y", "G00 X1", "G60 X", "G01 Z1 F100"], ["GP129"]),
        (["G00 X1", "G60 X Y", "G01 Z1 F100"], ["GP113"]),
        # Written twice it is no less a second one; the first set again is both.
        (["G60 X Y", "G00 X1", "G60 X Y Z", "G60 X Y Z", "G01 Z2 F100"], ["GP113"]),
        (["G60 X Y", "G00 X1", "G60 X Y Z", "G60 X Y", "G01 X2 F100"], []),
        (["G60 X Y", "G00 X1", "G60 X Y Z", "G60 X Y", "G01 Z2 F100"], ["GP129"]),
        # G53 switches off the offset of the axes that interpolate.
        # G00 is no interpolation.
        (["G60 X Y Z", "G00 X1", "G60 X Y", "G00 Z1"], []),
    ],
)
def test_a_second_g60_counts_or_does_not(version: str, lines: list[str], expected: list[str]) -> None:
    assert labels(run(lines, on=machine(version=version))[1]) == expected


@pytest.mark.parametrize(
    ("lines", "known"),
    [
        # G53 switches off the offset of the axes that interpolate: Z goes to 1 or to 6.
        (["G60 X Y", "G00 X1", "G60 X Y Z", "G53", "G00 X1"], True),
        (["G60 X Y", "G00 X1", "G60 X Y Z", "G53", "G00 Z1"], False),
        (["G53", "G60 X Y", "G00 Z1"], False),
        (["G53", "G60 X Y Z", "G00 Z1"], True),
    ],
)
def test_offsets_where_it_is_open_which_axes_interpolate(lines: list[str], known: bool) -> None:
    trace, _ = run(["G92 Z5", *lines], on=machine(interpolation_axes="XYZ"))
    assert (UNKNOWN not in [frame[2] for frame in trace.frames]) is known


def test_limits_that_the_program_sets() -> None:
    trace, findings = run(["G98 X-5", "G99 X50", "G00 X1"])
    (state,) = {trace.states[int(n)] for n in trace.sections[0].rows["state"][:1]}
    assert [(b.axis, b.low, b.high, b.limit) for b in state.boundaries] == [(0, -5.0, 50.0, True)]
    assert labels(findings) == []
    assert labels(run(["G70", "G98 X-5"])[1]) == ["GP302"]
    assert labels(run(["G91", "G98 X-5"])[1]) == ["GP302"]


def test_axes_without_a_reference_run() -> None:
    some = dataclasses.replace(ZERO, homed=("x",))
    assert never_homed(["G00 X1", "G00 Y1", "G00 Y2"], some, machine()) == [("Y", 2)]


def test_outputs() -> None:
    trace, findings = run(["M26 200", ("if", "IN5 == 2", ["G00 X1"]), "M80 X5"])
    rows = [r for s in trace.sections for r in s.rows.rows() if r[0] == Op.OUTPUT]
    assert len(rows) == 2
    assert labels(findings) == []
    assert labels(run(["M26 99"])[1]) == ["GP128"]
    assert labels(run(["M26 1.5"])[1]) == ["GP229"]
