"""``gproof check --also gouges`` of surface finishing: a ball nose in short moves over a mesh of 200 × 200 mm.

Used by run.py. The surface is a sum of sines, as 100,000 triangles, floor and sides as many; the tool of 6 mm follows
it 0.01 mm above the contact that samples of the surface give, moves of 0.5 mm in rows. 0.1 mm into the part are
allowed, so that a right answer is SAFE; a pass that is 0.3 mm too deep shows that it is no empty one.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from measure import Runs, run_once

MOVES = (10_000, 1_000_000)
GOAL_SECONDS = 60.0
SIZE, CELLS, RADIUS, ROW = 200.0, 224, 3.0, 400
Floats = npt.NDArray[np.float64]


def surface(x: Floats, y: Floats) -> Floats:
    """The height at places of the part."""
    return -10.0 + 6.0 * np.sin(x / 25.0) * np.cos(y / 32.0) + 1.5 * np.sin(x / 7.0) * np.sin(y / 9.0)


def write_part(path: Path) -> int:
    """The closed mesh as binary STL; how many triangles it has."""
    line = np.linspace(0.0, SIZE, CELLS + 1)
    x, y = np.meshgrid(line, line, indexing="ij")
    top = np.stack([x, y, surface(x, y)], axis=-1)
    floor = top.copy()
    floor[..., 2] = -30.0
    made = []
    for grid in (top, floor[:, ::-1]):
        a, b, c, d = (g.reshape(-1, 3) for g in (grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]))
        made += [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]
    for edge, low in ((top[:, 0], floor[:, 0]), (top[-1], floor[-1]), (top[::-1, -1], floor[::-1, -1]),
                      (top[0, ::-1], floor[0, ::-1])):  # fmt: skip
        made += [np.stack([low[:-1], low[1:], edge[1:]], axis=1), np.stack([low[:-1], edge[1:], edge[:-1]], axis=1)]
    triangles = np.concatenate(made)
    rows = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    rows["corners"] = triangles
    path.write_bytes(b"\0" * 80 + struct.pack("<I", len(rows)) + rows.tobytes())
    return len(rows)


def write_program(path: Path, moves: int, above: float) -> None:
    """Rows of short moves, the tool so far above (mm) where it touches."""
    xs = np.linspace(2.0, SIZE - 2.0, ROW)
    ys = np.linspace(RADIUS, SIZE - RADIUS, max(1, moves // ROW))
    x, y = np.meshgrid(xs, ys)
    x[1::2] = x[1::2, ::-1]
    x, y = x.ravel(), y.ravel()
    z = np.full(len(x), -np.inf)
    offsets = np.linspace(-RADIUS, RADIUS, 25)
    for a in offsets:
        for b in offsets:
            if a * a + b * b <= RADIUS * RADIUS:
                z = np.maximum(z, surface(x + a, y + b) - (RADIUS - np.sqrt(RADIUS * RADIUS - a * a - b * b)))
    with path.open("w", encoding="ascii") as out:
        out.write("G21 G17 G90 G94 G54 G40 G49 G61\nT1 M6\nG43 H1\nM3 S12000\nF3000\nG0 Z30\n")
        out.write(f"G0 X{x[0]:.3f} Y{y[0]:.3f}\n")
        out.writelines(f"G1 X{a:.3f} Y{b:.3f} Z{c:.4f}\n" for a, b, c in zip(x, y, z + above, strict=True))
        out.write("G0 Z30\nM5\nM30\n")


def write_setup(folder: Path) -> int:
    """Machine, setup and part; how many triangles that has."""
    axes = "".join(f"[axes.{axis}]\nmin = -500.0\nmax = 500.0\n" for axis in "xyz")
    (folder / "gouges-machine.toml").write_text(
        f'schema = "gproof-machine/1"\nname = "bench"\nunits = "mm"\n{axes}[tools.1]\nlength = 40.0\nshape = "ball"\n'
        f"diameter = {2.0 * RADIUS}\nflute_length = 20.0\nshank_diameter = {2.0 * RADIUS}\nstickout = 40.0\n",
        encoding="utf-8",
    )
    zero = "x = 0.0\ny = 0.0\nz = 0.0\n"
    (folder / "gouges-setup.toml").write_text(
        'schema = "gproof-setup/1"\nactive_work = 1\nhomed = ["x", "y", "z"]\nstart = {x = 0.0, y = 0.0, z = 80.0}\n'
        f'[work.1]\n{zero}[g92]\n{zero}[workpiece]\ntolerance = 0.1\n[[part]]\nstl = "gouges-part.stl"\n',
        encoding="utf-8",
    )
    return write_part(folder / "gouges-part.stl")


def measure(folder: Path, environment: Mapping[str, str], gproof: list[str], repeat: int) -> list[dict[str, Any]]:
    """For each size the whole process with and without the property, in turn."""
    triangles = write_setup(folder)
    around = ["--machine", str(folder / "gouges-machine.toml"), "--setup", str(folder / "gouges-setup.toml")]
    rows = []
    for moves, above in ((MOVES[0], -0.3), *((n, 0.01) for n in MOVES)):
        job = folder / f"gouges-{moves}{'' if above > 0.0 else '-deep'}.cnc"
        write_program(job, moves, above)
        plain, asked = Runs(), Runs()
        said = ""
        for _ in range(max(1, repeat if moves < MOVES[-1] else repeat // 2)):
            command = [*gproof, "check", str(job), *around, "--dialect", "eding", "--format", "json"]
            run_once(command, environment, plain, (0, 1))
            said = run_once([*command, "--also", "gouges"], environment, asked, (0, 1))
        verdict = json.loads(said)["properties"]["gouges"]["verdict"] if said else "?"
        right = verdict == ("SAFE" if above > 0.0 else "UNSAFE")
        rows.append(
            {"moves": moves, "triangles": triangles, "above": above, "verdict": verdict, "right": right,
             "plain": plain.as_json(), "gouges": asked.as_json()}
        )  # fmt: skip
    return rows


def show(rows: list[dict[str, Any]]) -> None:
    """A line for each size."""
    print(
        f"\nGouges of surface finishing in a mesh of {rows[0]['triangles']:,} triangles, seconds of the whole process"
    )
    print(f"  {'moves':>9} {'without':>8} {'with':>8} {'cpu':>8} {'MB':>5}  verdict")
    for row in rows:
        plain, asked = row["plain"], row["gouges"]
        best = min(asked["wall_s"])
        met = row["right"] and best <= GOAL_SECONDS
        print(
            f"  {row['moves']:9,} {min(plain['wall_s']):8.2f} {best:8.2f} {min(asked['cpu_s']):8.2f} "
            f"{asked['peak_mb']:5.0f}  {row['verdict']} ({row['above']:+g} mm)  {'PASS' if met else 'MISS'}"
        )
        for name in ("plain", "gouges"):
            if "problem" in row[name]:
                print(f"         ! {name}: {row[name]['problem']}")
