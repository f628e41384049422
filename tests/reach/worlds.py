"""Small worlds in which each stated fact can be seen to matter: a machine file of the corpus, a setup, a program."""

from __future__ import annotations

import contextlib
import functools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
from corpus.jobs import CORPUS
from reach.answers import TARGETS, Place, again, answers
from reach.changes import Path as FieldPath
from reach.changes import put

from gproof.driver.session import Session, open_session
from gproof.ir.machine import Machine
from gproof.ir.setup import Interval, Setup
from gproof.ir.trace import Chunk
from gproof.ir.workpiece import Box, Placed, Workpiece
from gproof.passes.interpret.core.run import Run

Change = tuple[FieldPath, Any]
STATE = "state"
"""Paths that begin with it change the record that rows of the trace carry."""


def exactly(**places: float) -> dict[str, Interval]:
    """Known positions by axis."""
    return {name: Interval(value, value) for name, value in places.items()}


@dataclass(frozen=True)
class World:
    """A machine of the corpus, what is stated of it, and changes that hold for every witness in it."""

    dialect: str
    machine: str
    setup: Setup
    changes: tuple[Change, ...] = ()

    def but(self, *changes: Change) -> World:
        """The same with more changes of its machine."""
        return replace(self, changes=(*self.changes, *changes))

    def with_setup(self, **stated: Any) -> World:
        """The same with another setup."""
        return replace(self, setup=replace(self.setup, **stated))


_SUFFIX = {"eding": "cnc", "wincnc": "tap", "mcuwin": "src"}


@functools.cache
def _machine(file: Path, dialect: str, program: Path) -> Session:
    return open_session(program, machine=file, setup=None, dialect=dialect)


def answered(world: World, program: str, folder: Path, changes: tuple[Change, ...]) -> dict[str, str]:
    """What is answered of a program, put into ``folder``; paths begin with ``machine``, ``setup`` or ``state``."""
    job = folder / f"job.{_SUFFIX[world.dialect]}"
    job.write_text(program, encoding="utf-8")
    place = Place(job, CORPUS / world.machine, None, world.dialect)
    session = _machine(place.machine, world.dialect, job)
    facts: dict[str, Any] = {"machine": session.machine, "setup": world.setup}
    states: list[Change] = []
    for path, value in (*world.changes, *changes):
        if path[0] == STATE:
            states.append((path[1:], value))
        else:
            facts[path[0]] = put(facts[path[0]], path[1:], value)
    machine: Machine = facts["machine"]
    machine.verify()
    with changed_states(states):
        return answers(again(place, session, machine, facts["setup"]))


@contextlib.contextmanager
def changed_states(changes: list[Change]) -> Iterator[None]:
    """While it lasts, every state of every trace has other values: what reads the field answers otherwise."""
    run = Run.chunks

    def changed(executor: Run) -> Iterator[Chunk]:
        for chunk in run(executor):
            states = chunk.trace.states
            for number, state in enumerate(states):
                for path, value in changes:
                    state = put(state, path, value)
                states[number] = state
            yield chunk

    with pytest.MonkeyPatch.context() as patch:
        if changes:
            patch.setattr(Run, "chunks", changed)
        yield


def moved(first: dict[str, str], second: dict[str, str]) -> set[str]:
    """Targets of which two answers differ; no stream for one reason is as good as none for another."""
    found = {target for target in TARGETS if first.get(target) != second.get(target)}
    for name in ("plan", "stream"):
        if first[name].startswith("none") and second[name].startswith("none"):
            found.discard(name)
    return found


HOME = {"x": 0.0, "y": 0.0, "z": 0.0}
BLOCK = Workpiece(
    stock=(Placed(name="stock", body=Box(low=(0.0, 0.0, -15.0), high=(120.0, 80.0, 0.0))),),
    part=(Placed(name="part", body=Box(low=(20.0, 20.0, -15.0), high=(100.0, 60.0, -2.0))),),
    fixtures=(Placed(name="clamp", body=Box(low=(-40.0, 32.0, 0.0), high=(-4.0, 48.0, 12.0))),),
    clearance=0.5,
)
"""Counted from G54, whose zero the worlds have at X150 Y120 Z-110."""

EDING = World(
    "eding",
    "eding/clamped-bracket/machine.toml",
    Setup(
        name="setup.toml", homed=("x", "y", "z"), active_work=1, tool=1, block_delete=False, optional_stop=False,
        start=exactly(**HOME), g92=exactly(**HOME), tool_lengths={0: Interval(0.0, 0.0)},
        work={(1, name): Interval(v, v) for name, v in (("x", 150.0), ("y", 120.0), ("z", -110.0))},
        default_parameter=0.0,
    ),
)  # fmt: skip
WINCNC = World(
    "wincnc",
    "wincnc/router-atc/WINCNC.INI",
    Setup(
        name="setup.toml", homed=("x", "y", "z"), active_work=1, tool=1, block_delete=False, optional_stop=False,
        start=exactly(**HOME), g92=exactly(**HOME), measures=exactly(z=-133.35),
        tool_lengths={n: Interval(-130.0 - n, -130.0 - n) for n in range(1, 7)},
    ),
)  # fmt: skip
MCUWIN = World(
    "mcuwin",
    "mcuwin/rotary-mill/machine.toml",
    Setup(
        name="setup.toml", homed=("x", "y", "z", "c"), start=exactly(x=0.0, y=0.0, z=60.0, c=0.0),
        block_delete=False, optional_stop=False,
    ),
)  # fmt: skip
