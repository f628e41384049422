"""WinCNC: lines that move, as operations of a Job. Manual: G Codes, G0 to G3, G53; P, H; F."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gproof.frontend.common.raising import Unraisable
from gproof.frontend.common.raising_modes import UNKNOWN_MODE, Modes
from gproof.frontend.wincnc.raising_feeds import (
    SAME,
    feed_of_arc,
    feed_of_line,
    give_arc_feed,
    give_feed,
    unknown,
)
from gproof.frontend.wincnc.raising_line import Command, LineRaiser
from gproof.ir.columns import Array, Columns
from gproof.ir.job import ARC_CW, MM, ArcTo, AxisPlace, Feed, MoveTo, Node, Quantity
from gproof.ir.machine import AXIS_NAMES, AxisKind
from gproof.ir.program import Expr, Number
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F

OPEN = "?"
"""In place of the kept I and J: what they are is not known."""


def feed_value(line: Command) -> float | Expr | None:
    """The value of F; Unraisable for one that is no feed."""
    value = line.value("F")
    if isinstance(value, Number):
        if value.value <= 0.0:
            raise Unraisable(f"F{value.value:g}", "no feed")
        return value.value
    return value


def take_feed(raiser: LineRaiser, line: Command, columns: int) -> None:
    """F of a line gives a feed to these columns and their groups."""
    value = feed_value(line)
    if value is not None:
        if raiser.now.unit == UNKNOWN_MODE:
            raise Unraisable("F", "the unit depends on the way that the program took")
        raiser.modes = give_feed(raiser.now, raiser.feeds, columns, value)


def need_no_places(line: Command) -> None:
    """Unraisable for a stored place."""
    for letter in "PHT":
        if letter in line.words:
            raise Unraisable(f"{letter} as a stored position", "a place that only the controller knows")


def stored_place(raiser: LineRaiser, line: Command) -> tuple[AxisPlace, ...]:
    """Where a stored position is, of the axes that the line names, or all, in machine coordinates: a number next to an
    axis is a distance from there; empty for a line without one (P, H; positions=)."""
    names = [letter for letter in "PHT" if letter in line.words]
    if not names:
        return ()
    name = f"{names[0]}{line.number(names[0]) or 0.0:g}"
    stated = raiser.stored.get(name)
    if stated is None or len(names) > 1:
        what = f"no file says where it is: [positions.{name}] of the setup file"
        raise Unraisable(f"{name} as a stored position", what)
    if stated.lift:
        raise Unraisable(f"{name} as a stored position", "how far heads are lifted on the way the manual leaves open")
    words = line.axes()
    if any(word.number is None for word in words.values()) or not {AXIS_NAMES[n] for n in words} <= stated.axes.keys():
        raise Unraisable(f"{name} as a stored position", "an axis that was not stored, or a computed distance from it")
    found = []
    for column, axis in enumerate(AXIS_NAMES):
        if axis in stated.axes and (not words or column in words):
            unit = MM[raiser.now.unit] if raiser.linear[column] and raiser.now.unit in MM else 1.0
            at = stated.axes[axis] / unit + (words[column].number or 0.0 if column in words else 0.0)
            found.append(AxisPlace(axis, raiser.amount(column, Number(round(at, PLACES), line.span))))
    return tuple(found)


PLACES = 9
"""Decimals of a stored place in another unit than the file has it in."""


def need_cell(raiser: LineRaiser, columns: int) -> None:
    """An array needs G92 X Y in its cells before X or Y move (L10)."""
    if raiser.own_mode("cell", False) and columns & 3:
        raise Unraisable("L10", "no G92 X Y after it, which the manual requires")


def straight(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G0 and G1."""
    is_rapid = rule.function is F.TRAVERSE
    stored = stored_place(raiser, line) if is_rapid and not line.axes() else ()
    if stored:
        return _machine_move(raiser, stored, line)
    need_no_places(line)
    if "L" in line.words:
        raise Unraisable(f"{rule.text} with L", "power of a laser")
    columns = line.mask
    if line.command is None and columns and next(iter(line.words)) == "F":
        others = [word.bare for letter, word in line.words.items() if letter != "F"]
        if all(others):
            raise Unraisable("F before axes without numbers", "a feed for them, or a move to 0 as well")
    raiser.modes = replace(raiser.now, motion=rule.tenths, sticky=()).with_own("cycle", 0)
    inverse = not is_rapid and raiser.now.per == "move"
    if raiser.now.per == UNKNOWN_MODE:
        raise Unraisable(rule.text, "whether G93 is on depends on the way that the program took")
    if not inverse:
        take_feed(raiser, line, columns)
    for letter in "IJKR":
        if letter in line.words:
            raise Unraisable(f"{letter} in a line of {rule.text}", "no command takes it")
    stop = line.find(F.LIMIT_STOPS_AXIS, F.LIMIT_STOPS_LINE, F.STOP_PARSING)
    if stop is not None:
        raise Unraisable(f"{rule.text} with {stop.text}", "a switch may end the move")
    if not columns:
        return []
    need_cell(raiser, columns)
    raiser.settle_turn(columns, line)
    relative = raiser.is_relative(line)
    to = raiser.places(line, relative=relative)
    raiser.follow_height(line, relative=relative)
    if is_rapid:
        return [MoveTo(to=to, kind="rapid", span=line.span)]
    if inverse:
        return [MoveTo(to=to, feed=_inverse(raiser, line, rule), span=line.span)]
    feed = raiser.say_feed(feed_of_line(raiser.now, raiser.feeds, columns), line)
    return [MoveTo(to=to, feed=feed, span=line.span)]


def _inverse(raiser: LineRaiser, line: Command, rule: CodeRule) -> Feed:
    value = line.value("F")
    if value is None:
        raise Unraisable(rule.text, "no F while G93 is on")
    feed_value(line)
    raiser.set_own("said", None)
    return Feed(Quantity(value, "1/min"), "move")


def machine_rapid(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G53: a rapid in machine coordinates; alone all vertical axes go to machine zero."""
    stored = stored_place(raiser, line)
    if line.axes() and not stored and raiser.is_relative(line):
        raise Unraisable("G53 with distances", "what they count from the manual does not say")
    if raiser.own_mode("turn", "") != "" and (line.mask & 3 or raiser.own_mode("turn") != "rotate"):
        raise Unraisable("G53 while G51 or G52 is on", "whether it is scaled and turned the manual does not say")
    to = stored or raiser.places(line)
    if not to:
        vertical = sorted(
            axis.index for axis in raiser.machine.axes
            if (axis.vertical if axis.vertical is not None else axis.word in "ZWUV" and axis.kind is AxisKind.LINEAR)
        )  # fmt: skip
        to = tuple(AxisPlace(AXIS_NAMES[n], raiser.amount(n, Number(0.0, line.span))) for n in vertical)
    if not to:
        return []
    return _machine_move(raiser, to, line)


def _machine_move(raiser: LineRaiser, to: tuple[AxisPlace, ...], line: Command) -> list[Node]:
    if any(place.axis in "xy" for place in to):
        raiser.set_own("settled", False)
    raiser.forget_height()
    return [MoveTo(to=to, kind="rapid", frame="machine", span=line.span)]


# ---- arcs


def arc(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G2 and G3 in X and Y; what else the line names moves along evenly."""
    need_no_places(line)
    if raiser.controls.arcs_modal:
        raiser.modes = replace(raiser.now, motion=rule.tenths, sticky=()).with_own("cycle", 0)
    if "L" in line.words:
        raise Unraisable(f"{rule.text} with L", "power of a laser")
    if raiser.own_mode("turn", "") not in ("", "rotate"):
        raise Unraisable(f"{rule.text} while G51 is on", "the message list has it as an error")
    columns = line.mask
    if columns & 4 and not raiser.controls.helical_arcs:
        raise Unraisable(f"{rule.text} with Z", "this controller has no helices")
    if "K" in line.words and (not {"I", "J"} <= line.words.keys() or line.number("K") != 0.0):
        raise Unraisable(f"K of {rule.text}", "an arc in another plane")
    if raiser.now.per != "minute":
        raise Unraisable(f"{rule.text} while G93 is on", "what its F counts the manual does not say")
    need_cell(raiser, columns or 3)
    raiser.settle_turn(columns, line)
    relative = raiser.is_relative(line)
    center, radius = _center(raiser, line, rule)
    value = feed_value(line)
    if value is not None:
        raiser.modes = give_arc_feed(raiser.now, raiser.feeds, columns | 3, value)
    to = raiser.places(line, relative=relative)
    raiser.follow_height(line, relative=relative)
    smallest = raiser.controls.smallest_arc
    if smallest is not None:
        # Smaller ones are lines (arc_min=).
        need_size(raiser, center, radius, smallest)
    rate = feed_of_arc(raiser.now, raiser.feeds, given=value is not None)
    if rate is None and raiser.feeds.shared is None:
        raise Unraisable("F of arcs", "whether it is kept apart from that of lines the manual leaves open")
    feed = raiser.say_feed(rate, line)
    return [
        ArcTo(
            to=to, plane="xy", clockwise=rule.function is F.ARC_CW, center=center, radius=radius, feed=feed,
            span=line.span,
        )
    ]  # fmt: skip


def need_size(raiser: LineRaiser, center: tuple[AxisPlace, ...], radius: Quantity | None, smallest: float) -> None:
    """Unraisable for an arc that may be below arc_min=."""
    if radius is None and not all(place.relative for place in center):
        return  # how far a place is away is not known here
    sizes = [radius] if radius is not None else [place.at for place in center]
    numbers = [size.number for size in sizes]
    known = [abs(number) for number in numbers if number is not None]
    size = math.hypot(*known) if len(known) == len(numbers) and known else 0.0
    mm = MM[raiser.now.unit]
    if size * mm < smallest + SAME:
        raise Unraisable("an arc below arc_min=", "it is a line")


def _center(raiser: LineRaiser, line: Command, rule: CodeRule) -> tuple[tuple[AxisPlace, ...], Quantity | None]:
    """Centre or radius of an arc (G2: without I and J the former values are kept)."""
    absolute = raiser.machine.controller.absolute_arc_centers
    given = [letter for letter in "IJ" if letter in line.words]
    if "R" in line.words:
        if given:
            raise Unraisable(f"{rule.text} with R and a centre", "which one counts the manual does not say")
        number = line.number("R")
        if number is None or number <= 0.0:
            raise Unraisable(f"{rule.text} with a radius of {number:g}", "a radius is above 0")
        # Whether R leaves the I and J before it is not said.
        raiser.set_own("center", OPEN)
        return (), raiser.length(line.words["R"].value)
    kept = raiser.own_mode("center")
    if not given:
        if not isinstance(kept, tuple):
            why = "there is none before it" if kept is None else "which they are is not known"
            raise Unraisable(f"{rule.text} with the I and J of an arc before it", why)
        values: list[Expr] = [Number(v, line.span) if isinstance(v, float) else v for v in kept]
    else:
        values = []
        for n, letter in enumerate("IJ"):
            value = line.value(letter)
            if value is None:
                if absolute or kept == OPEN or (isinstance(kept, tuple) and not _is_zero(kept[n])):
                    raise Unraisable(f"{rule.text} without {letter}", "the value of the arc before, or 0")
                value = Number(0.0, line.span)
            values.append(value)
        raiser.set_own("center", tuple(v.value if isinstance(v, Number) else v for v in values))
    center = tuple(
        AxisPlace(axis, raiser.length(value), not absolute) for axis, value in zip("xy", values, strict=True)
    )
    return center, None


def _is_zero(value: object) -> bool:
    return isinstance(value, float) and abs(value) <= SAME


# ---- tables


def good_arcs(raiser: LineRaiser, rows: Columns) -> Array:
    """For each row of a table, whether it is no arc, or one whose centre or radius says what it is by itself."""
    arc = rows["kind"] >= ARC_CW
    good = np.ones(len(rows), np.bool_)
    if not arc.any():
        return good
    at = np.flatnonzero(arc)
    mask, center, radius = rows["centred"][at], rows["center"][at, :2], rows["radius"][at]
    fine = np.where(mask == 0, radius > 0.0, radius == 0.0)
    kept = raiser.own_mode("center")
    first = np.zeros(2) if kept is None else np.full(2, np.nan)
    if isinstance(kept, tuple):
        first = np.array([v if isinstance(v, float) else np.nan for v in kept])
    left = np.where((mask == 0)[:, None], np.nan, center)
    before = np.concatenate((first[None, :2], left[:-1]))
    missing = ((mask[:, None] >> np.arange(2)) & 1 == 0) & (mask != 0)[:, None]
    fine &= ~(missing & ~(np.abs(before) <= SAME)).any(axis=1)
    if raiser.machine.controller.absolute_arc_centers:
        fine[:] = False
    if not raiser.controls.helical_arcs:
        fine &= rows["axes"][at] & 4 == 0
    smallest = raiser.controls.smallest_arc
    if smallest is not None:
        mm = MM[raiser.now.unit]
        fine &= np.where(mask == 0, radius, np.hypot(center[:, 0], center[:, 1])) * mm >= smallest + SAME
    good[at] = fine
    return good


def after_arcs(rows: Columns, modes: Modes) -> Modes:
    """The modes after the last arc of a table: the I and J that it leaves."""
    at = np.flatnonzero(rows["kind"] >= ARC_CW)
    if not len(at):
        return modes
    last = int(at[-1])
    if rows["centred"][last] == 0:
        return modes.with_own("center", OPEN)
    return modes.with_own("center", tuple(rows["center"][last, :2].tolist()))


def height_after(rows: Columns, modes: Modes) -> Modes:
    """The modes after a table: where Z is."""
    at = np.flatnonzero(rows["axes"] & 4)
    if not len(at):
        return modes
    return modes.with_own("z", None if modes.relative else (float(rows["to"][int(at[-1]), 2]), modes.unit))


def is_plain(raiser: LineRaiser) -> bool:
    """Whether tables may be raised as such in the modes in force."""
    modes = raiser.now
    if modes.per != "minute" or modes.own("cycle") != 0 or modes.own("cell", False) is not False:
        return False
    if unknown(modes.own("doubt")) or modes.own("turn", "") not in ("", "rotate"):
        return False
    return modes.own("turn", "") == "" or modes.own("settled") is True
