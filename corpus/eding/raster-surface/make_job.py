"""Write job.cnc: a relief of 120 x 80 mm, milled line by line (zigzag) with a 6 mm ball nose cutter.

Run it without arguments; it gives the same bytes each time. The surface is a shallow dome with ripples
whose height never leaves -14 ... 0 mm. 134 lines of 151 points are what a CAM program would give for a
step-over of 0.6 mm and a chord of 0.8 mm.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

LENGTH, WIDTH = 120.0, 80.0
STEP_X, STEP_Y = 0.8, 0.6
DEEPEST = -14.0
FEED, PLUNGE = 2400, 500


def height(x: float, y: float) -> float:
    """Z of the tool tip at one point of the relief, millimetres below the top of the stock."""
    u, v = 2 * x / LENGTH - 1, 2 * y / WIDTH - 1
    dome = max(0.0, 1 - u * u) * max(0.0, 1 - v * v)
    ripple = 0.08 * math.cos(math.radians(9 * x)) * math.cos(math.radians(13.5 * y))
    return max(DEEPEST, min(0.0, DEEPEST * (1 - min(1.0, dome + ripple))))


def number(value: float) -> str:
    """Three decimals at most, no trailing zeros, no negative zero: the way CAM programs write."""
    text = f"{value:.3f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def lines() -> Iterator[str]:
    """The lines of the program, without line ends."""
    columns = round(LENGTH / STEP_X)
    rows = round(WIDTH / STEP_Y)
    yield "(RELIEF, 3D FINISHING, ZIGZAG ALONG X)"
    yield f"(stock {LENGTH:g} x {WIDTH:g}, deepest Z{DEEPEST:g})"
    yield "(ball nose 6 mm)"
    yield "(written by make_job.py, do not edit)"
    yield "G21 G17 G90 G94"
    yield "G40 G49 G80 G54"
    yield "G64 P0.02 Q0.01"
    yield "S18000 M3"
    yield "G0 Z10"
    yield "G0 X0 Y0"
    yield "G0 Z1"
    for row in range(rows + 1):
        y = row * STEP_Y
        order = range(columns + 1) if row % 2 == 0 else range(columns, -1, -1)
        for place, column in enumerate(order):
            x = column * STEP_X
            z = number(height(x, y))
            if row == 0 and place == 0:
                yield f"G1 Z{z} F{PLUNGE}"
            elif place == 0:
                yield f"Y{number(y)} Z{z}"
            elif row == 0 and place == 1:
                yield f"X{number(x)} Z{z} F{FEED}"
            else:
                yield f"X{number(x)} Z{z}"
    yield "G0 Z10"
    yield "M5"
    yield "G0 X0 Y0"
    yield "M30"


def main() -> None:
    """Write job.cnc beside this script."""
    target = Path(__file__).with_name("job.cnc")
    target.write_text("\n".join(lines()) + "\n", encoding="ascii", newline="\n")


if __name__ == "__main__":
    main()
