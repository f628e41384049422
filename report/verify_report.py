"""What ``gproof verify`` says of a package: the verdict, what was judged here, what its signer states, what is open.

Every text of the package is escaped (``report/escape.py``). docs/verify-json.md defines the JSON form.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Iterator
from typing import Any

import click

from gproof.driver.conditions import SAFE_IF
from gproof.driver.escape import shown
from gproof.driver.key_ring import name_of
from gproof.driver.verified import Verified
from gproof.ir.finding import Finding
from gproof.ir.verdict import Condition, Verdict
from gproof.report.summary import condition_of
from gproof.report.text import finding_json
from gproof.verify.certificate.package import Package
from gproof.verify.certificate.signers import fingerprint
from gproof.verify.explain.stream_report import BOUNDS

SCHEMA = "gproof-verify/1"
"""Of the JSON report: docs/verify-json.md."""


def print_verified(path: str, of: Verified) -> None:
    """The report for people."""
    body, machine = of.package.body, of.package.machine
    click.echo(f"{shown(path)}: {SAFE_IF if of.conditional else of.verdict.value}")
    for name, condition in of.check.conditions if of.verdict is not Verdict.UNSAFE else ():
        _row("if", shown(f"{condition_of(machine, condition)} ({name})"))
    for said in of.taken:
        _row("taken", shown(said))
    _row("certificate", of.package.sha256)
    _row("job", f"{shown(body.get('job'))}, machine {shown(machine.name)}")
    _row("signed by", _signer(of))
    label = of.package.signature or {}
    for key, word in (("created", "created"), ("comment", "comment")):
        if label.get(key):
            _row(word, f"{shown(label[key])}, according to the signer")
    _row(
        "compared",
        f"with {', '.join(of.compared)}" if of.compared else "with nothing; use --machine, --setup and --source",
    )
    frequency = of.package.stream.tick_frequency
    seconds = sum(section.duration for section in of.package.stream.sections) / frequency
    _row("steps", f"{of.check.stream.steps} checked, {seconds:.1f} s")
    if of.pure:
        _row("proved", "in plain Python: no compiled code, no numba")
    width = max(len(name) for name in BOUNDS)
    judged = [f"{one.name:<{width}}  {one.verdict.value}" for one in of.check.stream.properties]
    _rows("proved here", judged)
    stated = [one for one in _properties(body) if one["name"] not in BOUNDS]
    for one in stated:
        said = f"{shown(one['name']):<{width}}  {shown(one['verdict'])}"
        _row("stated" if one is stated[0] else "", said)
        for condition in _conditions(one):
            _row("", f"{'':<{width}}  if {shown(condition_of(machine, condition))}")
    _rows("unchecked", [", ".join(map(shown, _texts(body.get("not_judged"))))])
    of_each = [text for one in _properties(body) for text in _texts(one.get("assumptions"))]
    _rows("assuming", [shown(one) for one in dict.fromkeys((*_texts(body.get("assumptions")), *of_each))])


def verified_json(path: str, of: Verified) -> dict[str, Any]:
    """The report for programs."""
    package, stream = of.package, of.package.stream
    body, label = package.body, package.signature or {}
    known = None if of.check.signer is None else base64.b64decode(of.check.signer)
    return {
        "schema": SCHEMA,
        "package": path,
        "certificate": package.sha256,
        "verdict": of.verdict.value,
        "conditional": of.conditional,
        "exit_code": of.verdict.exit_code,
        "job": str(body.get("job")),
        "machine": package.machine.name,
        "gproof": str(body.get("gproof")),
        "signer": None if known is None else {
            "public_key": of.check.signer,
            "fingerprint": fingerprint(known),
            "name": next((one.name for one in of.trusted if one.raw == known and one.name), None),
            "created": str(label.get("created", "")),
            "comment": str(label.get("comment", "")),
        },
        "compared": list(of.compared),
        "taken": list(of.taken),
        "steps": of.check.stream.steps,
        "seconds": sum(s.duration for s in stream.sections) / stream.tick_frequency,
        "pure": of.pure,
        "judged": {one.name: one.verdict.value for one in of.check.stream.properties},
        "stated": {
            str(one["name"]): {
                "verdict": str(one["verdict"]),
                "assumptions": _texts(one.get("assumptions")),
                "conditions": [_condition_json(package, c) for c in _conditions(one)],
            }
            for one in _properties(body)
            if one["name"] not in BOUNDS
        },
        "open": [{"property": n, **_condition_json(package, c)} for n, c in of.check.conditions],
        "not_judged": _texts(body.get("not_judged")),
        "assumptions": _texts(body.get("assumptions")),
        "findings": [finding_json(one) for one in of.findings],
    }  # fmt: skip


def unread_json(path: str, verdict: Verdict, finding: Finding) -> dict[str, Any]:
    """The same of a package of which nothing can be said but why."""
    return {
        "schema": SCHEMA, "package": path, "verdict": verdict.value, "conditional": False,
        "exit_code": verdict.exit_code, "findings": [finding_json(finding)],
    }  # fmt: skip


def _condition_json(package: Package, condition: Condition) -> dict[str, Any]:
    return {
        "text": condition_of(package.machine, condition),
        "terms": [{"symbol": s, "coefficient": k} for s, k in condition.terms],
        "low": condition.low if math.isfinite(condition.low) else None,
        "high": condition.high if math.isfinite(condition.high) else None,
    }


def _signer(of: Verified) -> str:
    if of.check.signer is None:
        return "nobody"
    raw = base64.b64decode(of.check.signer)
    return shown(name_of(raw, of.trusted))


def _properties(body: dict[str, Any]) -> list[dict[str, Any]]:
    """What the body lists, as far as it is of its form."""
    listed = body.get("properties")
    if not isinstance(listed, list):
        return []
    return [one for one in listed if isinstance(one, dict) and {"name", "verdict"} <= set(one)]


def _conditions(listed: dict[str, Any]) -> Iterator[Condition]:
    found = listed.get("conditions")
    for one in found if isinstance(found, list) else ():
        try:
            terms = tuple((str(symbol), int(count)) for symbol, count in one["terms"])
            yield Condition(terms=terms, low=float(one["low"]), high=float(one["high"]))
        except (LookupError, TypeError, ValueError, OverflowError):
            continue


def _texts(value: object) -> list[str]:
    return [str(one) for one in value] if isinstance(value, list) else []


def _row(label: str, text: str) -> None:
    click.echo(f"  {label:<11} {text}".rstrip())


def _rows(label: str, texts: list[str]) -> None:
    for n, text in enumerate(one for one in texts if one):
        _row("" if n else label, text)
