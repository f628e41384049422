"""[controls] and the other keys of gproof's own machine file that a WinCNC machine needs beside its own file."""

from __future__ import annotations

from pathlib import Path

import pytest

from gproof.driver.dialects import load_machine
from gproof.ir.dialects.wincnc.settings import WinCncSettings
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine

HEAD = 'schema = "gproof-machine/1"\nunits = "mm"\nbase = "WINCNC.INI"\n'
INI = """\
unit=in
axischar=XYZW
axisspec=r1000a100
axisspec=r1000a100
axisspec=r1000a100
axisspec=r1000a100
softlim=t2
lobound=z0w0
vgroup=fxy
"""


def load(text: str, tmp_path: Path) -> tuple[Machine | None, Findings]:
    (tmp_path / "WINCNC.INI").write_text(INI)
    path = tmp_path / "router.toml"
    path.write_text(HEAD + text)
    findings = Findings()
    machine, files = load_machine(path, findings)
    assert [Path(name).name for name, _ in files] == ["router.toml", "WINCNC.INI"]
    return machine, findings


def test_a_file_refines_wincnc_ini(tmp_path: Path) -> None:
    text = """
[axes.x]
travel_min = -3
travel_max = 1250
boundary_min = 5
boundary_max = 1200
feed_velocity = 20
home_place = 1.5

[axes.a]
letter = "U"
vertical = false

[controls]
shift_sign = -1
helical_arcs = false
arcs_share_feed = true
nesting = 9
soft_limits = true
start = "M98 ON.TAP"
inputs = [4, 1]
devices = ["knife", "thc"]
feed_groups = ["xy", "z"]
command_group = "z"
arc_tolerance = 0.05
"""
    machine, findings = load(text, tmp_path)
    assert findings.kept == []
    assert machine is not None
    x, a = machine.axis("x"), machine.axis("a")
    assert x is not None and a is not None
    assert (x.travel_lower, x.travel_upper, x.boundary_lower, x.boundary_upper) == (-3.0, 1250.0, 5.0, 1200.0)
    assert (x.feed_velocity, x.home_place) == (20.0, 1.5)
    # What the file does not say stays as WINCNC.INI has it: a boundary at 0 inches.
    assert (a.word, a.vertical, a.boundary_lower) == ("U", False, 0.0)
    assert machine.controller.dialect == "wincnc"
    assert machine.unit == 25.4
    assert machine.settings == WinCncSettings(
        arc_tolerance=0.05, smallest_arc=0.0508, soft_limits=True, shift_sign=-1, helical_arcs=False,
        arcs_share_feed=True, nesting=9,
        start="M98 ON.TAP", inputs=(1, 4), outputs=(), devices=("knife", "thc"), feed_groups=("xy", "z"),
        command_group="z", axis_order="xyza", highest_channel=64,
    )  # fmt: skip


def test_every_switch(tmp_path: Path) -> None:
    for key in ("absolute", "limits_available", "adjust_boundary", "adjust_vertical", "arcs_modal"):
        for value in (True, False):
            machine, findings = load(f"[controls]\n{key} = {str(value).lower()}\n", tmp_path)
            assert findings.kept == []
            assert machine is not None
            assert getattr(machine.settings, key) is value


@pytest.mark.parametrize(
    ("text", "line", "what"),
    [
        ("[controls]\nshift_sign = 0\n", 5, "0 is neither 1 nor -1"),
        ("[controls]\nshift_sign = 2\n", 5, "is not a whole number from -1 to 1"),
        ("[controls]\nrotation_sign = 0\n", 5, "0 is neither 1 nor -1"),
        ("[controls]\nvirtual_on = 62\n", 5, "is not a whole number from 60 to 61"),
        ("[controls]\nhighest_channel = 0\n", 5, "is not a whole number from 1 to 1000"),
        ("[controls]\nhighest_channel = 8\ninputs = [9]\n", 6, "is not a list of whole numbers from 1 to 8"),
        ('[controls]\narray_order = "both"\n', 5, "both"),
        ("[controls]\naround_files = 1\n", 5, "is not"),
        ("[controls]\nnesting = -1\n", 5, "is not a whole number from 0 to 1000"),
        ("[controls]\ninputs = [0]\n", 5, "is not a list of whole numbers from 1 to 64"),
        ("[controls]\noutputs = 3\n", 5, "is not a list of whole numbers from 1 to 64"),
        ('[controls]\ndevices = ["wheel"]\n', 5, "'wheel' is not one of"),
        ('[controls]\ndevices = "knife"\n', 5, "is not a list of texts"),
        ('[controls]\nfeed_groups = ["xy", "yz"]\n', 5, "at most once"),
        ('[controls]\nfeed_groups = ["w"]\n', 5, "at most once"),
        ('[controls]\ncommand_group = "xx"\n', 5, "'xx' is not made of"),
        ("[controls]\narc_tolerance = -1\n", 5, "is not 0 or greater than 0"),
        ('[axes.x]\nletter = "W"\n', 5, "X has its own letter"),
        ('[axes.b]\nletter = "W"\n', 5, "W already moves another axis"),
        ('[axes.a]\nletter = "Q"\n', 5, "is not one of W, U, V"),
        ("[axes.x]\nboundary_min = 5\nboundary_max = 4\n", 5, "boundary_min is above boundary_max"),
    ],
)
def test_mistakes_have_their_line(text: str, line: int, what: str, tmp_path: Path) -> None:
    machine, findings = load(text, tmp_path)
    assert machine is None
    assert [(f.code.label, f.span.line) for f in findings.kept] == [("GP603", line)]
    assert what in findings.kept[0].message


def test_a_key_that_is_not_known(tmp_path: Path) -> None:
    machine, findings = load("[controls]\nshift = 1\n", tmp_path)
    assert machine is None
    assert [(f.code.label, f.span.line) for f in findings.kept] == [("GP611", 5)]
