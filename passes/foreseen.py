"""Whether a job uses lengths of tools anywhere: known before it runs, because it says what its first moves are.

A zero that counts for tips of tools with their lengths does so from the first line on, also before the G43 that puts a
length in force (Eding manual 3.4.12; WinCNC Users Guide, Tool Length Offset). Takes a Program, whose tables it searches
as bytes; a code that an expression makes is not seen.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from gproof.ir.machine import Machine
from gproof.ir.program import Block, BlockTable, Call, DeferredBlock, Number, Program, Replaced, Statement, parts_of
from gproof.ir.rules import Function as F
from gproof.ir.setup import Setup

LENGTHS = frozenset((F.TOOL_OFFSET_ON, F.TOOL_OFFSET_DYNAMIC, F.MEASURE_TOOL, F.TOOL_NUMBER))
"""Functions behind which positions count with the lengths of tools, or with their measures."""
_PIECE = 1 << 20

Code = tuple[str, int]


def lengths_foreseen(program: Program, machine: Machine, setup: Setup) -> bool:
    """Whether the job uses lengths of tools, asked where bodies or zones make a difference of it."""
    if setup.workpiece is None and not (setup.keep_out or machine.keep_out):
        return False
    codes = frozenset(code for code, rule in program.rules.codes.items() if rule.function in LENGTHS)
    return any(code in codes for code in _codes(program, codes | program.overrides.keys()))


def _codes(program: Program, wanted: frozenset[Code]) -> Iterator[Code]:
    """Those of some codes that stand in what the job may run, subprograms that replace codes included."""
    todo = [program.head, program.body, program.tail, program.abort]
    done: set[str] = set()
    while todo:
        for node in _all(todo.pop()):
            names: list[str] = []
            if isinstance(node, Call):
                names.append(node.name)
            for code in _of(program, node, wanted):
                yield code
                names += [program.overrides[code]] if code in program.overrides else []
            for name in names:
                if name in program.subprograms and name not in done:
                    done.add(name)
                    todo.append(program.subprograms[name].body)


def _all(body: Iterable[Statement]) -> Iterator[Statement]:
    for node in body:
        yield node
        if isinstance(node, Replaced) and node.line is not None:
            yield node.line
        for part in parts_of(node):
            yield from _all(part)


def _of(program: Program, node: Statement, wanted: frozenset[Code]) -> Iterator[Code]:
    """Codes of one statement."""
    if isinstance(node, DeferredBlock):
        raw = node._raw
        if not any(_pattern(code).search(raw) for code in wanted):
            return
        node = node.made()
    if isinstance(node, Block):
        for word in node.words:
            if isinstance(word.value, Number):
                code = word.letter, round(word.value.value * 10) if abs(word.value.value) < 1e6 else -1
                if code in wanted:
                    yield code
    elif isinstance(node, BlockTable):
        yield from _of_table(program, node, wanted)


def _of_table(program: Program, table: BlockTable, wanted: frozenset[Code]) -> Iterator[Code]:
    if table.words is None:
        data = program.files[table.file].data
        wanted = frozenset(code for code in wanted if _pattern(code).search(data, table.begin, table.end))
    begin, line = table.begin, table.first_line
    while wanted and begin < table.end:
        words, begin, line = program.load(table, begin, line, _PIECE)
        letters, tenths = words["letter"], words["value"] * 10.0
        found = {code for code in wanted if ((letters == ord(code[0])) & (abs(tenths - code[1]) < 0.5)).any()}
        yield from found
        wanted -= found
        if table.words is not None:
            return


def _pattern(code: Code) -> re.Pattern[bytes]:
    """Where a code may stand in a text, blanks and leading zeros as they come."""
    whole, tenth = divmod(code[1], 10)
    letter = f"[{code[0].upper()}{code[0].lower()}]"
    fraction = rf"[ \t]*\.[ \t]*{tenth}" if tenth else r"(?![ \t]*[0-9])"
    digits = r"[ \t]*".join(str(whole))
    return re.compile(rf"{letter}[ \t+]*[0 \t]*{digits}{fraction}".encode())
