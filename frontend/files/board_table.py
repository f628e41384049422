"""``[board]`` of a machine file: times, where the board is plugged in, and which pin is for what.

docs/machine-files.md lists the keys. Pins have the names that the board's own dictionary gives them; ``!`` before one
inverts it, ``^`` switches the pull-up resistor of an input on, as in the files of Klipper.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

from gproof.frontend.common.toml_table import TomlTable
from gproof.ir.machine import Board, Machine, Pin, WiredMotor, WiredOutput

SWITCHED = ("spindle", "spindle_reverse", "mist", "flood")
"""Names of outputs that are not numbers of channels."""

HIGHEST_OUTPUT = 9999
SLOWEST, FASTEST = 1200, 10_000_000
"""Baud."""

_PIN = re.compile(r"[!^]{0,2}[A-Za-z][A-Za-z0-9_.:/-]{0,39}")
_SHARED = ("enable", "limit")
"""Motors may have one enable pin together, and switches in a row are one limit."""


def board_from(root: TomlTable, machine: Machine) -> Board:
    """The board of a file over that of its base."""
    before, table = machine.board, root.table("board")
    if table is None:
        return before
    board = replace(
        before,
        **_given(
            name=table.text("name"),
            tick_frequency=table.whole("tick_frequency", 1, 10**12),
            step_pulse=table.positive("step_pulse", zero=True),
            direction_setup=table.positive("direction_setup", zero=True),
            port=_port(table),
            baud=table.whole("baud", SLOWEST, FASTEST),
            probe=_pin(table, "probe", reads=True),
        ),
    )
    board = replace(board, motors=_motors(table, machine), outputs=_outputs(table, board))
    _told_apart(table, board)
    table.finish()
    return board


def _given(**values: Any) -> dict[str, Any]:
    return {name: value for name, value in values.items() if value is not None}


def _port(table: TomlTable) -> str | None:
    port = table.text("port")
    if port is not None and not port.strip():
        table.bad("port", "an empty text")
    return port


def _pin(table: TomlTable, key: str, *, reads: bool = False) -> Pin | None:
    """A pin; reads: it is an input."""
    text = table.text(key)
    if text is None:
        return None
    name = text.lstrip("!^")
    marks = text[: len(text) - len(name)]
    if not _PIN.fullmatch(text) or marks in ("!!", "^^"):
        table.bad(key, f'{text!r} is not a pin such as "PB4", or "!PB4" where it is inverted')
        return None
    if "^" in marks and not reads:
        table.bad(key, f"{text!r}: only an input has a pull-up resistor (^)")
        return None
    return Pin(name=name, inverted="!" in marks, pull_up="^" in marks)


def _motors(board: TomlTable, machine: Machine) -> tuple[WiredMotor, ...]:
    """In the order of the machine's motors."""
    known = [drive.name for axis in machine.axes for drive in axis.drives()]
    wired = {motor.motor: motor for motor in machine.board.motors}
    outer = board.table("motors")
    for name in outer.values if outer else ():
        assert outer is not None
        table = outer.table(name)
        if table is None:
            continue
        motor = _motor(table, name.upper(), wired.get(name.upper()))
        if name.upper() not in known:
            has = f"it has: {', '.join(known).lower()}" if known else "it has none"
            outer.bad(name, f"the machine has no motor {name}; {has}")
        elif motor is not None:
            wired[motor.motor] = motor
        table.finish()
    return tuple(sorted(wired.values(), key=lambda motor: known.index(motor.motor) if motor.motor in known else 0))


def _motor(table: TomlTable, name: str, before: WiredMotor | None) -> WiredMotor | None:
    pins = {key: _pin(table, key, reads=key == "limit") for key in ("step", "direction", "enable", "limit")}
    if before is not None:
        return replace(before, **_given(**pins))
    for key in ("step", "direction"):
        if key not in table.values:
            table.missing(key)
    step, direction = pins["step"], pins["direction"]
    if step is None or direction is None:
        return None
    return WiredMotor(motor=name, step=step, direction=direction, enable=pins["enable"], limit=pins["limit"])


def _outputs(board: TomlTable, before: Board) -> tuple[WiredOutput, ...]:
    """By name, then by the number of the channel."""
    wired = {output.output: output for output in before.outputs}
    outer = board.table("outputs")
    for name in outer.values if outer else ():
        assert outer is not None
        table = outer.table(name)
        if table is None:
            continue
        channel = name.isascii() and name.isdigit() and len(name) < 6 and 0 <= int(name) <= HIGHEST_OUTPUT
        plain = str(int(name)) if channel else name
        output = _output(table, plain, wired.get(plain))
        if not channel and name not in SWITCHED:
            what = f"{name!r} is not one of {', '.join(SWITCHED)}, or the number of an output channel"
            outer.bad(name, what)
        elif output is not None:
            wired[plain] = output
        table.finish()
    return tuple(sorted(wired.values(), key=lambda output: (output.output.isdigit(), output.output.zfill(5))))


def _output(table: TomlTable, name: str, before: WiredOutput | None) -> WiredOutput | None:
    pin, idle = _pin(table, "pin"), table.boolean("idle")
    speed = table.positive("speed")
    if speed is not None and not name.startswith("spindle"):
        table.bad("speed", "only a spindle has a speed")
    if before is not None:
        return replace(before, **_given(pin=pin, idle=idle, speed=speed))
    if "pin" not in table.values:
        table.missing("pin")
    return None if pin is None else WiredOutput(output=name, pin=pin, idle=bool(idle), speed=speed)


# One pin, one use.


def _used(board: Board) -> Iterator[tuple[str, str, Pin]]:
    """(what for, the kind of use, pin) of all pins."""
    for motor in board.motors:
        for kind in ("step", "direction", "enable", "limit"):
            pin = getattr(motor, kind)
            if pin is not None:
                yield f"motors.{motor.motor.lower()}.{kind}", kind, pin
    for output in board.outputs:
        yield f"outputs.{output.output}.pin", "output", output.pin
    if board.probe is not None:
        yield "probe", "probe", board.probe


def _told_apart(table: TomlTable, board: Board) -> None:
    """A finding for each pin that is named twice."""
    first: dict[str, tuple[str, str, Pin]] = {}
    for where, kind, pin in _used(board):
        earlier = first.setdefault(pin.name.upper(), (where, kind, pin))
        if earlier[0] == where or (kind in _SHARED and kind == earlier[1] and pin == earlier[2]):
            continue
        here = where if _is_written(table, where.split(".")) else earlier[0]
        other = earlier[0] if here == where else where
        why = ", with other signs" if kind in _SHARED and kind == earlier[1] else ""
        inner, key = _table_of(table, here.split("."))
        inner.bad(key, f"pin {pin.name} is also {other}{why}")


def _is_written(table: TomlTable, path: Iterable[str]) -> bool:
    """Whether this file itself says it, rather than its base."""
    values: Any = table.values
    for part in path:
        found = {key.lower(): value for key, value in values.items()} if isinstance(values, dict) else {}
        if part not in found:
            return False
        values = found[part]
    return True


def _table_of(table: TomlTable, path: list[str]) -> tuple[TomlTable, str]:
    """The table that has the last key of a path, as far as this file has it."""
    for k, part in enumerate(path[:-1]):
        written = next((key for key in table.values if key.lower() == part), None)
        inner = None if written is None else table.table(written)
        if inner is None:
            return table, ".".join(path[k:])
        table = inner
    return table, path[-1]
