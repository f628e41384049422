"""What the words of a line do, in the order in which the controller does them.

Sources: LinuxCNC user manual 2.9, G-Code Overview, Order of Execution, and the sections of G-Codes and M-Codes; grbl
1.1 takes the same order (Supported G-Codes, after NIST IR 6556 3.8).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from gproof.ir.drives import AXIS_NAMES
from gproof.ir.end_state import EndState, Left
from gproof.ir.trace import UNKNOWN, Op, PathMode, State, Wait
from gproof.verify.translation.rs274 import drilling
from gproof.verify.translation.rs274.language import MOST_CHANNEL, Language, Unread
from gproof.verify.translation.rs274.moves import Manner, go, length_of
from gproof.verify.translation.rs274.offsets import Place, Zeros, unknown
from gproof.verify.translation.rs274.rows import Forms, Rows
from gproof.verify.translation.rs274.words import Words

NAN = math.nan
AXES = "XYZABC"
START = tuple(((f"start.{name}", 1),) for name in AXIS_NAMES)
_NO_WORDS = np.full(9, NAN)


class Controller:
    """Modes are None until the program says them: an earlier one may have left them otherwise."""

    def __init__(
        self, name: str, language: Language, work: int, lengths: Mapping[int, float], columns: tuple[int, ...]
    ) -> None:  # fmt: skip
        forms: Any = START
        self.columns = columns
        self.language = language
        self.rows = Rows(name, forms)
        self.zeros = Zeros(work, dict(lengths))
        self.state = State(work=work, path_tolerance=NAN)
        self.unit: float | None = None
        self.absolute: bool | None = None
        self.plane: int | None = None
        self.per: int | None = None
        self.motion: int | None = None
        self.compensated = language.structured
        self.centers_known = not language.structured
        self.initial: bool | None = None
        self.series = drilling.Series()
        self.first_hole = True
        self.feed = NAN
        self.speed = NAN
        self.direction = 0
        self.coolant = (0.0, 0.0)
        self.selected: int | None = None
        self.by_hand = False
        self.waits_for_motion = False
        self.probes = 0
        self.ended = False
        self.assumed: dict[str, None] = {}
        self._known_state: tuple[State, int] | None = None

    # ---- what all lines need

    def state_number(self) -> int:
        """The number of the present state in the Trace."""
        if self._known_state is None or self._known_state[0] is not self.state:
            self._known_state = self.state, self.rows.state(self.state)
        return self._known_state[1]

    def now(self, **values: Any) -> None:
        """The state changes."""
        self.state = replace(self.state, **values)

    def event(self, op: Op, line: int, first: float = 0.0, second: float = 0.0, text: int = 0) -> None:
        """A row that does not move."""
        self.rows.event(op, line, self.state_number(), (first, second), text=text)

    def mm(self, what: str = "a length") -> float:
        """Millimetres of the unit in force."""
        if self.unit is None:
            raise Unread(f"{what} before G20 or G21")
        return self.unit

    def here(self, axis: int) -> Place:
        """Where an axis is."""
        return Place(self.rows.place[axis], self.rows.forms[axis])

    def manner(self, *, machine: bool = False) -> Manner:
        """How the words of moves count."""
        if self.absolute is None:
            raise Unread("a place before G90 or G91")
        if self.compensated:
            raise Unread("a move before G40")
        if machine and not self.absolute:
            raise Unread("G53 in G91")
        return Manner(
            language=self.language, unit=self.mm("a place"), absolute=self.absolute, plane=self.plane or 0,
            state=self.state_number(), machine=machine,
        )  # fmt: skip

    # ---- a line

    def line(self, words: Words, line: int) -> None:
        """All that a line says; Unread."""
        if self.ended:
            raise Unread("a line after the end of the program")
        self._feeds(words)
        self._speed(words, line)
        self._outputs(words, line)
        self._change(words, line)
        self._spindle(words, line)
        self._coolant(words, line)
        if words.m.get("overrides"):
            self.now(overrides=words.m["overrides"] == 480)
        if words.g.get("once") == 40:
            self.event(Op.DWELL, line, words.need("P", "G4"))
        self._modes(words)
        self._lengths(words)
        self._zeros(words, line)
        self._motion(words, line)
        if words.values:
            raise Unread(f"{next(iter(words.values))} in this line")
        self._stop(words, line)

    def _feeds(self, words: Words) -> None:
        """G93, G94, G95, F."""
        per = words.g.get("per")
        if per is not None and (per // 10 != self.per or self.language.structured):
            # LinuxCNC takes the feed away even where the mode stays.
            self.per, self.feed = per // 10, NAN
            self.now(feed_mode=per // 10)
        feed = words.take("F")
        if feed is None:
            if self.per == 93:
                # It is for the motion of its own line alone (G-Codes G93).
                self.feed = NAN
            return
        if self.per is None:
            raise Unread("F before G94")
        unit = {200: 25.4, 210: 1.0}.get(words.g.get("unit", 0), self.unit)
        if unit != self.unit and self.per != 93:
            raise Unread("F in the line of a new unit")
        self.feed = feed

    def _speed(self, words: Words, line: int) -> None:
        """S, T."""
        speed = words.take("S")
        if speed is not None:
            self.speed = speed
            if self.direction and "spindle" not in words.m:
                self.turn(self.direction, line)
        tool = words.take("T")
        self.by_hand = tool is not None and not self.language.structured
        if tool is not None:
            if tool != round(tool) or tool < 0:
                raise Unread(f"T{tool:g}")
            self.selected = round(tool)

    def _outputs(self, words: Words, line: int) -> None:
        """M62 to M66."""
        code = words.m.get("output")
        if code is None:
            return
        channel = words.need("P", f"M{code // 10}")
        if code == 660:
            self._wait_input(words, channel, line, "come or timed out")
            return
        _check_channel(channel)
        moving = code in (620, 630)
        self.waits_for_motion |= moving
        self.event(Op.OUTPUT, line, channel, float(code in (620, 640)), text=int(moving))

    def wait_for_ever(self, words: Words, line: int) -> bool:
        """Whether a line that is repeated until its time is not over is M66 alone; then it has waited."""
        if words.g or words.m != {"output": 660} or set(words.values) != set("PLQ"):
            return False
        self._wait_input(words, words.need("P", "M66"), line, "come")
        return True

    def _wait_input(self, words: Words, channel: float, line: int, outcome: str) -> None:
        mode, limit = words.need("L", "M66"), words.need("Q", "M66")
        _check_channel(channel)
        if mode not in (3.0, 4.0) or limit <= 0.0:
            raise Unread(f"M66 L{mode:g} Q{limit:g}")
        self.event(Op.INPUT_WAIT, line, channel, float(mode == 3.0))
        self.rows.wait(Wait.INPUT, outcome, line)

    def _change(self, words: Words, line: int) -> None:
        """M6: the spindle stops, and the operator changes the tool (M-Codes M6)."""
        if "change" not in words.m:
            return
        if self.selected is None:
            raise Unread("M6 without a tool that was selected")
        self._still()
        self.assumed[f"at M6 {self.language.title} moves no axis, and waits for the operator"] = None
        if self.direction:
            self.turn(0, line)
        self.now(tool=self.selected)
        self.event(Op.TOOL_CHANGE, line, float(self.selected))
        self.rows.wait(Wait.TOOL_CHANGE, "tool changed", line)

    def _spindle(self, words: Words, line: int) -> None:
        code = words.m.get("spindle")
        if code is not None:
            self.turn({30: 1, 40: -1, 50: 0}[code], line)

    def turn(self, direction: int, line: int) -> None:
        """The spindle: 1 clockwise, -1 counter-clockwise, 0 off."""
        self.direction = direction
        self.now(spindle=direction * self.speed if direction else 0.0)
        self.event(Op.SPINDLE, line, float(direction), self.speed if direction else 0.0)

    def _coolant(self, words: Words, line: int) -> None:
        code = words.m.get("coolant")
        if code is None:
            return
        mist, flood = self.coolant
        self.coolant = {70: (1.0, flood), 80: (mist, 1.0), 90: (0.0, 0.0)}[code]
        self.event(Op.COOLANT, line, *self.coolant)

    def _modes(self, words: Words) -> None:
        """G17 to G19, G20, G21, G40, path modes, G90, G91, G98, G99."""
        if "plane" in words.g:
            self.plane = words.g["plane"] // 10
        if "unit" in words.g:
            unit = 25.4 if words.g["unit"] == 200 else 1.0
            if self.unit is not None and unit != self.unit and not math.isnan(self.feed) and self.per != 93:
                # The speed stays what it was; its number is another one by now.
                self.feed *= self.unit / unit
            self.unit = unit
        if "compensation" in words.g:
            self.compensated = False
        if "centers" in words.g:
            self.centers_known = True
        path = words.g.get("path")
        if path == 640:
            tolerance, simplify = words.take("P"), words.take("Q")
            if tolerance is not None and simplify is None:
                raise Unread("G64 P without Q")
            self.now(
                path_mode=PathMode.CONTINUOUS, path_tolerance=(tolerance or 0.0) * self.mm(),
                simplify=(simplify or 0.0) * self.mm(),
            )  # fmt: skip
        elif path is not None:
            mode = PathMode.EXACT_PATH if path == 610 else PathMode.EXACT_STOP
            self.now(path_mode=mode, path_tolerance=0.0, simplify=0.0)
        if "distance" in words.g:
            self.absolute = words.g["distance"] == 900
        if "retract" in words.g:
            self.initial = words.g["retract"] == 980

    def _lengths(self, words: Words) -> None:
        """G43, G43.1, G49."""
        code = words.g.get("length")
        if code == 490:
            self.zeros.length = Place()
        elif code == 431:
            self.zeros.length = Place(words.need("Z", "G43.1") * self.mm())
            if any(letter in words.values for letter in AXES) or "motion" in words.g:
                raise Unread("G43.1 with a move")
        elif code == 430:
            number = words.take("H")
            if number is None:
                number = float(self.state.tool)
            if number != round(number) or number < 0:
                raise Unread("G43 with an unknown tool")
            self.zeros.length = self.zeros.tool_length(round(number))

    def _zeros(self, words: Words, line: int) -> None:
        """G54 to G59.3, G10, G92, G28, G30."""
        offset = words.g.get("offset")
        if offset is not None:
            number = {591: 7, 592: 8, 593: 9}.get(offset, offset // 10 - 53)
            self.zeros.work = number
            self.now(work=number)
        code = words.g.get("once")
        if code in (None, 40, 530):
            return
        if words.g.get("motion") not in (None, 800):
            raise Unread("a motion in the line of an offset or a parking place")
        if code in (280, 300):
            self._park(words, 1 if code == 280 else 2, line)
        elif code == 100:
            self._store(words)
        elif code == 920:
            places = self._axis_values(words)
            for axis, value in places.items():
                self.zeros.name_here(axis, self.here(axis), value)
            self.zeros.keep_local()
        elif code == 923:
            if self.zeros.stored is None:
                raise Unread("G92.3 before G92")
            self.zeros.local = list(self.zeros.stored)
        else:
            self.zeros.local_off(forget=code == 921)

    def _axis_values(self, words: Words) -> dict[int, float]:
        """mm or degrees of the axis words, by column."""
        found = {
            axis: value * (self.mm() if axis < 3 else 1.0)
            for axis, letter in enumerate(AXES) if (value := words.take(letter)) is not None
        }  # fmt: skip
        if not found:
            raise Unread("axis words are missing")
        return found

    def _store(self, words: Words) -> None:
        """G10 L2, L20."""
        key, number = words.need("L", "G10"), words.need("P", "G10")
        if key not in (2.0, 20.0) or number not in range(1, self.language.offsets + 1):
            raise Unread(f"G10 L{key:g} P{number:g}")
        for axis, value in self._axis_values(words).items():
            if key == 2.0:
                self.zeros.set_offset(round(number), axis, Place(value))
            else:
                self.zeros.call_here(round(number), axis, self.here(axis), value)

    def _park(self, words: Words, number: int, line: int) -> None:
        """G28, G30: by way of the places given, then these axes, or all, to a place of the controller's own."""
        self._still()
        named = [axis for axis, letter in enumerate(AXES) if letter in words.values]
        if named:
            self._moves(words, 0, line, machine=False)
        forms: list[Any] = list(self.rows.forms)
        for axis in named or self.columns:
            self.rows.place[axis] = 0.0
            forms[axis] = unknown(f"park{number}.{AXIS_NAMES[axis]}").form
        self.rows.forms = self._forms(forms)
        self.event(Op.TRAVERSE, line)

    def _forms(self, forms: list[Any]) -> Forms:
        a, b, c, d, e, f = forms
        return a, b, c, d, e, f

    # ---- motion

    def _motion(self, words: Words, line: int) -> None:
        machine = words.g.get("once") == 530
        code = words.g.get("motion")
        if code == 800:
            self.motion = None
            if any(letter in words.values for letter in AXES):
                raise Unread("axis words with G80")
            return
        if code is not None:
            self.first_hole |= self.motion is None or self.motion <= 800
            self.motion = code
        if not any(letter in words.values for letter in "XYZABCIJK"):
            if machine:
                raise Unread("G53 without a place")
            if code is not None and code >= 20:
                raise Unread("a motion without axis words")
            return
        if self.motion is None:
            raise Unread("axis words without a motion")
        if self.motion == 382:
            self._probe(words, line)
        elif self.motion > 800:
            drilling.drill(self, words, line)
        else:
            self._moves(words, self.motion // 10, line, machine=machine)
        self.waits_for_motion = False

    def _moves(self, words: Words, code: int, line: int, *, machine: bool) -> None:
        """A single move."""
        manner = self.manner(machine=machine)
        if machine and code > 1:
            raise Unread("G53 with an arc")
        if code >= 2 and self.plane is None:
            raise Unread("an arc before its plane")
        table = _NO_WORDS.copy()
        for column, letter in enumerate("XYZABCIJK" if code >= 2 else AXES):
            value = words.take(letter)
            if value is not None:
                table[column] = value
        radius = words.take("R") if code >= 2 else None
        if code >= 2 and radius is None and not self.centers_known:
            raise Unread("the centre of an arc before G91.1")
        turns = words.take("P") if code >= 2 else None
        if turns is not None and (turns != round(turns) or turns < 1 or not self.language.structured):
            raise Unread("an arc with P")
        self.one_move(code, line, manner, table, NAN if radius is None else radius, round(turns or 1.0))

    def one_move(self, code: int, line: int, manner: Manner, table: Any, radius: float = NAN, turns: int = 1) -> None:
        """A row of a move; its feed by the mode in force."""
        if code and self.per is None:
            raise Unread("a feed move before G94")
        zero = [Place()] * 6 if manner.machine else [self.zeros.zero(axis) for axis in range(6)]
        before, forms = np.array(self.rows.place), self.rows.forms
        feed = self.feed
        if self.per == 95:
            feed *= abs(self.state.spindle)
        inverse = self.per == 93 and code > 0
        if inverse and math.isnan(feed):
            raise Unread("a move in inverse time without F")
        try:
            go(self.rows, zero, manner, np.array([line]), np.array([code]), table[None], np.array([radius]),
               np.array([1.0 if inverse else feed]), turns)  # fmt: skip
        except Unread as found:
            raise Unread(found.why) from found
        if inverse:
            last = self.rows.last()
            center = last["center"][0] if code >= 2 else None
            length = length_of(before, last["to"][0], center, manner.plane, code == 2, turns)
            last["feed"][0] = feed * length if forms == self.rows.forms else NAN
            self.feed = NAN

    def straight_moves(self, codes: list[int], tables: list[Any], line: int) -> None:
        """Moves of one line, G0 or G1, in millimetres or inches a minute."""
        count = len(codes)
        zero = [self.zeros.zero(axis) for axis in range(6)]
        try:
            go(self.rows, zero, self.manner(), np.full(count, line), np.array(codes), np.stack(tables),
               np.full(count, NAN), np.full(count, self.feed))  # fmt: skip
        except Unread as found:
            raise Unread(found.why) from found

    def _probe(self, words: Words, line: int) -> None:
        """G38.2: the axes that move have gone some way from where they were when the probe touches."""
        self._still()
        manner = self.manner()
        named = [axis for axis, letter in enumerate(AXES) if letter in words.values]
        table = _NO_WORDS.copy()
        for axis in named:
            table[axis] = words.values.pop(AXES[axis])
        if self.per != 94:
            raise Unread("a probing move that is not in G94")
        before = [self.here(axis) for axis in range(len(AXES))]
        self.one_move(1, line, manner, table)
        self.rows.last()["op"][0] = int(Op.PROBE)
        self.probes += 1
        self.rows.wait(Wait.PROBE, "stopped", line)
        forms: list[Any] = list(self.rows.forms)
        for axis in named:
            touched = before[axis].plus(unknown(f"probe.{self.probes}.{AXIS_NAMES[axis]}"))
            self.rows.place[axis], forms[axis] = touched.value, touched.form
        self.rows.forms = self._forms(forms)
        self.rows.starts_here()

    def _still(self) -> None:
        """An output that waits for the next motion has had it."""
        if self.waits_for_motion:
            raise Unread("M62 or M63 without a motion after it")

    # ---- stops

    def _stop(self, words: Words, line: int) -> None:
        """M0, M1, M2, M30."""
        code = words.m.get("stop")
        if code is None:
            return
        self._still()
        if self.by_hand and code == 0 and self.selected is not None:
            self.assumed[f"at a stop with T the operator changes the tool: {self.language.title} has no M6"] = None
            self.now(tool=self.selected)
            self.event(Op.TOOL_CHANGE, line, float(self.selected))
            self.rows.wait(Wait.TOOL_CHANGE, "tool changed", line)
            return
        if code in (0, 10):
            self.event(Op.STOP, line, float(code == 10))
            self.rows.wait(Wait.OPERATOR, "cycle start", line)
            return
        if self.direction:
            self.turn(0, line)
        if any(self.coolant):
            self.event(Op.COOLANT, line)
        self.event(Op.END, line)
        self.finish(line, reset=True)

    def finish(self, line: int, *, reset: bool) -> None:
        """The program is over. reset: by M2 or M30, which go back to G54 (M-Codes M2 M30)."""
        self._still()
        self.ended = True
        if not reset:
            self.event(Op.END, line, 1.0)
        section = len(self.rows.trace.sections)
        self.rows.end(Wait.END, "end", line)
        self.rows.trace.ends[section] = self._end_state(reset=reset)

    def _end_state(self, *, reset: bool) -> EndState:
        zeros = self.zeros
        assumed: tuple[str, ...] = ()
        kept: Left | None = tuple(
            (name, zeros.zero(axis).value, zeros.zero(axis).form) for axis, name in enumerate(AXIS_NAMES)
            if name.upper() in self.language.axes
        )  # fmt: skip
        if reset and zeros.work != 1:
            kept = None
            assumed = (f"{self.language.title} goes back to G54 at the end: the next job says its own work offset",)
        table = tuple(
            (f"work.{number}.{AXIS_NAMES[axis]}", place.value, place.form)
            for (number, axis), place in sorted(zeros.table.items())
        )
        first = unknown("tool.0.z")
        length: Left = () if zeros.length == first else (("z", zeros.length.value, zeros.length.form),)
        return EndState(zero=kept, table=table, length=length, assumed=assumed)

    def give_up(self, found: Unread, line: int) -> None:
        """What comes now is not known."""
        self.rows.forms = self._forms([UNKNOWN] * len(AXES))
        self.rows.end(Wait.UNKNOWN, found.why, found.line or line)


def _check_channel(channel: float) -> None:
    if channel != round(channel) or not 0 <= channel <= MOST_CHANNEL:
        raise Unread(f"the channel {channel:g}")
