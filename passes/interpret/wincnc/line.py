"""Lines of controllers that take one command a line (WinCNC): gathered, judged, and given to what the command does.

A line is at most one command with its words, and companions: distance modes, and what a limit switch does. A line
without a command is the active motion, a feed, or a speed. Source: WinCNC Users Guide, Command Reference.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.accepts import REPEATED_CHANNEL
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import Refusal, Severity, Span
from gproof.ir.machine import AXES
from gproof.ir.modal_groups import MOVES, PLACE
from gproof.ir.program import Text
from gproof.ir.rules import CHECKED_ONLY, LINE_LETTERS, CodeRule, only_a_macro
from gproof.ir.rules import Function as F
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.core.axis_words import letters_of
from gproof.passes.interpret.wincnc import moves as single_motion
from gproof.passes.interpret.wincnc.axis_targets import aim
from gproof.passes.interpret.wincnc.command import (
    AXIS_LETTERS,
    MAPPINGS,
    MEANT_BOTH,
    Command,
    Words,
    gather,
    is_number,
    measure_behind,
)
from gproof.passes.interpret.wincnc.commands import HANDLERS
from gproof.passes.interpret.wincnc.events import note

if TYPE_CHECKING:
    from gproof.passes.interpret.wincnc.state import WinCncRun

Texts = Sequence[tuple[str, Text]]


def run_line(
    run: WinCncRun,
    span: Span,
    words: Words,
    *,
    texts: Texts = (),
    comment: str = "",
    bare: frozenset[str] = frozenset(),
) -> None:
    """Execute one line; a Refusal inside it becomes a finding."""
    behind = measure_behind(words)
    if behind:
        run_line(run, span, words[:behind], texts=texts, comment=comment, bare=bare)
        words = words[behind:]
    for part in _channels_apart(run, words):
        _run_alone(run, span, part, texts, comment, bare)


def _channels_apart(run: WinCncRun, words: Words) -> list[Words]:
    """A line that switches several channels as one for each, where the controller takes it so."""
    channels = [word for word in words if word[0] == "C"]
    others = [word for word in words if word[0] != "C"]
    if len(channels) < 2 or [(letter, value) for letter, value, _ in others] not in ([("M", 11.0)], [("M", 12.0)]):
        return [words]
    return [[*others, one] for one in channels] if run.takes(REPEATED_CHANNEL) else [words]


def _run_alone(run: WinCncRun, span: Span, words: Words, texts: Texts, comment: str, bare: frozenset[str]) -> None:
    line: Command | None = None
    if run.modal.line_lost:
        refused_lines.settle(run.modal)
    devices = wincnc_settings(run.machine).devices
    try:
        has_laser = devices is not None and "laser" in devices
        line = gather(run.program.rules, letters_of(run.machine), span, words, has_laser)
        line.texts, line.comment, line.bare = dict(texts), comment, bare
        _execute(run, line)
    except Refusal as refusal:
        finding = refusal.finding
        columns = letters_of(run.machine)
        if finding.code is codes.UNKNOWN_CODE and run.program.open_codes:
            what = only_a_macro(finding.message.split()[0])
            finding = codes.UNSUPPORTED_CODE.at(finding.span, code=what, hint=run.program.open_codes)
        name = _open_name(words) if run.program.open_codes and finding.severity is Severity.ERROR else ""
        if name:
            finding = codes.UNSUPPORTED_CODE.at(span, code=only_a_macro(name), hint=run.program.open_codes)
            refused_lines.lose_everything(run, finding)
            run.refuse(finding)
            return
        finding = run.as_accepted(finding)
        where = None if line is None else functools.partial(aim, run, line)
        refused_lines.refuse_words(run, words, columns, refusal, finding, where)
        run.refuse(finding)
    finally:
        if run.modal.own.absolute_once is not None:
            run.modal.own = run.modal.own.but(absolute_once=None)


def _open_name(words: Words) -> str:
    """The name of letters and digits that starts a line and is not one of its words alone; "" where there is none.

    A word of two letters or more (``PARK``, ``TOOL3``), or a letter that starts no line (``Q5``).
    """
    name, ends = "", -1
    for letter, value, where in words:
        if name and where.column != ends:
            break
        is_bare = where.end_column == where.column + 1
        if not name and (not is_bare or not where.column):
            return (
                ""
                if letter in LINE_LETTERS or letter in "GLM"
                else f"{letter}{value:g}"
                if is_number(value)
                else letter
            )
        name += letter if is_bare else f"{letter}{value:g}" if is_number(value) else letter
        ends = where.end_column
    return name if len(name) > 1 or name not in LINE_LETTERS + "GLM" else ""


def _execute(run: WinCncRun, line: Command) -> None:
    s = run.modal
    for letter in line.values:
        taken = "" if line.command is None else line.command.takes
        if letter in AXIS_LETTERS and letter not in taken and letter not in line.columns:
            raise Refusal(codes.AXIS_NOT_THERE.at(line.where(letter), axis=letter))
    _judge_companions(run, line)
    for rule in line.companions:
        if rule.function in (F.ABSOLUTE, F.INCREMENTAL):
            s.absolute = rule.function is F.ABSOLUTE
            s.stated.add("distance")
        elif rule.function in MEANT_BOTH:
            s.own = s.own.but(absolute_once=rule.function is F.ABSOLUTE_ONCE)
    has_axes = bool(line.axes())
    refused_lines.restate(run, line.companions, has_axes)
    command = line.command
    if command is None:
        single_motion.without_command(run, line, HANDLERS)
        return
    _need_device(run, line, command)
    _doubt_mapping(run, line, command)
    if command.function is F.UNSUPPORTED:
        _unsupported(run, line, command)
        return
    if command.function in CHECKED_ONLY and command.function not in HANDLERS:
        note(run, line, command)
        return
    run.settings.line(command, line.span)
    if s.line_lost and _rests_on_lost(run, line, command):
        return
    HANDLERS[command.function](run, line, command)
    refused_lines.restate(run, (command,), has_axes)


def _rests_on_lost(run: WinCncRun, line: Command, command: CodeRule) -> bool:
    """Whether a command rests on what a refused line may have changed: what it moves or sets is not known."""
    if command.function not in MOVES:
        return refused_lines.is_lost(run, command, bool(line.axes()), line.span)
    if "F" in line.values:
        single_motion.feed_word(run, line, set(line.axes()))
    return refused_lines.vague(run, line, command, machine=command.function is F.MACHINE_TRAVERSE)


def _judge_companions(run: WinCncRun, line: Command) -> None:
    """Refusal GP113 for two distance modes in a line, and for M28 or M29 next to what is not a plain G0 or G1."""
    modes = [rule for rule in line.companions if rule.function in (F.ABSOLUTE, F.INCREMENTAL, *MEANT_BOTH)]
    if len(modes) > 1:
        what = f"{modes[0].text} and {modes[1].text} in one line"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where_code(modes[1]), code=what))
    stops = line.find(F.LIMIT_STOPS_AXIS, F.LIMIT_STOPS_LINE)
    if stops is None:
        return
    s = run.modal
    if line.command is None:
        other = bool(s.cycle_code) or s.motion in (int(F.ARC_CW), int(F.ARC_CCW))
    else:
        other = line.command.function not in (F.TRAVERSE, F.FEED)
    if other or line.values.keys() & set("PHT"):
        what = f"{stops.text} together with a code that is not G0 or G1 to a position of its own"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where_code(stops), code=what))


def _doubt_mapping(run: WinCncRun, line: Command, command: CodeRule) -> None:
    """Refusal GP113 where words that do not move would mean other axes if L11 and L12 changed them too."""
    sources = run.modal.own.sources
    if command.function in single_motion.MOVES or command.function in MAPPINGS or not command.uses_axes:
        return
    words = line.axes()
    if words != {axis: words[source] for axis, source in enumerate(sources) if source in words}:
        what = f"{command.text} while L11 or L12 maps its axes (the manual does not say whether the map applies to it)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where_code(command), code=what))


def _need_device(run: WinCncRun, line: Command, command: CodeRule) -> None:
    """Refusal GP285 for a command to something that the machine's file does not set up."""
    controls = wincnc_settings(run.machine)
    if controls.devices is None:
        return
    devices = {*controls.devices, *(f"atc{changer.number}" for changer in controls.changers)}
    if command.device and command.device not in devices:
        key = {"atc1": "atc1", "atc2": "atc2", "knife": "knifemode", "saw": "sawmode", "pump": "pumpcont",
               "probe": "scan"}.get(command.device, command.device)  # fmt: skip
        raise Refusal(
            codes.NOT_ENABLED.at(line.where_code(command), code=command.text, device=command.device, key=f"{key}=")
        )


def _unsupported(run: WinCncRun, line: Command, command: CodeRule) -> None:
    what = f"{command.text} ({command.open})" if command.open else command.text
    finding = codes.UNSUPPORTED_CODE.at(line.where_code(command), code=what)
    refused_lines.lose(run, {PLACE}, finding, frozenset(line.axes() or range(AXES)))
    run.fail(finding)
