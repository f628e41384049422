"""CNC.MAC alone as a Program of definitions, to be printed again.

A line that defines a command is a ``Definition``; one of which the manual leaves open what it is (a variable, words
after a closed comment) a ``Mistake`` that stays as it is. Manual: Macro File Configuration; Braces; Comment.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from gproof.frontend.common.source import UTF8_MARK, encoding_of, newline_of, read_source
from gproof.frontend.wincnc.line import LineError, LineReader
from gproof.frontend.wincnc.mac_file import (
    COMMENT_SIGNS,
    Macro,
    behind_comments,
    each_macro,
    end_of_command,
    is_comment,
)
from gproof.frontend.wincnc.machine import NO_SHOP
from gproof.frontend.wincnc.notes import Found, comments
from gproof.frontend.wincnc.statements import ArrayLine, FileFinder, Head, Lines, Parsed, text_codes
from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.dialects import rules_named
from gproof.ir.dialects.wincnc.settings import Lexical, wincnc_settings
from gproof.ir.finding import Findings, Refusal, Severity, Span
from gproof.ir.machine import Machine
from gproof.ir.notes import NOTE, NoteKind, Notes
from gproof.ir.program import Block, Definition, Mistake, Program, SourceFile, Statement


def load_macro_file(path: Path, findings: Findings, name: str = "", *, machine: Machine = NO_SHOP) -> Program | None:
    """The definitions of CNC.MAC; None when the file is refused. Mistakes are findings, as for a job that uses it.

    machine: whose settings say how lines are read; name: of the file in findings, when it is not ``path``.
    """
    controls = wincnc_settings(machine)
    try:
        source = read_source(path, dos=True)
        source.name = name or source.name
        return _program(source, findings, controls.lexical, len(controls.changers))
    except Refusal as refusal:
        findings.add(refusal.finding)
        return None


def _program(source: SourceFile, findings: Findings, lexical: Lexical, changers: int) -> Program:
    raws = _raw_lines(source)
    own = Findings(limit=len(raws) + 1)
    macros = list(each_macro(source, own, lexical))
    mistakes = [finding for finding in own.kept if finding.severity is not Severity.ERROR]
    for finding in own.kept:
        if finding.severity is Severity.ERROR:
            findings.add(finding)
    rules = rules_named("wincnc")
    reader = LineReader(lexical, text_codes(rules))
    lines = Lines(reader, rules, {m.name: m for m in reversed(macros)}, _NAMES, changers)
    nodes: dict[int, Statement] = {macro.span.line: _definition(macro, lines) for macro in macros}
    for finding in mistakes:
        line = finding.span.line
        text = raws[line - 1].decode(encoding_of(raws[line - 1])).strip()
        nodes[line] = Mistake(
            code=finding.code.number, message=finding.message, span=finding.span, text=text, hint=finding.hint
        )
    source.mark = source.data[:3] == UTF8_MARK
    source.newline = newline_of(source.data)
    source.line_count = len(raws)
    source.notes = _notes(raws, COMMENT_SIGNS + lexical.comment_signs)
    if not findings.has(Severity.ERROR):
        _require_all(source, raws, nodes, COMMENT_SIGNS + lexical.comment_signs)
    body = tuple(nodes[line] for line in sorted(nodes))
    return Program(dialect="wincnc", rules=rules, files=[source], body=body, line_count=source.line_count)


def _raw_lines(source: SourceFile) -> list[bytes]:
    """The lines without their ends; Refusal (GP702) where a carriage return alone ends one."""
    lines = bytes(source.data).removeprefix(UTF8_MARK).split(b"\n")
    if not lines[-1]:
        lines.pop()
    found = []
    for number, line in enumerate(lines, 1):
        line = line.removesuffix(b"\r")
        if b"\r" in line:
            what = "a line that ends in a carriage return alone"
            raise Refusal(codes.NOT_PRINTABLE.at(Span(source.name, number), what=what))
        found.append(line)
    return found


def _require_all(source: SourceFile, raws: Sequence[bytes], nodes: dict[int, Statement], signs: str) -> None:
    """Refusal (GP702) for a line that says something and has no statement: it would not be printed."""
    for number, raw in enumerate(raws, 1):
        if number not in nodes and not is_comment(raw.decode(encoding_of(raw)), signs):
            raise Refusal(codes.NOT_PRINTABLE.at(Span(source.name, number), what="this line"))


class _AnyName:
    """Subprogram files, whether they are there or not: which one a command means is not asked here."""

    where = ""

    def find(self, name: str) -> str | None:
        """The name itself, where no other reading is possible: in quotes, or without blanks."""
        text = name.strip().strip('"')
        is_name = bool(text) and (name.startswith('"') or not any(blank in text for blank in " \t"))
        return text.lower() if is_name else None


_NAMES: FileFinder = _AnyName()


def _definition(macro: Macro, lines: Lines) -> Definition:
    return Definition(
        name=macro.name, label=macro.label, written=macro.text, span=macro.span, line=_line(macro, lines)
    )  # fmt: skip


def _line(macro: Macro, lines: Lines) -> Block | None:
    """The words and texts of a command at their places; None for one that makes no sense on its own."""
    if not macro.text or lines.reader.cut(macro.text)[0] != macro.text:
        return None
    try:
        parsed = lines.parse(" " * (macro.column - 1) + macro.text, macro.span.file, macro.span.line)
    except LineError:
        return None
    return _line_of(parsed)


def _line_of(parsed: Parsed | None) -> Block | None:
    if isinstance(parsed, Head):
        parsed = parsed.statement
    if isinstance(parsed, Block):
        return parsed
    line = parsed.line if isinstance(parsed, ArrayLine) else getattr(parsed, "line", None)
    assert line is None or isinstance(line, Block)
    return line


def _notes(raws: Sequence[bytes], signs: str) -> Notes:
    rows: list[tuple[int, int, int, int, int, int]] = []
    text = bytearray()
    for number, raw in enumerate(raws, 1):
        for place, kind, column, part in _line_notes(raw, signs):
            rows.append((number, place, kind, column, len(text), len(part)))
            text += part
    cells: list[Any] = list(zip(*rows, strict=True)) or [()] * len(NOTE.columns)
    columns = {c.name: np.array(values, c.dtype) for c, values in zip(NOTE.columns, cells, strict=True)}
    return Notes(Columns(NOTE, columns), bytes(text))


def _line_notes(raw: bytes, signs: str) -> list[Found]:
    """The notes of one line: see ``frontend/wincnc/notes.py``."""
    encoding = encoding_of(raw)
    line = raw.decode(encoding)
    if not line.strip():
        return []  # blanks of every kind, those of Windows-1252 too
    found: list[Found] = [] if encoding == "utf-8" else [(0, NoteKind.ENCODING, 0, encoding.encode())]
    if is_comment(line, signs):
        line, at = line.lstrip(), 0
        if line.isascii():
            found = []  # the blanks before it were all that needed one
    else:
        equals = line.find("=") + 1
        at = end_of_command(line, len(line) - len(line[equals:].lstrip()) if equals else len(line), signs)
    if behind_comments(line, at, signs) < len(line) and at < len(line):
        return [(0, NoteKind.LEFT_OUT, 0, raw.rstrip(b" \t\r"))]
    return found + comments(line, at, encoding)
