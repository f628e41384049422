"""Triangles of an STL file, binary or text, and whether they enclose something.

The layouts are those of the StereoLithography Interface Specification (3D Systems, 1989): a text of facets, or 80
bytes, a number of triangles and 50 bytes for each. The file has no unit. ``StlError`` says what is wrong and where.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import numpy.typing as npt

from gproof.ir.record import record

Floats = npt.NDArray[np.float64]

MOST_TRIANGLES = 10_000_000
LARGEST = 1e7
"""Of a coordinate, file units."""
_BINARY = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
_VERTEX = re.compile(rb"^\s*vertex\s+(\S{1,64})\s+(\S{1,64})\s+(\S{1,64})\s*$", re.IGNORECASE)
"""Numbers of so many characters are those of the array that they are read into."""


class StlError(ValueError):
    """What keeps a file from being a mesh; line: of a text file, 0 for none."""

    def __init__(self, what: str, line: int = 0) -> None:
        super().__init__(what)
        self.line = line


@record(slots=True)
class Triangles:
    """corners: (n, 3, 3) in file units, counter-clockwise as seen from outside; opening: where it is not closed, ""."""

    corners: Floats
    opening: str = ""


def read_stl(path: Path) -> Triangles:
    """The mesh in a file; StlError, OSError."""
    raw = path.read_bytes()
    corners = _text(raw) if _is_text(raw) else _binary(raw)
    if not len(corners):
        raise StlError("it has no triangle")
    bad = np.flatnonzero(~np.isfinite(corners).all(axis=(1, 2)))
    if bad.size:
        raise StlError(f"triangle {bad[0] + 1} has a coordinate that is not a finite number")
    far = np.flatnonzero((np.abs(corners) > LARGEST).any(axis=(1, 2)))
    if far.size:
        raise StlError(f"triangle {far[0] + 1} has a coordinate beyond {LARGEST:g}")
    return _closed(corners)


def _is_text(raw: bytes) -> bool:
    """Binary files may start with "solid" too: then their length is that of their number of triangles."""
    if len(raw) >= 84 and len(raw) == 84 + 50 * int.from_bytes(raw[80:84], "little"):
        return False
    return raw.lstrip()[:5].lower() == b"solid" and b"\0" not in raw[:4096]


def _binary(raw: bytes) -> Floats:
    if len(raw) < 84:
        raise StlError(f"{len(raw)} bytes are not an STL file")
    count = int.from_bytes(raw[80:84], "little")
    if count > MOST_TRIANGLES:
        raise StlError(f"{count} triangles; gproof reads meshes up to {MOST_TRIANGLES} triangles")
    if len(raw) != 84 + 50 * count:
        raise StlError(f"{count} triangles take {84 + 50 * count} bytes, the file has {len(raw)}")
    return np.frombuffer(raw, _BINARY, count, 84)["corners"].astype(np.float64)


def _text(raw: bytes) -> Floats:
    last = 0
    values: list[tuple[bytes, bytes, bytes]] = []
    lines: list[int] = []
    facets = solids = 0
    for number, line in enumerate(raw.splitlines(), 1):
        word = line.split(None, 1)[:1]
        kind = word[0].lower() if word else b""
        if kind == b"vertex":
            found = _VERTEX.match(line)
            if found is None:
                raise StlError("a corner must be vertex and three numbers", number)
            values.append((found[1], found[2], found[3]))
            lines.append(number)
        elif kind == b"endfacet":
            facets += 1
            if len(values) != 3 * facets:
                raise StlError(f"a facet of {len(values) - 3 * (facets - 1)} corners is not a triangle", number)
            if facets > MOST_TRIANGLES:
                raise StlError(f"more than {MOST_TRIANGLES} triangles", number)
        elif kind in _ENDS:
            solids += _ENDS[kind]
            last = number
        elif kind not in _WORDS:
            raise StlError("this is not a line of a text STL file", number)
    if len(values) != 3 * facets:
        raise StlError("it ends within a facet", lines[-1] if lines else 0)
    if solids:
        raise StlError("a solid is not closed: endsolid is missing" if solids > 0 else "endsolid without solid", last)
    try:
        corners = np.array(values, dtype="S64").astype(np.float64) if values else np.zeros((0, 3))
    except ValueError:
        number = next(n for n, row in zip(lines, values, strict=True) if not all(_is_number(one) for one in row))
        raise StlError("a coordinate is not a number", number) from None
    return corners.reshape(-1, 3, 3)


_WORDS = (b"", b"facet", b"outer", b"endloop")
_ENDS = {b"solid": 1, b"endsolid": -1}


def _is_number(text: bytes) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _closed(corners: Floats) -> Triangles:
    """Turned outwards, where it encloses something: each edge is passed once each way."""
    points, of = _welded(corners)
    whole = (of[:, 0] != of[:, 1]) & (of[:, 1] != of[:, 2]) & (of[:, 2] != of[:, 0])
    corners, of = corners[whole], of[whole]
    if not len(of):
        raise StlError("all its triangles are points or lines")
    begin, end = of.ravel(), of[:, [1, 2, 0]].ravel()
    count = len(points)
    ways, back = np.sort(begin * count + end), np.sort(end * count + begin)
    if not np.array_equal(ways, back) or (ways[1:] == ways[:-1]).any():
        return Triangles(corners, _opening(ways, points))
    volume = float(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum()) / 6.0
    if volume < 0.0:
        corners = corners[:, ::-1]
    return Triangles(np.ascontiguousarray(corners), "" if volume else "it has no volume")


def _welded(corners: Floats) -> tuple[Floats, npt.NDArray[np.int64]]:
    """(m, 3) places and (n, 3) which of them the corners are: those of equal numbers are one."""
    flat = corners.reshape(-1, 3) + 0.0
    key = np.zeros(len(flat), dtype=np.int64)
    for axis in range(3):
        # Ranks, so that a pair of them is a number again; ten times faster than rows as such.
        values, rank = np.unique(flat[:, axis], return_inverse=True)
        key = np.unique(key * len(values) + rank, return_inverse=True)[1]
    first = np.zeros(int(key.max()) + 1, dtype=np.int64)
    first[key[::-1]] = np.arange(len(key) - 1, -1, -1)
    return flat[first], key.reshape(-1, 3)


def _opening(ways: npt.NDArray[np.int64], points: Floats) -> str:
    """An edge that is not passed once each way."""
    begin, end = np.divmod(ways, len(points))
    edges, count = np.unique(np.minimum(begin, end) * len(points) + np.maximum(begin, end), return_counts=True)
    single = edges[count == 1]
    if single.size:
        return f"{single.size} edges have one triangle only, such as {_edge(int(single[0]), points)}"
    if (count > 2).any():
        return f"more than two triangles meet at {_edge(int(edges[count > 2][0]), points)}"
    passed, times = np.unique(ways, return_counts=True)
    return f"neighbouring triangles face different sides at {_edge(int(passed[times > 1][0]), points)}"


def _edge(edge: int, points: Floats) -> str:
    ends = (points[edge // len(points)], points[edge % len(points)])
    return " to ".join(f"X {x:.4f} Y {y:.4f} Z {z:.4f}" for x, y, z in (end.tolist() for end in ends))
