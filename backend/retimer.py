"""Retimings that passed the validator: feed override and feed hold of a job's sections.

Each proposal is validated before anyone may send it; when it fails, steps on their exact ticks and then
gentler ramps are tried.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

import numpy as np

from gproof.backend.feed_hold import MARGINS, hold
from gproof.backend.override_change import change_map, changed, place_of
from gproof.backend.record_data import Retiming
from gproof.backend.retime import Spacing, retime, slow_map
from gproof.backend.section_run import Prepared
from gproof.backend.time_map import MapBuilder, TimeMap
from gproof.ir.machine import Machine
from gproof.ir.stream import Motor, StreamSection

Accept = Callable[[StreamSection], bool]


class Retimer:
    """For one stream on one machine; ``accept`` asks the validator about a section."""

    def __init__(self, motors: tuple[Motor, ...], machine: Machine, tick_frequency: int, accept: Accept) -> None:
        self.motors = motors
        self.machine = machine
        self.tick_frequency = tick_frequency
        self.accept = accept

    def override(self, section: StreamSection, factor: Fraction) -> Prepared | None:
        """The section at ``factor`` of its speed; None when the validator refuses it."""
        times = slow_map(section, self.tick_frequency, factor)
        for exact in (False, True):
            source, target = _lists(times)
            retiming = Retiming(kind="override", factor=str(factor), exact=exact, source=source, target=target)
            found = self._made(section, times, retiming)
            if found is not None:
                return found
        return None

    def change(
        self, planned: StreamSection, section: StreamSection, before: Sequence[Retiming], tick: int, factor: Fraction
    ) -> Prepared | None:
        """From ``tick`` on at ``factor`` of the planned speed; before: what made the section of the planned one.

        None when there is no such place, or the validator refuses every ramp.
        """
        place = place_of(planned, section, before, tick)
        if place is None:
            return None
        for margin in MARGINS:
            times = change_map(planned, self.motors, self.machine, self.tick_frequency, place, factor, margin)
            source, target = _lists(times)
            for exact in (False, True):
                retiming = Retiming(
                    kind="change", factor=str(factor), asked=place.tick, exact=exact, source=source, target=target
                )
                late = changed(
                    planned, section, retiming, Spacing.of(self.machine, self.tick_frequency, exact=exact)
                )  # fmt: skip
                if self.accept(late):
                    return Prepared(late, retiming)
        return None

    def hold(self, section: StreamSection, tick: int, rest: int) -> Prepared | None:
        """A feed hold from ``tick`` on; None when the validator refuses every ramp."""
        for margin in MARGINS:
            for exact in (False, True):
                found = self._held(section, tick, rest, (margin, exact))
                if found is not None:
                    return found
        return None

    def rest(self, section: StreamSection, ticks: Sequence[int], rest: int) -> Prepared | None:
        """The section with a rest after each of the ticks, at which nothing moves; None when the validator refuses."""
        build = MapBuilder()
        for tick in ticks:
            build.shift(tick)
            build.rest(rest)
        times = build.done()
        source, target = _lists(times)
        at = int(times.at(np.array([ticks[0]], dtype=np.int64))[0])
        retiming = Retiming(
            kind="hold", asked=ticks[0], rest_begins=at, rest=rest, exact=True, source=source, target=target
        )
        return self._made(section, times, retiming)

    def _held(self, section: StreamSection, tick: int, rest: int, way: tuple[float, bool]) -> Prepared | None:
        margin, exact = way
        made = hold(section, self.motors, self.machine, self.tick_frequency, tick=tick, rest=rest, margin=margin)
        source, target = _lists(made.times)
        retiming = Retiming(
            kind="hold",
            asked=tick,
            rest_begins=made.rest_begins,
            rest=rest,
            exact=exact,
            source=source,
            target=target,
        )
        found = self._made(section, made.times, retiming)
        if found is None:
            return None
        return Prepared(found.section, found.retiming, lambda longer: self._held(section, tick, longer, way))

    def _made(self, section: StreamSection, times: TimeMap, retiming: Retiming) -> Prepared | None:
        late = retime(section, times, Spacing.of(self.machine, self.tick_frequency, exact=retiming.exact))
        return Prepared(late, retiming) if self.accept(late) else None


def _lists(times: TimeMap) -> tuple[tuple[int, ...], tuple[int, ...]]:
    return tuple(times.source.tolist()), tuple(times.target.tolist())
