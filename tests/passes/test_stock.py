"""What is told of traverses, depths, shanks and holders; expected answers by hand from the geometry."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from passes.stock_jobs import FLAT, MACHINE, START, Judged

from gproof.ir.columns import Columns
from gproof.ir.workpiece import TRIANGLES, Box, Mesh
from gproof.passes import stock

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
    assert "nobody stated the shape of tool 1" in job.findings.kept[0].message
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
