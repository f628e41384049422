"""Right streams pass: both speeds of the checker, all kinds of rows, steps moved within their tolerance."""

import dataclasses
import hashlib
import itertools
import math
import random
import sys
import time
import zipfile
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.campaigns import seeds, share
from verify.jobs import JOBS, random_job
from verify.package_files import write_parts
from verify.path_oracle import follows, samples
from verify.reference_stepper import Job, Stepped, machine, step, stream_of

from gproof.ir.columns import Columns
from gproof.ir.kernel import Kernel
from gproof.ir.kernel_copies import dispatcher
from gproof.ir.machine import Axis, AxisKind, Controller, Machine, Slave
from gproof.ir.setup import NOTHING, Interval, Setup
from gproof.ir.stream import StepStream, StreamSection
from gproof.ir.trace import Edge, Op, State, Trace, Wait
from gproof.ir.verdict import Verdict
from gproof.verify.certificate.package import parts_of, read_package, write_members
from gproof.verify.explain.stream_report import BOUNDS, StreamReport
from gproof.verify.kernel import path_kernels, prove, walk_kernels, walk_state
from gproof.verify.stream import validate


def check(done: Stepped, job: Job, on: Machine | None = None, **options: object) -> StreamReport:
    on = on or machine()
    return validate(stream_of(done, on), job.trace(), on, NOTHING, **options)  # type: ignore[arg-type]


def assert_safe(report: StreamReport) -> None:
    assert [f"{f.code.label} {f.message}" for f in report.findings] == []
    assert report.verdict is Verdict.SAFE


@pytest.mark.parametrize("name", JOBS)
def test_right_streams_pass(name: str) -> None:
    job = JOBS[name]()
    done = step(job, machine())
    report = check(done, job)
    assert_safe(report)
    assert report.steps == sum(len(s) for s in done.steps) > 0
    assert [p.name for p in report.properties] == list(BOUNDS)


@pytest.mark.parametrize("name", JOBS)
def test_both_speeds_agree_bit_for_bit(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    job = JOBS[name]()
    slower = dataclasses.replace(machine(), axes=tuple(hurried(a) for a in machine().axes))
    done = step(job, machine())
    spoilt = done.copy()
    busiest = max(spoilt.steps, key=len)
    del busiest[len(busiest) // 3]
    for stream, on in ((done, machine()), (done, slower), (spoilt, machine())):
        seen: list[tuple[StreamReport, list[bytes]]] = []
        for mode in ("python", "numba"):
            monkeypatch.setenv("GPROOF_KERNELS", mode)
            taken: list[bytes] = []
            watch(monkeypatch, taken)
            seen.append((check(stream, job, on), taken))
            monkeypatch.undo()
        assert seen[0] == seen[1]
        assert seen[0][1]


@pytest.mark.parametrize(("name", "size"), share(list(itertools.product(JOBS, (1, 7, 501))), 4))
def test_slices_change_nothing(name: str, size: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The walk stops and goes on anywhere: the same findings, and the same bytes left behind at its end."""
    job = JOBS[name]()
    done = step(job, machine())
    spoilt = done.copy()
    busiest = max(spoilt.steps, key=len)
    del busiest[len(busiest) // 3]
    monkeypatch.setenv("GPROOF_KERNELS", "python")
    for stream in (done, spoilt):
        seen: list[tuple[StreamReport, list[bytes]]] = []
        for most in (1 << 20, size):
            with monkeypatch.context() as patch:
                taken: list[bytes] = []
                patch.setattr(prove, "SLICE", most)
                watch(patch, taken)
                seen.append((check(stream, job), taken))
        (whole, all_), (parts, slices) = seen
        assert whole == parts
        assert slices[-len(all_) :] == all_
        assert len(slices) > len(all_) or whole.steps < size


def test_a_beat_is_heard_between_slices(monkeypatch: pytest.MonkeyPatch) -> None:
    job = JOBS["square"]()
    stream = stream_of(step(job, machine()), machine())
    monkeypatch.setattr(prove, "SLICE", 100)
    heard: list[int] = []

    def beat(steps: int) -> None:
        heard.append(steps)
        if len(heard) == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        validate(stream, job.trace(), machine(), NOTHING, beat=beat)
    assert heard == [100, 200, 300]


def hurried(axis: Axis) -> Axis:
    return dataclasses.replace(axis, max_velocity=20.0, max_acceleration=100.0, upper=2.0)


def watch(monkeypatch: pytest.MonkeyPatch, taken: list[bytes]) -> None:
    """Keep a digest of everything that each call of the kernel leaves behind: the bytes came to gigabytes."""
    pick = walk_kernels.check_section.pick

    def picked(work: float) -> Callable[..., int]:
        run = pick(work)

        def call(most: int, cursor: walk_state.Cursor, start: np.ndarray, *args: object) -> int:
            steps = run(most, cursor, start, *args)  # type: ignore[arg-type]
            window, walk, problems = args[-3:]
            assert isinstance(window, walk_state.Window)
            assert isinstance(walk, walk_state.Walk)
            assert isinstance(problems, walk_state.Problems)
            tail = walk.ints[path_kernels.TAIL]
            kept = [start, *cursor[:-2], *walk, *problems, window.line[:tail], window.reach[:tail], window.row[:tail]]
            taken.append(hashlib.blake2b(b"".join(array.tobytes() for array in kept)).digest())
            return int(steps)

        return call

    monkeypatch.setattr(walk_kernels.check_section, "pick", picked)


@pytest.mark.parametrize("seed", seeds(6, 40))
def test_random_right_streams_pass(seed: int) -> None:
    job = random_job(seed)
    assert_safe(check(step(job, machine()), job))


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(1000, 3000))
def test_random_right_streams_pass_for_long(seed: int) -> None:
    job = random_job(seed, rows=30, size=6.0)
    assert_safe(check(step(job, machine()), job))


def shaken(done: Stepped, rng: random.Random, share: float, frequency: int) -> Stepped:
    """Each step moved by at most ``share`` of the shorter interval beside it and 25 us."""
    moved = done.copy()
    for m, steps in enumerate(done.steps):
        ticks = [0, *(t for t, _ in steps), done.duration]
        for k, (tick, direction) in enumerate(steps):
            room = min(ticks[k + 1] - ticks[k], ticks[k + 2] - ticks[k + 1])
            most = int(min(share * room, 25e-6 * frequency))
            moved.steps[m][k] = (max(1, tick + rng.choice((-most, most))), direction)
    return moved


@pytest.mark.parametrize("seed", seeds(2, 12))
def test_steps_moved_within_the_tolerance_of_run_compression_pass(seed: int) -> None:
    """The very ends of the tolerance: half the local interval, either way. The step rate has room here."""
    on = dataclasses.replace(machine(), controller=Controller(max_step_frequency=None))
    job = list(JOBS.values())[seed % 4]() if seed % 2 else random_job(seed)
    done = shaken(step(job, on), random.Random(seed), 0.5, on.board.tick_frequency)
    report = check(done, job, on)
    assert {f.code.label for f in report.findings} <= {"GP804"}, report.findings
    assert not {"stream-position", "stream-order", "stream-velocity"} & {
        p.name for p in report.properties if p.verdict is not Verdict.SAFE
    }


@pytest.mark.parametrize("seed", seeds(1, 300))
def test_position_check_agrees_with_brute_force(seed: int) -> None:
    """Random damage to random jobs: accepted only if 1.02 steps explain it, always if 0.97 do."""
    rng = random.Random(seed)
    job = random_job(seed, rows=6, size=0.8)
    on = machine()
    path = samples(job, on)
    clean = step(job, on)
    decided = 0
    for _ in range(6):
        done = damaged(clean, rng)
        report = check(done, job, on)
        left = next(p for p in report.properties if p.name == "stream-position").verdict is not Verdict.SAFE
        if left:
            assert not follows(path, done, 0.97)
        else:
            assert follows(path, done, 1.02)
        decided += 1
    assert decided == 6


def damaged(clean: Stepped, rng: random.Random) -> Stepped:
    """Steps exchanged between or moved within motors so that the end position stays."""
    done = clean.copy()
    busy = [m for m, steps in enumerate(done.steps) if len(steps) > 2]
    for _ in range(rng.choice((1, 1, 2, 4))):
        if not busy:
            break
        m = rng.choice(busy)
        steps = done.steps[m]
        k = rng.randrange(len(steps))
        kind = rng.random()
        if kind < 0.6:
            tick, direction = steps.pop(k)
            reach = int(done.duration * rng.choice((0.002, 0.01, 0.05)))
            steps.append((min(done.duration, max(1, tick + rng.randint(-reach, reach))), direction))
        else:
            tick, direction = steps[k]
            steps += [(tick + 1, -direction), (tick + 2, direction)]
        steps.sort()
        unique: list[tuple[int, int]] = []
        for tick, direction in steps:
            unique.append((max(tick, unique[-1][0] + 1) if unique else tick, direction))
        done.steps[m] = unique
        done.duration = max(done.duration, unique[-1][0])
    return done


def test_guard_off_lets_the_physical_travel_decide() -> None:
    job = Job().rapid(x=2).state(State(guards_off=("machine_area",))).rapid(x=6).rapid(x=2)
    done = step(job, machine())
    x = dataclasses.replace(machine().axes[0], upper=5.0)

    def report_with(**travel: float) -> StreamReport:
        return check(done, job, dataclasses.replace(machine(), axes=(dataclasses.replace(x, **travel), *rest)))

    rest = machine().axes[1:]
    unknown = report_with()
    assert unknown.verdict is Verdict.UNKNOWN
    assert unknown.findings == ()
    assert_safe(report_with(travel_lower=-5.0, travel_upper=6.0))
    assert {f.code.label for f in report_with(travel_lower=-5.0, travel_upper=5.9).findings} == {"GP809"}
    guarded = Job().rapid(x=2).rapid(x=6).rapid(x=2)
    assert {f.code.label for f in check(done, guarded, dataclasses.replace(machine(), axes=(x, *rest))).findings} == {
        "GP809"
    }


def test_a_limit_between_two_steps_allows_its_nearest_step() -> None:
    job = Job().rapid(x=2.008)  # 160.64 steps
    done = step(job, machine())
    for upper, allowed in ((2.008, True), (2.0065, True), (2.0, False)):
        x = dataclasses.replace(machine().axes[0], upper=upper)
        on = dataclasses.replace(machine(), axes=(x, *machine().axes[1:]))
        assert (check(done, job, on).verdict is Verdict.SAFE) == allowed


def test_slave_motors_are_demanded_and_checked() -> None:
    gantry = dataclasses.replace(machine().axes[0], slaves=(Slave(),))
    on = dataclasses.replace(machine(), axes=(gantry, *machine().axes[1:]))
    job = JOBS["square"]()
    done = step(job, on)
    assert len(done.steps) == 5
    assert_safe(check(done, job, on))
    assert {f.code.label for f in check(step(job, machine()), job, machine()).findings} == set()
    missing = validate(stream_of(step(job, machine()), machine()), job.trace(), on, NOTHING)
    assert {f.code.label for f in missing.findings} == {"GP810"}
    done.steps[1] = done.steps[1][:-1]
    assert {f.code.label for f in check(done, job, on).findings} == {"GP808"}


def test_an_axis_without_velocity_leaves_the_verdict_open() -> None:
    job = JOBS["square"]()
    done = step(job, machine())
    x = dataclasses.replace(machine().axes[0], max_velocity=None)
    on = dataclasses.replace(machine(), axes=(x, *machine().axes[1:]))
    report = check(done, job, on)
    assert report.findings == ()
    assert report.verdict is Verdict.UNKNOWN


def test_standing_still_for_long_is_cheap_and_allowed() -> None:
    job = Job().rapid(x=1).event(Op.DWELL, 1e6).rapid(x=0)
    assert_safe(check(step(job, machine()), job))
    late = step(Job().rapid(x=1), machine())
    late.steps[0] = [(t + (1 << 50), d) for t, d in late.steps[0]]
    late.duration += 1 << 50
    assert_safe(check(late, Job().rapid(x=1)))


def test_a_section_without_rows_or_motors() -> None:
    job = Job()
    assert_safe(check(step(job, machine()), job))
    bare = Machine(name="bare", axes=(Axis(name="x", kind=AxisKind.LINEAR),))
    report = check(Stepped([], [], [], 5), Job().event(Op.DWELL, 1e-7), bare)
    assert {f.code.label for f in report.findings} == {"GP807"}, "the event is missing"
    moving = check(Stepped([], [], [], 5), Job().rapid(x=1), bare)
    assert {f.code.label for f in moving.findings} == {"GP810"}


def two_sections(second: Job, wait: Wait = Wait.OPERATOR) -> tuple[StepStream, Trace]:
    on = machine()
    first = Job().rapid(x=2, y=1).event(Op.HOME if wait is Wait.HOME else Op.STOP, 0.0)
    trace = first.trace()
    trace.texts.append("x y")
    trace.sections[0].edges = (Edge(wait=wait, outcome="go on", target=1),)
    trace.sections.append(dataclasses.replace(second.trace().sections[0], number=1))
    stream = stream_of(step(first, on), on)
    stream.sections.append(step(second, on).section(1))
    return stream, trace


def test_sections_follow_one_another() -> None:
    stream, trace = two_sections(Job((2.0, 1.0, 0.0, 0.0, 0.0, 0.0)).rapid(x=0, y=0))
    assert_safe(validate(stream, trace, machine(), NOTHING))
    jumped, trace = two_sections(Job((2.5, 1.0, 0.0, 0.0, 0.0, 0.0)).rapid(x=0, y=0))
    assert {f.code.label for f in validate(jumped, trace, machine(), NOTHING).findings} == {"GP808"}
    homed, trace = two_sections(Job().rapid(x=1, y=0), Wait.HOME)
    assert_safe(validate(homed, trace, machine(), NOTHING))


def test_first_steps_of_a_section_keep_their_distance_from_the_last_ones() -> None:
    stream, trace = two_sections(Job((2.0, 1.0, 0.0, 0.0, 0.0, 0.0)).rapid(x=0, y=0))
    hasty = stream.sections[0]
    runs = hasty.runs[0]
    last = int((runs["interval"] * runs["count"] + runs["add"] * (runs["count"] - 1) * runs["count"] // 2).sum())
    stream.sections[0] = StreamSection(
        number=0, start=hasty.start, runs=hasty.runs, events=hasty.events, duration=max(last, hasty.duration)
    )
    second = stream.sections[1].runs[0]
    second["interval"][0] = 2
    second["interval"][1] += 60_000
    report = validate(stream, trace, machine(), NOTHING)
    tail = hasty.duration - last + 2
    assert ("GP804" in {f.code.label for f in report.findings}) == (tail < 80)


def test_only_the_sections_asked_for_are_walked() -> None:
    stream, trace = two_sections(Job((2.0, 1.0, 0.0, 0.0, 0.0, 0.0)).rapid(x=0, y=0))
    whole = validate(stream, trace, machine(), NOTHING)
    one = validate(stream, trace, machine(), NOTHING, sections=[1])
    assert_safe(one)
    assert 0 < one.steps < whole.steps


def many_sections(count: int) -> tuple[StepStream, Trace]:
    """So many short ways there and back, each with a stop at its end."""
    first, last = Job().rapid(x=0.1).rapid(x=0).event(Op.STOP), Job().rapid(x=0.1).rapid(x=0)
    trace, stream = first.trace(), stream_of(step(first, machine()), machine())
    rows, done = trace.sections[0], step(first, machine())
    go = [(Edge(wait=Wait.OPERATOR, outcome="go on", target=k + 1),) for k in range(count)]
    trace.sections = [dataclasses.replace(rows, number=k, edges=go[k]) for k in range(count)]
    trace.sections.append(dataclasses.replace(last.trace().sections[0], number=count))
    stream.sections = [*(done.section(k) for k in range(count)), step(last, machine()).section(count)]
    return stream, trace


def test_3000_sections_take_no_longer_than_their_steps(tmp_path: Path) -> None:
    """Written, read and validated in some tenths of a second each (processor time; three times that are allowed, and
    a loaded machine), and in ten times of what a tenth of them takes."""
    took: list[list[float]] = []
    for count in (300, 3000):
        stream, trace = many_sections(count)
        path = tmp_path / f"{count}.gpx"
        clock = [time.process_time()]
        write_members(path, parts_of(machine(), NOTHING, trace, stream))
        clock.append(time.process_time())
        write_parts(path, machine(), NOTHING, trace, stream)
        began = time.process_time()
        package = read_package(path)
        read = time.process_time() - began
        with zipfile.ZipFile(path) as archive:
            assert len(archive.namelist()) == 5 + 2 + len(stream.motors), "no member for each section"
        began = time.process_time()
        assert_safe(validate(package.stream, package.trace, package.machine, package.setup))
        took.append([clock[1] - clock[0], read, time.process_time() - began])
        assert package.trace.sections == trace.sections
        assert package.stream == stream
    for few, many in zip(*took, strict=True):
        assert many < min(3.0, 15 * few + 2.0), took


@pytest.mark.parametrize("spoilt", [0, 149, 300])
def test_one_bad_section_of_many_is_named(spoilt: int) -> None:
    """What is looked at together is refused as it is by itself: each table of a section, in its place."""
    stream, trace = many_sections(300)
    rows, part = trace.sections[spoilt].rows, stream.sections[spoilt]

    def other(table: Columns, column: str, row: int, value: float) -> Columns:
        arrays = {name: array.copy() for name, array in table.arrays.items()}
        arrays[column][row] = value
        return Columns(table.schema, arrays)

    def judged(new_rows: Columns = rows, **changed: Any) -> set[str]:
        sections = list(trace.sections)
        sections[spoilt] = dataclasses.replace(sections[spoilt], rows=new_rows)
        parts = list(stream.sections)
        parts[spoilt] = dataclasses.replace(part, **changed)
        report = validate(
            dataclasses.replace(stream, sections=parts),
            dataclasses.replace(trace, sections=sections),
            machine(),
            NOTHING,
        )
        assert report.verdict is Verdict.UNSAFE
        assert any(f"section {spoilt}" in f.message for f in report.findings), report.findings
        return {f.code.label for f in report.findings}

    first, *rest = part.runs
    assert judged(other(rows, "to", 1, math.nan)) == {"GP810"}
    assert judged(other(rows, "op", 0, 200)) == {"GP810"}
    assert judged(other(rows, "plane", 0, 1)) == {"GP810"}
    assert judged(other(rows, "op", 0, Op.ORIENT)) == {"GP810"}
    assert judged(runs=(other(first, "direction", 0, 0), *rest)) == {"GP810"}
    assert judged(runs=(other(first, "interval", 0, 0), *rest)) == {"GP810"}
    assert judged(start=(part.start[0] + 3, *part.start[1:])) >= {"GP808"}
    assert judged(duration=1) - {"GP810"}
    if len(part.events):
        assert judged(events=other(part.events, "row", 0, 1)) == {"GP807"}
        assert judged(events=other(part.events, "tick", 0, part.duration + 1)) == {"GP807"}
        assert judged(events=other(part.events, "op", 0, Op.DWELL)) == {"GP807"}


def test_setup_that_names_another_start_refuses() -> None:
    job = JOBS["square"]()
    done = stream_of(step(job, machine()), machine())
    near = Setup(start={"x": Interval(-1.0, 1.0)})
    assert_safe(validate(done, job.trace(), machine(), near))
    far = Setup(start={"x": Interval(0.5, 1.0)})
    assert {f.code.label for f in validate(done, job.trace(), machine(), far).findings} == {"GP808"}


def test_unknown_positions_are_refused() -> None:
    job = JOBS["square"]()
    trace = job.trace()
    trace.frames.append(((("work.1.x", 1),), (), (), (), (), ()))
    trace.sections[0].rows["frame"][2] = 1
    report = validate(stream_of(step(job, machine()), machine()), trace, machine(), NOTHING)
    assert {f.code.label for f in report.findings} == {"GP810"}
    assert report.verdict is Verdict.UNSAFE
    other = job.trace()
    other.frames.append(((), (), (), (), (), (("start.c", 1),)))
    other.sections[0].rows["frame"][:] = 1
    assert_safe(validate(stream_of(step(job, machine()), machine()), other, machine(), NOTHING))


def test_feed_may_be_overridden_only_as_far_as_asked() -> None:
    job = Job().line(x=20, feed=600)
    done = step(job, machine())
    done.steps[0] = [(t * 10 // 11, d) for t, d in done.steps[0]]
    assert {f.code.label for f in check(done, job).findings} == {"GP805"}
    assert_safe(check(done, job, override=1.2))


def test_spindle_start_waits_for_its_ramp() -> None:
    slow = dataclasses.replace(machine(), controller=Controller(max_step_frequency=125_000.0, spindle_ramp_time=0.2))
    job = Job().event(Op.SPINDLE, 1.0, 8000.0).rapid(x=1).event(Op.SPINDLE, 1.0, 9000.0).rapid(x=0)
    assert_safe(check(step(job, slow), job, slow))
    assert "GP807" in {f.code.label for f in check(step(job, machine()), job, slow).findings}


def test_ties_may_go_either_way() -> None:
    """80 steps/mm: 0.00625 mm is half a step; both neighbours are nearest."""
    job = Job((0.00625, 0.0, 0.0, 0.0, 0.0, 0.0)).event(Op.STOP, 0.0)
    for x in (0, 1):
        assert_safe(check(Stepped([x, 0, 0, 0], [[], [], [], []], [(0, 0, int(Op.STOP), (0, 0))], 1), job))
    bad = check(Stepped([-1, 0, 0, 0], [[], [], [], []], [(0, 0, int(Op.STOP), (0, 0))], 1), job)
    assert {f.code.label for f in bad.findings} == {"GP808"}


def test_a_circle_in_an_axis_without_a_motor_is_refused() -> None:
    """Its ends are the same, so that only its plane tells that the axis moves."""
    job = Job().rapid(x=1).arc((0.0, 2.0), 1, plane=2).rapid(x=0)
    flat = dataclasses.replace(machine(), axes=machine().axes[:2])
    still = Job().rapid(x=1).rapid(x=0)
    report = validate(stream_of(step(still, flat), flat), job.trace(), flat, NOTHING)
    assert {f.code.label for f in report.findings} == {"GP810"}


def test_a_stream_that_leaves_backlash_out_is_refused() -> None:
    """A square and back: with 4 steps of backlash X and Y are not where they should be after their first turn."""
    on = dataclasses.replace(machine(), axes=tuple(dataclasses.replace(a, backlash=0.05) for a in machine().axes))
    report = check(step(JOBS["square"](), on), JOBS["square"](), on)
    assert {f.code.label for f in report.findings} <= {"GP801", "GP802", "GP807", "GP808"}
    assert report.verdict is Verdict.UNSAFE


def test_where_an_axis_with_backlash_came_from_is_an_assumption() -> None:
    """Up only: the motor goes where its axis goes."""
    on = dataclasses.replace(machine(), axes=tuple(dataclasses.replace(a, backlash=0.05) for a in machine().axes))
    job = Job()
    job.line(x=3.0, y=2.0, feed=600)
    report = check(step(job, on), job, on)
    assert_safe(report)
    assert "x reached its start position from below (backlash 0.05)" in report.result().assumptions


def test_a_path_too_dense_to_follow_is_refused_not_believed() -> None:
    job = Job()
    for k in range(2 * path_kernels.WINDOW + 50):
        job.line(x=0.001 * (k % 2), feed=6000)
    job.line(x=1.0)
    on = dataclasses.replace(machine(), axes=(dataclasses.replace(machine().axes[0], steps_per_unit=Fraction(40)),))
    done = Stepped([0], [[(400_000_000 + 200_000 * k, 1) for k in range(40)]], [], 1_000_000_000)
    report = check(done, job, on)
    assert {f.code.label for f in report.findings} == {"GP801"}
    assert "dense" in report.findings[0].message


def test_no_kernel_of_the_checker_counts_who_holds_its_arrays(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """That took most of its time; compiled code without it leaves the holders as they are."""
    kernels = [
        value for file in (path_kernels, walk_kernels) for value in vars(file).values() if isinstance(value, Kernel)
    ]
    assert len(kernels) > 10
    assert all(kernel.borrows for kernel in kernels)
    monkeypatch.setenv("GPROOF_CACHE_DIR", str(tmp_path))  # only of what was compiled just now is the code known
    compiled: Any = dispatcher(walk_kernels.surround, {})
    near = np.array([[-1.0, 1.0]])
    backlash = walk_state.Backlash(np.array([3]), np.array([-1]))
    ints, floats = np.zeros((12, 2), np.int64), np.zeros((12, 2))
    table = dict.fromkeys(walk_state.Motors._fields, ints[0])
    table |= dict.fromkeys(("spu",), floats[0]) | dict.fromkeys(("speed", "acceleration", "knots"), floats)
    motors = walk_state.Motors(**table)  # type: ignore[arg-type]
    arrays = [near, *backlash, ints, floats, *motors]
    held = [sys.getrefcount(array) for array in arrays]
    for _ in range(3):
        compiled(0, backlash.at, backlash, motors, near)
        assert near.tolist() == [[2.0, 4.0]]
        assert [sys.getrefcount(array) for array in arrays] == held
    assert all("NRT_" not in code for code in compiled.inspect_asm().values())
