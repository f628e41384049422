"""Lines that a machine's file runs around a job (WINCNC.INI: cmdstart=, cmdend=, cmdabort=), and ends of DOS files."""

from __future__ import annotations

import hashlib
import json
import re
from pathlib import Path

import pytest
from support.goldens import ROOT

from gproof.cli.main import main
from gproof.driver.dialects import load_machine
from gproof.frontend.wincnc.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine
from gproof.ir.program import Program

INI = "unit=MM\naxischar=XYZ\n" + "axisspec=p0s0d0r100a400t1\naxisvel=r600f150s50m200h450\n" * 3 + "auxout=C1 P7 B0\n"
FIRST = INI.count("\n") + 1


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("job.tap").write_text("G0 X1\n")
    Path("CNC.MAC").write_text("M7=M11C2\n")
    return tmp_path


def loaded(ini: str) -> tuple[Program, Findings, Machine]:
    Path("WINCNC.INI").write_text(INI + ini)
    findings = Findings()
    machine, _ = load_machine(Path("WINCNC.INI"), findings)
    assert machine is not None
    program = load_program(Path("job.tap"), findings, machine, Path("WINCNC.INI"))
    assert program is not None
    program.verify()
    return program, findings, machine


def spans(findings: Findings) -> list[tuple[str, str, int, int, int]]:
    return [(f.code.label, f.span.file, f.span.line, f.span.column, f.span.end_column) for f in findings.kept]


def mistakes_of_settings(
    capsys: pytest.CaptureFixture[str], machine: str = "WINCNC.INI"
) -> list[tuple[str, str, int, int, int]]:
    """Code and place of what a judged job has against lines that a file of the machine makes it run."""
    capsys.readouterr()
    main(["check", "job.tap", "--machine", machine, "--setup", "zero", "--format", "json"])
    found = json.loads(capsys.readouterr().out)["findings"]
    mine = [f for f in found if f["file"] == machine and f["property"] == "language"]
    return [(f["code"], f["file"], f["line"], f["column"], f["end_column"]) for f in mine]


@pytest.mark.parametrize("key", ["cmdstart", "cmdend", "cmdabort"])
@pytest.mark.parametrize(
    ("value", "column", "end", "code"),
    [
        ("=G0 X?", 5, 6, "GP101"),
        ("  = [on] G0 X? [off]", 13, 14, "GP101"),
        ("=M7 ?", 1, 5, "GP101"),
        ("= G7 Q X{1+}", 8, 12, "GP107"),
    ],
)
def test_a_mistake_has_its_place(
    shop: Path, capsys: pytest.CaptureFixture[str], key: str, value: str, column: int, end: int, code: str
) -> None:
    """``column`` and ``end`` count from the end of the key, which is 0. Only a job that comes to the line has it."""
    _, findings, _ = loaded(f"\n {key}{value}\n")
    assert findings.kept == []
    at = len(key) + 1
    place = (code, "WINCNC.INI", FIRST + 1, at + column + 1, at + end + 1)
    to_its_end = [] if key == "cmdabort" else [place]
    for job, expected in (("G0 X1\n", to_its_end), ("M99.1\n", [place] if key != "cmdend" else [])):
        Path("job.tap").write_text(job)
        assert mistakes_of_settings(capsys) == expected


@pytest.mark.parametrize("key", ["start", "end", "abort"])
def test_a_mistake_in_a_file_over_the_machine_s_own_has_no_column(
    shop: Path, capsys: pytest.CaptureFixture[str], key: str
) -> None:
    """TOML does not tell where a value stands: columns of the value are none of the file."""
    loaded(f"cmd{key}=M11 C1\n")
    text = f'schema = "gproof-machine/1"\nunits = "mm"\nbase = "WINCNC.INI"\n[controls]\n{key} = "G0 X?"\n'
    Path("shop.toml").write_text(text)
    Path("job.tap").write_text("M99.1\n" if key == "abort" else "G0 X1\n")
    assert mistakes_of_settings(capsys, "shop.toml") == [("GP101", "shop.toml", 1, 0, 0)]


@pytest.mark.parametrize(
    ("ini", "line", "column"), [("cmdstart=M11C9\n", FIRST, 13), ("\n\ncmdend=M11 C9\n", FIRST + 2, 12)]
)
def test_a_finding_of_the_execution_has_its_place(
    shop: Path, capsys: pytest.CaptureFixture[str], ini: str, line: int, column: int
) -> None:
    loaded(ini)
    main(["check", "job.tap", "--machine", "WINCNC.INI", "--setup", "zero", "--format", "json"])
    report = json.loads(capsys.readouterr().out)
    (found,) = [f for f in report["findings"] if f["code"] == "GP128"]
    assert (found["file"], found["line"], found["column"]) == ("WINCNC.INI", line, column)


def test_rows_of_the_trace_name_the_file(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    loaded("cmdstart=G0 X5\ncmdend=M98 END.TAP\n")
    Path("END.TAP").write_text("\nG0 X9\n")
    capsys.readouterr()
    words = ["--machine", "WINCNC.INI", "--setup", "zero", "--stage", "trace", "--format", "jsonl"]
    assert main(["dump", "job.tap", *words]) == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    moves = [(row.get("file", "job.tap"), row["line"], row["to"]["x"]) for row in rows if row["op"] == "traverse"]
    assert moves == [("WINCNC.INI", FIRST, 5.0), ("job.tap", 1, 1.0), ("END.TAP", 2, 9.0)]


@pytest.mark.parametrize(
    ("ini", "job", "told"),
    [
        ("cmdend=M12C1\n", "M99\n", []),
        ("cmdend=M12C1\n", "M99.1\nG0 X2\n", [("job.tap", 2)]),
        ("cmdend=M99\n", "G0 X1\n" * 40, []),
        ("cmdend=M99.1\n", "M11 C1\nG0 X1\n" * 40, []),
        ("cmdend=M12C1\n", "M99.1\n", []),
        ("cmdend=M99\n", "G0 X1\nM17.1 C1\nG0 X2\n" * 40, []),
        ("cmdstart=M11C1\n", "[a]\n" * 30 + "M99.1\nM11 C1\n", [("job.tap", 32)]),
    ],
)
def test_what_stands_behind_the_end_of_the_job(
    shop: Path, capsys: pytest.CaptureFixture[str], ini: str, job: str, told: list[tuple[str, int]]
) -> None:
    """A line of the settings is none of the job's, whatever its number."""
    loaded(ini)
    Path("job.tap").write_text(job)
    main(["check", "job.tap", "--machine", "WINCNC.INI", "--setup", "zero", "--format", "json"])
    found = [f for f in json.loads(capsys.readouterr().out)["findings"] if f["code"] == "GP123"]
    assert [(f["file"], f["line"]) for f in found] == told


def test_a_file_over_the_machine_s_own_has_its_first_line(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    loaded("cmdstart=M11C9\ncmdend=M11C9\n")
    text = 'schema = "gproof-machine/1"\nunits = "mm"\nbase = "WINCNC.INI"\n[controls]\nstart = "M11 C8"\n'
    Path("shop.toml").write_text(text)
    main(["check", "job.tap", "--machine", "shop.toml", "--setup", "zero", "--format", "json"])
    found = [f for f in json.loads(capsys.readouterr().out)["findings"] if f["code"] == "GP128"]
    assert [(f["file"], f["line"]) for f in found] == [("WINCNC.INI", FIRST + 1), ("shop.toml", 1)]


def test_every_file_is_an_input_once(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    loaded("cmdstart=G0 X5\n")
    main(["check", "job.tap", "--machine", "WINCNC.INI", "--setup", "zero", "--format", "json"])
    inputs = json.loads(capsys.readouterr().out)["inputs"]
    expected = [("WINCNC.INI", "machine"), ("job.tap", "source"), ("CNC.MAC", "source")]
    assert [(one["file"], one["role"]) for one in inputs] == expected
    for one in inputs:
        assert one["sha256"] == hashlib.sha256(Path(one["file"]).read_bytes()).hexdigest()


# -- Ctrl-Z


@pytest.mark.parametrize("lines", [3, 150_000], ids=["read", "mapped"])
@pytest.mark.parametrize("end", ["\r\n\x1a", "\x1a"])
def test_one_ctrl_z_at_the_end_of_a_job_is_no_mistake(shop: Path, end: str, lines: int) -> None:
    data = ("\r\n".join(["G0 X1 Y2"] * lines) + end).encode()
    Path("job.tap").write_bytes(data)
    program, findings, _ = loaded("")
    assert findings.kept == []
    assert program.line_count == lines
    assert program.files[0].sha256 == hashlib.sha256(data).hexdigest()
    assert bytes(program.files[0].data) == data[:-1]


@pytest.mark.parametrize("text", ["G0 X1\r\n\x1a\x1a", "\x1aG0 X1", "G0 X1\r\n\x1a\r\n", "G0\x1a X1\r\n"])
def test_any_other_ctrl_z_is_one(shop: Path, text: str) -> None:
    Path("job.tap").write_bytes(text.encode())
    _, findings, _ = loaded("")
    assert {label for label, *_ in spans(findings)} == {"GP101"}


def test_ctrl_z_in_the_other_files(shop: Path) -> None:
    Path("job.tap").write_bytes(b"M98 SUB.TAP\r\nM7\r\n\x1a")
    Path("SUB.TAP").write_bytes(b"G0 X2\x1a")
    Path("CNC.MAC").write_bytes(b"M7=M11C1\r\n\x1a")
    _, findings, _ = loaded("cmdend=M12C1\n\x1a")
    assert findings.kept == []
    Path("CNC.MAC").write_bytes(b"M7=M11C1\x1a\r\n")
    _, findings, _ = loaded("")
    assert [label for label, *_ in spans(findings)][:1] == ["GP101"]


# -- the ini of another controller


def test_the_file_of_eding_is_told(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for text, told in ((next((ROOT / "corpus/eding").rglob("cnc.ini")).read_text(), True), ("unit=MM\n", False)):
        Path("WINCNC.INI").write_text(text)
        assert main(["check", "job.tap", "--machine", "WINCNC.INI"]) == 3
        err = capsys.readouterr().err
        assert "GP604 [missing-key] axischar= is missing" in err
        assert bool(re.search(r"hint: .*Eding CNC", err)) == told
