"""A program without what its machine's macros do besides at codes of devices: at ``M6`` the tool is changed, and its
length counts; at ``M3``, ``M4``, ``M5`` the spindle is switched, at ``M7``, ``M8``, ``M9`` coolant.

For comparing programs of two machines, each of which does these in its own way (CNC.MAC).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

from gproof.ir.program import (
    Block,
    BlockTable,
    Call,
    Device,
    Expr,
    Named,
    Number,
    Program,
    Replaced,
    Statement,
    Word,
    parts_of,
)

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
            change = Device(name="own_tool_change", arguments=(tool,), span=node.span)
            return replace(node, body=(*kept, change))
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
            yield from _of_table(node, program)
        else:
            for part in parts_of(node):
                yield from _settings(part, program, calls)


def _of_table(table: BlockTable, program: Program) -> Iterator[Block]:
    """G43 and G49 among plain lines."""
    from gproof.ir.finding import Span

    words, _, _ = program.load(table, table.begin, table.first_line, 1 << 22)
    for line, letter, value in zip(
        words["line"].tolist(), words["letter"].tolist(), words["value"].tolist(), strict=True
    ):
        name = chr(letter)
        if (name == "G" and value in _LENGTH) or (name == "L" and value in _TOOL):
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
