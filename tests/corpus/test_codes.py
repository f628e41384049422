"""The examples in docs/codes: each bad program gives its code on the marked line, each good one no error.

`run.toml` in a folder says what is special about it: `setup` ("zero", "none" or a file), `machine` (a file),
`program` (one program for both runs; the machine or setup differs), `command` ("check" or "compile"),
`options` (further arguments); `[bad]` and `[good]` override single keys. Without it the shared `machine.toml` and
`setup.toml` of docs/codes are used. Programs of WinCNC are `bad.tap` and `good.tap`; they run on the folder's own
`WINCNC.INI` and `setup.toml`, where it has them, else on those of docs/codes/wincnc. Programs of McuWIN are `bad.src`
and `good.src`, on the folder's own `machine.toml` or that of docs/codes/mcuwin.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

import pytest
from corpus.expectations import JUDGED, ROOT, Found, findings, markers, misplaced, report_of, shown

from gproof.ir.codes import CODES

DOCS = ROOT / "docs" / "codes"
FOLDERS = sorted(DOCS.glob("GP*"))
DEFAULTS = {"setup": "../setup.toml", "machine": "../machine.toml", "command": "check", "options": []}


def defaults(folder: Path) -> dict:
    """What a run of a folder's programs takes where `run.toml` says nothing."""
    if (folder / "bad.src").is_file():
        own = "machine.toml" if (folder / "machine.toml").is_file() else "../mcuwin/machine.toml"
        return {**DEFAULTS, "machine": own, "setup": "../mcuwin/setup.toml", "options": ["--dialect", "mcuwin"]}
    if not (folder / "bad.tap").is_file():
        return DEFAULTS
    own = {key: name for key, name in (("machine", "WINCNC.INI"), ("setup", "setup.toml")) if (folder / name).is_file()}
    shared = {"machine": "../wincnc/WINCNC.INI", "setup": "../wincnc/setup.toml"}
    return {**DEFAULTS, **shared, **own, "options": ["--dialect", "wincnc"]}


@dataclass(frozen=True)
class Result:
    """What one run of the command line left behind."""

    exit: int
    output: str
    found: list[Found]


class Runner:
    """Runs gproof inside this process, so that two hundred runs take seconds."""

    def __init__(self, capsys: pytest.CaptureFixture[str], scratch: Path):
        self.capsys, self.scratch = capsys, scratch

    def __call__(self, folder: Path, side: str) -> tuple[Path, Result]:
        path = folder / "run.toml"
        special = tomllib.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
        other = {"bad", "good"}
        settings = {**defaults(folder), **{k: v for k, v in special.items() if k not in other}, **special.get(side, {})}
        suffix = next((one for one in ("tap", "src") if (folder / f"bad.{one}").is_file()), "cnc")
        program = folder / settings.get("program", f"{side}.{suffix}")
        words = [settings["command"], str(program), "--machine", str(folder / settings["machine"])]
        if settings["setup"] != "none":
            setup = settings["setup"]
            words += ["--setup", setup if setup == "zero" else str(folder / setup)]
        if settings["command"] == "check":
            words += ["--format", "json"]
        else:
            words += ["-o", str(self.scratch / f"{side}.gpx")]
        return program, self.run([*words, *settings["options"]], as_json=settings["command"] == "check")

    def run(self, words: list[str], *, as_json: bool) -> Result:
        from gproof.cli.main import main

        exit_code = main(words)
        captured = self.capsys.readouterr()
        output = captured.out + captured.err
        if as_json and captured.out.lstrip().startswith("{"):
            return Result(exit_code, output, findings(report_of(captured.out)))
        return Result(exit_code, output, shown(output))


@pytest.fixture
def gproof(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Runner:
    return Runner(capsys, tmp_path)


def has_example(folder: Path) -> bool:
    return any((folder / name).is_file() for name in ("bad.cnc", "bad.tap", "bad.src", "run.toml"))


EXAMPLES = [folder for folder in FOLDERS if has_example(folder)]


def test_every_code_has_a_folder_and_every_folder_a_code() -> None:
    assert {folder.name for folder in FOLDERS} == {f"GP{number}" for number in CODES}


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_explanation_starts_with_number_and_name(folder: Path) -> None:
    text = (folder / "explanation.md").read_text(encoding="utf-8")
    number = int(folder.name[2:])
    assert text.splitlines()[0] == f"# {folder.name} {CODES[number].name}"
    assert "**Why it matters.**" in text
    assert "**What to do.**" in text


def test_only_codes_that_no_program_can_show_lack_an_example() -> None:
    without = {folder.name for folder in FOLDERS} - {folder.name for folder in EXAMPLES}
    assert {name for name in without if name < "GP800"} == {"GP701", "GP702"}


@pytest.mark.parametrize("folder", EXAMPLES, ids=lambda folder: folder.name)
def test_bad_program_gives_its_code(folder: Path, gproof: Runner) -> None:
    program, result = gproof(folder, "bad")
    code = folder.name
    if result.found:
        assert code in {one.code for one in result.found}, result.output
    else:
        assert code in result.output, result.output
    if code in markers(program).codes:
        assert misplaced(result.found, program) == [], result.output


@pytest.mark.parametrize("folder", EXAMPLES, ids=lambda folder: folder.name)
def test_good_program_gives_no_error(folder: Path, gproof: Runner) -> None:
    _, result = gproof(folder, "good")
    assert [one for one in result.found if one.severity in JUDGED or one.code == folder.name] == []
    assert result.exit == 0, result.output
