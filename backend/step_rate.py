"""Whether a section asks a board for steps faster than its processor makes them, exactly, before anything moves.

A board states how many steps a second of all its motors together it makes on their ticks. Motors that keep to that
rate together may still step at one moment: in any time of T seconds there may be one step of each more than rate * T,
and of one motor alone one more. A quarter of a step is left for ticks that are rounded.
"""

from __future__ import annotations

import numpy as np

from gproof.backend.step_rate_kernels import BEGIN, MOTOR, STEPS, TICK, crowded
from gproof.ir.record import record
from gproof.ir.stream import StreamSection


@record(frozen=True, slots=True, kw_only=True)
class TooFast:
    """The first step that is too many. tick: of the section; motor: the one that is too fast alone, -1 for all
    together; begin: tick of the first of ``steps`` steps that come too fast."""

    tick: int
    motor: int
    begin: int
    steps: int


def too_fast(section: StreamSection, rate: int, tick_frequency: int) -> TooFast | None:
    """The first step of a section that comes too fast for a board of ``rate`` steps a second; None: there is none."""
    motors = len(section.runs)
    columns = [
        np.concatenate([runs[name].astype(np.int64) for runs in section.runs]) for name in ("interval", "count", "add")
    ]
    places = np.cumsum([0, *(len(runs) for runs in section.runs)], dtype=np.int64)
    found = np.zeros(4, dtype=np.int64)
    kernel = crowded.pick(int(columns[1].sum()))
    state = np.zeros((motors + 1, 7), dtype=np.int64)
    if not kernel(columns[0], columns[1], columns[2], places, rate, tick_frequency, state, found):
        return None
    return TooFast(tick=int(found[TICK]), motor=int(found[MOTOR]), begin=int(found[BEGIN]), steps=int(found[STEPS]))


def too_fast_text(found: TooFast, rate: int, tick_frequency: int, section: StreamSection, names: list[str]) -> str:
    """In words. names: of the motors."""
    who = "all motors together" if found.motor < 0 else f"motor {names[found.motor]}"
    took = (found.tick - found.begin) / tick_frequency * 1000
    seconds = found.tick / tick_frequency
    return (
        f"section {section.number}, {seconds:.3f} s after its start (tick {found.tick}): {who} would"
        f" make {found.steps} steps in {took:.3f} ms, and it makes {rate} steps a second"
    )
