"""Texts of pictures: about how wide they are drawn, and in how many lines they fit, so that nothing of them is cut."""

from __future__ import annotations

import re


def wide(text: str, size: float, bold: bool = False) -> float:
    """About how wide a text is drawn, rather more than less; pixels, as ``size``."""
    units = sum(0.36 if c in " .,:;'|!()[]iljtf" else 0.76 if c.isupper() or c in "mwMW…" else 0.63 for c in text)
    return units * size * (1.1 if bold else 1.0)


def wrapped(text: str, size: float, room: float, bold: bool = False) -> list[str]:
    """The text in lines no wider than ``room``, one at least; broken at blanks and after ``/``, otherwise anywhere."""
    lines: list[str] = []
    line = ""
    for piece in re.findall(r"[^ /]*[ /]?", "".join(c if c.isprintable() else "?" for c in text)):
        left = piece
        if line and wide((line + left).rstrip(), size, bold) > room:
            lines.append(line.rstrip())
            line = ""
        while not line and len(left) > 1 and wide(left.rstrip(), size, bold) > room:
            fits = next(n for n in range(len(left) - 1, 0, -1) if n == 1 or wide(left[:n], size, bold) <= room)
            lines.append(left[:fits])
            left = left[fits:]
        line += left
    return [*lines, line.rstrip()] if line.strip() or not lines else lines
