"""The examples in docs/codes: each bad program gives its code on the marked line, each good one no error (pages.py)."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
from corpus.expectations import (
    JUDGED,
    Found,
    findings,
    markers,
    misplaced,
    report_of,
    shown,
    strange,
    strange_texts,
)
from corpus.pages import (
    DOCS,
    FOLDERS,
    NAMES,
    PAGES,
    dialects,
    differences,
    reasons,
    sentences,
    settings,
    table,
    text_of,
)
from support.campaigns import share
from support.each import each

from gproof.ir.codes import CODES, RETIRED


@dataclass(frozen=True)
class Result:
    """What one run of the command line left behind; strange: texts that no reader can make anything of."""

    exit: int
    output: str
    found: list[Found]
    strange: list[str]


class Runner:
    """Runs gproof inside this process, so that two hundred runs take seconds."""

    def __init__(self, capsys: pytest.CaptureFixture[str], scratch: Path):
        self.capsys, self.scratch = capsys, scratch

    def __call__(self, folder: Path, dialect: str, side: str) -> tuple[Path, Result]:
        run = settings(folder, dialect, side)
        program = folder / run["program"]
        words = [run["command"], str(program), "--machine", str(folder / run["machine"])]
        if run["setup"] != "none":
            setup = run["setup"]
            words += ["--setup", setup if setup == "zero" else str(folder / setup)]
        if run["command"] == "check":
            words += ["--format", "json"]
        else:
            words += ["-o", str(self.scratch / f"{side}.gpx")]
        return program, self.run([*words, *run["options"]], as_json=run["command"] == "check")

    def run(self, words: list[str], *, as_json: bool) -> Result:
        from gproof.cli.main import main

        exit_code = main(words)
        captured = self.capsys.readouterr()
        output = captured.out + captured.err
        if as_json and captured.out.lstrip().startswith("{"):
            report = report_of(captured.out)
            return Result(exit_code, output, findings(report), strange_texts(report))
        lines = [line for line in output.splitlines() if not re.match(r" +\d+ \||\s*\|", line)]
        return Result(
            exit_code, output, shown(output), [f"{one} in {line!r}" for line in lines for one in strange(line)]
        )


@pytest.fixture
def gproof(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Runner:
    return Runner(capsys, tmp_path)


Golden = Callable[[Path, str], None]
EXAMPLES = [(folder, dialect) for folder in FOLDERS for dialect in dialects(folder)]


def cell_name(value: Path | str) -> str:
    return value.name if isinstance(value, Path) else value


def test_every_code_has_a_page_and_every_page_a_code() -> None:
    assert {folder.name for folder in FOLDERS} == {f"GP{number}" for number in CODES}


@each("folder", FOLDERS, ids=lambda folder: folder.name)
def test_explanation_starts_with_number_and_name(folder: Path) -> None:
    explanation = text_of(folder).partition("\n## Programs\n")[0]
    number = int(folder.name[2:])
    assert explanation.splitlines()[0] == f"# {folder.name} {CODES[number].name}"
    assert "**Why it matters.**" in explanation
    assert "**What to do.**" in explanation


def test_every_code_has_a_pair_for_each_controller_or_a_reason_why_not() -> None:
    """No finding without its programs: where a controller has none, the page says why."""
    for folder in FOLDERS:
        filled, why = set(dialects(folder)), set(reasons(text_of(folder)))
        assert filled | why == set(NAMES), f"{folder.name}: a program, or a line `- WinCNC: why not` under its programs"
        assert not filled & why, f"{folder.name}: a reason, and there is a program"


def test_the_list_of_pages(golden: Golden) -> None:
    """docs/codes/README.md, which `make goldens` writes."""
    golden(PAGES / "README.md", list_of_pages())


HUNDREDS = (
    "", "Language", "Meaning", "Limits and areas", "Geometry", "Motion, time and cutting", "Machine and setup files",
    "Printing", "Streams, packages and runs",
)  # fmt: skip


def list_of_pages() -> str:
    """All findings by their hundred, with name, severity and the property that they decide."""
    lines = ["# The findings of gproof", ""]
    lines += ["Each finding has a page: what it means, why it matters, what to do, a bad and a good program."]
    lines += ["`gproof explain GP301` shows the same page on a terminal. In a program, `expect: GP301` marks the line"]
    lines += ["that gives the finding, and `allow: GP304` a line that may give another one."]
    hundred = 0
    for number, code in sorted(CODES.items()):
        if number // 100 != hundred:
            hundred = number // 100
            lines += ["", f"## GP{hundred}xx: {HUNDREDS[hundred]}", "", "| code | name | severity | property |"]
            lines += ["|---|---|---|---|"]
        lines += [f"| [{code.label}]({code.label}.md) | {code.name} | {code.severity.value} | {code.decides} |"]
    lines += ["", "## Retired", ""]
    lines += [f"- GP{number} {name}: {instead}" for number, (name, instead) in sorted(RETIRED.items())]
    return "\n".join(lines) + "\n"


@each("folder", FOLDERS, ids=lambda folder: folder.name)
def test_a_page_says_what_its_programs_run_with(folder: Path) -> None:
    """Of each controller its heading and what its programs give; below all the files that they take."""
    _, _, told = text_of(folder).partition("\n## Programs\n")
    programs, _, files = told.partition("\n## Files\n")
    sections = re.split(r"^### ", programs, flags=re.MULTILINE)
    for dialect in dialects(folder):
        section = next((one for one in sections if one.startswith(f"{NAMES[dialect]}\n")), "")
        assert section, f"### {NAMES[dialect]}"
        flat = " ".join(section.split())
        for sentence in sentences(folder, dialect):
            assert sentence in flat
        for block in differences(folder, dialect):
            assert block in section
        for side in ("bad", "good"):
            name = settings(folder, dialect, side)["program"]
            assert re.search(rf"^`{{3,}}gcode {re.escape(name)}\b", section, re.MULTILINE), name
    if dialects(folder):
        assert "\n".join(table(folder)) in files
    macros = (DOCS / "wincnc" / "CNC.MAC").read_bytes()
    for name in re.findall(r"^`{3,}gcode (\S+)", files, re.MULTILINE):
        assert (folder / name).read_bytes() == macros, f"{name} is a part of the programs: above"


def test_what_a_reason_names_tells_of_that_controller() -> None:
    """A code that a reason calls the one of the like has a pair of programs for the controller itself."""
    filled = {(folder.name, dialect) for folder, dialect in EXAMPLES}
    for folder in FOLDERS:
        for dialect, because in reasons(text_of(folder)).items():
            for named in re.findall(r"GP\d{3}", because):
                assert (named, dialect) in filled, f"{folder.name} {dialect}: {because}"


def test_a_pair_is_whole() -> None:
    for folder, dialect in EXAMPLES:
        for side in ("bad", "good"):
            assert (folder / settings(folder, dialect, side)["program"]).is_file(), f"{folder.name} {dialect} {side}"


@pytest.mark.parametrize(("folder", "dialect"), share(EXAMPLES, 3), ids=cell_name)
def test_bad_program_gives_its_code(folder: Path, dialect: str, gproof: Runner) -> None:
    program, result = gproof(folder, dialect, "bad")
    code = folder.name
    if result.found:
        assert code in {one.code for one in result.found}, result.output
    else:
        # Also the path of the program names the code.
        assert re.search(rf"(?<!/){code}\b", result.output), result.output
    if code in markers(program).codes:
        assert misplaced(result.found, program) == [], result.output
    assert not result.strange, "\n".join(result.strange)


@pytest.mark.parametrize(("folder", "dialect"), share(EXAMPLES, 3), ids=cell_name)
def test_good_program_gives_no_error(folder: Path, dialect: str, gproof: Runner) -> None:
    _, result = gproof(folder, dialect, "good")
    assert [one for one in result.found if one.severity in JUDGED or one.code == folder.name] == []
    assert result.exit == 0, result.output
    assert not result.strange, "\n".join(result.strange)
