"""WinCNC: the same places under other zeros, heads, arrays, locks: the same moves."""

from __future__ import annotations

import random
from dataclasses import replace
from pathlib import Path

import pytest
from metamorphic.test_wincnc_spelling import compare, job_of, judged_near
from metamorphic.wincnc_jobs import Job
from metamorphic.wincnc_programs import (
    AXES,
    Can,
    Group,
    Line,
    Maker,
    Program,
    Word,
    code,
    flat,
    mapped,
    number,
    relative,
    text_of,
)

FAST = 4
SEEDS = [pytest.param(0, FAST, id="0")]
MORE = [pytest.param(20_000 + n * 40, 40, id=f"soak-{n}", marks=pytest.mark.soak) for n in range(10)]
seeds = pytest.mark.parametrize(("first", "count"), [*SEEDS, *MORE])


def written(program: Program) -> str:
    return text_of(["G22", *flat(program)])


# ---- local coordinates


class Zeros(Maker):
    """Sets local coordinates; remembers the machine place of their zero."""

    zeros: list[dict[str, float]]

    def set_local(self) -> Group:
        before = dict(self.local)
        group = super().set_local()
        self.zeros.append(before)
        self.zeros.append(dict(self.local))
        return group


@seeds
def test_local_coordinates(first: int, count: int, tmp_path: Path) -> None:
    """G92, G92.2 and G92 alone: the same by G92.1, which names the machine place of zero; or each by G92.2."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        maker = Zeros(rng, Can(calls=False))
        maker.zeros = []
        program = maker.program(2)
        for _ in range(rng.randrange(1, 5)):
            program += [maker.set_local(), *maker.groups(2)]
        job = judged_near(tmp_path, rng, job_of(program))
        for name in ("G92.1", "G92.2"):
            zeros = iter(maker.zeros)

            def change(line: Line, name: str = name, zeros: object = zeros) -> tuple[Line, ...]:
                if line.kind != "local":
                    return (line,)
                before, behind = next(zeros), next(zeros)  # type: ignore[call-overload]
                values = behind if name == "G92.1" else {n: v - before[n] for n, v in behind.items()}
                return (replace(line, words=(*code(name), *(Word(n, v) for n, v in values.items()))),)

            other = replace(job, program=written(mapped(program, change)))
            compare(tmp_path, job, other, f"seed {seed}, {name}")


@seeds
def test_local_coordinates_put_away(first: int, count: int, tmp_path: Path) -> None:
    """G92.3 stores and clears them, the next one brings them back: G92 alone, and G92.1 of what was."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        maker = Maker(rng, Can(calls=False))
        program = [*maker.program(2), maker.set_local(), *maker.groups(2)]
        stored = dict(maker.local)
        is_set = any(stored.values())
        maker.local = dict.fromkeys(AXES, 0.0)
        maker.can = replace(maker.can, local=False)
        middle = maker.groups(3)
        maker.local = dict(stored)
        behind = maker.groups(2)
        back = Line((*code("G92.1"), *(Word(n, v) for n, v in stored.items())))
        switch: Group = (Line(text="G92.3"),)
        one: Program = [*program, switch, *middle, *([switch] if is_set else []), *behind]
        two: Program = [*program, (Line(text="G92"),), *middle, (back,), *behind]
        job = judged_near(tmp_path, rng, job_of(one))
        compare(tmp_path, job, replace(job, program=written(two)), f"seed {seed}")


@seeds
def test_workspaces(first: int, count: int, tmp_path: Path) -> None:
    """G55 … G59 with M0, which move nothing, and a sign that is known: a zero that lies elsewhere, like G92.2."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        maker = Maker(rng, Can(calls=False, turns=rng.random() < 0.5))
        shifts = {n: (rng.randrange(-320, 320) / 16, rng.randrange(-320, 320) / 16) for n in (55, 56, 58)}
        sign = rng.choice((1, -1))
        at = 0.0, 0.0
        one, two = maker.program(1), []
        two = list(one)
        for _ in range(rng.randrange(1, 5)):
            space = rng.choice((54, 55, 56, 58))
            new = shifts.get(space, (0.0, 0.0))
            change = [sign * (b - a) for a, b in zip(at, new, strict=True)]
            at = new
            # The maker knows nothing of workspaces: to it the zero is shifted, as it is in the second program.
            words = tuple(Word(n, v) for n, v in zip("XY", change, strict=True))
            for word in words:
                maker.local[word.letter] += word.value
            one.append((Line(text=f"G{space}"),))
            two.append((Line((*code("G92.2"), *words)),))
            maker.can = replace(maker.can, local=False)
            groups = maker.groups(3)
            one += groups
            two += groups
        job = judged_near(tmp_path, rng, replace(Job(written(one)), shifts=shifts, sign=sign))
        compare(tmp_path, job, replace(job, program=written(two)), f"seed {seed}")


@seeds
def test_workspaces_of_heads(first: int, count: int, tmp_path: Path) -> None:
    """G55 … G57 with M1: the other head goes to the same X and Y of the program, which is a move of its own."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        maker = Maker(rng, Can(calls=False, turns=False))
        shifts = {n: (rng.randrange(-320, 320) / 16, rng.randrange(-320, 320) / 16) for n in (55, 56)}
        sign = rng.choice((1, -1))
        at = 0.0, 0.0
        one = maker.program(1)
        two = list(one)
        maker.can = replace(maker.can, local=False, bare=False)
        for _ in range(rng.randrange(1, 5)):
            space = rng.choice((54, 55, 56))
            new = shifts.get(space, (0.0, 0.0))
            change = [sign * (b - a) for a, b in zip(at, new, strict=True)]
            at = new
            words = tuple(Word(n, v) for n, v in zip("XY", change, strict=True))
            for word in words:
                maker.local[word.letter] += word.value
                maker.at[word.letter] += word.value
            one.append((Line(text=f"G{space}"),))
            two.append((Line((*code("L91 G0"), *words)), Line((*code("G92.2"), *words))))
            groups = maker.groups(3)
            one += groups
            two += groups
        job = judged_near(tmp_path, rng, replace(Job(written(one)), shifts=shifts, sign=sign, moves=1))
        compare(tmp_path, job, replace(job, program=written(two)), f"seed {seed}")


# ---- tool measures


@seeds
def test_measures(first: int, count: int, tmp_path: Path) -> None:
    """M37, G43, G49: places count from elsewhere, as under G92.2 by as much."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        maker = Maker(rng, Can(calls=False, local=False, measures=False))
        one = maker.program(1)
        two = list(one)
        for _ in range(rng.randrange(1, 5)):
            before = dict(maker.tool)
            group = maker.measure()
            words = [Word(n, maker.tool[n] - before[n]) for n in "ZW"]
            one.append(group)
            two.append((Line((*code("G92.2"), *words)),))
            groups = maker.groups(3)
            one += groups
            two += groups
        job = judged_near(tmp_path, rng, Job(written(one)))
        compare(tmp_path, job, replace(job, program=written(two)), f"seed {seed}")


# ---- heads and locks


@seeds
def test_heads_swapped(first: int, count: int, tmp_path: Path) -> None:
    """L12 WZ: words of Z move W and words of W move Z; L12 ZZ: Z moves both; L12 alone: as before."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        can = Can(calls=False, local=False, machine=False, homes=False, measures=False, cycles=False, turns=False)
        maker = Maker(rng, replace(can, heads=False))
        program = maker.program(rng.randrange(3, 9))

        def swapped(line: Line) -> tuple[Line, ...]:
            words = tuple(replace(w, letter={"Z": "W", "W": "Z"}.get(w.letter, w.letter)) for w in line.words)
            return (replace(line, words=words),)

        def both(line: Line) -> tuple[Line, ...]:
            more = tuple(replace(w, letter="W") for w in line.words if w.letter == "Z")
            return (replace(line, words=(*line.words, *more)),)

        behind = maker.groups(2)
        for mapping, change in (("L12 WZ", swapped), ("l12 z z", both), ("L12ZW", None), ("L12", None)):
            off: Group = (Line(text="L12"),)
            one: Program = [(Line(text=mapping),), *program, off, *behind]
            two: Program = [*(program if change is None else mapped(program, change)), *behind]
            job = judged_near(tmp_path, rng, Job(written(one)))
            compare(tmp_path, job, replace(job, program=written(two)), f"seed {seed}, {mapping}")


@seeds
def test_axes_mapped(first: int, count: int, tmp_path: Path) -> None:
    """L11: the axes that take the words of X, Y, Z, W, in this order; two that take the same one move together."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        can = Can(
            arcs=False, calls=False, local=False, machine=False, homes=False, measures=False, cycles=False, turns=False
        )
        program = Maker(rng, can).program(rng.randrange(3, 9))
        order = rng.sample(AXES, 4)

        def change(line: Line, order: list[str] = order) -> tuple[Line, ...]:
            words = {w.letter: w for w in line.words if w.letter in AXES and not w.plain}
            rest = tuple(w for w in line.words if w.letter not in AXES or w.plain)
            # A permutation and its inverse differ: the machine's X takes the word that stands first in the list.
            made = tuple(
                replace(words[source], letter=axis) for axis, source in zip(AXES, order, strict=True) if source in words
            )
            return (replace(line, words=(*rest, *made)),)

        if any(order[AXES.index(other)] != axis for axis, other in zip(AXES, order, strict=True)):
            continue  # the manual's example is a swap; what three axes in a ring do it does not say
        job = judged_near(tmp_path, rng, Job(written([(Line(text="L11 " + "".join(order)),), *program])))
        compare(tmp_path, job, replace(job, program=written(mapped(program, change))), f"seed {seed}")


@seeds
def test_followers(first: int, count: int, tmp_path: Path) -> None:
    """L13 ZW: every step of Z is one of W: as if each line gave W the same distance."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        can = Can(calls=False, local=False, machine=False, homes=False, measures=False, cycles=False, turns=False)
        maker = Maker(rng, replace(can, heads=False))
        head, *program = maker.program(rng.randrange(3, 9))
        leader, follower = rng.choice(("ZW", "WZ", "ZW"))
        swap = {"Z": leader, "W": follower}

        def distances(line: Line, swap: dict[str, str] = swap) -> tuple[Line, ...]:
            made = relative(line)
            return (replace(made, words=tuple(replace(w, letter=swap.get(w.letter, w.letter)) for w in made.words)),)

        def together(line: Line, leader: str = leader, follower: str = follower) -> tuple[Line, ...]:
            more = tuple(replace(w, letter=follower) for w in line.words if w.letter == leader)
            return (replace(line, words=(*line.words, *more)),)

        moves = mapped(program, distances)
        start: Program = [head, (Line(text="G91"),)]
        one = written([*start, (Line(text=f"L13 {leader}{follower}"),), *moves])
        job = judged_near(tmp_path, rng, Job(one))
        compare(tmp_path, job, replace(job, program=written([*start, *mapped(moves, together)])), f"seed {seed}")


@seeds
def test_locked_axes(first: int, count: int, tmp_path: Path) -> None:
    """L300 W: what is commanded to W is ignored, until L301."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        can = Can(calls=False, local=False, homes=False, measures=False, cycles=rng.random() < 0.5, turns=False)
        maker = Maker(rng, can)
        before, program, behind = maker.program(2), maker.groups(6), maker.groups(2)
        locked = rng.choice(("W", "W", "ZW") if not can.cycles else ("W",))

        def without(line: Line, locked: str = locked) -> tuple[Line, ...]:
            if line.kind == "machine" and len(line.words) == 1:
                left = [axis for axis in "ZW" if axis not in locked]
                words = (*line.words, *(Word(axis, 0.0) for axis in left))
                return (replace(line, words=words),) if left else (Line(text="[all of them are locked]"),)
            left_out = tuple(w for w in line.words if w.letter not in locked or w.plain)
            if line.kind in ("machine", "go") and not any(w.letter in AXES for w in left_out):
                feed = tuple(w for w in left_out if w.letter == "F")
                # A line that moves nothing is still the motion of the lines behind it.
                stay = replace(line, words=(*(w for w in line.words if w.plain), *code("L91"), Word("X", 0.0), *feed))
                return (stay,) if line.kind == "go" else (Line(text="[locked]"),)
            return (replace(line, words=left_out),)

        on, off = (Line(text=f"L300 {locked}"),), (Line(text=f"L301 {locked}"),)
        job = judged_near(tmp_path, rng, Job(written([*before, on, *program, off, *behind])))
        other = written([*before, *mapped(program, without), *behind])
        compare(tmp_path, job, replace(job, program=other), f"seed {seed}")


# ---- arrays


@seeds
def test_arrays(first: int, count: int, tmp_path: Path) -> None:
    """L10 of one row or one column: the part, rapid to the next place, the part …, and back unless E stands there."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        maker = Maker(rng, Can(calls=False, homes=False, bare=False))
        before = maker.program(2)
        start = maker.at["X"], maker.at["Y"]
        times, step = rng.randrange(1, 5), rng.randrange(-480, 480) / 16
        is_row = rng.random() < 0.5
        stays = rng.random() < 0.3
        words = f"C{times} X{number(step)} R1" if is_row else f"R{times} Y{number(step)}"
        # A part begins with G92 X Y, so that its places count from the cell; it is bare, or has numbers.
        zero = Line((*code("G92"), Word("X", maker.number(32)), Word("Y", maker.number(32))))
        for word in zero.words[1:]:
            maker.local[word.letter] = maker.at[word.letter] - word.value
        maker.kept = None
        maker.can = replace(maker.can, local=False, machine=False, measures=False)
        part: Program = [(zero,), (maker.go("G0", feed=True),), *maker.groups(rng.randrange(1, 5))]
        array = Line(text=f"L10 {words}" + (" E1" if stays else ""))
        ends = rng.random() < 0.5
        behind: Program = [(Line(text="G92"),), (maker.everywhere(),)] if ends else []
        one: Program = [*before, (array,), *part, *([(Line(text="L10"),)] if ends else []), *behind]
        two: Program = [*before]
        for cell in range(times):
            if cell:
                there = start[0] + (cell * step if is_row else 0.0), start[1] + (0.0 if is_row else cell * step)
                two.append((Line((*code("G53"), Word("X", there[0]), Word("Y", there[1]))),))
            two += part
        if not stays:
            two.append((Line((*code("G53"), Word("X", start[0]), Word("Y", start[1]))),))
        two += behind
        job = judged_near(tmp_path, rng, Job(written(one)))
        compare(tmp_path, job, replace(job, program=written(two)), f"seed {seed}")


# ---- cycles


@seeds
def test_holes_written_out(first: int, count: int, tmp_path: Path) -> None:
    """G73, G81 to G83: X and Y, down to R, by pecks of Q, back to R; lines with X and Y are further holes."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        maker = Maker(rng, Can(calls=False, turns=False))
        program = [*maker.program(2), maker.cycle(), maker.group(), maker.cycle(), maker.group()]
        kept: dict[str, float] = {}

        def moves(line: Line) -> tuple[Line, ...]:
            nonlocal kept
            if line.kind not in ("cycle", "hole"):
                return (line,)
            values = {w.letter: w.value for w in line.words}
            if line.kind == "cycle":
                kept = values
            name, r, depth = kept["G"], kept["R"], kept["Z"]
            target = tuple(w for w in line.words if w.letter in "XY")
            heights: list[tuple[str, float]] = [("G0", r)]
            at, peck = r, kept.get("Q", r - depth)
            while at - peck > depth:
                at -= peck
                heights.append(("G1", at))
                heights += [("G0", r), ("G0", min(at + 1.27, r))] if name == 83.0 else [("G0", at + 1.27)]
            heights += [("G1", depth), ("G0", r)]
            out = [Line((*code("G0"), *target))]
            out += [Line((*code(motion), Word("Z", z), Word("F", kept["F"]))) for motion, z in heights]
            if name == 82.0:
                out.insert(-1, Line(text="G4 X.25"))
            return tuple(out)

        job = judged_near(tmp_path, rng, Job(written(program)))
        compare(tmp_path, job, replace(job, program=written(mapped(program, moves))), f"seed {seed}", 1e-9)
