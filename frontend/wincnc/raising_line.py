"""A line of WinCNC as raising sees it: one command, its words and companions, in the modes in force.

What a line that cannot be read so means, nobody knows: ``Unraisable``. Manual: Command Reference.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import replace

from gproof.frontend.common.move_tables import MoveLetters
from gproof.frontend.common.raising import Line, Raiser, Unraisable
from gproof.frontend.common.raising_modes import UNKNOWN_MODE, LineWord, Modes
from gproof.frontend.wincnc.raising_feeds import FeedRules, Rate, feed_rules, first_feeds, unknown
from gproof.ir.dialects.wincnc.settings import WinCncSettings, wincnc_settings
from gproof.ir.finding import Span
from gproof.ir.job import MM, AxisPlace, Feed, Quantity
from gproof.ir.machine import AXES, AXIS_NAMES, AxisKind, Machine
from gproof.ir.program import Binary, Expr, Input, Named, Number, Program, Unary, Variable
from gproof.ir.record import field, record
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.setup import StoredPosition

AXIS_LETTERS = "XYZWUVABC"
UNIT_OF_MM = {mm: unit for unit, mm in MM.items()}
ONCE = (F.ABSOLUTE_ONCE, F.INCREMENTAL_ONCE)
MAPPINGS = (F.MAP_WORDS, F.MAP_HEADS, F.MAP_PULSES)
MODES_OF_DISTANCE = (F.ABSOLUTE, F.INCREMENTAL, *ONCE)


OWN_MODES: dict[str, object] = {
    "doubt": False, "cycle": 0, "cell": False, "turn": "", "settled": False, "center": None, "z": None, "said": None,
    "unit_before": None, "stored": False, "moved": False, "keep": False, "lengths": True, "work": 1, "arc": None,
}  # fmt: skip
"""Modes of this language at the start of a job.

doubt: an arc had the last F; cycle: tenths of a drilling cycle in force; cell: an array's cell has named no zero yet;
turn: ``rotate`` or ``scale``, settled: X and Y were named since; center: I and J of the last arc; z: height of Z; said:
the feed that the Job has in force; stored: G92.3 has put a zero away; moved, keep: the file has moved the zero, and
keeps it; lengths: measures of tools count; arc: the feed of arcs.
"""


@record(slots=True)
class Command:
    """A line of one command. words: by letter; columns: of its axis words; comment: after the words."""

    span: Span
    command: CodeRule | None = None
    companions: list[CodeRule] = field(default_factory=list)
    words: dict[str, LineWord] = field(default_factory=dict)
    columns: dict[str, int] = field(default_factory=dict)
    comment: str = ""

    @property
    def name(self) -> str:
        """What to call it."""
        return "a line without a command" if self.command is None else self.command.text

    def axes(self) -> dict[int, LineWord]:
        """The axis words by column."""
        taken = "" if self.command is None else self.command.takes
        return {self.columns[k]: word for k, word in self.words.items() if k in self.columns and k not in taken}

    @property
    def mask(self) -> int:
        """The columns of the axis words as bits."""
        return sum(1 << column for column in self.axes())

    def find(self, *functions: F) -> CodeRule | None:
        """A companion with one of these functions."""
        return next((rule for rule in self.companions if rule.function in functions), None)

    def value(self, letter: str) -> Expr | None:
        """The value of a word, 0 for a letter alone."""
        word = self.words.get(letter)
        return None if word is None else word.value

    def number(self, letter: str) -> float | None:
        """The literal value of a word; Unraisable for another one."""
        word = self.words.get(letter)
        if word is None:
            return None
        if word.number is None:
            raise Unraisable(self.name, f"{letter} is a computed number")
        return word.number


class LineRaiser(Raiser):
    """What handlers of commands need of the program, the machine and the modes."""

    def __init__(self, program: Program, machine: Machine) -> None:
        self.controls: WinCncSettings = wincnc_settings(machine)
        self.columns = {axis.word: axis.index for axis in machine.axes}
        linear = {axis.index: axis.kind is AxisKind.LINEAR for axis in machine.axes}
        self.linear = tuple(linear.get(column, column < 3) for column in range(AXES))
        self.unit = UNIT_OF_MM[machine.unit]
        self.stored: Mapping[str, StoredPosition] = {}
        self.feeds: FeedRules = feed_rules(machine, self.controls, self.unit)
        words = {axis.index: axis.word for axis in machine.axes}
        # A head that moves up and down in the column of a rotary axis is no such axis in a table.
        axes = tuple(words.get(c, "") if self.linear[c] == (c < 3) else "" for c in range(AXES))
        self.letters = MoveLetters(axes=axes, centers="IJ", arcs_stay=self.controls.arcs_modal, bare=True)
        super().__init__(program, machine)

    def first_modes(self) -> Modes:
        """The modes at the start of a job (WINCNC.INI Settings: unit=, nmode=)."""
        modes = Modes(unit=self.unit, relative=self.controls.absolute is False, back="top")
        modes = first_feeds(modes, self.feeds)
        for name, value in OWN_MODES.items():
            modes = modes.with_own(name, value)
        return modes

    @property
    def now(self) -> Modes:
        """The modes in force."""
        assert self.modes is not None
        return self.modes

    def own_mode(self, name: str, usual: object = None) -> object:
        """A mode of this language."""
        return self.now.own(name, usual)

    def set_own(self, name: str, value: object) -> None:
        """Set a mode of this language."""
        self.modes = self.now.with_own(name, value)

    # ---- reading

    def command(self, line: Line, span: Span) -> Command:
        """A line's words as a command; Unraisable for what is none."""
        found = Command(span, columns=self.columns)
        for word in line:
            rule = self._code(found, word)
            if found.command is not None and found.command.function in MAPPINGS and rule is None:
                raise Unraisable(found.command.text, "words of one axis move another one")
            if rule is None:
                if word.letter in found.words:
                    raise Unraisable(f"{word.letter} twice in a line", "which one counts the manual does not say")
                value = self.expression(word.value, found.name)
                found.words[word.letter] = LineWord(word.letter, value, word.span, word.bare)
            elif rule.companion:
                found.companions.append(rule)
            elif found.command is not None:
                raise Unraisable(f"{found.command.text} with {rule.text}", "a line has one command")
            else:
                found.command = rule
        self._judge(found)
        return found

    def _code(self, found: Command, word: LineWord) -> CodeRule | None:
        """The rule of a word with G, L or M; None where the letter is a parameter of the command."""
        if word.letter not in self.program.rules.code_letters:
            return None
        number = word.number
        if number is None:
            if found.command is not None and word.letter in found.command.takes:
                return None
            raise Unraisable(f"{word.letter} with a number in braces", "which code it is, is not known")
        known = self.rule(word.letter, number) if abs(number * 10 - round(number * 10)) < 1e-6 else None
        if found.command is not None and word.letter in found.command.takes and (known is None or not known.companion):
            return None
        if known is None:
            raise Unraisable(f"{word.letter}{number:g}", "the language has no such code")
        return known

    def _judge(self, line: Command) -> None:
        """Unraisable for a word that nothing takes, and for two distance modes."""
        command = line.command
        if len([rule for rule in line.companions if rule.function in MODES_OF_DISTANCE]) > 1:
            raise Unraisable("two distance modes in a line", "which one counts the manual does not say")
        for letter in line.words:
            if command is None:
                good = letter in "FSPHT" or letter in AXIS_LETTERS or letter in "IJKR"
            else:
                good = letter in command.takes or (command.uses_axes and letter in AXIS_LETTERS)
            if not good or (
                letter in AXIS_LETTERS
                and letter not in self.columns
                and letter not in (command.takes if command else "")
            ):
                raise Unraisable(f"{letter} in a line of {line.name}", "no command takes it, or there is no such axis")
        for letter in command.needs if command else "":
            if letter not in line.words:
                raise Unraisable(line.name, f"{letter} is missing")

    def expression(self, value: Expr, what: str) -> Expr:
        """An expression with the arguments of the call as variables; Unraisable for what only this controller has."""
        if isinstance(value, Named):
            if len(value.name) != 1:
                raise Unraisable(f"{value.name} in braces", "a value that this controller keeps")
            return Variable(Number(float(ord(value.name) - 64), value.span), value.span, value.name)
        if isinstance(value, Unary):
            return dataclasses.replace(value, operand=self.expression(value.operand, what))
        if isinstance(value, Binary):
            left, right = (self.expression(part, what) for part in (value.left, value.right))
            return dataclasses.replace(value, left=left, right=right, readings=())
        if isinstance(value, Input):
            raise Unraisable(what, "a state of the machine as a number")
        return value

    # ---- operands

    def length(self, value: Expr) -> Quantity:
        """A length in the unit in force."""
        if self.now.unit == UNKNOWN_MODE:
            raise Unraisable("a length", "its unit depends on the way that the program took")
        return Quantity(value, self.now.unit)

    def amount(self, column: int, value: Expr) -> Quantity:
        """A place or distance of an axis."""
        return self.length(value) if self.linear[column] else Quantity(value, "deg")

    def is_relative(self, line: Command) -> bool:
        """Whether the words of a line are distances."""
        once = line.find(*ONCE)
        if once is not None:
            return once.function is F.INCREMENTAL_ONCE
        if self.now.relative == UNKNOWN_MODE:
            raise Unraisable("axis words", "whether they are absolute depends on the way that the program took")
        return self.now.relative is True

    def places(self, line: Command, *, relative: bool = False, only: int = -1) -> tuple[AxisPlace, ...]:
        """The axis words of a line; only: those of these columns (bits)."""
        return tuple(
            AxisPlace(AXIS_NAMES[column], self.amount(column, word.value), relative)
            for column, word in sorted(line.axes().items()) if only >> column & 1
        )  # fmt: skip

    def say_feed(self, rate: Rate | None, line: Command) -> Feed | None:
        """The feed of a move: None where it is that of the feed move before; Unraisable where it is not known."""
        if rate is None:
            raise Unraisable("F", "the feed of this move is not known: none was given for its axes, or feeds differ")
        if self.own_mode("said") == rate:
            return None
        self.set_own("said", rate)
        value = rate[0] if not isinstance(rate[0], float) else Number(rate[0], line.span)
        return Feed(Quantity(value, rate[1]))

    def settle_turn(self, columns: int, line: Command) -> None:
        """While G52 turns X and Y, one of them alone moves to a place that is only known once both were named."""
        if self.own_mode("turn", "") in ("", "scale") or not columns & 3:
            return
        if unknown(self.own_mode("turn")):
            raise Unraisable(line.name, "whether G51 or G52 is on depends on the way that the program took")
        if columns & 3 == 3:
            self.set_own("settled", True)
        elif self.own_mode("settled") is not True:
            raise Unraisable(line.name, "one of X and Y alone after G52, before a line named both")

    def forget_height(self) -> None:
        """Where Z is among the program's numbers is not known any more."""
        self.modes = replace(self.now.with_own("z", None))

    def follow_height(self, line: Command, *, relative: bool) -> None:
        """Keep where Z is, if its word is a literal place."""
        word = line.words.get("Z")
        if word is not None and self.columns.get("Z") == 2:
            z = (word.number, self.now.unit) if word.number is not None and not relative else None
            self.set_own("z", z)
