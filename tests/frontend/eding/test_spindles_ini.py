"""The sections [SPINDLE_n] of cnc.ini, and their refinement in TOML. Eding CNC manual 3.5.2 and 2.1.11."""

from __future__ import annotations

from pathlib import Path

import pytest

from gproof.driver.dialects import load_machine
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine, Spindle
from gproof.ir.text import parse_ir, print_ir

INI = """\
[GENERAL]
units = {units}
[JOINT_0]
visible = 1
[SPINDLE_0]
spindleRampUpTime = 1.50
spindleNmax = 24000.00
spindleNmin = 1000.00
xOffset = 7
[SPINDLE_2]
spindleNmax = 6000
xOffset = 2.0
yOffset = -4
"""


def load(folder: Path, ini: str, toml: str | None = None) -> tuple[Machine | None, Findings]:
    path = folder / "cnc.ini"
    path.write_text(ini)
    if toml is not None:
        path = folder / "machine.toml"
        path.write_text(f'schema = "gproof-machine/1"\nunits = "mm"\nbase = "cnc.ini"\n{toml}')
    findings = Findings()
    machine, _ = load_machine(path, findings)
    return machine, findings


@pytest.mark.parametrize(("units", "mm"), [("mm", 1.0), ("inch", 25.4)])
def test_speeds_and_offsets(tmp_path: Path, units: str, mm: float) -> None:
    machine, findings = load(tmp_path, INI.format(units=units))
    assert machine is not None and findings.kept == []
    assert machine.spindles == (
        Spindle(number=0, min_rpm=1000, max_rpm=24000, ramp_time=1.5, offset=(0.0, 0.0, 0.0)),
        Spindle(number=2, max_rpm=6000, offset=(2.0 * mm, -4.0 * mm, None), unsigned=True),
    )
    assert parse_ir(print_ir(machine)) == machine
    assert machine.spindle(2) is machine.spindles[1] and machine.spindle(1) is None


def test_an_offset_in_toml_has_its_sign(tmp_path: Path) -> None:
    machine, findings = load(tmp_path, INI.format(units="mm"), "[spindles.2]\nx = -2.0\n[spindles.5]\nz = 3\n")
    assert machine is not None and findings.kept == []
    assert machine.spindles[1:] == (
        Spindle(number=2, max_rpm=6000, offset=(-2.0, None, None)),
        Spindle(number=5, offset=(None, None, 3.0)),
    )
    # speeds alone leave the sign open
    machine, _ = load(tmp_path, INI.format(units="mm"), "[spindles.2]\nmin_rpm = 5\n")
    assert machine is not None
    assert machine.spindles[1] == Spindle(number=2, min_rpm=5, max_rpm=6000, offset=(2.0, -4.0, None), unsigned=True)


@pytest.mark.parametrize(
    ("ini", "toml", "line"),
    [
        ("[SPINDLE_0]\nspindleNmin = 9\nspindleNmax = 8\n", None, 4),
        ("[SPINDLE_0]\nspindleNmax = 0\n", None, 4),
        ("[SPINDLE_1]\nxOffset = far\n", None, 4),
        ("", "[spindles.6]\nx = 1\n", 4),
        ("", "[spindles.1]\nmax_rpm = 0\n", 5),
        ("", "[spindles.1]\nmin_rpm = 9\nmax_rpm = 8\n", 5),
        ("", "[spindles.0]\nx = 1.0\n", 5),
        ("", '[controller]\nthread_peak = "radius"\n', 5),
    ],
)
def test_mistakes_have_their_line(tmp_path: Path, ini: str, toml: str | None, line: int) -> None:
    machine, findings = load(tmp_path, "[JOINT_0]\nvisible = 1\n" + ini, toml)
    assert machine is None
    assert [(f.code.label, f.span.line) for f in findings.kept] == [("GP603", line)]
