"""WinCNC: outputs, waits, spindle, coolant and tools as operations of a Job.

The language has no codes for a spindle, coolant and tool changes: a shop defines them in CNC.MAC. An output that M3 or
M4 of CNC.MAC switches on and M5 off is the spindle, one that M7 or M8 switches on and M9 off is coolant
(``Program.spindle_outputs``).
Manual: G Codes: G4; L Codes: L101 to L120; M Codes: M11 to M18; Macro File Configuration.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from gproof.frontend.common.raising import Unraisable
from gproof.frontend.wincnc.raising_line import Command, LineRaiser
from gproof.ir.finding import Span
from gproof.ir.job import (
    Choice,
    DwellFor,
    EndJob,
    LeaveRoutine,
    Node,
    PauseJob,
    Quantity,
    Routine,
    RunRoutine,
    ShowText,
    SwitchCoolant,
    SwitchOutput,
    TurnSpindle,
    UseLength,
    WaitFor,
    bodies,
    walk,
)
from gproof.ir.program import Block, BlockTable, Call, Number, Program, Replaced, Statement, Text, parts_of
from gproof.ir.record import field, record
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F

_NAME = re.compile(r"([A-Z])0*(\d+(?:\.\d+)?)")


def name_of(node: Replaced) -> str:
    """The name of the command that CNC.MAC replaces in a line, a code without leading zeros."""
    texts = dict(node.line.texts) if node.line is not None else {}
    written = texts[""].value if "" in texts else node.written
    text = re.sub(r"[ \t+]", "", written).upper()
    found = _NAME.match(text)
    return f"{found.group(1)}{found.group(2)}" if found is not None else text


@record(slots=True)
class Channels:
    """Outputs that are devices. spindle: by channel the direction that it turns, coolant: which one it is."""

    spindle: dict[int, str] = field(default_factory=dict)
    coolant: dict[int, str] = field(default_factory=dict)


def channels_of(program: Program) -> Channels:
    """The outputs of a program that are the spindle or coolant, where each is one alone."""
    found = Channels()
    outputs = program.spindle_outputs
    if len(outputs.forward) == 1 and len(outputs.backward) <= 1 and not set(outputs.forward) & set(outputs.backward):
        found.spindle = dict.fromkeys(outputs.forward, "cw") | dict.fromkeys(outputs.backward, "ccw")
    kinds: dict[int, set[str]] = {}
    for node in every(program):
        if isinstance(node, Replaced) and name_of(node) in ("M7", "M8"):
            kind = "mist" if name_of(node) == "M7" else "flood"
            for channel, on in switched(node.body, program, frozenset()):
                if on and channel in outputs.coolant:
                    kinds.setdefault(channel, set()).add(kind)
    found.coolant = {channel: min(kind) for channel, kind in kinds.items() if len(kind) == 1}
    return found


def every(program: Program) -> Iterator[Statement]:
    """All statements of a program, those within others too."""
    rest: list[Iterable[Statement]] = [program.body, *(sub.body for sub in program.subprograms.values())]
    while rest:
        for node in rest.pop():
            yield node
            rest += parts_of(node)


def switched(body: Iterable[Statement], program: Program, calls: frozenset[str]) -> Iterator[tuple[int, bool]]:
    """(channel, on) that statements and the files that they call switch. calls: files that are looked at already."""
    for node in body:
        if isinstance(node, Call) and node.name in program.subprograms and node.name not in calls:
            yield from switched(program.subprograms[node.name].body, program, calls | {node.name})
        elif isinstance(node, Block):
            words = {word.letter: word.value.value for word in node.words if isinstance(word.value, Number)}
            if words.get("M") in (11.0, 12.0, 13.0, 14.0) and "C" in words:
                yield round(words["C"]), words["M"] in (11.0, 13.0)
        else:
            for part in parts_of(node):
                yield from switched(part, program, calls)


def changes_tool(body: Iterable[Statement], program: Program, calls: frozenset[str] = frozenset()) -> bool:
    """Whether statements say that another tool is in the spindle (L101, L102, L110, L120)."""
    for node in body:
        if isinstance(node, Block):
            codes = [w.value.value for w in node.words if w.letter == "L" and isinstance(w.value, Number)]
            if {101.0, 102.0, 110.0, 120.0} & set(codes):
                return True
        elif isinstance(node, BlockTable):
            continue
        elif isinstance(node, Call) and node.name in program.subprograms and node.name not in calls:
            if changes_tool(program.subprograms[node.name].body, program, calls | {node.name}):
                return True
        elif any(changes_tool(part, program, calls) for part in parts_of(node)):
            return True
    return False


# ---- lines


def dwell(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G4 X: seconds; alone: until the operator goes on, with the comment as a prompt."""
    if rule.letter != "G":
        raise Unraisable(rule.text, "a laser that stays at one place")
    value = line.value("X")
    if value is None:
        text = strip_signs(line.comment)
        shown: list[Node] = [ShowText(kind="msg", parts=(Text(text, line.span),), span=line.span)] if text else []
        return [*shown, PauseJob(span=line.span)]
    return [DwellFor(time=Quantity(value, "s"), span=line.span)]


def strip_signs(text: str) -> str:
    """A comment without what starts and ends it."""
    found = text.strip()
    closing = {"[": "]", "(": ")"}.get(found[:1])
    if closing is None:
        return found[1:].strip() if found[:1] in "%;" else found
    return found[1:].removesuffix(closing).strip()


def output(raiser: LineRaiser, line: Command, rule: CodeRule, channels: Channels) -> list[Node]:
    """M11 to M14: an output on or off; M13 and M14 without a stop."""
    channel = line.value("C")
    if channel is None or "D" in line.words:
        raise Unraisable(f"{rule.text} with D", "drills of a bank")
    on = rule.function in (F.OUTPUT_ON, F.OUTPUT_ON_MOVING)
    moving = rule.function in (F.OUTPUT_ON_MOVING, F.OUTPUT_OFF_MOVING)
    number = round(channel.value) if isinstance(channel, Number) else None
    torch = raiser.controls.torch
    if torch is not None and number in (None, torch.output):
        raise Unraisable(f"{rule.text} of the torch", "torch height control moves Z")
    if number in channels.spindle:
        return [TurnSpindle(direction=channels.spindle[number] if on else "off", span=line.span)]
    if number in channels.coolant:
        return [_coolant(channels.coolant[number], on, line.span)]
    if not on and number in raiser.program.spindle_outputs.coolant:
        # Which of both it is, no line of the job says: that it is off is all that counts.
        return [SwitchCoolant(mist=False, flood=False, span=line.span)]
    return [SwitchOutput(channel=channel, value=Number(float(on), line.span), moving=moving, span=line.span)]


def _coolant(kind: str, on: bool, span: Span) -> SwitchCoolant:
    return SwitchCoolant(mist=on if kind == "mist" else None, flood=on if kind == "flood" else None, span=span)


def wait(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """M17 and M18: until an input is on or off."""
    channel = line.words["C"].value
    return [WaitFor(channel=channel, on=rule.function is F.WAIT_ON, span=line.span)]


def speed(raiser: LineRaiser, line: Command) -> list[Node]:
    """S alone."""
    if "spinmac" in (raiser.controls.devices or ()):
        raise Unraisable("S with spindle=T2", "it runs SPIN.MAC")
    return [TurnSpindle(direction="speed", speed=Quantity(line.words["S"].value, "rpm"), span=line.span)]


# ---- what a shop's definitions run

FEW = 3


def inlined(nodes: list[Node], routines: dict[str, Routine]) -> list[Node]:
    """A file of a few operations in place of its call, where a line that CNC.MAC replaces calls it."""
    if len(nodes) != 1 or not isinstance(nodes[0], RunRoutine) or nodes[0].arguments:
        return together(nodes)
    body = routines[nodes[0].name].body
    plain = all(type(node) in _PLAIN for node in body)
    return together(body) if plain and len(body) <= FEW else nodes


def together(body: Iterable[Node]) -> list[Node]:
    """Mist and flood that are switched off one right after the other, as one operation."""
    found: list[Node] = []
    for node in body:
        before = found[-1] if found else None
        if isinstance(before, SwitchCoolant) and isinstance(node, SwitchCoolant) and _is_off(before) and _is_off(node):
            mist = False if False in (before.mist, node.mist) else None
            flood = False if False in (before.flood, node.flood) else None
            found[-1] = SwitchCoolant(mist=mist, flood=flood, span=before.span)
        else:
            found.append(node)
    return found


_PLAIN = frozenset((DwellFor, SwitchCoolant, SwitchOutput, TurnSpindle, WaitFor))


def left_by(nodes: Iterable[Node], routines: dict[str, Routine], span: Span) -> list[Node]:
    """Spindle, coolant and tool length as a tool change leaves them.

    What it switches off only where another tool was in the spindle goes with the change itself. Unraisable where what
    it leaves on hangs on a condition.
    """
    found: dict[str, tuple[Node, bool]] = {}
    _follow(nodes, routines, found, maybe=False)
    kept = []
    for name, (node, maybe) in found.items():
        if not maybe:
            kept.append(node)
        elif not _is_off(node):
            raise Unraisable("a tool change", f"whether it leaves {name} on hangs on a condition")
    return kept


def _is_off(node: Node) -> bool:
    if isinstance(node, TurnSpindle):
        return node.direction == "off"
    return isinstance(node, SwitchCoolant) and True not in (node.mist, node.flood)


def _device(node: Node) -> str:
    """What an operation switches, "" for another one."""
    if isinstance(node, TurnSpindle):
        return "the speed" if node.direction == "speed" else "the spindle"
    if isinstance(node, SwitchCoolant):
        return "mist" if node.mist is not None else "flood"
    return "the tool length" if isinstance(node, UseLength) else ""


def _follow(
    nodes: Iterable[Node], routines: dict[str, Routine], found: dict[str, tuple[Node, bool]], *, maybe: bool
) -> bool:
    """Collect what operations switch; whether they may end before their last one."""
    for node in nodes:
        name = _device(node)
        if name:
            before = found.pop(name, None)
            # Off where it was on before, or may have been: the last one that surely counts says it.
            kept = before is not None and maybe and not before[1] and before[0] == node
            found[name] = (node, maybe and not kept)
        if isinstance(node, RunRoutine):
            _follow(routines[node.name].body, routines, found, maybe=maybe)
        for part in bodies(node):
            if not any(isinstance(one, EndJob) for one in part):
                maybe |= _follow(part, routines, found, maybe=maybe or isinstance(node, Choice))
        maybe |= isinstance(node, LeaveRoutine)
    return maybe and any(isinstance(node, LeaveRoutine) for node in walk(tuple(nodes)))
