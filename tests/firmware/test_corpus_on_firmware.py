"""Every job of the corpus of under a minute on the simulated reference firmware, under lower limits; and long ones.

The machines of the corpus step up to 64,000 times a second. Here no motor is faster than its share of 19,000.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from corpus.jobs import all_jobs, lowered
from firmware.test_jobs_on_firmware import compiled, machine_text, on_chip
from support.simulated_board import HZ, MISSING, Simulation

from gproof.backend.firmware import CHIPS
from gproof.ir.machine import Machine, Pin, WiredMotor, WiredOutput
from gproof.ir.verdict import DEFAULT_POLICY, PropertyResult, Verdict
from gproof.verify.certificate.keys import load_or_create_key
from gproof.verify.certificate.package import Package, read_package
from gproof.verify.certificate.write import write_package
from gproof.verify.stream import validate

pytestmark = [pytest.mark.skipif(bool(MISSING), reason=MISSING), pytest.mark.soak]

STEPS, LONGEST = 19_000, 60.0
"""Steps a second of all motors; seconds of a job with the limits that it has."""

PINS = [Pin(name=f"P{port}{bit}") for port in "BC" for bit in range(6)]
OUTPUTS = ("spindle", "flood", "mist", "1", "2", "3")


def slowed(machine: Machine) -> Machine:
    """The machine with pins of either chip, and motors of at most their share of the rate."""
    drives = [(axis, drive) for axis in machine.axes for drive in axis.drives() if drive.steps_per_unit is not None]
    share = STEPS / len(drives)
    most = {axis.name: share / abs(float(drive.steps_per_unit)) for axis, drive in drives}
    axes = tuple(
        replace(axis, max_velocity=min(axis.max_velocity or most[axis.name], most[axis.name]))
        if axis.name in most
        else axis
        for axis in machine.axes
    )
    motors = tuple(
        WiredMotor(motor=drive.name, step=PINS[2 * k], direction=PINS[2 * k + 1]) for k, (_, drive) in enumerate(drives)
    )
    outputs = tuple(WiredOutput(output=name, pin=Pin(name=f"PD{k + 2}")) for k, name in enumerate(OUTPUTS))
    board = replace(machine.board, name="klipper", motors=motors, outputs=outputs, probe=None)
    return replace(machine, axes=axes, board=board)


def package_of(name: str, folder: Path) -> Package | None:
    """A job compiled and signed; None where there is no stream, or it takes too long."""
    session, stages = lowered(name)
    if stages.stream is None or sum(part.duration for part in stages.stream.sections) > LONGEST * HZ:
        return None
    machine = session.machine
    session, stages = lowered(name, slowed)
    assert stages.stream is not None and session.machine != machine
    write_package(
        folder / "job.gpx", job=name, version="0", inputs=[],
        properties=[PropertyResult(name=one, verdict=Verdict.SAFE) for one in DEFAULT_POLICY],
        not_judged=[], assumptions=[], machine=session.machine, setup=session.setup, trace=stages.trace,
        stream=stages.stream, report=validate(stages.stream, stages.trace, session.machine, session.setup),
        key=load_or_create_key(folder / "key.pem"),
    )  # fmt: skip
    return read_package(folder / "job.gpx")


@pytest.mark.parametrize("chip", CHIPS)
@pytest.mark.parametrize("name", all_jobs())
def test_a_job_of_the_corpus(name: str, chip: str, chip_of: Callable[[str], Simulation], tmp_path: Path) -> None:
    package = package_of(name, tmp_path)
    if package is None:
        return
    record = on_chip(package, chip_of(chip), tmp_path)
    assert sum(record.steps) > 0
    assert record.position == package.stream.sections[record.sections[-1].number].end()


LONG = """\
G21 G90 G54 G17 G94
G0 X10 Y5 Z-2
T1 M6
M3 S6000
M8
F1500
G1 X20 Y12
G4 P200
M9
G2 X30 Y12 I5 J0
M5
T2 M6
M3 S6000
G4 P70
G1 X0 Y0 Z0
M5
M30
"""


@pytest.mark.parametrize("chip", CHIPS)
def test_a_dwell_of_200_s_and_a_job_longer_than_the_clock_has_bits(
    chip: str, chip_of: Callable[[str], Simulation], tmp_path: Path
) -> None:  # fmt: skip
    """Two tools and outputs, too. 2**32 ticks are 268 s."""
    package = compiled(tmp_path, "long.cnc", LONG, machine_text("eding", x=60, y=60, z=60))
    record = on_chip(package, chip_of(chip), tmp_path)
    assert sum(done.ticks for done in record.sections) > 2**32
    assert record.position == (0, 0, 0)
