"""Motion codes to rows: lines, arcs by centre or radius, feeds. Eding CNC manual 3.4.1 to 3.4.3, 3.4.24."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import ORIGIN, Position, Unknown, not_known
from gproof.ir.symbols import describe
from gproof.ir.trace import Op, Plane
from gproof.passes.interpret.core import line_kernels as k
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.core.arc_condition import radius_arc_warning
from gproof.passes.interpret.core.moves import AXES_OF_PLANE
from gproof.passes.interpret.core.parsed_line import Line
from gproof.passes.interpret.eding import compensation_codes as compensated
from gproof.passes.interpret.eding.axis_targets import aim, named_place, need_feed, note_assumptions
from gproof.passes.interpret.eding.canned_cycles import run_cycle
from gproof.passes.interpret.eding.cycle_motions import CYCLES
from gproof.passes.interpret.eding.probing import run_probe
from gproof.passes.interpret.eding.spindle_synchronised import SYNCHRONISED, run_synchronised
from gproof.passes.interpret.eding.threading import run_threading
from gproof.passes.interpret.eding.transform_codes import check_arc

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

_OUT_OF_PLANE = {Plane.XY: "K", Plane.XZ: "J", Plane.YZ: "I"}
_CENTER_WORDS = {Plane.XY: ("I", "J"), Plane.XZ: ("I", "K"), Plane.YZ: ("J", "K")}


def motion(run: Run, line: Line, rule: CodeRule) -> None:
    """Execute the motion code of a line, or the one in force (step 20)."""
    note_assumptions(run, line, rule)
    machine = line.find(F.MACHINE_COORDINATES)
    if refused_lines.vague(run, line, rule, machine=machine is not None):
        return
    if machine is not None and rule.function not in (F.TRAVERSE, F.FEED, F.PROBE):
        raise Refusal(codes.G53_NEEDS_G0_G1.at(line.where_code(machine), mode=rule.text))
    comp = run.modal.compensation
    if comp is not None and machine is not None:
        raise Refusal(codes.G53_WITH_COMPENSATION.at(line.where_code(machine), hint="program G40 before"))
    if rule.function is F.PROBE:
        compensated.no_probing(run.modal, line, rule)
    if comp is not None and rule.function in (*CYCLES, F.THREADING):
        # 3.4.19 calls G76 a canned cycle too.
        raise Refusal(codes.CYCLE_WITH_COMPENSATION.at(line.span, code=rule.text, hint="program G40 before"))
    if rule.function in CYCLES:
        run_cycle(run, line, rule)
        return
    if rule.function in SYNCHRONISED and comp is not None:
        what = (
            f"{rule.text} during compensation (the manual does not say whether it follows the contour and the spindle)"
        )
        raise Refusal(codes.COMPENSATION_UNKNOWN.at(line.where_code(rule), cause=what, hint="program G40 before"))
    if rule.function is F.THREADING:
        run_threading(run, line, rule)
        return
    if rule.function not in SYNCHRONISED:
        set_motion(run, rule)
        if rule.function is not F.TRAVERSE:
            need_feed(run, line, rule)
    for axis, value in line.axes().items():
        if isinstance(value, Unknown):
            word = AXIS_NAMES[axis].upper()
            # Of a bounded value the position keeps the bounds, but not through a rotation.
            turned = axis < 2 and machine is None and run.modal.transform.on
            origin = ORIGIN if machine is not None else run.modal.offset(axis)
            named = machine is not None or run.modal.absolute
            if turned or not (value.bounded or (named and named_place(run, axis, value, origin))):
                run.findings.add(not_known(line.where(word), word, value))
    target = aim(run, line, machine=machine is not None)
    if rule.function in SYNCHRONISED:
        run_synchronised(run, line, rule, target)
    elif rule.function in (F.ARC_CW, F.ARC_CCW):
        _arc(run, line, rule, target)
    elif rule.function is F.PROBE:
        run_probe(run, line, rule, target)
    else:
        op = Op.TRAVERSE if rule.function is F.TRAVERSE else Op.FEED
        if comp is None:
            run.move(op, target, line.span)
        else:
            compensated.straight(run, line, op, target)
    run.moved = True


def set_motion(run: Run, rule: CodeRule) -> None:
    """The motion code that is in force from here."""
    if run.modal.motion != rule.function or rule.function is F.MOTION_CANCEL:
        run.modal.cycle, run.modal.cycle_code = {}, 0
    run.modal.motion = int(rule.function)


def _arc(run: Run, line: Line, rule: CodeRule, target: list[Position]) -> None:
    """Radius and centre format, 3.4.3.1 and 3.4.3.2."""
    s = run.modal
    first, second, _ = AXES_OF_PLANE[s.plane]
    names = [AXIS_NAMES[first].upper(), AXIS_NAMES[second].upper()]
    if first not in line.axes() and second not in line.axes():
        raise Refusal(
            codes.AXIS_WORDS_MISSING.at(line.span, code=f"{rule.text} in this plane, {names[0]} or {names[1]},")
        )
    one, two = _CENTER_WORDS[s.plane]
    radius = line.number("R")
    center_words = (line.number(one), line.number(two))
    if radius is None and center_words == (None, None):
        raise Refusal(codes.ARC_CENTER_MISSING.at(line.span, code=rule.text, needed=f"{one} or {two}, or R"))
    wrong = _OUT_OF_PLANE[s.plane]
    if wrong in line.values:
        raise Refusal(codes.UNUSED_WORD.at(line.where(wrong), word=f"{wrong} (out of the arc's plane)"))
    if radius is not None and center_words != (None, None):
        raise Refusal(codes.UNUSED_WORD.at(line.where("R"), word="R together with a centre"))
    if s.xz_view_open:
        cause = "the viewing side for arcs in the XZ plane"
        raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=cause, hint=compensated.VIEW_HINT))
    turns = 1 if (rule.function is F.ARC_CCW) != s.xz_mirrored else -1
    factor = check_arc(run, line)
    if s.compensation is not None and s.compensation.radius is None:
        compensated.straight(run, line, Op.FEED, target)
        return
    start = [s.programmed(first), s.programmed(second)]
    end = [target[first], target[second]]
    for a, b, name in zip(start, end, names, strict=True):
        difference = b.minus(a)
        if difference.form:
            raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=f"{name}: {describe(difference.form)}"))
    if radius is not None:
        entry = compensated.entry_center(run, line, target, radius * s.unit * factor, turns)
        center = entry or _radius_center(run, line, start, end, radius * s.unit * factor, turns > 0)
    elif run.machine.controller.absolute_arc_centers:
        center = _absolute_center(run, line, center_words, (first, second), start)
    else:
        i, j = (0.0 if v is None else v * s.unit for v in center_words)
        if s.transform.on:
            i, j = s.transform.step(i, j)
        center = [start[0].value + i, start[1].value + j]
    if all(abs(a.value - b.value) < 1e-6 for a, b in zip(start, end, strict=True)):
        target[first], target[second] = start
    whole = [p.value for p in s.position[:3]]
    whole[first], whole[second] = center
    if math.hypot(center[0] - start[0].value, center[1] - start[1].value) < 1e-9:
        raise Refusal(codes.ARC_RADIUS_ZERO.at(line.span))
    if s.compensation is None:
        run.move(Op.ARC, target, line.span, center=whole, turns=turns, plane=s.plane)
    else:
        compensated.circular(run, line, target, whole, turns)


def _radius_center(
    run: Run, line: Line, start: list[Position], end: list[Position], radius: float, ccw: bool
) -> list[float]:
    # Counter-clockwise is meant in a right-handed pair; XZ is listed as (X, Z), its pair is (Z, X).
    flip = run.modal.plane is Plane.XZ
    a, b = (1, 0) if flip else (0, 1)
    x, y, bad = k.radius_center(start[a].value, start[b].value, end[a].value, end[b].value, radius, int(ccw))
    chord = math.hypot(end[0].value - start[0].value, end[1].value - start[1].value)
    if bad == k.RADIUS_ZERO:
        raise Refusal(codes.ARC_RADIUS_ZERO.at(line.where("R")))
    if bad == k.RADIUS_SAME_POINT:
        raise Refusal(codes.ARC_SAME_POINT.at(line.span))
    if bad == k.RADIUS_UNREACHABLE:
        raise Refusal(codes.ARC_UNREACHABLE.at(line.where("R"), chord=chord, radius=abs(radius), unit="mm"))
    warning = radius_arc_warning(line.span, chord, radius, run.modal.unit != 1.0)
    if warning is not None:
        run.findings.add(warning)
    return [y, x] if flip else [x, y]


def _absolute_center(
    run: Run,
    line: Line,
    words: tuple[float | None, float | None],
    axes: tuple[int, int],
    start: list[Position],
) -> list[float]:
    center = []
    if None in words:
        raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause="a missing centre word with absolute centres on"))
    if run.machine.controller.diameter_programming and axes[0] == 0 and words[0]:
        raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause="an absolute centre I with diameter programming"))
    s = run.modal
    i, j = (0.0 if word is None else word * s.scale(axis) for word, axis in zip(words, axes, strict=True))
    offset = s.offset(axes[0]), s.offset(axes[1])
    places = offset[0].moved(i), offset[1].moved(j)
    if s.transform.on:
        places = s.transform.absolute((i, j), (start[0], start[1]), offset)
    for place, at in zip(places, start, strict=True):
        if place.form != at.form:
            raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=describe(place.minus(at).form)))
        center.append(place.value)
    return center
