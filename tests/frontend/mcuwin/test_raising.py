"""Programs of McuWIN as neutral jobs: what the manual requires of each construct, written by hand."""

from __future__ import annotations

import dataclasses
import tomllib
from pathlib import Path
from typing import Any

import pytest
from frontend.mcuwin.mcuwin_programs import load, machine
from support.bundles import ROOT
from support.neutral_words import words_of

from gproof.driver.dialects import DIALECTS
from gproof.driver.session import open_session
from gproof.frontend.mcuwin.machine import NO_MCUWIN
from gproof.frontend.mcuwin.raising import raise_program
from gproof.ir.dialects.mcuwin.settings import RadiusTool, TaskCode
from gproof.ir.job import ArcTo, Job, Moves, NotRaised, walk
from gproof.ir.machine import Axis, Machine
from gproof.ir.text import parse_ir, print_ir

TASKS = tuple(
    TaskCode(code=code, action=action)
    for code, action in {
        "M3": "spindle_cw", "M4": "spindle_ccw", "M5": "spindle_off", "M6": "tool_change", "M8": "coolant_on",
        "M9": "coolant_off", "S": "spindle_speed", "T": "tool_select", "G74": "home", "M210": "nothing",
        "M211": "unknown", "M212": "stop",
    }.items()
)  # fmt: skip
LINEAR = tuple(axis for axis in NO_MCUWIN.axes if axis.index < 3)


def on(axes: tuple[Axis, ...] = LINEAR, **din: Any) -> Machine:
    """X, Y and Z on a machine whose settings are known."""
    usual: dict[str, Any] = {"time_unit": 60.0, "absolute_centers": False, "tasks": TASKS, "tools": ()}
    return dataclasses.replace(machine(**usual | din), axes=axes)


def raised(folder: Path, text: str, on_machine: Machine | None = None) -> Job:
    """The job of a program, verified, whose text form parses back."""
    this = on_machine or on()
    program, _ = load(folder, text, this)
    assert program is not None
    job = raise_program(program, this)
    job.verify()
    printed = print_ir(job)
    assert print_ir(parse_ir(printed)) == printed
    return job


def words(folder: Path, lines: str, on_machine: Machine | None = None) -> list[str]:
    """What the lines of a program say; ``M30`` is added, and what it says left out."""
    body = words_of(raised(folder, f"%A\n{lines}\nM30\n%\n", on_machine).body)
    assert body[-1] == "end reset"
    return body[:-1]


STATED = {
    "a code goes on in the order of the source (3.1)": (
        "G00 X20 Y22\nX30 Y23 Z-5\nG01 X1 F100\nY2",
        ["rapid x20 y22", "rapid x30 y23 z-5", "feed x1 F100", "feed y2"],
    ),
    "places and distances (3.24, 3.25)": ("G91\nG00 X1\nG01 Y2 F5\nG90\nG01 X3", [
        "rapid x+1", "feed y+2 F5", "feed x3"]),
    "inches are not for G00, which has the axis's unit (3.1, 3.21)": (
        "G70\nG00 X1\nG01 X2 F3\nG00 X4\nG71\nG01 X5 F6",
        ["rapid x1", "feed x2inch F3inch", "rapid x4", "feed x5 F6"],
    ),
    "F after a unit must come again (3.21, 5.3)": (
        "G01 X1 F100\nG70\nG01 X2\nG01 X3 F4\nX5",
        ["feed x1 F100", "NOT the feed in force", "feed x3inch F4inch", "feed x5inch"],
    ),
    "F alone, and with G00 (5.3)": ("F300\nG00 X1 F200\nG01 X2", ["F300", "F200", "rapid x1", "feed x2"]),
    "centres are distances (3.36)": (
        "G162\nG90 F100\nG00 X0 Y0\nG02 X10 Y0 I5 J0\nX0 I-5 J0\nG03 I5 J0 Z-1",
        ["F100", "rapid x0 y0", "cw xy x10 y0 about x+5 y+0", "cw xy x0 about x-5 y+0", "ccw xy z-1 about x+5 y+0"],
    ),
    "centres are places in G90 (3.35)": (
        "G161\nF100\nG00 X10 Y20\nG02 X30 Y20 I20 J20\nG91\nG03 X-20 Y0 I-10 J0",
        ["F100", "rapid x10 y20", "cw xy x30 y20 about x+10 y+0", "ccw xy x-20 y+0 about x-10 y+0"],
    ),
    "a centre word that is missing is 0 where it was 0 (3.3)": (
        "F100\nG02 X10 Y0 I5\nG02 X20 J3\nG02 X30 I5",
        ["F100", "cw xy x10 y0 about x+5 y+0", "NOT an arc without I", "NOT an arc without J"],
    ),
    "a helix and an arc of Z-X (3.7)": (
        "G18\nF9\nG02 X1 Z2 I3 K4\nG02 X1 Y2 I3 J4\nG17",
        ["F9", "NOT G2 after G18 or G19", "NOT G2 after G18 or G19"],
    ),
    "seconds at rest (3.5, 10)": ("G04 3\nG04 CD601\n$wt(2000);", ["dwell 3s", "dwell CD601s", "dwell 2000ms"]),
    "zero offsets (3.18, 3.19)": (
        "G53\nG54\nG58", ["zero_at x0 y0 z0", "select 1", "select 5"]),
    "G92 is a zero in machine places, in G91 from the one in force (3.26)": (
        "G92 X100 Y-200\nG91\nG92 Z5", ["zero_at x100 y-200", "zero_shift z+5"]),
    "axis words after G92 are G92 again (3.26)": ("G92 X1\nY2", ["zero_at x1", "zero_at y2"]),
    "G53 in G91 may end it (3.18)": ("G91\nG53\nG01 X1 F5\nG91\nG01 X1", [
        "zero_at x0 y0 z0", "NOT axis words", "feed x+1"]),
    "the zero is kept and comes back (3.33, 3.34)": (
        "G154\nG153\nG92 X1\nG154", ["NOT G154", "zero_keep", "zero_at x1", "zero_recall"]),
    "reflections add up (3.9 to 3.12)": (
        "G91\nG21\nG22\nG24\nG23\nG01 X1 F5",
        ["mirror y0", "mirror_off", "mirror x0 y0", "mirror_off", "mirror x0 y0", "feed x+1 F5"],
    ),
    "a place under a reflection is mirrored about a zero that is open (3.9)": (
        "F5\nG22\nG01 X1\nG01 Y2\nG53\nG01 X3",
        ["F5", "mirror x0", "NOT a place of X under a reflection", "feed y2", "zero_at x0 y0 z0", "feed x3"],
    ),
    "factors of reflected axes (3.13)": (
        "G91\nG39 X2 Y2\nG23\nG39\nG24",
        ["scale by x2 y2", "scale_off", "mirror x0 y0", "mirror_off"],
    ),
    "whether G24 keeps factors is open (3.12)": ("G91\nG39 X2\nG22\nG24\nG22", [
        "scale by x2", "scale_off", "NOT G22"]),
    "Task 0 (4.4 to 4.9, 5.4, 5.5)": (
        "S12000 M03\nM04\nM05\nT3\nM06\nM08\nM09",
        ["spindle speed 12000rpm", "spindle cw", "spindle ccw", "spindle off", "tool 3 selected", "tool change",
         "flood on", "mist off flood off"],
    ),
    "codes of the application (4)": ("M210\nM211\nM212\nM213", [
        "NOT M210", "NOT M211", "pause", "NOT M213"]),
    "reference run (3.23)": ("G74\nG74 X Z", ["home x y z", "home x z"]),
    "outputs while moving (4.11, 4.12)": ("M26 102\nM27 301\nM26 200\nM26 401", [
        "output 102 := 1 moving", "output 301 := 0 moving", "NOT M26 200", "NOT M26 401"]),
    "stops (4.1, 4.2)": ("M00\nM01", ["pause", "pause optional"]),
    "codes in front of a motion and after it (4)": (
        "M08 G01 X1 F5 M05", ["flood on", "feed x1 F5", "spindle off"]),
    "modes act before the motion (3.24)": ("G01 X1 F5 G91\nG90\nG70 G01 X1 F5", [
        "NOT G91 after the words of a move", "feed x1inch F5inch"]),
    "words between two codes (3.1)": ("G00 G92 X0", ["NOT axis words after G0 and G92"]),
    "after another code bare words are open (3.1)": ("G01 X1 F5\nG90\nX2", ["feed x1 F5", "NOT axis words alone"]),
    "after G04 nothing goes on (3.5)": ("G01 X1 F5\nG04 1\nX2", ["feed x1 F5", "dwell 1s", "NOT axis words alone"]),
    "what has no form": (
        "G41\nG93\nG96\nG98 X1\nG99 X1\nG151\nM80 X4\nM150\nM901 601\nM902 601\nM910",
        ["NOT G41", "NOT G93", "NOT G96", "NOT G98", "NOT G99", "NOT G151", "NOT M80",
         "NOT M150", "NOT M901", "NOT M902", "NOT M910"],
    ),
    "loops and choices (7, 8)": (
        "$for CI600:=1 to 3 do begin\nG00 X(CI600)\n$end;\n$repeat begin\nM08\n$end until (CI600 > 2);\n"
        "$while (CI600 < 5) do begin\nCI600 := CI600 + 1\n$end;\n$if (X.digib.5) then begin\nM08\n$end else begin\n"
        "M09\n$end",
        ["for CI600 = 1 to 3 {rapid x(CI600)}", "first while ((CI600 > 2) == 0) {flood on}",
         "while (CI600 < 5) {CI600 := (CI600 + 1)}", "if input 105 {flood on} else {mist off flood off}"],
    ),
    "texts (5.7)": ('WRITE "at " CD601\nWRITELN " mm"\nWRITE "b"\nM08\nWRITELN "c"', [
        "text 'at ' CD601 ' mm'", "NOT WRITE", "flood on", "text 'c'"]),
    "what the controller holds (11, 12)": ("CI2 := 1\nG00 X(X.tp)\nCD600 := CI59", [
        "NOT CI2", "NOT X.TP", "NOT CI59"]),
    "comments (6)": ("G00 X1 (one)\n' two\nM08 ' three", ["rapid x1", "'one'", "'two'", "flood on", "'three'"]),
}  # fmt: skip
"""By what it is about: lines, what they say."""


@pytest.mark.parametrize("about", STATED)
def test_lines(about: str, tmp_path: Path) -> None:
    lines, expected = STATED[about]
    assert words(tmp_path, lines) == expected


def test_planes_with_a_tool_table(tmp_path: Path) -> None:
    """Arcs of Z-X and Y-Z have the centre words of DIN 66025 (2.7, 3.7, 3.8)."""
    tools = (RadiusTool(plane="xy", number=1, radius=2.0, length=0.0),)
    lines = "F9\nG18\nG02 X1 Z2 I3 K4\nG19\nG03 Y1 Z2 J3 K4\nG03 Y1 Z2 I3 K4"
    expected = ["F9", "cw xz x1 z2 about x+3 z+4", "ccw yz y1 z2 about y+3 z+4", "NOT I in G3"]
    assert words(tmp_path, lines, on(tools=tools)) == expected
    lines = "T1\nG41\nG01 X1 F5\nG42\nG40\nG40"
    assert words(tmp_path, lines, on(tools=tools)) == ["tool 1 selected", "correct left", "feed x1 F5", "NOT G42",
                                                       "correct off"]  # fmt: skip
    long = (RadiusTool(plane="xy", number=1, radius=2.0, length=10.0),)
    assert words(tmp_path, "T1", on(tools=long)) == ["NOT T"]


def test_what_the_machine_file_says(tmp_path: Path) -> None:
    """Time unit (5.3), unit at the start (3.22), centres (3.3), what wt counts (10), the tool change (5.5)."""
    assert words(tmp_path, "G01 X1 F2\nG94\nX2 F3", on(time_unit=1.0)) == [
        "feed x1 F120", "NOT axis words alone"]  # fmt: skip
    assert words(tmp_path, "G01 X1 F2\nG94\nG01 X2\nG01 X3 F3", on(time_unit=1.0)) == [
        "feed x1 F120", "NOT the feed in force", "feed x3 F3"]  # fmt: skip
    assert words(tmp_path, "G00 X1\nG01 X1 F2", on(time_unit=None)) == ["rapid x1", "NOT F"]
    assert words(tmp_path, "G01 X1 F2\nG00 X3", on(position_unit=25.4)) == ["feed x1inch F2inch", "rapid x3"]
    assert words(tmp_path, "F1\nG02 X1 Y1 I1 J0", on(absolute_centers=True)) == ["F1", "cw xy x1 y1 about x=1 y=0"]
    assert words(tmp_path, "F1\nG02 X1 Y1 I1 J0", on(absolute_centers=None))[1:] == ["NOT the centre of an arc in G90"]
    assert words(tmp_path, "$wt(2);", on(wait_unit=1.0)) == ["dwell 2s"]
    assert words(tmp_path, "T2", on(tasks=(TaskCode(code="T", action="tool_change"),))) == ["tool 2 changed"]
    assert words(tmp_path, "T2\nM06\nM03\nS5", on(tasks=())) == [
        "NOT T", "NOT M6", "spindle cw", "spindle speed 5rpm"]  # fmt: skip
    assert words(tmp_path, "G55", on(interpolation_axes="XY")) == ["select 2 of x y"]
    assert words(tmp_path, "G60 X Y Z\nG01 Z1 F5\nG60 X", on(interpolation_axes="XY")) == [
        "feed z1 F5", "NOT G60 after moves"]  # fmt: skip
    old = on(version="2.5.3.32")
    assert words(tmp_path, "G01 X1 F5\nG91\nG01 X1", old) == ["feed x1 F5", "feed x+1"]


def test_rotary_axes(tmp_path: Path) -> None:
    """Degrees in G00; in G01 how F counts is open (3.17)."""
    lines = "G00 C90\nG01 C180 F5\nG51 C40"
    assert words(tmp_path, lines, on(NO_MCUWIN.axes)) == ["rapid c90deg", "NOT C in G1", "NOT G51"]


def test_subprogram_in_two_states_is_two_routines(tmp_path: Path) -> None:
    """``G01 X5`` is a place for one call and a distance for the other (3.24, 4.16)."""
    text = "%A\nG90\nM98 L20\nG91\nM98 L20 O3\nM98 L20\nM30\n%\n%20\nG01 X5 F7\nM17\n%\n"
    job = raised(tmp_path, text)
    assert words_of(job.body) == ["run 20", "run 20~2 3 times", "run 20~2", "end reset"]
    assert {name: words_of(routine.body) for name, routine in job.routines.items()} == {
        "20": ["feed x5 F7", "leave"], "20~2": ["feed x+5 F7", "leave"],
    }  # fmt: skip


def test_procedure(tmp_path: Path) -> None:
    """Parameters are variables that the call gives values; what a var parameter becomes goes back (10, 12)."""
    text = (
        "$DINEND\nvar depth : double;\nprocedure deeper(by : double; var z : double);\nbegin\nz := z - by;\nend;\n"
        "{$DINSTART}\n%A\ndepth := 1\n$deeper(2, depth);\nG00 Z(depth)\nM30\n%\n"
    )
    job = raised(tmp_path, text)
    assert words_of(job.body) == [
        "depth := 1", "run deeper with by = 2 z = depth", "depth := z", "rapid z(depth)", "end reset",
    ]  # fmt: skip
    (routine,) = job.routines.values()
    assert [one.name for one in routine.parameters] == ["by", "z"]
    assert words_of(routine.body) == ["z := (z - by)"]


def test_mode_is_unknown_after_a_choice(tmp_path: Path) -> None:
    lines = "$if (CI600 < 5) then begin\nG91\n$end\nG01 X1 F5\nG90\nG01 X2"
    assert words(tmp_path, lines)[1:] == ["NOT axis words", "feed x2"]


def test_a_centre_left_open_counts_only_where_a_word_is_missing(tmp_path: Path) -> None:
    """J is not 0 on one way of the choice: an arc with both words is that arc, one without J is open."""
    way = "G01 X10 Y0 F100\n$if E5.1 then begin\nG02 X10 Y20 I0 J10\nG01 X10 Y0\n$end;\n"
    assert words(tmp_path, f"{way}G02 X12 Y0 I1 J0")[-1] == "cw xy x12 y0 about x+1 y+0"
    assert words(tmp_path, f"{way}G02 X12 Y0 I1")[-1].startswith("NOT an arc without J")


def test_mode_is_unknown_after_a_jump(tmp_path: Path) -> None:
    """The label is reached in G90 from above and in G91 by the jump (4.15)."""
    lines = "G90\nL10\nG01 X1 F5\nG91\n$if (CI600 < 5) then begin\nM96 L10\n$end"
    assert words(tmp_path, lines) == ["mark 10", "NOT axis words", "if (CI600 < 5) {goto 10}"]
    lines = "G90\nL10\nG01 X1 F5\n$if (CI600 < 5) then begin\nM96 L10\n$end"
    assert words(tmp_path, lines) == ["mark 10", "feed x1 F5", "if (CI600 < 5) {goto 10}"]


def test_the_end_of_a_module(tmp_path: Path) -> None:
    """Without M02, M30 or M17: error 190; before 2.5.3.90 a program ended so (14)."""
    text = "%A\nG00 X1\n"
    assert words_of(raised(tmp_path, text).body) == ["rapid x1", "NOT the end of a module"]
    assert words_of(raised(tmp_path, text, on(version="2.5.3.32")).body) == ["rapid x1", "end"]


def test_long_files_are_tables(tmp_path: Path) -> None:
    """A run of plain lines is one table, whatever G00 counts in, and its centres count from the starts."""
    lines = "G161\nG00 X0 Y0\nG01 X1 F60\n" + "G02 X3 Y0 I2 J0\nG01 X1 Y0\n" * 500
    job = raised(tmp_path, f"%A\n{lines}M30\n%\n")
    tables = [node for node in job.body if isinstance(node, Moves)]
    assert sum(len(table.rows) for table in tables) == 1002
    assert len(tables) == 1
    assert not [node for node in job.body if isinstance(node, ArcTo)]
    assert words_of(job.body)[2:4] == ["cw xy x3 y0 about x+1 y+0", "feed x1 y0"]


def _safe_jobs() -> list[Path]:
    found = []
    for page in sorted((ROOT / "corpus" / "mcuwin").glob("*/expect.toml")):
        for name, entry in tomllib.loads(page.read_text("utf-8")).items():
            if isinstance(entry, dict) and entry.get("verdict") == "SAFE":
                found.append(page.parent / "jobs" / f"{name}.src")
    return found


REFUSED = {
    "engraver/between-clamps": {"G98", "G99"},
    "engraver/wave": {"M210", "X.TP"},
    "dispenser/lid-bead": {"M210", "M211"},
    "portal/left-and-right": {"a place of X under a reflection"},
    "portal/mirrored-in-the-vice": {"a place of X under a reflection"},
    "portal/next-part": {"M902", "M904"},
    "rotary-mill/band": {"G51", "C in G1"},
    "rotary-mill/old-counter": {"M901", "M902"},
}
"""Jobs of the corpus with what no other controller has, or the manual leaves open."""


@pytest.mark.parametrize("path", _safe_jobs(), ids=lambda path: f"{path.parent.parent.name}/{path.stem}")
def test_corpus(path: Path) -> None:
    session = open_session(path, machine=path.parent.parent / "machine.toml", setup="zero", dialect="mcuwin")
    assert session.program is not None
    raising = DIALECTS["mcuwin"].frontend.raise_program
    assert raising is not None
    job = raising(session.program, session.machine)
    job.verify()
    printed = print_ir(job)
    assert print_ir(parse_ir(printed)) == printed
    bodies = (job.body, *(routine.body for routine in job.routines.values()))
    refused = {node.construct for body in bodies for node in walk(body) if isinstance(node, NotRaised)}
    assert refused == REFUSED.get(f"{path.parent.parent.name}/{path.stem}", set())
