"""A revision's packages in a folder of their own, and processes that run them."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
WORKER = Path(__file__).with_name("worker.py")


class NotComparable(Exception):
    """Why nothing could be compared."""


def site_of(source: Path, site: Path) -> Path:
    """The packages of a source tree, as installing would lay them out, with bytecode where there is some."""
    drafts = shutil.ignore_patterns("*.pyc.*")  # of a process that writes bytecode now
    project = tomllib.loads((source / "pyproject.toml").read_text(encoding="utf-8"))
    for package, folder in project["tool"]["setuptools"]["package-dir"].items():
        target = site / Path(*package.split("."))
        shutil.copytree(source / folder, target, ignore=drafts, dirs_exist_ok=True)
    about = project["project"]
    facts = site / f"{about['name']}-{about['version']}.dist-info"
    facts.mkdir(parents=True)
    facts.joinpath("METADATA").write_text(
        f"Metadata-Version: 2.1\nName: {about['name']}\nVersion: {about['version']}\n"
    )
    scripts = "".join(f"{name} = {entry}\n" for name, entry in about["scripts"].items())
    facts.joinpath("entry_points.txt").write_text(f"[console_scripts]\n{scripts}")
    return site


def site_of_revision(revision: str) -> Path:
    """The packages of a git revision below ``build/replay``, made once for each commit."""
    commit = _git("rev-parse", "--verify", "--quiet", f"{revision}^{{commit}}").strip()
    site = ROOT / "build" / "replay" / commit
    if not site.exists():
        site.parent.mkdir(parents=True, exist_ok=True)
        with tree_of_revision(revision) as source, tempfile.TemporaryDirectory(dir=site.parent) as folder:
            site_of(source, Path(folder) / "site").rename(site)
    return site


@contextlib.contextmanager
def tree_of_revision(revision: str) -> Iterator[Path]:
    """The files of a git revision, for a while."""
    with tempfile.TemporaryDirectory() as folder:
        source, archive = Path(folder) / "source", Path(folder) / "source.tar"
        source.mkdir()
        _git("archive", "-o", str(archive), f"{revision}^{{commit}}")
        shutil.unpack_archive(archive, source, filter="data")
        yield source


def _git(*words: str) -> str:
    done = subprocess.run(("git", *words), cwd=ROOT, text=True, capture_output=True, check=False)
    if done.returncode != 0:
        raise NotComparable(f"git {' '.join(words[:4])} ended with {done.returncode} {done.stderr.strip()}")
    return done.stdout


def entry_of(site: Path | None) -> str:
    """``module:function`` of the command, as the revision's project file says."""
    if site is None:
        return str(tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["scripts"]["gproof"])
    lines = next(site.glob("*.dist-info")).joinpath("entry_points.txt").read_text("utf-8").splitlines()
    return next(line.partition("=")[2].strip() for line in lines if line.startswith("gproof ="))


class Runner:
    """A process with one revision; None: the tree at hand."""

    def __init__(self, site: Path | None) -> None:
        words = [sys.executable, str(WORKER), entry_of(site), *([str(site)] if site else [])]
        fixed = {"COLUMNS": "120", "PYTHONPATH": str(site) if site else "", "PYTHONSAFEPATH": "1", "NO_COLOR": "1"}
        self._running = subprocess.Popen(
            words, cwd=ROOT, env={**os.environ, **fixed}, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )

    def ask(self, question: dict[str, Any]) -> None:
        """Begin a case."""
        assert self._running.stdin is not None
        try:
            print(json.dumps(question), file=self._running.stdin, flush=True)
        except BrokenPipeError:
            raise NotComparable("a process that runs gproof has ended") from None

    def answer(self) -> dict[str, str]:
        """What the case left behind, by aspect."""
        assert self._running.stdout is not None
        line = self._running.stdout.readline()
        if not line:
            raise NotComparable("a process that runs gproof has ended")
        found: dict[str, str] = json.loads(line)
        return found

    def close(self) -> None:
        assert self._running.stdin is not None
        self._running.stdin.close()
        self._running.wait()
