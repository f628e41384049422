"""What the job before may have left on: stated by this job, or an assumption that is printed. Never neither."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from passes.interpret.core.programs import HEAD

from gproof.driver.running import begin
from gproof.frontend.eding.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.machine import NO_MACHINE, Controller, Machine, Spindle, Tool
from gproof.ir.setup import NOTHING, ZERO, Setup

FULL = f"G69 G50 G98\n{HEAD}F100\n"
"""All of it stated."""
LATHE_TOOL = dataclasses.replace(NO_MACHINE, tools=(Tool(number=1, length=10.0, x_offset=4.0),))
LATHE = dataclasses.replace(NO_MACHINE, controller=Controller(turning=True, xz_seen_from="+y"))
HEADS = dataclasses.replace(NO_MACHINE, spindles=(Spindle(number=0), Spindle(number=1, offset=(80.0, 0.0, 0.0))))

CASES = {
    "nothing left": (FULL + "G0 X1\nG81 X1 R2 Z1\n", NO_MACHINE, []),
    "G40": (FULL.replace(" G40", "") + "G0 X1\n", NO_MACHINE, ["no cutter compensation (G41)"]),
    "G40 and G69": (
        FULL.replace(" G40", "").replace("G69 ", "") + "G0 X1\n", NO_MACHINE,
        ["no rotation (G68)", "no cutter compensation (G41)"],
    ),
    "three": ("G21 G90 G49\nG0 X1\n", NO_MACHINE, ["no rotation (G68) and no scaling", "no cutter"]),
    "G49 where tools have offsets in X": (
        FULL.replace(" G49", "") + "G0 X1\n", LATHE_TOOL, ["no X offset of a tool (G43)"],
    ),
    "G49 where they have none": (FULL.replace(" G49", "") + "G0 X1\n", NO_MACHINE, []),
    "G49 on a lathe": (
        FULL.replace(" G49", "") + "G0 X1\n",
        dataclasses.replace(NO_MACHINE, controller=Controller(turning=True)), ["no X offset of a tool (G43)"],
    ),
    "G43.1": (FULL.replace("G49", "G43.1 I1") + "G0 X1\n", LATHE_TOOL, []),
    "G17": (FULL.replace(" G17", "") + "G0 X1\nG2 X3 R1\n", NO_MACHINE, ["the job starts in the XY plane (G17)"]),
    "G18 on a lathe": (FULL.replace(" G17", "") + "G0 X1\nG2 X3 R1\n", LATHE, ["the job starts in the XZ plane (G18)"]),
    "G98": (FULL.replace(" G98", "") + "G0 X1\nG81 X1 R2 Z1\n", NO_MACHINE, ["return to the initial level"]),
    "G98 without a cycle": (FULL.replace(" G98", "") + "G0 X1\n", NO_MACHINE, []),
    "G99 behind the first cycle": (
        FULL.replace(" G98", "") + "G0 X1\nG81 X1 R2 Z1\nG99 X2\n", NO_MACHINE, ["return to the initial level"],
    ),
    "M90": (FULL + "G0 X1\n", HEADS, ["the first spindle (M90)"]),
    "M90 stated": (FULL + "M90\nG0 X1\n", HEADS, ["the first spindle (M90)"]),
    "G92.3": (FULL + "G92.3\nG0 X1\n", NO_MACHINE, []),
    "G92.3 behind G92.2": (FULL + "G92.2\nG92.3\nG0 X1\n", NO_MACHINE, []),
    "G92.3 behind G92": (FULL + "G92 X1\nG92.2\nG92.3\nG0 X1\n", NO_MACHINE, []),
    "G92.3 behind G92.1": (FULL + "G92.1\nG92.3\nG0 X1\n", NO_MACHINE, []),
    "units of G92": ("G69 G50 G90 G40 G49\nG92 X1\nG21\nG0 X1\n", NO_MACHINE, ["starts in millimetres"]),
    "units of G10": ("G69 G50 G90 G40 G49\nG10 L2 P1 X1\nG20\nG0 X1\n", NO_MACHINE, ["starts in millimetres"]),
    "distances of G28": (FULL.replace(" G90", "") + "G28 X1\nG90\nG0 X1\n", NO_MACHINE, ["absolute distances (G90)"]),
    "G28 alone": (FULL.replace(" G90", "").replace(" G40", "") + "G28\n", NO_MACHINE, []),
}  # fmt: skip


def assumed(folder: Path, text: str, machine: Machine, setup: Setup) -> list[str]:
    job = folder / "job.cnc"
    job.write_text(text + "M30\n")
    program = load_program(job, Findings())
    assert program is not None
    executor = begin(program, setup, machine, Findings())
    list(executor.chunks())
    return list(executor.assumed)


@pytest.mark.parametrize("case", CASES)
def test_what_the_job_before_left_on(case: str, tmp_path: Path) -> None:
    """3.5.1: M30 ends compensation and chooses G17, G90 and G94; M2 and a stopped job end nothing."""
    text, machine, expected = CASES[case]
    told = assumed(tmp_path, text, machine, NOTHING)
    assert len(told) == len(expected), told
    for sentence, part in zip(told, expected, strict=True):
        assert part in sentence
    if case != "M90 stated":
        zero = [said for said in assumed(tmp_path, text, machine, ZERO) if "in force" in said or "spindle" in said]
        assert zero == []
