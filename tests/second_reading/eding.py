"""A plain interpreter of Eding CNC programs, written from its manual (4.01, chapters 3 and 4) and from nothing else.

`read` walks a program with the facts of a machine and a setup and gives one `Walk` for each reading of what the manual
leaves open. Positions are machine coordinates, mm and degrees; numbers in the code are sections of the manual.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from .walked import Limits, NotRead, Point, Questions, Refused, Walk, centre_of, every_reading, swept

HEIGHTS = "G51 P: X and Y, or Z too"
INCH = 25.4
LINEAR = "XYZ"
AXES = "XYZABC"
MOTIONS = {0, 10, 20, 30, 730, 800, 810, 820, 830, 850, 860, 870, 880, 890}
GROUPS: list[set[int]] = [  # 3.3, table 3-3; codes times ten
    MOTIONS | {330, 331, 382, 740, 760, 840},
    {170, 180, 190},
    {900, 910},
    {930, 940, 950},
    {200, 210, 700, 710},
    {400, 410, 420, 411, 421},
    {430, 431, 490},
    {980, 990},
    {540, 550, 560, 570, 580, 590, 591, 592, 593},
    {610, 611, 640},
    {680, 690},
    {500, 510},
    {40, 100, 280, 300, 530, 920, 921, 922, 923},
]
SYSTEMS = {code: n for n, code in enumerate((540, 550, 560, 570, 580, 590, 591, 592, 593), start=1)}
TAKES_AXES = {100, 280, 300, 920}
M_GROUPS: list[set[int]] = [{0, 1, 2, 30, 60}, {6}, {3, 4, 5}, {7}, {8, 9}, {48, 49}, {90, 91, 92}]
M_KNOWN = {90, 91, 92, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 30, 48, 49, 54, 55, 60}
PLANES = {170: ("X", "Y", "Z", "I", "J"), 180: ("Z", "X", "Y", "K", "I"), 190: ("Y", "Z", "X", "J", "K")}
STEPS = 20_000


@dataclass
class Facts:
    """What is known of the machine and the moment; mm, degrees, machine coordinates for `start`, `g28`, `g30`."""

    limits: Limits
    start: Point
    work: dict[int, Point] = field(default_factory=dict)
    system: int = 1
    g92: Point = field(default_factory=dict)
    lengths: dict[int, float] = field(default_factory=dict)
    tool: int | None = None
    g28: Point | None = None
    g30: Point | None = None
    variables: dict[int, float] = field(default_factory=dict)
    block_delete: bool = False
    macros: str = ""
    heads: dict[int, Point] = field(default_factory=dict)
    """What is added to positions under M91 and M92."""


class Ended(Exception):
    """M2 or M30."""


# -- values (3.2.2)


class Reader:
    """The characters of one line without blanks and comments, read from left to right."""

    def __init__(self, text: str, run: Run) -> None:
        self.text, self.at, self.run = text, 0, run

    def done(self) -> bool:
        return self.at >= len(self.text)

    def take(self, pattern: str) -> str | None:
        found = re.compile(pattern).match(self.text, self.at)
        if found is None:
            return None
        self.at = found.end()
        return found.group()

    def real(self, *, signed: bool = True) -> float:
        """A number, a parameter, an expression, a unary operation (3.2.2)."""
        number = self.take(r"[+-]?(\d+\.?\d*|\.\d+)" if signed else r"(\d+\.?\d*|\.\d+)")
        if number is not None:
            return float(number)
        if signed and (sign := self.take(r"[+-](?=[#\[a-z])")):
            value = self.real(signed=False)
            return -value if sign == "-" else value
        if self.take("#"):
            return self.run.parameter(index(self.real()))
        if self.take(r"\["):
            value = self.expression()
            if not self.take(r"\]"):
                raise Refused("bracket not closed")
            return value
        return self.unary()

    def unary(self) -> float:
        name = self.take(r"abs|acos|asin|atan|cos|exp|fix|fup|int|ln|round|sin|sqrt|tan|not")
        if name is None or not self.text.startswith("[", self.at):
            raise Refused(f"no value at {self.text[self.at :]!r}")
        value = self.real()
        try:
            if name == "atan":
                if not self.take("/"):
                    raise Refused("atan needs two values")
                return math.degrees(math.atan2(value, self.real()))
            return self.computed(name, value)
        except (ValueError, OverflowError) as wrong:
            raise Refused(f"{name} of {value}") from wrong

    def computed(self, name: str, value: float) -> float:
        if name == "round":
            if abs(value - math.floor(value) - 0.5) < 1e-9:
                return float((math.floor(value), math.ceil(value))[self.run.pick("a half goes down or up")])
            return float(math.floor(value + 0.5))
        for limit in ("fix", "fup", "int"):
            if name == limit and abs(value - round(value)) < 1e-9 and value != round(value):
                raise NotRead("rounding beside a whole number")
        angle = math.radians(value)
        return {
            "abs": lambda: abs(value),
            "acos": lambda: math.degrees(math.acos(value)),
            "asin": lambda: math.degrees(math.asin(value)),
            "cos": lambda: math.cos(angle),
            "sin": lambda: math.sin(angle),
            "tan": lambda: math.tan(angle),
            "exp": lambda: math.exp(value),
            "ln": lambda: math.log(value),
            "sqrt": lambda: math.sqrt(value),
            "fix": lambda: float(math.floor(value)),
            "fup": lambda: float(math.ceil(value)),
            "int": lambda: float(math.trunc(value)),
            "not": lambda: float(value == 0),
        }[name]()

    def expression(self) -> float:
        """What stands between brackets: groups of operations, each from the left (3.2.2.3), comparisons below (4.2)."""
        values = [self.operand()]
        names: list[str] = []
        while name := self.take(r"\*\*|<=|>=|==|<>|<<|>>|[*/+<>-]|mod|and|xor|or|band|bxor|bor"):
            names.append(name)
            values.append(self.operand())
        kinds = [{"**": 0, "*": 1, "/": 1, "mod": 1, "+": 2, "-": 2}.get(n, 3) for n in names]
        if kinds.count(3) > 1 or (
            {"and", "or", "xor", "band", "bor", "bxor", "<<", ">>"} & set(names) and len(names) > 1
        ):
            raise NotRead("operations without a stated order")
        for group in range(4):
            for place in itertools.count():
                while place < len(kinds) and kinds[place] == group:
                    values[place : place + 2] = [self.operated(names.pop(place), values[place], values[place + 1])]
                    del kinds[place]
                if place >= len(kinds):
                    break
        return values[0]

    def operand(self) -> float:
        signed_power = re.compile(r"-[^*/+<>=\]-]*\*\*").match(self.text, self.at)
        if signed_power:
            raise NotRead("a sign before a power")
        return self.real()

    def operated(self, name: str, a: float, b: float) -> float:
        try:
            if name == "**":
                value = a**b
                if isinstance(value, complex):
                    raise Refused("root of a negative number")
                return float(value)
            if name == "/":
                return a / b
            if name == "mod":
                if a < 0 or b < 0:
                    return (
                        math.fmod(a, b)
                        if self.run.pick("mod of negatives: sign of the first or the second") == 0
                        else a % b
                    )
                return math.fmod(a, b)
        except (ZeroDivisionError, OverflowError, ValueError) as wrong:
            raise Refused(f"{a} {name} {b}") from wrong
        if name in {"*", "+", "-"}:
            return {"*": a * b, "+": a + b, "-": a - b}[name]
        if name in {"and", "or", "xor"}:
            one, two = a != 0, b != 0
            return float({"and": one and two, "or": one or two, "xor": one != two}[name])
        if name in {"<", ">", "<=", ">=", "==", "<>"}:
            return float(self.compared(name, a, b))
        raise NotRead(f"operation {name}")

    def compared(self, name: str, a: float, b: float) -> bool:
        if a != b and abs(a - b) < 1e-9 * max(1.0, abs(a), abs(b)):
            a = (a, b)[self.run.pick(f"nearly equal in line {self.run.walk.line}")]
        return {"<": a < b, ">": a > b, "<=": a <= b, ">=": a >= b, "==": a == b, "<>": a != b}[name]


def index(value: float) -> int:
    """A number that has to be whole, within 0.0001 (3.2.2.1)."""
    if not math.isfinite(value) or abs(value - round(value)) > 1e-4:
        raise Refused(f"{value} is not whole")
    return round(value)


# -- lines (3.2, 4.1)


@dataclass
class Line:
    """number: in the file, from 1; text: without comments and blanks, small letters; raw: as written."""

    number: int
    text: str
    raw: str


def bare(raw: str) -> str:
    """A line without its comments; strings of messages stay."""
    out, at = "", 0
    while at < len(raw):
        sign = raw[at]
        if sign == ";":
            break
        if sign == "(":
            end = raw.find(")", at)
            if end < 0 or "(" in raw[at + 1 : end]:
                return out + "\0"
            at = end + 1
            continue
        out += sign
        at += 1
    return out


def lines_of(text: str) -> list[Line]:
    found = []
    for number, raw in enumerate(text.splitlines(), start=1):
        kept = bare(raw)
        found.append(Line(number, re.sub(r"\s", "", kept).lower(), kept))
    return found


def word_of(line: Line) -> str:
    """The keyword that a line begins with, or ''."""
    text = re.sub(r"^n\d{1,5}", "", line.text)
    for name in ("endif", "endwhile", "endsub", "else", "while", "sub", "gosub", "if"):
        if text.startswith(name) and not (name == "sub" and text.startswith("sub[")):
            return name
    return ""


def name_of(line: Line, keyword: str) -> str:
    return re.sub(r"^n\d{1,5}", "", line.text)[len(keyword) :]


@dataclass
class Code:
    """A file: its lines without the subprograms, and those by name."""

    main: list[Line]
    subs: dict[str, list[Line]]


def code_of(text: str) -> Code:
    main: list[Line] = []
    subs: dict[str, list[Line]] = {}
    into: list[Line] | None = None
    for line in lines_of(text):
        keyword = word_of(line)
        if keyword == "sub":
            if into is not None:
                raise NotRead("a subprogram within a subprogram")
            name = name_of(line, "sub")
            if name in subs:
                raise NotRead("two subprograms of a name")
            into = subs.setdefault(name, [])
        elif keyword == "endsub":
            if into is None:
                raise NotRead("endsub without sub")
            into = None
        else:
            (main if into is None else into).append(line)
    if into is not None:
        raise NotRead("sub without endsub")
    return Code(main, subs)


def matching(lines: list[Line], at: int) -> tuple[int | None, int]:
    """The places of the `else` and of the end that belong to the `if` or `while` at a place."""
    depth, other = 0, None
    for place in range(at, len(lines)):
        keyword = word_of(lines[place])
        if keyword in {"if", "while"}:
            depth += 1
        elif keyword == "else" and depth == 1:
            other = place
        elif keyword in {"endif", "endwhile"}:
            depth -= 1
            if depth == 0:
                if (keyword == "endif") != (word_of(lines[at]) == "if"):
                    raise NotRead("blocks that cross")
                return other, place
    raise NotRead("a block without an end")


# -- the run


class Run:
    """One reading of one program."""

    def __init__(self, program: str, facts: Facts, questions: Questions) -> None:
        self.facts = facts
        self.pick = questions.pick
        self.code = code_of(program)
        self.subs = {**code_of(facts.macros).subs, **self.code.subs}
        self.walk = Walk(dict(facts.start), facts.limits)
        self.values = dict(facts.variables)
        self.axes = [a for a in AXES if a in facts.start]
        zero = dict.fromkeys(self.axes, 0.0)
        self.work = {n: {**zero, **facts.work.get(n, {})} for n in range(1, 10)}
        self.system = facts.system
        self.g92 = {**zero, **facts.g92}
        self.kept92 = dict(self.g92)
        self.length: float = 0.0
        self.head = 0
        self.lengths = dict(facts.lengths)
        self.follows_tool = False
        self.tool, self.selected = facts.tool, None
        self.inches = False
        self.relative = False
        self.plane = 170
        self.motion: int | None = None
        self.back_to_old = True
        self.turned: tuple[float, float, float] | None = None
        self.scaled: tuple[float, float, float, float, float] | None = None
        self.scaled_rotary = 1.0
        self.cycle: dict[str, float] = {}
        self.cycle_relative = False
        self.cycle_inches = False
        self.spindle = False
        self.inside: list[str] = []
        self.steps = 0
        self.place = self.program_place()

    # -- coordinates

    def origin(self) -> Point:
        """Where the zero of the program lies: system, G92 and tool length (3.1.2.2, 3.4.12, 3.4.24)."""
        base = {a: self.work[self.system][a] + self.g92[a] for a in self.axes}
        base["Z"] += self.length
        for axis, value in self.facts.heads.get(self.head, {}).items():
            base[axis] += value
        return base

    def formed(self, at: Point) -> Point:
        """A programmed place after scaling and rotation, in the system (3.4.13, 3.4.18)."""
        out = dict(at)
        if self.scaled:
            sx, sy, sz, i, j = self.scaled
            out["X"], out["Y"], out["Z"] = i + sx * (out["X"] - i), j + sy * (out["Y"] - j), sz * out["Z"]
            for axis in set(self.axes) - set("XYZ"):
                out[axis] *= self.scaled_rotary
        if self.turned:
            angle, x, y = self.turned
            dx, dy = out["X"] - x, out["Y"] - y
            out["X"] = x + dx * math.cos(angle) - dy * math.sin(angle)
            out["Y"] = y + dx * math.sin(angle) + dy * math.cos(angle)
        return out

    def machine(self, at: Point) -> Point:
        formed, origin = self.formed(at), self.origin()
        return {a: formed[a] + origin[a] for a in self.axes}

    def program_place(self) -> Point:
        """Where the machine stands, as the program would write it."""
        origin = self.origin()
        at = {a: self.walk.at[a] - origin[a] for a in self.axes}
        if self.turned:
            angle, x, y = self.turned
            dx, dy = at["X"] - x, at["Y"] - y
            at["X"] = x + dx * math.cos(angle) + dy * math.sin(angle)
            at["Y"] = y - dx * math.sin(angle) + dy * math.cos(angle)
        if self.scaled:
            sx, sy, sz, i, j = self.scaled
            at["X"], at["Y"], at["Z"] = i + (at["X"] - i) / sx, j + (at["Y"] - j) / sy, at["Z"] / sz
            for axis in set(self.axes) - set("XYZ"):
                at[axis] /= self.scaled_rotary
        return at

    def to(self, at: Point) -> None:
        """A straight move to a programmed place."""
        self.walk.go(self.machine(at))
        self.place = at

    # -- parameters (3.1.2)

    def parameter(self, number: int) -> float:
        if not 1 <= number <= 5999:
            raise Refused(f"no parameter {number}")
        if number in self.values:
            return self.values[number]
        if number < 5000:
            raise NotRead(f"#{number} is not known")
        if self.inches:
            raise NotRead("places as numbers in inch")
        for first, table in ((5001, self.place), (5071, self.walk.at), (5211, self.kept92)):
            if first <= number < first + len(AXES) and AXES[number - first] in table:
                return table[AXES[number - first]]
        if 5221 <= number <= 5386 and (number - 5221) % 20 < len(AXES):
            axis = AXES[(number - 5221) % 20]
            if axis in self.axes:
                return self.work[(number - 5221) // 20 + 1][axis]
        if number == 5220:
            return float(self.system)
        if 5401 <= number <= 5499 and number - 5400 in self.lengths:
            return self.lengths[number - 5400]
        if number == 5008 and self.tool is not None:
            return float(self.tool)
        raise NotRead(f"#{number}")

    def assign(self, number: int, value: float) -> None:
        if not 1 <= number <= 5999:
            raise Refused(f"no parameter {number}")
        if 5401 <= number <= 5499 and not self.inches:
            self.lengths[number - 5400] = value
            in_use = self.follows_tool and self.tool == number - 5400
            if in_use and self.pick("a length that is written acts: at the next G43, at once"):
                self.length = value
                self.place = self.program_place()
            return
        for first, table in ((5161, self.facts.g28), (5181, self.facts.g30)):
            if table is not None and first <= number < first + len(self.axes) and not self.inches:
                table[self.axes[number - first]] = value
                return
        if number >= 5000:
            raise NotRead(f"writing #{number}")
        self.values[number] = value

    # -- flow (4.1)

    def all(self) -> Walk:
        try:
            self.block(self.code.main)
        except Ended:
            pass
        except Refused as stop:
            self.walk.refused = f"line {self.walk.line}: {stop}"
        return self.walk

    def block(self, lines: list[Line]) -> None:
        at = 0
        while at < len(lines):
            line = lines[at]
            self.steps += 1
            if self.steps > STEPS:
                raise NotRead("too many steps")
            self.walk.line = line.number
            if "\0" in line.text:
                raise Refused("comment")
            if line.text.startswith("/"):
                if self.facts.block_delete:
                    at += 1
                    continue
                line = Line(line.number, line.text[1:], line.raw)
            keyword = word_of(line)
            if keyword == "if":
                other, end = matching(lines, at)
                if self.condition(name_of(line, "if")):
                    self.block(lines[at + 1 : other if other is not None else end])
                elif other is not None:
                    self.block(lines[other + 1 : end])
                at = end + 1
            elif keyword == "while":
                _, end = matching(lines, at)
                while self.condition(name_of(line, "while")):
                    self.block(lines[at + 1 : end])
                    self.steps += 1
                    if self.steps > STEPS:
                        raise NotRead("too many steps")
                    self.walk.line = line.number
                at = end + 1
            elif keyword in {"else", "endif", "endwhile"}:
                raise NotRead(f"{keyword} without its beginning")
            else:
                self.statement(line, keyword)
                at += 1

    def condition(self, text: str) -> bool:
        if not text.startswith("["):
            raise NotRead("a condition without brackets")
        reader = Reader(text, self)
        value = reader.real()
        if not reader.done():
            raise NotRead("words after a condition")
        return value != 0

    def statement(self, line: Line, keyword: str) -> None:
        if keyword == "gosub":
            self.call(name_of(line, "gosub"))
        elif line.text.startswith(("msg", "logmsg", "logfile")):
            return
        elif line.text.startswith("errmsg"):
            raise Ended
        elif line.text.startswith(("dlgmsg", "sp", "tcaguard", "mcaguard", "homeisestop", "setlafangle")):
            raise NotRead(line.text)
        else:
            self.words(line.text)

    def call(self, name: str) -> None:
        if name not in self.subs:
            raise Refused(f"no subprogram {name}")
        if len(self.inside) > 8:
            raise NotRead("nested calls")
        self.inside.append(name)
        line = self.walk.line
        self.block(self.subs[name])
        self.walk.line = line
        self.inside.pop()

    # -- one line of words (3.2)

    def words(self, text: str) -> None:
        reader = Reader(re.sub(r"^n\d{1,5}", "", text), self)
        codes: list[int] = []
        ms: list[int] = []
        given: dict[str, float] = {}
        settings: list[tuple[int, float]] = []
        while not reader.done():
            if reader.take("#"):
                number = index(reader.real())
                if not reader.take("="):
                    raise Refused("no = after a parameter")
                settings.append((number, reader.real()))
                continue
            letter = reader.take(r"[a-z]")
            if letter is None or letter in "nouvw":
                raise Refused(f"what is {reader.text[reader.at :]!r}")
            value = reader.real()
            if letter == "g":
                codes.append(index(round(value * 10, 3)))
            elif letter == "m":
                ms.append(index(value))
            elif letter.upper() in given:
                raise Refused(f"two words {letter}")
            else:
                given[letter.upper()] = value
        self.execute(codes, ms, given)
        for number, value in settings:
            self.assign(number, value)

    def checked(self, codes: list[int], ms: list[int], given: dict[str, float]) -> None:
        """One code of each modal group, and nobody else takes the axis words (3.2.2.7, 3.3)."""
        known = set().union(*GROUPS)
        for code in codes:
            if code not in known:
                raise Refused(f"G{code / 10}")
        for group in GROUPS:
            if sum(code in group for code in codes) > 1:
                raise Refused("two codes of one group")
        for group in M_GROUPS:
            if sum(m in group for m in ms) > 1:
                raise Refused("two M codes of one group")
        if len(ms) > 4:
            raise Refused("more than four M words")
        if set(codes) & (MOTIONS - {800}) and set(codes) & TAKES_AXES and any(a in given for a in AXES):
            raise Refused("two codes that take axes")
        if any(a in given and a not in self.axes for a in AXES):
            raise NotRead("an axis that is not there")
        if given.get("S", 0.0) < 0:
            raise Refused("negative speed")
        unread = {330, 331, 382, 740, 760, 840, 930, 950, 410, 420, 411, 421, 431}
        if unread & set(codes):
            raise NotRead("codes that are not read")

    def execute(self, codes: list[int], ms: list[int], given: dict[str, float]) -> None:
        """The order of table 3-7."""
        self.checked(codes, ms, given)
        own = [m for m in ms if f"m{m}" in self.subs and f"m{m}" not in self.inside]
        if own:
            self.own_function(own, codes, ms, given)
            return
        if any(m not in M_KNOWN for m in ms):
            raise NotRead(f"M{ms}")
        left = {n: v for n, v in given.items() if n not in "FS"}
        if "T" in left:
            number = index(left.pop("T"))
            if number < 0:
                raise Refused("negative tool")
            self.selected = number
        if 6 in ms:
            self.change()
        if {3, 4} & set(ms):
            self.spindle = True
        if 5 in ms:
            self.spindle = False
        for head in {90, 91, 92} & set(ms):
            if (head > 90 and head - 90 not in self.facts.heads) or len(ms) > 1 or codes:
                raise NotRead("heads")
            self.head = head - 90
            self.place = self.program_place()
        if 54 in ms or 55 in ms:
            left.pop("P", None)
        if 40 in codes and left.pop("P", 0.0) < 0:
            raise Refused("negative dwell")
        self.modes(codes, left)
        motion = next((c for c in codes if c in MOTIONS), None)
        self.shift(codes, left)
        if 280 in codes or 300 in codes:
            self.home(self.facts.g28 if 280 in codes else self.facts.g30, left)
        elif motion == 800:
            self.motion, self.cycle = 800, {}
            if not set(codes) & TAKES_AXES and any(a in left for a in AXES):
                raise Refused("axis words under G80")
        elif motion is not None or any(a in left for a in AXES):
            self.move(motion, codes, left)
        if left:
            raise NotRead(f"words without use: {sorted(left)}")
        if {2, 30} & set(ms):
            raise Ended

    def own_function(self, own: list[int], codes: list[int], ms: list[int], given: dict[str, float]) -> None:
        """A subprogram m<n> in place of the code; letters in #1 to #26 (4.4)."""
        if codes or len(ms) > 1:
            raise Refused("an overridden M code with others")
        for n in range(26):
            self.values[n + 1] = given.get(chr(ord("A") + n), -1e10)
        self.call(f"m{own[0]}")

    def change(self) -> None:
        """M6 (3.5.3, 4.3)."""
        if "change_tool" in self.subs and "change_tool" not in self.inside:
            raise NotRead("change_tool")
        if self.selected is None:
            raise NotRead("M6 without T")
        self.tool = self.selected
        self.spindle = False
        if self.follows_tool:
            self.length = self.length_of(self.tool)
            self.place = self.program_place()

    def length_of(self, tool: int | None) -> float:
        if tool == 0:
            return 0.0
        if tool is None or tool not in self.lengths:
            raise NotRead("a length that is not known")
        return self.lengths[tool]

    def modes(self, codes: list[int], left: dict[str, float]) -> None:
        for code in codes:
            if code in PLANES:
                self.plane = code
        for code in codes:
            if code in {200, 700}:
                self.inches = True
            elif code in {210, 710}:
                self.inches = False
        if 430 in codes:
            if "H" in left:
                number = index(left.pop("H"))
                if not 1 <= number <= 99:
                    raise Refused("H")
                self.length, self.follows_tool = self.length_of(number), False
            else:
                self.length, self.follows_tool = self.length_of(self.tool), True
            self.place = self.program_place()
        if 490 in codes:
            self.length, self.follows_tool = 0.0, False
            self.place = self.program_place()
        for code in codes:
            if code in SYSTEMS:
                if (self.turned or self.scaled) and SYSTEMS[code] != self.system:
                    raise NotRead("another system under rotation or scaling")
                self.system = SYSTEMS[code]
                self.place = self.program_place()
        if {610, 611, 640} & set(codes):
            for name in "PQR":
                left.pop(name, None)
        if 900 in codes:
            self.relative = False
        if 910 in codes:
            self.relative = True
        if 980 in codes:
            self.back_to_old = True
        if 990 in codes:
            self.back_to_old = False

    def size(self, axis: str) -> float:
        return INCH if self.inches and axis in "XYZIJKRQ" else 1.0

    def shift(self, codes: list[int], left: dict[str, float]) -> None:
        """G10, G92 and its kin (3.4.5, 3.4.24), G68, G69, G50, G51."""
        if {100, 920, 921, 922, 923} & set(codes) and (self.turned or self.scaled):
            raise NotRead("offsets under rotation or scaling")
        named = {a: left[a] * self.size(a) for a in self.axes if a in left}
        if 100 in codes:
            self.set_system(left, named)
        if 920 in codes:
            if not named:
                raise Refused("G92 without axes")
            for axis, value in named.items():
                self.g92[axis] += self.place[axis] - value
                del left[axis]
            self.kept92 = dict(self.g92)
        if 921 in codes or 922 in codes:
            self.g92 = dict.fromkeys(self.axes, 0.0)
            if 921 in codes:
                self.kept92 = dict(self.g92)
        if 923 in codes:
            self.g92 = dict(self.kept92)
        if {100, 920, 921, 922, 923} & set(codes):
            self.place = self.program_place()
        if {680, 690, 500, 510} & set(codes):
            self.form(codes, left, named)

    def set_system(self, left: dict[str, float], named: Point) -> None:
        kind, number = left.pop("L", None), left.pop("P", None)
        if kind is None or number is None or index(kind) not in {2, 20} or not 1 <= index(number) <= 9:
            raise Refused("G10")
        if "R" in left:
            raise NotRead("G10 R")
        for axis, value in named.items():
            del left[axis]
            if kind == 2:
                self.work[index(number)][axis] = value
                continue
            if axis == "Z" and self.length and self.pick("G10 L20: with or without the tool length"):
                at = self.walk.at[axis]
            else:
                at = self.walk.at[axis] - (self.length if axis == "Z" else 0.0)
            if self.g92[axis]:
                at -= self.g92[axis] * (1 - self.pick("G10 L20: with or without G92"))
            self.work[index(number)][axis] = at - value

    def form(self, codes: list[int], left: dict[str, float], named: Point) -> None:
        if {*TAKES_AXES, *MOTIONS} & set(codes):
            raise NotRead("rotation or scaling and a move in one line")
        before = self.place
        if 690 in codes:
            self.turned = None
        if 500 in codes:
            self.scaled, self.scaled_rotary = None, 1.0
        if 680 in codes:
            if "R" not in left or self.turned:
                raise NotRead("G68 without R, or a second one")
            self.turned = (math.radians(left.pop("R")), named.get("X", 0.0), named.get("Y", 0.0))
            if ("X" in named) != ("Y" in named) or not named:
                raise NotRead("G68 without its point")
            for axis in "XY":
                left.pop(axis, None)
        if 510 in codes:
            self.scaling(left)
        if self.turned and self.scaled and self.turned[1:] != self.scaled[3:]:
            raise NotRead("two points of rotation and scaling")
        moved = self.pick(
            "the program's place when rotation or scaling changes: that of the machine, the last programmed"
        )
        self.place = before if moved else self.program_place()

    def scaling(self, left: dict[str, float]) -> None:
        if self.scaled:
            raise NotRead("a second G51")
        if "I" not in left or "J" not in left:
            raise NotRead("G51 without its point")
        i, j = left.pop("I") * self.size("I"), left.pop("J") * self.size("J")
        if "P" in left:
            p = left.pop("P")
            # "UNIFORM": of X and Y, for which the page has a point each, of Z, or of whatever axis there is.
            z = (1.0, p)[self.pick(HEIGHTS)]
            self.scaled, self.scaled_rotary = (p, p, z, i, j), (1.0, p)[self.pick("G51 P: rotary axes or not")]
        elif "X" in left and "Y" in left:
            self.scaled = (left.pop("X"), left.pop("Y"), 1.0, i, j)
        else:
            raise NotRead("G51 with one factor")
        if 0.0 in (*self.scaled[:3], self.scaled_rotary):
            raise NotRead("scaled by nothing")

    # -- moves (3.4)

    def target(self, left: dict[str, float]) -> Point:
        """The programmed end; takes the axis words."""
        end = dict(self.place)
        for axis in self.axes:
            if axis in left:
                value = left.pop(axis) * self.size(axis)
                end[axis] = end[axis] + value if self.relative else value
        return end

    def home(self, home: Point | None, left: dict[str, float]) -> None:
        """G28, G30: by way of a point, then home (3.4.8)."""
        if home is None or any(axis not in home for axis in self.axes) or self.inches:
            raise NotRead("no home position")
        if any(axis in left for axis in self.axes):
            self.to(self.target(left))
        self.walk.go({axis: home[axis] for axis in self.axes})
        self.place = self.program_place()

    def move(self, motion: int | None, codes: list[int], left: dict[str, float]) -> None:
        if motion is None:
            if self.motion is None:
                raise NotRead("no motion mode stated")
            if self.motion == 800:
                raise Refused("axis words under G80")
            motion = self.motion
        fresh = self.motion != motion
        self.motion = motion
        if motion not in {0, 10} and 530 in codes:
            raise Refused("G53 without G0 or G1")
        if motion in {0, 10}:
            self.cycle = {}
            if not any(a in left for a in AXES):
                raise Refused("no axis words") if motion is not None else NotRead("a bare motion code")
            if 530 in codes:
                self.walk.go({a: left.pop(a) * self.size(a) for a in self.axes if a in left})
                self.place = self.program_place()
            else:
                self.to(self.target(left))
        elif motion in {20, 30}:
            self.cycle = {}
            self.arc(left, clockwise=motion == 20)
        else:
            self.drill(motion, left, fresh=fresh)

    def arc(self, left: dict[str, float], *, clockwise: bool) -> None:
        """3.4.3, in either format, in the programmed coordinates, then formed."""
        one, two, _, first, second = PLANES[self.plane]
        if one not in left and two not in left:
            raise Refused("an arc without an axis of its plane")
        start = self.place
        radius = left.pop("R") * self.size("R") if "R" in left else None
        offset = {n: left.pop(n) * self.size(n) for n in (first, second) if n in left}
        end = self.target(left)
        begin, finish = (start[one], start[two]), (end[one], end[two])
        if radius is not None:
            if offset:
                raise NotRead("R together with a centre")
            apart = math.dist(begin, finish)
            if apart < 1e-9 or apart / 2 > abs(radius) + 1e-6 or radius == 0:
                raise Refused("radius")
            if apart / 2 > abs(radius) - 1e-6:
                raise NotRead("a radius at its limit")
            centre = centre_of(begin, finish, radius, clockwise=clockwise)
        else:
            if not offset:
                raise Refused("an arc without centre")
            centre = (begin[0] + offset.get(first, 0.0), begin[1] + offset.get(second, 0.0))
            apart = abs(math.dist(begin, centre) - math.dist(finish, centre))
            tolerance = 0.0002 * INCH if self.inches else 0.002
            if apart > tolerance * 1.001:
                raise Refused("centre")
            if apart > tolerance * 0.999 or math.dist(begin, centre) < 1e-6:
                raise NotRead("a centre at its limit")
            if 0 < math.dist(begin, finish) < 1e-3:
                raise NotRead("nearly a full circle")
        if (self.turned or self.scaled) and self.plane != 170:
            raise NotRead("an arc in another plane under rotation or scaling")
        if self.scaled and self.scaled[0] != self.scaled[1]:
            raise Refused("an arc under two factors")
        if self.scaled and self.scaled[0] < 0:
            raise NotRead("an arc under a negative factor")
        if (
            self.machine(start) != self.walk.at
            and max(abs(self.machine(start)[a] - self.walk.at[a]) for a in self.axes) > 1e-6
        ):
            raise NotRead("an arc from a place that the machine has not")
        angle = swept(begin, finish, centre, clockwise=clockwise)
        middle = self.machine({**start, one: centre[0], two: centre[1]})
        self.walk.turn((one, two), (middle[one], middle[two]), angle, self.machine(end))
        self.place = end

    # -- drilling (3.4.21)

    def drill(self, motion: int, left: dict[str, float], *, fresh: bool) -> None:
        one, two, deep = PLANES[self.plane][:3]
        if (self.turned or self.scaled) and self.plane != 170:
            raise NotRead("a cycle under rotation or scaling")
        if fresh:
            self.cycle = {}
        elif self.cycle and (self.cycle_relative != self.relative or self.cycle_inches != self.inches):
            raise NotRead("sticky numbers in another mode")
        self.cycle_relative, self.cycle_inches = self.relative, self.inches
        if not any(a in left for a in "XYZ"):
            raise Refused("a cycle without X, Y, Z")
        if any(a in left for a in "ABC"):
            raise NotRead("a rotary axis in a cycle")
        if deep not in left and deep not in self.cycle:
            raise Refused("no depth")
        if "R" not in left and "R" not in self.cycle:
            raise NotRead("no R")
        for name in (deep, "R", "Q", "P", "K", "I", "J"):
            if name in left:
                self.cycle[name] = left.pop(name)
        repeats = index(left.pop("L", 1.0))
        if repeats < 1:
            raise Refused("L")
        if self.cycle.get("P", 0.0) < 0:
            raise Refused("P")
        if motion in {830, 730} and "Q" not in self.cycle:
            raise NotRead("no Q")
        if motion in {830, 730} and self.cycle["Q"] <= 0:
            raise Refused("Q")
        if motion == 860 and not self.spindle:
            raise Refused("G86 without a spindle that turns")
        if motion == 870:
            raise NotRead("G87")
        size = self.size("Z")
        old = self.place[deep]
        retract = self.cycle["R"] * size + (old if self.relative else 0.0)
        bottom = self.cycle[deep] * size + (retract if self.relative else 0.0)
        if retract < bottom:
            raise Refused("R below the depth")
        clear = max(old, retract) if self.back_to_old else retract
        at = dict(self.place)
        if at[deep] < retract:
            at = {**at, deep: retract}
            self.to(at)
        moves = {a: left.pop(a) * size for a in (one, two) if a in left}
        for _ in range(repeats):
            across = {a: (at[a] + v if self.relative else v) for a, v in moves.items()}
            at = {**at, **across}
            self.to(at)
            for height in (retract, bottom, clear):
                at = {**at, deep: height}
                self.to(at)
        if motion == 880:
            return


def read(program: str, facts: Facts, settled: Mapping[str, int] | None = None) -> Iterator[Walk]:
    """Every reading of a program: `NotRead` where this interpreter makes no statement."""
    return every_reading(lambda questions: Run(program, facts, questions).all(), settled)
