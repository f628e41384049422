"""Reports as Markdown: a table of verdicts, and below it what was found, for a summary page of a CI server."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from gproof.driver.conditions import SAFE_IF, conditions_of_report, word_of_report
from gproof.driver.escape import in_one_line
from gproof.driver.outcome import LEVELS, Outcome, closing_line, counted
from gproof.report.grouping import shown_json

_LISTED = 50
"""Findings of a job that are listed."""
_MARKS = {"SAFE": "✅ SAFE", SAFE_IF: "☑️ SAFE-IF", "UNSAFE": "❌ UNSAFE", "UNKNOWN": "❓ UNKNOWN"}


def markdown(outcomes: Sequence[Outcome], *, every: bool = False) -> str:
    """The page; every: findings of one kind one by one."""
    names = list(dict.fromkeys(name for o in outcomes if o.report for name in o.report["properties"]))
    rows = [["Job", "Verdict", *names, "Findings"]]
    for outcome in outcomes:
        if outcome.report is None:
            rows.append([_code(outcome.job), "not checked", *("" for _ in names), _text(outcome.problem)])
            continue
        answers = outcome.report["properties"]
        verdicts = [word_of_report(answers[name]) if name in answers else "" for name in names]
        rows.append([_code(outcome.job), _MARKS[outcome.word], *verdicts, _summary(outcome.report)])
    lines = ["## gproof", "", f"{closing_line(list(outcomes))}.", "", *_table(rows)]
    for outcome in outcomes:
        lines += _details(outcome, every)
    return "\n".join(lines)


def _table(rows: list[list[str]]) -> list[str]:
    head, *body = rows
    return [_row(head), _row(["---"] * len(head)), *(_row(row) for row in body)]


def _row(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _summary(report: dict[str, Any]) -> str:
    """How many findings there are of each weight, those that are not listed too."""
    found = report["findings"]
    numbers = dict.fromkeys(LEVELS, 0)
    for code in dict.fromkeys(f["code"] for f in found):
        own = [f for f in found if f["code"] == code]
        accepted = sum(f["times"] for f in own if "suppressed" in f)
        listed = sum(f["times"] for f in own) - accepted
        numbers[own[0]["severity"]] += max(listed, report.get("counts", {}).get(code, 0) - accepted)
    parts = [counted(numbers[level], level) for level in reversed(LEVELS) if numbers[level]]
    hidden = sum("suppressed" in f for f in found)
    return ", ".join([*parts, *([f"{hidden} suppressed"] if hidden else [])])


def _details(outcome: Outcome, every: bool) -> list[str]:
    shown = [] if outcome.shown is None else shown_json(outcome.shown, every=every)
    conditions = {} if outcome.shown is None else conditions_of_report(outcome.shown)
    if not shown and not conditions:
        return []
    lines = ["", f"### {_code(outcome.job)}", ""]
    lines += [f"- SAFE if {_text(text)} ({name})" for name, texts in conditions.items() for text in texts]
    for finding, more in sorted(shown, key=lambda one: -LEVELS.index(one[0]["severity"]))[:_LISTED]:
        place = finding["file"] + (f":{finding['line']}" if finding["line"] else "")
        hint = f" *Hint: {_text(finding['hint'])}*" if finding.get("hint") else ""
        often = f" ({finding['times']} times)" if finding["times"] > 1 else ""
        like = f", {_text(more.text())}" if more is not None else ""
        rests = f", {_text(finding['rests']['text'])}" if "rests" in finding else ""
        said = f"{_text(finding['message'])}{often}{rests}{like}{hint}"
        lines.append(f"- **{finding['severity']} {finding['code']}** {_code(place)}: {said}")
    if len(shown) > _LISTED:
        lines.append(f"- … and {len(shown) - _LISTED} more")
    return lines


def _text(text: str) -> str:
    """Words as words: nothing in them is markup, an entity, a formula or an address, and a line stays one."""
    plain = re.sub(r"([\\`*_{}\[\]<>#|~&$])", r"\\\1", _visible(text))
    return re.sub(r"(?i)(:(?=//)|(?<=www)\.)", r"\\\1", plain)


def _visible(text: str) -> str:
    return in_one_line(" ".join(text.split()))


def _code(text: str) -> str:
    text = _visible(text)
    ticks = "`" * (max((len(run) for run in re.findall(r"`+", text)), default=0) + 1)
    pad = " " if ticks != "`" or text.startswith("`") else ""
    return f"{ticks}{pad}{text}{pad}{ticks}".replace("|", "\\|")
