"""Cuts with a head whose spindle the job's orders tell nothing of: outputs that run a spindle run the one of Z.

WinCNC manual, G54 to G57 and Workspace: they select the heads Z, W, U and V, each with a spindle of its own or not; no
file says which output runs it. ``[spindles.1]`` to ``[spindles.3]`` of the machine file do, where it is the same one.
"""

from __future__ import annotations

import numpy as np

from gproof.ir.machine import Machine
from gproof.ir.program import Program
from gproof.ir.trace import Chunk
from gproof.passes.checks.cutting.spin_up import Runs
from gproof.passes.checks.tooling.cutting_rows import SOMEWHERE, Bools, Floats, StateColumn
from gproof.passes.geometry.machine_axes import vertical_axes

_HEADS = "ZWUV"
"""By the number of the workspace that selects it, from 1."""


class OtherHeads:
    """Tells of each row whether such a head may cut in it. hint: what would tell of its spindle."""

    def __init__(self, program: Program, machine: Machine, runs: Runs) -> None:
        upright = {machine.word(axis): axis for axis in vertical_axes(machine)}
        self._axes: dict[int, int] = {}
        """Columns by workspace."""
        hints: list[str] = []
        for number, letter in enumerate(_HEADS):
            spindle = machine.spindle(number)
            same = spindle is not None and spindle.output in runs.channels
            if number and runs.channels and program.rules.workspaces_select_heads and letter in upright and not same:
                self._axes[number + 1] = upright[letter]
                hints.append(f"[spindles.{number}]: head {letter}")
        self.hint = (
            f"state output = ... in the machine file, if the same output runs their spindle ({', '.join(hints)})"
        )
        self._selected = StateColumn(lambda state: float(state.work in self._axes))

    def rows(self, chunk: Chunk, way: Floats) -> Bools:
        """(n,): True where such a head is selected, or moves."""
        if not self._axes:
            return np.zeros(len(chunk.rows), dtype=np.bool_)
        found: Bools = self._selected.rows(chunk) != 0.0
        for axis in self._axes.values():
            found |= np.abs(way[:, axis]) > SOMEWHERE
        return found
