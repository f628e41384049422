"""What ``gproof fit`` says: a table for the machinist, or the JSON report of docs/fit.md."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import click

from gproof.driver.escape import in_one_line
from gproof.driver.fit.answer import Fit, Range, Travel, smallest
from gproof.driver.fit.fitting import Fitted
from gproof.driver.fit.zones import Beside
from gproof.ir.finding import Findings, Severity, distinct
from gproof.ir.symbols import describe
from gproof.ir.trace import Affine
from gproof.ir.verdict import Verdict
from gproof.passes.checks.zones.offset_boxes import outline
from gproof.passes.checks.zones.offset_regions import FAR
from gproof.report.text import coloured, finding_json, print_findings
from gproof.report.units import CHOICES, LengthUnit, unit_of

SCHEMA = "gproof-fit/1"
MOST_BOXES = 6
"""Boxes of a region that the text names."""
_SHADES = {Verdict.SAFE: "green", Verdict.UNSAFE: "red", Verdict.UNKNOWN: "magenta"}


def print_fit(fitted: Fitted, units: str | None) -> None:
    """The answer as text: what prevents SAFE, the ranges, the travel."""
    fit = fitted.fit
    unit = unit_of(fitted.session.machine.unit) if units is None else CHOICES[units]
    blocking = blocking_findings(fitted)
    if blocking.kept:
        print_findings(blocking, unit=unit)
        click.echo()
    verdict = fit.verdict.value
    if coloured():
        verdict = click.style(verdict, fg=_SHADES[fit.verdict], bold=True)
    click.echo(f"{in_one_line(str(fitted.session.job))}: {verdict}, {headline(fit)}")
    for label, lines in (
        ("safe for", _range_lines(fit, unit)),
        *(
            (f"{'' if n else 'and in'}", _zone_lines(one, unit, is_safe=fit.verdict is Verdict.SAFE))
            for n, one in enumerate(fit.zones)
        ),
        ("because", [fit.reason] if fit.reason else []),
        ("note", _notes(fit)),
        ("needs", _travel_lines(fitted.travel, unit)),
        ("smallest", _smallest_line(fitted.travel, unit)),
        ("assuming", [unit.sentence(line) for line in assumptions(fitted)]),
        ("machine", [fitted.session.machine.name]),
        ("setup", [fitted.session.setup.name]),
    ):
        for n, line in enumerate(lines):
            click.echo(in_one_line(f"  {'' if n else label:<9} {line}".rstrip()))


def print_machines(job: Path, machines: Sequence[Path], answers: Sequence[Fitted], units: str | None) -> None:
    """A line for each machine: what it says as it is stated, what is wrong or how much room there is."""
    as_is = sum(fitted.fit.verdict is Verdict.SAFE for fitted in answers)
    moved = sum(_takes_moved(fitted.fit) for fitted in answers)
    also = f", {moved} more with another work zero" if moved else ""
    click.echo(f"{in_one_line(str(job))}: {as_is} of {len(answers)} machines can run it{also}")
    rows = []
    for file, fitted in zip(machines, answers, strict=True):
        unit = unit_of(fitted.session.machine.unit) if units is None else CHOICES[units]
        rows.append((in_one_line(str(file)), fitted.fit.verdict.value, in_one_line(_in_short(fitted, unit))))
    wide = [max(len(row[n]) for row in rows) for n in range(2)]
    for (name, verdict, said), fitted in zip(rows, answers, strict=True):
        shown = click.style(verdict, fg=_SHADES[fitted.fit.verdict], bold=True) if coloured() else verdict
        click.echo(f"  {name:<{wide[0]}}  {shown}{' ' * (wide[1] - len(verdict))}  {said}".rstrip())
    needs = next((fitted for fitted in answers if fitted.travel), None)
    if needs is not None:
        unit = unit_of(needs.session.machine.unit) if units is None else CHOICES[units]
        for line in _smallest_line(needs.travel, unit):
            click.echo(f"  the job needs {line}")


def _takes_moved(fit: Fit) -> bool:
    return fit.verdict is not Verdict.SAFE and fit.kind in ("ranges", "regions") and not fit.open_sides


def _in_short(fitted: Fitted, unit: LengthUnit) -> str:
    """What decides, in a few words: how far the zero can be moved, or the first thing that is wrong."""
    fit = fitted.fit
    if fit.kind not in ("ranges", "regions"):
        if fit.reason:
            return fit.reason
        found = blocking_findings(fitted).kept
        return f"{found[0].code.label} {unit.message(found[0])}" if found else headline(fit)
    rooms: dict[str, tuple[float, str]] = {}
    for one in fit.ranges:
        axis = one.name[-1]
        before = rooms.get(axis, (math.inf, one.unit))[0]
        rooms[axis] = min(before, one.high - one.low), one.unit
    sizes = ", ".join(
        f"{axis} {'open' if math.isinf(size) else unit.place(size, own)}{'' if own == 'mm' else ' deg'}"
        for axis, (size, own) in rooms.items()
    )
    beside = f", clear of {' and '.join(fit.zones[0].place.zones)}" if fit.zones else ""
    if not sizes:
        return headline(fit)
    said = "" if fit.verdict is Verdict.SAFE and fit.now is None else f"{headline(fit)}; "
    return f"{said}room for the zero: {sizes}{beside}"


def headline(fit: Fit) -> str:
    """What the answer comes to, in some words."""
    moved = [one for one in fit.ranges if one.fits is False]
    if fit.kind == "none":
        return "no work offset changes that" if fit.now is not Verdict.SAFE else "with the offsets of the setup"
    if fit.kind == "unknown":
        if fit.now is Verdict.SAFE:
            return "with the offsets of the setup; other work zeros are not known"
        return "no safe work zero is known"
    if not fit.ranges:
        return "no work offset of the setup moves this job"
    if fit.open_sides and fit.verdict is Verdict.UNKNOWN:
        return "because travel limits are missing"
    if fit.now is None:
        return "with the offsets in these ranges"
    away = [one for one in fit.zones if one.inside is False]
    if away and not moved:
        names = dict.fromkeys(zone for one in away for zone in one.place.zones)
        return f"with this work zero, moves enter {' and '.join(names)}"
    if moved:
        worst = [f"{abs(one.short):.4g} {one.unit} short on {one.name}" for one in moved]
        return f"the work zero is {', '.join(worst)}"
    return "the work zero can stay where it is" if fit.now is Verdict.SAFE else "with the offsets of the setup"


def blocking_findings(fitted: Fitted) -> Findings:
    """Errors and unknowns that no offset takes away: those of the job with its offsets open."""
    out = Findings()
    if fitted.fit.kind in ("ranges", "regions") and not fitted.fit.open_sides:
        return out
    for finding in fitted.judgement.findings.kept if not fitted.fit.reason else ():
        if finding.severity in (Severity.ERROR, Severity.UNKNOWN):
            out.add(finding)
    return out


def assumptions(fitted: Fitted) -> list[str]:
    """What the ranges depend on."""
    found = [*fitted.judgement.assumptions, *(a for r in fitted.judgement.properties for a in r.assumptions)]
    found += [fitted.fit.assumed] if fitted.fit.assumed else []
    return list(dict.fromkeys(one for one in found if not one.startswith("setup zero")))


def _range_lines(fit: Fit, unit: LengthUnit) -> list[str]:
    """A line for each offset, in columns: name, from, to, where it is now, what to change."""
    rows = []
    for one in fit.ranges:
        low = unit.inward(one.low, one.unit, up=True) if math.isfinite(one.low) else "any"
        high = unit.inward(one.high, one.unit, up=False) if math.isfinite(one.high) else "any"
        rows.append((one.name, low, high, unit.named(one.unit), _now(one, unit), _change(one, unit)))
    if not rows:
        return []
    wide = [max(len(row[n]) for row in rows) for n in range(6)]
    return [
        f"{name:<{wide[0]}}  {low:>{wide[1]}} ... {high:>{wide[2]}} {own:<{wide[3]}}  "
        f"{'now ' + now if now else '':<{wide[4] + 4}}  {change}".rstrip()
        for name, low, high, own, now, change in rows
    ]


def _now(one: Range, unit: LengthUnit) -> str:
    if one.now is None:
        return ""
    if one.now.exact:
        return unit.place(one.now.low, one.unit)
    return f"{unit.place(one.now.low, one.unit)} to {unit.place(one.now.high, one.unit)}"


def _change(one: Range, unit: LengthUnit) -> str:
    """``3.2000 short: add 3.2000 ... 12.0000``, rounded so that it is enough."""
    if one.now is None:
        return ""
    if one.fits:
        return "fits"
    by = unit.inward(abs(one.short), one.unit, up=True)
    if one.move is None:
        return f"{by} short, and the range in the setup is too wide"
    low, high = one.move
    ends = [unit.inward(end, one.unit, up=up) for end, up in ((low, True), (high, False)) if math.isfinite(end)]
    signed = [end if end.startswith("-") else f"+{end}" for end in ends]
    return f"{by} short: move by {' ... '.join(signed)}"


def _zone_lines(one: Beside, unit: LengthUnit, *, is_safe: bool) -> list[str]:
    """The boxes of a region, one a line, and where the stated offsets are. is_safe: the job is, with them."""
    place = one.place
    used = [n for n in range(3) if place.terms[n]]
    shown = place.boxes[:MOST_BOXES]
    head = f"one of these, clear of {' and '.join(place.zones)}:"
    cells = [[f"{_end(box[n][0], unit, up=True)} ... {_end(box[n][1], unit, up=False)}" for n in used] for box in shown]
    wide = [max(len(row[k]) for row in cells) for k in range(len(used))] if cells else []
    out = [head] + [
        "   ".join(f"{one.names[n]} {row[k]:>{wide[k]}}" for k, n in enumerate(used)) + f" {unit.name}" for row in cells
    ]
    hidden = len(place.boxes) - len(shown)
    if hidden:
        out.append(f"and {hidden} smaller boxes")
    if place.region.resolution != 0.0:
        out.append("and places next to moves at an angle: see --picture or --format json")
    if one.inside is False and one.nearest is not None and one.now is not None:
        goes = [f"{one.names[n]} {unit.place(one.nearest[n], 'mm')}" for n in used]
        out.append(
            "now next to them, but SAFE: not all places are known"
            if is_safe
            else f"now outside; the nearest place is {', '.join(goes)}"
        )
    return out


def _end(value: float, unit: LengthUnit, *, up: bool) -> str:
    if abs(value) >= FAR:
        return "any"
    return unit.inward(value, "mm", up=up)


def _notes(fit: Fit) -> list[str]:
    out = [f"{message[0].upper()}{message[1:]}: no limit on that side" for message in fit.open_sides]
    if fit.kind in ("ranges", "regions") and not fit.complete:
        out.append("other offsets may be SAFE too")
    return out


def _travel_lines(travel: tuple[Travel, ...] | None, unit: LengthUnit) -> list[str]:
    """A line for each motor and what it moves with."""
    if travel is None:
        return ["not known: part of the path is not known"]
    rows = []
    for one in travel:
        low, high = one.limits
        size = None if low is None or high is None else high - low
        has = "not given" if size is None else f"{unit.place(size, one.unit)} {unit.named(one.unit)}"
        beside = f"from {describe(one.relative)}" if one.relative else "machine coordinates"
        more = ", longer with its pitch table" if one.bends else ""
        rows.append((
            one.motor, unit.place(one.low, one.unit), unit.place(one.high, one.unit),
            f"{unit.place(one.size, one.unit)} {unit.named(one.unit)}", has, beside + more,
        ))  # fmt: skip
    wide = [max((len(row[n]) for row in rows), default=0) for n in range(6)]
    return [
        f"{motor:<{wide[0]}}  {low:>{wide[1]}} ... {high:>{wide[2]}}  {size:>{wide[3]}} of {has:>{wide[4]}}  {beside}"
        for motor, low, high, size, has, beside in rows
    ]


def _smallest_line(travel: tuple[Travel, ...] | None, unit: LengthUnit) -> list[str]:
    """``X 293.000 x Y 193.000 x Z 95.800 mm``, rotary axes after."""
    if not travel:
        return []
    own = {one.motor: one.unit for one in travel}
    sizes = smallest(travel)
    lengths = " x ".join(f"{m} {unit.place(s, 'mm')}" for m, s in sizes.items() if own[m] == "mm")
    turns = ", ".join(f"{m} {unit.place(s, 'deg')} deg" for m, s in sizes.items() if own[m] != "mm")
    return [", ".join(part for part in (f"{lengths} {unit.name}" if lengths else "", turns) if part)]


def report_json(fitted: Fitted) -> dict[str, object]:
    """The stable JSON report; docs/fit.md defines it."""
    session, fit = fitted.session, fitted.fit
    return {
        "schema": SCHEMA,
        "job": str(session.job),
        "dialect": {"name": session.dialect, "reason": session.dialect_reason},
        "machine": session.machine.name,
        "setup": session.setup.name,
        "inputs": [{"file": name, "sha256": digest, "role": role} for name, digest, role in session.inputs],
        "verdict": fit.verdict.value,
        "exit_code": fit.verdict.exit_code,
        "stated": None if fit.now is None else fit.now.value,
        "kind": fit.kind,
        "reason": fit.reason,
        "complete": fit.complete if fit.kind in ("ranges", "regions") else False,
        "offsets": [_range_json(one) for one in fit.ranges],
        "regions": [_zone_json(one) for one in fit.zones],
        "travel": None if fitted.travel is None else [_travel_json(one) for one in fitted.travel],
        "smallest_machine": {} if fitted.travel is None else smallest(fitted.travel),
        "assumptions": assumptions(fitted),
        "findings": [finding_json(f, n) for f, n in distinct(blocking_findings(fitted))],
    }


def _range_json(one: Range) -> dict[str, object]:
    move = one.move
    return {
        "name": one.name,
        "terms": _terms_json(one.terms),
        "unit": one.unit,
        "low": _finite(one.low),
        "high": _finite(one.high),
        "now": None if one.now is None else {"low": one.now.low, "high": one.now.high},
        "fits": one.fits,
        "short": one.short,
        "move": None if move is None else {"low": _finite(move[0]), "high": _finite(move[1])},
    }


def _zone_json(one: Beside) -> dict[str, object]:
    place = one.place
    return {
        "zones": list(place.zones),
        "terms": {axis: _terms_json(form) for axis, form in zip("xyz", place.terms, strict=True)},
        "resolution": place.region.resolution,
        "boxes": [
            {axis: _ends_json(ends) if form else None for axis, ends, form in zip("xyz", box, place.terms, strict=True)}
            for box in place.boxes
        ],
        "layers": [
            {"z": _ends_json(layer.z) if place.terms[2] else None, "polygons": outline(layer)}
            for layer in place.region.layers
        ],
        "now": None if one.now is None else list(one.now),
        "inside": one.inside,
        "nearest": None if one.nearest is None else list(one.nearest),
    }


def _terms_json(form: Affine) -> list[dict[str, object]]:
    return [{"symbol": symbol, "coefficient": count} for symbol, count in form]


def _ends_json(ends: tuple[float, float]) -> dict[str, float | None]:
    low, high = (None if abs(value) >= FAR else value for value in ends)
    return {"low": low, "high": high}


def _travel_json(one: Travel) -> dict[str, object]:
    return {
        "motor": one.motor,
        "axis": one.axis,
        "unit": one.unit,
        "relative_to": _terms_json(one.relative),
        "low": one.low,
        "high": one.high,
        "size": one.size,
        "machine": {"low": one.limits[0], "high": one.limits[1]},
    }


def _finite(value: float) -> float | None:
    """JSON has no infinities."""
    return value if math.isfinite(value) else None
