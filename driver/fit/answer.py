"""Where the zero may go: from judgements of a job to ranges of its work offsets and the machine that it needs.

Takes the judgement of the job with its offsets open, and of the job as it was stated; gives plain data, which text
and JSON reports print. Millimetres and degrees. Nothing is guessed: where the open job is not proved, no range is
given; what prevents an answer stays as findings.
"""

from __future__ import annotations

import dataclasses
import math

from gproof.driver.condition_feasibility import contradiction
from gproof.driver.fit.open_offsets import Asked
from gproof.driver.fit.zones import Beside, ZoneWatch, agree, beside
from gproof.driver.judge import Judgement
from gproof.ir import codes
from gproof.ir.finding import Severity
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.record import field, record
from gproof.ir.setup import Interval
from gproof.ir.symbols import describe
from gproof.ir.trace import UNKNOWN, Affine
from gproof.ir.verdict import DEFAULT_POLICY, Condition, Verdict

SLACK = 1e-9
"""mm or degrees by which a stated offset may be past an end: what the checks allow to arithmetic."""


@record(frozen=True, slots=True, kw_only=True)
class Range:
    """What one offset, or a sum of several, must lie between. now: what was stated; unit: mm or deg."""

    terms: Affine
    low: float
    high: float
    now: Interval | None
    unit: str = "mm"

    @property
    def name(self) -> str:
        """In the words of a machinist, ``G54 X``."""
        return describe(self.terms).replace(" offset", "")

    @property
    def short(self) -> float:
        """How far the zero has to be moved at least: above 0 up, below 0 down, 0 where it is fine."""
        if self.now is None:
            return 0.0
        if self.now.low < self.low - SLACK:
            return self.low - self.now.low
        return self.high - self.now.high if self.now.high > self.high + SLACK else 0.0

    @property
    def fits(self) -> bool | None:
        """Whether the given value is within the range; None: none is given."""
        return None if self.now is None else self.short == 0.0

    @property
    def move(self) -> tuple[float, float] | None:
        """By how much the stated offset may be changed, from and to; None where nothing was, or no change helps."""
        if self.now is None or self.low - self.now.low > self.high - self.now.high:
            return None
        return self.low - self.now.low, self.high - self.now.high


@record(frozen=True, slots=True, kw_only=True)
class Fit:
    """The answer of ``gproof fit``.

    verdict: of the job with what was stated, or, where nothing was, whether there are offsets. kind: ``ranges``: every
    value inside is SAFE; ``regions``: in the ranges, those are that lie in a region of each of ``zones`` as well;
    ``none``: no offsets are; ``unknown``. complete: outside nothing is SAFE. now: the verdict of the stated offsets,
    None where none were; open_sides: axes that no limit holds, as reported; zones: where sums may be together;
    reason: why there is no range, where no finding says it; assumed: about an unknown start.
    """

    verdict: Verdict
    kind: str
    ranges: tuple[Range, ...] = ()
    complete: bool = True
    now: Verdict | None = None
    open_sides: tuple[str, ...] = field(default=())
    zones: tuple[Beside, ...] = ()
    reason: str = ""
    assumed: str = ""


def fit_of(
    machine: Machine, asked: Asked, open_job: Judgement, stated: Judgement | None, watch: ZoneWatch
) -> Fit:  # fmt: skip
    """The answer.

    stated: the judgement of the offsets as they were stated, None where none were; watch: has heard the open job.
    """
    verdicts = {result.name: result.verdict for result in open_job.properties if result.name in DEFAULT_POLICY}
    now = None if stated is None else stated.verdict
    unlimited = _only_limits_missing(open_job, verdicts)
    if Verdict.UNSAFE in verdicts.values():
        return Fit(verdict=now or Verdict.UNSAFE, kind="none", now=now)
    nothing = Fit(verdict=now or Verdict.UNKNOWN, kind="unknown", now=now)
    if not unlimited and any(verdict is not Verdict.SAFE for verdict in verdicts.values()):
        return nothing
    found = _ranges(machine, asked, open_job)
    if found is None:
        return nothing
    places = watch.places({one.terms: (one.low, one.high) for one in found}, _starts(open_job))
    if places is None:
        return dataclasses.replace(nothing, reason="moves that do not depend on work offsets may enter a zone")
    taken = [place for place in places if place.region.empty]
    names = " and ".join(dict.fromkeys(zone for place in taken for zone in place.zones))
    if any(place.region.hopeless for place in taken):
        reason = f"no work offset keeps all moves out of {names}"
        return Fit(verdict=now or Verdict.UNSAFE, kind="none", now=now, reason=reason)
    if taken:
        return dataclasses.replace(nothing, reason=f"no work offset was found that keeps all moves out of {names}")
    if places and not agree(places, {one.terms: (one.low, one.high) for one in found}):
        return dataclasses.replace(nothing, reason="no offsets were found that suit all zones and limits at once")
    complete = asked.setup.height_map is None and asked.setup.cylinder is None
    return Fit(
        verdict=now or (Verdict.UNKNOWN if unlimited else Verdict.SAFE), kind="regions" if places else "ranges",
        ranges=found, now=now, assumed=watch.assumed,
        complete=complete and not watch.assumed and all(place.region.resolution is not None for place in places),
        open_sides=unlimited, zones=tuple(beside(place, asked) for place in places),
    )  # fmt: skip


def _starts(judgement: Judgement) -> dict[Affine, tuple[float, float]]:
    """The bounds that are assumed for an unknown start."""
    found = (c for result in judgement.properties for c in result.conditions)
    return {c.terms: (c.low, c.high) for c in found if len(c.terms) == 1 and c.terms[0][0].startswith("start.")}


def _only_limits_missing(judgement: Judgement, verdicts: dict[str, Verdict]) -> tuple[str, ...]:
    """What the findings say of limits that are not given, if only these prevent an answer; otherwise ()."""
    if any(verdict is not Verdict.SAFE for name, verdict in verdicts.items() if name != "limits"):
        return ()
    unknown = [f for f in judgement.findings.kept if f.severity is Severity.UNKNOWN]
    if any(f.code.number != codes.LIMIT_UNKNOWN.number for f in unknown):
        return ()
    return tuple(dict.fromkeys(f.message for f in unknown))


def _ranges(machine: Machine, asked: Asked, judgement: Judgement) -> tuple[Range, ...] | None:
    """Ranges that hold together; None where they exclude each other, or other unknowns, as stated, leave none."""
    units = {axis.name: axis.unit for axis in machine.axes}
    rooms: dict[Affine, tuple[float, float]] = {}
    for condition in (c for result in judgement.properties for c in result.conditions):
        if condition.terms[0][0].startswith("start.") and len(condition.terms) == 1:
            continue  # the assumptions of the judgement say it
        terms, low, high = _solved(condition, asked)
        before = rooms.get(terms, (-math.inf, math.inf))
        rooms[terms] = max(before[0], low), min(before[1], high)
    for _, form, _, _ in judgement.summary.extents:
        terms, _, _ = _solved(Condition(terms=form, low=0.0, high=0.0), asked)
        if any(asked.is_open(symbol) for symbol, _ in terms):
            rooms.setdefault(terms, (-math.inf, math.inf))
    conditions = [Condition(terms=terms, low=low, high=high) for terms, (low, high) in rooms.items()]
    if any(c.low > c.high + 2 * SLACK for c in conditions) or contradiction(conditions):
        return None
    return tuple(
        Range(
            terms=terms, low=min(low, high), high=max(low, high), now=asked.interval(terms),
            unit=units.get(_axis(terms), "mm" if _axis(terms) in "xyz" else "deg"),
        )
        for terms, (low, high) in sorted(rooms.items(), key=lambda item: _place(item[0]))
    )  # fmt: skip


def _solved(condition: Condition, asked: Asked) -> tuple[Affine, float, float]:
    """The condition on the open offsets alone, for all values of what else is given; never on a negative alone."""
    own = tuple(term for term in condition.terms if asked.is_open(term[0]))
    rest = tuple(term for term in condition.terms if not asked.is_open(term[0]))
    known = asked.interval(rest) if own and rest else None
    terms, low, high = condition.terms, condition.low, condition.high
    if known is not None:
        terms, low, high = own, low - known.low, high - known.high
    if all(count < 0 for _, count in terms):
        terms, low, high = tuple((symbol, -count) for symbol, count in terms), -high, -low
    return terms, low, high


def _axis(terms: Affine) -> str:
    return terms[0][0].rpartition(".")[2] if terms else "x"


def _place(terms: Affine) -> tuple[object, ...]:
    """Sorted as a machinist reads: coordinate systems one after the other, in each the axes."""
    names = [symbol.split(".") for symbol, _ in terms]
    axis = AXIS_NAMES.index(names[0][-1]) if names[0][-1] in AXIS_NAMES else len(AXIS_NAMES)
    return tuple(sorted(".".join(parts[:-1]) for parts in names)), axis, terms


# -- what the job needs of a machine


@record(frozen=True, slots=True, kw_only=True)
class Travel:
    """What one motor has to reach. relative: () for machine coordinates, else the offsets that it moves with.

    low, high: of the motor, backlash and pitch table included; limits: what the machine gives it, None: not given.
    bends: a pitch table would add to it, and where is not known.
    """

    motor: str
    axis: str
    unit: str
    relative: Affine
    low: float
    high: float
    limits: tuple[float | None, float | None]
    bends: bool = False

    @property
    def size(self) -> float:
        """How long the travel is."""
        return self.high - self.low


def travel_of(machine: Machine, asked: Asked, judgement: Judgement) -> tuple[Travel, ...] | None:
    """What each motor needs, by what it is relative to; None where the job is not followed to its end."""
    from gproof.passes.geometry.motor_limits import needed

    language = next(result for result in judgement.properties if result.name == "language")
    if language.verdict is not Verdict.SAFE or not _followed(judgement):
        return None
    out: list[Travel] = []
    for index in sorted({index for index, *_ in judgement.summary.extents}):
        axis = machine.axis(AXIS_NAMES[index])
        if axis is None:
            return None
        parts: dict[Affine, tuple[float, float]] = {}
        for column, form, low, high in judgement.summary.extents:
            if column != index:
                continue
            known = asked.interval(form)
            if known is not None:
                form, low, high = (), low + known.low, high + known.high
            before = parts.get(form, (math.inf, -math.inf))
            parts[form] = min(before[0], low), max(before[1], high)
        begin = judgement.summary.begin.get(axis.word.lower(), math.nan)
        if () in parts and not math.isnan(begin):
            parts[()] = min(parts[()][0], begin), max(parts[()][1], begin)
        parts = {form: ends for form, ends in parts.items() if not _only_start(form, ends)}
        for drive in axis.drives():
            for form, (low, high) in sorted(parts.items()):
                ends = needed(drive, low, high, placed=form == ())
                out.append(
                    Travel(
                        motor=axis.word + drive.name[len(axis.name) :], axis=axis.word, unit=axis.unit, relative=form,
                        low=ends[0], high=ends[1], limits=(drive.lower, drive.upper),
                        bends=drive.pitch is not None and form != (),
                    )
                )  # fmt: skip
    return tuple(out)


def _followed(judgement: Judgement) -> bool:
    return not any(form == UNKNOWN for _, form, _, _ in judgement.summary.extents)


def _only_start(form: Affine, ends: tuple[float, float]) -> bool:
    """The axis is where it was: nothing that a machine must have additional room for."""
    return bool(form) and all(symbol.startswith("start.") for symbol, _ in form) and ends[0] == ends[1]


def smallest(travel: tuple[Travel, ...]) -> dict[str, float]:
    """By motor the shortest travel with which some zero does: the longest of what moves together."""
    out: dict[str, float] = {}
    for one in travel:
        out[one.motor] = max(out.get(one.motor, 0.0), one.size)
    return out
