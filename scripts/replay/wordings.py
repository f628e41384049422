"""What differs between two revisions in nothing but the wording of a sentence.

A sentence of one side is paired with one of the other by all that is not a sentence: the finding's code and place and
name, the key of a report and its place in it, the line of a text, the value of a text form. Both have to say the same
facts: the same numbers, as often, where one with three decimals or more may be the rounded other one; and each name of
the old sentence (an axis, a text in quotes, a key) is in the new one. What has a number or a name less is a difference
like any other. Each wording is listed once, with how often it came.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

ROUNDED = 3
"""Decimals of a number that may be the rounded one of the other side."""
SAID = ("message", "hint", "text")
"""Keys of reports that hold a sentence, be it of one word."""
REPORT, FORM = "report", "text form"
"""Where a sentence is that no finding says."""
_PARTS = re.compile(r" \(hint: |, only when |, for example when ")
"""What comes after a message where it is one text with its hint and what it rests on."""
_NUMBER = re.compile(r"(?<![A-Za-z0-9.])-?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|(?<=[A-Za-z#$])-?\d+(?:\.\d+)?")
_LETTER = re.compile(r"(?<![\w'])[A-Z](?![\w'])")
_QUOTED = re.compile(r"(?<!\w)(['\"])((?:(?!\1).)+)\1(?!\w)")
_KEY = re.compile(r"\b[a-z]+(?:_[a-z]+)+\b|--[a-z-]+")
_PREFIX = re.compile(r"(?P<place>.*? (?:error|unknown|warning|note) (?P<code>GP\d{3}) \[[a-z0-9-]+\] )(?P<message>.*)")
_LEAD = re.compile(r"\s*(?:=\s+(?:hint:|note:)?|\.\.\.|assuming\b)?\s*")
_IN_FORM = re.compile(r'"(?:[^"\\]|\\.)*"')
_BLANKS, _BREAKS = re.compile(r"\s+"), re.compile(r"(?<=[(\[]) | (?=[)\]])")
_DIGEST = re.compile(r"\b[0-9a-f]{64}\b")
_CAPITALS = re.compile(r"\b[A-Z]{2,}\b")
_PATH = re.compile(r"(?<![\w.])(?:/[\w.#@+-]+){2,}")
"""A file's path: a name, whatever numbers are in it."""
_QUOTED_LINE = re.compile(r" *\d* \|")
_AXIS = re.compile(r"(?<![\w'])[XYZABCUVW](?![\w'])")


_ERRORS = "\n--- standard error\n"


class Different(Exception):
    """More than the wording."""


@dataclass
class Wordings:
    """Sentences that say the same; count: by code (or where they are), old and new one, numbers left out."""

    count: Counter[tuple[str, str, str]] = field(default_factory=Counter)
    rounded: set[tuple[str, str, str]] = field(default_factory=set)

    def explain(self, differing: dict[str, tuple[str, str]]) -> dict[str, tuple[str, str]]:
        """Those aspects of a program that differ in more than sentences; the wordings of the others are counted."""
        left, found = self._explained(differing, hashes=len(differing) > 1)
        if left:  # digests of what differs in more than words are differences too
            left, found = self._explained(differing, hashes=False)
        self.count += found
        return left

    def _explained(
        self, differing: dict[str, tuple[str, str]], *, hashes: bool
    ) -> tuple[dict[str, tuple[str, str]], Counter[tuple[str, str, str]]]:
        left, counted = {}, Counter[tuple[str, str, str]]()
        for name, texts in differing.items():
            found: Counter[tuple[str, str, str]] = Counter()
            try:
                _Pairing(name, found, self.rounded, hashes).texts(*texts)
            except Different:
                left[name] = texts
            else:
                counted += found
        return left, counted

    def lines(self) -> list[str]:
        """The list, by code."""
        return [
            f"{code}: {old} → {new} ({times}{', rounded' if (code, old, new) in self.rounded else ''})"
            for (code, old, new), times in sorted(self.count.items())
        ]


@dataclass
class _Pairing:
    """One aspect of one program."""

    name: str
    found: Counter[tuple[str, str, str]]
    rounded: set[tuple[str, str, str]]
    hashes: bool
    """Whether other aspects differ too: their digests are no difference of their own."""

    def texts(self, before: str, now: str) -> None:
        """Both texts of the aspect."""
        (one, _, errors), (other, _, others) = before.partition(_ERRORS), now.partition(_ERRORS)
        try:
            trees = json.loads(one), json.loads(other)
        except ValueError:
            self._other_text(one, other)
        else:
            self.trees(*trees, code="")
        self.lines(errors, others)

    def _other_text(self, before: str, now: str) -> None:
        """A text form, a program, or lines for people."""
        if self.name.startswith("dump") or self.name.endswith(".ir"):
            self.form(before, now)
        elif self.name != "fmt":
            self.lines(before, now)
        elif before != now:
            raise Different

    def trees(self, before: Any, now: Any, code: str, key: str = "") -> None:
        """Two values of a report, of which only sentences may differ."""
        if type(before) is not type(now):
            raise Different
        if isinstance(before, dict):
            if list(before) != list(now):
                raise Different
            code = str(before.get("code") or before.get("ruleId") or code)
            for name, value in before.items():
                if name == "rules" and isinstance(value, list) and value and "id" in value[0]:
                    self.pages(value, now[name])
                else:
                    self.trees(value, now[name], code, name)
        elif isinstance(before, list):
            if len(before) != len(now):
                raise Different
            for one, other in zip(*_in_order(before, now), strict=True):
                self.trees(one, other, code)
        elif isinstance(before, str):
            self.strings(before, now, code or REPORT, key)
        elif before != now:
            raise Different

    def pages(self, before: list[Any], now: list[Any]) -> None:
        """The rules of a SARIF report: what their pages say is no finding, and is counted by code alone."""
        if [rule["id"] for rule in before] != [rule["id"] for rule in now]:
            raise Different
        for one, other in zip(before, now, strict=True):
            if one != other:
                self.found[one["id"], "its page", "its page"] += 1

    def strings(self, before: str, now: str, code: str, key: str) -> None:
        """Two values of a key: the same, or sentences."""
        if before == now:
            return
        if self.hashes and _DIGEST.sub("", before) == _DIGEST.sub("", now):
            return
        if "\n" in before or "\n" in now:
            self.lines(before, now)
            return
        if key not in SAID and (" " not in before or " " not in now):
            raise Different
        self.sentence(before, now, code)

    def lines(self, before: str, now: str) -> None:
        """Two texts, line by line; a finding's message gives its code to the lines below it."""
        code = REPORT
        one, other = before.splitlines(), now.splitlines()
        if len(one) != len(other):
            raise Different
        for old, new in zip(one, other, strict=True):
            first, second = _PREFIX.fullmatch(old), _PREFIX.fullmatch(new)
            if first is not None:
                code = first["code"]
            elif not old.startswith(" "):
                code = REPORT
            if old == new or (self.hashes and _DIGEST.sub("", old) == _DIGEST.sub("", new)):
                continue
            if _QUOTED_LINE.match(old):
                raise Different
            if first is not None and second is not None:
                if first["place"] != second["place"]:
                    raise Different
                self.sentence(first["message"], second["message"], code)
            else:
                lead, led = _LEAD.match(old), _LEAD.match(new)
                assert lead is not None and led is not None
                if lead[0] != led[0]:
                    raise Different
                self.sentence(old[lead.end() :], new[led.end() :], code)

    def form(self, old: str, new: str) -> None:
        """A text form: only its quoted texts may differ, and where its lines are broken for them."""
        one, other = (_BREAKS.sub("", _BLANKS.sub(" ", _IN_FORM.sub('""', text))) for text in (old, new))
        if one != other:
            raise Different
        for one, other in zip(_IN_FORM.findall(old), _IN_FORM.findall(new), strict=True):
            if one != other:
                if " " not in one or " " not in other:
                    raise Different
                self.sentence(one[1:-1], other[1:-1], FORM)

    def sentence(self, old: str, new: str, code: str) -> None:
        """Two sentences with the same facts, or more that are one text."""
        parts = _PARTS.split(old), _PARTS.split(new)
        if len(parts[0]) > 1 and len(parts[0]) == len(parts[1]):
            for one, other in zip(*parts, strict=True):
                if one != other:
                    self.sentence(one, other, code)
            return
        rounding = _same_numbers(_PATH.sub(" ", old), _PATH.sub(" ", new))
        said = new.lower()
        if not set(_PATH.findall(old)) <= set(_PATH.findall(new)):
            raise Different
        for letter in _LETTER.findall(old):
            if letter not in _LETTER.findall(new) and not re.search(rf"(?<!\w){letter}[-\d#]", new):
                raise Different
        for _, quoted in _QUOTED.findall(old):
            if quoted.lower() not in said:
                raise Different
        for names in (_KEY, _CAPITALS):
            if not set(names.findall(old)) <= set(names.findall(new)):
                raise Different
        kind = code, _kind(old), _kind(new)
        self.found[kind] += 1
        if rounding:
            self.rounded.add(kind)


def _in_order(before: list[Any], now: list[Any]) -> tuple[list[Any], list[Any]]:
    """Both lists, by what is not a sentence where the order of sentences made theirs."""
    one, other = [_bare(item) for item in before], [_bare(item) for item in now]
    if one == other or sorted(one) != sorted(other):
        return before, now
    return (
        [before[n] for n in sorted(range(len(one)), key=one.__getitem__)],
        [now[n] for n in sorted(range(len(other)), key=other.__getitem__)],
    )


def _bare(value: Any) -> str:
    """A value without its sentences."""
    if isinstance(value, dict):
        return "{" + ",".join(f"{key}:{_bare(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ",".join(map(_bare, value)) + "]"
    return "~" if isinstance(value, str) and " " in value else repr(value)


def _same_numbers(old: str, new: str) -> bool:
    """Whether a number of the new sentence is a rounded one; Different where the numbers are others."""
    left = _NUMBER.findall(new)
    unmatched = []
    for number in _NUMBER.findall(old):
        same = next((n for n, one in enumerate(left) if float(one) == float(number)), None)
        if same is None:
            unmatched.append(number)
        else:
            del left[same]
    if len(unmatched) != len(left):
        raise Different
    for number in unmatched:
        near = next((n for n, one in enumerate(left) if _is_rounded(number, one)), None)
        if near is None:
            raise Different
        del left[near]
    return bool(unmatched)


def _is_rounded(number: str, rounded: str) -> bool:
    decimals = len(rounded.partition(".")[2])
    if decimals < ROUNDED or "e" in rounded.lower():
        return False
    return abs(float(number) - float(rounded)) <= 0.5000001 * 10.0**-decimals


def _kind(sentence: str) -> str:
    """A sentence without its numbers, quotations and the axis it speaks of."""
    text = _QUOTED.sub("'...'", _PATH.sub("FILE", sentence))
    return _AXIS.sub("X", _NUMBER.sub("#", text))
