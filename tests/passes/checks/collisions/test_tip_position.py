"""Where the tip of the tool is beside a body; values by hand from the manuals' rules of offsets.

Eding CNC manual 3.4.5, 3.4.12, 3.4.23 (a position is words + work + G92 + tool); WinCNC Users Guide, Tool Length
Offset, M37; McuWIN 3.19, 3.26.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from gproof.driver.running import begin
from gproof.driver.session import Running, open_session
from gproof.ir.trace import Chunk, Op
from gproof.ir.workpiece import ACTIVE, MACHINE
from gproof.passes.checks.tooling.tip_position import OWN_ZERO, Placing, Reason, Tips

TABLE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
[axes.y]
[axes.z]
[tools.1]
length = 40.0
[tools.2]
length = 65.0
[tools.3]
"""
START = "G21 G17 G90 G94 G54 G40\nG0 Z30\nG0 X0 Y0\n"


class Placed:
    """A job, its rows that move, and where the tip is in them."""

    def __init__(self, folder: Path, name: str, text: str, machine: str = TABLE, setup: str = "") -> None:
        (folder / "machine.toml").write_text(machine)
        (folder / "setup.toml").write_text('schema = "gproof-setup/1"\n' + setup)
        job = folder / name
        job.write_text(text)
        session = open_session(job, machine=folder / "machine.toml", setup=str(folder / "setup.toml"), dialect=None)
        assert session.program is not None
        self.findings = session.findings
        executor = begin(
            session.program, session.setup, session.machine, session.findings, **session.options(Running())
        )
        self.placing = Placing(session.machine, session.setup, executor.modal.copy().zero_at_start)
        self.chunks: list[Chunk] = list(executor.chunks())

    def tips(self, work: int = 1) -> list[Tips]:
        return [self.placing.tips(chunk, work) for chunk in self.chunks]

    def ends(self, work: int = 1) -> list[tuple[float | None, ...]]:
        """Behind each move, None for an axis whose place is open."""
        found: list[tuple[float | None, ...]] = []
        for chunk, tips in zip(self.chunks, self.tips(work), strict=True):
            for row in np.flatnonzero(chunk.rows["op"] < Op.DWELL).tolist():
                place = tips.end[row].tolist()
                found.append(tuple(None if math.isnan(value) else round(value, 9) + 0.0 for value in place))
        return found

    def reasons(self, work: int = 1) -> list[Reason]:
        return [
            Reason(int(tips.reason[row]))
            for chunk, tips in zip(self.chunks, self.tips(work), strict=True)
            for row in np.flatnonzero(chunk.rows["op"] < Op.DWELL).tolist()
        ]

    def cause(self, work: int = 1) -> str:
        """Of the last move."""
        for chunk, tips in zip(reversed(self.chunks), reversed(self.tips(work)), strict=True):
            for row in reversed(np.flatnonzero(chunk.rows["op"] < Op.DWELL).tolist()):
                assert not tips.known[row]
                return self.placing.cause(chunk, row, work)
        raise AssertionError("no move")


# ---- Eding


def test_a_work_offset_that_nobody_stated_cancels(tmp_path: Path) -> None:
    job = Placed(tmp_path, "job.cnc", START + "G1 Z-2 F100\nX10\nM30\n")
    assert job.ends() == [(None, None, 30.0), (0.0, 0.0, 30.0), (0.0, 0.0, -2.0), (10.0, 0.0, -2.0)]
    assert job.reasons() == [Reason.START, Reason.START, Reason.KNOWN, Reason.KNOWN]
    assert OWN_ZERO not in job.placing.assumptions
    # The tool length in force at the start is in the positions, and in what is taken from them.
    tips = job.tips()[0]
    assert tips.known.tolist()[-2:] == [True, True]
    assert tips.axes[job.chunks[0].rows["op"] < Op.DWELL].tolist()[:2] == [[False, False, False], [False, False, True]]


def test_a_length_in_force_is_taken_from_positions(tmp_path: Path) -> None:
    text = START + "G49\nT1 M6\nG43\nG0 Z5\nG1 Z-2 F100\nT2 M6\nG0 Z5\nG43 H2\nG1 Z-3 F100\nM30\n"
    job = Placed(tmp_path, "job.cnc", text, setup="[work.1]\nx = 0.0\ny = 0.0\nz = 100.0\n[g92]\nx=0.0\ny=0.0\nz=0.0\n")
    machine = [chunk.rows["to"][row, 2] for chunk in job.chunks for row in np.flatnonzero(chunk.rows["op"] < Op.DWELL)]
    assert machine[-4:] == [145.0, 138.0, 170.0, 162.0]
    assert [end[2] for end in job.ends()][-4:] == [5.0, -2.0, 5.0, -3.0]
    assert [end[2] for end in job.ends(MACHINE)][-4:] == [105.0, 98.0, 105.0, 97.0]


def test_a_tool_without_its_length_in_force_stands_out(tmp_path: Path) -> None:
    """Lengths are in use, so that the zero counts for tips; G49 then brings the tip 40 mm too low."""
    text = START + "T1 M6\nG43\nG0 Z50\nG49\nG0 Z50\nM30\n"
    assert [end[2] for end in Placed(tmp_path, "job.cnc", text).ends()][-2:] == [50.0, 10.0]


def test_the_length_of_another_tool(tmp_path: Path) -> None:
    """G43 H1 stays what it is over a change of tools (3.4.12, the warning): tool 2 is 25 mm longer."""
    text = START + "T1 M6\nG43 H1\nG0 Z50\nT2 M6\nG0 Z50\nM30\n"
    assert [end[2] for end in Placed(tmp_path, "job.cnc", text).ends()][-2:] == [50.0, 25.0]
    unstated = Placed(tmp_path, "job.cnc", text.replace("T2", "T3"))
    assert unstated.ends()[-1] == (0.0, 0.0, None)
    assert unstated.reasons()[-1] is Reason.OFFSET
    assert unstated.cause() == "length of tool 3: unknown"


def test_a_length_that_nobody_stated_cancels_for_its_own_tool(tmp_path: Path) -> None:
    text = START + "T3 M6\nG43\nG0 Z5\nG1 Z-1 F100\nM30\n"
    assert [end[2] for end in Placed(tmp_path, "job.cnc", text).ends()][-2:] == [5.0, -1.0]


def test_a_length_of_the_program_itself(tmp_path: Path) -> None:
    text = START + "T1 M6\nG43.1 K12.5\nG0 Z5\nT2 M6\nG0 Z5\nM30\n"
    assert [end[2] for end in Placed(tmp_path, "job.cnc", text).ends()][-2:] == [5.0, 5.0 + 12.5 - 65.0]


def test_no_length_means_the_zero_was_taken_with_the_tool(tmp_path: Path) -> None:
    job = Placed(tmp_path, "job.cnc", START + "G49\nT1 M6\nG0 Z5\nT2 M6\nG1 Z-1 F100\nM30\n")
    assert [end[2] for end in job.ends()][-2:] == [5.0, -1.0]
    assert OWN_ZERO in job.placing.assumptions
    assert [tip.tool[-1] for tip in job.tips() if len(tip.tool)][-1] == 2


@pytest.mark.parametrize(
    ("line", "height"),
    [
        ("G92 X100 Y200 Z300", 31.0), ("G10 L20 P1 X100 Y200 Z300", None),
        ("G92 X100 Y200\nG92.2\nG92.3\nG10 L20 P1 Z300", None),
    ],
)  # fmt: skip
def test_a_body_stays_where_it_is_when_the_program_moves_the_zero(
    tmp_path: Path, line: str, height: float | None
) -> None:
    """At (7, 8, 30) the point gets other numbers; 1 mm on in all three it is at (8, 9, 31) of the body.

    Not of Z, where G10 L20 may or may not take out a length that nobody stated (3.4.5).
    """
    text = START + f"G0 X7 Y8\n{line}\nG0 X101 Y201 Z301\nM30\n"
    job = Placed(tmp_path, "job.cnc", text, setup="[g92]\nx = 0.0\ny = 0.0\nz = 0.0\n")
    assert job.ends()[-1] == (8.0, 9.0, height)


def test_a_zero_given_in_numbers_needs_the_old_one(tmp_path: Path) -> None:
    text = START + "G10 L2 P1 X50 Y60 Z70\nG0 X1 Y2 Z3\nM30\n"
    job = Placed(tmp_path, "job.cnc", text)
    assert job.ends()[-1] == (None, None, None)
    assert job.cause() == "G54 X offset, G54 Y offset, G54 Z offset: unknown"
    stated = Placed(tmp_path, "job.cnc", text, setup="[work.1]\nx = 10.0\ny = 20.0\nz = 30.0\n")
    assert stated.ends()[-1] == (41.0, 42.0, 43.0)


def test_an_interval_cancels_too(tmp_path: Path) -> None:
    job = Placed(tmp_path, "job.cnc", START + "M30\n", setup="[work.1]\nx = [1.0, 9.0]\n")
    assert job.ends()[-1] == (0.0, 0.0, 30.0)
    assert job.ends(MACHINE)[-1] == (None, None, None)


def test_systems_beside_one_another(tmp_path: Path) -> None:
    setup = "[work.1]\nx=10.0\ny=0.0\nz=0.0\n[work.2]\nx=110.0\ny=5.0\nz=1.0\n"
    text = START + "G55\nG0 X1 Y1 Z1\nM30\n"
    job = Placed(tmp_path, "job.cnc", text, setup=setup)
    assert job.ends(1)[-1] == (101.0, 6.0, 2.0)
    assert job.ends(2)[-1] == (1.0, 1.0, 1.0)
    unstated = Placed(tmp_path, "job.cnc", text)
    assert unstated.ends(2)[-1] == (1.0, 1.0, 1.0)
    assert unstated.ends(1)[-1] == (None, None, None)


def test_the_zero_in_force_at_the_start(tmp_path: Path) -> None:
    text = "G21 G90\nG0 X1 Y2 Z3\nM30\n"
    assert Placed(tmp_path, "job.cnc", text).ends(ACTIVE)[-1] == (1.0, 2.0, 3.0)
    assert Placed(tmp_path, "job.cnc", text).ends(1)[-1] == (None, None, None)
    for setup in ("active_work = 2\n", "[parameters]\n5220 = 2\n"):
        assert Placed(tmp_path, "job.cnc", text, setup=setup).ends(2)[-1] == (1.0, 2.0, 3.0)


def test_a_traverse_from_the_unknown_start_is_told_from_feeds(tmp_path: Path) -> None:
    text = "G21 G90 G54\nG92 X0 Y0 Z0\nG0 X1\nG1 Y1 F100\nM30\n"
    job = Placed(tmp_path, "job.cnc", text)
    assert job.reasons() == [Reason.START, Reason.OFFSET]


def test_centres_go_along(tmp_path: Path) -> None:
    job = Placed(tmp_path, "job.cnc", START + "G2 X10 Y0 I5 J0 F100\nM30\n")
    tips = job.tips()[0]
    arc = int(np.flatnonzero(job.chunks[0].rows["op"] == Op.ARC)[0])
    assert tips.center[arc].tolist() == [5.0, 0.0, 30.0]
    assert np.isfinite(tips.center).all()


def test_a_turned_axis(tmp_path: Path) -> None:
    text = START + "G0 A0\nG1 X1 F100\nG0 A90\nG1 X2 F100\nG0 A0\nG1 X3 F100\nM30\n"
    machine = TABLE + "[axes.a]\n"
    assert Placed(tmp_path, "job.cnc", text, machine).reasons()[2:] == [Reason.ROTARY] * 6
    known = Placed(tmp_path, "job.cnc", text, machine, "[start]\na = 0.0\n[work.1]\na = 0.0\n[g92]\na = 0.0\n")
    assert known.reasons()[2:] == [
        Reason.KNOWN, Reason.KNOWN, Reason.ROTARY, Reason.ROTARY, Reason.ROTARY, Reason.KNOWN,
    ]  # fmt: skip
    assert known.ends()[-1] == (3.0, 0.0, 30.0)
    assert known.ends()[-2] == (None, None, None)


def test_another_head(tmp_path: Path) -> None:
    machine = TABLE + "[spindles.1]\nx = 50.0\ny = 0.0\nz = 0.0\n"
    job = Placed(tmp_path, "job.cnc", START + "M91\nG0 X1\nM90\nG0 X2\nM30\n", machine)
    assert Reason.HEAD in job.reasons()


def test_other_kinematics(tmp_path: Path) -> None:
    lathe = TABLE + "[controller]\nturning = true\n"
    assert set(Placed(tmp_path, "job.cnc", "G21 G90 G54\nG0 X1 Z1\nM30\n", lathe).reasons()) == {Reason.LATHE}
    setup = "[cylinder]\nradius = 20.0\ny = 0.0\nz = 0.0\n"
    assert set(Placed(tmp_path, "job.cnc", START + "M30\n", TABLE + "[axes.a]\n", setup).reasons()) == {Reason.MAPPED}


# ---- WinCNC

INI = """unit=MM
axischar=XYZ
axisspec=p0 s0 d0 r100 a100 t1
axisspec=p0 s1 d1 r100 a100 t2
axisspec=p0 s2 d2 r100 a100 t3
axisvel=r6000 f3000
atc1=H0 A2
"""


def wincnc(folder: Path, text: str, setup: str = "") -> Placed:
    (folder / "WINCNC.INI").write_text(INI)
    (folder / "CNC.MAC").write_text("")
    machine = 'schema = "gproof-machine/1"\nunits = "mm"\nbase = "WINCNC.INI"\n'
    return Placed(folder, "job.tap", text, machine, setup)


def test_a_measure_of_the_start(tmp_path: Path) -> None:
    job = wincnc(tmp_path, "G90\nG0 Z10\nG0 X1 Y2\nG1 Z-1\n")
    assert job.ends()[-1] == (1.0, 2.0, -1.0)
    assert job.ends(ACTIVE)[-1] == (1.0, 2.0, -1.0)
    assert job.ends(MACHINE)[-1] == (None, None, None)


def test_measures_and_local_zero(tmp_path: Path) -> None:
    """M37 at machine -150 names the tip 0 of the workspace; L101 T2 then holds a tool that measures -130."""
    setup = "[start]\nx = 0.0\ny = 0.0\nz = -150.0\n[g92]\nx = 0.0\ny = 0.0\nz = 20.0\n[tools.2]\nlength = -130.0\n"
    job = wincnc(tmp_path, "G90\nM37 Z0\nG0 Z5\nG0 X1 Y1\nL101 T2\nG0 Z5\nG49\nG0 Z5\nG43\nG0 Z5\n", setup)
    machine = [chunk.rows["to"][row, 2] for chunk in job.chunks for row in np.flatnonzero(chunk.rows["op"] < Op.DWELL)]
    assert machine == [-125.0, -125.0, -105.0, 25.0, -105.0]
    # Local zero is 20 up. With its measure off, tool 2 is not 5 but 135 above it: the tip is where it is.
    assert [end[2] for end in job.ends()] == [5.0, 5.0, 5.0, 135.0, 5.0]


def test_a_new_local_zero_leaves_the_body(tmp_path: Path) -> None:
    job = wincnc(tmp_path, "G90\nG0 Z10\nG0 X1 Y2\nG92 X0 Y0 Z0\nG0 X5 Y5 Z5\n")
    assert job.ends()[-1] == (6.0, 7.0, 15.0)


# ---- McuWIN

DIN = """schema = "gproof-machine/1"
units = "mm"
base = "McuWIN.ini"
[axes.x]
position_unit = "mm"
[axes.y]
position_unit = "mm"
[axes.z]
position_unit = "mm"
[din]
position_unit = "mm"
time_unit = "min"
absolute_centers = false
interpolation_axes = "XYZ"
tool_file = ""
"""


def mcuwin(folder: Path, text: str, more: str = "") -> Placed:
    (folder / "McuWIN.ini").write_text("[MCU]\n")
    return Placed(folder, "job.src", text, DIN + more)


def test_the_table_of_zero_offsets(tmp_path: Path) -> None:
    """G54 and G55 choose records (3.19); G92 in G90 counts from machine zero (3.26)."""
    text = "% P\nG90 G55\nG00 X1 Y1 Z1\nG54\nG00 X1 Y1 Z1\nG92 X5 Y6 Z7\nG00 X1 Y1 Z1\nM30\n"
    job = mcuwin(tmp_path, text, "zero_offsets = [[10, 20, 30], [110, 120, 130]]\n")
    assert job.ends(1) == [(101.0, 101.0, 101.0), (1.0, 1.0, 1.0), (-4.0, -13.0, -22.0)]
    assert job.ends(2) == [(1.0, 1.0, 1.0), (-99.0, -99.0, -99.0), (-104.0, -113.0, -122.0)]
    unstated = mcuwin(tmp_path, text)
    assert unstated.ends(1) == [(None,) * 3, (1.0, 1.0, 1.0), (None,) * 3]


def test_the_offset_in_force_at_the_start(tmp_path: Path) -> None:
    job = mcuwin(tmp_path, "% P\nG90\nG00 X1 Y1 Z1\nM30\n")
    assert job.ends(ACTIVE)[-1] == (1.0, 1.0, 1.0)
    assert job.ends(1)[-1] == (None, None, None)
