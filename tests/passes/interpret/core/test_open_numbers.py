"""A number that only changes times, feeds or how far the tool may be beside its path reaches these and nothing else.

Each word of each controller is tried with a number and with one that nobody stated: what it does not touch is answered
as before, what it touches is UNKNOWN, and no stream is made. What is touched comes from the sections of the manuals
beside the words.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from reach.worlds import BLOCK, EDING, MCUWIN, WINCNC, World, answered, exactly
from support.command import in_this_process

from gproof.ir.machine import Area

OPEN = EDING.with_setup(default_parameter=None)
BESIDE = OPEN.with_setup(
    # 80 mm from the path, and a part far below it.
    keep_out=(Area(name="beside", box=((250.0, 260.0), (120.0, 130.0), (-50.0, 50.0))),), workpiece=BLOCK
)  # fmt: skip
ROUNDED = ("areas", "gouges", "collisions")
DIN = MCUWIN.with_setup(g92=exactly(x=0.0, y=0.0, z=0.0, c=0.0), default_offset=0.0)
JUDGED = ("language", "limits", "areas", "arcs", "feeds", "cutting", "gouges", "collisions")

WORDS = [
    # world, program with {} for the number, a number, what is unknown; what a controller does with it
    (OPEN, "M3 S5000\nG0 X10\nG4 P{}\nG1 X20 F300\nM5", "#110", "1", ()),  # 3.4.4
    (OPEN, "M3 S5000\nG0 X10\nG1 X20 F{}\nM5", "#110", "300", ("feeds",)),  # 3.6.1
    (OPEN, "M3 S{}\nG0 X10\nG1 X20 F300\nM5", "#110", "5000", ("cutting",)),  # 3.6.2
    (OPEN, "M3 S5000\nG81 X10 Y5 Z-3 R2 F{}\nG80\nM5", "#110", "300", ("feeds",)),
    (OPEN, "M3 S5000\nG82 X10 Y5 Z-3 R2 P{} F300\nX15\nG80\nM5", "#110", "1", ()),  # 3.4.21.3
    (OPEN, "M3 S5000\nG86 X10 Y5 Z-3 R2 P{} F300\nG80\nM5", "#110", "1", ()),  # 3.4.21.9
    (OPEN, "M3 S5000\nG89 X10 Y5 Z-3 R2 P{} F300\nG80\nM5", "#110", "1", ()),  # 3.4.21.12
    (OPEN, "M3 S5000\nG83 X10 Y5 Z-3 R2 Q{} F300\nX15\nG80\nM5", "#110", "1", ()),  # 3.4.21.4
    (OPEN, "M3 S5000\nG73 X10 Y5 Z-3 R2 Q{} F300\nX15\nG80\nM5", "#110", "1", ()),  # 3.4.21.5
    (BESIDE, "M3 S5000\nG64 P{}\nG0 X10\nG1 X20 F300\nY5\nM5", "#110", "0.01", ROUNDED),  # 3.4.16
    (BESIDE, "M3 S5000\nG64 P0.01 Q{}\nG0 X10\nG1 X20 F300\nY5\nM5", "#110", "0.01", ROUNDED),
    (BESIDE, "M3 S5000\nG61 Q{}\nG0 X10\nG1 X20 F300\nY5\nM5", "#110", "0.01", ROUNDED),
    (OPEN, "M56 P1 L0 Q{}\nG0 X10", "#110", "1", ()),  # 3.5.9
    (OPEN, "M3 S500\nG0 X10\nG33 X20 K{}\nM5", "#110", "1", ("feeds",)),  # 3.4.9
    (OPEN, "M3 S5000\nM50 P{}\nG0 X10\nG1 X20 F300\nM5", "#110", "-1", ("feeds",)),  # 3.5.5
    (DIN, "M3 S500\nG00 X10\nG04 {}\nG01 X20 F300\nM5", "CD601", "1", ()),  # 3.5
    (DIN, "M3 S500\nG00 X10\nG04 (CD601 * {})\nG01 X20 F300\nM5", "CD602", "1", ()),
    (DIN, "M3 S500\nG00 X10\nG01 X20 F{}\nM5", "CD601", "300", ("feeds",)),  # 5.3
    (DIN, "M3 S500\nG00 X10\n$ wt({});\nG01 X20 F300\nM5", "CI601", "10", ()),  # 10
    (WINCNC, "G0 X2 Y2\nG82 X3 Y2 Z0.4 R0.5 P{}\nG80\nG0 X2", "{{TM1}}", "1", ()),  # G82
    (WINCNC, "G0 X1\nG4 X{}\nG0 X2", "{{TM1}}", "1", ()),  # G4
]
SET = {"CD602": "CD601 := 1\n"}
"""What has to stand before."""


@pytest.mark.parametrize(
    ("world", "text", "unknown", "number", "touched"), WORDS, ids=lambda value: value if isinstance(value, str) else ""
)
def test_a_number_reaches_what_it_touches(
    world: World, text: str, unknown: str, number: str, touched: tuple[str, ...], tmp_path: Path
) -> None:
    head, tail = {
        "eding": ("G21 G90 G94 G17 G54\n", "\nM30\n"),
        "wincnc": ("G20 G90\n", "\n"),
        "mcuwin": ("%1\nG90 G71\n", "\nM30\n%\n"),
    }[world.dialect]
    head += SET.get(unknown, "")
    known = answered(world, head + text.format(number) + tail, tmp_path, ())
    found = answered(world, head + text.format(unknown.format()) + tail, tmp_path, ())
    for name in JUDGED:
        before, after = (answer[name].splitlines()[0] for answer in (known, found))
        assert after == ("UNKNOWN" if name in touched else before), (name, known[name], found[name])
    for name in ("limits", *touched):
        assert known[name].startswith("SAFE"), known[name]
    # gproof's own plan rounds no corners and joins no lines (docs/reach.md).
    assert found["stream"].startswith("none") or touched == ROUNDED, found["stream"]


MACHINE = """schema = "gproof-machine/1"
units = "mm"
{axes}
[[keep_out]]
name = "zone"
x = [30, 40]
y = [-5, 5]
z = [-50, 50]

[tools.1]
length = 0
diameter = 2

[controller]
dialect = "eding"
"""
AXIS = "[axes.{}]\nmin = -100.0\nmax = 100.0\nmax_velocity = 80.0\nmax_acceleration = 400.0\n"
PLACES = "homed = ['x', 'y', 'z']\nstart = {x = 0, y = 0, z = 0}\ng92 = {x = 0, y = 0, z = 0}\nactive_work = 1\n"
SETUP = f'schema = "gproof-setup/1"\n{PLACES}work = {{1 = {{x = 0, y = 0, z = 0}}}}\ntool = 1\ntool_length = 0\n'


@pytest.mark.parametrize(
    ("line", "stated", "expected", "assumed"),
    [
        # Every number that it can be is refused (3.4.4, 3.4.21.4), or none, or the report says what it stands on.
        ("G4 P#110", "[-3, -1]", {"language": "UNSAFE"}, False),
        ("G4 P#110", "[0, 5]", {"language": "SAFE", "limits": "SAFE"}, False),
        ("G4 P#110", "[-1, 5]", {"language": "SAFE", "limits": "SAFE"}, True),
        ("G4 P#110", "", {"language": "SAFE", "limits": "SAFE", "areas": "SAFE"}, True),
        ("G83 X10 Y0 Z-5 R2 Q#110 F100", "[-3, 0]", {"language": "UNSAFE"}, False),
        ("G83 X10 Y0 Z-5 R2 Q#110 F100", "[1, 5]", {"language": "SAFE", "limits": "SAFE", "areas": "SAFE"}, False),
        ("G83 X10 Y0 Z-5 R2 Q#110 F100", "[0, 5]", {"language": "SAFE", "limits": "SAFE", "areas": "SAFE"}, True),
        # The hole itself is judged: past a limit, past it above, in the zone.
        ("G83 X10 Y0 Z-101 R2 Q#110 F100", "", {"limits": "UNSAFE"}, True),
        ("G73 X10 Y0 Z-101 R2 Q#110 F100", "", {"limits": "UNSAFE"}, True),
        ("G83 X10 Y0 Z-5 R101 Q#110 F100", "", {"limits": "UNSAFE"}, True),
        ("G73 X-100 Y0 Z-100 R100 Q#110 F100", "", {"limits": "SAFE", "areas": "SAFE"}, True),
        ("G83 X35 Y0 Z-5 R2 Q#110 F100", "", {"limits": "SAFE", "areas": "UNSAFE"}, True),
        # The corner at X25 is 4 mm from the zone for the side of the tool.
        ("G64 P#110\nG1 X25 F100\nG1 Y10", "", {"limits": "SAFE", "areas": "UNKNOWN"}, True),
        ("G64 P#110\nG1 X25 F100\nG1 Y10", "[0.1, 3]", {"limits": "SAFE", "areas": "SAFE"}, False),
        ("G64 P#110\nG1 X25 F100\nG1 Y10", "[0.1, 6]", {"limits": "SAFE", "areas": "UNKNOWN"}, False),
        ("G64 P#110\nG1 X25 F100\nG1 Y10", "[0, 3]", {"limits": "SAFE", "areas": "UNKNOWN"}, False),
        ("G64 P#110\nG1 X101 Y50 F100", "", {"limits": "UNSAFE"}, True),
        ("G61 Q#110\nG1 X25 F100\nG1 Y10", "[0.1, 3]", {"limits": "SAFE", "areas": "SAFE"}, False),
        ("G61 Q#110\nG1 X25 F100\nG1 Y10", "", {"limits": "SAFE", "areas": "UNKNOWN"}, True),
        ("G64 P#110\nG1 X5 F100", "[-3, -1]", {"language": "UNSAFE"}, False),
        ("M3 S100\nG33 Z-101 K#110", "", {"limits": "UNSAFE"}, True),
        ("M3 S100\nG33 Z-5 K#110", "[-3, 0]", {"language": "UNSAFE"}, False),
    ],
)
def test_what_a_number_may_be(
    line: str, stated: str, expected: dict[str, str], assumed: bool, tmp_path: Path
) -> None:  # fmt: skip
    (tmp_path / "machine.toml").write_text(MACHINE.format(axes="".join(AXIS.format(name) for name in "xyz")))
    (tmp_path / "setup.toml").write_text(SETUP + (f"[parameters]\n110 = {stated}\n" if stated else ""))
    (tmp_path / "job.cnc").write_text(f"G21 G90 G94 G17 G54\n{line}\nM30\n")
    words = ["check", "job.cnc", "--machine", "machine.toml", "--setup", "setup.toml", "--format", "json"]
    done = in_this_process(words, tmp_path)
    report = json.loads(done.out)
    assert {name: report["properties"][name]["verdict"] for name in expected} == expected, report["findings"]
    assert any("which depends on #110" in text for text in report["assumptions"]) is assumed, report["assumptions"]
