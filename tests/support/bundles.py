"""Markdown pages that hold files, and the folders that they stand for.

A fenced block whose fence names a file holds it: a language for colours, the name, and words that say what a text block
cannot show::

    ```gcode bad.cnc
    G0 X1000
    ```

Words: ``crlf`` (lines end so), ``no-end`` (the last line has no end), ``latin-1`` (its bytes), ``base64`` (no text),
``about`` (JSON Lines whose first row is the text of its section: ``about_row``). Other blocks and all text around them
are for people. ``unpacked`` writes a tree of pages as the folders that they were packed from, once for each state of
the tree, below ``build/``: ``mill.md`` holds the folder ``mill``, ``mill.arcs.md`` a topic of it, ``_knives.md`` many
folders, with which its names of files start, and ``format-3.zip`` the folder ``format-3``.

Imports nothing of gproof: ``make replay`` unpacks the same pages for both revisions.
"""

from __future__ import annotations

import base64
import hashlib
import io
import json
import os
import re
import shutil
import tempfile
import time
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
BUILT = ROOT / "build" / "unpacked"
LANGUAGES = {
    ".toml": "toml", ".ini": "ini", ".json": "json", ".jsonl": "jsonl", ".py": "python", ".stl": "text", ".txt": "text",
    ".md": "md",
}  # fmt: skip
"""What a fence says for colours; other files are programs."""
_OPEN = re.compile(r"(?P<fence>`{3,})(?P<language>[a-z]+) (?P<name>\S+)(?P<words>(?: [a-z0-9-]+)*)")
_WORDS = {"crlf", "no-end", "latin-1", "base64", "about"}
MANUAL, SETUP, CODE = "Manual: ", "Setup: ", "Code: "
"""How the lines of a case begin that say its sections of the manual, its state at the start and gproof's code."""


@dataclass
class Section:
    """A heading of the second level: its text, line by line without blank lines, and its files by name."""

    heading: str
    text: list[str] = field(default_factory=list)
    files: dict[str, bytes] = field(default_factory=dict)

    def said(self, label: str) -> str:
        """What its line says that begins with a label, or ""."""
        return next((line.removeprefix(label) for line in self.text if line.startswith(label)), "")

    def about_row(self) -> dict[str, Any]:
        """The first row of a trace by hand: the manual's headings, how the numbers come about, what is not as usual."""
        why = " ".join(line for line in self.text if not line.startswith((MANUAL, SETUP, CODE)))
        row = {"op": "about", "manual": self.said(MANUAL).split("; "), "why": why}
        setup = self.said(SETUP).strip("`")
        return row | ({"setup": json.loads(setup)} if setup else {})


def sections(text: str) -> list[Section]:
    """A page's sections; the first is what comes before any. ValueError: a block is not closed or a word is none."""
    found = [Section("")]
    lines = iter(text.split("\n"))
    for line in lines:
        plain = re.match(r"`{3,}", line)
        if plain is None:
            if line.startswith("## "):
                found.append(Section(line.removeprefix("## ")))
            elif line.strip():
                found[-1].text.append(line)
            continue
        inside = list(_block(lines, line, plain[0]))
        opened = _OPEN.fullmatch(line)
        if opened is None:
            continue
        words = set(opened["words"].split())
        if opened["name"] in found[-1].files:
            raise ValueError(f"two files are named {opened['name']}")
        if "about" in words:
            inside.insert(0, json.dumps(found[-1].about_row(), ensure_ascii=False))
        found[-1].files[opened["name"]] = _bytes(inside, words)
    return found


def _block(lines: Iterator[str], opened: str, fence: str) -> Iterator[str]:
    for line in lines:
        if line == fence:
            return
        yield line
    raise ValueError(f"a block is not closed: {opened}")


def files_of(text: str) -> dict[str, bytes]:
    """The files of a page, by name. ValueError: a block is not closed, a name stands twice or a word is none."""
    found: dict[str, bytes] = {}
    for section in sections(text):
        for name, content in section.files.items():
            if name in found:
                raise ValueError(f"two files are named {name}")
            found[name] = content
    return found


def _bytes(lines: list[str], words: set[str]) -> bytes:
    if words - _WORDS:
        raise ValueError(f"a fence has no word {min(words - _WORDS)}")
    if "base64" in words:
        return base64.b64decode("".join(lines), validate=True)
    end = "\r\n" if "crlf" in words else "\n"
    text = end.join(lines) + end * bool(lines and "no-end" not in words)
    return text.encode("latin-1" if "latin-1" in words else "utf-8")


def block(name: str, content: bytes) -> str:
    """A file as a block of a page, with a line end."""
    lines, words = _lines(content)
    longest = max((len(run) for line in lines for run in re.findall(r"^`+", line)), default=0)
    fence = "`" * max(3, longest + 1)
    language = LANGUAGES.get(Path(name).suffix.lower(), "gcode")
    return "\n".join([" ".join([f"{fence}{language}", name, *words]), *lines, fence, ""])


def _lines(content: bytes) -> tuple[list[str], list[str]]:
    """Lines of a block and the words of its fence."""
    for coding, words in (("utf-8", []), ("latin-1", ["latin-1"])):
        try:
            text = content.decode(coding)
        except UnicodeDecodeError:
            continue
        if "\x00" in text:
            break
        if not text:
            return [], words
        if text.count("\r\n") == text.count("\n") > 0:
            text, words = text.replace("\r\n", "\n"), [*words, "crlf"]
        if "\r" in text:
            break
        words = words if text.endswith("\n") else [*words, "no-end"]
        return text.removesuffix("\n").split("\n"), words
    encoded = base64.b64encode(content).decode()
    return [encoded[at : at + 116] for at in range(0, len(encoded), 116)], ["base64"]


@cache
def unpacked(tree: str) -> Path:
    """The folders of a tree of pages (``docs/codes``): each page's files in a folder of its name, other files as they
    are, Python left out."""
    source = ROOT / tree
    files = sorted(path for path in source.rglob("*") if path.is_file() and path.suffix not in {".py", ".pyc"})
    contents = {path.relative_to(source): path.read_bytes() for path in files}
    digest = hashlib.sha256(tree.encode())
    for name, content in contents.items():
        digest.update(f"{name.as_posix()}\0{len(content)}\0".encode() + content)
    target = BUILT / digest.hexdigest()[:16] / tree
    if target.is_dir():
        os.utime(target)
        return target
    _forget(tree)
    BUILT.mkdir(parents=True, exist_ok=True)
    made = Path(tempfile.mkdtemp(dir=BUILT))
    try:
        for name, content in contents.items():
            for inner, data in _held(name, content):
                _write(made / tree / inner, data)
        try:
            made.rename(BUILT / digest.hexdigest()[:16])
        except OSError:  # another process was first
            if not target.is_dir():
                raise
    finally:
        shutil.rmtree(made, ignore_errors=True)
    return target


KEPT = 7 * 24 * 3600
"""Seconds after its last use that a state of a tree is kept."""


def _forget(tree: str) -> None:
    """Remove states of a tree that nothing has used for long: each is some megabytes."""
    for state in BUILT.glob("*") if BUILT.is_dir() else ():
        if (state / tree).is_dir() and (state / tree).stat().st_mtime < time.time() - KEPT:
            shutil.rmtree(state, ignore_errors=True)


def _held(name: Path, content: bytes) -> Iterator[tuple[Path, bytes]]:
    """The files that a file of a tree stands for: those of a page or an archive, or itself."""
    if name.suffix == ".zip":
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            yield from ((name.with_suffix("") / inner, archive.read(inner)) for inner in archive.namelist())
    elif name.suffix == ".md" and name.name != "README.md":
        folder = name.parent if name.name.startswith("_") else name.with_name(name.name.partition(".")[0])
        yield from ((folder / inner, data) for inner, data in files_of(content.decode()).items())
    else:
        yield name, content


def pages_of(folder: str) -> list[Path]:
    """The pages that hold a folder (``tests/hand/wincnc/router``): its own and those of its topics."""
    found = sorted((ROOT / folder).parent.glob(f"{Path(folder).name}.*md"))
    return [page for page in found if page.name.partition(".")[0] == Path(folder).name]


def _write(path: Path, content: bytes) -> None:
    if path.exists():
        raise ValueError(f"two pages hold {path.parent.name}/{path.name}")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


def pack(folder: Path) -> str:
    """The files of a folder as blocks, in the order of their names."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return "\n".join(block(path.relative_to(folder).as_posix(), path.read_bytes()) for path in files)


if __name__ == "__main__":
    import sys

    # The folder of a page, to be looked at or run by hand.
    for page in (Path(word).resolve() for word in sys.argv[1:]):
        tree = unpacked(os.path.relpath(page.parent, ROOT))
        print(tree if page.name.startswith("_") else tree / page.name.partition(".")[0])
