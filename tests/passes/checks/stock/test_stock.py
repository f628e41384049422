"""What is told of traverses, depths, shanks and holders; expected answers by hand from the geometry."""

from __future__ import annotations

import dataclasses
import random
from pathlib import Path

import numpy as np
import pytest
import shapely
from passes.checks.stock.stock_jobs import FLAT, MACHINE, START, Judged

from gproof.ir.columns import Columns
from gproof.ir.workpiece import TRIANGLES, Box, Mesh
from gproof.passes.checks.stock import stock

SLOT = "G0 Z5\nG0 X10 Y20\nG1 Z-2\nG1 X40\n"


def test_a_slot_with_traverses_above_the_stock_is_safe(tmp_path: Path) -> None:
    job = Judged(tmp_path, SLOT + "G0 Z5\nG0 X0 Y0\nM30\n")
    assert (job.verdict, job.told()) == ("SAFE", [])
    assert any("cells of 0.5 mm" in each for each in job.result.assumptions)


def test_a_traverse_at_depth_out_of_the_slot_is_unsafe(tmp_path: Path) -> None:
    job = Judged(tmp_path, SLOT + "G0 X-10 Y5\nM30\n")
    assert (job.verdict, job.told()) == ("UNSAFE", [(5, 435)])


def test_a_traverse_a_hair_inside_is_never_safe(tmp_path: Path) -> None:
    above = Judged(tmp_path, SLOT + "G0 Z0\nG0 Y-20\nM30\n")
    inside = Judged(tmp_path, SLOT + "G0 Z-0.000001\nG0 Y-20\nM30\n")
    assert (above.verdict, above.told()) == ("SAFE", [])
    assert inside.verdict != "SAFE"
    assert inside.told()[0][0] == 6
    near = Judged(tmp_path, SLOT + "G0 Z0.999\nG0 Y-20\nM30\n", clearance=1.0)
    assert (near.verdict, near.told()) == ("UNKNOWN", [(6, 436)])


def test_pecks_may_go_back_into_their_hole(tmp_path: Path) -> None:
    peck = "G0 Z5\nG0 X10 Y20\nG1 Z-2\nG0 Z5\nG0 Z-1.9\nG1 Z-4\nG0 Z5\nG0 X30\nG0 X10\nG0 Z-3.9\nG1 Z-6\nG0 Z5\nM30\n"
    job = Judged(tmp_path, peck)
    assert (job.verdict, job.told()) == ("SAFE", [])
    deeper = Judged(tmp_path, peck.replace("G0 Z-3.9", "G0 Z-4.1"))
    assert deeper.told() == [(10, 435)]


def test_cycles_that_peck_are_safe(tmp_path: Path) -> None:
    job = Judged(tmp_path, "G0 Z5\nG83 X10 Y10 Z-8 R1 Q2\nX20\nG80\nG0 Z5\nM30\n")
    assert (job.verdict, job.told()) == ("SAFE", [])


def test_flutes_that_are_too_short(tmp_path: Path) -> None:
    short = dataclasses.replace(FLAT, flute_length=1.5)
    assert Judged(tmp_path, SLOT + "G0 Z5\nM30\n", tools=(short,)).told() == [(3, 437), (3, 442), (4, 437), (4, 442)]


CUT = "G0 X10\nG1 Z-2\nX40\nY21\nX10\nY19\nX40\nY20\nG0 Z5\nG0 X25\n"


def test_where_ways_come_together_the_most_may_be_left(tmp_path: Path) -> None:
    """Only one outcome of the question cuts: a traverse down is not proved there, and not wrong for certain."""
    begin, end = "G0 Z5\nG0 X25 Y20\nif [#100 > 0]\n" + CUT, "endif\nG0 Z-1\nG0 Z5\nM30\n"
    job = Judged(tmp_path, begin + end)
    assert (job.verdict, job.told()) == ("UNKNOWN", [(15, 436)])
    both = Judged(tmp_path, begin + "else\n" + CUT + end)
    assert (both.verdict, both.told()) == ("SAFE", [])


def test_ways_that_do_not_come_together_are_judged_each(tmp_path: Path) -> None:
    job = Judged(tmp_path, "G0 Z5\nG0 X25 Y20\nif [#100 > 0]\n" + CUT + "G0 Y21\nendif\nG0 Y20\nG0 Z-1\nG0 Z5\nM30\n")
    assert (job.verdict, job.told()) == ("UNSAFE", [(17, 435)])


def test_a_loop_that_comes_back_with_less_stock_is_judged_once(tmp_path: Path) -> None:
    job = Judged(
        tmp_path, "G0 Z5\nG0 X10 Y20\nwhile [#100 > 0]\nG0 Z5\nG0 X10\nG1 Z-2\nX30\nG0 Z5\nG0 X10\nendwhile\nM30\n"
    )
    assert (job.verdict, job.told()) == ("SAFE", [])


def test_operators_stops_keep_what_is_left(tmp_path: Path) -> None:
    assert Judged(tmp_path, SLOT + "G0 Z5\nM0\nG0 X25\nG0 Z-1\nM30\n").told() == []
    assert Judged(tmp_path, SLOT + "G0 Z5\nM0\nG0 X25 Y20.1\nG0 Z-1\nM30\n").told() == [(8, 436)]
    assert Judged(tmp_path, SLOT + "G0 Z5\nM0\nG0 X25 Y30\nG0 Z-1\nM30\n").told() == [(8, 435)]


def test_a_tool_without_a_shape(tmp_path: Path) -> None:
    bare = dataclasses.replace(FLAT, shape=None)
    job = Judged(tmp_path, SLOT + "G0 Z5\nM30\n", tools=(bare,))
    assert (job.verdict, job.told()) == ("UNKNOWN", [(3, 443), (4, 443)])
    assert "the machine file gives no shape of tool 1" in job.findings.kept[0].message
    assert Judged(tmp_path, "G0 Z5\nG0 X10 Y20\nG1 X40\nM30\n", tools=(bare,)).verdict == "SAFE"
    assert Judged(tmp_path, SLOT + "G0 Z5\nM30\n", tools=()).verdict == "UNKNOWN"


def test_a_place_that_is_not_known(tmp_path: Path) -> None:
    job = Judged(tmp_path, "G0 Z5\nG0 X10 Y20\nG1 Z#50\nX40\nG0 Z5\nM30\n")
    assert (job.verdict, job.told()[0]) == ("UNKNOWN", (3, 443))


def test_what_nobody_stated_of_a_tool_may_be_anything(tmp_path: Path) -> None:
    bare = dataclasses.replace(FLAT, flute_length=None, shank_diameter=None, stickout=None)
    assert Judged(tmp_path, SLOT + "G0 Z5\nM30\n", tools=(bare,)).told() == [(3, 442), (4, 442)]
    long = dataclasses.replace(bare, stickout=30.0)
    job = Judged(tmp_path, SLOT + "G0 Z5\nM30\n", tools=(long,))
    assert job.verdict == "SAFE"
    assert any("flute length" in each for each in job.result.assumptions)


def test_traverses_that_are_no_straight_lines(tmp_path: Path) -> None:
    """Through a gap between two blocks askew: straight it is free, one axis after the other it is not."""
    walls = (Box(low=(0.0, 20.0, -10.0), high=(20.0, 40.0, 0.0)), Box(low=(30.0, 0.0, -10.0), high=(50.0, 20.0, 0.0)))
    assert Judged(tmp_path, "G0 Z5\nG0 X5 Y0\nG0 Z-5\nG0 X45 Y40\nM30\n", stock=walls).verdict == "SAFE"
    loose = MACHINE + "[controller]\nstraight_traverse = false\n"
    job = Judged(tmp_path, "G0 Z5\nG0 X5 Y0\nG0 Z-5\nG0 X45 Y40\nM30\n", stock=walls, machine=loose)
    assert (job.verdict, job.told()) == ("UNKNOWN", [(4, 436)])
    alone = Judged(tmp_path, "G0 Z5\nG0 X-9 Y30\nG0 Z-5\nG0 X45\nM30\n", stock=walls, machine=loose)
    assert (alone.verdict, alone.told()) == ("UNSAFE", [(4, 435)])


def test_several_bodies_and_arcs(tmp_path: Path) -> None:
    ring = (Box(low=(0.0, 0.0, -10.0), high=(20.0, 40.0, 0.0)), Box(low=(20.0, 0.0, -10.0), high=(50.0, 40.0, 0.0)))
    bore = "G0 Z5\nG0 X30 Y20\nG1 Z0\nG3 X30 Y20 Z-2 I-5\nG3 X30 Y20 I-5\nG0 Z5\nG0 X30 Y20\nG0 Z-1\nG0 Z5\nM30\n"
    job = Judged(tmp_path, bore, stock=ring)
    assert (job.verdict, job.told()) == ("SAFE", [])
    off = Judged(tmp_path, bore.replace("G0 X30 Y20\nG0 Z-1", "G0 X30.9 Y20\nG0 Z-1"), stock=ring)
    assert off.told() == [(8, 435)]


def test_pieces_of_any_size_tell_the_same(tmp_path: Path) -> None:
    text = SLOT + "G0 Y30\nG1 Z-4\nG3 X20 Y30 I-10\nG0 Z5\nG0 X25 Y35\nG0 Z-1\nG0 Z5\nM30\n"
    whole = Judged(tmp_path, text)
    for size in (1, 3):
        parts = Judged(tmp_path, text, pieces=size)
        assert [f.message for f in parts.findings.kept] == [f.message for f in whole.findings.kept]
        for one, other in zip(parts.check.fields, whole.check.fields, strict=True):
            assert one.upper.tobytes() == other.upper.tobytes()
            assert one.lower.tobytes() == other.lower.tobytes()
    assert whole.verdict == "UNSAFE"


def test_a_mesh_that_is_not_closed(tmp_path: Path) -> None:
    """Only the floor of a block: nobody knows what stands on it."""
    corners = [[(0.0, 0.0, -10.0), (50.0, 40.0, -10.0), (50.0, 0.0, -10.0)]]
    columns = {name: np.array([each[n] for each in corners]) for n, name in enumerate("abc")}
    open_mesh = Mesh(triangles=Columns(TRIANGLES, columns), closed=False)
    job = Judged(tmp_path, "G0 Z5\nG0 X10 Y20\nG0 Z-2\nG0 Z5\nM30\n", stock=(open_mesh,))
    assert (job.verdict, [f.code.number for f in job.findings.kept]) == ("UNKNOWN", [443])


def test_fields_that_would_be_too_many_start_from_whole_stock(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:  # fmt: skip
    monkeypatch.setattr(stock, "WAITING_CELLS", 100)
    begin, end = "G0 Z5\nG0 X25 Y20\nif [#100 > 0]\n" + CUT, "endif\nG0 Z-1\nG0 Z5\nM30\n"
    assert Judged(tmp_path, begin + "else\n" + CUT + end).verdict == "UNKNOWN"
    assert Judged(tmp_path, CUT + "M0\nG0 Z-1\nG0 Z5\nM30\n", start=START + "G0 Z5\nG0 X25 Y20\n").verdict == "SAFE"


@pytest.mark.parametrize("straight", ["true", "false"])
@pytest.mark.parametrize(
    ("text", "setup", "expected"),
    [
        ("G0 Z5\nG0 X25 Y20 Z-5\nM30\n", "", ("UNSAFE", [(2, 435)])),
        ("G0 X25 Y20 Z-5\nM30\n", "", ("UNSAFE", [(1, 435)])),
        ("G0 X25 Y20 Z-5\nM30\n", "start = {x = [-90.0, 90.0], y = 0.0, z = 50.0}\n", ("UNSAFE", [(1, 435)])),
        # The end lies beside the block, or above it.
        ("G0 X-3.1 Y20 Z-5\nM30\n", "", ("SAFE", [])),
        ("G0 X25 Y20 Z0.1\nM30\n", "", ("SAFE", [])),
    ],
)
def test_a_traverse_whose_end_is_in_stock_is_refuted_whatever_its_way(
    tmp_path: Path, text: str, setup: str, expected: tuple[str, list[tuple[int, int]]], straight: str
) -> None:
    machine = MACHINE + f"[controller]\nstraight_traverse = {straight}\n"
    job = Judged(
        tmp_path, text, machine=machine, setup=setup + "[work.1]\nx = 0.0\ny = 0.0\nz = 0.0\n" if setup else ""
    )
    assert (job.verdict, job.told()) == expected


def test_an_end_in_what_was_cut_is_not_refuted(tmp_path: Path) -> None:
    """Down at random places, then a traverse of any way to somewhere: an error only where its end is not all cut."""
    machine = MACHINE + "[controller]\nstraight_traverse = false\n"
    seen = set()
    for seed in range(40):
        rng = random.Random(f"ends {seed}")
        holes = [(rng.uniform(0, 50), rng.uniform(0, 40)) for _ in range(rng.randrange(1, 5))]
        text = "".join(f"G0 Z5\nG0 X{x:.3f} Y{y:.3f}\nG1 Z-8\n" for x, y in holes)
        x, y = rng.choice(holes)
        x, y = x + rng.choice((0.0, 0.2, 1.5)), y + rng.uniform(-0.5, 0.5)
        text += f"G0 Z5\nG0 X-20 Y-20\nG0 X{x:.3f} Y{y:.3f} Z-5\nM30\n"
        job = Judged(tmp_path, text, machine=machine, cell=0.25)
        end = shapely.Point(x, y).buffer(3.0, 64).intersection(shapely.box(0, 0, 50, 40))
        left = end.difference(shapely.union_all([shapely.Point(*hole).buffer(3.001, 64) for hole in holes]))
        if (3 * len(holes) + 3, 435) in job.told():
            assert left.area > 0.0, f"seed {seed}\n{text}"
        elif left.buffer(-0.4).area > 0.0:
            raise AssertionError(f"seed {seed}: not refuted\n{text}")
        seen.add(job.verdict)
    assert "UNSAFE" in seen
    assert "UNKNOWN" in seen


@pytest.mark.parametrize(("depth", "expected"), [(5.0, [(4, 438)]), (2.01, [(4, 438)]), (2.0, []), (1.9, [])])
@pytest.mark.parametrize("move", ["G2 X30 Y20 I20 J0", "G3 X30 Y20 R25", "G1 X30 Y20"])
def test_the_greatest_depth_holds_on_arcs_as_on_lines(
    tmp_path: Path, move: str, depth: float, expected: list[tuple[int, int]]
) -> None:
    tool = dataclasses.replace(FLAT, max_depth=2.0)
    job = Judged(tmp_path, f"G0 Z5\nG0 X-10 Y20\nG1 Z-{depth}\n{move}\nG0 Z5\nM30\n", tools=(tool,))
    assert job.told() == expected


def test_arcs_over_what_was_cut_are_as_deep_as_what_is_left(tmp_path: Path) -> None:
    """A slot, then a level arc over it: too deep for certain only where some of the arc's way was uncut enough."""
    tool = dataclasses.replace(FLAT, max_depth=3.0)
    seen = set()
    for seed in range(40):
        rng = random.Random(f"arcs {seed}")
        first, second = rng.uniform(1.0, 2.9), rng.uniform(2.0, 5.9)
        y, wide = rng.uniform(5, 35), rng.uniform(8, 20)
        sign, code = rng.choice(((1, "G3"), (-1, "G2")))
        text = f"G0 Z5\nG0 X-10 Y{y:.3f}\nG1 Z-{first:.3f}\nG1 X60\nG0 Z5\n"
        text += f"G0 X{25 - wide:.3f} Y{y:.3f}\nG1 Z-{second:.3f}\n"
        text += f"{code} X{25 + wide:.3f} Y{y:.3f} I{wide:.3f} J0\nG0 Z5\nM30\n"
        job = Judged(tmp_path, text, tools=(tool,))
        angles = np.linspace(np.pi, np.pi + sign * np.pi, 400)
        way = shapely.LineString(np.stack([25 + wide * np.cos(angles), y + wide * np.sin(angles)], axis=1))
        cut = way.buffer(3.0, 64).intersection(shapely.box(0, 0, 50, 40))
        slot = shapely.LineString([(-10, y), (60, y)]).buffer(3.0, 64)
        fresh = cut.difference(slot).area > 0.0 and second > 3.0
        again = cut.intersection(slot).area > 0.0 and second - first > 3.0
        told = (8, 438) in job.told()
        assert not told or fresh or again, f"seed {seed}\n{text}"
        wholly = cut.difference(slot).buffer(-1.0).area > 0.0 and second > 3.001
        assert told or not wholly, f"seed {seed}: not told\n{text}{job.told()}"
        seen.add(told)
    assert seen == {True, False}
