"""Findings that somebody has looked at and accepts: by a comment in the program with a reason, or by a baseline.

Accepted findings stay in every report, marked; a verdict never changes by them. A comment accepts notes, warnings and
unknowns; an error it cannot accept.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from pathlib import Path

from gproof.driver.errors import UsageError
from gproof.driver.files import require_file, write_text
from gproof.driver.judge import Judgement
from gproof.driver.outcome import Fingerprints
from gproof.frontend.common.own_keys import KEYS, suggestion, unknown_keys
from gproof.frontend.common.toml_table import meant
from gproof.ir import codes
from gproof.ir.codes import CODES
from gproof.ir.finding import Finding, Findings, Severity, Span, brief, distinct
from gproof.ir.mapped import pieces
from gproof.ir.notes import NoteKind
from gproof.ir.program import Program, SourceFile
from gproof.ir.record import record
from gproof.passes.checks.registry import not_judged

SCHEMA = "gproof-baseline/1"
IN_SOURCE, EXTERNAL = "inSource", "external"
"""How a finding was accepted, in the words of SARIF."""
MANY = 100_000
"""Findings of a code that are kept while some may be accepted: those left out could not be."""

Known = dict[str, list[dict[str, str]]]
"""Findings as a baseline has them, by file."""

_SIGN = b"gproof:"
_PIECE = 1 << 20
_ALLOW = re.compile(
    r"gproof:\s*allow(?P<whole>-file)?\s+(?P<codes>[\w-]+(?:\s*,\s*[\w-]+)*)\s*(?::|--)?\s*(?P<reason>.*)", re.I | re.S
)
_FORM = "the form is gproof: allow GP243: the reason"
_COMMENTS = (NoteKind.COMMENT, NoteKind.REMARK, NoteKind.SIGNED)


@record(frozen=True, slots=True, kw_only=True)
class Allowed:
    """A comment that accepts findings. numbers: of codes; line: where they are accepted, 0: in the whole file."""

    span: Span
    numbers: frozenset[int]
    line: int
    reason: str


def may_accept(program: Program | None) -> bool:
    """Whether a file of the program may hold such a comment."""
    return program is not None and any(True for file in program.files for _ in _signs(file.data))


def _signs(data: bytes) -> Iterator[int]:
    """Where the sign of such a comment starts, in any case of letters; by pieces, as the file may be mapped."""
    for begin, piece in pieces(data, len(_SIGN) - 1, _PIECE):
        # Most programs have no colon at all, and one byte is found much faster than a word.
        if b":" not in piece:
            continue
        lower = piece.lower()
        at = lower.find(_SIGN)
        while at >= 0:
            yield begin + at
            at = lower.find(_SIGN, at + 1)


def _feeds(data: bytes, begin: int, end: int) -> int:
    """How many lines end in ``data[begin:end]``."""
    return sum(data[at : min(at + _PIECE, end)].count(b"\n") for at in range(begin, end, _PIECE))


def comments(program: Program, findings: Findings) -> Iterator[Allowed]:
    """The comments of a program that accept findings; GP608 for one that says it in no right way."""
    for index, file in enumerate(program.files):
        number, counted = 1, 0
        for found in _signs(file.data):
            begin = file.data.rfind(b"\n", 0, found) + 1
            number, counted = number + _feeds(file.data, counted, begin), begin
            notes, _, _ = program.load_notes(index, begin, number, 1)
            for line, _, kind, _, text in notes.lines(number, number):
                if line == number and kind in _COMMENTS and _SIGN in text.lower():
                    yield from _allowed(file, begin, number, found - begin, text, findings)


def _allowed(
    file: SourceFile, begin: int, number: int, at: int, text: bytes, findings: Findings
) -> Iterator[Allowed]:  # fmt: skip
    raw = file.data[begin : (file.data.find(b"\n", begin) + 1 or len(file.data))]
    plain = text.decode("utf-8", "replace").strip()
    column = len(raw[:at].decode("utf-8", "replace")) + 1
    span = Span(file.name, number, column, column + len(plain[plain.lower().index("gproof:") :].rstrip(" )]}")))
    stated = _ALLOW.search(plain)
    if stated is None:
        findings.add(codes.BAD_ALLOWANCE.at(span, what="says nothing that gproof knows", hint=_FORM))
        return
    by_name = {code.name: code.number for code in CODES.values()} | {c.label.lower(): c.number for c in CODES.values()}
    written = [name.strip() for name in stated["codes"].split(",")]
    names = [name.lower() for name in written]
    for name in written:
        if name.lower() not in by_name:
            hint = meant(name, by_name)
            findings.add(codes.BAD_ALLOWANCE.at(span, what=f"names {name!r}, which is no finding", hint=hint))
            return
    reason = stated["reason"].rstrip(" \t)]}").strip()
    if not reason:
        findings.add(codes.BAD_ALLOWANCE.at(span, what="gives no reason", hint=_FORM))
        return
    # Alone on its line a comment speaks of the next one.
    place = raw.find(text)
    rest = raw[place + len(text) :].strip().lstrip(b")]}").strip()
    alone = not rest and not re.search(rb"[^\s()\[\]{};'/]", raw[:place])
    line = 0 if stated["whole"] else number + 1 if alone else number
    yield Allowed(span=span, numbers=frozenset(by_name[name] for name in names), line=line, reason=reason)


def accept_comments(program: Program, judgement: Judgement) -> list[Finding]:
    """Mark what comments accept; what is to tell of them themselves: GP608, GP609, GP610."""
    findings, told = judgement.findings, Findings()
    # What nobody judged this time may be there all the same.
    left_open = set(not_judged(result.name for result in judgement.properties))
    for allowed in comments(program, told):
        met = [
            finding
            for finding in findings.kept
            if finding.code.number in allowed.numbers
            and finding.span.file == allowed.span.file
            and allowed.line in (0, finding.span.line)
        ]
        if not met and not any(CODES[number].decides in left_open for number in allowed.numbers):
            told.add(codes.UNUSED_ALLOWANCE.at(allowed.span, codes=_labels(allowed.numbers)))
        for finding in met:
            if finding.severity is Severity.ERROR:
                told.add(codes.ERROR_NOT_ALLOWED.at(allowed.span, code=finding.code.label))
            else:
                judgement.accepted[finding] = IN_SOURCE, allowed.reason
    return told.kept


def _labels(numbers: frozenset[int]) -> str:
    return ", ".join(CODES[number].label for number in sorted(numbers))


# ---- baselines


def _places(findings: Findings) -> Iterator[tuple[Finding, str]]:
    """The findings by place, each with its fingerprint."""
    kept = [finding for finding, _ in distinct(findings)]
    marks = Fingerprints().of([(f.span.file, f.span.line, f.code.label) for f in kept])
    yield from zip(kept, marks, strict=True)


def _file_key(name: str, folder: Path) -> str:
    return Path(os.path.relpath(os.path.abspath(name), folder.resolve())).as_posix()


@record(slots=True)
class Baseline:
    """Findings that are known. known: by file, seen from the folder of the baseline, messages by fingerprint."""

    path: Path
    known: dict[str, dict[str, str]]

    def accept(self, judgement: Judgement) -> None:
        """Mark the findings that are known.

        An error, and what is at no line, is known with its message alone: other numbers, another axis are new.
        """
        for finding, mark in _places(judgement.findings):
            message = self.known.get(_file_key(finding.span.file, self.path.parent), {}).get(mark)
            exactly = finding.severity is Severity.ERROR or not finding.span.line
            if message is not None and (message == finding.message or not exactly):
                judgement.accepted.setdefault(finding, (EXTERNAL, f"in the baseline {self.path}"))


def read_baseline(path: Path) -> Baseline:
    """A baseline file; UsageError for what is none."""
    require_file(path, "baseline")
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        if data["schema"] != SCHEMA:
            raise UsageError(f"baseline {path}: schema is {brief(repr(data['schema']))}, must be {SCHEMA!r}")
        wrong = [
            f"{'.'.join((*place, key))!r} ({suggestion(key, SCHEMA, (*keys.own, *keys.tables), ())})"
            for place, key, keys in unknown_keys(data, KEYS[SCHEMA], {})
        ]
        if wrong:
            raise UsageError(f"baseline {path}: there is no key {', nor '.join(wrong)}")
        known = {
            str(name): {str(entry["fingerprint"]): str(entry["message"]) for entry in found}
            for name, found in data["files"].items()
        }
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise UsageError(f"baseline {path}: not a baseline; --write-baseline writes one") from None
    return Baseline(path, known)


def known_findings(judgement: Judgement, folder: Path) -> Known:
    """What a baseline in ``folder`` says of a job: its findings but those that comments accept."""
    out: Known = {}
    for finding, mark in _places(judgement.findings):
        kind, _ = judgement.accepted.get(finding, ("", ""))
        if kind != IN_SOURCE:
            entry = {"fingerprint": mark, "code": finding.code.label, "message": finding.message}
            out.setdefault(_file_key(finding.span.file, folder), []).append(entry)
    return out


def write_baseline(path: Path, found: list[Known]) -> int:
    """Write what is found now as known; returns how many findings."""
    files: dict[str, dict[str, dict[str, str]]] = {}
    for job in found:
        for name, entries in job.items():
            files.setdefault(name, {}).update({entry["fingerprint"]: entry for entry in entries})
    known = {name: [files[name][mark] for mark in sorted(files[name])] for name in sorted(files)}
    text = json.dumps({"schema": SCHEMA, "files": known}, indent=2, ensure_ascii=False) + "\n"
    write_text(path, text, "baseline")
    return sum(map(len, known.values()))
