"""What both programs leave for the next job, fact by fact; what one of the controllers cannot have is not compared."""

from __future__ import annotations

from collections.abc import Mapping

from gproof.ir.end_state import EndState, Left
from gproof.ir.trace import Affine
from gproof.verify.translation.comparison import Comparison, Places, divergence
from gproof.verify.translation.sides import BLURRED, Side, is_own
from gproof.verify.translation.stretches import Stretch


def compare_ends(
    sides: tuple[Side, Side], stretches: tuple[Stretch, Stretch],
    ends: tuple[Mapping[int, EndState], Mapping[int, EndState]], result: Comparison,
) -> None:  # fmt: skip
    """Compare what two stretches that end their programs leave."""
    one, other = (ends[n].get(stretches[n].sections[-1]) for n in (0, 1))
    places = stretches[0].last_place, stretches[1].last_place
    if one is None or other is None:
        result.open(divergence("end state unknown", places))
        return
    left_out = sides[0].terms.left_out
    for sentence in (*one.assumed, *other.assumed):
        result.assume(sentence)
    if one.guards_off is not None and other.guards_off is not None and "guards" not in left_out:
        mine, theirs = (sides[0].terms.shared_guards(end.guards_off or ()) for end in (one, other))
        if mine != theirs:
            result.differs(divergence("end state", places, names=("guards", ", ".join(mine), ", ".join(theirs))))
    theirs_by_name = dict(other.modes)
    for name, text in one.modes:
        there = theirs_by_name.get(name, text)
        if there != text and name not in left_out:
            result.differs(divergence("end state", places, names=(name, text, there)))
    for fact in ("zero", "table", "length"):
        pair = getattr(one, fact), getattr(other, fact)
        if None not in pair and fact not in left_out:
            _places(fact, sides, pair, places, result)


def _places(fact: str, sides: tuple[Side, Side], pair: tuple[Left, Left], places: Places, result: Comparison) -> None:
    terms = sides[0].terms
    mine, theirs = (
        {name: (mm + sides[n].form(form)[0], sides[n].form(form)[1]) for name, mm, form in pair[n]} for n in (0, 1)
    )
    names = {*mine, *theirs} if fact != "zero" else mine.keys() & theirs.keys()
    for name in sorted(name for name in names - terms.scratch if name[-1] in terms.axes):
        a, b = mine.get(name), theirs.get(name)
        tolerance = terms.tolerance_mm if name[-1] in "xyz" else terms.tolerance_deg
        alike = a is not None and b is not None and a[1] == b[1] and not _is_blurred(a[1])
        if alike and a is not None and b is not None and abs(a[0] - b[0]) <= tolerance:
            continue
        said = tuple("left alone" if v is None else _said(v) for v in (a, b))
        found = divergence("offset left", places, names=(f"{fact} {name}", *said))
        is_open = any(v is not None and _is_open(v[1]) for v in (a, b))
        (result.open if is_open else result.differs)(found)


def _is_open(form: Affine) -> bool:
    """Whether a place rests on what only one side knows, or is nowhere."""
    return any(is_own(name) or name.split(".")[0] in BLURRED for name, _ in form)


def _is_blurred(form: Affine) -> bool:
    return any(name.split(".")[0] in BLURRED for name, _ in form)


def _said(value: tuple[float, Affine]) -> str:
    number = [f"{value[0]:g}"] if value[0] or not value[1] else []
    return " + ".join([*number, *(f"{n} {symbol}" if n != 1 else symbol for symbol, n in value[1])])
