"""Programs of DIN blocks that look harmless: what must not be told SAFE, and what must be told at all."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest
from passes.interpret.mcuwin.mcuwin_programs import labels, machine, moves, never_homed, program, run

from gproof.driver.running import begin, collect
from gproof.ir.dialects.mcuwin.settings import RadiusTool, TaskCode
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine, Spindle
from gproof.ir.setup import ZERO, Setup

TOOLS = tuple(
    RadiusTool(number=number, plane=plane, radius=radius, length=0.0)
    for number, plane, radius in (
        (0, "xy", 0.0), (1, "xy", 5.0), (2, "xy", 0.0), (0, "zx", 3.0), (1, "zx", 3.0), (2, "zx", 0.0),
    )
)  # fmt: skip


@pytest.mark.parametrize(
    ("lines", "known"),
    [
        (["T1"], False),
        (["T2"], True),
        (["G18"], False),
        (["T2", "G18"], True),
        (["T2", "G18", "T1"], False),
        (["G40", "T1"], True),
        (["G40", "G18"], True),
    ],
)
def test_a_correction_of_no_radius_is_one_with_the_next_tool_or_plane(lines: list[str], known: bool) -> None:
    on = machine(tools=TOOLS)
    trace, _ = run(["G90 F100", "G41", *lines, "G01 X5"], on=on)
    assert all(frame == ((),) * 6 for frame in trace.frames) is known


@pytest.mark.parametrize(
    "line", ["G00 X", "G01 X Y5 F10", "G92 X", "G98 X", "G99 Y", "G51 C", "M80 X", "G39 X", "G00 F X5"]
)
def test_a_letter_without_its_number_is_refused(line: str) -> None:
    assert "GP108" in labels(run(["G90", line])[1])


@pytest.mark.parametrize("line", ["G60 X Y", "G74 X"])
def test_codes_that_name_axes_take_letters_alone(line: str) -> None:
    assert "GP108" not in labels(run(["G90", line])[1])


def _ended(**changes: float) -> Machine:
    """X from -100 to 100, end stops as given."""
    on = machine()
    axes = tuple(
        dataclasses.replace(axis, lower=-100.0, upper=100.0, **changes) if axis.name == "x" else axis
        for axis in on.axes
    )
    return dataclasses.replace(on, axes=axes)


@pytest.mark.parametrize(
    ("line", "stops", "known"),
    [
        ("G98 X-150", {}, False),
        ("G99 X150", {}, False),
        ("G98 X-100", {}, True),
        ("G99 X60", {}, True),
        ("G98 X-150", {"travel_upper": 110.0}, False),
        ("G98 X-150", {"travel_lower": -160.0}, True),
        ("G99 X150", {"travel_upper": 110.0}, True),
    ],
)
def test_limits_past_those_of_the_machine_need_its_end_stops(line: str, stops: dict[str, float], known: bool) -> None:
    assert ("GP302" not in labels(run(["G90", line], on=_ended(**stops))[1])) is known


def test_a_library_of_subprograms_says_that_it_is_no_job() -> None:
    _, findings = run(["G90 G00 X5", "M17"])
    (found,) = [finding for finding in findings.kept if finding.code.label == "GP113"]
    assert "$I" in found.hint


@pytest.mark.parametrize(
    "lines",
    [
        ["G91", "L1", "G00 X30", "M96 L1"],
        ["G91", ("while", "1 == 1", ["G00 X30"])],
        ["G91", ("repeat", ["G00 X30"], "1 == 2")],
        ["G91", ("repeat", ["G00 X30"], "IN101")],
    ],
)
def test_a_loop_that_leads_away_for_ever_is_not_run_for_ever(lines: list[Any]) -> None:
    trace, findings = run(lines, on=_ended(), budget=200_000)
    assert "GP113" in labels(findings)
    assert sum(len(section.rows) for section in trace.sections) < 2000


def test_a_long_loop_within_the_machine_runs_to_its_end() -> None:
    lines = ["G91", "CI601 := 0", ("while", "CI601 < 500", ["G00 X30", "G00 X-30", "CI601 := CI601 + 1"])]
    assert labels(run(lines, on=_ended())[1]) == []


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        (["G00 X10", "G98 X20", "G00 X30"], ["GP301"]),
        (["G00 X10", "G99 X5"], ["GP301"]),
        (["G00 X10", "G98 X10", "G99 X10", "G00 Y5"], []),
        # From machine zero X stands within, from the offset it does not: 3.29 has neither.
        (["G92 X10", "G00 X0", "G98 X5", "G00 X1"], ["GP302"]),
        (["G92 X10", "G00 X0", "G99 X50", "G00 X1"], []),
        (["G91", "G00 X10", "G90", "G98 X5 Y1"], ["GP301"]),
        # Of a limit that nobody knows nothing is past, nor of the one before it.
        (["G00 X10", "G98 X5", "G91", "G98 X-9", "G90", "G00 X3"], ["GP302"]),
    ],
)
def test_an_axis_stands_within_the_limits_that_the_program_sets(lines: list[str], expected: list[str]) -> None:
    assert labels(run(["G90", *lines], on=_ended())[1]) == expected


def test_a_start_that_nobody_stated_is_taken_to_be_within_new_limits() -> None:
    ex = begin(program(["G90", "G98 X5", "G00 X6", "M30"]), Setup(), _ended(), Findings())
    collect(ex)
    assert any("G98 and G99" in text for text in ex.assumed)


def test_records_of_the_table_set_the_offsets_of_all_axes_in_the_older_version() -> None:
    def last(version: str) -> tuple[float, ...]:
        trace, _ = run(["G60 X Y", "G90", "G54", "G00 X0 Y0 Z0"], on=machine(version=version))
        return moves(trace)[-1][1:]

    assert last("2.5.3.133") == (10.0, 20.0, 0.0)
    assert last("2.5.3.32") == (10.0, 20.0, 30.0)


def test_an_arc_through_an_axis_that_does_not_interpolate() -> None:
    assert labels(run(["F100", "G60 X Z", "G02 X10 I5 J0"])[1]) == ["GP129"]
    assert labels(run(["F100", "G60 X Y", "G02 X10 I5 J0"])[1]) == []
    assert labels(run(["F100", "G60 X Z", "G60 X Y", "G02 X10 I5 J0"])[1]) == ["GP113"]


def test_axis_d_of_the_manual_is_no_tool_table() -> None:
    assert labels(run(["G51 C20 D40"])[1]) == ["GP296"]
    assert labels(run(["G51 C20", "D40"])[1]) == ["GP200"]


def test_centre_words_behind_a_maintained_g92() -> None:
    assert labels(run(["G92 X5", "X6 I3"])[1]) == ["GP121"]


def test_what_g153_reads_of_a_cylinder_is_in_no_known_unit() -> None:
    table = ((0.0, 0.0, 0.0, 0.0, 0.0, 45.0),)
    lines = ["F100", "G54", "G51 C20", "G153", "G01 C(CD55)"]
    assert "GP225" in labels(run(lines, on=machine(zero_offsets=table))[1])
    back = ["F100", "G54", "G51 C20", "G153", "G53", "G154", "G90 G00 C0"]
    trace, findings = run(back, on=machine(zero_offsets=table))
    assert moves(trace, 6)[-1][1:] == (0.0, 0.0, 0.0, 0.0, 0.0, 45.0)
    assert labels(findings) == []


def test_an_end_of_which_task_0_is_not_known() -> None:
    def ended(version: str) -> list[str]:
        tasks = (TaskCode(code="M2", action="unknown"),)
        return labels(run(["G00 X1", "M2"], on=machine(version=version, tasks=tasks))[1])

    assert "GP514" in ended("2.5.3.133")
    assert "GP514" not in ended("2.5.3.32")


@pytest.mark.parametrize("line", ["G21", "G23", "G74 X", "G74"])
def test_what_turns_a_contour_over_while_it_is_corrected(line: str) -> None:
    around = ["G90 F100", "T1", "G41", "G01 X10 Y10", line, "G01 X20", "G40", "G24", "G00 X0 Y0 Z0"]
    assert "GP256" in labels(run(around, on=machine(tools=TOOLS))[1])
    before = ["G90", line, "G00 X0 Y0 Z0", *(other for other in around if other != line)]
    assert "GP256" not in labels(run(before, on=machine(tools=TOOLS))[1])


def test_a_reflection_that_is_on_already_changes_no_side() -> None:
    lines = ["G90 F100", "T1", "G21", "G41", "G01 X10 Y10", "G21", "G01 X20"]
    assert labels(run(lines, on=machine(tools=TOOLS))[1]) == ["GP169"]
    assert "GP256" in labels(run([*lines, "G24", "G01 X30"], on=machine(tools=TOOLS))[1])


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        (["G02 X10 I5 J0"], [("Y", 2)]),
        (["G02 I5 J0", "G01 X1"], [("Y", 2)]),
        (["G01 X10"], []),
        (["T1", "G41", "G01 X10"], [("Y", 4)]),
        (["T1", "G41", "G40", "G01 X10"], []),
    ],
)
def test_axes_that_an_arc_or_a_correction_moves_have_had_a_reference_run(
    lines: list[str], expected: list[tuple[str, int]]
) -> None:  # fmt: skip
    some = dataclasses.replace(ZERO, homed=("x", "z"))
    assert never_homed(["G90 F100", *lines], some, machine(tools=TOOLS)) == expected


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        # Which of two codes of one kind counts, and whose the words are, no section says (3, 4).
        ("M03 M05", ["GP113"]), ("M04 M03", ["GP113"]), ("M08 M09", ["GP113"]), ("M03 M08", []), ("M05 M09", []),
        ("G00 G92 X5", ["GP113"]), ("G01 G98 X-5", ["GP113"]), ("G92 X5 G00 X7", []), ("G90 G00 X5", []),
        # F in front of a code of units (5.3).
        ("F10 G70 M08", []), ("G70 F10 M08", []),
    ],
)  # fmt: skip
def test_two_codes_of_a_line(line: str, expected: list[str]) -> None:
    assert labels(run(["G90 F100", line])[1]) == expected


def test_feed_in_front_of_its_unit() -> None:
    assert labels(run(["G90", "F10 G70", "G01 X1"])[1]) == ["GP204"]
    assert labels(run(["G90", "G70 F10", "G01 X1"])[1]) == []
    assert labels(run(["G90", "F10 G71", "G01 X1"])[1]) == []


@pytest.mark.parametrize(
    ("s", "expected"),
    [("S3000", []), ("S0", []), ("S2999", ["GP271"]), ("S24000", []), ("S24001", ["GP271"]), ("S(CD600)", ["GP234"])],
)
def test_speeds_that_the_spindle_does_not_have(s: str, expected: list[str]) -> None:
    """Error 4000 (13.1.1.25): above its greatest speed and below its least; a speed of 0 is one that rests."""
    on = dataclasses.replace(machine(), spindles=(Spindle(number=0, min_rpm=3000.0, max_rpm=24000.0),))
    setup = dataclasses.replace(ZERO, default_parameter=None)
    assert labels(run([s, "G00 X1"], on=on, setup=setup)[1]) == expected
