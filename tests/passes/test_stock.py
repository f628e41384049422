"""What is told of traverses, depths, shanks and holders; expected answers by hand from the geometry."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from passes.stock_jobs import FLAT, Judged

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
