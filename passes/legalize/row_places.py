"""Places before and after each row of a table of moves."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gproof.ir.columns import Array
from gproof.ir.job import MM, Moves
from gproof.ir.machine import AXIS_NAMES


def positions(moves: Moves, place: Mapping[str, float]) -> tuple[Array, Array]:
    """Places in the unit of a table before and after each row, (rows, 6); NaN where that of an axis is not known."""
    rows = moves.rows
    count = len(rows)
    after = np.full((count, len(AXIS_NAMES)), np.nan)
    before = np.full((count, len(AXIS_NAMES)), np.nan)
    scale = MM[moves.unit]
    for column, axis in enumerate(AXIS_NAMES):
        unit = scale if column < 3 else 1.0
        start = place[axis] / unit if axis in place else np.nan
        named = (rows["axes"] & np.uint8(1 << column)) != 0
        values = rows["to"][:, column]
        if moves.relative:
            after[:, column] = start + np.cumsum(np.where(named, values, 0.0))
        else:
            last = np.where(named, np.arange(count), -1)
            np.maximum.accumulate(last, out=last)
            after[:, column] = np.where(last >= 0, values[np.maximum(last, 0)], start)
        before[0, column] = start
        before[1:, column] = after[:-1, column]
    return before, after
