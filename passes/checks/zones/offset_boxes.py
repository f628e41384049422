"""Boxes in regions of offsets: the largest ones with sides along the axes, for people who type three numbers.

Every box is in its region. Where all edges of the region are along the axes the boxes cover it, as far as there are
not too many of them.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from gproof.passes.checks.zones.offset_regions import SAME, Layer, Pair, Region

Box = tuple[Pair, Pair, Pair]
MARKS = 48
"""Places of X and of Y at which boxes end, at most."""
BOXES = 24
"""So many boxes at most."""
SHARE = 0.02
"""Of the whole region: what a box has to add where boxes cannot cover all of it."""


def boxes_of(region: Region) -> tuple[Box, ...]:
    """Those first that add most to those before them; where edges are not along the axes, only what adds ``SHARE``."""
    import shapely

    x, y = _marks(region, 0), _marks(region, 1)
    if min(len(x), len(y)) < 2:
        return ()
    low, high = (np.meshgrid(*ends, indexing="ij") for ends in ((x[:-1], y[:-1]), (x[1:], y[1:])))
    cells = shapely.box(low[0].ravel(), low[1].ravel(), high[0].ravel(), high[1].ravel())
    inside = []
    for layer in region.layers:
        # A cell is inside when its part outside is none but rounding.
        shapely.prepare(layer.left)
        outside = shapely.area(shapely.difference(cells, layer.left))
        inside.append((outside <= 1e-9 * shapely.area(cells)).reshape(len(x) - 1, len(y) - 1))
    cover = np.array(inside)
    heights = np.array([max(layer.z[1] - layer.z[0], 1e-9) for layer in region.layers])
    volume = heights[:, np.newaxis, np.newaxis] * np.diff(x)[:, np.newaxis] * np.diff(y)
    areas = [float(layer.left.area) for layer in region.layers]
    whole = float(np.dot(heights, areas))
    exact = bool(np.isclose((volume * cover).sum(), whole, rtol=1e-9))
    least = 0.0 if exact else SHARE * whole
    candidates = np.array(_candidates(region, cover), dtype=np.int64).reshape(-1, 6)
    out: list[Box] = []
    while len(out) < BOXES and len(candidates):
        gains = _sums(np.where(cover, volume, 0.0), candidates)
        best = int(np.argmax(gains))
        if gains[best] <= least and out:
            break
        a, b, i, j, k, m = candidates[best].tolist()
        cover[a:b, i:j, k:m] = False
        out.append((
            (float(x[i]), float(x[j])), (float(y[k]), float(y[m])), (region.layers[a].z[0], region.layers[b - 1].z[1])
        ))  # fmt: skip
        candidates = candidates[gains > 0.0]
    return tuple(out)


def _candidates(region: Region, inside: npt.NDArray[np.bool_]) -> list[tuple[int, int, int, int, int, int]]:
    """All boxes of cells (layers, X, Y; from and to) that cannot be made larger within their layers."""
    found = []
    for a in range(len(region.layers)):
        common = inside[a].copy()
        for b in range(a + 1, len(region.layers) + 1):
            if b > a + 1:
                if region.layers[b - 2].z[1] != region.layers[b - 1].z[0]:
                    break
                common &= inside[b - 1]
            if not common.any():
                break
            found += [(a, b, *cells) for cells in rectangles(common)]
    return found


def _sums(values: npt.NDArray[np.float64], boxes: npt.NDArray[np.int64]) -> npt.NDArray[np.float64]:
    """(n,): what boxes of cells hold together."""
    total = np.zeros(tuple(n + 1 for n in values.shape))
    total[1:, 1:, 1:] = values.cumsum(axis=0).cumsum(axis=1).cumsum(axis=2)
    a, b, i, j, k, m = boxes.T
    upper = total[b, j, m] - total[b, i, m] - total[b, j, k] + total[b, i, k]
    lower = total[a, j, m] - total[a, i, m] - total[a, j, k] + total[a, i, k]
    found: npt.NDArray[np.float64] = upper - lower
    # Differences of great sums: what is next to nothing is nothing.
    return np.where(found > 1e-9 * max(float(total[-1, -1, -1]), 1e-300), found, 0.0)


def _marks(region: Region, axis: int) -> npt.NDArray[np.float64]:
    """Places along an axis where layers have corners, in order; of too many those with the longest edges across."""
    values, weights = [np.zeros(0)], [np.zeros(0)]
    for layer in region.layers:
        for ring in (ring for polygon in outline(layer) for ring in polygon):
            points = np.array(ring)
            way = np.abs(points - np.roll(points, 1, axis=0))
            across = np.where(way[:, axis] <= SAME, way[:, 1 - axis], 0.0)
            values.append(points[:, axis])
            weights.append(np.maximum(across, np.roll(across, -1)))
    found, weight = np.concatenate(values), np.concatenate(weights)
    order = np.argsort(found, kind="stable")
    found, weight = found[order], weight[order]
    if not len(found):
        return found
    # Neighbours that differ by rounding are one.
    first = np.concatenate([[True], np.diff(found) > SAME])
    group = np.cumsum(first) - 1
    marks: npt.NDArray[np.float64] = found[first]
    total = np.bincount(group, weights=weight)
    if len(marks) > MARKS:
        total[[0, -1]] = np.inf
        marks = marks[np.sort(np.argsort(-total, kind="stable")[:MARKS])]
    return marks


def rectangles(cells: npt.NDArray[np.bool_]) -> list[tuple[int, int, int, int]]:
    """All rectangles (first and after last in both directions) of true cells that cannot be made larger."""
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
