"""Limits and the tool change area against an independent reckoning of the path (tests/support/paths.py).

Sound: a point of the path beyond a limit makes the job UNSAFE. Sharp: an UNSAFE job has such a point, or one
within a thousandth of it. Conditional answers: what is inside the printed range is SAFE once it is stated, what
is outside is UNSAFE.
"""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
from support.campaigns import seeds
from support.judging import answer, judged
from support.paths import AXES, Offsets, Points, RandomPath, nearest

from gproof.driver.judge import Judgement
from gproof.ir.verdict import Condition, Verdict

SURELY, NEARLY = 1e-6, 1e-3
TOOL_1 = 17.25


def machine_text(low: Points, high: Points, more: str = "") -> str:
    axes = "".join(
        f"[axes.{name}]\nmin = {a!r}\nmax = {b!r}\n"
        for name, a, b in zip("xyz", low.tolist(), high.tolist(), strict=True)
    )
    return f'schema = "gproof-machine/1"\nunits = "mm"\n{axes}[tools.1]\nlength = {TOOL_1}\n{more}'


def setup_text(start: list[float] | None, work: dict[int, list[float]], g92: list[float] | None) -> str:
    def table(name: str, values: list[float] | None) -> str:
        if values is None:
            return ""
        return f"[{name}]\n" + "".join(f"{n} = {v!r}\n" for n, v in zip("xyz", values, strict=True))

    tables = table("start", start) + "".join(table(f"work.{n}", v) for n, v in work.items()) + table("g92", g92)
    return f'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\nactive_work = 1\ntool = 1\n{tables}'


def judge_texts(folder: Path, program: str, machine: str, setup: str | None) -> Judgement:
    for name, text in (("job.cnc", program), ("machine.toml", machine), ("setup.toml", setup or "")):
        (folder / name).write_text(text, encoding="utf-8")
    return judged(folder / "job.cnc", folder / "machine.toml", None if setup is None else str(folder / "setup.toml"))


def random_path(rng: random.Random) -> tuple[RandomPath, str]:
    """A path of a few moves, and the setup it starts from."""
    start = [round(rng.uniform(-30, 30), 3) for _ in range(3)]
    work = {n: [round(rng.uniform(-40, 40), 3) if rng.random() < 0.5 else 0.0 for _ in range(3)] for n in (1, 2)}
    g92 = [round(rng.uniform(-10, 10), 3) if rng.random() < 0.3 else 0.0 for _ in range(3)]
    setup = setup_text(start, work, g92)
    path = RandomPath(rng, start, Offsets(work, g92), TOOL_1)
    for _ in range(rng.randrange(1, 7)):
        path.random_move()
    return path, setup


def rooms(rng: random.Random) -> Points:
    """How far the six limits lie beyond the path: all of them a little, or some of them hardly, or before it."""
    sizes = rng.choice(((2e-3, 0.01, 1.0, 20.0), (2e-6, 1e-4, 0.01, -2e-6, -1e-4, 1.0, 20.0), (1.0, 1.0, 20.0, -0.01)))
    return np.array([[rng.choice(sizes) * rng.uniform(1.0, 2.0) for _ in AXES] for _ in range(2)])


def told(seed: int, judgement: Judgement, *texts: str) -> str:
    found = "".join(f"{f.span.line}: {f.code.label} {f.message}\n" for f in judgement.findings.kept)
    return f"seed {seed}\n" + "\n".join(texts) + f"\n{found}"


def assert_clean(judgement: Judgement, where: str) -> None:
    """Language and arcs hold: the generator wrote what it meant."""
    assert answer(judgement, "language").verdict is Verdict.SAFE, where
    assert answer(judgement, "arcs").verdict is Verdict.SAFE, where


@pytest.mark.parametrize("group", seeds(2, 10))
def test_limits_agree_with_a_dense_walk_of_the_path(group: int, tmp_path: Path) -> None:
    verdicts = []
    for seed in range(group * 40, group * 40 + 40):
        rng = random.Random(seed)
        path, setup = random_path(rng)
        points = path.samples()
        below, above = rooms(rng)
        low, high = points.min(axis=0) - below, points.max(axis=0) + above
        high = np.maximum(low, high)
        machine = machine_text(low, high)
        judgement = judge_texts(tmp_path, path.text, machine, setup)
        where = told(seed, judgement, path.text, machine, setup)
        assert_clean(judgement, where)
        verdict = answer(judgement, "limits").verdict
        beyond = float(np.maximum(low - points, points - high).max())
        assert verdict is not Verdict.UNKNOWN, where
        if beyond > SURELY:
            assert verdict is Verdict.UNSAFE, f"{beyond} mm beyond\n{where}"
        if verdict is Verdict.UNSAFE:
            assert beyond > -NEARLY, f"{-beyond} mm inside\n{where}"
        verdicts.append(verdict)
    assert set(verdicts) == {Verdict.SAFE, Verdict.UNSAFE}


@pytest.mark.parametrize("group", seeds(2, 10))
def test_tool_change_area_agrees_with_a_dense_walk_of_the_path(group: int, tmp_path: Path) -> None:
    verdicts = []
    for seed in range(group * 30, group * 30 + 30):
        rng = random.Random(1000 + seed)
        path, setup = random_path(rng)
        near = path.pieces[-1](np.array([rng.random()]))[0]
        size = np.array([rng.choice((0.2, 5.0, 40.0)) * rng.uniform(0.5, 1.5) for _ in AXES])
        # A corner or a side of the box a little beside a point of the path, to any side.
        side = np.array([rng.choice((-1.0, 0.0, 1.0)) for _ in AXES])
        gap = np.array([rng.choice((0.0, 1e-5, 0.01, 1.0)) * rng.choice((-1, 1)) for _ in AXES])
        if rng.random() < 0.5:
            # Beside the farthest point of the path, where an arc passes without entering.
            axis, sign = rng.randrange(3), rng.choice((-1.0, 1.0))
            points = path.samples()
            near = points[np.argmax(sign * points[:, axis])]
            side = np.eye(3)[axis] * sign
        low = near + side * (size / 2 + gap) - size / 2
        high = low + size
        area = "[areas.tool_change]\n" + "".join(
            f"{n} = [{a!r}, {b!r}]\n" for n, a, b in zip("xyz", low.tolist(), high.tolist(), strict=True)
        )
        machine = machine_text(np.full(3, -1e6), np.full(3, 1e6), area)
        judgement = judge_texts(tmp_path, path.text, machine, setup)
        where = told(seed, judgement, path.text, machine, setup)
        assert_clean(judgement, where)
        verdict = answer(judgement, "areas").verdict
        outside = nearest(path, low, high)
        assert verdict is not Verdict.UNKNOWN, where
        if outside < -SURELY:
            assert verdict is Verdict.UNSAFE, f"{-outside} mm inside\n{where}"
        if verdict is Verdict.UNSAFE:
            assert outside < NEARLY, f"{outside} mm outside\n{where}"
        verdicts.append(verdict)
    assert set(verdicts) == {Verdict.SAFE, Verdict.UNSAFE}


# -- answers under conditions


def conditional_program(rng: random.Random) -> str:
    """Moves that touch the axes one after another, so that positions stand in several mixtures of unknowns."""
    path = RandomPath(rng, [0.0] * 3, Offsets())
    path.lines = ["G21 G90 G17 G94 G40 G49"]
    for _ in range(rng.randrange(2, 8)):
        axes = sorted(rng.sample(range(3), rng.choice((1, 1, 2, 3))))
        if rng.random() < 0.15:
            path.absolute = not path.absolute
            path.lines.append("G90" if path.absolute else "G91")
        code = rng.choice(("G0", "G1"))
        words = [f"{AXES[axis]}{rng.uniform(-40, 40):.4f}" for axis in axes]
        path.lines.append(f"{code} {' '.join(words)} F500")
        if rng.random() < 0.3 and path.absolute and len(axes) == 3:
            radius = round(rng.uniform(1, 20), 3)
            path.lines.append(f"G{rng.choice((2, 3))} X{words[0][1:]} Y{words[1][1:]} I{radius}")
    return path.text


def solve(
    rng: random.Random, conditions: list[Condition], edge: float | None, low: Points, high: Points
) -> dict[str, float]:
    """Values of all unknowns inside every condition; with ``edge`` one condition is missed by that much.

    An axis that never moves has no condition; it starts within its limits.
    """
    values = {f"g92.{n}": rng.uniform(-5, 5) for n in "xyz"}
    values |= {f"start.{n}": rng.uniform(a, b) for n, a, b in zip("xyz", low.tolist(), high.tolist(), strict=True)}
    # Conditions on the start alone first; then the work offset carries the rest.
    for condition in conditions:
        first, *more = [symbol for symbol, _ in condition.terms]
        if first.startswith("start") and not more:
            values[first] = rng.uniform(condition.low, condition.high)
    missed = rng.choice([c for c in conditions if any("work" in s for s, _ in c.terms)]) if edge is not None else None
    for condition in conditions:
        work = [symbol for symbol, _ in condition.terms if symbol.startswith("work")]
        if not work:
            continue
        goal = rng.choice((condition.low, condition.high, rng.uniform(condition.low, condition.high)))
        if condition is missed:
            assert edge is not None
            goal = rng.choice((condition.low - edge, condition.high + edge))
        rest = sum(k * values[s] for s, k in condition.terms if s != work[0])
        values[work[0]] = goal - rest
    return values


def stated(values: dict[str, float]) -> str:
    return setup_text(
        [values[f"start.{n}"] for n in "xyz"],
        {1: [values.get(f"work.1.{n}", values.get(f"work.0.{n}", 0.0)) for n in "xyz"]},
        [values[f"g92.{n}"] for n in "xyz"],
    )


def merged(conditions: tuple[Condition, ...]) -> list[Condition]:
    assert len({c.terms for c in conditions}) == len(conditions), conditions
    return list(conditions)


@pytest.mark.parametrize("group", seeds(1, 5))
def test_printed_offsets_are_exactly_the_safe_ones(group: int, tmp_path: Path) -> None:
    conditional = impossible = 0
    unknown = 'schema = "gproof-setup/1"\nactive_work = 1\ntool = 1\n'
    for seed in range(group * 30, group * 30 + 30):
        rng = random.Random(5000 + seed)
        program = conditional_program(rng)
        span = rng.choice((60.0, 100.0, 200.0))
        low = np.array([round(rng.uniform(-50, 0), 3) for _ in AXES])
        machine = machine_text(low, low + span)
        judgement = judge_texts(tmp_path, program, machine, unknown)
        where = told(seed, judgement, program, machine)
        limits = answer(judgement, "limits")
        if answer(judgement, "arcs").verdict is not Verdict.SAFE:
            continue
        assert answer(judgement, "language").verdict is Verdict.SAFE, where
        assert limits.verdict is not Verdict.UNKNOWN, where
        conditions = merged(limits.conditions)
        for edge in (None, None, 2e-6, 1.0):
            if limits.verdict is Verdict.SAFE:
                if edge is not None and not any("work" in s for c in conditions for s, _ in c.terms):
                    continue
                values = solve(rng, conditions, edge, low, low + span)
                expected = Verdict.SAFE if edge is None else Verdict.UNSAFE
            else:
                names = [f"{kind}.{n}" for kind in ("start", "work.1", "g92") for n in "xyz"]
                values = {name: rng.uniform(-60, 60) for name in names}
                expected = Verdict.UNSAFE
            setup = stated(values)
            again = judge_texts(tmp_path, program, machine, setup)
            result = answer(again, "limits")
            assert result.verdict is expected, f"edge {edge}\n{told(seed, again, program, machine, setup)}{conditions}"
            assert not result.conditions, where
        conditional += limits.verdict is Verdict.SAFE
        impossible += limits.verdict is Verdict.UNSAFE
    assert conditional >= 5
    assert impossible >= 2


def test_an_offset_within_a_range_is_judged_for_all_of_it(tmp_path: Path) -> None:
    verdicts = []
    for seed in range(60):
        rng = random.Random(7000 + seed)
        program = conditional_program(rng)
        low = np.array([round(rng.uniform(-60, 0), 3) for _ in AXES])
        machine = machine_text(low, low + rng.choice((80.0, 150.0)))
        ends = [sorted(round(rng.uniform(-30, 30), 3) for _ in range(2)) for _ in AXES]
        table = "[work.1]\n" + "".join(f"{n} = {pair}\n" for n, pair in zip("xyz", ends, strict=True))
        around = setup_text([float(x) for x in low + 40.0], {}, [0.0] * 3)
        judgement = judge_texts(tmp_path, program, machine, around + table)
        limits = answer(judgement, "limits").verdict
        if answer(judgement, "arcs").verdict is not Verdict.SAFE:
            continue
        exact = []
        for pick in range(8):
            values = [pair[pick >> k & 1] for k, pair in enumerate(ends)]
            stated = setup_text([float(x) for x in low + 40.0], {1: values}, [0.0] * 3)
            exact.append(answer(judge_texts(tmp_path, program, machine, stated), "limits").verdict)
        where = told(seed, judgement, program, machine, around + table, str(exact))
        # Positions are sums with the offset: when all corners of the ranges fit, all of them fits.
        assert (limits is Verdict.SAFE) == (set(exact) == {Verdict.SAFE}), where
        if limits is Verdict.UNSAFE:
            assert set(exact) == {Verdict.UNSAFE}, where
        verdicts.append(limits)
    assert set(verdicts) == set(Verdict)


def test_offsets_inside_the_printed_ranges_keep_out_of_the_tool_change_area(tmp_path: Path) -> None:
    conditional = 0
    unknown = 'schema = "gproof-setup/1"\nactive_work = 1\ntool = 1\n'
    for seed in range(100):
        rng = random.Random(9000 + seed)
        program = conditional_program(rng)
        low = np.array([round(rng.uniform(-120, -60), 3) for _ in AXES])
        corner = [round(rng.uniform(-60, 30), 3) for _ in AXES]
        area = "[areas.tool_change]\n" + "".join(
            f"{n} = [{a!r}, {a + rng.choice((1.0, 30.0))!r}]\n" for n, a in zip("xyz", corner, strict=True)
        )
        machine = machine_text(low, low + 200.0, area)
        judgement = judge_texts(tmp_path, program, machine, unknown)
        areas, limits = answer(judgement, "areas"), answer(judgement, "limits")
        if judgement.verdict is not Verdict.SAFE:
            continue
        ranges = {c.terms: (c.low, c.high) for c in merged(limits.conditions)}
        for c in merged(areas.conditions):
            a, b = ranges.get(c.terms, (c.low, c.high))
            ranges[c.terms] = max(a, c.low), min(b, c.high)
        both = [Condition(terms=terms, low=a, high=b) for terms, (a, b) in ranges.items()]
        assert not any(c.empty for c in both), told(seed, judgement, program, machine, str(both))
        for _ in range(3):
            setup = stated(solve(rng, both, None, low, low + 200.0))
            again = judge_texts(tmp_path, program, machine, setup)
            where = told(seed, again, program, machine, setup, str(both))
            assert answer(again, "limits").verdict is Verdict.SAFE, where
            # The face itself is outside; adding offsets up may land on either side of it by a rounding.
            if answer(again, "areas").verdict is not Verdict.SAFE:
                assert all(f.code.number == 310 for f in again.findings.kept), where
                pytest.fail(where)
        conditional += bool(areas.conditions)
    assert conditional >= 20


# -- single cases that were once answered wrongly

BOX = np.array([0.0, 0.0, -50.0]), np.array([100.0, 100.0, 50.0])


def found(judgement: Judgement) -> list[tuple[str, int]]:
    return [(f.code.label, f.span.line) for f in judgement.findings.kept if f.severity.value in ("error", "unknown")]


def test_one_offset_in_two_frames_must_fit_all_rows(tmp_path: Path) -> None:
    # X-90 while Y still stands at its unknown start, X90 once it does not: 180 mm on an axis of 100.
    program = "G21 G90 G40 G49\nG0 X0\nX-90\nX0\nG0 Y0\nG0 X90\nM30\n"
    judgement = judge_texts(tmp_path, program, machine_text(*BOX), None)
    assert found(judgement) == [("GP303", 6)]
    assert judgement.verdict is Verdict.UNSAFE
    assert "spans 180.000 mm, and the axis has 100.000 mm" in judgement.findings.kept[0].message


def test_a_job_as_long_as_the_axis_has_one_offset(tmp_path: Path) -> None:
    program = "G21 G90 G40 G49\nG0 X0.1\nX100.1\nM30\n"
    judgement = judge_texts(tmp_path, program, machine_text(*BOX), None)
    (offset,) = [c for c in answer(judgement, "limits").conditions if len(c.terms) == 2]
    assert judgement.verdict is Verdict.SAFE
    assert (offset.low, offset.high) == pytest.approx((-0.1, -0.1), abs=1e-9)


def test_no_offset_fits_the_physical_travel(tmp_path: Path) -> None:
    axes = "[axes.x]\ntravel_min = 0.0\ntravel_max = 100.0\n"
    machine = f'schema = "gproof-machine/1"\nunits = "mm"\n{axes}'
    judgement = judge_texts(tmp_path, "G21 G90\nMCAGUARD OFF\nG0 X0\nG0 X200\nM30\n", machine, None)
    assert ("GP303", 4) in found(judgement)
    assert judgement.verdict is Verdict.UNSAFE


def test_an_unknown_start_lies_within_the_limits_too(tmp_path: Path) -> None:
    program = "G21 G40 G49\nG91\nG0 X-30\nG0 X20\nM30\n"
    judgement = judge_texts(tmp_path, program, machine_text(*BOX), None)
    (start,) = answer(judgement, "limits").conditions
    assert (start.low, start.high) == (30.0, 100.0)


AREA = "[areas.tool_change]\nx = [80, 90]\ny = [80, 90]\nz = [0, 40]\n"


def test_an_arc_whose_radius_shrinks_beside_the_area(tmp_path: Path) -> None:
    # Within the tolerance of a radius; its box meets the area, the arc does not.
    program = "G21 G90 G17 G94\nG0 Z10\nG0 X70 Y74.9996\nG3 X70 Y94.9994 I0 J10.0004 F100\nM30\n"
    judgement = judge_texts(tmp_path, program, machine_text(*BOX, AREA), setup_text([0.0] * 3, {1: [0.0] * 3}, None))
    assert answer(judgement, "areas").verdict is Verdict.SAFE


def test_the_face_of_the_area_leaves_room_for_the_limits(tmp_path: Path) -> None:
    # Left of the area there is more room, but the limits want the job on its right.
    area = "[areas.tool_change]\nx = [20, 90]\ny = [0, 100]\nz = [-50, 50]\n"
    program = "G21 G90 G40 G49\nTCAGUARD OFF\nG0 X0\nX-50\nX0\nTCAGUARD ON\nG0 X0\nM30\n"
    judgement = judge_texts(tmp_path, program, machine_text(*BOX, area), None)
    offset = (("g92.x", 1), ("work.0.x", 1))
    limits = next(c for c in answer(judgement, "limits").conditions if c.terms == offset)
    areas = next(c for c in answer(judgement, "areas").conditions if c.terms == offset)
    assert (limits.low, limits.high) == (50.0, 100.0)
    assert (areas.low, areas.high) == (90.0, 100.0)


def test_no_offset_for_both_settings_of_block_delete_is_unknown(tmp_path: Path) -> None:
    program = "G21 G90 G40 G49\n/G0 X0\n/G0 X95\n/M30\nG0 X-95\nX0\nM30\n"
    judgement = judge_texts(tmp_path, program, machine_text(*BOX), None)
    assert judgement.verdict is Verdict.UNKNOWN
    assert "block delete" in judgement.findings.kept[-1].message


@pytest.mark.parametrize("plane", ["G17", "G18", "G19"])
def test_the_bulge_of_a_helix_that_begins_at_an_unknown_height(plane: str, tmp_path: Path) -> None:
    # Half a turn of radius 10 whose ends lie beside the area; its third axis comes from where nobody knows.
    u, v, w = {"G17": "xyz", "G18": "zxy", "G19": "yzx"}[plane]
    program = f"G21 G90 G40 G49\n{plane} F100\nG2 {u}-10 {v}-20 {w}5 R10.5\nM30\n"
    area = f"[areas.tool_change]\n{v} = [-50, 0]\n{u} = [-5, 0]\n"
    machine = machine_text(np.full(3, -100.0), np.full(3, 100.0), area)
    zero = "[work.1]\nx = 0.0\ny = 0.0\nz = 0.0\n[g92]\nx = 0.0\ny = 0.0\nz = 0.0\n"
    head = 'schema = "gproof-setup/1"\nactive_work = 1\n'
    for start, expected in ((f"{w} = 0.0", Verdict.UNSAFE), ("", Verdict.UNKNOWN)):
        setup = f"{head}[start]\n{u} = -10.0\n{v} = 0.0\n{start}\n{zero}"
        assert answer(judge_texts(tmp_path, program, machine, setup), "areas").verdict is expected
