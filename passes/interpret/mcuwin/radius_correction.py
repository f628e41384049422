"""Tool radius correction of controllers of DIN blocks with Pascal inside: G40, G41, G42, and moves next to a contour.

APCI-8001 G-code manual 2.7, 3.14 to 3.16, 5.5, 14 (2.5.3.89, .100). Entry, exit and corners are not described. So the
centre of the tool is known within an envelope of the contour that holds what the usual strategies do: in the axes of
the plane a place is that of the contour plus an unknown of four tool radii each way (docs/trace.md). Where strategies
differ by more, GP256.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.mcuwin.settings import USUAL, VERSIONS
from gproof.ir.finding import Refusal
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.setup import Interval
from gproof.ir.symbolic import BESIDE, NOWHERE, Position
from gproof.ir.trace import Op, Plane
from gproof.passes.interpret.mcuwin.contour import REACH, Element, judge
from gproof.passes.interpret.mcuwin.correction import Corner, Correction
from gproof.passes.interpret.mcuwin.state import SAME, McuWinState, din_of, factor

if TYPE_CHECKING:
    from gproof.passes.interpret.mcuwin.parts import Part
    from gproof.passes.interpret.mcuwin.state import McuWinRun

_OWN = 512
"""Symbols of a job up to which each line has symbols of its own."""
_ROUNDING = 1e-6
"""mm."""
_SECTIONS = {Plane.XY: "xy", Plane.XZ: "zx", Plane.YZ: "yz"}
TOLD = "a correction for nothing"
_RIGHT_HANDED = {Plane.XY: (0, 1), Plane.XZ: (2, 0), Plane.YZ: (1, 2)}


def correction(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G40 to G42: radius correction with a record of the tool table (2.7)."""
    s = run.modal
    if rule.function is F.COMPENSATION_OFF:
        # The tool comes back to the contour with the next move.
        left = s.own.corrected
        s.own = s.own.but(side=0, idle=0, corrected=None if left is None else replace(left, last=None, at=None))
        return
    tools = din_of(run.machine).tools
    if tools is not None and not tools and "tool_file" in din_of(run.machine).unstated:
        hint = 'name the tool table in tool_file under [din] of the machine file; "" means switched off'
        cause = f"{rule.text}: the tool table, which is unknown"
        raise Refusal(codes.COMPENSATION_UNKNOWN.at(line.code_span(), cause=cause, hint=hint))
    if tools is not None and not tools:
        hint = "load a tool table with contents (2.7)"
        raise Refusal(
            codes.NOT_ENABLED.at(line.code_span(), code=rule.text, device="tools", key="tool_file", hint=hint)
        )
    correct(run, line, 1 if rule.function is F.COMPENSATION_LEFT else -1)


def note_no_table(run: McuWinRun) -> None:
    """That no tool table is loaded is assumed where the setup does not give one (2.7)."""
    din = din_of(run.machine)
    if din.tools is not None and "tool_file" in din.unstated:
        run.assumed[USUAL["tool_file"]] = None


def note_record(run: McuWinRun) -> None:
    """The record that counts before the first T is assumed where the setup does not give it."""
    if not run.modal.own.chosen and run.setup.tool is None and run.setup.default_offset is None:
        run.assumed["record 0 of the tool table is active at the start, as after power-on (5.5)"] = None


def is_for_nothing(din: McuWinState) -> bool:
    """Whether a correction is on by record 0, without a radius, which no T has chosen: GP258 at its first move."""
    return bool(din.idle) and din.tool == 0 and not din.chosen and TOLD not in din.told


def tell_for_nothing(run: McuWinRun, line: Part) -> None:
    """GP258, once: the tool that is really there goes along the contour with its middle (2.7, 5.5)."""
    s = run.modal
    if is_for_nothing(s.own):
        s.own = s.own.but(told=s.own.told | {TOLD})
        hint = "program T for another record: record 0 is active after power-on (5.5)"
        run.findings.add(codes.COMPENSATION_WITHOUT_TOOL.at(line.span, hint=hint))


def correct(run: McuWinRun, line: Part, side: int) -> None:
    """The tool moves next to the contour from here, as far as its record has a radius in the plane."""
    s = run.modal
    note_record(run)
    section = _SECTIONS[s.plane]
    found = [t for t in din_of(run.machine).tools or () if t.number == s.own.tool and t.plane == section]
    if found and all(t.radius == 0.0 for t in found) and not s.own.plane_open:
        s.own = s.own.but(side=0, idle=side)
        return
    now = s.own.corrected
    if now is not None and now.side == side == s.own.side:
        return
    crossing = now is not None and now.side != side and (s.own.side or any(is_beside(place) for place in s.position))
    s.own = s.own.but(side=side, idle=0, corrected=None)
    radius = found[0].radius if len(found) == 1 else None
    code = "G41" if side > 0 else "G42"
    cause = ""
    if radius is None or radius < 0.0 or s.own.plane_open:
        cause = f"{code}: the tool radius, which is unknown"
    elif crossing:
        cause = f"{code} before the tool is back from the other side"
    elif s.plane is not Plane.XY and din_of(run.machine).version != VERSIONS[0]:
        cause = f"{code} outside the X-Y plane, which this version does not do well (14 (2.5.3.100))"
    elif not all(s.linear[axis] for axis in _RIGHT_HANDED[s.plane]):
        cause = f"{code} in a plane whose axes turn"
    if cause:
        run.fail(codes.COMPENSATION_UNKNOWN.at(line.code_span(), cause=cause))
        return
    assert radius is not None
    name = f"{s.own.tool}{section}{'+' if side > 0 else '-'}{radius!r}".replace(".", ",")
    s.own = s.own.but(corrected=Correction(side=side, radius=radius, name=name))
    run.assumed[
        f"the tool centre stays within {REACH:g} tool radii of its contour: the manual does "
        "not describe entry, exit and corners (2.7)"
    ] = None


def unfollowed(run: McuWinRun, line: Part, code: str) -> None:
    """GP256 for what happens while a correction is on: it is not known on which side, or from where, it goes on."""
    s = run.modal
    if s.own.side:
        s.own = s.own.but(corrected=None)
        run.fail(codes.COMPENSATION_UNKNOWN.at(line.code_span(), cause=f"{code} while the tool radius is corrected"))


def is_beside(place: Position) -> bool:
    """Whether a place rests on where a corrected tool is next to its contour."""
    return any(symbol.startswith(BESIDE) for symbol, _ in place.form)


def contour_place(place: Position) -> Position:
    """The place of the contour, of one next to it."""
    return Position(place.value, tuple(term for term in place.form if not term[0].startswith(BESIDE)))


def follow(run: McuWinRun, target: list[Position], own: str = "") -> list[Position]:
    """The ends of a move next to the contour: those of the plane anywhere around it. own: see ``Correction``."""
    s = run.modal
    axes = _RIGHT_HANDED[s.plane]
    now = s.own.corrected
    if now is None:
        return [NOWHERE if axis in axes else place for axis, place in enumerate(target)]
    return [_around(run, now, axis, place, own) if axis in axes else place for axis, place in enumerate(target)]


def _around(run: McuWinRun, now: Correction, axis: int, place: Position, own: str) -> Position:
    symbol = f"{BESIDE}{now.name}{own}.{AXIS_NAMES[axis]}"
    # The same one for both ends of a line, without one of its own for each place: a row then has the envelope around
    # its whole path.
    off = REACH * now.radius + run.modal.arc_tolerance()
    run.trace.symbols.setdefault(symbol, Interval(-off, off))
    return contour_place(place).plus(Position(0.0, ((symbol, 1),)))


def _own_symbols(run: McuWinRun) -> str:
    """What tells the symbols of the next line from those of others; "" once there are many."""
    if len(run.trace.symbols) >= _OWN:
        return ""
    run.unknowns += 1
    return f"#{run.unknowns}"


def _narrow(run: McuWinRun, now: Correction, new: Element) -> Corner | None:
    """Where the tool may be around the corner of two lines; the symbols of the first one hold no more than it needs.

    Round, cut or mitred, inside or outside: the path around a corner is within the triangle of where those next to
    its lines end and meet. None: the corner is not between two lines.
    """
    last = now.last
    if last is None or last.center is not None or new.center is not None:
        return None
    (ax, ay), (bx, by) = last.direction(at_end=True), new.direction(at_end=False)
    beside = now.side * now.radius
    one, other = (-ay * beside, ax * beside), (-by * beside, bx * beside)
    whole = 1.0 + ax * bx + ay * by
    mitre = (one[0] + other[0]) / whole, (one[1] + other[1]) / whole
    points = (one, other, mitre)
    corner = tuple((min(p[k] for p in points), max(p[k] for p in points)) for k in (0, 1))
    if now.own and now.begin is not None and now.forks == run.branches:
        wide = run.modal.arc_tolerance() + _ROUNDING
        for axis, begin, end in zip(_RIGHT_HANDED[run.modal.plane], now.begin, corner, strict=True):
            symbol = f"{BESIDE}{now.name}{now.own}.{AXIS_NAMES[axis]}"
            run.trace.symbols[symbol] = Interval(min(begin[0], end[0]) - wide, max(begin[1], end[1]) + wide)
    return corner[0], corner[1]


def no_arc(run: McuWinRun, line: Part) -> None:
    """Refusal GP256 for an arc on which the tool would come to the contour or leave it."""
    s = run.modal
    now = s.own.corrected
    places = [s.position[axis] for axis in _RIGHT_HANDED[s.plane]]
    if s.own.side and now is not None:
        begins = f"{BESIDE}{now.name}"
        if all(any(symbol.startswith((f"{begins}.", f"{begins}#")) for symbol, _ in place.form) for place in places):
            return
        cause = "an arc as the first move of a correction, which is not in the manual (2.7)"
    elif not any(is_beside(place) for place in places):
        return
    else:
        cause = "an arc on which the tool leaves the contour, which is not in the manual (2.7)"
    raise Refusal(codes.COMPENSATION_UNKNOWN.at(line.span, cause=cause, hint="program a straight line before"))


def before(
    run: McuWinRun, op: Op, line: Part, target: list[Position], center: list[float] | None = None, turns: int = 0
) -> None:  # fmt: skip
    """Rows before a move next to the contour: to the envelope at the start, anywhere at corners nobody can bound."""
    s = run.modal
    now = s.own.corrected
    if not s.own.side or now is None:
        return
    row = Op.TRAVERSE if op is Op.TRAVERSE else Op.FEED
    u, v = _RIGHT_HANDED[s.plane]
    here = contour_place(s.position[u]), contour_place(s.position[v])
    there = contour_place(target[u]), contour_place(target[v])
    problem, own = "", ""
    begin: Corner | None = None
    forks = run.branches
    reflected = [axis for axis in (u, v) if axis in s.own.reflected]
    ways = [b.minus(a) for a, b in zip(here, there, strict=True)]
    new: Element | None = None
    if any(way.form for way in ways):
        problem = "the direction of a move, which is unknown"
    elif any(abs(factor(s, axis)) != 1.0 for axis in reflected):
        problem = "whether a factor of G39 changes the radius as well"
    elif now.at is not None and now.at != here:
        problem = "where the contour goes on, which is unknown"
    elif op is Op.ARC or any(abs(way.value) >= SAME for way in ways):
        middle = None if center is None or op is not Op.ARC else (center[u], center[v])
        new = Element((here[0].value, here[1].value), (there[0].value, there[1].value), middle, turns)
        # Seen from which side, and whether a mirror image has its tool on the other side, is open.
        sides = (1, -1) if reflected or s.plane is not Plane.XY else (now.side,)
        problem, new = judge(now.last, new, sides, now.radius)
        if not problem and len(sides) == 1:
            begin = _narrow(run, now, new)
            own = _own_symbols(run) if new.center is None else ""
    else:
        new, own, begin, forks = now.last, now.own, now.begin, now.forks
    start = follow(run, s.position, own)
    if start != s.position:
        run.move(row, start, line.span)
    target[:] = follow(run, target, own)
    if problem:
        what = f"{problem} (radius {now.radius:g}, 2.7)" if "radius" not in problem else f"{problem} (2.7)"
        run.fail(codes.COMPENSATION_UNKNOWN.at(line.span, cause=what))
        lost = [NOWHERE if axis in (u, v) else place for axis, place in enumerate(s.position)]
        run.move(row, lost, line.span)
        run.move(row, start, line.span)
        new = None
    s.own = s.own.but(
        corrected=replace(now, last=new, at=None if new is None else there, own=own, begin=begin, forks=forks)
    )
