"""A program of Eding CNC that goes on with another one at a line: modes, tool, spindle, coolant, then the way there.

What the lines before leave in force is read from them, the last word of each modal group (Eding CNC manual 3.3.7, 3.4),
and printed again. Numbers of places may be expressions; assignments are printed again in their order. Whether nothing
was missed is not decided here: the new program is executed, and its rows must be those of the job.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from decimal import Decimal

from gproof.frontend.common.resuming import CannotResume, Resumed, Start

_COMMENT = re.compile(r"\([^()]*\)|;.*$")
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)"
_NESTED = r"\[(?:[^\[\]]|\[(?:[^\[\]]|\[[^\[\]]*\])*\])*\]"
_WORD = re.compile(rf"([A-Z])\s*({_NUMBER}|[+-]?#\d+|[+-]?{_NESTED})")
_SET = re.compile(r"#(\d+)\s*=\s*(.+)")
_READ = re.compile(r"#(\d+)")
_AT_FRONT = re.compile(r"\s*(?:[Nn]\s*\d+)?\s*")

UNKNOWN = "?"
"""Stands for a number that is an expression."""

OWN_VARIABLES = 4000
"""Variables from here on outlive the program (4000 to 4999) or are the controller's own (5000 on)."""

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

ONCE = ("4", "10", "28", "30", "53", "92", "92.1")
"""G codes of one line only: where they led is known from the execution, and zeros are kept apart."""

IN_FORCE = {
    "cutter": (("41", "42", "41.1", "42.1"), "cutter radius compensation is on"),
    "rotation": (("68",), "the plane is rotated"),
    "scaling": (("51",), "axes are scaled"),
    "feed": (("93", "95"), "the feed is not in units a minute"),
    "spindle mode": (("96",), "the surface speed is held constant"),
}
"""What cannot be taken up again, by the group that says so."""

CYCLES = ("73", "74", "81", "82", "83", "84", "85", "86", "89")
SUSPEND = ("4", "10", "28", "30", "92")
"""G codes whose words are not those of the motion in force."""

STICKY = "ZRQP"
"""Words of a canned cycle that hold for the next holes. Source: Eding CNC manual 3.4.21."""

M_CODES = ("0", "1", "3", "4", "5", "6", "7", "8", "9", "48", "49", "54", "55", "56", "60")
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
        self.cycle: dict[str, str] = {}
        self.outputs: dict[str, str] = {}
        self.zeros: dict[tuple[str, str], tuple[str, str, Decimal, int]] = {}
        self.cleared = False
        self._waits = False

    def take(self, words: Words, line: int) -> None:
        """The words of one line; CannotResume for one whose effect cannot be had again."""
        if any(letter in "GM" and number == UNKNOWN for letter, number in words):
            raise CannotResume(f"line {line}: a code whose number is an expression", line)
        codes = [number for letter, number in words if letter == "G"]
        self._sticky(words, codes)
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
            raise CannotResume(f"line {line}: G{number} cannot be taken up again", line)
        if number in ("10", "92", "92.1"):
            self._zero(number, line, words)
        if group is not None:
            self.codes[group] = number, line, words
        if number == "4" and self._waits:
            self.spinning_up = "G4" + "".join(f" P{value}" for letter, value in words if letter == "P")

    def _m(self, number: str, line: int, words: Words) -> None:
        if number not in M_CODES:
            raise CannotResume(f"line {line}: M{number} cannot be taken up again", line)
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
        elif number in ("54", "55"):
            given = [(letter, value) for letter, value in words if letter in "PEQ"]
            if len(given) != 1 or given[0][0] != "P" or given[0][1] == UNKNOWN:
                raise CannotResume(
                    f"line {line}: M{number} cannot be taken up again but with a number in P alone", line
                )
            self.outputs[given[0][1]] = number

    def _sticky(self, words: Words, codes: list[str]) -> None:
        """What a canned cycle keeps for its next holes."""
        motion = next((code for code in codes if OF_GROUP.get(code) == "motion"), None)
        if motion is not None and motion != self.code("motion"):
            self.cycle = {letter: number for letter, number in self.cycle.items() if letter == "R"}
        if (motion or self.code("motion")) in CYCLES and not any(code in SUSPEND for code in codes):
            self.cycle.update((letter, number) for letter, number in words if letter in STICKY)

    def _zero(self, code: str, line: int, words: Words) -> None:
        """A zero that the job has set: G10 L2, G10 L20, G92, G92.1 (Eding CNC manual 3.4)."""
        given = dict(words)
        if code == "92.1":
            self.zeros = {key: zero for key, zero in self.zeros.items() if zero[0] != "G92"}
            self.cleared = True
            return
        kind = "G92"
        if code == "10":
            if given.get("L") not in ("2", "20") or given.get("P", UNKNOWN) == UNKNOWN or "R" in given:
                raise CannotResume(f"line {line}: G10 cannot be taken up again but with L2 or L20, and numbers", line)
            kind = f"G10 L{given['L']} P{given['P']}"
        for letter, number in words:
            if letter not in "XYZABC":
                continue
            if number == UNKNOWN:
                raise CannotResume(f"line {line}: {kind} with an expression cannot be taken up again", line)
            inch = self.code("units") in ("20", "70") and letter in "XYZ"
            key = given["P"] if code == "10" else "", letter
            self.zeros.pop(key, None)
            self.zeros[key] = kind, letter, Decimal(number) * (Decimal("25.4") if inch else 1), line

    def code(self, group: str) -> str:
        """The code in force of a group; empty: none was named."""
        return self.codes[group][0] if group in self.codes else ""


def resumed(lines: Sequence[str], start: Start) -> Resumed:
    """The new program; CannotResume."""
    modes, variables = _Modes(), Variables()
    for number, text in enumerate(lines[: start.line - 1], 1):
        plain = _plain(text)
        if not variables.take(plain, number):
            modes.take(_words(plain, number, variables), number)
    for group, (codes, why) in IN_FORCE.items():
        if modes.code(group) in codes:
            line = modes.codes[group][1]
            raise CannotResume(f"{why} since line {line} (G{modes.code(group)})", line)
    rest = list(lines[start.line - 1 :])
    variables.rest(rest, start.line)
    _first_move(modes, rest, start.line)
    added = tuple(variables.lines + _added(modes, start))
    shifted = modes.cleared or any(zero[0] == "G92" for zero in modes.zeros.values())
    if not shifted and any(re.search(r"G\s*92(?!\.[123])", _plain(text)) for text in rest):
        # The run that was left may have come to it.
        added = ("G92.1", *added)
    text = "\n".join(rest)
    title = f"({start.job.replace('(', '[').replace(')', ']')} from line {start.line}, by gproof)"
    added = (title, *added)
    return Resumed(added, "\n".join(added) + "\n" + text.rstrip("\n") + "\n", _zeros_to_come(modes, rest, start.line))


def _zeros_to_come(modes: _Modes, rest: Sequence[str], first: int) -> tuple[str, ...]:
    """A zero that only a later line stores: the run that was left may have stored it already."""
    for line, text in enumerate(rest, first):
        if re.search(r"G\s*10(?![\d.])", _plain(text)):
            words = _letters(text)
            table = dict(words).get("P", "")
            number = _number(table) if re.fullmatch(_NUMBER, table) else UNKNOWN
            if any((number, letter) not in modes.zeros for letter, _ in words if letter in "XYZABC"):
                why = f"the run may have reached line {line}, which stores others"
                return (f"zeros       must be those of the setup: {why}",)
    return ()


class Variables:
    """The assignments of the lines before: they are printed again in their order, and numbers among them are known."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.values: dict[str, str] = {}
        self._set: set[str] = set()

    def take(self, plain: str, line: int) -> bool:
        """Whether a line is an assignment; CannotResume for one that would not give the same again."""
        found = _SET.fullmatch(plain)
        if found is None:
            return False
        name, value = found.groups()
        text = value.strip()
        read = _READ.findall(text)
        if int(name) >= OWN_VARIABLES or "=" in text or "#" in _READ.sub("", text):
            raise CannotResume(f"line {line}: {plain[:30]} cannot be taken up again", line)
        for other in read:
            if other not in self._set:
                raise CannotResume(f"line {line}: #{other} has its value from outside of the job", line)
        self._set.add(name)
        if re.fullmatch(_NUMBER, text):
            self.values[name] = text
        else:
            self.values.pop(name, None)
        self.lines.append(plain)
        return True

    def rest(self, rest: Sequence[str], first: int) -> None:
        """CannotResume where a variable is read before it is set: the run that was left may have set it."""
        known: set[str] = set(self._set)
        read: dict[str, int] = {}
        for line, text in enumerate(rest, first):
            plain = _plain(text)
            found = _SET.fullmatch(plain)
            for name in _READ.findall(found.group(2) if found else plain):
                if name not in known:
                    read.setdefault(name, line)
            if found:
                if read and "#[" in "".join(rest):
                    raise CannotResume(f"line {line} sets a variable, and others are named by an expression")
                if found.group(1) in read:
                    name = found.group(1)
                    raise CannotResume(
                        f"line {read[name]} reads #{name}, which line {line} sets: it may be set already"
                    )
                known.add(found.group(1))


def _first_move(modes: _Modes, rest: list[str], first: int) -> None:
    """The canned cycle in force is named again, with all of its words, on the first line that drills."""
    motion = modes.code("motion")
    if motion not in ("2", "3", *CYCLES):
        return
    for place, text in enumerate(rest):
        letters = _letters(text)
        codes = [_number(number) for letter, number in letters if letter == "G" and re.fullmatch(_NUMBER, number)]
        if any(OF_GROUP.get(code) == "motion" for code in codes):
            return
        names = {letter for letter, _ in letters}
        if not names & set("XYZABCIJKR") or any(code in SUSPEND for code in codes):
            continue
        line = modes.codes["motion"][1]
        if motion in ("2", "3"):
            raise CannotResume(f"line {first + place} continues an arc of line {line} without naming it", line)
        if modes.code("plane") not in ("", "17"):
            raise CannotResume(f"a canned cycle is in force since line {line} in another plane than XY", line)
        if UNKNOWN in modes.cycle.values():
            raise CannotResume(f"the canned cycle of line {line} has an expression that cannot be taken up again", line)
        words = "".join(f" {letter}{modes.cycle[letter]}" for letter in STICKY if letter in modes.cycle.keys() - names)
        end = re.match(_AT_FRONT, text)
        at = end.end() if end else 0
        rest[place] = f"{text[:at]}G{motion}{words} {text[at:]}"
        return


def _plain(text: str) -> str:
    """A line without its comments."""
    return _COMMENT.sub(" ", text).strip().upper()


def _letters(text: str) -> Words:
    return [(letter, number) for letter, number in _WORD.findall(_plain(text)) if letter != "N"]


def _words(plain: str, line: int, variables: Variables) -> Words:
    """The words of a line; CannotResume for a line that has more than words."""
    if plain in ("", "%") or re.match(r"(?:N\s*\d+\s*)?MSG\b", plain):
        return []
    left = _WORD.sub(" ", plain).strip()
    if left:
        what = "a block that may be deleted" if left.startswith("/") else f"not plain words ({left[:30].strip()})"
        raise CannotResume(f"line {line}: {what}; a job goes on where all of its lines are plain words", line)
    return [(letter, _value(number, variables)) for letter, number in _WORD.findall(plain) if letter != "N"]


def _value(number: str, variables: Variables) -> str:
    if re.fullmatch(_NUMBER, number):
        return _number(number)
    value = variables.values.get(number[1:]) if number.startswith("#") else None
    return UNKNOWN if value is None else _number(value)


def _number(text: str) -> str:
    """A number as codes are named: 54 for 54. and 054, 59.1 for 59.10."""
    value = Decimal(text)
    return f"{value.normalize():f}" if value else "0"


def _added(modes: _Modes, start: Start) -> list[str]:
    """The lines before the job's own: modes, up, tool, spindle, coolant, across, down."""
    inch = modes.code("units") in ("20", "70")

    def place(*letters: str) -> str:
        return "".join(f" {letter}{_place(at[letter], inch and letter in 'XYZ')}" for letter in letters)

    zero = start.work or (0.0,) * len(start.at)
    at = {letter: value - known for (letter, value), known in zip(start.at, zero, strict=True)}
    plane = start.plane - dict(start.at)["Z"] + at["Z"]
    machine = "" if start.work else " G53"
    across = [letter for letter, _ in start.at if letter != "Z"]
    out = [f"{'G20' if inch else 'G21'} G90 G94 G40 G49 G80 G{modes.code('plane') or '17'}"]
    out += ["G92.1"] if modes.cleared else []
    out += _table(modes, inch)
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
    if across:
        out.append(f"G0{machine}" + place(*across))
    if "S" in modes.words or modes.spindle in ("3", "4"):
        speed = f"S{modes.words['S']}" if "S" in modes.words else ""
        turning = f"M{modes.spindle}" if modes.spindle in ("3", "4") else ""
        out.append(f"{speed} {turning}".strip())
        out += [modes.spinning_up] if modes.spinning_up and turning else []
    out += [f"M{code}" for code in sorted(modes.coolant)]
    out += [f"M{code} P{number}" for number, code in modes.outputs.items()]
    out.append(f"G0{machine} Z{_place(plane, inch)}")
    if UNKNOWN in (modes.words.get("F"), modes.words.get("S"), modes.words.get("T"), modes.tool):
        raise CannotResume(f"F, S or T before line {start.line} is an expression")
    if "F" in modes.words:
        slower = start.plunge is not None and start.plunge < float(modes.words["F"]) * (25.4 if inch else 1)
        feed = _place(start.plunge, inch) if slower and start.plunge is not None else modes.words["F"]
        out.append(f"G1{machine}{place('Z')} F{feed}")
        out += [f"F{modes.words['F']}"] if slower else []
    elif start.plane != dict(start.at)["Z"]:
        raise CannotResume(f"no feed is known before line {start.line}, with which the tool could be lowered")
    if modes.code("motion") in ("", "0"):
        out.append(f"G0{machine}{place('Z')}")
    out += _here(modes, start, inch)
    if modes.code("distance") == "91":
        out.append("G91")
    if any(UNKNOWN in line for line in out):
        raise CannotResume(f"a number before line {start.line} is an expression")
    return out


def _table(modes: _Modes, inch: bool) -> list[str]:
    """The zeros in the controller's table that the job has stated."""
    out: dict[str, str] = {}
    for kind, letter, value, _ in modes.zeros.values():
        if kind.startswith("G10 L2 "):
            out[kind] = out.get(kind, kind) + f" {letter}{_place(float(value), inch and letter in 'XYZ')}"
    return list(out.values())


def _here(modes: _Modes, start: Start, inch: bool) -> list[str]:
    """The zeros that the job has set where it was: the same ones, said from where the axes are now."""
    out, now = [], dict(start.at)
    for kind, letter, value, line in modes.zeros.values():
        if kind.startswith("G10 L2 "):
            continue
        then = start.before(line) if start.before is not None and not start.work else None
        if then is None or letter not in then:
            raise CannotResume(f"line {line}: where the axes were at {kind} is not known", line)
        number = float(value) + now[letter] - then[letter]
        out.append(f"{kind} {letter}{_place(number, inch and letter in 'XYZ')}")
    return out


def _with(modes: _Modes, group: str, letters: str) -> str:
    """The words that a code had beside it."""
    words = modes.codes[group][2]
    return "".join(f" {letter}{number}" for letter, number in words if letter in letters)


def _place(value: float, inch: bool) -> str:
    number = value / 25.4 if inch else value
    return f"{Decimal(repr(round(number, 9 if inch else 7))).normalize():f}"
