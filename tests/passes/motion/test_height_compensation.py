"""Rows over a height map: against Z + height by another computation, in exact fractions, and lines made by hand.

What the passes follow is compared point by point with the row it came from, and the finished steps with the raised
path at their own time; the stream checker has to take every such stream and to refuse those of another map.
"""

from __future__ import annotations

import dataclasses
import math
import random
from fractions import Fraction

import numpy as np
import pytest
from passes.motion.reference_motion import PAIRS, Motion, expand
from passes.motion.traces import Path, machine, validate
from support.campaigns import seeds

from gproof.ir.finding import Findings
from gproof.ir.machine import Machine, PitchTable
from gproof.ir.setup import NOTHING, CylinderMap, HeightMap, Setup
from gproof.ir.stream import StepStream
from gproof.ir.text import print_ir
from gproof.ir.trace import HEIGHT_MAP, Edge, Op, PathMode, Plane, Trace, Wait
from gproof.ir.verdict import Verdict
from gproof.passes.motion.height_compensation import Followed, follow
from gproof.passes.motion.plan import plan
from gproof.passes.motion.step import step

ON = (HEIGHT_MAP,)
ALLOWED = 0.05
"""Steps between what is followed and the row with the map's height (docs/stream.md)."""


WEDGE = HeightMap(x=0.0, y=0.0, size=10.0, heights=((5.0, 5.1, 5.1), (5.0, 5.1, 5.1), (5.0, 5.1, 5.1)))
"""Rises by 0.1 mm from X0 to X10, then level to X20; alike for all Y."""

SADDLE = HeightMap(x=0.0, y=0.0, size=10.0, heights=((1.0, 1.0), (1.0, 1.2)))
"""0.2 * X / 10 * Y / 10 above its first point."""


def using(height_map: HeightMap, *, on: bool = True) -> Setup:
    return Setup(name="map", height_map=dataclasses.replace(height_map, on=on))


def followed(trace: Trace, setup: Setup, on: Machine) -> Followed:
    findings = Findings()
    made = follow(trace, setup, on, findings)
    assert made is not None, [f.message for f in findings.kept]
    made.trace.verify()
    return made


def lowered(trace: Trace, setup: Setup, on: Machine) -> StepStream:
    findings = Findings()
    path = followed(trace, setup, on)
    planned = plan(path.trace, on, findings, path.joined)
    assert planned is not None, [f.message for f in findings.kept]
    planned.verify()
    stream = step(path.trace, planned, on, findings, path.origin)
    assert stream is not None, [f.message for f in findings.kept]
    stream.verify()
    return stream


def refused(trace: Trace, setup: Setup, on: Machine | None = None) -> list[str]:
    findings = Findings()
    assert follow(trace, setup, on or machine(), findings) is None
    return [f.code.label for f in findings.kept]


def found(stream: StepStream, trace: Trace, setup: Setup, on: Machine) -> set[str]:
    return {f.code.label for f in validate(stream, trace, on, setup).findings}


# --- another computation ----------------------------------------------------------------------------------


def added(height_map: HeightMap, x: Fraction, y: Fraction) -> Fraction:
    """The height at a place less that of the first point: four corners by the area opposite to each, exactly."""
    u = (x - Fraction(height_map.x)) / Fraction(height_map.size)
    v = (y - Fraction(height_map.y)) / Fraction(height_map.size)
    rows = [[Fraction(h) for h in row] for row in height_map.heights]
    edge = Fraction(1, 10**9)  # of a cell: on the edge
    if not (-edge <= u <= len(rows[0]) - 1 + edge and -edge <= v <= len(rows) - 1 + edge):
        return Fraction(0)
    u, v = min(max(u, Fraction(0)), Fraction(len(rows[0]) - 1)), min(max(v, Fraction(0)), Fraction(len(rows) - 1))
    i, j = min(math.floor(u), len(rows[0]) - 2), min(math.floor(v), len(rows) - 2)
    s, t = u - i, v - j
    corners = ((0, 0, (1 - s) * (1 - t)), (1, 0, s * (1 - t)), (0, 1, (1 - s) * t), (1, 1, s * t))
    return sum((rows[j + b][i + a] * share for a, b, share in corners), Fraction(0)) - rows[0][0]


class Raised:
    """The rows of a section with the map: points by (row, share), written from the definitions."""

    def __init__(self, trace: Trace, setup: Setup) -> None:
        self.section = trace.sections[0]
        self.on = [HEIGHT_MAP in state.following for state in trace.states]
        assert setup.height_map is not None
        self.map = setup.height_map

    def begin(self, row: int) -> list[float]:
        return list(self.section.start) if row == 0 else self.section.rows["to"][row - 1].tolist()

    def arc(self, row: int) -> tuple[int, int, complex, complex, complex, float]:
        rows, begin = self.section.rows, self.begin(row)
        p, q = PAIRS[Plane(int(rows["plane"][row]))]
        center = complex(rows["center"][row][p], rows["center"][row][q])
        end = rows["to"][row].tolist()
        first, last = complex(begin[p], begin[q]) - center, complex(end[p], end[q]) - center
        turns = int(rows["turns"][row])
        sweep = math.atan2(last.imag, last.real) - math.atan2(first.imag, first.real)
        while turns > 0 and sweep <= 0:
            sweep += 2 * math.pi
        while turns < 0 and sweep >= 0:
            sweep -= 2 * math.pi
        return p, q, center, first, last, sweep + 2 * math.pi * (turns - (1 if turns > 0 else -1))

    def at(self, row: int, share: Fraction) -> list[Fraction]:
        """X, Y, Z with the map's height."""
        rows = self.section.rows
        begin, end = ([Fraction(v) for v in p[:3]] for p in (self.begin(row), rows["to"][row].tolist()))
        now = [a + (b - a) * share for a, b in zip(begin, end, strict=True)]
        if rows["op"][row] == Op.ARC and 0 < share < 1:
            p, q, center, first, last, sweep = self.arc(row)
            radius = abs(first) + (abs(last) - abs(first)) * float(share)
            way = math.atan2(first.imag, first.real) + sweep * float(share)
            now[p], now[q] = (
                Fraction(center.real + radius * math.cos(way)), Fraction(center.imag + radius * math.sin(way))
            )  # fmt: skip
        if self.on[int(rows["state"][row])]:
            now[2] += added(self.map, now[0], now[1])
        return now

    def share_of(self, row: int, point: list[float], before: Fraction) -> Fraction:
        """The share at which a row is at a point of it; ``before``: one that is not behind it."""
        rows, begin, end = self.section.rows, self.begin(row), self.section.rows["to"][row].tolist()
        if rows["op"][row] != Op.ARC:
            axis = max((0, 1), key=lambda a: abs(end[a] - begin[a]))
            return (Fraction(point[axis]) - Fraction(begin[axis])) / (Fraction(end[axis]) - Fraction(begin[axis]))
        p, q, center, first, _, sweep = self.arc(row)
        plain = [*point[:2], point[2] - float(added(self.map, Fraction(point[0]), Fraction(point[1])))]
        there = complex(plain[p], plain[q]) - center
        share = (math.atan2(there.imag, there.real) - math.atan2(first.imag, first.real)) / sweep
        turn = 2 * math.pi / abs(sweep)
        while share < float(before) - 1e-9:
            share += turn
        while share - turn > float(before) + 1e-9:
            share -= turn
        return Fraction(share)


def most_off(path: Followed, trace: Trace, setup: Setup, on: Machine, samples: int = 7) -> float:
    """The most steps that what is followed is off the raised rows, at equal share, in any axis."""
    raised, worst = Raised(trace, setup), 0.0
    section, origin = path.trace.sections[0], path.origin[0].tolist()
    steps = [next((abs(float(a.steps_per_unit)) for a in on.axes if a.index == i), 0.0) for i in range(3)]
    place, share, row_before = list(section.start), Fraction(0), -1
    for n, row in enumerate(origin):
        to = section.rows["to"][n].tolist()
        if trace.sections[0].rows["op"][row] >= Op.DWELL:
            place = to
            continue
        if row != row_before:
            share, row_before = Fraction(0), row
        last = n + 1 == len(origin) or origin[n + 1] != row
        if section.rows["op"][n] == Op.ARC:
            assert last and (n == 0 or origin[n - 1] != row)
            now = np.array([float(v) for v in raised.at(row, Fraction(1))])
            worst = max(worst, float((np.abs(now - to[:3]) * steps).max()))
            place = to
            continue
        goal = Fraction(1) if last else raised.share_of(row, to, share)
        for k in range(1, samples + 1):
            part = Fraction(k, samples)
            exact = raised.at(row, share + (goal - share) * part)
            for i in range(3):
                a, b = Fraction(place[i]), Fraction(to[i])
                worst = max(worst, abs(float(a + (b - a) * part - exact[i])) * steps[i])
        place, share = to, goal
    return worst


# --- by hand ------------------------------------------------------------------------------------------------


def test_a_line_over_a_wedge_is_cut_where_it_ends() -> None:
    trace = Path().state(following=ON).feed(600, x=20, z=-2).done()
    path = followed(trace, using(WEDGE), machine())
    rows = path.trace.sections[0].rows
    assert rows["to"][:, 0].tolist() == [10.0, 20.0]
    assert rows["to"][:, 2].tolist() == pytest.approx([-0.9, -1.9])
    assert path.origin[0].tolist() == [0, 0]
    assert path.joined[0].tolist() == [0, 1]


def test_a_line_in_one_plane_of_the_map_stays_one() -> None:
    trace = Path().state(following=ON).feed(600, x=9, y=7).feed(600, x=2, y=20).done()
    path = followed(trace, using(WEDGE), machine())
    assert path.trace.sections[0].rows["to"][:, 2].tolist() == pytest.approx([0.09, 0.02])
    assert path.origin[0].tolist() == [0, 1]


def test_a_diagonal_over_a_saddle_is_a_parabola() -> None:
    trace = Path().state(following=ON).feed(600, x=10, y=10).done()
    path = followed(trace, using(SADDLE), machine())
    to = path.trace.sections[0].rows["to"]
    shares = to[:, 0] / 10
    assert to[:, 2] == pytest.approx(0.2 * shares**2, abs=1e-12)
    # Chords over d are 0.2 d2 / 4 mm off: 320 steps/mm leave a little over 0.056 for d, 18 of them at least.
    assert 18 <= len(to) <= 40
    assert most_off(path, trace, using(SADDLE), machine()) <= ALLOWED


def test_arcs_stay_arcs_where_the_map_is_level() -> None:
    trace = Path(x=19, y=10).state(following=ON).feed(600, z=-1).arc(600, 1, (15, 10)).arc(600, 1, (12, 10)).done()
    path = followed(trace, using(WEDGE), machine())
    rows = path.trace.sections[0].rows
    assert rows["op"][:2].tolist() == [Op.FEED, Op.ARC]
    assert path.trace.sections[0].start[2] == pytest.approx(0.1)
    assert rows["to"][:2, 2].tolist() == pytest.approx([-0.9, -0.9])
    assert rows["center"][1, 2] == pytest.approx(trace.sections[0].rows["center"][1, 2] + 0.1)
    assert set(rows["op"][2:].tolist()) == {int(Op.FEED)}  # the second circle reaches X5
    assert not rows["turns"][2:].any() and not rows["plane"][2:].any()


def test_moves_of_z_alone_and_what_does_not_move_are_raised_whole() -> None:
    path = Path(x=5, y=5).state(following=ON).traverse(z=-3).dwell(0.1).feed(100, z=-4).other(Op.COOLANT, 1.0)
    trace = path.done()
    made = followed(trace, using(WEDGE), machine())
    assert made.origin[0].tolist() == [0, 1, 2, 3]
    assert made.trace.sections[0].rows["to"][:, 2].tolist() == pytest.approx([-2.95, -2.95, -3.95, -3.95])


def test_without_a_map_the_trace_is_followed_as_it_is() -> None:
    trace = Path().feed(600, x=20).done()
    assert followed(trace, NOTHING, machine()).trace is trace
    assert followed(trace, using(WEDGE, on=False), machine()).trace is trace


def test_a_corner_that_only_the_map_makes_is_no_stop() -> None:
    # At 0.01 of slope the look-ahead angle of 0 would stop at the wedge's end.
    trace = Path().state(following=ON, path_mode=PathMode.EXACT_STOP).feed(600, x=20).done()
    path = followed(trace, using(WEDGE), machine(laf_angle=0.0))
    planned = plan(path.trace, machine(laf_angle=0.0), Findings(), path.joined)
    assert planned is not None
    assert planned.sections[0].rows["exit"].tolist() == pytest.approx([10.0, 0.0])
    shown = path.of_job(planned)
    shown.verify()
    assert shown.sections[0].rows["row"].tolist() == [0, 0]


# --- jumps ----------------------------------------------------------------------------------------------------


def test_where_z_would_jump_there_is_no_stream() -> None:
    out = Path(x=5, y=5).state(following=ON).feed(600, x=30)
    into = Path(x=-5, y=5).state(following=ON).feed(600, x=-4).feed(600, x=15)
    through = Path(x=-5, y=5).state(following=ON).feed(600, x=30)
    off = Path(x=5, y=5).state(following=ON).feed(600, x=6).state().feed(600, x=7)
    arc = Path(x=15, y=10).state(following=ON).arc(600, 1, (21, 10))
    for path, line in ((out, 1), (through, 1), (off, 2), (arc, 1)):
        trace = path.done()
        assert refused(trace, using(WEDGE)) == ["GP521"]
        findings = Findings()
        follow(trace, using(WEDGE), machine(), findings)
        assert findings.kept[0].span.line == line
    # Over the edge at X0, where the height is 0, nothing jumps.
    assert followed(into.done(), using(WEDGE), machine()).trace.sections[0].rows["to"][-1, 2] == pytest.approx(0.1)


def test_switching_where_the_height_is_0_is_no_jump() -> None:
    trace = Path(x=-5, y=5).feed(600, x=0).state(following=ON).feed(600, x=15).done()
    path = followed(trace, using(WEDGE, on=False), machine())
    assert path.trace.sections[0].rows["to"][:, 2].tolist() == pytest.approx([0.0, 0.1, 0.1])
    assert found(lowered(trace, using(WEDGE, on=False), machine()), trace, using(WEDGE, on=False), machine()) == set()
    # The job begins with it on, the first row is without.
    assert refused(Path(x=5, y=5).feed(600, x=6).done(), using(WEDGE)) == ["GP521"]


def test_the_checker_refuses_jumps_too() -> None:
    """A stream that runs along the edge of the map, for a trace that leaves it."""
    inside = Path(x=5, y=5).state(following=ON).feed(600, x=20).done()
    outside = Path(x=5, y=5).state(following=ON).feed(600, x=20.001).done()
    stream = lowered(inside, using(WEDGE), machine())
    assert found(stream, inside, using(WEDGE), machine()) == set()
    assert found(stream, outside, using(WEDGE), machine()) == {"GP810"}
    off = Path(x=5, y=5).state(following=ON).feed(600, x=20).state().feed(600, z=1).done()
    assert found(stream, off, using(WEDGE), machine()) == {"GP810"}
    assert found(stream, inside, NOTHING, machine()) == {"GP810"}
    assert found(stream, inside, using(WEDGE, on=False), machine()) & {"GP808", "GP810"}


@pytest.mark.parametrize("unknown", ["work.1.x", "work.1.y", "work.1.z", "?"])
def test_positions_that_nobody_stated_are_said_to_be_missing(unknown: str) -> None:
    trace = Path(x=5).state(following=ON).frame(unknown).feed(600, x=30, y=1, z=1).done()
    path, findings = followed(trace, using(WEDGE), machine()), Findings()
    assert plan(path.trace, machine(), findings, path.joined) is None
    assert [f.code.label for f in findings.kept] == ["GP503"]


def test_a_map_on_a_cylinder_is_not_followed() -> None:
    trace = Path().state(following=ON).feed(600, x=5).done()
    setup = dataclasses.replace(using(WEDGE), cylinder=CylinderMap(radius=10.0, y=0.0, zero=0.0))
    findings = Findings()
    assert follow(trace, setup, machine(), findings) is None
    assert [f.code.label for f in findings.kept] == ["GP520"]


# --- at random ------------------------------------------------------------------------------------------------


def a_map(rng: random.Random, *, steep: float) -> HeightMap:
    """Mostly of the kind that a probe measures; sometimes with level parts, or in steps of a step."""
    nx, ny, size = rng.randint(2, 7), rng.randint(2, 7), rng.choice([0.5, 2.0, 5.0, 7.3])
    kind = rng.random()
    heights = [[rng.gauss(-8.0, steep * size) for _ in range(nx)] for _ in range(ny)]
    if kind < 0.3:
        heights = [[round(h, 1) for h in row] for row in heights]
    elif kind < 0.5:
        a, b = rng.uniform(-steep, steep), rng.uniform(-steep, steep)
        heights = [[a * i + b * j for i in range(nx)] for j in range(ny)]
    return HeightMap(
        x=rng.choice([0.0, 1.25, rng.uniform(-3, 3)]), y=rng.choice([0.0, rng.uniform(-3, 3)]), size=size,
        heights=tuple(tuple(row) for row in heights),
    )  # fmt: skip


def a_path(rng: random.Random, area: HeightMap) -> Trace:
    """Lines, arcs and helices within the map."""
    wide, deep = (len(area.heights[0]) - 1) * area.size, (len(area.heights) - 1) * area.size

    def place() -> tuple[float, float]:
        if rng.random() < 0.3:  # on grid lines and points
            i, j = rng.randrange(len(area.heights[0])), rng.randrange(len(area.heights))
            return area.x + i * area.size, area.y + (j if rng.random() < 0.5 else rng.uniform(0, 1) * j) * area.size
        return area.x + rng.uniform(0, wide), area.y + rng.uniform(0, deep)

    x, y = place()
    path = Path(x=x, y=y, z=rng.uniform(-2, 2)).state(following=ON, laf_angle=rng.choice([math.nan, 30.0]))
    for _ in range(rng.randint(1, 6)):
        x, y = path.place[:2]
        kind, feed = rng.random(), rng.choice([300.0, 1500.0, 6000.0])
        if kind < 0.35:
            x, y = place()
            path.feed(feed, x=x, y=y, **({"z": rng.uniform(-2, 2)} if rng.random() < 0.3 else {}))
        elif kind < 0.45:
            x, y = place()
            path.traverse(x=x, y=y, a=rng.uniform(-20, 20))
        elif kind < 0.55:
            path.feed(feed, z=rng.uniform(-2, 2))
        elif kind < 0.6:
            path.dwell(0.02)
        elif kind < 0.9:
            room = min(x - area.x, area.x + wide - x, y - area.y, area.y + deep - y) / 2
            if room < 0.05:
                continue
            radius, angle = rng.uniform(0.02, room), rng.uniform(-math.pi, math.pi)
            center = complex(x, y) + radius * complex(math.cos(angle), math.sin(angle))
            end, turns = complex(x, y), rng.choice([1, -1, 2])
            if rng.random() < 0.7:
                end = center + (radius + rng.choice([0.0, 0.001])) * complex(math.cos(angle + 3), math.sin(angle + 3))
            more = {"z": rng.uniform(-2, 2)} if rng.random() < 0.4 else {}
            path.arc(feed, turns, (center.real, center.imag), x=end.real, y=end.imag, **more)
        else:
            plane = rng.choice([Plane.XZ, Plane.YZ])
            p, q = PAIRS[plane]
            room = min(x - area.x, area.x + wide - x, y - area.y, area.y + deep - y) / 2
            if room < 0.05:
                continue
            here = complex(path.place[p], path.place[q])
            radius, angle = rng.uniform(0.02, room), rng.uniform(-math.pi, math.pi)
            center = here + radius * complex(math.cos(angle), math.sin(angle))
            end = center + radius * complex(math.cos(angle + 2), math.sin(angle + 2))
            path.arc(feed, rng.choice([1, -1]), (center.real, center.imag), plane,
                     **{"xyz"[p]: end.real, "xyz"[q]: end.imag})  # fmt: skip
    return path.done()


MACHINES = (
    machine(),
    machine(steps=Fraction(-1600, 7), velocity=60.0, acceleration=300.0, laf_angle=0.0),
    machine(steps=1000, acceleration=1500.0, max_step_frequency=None),
)


@pytest.mark.parametrize("seed", seeds(3, 400))
def test_what_is_followed_stays_close_to_z_and_height(seed: int) -> None:
    rng = random.Random(seed)
    area, on = a_map(rng, steep=rng.choice([0.001, 0.01, 0.2])), MACHINES[seed % 3]
    trace = a_path(rng, area)
    path = followed(trace, using(area), on)
    assert most_off(path, trace, using(area), on) <= ALLOWED + 1e-6, print_ir(trace)


@pytest.mark.parametrize("seed", seeds(5, 240))
def test_every_motor_is_within_its_bound_at_all_times_and_the_checker_agrees(seed: int) -> None:
    rng = random.Random(1000 + seed)
    area, on = a_map(rng, steep=rng.choice([0.001, 0.01, 0.2])), MACHINES[seed % 3]
    trace = a_path(rng, area)
    path = followed(trace, using(area), on)
    planned = plan(path.trace, on, Findings(), path.joined)
    assert planned is not None
    stream = lowered(trace, using(area), on)
    report = validate(stream, trace, on, using(area))
    assert report.verdict is Verdict.SAFE, ([f.message for f in report.findings], print_ir(trace))
    if any(op in (Op.DWELL,) for op in trace.sections[0].rows["op"].tolist()):
        return  # ticks of rests are rounded up: the plan's times are not the stream's
    motion = Motion(path.trace.sections[0], planned.sections[0])
    for m, motor in enumerate(stream.motors):
        n, rate = stream.sections[0].start[m], float(motor.steps_per_unit)
        for tick, direction in expand(stream, 0, m):
            aim = motion.at(tick / stream.tick_frequency)[motor.axis] * rate
            assert abs(n - aim) < 1.0 + 1e-3 and abs(n + direction - aim) < 1.0 + 1e-3
            n += direction


@pytest.mark.parametrize("seed", seeds(4, 90))
def test_a_stream_of_another_map_is_refused(seed: int) -> None:
    """The height of one point that the path comes near is another one, by 3 steps or more where the path is."""
    rng = random.Random(2000 + seed)
    on = MACHINES[seed % 3]
    while True:
        area = a_map(rng, steep=0.01)
        trace = a_path(rng, area)
        steps = abs(float(on.axes[2].steps_per_unit))  # type: ignore[arg-type]
        j, i = rng.randrange(len(area.heights)), rng.randrange(len(area.heights[0]))
        if (i, j) == (0, 0):
            continue
        heights = [list(row) for row in area.heights]
        heights[j][i] += rng.choice([-1, 1]) * 40 / steps
        other = dataclasses.replace(area, heights=tuple(tuple(row) for row in heights))
        raised = Raised(trace, using(area))
        rows = trace.sections[0].rows
        points = [
            raised.at(r, Fraction(k, 16)) for r in range(len(rows)) for k in range(17) if rows["op"][r] < Op.DWELL
        ]
        if max((abs(added(area, p[0], p[1]) - added(other, p[0], p[1])) for p in points), default=0) * steps > 3:
            break
    stream = lowered(trace, using(other), on)
    assert found(stream, trace, using(other), on) == set()
    assert found(stream, trace, using(area), on)
    plain = Path.done(Path())  # nothing moves
    assert found(stream, plain, using(area), on)


def test_a_stream_without_the_map_is_refused() -> None:
    trace = Path().state(following=ON).feed(600, x=20).done()
    flat = Path().feed(600, x=20).done()
    stream = lowered(flat, NOTHING, machine())
    assert found(stream, flat, NOTHING, machine()) == set()
    assert found(stream, trace, using(WEDGE), machine()) & {"GP801", "GP802", "GP808"}
    assert found(lowered(trace, using(WEDGE), machine()), flat, NOTHING, machine()) & {"GP801", "GP802", "GP808"}


def test_problems_name_rows_of_the_trace() -> None:
    path = Path().state(following=ON)
    for n in range(5):
        path.feed(600, x=1.0 + n, y=1.0 + n).dwell(0.01)
    trace = path.done()
    stream = lowered(trace, using(SADDLE), machine())
    assert stream.sections[0].events["row"].tolist() == [1, 3, 5, 7, 9]
    assert found(stream, trace, using(SADDLE), machine()) == set()
    # The last steps of X are missing, then go the wrong way from a place that row 8 has behind it.
    runs = stream.sections[0].runs[0]
    runs["direction"][-1] *= -1
    late = validate(stream, trace, machine(), using(SADDLE)).findings[0]
    assert late.span.line == 10 and "row 9" in late.message and "only reached row 8" in late.message
    for motor in range(3):
        stream.sections[0].runs[motor]["direction"][-1] *= -1
    left = validate(stream, trace, machine(), using(SADDLE)).findings[0]
    assert left.span.line in (9, 10) and ("row 8" in left.message or "row 9" in left.message)


def test_a_pitch_table_of_z_works_behind_the_map() -> None:
    table = PitchTable(machine=(-5.0, 0.0, 5.0), calibrated=(-5.02, 0.0, 5.03))
    base = machine()
    on = dataclasses.replace(
        base, axes=tuple(dataclasses.replace(a, pitch=table) if a.name == "z" else a for a in base.axes)
    )
    trace = Path(x=1, y=1, z=-2).state(following=ON).feed(600, x=9, y=9).feed(600, z=3).feed(600, x=2).done()
    stream = lowered(trace, using(SADDLE), on)
    assert found(stream, trace, using(SADDLE), on) == set()
    assert found(lowered(trace, using(SADDLE), base), trace, using(SADDLE), on)
    # The motor for Z3 and 0.162 of height is at 3.162 of the table's second half: 3.162 * 5 / 5.03.
    at = stream.sections[0].start[2] + sum(d for t, d in expand(stream, 0, 2) if t <= stream.sections[0].duration)
    assert at == round((3 + 0.2 * 0.2 * 0.9) * 5 / 5.03 * 320)


@pytest.mark.parametrize("seed", seeds(6, 120))
def test_backlash_and_pitch_tables_come_behind_the_map(seed: int) -> None:
    rng = random.Random(8000 + seed)
    table = PitchTable(machine=(-5.0, 0.0, 5.0), calibrated=(-5.02, 0.0, 5.03))
    base = MACHINES[seed % 3]
    axes = tuple(
        dataclasses.replace(a, backlash=rng.choice([0.0, 0.02, 0.1]), pitch=table if rng.random() < 0.5 else None)
        if a.name in "xyz"
        else a
        for a in base.axes
    )
    on = dataclasses.replace(base, axes=axes)
    area = a_map(rng, steep=rng.choice([0.001, 0.01, 0.2]))
    trace = a_path(rng, area)
    report = validate(lowered(trace, using(area), on), trace, on, using(area))
    assert report.verdict is Verdict.SAFE, ([f.message for f in report.findings], print_ir(trace))


def test_limits_hold_for_the_raised_z() -> None:
    base = machine()
    on = dataclasses.replace(
        base, axes=tuple(dataclasses.replace(a, lower=-1.0, upper=0.05) if a.name == "z" else a for a in base.axes)
    )
    trace = Path().state(following=ON).feed(600, x=20).done()
    stream = lowered(trace, using(WEDGE), on)
    assert found(stream, trace, using(WEDGE), on) == {"GP809"}
    assert found(lowered(trace, using(WEDGE), base), trace, using(WEDGE), base) == set()


def test_sections_begin_where_the_one_before_ended() -> None:
    path = Path(x=5, y=5).state(following=ON).feed(600, x=8).end_section().feed(600, x=2).end_section()
    trace = path.done()
    trace.sections[0].edges = (Edge(wait=Wait.OPERATOR, outcome="go", target=1),)
    stream = lowered(trace, using(WEDGE), machine())
    assert stream.sections[0].start[2] == 16
    assert stream.sections[0].end()[2] == stream.sections[1].start[2] == round(0.08 * 320)
    assert found(stream, trace, using(WEDGE), machine()) == set()
    # Switched off between the sections, where it is not 0.
    off = Path(x=5, y=5).state(following=ON).feed(600, x=8).end_section().state().feed(600, x=2).done()
    off.sections[0].edges = (Edge(wait=Wait.OPERATOR, outcome="go", target=1),)
    assert refused(off, using(WEDGE)) == ["GP521"]
