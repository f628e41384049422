"""The ``.gpx`` file: a zip of the certificate's body, its signature and the parts it speaks of.

Members: ``body.json`` (what is signed), ``signature.json`` (outside every hash), ``machine.ir``, ``setup.ir``,
``trace.ir``, ``stream.ir`` (text forms, with empty tables), and one ``.bin`` a table: the columns of its schema
one after the other, little-endian, rows in order. Same inputs, same bytes: members in sorted order, fixed
times. The zip's comment is the SHA-256 of all bytes before it, so that no damaged file is taken for a whole one.
Nothing is believed while reading; docs/certificate.md defines the format.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
import struct
import tempfile
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from gproof.ir import codes
from gproof.ir.columns import Columns, Schema
from gproof.ir.finding import Code, Finding, Span
from gproof.ir.machine import Machine
from gproof.ir.record import record
from gproof.ir.setup import Setup
from gproof.ir.stream import EVENT, RUN, StepStream
from gproof.ir.text import parse_ir, print_ir
from gproof.ir.trace import TRACE_ROW, Trace
from gproof.verify.conform import misfit

BODY, SIGNATURE = "body.json", "signature.json"
TEXTS = ("machine.ir", "setup.ir", "trace.ir", "stream.ir")
MEMBER_LIMIT = 2 << 30
"""Bytes of one table at most (and of one text, of all together): more is refused before it is read."""
TEXT_LIMIT = 64 << 20
TOTAL_LIMIT = 4 << 30
_SEAL = b"sha256:"
_EPOCH = (1980, 1, 1, 0, 0, 0)


class CertificateError(Exception):
    """A package can not be used; ``finding`` says why (GP820 or GP821)."""

    def __init__(self, code: Code, path: str, what: str) -> None:
        self.finding: Finding = code.at(Span(path, 0), what=what)
        super().__init__(what)


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


def _decode(schema: Schema, data: bytes) -> Columns:
    sizes = [np.dtype(c.dtype).itemsize * c.width for c in schema.columns]
    rows, rest = divmod(len(data), sum(sizes))
    if rest:
        raise ValueError(f"a {schema.name} table of {len(data)} bytes does not hold whole rows")
    arrays, at = {}, 0
    for c, size in zip(schema.columns, sizes, strict=True):
        flat = np.frombuffer(data, dtype=_little(c.dtype), count=rows * c.width, offset=at).astype(c.dtype)
        arrays[c.name] = flat.reshape(rows, c.width) if c.width > 1 else flat
        at += rows * size
    return Columns(schema, arrays)


def write_members(path: Path, members: dict[str, bytes]) -> None:
    """Write the zip whole or not at all; an existing file is replaced only by a complete one."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "w+b") as out:
            with zipfile.ZipFile(out, "w") as archive:
                for member in sorted(members):
                    info = zipfile.ZipInfo(member, date_time=_EPOCH)
                    info.compress_type = zipfile.ZIP_DEFLATED
                    info.external_attr = 0o644 << 16
                    info.create_system = 3
                    archive.writestr(info, members[member], compresslevel=6)
                archive.comment = _SEAL + b"0" * 64
            seal(out)
            out.flush()
            os.fsync(out.fileno())
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


def seal(file: BinaryIO) -> None:
    """Write the digest of everything before it over the last 64 bytes of the zip's comment."""
    end = file.seek(-64, os.SEEK_END)
    file.seek(0)
    digest = _digest(file, end)
    file.seek(end)
    file.write(digest)


def _digest(file: BinaryIO, size: int) -> bytes:
    """SHA-256 of the next ``size`` bytes, as hexadecimal text."""
    whole = hashlib.sha256()
    while size > 0 and (block := file.read(min(size, 1 << 20))):
        whole.update(block)
        size -= len(block)
    return whole.hexdigest().encode()


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
    members = _members(path)
    for needed in (BODY, *TEXTS):
        if needed not in members:
            raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), f"{needed} is missing")
    body = _json(path, BODY, members[BODY])
    _check_hashes(path, body, members)
    signature = _json(path, SIGNATURE, members[SIGNATURE]) if SIGNATURE in members else None
    machine, setup, trace, stream = (parse_ir(members[name].decode()) for name in TEXTS)
    for value, kind in ((machine, Machine), (setup, Setup), (trace, Trace), (stream, StepStream)):
        wrong = misfit(value, kind, kind.__name__)
        if wrong:
            raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), wrong)
    _fill(trace, stream, members)
    machine.verify()
    trace.verify()
    stream.verify()
    return Package(
        path=str(path), body=body, body_bytes=members[BODY], signature=signature, machine=machine, setup=setup,
        trace=trace, stream=stream,
    )  # fmt: skip


def _json(path: Path, name: str, data: bytes) -> dict[str, Any]:
    """An object in its one canonical spelling: no blanks, no key twice, nothing left over."""
    value = json.loads(data)
    if not isinstance(value, dict) or canonical(value) != data:
        raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), f"{name} is not in its canonical form")
    return value


def _members(path: Path) -> dict[str, bytes]:
    """All members of a sealed zip, each no larger than it says and all together bounded."""
    out: dict[str, bytes] = {}
    total = 0
    with path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size - 64
        if size < 0 or _digest(file, size) != file.read():
            raise CertificateError(codes.CERTIFICATE_HASH, str(path), "the file is damaged, cut short or not a package")
        with zipfile.ZipFile(file) as archive:
            if not archive.comment.startswith(_SEAL) or len(archive.comment) != len(_SEAL) + 64:
                raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), "the zip file is not a sealed package")
            for info in archive.infolist():
                name = info.filename
                total += info.file_size
                limit = MEMBER_LIMIT if name.endswith(".bin") else TEXT_LIMIT
                if info.file_size > limit or total > TOTAL_LIMIT:
                    raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), f"{name!r} is too large")
                if name in out:
                    raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), f"{name!r} is there twice")
                if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                    raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), f"{name!r} is packed otherwise")
                with archive.open(info) as handle:
                    data = handle.read(info.file_size + 1)
                if len(data) != info.file_size:
                    raise CertificateError(
                        codes.CERTIFICATE_MALFORMED, str(path), f"{name!r} is not as long as it says"
                    )
                out[name] = data
    return out


def _check_hashes(path: Path, body: dict[str, Any], members: dict[str, bytes]) -> None:
    named = body["members"]
    there = set(members) - {BODY, SIGNATURE}
    if set(named) != there:
        odd = sorted(set(named) ^ there)[0]
        raise CertificateError(codes.CERTIFICATE_HASH, str(path), f"{odd} is not what the certificate lists")
    for name, digest in named.items():
        if hashlib.sha256(members[name]).hexdigest() != digest:
            raise CertificateError(codes.CERTIFICATE_HASH, str(path), f"{name} was changed: its hash differs")


def _fill(trace: Trace, stream: StepStream, members: dict[str, bytes]) -> None:
    """Put the tables where they belong; every table member is used exactly once."""
    used = set()

    def table(name: str, schema: Schema) -> Columns:
        used.add(name)
        return _decode(schema, members[name])

    for section in trace.sections:
        section.rows = table(f"trace/{section.number}.bin", TRACE_ROW)
    for part in stream.sections:
        part.runs = tuple(table(f"stream/{part.number}/{i}.bin", RUN) for i in range(len(part.runs)))
        part.events = table(f"stream/{part.number}/events.bin", EVENT)
    extra = set(members) - used - {BODY, SIGNATURE, *TEXTS}
    if extra:
        raise ValueError(f"a table that belongs nowhere: {sorted(extra)[0]}")
