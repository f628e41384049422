"""Findings as text with the source line and a caret, in the shape of compilers; colours on a terminal only."""

from __future__ import annotations

import os
import sys

import click

from gproof.driver.escape import in_one_line
from gproof.driver.source_text import source_lines
from gproof.ir.codes import CODES
from gproof.ir.finding import Finding, Findings, Rests, Severity, Span, brief, distinct
from gproof.report.grouping import Accepted, left_over, shown
from gproof.report.units import MM, LengthUnit

COLOURS = {
    Severity.ERROR: "red",
    Severity.UNKNOWN: "magenta",
    Severity.WARNING: "yellow",
    Severity.NOTE: "cyan",
}
_LONGEST = 160


def coloured(err: bool = False) -> bool:
    """True when the output is a terminal and NO_COLOR is not set or empty."""
    stream = sys.stderr if err else sys.stdout
    return stream.isatty() and not os.environ.get("NO_COLOR")


def location(span: Span) -> str:
    """``file:line:col`` as far as it is known."""
    parts = [in_one_line(span.file)]
    if span.line:
        parts.append(str(span.line))
        parts.append(str(span.column or 1))
    return ":".join(parts)


def format_finding(
    finding: Finding, text: str | None, colour: bool, times: int = 1, unit: LengthUnit = MM
) -> list[str]:
    """The lines of one finding."""
    shade = COLOURS[finding.severity]
    code = finding.code
    often = f" ({times} times)" if times > 1 else ""
    place, severity = location(finding.span), finding.severity.value
    if colour:
        place, severity = click.style(place, bold=True), click.style(severity, fg=shade, bold=True)
    out = [f"{place}: {severity} {code.label} [{code.name}] {in_one_line(unit.message(finding))}{often}"]
    if text is not None:
        line, *marks = _excerpt(finding.span, text)
        out += [line, *(click.style(mark, fg=shade) if colour else mark for mark in marks)]
    if finding.hint:
        word = click.style("hint", bold=True) if colour else "hint"
        out.append(f"      = {word}: {in_one_line(unit.sentence(finding.hint))}")
    for other in finding.related:
        said = in_one_line(unit.sentence(brief(other.message)))
        out.append(f"      = {location(other.span)}: {said}")
    if finding.rests is not None:
        out.append(f"      = {in_one_line(finding.rests.text(finding.span.file))}")
    return out


def _excerpt(span: Span, text: str) -> list[str]:
    column, end = span.column, span.end_column
    if column > len(text) + 1:  # more of the line was not read
        column = 0
    if len(text) > _LONGEST:
        shift = max(0, min(column - _LONGEST // 2, len(text) - _LONGEST))
        text, column, end = text[shift : shift + _LONGEST], column - shift, end - shift
    plain = "".join(c if c.isprintable() else " " for c in text.expandtabs(1)).replace("##[", "# [")
    out = [f"{span.line:5d} | {plain.rstrip()}"]
    if column:
        width = max(1, min(end, len(plain) + 1) - column)
        out.append(f"      | {' ' * (column - 1)}^{'~' * (width - 1)}")
    return out


def print_findings(
    findings: Findings, *, err: bool = False, unit: LengthUnit = MM, notes: bool = True,
    accepted: Accepted | None = None, every: bool = False,
) -> None:  # fmt: skip
    """The kept findings by place, the others counted; notes: those too; accepted: marked so; every: repeats too."""
    accepted = accepted or {}
    colour = coloured(err)
    ordered = [finding for finding, _ in distinct(findings)]
    told = shown(findings, ordered, accepted, unit.message, every=every)
    by_file: dict[str, set[int]] = {}
    for span in (one.finding.span for one in told):
        if span.line:
            by_file.setdefault(span.file, set()).add(span.line)
    texts = {name: source_lines(name, lines) for name, lines in by_file.items()}
    for one in told:
        finding = one.finding
        if not notes and (finding.severity is Severity.NOTE or finding in accepted):
            continue
        text = texts.get(finding.span.file, {}).get(finding.span.line)
        for line in format_finding(finding, text, colour, one.times, unit):
            click.echo(line, err=err)
        if one.more is not None:
            click.echo(f"      = {in_one_line(one.more.text())}", err=err)
        if finding in accepted:
            click.echo(f"      = accepted: {in_one_line(accepted[finding][1])}", err=err)
    for number, count in left_over(findings, told).items():
        if CODES[number].severity is Severity.NOTE and not notes:
            continue
        click.echo(f"... and {count} more {CODES[number].label} [{CODES[number].name}]", err=err)


def finding_json(
    finding: Finding, times: int = 1, accepted: tuple[str, str] | None = None, unit: LengthUnit = MM
) -> dict[str, object]:  # fmt: skip
    """One finding of ``check --format json``; its texts in ``unit``, for reports that people read."""
    out: dict[str, object] = {
        "code": finding.code.label,
        "name": finding.code.name,
        "severity": finding.severity.value,
        "property": finding.code.decides,
        "file": finding.span.file,
        "line": finding.span.line,
        "column": finding.span.column,
        "end_column": finding.span.end_column,
        "message": unit.message(finding),
        "times": times,
    }
    if finding.hint:
        out["hint"] = unit.sentence(finding.hint)
    if accepted is not None:
        out["suppressed"] = {"kind": accepted[0], "reason": accepted[1]}
    if finding.related:
        out["related"] = [
            {
                "file": r.span.file,
                "line": r.span.line,
                "column": r.span.column,
                "message": unit.sentence(brief(r.message)),
            }
            for r in finding.related
        ]
    if finding.rests is not None:
        out["rests"] = _rests_json(finding.rests, finding.span.file)
    return out


def _rests_json(rests: Rests, file: str) -> dict[str, object]:
    """The outcomes that a finding rests on."""
    outcomes = [
        {
            "file": one.span.file,
            "line": one.span.line,
            "what": brief(one.what),
            "answer": one.answer,
            "times": one.times,
        }
        for one in rests.outcomes
    ]
    return {"text": rests.text(file), "outcomes": outcomes, "more": rests.more, "example": rests.example}
