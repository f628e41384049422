"""Words that only change times or how far the tool may be from its path, where their number is not known.

The path does not rest on them: what asks where the axes go is judged as ever, and the number goes on as NaN to what it
touches (times and streams: GP503 at the row). Numbers that the controller refuses stop the job at that line; that this
one is not one of them is an assumption of the report.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir.symbolic import Unknown, Value, bounds
from gproof.passes.interpret.core.parsed_line import named

if TYPE_CHECKING:
    from gproof.passes.interpret.core.parsed_line import Line
    from gproof.passes.interpret.core.run import Run


def number_or_open(run: Run, line: Line, letter: str, code: str, *, positive: bool = False) -> float | None:
    """The value of a word, None when the word is absent, NaN when it is not known; marks it used. See ``or_open``."""
    line.used.add(letter)
    value = line.values.get(letter)
    return None if value is None else or_open(run, value, f"{named(letter)} of {code}", positive=positive)


def or_open(run: Run, value: Value, name: str, *, positive: bool = False) -> float:
    """A number, NaN when it is not known. Below 0, ``positive``: 0 and below, the controller refuses it.

    Where each that it can be is refused the greatest of them comes back, for the caller to refuse.
    """
    if not isinstance(value, Unknown):
        return value
    if value.high < 0.0 or (positive and value.high <= 0.0):
        return value.high
    if value.low < 0.0 or (positive and value.low <= 0.0):
        ends = "above 0" if positive else "not negative"
        run.assumed[f"{name}, which depends on {value.cause}, is assumed {ends}"] = None
    return math.nan


def low_of(line: Line, letter: str) -> float:
    """The least that the value of a word can be; 0 where it is absent."""
    return bounds(line.values.get(letter, 0.0))[0]


def width_or_open(run: Run, line: Line, letter: str, code: str) -> float | None:
    """The same of how far the tool may be from its path: the most that it can be, infinite where that is not known.

    0 stands for no width at all, of which each check says what it takes it for: a range with it has no end here.
    """
    value = line.values.get(letter)
    if isinstance(value, Unknown) and value.low > 0.0:
        line.used.add(letter)
        return value.high
    number = number_or_open(run, line, letter, code)
    return math.inf if number is not None and math.isnan(number) else number
