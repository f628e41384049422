"""Jobs of the corpus on the virtual board: plain, with feed holds and overrides, stopped anywhere."""

import random
import tomllib
from collections import Counter
from pathlib import Path

import pytest

from gproof.backend import runtime
from gproof.backend.boards.virtual import VirtualBoard
from gproof.backend.job import Job
from gproof.backend.record import Result, problems
from gproof.backend.runs import expand, position_at
from gproof.backend.runtime import Hold
from gproof.cli.compile import lower
from gproof.cli.session import Running, open_session
from gproof.ir.verdict import Verdict
from gproof.verify.stream import validate

CORPUS = Path(__file__).resolve().parents[2] / "corpus" / "eding"
SAMPLE = (
    "drilled-plate", "operator-stops", "guilloche-engraving", "pcb-height-map", "slots-with-g92", "engraved-cylinder",
)  # fmt: skip


def compiled(name: str) -> Job | None:
    """None: there is no stream that the validator accepts (offsets that nobody stated, say)."""
    folder = CORPUS / name
    expected = tomllib.loads((folder / "expect.toml").read_text(encoding="utf-8"))
    setup = expected.get("setup", "zero")
    session = open_session(
        folder / "job.cnc",
        machine=folder / expected["machine"],
        setup=setup if setup == "zero" else str(folder / setup),
        dialect=None,
    )
    lowered = lower(session, Running(1_000_000), "stream")
    if lowered.stream is None:
        return None
    report = validate(lowered.stream, lowered.trace, session.machine, session.setup)
    if report.verdict is not Verdict.SAFE:
        return None
    return Job(
        name=name,
        certificate="00" * 32,
        trace=lowered.trace,
        machine=session.machine,
        setup=session.setup,
        stream=lowered.stream,
    )


def on_a_board(what: Job, **more):
    board = VirtualBoard.for_machine(what.machine, len(what.stream.motors))
    record = runtime.walk(what, board, **more)
    assert list(problems(record, what)) == []
    assert record.observed.clean
    return record


def check(what: Job, seed: int, rounds: int, monkeypatch: pytest.MonkeyPatch) -> None:
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
    check(what, 1, 2, monkeypatch)


@pytest.mark.soak
@pytest.mark.parametrize("name", sorted(p.name for p in CORPUS.iterdir() if (p / "expect.toml").is_file()))
def test_all_jobs_of_the_corpus(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    verdict = tomllib.loads((CORPUS / name / "expect.toml").read_text(encoding="utf-8"))["verdict"]
    what = compiled(name) if verdict == "SAFE" else None
    if what is not None:
        check(what, 2, 8, monkeypatch)
