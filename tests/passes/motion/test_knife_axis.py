"""Tangential knife: turns and lifts worked out by hand, and the direction held against the path itself."""

from __future__ import annotations

import dataclasses
import math
import random

import pytest
from passes.motion.traces import Path
from passes.motion.traces import machine as plain_machine
from support.campaigns import seeds

from gproof.ir.finding import Findings
from gproof.ir.machine import Axis, AxisKind, Knife, Machine
from gproof.ir.trace import KNIFE, Edge, Op, Trace, Wait, chunks
from gproof.passes.motion.knife_axis import follow_knife

ON = {"following": (KNIFE,)}


def mill(**knife: float | str) -> Machine:
    stated = {"angle": 20.0, "lift": 5.0, "blend_angle": 6.0, "blend_distance": 1.0, **knife}
    on = plain_machine()
    c = Axis(name="c", kind=AxisKind.ROTARY, max_velocity=360.0, max_acceleration=3600.0)
    return dataclasses.replace(on, axes=(*on.axes, c), knife=Knife(**stated))  # type: ignore[arg-type]


def followed(trace: Trace, on: Machine) -> tuple[list[tuple[str, float, float, float, float]], list[str]]:
    """(function, X, Y, Z, C) of each row; labels and reasons of findings."""
    findings = Findings()
    rows = []
    for chunk in follow_knife(chunks(trace), on, findings):
        begin = len(rows)
        for k in range(len(chunk.rows)):
            x, y, z, _, _, c = chunk.rows["to"][k].tolist()
            rows.append((Op(int(chunk.rows["op"][k])).name, *(round(v, 6) for v in (x, y, z, c))))
        assert chunk.begin + 0 <= begin
    return rows, [f.message for f in findings.kept]


def test_a_corner_above_the_angle_lifts_turns_and_goes_down() -> None:
    path = Path(z=-1).state(**ON).feed(600, x=10).feed(600, y=10)
    rows, said = followed(path.done(), mill())
    assert said == []
    assert rows == [
        ("FEED", 10, 0, -1, 0),  # along +X: the knife is there already
        ("TRAVERSE", 10, 0, 4, 0), ("TRAVERSE", 10, 0, 4, 90), ("FEED", 10, 0, -1, 90),
        ("FEED", 10, 10, -1, 90),
    ]  # fmt: skip


def test_a_corner_below_the_angle_turns_in_place() -> None:
    along = math.tan(math.radians(15)) * 10
    rows, _ = followed(Path(z=-1).state(**ON).feed(600, x=10).feed(600, x=20, y=along).done(), mill())
    assert rows[1:] == [("TRAVERSE", 10, 0, -1, 15), ("FEED", 20, round(along, 6), -1, 15)]
    exactly = followed(Path().state(**ON).feed(600, x=10).feed(600, x=20, y=10).done(), mill(angle=45.0))[0]
    assert [row[0] for row in exactly] == ["FEED", "TRAVERSE", "FEED"]


def test_short_moves_turn_the_knife_on_their_way() -> None:
    dx, dy = 0.5 * math.cos(math.radians(5)), 0.5 * math.sin(math.radians(5))
    rows, _ = followed(Path().state(**ON).feed(600, x=10).feed(600, x=10 + dx, y=dy).done(), mill())
    assert [row[0] for row in rows] == ["FEED", "FEED"] and rows[-1][4] == 5.0
    longer, _ = followed(Path().state(**ON).feed(600, x=10).feed(600, x=10 + 4 * dx, y=4 * dy).done(), mill())
    assert [row[0] for row in longer] == ["FEED", "TRAVERSE", "FEED"]


def test_the_knife_turns_with_an_arc_and_the_shorter_way() -> None:
    # Half a circle counter-clockwise from (10, 0) about (10, 5): along +X at its begin, along -X at its end.
    path = Path().state(**ON).feed(600, x=10).arc(600, 1, (10, 5), x=10, y=10).feed(600, x=0, y=10)
    assert followed(path.done(), mill())[0] == [
        ("FEED", 10, 0, 0, 0), ("ARC", 10, 10, 0, 180), ("FEED", 0, 10, 0, 180)
    ]  # fmt: skip
    back = Path().state(**ON).feed(600, y=-10).feed(600, x=-10)
    assert [row[4] for row in followed(back.done(), mill())[0]] == [0, -90, -90, -90, -90, -180, -180, -180]
    circle = Path().state(**ON).feed(600, x=10).arc(600, -1, (10, -5), x=10, y=0)
    assert followed(circle.done(), mill())[0][-1] == ("ARC", 10, 0, 0, -360)


def test_traverses_and_moves_of_z_do_not_turn_it_and_off_it_stays() -> None:
    path = Path().state(**ON).traverse(y=10).feed(600, z=-2).feed(600, y=20).state().feed(600, x=5).traverse(c=30)
    assert [row[4] for row in followed(path.feed(600, x=9).done(), mill())[0]] == [0, 0, 0, 90, 90, 90, 90, 30, 30]


def test_it_is_followed_from_section_to_section() -> None:
    path = Path().state(**ON).feed(600, y=10).end_section().feed(600, y=20)
    trace = path.done()
    trace.sections[0].edges = (Edge(wait=Wait.OPERATOR, outcome="run", target=1),)
    rows, said = followed(trace, mill())
    assert (said, rows[-1]) == ([], ("FEED", 0, 20, 0, 90))
    assert len(rows) == 5
    trace.sections[1].edges = (Edge(wait=Wait.BRANCH, outcome="again", target=1),)
    assert followed(trace, mill())[1] == []
    other = Path().state(**ON).feed(600, y=10).end_section().feed(600, x=20).done()
    other.sections[0].edges = (Edge(wait=Wait.OPERATOR, outcome="run", target=1),)
    other.sections[1].edges = (Edge(wait=Wait.BRANCH, outcome="again", target=1),)
    assert "depends on the path" in followed(other, mill())[1][0]


@pytest.mark.parametrize(
    ("path", "reason"),
    [
        (Path().state(**ON).feed(600, x=5, c=10), "turns C itself"),
        (Path().state(following=(KNIFE,), compensation=1).feed(600, x=5), "cutter radius compensation"),
        (Path().frame("start.c").state(**ON).feed(600, x=5), "the position of C"),
        (Path().state(**ON).feed(600, x=5).frame("work.1.x").feed(600, x=9), "unknown offsets"),
    ],
)  # fmt: skip
def test_what_can_not_be_followed_is_told(path: Path, reason: str) -> None:
    assert any(reason in message for message in followed(path.done(), mill())[1])


def test_nothing_changes_without_a_knife_or_before_it_is_on() -> None:
    trace = Path().feed(600, x=5).feed(600, y=5).done()
    assert [row[4] for row in followed(trace, mill())[0]] == [0, 0]
    on = Path().state(**ON).feed(600, y=5).done()
    assert followed(on, dataclasses.replace(mill(), knife=None))[0] == [("FEED", 0, 5, 0, 0)]


@pytest.mark.parametrize("seed", seeds(24, 60))
def test_the_knife_points_along_the_path_wherever_it_cuts(seed: int) -> None:
    rng = random.Random(seed)
    path = Path(x=rng.uniform(-9, 9), y=rng.uniform(-9, 9)).state(**ON)
    for _ in range(12):
        x, y = rng.uniform(-9, 9), rng.uniform(-9, 9)
        if rng.random() < 0.4:
            center = ((path.place[0] + x) / 2, (path.place[1] + y) / 2)
            path.arc(600, rng.choice([1, -1, 2]), center, x=x, y=y)
        else:
            path.feed(600, x=x, y=y)
    (chunk,) = follow_knife(chunks(path.done()), mill(blend_angle=0.0), Findings())
    chunk.trace.sections[0].rows = chunk.rows
    chunk.trace.verify()
    place = list(chunk.start)
    for k in range(len(chunk.rows)):
        to = chunk.rows["to"][k].tolist()
        begin, end = place[5], to[5]
        if chunk.rows["op"][k] == Op.ARC:
            cx, cy = chunk.rows["center"][k, :2].tolist()
            sign = 1 if chunk.rows["turns"][k] > 0 else -1
            at = [(-(p[1] - cy) * sign, (p[0] - cx) * sign) for p in (place, to)]
        else:
            at = [(to[0] - place[0], to[1] - place[1])] * 2
        if chunk.rows["op"][k] != Op.TRAVERSE and math.hypot(*at[0]) > 1e-9:
            for angle, (dx, dy) in zip((begin, end), at, strict=True):
                turn = math.degrees(math.atan2(dy, dx)) - angle
                assert abs((turn + 180) % 360 - 180) < 1e-6
        else:
            # Between cuts it turns by half a turn at most, lifted when it turns by more than the angle.
            assert abs(end - begin) <= 180.0
            assert abs(end - begin) <= 20.0 or to[2] == 5.0
        place = to
