"""Random programs as trees that can be rewritten, and the rewriters of the metamorphic tests.

A program here is a list of statements; ``render`` prints one. Numbers are multiples of 1/16, so that sums, halves and
quarter turns are exact and two spellings of a program can be compared bit for bit. Nothing here knows what a
program does: what must stay the same follows from the manual's rules, each named in the test that uses it.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

LENGTHS = frozenset("XYZIJKRQF")
PLANES = {17: "XYZ", 18: "ZXY", 19: "YZX"}
"""The right-handed pair of a plane and the axis across it."""
CENTER = {"X": "I", "Y": "J", "Z": "K"}
SYSTEMS = (54, 55, 56)


@dataclass(frozen=True)
class Word:
    """A letter and its number; text: another spelling of the number; counter: times a loop's counter, added."""

    letter: str
    value: float
    text: str = ""
    counter: int = 0
    plain: bool = False  # no length, whatever its letter


@dataclass(frozen=True)
class Block:
    """A line of words. parts: the same move in several lines; kind: what sort of line it is."""

    words: tuple[Word, ...]
    kind: str = ""
    parts: tuple[Block, ...] = ()
    deleted: bool = False


@dataclass(frozen=True)
class Raw:
    """A line of text."""

    text: str


@dataclass(frozen=True)
class Loop:
    """A while loop; ``counter`` is the number of its variable, which runs from 1 to ``times``."""

    times: int
    counter: int
    body: tuple[Statement, ...]


@dataclass(frozen=True)
class Call:
    """A call of a subprogram."""

    name: str
    body: tuple[Statement, ...]


@dataclass(frozen=True)
class Branch:
    """Statements under a condition; then a second list."""

    condition: str
    then: tuple[Statement, ...]
    otherwise: tuple[Statement, ...] = ()


Statement = Block | Raw | Loop | Call | Branch
Tree = tuple[Statement, ...]


def number(value: float) -> str:
    return f"{value:.10f}".rstrip("0").rstrip(".") if value != 0 else "0"


def words(text: str, kind: str = "", **values: float) -> Block:
    """A block from codes such as ``G1 G90`` and further words."""
    made = [Word(code[0], float(code[1:]), plain=True) for code in text.split()]
    return Block((*made, *(Word(letter, value) for letter, value in values.items())), kind)


def print_block(block: Block, spell: Callable[[Word], str]) -> str:
    text = " ".join(f"{word.letter}{spell(word)}" for word in block.words)
    return ("/" if block.deleted else "") + text


def spell_plain(word: Word) -> str:
    if word.counter:
        return f"[{word.text or number(word.value)} + #{word.counter} * {number(COUNTED)}]"
    return word.text or number(word.value)


COUNTED = 0.5
"""What a loop's counter adds for each round to the words that count it."""


def render(tree: Tree, spell: Callable[[Word], str] = spell_plain) -> str:
    """The text of a program; subprograms behind its end."""
    subs: dict[str, Tree] = {}
    lines = list(_lines(tree, spell, subs))
    lines.append("M2")
    done: set[str] = set()
    while subs.keys() - done:
        for name in sorted(subs.keys() - done):
            done.add(name)
            lines += [f"sub {name}", *_lines(subs[name], spell, subs), "endsub"]
    return "\n".join(lines) + "\n"


def _lines(tree: Tree, spell: Callable[[Word], str], subs: dict[str, Tree]) -> Iterator[str]:
    for node in tree:
        match node:
            case Block():
                yield print_block(node, spell)
            case Raw():
                yield node.text
            case Call():
                subs[node.name] = node.body
                yield f"gosub {node.name}"
            case Branch():
                yield f"if [{node.condition}]"
                yield from _lines(node.then, spell, subs)
                if node.otherwise:
                    yield "else"
                    yield from _lines(node.otherwise, spell, subs)
                yield "endif"
            case Loop():
                yield f"#{node.counter} = 0"
                yield f"while [#{node.counter} < {node.times}]"
                yield f"#{node.counter} = [#{node.counter} + 1]"
                yield from _lines(node.body, spell, subs)
                yield "endwhile"


# -- rewriting


def rewrite(tree: Tree, change: Callable[[Statement], Tree]) -> Tree:
    """Every statement, innermost first, replaced by what ``change`` makes of it."""
    out: list[Statement] = []
    for node in tree:
        match node:
            case Loop() | Call():
                node = replace(node, body=rewrite(node.body, change))
            case Branch():
                node = replace(node, then=rewrite(node.then, change), otherwise=rewrite(node.otherwise, change))
        out += change(node)
    return tuple(out)


def rewrite_blocks(tree: Tree, change: Callable[[Block], Tree]) -> Tree:
    return rewrite(tree, lambda node: change(node) if isinstance(node, Block) else (node,))


def unrolled(tree: Tree) -> Tree:
    """Loops as the copies of their bodies, the counter's share put into the numbers."""

    def copies(node: Statement) -> Tree:
        if not isinstance(node, Loop):
            return (node,)
        out: list[Statement] = []
        for turn in range(1, node.times + 1):
            out += rewrite_blocks(node.body, lambda block, turn=turn: (_counted(block, node.counter, turn),))
        return tuple(out)

    # Subprograms that count with a loop of their caller can not stand for all rounds at once.
    return rewrite(inlined(tree), copies)


def _counted(block: Block, counter: int, turn: int) -> Block:
    def put(word: Word) -> Word:
        if word.counter != counter:
            return word
        return replace(word, value=word.value + turn * COUNTED, counter=0)

    return replace(
        block,
        words=tuple(put(word) for word in block.words),
        parts=tuple(_counted(p, counter, turn) for p in block.parts),
    )


def inlined(tree: Tree) -> Tree:
    """Calls as the bodies of what they call."""
    return rewrite(tree, lambda node: node.body if isinstance(node, Call) else (node,))


def split(tree: Tree) -> Tree:
    """Moves that name their parts as these parts."""
    return rewrite_blocks(tree, lambda block: block.parts or (block,))


def respelled(rng: random.Random) -> Callable[[Word], str]:
    """Numbers as expressions, functions and variables of the same value; ``#90`` to ``#97`` hold 0 to 7 halves."""

    def spell(word: Word) -> str:
        plain = spell_plain(word)
        if word.text or word.counter:
            return plain
        v = word.value
        part = rng.randrange(-64, 64) / 8
        held = rng.randrange(8)
        return rng.choice([
            plain, f"[{number(v - part)} + {number(part)}]", f"[{number(v * 4)} / 4]", f"[[{number(v / 2)}] * 2]",
            f"[#{90 + held} + {number(v - held / 2)}]", f"[0 - {number(-v)}]", f"[{number(v)} ** 1]",
            f"[#[90 + {held}] * 1 - {number(held / 2 - v)}]", f"[{number(v)} * [1 == 1]]",
        ])  # fmt: skip

    return spell


HELD = tuple(Raw(f"#{90 + n} = {n / 2}") for n in range(8))


# -- random programs


@dataclass
class Can:
    """What a program may hold."""

    arcs: bool = True
    cycles: bool = True
    planes: bool = True
    offsets: bool = True
    parks: bool = True
    machine: bool = True
    transforms: bool = True
    contours: bool = True
    lengths: bool = True
    rotary: bool = True
    structure: bool = True
    units: bool = False
    deleted: bool = False
    no_cycle_along: str = ""
    counters: bool = True


@dataclass
class Maker:
    """Makes one program. ``size``: how far moves go at most, in 1/16."""

    rng: random.Random
    can: Can = field(default_factory=Can)
    size: int = 30 * 16
    plane: int = 17
    absolute: bool = True
    inch: bool = False
    turned: bool = False
    unequal: bool = False
    counters: list[int] = field(default_factory=list)
    made: int = 0
    system: int = 54

    def length(self, most: int | None = None) -> float:
        most = self.size if most is None else most
        value = self.rng.randrange(-most, most + 1) / 16
        return value / 16 if self.inch else value

    def positive(self, least: int, most: int) -> float:
        value = self.rng.randrange(least, most) / 16
        return value / 16 if self.inch else value

    def program(self, statements: int) -> Tree:
        head = words("G21 G90 G17 G40 G49 G80 G94 G98 G69 G50 G54", F=640.0)
        return (head, *self.body(statements, depth=2))

    def body(self, statements: int, depth: int) -> Tree:
        out: list[Statement] = []
        for _ in range(statements):
            out += self.statement(depth)
        return tuple(out)

    def neutral(self, statements: int, depth: int) -> Tree:
        """A body that leaves plane, distance mode and units as they were."""
        before = self.plane, self.absolute, self.inch
        made = self.body(statements, depth)
        back = [f"G{self.plane}" for self.plane in (before[0],) if self.can.planes]
        self.plane, self.absolute, self.inch = before
        back.append("G90" if self.absolute else "G91")
        if self.can.units:
            back.append("G20" if self.inch else "G21")
        return (*made, words(" ".join(back)))

    def statement(self, depth: int) -> Tree:
        rng, can = self.rng, self.can
        choices: list[Callable[[], Tree]] = [self.line] * 5
        flat = not self.turned or self.plane == 17
        choices += [self.arc] * 5 if can.arcs and flat and not self.unequal else []
        drill = PLANES[self.plane][2]
        choices += [self.cycle] if can.cycles and flat and drill != can.no_cycle_along else []
        choices += [self.distance]
        choices += [self.choose_plane] if can.planes else []
        choices += [self.offset] if can.offsets and not self.turned else []
        choices += [self.park] if can.parks and not can.units else []  # their unit is open (3.4.8)
        choices += [self.in_machine] if can.machine else []
        choices += [self.tool_length] if can.lengths else []
        choices += [self.change_units] if can.units and not self.turned else []
        choices += [self.guard]
        if depth:
            choices += [lambda: self.transform(depth)] if can.transforms and not self.turned else []
            choices += [self.contour] if can.contours and not self.unequal else []
            if can.structure:
                choices += [lambda: self.loop(depth), lambda: self.call(depth), lambda: self.branch(depth)]
        made = rng.choice(choices)()
        if can.deleted and rng.random() < 0.2 and all(isinstance(node, Block) for node in made):
            made = tuple(replace(node, deleted=True) for node in made if isinstance(node, Block))
        return made

    def axis_words(self, axes: str) -> tuple[Word, ...]:
        counted = [c for c in self.counters if self.can.counters and self.rng.random() < 0.5]
        return tuple(
            Word(letter, self.length(), counter=self.rng.choice(counted) if counted and letter in "XYZ" else 0)
            for letter in axes
        )

    def some(self, letters: str) -> str:
        chosen = [letter for letter in letters if self.rng.random() < 0.5]
        return "".join(chosen or [self.rng.choice(letters)])

    def line(self) -> Tree:
        letters = self.some("XYZ") + ("A" if self.can.rotary and self.rng.random() < 0.1 else "")
        code = self.rng.choice("01")
        block = Block((Word("G", float(code), plain=True), *self.axis_words(letters)), "line")
        if not self.absolute and not any(word.counter for word in block.words):
            halves = tuple(w if w.letter == "G" else replace(w, value=w.value / 2) for w in block.words)
            block = replace(block, parts=(Block(halves, "line"), Block(halves, "line")))
        return (block,)

    def arc(self) -> Tree:
        """A quarter, half or whole turn, or one by its radius, in increments; helical now and then."""
        rng = self.rng
        u, v, w = PLANES[self.plane]
        ccw = rng.random() < 0.5
        code = words("G3" if ccw else "G2").words
        r = self.positive(32, 320)
        sign = rng.choice((1, -1))
        # Start at an extreme: the centre lies r from it along the pair's first or second axis.
        start = rng.randrange(4)
        rise = self.length(64) * 4 if rng.random() < 0.4 else 0.0

        def turn(begin: int, quarters: int, share: float) -> Block:
            at = [(-1, 0), (0, -1), (1, 0), (0, 1)]  # from the centre to the point, by quarter
            a = at[begin % 4]
            b = at[(begin + (quarters if ccw else -quarters)) % 4]
            ends = (Word(u, r * (b[0] - a[0])), Word(v, r * (b[1] - a[1])))
            middle = (Word(CENTER[u], -r * a[0]), Word(CENTER[v], -r * a[1]))
            third = (Word(w, rise * share),) if rise else ()
            return Block((*code, *ends, *third, *middle), "arc")

        kind = rng.randrange(4)
        if kind < 3:
            quarters = (1, 2, 4)[kind]
            step = 1 if ccw else -1
            parts = tuple(turn(start + k * step, 1, 1 / quarters) for k in range(quarters))
            block = replace(turn(start, quarters, 1.0), parts=parts if quarters > 1 else ())
        else:
            # 3-4-5: half the chord is 0.6 of the radius.
            chord = (1.2 * 5 * sign, 0.0) if rng.random() < 0.5 else (0.0, 1.2 * 5 * sign)
            scale = self.positive(16, 64)
            ends = (Word(u, chord[0] * scale), Word(v, chord[1] * scale))
            third = (Word(w, rise),) if rise else ()
            block = Block((*code, *ends, *third, Word("R", rng.choice((5.0, -5.0)) * scale)), "arc")
        if self.absolute:
            return (words("G91"), block, words("G90"))
        return (block,)

    def cycle(self) -> Tree:
        rng = self.rng
        u, v, w = PLANES[self.plane]
        code = rng.choice((81, 82, 83, 73, 85, 89))
        depth, r = self.positive(8, 200), self.length(160)
        level = rng.choice((98, 99))
        made = [Word("R", r), Word(w, r - depth if self.absolute else -depth)]
        if code in (83, 73):
            made.append(Word("Q", self.positive(24, 90)))
        if code in (82, 89):
            made.append(Word("P", 0.5, plain=True))
        if rng.random() < 0.4:
            made.append(Word("L", float(rng.randrange(1, 4)), plain=True))
        first = Block((*words(f"G{code} G{level}").words, *self.axis_words(self.some(u + v)), *made), "cycle")
        out: list[Statement] = [first]
        if rng.random() < 0.4:
            out.append(Block(self.axis_words(self.some(u + v)), "cycle"))
        return (*out, words("G80"))

    def distance(self) -> Tree:
        self.absolute = not self.absolute
        return (words("G90" if self.absolute else "G91"),)

    def choose_plane(self) -> Tree:
        self.plane = self.rng.choice((17, 18, 19))
        return (words(f"G{self.plane}"),)

    def change_units(self) -> Tree:
        self.inch = not self.inch
        return (words("G20" if self.inch else "G21"), words("", F=32.0 if self.inch else 640.0))

    def offset(self) -> Tree:
        rng = self.rng
        kind = rng.randrange(6)
        axes = Block(self.axis_words(self.some("XYZ")))
        if kind == 0:
            return (replace(axes, words=(*words("G92").words, *axes.words), kind="g92"),)
        if kind == 1:
            return (words(rng.choice(("G92.1", "G92.2", "G92.3"))),)
        if kind in (2, 3):
            key = rng.choice((2, 20))
            code = words(f"G10 L{key} P{rng.randrange(1, 4)}").words
            return (replace(axes, words=(*code, *axes.words), kind=f"g10l{key}"),)
        self.system = rng.choice(SYSTEMS)
        return (words(f"G{self.system}"),)

    def park(self) -> Tree:
        via = self.axis_words(self.some("XYZ")) if self.rng.random() < 0.6 else ()
        return (Block((*words(self.rng.choice(("G28", "G30"))).words, *via), "park"),)

    def in_machine(self) -> Tree:
        code = self.rng.choice(("G53 G0", "G53 G1"))
        plain = tuple(replace(word, counter=0) for word in self.axis_words(self.some("XYZ")))
        return (Block((*words(code).words, *plain), "machine"),)

    def tool_length(self) -> Tree:
        rng = self.rng
        kind = rng.randrange(5)
        tool = rng.randrange(1, 4)
        if kind == 0 and not self.inch:
            return (Raw(f"#540{tool} = {self.length()}"), words(f"G43 H{tool}"))
        if kind == 1:
            return (words("G49"),)
        if kind == 2 and not self.turned:
            return (words("G43.1", K=self.length()),)
        if kind == 3:
            return (words(f"T{tool} M6"), words("G43"))
        return (words(f"G43 H{tool}"),)

    def guard(self) -> Tree:
        return (Raw(f"TCAGuard {self.rng.choice(('on', 'on', 'off'))}"),)

    def transform(self, depth: int) -> Tree:
        rng = self.rng
        kind = rng.randrange(4)
        back = () if self.absolute else (words("G91"),)
        front = () if self.absolute else (words("G90"),)
        on: Block = words(
            "G68", "g68", R=rng.choice((90.0, 180.0, 270.0, -90.0, 30.0)), X=self.length(), Y=self.length()
        )
        off = words("G69")
        if kind == 1:
            # With P it is open whether Z is scaled too.
            factor = rng.choice((2.0, 0.5, -1.0))
            both = (Word("X", factor, plain=True), Word("Y", factor, plain=True))
            on, off = (
                Block((*words("G51").words, *both, Word("I", self.length()), Word("J", self.length())), "g51"),
                words("G50"),
            )
        if kind == 2:
            x, y = (Word(a, rng.choice((2.0, 0.5, -1.0, 1.0)), plain=True) for a in "XY")
            self.unequal = x.value != y.value
            middle = (Word("I", self.length()), Word("J", self.length()))
            on, off = Block((*words("G51").words, x, y, *middle), "g51"), words("G50")
        on = replace(on, words=tuple(replace(w, plain=True) if w.letter == "R" else w for w in on.words))
        self.turned = True
        body = self.neutral(rng.randrange(1, 4), depth - 1)
        self.turned = self.unequal = False
        return (*front, on, *back, *body, off)

    def contour(self) -> Tree:
        """Around a box by its outside, with the radius of the cutter compensated; only in G17, in increments."""
        rng = self.rng
        code, turn = rng.choice((("G41.1", -1), ("G42.1", 1)))
        diameter = Word("D", self.positive(16, 96))
        entry, a, b = self.positive(160, 320), self.positive(160, 480), self.positive(160, 480)
        steps = [(entry + a, 0.0), (0.0, turn * b), (-a, 0.0), (0.0, -turn * b)]
        out: list[Statement] = [words("G17 G91")] if self.plane != 17 else [words("G91")]
        out.append(Block((*words(code).words, diameter), "side"))
        for k, (x, y) in enumerate(steps):
            letters = (Word("X", x),) if x else (Word("Y", y),)
            block = Block((*words("G1").words, *letters), "line")
            if k:
                half = replace(
                    block, words=tuple(w if w.letter == "G" else replace(w, value=w.value / 2) for w in block.words)
                )
                block = replace(block, parts=(half, half))
            out.append(block)
        out.append(words("G40"))
        back = [f"G{self.plane}"] if self.plane != 17 else []
        back.append("G90" if self.absolute else "G91")
        return (*out, words(" ".join(back)))

    def loop(self, depth: int) -> Tree:
        self.made += 1
        counter = 30 + self.made
        self.counters.append(counter)
        body = self.neutral(self.rng.randrange(1, 4), depth - 1)
        self.counters.remove(counter)
        return (Loop(self.rng.randrange(1, 4), counter, body),)

    def call(self, depth: int) -> Tree:
        self.made += 1
        counters, self.counters = self.counters, []
        name = f"part_{self.made}"
        body = self.neutral(self.rng.randrange(1, 4), depth - 1)
        self.counters = counters
        return (Call(name, body),) * self.rng.randrange(1, 3)

    def branch(self, depth: int) -> Tree:
        truth = self.rng.random() < 0.5
        one, other = self.neutral(1, depth - 1), self.neutral(1, depth - 1)
        condition = self.rng.choice(("1 < 2", "[3 * 2] == 6") if truth else ("1 > 2", "[3 * 2] <> 6"))
        return (Branch(condition, one, other),)
