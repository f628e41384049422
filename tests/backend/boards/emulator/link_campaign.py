"""Seeded schedules of faults between a host and an emulated board, and the verdict of the board's own log on each.

A schedule is a seed: the board's clock, its profile, noise on the line, a fault at a moment of the motion, and stalls
of the host. The verdict: every step in the log is the stream's next one, at its tick; nothing of a later section; and
the record claims no more than was made, and says of each position whether it is known.
"""

from __future__ import annotations

import contextlib
import random
from collections import Counter
from dataclasses import replace
from functools import cache
from unittest import mock

from backend.boards.emulator.emulated_line import EmulatedLine
from backend.jobs import job
from backend.streams import FREQUENCY, steps_of

from gproof.backend.boards.board import BoardError
from gproof.backend.boards.emulator.emulator import Emulator, Options
from gproof.backend.boards.emulator.faults import Noise, parsed
from gproof.backend.boards.emulator.log_reader import Told, read
from gproof.backend.boards.klipper import driver
from gproof.backend.boards.klipper.driver import KlipperBoard
from gproof.backend.boards.klipper.wiring import MotorPins, Wiring
from gproof.backend.job import CertifiedJob
from gproof.backend.record import parse_record, problems
from gproof.backend.record_data import TRUSTED, ExecutionRecord, Result
from gproof.backend.record_proof import Proof, proof_of, sent
from gproof.backend.runtime import walk

PINS = (0, 2)
"""Step pins of the two motors: PA0, PA2."""

WIRING = Wiring(motors=[MotorPins(step=f"PA{pin}", direction=f"PA{pin + 1}") for pin in PINS])

FAULTS = (
    "", "", "drop to-board {n}", "drop to-host {n}", "flip to-board {n}", "flip to-host {n}", "double to-board {n}",
    "double to-host {n}", "delay to-board {s}", "delay to-host {s}", "drop to-board {burst}", "drop to-host {burst}",
    "close {s}", "close {long}", "shutdown", "reset", "brown-out {s}", "stall {s}",
)  # fmt: skip


@cache
def jobs() -> tuple[CertifiedJob, ...]:
    """Two and three sections of some hundred steps, one motor at rest at times."""
    ways = (
        ([(0.8, 0.5), (1.5, -0.4)], [(0.3, 0.2)]),
        ([(1.0, 0.0)], [(1.0, 1.5), (0.0, 1.5)], [(0.0, 0.0)]),
    )
    made = [job(*way) for way in ways]
    return tuple(replace(one, accepted=TRUSTED, machine_at_hand=True, setup_at_hand=True) for one in made)


def schedule(seed: int, *, certified: bool) -> tuple[str, Options, list[tuple[float, float]]]:
    """What a seed means: its fault, the board, the host's stalls."""
    random_ = random.Random(seed)
    kind = random_.choice(FAULTS)
    if kind:
        size = {"n": random_.randint(1, 5), "burst": random_.randint(20, 200), "s": random_.choice((0.002, 0.05, 0.3))}
        kind = kind.format(**size, long=random_.choice((3, 30)))
    at = random_.uniform(0, 0.6)
    noise = Noise()
    if random_.random() < 0.3:
        noise = Noise(*(random_.choice((0, 1e-4, 1e-3)) for _ in range(3)), bursts=random_.choice((0, 1e-4)))
    stalls = []
    if random_.random() < 0.25:
        stalls.append((random_.uniform(0.2, 0.9), random_.choice((0.1, 0.3, 1.0, 5.0))))
    options = Options(
        certified=certified,
        frequency=FREQUENCY,
        baud=1_000_000,
        drift=random_.randint(-200_000, 200_000),
        wander=random_.choice((0, 30_000)),
        jitter=random_.choice((0, 300_000)),
        start=random_.choice((0, 2**32 - random_.randint(1, 1_200_000))),
        seed=seed,
        noise=noise,
        faults=tuple(parsed(f"motion+{at:.4f} {kind}")) if kind else (),
    )
    name = kind.split(" ")[0] + (" " + kind.split(" ")[1] if "to-" in kind else "")
    return name or ("noise" if noise.any else "stalled host" if stalls else "none"), options, stalls


def judged(certified: CertifiedJob, told: Told, record: ExecutionRecord) -> str:
    """The outcome, with where the position is: known, or unknown. AssertionError: the board or the record is wrong."""
    sections = certified.stream.sections
    wanted = [[steps_of(section.runs[k]) for section in sections] for k in range(len(PINS))]
    made = [list(zip(*(part.tolist() for part in told.steps.of(pin)), strict=True)) for pin in PINS]
    boots = [told.steps.boot[told.steps.motor == pin].tolist() for pin in PINS]
    left = [0] * len(PINS)
    over = False
    for number in range(len(sections)):
        bases = set()
        for k, steps in enumerate(wanted):
            here = made[k][left[k] : left[k] + len(steps[number])]
            assert not (over and here), "steps of a section after a loss"
            assert [d for _, d in here] == [d for _, d in steps[number][: len(here)]], "a wrong direction"
            bases |= {(tick - due, boots[k][left[k]]) for (tick, _), (due, _) in zip(here, steps[number], strict=False)}
            left[k] += len(here)
        assert len(bases) < 2, f"steps are not at their ticks: {bases}"
        over = over or left != [sum(map(len, steps[: number + 1])) for steps in wanted]
    assert left == [len(steps) for steps in made], "steps that the stream does not have"
    assert all(claimed <= count for claimed, count in zip(record.steps, left, strict=True)), "steps were claimed"
    if record.position is not None:
        position = tuple(s + sum(d for _, d in steps) for s, steps in zip(sections[0].start, made, strict=True))
        assert record.position == position, "a position that is not that of the board"
    if record.result is Result.COMPLETED:
        assert not over and record.position is not None
    proved(certified, record, left)
    return f"{record.result.value}, position {'known' if record.position is not None else 'unknown'}"


def proved(certified: CertifiedJob, record: ExecutionRecord, made: list[int]) -> None:
    """The record fits its job; of what it says of steps nothing is more than was made, and nothing too little."""
    wrong = [*problems(record, certified)]
    assert not wrong, wrong
    assert parse_record(record.to_json()) == record
    least, most, unknown = [0] * len(PINS), [0] * len(PINS), False
    for done in record.sections:
        section = sent(done, certified.stream.sections[done.number], certified)
        for k, one in enumerate(proof_of(done, section, record)):
            exact = one.proof is not Proof.UNKNOWN
            least[k] += one.steps
            most[k] += one.steps if one.most is None else one.most
            unknown |= not exact and one.most is None
            if record.board.counting is not None and done.outcome is Result.COMPLETED:
                assert one.proof is Proof.PROVED
    assert all(a <= b for a, b in zip(least, made, strict=True)), "more is claimed than was made"
    assert unknown or all(a >= b for a, b in zip(most, made, strict=True)), f"{made} made, {most} at most"


def ran(one: CertifiedJob, options: Options, stalls: list[tuple[float, float]]) -> tuple[Told, ExecutionRecord | None]:
    """The board's log and the host's record of a job; no record where the board could not be opened."""
    board = Emulator(options)
    line = EmulatedLine(board, stalls)
    record = None
    with mock.patch.object(driver, "FIND_PAUSE", 0.0), contextlib.suppress(BoardError):
        record = walk(one, KlipperBoard(line.connect, WIRING, pulse=2, direction_setup=5))
    # What the board still does when nobody is there any more belongs to its log.
    board.advance(board.now + 40 * 10**9)
    board.finish()
    return read(board.log.held), record


def outcome(seed: int, *, certified: bool) -> tuple[str, str]:
    """The fault and the outcome of one schedule."""
    name, options, stalls = schedule(seed, certified=certified)
    one = jobs()[seed % len(jobs())]
    told, record = ran(one, options, stalls)
    if record is None:
        assert not len(told.steps.tick), "a board that could not be opened moved"
        return name, "not opened, nothing moved"
    return name, judged(one, told, record)


def table(seeds: range, *, certified: bool) -> Counter[tuple[str, str]]:
    """How often each outcome of each fault was seen; AssertionError with the seed."""
    found: Counter[tuple[str, str]] = Counter()
    for seed in seeds:
        try:
            found[outcome(seed, certified=certified)] += 1
        except AssertionError as error:
            raise AssertionError(f"seed {seed}, certified {certified}: {error}") from error
    return found
