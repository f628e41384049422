"""Columns: a table of numpy arrays with a fixed schema, for anything with a row per line, move or step."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from gproof.ir.record import record

Array = npt.NDArray[Any]


@record(frozen=True, slots=True)
class Column:
    """One column: name, numpy dtype string such as ``f8``, width (1: a vector, n: n values a row)."""

    name: str
    dtype: str
    width: int = 1


class Schema:
    """An ordered set of columns with a name of its own."""

    def __init__(self, name: str, *columns: Column) -> None:
        self.name = name
        self.columns = columns
        self.by_name = {column.name: column for column in columns}

    def empty(self, rows: int) -> dict[str, Array]:
        """Uninitialised arrays for ``rows`` rows."""
        return {
            c.name: np.zeros((rows, c.width) if c.width > 1 else rows, dtype=np.dtype(c.dtype)) for c in self.columns
        }


class Columns:
    """A table: ``table["to"]`` is the array of that column.

    Arrays are used as they are, not copied; equality is exact, NaN equal to NaN.
    """

    __slots__ = ("arrays", "schema")

    def __init__(self, schema: Schema, arrays: Mapping[str, Array] | None = None) -> None:
        self.schema = schema
        self.arrays: dict[str, Array] = dict(schema.empty(0) if arrays is None else arrays)
        self.verify()

    def __len__(self) -> int:
        return len(self.arrays[self.schema.columns[0].name])

    def __getitem__(self, name: str) -> Array:
        return self.arrays[name]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Columns) or other.schema is not self.schema or len(self) != len(other):
            return False
        return all(np.array_equal(a, other.arrays[n], equal_nan=a.dtype.kind == "f") for n, a in self.arrays.items())

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"Columns({self.schema.name}, {len(self)} rows)"

    def slice(self, start: int, stop: int) -> Columns:
        """Rows start..stop as views."""
        part = object.__new__(Columns)
        # Of a table that fits its schema, rows fit it too: there are many such parts in a job of many sections.
        part.schema, part.arrays = self.schema, {n: a[start:stop] for n, a in self.arrays.items()}
        return part

    def rows(self) -> Iterator[tuple[Any, ...]]:
        """Each row as plain Python values, in schema order."""
        yield from zip(*(self.arrays[c.name].tolist() for c in self.schema.columns), strict=True)

    def verify(self) -> None:
        """Shapes and dtypes are those of the schema; ValueError otherwise."""
        if set(self.arrays) != set(self.schema.by_name):
            raise ValueError(f"{self.schema.name}: columns {sorted(self.arrays)} are not those of the schema")
        rows = len(self)
        for c in self.schema.columns:
            a = self.arrays[c.name]
            shape = (rows, c.width) if c.width > 1 else (rows,)
            if a.shape != shape or a.dtype != np.dtype(c.dtype):
                raise ValueError(f"{self.schema.name}.{c.name}: {a.dtype}{a.shape}, expected {c.dtype}{shape}")


def concatenate(schema: Schema, parts: list[Columns]) -> Columns:
    """All parts below one another, copied."""
    if not parts:
        return Columns(schema)
    return Columns(schema, {c.name: np.concatenate([p[c.name] for p in parts]) for c in schema.columns})


ENOUGH = 1 << 16
"""Rows that are worth a look at once."""


def batches(rows: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Tables of so many rows, in groups of neighbours ``begin..end`` that have about ``ENOUGH`` rows together.

    A table of many rows is a group of its own, so that what is copied to be looked at together stays small.
    """
    begin = total = 0
    for place, count in enumerate(rows):
        if place > begin and total + count > ENOUGH:
            yield begin, place
            begin, total = place, 0
        total += count + 1
    if begin < len(rows):
        yield begin, len(rows)


def joined(schema: Schema, parts: list[Columns]) -> Columns:
    """All parts below one another; a single one as it is."""
    return parts[0] if len(parts) == 1 else concatenate(schema, parts)


def occurring(indexes: Array) -> list[int]:
    """Which of the numbers 0, 1, … a column of indexes holds, in order.

    Counting is faster than ``np.unique``, which sorts, and for which numpy imports its masked arrays.
    """
    numbers: list[int] = np.flatnonzero(np.bincount(indexes)).tolist()
    return numbers
