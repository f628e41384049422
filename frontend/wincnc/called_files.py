"""Which file a call means: next to the job, then next to the machine's file, in any case of letters. Manual: M98."""

from __future__ import annotations

import re
from pathlib import Path


class CalledFiles:
    """Subprogram files by name, loaded when they are first called."""

    def __init__(self, folders: list[Path]) -> None:
        self.folders = folders
        self.paths: dict[str, Path] = {}
        self.wanted: list[str] = []
        self.where = f" in {' or '.join(sorted({str(folder) for folder in folders}))}"
        self._listed: dict[Path, dict[str, Path]] = {}

    def find(self, name: str) -> str | None:
        """The key of a file: its path in lower case with forward slashes, next to the job or the machine's file."""
        text = name.strip().strip('"').replace("\\", "/")
        if not text or "\0" in text:
            return None
        # A drive or an absolute path is the controller's own disk: the file of that name next to the job is taken.
        candidates = [text] if not (text.startswith("/") or text[1:2] == ":") else []
        candidates.append(text.rpartition("/")[2])
        for candidate in candidates:
            for folder in self.folders:
                found = self.below(folder, candidate.split("/"))
                if found is not None:
                    key = candidate.lower()
                    if key not in self.paths:
                        self.paths[key] = found
                        self.wanted.append(key)
                    return key
        return None

    def other_of(self, path: Path) -> Path | None:
        """A different file of the same name in another of the folders; which one is meant is not known."""
        for folder in self.folders:
            other = self.below(folder, [path.name])
            if other is not None and other.parent != path.parent and other.resolve() != path.resolve():
                try:
                    if other.read_bytes() != path.read_bytes():
                        return other
                except OSError:
                    return other
        return None

    def below(self, folder: Path, parts: list[str]) -> Path | None:
        """A file by its name in any case, as the controller's disk finds it."""
        at = folder
        for part in parts:
            if part in ("", "."):
                continue
            if part == "..":
                at = at.parent
                continue
            found = self._entries(at).get(part.lower())
            if found is None:
                return None
            at = found
        return at if at.is_file() else None

    def _entries(self, folder: Path) -> dict[str, Path]:
        if folder not in self._listed:
            try:
                entries = sorted(folder.iterdir())
            except OSError:
                entries = []
            self._listed[folder] = {entry.name.lower(): entry for entry in entries}
        return self._listed[folder]


class AnyFiles(CalledFiles):
    """Subprogram files whether they are there or not; a name with blanks that is not in quotes must be."""

    def find(self, name: str) -> str | None:
        """As for ``CalledFiles``; else the name itself."""
        found = super().find(name)
        text = name.strip().strip('"')
        is_name = bool(text) and (name.startswith('"') or not re.search(r"[ \t]", text))
        return found or (text.lower() if is_name else None)
