"""F words of WinCNC: a feed for each group of axes and one for arcs, where a Job has one feed in force.

Manual: Feed Velocity; WINCNC.INI Settings: vgroup=. Whether arcs share the feed of lines, the manual leaves open: F is
printed wherever a reading needs it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from gproof.ir.columns import Array, Columns
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.job import ARC_CW, RAPID
from gproof.ir.machine import AXES, AXIS_NAMES, Machine

State = dict[str, Any]
LINE, ARC, LAST = "f line", "f arc", "f last"
"""Keys of the feed of the last line in X or Y, of the last arc, and of the last of both."""


def feed_groups(machine: Machine) -> tuple[int, ...]:
    """The groups of columns that share a feed, as bits; that of X and Y first. Empty where these two share
    none: each move with feed says its own then."""
    controls = wincnc_settings(machine)
    grouped = [set(group) for group in controls.feed_groups]
    by_command = {"x", "y"} <= set(controls.command_group) and not {"x", "y"} & set().union(*grouped)
    if not by_command and not any({"x", "y"} <= group for group in grouped):
        return ()
    groups = [{0, 1}]
    for names in (*controls.feed_groups, controls.command_group):
        columns = {AXIS_NAMES.index(name) for name in names}
        touched = [group for group in groups if group & columns]
        groups = [group for group in groups if not group & columns]
        groups.append(columns.union(*touched))
    missing = set(range(AXES)) - set().union(*groups)
    groups += [{column} for column in sorted(missing)]
    groups.sort(key=lambda group: (0 not in group, min(group, default=0)))
    return tuple(sum(1 << column for column in group) for group in groups if group)


def needs_feed(state: State, groups: tuple[int, ...], rate: float, columns: int, *, arc: bool) -> bool:
    """Whether a move of these columns (bits) at this feed has to say it; the state is that after it."""
    if not groups:
        return True
    keys = [LAST, ARC] if arc else []
    if not arc:
        for group in groups:
            if columns & group:
                keys += [LAST, LINE] if group == groups[0] else [f"f {group}"]
    needed = any(state.get(key) != rate for key in keys)
    state |= dict.fromkeys(keys, rate)
    for group in groups[1:] if arc else ():
        if columns & group:
            # Whether the F of an arc is theirs too, is open.
            state.pop(f"f {group}", None)
    return needed


def forget_feeds(state: State) -> None:
    """After a change of the unit, or of what is not known."""
    for key in [key for key in state if key.startswith("f ")]:
        del state[key]


def table_feeds(rows: Columns, state: State, groups: tuple[int, ...], start: float) -> tuple[Array, Array]:
    """(feed of each row, rows that have to say it); the state is that after the table. start: the feed in force, NaN
    for one that is not known."""
    rate = _filled(rows["feed"], start)
    arc, mask = rows["kind"] >= ARC_CW, rows["axes"].astype(np.int64)
    feed = rows["kind"] != RAPID
    if not groups:
        return rate, feed & ~np.isnan(rate)
    said = np.zeros(len(rows), np.bool_)
    flat = feed & ~arc & (mask & groups[0] != 0)
    for key, at in ((LAST, flat | (arc & feed)), (LINE, flat), (ARC, arc & feed)):
        said |= _differs(rate, at, state, key)
    for group in groups[1:]:
        # Whether the F of an arc that moves them is theirs too, is open: the next line says its own.
        at = feed & (mask & group != 0)
        said |= _differs(np.where(arc, np.nan, rate), at, state, f"f {group}") & ~arc
    return rate, said & ~np.isnan(rate)


def _filled(values: Array, start: float) -> Array:
    """Each value up to the next one."""
    at = np.flatnonzero(~np.isnan(values))
    found = np.full(len(values), start)
    if len(at):
        place = np.searchsorted(at, np.arange(len(values)), "right") - 1
        found[place >= 0] = values[at[place[place >= 0]]]
    return found


def _differs(rate: Array, which: Array, state: State, key: str) -> Array:
    """Rows among ``which`` whose feed is not that of the one before."""
    at = np.flatnonzero(which)
    found = np.zeros(len(rate), np.bool_)
    if len(at):
        values = rate[at]
        found[at] = values != np.concatenate(([state.get(key, np.nan)], values[:-1]))
        state[key] = float(values[-1])
        if np.isnan(state[key]):
            del state[key]
    return found
