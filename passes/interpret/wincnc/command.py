"""A line as one command with its words, judged by itself (WinCNC Users Guide, Command Reference)."""

from __future__ import annotations

import math
from collections.abc import Sequence

from gproof.ir import codes
from gproof.ir.dialects.accepts import REPEATED_CHANNEL
from gproof.ir.finding import Refusal, Span
from gproof.ir.program import Text
from gproof.ir.record import field, record
from gproof.ir.rules import CodeRule, LanguageRules
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import Unknown, Value, beyond
from gproof.passes.interpret.core.parsed_line import LARGEST, Line

Words = Sequence[tuple[str, Value, Span]]


AXIS_LETTERS = "XYZWUVABC"


MEANT_BOTH = (F.ABSOLUTE_ONCE, F.INCREMENTAL_ONCE)
MAPPINGS = (F.MAP_WORDS, F.MAP_HEADS, F.MAP_PULSES)


@record(slots=True)
class Command(Line):
    """A line of one command. command: its rule, None for a line without one; columns: of the axis words.

    texts: by letter; comment: after the words; bare: letters without a number; letters: of a command that maps axes,
    in order.
    """

    command: CodeRule | None = None
    companions: list[CodeRule] = field(default_factory=list)
    texts: dict[str, Text] = field(default_factory=dict)
    comment: str = ""
    bare: frozenset[str] = frozenset()
    columns: dict[str, int] = field(default_factory=dict)
    letters: str = ""

    def axes(self) -> dict[int, Value]:
        """Values of the axis words by column."""
        taken = "" if self.command is None else self.command.takes
        return {
            column: self.values[letter]
            for letter, column in self.columns.items()
            if letter in self.values and letter not in taken
        }


def gather(
    rules: LanguageRules, columns: dict[str, int], span: Span, words: Words, has_laser: bool
) -> Command:  # fmt: skip
    """Words to a Command; Refusal with GP109, GP112, GP113, GP121, GP127, GP228 or GP232."""
    line = Command(span, columns=columns)
    for letter, value, where in words:
        if not isinstance(value, Unknown) and abs(value) > LARGEST:
            raise Refusal(codes.ARITHMETIC.at(where, what=beyond(letter, value)))
        rule = _code(rules, letter, value, where, line) if letter in "GLM" else None
        if rule is not None:
            _take_code(line, rule, where, has_laser)
        elif line.command is not None and line.command.function in MAPPINGS and letter in columns:
            line.letters += letter
        elif letter in line.values:
            hint = REPEATED_CHANNEL.hint if letter == "C" and line.command in _switches(rules) else ""
            raise Refusal(codes.REPEATED_WORD.at(where, letter=letter, hint=hint))
        else:
            line.values[letter] = value
            line.spans[letter] = where
    _check_words(line)
    return line


def _switches(rules: LanguageRules) -> tuple[CodeRule | None, ...]:
    """M11 and M12."""
    return rules.codes.get(("M", 110)), rules.codes.get(("M", 120))


def _code(rules: LanguageRules, letter: str, value: Value, where: Span, line: Command) -> CodeRule | None:
    """The rule of a word with G, L or M; None where the letter is a parameter of the command."""
    if isinstance(value, Unknown):
        if line.command is not None and letter in line.command.takes:
            return None
        raise Refusal(codes.UNKNOWN_CONDITION.at(where, cause=value.cause))
    tenths = round(value * 10)
    known = rules.codes.get((letter, tenths)) if abs(value * 10 - tenths) < 1e-6 else None
    if line.command is not None and letter in line.command.takes and (known is None or not known.companion):
        return None
    if known is None:
        raise Refusal(codes.UNKNOWN_CODE.at(where, code=f"{letter}{value:g}"))
    return known


def _take_code(line: Command, rule: CodeRule, where: Span, has_laser: bool) -> None:
    command = line.command
    if rule.companion:
        if command is not None and "L" in command.takes and rule.letter == "L" and has_laser:
            what = f"{rule.text} after {command.text}: a laser power or a distance mode"
            raise Refusal(codes.UNSUPPORTED_CODE.at(where, code=what))
        if rule in line.companions:
            raise Refusal(codes.REPEATED_WORD.at(where, letter=rule.text))
        line.companions.append(rule)
    elif command is not None:
        raise Refusal(codes.MULTIPLE_COMMANDS.at(where, first=command.text, second=rule.text))
    else:
        line.command = rule
    line.rules.append(rule)
    line.code_spans.append(where)


def _check_words(line: Command) -> None:
    """Every word has somebody who takes it."""
    command = line.command
    for letter in line.values:
        if command is None:
            if letter in "FSPHT" or letter in AXIS_LETTERS or letter in "IJKR":
                continue
        elif letter in command.takes or (command.uses_axes and letter in AXIS_LETTERS):
            continue
        raise Refusal(codes.UNUSED_WORD.at(line.where(letter), word=letter))
    if command is not None:
        for letter in command.needs:
            if letter not in line.values:
                raise Refusal(codes.WORD_MISSING.at(line.where_code(command), code=command.text, needed=letter))
        for letter, least, most in command.ranges:
            value = line.values.get(letter, least)
            if not isinstance(value, Unknown) and not least <= value <= most:
                allowed = f"{least:g} or more" if most == math.inf else f"{least:g} to {most:g}"
                raise Refusal(
                    codes.PARAMETER_RANGE.at(line.where(letter), code=command.text, word=letter, allowed=allowed)
                )


def is_number(value: Value) -> bool:
    """Whether a value is known and whole."""
    return not isinstance(value, Unknown)


def measure_behind(words: Words) -> int:
    """Where an M37 starts after a move on one line (G31: a tool that touches its switch is measured at once), or 0."""
    for n, (letter, value, _) in enumerate(words):
        if n and letter == "M" and value == 37.0:
            before = [v for k, v, _ in words[:n] if k == "G"]
            return n if 31.0 in before and (0.0 in before or 1.0 in before) else 0
    return 0


def judge_line(rules: LanguageRules, columns: dict[str, int], span: Span, words: Words) -> None:
    """Refusal for a line that means nothing by itself, the line after a measure included."""
    behind = measure_behind(words)
    for part in (words[:behind], words[behind:]) if behind else (words,):
        _judge_part(rules, columns, span, part)


def _judge_part(rules: LanguageRules, columns: dict[str, int], span: Span, words: Words) -> None:
    """Refusal as when the line runs; for axes next to a stored place too, where a sign may say more than it does."""
    line = gather(rules, columns, span, words, has_laser=False)
    command = line.command
    stored = line.values.keys() & set("PHT")
    if command is not None and command.function in (F.OUTPUT_ON, F.OUTPUT_OFF) and not line.values.keys() & set("CD"):
        raise Refusal(codes.WORD_MISSING.at(span, code=command.text, needed="C"))
    moves = command is None or command.function in (F.TRAVERSE, F.FEED, F.MACHINE_TRAVERSE)
    if stored and moves and line.values.keys() & set("XYZWUVABC"):
        raise Refusal(codes.UNSUPPORTED_CODE.at(span, code="axes together with a stored position"))
