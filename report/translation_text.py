"""What a translation did, as text and as JSON."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gproof.ir.target import FEATURES
from gproof.ir.verdict import Verdict

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


def markdown_of(done: Translation, job: Path, output: Path, *, written: bool) -> str:
    """The same as a page."""
    head, *rest = summary_lines(done, job, output, written=written)
    lines = [f"# {job.name} for {done.target.title}", "", f"**{done.verdict.value}**: {head}", ""]
    found = [one for one in done.findings.kept if one.code.number // 100 == CODES]
    if found:
        lines += ["| line | finding | what |", "|---|---|---|"]
        lines += [f"| {one.span.line} | {one.code.label} | {_cell(one.message)} |" for one in found]
        lines.append("")
    lines += [f"- {line.strip()}" for line in rest]
    return "\n".join(lines).rstrip() + "\n"


CODES = 7
"""Hundred of the findings of translation."""


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;")


def translation_json(done: Translation, output: Path, *, written: bool) -> dict[str, Any]:
    """The same for programs."""
    found = done.comparison
    return {
        "format": "gproof-translation-report/1",
        "verdict": done.verdict.value,
        "target": done.target.name,
        "written": [str(output.parent / name if name else output) for name in done.files] if written else [],
        "kept": [{"construct": text, "times": count} for text, count in _kept(done)],
        "rewritten": [{"pattern": name, "line": line, "times": count} for name, line, count in _patterns(done)],
        "assumed": done.assumed,
        "findings": [
            {"code": one.code.label, "file": one.span.file, "line": one.span.line, "message": one.message}
            for one in done.findings.kept
        ],
        "moves": None if found is None else found.rows[0],
        "drift": None if found is None else {"mm": found.drift[0], "degrees": found.drift[1]},
    }
