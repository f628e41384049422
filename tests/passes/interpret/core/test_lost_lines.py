"""After a refused line plain lines run in the kernels too: the rows, state and findings of lines one by one in Python.

Random programs of each language, with lines that are refused or not understood and codes that state groups again.
"""

from __future__ import annotations

import math
import random
from pathlib import Path
from typing import Any

import pytest
from support.campaigns import seeds

from gproof.driver.running import begin, collect
from gproof.driver.session import Running, open_session
from gproof.ir.text import print_ir
from gproof.passes.interpret.core import lost_lines
from gproof.passes.interpret.core.block_tables import BlockTables
from gproof.passes.interpret.core.modal_state import Modal

from .test_lost_state import EDING, LANGUAGES, MACHINE, MCUWIN, SETUP, WINCNC, Language, run

CONSTANT = ("rules", "setup", "machine", "ranges")
OF_MOVES = ("feed", "feed_unit", "motion")
"""Set before each move of such languages from what their lines keep."""
BAD = {
    "eding": ("G777", "G1 X1 QQ", "X5 X5", "G91 X5 X5", "G20 X1 X1", "G0 X3 X3", "G93 F1 F2", "F5 F6", "G2 X1 X2 I3",
              "G18 G18", "M48 M48", "G43 Z1 Z1", "G1 #<made_up> X3"),
    "wincnc": ("G777", "G1 (so) X3", "X5 X5", "G91 G1 X5 X5", "G20 X1", "G0 X3 X3", "G93 X1 X2", "F5 F6", "G2 X1 X2",
               "G92 X1 X1", "L11 X1 X2", "S1 S2"),
    "mcuwin": ("G777", "G1 ? X3", "X5 X5", "G91 X5 X5", "G70 X1 X1", "G0 X3 X3", "G95 F1 F2", "F5 F6", "G2 X1 X2 I3",
               "G17 G17", "G41 X1 X1", "G1 X.zerooffset := 3"),
}  # fmt: skip
AGAIN = {
    "eding": ("G21", "G90", "G91", "G17", "G94", "G54", "M27", "M90", "G92.1", "G40", "G49", "G69 G50", "G0 X1 Y1 Z1",
              "G53 G0 Z5", "M48", "M3 S100", "G80", "G98", "G93", "G64 P0.1"),
    "wincnc": ("G22", "G90", "G91", "G54", "G92", "G40", "G49", "G50", "G80", "L11", "L12", "L13", "L301", "L22.1",
               "L23.1", "L31", "L33", "L37", "G0 X1 Y1 Z1", "G53 Z5", "G94", "S100", "G93"),
    "mcuwin": ("G71", "G90", "G91", "G17", "G94", "G53", "G40", "G24", "G150", "G60 X Y Z", "G0 X1 Y1 Z1", "M3"),
}  # fmt: skip


def plain(rng: random.Random, name: str) -> str:
    """A line that the kernels may take, most often."""
    if rng.random() < 0.06:
        return f"F{rng.choice([100, 250.5, 0, 900])}"
    letters = [letter for letter in "XYZ" if rng.random() < 0.5] or ["Y"]
    if rng.random() < 0.03:
        letters.append(rng.choice([*letters, "A", "U"]))
    words = [f"{letter}{rng.choice([rng.uniform(-20, 20), 0.0, 1.0]):.3f}" for letter in letters]
    kind = rng.random()
    if kind < 0.12:
        words += [f"I{rng.uniform(-9, 9):.2f}", f"J{rng.uniform(-9, 9):.2f}"]
        words.insert(0, rng.choice(["G2", "G3", ""]))
    elif kind < 0.16 and name != "mcuwin":
        words = [rng.choice(["G2", "G3"]), *words, f"R{rng.uniform(9, 60):.2f}"]
    elif kind < 0.5:
        words.insert(0, rng.choice(["G0", "G1", "G1"]))
    if rng.random() < 0.2:
        words.insert(rng.choice([0, len(words)]), f"F{rng.choice([100, 77.7, 1200])}")
    return " ".join(word for word in words if word)


def program(rng: random.Random, language: Language) -> list[str]:
    lines: list[str] = [*language.before, "G1 X2 Y1 F100"]
    for _ in range(rng.randint(1, 4)):
        lines += [plain(rng, language.name) for _ in range(rng.randint(0, 8))]
        lines.append(rng.choice(BAD[language.name]))
        for _ in range(rng.randint(0, 4)):
            lines += [plain(rng, language.name) for _ in range(rng.randint(0, 10))]
            how = rng.random()
            if how < 0.3:
                lines += rng.sample(AGAIN[language.name], rng.randint(1, 6))
            elif how < 0.6:
                header = list(language.again)
                if rng.random() < 0.5:
                    header.pop(rng.randrange(len(header)))
                lines += [*header, *rng.choice([[], ["G94"], ["F300"], ["G94", "F300"], ["G94", "G1 X3 F90"]])]
        lines += [plain(rng, language.name) for _ in range(rng.randint(0, 10))]
    return [*lines, *language.after]


DIN = """[din]
case_sensitive = false
line_numbers = false
position_unit = "mm"
time_unit = "min"
absolute_centers = false
interpolation_axes = "XYZ"
arc_tolerance = 1000
"""
"""Of arcs that miss their circle the kernel makes rows with the error, Python none."""


def told(folder: Path, language: Language, lines: list[str]) -> list[str]:
    """Rows, final state and findings of a job."""
    job = folder / f"job.{language.extension}"
    job.write_text("\n".join(lines) + "\n")
    (folder / "m.toml").write_text(MACHINE + (DIN if language is MCUWIN else ""))
    (folder / "CNC.MAC").write_text("")
    (folder / "s.toml").write_text(SETUP)
    session = open_session(job, machine=folder / "m.toml", setup=str(folder / "s.toml"), dialect=language.name)
    assert session.program is not None
    options = session.options(Running(30_000, 64, False, None))
    ex = begin(session.program, session.setup, session.machine, session.findings, **options)
    trace = collect(ex)
    trace.verify()
    rows = [section.rows[name].tobytes().hex() for section in trace.sections for name in section.rows.arrays]
    hidden = (*CONSTANT, *(OF_MOVES if language is MCUWIN else ()))
    modal = [
        f"{name}: {sorted(value) if isinstance(value, frozenset) else value!r}"
        for name, value in sorted(vars(ex.modal).items())
        if name not in hidden
    ]
    found = sorted(f"{finding.span} {finding}" for finding in session.findings.kept)
    return [*rows, print_ir(trace), *modal, repr((list(ex.assumed), ex.refused)), *found]


def slow(folder: Path, language: Language, lines: list[str]) -> list[str]:
    """The same with every line behind a refused one in Python."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("GPROOF_KERNELS", "python")
        patch.setattr(lost_lines, "are_vague", lambda s: False)
        patch.setattr(Modal, "modes_known", property(lambda s: not s.line_lost))
        return told(folder, language, lines)


@pytest.mark.parametrize("mode", ["python", "numba"])
@pytest.mark.parametrize("language", LANGUAGES, ids=lambda each: each.name)
@pytest.mark.parametrize("seed", seeds(4, 1000))
def test_fast_and_slow_agree(seed: int, language: Language, mode: str, tmp_path: Path) -> None:
    lines = program(random.Random(f"{language.name} {seed}"), language)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("GPROOF_KERNELS", mode)
        fast = told(tmp_path, language, lines)
    expected = slow(tmp_path, language, lines)
    different = [pair for pair in zip(fast, expected, strict=True) if pair[0] != pair[1]]
    assert not different, f"seed {seed}, {language.name}:\n" + "\n".join(lines)


@pytest.mark.parametrize("language", [WINCNC, MCUWIN], ids=lambda each: each.name)
def test_no_stale_feed_where_the_place_is_lost(language: Language, tmp_path: Path) -> None:
    """Which axes such a line moves nobody knows: the feed of the move before is not that of its row."""
    _, chunks, _ = run(tmp_path, language, ["F100", "G1 X2 Y1", "G91 X5 X5", "G1 X3 F900"])
    at = len(language.before) + 4
    feeds = [
        float(feed)
        for chunk in chunks
        for line, feed in zip(chunk.rows["line"], chunk.rows["feed"], strict=True)
        if line == at
    ]
    assert len(feeds) == 1
    assert math.isnan(feeds[0])


HEADERS = {
    "eding": [*EDING.again, "F300"], "wincnc": [*WINCNC.again, "F300"], "mcuwin": [*MCUWIN.again, "F300"],
}  # fmt: skip
MOVES = [f"X{n % 50} Y{n % 7}.5" for n in range(2000)]


@pytest.mark.parametrize("language", LANGUAGES, ids=lambda each: each.name)
@pytest.mark.parametrize("way", ["restated", "lost", "middle"])
def test_long_jobs_stay_in_the_kernels(
    language: Language, way: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:  # fmt: skip
    """Few of the lines are left to Python, whether or not all is stated again."""
    start = ["F100", "G1 X1 Y1 Z1"]
    lines = {
        "restated": ["G777", *HEADERS[language.name], "G1 X1 Y1", *MOVES],
        "lost": [*start, "G777", "G1 X1 Y1", *MOVES],
        "middle": [*start, *MOVES[:1000], "G777", *MOVES[1000:]],
    }[way]
    cold = []
    one = BlockTables._cold

    def counted(self: BlockTables, *args: Any) -> None:
        cold.append(args[2])
        one(self, *args)

    monkeypatch.setattr(BlockTables, "_cold", counted)
    told(tmp_path, language, [*language.before, *lines, *language.after])
    assert len(cold) < 60, cold[:100]
