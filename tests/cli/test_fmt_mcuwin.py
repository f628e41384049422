"""``gproof fmt`` of McuWIN files from the command line: jobs, includes, settings of the machine, standard input."""

from __future__ import annotations

import io
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from gproof.cli.main import main

UGLY = "%MAIN\ng90\ng1x.50y2f100  ' cut\n$IF(CI600<1)Then begin\nm8\n$End;\nm98 l0007 o2\nm30\n$I subs.inc\n"
NICE = """%MAIN
G90
G01 X0.5 Y2 F100 ' cut
$if (CI600 < 1) then begin
  M08
$end;
M98 L0007 O2
M30
$I subs.inc
"""

MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
kind = "linear"
[axes.c]
kind = "linear"
[controller]
dialect = "mcuwin"
[din]
case_sensitive = {case}
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "job.din").write_text(UGLY)
    (tmp_path / "subs.inc").write_text("%7 (bore)\ng0z-5\nm17\n%\n")
    (tmp_path / "more.src").write_text("g0x1\r\n\x1a")
    return tmp_path


@pytest.fixture
def gproof(folder: Path, capsys: pytest.CaptureFixture[str]) -> object:
    def run(*words: str) -> tuple[int, str, str]:
        before = sorted(folder.rglob("*"))
        capsys.readouterr()
        code = main(["fmt", *words])
        captured = capsys.readouterr()
        assert "Traceback" not in captured.out + captured.err
        assert "internal error" not in captured.err
        assert sorted(folder.rglob("*")) == before, "files were left behind"
        return code, captured.out, captured.err

    return run


def test_a_folder_of_jobs_and_includes(folder: Path, gproof) -> None:
    assert gproof("--check", ".")[0] == 1
    assert gproof(".") == (0, "job.din: formatted\nmore.src: formatted\nsubs.inc: formatted\n", "")
    assert (folder / "job.din").read_text() == NICE
    assert (folder / "subs.inc").read_text() == "%7 (bore)\nG00 Z-5\nM17\n%\n"
    assert (folder / "more.src").read_bytes() == b"G00 X1\r\n"
    assert gproof("--check", ".") == (0, "job.din: unchanged\nmore.src: unchanged\nsubs.inc: unchanged\n", "")


def test_a_patch_and_standard_input(folder: Path, gproof, monkeypatch: pytest.MonkeyPatch) -> None:
    code, out, _ = gproof("--diff", "job.din")
    assert code == 0
    assert "-g90\n-g1x.50y2f100  ' cut\n" in out
    assert "+  M08\n" in out
    for words in (["-", "--stdin-name", "job.din"], ["-", "--dialect", "mcuwin"]):
        monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(UGLY.encode())))
        assert gproof(*words) == (0, NICE, "")
    # Nothing but the name says whose it is, and where its names are declared.
    (folder / "names.inc").write_text("var depth: double;\n")
    text = b"$I names.inc\n%\ng1x(depth)\n"
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(text)))
    assert gproof("-", "--stdin-name", "other.src")[:2] == (0, "$I names.inc\n%\nG01 X(depth)\n")
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(b"g1x.50")))
    assert gproof("-", "--stdin-name", "other.inc")[:2] == (0, "G01 X0.5\n")


def test_settings_of_the_machine(folder: Path, gproof) -> None:
    for case in ("true", "false"):
        (folder / f"{case}.toml").write_text(MACHINE.format(case=case))
    (folder / "job.din").write_text("var Depth: double;\n%\nG1C(Depth)\ndepth:=1\nM30\n")
    assert gproof("--machine", "true.toml", "job.din")[0] == 1
    assert gproof("--machine", "false.toml", "job.din")[0] == 0
    assert (folder / "job.din").read_text() == "var Depth: double;\n%\nG01 C(Depth)\nDepth := 1\nM30\n"
    (folder / "job.din").write_text("var Depth: double;\n%\ndepth:=1\nM30\n")
    assert gproof("job.din")[0] == 0  # nobody said whether case matters
    assert (folder / "job.din").read_text() == "var Depth: double;\n%\ndepth := 1\nM30\n"


def test_files_that_the_machine_puts_before_each_job(folder: Path, gproof) -> None:
    (folder / "mill.toml").write_text(MACHINE.format(case="true") + 'pre_include = "Names.inc"\n')
    (folder / "Names.inc").write_text("var depth : double;\n")
    (folder / "job.din").write_text("%\nG1X(depth)\nM30\n")
    code, out, err = gproof("--machine", "mill.toml", "job.din", "Names.inc")
    assert (code, out) == (0, "job.din: formatted\nNames.inc: formatted\n"), err
    assert (folder / "Names.inc").read_text() == "var depth: double;\n"


@pytest.mark.parametrize(
    "text", ["G0 X\n$end\n", "G1 X(depth)\n", "G7 X1\n", "M3 (on)\n", "$if CI600 < 1 then begin\n"]
)
def test_a_file_with_mistakes_is_left_alone(folder: Path, gproof, text: str) -> None:
    (folder / "job.din").write_text(text)
    code, out, err = gproof("job.din", "subs.inc")
    assert (code, out) == (1, "subs.inc: formatted\n")
    assert err.endswith("job.din: not formatted\n")
    assert (folder / "job.din").read_text() == text


def test_a_text_that_differs_is_never_written(folder: Path, gproof, monkeypatch: pytest.MonkeyPatch) -> None:
    for one, two in (
        ("X0.5", "X0.51"),
        ("< 1", "> 1"),
        ("' cut", "' cat"),
        ("M98", "M96"),
        ("O2", "O3"),
        ("I subs", "I sub"),
    ):
        text = NICE.replace(one, two).encode()
        monkeypatch.setattr("gproof.backend.emit.mcuwin.program.emit", lambda program, din, as_is, text=text: [text])
        code, out, err = gproof("job.din")
        assert (code, out) == (1, "")
        assert "GP701" in err
        assert (folder / "job.din").read_text() == UGLY


JOB = "var depth, Step: double;\n%MAIN\ng1 z(depth) f100\nm98 l7\nm30\n$I {}\n"
LIBRARY = "%7 (bore)\ng1  z(-depth*2)  ' down\ndepth:=depth+step\n$if (depth<5) then begin\nx1\n$end\nm17\n"
NICE_LIBRARY = """%7 (bore)
G01 Z(-depth * 2) ' down
depth := depth + step
$if (depth < 5) then begin
  X1
$end
M17
"""


def test_an_include_file_is_read_within_the_jobs_that_include_it(folder: Path, gproof) -> None:
    (folder / "part.din").write_text(JOB.format("lib.inc"))
    (folder / "lib.inc").write_text(LIBRARY)
    assert gproof("lib.inc") == (0, "lib.inc: formatted\n", "")
    assert (folder / "lib.inc").read_text() == NICE_LIBRARY
    assert gproof("--check", "lib.inc") == (0, "lib.inc: unchanged\n", "")


def test_within_a_job_by_way_of_another_include_and_of_a_folder(folder: Path, gproof) -> None:
    """The job lies one folder up, and includes the file through another one; a second job does not declare names."""
    (folder / "lib").mkdir()
    (folder / "part.din").write_text(JOB.format("lib\\\\all.inc"))
    (folder / "other.din").write_text("%A\nM30\n$I lib\\lib.inc\n")
    (folder / "lib" / "all.inc").write_text("$i LIB.INC\n")
    (folder / "lib" / "lib.inc").write_text(LIBRARY)
    assert gproof("lib") == (0, "lib/all.inc: formatted\nlib/lib.inc: formatted\n", "")
    assert (folder / "lib" / "lib.inc").read_text() == NICE_LIBRARY


def test_names_that_are_declared_behind_the_include_do_not_count(folder: Path, gproof) -> None:
    (folder / "part.din").write_text("$I lib.inc\nvar depth, step: double;\n%MAIN\nM30\n")
    (folder / "lib.inc").write_text("%7\ng1 z(depth)\nm17\n")
    code, out, err = gproof("lib.inc")
    assert (code, out) == (1, "")
    assert "'depth' is not declared" in err


def test_an_include_file_of_no_job_keeps_lines_that_use_what_it_does_not_declare(folder: Path, gproof) -> None:
    (folder / "lib.inc").write_text(LIBRARY)
    said = (
        "lib.inc: lines 2, 3, 4 stay as they are, with names that only a job which includes the file can declare; "
        "no file here does\n"
    )
    assert gproof("--check", "lib.inc") == (1, "lib.inc: would be formatted\n", said)
    assert gproof("lib.inc") == (0, "lib.inc: formatted\n", said)
    kept = LIBRARY.splitlines()
    assert (folder / "lib.inc").read_text().splitlines() == ["%7 (bore)", *kept[1:4], "  X1", "$end", "M17"]
    assert gproof("--check", "lib.inc") == (0, "lib.inc: unchanged\n", said)
    # Other mistakes are mistakes, and a job declares its names itself.
    (folder / "lib.inc").write_text(LIBRARY + "G7 X1\n")
    assert gproof("lib.inc")[:2] == (1, "")
    (folder / "lib.src").write_text(LIBRARY)
    assert gproof("lib.src")[:2] == (1, "")
    assert (folder / "lib.src").read_text() == LIBRARY


def test_jobs_that_read_an_include_file_in_two_ways(folder: Path, gproof) -> None:
    """In one of them it has a mistake: the other says what it means."""
    (folder / "one.din").write_text("var depth: double;\n%A\nM30\n$I lib.inc\n")
    (folder / "two.din").write_text("var depth: integer;\n%A\nM30\n$I lib.inc\n")
    (folder / "lib.inc").write_text("%7\ng1 z(depth and 1)\nm17\n")
    assert gproof("lib.inc") == (0, "lib.inc: formatted\n", "")
    assert (folder / "lib.inc").read_text() == "%7\nG01 Z(depth and 1)\nM17\n"
