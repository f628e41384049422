"""WinCNC: lines with numbers of their own, in jobs, called files and CNC.MAC; the manual has no such N."""

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
[controller]
"""
INI = (
    "unit=mm\ntimertype=7200\naxischar=XYZ\n"
    + "".join(f"axisspec=p0 s{n} d{n} r100 a36000 f24000 t{n + 1}\n" for n in range(3))
    + "auxout=c1p0b1\nauxout=c2p0b2\nauxin=c1p0b3\n"
)
ACCEPTS = 'accepts = ["line-numbers"]\n'
MACROS = "M8=M11C1\nM9=N5 M12C1\nPARK=M98 PARK.TAP\nGO=G0\n"
PARK = "N10 G0 Z0\nN20\nN30 X5\n"


def check(folder: Path, text: str, accepts: str = "", *, macros: str = MACROS, name: str = "check") -> Done:
    """One command on a job that may call PARK.TAP."""
    files = {"mill.toml": MACHINE + accepts, "WINCNC.INI": INI, "CNC.MAC": macros, "PARK.TAP": PARK, "job.tap": text}
    for file, content in files.items():
        (folder / file).write_text(content)
    more = ["--setup", "zero"] if name == "check" else []
    return in_this_process([name, "job.tap", "--machine", "mill.toml", *more], folder)


# Each line of each job means what the same line means without its number.
JOBS = {
    "words": "N1 G22\nN2 G90\nN3 G0 X{x} Y6\nN4 Y7\n",
    "macro": "G22 [mm]\nG90\nN3 M8\nN4 GO X{x}\nN5 M9\n",
    "within a macro": "G22\nG90\nG0 X{x}\nM9\n",
    "call": "G22\nG90\nG0 X{x}\nN4 M98 PARK.TAP\n",
    "called file": "G22\nG90\nG0 X{x}\nPARK\n",
    "own command": "G22\nG90\nN3 G0 X{x}\nN4 ~M11 C1\n",
    "message": 'G22\nG90\nN7 G5 T0 M"N8"\nG0 X{x}\n',
    "condition": "G22\nG90\nN3 M17.1 C1\nN4 G0 X{x}\n",
    "comment": "G22\nG90\nN3 [nothing]\nN4 G0 X{x} [there]\n",
}


@pytest.mark.parametrize("text", JOBS.values(), ids=JOBS)
def test_numbers_of_lines_are_unknown_once_and_nothing_where_the_shop_says_so(text: str, tmp_path: Path) -> None:
    without = check(tmp_path, text.format(x=5))
    assert without.exit == 2, without.out
    assert without.out.count("an N at the start of a line") == 1, without.out
    assert 'accepts = ["line-numbers"]' in without.out
    safe = check(tmp_path, text.format(x=5), ACCEPTS)
    assert safe.exit == 0 and "(accepts line-numbers)" in safe.out, safe.out
    unsafe = check(tmp_path, text.format(x=500), ACCEPTS)
    assert unsafe.exit == 1 and "GP301" in unsafe.out, unsafe.out


def test_an_n_that_the_command_has_is_its_own(tmp_path: Path) -> None:
    # L1: N is the register.
    done = check(tmp_path, "G22\nG90\nN3 L1 V5\nG0 X5\n")
    assert "an N at the start of a line" not in done.out


def test_a_macro_named_like_a_number_is_the_macro(tmp_path: Path) -> None:
    done = check(tmp_path, "G22\nG90\nN10 X5\n", macros="N10=G0\n")
    assert done.exit == 0 and "line-numbers" not in done.out, done.out


@pytest.mark.parametrize("accepts", ["", ACCEPTS], ids=["without", "with"])
def test_fmt_leaves_numbered_lines_as_they_are(accepts: str, tmp_path: Path) -> None:
    text = "g22\nN10  g0x5 y6 (a)\nn20\nN30 m8\n N40 PARK\nN50 m98 PARK.TAP  [b]\nN60 m17.1c1\nN70 g0 x6\nN80 ~m11c1\n"
    done = check(tmp_path, text, accepts, name="fmt")
    assert done.exit == 0, done.out + done.err
    assert (tmp_path / "job.tap").read_text() == "G22" + text[3:]
