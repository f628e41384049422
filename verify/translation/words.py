"""Differences of two programs in sentences. It explains and decides nothing."""

from __future__ import annotations

from collections.abc import Iterable

from gproof.ir.trace import Op
from gproof.ir.translation_terms import ROW_FACTS, SymbolMeaning
from gproof.verify.translation.comparison import Divergence, Place

DIFFERENT: dict[str, str] = {
    "kind": "a {names[0]} on one side is a {names[1]} on the other",
    "place": "the moves end at different places: {places}",
    "start": "the sections start at different places",
    "center": "the arcs have different centers and paths",
    "sense": "the arcs turn in different directions or by different angles",
    "plane": "the arcs are in different planes",
    "chord": "a straight move is further from the arc than the chord tolerance",
    "feed": "the feed is {numbers[0]:g} and {numbers[1]:g}",
    "move lost": "the target lacks a move",
    "move added": "the target has a move that the source does not have",
    "event moved": "something is switched before a move on one side and after it on the other",
    "event": "the source has {names[0]} here, the target {names[1]}",
    "output timing": "motion stops for the output on one side only",
    "wait": "the source waits for {names[0]}, the target for {names[1]}",
    "outcome": "the wait has the outcomes {names[0]} in the source and {names[1]} in the target",
    "end": "one program ends here and the other goes on",
    "end state": "the program leaves another {names[0]}: {names[1]} and {names[2]}",
    "offset left": "the program leaves another offset {names[0]}: {names[1]} and {names[2]}",
    "tool": "the tool is not the same",
    "path_mode": "corners are taken in different ways",
    "overrides": "overrides act on one side only",
    "head": "different heads are selected",
    "surface_speed": "constant surface speed is not the same",
    "synchronised": "the move follows the spindle on one side only",
    "following": "the controller adds different things to the path",
    "guards": "different guards are off",
    "dynamics": "velocities or accelerations are set differently",
    "backlash": "backlash is set differently",
    "limits": "limits are set differently",
    "spindle": "the spindle does not turn alike",
}
"""By kind what is different; a kind that is not here is that of an event: what ``_event`` says."""

OPEN: dict[str, str] = {
    "nothing there": "one of the programs has no trace",
    "too many states": "a place of the programs is reached in too many states to compare all",
    "place": "the position rests on something that arises in the run and is not matched on the other side",
    "machine place": "a move to machine coordinates, which do not count from the same place on both machines",
    "feed unknown": "the feed is unknown",
    "rapid": "rapid moves of several axes: the path is not the same on both machines, or unknown",
    "not followed": "what comes after this line is unknown",
    "branch": "the source waits for {names[0]}, the target for {names[1]}: an open condition is on one side only",
    "names": "the position rests on something that arises in a loop",
    "question": "the operator reads different questions",
    "one question": "one program asks a question here, and the other goes on without it",
    "condition": "the two conditions cannot be compared",
    "timeout": "the wait ends with {names[0]!r} in the source and {names[1]!r} in the target",
    "end state unknown": "what the program leaves for the next job is unknown",
    "offset left": "the offset {names[0]} that is left is unknown: {names[1]} and {names[2]}",
}
"""By kind what is open; a kind that is not here is an event with a number that is not known, or a device command."""

_MOVES = {"TRAVERSE": "rapid move", "FEED": "feed move", "ARC": "arc", "PROBE": "probe move"}
_AXES = "XYZABC"
PLAIN_OFFSETS = 6
"""Work offsets that are G54 to G59; those after them are G59.1 and so on."""


def sentence(found: Divergence, *, is_open: bool = False) -> str:
    """What one divergence says, without its places."""
    known = (OPEN if is_open else DIFFERENT).get(found.kind)
    if known is None:
        return _event(found)
    names = tuple(_MOVES.get(name, name) for name in found.names)
    return known.format(names=names, numbers=found.numbers, places=_places(found.numbers))


def _event(found: Divergence) -> str:
    what, _, how = found.kind.rpartition(" ")
    numbers = " and ".join(f"{number:g}" for number in found.numbers)
    if how == "lost":
        return f"the target lacks {what}" + (f" ({numbers})" if numbers else "")
    if how == "added":
        return f"the target has {what} that the source does not have" + (f" ({numbers})" if numbers else "")
    if how == "unknown":
        return f"{what}: a number is unknown"
    return f"{found.kind} is not the same" + (f" ({numbers})" if numbers else "")


def _places(numbers: tuple[float, ...]) -> str:
    if len(numbers) != 2 * len(_AXES):
        return ""
    sides = numbers[: len(_AXES)], numbers[len(_AXES) :]
    apart = [k for k, (a, b) in enumerate(zip(*sides, strict=True)) if a != b]
    if not apart:
        return "the numbers are the same, the offsets or tool lengths that they count from are not"
    return " and ".join(" ".join(f"{_AXES[k]}{side[k]:.4f}" for k in apart) for side in sides)


def meanings(side: str, said: Iterable[SymbolMeaning], axes: frozenset[str]) -> list[str]:
    """What unknowns of a side (``source`` or ``target``) are, a sentence for the axes of one kind together."""
    found: dict[str, list[str]] = {}
    for one in said:
        name, _, axis = one.symbol.rpartition(".")
        if axis not in axes:
            continue
        parts = [_symbol(symbol.rpartition(".")[0], times) for symbol, times in one.form]
        number = [f"{one.mm:g} mm"] if one.mm or not parts else []
        found.setdefault(f"{_symbol(name)} of the {side} program is {' and '.join(number + parts)}", []).append(axis)
    linear = axes & set("xyz")
    return [
        text if linear <= set(of) or text.startswith("the length") else f"{text} ({', '.join(of).upper()})"
        for text, of in found.items()
    ]


def facts(names: Iterable[str]) -> str:
    """Names of ``left_out``, in words."""
    said = {**ROW_FACTS, "table": "what is stored in the table of work offsets"}
    return "; ".join(said.get(name, name) for name in sorted(names))


def _symbol(name: str, times: float = 1) -> str:
    """An unknown without its axis: ``g92``, ``work.2``, ``tool.3``."""
    kind, _, number = name.partition(".")
    if kind == "work":
        code = f"G{53 + int(number)}" if int(number) <= PLAIN_OFFSETS else f"G59.{int(number) - PLAIN_OFFSETS}"
        text = f"work offset {number} ({code})"
    elif kind == "tool":
        text = f"the length of tool {number}" if number != "0" else "the tool length in force at the start"
    else:
        text = _PLACES.get(name, name)
    return text if times == 1 else f"{times:g} times {text}"


_PLACES = {
    "g92": "the local offset (G92)", "park1": "the parking place (G28)", "park2": "the parking place (G30)",
}  # fmt: skip


def where(place: Place | None) -> str:
    """A place as readers write it."""
    return f"{place[0]}:{place[1]}" if place is not None else "(no line)"


assert set(_MOVES) == {op.name for op in Op if op < 10}
