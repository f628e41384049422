"""Cutter radius compensation in execution: G40 to G42.1, compensated moves as rows, what is refused meanwhile.

The geometry is in ``passes/interpret/core/cutter_compensation.py``. Eding CNC manual 4.01: 3.4.11, 3.1.2.1 (turning),
chapter 5; the numbers in brackets are those of the list of errors in 5.4.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Finding, Refusal, Span
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import Position, Unknown
from gproof.ir.symbols import describe
from gproof.ir.trace import UNKNOWN, Op, Plane
from gproof.passes.interpret.core import cutter_compensation as geometry
from gproof.passes.interpret.core.cutter_compensation import Compensation, Fault, Path, Piece, Point, Trouble
from gproof.passes.interpret.core.cutter_compensation_kernels import distance
from gproof.passes.interpret.core.moves import APART
from gproof.passes.interpret.core.parsed_line import Line

if TYPE_CHECKING:
    from gproof.passes.interpret.core.modal_state import Modal
    from gproof.passes.interpret.core.run import Run

NOSE = {1: (1, -1), 2: (-1, -1), 3: (-1, 1), 4: (1, 1), 5: (1, 0), 6: (0, -1), 7: (-1, 0), 8: (0, 1), 9: (0, 0)}
"""By orientation of a turning tool: from the centre of its nose to the controlled point, (Z, X), in radii.

The manual (3.1.2.1) states 2 and 9 in words and the others in a picture; these are LinuxCNC's, where 2 and 9 agree.
"""


"""Why it is not known where the contour goes on."""

VIEW_HINT = 'state xz_seen_from = "+y" or "-y" under [controller] in the machine file'


# -- on and off


def switch(run: Run, line: Line) -> None:
    """Step 13 of table 3-7. Refusal GP229, GP249, GP250, GP253, GP254 or GP108 where G41 or G42 may not be."""
    rule = line.find(F.COMPENSATION_OFF, F.COMPENSATION_LEFT, F.COMPENSATION_RIGHT)
    if rule is None:
        return
    s = run.modal
    if rule.function is F.COMPENSATION_OFF:
        if s.compensation is not None:
            s.compensation = None
            run.state_changed()
        return
    line.used.add("D")
    where = line.where_code(rule)
    if s.compensation is not None:
        hint = "end the contour with G40 before"
        raise Refusal(codes.COMPENSATION_ALREADY_ON.at(where, code=rule.text, hint=hint))
    if s.plane is Plane.YZ:
        raise Refusal(codes.COMPENSATION_PLANE.at(where, code=rule.text, plane="YZ", hint="program G17 before"))
    tool = None if rule.value else _table_entry(run, line)
    diameter = _given_diameter(run, line, rule) if rule.value else _tool_diameter(run, line, tool)
    side = 1 if rule.function is F.COMPENSATION_LEFT else -1
    radius = None
    if diameter is not None:
        # A negative diameter is compensated on the other side (5.3).
        side, radius = (-side if diameter < 0 else side), abs(diameter) / 2.0
    shift = (0.0, 0.0)
    if s.plane is Plane.XZ and radius != 0.0:
        view, nose = _view(run, where), _nose(run, where, tool, diameter)
        if view is None or nose is None or radius is None:
            radius = None
        else:
            side, shift = side * view, (nose[0] * radius, nose[1] * radius)
    s.compensation = Compensation(side=side, radius=radius, plane=s.plane, shift=shift)
    run.state_changed()


def _table_entry(run: Run, line: Line) -> int | None:
    """The D number, or without one the tool in the spindle; None: not known, and reported."""
    value = line.values.get("D")
    s = run.modal
    if value is None:
        if s.tool is None:
            hint = "program T and M6, state tool in the setup file, or program D"
            run.fail(codes.COMPENSATION_RADIUS_UNKNOWN.at(line.span, cause="the tool in the spindle", hint=hint))
        return s.tool
    where = line.where("D")
    if isinstance(value, Unknown):
        run.fail(codes.COMPENSATION_RADIUS_UNKNOWN.at(where, cause=value.cause))
        return None
    rules = run.program.rules
    number = line.whole("D", rules.integer_tolerance)
    assert number is not None
    if number < 0:
        raise Refusal(codes.COMPENSATION_TOOL_NEGATIVE.at(where, value=number, hint="end the compensation with G40"))
    if number > rules.highest_tool:
        raise Refusal(codes.COMPENSATION_TOOL_RANGE.at(where, value=number, highest=rules.highest_tool))
    return number


def _tool_diameter(run: Run, line: Line, tool: int | None) -> float | None:
    if tool is None:
        return None
    if tool == 0 and "D" not in line.values:
        run.findings.add(
            codes.COMPENSATION_WITHOUT_TOOL.at(line.span, hint="program D of another tool: tool 0 means no tool")
        )
    value = run.modal.tool_diameter(tool)
    if isinstance(value, Unknown):
        hint = "state it in the tool table of the machine file"
        run.fail(codes.COMPENSATION_RADIUS_UNKNOWN.at(line.where("D"), cause=value.cause, hint=hint))
        return None
    return value


def _given_diameter(run: Run, line: Line, rule: CodeRule) -> float | None:
    """G41.1 and G42.1: D is a diameter."""
    value = line.values.get("D")
    if value is None:
        raise Refusal(codes.MISSING_VALUE.at(line.where_code(rule), letter=f"{rule.text}: D, the diameter,"))
    if isinstance(value, Unknown):
        run.fail(codes.COMPENSATION_RADIUS_UNKNOWN.at(line.where("D"), cause=value.cause))
        return None
    return value * run.modal.unit


def _view(run: Run, where: Span) -> int | None:
    """1 where left in the XZ plane is left as seen from positive Y, -1 from negative Y; None: not known, reported."""
    view = run.machine.controller.xz_seen_from
    if view is None:
        cause = "the viewing side for arcs and sides in the XZ plane"
        run.fail(codes.COMPENSATION_LATHE_UNKNOWN.at(where, cause=cause, hint=VIEW_HINT))
        return None
    return -1 if view == "-y" else 1


def _nose(run: Run, where: Span, tool: int | None, diameter: float | None) -> tuple[int, int] | None:
    """The orientation's offset in radii; None: not known, and reported."""
    s = run.modal
    held = s.tool if s.tool is not None else tool
    used = held if tool is None else tool
    cause = "the tool in the spindle"
    if held is not None and used is not None:
        mine, its = s.tool_orientation(held), s.tool_orientation(used)
        nose = None if isinstance(mine, Unknown) else NOSE.get(round(mine))
        cause = f"the orientation of tool {held}"
        if nose is not None and mine == its and (nose == (0, 0) or diameter is None or diameter >= 0):
            return nose
        if nose is not None:
            cause = (
                "two tools with different orientations" if mine != its else "a negative diameter with an orientation"
            )
    hint = "state it (1 to 9) in the tool table of the machine file"
    run.fail(codes.COMPENSATION_LATHE_UNKNOWN.at(where, cause=cause, hint=hint))
    return None


# -- what is refused while it is on


def keep_plane(modal: Modal, plane: Plane, line: Line, rule: CodeRule) -> None:
    """Refusal GP252 for another plane [8, 9]."""
    comp = modal.compensation
    if comp is not None and comp.plane is not plane:
        raise Refusal(codes.PLANE_WITH_COMPENSATION.at(line.where_code(rule), code=rule.text, plane=comp.plane.name))


def keep_units(modal: Modal, line: Line, rule: CodeRule) -> None:
    """Refusal GP247 for a choice of units [2]."""
    if modal.compensation is not None:
        raise Refusal(codes.UNITS_WITH_COMPENSATION.at(line.where_code(rule), code=rule.text))


def keep_offsets(modal: Modal, line: Line, rule: CodeRule) -> None:
    """Refusal GP246 for a code that moves the origin [1]."""
    if modal.compensation is not None:
        raise Refusal(codes.OFFSETS_WITH_COMPENSATION.at(line.where_code(rule), code=rule.text))


def keep_tool_and_head(comp: Compensation | None, before: list[Position], modal: Modal, line: Line) -> None:
    """Refusal GP246 where the offset of tool or head changed along a compensated axis [1]; the others: at the line."""
    if comp is None or modal.compensation is None:
        return
    changed = [AXIS_NAMES[a].upper() for a in comp.axes if before[a] != modal.beside_work(a)]
    if changed:
        what = f"an offset of tool or head in {' and '.join(changed)}"
        raise Refusal(codes.OFFSETS_WITH_COMPENSATION.at(line.span, code=what))


def no_parking(modal: Modal, line: Line, rule: CodeRule) -> None:
    """Refusal GP251 for G28 and G30 [6]."""
    if modal.compensation is not None:
        raise Refusal(codes.PARK_WITH_COMPENSATION.at(line.where_code(rule), code=rule.text, hint="program G40 before"))


def no_probing(modal: Modal, line: Line, rule: CodeRule) -> None:
    """Refusal GP248 for a probing move [3]."""
    if modal.compensation is not None:
        where = line.where_code(rule) if rule in line.rules else line.span
        raise Refusal(codes.PROBE_WITH_COMPENSATION.at(where, code=rule.text, hint="program G40 before"))


# -- moves


def is_plain(modal: Modal) -> bool:
    """True in the middle of a contour, where the tool touches it and all is known: the moves of ``offset_rows``."""
    comp = modal.compensation
    if comp is None or comp.programmed is None or not comp.radius or not comp.placed or comp.plane is not modal.plane:
        return False
    there = tuple(modal.position[axis] for axis in comp.axes)
    if comp.left is not None and comp.left != there:
        return False
    return all(p.form == q.form for p, q in zip(there, comp.programmed, strict=True))


def straight(run: Run, line: Line, op: Op, target: list[Position]) -> None:
    """A straight move to the programmed target, compensated. A corner before it is rounded at its height."""
    comp = run.modal.compensation
    assert comp is not None
    known = _known(run, line, comp, target)
    if known is None:
        _anywhere(run, line, op, comp, target)
        return
    tool, start, end, placed = known
    radius = comp.radius or 0.0
    if comp.programmed is None and radius:
        path = geometry.entry_line(tool, end, comp.side, radius)
    elif radius:
        path = geometry.line(tool, start, end, comp.side, radius, placed)
    else:
        path = [Piece(end)], None
    _follow(run, line, op, comp, target, tool, path, 0.0)


def entry_center(run: Run, line: Line, target: list[Position], radius: float, sense: int) -> list[float] | None:
    """The centre of a first move given by its radius, (first, second) axis of the plane; None: an ordinary arc.

    Refusal with the fault when there is no such arc.
    """
    comp = run.modal.compensation
    if comp is None or comp.programmed is not None or not comp.radius:
        return None
    known = _known(run, line, comp, target)
    if known is None:
        return None
    tool, _, end, _ = known
    center = geometry.entry_arc_center(tool, end, radius, sense, comp.side, comp.radius)
    if isinstance(center, Fault):
        raise Refusal(_finding(line.span, center, comp.radius))
    # The pair of XZ is (Z, X); the caller's order is the order of the letters.
    return [center[1], center[0]] if comp.plane is Plane.XZ else [center[0], center[1]]


def circular(run: Run, line: Line, target: list[Position], center: list[float], sense: int) -> None:
    """An arc to the programmed target, compensated. center: machine X, Y, Z; sense: +1 counter-clockwise."""
    comp = run.modal.compensation
    assert comp is not None
    known = _known(run, line, comp, target)
    if known is None:
        _anywhere(run, line, Op.FEED, comp, target)
        return
    tool, start, end, placed = known
    u, v = comp.axes
    about = center[u], center[v]
    radius = comp.radius or 0.0
    tolerance = run.modal.arc_tolerance()
    off = abs(distance(*start, *about) - distance(*end, *about))
    entry = comp.programmed is None and radius > 0.0
    if not entry and off > tolerance:
        raise Refusal(
            codes.ARC_RADIUS_MISMATCH.at(
                line.span, start=math.dist(start, about), end=math.dist(end, about), off=off, unit="mm",
                allowed=tolerance,
            )
        )  # fmt: skip
    path: Path
    if entry:
        path = geometry.entry_arc(tool, end, about, sense, comp.side, radius, tolerance)
    elif radius:
        path = geometry.arc(tool, start, end, about, sense, comp.side, radius, placed, tolerance)
    else:
        path = [Piece(end, about, sense)], None
    _follow(run, line, Op.FEED, comp, target, tool, path, center[3 - u - v])


def _known(run: Run, line: Line, comp: Compensation, target: list[Position]) -> tuple[Point, Point, Point, bool] | None:
    """Tool, programmed start and end as numbers in the pair, whether the tool touches the start.

    Positions may rest on unknown offsets, as long as they are the same ones. None: not known, and reported.
    """
    if comp.radius is None:
        return None
    s = run.modal
    a, b = comp.axes
    if comp.left is not None and comp.left != (s.position[a], s.position[b]):
        run.fail(codes.COMPENSATION_UNKNOWN.at(line.span, cause=APART, hint="program G40 before"))
        return None
    start = comp.programmed or (s.position[a], s.position[b])
    for axis, at in zip(comp.axes, start, strict=True):
        difference = target[axis].minus(at)
        if difference.form:
            if difference.form != UNKNOWN:
                cause = f"{AXIS_NAMES[axis].upper()}: {describe(difference.form)}"
                run.fail(codes.COMPENSATION_UNKNOWN.at(line.span, cause=cause))
            return None
    there = s.position[a], s.position[b]
    placed = comp.placed and all(p.form == q.form for p, q in zip(there, start, strict=True))
    tool = there[0].value - comp.shift[0], there[1].value - comp.shift[1]
    if comp.programmed is not None and not placed:
        tool = start[0].value, start[1].value
    return tool, (start[0].value, start[1].value), (target[a].value, target[b].value), placed


def _anywhere(run: Run, line: Line, op: Op, comp: Compensation, target: list[Position]) -> None:
    """A move whose end in the plane is not known."""
    a, b = comp.axes
    goal = target[a], target[b]
    to = list(target)
    if goal != (run.modal.programmed(a), run.modal.programmed(b)) or comp.programmed is None:
        to[a], to[b] = Position(goal[0].value, UNKNOWN), Position(goal[1].value, UNKNOWN)
    else:
        to[a], to[b] = run.modal.position[a], run.modal.position[b]
    run.modal.compensation = comp.at(*goal, placed=False)
    run.move(op, to, line.span, programmed=(goal[0].value, goal[1].value))
    _leave(run.modal)


def _follow(
    run: Run, line: Line, op: Op, comp: Compensation, target: list[Position], tool: Point, path: Path, level: float
) -> None:
    """The pieces as rows; level: coordinate of arcs' centres across the plane."""
    s = run.modal
    pieces, fault = path
    if fault is not None:
        assert comp.radius is not None
        run.fail(_finding(line.span, fault, comp.radius))
    a, b = comp.axes
    goal = target[a], target[b]
    corner = s.programmed(a).value, s.programmed(b).value
    across = 3 - a - b
    rise = target[across].minus(s.position[across]).value
    length = geometry.path_length(tool, pieces, rise)
    # A move across the plane alone brings no tool onto the contour.
    s.compensation = comp.at(*goal, placed=comp.placed or pieces[-1].end != tool)
    at = tool
    for k, piece in enumerate(pieces):
        last = k == len(pieces) - 1
        to = list(target) if last else list(s.position)
        if piece.end == at and comp.radius:
            to[a], to[b] = s.position[a], s.position[b]
        else:
            to[a] = Position(piece.end[0] + comp.shift[0], goal[0].form)
            to[b] = Position(piece.end[1] + comp.shift[1], goal[1].form)
        center = None
        if piece.center is not None:
            center = [0.0, 0.0, 0.0]
            center[a], center[b] = piece.center[0] + comp.shift[0], piece.center[1] + comp.shift[1]
            center[across] = level if last and op is not Op.TRAVERSE else s.position[across].value
        run.move(
            op if center is None else Op.ARC, to, line.span, center=center, turns=piece.turns,
            plane=comp.plane if center is not None else 0, length=math.nan if op is Op.TRAVERSE else length,
            programmed=(goal[0].value, goal[1].value) if last else corner,
        )  # fmt: skip
        at = piece.end
    _leave(s)


def _leave(modal: Modal) -> None:
    """Remember where the axes are: what moves them before the next line of the contour is found out."""
    comp = modal.compensation
    assert comp is not None
    modal.compensation = replace(comp, left=(modal.position[comp.axes[0]], modal.position[comp.axes[1]]))


def _finding(span: Span, fault: Fault, radius: float) -> Finding:
    match fault.trouble:
        case Trouble.CONCAVE_CORNER:
            hint = f"program an arc larger than {radius:.3f} mm in it, or use the other side of the contour"
            return codes.CONCAVE_CORNER.at(span, degrees=fault.number, radius=radius, hint=hint)
        case Trouble.GOUGING:
            hint = "make the first move in the plane and longer than the tool radius"
            return codes.CUTTER_GOUGING.at(span, distance=fault.number, radius=radius, hint=hint)
        case Trouble.ARC_TOO_SMALL:
            hint = "use a smaller tool or a larger arc"
            return codes.ARC_TOO_SMALL_FOR_TOOL.at(span, arc=fault.number, radius=radius, hint=hint)
    hint = "start with a straight move"
    return codes.ENTRY_ARC.at(span, distance=fault.number, needed=fault.other, hint=hint)
