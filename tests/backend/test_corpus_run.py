"""Jobs of the corpus on the virtual board: plain, with feed holds and overrides, stopped anywhere."""

import random
from collections import Counter
from fractions import Fraction

import numpy as np
import pytest
from corpus.jobs import all_jobs, compiled

from gproof.backend import runtime
from gproof.backend.boards.virtual import VirtualBoard
from gproof.backend.job import CertifiedJob
from gproof.backend.record import ExecutionRecord, Result, problems
from gproof.backend.runs import expand, position_at
from gproof.backend.runtime import Hold
from gproof.ir.trace import Op

SAMPLE = (
    "eding/drilled-plate", "eding/operator-stops", "eding/guilloche-engraving", "eding/pcb-height-map",
    "eding/slots-with-g92", "eding/engraved-cylinder",
)  # fmt: skip
ONCE = (
    "mcuwin/engraver/wave", "mcuwin/dispenser/lid-bead", "mcuwin/rotary-mill/band",
    "mcuwin/rotary-mill/inch-drawing", "wincnc/knife-twohead/coupled-heads",
)  # fmt: skip
"""Of the other dialects, from the text to the board and no further."""


def on_a_board(what: CertifiedJob, **more):
    board = VirtualBoard.for_machine(what.machine, len(what.stream.motors))
    record = runtime.walk(what, board, **more)
    assert list(problems(record, what)) == []
    assert record.observed.clean
    return record


def check_end(what: CertifiedJob, record: ExecutionRecord) -> None:
    """The motors stand where the trace ends, to less than a step, and have gone as far as the runs say."""
    last = record.sections[-1].number
    section = what.trace.sections[last]
    motion = np.flatnonzero(section.rows["op"] < Op.DWELL)
    ends = section.rows["to"][motion[-1]].tolist() if len(motion) else section.start
    for place, motor in enumerate(what.stream.motors):
        assert abs(record.position[place] - Fraction(ends[motor.axis]) * motor.steps_per_unit) < 1, motor.name
        runs = [what.stream.sections[done.number].runs[place] for done in record.sections]
        assert record.steps[place] == sum(int(one["count"].sum()) for one in runs)


def check(what: CertifiedJob, seed: int, rounds: int, monkeypatch: pytest.MonkeyPatch) -> None:
    chance = random.Random(seed)
    asked: Counter[bool] = Counter()
    accept = runtime._Walk._accept

    def counted(self, section) -> bool:
        answer = accept(self, section)
        asked[answer] += 1
        return answer

    monkeypatch.setattr(runtime._Walk, "_accept", counted)
    plain = on_a_board(what)
    assert plain.result is Result.COMPLETED
    ticks = sum(s.ticks for s in plain.sections)
    for _ in range(rounds):
        hold = Hold(at=chance.randrange(ticks), rest=chance.randrange(1, what.stream.tick_frequency))
        factor = chance.choice([1, 0.1, 0.5, 0.73])
        late = on_a_board(what, hold_at=hold, override=factor)
        assert (late.result, late.steps, late.position) == (plain.result, plain.steps, plain.position)
        at = chance.randrange(ticks)
        stopped = on_a_board(what, estop_at=at)
        assert sum(s.ticks for s in stopped.sections) == at
        last = stopped.sections[-1]
        section = what.stream.sections[last.number]
        assert stopped.position == position_at(section, last.ticks)
        for runs, steps in zip(section.runs, last.steps, strict=True):
            assert steps == int((expand(runs)[0] <= last.ticks).sum())
    # The first, fastest ramp is good enough for nearly all.
    assert asked[False] <= asked[True] // 20, asked


@pytest.mark.parametrize("name", SAMPLE)
def test_jobs_of_the_corpus(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    what = compiled(name)
    assert what is not None
    check(what, 1, 1, monkeypatch)


@pytest.mark.parametrize("name", ONCE)
def test_jobs_of_other_dialects_end_where_their_traces_do(name: str) -> None:
    what = compiled(name)
    assert what is not None
    record = on_a_board(what)
    assert record.result is Result.COMPLETED
    assert sum(record.steps) > 10_000
    check_end(what, record)


@pytest.mark.soak
@pytest.mark.parametrize("name", all_jobs())
def test_all_jobs_of_the_corpus(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    what = compiled(name)
    if what is not None:
        check(what, 2, 8, monkeypatch)
