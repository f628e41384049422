"""The certificate: what was proved of which bytes, signed, and checked again before anything moves.

The body names by SHA-256 the inputs and every part of the package, and each property with its verdict, bound,
assumptions, conditions and checker. A signature (Ed25519) says who made it, not that it is true:
``check_package`` believes nothing and runs the stream checker again.
"""

from __future__ import annotations

import base64
import hashlib
import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gproof.ir import codes
from gproof.ir.finding import Finding, Severity, Span
from gproof.ir.machine import Machine
from gproof.ir.record import record
from gproof.ir.setup import Interval, Setup
from gproof.ir.stream import StepStream
from gproof.ir.symbols import describe
from gproof.ir.text import print_ir
from gproof.ir.trace import Trace
from gproof.ir.verdict import DEFAULT_POLICY, Condition, PropertyResult, Verdict
from gproof.verify import certificate_words as words
from gproof.verify.claims import TRACE_CHECKER, other_claims
from gproof.verify.ed25519_points import weakness
from gproof.verify.measured import Moved, NotPlaced, NotStated, Open, Place, open_of, slack, values_of, written
from gproof.verify.measured import moved as move
from gproof.verify.package import (
    BODY,
    FORMAT,
    SIGNATURE,
    CertificateError,
    Package,
    TooLarge,
    beyond_reading,
    canonical,
    parts_of,
    read_package,
    write_members,
)
from gproof.verify.setup_at_hand import differences
from gproof.verify.signature import fits
from gproof.verify.signers import Trusted, judge_signer
from gproof.verify.stream import validate
from gproof.verify.stream_report import BOUNDS, CHECKER, CHECKER_VERSION, StreamReport

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

__all__ = [
    "CertificateError", "Check", "Package", "TooLarge", "check_package", "load_or_create_key", "public_key_text",
    "read_package", "write_package",
]  # fmt: skip

PLACED = "stream-position"
"""The property that has what is asked of offsets that are measured later."""
COMPILE_AGAIN = "a package holds for the setup that it was made for: gproof compile makes one for the setup at hand"


@record(frozen=True, slots=True, kw_only=True)
class Check:
    """What ``check_package`` found. valid: every part holds, so that it may run; stream: the checker's report.

    open: those of the findings that only say of a condition that no setup states what it asks of; conditions: these, by
    the property that has them; moved: of a job with open offsets, Trace and stream where the setup states them, or
    where the stream was made.
    """

    findings: tuple[Finding, ...]
    stream: StreamReport
    signer: str | None
    open: tuple[Finding, ...] = ()
    conditions: tuple[tuple[str, Condition], ...] = ()
    moved: Moved | None = None

    @property
    def valid(self) -> bool:
        """True when no finding is an error or an unknown."""
        return not any(f.severity in (Severity.ERROR, Severity.UNKNOWN) for f in self.findings)

    @property
    def valid_if(self) -> bool:
        """True when nothing but open conditions keeps it from being valid."""
        against = [f for f in self.findings if f.severity in (Severity.ERROR, Severity.UNKNOWN)]
        return bool(self.open) and all(f in self.open for f in against)


def write_package(
    path: Path, *, job: str, version: str, inputs: Iterable[tuple[str, str, str]],
    properties: Iterable[PropertyResult], not_judged: Iterable[str], assumptions: Iterable[str], machine: Machine,
    setup: Setup, trace: Trace, stream: StepStream, report: StreamReport, key: Ed25519PrivateKey | None = None,
    created: str = "", comment: str = "", left_open: Open | None = None,
) -> str:  # fmt: skip
    """Write a package and return the SHA-256 of its body; the file appears whole or not at all.

    inputs: (name, sha256, role); properties: those of the trace; report: of the stream checker;
    Raises TooLarge when it would be larger than a reader takes.
    created, comment: kept beside the signature, outside the body; a second signature covers them; left_open: the
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
            "public_key": _encode(raw_public(key)),
            "signature": _encode(key.sign(data)),
            "created": created,
            "comment": comment,
        }
        members[SIGNATURE] = canonical({**label, "label_signature": _encode(key.sign(canonical(label)))})
    write_members(path, members)
    return hashlib.sha256(data).hexdigest()


def _property(result: PropertyResult, checker: str, version: str, bound: str) -> dict[str, Any]:
    return {
        "name": result.name,
        "verdict": result.verdict.value,
        "bound": bound,
        "assumptions": list(result.assumptions),
        "conditions": [_condition(c) for c in result.conditions],
        "checker": checker,
        "version": version,
    }


def _condition(of: Condition) -> dict[str, Any]:
    return {"terms": [[s, k] for s, k in of.terms], "low": repr(of.low), "high": repr(of.high)}


def check_package(
    package: Package, machine: Machine | None = None, setup: Setup | None = None,
    trusted_keys: Trusted = None, beat: Callable[[int], None] | None = None,
) -> Check:  # fmt: skip
    """Check everything but the hashes (``read_package`` did): signature, machine, verdicts, conditions, stream.

    machine, setup: those at hand, when they are known apart from the package; trusted_keys: public keys of signers
    to accept (None: any signer, an empty list: nobody); beat: as for ``validate``. Never raises for what the package
    says.
    """
    where = Span(package.path, 0)
    findings: list[Finding] = []
    left: list[tuple[Finding, str, Condition]] = []
    signer = _check_signature(package, trusted_keys, findings, where)
    if machine is not None and print_ir(machine) != print_ir(package.machine):
        findings.append(
            codes.CERTIFICATE_MACHINE.at(
                where, what=f"made for machine {package.machine.name!r} in another state than {machine.name!r} is now"
            )
        )
    moved: Moved | None = None
    open_: Open | None = None
    try:
        _check_verdicts(package, findings, where)
        at_hand = setup or package.setup
        open_ = open_of(package.body, package.trace, package.machine, package.setup)
        taken, problems = ({}, []) if open_ is None else values_of(open_.places, at_hand, package.machine)
        known = open_ if open_ is not None and not problems else None
        left = _check_conditions(package, at_hand, findings, where, known, taken)
        left += _not_stated(problems, left, findings, where)
        if open_ is not None:
            at = taken if known else {axis: Fraction(value) for axis, value in open_.reference.items()}
            moved = move(package.trace, package.stream, open_, at, package.machine)
        if setup is not None:
            measured = _condition_symbols(package.body) | (frozenset() if open_ is None else open_.symbols)
            findings += (
                codes.CERTIFICATE_OFFSETS.at(where, what=said, hint=COMPILE_AGAIN)
                for said in differences(package.setup, setup, package.machine, package.trace, measured)
            )
    except (LookupError, ValueError, TypeError, AttributeError, ArithmeticError) as error:
        findings.append(codes.CERTIFICATE_MALFORMED.at(where, what=f"the body is not of its form ({error})"))
    stream, trace = (package.stream, package.trace) if moved is None else (moved.stream, moved.trace)
    report = validate(stream, trace, package.machine, package.setup, beat=beat)
    findings += report.findings
    if not any(f.code is codes.CERTIFICATE_MALFORMED for f in findings):
        try:
            asked = () if open_ is None else tuple(c for p in open_.places.values() for c in p.conditions())
            placed = [_condition(c) for c in asked]
            findings += other_claims(package, report, where, {PLACED: placed})
        except (LookupError, ValueError, TypeError, AttributeError) as error:
            findings.append(codes.CERTIFICATE_MALFORMED.at(where, what=f"the body is not of its form ({error})"))
    if report.verdict is not Verdict.SAFE and not report.findings:
        findings.append(codes.CERTIFICATE_VERDICT.at(where, what="the stream checker could not judge every property"))
    return Check(
        findings=tuple(findings), stream=report, signer=signer, open=tuple(finding for finding, _, _ in left),
        conditions=tuple((name, condition) for _, name, condition in left), moved=moved,
    )  # fmt: skip


Left = list[tuple[Finding, str, Condition]]


def _not_stated(problems: list[tuple[Place, NotPlaced]], left: Left, findings: list[Finding], where: Span) -> Left:
    """Findings for offsets that have to be measured and that the setup does not state, or not as they have to be."""
    found: Left = []
    asked = {symbol for _, _, condition in left for symbol, _ in condition.terms}
    for place, error in problems:
        if isinstance(error, NotStated) and asked.intersection(error.symbols):
            continue  # the condition says so
        finding = codes.CERTIFICATE_OFFSETS.at(where, what=str(error))
        findings.append(finding)
        if isinstance(error, NotStated):
            found += [(finding, PLACED, condition) for condition in place.conditions()]
    return found


def _condition_symbols(body: dict[str, Any]) -> frozenset[str]:
    """What conditions ask of: left open when the job was judged, and stated now."""
    conditions = [c for prop in body.get("properties", []) for c in prop.get("conditions", [])]
    return frozenset(str(symbol) for condition in conditions for symbol, _ in condition["terms"])


def _check_signature(package: Package, trusted: Trusted, findings: list[Finding], where: Span) -> str | None:
    """Who signed, in base64; None for nobody, and for a signature that says nothing."""
    if package.signature is None:
        if trusted is not None:
            findings.append(codes.CERTIFICATE_UNTRUSTED.at(where, what="unsigned: nobody says where it comes from"))
        else:
            findings.append(codes.CERTIFICATE_UNSIGNED.at(where))
        return None
    if not fits(package.signature, package.body_bytes):
        findings.append(codes.CERTIFICATE_SIGNATURE.at(where, what="the signature does not fit the certificate"))
        return None
    raw = _decode(package.signature["public_key"])
    findings += judge_signer(raw, trusted, where, created=str(package.signature.get("created", "")))
    return _encode(raw)


def _check_verdicts(package: Package, findings: list[Finding], where: Span) -> None:
    """Every property of the policy and of the stream is listed, once, and SAFE; none listed is UNSAFE."""
    body = package.body
    if body.get("format") != FORMAT:
        findings.append(codes.CERTIFICATE_MALFORMED.at(where, what=f"format {body.get('format')!r} is not {FORMAT}"))
    listed = [(str(p["name"]), str(p["verdict"])) for p in body["properties"]]
    for name in (*DEFAULT_POLICY, *BOUNDS):
        verdicts = [v for n, v in listed if n == name] or ["missing"]
        if verdicts != [Verdict.SAFE.value]:
            said = " and ".join(verdicts)
            findings.append(codes.CERTIFICATE_VERDICT.at(where, what=f"property {name} is {said}, not SAFE"))
    for name, verdict in listed:
        if verdict not in Verdict.__members__ or (verdict == "UNSAFE" and name not in (*DEFAULT_POLICY, *BOUNDS)):
            findings.append(codes.CERTIFICATE_VERDICT.at(where, what=f"property {name} is {verdict}"))


def _check_conditions(
    package: Package, setup: Setup, findings: list[Finding], where: Span, open_: Open | None,
    taken: Mapping[int, Fraction],
) -> Left:  # fmt: skip
    """Findings for conditions that do not hold; those of which the setup states nothing, with their property.

    open_, taken: offsets that are taken for whole steps, with which they have to hold too.
    """
    left: Left = []
    for prop in package.body.get("properties", []):
        for condition in prop.get("conditions", []):
            low, high = float(condition["low"]), float(condition["high"])
            terms = tuple((str(symbol), int(count)) for symbol, count in condition["terms"])
            known = _sum(condition["terms"], setup)
            more = 0.0
            if open_ is not None and prop.get("name") != PLACED:
                more = slack(open_.places, taken, Condition(terms=terms, low=low, high=high), setup)
            if known is None or not (low + more <= known.low and known.high <= high - more):
                stated = "not stated" if known is None else words.between(known.low, known.high)
                stated += f", and {words.number(more)} beside it on whole steps," if more else ""
                names = describe(terms, package.machine)
                finding = codes.CERTIFICATE_OFFSETS.at(
                    where, what=f"the certificate holds for {names} {words.between(low, high)}; it is {stated} now"
                )
                findings.append(finding)
                if known is None:
                    left.append((finding, str(prop["name"]), Condition(terms=terms, low=low, high=high)))
    return left


def _sum(terms: list[list[Any]], setup: Setup) -> Interval | None:
    low = high = 0.0
    for symbol, coefficient in terms:
        known = setup.interval(str(symbol))
        if known is None:
            return None
        ends = (known.low * int(coefficient), known.high * int(coefficient))
        low, high = low + min(ends), high + max(ends)
    return Interval(low, high)


def _encode(raw: bytes) -> str:
    return base64.b64encode(raw).decode()


def _decode(text: str) -> bytes:
    """ValueError for any spelling but the one of ``_encode``."""
    raw = base64.b64decode(text, validate=True)
    if _encode(raw) != text:
        raise ValueError("base64 with bits left over")
    return raw


def raw_public(key: Ed25519PrivateKey) -> bytes:
    """The 32 bytes of the public half."""
    from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat

    return key.public_key().public_bytes(Encoding.Raw, PublicFormat.Raw)


def load_key(path: Path) -> Ed25519PrivateKey:
    """An Ed25519 private key from a PEM file; ValueError when it is none."""
    from cryptography.exceptions import UnsupportedAlgorithm
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
    from cryptography.hazmat.primitives.serialization import load_pem_private_key

    try:
        key = load_pem_private_key(path.read_bytes(), password=None)
    except (ValueError, TypeError, UnsupportedAlgorithm):
        raise ValueError(f"{path} is no private key in PEM form without a password") from None
    if not isinstance(key, Ed25519PrivateKey):
        raise ValueError(f"{path} is no Ed25519 key")
    return key


def load_or_create_key(path: Path) -> Ed25519PrivateKey:
    """The key at ``path``; a new one is made there, readable by its owner alone, when there is none.

    ValueError for a file that is no such key, or that others may read.
    """
    if path.exists():
        if not path.is_file():
            raise ValueError(f"{path} is not a regular file")
        if os.name == "posix" and path.stat().st_mode & 0o077:
            raise ValueError(f"{path} can be read or written by others: chmod 600 it, or make a new key")
        return load_key(path)
    return create_key(path)


def create_key(path: Path) -> Ed25519PrivateKey:
    """A new key, readable by its owner alone; OSError where there is a file already."""
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
    from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat

    key = Ed25519PrivateKey.generate()
    text = key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())
    path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    with os.fdopen(handle, "wb") as out:
        out.write(text)
    return key


def public_key_text(key: Ed25519PrivateKey | bytes) -> str:
    """The public half of a key, or a raw public one, in PEM, to hand out."""
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey
    from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat

    public = Ed25519PublicKey.from_public_bytes(key) if isinstance(key, bytes) else key.public_key()
    return public.public_bytes(Encoding.PEM, PublicFormat.SubjectPublicKeyInfo).decode()


def load_public_key(path: Path) -> bytes:
    """The raw public key of a PEM file; ValueError when it is none, or when it holds more than that."""
    from cryptography.exceptions import UnsupportedAlgorithm
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey
    from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat, load_pem_public_key

    data = path.read_bytes()
    if b"PRIVATE KEY" in data:
        raise ValueError(f"{path} is a private key, which is given to nobody; gproof keys show prints its public half")
    if data.count(b"-----BEGIN ") > 1:
        raise ValueError(f"{path} holds more than one key, and which is meant it does not say")
    try:
        key = load_pem_public_key(data)
    except (ValueError, TypeError, UnsupportedAlgorithm):
        raise ValueError(f"{path} is no public key in PEM form") from None
    if not isinstance(key, Ed25519PublicKey):
        raise ValueError(f"{path} is no Ed25519 key")
    raw = key.public_bytes(Encoding.Raw, PublicFormat.Raw)
    if weak := weakness(raw):
        raise ValueError(f"{path}: the key {weak}")
    return raw
