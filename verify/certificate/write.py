"""Write a certified stream: the body with what was proved of which bytes, signed, and its parts, in one file."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gproof.ir.machine import Machine
from gproof.ir.setup import Setup
from gproof.ir.stream import StepStream
from gproof.ir.trace import Trace
from gproof.ir.verdict import DEFAULT_POLICY, Condition, PropertyResult
from gproof.verify.certificate.claims import TRACE_CHECKER
from gproof.verify.certificate.keys import raw_public
from gproof.verify.certificate.measured import Open, written
from gproof.verify.certificate.package import (
    BODY,
    FORMAT,
    SCHEMAS,
    SIGNATURE,
    TooLarge,
    beyond_reading,
    canonical,
    parts_of,
    write_members,
)
from gproof.verify.explain.stream_report import BOUNDS, CHECKER, CHECKER_VERSION, StreamReport

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

PLACED = "stream-position"
"""The property that has what is asked of offsets that are measured later."""


def write_package(
    path: Path, *, job: str, version: str, inputs: Iterable[tuple[str, str, str]],
    properties: Iterable[PropertyResult], not_judged: Iterable[str], assumptions: Iterable[str], machine: Machine,
    setup: Setup, trace: Trace, stream: StepStream, report: StreamReport, key: Ed25519PrivateKey | None = None,
    created: str = "", comment: str = "", left_open: Open | None = None,
) -> str:  # fmt: skip
    """Write a package and return the SHA-256 of its body; the file appears whole or not at all.

    inputs: (name, sha256, role); properties: those of the trace; report: of the stream checker;
    Raises TooLarge when it would be larger than a reader takes.
    created, comment: kept next to the signature, outside the body; a second signature covers them; left_open: the
    offsets that are measured later, of which the runtime asks what the position of the stream then has as conditions.
    """
    members = parts_of(machine, setup, trace, stream)
    if why := beyond_reading(members, trace, stream):
        raise TooLarge(why)
    of_stream = report.properties
    if left_open is not None:
        asked = tuple(c for place in left_open.places.values() for c in place.conditions())
        of_stream = tuple(replace(p, conditions=asked) if p.name == PLACED else p for p in of_stream)
    body: dict[str, Any] = {
        "format": FORMAT,
        "schemas": SCHEMAS,
        "gproof": version,
        "job": job,
        "policy": list(DEFAULT_POLICY),
        "inputs": [{"name": n, "sha256": d, "role": r} for n, d, r in sorted(inputs, key=lambda i: (i[2], i[0]))],
        "members": {name: hashlib.sha256(data).hexdigest() for name, data in members.items()},
        "sizes": {name: len(data) for name, data in members.items()},
        "properties": [
            *(_property(p, TRACE_CHECKER, version, "") for p in properties),
            *(_property(p, CHECKER, CHECKER_VERSION, BOUNDS[p.name]) for p in of_stream),
        ],
        "not_judged": sorted(not_judged),
        "assumptions": list(assumptions),
        "steps": report.steps,
        "duration_ticks": sum(s.duration for s in stream.sections),
    }
    if left_open is not None:
        body["reference"] = written(left_open.places, left_open.reference)
    data = canonical(body)
    members[BODY] = data
    if key is not None:
        label = {
            "public_key": base64_of(raw_public(key)),
            "signature": base64_of(key.sign(data)),
            "created": created,
            "comment": comment,
        }
        members[SIGNATURE] = canonical({**label, "label_signature": base64_of(key.sign(canonical(label)))})
    write_members(path, members)
    return hashlib.sha256(data).hexdigest()


def _property(result: PropertyResult, checker: str, version: str, bound: str) -> dict[str, Any]:
    return {
        "name": result.name,
        "verdict": result.verdict.value,
        "bound": bound,
        "assumptions": list(result.assumptions),
        "conditions": [condition_json(c) for c in result.conditions],
        "checker": checker,
        "version": version,
    }


def condition_json(of: Condition) -> dict[str, Any]:
    """A condition as a body has it."""
    return {"terms": [[s, k] for s, k in of.terms], "low": repr(of.low), "high": repr(of.high)}


def base64_of(raw: bytes) -> str:
    """Bytes as a body and a signature have them."""
    return base64.b64encode(raw).decode()
