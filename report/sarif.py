"""Reports as SARIF 2.1.0 (OASIS), which code scanning services and editors read."""

from __future__ import annotations

import os
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path, PurePath
from typing import Any
from urllib.parse import quote

from gproof.driver.conditions import conditions_of_report
from gproof.driver.outcome import Fingerprints, Outcome, exit_code
from gproof.ir.codes import CODES
from gproof.ir.finding import Code
from gproof.report.escape import json_text
from gproof.report.finding_page import page_to_read

SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
LEVELS = {"error": "error", "unknown": "error", "warning": "warning", "note": "note"}
"""SARIF has no level for what is neither proved nor refuted; it fails the job, so it is an error there."""
ROOT = "%SRCROOT%"


def sarif(outcomes: Sequence[Outcome]) -> str:
    """One log with one run over all jobs. Paths are relative to the folder it was run in."""
    used = sorted({finding["code"] for outcome in outcomes for finding in outcome.findings})
    rules = {label: n for n, label in enumerate(used)}
    marks = Fingerprints()
    results: list[dict[str, Any]] = []
    for outcome in outcomes:
        findings = outcome.findings
        for finding, mark in zip(
            findings, marks.of([(f["file"], f["line"], f["code"]) for f in findings]), strict=True
        ):
            results.append(_result(finding, rules, mark))
    code = exit_code(outcomes)
    problems = [outcome.problem for outcome in outcomes if outcome.problem]
    invocation: dict[str, Any] = {"executionSuccessful": not problems, "exitCode": code}
    if problems:
        invocation["toolExecutionNotifications"] = [
            {"level": "error", "message": {"text": problem}} for problem in problems
        ]
    run: dict[str, Any] = {
        "tool": {
            "driver": {
                "name": "gproof",
                "semanticVersion": version("gproof"),
                "rules": [_rule(CODES[int(label[2:])]) for label in used],
            }
        },
        "columnKind": "unicodeCodePoints",
        "originalUriBaseIds": {ROOT: {"description": {"text": "The folder that gproof was run in."}}},
        "invocations": [invocation],
        "artifacts": _artifacts(outcomes),
        "results": results,
        "properties": {
            "verdicts": {outcome.job: outcome.word if outcome.verdict else None for outcome in outcomes},
            "conditions": {
                outcome.job: found
                for outcome in outcomes
                if outcome.report is not None and (found := conditions_of_report(outcome.report))
            },
        },
    }
    log = {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}
    return json_text(log, indent=2)


def _rule(code: Code) -> dict[str, Any]:
    page = page_to_read(code)
    paragraphs = [" ".join(part.split()) for part in page.split("\n\n")]
    first = next((part for part in paragraphs if part and not part.startswith("#")), code.name)
    return {
        "id": code.label,
        "name": "".join(word.capitalize() for word in code.name.split("-")),
        "shortDescription": {"text": code.name.replace("-", " ")},
        "fullDescription": {"text": first},
        "help": {"text": page, "markdown": page},
        "defaultConfiguration": {"level": LEVELS[code.severity.value]},
        "properties": {"tags": [code.decides], "severity": code.severity.value},
    }


def _result(finding: dict[str, Any], rules: dict[str, int], mark: str) -> dict[str, Any]:
    text = finding["message"]
    if "rests" in finding:
        text += f", {finding['rests']['text']}"
    if finding.get("hint"):
        text += f" (hint: {finding['hint']})"
    out: dict[str, Any] = {
        "ruleId": finding["code"],
        "ruleIndex": rules[finding["code"]],
        "level": LEVELS[finding["severity"]],
        "message": {"text": text},
        "locations": [_location(finding)],
        "partialFingerprints": {"primaryLocationLineHash": mark},
        "properties": {"severity": finding["severity"], "property": finding["property"]},
    }
    if "rests" in finding:
        out["properties"]["rests"] = finding["rests"]
    if finding["times"] > 1:
        out["occurrenceCount"] = finding["times"]
    if finding.get("related"):
        out["relatedLocations"] = [
            {**_location(other), "message": {"text": other["message"]}} for other in finding["related"]
        ]
    if "suppressed" in finding:
        suppressed = finding["suppressed"]
        out["suppressions"] = [
            {"kind": suppressed["kind"], "status": "accepted", "justification": suppressed["reason"]}
        ]
    return out


def _location(place: dict[str, Any]) -> dict[str, Any]:
    physical: dict[str, Any] = {"artifactLocation": _artifact(place["file"])}
    if place["line"]:
        region = physical["region"] = {"startLine": place["line"]}
        if place["column"]:
            region["startColumn"] = place["column"]
        if place.get("end_column", 0) > place["column"] > 0:
            region["endColumn"] = place["end_column"]
    return {"physicalLocation": physical}


def _artifact(name: str) -> dict[str, str]:
    path = PurePath(os.path.normpath(name))
    if path.is_absolute():
        try:
            path = path.relative_to(Path.cwd())
        except ValueError:
            return {"uri": path.as_uri()}
    return {"uri": quote(os.fsencode(path.as_posix())), "uriBaseId": ROOT}


def _artifacts(outcomes: Sequence[Outcome]) -> list[dict[str, Any]]:
    files: dict[str, dict[str, Any]] = {}
    for outcome in outcomes:
        for entry in outcome.report["inputs"] if outcome.report is not None else []:
            files.setdefault(
                entry["file"],
                {
                    "location": _artifact(entry["file"]),
                    "roles": ["analysisTarget" if entry["role"] == "source" else "userSpecifiedConfiguration"],
                    "hashes": {"sha-256": entry["sha256"]},
                },
            )
    return list(files.values())
