"""What raising of McuWIN knows besides what every dialect's does: machine, own modes, units, words of axes.

Sections are those of the manual of V 2.5.3.133; docs/dialects/mcuwin.md says how open questions are read. What is open
there is no operation here: ``Unraisable``.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from gproof.frontend.common.raising import Raiser, Unraisable
from gproof.frontend.common.raising_modes import UNKNOWN_MODE, LineWord, Modes
from gproof.ir.dialects.mcuwin.rules import COMMON, DECLARED, PROTECTED
from gproof.ir.dialects.mcuwin.settings import VERSIONS, mcuwin_settings
from gproof.ir.finding import Span
from gproof.ir.job import AxisPlace, Feed, Quantity
from gproof.ir.machine import AXIS_NAMES, AxisKind, Machine
from gproof.ir.program import Binary, Expr, Named, Number, Program, Unary, Variable

UNIT_NAMES = {1.0: "mm", 25.4: "inch", 10.0: "cm"}
"""Units of length by their millimetres (3.21, 3.22, IniCfg)."""
MINUTE = 60.0
BY_WAY = "it depends on the path that the program took"


class McuWinState(Raiser):
    """Modes of its own.

    ``feed``: ``none``, ``given``, ``asked`` (F must come again, 3.21, 3.28); ``time``: seconds in the unit of feeds;
    ``axes``: those that interpolate (3.20); ``began``: a move or a G60 has come; ``reflected``, ``factors``: 3.9 to
    3.13, None: open; ``zero``: axes whose zero is certainly that of the machine; ``plane_open``: G18, G19 without a
    tool table (2.7); ``centers``: absolute in G90, None: not stated; ``center``: whether I, J and K of the arc before
    were 0, or there was none; ``side``: tool radius correction is on; ``kept``: a G153 has come.
    """

    def __init__(self, program: Program, machine: Machine) -> None:
        self.din = mcuwin_settings(machine)
        self.columns = {axis.word: axis.index for axis in machine.axes}
        self.names = {axis.word: AXIS_NAMES[axis.index] for axis in machine.axes}
        self.rotary = {axis.word for axis in machine.axes if axis.kind is AxisKind.ROTARY}
        self.own_units = {axis.word: axis.position_unit or 1.0 for axis in machine.axes}
        self.old = self.din.version == VERSIONS[1]
        self.shortest_path = any("shortest_path" in one.what for one in machine.not_modelled)
        super().__init__(program, machine)

    def first_modes(self) -> Modes:
        """The modes in which a job starts (3, IniCfg)."""
        din = self.din
        named = din.interpolation_axes
        axes = tuple(self.names[word] for word in self.columns if named is None or word in named)
        own: dict[str, object] = {
            "feed": "none", "time": din.time_unit, "axes": axes, "began": False, "reflected": (),
            "factors": (-1.0, -1.0), "zero": (), "plane_open": False, "centers": din.absolute_centers,
            "center": (True, True, True), "side": False, "kept": False,
        }  # fmt: skip
        unit = UNIT_NAMES.get(din.position_unit or 1.0, UNKNOWN_MODE)
        return Modes(unit=unit, more=tuple(sorted(own.items(), key=lambda pair: pair[0])))

    # ---- modes

    @property
    def now(self) -> Modes:
        """The modes in force."""
        assert self.modes is not None
        return self.modes

    def mode(self, name: str, construct: str) -> Any:
        """A mode of its own, which a construct needs; Unraisable where it is not known."""
        value = self.now.own(name)
        if value == UNKNOWN_MODE:
            raise Unraisable(construct, BY_WAY)
        return value

    def keep(self, **modes: object) -> None:
        """Modes of its own from here on."""
        for name, value in modes.items():
            self.modes = self.now.with_own(name, value)

    def set_modes(self, **modes: Any) -> None:
        """Modes that every dialect has, from here on."""
        self.modes = replace(self.now, **modes)

    @property
    def is_relative(self) -> bool:
        """G91; Unraisable where it is not known."""
        if self.now.relative == UNKNOWN_MODE:
            raise Unraisable("axis words", "whether they are places or distances is not known (3.18, 3.24, 3.25)")
        return self.now.relative is True

    @property
    def length_unit(self) -> str:
        """The unit of interpolation; Unraisable where it is not known."""
        if self.now.unit == UNKNOWN_MODE:
            raise Unraisable("a length", "its unit is not known (3.21, 3.22)")
        return self.now.unit

    # ---- values

    def plain(self, value: Expr) -> Expr:
        """A value that any controller can have; Unraisable."""
        if isinstance(value, Named):
            raise Unraisable(value.name, "what the controller holds there, no other one has (12)")
        if isinstance(value, Variable):
            number = value.number.value if isinstance(value.number, Number) else None
            if number is not None and number < DECLARED and number % COMMON < PROTECTED:
                name = self.program.rules.name_of(int(number))
                raise Unraisable(name, "it belongs to the controller (11)")
            self.plain(value.number)
        elif isinstance(value, Unary):
            self.plain(value.operand)
        elif isinstance(value, Binary):
            self.plain(value.left)
            self.plain(value.right)
        return value

    def own_unit(self, word: str) -> str:
        """The unit of an axis's own positions, which G00 and zero offsets have (3.1); Unraisable for a strange one."""
        scale = self.own_units[word]
        unit = ("deg" if scale == 1.0 else "") if word in self.rotary else UNIT_NAMES.get(scale, "")
        if not unit:
            raise Unraisable(f"{word} in units of its own", f"one of them is {scale:g} mm or degrees (3.1)")
        return unit

    def quantity(self, word: LineWord, *, own: bool) -> Quantity:
        """The value of an axis word. own: in the axis's unit, otherwise in that of interpolation."""
        value = self.plain(word.value)
        if own or word.letter in self.rotary:
            return Quantity(value, self.own_unit(word.letter))
        return Quantity(value, self.length_unit)

    def feed_of(self, word: LineWord) -> Feed:
        """F, a minute (3.28, 5.3, IniCfg)."""
        value = self.plain(word.value)
        time = self.mode("time", "F")
        if time is None:
            raise Unraisable("F", "whether it counts a minute or a second is in no file (IniCfg, 5.3)")
        return Feed(Quantity(times(value, MINUTE / time, word.span), self.length_unit))

    def places(self, words: dict[str, LineWord], *, own: bool, span: Span) -> tuple[AxisPlace, ...]:
        """The axis words of a move (3.1 to 3.4), in the order of the columns."""
        found = []
        for letter, axis in self.names.items():
            if letter not in words:
                continue
            relative = self.is_relative
            self.no_doubtful_mirror(axis, letter, relative)
            if letter in self.rotary and self.shortest_path:
                raise Unraisable(f"{letter} by the shortest path", "no other controller turns so (14 (2.5.3.75))")
            found.append(AxisPlace(axis, self.quantity(words[letter], own=own), relative))
        return tuple(found)

    def no_doubtful_mirror(self, axis: str, letter: str, relative: bool) -> None:
        """Unraisable for a place under a reflection: about which zero it is mirrored, is open (3.9, 3.26)."""
        reflected = self.mode("reflected", f"{letter} under a reflection")
        if axis not in reflected:
            return
        if not relative and axis not in self.mode("zero", f"{letter} under a reflection"):
            what = "whether it is mirrored about the zero offset or machine zero is open (3.9, 3.26)"
            raise Unraisable(f"a place of {letter} under a reflection", f"{what}; a distance (G91) is clear")


def times(value: Expr, factor: float, span: Span) -> Expr:
    """A value times a number; of a literal the product."""
    if factor == 1.0:
        return value
    if isinstance(value, Number):
        return Number(round(value.value * factor, 9), value.span)
    return Binary("*", value, Number(factor, span), span)
