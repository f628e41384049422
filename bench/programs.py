"""CAM-like programs for the benchmarks, the same bytes on every run and machine.

Coordinates are whole tenths of a micrometre until they are printed, from a counter and integer arithmetic:
no random numbers, no sines. Every program is valid for the Eding controller and for LinuxCNC: G21 G90 G17
G54 G94 at the top, F and S given, M30 at the end, X and Y within 0 ... 500 mm, Z within -50 ... 50 mm; WinCNC and
McuWIN read the lines between.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests"))

from support.bundles import unpacked

MACHINES = unpacked("bench") / "machines"
"""The folder that machines.md holds."""

HEAD = ("(benchmark)", "G21 G90 G17 G54 G94", "S12000 M3", "G0 Z5", "G0 X0 Y0", "G1 Z0 F1500")
TAIL = ("G0 Z5", "M30")

TAP_HEAD = ("[benchmark]", "G22", "G90", "G0 Z5", "G0 X0 Y0", "G1 Z0 F1500")
TAP_TAIL = ("G0 Z5", "[end]")
"""As many lines around the same path, for WinCNC."""

DIN_HEAD = ("'benchmark", "%1", "G90", "G00 Z5", "G00 X1 Y1", "G01 Z0 F1500")
DIN_TAIL = ("G00 Z5", "M30")
"""As many lines around the same path, for McuWIN."""

AROUND = {".tap": (TAP_HEAD, TAP_TAIL), ".din": (DIN_HEAD, DIN_TAIL)}
"""Of other programs than those of Eding, by suffix."""

# Sixteen points of the unit circle times 10000, rounded: an arc's radii at its ends differ a little, as in CAM output.
_RING = (
    (10000, 0), (9239, 3827), (7071, 7071), (3827, 9239), (0, 10000), (-3827, 9239), (-7071, 7071), (-9239, 3827),
    (-10000, 0), (-9239, -3827), (-7071, -7071), (-3827, -9239), (0, -10000), (3827, -9239), (7071, -7071),
    (9239, -3827),
)  # fmt: skip


def mm(tenths: int) -> str:
    """Tenths of a micrometre as CAM systems print millimetres: four decimals, no needless zeros."""
    sign, size = ("-", -tenths) if tenths < 0 else ("", tenths)
    return f"{sign}{size // 10000}.{size % 10000:04d}".rstrip("0")


def _wave(n: int, period: int, height: int) -> int:
    """A smooth wave of a whole number: parabolas up and down, 0 at multiples of period / 2."""
    half = period // 2
    at = n % half
    hill = 4 * height * at * (half - at) // (half * half)
    return hill if n % period < half else -hill


def raster() -> Iterator[str]:
    """Surface finishing: G1 X Y Z on each line, 0.2 mm apart, rows 0.25 mm apart, to and fro."""
    x, y, step, n = 0, 0, 2003, 0
    while True:
        for _ in range(2400):
            x += step
            n += 1
            z = _wave(x + y, 270011, 91007) + _wave(x - 2 * y, 83003, 23011)
            yield f"G1 X{mm(x)} Y{mm(y)} Z{mm(z)}"
        y = (y + 2500) % 5000000
        step = -step
        yield f"G1 X{mm(x)} Y{mm(y)}"


def contours() -> Iterator[str]:
    """Pockets as rings of arcs: G2 or G3 with X Y I J, sixteen to a turn, and a short line between rings."""
    n = 0
    while True:
        column, row = n % 48, n // 48 % 48
        cx, cy, code = 150000 + column * 100003, 150000 + row * 100003, "G3" if n % 2 else "G2"
        ring = _RING if n % 2 else (_RING[0], *_RING[:0:-1])
        for radius in range(8000 + n % 97 * 13, 45000, 4507):
            points = [(cx + radius * a // 10000, cy + radius * b // 10000) for a, b in ring]
            x, y = points[0]
            yield f"G1 X{mm(x)} Y{mm(y)}"
            for to_x, to_y in (*points[1:], points[0]):
                yield f"{code} X{mm(to_x)} Y{mm(to_y)} I{mm(cx - x)} J{mm(cy - y)}"
                x, y = to_x, to_y
        n += 1


def modal() -> Iterator[str]:
    """Lines without G words, with only the words that change, as post-processors write them."""
    x, y, z, n = 0, 0, 0, 0
    while True:
        n += 1
        before = x, y, z
        x = 2500000 + _wave(n * 1009, 4000037, 2400000)
        y = 2500000 + _wave(n * 131, 9000011, 2400000) if n % 7 else y
        z = _wave(n, 911, 40000) if n % 3 == 0 else z
        words = [f"{name}{mm(b)}" for name, a, b in zip("XYZ", before, (x, y, z), strict=True) if a != b]
        if words:
            yield " ".join(words)


def beside() -> Iterator[str]:
    """A contour with cutter radius compensation: turns around a disk, every other of its sixteen sides an arc."""
    cx, cy, radius = 2500000, 2500000, 400000
    ring = (_RING[0], *_RING[:0:-1])
    yield f"G0 X{mm(cx + 300000)} Y{mm(cy + 600000)}"
    yield "G41.1 D4"
    yield f"G1 X{mm(cx + radius)} Y{mm(cy + 300000)}"
    n, x, y = 0, 0, 0
    while True:
        for k, (a, b) in enumerate(ring):
            to_x, to_y = cx + radius * a // 10000, cy + radius * b // 10000
            if k % 2 == 0:
                yield f"G1 X{mm(to_x)} Y{mm(to_y)} Z{mm(_wave(n, 9001, 40000))}"
            else:
                yield f"G2 X{mm(to_x)} Y{mm(to_y)} I{mm(cx - x)} J{mm(cy - y)}"
            x, y = to_x, to_y
            n += 1


SHAPES: dict[str, Callable[[], Iterator[str]]] = {
    "raster": raster, "arcs": contours, "modal": modal, "beside": beside,
}  # fmt: skip


COMMON_SHAPES = ("raster", "arcs", "modal")
"""Shapes whose lines mean the same to WinCNC and McuWIN."""


def write_program(shape: str, lines: int, path: Path) -> None:
    """A program of exactly so many lines; for WinCNC or McuWIN when the file's name ends so (.tap, .din)."""
    head, tail = AROUND.get(path.suffix, (HEAD, TAIL))
    body = lines - len(head) - len(tail)
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.writelines(f"{line}\n" for line in head)
        file.writelines(f"{line}\n" for line in islice(SHAPES[shape](), body))
        file.writelines(f"{line}\n" for line in tail)
