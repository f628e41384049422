"""What ``Kernel.pick`` reckons with, beside what this machine measures.

    python bench/kernels.py [--lines 20000] [--shape raster] [--command check|compile] [--tap]

Runs one job in plain Python, with numba and an empty cache, and with the cache that this left. By kernel: how
much work was asked for, microseconds of a unit in plain Python, seconds to compile, seconds to load the compiled
copy (the first kernel's has numba's own set-up in it), nanoseconds of a unit when compiled. Processor time, so that a
busy machine matters less.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from programs import MACHINES, SHAPES, write_program


def watch() -> dict[str, dict[str, Any]]:
    """From now on note what each kernel that is picked costs, by ``file.kernel``."""
    from gproof.ir.kernel import Kernel

    notes: dict[str, dict[str, Any]] = {}
    plain = os.environ["GPROOF_KERNELS"] == "python"
    pick, wrapped = Kernel.pick, {}

    def timed(run: Callable[..., Any], calls: list[float]) -> Callable[..., Any]:
        def call(*args: Any) -> Any:
            began = time.process_time()
            result = run(*args)
            calls.append(time.process_time() - began)
            return result

        return call

    def watched(self: Any, work: float) -> Any:
        if id(self) not in wrapped:
            wrapped[id(self)] = name = f"{Path(self.python.__code__.co_filename).stem}.{self.python.__name__}"
            declared = {"unit": self.seconds_per_unit, "compile": self.compile_seconds}
            notes[name] = {"declared": declared, "work": 0.0, "picking": [], "calls": []}
            if plain:
                # Callers compare what they get with ``kernel.python``.
                self.python = timed(self.python, notes[name]["calls"])
        note = notes[wrapped[id(self)]]
        note["work"] += work
        began = time.process_time()
        run = pick(self, work)
        note["picking"].append(time.process_time() - began)
        return run if plain else timed(run, note["calls"])

    Kernel.pick = watched  # type: ignore[method-assign]
    return notes


def run_watched(arguments: list[str]) -> None:
    """In a child: one command of gproof, its kernels' costs as JSON."""
    from gproof.cli.main import main as gproof

    began = time.process_time()
    if os.environ["GPROOF_KERNELS"] == "numba":
        import numba  # noqa: F401
    imported = time.process_time() - began
    notes = watch()
    with open(os.devnull, "w", encoding="utf-8") as nowhere, contextlib.redirect_stdout(nowhere):
        gproof(arguments)
    print(json.dumps({"import": imported, "kernels": notes}))


def measured(folder: Path, mode: str, arguments: list[str]) -> dict[str, Any]:
    environment = os.environ | {"GPROOF_KERNELS": mode, "GPROOF_CACHE_DIR": str(folder / "cache")}
    command = [sys.executable, __file__, "--child", *arguments]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(done.stdout + done.stderr)
    answer: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return answer


def main() -> None:
    parser = argparse.ArgumentParser(description="Declared and measured costs of kernels.")
    parser.add_argument("--lines", type=int, default=20_000)
    parser.add_argument("--shape", choices=list(SHAPES), default="raster")
    parser.add_argument("--command", choices=["check", "compile"], default="check")
    parser.add_argument("--tap", action="store_true", help="a job of WinCNC")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="gproof-bench-") as name:
        folder = Path(name)
        job = folder / ("job.tap" if asked.tap else "job.ngc")
        write_program(asked.shape, asked.lines, job)
        machine = "WINCNC.INI" if asked.tap else "machine.toml"
        arguments = [asked.command, str(job), "--machine", str(MACHINES / machine), "--setup", "zero"]
        if asked.command == "compile":
            arguments += ["--unsigned", "-o", str(folder / "job.gpx")]
        plain, cold, warm = (measured(folder, mode, arguments) for mode in ("python", "numba", "numba"))
    print(f"import of numba: {warm['import']:.2f} s\n")
    print(f"{'':<32} {'work':>10}   {'µs a unit':>14}   {'s to compile':>13} {'to load':>7} {'ns a unit':>9}")
    print(f"{'':<32} {'':>10}   {'declared':>8} {'meas':>5}   {'declared':>8} {'meas':>4}")
    for kernel, note in plain["kernels"].items():
        first, again = cold["kernels"].get(kernel), warm["kernels"].get(kernel)
        if not (first and again and first["calls"] and again["calls"] and note["work"]):
            print(f"{kernel:<32} not called")
            continue
        work, declared = note["work"], note["declared"]
        print(
            f"{kernel:<32} {work:10.0f}   {declared['unit'] * 1e6:8.2f} {sum(note['calls']) / work * 1e6:5.2f}   "
            f"{declared['compile']:8.1f} {first['calls'][0] + first['picking'][0]:4.1f} "
            f"{again['calls'][0] + again['picking'][0]:7.3f} {sum(again['calls'][1:]) / work * 1e9:9.0f}"
        )


if __name__ == "__main__":
    if sys.argv[1:2] == ["--child"]:
        run_watched(sys.argv[2:])
    else:
        main()
