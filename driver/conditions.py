"""A SAFE that holds under conditions: which property requires what, and the words that say so in every report.

``SAFE if`` where the conditions fit, ``SAFE-IF`` where one word does. Under another verdict there are no conditions.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from gproof.driver.judge import Judgement
from gproof.ir.verdict import Condition, PropertyResult, Verdict

SAFE_IF = "SAFE-IF"
"""The verdict of a SAFE with conditions, in one word."""


def conditions_of(judgement: Judgement) -> dict[str, tuple[Condition, ...]]:
    """By property, what the verdict holds under; nothing where it is not SAFE."""
    if judgement.verdict is not Verdict.SAFE:
        return {}
    return {
        result.name: result.conditions
        for result in judgement.properties
        if result.verdict is Verdict.SAFE and result.conditions and result.name not in judgement.left_out
    }


def word(judgement: Judgement) -> str:
    """The verdict in one word."""
    return SAFE_IF if conditions_of(judgement) else judgement.verdict.value


def word_of(result: PropertyResult) -> str:
    """The answer for a property in one word."""
    return SAFE_IF if result.verdict is Verdict.SAFE and result.conditions else result.verdict.value


def word_of_report(report: Mapping[str, Any]) -> str:
    """The verdict of a JSON report, or of a property in it, in one word."""
    conditional = report.get("conditional", bool(report.get("conditions")))
    return SAFE_IF if report["verdict"] == "SAFE" and conditional else str(report["verdict"])


def conditions_of_report(report: Mapping[str, Any]) -> dict[str, list[str]]:
    """By property, the texts of the conditions that the verdict of a JSON report holds under."""
    if not report.get("conditional"):
        return {}
    left_out = report.get("left_out", ())
    return {
        name: [condition["text"] for condition in answer["conditions"]]
        for name, answer in report["properties"].items()
        if answer["verdict"] == "SAFE" and answer["conditions"] and name not in left_out
    }


def in_words(found: Mapping[str, list[str]]) -> str:
    """``if G54 X offset is 0.0000 ... 9.0000 mm (limits)``: all conditions in one line, each with its property."""
    return "if " + ", ".join(f"{', '.join(texts)} ({name})" for name, texts in found.items())
