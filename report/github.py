"""Reports as workflow commands of GitHub Actions, which put findings next to the lines of a change."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from gproof.driver.conditions import conditions_of_report, in_words
from gproof.driver.escape import in_one_line
from gproof.driver.outcome import LEVELS, Outcome, closing_line
from gproof.report.grouping import More, shown_json

_COMMANDS = {"error": "error", "unknown": "error", "warning": "warning", "note": "notice"}


def workflow_commands(outcomes: Sequence[Outcome], *, every: bool = False) -> str:
    """Commands, the weightiest first because only some are shown, then a line for each job and one for all.

    Findings of one kind are one command; every: each of them is.
    """
    lines: list[str] = []
    found = [one for o in outcomes if o.shown is not None for one in shown_json(o.shown, every=every)]
    for finding, more in sorted(found, key=lambda one: -LEVELS.index(one[0]["severity"])):
        lines.append(_command(finding, more))
    for outcome in outcomes:
        if outcome.problem:
            lines.append(f"::error title=gproof::{_data(outcome.problem)}")
    for outcome in outcomes:
        # A path may start with what would be a command.
        lines.append(f"gproof: {_data(outcome.job)}: {_data(_verdict(outcome))}")
    lines.append(closing_line(list(outcomes)))
    return "\n".join(lines)


def _verdict(outcome: Outcome) -> str:
    found = {} if outcome.shown is None else conditions_of_report(outcome.shown)
    return f"SAFE {in_words(found)}" if found else outcome.word


def _command(finding: dict[str, Any], more: More | None) -> str:
    places = {"file": finding["file"]}
    if finding["line"]:
        places["line"] = str(finding["line"])
        if finding["column"]:
            places["col"] = str(finding["column"])
        if finding["end_column"] > finding["column"] > 0:
            places["endColumn"] = str(finding["end_column"] - 1)
    places["title"] = f"{finding['code']} {finding['name']}"
    shown = ",".join(f"{key}={_property(value)}" for key, value in places.items())
    text = finding["message"]
    if finding["severity"] == "unknown":
        text = f"unknown: {text}"
    if "rests" in finding:
        text += f"\n{finding['rests']['text']}"
    if more is not None:
        text += f"\n{more.text()}"
    if finding.get("hint"):
        text += f"\nhint: {finding['hint']}"
    return f"::{_COMMANDS[finding['severity']]} {shown}::{_data(text)}"


def _data(text: str) -> str:
    """A message: its line feeds are kept for the page, whatever else would act on a log is a number."""
    return in_one_line(_lines(text))


def _lines(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return in_one_line(_lines(text)).replace(":", "%3A").replace(",", "%2C")
