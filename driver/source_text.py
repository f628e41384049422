"""Lines of source files as they are quoted: next to findings, in fingerprints, in what ``fmt`` shows."""

from __future__ import annotations


def source_lines(path: str, wanted: set[int]) -> dict[int, str]:
    """The text of some lines of a file, read once from the top; missing ones are left out."""
    found: dict[int, str] = {}
    last = max(wanted, default=0)
    try:
        with open(path, "rb") as handle:
            for number in range(1, last + 1):
                raw = handle.readline(1 << 16)
                if not raw:
                    break
                while not raw.endswith(b"\n") and len(raw) >= 1 << 16:
                    more = handle.readline(1 << 20)
                    if not more or more.endswith(b"\n"):
                        break
                if number in wanted:
                    found[number] = line_text(raw.removeprefix(b"\xef\xbb\xbf") if number == 1 else raw).rstrip("\r\n")
    except OSError:
        return {}
    return found


def line_text(raw: bytes) -> str:
    """A line as the frontends read it, so that columns fit."""
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError:
        return raw.decode("cp1252", "replace")
