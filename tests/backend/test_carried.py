"""Relative places as they are printed: no place is further off than half of the last digit."""

from __future__ import annotations

import random

import numpy as np
import pytest
from support.jobs_by_hand import PLACE, at, cut, job, mm, rapid, run

from gproof.backend.emit.carried import carried
from gproof.ir.columns import Columns
from gproof.ir.job import MOVE, STRAIGHT, ArcTo, Choice, LoopWhile, Moves, MoveTo, Node
from gproof.ir.program import Number
from gproof.ir.target import Style

STYLE = Style(decimals_mm=3)
HALF = 0.5001e-3


def printed(node: Node) -> dict[str, float]:
    """The numbers of a move's places."""
    assert isinstance(node, MoveTo | ArcTo)
    return {place.axis: place.at.value.value for place in node.to if isinstance(place.at.value, Number)}


def table(values: list[float]) -> Moves:
    """Relative moves of X."""
    rows = Columns(MOVE, MOVE.empty(len(values)))
    rows["to"][:, 0], rows["kind"][:], rows["axes"][:], rows["feed"][:] = values, STRAIGHT, 1, np.nan
    return Moves(rows=rows, unit="mm", relative=True, span=PLACE)


@pytest.mark.parametrize("seed", range(20))
def test_no_place_is_further_off_than_half_a_digit(seed: int) -> None:
    rng = random.Random(seed)
    values = [round(rng.uniform(-0.01, 0.01), 5) for _ in range(40)]
    singly = carried(job(*(rapid(x=value, relative=True) for value in values)), STYLE)
    as_table = carried(job(table(values[:20]), table(values[20:])), STYLE)
    rows = np.concatenate([node.rows["to"][:, 0] for node in as_table.body if isinstance(node, Moves)])
    for found in ([printed(node)["x"] for node in singly.body], rows.tolist()):
        assert found == [round(value, 3) for value in found]
        assert np.abs(np.cumsum(found) - np.cumsum(values)).max() <= HALF


def test_what_does_not_move_an_axis_stays_so() -> None:
    center = at(x=5, y=0, relative=True)
    circle = ArcTo(to=at(x=0, relative=True), plane="xy", clockwise=True, center=center, span=PLACE)
    whole = carried(job(rapid(x=0.0005, relative=True), circle, rapid(x=0.0005, relative=True)), STYLE)
    assert [printed(node)["x"] for node in whole.body] == [0.0, 0.0, 0.001]


def test_an_absolute_place_starts_anew() -> None:
    """1.0004 is printed as 1: the 0.4 of a thousandth are made up for by the next relative place."""
    first, after, again = carried(
        job(rapid(x=1.0004), rapid(x=2.0004, relative=True), rapid(x=1.0004, relative=True)), STYLE
    ).body
    assert printed(first) == {"x": 1.0004}  # which the printer rounds
    assert printed(after) == {"x": 2.001}
    assert printed(again) == {"x": 1.0}


def test_nothing_is_carried_into_what_may_start_anywhere() -> None:
    by = rapid(x=0.0004, relative=True)
    loop = LoopWhile(condition=mm(1).value, body=(by, by), span=PLACE)
    found = carried(job(by, loop, by, run(), by, a=[by, by]), STYLE)
    assert isinstance(found.body[1], LoopWhile)
    # What may come again has more digits instead: its rounding would be added up.
    assert [printed(node)["x"] for node in found.body[1].body] == [0.0004, 0.0004]
    assert [printed(node)["x"] for node in found.routines["a"].body] == [0.0004, 0.0004]
    assert [printed(found.body[n])["x"] for n in (0, 2, 4)] == [0.0, 0.0, 0.0]


def test_after_a_choice_only_what_both_ways_left_out_is_carried() -> None:
    by = rapid(x=0.0004, relative=True)
    ways = Choice(condition=mm(1).value, then=(by, cut(y=1)), otherwise=(cut(y=2),), span=PLACE)
    before, choice, after = carried(job(by, ways, by), STYLE).body
    assert isinstance(choice, Choice)
    assert printed(before) == {"x": 0.0} and printed(choice.then[0]) == {"x": 0.001}
    assert printed(after) == {"x": 0.0}
