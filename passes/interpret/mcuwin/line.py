"""Lines of controllers that run DIN 66025 blocks with Pascal inside (McuWIN): gathered, judged, and executed in order.

A line may have several codes, each with the words behind it. Modes, F, S, T and D act before the line's motion wherever
they stand; what would make another path if it acted behind it is not modelled there. G04 and M codes act before the
motion where they stand in front of its words, else behind it. What a line without a code goes on with, the frontend
decides in source order (3.1). Source: APCI-8001 G-code manual, McuWIN V 2.5.3.133.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from gproof.ir import codes, modal_groups
from gproof.ir.dialects.mcuwin import COOLANT, MOTION, SPINDLE, USER, has_code
from gproof.ir.dialects.mcuwin_settings import FIRST_USER_CODE, LAST_USER_CODE
from gproof.ir.finding import Refusal, Span
from gproof.ir.program import PARAMETER
from gproof.ir.record import field, record
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import Unknown, Value, beyond
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.core.parsed_line import LARGEST, Line
from gproof.passes.interpret.mcuwin import modes as din_modes
from gproof.passes.interpret.mcuwin import moves as din_motion
from gproof.passes.interpret.mcuwin import outputs_and_waits as din_events
from gproof.passes.interpret.mcuwin import zero_offsets as din_origins
from gproof.passes.interpret.mcuwin.state import din_of
from gproof.passes.interpret.wincnc.state import letters_of

if TYPE_CHECKING:
    from gproof.passes.interpret.eding.moves import Motion

Words = Sequence[tuple[str, Value, Span]]
_LATER = frozenset((
    F.DWELL, F.STOP, F.OPTIONAL_STOP, F.END, F.END_RESET, F.SPINDLE_CW, F.SPINDLE_CCW, F.SPINDLE_OFF, F.TOOL_CHANGE,
    F.FLOOD_ON, F.COOLANT_OFF, F.OUTPUT_ON, F.OUTPUT_OFF, F.OUTPUT_WORD, F.APPLICATION, F.DEVICE, F.SAVE_VARIABLE,
    F.RESTORE_VARIABLE, F.HOME,
))  # fmt: skip
"""Functions of codes that act where they stand, before the motion or behind it."""
_ENDS = (F.END, F.END_RESET)
_NAMES_AXES = (F.INTERPOLATION_AXES, F.HOME, F.APPLICATION)
"""Functions of codes behind which a letter may stand alone."""


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

    moves_from, words_from: places of the first word of the motion, its code counted in or not, among the line's words;
    feed_at: that of F.
    """

    motion: Part
    parts: list[Part] = field(default_factory=list)
    settings: Part | None = None
    moves_from: int = 1 << 30
    words_from: int = 1 << 30
    feed_at: int = 1 << 30
    order: list[str] = field(default_factory=list)


def run(
    ex: Motion, span: Span, words: Words, *, bare: frozenset[str] = frozenset(), continued: str = "",
    distances: str = "",
) -> None:  # fmt: skip
    """Execute one line; a Refusal inside it becomes a finding.

    continued, distances: what the order of the source decides, see ``ir.program.Block``.
    """
    if distances:
        ex.modal.absolute = distances == "G90"
    columns = letters_of(ex.machine)
    try:
        line = _gather(ex, columns, span, words, bare)
        _execute(ex, line, continued)
    except Refusal as refusal:
        finding = ex.as_accepted(refusal.finding)
        refused_lines.refuse_words(ex, words, columns, refusal, finding)
        ex._refuse(finding)


def _gather(ex: Motion, columns: dict[str, int], span: Span, words: Words, bare: frozenset[str]) -> Gathered:
    """Words by the code they belong to; Refusal with GP109, GP112, GP113, GP121, GP228, GP232 or GP296."""
    line = Gathered(Part(span, columns=columns), settings=Part(span, columns=columns))
    assert line.settings is not None
    owner: Part | None = None
    for at, (letter, value, where) in enumerate(words):
        if not isinstance(value, Unknown) and abs(value) > LARGEST:
            raise Refusal(codes.ARITHMETIC.at(where, what=beyond(letter, value)))
        if letter in "GM":
            rule = _code(ex, letter, value, where)
            part = Part(span, columns=columns, rule=rule, rules=[rule], code_spans=[where], bare=bare, at=at)
            if rule.group != MOTION:
                _no_second(ex, line, part)
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
        _no_stolen(ex, line, part)
        for letter in part.rule.needs:
            if letter not in part.values:
                needed = "a number" if letter == PARAMETER else letter
                raise Refusal(codes.WORD_MISSING.at(part.code_span(), code=part.rule.text, needed=needed))
    return line


def _no_chosen_axes(rule: CodeRule, letter: str, where: Span) -> None:
    """Refusal GP113 for ``G154 X``: "for any number of axes" (3.34) may name them so, and shows no form that does."""
    if rule.function is F.ZERO_OFFSET_RESTORE:
        what = f"{rule.text} with the letter {letter} alone (whether letters choose its axes is not documented)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(where, code=what))


_ACTS_ON = {"spindle_cw": SPINDLE, "spindle_ccw": SPINDLE, "spindle_off": SPINDLE, "coolant_on": COOLANT,
            "coolant_off": COOLANT, "stop": "stop", "end": "stop"}  # fmt: skip
"""Of what Task 0 does for a code, the group in which one of two counts."""


def _group(ex: Motion, rule: CodeRule) -> str:
    """The group of a code: the manual's, or by what the machine's file says that Task 0 does; "" for none."""
    stated = din_of(ex.machine).task(rule.text)
    own = "" if rule.group == USER else rule.group
    return own if stated is None else _ACTS_ON.get(stated.action, own)


def _no_second(ex: Motion, line: Gathered, part: Part) -> None:
    """Refusal GP113 for two codes of one group, or the same code twice."""
    rule = part.rule
    assert rule is not None
    group = _group(ex, rule)
    for other in line.parts:
        assert other.rule is not None
        if other.rule is rule or (group and _group(ex, other.rule) == group):
            what = f"{other.rule.text} and {rule.text} in one line"
            raise Refusal(codes.UNSUPPORTED_CODE.at(part.code_span(), code=what))


def _no_stolen(ex: Motion, line: Gathered, part: Part) -> None:
    """Refusal GP113 for the words of ``G00 G92 X0``: nothing says which of the two codes they belong to."""
    motion, rule = line.motion.rule, part.rule
    assert rule is not None
    if motion is None or not rule.uses_axes or rule.function is F.INTERPOLATION_AXES or line.motion.values:
        return
    if line.moves_from < part.at and any(letter not in part.bare for letter in part.columns if letter in part.values):
        what = f"axis words behind {motion.text} and {rule.text} (whose they are is not documented)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(part.span, code=what, hint="a line for each code"))


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
        behind = f" behind {rule.text}" if rule is not None else ""
        raise Refusal(codes.UNUSED_WORD.at(where, word=f"a number without a letter{behind}"))
    if letter in "LO":
        raise Refusal(codes.UNUSED_WORD.at(where, word=letter))
    raise Refusal(codes.AXIS_NOT_THERE.at(where, axis=letter))


def _code(ex: Motion, letter: str, value: Value, where: Span) -> CodeRule:
    """The rule of a word with G or M."""
    if isinstance(value, Unknown):
        raise Refusal(codes.UNKNOWN_CONDITION.at(where, cause=value.cause))
    number = round(value)
    if number == value and FIRST_USER_CODE <= number <= LAST_USER_CODE:
        if din_of(ex.machine).tasks is not None and din_of(ex.machine).task(f"{letter}{number}") is None:
            raise Refusal(codes.UNKNOWN_CODE.at(where, code=f"{letter}{number}", hint="[din.task0] declares it"))
        return CodeRule(
            letter=letter, tenths=number * 10, function=F.APPLICATION, group=USER, source="4", uses_axes=True,
            takes=PARAMETER,
        )  # fmt: skip
    known = ex.program.rules.codes.get((letter, number * 10)) if number == value else None
    own = known is not None and has_code(letter, number, din_of(ex.machine).version)
    if not own and din_of(ex.machine).task(f"{letter}{number}") is not None:
        return CodeRule(
            letter=letter, tenths=number * 10, function=F.APPLICATION, group=USER, source="4", takes=PARAMETER
        )
    if known is None or not own:
        raise Refusal(codes.UNKNOWN_CODE.at(where, code=f"{letter}{value:g}"))
    return known


def _execute(ex: Motion, line: Gathered, continued: str) -> None:
    motion = _continued(ex, line, continued)
    earlier: list[Part] = []
    later: list[Part] = []
    for part in line.parts:
        assert part.rule is not None
        if part.rule.function not in _LATER:
            _judge_place(ex, line, part, motion)
            continue
        (earlier if part.at < line.moves_from and motion is not None else later).append(part)
    for part in earlier:
        assert part.rule is not None
        if part.rule.function in _ENDS:
            what = f"{part.rule.text} in front of a move in one line"
            raise Refusal(codes.UNSUPPORTED_CODE.at(part.code_span(), code=what))
    settings = line.settings
    assert settings is not None
    # Units and modes first: the F of the line counts in what the codes in front of it have chosen.
    asked = ""
    for part in line.parts:
        assert part.rule is not None
        if part.rule.function not in _LATER:
            counts = ex.modal.unit, ex.modal.din.time_unit
            _handle(ex, part)
            if part.at > line.feed_at and counts != (ex.modal.unit, ex.modal.din.time_unit):
                asked = part.rule.text
    for letter in line.order:
        din_events.SETTINGS[letter](ex, settings)
    if asked:
        ex.modal.din = ex.modal.din.but(asked=asked)
    for part in earlier:
        _handle(ex, part)
    if motion is not None:
        din_motion.move(ex, line.motion, motion)
    for part in later:
        _handle(ex, part)


def _handle(ex: Motion, part: Part) -> None:
    rule = part.rule
    assert rule is not None
    has_axes = bool(part.axes())
    if refused_lines.is_lost(ex, rule, has_axes, part.span):
        return
    HANDLERS[rule.function](ex, part, rule)
    refused_lines.restate(ex, (rule,), has_axes)


def _judge_place(ex: Motion, line: Gathered, part: Part, motion: CodeRule | None) -> None:
    """Refusal GP113 for a mode behind the words of a move, where acting behind it would make another path."""
    s, rule = ex.modal, part.rule
    assert rule is not None
    if motion is None or part.at < line.words_from:
        return
    function = rule.function
    same = (
        (function is F.ABSOLUTE and s.absolute and not s.din.mode_open)
        or (function is F.INCREMENTAL and not s.absolute and not s.din.mode_open)
        or (function is F.UNITS_MM and s.unit == 1.0)
        or (function is F.REFLECT_OFF and not s.din.reflected)
        or (function is F.COMPENSATION_OFF and not s.din.side)
        or (function is F.SPLINE_OFF and not s.din.spline)
        or function in (F.ZERO_OFFSET_READ, F.FEED_PER_MINUTE, F.SPINDLE_RPM)
    )
    if not same:
        what = f"{rule.text} behind the words of a move"
        raise Refusal(codes.UNSUPPORTED_CODE.at(part.code_span(), code=what))


def _continued(ex: Motion, line: Gathered, continued: str) -> CodeRule | None:
    """The motion code of a line, its own or the one that goes on; None: nothing moves. Refusal GP113 or GP202."""
    motion = line.motion
    if motion.rule is not None:
        return motion.rule
    if not motion.values:
        return None
    if modal_groups.MOTION in ex.modal.unknown_modes:
        return refused_lines.LOST_MOTION
    others = [part.rule for part in line.parts if part.rule is not None and part.rule.letter == "G"]
    keeps = din_of(ex.machine).keeps_over_codes and not any(rule.function is F.DWELL for rule in others)
    if continued == "?" or (others and not keeps):
        why = f"{others[0].text} on their line" if others else "another command before them"
        what = f"axis words with {why} (whether the last motion goes on is not documented, 3.1)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(motion.span, code=what))
    if not continued:
        raise Refusal(codes.AXIS_WORDS_UNUSED.at(motion.span, why="no command is in force"))
    rule = ex.program.rules.codes[continued[0], int(continued[1:]) * 10]
    if rule.function is F.ZERO_OFFSET_SET:
        for letter in "IJK":
            if letter in motion.values:
                raise Refusal(codes.UNUSED_WORD.at(motion.where(letter), word=letter))
        ex.findings.add(codes.MAINTAINED_OFFSET.at(motion.span, code=rule.text))
        din_origins.zero_offset(ex, motion, rule)
        return None
    return rule


HANDLERS = {**din_origins.HANDLERS, **din_events.HANDLERS, **din_modes.HANDLERS}
"""What each function does: (run, part, rule)."""
