"""Answers when less is known, when limits are tighter, when moves stand under a condition: never better ones."""

from __future__ import annotations

import random
from dataclasses import replace
from pathlib import Path

import pytest
from metamorphic.jobs import WORSE, Job, Known, Run, Span, fitted, random_setup, run, wide
from metamorphic.programs import Branch, Can, Maker, Statement, Tree, render

from gproof.ir.verdict import Verdict

FAST = 25
SEEDS = [pytest.param(n * FAST, FAST, id=f"{n}") for n in range(1)]
MORE = [pytest.param(30_000 + n * 100, 100, id=f"soak-{n}", marks=pytest.mark.soak) for n in range(10)]
seeds = pytest.mark.parametrize(("first", "count"), [*SEEDS, *MORE])
SIZES = (0.002, 0.002, 5.0, 60.0, -0.002)
JUDGED = ("limits", "areas")


def random_area(rng: random.Random, run: Run) -> dict[str, Span] | None:
    """A box beside or across what the job reaches; some sides are not bounded."""
    if rng.random() < 0.3:
        return None
    area = {}
    for name in "xyz":
        low, high = run.box.get((name, ""), (0.0, 0.0))
        at = rng.uniform(low - 5, high + 5)
        if rng.random() < 0.8:
            area[name] = (round(at, 3), round(at + rng.choice((1.0, 15.0, 60.0)), 3))
    return area or None


def known_job(rng: random.Random, folder: Path, can: Can) -> tuple[Tree, Job]:
    tree = Maker(rng, can).program(rng.randrange(2, 8))
    job = random_setup(rng, Job(render(tree), wide()))
    before = run(folder, job)
    job = fitted(rng, job, before, SIZES if rng.random() < 0.5 else (20.0, 100.0))
    return tree, replace(job, area=random_area(rng, before))


# -- less is known


def blurred(rng: random.Random, job: Job) -> Job:
    """The same with some values not stated, or stated as a range that holds them."""
    often = rng.choice((0.15, 0.5, 1.0))

    def blur(values: Known) -> Known:
        out: Known = {}
        for name, value in values.items():
            assert isinstance(value, float)
            kind = rng.random()
            out[name] = value
            if kind < often * 0.6:
                out[name] = None
            elif kind < often:
                out[name] = (value - rng.choice((0.0, 0.5, 30.0)), value + rng.choice((0.0, 0.5, 30.0)))
        return out

    lengths: dict[int, Span | None] = {}
    for tool, length in job.tools.items():
        if rng.random() < often / 2:
            lengths[tool] = None if rng.random() < 0.5 else (length - rng.choice((0.0, 2.0)), length + 2.0)
    which = rng.randrange(1, 16)
    return replace(
        job,
        start=blur(job.start) if which & 1 else job.start,
        work={n: blur(values) if which & 2 else values for n, values in job.work.items()},
        g92=blur(job.g92) if which & 4 else job.g92,
        lengths=lengths if which & 8 else {},
    )  # fmt: skip


def truth(job: Job, symbol: str) -> float:
    """The value that the job which knows gives to an unknown."""
    kind, *rest = symbol.split(".")
    values: Known = {}
    if kind == "tool":
        return job.tools[int(rest[0])]
    if kind == "work":
        values = job.work[int(rest[0]) or job.active or 1]
    else:
        values = job.start if kind == "start" else job.g92
    value = values.get(rest[-1])
    assert isinstance(value, float), symbol
    return value


def holds(job: Job, unknown: Run, name: str) -> bool:
    """Whether what is true meets the conditions of an answer."""
    answer = next(p for p in unknown.judgement.properties if p.name == name)
    sums = [(sum(k * truth(job, s) for s, k in c.terms), c) for c in answer.conditions]
    return all(c.low - 1e-9 <= value <= c.high + 1e-9 for value, c in sums)


@seeds
def test_less_known(first: int, count: int, tmp_path: Path) -> None:
    """SAFE holds for the true values wherever they meet what it asks for; UNSAFE holds for all, so for them too."""
    seen: set[tuple[Verdict, Verdict]] = set()
    for seed in range(first, first + count):
        rng = random.Random(seed)
        can = Can(transforms=rng.random() < 0.3, contours=rng.random() < 0.3, structure=False, rotary=False)
        _, job = known_job(rng, tmp_path, can)
        known = run(tmp_path, job)
        assert known.clean, f"seed {seed}\n{job.program}{known.told()}"
        for _ in range(3):
            less = blurred(rng, job)
            unknown = run(tmp_path, less)
            where = (
                f"seed {seed}\n{job.machine_text()}{job.setup_text()}---\n{less.setup_text()}{less.program}"
                f"known:\n{known.told()}\nunknown:\n{unknown.told()}\n{unknown.judgement.properties}"
            )
            ask = all(holds(job, unknown, name) for name in JUDGED)
            for name in JUDGED:
                a, b = known.answer(name), unknown.answer(name)
                if unknown.verdict is Verdict.SAFE and ask:
                    assert a is Verdict.SAFE, f"{name}\n{where}"
                if b is Verdict.UNSAFE and unknown.answer("language") is Verdict.SAFE:
                    assert a is Verdict.UNSAFE, f"{name}\n{where}"
                seen.add((a, b))
    assert (Verdict.UNSAFE, Verdict.UNKNOWN) in seen
    assert (Verdict.SAFE, Verdict.SAFE) in seen


# -- tighter limits, a larger area


@seeds
def test_tighter_limits(first: int, count: int, tmp_path: Path) -> None:
    """A smaller machine, or a larger area to keep out of, never gets a better answer."""
    changed = 0
    for seed in range(first, first + count):
        rng = random.Random(seed)
        _, job = known_job(rng, tmp_path, Can(rotary=False))
        if rng.random() < 0.5:
            job = blurred(rng, job)
        tight = {
            n: (a + (b - a) * rng.choice((0.0, 0.001, 0.3)), b - (b - a) * rng.choice((0.0, 0.001, 0.3)))
            for n, (a, b) in job.limits.items()
        }
        grown = job.area
        if grown is not None:
            grown = {n: (a - rng.choice((0.0, 3.0)), b + rng.choice((0.0, 3.0))) for n, (a, b) in grown.items()}
        one, two = run(tmp_path, job), run(tmp_path, replace(job, limits=tight, area=grown))
        where = f"seed {seed}\n{job.machine_text()}{two.job.machine_text()}{job.setup_text()}{job.program}"
        for name in JUDGED:
            # The face of the area that is chosen is that which suits the limits: only both answers together count.
            assert WORSE[two.answer("limits")] >= WORSE[one.answer("limits")], f"{name}\n{where}"
        assert WORSE[two.verdict] >= WORSE[one.verdict], f"{where}{one.told()}\n---\n{two.told()}"
        changed += two.verdict is not one.verdict
    assert changed


# -- moves under a condition


def conditional(rng: random.Random, tree: Tree) -> Tree:
    """One or two statements under a condition that nobody can decide; the rest follows either way."""
    head, *rest = tree
    out: list[Statement] = [head]
    left = rng.randrange(1, 3)
    for node in rest:
        if left and rng.random() < 0.5:
            left -= 1
            node = Branch(f"#{4000 + left} > 1", (node,))
        out.append(node)
    return tuple(out)


@seeds
def test_moves_under_a_condition(first: int, count: int, tmp_path: Path) -> None:
    """What happens when the condition holds is what happened without it: UNSAFE stays UNSAFE (3.1.1, 4.1)."""
    unsafe = 0
    for seed in range(first, first + count):
        rng = random.Random(seed)
        can = Can(contours=False, transforms=False, arcs=rng.random() < 0.5, cycles=rng.random() < 0.5, rotary=False)
        tree, job = known_job(rng, tmp_path, can)
        one, two = run(tmp_path, job), run(tmp_path, replace(job, program=render(conditional(rng, tree))))
        where = f"seed {seed}\n{job.machine_text()}{job.setup_text()}{job.program}---\n{two.job.program}{two.told()}"
        assert one.clean, where
        for name in JUDGED:
            assert WORSE[two.answer(name)] >= WORSE[one.answer(name)], f"{name}\n{where}"
            unsafe += one.answer(name) is Verdict.UNSAFE
    assert unsafe
