"""``gproof check``: findings, then a verdict for each property and the figures of the job."""

from __future__ import annotations

import contextlib
import io
import json
import math
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import click

from gproof.cli.files import require_picture, require_place, write_text
from gproof.cli.jobs import find_jobs, is_several
from gproof.cli.judge import NOT_JUDGED, Judgement, judge
from gproof.cli.lengths import CHOICES, MM, LengthUnit, unit_of
from gproof.cli.main import UsageError
from gproof.cli.many import How, judge_all, print_text, with_progress
from gproof.cli.outcome import Outcome, closing_line, exit_code
from gproof.cli.report import coloured, distinct, finding_json, print_findings
from gproof.cli.session import Running, Session, open_session
from gproof.ir.codes import CODES, SYNTAX
from gproof.ir.finding import Span
from gproof.ir.machine import Axis
from gproof.ir.trace import UNKNOWN, Affine, Chunk
from gproof.ir.verdict import Condition, Verdict
from gproof.passes.values import describe

SCHEMA = "gproof-check/1"
SCHEMA_OF_SEVERAL = "gproof-check-several/1"
_NOWHERE = describe(UNKNOWN)
_SHADES = {Verdict.SAFE: "green", Verdict.UNSAFE: "red", Verdict.UNKNOWN: "magenta"}


def run_check(
    names: Sequence[str], *, machine: Path | None, setup: str | None, dialect: str | None, running: Running, form: str,
    strict: bool, picture: Path | None, units: str | None, output: Path | None, quiet: bool, workers: int | None,
    exclude: Sequence[str],
) -> int:  # fmt: skip
    """Judge jobs, print or write the report in ``units``, write the picture; returns the exit code."""
    if output is not None:
        require_place(output, "report", (*names, machine, setup))
    if form in ("text", "json") and not is_several(names) and not exclude:
        with _into(output):
            return _check_one(
                Path(names[0]), machine=machine, setup=setup, dialect=dialect, running=running, form=form,
                strict=strict, picture=picture, units=units, quiet=quiet,
            )  # fmt: skip
    if picture is not None:
        raise UsageError("--picture is drawn of one program, not of several jobs or a report for other programs")
    if running.call is not None and is_several(names):
        raise UsageError("--call judges a subprogram of one program")
    return _check_several(
        names, machine=machine, setup=setup, dialect=dialect, output=output, workers=workers, exclude=exclude,
        how=How(running=running, strict=strict, form=form, units=units, quiet=quiet, tty=output is None and coloured()),
    )  # fmt: skip


def _check_several(
    names: Sequence[str], *, machine: Path | None, setup: str | None, dialect: str | None, output: Path | None,
    workers: int | None, exclude: Sequence[str], how: How,
) -> int:  # fmt: skip
    jobs = find_jobs(names, machine=machine, setup=setup, dialect=dialect, exclude=exclude)
    outcomes = with_progress(judge_all(jobs, how, workers), len(jobs))
    if how.form == "text":
        with _into(output):
            kept = print_text(outcomes)
            if len(kept) > 1:
                click.echo(closing_line(kept))
        return exit_code(kept)
    kept = list(outcomes)
    for outcome in kept:
        if outcome.problem:
            click.echo(f"gproof: error: {outcome.problem}", err=True)
    with _into(output):
        click.echo(_document(kept, how.form))
    return exit_code(kept)


def _document(outcomes: list[Outcome], form: str) -> str:
    if form == "sarif":
        from gproof.cli.sarif import sarif

        return sarif(outcomes)
    if form == "junit":
        from gproof.cli.junit import junit

        return junit(outcomes)
    if form == "github":
        from gproof.cli.github import workflow_commands

        return workflow_commands(outcomes)
    if form == "markdown":
        from gproof.cli.markdown import markdown

        return markdown(outcomes)
    answers = [
        outcome.report if outcome.report is not None else {"job": outcome.job, "problem": outcome.problem}
        for outcome in outcomes
    ]
    counts = dict.fromkeys(("SAFE", "UNSAFE", "UNKNOWN", "not_judged"), 0)
    for outcome in outcomes:
        counts[outcome.verdict.value if outcome.verdict else "not_judged"] += 1
    return json.dumps({"schema": SCHEMA_OF_SEVERAL, "counts": counts, "jobs": answers}, indent=2, ensure_ascii=False)


@contextlib.contextmanager
def _into(output: Path | None) -> Iterator[None]:
    """What is printed inside goes to a file, whole or not at all."""
    if output is None:
        yield
        return
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        yield
    write_text(output, text.getvalue(), "report")


def _check_one(
    job: Path, *, machine: Path | None, setup: str | None, dialect: str | None, running: Running, form: str,
    strict: bool, picture: Path | None, units: str | None, quiet: bool,
) -> int:  # fmt: skip
    if picture is not None:
        require_place(picture, "picture", (job, machine, setup))
        require_picture(picture)
    session = open_session(job, machine=machine, setup=setup, dialect=dialect, call=running.call)
    drawing = None
    if picture is not None:
        from gproof.cli.picture import Drawing

        drawing = Drawing(session.machine)
    progress = progress_bar(session)
    observe = _observers(progress, drawing.add if drawing is not None else None)
    try:
        beat = None if progress is None else progress.beat
        judgement = judge(session, running=running, strict=strict, observe=observe, beat=beat)
    finally:
        if progress is not None:
            progress.stop()
    if drawing is not None and picture is not None:
        drawing.write(picture, session, judgement)
    if form == "json":
        click.echo(json.dumps(report_json(session, judgement), indent=2, ensure_ascii=False))
    elif quiet:
        print_brief(session, judgement, units, quiet=True)
    else:
        print_summary(session, judgement, findings=True, unit=None if units is None else CHOICES[units])
    return judgement.verdict.exit_code


def print_brief(session: Session, judgement: Judgement, units: str | None, *, quiet: bool) -> None:
    """One of several jobs: findings other than notes, its verdict, and what a SAFE rests on; quiet: the verdict."""
    unit = unit_of_report(session, judgement) if units is None else CHOICES[units]
    if not quiet:
        print_findings(judgement.findings, unit=unit, notes=False)
    click.echo(f"{session.job}: {_shade(judgement.verdict)}")
    if quiet or judgement.verdict is not Verdict.SAFE:
        return
    bounds: dict[Affine, tuple[float, float]] = {}
    for condition in (c for r in judgement.properties for c in r.conditions if not _is_start(c)):
        low, high = bounds.get(condition.terms, (-math.inf, math.inf))
        bounds[condition.terms] = max(low, condition.low), min(high, condition.high)
    parts = [_condition_parts(Condition(terms=terms, low=a, high=b), unit) for terms, (a, b) in bounds.items()]
    width = max((len(name) for name, _ in parts), default=0)
    for name, ends in parts:
        click.echo(f"  if {name:<{width}} is {ends}")


def _shade(verdict: Verdict) -> str:
    return click.style(verdict.value, fg=_SHADES[verdict], bold=True) if coloured() else verdict.value


def _observers(progress: Progress | None, draw: Callable[[Chunk], None] | None) -> Callable[[Chunk], None] | None:
    parts = [f for f in (progress, draw) if f is not None]
    if not parts:
        return None

    def observe(chunk: Chunk) -> None:
        for part in parts:
            part(chunk)

    return observe


class Progress:
    """A bar on standard error for jobs that take longer than a second, by source line."""

    def __init__(self, lines: int) -> None:
        self.lines = lines
        self.began = time.monotonic()
        self.bar: object = None
        self.task: object = None

    def __call__(self, chunk: Chunk) -> None:
        """Move the bar to the chunk's last line."""
        if len(chunk.rows) and self._is_long():
            self.bar.update(self.task, completed=int(chunk.rows["line"][-1]))  # type: ignore[attr-defined]

    def beat(self, blocks: int, span: Span) -> None:
        """A loop goes round: tell where, and how many blocks that has come to."""
        if self._is_long():
            told = f"checking, {blocks:,} blocks executed"
            self.bar.update(self.task, completed=span.line, description=told)  # type: ignore[attr-defined]

    def _is_long(self) -> bool:
        """Whether there is a bar by now."""
        if time.monotonic() - self.began < 1.0:
            return False
        if self.bar is None:
            from rich.console import Console
            from rich.progress import Progress as Bar

            bar = Bar(console=Console(stderr=True), transient=True)
            self.bar, self.task = bar, bar.add_task("checking", total=self.lines)
            bar.start()
        return True

    def stop(self) -> None:
        """Take the bar away."""
        if self.bar is not None:
            self.bar.stop()  # type: ignore[attr-defined]


def progress_bar(session: Session) -> Progress | None:
    """A bar when standard error is a terminal and the job is long."""
    if session.program is None or not sys.stderr.isatty() or os.environ.get("CI"):
        return None
    return Progress(session.program.line_count)


def condition_text(condition: Condition) -> str:
    """``G54 X offset is 12.4000 ... 230.1000 mm``; bounds are rounded inwards."""
    name, bounds = _condition_parts(condition, MM)
    return f"{name} is {' '.join(bounds.split())}"


def _condition_parts(condition: Condition, length: LengthUnit) -> tuple[str, str]:
    """Name and bounds, the bounds in columns."""
    axis = condition.terms[0][0].rpartition(".")[2] if condition.terms else "x"
    own = "deg" if axis in "abc" else "mm"
    low = length.inward(condition.low, own, up=True) if math.isfinite(condition.low) else None
    high = length.inward(condition.high, own, up=False) if math.isfinite(condition.high) else None
    unit = length.named(own)
    if low is None or high is None:
        side = f"at least {low}" if low is not None else f"at most {high}" if high is not None else "anything, in"
        return describe(condition.terms), f"{side} {unit}"
    return describe(condition.terms), f"{low:>9} ... {high:>9} {unit}"


def unit_of_report(session: Session, judgement: Judgement) -> LengthUnit:
    """The unit of the machine file, or without one that of the job."""
    named = session.machine.unit if session.machine_given else judgement.summary.unit
    return unit_of(session.machine.unit if named is None else named)


def _looks_otherwise(session: Session) -> None:
    """A line for a job with syntax errors whose text or folder speaks for another controller than it was read for."""
    from gproof.frontend.guess import guess_dialect

    dialect, reason = guess_dialect(session.job)
    if dialect != session.dialect and " in " in reason:
        _row("", f"the job looks like one for {dialect}: {reason}")


def print_summary(
    session: Session, judgement: Judgement, *, findings: bool = False, unit: LengthUnit | None = None
) -> None:
    """Verdicts with their conditions, what they stand on, then the figures of the job, lined up; findings: before them.

    unit: None: that of the machine file, or without one that of the job.
    """
    if unit is None:
        unit = unit_of_report(session, judgement)
    if findings:
        print_findings(judgement.findings, unit=unit)
    if judgement.findings.kept:
        click.echo()
    click.echo(f"{session.job}: {_shade(judgement.verdict)}")
    for result in judgement.properties:
        parts = [_condition_parts(c, unit) for c in result.conditions if not _is_start(c)]
        parts = parts if result.verdict is Verdict.SAFE else []
        width = max((len(name) for name, _ in parts), default=0)
        first = _shade(result.verdict) + " " * (9 - len(result.verdict.value))
        for n, detail in enumerate([f"if {name:<{width}} is {bounds}" for name, bounds in parts] or [""]):
            _row("" if n else result.name, (" " * 9 if n else first) + detail)
    _row("not judged", ", ".join(NOT_JUDGED))
    assumed = [*judgement.assumptions, *(a for r in judgement.properties for a in r.assumptions)]
    _rows("assuming", [unit.sentence(one) for one in dict.fromkeys(assumed)])
    _row("machine", session.machine.name)
    _row("dialect", f"{session.dialect} ({session.dialect_reason})")
    if judgement.findings.counts.get(SYNTAX.number):
        _looks_otherwise(session)
    if session.program is not None:
        _figures(session, judgement, unit)


def _row(label: str, text: str) -> None:
    click.echo(f"  {label:<10}  {text}".rstrip())


def _rows(label: str, texts: list[str]) -> None:
    for n, text in enumerate(texts):
        _row("" if n else label, text)


def _figures(session: Session, judgement: Judgement, unit: LengthUnit) -> None:
    summary = judgement.summary
    blocks, sections = _count(summary.blocks, "block"), _count(summary.sections, "section")
    ways = f", {summary.branches} outcomes of unknown conditions followed" if summary.branches else ""
    _row("program", f"{_count(summary.lines, 'line')}, {blocks} executed in {sections}{ways}")
    reaches = [r for r in summary.box if not (r[1].startswith("the start position") and r[2] == r[3])]
    _rows("reaches", _lined_up([_reach(session, unit, *r) for r in reaches]))
    moving = {axis for axis, *_ in summary.box}
    for label, places in (("begins", summary.begin), ("ends", summary.end)):
        shown = [
            f"{axis.upper()} {_place(session, unit, axis, value)}" for axis, value in places.items() if axis in moving
        ]
        if shown:
            _row(label, ", ".join(shown))
    if summary.box:
        _row("path", f"{unit.path(summary.path_length)}, {unit.path(summary.feed_length)} of it at feed")
        if summary.branches:
            _row("time", "not known: the way depends on inputs; the path is that of all outcomes together")
        else:
            _row("time", duration_text(summary.seconds, summary.at_least, session.machine_given))


def _reach(session: Session, length: LengthUnit, axis: str, relative: str, low: float, high: float) -> tuple[str, ...]:
    """The cells of one line: axis, range, what to compare it with."""
    if relative == _NOWHERE:
        return axis.upper(), "", "", f"{'and ' if low != high else ''}somewhere that is not known"
    known = _axis(session, axis)
    own = _counts_in(known, axis)
    beside = f"from {relative}" if relative else ""
    if not relative and known is not None and session.machine_given:
        beside = f"(limits {_limit(known.lower, own, length)} ... {_limit(known.upper, own, length)})"
    return axis.upper(), length.place(low, own), f"{length.place(high, own)} {length.named(own)}", beside


def _axis(session: Session, letter: str) -> Axis | None:
    return next((one for one in session.machine.axes if one.word.lower() == letter), None)


def _counts_in(known: Axis | None, letter: str) -> str:
    return known.unit if known is not None else "mm" if letter in "xyz" else "deg"


def _place(session: Session, length: LengthUnit, letter: str, value: float) -> str:
    return "not known" if math.isnan(value) else length.place(value, _counts_in(_axis(session, letter), letter))


def _limit(value: float | None, own: str, length: LengthUnit) -> str:
    return "not given" if value is None else f"{length.of(value, own):.4f}".rstrip("0").rstrip(".")


def _lined_up(cells: list[tuple[str, ...]]) -> list[str]:
    wide = [max((len(row[k]) for row in cells), default=0) for k in range(3)]
    return [
        f"{axis} {low:>{wide[1]}} {'...' if low else '   '} {high:>{wide[2]}}  {beside}".rstrip()
        for axis, low, high, beside in cells
    ]


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _is_start(condition: Condition) -> bool:
    return len(condition.terms) == 1 and condition.terms[0][0].startswith("start.")


def duration_text(seconds: float | None, at_least: bool, machine_given: bool = True) -> str:
    """``about 3 min 12 s``, or why it is not known."""
    if seconds is None:
        missing = "the machine file gives no velocities and accelerations" if machine_given else "no machine file"
        return f"not known: {missing}"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    text = f"{seconds:.1f} s"
    if hours or minutes:
        text = f"{hours} h {minutes} min" if hours else f"{minutes} min {rest} s"
    return f"{'at least' if at_least else 'about'} {text}, waits not counted"


def report_json(session: Session, judgement: Judgement) -> dict[str, object]:
    """The stable JSON report; docs/check-json.md defines it."""
    summary = judgement.summary
    return {
        "schema": SCHEMA,
        "job": str(session.job),
        "dialect": {"name": session.dialect, "reason": session.dialect_reason},
        "machine": session.machine.name if session.machine_given else None,
        "setup": session.setup.name,
        "inputs": [{"file": name, "sha256": digest, "role": role} for name, digest, role in session.inputs],
        "verdict": judgement.verdict.value,
        "properties": {
            r.name: {
                "verdict": r.verdict.value,
                "assumptions": list(r.assumptions),
                "conditions": [
                    {
                        "text": condition_text(c),
                        "terms": [{"symbol": s, "coefficient": k} for s, k in c.terms],
                        "low": _finite(c.low),
                        "high": _finite(c.high),
                    }
                    for c in r.conditions
                ],
            }
            for r in judgement.properties
        },
        "not_judged": list(NOT_JUDGED),
        "assumptions": judgement.assumptions,
        "findings": [finding_json(f, times) for f, times in distinct(judgement.findings)],
        "counts": {CODES[n].label: count for n, count in sorted(judgement.findings.counts.items())},
        "summary": {
            "lines": summary.lines,
            "blocks": summary.blocks,
            "begin": {axis: _finite(value) for axis, value in summary.begin.items()},
            "end": {axis: _finite(value) for axis, value in summary.end.items()},
            "sections": summary.sections,
            "branches": summary.branches,
            "path_length_mm": _finite(summary.path_length),
            "feed_length_mm": _finite(summary.feed_length),
            "seconds": _finite(summary.seconds),
            "seconds_at_least": summary.at_least,
            "box": [
                {"axis": axis, "relative_to": relative, "low": _finite(low), "high": _finite(high)}
                for axis, relative, low, high in summary.box
            ],
        },
    }


def _finite(value: float | None) -> float | None:
    """JSON has no infinities."""
    return value if value is not None and math.isfinite(value) else None
