"""The certificate: what was proved of which bytes, signed, and checked again before anything moves.

The body names by SHA-256 the inputs and every part of the package, and each property with its verdict, bound,
assumptions, conditions and checker. A signature (Ed25519) says who made it, not that it is true:
``check_package`` believes nothing and runs the stream checker again.
"""

from __future__ import annotations

import base64
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

from gproof.ir import codes
from gproof.ir.finding import Finding, Severity, Span
from gproof.ir.machine import Machine
from gproof.ir.record import record
from gproof.ir.setup import Interval, Setup
from gproof.ir.symbols import describe
from gproof.ir.text import print_ir
from gproof.ir.verdict import DEFAULT_POLICY, Condition, Verdict
from gproof.verify.certificate.claims import other_claims
from gproof.verify.certificate.measured import (
    Moved,
    NotPlaced,
    NotStated,
    Open,
    Place,
    open_of,
    slack,
    values_of,
)
from gproof.verify.certificate.measured import moved as move
from gproof.verify.certificate.package import (
    FORMAT,
    Package,
)
from gproof.verify.certificate.setup_at_hand import differences
from gproof.verify.certificate.signature import fits
from gproof.verify.certificate.signers import Trusted, judge_signer
from gproof.verify.certificate.write import PLACED, base64_of, condition_json
from gproof.verify.explain import certificate_words as words
from gproof.verify.explain.stream_report import BOUNDS, StreamReport
from gproof.verify.stream import validate

COMPILE_AGAIN = "a package is valid for the setup that it was made for: compile the job again with the present setup"


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


def check_package(
    package: Package, machine: Machine | None = None, setup: Setup | None = None,
    trusted_keys: Trusted = None, beat: Callable[[int], None] | None = None, *, pure: bool = False,
) -> Check:  # fmt: skip
    """Check everything but the hashes (``read_package`` did): signature, machine, verdicts, conditions, stream.

    machine, setup: those at hand, when they are known apart from the package; trusted_keys: public keys of signers
    to accept (None: any signer, an empty list: nobody); beat, pure: as for ``validate``. Never raises for what the
    package says.
    """
    where = Span(package.path, 0)
    findings: list[Finding] = []
    left: list[tuple[Finding, str, Condition]] = []
    signer = _check_signature(package, trusted_keys, findings, where)
    if machine is not None and print_ir(machine) != print_ir(package.machine):
        said = f"not for {machine.name!r}" if machine.name != package.machine.name else "with other settings than now"
        what = f"made for machine {package.machine.name!r}, {said}"
        findings.append(codes.CERTIFICATE_MACHINE.at(where, what=what))
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
        findings.append(codes.CERTIFICATE_MALFORMED.at(where, what=f"the body is malformed ({error})"))
    stream, trace = (package.stream, package.trace) if moved is None else (moved.stream, moved.trace)
    report = validate(stream, trace, package.machine, package.setup, beat=beat, pure=pure)
    findings += report.findings
    if not any(f.code is codes.CERTIFICATE_MALFORMED for f in findings):
        try:
            asked = () if open_ is None else tuple(c for p in open_.places.values() for c in p.conditions())
            placed = [condition_json(c) for c in asked]
            findings += other_claims(package, report, where, {PLACED: placed})
        except (LookupError, ValueError, TypeError, AttributeError) as error:
            findings.append(codes.CERTIFICATE_MALFORMED.at(where, what=f"the body is malformed ({error})"))
    if report.verdict is not Verdict.SAFE and not report.findings:
        findings.append(codes.CERTIFICATE_VERDICT.at(where, what="the stream checker could not decide every property"))
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
            findings.append(codes.CERTIFICATE_UNTRUSTED.at(where, what="it is not signed"))
        else:
            findings.append(codes.CERTIFICATE_UNSIGNED.at(where))
        return None
    if not fits(package.signature, package.body_bytes):
        findings.append(codes.CERTIFICATE_SIGNATURE.at(where, what="the signature does not fit the certificate"))
        return None
    raw = _decode(package.signature["public_key"])
    findings += judge_signer(raw, trusted, where, created=str(package.signature.get("created", "")))
    return base64_of(raw)


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
                stated = "not in the setup" if known is None else words.between(known.low, known.high)
                stated += f" ({words.number(more)} more or less, rounded to motor steps)" if more else ""
                names = describe(terms, package.machine)
                finding = codes.CERTIFICATE_OFFSETS.at(
                    where, what=f"valid for {names} {words.between(low, high)}; now it is {stated}"
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


def _decode(text: str) -> bytes:
    """ValueError for any spelling but the one of ``base64_of``."""
    raw = base64.b64decode(text, validate=True)
    if base64_of(raw) != text:
        raise ValueError("base64 with bits left over")
    return raw
