"""The feeder: everything once, in time, never beyond what was asked."""

import pytest
from backend.streams import events_of, runs_of, sections, steps_of
from backend.test_virtual_board import reference
from hypothesis import given
from hypothesis import strategies as st

from gproof.backend.boards.board import BoardError
from gproof.backend.boards.virtual import VirtualBoard
from gproof.backend.feed import Feeder, Words
from gproof.backend.retime import Spacing, retime
from gproof.backend.time_map import MapBuilder
from gproof.ir.stream import StreamSection


class Store:
    """A board that only remembers."""

    def __init__(self, motors: int) -> None:
        self.steps: list[list[tuple[int, int]]] = [[] for _ in range(motors)]
        self.runs = 0
        self.events: list[int] = []
        self.greatest_count = self.greatest_add = 0

    def queue_runs(self, motor: int, runs) -> None:
        self.greatest_count = max(self.greatest_count, int(runs["count"].max()))
        self.greatest_add = max(self.greatest_add, int(abs(runs["add"]).max()))
        last = self.steps[motor][-1][0] if self.steps[motor] else 0
        self.steps[motor] += [(last + t, d) for t, d in steps_of(runs)]
        self.runs += len(runs)

    def queue_event(self, tick: int, row: int, op: int, arg: tuple[int, int]) -> None:
        self.events.append(tick)


@given(
    sections(),
    st.lists(st.tuples(st.integers(3, 12), st.integers(1, 3000)), max_size=30),
    st.integers(1, 9),
    st.integers(0, 40),
)
def test_everything_is_sent_once_and_never_too_early(
    section: StreamSection, fills: list[tuple[int, int]], most: int, growth: int
) -> None:
    board, feeder, until = Store(len(section.runs)), Feeder(section, Words(count=most, add=growth)), 0
    for free, more in [*fills, (10**6, 10**9)]:
        until += more
        runs = board.runs
        feeder.fill(board, free, until)
        assert board.runs - runs <= free
        assert board.greatest_count <= most
        assert board.greatest_add <= growth
        sent = [s for steps in board.steps for s in steps]
        assert all(t <= until for t, _ in sent)
        assert feeder.sent_until == max((t for t, _ in sent), default=0)
        left = [
            steps_of(runs)[len(done)][0]
            for runs, done in zip(section.runs, board.steps, strict=True)
            if len(done) < len(steps_of(runs))
        ] + section.events["tick"].tolist()[len(board.events) :]
        assert feeder.next_due == (min(left) if left else None)
    assert board.steps == [steps_of(runs) for runs in section.runs]
    assert board.events == section.events["tick"].tolist()


@given(sections(), st.integers(0, 30_000), st.integers(1, 5000))
def test_the_rest_can_be_retimed_after_some_was_sent(section: StreamSection, until: int, ticks: int) -> None:
    board, feeder = Store(len(section.runs)), Feeder(section)
    feeder.fill(board, 10**6, until)
    build = MapBuilder()
    build.shift(feeder.sent_until)
    build.rest(ticks)
    late = retime(section, build.done(), Spacing(gap=1, setup=1, tolerance=0))
    rest = Feeder(late)
    rest.follow(feeder)
    rest.fill(board, 10**6, 10**9)
    assert board.steps == [steps_of(runs) for runs in late.runs]


def test_a_section_that_differs_in_what_was_sent_is_refused() -> None:
    section = StreamSection(
        number=0,
        start=(0,),
        runs=(runs_of([(5, 9, 0, 1)]),),
        events=events_of([]),
        duration=50,
    )
    feeder = Feeder(section)
    feeder.fill(Store(1), 9, 20)
    build = MapBuilder()
    build.to(10, 30)
    with pytest.raises(ValueError, match="was sent"):
        Feeder(retime(section, build.done(), Spacing(gap=1, setup=1, tolerance=0))).follow(feeder)


@given(sections(motors=2), st.integers(4, 40))
def test_a_small_fifo_is_fed_in_order(section: StreamSection, depth: int) -> None:
    board = VirtualBoard(2, fifo_runs=depth)
    board.open()
    feeder = Feeder(section)
    base = board.start_section(0, section.start, 0)
    while (due := feeder.next_due) is not None:
        now = board.status().tick - base
        feeder.fill(board, board.status().free, now + 1000)
        due = feeder.next_due
        if due is None:
            board.finish_section(section.duration)
        else:
            board.commit(due - 1)
        board.wait(base + now + max(1, ((due or section.duration) - 1 - now) // 2))
        now = board.status().tick - base
        assert board.status().position == reference(section, now)
        assert not board.status().state.over, board.status().reason


@pytest.mark.parametrize(
    ("run", "words", "sent"),
    [
        ((100, 65_536, 0, 1), Words(count=65_535), [(100, 65_535, 0, 1), (100, 1, 0, 1)]),
        ((50_000, 3, 32_768, 1), Words(add=32_767), [(50_000, 1, 0, 1), (82_768, 1, 0, 1), (115_536, 1, 0, 1)]),
        ((500_000, 3, -40_000, -1), Words(add=32_767), [(500_000, 1, 0, -1), (460_000, 1, 0, -1), (420_000, 1, 0, -1)]),
        ((50_000, 3, 32_767, 1), Words(add=32_767), [(50_000, 3, 32_767, 1)]),
        ((50_000, 1, 99_999, 1), Words(add=32_767), [(50_000, 1, 0, 1)]),
    ],
)
def test_runs_are_split_to_the_words_of_a_board(run, words: Words, sent) -> None:  # type: ignore[no-untyped-def]
    section = StreamSection(number=0, start=(0,), runs=(runs_of([run]),), events=events_of([]), duration=2**40)
    reached = []

    class Board(Store):
        def queue_runs(self, motor: int, runs) -> None:  # type: ignore[no-untyped-def]
            reached.extend(tuple(int(v) for v in row) for row in runs.rows())

    Feeder(section, words).fill(Board(1), 10**6, 2**40)  # type: ignore[arg-type]
    assert reached == sent


@pytest.mark.parametrize(
    ("run", "words"),
    [
        ((2**32, 1, 0, 1), Words(interval=2**32 - 1)),
        ((2**31, 3, 2**31, 1), Words(interval=2**32 - 1)),
        ((2**20, 2**40, 0, 1), Words(count=65_535)),
        ((2**20, 10**8, 1, 1), Words(add=0)),
    ],
)
def test_what_no_words_hold_is_refused(run, words: Words) -> None:  # type: ignore[no-untyped-def]
    section = StreamSection(number=0, start=(0,), runs=(runs_of([run]),), events=events_of([]), duration=2**60)
    with pytest.raises(BoardError):
        Feeder(section, words)
