"""The examples in docs/codes: each bad program gives its code on the marked line, each good one no error.

A folder has a pair for each controller whose jobs the code can be told of: `bad.cnc` and `good.cnc` for Eding CNC,
`.tap` for WinCNC, `.src` for McuWIN; `cells.toml` beside this test says for which controllers there is none, and why.
They run on the shared machine and setup of docs/codes, docs/codes/wincnc or docs/codes/mcuwin, or on the folder's own
(`WINCNC.INI`, `setup.toml` for WinCNC, `machine.toml` for McuWIN where it has no other pair).

`run.toml` in a folder says what is special about it: `setup` ("zero", "none" or a file), `machine` (a file), `program`
(one program for both runs; the machine or setup differs), `command` ("check" or "compile"), `options` (further
arguments); `[bad]` and `[good]` override single keys. That holds for the folder's first pair in the order above, or
the one that `dialect` names; tables `[eding]`, `[wincnc]`, `[mcuwin]`, with the same keys, for the others.
"""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from pathlib import Path

import pytest
from corpus.expectations import (
    JUDGED,
    ROOT,
    Found,
    findings,
    markers,
    misplaced,
    report_of,
    shown,
    strange,
    strange_texts,
)
from support.campaigns import share

from gproof.ir.codes import CODES

DOCS = ROOT / "docs" / "codes"
FOLDERS = sorted(DOCS.glob("GP*"))
DEFAULTS = {"setup": "../setup.toml", "machine": "../machine.toml", "command": "check", "options": []}


SUFFIX = {"eding": "cnc", "wincnc": "tap", "mcuwin": "src"}
CELLS = tomllib.loads((Path(__file__).parent / "cells.toml").read_text(encoding="utf-8"))


def special(folder: Path) -> dict:
    """What `run.toml` says."""
    path = folder / "run.toml"
    return tomllib.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}


def first_dialect(folder: Path) -> str | None:
    """The controller of the folder's first pair, which the keys of `run.toml` are for."""
    told = special(folder)
    found = [dialect for dialect, suffix in SUFFIX.items() if (folder / f"bad.{suffix}").is_file()]
    return told.get("dialect", found[0] if found else "eding" if told else None)


def dialects(folder: Path) -> list[str]:
    """The controllers of which a folder has a pair."""
    told, first = special(folder), first_dialect(folder)
    return [d for d, suffix in SUFFIX.items() if (folder / f"bad.{suffix}").is_file() or d == first or d in told]


def defaults(folder: Path, dialect: str) -> dict:
    """What a run of a folder's programs takes where `run.toml` says nothing."""
    if dialect == "eding":
        return {**DEFAULTS, "options": []}
    alone = first_dialect(folder) == dialect
    shared = {"machine": f"../{dialect}/{'WINCNC.INI' if dialect == 'wincnc' else 'machine.toml'}"}
    shared["setup"] = f"../{dialect}/setup.toml"
    own = {"machine": "WINCNC.INI", "setup": "setup.toml"} if dialect == "wincnc" else {"machine": "machine.toml"}
    own = {key: name for key, name in own.items() if alone and (folder / name).is_file()}
    return {**DEFAULTS, **shared, **own, "options": []}


def settings(folder: Path, dialect: str, side: str) -> dict:
    """What a run of one program of a folder takes."""
    told = special(folder)
    if dialect != first_dialect(folder):
        told = told.get(dialect, {})
    plain = {key: value for key, value in told.items() if not isinstance(value, dict) and key != "dialect"}
    out = {**defaults(folder, dialect), "program": f"{side}.{SUFFIX[dialect]}", **plain, **told.get(side, {})}
    if dialect != "eding" and "--dialect" not in out["options"]:
        out["options"] = [*out["options"], "--dialect", dialect]
    return out


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


EXAMPLES = [(folder, dialect) for folder in FOLDERS for dialect in dialects(folder)]


def cell_name(value: Path | str) -> str:
    return value.name if isinstance(value, Path) else value


def test_every_code_has_a_folder_and_every_folder_a_code() -> None:
    assert {folder.name for folder in FOLDERS} == {f"GP{number}" for number in CODES}


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_explanation_starts_with_number_and_name(folder: Path) -> None:
    text = (folder / "explanation.md").read_text(encoding="utf-8")
    number = int(folder.name[2:])
    assert text.splitlines()[0] == f"# {folder.name} {CODES[number].name}"
    assert "**Why it matters.**" in text
    assert "**What to do.**" in text


def declared() -> dict[tuple[str, str], str]:
    """Cells of `cells.toml`, each with the reason."""
    out: dict[tuple[str, str], str] = {}
    for row in CELLS["none"]:
        assert set(row) == {"dialects", "codes", "because"}, row
        assert row["because"].strip()
        for dialect in row["dialects"]:
            for code in row["codes"]:
                assert (code, dialect) not in out, f"{code} {dialect} is declared twice"
                out[code, dialect] = row["because"]
    return out


def test_every_code_has_a_pair_for_each_controller_or_a_reason_why_not() -> None:
    """Codes of jobs, which are those below 800; the others are of streams, packages and runs."""
    assert set(CELLS) == {"none"}, "no cell stays open: a program, or a reason why there can be none"
    told = declared()
    cells = {(f"GP{number}", dialect) for number in CODES if number < 800 for dialect in SUFFIX}
    filled = {(folder.name, dialect) for folder, dialect in EXAMPLES}
    assert sorted(cells - filled - set(told)) == [], "a program, or a line in cells.toml"
    assert sorted(set(told) & filled) == [], "in cells.toml, and there is a program"
    assert sorted(set(told) - cells) == [], "in cells.toml, and no such code or controller"


def test_what_a_reason_names_tells_of_that_controller() -> None:
    """A code that a reason calls the one of the like has a pair of programs for the controller itself."""
    filled = {(folder.name, dialect) for folder, dialect in EXAMPLES}
    for (code, dialect), because in declared().items():
        for named in re.findall(r"GP\d{3}", because):
            assert (named, dialect) in filled, f"{code} {dialect}: {because}"


def test_a_pair_is_whole() -> None:
    for folder, dialect in EXAMPLES:
        for side in ("bad", "good"):
            assert (folder / settings(folder, dialect, side)["program"]).is_file(), f"{folder.name} {dialect} {side}"


@pytest.mark.parametrize(("folder", "dialect"), share(EXAMPLES, 2), ids=cell_name)
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


@pytest.mark.parametrize(("folder", "dialect"), share(EXAMPLES, 2), ids=cell_name)
def test_good_program_gives_no_error(folder: Path, dialect: str, gproof: Runner) -> None:
    _, result = gproof(folder, dialect, "good")
    assert [one for one in result.found if one.severity in JUDGED or one.code == folder.name] == []
    assert result.exit == 0, result.output
    assert not result.strange, "\n".join(result.strange)
