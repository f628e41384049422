"""How a finding code is declared, and those that are no more."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.finding import Code, Severity

CODES: dict[int, Code] = {}
RETIRED: dict[int, tuple[str, str]] = {
    305: ("offset-box", "the verdict says for which offsets a job is safe, and so do the conditions of a report"),
    414: ("arc-too-small", "an arc without a radius is GP402, an arc that a controller cuts as a line is GP407"),
    516: ("jump-target", "a jump to a missing label is GP143, one into a block GP144"),
}
"""Numbers and names of codes that are no more, which no other code takes: what tells of the like now."""
SENTENCES: list[Code] = []
"""Codes with another sentence than their first one."""

_NAMES: set[str] = set()


def code(number: int, name: str, severity: Severity, template: str, prop: str = "language", hint: str = "") -> Code:
    """Declare a code; a number or name used twice, or of a code that was retired, is an error at import.

    hint: what to do, in findings that have no words of their own for it.
    """
    if number in RETIRED or any(name == old for old, _ in RETIRED.values()):
        raise ValueError(f"finding code {number} {name} was retired")
    if number in CODES or name in _NAMES:
        raise ValueError(f"finding code {number} {name} declared twice")
    _NAMES.add(name)
    CODES[number] = Code(number, name, severity, template, prop, hint)
    return CODES[number]


def saying(first: Code, template: str) -> Code:
    """The same code with another sentence; findings of both are findings of this code."""
    SENTENCES.append(replace(first, template=template))
    return SENTENCES[-1]
