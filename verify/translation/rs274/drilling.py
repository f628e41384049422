"""Drilling cycles of LinuxCNC as moves (user manual, G-Codes G80 to G89, G98 G99)."""

from __future__ import annotations

import math
from typing import Any, Protocol

import numpy as np

from gproof.ir.record import field, record
from gproof.ir.trace import Op
from gproof.verify.translation.rs274.language import Unread
from gproof.verify.translation.rs274.moves import Manner
from gproof.verify.translation.rs274.offsets import Place, Zeros
from gproof.verify.translation.rs274.words import Words

SAME = 1e-9
"""mm that two heights differ by rounding."""


@record(slots=True)
class Series:
    """Successive holes. code: of the cycle; kept: its words; height: work height where the first hole started."""

    code: int = 0
    kept: dict[str, float] = field(default_factory=dict)
    height: float = math.nan


class Driller(Protocol):
    """What a hole needs of the controller that drills it."""

    motion: int | None
    plane: int | None
    per: int | None
    initial: bool | None
    zeros: Zeros
    series: Series
    first_hole: bool
    direction: int

    def manner(self) -> Manner:
        """How numbers are meant."""

    def here(self, axis: int) -> Place:
        """Where an axis is."""

    def straight_moves(self, codes: list[int], tables: list[Any], line: int) -> None:
        """Moves of one line."""

    def event(self, op: Op, line: int, first: float = 0.0) -> None:
        """Something between moves."""

    def turn(self, direction: int, line: int) -> None:
        """The spindle starts or stops."""


def drill(now: Driller, words: Words, line: int) -> None:
    """One hole."""
    code = now.motion or 0
    manner = now.manner()
    if not manner.absolute or now.plane != 17 or now.per != 94 or now.initial is None:
        raise Unread("a cycle that is not in G17, G90 and G94, or before G98 or G99")
    zero = now.zeros.zero(2)
    at = now.here(2)
    if at.form != zero.form:
        raise Unread("a cycle from a height that is unknown")
    height = at.value - zero.value
    series = now.series
    if series.code == 0 or now.first_hole:
        series.height = height
    if series.code != code or now.first_hole:
        series.code, series.kept = code, {}
    now.first_hole = False
    for letter in "ZRP":
        value = words.take(letter)
        if value is not None:
            series.kept[letter] = value
    wanted = "ZRP" if code in (820, 860) else "ZR"
    if any(letter not in series.kept for letter in wanted) or set(series.kept) - set(wanted):
        raise Unread(f"the words of G{code // 10}")
    top, bottom = (series.kept[letter] * manner.unit for letter in "RZ")
    if bottom > top:
        raise Unread("a hole whose bottom is above its top")
    clear = max(top, series.height) if now.initial else top

    codes: list[int] = []
    tables: list[Any] = []

    def along(code: int, target: float) -> None:
        table = np.full(9, math.nan)
        table[2] = target / manner.unit
        codes.append(code)
        tables.append(table)

    def go() -> None:
        """What was gathered; before something else happens."""
        if codes:
            now.straight_moves(codes, tables, line)
        codes.clear()
        tables.clear()

    if height < top - SAME:
        along(0, top)
        height = top
    table = np.full(9, math.nan)
    for column, letter in enumerate("XY"):
        value = words.take(letter)
        if value is not None:
            table[column] = value
    if not np.isnan(table).all():
        codes.append(0)
        tables.append(table)
    if height > top + SAME:
        along(0, top)
    along(1, bottom)
    if "P" in wanted:
        go()
        now.event(Op.DWELL, line, series.kept["P"])
    turning = now.direction
    if code == 860:
        if not turning:
            raise Unread("G86 with a spindle that does not turn")
        go()
        now.turn(0, line)
    along(0, clear)
    go()
    if code == 860:
        now.turn(turning, line)
