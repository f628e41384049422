"""A line of CNC.MAC that could not be read may define any code: jobs with a code that nobody defines are UNKNOWN."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.command import Done, in_this_process

MACHINE = """schema = "gproof-machine/1"
units = "mm"
base = "WINCNC.INI"
[axes.x]
min = 0
max = 100
[axes.y]
min = 0
max = 100
[axes.z]
min = -50
max = 0
"""
INI = (
    "unit=mm\ntimertype=7200\naxischar=XYZ\n"
    + "".join(f"axisspec=p0 s{n} d{n} r100 a36000 f24000 t{n + 1}\n" for n in range(3))
    + "auxout=c1p0b1\n"
)
USED = ("M8", "M8.5", "L777", "G77", "m 08", "G0.7 X1")


def check(folder: Path, macros: str, line: str) -> Done:
    """A job of one line between others, with the shop's CNC.MAC."""
    files = {"mill.toml": MACHINE, "WINCNC.INI": INI, "CNC.MAC": macros, "job.tap": f"G22\nG90\nG0 X5\n{line}\n"}
    for file, content in files.items():
        (folder / file).write_text(content)
    return in_this_process(["check", "job.tap", "--machine", "mill.toml", "--setup", "zero"], folder)


@pytest.mark.parametrize("line", USED)
@pytest.mark.parametrize("unread", ["[N1] {}=M11C1", "(a) {}=M11C1", "M7=5", "[a] what it is"])
def test_a_code_that_an_unread_line_may_define_is_unknown(unread: str, line: str, tmp_path: Path) -> None:
    done = check(tmp_path, f"M9=M12C1\n{unread.format(line.split(maxsplit=1)[0])}\n", line)
    assert done.exit == 2 and "GP112" not in done.out, done.out
    assert "line 2 of CNC.MAC was not understood, and may define it" in done.out


@pytest.mark.parametrize("line", USED)
@pytest.mark.parametrize("macros", ["", "M9=M12C1\n[N1] (nothing)\n", "[nothing\n"])
def test_where_each_line_was_read_the_code_is_an_error(macros: str, line: str, tmp_path: Path) -> None:
    done = check(tmp_path, macros, line)
    assert done.exit == 1 and "GP112" in done.out, done.out


def test_a_line_that_can_be_no_definition_stays_an_error_of_its_own(tmp_path: Path) -> None:
    done = check(tmp_path, "what it is\n", "M8")
    assert done.exit == 1 and "GP101" in done.out and "GP112" not in done.out, done.out


def test_a_code_that_is_read_after_an_unread_line_counts(tmp_path: Path) -> None:
    done = check(tmp_path, "[N1] M8=M11C1\nM9=M12C1\n", "M9")
    assert done.exit == 2 and "GP112" not in done.out and "may define it" not in done.out, done.out
