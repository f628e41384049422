"""Knife, saw, torch and their like: devices that a job switches on, some of which move axes themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import FollowedRefusal, Refusal
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOWHERE
from gproof.ir.trace import KNIFE, Op
from gproof.passes.interpret.core.channels import with_pair
from gproof.passes.interpret.core.open_numbers import number_or_open
from gproof.passes.interpret.wincnc import tangential_knife as single_knife
from gproof.passes.interpret.wincnc.events import note
from gproof.passes.interpret.wincnc.moves import Handler, switch_output
from gproof.passes.interpret.wincnc.state import (
    LEANING,
    KnifeNow,
)

if TYPE_CHECKING:
    from gproof.passes.interpret.wincnc.command import Command
    from gproof.passes.interpret.wincnc.state import (
        WinCncRun,
    )


def switched(name: str, on: bool, *, moves: bool = False) -> Handler:
    """What switches a device on or off; moves: it may move axes, and it is not known where."""

    def handler(run: WinCncRun, line: Command, rule: CodeRule) -> None:
        s = run.modal
        flags = s.own.flags | {name} if on else s.own.flags - {name}
        s.own = s.own.but(flags=flags)
        note(run, line, rule)
        if on and moves:
            run.lose_places()
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text}, which moves axes on its own,"))

    return handler


def knife(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L30 and L31: the knife's axis follows the path (``passes/interpret/wincnc/tangential_knife.py``)."""
    s = run.modal
    note(run, line, rule)
    if rule.function is F.KNIFE_OFF:
        if KNIFE in s.following:
            single_knife.switched(run, line.span)
        s.following = tuple(name for name in s.following if name != KNIFE)
        s.own = s.own.but(flags=s.own.flags - {LEANING})
        run.state_changed()
        return
    mode = wincnc_settings(run.machine).knife
    if run.machine.knife is None:
        problem = "without knifemode=" if mode is None else single_knife.problem_of(run, mode)
        if problem:
            run.lose_places()
            if mode is not None and (mode.blade or mode.both_ways):
                s.own = s.own.but(flags=s.own.flags | {LEANING})
            raise FollowedRefusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} {problem}"))
    s.following = tuple(sorted({*s.following, KNIFE}))
    run.state_changed()
    single_knife.switched(run, line.span)


def knife_settings(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L30.1: lift angle, lift position and plunge depth, in the unit in force."""
    s = run.modal
    mode = wincnc_settings(run.machine).knife
    angle, up, down = (line.number(letter) for letter in "AZP")
    if angle is not None and angle < 0:
        raise Refusal(codes.ILLEGAL_VALUE.at(line.where("A"), word="A", what=f"a lift angle of {angle:g}"))
    note(run, line, rule)
    if mode is None:
        return
    scale = s.scale(AXIS_NAMES.index(mode.vertical)) if mode.vertical else s.unit
    now = s.own.knife or single_knife.settings(mode)
    s.own = s.own.but(
        knife=KnifeNow(
            now.angle if angle is None else angle,
            now.lifted if up is None else up * scale,
            now.lowered if down is None else down * scale,
        )
    )


def saw(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L32: the blade turns with the path; what it does to lifts and to the ends of cuts the manual does not say."""
    s = run.modal
    s.own = s.own.but(flags=s.own.flags | {"saw"})
    note(run, line, rule)
    run.lose_places()
    what = (
        f"{rule.text} (the manual does not say in which direction O of sawmode= counts, before which turns it lifts "
        "by Z, and what its radius R does to the ends of cuts)"
    )
    raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))


def torch(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L38 and L39: the torch's output; with height control on, Z goes where the arc's voltage sends it."""
    s = run.modal
    controls = wincnc_settings(run.machine)
    on = rule.function is F.TORCH_ON
    if "A" in line.values:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} with a bevel angle"))
    control = controls.torch
    number = None if control is None else control.output
    if number is not None:
        s.outputs = with_pair(s.outputs, number, float(on))
        run.event(Op.OUTPUT, line.span, arg=(float(number), float(on)))
    delay = None if control is None else control.start_delay if on else control.end_delay
    if delay:
        run.event(Op.DWELL, line.span, arg=(delay, 0.0))
    axis = AXIS_NAMES.index(control.axis) if control is not None and control.axis else 2
    lift = 0.0 if control is None or control.lift is None else control.lift
    burning(run, line, rule, on=on)
    if not on and lift:
        known = not _height_acts(run)
        s.position[axis] = run.unknown_place("value", axis, (0.0, lift), s.position[axis]) if known else NOWHERE
        s.jumped = True


def _height_acts(run: WinCncRun) -> bool:
    """Whether height control may move Z: after L36, and before the job's first L37, as its first state is not known."""
    flags = run.modal.own.flags
    return "height" in flags or ("height off" not in flags and run.setup.default_offset is None)


def burning(run: WinCncRun, line: Command, rule: CodeRule, *, on: bool) -> None:
    """The torch burns, by L38 or by its output, or goes out: Z goes where the arc's voltage sends it."""
    s = run.modal
    s.own = s.own.but(flags=s.own.flags | {"torch"} if on else s.own.flags - {"torch"})
    if on and _height_acts(run):
        control = wincnc_settings(run.machine).torch
        s.position[AXIS_NAMES.index(control.axis) if control is not None and control.axis else 2] = NOWHERE
        run.fail(codes.HEIGHT_CONTROL.at(line.span, code=rule.text))
        s.jumped = True


def height(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L36 and L37: torch height control."""
    s = run.modal
    on = rule.function is F.HEIGHT_ON
    flags = s.own.flags - {"height", "height off"} | {"height" if on else "height off"}
    s.own = s.own.but(flags=flags)
    run.event(Op.SETPOINT, line.span, arg=(0.0, float(on)), text=run.text_number("height_control"))
    if on and "torch" in flags:
        burning(run, line, rule, on=True)


def auto_output(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L34 and L35: the output that is on while the job cuts; with D only its dwell is set."""
    s = run.modal
    on = rule.function is F.AUTO_OUTPUT_ON
    if "D" in line.values:
        seconds = number_or_open(run, line, "D", rule.text) or 0.0
        first, second = s.own.auto_dwell
        s.own = s.own.but(auto_dwell=(seconds, second) if on else (first, seconds))
    else:
        if not on:
            switch_output(run, line, cutting=False)
        s.own = s.own.but(flags=s.own.flags | {"autoaux"} if on else s.own.flags - {"autoaux"})
    note(run, line, rule)
