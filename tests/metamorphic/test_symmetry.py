"""Jobs turned, mirrored, shifted and converted: extents and answers go along."""

from __future__ import annotations

import random
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest
from metamorphic.jobs import AXES, Job, Known, Run, fitted, random_setup, run, same_moves, wide
from metamorphic.programs import (
    LENGTHS,
    PLANES,
    Block,
    Can,
    Maker,
    Raw,
    Statement,
    Tree,
    Word,
    number,
    render,
    rewrite,
    words,
)

from gproof.ir.verdict import Verdict

FAST = 10
SEEDS = [pytest.param(n * FAST, FAST, id=f"{n}") for n in range(1)]
MORE = [pytest.param(20_000 + n * 100, 100, id=f"soak-{n}", marks=pytest.mark.soak) for n in range(4)]
seeds = pytest.mark.parametrize(("first", "count"), [*SEEDS, *MORE])
SIZES = (0.002, 1.0, 20.0, -0.002)
"""How far limits lie beyond the path, mm."""


def check(
    folder: Path, seed: int, job: Job, other: Job, moved: dict[str, tuple[str, float, float]], tol: float
) -> None:
    """The other job's extents are the first one's: axis -> (its axis there, factor, what is added)."""
    one, two = run(folder, job), run(folder, other)
    where = (
        f"seed {seed}\n{job.machine_text()}{job.setup_text()}{job.program}---\n{other.machine_text()}"
        f"{other.setup_text()}{other.program}{one.told()}\n---\n{two.told()}"
    )
    assert one.clean, where
    assert one.verdict is two.verdict, f"{one.verdict} {two.verdict}\n{where}"
    assert len(one.to) == len(two.to), where
    for name in AXES:
        there, factor, shift = moved.get(name, (name, 1.0, 0.0))
        if (name, "") not in one.box:
            assert (there, "") not in two.box, where
            continue
        low, high = sorted(factor * value + shift for value in one.box[name, ""])
        assert two.box[there, ""] == pytest.approx((low, high), abs=tol), f"{name}\n{where}"


# -- mirrored


def mirrored(tree: Tree, axis: str) -> Tree:
    """Every number along an axis with its sign changed, and what turns, turning the other way."""
    plane = 17

    def change(node: Statement) -> Tree:
        nonlocal plane
        if not isinstance(node, Block):
            return (node,)
        codes = {(w.letter, w.value) for w in node.words if w.letter == "G"}
        plane = next((int(v) for _, v in codes if v in PLANES), plane)
        scaling = ("G", 51.0) in codes
        center = {"X": "I", "Y": "J", "Z": "K"}[axis]
        swap = {2.0: 3.0, 3.0: 2.0} if axis in PLANES[plane][:2] else {}
        swap |= {41.1: 42.1, 42.1: 41.1}
        out = []
        for word in node.words:
            if word.letter == "G":
                word = replace(word, value=swap.get(word.value, word.value))
            elif word.letter == axis and not scaling:
                word = replace(word, value=-word.value, counter=-word.counter)
            elif (word.letter == center and ("G", 43.1) not in codes) or (word.letter == "R" and ("G", 68.0) in codes):
                word = replace(word, value=-word.value)
            out.append(word)
        return (replace(node, words=tuple(out)),)

    return rewrite(tree, change)


def negated(values: Known, axis: str) -> Known:
    out: Known = {}
    for name, value in values.items():
        out[name] = -value if name == axis and isinstance(value, float) else value
    return out


@seeds
@pytest.mark.parametrize("axis", ["X", "Y"])
def test_mirrored(axis: str, first: int, count: int, tmp_path: Path) -> None:
    """X or Y of everything changes its sign: arcs, sides and rotations turn the other way (3.4.3, 3.4.11, 3.4.18)."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        can = Can(no_cycle_along=axis, structure=False)
        tree = Maker(rng, can).program(rng.randrange(3, 10))
        job = random_setup(rng, Job(render(tree), wide()))
        job = fitted(rng, job, run(tmp_path, job), SIZES)
        low, high = job.limits[axis.lower()]
        k = "XYZ".index(axis)
        other = replace(
            job, program=render(mirrored(tree, axis)), limits=job.limits | {axis.lower(): (-high, -low)},
            start=negated(job.start, axis.lower()), g92=negated(job.g92, axis.lower()),
            work={n: negated(w, axis.lower()) for n, w in job.work.items()},
            parks={n: -v if n in (5161 + k, 5181 + k) else v for n, v in job.parks.items()},
        )  # fmt: skip
        check(tmp_path, seed, job, other, {axis.lower(): (axis.lower(), -1.0, 0.0)}, 1e-9)


# -- axes in another order

NEXT = {"X": "Y", "Y": "Z", "Z": "X", "I": "J", "J": "K", "K": "I"}
TURNED_PLANE = {17.0: 19.0, 19.0: 18.0, 18.0: 17.0}
LOWER = {"x": "y", "y": "z", "z": "x", "a": "a"}


def cycled(tree: Tree) -> Tree:
    def change(node: Statement) -> Tree:
        if not isinstance(node, Block):
            return (node,)
        turned = tuple(
            replace(
                w,
                letter=NEXT.get(w.letter, w.letter),
                value=TURNED_PLANE.get(w.value, w.value) if w.letter == "G" else w.value,
            )
            for w in node.words
        )
        return (replace(node, words=turned),)

    return rewrite(tree, change)


@seeds
def test_axes_in_another_order(first: int, count: int, tmp_path: Path) -> None:
    """X Y Z become Y Z X, and the planes with them: XY is YZ, YZ is ZX, ZX is XY (3.4.3, 3.4.6, 3.4.21)."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        can = Can(transforms=False, contours=False, lengths=False, units=rng.random() < 0.3)
        tree = Maker(rng, can).program(rng.randrange(3, 10))
        job = random_setup(rng, Job(render(tree), wide()))
        job = fitted(rng, job, run(tmp_path, job), SIZES)

        def turned(values: Known) -> Known:
            return {LOWER[name]: value for name, value in values.items()}

        parks = {n + (1 if (n - 5161) % 20 < 2 else -2 if (n - 5161) % 20 == 2 else 0): v for n, v in job.parks.items()}
        other = replace(
            job, program=render(cycled(tree)), limits={LOWER[n]: span for n, span in job.limits.items()},
            start=turned(job.start), g92=turned(job.g92), work={n: turned(w) for n, w in job.work.items()}, parks=parks,
        )  # fmt: skip
        check(tmp_path, seed, job, other, {a: (b, 1.0, 0.0) for a, b in LOWER.items()}, 1e-9)


# -- the machine's zero elsewhere


@seeds
def test_another_machine_zero(first: int, count: int, tmp_path: Path) -> None:
    """Start, work offsets, limits, park positions and G53 shifted alike: nothing else changes (3.1.3, 3.4.14)."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        tree = Maker(rng, Can(parks=True, rotary=False)).program(rng.randrange(3, 10))
        job = random_setup(rng, Job(render(tree), wide()))
        job = fitted(rng, job, run(tmp_path, job), SIZES)
        shift = {n: rng.randrange(-320, 320) / 16 for n in "xyz"} | {"a": 0.0}

        def absolute(node: Statement, shift: dict[str, float] = shift) -> Tree:
            if not isinstance(node, Block) or node.kind not in ("machine", "g10l2"):
                return (node,)
            return (
                replace(
                    node,
                    words=tuple(replace(w, value=w.value + shift.get(w.letter.lower(), 0.0)) for w in node.words),
                ),
            )

        def moved(values: Known, shift: dict[str, float] = shift) -> Known:
            return {n: v + shift[n] if isinstance(v, float) else v for n, v in values.items()}

        area = (
            {n: (a, a + 20.0) for n in "xyz" for a in (rng.randrange(-40, 20) * 1.0,)} if rng.random() < 0.5 else None
        )
        job = replace(job, area=area)
        other = replace(
            job, program=render(rewrite(tree, absolute)), start=moved(job.start),
            work={n: moved(w) for n, w in job.work.items()},
            parks={n: v + shift[AXES[(n - 5161) % 20]] for n, v in job.parks.items()},
            limits={n: (a + shift[n], b + shift[n]) for n, (a, b) in job.limits.items()},
            area=None if area is None else {n: (a + shift[n], b + shift[n]) for n, (a, b) in area.items()},
        )  # fmt: skip
        check(tmp_path, seed, job, other, {n: (n, 1.0, d) for n, d in shift.items()}, 1e-9)


# -- inches


@seeds
def test_in_inches(first: int, count: int, tmp_path: Path) -> None:
    """Every length divided by 25.4 under G20 (3.4.7); the limits are the machine's and stay."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        tree = Maker(rng, Can(parks=False, structure=rng.random() < 0.5)).program(rng.randrange(3, 10))
        tree = rewrite(tree, lambda node: (node,) if not _table(node) else ())
        tree = _uncounted(tree)
        job = random_setup(rng, Job(render(tree), wide()))
        job = fitted(rng, job, run(tmp_path, job), SIZES)

        def inches(node: Statement) -> Tree:
            if not isinstance(node, Block):
                return (node,)
            codes = {w.value for w in node.words if w.letter == "G"}
            made = tuple(_inch(w, dynamic=bool(codes & {41.1, 42.1})) for w in node.words)
            return (replace(node, words=made),)

        other = replace(job, program=render(rewrite(tree, inches)))
        check(tmp_path, seed, job, other, {}, 1e-6)


def _table(node: Statement) -> bool:
    """A tool length that the program writes: its unit is open (3.1.1)."""
    return isinstance(node, Raw) and node.text.startswith("#54")


def _uncounted(tree: Tree) -> Tree:
    def change(node: Statement) -> Tree:
        if not isinstance(node, Block):
            return (node,)
        return (replace(node, words=tuple(replace(w, counter=0) for w in node.words)),)

    return rewrite(tree, change)


def _inch(word: Word, *, dynamic: bool) -> Word:
    if word.letter == "G" and word.value == 21.0:
        return replace(word, value=20.0)
    if word.plain or (word.letter not in LENGTHS and not (word.letter == "D" and dynamic)):
        return word
    return replace(word, text=f"{word.value / 25.4:.14f}")


# -- absolute and incremental


@dataclass
class Walk:
    """A path whose place is followed, so that each line can be written in either distance mode.

    at: program coordinates of X Y Z; every number is a multiple of 1/16. centers: those of arcs are left out of the
    lines, and kept by line as increments and as places.
    """

    rng: random.Random
    at: list[float] = field(default_factory=lambda: [0.0] * 3)
    lines: list[tuple[str, str]] = field(default_factory=list)
    plane: int = 17
    centers: bool = False
    relative: dict[int, str] = field(default_factory=dict)
    absolute: dict[int, str] = field(default_factory=dict)

    def write(self, absolute: str, incremental: str) -> None:
        self.lines.append((absolute, incremental))

    def number(self, most: int = 480) -> float:
        return self.rng.randrange(-most, most) / 16

    def place(self) -> dict[int, float]:
        axes = [k for k in range(3) if self.rng.random() < 0.5] or [self.rng.randrange(3)]
        return {k: self.number() for k in axes}

    def both(self, target: dict[int, float]) -> tuple[str, str]:
        one = " ".join(f"{'XYZ'[k]}{number(v)}" for k, v in target.items())
        other = " ".join(f"{'XYZ'[k]}{number(v - self.at[k])}" for k, v in target.items())
        return one, other

    def go(self, target: dict[int, float]) -> None:
        for k, v in target.items():
            self.at[k] = v

    def step(self) -> None:
        kind = self.rng.randrange(9)
        if kind <= 2:
            target = self.place()
            a, b = self.both(target)
            code = self.rng.choice(("G0", "G1"))
            self.write(f"{code} {a}", f"{code} {b}")
            self.go(target)
        elif kind <= 4:
            u, v, w = ("XYZ".index(letter) for letter in PLANES[self.plane])
            r = self.rng.randrange(32, 320) / 16
            end = {u: self.at[u] + r, v: self.at[v] + r}
            if self.rng.random() < 0.5:
                end[w] = self.number()
            a, b = self.both(end)
            code = self.rng.choice(("G2", "G3"))
            center = f"{'IJK'[u]}{number(r)}" if self.rng.random() < 0.5 else f"{'IJK'[v]}{number(r)}"
            if self.centers:
                middle = (r, 0.0) if self.rng.random() < 0.5 else (0.0, r)
                self.relative[len(self.lines)] = f"{'IJK'[u]}{number(middle[0])} {'IJK'[v]}{number(middle[1])}"
                places = (self.at[u] + middle[0], self.at[v] + middle[1])
                self.absolute[len(self.lines)] = f"{'IJK'[u]}{number(places[0])} {'IJK'[v]}{number(places[1])}"
                center = ""
            elif self.rng.random() < 0.4:
                center = f"R{number(self.rng.choice((1, -1)) * 2 * r)}"
            self.write(f"{code} {a} {center}", f"{code} {b} {center}")
            self.go(end)
        elif kind == 5:
            self.plane = self.rng.choice((17, 18, 19))
            self.write(f"G{self.plane}", f"G{self.plane}")
        elif kind == 6:
            self.cycle()
        elif kind == 7:
            target = self.place()
            text = " ".join(f"{'XYZ'[k]}{number(v)}" for k, v in target.items())
            self.write(f"G92 {text}", f"G92 {text}")
            self.go(target)
        else:
            target = self.place()
            a, b = self.both(target)
            self.write(f"G28 {a}", f"G28 {b}")
            self.write("G92 X0 Y0 Z0", "G92 X0 Y0 Z0")
            self.at = [0.0] * 3

    def cycle(self) -> None:
        u, v, w = ("XYZ".index(letter) for letter in PLANES[self.plane])
        target = {k: self.number() for k in (u, v)}
        r, depth = self.number(), self.rng.randrange(8, 200) / 16
        a, b = self.both(target)
        letter = "XYZ"[w]
        level = self.rng.choice((98, 99))
        code = self.rng.choice(("G81", "G83", "G73", "G85"))
        peck = "Q3" if code in ("G83", "G73") else ""
        self.write(
            f"{code} G{level} {a} R{number(r)} {letter}{number(r - depth)} {peck}",
            f"{code} G{level} {b} R{number(r - self.at[w])} {letter}{number(-depth)} {peck}",
        )
        self.go(target)
        self.at[w] = max(self.at[w], r) if level == 98 else r
        self.write("G80", "G80")


@seeds
def test_absolute_and_incremental(first: int, count: int, tmp_path: Path) -> None:
    """Each line in G90 or in G91 (3.4.22); G92 and the words of cycles as 3.4.23 and 3.4.21 say."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        walk = Walk(rng)
        for _ in range(rng.randrange(2, 9)):
            walk.step()
        head = "G21 G90 G17 G40 G49 G80 G94 G98 G69 G50 G54 F640\nG92 X0 Y0 Z0\n"
        texts = []
        for which in (0, 1, None):
            chosen = [rng.randrange(2) if which is None else which for _ in walk.lines]
            texts.append(head + "".join(f"G9{k}\n{pair[k]}\n" for k, pair in zip(chosen, walk.lines, strict=True)))
        job = random_setup(rng, Job(texts[0] + "M2\n", wide()))
        runs: list[Run] = [run(tmp_path, replace(job, program=text + "M2\n")) for text in texts]
        for other in runs[1:]:
            where = f"seed {seed}\n{texts[0]}---\n{other.job.program}"
            assert runs[0].clean, f"{where}\n{runs[0].told()}"
            assert not same_moves(runs[0], other), f"{same_moves(runs[0], other)}\n{where}"


# -- lines that do nothing

NOTHING: tuple[tuple[Tree, Tree], ...] = (
    ((words("G68 R0", X=3.0, Y=4.0),), (words("G69"),)),
    ((words("G68 R360", X=3.0, Y=4.0),), (words("G69"),)),
    ((words("G51 P1", I=3.0, J=-4.0),), (words("G50"),)),
    ((words("G51 X1 Y1", I=3.0, J=-4.0),), (words("G50"),)),
    ((words("G68 R180", X=3.0, Y=4.0), words("G51 P-1", I=3.0, J=4.0)), (words("G50"), words("G69"))),
    ((words("G51 X-1 Y-1", I=3.0, J=4.0), words("G68 R-180", X=3.0, Y=4.0)), (words("G50"), words("G69"))),
)
STANDING = (
    Raw("G92 X#5001 Y#5002 Z#5003"), Raw("G53 G0 X#5071 Y#5072 Z#5073"), Raw("G4 P0"), Raw("M8"),
    Raw("G61"), Raw("G64 P0.1"),
    Raw("#50 = 3"), Raw("gosub nothing"), Raw('msg "here"'), Raw("M3 S1000"),
    Raw("G10 L20 P8 X1"), Raw("G10 L2 P9 X1 Y2"),
)  # fmt: skip


@seeds
def test_lines_that_do_nothing(first: int, count: int, tmp_path: Path) -> None:
    """A rotation by no angle or a full turn, a factor of 1, half a turn back by a factor of −1; G92 of the place."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        maker = Maker(rng, Can(transforms=False, offsets=False, lengths=rng.random() < 0.3))
        groups: list[Tree] = []
        out: list[Statement] = []
        for _ in range(rng.randrange(2, 7)):
            maker.turned = True  # arcs and cycles stay in G17
            absolute = maker.absolute
            group = (*maker.statement(1), words("G17"))
            maker.plane = 17
            groups.append(group)
            kind = rng.randrange(3)
            fixed = [node for node in group if isinstance(node, Block) and node.kind == "side"]
            if kind == 0 and absolute and not fixed:
                on, off = rng.choice(NOTHING)
                group = (*on, *group, *off)
            elif kind == 1:
                group = (rng.choice(STANDING), *group)
            out += group
        head = words("G21 G90 G17 G40 G49 G80 G94 G98 G69 G50 G54", F=640.0)
        sub = "sub nothing\nendsub\n"
        one = render((head, *(node for group in groups for node in group))) + sub
        job = random_setup(rng, Job(one, wide()))
        other = replace(job, program=render((head, *out)) + sub)
        runs = run(tmp_path, job), run(tmp_path, other)
        where = f"seed {seed}\n{job.setup_text()}{job.program}---\n{other.program}{runs[1].told()}"
        assert runs[1].clean, where
        for name, span in runs[0].box.items():
            assert runs[1].box[name] == pytest.approx(span, abs=1e-9), where
        assert runs[0].verdict is runs[1].verdict is Verdict.SAFE, where
