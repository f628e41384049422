"""``check --format json`` of several jobs; docs/check-json.md defines it."""

from __future__ import annotations

from collections.abc import Sequence

from gproof.driver.outcome import Outcome
from gproof.report.escape import json_text

SCHEMA = "gproof-check-several/1"


def several_json(outcomes: Sequence[Outcome]) -> str:
    """The reports of all jobs, and how many of them came to which verdict."""
    answers = [
        outcome.report
        if outcome.report is not None
        else {"job": outcome.job, "problem": outcome.problem, **({"details": outcome.text} if outcome.text else {})}
        for outcome in outcomes
    ]
    counts = dict.fromkeys(("SAFE", "UNSAFE", "UNKNOWN", "not_judged", "conditional"), 0)
    for outcome in outcomes:
        counts[outcome.verdict.value if outcome.verdict else "not_judged"] += 1
        counts["conditional"] += outcome.report is not None and bool(outcome.report["conditional"])
    return json_text({"schema": SCHEMA, "counts": counts, "jobs": answers}, indent=2)
