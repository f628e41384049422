"""Loops of plain words and arithmetic: executed blocks a second, of the whole process, for each kind of loop.

A program of twenty lines that runs for long: what is measured is execution, not reading. ``drift`` never ends and meets
the budget; the others end by themselves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from measure import Runs, run_once
from programs import MACHINES

BLOCKS = 2_000_000
GOAL = 200_000
VERDICTS = (0, 1, 2)

EDING = "G21 G90 G17 G40 G49 G54\nF1000\nG0 X0 Y0 Z5\n#1 = 0\n"
WINCNC = "G90\nG0 X20 Y20\nG0 Z2\nF100\n"
DIN = "$DINEND\nvar\n  step : double;\n  point : integer;\n{$DINSTART}\n%P\nG53\nG90\nG94\nstep := 0.0005\npoint := 0\n"
DIN += "G00 X0 Y0 Z5\nG01 Z-1 F300\n"
PASS = "G01 X(point * step) Y(12 + point * 0.0001)\nG01 X(point * step + 1)\n"
COUNT = "point := point + 1\n"


def programs() -> dict[tuple[str, str], tuple[str, str, Path]]:
    """(dialect, loop): suffix, text, machine. Passes have 4 blocks, cells 9: the way there, and 8 lines."""
    passes = BLOCKS // 4
    eding, din, ini = MACHINES / "machine.toml", MACHINES / "mcuwin.toml", MACHINES / "WINCNC.INI"
    while_body = "G1 X[#1 * 0.0005] Y[12 + #1 * 0.0001]\nG1 Z[0 - #1 * 0.000001]\n#1 = [#1 + 1]\n"
    round_body = "G1 X[#1 * 0.00001] Y0\nG2 X[#1 * 0.00001 + 1] Y1 R1\n#1 = [#1 + 1]\n"
    dwell_body = "G1 X[#1 * 0.0005] Y0\nG4 P[#1 * 0.000001]\n#1 = [#1 + 1]\n"
    square = "G92 XY\nG1 Z-1 F50\nG1 X0.1\nG1 Y0.1\nG1 X0\nG1 Y0\nG1 Z2\nG0 X0.05\n"
    return {
        ("Eding", "while"): (".cnc", f"{EDING}while [#1 < {passes}]\n{while_body}endwhile\nM30\n", eding),
        ("Eding", "drift"): (
            ".cnc", f"{EDING}G91\nwhile [1 == 1]\n#1 = [#1 + 1]\nG1 X0.0000001\nendwhile\nM30\n", eding,
        ),
        ("Eding", "radius"): (
            ".cnc",
            f"{EDING}while [#1 < {passes}]\n{round_body}endwhile\nM30\n",
            eding,
        ),
        ("Eding", "dwell"): (
            ".cnc",
            f"{EDING}while [#1 < {passes}]\n{dwell_body}endwhile\nM30\n",
            eding,
        ),
        ("WinCNC", "array"): (".tap", f"{WINCNC}L10 R{BLOCKS // 9} C1 X0 Y0.001\n{square}", ini),
        ("McuWIN", "while"): (
            ".din", f"{DIN}$while point < {passes} do begin\n{PASS}{COUNT}$end;\nM30\n%\n", din,
        ),
        ("McuWIN", "repeat"): (".din", f"{DIN}$repeat\n{PASS}{COUNT}$until point >= {passes};\nM30\n%\n", din),
        ("McuWIN", "for"): (
            ".din", f"{DIN}$for point := 1 to {passes} do begin\n{PASS}step := step * 1.0\n$end;\nM30\n%\n", din,
        ),
        ("McuWIN", "label"): (".din", f"{DIN}L5\n{PASS}{COUNT}M96 L5\n", din),
        ("McuWIN", "calls"): (".din", f"{DIN}M98 L7 O{passes}\nM30\n%\n%7\n{PASS}{COUNT}M17\n%\n", din),
    }  # fmt: skip


MACROS = MACHINES / "macros" / "probing.cnc"
"""Routines of a shop that measures a surface point by point with another try after a miss, corners, holes and tools."""
PROBING = ("surface_grid", "find_corner", "find_hole", "measure_tool")
GOAL_PROBING = 10.0, 500.0
"""Seconds and MB."""


def probing(environment: Mapping[str, str], gproof: Sequence[str]) -> list[dict[str, Any]]:
    """One row a probing macro: its name and its runs."""
    rows = []
    for name in PROBING:
        runs = Runs()
        machine = str(MACHINES / "machine.toml")
        command = [*gproof, "check", "--setup", "zero", "--machine", machine, "--dialect", "eding"]
        run_once([*command, "--call", name, str(MACROS)], environment, runs, VERDICTS)
        rows.append({"macro": name, "runs": runs.as_json()})
    return rows


def show_probing(rows: Sequence[Mapping[str, Any]]) -> None:
    """The rows as a table."""
    print("\nProbing macros, judged with --call: outcomes of contacts that are not known")
    seconds, most = GOAL_PROBING
    for row in rows:
        cpu, peak = min(row["runs"]["cpu_s"]), row["runs"]["peak_mb"]
        verdict = "PASS" if cpu <= seconds and peak <= most else "MISS"
        print(f"  {row['macro']:<14} {cpu:6.2f} s {peak:5.0f} MB  at most {seconds:g} s, {most:g} MB  {verdict}")


def measured(
    folder: Path, environment: Mapping[str, str], gproof: Sequence[str], repeat: int
) -> list[dict[str, Any]]:  # fmt: skip
    """One row a program: dialect, loop, blocks a second of the best run, and the runs."""
    rows = []
    for (dialect, loop), (suffix, text, machine) in programs().items():
        job = folder / f"loop-{loop}{suffix}"
        job.write_text(text, encoding="ascii")
        command = [
            *gproof,
            "check",
            "--setup",
            "zero",
            "--machine",
            str(machine),
            "--max-blocks",
            str(BLOCKS),
            str(job),
        ]
        runs = Runs()
        for _ in range(min(2, repeat)):
            run_once(command, environment, runs, VERDICTS)
        rows.append({"dialect": dialect, "loop": loop, "rate": BLOCKS / runs.cpu, "runs": runs.as_json()})
    return rows


def show(rows: Sequence[Mapping[str, Any]]) -> None:
    """The rows as a table."""
    print(f"\nLoops of plain words and arithmetic, {BLOCKS:,} blocks, whole process: blocks a second of processor time")
    for row in rows:
        verdict = "PASS" if row["rate"] >= GOAL else "MISS"
        problem = row["runs"].get("problem", "")
        name = f"{row['dialect']:<8} {row['loop']:<8}"
        print(f"  {name} {row['rate']:>10,.0f}  at least {GOAL:,}  {verdict}  {problem}".rstrip())
