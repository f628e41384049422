"""The ```console blocks of the pages: commands after `$ `, below each what it prints; `...` stands for any lines.

A block of another kind after a line that ends in "Save it as `name`:" is a file that the reader saves.
"""

from __future__ import annotations

import contextlib
import difflib
import io
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

from gproof.cli.main import main
from gproof.ir.kernel_copies import cache_root

ELLIPSIS = "..."
_PLAIN = re.compile(r"gproof(?: [\w./=,:@+-]+)+")
_SAVED = re.compile(r"[Ss]ave (?:it|this) as `([\w.-]+)`:$")


@dataclass(frozen=True)
class Step:
    """A command and the lines below it: text lines first ... stop - 1 of the page, counted from 0."""

    command: str
    expected: list[str]
    first: int
    stop: int


def steps(page: str) -> list[Step]:
    """All commands of a page, in order; for a file to save, one that writes it."""
    lines = page.split("\n")
    out: list[Step] = []
    at, inside, text = 0, False, ""
    while at < len(lines):
        line = lines[at]
        if line.startswith("```"):
            saved = _SAVED.search(text)
            if saved and not inside and line.strip() != "```console":
                end = lines.index("```", at + 1)
                body = "\n".join(lines[at + 1 : end])
                out.append(Step(f"cat >{saved[1]} <<'END OF FILE'\n{body}\nEND OF FILE\n", [], end, end))
                at = end
            else:
                inside = line.strip() == "```console"
            text = ""
        elif inside and line.startswith("$ "):
            command = line[2:]
            while command.endswith("\\"):
                at += 1
                command = command[:-1].rstrip() + " " + lines[at].strip()
            first = stop = at + 1
            while not lines[stop].startswith(("$ ", "```")):
                stop += 1
            out.append(Step(command, lines[first:stop], first, stop))
            at = stop - 1
        elif line.strip():
            text = line
        at += 1
    return out


def matches(expected: list[str], actual: list[str]) -> bool:
    """True when the lines are equal, `...` lines standing for any number of lines."""
    pattern = "".join(r"(?:.*\n)*?" if line == ELLIPSIS else re.escape(line) + r"\n" for line in expected)
    return re.fullmatch(pattern, "".join(f"{line}\n" for line in actual)) is not None


def renewed(expected: list[str], actual: list[str]) -> list[str]:
    """What the page should show: the actual lines, with the page's `...` where they still leave something out."""
    parts: list[list[str]] = [[]]
    for line in expected:
        if line == ELLIPSIS:
            parts.append([])
        else:
            parts[-1].append(line)
    if len(parts) == 1:
        return actual
    head, tail = len(parts[0]), len(parts[-1])
    if head + tail > len(actual):
        return actual
    out, at, end = actual[:head], head, len(actual) - tail
    for part in parts[1:-1]:
        size = min(len(part), end - at)
        begin = max(range(at, end - size + 1), key=lambda b: (_alike(part, actual[b : b + size]), -b))
        out += [ELLIPSIS, *actual[begin : begin + size]]
        at = begin + size
    return [*out, ELLIPSIS, *actual[end:]]


def _alike(old: list[str], new: list[str]) -> tuple[int, float]:
    """Equal lines, then equal characters."""
    same = sum(a == b for a, b in zip(old, new, strict=False))
    return same, difflib.SequenceMatcher(None, "\n".join(old), "\n".join(new)).ratio()


class Shell:
    """Runs commands one after another in a folder; `gproof` is the one under test; `cd` and `$?` last.

    here: what needs no shell (`gproof` with plain words) is a call in this process, for less than a process costs.
    """

    def __init__(self, folder: Path, *, here: bool = False) -> None:
        self.folder, self.exit_code, self.here = folder, 0, here
        commands = self.commands = folder / ".commands"
        commands.mkdir()
        gproof = commands / "gproof"
        gproof.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m gproof.cli.main "$@"\n', encoding="utf-8")
        gproof.chmod(0o755)
        self.environment = {
            **{k: v for k, v in os.environ.items() if not k.startswith(("GPROOF_", "PYTEST_", "XDG_"))},
            "PATH": f"{commands}:{os.environ['PATH']}",
            "HOME": str(commands),
            "GPROOF_CACHE_DIR": str(cache_root()),
            "LC_ALL": "C.UTF-8",
            "COLUMNS": "100",
        }

    def run(self, command: str) -> list[str]:
        """The lines that a command prints, on both streams."""
        if self.here and _PLAIN.fullmatch(command):
            return self._call(command.split()[1:])
        done = subprocess.run(
            ["bash", "-c", f"trap 'pwd >{self.commands}/folder' EXIT; (exit {self.exit_code}); {command}"],
            cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, encoding="utf-8", check=False,
        )  # fmt: skip
        self.exit_code = done.returncode
        self.folder = Path((self.commands / "folder").read_text(encoding="utf-8").strip())
        return done.stdout.splitlines()

    def _call(self, words: list[str]) -> list[str]:
        printed = io.BytesIO()
        streams = [io.TextIOWrapper(printed, encoding="utf-8", write_through=True) for _ in range(2)]
        with (
            contextlib.chdir(self.folder),
            mock.patch.dict(os.environ, self.environment, clear=True),
            contextlib.redirect_stdout(streams[0]),
            contextlib.redirect_stderr(streams[1]),
        ):
            self.exit_code = main(words)
        return printed.getvalue().decode("utf-8").splitlines()
