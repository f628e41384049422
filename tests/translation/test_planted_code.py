"""Mistakes planted in the code that raises and in the code that writes: no trap that they touch is proven and wrong.

Each is one change of a file's syntax tree (``code_mutants.py``). Where it changes what is written for a trap, the
answer is not "proven", or the new text does the same as the right one under every setup, by the interpreter alone: a
word that is printed again, modes in another order.
"""

from __future__ import annotations

import dataclasses
import random
import re
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Any

import pytest
from differential import rs274_peer
from support.campaigns import SOAK, share
from support.traps import AXES, DIALECTS, MACHINE, READ, Case, cases, machine_files
from translation import code_mutants
from translation.test_traps import difference, setup_of, worded
from translation.test_traps_mutated import FURTHER, plain

from gproof.driver import translation
from gproof.driver.dialects import DIALECTS as FRONTENDS
from gproof.driver.running import begin
from gproof.driver.session import Session, open_session
from gproof.driver.targets import TARGETS
from gproof.ir.finding import Findings
from gproof.ir.verdict import Verdict

from hand.compare import rows_of  # isort: skip

EXTENSIONS = {dialect: extension for extension, dialect in DIALECTS.items()}
RAISING = {
    f"gproof.frontend.{path.parent.name}.{path.stem}": path.parent.name
    for path in sorted((code_mutants.ROOT / "frontend").glob("*/raising*.py"))
}
"""Modules that raise, and whose programs."""
WRITING = {
    f"gproof.backend.emit.{name}.{part}": to
    for name, parts, to in (
        ("eding", ("from_job", "expressions"), ("eding",)), ("wincnc", ("from_job", "feeds", "tables"), ("wincnc",)),
        ("mcuwin", ("from_job", "job_expressions", "job_lines"), ("mcuwin",)), ("grbl", ("from_job",), ("grbl",)),
        ("linuxcnc", ("from_job", "expressions"), ("linuxcnc",)),
        ("rs274", ("writer", "tables"), ("eding", "linuxcnc")),
    ) for part in parts
} | {"gproof.backend.emit.job_writer": tuple(TARGETS), "gproof.backend.emit.job_numbers": tuple(TARGETS)}  # fmt: skip
"""Modules that write, and for which targets."""
MODULES = [*RAISING, *WRITING]
MOST_TOUCHED = 6
"""Pairs that a mistake is looked at in, of those that it touches."""
SECONDS = 20
"""For all that is done with one mistake: it may be a loop without an end."""
MISTAKES = 80
"""In each file, in a soak; one otherwise."""
FEW = 20
"""Pairs that are tried for it if it is no soak."""


class TooLong(Exception):
    """A mistake that takes too long."""


@contextmanager
def bounded() -> Iterator[None]:
    def over(*_: object) -> None:
        raise TooLong

    before = signal.signal(signal.SIGALRM, over)
    signal.alarm(SECONDS)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@dataclasses.dataclass
class Pair:
    """A trap and a target: its program, the machines, and what is right."""

    case: Case
    to: str
    job: Path
    machine: Path
    machine_to: Path
    session: Session

    def wanted(self) -> translation.Wanted:
        dialect = self.case.dialect(self.case.source)
        return translation.Wanted(
            job=self.job, to=self.to, machine=self.machine, machine_to=self.machine_to, dialect=dialect
        )

    @cached_property
    def right(self) -> tuple[translation.Translation, tuple[Any, ...]]:
        """The translation, and what the writer was given for it."""
        given: list[tuple[Any, ...]] = []
        entry = TARGETS[self.to]

        def write(*arguments: Any) -> dict[str, bytes]:
            given.append(arguments)
            return entry.write(*arguments)

        TARGETS[self.to] = dataclasses.replace(entry, write=write)
        try:
            done = translation.translate(self.wanted())
        finally:
            TARGETS[self.to] = entry
        return done, given[-1] if given else ()


@pytest.fixture(scope="module")
def pairs(tmp_path_factory: pytest.TempPathFactory) -> list[Pair]:
    """Every trap to every target."""
    shop = tmp_path_factory.mktemp("planted")
    for dialect in READ:
        (shop / dialect).mkdir()
        for name, data in machine_files(dialect).items():
            (shop / dialect / name).write_bytes(data)
    found = []
    for case in cases():
        place = shop / case.name
        place.mkdir(parents=True)
        job, machine = case.written(case.source, place, alone=True)
        dialect = case.dialect(case.source)
        session = open_session(job, machine=machine, setup=None, dialect=dialect)
        for to in TARGETS if session.program is not None else ():
            of = to if to in READ else "eding"
            found.append(Pair(case, to, job, machine, shop / of / MACHINE[of], session))
    return found


@dataclasses.dataclass
class Outcome:
    """What came of a mistake: pairs that it touches, of them not proven by the comparison, ended by an error or refused
    before, and proven with the same rows."""

    said: str
    touched: int = 0
    refused: int = 0
    ended: int = 0
    harmless: int = 0
    wrong: list[str] = dataclasses.field(default_factory=list)


def outcome(name: str, number: int, pairs: list[Pair], folder: Path) -> Outcome:
    """A mistake of a module on the pairs that it touches."""
    said, tree = code_mutants.changed(name, number)
    found = Outcome(f"{name} {said}")
    if name in RAISING:
        mine = [one for one in pairs if RAISING[name] in ("common", one.session.dialect)]
    else:
        mine = [one for one in pairs if one.to in WRITING[name]]
    random.Random(f"{name} {number}").shuffle(mine)
    mine = [one for one in mine[: None if SOAK else FEW] if name in RAISING or one.right[0].files]
    jobs = {one.job: translation.raised(one.session) for one in mine} if name in RAISING else {}
    answers: list[tuple[Pair, translation.Translation | str]] = []
    made: dict[Path, translation.Translation | str | None] = {}
    try:
        with bounded(), code_mutants.planted(name, tree):
            for one in mine:
                if made.get(one.job, "") is None:
                    continue  # another target of a job that it does not touch
                answer = _planted(one, name, jobs.get(one.job))
                made[one.job] = answer if name in RAISING else ""
                if answer is not None:
                    answers.append((one, answer))
                if len(answers) >= MOST_TOUCHED:
                    break
    except Exception:  # it takes too long, or cannot even be loaded
        found.touched = found.ended = 1
    for one, answer in answers:
        found.touched += 1
        _judge(one, answer, found, folder / f"{found.touched}")
    return found


def _planted(one: Pair, name: str, right: Any) -> translation.Translation | str | None:
    """What is translated with a mistake; None: it does not touch the pair; "": it ends with an error."""
    entry, raised = TARGETS[one.to], translation.raised
    try:
        if name in RAISING:
            assert one.session.program is not None
            job = FRONTENDS[one.session.dialect].frontend.raise_program(one.session.program, one.session.machine)  # type: ignore[misc]
            if job == right:
                return None
            translation.raised = lambda session: job
        else:
            files = entry.write(*one.right[1])
            if files == one.right[0].files:
                return None
            TARGETS[one.to] = dataclasses.replace(entry, write=lambda *_: files)
        return translation.translate(one.wanted())
    except TooLong:
        raise
    except Exception:
        return ""
    finally:
        TARGETS[one.to], translation.raised = entry, raised


def _judge(one: Pair, answer: translation.Translation | str, found: Outcome, folder: Path) -> None:
    right = one.right[0]
    if isinstance(answer, str) or answer.comparison is None:
        found.ended += 1
    elif answer.verdict is not Verdict.SAFE:
        found.refused += 1
    elif answer.files == right.files or (right.files and right.verdict is Verdict.SAFE and _alike(one, answer, folder)):
        found.harmless += 1
    else:
        texts = [b"".join(done.files.values()).decode(errors="replace") for done in (right, answer)]
        found.wrong.append(f"{found.said}\n{one.case.name} to {one.to}, right:\n{texts[0]}\nproven:\n{texts[1]}")


def _alike(one: Pair, answer: translation.Translation, folder: Path) -> bool:
    """Whether two texts do the same under every setup."""
    both = (one.right[0], answer)
    if len({_has_marks(done) for done in both}) == 2 and any(_starts_devices(done) for done in both):
        return len({_without_end(done) for done in both}) == 1
    states = [*one.case.setups(), *(one.case.setups()[0] | further for further in FURTHER)]
    runs = []
    for name, done in (("right", one.right[0]), ("proven", answer)):
        place = folder / name
        place.mkdir(parents=True)
        written = place / f"written{EXTENSIONS[one.to]}"
        for inner, text in done.files.items():
            # The peer of LinuxCNC does not read a second %.
            plain_text = text.replace(b"\n%\n", b"\nM2\n").removeprefix(b"%\n") if _has_marks(done) else text
            if done.target.name == "grbl" and not {b"M2", b"M30"} & set(text.split(b"\n")):
                plain_text += b"M2\n"  # that it wants an end is LinuxCNC's own rule
            if one.to not in READ:
                # rs274 and the module gcode start at other heights where the zero is not that of the machine.
                plain_text = b"G53 G0 X0 Y0 Z0\n" + plain_text
            (place / inner if inner else written).write_bytes(plain_text)
        runs.append(_rows(one, written, states))
    return all(
        difference(plain(a, state["start"]), plain(b, state["start"])) == ""
        == difference(plain(b, state["start"]), plain(a, state["start"]))
        for a, b, state in zip(*runs, states, strict=True)
    )  # fmt: skip


def _has_marks(done: translation.Translation) -> bool:
    """Whether a text for LinuxCNC is between two %."""
    return done.target.name == "linuxcnc" and done.files[""].startswith(b"%\n")


def _starts_devices(done: translation.Translation) -> bool:
    """Whether a text starts spindle or coolant, which one end stops and another does not."""
    return re.search(rb"\bM0*[3478]\b", b"".join(done.files.values())) is not None


def _without_end(done: translation.Translation) -> bytes:
    """A text without the lines that end it: what they stop is an event of the Trace."""
    return b"\n".join(line for line in b"".join(done.files.values()).split(b"\n") if line not in (b"%", b"M2", b"M30"))


def _rows(one: Pair, written: Path, states: list[dict[str, Any]]) -> list[list[dict[str, Any]]]:
    starts = [dict(zip(AXES, state["start"], strict=True)) for state in states]
    if one.to in READ:
        session = open_session(written, machine=one.machine_to, setup="zero", dialect=one.to)
        assert session.program is not None
        found = []
        for state, start in zip(states, starts, strict=True):
            setup = setup_of(state, one.to)
            if one.to == "mcuwin":  # both start in G54, which a translation takes for granted and says so
                setup = dataclasses.replace(setup, g92={axis: setup.work[1, axis] for axis in AXES})
            run = begin(session.program, setup, session.machine, Findings())
            found.append(worded(rows_of(run, session.machine, (), written), start, one.to))
        return found
    if rs274_peer.missing() is not None:
        return [[] for _ in states]
    jobs = []
    for state in states:
        zeros = {n: dict(zip(AXES, state[key], strict=True)) for n, key in ((1, "work"), (2, "second"))}
        tools = {1: (40.0, 6.0), 2: (40.0, 4.0), 3: (40.0, 10.0)}
        jobs.append((written, rs274_peer.Situation(tools=tools, work=zeros)))
    runs = rs274_peer.run_peers(jobs)
    return [worded(run.rows, start, one.to) for run, start in zip(runs, starts, strict=True)]


@pytest.mark.parametrize("name", share(MODULES, 8))
def test_no_mistake_is_proven(name: str, pairs: list[Pair], tmp_path: Path) -> None:
    count = code_mutants.changes(name)
    chosen = random.Random(name).sample(range(count), min(MISTAKES if SOAK else 1, count))
    found = [outcome(name, number, pairs, tmp_path / str(number)) for number in chosen]
    assert [text for one in found for text in one.wrong] == []
    caught = [one.said for one in found if one.refused or one.ended]
    assert len(caught) >= (3 if SOAK else 0), caught
