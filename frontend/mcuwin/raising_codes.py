"""Codes of McuWIN that choose a mode, a frame or a correction, as modes and operations of a Job: (state, part, span).

Sections are those of the manual of V 2.5.3.133: 3.6 to 3.33.
"""

from __future__ import annotations

from collections.abc import Callable

from gproof.frontend.common.raising import Unraisable
from gproof.frontend.common.raising_modes import UNKNOWN_MODE
from gproof.frontend.mcuwin.raising_state import MINUTE, McuWinState
from gproof.frontend.mcuwin.raising_words import Part
from gproof.ir.dialects.mcuwin.rules import OFFSETS_AT
from gproof.ir.finding import Span
from gproof.ir.job import AxisPlace, Compensate, Node, Quantity, SetFrame
from gproof.ir.program import Number, Program
from gproof.ir.rules import Function as F

Handler = Callable[[McuWinState, Part, Span], list[Node]]
PLANES = {F.PLANE_XY: "xy", F.PLANE_XZ: "xz", F.PLANE_YZ: "yz"}
_READ_AT = range(OFFSETS_AT, OFFSETS_AT + 10)


def plane(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G17 to G19; the latter two without a tool table: whether they count is open (2.7, 14 (2.5.3.89))."""
    new = PLANES[part.rule.function]
    if new != state.now.plane:
        state.keep(center=(True, True, True))
    state.keep(plane_open=new != "xy" and not state.din.tools)
    state.set_modes(plane=new)
    return []


# ---- units, distances, centres, feeds


def units(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G70, G71: F has to come again (3.21, 3.22)."""
    new = "inch" if part.rule.function is F.UNITS_INCH else "mm"
    if new != state.now.unit:
        _ask(state)
        state.keep(center=(True, True, True))
    state.set_modes(unit=new)
    return []


def per_minute(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G94: F counts a minute (3.28)."""
    if state.now.own("time") != MINUTE:
        _ask(state)
    state.keep(time=MINUTE)
    return []


def _ask(state: McuWinState) -> None:
    if state.now.own("feed") != "none":
        state.keep(feed="asked")


def distance(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G90, G91 (3.24, 3.25)."""
    state.set_modes(relative=part.rule.function is F.INCREMENTAL)
    return []


def centers(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G161, G162 (3.35, 3.36)."""
    state.keep(centers=part.rule.function is F.CENTERS_ABSOLUTE, center=(True, True, True))
    return []


def default(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G97, G150: what is in force as long as the codes that they end are refused (3.28, 3.31)."""
    return []


def interpolation(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G60: the axes of G01 to G03; after moves or another G60 it may count or not (3.20, 14 (2.5.3.78))."""
    new = tuple(axis for letter, axis in state.names.items() if letter in part.values)
    if not new:
        raise Unraisable("G60", "axes are missing")
    again = state.now.own("began")
    if state.now.own("axes") != new and again is not False and state.din.g60 != "run":
        if state.din.g60 == "once" and again is True:
            return []
        raise Unraisable("G60 after moves", "whether it counts there is open (3.20)")
    state.keep(axes=new, began=True)
    return []


# ---- reflections


def effective(state: McuWinState, construct: str) -> dict[str, float]:
    """What numbers of X and Y are multiplied by, axis by axis, where that is not 1 (3.9 to 3.13)."""
    reflected = state.mode("reflected", construct)
    factors = state.mode("factors", construct)
    found = {}
    for letter, by in zip("XY", factors, strict=True):
        axis = state.names.get(letter, "")
        if axis in reflected:
            if by is None:
                raise Unraisable(construct, "whether G24 keeps the factors of G39 is open (3.12, 3.13)")
            found[axis] = by
    return found


def _reframed(state: McuWinState, before: dict[str, float], now: dict[str, float], span: Span) -> list[Node]:
    """From one set of factors to another: -1 is a mirror, another number a scale."""
    ended: list[Node] = []
    started: list[Node] = []
    for action, is_mirror in (("mirror", True), ("scale", False)):
        old = {axis: by for axis, by in before.items() if (by == -1.0) is is_mirror}
        new = {axis: by for axis, by in now.items() if (by == -1.0) is is_mirror}
        if old == new:
            continue
        if old:
            ended.append(SetFrame(action=f"{action}_off", span=span))
        if new and is_mirror:
            zeros = tuple(AxisPlace(axis, Quantity(Number(0.0, span), "mm")) for axis in sorted(new))
            started.append(SetFrame(action="mirror", places=zeros, span=span))
        elif new:
            by = tuple(AxisPlace(axis, Quantity(Number(value, span), "1")) for axis, value in sorted(new.items()))
            started.append(SetFrame(action="scale", factors=by, span=span))
    return [*ended, *started]


def reflect(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G21 to G23: they add up (3.9 to 3.11)."""
    code = part.rule.text
    before = effective(state, code)
    added = {letter for bit, letter in enumerate("XY") if part.rule.value >> bit & 1}
    if not added <= state.names.keys():
        raise Unraisable(code, "the machine has no such axis")
    _uncorrected(state, code)
    reflected = {*state.mode("reflected", code), *(state.names[letter] for letter in added)}
    state.keep(reflected=tuple(sorted(reflected)))
    return _reframed(state, before, effective(state, code), span)


def reflect_off(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G24; whether it keeps the factors of G39 is open (3.12)."""
    before = effective(state, "G24")
    if before:
        _uncorrected(state, "G24")
    factors = tuple(by if by == -1.0 else None for by in state.mode("factors", "G24"))
    state.keep(reflected=(), factors=factors)
    return _reframed(state, before, {}, span)


def position_factor(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G39: factors of reflected axes; alone: all are -1 again (3.13)."""
    before = effective(state, "G39") if None not in state.mode("factors", "G39") else {}
    factors = list(state.mode("factors", "G39")) if part.values else [-1.0, -1.0]
    for letter, word in part.values.items():
        if letter not in "XY":
            raise Unraisable(f"G39 of {letter}", "no code mirrors it (3.13)")
        if word.number is None or word.number == 0.0:
            raise Unraisable("G39", "its factor is 0 or computed")
        factors["XY".index(letter)] = word.number
    state.keep(factors=tuple(factors))
    return _reframed(state, before, effective(state, "G39"), span)


# ---- tool radius


def correction(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G40 to G42, by the record of the tool table that T has selected (2.7, 3.14 to 3.16)."""
    function, code = part.rule.function, part.rule.text
    on = state.now.own("side")
    if function is F.COMPENSATION_OFF:
        state.keep(side=False)
        return [] if on is False else [Compensate(side="off", open=True, span=span)]
    if not state.din.tools:
        raise Unraisable(code, "no tool table is known (2.7)")
    if on is not False:
        raise Unraisable(code, "another correction is on")
    if state.now.plane == UNKNOWN_MODE:
        raise Unraisable(code, "the plane depends on the path that the program took")
    state.keep(side=True)
    side = "left" if function is F.COMPENSATION_LEFT else "right"
    return [Compensate(side=side, plane=state.now.plane, open=True, span=span)]


def _uncorrected(state: McuWinState, code: str) -> None:
    if state.now.own("side") is not False:
        raise Unraisable(f"{code} while the tool radius is corrected", "the path is open (2.7)")


# ---- zero offsets


def offset_off(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G53: the zero of the interpolation axes is that of the machine; in G91 it may end G91 too (3.18)."""
    _uncorrected(state, "G53")
    axes = state.mode("axes", "G53")
    if state.now.relative is not False:
        state.set_modes(relative=UNKNOWN_MODE)
    state.keep(zero=tuple(sorted({*_zeros(state), *axes})))
    zeros = tuple(AxisPlace(axis, Quantity(Number(0.0, span), _unit_of(state, axis))) for axis in axes)
    return [SetFrame(action="zero_at", places=zeros, span=span)]


def _zeros(state: McuWinState) -> tuple[str, ...]:
    known = state.now.own("zero")
    return known if isinstance(known, tuple) else ()


def _unit_of(state: McuWinState, axis: str) -> str:
    return state.own_unit(next(letter for letter, name in state.names.items() if name == axis))


def offset_record(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G54 to G58: records of the table, for the interpolation axes (3.19), in V 2.5.3.32 for all (4.19 there)."""
    _uncorrected(state, part.rule.text)
    every = tuple(state.names.values())
    axes = every if state.old else state.mode("axes", part.rule.text)
    state.keep(zero=tuple(axis for axis in _zeros(state) if axis not in axes))
    number = Number(float(part.rule.value), span)
    some = tuple(axes) if set(axes) != set(every) else ()
    return [SetFrame(action="select", number=number, axes=some, span=span)]


def zero_offset(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G92: a zero in machine places; in G91 from the zero in force (3.26)."""
    _uncorrected(state, "G92")
    relative = state.is_relative
    reflected = state.mode("reflected", "G92")
    places: list[AxisPlace] = []
    zero = set(_zeros(state))
    for letter, axis in state.names.items():
        if letter not in part.values:
            continue
        word = part.values[letter]
        own = state.own_unit(letter)
        if word.number != 0.0 and axis in reflected:
            raise Unraisable(f"G92 {letter} under a reflection", "in which direction it counts is open (3.26)")
        if word.number != 0.0 and letter not in state.rotary and state.length_unit != own:
            raise Unraisable(f"G92 {letter}", "whether it has the unit of the axis or of G70 and G71 is open (3.26)")
        places.append(AxisPlace(axis, state.quantity(word, own=True)))
        if not relative and word.number == 0.0:
            zero.add(axis)
        elif not (relative and word.number == 0.0):
            zero.discard(axis)
    if not places:
        raise Unraisable("G92", "axes are missing")
    state.keep(zero=tuple(sorted(zero)))
    return [SetFrame(action="zero_shift" if relative else "zero_at", places=tuple(places), span=span)]


def read_offset(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G153: the offset of all axes is kept in CD50 and on (3.33)."""
    _no_numbers(state.program)
    state.keep(kept=True)
    return [SetFrame(action="zero_keep", span=span)]


def restore_offset(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G154: the offset that G153 has kept (3.34)."""
    _uncorrected(state, "G154")
    if part.values:
        raise Unraisable("G154 with letters of axes", "whether they select its axes is open (3.34)")
    if state.now.own("kept") is not True:
        raise Unraisable("G154", "no G153 of this program is certainly before it (3.33)")
    _no_numbers(state.program)
    state.keep(zero=())
    return [SetFrame(action="zero_recall", span=span)]


def _no_numbers(program: Program) -> None:
    """Unraisable where a program uses CD50 and on as variables."""
    bodies = (program.head, program.body, *(sub.body for sub in program.subprograms.values()))
    text = repr(bodies)
    if any(f"Variable(number=Number(value={float(n)!r}," in text for n in _READ_AT):
        raise Unraisable("G153 and G154", f"the program uses CD{OFFSETS_AT} and on as numbers (3.33)")


# ---- what has no form


def _refused(why: str) -> Handler:
    def handler(state: McuWinState, part: Part, span: Span) -> list[Node]:
        raise Unraisable(part.rule.text, why)

    return handler


MODES: dict[F, Handler] = {
    F.PLANE_XY: plane,
    F.PLANE_XZ: plane,
    F.PLANE_YZ: plane,
    F.REFLECT: reflect,
    F.REFLECT_OFF: reflect_off,
    F.POSITION_FACTOR: position_factor,
    F.EFFECTIVE_RADIUS: _refused("words of a rotary axis are lengths on a cylinder (3.17)"),
    F.UNITS_INCH: units,
    F.UNITS_MM: units,
    F.FEED_PER_MINUTE: per_minute,
    F.FEED_INVERSE_TIME: _refused("it is not implemented (3.27)"),
    F.SURFACE_SPEED: _refused("which feed and speed follow is open (3.28)"),
    F.SPINDLE_RPM: default,
    F.ABSOLUTE: distance,
    F.INCREMENTAL: distance,
    F.SPLINE_OFF: default,
    F.SPLINE_ON: _refused("the path between the points is open (3.32)"),
    F.CENTERS_ABSOLUTE: centers,
    F.CENTERS_RELATIVE: centers,
    F.INTERPOLATION_AXES: interpolation,
    F.COMPENSATION_OFF: correction,
    F.COMPENSATION_LEFT: correction,
    F.COMPENSATION_RIGHT: correction,
    F.ZERO_OFFSET_OFF: offset_off,
    F.SELECT_COORDINATES: offset_record,
    F.ZERO_OFFSET_SET: zero_offset,
    F.ZERO_OFFSET_READ: read_offset,
    F.ZERO_OFFSET_RESTORE: restore_offset,
    F.LIMIT_LEFT: _refused("a software limit that the program sets (3.29)"),
    F.LIMIT_RIGHT: _refused("a software limit that the program sets (3.30)"),
}
"""What a code that acts before the motion of its line means."""
