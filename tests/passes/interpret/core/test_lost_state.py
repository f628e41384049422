"""A line that is refused or not understood loses what it may have changed, for every code of every language's table.

The codes come from the tables of the dialects: a new one is in these tests by itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest
from support.campaigns import share

from gproof.driver.conclude import _all_accepted
from gproof.driver.judge import Judgement, judge
from gproof.driver.policy import Policy
from gproof.driver.session import Running, open_session
from gproof.driver.suppressions import accept_comments
from gproof.ir import modal_groups as g
from gproof.ir.dialects import rules_named
from gproof.ir.finding import Severity
from gproof.ir.rules import CodeRule
from gproof.ir.trace import UNKNOWN, Chunk
from gproof.ir.verdict import Verdict

MACHINE = """
schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = -500
max = 500
[axes.y]
min = -500
max = 500
[axes.z]
min = -500
max = 500
"""
SETUP = """
schema = "gproof-setup/1"
units = "mm"
homed = ["x", "y", "z"]
tool = 1
active_work = 1
[start]
x = 0
y = 0
z = 0
[g92]
x = 0
y = 0
z = 0
[work.1]
x = 0
y = 0
z = 0
[tools.1]
length = 0
"""


@dataclass(frozen=True)
class Language:
    """How jobs of a language are written in these tests.

    lost: a line with a code and a text of which nobody knows what it is, so that what is told is UNKNOWN; error: the
    same as an error; before, after: around the lines of a job; allow: a comment for the next line; again: states every
    modal group, and a place; far: a move of one axis to 9, with a motion code.
    """

    name: str
    extension: str
    lost: str
    error: str
    allow: str
    before: tuple[str, ...]
    again: tuple[str, ...]
    far: str
    after: tuple[str, ...]


EDING = Language(
    "eding", "cnc", "{code} #<made_up> X3", "{code} QQ X3", "; gproof: allow {codes}: looked at",
    ("G21 G90 G17 G40 G49 G54 G69 G50 G80 G94 G98 M90 M27", "G92.1", "G0 X1 Y1 Z1"),
    ("G21 G90 G17 G40 G49 G54 G69 G50 G80 G94 G98 M90", "M27", "G92.1", "G0 X1 Y1 Z1"), "G0 X9", ("M30",),
)  # fmt: skip
WINCNC = Language(
    "wincnc", "tap", "{code} (so) X3", "{code} QQ? X3", "[gproof: allow {codes}: looked at]",
    ("G22", "G90", "G54", "G92", "G40", "G49", "G50", "G80", "L11", "L12", "L13", "L20", "G0 X1 Y1 Z1"),
    ("G22", "G90", "G54", "G92", "G40", "G49", "G50", "G80", "L11", "L12", "L13", "L301", "L22.1", "L23.1", "L31",
     "L33", "L37", "G0 X1 Y1 Z1"), "G0 X9", ("[end]",),
)  # fmt: skip
MCUWIN = Language(
    "mcuwin", "src", "{code} X.zerooffset := 3", "{code} ? X3", "' gproof: allow {codes}: looked at",
    ("%A", "G71 G90 G40 G24 G150", "G53", "G60 X Y Z", "G00 X1 Y1 Z1"),
    ("G71 G90", "G40", "G24", "G150", "G17", "G53", "G60 X Y Z", "G00 X1 Y1 Z1"), "G00 X9", ("M30", "%"),
)  # fmt: skip
LANGUAGES = (EDING, WINCNC, MCUWIN)
CODES = [(each, rule) for each in LANGUAGES for rule in rules_named(each.name).codes.values()]
ENDS = {"M2", "M30", "M17", "M99", "M99.1"}
FOLLOWED = [(each, rule) for each, rule in CODES if rule.text not in ENDS]
"""Codes that lines come after."""
IN_WORDS = [(each, rule) for each, rule in CODES if not rule.has_text]
"""Codes that no text follows, which would take what is not understood."""


def name(value: Language | CodeRule) -> str:
    return value.name if isinstance(value, Language) else value.text


def run(folder: Path, language: Language, lines: list[str], allowed: str = "") -> tuple[Judgement, list[Chunk], bool]:
    """A job judged: its judgement, its chunks, and whether all that was found is accepted (exit 0)."""
    job = folder / f"job.{language.extension}"
    lines = [*language.before, *([language.allow.format(codes=allowed)] if allowed else []), *lines, *language.after]
    job.write_text("\n".join(lines) + "\n")
    (folder / "m.toml").write_text(MACHINE)
    (folder / "CNC.MAC").write_text("")
    (folder / "s.toml").write_text(SETUP)
    session = open_session(job, machine=folder / "m.toml", setup=str(folder / "s.toml"), dialect=language.name)
    chunks: list[Chunk] = []
    judgement = judge(session, running=Running(10**6), observe=chunks.append)
    if session.program is not None:
        for finding in accept_comments(session.program, judgement):
            assert finding.severity is not Severity.ERROR
    left = [finding for finding in judgement.findings.kept if finding not in judgement.accepted]
    done = judgement.verdict is Verdict.SAFE or (bool(judgement.accepted) and _all_accepted(judgement, Policy(), left))
    return judgement, chunks, done


def told(judgement: Judgement) -> str:
    return "\n".join(f"{f.span.line}: {f.severity.value} {f.code.label} {f.message}" for f in judgement.findings.kept)


def forms_of(chunks: list[Chunk], line: int) -> list[object]:
    """What X rests on at the rows of a line."""
    return [
        chunk.trace.frames[int(frame)][0]
        for chunk in chunks
        for op, frame, at in zip(chunk.rows["op"], chunk.rows["frame"], chunk.rows["line"], strict=True)
        if at == line and op < 10
    ]


def at_lines(language: Language, lines: list[str], *, allowed: bool) -> int:
    """The number of the last of the lines in the job."""
    return len(language.before) + allowed + len(lines)


@pytest.mark.parametrize(("language", "rule"), share(FOLLOWED, 4), ids=name)
def test_what_is_not_understood_loses_all(language: Language, rule: CodeRule, tmp_path: Path) -> None:
    lines = [language.lost.format(code=rule.text), language.far]
    judgement, chunks, done = run(tmp_path, language, lines, "GP113, GP134, GP139, GP514")
    assert judgement.verdict is not Verdict.SAFE, told(judgement)
    assert not done, told(judgement)
    forms = forms_of(chunks, at_lines(language, lines, allowed=True))
    assert all(form == UNKNOWN for form in forms), told(judgement)


@pytest.mark.parametrize(("language", "rule"), share(IN_WORDS, 4), ids=name)
def test_nothing_is_refuted_behind_it(language: Language, rule: CodeRule, tmp_path: Path) -> None:
    """A move that the old state would send past a limit is no error behind a line that is an error itself."""
    lines = [language.error.format(code=rule.text), language.far.replace("9", "900"), "G91", language.far] * 2
    judgement, _, _ = run(tmp_path, language, lines)
    assert judgement.verdict is Verdict.UNSAFE, told(judgement)
    behind = {f.code.label for f in judgement.findings.kept if f.code.decides in ("limits", "areas", "arcs")}
    assert not behind, told(judgement)


@pytest.mark.parametrize("language", LANGUAGES, ids=lambda each: each.name)
def test_all_stated_again_is_known_again(language: Language, tmp_path: Path) -> None:
    code = "G90"
    lines = [language.lost.format(code=code), *language.again, language.far]
    judgement, chunks, done = run(tmp_path, language, lines, "GP113, GP134")
    assert done, told(judgement)
    assert forms_of(chunks, at_lines(language, lines, allowed=True)) == [()], told(judgement)


MODES = [
    (EDING, "G20", "G21"), (EDING, "G91", "G90"), (EDING, "G55", "G54"), (EDING, "G92", "G92.1"), (EDING, "G43", "G49"),
    (EDING, "G68", "G69"), (EDING, "G51", "G50"), (EDING, "G41", "G40"), (EDING, "G21", "G21"), (EDING, "G90", "G90"),
    (WINCNC, "G20", "G22"), (WINCNC, "G23", "G22"), (WINCNC, "G92", "G92"), (WINCNC, "G49", "G49"),
    (WINCNC, "G51", "G50"), (WINCNC, "G52", "G50"), (WINCNC, "G41", "G40"),
    (WINCNC, "L22", "L22.1"), (WINCNC, "L30", "L31"),
    (MCUWIN, "G70", "G71"), (MCUWIN, "G91", "G90"), (MCUWIN, "G54", "G53"), (MCUWIN, "G21", "G24"),
    (MCUWIN, "G41", "G40"), (MCUWIN, "G151", "G150"),
]  # fmt: skip
"""A code that changes what words mean, and one that states the same group again."""


@pytest.mark.parametrize(("language", "code", "again"), MODES, ids=lambda one: getattr(one, "name", one))
def test_words_that_were_read_lose_their_groups(language: Language, code: str, again: str, tmp_path: Path) -> None:
    """The line is refused for a word that it has twice; its codes were read."""
    absolute = "G0 X2 Y2 Z2"
    lines = [f"{code} X5 X5", absolute, language.far, again, absolute, language.far]
    judgement, chunks, _ = run(tmp_path, language, lines)
    first = len(language.before)
    assert set(forms_of(chunks, first + 3)) == {UNKNOWN}, told(judgement)
    assert set(forms_of(chunks, first + 6)) == {()}, told(judgement)


@pytest.mark.parametrize("language", LANGUAGES, ids=lambda each: each.name)
def test_axis_words_lose_the_place_alone(language: Language, tmp_path: Path) -> None:
    lines = ["G0 X5 X5", "G91 G0 X9", "G90 G0 X9", "G0 X900"]
    judgement, chunks, _ = run(tmp_path, language, lines)
    first = len(language.before)
    assert forms_of(chunks, first + 2) == [UNKNOWN]
    assert forms_of(chunks, first + 3) == [()]
    # What is an error whatever the line was stays one.
    assert [f.span.line for f in judgement.findings.kept if f.code.label == "GP301"] == [first + 4], told(judgement)


def test_every_function_has_its_groups() -> None:
    """Codes whose function has no row lose everything: those of which nobody knows what they run."""
    open_ones = {"CALL", "RETURN", "JUMP", "APPLICATION", "UNSUPPORTED"}
    for language in LANGUAGES:
        for rule in rules_named(language.name).codes.values():
            assert rule.function in g.CHANGES or rule.function.name in open_ones, rule
    for function, groups in g.STATES.items():
        assert set(groups) <= set(g.CHANGES[function]), function
