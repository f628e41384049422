"""What a part of a package may say: its types with their fields and defaults, as lines of text."""

from __future__ import annotations

import dataclasses
import enum
import re
import typing
from collections.abc import Iterator
from typing import Any

from gproof.ir.columns import Schema
from gproof.ir.machine import Machine
from gproof.ir.settings import Settings
from gproof.ir.setup import Setup
from gproof.ir.stream import EVENT, RUN, StepStream
from gproof.ir.text import has_default, print_ir, printed_fields
from gproof.ir.text import types as known_types
from gproof.ir.trace import TRACE_ROW, Op, Trace
from gproof.ir.workpiece import TRIANGLES

ROOTS: dict[str, tuple[type, tuple[Schema, ...]]] = {
    "machine": (Machine, ()), "setup": (Setup, (TRIANGLES,)), "trace": (Trace, (TRACE_ROW,)),
    "stream": (StepStream, (RUN, EVENT)),
}  # fmt: skip
"""By part its type, and the tables that it has."""


def classes_of(root: type) -> set[type]:
    """Dataclasses and enumerations that a value of a type may hold."""
    found: set[type] = set()
    left: list[Any] = [root]
    while left:
        hint = left.pop()
        left += typing.get_args(hint)
        if not isinstance(hint, type) or hint in found:
            continue
        if dataclasses.is_dataclass(hint):
            found.add(hint)
            hints = typing.get_type_hints(hint)
            left += [hints[name] for name, _ in printed_fields(hint)]
            if hint is Settings:
                left += [cls for cls in known_types().classes.values() if issubclass(cls, Settings)]
        elif issubclass(hint, enum.Enum):
            found.add(hint)
    return found


def shape(part: str) -> list[str]:
    """A line for each field, member and table; sorted."""
    root, tables = ROOTS[part]
    return sorted([*_lines(classes_of(root)), *map(_table, tables), *(_numbers() if part == "trace" else ())])


def _lines(classes: set[type]) -> Iterator[str]:
    for cls in classes:
        if issubclass(cls, enum.Enum):
            yield from (f"{cls.__name__}.{name}" for name in cls.__members__)
            continue
        hints = typing.get_type_hints(cls)
        yield cls.__name__
        for name, default in printed_fields(cls):
            said = " ".join(print_ir(default).split()) if has_default(default) else "required"
            yield f"{cls.__name__}.{name}: {_said(hints[name])} = {said}"


def _said(hint: Any) -> str:
    """A type without the modules that its parts are from."""
    return hint.__name__ if type(hint) is type else re.sub(r"[\w.]+\.(\w+)", r"\1", str(hint))


def _table(schema: Schema) -> str:
    return f"table {schema.name}: " + ", ".join(f"{c.name} {c.dtype} x {c.width}" for c in schema.columns)


def _numbers() -> Iterator[str]:
    """Kinds of rows, which stand as numbers in tables."""
    return (f"Op.{op.name} = {op.value}" for op in Op)
