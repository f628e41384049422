"""Text forms: any IR value as an S-expression that parses back bit for bit.

``(Name field field ...)`` is a dataclass in field order; ``[...]`` a tuple or list; ``{k v ...}`` a dict;
numbers print as Python's shortest exact form, rationals as ``n/d``, strings as JSON, enumerations as
``Enum.MEMBER``; bytes as ``b"..."``; ``none true false``. A column table is
``(columns schema rows (name values ...) ...)``.
``print_ir`` and ``parse_ir`` know the types of ``ir/``, nothing else.
"""

from __future__ import annotations

import dataclasses
import enum
import functools
import json
import re
import sys
import typing
import warnings
from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from typing import Any

import numpy as np

from gproof.ir.columns import Columns, Schema
from gproof.ir.text_of_machine import parts, read

WIDTH = 100


@functools.cache
def _registry() -> tuple[dict[str, type], dict[str, type[enum.Enum]], dict[str, Schema]]:
    """Dataclasses, enumerations and schemas of the IR modules, by name."""
    from gproof.ir import (
        drives,
        finding,
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
    )  # fmt: skip
    from gproof.ir.dialects import eding_settings, mcuwin_settings, wincnc_settings

    classes: dict[str, type] = {}
    enums: dict[str, type[enum.Enum]] = {}
    schemas: dict[str, Schema] = {}
    modules = (
        drives, eding_settings, finding, machine, mcuwin_settings, notes, plan, program, rules, settings, setup,
        statements, stream, trace, verdict, wincnc_settings, workpiece,
    )  # fmt: skip
    for module in modules:
        for name, value in vars(module).items():
            if isinstance(value, Schema):
                schemas[value.name] = value
            elif isinstance(value, type) and value.__module__ == module.__name__:
                if dataclasses.is_dataclass(value):
                    classes[name] = value
                elif issubclass(value, enum.Enum):
                    enums[name] = value
    return classes, enums, schemas


@functools.cache
def _fields(cls: type) -> tuple[dataclasses.Field[Any], ...]:
    return tuple(f for f in dataclasses.fields(cls) if f.compare)


_PLAIN: dict[type, Callable[[Any], str]] = {float: repr, int: str, str: json.dumps}
"""How values of exactly these types print: most of what has no parts."""


def _atom(value: Any) -> str | None:
    """The text of a value that has no parts, or None."""
    printed = _PLAIN.get(type(value))
    if printed is not None:
        return printed(value)
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, enum.Enum):
        return f"{type(value).__name__}.{value.name}"
    if isinstance(value, float | np.floating):
        return repr(float(value))
    if isinstance(value, int | np.integer):
        return str(int(value))
    if isinstance(value, Fraction):
        return f"{value.numerator}/{value.denominator}"
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, bytes):
        return "b" + json.dumps(value.decode("utf-8", "surrogateescape"))
    return None


def _columns(table: Columns, indent: str) -> Iterator[str]:
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
    yield f"{indent}(columns {table.schema.name} {len(table)}"
    yield f"{indent}  ; " + " ".join(h.rjust(w) for h, w in zip(heads, widths, strict=True))
    for row in zip(*cells, strict=True):
        yield f"{indent}    " + " ".join(v.rjust(w) for v, w in zip(row, widths, strict=True))
    yield f"{indent})"


def _lines(value: Any, indent: str) -> Iterator[str]:
    atom = _atom(value)
    if atom is not None:
        yield indent + atom
        return
    if isinstance(value, Columns):
        yield from _columns(value, indent)
        return
    if type(value).__name__ == "LanguageRules":
        yield f"{indent}(LanguageRules {json.dumps(value.name)})"
        return
    open_, close, parts = _parts(value)
    flat = _flat(value)
    if flat is not None and len(indent) + len(flat) <= WIDTH:
        yield indent + flat
        return
    yield indent + open_
    for part in parts:
        yield from _lines(part, indent + "  ")
    yield indent + close


def _parts(value: Any) -> tuple[str, str, list[Any]]:
    value = value.made() if type(value).__name__ == "DeferredBlock" else value
    named = parts(value)
    if named is not None:
        return f"({named.name}", ")", named.parts
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return f"({type(value).__name__}", ")", [getattr(value, f.name) for f in _fields(type(value))]
    if isinstance(value, dict):
        return "{", "}", [x for pair in value.items() for x in pair]
    if isinstance(value, list | tuple):
        return "[", "]", list(value)
    raise TypeError(f"no text form for {type(value).__name__}")


def _flat(value: Any) -> str | None:
    """The one-line form, or None when it has a table inside or is long."""
    atom = _atom(value)
    if atom is not None:
        return atom
    if isinstance(value, Columns):
        return None
    if type(value).__name__ == "LanguageRules":
        return f"(LanguageRules {json.dumps(value.name)})"
    open_, close, parts = _parts(value)
    if len(parts) > WIDTH // 2:
        return None
    texts = []
    for part in parts:
        text = _flat(part)
        if text is None or len(text) > WIDTH:
            return None
        texts.append(text)
    body = " ".join(texts)
    if open_.startswith("("):
        return f"{open_} {body})" if body else f"{open_})"
    return f"{open_}{body}{close}"


def print_lines(value: Any) -> Iterator[str]:
    """The text form, a line at a time."""
    yield from _lines(value, "")


def print_ir(value: Any) -> str:
    """The text form of an IR value, ending in a newline."""
    return "\n".join(_lines(value, "")) + "\n"


DEPTH = 200
"""Brackets within brackets at most, in texts of strangers: no machine, setup, trace or stream has as many."""
TOKENS = 2_000_000
"""Words and brackets of one text at most, those of tables aside: some seconds of reading."""

_TOKEN = re.compile(r'(?:\s+|;[^\n]*)*+([()\[\]{}]|b?"(?:[^"\\]|\\.)*+"|[^\s()\[\]{};"]+|.|$)', re.DOTALL)
_TABLE_END = re.compile(r"[()\[\]{}\"]")
_COMMENT = re.compile(r";[^\n]*")


def words_of(text: str) -> int:
    """As many words and brackets as ``TOKENS`` bounds, or more: those of tables are counted too."""
    return sum(1 for _ in _TOKEN.finditer(text))


class _Reader:
    """A recursive reader; ``token`` is the next one, "" at the end of the text."""

    def __init__(self, text: str, tokens: int, deepest: int) -> None:
        self.text = text
        self.deepest = deepest
        self.end = 0
        self.left = tokens
        self.depth = 0
        self.token = ""
        self.next()

    def next(self) -> None:
        """Go on to the next token."""
        found = _TOKEN.match(self.text, self.end)
        assert found is not None
        self.end = found.end()
        self.token = found[1]
        self.left -= 1
        if self.left < 0:
            raise ValueError(f"text form: more than {TOKENS} words")

    def take(self) -> str:
        token = self.token
        if not token:
            raise ValueError("text form: ends too early")
        self.next()
        return token

    def value(self) -> Any:
        token = self.token
        if token not in _OPENING:
            return _read_atom(self.take())
        if self.depth == self.deepest:
            raise ValueError(f"text form: nested more than {self.deepest} deep")
        self.depth += 1
        self.next()
        value: Any
        if token == "(":
            name = self.take()
            value = self.columns() if name == "columns" else self.object(name)
        elif token == "[":
            value = tuple(self.until("]"))
        else:
            flat = self.until("}")
            value = dict(zip(flat[::2], flat[1::2], strict=True))
        self.depth -= 1
        return value

    def until(self, close: str) -> list[Any]:
        out = []
        match, text = _TOKEN.match, self.text
        while self.token != close:
            if self.token in _OPENING:
                out.append(self.value())
                continue
            out.append(_read_atom(self.token))
            found = match(text, self.end)  # As ``next`` does: most words of a text are read here.
            assert found is not None
            self.end, self.token, self.left = found.end(), found[1], self.left - 1
            if self.left < 0:
                raise ValueError(f"text form: more than {TOKENS} words")
        self.next()
        return out

    def object(self, name: str) -> Any:
        classes, _, _ = _registry()
        values = self.until(")")
        if name == "LanguageRules":
            from gproof.ir.dialects import rules_named

            return rules_named(values[0])
        whole = read(name, values)
        if whole is not None:
            return whole
        cls = classes.get(name)
        if cls is None:
            raise ValueError(f"text form: unknown type {name!r}")
        names = _field_hints(cls)
        if len(values) != len(names):
            raise ValueError(f"text form: {name} has {len(names)} fields, {len(values)} given")
        # Lists and tuples share brackets in the text: the field's type tells which one it was.
        return cls(
            **{
                name: list(value) if is_list and isinstance(value, tuple) else value
                for (name, is_list), value in zip(names, values, strict=True)
            }
        )

    def columns(self) -> Columns:
        """A table; its values are read at once, not word by word."""
        _, _, schemas = _registry()
        schema, rows = schemas[self.take()], int(self.token)
        if rows == 0:  # As all tables of a package are.
            self.next()
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
        self.next()
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
def _field_hints(cls: type) -> tuple[tuple[str, bool], ...]:
    """Names of the fields that are printed, and whether each is a list."""
    hints = _hints(cls)
    return tuple((f.name, typing.get_origin(hints[f.name]) is list) for f in _fields(cls))


@functools.cache
def _hints(cls: type) -> dict[str, Any]:
    return typing.get_type_hints(cls)


_NAMED = {
    "none": None, "true": True, "false": False, "inf": float("inf"), "-inf": float("-inf"), "nan": float("nan"),
}  # fmt: skip
_WHOLE = re.compile(r"-?[0-9]{1,640}", re.ASCII)
_RATIONAL = re.compile(r"-?[0-9]{1,640}/[0-9]{1,640}", re.ASCII)
_REAL = re.compile(r"-?[0-9]{1,400}(?:\.[0-9]{0,400})?(?:e[-+]?[0-9]{1,4})?", re.ASCII)


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
    head, _, member = token.partition(".")
    found = _registry()[1].get(head)
    if found is None or not member:
        raise ValueError(f"text form: {token[:40]!r} is no value")
    return found[member]


def parse_ir(text: str) -> Any:
    """The value that ``print_ir`` printed; ValueError when the text is not of that form.

    No longer than TOKENS, nested no deeper than Python's stack.
    """
    return next(parse_texts([text], deepest=sys.maxsize))


def parse_texts(texts: Iterable[str], *, deepest: int = DEPTH) -> Iterator[Any]:
    """The value of each text, as ``parse_ir``; all together are no longer than TOKENS, none nested deeper."""
    left = TOKENS
    for text in texts:
        try:
            reader = _Reader(text, left, deepest)
            value = reader.value()
        except (KeyError, TypeError, ArithmeticError, RecursionError, json.JSONDecodeError) as error:
            raise ValueError(f"text form: {error}") from None
        if reader.token:
            raise ValueError("text form: text after the end")
        left = reader.left
        yield value
