"""A program of Eding CNC that goes on with another one at a line: modes, tool, spindle, coolant, then the way there.

The lines before must be plain words: what they leave in force is read from them, the last word of each modal group
(Eding CNC manual 3.3.7, 3.4), and printed again. Whether nothing was missed is not decided here: the new program is
executed, and its rows must be those of the job.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from decimal import Decimal

from gproof.frontend.common.resuming import CannotResume, Resumed, Start

_COMMENT = re.compile(r"\([^()]*\)|;.*$")
_WORD = re.compile(r"([A-Z])\s*([+-]?(?:\d+\.?\d*|\.\d+))")

GROUPS = {
    "motion": ("0", "1", "2", "3", "80", "73", "74", "81", "82", "83", "84", "85", "86", "89"),
    "plane": ("17", "18", "19"),
    "units": ("20", "21", "70", "71"),
    "cutter": ("40", "41", "42", "41.1", "42.1"),
    "length": ("43", "49"),
    "offset": ("54", "55", "56", "57", "58", "59", "59.1", "59.2", "59.3"),
    "path": ("61", "61.1", "64"),
    "rotation": ("68", "69"),
    "scaling": ("50", "51"),
    "distance": ("90", "91"),
    "feed": ("93", "94", "95"),
    "spindle mode": ("96", "97"),
    "retract": ("98", "99"),
}
"""Modal groups of G codes. Source: Eding CNC manual 3.3.7."""

OF_GROUP = {code: group for group, codes in GROUPS.items() for code in codes}

ONCE = ("4", "28", "30", "53")
"""G codes of one line only: where they led is known from the execution."""

IN_FORCE = {
    "cutter": (("41", "42", "41.1", "42.1"), "cutter radius compensation is on"),
    "motion": (("73", "74", "81", "82", "83", "84", "85", "86", "89"), "a canned cycle is in force"),
    "rotation": (("68",), "the plane is rotated"),
    "scaling": (("51",), "axes are scaled"),
    "feed": (("93", "95"), "the feed is not in units a minute"),
    "spindle mode": (("96",), "the surface speed is held constant"),
}
"""What cannot be taken up again, by the group that says so."""

M_CODES = ("0", "1", "3", "4", "5", "6", "7", "8", "9", "48", "49", "60")
"""M codes whose effect is taken up again, or is over."""

Words = list[tuple[str, str]]


class _Modes:
    """What the lines before leave in force."""

    def __init__(self) -> None:
        self.codes: dict[str, tuple[str, int, Words]] = {}
        self.words: dict[str, str] = {}
        self.tool: str | None = None
        self.spindle: str | None = None
        self.coolant: set[str] = set()
        self.overrides = ""
        self.spinning_up = ""
        self._waits = False

    def take(self, words: Words, line: int) -> None:
        """The words of one line; CannotResume for one whose effect cannot be had again."""
        if any(letter in "XYZABC" for letter, _ in words):
            self._waits = False
        for letter, number in words:
            if letter == "G":
                self._g(number, line, words)
            elif letter == "M":
                self._m(number, line, words)
            elif letter in "FST":
                self.words[letter] = number

    def _g(self, number: str, line: int, words: Words) -> None:
        group = OF_GROUP.get(number)
        if group is None and number not in ONCE:
            raise CannotResume(f"line {line}: G{number} cannot be taken up again")
        if group is not None:
            self.codes[group] = number, line, words
        if number == "4" and self._waits:
            self.spinning_up = "G4" + "".join(f" P{value}" for letter, value in words if letter == "P")

    def _m(self, number: str, line: int, words: Words) -> None:
        if number not in M_CODES:
            raise CannotResume(f"line {line}: M{number} cannot be taken up again")
        if number in ("3", "4", "5"):
            self.spindle, self.spinning_up, self._waits = number, "", number != "5"
        elif number in ("7", "8"):
            self.coolant.add(number)
        elif number == "9":
            self.coolant.clear()
        elif number == "6":
            self.tool = dict(words).get("T", self.words.get("T"))
        elif number in ("48", "49"):
            self.overrides = number

    def code(self, group: str) -> str:
        """The code in force of a group; empty: none was named."""
        return self.codes[group][0] if group in self.codes else ""


def resumed(lines: Sequence[str], start: Start) -> Resumed:
    """The new program; CannotResume."""
    modes = _Modes()
    for number, text in enumerate(lines[: start.line - 1], 1):
        modes.take(_words(text, number), number)
    for group, (codes, why) in IN_FORCE.items():
        if modes.code(group) in codes:
            raise CannotResume(f"{why} since line {modes.codes[group][1]} (G{modes.code(group)})")
    after = [_words(text, number) for number, text in enumerate(lines[start.line - 1 :], start.line)]
    first = next((words for words in after if any(letter in "XYZABCIJKR" for letter, _ in words)), [])
    motion = modes.code("motion")
    if motion in ("2", "3") and not any(letter == "G" and OF_GROUP.get(n) == "motion" for letter, n in first):
        raise CannotResume(f"line {start.line} continues an arc of line {modes.codes['motion'][1]} without naming it")
    added = tuple(_added(modes, start))
    rest = "\n".join(lines[start.line - 1 :])
    return Resumed(added, "\n".join(added) + "\n" + rest.rstrip("\n") + "\n")


def _words(text: str, line: int) -> Words:
    """The words of a plain line; CannotResume for any other."""
    plain = _COMMENT.sub(" ", text).strip().upper()
    if plain in ("", "%"):
        return []
    left = _WORD.sub(" ", plain).strip()
    if left:
        what = "a block that may be deleted" if left.startswith("/") else f"not plain words ({left[:30].strip()})"
        raise CannotResume(f"line {line}: {what}; a job goes on where all of its lines are plain words")
    return [(letter, _number(number)) for letter, number in _WORD.findall(plain) if letter != "N"]


def _number(text: str) -> str:
    """A number as codes are named: 54 for 54. and 054, 59.1 for 59.10."""
    value = Decimal(text)
    return f"{value.normalize():f}" if value else "0"


def _added(modes: _Modes, start: Start) -> list[str]:
    """The lines before the job's own: modes, up, tool, spindle, coolant, across, down."""
    inch = modes.code("units") in ("20", "70")

    def place(*letters: str) -> str:
        at = dict(start.at)
        return "".join(f" {letter}{_place(at[letter], inch and letter in 'XYZ')}" for letter in letters)

    across = [letter for letter, _ in start.at if letter != "Z"]
    out = [f"({start.job.replace('(', '[').replace(')', ']')} from line {start.line}, by gproof)"]
    out.append(f"{'G20' if inch else 'G21'} G90 G94 G40 G49 G80 G{modes.code('plane') or '17'}")
    out += [f"G{modes.code('offset')}"] if modes.code("offset") else []
    out.append(f"G0 G53 Z{_place(start.top, inch)}")
    out += [f"T{modes.tool} M6"] if modes.tool is not None else []
    out += [f"T{modes.words['T']}"] if modes.words.get("T", modes.tool) != modes.tool else []
    if modes.code("length") == "43":
        out.append("G43" + _with(modes, "length", "H"))
    if modes.code("path"):
        out.append(f"G{modes.code('path')}" + _with(modes, "path", "PQR"))
    out += [f"G{modes.code('retract')}"] if modes.code("retract") else []
    out += [f"M{modes.overrides}"] if modes.overrides else []
    if "S" in modes.words or modes.spindle in ("3", "4"):
        speed = f"S{modes.words['S']}" if "S" in modes.words else ""
        turning = f"M{modes.spindle}" if modes.spindle in ("3", "4") else ""
        out.append(f"{speed} {turning}".strip())
        out += [modes.spinning_up] if modes.spinning_up and turning else []
    out += [f"M{code}" for code in sorted(modes.coolant)]
    if across:
        out.append("G0 G53" + place(*across))
    out.append(f"G0 G53 Z{_place(start.plane, inch)}")
    if "F" in modes.words:
        slower = start.plunge is not None and start.plunge < float(modes.words["F"]) * (25.4 if inch else 1)
        feed = _place(start.plunge, inch) if slower and start.plunge is not None else modes.words["F"]
        out.append(f"G1 G53{place('Z')} F{feed}")
        out += [f"F{modes.words['F']}"] if slower else []
    elif start.plane != dict(start.at)["Z"]:
        raise CannotResume(f"no feed is known before line {start.line}, with which the tool could go down")
    if modes.code("motion") in ("", "0"):
        out.append(f"G0 G53{place('Z')}")
    if modes.code("distance") == "91":
        out.append("G91")
    return out


def _with(modes: _Modes, group: str, letters: str) -> str:
    """The words that a code had beside it."""
    words = modes.codes[group][2]
    return "".join(f" {letter}{number}" for letter, number in words if letter in letters)


def _place(value: float, inch: bool) -> str:
    number = value / 25.4 if inch else value
    return f"{Decimal(repr(round(number, 9 if inch else 7))).normalize():f}"
