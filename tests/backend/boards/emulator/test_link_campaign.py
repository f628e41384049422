"""The whole runtime on a faulty link, judged by the board's own log; the table of outcomes is printed (-s)."""

from __future__ import annotations

import copy
from dataclasses import replace

import pytest
from backend.boards.emulator.emulated_line import EmulatedLine
from backend.boards.emulator.link_campaign import jobs, judged, ran, schedule, table
from support.campaigns import sizes

from gproof.backend.boards.emulator.emulator import Emulator, Options
from gproof.backend.boards.klipper.connection import Connection


@pytest.mark.parametrize("count", sizes(12, 5000))
def test_no_fault_makes_a_wrong_step_or_a_record_that_claims_one(count: int) -> None:
    for certified in (False, True):
        for (fault, result), times in sorted(table(range(count), certified=certified).items()):
            print(f"{'certified' if certified else 'plain':9}  {fault:18}  {result:40}  {times:6}")


def test_a_board_that_lost_step_is_found() -> None:
    for rubbish in (b"\xff\xff\xff", b"\x20\x10", b"\x7e\x00", bytes(range(200))):
        board = Emulator(Options())
        board.write(rubbish)
        board.advance(10**9)
        connection = Connection(EmulatedLine(board), lambda _: None)
        connection.synchronise()
        assert connection.identify().version


def test_the_judge_sees_what_is_wrong() -> None:
    one = jobs()[0]
    told, record = ran(one, replace(schedule(0, certified=False)[1], faults=()), [])
    assert record is not None and judged(one, told, record) == "completed, position known"
    late, turned, extra = (copy.deepcopy(told) for _ in range(3))
    late.steps.tick[100] += 1
    turned.steps.direction[100] *= -1
    for name in ("motor", "tick", "direction", "boot"):
        column = getattr(extra.steps, name)
        setattr(extra.steps, name, column[[*range(len(column)), len(column) - 1]])
    claimed = replace(record, steps=(record.steps[0] + 1, record.steps[1]))
    moved = replace(record, position=(1, 1))
    for log, told_record, why in (
        (late, record, "not at their ticks"),
        (turned, record, "a wrong direction"),
        (extra, record, "does not have"),
        (told, claimed, "were claimed"),
        (told, moved, "not that of the board"),
    ):
        with pytest.raises(AssertionError, match=why):
            judged(one, log, told_record)
