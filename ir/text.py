"""Text forms: any IR value as an S-expression that parses back bit for bit.

``(Name field: value ...)`` is a dataclass: its fields by name, in the order of the type, those left out that have their
default; ``[...]`` a tuple or list; ``{k v ...}`` a dict; numbers print as Python's shortest exact form, rationals as
``n/d``, strings as JSON, enumerations as ``Enum.MEMBER``; bytes as ``b"..."``; ``none true false``. A column table is
``(columns schema rows values ...)``, below a comment with the names of its columns. A value has one text, and a field
that is added with a default changes neither a text nor what it says. ``print_ir`` and ``parse_ir`` know the types of
``ir/``, no others.
"""

from __future__ import annotations

import dataclasses
import enum
import functools
import itertools
import json
import re
import sys
import typing
import warnings
from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from gproof.ir.columns import Columns, Schema

WIDTH = 100


class NotKnown(ValueError):
    """A text has a type, a field or a member of an enumeration that is none here: another version wrote it."""


class Types(NamedTuple):
    """What texts may name: dataclasses, enumerations and schemas of tables, by name."""

    classes: dict[str, type]
    enums: dict[str, type[enum.Enum]]
    schemas: dict[str, Schema]


@functools.cache
def types() -> Types:
    """Those of the IR modules."""
    from gproof.ir import (
        drives,
        finding,
        job,
        machine,
        notes,
        plan,
        program,
        rules,
        settings,
        setup,
        statements,
        stream,
        trace,
        verdict,
        workpiece,
    )
    from gproof.ir.dialects import settings_modules

    found = Types({}, {}, {})
    modules = (
        drives, finding, job, machine, notes, plan, program, rules, settings, setup, statements, stream, trace, verdict,
        workpiece,
    )  # fmt: skip
    for module in (*modules, *settings_modules()):
        for name, value in vars(module).items():
            if isinstance(value, Schema):
                found.schemas[value.name] = value
            elif isinstance(value, type) and value.__module__ == module.__name__:
                if dataclasses.is_dataclass(value):
                    found.classes[name] = value
                elif issubclass(value, enum.Enum):
                    found.enums[name] = value
    return found


_REQUIRED = object()
"""In place of a default."""


@functools.cache
def printed_fields(cls: type) -> tuple[tuple[str, Any], ...]:
    """Fields of a dataclass that are part of its value, each with its default."""
    found = []
    for f in dataclasses.fields(cls):
        if f.compare:
            made = f.default_factory
            default = f.default if made is dataclasses.MISSING else made()
            found.append((f.name, _REQUIRED if default is dataclasses.MISSING else default))
    return tuple(found)


def has_default(default: object) -> bool:
    """Whether what ``printed_fields`` gives with a field is a default."""
    return default is not _REQUIRED


def _same(value: Any, other: Any) -> bool:
    """Whether two values have the same text: 0 is neither 0.0 nor false, 0.0 is not -0.0, NaN is NaN."""
    if value is other:
        return True
    kind = type(value)
    if kind is not type(other):
        return isinstance(value, np.generic) and _same(value.item(), other)
    if kind is float:
        return repr(value) == repr(other)
    if kind is tuple or kind is list:
        return len(value) == len(other) and all(map(_same, value, other))
    if kind is dict:
        return len(value) == len(other) and all(map(_same, value.items(), other.items()))
    if kind is Columns:
        return value.schema is other.schema and len(value) == len(other) == 0
    if dataclasses.is_dataclass(kind):
        return all(_same(getattr(value, name), getattr(other, name)) for name, _ in printed_fields(kind))
    return bool(value == other)


# -- printing


@functools.cache
def _printer(kind: type) -> Callable[[Any], str] | None:
    """What prints a value of a type that has no parts; None for one that has."""
    if kind in (float, int):
        return repr
    if kind is str:
        return json.dumps
    if kind is type(None):
        return lambda value: "none"
    if issubclass(kind, bool):
        return lambda value: "true" if value else "false"
    if issubclass(kind, enum.Enum):
        return lambda value: f"{kind.__name__}.{value.name}"
    if issubclass(kind, float | np.floating):
        return lambda value: repr(float(value))
    if issubclass(kind, int | np.integer):
        return lambda value: str(int(value))
    if kind is Fraction:
        return lambda value: f"{value.numerator}/{value.denominator}"
    if issubclass(kind, str):
        return json.dumps
    if issubclass(kind, bytes):
        return lambda value: "b" + json.dumps(value.decode("utf-8", "surrogateescape"))
    if kind.__name__ == "LanguageRules":
        return lambda value: f"(LanguageRules {json.dumps(value.name)})"
    return None


def _columns(table: Columns, indent: str, before: str) -> Iterator[str]:
    """Rows below one another, lined up, under a line of names."""
    heads: list[str] = []
    cells: list[list[str]] = []
    for c in table.schema.columns:
        values = table[c.name].tolist()
        if c.width == 1:
            heads.append(c.name)
            cells.append([repr(v) for v in values])
        else:
            for k in range(c.width):
                heads.append(f"{c.name}.{k}")
                cells.append([repr(v[k]) for v in values])
    widths = [max([len(h), *map(len, col)]) for h, col in zip(heads, cells, strict=True)]
    yield f"{indent}{before}(columns {table.schema.name} {len(table)}"
    yield f"{indent}  ; " + " ".join(h.rjust(w) for h, w in zip(heads, widths, strict=True))
    for row in zip(*cells, strict=True):
        yield f"{indent}    " + " ".join(v.rjust(w) for v, w in zip(row, widths, strict=True))
    yield f"{indent})"


def _lines(value: Any, indent: str, before: str = "") -> Iterator[str]:
    """before: what is in front of the value on its first line: the name of the field, the key."""
    kind: type = type(value)
    print_ = _printer(kind)
    text = _flat(value, WIDTH - len(indent) - len(before)) if print_ is None else print_(value)
    if text is not None:
        yield f"{indent}{before}{text}"
    elif isinstance(value, Columns):
        yield from _columns(value, indent, before)
    else:
        open_, close, parts = _parts(value)
        yield f"{indent}{before}{open_}"
        for name, part in parts:
            yield from _lines(part, indent + "  ", name)
        yield indent + close


def _parts(value: Any) -> tuple[str, str, list[tuple[str, Any]]]:
    """Brackets around a value, and its parts, each with what is in front of it."""
    kind = type(value)
    if kind is tuple or kind is list:
        return "[", "]", [("", part) for part in value]
    if kind.__name__ == "DeferredBlock":
        value = value.made()
        kind = type(value)
    if dataclasses.is_dataclass(kind):
        parts = []
        for name, default in printed_fields(kind):
            part = getattr(value, name)
            if default is _REQUIRED or not _same(part, default):
                parts.append((f"{name}: ", part))
        return f"({kind.__name__}", ")", parts
    if isinstance(value, dict):
        return "{", "}", [(f"{_flat(key, sys.maxsize)} ", part) for key, part in value.items()]
    if isinstance(value, list | tuple):
        return "[", "]", [("", part) for part in value]
    raise TypeError(f"no text form for {kind.__name__}")


def _flat(value: Any, room: int) -> str | None:
    """The text on one line, or None when it has a table inside or more characters than ``room``."""
    kind: type = type(value)
    print_ = _printer(kind)
    if print_ is not None:
        text = print_(value)
        return text if len(text) <= room else None
    if kind is Columns or room < 2 or ((kind is tuple or kind is list) and 2 * len(value) > room + 1):
        return None
    open_, close, parts = _parts(value)
    blank = len(open_) > 1  # After a name.
    room -= len(open_) + len(close) - (not blank)
    texts = []
    for name, part in parts:
        room -= len(name) + 1
        inner: type = type(part)
        print_ = _printer(inner)
        found = _flat(part, room) if print_ is None else print_(part)
        if found is None or len(found) > room:
            return None
        texts.append(name + found)
        room -= len(found)
    if room < 0:
        return None
    return f"{open_}{' ' if blank and texts else ''}{' '.join(texts)}{close}"


def print_lines(value: Any) -> Iterator[str]:
    """The text form, a line at a time."""
    yield from _lines(value, "")


def print_ir(value: Any) -> str:
    """The text form of an IR value, ending in a newline."""
    return "\n".join(_lines(value, "")) + "\n"


# -- reading

DEPTH = 200
"""Brackets within brackets at most, in texts of strangers: no machine, setup, trace or stream has as many."""
TOKENS = 2_700_000
"""Words and brackets of one text at most, those of tables aside: some seconds of reading."""

_TOKEN = re.compile(r'(?:\s+|;[^\n]*)*+([()\[\]{}]|b?"(?:[^"\\]|\\.)*+"|[^\s()\[\]{};"]+|.|$)', re.DOTALL)
_TABLE_END = re.compile(r"[()\[\]{}\"]")
_COMMENT = re.compile(r";[^\n]*")
_BLOCK = 1 << 16
"""Characters that are taken apart at once, as far as the end of the line."""


def words_of(text: str) -> int:
    """As many words and brackets as ``TOKENS`` bounds, or more: those of tables are counted too."""
    return sum(1 for _ in _TOKEN.finditer(text))


class _Reader:
    """A recursive reader; ``tokens`` are those that are still to come."""

    def __init__(self, text: str, tokens: int, deepest: int) -> None:
        self.text = text
        self.deepest = deepest
        self.left = tokens
        self.depth = 0
        self.end = 0
        one_by_one = "(columns" in text  # Of a table the numbers are no words: its place in the text is needed.
        words = self._one_by_one() if one_by_one else itertools.chain.from_iterable(self._blocks())
        self.tokens = filter(None, words)

    def _blocks(self) -> Iterator[list[str]]:
        """All words, cut apart where lines end: no word of a right text is longer than its line."""
        text = self.text
        while self.end < len(text):
            begin, line = self.end, text.find("\n", self.end + _BLOCK)
            self.end = len(text) if line < 0 else line
            if self.end - begin > self.left:
                self._spend(sum(1 for _ in itertools.islice(_TOKEN.finditer(text, begin, self.end), self.left + 1)), 0)
            words = _TOKEN.findall(text, begin, self.end)
            self._spend(len(words) - words.count(""))
            yield words

    def _one_by_one(self) -> Iterator[str]:
        """Each word from ``end`` on, which is after the last one."""
        match, text = _TOKEN.match, self.text
        while self.end < len(text):
            found = match(text, self.end)
            assert found is not None
            self.end = found.end()
            self._spend(bool(found[1]))
            yield found[1]

    def _spend(self, words: int, price: int = 1) -> None:
        if words > self.left:
            raise ValueError(f"text form: more than {TOKENS} words")
        self.left -= words * price

    def take(self) -> str:
        """The next token."""
        token = next(self.tokens, None)
        if token is None:
            raise ValueError("text form: ends too early")
        return token

    def whole(self) -> Any:
        """The one value of the text."""
        value = self.value(self.take())
        if next(self.tokens, None) is not None:
            raise ValueError("text form: text after the end")
        return value

    def value(self, token: str) -> Any:
        """The value that starts with a token."""
        if token not in _OPENING:
            return _read_atom(token)
        if self.depth == self.deepest:
            raise ValueError(f"text form: nested more than {self.deepest} deep")
        self.depth += 1
        value: Any
        if token == "(":
            name = self.take()
            value = self.columns() if name == "columns" else self.object(name)
        elif token == "[":
            value = tuple(self.until("]"))
        else:
            flat = self.until("}")
            value = dict(zip(flat[::2], flat[1::2], strict=True))
            if 2 * len(value) != len(flat):
                raise ValueError("text form: a key is given twice")
        self.depth -= 1
        return value

    def until(self, close: str) -> list[Any]:
        out: list[Any] = []
        for token in self.tokens:
            if token == close:
                return out
            out.append(self.value(token) if token in _OPENING else _read_atom(token))
        raise ValueError("text form: ends too early")

    def object(self, name: str) -> Any:
        if name == "LanguageRules":
            from gproof.ir.dialects import rules_named

            (dialect,) = self.until(")")
            return rules_named(dialect)
        cls = types().classes.get(name)
        if cls is None:
            raise _no_such("type", name)
        known = _read_fields(cls)
        values: dict[str, Any] = {}
        for word in self.tokens:
            if word == ")":
                return cls(**values)
            field = known.get(word)
            if field is None:
                raise _no_such("field", f"{name}.{word[:-1]}" if word.endswith(":") else word)
            key, is_list = field
            if key in values:
                raise ValueError(f"text form: {name}.{key} is given twice")
            value = self.value(self.take())
            # Lists and tuples share brackets in the text: the field's type tells which one it was.
            values[key] = list(value) if is_list and isinstance(value, tuple) else value
        raise ValueError("text form: ends too early")

    def columns(self) -> Columns:
        """A table; its values are read at once, not word by word."""
        name = self.take()
        schema, rows = types().schemas.get(name), int(self.take())
        if schema is None:
            raise _no_such("table", name)
        if rows == 0:
            if self.take() != ")":
                raise ValueError("text form: a table has more values than rows")
            return Columns(schema)
        width = sum(c.width for c in schema.columns)
        close = _TABLE_END.search(self.text, self.end)
        if close is None:
            raise ValueError("text form: ends too early")
        body = self.text[self.end : close.start()]
        if not 0 <= rows <= len(body):
            raise ValueError("text form: a table has less values than rows")
        body = _COMMENT.sub("", body)
        if all(c.dtype.startswith("f") for c in schema.columns):
            flat = _floats(body, rows * width)
            cells = flat.reshape(rows, width)
        else:
            if len(body) > _TABLE_CHARACTERS:
                raise ValueError("text form: a table is too long")
            words = body.split()
            if len(words) != rows * width:
                raise ValueError("text form: a table has not as many values as its rows need")
            cells = np.array(words, dtype=object).reshape(rows, width)
        self.end = close.start()
        if self.take() != ")":
            raise ValueError("text form: a table has more values than rows")
        arrays, at = {}, 0
        for c in schema.columns:
            kind: Any = float if c.dtype.startswith("f") else int
            part = cells[:, at : at + c.width]
            if part.dtype == object:
                part = np.array([[kind(v) for v in row] for row in part]).reshape(rows, c.width)
            part = part.astype(c.dtype)
            arrays[c.name] = part if c.width > 1 else part[:, 0]
            at += c.width
        return Columns(schema, arrays)


_OPENING = frozenset("([{")
_TABLE_CHARACTERS = 1 << 22
"""Of a table of whole numbers in a text: those of packages are empty there."""


def _floats(text: str, count: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    """So many decimal numbers with blanks between; ValueError."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            flat = np.fromstring(text, dtype=np.float64, sep=" ")
        except DeprecationWarning as error:
            raise ValueError(f"text form: {error}") from None
    if not text.strip():
        flat = flat[:0]
    if len(flat) != count:
        raise ValueError("text form: a table has not as many values as its rows need")
    return flat


@functools.cache
def _read_fields(cls: type) -> dict[str, tuple[str, bool]]:
    """By the word in front of it each field, and whether it is a list."""
    hints = _hints(cls)
    return {f"{name}:": (name, typing.get_origin(hints[name]) is list) for name, _ in printed_fields(cls)}


@functools.cache
def _hints(cls: type) -> dict[str, Any]:
    # Some modules import a type for its name alone.
    return typing.get_type_hints(cls, localns=dict(types().classes))


_NAMED = {
    "none": None, "true": True, "false": False, "inf": float("inf"), "-inf": float("-inf"), "nan": float("nan"),
}  # fmt: skip
_WHOLE = re.compile(r"-?[0-9]{1,640}", re.ASCII)
_RATIONAL = re.compile(r"-?[0-9]{1,640}/[0-9]{1,640}", re.ASCII)
_REAL = re.compile(r"-?[0-9]{1,400}(?:\.[0-9]{0,400})?(?:e[-+]?[0-9]{1,4})?", re.ASCII)
_MEMBER = re.compile(r"[A-Z]\w*\.\w+", re.ASCII)
_NAMES = {
    "type": re.compile(r"[A-Z]\w*", re.ASCII), "field": re.compile(r"[A-Z]\w*\.[a-z]\w*", re.ASCII),
    "table": re.compile(r"[a-z]\w*", re.ASCII), "value": _MEMBER,
}  # fmt: skip


def _no_such(kind: str, name: str) -> ValueError:
    """The error for a name that is none here, or that none can have."""
    if _NAMES[kind].fullmatch(name):
        return NotKnown(f"{name[:80]}: no such {kind}")
    return ValueError(f"text form: {name[:40]!r} is not a name of a {kind}")


@functools.lru_cache(1024)
def _read_atom(token: str) -> Any:
    if not token:
        raise ValueError("text form: ends too early")
    if _WHOLE.fullmatch(token):
        return int(token)
    if token in _NAMED:
        return _NAMED[token]
    if token[0] == '"':
        return json.loads(token)
    if token.startswith('b"'):
        return json.loads(token[1:]).encode("utf-8", "surrogateescape")
    if _REAL.fullmatch(token):
        return float(token)
    if _RATIONAL.fullmatch(token):
        return Fraction(token)
    if not _MEMBER.fullmatch(token):
        raise ValueError(f"text form: {token[:40]!r} is not a value")
    head, _, member = token.partition(".")
    found = types().enums.get(head)
    if found is None or member not in found.__members__:
        raise _no_such("value", token)
    return found[member]


def parse_ir(text: str) -> Any:
    """The value that ``print_ir`` printed; ValueError when the text is not of that form.

    No longer than TOKENS, nested no deeper than Python's stack.
    """
    return next(parse_texts([text], deepest=sys.maxsize))


def parse_texts(texts: Iterable[str], *, deepest: int = DEPTH) -> Iterator[Any]:
    """The value of each text, as ``parse_ir``; all together are no longer than TOKENS, none nested deeper.

    NotKnown for a text with names that are none here.
    """
    left = TOKENS
    for text in texts:
        try:
            reader = _Reader(text, left, deepest)
            value = reader.whole()
        except (KeyError, TypeError, ArithmeticError, RecursionError, json.JSONDecodeError) as error:
            raise ValueError(f"text form: {error}") from None
        left = reader.left
        yield value
