"""A feed override that changes while a section runs: what was sent stays, the rest of the plan comes at another rate.

A change is made from the planned section, not from the one that is running: a rate may rise again, and nothing ever
comes nearer together than planned. Its TimeMap takes planned ticks: up to tick P it counts for nothing, there the
section that runs is at its tick ``asked``, and from there on rate f moves to the new one within the acceleration of
every axis (``feed_hold.py``). Steps and events up to ``asked`` are those that were there before.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np

from gproof.backend.feed_hold import ramp_to
from gproof.backend.record_data import Retiming
from gproof.backend.retime import Spacing, begin_of_end, dwells, retime
from gproof.backend.runs import cut, done_by, join
from gproof.backend.time_map import MapBuilder, TimeMap
from gproof.ir.columns import Columns
from gproof.ir.machine import Machine
from gproof.ir.record import record
from gproof.ir.stream import EVENT, Motor, StreamSection

TRIES = 64
"""Ticks that a change is put off at most, so that no steps that belong to one planned tick are parted."""


@record(frozen=True, slots=True)
class Place:
    """Where a section is at a tick: the planned tick, which all that was done by then has and nothing else, and the
    rate there, of the planned speed."""

    tick: int
    planned: int
    rate: float


def place_of(
    planned: StreamSection, section: StreamSection, retimings: Sequence[Retiming], tick: int
) -> Place | None:  # fmt: skip
    """The place at a tick of a section that retimings made of the planned one, or just after it; None: nowhere."""
    for at in range(tick, tick + TRIES):
        guess, rate = _back(retimings, at)
        room = _room(planned, section, at)
        if room is not None:
            return Place(at, min(max(int(guess), room[0]), room[1]), rate)
    return None


def _back(retimings: Sequence[Retiming], tick: int) -> tuple[float, float]:
    """The planned tick of a tick, and the rate there."""
    at, rate = float(tick), 1.0
    for one in reversed(retimings):
        if one.kind == "change" and at <= one.asked:
            continue
        source, target = np.array(one.source), np.array(one.target)
        cell = int(np.searchsorted(target, at, side="right")) - 1
        slope = 1.0
        if cell + 1 < len(target):
            slope = float((source[cell + 1] - source[cell]) / (target[cell + 1] - target[cell]))
        at, rate = float(source[cell] + (at - target[cell]) * slope), rate * slope
        if one.kind == "change":
            break
    return at, rate


def _room(planned: StreamSection, section: StreamSection, tick: int) -> tuple[int, int] | None:
    """The planned ticks that part what is done by a tick from what is not; None where no tick does."""
    done, left = 0, planned.duration + 1
    for before, runs in zip(planned.runs, section.runs, strict=True):
        steps = done_by(runs, tick).steps
        last, following = _around(before, steps)
        done, left = max(done, last), min(left, following)
    count = int(np.searchsorted(section.events["tick"], tick, side="right"))
    ticks = planned.events["tick"]
    done = max(done, int(ticks[count - 1])) if count else done
    left = min(left, int(ticks[count])) if count < len(ticks) else left
    return (done, left - 1) if done < left else None


def _around(runs: Columns, steps: int) -> tuple[int, int]:
    """Ticks of step number ``steps`` (0: of none) and of the one after it."""
    counted = np.cumsum(runs["count"])
    place = int(np.searchsorted(counted, steps, side="left"))
    found = []
    for number in (steps, steps + 1):
        place = int(np.searchsorted(counted, number, side="left"))
        if number < 1:
            found.append(0)
        elif place >= len(counted):
            found.append(1 << 62)
        else:
            k = number - (int(counted[place - 1]) if place else 0)
            first, add = int(runs["interval"][place]), int(runs["add"][place])
            found.append(done_by(runs.slice(0, place), 1 << 62).last + k * first + add * (k * (k - 1) // 2))
    return found[0], found[1]


def change_map(
    planned: StreamSection, motors: tuple[Motor, ...], machine: Machine, frequency: int,
    place: Place, factor: Fraction, margin: float,
) -> TimeMap:  # fmt: skip
    """From a place on to ``factor`` of the planned speed; margin: part of the acceleration that is used."""
    build = MapBuilder()
    build.shift(place.planned)
    build.rest(place.tick - place.planned)
    ramp_to(build, planned, motors, machine, frequency, rate=place.rate, goal=float(factor), margin=margin)
    for begin, end in dwells(planned, frequency):
        build.slow(begin, factor)
        build.shift(min(planned.duration, end))
    build.slow(max(planned.duration, begin_of_end(planned)), factor)
    return build.done()


def changed(planned: StreamSection, section: StreamSection, change: Retiming, spacing: Spacing) -> StreamSection:
    """The section with a change; ValueError where its map does not fit the section."""
    times = change.times()
    at = int(np.searchsorted(times.target, change.asked, side="left"))
    if at >= len(times.target) or int(times.target[at]) != change.asked:
        raise ValueError("a change of the override starts at no breakpoint of its map")
    begin = int(times.source[at])
    room = _room(planned, section, change.asked)
    if room is None or not room[0] <= begin <= room[1]:
        raise ValueError(f"the planned tick {begin} is not where the section is at tick {change.asked}")
    later = TimeMap(times.source[at:] - begin, times.target[at:] - change.asked)
    events = {name: values.copy() for name, values in section.events.arrays.items()}
    count = int(np.searchsorted(section.events["tick"], change.asked, side="right"))
    rest = StreamSection(
        number=planned.number,
        start=planned.start,
        runs=tuple(_from(cut(runs, begin), begin) for runs in planned.runs),
        events=Columns(EVENT, {name: values[count:] for name, values in planned.events.arrays.items()}),
        duration=planned.duration - begin,
    )
    rest.events = Columns(EVENT, {**rest.events.arrays, "tick": rest.events["tick"] - begin})
    late = retime(rest, later, spacing)
    events["tick"][count:] = late.events["tick"] + change.asked
    runs = []
    for before, after in zip(section.runs, late.runs, strict=True):
        head, _, last = cut(before, change.asked)
        runs.append(join([head, _moved(after, change.asked - last)]))
    return replace(
        section, runs=tuple(runs), events=Columns(EVENT, events), duration=late.duration + change.asked
    )  # fmt: skip


def _from(parts: tuple[Columns, Columns, int], tick: int) -> Columns:
    """What is left of a motor's runs after a cut at ``tick``, counted from there."""
    return _moved(parts[1], parts[2] - tick)


def _moved(runs: Columns, by: int) -> Columns:
    """Runs whose first step, and so each, comes so many ticks later."""
    if not len(runs) or not by:
        return runs
    first = Columns(runs.schema, {name: values[:1].copy() for name, values in runs.arrays.items()})
    others = Columns(runs.schema, {name: values.copy() for name, values in runs.arrays.items()})
    others["interval"][0] += others["add"][0]
    others["count"][0] -= 1
    first["interval"][0] += by
    first["count"][0], first["add"][0] = 1, 0
    return join([first, others if int(others["count"][0]) else others.slice(1, len(others))])
