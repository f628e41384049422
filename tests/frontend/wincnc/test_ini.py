"""WINCNC.INI by hand from the manual, "System Configuration"."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.each import each

from gproof.driver.dialects import load_machine
from gproof.frontend.wincnc.ini_check import columns_of
from gproof.frontend.wincnc.ini_file import without_comments
from gproof.frontend.wincnc.ini_keys import KEYS
from gproof.ir.dialects.wincnc.keys import KEYS as NAMED
from gproof.ir.dialects.wincnc.settings import (
    Changer,
    DrillSettings,
    Lexical,
    MeasureSwitch,
    WinCncSettings,
    wincnc_settings,
)
from gproof.ir.finding import Finding, Findings
from gproof.ir.machine import Axis, AxisKind, Machine, Slave
from gproof.ir.settings import HomingLine, KnifeMode, SawMode, TorchControl, Workspace
from gproof.ir.text import parse_ir, print_ir

ROUTER = """\
unit=IN
timertype=7200

[Axis Labels]
axischar=XYZW
[X Axis: rack and pinion
axisspec = p0 s0 d0 r818.5 a400 f300 t1
axisvel = r600 f100 s50 m200 h450
axislo = p2 b6 o1 [low switch]
axishi=p2b7o1
[Y Axis, two motors]
AxisSpec=P0S1D1 R818.5 A400 [smooth] B.002
altaxisspec=p0 s4 d4 o0
axisvel=r600f100
[axishi=p3b1o0]
axisspec = p0 s2 d2 r400 a200
"""
BASE = """\
unit=mm
axischar=XYZWC
axisspec=p0s0d0r100a6000
axisvel=r6000f1200
axisspec=p0s1d1r100a6000
axisvel=r6000f1200
axisspec=p0s2d2r200a3000
axisvel=r3000f600
axisspec=p0s3d3r200a3000
axisvel=r3000f600
axisspec=p0s4d4r50a3000
axisvel=r7200f3600
"""
"""Five axes in millimetres: 100 units a second for X and Y, 50 for Z and W, C turns 120 degrees a second."""


def load(text: str | bytes, tmp_path: Path) -> tuple[Machine | None, list[Finding]]:
    path = tmp_path / "WINCNC.INI"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    findings = Findings()
    machine, files = load_machine(path, findings)
    assert [name for name, _ in files] == [str(path)]
    return machine, findings.kept


def machine_of(text: str | bytes, tmp_path: Path) -> Machine:
    machine, kept = load(text, tmp_path)
    assert kept == []
    assert machine is not None
    assert parse_ir(print_ir(machine)) == machine
    return machine


def controls_of(lines: str, tmp_path: Path) -> WinCncSettings:
    return wincnc_settings(machine_of(BASE + lines, tmp_path))


def axis(machine: Machine, name: str) -> Axis:
    found = machine.axis(name)
    assert found is not None
    return found


def places(kept: list[Finding]) -> list[tuple[str, int, int, int]]:
    return [(f.code.label, f.span.line, f.span.column, f.span.end_column) for f in kept]


# -- axes


def test_axes_of_a_router_in_inches(tmp_path: Path) -> None:
    text = ROUTER + "axisvel=r250f50\naxisspec=p0s3d3r400a200\naxisvel=r250f50\n"
    machine = machine_of(text + "lolim=x0y-.1\nhilim=x48 y96.1 z0w0\nlobound=z0w0 x.5\nhibound=x47.5\n", tmp_path)
    assert machine.unit == 25.4
    assert machine.controller.dialect == "wincnc"
    assert [a.name for a in machine.axes] == ["x", "y", "z", "a"]
    x, y, z, w = machine.axes
    # 818.5 steps an inch are 818.5 / 25.4 a millimetre; 600 inches a minute 254 mm/s.
    assert x.steps_per_unit == Fraction(8185, 254)
    assert x.max_velocity == pytest.approx(254.0)
    assert x.feed_velocity == pytest.approx(100 * 25.4 / 60)
    # The lower one of A and F: 300 inches a minute a second.
    assert x.max_acceleration == pytest.approx(127.0)
    assert y.max_acceleration == pytest.approx(400 * 25.4 / 60)
    assert (x.lower, x.upper) == (0.0, pytest.approx(1219.2))
    assert (x.boundary_lower, x.boundary_upper) == (pytest.approx(12.7), pytest.approx(1206.5))
    assert (y.lower, y.upper, y.boundary_lower) == (pytest.approx(-2.54), pytest.approx(96.1 * 25.4), None)
    assert y.backlash == pytest.approx(0.0508)
    assert y.slaves == (Slave(joint="P0 S4 D4"),)
    # Heads have no lower limit: nothing is known of it.
    assert (z.lower, z.upper, z.boundary_lower) == (None, 0.0, 0.0)
    assert (z.vertical, w.vertical, x.vertical) == (True, True, False)
    assert (w.letter, w.word, w.kind) == ("W", "W", AxisKind.LINEAR)
    assert all(a.home_place == 0.0 for a in machine.axes)
    assert wincnc_settings(machine).axis_order == "xyza"
    assert ("axislo", "p2 b6 o1") in machine.kept


def test_kinds_and_units_of_axes(tmp_path: Path) -> None:
    machine = machine_of(BASE, tmp_path)
    c = axis(machine, "c")
    # A, B and C turn without T4: steps a degree, degrees a minute.
    assert (c.kind, c.steps_per_unit, c.max_velocity, c.max_acceleration) == (AxisKind.ROTARY, 50, 120.0, 50.0)
    assert c.vertical is False
    text = BASE.replace("s4d4r50", "s4d4r50t3").replace("s3d3r200", "s3d3r200t4")
    machine = machine_of(text, tmp_path)
    assert (axis(machine, "c").kind, axis(machine, "c").vertical) == (AxisKind.LINEAR, True)
    assert (axis(machine, "a").kind, axis(machine, "a").vertical) == (AxisKind.ROTARY, False)


@pytest.mark.parametrize(
    ("letters", "columns"),
    [
        ("XY", "xy"), ("XYZ", "xyz"), ("XYZW", "xyza"), ("XYZWUV", "xyzabc"), ("XYZAW", "xyzab"),
        ("XYZWA", "xyzba"), ("XYZWUC", "xyzabc"), ("XYWC", "xyac"), ("XYZCBA", "xyzcba"),
    ],
)  # fmt: skip
def test_columns_of_letters(letters: str, columns: str) -> None:
    assert columns_of(letters) == (dict(zip(letters, columns, strict=True)), "")


@pytest.mark.parametrize(
    ("value", "what"),
    [
        ("YXZ", "the first axis must be X and the second Y"), ("X", "the first axis must be X and the second Y"),
        ("XYQ", "'Q' is not an axis"), ("XYZZ", "Z is given twice"), ("XYZWUAB", "is one too many"),
    ],
)  # fmt: skip
def test_letters_that_can_be_no_axes(value: str, what: str, tmp_path: Path) -> None:
    machine, kept = load(f"axischar={value}\n", tmp_path)
    assert machine is None
    assert kept[0].code.label == "GP603"
    assert what in kept[0].message
    assert (kept[0].span.line, kept[0].span.column) == (1, 10)


def test_axes_without_settings_and_settings_without_axes(tmp_path: Path) -> None:
    machine, kept = load("axischar=XYZ\naxisspec=r1a1\naxisspec=r1a1\n", tmp_path)
    assert [(*places([f])[0], f.message) for f in kept] == [
        ("GP604", 1, 10, 13, "axisspec= of Z, axis number 2, is missing")
    ]
    assert machine is not None
    assert kept[0].severity.value == "note"
    # The letter keeps its number; a job that moves the axis is refused: tests/driver/test_open_settings.py.
    assert [one.name for one in machine.axes] == ["x", "y"]
    _, kept = load("axischar=XY\naxisspec=r1a1\naxisspec=r1a1\naxisspec=r1a1\n", tmp_path)
    assert places(kept) == [("GP603", 4, 10, 14)]
    _, kept = load("axischar=XY\naxisvel=r1\naxisspec=r1a1\naxisspec=r1a1\n", tmp_path)
    assert places(kept) == [("GP603", 2, 9, 11)]
    _, kept = load("axisspec=r1a1\naxischar=XY\naxisspec=r1a1\n", tmp_path)
    assert ("GP603", 2, 10, 12) in places(kept)
    _, kept = load("[nothing]\n", tmp_path)
    assert [(f.code.label, f.message) for f in kept] == [("GP604", "axischar= is missing")]


def test_backlash_counts_unless_it_is_switched_off(tmp_path: Path) -> None:
    text = BASE.replace("s0d0r100", "s0d0r100b.03")
    assert axis(machine_of(text, tmp_path), "x").backlash == 0.03
    assert axis(machine_of(text + "backlash=b1 f100\n", tmp_path), "x").backlash == 0.03
    assert axis(machine_of(text + "backlash=b0\n", tmp_path), "x").backlash == 0.0


def test_places_behind_homing(tmp_path: Path) -> None:
    machine = machine_of(BASE + "g28coord=x-5z100\ng28move=z-2w-2f600t60r5\ng28move=x10y-10f1200m1l2000\n", tmp_path)
    assert [a.home_place for a in machine.axes] == [-5.0, 0.0, 100.0, 0.0, 0.0]
    assert machine.settings.homing == (
        HomingLine(distances=(("z", -2.0), ("a", -2.0)), retreat=5.0, feed=10.0, second_feed=1.0),
        HomingLine(distances=(("x", 10.0), ("y", -10.0)), feed=20.0, longest=2000.0, singly=True),
    )
    # Away from the switch at the end means towards it before: up for Z, down for X, up for Y.
    assert [a.home_velocity for a in machine.axes] == [-20.0, 20.0, 10.0, 10.0, None]


@pytest.mark.parametrize(
    ("lines", "place"),
    [
        ("lolim=x10\nhilim=x5\n", ("GP603", 14, 7, 9)),
        ("lobound=x10\nhibound=y1 x5\n", ("GP603", 14, 12, 14)),
        ("lolim=x\n", ("GP603", 13, 7, 8)),
        ("lolim=x 1,5\n", ("GP603", 13, 10, 11)),
        ("lolim=x1x2\n", ("GP603", 13, 9, 11)),
        ("lolim=x1\nhilim=x9\nlolim=x2\n", ("GP603", 15, 7, 9)),
    ],
)
def test_bad_limits_are_told_at_their_place(lines: str, place: tuple[str, int, int, int], tmp_path: Path) -> None:
    machine, kept = load(BASE + lines, tmp_path)
    assert machine is None
    assert places(kept) == [place]


@pytest.mark.parametrize("old", ["r100", "a6000", "r6000"])
def test_steps_and_velocities_are_greater_than_0(old: str, tmp_path: Path) -> None:
    machine, kept = load(BASE.replace(old, old[0] + "0", 1), tmp_path)
    assert machine is None
    assert [f.code.label for f in kept] == ["GP603"]


def test_an_acceleration_that_the_controller_can_not_count(tmp_path: Path) -> None:
    # 3000 units a minute a second are 50 a second: times 1400 steps 70000, more than 65535.
    machine, kept = load(BASE.replace("s2d2r200", "s2d2r1400"), tmp_path)
    assert machine is not None
    assert [f.code.label for f in kept] == ["GP606"]


# -- the file


@pytest.mark.parametrize(("name", "mm"), [("IN", 25.4), ("cm", 10.0), ("Mm", 1.0)])
def test_unit(name: str, mm: float, tmp_path: Path) -> None:
    assert machine_of(BASE.replace("unit=mm", f"unit = {name} [unit]"), tmp_path).unit == mm


def test_without_a_unit_the_file_is_in_inches(tmp_path: Path) -> None:
    assert machine_of(BASE.removeprefix("unit=mm\n"), tmp_path).unit == 25.4


def test_the_unit_is_the_first_setting(tmp_path: Path) -> None:
    assert machine_of("\n[shop]\n" + BASE, tmp_path).unit == 1.0
    machine, kept = load("timertype=7200\n" + BASE, tmp_path)
    assert machine is None
    assert places(kept) == [("GP603", 2, 6, 8)]
    machine, kept = load(BASE.replace("=mm", "=feet"), tmp_path)
    assert places(kept) == [("GP603", 1, 6, 10)]


def test_comments_anywhere(tmp_path: Path) -> None:
    plain = machine_of(BASE + "softlim=t1b1\n", tmp_path)
    text = BASE.replace("\n", " [x] \n").replace("a6000", "[why] A [fast] 6000")
    assert machine_of(text + "[a]softlim[b]=[c]t[d]1[e]b 1[f\n[softlim=t0\n", tmp_path) == plain


def test_brackets_in_quotes_and_quotes_in_brackets() -> None:
    assert without_comments('auxin=m"a [b]" [c') == 'auxin=m"a [b]"   '
    assert without_comments('a=1 [3" tool] b') == "a=1           b"
    assert without_comments("m“[x]”[y]") == "m“[x]”   "


@pytest.mark.parametrize(
    ("line", "place"),
    [
        ("softlim t1", ("GP601", 13, 1, 11)),
        ("  = 5", ("GP601", 13, 3, 6)),
        ("; softlim=t1", ("GP601", 13, 1, 13)),
        ("softlim=t1 \x01", ("GP601", 13, 12, 13)),
        ("softlim=t", ("GP603", 13, 9, 10)),
        ("softlim=t1;", ("GP603", 13, 11, 12)),
        ("softlim=t3", ("GP603", 13, 9, 11)),
        ("softlim=t1.5", ("GP603", 13, 9, 13)),
        ("softlim=t1 [a] ]", ("GP603", 13, 16, 17)),
        ('auxin=c1 m"open', ("GP603", 13, 11, 12)),
        ("auxin=c1 m5", ("GP603", 13, 10, 12)),
        ('auxin=c"1"', ("GP603", 13, 7, 11)),
        ("auxin=p1", ("GP603", 13, 7, 9)),
        ("auxin=c65", ("GP603", 13, 7, 10)),
        ("auxin=c0", ("GP603", 13, 7, 9)),
        ("nmode=95", ("GP603", 13, 7, 9)),
        ("nmode=", ("GP603", 13, 1, 6)),
        ("arc_err=-1", ("GP603", 13, 9, 11)),
        ("arc_err=a", ("GP603", 13, 9, 10)),
        ("timertype=7100", ("GP603", 13, 11, 15)),
        ("knifemode=n7", ("GP603", 13, 11, 13)),
        ("knifemode=a5", ("GP603", 13, 11, 13)),
        ("sawmode=t1", ("GP603", 13, 9, 11)),
        ("g54=t2", ("GP603", 13, 5, 7)),
        ("vgroup=xq", ("GP603", 13, 8, 10)),
        ("vgroup=xx", ("GP603", 13, 8, 10)),
        ("skipchars=c5", ("GP603", 13, 11, 13)),
        ("skipchars=n5", ("GP603", 13, 11, 13)),
        ("override=l120h90", ("GP603", 13, 10, 14)),
        ("override=l90h90", ("GP603", 13, 10, 13)),
        ("scan=t2a2", ("GP603", 13, 6, 10)),
        ("spindle=r0", ("GP603", 13, 9, 11)),
        ("drillbank=n4", ("GP603", 13, 11, 13)),
        ("portin=x", ("GP603", 13, 8, 9)),
        ("lolim=x99999999999999", ("GP603", 13, 7, 8)),
        ("unti=5", ("GP602", 13, 1, 5)),
        ("anykey=q5", ("GP602", 13, 8, 10)),
        ("lolim=u5", ("GP602", 13, 7, 9)),
        ("vgroup=xu", ("GP602", 13, 1, 7)),
    ],
)
def test_mistakes_are_told_at_line_and_column(line: str, place: tuple[str, int, int, int], tmp_path: Path) -> None:
    machine, kept = load(BASE + line + "\n", tmp_path)
    assert places(kept) == [place]
    assert (machine is None) == (place[0] != "GP602")


def test_all_mistakes_are_told_at_once(tmp_path: Path) -> None:
    _, kept = load(BASE + "nmode=1\nbogus=2\nlolim=x\n", tmp_path)
    assert [f.span.line for f in kept] == [13, 14, 15]


@pytest.mark.parametrize(
    ("first", "second"),
    [("nmode=90", "nmode=91"), ("softlim=t1", "softlim=1b1"), ("axisvel=r6000f1300", ""), ("atc1=h1", "ATC1=h2"),
     ("auxin=c1p0", "auxin=c1p1"), ("vgroup=fxy", "vgroup=fx"), ("vgroup=xy", "vgroup=yz")],
)  # fmt: skip
def test_a_key_given_twice_with_two_values(first: str, second: str, tmp_path: Path) -> None:
    text = BASE.replace("axisvel=r6000f1200\n", f"axisvel=r6000f1200\n{first}\n", 1) if not second else BASE + first
    machine, kept = load(f"{text}\n{second}\n", tmp_path)
    assert machine is None
    assert [f.code.label for f in kept] == ["GP603"]


def test_a_key_given_twice_with_one_value(tmp_path: Path) -> None:
    once = machine_of(BASE + "softlim=t1\nvgroup=xy\n", tmp_path)
    assert machine_of(BASE + "softlim=t1\nSOFTLIM=1.0\nvgroup=xy\nvgroup=y x\n", tmp_path) == once


def test_no_text(tmp_path: Path) -> None:
    for data in (b"axischar=XY\0", "axischar=XY".encode("utf-16")):
        machine, kept = load(data, tmp_path)
        assert machine is None
        assert [f.code.label for f in kept] == ["GP601"]
    findings = Findings()
    assert load_machine(tmp_path / "none" / "WINCNC.INI", findings) == (None, [])
    assert [f.code.label for f in findings.kept] == ["GP601"]


def test_windows_1252_a_mark_and_a_dos_end(tmp_path: Path) -> None:
    text = BASE.replace("\n", "\r\n").encode() + b"[f\xfcr T\xfcr]\r\nauxin=c1m\x93T\xfcr offen\x94\r\n\x1a"
    assert machine_of(b"\xef\xbb\xbf" + BASE.encode(), tmp_path) == machine_of(BASE, tmp_path)
    assert wincnc_settings(machine_of(text, tmp_path)).inputs == (1,)


def test_which_ini_files_are_of_this_controller(tmp_path: Path) -> None:
    def dialect(name: str, text: str) -> str | None:
        path = tmp_path / name
        path.write_text(text)
        machine, _ = load_machine(path, Findings())
        return machine.controller.dialect if machine else None

    assert dialect("wincnc.ini", BASE) == "wincnc"
    assert dialect("router.ini", BASE) == "wincnc"
    assert dialect("cnc.ini", "[JOINT_0]\nresolution=1\n[JOINT_1]\n") == "eding"


# -- the other settings


def test_what_is_not_stated(tmp_path: Path) -> None:
    controls = controls_of("", tmp_path)
    assert controls == WinCncSettings(
        arc_tolerance=0.01, smallest_arc=0.002, inputs=(), outputs=(), devices=(), axis_order="xyzac",
        highest_channel=64,
    )  # fmt: skip
    machine = machine_of(BASE, tmp_path)
    assert machine.controller.max_step_frequency == 30000
    assert (machine.board.step_pulse, machine.board.direction_setup) == (5e-6, 5e-6)
    assert not machine.controller.absolute_arc_centers


def test_arc_settings_are_in_the_unit_of_the_file(tmp_path: Path) -> None:
    inches = BASE.replace("unit=mm", "unit=in")
    controls = wincnc_settings(machine_of(inches, tmp_path))
    assert (controls.arc_tolerance, controls.smallest_arc) == (pytest.approx(0.254), pytest.approx(0.0508))
    controls = wincnc_settings(machine_of(inches + "arc_err=.02\narc_min=0\n", tmp_path))
    assert (controls.arc_tolerance, controls.smallest_arc) == (pytest.approx(0.508), 0.0)


@pytest.mark.parametrize(
    ("line", "values"),
    [
        ("nmode=90", {"absolute": True}),
        ("nmode=91", {"absolute": False}),
        ("g2modal=1", {"arcs_modal": True}),
        ("arcs=m1a0", {"arcs_modal": True}),
        ("arctype=i0m1", {"arcs_modal": True}),
        ("softlim=1", {"soft_limits": True}),
        ("softlim=m1", {"soft_limits": True}),
        ("softlim=t0", {"soft_limits": False, "limits_available": False}),
        ("softlim=t2b1v1", {"soft_limits": False, "adjust_boundary": True, "adjust_vertical": True}),
        ("vgroup=fxy\nvgroup=x Y\nvgroup=z\nvgroup=W", {"feed_groups": ("xy", "z", "a"), "command_group": "xy"}),
        ("forcelim=x-2", {"forced": ((-2.0, None), (-1.0, None))}),
        ("comchars=;'!;", {"lexical": Lexical(comment_signs=";'!")}),
        ("comchars=[(%;  [and these]", {"lexical": Lexical(comment_signs=";")}),
        ("comchars = [", {}),
        ("comchars=[(%", {}),
        ("comchars=[none]", {}),
        ("comchars [x]=;[since May] '", {"lexical": Lexical(comment_signs=";'")}),
        ('skipchars=c"[%" n10', {"lexical": Lexical(skips=(("[%", 10),))}),
        ('skipchars=c"#%" n10', {"lexical": Lexical(skips=(("#%", 10),))}),
        ("commatodec=1", {"lexical": Lexical(comma=True)}),
        ("cmdstart=M98 Start.tap [on]", {"start": "M98 Start.tap"}),
        ("cmdend=M12C1\ncmdabort=M12 C2", {"end": "M12C1", "abort": "M12 C2"}),
        ("auxin=c2p0b1\nauxin=c1p0b0f1\nauxout=c64", {"inputs": (1, 2), "outputs": (64,)}),
        ("drillbank=c4n9", {"drill_banks": ((4, 9),), "devices": ("drillbank",)}),
        ("positions=p30h30t20w1", {"positions": 30, "homes": 30, "tool_positions": 20}),
        ("g54=\ng55=x100y-2.5t0m1", {
            "workspaces": (Workspace(number=54), Workspace(number=55, x=100.0, y=-2.5, moves=True))}),
        ("g56=t3r60o90m0", {"workspaces": (Workspace(number=56, kind=3, radius=60.0, offset=90.0, moves=False),)}),
        ("atc1=h-50o3z-80a3m1", {"changers": (
            Changer(number=1, height=-50.0, sensor=3.0, spindle_height=-80.0, axis="a", in_library=True),)}),
        ("atc2=h5", {"changers": (Changer(number=2, height=5.0),)}),
        ("g37=x1y2i3j4d5f600", {"measure": MeasureSwitch(x=1.0, y=2.0, i=3.0, j=4.0, descent=5.0, feed=10.0)}),
        ("g81set=d.5r2l3\ng81dwell=.25", {"drill": DrillSettings(dwell=0.5, other_dwell=0.25, approach=2.0, lift=3.0)}),
        ("autoaux=c3i1s.5e.2t1", {"auto_output": 3, "auto_output_on": True, "auto_dwell": (0.5, 0.2),
                                  "auto_pausing": False, "devices": ("autoaux",)}),
        ("cutcomp=t1d-1", {"compensation_entry": True, "compensation_swapped": True}),
        ("override=e0l20h120", {"override": (20.0, 120.0), "override_enabled": False}),
        ("knifemode=n4a15l2z20p-3c5d.3m1r0", {"devices": ("knife",), "knife": KnifeMode(
            axis="c", angle=15.0, blend=2.0, lifted=20.0, lowered=-3.0, vertical="", output=5, dwell=0.3,
            automatic=True, lifts_in_arcs=False)}),
        ("knifemode=n4t1v3\nknifeangle=a30m1x1y-2", {"devices": ("knife",), "knife": KnifeMode(
            axis="c", target=True, vertical="a", blade=30.0, both_ways=True, x=1.0, y=-2.0)}),
        ("sawmode=t1a4r150o-90z10", {"devices": ("saw",), "saw": SawMode(
            axis="c", radius=150.0, offset=-90.0, lift=10.0)}),
        ("thc=a2f600v120s.5e.2p95o4i5d1l10", {"devices": ("thc",), "torch": TorchControl(
            axis="z", feed=10.0, output=4, input=5, start_delay=0.5, end_delay=0.2, compression=1.0, lift=10.0)}),
        ("scan=t2a3c8", {"devices": ("probe",), "probe_input": 8, "probe_axis": "a"}),
        ("laser=p50a0b1\nda=t1v10\npumpcont=t0\nspindle=t1r18000", {"devices": ("laser", "pump", "da", "spindle")}),
        ("torchbevel=b3c4r100", {"devices": ("bevel",)}),
        ("accel=s50", {"smoothing": True}),
        ("g08=e1", {"smoothing": True}),
        ("g08=e0", {}),
        ("g09=s40a20", {"smoothing": True}),
        ("g09=40", {"smoothing": True}),
        ("vmatch=p.95t2", {"smoothing": True}),
        ("autoarcfeed=f30m100", {"smoothing": True}),
    ],
)  # fmt: skip
def test_a_setting(line: str, values: dict[str, object], tmp_path: Path) -> None:
    assert controls_of(line + "\n", tmp_path) == replace(controls_of("", tmp_path), **values)


def test_lowest_velocity_in_corners(tmp_path: Path) -> None:
    assert machine_of(BASE.replace("f1200", "f1200c60"), tmp_path).settings.smoothing
    assert not machine_of(BASE.replace("f1200", "f1200c0"), tmp_path).settings.smoothing


def test_settings_of_the_controller_and_the_board(tmp_path: Path) -> None:
    machine = machine_of(BASE + "maxstepv=50000\nsteppulse=p4d8\narcs=a1\nspindle=t1r18000i0\n", tmp_path)
    assert machine.controller.max_step_frequency == 50000
    assert machine.controller.absolute_arc_centers
    assert (machine.board.step_pulse, machine.board.direction_setup) == (4e-6, 8e-6)
    assert [(s.number, s.max_rpm) for s in machine.spindles] == [(0, 18000.0)]


def test_forced_limits_beside_low_limits_are_the_higher_reading(tmp_path: Path) -> None:
    # From the origin -1, from the low limit 5 - 1 = 4.
    assert controls_of("lolim=x5y-5\nforcelim=x-1y-1\n", tmp_path).forced == ((4.0, None), (-1.0, None))


@pytest.mark.parametrize(
    ("line", "what", "why", "axis"),
    [
        ("arctype=i.5", "arctype=i.5", "arcs are broken up", ""),
        ("arcs=m0\ng2modal=1", "g2modal=1", "says something else", ""),
        ("g54=x1q5", "g54= Q5", "this letter of the key", ""),
        ("g54=a5", "g54= A5", "does not say what A is", ""),
        ("spinchar=Q", "spinchar=Q", "sets the spindle", ""),
        ("comchars=;N", "comchars=;N", "starts a comment", ""),
        ("axismap=s0e100m10", "axismap=s0e100m10", "adjustments", ""),
        ("axismode=1", "axismode=1", "only the name", "c"),
        ("axisadj=t1", "axisadj=t1", "keys and inputs", "c"),
        ("axisadj=a2i1", "axisadj=a2i1", "keys and inputs", "z"),
    ],
)
def test_settings_that_are_not_followed(line: str, what: str, why: str, axis: str, tmp_path: Path) -> None:
    [found] = machine_of(BASE + line + "\n", tmp_path).not_modelled
    assert (found.what, found.axis, found.file) == (what, axis, "WINCNC.INI")
    assert why in found.why
    assert found.line == (BASE + line).count("\n") + 1


def test_two_axes_on_one_output_go_together(tmp_path: Path) -> None:
    found = machine_of(BASE.replace("p0s3d3", "p0s1d3"), tmp_path).not_modelled
    assert [(one.axis, one.line, one.why) for one in found] == [
        (axis, 9, "Y and W have the same step output") for axis in ("y", "a")
    ]
    # A second motor of its own axis may share its output.
    assert machine_of(BASE + "altaxisspec=s4d5\n", tmp_path).not_modelled == ()
    assert len(machine_of(BASE + "altaxisspec=s0d5\n", tmp_path).not_modelled) == 2


@pytest.mark.parametrize("line", ["axisadj=t1i0", "arctype=i0", "spinchar=s", "mapping=i.1r1", "g2modal=0\narcs=m0"])
def test_settings_that_are_off(line: str, tmp_path: Path) -> None:
    assert machine_of(BASE + line + "\n", tmp_path).not_modelled == ()


# -- every key

SAMPLES = {
    "unit": "MM", "timertype": "7200", "axischar": "X Y Z W C", "axisspec": "P0 S5 D5 R10 A10 F5 O1 E0 T3 B.1 K-3",
    "axisvel": "R10 F5 S1 M2 H3 A.5 C1", "axismode": "1", "axisadj": "T1 A2 V50 U3 D4 I0 B3 S5",
    "axismap": "S0 E100 M5", "altaxisspec": "P0 S4 D4 O1 E0", "axislo": "P3 B1 O1 A2 D5", "axishi": "P3B1O1A2D5",
    "altaxislo": "P3B1O1A2D5", "altaxishi": "P3B1O1A2D5", "exaltaxislo": "C1P3A2B1O1", "exaltaxishi": "C10P3A2B1O1",
    "accel": "S60", "ad": "L0 H5 X0 Y20 A1 B18", "anykey": "A1 P0", "arc_err": ".01", "arc_min": ".002",
    "arcs": "M0 A0", "arctype": "I0 M0 O1", "atc1": "H1 O2 Z3 A2 M0", "atc2": "H1 O2 Z3 A3 M1",
    "autoarcfeed": "F30 S.05 L10 M20 A5", "autoaux": "C2 I0 S.5 E.5 T0", "autodir": r"c:\shop\auto",
    "autofdir": r"c:\shop\done", "autogas": "T1 C3 B19200 N10 G20 D5", "automode": "2",
    "auxin": 'C1 P2 B3 O0 D20 F1 L201 I1 M"Air [low]" A"XY"', "auxout": "C1 P7 B1 O0 S0 E0 T2 X0 W1 R1",
    "auxoutvel": "80", "backlash": "B1 S2 F100", "bitmapdir": r"c:\shop\bmp", "bmpeditor": "paint.exe",
    "bmpend": "M12C1", "bmpstart": "m98 start.tap", "bmpoffset": "L1 H2 S10 F100", "btnoptions": "0",
    "cmdabort": "M12C1", "cmdend": "M12C1", "cmdrestart": "M98 again.tap", "cmdrestartfeed": "M11C1",
    "cmdrestartrapid": "M12C1", "cmdstart": "M11C1", "commatodec": "0", "comchars": ";'", "comdll": r"c:\shop\com.dll",
    "contdelay": "2.5", "cutcomp": "T0 D-1", **{f"ctrlf{n}": "G28" for n in range(1, 9)},
    "da": "T1 A0 V10 I0 C1 R250", "drillbank": "C10 N8", "editor": "write.exe",
    "enab": 'C1 M"Stop" T1 L201 I1 A"XYZ"', "esc_step": "200", "filetype": "*.tap;*.nc", "forcelim": "X-1 Y-1",
    "fslock": "1", "g08": "E1 L.05 N10 T5", "g09": "S40 A20", "g2modal": "0", "g28altmove": "X.01 Y0", "g28check": "1",
    "g28checktol": "X.01Y.01Z.01", "g28coord": "X0Y0Z0", "g28_lim_cnt": "3", "g28move": "X1 Y1 R.5 F100 T10 A1 M1 L99",
    "g37": "X1 Y2 I3 J4 D5 F6", **{f"g{n}": "X1 Y2 T0 R3 O4 M1" for n in range(54, 60)},
    "g81set": "D1 R.1 L.2", "g81dwell": ".5", "helpfile": r"c:\shop\help", "hibound": "X9Y9", "hilim": "X9Y9Z9W9",
    "homedir": r"c:\shop\homes", "keyfact": "4", "keypad": "C1 B9600 P4 S-2", "keypaddir": r"c:\shop\keypad",
    "knifeangle": "A-30 M1 X1 Y1", "knifemode": "T1 A15 L1 Z5 P-1 N4 C3 D.5 M1 R0 V2",
    "laser": "P50 D80 S1 M5 O2 A0 B1 R0", "laserscan": "S3 M0 U1 W4 A0 T1", "lim_cnt": "10", "lim_mode": "3",
    "lim_step": "100", "lobound": "Z0W0", "logdir": r"c:\shop\log", "logfile": r"c:\shop\log.csv", "lolim": "X-1Y-1",
    "mapping": "I.5 R1", "maxstepv": "50000", "maxtrans": "120", "numkp": "0", "nmode": "90",
    "override": "E1 L20 H150 D7 U8", "portin": "2, 0x379", "portout": "7,37A", "pci48h": "A15 B0", "pci24h": "A3",
    "positions": "P30 H30 T20 W1", "pumpcont": "T1 L10 H200 A5 B50 I20 R3", "pwm": "F75 M100", "quadmode": "1",
    "rapid_lock": "0", "rapidjog": "1", "restart": "V0", "sawmode": "T1 A4 R150 O90 Z10",
    "scan": "T2 A2 C8 S50 H.005 F30 P30 D0", "signal": 'C2 M"Go" T110 I1', "skipchars": 'C"#%" N10',
    "softlim": "T1 M1 B0 V0", "spinchar": "S", "spindle": "T1 R18000 I0", "steppulse": "P5 D5",
    "table": "X0 Y0 W48 H96 B1 Z2", "thc": "A2 F100 V120 S.5 E.2 P95 O3 I4 D.1 L1 T2 C10 W1 M2", "thcauto": "0",
    "thcdiv": "M50 B20", "thcdisab": "V30 T.5", "thclim": "L20 H350", "thcvel": "F200 V10", "torchbevel": "B3 C4 R5",
    "tranadj": ".01", "vgroup": "FXY", "vmatch": "P.9 T2", "watch": "T4 D50 C3", "xhc": "T1 D500 S200",
}  # fmt: skip
"""A value for each key of the manual."""


def test_the_table_has_the_keys_and_letters_of_the_manual() -> None:
    assert set(KEYS) == set(NAMED) == set(SAMPLES)
    for key, rule in KEYS.items():
        # A of g54= ... stands in "Workspace" only.
        assert set(rule.letters) - ({"A"} if key[:2] == "g5" else set()) == set(NAMED[key].letters), key
        assert rule.reason, key
        assert bool(rule.letters or rule.named.form == "axes" or rule.bare), key


@each("key", KEYS)
def test_every_key_is_read(key: str, tmp_path: Path) -> None:
    line = f"{key}={SAMPLES[key]}\n"
    if key in ("unit", "axischar", "axisspec", "axisvel"):
        old = next(one for one in BASE.splitlines() if one.startswith(f"{key}="))
        machine, kept = load(BASE.replace(old + "\n", line), tmp_path)
    else:
        machine, kept = load(BASE + line, tmp_path)
    assert kept == []
    assert machine is not None
    assert machine.unknown_keys == ()
    assert ((key, SAMPLES[key]) in machine.kept) == (KEYS[key].treatment in ("kept", "checked"))


@each("key", [key for key, rule in KEYS.items() if rule.letters])
def test_the_letters_of_a_key_in_any_form(key: str, tmp_path: Path) -> None:
    """Odd case, no blanks, a comment in the middle: the same machine."""
    words = SAMPLES[key]
    base = BASE.replace("axisvel=r7200f3600\n", "") if key == "axisvel" else BASE
    base = base.replace("axischar=XYZWC", "axischar=XYZWCA") if key == "axisspec" else base
    plain, _ = load(f"{base}{key}={words}\n", tmp_path)
    assert plain is not None
    quoted = '"' in words
    other = words if quoted else words.replace(" ", "").lower()
    odd, _ = load(f"{base} {key.title()}\t= [x]{other}[ y\n", tmp_path)
    assert odd is not None
    assert replace(odd, kept=(), not_modelled=()) == replace(plain, kept=(), not_modelled=())


# -- random files

_LINES = [line for line in BASE.splitlines() if line] + ["softlim=t1b1", "lolim=x-1y-2", "g55=x1y2t0m1", "vgroup=xy"]


@st.composite
def spelled(draw: st.DrawFn) -> str:
    """The same settings with other blanks, case, comments and disabled lines."""
    comment = st.sampled_from(["", " [c]", "[a=1 b2]", "\t[“]", "  "])
    lines = []
    for line in _LINES:
        key, _, value = line.partition("=")
        if draw(st.booleans()):
            key, value = key.upper(), value.upper()
        parts = [value]
        if key.lower() not in ("unit", "axischar", "vgroup"):
            at = [i for i, sign in enumerate(value) if sign.isalpha()][1:]
            cut = draw(st.sampled_from(at)) if at else 0
            parts = [value[:cut], value[cut:]]
        text = draw(comment).join(parts)
        lines.append(f"{draw(comment)}{key}{draw(comment)}={draw(comment)}{text}{draw(comment)}")
        if draw(st.booleans()):
            lines.append(draw(st.sampled_from(["", "[softlim=t0]", "[open", " \t"])))
    return draw(st.sampled_from(["\n", "\r\n"])).join(lines)


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)
@given(text=spelled())
def test_blanks_case_and_comments_change_nothing(text: str, tmp_path: Path) -> None:
    machine, kept = load(text, tmp_path)
    assert kept == []
    plain = machine_of("\n".join(_LINES), tmp_path)
    assert machine is not None
    assert replace(machine, kept=()) == replace(plain, kept=())


_PIECES = [
    *(key.encode() for key in KEYS), b"=", b"\n", b"\r", b" ", b"[", b"]", b'"', b"\x93", b"\xe2\x80\x9c", b"x", b"T",
    b"-1", b".5", b"1e9", b"99999999999999", b"\0", b"\xff", b"#", b",",
]  # fmt: skip


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=300)
@given(
    data=st.one_of(st.binary(max_size=100), st.lists(st.sampled_from(_PIECES), max_size=40).map(b"".join)),
    behind=st.booleans(),
)
def test_no_bytes_end_in_a_traceback(data: bytes, behind: bool, tmp_path: Path) -> None:
    machine, kept = load(BASE.encode() + data if behind else data, tmp_path)
    if machine is None:
        assert kept
        assert all(f.span.file.endswith("WINCNC.INI") for f in kept)
    else:
        assert parse_ir(print_ir(machine)) == machine


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=200)
@given(key=st.sampled_from(sorted(KEYS)), value=st.text(alphabet='xyztm019.- "[]', max_size=12))
def test_no_value_of_a_key_ends_in_a_traceback(key: str, value: str, tmp_path: Path) -> None:
    machine, kept = load(f"{BASE}{key}={value}\n", tmp_path)
    assert machine is not None or kept
