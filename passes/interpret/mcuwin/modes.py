"""Codes that say how moves count and where they go: planes, reflection, cylinders, units, modes, correction.

APCI-8001 G-code manual 3.6 to 3.17, 3.20 to 3.22, 3.24, 3.25, 3.27, 3.28, 3.31, 3.32, 3.35, 3.36 and 2.7.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOWHERE, Unknown
from gproof.ir.trace import Op, Plane
from gproof.passes.interpret.core.modal_state import INCH
from gproof.passes.interpret.mcuwin.moves import Handler
from gproof.passes.interpret.mcuwin.radius_correction import correct, correction, unfollowed
from gproof.passes.interpret.mcuwin.state import din_of, has_tools, mirror_columns

if TYPE_CHECKING:
    from gproof.passes.interpret.eding.moves import Motion
    from gproof.passes.interpret.mcuwin.line import Part


def plane(ex: Motion, line: Part, rule: CodeRule) -> None:
    """G17, G18, G19: the latter two count where a tool table is loaded (2.7, 14 (2.5.3.89))."""
    s = ex.modal
    new = {F.PLANE_XY: Plane.XY, F.PLANE_XZ: Plane.XZ}.get(rule.function, Plane.YZ)
    if s.din.side and new is not s.plane:
        raise Refusal(codes.PLANE_WITH_COMPENSATION.at(line.code_span(), code=rule.text, plane=s.plane.name))
    is_open = new is not Plane.XY and not has_tools(ex.machine)
    if new is not s.plane or is_open != s.din.plane_open:
        # I, J and K of another plane are other words.
        s.din = s.din.but(center=None)
    s.plane = new
    s.din = s.din.but(plane_open=is_open)
    if s.din.idle:
        correct(ex, line, s.din.idle)
    s.stated.add("plane")
    ex.event(Op.PLANE, line.span, arg=(float(new), 0.0))


def reflect(ex: Motion, line: Part, rule: CodeRule) -> None:
    """G21 to G23: Y, X, or both."""
    s = ex.modal
    columns = mirror_columns(ex.machine)
    new = set(s.din.reflected)
    for bit, (letter, column) in enumerate(zip("XY", columns, strict=True)):
        if rule.value >> bit & 1:
            if column is None:
                raise Refusal(codes.AXIS_NOT_THERE.at(line.code_span(), axis=letter))
            new.add(column)
    if new != s.din.reflected:
        # The other side of the contour, from here on, or not.
        unfollowed(ex, line, rule.text)
    if not ex._moves and s.din.mirrored is None:
        s.din = s.din.but(mirrored=(rule.text, line.code_span()))
    s.din = s.din.but(reflected=frozenset(new))


def reflect_off(ex: Motion, line: Part, rule: CodeRule) -> None:
    """G24: whether factors are kept for the next reflection is open."""
    s = ex.modal
    if s.din.reflected:
        unfollowed(ex, line, rule.text)
    factors = tuple(by if by == -1.0 else math.nan for by in s.din.factors)
    s.din = s.din.but(reflected=frozenset(), factors=(factors[0], factors[1]), mirrored=None)


def position_factor(ex: Motion, line: Part, rule: CodeRule) -> None:
    """G39: factors of reflected axes; alone: all are -1 again."""
    s = ex.modal
    words = line.axes()
    # Who gives a factor means a reflection.
    s.din = s.din.but(mirrored=None)
    factors = list(s.din.factors) if words else [-1.0, -1.0]
    columns = mirror_columns(ex.machine)
    for axis, value in words.items():
        word = ex.machine.word(axis)
        if word in line.bare:
            raise Refusal(codes.MISSING_VALUE.at(line.where(word), letter=word))
        if axis not in columns:
            what = f"{rule.text} of {word}, which no code reflects"
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.where(word), code=what))
        if value == 0.0:
            raise Refusal(codes.SCALING_ZERO.at(line.where(word), code=rule.text))
        factors[columns.index(axis)] = math.nan if isinstance(value, Unknown) else value
    s.din = s.din.but(factors=(factors[0], factors[1]))


def effective_radius(ex: Motion, line: Part, rule: CodeRule) -> None:
    """G51: radius of the cylinder on which words of a rotary axis are lengths, in interpolation units."""
    s = ex.modal
    words = line.axes()
    if not words:
        raise Refusal(codes.AXIS_WORDS_MISSING.at(line.code_span(), code=rule.text))
    radii = dict(s.din.radii)
    for axis, value in words.items():
        word = ex.machine.word(axis)
        if s.linear[axis]:
            what = f"{rule.text} of {word}, which is no rotary axis"
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.where(word), code=what))
        if not isinstance(value, Unknown) and value <= 0.0:
            raise Refusal(codes.ILLEGAL_VALUE.at(line.where(word), word=word, what=f"a radius of {value:g}"))
        radii[axis] = math.nan if isinstance(value, Unknown) else value * s.unit
    s.din = s.din.but(radii=tuple(sorted(radii.items(), key=lambda pair: pair[0])))


def units(ex: Motion, line: Part, rule: CodeRule) -> None:
    """G70, G71: positions and feeds of interpolation; F is asked for anew."""
    s = ex.modal
    new = INCH if rule.function is F.UNITS_INCH else 1.0
    s.stated.add("units")
    if new != s.unit:
        radii = tuple((axis, math.nan) for axis, _ in s.din.radii)
        s.din = s.din.but(asked=rule.text if s.din.given else "", radii=radii, center=None)
    s.unit = new
    ex._state_changed()
    ex.event(Op.UNITS, line.span, arg=(new, 0.0))


def per_minute(ex: Motion, line: Part, rule: CodeRule) -> None:
    """G94: F counts a minute."""
    s = ex.modal
    if s.din.time_unit != 60.0:
        s.din = s.din.but(time_unit=60.0, asked=rule.text if s.din.given else "")


def inverse_time(ex: Motion, line: Part, rule: CodeRule) -> None:
    """G93 is not implemented (3.27)."""
    raise Refusal(codes.UNKNOWN_CODE.at(line.code_span(), code=f"{rule.text} (not implemented, 3.27)"))


def constant_speed(ex: Motion, line: Part, rule: CodeRule) -> None:
    """G96, G97: which feed and speed follow is not described."""
    ex.modal.din = ex.modal.din.but(constant_speed=rule.function is F.SURFACE_SPEED)
    ex.event(Op.DEVICE, line.span, text=ex._text(rule.text))


def distance_mode(ex: Motion, line: Part, rule: CodeRule) -> None:
    """G90, G91."""
    ex.modal.absolute = rule.function is F.ABSOLUTE
    ex.modal.din = ex.modal.din.but(mode_open=False)
    ex.modal.stated.add("distance")


def spline(ex: Motion, line: Part, rule: CodeRule) -> None:
    """G150, G151: between the points of a spline nobody knows the path."""
    on = rule.function is F.SPLINE_ON
    ex.modal.din = ex.modal.din.but(spline=on)
    if on:
        what = f"{rule.text} (the path between points)"
        ex._fail(codes.UNSUPPORTED_CODE.at(line.code_span(), code=what, hint="without it, points are joined by lines"))


def centers(ex: Motion, line: Part, rule: CodeRule) -> None:
    """G161: places in G90 (3.35); G162: distances (3.36). Each stands over what IniCfg has."""
    s = ex.modal
    s.din = s.din.but(centers_absolute=rule.function is F.CENTERS_ABSOLUTE, center=None)


def interpolation_axes(ex: Motion, line: Part, rule: CodeRule) -> None:
    """G60: the axes of G01 to G03 (3.20, 14 (2.5.3.78)).

    It counts where it runs (the notes of 2.5.3.78), or what it says is read once, when the program starts (3.20): where
    it is not the first thing that such a program does, axes of which the two differ are doubtful.
    """
    s = ex.modal
    new = frozenset(line.axes())
    if not new:
        raise Refusal(codes.AXIS_WORDS_MISSING.at(line.code_span(), code=rule.text))
    din, stated = s.din, din_of(ex.machine).g60
    again = din.programmed_axes or bool(ex._moves)
    if again and stated == "once":
        return
    start = din.at_start if again and stated != "run" else new
    if not again and not stated and "work" in s.stated:
        # Read when the program started, it holds for the offsets that were set above it too.
        for axis in din.interpolating ^ new:
            s.g92[axis] = NOWHERE
    s.din = din.but(interpolating=new | start, doubtful=new ^ start, at_start=start, programmed_axes=True)


HANDLERS: dict[F, Handler] = {
    F.PLANE_XY: plane,
    F.PLANE_XZ: plane,
    F.PLANE_YZ: plane,
    F.REFLECT: reflect,
    F.REFLECT_OFF: reflect_off,
    F.POSITION_FACTOR: position_factor,
    F.EFFECTIVE_RADIUS: effective_radius,
    F.UNITS_INCH: units,
    F.UNITS_MM: units,
    F.FEED_PER_MINUTE: per_minute,
    F.FEED_INVERSE_TIME: inverse_time,
    F.SURFACE_SPEED: constant_speed,
    F.SPINDLE_RPM: constant_speed,
    F.ABSOLUTE: distance_mode,
    F.INCREMENTAL: distance_mode,
    F.SPLINE_OFF: spline,
    F.SPLINE_ON: spline,
    F.CENTERS_ABSOLUTE: centers,
    F.CENTERS_RELATIVE: centers,
    F.INTERPOLATION_AXES: interpolation_axes,
    F.COMPENSATION_OFF: correction,
    F.COMPENSATION_LEFT: correction,
    F.COMPENSATION_RIGHT: correction,
}
