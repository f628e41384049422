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
import typing
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any

import numpy as np

from gproof.ir.columns import Columns, Schema

WIDTH = 100


@functools.cache
def _registry() -> tuple[dict[str, type], dict[str, type[enum.Enum]], dict[str, Schema]]:
    """Dataclasses, enumerations and schemas of the IR modules, by name."""
    from gproof.ir import (
        controls,
        din,
        finding,
        machine,
        notes,
        plan,
        program,
        rules,
        setup,
        stream,
        trace,
        verdict,
        workpiece,
    )  # fmt: skip

    classes: dict[str, type] = {}
    enums: dict[str, type[enum.Enum]] = {}
    schemas: dict[str, Schema] = {}
    modules = (controls, din, finding, machine, notes, plan, program, rules, setup, stream, trace, verdict, workpiece)
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


_TOKEN = re.compile(r'\s+|;[^\n]*|([()\[\]{}])|(b?"(?:[^"\\]|\\.)*")|([^\s()\[\]{};"]+)')


def _tokens(text: str) -> Iterator[str]:
    at = 0
    while at < len(text):
        m = _TOKEN.match(text, at)
        if m is None:
            raise ValueError(f"text form: unreadable at offset {at}")
        at = m.end()
        if m.lastindex:
            yield m.group(m.lastindex)


class _Reader:
    def __init__(self, text: str) -> None:
        self.tokens = _tokens(text)
        self.token: str | None = next(self.tokens, None)

    def take(self) -> str:
        token = self.token
        if token is None:
            raise ValueError("text form: ends too early")
        self.token = next(self.tokens, None)
        return token

    def value(self) -> Any:
        token = self.take()
        if token == "(":
            name = self.take()
            return self.columns() if name == "columns" else self.object(name)
        if token == "[":
            return tuple(self.until("]"))
        if token == "{":
            flat = self.until("}")
            return dict(zip(flat[::2], flat[1::2], strict=True))
        return _read_atom(token)

    def until(self, close: str) -> list[Any]:
        out = []
        while self.token != close:
            out.append(self.value())
        self.take()
        return out

    def object(self, name: str) -> Any:
        classes, _, _ = _registry()
        values = self.until(")")
        if name == "LanguageRules":
            from gproof.ir.dialects import rules_named

            return rules_named(values[0])
        cls = classes.get(name)
        if cls is None:
            raise ValueError(f"text form: unknown type {name!r}")
        names = _fields(cls)
        if len(values) != len(names):
            raise ValueError(f"text form: {name} has {len(names)} fields, {len(values)} given")
        hints = _hints(cls)
        return cls(**{f.name: _as_field(v, hints[f.name]) for f, v in zip(names, values, strict=True)})

    def columns(self) -> Columns:
        _, _, schemas = _registry()
        schema, rows = schemas[self.take()], int(self.take())
        width = sum(c.width for c in schema.columns)
        flat = [self.take() for _ in range(rows * width)]
        if self.take() != ")":
            raise ValueError("text form: a table has more values than rows")
        arrays, at = {}, 0
        for c in schema.columns:
            kind: Any = float if c.dtype.startswith("f") else int
            part = np.array(
                [[kind(flat[r * width + at + k]) for k in range(c.width)] for r in range(rows)], dtype=c.dtype
            ).reshape(rows, c.width)
            arrays[c.name] = part if c.width > 1 else part[:, 0]
            at += c.width
        return Columns(schema, arrays)


@functools.cache
def _hints(cls: type) -> dict[str, Any]:
    return typing.get_type_hints(cls)


def _as_field(value: Any, hint: Any) -> Any:
    """Lists and tuples share brackets in the text: the field's type tells which one it was."""
    if isinstance(value, tuple) and typing.get_origin(hint) is list:
        return list(value)
    return value


def _read_atom(token: str) -> Any:
    if token[0] == '"':
        return json.loads(token)
    if token.startswith('b"'):
        return json.loads(token[1:]).encode("utf-8", "surrogateescape")
    named = {"none": None, "true": True, "false": False}
    if token in named:
        return named[token]
    if token in ("inf", "-inf", "nan"):
        return float(token)
    head, dot, member = token.partition(".")
    if dot and head and head[0].isalpha():
        return _registry()[1][head][member]
    if "/" in token:
        return Fraction(token)
    return float(token) if any(c in token for c in ".en") else int(token)


def parse_ir(text: str) -> Any:
    """The value that ``print_ir`` printed; ValueError when the text is not of that form."""
    reader = _Reader(text)
    try:
        value = reader.value()
    except (KeyError, TypeError, ArithmeticError, RecursionError, json.JSONDecodeError) as error:
        raise ValueError(f"text form: {error}") from None
    if reader.token is not None:
        raise ValueError("text form: text after the end")
    return value
