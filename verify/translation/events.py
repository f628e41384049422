"""What happens between the moves, in order: events of a section in the names that both sides share.

Left out is what changes nothing:

- a spindle, coolant or output command that repeats the state in force: the device gets the command that it has;
- a tool that is said twice with nothing in between: it is in the spindle then;
- a speed for a spindle that rests: the start of the spindle has the speed in force then;
- a speed right before a command for the spindle at the same place, which has that speed;
- one coolant off right before the other one at the same place, by outputs: both are off then;
- rows that only say what the rows of moves have in their state and in their numbers (offsets, units, plane, path mode,
  guards, overrides), and messages, which move and switch nothing; a question ends its section and is compared there.

Dwells in a row at one place are one dwell: the axes rest for the sum, and nothing happens in between. An output that
motion does not stop for is as one that it stops for where the axes rest at that place anyway: at the start and the end
of a section, or because of another event there. Where neither side stops for it, a zero may: that stop is there
without the output too.
"""

from __future__ import annotations

import math
import re
from typing import NamedTuple

import numpy as np

from gproof.ir.columns import Columns
from gproof.ir.trace import Op
from gproof.verify.translation.comparison import Place
from gproof.verify.translation.sides import Side

QUIET = (Op.TOOL_OFFSET, Op.UNITS, Op.PLANE, Op.OVERRIDE, Op.PATH_MODE, Op.GUARD, Op.MESSAGE, Op.END)
"""Rows that say what rows of moves have in their state, or that the operator reads."""
_PRESELECTED = re.compile(r"T\d+")
"""A tool that is only named: the change says which tool comes (``Op.TOOL_CHANGE``)."""


class Event(NamedTuple):
    """kind: a word; values: what must be the same; at: moves of the section before it; flying: motion goes on."""

    kind: str
    values: tuple[float | str, ...]
    at: int
    place: Place
    flying: bool = False


class Devices(NamedTuple):
    """What is switched on; None: as it was at the start. outputs: (channel, value) that are known, by channel; changed:
    the tool that a stop before has named (``TranslationTerms.tool_by_stop``)."""

    spindle: tuple[float, float] | None = None
    coolant: tuple[float, ...] | None = None
    speed: float = math.nan
    outputs: tuple[tuple[int, float], ...] = ()
    changed: float | None = None

    def after_operator(self, keep: frozenset[int]) -> Devices:
        """After a wait for the operator, who may have switched anything: no command repeats a state any more.

        keep: channels by which a spindle's direction and both coolants are known: a command for one of these
        devices leaves the others as the operator has left them, on both machines.
        """
        kept = tuple(pair for pair in self.outputs if pair[0] in keep)
        return Devices(speed=self.speed, outputs=kept, changed=self.changed)


class EventReader:
    """Reads the event rows of one side, with the state of its devices."""

    def __init__(self, side: Side, devices: Devices) -> None:
        self.side = side
        self.spindle, self.coolant, self.speed, outputs, self.changed = devices
        self.outputs = dict(outputs)
        self.found: list[Event] = []
        self.rests: set[int] = set()
        self._partial: Event | None = None
        self._speed_alone: tuple[int, tuple[float, float] | None, Place | str] | None = None
        """Of a speed alone that changed while the spindle turns: the number of its event, the state before it, and
        where that is not known, the line: another command on it is the one that the speed is of."""
        self._one_off: tuple[int, tuple[float, ...] | None] | None = None
        """Of an output that switched one coolant off: the number of its event, the state before it."""
        self._coolant_words = dict(side.terms.coolant) if side.which == 0 else {}

    @property
    def devices(self) -> Devices:
        """Their state after what was read."""
        return Devices(self.spindle, self.coolant, self.speed, tuple(sorted(self.outputs.items())))

    def read(self, rows: Columns, before: np.ndarray[tuple[int], np.dtype[np.int64]]) -> None:
        """The events of a section's rows; before: moves before each row, counted over the whole stretch."""
        op = rows["op"]
        which = np.flatnonzero((op >= 10) & ~np.isin(op, QUIET))
        files = self.side.trace.files
        columns = zip(
            op[which].tolist(), rows["arg"][which].tolist(), rows["text"][which].tolist(), before[which].tolist(),
            rows["file"][which].tolist(), rows["line"][which].tolist(), strict=True,
        )  # fmt: skip
        for kind, arg, text, at, file, line in columns:
            partial = self._partial
            if partial is not None and (kind != Op.OUTPUT or at != partial.at):
                self._keep_partial(partial)
            self._one(kind, arg[0], arg[1], text, at, (files[file], line))
        if self._partial is not None:
            self._keep_partial(self._partial)

    def _keep_partial(self, partial: Event) -> None:
        """Outputs that run a device together were not switched together: what it does is not known."""
        self.found.append(partial)
        self._partial, self.spindle = None, None

    def _complete(self, device: str) -> None:
        """Another output of a device is switched: what the one before has done is judged with it."""
        if self._partial is not None and not self._partial.kind.startswith(device):
            self._keep_partial(self._partial)
        self._partial = None

    def _one(self, op: int, first: float, second: float, text: int, at: int, place: Place) -> None:
        if op == Op.OFFSET:
            if second:
                self.rests.add(at)
            return
        flying = op == Op.OUTPUT and text == 1
        if not flying and op != Op.SETPOINT:
            self.rests.add(at)
        if op == Op.DWELL:
            self._dwell(first, at, place)
        elif op == Op.SPINDLE:
            self._turn(first, second, at, place)
        elif op == Op.COOLANT:
            self._cool((first, second), at, place)
        elif op == Op.OUTPUT:
            self._switch(int(first), second, text, at, place)
        elif op == Op.SETPOINT:
            self._set(self.side.trace.texts[text], first, second, at, place)
        elif op == Op.TOOL_CHANGE:
            number = first if math.isnan(first) else float(self.side.tools.get(int(first), int(first)))
            if number == self.changed and at == 0 and not self.found:
                # The number of the tool that the operator has put in at the stop before.
                self.changed = None
            elif not (self.found and self.found[-1][:3] == ("tool", (number,), at)):
                self._add("tool", (number,), at, place)
        elif op == Op.INPUT_WAIT:
            if not math.isnan(second):
                self._add("input", (float(self.side.inputs.get(int(first), int(first))), second), at, place)
        elif op == Op.STOP:
            # With its switch on, an optional stop is one like any other.
            self._add("stop", (0.0 if self.side.terms.stops_on else first,), at, place)
        elif op == Op.HOME:
            self._add("home", (" ".join(sorted(self.side.trace.texts[text].split())),), at, place)
        elif op == Op.DEVICE:
            written = self.side.trace.texts[text]
            if written not in self.side.terms.silent and not _PRESELECTED.fullmatch(written):
                self._add("device", (written,), at, place)
        else:
            self._add(
                {Op.ORIENT: "orient", Op.HEAD: "head"}.get(Op(op), "event"), (float(op), first, second), at, place
            )

    def _add(self, kind: str, values: tuple[float | str, ...], at: int, place: Place, *, flying: bool = False) -> None:
        self.found.append(Event(kind, values, at, place, flying))

    def _group(self, channels: set[int]) -> bool | None:
        """Whether channels that are switched together are on; None: some of them."""
        on = sum(bool(self.outputs.get(one)) for one in channels)
        return None if 0 < on < len(channels) else on > 0

    def _dwell(self, seconds: float, at: int, place: Place) -> None:
        last = self.found[-1] if self.found else None
        if last is not None and last.kind == "dwell" and last.at == at:
            assert isinstance(last.values[0], float)
            self.found[-1] = last._replace(values=(last.values[0] + seconds,))
        elif seconds != 0.0:
            self._add("dwell", (seconds,), at, place)

    def _turn(self, direction: float, speed: float, at: int, place: Place, *, alone_speed: bool = False) -> None:
        now = (direction, speed if direction else 0.0)
        alone = self._speed_alone
        is_next = alone is not None and alone[0] == len(self.found) - 1 and self.found[-1].at == at
        if alone is not None and is_next and alone[2] in ("", place):
            # S before M3, M4 or M5 at one place: one command for the spindle.
            self.found.pop()
            self.spindle = alone[1]
        self._speed_alone = None
        before = self.spindle
        if now != before:
            self._add("spindle", now, at, place)
            same_way = alone_speed or (before is not None and before[0] == direction)
            if direction and (same_way or before is None):
                self._speed_alone = len(self.found) - 1, before, "" if same_way else place
        self.spindle = now

    def _cool(self, now: tuple[float, ...], at: int, place: Place) -> None:
        """now: mist and flood."""
        if self._coolant_words:
            # As the target's map has it: one of them may stand for the other, and is on where either is.
            mapped = {"mist": 0.0, "flood": 0.0}
            for word, value in zip(("mist", "flood"), now, strict=True):
                into = self._coolant_words.get(word, word)
                mapped[into] = value if mapped[into] != 1.0 and value != 0.0 else mapped[into]
            now = mapped["mist"], mapped["flood"]
        if now != self.coolant:
            self._add("coolant", now, at, place)
        self.coolant = now

    def _cool_by_output(self, now: tuple[float, ...], at: int, place: Place, *, is_off: bool) -> None:
        """now: mist and flood; is_off: an output of one of them was switched off."""
        before, off = self.coolant, self._one_off
        self._one_off = None
        if is_off and off is not None and off[0] == len(self.found) - 1 and self.found[-1].at == at:
            self.found.pop()
            self.coolant = before = off[1]
        count = len(self.found)
        self._cool(now, at, place)
        if is_off and len(self.found) > count:
            self._one_off = count, before

    def _set(self, what: str, channel: float, value: float, at: int, place: Place) -> None:
        if what != "spindle_speed":
            self.rests.add(at)
            self._add("setpoint", (what, float(self.side.channels.get(int(channel), int(channel))), value), at, place)
            return
        self.speed = value
        before = self.spindle or self._by_outputs()
        if before is not None and before[0]:
            self.rests.add(at)
            self._turn(before[0], value, at, place, alone_speed=True)

    def _by_outputs(self) -> tuple[float, float] | None:
        """The direction that outputs which are known say, where nothing else does: after a stop."""
        own = self.side.outputs
        on = {one for one in self.side.spindle_channels if self.outputs.get(one)}
        if not on or set(own.forward) == set(own.backward) or on not in (set(own.forward), set(own.backward)):
            return None
        return (1.0 if on == set(own.forward) else -1.0), math.nan

    def _switch(self, channel: int, value: float, text: int, at: int, place: Place) -> None:
        own = self.side.outputs
        if text < 0:
            self.outputs.clear()
            self._add("output word", (float(self.side.channels.get(channel, channel)), value), at, place)
            return
        known = self.outputs.get(channel)
        # A number that ends in 00 may be all channels of a group (McuWIN 4.11): nothing is known of the others then.
        alike = [one for one in self.outputs if one // 100 == channel // 100 and (one % 100 == 0 or channel % 100 == 0)]
        for one in alike:
            del self.outputs[one]
        known = None if alike else known
        self.outputs[channel] = value
        if channel in self.side.spindle_channels:
            on = {one for one in self.side.spindle_channels if self.outputs.get(one)}
            self._complete("spindle")
            if not on:
                self._turn(0.0, 0.0, at, place)
            elif value == 0.0 and self.spindle is None and on in (set(own.forward), set(own.backward)):
                # One way is switched off while the other is on, as the first of two: the second says what is meant.
                direction = 1.0 if on == set(own.forward) else -1.0
                self._partial = Event("spindle", (direction, self.speed), at, place)
            elif on == set(own.forward) == set(own.backward):
                self._turn(math.nan, self.speed, at, place)
            elif on == set(own.forward):
                self._turn(1.0, self.speed, at, place)
            elif on == set(own.backward):
                self._turn(-1.0, self.speed, at, place)
            else:
                self._partial = Event("spindle outputs", (float(channel), value), at, place)
        elif channel in own.coolant:
            self._complete("coolant")
            now = [self._group(ones) for ones in (set(own.mist), set(own.coolant) - set(own.mist))]
            if None in now:
                self._partial = Event("coolant outputs", (float(channel), value), at, place)
            else:
                self._cool_by_output(tuple(float(bool(one)) for one in now), at, place, is_off=value == 0.0)
        elif known != value:
            number = float(self.side.channels.get(channel, channel))
            self._add("output", (number, value), at, place, flying=text == 1)


def same(one: Event, other: Event, feed_relative: float, seconds: float) -> bool | None:
    """Whether two events are the same; None: a number of them is not known."""
    if one.kind != other.kind or len(one.values) != len(other.values):
        return False
    is_open = False
    for a, b in zip(one.values, other.values, strict=True):
        if isinstance(a, str) or isinstance(b, str):
            if a != b:
                return False
        elif math.isnan(a) or math.isnan(b):
            is_open = True
        elif one.kind == "dwell":
            if abs(a - b) > seconds:
                return False
        elif abs(a - b) > (feed_relative * max(abs(a), abs(b)) if one.kind == "spindle" else 0.0):
            return False
    return None if is_open else True
