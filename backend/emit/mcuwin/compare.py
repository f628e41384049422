"""Whether two Programs are the same to a second printer, which never looks at the text of a file."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from itertools import zip_longest

from gproof.backend.emit.mcuwin.tree import text_of
from gproof.ir.dialects.mcuwin.settings import mcuwin_settings
from gproof.ir.finding import Refusal
from gproof.ir.machine import Machine
from gproof.ir.program import Program


def said_otherwise(before: Program, after: Program, machine: Machine) -> str:
    """What a second printer, which never looks at the text of a file, makes of one Program and not of the other; ""."""
    sums = []
    for program in (before, after):
        found = hashlib.sha256()
        for piece in _pieces(program, machine):
            found.update(piece)
        sums.append(found.digest())
    if sums[0] == sums[1]:
        return ""
    pairs = zip_longest(*(_lines(program, machine) for program in (before, after)), fillvalue="nothing")
    return next(f"{one!r} and {two!r}" for one, two in pairs if one != two)


def _pieces(program: Program, machine: Machine) -> Iterator[bytes]:
    """The text of a Program, up to what has none: that is compared as a node."""
    axes = "".join(axis.word for axis in machine.axes)
    try:
        yield from text_of(program, mcuwin_settings(machine), axes)
    except Refusal as refusal:
        yield str(refusal.finding.message).encode()


def _lines(program: Program, machine: Machine) -> Iterator[str]:
    held = b""
    for piece in _pieces(program, machine):
        *lines, held = (held + piece).split(b"\n")
        yield from (line.decode() for line in lines)
    if held:
        yield held.decode()
