"""What the Eding manual does not name is UNKNOWN, never refuted, and only where a job reaches it."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.command import in_this_process

MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = 0
max = 100
[axes.z]
min = -50
max = 0
[controller]
dialect = "eding"
"""
TITLES = " ".join(f'"value {n}" {n}' for n in range(1, 15))
LINES = {
    "command": "GetToolInfo num 3",
    "command without words": "refreshscreen",
    "command with numbers": "ModbusWrite 1 40001 [#1 + 2]",
    "command with signs": 'modbus.read "slave" 1,2 #5',
    "numbered command": "N10 modbuswrite 1 2 ; comment",
    "long dialog": f'dlgmsg "measure" {TITLES}',
    "actual tool": "#5008 = 3",
    "new tool": "#5011 = [#5008 + 1]",
    "later code": "G37 Z-20 F100",
    "later code in an expression": "G[30 + 7]",
    "named parameter": "#<depth> = 3",
    "name with a sign": "gosub tool-change",
    "name with a digit": "gosub 3d_probe",
}
NAMES = "sub tool-change\n#2 = 1\nendsub\nsub 3d_probe\n#2 = 1\nendsub\n"


def check(folder: Path, text: str, *words: str) -> tuple[int, str]:
    (folder / "mill.toml").write_text(MACHINE)
    (folder / "job.cnc").write_text(text)
    done = in_this_process(["check", "job.cnc", "--machine", "mill.toml", "--setup", "zero", *words], folder)
    return done.exit, done.out


KEEP = ("actual tool", "new tool", "name with a sign", "name with a digit")
"""Those that are not followed by a loss of places and variables."""


@pytest.mark.parametrize("name", LINES)
def test_it_is_unknown_and_what_follows_is_not_refuted(name: str, tmp_path: Path) -> None:
    """Neither by a place nor by a variable that the line may have changed, stated ones included."""
    after = "G91\nG0 X60\nG90\n"
    after = "" if name in KEEP else f"{after}G53 G0 X[#1 * 500]\n{after}G53 G0 X[#4200 + 500]\n"
    exit_code, out = check(tmp_path, f"G21 G90\nG53 G0 X90\n#1 = 1\n{LINES[name]}\n{after}G53 G0 X5\nM30\n{NAMES}")
    assert exit_code == 2, out


@pytest.mark.parametrize("name", [name for name in LINES if not name.startswith("name ")])
def test_where_nothing_reaches_it_it_makes_nothing_unknown(name: str, tmp_path: Path) -> None:
    line = LINES[name]
    for text in (
        f"G21 G90\nG53 G0 X5\nif [1 == 2]\n{line}\nendif\nM30\n",
        f"G21 G90\nG53 G0 X5\nM30\nsub never\n{line}\nendsub\n",
    ):
        exit_code, out = check(tmp_path, text)
        assert exit_code == 0, out


@pytest.mark.parametrize("line", LINES.values(), ids=LINES)
def test_a_macro_file_may_hold_it(line: str, tmp_path: Path) -> None:
    subs = f"sub never\n{line}\nendsub\nsub park\nG53 G0 X5\nendsub\n{NAMES}"
    (tmp_path / "macro.cnc").write_text(subs)
    job = "G21 G90\nG53 G0 X5\ngosub park\nM30\n"
    exit_code, out = check(tmp_path, job)
    assert exit_code == 0, out
    for call, wanted in (("park", 0), ("never", 2)):
        exit_code, out = check(tmp_path, job, "--call", call)
        assert exit_code == wanted, out


def test_what_is_wrong_by_the_manual_stays_an_error(tmp_path: Path) -> None:
    for line in ("GO X5", "G0 X5 )", "G123", "#5001 = 3", "gosub nowhere", 'dlgmsg "a" "b" c'):
        assert check(tmp_path, f"G21 G90\n{line}\nM30\n")[0] == 1, line
