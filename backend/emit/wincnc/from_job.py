"""A legal Job as text of WinCNC: the job, and a file for each subprogram. Headings of the manual in brackets.

A line has one command. What has codes on other controllers and none here (spindle, coolant, tools) is what the shop's
CNC.MAC has under the usual codes [Macro File Configuration].
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from gproof.backend.emit.job_numbers import decimals_of, factor, feed_decimals, text_of
from gproof.backend.emit.job_writer import JobWriter, joined
from gproof.backend.emit.printer import Unprintable
from gproof.backend.emit.wincnc.feeds import feed_groups, forget_feeds, needs_feed
from gproof.backend.emit.wincnc.job_walk import (
    OPEN_FEED,
    ZERO,
    Rate,
    bits,
    feed_after,
    kept_before,
    number,
    own_zero,
    rate_of,
    shifted_back,
    zeros_for_a_while,
)
from gproof.backend.emit.wincnc.tables import table_text
from gproof.backend.emit.wincnc.zeros_away import ZerosAway
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import Span
from gproof.ir.job import (
    LENGTHS,
    ArcTo,
    AxisPlace,
    ChangeTool,
    Choice,
    CountLoop,
    DrillHole,
    DwellFor,
    EndJob,
    Feed,
    HomeAxes,
    Job,
    LeaveRoutine,
    LoopWhile,
    Moves,
    MoveTo,
    Node,
    Nodes,
    PauseJob,
    Quantity,
    Remark,
    RepeatGrid,
    Routine,
    RunRoutine,
    SetFeed,
    SetFrame,
    SwitchCoolant,
    SwitchOutput,
    TurnSpindle,
    UseLength,
    WaitFor,
    quantities,
    walk,
)
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.program import Input, Text, Unary
from gproof.ir.target import Style, Target

UNITS = {"mm": "G22", "inch": "G20", "cm": "G21"}
CYCLES = {"drill": "G81", "dwell": "G82", "peck": "G83", "chip_break": "G73"}
BY_WAY = "a feed that depends on the way that the program took"
NAME = re.compile(r"[^A-Z0-9_]+")


class WinCncWriter(JobWriter):
    """files: text of the subprogram files, by name; loose: lines of choices that are files of their own."""

    def __init__(self, job: Job, target: Target, machine: Machine, style: Style) -> None:
        super().__init__(job, target, machine, style)
        self.controls = wincnc_settings(machine)
        self.groups = feed_groups(machine)
        letters = {axis.index: axis.word for axis in machine.axes}
        self.letters = tuple(
            letters.get(column, "" if letters else "XYZABC"[column]) for column in range(len(AXIS_NAMES))
        )
        self.files: dict[str, bytes] = {}
        self.in_file = ""
        self.away = ZerosAway({AXIS_NAMES[column] for column, letter in enumerate(self.letters) if letter})
        self.enough: list[Node] = []
        self.in_structure = False
        self.entries: dict[str, Rate | None] = {}
        self.exits: dict[tuple[str, Rate | None], Rate | None] = {}
        feed_after(self.job.body, None, self)
        self.handlers: dict[type, Callable[[Any], None]] = {
            MoveTo: self.move, ArcTo: self.arc, DrillHole: self.hole, SetFeed: self.set_feed, DwellFor: self.dwell,
            PauseJob: self.pause, TurnSpindle: self.spindle, SwitchCoolant: self.coolant, ChangeTool: self.tool,
            SetFrame: self.frame, UseLength: self.length, EndJob: self.end, HomeAxes: self.home,
            SwitchOutput: self.output, WaitFor: self.wait, RunRoutine: self.run, LeaveRoutine: self.leave,
        }  # fmt: skip

    # ---- the whole

    def write(self) -> bytes:
        """The text of the job; those of its files are in ``files``."""
        for name, routine in self.job.routines.items():
            self._file(self.names[name], routine, self.entries.get(name))
        self.out, self.state, self.in_file = [], dict(self.constant), ""
        body, _ = own_zero(self.job.body)
        body = shifted_back(kept_before(body), self.job)
        first = next((place for place, node in enumerate(body) if not isinstance(node, Remark)), len(body))
        self.body(body[:first])
        for line in self.header():
            self.line(line)
        self.body(body[first:])
        self._end_cycle()
        if self._leaves(self.job.body):
            self.line("L92")
        for line in self.footer():
            self.line(line)
        return b"".join(self.out)

    def header(self) -> list[str]:
        """The modes that the whole job shares; each is a command of its own."""
        found = list(self.style.header)
        if "unit" in self.constant:
            found.append(UNITS[self.constant["unit"]])
        if "relative" in self.constant:
            found.append("G91" if self.constant["relative"] else "G90")
        if self.constant.get("per") == "move":
            found.append("G93")
        return found

    def _file(self, name: str, routine: Routine, feed: Rate | None) -> None:
        """A subprogram [M98]; L92 leaves its zero to the caller, where the file does not give it back."""
        self.out, self.state, self.in_file = [], dict(self.constant), name
        self.state["feed"] = feed
        body, _ = own_zero(routine.body)
        body = shifted_back(kept_before(body), self.job)
        if self._leaves(routine.body):
            self.line("L92")
        if body and isinstance(body[-1], LeaveRoutine):
            body = body[:-1]
        self.body(body)
        self._end_cycle()
        self.files[name] = b"".join(self.out)

    def _leaves(self, body: Nodes) -> bool:
        """Whether a body, or a file that it runs, leaves a zero behind that the end of the file would take back."""
        rest, keeps = own_zero(body)
        # What is brought back at the end is what the end of a file does by itself.
        return keeps or (rest is body and self._inner_zero(body))

    def _inner_zero(self, body: Nodes) -> bool:
        """Whether files that a body runs leave a zero to it."""
        return any(
            isinstance(node, RunRoutine) and self._leaves(self.job.routines[node.name].body) for node in walk(body)
        )

    def routine_name(self, name: str) -> str:
        """The name of a file."""
        stem = NAME.sub("_", self.plain_name(name).upper())
        return f"{stem}{self.style.extension.upper()}"

    def comment(self, text: str) -> str:
        """``[text]`` [Comment]."""
        return f"({text})" if "]" in text and ")" not in text else f"[{text.replace(']', ')')}]"

    def joins(self, rank: int, words: list[str]) -> bool:
        """A line has one command."""
        return False

    def body(self, nodes: Nodes) -> None:
        """A list of operations, up to the end of the job."""
        self.enough += zeros_for_a_while(nodes)
        for place, node in enumerate(nodes):
            if isinstance(node, EndJob) and self._is_last(node):
                self._end_cycle()
                super().body(tuple(one for one in nodes[place + 1 :] if isinstance(one, Remark)))
                return
            super().body((node,))

    def _is_last(self, node: EndJob) -> bool:
        """Whether the job is over at its end: the file is then, too."""
        return not self.in_file and any(one is node for one in self.job.body)

    def node(self, node: Node) -> None:
        """An operation, by its handler; Unprintable."""
        if not isinstance(node, DrillHole):
            self._end_cycle()
        handler = self.handlers.get(type(node))
        if handler is None:
            raise Unprintable(type(node).__name__)
        self.unit([amount.unit for amount in quantities(node)])
        handler(node)
        self.flush()

    def _end_cycle(self) -> None:
        """G80: the next line is no hole."""
        if self.state.get("cycle") is not None:
            self.line("G80")
            self.state["cycle"] = self.state["motion"] = None

    # ---- values and modes

    def amount(self, amount: Quantity, *, summed: bool = False) -> str:
        """A quantity in the unit of the text; Unprintable for an expression. summed: see ``decimals_of``."""
        unit = self.state.get("unit", amount.unit) if amount.unit in LENGTHS else amount.unit
        digits = decimals_of(self.style, unit, summed=summed)
        return text_of(number(amount.value) * factor(amount.unit, unit), digits)

    def words(self, places: Iterable[AxisPlace], *, summed: bool = False) -> list[str]:
        """Axis words. summed: they are those of a zero."""
        ordered = sorted(places, key=lambda place: AXIS_NAMES.index(place.axis))
        self.need_axes(bits(ordered))
        return [
            f"{self.letters[AXIS_NAMES.index(place.axis)]}{self.amount(place.at, summed=summed or place.relative)}"
            for place in ordered
        ]

    def need_axes(self, columns: int) -> None:
        """Unprintable for an axis that the machine does not have."""
        for column, letter in enumerate(self.letters):
            if columns >> column & 1 and not letter:
                raise Unprintable(f"axis {AXIS_NAMES[column].upper()}, which the machine does not have")

    def say(self, *words: str) -> None:
        """A line."""
        self.line(" ".join(words))

    def command(self, span: Span, *words: str) -> None:
        """A line of the source's line, so that its comment can be at its end."""
        self.put(0, [" ".join(words)], span)

    def unit(self, units: list[str]) -> None:
        """G20, G21, G22: what a feed is after it, the manual leaves open."""
        found = [unit for unit in units if unit in LENGTHS]
        if found and self.state.get("unit") not in found:
            self.line(UNITS[found[0]])
            self.state["unit"] = found[0]
            self.state["cycle"] = None
            forget_feeds(self.state)

    def distances(self, places: Iterable[AxisPlace]) -> None:
        """G90, G91."""
        relative = {place.relative for place in places}
        if len(relative) > 1:
            raise Unprintable("absolute and relative places in one move")
        for one in relative:
            if self.state.get("relative") != one:
                self.line("G91" if one else "G90")
                self.state["relative"] = one

    def feed(self, feed: Feed | None, columns: int, *, arc: bool = False) -> list[str]:
        """F, where a group of the axes that move has another feed."""
        if feed is not None:
            self.state["feed"] = rate_of(feed)
        rate: Rate | None = self.state.get("feed")
        if rate is None:
            return []
        if rate == OPEN_FEED:
            raise Unprintable(BY_WAY)
        value, unit, per = rate
        if per == "revolution" or (per == "move" and arc):
            raise Unprintable("a feed per revolution, or inverse time of an arc")
        self._per(per)
        value *= factor(unit, self.state.get("unit", unit))
        if per == "move" or needs_feed(self.state, self.groups, value, columns, arc=arc):
            return [f"F{text_of(value, feed_decimals(value, self.style.decimals))}"]
        return []

    def _per(self, per: str) -> None:
        if self.state.get("per") != per:
            self.line("G93" if per == "move" else "G94")
            self.state["per"] = per

    def code(self, name: str) -> list[str]:
        """A motion's code; that of an arc always, as whether it stays is a setting."""
        if self.state.get("motion") == float(name[1:]):
            return []
        self.state["motion"] = float(name[1:])
        return [name]

    # ---- motion

    def move(self, node: MoveTo) -> None:
        """G0, G1, G53."""
        columns = bits(node.to)
        if node.frame == "machine":
            if node.kind != "rapid" or any(place.relative for place in node.to):
                raise Unprintable("a move in machine coordinates that is no rapid to a place")
            self.distances(())
            if self.state.get("relative") is not False:
                self.line("G90")
                self.state["relative"] = False
            self.command(node.span, "G53", *self.words(node.to))
            return
        if node.kind == "rapid" and node.feed is not None:
            self.state["feed"] = rate_of(node.feed)
        self.distances(node.to)
        if node.kind == "rapid":
            self.command(node.span, *self.code("G0"), *self.words(node.to))
            return
        feed = self.feed(node.feed, columns)
        self.command(node.span, *self.code("G1"), *self.words(node.to), *feed)

    def arc(self, node: ArcTo) -> None:
        """G2, G3 with both I and J."""
        if node.plane != "xy" or node.radius is not None or node.turns is not None:
            raise Unprintable("an arc by its radius, in another plane or of several turns")
        if any(not place.relative for place in node.center):
            raise Unprintable("an arc whose centre is a place")
        self.distances(node.to)
        center = {place.axis: self.amount(place.at) for place in node.center}
        feed = self.feed(node.feed, bits(node.to), arc=True)
        words = [f"I{center.get('x', '0')}", f"J{center.get('y', '0')}", *feed]
        self.state["motion"] = None
        self.command(node.span, "G2" if node.clockwise else "G3", *self.words(node.to), *words)

    def moves(self, node: Moves) -> None:
        """A table."""
        self._end_cycle()
        self.need_axes(int(np.bitwise_or.reduce(node.rows["axes"])))
        self.unit([node.unit])
        if self.state.get("relative") != node.relative:
            self.line("G91" if node.relative else "G90")
            self.state["relative"] = node.relative
        arcs = node.rows["kind"] > 2
        if arcs.any() and (node.plane != "xy" or node.per == "move"):
            raise Unprintable("an arc in another plane, or with inverse time")
        given = ~np.isnan(node.rows["feed"])
        before: Rate | None = self.state.get("feed")
        start = np.nan
        if before == OPEN_FEED:
            before = None
            moving = node.rows["kind"] != 1
            if moving.any() and not given[: int(np.argmax(moving)) + 1].any():
                raise Unprintable(BY_WAY)
        if before is not None and (not given.any() or before[2] == node.per):
            start = before[0] * factor(before[1], node.unit)
        per = node.per if given.any() else before[2] if before is not None else None
        if per == "revolution":
            raise Unprintable("a feed per revolution")
        if per is not None and (node.rows["kind"] != 1).any():
            self._per(per)
        self.out.append(table_text(node, self.style, self.letters, self.state, self.groups, start))
        if given.any():
            last = float(node.rows["feed"][np.flatnonzero(given)[-1]])
            self.state["feed"] = last, node.unit, node.per
        self.last_line_of, self.commented = int(node.rows["line"][-1]), False

    def hole(self, node: DrillHole) -> None:
        """G73, G81 to G83: each line has all its words."""
        if node.plane != "xy" or node.back != "top" or node.repeats is not None or node.top.relative:
            raise Unprintable("a hole in another plane, or that repeats")
        if self.state.get("relative") is not False:
            self.line("G90")
            self.state["relative"] = False
        words = [*self.words(node.at), *self.words([node.bottom]), f"R{self.amount(node.top.at)}"]
        if node.peck is not None:
            words.append(f"Q{self.amount(node.peck, summed=True)}")
        if node.kind == "dwell" and node.dwell is not None:
            scale = {"s": 1000.0, "ms": 1.0}[node.dwell.unit]
            words.append(f"P{text_of(number(node.dwell.value) * scale, self.style.decimals)}")
        self.state["cycle"] = node.kind
        self.command(node.span, CYCLES[node.kind], *words, *self.feed(node.feed, 4))

    def set_feed(self, node: SetFeed) -> None:
        """Printed with the next move."""
        self.state["feed"] = rate_of(node.feed)

    # ---- devices

    def dwell(self, node: DwellFor) -> None:
        """G4 X, seconds."""
        seconds = number(node.time.value) * (0.001 if node.time.unit == "ms" else 1.0)
        self.command(node.span, "G4", f"X{text_of(seconds, self.style.decimals)}")

    def pause(self, node: PauseJob) -> None:
        """G4 alone: until the operator goes on."""
        if node.optional:
            raise Unprintable("an optional stop")
        self.command(node.span, "G4")

    def spindle(self, node: TurnSpindle) -> None:
        """S; M3, M4, M5 of CNC.MAC."""
        if node.speed is not None:
            self.command(node.span, f"S{self.amount(node.speed)}")
            self.flush()
        if node.direction != "speed":
            self.command(node.span, {"cw": "M3", "ccw": "M4", "off": "M5"}[node.direction])

    def coolant(self, node: SwitchCoolant) -> None:
        """M7, M8, M9 of CNC.MAC."""
        if node.mist is False or node.flood is False:
            used = {name for one in self.all_nodes() if isinstance(one, SwitchCoolant)
                    for name in ("mist", "flood") if getattr(one, name)}  # fmt: skip
            ended = {name for name in ("mist", "flood") if getattr(node, name) is False}
            if not used <= ended:
                raise Unprintable("one coolant off, the other as it is")
            self.command(node.span, "M9")
        for name, code in (("mist", "M7"), ("flood", "M8")):
            if getattr(node, name):
                self.command(node.span, code)
                self.flush()

    def tool(self, node: ChangeTool) -> None:
        """M6 T of CNC.MAC."""
        if not node.change or node.number is None:
            raise Unprintable("a tool that is selected before its change")
        tool = text_of(number(node.number), 0)
        self.command(node.span, "M6", f"T{tool}")
        self.state["motion"] = None
        self.flush()
        if not self.lengths():
            # A tool's measure counts from its number on.
            self.say("G49")

    def lengths(self) -> bool:
        """Whether tool lengths are in force, or may be."""
        on = any(isinstance(node, UseLength) and node.on for node in self.all_nodes())
        usual = on or self.job.source == "wincnc"
        return bool(self.state.get("lengths", usual))

    def output(self, node: SwitchOutput) -> None:
        """M11, M12; M13, M14 without stopping."""
        on = number(node.value) != 0.0
        code = ("M13" if on else "M14") if node.moving else ("M11" if on else "M12")
        self.command(node.span, code, f"C{text_of(number(node.channel), 0)}")

    def wait(self, node: WaitFor) -> None:
        """M17, M18."""
        if node.on is None or node.timeout is not None:
            raise Unprintable("a wait for an input with a time limit")
        self.command(node.span, "M17" if node.on else "M18", f"C{text_of(number(node.channel), 0)}")

    def length(self, node: UseLength) -> None:
        """G43, G49: that of the tool in the spindle."""
        self.command(node.span, "G43" if node.on else "G49")
        self.state["lengths"] = node.on

    def home(self, node: HomeAxes) -> None:
        """G28, axis by axis."""
        for axis in node.axes:
            self.command(node.span, "G28", self.letters[AXIS_NAMES.index(axis)])
            self.flush()

    # ---- zeros

    def frame(self, node: SetFrame) -> None:
        """G92, G92.1, G92.2; G52, G50."""
        if self.in_structure and self.away.keeps and node.action in ZERO:
            raise Unprintable("a zero that is kept, and changed in a choice")
        if not self.in_structure and node.action in ZERO:
            done = self.away.frame(node, any(node is one for one in self.enough))
            if done.says:
                self.command(node.span, "G92.3")
                self.flush()
                self.state["cycle"] = None
            if done.over:
                return
        words = self.words(node.places, summed=True)
        if node.action in {"local_here", "zero_at", "zero_shift"}:
            code = {"local_here": "G92", "zero_at": "G92.1", "zero_shift": "G92.2"}[node.action]
            self.command(node.span, code, *words)
        elif node.action == "rotate" and node.angle is not None:
            center = {place.axis: self.amount(place.at) for place in node.places}
            angle = number(node.angle.value) * self.controls.rotation_sign
            turn = text_of(angle, self.style.decimals_deg)
            self.command(node.span, "G52", f"I{center.get('x', '0')}", f"J{center.get('y', '0')}", f"A{turn}")
        elif node.action == "rotate_off":
            self.command(node.span, "G50")
        else:
            raise Unprintable(f"a frame: {node.action}")
        self.state["cycle"] = None

    # ---- structure

    def run(self, node: RunRoutine) -> None:
        """M98."""
        if node.arguments or node.count is not None:
            raise Unprintable("a subprogram with arguments, or that repeats")
        self.command(node.span, "M98", self.names[node.name])
        feed = feed_after((node,), self.state.get("feed"), self)
        self.state = dict(self.constant)
        self.state["feed"] = feed

    def leave(self, node: LeaveRoutine) -> None:
        """M99."""
        self.command(node.span, "M99")

    def end(self, node: EndJob) -> None:
        """M99.1, where nothing runs after it."""
        if self.controls.abort:
            raise Unprintable("an end of the job before its last line, on a controller with cmdabort=")
        self.command(node.span, "M99.1")

    def structure(self, node: Node) -> None:
        """A choice, or an array."""
        self._end_cycle()
        if isinstance(node, Choice):
            self._choice(node)
        elif isinstance(node, RepeatGrid):
            self._grid(node)
        else:
            assert isinstance(node, Node)
            raise Unprintable("a loop" if isinstance(node, LoopWhile | CountLoop) else type(node).__name__)

    def _choice(self, node: Choice) -> None:
        """M17.1, M18.1, G5: they decide about the next line."""
        if node.otherwise:
            raise Unprintable("a choice with two ways")
        asked = self._asked(node)
        entry = dict(self.state)
        out, self.out = self.out, []
        inside, self.in_structure = self.in_structure, True
        self.indented(node.then)
        self.in_structure = inside
        self._end_cycle()
        lines, self.out = self.out, out
        ends = self.style.newline.encode()
        commands = [line for line in b"".join(lines).splitlines() if not line.strip().startswith((b"[", b"("))]
        if not commands:
            # The operator is asked, or the input read, all the same: what depends on it is a mode that is in force.
            if "relative" not in self.state:
                raise Unprintable("a choice that does nothing")
            lines = commands = [b"G91" if self.state["relative"] else b"G90"]
        self.line(asked)
        if len(commands) == 1:
            self.out.append(commands[0].lstrip() + ends)
        else:
            if any(isinstance(one, LeaveRoutine) for one in walk(node.then)):
                raise Unprintable("a return within a choice of several lines")
            name = self._loose_name()
            zero = any(isinstance(one, SetFrame) and one.action in ZERO for one in walk(node.then))
            text = b"".join(line.lstrip() for line in lines)
            self.files[name] = (b"L92" + ends if zero or self._inner_zero(node.then) else b"") + text
            self.line(f"M98 {name}")
        feeds = self.state.get("feed"), entry.get("feed")
        self.state = joined(self.state, entry) | {"feed": feeds[0] if feeds[0] == feeds[1] else OPEN_FEED}

    def _loose_name(self) -> str:
        taken = {*self.files, *self.names.values(), *self.style.taken}
        count = 1
        while (name := f"CHOICE_{count}{self.style.extension.upper()}") in taken:
            count += 1
        return name

    def _asked(self, node: Choice) -> str:
        condition, on = node.condition, True
        if isinstance(condition, Unary) and condition.operator == "not":
            condition, on = condition.operand, False
        if not isinstance(condition, Input):
            raise Unprintable("a condition that is no input")
        if condition.kind == "answer":
            text = " ".join(part.value for part in node.question if isinstance(part, Text))
            quote = text.replace('"', "'")
            return f'G5 {"T3" if on else "T4"} M"{quote}"'
        code = {"input": "1", "output": "2"}.get(condition.kind)
        if code is None:
            raise Unprintable("a condition that is no input")
        return f"{'M17' if on else 'M18'}.{code} C{text_of(number(condition.number), 0)}"

    def _grid(self, node: RepeatGrid) -> None:
        """L10 ... L10, in the job alone, with G92 X Y after it."""
        if self.in_file:
            raise Unprintable("an array in a subprogram")
        first = next((one for one in node.body if not isinstance(one, Remark)), None)
        named = {place.axis for place in first.places} if isinstance(first, SetFrame) else set()
        if not isinstance(first, SetFrame) or first.action != "local_here" or not {"x", "y"} <= named:
            raise Unprintable("an array whose cells do not start by naming their place")
        order = "rows" if node.by_rows else "columns"
        if node.rows > 1 and node.columns > 1 and self.controls.array_order != order:
            raise Unprintable("an array of rows and columns, whose order the machine file does not say")
        self.unit([node.dx.unit])
        end = [] if node.back else ["E1"]
        size = [f"R{node.rows}", f"C{node.columns}"]
        size += [f"{axis}{self.amount(by, summed=True)}" for axis, by in (("X", node.dx), ("Y", node.dy))]
        before = self.state.get("feed")
        after = feed_after(node.body, before, self)
        entry: dict[str, Any] = dict(self.constant) | {"feed": before if after == before else OPEN_FEED}
        self.say("L10", *size, *end)
        self.state = entry
        self.indented(node.body)
        self._end_cycle()
        self.line("L10")
        self.state = dict(self.constant) | {"feed": feed_after(node.body, entry["feed"], self)}


def write(job: Job, target: Target, machine: Machine, style: Style) -> dict[str, bytes]:
    """The files of a job: text by name, "" for its own; Unprintable."""
    writer = WinCncWriter(job, target, machine, style)
    return {"": writer.write()} | writer.files
