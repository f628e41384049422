"""G83 with g81set=L (WinCNC): between pecks the drill lifts above R, as high as the manual can be read.

WinCNC Users Guide, G Codes: G83; WINCNC.INI Settings: g81set=.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gproof.driver.dialects import load_machine, load_setup
from gproof.driver.running import execute
from gproof.frontend.wincnc.load import load_program
from gproof.ir.dialects.wincnc.settings import DrillSettings, wincnc_settings
from gproof.ir.finding import Findings
from gproof.ir.trace import Op

SHOP = Path(__file__).resolve().parents[4] / "corpus" / "wincnc" / "router-atc"


@pytest.mark.parametrize(("lift", "tops"), [(2.54, [-10.16, -10.16]), (0.0, [-12.7, -12.7]), (None, [-12.7, -12.7])])
def test_way_back_between_pecks(tmp_path: Path, lift: float | None, tops: list[float]) -> None:
    job = tmp_path / "job.tap"
    job.write_text("G90\nG49\nG0 X4 Y5\nG83 X5 Y5 Z-1.1 R-.5 Q.2 F30\n", encoding="ascii")
    findings = Findings()
    machine, _ = load_machine(SHOP / "WINCNC.INI", findings)
    assert machine is not None
    settings = replace(wincnc_settings(machine), drill=DrillSettings(approach=1.27, lift=lift))
    machine = replace(machine, settings=settings)
    setup, _ = load_setup(SHOP / "setup.toml", findings, machine)
    program = load_program(job, findings, machine, SHOP / "WINCNC.INI")
    assert program is not None
    assert setup is not None
    done = execute(program, setup, machine, findings)
    rows = done.sections[0].rows
    moves = np.isin(rows["op"], (Op.TRAVERSE, Op.FEED))
    heights = [round(float(z), 6) for z in rows["to"][moves, 2]]
    # R -12.7; pecks to -17.78, -22.86, the last one to -27.94; back down to 1.27 above where the drill was.
    assert heights == [0.0, 0.0, -12.7, -17.78, tops[0], -16.51, -22.86, tops[1], -21.59, -27.94, -12.7]
