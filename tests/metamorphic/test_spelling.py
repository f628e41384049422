"""One program in two spellings that the manual says mean the same: the same moves, bit for bit."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from metamorphic.jobs import Job, Run, fitted, random_setup, run, same_moves, wide
from metamorphic.programs import (
    HELD,
    Block,
    Can,
    Maker,
    Tree,
    inlined,
    print_block,
    render,
    respelled,
    rewrite_blocks,
    spell_plain,
    split,
    unrolled,
)

from gproof.backend.emit.eding.program import emit
from gproof.frontend.eding.load import load_alone
from gproof.ir.finding import Findings
from gproof.ir.verdict import worst

FAST, SOAK = 10, 400
SEEDS = [pytest.param(n * FAST, FAST, id=f"{n}") for n in range(1)]
MORE = [pytest.param(10_000 + n * 100, 100, id=f"soak-{n}", marks=pytest.mark.soak) for n in range(SOAK // 100)]
seeds = pytest.mark.parametrize(("first", "count"), [*SEEDS, *MORE])

Rewriter = Callable[[random.Random, Tree], str]


def compare(folder: Path, job: Job, other: Job, where: str, tolerance: float = 0.0) -> tuple[Run, Run]:
    """Both jobs make the same moves and get the same answer."""
    one, two = run(folder, job), run(folder, other)
    texts = f"{where}\n{job.setup_text()}\n{job.program}\n---\n{other.program}\n{one.told()}\n---\n{two.told()}"
    assert one.clean, texts
    assert one.verdict is two.verdict, f"{one.verdict} and {two.verdict}\n{texts}"
    difference = same_moves(one, two, tolerance)
    assert not difference, f"{difference}\n{texts}"
    return one, two


def each(first: int, count: int, folder: Path, can: Callable[[random.Random], Can], rewriter: Rewriter) -> None:
    for seed in range(first, first + count):
        rng = random.Random(seed)
        tree = Maker(rng, can(rng)).program(rng.randrange(3, 10))
        job = random_setup(rng, Job(render(tree), wide()))
        compare(folder, job, replace(job, program=rewriter(rng, tree)), f"seed {seed}")


def anything(rng: random.Random) -> Can:
    return Can(units=rng.random() < 0.3)


@seeds
def test_loops_unrolled(first: int, count: int, tmp_path: Path) -> None:
    """Manual 4.1: a while loop is its body as often as its condition holds."""
    each(first, count, tmp_path, anything, lambda rng, tree: render(unrolled(tree)))


@seeds
def test_subprograms_inlined(first: int, count: int, tmp_path: Path) -> None:
    """Manual 4.1: a call is the body of the subprogram."""
    each(first, count, tmp_path, anything, lambda rng, tree: render(inlined(tree)))


@seeds
def test_numbers_as_expressions(first: int, count: int, tmp_path: Path) -> None:
    """Manual 3.2.2, 3.4: any number may be an expression, a parameter or a function of the same value."""
    each(first, count, tmp_path, anything, lambda rng, tree: render((*HELD, *tree), respelled(rng)))


@seeds
def test_words_in_another_order(first: int, count: int, tmp_path: Path) -> None:
    """Manual 3.2.1, 3.2.6: the words of a line in any order, with line numbers, blanks and either case."""

    def shuffled(rng: random.Random, tree: Tree) -> str:
        def shuffle(block: Block) -> Tree:
            return (replace(block, words=tuple(rng.sample(block.words, len(block.words)))),)

        lines = render(rewrite_blocks(tree, shuffle)).splitlines()
        out = []
        for n, line in enumerate(lines):
            kind = rng.randrange(5)
            plain = not line.startswith(("sub", "endsub", "gosub", "if", "else", "endif", "while", "endwhile", "TCA"))
            if kind == 0 and plain:
                line = f"N{n} {line}"
            elif kind == 1:
                line = line.lower()
            elif kind == 2 and plain:
                line = line.replace(" ", "")
            elif kind == 3 and plain:
                line = f"(note) {line} ; G91"
            out.append(line)
        return "\n".join(out) + "\n"

    each(first, count, tmp_path, anything, shuffled)


@seeds
def test_codes_before_their_move(first: int, count: int, tmp_path: Path) -> None:
    """Manual 3.2.7: a motion code stays active; G90 and G91 may stand on the line of the move (table 3-7)."""

    def without(rng: random.Random, tree: Tree) -> str:
        lines = render(tree).splitlines()
        out: list[str] = []
        for line in lines:
            moves = line.startswith(("G0 ", "G1 ", "G2 ", "G3 ", "G8", "G73")) and line != "G80"
            if moves and out and out[-1] in ("G90", "G91") and rng.random() < 0.7:
                out[-1] = f"{out[-1]} {line}"
                continue
            out.append(line)
        return "\n".join(out) + "\n"

    each(first, count, tmp_path, anything, without)


@seeds
def test_formatted(first: int, count: int, tmp_path: Path) -> None:
    """``gproof fmt`` keeps every line where it is: moves, answer and messages are the same."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        tree = Maker(rng, Can(deleted=True, units=rng.random() < 0.5)).program(rng.randrange(3, 10))
        job = random_setup(rng, Job(render((*HELD, *tree), respelled(rng)), wide(60.0)))
        job = replace(job, block_delete=rng.choice((True, False, None)))
        path = tmp_path / "before.cnc"
        path.write_text(job.program, encoding="utf-8")
        program = load_alone(path, Findings(), "before.cnc")
        assert program is not None
        printed = b"".join(emit(program)).decode()
        one, two = run(tmp_path, job), run(tmp_path, replace(job, program=printed))
        assert one.verdict is two.verdict
        assert one.told() == two.told(), f"seed {seed}\n{job.program}\n---\n{printed}"
        assert not same_moves(one, two), f"seed {seed}"


@seeds
def test_lines_behind_a_slash(first: int, count: int, tmp_path: Path) -> None:
    """Manual 3.2: with the switch on they are not there, with it off the slash is not; unknown, both must hold."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        tree = Maker(rng, Can(deleted=True)).program(rng.randrange(3, 10))
        job = random_setup(rng, Job(render(tree), wide(rng.choice((60.0, 100.0, 1e6)))))
        gone = render(rewrite_blocks(tree, lambda block: () if block.deleted else (block,)))
        kept = render(rewrite_blocks(tree, lambda block: (replace(block, deleted=False),)))
        on, without = run(tmp_path, replace(job, block_delete=True)), run(tmp_path, replace(job, program=gone))
        off, plain = run(tmp_path, job), run(tmp_path, replace(job, program=kept))
        either = run(tmp_path, replace(job, block_delete=None))
        where = f"seed {seed}\n{job.program}"
        for a, b in ((on, without), (off, plain)):
            assert a.verdict is b.verdict, where
            assert not same_moves(a, b), where
        assert either.verdict is worst((on.verdict, off.verdict)), where


@seeds
def test_moves_in_parts(first: int, count: int, tmp_path: Path) -> None:
    """A line cut in the middle, a turn cut into quarters: the same path, so the same extent and the same answer."""
    sizes = (0.002, 1.0, 20.0, -0.002)
    for seed in range(first, first + count):
        rng = random.Random(seed)
        tree = Maker(rng, Can(units=rng.random() < 0.3)).program(rng.randrange(3, 10))
        job = random_setup(rng, Job(render(tree), wide()))
        before = run(tmp_path, job)
        job = fitted(rng, job, before, sizes)
        one, two = run(tmp_path, job), run(tmp_path, replace(job, program=render(split(tree))))
        where = (
            f"seed {seed}\n{job.machine_text()}{job.program}\n---\n{render(split(tree))}\n{one.told()}\n{two.told()}"
        )
        assert one.verdict is two.verdict, where
        assert one.box.keys() == two.box.keys(), where
        for key, span in one.box.items():
            assert span == pytest.approx(two.box[key], abs=1e-9), where


def test_the_spellings_differ() -> None:
    """The rewriters do something: a guard of the tests above."""
    rng = random.Random(3)
    trees = [Maker(random.Random(n)).program(9) for n in range(20)]
    assert any(render(tree) != render(split(tree)) for tree in trees)
    assert any(render(tree) != render(unrolled(tree)) != render(inlined(tree)) for tree in trees)
    assert all(render(tree) != render(tree, respelled(rng)) for tree in trees)
    assert print_block(trees[0][0], spell_plain).startswith("G21") if isinstance(trees[0][0], Block) else False
