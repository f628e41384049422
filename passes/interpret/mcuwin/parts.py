"""A line of DIN 66025 as words by the code they belong to, judged by itself (McuWIN 2.2, 3)."""

from __future__ import annotations

from collections.abc import Sequence

from gproof.ir import codes
from gproof.ir.dialects.mcuwin.rules import COOLANT, MOTION, SPINDLE, USER, has_code
from gproof.ir.dialects.mcuwin.settings import FIRST_USER_CODE, LAST_USER_CODE
from gproof.ir.finding import Refusal, Span
from gproof.ir.machine import Machine
from gproof.ir.program import PARAMETER
from gproof.ir.record import field, record
from gproof.ir.rules import CodeRule, LanguageRules
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import Unknown, Value, beyond
from gproof.passes.interpret.core.parsed_line import LARGEST, Line
from gproof.passes.interpret.mcuwin.state import din_of

Words = Sequence[tuple[str, Value, Span]]


_NAMES_AXES = (F.INTERPOLATION_AXES, F.HOME, F.APPLICATION)
"""Functions of codes after which a letter may come alone."""


@record(slots=True)
class Part(Line):
    """One code of a line with the words that belong to it.

    columns: of the axis words; bare: letters without numbers; at: place of the code among the line's words.
    """

    rule: CodeRule | None = None
    columns: dict[str, int] = field(default_factory=dict)
    bare: frozenset[str] = frozenset()
    at: int = 0

    def axes(self) -> dict[int, Value]:
        """Values of the axis words by column."""
        return {column: self.values[letter] for letter, column in self.columns.items() if letter in self.values}

    def code_span(self) -> Span:
        """The word of its code."""
        return self.code_spans[0] if self.code_spans else self.span


@record(slots=True)
class Gathered:
    """motion: words that move, with the code of the line or none; parts: other codes in order; settings: F, S, T, D.

    moves_from, words_from: places of the first word of the motion, its code included or not, among the line's words;
    feed_at: that of F.
    """

    motion: Part
    parts: list[Part] = field(default_factory=list)
    settings: Part | None = None
    moves_from: int = 1 << 30
    words_from: int = 1 << 30
    feed_at: int = 1 << 30
    order: list[str] = field(default_factory=list)


def gather(
    rules: LanguageRules, machine: Machine, columns: dict[str, int], span: Span, words: Words, bare: frozenset[str]
) -> Gathered:
    """Words by the code they belong to; Refusal with GP109, GP112, GP113, GP121, GP228, GP232 or GP296."""
    line = Gathered(Part(span, columns=columns), settings=Part(span, columns=columns))
    assert line.settings is not None
    owner: Part | None = None
    for at, (letter, value, where) in enumerate(words):
        if not isinstance(value, Unknown) and abs(value) > LARGEST:
            raise Refusal(codes.ARITHMETIC.at(where, what=beyond(letter, value)))
        if letter in "GM":
            rule = _code(rules, machine, letter, value, where)
            part = Part(span, columns=columns, rule=rule, rules=[rule], code_spans=[where], bare=bare, at=at)
            if rule.group != MOTION:
                _no_second(machine, line, part)
                line.parts.append(part)
                owner = part
                continue
            if line.motion.rule is not None:
                what = f"{line.motion.rule.text} and {rule.text} in one line"
                raise Refusal(codes.UNSUPPORTED_CODE.at(where, code=what))
            line.motion.rule, line.motion.rules, line.motion.code_spans = rule, [rule], [where]
            line.moves_from = min(line.moves_from, at)
            owner = None
            continue
        taker = _taker(line, owner, columns, letter, where)
        if letter in bare and not (taker.rule is not None and taker.rule.function in _NAMES_AXES):
            if letter in columns and owner is not None and owner.rule is not None:
                _no_chosen_axes(owner.rule, letter, where)
            raise Refusal(codes.MISSING_VALUE.at(where, letter=letter))
        if letter in taker.values:
            raise Refusal(codes.REPEATED_WORD.at(where, letter=letter))
        taker.values[letter], taker.spans[letter] = value, where
        if taker is line.motion:
            line.moves_from, line.words_from = min(line.moves_from, at), min(line.words_from, at)
        elif taker is line.settings:
            line.order.append(letter)
            line.feed_at = at if letter == "F" else line.feed_at
    for part in line.parts:
        assert part.rule is not None
        _no_stolen(line, part)
        for letter in part.rule.needs:
            if letter not in part.values:
                needed = "a number" if letter == PARAMETER else letter
                raise Refusal(codes.WORD_MISSING.at(part.code_span(), code=part.rule.text, needed=needed))
    return line


def _no_chosen_axes(rule: CodeRule, letter: str, where: Span) -> None:
    """Refusal GP113 for ``G154 X``: "for any number of axes" (3.34) may name them so, and shows no form that does."""
    if rule.function is F.ZERO_OFFSET_RESTORE:
        what = f"{rule.text} with the letter {letter} alone (the manual does not say whether letters select its axes)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(where, code=what))


_ACTS_ON = {"spindle_cw": SPINDLE, "spindle_ccw": SPINDLE, "spindle_off": SPINDLE, "coolant_on": COOLANT,
            "coolant_off": COOLANT, "stop": "stop", "end": "stop"}  # fmt: skip
"""Of what Task 0 does for a code, the group in which one of two counts."""


def _group(machine: Machine, rule: CodeRule) -> str:
    """The group of a code: the manual's, or by what the machine's file says that Task 0 does; "" for none."""
    stated = din_of(machine).task(rule.text)
    own = "" if rule.group == USER else rule.group
    return own if stated is None else _ACTS_ON.get(stated.action, own)


def _no_second(machine: Machine, line: Gathered, part: Part) -> None:
    """Refusal GP113 for two codes of one group, or the same code twice."""
    rule = part.rule
    assert rule is not None
    group = _group(machine, rule)
    for other in line.parts:
        assert other.rule is not None
        if other.rule is rule or (group and _group(machine, other.rule) == group):
            what = f"{other.rule.text} and {rule.text} in one line"
            raise Refusal(codes.UNSUPPORTED_CODE.at(part.code_span(), code=what))


def _no_stolen(line: Gathered, part: Part) -> None:
    """Refusal GP113 for the words of ``G00 G92 X0``: it is not known which of the two codes they belong to."""
    motion, rule = line.motion.rule, part.rule
    assert rule is not None
    if motion is None or not rule.uses_axes or rule.function is F.INTERPOLATION_AXES or line.motion.values:
        return
    if line.moves_from < part.at and any(letter not in part.bare for letter in part.columns if letter in part.values):
        what = f"axis words after {motion.text} and {rule.text} (the manual does not say which code they belong to)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(part.span, code=what, hint="program one line for each code"))


def _taker(line: Gathered, owner: Part | None, columns: dict[str, int], letter: str, where: Span) -> Part:
    """To whom a word belongs."""
    rule = None if owner is None else owner.rule
    if owner is not None and rule is not None and (letter in rule.takes or (rule.uses_axes and letter in columns)):
        return owner
    if owner is not None and rule is not None and rule.group == USER:
        # Parameters of the application's own code: what they are it alone knows.
        return owner
    if letter in columns or letter in "IJK":
        return line.motion
    if rule is not None and rule.function is F.EFFECTIVE_RADIUS and letter == "D":
        # An axis in the manual's own example (3.17); elsewhere D is a word by itself.
        raise Refusal(codes.AXIS_NOT_THERE.at(where, axis=letter))
    if letter in "FSTD":
        assert line.settings is not None
        return line.settings
    if letter == PARAMETER:
        behind = f" after {rule.text}" if rule is not None else ""
        raise Refusal(codes.UNUSED_WORD.at(where, word=f"a number without a letter{behind}"))
    if letter in "LO":
        raise Refusal(codes.UNUSED_WORD.at(where, word=letter))
    raise Refusal(codes.AXIS_NOT_THERE.at(where, axis=letter))


def _code(rules: LanguageRules, machine: Machine, letter: str, value: Value, where: Span) -> CodeRule:
    """The rule of a word with G or M."""
    if isinstance(value, Unknown):
        raise Refusal(codes.UNKNOWN_CONDITION.at(where, cause=value.cause))
    number = round(value)
    if number == value and FIRST_USER_CODE <= number <= LAST_USER_CODE:
        if din_of(machine).tasks is not None and din_of(machine).task(f"{letter}{number}") is None:
            raise Refusal(codes.UNKNOWN_CODE.at(where, code=f"{letter}{number}", hint="declare it in [din.task0]"))
        return CodeRule(
            letter=letter, tenths=number * 10, function=F.APPLICATION, group=USER, source="4", uses_axes=True,
            takes=PARAMETER,
        )  # fmt: skip
    known = rules.codes.get((letter, number * 10)) if number == value else None
    own = known is not None and has_code(letter, number, din_of(machine).version)
    if not own and din_of(machine).task(f"{letter}{number}") is not None:
        return CodeRule(
            letter=letter, tenths=number * 10, function=F.APPLICATION, group=USER, source="4", takes=PARAMETER
        )
    if known is None or not own:
        raise Refusal(codes.UNKNOWN_CODE.at(where, code=f"{letter}{value:g}"))
    return known
