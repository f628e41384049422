"""Reports as JUnit XML: a suite a job, a case a property, as test reporters of CI servers read it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any
from xml.etree import ElementTree as ET

from gproof.driver.conditions import conditions_of_report, in_words
from gproof.driver.outcome import Outcome
from gproof.report.escape import xml_text

_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML 1.0 cannot carry."""


COUNTED = ("tests", "failures", "errors", "skipped")
SAFE = 0
"""The exit code of a job that passes."""


def junit(outcomes: Sequence[Outcome]) -> str:
    """A document, in which a job fails where its exit code says so.

    A property that is UNSAFE or UNKNOWN is a failure, unless the policy leaves it out (skipped) or all that speaks
    against it is accepted; findings that fail the check by their weight alone are a case of their own; a job that could
    not be judged is an error.
    """
    root = ET.Element("testsuites", name="gproof check")
    totals = dict.fromkeys(COUNTED, 0)
    for outcome in outcomes:
        suite = ET.SubElement(root, "testsuite", name=_clean(outcome.job))
        if outcome.shown is None:
            case = ET.SubElement(suite, "testcase", classname=_clean(outcome.job), name="job")
            error = ET.SubElement(case, "error", message=_clean(outcome.problem), type="could not run")
            error.text = _clean("\n".join(outcome.text)) or None
        else:
            _cases(suite, outcome, outcome.shown)
        counts = {"tests": len(suite.findall("testcase"))}
        counts |= {name: len(suite.findall(f"testcase/{name.rstrip('s')}")) for name in ("failures", "errors")}
        counts["skipped"] = len(suite.findall("testcase/skipped"))
        for name in COUNTED:
            suite.set(name, str(counts[name]))
            totals[name] += counts[name]
    for name in COUNTED:
        root.set(name, str(totals[name]))
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + xml_text(ET.tostring(root, encoding="unicode"))


def _cases(suite: ET.Element, outcome: Outcome, report: dict[str, Any]) -> None:
    names = list(report["properties"])
    left_out = report.get("left_out", ())
    conditions = conditions_of_report(report)
    said = ET.SubElement(ET.SubElement(suite, "properties"), "property", name="verdict", value=outcome.word)
    if conditions:
        said.set("value", _clean(f"SAFE {in_words(conditions)}"))
    for name, answer in report["properties"].items():
        case = ET.SubElement(suite, "testcase", classname=_clean(outcome.job), name=name, file=_clean(outcome.job))
        own = [f for f in report["findings"] if f["property"] == name or (name == names[0] and _of_none(f, names))]
        lines = [_line(finding) for finding in own]
        verdict = answer["verdict"]
        if name in left_out:
            ET.SubElement(case, "skipped", message="left out by the policy")
        elif verdict != "SAFE" and outcome.code != SAFE:
            told = [f for f in own if f["severity"] in ("error", "unknown")]
            message = told[0]["message"] if told else f"{name} is {verdict}"
            failure = ET.SubElement(case, "failure", message=_clean(message), type=verdict)
            failure.text = _clean("\n".join(lines) or f"{name} is {verdict}")
            continue
        elif name in conditions:
            lines[:0] = [f"{name} is SAFE if {text}" for text in conditions[name]]
        elif verdict != "SAFE":
            lines.insert(0, f"{name} is {verdict} (accepted)")
        if lines:
            ET.SubElement(case, "system-out").text = _clean("\n".join(lines))
    if outcome.code != SAFE and suite.find("testcase/failure") is None:
        case = ET.SubElement(suite, "testcase", classname=_clean(outcome.job), name="policy", file=_clean(outcome.job))
        failure = ET.SubElement(case, "failure", message="findings that fail the check", type="policy")
        failure.text = _clean("\n".join(_line(f) for f in report["findings"] if "suppressed" not in f))


def _of_none(finding: dict[str, Any], names: list[str]) -> bool:
    return finding["property"] not in names


def _line(finding: dict[str, Any]) -> str:
    place = finding["file"] + (f":{finding['line']}" if finding["line"] else "")
    hint = f" (hint: {finding['hint']})" if finding.get("hint") else ""
    rests = f" ({finding['rests']['text']})" if "rests" in finding else ""
    return f"{place}: {finding['severity']} {finding['code']} [{finding['name']}] {finding['message']}{rests}{hint}"


def _clean(text: str) -> str:
    return _NOT_XML.sub("\ufffd", text)
