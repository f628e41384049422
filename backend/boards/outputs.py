"""What an event of a stream switches: the pins that the machine file has for it, and what is left to the operator.

Arguments of events are those of ``ir/trace.py: ARGUMENTS``, in thousandths. A pin is on or off: the speed of a spindle
is the operator's, unless the machine file says that the spindle runs at just that speed.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

from gproof.ir.machine import WiredOutput
from gproof.ir.trace import Op

SPINDLE, REVERSE, MIST, FLOOD = "spindle", "spindle_reverse", "mist", "flood"

Switched = tuple[tuple[str, bool], ...]
"""Outputs by name, and whether they go on."""

_SAME_SPEED = 0.5
"""Revolutions a minute."""


class Manual(NamedTuple):
    """Something that no pin does. what: the thing; to: what it has to be."""

    what: str
    to: str


def pins_of(op: int, arg: tuple[int, int], wired: Collection[str]) -> Switched:
    """The outputs among ``wired`` that an event switches."""
    if op == Op.SPINDLE:
        turns = {SPINDLE: arg[0] > 0, REVERSE: arg[0] < 0}
        # Off first: two relays must not be closed together.
        return tuple(sorted(((name, on) for name, on in turns.items() if name in wired), key=lambda pair: pair[1]))
    if op == Op.COOLANT:
        return tuple((name, value != 0) for name, value in zip((MIST, FLOOD), arg, strict=True) if name in wired)
    if op == Op.OUTPUT and _channel(arg) in wired and arg[1] in (0, 1000):
        return ((_channel(arg), arg[1] != 0),)
    return ()


def left_of(op: int, arg: tuple[int, int], outputs: Sequence[WiredOutput], text: str = "") -> tuple[Manual, ...]:
    """What of an event no pin does; text: what a setpoint sets."""
    speeds = {output.output: output.speed for output in outputs}
    if op == Op.SPINDLE:
        return tuple(_spindle(arg, speeds))
    if op == Op.COOLANT:
        named = zip((MIST, FLOOD), arg, strict=True)
        return tuple(Manual(name, "on" if value else "off") for name, value in named if name not in speeds)
    if op == Op.OUTPUT and not pins_of(op, arg, speeds):
        return (Manual(f"output {_channel(arg)}", {0: "off", 1000: "on"}.get(arg[1], f"{arg[1] / 1000:g}")),)
    if op == Op.SETPOINT:
        channel = f" {arg[0] / 1000:g}" if arg[0] else ""
        return (Manual(text.replace("_", " ") + channel, f"{arg[1] / 1000:g}"),)
    return ()


def _channel(arg: tuple[int, int]) -> str:
    return f"{arg[0] / 1000:g}"


def _spindle(arg: tuple[int, int], speeds: dict[str, float | None]) -> list[Manual]:
    direction, speed = arg[0], arg[1] / 1000
    if not direction:
        return [] if SPINDLE in speeds or REVERSE in speeds else [Manual("spindle", "off")]
    name = SPINDLE if direction > 0 else REVERSE
    turning = "clockwise" if direction > 0 else "counter-clockwise"
    if name not in speeds:
        return [Manual("spindle", f"{turning}, {speed:g} rpm")]
    stated = speeds[name]
    if stated is not None and abs(stated - speed) <= _SAME_SPEED:
        return []
    return [Manual("spindle speed", f"{speed:g} rpm")]
