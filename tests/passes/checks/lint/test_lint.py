"""The property sense: each mistake is found in a good job, and no good job, of the corpus or made, gives a warning.

What is read before it is set is checked against runs: random programs of assignments, conditions and loops are run with
every outcome of their conditions, by an interpreter of a few lines that shares nothing with the pass.
"""

from __future__ import annotations

import json
import random
import re
from pathlib import Path

import pytest
from corpus.expectations import around, expectation, jobs
from support.campaigns import seeds, share
from support.command import in_this_process
from support.goldens import ROOT

from gproof.frontend.eding.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.setup import NOTHING
from gproof.passes.checks.lint.unset_variables import UnsetReads

CORPUS = ROOT / "corpus"
DOCS = ROOT / "docs" / "codes"
OWN = frozenset(f"GP{n}" for n in range(150, 160))
HEAD = "G21 G17 G90 G94 G40 G49 G54\n"


def told(job: Path, *words: str) -> tuple[str, list[dict[str, object]]]:
    """The property's verdict, and its findings."""
    done = in_this_process(["check", str(job), "--also", "sense", "--format", "json", *words], job.parent)
    report = json.loads(done.out)
    return report["properties"]["sense"]["verdict"], [f for f in report["findings"] if f["code"] in OWN]


def eding(folder: Path, text: str, machine: Path = DOCS / "machine.toml") -> list[tuple[str, int]]:
    job = folder / "job.cnc"
    job.write_text(text, encoding="utf-8")
    verdict, found = told(job, "--machine", str(machine), "--setup", "zero", "--dialect", "eding")
    assert verdict != "UNSAFE"
    return [(str(f["code"]), int(str(f["line"]))) for f in found]


def mcuwin(folder: Path, text: str) -> list[tuple[str, int]]:
    job = folder / "job.src"
    job.write_text(text, encoding="utf-8")
    machine, setup = DOCS / "mcuwin" / "machine.toml", DOCS / "mcuwin" / "setup.toml"
    _, found = told(job, "--machine", str(machine), "--setup", str(setup), "--dialect", "mcuwin")
    return [(str(f["code"]), int(str(f["line"]))) for f in found]


GOOD = (
    HEAD
    + "#1 = 0\nwhile [#1 < 3]\n  gosub groove\n  #1 = [#1 + 1]\nendwhile\nif [#1 == 3]\n  #2 = 5\n"
    + "else\n  #2 = 6\nendif\n"
    + "G0 Z#2\nM30\nsub groove\n  #10 = [#1 * 20]\n  G0 X#10\n  G1 Y50 F500\n  G0 Y0\nendsub\n"
)
MUTANTS = {
    "the counter is never set": ("#1 = 0\n", "", "GP156"),
    "one side of a condition sets it": ("else\n  #2 = 6\n", "", "GP156"),
    "only the subprogram sets it": ("G0 Z#2", "G0 Z#2 X#10", "GP156"),
    "a mistyped number": ("G0 X#10", "G0 X#11", "GP157"),
    "the call is forgotten": ("  gosub groove\n", "", "GP155"),
    "a number for a variable": ("if [#1 == 3]", "if [1 == 3]", "GP158"),
    "no units": ("G21 ", "", "GP150"),
    "no distances": ("G90 ", "", "GP159"),
}


def test_the_good_job_is_good(tmp_path: Path) -> None:
    assert eding(tmp_path, GOOD) == []


@pytest.mark.parametrize("name", MUTANTS)
def test_a_mistake_is_found(name: str, tmp_path: Path) -> None:
    old, new, code = MUTANTS[name]
    assert GOOD.count(old) == 1
    found = {one for one, _ in eding(tmp_path, GOOD.replace(old, new))}
    # What a line that runs reads unset is GP234 already, told by default.
    assert code in found or (code == "GP156" and "GP234" in _all_codes(tmp_path))


def _all_codes(folder: Path) -> set[str]:
    words = ["check", "job.cnc", "--machine", str(DOCS / "machine.toml"), "--format", "json", "--dialect", "eding"]
    return {f["code"] for f in json.loads(in_this_process(words, folder).out)["findings"]}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        # A loop that may run no time sets nothing for what is behind it; one that runs once at least does.
        ("#1 = 5\nwhile [#1 < 3]\n#2 = 1\n#1 = [#1 + 1]\nendwhile\nG0 X#2\n", [("GP156", 7)]),
        # A computed number may be any variable.
        ("#1 = 5\n#[#1 + 1] = 10\nG0 X#6 Y#1\n", []),
        # Variables that outlive the job are not the job's alone.
        ("G0 X#4000\n", []),
        # A subprogram that needs a variable is fine where its caller has set it, and its own read is told where not.
        ("#5 = 1\ngosub a\nM30\nsub a\nG0 X#5\nendsub\n", []),
        ("gosub a\nM30\nsub a\nG0 X#5\nendsub\n", [("GP156", 5)]),
        # The operator's answer sets what the dialog names, and what tells how it ended.
        ('#7 = 1\ndlgmsg "how wide" "w" 7\nif [#5398 == 1]\nG0 X#7\nendif\n', []),
        # A part that ends the job: behind it only the other outcome goes on.
        ("#1 = 2\nif [#1 > 1]\n#3 = 5\nelse\nM30\nendif\nG0 X#3\n", []),
    ],
)
def test_ways_through_a_program(text: str, found: list[tuple[str, int]], tmp_path: Path) -> None:
    job = HEAD + text + ("" if "M30\nsub" in text else "M30\n")
    ours = [one for one in eding(tmp_path, job) if one[0] == "GP156"]
    assert ours == found or (not ours and "GP234" in _all_codes(tmp_path))


def test_labels_and_jumps(tmp_path: Path) -> None:
    good = "%P\nN1 G90 F300\nCI600 := 0\nL10\nN2 G00 X(100 + CI600)\nCI600 := CI600 + 1\n"
    good += "$if (CI600 < 3) then begin\nM96 L10\n$end\nN3 M30\n%\n"
    assert mcuwin(tmp_path, good) == []
    assert mcuwin(tmp_path, good.replace("M96 L10\n", "CI600 := 9\n")) == [("GP154", 4)]
    dead = good.replace("N3 M30", "M96 L20\nN4 G00 X0\nL20\nN3 M30")
    assert mcuwin(tmp_path, dead) == [("GP153", 11)]
    # A line that only ends the program may stand behind a jump: the compiler asks for one.
    assert mcuwin(tmp_path, "%P\nN1 G90 F300\nL10\nN2 G00 X100\nM96 L10\nN3 M30\n%\n") == []


ENDS = {
    # The text begins in line 4. Behind the end of the body that runs first GP123 tells; block delete may be on.
    "M30\nG0 X1\n": [],
    "if [#1 == 1]\nM30\nendif\n": [],
    "if [#1 == 1]\n/M30\nG0 X1\nendif\n": [],
    "if [#1 == 1]\nG0 X1\nM30\nG0 X2\nG0 X3\nendif\n": [("GP153", 7)],
    "if [#1 == 1]\nM2\nelse\nG0 X1\nendif\n": [],
    "if [#1 == 1]\nM30\n#5 = 3\nendif\nG0 X#5\n": [("GP153", 6)],
    "if [#1 == 1]\nM30\nif [#1 == 2]\nG0 X1\nendif\nendif\n": [("GP153", 6)],
    "if [#1 == 1]\nM30\nM2\nendif\n": [],
    "while [#1 < 3]\n#1 = [#1 + 1]\nG0 X1 M30\nG0 X2\nendwhile\n": [("GP153", 7)],
    "gosub a\nM30\nsub a\nM30\nG0 X2\nendsub\n": [("GP153", 8)],
}


@pytest.mark.parametrize("text", ENDS)
def test_nothing_leads_behind_an_end_of_the_program(text: str, tmp_path: Path) -> None:
    job = HEAD + "#1 = 2\n#5 = 0\n" + text
    job += "" if "sub a" in text or text.startswith("M30") else "M30\n"
    assert [one for one in eding(tmp_path, job) if one[0] == "GP153"] == ENDS[text]


def test_nothing_leads_behind_an_end_within_a_condition(tmp_path: Path) -> None:
    good = "%P\nN1 G90 F300\nCI600 := 0\n$if (CI600 < 3) then begin\nM30\nN2 G00 X1\n$end\nN3 M30\n%\n"
    assert [one for one in mcuwin(tmp_path, good) if one[0] == "GP153"] == [("GP153", 6)]


FOREIGN = {
    "LinuxCNC": "O100 sub\nG0 X1\nO100 endsub\nO100 call\n",
    "Fanuc or Mach": "O1234\nG65 P9010 A1\nM98 P1000\nIF [#1 EQ 2] GOTO 10\n",
    "Siemens": 'MSG("hello")\nR1=5\nCYCLE81(10,0,2,-5)\n',
    "Heidenhain": "BEGIN PGM 1 MM\nTOOL CALL 1 Z S2000\nL X+10 Y+5 R0 FMAX\nEND PGM 1 MM\n",
    "a 3D printer (RepRap, Marlin)": "M104 S200\nM190 S60\nG29\nG1 X10 E0.5\n",
    "grbl": "$H\n$X\n$100=80\n",
    "WinCNC": "L21\nM98 CUT.TAP\nM11C1\n",
    "McuWIN": "CD600 := 5\n$writeln('x')\nM96 L10\n",
}


@pytest.mark.parametrize("controller", FOREIGN)
def test_a_job_for_another_controller(controller: str, tmp_path: Path) -> None:
    job = tmp_path / "job.cnc"
    job.write_text(HEAD + FOREIGN[controller] + "M30\n", encoding="utf-8")
    _, found = told(job, "--machine", str(DOCS / "machine.toml"), "--setup", "zero", "--dialect", "eding")
    looks = [str(f["message"]) for f in found if f["code"] == "GP152"]
    assert len(looks) == 1
    assert f"looks like a program for {controller}:" in looks[0]


@pytest.mark.parametrize(
    "lines",
    [
        # QtPlasmaC: materials by number, spindles by $, feeds from pins of HAL.
        "M190 P2\nM66 P3 L3 Q1\nF#<_hal[plasmac.cut-feed-rate]>\n", "M3 $0 S1\nM5 $0\n", "M62 P1\nM67 E0 Q50\n",
        # Polar words, splines.
        "G0 @10 ^30\n^120\n", "G5.1 X10 Y10 I2 J3\nG5.2 X1 Y1 P1 L3\nG5.3\n",
    ],
)  # fmt: skip
def test_what_only_linuxcnc_has(lines: str, tmp_path: Path) -> None:
    """Words of its manual ("G Codes", "M Codes", "Polar Coordinates"); the temperature of a bed is M190 S."""
    job = tmp_path / "job.cnc"
    job.write_text(HEAD + lines + "M30\n", encoding="utf-8")
    _, found = told(job, "--machine", str(DOCS / "machine.toml"), "--setup", "zero", "--dialect", "eding")
    looks = [str(f["message"]) for f in found if f["code"] == "GP152"]
    assert [one.partition(":")[0] for one in looks] == ["this job looks like a program for LinuxCNC"]


def test_an_eding_job_on_a_wincnc_machine(tmp_path: Path) -> None:
    job = tmp_path / "job.tap"
    job.write_text('msg "hello"\ngosub a\nG0 X10\nsub a\nendsub\n', encoding="utf-8")
    (tmp_path / "CNC.MAC").write_text("", encoding="utf-8")
    machine = DOCS / "wincnc" / "WINCNC.INI"
    _, found = told(job, "--machine", str(machine), "--dialect", "wincnc")
    assert [str(f["message"]) for f in found if "Eding CNC" in str(f["message"])]


# ---- units


def test_an_inch_job_read_as_millimetres_and_the_reverse(tmp_path: Path) -> None:
    """The corpus: the other code of units in a good job is found where the job tells which one it means."""
    for name, old, new in (
        ("inch-bracket", "g20", "g21"),
        ("drilled-plate", "g21", "g20"),
        ("thread-milling", "g21", "g20"),
    ):
        folder = CORPUS / "eding" / name
        text = (folder / "job.cnc").read_text(encoding="utf-8")
        assert re.search(old, text, re.I)
        for content, found in ((text, False), (re.sub(old, new, text, flags=re.I), True)):
            job = tmp_path / "job.cnc"
            job.write_text(content, encoding="utf-8")
            machine = expectation(folder / "job.cnc")["machine"]
            _, ours = told(job, "--machine", machine, "--setup", "zero", "--dialect", "eding")
            assert ("GP151" in {f["code"] for f in ours}) is found, (name, found)


@pytest.mark.parametrize("job", ["eding/wrong-units/job.cnc", "mcuwin/rotary-mill/jobs/millimetres-as-inches.src"])
def test_the_wrong_units_of_the_corpus(job: str) -> None:
    """Both go to X 90 inches, 2286 mm, on machines of 440 and 400 mm."""
    path = CORPUS / job
    _, found = told(path, "--machine", expectation(path)["machine"])
    (message,) = [str(f["message"]) for f in found if f["code"] == "GP151"]
    assert "look like millimetres, but are read as inches" in message
    assert "X 22" in message or "X 21" in message


def test_a_small_job_in_millimetres_is_no_inch_job(tmp_path: Path) -> None:
    """A circuit board of 20 mm, slow and fast-turning: one thing alone says nothing."""
    lines = "".join(f"G1 X{x / 100} Y{(x * 7) % 1900 / 100} F60\n" for x in range(0, 2000, 37))
    text = HEAD + "S24000 M3\nG0 Z2\nG0 X0 Y0\nG1 Z-0.1 F60\n" + lines + "G0 Z2\nM30\n"
    assert "GP151" not in {code for code, _ in eding(tmp_path, text)}


# ---- ways, against runs

Tree = list[tuple[str, object]]
Seen = set[tuple[frozenset[int], frozenset[int]]]
"""(variables that are set, variables that were read before they were set)."""


def _tree(rng: random.Random, depth: int) -> Tree:
    body: Tree = []
    for _ in range(rng.randint(1, 4)):
        kind = rng.choice(["set", "set", "read", "if", "while", "call"] if depth < 3 else ["set", "read"])
        if kind in ("set", "read"):
            body.append((kind, rng.randint(10, 13)))
        elif kind == "if":
            body.append((kind, (_tree(rng, depth + 1), _tree(rng, depth + 1))))
        else:
            body.append((kind, _tree(rng, depth + 1)))
    return body


def _text(body: Tree, subs: list[str]) -> str:
    """As Eding text; what decides conditions (#4000) outlives jobs, so that nobody knows it."""
    out = ""
    for kind, what in body:
        if kind == "set":
            out += f"#{what} = 1\n"
        elif kind == "read":
            out += f"#50 = #{what}\n"
        elif kind == "if":
            one, other = what  # type: ignore[misc]
            out += f"if [#4000 == 1]\n{_text(one, subs)}else\n{_text(other, subs)}endif\n"
        elif kind == "while":
            out += f"while [#4000 == 2]\n{_text(what, subs)}endwhile\n"  # type: ignore[arg-type]
        else:
            inner = _text(what, subs)  # type: ignore[arg-type]
            subs.append(f"sub part{len(subs)}\n{inner}endsub\n")
            out += f"gosub part{len(subs) - 1}\n"
    return out


def _runs(body: Tree, states: Seen) -> Seen:
    """What may be set and read behind a body; loops are run up to twice: more passes read nothing new."""
    for kind, what in body:
        if kind == "set":
            states = {(known | {what}, early) for known, early in states}  # type: ignore[misc]
        elif kind == "read":
            states = {(known, early if what in known else early | {what}) for known, early in states}  # type: ignore[misc]
        elif kind == "if":
            one, other = what  # type: ignore[misc]
            states = _runs(one, states) | _runs(other, states)
        elif kind == "while":
            once = _runs(what, states)  # type: ignore[arg-type]
            states = states | once | _runs(what, once)  # type: ignore[arg-type]
        else:
            states = _runs(what, states)  # type: ignore[arg-type]
    return states


@pytest.mark.parametrize("seed", seeds(20, 1000))
def test_what_is_read_too_early_is_what_some_run_reads_too_early(seed: int, tmp_path: Path) -> None:
    body = _tree(random.Random(seed), 0)
    subs: list[str] = []
    text = _text(body, subs) + "M30\n" + "".join(subs)
    job = tmp_path / "job.cnc"
    job.write_text(text, encoding="utf-8")
    program = load_program(job, Findings())
    assert program is not None, text
    found = {number for number, _, _ in UnsetReads(program, NOTHING).found()}
    early = set().union(*(read for _, read in _runs(body, {(frozenset(), frozenset())})))
    assert found == early, f"seed {seed}\n{text}"


# ---- the corpus

JOBS = sorted(
    job for dialect in ("eding", "wincnc", "mcuwin") for job in jobs(dialect) if expectation(job)["verdict"] == "SAFE"
)


@pytest.mark.parametrize("job", share(JOBS, 3), ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_good_jobs_of_the_corpus(job: Path) -> None:
    verdict, found = told(job, *around(job))
    assert (verdict, [(f["code"], f["line"]) for f in found]) == ("SAFE", [])
