"""The height map as passes see it: what is added to Z at a point and along rows.

Eding CNC manual 2.2.5.5: heights are kept in motor coordinates, the compensation is 0 at the first measured point
and works in the measured range only. Between points it is bilinear.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from gproof.ir.setup import HeightMap
from gproof.ir.trace import HEIGHT_MAP, Chunk
from gproof.passes.geometry.height_span_kernels import height_at, height_spans

Floats = npt.NDArray[np.float64]


class Heights:
    """A height map ready for use."""

    def __init__(self, height_map: HeightMap) -> None:
        self.grid = np.array([height_map.x, height_map.y, height_map.size])
        heights = np.array(height_map.heights, dtype=np.float64)
        self.heights = heights - heights[0, 0]

    def least(self) -> float:
        """The most that Z can be lowered by, anywhere: 0 or negative."""
        return min(0.0, float(self.heights.min()))

    def most(self) -> float:
        """The most that Z can be raised by, anywhere."""
        return max(0.0, float(self.heights.max()))

    def at(self, x: float, y: float) -> float:
        """What is added to Z at a machine position."""
        u, v = (x - self.grid[0]) / self.grid[2], (y - self.grid[1]) / self.grid[2]
        ny, nx = self.heights.shape
        if not (0.0 <= u <= nx - 1 and 0.0 <= v <= ny - 1):
            return 0.0
        return height_at(u, v, self.heights)

    def spans(self, chunk: Chunk, known: npt.NDArray[np.uint8]) -> Floats:
        """(n, 2): least and most that is added in each row; empty when the map is off in all of them.

        known: (frames, 6) 1 where an axis is known.
        """
        rows = chunk.rows
        on = np.array([HEIGHT_MAP in state.following for state in chunk.trace.states], dtype=np.uint8)
        if not on.any() or not len(rows):
            return np.zeros((0, 2))
        spans = np.zeros((len(rows), 2))
        height_spans.pick(chunk.work)(
            rows["op"], rows["to"], rows["center"], rows["turns"], rows["plane"], rows["frame"], rows["state"],
            np.array(chunk.start, dtype=np.float64), chunk.start_frame, on, known, self.grid, self.heights, spans,
        )  # fmt: skip
        return spans


def heights_of(height_map: HeightMap | None) -> Heights | None:
    """Ready for use, or None when there is no map, or a flat one."""
    if height_map is None:
        return None
    found = Heights(height_map)
    return None if found.least() == found.most() else found
