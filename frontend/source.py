"""Files as bytes: read or mapped, hashed, refused when they are no text."""

from __future__ import annotations

import hashlib
import mmap
import os
import stat
from pathlib import Path

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.program import SourceFile

MAP_FROM = 1 << 20
"""Files with more bytes than this are mapped, not read."""

UTF8_MARK = b"\xef\xbb\xbf"


def read_source(path: Path) -> SourceFile:
    """The file with its hash; Refusal (GP601) when it can not be read, (GP119) when it is no text."""
    name = str(path)
    try:
        data = _bytes_of(path)
    except OSError as error:
        what = f"{name}: {error.strerror or error}"
        raise Refusal(codes.FILE_UNREADABLE.at(Span(name, 0), what=what)) from None
    refuse_binary(name, data)
    return SourceFile(name=name, sha256=hashlib.sha256(data).hexdigest(), data=data)


def refuse_binary(name: str, data: bytes) -> None:
    """Refusal (GP119) for UTF-16 and for a NUL byte anywhere."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise Refusal(codes.NOT_TEXT.at(Span(name, 1), byte=f"0x{data[0]:02X}", offset=0, hint="UTF-16?"))
    at = data.find(b"\0")
    if at >= 0:
        raise Refusal(codes.NOT_TEXT.at(Span(name, 0), byte="0x00", offset=at))


def _bytes_of(path: Path) -> bytes:
    with open(path, "rb") as file:
        about = os.fstat(file.fileno())
        if not (stat.S_ISREG(about.st_mode) or stat.S_ISFIFO(about.st_mode)):
            raise OSError("not a file")
        if stat.S_ISREG(about.st_mode) and about.st_size > MAP_FROM:
            # A memory map has what the scanner uses of bytes: indexing, slices, find, the buffer.
            return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)  # type: ignore[return-value]
        return file.read()


def encoding_of(raw: bytes) -> str:
    """Of a line: UTF-8, else Windows-1252 as the controller writes it, else Latin-1."""
    for encoding in ("utf-8", "cp1252"):
        try:
            raw.decode(encoding)
        except UnicodeDecodeError:
            continue
        return encoding
    return "latin-1"


def decode(raw: bytes) -> str:
    """Text of a line, by ``encoding_of``."""
    return raw.decode(encoding_of(raw))
