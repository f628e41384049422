"""A legal Job as RS274/NGC. What Eding CNC, LinuxCNC and grbl write alike; sections are NIST IR 6556's."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from gproof.backend.emit.job_numbers import decimals_of, factor, feed_decimals, text_of
from gproof.backend.emit.job_writer import JobWriter
from gproof.backend.emit.printer import Unprintable
from gproof.backend.emit.rs274.tables import table_text
from gproof.ir.finding import Span
from gproof.ir.job import (
    LENGTHS,
    RAPID,
    AllowOverrides,
    ArcTo,
    AxisPlace,
    ChangeTool,
    Compensate,
    DrillHole,
    DwellFor,
    EndJob,
    Feed,
    Moves,
    MoveTo,
    Node,
    ParkAt,
    PauseJob,
    Quantity,
    SetFeed,
    SetFrame,
    SetPathMode,
    SwitchCoolant,
    TurnSpindle,
    UseLength,
    quantities,
)
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.program import Binary, Expr, Number

PLANES = {"xy": 17, "xz": 18, "yz": 19}
UNITS = {"mm": 21, "inch": 20}
PER = {"minute": 94, "move": 93, "revolution": 95}
CENTERS = {"x": "I", "y": "J", "z": "K"}
CYCLES = {
    "drill": 81, "dwell": 82, "peck": 83, "chip_break": 73, "bore": 85, "bore_stop": 86, "bore_dwell": 89,
    "tap_right": 84, "tap_left": 74,
}  # fmt: skip
OFFSETS = ("54", "55", "56", "57", "58", "59", "59.1", "59.2", "59.3")
LOCAL = {"local_off": "G92.1", "local_suspend": "G92.2", "local_restore": "G92.3"}
ORDER = "GXYZABCIJKRPQLEFSTHDM"
"""The words of a line, as people write them."""

# Steps of a line, in the order in which it is executed (NIST IR 6556, 3.8; Eding manual, table 3-7).
FEED_MODE, FEED, SPEED, TOOL, CHANGE, SPINDLE, COOLANT, OVERRIDES, OUTPUT, DWELL = range(10)
PLANE, UNIT, SIDE, LENGTH, OFFSET, PATH, DISTANCE, RETRACT, ONCE, MOTION, STOP = range(10, 21)

FACTOR_DECIMALS = 9
"""Of the number by which an expression in another unit is divided."""


class Rs274Writer(JobWriter):
    """handlers: what prints an operation, by its type."""

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.handlers: dict[type, Callable[[Any], None]] = {
            MoveTo: self.move, ArcTo: self.arc, DrillHole: self.hole, SetFeed: self.set_feed, DwellFor: self.dwell,
            PauseJob: self.pause, TurnSpindle: self.spindle, SwitchCoolant: self.coolant, ChangeTool: self.tool,
            SetFrame: self.frame, SetPathMode: self.path, Compensate: self.side, UseLength: self.length,
            ParkAt: self.park, AllowOverrides: self.overrides, EndJob: self.end,
        }  # fmt: skip
        self.axes = tuple(name.upper() if name in self.target.axes else "" for name in AXIS_NAMES)

    def node(self, node: Node) -> None:
        """An operation, by its handler; Unprintable."""
        if self.state.get("cycle") is not None and not isinstance(node, DrillHole):
            self.line("G80")
            self.state["cycle"], self.state["motion"] = None, None
        handler = self.handlers.get(type(node))
        if handler is None:
            raise Unprintable(type(node).__name__)
        self.unit(node)
        handler(node)

    def header(self) -> list[str]:
        """The modes that the whole job shares."""
        words = []
        if "unit" in self.constant:
            words.append(f"G{UNITS[self.constant['unit']]}")
        if "plane" in self.constant:
            words.append(f"G{PLANES[self.constant['plane']]}")
        if "relative" in self.constant:
            words.append("G91" if self.constant["relative"] else "G90")
        if "per" in self.constant:
            words.append(f"G{PER[self.constant['per']]}")
        return [*self.style.header, *([" ".join(words)] if words else [])]

    # ---- values

    def expression(self, value: Expr) -> str:
        """A value after a letter; Unprintable where the target has only numbers."""
        if isinstance(value, Number):
            return text_of(value.value, self.style.decimals)
        raise Unprintable("an expression")

    def scaled(self, value: Expr, by: float) -> Expr:
        """A value times a number."""
        if by == 1.0:
            return value
        if isinstance(value, Number):
            return Number(value.value * by, value.span)
        # A divisor has fewer digits than what is less than 1: 25.4, 1000.
        operator, number = ("*", by) if by > 1.0 else ("/", round(1.0 / by, FACTOR_DECIMALS))
        return Binary(operator, value, Number(number, value.span), value.span)

    def amount(self, amount: Quantity, *, summed: bool = False) -> str:
        """A quantity in the unit of the text. summed: see ``decimals_of``."""
        unit = self.state.get("unit", amount.unit) if amount.unit in LENGTHS else amount.unit
        value = self.scaled(amount.value, factor(amount.unit, unit))
        if isinstance(value, Number):
            return text_of(value.value, decimals_of(self.style, unit, summed=summed))
        return self.expression(value)

    def words(self, places: tuple[AxisPlace, ...], *, summed: bool = False) -> list[str]:
        """Axis words. summed: they are those of a zero."""
        ordered = sorted(places, key=lambda place: AXIS_NAMES.index(place.axis))
        for place in ordered:
            self.check_axis(AXIS_NAMES.index(place.axis))
        return [f"{place.axis.upper()}{self.amount(place.at, summed=summed or place.relative)}" for place in ordered]

    def check_axis(self, column: int) -> None:
        """Unprintable for an axis that the target does not have."""
        if not self.axes[column]:
            raise Unprintable(f"axis {AXIS_NAMES[column].upper()}")

    # ---- modes

    def mode(self, name: str, value: object, rank: int, word: str, span: Span) -> None:
        """A word, where the text is not in that mode."""
        if self.state.get(name) != value:
            self.put(rank, [word], span)
            self.state[name] = value

    def unit(self, node: Node) -> None:
        """The unit of an operation's lengths, on a line of its own: F is read in the unit before."""
        found = [amount.unit for amount in quantities(node) if amount.unit in LENGTHS]
        if found and self.state.get("unit") not in found:
            self.line(f"G{UNITS[found[0]]}")
            self.state["unit"] = found[0]

    def distances(self, places: tuple[AxisPlace, ...], span: Span) -> None:
        """G90 or G91."""
        relative = {place.relative for place in places}
        if len(relative) > 1:
            raise Unprintable("absolute and relative places in one move")
        for one in relative:
            self.mode("relative", one, DISTANCE, "G91" if one else "G90", span)

    def feed(self, feed: Feed | None, span: Span) -> list[str]:
        """F, with what it is per."""
        if feed is None:
            return []
        self.mode("per", feed.per, FEED_MODE, f"G{PER[feed.per]}", span)
        unit = feed.amount.unit
        value = self.scaled(feed.amount.value, factor(unit, self.state.get("unit", unit) if unit in LENGTHS else unit))
        if isinstance(value, Number):
            return [f"F{text_of(value.value, feed_decimals(value.value, decimals_of(self.style, unit)))}"]
        return [f"F{self.expression(value)}"]

    def motion(self, code: float, span: Span, words: list[str], feed: list[str], *, machine: bool = False) -> None:
        """A line of motion; machine: in machine coordinates."""
        if feed:
            self.put(FEED, feed, span)
        if machine:
            self.put(ONCE, ["G53"], span)
            self.state.pop("motion", None)
        found = [] if self.state.get("motion") == code else [f"G{code:g}"]
        self.put(MOTION, [*found, *words], span)
        self.state["motion"] = code

    # ---- operations

    def move(self, node: MoveTo) -> None:
        """G0, G1, G38.2; G53."""
        feed = self.feed(node.feed, node.span)
        if node.kind == "rapid" and feed:
            raise Unprintable("a feed of a rapid")
        self.distances(node.to, node.span)
        code = {"rapid": 0.0, "feed": 1.0, "probe": 38.2}[node.kind]
        words = self.words(node.to)
        self.motion(code, node.span, words, feed, machine=node.frame == "machine")

    def arc(self, node: ArcTo) -> None:
        """G2, G3 with I, J, K or R."""
        feed = self.feed(node.feed, node.span)
        self.mode("plane", node.plane, PLANE, f"G{PLANES[node.plane]}", node.span)
        self.distances(node.to, node.span)
        words = self.words(node.to)
        words += [f"{CENTERS[place.axis]}{self.amount(place.at)}" for place in node.center]
        if node.radius is not None:
            words.append(f"R{self.amount(node.radius)}")
        if node.turns is not None:
            words.append(f"P{self.expression(node.turns)}")
        self.motion(2.0 if node.clockwise else 3.0, node.span, words, feed)

    def moves(self, node: Moves) -> None:
        """A table; the words of modes are on its first line."""
        for column in np.flatnonzero([(node.rows["axes"] & np.uint8(1 << n)).any() for n in range(len(AXIS_NAMES))]):
            self.check_axis(int(column))
        if self.state.get("cycle") is not None:
            self.line("G80")
            self.state["cycle"], self.state["motion"] = None, None
        if self.state.get("unit") != node.unit:
            self.line(f"G{UNITS[node.unit]}")
        first = []
        if self.state.get("relative") != node.relative:
            first.append(91.0 if node.relative else 90.0)
        if (node.rows["kind"] > 2).any():
            if self.state.get("plane") != node.plane:
                first.append(float(PLANES[node.plane]))
            self.state["plane"] = node.plane
        cuts = node.rows["feed"][node.rows["kind"] > RAPID]
        # G94 takes the feed away: only with an F, and where a move has the feed before it, its mode is in force.
        if self.state.get("per") != node.per and len(cuts) and not np.isnan(cuts[0]):
            first.append(float(PER[node.per]))
            self.state["per"] = node.per
        motion = self.state.get("motion")
        code = int(motion) if motion is not None and motion in {0.0, 1.0, 2.0, 3.0} else None
        text, last = table_text(node, self.style, self.axes, first, code, self.style.indent * self.depth)
        self.out.append(text)
        self.last_line_of, self.commented = int(node.rows["line"][-1]), False
        self.state |= {"unit": node.unit, "relative": node.relative, "motion": float(last)}

    def hole(self, node: DrillHole) -> None:
        """G73, G74, G81 to G89; words that stay are printed when they change."""
        feed = self.feed(node.feed, node.span)
        self.mode("plane", node.plane, PLANE, f"G{PLANES[node.plane]}", node.span)
        self.distances((*node.at, node.top), node.span)
        if self.state.get("cycle") is not None and self.state.get("back") != node.back:
            self.series_ends()
        self.mode("back", node.back, RETRACT, "G98" if node.back == "before" else "G99", node.span)
        series = [f"{node.bottom.axis.upper()}{self.amount(node.bottom.at)}", f"R{self.amount(node.top.at)}"]
        if node.peck is not None:
            series.append(f"Q{self.amount(node.peck, summed=True)}")
        if node.dwell is not None:
            series.append(f"P{self.seconds(node.dwell)}")
        repeats = [] if node.repeats is None else [f"L{self.expression(node.repeats)}"]
        known = (node.kind, tuple(series), node.top.relative)
        at = self.words(node.at)
        if self.state.get("cycle") == known and at:
            series = []
        self.motion(float(CYCLES[node.kind]), node.span, [*at, *series, *repeats], feed)
        self.state["cycle"] = known

    def series_ends(self) -> None:
        """Between two holes of one series that go back to different heights."""

    def set_feed(self, node: SetFeed) -> None:
        """F alone."""
        self.put(FEED, self.feed(node.feed, node.span), node.span)

    def dwell(self, node: DwellFor) -> None:
        """G4 P, seconds."""
        self.put(DWELL, ["G4", f"P{self.seconds(node.time)}"], node.span)
        self.flush()

    def seconds(self, time: Quantity) -> str:
        """A time as P has it."""
        return self.expression(self.scaled(time.value, 0.001) if time.unit == "ms" else time.value)

    def pause(self, node: PauseJob) -> None:
        """M0, M1; T, for a tool that the operator puts in."""
        if node.tool is not None:
            self.flush()
            self.put(TOOL, [f"T{self.expression(node.tool)}"], node.span)
        self.put(STOP, ["M1" if node.optional else "M0"], node.span)

    def spindle(self, node: TurnSpindle) -> None:
        """S, M3, M4, M5."""
        if node.speed is not None:
            self.put(SPEED, [f"S{self.amount(node.speed)}"], node.span)
        if node.direction != "speed":
            self.put(SPINDLE, [{"cw": "M3", "ccw": "M4", "off": "M5"}[node.direction]], node.span)

    def coolant(self, node: SwitchCoolant) -> None:
        """M7, M8, M9."""
        if node.mist is False or node.flood is False:
            if (node.mist, node.flood) != (False, False) and self.both_coolants:
                raise Unprintable("one coolant off, the other as it is")
            self.put(COOLANT, ["M9"], node.span)
            return
        if node.mist:
            self.put(COOLANT, ["M7"], node.span)
        if node.flood:
            self.flush()
            self.put(COOLANT, ["M8"], node.span)

    @cached_property
    def both_coolants(self) -> bool:
        """The job has mist and flood on: M9 would end both."""
        switched = [node for node in self.all_nodes() if isinstance(node, SwitchCoolant)]
        return any(node.mist for node in switched) and any(node.flood for node in switched)

    def tool(self, node: ChangeTool) -> None:
        """T, M6."""
        if node.number is not None:
            self.put(TOOL, [f"T{self.expression(node.number)}"], node.span)
        if node.change:
            self.put(CHANGE, ["M6"], node.span)

    def frame(self, node: SetFrame) -> None:
        """G54 to G59.3, G10, G92."""
        if node.action == "select":
            assert isinstance(node.number, Number)
            self.put(OFFSET, [f"G{OFFSETS[round(node.number.value) - 1]}"], node.span)
        elif node.action in {"store", "store_here"}:
            assert node.number is not None
            key = "2" if node.action == "store" else "20"
            words = ["G10", f"L{key}", f"P{self.expression(node.number)}", *self.words(node.places, summed=True)]
            self.put(ONCE, words, node.span)
            self.flush()
        elif node.action == "local_here":
            self.put(ONCE, ["G92", *self.words(node.places, summed=True)], node.span)
            self.flush()
        elif node.action in LOCAL:
            self.put(ONCE, [LOCAL[node.action]], node.span)
        else:
            raise Unprintable(node.action)

    def path(self, node: SetPathMode) -> None:
        """G61, G61.1, G64."""
        code = {"exact_path": "G61", "exact_stop": "G61.1", "continuous": "G64"}[node.mode]
        tolerance = [] if node.tolerance is None else [f"P{self.amount(node.tolerance)}"]
        tolerance += [] if node.simplify is None else [f"Q{self.amount(node.simplify)}"]
        tolerance += [] if node.angle is None else [f"R{self.amount(node.angle)}"]
        if tolerance:
            self.flush()
        self.put(PATH, [code, *tolerance], node.span)
        if tolerance:
            self.flush()

    def side(self, node: Compensate) -> None:
        """G40, G41, G42."""
        if node.side == "off":
            self.put(SIDE, ["G40"], node.span)
            return
        code = "G41" if node.side == "left" else "G42"
        if node.diameter is not None:
            self.put(SIDE, [f"{code}.1", f"D{self.amount(node.diameter)}"], node.span)
        else:
            self.put(SIDE, [code, *([] if node.tool is None else [f"D{self.expression(node.tool)}"])], node.span)

    def length(self, node: UseLength) -> None:
        """G43, G49."""
        if not node.on:
            self.put(LENGTH, ["G49"], node.span)
        else:
            self.put(LENGTH, ["G43", *([] if node.tool is None else [f"H{self.expression(node.tool)}"])], node.span)

    parks_all = False
    """Every axis goes to the parking place, by way of a place that names only some of them."""

    def park(self, node: ParkAt) -> None:
        """G28, G30."""
        if node.to and not self.parks_all:
            self.move(MoveTo(to=node.to, kind="rapid", span=node.span))
            node = replace(node, to=())
        self.distances(node.to, node.span)
        self.put(ONCE, ["G28" if node.number == 1 else "G30", *self.words(node.to)], node.span)
        self.flush()

    def overrides(self, node: AllowOverrides) -> None:
        """M48, M49."""
        self.put(OVERRIDES, ["M48" if node.on else "M49"], node.span)

    def end(self, node: EndJob) -> None:
        """M2, M30."""
        self.put(STOP, ["M30" if node.reset else "M2"], node.span)

    # ---- lines

    def in_order(self, words: list[str]) -> str:
        """G codes first, then axes, and M last."""
        return " ".join(sorted(words, key=lambda word: ORDER.index(word[0])))
