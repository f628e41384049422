"""Machines of the targets in tests: equal axes, travel, limits and tools, and what a shop states besides."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.target_machines import machine_like
from support.translations import DIALECTS, OTHERS, safe_jobs

from gproof.driver.dialects import load_machine
from gproof.ir.dialects.mcuwin.settings import mcuwin_settings
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
        if one.controller.dialect == "mcuwin":
            # Tools that only ToolComp.INI has (McuWIN 2.7): record 0 is none; R is half of the diameter.
            listed = {0, *(number for number, _, _ in tools[0])}
            own = [tool for tool in mcuwin_settings(one).tools or () if tool.number not in listed]
            tools[0] += [(tool.number, None, 2.0 * (tool.radius or 0.0)) for tool in own if tool.plane == "xy"]
        assert sorted(tools[0]) == sorted(tools[1]), file
        assert (tmp_path / str(number) / "CNC.MAC").exists() == (to == "wincnc")
