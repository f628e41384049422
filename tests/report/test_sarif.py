"""Reports for other programs: SARIF by its public schema, JUnit by its shape, workflow commands by their escapes.

`sarif/sarif-2.1.0.json` is the public JSON Schema of SARIF 2.1.0 (OASIS), as Microsoft's SARIF SDK ships it (npm
package `@microsoft/sarif-multitool-linux` 5.7.0, MIT licence), unchanged.
"""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest
from jsonschema import Draft202012Validator
from support.bundles import unpacked
from support.goldens import ROOT

from gproof.cli.main import main
from gproof.driver.outcome import Fingerprints, Outcome
from gproof.report.github import workflow_commands
from gproof.report.junit import junit
from gproof.report.markdown import markdown
from gproof.report.sarif import sarif

MACHINE = str(ROOT / "docs" / "codes" / "machine.toml")
BAD = sorted(unpacked("docs/codes").glob("GP*/bad.cnc"))


@cache
def validator() -> Draft202012Validator:
    schema = json.loads((Path(__file__).parent / "sarif" / "sarif-2.1.0.json").read_text(encoding="utf-8"))
    return Draft202012Validator(schema)


def finding(**values: Any) -> dict[str, Any]:
    plain = {
        "code": "GP301", "name": "soft-limit", "severity": "error", "property": "limits", "file": "a.cnc", "line": 3,
        "column": 2, "end_column": 5, "message": "X is too far", "times": 1,
    }  # fmt: skip
    return plain | values


def outcome(*findings: dict[str, Any], job: str = "a.cnc", verdict: str = "UNSAFE") -> Outcome:
    answers = {name: {"verdict": verdict, "conditions": []} for name in ("language", "limits")}
    report = {"verdict": verdict, "properties": answers, "findings": list(findings), "inputs": []}
    return Outcome(job=job, report=report, code=("SAFE", "UNSAFE", "UNKNOWN").index(verdict))


def test_every_code_is_valid_sarif(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    names = [str(path.relative_to(ROOT)) for path in BAD]
    code = main(["check", *names, "missing.cnc", "--machine", MACHINE, "--format", "sarif", "--max-blocks", "2000"])
    log = json.loads(capsys.readouterr().out)
    assert [error.message for error in validator().iter_errors(log)] == []
    (run,) = log["runs"]
    assert code == run["invocations"][0]["exitCode"] == 3
    assert len(run["results"]) > 100
    rules = run["tool"]["driver"]["rules"]
    for result in run["results"]:
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"]
        assert re.fullmatch("[0-9a-f]{32}", result["partialFingerprints"]["primaryLocationLineHash"])
        (location,) = result["locations"]
        uri = location["physicalLocation"]["artifactLocation"]["uri"]
        assert (ROOT / uri).is_file()
        region = location["physicalLocation"].get("region", {})
        assert region.get("endColumn", 1 << 30) > region.get("startColumn", 1)
    assert all(re.fullmatch("[A-Z][A-Za-z0-9]+", rule["name"]) for rule in rules)
    for rule in rules:
        page = (ROOT / "docs" / "codes" / f"{rule['id']}.md").read_text("utf-8")
        assert rule["help"]["markdown"] == rule["help"]["text"] == page.partition("\n## Files\n")[0].rstrip()


def test_sarif_of_marks_and_suppressions() -> None:
    hidden = finding(code="GP243", severity="note", suppressed={"kind": "inSource", "reason": "on purpose"}, line=0)
    related = [{"file": "b c.inc", "line": 7, "column": 1, "message": "called here"}]
    log = json.loads(sarif([outcome(finding(times=3, hint="move it", related=related), hidden)]))
    assert list(validator().iter_errors(log)) == []
    first, second = log["runs"][0]["results"]
    assert first["occurrenceCount"] == 3
    assert first["message"]["text"] == "X is too far (hint: move it)"
    assert first["relatedLocations"][0]["physicalLocation"]["artifactLocation"]["uri"] == "b%20c.inc"
    assert second["suppressions"] == [{"kind": "inSource", "status": "accepted", "justification": "on purpose"}]
    assert "region" not in second["locations"][0]["physicalLocation"]


def test_fingerprints_stay_when_lines_move(tmp_path: Path) -> None:
    job = tmp_path / "a.cnc"
    job.write_text("N10 G1 X5\nN20 G1 X9000\nN30 G1 X9000\n", encoding="utf-8")
    before = list(Fingerprints().of([(str(job), n, "GP301") for n in (2, 3)]))
    job.write_text("(new)\n\nN5 G1 X5\nN100 G1   X9000\nN105 G1 X9000 \n", encoding="utf-8")
    after = list(Fingerprints().of([(str(job), n, "GP301") for n in (4, 5)]))
    assert before == after
    assert len(set(before)) == 2
    job.write_text("G1 X9001\n", encoding="utf-8")
    assert next(Fingerprints().of([(str(job), 1, "GP301")])) not in before


def test_junit_counts_and_escapes() -> None:
    strange = finding(message='<b> & "\x00\x1b]\ud800', file="a&b.cnc")
    text = junit([outcome(strange), outcome(verdict="SAFE", job="<b>"), Outcome(job="c", problem="no such file")])
    root = ET.fromstring(text)
    assert (root.get("tests"), root.get("failures"), root.get("errors")) == ("5", "2", "1")
    assert [suite.get("name") for suite in root] == ["a.cnc", "<b>", "c"]
    failures = root.findall("./testsuite/testcase/failure")
    assert failures[1].get("message") == '<b> & "\ufffd\ufffd]\ufffd'
    assert failures[0].text == "language is UNSAFE"
    assert [suite.get("failures") for suite in root] == ["2", "0", "0"]


def test_workflow_commands_escape_what_would_end_them() -> None:
    text = workflow_commands(
        [
            outcome(
                finding(severity="note", message="last"),
                finding(file="a,b:c%.cnc", message="100 %\nof it", hint="less", severity="unknown"),
                finding(severity="warning", suppressed={"kind": "inSource", "reason": "x"}),
            ),
            Outcome(job="::error::x", problem="gone"),
        ]
    )
    assert text.splitlines() == [
        "::error file=a%2Cb%3Ac%25.cnc,line=3,col=2,endColumn=4,title=GP301 soft-limit"
        "::unknown: 100 %25%0Aof it%0Ahint: less",
        "::notice file=a.cnc,line=3,col=2,endColumn=4,title=GP301 soft-limit::last",
        "::error title=gproof::gone",
        "gproof: a.cnc: UNSAFE",
        "gproof: \\x3a:error::x: not checked",
        "2 jobs: 1 UNSAFE, 1 not checked",
    ]


def test_markdown_shows_text_as_text() -> None:
    page = markdown([outcome(finding(message="a|b *c* <img> `d`", hint="e\nf"), job="x|`y`.cnc")])
    table = [line for line in page.splitlines() if line.startswith("|")]
    assert [len(re.findall(r"(?<!\\)\|", line)) for line in table] == [6, 6, 6]
    assert r"a\|b \*c\* \<img\> \`d\` *Hint: e f*" in page
    assert page.startswith("## gproof\n\n1 job: 1 UNSAFE.\n")


@pytest.mark.parametrize("count", [49, 50, 51, 300])
def test_markdown_lists_so_many_findings_at_most(count: int) -> None:
    page = markdown([outcome(*(finding(line=n) for n in range(1, count + 1)))], every=True)
    assert page.count("\n- **error") == min(count, 50)
    assert ("more" in page) == (count > 50)
