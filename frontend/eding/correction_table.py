"""The controller's correction tables: lines of two numbers, ``;`` before a comment.

Source: Eding CNC manual 2.3 (machine position, calibrated position) and 2.4 (spindle speed, percent of PWM).
"""

from __future__ import annotations

import hashlib
import re
from fractions import Fraction
from pathlib import Path

from gproof.frontend.eding.ini_file import Ini
from gproof.frontend.eding.prepare import decode
from gproof.frontend.toml_table import LARGEST, exact_ratio
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
    for number, line in enumerate(decode(raw.removeprefix(b"\xef\xbb\xbf")).splitlines(), 1):
        words = re.split(r"[;#]", line, maxsplit=1)[0].split()
        if not words:
            continue
        values = [exact_ratio(word) if "/" not in word else None for word in words]
        if len(values) != 2 or any(value is None or abs(value) > LARGEST for value in values):
            good = False
            _refuse(path, number, "a correction table has two numbers in a line", ini)
            continue
        first, second = values
        assert first is not None and second is not None
        pairs.append((first, second))
    if good and not pairs:
        good = False
        _refuse(path, 0, "a correction table without numbers", ini)
    return (pairs if good else None), digest


def _refuse(path: Path, line: int, what: str, ini: Ini) -> None:
    ini.errors += 1
    findings: Findings = ini.findings
    findings.add(codes.FILE_UNREADABLE.at(Span(str(path), line), what=what))
