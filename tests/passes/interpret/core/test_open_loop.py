"""What only the controller's own spindle feedback can do becomes no step stream (GP511), in whole sections."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from passes.interpret.core.programs import HEAD, run_whole

from gproof.driver.dialects import load_machine
from gproof.ir.dialects.eding.settings import EdingSettings
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine, Spindle
from gproof.passes.motion.plan import plan
from gproof.passes.motion.step import step

ROOT = Path(__file__).parents[4]


def bench_mill() -> Machine:
    machine, _ = load_machine(ROOT / "corpus" / "eding" / "machines" / "bench-mill-centred.toml", Findings())
    assert machine is not None
    settings = EdingSettings(thread_peak="offset")
    head = Spindle(number=1, offset=(3.0, 0.0, 0.0))
    return dataclasses.replace(machine, settings=settings, spindles=(head,))


def lowered(folder: Path, text: str) -> list[str]:
    """Codes of the way to a stream; [] when there is one."""
    machine = bench_mill()
    trace, told = run_whole(folder, text, machine=machine)
    assert [f.code.label for f in told.kept if f.code.severity.name in ("ERROR", "UNKNOWN")] == []
    findings = Findings()
    planned = plan(trace, machine, findings)
    assert planned is not None  # times are nominal, and there
    stream = step(trace, planned, machine, findings)
    assert (stream is None) == bool(findings.kept)
    return [f.code.label for f in findings.kept]


@pytest.mark.parametrize(
    "line",
    [
        "G33 Z-5 K1",
        "G33.1 Z-5 K1",
        "G18 G76 P1 Z-10 I-5 J0.5 K1",
        "G84 X1 Y1 Z-5 R2 F1",
        "M0\nG84 X1 Y1 Z-5 R2 F1",
        "G87 X1 Y1 Z-5 R2 I1 J0 K-3 F50",
        "M5 M91",
    ],
)
def test_refused(tmp_path: Path, line: str) -> None:
    assert lowered(tmp_path, f"{HEAD}S300 M3\nG0 Z5\n{line}\nM5\nM30\n") == ["GP511"]


@pytest.mark.parametrize("line", ["G86 X1 Y1 Z-5 R2 P0 F50", "M90", "G95 G1 X5 F0.2", "M84"])
def test_the_others_are_not(tmp_path: Path, line: str) -> None:
    assert lowered(tmp_path, f"{HEAD}S300 M3\nG0 Z5\n{line}\nM5\nM30\n") == []


def test_a_feed_that_is_not_known_is_planned_by_nobody(tmp_path: Path) -> None:
    machine = bench_mill()
    trace, _ = run_whole(tmp_path, f"{HEAD}S300 M3\nM50 P80\nG1 X5 F100\nM30\n", machine=machine)
    findings = Findings()
    assert plan(trace, machine, findings) is None
    assert [f.code.label for f in findings.kept] == ["GP503"]


def test_a_spindle_whose_speed_follows_x_has_no_number_for_the_board(tmp_path: Path) -> None:
    assert lowered(tmp_path, f"{HEAD}G96 S100 D900 M3\nG0 Z5\nM5\nM30\n") == ["GP503"]
