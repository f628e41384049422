"""A program without what its machine's macros do besides at codes of devices: at ``M6`` the tool is changed, and its
length counts; at ``M3``, ``M4``, ``M5`` the spindle is switched, at ``M7``, ``M8``, ``M9`` coolant.

For comparing programs of two machines, each of which does these in its own way (CNC.MAC).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any

from gproof.ir.program import (
    Binary,
    Block,
    BlockTable,
    Call,
    Device,
    Expr,
    If,
    Named,
    Number,
    Program,
    Replaced,
    Statement,
    Unary,
    Word,
    parts_of,
)
from gproof.ir.record import record

_CHANGE = re.compile(r"[ \t]*M0*6(?![0-9.])", re.IGNORECASE)
_DEVICE = re.compile(r"[ \t]*M0*[345789](?![0-9.])", re.IGNORECASE)
_TOOL = frozenset((101.0, 102.0, 110.0, 120.0))
"""L codes that say which tool is in a spindle (Command Reference, L Codes)."""
_SWITCHES = (11.0, 12.0, 13.0, 14.0)
_QUIET = frozenset(("M", number) for number in (*_SWITCHES, 17.0, 18.0))
_LENGTH = frozenset((43.0, 49.0))


def plain_devices(program: Program) -> Program:
    """The same program with every ``M6 T#`` of a macro as the machine's own tool change."""
    return replace(
        program, body=_plain(program.body, program),
        subprograms={
            name: replace(sub, body=_plain(sub.body, program)) for name, sub in program.subprograms.items()
        },
    )  # fmt: skip


def _plain(body: tuple[Statement, ...], program: Program) -> tuple[Statement, ...]:
    return tuple(_of(node, program) for node in body)


def _of(node: Statement, program: Program) -> Statement:
    if isinstance(node, Replaced) and _CHANGE.match(node.written) and node.line is not None:
        tool = next((word.value for word in node.line.words if word.letter == "T"), None)
        if tool is not None:
            kept = [_with(block, tool) for block in _settings(node.body, program, frozenset())]
            off = spindle_off(node.body, program)
            values = (tool, *(Number(float(one), node.span) for one in (off.when, *off.channels)))
            rest = (Device(name="own_spindle_off", arguments=values, span=node.span),) if off.channels else ()
            change = Device(name="own_tool_change", arguments=(tool,), span=node.span)
            return replace(node, body=(*rest, *kept, change))
    if isinstance(node, Replaced) and _DEVICE.match(node.written):
        switches = device_switches(node.body, program)
        if switches is not None:
            return replace(node, body=switches)
    changed: dict[str, Any] = {}
    for name in ("then", "otherwise", "body"):
        inner = getattr(node, name, None)
        if isinstance(inner, tuple) and inner and not isinstance(node, BlockTable | Block):
            changed[name] = _plain(inner, program)
    return replace(node, **changed) if changed else node


@record(frozen=True, slots=True)
class SpindleOff:
    """What a tool change does to the spindle. channels: outputs that its macro switches off and not on again; when: see
    ``ALWAYS``, ``OTHER_TOOL``, ``MAYBE``."""

    channels: tuple[int, ...] = ()
    when: int = 0


ALWAYS, OTHER_TOOL, MAYBE = range(3)
"""Whatever the macro meets; where another tool is in the spindle (L110 to L112); where something else says so."""


def spindle_off(body: Iterable[Statement], program: Program) -> SpindleOff:
    """What the macro of a tool change does to the spindle."""
    spindle = {*program.spindle_outputs.forward, *program.spindle_outputs.backward}
    last: dict[int, tuple[bool, int]] = {}
    for on, channel, when in _switched(body, program, frozenset(), ALWAYS):
        if channel in spindle and (on or when == ALWAYS or last.get(channel) != (False, ALWAYS)):
            last[channel] = on, when
    off = {channel: when for channel, (on, when) in sorted(last.items()) if not on}
    return SpindleOff(tuple(off), max(off.values(), default=ALWAYS))


_ON = (11.0, 13.0)
_TOOL_NAMES = frozenset(("T", "TP1", "TP2"))


def _switched(
    body: Iterable[Statement], program: Program, calls: frozenset[str], when: int
) -> Iterator[tuple[bool, int, int]]:
    """(on, output, when) of the lines of a macro and of files that it calls, in their order."""
    for node in body:
        if isinstance(node, Call) and node.name in program.subprograms and node.name not in calls:
            yield from _switched(program.subprograms[node.name].body, program, calls | {node.name}, when)
        elif isinstance(node, BlockTable):
            table = _of_table(node, program, lambda name, value: name == "M")
            yield from _switched(table, program, calls, when)
        elif isinstance(node, Block):
            values = {word.letter: word.value.value for word in node.words if isinstance(word.value, Number)}
            if values.get("M") in _SWITCHES and "C" in values:
                yield values["M"] in _ON, round(values["C"]), when
        else:
            inner = when
            if isinstance(node, If):
                inner = max(when, OTHER_TOOL if _asks_for_tool(node.condition) else MAYBE)
            for part in parts_of(node):
                yield from _switched(part, program, calls, inner)


def _asks_for_tool(condition: Expr) -> bool:
    """Whether a condition only compares the tool of the change with that in the spindle."""
    if isinstance(condition, Unary):
        return _asks_for_tool(condition.operand)
    sides = (condition.left, condition.right) if isinstance(condition, Binary) else ()
    return len(sides) == 2 and all(isinstance(one, Named) and one.name in _TOOL_NAMES for one in sides)


def device_switches(body: Iterable[Statement], program: Program) -> tuple[Block, ...] | None:
    """The lines that switch spindle and coolant, of a macro that only switches outputs and waits; None of another."""
    outputs = program.spindle_outputs
    devices = {*outputs.forward, *outputs.backward, *outputs.coolant}
    found: list[Block] = []
    try:
        for node in _lines(body, program, frozenset()):
            words = {word.letter: word.value.value for word in node.words if isinstance(word.value, Number)}
            if words.get("C") in devices and words.get("M") in _SWITCHES:
                found.append(node)
    except _OtherError:
        return None
    return tuple(found) or None


class _OtherError(Exception):
    """A line that does more than to switch outputs, or to wait."""


def _lines(body: Iterable[Statement], program: Program, calls: frozenset[str]) -> Iterator[Block]:
    """The lines of a macro and of the files that it calls; _OtherError."""
    for node in body:
        if (
            isinstance(node, Call)
            and not node.arguments
            and node.name in program.subprograms
            and node.name not in calls
        ):
            yield from _lines(program.subprograms[node.name].body, program, calls | {node.name})
        elif isinstance(node, Block) and not node.texts and _is_quiet(node):
            yield node
        else:
            raise _OtherError


def _is_quiet(node: Block) -> bool:
    codes = [(w.letter, w.value.value) for w in node.words if w.letter in "GLM" and isinstance(w.value, Number)]
    others = {word.letter for word in node.words} - {"G", "M"}
    if codes == [("G", 4.0)]:
        return others == {"X"}
    return len(codes) == 1 and codes[0] in _QUIET and others == {"C"}


def _settings(body: Iterable[Statement], program: Program, calls: frozenset[str]) -> Iterator[Block]:
    """Lines of a macro, and of files that it calls, that say which tool there is and that its length counts."""
    for node in body:
        if isinstance(node, Call) and node.name in program.subprograms and node.name not in calls:
            yield from _settings(program.subprograms[node.name].body, program, calls | {node.name})
        elif isinstance(node, Block):
            codes = {(w.letter, w.value.value) for w in node.words if isinstance(w.value, Number)}
            if ("T", 0.0) not in codes and any(
                (l == "L" and n in _TOOL) or (l == "G" and n in _LENGTH) for l, n in codes
            ):
                yield node
        elif isinstance(node, BlockTable):
            yield from _of_table(node, program, _says_tool)
        else:
            for part in parts_of(node):
                yield from _settings(part, program, calls)


def _says_tool(name: str, value: float) -> bool:
    """G43, G49, and which tool is in a spindle."""
    return (name == "G" and value in _LENGTH) or (name == "L" and value in _TOOL)


def _of_table(table: BlockTable, program: Program, wanted: Callable[[str, float], bool]) -> Iterator[Block]:
    """Plain lines with a code that is wanted."""
    from gproof.ir.finding import Span

    words, _, _ = program.load(table, table.begin, table.first_line, 1 << 22)
    for line, letter, value in zip(
        words["line"].tolist(), words["letter"].tolist(), words["value"].tolist(), strict=True
    ):
        name = chr(letter)
        if wanted(name, value):
            same = words["line"] == line
            span = Span(program.files[table.file].name, line)
            found = tuple(
                Word(chr(one), Number(number, span), span)
                for one, number in zip(words["letter"][same].tolist(), words["value"][same].tolist(), strict=True)
            )
            yield Block(words=found, assigns=(), span=span)


def _with(block: Block, tool: Expr) -> Block:
    """A line of the macro with the tool for the letter that stands for it."""
    words = tuple(
        replace(word, value=tool, braced=False) if isinstance(word.value, Named) and word.value.name == "T" else word
        for word in block.words
    )
    return replace(block, words=words)
