"""Symbols of unknowns in words: what messages call ``work.1.x + tool.3.z``.

Which kinds there are says docs/trace.md, Frames. Both those who decide and those who check (``verify``) print them.
"""

from __future__ import annotations

from itertools import takewhile

from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.trace import Affine

RISEN = "risen"
"""Kind of the symbols of heights that a cycle rises to: the greater of two places of the path."""
STORED = "stored"
"""Kind of the symbols of #5211 to #5216 as an earlier job left them."""
UNIFORM = "uniform"
ACTUAL = "actual"
"""Kind of the symbols by which axes lie elsewhere if ``G51 P`` scales them, too."""
MIRRORED = "mirrored"
"""Kind of the symbols of reflections about one of two zeros (docs/trace.md, Frames)."""
UNHOMED = "unhomed"
"""Kind of the symbols by which the positions of an axis that was never homed differ from those of its machine."""


def describe(form: Affine, machine: Machine | None = None) -> str:
    """A form in words: ``G54 X offset + tool 3 length``; machine: its axes have the letters that programs give them."""
    kinds = ("work", "g92", "tool", "head", "start", "probe", "home", "value", "length", RISEN, "beside")
    ordered = sorted(form, key=lambda term: kinds.index(k) if (k := term[0].split(".")[0]) in kinds else len(kinds))
    alike: dict[tuple[str, str, int], list[int]] = {}
    for symbol, count in ordered if len(form) > ONE_BY_ONE else ():
        kind, *rest = symbol.split(".")
        if kind in _SEVERAL and len(rest) == 2 and rest[0].isdigit():
            alike.setdefault((kind, rest[1], count), []).append(int(rest[0]))
    said: dict[str, None] = {}
    for symbol, count in ordered:
        kind, *rest = symbol.split(".")
        numbers = alike.get((kind, rest[-1] if rest else "", count), ())
        one = describe_symbol(symbol, machine)
        if len(numbers) > ONE_BY_ONE:
            many = f"{len(numbers)} {_SEVERAL[kind].format(axis=_word(rest[1], machine))}"
            one = f"{many} ({min(numbers)} ... {max(numbers)})"
        times = one if abs(count) == 1 else f"{abs(count)} x {one}"
        said[f"{'-' if count < 0 else '+'} {times}"] = None
    return " ".join(said).removeprefix("+ ")


ONE_BY_ONE = 3
"""So many unknowns of a kind are named one by one."""
_SEVERAL = {
    "probe": "probe contacts in {axis}", "home": "positions of {axis} after homing", "tool": "lengths of tools",
    RISEN: "heights of {axis} that cycles rise to", "length": "tool lengths that are measured or typed",
    "value": "values of {axis}", UNIFORM: "positions of {axis} under G51 P",
    ACTUAL: "positions of {axis} that G10 L20 uses",
}  # fmt: skip
"""Kinds of which there may be many in one sum, in words."""


def _word(name: str, machine: Machine | None) -> str:
    """The letter of an axis by its name."""
    return machine.word(AXIS_NAMES.index(name)) if machine is not None and name in AXIS_NAMES else name.upper()


def describe_symbol(symbol: str, machine: Machine | None = None) -> str:
    """A symbol in the words of a machinist; the length of a tool says which head it is of, where that is not Z's."""
    kind, *rest = symbol.split(".")
    if kind == "start":
        return f"the start position of {_word(rest[0], machine)}"
    if kind == "work":
        names = ("active", "G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")
        return f"{names[int(rest[0])]} {_word(rest[1], machine)} offset"
    if kind == "g92":
        return f"G92 {_word(rest[0], machine)} offset"
    if kind == "tool":
        head = "" if rest[1] == "z" else f" of {_word(rest[1], machine)}"
        return f"active tool length{head}" if rest[0] == "0" else f"length{head} of tool {rest[0]}"
    if kind == "probe":
        return f"the probe contact {rest[0]} in {_word(rest[1], machine)}"
    if kind == UNHOMED:
        return f"the start position of {_word(rest[0], machine)}, which has had no reference run"
    if kind == "home":
        return f"the position of {_word(rest[1], machine)} after homing {rest[0]}"
    if kind == "head":
        return f"head {rest[0]} {_word(rest[1], machine)} offset"
    if kind == "beside":
        tool = "".join(takewhile(str.isdigit, rest[0]))
        return f"the position of the corrected tool {tool} next to its contour in {_word(rest[1], machine)}"
    if kind == MIRRORED:
        return f"the zero that {_word(rest[1], machine)} is mirrored about (of the offset or of the machine)"
    if kind == RISEN:
        return f"the height {rest[0]} of {_word(rest[1], machine)} that a cycle rises to"
    if kind == "length":
        return f"the tool length {rest[0]}, which is measured or typed while the job runs"
    if kind == STORED:
        return f"#{5211 + AXIS_NAMES.index(rest[1])}, which G92.3 brings back"
    if kind == UNIFORM:
        return f"the position of {_word(rest[1], machine)} under G51 P (scaled or not, no. {rest[0]})"
    if kind == ACTUAL:
        return f"the position of {_word(rest[1], machine)} that G10 L20 uses (no. {rest[0]})"
    if kind == "value":
        return f"a value of {_word(rest[1], machine)} with known limits only (no. {rest[0]})"
    return "an unknown value"
