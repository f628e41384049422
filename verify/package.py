"""The ``.gpx`` file: a zip of the certificate's body, its signature and the parts it speaks of.

Members: ``body.json`` (what is signed), ``signature.json`` (outside every hash), ``machine.ir``, ``setup.ir``,
``trace.ir``, ``stream.ir`` (text forms, with empty tables), and one ``.bin`` a table: the columns of its schema
one after the other, little-endian, rows in order. Same inputs, same bytes: members in sorted order, fixed
times. The zip's comment is the SHA-256 of all bytes before it, so that no damaged file is taken for a whole one.
Nothing is believed while reading; docs/certificate.md defines the format.
"""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import json
import struct
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from gproof.ir import codes
from gproof.ir.columns import Column, Columns, Schema
from gproof.ir.machine import Machine
from gproof.ir.number_ranges import number_problem
from gproof.ir.record import record
from gproof.ir.setup import Setup
from gproof.ir.stream import EVENT, RUN, StepStream
from gproof.ir.text import parse_texts, print_ir
from gproof.ir.trace import TRACE_ROW, Trace
from gproof.verify.conform import misfit
from gproof.verify.package_zip import CertificateError, Sealed, open_sealed, seal, write_members
from gproof.verify.signature import fits

__all__ = [
    "BODY", "FORMAT", "SIGNATURE", "CertificateError", "Package", "canonical", "parts_of", "read_package", "seal",
    "write_members",
]  # fmt: skip

BODY, SIGNATURE = "body.json", "signature.json"
TEXTS = ("machine.ir", "setup.ir", "trace.ir", "stream.ir")
FORMAT = "gproof-certificate/2"
MEMBER_LIMIT = 2 << 30
"""Bytes of one table at most (and of one text, of the body, of the signature): more is refused before it is read."""
TEXT_LIMIT = 64 << 20
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
        trace, sections=[dataclasses.replace(s, rows=Columns(TRACE_ROW)) for s in trace.sections]
    )
    bare_stream = dataclasses.replace(
        stream,
        sections=[
            dataclasses.replace(s, runs=tuple(Columns(RUN) for _ in s.runs), events=Columns(EVENT))
            for s in stream.sections
        ],
    )
    members = {
        "machine.ir": print_ir(machine).encode(),
        "setup.ir": print_ir(setup).encode(),
        "trace.ir": print_ir(bare_trace).encode(),
        "stream.ir": print_ir(bare_stream).encode(),
    }
    members.update((name, _encode(table)) for name, table in _tables(trace, stream))
    return members


def _tables(trace: Trace, stream: StepStream) -> Iterator[tuple[str, Columns]]:
    for section in trace.sections:
        yield f"trace/{section.number}.bin", section.rows
    for part in stream.sections:
        for index, runs in enumerate(part.runs):
            yield f"stream/{part.number}/{index}.bin", runs
        yield f"stream/{part.number}/events.bin", part.events


def _little(dtype: str) -> np.dtype[Any]:
    return np.dtype(dtype).newbyteorder("<")


def _encode(table: Columns) -> bytes:
    return b"".join(table[c.name].astype(_little(c.dtype), copy=False).tobytes() for c in table.schema.columns)


def _decode(schema: Schema, data: bytes | bytearray) -> Columns:
    if not data:
        return Columns(schema)
    layout = _layout(schema)
    rows, rest = divmod(len(data), sum(size for _, _, _, size in layout))
    if rest:
        raise ValueError(f"a {schema.name} table of {len(data)} bytes does not hold whole rows")
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
        raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), error.strerror or "can not be read") from None
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, struct.error) as error:
        raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), f"not a whole zip file ({error})") from None
    except (ValueError, LookupError, TypeError, AttributeError, ArithmeticError, MemoryError, AssertionError) as error:
        raise CertificateError(
            codes.CERTIFICATE_MALFORMED, str(path), f"not a certified stream ({type(error).__name__}: {error})"
        ) from None


def _read(path: Path) -> Package:
    with open_sealed(path) as sealed:
        for needed in (BODY, *TEXTS):
            if needed not in sealed.names:
                raise sealed.refused(f"{needed} is missing")
        body_bytes = sealed.small(BODY, BODY_LIMIT)
        body = _json(path, BODY, body_bytes)
        _check_format(path, body.get("format"))
        signature = None
        if SIGNATURE in sealed.names:
            signature = _json(path, SIGNATURE, sealed.small(SIGNATURE, SIGNATURE_LIMIT))
            if not fits(signature, body_bytes):
                what = "the signature does not fit the certificate"
                raise CertificateError(codes.CERTIFICATE_SIGNATURE, str(path), what)
        parts = _Parts(path, sealed, body)
        machine, setup, trace, stream = parse_texts(parts.take(name).decode() for name in TEXTS)
        for value, kind in ((machine, Machine), (setup, Setup), (trace, Trace), (stream, StepStream)):
            wrong = misfit(value, kind, kind.__name__)
            if wrong:
                raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), wrong)
            _check_numbers(path, kind.__name__, value)
        _fill(trace, stream, parts)
        _check_numbers(path, "Trace.sections", trace.sections)
        _check_numbers(path, "StepStream.sections", stream.sections)
        left = parts.left()
        if left:
            raise ValueError(f"a table that belongs nowhere: {left}")
    machine.verify()
    trace.verify()
    stream.verify()
    return Package(
        path=str(path), body=body, body_bytes=body_bytes, signature=signature, machine=machine, setup=setup,
        trace=trace, stream=stream,
    )  # fmt: skip


def _check_numbers(path: Path, name: str, value: object) -> None:
    wrong = number_problem(value)
    if wrong is not None:
        what = f"{name}{'' if wrong.where.startswith('[') else '.'}{wrong.where}: {wrong.what}"
        raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), what)


def _check_format(path: Path, said: object) -> None:
    if said == FORMAT:
        return
    family, _, number = str(said).partition("/")
    if family != FORMAT.partition("/")[0] or not number.isdecimal() or len(number) > 4:
        raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), f"format {said!r} is not {FORMAT}")
    age = "an older" if int(number) < int(FORMAT.partition("/")[2]) else "a newer"
    raise CertificateError(codes.CERTIFICATE_FORMAT, str(path), f"made by {age} gproof ({said}; this one has {FORMAT})")


class _Parts:
    """The members that a body names, each inflated once, when it is needed, to the size that the body states."""

    def __init__(self, path: Path, sealed: Sealed, body: dict[str, Any]) -> None:
        self._path = path
        self._sealed = sealed
        self._digests: dict[str, str] = body["members"]
        self._sizes: dict[str, int] = body["sizes"]
        for odd in sorted(set(self._digests) ^ (sealed.names - {BODY, SIGNATURE})):
            raise CertificateError(codes.CERTIFICATE_HASH, str(path), f"{odd} is not what the certificate lists")
        for odd in sorted(set(self._digests) ^ set(self._sizes)):
            raise sealed.refused(f"{odd} has no size")
        for name, size in self._sizes.items():
            limit = MEMBER_LIMIT if name.endswith(".bin") else TEXT_LIMIT
            if type(size) is not int or not 0 <= size <= limit:
                raise sealed.refused(f"{name} is of {size!r} bytes")
        if sum(self._sizes.values()) > sealed.most:
            raise sealed.refused(f"its parts are of more bytes than a file of its size may hold ({sealed.most})")
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


def _fill(trace: Trace, stream: StepStream, parts: _Parts) -> None:
    """Put the tables where they belong."""
    for section in trace.sections:
        section.rows = _decode(TRACE_ROW, parts.take(f"trace/{section.number}.bin"))
    for part in stream.sections:
        place = f"stream/{part.number}"
        part.runs = tuple(_decode(RUN, parts.take(f"{place}/{i}.bin")) for i in range(len(part.runs)))
        part.events = _decode(EVENT, parts.take(f"{place}/events.bin"))
