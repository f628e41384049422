"""Whether a job uses lengths of tools anywhere: known before it runs, because it says what its first moves are.

A zero that counts for tips of tools with their lengths does so from the first line on, also before the G43 that puts a
length in force (Eding manual 3.4.12; WinCNC Users Guide, Tool Length Offset). Takes a Program, whose tables it searches
as bytes; a code that an expression makes is not seen.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable, Iterator

import numpy as np

from gproof.ir.mapped import forget
from gproof.ir.program import Block, BlockTable, Call, DeferredBlock, Number, Program, Replaced, Statement, parts_of
from gproof.ir.rules import Function as F

LENGTHS = frozenset((F.TOOL_OFFSET_ON, F.TOOL_OFFSET_DYNAMIC, F.MEASURE_TOOL, F.TOOL_NUMBER))
"""Functions after which positions count with the lengths of tools, or with their measures."""
_PIECE = 1 << 20
_NEAR = 12
"""Bytes that a code takes at most, with blanks and zeros."""
_BEFORE = np.frombuffer(b"Gg0+ \t", np.uint8)

Code = tuple[str, int]


def lengths_foreseen(program: Program) -> bool:
    """Whether the job uses lengths of tools."""
    codes = frozenset(code for code, rule in program.rules.codes.items() if rule.function in LENGTHS)
    return any(code in codes for code in _codes(program, codes.union(program.overrides)))


def _codes(program: Program, wanted: frozenset[Code]) -> Iterator[Code]:
    """Those of some codes that are in what the job may run, subprograms that replace codes included."""
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
        if not _pattern(wanted).search(node.raw):
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
        wanted = _perhaps(program.files[table.file].data, table.begin, table.end, wanted)
    begin, line = table.begin, table.first_line
    while wanted and begin < table.end:
        words, begin, line = program.load(table, begin, line, _PIECE)
        letters, tenths = words["letter"], words["value"] * 10.0
        found = {code for code in wanted if ((letters == ord(code[0])) & (abs(tenths - code[1]) < 0.5)).any()}
        yield from found
        wanted -= found
        if table.words is not None:
            return


def _perhaps(data: bytes, begin: int, end: int, wanted: frozenset[Code]) -> frozenset[Code]:
    """Those codes that can be in a long text: what has their letter and their digits near one another.

    Letters of few words (L, M) are looked for themselves, G by its digits: most lines have one.
    """
    found: set[Code] = set()
    for at in range(begin, end, _PIECE):
        piece = np.frombuffer(data, np.uint8, min(end, at + _PIECE + _NEAR) - at, at)
        left = wanted - found
        for letter, whole in {(letter, str(tenths // 10)) for letter, tenths in left}:
            if letter == "G" and len(whole) > 1:
                hits = np.flatnonzero((piece[:-1] == ord(whole[0])) & (piece[1:] == ord(whole[1])))
                hits = hits[np.isin(piece[hits - 1], _BEFORE) | (hits == 0)]
            else:
                hits = np.flatnonzero((piece == ord(letter)) | (piece == ord(letter.lower())))
            codes = frozenset(code for code in left if code[0] == letter and str(code[1] // 10) == whole)
            pattern = _pattern(codes)
            if any(pattern.search(data, max(begin, at + n - _NEAR), at + n + _NEAR) for n in hits.tolist()):
                found |= codes
        forget(data, at, min(end, at + _PIECE))
    return frozenset(found)


@functools.cache
def _pattern(codes: frozenset[Code]) -> re.Pattern[bytes]:
    """Where some codes can be in a text, blanks and leading zeros as they come."""
    forms = []
    for letter, tenths in sorted(codes):
        whole, tenth = divmod(tenths, 10)
        fraction = rf"[ \t]*\.[ \t]*{tenth}" if tenth else r"(?![ \t]*[0-9])"
        forms.append(rf"[{letter.upper()}{letter.lower()}][ \t+]*[0 \t]*{whole}{fraction}")
    return re.compile("|".join(forms).encode() if forms else b"(?!)")
