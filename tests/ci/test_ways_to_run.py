"""`python -m pytest` finds the tests as `pytest` does, though it puts the root with folders of the same names first."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
IMPORTS_A_NEIGHBOUR = "tests/backend/test_feed.py"


def test_as_a_module() -> None:
    command = [sys.executable, "-m", "pytest", "-q", "--collect-only", IMPORTS_A_NEIGHBOUR]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
