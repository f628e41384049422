"""Running the checks of the policy over a job: one streaming pass, or two where block delete is open."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from gproof.driver.condition_feasibility import contradiction
from gproof.driver.running import begin as begin_run
from gproof.driver.session import Running, Session
from gproof.ir import codes
from gproof.ir.dialects.accepts import MANUALS
from gproof.ir.finding import AT_END, Finding, Findings, Related, Severity, Span
from gproof.ir.machine import Machine
from gproof.ir.prefetch import InOrder
from gproof.ir.record import field, record
from gproof.ir.setup import ZERO
from gproof.ir.symbols import describe
from gproof.ir.trace import Affine, Chunk, Frame, Op, Wait, verify_rows
from gproof.ir.verdict import DEFAULT_POLICY, Condition, PropertyResult, Verdict, worst
from gproof.passes.checks.arc_radius import ArcRadius
from gproof.passes.checks.base import Remains, apart, excluding
from gproof.passes.checks.first_moves import FirstMoves
from gproof.passes.checks.limits.guard_stretches import GuardStretches
from gproof.passes.checks.limits.soft_limits import Limits
from gproof.passes.checks.limits.work_boundaries import Boundaries
from gproof.passes.checks.registry import added_checks, decided
from gproof.passes.checks.zones.zone_check import Hears
from gproof.passes.checks.zones.zones import Areas
from gproof.passes.interpret.core.open_settings import note
from gproof.passes.interpret.core.outcomes import Outcomes
from gproof.passes.interpret.core.run import Run
from gproof.passes.motion.knife_axis import follow_knife
from gproof.passes.motion.plan import MotionEstimate

_LEAVES_THE_PATH_OPEN = (
    codes.MAPPED_AXIS, codes.HEIGHT_MAP_UNKNOWN, codes.KNIFE_UNKNOWN,
)  # fmt: skip
"""Unknowns that the limits report, and that leave open for every property where the tool goes; settings that are not
followed (GP605) say themselves what they leave open."""

Observer = Callable[[Chunk], None]
Beat = Callable[[int, Span], None]


@record(slots=True, kw_only=True)
class Summary:
    """Figures of a job. box: (axis, relative to "" or unknown offsets, low, high), mm or degrees;
    seconds: estimated time without waits, None without machine data; at_least: some moves are not in it;
    branches: outcomes of unknown conditions that were followed: with some, lengths are those of all of them together
    and the time is not known; ``begin``, ``end``: machine position before and after the job by axis, mm or degrees, NaN
    where it is not known, end empty where it has several; extents: the box with columns and forms; unit: mm
    in the first unit that the job names, None: none; remains: of stock, where somebody watches the job (``observe``)
    and it has one end; open_path: some finding leaves open where the tool goes, so that nothing is proved."""

    lines: int = 0
    blocks: int = 0
    sections: int = 1
    path_length: float = 0.0
    feed_length: float = 0.0
    seconds: float | None = None
    at_least: bool = False
    branches: int = 0
    begin: dict[str, float] = field(default_factory=dict)
    end: dict[str, float] = field(default_factory=dict)
    unit: float | None = None
    remains: tuple[Remains, ...] = ()
    box: list[tuple[str, str, float, float]] = field(default_factory=list)
    extents: list[tuple[int, Affine, float, float]] = field(default_factory=list)
    open_path: bool = False


@record(slots=True, kw_only=True)
class Judgement:
    """The answer of ``check``: the verdict of the policy, each property, assumptions of the whole.

    accepted: findings that a comment or a baseline accepts, each with how (SARIF's word) and the reason; left_out:
    properties that are answered and that the policy does not require: the verdict says nothing of them; strict: those
    that are UNKNOWN only because their SAFE would have conditions.
    """

    verdict: Verdict
    properties: list[PropertyResult]
    assumptions: list[str]
    summary: Summary
    findings: Findings
    accepted: dict[Finding, tuple[str, str]] = field(default_factory=dict)
    left_out: tuple[str, ...] = ()
    strict: tuple[str, ...] = ()


def judge(
    session: Session, *, running: Running, properties: Sequence[str] = DEFAULT_POLICY, strict: bool = False,
    observe: Observer | None = None, beat: Beat | None = None, hears: Hears | None = None,
) -> Judgement:  # fmt: skip
    """Judge the job; ``observe`` sees every chunk of the first pass.

    properties: those that the verdict requires; the others of the default policy are answered too.
    beat: hears from time to time how many blocks are executed, and where, chunks or none; hears: takes what rests on
    unknown offsets near zones, in all passes (``passes/checks/zones/zones.py``): of that ``areas`` says nothing then.
    """
    findings = session.findings
    _machine_findings(session)
    if session.program is None:
        results = [PropertyResult(name="language", verdict=_language(findings))]
        others = (*DEFAULT_POLICY[1:], *(n for n in properties if n not in DEFAULT_POLICY and decided(n)))
        results += [PropertyResult(name=n, verdict=Verdict.UNKNOWN) for n in others]
        return Judgement(
            verdict=worst(r.verdict for r in results if r.name in properties), properties=results, assumptions=[],
            summary=Summary(), findings=findings,
        )  # fmt: skip
    setting = session.setup.block_delete
    results, summary, assumed, met, _ = _pass(
        session, findings, bool(setting), running, properties, observe, beat, hears
    )  # fmt: skip
    if met and setting is None:
        other = Findings(limit=findings.limit, stated=findings.stated)
        second, switched, more, _, later = _pass(session, other, True, running, properties, None, beat, hears)
        summary.extents += switched.extents
        summary.open_path |= switched.open_path
        summary.remains = ()
        results = [_both(session, findings, a, b, later) for a, b in zip(results, second, strict=True)]
        findings.join(other)
        assumed += [a for a in more if a not in assumed]
        assumed.append("checked with block delete off and on")
    results = _after_language(results, _language(findings))
    conditional = tuple(r.name for r in results if r.conditions and r.verdict is Verdict.SAFE) if strict else ()
    results = [dataclasses.replace(r, verdict=Verdict.UNKNOWN) if r.name in conditional else r for r in results]
    verdict = worst(r.verdict for r in results if r.name in properties)
    return Judgement(
        verdict=verdict, properties=results, assumptions=assumed, summary=summary, findings=findings,
        strict=conditional,
    )  # fmt: skip


def in_spite_of(
    session: Session, judgement: Judgement, errors: Iterable[Finding], *, running: Running,
    properties: Sequence[str] = DEFAULT_POLICY, beat: Beat | None = None,
) -> list[Finding]:  # fmt: skip
    """What is found besides where these errors are accepted: the job is run with what their lines changed lost.

    After an error nothing is reported that depends on its line, as no controller comes there; who accepts it does.
    """
    accepted = frozenset((finding.code.number, finding.span) for finding in errors)
    if session.program is None or not accepted or not judgement.summary.open_path:
        return []
    seen = {(finding.code.number, finding.span) for finding in judgement.findings.kept}
    found: dict[tuple[int, Span], Finding] = {}
    stated = session.setup.block_delete
    for block_delete in (False, True) if stated is None else (stated,):
        other = Findings(limit=judgement.findings.limit, stated=session.findings.stated)
        *_, met, _ = _pass(
            session, other, block_delete, running, properties, None, beat, None, accepted
        )  # fmt: skip
        for finding in other.kept:
            if (finding.code.number, finding.span) not in seen:
                found.setdefault((finding.code.number, finding.span), finding)
        if not met:
            break
    return list(found.values())


@record(slots=True, kw_only=True)
class _Course:
    """Where a job starts and ends, what it waits for and which unit it names first, as its chunks go by."""

    machine: Machine
    sections: int = 0
    waits: set[Wait] = field(default_factory=set)
    begin: dict[str, float] = field(default_factory=dict)
    ends: list[dict[str, float]] = field(default_factory=list)
    unit: float | None = None

    def feed(self, chunk: Chunk) -> None:
        """Some successive rows."""
        frames = chunk.trace.frames
        self.begin = self.begin or _places(self.machine, chunk.start, frames[chunk.start_frame])
        if chunk.last and any(edge.target < 0 for edge in chunk.edges):
            last = len(chunk.rows) - 1
            at = chunk.start if last < 0 else tuple(chunk.rows["to"][last].tolist())
            frame = chunk.start_frame if last < 0 else int(chunk.rows["frame"][last])
            self.ends.append(_places(self.machine, at, frames[frame]))
        if self.unit is None and (named := np.flatnonzero(chunk.rows["op"] == Op.UNITS)).size:
            self.unit = float(chunk.rows["arg"][int(named[0]), 0])
        self.waits.update(edge.wait for edge in chunk.edges)
        self.sections += chunk.last

    @property
    def end(self) -> dict[str, float]:
        """Where the job ends; empty where it has several ends or none."""
        return self.ends[0] if len(self.ends) == 1 else {}


class _Checks:
    """The checks of one pass: those of the default policy, and what ``properties`` requires in addition."""

    def __init__(
        self, session: Session, run: Run, findings: Findings, properties: Sequence[str], hears: Hears | None
    ) -> None:  # fmt: skip
        assert session.program is not None
        machine, setup = session.machine, session.setup
        self.session, self.findings = session, findings
        self.limits = Limits(machine, setup, findings)
        stated = machine.controller.straight_traverse
        straight = session.program.rules.straight_traverse if stated is None else stated
        self.areas = Areas(
            machine, setup, findings, straight=straight,
            zero=run.modal.zero_at_start, hears=hears,
        )  # fmt: skip
        self.arcs = ArcRadius(machine, setup, findings)
        self.edges = Boundaries(machine, setup, findings)
        # Of a state of its own, which the run does not change.
        start = run.dialect.first_state(session.program, setup, machine)
        self.added = added_checks(properties, session.program, machine, setup, findings, start.zero_at_start)

    def feed(self, chunk: Chunk) -> None:
        """Some successive rows."""
        for check in (self.limits, self.areas, self.arcs, self.edges, *self.added):
            check.feed(chunk)

    def finish(self, firsts: FirstMoves) -> list[PropertyResult]:
        """The answer of each property, those of several checks put together."""
        session, findings = self.session, self.findings
        fits = _together(session, findings, self.limits.finish(), self.edges.finish(), firsts)
        self.areas.given(fits.conditions)
        results = [fits, self.areas.finish(), self.arcs.finish()]
        for name, answers in itertools.groupby((check.finish() for check in self.added), key=lambda one: one.name):
            answer, *more = answers
            for other in more:
                answer = _both(session, findings, answer, other, firsts, f"the checks of {name}")
            results.append(answer)
        return results


def _pass(
    session: Session, findings: Findings, block_delete: bool, running: Running, properties: Sequence[str],
    observe: Observer | None, beat: Beat | None, hears: Hears | None,
    accepted: frozenset[tuple[int, Span]] = frozenset(),
) -> tuple[list[PropertyResult], Summary, list[str], bool, FirstMoves]:  # fmt: skip
    assert session.program is not None
    machine, setup = session.machine, session.setup
    run = begin_run(
        session.program, setup, machine, findings, block_delete=block_delete, accepted=accepted,
        **session.options(running),
    )  # fmt: skip
    run.on_beat = beat
    checks = _Checks(session, run, findings, properties, hears)
    stretches = GuardStretches(machine, findings)
    estimate = MotionEstimate(machine)
    timed = InOrder(estimate.feed)
    outcomes, firsts, course = Outcomes(), FirstMoves(), _Course(machine=machine)
    session.program.verify()
    for chunk in follow_knife(run.chunks(), machine, findings):
        verify_rows(chunk.rows, chunk.trace, f"section {chunk.section}")
        course.feed(chunk)
        outcomes.feed(chunk, forked=bool(run.asked))
        firsts.feed(chunk)
        with findings.within(chunk.section):
            checks.feed(chunk)
            run.settings.feed(chunk)
            stretches.feed(chunk)
        timed(chunk, len(chunk.rows))
        if observe is not None:
            observe(chunk)
    findings.section = AT_END
    timed.wait()
    estimate.finish()
    stretches.finish()
    results = checks.finish(firsts)
    findings.section = None
    outcomes.name(findings, run.asked, session.program)
    noted = [one for one in machine.not_modelled if not one.axis and not one.touches]
    noted += [*run.settings.noted, *checks.limits.noted]
    open_path = run.refused or any(code.number in findings.counts for code in _LEAVES_THE_PATH_OPEN)
    results = [_not_proved(r) if open_path or any(one.opens(r.name) for one in noted) else r for r in results]
    open_path = open_path or any(one.opens("areas") for one in noted)
    language = PropertyResult(name="language", verdict=_language(findings))
    summary = Summary(
        lines=session.program.line_count, blocks=run.blocks - run.charged, sections=max(1, course.sections),
        path_length=estimate.path_length_mm, feed_length=estimate.feed_length_mm,
        seconds=None if run.branches else estimate.seconds, branches=run.branches,
        at_least=estimate.unknown_rows > 0, box=checks.limits.box(), extents=checks.limits.extents(),
        begin=course.begin, end=course.end, unit=course.unit, open_path=bool(open_path),
        remains=tuple(left for check in checks.added for left in check.remains())
        if observe and len(course.ends) == 1
        else (),
    )  # fmt: skip
    assumed = [
        *_taken_as_zero(session, run.modal.zero_lengths),
        *session.program.assumed,
        *run.assumed,
        *_standing(session, course.waits),
    ]
    return [language, *results], summary, assumed, run.met_deleted, firsts


def _taken_as_zero(session: Session, lengths: Iterable[int]) -> list[str]:
    """What the setup zero says of a machine that it was not made for, lengths of tools by name."""
    if session.setup.name != ZERO.name:
        return []
    said = ["setup zero: homed, at machine position 0, no offsets, parameters 0, tool 0"]
    if tools := ", ".join(f"T{number}" for number in sorted(lengths)):
        said.append(f"setup zero: length 0 for {tools}, which are in no tool table")
    return said


def _places(machine: Machine, at: Sequence[float], frame: Frame) -> dict[str, float]:
    """A position by axis; NaN where it rests on something unknown."""
    return {axis.word.lower(): math.nan if frame[axis.index] else float(at[axis.index]) for axis in machine.axes}


def _standing(session: Session, waits: set[Wait]) -> list[str]:
    """What every answer about positions depends on."""
    out = []
    homed = session.setup.homed
    if homed is None and session.machine_given:
        names = " ".join(axis.word for axis in session.machine.axes)
        out.append(f"{names} are homed: machine positions are what the controller shows")
    version = session.machine.controller.version
    manual = MANUALS.get(session.dialect, "")
    if version and not f"{version}.".startswith(f"{manual.rpartition(' ')[2]}."):
        out.append(f"the controller, version {version}, works as the {manual} says")
    if waits & {Wait.OPERATOR, Wait.TOOL_CHANGE}:
        out.append("nobody moves the axes while the job waits for the operator")
    return out


def _language(findings: Findings) -> Verdict:
    if findings.has(Severity.ERROR, ("language", "files")):
        return Verdict.UNSAFE
    if findings.has(Severity.UNKNOWN, ("language", "files")):
        return Verdict.UNKNOWN
    return Verdict.SAFE


def _after_language(results: list[PropertyResult], language: Verdict) -> list[PropertyResult]:
    """What was judged on a trace that the language leaves open is not proved."""
    rest = results[1:] if language is Verdict.SAFE else [_not_proved(r) for r in results[1:]]
    return [dataclasses.replace(results[0], verdict=language), *rest]


def _not_proved(result: PropertyResult) -> PropertyResult:
    """A property on a trace that is not the whole path: what was found stays, SAFE does not."""
    if result.verdict is not Verdict.SAFE:
        return result
    return dataclasses.replace(result, verdict=Verdict.UNKNOWN, conditions=())


def _together(
    session: Session, findings: Findings, limits: PropertyResult, edges: PropertyResult, firsts: FirstMoves
) -> PropertyResult:
    """What soft limits and boundaries ask of unknown offsets, which both hold at once.

    GP303 where what each needs for certain excludes the other; GP304 where only their conditions do: at the later one
    of two moves that exclude each other.
    """
    needed = (*limits.needed, *edges.needed)
    missed = contradiction(needed) if limits.needed and edges.needed else 0.0
    told = findings.has(Severity.ERROR, ("limits",))
    fits = _both(session, findings, limits, edges, firsts, "limits and boundaries", refuted=bool(missed))
    if missed and not told:
        names = " and ".join(
            dict.fromkeys(describe(((symbol, 1),), session.machine) for c in needed for symbol, _ in c.terms)
        )
        asked = [
            f"{what}: {_range(session, c)}" for what, r in (("limits", limits), ("boundaries", edges)) for c in r.needed
        ]
        hint = "change one of them: soft limits and boundaries contradict each other; " + ", ".join(asked)
        where, _, related = _apart(session, limits.needed, edges.needed, firsts)
        findings.add(
            codes.NO_SAFE_OFFSET.at(where, name=names, extent=missed, unit="mm", room=0.0, hint=hint, related=related)
        )
        return dataclasses.replace(fits, verdict=Verdict.UNSAFE, conditions=())
    if not missed and fits.verdict is Verdict.SAFE and contradiction(fits.conditions):
        names = " and ".join(describe(c.terms, session.machine) for c in fits.conditions)
        cause = f"no values of {names} suit both limits and boundaries"
        where, hint, related = _apart(session, limits.conditions, edges.conditions, firsts)
        findings.add(codes.POSITION_UNKNOWN.at(where, axis="the job", cause=cause, hint=hint, related=related))
        return dataclasses.replace(fits, verdict=Verdict.UNKNOWN)
    return fits


def _apart(
    session: Session, ours: Sequence[Condition], theirs: Sequence[Condition], firsts: FirstMoves
) -> tuple[Span, str, tuple[Related, ...]]:
    """Where conditions of two checks exclude each other: at the later of the two moves that miss each other most."""
    one_sided = [
        [c for whole in several for c in _sides(whole) if math.isfinite(c.low) or math.isfinite(c.high)]
        for several in (ours, theirs)
    ]
    most, pair = 0.0, None
    for a, b in itertools.product(*one_sided):
        missed = contradiction((a, b))
        most, pair = (missed, (a, b)) if missed > most else (most, pair)
    everything = (*ours, *theirs)
    otherwise = _begins(session, tuple(term for c in everything for term in c.terms), firsts)
    if pair is None:
        return otherwise, "", ()
    one, other = ((_place(side), _range(session, side)) for side in pair)
    return excluding(one, other, otherwise)


def _sides(condition: Condition) -> tuple[Condition, Condition]:
    """What a condition asks below and above."""
    below, above = condition.places
    return (
        dataclasses.replace(condition, high=math.inf, places=(below, None)),
        dataclasses.replace(condition, low=-math.inf, places=(None, above)),
    )


def _place(side: Condition) -> Span | None:
    return side.places[0] or side.places[1]


def _begins(session: Session, terms: Affine, firsts: FirstMoves) -> Span:
    """The first move that rests on these; of a job without moves its first line."""
    return firsts.of_terms(terms) or Span(str(session.job), 1)


def _unit(session: Session, condition: Condition) -> str:
    """That of the axis whose offsets a condition is about."""
    names = {symbol.rpartition(".")[2] for symbol, _ in condition.terms}
    return next((axis.unit for axis in session.machine.axes if axis.name in names), "mm")


def _range(session: Session, condition: Condition) -> str:
    ends = [
        f"{side} {value + 0.0:.4f} {_unit(session, condition)}"
        for side, value in (("at least", condition.low), ("at most", condition.high))
        if math.isfinite(value)
    ]
    return f"{describe(condition.terms, session.machine)} {' and '.join(ends)}"


def _both(
    session: Session, findings: Findings, a: PropertyResult, b: PropertyResult, firsts: FirstMoves,
    what: str = "the block delete switch", *, refuted: bool = False,
) -> PropertyResult:  # fmt: skip
    """One property under two settings of a switch, or by two checks: both must hold, for the same offsets.

    firsts: moves of the second one; refuted: that they exclude each other is reported already.
    """
    verdict = worst((a.verdict, b.verdict))
    assumptions = a.assumptions + tuple(x for x in b.assumptions if x not in a.assumptions)
    ranges: dict[Affine, Condition] = {}
    for c in (*a.conditions, *b.conditions):
        ranges[c.terms] = c.within(ranges[c.terms]) if c.terms in ranges else c
    conditions = tuple(ranges.values())
    for c in conditions:
        if c.empty and not refuted:
            both = f"both settings of {what}" if what == "the block delete switch" else f"all of {what}"
            cause = f"no value of {describe(c.terms, session.machine)} suits {both}"
            unit = _unit(session, c)
            where, hint, related = apart(c, session.machine, unit, _begins(session, c.terms, firsts))
            if a.name == "areas":
                findings.add(codes.TOOL_CHANGE_AREA_UNKNOWN.at(where, cause=cause, hint=hint, related=related))
            else:
                findings.add(codes.POSITION_UNKNOWN.at(where, axis="the job", cause=cause, hint=hint, related=related))
            verdict = worst((verdict, Verdict.UNKNOWN))
    conditions = tuple(c for c in conditions if not c.empty)
    return PropertyResult(name=a.name, verdict=verdict, assumptions=assumptions, conditions=conditions)


def _machine_findings(session: Session) -> None:
    for setting in session.machine.not_modelled:
        if not setting.axis and not setting.touches:
            note(setting, session.machine, session.findings)
