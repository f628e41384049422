"""Texts of targets as lines, with the words and modes that the manuals give them: enough to say what an edit changes.

For the programs of ``traps/`` alone, which are short and plain. What a line does is followed from line to line; after a
jump, a call, another unit or another zero it is not known any more (None). It shares nothing with gproof.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

AXES = "XYZ"
MILLING = ("eding", "linuxcnc", "grbl")
"""Dialects of one family: words of G-code as RS274 has them."""
_WORD = re.compile(r"(?<![A-Z#.])([A-Z])\s*(-?(?:\d+\.?\d*|\.\d+))")
_STRUCTURE = re.compile(
    r"\$|%|#|\b(?:SUB|ENDSUB|IF|ELSE|ENDIF|WHILE|ENDWHILE|GOSUB)\b|M9[89]|M1[78]\.|M17(?!C)|L6[01]C", re.IGNORECASE
)
_FRAME = re.compile(r"G(?:92(?:\.[123])?|5[4-9](?:\.[123])?|10|153|154|28|68|69|5[0-2]|4[0-3]|49)(?![0-9.])|L92|L3|L4")
_UNIT = re.compile(r"G(?:20|21|22|23|70|71)(?![0-9.])")
_COMMENT = {
    "wincnc": re.compile(r"\[.*?(?:\]|$)"), "mcuwin": re.compile(r"'.*|\{.*?\}|//.*|\((?!X\.).*?\)"),
    "eding": re.compile(r";.*|\(.*?\)"), "linuxcnc": re.compile(r";.*|\(.*?\)"), "grbl": re.compile(r";.*|\(.*?\)"),
}  # fmt: skip
START = math.nan
"""A coordinate at the start: another one than any number, because work zero and start are open."""


@dataclass(slots=True)
class Line:
    """raw: as written; code: the same without comments and line number, at the same columns; kind: move, cycle, machine
    (a move to machine coordinates), frame, dwell, stop, end, call, structure, other, blank; motion: 0 to 3 or a cycle;
    relative: distances; words: numbers by letter, of moves and cycles; before, after: program coordinates; feed: in
    force before; plane: 17 .. 19; inverse: feeds are times; inches: a word for inches is in force."""

    raw: str
    code: str
    kind: str = "other"
    motion: int | None = None
    relative: bool = False
    words: dict[str, float] = field(default_factory=dict)
    before: dict[str, float | None] = field(default_factory=dict)
    after: dict[str, float | None] = field(default_factory=dict)
    feeds: frozenset[float] = frozenset()
    plane: int = 17
    inverse: bool = False
    inches: bool = False

    @property
    def axes(self) -> str:
        """Axes that a move names."""
        return "".join(letter for letter in AXES if letter in self.words)

    def has(self, *codes: str) -> bool:
        """Whether one of some codes is in it, leading zeros or not."""
        return any(re.search(rf"(?<![A-Z0-9.]){c[0]}0?{re.escape(c[1:])}(?![0-9.])", self.code) for c in codes)

    @property
    def moves(self) -> bool | None:
        """Whether the axes move; None: not known."""
        if self.kind == "cycle" or self.motion in (2, 3):
            return True
        known = [self.before[a] is not None and self.after[a] is not None for a in self.axes]
        if any(k and not _same(self.before[a], self.after[a]) for a, k in zip(self.axes, known, strict=True)):
            return True
        return False if all(known) else None


def _same(one: float | None, other: float | None) -> bool:
    return one is not None and other is not None and abs(one - other) < 1e-9


class Text:
    """A target program, or a file that it calls."""

    def __init__(self, text: str, dialect: str, *, called: bool = False) -> None:
        self.dialect = dialect
        self.called = called
        self.raw = text.splitlines()
        self.lines = [Line(raw, self._code(raw)) for raw in self.raw]
        self._follow()

    def _code(self, raw: str) -> str:
        blank = _COMMENT[self.dialect].sub(lambda m: " " * len(m[0]), raw)
        return re.sub(r"^(?:N\d+|/)\s*", lambda m: " " * len(m[0]), blank)

    def _follow(self) -> None:
        place: dict[str, float | None] = dict.fromkeys(AXES, None if self.called else START)
        motion: int | None = None
        relative, inverse, inches, plane, feeds = False, False, False, 17, set[float]()
        for line in self.lines:
            relative = (relative or line.has("G91")) and not line.has("G90")
            inverse = (inverse or line.has("G93")) and not line.has("G94")
            plane = next((n for n in (17, 18, 19) if line.has(f"G{n}")), plane)
            inches = (inches or line.has("G20", "G70")) and not line.has("G21", "G22", "G71")
            line.relative, line.inverse, line.plane, line.inches = relative, inverse, plane, inches
            line.before, line.feeds = dict(place), frozenset(feeds)
            line.kind = self._kind(line, motion)
            line.motion = self._motion(line, motion)
            if line.kind in ("move", "cycle", "machine"):
                line.words = {m[1]: float(m[2]) for m in _WORD.finditer(line.code) if m[1] not in "GMN"}
            if "F" in line.words:
                feeds.add(line.words["F"])
            motion = line.motion if line.kind in ("move", "cycle") else None if line.kind == "structure" else motion
            if self.dialect == "wincnc" and motion in (2, 3):
                motion = 1
            if line.has("G80"):
                motion = None
            place = self._after(line, place)
            line.after = dict(place)

    def _motion(self, line: Line, motion: int | None) -> int | None:
        codes = [int(m[1]) for m in re.finditer(r"(?<![A-Z0-9.])G0?(\d+)(?![0-9.])", line.code)]
        own = [code for code in codes if code in (0, 1, 2, 3, 73, *range(81, 90))]
        return own[0] if own else motion

    def _kind(self, line: Line, motion: int | None) -> str:
        code = line.code.strip()
        if not code:
            return "blank"
        if _STRUCTURE.search(code):
            return "call" if re.match(r"M98|GOSUB", code, re.IGNORECASE) else "structure"
        if line.has("M2", "M30"):
            return "end"
        if line.has("G4"):
            return "dwell" if self._has_time(code) else "stop"
        if line.has("M0", "M1"):
            return "stop"
        names = bool(re.search(r"(?<![A-Z])[XYZ]", code))
        if line.has("G53"):
            return "machine" if names else "frame"
        if _FRAME.search(code) and not (names and line.has("G90") and line.has("G1", "G0")):
            return "frame"
        if not (names or (line.has("G2", "G3") and re.search("[IJK]", code))):
            return "other"
        kind = self._motion(line, motion)
        return "other" if kind is None else "cycle" if kind > 3 else "move"

    def _has_time(self, code: str) -> bool:
        return bool(re.search(r"G0?4\s*[PX]?\s*\d", code))

    def _after(self, line: Line, place: dict[str, float | None]) -> dict[str, float | None]:
        unknown: dict[str, float | None] = dict.fromkeys(AXES, None)
        changes_unit = _UNIT.search(line.code) and any(not _is_start(v) for v in place.values())
        if line.kind in ("structure", "call", "machine", "end") or line.has("G28"):
            return unknown
        if line.kind == "frame" and not all(map(_is_start, place.values())):
            return unknown
        if changes_unit or (self.dialect == "mcuwin" and line.has("G70")):
            return unknown
        if line.kind == "cycle":
            return {a: line.words.get(a, v) if a in "XY" and not line.relative else None for a, v in place.items()}
        if line.kind != "move":
            return place
        if line.relative:
            return {a: None if v is None else v + line.words.get(a, 0.0) for a, v in place.items()}
        return {a: line.words.get(a, v) for a, v in place.items()}

    # ---- edits

    def replaced(self, n: int, *lines: str) -> str:
        """The text with other lines in place of one."""
        return "\n".join([*self.raw[:n], *lines, *self.raw[n + 1 :]]) + "\n"

    def before(self, n: int, *lines: str) -> str:
        """The text with more lines before one."""
        return self.replaced(n, *lines, self.raw[n])

    def exchanged(self, n: int) -> str:
        """The text with a line and the next one in the other order."""
        return "\n".join([*self.raw[:n], self.raw[n + 1], self.raw[n], *self.raw[n + 2 :]]) + "\n"

    def substituted(self, n: int, pattern: str, by: str) -> Iterator[str]:
        """The text with one place of a line that fits a pattern anew, place by place; comments stay."""
        line = self.lines[n]
        for match in re.finditer(pattern, line.code):
            new = line.raw[: match.start()] + match.expand(by) + line.raw[match.end() :]
            if new != line.raw:
                yield self.replaced(n, new)

    def word(self, n: int, letter: str, value: float | None, name: str | None = None) -> str:
        """The text with another number of a word, another letter, or without the word."""
        line = self.lines[n]
        match = next(m for m in _WORD.finditer(line.code) if m[1] == letter)
        new = "" if value is None else f"{name or letter}{value:.10g}"
        return self.replaced(n, (line.raw[: match.start()] + new + line.raw[match.end() :]).rstrip())

    # ---- what lines are

    def each(self, *kinds: str) -> Iterator[tuple[int, Line]]:
        """Lines of some kinds, by number."""
        return ((n, line) for n, line in enumerate(self.lines) if line.kind in kinds)

    def coded(self, *codes: str) -> Iterator[tuple[int, Line]]:
        """Lines that have one of some codes."""
        return ((n, line) for n, line in enumerate(self.lines) if line.has(*codes))

    def next_move(self, n: int) -> Line | None:
        """The move right after a line; None where something else comes."""
        rest = [line for line in self.lines[n + 1 :] if not _is_mode(line)]
        return rest[0] if rest and rest[0].kind in ("move", "cycle", "machine") else None

    def is_cut(self, n: int) -> bool:
        """Whether a move may only cut a longer one in two, so that where it ends changes nothing."""
        line, after = self.lines[n], self.next_move(n)
        if line.kind != "move" or line.motion not in (0, 1):
            return False
        if after is None:
            rest = [one for one in self.lines[n + 1 :] if not _is_mode(one)]
            return bool(rest) and rest[0].kind == "call"
        own = after.words.get("F")
        if (
            after.kind != "move"
            or line.motion != after.motion
            or (own is not None and own not in line.feeds | {line.words.get("F")})
        ):
            return False
        ways = []
        for one in (line, after):
            way = [(one.after[a], one.before[a]) for a in AXES]
            if any(p is None or q is None for p, q in way):
                return len(set(line.axes + after.axes)) == 1
            ways.append([float(p) - float(q) for p, q in way if p is not None and q is not None])
        (a, b, c), (d, e, f) = ways
        cross = abs(a * e - b * d) + abs(b * f - c * e) + abs(a * f - c * d)
        return not cross > 1e-9 and a * d + b * e + c * f >= 0  # NaN, from the start on, is another direction

    def zero_again(self, n: int, axis: str) -> bool:
        """Whether no place of an axis counts from the zero at a line: another zero, the end or distances come first."""
        for line in self.lines[n:]:
            if line.kind in ("frame", "machine", "end") or (line.kind == "move" and line.relative):
                return True
            if line.kind in ("move", "cycle") and axis in line.words:
                return False
        return True

    def is_plain_before(self, n: int) -> bool:
        """Whether nothing but the head has said which zero is in force."""
        return not any(line.kind in ("frame", "machine") and not line.has("G17", "G54") for line in self.lines[:n])

    def has_moved(self, n: int) -> bool:
        """Whether the program has moved before a line, besides the subprograms that may come first in the file."""
        begin = max((k for k, raw in enumerate(self.raw[:n]) if raw.strip().lower().endswith("endsub")), default=0)
        return any(line.kind in ("move", "cycle") for line in self.lines[begin:n])


def _is_mode(line: Line) -> bool:
    """Whether a line moves, switches and asks nothing."""
    return line.kind in ("blank", "frame") or (line.kind == "other" and not re.search(r"[MSTL]\d", line.code))


def _is_start(value: float | None) -> bool:
    return value is not None and math.isnan(value)
