"""The checker's own rows over a height map: against Z + height in exact fractions; where Z jumps there are none."""

from __future__ import annotations

import dataclasses
import math
import random
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from passes.motion.reference_motion import expand
from passes.motion.test_height_compensation import MACHINES, ON, WEDGE, Raised, a_map, a_path, lowered, using
from passes.motion.traces import Path, machine
from support.campaigns import seeds
from verify.kernel.test_stream import damaged
from verify.path_oracle import FINE, follows
from verify.reference_stepper import Stepped

from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.setup import HeightMap, Setup
from gproof.ir.stream import Motor, StepStream
from gproof.ir.trace import Edge, Op, Plane, Trace, Wait
from gproof.ir.verdict import Verdict
from gproof.verify.explain.stream_report import StreamReport
from gproof.verify.kernel import lifted_path as module
from gproof.verify.kernel.lifted_path import Lifted, Lifting, Unfollowed
from gproof.verify.kernel.proof import Proof
from gproof.verify.kernel.rows import row_arrays, tables_of
from gproof.verify.stream import validate


def motors(on: Machine) -> tuple[Motor, ...]:
    return tuple(
        Motor(name=a.name, axis=a.index, steps_per_unit=a.steps_per_unit)
        for a in on.axes
        if a.steps_per_unit is not None
    )


def raised(trace: Trace, setup: Setup, on: Machine, number: int = 0) -> Lifted:
    stream = StepStream(tick_frequency=1, motors=motors(on))
    rows = row_arrays(trace.sections[number], tables_of(stream, trace), Proof())
    assert rows is not None
    return Lifting(trace, setup.height_map, motors(on)).section(number, rows)


def turns(values: list[float]) -> int:
    way = [b > a for a, b in pairwise(values) if a != b]
    return sum(a != b for a, b in pairwise(way))


@pytest.mark.parametrize("seed", seeds(3, 200))
def test_chords_are_on_the_raised_path_and_turn_as_it_does(seed: int) -> None:
    rng = random.Random(4000 + seed)
    area, on = a_map(rng, steep=rng.choice([0.001, 0.01, 0.2])), MACHINES[seed % 3]
    trace = a_path(rng, area)
    made, exact = raised(trace, using(area), on), Raised(trace, using(area))
    steps = [abs(float(a.steps_per_unit)) for a in on.axes[:3] if a.steps_per_unit is not None]
    place, share, before = made.start.tolist(), Fraction(0), -1
    for n, row in enumerate(made.origin.tolist()):
        to = made.rows.to[n].tolist()
        if row != before:
            share, before = Fraction(0), row
        last = n + 1 == len(made.origin) or made.origin[n + 1] != row
        if made.rows.slack[n] > 0.0:
            goal = Fraction(1) if last else exact.share_of(row, to, share)
            for k in range(1, 6):
                point = exact.at(row, share + (goal - share) * Fraction(k, 5))
                for i in range(3):
                    chord = Fraction(place[i]) + (Fraction(to[i]) - Fraction(place[i])) * Fraction(k, 5)
                    assert abs(float(chord - point[i])) * steps[i] <= module.CHORD + 1e-6
            share = goal
        elif made.rows.op[n] < Op.DWELL:
            assert [float(v) for v in exact.at(row, Fraction(1))] == pytest.approx(to[:3], abs=1e-12)
        place = to
    if ((made.rows.op == Op.ARC) & (made.rows.slack == 0.0)).any():
        return  # raised as it is; its ends alone do not show where Z turns
    # A hundred points of each row see no more turns of Z than the chords make, but for what rounding makes.
    rows = [r for r in range(len(trace.sections[0].rows)) if trace.sections[0].rows["op"][r] < Op.DWELL]
    seen = [float(made.start[2]), *(float(exact.at(r, Fraction(k, 100))[2]) for r in rows for k in range(1, 101))]
    seen = [seen[0], *(b for a, b in pairwise(seen) if abs(b - a) > 1e-9)]
    assert turns(seen) <= turns([float(made.start[2]), *made.rows.to[:, 2].tolist()])


@pytest.mark.parametrize("seed", seeds(8, 200))
def test_no_line_within_the_allowance_is_shorter_than_the_time_at_full_feed(seed: int) -> None:
    """The shortest of many ways through points of the raised path still takes what the checker asks for."""
    rng = random.Random(5000 + seed)
    area, on = a_map(rng, steep=rng.choice([0.01, 0.2, 1.0])), MACHINES[seed % 3]
    trace = a_path(rng, area)
    made, exact = raised(trace, using(area), on), Raised(trace, using(area))
    ends = np.vstack([made.start, made.rows.to])
    for row in sorted(set(made.origin[made.rows.slack > 0.0].tolist())):
        at = np.flatnonzero(made.origin == row)
        if trace.sections[0].rows["feed"][row] <= 0.0 or len(at) < 4:
            continue
        lengths = np.sqrt(((ends[at + 1] - ends[at])[:, :3] ** 2).sum(axis=1))
        asked = float((lengths / made.rows.feed[at]).sum())
        count = rng.choice([len(at), 3 * len(at)])
        points = np.array([[float(v) for v in exact.at(row, Fraction(k, count))] for k in range(count + 1)])
        way = float(np.sqrt((np.diff(points, axis=0) ** 2).sum(axis=1)).sum())
        assert way / float(trace.sections[0].rows["feed"][row]) >= asked * (1 - 1e-9)


def bowl(edge: float) -> HeightMap:
    return HeightMap(x=-10.0, y=-10.0, size=10.0, heights=((0.0, edge, edge), (edge, -0.3, edge), (edge, edge, edge)))


@pytest.mark.parametrize(("beyond", "jumps"), [(0.0, False), (1e-12, False), (1e-7, True), (1e-4, True), (0.5, True)])
@pytest.mark.parametrize("plane", [Plane.XY, Plane.YZ])
def test_an_arc_that_bulges_over_the_edge_is_not_accepted(beyond: float, jumps: bool, plane: Plane) -> None:
    """However little: inside is a height, outside is none."""
    if plane is Plane.XY:
        path = Path(x=-2, y=8 + beyond).state(following=ON).arc(600, -1, (0, 8 + beyond), x=2, y=8 + beyond)
    else:
        path = Path(y=8 + beyond, z=2).state(following=ON).arc(600, -1, (8 + beyond, 0), plane, y=8 + beyond, z=-2)
    trace = path.whole()
    if jumps:
        with pytest.raises(Unfollowed):
            raised(trace, using(bowl(0.1)), machine())
    else:
        raised(trace, using(bowl(0.1)), machine())
    raised(trace, using(bowl(0.0)), machine())


def test_a_row_over_the_whole_map_is_seen_to_jump_twice_or_not_at_all() -> None:
    through = Path(x=-20, y=0).state(following=ON).feed(600, x=20).whole()
    with pytest.raises(Unfollowed) as caught:
        raised(through, using(bowl(0.1)), machine())
    assert caught.value.row == 0
    made = raised(through, using(bowl(0.0)), machine())
    assert made.rows.to[:-1, 0].tolist() == [-10.0, 0.0, 10.0, 20.0]
    assert made.rows.to[:-1, 2].tolist() == [0.0, -0.3, 0.0, 0.0]
    # It only touches the corner, where the height is that of the first point.
    touching = Path(x=-20, y=0).state(following=ON).feed(600, x=0, y=-20).whole()
    raised(touching, using(bowl(0.1)), machine())


def test_sections_that_are_reached_with_the_map_on_and_off_need_no_height_there() -> None:
    def graph(x: float) -> Trace:
        path = Path(x=x, y=5).state(following=ON).other(Op.STOP).end_section().other(Op.STOP).end_section()
        path.state().other(Op.STOP).end_section().other(Op.END)
        trace = path.whole()
        go = [Edge(wait=Wait.OPERATOR, outcome=name, target=at) for name, at in (("a", 1), ("b", 2), ("c", 3))]
        trace.sections[0].edges = (go[0], go[1])
        trace.sections[1].edges = trace.sections[2].edges = (go[2],)
        return trace

    with pytest.raises(Unfollowed):
        raised(graph(5.0), using(WEDGE), machine(), 3)
    assert raised(graph(0.0), using(WEDGE), machine(), 3).start[2] == 0.0


def test_a_map_that_is_no_grid_or_lies_far_away_is_refused() -> None:
    trace = Path().state(following=ON).feed(600, x=20).whole()
    stream = lowered(trace, using(WEDGE), machine())
    for change in (
        {"heights": ((0.0, math.nan), (0.0, 1.0))}, {"heights": ((0.0, 1.0),)}, {"size": 0.0}, {"x": math.inf},
        {"heights": ((0.0, 1.0), (2.0,))},
    ):  # fmt: skip
        other = using(dataclasses.replace(WEDGE, **change))  # type: ignore[arg-type]
        assert {f.code.label for f in validate(stream, trace, machine(), other).findings} == {"GP810"}
    high = dataclasses.replace(WEDGE, heights=((0.0, 1e12), (0.0, 1e12)), size=1e-3)
    assert validate(stream, trace, machine(), using(high)).findings


def test_axes_are_named_as_everywhere() -> None:
    assert AXIS_NAMES[2] == "z" and module.PAIRS[int(Plane.XZ)] == (2, 0)


# --- brute force --------------------------------------------------------------------------------------------


def small_job(rng: random.Random) -> tuple[HeightMap, Trace]:
    """A few rows of less than a millimetre over cells of 0.2 mm that rise by up to ten steps."""
    heights = tuple(tuple(rng.uniform(-0.03, 0.03) for _ in range(6)) for _ in range(6))
    area = HeightMap(x=-0.1, y=-0.1, size=0.2, heights=heights)
    path = Path(x=0.4, y=0.4).state(following=ON)
    for _ in range(4):
        kind = rng.random()
        if kind < 0.6:
            path.feed(600, x=rng.uniform(-0.1, 0.9), y=rng.uniform(-0.1, 0.9))
        elif kind < 0.75:
            path.feed(600, z=rng.uniform(-0.1, 0.1))
        else:
            x, y = path.place[:2]
            radius = min(x + 0.1, 0.9 - x, y + 0.1, 0.9 - y) / 2
            if radius > 0.02:
                path.arc(600, rng.choice([1, -1]), (x + radius, y), z=path.place[2] + rng.uniform(-0.05, 0.05))
    return area, path.whole()


def samples(area: HeightMap, trace: Trace, on: Machine) -> np.ndarray:
    """(n, motors) the raised path in steps, neighbours at most ``FINE`` apart."""
    h = np.array(area.heights)
    rows, place = trace.sections[0].rows, np.array(trace.sections[0].start)
    parts = [place[np.newaxis, :]]
    for k in range(len(rows)):
        to = rows["to"][k]
        length = float(np.abs(to - place).sum())
        turning = rows["op"][k] == Op.ARC
        radius = math.dist(place[:2], rows["center"][k][:2])
        count = math.ceil((length + (2 * math.pi * radius if turning else 0.0)) * 1.5 * 320 / FINE) + 1
        share = np.linspace(0.0, 1.0, count)[1:, np.newaxis]
        points = place + (to - place) * share
        if turning:  # full circles only
            first = math.atan2(place[1] - rows["center"][k][1], place[0] - rows["center"][k][0])
            way = first + 2 * math.pi * int(rows["turns"][k]) * share[:, 0]
            points[:, 0] = rows["center"][k][0] + radius * np.cos(way)
            points[:, 1] = rows["center"][k][1] + radius * np.sin(way)
        parts.append(points)
        place = to
    path = np.concatenate(parts)
    u, v = (path[:, 0] - area.x) / area.size, (path[:, 1] - area.y) / area.size
    i, j = np.clip(u.astype(int), 0, h.shape[1] - 2), np.clip(v.astype(int), 0, h.shape[0] - 2)
    s, t = u - i, v - j
    path[:, 2] += (1 - t) * ((1 - s) * h[j, i] + s * h[j, i + 1]) + t * ((1 - s) * h[j + 1, i] + s * h[j + 1, i + 1])
    path[:, 2] -= h[0, 0]
    found: np.ndarray = path[:, [m.axis for m in motors(on)]] * np.array([float(m.steps_per_unit) for m in motors(on)])
    return found


@pytest.mark.parametrize("seed", seeds(4, 200))
def test_position_check_agrees_with_brute_force(seed: int) -> None:
    """Random damage, and random other maps: accepted only if 1.11 steps explain it, always if 1.02 do."""
    rng = random.Random(6000 + seed)
    on = machine()
    area, trace = small_job(rng)
    path = samples(area, trace, on)
    for kind in range(6):
        used = area
        if kind >= 4:
            heights = [list(row) for row in area.heights]
            heights[rng.randint(1, 5)][rng.randint(1, 5)] += rng.uniform(-4, 4) / 320
            used = dataclasses.replace(area, heights=tuple(tuple(row) for row in heights))
        stream = lowered(trace, using(used), on)
        section = stream.sections[0]
        clean = Stepped(list(section.start), [expand(stream, 0, m) for m in range(4)], [], section.duration)
        done = clean if kind >= 4 else damaged(clean, rng)
        given = dataclasses.replace(stream, sections=[done.section()])
        report = validate(given, trace, on, using(area))
        off = next(p for p in report.properties if p.name == "stream-position").verdict is not Verdict.SAFE
        if off:
            assert not follows(path, done, 1.02) or done.start != clean.start or wrong_end(report)
        else:
            assert follows(path, done, 1.11)


def wrong_end(report: StreamReport) -> bool:
    """Steps that follow the path but do not end, or begin, at the nearest ones."""
    return {"GP808"} == {f.code.label for f in report.findings} - {"GP803", "GP804", "GP805", "GP806"}


def test_both_speeds_of_the_kernel_say_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = random.Random(7000)
    for _ in range(3):
        area, trace = small_job(rng)
        stream = lowered(trace, using(area), machine())
        other = dataclasses.replace(area, heights=(*area.heights[:5], tuple(h + 0.05 for h in area.heights[5])))
        for used in (area, other):
            reports = []
            for mode in ("python", "numba"):
                monkeypatch.setenv("GPROOF_KERNELS", mode)
                reports.append(validate(stream, trace, machine(), using(used)))
            assert reports[0] == reports[1]
