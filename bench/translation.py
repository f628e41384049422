"""``gproof translate`` of CAM programs compared with ``gproof check`` of the same ones, in the same run.

Translating reads the program, rewrites and writes it, reads back what was written, runs both and compares them.
Checking reads, runs and judges the source alone. So the ratio says what a translation costs, whatever machine this is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from measure import Runs, gproof_command, run_once
from programs import MACHINES

SOURCES = {
    "eding": (".ngc", MACHINES / "machine.toml"), "wincnc": (".tap", MACHINES / "WINCNC.INI"),
    "mcuwin": (".din", MACHINES / "mcuwin.toml"),
}  # fmt: skip
"""Suffix of programs and machine, by dialect."""
TARGETS = {name: machine for name, (_, machine) in SOURCES.items()} | {
    "linuxcnc": MACHINES / "machine.toml", "grbl": MACHINES / "machine.toml",
}  # fmt: skip
"""Machine by target."""
SHAPES = ("raster", "arcs")
LINES, SMALL = 1_000_000, 100
LOADED = 20_000
"""Lines that McuWIN's controller surely loads."""
GOAL_RATIO, GOAL_MB, GOAL_SMALL_S = 10.0, 1_500.0, 0.6
VERDICTS = (0, 1, 2)
"""Exit codes where McuWIN is a side: a program may be longer than its controller loads."""


def translate_command(gproof: Sequence[str], job: Path, machine: Path, to: str, output: Path) -> list[str]:
    """``gproof translate`` of a job, with both machines."""
    machines = ["--machine", str(machine), "--machine-to", str(TARGETS[to])]
    return [*gproof, "translate", str(job), *machines, "--to", to, "-o", str(output)]


def measured(
    folder: Path, program: Callable[[str, int, str], Path], environment: Mapping[str, str], gproof: Sequence[str],
    *, shapes: Sequence[str], repeat: int, lines: int = LINES,
) -> list[dict[str, Any]]:  # fmt: skip
    """One row a pair and size: dialect, target, shape, lines, the runs of both commands, and the ratio of their
    processor times. program: shape, lines and suffix -> its file. A small job is run so often, a long one once."""
    rows = []
    for dialect, (suffix, machine) in SOURCES.items():
        for size, which in ((SMALL, shapes[:1]), (lines, shapes)):
            for shape in which:
                job = program(shape, size, suffix)
                for to in TARGETS if size == SMALL else ():  # compile every kernel and module
                    for mode in ("numba", "python"):
                        command = translate_command(gproof, job, machine, to, folder / f"first-{to}")
                        run_once(command, dict(environment) | {"GPROOF_KERNELS": mode}, Runs())
                checked = Runs()
                run_once(gproof_command(job, machine), environment, checked, VERDICTS)
                for to in TARGETS:
                    output = folder / f"translated-{dialect}-{to}"
                    runs = Runs()
                    accepted = VERDICTS if to == "mcuwin" and size > LOADED else (0,)
                    for _ in range(repeat if size == SMALL else 1):
                        run_once(translate_command(gproof, job, machine, to, output), environment, runs, accepted)
                    output.unlink(missing_ok=True)
                    about = {"dialect": dialect, "to": to, "shape": shape, "lines": size}
                    runs_of = {"translate": runs.as_json(), "check": checked.as_json()}
                    rows.append({**about, "ratio": runs.cpu / checked.cpu, **runs_of})
                if size == lines:
                    job.unlink()
    return rows


def show(rows: Sequence[Mapping[str, Any]]) -> None:
    """The rows as a table."""
    print("\nTranslation, seconds of the whole process, both machines given")
    print(f"  {'':<20} {'':>9}  {'':<6} {'translate':^17} {'check':>7}  {'':>5} {'peak':>5}")
    print(
        f"  {'from':<9}{'to':<11} {'lines':>9}  {'shape':<6} {'wall':>8} {'cpu':>8} {'cpu':>7}  {'ratio':>5}"
        f" {'MB':>5}  goal"
    )
    for row in rows:
        runs, peak = row["translate"], row["translate"]["peak_mb"]
        wall, cpu = sorted(runs["wall_s"])[len(runs["wall_s"]) // 2], min(runs["cpu_s"])
        if row["lines"] == SMALL:
            goal = f"at most {GOAL_SMALL_S:g} s  {_verdict(wall <= GOAL_SMALL_S)}"
        else:
            met = row["ratio"] <= GOAL_RATIO and peak <= GOAL_MB
            goal = f"ratio at most {GOAL_RATIO:g}, {GOAL_MB:g} MB  {_verdict(met)}"
        print(
            f"  {row['dialect']:<9}{row['to']:<11} {row['lines']:>9,}  {row['shape']:<6} {wall:8.2f} {cpu:8.2f} "
            f"{min(row['check']['cpu_s']):7.2f}  {row['ratio']:5.1f} {peak:5.0f}  {goal}"
        )
        for name in ("translate", "check"):
            if "problem" in row[name]:
                print(f"             ! {name}: {row[name]['problem']}")


def _verdict(met: bool) -> str:
    return "PASS" if met else "MISS"
