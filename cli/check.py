"""``gproof check``: findings, then a verdict for each property and the figures of the job."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

import click

from gproof.cli.judge import NOT_JUDGED, Judgement, judge
from gproof.cli.report import coloured, finding_json, print_findings
from gproof.cli.session import Session, open_session
from gproof.ir.codes import CODES
from gproof.ir.trace import Chunk
from gproof.ir.verdict import Condition, Verdict
from gproof.passes.values import describe

SCHEMA = "gproof-check/1"
_SHADES = {Verdict.SAFE: "green", Verdict.UNSAFE: "red", Verdict.UNKNOWN: "magenta"}


def run_check(
    job: Path, *, machine: Path | None, setup: str | None, dialect: str | None, max_blocks: int, form: str,
    strict: bool, picture: Path | None,
) -> int:  # fmt: skip
    """Judge a job, print the report, write the picture; returns the exit code."""
    session = open_session(job, machine=machine, setup=setup, dialect=dialect)
    drawing = None
    if picture is not None:
        from gproof.cli.picture import Drawing

        drawing = Drawing(session.machine)
    progress = progress_bar(session)
    observe = _observers(progress, drawing.add if drawing is not None else None)
    try:
        judgement = judge(session, budget=max_blocks, strict=strict, observe=observe)
    finally:
        if progress is not None:
            progress.stop()
    if drawing is not None and picture is not None:
        drawing.write(picture, session, judgement)
    if form == "json":
        click.echo(json.dumps(report_json(session, judgement), indent=2, ensure_ascii=False))
    else:
        print_findings(judgement.findings)
        print_summary(session, judgement)
    return judgement.verdict.exit_code


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
        if not len(chunk.rows) or time.monotonic() - self.began < 1.0:
            return
        if self.bar is None:
            from rich.console import Console
            from rich.progress import Progress as Bar

            bar = Bar(console=Console(stderr=True), transient=True)
            self.bar, self.task = bar, bar.add_task("checking", total=self.lines)
            bar.start()
        self.bar.update(self.task, completed=int(chunk.rows["line"][-1]))  # type: ignore[attr-defined]

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
    """``G54 X offset in 12.4 ... 230.1``."""
    return f"{describe(condition.terms)} in {condition.low:.4f} ... {condition.high:.4f}"


def print_summary(session: Session, judgement: Judgement) -> None:
    """Verdicts with their assumptions, and the figures, lined up."""
    colour = coloured()

    def shade(verdict: Verdict) -> str:
        text = f"{verdict.value:<8}"
        return click.style(text, fg=_SHADES[verdict], bold=True) if colour else text

    if judgement.findings.kept:
        click.echo()
    summary = judgement.summary
    click.echo(f"{session.job}: {shade(judgement.verdict).rstrip()}")
    click.echo(f"  dialect    {session.dialect} ({session.dialect_reason})")
    click.echo(f"  machine    {session.machine.name}")
    for result in judgement.properties:
        first = True
        details = [condition_text(c) for c in result.conditions if not _is_start(c)]
        for detail in details or [""]:
            label, verdict = (result.name, shade(result.verdict)) if first else ("", " " * 8)
            click.echo(f"  {label:<10} {verdict} {detail and 'for ' + detail}".rstrip())
            first = False
    click.echo(f"  not judged {', '.join(NOT_JUDGED)}")
    for text in [*judgement.assumptions, *(a for r in judgement.properties for a in r.assumptions)]:
        click.echo(f"  assuming   {text}")
    click.echo(f"  lines      {summary.lines}, {summary.blocks} blocks executed, {summary.sections} section(s)")
    if summary.box:
        click.echo(f"  path       {summary.path_length:.1f} mm, of which {summary.feed_length:.1f} mm at feed")
        for axis, relative, low, high in summary.box:
            unit = "mm" if axis in "xyz" else "deg"
            beside = f" + {relative}" if relative else ""
            click.echo(f"  box {axis.upper()}      {low:.3f} ... {high:.3f} {unit}{beside}")
        click.echo(f"  time       {duration_text(summary.seconds, summary.at_least)}")


def _is_start(condition: Condition) -> bool:
    return len(condition.terms) == 1 and condition.terms[0][0].startswith("start.")


def duration_text(seconds: float | None, at_least: bool) -> str:
    """``3 min 12 s``, or why it is not known."""
    if seconds is None:
        return "not known: the machine file gives no velocities and accelerations"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    text = (
        f"{hours} h {minutes} min {rest} s" if hours else f"{minutes} min {rest} s" if minutes else f"{seconds:.1f} s"
    )
    return f"about {text} without waits" + (", at least" if at_least else "")


def report_json(session: Session, judgement: Judgement) -> dict[str, object]:
    """The stable JSON report; docs/check-json.md defines it."""
    summary = judgement.summary
    return {
        "schema": SCHEMA,
        "job": str(session.job),
        "dialect": {"name": session.dialect, "reason": session.dialect_reason},
        "machine": session.machine.name if session.machine_given else None,
        "setup": session.setup.name,
        "verdict": judgement.verdict.value,
        "properties": {
            r.name: {
                "verdict": r.verdict.value,
                "assumptions": list(r.assumptions),
                "conditions": [
                    {
                        "text": condition_text(c),
                        "terms": [{"symbol": s, "coefficient": k} for s, k in c.terms],
                        "low": c.low,
                        "high": c.high,
                    }
                    for c in r.conditions
                ],
            }
            for r in judgement.properties
        },
        "not_judged": list(NOT_JUDGED),
        "assumptions": judgement.assumptions,
        "findings": [finding_json(f) for f in sorted(judgement.findings.kept, key=_by_place)],
        "counts": {CODES[n].label: count for n, count in sorted(judgement.findings.counts.items())},
        "summary": {
            "lines": summary.lines,
            "blocks": summary.blocks,
            "sections": summary.sections,
            "path_length_mm": summary.path_length,
            "feed_length_mm": summary.feed_length,
            "seconds": summary.seconds,
            "seconds_at_least": summary.at_least,
            "box": [{"axis": a, "relative_to": rel, "low": lo, "high": hi} for a, rel, lo, hi in summary.box],
        },
    }


def _by_place(finding: object) -> tuple[str, int, int, int]:
    from gproof.cli.report import sort_key

    return sort_key(finding)  # type: ignore[arg-type]
