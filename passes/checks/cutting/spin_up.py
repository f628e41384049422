"""Which outputs run a spindle, time from its start to the first cut, and what of a job's devices goes from section to
section."""

from __future__ import annotations

import copy
import math
from collections.abc import Collection

import numpy as np

from gproof.ir.machine import Machine
from gproof.ir.program import Program
from gproof.ir.record import record
from gproof.ir.trace import Chunk, Op
from gproof.passes.checks.tooling.cutting_rows import Bools, Floats


@record(frozen=True, slots=True)
class Runs:
    """Outputs that run the spindle; its direction by those that are on. ``told``: why, when no machine file does."""

    forward: frozenset[int] = frozenset()
    backward: frozenset[int] = frozenset()
    told: str = ""

    @property
    def channels(self) -> frozenset[int]:
        """All of them."""
        return self.forward | self.backward

    def turns(self, on: frozenset[int]) -> float:
        """1 forwards, -1 backwards, 0 at rest; NaN where only some of those are on that start it together."""
        if not on:
            return 0.0
        back = bool(self.backward) and self.backward <= on
        if self.forward and self.forward <= on and not (back and self.forward < self.backward):
            return 1.0
        return -1.0 if back else math.nan


def runs_of(program: Program, machine: Machine) -> Runs:
    """What runs the spindle where no code of the language does: what the machine file says, else the definitions."""
    first, found = machine.spindle(0), program.spindle_outputs
    if first is not None and first.output is not None:
        return Runs(frozenset((first.output,)))
    channels = sorted({*found.forward, *found.backward})
    if not channels:
        return Runs()
    many = len(channels) > 1
    named = f"outputs {' and '.join(map(str, channels))} run" if many else f"output {channels[0]} runs"
    told = f"{named} the spindle: the shop's own start code switches {'them' if many else 'it'} on, and its stop off"
    return Runs(frozenset(found.forward), frozenset(found.backward), told)


BY_CODE = -1
"""What has coolant on where no output has."""


@record(slots=True)
class Started:
    """A spindle on its way to its speed. needed: seconds it takes; seconds: those that are over for certain."""

    needed: float
    seconds: float


@record(slots=True)
class Flow:
    """What one section leaves to the next.

    on, rpm: outputs that run the spindle and are on, the speed that was set; turns: the direction of the last order
    to the spindle; started: it may be on its way to its speed; wet: what has coolant on, outputs or a code of the
    language (``BY_CODE``), wet_from: since this row of the chunk. cutting: the last move was a cut.
    """

    on: frozenset[int] = frozenset()
    rpm: float = math.nan
    turns: float = 0.0
    started: Started | None = None
    wet: frozenset[int] = frozenset()
    wet_from: int = 0
    cutting: bool = False

    def copy(self) -> Flow:
        """Another one, to go on with."""
        other = copy.copy(self)
        other.started = copy.copy(self.started)
        return other

    def joined(self, other: Flow) -> Flow:
        """Where two ways come together: what is worse of both."""
        one = self.copy()
        one.on = self.on & other.on
        one.rpm = self.rpm if self.rpm == other.rpm else math.nan
        one.turns = self.turns if self.turns == other.turns else 0.0
        late = [s for s in (self.started, other.started) if s is not None]
        one.started = copy.copy(max(late, key=lambda s: s.needed - s.seconds, default=None))
        one.wet = self.wet | other.wet if self.wet and other.wet else frozenset()
        return one


def reached(chunk: Chunk, cut: Bools, begin: int, outputs: Collection[int]) -> int:
    """The first row from ``begin`` that cuts or gives the spindle an order; the number of rows when none does."""
    rows = chunk.rows
    stops = cut[begin:] | (rows["op"][begin:] == Op.SPINDLE)
    if outputs:
        stops = stops | ((rows["op"][begin:] == Op.OUTPUT) & np.isin(rows["arg"][begin:, 0], list(outputs)))
    found = np.flatnonzero(stops)
    return begin + int(found[0]) if found.size else len(rows)


def waited(chunk: Chunk, way: Floats, begin: int, end: int, machine: Machine) -> float:
    """Seconds that rows take at least: dwells, and moves with each axis as fast as it can.

    A move of an axis whose velocity or way is not known may take no time at all.
    """
    rows = chunk.rows
    dwell = rows["op"][begin:end] == Op.DWELL
    seconds = float(np.nansum(rows["arg"][begin:end, 0][dwell]))
    moves = rows["op"][begin:end] < Op.DWELL
    longest = np.zeros(int(moves.sum()))
    for axis in machine.axes:
        if axis.max_velocity is not None:
            time = np.abs(way[begin:end][moves][:, axis.index]) / axis.max_velocity
            longest = np.fmax(longest, time)
    return seconds + float(longest.sum())
