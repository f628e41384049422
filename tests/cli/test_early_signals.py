"""Ctrl-C, SIGTERM and SIGHUP while gproof is still imported: one line and exit 130, whatever is imported."""

from __future__ import annotations

import signal
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

# The command as its script begins it; the process gets a signal as soon as a module is looked for.
AT = """
import os, sys
module, number = sys.argv[1], int(sys.argv[2])
class Signals:
    def find_spec(self, name, path=None, target=None):
        if name == module:
            os.kill(os.getpid(), number)
sys.meta_path.insert(0, Signals())
sys.argv = ["gproof", "--version"]
from gproof.cli.entry import main
sys.exit(main())
"""


@pytest.mark.parametrize(
    ("module", "number"),
    [("gproof.cli.main", signal.SIGINT), ("click", signal.SIGTERM), ("gproof.passes.checks.registry", signal.SIGINT),
     ("gproof.cli.options", signal.SIGHUP), ("importlib.metadata", signal.SIGINT)],
)  # fmt: skip
def test_while_gproof_is_imported(module: str, number: int, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", AT, module, str(int(number))], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (130, ""), done
    assert done.stderr == "gproof: interrupted\n"


def test_ignored_signals_stay_ignored(tmp_path: Path) -> None:
    words = ["nohup", sys.executable, "-c", AT, "click", str(int(signal.SIGHUP))]
    done = subprocess.run(words, cwd=tmp_path, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done
    assert done.stdout.startswith("gproof ")


def test_the_script_begins_there() -> None:
    project = tomllib.loads((Path(__file__).resolve().parents[2] / "pyproject.toml").read_text())
    assert project["project"]["scripts"] == {"gproof": "gproof.cli.entry:main"}
