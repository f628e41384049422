"""The container of a package: a sealed zip file, its members read one by one, never more than was requested.

The last bytes of the file are the SHA-256 of all before them. The directory is bounded before it is parsed, a member
is inflated in blocks into as many bytes as the reader expects, hashed meanwhile, and refused when it has one more or
one less. docs/certificate.md states the limits.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from gproof.ir import codes
from gproof.ir.finding import Code, Finding, Span

FILE_LIMIT = 4 << 30
"""Bytes of a package at most."""
MEMBERS = 200_000
"""Members of a package at most."""
FREE, RATIO = 48 << 20, 32
"""All members together inflate to no more than FREE bytes and RATIO for each byte of the file.

Tables of motion have a ratio of 3 to 15; one that packs better than RATIO is stored as it is."""
_SEAL = b"sha256:"
_EPOCH = (1980, 1, 1, 0, 0, 0)
_BLOCK = 1 << 20
_ENTRY = b"PK\x01\x02"


class CertificateError(Exception):
    """A package cannot be used; ``finding`` says why."""

    def __init__(self, code: Code, path: str, what: str) -> None:
        self.finding: Finding = code.at(Span(path, 0), what=what)
        super().__init__(what)


class Sealed:
    """A whole, unaltered zip file: names and members."""

    def __init__(self, path: Path, archive: zipfile.ZipFile, size: int) -> None:
        self._path = path
        self._archive = archive
        self.most = min(FILE_LIMIT, FREE + RATIO * size)
        self._infos: dict[str, zipfile.ZipInfo] = {}
        for info in archive.infolist():
            if info.filename in self._infos:
                raise self.refused(f"{info.filename!r} is in it twice")
            if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                raise self.refused(f"{info.filename!r} is packed differently")
            self._infos[info.filename] = info

    @property
    def names(self) -> set[str]:
        """Names of all members."""
        return set(self._infos)

    def refused(self, what: str) -> CertificateError:
        """The error for a package that is not of its form."""
        return CertificateError(codes.CERTIFICATE_MALFORMED, str(self._path), what)

    def small(self, name: str, limit: int) -> bytes:
        """A member of no more than ``limit`` bytes."""
        size = self._infos[name].file_size
        if size > limit:
            raise self.refused(f"{name!r} is too large")
        return bytes(self.member(name, size)[0])

    def member(self, name: str, size: int) -> tuple[bytearray, str]:
        """A member of exactly ``size`` bytes, and its SHA-256."""
        if self._infos[name].file_size != size:
            raise self.refused(f"{name!r} does not have the length it says")
        digest = hashlib.sha256()
        data = bytearray(size)
        view = memoryview(data)
        at = 0
        with self._archive.open(self._infos[name]) as handle:
            while block := handle.read(min(_BLOCK, size - at + 1)):
                if at + len(block) > size:
                    raise self.refused(f"{name!r} does not have the length it says")
                view[at : at + len(block)] = block
                digest.update(block)
                at += len(block)
        if at != size:
            raise self.refused(f"{name!r} does not have the length it says")
        return data, digest.hexdigest()


@contextmanager
def open_sealed(path: Path) -> Iterator[Sealed]:
    """Open a package whose seal fits and whose directory is not too large."""
    with path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size
        if size > FILE_LIMIT:
            raise CertificateError(
                codes.CERTIFICATE_MALFORMED, str(path), f"the file is larger than {FILE_LIMIT} bytes"
            )
        digest, entries = _digest(file, size - 64)
        if size < 64 or digest != file.read():
            raise CertificateError(
                codes.CERTIFICATE_HASH, str(path), "the file is damaged, incomplete or not a package"
            )
        if entries > MEMBERS:
            raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), f"it has more than {MEMBERS} members")
        with zipfile.ZipFile(file) as archive:
            if not archive.comment.startswith(_SEAL) or len(archive.comment) != len(_SEAL) + 64:
                raise CertificateError(codes.CERTIFICATE_MALFORMED, str(path), "the zip file is not a sealed package")
            yield Sealed(path, archive, size)


def write_members(path: Path, members: Mapping[str, bytes]) -> None:
    """Write the zip whole or not at all; an existing file is replaced only by a complete one."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "w+b") as out:
            _write(out, members, zipfile.ZIP_DEFLATED)
            if sum(map(len, members.values())) > FREE + RATIO * out.seek(0, os.SEEK_END):
                out.seek(0)
                out.truncate()
                _write(out, members, zipfile.ZIP_STORED)
            seal(out)
            out.flush()
            os.fsync(out.fileno())
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


def _write(out: BinaryIO, members: Mapping[str, bytes], packed: int) -> None:
    with zipfile.ZipFile(out, "w") as archive:
        for member in sorted(members):
            info = zipfile.ZipInfo(member, date_time=_EPOCH)
            info.compress_type = packed
            info.external_attr = 0o644 << 16
            info.create_system = 3
            archive.writestr(info, members[member], compresslevel=6)
        archive.comment = _SEAL + b"0" * 64


def seal(file: BinaryIO) -> None:
    """Write the digest of everything before it over the last 64 bytes of the zip's comment."""
    end = file.seek(-64, os.SEEK_END)
    file.seek(0)
    digest, _ = _digest(file, end)
    file.seek(end)
    file.write(digest)


def _digest(file: BinaryIO, size: int) -> tuple[bytes, int]:
    """SHA-256 of the next ``size`` bytes as hexadecimal text, and how many entries of a directory may be in them."""
    whole = hashlib.sha256()
    entries = 0
    while size > 0 and (block := file.read(min(size, _BLOCK))):
        whole.update(block)
        entries += block.count(_ENTRY)
        size -= len(block)
    return whole.hexdigest().encode(), entries
