"""Plain Python and compiled kernels give the same bytes: every stage, every report, for the same jobs.

Each speed runs in a process of its own, all jobs one after another, so that compiling is paid for once.
"""

from __future__ import annotations

import json
import os
import random
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from corpus.expectations import expectation
from support.campaigns import sizes
from support.paths import Offsets, RandomPath
from support.wild import ROOT, wild_program

SCRIPT = """
import contextlib, hashlib, io, json, sys
from gproof.cli.main import main
for words in json.load(sys.stdin):
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main(words)
    text = out.getvalue()
    print(json.dumps({"exit": code, "out": hashlib.sha256(text.encode()).hexdigest(), "size": len(text),
                      "head": text[:2000], "err": err.getvalue()[:2000]}))
"""
CORPUS = ("drilled-plate", "guilloche-engraving", "raster-surface")
LIMIT = 60_000
"""Bytes of a corpus job that plain Python does in a moment; of longer ones the first lines are taken."""


def commands(folder: Path, step: int) -> list[list[str]]:
    """Of every step-th job."""
    jobs: list[tuple[Path, list[str]]] = []
    for job in sorted((ROOT / "corpus").glob("*/*/job.cnc")):
        if job.stat().st_size > LIMIT and job.parent.name not in CORPUS:
            continue
        short = folder / f"{job.parent.name}.cnc"
        lines = job.read_bytes()[:LIMIT].splitlines(keepends=True)
        short.write_bytes(b"".join(lines[:-1] if job.stat().st_size > LIMIT else lines))
        machine = expectation(job)["machine"]
        jobs.append((short, ["--machine", machine, "--setup", "zero"]))
        jobs.append((short, ["--machine", machine]))
    machine = ROOT / "corpus" / "eding" / "drilled-plate" / "machine.toml"
    for seed in range(20):
        path = RandomPath(random.Random(seed), [0.0, 0.0, 0.0], Offsets())
        for _ in range(60):
            path.random_move()
        name = folder / f"path-{seed}.cnc"
        name.write_text(path.text)
        jobs.append((name, ["--machine", str(machine), *(["--setup", "zero"] if seed % 2 else [])]))
    for seed in range(80):
        name = folder / f"wild-{seed}.cnc"
        name.write_bytes(wild_program(random.Random(70_000 + seed)))
        jobs.append((name, ["--machine", str(machine), "--setup", "zero"]))
    out = []
    for job, around in jobs[::step]:
        words = [str(job), *around, "--max-blocks", "3000"]
        out.append(["check", *words, "--format", "json"])
        out.append(["dump", *words, "--stage", "trace"])
    # Steps are many: in plain Python only of moves of a few millimetres.
    for seed in range(3):
        name = folder / f"steps-{seed}.cnc"
        rng = random.Random(seed)
        moves = [f"G{rng.choice('01')} X{rng.uniform(9, 12):.3f} Y{rng.uniform(9, 12):.3f}" for _ in range(6)]
        arc = f"G{rng.choice('23')} X{rng.uniform(10, 11):.3f} R{rng.uniform(2, 3):.3f}"
        name.write_text("\n".join(["G21 G90 F900", "G92 X10 Y10 Z10", *moves, arc, "G83 Z9 R11 Q0.5", "M30", ""]))
        for stage in ("plan", "stream"):
            out.append(["dump", str(name), "--machine", str(machine), "--setup", "zero", "--stage", stage])
    board = ROOT / "corpus" / "eding" / "pcb-height-map"
    around = ["--machine", str(board / "cnc.ini"), "--setup", str(board / "setup.toml")]
    out.append(["dump", str(board / "job.cnc"), *around, "--stage", "plan"])
    return out


def results(speed: str, given: list[list[str]]) -> list[dict[str, Any]]:
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        input=json.dumps(given),
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"GPROOF_KERNELS": speed},
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return [json.loads(line) for line in done.stdout.splitlines()]


@pytest.mark.parametrize("step", sizes(10, 1))
def test_both_speeds_give_the_same_bytes(tmp_path: Path, step: int) -> None:
    given = commands(tmp_path, step)
    both = list(zip(given, results("python", given), results("numba", given), strict=True))
    for words, plain, compiled in both:
        assert plain == compiled, " ".join(words)
    # Every command was reached with something to print, and with every verdict.
    exits = {(words[0], plain["exit"]) for words, plain, _ in both}
    assert {("check", 0), ("check", 1), ("check", 2), ("dump", 0)} <= exits
    assert all(plain["exit"] == 0 for words, plain, _ in both if words[-1] in ("plan", "stream"))
    traces = [plain["size"] for words, plain, _ in both if words[-1] == "trace"]
    assert sorted(traces)[-10 // step] > 10_000
    assert not any("internal error" in plain["err"] for _, plain, _ in both)
