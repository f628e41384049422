"""Machines of the targets in tests: equal axes, travel, limits and tools, and what a shop states besides."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.target_machines import machine_like
from support.translations import DIALECTS, OTHERS, safe_jobs

from gproof.driver.dialects import load_machine
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine

FILES = sorted({job.machine for job in safe_jobs()})


def read(path: Path) -> Machine:
    machine, _ = load_machine(path, Findings())
    assert machine is not None
    return machine


@pytest.mark.parametrize("to", [*DIALECTS, *OTHERS])
def test_a_machine_is_like_that_of_the_source(to: str, tmp_path: Path) -> None:
    for number, file in enumerate(FILES):
        one, other = read(file), read(machine_like(file, to, tmp_path / str(number)))
        assert other.controller.dialect == (to if to in DIALECTS else None)
        for a, b in zip(one.axes, other.axes, strict=True):
            for fact in ("name", "kind", "lower", "upper", "travel_lower", "travel_upper", "max_velocity", "letter"):
                assert getattr(a, fact) == getattr(b, fact), (file, a.name, fact)
            assert a.steps_per_unit == b.steps_per_unit
        tools = [[(tool.number, tool.length, tool.diameter) for tool in machine.tools] for machine in (one, other)]
        assert tools[0] == tools[1], file
        assert (tmp_path / str(number) / "CNC.MAC").exists() == (to == "wincnc")
