"""G98 and G99 under a zero offset: from machine zero, or from the offset in force; the manual does not say (3.29).

Places that both readings leave are SAFE, those past both an error, those past one of them alone UNKNOWN. All numbers
below are worked out by hand: with offset o and limit v the readings are v and v + o, machine positions.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.command import in_this_process

MACHINE = """schema = "gproof-machine/1"
units = "mm"
{axes}
[controller]
dialect = "mcuwin"
[din]
version = "2.5.3.133"
case_sensitive = false
position_unit = "{unit}"
time_unit = "min"
absolute_centers = false
interpolation_axes = "XYZ"
shortest_path = false
zero_offsets = [[10.0, 0.0, 0.0]]
pre_include = ""
post_include = ""
tool_file = ""
[din.task0]
M30 = "end"
"""
AXIS = """[axes.{name}]
min = -100.0
max = 100.0
{travel}max_velocity = 80.0
max_acceleration = 400.0
position_unit = "{unit}"
"""
TRAVEL = "travel_min = -200.0\ntravel_max = 200.0\n"
START = 'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\nstart = {x = 0, y = 0, z = 0}\n'


def judged(
    folder: Path, lines: list[str], *, g92: str = "x = 0, y = 0, z = 0", travel: str = "", unit: str = "mm"
) -> tuple[str, list[tuple[str, int]], list[str]]:
    """The verdict of limits, decisive findings with their lines, and the conditions."""
    axes = "".join(AXIS.format(name=name, travel=travel, unit=unit) for name in "xyz")
    (folder / "machine.toml").write_text(MACHINE.format(axes=axes, unit=unit))
    (folder / "setup.toml").write_text(START + (f"g92 = {{{g92}}}\n" if g92 else ""))
    (folder / "job.src").write_text("\n".join(["%1", *lines, "M30", "%", ""]))
    words = ["check", "job.src", "--machine", "machine.toml", "--setup", "setup.toml", "--format", "json"]
    report = json.loads(in_this_process(words, folder).out)
    limits = report["properties"]["limits"]
    told = [(f["code"], f["line"]) for f in report["findings"] if f["severity"] in ("error", "unknown")]
    return limits["verdict"], told, [c["text"] for c in limits["conditions"]]


CASES = [
    # offset, limit, machine place of X, verdict
    (10, "G98 X-20", -5, "SAFE"),
    (10, "G98 X-20", -10, "SAFE"),
    (10, "G98 X-20", -15, "UNKNOWN"),
    (10, "G98 X-20", -20, "UNKNOWN"),
    (10, "G98 X-20", -25, "UNSAFE"),
    (-10, "G98 X-20", -20, "SAFE"),
    (-10, "G98 X-20", -25, "UNKNOWN"),
    (-10, "G98 X-20", -30, "UNKNOWN"),
    (-10, "G98 X-20", -35, "UNSAFE"),
    (10, "G99 X20", 20, "SAFE"),
    (10, "G99 X20", 25, "UNKNOWN"),
    (10, "G99 X20", 35, "UNSAFE"),
    (-10, "G99 X20", 10, "SAFE"),
    (-10, "G99 X20", 15, "UNKNOWN"),
    (-10, "G99 X20", 25, "UNSAFE"),
    # One of both sides leaves the other where the machine file has it.
    (10, "G98 X-20", 99, "SAFE"),
    (10, "G98 X-20", 101, "UNSAFE"),
    (-10, "G99 X20", -99, "SAFE"),
    (-10, "G99 X20", -101, "UNSAFE"),
    (0, "G98 X-20", -20, "SAFE"),
    (0, "G98 X-20", -21, "UNSAFE"),
    # Wider than the machine file's in one reading: -95 and -105, with -100 there and no end stop stated.
    (-10, "G98 X-95", -94, "SAFE"),
    (-10, "G98 X-95", -97, "UNKNOWN"),
    (-10, "G98 X-95", -103, "UNKNOWN"),
    (-10, "G98 X-95", -106, "UNSAFE"),
    (10, "G98 X-105", -94, "SAFE"),
    (10, "G98 X-105", -97, "UNKNOWN"),
    (10, "G98 X-105", -106, "UNSAFE"),
]


@pytest.mark.parametrize("travel", ["", TRAVEL], ids=["no end stops", "end stops"])
@pytest.mark.parametrize(("offset", "limit", "place", "verdict"), CASES)
def test_both_readings_of_a_limit_are_followed(
    offset: int, limit: str, place: int, verdict: str, travel: str, tmp_path: Path
) -> None:
    lines = ["G90", f"G92 X{offset}", limit, f"G00 X{place - offset}"]
    found, told, _ = judged(tmp_path, lines, travel=travel)
    assert found == verdict, told
    if verdict == "UNSAFE":
        assert ("GP301", 5) in told
    elif verdict == "UNKNOWN":
        # At the line that goes there, not at that of the limit.
        assert set(told) == {("GP302", 5)}


@pytest.mark.parametrize(("offset", "limit", "place", "verdict"), CASES)
def test_an_offset_that_the_setup_states_is_as_good_as_one_of_the_program(
    offset: int, limit: str, place: int, verdict: str, tmp_path: Path
) -> None:
    lines = ["G90", limit, f"G01 X{place - offset} F100"]
    found, told, _ = judged(tmp_path, lines, g92=f"x = {offset}, y = 0, z = 0")
    assert found == verdict, told


@pytest.mark.parametrize(
    ("lines", "verdict"),
    [
        # G53 before: the number is a machine position in both readings; a later offset does not move it.
        (["G53", "G98 X-20", "G00 X-20"], "SAFE"),
        (["G53", "G98 X-20", "G92 X10", "G00 X-30"], "SAFE"),
        (["G53", "G98 X-20", "G92 X10", "G00 X-31"], "UNSAFE"),
        # The limit stays where it was made: behind G53 the readings are still -20 and -10.
        (["G92 X10", "G98 X-20", "G53", "G00 X-15"], "UNKNOWN"),
        (["G92 X10", "G98 X-20", "G53", "G00 X-10"], "SAFE"),
        # Made again it is a single one; the other side keeps its two, 20 and 30.
        (["G92 X10", "G98 X-20", "G99 X20", "G53", "G98 X-20", "G00 X-15"], "SAFE"),
        (["G92 X10", "G98 X-20", "G99 X20", "G53", "G98 X-20", "G00 X25"], "UNKNOWN"),
        # An offset of another axis makes nothing open.
        (["G92 Y10", "G98 X-20", "G00 X-20"], "SAFE"),
        (["G92 Y10", "G98 X-20", "G00 X-21"], "UNSAFE"),
        # G54: the first record, 10.
        (["G54", "G98 X-20", "G00 X-25"], "UNKNOWN"),
        (["G54", "G98 X-20", "G00 X-20"], "SAFE"),
        # Between its ends the arc goes to X -12, machine: past -10, not past -20.
        (["G92 X10", "G98 X-20", "G00 X-10 Y0", "G03 X-10 Y-24 I0 J-12 F100"], "UNKNOWN"),
        (["G92 X10", "G98 X-20", "G00 X-8 Y0", "G03 X-8 Y-24 I0 J-12 F100"], "SAFE"),
        (["G92 X10", "G98 X-20", "G00 X-20 Y0", "G03 X-20 Y-24 I0 J-12 F100"], "UNSAFE"),
        # Past one reading only in one line, past both in another one.
        (["G92 X10", "G98 X-20", "G00 X-25", "G00 X-31"], "UNSAFE"),
    ],
)
def test_a_limit_counts_from_the_offset_of_its_own_line(lines: list[str], verdict: str, tmp_path: Path) -> None:
    found, told, _ = judged(tmp_path, ["G90", *lines], travel=TRAVEL)
    assert found == verdict, told


@pytest.mark.parametrize(
    ("place", "verdict"),
    [(-0.9, "SAFE"), (-1.0, "SAFE"), (-1.5, "UNKNOWN"), (-2.1, "UNSAFE")],
)
def test_limits_in_inches(place: float, verdict: str, tmp_path: Path) -> None:
    # -2 inches from machine zero, -1 with the offset of an inch.
    lines = ["G90", "G92 X1", "G98 X-2", f"G00 X{place - 1:.1f}"]
    found, told, _ = judged(tmp_path, lines, unit="inch")
    assert found == verdict, told


@pytest.mark.parametrize(
    ("word", "verdict"),
    # The offset is 5 to 10: from machine zero the limit is -20, from the offset -15 to -10.
    [(-20, "SAFE"), (-19, "SAFE"), (-23, "UNKNOWN"), (-29, "UNKNOWN"), (-31, "UNSAFE")],
)
def test_an_offset_between_two_numbers(word: int, verdict: str, tmp_path: Path) -> None:
    found, told, conditions = judged(
        tmp_path, ["G90", "G98 X-20", f"G00 X{word}"], g92="x = [5, 10], y = 0, z = 0", travel=TRAVEL
    )
    assert (found, conditions) == (verdict, []), told


def test_an_offset_that_nobody_stated_gives_a_condition(tmp_path: Path) -> None:
    # From the offset -15 is within -20 whatever it is; from machine zero where the offset is -5 or more.
    found, told, conditions = judged(tmp_path, ["G90", "G98 X-20", "G00 X-15"], g92="y = 0, z = 0", travel=TRAVEL)
    assert (found, told) == ("SAFE", []), told
    assert any("-5.0000" in text for text in conditions), conditions
    # Past it from the offset, whatever it is; not so from machine zero.
    found, told, _ = judged(tmp_path, ["G90", "G98 X-20", "G00 X-25"], g92="y = 0, z = 0", travel=TRAVEL)
    assert (found, told) == ("UNKNOWN", [("GP302", 4)])
