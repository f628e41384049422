"""Run arithmetic against runs taken one step at a time."""

from backend.streams import run_rows, runs_of, sections, steps_of
from hypothesis import given
from hypothesis import strategies as st

from gproof.backend.runs import cut, done_by, ends, expand, join, position_at
from gproof.ir.columns import Columns
from gproof.ir.stream import StreamSection

tables = st.lists(run_rows(), max_size=8).map(runs_of)


@given(tables)
def test_expand_gives_every_step(runs: Columns) -> None:
    ticks, directions = expand(runs)
    assert list(zip(ticks.tolist(), directions.tolist(), strict=True)) == steps_of(runs)
    if len(runs):
        assert ends(runs)[-1] == ticks[-1]


@given(tables, st.integers(-5, 200_000))
def test_done_by_counts_the_steps_that_are_due(runs: Columns, tick: int) -> None:
    due = [(t, d) for t, d in steps_of(runs) if t <= tick]
    done = done_by(runs, tick)
    assert (done.steps, done.net) == (len(due), sum(d for _, d in due))
    assert done.last == (due[-1][0] if due else 0)


@given(tables, st.integers(0, 200_000))
def test_cut_keeps_every_step(runs: Columns, tick: int) -> None:
    before, after, last = cut(runs, tick)
    assert all(t <= tick for t, _ in steps_of(before))
    assert last == (steps_of(before)[-1][0] if len(before) else 0)
    assert all(t + last > tick for t, _ in steps_of(after))
    assert steps_of(join([before, after])) == steps_of(runs)


@given(sections())
def test_position_at_the_end_is_the_end(section: StreamSection) -> None:
    assert position_at(section, section.duration) == section.end()
    assert position_at(section, 0) == section.start
