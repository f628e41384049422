"""What both programs leave for the next job, fact by fact; what one of the controllers cannot have is not compared."""

from __future__ import annotations

import math
from collections.abc import Mapping

from gproof.ir.end_state import EndState
from gproof.ir.trace import Affine
from gproof.verify.translation.comparison import Comparison, Places, divergence
from gproof.verify.translation.sides import Side
from gproof.verify.translation.stretches import Stretch

Offsets = tuple[tuple[str, float, Affine], ...]


def compare_ends(
    sides: tuple[Side, Side], stretches: tuple[Stretch, Stretch],
    ends: tuple[Mapping[int, EndState], Mapping[int, EndState]], result: Comparison,
) -> None:  # fmt: skip
    """Compare what two stretches that end their programs leave."""
    found = [ends[n].get(stretches[n].sections[-1]) for n in (0, 1)]
    places = stretches[0].last_place, stretches[1].last_place
    one, other = found
    if one is None or other is None:
        if one is not other:
            result.open(divergence("end state unknown", places))
        return
    for name in ("work", "tool", "spindle", "coolant", "guards_off", "modes"):
        a, b = getattr(one, name), getattr(other, name)
        if a is None or b is None or name in sides[0].terms.left_out:
            continue
        if name == "tool":
            a = sides[0].tools.get(a, a)
        if repr(a) != repr(b):
            result.differs(divergence("end state", places, names=(name, str(a), str(b))))
    for name in ("offsets", "tool_offset"):
        pair = getattr(one, name), getattr(other, name)
        if None not in pair and name not in sides[0].terms.left_out:
            _offsets(name, sides, pair, places, result)


def _offsets(
    name: str, sides: tuple[Side, Side], pair: tuple[Offsets, Offsets], places: Places, result: Comparison
) -> None:
    terms = sides[0].terms
    mine, theirs = (
        {key: (mm + sides[n].form(form)[0], sides[n].form(form)[1]) for key, mm, form in pair[n]} for n in (0, 1)
    )
    for key in sorted({*mine, *theirs}):
        a, b = mine.get(key), theirs.get(key)
        tolerance = terms.tolerance_mm if key[-1] in "xyz" else terms.tolerance_deg
        if a is not None and b is not None and a[1] == b[1] and abs(a[0] - b[0]) <= tolerance:
            continue
        said = tuple("left alone" if v is None else _said(v) for v in (a, b))
        found = divergence("offset left", places, names=(key, *said))
        is_open = any(v is not None and (math.isnan(v[0]) or any(s.startswith("?") for s, _ in v[1])) for v in (a, b))
        (result.open if is_open else result.differs)(found)


def _said(value: tuple[float, Affine]) -> str:
    return " + ".join([f"{value[0]:g}", *(f"{n} {symbol}" if n != 1 else symbol for symbol, n in value[1])])
