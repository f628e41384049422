"""What compensation adds to limits: against motor positions sampled along the path, by another computation.

The oracle walks the rows point by point, works out where each motor may be in every reading of pitch tables and
backlash, and Z with the height map by its own bilinear formula. A job that ``Limits`` calls SAFE must have all of
these inside; one that it calls UNSAFE must have a position outside; the rest is UNKNOWN.
"""

from __future__ import annotations

import dataclasses
import math
import random
from fractions import Fraction

import numpy as np
import pytest
from passes.motion.traces import Path
from support.campaigns import seeds

from gproof.ir.finding import Findings
from gproof.ir.machine import Area, Axis, AxisKind, Machine, PitchTable, Slave
from gproof.ir.setup import NOTHING, CylinderMap, HeightMap, Interval, Setup
from gproof.ir.trace import HEIGHT_MAP, Plane, Trace, chunks
from gproof.ir.verdict import PropertyResult, Verdict
from gproof.passes.checks.limits.soft_limits import Limits
from gproof.passes.checks.zones.zones import Areas
from gproof.passes.geometry.extent_kernels import Extents, boxed_rows, room_beyond, row_boxes
from gproof.passes.geometry.height_map import Heights
from gproof.passes.geometry.height_span_kernels import height_spans
from gproof.passes.geometry.pitch import axis_position, exact_motor_position, motor_position, steepest

TABLE = PitchTable(machine=(0.0, 50.0, 200.0, 300.0), calibrated=(0.0, 50.01, 200.03, 299.98))


def judged(trace: Trace, machine: Machine, setup: Setup = NOTHING) -> tuple[PropertyResult, list[str]]:
    findings = Findings()
    check = Limits(machine, setup, findings)
    for chunk in chunks(trace):
        check.feed(chunk)
    return check.finish(), [f.code.label for f in findings.kept]


def axis(name: str, low: float | None, high: float | None, **more: object) -> Axis:
    kind = AxisKind.LINEAR if name in "xyz" else AxisKind.ROTARY
    return Axis(name=name, kind=kind, steps_per_unit=Fraction(320), lower=low, upper=high, **more)  # type: ignore[arg-type]


def mill(*axes: Axis) -> Machine:
    wide = [axis(name, -1000.0, 1000.0) for name in "xyza" if name not in [a.name for a in axes]]
    made = Machine(name="test", axes=tuple(sorted([*axes, *wide], key=lambda a: a.index)))
    made.verify()
    return made


def test_a_table_read_by_hand() -> None:
    # The axis is at 50.01 when the motor is at 50: to bring the axis to 50 the motor stays 0.01 short (2.3).
    assert motor_position(TABLE, 50.01) == pytest.approx(50.0)
    assert motor_position(TABLE, 25.005) == pytest.approx(25.0)
    assert axis_position(TABLE, 125.0) == pytest.approx(125.02)
    assert motor_position(TABLE, -10.0) == -10.0
    assert motor_position(TABLE, 399.98) == pytest.approx(400.0)  # the last correction stays
    assert steepest(TABLE) == pytest.approx(100.0 / 99.95)


def test_the_exact_map_is_the_other_one_turned_round() -> None:
    rng = random.Random(7)
    for _ in range(200):
        at = rng.uniform(-50, 400)
        assert float(exact_motor_position(TABLE, at)) == pytest.approx(motor_position(TABLE, at), abs=1e-12)
        assert axis_position(TABLE, motor_position(TABLE, at)) == pytest.approx(at, abs=1e-11)


def test_the_narrower_motor_of_a_gantry_decides() -> None:
    x = axis("x", 0.0, 600.0, slaves=(Slave(joint="a", lower=2.0, upper=598.0),))
    for to, labels in ((598.0, []), (598.5, ["GP301"]), (2.0, []), (1.0, ["GP301"])):
        assert judged(Path(x=300).traverse(x=to).done(), mill(x))[1] == labels


def test_inside_the_limit_but_not_with_the_compensation_is_unknown() -> None:
    x = axis("x", 0.0, 250.0, pitch=TABLE)
    # The motor at 250 has its axis at 250.005 (halfway between 0.03 and -0.02), or is at 249.995 in the other reading.
    for to, labels in ((249.99, []), (249.9999, ["GP320"]), (250.0, ["GP320"]), (250.001, ["GP301"])):
        result, found = judged(Path(x=100).traverse(x=to).done(), mill(x))
        assert found == labels
        assert (
            result.verdict
            is {"": Verdict.SAFE, "GP320": Verdict.UNKNOWN, "GP301": Verdict.UNSAFE}[labels[0] if labels else ""]
        )


def test_backlash_takes_its_amount_from_both_ends() -> None:
    y = axis("y", -20.0, 300.0, backlash=0.05)
    for to, labels in ((299.95, []), (299.96, ["GP320"]), (300.0, ["GP320"]), (-19.95, []), (-19.96, ["GP320"])):
        assert judged(Path().traverse(y=to).done(), mill(y))[1] == labels


def test_an_axis_that_only_stands_at_its_limit_is_not_blamed() -> None:
    y, x = axis("y", 0.0, 300.0, backlash=0.05), axis("x", 0.0, 600.0, backlash=0.05)
    path = Path()
    for k in range(100):
        path.traverse(x=10 + k)
    assert judged(path.done(), mill(x, y))[1] == []
    path = Path()
    for k in range(100):
        path.traverse(x=10 + k)
    assert judged(path.traverse(y=5).traverse(y=0).done(), mill(x, y))[1] == ["GP320"]


def test_an_unknown_offset_is_bounded_by_what_compensation_leaves() -> None:
    x = axis("x", 0.0, 600.0, backlash=0.25, slaves=(Slave(upper=500.0),))
    result, found = judged(Path().frame("work.1.x").traverse(x=0).traverse(x=100).done(), mill(x))
    assert found == []
    (condition,) = result.conditions
    assert condition.terms == (("work.1.x", 1),)
    assert (condition.low, condition.high) == (pytest.approx(0.25), pytest.approx(399.75))


def test_with_the_guard_off_the_travel_is_narrowed_too() -> None:
    x = axis("x", 0.0, 600.0, backlash=0.25, travel_lower=-5.0, travel_upper=605.0)
    for to, labels in ((604.5, ["GP307"]), (604.9, ["GP320", "GP307"]), (606.0, ["GP301", "GP307"])):
        path = Path(x=300).state(guards_off=("machine_area",)).traverse(x=to)
        assert judged(path.done(), mill(x))[1] == labels


def oracle(trace: Trace, machine: Machine, heights: HeightMap | None) -> tuple[bool, bool]:
    """(some motor may be outside its limits, some axis is certainly outside its own)."""
    may = must = False
    moved: set[str] = set()
    place = list(trace.sections[0].start)
    rows = trace.sections[0].rows
    for k in range(len(rows)):
        to = rows["to"][k].tolist()
        for point in points(place, to, rows["center"][k].tolist(), int(rows["turns"][k])):
            lift = bilinear(heights, point[0], point[1]) if heights is not None else 0.0
            for one in machine.axes:
                plain = point[one.index]
                at = plain + (lift if one.name == "z" else 0.0)
                if plain != trace.sections[0].start[one.index] or (one.name == "z" and heights is not None):
                    moved.add(one.name)
                for drive in one.drives():
                    assert drive.lower is not None and drive.upper is not None
                    must |= any(not drive.lower - 1e-9 <= p <= drive.upper + 1e-9 for p in (plain, at))
                    reading = [at]
                    if drive.pitch is not None:
                        shift = correction(drive.pitch, at)
                        reading += [at - shift[0], at + shift[1]]
                    for motor in reading:
                        for slack in (-drive.backlash, 0.0, drive.backlash):
                            may |= one.name in moved and not drive.lower - 2e-9 <= motor + slack <= drive.upper + 2e-9
        place = to
    return may, must


def correction(table: PitchTable, at: float) -> tuple[float, float]:
    """How far the axis is beyond its motor: where the axis, and where the motor, is at ``at``."""
    found = []
    for key in (table.calibrated, table.machine):
        pairs = list(zip(key, (c - m for m, c in zip(table.machine, table.calibrated, strict=True)), strict=True))
        if at <= pairs[0][0]:
            found.append(pairs[0][1])
        elif at >= pairs[-1][0]:
            found.append(pairs[-1][1])
        else:
            k = next(k for k in range(len(pairs) - 1) if pairs[k][0] <= at <= pairs[k + 1][0])
            (a, u), (b, v) = pairs[k], pairs[k + 1]
            found.append(u + (v - u) * (at - a) / (b - a))
    return found[0], found[1]


def bilinear(heights: HeightMap, x: float, y: float) -> float:
    u, v = (x - heights.x) / heights.size, (y - heights.y) / heights.size
    h = heights.heights
    if not (0 <= u <= len(h[0]) - 1 and 0 <= v <= len(h) - 1):
        return 0.0
    total = 0.0
    for j, row in enumerate(h):
        for i, height in enumerate(row):
            total += max(0.0, 1 - abs(u - i)) * max(0.0, 1 - abs(v - j)) * (height - h[0][0])
    return total


def points(begin: list[float], end: list[float], center: list[float], turns: int) -> list[list[float]]:
    shares = [k / 100 for k in range(101)]
    found = [[a + (b - a) * t for a, b in zip(begin, end, strict=True)] for t in shares]
    if turns:
        r0, r1 = (math.hypot(p[0] - center[0], p[1] - center[1]) for p in (begin, end))
        angle = math.atan2(begin[1] - center[1], begin[0] - center[0])
        sweep = math.atan2(end[1] - center[1], end[0] - center[0]) - angle
        sweep = sweep % (2 * math.pi) or 2 * math.pi
        sweep = sweep if turns > 0 else sweep - 2 * math.pi if sweep < 2 * math.pi else -sweep
        for point, t in zip(found, shares, strict=True):
            radius = r0 + (r1 - r0) * t
            point[0] = center[0] + radius * math.cos(angle + sweep * t)
            point[1] = center[1] + radius * math.sin(angle + sweep * t)
    return found


def a_table(rng: random.Random) -> PitchTable:
    count = rng.randint(1, 5)
    machine = sorted({round(rng.uniform(-60, 160), 1) for _ in range(count)})
    return PitchTable(
        machine=tuple(machine), calibrated=tuple(at * 1.0005 + rng.uniform(-0.02, 0.02) for at in machine)
    )


def a_machine(rng: random.Random) -> Machine:
    axes = []
    for name, low, high in (("x", -1.0, 100.0), ("y", -1.0, 80.0), ("z", -20.0, 10.0)):
        slaves = []
        if rng.random() < 0.4:
            slaves.append(
                Slave(
                    lower=low + rng.choice([-0.5, 0.0, 0.3]), upper=high + rng.choice([-0.2, 0.0, 1.0]),
                    pitch=a_table(rng) if rng.random() < 0.5 else None,
                )
            )  # fmt: skip
        axes.append(
            axis(
                name, low, high, backlash=rng.choice([0.0, 0.0, 0.05]), slaves=tuple(slaves),
                pitch=a_table(rng) if rng.random() < 0.5 else None,
            )
        )  # fmt: skip
    return mill(*axes)


def a_path(rng: random.Random, lifted: bool) -> Trace:
    path = Path(x=20, y=20, z=0)
    if lifted:
        path.state(following=(HEIGHT_MAP,))
    for _ in range(rng.randint(1, 4)):
        z = rng.choice([0.0, 9.9, 9.99, -19.9, -19.99, rng.uniform(-21, 11)])
        x, y = rng.choice([99.9, 99.97, -0.99, rng.uniform(-1, 100)]), rng.choice([79.96, rng.uniform(-1, 80)])
        if rng.random() < 0.4:
            center = ((path.place[0] + x) / 2, (path.place[1] + y) / 2)
            if math.hypot(x - path.place[0], y - path.place[1]) > 1.0:
                path.arc(600, rng.choice([1, -1]), center, Plane.XY, x=x, y=y, z=z)
        else:
            path.traverse(x=x, y=y, z=z)
    return path.done()


@pytest.mark.parametrize("seed", seeds(40, 2000))
def test_safe_means_that_no_motor_can_be_outside(seed: int) -> None:
    rng = random.Random(seed)
    machine = a_machine(rng)
    heights = None
    if rng.random() < 0.6:
        grid = tuple(tuple(rng.uniform(-0.3, 0.3) for _ in range(4)) for _ in range(3))
        heights = HeightMap(x=rng.uniform(-10, 40), y=rng.uniform(-10, 40), size=rng.choice([7.0, 20.0]), heights=grid)
    trace = a_path(rng, heights is not None)
    result, labels = judged(trace, machine, dataclasses.replace(NOTHING, height_map=heights))
    may, must = oracle(trace, machine, heights)
    if result.verdict is Verdict.SAFE:
        assert not may
    if result.verdict is Verdict.UNSAFE:
        slaves = [tuple(dataclasses.replace(b, **narrow(b)) for b in a.slaves) for a in machine.axes]
        narrowed = [dataclasses.replace(a, **narrow(a), slaves=b) for a, b in zip(machine.axes, slaves, strict=True)]
        assert oracle(trace, dataclasses.replace(machine, axes=tuple(narrowed)), heights)[1], labels
    if must:
        assert result.verdict is not Verdict.SAFE


def narrow(motor: Axis | Slave) -> dict[str, float]:
    """By what sampled points of an arc may miss its extreme."""
    assert motor.lower is not None and motor.upper is not None
    return {"lower": motor.lower + 0.02, "upper": motor.upper - 0.02}


def test_the_cases_above_are_of_all_three_kinds() -> None:
    kinds = set()
    for seed in range(60):
        rng = random.Random(seed)
        kinds.add(judged(a_path(rng, False), a_machine(rng))[0].verdict)
    assert kinds == set(Verdict)


def test_a_height_map_counts_only_where_it_was_measured_and_only_while_it_is_on() -> None:
    heights = HeightMap(x=0.0, y=0.0, size=10.0, heights=((0.0, 0.0), (0.0, 0.5)))
    setup = dataclasses.replace(NOTHING, height_map=heights)
    z = axis("z", -5.0, 5.0)
    on = {"following": (HEIGHT_MAP,)}
    # Over the far corner 0.5 is added: 4.6 becomes 5.1. Beside the grid nothing is.
    assert judged(Path().state(**on).traverse(z=4.6).traverse(x=10, y=10).done(), mill(z), setup)[1] == ["GP301"]
    assert judged(Path().state(**on).traverse(z=4.6).traverse(x=10).done(), mill(z), setup)[1] == []
    across = Path(y=5).state(**on).traverse(z=4.6).traverse(x=10, y=7).traverse(x=0, y=10)
    assert judged(across.done(), mill(z), setup)[1] == ["GP320"]
    assert judged(Path().traverse(z=4.6).traverse(x=10, y=10).done(), mill(z), setup)[1] == []
    beside = Path(x=20).state(**on).traverse(z=4.6).traverse(y=30).done()
    assert judged(beside, mill(z), setup)[1] == []
    unknown = Path(x=20).state(**on).frame("work.1.x").traverse(z=4.6).done()
    assert "GP320" in judged(unknown, mill(z), setup)[1]


def cylinder(**values: float) -> Setup:
    return dataclasses.replace(NOTHING, cylinder=CylinderMap(**values))


def test_y_on_a_cylinder_is_judged_by_what_a_may_turn() -> None:
    # Radius 20: a turn is 125.66 mm of Y. A may turn from -90 to 90 degrees: 31.4159 mm to either side.
    a = axis("a", -90.0, 90.0)
    machine = mill(a, axis("y", 0.0, 200.0))
    setup = cylinder(radius=20.0, y=100.0, zero=100.0)
    for to, labels in ((131.4, []), (131.42, ["GP301"]), (68.6, []), (68.5, ["GP301"])):
        assert judged(Path(y=100).traverse(y=to).done(), machine, setup)[1] == labels
    # Where A is 0 is not stated: at machine Y 0, or at the axis of rotation. What fits neither is certain.
    open_zero = cylinder(radius=20.0, y=10.0)
    for to, labels in ((31.4, []), (31.5, ["GP320"]), (41.4, ["GP320"]), (41.5, ["GP301"])):
        assert judged(Path(y=0).traverse(y=to).done(), machine, open_zero)[1] == labels


def test_what_a_mapping_needs() -> None:
    machine = mill(axis("a", -90.0, 90.0), axis("y", 0.0, 200.0))
    turn = Path().traverse(y=5.0)
    assert "GP321" in judged(turn.done(), machine, cylinder(y=100.0))[1]
    assert "GP321" in judged(Path().traverse(y=5.0).done(), machine, cylinder(radius=20.0))[1]
    assert judged(Path().traverse(y=5.0).done(), machine, cylinder(radius=20.0, y=250.0, zero=0.0))[1] == ["GP306"]
    both = Path().traverse(y=5.0).traverse(a=10.0).done()
    assert judged(both, machine, cylinder(radius=20.0, y=100.0, zero=0.0))[1] == ["GP321"]
    without = dataclasses.replace(machine, axes=machine.axes[:3])
    assert "GP321" in judged(Path().traverse(y=5.0).done(), without, cylinder(radius=20.0, y=100.0))[1]


def test_a_height_map_on_a_cylinder_is_not_known() -> None:
    heights = HeightMap(x=0.0, y=0.0, size=10.0, heights=((0.0, 0.0), (0.0, 0.5)))
    setup = dataclasses.replace(cylinder(radius=20.0, y=100.0, zero=0.0), height_map=heights)
    path = Path().state(following=(HEIGHT_MAP,)).traverse(x=5)
    assert judged(path.done(), mill(), setup)[1] == ["GP322"]
    assert judged(Path().traverse(x=5).done(), mill(), setup)[1] == []


def test_an_interval_of_an_offset_is_held_against_what_compensation_leaves() -> None:
    x = axis("x", 0.0, 600.0, backlash=0.25)
    setup = dataclasses.replace(NOTHING, work={(1, "x"): Interval(0.0, 10.0)})
    result, labels = judged(Path(x=5).frame("work.1.x").traverse(x=0).done(), mill(x), setup)
    assert (result.verdict, labels) == (Verdict.UNKNOWN, ["GP304"])


def areas(trace: Trace, machine: Machine, setup: Setup) -> tuple[Verdict, list[str]]:
    findings = Findings()
    check = Areas(machine, setup, findings)
    for chunk in chunks(trace):
        check.feed(chunk)
    return check.finish().verdict, [f.code.label for f in findings.kept]


def magazine(*z: float) -> Machine:
    area = Area(name="tool_change", box=((50.0, 60.0), (0.0, 40.0), (z[0], z[1])))
    return dataclasses.replace(mill(), tool_change_area=area)


def test_the_tool_change_area_with_a_height_map() -> None:
    heights = HeightMap(x=0.0, y=0.0, size=100.0, heights=((0.0, 0.4), (0.0, 0.4)))
    setup = dataclasses.replace(NOTHING, height_map=heights)
    on = {"following": (HEIGHT_MAP,)}
    machine = magazine(-100.0, -10.0)
    # Above -10 the area ends. The map lifts by up to 0.4: -10.2 may be lifted out of it, -9.9 is never lowered into it.
    for z, labels in ((-9.9, []), (-10.2, ["GP311"]), (-10.5, ["GP310"])):
        path = Path(x=10, y=10, z=z).state(**on).traverse(x=90)
        assert areas(path.done(), machine, setup)[1] == labels
    assert areas(Path(x=10, y=10, z=-10.2).traverse(x=90).done(), machine, setup)[1] == ["GP310"]
    under = magazine(-10.0, 0.0)
    for z, labels in ((-10.5, []), (-10.2, ["GP311"]), (-9.9, ["GP310"])):
        path = Path(x=10, y=10, z=z).state(**on).traverse(x=90)
        assert areas(path.done(), under, setup)[1] == labels


def test_the_tool_change_area_while_y_turns_a() -> None:
    machine = magazine(-100.0, -10.0)
    through = Path(x=55, y=100, z=-20).traverse(y=-100).done()
    assert areas(through, machine, cylinder(radius=20.0, y=150.0)) == (Verdict.SAFE, [])
    assert areas(through, machine, cylinder(radius=20.0, y=20.0)) == (Verdict.UNSAFE, ["GP310"])
    assert areas(through, machine, cylinder(radius=20.0)) == (Verdict.UNKNOWN, ["GP311"])


def test_both_speeds_bound_heights_and_extents_alike() -> None:
    rng = random.Random(11)
    grid = tuple(tuple(rng.uniform(-0.3, 0.3) for _ in range(6)) for _ in range(5))
    heights = Heights(HeightMap(x=-3.0, y=2.0, size=13.0, heights=grid))
    path = Path(x=20, y=20, z=0).state(following=(HEIGHT_MAP,))
    for k in range(300):
        x, y = rng.uniform(-20, 100), rng.uniform(-20, 80)
        if k % 50 == 20:
            path.frame("work.1.x")
        if k % 50 == 25:
            path.frame()
        if rng.random() < 0.4:
            center = ((path.place[0] + x) / 2, (path.place[1] + y) / 2)
            path.arc(600, rng.choice([1, -1, 2]), center, Plane.XY, x=x, y=y)
        else:
            path.traverse(x=x, y=y, z=rng.uniform(-21, 11))
    (chunk,) = chunks(path.done())
    rows, trace = chunk.rows, chunk.trace
    known = np.array([[form == () for form in frame] for frame in trace.frames], dtype=np.uint8)
    states = np.zeros(len(trace.states), dtype=np.int64)
    lower, upper = np.full((2, 6), -15.0), np.full((2, 6), 70.0)
    results = []
    for spans_of, boxes_of in ((height_spans, row_boxes), (height_spans.compiled(), row_boxes.compiled())):
        spans = np.zeros((len(rows), 2))
        on = np.array([0, 1], dtype=np.uint8)
        columns = (rows["op"], rows["to"], rows["center"], rows["turns"], rows["plane"], rows["frame"])
        start = np.array(chunk.start)
        spans_of(*columns, rows["state"], start, chunk.start_frame, on, known, heights.grid, heights.heights, spans)
        low, high = np.full((2 * len(trace.frames), 6), math.inf), np.full((2 * len(trace.frames), 6), -math.inf)
        where = np.full(low.shape, -1, dtype=np.int64)
        bad = room_beyond(64)
        count = boxes_of(
            boxed_rows(rows), states, np.array(chunk.start), known, lower, upper,
            Extents(low, high, where, where.copy()), bad, spans,
        )  # fmt: skip
        results.append((spans, low, high, count, *bad))
    assert results[0][3] > 0 and (results[0][0] != 0).any()
    for slow, fast in zip(*results, strict=True):
        assert np.array_equal(slow, fast)
