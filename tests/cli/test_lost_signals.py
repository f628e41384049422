"""An interrupt where Python drops exceptions (callbacks) ends the command even so."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

# The command as it is; an object that goes while the program is read sends the signal from its ``__del__``.
DROPPED = """
import importlib, os, sys
module, number, *words = sys.argv[1:]
place = importlib.import_module(module)
real = place.load_program
class Dropped:
    def __del__(self):
        os.kill(os.getpid(), int(number))
        for _ in range(1000):  # the handler runs here
            pass
def called(*args, **kwargs):
    Dropped()
    import time
    time.sleep(20)
    return real(*args, **kwargs)
place.load_program = called
from gproof.cli.entry import main
sys.exit(main(words))
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_from_a_callback(number: int, tmp_path: Path) -> None:
    (tmp_path / "job.cnc").write_text("g21 g90\nm30\n")
    words = [sys.executable, "-c", DROPPED, "gproof.frontend.eding.load", str(int(number)), "check", "job.cnc"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=15)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "gproof: interrupted\n")
