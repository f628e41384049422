"""Programs of translations run by the interpreter alone, from a known start, with known zeros and tools."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from gproof.driver.dialects import DIALECTS
from gproof.driver.running import execute
from gproof.driver.session import Running, Session
from gproof.driver.translation_traces import any_zero, own_devices
from gproof.ir.finding import Findings
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.program import Program
from gproof.ir.setup import Interval, Setup
from gproof.ir.trace import Trace

NO_LENGTHS: Mapping[int, float] = MappingProxyType({})
NO_ONLY: Mapping[str, int] = MappingProxyType({})


def at_known_zero(
    program: Program, machine: Machine, setup: Setup, session: Session, seed: int,
    lengths: Mapping[int, float] = NO_LENGTHS, only: Mapping[str, int] = NO_ONLY,
    first: Mapping[str, int] = NO_ONLY,
) -> Trace:  # fmt: skip
    """session: of the source, whose options and switch of block delete count for its translation too; lengths: mm by
    tool, where they are in the zeros of a target that has none: tools keep their numbers here; only: by axis the
    work offset that the one zero of a controller without a table is, of others the first; first: by axis the
    work offset whose place the first one has."""
    known = at_zero(any_zero(setup, program), program.dialect, seed, only)
    work = known.work | {(1, axis): known.work[number, axis] for axis, number in first.items()}
    known = replace(known, work=work)
    if lengths:
        stated = {0: 0.0, **lengths}
        known = replace(known, tool_lengths={number: Interval(at, at) for number, at in stated.items()})
    bare = replace(machine, settings=replace(machine.settings, zero_offsets=None))
    return execute(
        own_devices(program, []), known, bare, Findings(), **session.options(Running()),
        block_delete=bool(session.setup.block_delete),
    )  # fmt: skip


def at_zero(setup: Setup, dialect: str, seed: int, only: Mapping[str, int]) -> Setup:
    """The same with a known start, tool and zeros; with inputs and answers open, as in a proof."""
    chance = random.Random(seed)
    places = {
        (number, axis): Interval(*(2 * [round(chance.uniform(-50, 50), 3)]))
        for number in range(1, 10) for axis in AXIS_NAMES
    }  # fmt: skip
    if "g92" in DIALECTS[dialect].frontend.open_offsets:
        # The local offset is the zero in force: of a controller with a table, its first work offset.
        single = "work" not in DIALECTS[dialect].frontend.open_offsets
        setup = replace(setup, g92={axis: places[only.get(axis, 1) if single else 1, axis] for axis in AXIS_NAMES})
    return replace(
        setup, inputs={}, outputs={}, virtual={}, answers={}, work=places,
        start={axis: Interval(0.0, 0.0) for axis in AXIS_NAMES}, default_offset=0.0,
        default_start=0.0, tool_lengths={number: Interval(*(2 * [10.0 + number])) for number in range(100)},
    )  # fmt: skip
