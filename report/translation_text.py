"""What a translation did, as text and as JSON."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gproof.ir.finding import Findings
from gproof.ir.record import record
from gproof.ir.target import FEATURES
from gproof.ir.verdict import Verdict
from gproof.report.text import finding_json

if TYPE_CHECKING:
    from gproof.driver.translation import Translation


CHORDS = "arc -> chords"


def _kept(done: Translation) -> list[tuple[str, int]]:
    """(construct, times), what the target has as it is, in the order of the table of features."""
    return [(text, done.kept[name]) for name, text in FEATURES.items() if name in done.kept]


def _patterns(done: Translation) -> list[tuple[str, int, int]]:
    """(pattern, first line, times) in the order of their first lines."""
    times = Counter(one.pattern for one in done.lowered)
    first: dict[str, int] = {}
    for one in done.lowered:
        first.setdefault(one.pattern, one.span.line)
    return [(name, first[name], count) for name, count in times.items()]


def summary_lines(done: Translation, job: Path, output: Path, *, written: bool) -> list[str]:
    """The result, what was rewritten, and what it rests on."""
    title = done.target.title
    if done.verdict is Verdict.SAFE:
        head = f"{output}: proven: the same as {job} on {title}, wherever the work zero is"
    elif written:
        head = f"{output}: written, not proven"
    elif done.verdict is Verdict.UNSAFE:
        head = f"{job}: refuted: nothing was written"
    else:
        head = f"{job}: not translated to {title}: nothing was written"
    lines = [head]
    if done.kept:
        lines.append(f"  kept: {', '.join(f'{text} ({count})' for text, count in _kept(done))}")
    for name, line, count in _patterns(done):
        within = f", within {done.chord_tolerance:g} mm" if name == CHORDS else ""
        lines.append(f"  rewritten: {name} ({count} time{'s' if count > 1 else ''}, first in line {line}{within})")
    lines += [f"  assumed: {text}" for text in done.assumed]
    if done.comparison is not None and done.verdict is Verdict.SAFE:
        mm, degrees = done.comparison.drift
        rows = done.comparison.rows[0]
        lines.append(f"  compared: {rows} moves; largest difference {mm:.2g} mm, {degrees:.2g} degrees")
    return lines


@record(frozen=True, slots=True, kw_only=True)
class TranslatedProgram:
    """What is said of one program. lines: its text, the result first; data: for programs; found: its findings."""

    job: Path
    target: str
    verdict: Verdict
    lines: tuple[str, ...]
    data: dict[str, Any]
    found: Findings
    assumed: tuple[str, ...]


def translated_program(done: Translation, job: Path, output: Path, *, written: bool) -> TranslatedProgram:
    """A translation that has ended, without the program itself."""
    lines = summary_lines(done, job, output, written=written)
    data = translation_json(done, job, output, written=written)
    return TranslatedProgram(
        job=job, target=done.target.title, verdict=done.verdict, lines=tuple(lines), data=data, found=done.findings,
        assumed=tuple(done.assumed),
    )  # fmt: skip


def markdown_of(done: TranslatedProgram, heading: str = "#") -> str:
    """The same as a page, or a part of one."""
    head, *rest = done.lines
    lines = [f"{heading} {done.job.name} for {done.target}", "", f"**{done.verdict.value}**: {head}", ""]
    found = [one for one in done.found.kept if one.code.number // 100 == CODES]
    if found:
        lines += ["| line | finding | what |", "|---|---|---|"]
        lines += [f"| {one.span.line} | {one.code.label} | {_cell(one.message)} |" for one in found]
        lines.append("")
    lines += [f"- {line.strip()}" for line in rest]
    return "\n".join(lines).rstrip()


CODES = 7
"""Hundred of the findings of translation."""


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;")


def translation_json(done: Translation, job: Path, output: Path, *, written: bool) -> dict[str, Any]:
    """The same for programs; docs/translation.schema.json describes it."""
    found = done.comparison
    return {
        "schema": "gproof-translation-report/1",
        "job": str(job),
        "dialect": done.session.dialect,
        "target": done.target.name,
        "verdict": done.verdict.value,
        "exit_code": done.verdict.exit_code,
        "written": [str(output.parent / name if name else output) for name in done.files] if written else [],
        "partial": done.partial,
        "kept": [{"construct": text, "times": count} for text, count in _kept(done)],
        "rewritten": [{"pattern": name, "line": line, "times": count} for name, line, count in _patterns(done)],
        "assumed": done.assumed,
        "findings": [finding_json(one, done.findings.times.get(one, 1)) for one in done.findings.kept],
        "moves": None if found is None else {"source": found.rows[0], "target": found.rows[1]},
        "drift": None if found is None else {"mm": found.drift[0], "degrees": found.drift[1]},
    }
