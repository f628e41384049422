"""Files in pieces: the same bytes as in one, mapped or not, and lines across the border of two pieces."""

from __future__ import annotations

import mmap
from pathlib import Path
from typing import Any

import pytest

from gproof.frontend.common import lines
from gproof.frontend.eding.scan import index
from gproof.ir import mapped


def mapped_file(path: Path, text: bytes) -> Any:
    path.write_bytes(text)
    with path.open("rb") as file:
        return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)


def test_pieces_overlap_and_pages_come_back(tmp_path: Path) -> None:
    text = bytes(n % 251 for n in range(3 * mmap.PAGESIZE + 17))
    for data in (text, mapped_file(tmp_path / "file", text)):
        for size in (1000, mmap.PAGESIZE, 10 * mmap.PAGESIZE):
            found = list(mapped.pieces(data, 5, size))
            assert b"".join(piece[:size] for _, piece in found) == text
            assert all(piece == text[begin : begin + size + 5] for begin, piece in found)
        mapped.forget(data, 3, 2)
        mapped.forget(data, 0, len(text))
        assert data[:] == text
    assert list(mapped.pieces(b"")) == []


def test_a_mapped_file_that_was_read_is_no_memory_of_the_process(tmp_path: Path) -> None:
    status = Path("/proc/self/smaps_rollup")
    if not status.exists():
        return

    def resident() -> int:
        return next(int(line.split()[1]) for line in status.read_text().splitlines() if line.startswith("Rss"))

    data = mapped_file(tmp_path / "file", b"x" * (24 << 20))
    before = resident()
    for _, piece in mapped.pieces(data):
        assert piece[0] == ord("x")
    assert resident() - before < 12 << 10


@pytest.mark.parametrize("newline", [b"\n", b"\r\n"])
def test_the_index_of_lines_does_not_depend_on_pieces(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, newline: bytes
) -> None:
    plain = [b"G1 X1 Y2.5", b"", b"X" + b"9" * 40, b"(note)"]
    special = [b"X[1+2]", b"#1=3", b"no line of a program", b"X" * 90]
    text = newline.join((plain * 3 + special) * 4 + [b"G0 Z1"])
    for data in (text, mapped_file(tmp_path / "file", text)):
        whole = index(data, 0, 80)
        for size in (1, 7, 50, 64, 200, len(text)):
            monkeypatch.setattr(lines, "PIECE", size)
            found = index(data, 0, 80)
            assert list(found.rows()) == list(whole.rows())
            assert (found.words_after, found.line_count) == (whole.words_after, whole.line_count)
        monkeypatch.undo()
