"""What people see: the text of reports and explanations, word for word, and colours only where they belong.

The golden files in tests/cli/goldens/ are rewritten by `make goldens`; read the diff.
"""

from __future__ import annotations

import os
import pty
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from corpus.expectations import around
from support.bundles import unpacked
from support.goldens import ROOT

from gproof.cli.main import main

GOLDENS = Path(__file__).parent / "goldens.md"
Golden = Callable[[Path, str], None]
ESCAPE = re.compile(r"\x1b\[[0-9;]*m")

JOBS = [
    "drilled-plate", "unknown-offsets", "over-limit-cycle-retract", "magazine-by-hand", "language-errors",
    "unknown-parameter", "rotary-engraving", "inch-bracket", "pitch-table-on",
]  # fmt: skip
UNPACKED = unpacked("docs/codes").parents[1]
"""Where docs/codes/GP301/bad.cnc is."""

EXAMPLES = ["GP110", "GP301", "GP303", "GP310", "GP401"]
EXPLAINED = ["GP301", "GP401", "soft-limit"]


def job_words(name: str) -> list[str]:
    job = ROOT / "corpus" / "eding" / name / "job.cnc"
    return [word.removeprefix(f"{ROOT}/") for word in (str(job), *around(job))]


def example_words(code: str) -> list[str]:
    folder = Path("docs/codes") / code
    special = UNPACKED / folder / "run.toml"
    settings = tomllib.loads(special.read_text(encoding="utf-8")) if special.is_file() else {}
    settings |= settings.get("bad", {})
    words = [str(folder / "bad.cnc"), "--machine", str(folder / settings.get("machine", "../machine.toml"))]
    setup = settings.get("setup", "../setup.toml")
    return words + (["--setup", setup if setup == "zero" else str(folder / setup)] if setup != "none" else [])


@pytest.fixture
def printed(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Callable[[list[str]], str]:
    """The command, its output and its exit code, run at the top of the repository."""
    monkeypatch.chdir(ROOT)

    def run(words: list[str]) -> str:
        code = main(words)
        captured = capsys.readouterr()
        return f"$ gproof {' '.join(words)}\n{captured.out}{captured.err}exit {code}\n"

    return run


@pytest.mark.parametrize("name", JOBS)
def test_report_of_a_job(name: str, printed: Callable[[list[str]], str], golden: Golden) -> None:
    golden(GOLDENS / f"check-{name}.txt", printed(["check", *job_words(name)]))


@pytest.mark.parametrize("code", EXAMPLES)
def test_report_of_an_example(
    code: str, printed: Callable[[list[str]], str], golden: Golden, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(UNPACKED)
    golden(GOLDENS / f"check-{code}.txt", printed(["check", *example_words(code)]))


@pytest.mark.parametrize("asked", EXPLAINED)
def test_explanation(asked: str, printed: Callable[[list[str]], str], golden: Golden) -> None:
    golden(GOLDENS / f"explain-{asked}.txt", printed(["explain", asked]))


def test_mistyped_code_gets_a_hint(printed: Callable[[list[str]], str], golden: Golden) -> None:
    golden(GOLDENS / "explain-mistyped.txt", printed(["explain", "soft-limt"]))


@pytest.mark.parametrize("name", JOBS)
def test_report_is_tidy(name: str, printed: Callable[[list[str]], str]) -> None:
    lines = printed(["check", *job_words(name)]).splitlines()
    assert [line for line in lines if line != line.rstrip()] == []
    findings = [line for line in lines if re.search(r": (error|unknown|warning|note) GP\d{3} ", line)]
    assert len(findings) == len(set(findings)), "a finding is repeated"
    assert [line for line in lines if re.search(r"\bnan\b|\binf\b|-0\.000\b", line)] == []
    summary = lines[lines.index(next(line for line in lines if line.startswith("  language"))) : -1]
    assert all(re.match(r"  (\S.{0,9})? {2,}\S", line) for line in summary), summary


# Colours


def check(environment: dict[str, str], *, terminal: bool, words: list[str] | None = None) -> str:
    """Standard output of a check in a fresh process, on a pseudo-terminal or not; not errors, where progress is."""
    command = [sys.executable, "-m", "gproof.cli.main", "check", *(words or job_words("over-limit-line"))]
    inherited = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "FORCE_COLOR", "TERM")}
    settings = {"cwd": ROOT, "env": inherited | {"TERM": "xterm-256color"} | environment, "stdin": subprocess.DEVNULL}
    if not terminal:
        return subprocess.run(command, capture_output=True, text=True, check=False, **settings).stdout  # type: ignore[call-overload]
    ours, theirs = pty.openpty()
    with subprocess.Popen(command, stdout=theirs, stderr=subprocess.DEVNULL, **settings) as running:  # type: ignore[call-overload]
        os.close(theirs)
        out = b""
        while True:
            try:
                part = os.read(ours, 65536)
            except OSError:  # how Linux says that the other side is closed
                break
            if not part:
                break
            out += part
        running.wait()
    os.close(ours)
    return out.decode("utf-8").replace("\r\n", "\n")


def test_a_file_or_pipe_gets_no_escape_codes() -> None:
    assert "\x1b" not in check({}, terminal=False)


def test_a_terminal_gets_colours_and_the_same_words() -> None:
    shown = check({}, terminal=True)
    assert "\x1b[31m\x1b[1merror\x1b[0m GP301" in shown
    assert "\x1b[31m\x1b[1mUNSAFE" in shown
    assert "\x1b[32m\x1b[1mSAFE" in shown
    assert ESCAPE.sub("", shown) == check({}, terminal=False)


def test_no_color_is_honoured() -> None:
    shown = check({"NO_COLOR": "1"}, terminal=True)
    assert "\x1b" not in shown
    assert shown == check({}, terminal=False)


def test_an_empty_no_color_says_nothing() -> None:
    assert "\x1b[" in check({"NO_COLOR": ""}, terminal=True)


def test_json_is_never_coloured() -> None:
    assert "\x1b" not in check({}, terminal=True, words=[*job_words("over-limit-line"), "--format", "json"])
