"""Lines of controllers that run DIN 66025 blocks with Pascal inside (McuWIN): gathered, judged, and executed in order.

A line may have several codes, each with the words after it. Modes, F, S, T and D act before the line's motion wherever
they are; what would make another path if it acted after it is not modelled there. G04 and M codes act before the
motion where they come before its words, otherwise after it. What a line without a code goes on with, the frontend
decides in source order (3.1). Source: APCI-8001 G-code manual, McuWIN V 2.5.3.133.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gproof.ir import codes, modal_groups
from gproof.ir.finding import Refusal, Span
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.core.axis_words import letters_of
from gproof.passes.interpret.mcuwin import modes as din_modes
from gproof.passes.interpret.mcuwin import moves as din_motion
from gproof.passes.interpret.mcuwin import outputs_and_waits as din_events
from gproof.passes.interpret.mcuwin import zero_offsets as din_origins
from gproof.passes.interpret.mcuwin.parts import Gathered, Part, Words, gather
from gproof.passes.interpret.mcuwin.state import din_of

if TYPE_CHECKING:
    from gproof.passes.interpret.mcuwin.state import McuWinRun

_LATER = frozenset((
    F.DWELL, F.STOP, F.OPTIONAL_STOP, F.END, F.END_RESET, F.SPINDLE_CW, F.SPINDLE_CCW, F.SPINDLE_OFF, F.TOOL_CHANGE,
    F.FLOOD_ON, F.COOLANT_OFF, F.OUTPUT_ON, F.OUTPUT_OFF, F.OUTPUT_WORD, F.APPLICATION, F.DEVICE, F.SAVE_VARIABLE,
    F.RESTORE_VARIABLE, F.HOME,
))  # fmt: skip
"""Functions of codes that act where they are, before the motion or after it."""
_ENDS = (F.END, F.END_RESET)


def run_line(
    run: McuWinRun, span: Span, words: Words, *, bare: frozenset[str] = frozenset(), continued: str = "",
    distances: str = "",
) -> None:  # fmt: skip
    """Execute one line; a Refusal inside it becomes a finding.

    continued, distances: what the order of the source decides, see ``ir.program.Block``.
    """
    if distances:
        run.modal.absolute = distances == "G90"
    columns = letters_of(run.machine)
    try:
        line = gather(run.program.rules, run.machine, columns, span, words, bare)
        _execute(run, line, continued)
    except Refusal as refusal:
        finding = run.as_accepted(refusal.finding)
        refused_lines.refuse_words(run, words, columns, refusal, finding)
        run.refuse(finding)


def _execute(run: McuWinRun, line: Gathered, continued: str) -> None:
    motion = _continued(run, line, continued)
    earlier: list[Part] = []
    later: list[Part] = []
    for part in line.parts:
        assert part.rule is not None
        if part.rule.function not in _LATER:
            _judge_place(run, line, part, motion)
            continue
        (earlier if part.at < line.moves_from and motion is not None else later).append(part)
    for part in earlier:
        assert part.rule is not None
        if part.rule.function in _ENDS:
            what = f"{part.rule.text} in front of a move in one line"
            raise Refusal(codes.UNSUPPORTED_CODE.at(part.code_span(), code=what))
    settings = line.settings
    assert settings is not None
    # Units and modes first: the F of the line has the unit that the codes before it have chosen.
    asked = ""
    for part in line.parts:
        assert part.rule is not None
        if part.rule.function not in _LATER:
            counts = run.modal.unit, run.modal.own.time_unit
            _handle(run, part)
            if part.at > line.feed_at and counts != (run.modal.unit, run.modal.own.time_unit):
                asked = part.rule.text
    for letter in line.order:
        din_events.SETTINGS[letter](run, settings)
    if asked:
        run.modal.own = run.modal.own.but(asked=asked)
    for part in earlier:
        _handle(run, part)
    if motion is not None:
        din_motion.move(run, line.motion, motion)
    for part in later:
        _handle(run, part)


def _handle(run: McuWinRun, part: Part) -> None:
    rule = part.rule
    assert rule is not None
    has_axes = bool(part.axes())
    if refused_lines.is_lost(run, rule, has_axes, part.span):
        return
    HANDLERS[rule.function](run, part, rule)
    refused_lines.restate(run, (rule,), has_axes)


def _judge_place(run: McuWinRun, line: Gathered, part: Part, motion: CodeRule | None) -> None:
    """Refusal GP113 for a mode after the words of a move, where acting after it would make another path."""
    s, rule = run.modal, part.rule
    assert rule is not None
    if motion is None or part.at < line.words_from:
        return
    function = rule.function
    same = (
        (function is F.ABSOLUTE and s.absolute and not s.own.mode_open)
        or (function is F.INCREMENTAL and not s.absolute and not s.own.mode_open)
        or (function is F.UNITS_MM and s.unit == 1.0)
        or (function is F.REFLECT_OFF and not s.own.reflected)
        or (function is F.COMPENSATION_OFF and not s.own.side)
        or (function is F.SPLINE_OFF and not s.own.spline)
        or function in (F.ZERO_OFFSET_READ, F.FEED_PER_MINUTE, F.SPINDLE_RPM)
    )
    if not same:
        what = f"{rule.text} after the words of a move"
        raise Refusal(codes.UNSUPPORTED_CODE.at(part.code_span(), code=what))


def _continued(run: McuWinRun, line: Gathered, continued: str) -> CodeRule | None:
    """The motion code of a line, its own or the one that goes on; None: nothing moves. Refusal GP113 or GP202."""
    motion = line.motion
    if motion.rule is not None:
        return motion.rule
    if not motion.values:
        return None
    if modal_groups.MOTION in run.modal.unknown_modes:
        return refused_lines.LOST_MOTION
    others = [part.rule for part in line.parts if part.rule is not None and part.rule.letter == "G"]
    keeps = din_of(run.machine).keeps_over_codes and not any(rule.function is F.DWELL for rule in others)
    if continued == "?" or (others and not keeps):
        why = f"{others[0].text} on their line" if others else "another command comes before them"
        what = f"axis words with {why} (the manual does not say whether the last motion goes on, 3.1)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(motion.span, code=what))
    if not continued:
        raise Refusal(codes.AXIS_WORDS_UNUSED.at(motion.span, why="no command is active"))
    rule = run.program.rules.codes[continued[0], int(continued[1:]) * 10]
    if rule.function is F.ZERO_OFFSET_SET:
        for letter in "IJK":
            if letter in motion.values:
                raise Refusal(codes.UNUSED_WORD.at(motion.where(letter), word=letter))
        run.findings.add(codes.MAINTAINED_OFFSET.at(motion.span, code=rule.text))
        din_origins.zero_offset(run, motion, rule)
        return None
    return rule


HANDLERS = {**din_origins.HANDLERS, **din_events.HANDLERS, **din_modes.HANDLERS}
"""What each function does: (run, part, rule)."""
