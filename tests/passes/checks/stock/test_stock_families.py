"""Tools and ways that are easily taken for free: each family has one that is and one that is not, by hand."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from passes.checks.stock.stock_jobs import FLAT, MACHINE, Judged

from gproof.ir.machine import Tool
from gproof.ir.workpiece import Box

SLOT = "G0 Z5\nG0 X10 Y20\nG1 Z-2\nG1 X40\n"
"""6 mm wide, from X 10 to X 40, 2 mm deep; the job stands at its end."""


@pytest.mark.parametrize(
    ("way", "told"),
    [
        ("G0 X10", []),
        ("G0 X25", []),
        ("G0 X10 Z-1.5", []),
        ("G0 Z5\nG0 X22\nG0 Z-2\nG0 X12 Z-1", []),
        ("G0 X9.999", [(5, 436)]),
        ("G0 X25 Y20.001", [(5, 436)]),
        ("G0 X25 Z-2.001", [(5, 435)]),
        ("G1 X10 Y10\nG0 X40 Y20\nG0 X10", []),
        ("G1 X10 Y10\nG0 X25 Y15", []),
        ("G1 X10 Y10\nG0 X25 Y15.01", [(6, 436)]),
        ("G1 X45\nG0 X10", []),
        ("G1 X40 Z-4\nG0 X45", [(6, 435)]),
        ("G1 X30 Z-4\nG0 X40 Z-2", []),
        ("G1 X30 Z-4\nG0 X40 Z-2.01", [(6, 435)]),
        ("G91\nG1 X0.3\nG1 X0.6\nG90\nG0 X10", []),
        ("G91\nG0 X-0.1\nG0 X-0.2\nG0 X-29.7", []),
        ("G2 X40 Y20 I-5\nG0 X10", []),
    ],
)
def test_back_along_a_slot(way: str, told: list[tuple[int, int]], tmp_path: Path) -> None:
    """A traverse that stays on the lines of feeds, or over them, touches nothing; a hair beside nobody can tell."""
    job = Judged(tmp_path, SLOT + way + "\nG0 Z5\nM30\n")
    assert job.told() == told


def test_back_along_a_slot_with_another_tool_or_on_another_way(tmp_path: Path) -> None:
    other = dataclasses.replace(FLAT, number=2)
    change = "G0 Z50\nT2 M6\nG0 X40 Y20 Z50\nG0 Z-2\nG0 X10\nG0 Z5\nM30\n"
    assert Judged(tmp_path, SLOT + change, tools=(FLAT, other)).told() == [(8, 436), (9, 436)]
    loose = MACHINE + "[controller]\nstraight_traverse = false\n"
    back = "G1 X10 Y10\nG0 X40 Y20\nG0 Z5\nM30\n"
    assert Judged(tmp_path, SLOT + back, machine=loose).told() == [(6, 436)]
    assert Judged(tmp_path, SLOT + "G0 X10\nG0 Z5\nM30\n", machine=loose).told() == []


def test_a_corner_that_may_be_rounded_is_not_known_to_be_cut(tmp_path: Path) -> None:
    """G64 P0.2: behind a plunge with a turn at its end stock may be left in the corner; a peck turns back there."""
    begin, end = "G64 P0.2\nG0 Z5\nG0 X10 Y20\nG1 Z-4\n", "G0 Z-3.5\nG1 Z-6\nG0 Z5\nM30\n"
    assert Judged(tmp_path, begin + "G0 Z5\n" + end).told() == []
    assert Judged(tmp_path, begin + "G1 X20\nG0 Z5\nG0 X10\n" + end).told() == [(8, 436)]
    assert Judged(tmp_path, "G64 P0.2\n" + SLOT + "G0 X10\nG0 Z5\nM30\n").told() == [(6, 436)]


MILL = Tool(
    number=1, shape="flat", diameter=20.0, flute_length=5.0, shank_diameter=10.0, stickout=60.0,
    holder=((40.0, 40.0, 50.0),),
)  # fmt: skip
"""Ten below, five above the flutes."""


def test_a_ledge_above_thin_shanks(tmp_path: Path) -> None:
    """10 mm deep beside the block, then 0.1 mm into it: flutes of 5 mm leave a ledge that the way up meets."""
    under = "G0 Z5\nG0 X-20 Y20\nG0 Z-10\nG1 X-9.9\nG0 Z5\nM30\n"
    job = Judged(tmp_path, under, tools=(MILL,))
    assert (5, 436) in job.told()
    assert job.verdict == "UNKNOWN"
    clear = "G0 Z5\nG0 X-20 Y20\nG0 Z-10\nG1 X-9.9\nG1 X-20\nG0 Z5\nM30\n"
    assert Judged(tmp_path, clear, tools=(MILL,)).verdict == "SAFE"
    shallow = "G0 Z5\nG0 X-20 Y20\nG0 Z-5\nG1 X-9.9\nG0 Z5\nM30\n"
    assert Judged(tmp_path, shallow, tools=(MILL,)).verdict == "SAFE"
    thick = dataclasses.replace(MILL, shank_diameter=20.0)
    assert (5, 436) not in Judged(tmp_path, under, tools=(thick,)).told()


def test_flutes_that_go_on_inside_the_holder_cut_no_rib_away(tmp_path: Path) -> None:
    """A rib 4 mm wide and 10 mm high, a drill chuck 6 mm over the tip: the holder meets what is ahead of the cutter."""
    rib = Box(low=(0.0, 18.0, -10.0), high=(50.0, 22.0, 0.0))
    along = "G0 Z5\nG0 X-30 Y20\nG0 Z-9\nG1 X20\nG0 Z5\nM30\n"
    long = dataclasses.replace(FLAT, flute_length=20.0, stickout=6.0, holder=((30.0, 30.0, 50.0),))
    for flutes in (20.0, None):
        held = dataclasses.replace(long, flute_length=flutes)
        assert Judged(tmp_path, along, tools=(held,), stock=(rib,)).verdict != "SAFE"
    free = dataclasses.replace(long, stickout=10.0)
    assert Judged(tmp_path, along, tools=(free,), stock=(rib,)).verdict == "SAFE"


def test_a_cone_that_ends_before_it_is_wide(tmp_path: Path) -> None:
    """90 degrees, 20 mm wide, but flutes of 4 mm: the hole is 8 mm wide, and a cutter of 16 mm does not go in."""
    vee = Tool(
        number=1, shape="vee", diameter=20.0, tip_angle=90.0, flute_length=4.0, shank_diameter=6.0, stickout=50.0,
        holder=((30.0, 30.0, 50.0),),
    )  # fmt: skip
    wide = dataclasses.replace(FLAT, number=2, diameter=16.0, shank_diameter=16.0)
    text = "G0 Z5\nG0 X25 Y20\nG1 Z-9\nG0 Z50\nT2 M6\nG0 X25 Y20 Z50\nG0 Z0.5\nG0 Z{}\nG0 Z5\nM30\n"
    assert (8, 435) in Judged(tmp_path, text.format("-0.5"), tools=(vee, wide)).told()
    assert 435 not in {code for _, code in Judged(tmp_path, text.format("0.1"), tools=(vee, wide)).told()}


def test_a_shank_that_nobody_stated_may_be_thick(tmp_path: Path) -> None:
    """3 mm deeper than the flutes, in a slot that was cut in passes: with a shank of its own it is another answer."""
    passes = "G0 Z5\nG0 X-10 Y20\n" + "".join(f"G0 Z-{z}\nG1 X60\nG0 Z5\nG0 X-10\n" for z in (3, 6, 9)) + "M30\n"
    short = dataclasses.replace(FLAT, flute_length=6.0, shank_diameter=4.0)
    assert Judged(tmp_path, passes, tools=(short,)).verdict == "SAFE"
    bare = dataclasses.replace(short, shank_diameter=None)
    job = Judged(tmp_path, passes, tools=(bare,))
    assert job.verdict == "UNKNOWN"
    assert {code for _, code in job.told()} == {442}


DRILL = dataclasses.replace(FLAT, shape="drill", flute_length=20.0)


def test_a_drill_without_a_tip_angle(tmp_path: Path) -> None:
    """It touches what a flat end would, and nobody knows what its tip leaves."""
    holes = "G0 Z5\nG0 X10 Y20\nG1 Z-6\nG0 Z1\nG0 Z-5.9\nG1 Z-9\nG0 Z5\nG0 X30\nG1 Z-9\nG0 Z5\nM30\n"
    job = Judged(tmp_path, holes, tools=(DRILL,))
    assert (job.verdict, job.told()) == ("SAFE", [])
    assert any("flat end" in each for each in job.result.assumptions)
    into = "G0 Z5\nG0 X10 Y20\nG0 Z-1\nG0 Z5\nM30\n"
    assert Judged(tmp_path, into, tools=(DRILL,)).told() == [(3, 435)]
    beside = "G0 Z5\nG0 X-2.9 Y20\nG0 Z-1\nG0 Z5\nM30\n"
    assert Judged(tmp_path, beside, tools=(DRILL,)).told() == [(3, 436)]
    deep = dataclasses.replace(DRILL, flute_length=8.0, stickout=40.0)
    assert Judged(tmp_path, "G0 Z5\nG0 X10 Y20\nG1 Z-9\nG0 Z5\nM30\n", tools=(deep,)).verdict != "SAFE"
    mill = dataclasses.replace(FLAT, number=2, diameter=5.0, shank_diameter=5.0)
    after = "G0 Z5\nG0 X10 Y20\nG1 Z-9\nG0 Z50\nT2 M6\nG0 X10 Y20 Z50\nG0 Z1\nG0 Z-3\nG0 Z5\nM30\n"
    assert Judged(tmp_path, after, tools=(DRILL, mill)).told() == [(8, 436)]
    pointed = dataclasses.replace(DRILL, tip_angle=118.0)
    assert Judged(tmp_path, after, tools=(pointed, mill), cell=0.2).told() == []


def test_what_a_controller_makes_of_arcs_is_charged(tmp_path: Path) -> None:
    """A bore of 8 mm; a (0.02 s)^2 / 8 of 1600 mm/s^2 along each axis is 0.139 mm that may be left of its wall."""
    bore = "G0 Z5\nG0 X30 Y20\nG1 Z-2\nG3 X30 Y20 I-5\nG0 Z5\nG0 X25\nG0 Z-2\nG0 X{}\nG0 Z5\nM30\n"
    axes = "".join(f"[axes.{axis}]\nmax_acceleration = 1600.0\n" for axis in "xyz")
    machine = 'schema = "gproof-machine/1"\nunits = "mm"\n' + axes + "[controller]\ninterpolation_time = {}\n"
    for seconds, x, told in ((1e-5, 20.05, []), (0.02, 20.05, [(8, 436)]), (0.02, 20.2, [])):
        job = Judged(tmp_path, bore.format(x), machine=machine.format(seconds), cell=0.02, stock=(WALL,))
        assert job.told() == told, (seconds, x)


WALL = Box(low=(15.0, 18.0, -10.0), high=(19.0, 22.0, 0.0))


def test_simplified_paths_are_charged_in_exact_path_mode_too(tmp_path: Path) -> None:
    near = "G61 Q{}\nG0 Z5\nG0 X-3.01 Y20\nG0 Z-5\nG0 Y10\nG0 Z5\nM30\n"
    assert Judged(tmp_path, near.format("0.001")).told() == []
    assert (5, 436) in Judged(tmp_path, near.format("0.1")).told()
