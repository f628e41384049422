"""Files that are mapped into memory, in pieces: what is done with counts as the process's memory no longer."""

from __future__ import annotations

import mmap
from collections.abc import Iterator

PIECE = 1 << 20
"""Bytes that are looked at in one go."""


def forget(data: object, begin: int, end: int) -> None:
    """Let go of ``data[begin:end]`` where ``data`` is mapped: whoever reads it again gets it from the disk's cache."""
    if not isinstance(data, mmap.mmap) or not hasattr(data, "madvise") or end <= begin:
        return
    first = begin // mmap.PAGESIZE * mmap.PAGESIZE
    data.madvise(mmap.MADV_DONTNEED, first, end - first)


def pieces(data: bytes, more: int = 0, size: int | None = None) -> Iterator[tuple[int, bytes]]:
    """(first byte, bytes) of successive pieces of a file, each with ``more`` bytes of the next one."""
    size = PIECE if size is None else size
    for begin in range(0, len(data), size):
        yield begin, data[begin : begin + size + more]
        forget(data, begin, min(begin + size, len(data)))
