"""The controller's correction tables: lines of two numbers, ``;`` before a comment.

Source: Eding CNC manual 2.3 (machine position, calibrated position) and 2.4 (spindle speed, percent of PWM).
"""

from __future__ import annotations

import hashlib
from fractions import Fraction
from pathlib import Path

from gproof.frontend.common.number_rows import number_rows
from gproof.frontend.common.source import decode
from gproof.frontend.eding.ini_file import Ini
from gproof.ir import codes
from gproof.ir.finding import Findings, Span

Pairs = list[tuple[Fraction, Fraction]]


def load_table(path: Path, ini: Ini) -> tuple[Pairs | None, str]:
    """The pairs of a table in order, and the file's sha256; None, with errors of the ini, when a line is bad."""
    try:
        raw = path.read_bytes()
    except OSError as error:
        _refuse(path, 0, f"{path}: {error.strerror or error}", ini)
        return None, ""
    digest = hashlib.sha256(raw).hexdigest()
    pairs: Pairs = []
    good = True
    for number, row in number_rows(decode(raw.removeprefix(b"\xef\xbb\xbf")), 2):
        if row is None:
            good = False
            _refuse(path, number, "a correction table must have two numbers on each line", ini)
        else:
            pairs.append((row[0], row[1]))
    if good and not pairs:
        good = False
        _refuse(path, 0, "the correction table has no numbers", ini)
    return (pairs if good else None), digest


def _refuse(path: Path, line: int, what: str, ini: Ini) -> None:
    ini.errors += 1
    findings: Findings = ini.findings
    findings.add(codes.FILE_UNREADABLE.at(Span(str(path), line), what=what))
