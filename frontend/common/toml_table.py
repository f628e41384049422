"""Reading gproof's TOML files with a finding, at its line, for everything that does not fit.

``TomlFile`` reads and parses; ``TomlTable`` takes keys out of a table one by one, so that at the end it knows
which ones were never read: each is an error (GP611). ``-`` in a key is read as ``_``. Decimal fractions keep their
exact text (``Decimal``) until a reader rounds them.
"""

from __future__ import annotations

import hashlib
import re
import tomllib
from collections.abc import Iterable
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any, TypeVar

from gproof.frontend.common.exact_numbers import LARGEST, TINIEST, exact_number, exact_ratio
from gproof.frontend.common.own_keys import KEYS, Keys, nth, suggestion, unknown_keys
from gproof.ir import codes
from gproof.ir.finding import Code, Findings, Severity, Span
from gproof.ir.number_ranges import number_problem

T = TypeVar("T")

OPTIONS = {"gproof-machine/1": "--machine", "gproof-setup/1": "--setup", "gproof-translation/1": "--map"}
"""The option that takes the files of a schema."""

_ROLES = {"gproof-machine/1": "machine", "gproof-setup/1": "setup"}

_NO_TOML = {
    "gproof-machine/1": "use a machine file of gproof (TOML) or of the controller: WINCNC.INI, McuWIN.ini, cnc.ini",
    "gproof-setup/1": "use a setup file of gproof (TOML)",
}
_HEADER = re.compile(r"\s*+(\[\[?)\s*+([^\[\]]++)\]\]?\s*+(?:#.*)?$")
_KEY = re.compile(r"""\s*((?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')(?:\s*\.\s*(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*'))*)\s*=""")
LARGEST_FILE = 4 << 20
"""Bytes of a file; numbers and tables take Python some microseconds a byte to read."""
HINTED = 500
"""Unknown keys for which others are looked for."""
DEEPEST_KEY = 100
"""Parts of a dotted key: reading takes the square of their number."""
_DEEP_KEY = re.compile(
    r"""(?<![A-Za-z0-9_."'-])(?:(?:[A-Za-z0-9_-]++|"[^"\n]{0,80}"|'[^'\n]{0,80}')[ \t]*+\.[ \t]*+){100}"""
)
_AT_LINE = re.compile(r"\(at line (\d+), column (\d+)\)")


class TomlFile:
    """A file, its findings and where its keys are. ``root`` is None when it cannot be read."""

    def __init__(self, path: Path, schema: str, findings: Findings) -> None:
        self.name = str(path)
        self.path = path
        self.findings = findings
        self.sha256 = ""
        self.errors = 0
        self.schema = schema
        self.root: TomlTable | None = None
        self.taken: dict[tuple[str, ...], set[str]] = {}
        self._reported: set[str] = set()
        self._lines: dict[str, int] = {}
        self._parsed = self._parse()
        if self._parsed is not None:
            self.root = TomlTable(self, (), self._parsed, KEYS[schema])
            self._check_schema(schema)

    @property
    def files(self) -> list[tuple[str, str]]:
        """(name, sha256) of what was read."""
        return [(self.name, self.sha256)] if self.sha256 else []

    def add(self, code: Code, where: str, /, **values: Any) -> None:
        """A finding at the line of the dotted key ``where`` ("": the file as a whole)."""
        self.add_at(code, self.place(where), **values)

    def place(self, where: str) -> Span:
        """The line of a dotted key."""
        return Span(self.name, self.line_of(where))

    def add_at(self, code: Code, span: Span, /, **values: Any) -> None:
        """A finding at a place of this file."""
        self.errors += code.severity is Severity.ERROR
        self.findings.add(code.at(span, **values))

    def line_of(self, key: str) -> int:
        """Line of a dotted key, or of the nearest table that holds it, or 1."""
        while key and key not in self._lines:
            key = key.rpartition(".")[0]
        return self._lines.get(key, 1)

    def finish(self) -> None:
        """A finding for each unknown key, in tables too that nobody came to read."""
        for path, key, keys in unknown_keys(self._parsed or {}, KEYS[self.schema], self.taken):
            self.report_unknown(".".join((*path, key)), key, (*keys.own, *keys.tables), ())

    def report_unknown(self, name: str, key: str, known: Iterable[str], given: Iterable[str]) -> None:
        """The finding for a key that is none, once. name: dotted; known: keys of its table; given: those it has."""
        if name not in self._reported:
            self._reported.add(name)
            hint = suggestion(key, self.schema, known, given) if len(self._reported) <= HINTED else ""
            self.add(codes.NO_SUCH_KEY, name, key=name, hint=hint)

    def _parse(self) -> dict[str, Any] | None:
        try:
            raw = self.path.read_bytes()
        except OSError as error:
            self.add(codes.FILE_UNREADABLE, "", what=f"{self.name}: {error.strerror or error}")
            return None
        self.sha256 = hashlib.sha256(raw).hexdigest()
        if len(raw) > LARGEST_FILE:
            what = f"{len(raw)} bytes; a settings file has at most {LARGEST_FILE} bytes"
            self.add(codes.FILE_UNREADABLE, "", what=what)
            return None
        try:
            text = raw.removeprefix(b"\xef\xbb\xbf").decode("utf-8")
        except UnicodeDecodeError as error:
            line = raw.count(b"\n", 0, error.start) + 1
            what = f"byte 0x{raw[error.start]:02X} is not UTF-8"
            self.add_at(codes.FILE_UNREADABLE, Span(self.name, line), what=what)
            return None
        deep = _DEEP_KEY.search(text)
        if deep is not None:
            what = f"a key of more than {DEEPEST_KEY} parts is not a key of gproof"
            self.add_at(codes.FILE_UNREADABLE, Span(self.name, text.count("\n", 0, deep.start()) + 1), what=what)
            return None
        try:
            parsed = tomllib.loads(text, parse_float=Decimal)
        except (tomllib.TOMLDecodeError, ValueError, ArithmeticError, RecursionError) as error:
            place = _AT_LINE.search(str(error))
            lines = text.count("\n") + (not text.endswith("\n"))
            span = Span(self.name, int(place[1]), int(place[2])) if place else Span(self.name, max(lines, 1))
            what = f"this is not TOML: {_AT_LINE.sub('', str(error)).strip() or type(error).__name__}"
            hint = "" if self.path.suffix.lower() == ".toml" else _NO_TOML.get(self.schema, "")
            self.add_at(codes.FILE_UNREADABLE, span, what=what, hint=hint)
            return None
        self._lines = _lines_of_keys(text)
        role = _ROLES.get(self.schema)
        for key, line in self._lines.items() if role else ():
            # Of files that refine one another the outermost one has the last word, and is read first.
            self.findings.stated.setdefault(f"{role}.{key.replace('-', '_')}", Span(self.name, line))
        return parsed

    def _check_schema(self, schema: str) -> None:
        assert self.root is not None
        stated = self.root.text("schema")
        if stated is None and "schema" not in self.root.values:
            self.add(codes.MISSING_KEY, "", key="schema", hint=f'add schema = "{schema}"')
        elif stated is not None and stated != schema:
            option = OPTIONS.get(stated, "")
            hint = f"give this file with {option}" if option else ""
            what = f"{stated!r}; this version of gproof reads {schema!r}"
            self.add(codes.BAD_VALUE, "schema", key="schema", what=what, hint=hint)
            if option:
                self.root = None  # none of its keys is one of this kind of file


def _lines_of_keys(text: str) -> dict[str, int]:
    """First line of each table and key, by dotted name; lines inside long strings may mislead, harmlessly."""
    lines: dict[str, int] = {}
    counts: dict[str, int] = {}
    table = ""
    for number, line in enumerate(text.splitlines(), 1):
        header = _HEADER.match(line)
        key = None if header else _KEY.match(line)
        if header:
            table = _numbered(_plain(header[2]), counts, is_list=header[1] == "[[")
        name = table if header else f"{table}.{_plain(key[1])}".lstrip(".") if key else ""
        while name:
            lines.setdefault(name, number)
            name = name.rpartition(".")[0]
    return lines


def _numbered(table: str, counts: dict[str, int], *, is_list: bool) -> str:
    """The name of a table with the place of each list around it, from the second table of the list on."""
    parts = table.split(".")
    name = ""
    for place, part in enumerate(parts):
        name = f"{name}.{part}".lstrip(".")
        if is_list and place == len(parts) - 1:
            counts[name] = counts.get(name, 0) + 1
        name = nth(name, counts.get(name, 1))
    return name


def _plain(dotted: str) -> str:
    return ".".join(part.strip().strip("\"'") for part in dotted.split("."))


class TomlTable:
    """One table of a file; every reader returns None for a missing key and for a bad value with its finding."""

    def __init__(self, file: TomlFile, path: tuple[str, ...], values: dict[str, Any], keys: Keys | None = None) -> None:
        self.file = file
        self.path = path
        self.keys = keys
        self.values: dict[str, Any] = {}
        self._written: dict[str, str] = {}
        for written, value in values.items():
            key = written if keys is None else keys.spelt(written)
            if key in self.values:
                name = ".".join((*path, written))
                file.add(
                    codes.BAD_VALUE, name, key=name, what=f"also given as {self._written[key]}; both are the same key"
                )
                continue
            self.values[key], self._written[key] = value, written
        self._taken = file.taken.setdefault(path, set())

    def name_of(self, key: str) -> str:
        """The dotted name of a key of this table, as it is written there."""
        return ".".join((*self.path, self._written.get(key, key)))

    def _inner(self, key: str, values: dict[str, Any], number: int = 1) -> TomlTable:
        path = (*self.path, nth(self._written.get(key, key), number))
        return TomlTable(self.file, path, values, None if self.keys is None else self.keys.inner(key))

    def bad(self, key: str, what: str) -> None:
        """A finding for the value of ``key``."""
        self.file.add(codes.BAD_VALUE, self.name_of(key), key=self.name_of(key), what=what)

    def missing(self, key: str) -> None:
        """A finding for a key that must be there."""
        self.file.add(codes.MISSING_KEY, ".".join(self.path), key=self.name_of(key))

    def take(self, key: str) -> Any:
        """The value as TOML has it, or None."""
        self._taken.add(key)
        return self.values.get(key)

    def text(self, key: str, allowed: tuple[str, ...] = ()) -> str | None:
        """A string, one of ``allowed`` when that is given."""
        value = self.take(key)
        if value is None:
            return None
        if not isinstance(value, str):
            self.bad(key, f"{show(value)} is not text")
            return None
        if allowed and value not in allowed:
            self.bad(key, f"{value!r} is not one of {', '.join(allowed)}")
            return None
        return value

    def texts(self, key: str) -> tuple[str, ...] | None:
        """A list of texts."""
        value = self.take(key)
        if value is None:
            return None
        if not isinstance(value, list) or not all(isinstance(one, str) for one in value):
            self.bad(key, f"{show(value)} is not a list of texts")
            return None
        return tuple(value)

    def boolean(self, key: str) -> bool | None:
        """``true`` or ``false``."""
        value = self.take(key)
        if value is None or isinstance(value, bool):
            return value
        self.bad(key, f"{show(value)} is not true or false")
        return None

    def whole(self, key: str, low: int, high: int) -> int | None:
        """A whole number from low to high."""
        value = self.take(key)
        if value is None:
            return None
        exact = exact_number(value)
        if exact is None or exact.denominator != 1 or not low <= exact <= high:
            self.bad(key, f"{show(value)} is not a whole number from {low} to {high}")
            return None
        return int(exact)

    def number(self, key: str, *, unit: Fraction = Fraction(1)) -> float | None:
        """A number, times ``unit``, rounded once."""
        value = self.take(key)
        if value is None:
            return None
        exact = exact_number(value)
        if exact is None:
            self.bad(key, f"{show(value)} is not a number")
            return None
        return self._rounded(key, exact * unit)

    def positive(self, key: str, *, unit: Fraction = Fraction(1), zero: bool = False) -> float | None:
        """A number greater than 0 (or 0, when ``zero``), times ``unit``."""
        value = self.number(key, unit=unit)
        if value is not None and not (value > 0 or (zero and value == 0)):
            self.bad(key, f"{show(self.values[key])} is not {'0 or ' if zero else ''}greater than 0")
            return None
        return value

    def ratio(self, key: str) -> Fraction | None:
        """An exact number: a TOML number, or a text such as ``"1600/5"``."""
        value = self.take(key)
        if value is None:
            return None
        exact = exact_ratio(value) if isinstance(value, str) else exact_number(value)
        if exact is None or not TINIEST <= abs(exact) <= LARGEST:
            self.bad(key, f'{show(value)} is not a number other than 0, or a fraction such as "1600/5"')
            return None
        return exact

    def interval(self, key: str, *, unit: Fraction = Fraction(1)) -> tuple[float, float] | None:
        """A number (both ends), or a list of the lower and upper end."""
        value = self.take(key)
        if value is None:
            return None
        ends = value if isinstance(value, list) else [value, value]
        exact = [exact_number(end) for end in ends]
        if len(exact) != 2 or exact[0] is None or exact[1] is None:
            self.bad(key, f"{show(value)} is not a number or a list of two numbers")
            return None
        if exact[0] > exact[1]:
            self.bad(key, f"the lower end {show(ends[0])} is above the upper end {show(ends[1])}")
            return None
        low, high = self._rounded(key, exact[0] * unit), self._rounded(key, exact[1] * unit)
        return None if low is None or high is None else (low, high)

    def as_stated(self, key: str, value: float, unit: Fraction) -> str:
        """A value as this table writes it; where another file has it, in this file's unit."""
        return show(self.values[key]) if key in self.values else f"{value / float(unit):g}"

    def table(self, key: str) -> TomlTable | None:
        """A table in this table."""
        value = self.take(key)
        if value is None:
            return None
        if not isinstance(value, dict):
            self.bad(key, f"{show(value)} is not a table")
            return None
        return self._inner(key, value)

    def tables(self, key: str) -> list[TomlTable]:
        """The tables of a list, ``[[key]]``."""
        value = self.take(key)
        if value is None:
            return []
        if not isinstance(value, list) or not all(isinstance(one, dict) for one in value):
            self.bad(key, f"{show(value)} is not a list of tables")
            return []
        return [self._inner(key, one, n) for n, one in enumerate(value, 1)]

    def grids(self, key: str) -> list[list[list[Fraction]] | None]:
        """A list of lists of lists of numbers, exactly."""
        value = self.take(key)
        if value is None:
            return []
        if not isinstance(value, list):
            self.bad(key, f"{show(value)} is not a list")
            return [None]
        return [self._grid(key, one) for one in value]

    def grid(self, key: str) -> list[list[Fraction]] | None:
        """A list of lists of numbers, exactly."""
        value = self.take(key)
        return None if value is None else self._grid(key, value)

    def _grid(self, key: str, value: Any) -> list[list[Fraction]] | None:
        rows: list[list[Fraction]] = []
        for row in value if isinstance(value, list) else [None]:
            exact = [exact_number(one) for one in row] if isinstance(row, list) else [None]
            numbers = [one for one in exact if one is not None and abs(one) <= LARGEST]
            if len(numbers) != len(exact):
                self.bad(key, f"{show(row if isinstance(value, list) else value)} is not a list of numbers")
                return None
            rows.append(numbers)
        return rows

    def numbered(self, key: str, low: int, high: int) -> list[tuple[int, TomlTable]]:
        """The tables ``[key.N]`` with N from low to high."""
        outer = self.table(key)
        found = []
        for name in outer.values if outer else ():
            assert outer is not None
            if small_number(name, low, high) is None:
                outer.bad(name, f"{name!r} is not a number from {low} to {high}")
                continue
            inner = outer.table(name)
            if inner is not None:
                found.append((int(name), inner))
        return found

    def finish(self) -> None:
        """A finding for each key that was never read, with the one that may be meant; at the root for the file."""
        known = self._taken.union(() if self.keys is None else (*self.keys.own, *self.keys.tables))
        for key in self.values:
            if key not in self._taken:
                here = known if self.keys is not None and not self.keys.knows(key) else self._taken
                self.file.report_unknown(self.name_of(key), self._written[key], here, self.values)
        if not self.path:
            self.file.finish()

    def _rounded(self, key: str, exact: Fraction) -> float | None:
        if abs(exact) > LARGEST:
            self.bad(key, f"{show(self.values[key])} is too large")
            return None
        return float(exact)


def meant(word: str, known: Iterable[str]) -> str:
    """A hint with the word that may be meant, "" without one."""
    from difflib import get_close_matches

    near = get_close_matches(word.lower(), sorted(known), 1, 0.7)
    return f"did you mean {near[0]!r}?" if near else ""


def in_range(value: T, path: Path, findings: Findings) -> T | None:
    """A machine or setup whose numbers are all in range (``ir/number_ranges.py``); otherwise None, with GP603."""
    wrong = number_problem(value)
    if wrong is None:
        return value
    stated = re.sub(r"\[[^\]]*\]", "", wrong.where)  # fields are mostly called as their keys are
    span = findings.where(f"{type(value).__name__.lower()}.{stated}", Span(str(path), 1))
    findings.add(codes.BAD_VALUE.at(span, key=wrong.where, what=wrong.what))
    return None


def small_number(name: str, low: int, high: int) -> int | None:
    """The whole number that a key spells, when it is in range."""
    if name.isascii() and name.isdigit() and len(name) <= 9 and low <= int(name) <= high:
        return int(name)
    return None


def show(value: Any) -> str:
    """A value in a message, short."""
    text = str(value).lower() if isinstance(value, bool) else str(value) if isinstance(value, Decimal) else repr(value)
    return text if len(text) <= 40 else text[:37] + "..."
