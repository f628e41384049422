"""Kinds of wrong translation in the moves of a target: places, arcs, feeds, cycles, units, distances.

A kind gives the wrong texts that a target has room for. It leaves out what its rule says changes nothing, by the
manuals: where a move ends that only cuts a longer one, a word that repeats what is in force, what has no length.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator

from translation.target_text import AXES, MILLING, Line, Text

Kind = Callable[[Text], Iterator[str]]
KINDS: dict[str, Kind] = {}


def kind(function: Kind) -> Kind:
    """A kind by its name."""
    KINDS[function.__name__.replace("_", "-")] = function
    return function


def _ends(t: Text) -> Iterator[tuple[int, Line]]:
    """Moves and holes whose end changes what happens."""
    return ((n, line) for n, line in t.each("move", "cycle", "machine") if not t.is_cut(n))


def numbers(t: Text, letters: str, change: Callable[[float], float]) -> Iterator[str]:
    """Each number of some words anew, one at a time."""
    for n, line in _ends(t):
        for letter in letters:
            if letter in line.words and abs(change(line.words[letter]) - line.words[letter]) > 1e-9:
                yield t.word(n, letter, change(line.words[letter]))


@kind
def sign_of_a_coordinate(t: Text) -> Iterator[str]:
    return numbers(t, AXES, lambda v: -v)


@kind
def millimetres_as_inches(t: Text) -> Iterator[str]:
    return numbers(t, AXES, lambda v: v * 25.4)


@kind
def inches_as_millimetres(t: Text) -> Iterator[str]:
    return numbers(t, AXES, lambda v: v / 25.4)


@kind
def centimetres_as_millimetres(t: Text) -> Iterator[str]:
    return numbers(t, AXES, lambda v: v / 10)


@kind
def decimals_that_are_lost(t: Text) -> Iterator[str]:
    return numbers(t, AXES, math.trunc)


@kind
def a_digit_that_is_wrong(t: Text) -> Iterator[str]:
    return numbers(t, AXES, lambda v: v + 0.001)


@kind
def a_digit_of_an_arc_that_is_wrong(t: Text) -> Iterator[str]:
    return numbers(t, "IJK", lambda v: v + 0.001)


@kind
def axes_that_are_exchanged(t: Text) -> Iterator[str]:
    for n, line in _ends(t):
        if line.words.get("X") != line.words.get("Y"):
            yield t.replaced(n, re.sub("[XY]", lambda m: "Y" if m[0] == "X" else "X", line.raw))


@kind
def an_axis_for_another_one(t: Text) -> Iterator[str]:
    for n, line in _ends(t):
        if "X" in line.words and "Z" not in line.words and line.kind == "move" and line.moves:
            yield t.word(n, "X", line.words["X"], "Z")


@kind
def a_coordinate_that_is_lost(t: Text) -> Iterator[str]:
    for n, line in _ends(t):
        for axis in line.axes if line.kind == "move" and line.motion in (0, 1) else "":
            was, now = line.before[axis], line.after[axis]
            if was is not None and now is not None and was != now:
                yield t.word(n, axis, None)


@kind
def a_coordinate_in_addition(t: Text) -> Iterator[str]:
    for n, line in _ends(t):
        for axis in AXES:
            if axis not in line.words and line.kind == "move" and line.motion in (0, 1):
                yield t.replaced(n, _plus(t, line, f" {axis}91"))


def _plus(t: Text, line: Line, word: str) -> str:
    """A line with a word more, before its comment."""
    end = len(line.code.rstrip())
    return line.raw[:end] + word + line.raw[end:]


@kind
def a_move_that_is_lost(t: Text) -> Iterator[str]:
    for n, line in t.each("move"):
        if line.moves and not t.is_cut(n) and not _on_the_way(t, n) and line.motion in (0, 1):
            yield t.replaced(n)


def _on_the_way(t: Text, n: int) -> bool:
    """Whether the way to the place of the next line may be the same without a rapid."""
    after = t.next_move(n)
    return after is not None and after.kind != "move" and t.lines[n].motion == 0


@kind
def a_move_that_is_doubled(t: Text) -> Iterator[str]:
    for n, line in t.each("move", "cycle"):
        once = line.kind == "move" and line.motion in (0, 1) and not line.relative
        if not once and line.moves is not False:
            yield t.before(n, line.raw)


@kind
def moves_in_the_other_order(t: Text) -> Iterator[str]:
    for n, line in t.each("move"):
        after = t.lines[n + 1] if n + 1 < len(t.lines) else None
        if after is None or after.kind != "move" or t.is_cut(n) or not line.moves or not after.moves:
            continue
        if line.motion in (0, 1) and after.motion in (0, 1) and not (line.relative or after.relative):
            yield t.exchanged(n)


@kind
def a_detour(t: Text) -> Iterator[str]:
    for n, _ in t.each("move"):
        yield t.before(n, "G00 X91" if t.dialect == "mcuwin" else "G0 X91")


@kind
def a_cut_that_is_rapid(t: Text) -> Iterator[str]:
    for n, line in t.each("move"):
        if line.motion == 1 and line.moves:
            yield from t.substituted(n, r"(?<![A-Z0-9.])G(0?)1(?![0-9.])", r"G\g<1>0")


@kind
def a_rapid_that_cuts(t: Text) -> Iterator[str]:
    for n, line in t.each("move"):
        if line.motion == 0 and line.moves:
            yield from t.substituted(n, r"(?<![A-Z0-9.])G(0?)0(?![0-9.])", r"G\g<1>1")


@kind
def a_motion_word_that_is_lost(t: Text) -> Iterator[str]:
    last: int | None = None
    for n, line in enumerate(t.lines):
        own = re.search(r"(?<![A-Z0-9.])G0?[01](?![0-9.])\s*", line.code)
        is_arc = t.dialect == "wincnc" and last in (2, 3)
        if line.kind == "move" and own and line.moves and last in (0, 1, 2, 3) and last != line.motion and not is_arc:
            yield t.replaced(n, line.raw[: own.start()] + line.raw[own.end() :])
        if line.kind in ("move", "cycle"):
            last = line.motion
        elif line.kind != "blank":
            last = None


# ---- arcs


@kind
def sense_of_an_arc(t: Text) -> Iterator[str]:
    for n, line in t.each("move"):
        if line.motion in (2, 3):
            yield from t.substituted(n, rf"(?<![A-Z0-9.])G(0?){line.motion}(?![0-9.])", rf"G\g<1>{5 - line.motion}")


@kind
def an_arc_as_a_line(t: Text) -> Iterator[str]:
    for n, line in t.each("move"):
        if line.motion in (2, 3) and line.axes:
            text = re.sub(r"(?<![A-Z0-9.])G(0?)[23](?![0-9.])", r"G\g<1>1", line.code.rstrip())
            yield t.replaced(n, re.sub(r"\s*(?<![A-Z])[IJKR]\s*-?[0-9.]+", "", text))


@kind
def an_arc_that_is_lost(t: Text) -> Iterator[str]:
    for n, line in t.each("move"):
        if line.motion in (2, 3):
            yield t.replaced(n)


@kind
def sign_of_a_centre(t: Text) -> Iterator[str]:
    return numbers(t, "IJK", lambda v: -v)


@kind
def words_of_a_centre_exchanged(t: Text) -> Iterator[str]:
    for n, line in t.each("move"):
        if line.motion in (2, 3) and "R" not in line.words and line.words.get("I", 0.0) != line.words.get("J", 0.0):
            yield t.replaced(n, re.sub("[IJ]", lambda m: "J" if m[0] == "I" else "I", line.raw))


@kind
def a_centre_as_a_place(t: Text) -> Iterator[str]:
    for n, line in t.each("move"):
        for letter, axis in (("I", "X"), ("J", "Y")):
            at = line.before[axis]
            if line.motion in (2, 3) and letter in line.words and at is not None and at != 0.0 and not math.isnan(at):
                yield t.word(n, letter, line.words[letter] + at)


@kind
def a_centre_word_that_is_lost(t: Text) -> Iterator[str]:
    for n, line in t.each("move"):
        for letter in "IJK":
            if line.motion in (2, 3) and line.words.get(letter):
                yield t.word(n, letter, None)


@kind
def sign_of_a_radius(t: Text) -> Iterator[str]:
    for n, line in t.each("move"):
        if line.motion in (2, 3) and "R" in line.words:
            yield t.word(n, "R", -line.words["R"])


@kind
def the_far_side_of_a_radius(t: Text) -> Iterator[str]:
    """A radius in place of a centre, with the sign of the other arc."""
    for n, line in t.each("move"):
        w = line.words
        at = [line.before[a] for a in "XY"]
        if line.motion not in (2, 3) or "I" not in w or not {"X", "Y"} <= w.keys() or line.plane != 17:
            continue
        if line.relative:
            chord = w["X"], w["Y"]
        elif None in at or math.isnan(at[0] or 0.0) or math.isnan(at[1] or 0.0):
            continue
        else:
            chord = w["X"] - (at[0] or 0.0), w["Y"] - (at[1] or 0.0)
        radius = math.hypot(w["I"], w.get("J", 0.0))
        cross = chord[0] * w.get("J", 0.0) - chord[1] * w["I"]
        if abs(cross) < 1e-6:
            continue  # half a circle: both arcs are the same
        is_short = (cross > 0) == (line.motion == 3)
        without = re.sub(r"\s*(?<![A-Z])[IJK]\s*-?[0-9.]+", "", line.code.rstrip())
        yield t.replaced(n, f"{without} R{-radius if is_short else radius:.6f}")


@kind
def no_rise_of_a_helix(t: Text) -> Iterator[str]:
    for n, line in t.each("move"):
        if line.motion in (2, 3) and line.plane == 17 and "Z" in line.words and line.before["Z"] != line.words["Z"]:
            yield t.word(n, "Z", None)


@kind
def a_full_circle_in_addition(t: Text) -> Iterator[str]:
    """An arc whose way back to its start follows."""
    for n, line in t.each("move"):
        at = [line.before[a] for a in "XY"]
        if line.motion in (1,) and None not in at and not any(math.isnan(v or 0.0) for v in at) and line.moves:
            code = "G02" if t.dialect == "mcuwin" else "G2"
            place = "" if t.dialect == "wincnc" else f" X{at[0]:g} Y{at[1]:g}" if not line.relative else " X0 Y0"
            yield t.before(n, f"{code}{place} I5 J0 F300")


@kind
def another_plane(t: Text) -> Iterator[str]:
    for n, line in t.each("move"):
        if line.motion in (2, 3) and t.dialect in MILLING:
            yield t.before(n, "G18" if line.plane == 17 else "G17")


@kind
def a_plane_that_is_lost(t: Text) -> Iterator[str]:
    for n, _ in t.coded("G18", "G19"):
        yield t.replaced(n)


# ---- feeds


@kind
def a_feed_that_is_a_little_wrong(t: Text) -> Iterator[str]:
    return _feeds(t, lambda v: v * 1.01)


@kind
def feed_in_seconds(t: Text) -> Iterator[str]:
    return _feeds(t, lambda v: v / 60)


@kind
def feed_in_the_other_unit(t: Text) -> Iterator[str]:
    return _feeds(t, lambda v: v / 25.4)


@kind
def feed_ten_times(t: Text) -> Iterator[str]:
    return _feeds(t, lambda v: v * 10)


def _feeds(t: Text, change: Callable[[float], float]) -> Iterator[str]:
    for n, line in t.each("move", "cycle"):
        if "F" in line.words and line.moves and line.motion != 0:
            yield t.word(n, "F", change(line.words["F"]))


USUAL = (1500.0, 900.0)
"""Feeds that the INI of the router has, until a program says one."""


@kind
def a_feed_that_is_lost(t: Text) -> Iterator[str]:
    for n, line in t.each("move", "cycle"):
        feed = line.words.get("F")
        if feed is not None and line.moves and line.motion != 0 and feed not in line.feeds and feed not in USUAL:
            yield t.word(n, "F", None)


@kind
def a_feed_of_the_line_before(t: Text) -> Iterator[str]:
    last: float | None = None
    for n, line in t.each("move", "cycle"):
        feed = line.words.get("F")
        if feed is not None:
            if last is not None and last != feed and line.moves and line.motion != 0:
                yield t.word(n, "F", last)
            last = feed


@kind
def inverse_time_as_feed(t: Text) -> Iterator[str]:
    for n, _ in t.coded("G93"):
        yield from t.substituted(n, r"G93", "G94")


@kind
def feed_as_inverse_time(t: Text) -> Iterator[str]:
    for n, line in t.each("move"):
        feeds = line.motion == 1 and line.moves and "F" in line.words and not line.inverse and not t.is_cut(n)
        if t.dialect != "mcuwin" and feeds and _length(line) != 1.0:
            yield t.before(n, "G93")


def _length(line: Line) -> float:
    """Of a move, in the unit in force: of one unit the inverse time is the feed."""
    way = [(line.before[a], line.after[a]) for a in AXES]
    return math.hypot(*(b - a for a, b in way if a is not None and b is not None))


@kind
def inverse_time_that_stays(t: Text) -> Iterator[str]:
    for n, _line in t.coded("G94"):
        rest = [one for one in t.lines[n + 1 :] if one.kind == "move"]
        if n and t.lines[n - 1].inverse and any(one.motion in (1, 2, 3) for one in rest):
            yield t.replaced(n)


# ---- units and distances


@kind
def inches_for_millimetres(t: Text) -> Iterator[str]:
    code = "G70" if t.dialect == "mcuwin" else "G20"
    for n, line in t.each("move"):
        counts = line.motion != 0 or t.dialect != "mcuwin"  # McuWIN 3.1: G00 has the unit of the axis
        again = any(one.has("G20", "G21", "G70", "G71") for one in t.lines[n : n + 2])
        if counts and any(line.words.get(a) for a in AXES) and not (t.is_cut(n) or line.inches or again):
            yield t.before(n, code)


@kind
def millimetres_for_inches(t: Text) -> Iterator[str]:
    code = {"mcuwin": ("G70", "G71"), "wincnc": ("G20", "G22")}.get(t.dialect, ("G20", "G21"))
    for n, _ in t.coded(code[0]):
        yield from t.substituted(n, code[0], code[1])


@kind
def centimetres_for_millimetres(t: Text) -> Iterator[str]:
    for n, _ in t.coded("G22") if t.dialect == "wincnc" else ():
        yield from t.substituted(n, "G22", "G21")


@kind
def the_unit_word_of_the_other_controller(t: Text) -> Iterator[str]:
    """G21 and G22 of McuWIN are reflections."""
    for n, line in t.each("move") if t.dialect == "mcuwin" else ():
        for code, axis in (("G21", "Y"), ("G22", "X")):
            if line.words.get(axis) and line.motion in (0, 1) and not t.is_cut(n):
                yield t.before(n, code)


@kind
def a_unit_that_is_not_restored(t: Text) -> Iterator[str]:
    for n, line in enumerate(t.lines[:-1]):
        back = line.has("G71") if t.dialect == "mcuwin" else line.has("G21") if t.dialect in MILLING else False
        if back and t.has_moved(n):
            yield t.replaced(n)


@kind
def distances_for_places(t: Text) -> Iterator[str]:
    for n, line in t.each("move"):
        if not line.relative and not t.is_cut(n) and line.motion in (0, 1) and not line.has("G90"):
            known = [line.before[a] for a in line.axes if line.words.get(a) != 0.0 or line.before[a] != 0.0]
            if any(v is not None and v != 0.0 for v in known):
                yield t.before(n, "G91")


@kind
def places_for_distances(t: Text) -> Iterator[str]:
    for n, line in t.coded("G91"):
        if _moves_next(t, n) or line.kind == "move":
            yield from t.substituted(n, "G91", "G90")


def _moves_next(t: Text, n: int) -> bool:
    after = t.next_move(n)
    return after is not None and any(after.before[a] not in (None, 0.0) for a in after.axes)


@kind
def distances_that_stay(t: Text) -> Iterator[str]:
    for n, line in t.coded("G90"):
        if n and t.lines[n - 1].relative and line.code.strip() == "G90":
            rest = [one for one in t.lines[n + 1 :] if one.kind == "move"]
            if rest and any(rest[0].before[a] not in (None, 0.0) for a in rest[0].axes):
                yield t.replaced(n)


# ---- cycles


@kind
def depth_of_a_hole(t: Text) -> Iterator[str]:
    for n, line in t.each("cycle"):
        if "Z" in line.words:
            yield t.word(n, "Z", line.words["Z"] - 1)


@kind
def height_of_a_hole(t: Text) -> Iterator[str]:
    for n, line in t.each("cycle"):
        if "R" in line.words:
            yield t.word(n, "R", line.words["R"] + 1)


@kind
def a_hole_that_is_lost(t: Text) -> Iterator[str]:
    for n, line in t.each("cycle"):
        if "Z" not in line.words or t.dialect == "wincnc":
            yield t.replaced(n)


@kind
def return_of_a_cycle(t: Text) -> Iterator[str]:
    for n, line in t.each("cycle"):
        yield from t.substituted(n, "G99", "G98") if line.has("G99") and _higher(line) else ()


def _higher(line: Line) -> bool:
    """Whether the tool was above the cycle's own height before."""
    return line.before["Z"] is not None and line.before["Z"] > line.words.get("R", 0.0)


@kind
def a_dwell_of_a_hole_that_is_lost(t: Text) -> Iterator[str]:
    for n, line in t.each("cycle"):
        if line.words.get("P"):
            yield t.word(n, "P", 0.0)


@kind
def a_dwell_of_a_hole_in_the_other_unit(t: Text) -> Iterator[str]:
    for n, line in t.each("cycle"):
        if line.words.get("P"):
            yield t.word(n, "P", line.words["P"] * (0.001 if t.dialect == "wincnc" else 1000))


@kind
def a_cycle_without_its_dwell(t: Text) -> Iterator[str]:
    for n, _ in t.each("cycle"):
        yield from t.substituted(n, "G82", "G81")
