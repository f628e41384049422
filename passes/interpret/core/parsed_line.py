"""One line of words, gathered and judged by the rules that need no machine state.

Repeats, modal groups, counts and codes: Eding CNC manual 3.2.5 (item repeats), 3.3 (modal groups).
"""

from __future__ import annotations

from collections.abc import Callable

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.program import PARAMETER
from gproof.ir.record import field, record
from gproof.ir.rules import CodeRule, Function, LanguageRules
from gproof.ir.symbolic import AXIS_INDEX, Unknown, Value, beyond, not_known

WordSpan = Callable[[str], Span]
LARGEST = 1e12
"""A word beyond is no number of any machine, and what is made of it could overflow. The line decoder has it too."""

ARGUMENTS = "DEHIJKLPQR"
LETTERS = frozenset("ABCDEFGHIJKLMPQRSTXYZ")


def named(letter: str) -> str:
    """A word in a message: a number after a code has no letter."""
    return "the number" if letter == PARAMETER else letter


@record(slots=True)
class Line:
    """Values of a line by letter; G and M codes by modal group; spans by letter on demand.

    used: argument letters that some code of the line has taken.
    """

    span: Span
    values: dict[str, Value] = field(default_factory=dict)
    spans: dict[str, Span] = field(default_factory=dict)
    rules: list[CodeRule] = field(default_factory=list)
    code_spans: list[Span] = field(default_factory=list)
    used: set[str] = field(default_factory=set)

    def where(self, letter: str) -> Span:
        """The word of a letter, or the line."""
        return self.spans.get(letter, self.span)

    def where_code(self, rule: CodeRule) -> Span:
        """The word of a code; the line when the code is one that stayed active."""
        return self.code_spans[self.rules.index(rule)] if rule in self.rules else self.span

    def find(self, *functions: Function) -> CodeRule | None:
        """The code on this line with one of these functions."""
        for rule in self.rules:
            if rule.function in functions:
                return rule
        return None

    def group(self, name: str) -> CodeRule | None:
        """The code of a modal group on this line."""
        for rule in self.rules:
            if rule.group == name:
                return rule
        return None

    def number(self, letter: str) -> float | None:
        """The known value of a word, None when the word is absent; marks it used.

        Refusal GP225 when its value is unknown.
        """
        self.used.add(letter)
        value = self.values.get(letter)
        if isinstance(value, Unknown):
            raise Refusal(not_known(self.where(letter), named(letter), value))
        return value

    def whole(self, letter: str, tolerance: float) -> int | None:
        """Like ``number`` for a value that must be whole; Refusal GP229."""
        value = self.number(letter)
        if value is None:
            return None
        if abs(value - round(value)) > tolerance:
            raise Refusal(codes.NOT_AN_INTEGER.at(self.where(letter), word=named(letter), value=value))
        return round(value)

    def axes(self) -> dict[int, Value]:
        """Axis words by axis index."""
        return {AXIS_INDEX[k]: v for k, v in self.values.items() if k in AXIS_INDEX}


def gather(rules: LanguageRules, span: Span, words: list[tuple[str, Value, Span]]) -> Line:
    """Words to a Line; Refusal with GP101, GP109 to GP113, GP228 or GP229."""
    line = Line(span)
    m_codes = 0
    for letter, value, where in words:
        if not isinstance(value, Unknown) and abs(value) > LARGEST:
            raise Refusal(codes.ARITHMETIC.at(where, what=beyond(letter, value)))
        if letter in "GM":
            m_codes += letter == "M"
            rule = _code(rules, letter, value, where)
            line.rules.append(rule)
            line.code_spans.append(where)
        elif letter not in LETTERS:
            raise Refusal(codes.SYNTAX.at(where, what=f"this controller has no word {letter}"))
        elif letter in line.values:
            raise Refusal(codes.REPEATED_WORD.at(where, letter=letter))
        else:
            line.values[letter] = value
            line.spans[letter] = where
    _check_groups(line)
    if m_codes > rules.m_codes_in_line:
        raise Refusal(codes.TOO_MANY_M_CODES.at(span, count=m_codes, allowed=rules.m_codes_in_line))
    return line


def _code(rules: LanguageRules, letter: str, value: Value, where: Span) -> CodeRule:
    if isinstance(value, Unknown):
        raise Refusal(codes.UNKNOWN_CONDITION.at(where, cause=value.cause))
    tenths = round(value * 10)
    if letter == "M" and abs(value - round(value)) > rules.integer_tolerance:
        raise Refusal(codes.NOT_AN_INTEGER.at(where, word="M", value=value))
    if abs(value * 10 - tenths) > 10 * rules.integer_tolerance:
        raise Refusal(codes.UNKNOWN_CODE.at(where, code=f"{letter}{value:g}"))
    rule = rules.codes.get((letter, tenths))
    if rule is None and (letter, tenths) in rules.later:
        what = f"{letter}{value:g}, which is not in the manual,"
        raise Refusal(codes.UNSUPPORTED_CODE.at(where, code=what))
    if rule is None:
        raise Refusal(codes.UNKNOWN_CODE.at(where, code=f"{letter}{value:g}"))
    return rule


def _check_groups(line: Line) -> None:
    first: dict[str, CodeRule] = {}
    for rule, where in zip(line.rules, line.code_spans, strict=True):
        if not rule.group:
            continue
        other = first.setdefault(rule.group, rule)
        if other is rule and line.rules.count(rule) == 1:
            continue
        if other is not rule or line.rules.count(rule) > 1:
            raise Refusal(codes.MODAL_GROUP_CONFLICT.at(where, first=other.text, second=rule.text, group=rule.group))


def check_unused(line: Line) -> None:
    """Refusal GP121 for an argument word that no code took."""
    for letter in ARGUMENTS:
        if letter in line.values and letter not in line.used:
            raise Refusal(codes.UNUSED_WORD.at(line.where(letter), word=letter))
