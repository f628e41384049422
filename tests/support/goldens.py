"""Expected texts that `--refresh-goldens` may rewrite, and those that it must never touch.

A path below a page (`goldens.md/check-GP301.txt`) is a block of it (support/bundles.py).
"""

from __future__ import annotations

import fcntl
import re
from pathlib import Path

from support.bundles import block, files_of

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


def expected(path: Path) -> str | None:
    """The text of a golden file, or of a block of a golden page; None: there is none yet."""
    if path.parent.suffix == ".md":
        found = files_of(path.parent.read_text(encoding="utf-8")).get(path.name)
        return None if found is None else found.decode("utf-8")
    return path.read_text(encoding="utf-8") if path.is_file() else None


def check(path: Path, actual: str, *, refresh: bool) -> None:
    """Compare a text with its golden file, or write the file when refreshing."""
    before = expected(path)
    if refresh:
        if before != actual:
            (rewrite_block if path.parent.suffix == ".md" else rewrite)(path, actual)
        return
    assert before is not None, f"{path.relative_to(ROOT)} is missing: make goldens"
    assert actual == before, "right? make goldens, then read the diff"


def rewrite_block(path: Path, text: str) -> None:
    """Write a block of a golden page anew; several processes may do so at once."""
    with path.parent.open("r+", encoding="utf-8") as page:
        fcntl.flock(page, fcntl.LOCK_EX)
        before = page.read()
        blocks = files_of(before) | {path.name: text.encode()}
        head = before.partition("\n## ")[0].rstrip()
        parts = [head, *(f"## {name}\n\n{block(name, blocks[name])}".rstrip() for name in sorted(blocks))]
        page.seek(0)
        page.truncate()
        page.write("\n\n".join(parts) + "\n")


_NUMBER = re.compile(r"-?\d+\.?\d*")


def check_drawing(path: Path, actual: str, *, refresh: bool, tolerance: float = 0.11) -> None:
    """The same for a drawing, whose coordinates may differ in their last digit from one processor to the next."""
    if not refresh and path.is_file():
        drawn = path.read_text(encoding="utf-8")
        if _NUMBER.sub("#", drawn) == _NUMBER.sub("#", actual):
            pairs = zip(_NUMBER.findall(drawn), _NUMBER.findall(actual), strict=True)
            assert max(abs(float(a) - float(b)) for a, b in pairs) <= tolerance
            return
    check(path, actual, refresh=refresh)
