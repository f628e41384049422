"""What a certificate's body says, held against what its parts give: steps, time, policy, bounds, checkers, versions.

A body that claims more, or other things, than the checker at hand finds is refused (GP824), also where what it claims
does no harm: whoever reads it would believe it. A body of another version of the stream checker is UNKNOWN (GP850):
what that one called proved is not what this one does.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from gproof.ir import codes
from gproof.ir.finding import Finding, Span
from gproof.ir.verdict import DEFAULT_POLICY
from gproof.verify.certificate.package import Package
from gproof.verify.explain.earlier_words import in_todays_words
from gproof.verify.explain.stream_report import BOUNDS, CHECKER, CHECKER_VERSION, StreamReport

TRACE_CHECKER = "gproof.passes"


def other_claims(
    package: Package, report: StreamReport, where: Span, asked: Mapping[str, list[Any]]
) -> Iterator[Finding]:  # fmt: skip
    """Findings for what the body says otherwise than the parts and the stream checker's report.

    asked: by property of the stream the conditions that it has, as the body spells them; others have none.
    LookupError, TypeError or ValueError where it is not of its form.
    """
    body = package.body
    policy = list(DEFAULT_POLICY)
    if body["policy"] != policy:
        yield _other(where, "policy", body["policy"], policy)
    ticks = sum(section.duration for section in package.stream.sections)
    if not _is(body["duration_ticks"], ticks):
        yield _other(where, "duration_ticks", body["duration_ticks"], ticks)
    steps = int(package.stream.steps())
    if not _is(body["steps"], steps):
        yield _other(where, "steps", body["steps"], steps)
    _texts(body["assumptions"], "assumptions")
    names = [one["name"] for one in body["properties"]]
    for name in _texts(body["not_judged"], "not_judged"):
        if name in names:
            yield _malformed(where, f"property {name!r} is listed as proved and as not checked")
    yield from _versions(body, where)
    proved = {one.name: one for one in report.properties}
    for one in body["properties"]:
        name, of_stream = one["name"], one["name"] in BOUNDS
        checker, version = (CHECKER, CHECKER_VERSION) if of_stream else (TRACE_CHECKER, body["gproof"])
        if one["checker"] != checker:
            yield _other(where, f"checker of {name}", one["checker"], checker)
        elif not of_stream and one["version"] != version:
            yield _other(where, f"version of the checker of {name}", one["version"], version)
        _texts(one["assumptions"], "assumptions")
        if not of_stream or one["version"] != CHECKER_VERSION:
            bound = "" if not of_stream else one["bound"]
        else:
            bound = BOUNDS[name]
            assumed = list(proved[name].assumptions) if name in proved else []
            if [in_todays_words(text) for text in one["assumptions"]] != assumed:
                yield _other(where, f"assumptions of {name}", one["assumptions"], assumed)
            conditions = asked.get(name, [])
            if one["conditions"] != conditions:
                yield _other(where, f"conditions of {name}", one["conditions"], conditions)
        if one["bound"] != bound:
            yield _other(where, f"bound of {name}", one["bound"], bound)


def _versions(body: dict[str, Any], where: Span) -> Iterator[Finding]:
    """GP850 once, however many properties of the stream say so."""
    if type(body["gproof"]) is not str:
        raise TypeError("gproof is not a text")
    for said in {one["version"] for one in body["properties"] if one["name"] in BOUNDS} - {CHECKER_VERSION}:
        what = f"the steps were checked by version {said!r} of {CHECKER}, this is version {CHECKER_VERSION}"
        yield codes.CERTIFICATE_VERSION.at(where, what=what)


def _texts(value: object, name: str) -> list[str]:
    if not isinstance(value, list) or not all(isinstance(one, str) for one in value):
        raise TypeError(f"{name} is not a list of texts")
    return value


def _is(said: object, found: int) -> bool:
    return type(said) is int and said == found


def _other(where: Span, name: str, said: object, found: object) -> Finding:
    return codes.CERTIFICATE_VERDICT.at(
        where, what=f"the body says {name} {_short(said)}; its parts give {_short(found)}"
    )


def _malformed(where: Span, what: str) -> Finding:
    return codes.CERTIFICATE_MALFORMED.at(where, what=what)


def _short(value: object) -> str:
    text = repr(value) if not isinstance(value, int) or value.bit_length() < 256 else "a huge number"
    return text if len(text) <= 100 else f"{text[:100]}..."
