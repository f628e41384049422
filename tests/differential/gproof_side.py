"""Runs gproof's command on a program and gives the rows of its trace.

Twice the same thing: `by_command` starts the installed command (what a user has), `in_process` calls the
command's function in this process (fast enough for hundreds of programs).
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
import json
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest import mock

Row = dict[str, Any]

HERE = Path(__file__).parent
MACHINE = HERE / "machine.toml"
START = "import sys; from gproof.cli.main import main; sys.exit(main())"


@dataclass(frozen=True)
class Said:
    """What a command said: exit code, output, and what it wrote beside it."""

    code: int
    output: str
    errors: str

    def rows(self) -> list[Row]:
        """The rows of a trace; raises AssertionError with everything that was said if these are none."""
        try:
            rows = [json.loads(line) for line in self.output.splitlines() if line.strip()]
        except json.JSONDecodeError as broken:
            raise AssertionError(f"gproof printed what is no JSON: {broken}\n{self}") from broken
        if not rows or not all(isinstance(row, dict) and "op" in row for row in rows):
            raise AssertionError(f"gproof printed no trace\n{self}")
        return rows

    def __str__(self) -> str:
        return f"exit {self.code}\n{self.output.strip()}\n{self.errors.strip()}"


def missing() -> str | None:
    """Why gproof's command can not run here, or None."""
    try:
        found = importlib.util.find_spec("gproof.cli.main")
    except ModuleNotFoundError:
        found = None
    return None if found else "gproof.cli.main is not installed"


def dump_arguments(program: Path, setup: Path | None) -> list[str]:
    return [
        *("dump", "--stage", "trace", "--format", "jsonl"),
        *("--setup", "zero" if setup is None else str(setup)),
        *("--machine", str(MACHINE), "--dialect", "eding", str(program)),
    ]


def check_arguments(program: Path) -> list[str]:
    return ["check", "--setup", "zero", "--machine", str(MACHINE), "--dialect", "eding", str(program)]


def by_command(arguments: Sequence[str]) -> Said:
    """Run the command in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-c", START, *arguments], capture_output=True, text=True, check=False, timeout=120
    )
    return Said(done.returncode, done.stdout, done.stderr)


def in_process(arguments: Sequence[str]) -> Said:
    """Call the command's function; an exception that it lets out is the test's failure."""
    from gproof.cli.main import main

    output, errors = io.StringIO(), io.StringIO()
    code: Any = 0
    with (
        mock.patch.object(sys, "argv", ["gproof", *arguments]),
        contextlib.redirect_stdout(output),
        contextlib.redirect_stderr(errors),
    ):
        try:
            code = main()
        except SystemExit as left:
            code = left.code
    return Said(code if isinstance(code, int) else int(code is not None), output.getvalue(), errors.getvalue())
