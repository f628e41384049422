"""Codes that a subprogram replaces: which line calls one, and with what. Eding CNC manual 4.4 and 3.5.3."""

from __future__ import annotations

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.program import Program
from gproof.ir.record import record
from gproof.ir.symbolic import Unknown, Value

Words = tuple[str, Value, Span]
"""Letter, value and place of a word."""

_TOOL_CHANGE = ("M", 60)
_FEED_MODES = (930, 940, 950)
_BEFORE = "FST"


@record(frozen=True, slots=True)
class Replaced:
    """A line that calls a subprogram.

    name: of the subprogram; arguments: (number of the variable, value) to set for it; before, after: words of the line
    that the controller executes itself, before and after the call.
    """

    name: str
    arguments: list[tuple[int, Value]]
    before: list[Words]
    after: list[Words]


def replaced(program: Program, depth: list[str], words: list[Words], span: Span) -> Replaced | None:
    """What a line calls instead of being executed; None for most lines. Refusal GP290.

    depth: names of the subprograms that are running: inside its own replacement a code is the controller's own.
    """
    if not program.overrides:
        return None
    called = None
    for letter, value, _ in words:
        if letter == "M" and not isinstance(value, Unknown) and abs(value) < 1e6:
            key = ("M", round(value * 10))
            name = program.overrides.get(key)
            if name is not None and name not in depth:
                if called is not None:
                    code, other = f"M{value:g}", called[1]
                    raise Refusal(codes.OVERRIDE_WITH_CODES.at(span, code=code, name=name, other=other))
                called = key, name
    if called is None:
        return None
    key, name = called
    if key == _TOOL_CHANGE and name != "m6":
        return _tool_change(name, words)
    base = program.rules.argument_base
    arguments: dict[int, Value] = {base + n: program.rules.argument_missing for n in range(26)}
    # What the variables of M and of the line number hold is not said.
    arguments |= {base + ord(letter) - 65: Unknown(f"#{base + ord(letter) - 65}") for letter in "MN"}
    for letter, value, where in words:
        if letter == "G" or (letter == "M" and ("M", round(_number(value) * 10)) != key):
            other = f"{letter}{_number(value):g}"
            raise Refusal(codes.OVERRIDE_WITH_CODES.at(where, code=f"M{key[1] // 10}", name=name, other=other))
        if letter != "M":
            arguments[base + ord(letter) - 65] = value
    return Replaced(name, sorted(arguments.items()), [], [])


def _tool_change(name: str, words: list[Words]) -> Replaced:
    """The tool change in the order of table 3-7: feed, speed and T come before it, the rest of the line after."""
    before, after = [], []
    for word in words:
        letter, number = word[0], _number(word[1])
        if letter in _BEFORE or (letter == "G" and round(number * 10) in _FEED_MODES):
            before.append(word)
        elif letter != "M" or round(number * 10) != _TOOL_CHANGE[1]:
            after.append(word)
    return Replaced(name, [], before, after)


def _number(value: Value) -> float:
    return -1.0 if isinstance(value, Unknown) else value
