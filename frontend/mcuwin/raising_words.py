"""The words of a McuWIN line by the code that each belongs to. Sections are those of the manual of V 2.5.3.133."""

from __future__ import annotations

from collections.abc import Sequence

from gproof.frontend.common.raising import Unraisable
from gproof.frontend.common.raising_modes import LineWord
from gproof.ir.dialects.mcuwin.rules import COOLANT, MOTION, SPINDLE, USER, has_code
from gproof.ir.dialects.mcuwin.settings import FIRST_USER_CODE, LAST_USER_CODE, McuWinSettings
from gproof.ir.program import PARAMETER
from gproof.ir.record import field, record
from gproof.ir.rules import CodeRule, LanguageRules
from gproof.ir.rules import Function as F

CENTERS = "IJK"
SETTINGS = "FSTD"
NAMES_AXES = (F.INTERPOLATION_AXES, F.HOME, F.APPLICATION)
"""Functions of codes after which an axis letter may come without a number (3.20, 3.23)."""
ACTS_ON = {"spindle_cw": SPINDLE, "spindle_ccw": SPINDLE, "spindle_off": SPINDLE, "coolant_on": COOLANT,
           "coolant_off": COOLANT, "stop": "stop", "end": "stop"}  # fmt: skip
"""Of what Task 0 does for a code, the group in which one of two counts."""


@record(slots=True)
class Part:
    """A code with its words. at: its place among the words of the line."""

    rule: CodeRule
    at: int
    values: dict[str, LineWord] = field(default_factory=dict)


@record(slots=True)
class Gathered:
    """A line. motion: its code of motion; moves: words that move; parts: other codes, in order; settings: F, S, T, D,
    in order; moves_from, words_from: place of the first word of the motion, its code included or not; feed_at: of F.
    """

    motion: CodeRule | None = None
    moves: dict[str, LineWord] = field(default_factory=dict)
    parts: list[Part] = field(default_factory=list)
    settings: dict[str, LineWord] = field(default_factory=dict)
    moves_from: int = 1 << 30
    words_from: int = 1 << 30
    feed_at: int = 1 << 30


def gather(rules: LanguageRules, din: McuWinSettings, columns: dict[str, int], words: Sequence[LineWord]) -> Gathered:
    """Words by the code they belong to; Unraisable where the manual does not say which that is, or for a mistake."""
    line = Gathered()
    owner: Part | None = None
    for at, word in enumerate(words):
        if word.letter in "GM":
            rule = _code(rules, din, word)
            if rule.group == MOTION:
                if line.motion is not None:
                    raise Unraisable(f"{line.motion.text} and {rule.text} in one line", "which counts is open (3)")
                line.motion, line.moves_from, owner = rule, min(line.moves_from, at), None
                continue
            owner = Part(rule, at)
            _no_second(din, line, owner)
            line.parts.append(owner)
            continue
        takes = _taker(line, owner, columns, word.letter)
        if word.bare and not (owner is not None and takes is owner.values and owner.rule.function in NAMES_AXES):
            raise Unraisable(f"{word.letter} without a number", "the language does not have it here")
        if word.letter in takes:
            raise Unraisable(f"{word.letter} twice in a line", "which of them counts is open")
        takes[word.letter] = word
        if takes is line.moves:
            line.moves_from, line.words_from = min(line.moves_from, at), min(line.words_from, at)
        elif word.letter == "F" and takes is line.settings:
            line.feed_at = at
    for part in line.parts:
        _no_stolen(line, part, columns)
        for letter in part.rule.needs:
            if letter not in part.values:
                raise Unraisable(part.rule.text, "its number is missing" if letter == PARAMETER else f"no {letter}")
    return line


def _code(rules: LanguageRules, din: McuWinSettings, word: LineWord) -> CodeRule:
    """The rule of a code: the manual's, or one of the application (4)."""
    if word.number is None:
        raise Unraisable(f"{word.letter} with a computed number", "which code it is, is not known")
    number, name = round(word.number), f"{word.letter}{word.number:g}"
    stated = din.task(name) is not None
    if FIRST_USER_CODE <= number <= LAST_USER_CODE and not (din.tasks is not None and not stated):
        return CodeRule(
            letter=word.letter, tenths=number * 10, function=F.APPLICATION, group=USER, source="4", uses_axes=True,
            takes=PARAMETER,
        )  # fmt: skip
    known = rules.codes.get((word.letter, number * 10))
    if known is not None and has_code(word.letter, number, din.version):
        return known
    if stated:
        return CodeRule(
            letter=word.letter, tenths=number * 10, function=F.APPLICATION, group=USER, source="4", takes=PARAMETER
        )
    raise Unraisable(name, "the language has no such code")


def _group(din: McuWinSettings, rule: CodeRule) -> str:
    stated = din.task(rule.text)
    own = "" if rule.group == USER else rule.group
    return own if stated is None else ACTS_ON.get(stated.action, own)


def _no_second(din: McuWinSettings, line: Gathered, part: Part) -> None:
    group = _group(din, part.rule)
    for other in line.parts:
        if other.rule == part.rule or (group and _group(din, other.rule) == group):
            raise Unraisable(f"{other.rule.text} and {part.rule.text} in one line", "which of them counts is open (3)")


def _no_stolen(line: Gathered, part: Part, columns: dict[str, int]) -> None:
    """``G00 G92 X0``: whose word X is, the manual does not say."""
    if line.motion is None or not part.rule.uses_axes or part.rule.function is F.INTERPOLATION_AXES or line.moves:
        return
    if line.moves_from < part.at and any(letter in columns and not w.bare for letter, w in part.values.items()):
        what = f"axis words after {line.motion.text} and {part.rule.text}"
        raise Unraisable(what, "which of the two codes they belong to is open (3.1)")


def _taker(line: Gathered, owner: Part | None, columns: dict[str, int], letter: str) -> dict[str, LineWord]:
    """The words among which one belongs."""
    if owner is not None:
        rule = owner.rule
        own = letter in rule.takes or (rule.uses_axes and letter in columns)
        if own or rule.group == USER:
            return owner.values
    if letter in columns or letter in CENTERS:
        return line.moves
    if letter in SETTINGS:
        return line.settings
    if letter == PARAMETER:
        raise Unraisable("a number without a letter", "no code takes it")
    raise Unraisable(f"{letter} in this line", "no code of the line takes it")
