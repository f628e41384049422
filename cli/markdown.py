"""Reports as Markdown: a table of verdicts, and below it what was found, for a summary page of a CI server."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from gproof.cli.outcome import LEVELS, Outcome, closing_line, counted

_LISTED = 50
"""Findings of a job that are listed."""
_MARKS = {"SAFE": "✅ SAFE", "UNSAFE": "❌ UNSAFE", "UNKNOWN": "❓ UNKNOWN"}


def markdown(outcomes: Sequence[Outcome]) -> str:
    """The page."""
    names = list(dict.fromkeys(name for o in outcomes if o.report for name in o.report["properties"]))
    rows = [["Job", "Verdict", *names, "Findings"]]
    for outcome in outcomes:
        if outcome.report is None:
            rows.append([_code(outcome.job), "not judged", *("" for _ in names), _text(outcome.problem)])
            continue
        answers = outcome.report["properties"]
        verdicts = [answers[name]["verdict"] if name in answers else "" for name in names]
        rows.append([_code(outcome.job), _MARKS[outcome.report["verdict"]], *verdicts, _summary(outcome.findings)])
    lines = ["## gproof", "", f"{closing_line(list(outcomes))}.", "", *_table(rows)]
    for outcome in outcomes:
        lines += _details(outcome)
    return "\n".join(lines)


def _table(rows: list[list[str]]) -> list[str]:
    head, *body = rows
    return [_row(head), _row(["---"] * len(head)), *(_row(row) for row in body)]


def _row(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _summary(findings: list[dict[str, Any]]) -> str:
    parts = []
    for level in reversed(LEVELS):
        number = sum(f["severity"] == level and "suppressed" not in f for f in findings)
        if number:
            parts.append(counted(number, level))
    hidden = sum("suppressed" in f for f in findings)
    return ", ".join([*parts, *([f"{hidden} suppressed"] if hidden else [])])


def _details(outcome: Outcome) -> list[str]:
    shown = [f for f in outcome.findings if "suppressed" not in f]
    conditions = [
        condition["text"]
        for answer in (outcome.report or {"properties": {}})["properties"].values()
        if answer["verdict"] == "SAFE"
        for condition in answer["conditions"]
    ]
    if not shown and not conditions:
        return []
    lines = ["", f"### {_code(outcome.job)}", ""]
    lines += [f"- SAFE if {_text(text)}" for text in dict.fromkeys(conditions)]
    for finding in sorted(shown, key=lambda f: -LEVELS.index(f["severity"]))[:_LISTED]:
        place = finding["file"] + (f":{finding['line']}" if finding["line"] else "")
        hint = f" *Hint: {_text(finding['hint'])}*" if finding.get("hint") else ""
        often = f" ({finding['times']} times)" if finding["times"] > 1 else ""
        lines.append(
            f"- **{finding['severity']} {finding['code']}** {_code(place)}: {_text(finding['message'])}{often}{hint}"
        )
    if len(shown) > _LISTED:
        lines.append(f"- … and {len(shown) - _LISTED} more")
    return lines


def _text(text: str) -> str:
    """Words as words: nothing in them is markup, and a line stays one."""
    return re.sub(r"([\\`*_{}\[\]<>#|~])", r"\\\1", " ".join(text.split()))


def _code(text: str) -> str:
    ticks = "`" * (max((len(run) for run in re.findall(r"`+", text)), default=0) + 1)
    pad = " " if ticks != "`" or text.startswith("`") else ""
    return f"{ticks}{pad}{' '.join(text.split())}{pad}{ticks}".replace("|", "\\|")
