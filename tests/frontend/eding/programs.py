"""Loading small programs in tests, and comparing trees without their places."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

from gproof.frontend.eding.load import load_program
from gproof.ir.finding import Findings, Span
from gproof.ir.program import BlockTable, Program

NOWHERE = Span("", 0)


def load(folder: Path, text: str | bytes, name: str = "job.cnc") -> tuple[Program | None, Findings]:
    """The program in a file of that content, with findings without a cap."""
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    findings = Findings(limit=100_000)
    return load_program(path, findings), findings


def program_of(folder: Path, text: str | bytes) -> Program:
    """A program that must have no finding."""
    program, findings = load(folder, text)
    assert shown(findings) == []
    assert program is not None
    program.verify()
    return program


def shown(findings: Findings) -> list[tuple[str, int, int, int]]:
    """(code, line, column, end column) of each finding, in order."""
    return [(f.code.label, f.span.line, f.span.column, f.span.end_column) for f in findings.kept]


def without_places(node: Any) -> Any:
    """The same tree with every span blank, without doubts and decimal points."""
    if isinstance(node, Span):
        return NOWHERE
    if isinstance(node, tuple | list):
        return tuple(without_places(item) for item in node)
    if dataclasses.is_dataclass(node) and not isinstance(node, type):
        changes = {f.name: without_places(getattr(node, f.name)) for f in dataclasses.fields(node)}
        for name in ("doubtful", "point"):
            if name in changes:
                changes[name] = False
        return type(node)(**changes)
    return node


def table_words(program: Program, table: BlockTable) -> list[tuple[int, str, float, int]]:
    """(line, letter, value, flags) of each word of a table, loaded as the executor loads it."""
    found = []
    begin, line = table.begin, table.first_line
    while begin < table.end:
        words, begin, line = program.load(table, begin, line, 64)
        found += [(row, chr(letter), value, flags) for row, _, letter, flags, value in words.rows()]
    return found
