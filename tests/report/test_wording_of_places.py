"""GP304 says what a place depends on, and between what that lies, in one sentence that a person can read."""

from __future__ import annotations

from pathlib import Path

import pytest

from gproof.cli.main import main

AXES = "".join(f"[axes.{axis}]\nmin = 0.0\nmax = 600.0\n" for axis in "xyz")
MACHINE = f'schema = "gproof-machine/1"\nunits = "mm"\n[controller]\ndialect = "eding"\n{AXES}'
SETUP = """schema = "gproof-setup/1"
units = "mm"
homed = ["x", "y", "z"]
active_work = 1
tool = 0
start = {{x = 0.0, y = 0.0, z = 100.0}}
g92 = {{x = 0.0, y = 0.0, z = 0.0}}
[work.1]
x = {work}
y = 0.0
z = 0.0
[parameters]
10 = [0, 700]
"""


def said(
    folder: Path, capsys: pytest.CaptureFixture[str], lines: str, work: str = "0.0", block_delete: str = ""
) -> str:
    (folder / "machine.toml").write_text(MACHINE)
    setup = SETUP.format(work=work) if work else SETUP.format(work="0.0").replace("x = 0.0\ny = 0.0", "y = 0.0")
    (folder / "setup.toml").write_text(setup.replace("tool = 0\n", f"tool = 0\n{block_delete}"))
    job = folder / "job.cnc"
    job.write_text(f"G21 G90 G94 G17 G40 G49 G54\n{lines}M30\n")
    main(["check", str(job), "--machine", str(folder / "machine.toml"), "--setup", str(folder / "setup.toml")])
    told = [line for line in capsys.readouterr().out.splitlines() if "GP304" in line]
    return told[0].split("] ", 1)[1] if told else ""


KNOWN = "block_delete = false\n"


@pytest.mark.parametrize(
    ("lines", "work", "wanted"),
    [
        ("G0 X580\n", "[0, 50]", "G54 X offset, which is 0 to 50 mm; only -580.000 to 20.000 mm is safe"),
        (
            "G0 X#10\n",
            "0.0",
            "a value of X with known limits only (no. 1), which is 0 to 700 mm; only 0.000 to 600.000 mm is safe",
        ),
        (
            "G0 X#10\n",
            "[0, 50]",
            "G54 X offset + a value of X with known limits only (no. 1), which is 0 to 750 mm; "
            "only 0.000 to 600.000 mm is safe",
        ),
    ],
)  # fmt: skip
def test_a_place_that_may_be_past_a_limit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], lines: str, work: str, wanted: str
) -> None:
    assert said(tmp_path, capsys, lines, work, KNOWN) == f"the position of X depends on {wanted}"
