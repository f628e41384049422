"""Write job.cnc: a guilloche rosette for a watch dial, engraved with moves of about 0.1 mm.

Run it without arguments; it gives the same bytes each time. Three closed rose curves lie inside a circle
of 18 mm; the depth swells between 0.03 and 0.10 mm, as a drag engraver or a V-bit would be driven.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

CENTRE = (20.0, 20.0)
OUTER = 18.0
CURVES = ((14.0, 4.0, 24), (10.0, 3.0, 18), (6.0, 2.0, 12))  # mean radius, swing, petals
MOVE = 0.1
FEED, PLUNGE = 900, 120


def curve(mean: float, swing: float, petals: int) -> Iterator[tuple[float, float, float]]:
    """Points of one closed curve, X Y Z, about MOVE apart."""
    length = 2 * math.pi * math.hypot(mean, swing * petals * 0.7)
    count = petals * round(length / MOVE / petals)
    for k in range(count + 1):
        turn = (k % count) / count * 2 * math.pi
        radius = mean + swing * math.cos(petals * turn)
        depth = 0.065 + 0.035 * math.sin(2 * petals * turn)
        yield (
            CENTRE[0] + radius * math.cos(turn),
            CENTRE[1] + radius * math.sin(turn),
            -depth,
        )


def lines() -> Iterator[str]:
    """The lines of the program, without line ends."""
    yield "(GUILLOCHE ROSETTE FOR A DIAL, 36 MM)"
    yield "(V-bit 60 deg, 0.1 flat; zero: lower left corner of the blank 40 x 40, on the brass)"
    yield "(written by make_job.py, do not edit)"
    yield "G21 G17 G90 G94 G40 G49 G80 G54"
    yield "G61 R3"
    yield "S24000 M3"
    yield "G0 Z5"
    for mean, swing, petals in CURVES:
        points = list(curve(mean, swing, petals))
        x, y, z = points[0]
        yield f"(curve at radius {mean:g}, {petals} petals)"
        yield f"G0 X{x:.4f} Y{y:.4f}"
        yield "G0 Z0.5"
        yield f"G1 Z{z:.4f} F{PLUNGE}"
        x, y, z = points[1]
        yield f"G1 X{x:.4f} Y{y:.4f} Z{z:.4f} F{FEED}"
        for x, y, z in points[2:]:
            yield f"X{x:.4f} Y{y:.4f} Z{z:.4f}"
        yield "G0 Z2"
    yield "(rim)"
    yield f"G0 X{CENTRE[0] + OUTER:g} Y{CENTRE[1]:g}"
    yield "G0 Z0.5"
    yield f"G1 Z-0.08 F{PLUNGE}"
    yield f"G3 X{CENTRE[0] + OUTER:g} Y{CENTRE[1]:g} I-{OUTER:g} J0 F{FEED}"
    yield "G0 Z5"
    yield "M5"
    yield "M30"


def main() -> None:
    """Write job.cnc beside this script."""
    target = Path(__file__).with_name("job.cnc")
    target.write_text("\n".join(lines()) + "\n", encoding="ascii", newline="\n")


if __name__ == "__main__":
    main()
