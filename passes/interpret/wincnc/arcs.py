"""Arcs by centre or radius, and their feed (WinCNC Users Guide, G Codes: G2, G3)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import Refusal
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import Position, Unknown, Value
from gproof.ir.symbols import describe
from gproof.ir.trace import Op, Plane
from gproof.passes.interpret.core import line_kernels as k
from gproof.passes.interpret.core.arc_condition import radius_arc_warning
from gproof.passes.interpret.core.line_kernels import SAME, ZERO_RADIUS, distance
from gproof.passes.interpret.wincnc.axis_targets import aim, mapped
from gproof.passes.interpret.wincnc.line_kernels import agreed
from gproof.passes.interpret.wincnc.moves import feed_columns, feed_word, note_assumptions, switch_output, use_feed
from gproof.passes.interpret.wincnc.state import (
    LEANING,
)

if TYPE_CHECKING:
    from gproof.passes.interpret.wincnc.command import Command
    from gproof.passes.interpret.wincnc.state import (
        WinCncModal,
        WinCncRun,
    )


def arc(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G2 and G3 in X and Y; what else the line names moves along evenly."""
    note_assumptions(run, line.span)
    s = run.modal
    controls = wincnc_settings(run.machine)
    if controls.arcs_modal:
        s.motion = int(rule.function)
        s.cycle, s.cycle_code = {}, 0
    if "compensation" in s.own.flags:
        raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause="the amount of compensation (G41, G42)"))
    moved = set(mapped(run, line))
    if "mapped" in s.own.flags:
        raise Refusal(codes.ARC_MAPPED.at(line.span, code="L11"))
    if LEANING in s.own.flags:
        raise Refusal(codes.ARC_LEANING_KNIFE.at(line.span))
    if s.transform.factors != (1.0, 1.0):
        raise Refusal(codes.ARC_SCALED.at(line.span, axes="X or Y", code="G51"))
    if not moved & {3, 4, 5} and not controls.helical_arcs and moved & {2}:
        raise Refusal(codes.HELIX_NOT_SUPPORTED.at(line.span, axes="Z"))
    if "K" in line.values and (not {"I", "J"} <= line.values.keys() or line.number("K")):
        # Next to I and J a K of 0 says nothing; else it may be the centre of an arc in another plane.
        _keep_words(s, line)
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where("K"), code=f"K of {rule.text}, an arc in another plane,"))
    target = aim(run, line)
    turns = 1 if rule.function is F.ARC_CCW else -1
    start, end = (s.position[0], s.position[1]), (target[0], target[1])
    for a, b, name in zip(start, end, "XY", strict=True):
        difference = b.minus(a)
        if difference.form:
            _keep_words(s, line)
            raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=f"{name}: {describe(difference.form)}"))
    center = _center(run, line, rule, start, end, moved)
    same = all(abs(a.value - b.value) < SAME for a, b in zip(start, end, strict=True))
    radius = distance(center[0] - start[0].value, center[1] - start[1].value)
    if radius < ZERO_RADIUS:
        raise Refusal(codes.ARC_RADIUS_ZERO.at(line.span))
    at_end = distance(center[0] - end[0].value, center[1] - end[1].value)
    if abs(at_end - radius) > s.arc_tolerance() + SAME:
        raise Refusal(
            codes.ARC_RADIUS_MISMATCH.at(
                line.span, start=radius, end=at_end, off=abs(at_end - radius), allowed=s.arc_tolerance(), unit="mm",
                hint="check I and J: the controller stops with Arc Radius; arc_err= sets what it allows",
            )
        )  # fmt: skip
    if same:
        target[0], target[1] = start
        if moved & {0, 1}:
            run.findings.add(codes.ARC_FULL_CIRCLE.at(line.span))
    if s.feed_mode == 93:
        s.feed = math.nan
        s.feed_mode = 94
        try:
            _make(run, line, target, center, radius, turns)
        finally:
            s.feed_mode = 93
        return
    _arc_feed(run, line, moved | {0, 1})
    _make(run, line, target, center, radius, turns)


def _arc_feed(run: WinCncRun, line: Command, moved: set[int]) -> None:
    """F of arcs is kept apart from that of lines (Feed Velocity), or not: known where both readings agree.

    They do after an F of an arc until lines have one: it is then the last of both.
    """
    s = run.modal
    share = wincnc_settings(run.machine).arcs_share_feed
    value = line.values.get("F")
    if share:
        feed_word(run, line, moved)
        s.feed = agreed(s.own.feeds, 0, 3, 3)
    elif value is not None:
        if not isinstance(value, Unknown) and value <= 0:
            raise Refusal(codes.ILLEGAL_VALUE.at(line.where("F"), word="F", what=f"a feed of {value:g}"))
        s.feed = math.nan if isinstance(value, Unknown) else value * s.unit
        s.own = s.own.but(arc_feed=s.feed, feed_doubt=share is None and s.own.feeds[:2] != (s.feed, s.feed))
        if share is None:
            s.own = s.own.but(feeds=_either_feed(run, moved, value))
    else:
        own = usual_feed(run) if s.own.arc_feed is None else s.own.arc_feed
        last_of_both = s.own.arc_feed is not None and s.own.feed_doubt
        alike = share is False or last_of_both or (s.own.feeds[0] == own and s.own.feeds[1] == own)
        s.feed = own if alike else math.nan
    s.feed_unit = 1.0


def _either_feed(run: WinCncRun, moved: set[int], value: Value) -> tuple[float, ...]:
    """Feeds of lines after an F of an arc that may be theirs too: of axes besides X and Y, whose doubt is apart."""
    s = run.modal
    named = feed_columns(wincnc_settings(run.machine), moved) - {0, 1}
    rates = {column: math.nan if isinstance(value, Unknown) else value * s.scale(column) for column in named}
    return tuple(
        feed if column not in rates or rates[column] == feed else math.nan for column, feed in enumerate(s.own.feeds)
    )


def usual_feed(run: WinCncRun) -> float:
    """mm/min of X before a program gives another; NaN where no file says it."""
    axis = run.machine.axis("x")
    return math.nan if axis is None or axis.feed_velocity is None else axis.feed_velocity * 60.0


def _make(
    run: WinCncRun, line: Command, target: list[Position], center: list[float], radius: float, turns: int
) -> None:  # fmt: skip
    s = run.modal
    switch_output(run, line, cutting=True)
    smallest = wincnc_settings(run.machine).smallest_arc
    if smallest is not None and radius < smallest:
        closed = all(abs(target[axis].value - s.position[axis].value) < SAME for axis in (0, 1))
        hint = "check the start point: the arc is a full circle, and none of it is cut" if closed else ""
        run.findings.add(codes.ARC_UNDER_MINIMUM.at(line.span, radius=radius, allowed=smallest, unit="mm", hint=hint))
        if s.feed_mode != 93:
            use_feed(run, line, target, {0, 1})
        run.move(Op.FEED, target, line.span)
    else:
        whole = [center[0], center[1], run.modal.position[2].value]
        run.move(Op.ARC, target, line.span, center=whole, turns=turns, plane=Plane.XY)
    run.moved = True


def _keep_words(s: WinCncModal, line: Command) -> None:
    """I and J that a later arc counts with, of an arc that nobody can follow."""
    given = [line.values.get(letter) for letter in "IJ"]
    if "R" in line.values:
        s.own = s.own.but(center=(math.nan, math.nan))
    elif given != [None, None]:
        i, j = (value * s.unit if isinstance(value, float) else math.nan for value in given)
        s.own = s.own.but(center=(math.nan, math.nan) if math.isnan(i + j) else (i, j))


def _center(
    run: WinCncRun, line: Command, rule: CodeRule, start: tuple[Position, Position], end: tuple[Position, Position],
    moved: set[int],
) -> list[float]:  # fmt: skip
    s = run.modal
    if any(isinstance(line.values.get(letter), Unknown) for letter in "IJR"):
        _keep_words(s, line)
    given = {letter: line.number(letter) for letter in "IJ" if letter in line.values}
    if "R" in line.values:
        if given:
            raise Refusal(codes.UNUSED_WORD.at(line.where("R"), word="R together with a centre"))
        radius = line.number("R") or 0.0
        if radius <= 0.0:
            raise Refusal(codes.ILLEGAL_VALUE.at(line.where("R"), word="R", what=f"a radius of {radius:g}"))
        radius *= s.unit
        x, y, bad = k.radius_center(
            start[0].value, start[1].value, end[0].value, end[1].value, radius, int(rule.function is F.ARC_CCW)
        )
        if bad == k.RADIUS_SAME_POINT:
            raise Refusal(codes.ARC_SAME_POINT.at(line.span))
        chord = math.hypot(end[0].value - start[0].value, end[1].value - start[1].value)
        if bad == k.RADIUS_UNREACHABLE:
            raise Refusal(codes.ARC_UNREACHABLE.at(line.where("R"), chord=chord, radius=radius, unit="mm"))
        warning = radius_arc_warning(line.span, chord, radius, s.unit != 1.0)
        if warning is not None:
            run.findings.add(warning)
        # Whether R leaves the I and J before it, those of its own centre, or none is not said.
        s.own = s.own.but(center=(math.nan, math.nan))
        return [x, y]
    kept = s.own.center
    if not given:
        if kept is None:
            raise Refusal(codes.ARC_CENTER_MISSING.at(line.span, code=rule.text, needed="I and J, or R"))
        if math.isnan(kept[0]):
            raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause="I and J of an earlier arc, which are unknown"))
        i, j = kept
    else:
        values = []
        for n, letter in enumerate("IJ"):
            value = given.get(letter)
            if value is None:
                if kept is not None and not abs(kept[n]) <= SAME:
                    other = f"{letter} missing: the value of the arc before, or 0"
                    _keep_words(s, line)
                    raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=other))
                value = 0.0
                if kept is None:
                    run.assumed["no I or J is left from the job before"] = None
                if run.machine.controller.absolute_arc_centers:
                    raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=f"{letter} left out with absolute centres on"))
            values.append(value * s.unit)
        i, j = values
        s.own = s.own.but(center=(i, j))
    if run.machine.controller.absolute_arc_centers:
        places = [s.offset(axis).moved(value) for axis, value in ((0, i), (1, j))]
        if s.transform.on:
            places = list(s.transform.absolute((i, j), (start[0], start[1]), (s.offset(0), s.offset(1))))
        for place, at in zip(places, start, strict=True):
            if place.form != at.form:
                raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=describe(place.minus(at).form)))
        return [places[0].value, places[1].value]
    if s.transform.on:
        i, j = s.transform.step(i, j)
    return [start[0].value + i, start[1].value + j]
