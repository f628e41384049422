"""Write relief.tap: a relief of 12 x 10 inches, milled line by line (zigzag) with a 1/4 inch ball nose cutter.

Run it without arguments; it gives the same bytes each time. The surface is a shell, a dome with twelve grooves,
whose height never leaves -.625 ... 0 inch below the top of the stock. 51 lines of 97 points are what a CAM program
gives for a roughing step-over of .2 inch and a chord of an eighth.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

LENGTH, WIDTH = 12.0, 10.0
STEP_X, STEP_Y = 0.125, 0.2
DEEPEST = -0.625
FEED, PLUNGE = 300, 60


def height(x: float, y: float) -> float:
    """Z of the tool tip at one point of the relief, inches below the top of the stock."""
    u, v = 2 * x / LENGTH - 1, 2 * y / WIDTH - 1
    dome = max(0.0, 1 - u * u - v * v)
    groove = 0.06 * math.cos(12 * math.atan2(v, u)) * dome
    return max(DEEPEST, min(0.0, DEEPEST * (1 - dome) + groove - 0.06))


def number(value: float) -> str:
    """Four decimals at most, no leading or trailing zeros, no negative zero: the way inch programs are posted."""
    text = f"{value:.4f}".rstrip("0").rstrip(".")
    if text in ("-0", "0", ""):
        return "0"
    return text.replace("-0.", "-.") if text.startswith("-0.") else text.removeprefix("0")


def lines() -> Iterator[str]:
    """The lines of the program, without line ends."""
    columns = round(LENGTH / STEP_X)
    rows = round(WIDTH / STEP_Y)
    yield "[SHELL, 3D ROUGHING, ZIGZAG ALONG X]"
    yield f"[stock {LENGTH:g} x {WIDTH:g} x 1.5, deepest Z{number(DEEPEST)}, 1/4 ball nose is tool 2]"
    yield "[written by make_relief.py, do not edit]"
    yield "G90"
    yield "M6 T2"
    yield "S18000"
    yield "M3"
    yield "G92.1 X20 Y30 Z1.5"
    yield "G0 Z.5"
    yield "X0 Y0"
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
    yield "G0 Z.5"
    yield "M30"


def main() -> None:
    """Write relief.tap beside this script."""
    target = Path(__file__).with_name("relief.tap")
    target.write_text("\n".join(lines()) + "\n", encoding="ascii", newline="\n")


if __name__ == "__main__":
    main()
