"""A plain interpreter of McuWIN programs, written from the manual of 2.5.3.133 and from nothing else.

`read` walks a program with the facts of a machine and gives one `Walk` for each reading of what the manual leaves open.
Positions are machine coordinates, mm and degrees; numbers in the code are sections of the manual.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from .walked import Limits, NotRead, Point, Questions, Refused, Walk, every_reading, swept

INCH = 25.4
STEPS = 20_000
MODES = {17, 18, 19, 21, 22, 23, 24, 40, 70, 71, 90, 91, 94, 150, 161, 162}
CENTRES = {17: ("X", "Y", "I", "J"), 18: ("Z", "X", "K", "I"), 19: ("Y", "Z", "J", "K")}
SILENT_M = {0, 1, 3, 4, 5, 6, 8, 9, 26, 27, 80}


@dataclass
class Facts:
    """What is known of the machine and the moment. axes: in order; records: the zero offset table, by index from 0."""

    limits: Limits
    start: Point
    interpolated: str = "XYZ"
    offset: Point = field(default_factory=dict)
    records: list[Point] = field(default_factory=list)
    absolute_centres: bool = False
    degrees: bool = False
    tool_table: bool = False
    reals: dict[int, float] = field(default_factory=dict)
    wholes: dict[int, int] = field(default_factory=dict)


class Ended(Exception):
    """M02, M30."""


TOKEN = re.compile(
    r"\s*(?:(\d+\.?\d*|\.\d+)|([A-Za-z](?=C[DI]\d)|[A-Za-z_]+)|(:=|<=|>=|<>|[-+*/()=<>;.,%\[\]]))", re.IGNORECASE
)
FUNCTIONS = {"sin", "cos", "sqrt", "abs", "trunc", "round", "sqr"}


def tokens(text: str) -> list[str]:
    found, at = [], 0
    text = text.rstrip()
    while at < len(text):
        piece = TOKEN.match(text, at)
        if piece is None:
            raise NotRead(f"what is {text[at:]!r}")
        found.append(piece.group().strip())
        at = piece.end()
    return found


def without_comments(raw: str) -> str:
    """A DIN line without its comments: `'` to its end, round brackets where no expression is expected (6).

    A round bracket straight after a letter, an operation, a function or another bracket belongs to an expression.
    """
    pascal = raw.lstrip().lower()
    pascal = re.sub(r"^n\d+\s*", "", pascal)
    if pascal.startswith("$") or ":=" in raw:
        return re.sub(r"\{[^}]*\}", "", raw.split("//", maxsplit=1)[0].split("'", maxsplit=1)[0])
    out, at, depth = "", 0, 0
    while at < len(raw):
        sign = raw[at]
        if sign == "'":
            break
        if sign == "(" and depth == 0 and not re.search(r"[A-Za-z*/+-]\s*$", out):
            end = raw.find(")", at)
            if end < 0 or "(" in raw[at + 1 : end]:
                raise NotRead("a comment within a comment")
            at = end + 1
            continue
        depth += (sign == "(") - (sign == ")")
        out += sign
        at += 1
    return out


@dataclass
class Line:
    number: int
    text: str


def lines_of(program: str) -> list[Line]:
    found = []
    for number, raw in enumerate(program.splitlines(), start=1):
        text = re.sub(r"^\s*[Nn]\d+", "", without_comments(raw)).strip()
        if text:
            found.append(Line(number, text))
    return found


class Expression:
    """Reads values from the tokens of a line."""

    def __init__(self, pieces: list[str], run: Run) -> None:
        self.pieces, self.at, self.run = pieces, 0, run

    def peek(self, ahead: int = 0) -> str:
        place = self.at + ahead
        return self.pieces[place].lower() if place < len(self.pieces) else ""

    def take(self, *wanted: str) -> str:
        piece = self.peek()
        if piece and (not wanted or piece in wanted):
            self.at += 1
            return piece
        return ""

    def need(self, wanted: str) -> None:
        if not self.take(wanted):
            raise NotRead(f"{wanted!r} expected before {self.peek()!r}")

    def sum(self) -> float:
        value = self.product()
        while sign := self.take("+", "-"):
            other = self.product()
            value = value + other if sign == "+" else value - other
        return value

    def product(self) -> float:
        value = self.factor()
        while sign := self.take("*", "/", "div", "mod"):
            other = self.factor()
            if sign == "*":
                value = value * other
            elif other == 0:
                raise Refused("division by zero")
            elif sign == "/":
                value = value / other
            else:
                if value != int(value) or other != int(other):
                    raise NotRead(f"{sign} of broken numbers")
                one, two = int(value), int(other)
                quotient = abs(one) // abs(two) * (1 if (one < 0) == (two < 0) else -1)
                if sign == "mod" and (one < 0 or two < 0):
                    raise NotRead("mod of negatives")
                value = float(quotient if sign == "div" else one - two * quotient)
        return value

    def factor(self) -> float:
        if sign := self.take("+", "-"):
            value = self.factor()
            return -value if sign == "-" else value
        if self.take("("):
            value = self.sum()
            self.need(")")
            return value
        piece = self.take()
        if re.match(r"[\d.]", piece) and piece != ".":
            return float(piece)
        if piece in FUNCTIONS and self.peek() == "(":
            self.need("(")
            value = self.sum()
            self.need(")")
            return self.function(piece, value)
        if piece in {"cd", "ci"} and self.peek().isdigit():
            return self.run.common(piece, int(self.take()))
        if self.peek() == ".":
            raise NotRead("an axis qualifier")
        return self.run.named(piece)

    def function(self, name: str, value: float) -> float:
        angle = math.radians(value) if self.run.facts.degrees else value
        if name == "sqrt" and value < 0:
            raise Refused("root of a negative number")
        if name in {"trunc", "round"} and abs(value * 2 - round(value * 2)) < 1e-9 and value != round(value):
            raise NotRead("rounding at a border")
        return {
            "sin": lambda: math.sin(angle),
            "cos": lambda: math.cos(angle),
            "sqrt": lambda: math.sqrt(value),
            "abs": lambda: abs(value),
            "sqr": lambda: value * value,
            "trunc": lambda: float(math.trunc(value)),
            "round": lambda: float(round(value)),
        }[name]()

    def truth(self) -> bool:
        """A condition: comparisons joined by one kind of `and`, `or` between brackets (7)."""
        value = self.one_truth()
        while name := self.take("and", "or"):
            other = self.one_truth()
            value = (value and other) if name == "and" else (value or other)
        return value

    def one_truth(self) -> bool:
        if self.take("not"):
            return not self.one_truth()
        place = self.at
        if self.take("("):
            try:
                value = self.truth()
                self.need(")")
            except NotRead:
                self.at = place
            else:
                if self.peek() not in {"+", "-", "*", "/", "<", ">", "=", "<>", "<=", ">=", "div", "mod"}:
                    return value
                self.at = place
        a = self.sum()
        name = self.take("<", ">", "=", "<>", "<=", ">=")
        if not name:
            raise NotRead("no comparison")
        b = self.sum()
        if a != b and abs(a - b) < 1e-9 * max(1.0, abs(a), abs(b)):
            raise NotRead("nearly equal")
        return {"<": a < b, ">": a > b, "<=": a <= b, ">=": a >= b, "=": a == b, "<>": a != b}[name]


class Run:
    """One reading of one program."""

    def __init__(self, program: str, facts: Facts, questions: Questions) -> None:
        self.facts, self.pick = facts, questions.pick
        self.walk = Walk(dict(facts.start), dict(facts.limits))
        self.axes = list(facts.start)
        self.reals, self.wholes = dict(facts.reals), dict(facts.wholes)
        self.names: dict[str, float | None] = {}
        self.whole_names: set[str] = set()
        self.constants: set[str] = set()
        self.offset = {a: facts.offset.get(a, 0.0) for a in self.axes}
        self.relative = False
        self.inches = False
        self.plane = 17
        self.absolute_centres = facts.absolute_centres
        self.mirrored: set[str] = set()
        self.factors: dict[str, float] = {}
        self.old: set[str] = set()
        """Axes whose factor was set before a G24."""
        self.interpolated = set(facts.interpolated)
        self.named_axes = self.moved = False
        self.steps = 0
        self.loops: dict[int, tuple[float, float]] = {}
        self.lines = lines_of(self.declared(program))
        self.blocks()
        self.calls: list[tuple[int, int, int]] = []

    def declared(self, program: str) -> str:
        """Takes the Pascal declarations before the program (10, 12); their lines become empty."""
        begin = re.search(r"(?im)^\s*(?:N\d+\s*)?\$DINEND\s*$", program)
        if begin is None:
            return program
        end = re.search(r"(?i)\{\s*\$DINSTART\s*\}", program[begin.end() :])
        if end is None:
            raise NotRead("no DINSTART")
        text = program[begin.end() : begin.end() + end.start()]
        after = program[begin.end() + end.end() :]
        if re.search(r"(?i)\$DINEND", after) or program[: begin.start()].strip().strip("'"):
            raise NotRead("more Pascal")
        plain = re.sub(r"\{[^}]*\}", " ", re.sub(r"//.*", "", text))
        kind = ""
        for statement in plain.split(";"):
            words = statement.strip()
            if found := re.match(r"(?i)(var|const)\b", words):
                kind, words = found.group().lower(), words[found.end() :].strip()
            if not words:
                continue
            if kind == "const" and (found := re.fullmatch(r"(?s)([A-Za-z_]+)\s*=\s*(-?[\d.]+)", words)):
                self.names[found[1].lower()] = float(found[2])
                self.constants.add(found[1].lower())
            elif kind == "var" and (found := re.fullmatch(r"(?is)([A-Z_,\s]+):\s*(double|integer)", words)):
                for name in found[1].split(","):
                    self.names[name.strip().lower()] = None
                    if found[2].lower() == "integer":
                        self.whole_names.add(name.strip().lower())
            else:
                raise NotRead(f"declaration {words!r}")
        return "\n" * program[: begin.end() + end.end()].count("\n") + after

    # -- variables (11, 12)

    def common(self, kind: str, number: int) -> float:
        if not 600 <= number <= 699 and not (kind == "cd" and 50 <= number <= 57):
            raise NotRead("a variable of the system")
        table: Mapping[int, float] = self.reals if kind == "cd" else self.wholes
        if number not in table:
            raise NotRead(f"{kind}{number} is not known")
        return float(table[number])

    def named(self, name: str) -> float:
        value = self.names.get(name)
        if value is None:
            raise NotRead(f"{name} has no value")
        return value

    def assign(self, pieces: list[str], value: float) -> None:
        name = pieces[0].lower()
        whole = name == "ci" or name in self.whole_names
        if whole and value != int(value):
            raise NotRead("a broken number for a whole variable")
        if len(pieces) == 2 and name in {"cd", "ci"} and pieces[1].isdigit():
            if not 600 <= int(pieces[1]) <= 699:
                raise NotRead("a variable of the system")
            if name == "cd":
                self.reals[int(pieces[1])] = value
            else:
                self.wholes[int(pieces[1])] = int(value)
        elif len(pieces) == 1 and name in self.names and name not in self.constants:
            self.names[name] = value
        else:
            raise NotRead(f"assignment to {pieces}")

    # -- structure

    def blocks(self) -> None:
        """Which line ends each `$` block, which `else` follows, where labels and subprograms are."""
        self.end: dict[int, int] = {}
        self.begin: dict[int, int] = {}
        self.labels: dict[str, int] = {}
        self.deep: list[int] = []
        open_: list[int] = []
        for place, line in enumerate(self.lines):
            text = re.sub(r"\s+", " ", line.text.lower())
            self.deep.append(len(open_))
            if (found := re.fullmatch(r"l ?(\d+)", text)) or (found := re.fullmatch(r"%(\w+)", text)):
                self.label(found[1], place, open_)
            if text.startswith("$end"):
                if not open_:
                    raise NotRead("end without begin")
                begin = open_.pop()
                self.end[begin], self.begin[place] = place, begin
            if text.startswith("$") and re.search(r"\bbegin\b", text):
                open_.append(place)
        if open_:
            raise NotRead("begin without end")

    def label(self, name: str, place: int, open_: list[int]) -> None:
        if open_:
            raise NotRead("a label in a block")
        if name in self.labels:
            if self.lines[place - 1].text.lower() != f"%{name}" or self.labels[name] != place - 1:
                raise NotRead("a label twice")
            return
        self.labels[name] = place

    # -- the run

    def all(self) -> Walk:
        try:
            self.run()
        except Ended:
            pass
        except Refused as stop:
            self.walk.refused = f"line {self.walk.line}: {stop}"
        return self.walk

    def run(self) -> None:
        at = 0
        begun = False
        while True:
            self.steps += 1
            if self.steps > STEPS:
                raise NotRead("too many steps")
            if at >= len(self.lines):
                raise NotRead("the file ends without M30")
            line = self.lines[at]
            self.walk.line = line.number
            text = line.text
            if text.startswith("%"):
                if begun and at > 0:
                    raise NotRead("the program runs into another module")
                begun = True
                at += 1
                continue
            begun = True
            if re.fullmatch(r"(?i)l\s*\d+", text):
                at += 1
            elif text.startswith("$"):
                at = self.pascal(at, text[1:].strip())
            elif ":=" in text:
                self.assignment(text)
                at += 1
            else:
                at = self.din(at, text)

    def assignment(self, text: str) -> None:
        left, _, right = text.partition(":=")
        reader = Expression(tokens(right.rstrip().rstrip(";")), self)
        value = reader.sum()
        if reader.peek():
            raise NotRead("words after an assignment")
        self.assign(tokens(left), value)

    def pascal(self, at: int, text: str) -> int:
        """The line to go on with after a `$` line (7, 8)."""
        reader = Expression(tokens(text.rstrip().rstrip(";")), self)
        word = reader.take()
        if word == "if":
            return self.branch(at, reader)
        if word == "end":
            return self.closed(at, reader)
        if word == "while":
            return at + 1 if self.asked(reader, "do") else self.end[at] + 1
        if word == "repeat":
            return at + 1
        if word == "for":
            return self.counted(at, reader)
        if ":=" in text:
            self.assignment(text)
            return at + 1
        raise NotRead(f"${text}")

    def asked(self, reader: Expression, then: str) -> bool:
        value = reader.truth()
        if not reader.take(then) and then != "then":
            raise NotRead(f"{then} missing")
        reader.need("begin")
        return value

    def branch(self, at: int, reader: Expression) -> int:
        """Into the block, or to the `else` that follows it."""
        if self.asked(reader, "then"):
            return at + 1
        end = self.end[at]
        other = Expression(tokens(self.lines[end].text[1:].rstrip().rstrip(";")), self)
        other.need("end")
        if not other.peek():
            return end + 1
        other.need("else")
        if other.take("if"):
            return self.branch(end, other)
        other.need("begin")
        return end + 1

    def closed(self, at: int, reader: Expression) -> int:
        """After the end of a block that ran."""
        head = Expression(tokens(self.lines[self.begin[at]].text[1:].rstrip().rstrip(";")), self).take()
        if head == "while":
            return self.begin[at]
        if head == "repeat":
            reader.need("until")
            return at + 1 if reader.truth() else self.begin[at] + 1
        if head == "for":
            return self.begin[at]
        # a branch that ran: past every `else` that follows
        while re.search(r"(?i)\belse\b", self.lines[at].text):
            at = self.end[at]
        return at + 1

    def counted(self, at: int, reader: Expression) -> int:
        """`for`: bounds are taken once, as in Pascal (8.3)."""
        name = [reader.pieces[reader.at]]
        reader.take()
        if name[0].lower() in {"ci", "cd"}:
            name.append(reader.take())
        if name[0].lower() != "ci" and name[0].lower() not in self.whole_names:
            raise NotRead("a variable of a for that is not whole")
        reader.need(":=")
        first = reader.sum()
        down = reader.take("to", "downto") == "downto"
        last = reader.sum()
        step = -1.0 if down else 1.0
        if at in self.loops:
            value, last = self.loops[at]
            value += step
        else:
            value = first
        if (value < last) if down else (value > last):
            self.loops.pop(at, None)
            self.forget(name)
            return self.end[at] + 1
        self.loops[at] = (value, last)
        self.assign(name, value)
        return at + 1

    def forget(self, name: list[str]) -> None:
        """After the loop its variable holds nothing stated."""
        if len(name) == 2:
            self.wholes.pop(int(name[1]), None)
        else:
            self.names[name[0].lower()] = None

    # -- a DIN line

    def din(self, at: int, text: str) -> int:
        reader = Expression(tokens(text), self)
        code: int | None = None
        words: dict[str, float] = {}
        named: list[str] = []
        while reader.peek():
            letter = reader.take()
            if letter == "g":
                number = int(reader.sum())
                if number in MODES:
                    if words:
                        raise NotRead("a mode after words")
                    self.mode(number)
                    code = -1 if code is None else code
                    continue
                if code is not None and code >= 0:
                    raise NotRead("two G codes")
                code = number
                if code == 4:
                    reader.sum()
            elif letter == "m":
                if code is not None or words:
                    raise NotRead("M beside G")
                return self.m_code(at, reader)
            elif letter in {"f", "s", "t", "d"} and (letter != "d" or code != 51):
                value = reader.sum()
                if letter == "t" and not self.facts.tool_table and value != 0:
                    raise NotRead("T without a table")
            elif len(letter) == 1 and (letter.upper() in self.axes or letter in "ijk"):
                if letter.upper() in words or letter.upper() in named:
                    raise NotRead("a word twice")
                if not reader.peek() or (
                    reader.peek().isalpha() and reader.peek() not in FUNCTIONS | {"cd", "ci"} | self.names.keys()
                ):
                    named.append(letter.upper())
                else:
                    words[letter.upper()] = reader.sum()
            else:
                raise NotRead(f"what is {letter!r}")
        self.command(at, code, words, named)
        return at + 1

    def command(self, at: int, code: int | None, words: dict[str, float], named: list[str]) -> None:
        if code == 60:
            if words or not named:
                raise NotRead("G60")
            if (self.named_axes or self.moved) and self.pick("a second G60: where it runs, not at all"):
                return
            self.interpolated, self.named_axes = set(named), True
            return
        if named:
            raise NotRead("an axis without a value")
        if (code is None or code == -1) and words:
            kept = self.kept(at, own=code == -1)
            if kept is None:
                raise Refused("axis words without a command")
            code = kept
        if code is None or code in {-1, 4}:
            if words:
                raise NotRead("words for nothing")
        elif code in {0, 1, 2, 3}:
            self.move(code, words)
        elif code == 53:
            self.zeroed(words)
        elif 54 <= code <= 58:
            self.record(code - 54, words)
        elif code == 92:
            self.set_offset(words)
        elif code == 39:
            self.factor(words)
        elif code in {98, 99}:
            self.limit(code, words)
        elif code == 153 and not words:
            if self.inches:
                raise NotRead("G153 in inch")
            self.reals.update({50 + n: self.offset[a] for n, a in enumerate(self.axes)})
        elif code == 154 and not words:
            if self.inches or any(50 + n not in self.reals for n in range(len(self.axes))):
                raise NotRead("G154")
            self.offset = {a: self.reals[50 + n] for n, a in enumerate(self.axes)}
        else:
            raise NotRead(f"G{code}")

    def kept(self, at: int, *, own: bool) -> int | None:
        """The motion that a line of bare words repeats: the last command in the text before it (3.1)."""
        others = own
        for place in range(at - 1, -1, -1):
            text = self.lines[place].text.upper()
            if text.startswith("%"):
                return None
            found = re.findall(r"(?<![A-Z])G\s*(\d+)", text) if not text.startswith("$") and ":=" not in text else []
            codes = [int(n) for n in found]
            if 4 in codes:
                return None
            motions = [n for n in codes if n in {0, 1, 2, 3}]
            if motions:
                if others and self.pick("a mode between: the motion is kept, or none is"):
                    return None
                return motions[-1]
            if any(n not in MODES for n in codes):
                raise NotRead("bare words after another command")
            if codes or text.startswith("$"):
                others = True
        return None

    def mode(self, number: int) -> None:
        if number in {17, 18, 19}:
            self.plane = number
        elif number in {21, 22, 23}:
            if self.old and self.pick("factors after G24: kept or -1"):
                self.factors = {a: f for a, f in self.factors.items() if a not in self.old}
            self.old = set()
            self.mirrored |= {21: {"Y"}, 22: {"X"}, 23: {"X", "Y"}}[number]
        elif number == 24:
            self.mirrored, self.old = set(), set(self.factors)
        elif number in {70, 71}:
            self.inches = number == 70
        elif number in {90, 91}:
            self.relative = number == 91
        elif number in {161, 162}:
            self.absolute_centres = number == 161

    def m_code(self, at: int, reader: Expression) -> int:
        number = int(reader.sum()) if reader.peek().isdigit() else -1
        if number in {2, 30}:
            raise Ended
        if number == 17:
            if not self.calls:
                raise NotRead("M17 without a call")
            place, left, back = self.calls.pop()
            if left > 1:
                self.calls.append((place, left - 1, back))
                return place + 1
            return back
        if number in {96, 98}:
            reader.need("l")
            label = reader.take()
            if label not in self.labels:
                raise Refused(f"no label {label}")
            times = 1
            if number == 98 and reader.take("o"):
                count = reader.sum()
                if count != int(count) or count < 0:
                    raise NotRead("O")
                times = int(count)
                if times == 0:
                    raise NotRead("O0")
            if reader.peek():
                raise NotRead("words after a jump")
            if number == 96:
                if self.deep[at]:
                    raise NotRead("a jump out of a block")
                return self.labels[label] + 1
            if len(self.calls) > 8:
                raise NotRead("nested calls")
            self.calls.append((self.labels[label], times, at + 1))
            return self.labels[label] + 1
        if number not in SILENT_M:
            raise NotRead(f"M{number}")
        return at + 1

    # -- offsets (3.18, 3.19, 3.26)

    def place(self, axis: str, value: float, *, inch: bool) -> float:
        """A programmed number of an axis, mm in the offset's coordinates, absolute."""
        size = INCH if inch and axis in "XYZIJK" else 1.0
        factor = self.factors.get(axis, -1.0) if axis in self.mirrored else 1.0
        if self.relative:
            return self.walk.at[axis] - self.offset[axis] + factor * size * value
        about = factor * size * value
        matters = factor != 1.0 and self.offset[axis]
        if matters and self.pick("reflection about the offset zero or the machine zero"):
            about += (factor - 1.0) * self.offset[axis]
        return about

    def zeroed(self, words: dict[str, float]) -> None:
        if words:
            raise NotRead("G53 with words")
        for axis in self.interpolated:
            self.offset[axis] = 0.0
        if self.relative:
            self.relative = bool(self.pick("after G53 in G91: G90, G91"))

    def record(self, number: int, words: dict[str, float]) -> None:
        if words or number >= len(self.facts.records):
            raise NotRead("a record that is not known")
        for axis in self.interpolated:
            if axis not in self.facts.records[number]:
                raise NotRead("a record without the axis")
            self.offset[axis] = self.facts.records[number][axis]

    def set_offset(self, words: dict[str, float]) -> None:
        if not words or any(a in words for a in "IJK"):
            raise NotRead("G92")
        for axis, value in words.items():
            size = 1.0
            if self.inches and axis in "XYZ":
                size = (1.0, INCH)[self.pick("G92 under G70: axis unit or inch")]
            self.offset[axis] = value * size + (self.offset[axis] if self.relative else 0.0)

    def factor(self, words: dict[str, float]) -> None:
        if not words:
            self.factors, self.old = {}, set()
        for axis, value in words.items():
            if axis not in self.axes:
                raise NotRead("G39")
            self.factors[axis] = value
            self.old.discard(axis)

    def limit(self, code: int, words: dict[str, float]) -> None:
        """A software limit is put elsewhere (3.29)."""
        if not words or self.inches or any(a not in self.axes for a in words):
            raise NotRead("G98, G99")
        limits = dict(self.walk.limits)
        for axis, value in words.items():
            if self.relative or axis in self.mirrored:
                raise NotRead("limits in distances or reflected")
            if self.offset[axis]:
                value += self.offset[axis] * self.pick("limits by G98, G99: of the machine, of the program")
            low, high = limits.get(axis, (None, None))
            limits[axis] = (value, high) if code == 98 else (low, value)
        self.walk.limits = limits
        self.walk.visit(dict(self.walk.at))  # what stands outside of them is detected (13.1.1.7)

    # -- moves (3.1 to 3.4)

    def move(self, code: int, words: dict[str, float]) -> None:
        named = [a for a in words if a in self.axes]
        self.moved = True
        if code == 0:
            if len(named) < len(words) or not named:
                raise NotRead("G00 with other words, or none")
            self.walk.go({a: self.place(a, words[a], inch=False) + self.offset[a] for a in named})
            return
        if any(a not in self.interpolated for a in named):
            raise Refused("an axis that is not interpolated")
        if code == 1 and (len(named) < len(words) or not named):
            raise NotRead("G01 with other words, or none")
        end = {a: self.place(a, words[a], inch=self.inches) + self.offset[a] for a in named}
        if code == 1:
            self.walk.go(end)
        else:
            self.arc(end, words, clockwise=code == 2)

    def arc(self, end: Point, words: dict[str, float], *, clockwise: bool) -> None:
        if self.plane != 17 and not self.facts.tool_table:
            raise NotRead("planes without a table")
        one, two, first, second = CENTRES[self.plane]
        if any(n in words and n not in {first, second} for n in "IJK"):
            raise NotRead("centre words of another plane")
        if first not in words or second not in words:
            raise NotRead("a centre with one word")
        factor = {a: self.factors.get(a, -1.0) if a in self.mirrored else 1.0 for a in (one, two)}
        if abs(factor[one]) != abs(factor[two]):
            raise NotRead("unequal factors on an arc")
        size = INCH if self.inches else 1.0
        at = self.walk.at
        if self.absolute_centres and not self.relative:
            centre = tuple(
                self.place(a, words[n], inch=self.inches) + self.offset[a] for a, n in ((one, first), (two, second))
            )
        else:
            centre = tuple(at[a] + factor[a] * size * words[n] for a, n in ((one, first), (two, second)))
        if factor[one] * factor[two] < 0:
            clockwise = not clockwise
        begin = (at[one], at[two])
        finish = (end.get(one, at[one]), end.get(two, at[two]))
        apart = abs(math.dist(begin, centre) - math.dist(finish, centre))
        if apart > 0.05:
            raise Refused("centre")
        if apart > 1e-4 or math.dist(begin, centre) < 1e-6 or 0 < math.dist(begin, finish) < 1e-3:
            raise NotRead("an arc at a border")
        angle = swept(begin, finish, (centre[0], centre[1]), clockwise=clockwise)
        self.walk.turn((one, two), (centre[0], centre[1]), angle, end)


def read(program: str, facts: Facts, settled: Mapping[str, int] | None = None) -> Iterator[Walk]:
    """Every reading of a program: `NotRead` where this interpreter makes no statement."""
    return every_reading(lambda questions: Run(program, facts, questions).all(), settled)
