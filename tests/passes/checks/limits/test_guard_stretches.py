"""Stretches that a job runs with a guard off: one note each, with its lines and how far the axes go."""

from __future__ import annotations

from pathlib import Path

from passes.checks.zones.test_zones import HEAD, MACHINE, run, stated

from gproof.driver.judge import Judgement
from gproof.ir.verdict import Verdict


def notes(judgement: Judgement) -> list[tuple[int, str]]:
    return [(f.span.line, f.message) for f in judgement.findings.kept if f.code.number == 338]


def test_each_stretch_has_its_lines_and_its_reach(tmp_path: Path) -> None:
    program = (
        f"{HEAD}G0 X10\nMCAGuard off\nG0 X20 Y5\nG0 X-3\nMCAGuard on\nG0 X0\nTCAGuard off\nTCAGuard on\n"
        "TCAGuard off\nMCAGuard off\nG1 Z-5\nM30\n"
    )
    judgement = run(tmp_path, program, MACHINE, stated())
    assert notes(judgement) == [
        (3, "soft limits: off from here to line 5, during 2 moves, X -3.000 ... 20.000 mm, Y 0.000 ... 5.000 mm"),
        (11, "soft limits and tool change area: off from here to line 12, during 1 move, Z -5.000 ... 0.000 mm"),
    ]
    assert judgement.verdict is Verdict.UNKNOWN or judgement.verdict is Verdict.SAFE


def test_a_stretch_that_runs_again_is_told_once(tmp_path: Path) -> None:
    again = "#1 = 0\nwhile [#1 < 40]\nTCAGuard off\nG0 X5\nG0 X6\nTCAGuard on\n#1 = [#1 + 1]\nendwhile\n"
    program = f"{HEAD}G0 X6\n{again}M30\n"
    judgement = run(tmp_path, program, MACHINE, stated())
    assert notes(judgement) == [(5, "tool change area: off from here to line 7, during 2 moves, X 5.000 ... 6.000 mm")]
    assert judgement.findings.counts[338] == 40


def test_limits_that_were_never_on_are_one_stretch(tmp_path: Path) -> None:
    """A machine whose soft limits start switched off: from the first line to the last."""
    machine = MACHINE.replace('"eding"', '"wincnc"') + "\n[controls]\nsoft_limits = false\n"
    start = 'schema = "gproof-setup/1"\nstart = {x = 0.0, y = 0.0, z = 0.0}\ng92 = {x = 0.0, y = 0.0, z = 0.0}\n'
    judgement = run(tmp_path, "G90\nG22\nG0 X10\nG0 X20 Y5\n", machine, start, "wincnc")
    assert [line for line, _ in notes(judgement)] == [2], [f.message for f in judgement.findings.kept]
