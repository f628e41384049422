"""Lines of a job for McuWIN: line numbers (14 (2.5.3.24)), reflections (3.9 to 3.13)."""

from __future__ import annotations

from collections.abc import Mapping

from gproof.backend.emit.job_numbers import text_of
from gproof.backend.emit.printer import Unprintable
from gproof.ir.job import SetFrame

REFLECT = {("x",): "G22", ("y",): "G21", ("x", "y"): "G23"}
DIGITS = 9
"""Decimals of a factor of G39."""


def numbered(text: bytes, newline: str) -> bytes:
    """Every line with words gets a number (14 (2.5.3.24))."""
    found, number, inside = [], 0, False
    end = newline.encode()
    for line in text.split(end):
        words = line.lstrip()
        inside = words.startswith(b"$DINEND") or (inside and not words.startswith(b"{$DINSTART}"))
        if words and not inside and words[:1] not in (b"%", b"'", b"{"):
            number += 10
            line = b"N%d " % number + words
        found.append(line)
    return end.join(found)


def reflection(
    node: SetFrame, now: dict[str, float] | None, letters: Mapping[str, str], *, foreign: bool
) -> tuple[dict[str, float], list[str]]:
    """(factors by axis after it, lines of G21 to G24 and G39); Unprintable.

    now: factors in force, None: not known. foreign: a program that was not for this controller, of which it is open
    about which zero its places are mirrored (3.9, 3.26).
    """
    if foreign:
        raise Unprintable("mirrored or scaled places, whose zero is open (3.9, 3.26)")
    if now is None:
        raise Unprintable("a reflection where it is not known what is reflected")
    is_mirror = node.action.startswith("mirror")
    if not node.action.endswith("_off"):
        new = dict.fromkeys((place.axis for place in node.places), -1.0) if is_mirror else _factors(node)
        return now | new, _switched_on(new, letters)
    kept = {axis: by for axis, by in now.items() if (by == -1.0) is not is_mirror}
    usual = ["G39"] if any(by != -1.0 for by in now.values()) else []
    return kept, ["G24", *usual, *_switched_on(kept, letters)]


def _factors(node: SetFrame) -> dict[str, float]:
    found = {place.axis: place.at.number for place in node.factors}
    if not found.keys() <= {"x", "y"} or None in found.values() or node.places:
        raise Unprintable("a scale of other axes than X and Y, or by computed factors")
    return {axis: by for axis, by in found.items() if by is not None}


def _switched_on(new: Mapping[str, float], letters: Mapping[str, str]) -> list[str]:
    """A factor of -1 is the usual one (3.13)."""
    words = [f"{letters[axis]}{text_of(by, DIGITS)}" for axis, by in sorted(new.items()) if by != -1.0]
    factors = [" ".join(["G39", *words])] if words else []
    return [*factors, REFLECT[tuple(sorted(new))]] if new else []
