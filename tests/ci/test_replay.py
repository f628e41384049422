"""`make replay`: a planted change is caught and named, no language is empty, and nothing is compared with itself."""

from __future__ import annotations

import dataclasses
import json
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
from corpus.expectations import jobs

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "scripts" / "replay"
sys.path.insert(0, str(FOLDER))

from cases import all_cases  # noqa: E402  (scripts/replay is no package)
from moved import cases_of, lost  # noqa: E402
from named_fields import Mapping  # noqa: E402
from revisions import site_of  # noqa: E402
from wordings import Wordings  # noqa: E402
from worker import FAILED, answer, aspects  # noqa: E402

LIMITS, POCKET = "docs/codes/GP301/bad (eding)", "corpus/eding/pocket-in-steps/job.cnc"
PLANTS = [
    ("passes/checks/limits/offset_ranges.py", "ROUNDING = 1e-9", "ROUNDING = 50.0"),
    ("passes/motion/step.py", "TOLERANCE = 25e-6", "TOLERANCE = 1e-5"),
    ("backend/emit/eding/program.py", "INDENT = 2", "INDENT = 3"),
]
"""File, what stands there, what is planted."""

SHOW = {
    LIMITS: {"check", "check, json", "check, sarif", "dump, stream", "fit", "compile"},
    POCKET: {"dump, stream", "compile", "compile, body", "compile, stream.ir", "fmt"},
}
"""The aspects in which these programs differ then, and no others."""


def replay(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(FOLDER), *words], cwd=ROOT, text=True, capture_output=True, check=False, timeout=300
    )


def test_planted_changes_are_caught(tmp_path: Path) -> None:
    site = site_of(ROOT, tmp_path)
    for file, there, planted in PLANTS:
        path = site / "gproof" / file
        text = path.read_text(encoding="utf-8")
        assert text.count(there) == 1
        path.write_text(text.replace(there, planted), encoding="utf-8")
    done = replay(str(site), "--only", LIMITS, "--only", POCKET)
    assert done.returncode == 1, done.stderr
    lines = [line.removesuffix(" differs") for line in done.stdout.splitlines() if line.endswith(" differs")]
    assert sorted(lines) == sorted(f"{case}: {name}" for case, names in SHOW.items() for name in names), done.stdout


def test_the_same_is_the_same(tmp_path: Path) -> None:
    done = replay(str(site_of(ROOT, tmp_path)), "--only", "GP301/bad")
    assert (done.returncode, done.stderr) == (0, "")


SENTENCE = (
    "{axis} would reach {reached:.3f} {unit}, {over:.3f} {unit} past its {side} travel limit of {limit:.3f} {unit}"
)
SAME_FACTS = "past its {side} end of {limit:.4f} {unit} by {over:.3f} {unit}: {axis} gets to {reached:.3f} {unit}"
WITHOUT_A_NUMBER = "{axis} would reach {reached:.3f} {unit}, past its {side} travel limit of {limit:.3f} {unit}"


@pytest.mark.parametrize(("planted", "code"), [(SAME_FACTS, 0), (WITHOUT_A_NUMBER, 1)], ids=["wording", "lost number"])
def test_other_words_are_listed_and_lost_facts_are_differences(planted: str, code: int, tmp_path: Path) -> None:
    site = site_of(ROOT, tmp_path)
    path = site / "gproof" / "ir" / "codes" / "c300_limits.py"
    text = path.read_text(encoding="utf-8")
    assert text.count(SENTENCE) == 1
    path.write_text(text.replace(SENTENCE, planted), encoding="utf-8")
    done = replay(str(site), "--only", LIMITS)
    assert done.returncode == code, done.stdout + done.stderr
    listed = [line for line in done.stdout.splitlines() if line.startswith("GP301: ")]
    assert len(listed) == (code == 0)
    assert code or ("gets to # mm → X would reach # mm, # mm past its" in listed[0] and "rounded" not in listed[0])
    assert ("check differs" in done.stdout) is (code == 1)


def told(old: str, new: str, name: str = "check") -> tuple[bool, list[str]]:
    """Whether two lines of a report differ in words alone, and the list."""
    wordings = Wordings()
    place = "job.cnc:3:1: error GP301 [soft-limit] "
    left = wordings.explain({name: (f"{place}{old}\nend\n", f"{place}{new}\nend\n")})
    return not left, wordings.lines()


def test_what_is_another_wording() -> None:
    """The same numbers, as often, three decimals for four; the same names."""
    assert told("X goes to 5.12345 mm", "X moves to 5.123 mm") == (
        True,
        ["GP301: X goes to # mm → X moves to # mm (1, rounded)"],
    )
    for old, new in (
        ("X goes to 5.1 mm", "X moves to 5 mm"),
        ("X goes to 5 mm of 5 mm", "X moves to 5 mm"),
        ("X goes to 5 mm", "X moves to 5 mm of 5 mm"),
        ("X goes to 5.1238 mm", "X moves to 5.123 mm"),
        ("X goes to 5 mm", "Y moves to 5 mm"),
        ("it goes into 'clamp'", "it hits 'vice'"),
        ("set max_feed", "change the feed"),
        ("limits are SAFE here", "limits are UNSAFE here"),
        ("file /a/1.toml is bad", "a file is bad"),
    ):
        assert told(old, new) == (False, []), (old, new)
    assert told("a file is bad", "file /a/1.toml is bad")[0] is True
    assert told("the axis goes", "the axis moves", "fmt")[0] is False


def test_places_codes_and_values_are_no_words() -> None:
    """Of a report as JSON; sentences may stand in another order, where they alone made it."""

    def of(message: str, line: int = 3, verdict: str = "SAFE") -> str:
        return json.dumps({"verdict": verdict, "findings": [{"code": "GP301", "line": line, "message": message}]})

    for other, alike in (
        (of("X moves there"), True),
        (of("X moves there", 4), False),
        (of("X moves there", 3, "UNSAFE"), False),
    ):
        assert (Wordings().explain({"check, json": (of("X goes there"), other)}) == {}) is alike
    form = '(Op text: "X goes there" op: "feed" at: 3)'
    assert not Wordings().explain({"dump, trace": (form, form.replace("goes", "moves"))})
    assert Wordings().explain({"dump, trace": (form, form.replace('"feed"', '"rapid"'))})
    assert Wordings().explain({"dump, trace": (form, form.replace("at: 3", "at: 4"))})


def test_no_language_is_empty() -> None:
    """All programs of the four folders are cases, by language and folder."""
    cases = all_cases()
    by_folder = Counter((case.dialect, case.name.split("/")[0]) for case in cases)
    for dialect in ("eding", "wincnc", "mcuwin"):
        assert min(by_folder[dialect, "corpus"], by_folder[dialect, "docs"]) >= 60, by_folder
    assert min(by_folder[dialect, "tests"] for dialect in ("eding", "wincnc", "mcuwin")) >= 250, by_folder
    programs = {case.program for case in cases}
    assert all(programs.issuperset(jobs(dialect)) for dialect in ("eding", "wincnc", "mcuwin"))
    assert all(case.machine is not None and case.machine.is_file() and case.program.is_file() for case in cases)


@pytest.mark.parametrize("words", [(), ("no-such-revision",)], ids=["none", "unknown"])
def test_what_can_not_be_compared(words: tuple[str, ...]) -> None:
    done = replay(*words)
    assert done.returncode in (2, 3)
    assert "Traceback" not in done.stderr


def test_a_command_that_breaks_has_not_run(tmp_path: Path) -> None:
    """Or two revisions that both break would be alike."""

    def broken(_: list[str]) -> int:
        raise TypeError

    case = {"words": [], "check": ["--also", "all"], "fmt": [], "program": "job.cnc"}
    found = answer(aspects(broken, case, tmp_path), False, tmp_path)
    assert {name for name, text in found.items() if not text.startswith(FAILED)} == set()


def test_a_mapping_explains_form_and_nothing_else() -> None:
    """Texts of before with all fields in order, of now with names; a value that differs is left."""
    mapping = Mapping.__new__(Mapping)
    mapping._fields = {
        "Machine": [("name", None), ("controller", "(Controller none 0.25 none none (Controls none []) none)"),
                    ("unit", "1.0")],
        "Controller": [("dialect", "none"), ("fifo_time", "0.25"), ("macro_file", "none"), ("thread_peak", "none"),
                       ("controls", "(Controls none [])"), ("din", "none")],
        "Controls": [("nesting", "none"), ("feed_groups", "[]")],
    }  # fmt: skip
    plain = mapping.plain
    before = '(Machine "m" (Controller "wincnc" 0.25 none none (Controls 3 ["xy"]) none) 25.4)'
    now = (
        '(Machine name: "m"\n controller: (Controller dialect: "wincnc")\n'
        ' settings: (WinCncSettings feed_groups: ["xy"] nesting: 3) unit: 25.4)'
    )
    assert plain(before, named=False) == plain(now, named=True)
    for there, planted in (("3", "4"), ('"xy"', '"xyz"'), ("25.4", "1.0"), ('"m"', '"n"')):
        assert plain(before, named=False) != plain(now.replace(there, planted), named=True)
    before = '(Machine "m" (Controller "eding" 0.5 "a.cnc" none (Controls none []) none) 1.0)'
    now = (
        '(Machine name: "m" controller: (Controller dialect: "eding" fifo_time: 0.5)'
        ' settings: (EdingSettings macro_file: "a.cnc"))'
    )
    assert plain(before, named=False) == plain(now, named=True)
    table = "(columns trace 1\n ; a b\n 1 2\n)"
    assert plain(table, named=False) == plain(table.replace(" 1 ", "  1  "), named=True) != plain("", named=True)


def test_a_case_that_is_gone_or_has_other_files_is_found() -> None:
    """Under another name with the same files it is the same case."""
    here = cases_of(ROOT)
    assert list(lost(here, here)) == []
    by_name = {case.name: case for case in here}
    plate, pocket, wave = (
        by_name.pop(f"corpus/{name}")
        for name in ("eding/drilled-plate/job.cnc", "eding/pocket-in-steps/job.cnc", "mcuwin/engraver/jobs/wave.src")
    )
    assert all(plate.parts) and len(by_name) > 2000
    changed = dataclasses.replace(pocket, parts=("other", pocket.parts[1], "another", pocket.parts[3]))
    now = [*by_name.values(), dataclasses.replace(plate, name="elsewhere"), changed]
    assert list(lost(here, now)) == [
        f"{pocket.name}: another program, another setup",
        f"{wave.name}: not here, nor its files elsewhere",
    ]
