"""The ``.gpx`` file: a zip of the certificate's body, its signature and the parts it speaks of.

Members: ``body.json`` (what is signed), ``signature.json`` (outside every hash), ``machine.ir``, ``setup.ir``,
``trace.ir``, ``stream.ir`` (text forms, in which the number of its rows stands for each table), and one ``.bin`` a kind
of table: the rows of all sections, one section after the other, as the columns of its schema, little-endian. Same
inputs, same bytes: members in sorted order, fixed times. The comment is the SHA-256 of all bytes before it, so that
no damaged file is taken for a whole one.
Nothing is believed while reading; docs/certificate.md defines the format.
"""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import itertools
import json
import re
import struct
import zipfile
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from gproof.ir import codes
from gproof.ir.columns import Column, Columns, Schema
from gproof.ir.machine import Machine
from gproof.ir.number_ranges import LONGEST_TABLE, number_problem
from gproof.ir.record import record
from gproof.ir.setup import Setup
from gproof.ir.stream import EVENT, RUN, StepStream
from gproof.ir.text import TOKENS, NotKnown, parse_texts, print_ir, words_of
from gproof.ir.trace import TRACE_ROW, Trace
from gproof.verify.certificate.conform import misfit
from gproof.verify.certificate.package_zip import FILE_LIMIT, CertificateError, Sealed, open_sealed, seal, write_members
from gproof.verify.certificate.signature import fits

__all__ = [
    "BODY", "FORMAT", "SCHEMAS", "SIGNATURE", "CertificateError", "Package", "TooLarge", "beyond_reading", "canonical",
    "parts_of", "read_package", "seal", "write_members",
]  # fmt: skip

BODY, SIGNATURE = "body.json", "signature.json"
TEXTS = ("machine.ir", "setup.ir", "trace.ir", "stream.ir")
FORMAT = "gproof-certificate/4"
SCHEMAS = {"machine": 1, "setup": 1, "stream": 1, "trace": 1}
"""By part the number of its schema: the types of its text with their fields and defaults, the columns of its tables.

It rises when an older text would have another meaning, or none, to this version; a field that is added with a default
raises none. tests/ir/schemas.md has what each number stands for.
"""
MEMBER_LIMIT = FILE_LIMIT
"""Bytes of one kind of table at most; below, of a text, of the body, of the signature: more is refused unread."""
TEXT_LIMIT = 64 << 20
TRACE_TABLE, EVENT_TABLE = "trace.bin", "stream/events.bin"
BODY_LIMIT = 32 << 20
SIGNATURE_LIMIT = 1 << 16


@record(frozen=True, slots=True, kw_only=True)
class Package:
    """A package as read: its parts, the parsed body with its exact bytes, and the signature (None: unsigned)."""

    path: str
    body: dict[str, Any]
    body_bytes: bytes
    signature: dict[str, Any] | None
    machine: Machine
    setup: Setup
    trace: Trace
    stream: StepStream

    @property
    def sha256(self) -> str:
        """The certificate's identity: SHA-256 of its body."""
        return hashlib.sha256(self.body_bytes).hexdigest()


def canonical(value: Any) -> bytes:
    """JSON with sorted keys and no blanks, UTF-8; floats in their shortest exact form, no NaN."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()


def parts_of(machine: Machine, setup: Setup, trace: Trace, stream: StepStream) -> dict[str, bytes]:
    """Every hashed member by name."""
    bare_trace = dataclasses.replace(
        trace, sections=[dataclasses.replace(s, rows=_rows_of(s.rows)) for s in trace.sections]
    )
    bare_stream = dataclasses.replace(
        stream,
        sections=[
            dataclasses.replace(s, runs=tuple(map(_rows_of, s.runs)), events=_rows_of(s.events))
            for s in stream.sections
        ],
    )
    members = {
        "machine.ir": print_ir(machine).encode(),
        "setup.ir": print_ir(setup).encode(),
        "trace.ir": print_ir(bare_trace).encode(),
        "stream.ir": print_ir(bare_stream).encode(),
    }
    members.update((name, _encode(schema, tables)) for name, schema, tables in _tables(trace, stream))
    return members


class TooLarge(ValueError):
    """A package that nobody would read, for its size alone."""


def beyond_reading(members: dict[str, bytes], trace: Trace, stream: StepStream) -> str:
    """Why a package of these parts would be refused unread for its size alone; an empty text when it is not."""
    for name, data in members.items():
        limit = MEMBER_LIMIT if name.endswith(".bin") else TEXT_LIMIT
        if len(data) > limit:
            return f"{name} has {len(data)} bytes, at most {limit} are read"
    for name, _, tables in _tables(trace, stream):
        rows = sum(map(len, tables))
        if rows > LONGEST_TABLE:
            return f"{name} has {rows} rows, at most {LONGEST_TABLE} are read"
    texts = [members[name] for name in TEXTS]
    if sum(map(len, texts)) > TOKENS:
        words = sum(words_of(text.decode()) for text in texts)
        if words > TOKENS:
            return f"its texts have {words} words, at most {TOKENS} are read: it has too many sections"
    return ""


def _rows_of(table: Columns) -> Any:
    """What stands for a table in a text."""
    return len(table)


def _tables(trace: Trace, stream: StepStream) -> Iterator[tuple[str, Schema, list[Columns]]]:
    """By member, the tables that it has one after the other."""
    yield TRACE_TABLE, TRACE_ROW, [section.rows for section in trace.sections]
    for motor in range(_motors(stream)):
        yield run_table(motor), RUN, [part.runs[motor] for part in stream.sections if motor < len(part.runs)]
    yield EVENT_TABLE, EVENT, [part.events for part in stream.sections]


def _motors(stream: StepStream) -> int:
    return max((len(part.runs) for part in stream.sections), default=0)


def run_table(motor: int) -> str:
    """The member that has the runs of a motor."""
    return f"stream/{motor}.bin"


def _little(dtype: str) -> np.dtype[Any]:
    return np.dtype(dtype).newbyteorder("<")


def _encode(schema: Schema, tables: list[Columns]) -> bytes:
    return b"".join(
        table[c.name].astype(_little(c.dtype), copy=False).tobytes() for c in schema.columns for table in tables
    )


def _decode(schema: Schema, data: bytes | bytearray) -> Columns:
    if not data:
        return Columns(schema)
    layout = _layout(schema)
    rows, rest = divmod(len(data), sum(size for _, _, _, size in layout))
    if rest:
        raise ValueError(f"a {schema.name} table of {len(data)} bytes is not a whole number of rows")
    arrays, at = {}, 0
    for c, little, dtype, size in layout:
        flat = np.frombuffer(data, dtype=little, count=rows * c.width, offset=at).astype(dtype)
        arrays[c.name] = flat.reshape(rows, c.width) if c.width > 1 else flat
        at += rows * size
    return Columns(schema, arrays)


@functools.cache
def _layout(schema: Schema) -> tuple[tuple[Column, np.dtype[Any], np.dtype[Any], int], ...]:
    """Each column with its type in the file, its type in memory, and its bytes a row."""
    return tuple((c, _little(c.dtype), np.dtype(c.dtype), np.dtype(c.dtype).itemsize * c.width) for c in schema.columns)


def read_package(path: Path) -> Package:
    """Read and re-hash a package; CertificateError for anything but a whole, unaltered one."""
    try:
        return _read(path)
    except CertificateError:
        raise
    except OSError as error:
        raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), error.strerror or "cannot be read") from None
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, struct.error) as error:
        raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), f"not a complete zip file ({error})") from None
    except (ValueError, LookupError, TypeError, AttributeError, ArithmeticError, MemoryError, AssertionError) as error:
        raise CertificateError(
            codes.CERTIFICATE_MALFORMED, str(path), f"not a certified stream ({type(error).__name__}: {error})"
        ) from None


def _read(path: Path) -> Package:
    with open_sealed(path) as sealed:
        _there(sealed, BODY)
        body_bytes = sealed.small(BODY, BODY_LIMIT)
        body = _json(path, BODY, body_bytes)
        _check_format(path, body)
        _there(sealed, *TEXTS)
        signature = None
        if SIGNATURE in sealed.names:
            signature = _json(path, SIGNATURE, sealed.small(SIGNATURE, SIGNATURE_LIMIT))
            if not fits(signature, body_bytes):
                what = "the signature does not fit the certificate"
                raise CertificateError(codes.CERTIFICATE_SIGNATURE, str(path), what)
        parts = _Parts(path, sealed, body)
        try:
            machine, setup, trace, stream = parse_texts(parts.take(name).decode() for name in TEXTS)
        except NotKnown as strange:
            raise _other_version(path, body, f"another version ({strange} here)") from None
        _fill(path, trace, stream, parts)
        for value, kind in ((machine, Machine), (setup, Setup), (trace, Trace), (stream, StepStream)):
            wrong = misfit(value, kind, kind.__name__)
            if wrong:
                raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), wrong)
            _check_numbers(path, kind.__name__, value, tables=kind is not Trace and kind is not StepStream)
        left = parts.left()
        if left:
            raise ValueError(f"an unexpected table: {left}")
    machine.verify()
    trace.verify()
    stream.verify()
    return Package(
        path=str(path), body=body, body_bytes=body_bytes, signature=signature, machine=machine, setup=setup,
        trace=trace, stream=stream,
    )  # fmt: skip


def _there(sealed: Sealed, *names: str) -> None:
    for name in names:
        if name not in sealed.names:
            raise sealed.refused(f"{name} is missing")


def _check_numbers(path: Path, name: str, value: object, *, tables: bool) -> None:
    wrong = number_problem(value, tables=tables)
    if wrong is not None:
        what = f"{name}{'' if wrong.where.startswith('[') else '.'}{wrong.where}: {wrong.what}"
        raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), what)


def _check_format(path: Path, body: dict[str, Any]) -> None:
    """Format and schemas are those that this version writes; GP857 for others of their form."""
    said = body.get("format")
    family, _, number = str(said).partition("/")
    mine, _, current = FORMAT.partition("/")
    if family != mine or not number.isdecimal() or len(number) > 4 or str(int(number)) != number:
        raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), f"format {said!r} is not {FORMAT}")
    if said != FORMAT:
        age = "an older" if int(number) < int(current) else "a newer"
        raise _other_version(path, body, f"{age} version ({said}; this one reads {FORMAT})")
    schemas = body.get("schemas")
    if not isinstance(schemas, dict) or not all(type(n) is int and 0 < n < 10_000 for n in schemas.values()):
        raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), "the numbers of its schemas are missing")
    for part in sorted(SCHEMAS.keys() | schemas.keys()):
        there, here = schemas.get(part, 0), SCHEMAS.get(part, 0)
        if there != here:
            age = "an older" if there < here else "a newer"
            what = f"{age} version (schema {there} of {part[:40]}; this one reads {here})"
            raise _other_version(path, body, what)


_VERSION = re.compile(r"[0-9A-Za-z][0-9A-Za-z.+-]{0,39}", re.ASCII)


def _other_version(path: Path, body: dict[str, Any], what: str) -> CertificateError:
    """The error for a package that another version made; what it says of itself is not believed, only reported."""
    version = body.get("gproof")
    maker = f"gproof {version}" if isinstance(version, str) and _VERSION.fullmatch(version) else "gproof"
    return CertificateError(codes.CERTIFICATE_FORMAT, str(path), f"made by {maker}, {what}")


class _Parts:
    """The members that a body names, each inflated once, when it is needed, to the size that the body states."""

    def __init__(self, path: Path, sealed: Sealed, body: dict[str, Any]) -> None:
        self._path = path
        self._sealed = sealed
        self._digests: dict[str, str] = body["members"]
        self._sizes: dict[str, int] = body["sizes"]
        for odd in sorted(set(self._digests) ^ (sealed.names - {BODY, SIGNATURE})):
            raise CertificateError(
                codes.CERTIFICATE_HASH, str(path), f"{odd} does not match the list in the certificate"
            )
        for odd in sorted(set(self._digests) ^ set(self._sizes)):
            raise sealed.refused(f"{odd} has no size")
        for name, size in self._sizes.items():
            limit = MEMBER_LIMIT if name.endswith(".bin") else TEXT_LIMIT
            if type(size) is not int or not 0 <= size <= limit:
                raise sealed.refused(f"{name} has {size!r} bytes")
        if sum(self._sizes.values()) > sealed.most:
            raise sealed.refused(f"its parts have more bytes than a file of its size can hold ({sealed.most})")
        self._unused = set(self._digests)

    def take(self, name: str) -> bytearray:
        """The bytes of a part, which fit its hash."""
        self._unused.discard(name)
        data, digest = self._sealed.member(name, self._sizes[name])
        if digest != self._digests[name]:
            raise CertificateError(codes.CERTIFICATE_HASH, str(self._path), f"{name} was changed: its hash differs")
        return data

    def left(self) -> str:
        """A part that nobody has taken, or an empty text."""
        return min(self._unused, default="")


def _json(path: Path, name: str, data: bytes) -> dict[str, Any]:
    """An object in its one canonical spelling: no blanks, no key twice, nothing left over."""
    value = json.loads(data)
    if not isinstance(value, dict) or canonical(value) != data:
        raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), f"{name} is not in its canonical form")
    return value


def _fill(path: Path, trace: Trace, stream: StepStream, parts: _Parts) -> None:
    """Put the tables where numbers of rows are, their own numbers judged."""
    if type(trace) is not Trace or type(stream) is not StepStream:
        raise ValueError("trace.ir or stream.ir has another content")
    for section, table in zip(
        trace.sections, _cut(path, TRACE_TABLE, TRACE_ROW, [s.rows for s in trace.sections], parts), strict=True
    ):
        section.rows = table
    asked: list[list[Any]] = [[] for _ in range(_motors(stream))]
    for part in stream.sections:
        for counts, count in zip(asked, part.runs, strict=False):
            counts.append(count)
    runs = [iter(_cut(path, run_table(motor), RUN, counts, parts)) for motor, counts in enumerate(asked)]
    events = _cut(path, EVENT_TABLE, EVENT, [part.events for part in stream.sections], parts)
    for part, table in zip(stream.sections, events, strict=True):
        part.runs, part.events = tuple(next(tables) for tables in runs[: len(part.runs)]), table


def _cut(path: Path, name: str, schema: Schema, counts: Sequence[Any], parts: _Parts) -> list[Columns]:
    """The tables of a member: so many rows each."""
    for place, count in enumerate(counts):
        if type(count) is not int or not 0 <= count <= LONGEST_TABLE:
            raise ValueError(f"section {place} has {str(count)[:40]} rows in {name}")
    whole = _decode(schema, parts.take(name))
    if len(whole) != sum(counts):
        raise ValueError(f"{name} has {len(whole)} rows, but its sections {sum(counts)}")
    wrong = number_problem(whole)
    if wrong is not None:
        what = f"{name}{wrong.where}: {wrong.what}"
        raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), what)
    ends = list(itertools.accumulate(counts, initial=0))
    return [whole.slice(begin, end) for begin, end in itertools.pairwise(ends)]
