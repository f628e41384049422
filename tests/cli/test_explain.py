"""`gproof explain`: the page of a finding fits a terminal, shows its programs, and says where their files are."""

from __future__ import annotations

import io
import re
import sys
from pathlib import Path

import pytest
from rich.cells import cell_len
from support.bundles import files_of
from support.each import each

from gproof.cli.main import main
from gproof.ir.codes import CODES
from gproof.report.finding_page import FILES, within

PAGES = Path(__file__).resolve().parents[2] / "docs" / "codes"
ESCAPE = re.compile(r"\x1b\[[0-9;]*m")


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> object:
    """What a command prints on a terminal of some columns."""
    monkeypatch.setenv("TERM", "xterm-256color")
    for name in ("NO_COLOR", "FORCE_COLOR", "CI"):
        monkeypatch.delenv(name, raising=False)

    def run(*words: str, columns: int = 100) -> str:
        terminal = Terminal()
        with monkeypatch.context() as patch:
            patch.setenv("COLUMNS", str(columns))
            patch.setattr(sys, "stdout", terminal)
            assert main(list(words)) == 0
        return terminal.getvalue()

    return run


def words_of(text: str) -> list[str]:
    """The words of a page, whatever marks them and wherever lines end."""
    return re.findall(r"\w+", text.replace("...", ""))


@each("number", CODES)
def test_every_page_fits_100_columns(number: int, shown, capsys: pytest.CaptureFixture[str]) -> None:  # type: ignore[no-untyped-def]
    page = (PAGES / f"GP{number}.md").read_text("utf-8")
    explanation, _, files = page.partition(FILES)
    assert main(["explain", f"GP{number}"]) == 0
    plain = capsys.readouterr().out
    rendered = shown("explain", f"GP{number}", columns=140)
    for text in (plain, ESCAPE.sub("", rendered)):
        assert [line for line in text.splitlines() if cell_len(line) > 100] == []
        assert f"GP{number} {CODES[number].name}" in text.splitlines()[0]
        assert ("--files" in text.splitlines()[-3]) == bool(files)
    # Nothing is lost: long words of programs are divided, so only their letters count.
    assert "".join(words_of(plain)).startswith("".join(words_of(explanation)))


@each("number", list(CODES)[::9])
def test_a_page_fits_a_narrow_terminal(number: int, shown) -> None:  # type: ignore[no-untyped-def]
    lines = ESCAPE.sub("", shown("explain", str(number), "--files", columns=60)).splitlines()
    assert [line for line in lines if cell_len(line) > 60] == []


def test_a_terminal_shows_programs_in_colours_and_no_marks(shown, monkeypatch: pytest.MonkeyPatch) -> None:  # type: ignore[no-untyped-def]
    text = shown("explain", "soft-limit")
    assert "\x1b[1;31mG3 X480 Y180" in text
    plain = ESCAPE.sub("", text)
    assert "    G3 X480 Y180 I0 J40            ; expect: GP301" in plain
    assert not re.search(r"```|\*\*|^#", plain, re.MULTILINE)
    monkeypatch.setenv("NO_COLOR", "1")
    assert not re.search(r"\x1b\[[0-9;]*[39][0-7]m", shown("explain", "soft-limit"))


@pytest.mark.parametrize("code", ["GP603", "GP436", "GP801"])
def test_files_prints_the_page_as_it_is(code: str, capsys: pytest.CaptureFixture[str]) -> None:
    """And then the files that it shares with others, so that somebody with a wheel can run the programs."""
    assert main(["explain", code, "--files"]) == 0
    printed = capsys.readouterr().out
    page = (PAGES / f"{code}.md").read_text("utf-8")
    assert printed.startswith(page)
    assert files_of(page).items() <= files_of(printed).items()
    for name in re.findall(r"\]\(((?:\w+/)?\w+\.(?:toml|INI))\)", page):
        assert files_of(printed)[f"../{name}"] == (PAGES / name).read_bytes()


def test_lines_of_a_page_are_made_anew() -> None:
    page = "# A long title stays\n\none two\nthree four\n\n- a b c d e f\n  g\n- h\n\n"
    page += "```gcode a\n123456789012345\n```\n| a | b |"
    assert within(page, 10).split("\n") == [
        "# A long title stays", "", "one two", "three four", "", "- a b c d", "  e f g", "- h", "", "```gcode a",
        "1234567890", "...12345", "```", "| a | b |",
    ]  # fmt: skip
