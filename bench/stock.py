"""``gproof check --also collisions`` over a finishing job: a ball nose over a wavy surface, stock by cells of 0.1 mm.

Moves of 0.5 mm over 200 mm by 200 mm; the stock is whole before, so that every move cuts.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from measure import Runs, run_once

MOVES = (10_000, 1_000_000)
SIDE, STEP, CELL = 200.0, 0.5, 0.1
GOAL_S = 60.0
"""Of a million moves, the whole process."""
MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = -10.0
max = 210.0
[axes.y]
min = -10.0
max = 210.0
[axes.z]
min = -40.0
max = 10.0
[tools.1]
diameter = 6.0
shape = "ball"
flute_length = 20.0
stickout = 40.0
shank_diameter = 6.0
[controller]
dialect = "eding"
"""
SETUP = f"""schema = "gproof-setup/1"
tool = 1
active_work = 1
start = {{x = 0.0, y = 0.0, z = 5.0}}
work.1 = {{x = 0.0, y = 0.0, z = 0.0}}
g92 = {{x = 0.0, y = 0.0, z = 0.0}}
[workpiece]
cell = {CELL}
[stock]
box = [[0, 0, -30], [{SIDE}, {SIDE}, 0]]
"""


def write_job(path: Path, moves: int) -> None:
    """Rows along X, there and back, over all of Y."""
    each = round(SIDE / STEP)
    rows = max(1, moves // each)
    with path.open("w", encoding="utf-8") as out:
        out.write("G21 G17 G90 G94 G54 G40 G49\nM3 S12000\nF2000\nG0 Z5\nG0 X0 Y0\nG1 Z-5\n")
        for row in range(rows):
            y = row * SIDE / rows
            for n in range(each + 1):
                x = (n if row % 2 == 0 else each - n) * STEP
                z = -5.0 + 3.0 * math.sin(x / 15.0) * math.cos(y / 20.0)
                out.write(f"X{x:.3f} Y{y:.3f} Z{z:.4f}\n")
        out.write("G0 Z5\nM5\nM30\n")


def measured(folder: Path, environment: Mapping[str, str], gproof: list[str], repeat: int) -> list[dict[str, Any]]:
    """For each size the runs with and without stock; the long one once."""
    (folder / "stock-machine.toml").write_text(MACHINE, encoding="utf-8")
    (folder / "stock-setup.toml").write_text(SETUP, encoding="utf-8")
    around = ["--machine", str(folder / "stock-machine.toml"), "--setup", str(folder / "stock-setup.toml")]
    out = []
    for moves in MOVES:
        job = folder / f"finish-{moves}.cnc"
        write_job(job, moves)
        with_stock, plain = Runs(), Runs()
        for _ in range(repeat if moves < 1_000_000 else 1):
            run_once([*gproof, "check", str(job), *around, "--also", "collisions"], environment, with_stock)
            run_once([*gproof, "check", str(job), *around], environment, plain)
        out.append({"moves": moves, "stock": with_stock.as_json(), "plain": plain.as_json()})
        job.unlink()
    return out


def show(rows: list[dict[str, Any]]) -> None:
    """A line for each size."""
    print(f"\nStock that is still there: {SIDE:g} mm square by cells of {CELL:g} mm, moves of {STEP:g} mm")
    print(f"  {'moves':>9} {'check':>8} {'+ stock':>8} {'cpu':>8} {'MB':>6}")
    for row in rows:
        stock, plain = row["stock"], row["plain"]
        best = min(stock["wall_s"])
        goal = "" if row["moves"] < 1_000_000 else "PASS" if best <= GOAL_S else f"over {GOAL_S:g} s"
        print(f"  {row['moves']:9,} {min(plain['wall_s']):8.2f} {best:8.2f} {min(stock['cpu_s']):8.2f}"
              f" {stock['peak_mb']:6.0f}  {goal}")  # fmt: skip
        if "problem" in stock:
            print(f"         ! {stock['problem']}")
