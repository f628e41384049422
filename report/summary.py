"""What ``check`` says of a job: verdicts with their conditions and figures as text, and the JSON report."""

from __future__ import annotations

import math

import click

from gproof.driver.conditions import SAFE_IF, conditions_of, in_words, word_of
from gproof.driver.escape import in_one_line
from gproof.driver.judge import Judgement
from gproof.driver.session import Session
from gproof.ir.codes import CODES, SYNTAX
from gproof.ir.finding import distinct
from gproof.ir.machine import Axis, Machine
from gproof.ir.symbols import describe
from gproof.ir.trace import UNKNOWN
from gproof.ir.verdict import Condition, Verdict
from gproof.passes.checks.registry import not_judged
from gproof.report.grouping import groups_json
from gproof.report.text import coloured, finding_json, print_findings
from gproof.report.units import CHOICES, MM, LengthUnit, unit_of

SCHEMA = "gproof-check/1"
_NOWHERE = describe(UNKNOWN)
_SHADES = {"SAFE": "green", SAFE_IF: "yellow", "SAFE if": "yellow", "UNSAFE": "red", "UNKNOWN": "magenta"}


def condition_text(session: Session, condition: Condition, unit: LengthUnit = MM) -> str:
    """``G54 X offset is 12.4000 ... 230.1000 mm``; bounds are rounded inwards."""
    return condition_of(session.machine, condition, unit)


def condition_of(machine: Machine, condition: Condition, unit: LengthUnit = MM) -> str:
    """The same where there is a machine only, as in a package."""
    name, bounds = _condition_parts(machine, condition, unit)
    return f"{name} is {' '.join(bounds.split())}"


def _condition_parts(machine: Machine, condition: Condition, length: LengthUnit) -> tuple[str, str]:
    """Name and bounds, the bounds in columns."""
    if condition.terms and all(count < 0 for _, count in condition.terms):
        # What is at least less than nothing of something, is at most so much of it.
        terms = tuple((symbol, -count) for symbol, count in condition.terms)
        condition = Condition(terms=terms, low=-condition.high, high=-condition.low)
    axis = condition.terms[0][0].rpartition(".")[2] if condition.terms else "x"
    own = _counts_in(machine.axis(axis), axis)  # a, b and c may be linear: heads W, U, V
    low = length.inward(condition.low, own, up=True) if math.isfinite(condition.low) else None
    high = length.inward(condition.high, own, up=False) if math.isfinite(condition.high) else None
    unit = length.named(own)
    if low is None or high is None:
        side = f"at least {low}" if low is not None else f"at most {high}" if high is not None else "anything, in"
        return describe(condition.terms, machine), f"{side} {unit}"
    return describe(condition.terms, machine), f"{low:>9} ... {high:>9} {unit}"


def report_for_people(
    session: Session, judgement: Judgement, code: int, units: str | None
) -> dict[str, object] | None:  # fmt: skip
    """The report with its texts in the unit that people read (``--units``); None where that is the millimetre."""
    unit = unit_of_report(session, judgement) if units is None else CHOICES[units]
    return None if unit is MM else report_json(session, judgement, code, unit)


def unit_of_report(session: Session, judgement: Judgement) -> LengthUnit:
    """The unit of the machine file, or without one that of the job."""
    named = session.machine.unit if session.machine_given else judgement.summary.unit
    return unit_of(session.machine.unit if named is None else named)


def _looks_otherwise(session: Session) -> None:
    """A line for a job with syntax errors whose text or folder speaks for another controller than it was read for."""
    from gproof.driver.dialects import guess_dialect

    dialect, reason = guess_dialect(session.job)
    if dialect != session.dialect and " in " in reason:
        _row("", f"the program looks like one for {dialect}: {reason}")


def print_summary(
    session: Session, judgement: Judgement, *, findings: bool = False, unit: LengthUnit | None = None,
    code: int | None = None, every: bool = False,
) -> None:  # fmt: skip
    """Verdicts with conditions, what they depend on, then the figures of the job, lined up; findings: before them.

    unit: None: that of the machine file, or without one that of the job; code: the exit code, None: the verdict's;
    every: findings that repeat each other one by one.
    """
    if unit is None:
        unit = unit_of_report(session, judgement)
    if findings:
        print_findings(judgement.findings, unit=unit, accepted=judgement.accepted, every=every)
    if judgement.findings.kept:
        click.echo()
    code = judgement.verdict.exit_code if code is None else code
    conditions = conditions_of(judgement)
    click.echo(_verdict_line(session, judgement, code, f" the conditions of {' and '.join(conditions)} hold"))
    for result in judgement.properties:
        parts = [_condition_parts(session.machine, c, unit) for c in conditions.get(result.name, ())]
        width = max((len(name) for name, _ in parts), default=0)
        said = result.verdict.value if parts else word_of(result)
        first = _shade(said) + " " * (9 - len(said))
        aside = "left out by the policy" if result.name in judgement.left_out else ""
        if result.name in judgement.strict:
            aside = "SAFE only under conditions, which --strict does not accept"
        for n, detail in enumerate([f"if {name:<{width}} is {bounds}" for name, bounds in parts] or [aside]):
            _row("" if n else result.name, detail, " " * 9 if n else first)
    left = not_judged(result.name for result in judgement.properties)
    if left:
        _row("unchecked", ", ".join(left))
    starts = tuple(f"{describe(c.terms, session.machine)} is between" for found in conditions.values() for c in found)
    assumed = [*judgement.assumptions, *(a for r in judgement.properties for a in r.assumptions)]
    assumed = [one for one in assumed if not one.startswith(starts)]  # a condition already
    _rows("assuming", [unit.sentence(one) for one in dict.fromkeys(assumed)])
    _row("machine", session.machine.name)
    _row("dialect", f"{session.dialect} ({session.dialect_reason})")
    if judgement.findings.counts.get(SYNTAX.number):
        _looks_otherwise(session)
    if session.program is not None:
        _figures(session, judgement, unit)


def _row(label: str, text: str, shaded: str = "") -> None:
    """A line; text: may hold anything; shaded: what is before it, in a colour of ours."""
    click.echo(f"  {label:<10}  {shaded}{in_one_line(text)}".rstrip())


def _rows(label: str, texts: list[str]) -> None:
    for n, text in enumerate(texts):
        _row("" if n else label, text)


def _figures(session: Session, judgement: Judgement, unit: LengthUnit) -> None:
    summary = judgement.summary
    if session.machine.keep_out or session.setup.keep_out:
        from gproof.report.zones import named

        _row("keep out", named(session))
    if session.setup.workpiece is not None:
        from gproof.report import workpieces

        _row("workpiece", workpieces.named(session.setup.workpiece, unit))
    blocks, sections = _count(summary.blocks, "block"), _count(summary.sections, "section")
    ways = (
        f", {summary.branches} branch{'' if summary.branches == 1 else 'es'} explored (unknown conditions)"
        if summary.branches
        else ""
    )
    _row("program", f"{_count(summary.lines, 'line')}, {blocks} executed in {sections}{ways}")
    reaches = [r for r in summary.box if not (r[1].startswith("the start position") and r[2] == r[3])]
    _rows("reaches", _lined_up([_reach(session, unit, *r) for r in reaches]))
    moving = {axis for axis, *_ in summary.box}
    for label, places in (("starts at", summary.begin), ("ends at", summary.end)):
        shown = [
            f"{axis.upper()} {_place(session, unit, axis, value)}" for axis, value in places.items() if axis in moving
        ]
        if shown:
            _row(label, ", ".join(shown))
    if summary.box:
        _row("path", f"{unit.path(summary.path_length)}, of which {unit.path(summary.feed_length)} at feed")
        if summary.branches:
            _row("time", "not known: the path depends on conditions; its length is that of all branches together")
        else:
            _row("time", duration_text(summary.seconds, summary.at_least, session.machine_given))


def _reach(session: Session, length: LengthUnit, axis: str, relative: str, low: float, high: float) -> tuple[str, ...]:
    """The cells of one line: axis, range, what to compare it with."""
    if relative == _NOWHERE:
        return axis.upper(), "", "", f"{'and ' if low != high else ''}positions that are not known"
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


def duration_text(seconds: float | None, at_least: bool, machine_given: bool = True) -> str:
    """``about 3 min 12 s``, or why it is not known."""
    if seconds is None:
        missing = "no machine file"
        if machine_given:
            missing = "the machine file gives no velocities and accelerations, or the job changes them"
        return f"not known: {missing}"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    text = f"{seconds:.1f} s"
    if hours or minutes:
        text = f"{hours} h {minutes} min" if hours else f"{minutes} min {rest} s"
    return f"{'at least' if at_least else 'about'} {text}, without waits"


def report_json(
    session: Session, judgement: Judgement, code: int | None = None, unit: LengthUnit = MM
) -> dict[str, object]:  # fmt: skip
    """The stable JSON report; docs/check-json.md defines it. code: the exit code, None: the verdict's.

    unit: of its texts; reports that people read are made from one in the unit of the shop.
    """
    summary = judgement.summary
    return {
        "schema": SCHEMA,
        "job": str(session.job),
        "dialect": {"name": session.dialect, "reason": session.dialect_reason},
        "machine": session.machine.name if session.machine_given else None,
        "setup": session.setup.name,
        "inputs": [{"file": name, "sha256": digest, "role": role} for name, digest, role in session.inputs],
        "verdict": judgement.verdict.value,
        "conditional": bool(conditions_of(judgement)),
        "exit_code": judgement.verdict.exit_code if code is None else code,
        "properties": {
            r.name: {
                "verdict": r.verdict.value,
                "assumptions": [unit.sentence(one) for one in r.assumptions],
                "conditions": [
                    {
                        "text": condition_text(session, c, unit),
                        "terms": [{"symbol": s, "coefficient": k} for s, k in c.terms],
                        "low": _finite(c.low),
                        "high": _finite(c.high),
                    }
                    for c in (r.conditions if r.verdict is Verdict.SAFE else ())
                ],
            }
            for r in judgement.properties
        },
        **({"left_out": list(judgement.left_out)} if judgement.left_out else {}),
        "not_judged": list(not_judged(result.name for result in judgement.properties)),
        "assumptions": [unit.sentence(one) for one in judgement.assumptions],
        "findings": [finding_json(f, n, judgement.accepted.get(f), unit) for f, n in distinct(judgement.findings)],
        "groups": groups_json(judgement.findings, unit),
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
            **_workpiece(session),
        },
    }


def _workpiece(session: Session) -> dict[str, object]:
    if session.setup.workpiece is None:
        return {}
    from gproof.report import workpieces

    return {"workpiece": workpieces.report(session.setup.workpiece)}


def _finite(value: float | None) -> float | None:
    """JSON has no infinities."""
    return value if value is not None and math.isfinite(value) else None


def print_brief(
    session: Session, judgement: Judgement, code: int, units: str | None, *, quiet: bool, every: bool = False
) -> None:  # fmt: skip
    """One of several jobs: findings other than notes, its verdict, and what a SAFE rests on; quiet: in one line."""
    unit = unit_of_report(session, judgement) if units is None else CHOICES[units]
    if not quiet:
        print_findings(judgement.findings, unit=unit, notes=False, accepted=judgement.accepted, every=every)
    conditions = conditions_of(judgement)
    texts = {name: [condition_text(session, c, unit) for c in found] for name, found in conditions.items()}
    click.echo(_verdict_line(session, judgement, code, in_words(texts).removeprefix("if") if quiet else ""))
    if quiet:
        return
    parts = [(name, *_condition_parts(session.machine, c, unit)) for name, found in conditions.items() for c in found]
    width = max((len(name) for _, name, _ in parts), default=0)
    for prop, name, ends in parts:
        click.echo(in_one_line(f"  if {name:<{width}} is {ends} ({prop})"))


_WHY_OTHER = {0: " (accepted)", Verdict.UNKNOWN.exit_code: " (accepted, except what is UNKNOWN)"}
"""Why an exit code is not the verdict's."""


def _verdict_line(session: Session, judgement: Judgement, code: int, condition: str) -> str:
    """``job.cnc: UNKNOWN (accepted)``: the verdict, and where the exit code differs, why.

    condition: what follows ``SAFE if`` where the SAFE has conditions.
    """
    said = ""
    if code != judgement.verdict.exit_code:
        said = _WHY_OTHER.get(code, " (and findings that fail the check)")
    open_to = [r.name for r in judgement.properties if r.name in judgement.left_out and r.verdict is not Verdict.SAFE]
    if open_to and judgement.verdict is Verdict.SAFE:
        said = f", {' and '.join(open_to)} left out by the policy" + said
    verdict = f"{_shade('SAFE if')}{condition}" if conditions_of(judgement) else _shade(judgement.verdict.value)
    return f"{in_one_line(str(session.job))}: {verdict}{said}"


def _shade(word: str) -> str:
    return click.style(word, fg=_SHADES[word], bold=True) if coloured() else word
