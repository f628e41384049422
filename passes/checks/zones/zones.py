"""The property ``areas``: the tool change area while its guard is on, the keep-out zones of machine and setup, and how
high Z is before a tool is changed.

Each zone is judged by itself (``zone_check``); conditions on unknown offsets hold together with one another and with
those of the limits.
"""

from __future__ import annotations

from collections.abc import Callable

from gproof.ir.finding import Findings, Severity
from gproof.ir.machine import NO_MACHINE, Area, Machine
from gproof.ir.setup import Setup
from gproof.ir.symbolic import NOWHERE, Position
from gproof.ir.symbols import describe
from gproof.ir.trace import Chunk, Op
from gproof.ir.verdict import Condition, PropertyResult, Verdict
from gproof.passes.checks.base import Check, inward
from gproof.passes.checks.tooling.tip_position import OWN_LENGTH, rests_on_length_in_force, rotary_axes
from gproof.passes.checks.zones.approach_order import Clearance
from gproof.passes.checks.zones.face_conditions import Ranges
from gproof.passes.checks.zones.tool_profile import CUTTER, Told, most_parts
from gproof.passes.checks.zones.zone_check import Hears, ZoneCheck
from gproof.passes.geometry.height_map import heights_of
from gproof.passes.geometry.off_path import NO_TOLERANCE, blends_by_nothing

Zeros = Callable[[int, int], Position]
"""Where a coordinate system has its zero when the job starts, local offsets included, by number and axis."""


ROTARY = "rotary axes turn the work; the tool and keep-out zones in machine coordinates do not turn with it"


class Areas(Check):
    """See the module's text.

    straight: whether a traverse of several axes is a straight line on this controller, None: not known; zero: of the
    coordinate systems, for zones that count from one; hears: gets the rows whose places rest on something unknown, of
    which the answer then says nothing.
    """

    name = "areas"

    def __init__(
        self, machine: Machine, setup: Setup, findings: Findings, *, straight: bool | None = True,
        zero: Zeros | None = None, hears: Hears | None = None,
    ) -> None:  # fmt: skip
        super().__init__(machine, setup, findings)
        heights = heights_of(setup.height_map)
        self._zones: list[ZoneCheck] = []

        def check(area: Area, *, change: bool = False, part: int = CUTTER, told: Told | None = None) -> None:
            self._zones.append(
                ZoneCheck(
                    area, machine, setup, findings, heights=heights, straight=straight, origin=_origin(area, zero),
                    change=change, hears=hears, part=part, told=told,
                )
            )  # fmt: skip

        if machine.tool_change_area is not None:
            check(machine.tool_change_area, change=True)
        self._kept = (*machine.keep_out, *setup.keep_out)
        parts = 1 + most_parts(machine.tools)
        for area in self._kept:
            told = Told() if parts > 1 else None
            for part in range(parts):
                check(area, part=part, told=told)
        self._clearance = Clearance(machine, setup, findings)
        self._homed = self._own_length = self._blends = self._turns = False
        self._rotary = rotary_axes(machine) if self._kept else []
        self._states = 0
        self._given: Ranges = {}

    def given(self, conditions: tuple[Condition, ...]) -> None:
        """Conditions that hold anyway (those of the limits), so that the answer does not contradict them."""
        self._given = {c.terms: (c.low, c.high) for c in conditions}

    def feed(self, chunk: Chunk) -> None:
        """Findings for each line of the job that enters a zone."""
        if self._zones and not self._homed and self.machine.tool_change_area is not None:
            self._homed = bool((chunk.rows["op"] == Op.HOME).any())
        if self._kept and not self._own_length:
            self._own_length = any(map(rests_on_length_in_force, chunk.trace.states[self._states :]))
        if not self._turns and len(chunk.rows):
            self._turns = any((chunk.rows["to"][:, axis] != chunk.start[axis]).any() for axis in self._rotary)
        if self._kept:
            new = chunk.trace.states[self._states :]
            self._blends = self._blends or any(map(blends_by_nothing, new))
            self._states = len(chunk.trace.states)
        for zone in self._zones:
            zone.feed(chunk)
        self._clearance.feed(chunk)

    def finish(self) -> PropertyResult:
        """SAFE (with conditions where offsets are unknown), UNSAFE, or UNKNOWN."""
        asked: dict[tuple[tuple[str, int], ...], Condition] = {}
        parts: list[Clearance | ZoneCheck] = [self._clearance, *self._zones]
        for part in parts:
            if not any(one.errors for one in parts):
                for condition in part.conditions(self._given):
                    asked[condition.terms] = condition
                    self._given[condition.terms] = condition.low, condition.high
        errors = sum(part.errors for part in parts)
        conditions = tuple(asked[terms] for terms in sorted(asked))
        verdict = Verdict.SAFE
        if errors:
            verdict = Verdict.UNSAFE
        elif any(zone.is_open for zone in self._zones) or self.findings.has(Severity.UNKNOWN, (self.name,)):
            verdict = Verdict.UNKNOWN
        return PropertyResult(
            name=self.name, verdict=verdict, assumptions=tuple(self._assumptions(conditions)), conditions=conditions
        )

    def _assumptions(self, conditions: tuple[Condition, ...]) -> list[str]:
        out = [
            f"{describe(c.terms, self.machine)} is between {inward(c.low, c.high, ' and ')} mm (machine coordinates)"
            for c in conditions
            if len(c.terms) == 1 and c.terms[0][0].startswith("start.")
        ]
        if self.machine.tool_change_area is None:
            nothing = self.machine.name == NO_MACHINE.name
            out.append(
                "without a machine file no tool change area is known"
                if nothing
                else "the machine file gives no tool change area"
            )
        elif self._homed:
            out.append("homing moves stay out of the tool change area")
        if self._kept:
            out.append("tools in keep-out zones are as wide as in the tool table, with its shanks and holders")
            if self._turns and any(not area.work for area in self._kept):
                out.append(ROTARY)
            if self._blends:
                out.append(NO_TOLERANCE)
            if self._own_length:
                out.append(OWN_LENGTH)
            if self.machine.settings.smoothing:
                out.append("corners that the controller rounds do not reach a keep-out zone")
            if any(axis.vertical and axis.index > 2 for axis in self.machine.axes):
                out.append("keep-out zones are checked for the head of X, Y and Z only")
        return out


def _origin(area: Area, zero: Zeros | None) -> tuple[Position, Position, Position] | None:
    if not area.work:
        return None
    if zero is None:
        return NOWHERE, NOWHERE, NOWHERE
    return zero(area.work, 0), zero(area.work, 1), zero(area.work, 2)
