"""`gproof fit` says what `gproof check` says: inside its ranges every offset is SAFE, outside of them none is.

The jobs are those of the metamorphic tests, random programs with limits close around them; offsets are tried inside,
a millionth of a millimetre before and behind each end, and far outside.
"""

from __future__ import annotations

import dataclasses
import random
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from metamorphic import test_verdicts as eding
from metamorphic import wincnc_jobs as wincnc
from metamorphic.jobs import Job, Known, random_setup, wide
from metamorphic.jobs import run as run_eding
from metamorphic.programs import Can, Maker, render
from metamorphic.test_wincnc_spelling import job_of, judged_near, random_job
from metamorphic.test_wincnc_verdicts import CALM
from metamorphic.wincnc_jobs import run as run_wincnc
from support import made_jobs
from support.judging import UNBOUNDED

from gproof.driver.fit.answer import Fit, Range
from gproof.driver.fit.fitting import fit_session
from gproof.driver.judge import Judgement, judge
from gproof.driver.session import Running, open_session
from gproof.ir.verdict import Verdict
from gproof.passes.checks.zones import zones_under_unknown_offsets as open_zones

EDGE = 1e-6
FAST = 25
SEEDS = [pytest.param(0, FAST, id="0")]
MORE = [pytest.param(70_000 + n * 100, 100, id=f"soak-{n}", marks=pytest.mark.soak) for n in range(8)]
seeds = pytest.mark.parametrize(("first", "count"), [*SEEDS, *MORE])


def fit_job(folder: Path, machine: str = "machine.toml", job: str = "job.cnc", dialect: str = "eding") -> Fit:
    """The answer for the files that lie in a folder."""
    session = open_session(folder / job, machine=folder / machine, setup=str(folder / "setup.toml"), dialect=dialect)
    return fit_session(session, Running(UNBOUNDED)).fit


def with_work(job: Job, values: dict[str, float]) -> Job:
    """The job with these offsets stated, by symbol."""
    work: dict[int, Known] = {n: dict(row) for n, row in job.work.items()}
    for symbol, value in values.items():
        _, number, axis = symbol.split(".")
        work[int(number)][axis] = value
    return replace(job, work=work)


def within(rng: random.Random, one: Range) -> float:
    """A value inside the range, or just inside of an end."""
    low, high = max(one.low, -1e5), min(one.high, 1e5)
    if high - low < 4 * EDGE:
        return (low + high) / 2
    return rng.choice((low + EDGE, high - EDGE, rng.uniform(low + EDGE, high - EDGE)))


def outside(rng: random.Random, one: Range) -> float | None:
    """A value just behind an end, or far behind it; None for a range without ends."""
    ends = [end for end in ((one.low, -1.0), (one.high, 1.0)) if abs(end[0]) < 1e5]
    if not ends:
        return None
    end, sign = rng.choice(ends)
    return end + sign * rng.choice((EDGE, 0.1, 50.0))


def single(fit: Fit) -> list[Range]:
    """Ranges of one offset each; sums are tried by `test_bounded_offsets` and the like."""
    return [one for one in fit.ranges if len(one.terms) == 1 and one.terms[0][1] == 1]


@seeds
def test_ranges_are_what_check_says(first: int, count: int, tmp_path: Path) -> None:
    kinds: dict[str, int] = {}
    for seed in range(first, first + count):
        rng = random.Random(seed)
        _, job = eding.known_job(rng, tmp_path, Can(offsets=rng.random() < 0.3, transforms=rng.random() < 0.3))
        before = run_eding(tmp_path, job)
        fit = fit_job(tmp_path)
        kinds[fit.kind] = kinds.get(fit.kind, 0) + 1
        where = f"seed {seed}\n{job.machine_text()}{job.setup_text()}{job.program}{fit.ranges}\n{before.told()}"
        assert fit.verdict is before.verdict, where
        agrees(rng, tmp_path, job, fit, where)
    assert kinds.get("ranges", 0) > count // 4
    assert len(kinds) > 1


@seeds
def test_regions_beside_an_area_are_what_check_says(first: int, count: int, tmp_path: Path) -> None:
    """With room on the machine and an area across the job."""
    assert regions_agree(first, count, tmp_path) > count // 4


@seeds
def test_moves_that_are_taken_together_are_on_the_safe_side(
    first: int, count: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As in jobs of more moves than are taken one by one."""
    monkeypatch.setattr(open_zones, "MOST", 2)
    assert regions_agree(first, count // 2, tmp_path) > count // 10


def regions_agree(first: int, count: int, tmp_path: Path) -> int:
    """How many of so many jobs had regions; what fit and check say of all of them agrees."""
    kinds: dict[str, int] = {}
    for seed in range(first, first + count):
        rng = random.Random(1000 + seed)
        can = Can(
            offsets=rng.random() < 0.2, transforms=False, contours=False, rotary=False, machine=rng.random() < 0.3
        )
        tree = Maker(rng, can).program(rng.randrange(3, 7))
        job = random_setup(rng, Job(render(tree), wide(rng.choice((150.0, 400.0)))))
        job = replace(job, area={n: tuple(sorted(rng.uniform(-90, 90) for _ in range(2))) for n in "xyz"})
        if rng.random() < 0.5:
            job = zoned(rng, job)
        before = run_eding(tmp_path, job)
        fit = fit_job(tmp_path)
        kinds[fit.kind] = kinds.get(fit.kind, 0) + 1
        where = f"seed {1000 + seed}\n{job.machine_text()}{job.setup_text()}{job.program}{fit}\n{before.told()}"
        assert fit.verdict is before.verdict, where
        agrees(rng, tmp_path, job, fit, where)
    return kinds.get("regions", 0)


@dataclass(frozen=True)
class Zoned(Job):
    """With a keep-out zone, and tools that have a diameter."""

    zone: str = ""
    diameter: float = 1.0

    def machine_text(self) -> str:
        text = super().machine_text()
        for tool in self.tools if self.diameter else ():
            text = text.replace(f"[tools.{tool}]\n", f"[tools.{tool}]\ndiameter = {self.diameter!r}\n")
        return text + self.zone


def zoned(rng: random.Random, job: Job) -> Zoned:
    """The job with a keep-out zone in place of the area: a box or a polygon, at all heights or some."""
    x, y = rng.uniform(-80, 80), rng.uniform(-80, 80)
    if rng.random() < 0.5:
        where = f"x = [{x!r}, {x + rng.uniform(1, 60)!r}]\ny = [{y!r}, {y + rng.uniform(1, 60)!r}]\n"
    else:
        size = rng.uniform(5, 40)
        corners = [[0, 0], [2, 0], [2, 0.5], [0.7, 0.8], [0.4, 2], [0, 2]]
        where = f"polygon = {[[x + size * a, y + size * b] for a, b in corners]}\n"
    z = "" if rng.random() < 0.4 else f"z = [-inf, {rng.uniform(-30, 60)!r}]\n"
    zone = f'[[keep_out]]\nname = "clamp"\n{where}{z}'
    fields = {f.name: getattr(job, f.name) for f in dataclasses.fields(Job)} | {"area": None}
    return Zoned(**fields, zone=zone, diameter=rng.choice((1.0, 6.0)))


def agrees(rng: random.Random, folder: Path, job: Job, fit: Fit, where: str) -> None:
    """Offsets inside, at the ends, outside."""
    if fit.kind == "none":
        values = {f"work.{n}.{axis}": rng.uniform(-60, 60) for n in (1, 2, 3) for axis in "xyza"}
        assert run_eding(folder, with_work(job, values)).verdict is not Verdict.SAFE, f"{values}\n{where}"
    if fit.kind not in ("ranges", "regions") or len(single(fit)) != len(fit.ranges):
        return
    for _ in range(2):
        values = {one.terms[0][0]: within(rng, one) for one in fit.ranges}
        if fit.zones:
            values |= boxed(rng, fit)
        if all(in_region(fit, values)):
            inside = run_eding(folder, with_work(job, values))
            assert inside.verdict is Verdict.SAFE, f"{values}\n{inside.told()}\n{where}"
        if not fit.ranges:
            return
        one = rng.choice(fit.ranges)
        value = outside(rng, one)
        if value is not None:
            beyond = {**values, one.terms[0][0]: value}
            assert run_eding(folder, with_work(job, beyond)).verdict is not Verdict.SAFE, f"{beyond}\n{where}"
    for _ in range(3 if fit.zones else 0):
        # Inside of the ranges, anywhere beside the regions, or just beside one of them.
        values = {one.terms[0][0]: within(rng, one) for one in fit.ranges}
        if rng.random() < 0.5:
            values |= boxed(rng, fit, edge=rng.choice((-EDGE, EDGE)))
        told = in_region(fit, values)
        after = run_eding(folder, with_work(job, values)).verdict
        if all(told):
            assert after is Verdict.SAFE, f"{values}\n{where}"
        elif fit.complete and not all(in_region(fit, values, around=True)):
            assert after is not Verdict.SAFE, f"{values}\n{where}"


def boxed(rng: random.Random, fit: Fit, edge: float = 0.0) -> dict[str, float]:
    """Values in a box of each region, or so far beside one of its ends."""
    out: dict[str, float] = {}
    for one in fit.zones:
        box = rng.choice(one.place.boxes)
        for form, (low, high) in zip(one.place.terms, box, strict=True):
            if form:
                low, high = min(low + EDGE, (low + high) / 2), max(high - EDGE, (low + high) / 2)
                out[form[0][0]] = rng.choice((low, high, rng.uniform(low, high)))
        axis = rng.randrange(3)
        if edge and one.place.terms[axis]:
            out[one.place.terms[axis][0][0]] = rng.choice(box[axis]) + edge
    return out


def in_region(fit: Fit, values: dict[str, float], *, around: bool = False) -> list[bool]:
    """Whether values lie in each region, or so near to it that the answer leaves it open."""
    out = []
    for one in fit.zones:
        x, y, z = (values[form[0][0]] if form else 0.0 for form in one.place.terms)
        slack = 2e-6 + 3 * (one.place.region.resolution or 0.0) if around else 0.0
        point = shapely.Point(x, y)
        out.append(any(
            layer.z[0] - slack <= z <= layer.z[1] + slack and layer.left.distance(point) <= slack
            for layer in one.place.region.layers
        ))  # fmt: skip
    return out


@seeds
def test_ranges_of_local_coordinates_are_what_check_says(first: int, count: int, tmp_path: Path) -> None:
    kinds: dict[str, int] = {}
    for seed in range(first, first + count // 2):
        rng = random.Random(seed)
        program, _ = random_job(rng, CALM)
        job = judged_near(tmp_path, rng, job_of(program))
        before = run_wincnc(tmp_path, job)
        name = next(path.name for path in tmp_path.iterdir() if path.suffix.lower() == ".tap")
        fit = fit_job(tmp_path, job=name, dialect="wincnc")
        kinds[fit.kind] = kinds.get(fit.kind, 0) + 1
        where = f"seed {seed}\n{job.told()}{fit.ranges}\n{before.told()}"
        assert fit.verdict is before.verdict, where
        if fit.kind != "ranges" or len(single(fit)) != len(fit.ranges):
            continue
        values = {one.terms[0][0]: within(rng, one) for one in fit.ranges}
        inside = run_wincnc(tmp_path, with_local(job, values))
        assert inside.verdict is Verdict.SAFE, f"{values}\n{inside.told()}\n{where}"
        if fit.ranges:
            one = rng.choice(fit.ranges)
            value = outside(rng, one)
            if value is not None:
                beyond = {**values, one.terms[0][0]: value}
                assert run_wincnc(tmp_path, with_local(job, beyond)).verdict is not Verdict.SAFE, f"{beyond}\n{where}"
    assert kinds.get("ranges", 0) > count // 12


def with_local(job: wincnc.Job, values: dict[str, float]) -> wincnc.Job:
    """The job with these local coordinates stated; the column of W is a."""
    local: dict[str, Any] = dict(job.local)
    for symbol, value in values.items():
        axis = symbol.split(".")[1]
        local["w" if axis == "a" else axis] = value
    return replace(job, local=local)


@pytest.mark.parametrize("dialect", ["mcuwin", "wincnc"])
@seeds
def test_offsets_where_g0_is_not_straight_are_what_check_says(
    first: int, count: int, dialect: str, tmp_path: Path
) -> None:
    """McuWIN: the records of G54 and G55, and the offset at the start; WinCNC: G92. A zone of the machine in some."""
    kinds: dict[str, int] = {}
    for seed in range(first, first + count // 5):
        rng = random.Random(f"{dialect} {seed}")
        made = {"mcuwin": made_jobs.din, "wincnc": made_jobs.single}[dialect](rng, sets=rng.random() < 0.2)
        points = made.points()
        room = [[rng.choice((0.01, 20.0, 100.0, 100.0)) - rng.choice((0.0, 0.0, 0.1)) for _ in "xyz"] for _ in "ab"]
        low = points.min(axis=0) - room[0]
        limits = np.array([low, np.maximum(points.max(axis=0) + room[1], low + 1.0)])
        zone = ""
        if rng.random() < 0.5:
            x, y, z = (points[rng.randrange(len(points))] + [rng.uniform(-40, 40) for _ in "xyz"]).tolist()
            zone = f'[[keep_out]]\nname = "clamp"\nx = [{x}, {x + 20.0}]\ny = [{y}, {y + 20.0}]\nz = [-inf, {z}]\n'
            zone += "[tools.1]\ndiameter = 2.0\n"

        def ask(these: made_jobs.Made) -> Judgement:
            session = made_jobs.opened(tmp_path, these, made_jobs.machine_of(these, limits, zone))  # noqa: B023
            return judge(session, running=Running(UNBOUNDED))

        before = ask(made)
        fit = fit_job(tmp_path, job=f"job.{made_jobs.SUFFIXES[dialect]}", dialect=dialect)
        kinds[fit.kind] = kinds.get(fit.kind, 0) + 1
        where = f"seed {seed}\n{made.program}{made.setup}{made.records}{limits}{zone}{fit}"
        assert fit.verdict is before.verdict, where
        if fit.kind not in ("ranges", "regions") or len(single(fit)) != len(fit.ranges):
            continue
        for _ in range(3):
            values = {one.terms[0][0]: within(rng, one) for one in fit.ranges}
            if fit.zones:
                values |= boxed(rng, fit)
            if all(in_region(fit, values)):
                assert ask(with_records(made, values)).verdict is Verdict.SAFE, f"{values}\n{where}"
            elif fit.complete and not all(in_region(fit, values, around=True)):
                assert ask(with_records(made, values)).verdict is not Verdict.SAFE, f"{values}\n{where}"
            if not fit.ranges:
                break
            one = rng.choice(fit.ranges)
            value = outside(rng, one)
            if value is not None and fit.complete:
                beyond = {**values, one.terms[0][0]: value}
                assert ask(with_records(made, beyond)).verdict is not Verdict.SAFE, f"{beyond}\n{where}"
    assert kinds.get("ranges", 0) + kinds.get("regions", 0) > count // 15
    assert len(kinds) > 1


def with_records(made: made_jobs.Made, values: dict[str, float]) -> made_jobs.Made:
    """The job with these offsets stated: in the table, or as the one at the start."""
    records = [list(row) for row in made.records]
    start = [0.0] * 3
    for symbol, value in values.items():
        kind, *rest = symbol.split(".")
        row = start if kind == "g92" else records[int(rest[0]) - 1]
        row["xyz".index(rest[-1])] = value
    table = "[g92]\n" + "".join(f"{axis} = {value!r}\n" for axis, value in zip("xyz", start, strict=True))
    head, _, behind = made.setup.partition("[g92]")
    _, _, others = behind.partition("[measures]")
    measures = f"[measures]{others}" if others else ""
    return replace(made, setup=head + table + measures, records=records)


def test_a_moved_job_has_moved_ranges(tmp_path: Path) -> None:
    """All absolute words of X up by a number: the ranges of X down by it, all else the same."""
    rng = random.Random(11)
    job = Job(program="", limits={"x": (-50.0, 300.0), "y": (0.0, 200.0), "z": (-80.0, 20.0)})
    for _ in range(20):
        by = rng.randrange(-640, 640) / 16
        lines = [(rng.randrange(-800, 800) / 16, rng.randrange(-640, 640) / 16) for _ in range(4)]
        answers = []
        for shift in (0.0, by):
            body = "".join(f"G1 X{x + shift} Y{y} Z{-y / 8} F500\n" for x, y in lines)
            run_eding(tmp_path, replace(job, program=f"G21 G90 G17 G94 G40 G49 G54\nG0 X{shift}\n{body}M30\n"))
            answers.append(fit_job(tmp_path))
        one, other = answers
        assert one.kind == other.kind == "ranges"
        for a, b in zip(one.ranges, other.ranges, strict=True):
            down = by if a.name.endswith("X") else 0.0
            assert (b.low, b.high) == (a.low - down, a.high - down)
