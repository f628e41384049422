"""A legal Job as text of McuWIN. Sections are those of the manual of V 2.5.3.133.

Every move names its code but within tables of plain lines: what a line without one goes on with is the order of the
source (3.1), and the manual does not say what ends it. Lengths are millimetres, as G00 has them (3.1), centres
distances (3.36) with both words (3.3), feeds a minute (3.28).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from gproof.backend.emit.job_numbers import decimals_of, factor, text_of
from gproof.backend.emit.job_writer import JobWriter
from gproof.backend.emit.mcuwin.job_expressions import PascalWriter, Variables
from gproof.backend.emit.mcuwin.job_lines import numbered, reflection
from gproof.backend.emit.printer import Unprintable
from gproof.backend.emit.rs274.tables import table_text
from gproof.ir.columns import Columns
from gproof.ir.dialects.mcuwin.settings import VERSIONS, mcuwin_settings
from gproof.ir.finding import Span
from gproof.ir.job import (
    ARC_CW,
    MOVE,
    ArcTo,
    AxisPlace,
    ChangeTool,
    Choice,
    Compensate,
    CountLoop,
    DwellFor,
    EndJob,
    Feed,
    GoTo,
    HomeAxes,
    Job,
    LeaveRoutine,
    LoopWhile,
    Mark,
    Moves,
    MoveTo,
    Node,
    PauseJob,
    Quantity,
    Remark,
    Routine,
    RunRoutine,
    SetFeed,
    SetFrame,
    SetVariable,
    ShowText,
    SwitchCoolant,
    SwitchOutput,
    TurnSpindle,
    walk,
)
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.program import Binary, Expr, Number, Text
from gproof.ir.target import Style, Target

PLANES = {"xy": "G17", "xz": "G18", "yz": "G19"}
CENTERS = {"x": "I", "y": "J", "z": "K"}
BITS = {"xy": 0b011, "xz": 0b101, "yz": 0b110}
ORDER = "GXYZABCIJKFSTM"
"""The words of a line."""
FIRST_MODULE = 1000
"""Number of the first module whose name in the source is no number (4.16)."""

MODE, SPEED, TOOL, SWITCH, MOTION = range(5)


class McuWinWriter(JobWriter):
    """See the module's text."""

    def __init__(self, job: Job, target: Target, machine: Machine, style: Style) -> None:
        self.din = mcuwin_settings(machine)
        self.letters = {AXIS_NAMES[axis.index]: axis.word for axis in machine.axes}
        if any((axis.position_unit or 1.0) != 1.0 for axis in machine.axes):
            raise Unprintable("axes whose own unit is not mm or degrees (3.1)")
        super().__init__(job, target, machine, style)
        planes = {getattr(node, "plane", "") or "xy" for node in self.all_nodes()}
        if planes <= {"xy"}:
            self.constant["plane"] = "xy"
        self.variables = Variables(self.all_nodes(), job.source)
        axes = "".join(axis.word for axis in machine.axes)
        self.pascal = PascalWriter(self.variables, axes, self.din.angle_unit)
        self.columns = tuple(self.letters.get(name, "") if name in target.axes else "" for name in AXIS_NAMES)
        arcs = [node for node in self.all_nodes() if isinstance(node, ArcTo)]
        tables = any(isinstance(node, Moves) and (node.rows["kind"] >= ARC_CW).any() for node in self.all_nodes())
        places = all(any(not place.relative for place in node.center) for node in arcs)
        self.centers_are_places = bool(arcs) and places and not tables
        named = self.din.interpolation_axes
        self.interpolating = {name for name, word in self.letters.items() if named is None or word in named}
        self.used = set(self._used())
        self.changes_reflection = any(
            isinstance(node, SetFrame) and node.action.startswith(("mirror", "scale"))
            for routine in job.routines.values() for node in walk(routine.body)
        )  # fmt: skip
        self.moved = False
        self.labels: dict[tuple[int, str], int] = {}
        self.scope = 0
        self.handlers: dict[type, Callable[[Any], None]] = {
            MoveTo: self.move, ArcTo: self.arc, SetFeed: self.set_feed, DwellFor: self.dwell, PauseJob: self.pause,
            TurnSpindle: self.spindle, SwitchCoolant: self.coolant, ChangeTool: self.tool, SetFrame: self.frame,
            SwitchOutput: self.output, HomeAxes: self.home, EndJob: self.end, ShowText: self.message,
            Compensate: self.side, SetVariable: self.setting, RunRoutine: self.run, LeaveRoutine: self.leave,
            Mark: self.mark, GoTo: self.go,
        }  # fmt: skip

    # ---- the whole

    def _used(self) -> Iterator[str]:
        """The axes that the job moves."""
        for node in self.all_nodes():
            if isinstance(node, Moves):
                bits = int(np.bitwise_or.reduce(node.rows["axes"]))
                yield from (name for column, name in enumerate(AXIS_NAMES) if bits >> column & 1)
            elif isinstance(node, MoveTo | ArcTo):
                yield from (place.axis for place in node.to)

    def write(self) -> bytes:
        """Declarations, the program, its subprograms after it (4.16, 12); Unprintable."""
        body = list(self.job.body)
        first = next((place for place, node in enumerate(body) if not isinstance(node, Remark)), len(body))
        self.body(tuple(body[:first]))
        self._declare()
        self.line("%MAIN")
        self.state = dict(self.constant)
        for line in self.header():
            self.line(line)
        rest = tuple(body[first:])
        self.body(rest)
        if not rest or not isinstance(rest[-1], EndJob):
            self.line("M30")
        self.line("%")
        for routine in self.job.routines.values():
            self.state = dict(self.constant)
            self.scope += 1
            self.routine(routine)
        text = b"".join(self.out)
        return numbered(text, self.style.newline) if self.din.line_numbers or self.style.numbers else text

    def header(self) -> Iterable[str]:
        """Modes that the manual leaves to earlier programs or to IniCfg (3.3, 3.6, 3.24, 3.28); the zero (3.19)."""
        relative, plane = bool(self.constant.get("relative")), self.constant.get("plane", "xy")
        centers = "G161" if self.centers_are_places else "G162"
        words = ["G91" if relative else "G90", "G71", "G94", centers, PLANES[plane]]
        self.state |= {"relative": relative, "plane": plane, "reflected": {}}
        zero = [] if self.job.source == "mcuwin" or self._selects_first() else ["G54"]
        return [*self.style.header, " ".join(words), *zero]

    def _selects_first(self) -> bool:
        """Whether a work offset is chosen before anything else that counts from one."""
        quiet = (Remark, TurnSpindle, SwitchCoolant, ChangeTool, SetFeed, ShowText, PauseJob, DwellFor)
        first = next((node for node in self.job.body if not isinstance(node, quiet)), None)
        return isinstance(first, SetFrame) and first.action == "select"

    def _declare(self) -> None:
        """Variables, before the first percent sign (10, 12)."""
        if not self.variables.declared:
            return
        self.line("$DINEND")
        self.line("var")
        for is_whole, kind in ((False, "double"), (True, "integer")):
            names = [name for name, whole in self.variables.declared.items() if whole is is_whole]
            for begin in range(0, len(names), 8):
                self.line(f"  {', '.join(names[begin : begin + 8])} : {kind};")
        self.line("{$DINSTART}")

    def comment(self, text: str) -> str:
        """A quote up to the end of the line (6)."""
        return f"' {text}".rstrip()

    def remark(self, node: Remark) -> None:
        """After a ``$`` line on a line of its own: there a quote starts a text (7)."""
        last = self.out[-1].lstrip()[:1] if self.out and not self.pending else b""
        super().remark(replace(node, trailing=node.trailing and last not in (b"$", b"%", b"{", b"W")))

    def line(self, text: str) -> None:
        """A line that is no move: the next one names its code."""
        super().line(text)
        self.state.pop("motion", None)

    # ---- structure (4.10, 4.15, 4.16, 7, 8)

    def open(self, node: Node) -> None:
        """``$if``, ``$while``, ``$repeat``, ``$for``."""
        self.moved |= not isinstance(node, Choice)  # each pass comes after the one before
        if isinstance(node, Choice):
            self.line(f"$if {self.pascal.condition(node.condition)} then begin")
        elif isinstance(node, LoopWhile) and node.first:
            self.line("$repeat begin")
        elif isinstance(node, LoopWhile):
            self.line(f"$while {self.pascal.condition(node.condition)} do begin")
        elif isinstance(node, CountLoop):
            if not self.variables.is_whole(node.variable):
                raise Unprintable("a counted loop whose variable may be no whole number")
            name, way = self.variables.text(node.variable), "downto" if node.down else "to"
            self.line(f"$for {name} := {self.pascal.whole(node.first)} {way} {self.pascal.whole(node.last)} do begin")
        else:
            raise Unprintable(type(node).__name__)

    def divide(self, node: Choice) -> None:
        """``$end else begin``."""
        self.moved = True
        self.line("$end else begin")

    def close(self, node: Node) -> None:
        """``$end``, ``$end until``."""
        if isinstance(node, LoopWhile) and node.first:
            self.line(f"$end until {self.pascal.condition(node.condition, negated=True)};")
        else:
            self.line("$end;")
        self.moved = True

    def routine_name(self, name: str) -> str:
        """A number, as labels have (5.1)."""
        if name.isdigit() and len(name) <= 6:
            return str(int(name))
        taken = {str(int(one)) for one in self.job.routines if one.isdigit()}
        others = [one for one in self.job.routines if not (one.isdigit() and len(one) <= 6)]
        free = (str(n) for n in range(FIRST_MODULE, FIRST_MODULE + 2 * len(self.job.routines)) if str(n) not in taken)
        return dict(zip(others, free, strict=False))[name]

    def routine(self, routine: Routine) -> None:
        """A module with its number, up to M17 (4.10, 4.16)."""
        name = self.names[routine.name]
        self.moved = True  # where it is called from
        self.line(f"%{name}" if name == routine.name else f"%{name} ' {routine.name}")
        if self.din.version == VERSIONS[1]:
            self.line(f"L{name}")
        body = routine.body
        self.body(body)
        if not body or not isinstance(body[-1], LeaveRoutine):
            self.line("M17")
        self.line("%")

    def run(self, node: RunRoutine) -> None:
        """M98 (4.16)."""
        count = ""
        if node.count is not None:
            literal = isinstance(node.count, Number)
            count = f" O{self.expression(node.count)}" if literal else f" O{self.pascal.word(node.count)}"
        self.line(f"M98 L{self.names[node.name]}{count}")
        reflected = {} if self.changes_reflection else {"reflected": self.state.get("reflected")}
        self.state = self.constant | reflected
        self.moved = True

    def leave(self, node: LeaveRoutine) -> None:
        """M17 (4.10)."""
        self.line("M17")

    def _label(self, name: str) -> int:
        """A number that no module and no other label has: labels are of the whole text (4.15)."""
        key = self.scope, name
        if key not in self.labels:
            taken = {*self.names.values(), *(str(n) for n in self.labels.values())}
            number = int(name) if name.isdigit() and len(name) <= 6 else 1
            while str(number) in taken:
                number += 1
            self.labels[key] = number
        return self.labels[key]

    def mark(self, node: Mark) -> None:
        """L (5.1); it is reached in more than one way."""
        self.line(f"L{self._label(node.name)}")
        self.state = {name: self.state[name] for name in self.constant if name in self.state}
        self.moved = True

    def go(self, node: GoTo) -> None:
        """M96 (4.15)."""
        self.line(f"M96 L{self._label(node.name)}")

    def setting(self, node: SetVariable) -> None:
        """``:=`` (11)."""
        name = self.variables.text(node.target)
        if self.variables.is_whole(node.target):
            self.line(f"{name} := {self.pascal.whole(node.value)}")
        else:
            self.line(f"{name} := {self.pascal.value(node.value)}")

    # ---- values

    def node(self, node: Node) -> None:
        """An operation, by its handler; Unprintable."""
        handler = self.handlers.get(type(node))
        if handler is None:
            raise Unprintable(type(node).__name__)
        handler(node)

    def expression(self, value: Expr) -> str:
        """A value after a letter or a code."""
        if isinstance(value, Number):
            return text_of(value.value, self.style.decimals)
        return self.pascal.word(value)

    def amount(self, amount: Quantity, by: float = 1.0, *, summed: bool = False) -> str:
        """A quantity in mm, degrees or its own unit. summed: see ``decimals_of``."""
        scale = by * factor(amount.unit, "mm")
        if isinstance(amount.value, Number):
            return text_of(amount.value.value * scale, decimals_of(self.style, amount.unit, summed=summed))
        if scale != 1.0:
            raise Unprintable("an expression in another unit")
        return self.pascal.word(amount.value)

    def words(self, places: Iterable[AxisPlace], *, summed: bool = False) -> list[str]:
        """Axis words in the order of the columns. summed: they are those of a zero."""
        found = []
        for place in sorted(places, key=lambda one: AXIS_NAMES.index(one.axis)):
            if place.axis not in self.letters:
                raise Unprintable(f"{place.axis.upper()}, which the machine does not have")
            found.append(f"{self.letters[place.axis]}{self.amount(place.at, summed=summed or place.relative)}")
        return found

    def feed(self, feed: Feed | None) -> list[str]:
        """F a minute (5.3)."""
        if feed is None:
            return []
        if feed.per != "minute":
            raise Unprintable(f"a feed per {feed.per}")
        return [f"F{self.amount(feed.amount)}"]

    # ---- motion

    def mode_line(self, relative: bool) -> None:
        """G90 or G91 on a line of its own, where the text is not in it."""
        if self.state.get("relative") is not relative:
            self.line("G91" if relative else "G90")
            self.state["relative"] = relative

    def distances(self, places: Iterable[AxisPlace], span: Span) -> None:
        """G90 or G91 (3.24, 3.25)."""
        found = {place.relative for place in places}
        if len(found) > 1:
            raise Unprintable("absolute and relative places in one move")
        for relative in found:
            if self.state.get("relative") != relative:
                self.put(MODE, ["G91" if relative else "G90"], span)
                self.state["relative"] = relative

    def motion(self, code: str, words: list[str], feed: list[str], span: Span) -> None:
        """A line of its own."""
        self.put(MOTION, [code, *words, *feed], span)
        self.flush()
        self.state.pop("motion", None)
        self.moved = True

    def move(self, node: MoveTo) -> None:
        """G00, G01 (3.1, 3.2)."""
        if node.kind == "probe" or node.frame != "work":
            raise Unprintable("a probing move, or one in machine coordinates")
        self.distances(node.to, node.span)
        self.motion("G00" if node.kind == "rapid" else "G01", self.words(node.to), self.feed(node.feed), node.span)

    def arc(self, node: ArcTo) -> None:
        """G02, G03 with both words of the centre (3.3)."""
        if node.radius is not None or node.turns is not None:
            raise Unprintable("an arc by its radius, or of more turns")
        self._plane(node.plane)
        places = {place.axis: place for place in node.center}
        absolute = any(not place.relative for place in node.center)
        if absolute and not all(axis in places for axis in node.plane):
            raise Unprintable("an arc without a word of its centre")
        switches = absolute is not self.centers_are_places
        if switches:
            self.line("G161" if absolute else "G162")
        if absolute and any(place.relative for place in node.to):
            raise Unprintable("an arc to a distance with a place as its centre")
        zero = Quantity(Number(0.0, node.span), "mm")
        center = [f"{CENTERS[axis]}{self.amount(places[axis].at if axis in places else zero)}" for axis in node.plane]
        self.distances(node.to, node.span)
        if absolute and not node.to:
            self.mode_line(False)
        words = [*self.words(node.to), *center]
        self.motion("G02" if node.clockwise else "G03", words, self.feed(node.feed), node.span)
        if switches:
            self.line("G162" if absolute else "G161")

    def _plane(self, plane: str) -> None:
        if self.state.get("plane") != plane:
            self.line(PLANES[plane])
            self.state["plane"] = plane

    def moves(self, node: Moves) -> None:
        """A table: codes only where they change (3.1)."""
        if node.unit != "mm" or node.per != "minute":
            raise Unprintable(f"moves in {node.unit}, with feeds per {node.per}")
        rows = node.rows
        arcs = rows["kind"] >= ARC_CW
        if arcs.any():
            if (rows["radius"][arcs] != 0.0).any():
                raise Unprintable("an arc by its radius")
            self._plane(node.plane)
            centred = rows["centred"].copy()
            centred[arcs] |= np.uint8(BITS[node.plane])
            arrays = {column.name: rows[column.name] for column in MOVE.columns} | {"centred": centred}
            node = replace(node, rows=Columns(MOVE, arrays))
        used = int(np.bitwise_or.reduce(rows["axes"]))
        lost = [name for n, name in enumerate(AXIS_NAMES) if used >> n & 1 and not self.columns[n]]
        if lost:
            raise Unprintable(f"{lost[0].upper()}, which the machine does not have")
        first = [] if self.state.get("relative") == node.relative else [91.0 if node.relative else 90.0]
        text, _ = table_text(
            node, self.style, self.columns, first, None, self.style.indent * self.depth, two_digits=True
        )
        self.out.append(text)
        self.last_line_of, self.commented = int(node.rows["line"][-1]), False
        self.state["relative"] = node.relative
        self.state.pop("motion", None)
        self.moved = True

    def set_feed(self, node: SetFeed) -> None:
        """F alone (5.3)."""
        self.line(" ".join(self.feed(node.feed)))

    def dwell(self, node: DwellFor) -> None:
        """G04, seconds (3.5)."""
        value = node.time.value
        if node.time.unit == "ms" and isinstance(value, Number):
            value = Number(value.value * 0.001, value.span)
        elif node.time.unit == "ms":
            unit = 1.0 / (1000.0 * self.din.wait_unit)
            scaled = value if unit == 1.0 else Binary("*", value, Number(unit, value.span), value.span)
            self.line(f"$wt({self.pascal.value(scaled)});")
            self.moved = False
            return
        self.line(f"G04 {self.expression(value)}")
        self.moved = False

    # ---- frames (3.9 to 3.13, 3.18, 3.19, 3.26, 3.33, 3.34)

    def frame(self, node: SetFrame) -> None:
        """G53 to G58, G92, G153, G154; G21 to G24, G39."""
        if node.action.partition("_")[0] in ("mirror", "scale"):
            foreign = self.job.source != self.target.name
            now, lines = reflection(node, self.state.get("reflected"), self.letters, foreign=foreign)
            for line in lines:
                self.line(line)
            self.state["reflected"] = now
            return
        if node.action == "select":
            number = node.number.value if isinstance(node.number, Number) else 0.0
            if number not in range(1, self.target.offsets + 1):
                raise Unprintable("a work offset beyond G58")
            wanted, usual = set(node.axes or self.letters), self.interpolating
            if wanted != usual and not (not node.axes and self.used <= usual):
                raise Unprintable("a work offset of other axes than those that interpolate (3.19)")
            self.line(f"G{53 + round(number)}")
        elif node.action in ("zero_keep", "zero_recall"):
            if len(self._kept_places()) > 1:
                raise Unprintable("several work zeros that are kept")
            self.line("G153" if node.action == "zero_keep" else "G154")
        elif node.action in ("zero_at", "zero_shift"):
            self._zero(node)
        else:
            raise Unprintable(node.action)

    def _zero(self, node: SetFrame) -> None:
        """G92, in G90 or G91 (3.26); G53 where it is machine zero for the axes that interpolate (3.18)."""
        self.mode_line(node.action == "zero_shift")
        at_machine = all(place.at.number == 0.0 for place in node.places) and node.action == "zero_at"
        if at_machine and {place.axis for place in node.places} == self.interpolating:
            self.line("G53")
        else:
            self.line(" ".join(["G92", *self.words(node.places, summed=True)]))
        if "relative" in self.constant:
            # What the whole job shares holds in subprograms too.
            self.mode_line(self.constant["relative"])

    def side(self, node: Compensate) -> None:
        """G40 to G42, by the record of the tool table that T selects (2.7)."""
        if not node.open or node.tool is not None or node.diameter is not None:
            raise Unprintable("cutter compensation, whose path the manual leaves open (2.7)")
        if node.side != "off":
            self._plane(node.plane)
        self.line({"left": "G41", "right": "G42", "off": "G40"}[node.side])

    def _kept_places(self) -> set[object]:
        """Numbers of the places in which zeros are kept; McuWIN has one (3.33)."""
        kept = [node for node in self.all_nodes() if isinstance(node, SetFrame) and node.action == "zero_keep"]
        return {node.number.value if isinstance(node.number, Number) else node.number for node in kept}

    # ---- what Task 0 does (4, 5)

    def code(self, action: str, usual: str) -> str:
        """The code for which Task 0 does this: the usual one, where the machine's file says nothing else of it."""
        stated = self.din.task(usual)
        if stated is None or stated.action == action:
            return usual if len(usual) > 2 or not usual[1:].isdigit() else f"{usual[0]}0{usual[1:]}"
        for task in self.din.tasks or ():
            if task.action == action and task.code[0] == "M":
                return task.code
        raise Unprintable(f"a code of Task 0 for {action.replace('_', ' ')}")

    def spindle(self, node: TurnSpindle) -> None:
        """S (5.4), M03 to M05 (4.4 to 4.6)."""
        if node.speed is not None:
            self.put(SPEED, [f"S{self.amount(node.speed)}"], node.span)
        if node.direction != "speed":
            names = {"cw": ("spindle_cw", "M3"), "ccw": ("spindle_ccw", "M4"), "off": ("spindle_off", "M5")}
            self.put(SWITCH, [self.code(*names[node.direction])], node.span)
        self.moved = False

    def coolant(self, node: SwitchCoolant) -> None:
        """M08, M09 (4.8, 4.9)."""
        if node.mist:
            raise Unprintable("mist coolant")
        if node.flood is not None:
            self.put(
                SWITCH, [self.code("coolant_on", "M8") if node.flood else self.code("coolant_off", "M9")], node.span
            )
        self.moved = False

    def tool(self, node: ChangeTool) -> None:
        """T (5.5), M06 (4.7)."""
        stated = self.din.task("T")
        by_t = stated is not None and stated.action == "tool_change"
        if by_t and node.number is None:
            raise Unprintable("a tool change that does not name the tool")
        if node.number is not None:
            self.put(TOOL, [f"T{self.expression(node.number)}"], node.span)
        if node.change and not by_t:
            self.put(SWITCH, [self.code("tool_change", "M6")], node.span)
        self.moved = False

    def pause(self, node: PauseJob) -> None:
        """M00, M01 (4.1, 4.2)."""
        self.line("M01" if node.optional else "M00")
        self.moved = False

    def end(self, node: EndJob) -> None:
        """M30, M02 (4.3, 4.13); plane and unit stay as the source leaves them, or as they usually are (3.6, 3.22)."""
        self._plane(node.plane or "xy")
        if node.unit == "inch":
            self.line("G70")
        self.line("M30" if node.reset else "M02")

    def output(self, node: SwitchOutput) -> None:
        """M26, M27 (4.11): motion goes on; G04 0 lets the axes rest where the source does (3.5)."""
        if not (isinstance(node.value, Number) and isinstance(node.channel, Number)):
            raise Unprintable("an output that is computed")
        channel = round(node.channel.value)
        channels = self.din.channels or len(self.letters)
        if not (100 < channel < 1000 and channel % 100 and channel // 100 <= channels):
            raise Unprintable(f"output {channel}: channels are an axis and two digits (4.11); map it")
        if not node.moving and self.moved:
            self.line("G04 0")
        self.line(f"{'M26' if node.value.value else 'M27'} {channel}")
        self.moved = node.moving

    def home(self, node: HomeAxes) -> None:
        """G74 (3.23)."""
        self.line(" ".join(["G74", *(self.letters[axis] for axis in node.axes)]))
        self.moved = False

    def message(self, node: ShowText) -> None:
        """WRITELN (5.7.2)."""
        parts = []
        for part in node.parts:
            if isinstance(part, Text):
                parts.append('"' + part.value.replace('"', "'") + '"')
            else:
                parts.append(self.pascal.word(part))
        self.line(" ".join(["WRITELN", *parts]))

    # ---- lines

    def joins(self, rank: int, words: list[str]) -> bool:
        """Only G90 and G91 are on the line of a move; S and T with what they are for."""
        return rank != MOTION or all(one == MODE for one, _ in self.pending)

    def in_order(self, words: list[str]) -> str:
        """G codes first, then axes, F, and M last."""
        return " ".join(sorted(words, key=lambda word: ORDER.index(word[0])))


def write(job: Job, target: Target, machine: Machine, style: Style) -> dict[str, bytes]:
    """The files of a job: text by name, "" for its own; Unprintable."""
    return {"": McuWinWriter(job, target, machine, style).write()}
