"""The extents of rows do not depend on which of them were there before: each arc by itself, or all in one walk."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from gproof.passes.geometry.extent_kernels import Extents, arc_extreme, boxed_rows, room_beyond, row_boxes


def walk(run: Any, rows: dict[str, Any], limits: tuple[Any, Any]) -> tuple[Any, ...]:
    """(extents low and high, rows of them, offences) of rows under one frame whose axes are known."""
    low, high = np.full((2, 6), np.inf), np.full((2, 6), -np.inf)
    low_row, high_row = np.full((2, 6), -1), np.full((2, 6), -1)
    bad = room_beyond(900)
    count = run(
        boxed_rows(rows), np.zeros(1, np.int64), rows["start"].copy(), np.ones((1, 6), np.uint8), *limits,
        Extents(low, high, low_row, high_row), bad, np.zeros((0, 2)),
    )  # fmt: skip
    return (
        low,
        high,
        low_row,
        high_row,
        list(zip(*(c[:count].tolist() for c in bad), strict=True)),
    )


@pytest.mark.parametrize("seed", range(4))
def test_arcs_within_what_is_known_already(seed: int) -> None:
    """Whole arcs by ``arc_extreme``, one by one, against the walk that leaves out those that can not matter."""
    rng = np.random.default_rng(seed)
    count = 300
    to = rng.uniform(-1.0, 1.0, (count, 6)) * 10.0 ** rng.uniform(-3.0, 2.0, (count, 1))
    to[:, 3:] = 0.0
    start = np.zeros(6)
    before = np.vstack([start, to[:-1]])
    plane = rng.integers(1, 4, count)
    op = rng.choice([2, 3, 10], count, p=[0.2, 0.7, 0.1])
    before_moves = before.copy()
    for row in range(1, count):  # rows that do not move stand where the one before did
        if op[row] == 10:
            to[row] = to[row - 1] if row else start
        before_moves[row] = to[row - 1]
    center = (before_moves[:, :3] + to[:, :3]) / 2 + rng.normal(0.0, 0.5, (count, 3))
    # Points right on the axes of their circle, where rounding may put them outside of it.
    for row in range(0, count, 7):
        center[row] = before_moves[row, :3] + [rng.uniform(-1, 1), 0.0, 0.0]
    rows = {
        "op": op.astype(np.uint8), "to": to, "center": center, "turns": rng.choice([-2, -1, 1, 2], count),
        "plane": plane.astype(np.uint8), "frame": np.zeros(count, np.int32), "state": np.zeros(count, np.int32),
        "start": start,
    }  # fmt: skip
    limits = np.full((2, 6), -30.0), np.full((2, 6), 45.0)
    low, high, low_row, high_row, bad = (np.full(6, np.inf), np.full(6, -np.inf), np.full(6, -1), np.full(6, -1), [])
    for row in range(count):
        if op[row] >= 10:
            continue
        least, most = to[row].copy(), to[row].copy()
        if op[row] == 3:
            u, v = {1: (0, 1), 2: (2, 0), 3: (1, 2)}[int(plane[row])]
            cu, cv = center[row, u], center[row, v]
            ends = [before_moves[row, u] - cu, before_moves[row, v] - cv, to[row, u] - cu, to[row, v] - cv]
            a, b, c, d, _ = arc_extreme.python(*ends, int(rows["turns"][row]))
            least[[u, v]] = np.minimum(least[[u, v]], [cu + a, cv + c])
            most[[u, v]] = np.maximum(most[[u, v]], [cu + b, cv + d])
        low_row[least < low], high_row[most > high] = row, row
        low, high = np.minimum(low, least), np.maximum(high, most)
        for axis in range(6):
            bad += [(row, axis, least[axis])] if least[axis] < -30.0 else []
            bad += [(row, axis, most[axis])] if most[axis] > 45.0 else []
    assert len(bad) > 20
    for run in (row_boxes, row_boxes.compiled()):
        found = walk(run, rows, limits)
        assert found[0][0].tobytes() == low.tobytes()
        assert found[1][0].tobytes() == high.tobytes()
        assert (found[2][0].tolist(), found[3][0].tolist()) == (low_row.tolist(), high_row.tolist())
        assert found[4] == bad
