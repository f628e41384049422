"""What a picture of a job shows: the path in one frame, where its findings are, where an unknown work zero may be."""

from __future__ import annotations

import math

import numpy as np

from gproof.driver.judge import Judgement
from gproof.driver.session import Session
from gproof.ir.codes import SOFT_LIMIT
from gproof.ir.finding import Finding, Severity
from gproof.ir.machine import Machine
from gproof.ir.record import record
from gproof.ir.trace import Affine
from gproof.report.picture.path_points import Forms, PathPoints, Points
from gproof.report.picture.relief import Relief, relief_of
from gproof.report.workpieces import Drawn, drawn
from gproof.report.zones import entry, placed

WEIGHT = {Severity.ERROR: "#d50000", Severity.UNKNOWN: "#8e24aa"}
"""Findings that a picture shows, and their colours."""
_MOST_MARKS = 60
_SLACK = 1e-3  # mm; points are single precision

Pair = tuple[float, float]


@record(frozen=True, slots=True, kw_only=True)
class Mark:
    """Where a finding is: the moves to paint (indices of their ends), the place of its ring, what to write there."""

    moves: np.ndarray
    at: tuple[float, float, float]
    text: str
    colour: str


@record(frozen=True, slots=True, kw_only=True)
class Scene:
    """What there is to draw, in the frame that most of the cut is in.

    joined: (n,) the move to point i can be drawn; shift: by axis, mm to add for machine coordinates (None: not
    known, 0: they are); zero: by axis, where the unknown work zero may be; tools: how many cut; bodies: stock,
    part and fixtures; reliefs: what is left of stock.
    """

    points: Points
    joined: np.ndarray
    forms: Forms
    shift: tuple[float | None, float | None, float | None]
    zero: tuple[Pair | None, Pair | None, Pair | None]
    plunges: tuple[tuple[float, float, float], ...]
    marks: tuple[Mark, ...]
    tools: int
    bodies: tuple[Drawn, ...]
    reliefs: tuple[Relief, ...]
    low: np.ndarray
    high: np.ndarray


def scene_of(path: PathPoints, session: Session, judgement: Judgement) -> Scene:
    """The scene of a path; the frame that most of the cut is in decides."""
    points = path.points()
    forms: list[Forms] = list(path.forms) or [((), (), ())]
    cutting = points.frame[points.feed] if points.feed.any() else points.frame
    frame = int(np.bincount(cutting).argmax()) if len(cutting) else 0
    here = points.frame == frame
    joined = here.copy()
    joined[1:] &= here[:-1]
    joined[:1] = False
    zero = [_zero(judgement, form) if form else None for form in forms[frame]]
    shift = [(0.0 if not form else None if z is None else (z[0] + z[1]) / 2)
             for form, z in zip(forms[frame], zero, strict=True)]  # fmt: skip
    known = not any(forms[frame])
    marks = _marks(points, joined, path, session if known else None, judgement) if path.trace else []
    shown = points.at[here & points.feed] if (here & points.feed).any() else points.at[here]
    shown = np.concatenate([shown.astype(float), np.array([m.at for m in marks]).reshape(-1, 3)])
    bodies = drawn(session, forms[frame], next(iter(path.tips), None))
    corners = [c for b in bodies if b.role != "fixtures" for c in (b.low, b.high) if not math.isnan(c[2])]
    shown = np.concatenate([shown, np.array(corners).reshape(-1, 3)])
    if not len(shown):
        shown = np.zeros((1, 3))
    return Scene(
        points=points, joined=joined, forms=forms[frame], shift=(shift[0], shift[1], shift[2]),
        zero=(zero[0], zero[1], zero[2]), marks=tuple(marks), tools=len(path.tools), bodies=tuple(bodies),
        reliefs=_reliefs(judgement, bodies),
        low=shown.min(axis=0), high=shown.max(axis=0),
        plunges=tuple((x, y, d) for (x, y, f), d in path.plunges.items() if f == frame),
    )  # fmt: skip


def _reliefs(judgement: Judgement, bodies: list[Drawn]) -> tuple[Relief, ...]:
    """What is left of the bodies of stock that the picture has."""
    stock = {body.number: body for body in bodies if body.role == "stock"}
    found = []
    for left in judgement.summary.remains:
        if left.body in stock:
            low = stock[left.body].low
            found.append(relief_of(left, low[0] - float(left.grid[0]), low[1] - float(left.grid[1])))
    return tuple(found)


def _zero(judgement: Judgement, form: Affine) -> Pair | None:
    """Where the sum of unknown offsets may be, by the conditions of the verdict."""
    for result in judgement.properties:
        for c in result.conditions:
            if c.terms == form and math.isfinite(c.low) and math.isfinite(c.high):
                return c.low, c.high
    return None


def _marks(
    points: Points, joined: np.ndarray, path: PathPoints, session: Session | None, judgement: Judgement
) -> list[Mark]:
    """Marks of errors and unknowns whose line moves; several on one line share a mark."""
    assert path.trace is not None
    out: list[Mark] = []
    seen: set[tuple[str, int]] = set()
    files = {name: i for i, name in enumerate(path.trace.files)}
    beyond = _beyond(points.at, None if session is None else session.machine)
    for f in sorted((f for f in judgement.findings.kept if f.severity in WEIGHT), key=by_weight):
        place = f.span.file, f.span.line
        if place in seen or len(out) >= _MOST_MARKS:
            continue
        seen.add(place)
        moves = np.flatnonzero(joined & (points.line == f.span.line) & (points.file == files.get(f.span.file, -1)))
        if not len(moves):
            continue
        outside = moves[beyond[moves] > _SLACK]
        at = points.at[moves[-1]].astype(float)
        if len(outside):
            moves, at = outside, points.at[outside[np.argmax(beyond[outside])]].astype(float)
        elif f.code.decides == "areas" and session is not None:
            at = _entry(points, moves, session, at)
        out.append(Mark(moves=moves, at=(at[0], at[1], at[2]), text=f"{f.code.label} line {f.span.line}",
                         colour=WEIGHT[f.severity]))  # fmt: skip
    outside = np.flatnonzero(joined & (beyond > _SLACK))
    if judgement.findings.hidden(SOFT_LIMIT) and len(outside):
        # Findings are listed up to a number; the drawing shows all that is outside.
        at = points.at[outside[np.argmax(beyond[outside])]].tolist()
        colour = WEIGHT[Severity.ERROR]
        out.insert(0, Mark(moves=outside, at=(at[0], at[1], at[2]), text="GP301 at its worst", colour=colour))
    return out


def by_weight(finding: Finding) -> tuple[bool, int]:
    """Errors first, then by line."""
    return finding.severity is not Severity.ERROR, finding.span.line


def _beyond(at: np.ndarray, machine: Machine | None) -> np.ndarray:
    """(n,): mm by which a point is outside the soft limits, 0 or less inside."""
    out = np.zeros(len(at))
    for axis in machine.axes if machine is not None else ():
        if axis.index < 3 and axis.lower is not None:
            out = np.maximum(out, axis.lower - at[:, axis.index])
        if axis.index < 3 and axis.upper is not None:
            out = np.maximum(out, at[:, axis.index] - axis.upper)
    return out


def _entry(points: Points, moves: np.ndarray, session: Session, default: np.ndarray) -> np.ndarray:
    """About where a move enters the tool change area, or a tool a keep-out zone."""
    change = session.machine.tool_change_area
    at = points.at
    found = None if change is None else entry(at, moves, (change,), 0.0)
    if found is None:
        radius = float(points.diameter[moves].max()) / 2
        found = entry(at, moves, placed(session), radius)
    return default if found is None else found
