"""Feeds of WinCNC as raising follows them: one for each axis and its group, and another one for arcs.

A feed holds for the axes that its line names and for those grouped with them (Parameters in [Brackets]: F; WINCNC.INI
Settings: vgroup=), and F of arcs may be kept apart (Feed Velocity). A Job has one feed in force, so that each move
whose feed differs from that of the move before says it. What a feed is after a change of the unit, the manual does not
say: it is not known until the next F, or until that unit is back.
"""

from __future__ import annotations

import numpy as np

from gproof.frontend.common.raising_modes import UNKNOWN_MODE, Modes
from gproof.ir.columns import Array, Columns
from gproof.ir.dialects.wincnc.settings import WinCncSettings
from gproof.ir.job import ARC_CW, MM, RAPID
from gproof.ir.machine import AXES, AXIS_NAMES, Machine
from gproof.ir.program import Expr
from gproof.ir.record import record

Rate = tuple[float | Expr, str]
"""A feed: number or expression, and its unit of length."""
SAME = 1e-9
ROUNDED = 9
"""Decimals of a feed that a machine file has in another unit."""


def named_columns(controls: WinCncSettings, columns: frozenset[int]) -> frozenset[int]:
    """The columns to which an F next to axis words of these columns gives a feed (vgroup=)."""
    named = {AXIS_NAMES[column] for column in columns} or set(controls.command_group) or {"x", "y"}
    if columns:
        grouped = {name for group in controls.feed_groups for name in group}
        for group in controls.feed_groups:
            if named & set(group):
                named |= set(group)
        # The command group is one of axes only where no other says whom an axis belongs to.
        if named & set(controls.command_group) and not named & grouped:
            named |= set(controls.command_group)
    return frozenset(AXIS_NAMES.index(name) for name in named)


@record(frozen=True, slots=True)
class FeedRules:
    """What of a machine decides about feeds.

    groups: for each set of columns (bits) those that an F next to their words gives a feed to (bits); linear: columns
    that are measured in lengths (bits); shared: an F of lines holds for arcs and the reverse, None: not stated; usual:
    feeds before the program gives one, by column; unit: of these.
    """

    groups: tuple[int, ...]
    linear: int
    shared: bool | None
    usual: tuple[float | None, ...]
    unit: str

    def chosen(self, moving: int) -> int:
        """The columns whose feeds count for a move of some."""
        return moving & self.linear or moving


def feed_rules(machine: Machine, controls: WinCncSettings, unit: str) -> FeedRules:
    """Those of a machine; unit: in which its numbers count."""
    groups = []
    for mask in range(1 << AXES):
        columns = frozenset(column for column in range(AXES) if mask >> column & 1)
        groups.append(sum(1 << column for column in named_columns(controls, columns)))
    kinds = {axis.index: axis.unit == "mm" for axis in machine.axes}
    linear = sum(1 << column for column in range(AXES) if kinds.get(column, column < 3))
    usual: list[float | None] = [None] * AXES
    for axis in machine.axes:
        if axis.feed_velocity is not None:
            usual[axis.index] = round(axis.feed_velocity * 60.0 / MM[unit], ROUNDED)
    return FeedRules(tuple(groups), linear, controls.arcs_share_feed, tuple(usual), unit)


def first_feeds(modes: Modes, rules: FeedRules) -> Modes:
    """The modes with the feeds of the machine's own file."""
    for column, value in enumerate(rules.usual):
        modes = modes.with_own(f"feed{column}", None if value is None else (value, rules.unit))
    return modes


def _usable(modes: Modes, rules: FeedRules, name: str, column: int) -> Rate | None:
    """A feed where it is known in the unit in force; that of the machine's own file in any."""
    rate = modes.own(name)
    if not isinstance(rate, tuple):
        return None
    own = column >= 0 and rate == (rules.usual[column], rules.unit)
    return rate if own or rate[1] == modes.unit else None


def give_feed(modes: Modes, rules: FeedRules, columns: int, value: float | Expr) -> Modes:
    """After an F next to words of these columns (bits)."""
    named = rules.groups[columns]
    for column in range(AXES):
        if named >> column & 1:
            modes = modes.with_own(f"feed{column}", (value, modes.unit))
    return modes.with_own("doubt", False) if named & 3 else modes


def feed_of_line(modes: Modes, rules: FeedRules, moving: int) -> Rate | None:
    """The feed of a straight move of these columns, None where it is not known."""
    rates = [_usable(modes, rules, f"feed{c}", c) for c in range(AXES) if rules.chosen(moving) >> c & 1]
    if not rates or any(rate != rates[0] for rate in rates) or (moving & 3 and modes.own("doubt")):
        return None
    return rates[0]


def give_arc_feed(modes: Modes, rules: FeedRules, columns: int, value: float | Expr) -> Modes:
    """After the F of an arc next to words of these columns."""
    if rules.shared:
        return give_feed(modes, rules, columns | 3, value)
    rate = value, modes.unit
    differs = modes.own("feed0") != rate or modes.own("feed1") != rate
    for column in range(2, AXES) if rules.shared is None else ():
        # Of axes besides X and Y: that F, or the one of lines.
        if rules.groups[columns | 3] >> column & 1 and modes.own(f"feed{column}") != rate:
            modes = modes.with_own(f"feed{column}", None)
    return modes.with_own("arc", rate).with_own("doubt", rules.shared is None and differs)


def feed_of_arc(modes: Modes, rules: FeedRules, *, given: bool) -> Rate | None:
    """The feed of an arc after its F, if ``given``; None where it is not known."""
    feeds = [_usable(modes, rules, f"feed{column}", column) for column in (0, 1)]
    if rules.shared:
        return feeds[0] if feeds[0] == feeds[1] else None
    own = modes.own("arc")
    rate = _usable(modes, rules, "arc", -1)
    if own is None:
        rate = None if rules.usual[0] is None else (rules.usual[0], rules.unit)
    # After an F of an arc, and until lines have one, it is the last of both.
    last_of_both = own is not None and modes.own("doubt") is True
    return rate if given or rules.shared is False or last_of_both or feeds == [rate, rate] else None


@record(slots=True)
class _Filled:
    """Feeds row by row."""

    by_column: list[Array]
    arc: Array
    arc_given: Array
    doubt: Array


def _fill(known: Array, at: Array, values: Array) -> Array:
    """``known`` from each of the rows ``at`` on with its value, up to the next one."""
    if len(at):
        place = np.searchsorted(at, np.arange(len(known)), "right") - 1
        inside = place >= 0
        known[inside] = values[place[inside]]
    return known


def _number(rate: object) -> float:
    """A feed as a number, NaN for none or an expression."""
    return rate[0] if isinstance(rate, tuple) and isinstance(rate[0], float) else np.nan


def _filled(rows: Columns, modes: Modes, rules: FeedRules) -> _Filled:
    count = len(rows)
    feed, arc = rows["feed"], rows["kind"] >= ARC_CW
    given = ~np.isnan(feed)
    mask = rows["axes"].astype(np.int64)
    of_lines = given & (~arc | (rules.shared is True))
    touched = np.array(rules.groups)[np.where(arc, mask | 3, mask)]
    named = np.where(of_lines, touched, 0)
    columns = []
    for column in range(AXES):
        rate = _usable(modes, rules, f"feed{column}", column)
        start = _number(rate) if rate is not None and rate[1] == modes.unit else np.nan
        at = np.flatnonzero(named >> column & 1)
        of_lines_alone = _fill(np.full(count, start), at, feed[at])
        if column > 1 and rules.shared is None:
            either = given & arc & (touched >> column & 1 != 0)
            at = np.flatnonzero((named >> column & 1 != 0) | either)
            agree = ~either | (of_lines_alone == feed)
            of_lines_alone = _fill(np.full(count, start), at, np.where(agree, feed, np.nan)[at])
        columns.append(of_lines_alone)
    own = modes.own("arc")
    usual = (rules.usual[0], rules.unit) if own is None else _usable(modes, rules, "arc", -1)
    start = _number(usual) if isinstance(usual, tuple) and usual[1] == modes.unit else np.nan
    of_arcs = np.flatnonzero(given & arc & (rules.shared is not True))
    arcs = _fill(np.full(count, start), of_arcs, feed[of_arcs])
    doubt = np.full(count, bool(modes.own("doubt")))
    if rules.shared is None:
        events = np.flatnonzero((given & arc) | (named & 3 != 0))
        differs = (columns[0][events] != feed[events]) | (columns[1][events] != feed[events])
        doubt = _fill(doubt, events, arc[events] & differs)
    return _Filled(columns, arcs, _fill(np.zeros(count, np.bool_), of_arcs, np.ones(len(of_arcs), np.bool_)), doubt)


def _effective(rows: Columns, filled: _Filled, rules: FeedRules) -> Array:
    """The feed of each row, NaN where it is not known."""
    arc, mask = rows["kind"] >= ARC_CW, rows["axes"].astype(np.int64)
    linear = mask & rules.linear
    chosen = np.where(linear != 0, linear, mask)
    if rules.shared is True:
        chosen = np.where(arc, 3, chosen)
    rate = np.full(len(rows), np.nan)
    seen = np.zeros(len(rows), np.bool_)
    apart = np.zeros(len(rows), np.bool_)
    for column in range(AXES):
        here = (chosen >> column & 1) != 0
        apart |= here & seen & (filled.by_column[column] != rate)
        rate = np.where(here & ~seen, filled.by_column[column], rate)
        seen |= here
    rate[apart | (linear == 0) & ~arc] = np.nan
    if rules.shared is True:
        return rate
    rate[filled.doubt & (mask & 3 != 0)] = np.nan
    own = filled.arc
    alike = (filled.by_column[0] == own) & (filled.by_column[1] == own)
    sure = ~np.isnan(rows["feed"]) | alike | (rules.shared is False) | filled.doubt
    return np.where(arc, np.where(sure, own, np.nan), rate)


def table_feeds(rows: Columns, modes: Modes, rules: FeedRules) -> tuple[Array, Array, _Filled]:
    """(feed of each row, whether it is known or none is needed, what it was found from)."""
    filled = _filled(rows, modes, rules)
    rate = _effective(rows, filled, rules)
    good = ~(rows["feed"] <= 0.0) & ((rows["kind"] == RAPID) | ~np.isnan(rate))
    return rate, good, filled


def say_feeds(rows: Columns, rate: Array, modes: Modes) -> tuple[Array, float]:
    """(the column ``feed`` of a table: a number where it differs from that of the feed move before, the last one)."""
    moves = np.flatnonzero(rows["kind"] != RAPID)
    said = np.full(len(rows), np.nan)
    before = modes.own("said")
    last = _number(before) if isinstance(before, tuple) and before[1] == modes.unit else np.nan
    if len(moves):
        values = rate[moves]
        differs = values != np.concatenate(([last], values[:-1]))
        said[moves[differs]] = values[differs]
        last = float(values[-1])
    return said, last


def after_table(rows: Columns, filled: _Filled, modes: Modes, rules: FeedRules, last: float) -> Modes:
    """The modes after all rows of a table."""
    end = len(rows) - 1
    given = ~np.isnan(rows["feed"])
    arc = rows["kind"] >= ARC_CW
    mask = rows["axes"].astype(np.int64)
    of_lines = given & (~arc | (rules.shared is True))
    touched = np.array(rules.groups)[np.where(arc, mask | 3, mask)]
    either = given & arc & (rules.shared is None)
    named = int(np.bitwise_or.reduce(np.where(of_lines, touched, np.where(either, touched & ~3, 0))))
    for column in range(AXES):
        if named >> column & 1:
            value = float(filled.by_column[column][end])
            modes = modes.with_own(f"feed{column}", None if np.isnan(value) else (value, modes.unit))
    if filled.arc_given[end]:
        modes = modes.with_own("arc", (float(filled.arc[end]), modes.unit))
    if rules.shared is None and bool(filled.doubt[end]) != bool(modes.own("doubt")):
        modes = modes.with_own("doubt", bool(filled.doubt[end]))
    return modes if np.isnan(last) else modes.with_own("said", (last, modes.unit))


def unknown(value: object) -> bool:
    """Whether a mode of the dialect's own is not known."""
    return value == UNKNOWN_MODE
