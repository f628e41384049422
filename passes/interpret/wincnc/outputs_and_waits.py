"""Outputs, waits, tools, guards, devices of controllers of one command a line, and what their variables hold.

WinCNC Users Guide, Command Reference: G4, G40 to G42, L11 to L13, L20 to L23.1, L30 to L61, L101 to L120, L300, L301,
L500, M11 to M18, M99, and the variables of braces.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import Refusal, Span
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.setup import Interval
from gproof.ir.symbolic import NOWHERE, Position, Unknown, bounds
from gproof.ir.trace import Op, Wait
from gproof.passes.geometry.machine_axes import vertical_axes
from gproof.passes.interpret.core.channels import with_pair
from gproof.passes.interpret.core.open_numbers import number_or_open
from gproof.passes.interpret.core.run import ProgramEnd
from gproof.passes.interpret.wincnc.axis_targets import follow
from gproof.passes.interpret.wincnc.devices import (
    burning,
)
from gproof.passes.interpret.wincnc.events import note
from gproof.passes.interpret.wincnc.moves import note_assumptions, spindle_range
from gproof.passes.interpret.wincnc.state import (
    machine_zero,
)

if TYPE_CHECKING:
    from gproof.passes.interpret.wincnc.command import Command
    from gproof.passes.interpret.wincnc.state import (
        WinCncRun,
    )


def dwell(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G4 X: seconds; alone: until the operator goes on."""
    letter = "D" if rule.letter == "L" else "X"
    seconds = number_or_open(run, line, letter, rule.text)
    if seconds is None:
        if line.comment:
            run.event(Op.MESSAGE, line.span, text=run.text_number(line.comment))
        run.event(Op.STOP, line.span)
        run.findings.add(codes.OPERATOR_STOP.at(line.span, code=rule.text))
        run.end_section(Wait.OPERATOR, "cycle start", None, line.span)
        return
    if seconds < 0:
        raise Refusal(codes.DWELL_NEGATIVE.at(line.where(letter), seconds=seconds))
    run.event(Op.DWELL, line.span, arg=(seconds, 0.0))


# ---- outputs and inputs


def channel(run: WinCncRun, line: Command, rule: CodeRule, known: tuple[int, ...] | None, kind: str) -> int:
    """The channel in C; Refusal GP128 for one that is not there."""
    number = line.whole("C", run.program.rules.integer_tolerance)
    assert number is not None
    stated = wincnc_settings(run.machine).highest_channel
    highest = math.inf if stated is None else stated
    if number < 0 or number > highest or (known is not None and number not in known):
        allowed = (
            f"{highest} is the highest channel" if number > highest else f"the machine file has no {kind} {number}"
        )
        raise Refusal(codes.PARAMETER_RANGE.at(line.where("C"), code=rule.text, word="C", allowed=allowed))
    return number


def output(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """M11 to M14: an output on or off; M13 and M14 without a stop."""
    s = run.modal
    controls = wincnc_settings(run.machine)
    on = rule.function in (F.OUTPUT_ON, F.OUTPUT_ON_MOVING)
    if "C" not in line.values:
        if "D" not in line.values:
            raise Refusal(codes.WORD_MISSING.at(line.where_code(rule), code=rule.text, needed="C"))
        _bank(run, line, rule, on)
        return
    number = channel(run, line, rule, controls.outputs, "output")
    s.outputs = with_pair(s.outputs, number, float(on))
    passing = rule.function in (F.OUTPUT_ON_MOVING, F.OUTPUT_OFF_MOVING)
    run.event(Op.OUTPUT, line.span, arg=(float(number), float(on)), text=int(passing))
    if controls.torch is not None and number == controls.torch.output:
        run.settings.meet("torch", line.span)
        burning(run, line, rule, on=on)


def _bank(run: WinCncRun, line: Command, rule: CodeRule, on: bool) -> None:
    """M11 D: drills of a bank by the bits of a number."""
    banks = wincnc_settings(run.machine).drill_banks
    run.settings.meet("drills", line.span)
    if len(banks) != 1:
        raise Refusal(
            codes.UNSUPPORTED_CODE.at(
                line.span, code=f"{rule.text} with D, but the machine file has not exactly one drillbank="
            )
        )
    bits = line.whole("D", run.program.rules.integer_tolerance) or 0
    first, count = banks[0]
    if not 0 <= bits < 1 << count:
        allowed = f"the bank has {count} drills"
        raise Refusal(codes.PARAMETER_RANGE.at(line.where("D"), code=rule.text, word="D", allowed=allowed))
    s = run.modal
    for n in range(count):
        if bits >> n & 1:
            s.outputs = with_pair(s.outputs, first + n, float(on))
            run.event(Op.OUTPUT, line.span, arg=(float(first + n), float(on)))


def analog(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L51: the D/A output by volts, percent or spindle speed, one of them."""
    if len(line.values) > 1:
        second = list(line.values)[1]
        raise Refusal(codes.OUTPUT_VALUE.at(line.where(second), code=rule.text, what="only one of V, P and S"))
    if "S" in line.values:
        spindle_range(run, line)
    note(run, line, rule)


def wait(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """M17 and M18: until an input is on or off."""
    number = channel(run, line, rule, wincnc_settings(run.machine).inputs, "input")
    run.event(Op.INPUT_WAIT, line.span, arg=(float(number), float(rule.function is F.WAIT_ON)))
    run.end_section(Wait.INPUT, "come", None, line.span)


def virtual(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L60, L61: a virtual input."""
    number = line.whole("C", run.program.rules.integer_tolerance)
    if number is None or not 1 <= number <= 64:
        raise Refusal(codes.PARAMETER_RANGE.at(line.where("C"), code=rule.text, word="C", allowed="1 to 64"))
    s = run.modal
    swapped = wincnc_settings(run.machine).virtual_on == 60
    on = float((rule.function is F.VIRTUAL_ON) != swapped)
    s.own = s.own.but(virtual=with_pair(s.own.virtual, number, on))


# ---- what braces and conditions read


# ---- tools


# ---- compensation


# ---- mapping, locking


# ---- guards


# ---- devices that move axes in ways that nobody can follow


def store_position(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L500 stores machine places under a number; L501 local ones, whose recall is not described."""
    s = run.modal
    letter = next((letter for letter in "PHT" if letter in line.values), None)
    if letter is None:
        raise Refusal(codes.WORD_MISSING.at(line.where_code(rule), code=rule.text, needed="P, H or T"))
    number = line.whole(letter, run.program.rules.integer_tolerance)
    lift = line.number("L")
    axes = sorted(line.axes()) or sorted(axis.index for axis in run.machine.axes)
    local = rule.function is F.STORE_LOCAL_POSITION
    places = tuple((axis, NOWHERE if local else s.position[axis].minus(machine_zero(s.own, axis))) for axis in axes)
    lifted = lift is None or lift != 0.0
    others = tuple(known for known in s.own.places if known[0] != f"{letter}{number}")
    s.own = s.own.but(places=(*others, (f"{letter}{number}", places, lifted)))
    note(run, line, rule)


def level_heads(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L53: vertical heads as high as possible with their tools at one height."""
    s = run.modal
    heads = vertical_axes(run.machine)
    stored = s.own.before or s.tool_offset
    aside = {axis for axis in set(heads) & s.own.unmeasured if stored[axis] != s.tool_offset[axis]}
    moved = [axis for axis in heads if axis in dict(s.own.zeros)]
    if moved or aside or any(s.tool_offset[axis].form for axis in heads):
        for axis in heads:
            s.position[axis] = NOWHERE
        s.jumped = True
        why = (
            "while G49 is active (the manual does not say whether measured lengths count)"
            if aside
            else "with tools whose length is not measured"
        )
        why = "after an L28 of a head (its highest position is unknown)" if moved else why
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} {why}"))
    note_assumptions(run, line.span)
    target = list(s.position)
    if heads:
        # At machine zero the tip of an axis is at minus its measure: the lowest of them all can reach.
        height = min(-s.tool_offset[axis].value for axis in heads)
        for axis in heads:
            target[axis] = Position(height + s.tool_offset[axis].value)
    run.move(Op.TRAVERSE, follow(run, target, line.span), line.span)
    run.moved = True


def measured(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L82, L83: the probe goes down until it touches: the height, and what counts from it, is not known before.

    L82 where the setup states the contact of the probe's axis: the surface is there, and gets the number of Z. How far
    the probe rises again is not said: between the surface and where it came from.
    """
    s = run.modal
    controls = wincnc_settings(run.machine)
    axis = AXIS_NAMES.index(controls.probe_axis)
    contact = run.setup.contacts.get(controls.probe_axis)
    if axis in s.own.locked or any(axis in pair for pair in s.own.slaves):
        # Whether a probe that L300 locks goes down, and how far what follows it comes back, is not said.
        contact = None
        for follower, leader in s.own.slaves:
            if leader == axis:
                s.position[follower] = NOWHERE
    if rule.function is F.MEASURE_SURFACE and contact is not None and not s.position[axis].form:
        _surface(run, line, axis, contact)
        return
    for axis in vertical_axes(run.machine):
        s.position[axis] = NOWHERE
        if rule.function is F.MEASURE_SURFACE:
            s.g92[axis] = NOWHERE
    for axis in line.axes():
        s.position[axis] = NOWHERE
    s.jumped = True
    raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text}, which measures with the probe,"))


def _surface(run: WinCncRun, line: Command, axis: int, contact: Interval) -> None:
    """L82 down to a contact that the setup states, in machine coordinates."""
    s = run.modal
    start = s.position[axis]
    if contact.low > start.value:
        what = f"L82 from below the contact that the setup file gives for {run.machine.word(axis)}"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    note_assumptions(run, line.span)
    word = run.machine.word(axis)
    run.assumed[
        f"the setup file gives the contact of the probe of {word}, and the probe rises no higher than it came from"
    ] = None
    down = list(s.position)
    down[axis] = Position(contact.low)
    s.feed = math.nan
    run.move(Op.FEED, down, line.span)
    run.moved = True
    high = min(contact.high, start.value)
    known = contact.low == high
    place = Position(high) if known else run.unknown_place("home", axis, (contact.low, high), Position(0.0))
    value = line.values.get("Z", 0.0)
    base = s.work_offsets[s.work, axis].plus(s.beside_work(axis))
    s.g92[axis] = NOWHERE if isinstance(value, Unknown) else place.minus(base).moved(-value * s.scale(axis))
    run.state_changed()
    run.event(Op.OFFSET, line.span, arg=(0.0, 0.0))
    ends = contact.low, start.value
    s.position[axis] = run.unknown_place("home", axis, ends, Position(0.0)) if ends[0] < ends[1] else place
    run.end_section(Wait.PROBE, "touched", None, line.span)


def map_adjustment(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L600, L601: adjustments of axismap= off and on: nothing on a machine that has no map."""
    devices = wincnc_settings(run.machine).devices
    if devices is not None and "axismap" not in devices:
        note(run, line, rule)
        return
    if not line.axes():
        run.lose_places()
    for axis in line.axes():
        run.modal.position[axis] = NOWHERE
    run.modal.jumped = True
    raise Refusal(codes.UNSUPPORTED_CODE.at(line.where_code(rule), code=f"{rule.text} ({rule.open})"))


def recall(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L401: to where all axes were before the last file ran, which this job does not say."""
    run.lose_places()
    raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text}, to a place that an earlier file left,"))


def feed_override(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L40 P: percent of the programmed feed; GP200 outside of what override= allows (1 to 200: Feed Rate Override).

    Where override= E0 switches overrides off, or P is not known, feeds are not known any more (GP270).
    """
    s = run.modal
    controls = wincnc_settings(run.machine)
    percent = line.values.get("P", 0.0)
    low, high = controls.override or (None, None)
    low, high = 1.0 if low is None else low, 200.0 if high is None else high
    least, most = bounds(percent)
    if most < low or least > high:
        what = f"{rule.text} P{least:g} is not within {low:g} to {high:g} percent"
        run.findings.add(
            codes.COMMAND_IGNORED.at(line.where("P"), what=what, hint="use a value within L and H of override=")
        )
        run.event(Op.MESSAGE, line.span, text=run.text_number(f"L40 P{least:g} is ignored"))
        return
    cause = (
        "override= E0 switches overrides off (the manual does not say whether L40 acts)"
        if not controls.override_enabled
        else ""
    )
    if isinstance(percent, Unknown):
        cause = f"P depends on {percent.cause}, whose value is unknown"
    factor = math.nan if isinstance(percent, Unknown) else percent / 100.0
    if cause and factor != s.feed_override:
        run.findings.add(codes.OVERRIDE_FACTOR.at(line.where("P"), code=rule.text, what=cause))
        factor = math.nan
    s.feed_override = factor
    # With rapid_lock=0 rapids can be changed too: how much L40 does is not said, but where it leaves them alone.
    held = not controls.rapids_unlocked or factor == 1.0
    s.own = s.own.but(retimed=s.own.retimed - {rule.text} if held else s.own.retimed | {rule.text})
    run.state_changed()


def smoothing(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G9: how much the controller rounds corners from here on; how far that is from the path, no manual says."""
    factor = line.values.get("S", 0.0)
    if isinstance(factor, Unknown) or factor:
        run.assumed["corners that the controller rounds (G9) do not reach a zone or a body"] = None
    note(run, line, rule)


def dynamics(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L5, L6, L7: velocities and accelerations that the machine's file does not have; L6 and L7 alone: as before.

    Times, plans and streams by the file's do not hold while one is in force. What L5 sets may be the feed itself.
    """
    s = run.modal
    restores = rule.text != "L5" and not line.values
    if rule.text == "L7" and line.values.get("P") == 100.0 and rule.text not in s.own.retimed:
        restores = True  # all of what is in force
    names = s.own.retimed - {rule.text} if restores else s.own.retimed | {rule.text}
    s.own = s.own.but(retimed=names)
    run.state_changed()
    note(run, line, rule)


def backlash(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L8, L9: compensation of backlash on, with the file's amounts or new ones, or off.

    What is in force is kept as the most that it may be: whether L8 of some axes switches it on for others, and whether
    a motor goes back when it is switched off, is not said.
    """
    s = run.modal
    controls = wincnc_settings(run.machine)
    stated = {AXIS_NAMES.index(name): amount for name, amount in controls.backlash}
    most = dict(s.own.backlash)
    if rule.text == "L9":
        changed = {axis.index for axis in run.machine.axes if axis.backlash or axis.index in most}
        most |= {axis: most.get(axis, 0.0) for axis in changed}
    else:
        for axis in run.machine.axes:
            amount = stated.get(axis.index, axis.backlash)
            if amount != axis.backlash or axis.index in most:
                most[axis.index] = max(most.get(axis.index, 0.0), amount)
        for column, value in line.axes().items():
            if run.machine.word(column) in line.bare:
                continue
            if not isinstance(value, Unknown) and value < 0.0:
                raise Refusal(codes.ILLEGAL_VALUE.at(line.span, word=rule.text, what=f"a backlash of {value:g}"))
            amount = math.inf if isinstance(value, Unknown) else value * s.scale(column)
            most[column] = max(most.get(column, 0.0), amount)
    s.own = s.own.but(backlash=tuple(sorted(most.items())))
    run.state_changed()
    note(run, line, rule)


def abort(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """M99.1: the program aborts itself."""
    run.findings.add(run.ends_here(codes.ABORTED_BY_PROGRAM).at(line.span, code=rule.text))
    if run.flow.aborted():
        return
    run.event(Op.END, line.span)
    run.ended_by = rule.text, line.span.line
    run.end_section(Wait.END, "aborted", -1, line.span)
    raise ProgramEnd


def subprogram_end(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """M99: back to the caller; in the job itself its end."""
    run.flow.leave_file(Span(line.span.file, line.span.line))
