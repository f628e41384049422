"""Files as bytes: read or mapped, hashed, refused when they are no text."""

from __future__ import annotations

import hashlib
import mmap
import os
import stat
from pathlib import Path

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.mapped import pieces
from gproof.ir.program import SourceFile

MAP_FROM = 1 << 20
"""Files with more bytes than this are mapped, not read."""

UTF8_MARK = b"\xef\xbb\xbf"

CTRL_Z = b"\x1a"
"""What DOS has at the end of a text file."""


def read_source(path: Path, *, dos: bool = False) -> SourceFile:
    """The file with its hash; Refusal (GP601) when it cannot be read, (GP119) when it is no text.

    dos: one Ctrl-Z at its end is no part of the text; the hash is of the whole file nevertheless.
    """
    name = str(path)
    try:
        data = _bytes_of(path)
    except OSError as error:
        what = f"{name}: {error.strerror or error}"
        raise Refusal(codes.FILE_UNREADABLE.at(Span(name, 0), what=what)) from None
    _refuse_utf16(name, data)
    digest = hashlib.sha256()
    line = 1
    for begin, piece in pieces(data):
        line = _refuse_nul(name, piece, begin, line)
        digest.update(piece)
    if dos and data[-1:] == CTRL_Z:
        data = _without_last(path, data)
    return SourceFile(name=name, sha256=digest.hexdigest(), data=data)


def newline_of(data: bytes) -> str:
    """How the first line ends."""
    end = data.find(b"\n")
    return "\r\n" if end > 0 and data[end - 1 : end] == b"\r" else "\n"


def _refuse_utf16(name: str, data: bytes) -> None:
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise Refusal(
            codes.NOT_TEXT.at(
                Span(name, 1), byte=f"0x{data[0]:02X}", offset=0, hint="save it as plain text: it looks like UTF-16"
            )
        )


def _refuse_nul(name: str, piece: bytes, begin: int, line: int) -> int:
    """Of the piece of a file that starts at byte ``begin``, in a line; returns that of the next piece."""
    at = piece.find(b"\0")
    if at >= 0:
        raise Refusal(codes.NOT_TEXT.at(Span(name, line + piece.count(b"\n", 0, at)), byte="0x00", offset=begin + at))
    return line + piece.count(b"\n")


def _bytes_of(path: Path) -> bytes:
    with open(path, "rb") as file:
        about = os.fstat(file.fileno())
        if not (stat.S_ISREG(about.st_mode) or stat.S_ISFIFO(about.st_mode)):
            raise OSError("not a file")
        if stat.S_ISREG(about.st_mode) and about.st_size > MAP_FROM:
            # A memory map has what the scanner uses of bytes: indexing, slices, find, the buffer.
            return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)  # type: ignore[return-value]
        return file.read()


def _without_last(path: Path, data: bytes) -> bytes:
    """The bytes of a file without the last one, mapped when they are."""
    if len(data) <= MAP_FROM:
        return data[:-1]
    with open(path, "rb") as file:
        return mmap.mmap(file.fileno(), len(data) - 1, access=mmap.ACCESS_READ)  # type: ignore[return-value]


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
