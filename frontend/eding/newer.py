"""Commands that controllers newer than the manual have, as macro files of V4.03 use them, and what they do there.

The manual has none of these, so that they are UNKNOWN (GP113) unless ``accepts`` of the machine file names them. They
write variables, work on the height map or run programs of the PC; none of them moves an axis.
"""

from __future__ import annotations

import re

from gproof.ir.dialects.accepts import HEIGHT_COMMANDS, MODBUS, PC_PROGRAMS, TOOL_INFO, Accepted
from gproof.ir.finding import Span
from gproof.ir.program import Assign, Block, Device, Expr, Input, Number, Statement, Variable

ANSWER = 5399
"""What Exec leaves of the program that it has run."""
_TOOL_INFO = re.compile(r"gettoolinfo\s+(?:num|first|next)\s+(\d+)", re.IGNORECASE)
_READS = re.compile(r"modbus\s+s\d+\s+f[1-4]\s+a\d+\s+n(\d+)\s+u(\d+)", re.IGNORECASE)
_WRITES = re.compile(r"modbus\s+s\d+\s+f(?:5|6|15|16)\s+a\d+(?:\s+n\d+)?\s+[uv]\d+", re.IGNORECASE)
_EXEC = re.compile(r"exec\s+.*", re.IGNORECASE)
_HEIGHT = re.compile(r"zhc\s*(on|off)|(zhcinitex)\s+.*|(zhccheck)\s+\d+", re.IGNORECASE)
_MOST_READ = 125
"""Registers that one Modbus telegram carries."""


def meaning(text: str, span: Span) -> tuple[Accepted, tuple[Statement, ...]] | None:
    """The entry that has a command, and what it does; None for what is no such command, or not of a known form.

    text: the statement without comments.
    """
    if found := _TOOL_INFO.fullmatch(text):
        return TOOL_INFO, (_sets([int(found.group(1))], span),)
    if found := _READS.fullmatch(text):
        count, first = int(found.group(1)), int(found.group(2))
        return (MODBUS, (_sets(list(range(first, first + count)), span),)) if count <= _MOST_READ else None
    if _WRITES.fullmatch(text):
        return MODBUS, ()
    if _EXEC.fullmatch(text):
        return PC_PROGRAMS, (_sets([ANSWER], span),)
    if found := _HEIGHT.fullmatch(text):
        switch = (found.group(1) or "").lower()
        if switch:
            return HEIGHT_COMMANDS, (Device(name=f"height_map_{switch}", arguments=(), span=span),)
        if found.group(2):
            # A map with other steps in X and Y: what will be measured is as unknown as of one with equal steps.
            sizes: tuple[Expr, ...] = tuple(Number(0.0, span) for _ in range(3))
            return HEIGHT_COMMANDS, (Device(name="height_map_init", arguments=sizes, span=span),)
        return HEIGHT_COMMANDS, ()
    return None


def _sets(numbers: list[int], span: Span) -> Block:
    """Variables that hold what the controller got from outside."""
    return Block(
        words=(),
        assigns=tuple(
            Assign(Variable(Number(float(n), span), span), Input("outside", Number(float(n), span), span), span)
            for n in numbers
        ),
        span=span,
    )
