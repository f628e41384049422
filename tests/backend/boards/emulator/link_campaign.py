"""Seeded schedules of faults between a host and an emulated board, and the verdict of the board's own log on each.

A schedule is a seed: the board's clock, its profile, noise on the line, a fault at a moment of the motion, and what
happens to the host: it is stalled, killed at a write, its disk is full, another host wants the port. The verdict: every
step in the log is the stream's next one, at its tick; nothing of a later section; and the record, made from the journal
where the host was killed, claims no more than was made, and says of each position whether it is known.
"""

from __future__ import annotations

import contextlib
import random
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from unittest import mock

import numpy as np
from backend.boards.emulator.emulated_line import EmulatedLine, FrailHost, Killed
from backend.jobs import job
from backend.streams import FREQUENCY, steps_of

from gproof.backend import journal as journals
from gproof.backend.boards.board import BoardError
from gproof.backend.boards.emulator.emulator import Emulator, Options
from gproof.backend.boards.emulator.faults import Noise, parsed
from gproof.backend.boards.emulator.log_reader import Steps, Told, read
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

OF_BOARD = (
    "", "drop to-board {n}", "drop to-host {n}", "flip to-board {n}", "flip to-host {n}", "double to-board {n}",
    "double to-host {n}", "delay to-board {s}", "delay to-host {s}", "drop to-board {burst}", "drop to-host {burst}",
    "close {s}", "close {long}", "shutdown", "reset", "brown-out {s}", "stall {s}",
)  # fmt: skip
"""Faults of the line and the board."""

OF_HOST = ("host stalled", "host killed", "host killed, then another", "disk full", "two hosts")

WRITES, NOTES = 200, 24
"""About as many writes does a host make in a run, and so many of them into its journal."""


@cache
def jobs() -> tuple[CertifiedJob, ...]:
    """Two and three sections of some hundred steps, one motor at rest at times."""
    ways = (
        ([(0.8, 0.5), (1.5, -0.4)], [(0.3, 0.2)]),
        ([(1.0, 0.0)], [(1.0, 1.5), (0.0, 1.5)], [(0.0, 0.0)]),
    )
    made = [job(*way) for way in ways]
    return tuple(replace(one, accepted=TRUSTED, machine_at_hand=True, setup_at_hand=True) for one in made)


@dataclass
class Schedule:
    """What a seed means. stalls: of the host; taken: host seconds between which another program has the port;
    visits: when another host tries to open it; again: another host runs a job so many seconds after this one."""

    name: str
    options: Options
    host: FrailHost
    stalls: list[tuple[float, float]] = field(default_factory=list)
    taken: tuple[float, float] = (0.0, 0.0)
    visits: list[float] = field(default_factory=list)
    again: float | None = None


def schedule(seed: int, *, certified: bool) -> Schedule:
    """What a seed means: its fault, the board, what happens to the host."""
    random_ = random.Random(seed)
    kind = random_.choice((*OF_BOARD, *OF_HOST, *OF_HOST))
    of_host, found = kind in OF_HOST, Schedule("", Options(), FrailHost())
    name = kind if of_host else kind.split(" ")[0] + (" " + kind.split(" ")[1] if "to-" in kind else "")
    noisy = random_.random() < 0.3
    if of_host:
        # One in three of them with a fault of the line or the board in addition.
        kind = random_.choice(OF_BOARD) if random_.random() < 0.3 else ""
    if kind:
        size = {"n": random_.randint(1, 5), "burst": random_.randint(20, 200), "s": random_.choice((0.002, 0.05, 0.3))}
        kind = kind.format(**size, long=random_.choice((3, 30)))
    at = random_.uniform(0, 0.6)
    noise = Noise()
    if noisy:
        noise = Noise(*(random_.choice((0, 1e-4, 1e-3)) for _ in range(3)), bursts=random_.choice((0, 1e-4)))
    if name == "host stalled" or random_.random() < 0.1:
        for _ in range(random_.choice((1, 1, 1, 2, 3))):
            found.stalls.append((random_.uniform(0.2, 3.0), random_.choice((0.1, 0.3, 1.0, 2.5, 5.0))))
        found.stalls.sort()
    if name.startswith("host killed"):
        found.host.kill_at, found.host.half = random_.randint(1, WRITES), random_.random() < 0.5
    if name == "disk full":
        first = random_.randint(1, NOTES)
        found.host.full = range(first, first + random_.choice((1, 3, 1000)))
    if name in ("two hosts", "host killed, then another"):
        found.again = random_.choice((0.0, 0.05, 0.3, 3.0))
    if name == "two hosts":
        found.visits = [random_.uniform(0, 4) for _ in range(3)]
        begins = random_.uniform(0, 4)
        found.taken = (begins, begins + random_.choice((0.2, 2.0, 20.0)))
    found.options = Options(
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
    found.name = name or ("noise" if noise.any else "host stalled" if found.stalls else "none")
    return found


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


@dataclass
class Run:
    """One host's run: its job, the record (None: it never had the board), the one that its journal gives, the steps
    of the section that was open that the mark allows at most, and what the board made for it."""

    job: CertifiedJob
    record: ExecutionRecord | None = None
    killed: bool = False
    from_journal: ExecutionRecord | None = None
    given: tuple[int, tuple[int, ...]] | None = None
    told: Told = field(init=False)


class Started(KlipperBoard):
    """Remembers the clock at the tick 0 of its first section, and of which boot: no step of it comes before."""

    base: tuple[int, int] | None = None
    emulator: Emulator

    def start_section(self, number: int, start: tuple[int, ...], lead: int) -> int:
        found = super().start_section(number, start, lead)
        if self.base is None:
            self.base = int(str(self.emulator.state()["boots"])) - 1, found
        return found


def walked(one: CertifiedJob, line: EmulatedLine, host: FrailHost, folder: Path) -> tuple[Run, Started]:
    """One host from its start to its end."""
    board = Started(line.connect, WIRING, pulse=2, direction_setup=5)
    board.emulator = line.board
    made = Run(one)
    journal = journals.begin(folder, "klipper", {}, marks=folder)
    line.write_through, line.alive = host.write, host.check
    with host.writing(journal):
        try:
            with contextlib.suppress(BoardError):
                made.record = walk(one, board, journal=journal)
        except Killed:
            made.killed, made.record = True, None
        except OSError:
            assert host.full, "the journal could not be written"
    # The system closes what a process had open.
    line.held, path = False, journal.path
    journal.let_go()
    found = journals.read_journal(path)
    assert not found.damaged
    trail = found.trail()
    if trail.begun:
        made.from_journal = trail.record()
        given = found.given()
        if given is not None and given.place == trail.started and made.killed:
            made.given = given.place, given.given
    return made, board


def ran(one: CertifiedJob, plan: Schedule, other: CertifiedJob | None = None) -> list[Run]:
    """What the hosts of a schedule made of a job, and of another one after it."""
    board = Emulator(plan.options)
    line = EmulatedLine(board, list(plan.stalls), taken=plan.taken)
    visits = sorted(plan.visits)

    def visited() -> None:
        while visits and visits[0] <= line.now():
            visits.pop(0)
            if line.held:
                refused(line)

    line.visitor = visited
    runs, bases = [], []
    with mock.patch.object(driver, "FIND_PAUSE", 0.0), tempfile.TemporaryDirectory() as folder:
        made, _ = walked(one, line, plan.host, Path(folder, "first"))
        runs.append(made)
        if plan.again is not None and other is not None:
            line.visitor = None
            board.advance(board.now + round(plan.again * 1e9))
            made, second = walked(other, line, FrailHost(), Path(folder, "second"))
            runs.append(made)
            bases = [second.base]
    # What the board still does when nobody is there any more belongs to its log.
    board.advance(board.now + 40 * 10**9)
    board.finish()
    told = read(board.log.held)
    for run, part in zip(runs, parted(told, bases), strict=True):
        run.told = part
    return runs


def refused(line: EmulatedLine) -> None:
    """A host that wants a port that another one has gets nowhere, and sends nothing."""
    try:
        KlipperBoard(line.connect, WIRING).open()
    except BoardError as error:
        assert "another program" in str(error)
    else:
        raise AssertionError("two hosts have one port")


def parted(told: Told, bases: list[tuple[int, int] | None]) -> Iterator[Told]:
    """The steps of each host: those of the second come after the tick 0 of its first section."""
    steps = told.steps
    for base in bases:
        late = np.zeros(len(steps.tick), dtype=bool)
        if base is not None:
            boot, tick = base
            late = (steps.boot > boot) | ((steps.boot == boot) & (steps.tick > tick))
        yield replace(told, steps=_chosen(steps, ~late))
        steps = _chosen(steps, late)
    yield replace(told, steps=steps)


def _chosen(steps: Steps, mask: np.ndarray) -> Steps:
    return Steps(**{name: getattr(steps, name)[mask] for name in ("motor", "tick", "direction", "boot")})


def said(run: Run) -> str:
    """The outcome of a host's run; AssertionError."""
    if run.killed:
        run.record = run.from_journal
    if run.record is None:
        assert not len(run.told.steps.tick), "a board that was not opened moved, or no record says so"
        return "not opened, nothing moved"
    result = judged(run.job, run.told, run.record)
    if run.from_journal is not None and run.from_journal != run.record:
        judged(run.job, run.told, run.from_journal)
    if run.given is not None:
        place, most = run.given
        assert place == len(run.record.sections)
        before = [sum(s.steps[k] for s in run.record.sections[:-1]) for k in range(len(PINS))]
        for pin, b, m in zip(PINS, before, most, strict=True):
            assert len(run.told.steps.of(pin)[0]) <= b + m, "more was made than the mark says was given"
    return result


def outcome(seed: int, *, certified: bool) -> tuple[str, str]:
    """The fault and the outcome of one schedule."""
    plan = schedule(seed, certified=certified)
    one, other = jobs()[seed % len(jobs())], jobs()[(seed + 1) % len(jobs())]
    return plan.name, "; then ".join(said(run) for run in ran(one, plan, other))


def table(seeds: range, *, certified: bool) -> Counter[tuple[str, str]]:
    """How often each outcome of each fault was seen; AssertionError with the seed."""
    found: Counter[tuple[str, str]] = Counter()
    for seed in seeds:
        try:
            found[outcome(seed, certified=certified)] += 1
        except AssertionError as error:
            raise AssertionError(f"seed {seed}, certified {certified}: {error}") from error
    return found


def outcome_table(found: Counter[tuple[str, str]]) -> list[str]:
    """A row for each fault, a column for each outcome of the first host; of a second one how often it finished."""
    short = {
        "completed, position known": "finished", "stopped, position known": "stopped at rest",
        "emergency-stop, position known": "found again", "underrun, position known": "stopped in time",
        "fault, position known": "fault, known", "not opened, nothing moved": "nothing moved",
    }  # fmt: skip
    cells: Counter[tuple[str, str]] = Counter()
    for (fault, result), times in found.items():
        first = result.split("; ")[0]
        cells[fault, short.get(first, "declared unknown" if "unknown" in first else first)] += times
    columns = list(dict.fromkeys([*short.values(), "declared unknown", *(column for _, column in sorted(cells))]))
    rows = ["| fault | " + " | ".join(columns) + " |", "|---" * (len(columns) + 1) + "|"]
    for fault in [*sorted({fault for fault, _ in cells})]:
        rows.append(f"| {fault} | " + " | ".join(str(cells[fault, column] or "") for column in columns) + " |")
    return rows
