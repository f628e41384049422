"""Compares two traces row by row; every difference that is allowed is a rule here, never a wider tolerance.

Takes rows in the shape of `gproof dump --stage trace --format jsonl`. `normal(rows)` brings a trace into its
normal form, the same for both sides; `first_difference` compares two normal forms. The rules:

1. Kept are the moves (traverse, feed, arc, probe), dwell, spindle, coolant, tool_change, stop, end and error.
   State changes without an effect of their own (offset, units, plane, ...) show in the moves after them.
2. A traverse or feed of no length is dropped (rs274 says `G28` in two moves, the first one of no length, and
   repeats a cycle's move to R). A whole circle ends where it starts and is kept.
3. Spindle and coolant are states: of several rows of one kind in a row on one line the last counts (rs274
   sets the speed, then starts; switches mist off, then flood), a row that changes nothing is dropped, and a
   spindle that turns with zero revolutions is one that rests.
4. A tool change leaves the spindle off, said or not: a row `off` beside the change on its line is dropped. So
   is what that line did to the spindle before the change (rs274 sets S first).
5. The end leaves spindle and coolant off: rows that say so on the line of the end are dropped.
6. G83 comes back to the bottom of the hole, but a bit above it (manual 3.4.21.4), and each interpreter
   decides how much a bit is: the way back is taken to end at the bottom, if it ended above it by at most
   `A_BIT`.
7. Feeds agree to a millionth. Under inverse time feed the feed of an arc follows from its length, which is known
   no better than its ends are: there the bound grows by `LENGTH` over the radius.
8. A dwell of no time is dropped (rs274 says one at the bottom of a tap).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

Row = dict[str, Any]

MOVES = frozenset({"traverse", "feed", "arc", "probe"})
KEPT = MOVES | {"dwell", "spindle", "coolant", "tool_change", "stop", "end", "error"}
LENGTH = 1e-4  # mm (and degrees): where moves end, where arcs have their centre
NO_LENGTH = 1e-6  # mm: a move that goes no farther on any axis is none
A_BIT = 1.0  # mm: G83 may back off by so much
EXACT = 1e-6  # seconds, revolutions a minute; feeds relative to their size
REST: dict[str, Row] = {"spindle": {"dir": "off", "rpm": 0.0}, "coolant": {"mist": False, "flood": False}}
AXES = ("x", "y", "z", "a", "b", "c")


@dataclass(frozen=True)
class Difference:
    """Where two traces part: the row of each (None: there is none), and what is different about them."""

    index: int
    ours: Row | None
    theirs: Row | None
    what: str
    sides: tuple[str, str] = ("gproof", "peer")

    def __str__(self) -> str:
        text = [f"row {self.index}: {self.what}"]
        for side, row in zip(self.sides, (self.ours, self.theirs), strict=True):
            text.append(f"  {side} (line {row['line']}): {row}" if row else f"  {side}: no more rows")
        return "\n".join(text)


def first_difference(
    ours: Sequence[Row], theirs: Sequence[Row], sides: tuple[str, str] = ("gproof", "peer")
) -> Difference | None:
    """None if the normal forms of two traces agree; `sides` names the two in the message."""
    left, right = normal(ours), normal(theirs)
    for k in range(max(len(left), len(right))):
        one = left[k] if k < len(left) else None
        other = right[k] if k < len(right) else None
        if one is None or other is None:
            return Difference(k, one, other, "one side ends here", sides)
        what = _row_difference(one, other)
        if what:
            return Difference(k, one, other, what, sides)
    return None


def normal(rows: Sequence[Row]) -> list[Row]:
    """The normal form of a trace: rules 1 to 6 and 8, in the order that makes them independent of each other."""
    kept = [dict(row) for row in rows if row["op"] in KEPT and not (row["op"] == "dwell" and row["seconds"] == 0)]
    for rule in (_back_to_the_bottom, _without_rests, _states, _tool_changes, _ends, _changes):
        kept = rule(kept)
    return kept


def _reach(move: Row) -> dict[str, float]:
    to = move["to"]
    return {axis: float(to.get(axis, 0.0)) for axis in AXES}


def _without_rests(rows: list[Row]) -> list[Row]:
    """Rule 2. Compares with the last move kept, so that many short moves can not hide a long one."""
    kept: list[Row] = []
    at = dict.fromkeys(AXES, 0.0)
    for row in rows:
        if row["op"] in MOVES:
            to = _reach(row)
            if row["op"] in {"traverse", "feed"} and all(abs(to[axis] - at[axis]) <= NO_LENGTH for axis in AXES):
                continue
            at = to
        kept.append(row)
    return kept


def _states(rows: list[Row]) -> list[Row]:
    """Rule 3, first part: the last of several rows of one kind; a spindle that does not turn is off."""
    kept: list[Row] = []
    for row in rows:
        if row["op"] == "spindle" and (row["dir"] == "off" or row["rpm"] == 0.0):
            row = {**row, **REST["spindle"]}
        same = kept and row["op"] in REST and (kept[-1]["op"], kept[-1]["line"]) == (row["op"], row["line"])
        if same:
            kept.pop()
        kept.append(row)
    return kept


def _tool_changes(rows: list[Row]) -> list[Row]:
    """Rule 4: what the line did to the spindle before the change goes; `_changes` does the rest."""
    kept: list[Row] = []
    for row in rows:
        if row["op"] == "tool_change":
            while kept and kept[-1]["op"] == "spindle" and kept[-1]["line"] == row["line"]:
                kept.pop()
        kept.append(row)
    return kept


def _ends(rows: list[Row]) -> list[Row]:
    """Rule 5: rows beside the end, before and after it."""
    kept: list[Row] = []
    ended: Row | None = None
    for row in rows:
        if row["op"] == "end":
            ended = row
            while kept and _rests(kept[-1]) and kept[-1]["line"] == row["line"]:
                kept.pop()
        elif ended is not None and _rests(row) and row["line"] == ended["line"]:
            continue
        kept.append(row)
    return kept


def _rests(row: Row) -> bool:
    rest = REST.get(row["op"])
    return rest is not None and all(row[key] == value for key, value in rest.items())


def _changes(rows: list[Row]) -> list[Row]:
    """Rule 3, second part: rows that change the state. A tool change puts the spindle to rest."""
    kept: list[Row] = []
    state: dict[str, Row] = {op: dict(rest) for op, rest in REST.items()}
    for row in rows:
        if row["op"] == "tool_change":
            state["spindle"] = dict(REST["spindle"])
        if row["op"] in state:
            now = {key: row[key] for key in state[row["op"]]}
            if now == state[row["op"]]:
                continue
            state[row["op"]] = now
        kept.append(row)
    return kept


def _back_to_the_bottom(rows: list[Row]) -> list[Row]:
    """Rule 6: feed down, traverse out, traverse back to a bit above, feed on; on one line, along one axis."""
    moved = [k for k, row in enumerate(rows) if row["op"] in MOVES]
    changed = list(rows)
    for down, out, back, on in zip(moved, moved[1:], moved[2:], moved[3:], strict=False):
        four = [rows[k] for k in (down, out, back, on)]
        if [row["op"] for row in four] != ["feed", "traverse", "traverse", "feed"]:
            continue
        if len({row["line"] for row in four}) != 1:
            continue
        bottom, top, returned, next_bottom = map(_reach, four)
        along = [axis for axis in AXES[:3] if abs(top[axis] - bottom[axis]) > NO_LENGTH]
        if len(along) != 1:
            continue
        axis = along[0]
        beside = [other for other in AXES if other != axis]
        if any(abs(reached[a] - bottom[a]) > NO_LENGTH for reached in (top, returned, next_bottom) for a in beside):
            continue
        if not (0.0 < returned[axis] - bottom[axis] <= A_BIT and next_bottom[axis] < bottom[axis] < top[axis]):
            continue
        changed[back] = {**rows[back], "to": {**rows[back]["to"], axis: bottom[axis]}}
    return changed


def _row_difference(one: Row, other: Row) -> str | None:
    if one["op"] != other["op"]:
        return f"{one['op']} against {other['op']}"
    if one["line"] != other["line"]:
        return f"line {one['line']} against {other['line']}"
    return _move_difference(one, other) if one["op"] in MOVES else _event_difference(one, other)


def _move_difference(one: Row, other: Row) -> str | None:
    reached, wanted = _reach(one), _reach(other)
    for axis in AXES:
        if not abs(reached[axis] - wanted[axis]) <= LENGTH:  # a NaN is a difference too
            return f"{axis} {reached[axis]!r} against {wanted[axis]!r}"
    if one["op"] == "arc":
        planes = one.get("normal") or one["plane"], other.get("normal") or other["plane"]
        if planes[0] != planes[1]:
            return f"plane {planes[0]} against {planes[1]}"
        if one["turns"] != other["turns"]:
            return f"turns {one['turns']} against {other['turns']}"
        for letter, p, q in zip(one["plane"], one["center"], other["center"], strict=True):
            if not abs(p - q) <= LENGTH:
                return f"centre {letter} {p!r} against {q!r}"
    if one["op"] != "traverse":
        feeds: tuple[Any, Any] = one.get("feed"), other.get("feed")
        bound = EXACT + (LENGTH / _radius(other) if other["op"] == "arc" else 0.0)
        if None in feeds or abs(feeds[0] - feeds[1]) > EXACT + bound * abs(feeds[1]):
            return f"feed {feeds[0]!r} against {feeds[1]!r}"
    return None


def _radius(arc: Row) -> float:
    at = [arc["to"].get(letter.lower(), 0.0) for letter in arc["plane"]]
    return max(math.dist(at, arc["center"]), LENGTH)


def _event_difference(one: Row, other: Row) -> str | None:
    keys = {
        "dwell": ("seconds",),
        "spindle": ("dir", "rpm"),
        "coolant": ("mist", "flood"),
        "tool_change": ("tool",),
        "stop": ("optional",),
    }
    for key in keys.get(one["op"], ()):
        left, right = one.get(key), other.get(key)
        numbers = isinstance(left, float | int) and isinstance(right, float | int)
        if left != right and not (numbers and abs(left - right) <= EXACT):  # type: ignore[operator]
            return f"{key} {left!r} against {right!r}"
    return None
