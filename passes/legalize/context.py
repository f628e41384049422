"""What legalising knows at a place of the job: values of variables, where the axes are, what was done so far."""

from __future__ import annotations

from collections.abc import Iterable
from copy import copy
from dataclasses import replace
from typing import Any

import numpy as np

from gproof.ir.job import (
    MM,
    ArcTo,
    AxisPlace,
    ChangeTool,
    CountLoop,
    DrillHole,
    DwellFor,
    HomeAxes,
    Job,
    LoopWhile,
    Moves,
    MoveTo,
    Node,
    Nodes,
    OptionalPart,
    ParkAt,
    Quantity,
    Remark,
    RepeatGrid,
    RunRoutine,
    SetFeed,
    SetFrame,
    SetVariable,
    SwitchCoolant,
    SwitchOutput,
    TurnSpindle,
    UseLength,
    quantities,
    walk,
)
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.program import Expr, Number
from gproof.ir.target import Target
from gproof.passes.legalize.constants import constant
from gproof.passes.legalize.feeds import NO_FEED, FeedInForce, feed_after, gives_feed
from gproof.passes.legalize.job_axes import axes_of, moved_by
from gproof.passes.legalize.options import Lowered, Options, Zero
from gproof.passes.legalize.reached import reached
from gproof.passes.legalize.switched import switched_perhaps
from gproof.passes.legalize.transform import SAME, Transform, applied, joined

MOST_OFFSETS = 100
"""Numbers of work offsets are below it."""
MOST_OPERATIONS = 200_000
"""Operations that loops and routines may be unrolled into."""


_KNOWN = (
    "values", "place", "spindle", "coolant", "switched", "uneven", "turns", "program_place", "zero", "local_off",
    "kept", "local", "suspended", "remembered", "moved", "offsets", "doubtful", "selected", "shift", "length",
    "measuring", "at_machine", "borrowed", "feed", "feed_lost",
)  # fmt: skip
"""What a context knows at a place."""


POSITIONS = 5001
"""Number of the variable that holds the place of X in work coordinates (RS274); those of the other axes follow."""
SELECTED, IN_SPINDLE = -1, -2
"""Numbers of no variables: under them the context keeps the tool that is selected, and that in the spindle."""


_MOVING = (Moves, MoveTo, ArcTo, DrillHole)
_STRAIGHT = (*_MOVING, Remark, SetFeed, DwellFor, SwitchOutput, SwitchCoolant, TurnSpindle)
"""Operations of a subprogram that goes straight from its begin to its end: where it ends is known."""


class TooLong(Exception):
    """More operations than MOST_OPERATIONS."""


class Context:
    """What is known at a place.

    place: mm or degrees by axis, in the frame in force, of axes whose place is known; values: variables that are;
    spindle: the direction that is known to be in force, else ""; coolant: it may be on; switched: which of both the job
    may have switched so far, uneven: on some ways to here alone; zero: the work zero, and kept ones; local_off: no
    local offset is in force; spare_used: the spare work offset of the target is; axes: that the job moves; local: mm by
    axis of the local offset in force, None: not known, suspended: the one that was suspended; remembered: what
    ``zero_keep`` kept, moved: axes that moved since; settled: a select after which the local offset is brought back;
    unit: of lengths, as the source has it; offsets: places that the job stored, of offsets that the target does not
    have, doubtful: numbers of those whose places depend on the path, selected: which is in force, shift: mm by axis
    that the zero is from it, None: not known, placed: what brings one into force; reads_places: what variables hold
    of the place of an axis is its place; why: a pattern that does not fit says what it lacks; length: mm of the tool
    that are in the zero of a target without tool lengths, None: not known, length_known: whether it is at the start;
    measuring: each tool's length counts from its change on; kept_length: what ``zero_keep`` kept of it; keeping: the
    job itself uses the place for a kept zero; lengths_used: by tool; only: by axis the work offset that is the only
    zero of the target; at_machine: mm by axis from machine zero, of those that went there; as_is: frames and changes
    that are meant without a length, or have it already, with whether they move the place of Z; borrowed: the local
    offset of the target may hold shifts of the zero, which end with it; feed: number, unit and per what of the feed in
    force, NaN: none was given yet, None: not known; losing: moves after which it is not in force, feed_lost: after one.
    """

    def __init__(self, job: Job, target: Target, options: Options) -> None:
        self.job = job
        self.target = target
        self.options = options
        self.values: dict[int, float] = dict(options.values)
        self.place: dict[str, float] = {}
        self.spindle = ""
        self.coolant = False
        self.switched: set[str] = set()
        self.uneven: set[str] = set()
        self.turns: dict[str, Transform] = {}
        self.program_place: dict[str, float] = {}
        self.zero = Zero(1)
        self.local_off = True
        self.borrowed = False
        self.kept: dict[float, tuple[Zero, bool]] = {}
        self.spare_used = False
        self.spare_places: dict[str, tuple[int, float]] = {}
        self.remembered: tuple[float | None, Zero, dict[str, float] | None, dict[str, float]] | None = None
        self.moved: set[str] = set()
        self.settled: SetFrame | None = None
        self.coming: tuple[SetFrame, Zero, dict[str, float]] | None = None
        self.axes = axes_of(job)
        self.local: dict[str, float] | None = {}
        self.suspended: dict[str, float] | None = None
        self.offsets: dict[int, dict[str, float]] = {}
        self.doubtful: set[int] = set()
        self.selected = 1
        self.shift: dict[str, float] | None = {}
        self.placed: SetFrame | None = None
        self.unit = next((a.unit for node in self.nodes() for a in quantities(node) if a.unit in MM), "mm")
        turned = any(isinstance(one, SetFrame) and one.action in {"rotate", "scale", "mirror"} for one in self.nodes())
        units = {a.unit for node in self.nodes() for a in quantities(node) if a.unit in MM}
        units |= {node.unit for node in self.nodes() if isinstance(node, Moves)}
        self.reads_places = not turned and len(units) == 1
        self.lowered: list[Lowered] = []
        self.assumed: dict[str, None] = {}
        self.spent = 0
        self.why = ""
        self.length: float | None = 0.0
        self.measuring = False
        uses = any(isinstance(one, UseLength) and one.on for one in self.nodes())
        self.length_known = uses or not options.measured_tools
        self.lengths_used: dict[int, float] = {}
        self.kept_length: float | None = None
        self.keeping = False
        self.at_machine: dict[str, float] = {}
        self.only: dict[str, int] = {}
        self.as_is: list[tuple[Node, bool]] = []
        self.feed: FeedInForce | None = NO_FEED
        self.feed_lost = False
        self.losing: list[Node] = []

    @property
    def transform(self) -> Transform:
        """What rotations, scalings and mirrors in force make of places, where the target has none of its own."""
        found = SAME
        for one in self.turns.values():
            found = one if found == SAME else joined(found, one) if one != SAME else found
        return found

    def through(self, node: Node) -> Node | None:
        """An operation behind the transform; None where a number that it needs is not known."""
        found = applied(node, self.transform, self.program_place)
        if found is not None:
            place, self.place = self.place, dict(self.program_place)
            self.after(node)
            place, self.place = self.place, place
            self.program_place = place
        return found

    # ---- the ways of a choice

    def snapshot(self) -> dict[str, Any]:
        """What is known here, to come back to."""
        return {name: copy(getattr(self, name)) for name in _KNOWN}

    def restore(self, known: dict[str, Any]) -> None:
        """Back to what was known."""
        for name, value in known.items():
            setattr(self, name, copy(value))

    def join(self, other: dict[str, Any]) -> None:
        """What is known where two ways meet: what both know."""
        for known, name in ((self.values, "values"), (self.place, "place"), (self.at_machine, "at_machine")):
            there = other[name]
            for key in [key for key, value in known.items() if there.get(key) != value]:
                del known[key]  # type: ignore[arg-type]
        self.spindle = self.spindle if self.spindle == other["spindle"] else ""
        self.coolant = self.coolant or other["coolant"]
        for number in self.offsets.keys() | other["offsets"].keys():
            if self.offsets.get(number) != other["offsets"].get(number):
                self._doubt(number)
        self.doubtful |= other["doubtful"]
        self.selected = self.selected if self.selected == other["selected"] else 0
        self.shift = self.shift if self.shift == other["shift"] else None
        self.uneven |= other["uneven"] | (self.switched ^ other["switched"])
        self.switched |= other["switched"]
        self.moved |= other["moved"]
        self.program_place = {}
        if self.zero != other["zero"]:
            there = other["zero"]
            places = {axis: at for axis in AXIS_NAMES if (at := self.zero.place(axis)) and at == there.place(axis)}
            self.zero = Zero(0, places)
        self.local_off = self.local_off and other["local_off"]
        self.borrowed |= other["borrowed"]
        self.kept = {key: one for key, one in self.kept.items() if other["kept"].get(key) == one}
        self.length = self.length if self.length == other["length"] else None
        self.measuring = self.measuring and other["measuring"]
        self.feed = self.feed if str(self.feed) == str(other["feed"]) else None
        self.feed_lost |= other["feed_lost"]
        for name in ("local", "suspended", "remembered"):
            if getattr(self, name) != other[name]:
                setattr(self, name, None)

    # ---- values

    def value(self, expr: Expr) -> float | None:
        """A constant, None where it is none."""
        found = constant(expr, self.values)
        return constant(expr, self._positions() | self.values) if found is None and self.reads_places else found

    def _positions(self) -> dict[int, float]:
        """Variables that hold where the axes are in work coordinates, where that is known (RS274: 5001 for X ...)."""
        scale = MM.get(self.unit, 1.0)
        return {
            POSITIONS + column: self.place[axis] / (scale if column < 3 else 1.0)
            for column, axis in enumerate(AXIS_NAMES) if axis in self.place
        }  # fmt: skip

    def mm(self, amount: Quantity) -> float | None:
        """A quantity in mm, degrees or its own unit."""
        value = self.value(amount.value)
        return None if value is None else value * MM.get(amount.unit, 1.0)

    def spend(self, count: int = 1) -> None:
        """Charge operations that were not in the source; TooLong."""
        self.spent += count
        if self.spent > MOST_OPERATIONS:
            raise TooLong

    def assume(self, text: str) -> None:
        """Note an assumption of the whole translation."""
        self.assumed[text] = None

    # ---- what an operation leaves

    def after(self, node: Node) -> None:
        """Follow an operation that stays as it is."""
        for axis in moved_by(node) & self.at_machine.keys():
            del self.at_machine[axis]
        self.feed = feed_after(node, self.feed, self.values)
        if gives_feed(node):
            self.feed_lost = any(node is one for one in self.losing)
            self.feed = None if self.feed_lost else self.feed
        if isinstance(node, Moves):
            self._after_moves(node)
        elif isinstance(node, MoveTo):
            self._go(node.to, known=node.frame == "work" and node.kind != "probe")
        elif isinstance(node, ArcTo):
            self._go(node.to, known=True)
        elif isinstance(node, DrillHole):
            self._after_hole(node)
        elif isinstance(node, SetVariable):
            self._set(node)
        elif isinstance(node, SetFrame):
            self._after_frame(node)
        elif isinstance(node, SwitchCoolant):
            off = node.mist is False and node.flood is False
            self.coolant = bool(node.mist or node.flood) or (self.coolant and not off)
            self._switch("coolant")
        elif isinstance(node, TurnSpindle):
            if node.direction != "speed":
                self._switch("spindle")
                self.spindle = node.direction
        elif isinstance(node, ParkAt | HomeAxes | ChangeTool | UseLength):
            self.place = {}
            self.moved.update(AXIS_NAMES)
            if isinstance(node, ChangeTool):
                self._after_change(node)
        elif isinstance(node, RunRoutine):
            body = self.job.routines[node.name].body
            self.forget(body)
            if node.count is None and all(isinstance(one, _STRAIGHT) for one in body[:-1]):
                for one in body:
                    if isinstance(one, _MOVING):
                        self.after(one)
        elif isinstance(node, LoopWhile | CountLoop | OptionalPart | RepeatGrid):
            self.forget((node,))

    def _switch(self, device: str) -> None:
        """A command for it on every way to here."""
        self.switched.add(device)
        self.uneven.discard(device)

    def _after_change(self, node: ChangeTool) -> None:
        number = None if node.number is None else self.value(node.number)
        known = self.values.get(SELECTED) if node.number is None else number
        if node.select and node.number is not None:
            self._keep(SELECTED, number)
        if node.change:
            self.spindle = "off" if node.rests else self.spindle
            self._keep(IN_SPINDLE, known)

    def _keep(self, key: int, value: float | None) -> None:
        """Of a variable's number, or SELECTED and IN_SPINDLE."""
        if value is None:
            self.values.pop(key, None)
        else:
            self.values[key] = value

    def come_back(self, select: SetFrame, moved: set[str]) -> None:
        """This operation, some operations on, brings back what is known now, but for the places of some axes."""
        place = {axis: at for axis, at in self.place.items() if axis not in moved}
        self.coming = select, self.zero, place

    def _after_shift(self, node: SetFrame) -> None:
        """How far the zero in force is from the work offset that was selected."""
        if node is self.placed or (node.action == "select" and not node.axes):
            self.shift = {}
        elif node.action in {"zero_at", "zero_recall"}:
            self.shift = None
        elif node.action in {"zero_shift", "local_here"} and self.shift is not None:
            for place in node.places:
                by, here = self.mm(place.at), self.place.get(place.axis)
                if node.action == "local_here":
                    by = None if by is None or here is None else here - by
                if by is None:
                    self.shift = None
                    return
                self.shift[place.axis] = self.shift.get(place.axis, 0.0) + by

    def _after_frame(self, node: SetFrame) -> None:
        if node.action == "zero_shift" and self.is_as_is(node):
            if "z" in self.place and next(moves for one, moves in self.as_is if one is node):
                self.place["z"] -= self.mm(node.places[0].at) or 0.0
            return
        self._after_shift(node)
        number = None if node.number is None else self.value(node.number)
        if self.coming is not None and node is self.coming[0]:
            found = {axis: self.machine_place(axis) for axis in AXIS_NAMES}
            self.at_machine = {axis: at for axis, at in found.items() if at is not None}
            _, self.zero, self.place = self.coming
            self.local, self.coming = {}, None
            return
        if node.action == "select" and not node.axes:
            places = self.spare_places if number == self.target.spare_offset else {}
            self.zero = Zero(0 if places or number is None else round(number), places)
            self.selected = 0 if number is None else round(number)
        elif node.action == "store" and number == self.target.spare_offset:
            self.zero = Zero(0, self.spare_places)
        elif node.action in {"store", "store_here"}:
            # What rests on the number that this offset had before is not known any more.
            kept = {axis: one for axis, one in self.zero.places.items() if one[0] != number}
            self.zero = self.zero if self.zero.offset else Zero(0, kept)
        elif node.action in {"local_here", "local_at", "local_add", "local_restore"}:
            self.local_off = False
        elif node.action in {"local_off", "local_suspend"}:
            self.local_off = True
            self.borrowed = False
        elif node.action == "zero_keep":
            self.remembered = number, self.zero, self.local, dict(self.place)
            self.kept_length = self.length
            self.keeping |= not self.is_as_is(node)
            self.moved.clear()
            return
        elif node.action == "zero_recall" and self.remembered is not None and self.remembered[0] == number:
            _, self.zero, self.local, place = self.remembered
            self.place = {axis: at for axis, at in place.items() if axis not in self.moved}
            return
        elif node.action == "zero_at":
            kept = {axis: one for axis in AXIS_NAMES if (one := self.zero.place(axis)) is not None}
            moved = {place.axis: self.mm(place.at) for place in node.places}
            kept |= {axis: (0, at) for axis, at in moved.items() if at is not None}
            self.zero = Zero(0, {axis: at for axis, at in kept.items() if moved.get(axis, 0.0) is not None})
        elif node.action.startswith("zero") or node.axes:
            self.zero = Zero()
        here = {p.axis: v for p in node.places if (v := self.mm(p.at)) is not None and not p.relative}
        if node.action == "local_here":
            self.local = self.local_after(node)
            named = {place.axis for place in node.places}
            self.place = {axis: at for axis, at in self.place.items() if axis not in named} | here
        elif node.action == "zero_shift":
            named = {p.axis for p in node.places}
            self.place = {
                axis: at - here.get(axis, 0.0) for axis, at in self.place.items() if axis in here or axis not in named
            }
        elif node.action == "zero_at":
            named = {p.axis for p in node.places}
            self.place = {axis: at for axis, at in self.place.items() if axis not in named}
            if self.local is not None:
                self.local = {axis: at for axis, at in self.local.items() if axis not in named}
        else:
            self.place = {}
            if node.action in {"local_off", "local_suspend"}:
                self.local = {}
            elif node.action.startswith(("local", "zero")):
                self.local = None

    def loses_local(self, node: SetFrame) -> bool:
        """Whether choosing a work offset ends a local one on the target, whose only offset it is, or what the job has
        stored there is not in it; or does not end shifts of the zero, which the target has in a local one."""
        is_select = node.action == "select" and node is not self.settled
        number = None if node.number is None else self.value(node.number)
        if is_select and "frame_select" in self.target.legal and (number in self.offsets or number in self.doubtful):
            return True
        one_offset = "frame_zero_shift" in self.target.legal and "frame_local_here" not in self.target.legal
        return is_select and ((one_offset and self.local != {}) or self.borrowed)

    def machine_place(self, axis: str) -> float | None:
        """Where an axis is, from machine zero and without a tool length; None where it is not known."""
        zero = self.zero.place(axis)
        if zero is not None and not zero[0] and axis in self.place and self.local == {}:
            return zero[1] + self.place[axis]
        return self.at_machine.get(axis)

    def copied(self, node: SetFrame) -> SetFrame:
        """Another operation with the same content, and for the same purpose."""
        found = replace(node)
        self.settled = found if self.settled is node else self.settled
        self.placed = found if self.placed is node else self.placed
        if self.coming is not None and self.coming[0] is node:
            self.coming = found, *self.coming[1:]
        return found

    def is_as_is(self, node: Node) -> bool:
        """Whether a frame is meant as it stands, without the length of the tool."""
        return any(node is one for one, _ in self.as_is)

    def loses_length(self, node: Node) -> bool:
        """Whether a tool length, which a target without lengths has in its zero, has to be put there again."""
        if "length" in self.target.legal or "frame_zero_shift" not in self.target.legal:
            return False
        if isinstance(node, ChangeTool):
            return node.change and self.measuring and not self.is_as_is(node)
        action = node.action if isinstance(node, SetFrame) else ""
        known = self.length_known or action != "zero_at"
        if self.length == 0.0 and known and not (action == "zero_recall" and self.kept_length):
            return False
        if isinstance(node, SetFrame):
            named = {"z", *(place.axis for place in node.places)} if node.action == "zero_recall" else set()
            named |= {place.axis for place in node.places} | (
                set(node.axes or "z") if node.action == "select" else set()
            )
            return node.action in {"select", "zero_at", "zero_recall"} and "z" in named and not self.is_as_is(node)
        return False

    def local_after(self, node: SetFrame) -> dict[str, float] | None:
        """The local offset after the present place has got these names; None where it is not known."""
        if self.local is None:
            return None
        found = dict(self.local)
        for place in node.places:
            at, value = self.place.get(place.axis), self.mm(place.at)
            if at is None or value is None or place.relative:
                return None
            found[place.axis] = found.get(place.axis, 0.0) + at - value
        return found

    def nodes(self) -> Iterable[Node]:
        """Every operation of the job as it was raised."""
        for body in (self.job.body, *(routine.body for routine in self.job.routines.values())):
            yield from walk(body)

    def _go(self, to: Iterable[AxisPlace], *, known: bool) -> None:
        for place in to:
            self.moved.add(place.axis)
            at = self.mm(place.at) if known else None
            if at is not None and place.relative:
                before = self.place.get(place.axis)
                at = None if before is None else before + at
            if at is None:
                self.place.pop(place.axis, None)
            else:
                self.place[place.axis] = at

    def _after_hole(self, node: DrillHole) -> None:
        self._go(node.at, known=node.repeats is None)
        self.moved.add(node.top.axis)
        top, before = self.mm(node.top.at), self.place.get(node.top.axis)
        if top is None or node.top.relative or (node.back == "before" and before is None):
            self.place.pop(node.top.axis, None)
        elif node.back == "top" or before is None or before < top:
            self.place[node.top.axis] = top

    def _after_moves(self, node: Moves) -> None:
        rows, scale = node.rows, MM[node.unit]
        for column, axis in enumerate(AXIS_NAMES):
            named = np.flatnonzero(rows["axes"] & np.uint8(1 << column))
            if not len(named):
                continue
            self.moved.add(axis)
            unit = scale if column < 3 else 1.0
            if node.relative:
                if axis in self.place:
                    self.place[axis] += float(rows["to"][named, column].sum()) * unit
            else:
                self.place[axis] = float(rows["to"][named[-1], column]) * unit

    def _set(self, node: SetVariable) -> None:
        number, value = self.value(node.target.number), self.value(node.value)
        if number is None:
            self.values.clear()
        elif value is None:
            self.values.pop(round(number), None)
        else:
            self.values[round(number)] = value

    def begin_routine(self, name: str) -> None:
        """At the start of a routine, which runs at any place of the job: what nothing in the job changes is known."""
        self.forget(self.job.routines[name].body)
        self.forget(self.job.body)
        self.values = {}

    def forget(self, body: Nodes) -> None:
        """What these operations may change is not known after them: places, and variables that they write."""
        self.place = {}
        self.uneven |= switched_perhaps(body, self.job.routines) - self.switched
        for node in reached(body, self.job.routines, set()):
            self._forget_device(node)
            self.feed = None if gives_feed(node) else self.feed
            self.feed_lost |= bool(self.options.straight_rapids)
            if isinstance(node, SetFrame):
                self.zero, self.local_off = Zero(), False
                if node.action in {"store", "store_here", "zero_keep"}:
                    self.kept = {}
                if node.action in {"store", "store_here", "select"}:
                    self._forget_offset(node)
                if node.action.startswith("zero"):
                    self.shift = None
                    self.borrowed |= node.action == "zero_shift" and "frame_zero_shift" not in self.target.legal
                if node.action.startswith(("local", "zero")):
                    self.local = None
            if isinstance(node, UseLength):
                self.length = None if node.on or self.length else self.length
                self.measuring |= node.on
            elif isinstance(node, ChangeTool):
                self.length = None if self.measuring else self.length
                self.values.pop(IN_SPINDLE, None)
                self.values.pop(SELECTED, None)
            elif isinstance(node, SetVariable):
                number = node.target.number
                if isinstance(number, Number):
                    self.values.pop(round(number.value), None)
                else:
                    self.values.clear()
            elif isinstance(node, CountLoop) and isinstance(node.variable.number, Number):
                self.values.pop(round(node.variable.number.value), None)
            elif isinstance(node, RunRoutine):
                for target, _ in node.arguments:
                    if isinstance(target.number, Number):
                        self.values.pop(round(target.number.value), None)

    def _doubt(self, number: int) -> None:
        self.offsets.pop(number, None)
        self.doubtful.add(number)

    def _forget_offset(self, node: SetFrame) -> None:
        """An operation on work offsets that runs, or does not."""
        if node.action == "select":
            self.selected = 0
        elif isinstance(node.number, Number):
            self._doubt(round(node.number.value))
        else:
            for number in range(1, MOST_OFFSETS):
                self._doubt(number)

    def _forget_device(self, node: Node) -> None:
        """What an operation may switch, or not."""
        if isinstance(node, TurnSpindle) and node.direction != "speed":
            self.spindle = ""
            self.switched.add("spindle")
        elif isinstance(node, ChangeTool) and node.rests:
            self.spindle = "off" if self.spindle == "off" else ""
        elif isinstance(node, SwitchCoolant):
            self.coolant |= bool(node.mist or node.flood)
            self.switched.add("coolant")

    @property
    def may_run(self) -> bool:
        """Whether the job may have spindle or coolant on here."""
        turns = "spindle" in self.switched and self.spindle != "off"
        return turns or ("coolant" in self.switched and self.coolant)

    def may_reverse(self, node: TurnSpindle) -> bool:
        """Whether the spindle may turn in the other direction before an operation that turns it in this one."""
        if self.spindle or "spindle" not in self.switched:
            return self.spindle in {"cw", "ccw"} - {node.direction}
        turns = {one.direction for one in self.nodes() if isinstance(one, TurnSpindle)}
        return {"cw", "ccw"} <= turns

    def routine_nodes(self, name: str) -> Iterable[Node]:
        """Operations of a routine and of those that it runs."""
        return reached(self.job.routines[name].body, self.job.routines, {name})
