"""X of lathes whose programs have diameters: a neutral job has places."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.columns import Columns
from gproof.ir.job import Moves


def x_times(moves: Moves, factor: float) -> Moves:
    """A table whose X numbers are so many times those of another one; centres and radii stay."""
    arrays = {name: array.copy() for name, array in moves.rows.arrays.items()}
    arrays["to"][:, 0] *= factor
    return replace(moves, rows=Columns(moves.rows.schema, arrays))
