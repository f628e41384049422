"""Whole processes measured from outside: wall time, processor time, peak memory.

The process that measures stays small (no numpy here): on Linux a child's peak memory counts from that of
the process that starts it.
"""

from __future__ import annotations

import os
import statistics
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(slots=True)
class Runs:
    """Repeated runs of one command. wall_s, cpu_s: seconds of each run; peak_mb: the largest, MB of 10**6 bytes."""

    wall_s: list[float] = field(default_factory=list)
    cpu_s: list[float] = field(default_factory=list)
    peak_mb: float = 0.0
    problem: str = ""

    @property
    def best(self) -> float:
        return min(self.wall_s)

    @property
    def median(self) -> float:
        return statistics.median(self.wall_s)

    @property
    def cpu(self) -> float:
        return min(self.cpu_s)

    def as_json(self) -> dict[str, object]:
        out: dict[str, object] = {"wall_s": self.wall_s, "cpu_s": self.cpu_s, "peak_mb": self.peak_mb}
        return {**out, "problem": self.problem} if self.problem else out


def run_once(
    command: Sequence[str], environment: Mapping[str, str], into: Runs, accepted: Sequence[int] = (0,)
) -> str:  # fmt: skip
    """Run a command and note its figures; returns its standard output. What fails is ``problem``.

    accepted: exit codes that are no failure.
    """
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        actions = [
            (os.POSIX_SPAWN_OPEN, 0, os.devnull, os.O_RDONLY, 0),
            (os.POSIX_SPAWN_DUP2, out.fileno(), 1),
            (os.POSIX_SPAWN_DUP2, err.fileno(), 2),
        ]
        began = time.perf_counter()
        process = os.posix_spawn(command[0], list(command), dict(environment), file_actions=actions)
        _, status, used = os.wait4(process, 0)
        into.wall_s.append(time.perf_counter() - began)
        into.cpu_s.append(used.ru_utime + used.ru_stime)
        into.peak_mb = max(into.peak_mb, used.ru_maxrss * (1 if sys.platform == "darwin" else 1024) / 1e6)
        out.seek(0)
        err.seek(0)
        text = out.read().decode(errors="replace")
        code = os.waitstatus_to_exitcode(status)
        if code not in accepted and not into.problem:
            last = (err.read().decode(errors="replace") + text).strip().splitlines()
            into.problem = f"exit code {code}: {last[-1] if last else 'no output'}"
    return text


def gproof_itself() -> list[str]:
    """The command as installed beside this Python."""
    script = Path(sys.executable).with_name("gproof")
    return [str(script)] if script.exists() else [sys.executable, "-m", "gproof.cli.main"]


def gproof_command(job: Path, machine: Path) -> list[str]:
    """``gproof check`` of a job."""
    return [*gproof_itself(), "check", str(job), "--machine", str(machine), "--setup", "zero"]


def rs274_command(program: Path, tool: str) -> list[str]:
    """rs274's interpreter over a program; what it prints is thrown away, which spares it the disk."""
    return [tool, "-g", str(program), os.devnull]
