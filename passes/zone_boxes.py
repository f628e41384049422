"""Boxes in regions of offsets: the largest ones with sides along the axes, for people who type three numbers.

Every box lies in its region. Where all edges of the region are along the axes the boxes cover it, as far as there are
not too many of them.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import numpy.typing as npt

from gproof.passes.zone_regions import Layer, Pair, Region

Box = tuple[Pair, Pair, Pair]
MARKS = 48
"""Places of X and of Y between which boxes end; of more, evenly chosen ones."""
BOXES = 24
"""So many boxes at most."""


def boxes_of(region: Region) -> tuple[Box, ...]:
    """The greatest first, each of which covers something that those before it do not."""
    import shapely

    marks = [_marks([_places(layer.left)[:, axis] for layer in region.layers]) for axis in (0, 1)]
    if not region.layers or min(len(m) for m in marks) < 2:
        return ()
    x, y = marks
    low, high = (np.meshgrid(*ends, indexing="ij") for ends in ((x[:-1], y[:-1]), (x[1:], y[1:])))
    cells = shapely.box(low[0].ravel(), low[1].ravel(), high[0].ravel(), high[1].ravel())
    inside = []
    for layer in region.layers:
        # A cell is inside when its part outside is none but rounding.
        shapely.prepare(layer.left)
        outside = shapely.area(shapely.difference(cells, layer.left))
        inside.append((outside <= 1e-9 * shapely.area(cells)).reshape(len(x) - 1, len(y) - 1))
    found: list[tuple[float, Box, tuple[slice, slice, slice]]] = []
    for a, b in itertools.combinations(range(len(region.layers) + 1), 2):
        run = region.layers[a:b]
        if any(one.z[1] != other.z[0] for one, other in itertools.pairwise(run)):
            continue
        common = np.logical_and.reduce(inside[a:b])
        for i, j, k, m in rectangles(common):
            box = (float(x[i]), float(x[j])), (float(y[k]), float(y[m])), (run[0].z[0], run[-1].z[1])
            size = float(np.prod([max(high - low, 1e-9) for low, high in box]))
            found.append((size, box, (slice(a, b), slice(i, j), slice(k, m))))
    found.sort(key=lambda one: (-one[0], one[1]))
    covered = np.zeros((len(region.layers), len(x) - 1, len(y) - 1), dtype=bool)
    out: list[Box] = []
    for _, box, where in found:
        if len(out) == BOXES:
            break
        if not covered[where].all():
            covered[where] = True
            out.append(box)
    return tuple(out)


def _places(shape: Any) -> npt.NDArray[np.float64]:
    import shapely

    return np.asarray(shapely.get_coordinates(shape), dtype=np.float64)


def _marks(values: list[npt.NDArray[np.float64]]) -> npt.NDArray[np.float64]:
    """Different ones among all values, in order; neighbours that differ by rounding are one."""
    marks = np.unique(np.concatenate(values)) if values else np.zeros(0)
    if len(marks) > 1:
        marks = marks[np.concatenate([[True], np.diff(marks) > 1e-9])]
    if len(marks) > MARKS:
        marks = marks[np.linspace(0, len(marks) - 1, MARKS).round().astype(int)]
    return marks


def rectangles(cells: npt.NDArray[np.bool_]) -> list[tuple[int, int, int, int]]:
    """All rectangles (first and behind last in both directions) of true cells that can not be made larger."""
    n, m = cells.shape
    out = []
    for i in range(n):
        common = np.ones(m, dtype=bool)
        for j in range(i, n):
            common &= cells[j]
            if not common.any():
                break
            edges = np.flatnonzero(np.diff(np.concatenate([[0], common.astype(np.int8), [0]])))
            for k, e in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
                taller = (i > 0 and bool(cells[i - 1, k:e].all())) or (j + 1 < n and bool(cells[j + 1, k:e].all()))
                if not taller:
                    out.append((i, j + 1, k, e))
    return out


def outline(layer: Layer) -> list[list[list[list[float]]]]:
    """Polygons of a layer, each with its rings, the outer one first, without the first point again at the end."""
    out: list[list[list[list[float]]]] = []
    for part in getattr(layer.left, "geoms", [layer.left]):
        rings = [part.exterior, *part.interiors]
        out.append([[[float(x), float(y)] for x, y in list(ring.coords)[:-1]] for ring in rings])
    return out
