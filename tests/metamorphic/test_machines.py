"""One path on machines that read programs otherwise: diameters, absolute centres, inches, arcs seen from the front."""

from __future__ import annotations

import random
from dataclasses import replace
from pathlib import Path

import pytest
from metamorphic.jobs import AXES, Job, Known, Run, fitted, random_setup, run, same_moves, wide
from metamorphic.programs import PLANES, Block, Can, Maker, Statement, Tree, Word, number, render, rewrite
from metamorphic.test_symmetry import SIZES, Walk, check

FAST = 10
SEEDS = [pytest.param(n * FAST, FAST, id=f"{n}") for n in range(1)]
MORE = [pytest.param(40_000 + n * 100, 100, id=f"soak-{n}", marks=pytest.mark.soak) for n in range(4)]
seeds = pytest.mark.parametrize(("first", "count"), [*SEEDS, *MORE])


@seeds
def test_diameters(first: int, count: int, tmp_path: Path) -> None:
    """2.1.14: every X number twice as large, I and R as they are, is the same path."""

    def doubled(node: Statement) -> Tree:
        if not isinstance(node, Block):
            return (node,)
        return (
            replace(node, words=tuple(replace(w, value=2 * w.value) if w.letter == "X" else w for w in node.words)),
        )

    for seed in range(first, first + count):
        rng = random.Random(seed)
        can = Can(transforms=False, contours=False, no_cycle_along="X", counters=False, units=rng.random() < 0.3)
        tree = Maker(rng, can).program(rng.randrange(3, 10))
        job = random_setup(rng, Job(render(tree), wide()))
        job = fitted(rng, job, run(tmp_path, job), SIZES)
        other = replace(job, program=render(rewrite(tree, doubled)), controller={"diameter_programming": "true"})
        check(tmp_path, seed, job, other, {}, 1e-9)


@seeds
def test_absolute_centres(first: int, count: int, tmp_path: Path) -> None:
    """2.1.14: with absolute centres I, J and K are places in the program's coordinates, in G90 and in G91."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        walk = Walk(rng, centers=True)
        for _ in range(rng.randrange(2, 9)):
            walk.step()
        head = "G21 G90 G17 G40 G49 G80 G94 G98 G69 G50 G54 F640\nG92 X0 Y0 Z0\n"
        chosen = [rng.randrange(2) for _ in walk.lines]
        lines = [f"G9{k}\n{pair[k]}" for k, pair in zip(chosen, walk.lines, strict=True)]
        places = [walk.absolute.get(n, "") for n in range(len(lines))]
        texts = [
            head + "".join(f"{line} {own}\n" for line, own in zip(lines, centers, strict=True)) + "M2\n"
            for centers in ([walk.relative.get(n, "") for n in range(len(lines))], places)
        ]
        job = random_setup(rng, Job(texts[0], wide()))
        runs = (
            run(tmp_path, job),
            run(tmp_path, replace(job, program=texts[1], controller={"absolute_arc_centers": "true"})),
        )
        where = f"seed {seed}\n{job.setup_text()}{texts[0]}---\n{texts[1]}{runs[0].told()}\n{runs[1].told()}"
        assert runs[0].clean, where
        assert not same_moves(*runs, 1e-9), f"{same_moves(*runs, 1e-9)}\n{where}"


@seeds
def test_arcs_seen_from_the_front(first: int, count: int, tmp_path: Path) -> None:
    """3.4.11.2 against 3.4.3: seen from negative Y, G2 and G3 of the XZ plane change places, those of others do not."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        tree = Maker(rng, Can(transforms=rng.random() < 0.3)).program(rng.randrange(3, 10))
        job = random_setup(rng, Job(render(tree), wide()))
        job = fitted(rng, job, run(tmp_path, job), SIZES)
        plane = 17

        def swapped(node: Statement) -> Tree:
            nonlocal plane
            if not isinstance(node, Block):
                return (node,)
            plane = next((int(w.value) for w in node.words if w.letter == "G" and w.value in PLANES), plane)
            turn = {2.0: 3.0, 3.0: 2.0} if plane == 18 else {}
            return (
                replace(
                    node,
                    words=tuple(
                        replace(w, value=turn.get(w.value, w.value)) if w.letter == "G" else w for w in node.words
                    ),
                ),
            )

        other = replace(job, program=render(rewrite(tree, swapped)), controller={"xz_seen_from": '"-y"'})
        check(tmp_path, seed, job, other, {}, 1e-9)


@seeds
def test_a_machine_in_inches(first: int, count: int, tmp_path: Path) -> None:
    """The same numbers in a machine file, setup, park positions and program of inches: 25.4 times the path."""

    def inches(node: Statement) -> Tree:
        if not isinstance(node, Block):
            return (node,)
        return (
            replace(
                node,
                words=tuple(
                    Word("G", 20.0, plain=True) if (w.letter, w.value) == ("G", 21.0) else w for w in node.words
                ),
            ),
        )

    for seed in range(first, first + count):
        rng = random.Random(seed)
        tree = Maker(rng, Can(rotary=False)).program(rng.randrange(3, 10))
        job = random_setup(rng, Job(render(tree), wide()))
        job = fitted(rng, job, run(tmp_path, job), (0.01, 1.0, 20.0, -0.01))
        other = replace(job, program=render(rewrite(tree, inches)), unit="inch")
        check(tmp_path, seed, job, other, {n: (n, 25.4, 0.0) for n in "xyz"}, 1e-6)


@seeds
def test_the_setup_written_as_lines(first: int, count: int, tmp_path: Path) -> None:
    """Work offsets by G10 L2 or by #5221 …, the G92 offset by #5211 … and G92.3, the start by G53, parks by #5161 …"""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        tree = Maker(rng, Can(structure=rng.random() < 0.5)).program(rng.randrange(3, 10))
        job = random_setup(rng, Job(render(tree), wide()))
        one = run(tmp_path, job)
        lines: list[str] = []
        for system, values in job.work.items():
            text = [(k, number(v)) for k, v in enumerate(values.values()) if isinstance(v, float)]
            if rng.random() < 0.5:
                lines.append(f"G10 L2 P{system} " + " ".join(f"{AXES[k].upper()}{v}" for k, v in text))
            else:
                lines += [f"#{5201 + 20 * system + k} = {v}" for k, v in text]
        lines += [f"#{5211 + k} = {number(v)}" for k, v in enumerate(job.g92.values()) if isinstance(v, float)]
        lines += [f"#{n} = {number(v)}" for n, v in job.parks.items()]
        start = " ".join(f"{n.upper()}{number(v)}" for n, v in job.start.items() if isinstance(v, float))
        lines += ["G55", "G54", "G92.3", f"G21 G90 G69 G50 G53 G0 {start}"]
        unknown: Known = dict.fromkeys(AXES, None)
        less = replace(
            job, program="\n".join(lines) + "\n" + job.program, parks={}, g92=unknown,
            work=dict.fromkeys(job.work, unknown),
        )  # fmt: skip
        two: Run = run(tmp_path, less)
        where = f"seed {seed}\n{job.setup_text()}{less.program}{two.told()}"
        assert two.clean, where
        # The way there is the one move more.
        two = replace(
            two, to=two.to[1:], center=two.center[1:], kind=two.kind[1:], feed=two.feed[1:], forms=two.forms[1:]
        )
        assert not same_moves(one, two), f"{same_moves(one, two)}\n{where}"
        assert one.verdict is two.verdict, where
