"""Jobs on the reference firmware: G-code, package, runtime, driver, pyserial, a simulated chip, edges of its pins.

The edges are compared with the stream by ``support/simulated_line.py``, which works out from the format of runs when
and which way each step is due.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from corpus.jobs import all_jobs, lowered
from support.simulated_board import HZ, MISSING, Simulation
from support.simulated_line import Recorded, judge

from backend import streams
from gproof.backend.firmware import CHIPS
from gproof.backend.job import job_of
from gproof.backend.record_data import ExecutionRecord, Result
from gproof.backend.record_proof import sent
from gproof.backend.runtime import run
from gproof.driver.pipeline import Request, compile_job
from gproof.driver.progress import Watcher
from gproof.driver.session import Running
from gproof.ir.machine import Board, Machine, Pin, WiredMotor, WiredOutput
from gproof.ir.stream import Motor
from gproof.ir.trace import Op
from gproof.ir.verdict import DEFAULT_POLICY, PropertyResult, Verdict
from gproof.verify.certificate.keys import load_or_create_key, raw_public
from gproof.verify.certificate.package import Package, read_package
from gproof.verify.certificate.write import write_package
from gproof.verify.stream import validate

pytestmark = pytest.mark.skipif(bool(MISSING), reason=MISSING)

AXIS = """
[axes.{name}]
kind = "{kind}"
steps_per_unit = 100
min = -100.0
max = 100.0
max_velocity = {velocity}
max_acceleration = 800.0

[board.motors.{name}]
step = "{step}"
direction = "{direction}"
"""

MACHINE = """
schema = "gproof-machine/1"
name = "bench"
units = "mm"

[controller]
dialect = "{dialect}"
interpolation_time = 0.005
fifo_time = 0.25
auto_tool_change = false
max_step_frequency = 10000

[board]
name = "klipper"
tick_frequency = 16000000
step_pulse = 2e-6
direction_setup = 5e-6

[board.outputs.spindle]
pin = "PD3"
speed = 6000

[board.outputs.flood]
pin = "!PD4"

[board.outputs.mist]
pin = "PD5"
"""

PINS = {"x": ("PB0", "!PB1"), "y": ("!PB2", "PB3"), "z": ("PC0", "PC1"), "a": ("PC2", "!PC3")}


def machine_text(dialect: str, **velocities: float) -> str:
    """A machine file; the greatest velocity of each axis, units a second."""
    axes = [
        AXIS.format(
            name=name, kind="rotary" if name == "a" else "linear", velocity=velocity,
            step=PINS[name][0], direction=PINS[name][1],
        )
        for name, velocity in velocities.items()
    ]  # fmt: skip
    return MACHINE.format(dialect=dialect) + "".join(axes)


def compiled(folder: Path, name: str, program: str, machine: str) -> Package:
    """Through everything that ``gproof compile`` does, signed."""
    job, description, key = folder / name, folder / "machine.toml", folder / "key.pem"
    job.write_text(program)
    description.write_text(machine)
    load_or_create_key(key)
    made = compile_job(
        Request(
            job=job, machine=description, setup="zero", dialect=None, running=Running(), key=key,
            output=folder / "job.gpx",
        ),
        Watcher(),
    )  # fmt: skip
    assert made.package is not None, (made.why, [str(finding) for finding in made.session.findings.kept])
    return read_package(folder / "job.gpx")


def on_chip(
    package: Package, simulation: Simulation, folder: Path, ends: tuple[Result, ...] = (Result.COMPLETED,)
) -> ExecutionRecord:
    """A run to its end, judged by the pins; what the runtime rested for an operator is in the stream then."""
    board = Recorded(simulation, package.machine)
    key = raw_public(load_or_create_key(folder / "key.pem"))
    record = run(package, board, machine=package.machine, setup=package.setup, trusted_keys=[key])
    assert record.result in ends and (record.result is Result.STOPPED) == bool(record.reason), record.reason
    job = job_of(package)
    played = [sent(done, job.stream.sections[done.number], job) for done in record.sections]
    early, late = judge(simulation, job.machine, job.stream.motors, list(zip(board.bases, played, strict=True)))
    seconds = sum(done.ticks for done in record.sections) / HZ
    print(f"{job.name}: {sum(record.steps)} steps in {seconds:.1f} s, {early} to {late} cycles")
    return record


PLATE = """\
G21 G90 G54 G17 G94
G0 X10 Y5 Z-2
S6000 M3
M8
G4 P0.3
F1500
G1 X20 Y12
G2 X30 Y12 I5 J0
G3 X20 Y22 R12
G1 Z-4
M9
G0 X-15 Y-12 Z3
M5
M30
"""

FOUR_AT_ONCE = """\
G21 G90 G54 G17 G94
G0 X40 Y40 Z25 A20
M3 S6000
M1
G0 X-10 Y-10 Z-6 A-5
M0
G81 X5 Y5 Z-8 R-2 F900
X0 Y12
G80
M5
M30
"""

WAVE = """\
var
  point : integer;
{$DINSTART}
%WAVE
N10 G53
N20 G90
N30 G94
N40 G00 X-30 Y7
N50 G01 X-25 Y0 F4200
N60 $for point := 1 to 50 do begin
N70 G01 X(X.tp + 1) Y(12 * sin(X.tp / 4)) F3600
N80 $end;
N90 G04 0.25
N100 G00 X0 Y0
N110 M30
%
"""

JOBS = {
    "three motors, arcs, dwell and outputs": ("328p", "plate.cnc", PLATE, "eding", {"x": 60, "y": 60, "z": 60}),
    "four motors at 20,000 steps a second, waits": (
        "2560", "four.cnc", FOUR_AT_ONCE, "eding", {"x": 60, "y": 60, "z": 40, "a": 40}
    ),
    "two motors, DIN": ("328p", "wave.src", WAVE, "mcuwin", {"x": 100, "y": 95}),
}  # fmt: skip


@pytest.mark.parametrize("name", JOBS)
def test_a_job_from_its_text_to_the_pins(name: str, chip_of: Callable[[str], Simulation], tmp_path: Path) -> None:
    chip, file, program, dialect, velocities = JOBS[name]
    package = compiled(tmp_path, file, program, machine_text(dialect, **velocities))
    record = on_chip(package, chip_of(chip), tmp_path)
    assert sum(record.steps) == package.stream.steps()
    assert record.position == package.stream.sections[-1].end()


STEPS, LONGEST = 19_000, 60.0
"""Of jobs of the corpus, whose machines step up to 64,000 times a second: steps a second of all motors here, and
seconds that a job takes at most with the limits that it has."""

BOTH_CHIPS = [Pin(name=f"P{port}{bit}") for port in "BC" for bit in range(6)]
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
        WiredMotor(motor=drive.name, step=BOTH_CHIPS[2 * k], direction=BOTH_CHIPS[2 * k + 1])
        for k, (_, drive) in enumerate(drives)
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


@pytest.mark.soak
@pytest.mark.parametrize("chip", CHIPS)
@pytest.mark.parametrize("name", all_jobs())
def test_a_job_of_the_corpus(name: str, chip: str, chip_of: Callable[[str], Simulation], tmp_path: Path) -> None:
    package = package_of(name, tmp_path)
    if package is None:
        return
    record = on_chip(package, chip_of(chip), tmp_path, ends=(Result.COMPLETED, Result.STOPPED))
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


@pytest.mark.soak
@pytest.mark.parametrize("chip", CHIPS)
def test_a_dwell_of_200_s_and_a_job_longer_than_the_clock_has_bits(
    chip: str, chip_of: Callable[[str], Simulation], tmp_path: Path
) -> None:  # fmt: skip
    """Two tools and outputs, too. 2**32 ticks are 268 s."""
    package = compiled(tmp_path, "long.cnc", LONG, machine_text("eding", x=60, y=60, z=60))
    record = on_chip(package, chip_of(chip), tmp_path)
    assert sum(done.ticks for done in record.sections) > 2**32
    assert record.position == (0, 0, 0)


class Traced:
    """Edges of a stream by hand: X has steps at 1000, 3000 and 5000 forwards and at 9000 backwards; its direction pin
    is inverted, and the coolant goes on at 4000. The base is 10,000."""

    def __init__(self) -> None:
        self.rows = [(0, 9, 1), (10, 20, 1)]
        self.rows += [(tick + 12, 8, 1) for tick in (11_000, 13_000, 15_000, 19_000)]
        self.rows += [(tick + 60, 8, 0) for tick in (11_000, 13_000, 15_000, 19_000)]
        self.rows += [(10_100, 9, 0), (15_100, 9, 1), (14_020, 20, 0)]

    def edges(self) -> np.ndarray:
        return np.array(sorted(self.rows), dtype=np.int64)


def test_the_judge_of_the_pins_sees_what_is_wrong() -> None:
    pins = [Pin(name="PB0"), Pin(name="PB1", inverted=True)]
    board = Board(
        name="klipper", motors=(WiredMotor(motor="X", step=pins[0], direction=pins[1]),),
        outputs=(WiredOutput(output="flood", pin=Pin(name="PC4", inverted=True)),),
    )  # fmt: skip
    machine = replace(streams.machine("x"), board=board)
    section = streams.section_of([streams.runs_of([(1000, 1, 0, 1), (2000, 2, 0, 1), (4000, 1, 0, -1)])])
    section.events = streams.events_of([(4000, 0, int(Op.COOLANT), (0, 1000))])
    motor = Motor(name="X", axis=0, steps_per_unit=Fraction(1))
    assert judge(Traced(), machine, [motor], [(10_000, section)]) == (0, 12)
    for k, changed, why in (
        (2, None, "3 steps, and 4"),
        (2, (11_700, 8, 1), "cycles late"),
        (2, (10_900, 8, 1), "cycles late"),
        (6, (11_030, 8, 0), "a pulse of 18"),
        (11, (18_990, 9, 1), "changed 22 cycles before"),
        (11, None, "a wrong direction"),
        (12, None, "0 changes, and 1"),
        (12, (14_700, 20, 0), "cycles late"),
        (12, (14_020, 20, 1), "the wrong way"),
        (13, (16_000, 40, 1), "not wired"),
    ):
        traced = Traced()
        traced.rows[k : k + 1] = [] if changed is None else [changed]
        with pytest.raises(AssertionError, match=why):
            judge(traced, machine, [motor], [(10_000, section)])
