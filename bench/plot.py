"""A log-log plot as SVG, without a library: the same figures give the same bytes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

WIDTH, HEIGHT = 420, 330
LEFT, RIGHT, TOP, BOTTOM = 62, 16, 34, 48


@dataclass(frozen=True, slots=True)
class Line:
    """One curve. points: (x, y), both above 0; dashed: what is derived from another one."""

    name: str
    colour: str
    points: Sequence[tuple[float, float]]
    dashed: bool = False


@dataclass(frozen=True, slots=True)
class Panel:
    """One pair of axes with its curves; both axes count in powers of ten."""

    title: str
    x_name: str
    y_name: str
    lines: Sequence[Line]


def _decades(values: list[float]) -> tuple[int, int]:
    low, high = math.floor(math.log10(min(values)) + 1e-9), math.ceil(math.log10(max(values)) - 1e-9)
    return low, max(high, low + 1)


def _number(exponent: int) -> str:
    if 0 <= exponent <= 3:
        return str(10**exponent)
    if -3 <= exponent < 0:
        return f"{10.0**exponent:.{-exponent}f}"
    return f'10<tspan dy="-5" font-size="8">{exponent}</tspan>'


def _panel(panel: Panel, left: int) -> list[str]:
    points = [point for line in panel.lines for point in line.points]
    x0, x1 = _decades([x for x, _ in points])
    y0, y1 = _decades([y for _, y in points])
    wide, high = WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM

    def place(x: float, y: float) -> tuple[float, float]:
        return (
            left + LEFT + wide * (math.log10(x) - x0) / (x1 - x0),
            TOP + high * (1 - (math.log10(y) - y0) / (y1 - y0)),
        )

    out = [f'<text x="{left + LEFT}" y="20" font-size="13" font-weight="bold">{escape(panel.title)}</text>']
    for n in range(x0, x1 + 1):
        x, _ = place(10.0**n, 10.0**y0)
        out.append(f'<line x1="{x:.1f}" y1="{TOP}" x2="{x:.1f}" y2="{TOP + high}" stroke="#ddd"/>')
        out.append(f'<text x="{x:.1f}" y="{TOP + high + 17}" text-anchor="middle">{_number(n)}</text>')
    for n in range(y0, y1 + 1):
        _, y = place(10.0**x0, 10.0**n)
        edge = left + LEFT
        out.append(f'<line x1="{edge}" y1="{y:.1f}" x2="{edge + wide}" y2="{y:.1f}" stroke="#ddd"/>')
        out.append(f'<text x="{edge - 6}" y="{y + 4:.1f}" text-anchor="end">{_number(n)}</text>')
    out.append(
        f'<text x="{left + LEFT + wide / 2:.1f}" y="{HEIGHT - 10}" text-anchor="middle">{escape(panel.x_name)}</text>'
    )
    middle = TOP + high / 2
    out.append(
        f'<text transform="translate({left + 16},{middle:.1f}) rotate(-90)" text-anchor="middle">'
        f"{escape(panel.y_name)}</text>"
    )
    for row, line in enumerate(panel.lines):
        dash = ' stroke-dasharray="5 4"' if line.dashed else ""
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in (place(*point) for point in line.points))
        out.append(f'<polyline points="{path}" fill="none" stroke="{line.colour}" stroke-width="2"{dash}/>')
        if not line.dashed:
            out += [
                f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{line.colour}"/>'
                for x, y in (place(*point) for point in line.points)
            ]
        y = TOP + 16 + 16 * row
        edge = left + LEFT + 10
        out.append(
            f'<line x1="{edge}" y1="{y - 4}" x2="{edge + 22}" y2="{y - 4}" stroke="{line.colour}"'
            f' stroke-width="2"{dash}/>'
        )
        out.append(f'<text x="{edge + 28}" y="{y}">{escape(line.name)}</text>')
    return out


def plot(panels: Sequence[Panel]) -> str:
    """The panels side by side."""
    width = WIDTH * len(panels)
    body = [part for n, panel in enumerate(panels) for part in _panel(panel, n * WIDTH)]
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{HEIGHT}" viewBox="0 0 {width} {HEIGHT}"'
        ' font-family="sans-serif" font-size="11" fill="#222">'
    )
    background = f'<rect width="{width}" height="{HEIGHT}" fill="#fff"/>'
    return "\n".join([head, background, *body, "</svg>"]) + "\n"
