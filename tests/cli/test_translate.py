"""`gproof translate`: exit codes, what is written and what is not, wrong input."""

from __future__ import annotations

import json
import os
import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from support.command import Done, in_own_process, in_this_process
from support.each import each
from support.goldens import ROOT
from support.json_schema import violations
from support.target_machines import machine_like

from gproof.driver.targets import TARGETS
from gproof.ir.job import Job
from gproof.ir.machine import Machine
from gproof.ir.target import Style, Target

SCHEMA_JSON = json.loads((ROOT / "docs" / "translation.schema.json").read_text(encoding="utf-8"))
MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = -500
max = 500
[axes.y]
min = -500
max = 500
[axes.z]
min = -200
max = 200
"""
JOB = """(plate)
G21 G17 G90 G94 G40 G54
S6000 M3
G0 X10 Y20 Z5
G1 Z-2 F100
G3 X20 Y30 I0 J10 F600
G0 Z5
M5
M30
"""
WITH_OUTPUT = JOB.replace("S6000 M3\n", "S6000 M3\nM54 P3\n")
WITH_MIST = JOB.replace("G0 Z5\n", "M7\nG0 Z5\n")
SCHEMA = 'schema = "gproof-translation/1"\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A job, its machine, and one that needs a map."""
    texts = {"job.cnc": JOB, "output.cnc": WITH_OUTPUT, "mist.cnc": WITH_MIST, "machine.toml": MACHINE}
    for name, text in texts.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


@cache
def machine_to(to: str) -> str:
    """A machine of another controller that is like that of the jobs."""
    place = Path(tempfile.mkdtemp())
    (place / "machine.toml").write_text(MACHINE, encoding="utf-8")
    return str(machine_like(place / "machine.toml", to, place / to))


def translate(folder: Path, *words: str, job: str = "job.cnc", to: str = "linuxcnc", out: str = "out.ngc") -> Done:
    output = ["-o", out] if out else []
    machines = [] if "--machine" in words else ["--machine", "machine.toml"]
    machines += [] if "--machine-to" in words else ["--machine-to", machine_to(to)]
    return in_this_process(["translate", job, "--to", to, *machines, *output, *words], folder)


def given(folder: Path, text: str) -> str:
    """A map."""
    (folder / "map.toml").write_text(SCHEMA + text, encoding="utf-8")
    return "map.toml"


def untouched(folder: Path) -> bool:
    """Nothing was written, and no input changed."""
    names = {path.name for path in folder.iterdir()}
    return names - {"map.toml"} == {"job.cnc", "output.cnc", "mist.cnc", "machine.toml"} and all(
        (folder / name).read_text(encoding="utf-8") == text
        for name, text in (("job.cnc", JOB), ("output.cnc", WITH_OUTPUT), ("machine.toml", MACHINE))
    )


# ---- 0


@each("to", TARGETS)
def test_a_proven_translation_is_written(to: str, tmp_path: Path) -> None:
    folder = tmp_path / to
    folder.mkdir()
    for name, text in (("job.cnc", JOB), ("machine.toml", MACHINE)):
        (folder / name).write_text(text, encoding="utf-8")
    done = translate(folder, to=to)
    assert (done.exit, done.err) == (0, "")
    assert done.out.startswith(f"out.ngc: proven: the same as job.cnc on {TARGETS[to].target().title}, wherever")
    text = (folder / "out.ngc").read_text(encoding="utf-8")
    assert "plate" in text and "NOT PROVEN" not in text


def test_the_text_for_linuxcnc_is_what_a_person_would_write(folder: Path) -> None:
    assert translate(folder).exit == 0
    lines = (folder / "out.ngc").read_text(encoding="utf-8").splitlines()
    assert lines[0] == "(plate)"
    assert [line for line in lines if line.startswith(("G0 X", "G1 Z", "G3", "S6000", "M5", "M30"))] == [
        "S6000 M3", "G0 X10 Y20 Z5", "G1 Z-2 F100", "G3 X20 Y30 I0 J10 F600", "M5", "M30",
    ]  # fmt: skip


def test_a_map_gives_the_outputs_of_the_other_machine(folder: Path) -> None:
    assert translate(folder, job="output.cnc").exit == 2
    done = translate(folder, "--map", given(folder, "[outputs]\n3 = 2\n"), job="output.cnc")
    assert (done.exit, done.err) == (0, "")
    words = (folder / "out.ngc").read_text(encoding="utf-8").split()
    assert "P2" in words and "P3" not in words


def test_a_map_gives_the_lengths_that_no_file_says(folder: Path) -> None:
    """grbl has no tool table: G43.1 has the length as a number (Supported G-Codes)."""
    (folder / "job.cnc").write_text(JOB.replace("G0 X10", "G43 H2\nG0 X10"), encoding="utf-8")
    done = translate(folder, to="grbl")
    assert done.exit == 2 and "the length of a tool that the machine file does not have" in done.err
    done = translate(folder, "--map", given(folder, "[lengths]\n2 = 31.5\n"), to="grbl")
    assert done.exit == 0 and "assumed: the length of tool 2 of the source program is 31.5 mm" in done.out
    assert "G43.1 Z31.5\n" in (folder / "out.ngc").read_text()
    done = translate(folder, "--map", given(folder, "[lengths]\n3 = 31.5\n"), to="grbl", out="new.nc")
    assert done.exit == 3 and "[lengths] 3: nothing in job.cnc needs it" in done.err
    (folder / "machine.toml").write_text(MACHINE + "[tools.2]\nlength = 40\n", encoding="utf-8")
    words = ("--machine-to", "machine.toml", "--map", given(folder, "[lengths]\n2 = 31.5\n"))
    done = translate(folder, *words, to="grbl", out="new.nc")
    assert done.exit == 3 and "[lengths] 2 = 31.5: the machine file says that tool 2 is 40 mm long" in done.err


def test_the_style_of_a_map_is_used(folder: Path) -> None:
    style = '[style]\ndecimals_mm = 1\nnewline = "crlf"\nheader = ["(made)"]\nfooter = ["(done)"]\n'
    (folder / "job.cnc").write_text(JOB.replace("G0 Z5", "G0 Z5.24"), encoding="utf-8")
    done = translate(folder, "--map", given(folder, style))
    assert done.exit == 0, done
    text = (folder / "out.ngc").read_bytes()
    assert text.count(b"\n") == text.count(b"\r\n") > 5
    assert b" Z5\r\n" in text and b"Z5.2\r\n" in text and b"(made)\r\n" in text and b"(done)\r\n" in text


def test_a_proposed_map_is_one_that_works(folder: Path) -> None:
    proposed = translate(folder, "--map", "init", job="output.cnc", out="")
    assert (proposed.exit, proposed.err) == (0, "")
    assert "[outputs]\n3 = 3\n" in proposed.out and untouched(folder)
    (folder / "map.toml").write_text(proposed.out, encoding="utf-8")
    assert translate(folder, "--map", "map.toml", job="output.cnc").exit == 0


def test_a_report_for_programs(folder: Path) -> None:
    done = translate(folder, "--format", "json")
    report = json.loads(done.out)
    assert (done.exit, done.err) == (0, "")
    assert list(violations(report, SCHEMA_JSON)) == []
    assert report["schema"] == "gproof-translation-report/1"
    assert (report["verdict"], report["target"], report["written"]) == ("SAFE", "linuxcnc", ["out.ngc"])
    assert report["findings"] == [] and report["moves"] == {"source": 4, "target": 4}


# ---- 1


def wrong(old: bytes, new: bytes) -> Any:
    """A writer that makes a mistake."""
    entry = TARGETS["linuxcnc"]

    def write(job: Job, target: Target, machine: Machine, style: Style) -> dict[str, bytes]:
        files = entry.write(job, target, machine, style)
        assert old in files[""]
        return {name: text.replace(old, new) for name, text in files.items()}

    return replace(entry, write=write)


@each("old,new", [(b"X20", b"X20.01"), (b"G3 ", b"G2 "), (b"F600", b"F60"), (b"S6000 M3\n", b"")])
def test_a_wrong_translation_is_never_written(
    old: bytes, new: bytes, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patched:
        patched.setitem(TARGETS, "linuxcnc", wrong(old, new))
        for more in ((), ("--allow-unproven",), ("--partial",), ("--format", "json")):
            done = translate(folder, *more)
            assert done.exit == 1, (more, done)
            assert "GP704" in done.err + done.out
            assert untouched(folder)
    assert json.loads(done.out)["written"] == []


def test_a_difference_in_offsets_alone_says_so(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(TARGETS, "linuxcnc", wrong(b"G54", b"G55"))
    done = translate(folder)
    assert done.exit == 1 and untouched(folder)
    assert "the offsets or tool lengths that they count from are not" in done.err


# ---- 2


def test_a_construct_that_the_target_lacks_is_refused(folder: Path) -> None:
    done = translate(folder, to="grbl", job="mist.cnc")
    assert done.exit == 2 and untouched(folder)
    assert done.err.startswith(
        "mist.cnc:7:1: unknown GP703 [not-translated] mist coolant cannot be translated to grbl 1.1"
    )
    assert done.out.startswith("mist.cnc: not translated to grbl 1.1: nothing was written\n")
    report = json.loads(translate(folder, "--format", "json", to="grbl", job="mist.cnc").out)
    assert (report["verdict"], report["written"], report["moves"]) == ("UNKNOWN", [], None)
    assert [(one["code"], one["line"]) for one in report["findings"]] == [("GP703", 7)]


def test_a_job_with_a_mistake_is_not_translated(folder: Path) -> None:
    (folder / "mist.cnc").write_text(JOB.replace("X10 Y20", "X[10 Y20"), encoding="utf-8")
    done = translate(folder, "--allow-unproven", "--partial", job="mist.cnc")
    assert done.exit == 2 and "mist.cnc:4:" in done.err and untouched(folder)
    assert done.out == "mist.cnc: not translated to LinuxCNC: nothing was written\n"


def test_allow_unproven_writes_nothing_of_a_refused_job(folder: Path) -> None:
    assert translate(folder, "--allow-unproven", to="grbl", job="mist.cnc").exit == 2
    assert untouched(folder)


def test_partial_writes_what_comes_before_and_a_stop(folder: Path) -> None:
    done = translate(folder, "--partial", to="grbl", job="mist.cnc")
    assert done.exit == 2
    assert "out.ngc: written, not proven\n" in done.out
    lines = (folder / "out.ngc").read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("(NOT PROVEN: mist coolant cannot be translated to grbl 1.1")
    text = "\n".join(lines)
    assert "G3 X20 Y30" in text and "M7" not in text
    stop = lines.index("M0")  # what follows is no motion
    assert "the translation ends here: mist coolant" in lines[stop - 1]
    assert not any(line.startswith(("G0", "G1", "Z")) for line in lines[stop:])


def test_what_is_not_proven_is_written_only_on_demand(folder: Path) -> None:
    """Without CNC.MAC nobody knows what M3 does on the other machine."""
    other = folder.parent / "open.toml"
    other.write_text(f'{MACHINE}[controller]\ndialect = "wincnc"\n', encoding="utf-8")
    done = translate(folder, "--machine-to", str(other), to="wincnc")
    assert done.exit == 2 and untouched(folder)
    assert "GP705" in done.err or "GP113" in done.err
    done = translate(folder, "--allow-unproven", "--machine-to", str(other), to="wincnc")
    assert done.exit == 2 and done.out.startswith("out.ngc: written, not proven\n")
    first, second, *_ = (folder / "out.ngc").read_text(encoding="utf-8").splitlines()
    assert first.startswith("[NOT PROVEN: ") and first.endswith("]") and len(first) > 30
    assert second == "[plate]"


# ---- 3


BOTH = ("--machine", "machine.toml", "--machine-to", "machine.toml")
TO_EDING = ("--to", "eding", "-o", "out")
WRONG = [
    ("no such job", (*TO_EDING, "none.cnc"), "job none.cnc: no such file"),
    ("unknown --to", ("--to", "fanuc", "-o", "out", "job.cnc"), "--to fanuc: choose one of eding, "),
    ("no -o", ("--to", "eding", *BOTH, "job.cnc"), "-o FILE is missing"),
    ("no machine", (*TO_EDING, "--machine-to", "machine.toml", "job.cnc"),
     "--machine FILE is missing: the machine that job.cnc is for (cnc.ini, WINCNC.INI, McuWIN.ini, or gproof's own"),
    ("no machine to propose a map for", ("--to", "eding", "--map", "init", "job.cnc"), "--machine FILE is missing"),
    ("no other machine", (*TO_EDING, "--machine", "machine.toml", "job.cnc"),
     "--machine-to FILE is missing: the machine with Eding CNC (cnc.ini, or gproof's own machine file"),
    ("no other machine of another controller", ("--to", "grbl", "-o", "out", "--machine", "machine.toml", "job.cnc"),
     "--machine-to FILE is missing: the machine with grbl 1.1 (gproof's own machine file"),
    ("a folder without a machine", (*TO_EDING, "--machine-to", "machine.toml", "."), "--machine FILE is missing"),
    ("a folder without another machine", (*TO_EDING, "--machine", "machine.toml", "."), "--machine-to FILE is missing"),
    ("the other machine has another controller", (*TO_EDING, *BOTH[:3], "WINCNC.INI", "job.cnc"),
     "machine file WINCNC.INI: the machine has WinCNC, not Eding CNC"),
    ("a controller without a file of its own", ("--to", "linuxcnc", "-o", "out", *BOTH[:3], "WINCNC.INI", "job.cnc"),
     "machine file WINCNC.INI: is another controller's; LinuxCNC takes gproof's own machine file"),
    ("output is the source", ("--to", "eding", "-o", "job.cnc", *BOTH, "job.cnc"),
     "output job.cnc: would overwrite an input"),
    ("output is the machine", ("--to", "eding", "-o", "machine.toml", *BOTH[:3], "WINCNC.INI", "job.cnc"),
     "output machine.toml: would overwrite an input"),
    ("output is the other machine", ("--to", "wincnc", "-o", "WINCNC.INI", *BOTH[:3], "WINCNC.INI", "job.cnc"),
     "output WINCNC.INI: would overwrite an input"),
    ("output is the map", ("--to", "eding", "-o", "map.toml", *BOTH, "--map", "map.toml", "job.cnc"),
     "output map.toml: would overwrite an input"),
    ("output is a folder", ("--to", "eding", "-o", ".", *BOTH, "job.cnc"), "output .: is a folder, not a file"),
    ("no folder for the output", ("--to", "eding", "-o", "no/out", *BOTH, "job.cnc"), "no such folder: no"),
    ("no such machine", (*TO_EDING, "--machine", "machine.toml", "--machine-to", "none.toml", "job.cnc"),
     "machine file none.toml: no such file"),
    ("no such map", (*TO_EDING, *BOTH, "--map", "none.toml", "job.cnc"), "map file none.toml: no such file"),
    ("a map that is none", (*TO_EDING, *BOTH, "--map", "machine.toml", "job.cnc"),
     "map file machine.toml: cannot be used"),
    ("a chord tolerance of nothing", (*TO_EDING, *BOTH, "--chord-tolerance", "0", "job.cnc"), "--chord-tolerance"),
    ("rapids of no kind", (*TO_EDING, *BOTH, "--rapids", "bent", "job.cnc"), "--rapids"),
]  # fmt: skip
INI = "unit=MM\naxischar=XYZ\n" + "axisspec=p0 s0 d0 r100 a500 t1\naxisvel=r6000 f1500\n" * 3


@each("name,words,said", WRONG)
def test_wrong_input_is_one_line(name: str, words: tuple[str, ...], said: str, tmp_path: Path) -> None:
    folder = tmp_path / name
    folder.mkdir()
    texts = {"job.cnc": JOB, "machine.toml": MACHINE, "map.toml": SCHEMA, "WINCNC.INI": INI}
    for file, text in texts.items():
        (folder / file).write_text(text, encoding="utf-8")
    done = in_this_process(["translate", *words], folder)
    assert done.exit == 3 and done.out == ""
    assert said in done.err.splitlines()[-1], done.err
    assert {path.name: path.read_text(encoding="utf-8") for path in folder.iterdir()} == texts


MAPS = [
    ("[outputs]\n4 = 1\n", "[outputs] 4: nothing in job.cnc needs it"),
    ("[inputs]\n1 = 1\n", "[inputs] 1: nothing in job.cnc needs it"),
    ("[tools]\n1 = 1\n", "[tools] 1: nothing in job.cnc needs it"),
    ("[offsets]\n2 = 1\n", "[offsets] 2: nothing in job.cnc needs it"),
    ("[outputs]\n1 = 3\n2 = 3\n", "GP603"),
    ("[outputs]\nfan = 3\n", "GP603"),
    ("[outputs]\n1 = -3\n", "GP603"),
    ('[coolant]\nmist = "oil"\n', "GP603"),
    ('tool_change = "hope"\n', "GP603"),
    ("[style]\ndecimals_mm = 40\n", "GP603"),
    ("[outptus]\n1 = 1\n", "GP611"),
    ("[style]\nfont = 1\n", "GP611"),
    ("[[outputs]]\n", "GP603"),
    ("outputs = \n", "GP601"),
]


@each("text,said", MAPS)
def test_a_bad_map_is_told_with_its_line(text: str, said: str, folder: Path) -> None:
    done = translate(folder, "--map", given(folder, text))
    assert done.exit == 3 and untouched(folder)
    assert said in done.err, done.err
    assert "map.toml" in done.err


def test_no_permission(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "access", lambda path, mode, **_: mode != os.W_OK)
    done = translate(folder)
    assert done.exit == 3 and "no permission to write in folder" in done.err and untouched(folder)


def test_a_file_of_a_subprogram_is_not_overwritten(folder: Path) -> None:
    """WinCNC has subprograms in files of their own, next to the job."""
    called = "sub hole\nG1 Z-2 F100\nG0 Z5\nendsub\nG21 G90 G54\nG0 X1 Y1 Z5\ngosub hole\nG0 X2\ngosub hole\nM30\n"
    (folder / "called.cnc").write_text(called, encoding="utf-8")
    router = str(ROOT / "corpus" / "wincnc" / "router-atc" / "WINCNC.INI")
    words = ("--machine-to", router)
    first = translate(folder, *words, to="wincnc", job="called.cnc", out="out.tap")
    assert (first.exit, first.err) == (0, "")
    more = [path for path in folder.iterdir() if path.suffix.lower() == ".tap" and path.name != "out.tap"]
    assert len(more) == 1
    more[0].write_text("[mine]\n", encoding="utf-8")
    again = translate(folder, *words, to="wincnc", job="called.cnc", out="again.tap")
    assert again.exit == 3 and "exists; choose another folder" in again.err
    assert more[0].read_text(encoding="utf-8") == "[mine]\n" and not (folder / "again.tap").exists()


def test_the_style_is_that_of_the_first_comment_too(folder: Path) -> None:
    words = ("--partial", "--map", given(folder, '[style]\nnewline = "crlf"\n'))
    assert translate(folder, *words, to="grbl", job="mist.cnc").exit == 2
    text = (folder / "out.ngc").read_bytes()
    assert text.startswith(b"(NOT PROVEN") and text.count(b"\n") == text.count(b"\r\n")


# ---- folders


def test_the_extension_of_a_map_is_that_of_the_files(folder: Path) -> None:
    (folder / "parts").mkdir()
    (folder / "parts" / "a.cnc").write_text(JOB, encoding="utf-8")
    style = given(folder, '[style]\nextension = ".nc"\n')
    assert translate(folder, "--map", style, job="parts", out="new").exit == 0
    assert [path.name for path in (folder / "new").iterdir()] == ["a.nc"]


def test_a_folder_of_programs(folder: Path) -> None:
    (folder / "parts").mkdir()
    for name in ("a.cnc", "b.cnc"):
        (folder / "parts" / name).write_text(JOB, encoding="utf-8")
    done = translate(folder, job="parts", out="new")
    assert done.exit == 0 and done.out.count("proven: the same as") == 2
    assert sorted(path.name for path in (folder / "new").iterdir()) == ["a.ngc", "b.ngc"]
    (folder / "parts" / "b.cnc").write_text(WITH_OUTPUT, encoding="utf-8")
    assert translate(folder, job="parts", out="newer").exit == 2
    assert sorted(path.name for path in (folder / "newer").iterdir()) == ["a.ngc"]


def test_one_map_for_a_folder_of_programs(folder: Path) -> None:
    """Each entry is for some program; one that none needs is a mistake, and then nothing is written."""
    (folder / "parts").mkdir()
    for name, text in (("a.cnc", JOB), ("b.cnc", WITH_OUTPUT)):
        (folder / "parts" / name).write_text(text, encoding="utf-8")
    assert translate(folder, "--map", given(folder, "[outputs]\n3 = 2\n"), job="parts", out="new").exit == 0
    done = translate(folder, "--map", given(folder, "[outputs]\n3 = 2\n4 = 1\n"), job="parts", out="newer")
    assert done.exit == 3 and "[outputs] 4: nothing in parts needs it" in done.err
    assert not (folder / "newer").exists()


WITH_CALL = """(twice)
G21 G17 G90 G94 G40 G54 F300
G0 X0 Y0 Z5
M98 HOLE.TAP
G0 X20
M98 HOLE.TAP
"""
HOLE = "[a hole]\nG1 Z-2 F100\nG0 Z5 [out]\n"


@pytest.fixture
def shop(folder: Path) -> Path:
    """Two programs with WinCNC that call the same file, and one that is called by nobody."""
    (folder / "parts").mkdir()
    job = WITH_CALL.replace("G21 G17 G90 G94 G40 G54 F300", "G22\nG90\nG1 F300").replace("(twice)", "[twice]")
    for name in ("a.tap", "b.tap"):
        (folder / "parts" / name).write_text(job, encoding="utf-8")
    (folder / "parts" / "HOLE.TAP").write_text(HOLE, encoding="utf-8")
    (folder / "CNC.MAC").write_text("")
    return folder


def test_a_called_file_is_part_of_its_programs_and_no_program(shop: Path) -> None:
    """It is translated once, with its comments; the report says whose part it is, and sums up."""
    done = translate(shop, *BOTH, job="parts", out="new")
    assert done.exit == 0
    assert sorted(path.name for path in (shop / "new").iterdir()) == ["a.ngc", "b.ngc"]
    assert "parts/HOLE.TAP: part of parts/a.tap" in done.out and "2 programs: 2 proven, 0 refuted" in done.out
    text = (shop / "new" / "a.ngc").read_text()
    assert text.count("(a hole)") == text.count("(out)") == 1 and text.count("(twice)") == 1


def test_a_file_of_two_programs_is_written_once(shop: Path) -> None:
    """Where the target has files too; a second run of the command may write the same again."""
    for _ in range(2):
        done = translate(shop, *BOTH, job="parts", to="wincnc", out="new")
        assert done.exit == 0, done.err
        assert sorted(path.name for path in (shop / "new").iterdir()) == ["HOLE.TAP", "a.tap", "b.tap"]
    assert (shop / "new" / "HOLE.TAP").read_text().startswith("[a hole]\n")


def test_two_files_of_one_name_get_two_names(shop: Path) -> None:
    """Subprograms that are not the same in two programs are two files, and each program calls its own."""
    other = (shop / "parts" / "b.tap").read_text() + "G20\nM98 HOLE.TAP\n"
    (shop / "parts" / "b.tap").write_text(other, encoding="utf-8")
    done = translate(shop, *BOTH, job="parts", to="wincnc", out="new")
    assert done.exit == 0, done.err
    new = {path.name: path.read_text() for path in (shop / "new").iterdir()}
    assert new.keys() == {"HOLE.TAP", "HOLE_2.TAP", "HOLE_3.TAP", "a.tap", "b.tap"}
    assert "G20" in new["HOLE_3.TAP"] and "G2" not in new["HOLE.TAP"] and "M98 HOLE.TAP" not in new["b.tap"]


def test_the_reports_of_a_folder(shop: Path) -> None:
    (shop / "parts" / "c.tap").write_text("G90\nG0 X1\nL37\n", encoding="utf-8")
    report = json.loads(translate(shop, *BOTH, "--format", "json", job="parts", out="new").out)
    assert list(violations(report, SCHEMA_JSON)) == []
    assert [one["verdict"] for one in report["programs"]] == ["SAFE", "SAFE", "UNKNOWN"]
    assert report["exit_code"] == 2 and report["called"] == {"parts/HOLE.TAP": "parts/a.tap"}
    page = translate(shop, *BOTH, "--format", "markdown", job="parts", out="newer").out
    assert "| a.tap | SAFE |" in page and "| HOLE.TAP | part of a.tap |" in page and "## c.tap for LinuxCNC" in page


def test_programs_of_one_name_keep_their_extensions(folder: Path) -> None:
    (folder / "parts").mkdir()
    (folder / "parts" / "a.cnc").write_text(JOB, encoding="utf-8")
    (folder / "parts" / "a.ngc").write_text(JOB, encoding="utf-8")
    assert translate(folder, *BOTH, job="parts", to="grbl", out="new").exit == 0
    assert sorted(path.name for path in (folder / "new").iterdir()) == ["a_cnc.nc", "a_ngc.nc"]
    done = translate(folder, *BOTH, job="parts", to="grbl", out="parts/new")
    assert done.exit == 3 and "is in the folder that is translated" in done.err


def test_both_lines_are_shown_where_the_programs_part(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(TARGETS, "linuxcnc", wrong(b"X20", b"X20.01"))
    done = translate(folder)
    assert done.exit == 1 and "here the translation has: G3 X20.01 Y30" in done.err and "G3 X20 Y30 I0 J10" in done.err


def test_a_process_of_its_own_says_the_same(folder: Path) -> None:
    words = ["translate", "job.cnc", "--machine", "machine.toml", "--to", "grbl", "--machine-to", machine_to("grbl")]
    words += ["-o", "out.nc"]
    assert in_own_process(words, folder) == in_this_process(words, folder)
