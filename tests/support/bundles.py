"""Markdown pages that hold files, and the folders that they stand for.

A fenced block whose fence names a file holds it: a language for colours, the name, and words that say what a text block
cannot show::

    ```gcode bad.cnc
    G0 X1000
    ```

Words: ``crlf`` (lines end so), ``no-end`` (the last line has no end), ``latin-1`` (its bytes), ``base64`` (no text).
Other blocks and all that stands around is text for people. ``unpacked`` writes a tree of pages as the folders that they
were packed from, once for each state of the tree, below ``build/``.

Imports nothing of gproof: ``make replay`` unpacks the same pages for both revisions.
"""

from __future__ import annotations

import base64
import hashlib
import os
import re
import shutil
import tempfile
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILT = ROOT / "build" / "unpacked"
LANGUAGES = {
    ".toml": "toml", ".ini": "ini", ".json": "json", ".jsonl": "jsonl", ".py": "python", ".stl": "text", ".md": "md",
}  # fmt: skip
"""What a fence says for colours; other files are programs."""
_OPEN = re.compile(r"(?P<fence>`{3,})(?P<language>[a-z]+) (?P<name>\S+)(?P<words>(?: [a-z0-9-]+)*)")
_WORDS = {"crlf", "no-end", "latin-1", "base64"}


def files_of(text: str) -> dict[str, bytes]:
    """The files of a page, by name. ValueError: a block is not closed, a name stands twice or a word is none."""
    found: dict[str, bytes] = {}
    lines = iter(text.split("\n"))
    for line in lines:
        opened = _OPEN.fullmatch(line)
        plain = re.match(r"`{3,}", line)
        if plain is None:
            continue
        inside: list[str] = []
        for one in lines:
            if one == plain[0]:
                break
            inside.append(one)
        else:
            raise ValueError(f"a block is not closed: {line}")
        if opened is not None:
            if opened["name"] in found:
                raise ValueError(f"two files are named {opened['name']}")
            found[opened["name"]] = _bytes(inside, set(opened["words"].split()))
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
    are."""
    source = ROOT / tree
    files = sorted(path for path in source.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    contents = {path.relative_to(source): path.read_bytes() for path in files}
    digest = hashlib.sha256()
    for name, content in contents.items():
        digest.update(f"{name.as_posix()}\0{len(content)}\0".encode() + content)
    target = BUILT / digest.hexdigest()[:16] / tree
    if target.is_dir():
        return target
    BUILT.mkdir(parents=True, exist_ok=True)
    made = Path(tempfile.mkdtemp(dir=BUILT))
    try:
        for name, content in contents.items():
            is_page = name.suffix == ".md" and name.name != "README.md"
            held = files_of(content.decode()) if is_page else {}
            for inner, data in held.items():
                _write(made / tree / name.with_suffix("") / inner, data)
            if not is_page:
                _write(made / tree / name, content)
        try:
            made.rename(BUILT / digest.hexdigest()[:16])
        except OSError:  # another process was first
            if not target.is_dir():
                raise
    finally:
        shutil.rmtree(made, ignore_errors=True)
    return target


def _write(path: Path, content: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


def pack(folder: Path) -> str:
    """The files of a folder as blocks, in the order of their names."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return "\n".join(block(path.relative_to(folder).as_posix(), path.read_bytes()) for path in files)


if __name__ == "__main__":
    import sys

    # The folder of a page, to be looked at or run by hand.
    for page in sys.argv[1:]:
        print(unpacked(os.path.relpath(Path(page).resolve().parent, ROOT)) / Path(page).stem)
