"""A line of WinCNC does the same as a row of a table and, with a number in braces, as an expression."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

SHOP = Path(__file__).resolve().parents[4] / "corpus" / "wincnc" / "knife-twohead"
PROGRAMS = {
    "L11": "G0 X5 Y6\nL11 YXZW\nG0 X10 Y20\nG1 X30 F100\nG1 Y7\nX12 Y13",
    "L12 both": "L12 ZZ\nG0 X1\nG0 Z10\nG1 Z5 F100\nZ4\nX7 Z3",
    "L12 other": "L12 WZ\nG0 X1\nG0 Z10\nG1 Z5 F100\nZ4\nX7 Z3",
    "L13": "G0 X1\nL13 ZW\nG0 Z40\nG1 Z35 F100\nZ34\nX7 Z33",
    "L300": "G0 X1\nL300 Y\nG0 X10 Y20\nG1 X30 Y5 F100\nX12 Y13\nL301\nX13 Y14",
    "arcs are not modal": "G0 X10 Y10\nG1 X20 F100\nG2 X30 Y20 I0 J10\nX40 Y20\nX50\nG3 X60 Y30 I0 J10\nX70",
    "I and J stay": "G0 X10 Y10\nG1 X20 F100\nG2 X30 Y20 I0 J10\nG1 X20 Y10\nG2 X30 Y20\nG3\nG2 I5 J0\nG2",
    "negative R": "G0 X0 Y0\nG1 X1 F10\nG2 X11 Y0 R10\nG3 X21 Y0 R-10\nX5",
    "helix": "G0 X50 Y50\nG1 X51 F10\nG2 I5 J0 Z-.1\nG3 X61 Y50 I5 J0 W.5\nX5",
    "small arc": "G0 X5 Y5\nG1 X6 F100\nG2 X6.01 Y5.01 I0 J.01\nX7\nG2 X7.005 Y5.005 I.005 J0\nX8",
    "feeds of groups": "G0 X1\nG1 Z1 F50\nG1 X10 F200\nG1 Z2\nX20\nZ3\nX30 Y4",
    "once": "G0 X10\nG1 X20 F100\nL91 X5\nX6\nL91 G1 Y3\nG91\nX2\nL90 X50\nX2\nG90 X3",
    "letters alone": "G0 X10 Y10\nG1 X Y F100\nX5 Y",
    "units": "G0 X10\nG20\nG0 X1\nG1 X2 F10\nG21\nX3\nG23\nX3\nG22\nX4",
    "local zero": "G0 X5 Y5\nG92 X0\nG0 X5\nG92.2 X1 Y1\nX5 Y5\nG92.3\nX5 Y5\nG92.3\nX6\nG92\nX6",
    "G52": "G0 X5 Y5\nG52 I0 J0 A90\nG0 X30 Y0\nG1 X40 F100\nX50 Y-10\nG2 X60 Y-20 I0 J-10\nG50\nX5 Y5",
    "G51": "G0 X5 Y5\nG51 X2 Y2 I0 J0\nG0 X10 Y0\nG1 X20 F100\nX30 Y10\nG50\nX5 Y5",
    "G53": "G92 X100 Y50\nG0 X110\nG53 X5\nX106\nG1 X107 F10\nG53 Y4\nX108",
}
_NUMBER = re.compile(r"\b([XYZWIJ])(-?[\d.]+)")


def braced(program: str) -> str:
    """The same with the first number of a place in each line in braces, so that the line is no row of a table."""
    return "\n".join(_NUMBER.sub(r"\1{\2+0}", line, count=1) for line in program.split("\n"))


def dumped(folder: Path, program: str, capsys: pytest.CaptureFixture[str]) -> tuple[list[list[str]], list[str]]:
    """Rows of the trace that move, and the findings' lines and codes."""
    from gproof.cli.main import main

    job = folder / "job.tap"
    job.write_text(f"G90\nG43\n{program}\n", encoding="ascii")
    files = ["--machine", str(SHOP / "machine.toml"), "--setup", str(SHOP / "setup.toml")]
    main(["dump", "--stage", "trace", str(job), *files, "--dialect", "wincnc"])
    shown = capsys.readouterr()
    rows = [line.split() for line in shown.out.splitlines()]
    moves = [row for row in rows if len(row) == 21 and row[0] in ("1", "2", "3")]
    return moves, re.findall(r"job\.tap:(\d+):\d+: (\w+ GP\d+)", shown.err)


@pytest.mark.parametrize("name", PROGRAMS)
def test_lines_and_rows_agree(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plain = dumped(tmp_path, PROGRAMS[name], capsys)
    assert plain[0]
    assert plain == dumped(tmp_path, braced(PROGRAMS[name]), capsys)
