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


NAMES = (
    "PARK",
    "park X5",
    "TOOL3",
    "HOME_Z",
    "ZUP",
    "Q5",
    "O100",
    "PARK (up)",
    "PARK.MAC",
    "M3 @",
    "M6 T&2",
    "WASH3 Q",
)
"""Lines that CNC.MAC may define, or that name a file, and that are an error where it does not."""
LOST = "the position of every axis depends on line 4"


def bare(folder: Path, line: str, *words: str, macros: str | None = None) -> Done:
    """The same without a CNC.MAC; words: further arguments, the machine among them."""
    (folder / "mill.toml").write_text(MACHINE)
    (folder / "WINCNC.INI").write_text(INI)
    (folder / "job.tap").write_text(f"G22\nG90\nG0 X5\n{line}\nG0 X50 Y5 Z0\n")
    if macros is not None:
        (folder / "CNC.MAC").write_text(macros)
    return in_this_process(["check", "job.tap", "--setup", "zero", *words], folder)


@pytest.mark.parametrize("line", NAMES)
def test_without_a_macro_file_a_name_is_unknown_and_loses_all(line: str, tmp_path: Path) -> None:
    done = bare(tmp_path, line, "--machine", "mill.toml")
    assert done.exit == 2 and " error GP" not in done.out, done.out
    assert "which only a macro file can define" in done.out and LOST in done.out, done.out
    assert "put CNC.MAC and the files that it names next to mill.toml" in done.out


@pytest.mark.parametrize("line", NAMES)
def test_without_a_machine_file_the_hint_says_which_to_give(line: str, tmp_path: Path) -> None:
    done = bare(tmp_path, line)
    assert done.exit == 2 and " error GP" not in done.out, done.out
    assert "which only a macro file can define" in done.out
    assert "--machine WINCNC.INI, with CNC.MAC and its files next to it" in done.out


@pytest.mark.parametrize("line", NAMES)
def test_a_line_that_may_define_a_name_was_not_read(line: str, tmp_path: Path) -> None:
    done = bare(tmp_path, line, "--machine", "mill.toml", macros="M9=M12C1\nM7=5\n")
    assert done.exit == 2 and " error GP" not in done.out, done.out
    assert "line 2 of CNC.MAC was not understood, and may define it" in done.out and LOST in done.out


@pytest.mark.parametrize("line", NAMES)
def test_with_a_macro_file_that_was_read_a_name_that_it_lacks_is_an_error(line: str, tmp_path: Path) -> None:
    done = bare(tmp_path, line, "--machine", "mill.toml", macros="M9=M12C1\n")
    assert done.exit == 1 and " error GP" in done.out and "only a macro file" not in done.out, done.out


@pytest.mark.parametrize("line", ["12", "?PARK", "#1=5", "G0 X5 Q3", "G4 Q", "X5 Q3", "G0 X5 X6"])
def test_a_line_that_no_macro_file_could_mean_stays_an_error(line: str, tmp_path: Path) -> None:
    for more in ((), ("--machine", "mill.toml")):
        done = bare(tmp_path, line, *more)
        assert done.exit == 1 and " error GP" in done.out, done.out


@pytest.mark.parametrize("line", ["XY", "X Y", "ZX5", "F100XY5"])
def test_words_that_the_controller_has_keep_their_meaning(line: str, tmp_path: Path) -> None:
    done = bare(tmp_path, line, "--machine", "mill.toml")
    assert "only a macro file" not in done.out and " error GP" not in done.out, done.out
    assert "GP607" in done.out and done.exit == 2


@pytest.mark.parametrize("call", ["M98 PARK.MAC", "M98.1 park", 'm98 "my park.tap"', "M98 C:\\WINCNC\\PARK.MAC"])
def test_a_file_is_missing_only_where_its_folder_was_given(call: str, tmp_path: Path) -> None:
    done = bare(tmp_path, call, "--machine", "mill.toml")
    assert done.exit == 2 and "GP130" not in done.out and "which is not next to the job" in done.out, done.out
    assert LOST in done.out and "put CNC.MAC and the files that it names next to mill.toml" in done.out
    given = bare(tmp_path, call, "--machine", "mill.toml", macros="")
    assert given.exit == 1 and "GP130" in given.out, given.out


def test_a_condition_on_a_name_is_unknown_too(tmp_path: Path) -> None:
    done = bare(tmp_path, "M17.4 C1\nPARK", "--machine", "mill.toml")
    assert done.exit == 2 and " error GP" not in done.out, done.out


def test_a_setting_that_runs_a_name_is_unknown(tmp_path: Path) -> None:
    (tmp_path / "mill.toml").write_text(MACHINE)
    (tmp_path / "WINCNC.INI").write_text(INI + "cmdend=PARK\n")
    (tmp_path / "job.tap").write_text("G22\nG90\nG0 X5\n")
    words = ["check", "job.tap", "--machine", "mill.toml", "--setup", "zero"]
    done = in_this_process(words, tmp_path)
    assert done.exit == 2 and " error GP" not in done.out and "PARK, which only a macro file" in done.out, done.out
    (tmp_path / "CNC.MAC").write_text("PARK=G0 X3\n")
    assert in_this_process(words, tmp_path).exit == 0


@pytest.mark.parametrize(
    "definition", ["N10 M7=M11C1", "n 20 PARK=G0 X3", "TOOL-3=M11C1", "MY PARK=G0 X4", "3AX=G0 X3"]
)
def test_a_definition_whose_name_the_manual_does_not_describe_is_unknown(definition: str, tmp_path: Path) -> None:
    done = bare(tmp_path, "PARK", "--machine", "mill.toml", macros=f"M9=M12C1\n{definition}\n")
    assert done.exit == 2 and " error GP" not in done.out, done.out
    assert "CNC.MAC:2:1: unknown GP113" in done.out and "which only a macro file can define" in done.out


@pytest.mark.parametrize(("line", "exit_code"), [("M7", 0), ("PARK", 0), ("FAR", 1), ("M8", 1)])
def test_where_lines_have_numbers_definitions_may_have_them(line: str, exit_code: int, tmp_path: Path) -> None:
    macros = "N10 M7=M11C1\nn 20 PARK=G0 X3\nN30 far=G0 X300\n"
    done = bare(tmp_path, line, "--machine", "mill.toml", macros=macros)
    assert done.exit == 2 and done.out.count('accepts = ["line-numbers"]') >= 1, done.out
    (tmp_path / "mill.toml").write_text(MACHINE + '[controller]\naccepts = ["line-numbers"]\n')
    given = in_this_process(["check", "job.tap", "--setup", "zero", "--machine", "mill.toml"], tmp_path)
    assert given.exit == exit_code, given.out
    assert "(accepts line-numbers)" in given.out or line == "M8", given.out


@pytest.mark.parametrize("line", ["Y3", "L91 Y3", "G91 Y3", "X Y"])
def test_axis_words_before_the_first_motion_code_are_unknown(line: str, tmp_path: Path) -> None:
    """G0 and G1: modes stay; what is in force when a file begins is not said."""
    (tmp_path / "mill.toml").write_text(MACHINE)
    (tmp_path / "WINCNC.INI").write_text(INI)
    (tmp_path / "CNC.MAC").write_text("")
    (tmp_path / "job.tap").write_text(f"G22\nG90\n{line}\nG90\nG0 X5\n")
    words = ["check", "job.tap", "--machine", "mill.toml", "--setup", "zero"]
    done = in_this_process(words, tmp_path)
    assert done.exit == 2 and "unknown GP202" in done.out and "kept-motion" in done.out, done.out
    (tmp_path / "mill.toml").write_text(MACHINE + '[controller]\naccepts = ["kept-motion"]\n')
    assert in_this_process(words, tmp_path).exit == 0
