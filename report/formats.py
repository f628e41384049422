"""The registry of documents that ``check --format`` and ``check --report`` write: one line each, by the name requested.

A writer takes the outcomes of all jobs and whether repeats of a finding are listed one by one; it imports what it needs
when it is called.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gproof.driver.outcome import Outcome

Writer = Callable[[list["Outcome"], bool], str]
"""The document as text, without an end of line."""


def _json(outcomes: list[Outcome], every: bool) -> str:
    from gproof.report.several_json import several_json

    return several_json(outcomes)


def _sarif(outcomes: list[Outcome], every: bool) -> str:
    from gproof.report.sarif import sarif

    return sarif(outcomes)


def _junit(outcomes: list[Outcome], every: bool) -> str:
    from gproof.report.junit import junit

    return junit(outcomes)


def _github(outcomes: list[Outcome], every: bool) -> str:
    from gproof.report.github import workflow_commands

    return workflow_commands(outcomes, every=every)


def _markdown(outcomes: list[Outcome], every: bool) -> str:
    from gproof.report.markdown import markdown

    return markdown(outcomes, every=every)


DOCUMENTS: dict[str, Writer] = {
    "json": _json,
    "sarif": _sarif,
    "junit": _junit,
    "github": _github,
    "markdown": _markdown,
}
