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
    from gproof.passes.interpret.mcuwin.parts import Part
    from gproof.passes.interpret.mcuwin.state import McuWinRun


def plane(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G17, G18, G19: the latter two count where a tool table is loaded (2.7, 14 (2.5.3.89))."""
    s = run.modal
    new = {F.PLANE_XY: Plane.XY, F.PLANE_XZ: Plane.XZ}.get(rule.function, Plane.YZ)
    if s.own.side and new is not s.plane:
        raise Refusal(codes.PLANE_WITH_COMPENSATION.at(line.code_span(), code=rule.text, plane=s.plane.name))
    is_open = new is not Plane.XY and not has_tools(run.machine)
    if new is not s.plane or is_open != s.own.plane_open:
        # I, J and K of another plane are other words.
        s.own = s.own.but(center=None)
    s.plane = new
    s.own = s.own.but(plane_open=is_open)
    if s.own.idle:
        correct(run, line, s.own.idle)
    s.stated.add("plane")
    run.event(Op.PLANE, line.span, arg=(float(new), 0.0))


def reflect(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G21 to G23: Y, X, or both."""
    s = run.modal
    columns = mirror_columns(run.machine)
    new = set(s.own.reflected)
    for bit, (letter, column) in enumerate(zip("XY", columns, strict=True)):
        if rule.value >> bit & 1:
            if column is None:
                raise Refusal(codes.AXIS_NOT_THERE.at(line.code_span(), axis=letter))
            new.add(column)
    if new != s.own.reflected:
        # The other side of the contour, from here on, or not.
        unfollowed(run, line, rule.text)
    if not run.moves and s.own.mirrored is None:
        s.own = s.own.but(mirrored=(rule.text, line.code_span()))
    s.own = s.own.but(reflected=frozenset(new))


def reflect_off(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G24: whether factors are kept for the next reflection is open."""
    s = run.modal
    if s.own.reflected:
        unfollowed(run, line, rule.text)
    factors = tuple(by if by == -1.0 else math.nan for by in s.own.factors)
    s.own = s.own.but(reflected=frozenset(), factors=(factors[0], factors[1]), mirrored=None)


def position_factor(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G39: factors of reflected axes; alone: all are -1 again."""
    s = run.modal
    words = line.axes()
    # Who gives a factor means a reflection.
    s.own = s.own.but(mirrored=None)
    factors = list(s.own.factors) if words else [-1.0, -1.0]
    columns = mirror_columns(run.machine)
    for axis, value in words.items():
        word = run.machine.word(axis)
        if word in line.bare:
            raise Refusal(codes.MISSING_VALUE.at(line.where(word), letter=word))
        if axis not in columns:
            what = f"{rule.text} of {word}, which no code mirrors"
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.where(word), code=what))
        if value == 0.0:
            raise Refusal(codes.SCALING_ZERO.at(line.where(word), code=rule.text))
        factors[columns.index(axis)] = math.nan if isinstance(value, Unknown) else value
    s.own = s.own.but(factors=(factors[0], factors[1]))


def effective_radius(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G51: radius of the cylinder on which words of a rotary axis are lengths, in interpolation units."""
    s = run.modal
    words = line.axes()
    if not words:
        raise Refusal(codes.AXIS_WORDS_MISSING.at(line.code_span(), code=rule.text))
    radii = dict(s.own.radii)
    for axis, value in words.items():
        word = run.machine.word(axis)
        if s.linear[axis]:
            what = f"{rule.text} of {word}, which is not a rotary axis"
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.where(word), code=what))
        if not isinstance(value, Unknown) and value <= 0.0:
            raise Refusal(codes.ILLEGAL_VALUE.at(line.where(word), word=word, what=f"a radius of {value:g}"))
        radii[axis] = math.nan if isinstance(value, Unknown) else value * s.unit
    s.own = s.own.but(radii=tuple(sorted(radii.items(), key=lambda pair: pair[0])))


def units(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G70, G71: positions and feeds of interpolation; F is required again."""
    s = run.modal
    new = INCH if rule.function is F.UNITS_INCH else 1.0
    s.stated.add("units")
    if new != s.unit:
        radii = tuple((axis, math.nan) for axis, _ in s.own.radii)
        s.own = s.own.but(asked=rule.text if s.own.given else "", radii=radii, center=None)
    s.unit = new
    run.state_changed()
    run.event(Op.UNITS, line.span, arg=(new, 0.0))


def per_minute(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G94: F counts a minute."""
    s = run.modal
    if s.own.time_unit != 60.0:
        s.own = s.own.but(time_unit=60.0, asked=rule.text if s.own.given else "")


def inverse_time(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G93 is not implemented (3.27)."""
    raise Refusal(codes.UNKNOWN_CODE.at(line.code_span(), code=f"{rule.text} (not implemented, 3.27)"))


def constant_speed(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G96, G97: which feed and speed follow is not described."""
    run.modal.own = run.modal.own.but(constant_speed=rule.function is F.SURFACE_SPEED)
    run.event(Op.DEVICE, line.span, text=run.text_number(rule.text))


def distance_mode(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G90, G91."""
    run.modal.absolute = rule.function is F.ABSOLUTE
    run.modal.own = run.modal.own.but(mode_open=False)
    run.modal.stated.add("distance")


def spline(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G150, G151: between the points of a spline the path is not known."""
    on = rule.function is F.SPLINE_ON
    run.modal.own = run.modal.own.but(spline=on)
    if on:
        what = f"{rule.text} (the path between the points is not in the manual)"
        run.fail(
            codes.UNSUPPORTED_CODE.at(
                line.code_span(), code=what, hint="leave it out: points are then joined by straight lines"
            )
        )


def centers(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G161: places in G90 (3.35); G162: distances (3.36). Each is over what IniCfg has."""
    s = run.modal
    s.own = s.own.but(centers_absolute=rule.function is F.CENTERS_ABSOLUTE, center=None)


def interpolation_axes(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G60: the axes of G01 to G03 (3.20, 14 (2.5.3.78)).

    It counts where it runs (the notes of 2.5.3.78), or what it says is read once, when the program starts (3.20): where
    it is not the first thing that such a program does, axes of which the two differ are doubtful.
    """
    s = run.modal
    new = frozenset(line.axes())
    if not new:
        raise Refusal(codes.AXIS_WORDS_MISSING.at(line.code_span(), code=rule.text))
    din, stated = s.own, din_of(run.machine).g60
    again = din.programmed_axes or bool(run.moves)
    if again and stated == "once":
        return
    start = din.at_start if again and stated != "run" else new
    if not again and not stated and "work" in s.stated:
        # Read when the program started, it holds for the offsets that were set above it too.
        for axis in din.interpolating ^ new:
            s.g92[axis] = NOWHERE
    s.own = din.but(interpolating=new | start, doubtful=new ^ start, at_start=start, programmed_axes=True)


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
