"""Traces of a program for any work zero, with the devices of its machine left to the machine."""

from __future__ import annotations

from dataclasses import replace

from gproof.driver.dialects import DIALECTS
from gproof.driver.running import begin, collect
from gproof.driver.session import Running, Session
from gproof.ir.finding import Findings
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.program import Program
from gproof.ir.rules import Function as F
from gproof.ir.setup import Interval, Setup
from gproof.ir.trace import Trace


def any_zero(setup: Setup, program: Program) -> Setup:
    """A setup of which only stays what is no offset: start, work zeros and tool lengths are unknown. At the start no
    local offset is in force."""
    # Where the local offset is the zero in force, the work offset that is active is in it, and nothing is added to it.
    in_force = "g92" in DIALECTS[program.dialect].frontend.open_offsets
    none = {} if in_force else {name: Interval(0.0, 0.0) for name in AXIS_NAMES}
    return replace(
        setup, name="any work zero", homed=tuple(AXIS_NAMES), start={}, work={}, g92=none, tool_lengths={}, measures={},
        default_start=None, default_offset=None, active_work=setup.active_work or 1, tool=None, workpiece=None,
        keep_out=(), optional_stop=None,
    )  # fmt: skip


DEVICES = frozenset((
    F.TOOL_CHANGE, F.SPINDLE_CW, F.SPINDLE_CCW, F.SPINDLE_OFF, F.MIST_ON, F.FLOOD_ON, F.COOLANT_OFF,
))  # fmt: skip
"""Functions that each machine's own macros may do in their way."""


def own_devices(program: Program, assumed: list[str]) -> Program:
    """The program without its machine's macros for tool changes, spindle and coolant: each machine has its own."""
    plain = DIALECTS[program.dialect].frontend.plain_devices(program)
    pairs = ((plain.body, program.body), *((plain.subprograms[n].body, s.body) for n, s in program.subprograms.items()))
    if any(one is not two and one != two for new, old in pairs for one, two in zip(new, old, strict=True)):
        text = "what each machine's own macros do besides at a tool change, spindle or coolant code is right"
        if text not in assumed:
            assumed.append(text)
    program = plain
    codes_of = program.rules.codes
    kept = {
        code: name for code, name in program.overrides.items()
        if code not in codes_of or codes_of[code].function not in DEVICES
    }  # fmt: skip
    names = sorted(set(program.overrides.values()) - set(kept.values()))
    if not names:
        return program
    text = f"what each machine's own macros do at a tool change, spindle or coolant code ({', '.join(names)}) is right"
    if text not in assumed:
        assumed.append(text)
    return replace(program, overrides=kept)


def trace_of(
    program: Program, setup: Setup, machine: Machine, findings: Findings, running: Running, session: Session,
    *, block_delete: bool | None = None, optional_stop: bool | None = None, assumed: list[str] | None = None,
) -> Trace:  # fmt: skip
    """The trace for any work zero. block_delete: None: as the setup of the session states it, off where it does not;
    optional_stop: None: both positions of its switch; assumed: gets what the run takes as true."""
    machine = replace(
        machine, controller=replace(machine.controller, auto_tool_change=False),
        settings=replace(machine.settings, zero_offsets=None),
    )  # fmt: skip
    run = begin(
        program, replace(any_zero(setup, program), optional_stop=optional_stop), machine, findings,
        **session.options(running),
        block_delete=bool(session.setup.block_delete if block_delete is None else block_delete),
    )  # fmt: skip
    trace = collect(run)
    if assumed is not None:
        assumed += [text for text in (*program.assumed, *run.assumed) if text not in assumed]
    return trace
