"""Moves near zones whose places depend on unknown offsets: collected while a job streams by, then regions of offsets.

A coordinate is a number, a sum of unknown offsets (``Affine``), and what is only bounded: a tool length that was
stated as a range, a probe contact. Offsets are told apart by their sums: all moves that rest on the same three sums, or
on some of them, are one group, whose region says where those sums may be. What else a move depends on is taken
at all its values; where it has no bounds, the move may be anywhere.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from gproof.ir.record import field, record
from gproof.ir.symbolic import add_forms
from gproof.ir.trace import UNKNOWN, Affine, Chunk, Op, Plane
from gproof.passes.checks.zones.offset_boxes import Box, boxes_of
from gproof.passes.checks.zones.offset_regions import (
    MOST,
    Blocked,
    Floats,
    Move,
    Pair,
    Region,
    Solid,
    around_arc,
    around_box,
    joined,
    meets,
    straight,
    together,
)

Triple = tuple[Affine, Affine, Affine]
Ranges = dict[Affine, Pair]
Resolve = Callable[[Affine], tuple[Affine, Pair]]
"""The part of a sum that is open, and the bounds of the rest."""

Resolved = dict[int, list[tuple[Affine, Pair]]]
NOT_MOVED = -1

IN_PLANE = {Plane.XY: (0, 1), Plane.XZ: (2, 0), Plane.YZ: (1, 2)}
"""The right-handed pair of each plane."""


@record(frozen=True, slots=True, kw_only=True)
class Stand:
    """A zone as rows of some states are judged: positions less shift and form against the solid.

    name: of the zone; sure: what enters the solid enters the zone for certain.
    """

    name: str
    solid: Solid
    shift: tuple[float, float, float] = (0.0, 0.0, 0.0)
    form: Triple = ((), (), ())
    sure: bool = True


@record(frozen=True, slots=True, kw_only=True)
class Place:
    """Where sums of offsets may be together, so that the path keeps out of zones. terms: of X, Y, Z, () for none."""

    terms: Triple
    region: Region
    boxes: tuple[Box, ...]
    zones: tuple[str, ...]


@record(slots=True)
class _Rows:
    """Rows near one ``Stand``, as columns; frames: of starts and ends, as indices of all forms met."""

    start: list[Floats] = field(default_factory=list)
    end: list[Floats] = field(default_factory=list)
    center: list[Floats] = field(default_factory=list)
    turns: list[npt.NDArray[np.int64]] = field(default_factory=list)
    plane: list[npt.NDArray[np.int64]] = field(default_factory=list)
    frames: list[npt.NDArray[np.int64]] = field(default_factory=list)
    free: list[npt.NDArray[np.bool_]] = field(default_factory=list)


class OpenZones:
    """Collects rows (``add``); ``places`` says where offsets may be."""

    def __init__(self) -> None:
        self._rows: dict[int, tuple[Stand, _Rows]] = {}
        self._forms: dict[Triple, int] = {}

    def add(self, chunk: Chunk, stand: Stand, mine: npt.NDArray[np.bool_], *, is_straight: bool | None = True) -> None:
        """Rows of a chunk near ``stand``. mine: (n,); is_straight: if traverses are straight lines, None: open."""
        rows = chunk.rows
        if not mine.any():
            return
        numbers = np.array([self._forms.setdefault(frame[:3], len(self._forms)) for frame in chunk.trace.frames])
        _, kept = self._rows.setdefault(id(stand), (stand, _Rows()))
        kept.start.append(chunk.starts()[mine, :3])
        kept.end.append(rows["to"][mine, :3])
        kept.center.append(rows["center"][mine])
        kept.turns.append(rows["turns"][mine].astype(np.int64))
        kept.plane.append(rows["plane"][mine].astype(np.int64))
        kept.frames.append(np.stack([numbers[chunk.start_frames()[mine]], numbers[rows["frame"][mine]]], axis=1))
        traverse = (rows["op"][mine] == Op.TRAVERSE) if is_straight is not True else np.zeros(int(mine.sum()), bool)
        kept.free.append(traverse)

    @property
    def empty(self) -> bool:
        """Whether no row rests on anything unknown near a zone."""
        return not self._rows

    def faces(self) -> tuple[Floats, Floats]:
        """(3,) each: lower and upper faces of a box around all zones, machine mm; infinite where that is not known."""
        low, high = np.full(3, math.inf), np.full(3, -math.inf)
        for stand, _ in self._rows.values():
            for axis, (least, most) in enumerate(stand.solid.box()):
                known = stand.form[axis] == ()
                low[axis] = min(low[axis], least + stand.shift[axis] if known else -math.inf)
                high[axis] = max(high[axis], most + stand.shift[axis] if known else math.inf)
        return low, high

    def places(self, resolve: Resolve, ranges: Ranges) -> tuple[Place, ...] | None:
        """What is left of ``ranges`` (of sums; none: no bounds), for each group of sums that move together.

        None where a move that no offset moves may enter a zone, wherever it is.
        """
        forms = list(self._forms)
        resolved: list[Resolved] = []
        for stand, rows in self._rows.values():
            frames = {int(v) for part in rows.frames for v in np.unique(part)}
            resolved.append({n: [_apart(forms[n][k], stand.form[k], resolve) for k in range(3)] for n in frames})
        used = {(x[0], y[0], z[0]) for frames_of in resolved for x, y, z in frames_of.values()}
        groups = merged(used)
        blocked = [Blocked(*_asked(group, ranges)) for group in groups]
        zones: list[set[str]] = [set() for _ in groups]
        for (stand, rows), frames_of in zip(self._rows.values(), resolved, strict=True):
            moves: dict[int, list[Move]] = {}
            for number, move in _moves(rows, stand, groups, frames_of, ranges):
                moves.setdefault(number, []).append(move)
            if any(meets(stand.solid, move) for move in moves.pop(NOT_MOVED, [])):
                return None
            for number, found in moves.items():
                blocked[number].add(stand.solid, joined(found), sure=stand.sure)
                zones[number].add(stand.name)
        out = []
        for group, one, names in zip(groups, blocked, zones, strict=True):
            if names:
                region = one.region()
                out.append(Place(terms=group, region=region, boxes=boxes_of(region), zones=tuple(sorted(names))))
        return tuple(out)


def _apart(form: Affine, zone: Affine, resolve: Resolve) -> tuple[Affine, Pair]:
    """What a coordinate, seen from its zone, rests on."""
    if UNKNOWN in (form, zone):
        return (), (-math.inf, math.inf)
    return resolve(add_forms(form, zone, -1))


def merged(triples: set[Triple]) -> list[Triple]:
    """The fewest triples of which each given one is a part: () stands for any sum."""
    groups: list[list[Affine]] = []
    for triple in sorted(triples, key=lambda t: (-sum(form != () for form in t), t)):
        if not any(triple):
            continue
        for group in groups:
            if all(() in (a, b) or a == b for a, b in zip(group, triple, strict=True)):
                group[:] = [a or b for a, b in zip(group, triple, strict=True)]
                break
        else:
            groups.append(list(triple))
    return [(group[0], group[1], group[2]) for group in groups]


def _asked(group: Triple, ranges: Ranges) -> tuple[tuple[Pair, Pair, Pair], tuple[bool, bool, bool]]:
    everything = (-math.inf, math.inf)
    x, y, z = (ranges.get(form, everything) if form else (0.0, 0.0) for form in group)
    return (x, y, z), (not group[0], not group[1], not group[2])


def _moves(
    rows: _Rows, stand: Stand, groups: list[Triple], resolved: Resolved, ranges: Ranges
) -> list[tuple[int, Move]]:  # fmt: skip
    """Moves of rows, each with the group that it belongs to: that of its end, otherwise of its start."""
    shift = np.array(stand.shift)
    start, end = np.concatenate(rows.start) - shift, np.concatenate(rows.end) - shift
    center, frames = np.concatenate(rows.center) - shift, np.concatenate(rows.frames)
    turns, plane, free = np.concatenate(rows.turns), np.concatenate(rows.plane), np.concatenate(rows.free)
    out: list[tuple[int, Move]] = []
    known: dict[tuple[int, int], tuple[int, npt.NDArray[np.bool_], Floats | None]] = {}
    done = _runs(start, end, frames, (turns == 0) & ~free)
    for row in range(len(start)):
        key = int(frames[row, 0]), int(frames[row, 1])
        if key not in known:
            known[key] = _standing([resolved[key[0]], resolved[key[1]]], groups, ranges)
        group, moves, spans = known[key]
        plain = spans is None and bool((moves[0] == moves[1]).all())
        if row in done and plain:
            if done[row] > row:
                out.append((group, together(np.concatenate([start[row : row + 1], end[row : done[row]]]), moves)))
            continue
        a, b = start[row], end[row]
        pair = IN_PLANE[Plane(int(plane[row]))] if turns[row] else (0, 1)
        if turns[row] and plain and len(start) > MOST:
            out.append((group, around_box(a, b, center[row], int(turns[row]), pair, moves)))
            continue
        if turns[row] and plain:
            out += [(group, move) for move in around_arc(a, b, center[row], int(turns[row]), pair, moves)]
            continue
        if not turns[row] and (plain or (spans is None and not free[row])):
            out += [(group, move) for move in straight(a, b, moves, free=bool(free[row]))]
            continue
        low, high = np.stack([a, b]), np.stack([a, b])
        if turns[row]:
            around = around_arc(a, b, center[row], int(turns[row]), pair, moves)
            for axis in pair:
                alike = moves[0, axis] == moves[1, axis]
                low[:, axis] = min(m.low[0, axis] for m in around) if alike else -math.inf
                high[:, axis] = max(m.high[0, axis] for m in around) if alike else math.inf
        if spans is not None:
            low, high = low + spans[0], high + spans[1]
        out.append((group, Move(low=low, high=high, moves=moves, error=math.inf)))
    return out


def _runs(
    start: Floats, end: Floats, frames: npt.NDArray[np.int64], plain: npt.NDArray[np.bool_]
) -> dict[int, int]:  # fmt: skip
    """Neighbours to be taken together, where there are more than ``MOST`` rows.

    Of the first row of a run the row after it, of the others themselves.
    """
    size = -(-len(start) // MOST)
    if size <= 1:
        return {}
    follows = plain[1:] & plain[:-1] & (frames[1:] == frames[:-1]).all(axis=1) & (start[1:] == end[:-1]).all(axis=1)
    out: dict[int, int] = {}
    row = 0
    while row < len(start):
        last = row
        while last + 1 < len(start) and last + 1 - row < size and follows[last]:
            last += 1
        if last > row:
            out[row] = last + 1
            out.update((n, n) for n in range(row + 1, last + 1))
        row = last + 1
    return out


def _standing(
    ends: list[list[tuple[Affine, Pair]]], groups: list[Triple], ranges: Ranges
) -> tuple[int, npt.NDArray[np.bool_], Floats | None]:
    """The group, what of the ends moves with it, and by what else they may be off: (2, 2, 3), None: by nothing."""
    group = NOT_MOVED
    for end in (ends[1], ends[0]):
        triple = [form for form, _ in end]
        if any(triple):
            fits = (n for n, g in enumerate(groups) if all(a in ((), b) for a, b in zip(triple, g, strict=True)))
            group = next(fits)
            break
    moves = np.zeros((2, 3), dtype=bool)
    spans = np.zeros((2, 2, 3))
    for n, end in enumerate(ends):
        for axis, (form, (low, high)) in enumerate(end):
            moves[n, axis] = group >= 0 and form != () and form == groups[group][axis]
            if form != () and not moves[n, axis]:
                # It moves with another group: anywhere in that one's range.
                other = ranges.get(form, (-math.inf, math.inf))
                low, high = low + other[0], high + other[1]
            spans[:, n, axis] = low, high
    return group, moves, spans if spans.any() else None
