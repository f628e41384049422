"""Blocks that are made when they run give the Trace and the findings of blocks that a program holds."""

from __future__ import annotations

import functools
import random
from pathlib import Path

import pytest

from gproof.driver.dialects import load_machine
from gproof.driver.running import execute
from gproof.frontend.eding import load as loading
from gproof.frontend.eding.line_cache import Reader
from gproof.ir.finding import Finding, Findings
from gproof.ir.program import DeferredBlock
from gproof.ir.setup import ZERO
from gproof.ir.text import print_ir

MACHINE = Path(__file__).resolve().parents[4] / "docs" / "codes" / "machine.toml"


def job(rng: random.Random) -> str:
    """Moves in a loop and beside it, some of them wrong (no such parameter, a line below the limit of Z)."""
    forms = (
        "G1 X[#1+{:.4f}] Y[#2+{:.4f}]",
        "#5=[#5+{:.3f}] (pass {:.0f})",
        "X[#1 + {:.3f}] Z-{:.2f}",
        "/N7 G0 X-#{:.0f} F[{:.1f}]",
        "G2 X[#5] I[#1 + {:.2f}] (arc {})",
        "X[#{:.0f} / #6]",
    )
    lines = [rng.choice(forms).format(rng.uniform(0, 90), rng.uniform(0, 90)) for _ in range(60)]
    head = ["G21 G90 G17 G94 G54", "F300", "#1=1 #2=2 #5=0 #6=4", "while [#1 < 4]"]
    return "\n".join([*head, *lines[:30], "#1=[#1 + 1]", "endwhile", *lines[30:], "M30", ""])


@pytest.mark.parametrize("seed", range(4))
def test_the_same_trace_and_findings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    path = tmp_path / "job.cnc"
    path.write_text(job(random.Random(seed)), encoding="utf-8")
    machine, _ = load_machine(MACHINE, Findings())
    assert machine is not None
    found: list[tuple[str, list[Finding], dict[int, int]]] = []
    for held in (10_000, 0):
        monkeypatch.setattr(loading, "Reader", functools.partial(Reader, held=held))
        findings = Findings()
        program = loading.load_program(path, findings)
        assert program is not None
        assert any(isinstance(node, DeferredBlock) for node in program.body) is (held == 0)
        trace = execute(program, ZERO, machine, findings)
        found.append((print_ir(trace), findings.kept, findings.counts))
    assert found[0] == found[1]
