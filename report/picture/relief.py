"""What is left of stock after the job, as a picture of it from above shows it: the deeper, the darker.

Cells are drawn at their highest place, so nothing that may still be there is left out.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from gproof.ir.record import record
from gproof.passes.checks.base import Remains

LEVELS = 7
"""Steps of depth, apart from what is as it was and what is through."""
THROUGH = LEVELS + 1
COLOURS = ("#fff8e1", "#f5e3b5", "#e6c988", "#d3ab62", "#b98a45", "#97692f", "#724a20", "#4e2f14", "#ffffff")
"""By level: as it was, ever deeper, through."""

Pair = tuple[float, float]
Ints = npt.NDArray[np.int64]


@record(frozen=True, slots=True, eq=False)
class Relief:
    """low: where the first cell starts, in the frame of the picture, mm; size: of cells.

    level: (ny, nx), -1 where no stock was; depth: (ny, nx), mm below what was there.
    """

    low: Pair
    size: Pair
    level: Ints
    depth: npt.NDArray[np.float64]


def relief_of(left: Remains, x: float, y: float) -> Relief:
    """What is left, ``x`` and ``y`` mm away from the body's own coordinates."""
    x0, y0, hx, hy, floor, top = left.grid.tolist()
    high = max(top - floor, 1e-9)
    solid = np.isfinite(left.upper)
    depth = np.where(solid, left.before, 0.0) - np.where(solid, left.upper, 0.0)
    level = np.clip(np.ceil(depth / high * LEVELS - 1e-6).astype(np.int64), 0, LEVELS)
    level[left.upper <= floor + 1e-6 * high] = THROUGH
    level[left.before <= floor] = -1
    return Relief((x0 + x, y0 + y), (hx, hy), level, depth)


def draw(group: ET.Element, relief: Relief, at: Callable[[float, float], Pair]) -> None:
    """Cells of a level as one path; ``at`` gives places on the page."""
    (x0, y0), (hx, hy) = relief.low, relief.size
    for level, colour in enumerate(COLOURS):
        found = []
        for row in np.flatnonzero((relief.level == level).any(axis=1)).tolist():
            for begin, end in _runs(relief.level[row] == level):
                left, bottom = at(x0 + begin * hx, y0 + row * hy)
                right, top = at(x0 + end * hx, y0 + (row + 1) * hy)
                found.append(f"M{left:.1f} {top:.1f}H{right:.1f}V{bottom:.1f}H{left:.1f}z")
        if found:
            path = ET.SubElement(group, "path", d="".join(found), fill=colour)
            path.set("shape-rendering", "crispEdges")


def legend(reliefs: Sequence[Relief], mm: float, unit: str) -> list[tuple[str, str]]:
    """Colour and words of the levels that there are, with the depths of their cells; mm: in a unit of length."""
    said = []
    for level, colour in enumerate(COLOURS):
        depths = np.concatenate([one.depth[one.level == level] for one in reliefs]) / mm
        if not len(depths):
            continue
        text = "not cut" if level == 0 else "cut through"
        if 0 < level < THROUGH:
            ends = [f"{float(depths.min()):.3g}", f"{float(depths.max()):.3g}"]
            text = f"{' ... '.join(dict.fromkeys(ends))} {unit} deep"
        said.append((colour, text))
    return said


def _runs(wanted: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], wanted, [False]]).astype(np.int8)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
