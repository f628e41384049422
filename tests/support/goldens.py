"""Expected texts that `--refresh-goldens` may rewrite, and those that it must never touch."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BY_HAND = (ROOT / "corpus", ROOT / "docs" / "codes")
LISTS = {ROOT / "docs" / "codes" / "README.md"}
"""Written by a test, in a folder whose other files are by hand."""
WRITABLE = {".md", ".txt", ".svg", ".json", ".jsonl", ".ir"}
_MARKER = re.compile(r"; *(expect|allow): *GP")


def rewrite(path: Path, text: str) -> None:
    """Write a golden file anew; programs, machines and whatever holds `; expect:` markers are written by hand."""
    target = path.resolve()
    by_hand = target not in LISTS and any(target.is_relative_to(folder) for folder in BY_HAND)
    if by_hand or path.suffix not in WRITABLE:
        raise ValueError(f"{path} is written by hand, not by --refresh-goldens")
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(text, encoding="utf-8")


def check(path: Path, actual: str, *, refresh: bool) -> None:
    """Compare a text with its golden file, or write the file when refreshing."""
    if refresh:
        if not path.is_file() or path.read_text(encoding="utf-8") != actual:
            rewrite(path, actual)
        return
    assert path.is_file(), f"{path.relative_to(ROOT)} is missing: make goldens"
    assert actual == path.read_text(encoding="utf-8"), "right? make goldens, then read the diff"


_NUMBER = re.compile(r"-?\d+\.?\d*")


def check_drawing(path: Path, actual: str, *, refresh: bool, tolerance: float = 0.11) -> None:
    """The same for a drawing, whose coordinates may differ in their last digit from one processor to the next."""
    if not refresh and path.is_file():
        expected = path.read_text(encoding="utf-8")
        if _NUMBER.sub("#", expected) == _NUMBER.sub("#", actual):
            pairs = zip(_NUMBER.findall(expected), _NUMBER.findall(actual), strict=True)
            assert max(abs(float(a) - float(b)) for a, b in pairs) <= tolerance
            return
    check(path, actual, refresh=refresh)
