"""The registry of patterns: a line each; for one feature they are tried in this order."""

from __future__ import annotations

from gproof.passes.legalize.pattern import Pattern
from gproof.passes.legalize.patterns import (
    arcs,
    choices,
    constants,
    cycles,
    devices,
    frames,
    grids,
    inputs,
    inverse_time,
    lengths,
    local_offsets,
    loops,
    machine_moves,
    nothing_on,
    operators,
    paths,
    places,
    routines,
    straight_rapids,
    transforms,
)

PATTERNS: tuple[Pattern, ...] = (
    *grids.PATTERNS,
    *routines.PATTERNS,
    *inputs.PATTERNS,
    *choices.PATTERNS,
    *loops.PATTERNS,
    *constants.PATTERNS,
    *operators.PATTERNS,
    *straight_rapids.PATTERNS,
    *cycles.PATTERNS,
    *arcs.PATTERNS,
    *transforms.PATTERNS,
    *frames.PATTERNS,
    *places.PATTERNS,
    *paths.PATTERNS,
    *local_offsets.PATTERNS,
    *devices.PATTERNS,
    *inverse_time.PATTERNS,
    *machine_moves.PATTERNS,
    *nothing_on.PATTERNS,
    *lengths.PATTERNS,
)
