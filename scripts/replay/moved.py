"""Cases of another revision, wherever they are now: whether the same files are here.

Both revisions of a replay read the programs of the tree at hand. That says nothing of a case that went missing, so the
other revision's own list (its cases.py, over its own tree) is held against the one at hand: by name, and where a case
has moved, by what its program, machine and setup hold.
"""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from revisions import NotComparable

LIST = """
import json, sys
sys.path.insert(0, sys.argv[1])
from cases import all_cases
for case in all_cases():
    files = [str(case.program), str(case.machine or ""), case.setup or ""]
    print(json.dumps([case.name, files, [case.dialect, *case.options, *case.check]]))
"""
PARTS = ("program", "machine", "setup", "options")


@dataclass(frozen=True)
class Held:
    """A case by the content of its parts, in the order of PARTS."""

    name: str
    parts: tuple[str, ...]


def cases_of(tree: Path) -> list[Held]:
    """What the replay of a tree runs."""
    words = [sys.executable, "-c", LIST, str(tree / "scripts" / "replay")]
    environment = {**os.environ, "PYTHONPATH": "", "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(words, cwd=tree, env=environment, text=True, capture_output=True, check=False)
    if done.returncode != 0:
        raise NotComparable(f"the cases of {tree} cannot be listed: {done.stderr.strip()[-300:]}")
    return [
        Held(name, (*map(_content, files), " ".join(options)))
        for name, files, options in map(json.loads, done.stdout.splitlines())
    ]


def _content(file: str) -> str:
    """A hash of the file; a word that names none is itself."""
    path = Path(file)
    return hashlib.sha256(path.read_bytes()).hexdigest() if file and path.is_file() else file


def lost(before: list[Held], now: list[Held]) -> Iterator[str]:
    """A line for each case of before that is not here as it was."""
    by_name = {case.name: case for case in now}
    contents = {case.parts for case in now}
    for case in before:
        here = by_name.get(case.name)
        if case.parts in contents:
            continue
        if here is None:
            yield f"{case.name}: not here, nor its files elsewhere"
        else:
            others = [what for what, a, b in zip(PARTS, case.parts, here.parts, strict=True) if a != b]
            yield f"{case.name}: another {', another '.join(others)}"
