"""What the pages show is what the command prints: every ```console block is run, in order, in a copy of the corpus.

Those of the README and of a page for CI are all run by a shell.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from support.console import Shell, matches, renewed, steps
from support.goldens import ROOT, rewrite

PAGES = [path for path in [ROOT / "README.md", *sorted((ROOT / "docs").glob("**/*.md"))] if "codes" not in path.parts]
SHOWING = [path for path in PAGES if "```console" in path.read_text(encoding="utf-8")]


@pytest.mark.parametrize("page", SHOWING, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_page_shows_what_is_printed(page: Path, tmp_path: Path, refresh_goldens: bool) -> None:
    shutil.copytree(ROOT / "corpus", tmp_path / "corpus")
    text = page.read_text(encoding="utf-8")
    lines = text.split("\n")
    shell = Shell(tmp_path, here=page.name not in ("README.md", "ci.md"))
    shown = [(step, shell.run(step.command)) for step in steps(text)]
    assert shown
    wrong = [(step, actual) for step, actual in shown if not matches(step.expected, actual)]
    if wrong and refresh_goldens:
        for step, actual in reversed(wrong):
            lines[step.first : step.stop] = renewed(step.expected, actual)
        rewrite(page, "\n".join(lines))
        return
    for step, actual in wrong:
        where = f"{page.name}:{step.first}: $ {step.command}"
        assert actual == step.expected, f"{where} prints something else (make goldens rewrites it)"


def test_console_blocks_are_read_with_continued_commands() -> None:
    page = "text\n```console\n$ echo a \\\n    b\na b\n$ true\n```\n```sh\n$ not this\n```\n"
    assert [(s.command, s.expected) for s in steps(page)] == [("echo a b", ["a b"]), ("true", [])]


def test_a_block_to_save_is_a_file(tmp_path: Path) -> None:
    page = "Save it as `a.toml`:\n\n```toml\nx = '$A'\n\n```\nNot this:\n```\ny\n```\n```console\n$ cat a.toml\n```\n"
    shell = Shell(tmp_path)
    assert [shell.run(step.command) for step in steps(page)] == [[], ["x = '$A'", ""]]


def test_shell_remembers_folder_and_exit_code(tmp_path: Path) -> None:
    shell = Shell(tmp_path)
    (tmp_path / "there").mkdir()
    printed = [shell.run(c) for c in ("cd there", "basename $PWD", "false", "echo $?", "echo a; echo b >&2")]
    assert printed == [[], ["there"], [], ["1"], ["a", "b"]]
    assert "gproof" in shell.run("gproof --version")[0]


def test_a_call_prints_what_the_command_prints(tmp_path: Path) -> None:
    (tmp_path / "job.cnc").write_text("G0 X1\nG1 X9000\nM30\n")
    printed = []
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        shell = Shell(tmp_path / name, here=name == "a")
        commands = (
            "gproof check ../job.cnc --setup zero",
            "gproof fmt --diff ../job.cnc",
            "gproof dump",
            "gproof check a",
        )
        printed.append([(shell.run(command), shell.exit_code) for command in commands])
    assert printed[0] == printed[1]


@pytest.mark.parametrize(
    ("expected", "fits"),
    [("a b c d", True), ("a ... d", True), ("... d", True), ("a ...", True), ("a ... b c d ...", True), ("a d", False),
     ("a ... c", False), ("a b c", False)],
)  # fmt: skip
def test_dots_stand_for_lines(expected: str, fits: bool) -> None:
    assert matches(expected.split(), ["a", "b", "c", "d"]) is fits


@pytest.mark.parametrize(
    ("expected", "becomes"),
    [("a x c", "a b c d e"), ("x ... x", "a ... e"), ("a ... c x ...", "a ... c d ..."),
     ("a ... b q ... e", "a ... b c ... e")],
)  # fmt: skip
def test_refreshing_keeps_the_dots(expected: str, becomes: str) -> None:
    assert renewed(expected.split(), "a b c d e".split()) == becomes.split()


def test_refreshing_never_touches_what_is_written_by_hand() -> None:
    for path in (ROOT / "corpus" / "README.md", ROOT / "docs" / "codes" / "GP301.md", ROOT / "x.toml"):
        with pytest.raises(ValueError, match="by hand"):
            rewrite(path, "")
