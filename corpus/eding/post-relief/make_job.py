"""Writes job.cnc: a wave, finished in rows with a ball, as a post-processor writes surfaces."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

ROWS, STEPS, PITCH = 24, 60, 1.5


def lines() -> Iterator[str]:
    """The lines of the program."""
    yield from ("(WAVE PANEL)", "(BALL D6 STEPOVER 1.5)", "G17 G21 G40 G90", "G64 P0.02", "T1 M6", "S20000 M3")
    yield from ("G0 X0.000 Y0.000", "G43 H1 Z20.000", "G1 Z2.000 F1000", "F3000")
    for row in range(ROWS):
        y = PITCH * row
        columns = range(STEPS + 1) if row % 2 == 0 else range(STEPS, -1, -1)
        for column in columns:
            x = PITCH * column
            z = 2.0 * math.sin(x / 12.0) * math.cos(y / 9.0) - 3.0
            yield f"X{x:.3f} Y{y:.3f} Z{z:.3f}"
    yield from ("G0 Z20.000", "G64", "M5", "G53 G0 Z0", "M30")


if __name__ == "__main__":
    text = "".join(f"{line}\n" for line in lines())
    Path(__file__).with_name("job.cnc").write_text(text, encoding="utf-8")
