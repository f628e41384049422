"""Jobs whose offsets nobody knew when they were compiled, run where the offsets are measured.

What comes out is held against the same job compiled for exactly these offsets: the same motors at the same steps, at
the beginning and at the end of each section, and as many of them.
"""

from __future__ import annotations

import dataclasses
import itertools
import json
import random
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from support.campaigns import share
from support.command import in_this_process

from gproof.backend.boards.virtual import VirtualBoard
from gproof.backend.record import verify_record
from gproof.backend.record_data import ExecutionRecord, Result
from gproof.backend.runtime import RunRefused, run
from gproof.ir.columns import Columns
from gproof.ir.setup import Interval, Setup
from gproof.ir.stream import StepStream
from gproof.verify.certificate.check import check_package
from gproof.verify.certificate.measured import taken
from gproof.verify.certificate.package import Package, read_package

HEAD = "G21 G90 G94 G17 G40 G49 G54\n"
CUT = "M3 S1000\nG0 Z2\nG1 Z-1 F300\nG1 X40 F600\nG2 X60 Y20 I0 J20\nG1 Y40\nG0 Z20\n"
JOBS = {
    "plain": HEAD + "G0 Z20\nG0 X0 Y0\n" + CUT + "M30\n",
    "together": HEAD + "G0 X5 Y0 Z12.5\n" + CUT + "M30\n",
    "stops": HEAD + "G0 Z20\nG0 X0 Y0\n" + CUT + "M0\nG0 X3\nM0\nM8\nG1 Y1 F100\nM9\nM30\n",
    "relative": HEAD + "G91\nG0 Z5\nG1 X10 Y3 F300\nG2 X5 Y5 I0 J5\nG0 Z-5\nM30\n",
    "stays": HEAD + "G0 X10\nG1 X20 F100\nM30\n",
    "turned": HEAD + "G0 Z20\nG0 X0 Y0\nG68 X5 Y5 R30\nG0 X0 Y0\n" + CUT + "G69\nG0 X0 Y0\nM30\n",
    "cycle": HEAD + "G0 Z20\nG0 X0 Y0\nG81 X10 Y10 Z-3 R2 F100\nX20\nG80\nM30\n",
    "crept": HEAD + "G0 Z20\nG0 X0 Y0\nG91\nG0 X0.0017\nG90\nG1 X7.0001 F500\nM30\n",
}
"""Of these ``relative`` counts from the start alone, and ``stays`` moves one axis."""


def machine(more: str = "", x: str = "320", z: str = "400") -> str:
    axes = "".join(
        f"[axes.{name}]\nsteps_per_unit = {steps}\nmin = {low}\nmax = {high}\nmax_velocity = 100\n"
        f"max_acceleration = 500\n"
        for name, steps, low, high in (("x", x, -100.0, 300.0), ("y", "320", -100.0, 300.0), ("z", z, -200.0, 50.0))
    )
    head = 'schema = "gproof-machine/1"\nunits = "mm"\n[controller]\ndialect = "eding"\nlaf_angle = 10\n'
    return f"{head}{axes}{more}"


SLAVE = "[[axes.x.slaves]]\nsteps_per_unit = {}\n"
SETUP = (
    'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\nactive_work = 1\ntool = 0\ntool_length = 0.0\n'
    "block_delete = false\noptional_stop = false\ng92 = {x = 0.0, y = 0.0, z = 0.0}\n"
)


def at(value: float) -> Interval:
    return Interval(value, value)


def compiled(folder: Path, job: str, on: str | None = None, setup: str = SETUP, name: str = "job") -> tuple[int, str]:
    (folder / "job.cnc").write_text(job)
    (folder / "machine.toml").write_text(machine() if on is None else on)
    (folder / f"{name}.toml").write_text(setup)
    words = ["compile", "job.cnc", "--machine", "machine.toml", "--setup", f"{name}.toml", "--unsigned"]
    done = in_this_process([*words, "-o", f"{name}.gpx"], folder)
    return done.exit, " ".join((done.out + done.err).split())


def made(folder: Path, job: str, on: str | None = None, setup: str = SETUP, name: str = "job") -> Package:
    code, said = compiled(folder, job, on, setup, name)
    assert code == 0, said
    return read_package(folder / f"{name}.gpx")


def stands(package: Package, offsets: dict[str, float]) -> Setup:
    """The setup at hand: the offsets, and the axes where the package wants them."""
    asked = {}
    for prop in package.body["properties"]:
        for condition in prop["conditions"] if prop["name"] == "stream-position" else ():
            terms: dict[str, int] = dict(condition["terms"])
            start = next((s for s in terms if s.startswith("start.") and len(terms) > 1), None)
            if start is not None:
                asked[start[-1]] = (float(condition["low"]) + float(condition["high"])) / 2
    start = {axis: at(offsets[axis] + asked.get(axis, 0.0)) for axis in "xyz"}
    work = {(1, axis): at(value) for axis, value in offsets.items()}
    return dataclasses.replace(package.setup, name="now", start=start, work=work)


def executed(package: Package, now: Setup | None) -> ExecutionRecord:
    board = VirtualBoard.for_machine(package.machine, len(package.stream.motors))
    return run(package, board, setup=now)


def refused(package: Package, now: Setup | None) -> list[str]:
    with pytest.raises(RunRefused) as caught:
        executed(package, now)
    messages = [finding.message for finding in caught.value.findings if finding.code.number != 826]
    return [message.removeprefix("the setup does not fit the package: ") for message in messages]


def toml(now: Setup) -> str:
    """The setup at hand as a file, without its open offsets."""
    start = ", ".join(f"{axis} = {ends.low!r}" for axis, ends in now.start.items())
    work = "\n".join(f"{axis} = {ends.low!r}" for (_, axis), ends in now.work.items())
    return f"{SETUP}start = {{{start}}}\n[work.1]\n{work}\n"


OFFSETS: tuple[dict[str, float], ...] = (
    {"x": 10.0, "y": 20.0, "z": -100.0},
    {"x": -12.51, "y": 0.0031, "z": -20.001},
    {"x": 101.00156, "y": 99.99999, "z": -60.3333},
)


def on_steps(offsets: dict[str, float], package: Package) -> dict[str, float]:
    """Each offset on the nearest whole step, where the exact job is compiled."""
    rates = {motor.axis: abs(motor.steps_per_unit) for motor in package.stream.motors}
    return {a: float(round(Fraction(v) * rates["xyz".index(a)]) / rates["xyz".index(a)]) for a, v in offsets.items()}


def places(stream: StepStream) -> list[tuple[tuple[int, ...], tuple[int, ...]]]:
    return [(section.start, section.end()) for section in stream.sections]


@pytest.mark.parametrize(("offsets", "name"), share(list(itertools.product(OFFSETS, JOBS)), 2))
def test_it_runs_where_the_exact_job_runs(name: str, offsets: dict[str, float], tmp_path: Path) -> None:
    package = made(tmp_path, JOBS[name])
    assert "reference" in package.body
    if name == "relative":
        offsets = {axis: value + 1.0 for axis, value in offsets.items()}
    nearest = stands(package, on_steps(offsets, package))
    now = dataclasses.replace(nearest, work={(1, axis): at(value) for axis, value in offsets.items()})
    if name in ("relative", "stays"):
        # What the job never goes to no setup has to state; what is stated beside it is another setup.
        used = {"relative": "", "stays": "x"}[name]
        now = dataclasses.replace(now, work={key: value for key, value in now.work.items() if key[1] in used})
    done = executed(package, now)
    assert done.result is Result.COMPLETED
    exact = made(tmp_path, JOBS[name], setup=toml(nearest), name="exact")
    assert "reference" not in exact.body
    assert done.start == exact.stream.sections[0].start
    assert done.position == exact.stream.sections[-1].end()
    moved = check_package(package, setup=now).moved
    assert moved is not None
    assert places(moved.stream) == places(exact.stream)
    assert moved.stream.steps() == exact.stream.steps()
    assert len(taken(package, now)) == 3


def test_random_offsets(tmp_path: Path) -> None:
    package = made(tmp_path, JOBS["plain"])
    reference = {axis: float(value) for axis, value in package.body["reference"].items()}
    for seed in range(40):
        chance = random.Random(seed)
        offsets = {"x": chance.uniform(-99, 239), "y": chance.uniform(-99, 259), "z": chance.uniform(-198, 29)}
        whole = on_steps(offsets, package)
        now = stands(package, whole)
        now = dataclasses.replace(now, work={(1, axis): at(value) for axis, value in offsets.items()})
        done = executed(package, now)
        assert done.result is Result.COMPLETED, (seed, offsets)
        for motor, start, end, first in zip(
            package.stream.motors, done.start, done.last_position, package.stream.sections[0].start, strict=True
        ):
            axis = "xyz"[motor.axis]
            steps = (Fraction(whole[axis]) - Fraction(reference[axis])) * motor.steps_per_unit
            assert start - first == round(steps), (seed, offsets)
            assert abs(end / motor.steps_per_unit - Fraction(offsets[axis] + {"x": 60, "y": 40, "z": 20}[axis])) <= (
                1 / motor.steps_per_unit
            ), (seed, offsets)


@pytest.mark.parametrize("rates", [("320", "160"), ("320", "-320"), ("160", "320"), ("400", "320")])
def test_motors_of_one_axis_go_by_steps_that_all_have(rates: tuple[str, str], tmp_path: Path) -> None:
    package = made(tmp_path, JOBS["plain"], machine(SLAVE.format(rates[1]), x=rates[0]))
    coarse = Fraction(1, 80 if rates[0] == "400" else min(abs(int(rate)) for rate in rates))
    now = stands(package, {"x": float(10 + coarse), "y": 20.0, "z": -100.0})
    assert executed(package, now).result is Result.COMPLETED
    beside = at(float(10 + coarse * Fraction(5 if rates[0] == "320" and rates[1] == "-320" else 6, 4)))
    now = dataclasses.replace(now, work={**now.work, (1, "x"): beside})
    if rates == ("320", "-320"):
        assert executed(package, now).result is Result.COMPLETED
    else:
        found = refused(package, now)
        assert any("that all its motors can reach: more than half a step" in one for one in found), found


HERE = {"x": 10.0, "y": 20.0, "z": -100.0}


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"work": {}}, "G54 X offset"),
        ({"work": {(1, "x"): at(10.0), (1, "y"): at(20.0)}}, "G54 Z offset"),
        ({"start": {}}, "the start position of X"),
        ({"work": {(1, "x"): at(240.01), (1, "y"): at(20.0), (1, "z"): at(-100.0)}},
         "valid for G54 X offset from -100 to 240; now it is 240.01"),
        ({"work": {(1, "x"): at(240.001), (1, "y"): at(20.0), (1, "z"): at(-100.0)}},
         "valid for G54 X offset from -100 to 240; now it is 240.001"),
        ({"work": {(1, "x"): at(float("nan")), (1, "y"): at(20.0), (1, "z"): at(-100.0)}}, "G54 X offset"),
        ({"work": {(1, "x"): at(float("inf")), (1, "y"): at(20.0), (1, "z"): at(-100.0)}}, "G54 X offset"),
        ({"work": {(1, "x"): at(1e300), (1, "y"): at(20.0), (1, "z"): at(-100.0)}}, "G54 X offset"),
        ({"work": {(1, "x"): Interval(9.0, 11.0), (1, "y"): at(20.0), (1, "z"): at(-100.0)}},
         "the setup does not give an exact G54 X offset, and the steps of the job depend on it"),
        ({"start": {"x": at(10.0), "y": at(20.0), "z": at(-79.9)}},
         "the job starts with Z at machine position -80, but it is at -79.9"),
        ({"start": {"x": at(0.0), "y": at(20.0), "z": at(-80.0)}},
         "the job starts with X at machine position 10, but it is at 0"),
        ({"g92": {"x": at(0.5), "y": at(0.0), "z": at(0.0)}}, "made for G92 X offset 0; now it is 0.5"),
        ({"active_work": 2}, "made for the active work offset G54; now it is G55"),
        ({"tool_lengths": {0: at(5.0)}}, "made for active tool length 0; now it is 5"),
        ({"block_delete": True}, "made for the block delete switch off; now it is on"),
    ],
)  # fmt: skip
def test_another_setup_is_refused(changes: dict[str, Any], told: str, tmp_path: Path) -> None:
    package = made(tmp_path, JOBS["plain"])
    now = stands(package, HERE)
    assert executed(package, now).result is Result.COMPLETED
    found = refused(package, dataclasses.replace(now, **changes))
    assert any(told in message for message in found), found


def test_without_a_setup_at_hand_it_is_refused(tmp_path: Path) -> None:
    package = made(tmp_path, JOBS["plain"])
    assert refused(package, None)
    check = check_package(package)
    assert check.valid_if
    assert not check.valid
    assert {"work.1.x", "work.1.y", "work.1.z", "start.x", "start.y", "start.z"} <= {
        symbol for _, condition in check.conditions for symbol, _ in condition.terms
    }


@pytest.mark.parametrize(
    ("job", "why"),
    [
        ("G53 G0 Z0\nG0 X0 Y0\nG0 Z2\nM30\n", "Z depends on G54 Z offset and on a machine position"),
        ("G0 X0 Y0\nG55 G0 X5\nM30\n", "X depends on G54 X offset and on G55 X offset"),
        ("G0 X0 Y0 Z5\nG0 X[#100]\nM30\n", ""),
        ("G0 X0 Y0 Z5\nM6 T1\nG43 H1\nG0 Z2\nM30\n", "length of tool 1"),
        ("M6 T1\nG43 H1\nG0 X0 Y0 Z5\nG1 X5 F100\nM30\n", "length of tool 1 cannot be measured later"),
    ],
)
def test_a_job_that_goes_from_one_zero_to_another_has_no_one_stream(job: str, why: str, tmp_path: Path) -> None:
    code, said = compiled(tmp_path, HEAD + job)
    assert code == 2, said
    assert why in said
    assert not why or "put these offsets, lengths and positions into a setup file" in said, "what to do"
    assert not (tmp_path / "job.gpx").exists()


def test_a_start_in_machine_coordinates_has_no_one_stream(tmp_path: Path) -> None:
    code, said = compiled(tmp_path, JOBS["plain"], setup=SETUP + "start = {x = 0.0, y = 0.0, z = 0.0}\n")
    assert code == 2, said
    assert "depends on G54 X offset and on a machine position: the distance between them is not known" in said


def test_an_axis_that_is_stated_stands_where_the_job_begins(tmp_path: Path) -> None:
    """Z's offset is known, those of X and Y are not: Z has to stand at a machine position."""
    package = made(tmp_path, JOBS["plain"], setup=SETUP + "[work.1]\nz = -100.0\n")
    now = stands(package, HERE)
    start = {"x": at(10.0), "y": at(20.0), "z": at(-80.0)}
    now = dataclasses.replace(now, start=start)
    assert executed(package, now).result is Result.COMPLETED
    found = refused(package, dataclasses.replace(now, start={**start, "z": at(-81.0)}))
    assert any("the job starts with Z at machine position -80, but it is at -81" in one for one in found), found


def test_a_range_that_is_stated_is_kept(tmp_path: Path) -> None:
    ranged = SETUP + "[work.1]\nx = [5.0, 15.0]\ny = [10.0, 30.0]\nz = [-101.0, -99.0]\n"
    package = made(tmp_path, JOBS["plain"], setup=ranged)
    now = stands(package, HERE)
    assert executed(package, now).result is Result.COMPLETED
    beyond = dataclasses.replace(now, work={**now.work, (1, "x"): at(15.5)}, start={**now.start, "x": at(15.5)})
    assert any("made for G54 X offset from 5 to 15; now it is 15.5" in one for one in refused(package, beyond))


@pytest.mark.parametrize("tables", ["pitch", "height_map"])
def test_what_holds_for_one_place_of_the_machine_only(tables: str, tmp_path: Path) -> None:
    on, setup = machine(), SETUP
    if tables == "pitch":
        on = on.replace("[axes.y]", "pitch = [[-200, -200], [0, 0], [100, 100.1], [400, 400.4]]\n[axes.y]")
    else:
        setup += "[height_map]\nx = 0.0\ny = 0.0\nsize = 10.0\nheights = [[0.0, 0.0], [0.0, 0.1]]\non = false\n"
    code, said = compiled(tmp_path, JOBS["plain"], on, setup)
    assert code == 2, said
    assert {"pitch": "X has a pitch table", "height_map": "the height map fixes the position"}[tables] in said, said


@pytest.mark.parametrize(
    "reference",
    [
        None, {}, [], "x", {"x": "1.0"}, {"x": "70.0", "y": "80.0", "z": "nan"}, {"x": "70.0", "y": "80.0", "z": "inf"},
        {"x": "70.0", "y": "80.0", "z": "-109.5001"}, {"x": "70.0", "y": "80.0", "z": "1e300"},
        {"x": "70.0", "y": "80.0", "z": None}, {"x": "70.0", "y": "80.0", "z": "5", "a": "0.0"},
        {"x": "71.0", "y": "80.0", "z": "-109.5"},
    ],
)  # fmt: skip
def test_a_reference_that_does_not_fit_is_refused(reference: Any, tmp_path: Path) -> None:
    """Also one of other whole steps: the stream would not follow the Trace."""
    package = made(tmp_path, JOBS["plain"])
    body = {key: value for key, value in package.body.items() if key != "reference"}
    forged = dataclasses.replace(package, body=body if reference is None else {**body, "reference": reference})
    assert not check_package(forged).valid_if
    assert refused(forged, stands(package, HERE))


def test_a_body_without_its_conditions_asks_for_the_offsets_all_the_same(tmp_path: Path) -> None:
    package = made(tmp_path, JOBS["plain"])
    body = json.loads(package.body_bytes)
    for prop in body["properties"]:
        prop["conditions"] = []
    forged = dataclasses.replace(package, body=body)
    assert any("is not in the setup" in one for one in refused(forged, None))
    now = stands(package, HERE)
    wrong = dataclasses.replace(now, start={**now.start, "x": at(11.0)})
    said = "the job starts with X at machine position 10, but it is at 11"
    assert any(said in one for one in refused(forged, wrong))


def test_a_stream_that_is_damaged_is_refused_where_it_is_moved(tmp_path: Path) -> None:
    package = made(tmp_path, JOBS["plain"])
    section = package.stream.sections[0]
    runs = section.runs[0]
    columns = {column.name: runs[column.name].copy() for column in runs.schema.columns}
    columns["count"][0] += 20
    section.runs = (Columns(runs.schema, columns), *section.runs[1:])
    assert refused(package, stands(package, HERE))


def test_on_the_command_line(tmp_path: Path) -> None:
    code, said = compiled(tmp_path, JOBS["plain"])
    assert code == 0
    assert "to measure G54 Z offset, with Z 20.000 mm from G54 Z offset at the start of the job" in said
    words = ["compile", "job.cnc", "--machine", "machine.toml", "--setup", "job.toml", "-o", "signed.gpx"]
    assert in_this_process(words, tmp_path).exit == 0
    done = in_this_process(["verify", "signed.gpx"], tmp_path)
    assert done.exit == 0
    assert "signed.gpx: SAFE-IF" in done.out
    now = stands(read_package(tmp_path / "job.gpx"), HERE)
    measured = {**now.work, (1, "x"): at(10.001)}
    (tmp_path / "now.toml").write_text(toml(dataclasses.replace(now, work=measured)))
    (tmp_path / "beyond.toml").write_text(toml(stands(read_package(tmp_path / "job.gpx"), {**HERE, "x": 250.0})))
    for command in (["verify", "signed.gpx"], ["run", "signed.gpx", "--board", "virtual"]):
        done = in_this_process([*command, "--setup", "now.toml"], tmp_path)
        assert done.exit == 0, done
        assert "  taken       G54 X offset as 10, 0.001 off the setup\n" in done.out
        assert "  taken       G54 Y offset as 20\n" in done.out
        done = in_this_process([*command, "--setup", "beyond.toml"], tmp_path)
        assert done.exit == 1
        assert "valid for G54 X offset from -100 to 240; now it is 250" in done.out
    assert in_this_process(["run", "signed.gpx", "--board", "virtual"], tmp_path).exit == 1


def test_a_record_fits_its_package_where_it_was_run(tmp_path: Path) -> None:
    on = machine(SLAVE.format("160"))
    package = made(tmp_path, JOBS["stops"], on)
    done = executed(package, stands(package, HERE))
    assert verify_record(done, package) == []
    assert done.start != package.stream.sections[0].start
    for motor in range(len(done.motors)):
        start = tuple(step + (k == motor) for k, step in enumerate(done.start))
        forged = dataclasses.replace(done, start=start)
        assert verify_record(forged, package), motor
    exact = made(tmp_path, JOBS["stops"], on, toml(stands(package, HERE)), "exact")
    own = executed(exact, None)
    assert verify_record(own, exact) == []
    shift = tuple(step + 320 for step in own.start)
    assert verify_record(dataclasses.replace(own, start=shift), exact)
