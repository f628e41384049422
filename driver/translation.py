"""A job for another controller: raised, legalised, printed, read again and compared.

``translate`` gives what was written and what is known of it; it writes no file.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from gproof.backend.emit.carried import carried
from gproof.backend.emit.printer import Unprintable
from gproof.driver.dialects import DIALECTS
from gproof.driver.errors import UsageError
from gproof.driver.session import Running, Session, open_session
from gproof.driver.targets import TARGETS
from gproof.driver.translation_machines import MachineTo, machine_to, require_source
from gproof.driver.translation_terms import (
    lengths_in_numbers,
    lengths_of,
    measured,
    only_local,
    own_guards,
    printed_lengths,
    rapid_rates,
    rapids_asked,
    same_travel,
    straight_rapids,
    with_lengths,
)
from gproof.driver.translation_traces import own_devices, trace_of
from gproof.ir import codes
from gproof.ir.dialects import rules_named
from gproof.ir.finding import Finding, Findings, Related, Severity, Span
from gproof.ir.job import Job, Remark, UseLength
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.program import NO_OUTPUTS, Program, SpindleOutputs
from gproof.ir.record import field, record
from gproof.ir.setup import NOTHING
from gproof.ir.target import Style, Target
from gproof.ir.trace import Trace
from gproof.ir.translation_map import NO_MAP, TranslationMap
from gproof.ir.translation_terms import SymbolMeaning, TranslationTerms
from gproof.ir.verdict import Verdict
from gproof.passes.legalize.by_map import Mapped, by_map
from gproof.passes.legalize.legalize import Legal, before_refusal, legalize
from gproof.passes.legalize.options import Lowered, Options
from gproof.passes.legalize.unset_variables import with_stated
from gproof.verify.translation.compare import compare
from gproof.verify.translation.comparison import Comparison, Divergence
from gproof.verify.translation.words import sentence

SHORT_LINE = 100
"""Characters below which a line has no room for them."""
SHORT_DECIMALS = 6
"""Decimals with ``exact`` then."""
ROUNDING = 1.02
"""Rounding of sums besides that of the printed digits."""
EXACT_DECIMALS = 12
"""Decimals with ``exact``: more than a double has of millimetres."""


@record(frozen=True, slots=True, kw_only=True)
class Wanted:
    """What to translate: the arguments of ``gproof translate``. to: a key of TARGETS; machine, machine_to: files that
    both must be there; given: a map, instead of the file ``map``; several: the map is that of several programs, so that
    an entry which this one does not need is no mistake; beside: files by name that others of the programs call: one
    that this program calls has another name, or is the same."""

    job: Path
    to: str
    machine: Path | None = None
    machine_to: Path | None = None
    setup: str | None = None
    dialect: str | None = None
    chord_tolerance: float = 0.01
    exact: bool = False
    map: Path | None = None
    given: TranslationMap | None = None
    partial: bool = False
    straight_rapids: bool = False
    several: bool = False
    beside: Mapping[str, bytes] = field(default_factory=dict)
    running: Running = Running()


@record(slots=True, kw_only=True)
class Translation:
    """How it went. verdict: SAFE where ``files`` is proven to be the same job; files: text by name, "" for the job's
    own, empty where it is refused; kept: how often the job has each feature that stays as it is; lowered: patterns
    used; comparison: None where nothing was compared; partial: the files end before the first construct that is
    refused; chord_tolerance: mm."""

    session: Session
    target: Target
    verdict: Verdict
    files: dict[str, bytes] = field(default_factory=dict)
    kept: dict[str, int] = field(default_factory=dict)
    lowered: list[Lowered] = field(default_factory=list)
    assumed: list[str] = field(default_factory=list)
    findings: Findings = field(default_factory=Findings)
    comparison: Comparison | None = None
    map: TranslationMap = NO_MAP
    partial: bool = False
    spare_used: bool = False
    chord_tolerance: float = 0.0
    lengths: dict[int, float] = field(default_factory=dict)
    only: dict[str, int] = field(default_factory=dict)

    @property
    def switched(self) -> bool:
        """Whether the position of the switch for optional stops is in the files."""
        return any(one.pattern == "optional stop -> what its switch says" for one in self.lowered)


def translate(wanted: Wanted) -> Translation:
    """UsageError (exit 3) for files that cannot be used at all."""
    if wanted.to not in TARGETS:
        raise UsageError(f"--to {wanted.to}: choose one of {', '.join(TARGETS)}")
    require_source(wanted.job, wanted.machine)
    to = machine_to(wanted.to, wanted.machine_to)
    session = open_session(wanted.job, machine=wanted.machine, setup=wanted.setup, dialect=wanted.dialect)
    entry = TARGETS[wanted.to]
    target = entry.target()
    done = Translation(
        session=session, target=target, verdict=Verdict.UNKNOWN, chord_tolerance=wanted.chord_tolerance
    )  # fmt: skip
    if session.program is None or any(finding.severity is Severity.ERROR for finding in _of_meaning(session)):
        for finding in session.findings.kept:
            done.findings.add(finding)
        return done
    if entry.adapted is not None:
        done.target = target = entry.adapted(target, to.machine, to.files, session.dialect)
    for construct in () if wanted.to == session.dialect else _stated_only(session):
        span, why = Span(str(wanted.job), 1), "the setup file states it, and no program switches it on there"
        done.findings.add(codes.NOT_TRANSLATED.at(span, construct=construct, target=target.title, why=why))
    if done.findings.kept:
        return done
    given = wanted.given or map_in(wanted.map)
    to = replace(to, machine=with_lengths(to.machine, given, wanted.map))
    legal = legal_job(session, target, to.machine, wanted, given)
    done.lowered, done.assumed, done.map = legal.lowered, list(legal.assumed), given
    done.spare_used, done.only, done.kept = legal.spare_used, legal.only, dict(legal.kept)
    done.lengths = legal.lengths | printed_lengths(legal.job, to.machine, target)
    for refused in legal.refused:
        tried = f"tried: {'; '.join(refused.tried)}" if refused.tried else ""
        done.findings.add(
            codes.NOT_TRANSLATED.at(
                refused.span, construct=refused.construct, target=target.title, why=refused.why, hint=tried
            )
        )
    if legal.refused and not wanted.partial:
        return done
    job = before_refusal(legal) if legal.refused else legal.job
    style = given.styled(target.style)
    if wanted.exact:
        most = SHORT_DECIMALS if 0 < style.line_length < SHORT_LINE else EXACT_DECIMALS
        style = replace(style, decimals_mm=most, decimals_inch=most, decimals_deg=most, decimals=most)
    done.partial = bool(legal.refused)
    try:
        done.files = _files(job, target, to.machine, style, wanted)
    except Unprintable as error:
        span = Span(str(wanted.job), 1)
        why = "it has no text for it"
        done.findings.add(codes.NOT_TRANSLATED.at(span, construct=str(error), target=target.title, why=why))
        return done
    if not done.partial:
        prove(done, to, wanted, style)
    return done


def _stated_only(session: Session) -> Iterator[str]:
    """What changes the path of the whole job on its own controller, and is in no line of it."""
    if session.setup.cylinder is not None:
        yield "Y mapped onto A"
    if session.setup.height_map is not None and session.setup.height_map.on:
        yield "height compensation"


def _files(job: Job, target: Target, machine: Machine, style: Style, wanted: Wanted) -> dict[str, bytes]:
    """The text of the files, under names that none has whose text is another; Unprintable."""
    there = {name.upper(): text for name, text in wanted.beside.items()}
    job = carried(job, style)
    while True:
        files = TARGETS[wanted.to].write(job, target, machine, style)
        clash = {name.upper() for name, text in files.items() if there.get(name.upper(), text) != text}
        if not clash - style.taken:
            return files
        style = replace(style, taken=style.taken | clash)


def _of_meaning(session: Session) -> list[Finding]:
    """Findings of the job besides its size, which only matters to the controller that it leaves."""
    return [finding for finding in session.findings.kept if finding.code is not codes.PROGRAM_TOO_LARGE]


def raised(session: Session) -> Job:
    """The neutral form of a session's program; UsageError where its language has none."""
    raising = DIALECTS[session.dialect].frontend.raise_program
    if raising is None or session.program is None:
        raise UsageError(f"{session.job}: {session.dialect} has no neutral form")
    return raising(session.program, session.machine, session.setup)


def map_in(path: Path | None) -> TranslationMap:
    """The map in a file; UsageError, with findings, for a bad one."""
    if path is None:
        return NO_MAP
    from gproof.driver.files import require_file
    from gproof.frontend.files.translation_map import load_translation_map

    require_file(path, "map file")
    findings = Findings()
    found = load_translation_map(path, findings)
    if found is None:
        raise UsageError(f"map file {path}: cannot be used, see the errors above", findings)
    return found


def legal_job(
    session: Session, target: Target, machine: Machine, wanted: Wanted, given: TranslationMap
) -> Legal:  # fmt: skip
    """The job as the target can have it; UsageError for an entry of the map that nothing needs."""
    mapped = _mapped(session, target, machine, wanted, given)
    if mapped.unused and not wanted.several:
        table, number = mapped.unused[0]
        raise UsageError(f"map file {wanted.map}: [{table}] {number}: nothing in {wanted.job} needs it")
    setup = session.setup
    values = {number: float(value) for number, value in setup.parameters.items()}
    options = Options(
        chord_tolerance=wanted.chord_tolerance, block_delete=setup.block_delete, values=values,
        coolant=given.coolant, tool_change=given.tool_change,
        axes=frozenset(name for name in AXIS_NAMES if session.machine.axis(name) and machine.axis(name)),
        optional_stop=setup.optional_stop, lengths=lengths_of(session, machine, given),
        measured_tools=rules_named(session.dialect).measured_tools,
        zeros_end_contours=rules_named(session.dialect).zeros_end_contours,
        straight_rapids=rapids_asked(session, target, machine, wanted.straight_rapids),
        rapid_rates=rapid_rates(machine),
    )  # fmt: skip
    job = mapped.job
    if wanted.to != session.dialect:
        job = with_stated(job, values, _users(session))
    return legalize(job, target, options)


def _mapped(session: Session, target: Target, machine: Machine, wanted: Wanted, given: TranslationMap) -> Mapped:
    """The job in the target's numbers."""
    same = wanted.to == session.dialect
    job = _without_lengths(raised(session), session, target)
    return by_map(job, given, target, machine, same=same, own=session.machine)


def unused_entries(wanted: Wanted, given: TranslationMap) -> set[tuple[str, int]]:
    """(table, number) of entries of a map that a job does not need; none where it cannot be read."""
    session = open_session(wanted.job, machine=wanted.machine, setup=wanted.setup, dialect=wanted.dialect)
    if session.program is None:
        return set()
    return set(_mapped(session, TARGETS[wanted.to].target(), session.machine, wanted, given).unused)


def _without_lengths(job: Job, session: Session, target: Target) -> Job:
    """A job of a language without tool lengths: where the target has them, none is in force from the start."""
    own = TARGETS.get(session.dialect)
    if own is None or "length" in own.target().legal or "length" not in target.legal:
        return job
    first = next((node.span for node in job.body if not isinstance(node, Remark)), Span(str(session.job), 1))
    place = next((n for n, node in enumerate(job.body) if not isinstance(node, Remark)), len(job.body))
    off = UseLength(on=False, span=first)
    return replace(job, body=(*job.body[:place], off, *job.body[place:]))


def prove(done: Translation, to: MachineTo, wanted: Wanted, style: Style) -> None:
    """Read what was printed, under the target's machine, and compare both traces."""
    session = done.session
    assert session.program is not None
    own = Findings()
    # Whatever inputs and answers the setup states: the proof is for all of them.
    stated = replace(session.setup, inputs={}, outputs={}, virtual={}, answers={})
    source = trace_of(
        own_devices(session.program, done.assumed), stated, session.machine, own, wanted.running, session,
        optional_stop=session.setup.optional_stop if done.switched else None, assumed=done.assumed,
    )  # fmt: skip
    if len(_of_meaning(session)) < len(session.findings.kept):
        done.assumed.append("the job means what it says, although its own controller does not load so much")
    for finding in (*_of_meaning(session), *own.kept):
        if finding.severity in {Severity.ERROR, Severity.UNKNOWN}:
            done.findings.add(finding)
    opened = [finding.span for finding in done.findings.kept if finding.severity is Severity.UNKNOWN]
    if session.setup.active_work is None:
        done.assumed.append("both programs start in the first work offset (G54), and without a local offset (G92)")
    if session.setup.positions:
        done.assumed.append("stored positions are where the setup file has them")
    if session.setup.parameters:
        done.assumed.append("variables that the job reads and does not set have the values of the setup file")
    read, machine = Findings(), to.machine
    if TARGETS[wanted.to].read is not None:
        target = _read_by_verify(done, machine, wanted)
        terms = terms_of(done, NO_OUTPUTS, session.machine, machine, wanted, style)
        _conclude(done, compare(source, target, terms), wanted, opened)
        return
    with tempfile.TemporaryDirectory() as folder:
        printed, machine = _read_back(done, to, wanted, Path(folder), read)
        if printed is None:
            _also(done, read, Path(folder))
            return
        if _takes_devices(done, printed):
            return
        setup = stated if wanted.to == session.dialect else NOTHING
        target = trace_of(
            own_devices(printed, done.assumed), setup, machine, read, wanted.running, session, assumed=done.assumed
        )
        _also(done, read, Path(folder))
        terms = terms_of(done, printed.spindle_outputs, session.machine, machine, wanted, style)
        comparison = compare(source, target, terms)
    _conclude(done, comparison, wanted, opened)


def _takes_devices(done: Translation, printed: Program) -> bool:
    """Whether an output of the job is, by the map, one that runs the spindle or coolant on the target: GP703."""
    own = printed.spindle_outputs
    channels = {*own.forward, *own.backward, *own.coolant} if done.session.dialect != done.target.name else set()
    for old, new in sorted(done.map.outputs.items()):
        if new in channels:
            span, what = Span(str(done.session.job), 1), f"output {old}"
            why = f"its output {new} runs the spindle or coolant: map it to another one"
            done.findings.add(codes.NOT_TRANSLATED.at(span, construct=what, target=done.target.title, why=why))
            done.files = {}
    return not done.files


def _conclude(done: Translation, comparison: Comparison, wanted: Wanted, opened: list[Span]) -> None:
    """Keep what the comparison says. opened: places of the source after which nobody knows what it does: a difference
    from there on says nothing of what was translated."""
    done.comparison = comparison
    for is_open, divergences in ((False, comparison.differences), (True, comparison.unknown)):
        for found in divergences:
            span, what = _span(found, wanted.job), sentence(found, is_open=is_open)
            is_later = any(one.file != span.file or one.line <= span.line for one in opened)
            code = codes.TRANSLATION_OPEN if is_open or is_later else codes.TRANSLATION_DIFFERS
            done.findings.add(replace(code.at(span, what=what), related=_printed_line(done, found)))
    done.assumed += [one for one in comparison.assumptions if one not in done.assumed]
    if done.findings.has(Severity.ERROR):
        done.verdict = Verdict.UNSAFE
    elif done.findings.has(Severity.UNKNOWN):
        done.verdict = Verdict.UNKNOWN
    else:
        done.verdict = comparison.verdict


def _read_by_verify(done: Translation, machine: Machine, wanted: Wanted) -> Trace:
    """What the printed program does, of a language without a front end."""
    read = TARGETS[wanted.to].read
    assert read is not None
    name = f"{wanted.job.stem}{done.target.style.extension}"
    back = read(done.files, name, machine, done.session.setup.active_work or 1)
    for line, why in back.unread:
        text = f"{name}, line {line}: the reader of {done.target.title} does not know {why}"
        done.findings.add(codes.TRANSLATION_OPEN.at(Span(str(wanted.job), 1), what=text))
    done.assumed += [one for one in back.assumed if one not in done.assumed]
    return back.trace


def _read_back(
    done: Translation, to: MachineTo, wanted: Wanted, folder: Path, findings: Findings
) -> tuple[Program | None, Machine]:
    """The program that was printed, as the target's front end reads it."""
    from gproof.frontend.common.frontend import Reading

    frontend = DIALECTS[wanted.to].frontend
    job = folder / f"{wanted.job.stem}{done.target.style.extension}"
    for name, text in done.files.items():
        (folder / name if name else job).write_bytes(text)
    return frontend.load_program(
        Reading(job=job, findings=findings, machine=to.machine, machine_file=to.files[0], read=to.files)
    )


def _also(done: Translation, findings: Findings, folder: Path) -> None:
    """Mistakes and unknowns of the printed program are those of the translation."""

    def named(span: Span) -> Span:
        return replace(span, file=span.file.removeprefix(f"{folder}/"))

    for finding in findings.kept:
        if finding.code == codes.PROGRAM_TOO_LARGE:
            span, what = Span(str(done.session.job), 1), "a program of this length"
            why = finding.message
            done.findings.add(codes.NOT_TRANSLATED.at(span, construct=what, target=done.target.title, why=why))
            done.files = {}
        elif finding.severity in {Severity.ERROR, Severity.UNKNOWN}:
            related = tuple(replace(one, span=named(one.span)) for one in finding.related)
            done.findings.add(replace(finding, span=named(finding.span), related=related))


def _span(found: Divergence, job: Path) -> Span:
    place = found.source or found.target
    return Span(str(job), 1) if place is None else Span(place[0], max(1, place[1]))


def _printed_line(done: Translation, found: Divergence) -> tuple[Related, ...]:
    """The line of what was printed, which may be in no file."""
    if found.target is None:
        return ()
    name, line = Path(found.target[0]).name, found.target[1]
    rows = done.files.get(name, done.files.get("", b"")).split(b"\n")
    text = rows[line - 1].decode("utf-8", "replace").strip() if 0 < line <= len(rows) else ""
    return (Related(Span(name, line), f"here the translation has: {text}"),)


def terms_of(
    done: Translation, outputs: SpindleOutputs, source: Machine, target: Machine, wanted: Wanted, style: Style
) -> TranslationTerms:
    """What both sides agree on."""
    own = done.session.program
    assert own is not None
    half = 0.5 * max(10.0**-style.decimals_mm, 25.4 * 10.0**-style.decimals_inch) * ROUNDING
    chords = any(one.pattern == "arc -> chords" for one in done.lowered)
    left_out = frozenset(
        name for name, had in (("path_mode", done.target.path_modes), ("guards", "guard" in done.target.legal),
            ("table", "frame_store" in done.target.legal),)
        if not had
    )  # fmt: skip
    given = done.map
    back = {new: old for old, new in given.tools.items()}
    spare = done.target.spare_offset if done.spare_used else 0
    asked = rapids_asked(done.session, done.target, target, wanted.straight_rapids)
    axes = frozenset(name for name in AXIS_NAMES if source.axis(name) and target.axis(name))
    return TranslationTerms(
        axes=axes,
        scratch=frozenset(f"work.{spare}.{axis}" for axis in AXIS_NAMES if spare),
        source=done.session.dialect, target=done.target.name, tolerance_mm=half + 1e-9,
        tolerance_deg=0.5 * 10.0**-style.decimals_deg * ROUNDING + 1e-9,
        chord_mm=wanted.chord_tolerance if chords else 0.0, feed_relative=1e-4, seconds=1e-4,
        source_outputs=own.spindle_outputs, target_outputs=outputs,
        source_straight=straight_rapids(source, own.rules.straight_traverse),
        target_straight=straight_rapids(target, done.target.straight_rapids),
        rapid_rates=tuple(sorted(rapid_rates(target).items())) if asked == "target" else (),
        outputs=tuple(sorted(given.outputs.items())), inputs=tuple(sorted(given.inputs.items())),
        tools=tuple(sorted(given.tools.items())),
        source_symbols=only_local(done.session.dialect, done.target.name)
        + measured(done.session.dialect, done.target.name, target, back)
        + lengths_in_numbers(done.lengths, back, done.target)
        + tuple(
            SymbolMeaning(symbol=f"work.{old}.{axis}", form=((f"work.{new}.{axis}", 1),))
            for old, new in given.offsets.items() for axis in AXIS_NAMES
        ),
        target_symbols=(
            *only_local(done.target.name, done.session.dialect, done.only),
            *measured(done.target.name, done.session.dialect, source, given.tools),
            *_lengths_in_zeros(done), *_parked(done),
        ),
        coolant=tuple(sorted(given.coolant.items())),
        rapids_assumed=not wanted.straight_rapids, left_out=left_out,
        guards=own_guards(done.session.dialect) & done.target.guards, machine_zero_shared=same_travel(source, target),
        tool_by_stop=given.tool_change == "stop",
        stops_on=done.switched and bool(done.session.setup.optional_stop),
        filter_left_out=any(one.feature == "path_filter" for one in done.lowered),
    )  # fmt: skip


def _lengths_in_zeros(done: Translation) -> tuple[SymbolMeaning, ...]:
    """Work zeros of a controller without tool lengths: a length that the job leaves as it is, is in them."""
    own = TARGETS.get(done.session.dialect)
    has_lengths = own is None or "length" in own.target().legal
    if not has_lengths or "length" in done.target.legal or any(one.feature == "length" for one in done.lowered):
        return ()
    return tuple(
        SymbolMeaning(symbol=f"work.{n}.z", form=(("tool.0.z", 1), (f"work.{n}.z", 1)))
        for n in range(1, done.target.offsets + 1)
    )


def _users(session: Session) -> tuple[range, ...]:
    """Numbers of the variables that programs of a language have for themselves, and that outlive them."""
    parameters = rules_named(session.dialect).parameters
    return tuple(range(one.first, one.last + 1) for one in parameters if one.kind in ("free", "persistent"))


def _parked(done: Translation) -> Iterator[SymbolMeaning]:
    """Parking places of a target without a front end: where those of the source are, as its setup states."""
    if done.target.name in DIALECTS:
        return
    for entry in rules_named(done.session.dialect).parameters:
        number = {"park_1": 1, "park_2": 2}.get(entry.kind)
        for column, axis in enumerate(AXIS_NAMES) if number else ():
            stated = done.session.setup.parameters.get(entry.first + column)
            if stated is not None:
                mm = stated * (done.session.machine.unit if column < 3 else 1.0)
                yield SymbolMeaning(symbol=f"park{number}.{axis}", mm=mm)
