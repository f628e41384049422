"""A report format from outside: one line a job. Importing it registers it."""

from __future__ import annotations

from gproof.driver.outcome import Outcome
from gproof.report import formats

FILES = ("report/toy.py", "report/formats.py", "tests/report/test_toy.py")
REGISTRY = "report/formats.py"


def toy(outcomes: list[Outcome], every: bool) -> str:
    return "\n".join(f"{outcome.job} -> {outcome.word}, {len(outcome.findings)}" for outcome in outcomes)


formats.DOCUMENTS["toy"] = toy
