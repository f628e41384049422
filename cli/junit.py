"""Reports as JUnit XML: a suite a job, a case a property, as test reporters of CI servers read it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any
from xml.etree import ElementTree as ET

from gproof.cli.outcome import Outcome

_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML 1.0 can not carry."""


def junit(outcomes: Sequence[Outcome]) -> str:
    """A document. A property that is UNSAFE or UNKNOWN is a failure, a job that could not be judged an error."""
    root = ET.Element("testsuites", name="gproof check")
    totals = [0, 0, 0]
    for outcome in outcomes:
        suite = ET.SubElement(root, "testsuite", name=_clean(outcome.job))
        if outcome.shown is None:
            case = ET.SubElement(suite, "testcase", classname=_clean(outcome.job), name="job")
            ET.SubElement(case, "error", message=_clean(outcome.problem), type="could not run")
            counts = [1, 0, 1]
        else:
            counts = _cases(suite, outcome, outcome.shown)
        totals = [a + b for a, b in zip(totals, counts, strict=True)]
        _count(suite, counts)
    _count(root, totals)
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode")


def _count(element: ET.Element, counts: list[int]) -> None:
    for name, number in zip(("tests", "failures", "errors"), counts, strict=True):
        element.set(name, str(number))


def _cases(suite: ET.Element, outcome: Outcome, report: dict[str, Any]) -> list[int]:
    failures = 0
    names = list(report["properties"])
    for name, answer in report["properties"].items():
        case = ET.SubElement(suite, "testcase", classname=_clean(outcome.job), name=name, file=_clean(outcome.job))
        own = [f for f in report["findings"] if f["property"] == name or (name == names[0] and _of_none(f, names))]
        lines = [_line(finding) for finding in own]
        if answer["verdict"] == "SAFE":
            if lines:
                ET.SubElement(case, "system-out").text = _clean("\n".join(lines))
            continue
        failures += 1
        told = [f for f in own if f["severity"] in ("error", "unknown")]
        message = told[0]["message"] if told else f"{name} is {answer['verdict']}"
        failure = ET.SubElement(case, "failure", message=_clean(message), type=answer["verdict"])
        failure.text = _clean("\n".join(lines) or f"{name} is {answer['verdict']}")
    return [len(names), failures, 0]


def _of_none(finding: dict[str, Any], names: list[str]) -> bool:
    return finding["property"] not in names


def _line(finding: dict[str, Any]) -> str:
    place = finding["file"] + (f":{finding['line']}" if finding["line"] else "")
    hint = f" (hint: {finding['hint']})" if finding.get("hint") else ""
    return f"{place}: {finding['severity']} {finding['code']} [{finding['name']}] {finding['message']}{hint}"


def _clean(text: str) -> str:
    return _NOT_XML.sub("\ufffd", text)
