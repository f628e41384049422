"""Lines of controllers that take one command a line (WinCNC): gathered, judged, and given to what the command does.

A line is at most one command with its words, and companions: distance modes, and what a limit switch does. A line
without a command is the active motion, a feed, or a speed. Source: WinCNC Users Guide, Command Reference.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.accepts import REPEATED_CHANNEL
from gproof.ir.dialects.wincnc_settings import wincnc_settings
from gproof.ir.finding import Refusal, Severity, Span
from gproof.ir.machine import AXES
from gproof.ir.modal_groups import MOVES, PLACE
from gproof.ir.program import Text
from gproof.ir.record import field, record
from gproof.ir.rules import CHECKED_ONLY, LINE_LETTERS, CodeRule, LanguageRules, only_a_macro
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import Unknown, Value, beyond
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.core.parsed_line import LARGEST, Line
from gproof.passes.interpret.wincnc import drilling as single_cycles
from gproof.passes.interpret.wincnc import moves as single_motion
from gproof.passes.interpret.wincnc import outputs_and_waits as single_events
from gproof.passes.interpret.wincnc import work_offsets as single_origins
from gproof.passes.interpret.wincnc.state import letters_of

if TYPE_CHECKING:
    from gproof.passes.interpret.eding.moves import Motion

Words = Sequence[tuple[str, Value, Span]]
Texts = Sequence[tuple[str, Text]]
MEANT_BOTH = (F.ABSOLUTE_ONCE, F.INCREMENTAL_ONCE)
_AXES = "XYZWUVABC"
_MAPPINGS = (F.MAP_WORDS, F.MAP_HEADS, F.MAP_PULSES)


@record(slots=True)
class Command(Line):
    """A line of one command. command: its rule, None for a line without one; columns: of the axis words.

    texts: by letter; comment: behind the words; bare: letters without a number; letters: of a command that maps axes,
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
        elif line.command is not None and line.command.function in _MAPPINGS and letter in columns:
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
            what = f"{rule.text} behind {command.text}: a laser power or a distance mode"
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
            if letter in "FSPHT" or letter in _AXES or letter in "IJKR":
                continue
        elif letter in command.takes or (command.uses_axes and letter in _AXES):
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


def run(
    ex: Motion, span: Span, words: Words, *, texts: Texts = (), comment: str = "", bare: frozenset[str] = frozenset()
) -> None:
    """Execute one line; a Refusal inside it becomes a finding."""
    behind = _measure_behind(words)
    if behind:
        run(ex, span, words[:behind], texts=texts, comment=comment, bare=bare)
        words = words[behind:]
    for part in _channels_apart(ex, words):
        _run_alone(ex, span, part, texts, comment, bare)


def _channels_apart(ex: Motion, words: Words) -> list[Words]:
    """A line that switches several channels as one for each, where the controller takes it so."""
    channels = [word for word in words if word[0] == "C"]
    others = [word for word in words if word[0] != "C"]
    if len(channels) < 2 or [(letter, value) for letter, value, _ in others] not in ([("M", 11.0)], [("M", 12.0)]):
        return [words]
    return [[*others, one] for one in channels] if ex.takes(REPEATED_CHANNEL) else [words]


def _run_alone(ex: Motion, span: Span, words: Words, texts: Texts, comment: str, bare: frozenset[str]) -> None:
    line: Command | None = None
    if ex.modal.line_lost:
        refused_lines.settle(ex.modal)
    devices = wincnc_settings(ex.machine).devices
    try:
        has_laser = devices is not None and "laser" in devices
        line = gather(ex.program.rules, letters_of(ex.machine), span, words, has_laser)
        line.texts, line.comment, line.bare = dict(texts), comment, bare
        _execute(ex, line)
    except Refusal as refusal:
        finding = refusal.finding
        columns = letters_of(ex.machine)
        if finding.code is codes.UNKNOWN_CODE and ex.program.open_codes:
            what = only_a_macro(finding.message.split()[0])
            finding = codes.UNSUPPORTED_CODE.at(finding.span, code=what, hint=ex.program.open_codes)
        name = _open_name(words) if ex.program.open_codes and finding.severity is Severity.ERROR else ""
        if name:
            finding = codes.UNSUPPORTED_CODE.at(span, code=only_a_macro(name), hint=ex.program.open_codes)
            refused_lines.lose_everything(ex, finding)
            ex._refuse(finding)
            return
        finding = ex.as_accepted(finding)
        aim = None if line is None else functools.partial(single_motion.aim, ex, line)
        refused_lines.refuse_words(ex, words, columns, refusal, finding, aim)
        ex._refuse(finding)
    finally:
        if ex.modal.single.absolute_once is not None:
            ex.modal.single = ex.modal.single.but(absolute_once=None)


def _open_name(words: Words) -> str:
    """The name of letters and digits with which a line begins that is none of its words alone; "" where there is none.

    A word of two letters or more (``PARK``, ``TOOL3``), or a letter that begins no line (``Q5``).
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
                if _is_number(value)
                else letter
            )
        name += letter if is_bare else f"{letter}{value:g}" if _is_number(value) else letter
        ends = where.end_column
    return name if len(name) > 1 or name not in LINE_LETTERS + "GLM" else ""


def _is_number(value: Value) -> bool:
    return not isinstance(value, Unknown)


def _measure_behind(words: Words) -> int:
    """Where an M37 begins behind a move on one line (G31: a tool that touches its switch is measured at once), or 0."""
    for n, (letter, value, _) in enumerate(words):
        if n and letter == "M" and value == 37.0:
            before = [v for k, v, _ in words[:n] if k == "G"]
            return n if 31.0 in before and (0.0 in before or 1.0 in before) else 0
    return 0


def _execute(ex: Motion, line: Command) -> None:
    s = ex.modal
    for letter in line.values:
        taken = "" if line.command is None else line.command.takes
        if letter in _AXES and letter not in taken and letter not in line.columns:
            raise Refusal(codes.AXIS_NOT_THERE.at(line.where(letter), axis=letter))
    _judge_companions(ex, line)
    for rule in line.companions:
        if rule.function in (F.ABSOLUTE, F.INCREMENTAL):
            s.absolute = rule.function is F.ABSOLUTE
            s.stated.add("distance")
        elif rule.function in MEANT_BOTH:
            s.single = s.single.but(absolute_once=rule.function is F.ABSOLUTE_ONCE)
    has_axes = bool(line.axes())
    refused_lines.restate(ex, line.companions, has_axes)
    command = line.command
    if command is None:
        single_motion.without_command(ex, line)
        return
    _need_device(ex, line, command)
    _doubt_mapping(ex, line, command)
    if command.function is F.UNSUPPORTED:
        _unsupported(ex, line, command)
        return
    if command.function in CHECKED_ONLY and command.function not in HANDLERS:
        single_events.note(ex, line, command)
        return
    ex.settings.line(command, line.span)
    if s.line_lost and _rests_on_lost(ex, line, command):
        return
    HANDLERS[command.function](ex, line, command)
    refused_lines.restate(ex, (command,), has_axes)


def _rests_on_lost(ex: Motion, line: Command, command: CodeRule) -> bool:
    """Whether a command rests on what a refused line may have changed: it then goes, or sets, nobody knows what."""
    if command.function not in MOVES:
        return refused_lines.is_lost(ex, command, bool(line.axes()), line.span)
    if "F" in line.values:
        single_motion.feed_word(ex, line, set(line.axes()))
    return refused_lines.vague(ex, line, command, machine=command.function is F.MACHINE_TRAVERSE)


def _judge_companions(ex: Motion, line: Command) -> None:
    """Refusal GP113 for two distance modes in a line, and for M28 or M29 beside what is no plain G0 or G1."""
    modes = [rule for rule in line.companions if rule.function in (F.ABSOLUTE, F.INCREMENTAL, *MEANT_BOTH)]
    if len(modes) > 1:
        what = f"{modes[0].text} and {modes[1].text} in one line"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where_code(modes[1]), code=what))
    stops = line.find(F.LIMIT_STOPS_AXIS, F.LIMIT_STOPS_LINE)
    if stops is None:
        return
    s = ex.modal
    if line.command is None:
        other = bool(s.cycle_code) or s.motion in (int(F.ARC_CW), int(F.ARC_CCW))
    else:
        other = line.command.function not in (F.TRAVERSE, F.FEED)
    if other or line.values.keys() & set("PHT"):
        what = f"{stops.text} beside what is no G0 or G1 to a place of its own"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where_code(stops), code=what))


def _doubt_mapping(ex: Motion, line: Command, command: CodeRule) -> None:
    """Refusal GP113 where words that do not move would mean other axes if L11 and L12 changed them too."""
    sources = ex.modal.single.sources
    if command.function in single_motion.MOVES or command.function in _MAPPINGS or not command.uses_axes:
        return
    words = line.axes()
    if words != {axis: words[source] for axis, source in enumerate(sources) if source in words}:
        what = f"{command.text} while L11 or L12 maps its axes (whether the map holds for it is not said)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where_code(command), code=what))


def _need_device(ex: Motion, line: Command, command: CodeRule) -> None:
    """Refusal GP285 for a command to something that the machine's file does not set up."""
    controls = wincnc_settings(ex.machine)
    if controls.devices is None:
        return
    devices = {*controls.devices, *(f"atc{changer.number}" for changer in controls.changers)}
    if command.device and command.device not in devices:
        key = {"atc1": "atc1", "atc2": "atc2", "knife": "knifemode", "saw": "sawmode", "pump": "pumpcont",
               "probe": "scan"}.get(command.device, command.device)  # fmt: skip
        raise Refusal(
            codes.NOT_ENABLED.at(line.where_code(command), code=command.text, device=command.device, key=f"{key}=")
        )


def _unsupported(ex: Motion, line: Command, command: CodeRule) -> None:
    what = f"{command.text} ({command.open})" if command.open else command.text
    finding = codes.UNSUPPORTED_CODE.at(line.where_code(command), code=what)
    refused_lines.lose(ex, {PLACE}, finding, frozenset(line.axes() or range(AXES)))
    ex._fail(finding)


HANDLERS = {
    **single_motion.HANDLERS,
    **single_origins.HANDLERS,
    **single_events.HANDLERS,
    **single_cycles.HANDLERS,
}
"""What each function does: (run, line, rule)."""
