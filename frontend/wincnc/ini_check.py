"""The settings of a WINCNC.INI judged by the table of keys, and their values in gproof's units.

``Sheet`` has the settings by key, those of each axis together; a value that cannot be is a finding at its place.
What a known key has beyond the manual is UNKNOWN where a job rests on the key, else a warning.
Source: WinCNC manual, "System Configuration".
"""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from gproof.frontend.wincnc.ini_file import IniFile, Setting, Word, exact
from gproof.frontend.wincnc.ini_keys import EACH_AXIS, KEYS, MANY, OF_AXIS, KeyRule
from gproof.ir import codes
from gproof.ir.machine import AXIS_NAMES, Unmodelled

UNITS = {"IN": Fraction(127, 5), "CM": Fraction(10), "MM": Fraction(1)}
"""Millimetres in a unit (Unit Settings: unit=)."""

AXIS_LETTERS = "XYZABCWUV"
TURNING = "ABC"
"""Letters of axes that turn, where T of axisspec= does not say otherwise."""
TYPE_TURNING = 4
SECONDS_IN_MINUTE = 60
HIGHEST_CHANNEL = 64
"""Of inputs and outputs; auxin= and auxout= speak of 32, M17.3 and M18.2 of 64."""

_PORT = re.compile(r"\d{1,2}\s*[,\s]\s*(?:0x)?[0-9a-f]{1,8}h?", re.ASCII | re.IGNORECASE)
_WHOLE = ("whole", "switch", "channel", "axis")
_USUAL_RANGE = {"switch": "0..1", "channel": f"0..{HIGHEST_CHANNEL}"}


class Sheet:
    """What a file says.

    unit: millimetres in one of its units; letters: of its axes in order; columns: by letter; settings: by key, those
    that belong to no axis; axes: by key for each axisspec=; not_modelled: what is on and cannot be followed.
    """

    def __init__(self, ini: IniFile) -> None:
        self.ini = ini
        self.not_modelled: list[Unmodelled] = []
        self.unit = self._unit()
        self.letters, self.columns = self._letters()
        ini.columns = self.columns
        self.settings: dict[str, list[Setting]] = {}
        self.axes: list[dict[str, list[Setting]]] = []
        for setting in ini.settings:
            self._sort(setting)

    # -- values

    def all(self, key: str) -> list[Setting]:
        """Every setting of a key that belongs to no axis."""
        return self.settings.get(key, [])

    def one(self, key: str) -> Setting | None:
        """The setting of a key that is once."""
        return next(iter(self.all(key)), None)

    def value(self, key: str, letter: str) -> Fraction | None:
        """The number after a letter of a key, as written."""
        return number(self.one(key), letter)

    def bare(self, key: str) -> Fraction | None:
        """The number that is a key's value, as written."""
        setting = self.one(key)
        return None if setting is None else exact(setting.text)

    def text(self, key: str) -> str:
        """The value of a key as written, "" without it."""
        setting = self.one(key)
        return "" if setting is None else setting.text

    def switch(self, key: str, letter: str) -> bool | None:
        """A letter that is 0 or 1; None without it."""
        value = self.value(key, letter)
        return None if value is None else value != 0

    def length(self, key: str, letter: str) -> float | None:
        """A letter that is a length, in mm."""
        return self.scaled(self.value(key, letter), self.unit)

    def feed(self, key: str, letter: str) -> float | None:
        """A letter in units a minute, in mm/s."""
        return self.scaled(self.value(key, letter), self.unit / SECONDS_IN_MINUTE)

    def plain(self, key: str, letter: str) -> float | None:
        """A letter that is degrees, seconds or percent."""
        return self.scaled(self.value(key, letter), Fraction(1))

    def channel(self, key: str, letter: str) -> int | None:
        """A letter that is the number of an input or output; None for 0."""
        return int(self.value(key, letter) or 0) or None

    def axis(self, key: str, letter: str) -> str | None:
        """A letter that is the number of an axis, as its column."""
        value = self.value(key, letter)
        return None if value is None or not self.letters else self.columns[self.letters[int(value)]]

    def turns(self, letter: str) -> bool:
        """True for an axis that counts degrees: T4, or without T one of A, B and C."""
        at = self.letters.find(letter)
        kind = number(self.axes[at]["axisspec"][0], "T") if 0 <= at < len(self.axes) else None
        return letter in TURNING if kind is None else kind == TYPE_TURNING

    @staticmethod
    def scaled(value: Fraction | None, unit: Fraction) -> float | None:
        """A number times a unit, rounded once."""
        return None if value is None else float(value * unit)

    def open(self, setting: Setting, why: str, axis: str = "", word: Word | None = None) -> None:
        """A setting that is on and that gproof does not follow; which jobs it touches the table of keys says."""
        what = f"{setting.shown}={setting.text}" if word is None else f"{setting.shown}= {word.letter}{word.text}"
        touches = KEYS[setting.key].touches
        touches = "" if axis or touches in ("axis", "all") else touches
        file = Path(self.ini.name).name
        self.not_modelled.append(Unmodelled(what[:80], why, axis, file, setting.line, touches=touches))

    def odd(self, key: str) -> bool:
        """Whether a setting of a key, of an axis or not, has a letter that the manual does not name."""
        known = KEYS[key].letters
        found = [*self.all(key), *(setting for own in self.axes for setting in own.get(key, ()))]
        return any(word.letter not in known for setting in found for word in setting.words)

    def _odd_letter(self, setting: Setting, word: Word, touches: str) -> None:
        """A letter that the manual does not name: what rests on its key is UNKNOWN for the jobs that it touches."""
        if touches in ("", "corners", "state"):
            self.ini.report_unknown(setting, word)
            return
        at = len(self.axes) - (setting.key != "axisspec")
        of_axis = touches == "axis" and 0 <= at < len(self.letters)
        axis = self.columns[self.letters[at]] if of_axis else ""
        self.open(setting, "this letter of the key is not in the manual", axis, word)

    # -- the file

    def _unit(self) -> Fraction:
        """The unit of the file; a unit= that is not its first setting leaves open what the ones above it are in."""
        found = UNITS["IN"]
        for setting in self.ini.settings:
            if setting.key != "unit":
                continue
            if not setting.first:
                self.ini.bad(setting, "must be the first setting of the file")
            name = setting.text.upper()
            if name not in UNITS:
                self.ini.bad(setting, f"{setting.text[:20]!r} is not one of {', '.join(UNITS)}")
            found = UNITS.get(name, found)
        return found

    def _letters(self) -> tuple[str, dict[str, str]]:
        """The letters of axischar= and the column of each; ("", {}) when they cannot be."""
        setting = next((one for one in self.ini.settings if one.key == "axischar"), None)
        if setting is None:
            # It belongs above the first axis.
            first = next((one for one in self.ini.settings if one.key == "axisspec"), None)
            place = (1,) if first is None else (first.line, first.column, first.end_column)
            self.ini.add(codes.MISSING_KEY, *place, key="axischar=", hint=self.ini.hint)
            return "", {}
        letters = "".join(setting.text.split()).upper()
        columns, problem = columns_of(letters)
        if problem:
            self.ini.bad(setting, problem)
            return "", {}
        return letters, columns

    def _sort(self, setting: Setting) -> None:
        """Judge a setting and put it where it belongs."""
        rule = KEYS.get(setting.key)
        if rule is None:
            self.ini.report_unknown(setting)
            return
        at = len(self.axes) - (setting.key != "axisspec")
        if (setting.key in OF_AXIS or setting.key == "axisspec") and 0 <= at < len(self.letters):
            self.ini.axis_of[setting.line] = self.columns[self.letters[at]]
        judged = self._judged(setting, rule)
        if judged is None:
            return
        if setting.key == "axisspec":
            self.axes.append({setting.key: [judged]})
            return
        if setting.key in OF_AXIS and not self.axes:
            self.ini.bad(setting, "is above the first axisspec=, so it belongs to no axis")
            return
        if setting.key == "axischar" and self.axes:
            self.ini.bad(setting, "must be above the first axisspec=")
            return
        home = self.axes[-1] if setting.key in OF_AXIS else self.settings
        before = home.setdefault(setting.key, [])
        if not before or rule.times == MANY:
            before.append(judged)
        elif not _same(before[0], judged):
            of_axis = " of this axis" if rule.times == EACH_AXIS else ""
            self.ini.bad(setting, f"given again{of_axis} with another value than in line {before[0].line}")

    def _judged(self, setting: Setting, rule: KeyRule) -> Setting | None:
        """The setting with its words; None, with a finding, when its value cannot be."""
        if rule.bare.startswith("="):
            value = exact(setting.text)
            if value is not None:
                end = setting.value_column + len(setting.text)
                setting = replace(setting, words=(Word(rule.bare[1], value, setting.text, setting.value_column, end),))
                return self._with_words(setting, rule)
        elif rule.bare:
            return setting if self._bare_is_good(setting, rule.bare) else None
        words = self.ini.words(setting)
        return None if words is None else self._with_words(replace(setting, words=words), rule)

    def _with_words(self, setting: Setting, rule: KeyRule) -> Setting | None:
        good, without = True, []
        for word in setting.words:
            kind = rule.letters.get(word.letter)
            if kind is None and rule.named.form == "axes" and word.letter in AXIS_LETTERS:
                kind = "length"
                if word.letter not in self.columns and self.columns:
                    self.ini.report_unknown(setting, word, "there is no such axis")
            if kind is not None:
                is_good = self._is_good(setting, word, _with_range(rule, word.letter, kind))
                if not is_good and self.ini.is_replaced(setting, word.letter):
                    without.append(word)
                else:
                    good = is_good and good
            elif not self.ini.is_replaced(setting, word.letter):
                self._odd_letter(setting, word, rule.touches)
        if without:
            setting = replace(setting, words=tuple(word for word in setting.words if word not in without))
        return setting if good else None

    def _is_good(self, setting: Setting, word: Word, kind: str) -> bool:
        """True for a word of that kind; else a finding."""
        problem = self._problem(word.value, word.text, kind)
        if problem:
            self.ini.bad(setting, problem, word)
        return not problem

    def _bare_is_good(self, setting: Setting, kind: str) -> bool:
        """True for a value of that kind; else a finding."""
        problem = ""
        if kind == "port":
            problem = "" if _PORT.fullmatch(setting.text) else "it needs a number, a comma and a hexadecimal address"
        elif kind != "text" and not setting.text:
            problem = "no value"
        elif kind != "text":
            value = exact(setting.text)
            if value is None:
                problem = f"{setting.text[:20]!r} is not a number"
            else:
                problem = self._problem(value, setting.text, kind)
        if problem:
            self.ini.bad(setting, problem)
        return not problem

    def _problem(self, value: Fraction | None, text: str, kind: str) -> str:
        """What keeps a value from being of a kind, "" for nothing."""
        name, _, limits = kind.partition(" ")
        if name in ("text", "letters"):
            return "a text in quotes must follow it" if value is not None else ""
        if value is None:
            return "a number must follow it"
        if name in _WHOLE and value.denominator != 1:
            return f"{text} is not a whole number"
        if name == "axis" and self.letters and not 0 <= value < len(self.letters):
            return f"there is no axis number {text}"
        low, _, high = (limits or _USUAL_RANGE.get(name, "")).partition("..")
        if low and value < Fraction(low):
            return f"{text} is below {low}"
        if high and value > Fraction(high):
            return f"{text} is above {high}"
        return ""


def number(setting: Setting | None, letter: str) -> Fraction | None:
    """The number after a letter of a setting, or None."""
    word = None if setting is None else setting.word(letter)
    return None if word is None else word.value


def _with_range(rule: KeyRule, letter: str, kind: str) -> str:
    """The kind with the range that the manual gives for the letter; of keys that are only kept nothing is checked."""
    if rule.treatment == "kept":
        return kind if kind in ("text", "letters") else "number"
    if " " in kind or kind in _USUAL_RANGE:
        return kind
    named = next((parameter for parameter in rule.named.parameters if parameter.letter == letter), None)
    if named is None or (named.low is None and named.high is None):
        return kind
    low, high = ("" if end is None else f"{end:g}" for end in (named.low, named.high))
    return f"{kind} {low}..{high}"


def columns_of(letters: str) -> tuple[dict[str, str], str]:
    """The column of each letter of axischar=, and what is wrong with them ("" for nothing)."""
    if letters[:2] != "XY":
        return {}, "the first axis must be X and the second Y"
    strange = next((letter for letter in letters if letter not in AXIS_LETTERS), None)
    if strange is not None:
        return {}, f"{strange!r} is not an axis; axes are {' '.join(AXIS_LETTERS)}"
    twice = next((letter for at, letter in enumerate(letters) if letter in letters[:at]), None)
    if twice is not None:
        return {}, f"{twice} is given twice"
    free = [name for name in AXIS_NAMES[3:] if name.upper() not in letters]
    columns = {}
    for letter in letters:
        if letter.lower() in AXIS_NAMES:
            columns[letter] = letter.lower()
        elif free:
            columns[letter] = free.pop(0)
        else:
            return {}, f"gproof follows X, Y, Z and three more axes; {letter} is one too many"
    return columns, ""


def _same(one: Setting, other: Setting) -> bool:
    """True when two settings of a key say the same."""
    if one.words or other.words:
        return {(w.letter, w.value, w.value is None and w.text) for w in one.words} == {
            (w.letter, w.value, w.value is None and w.text) for w in other.words
        }
    return one.text == other.text
