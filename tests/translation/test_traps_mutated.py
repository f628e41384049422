"""Mistakes planted in the right targets of the traps: what the validator still proves does the same under every setup.

The oracle is the interpreter alone, with numbers for all that is unknown: rows of the target and of its mutant, under
the setups of the case. It never sees a form or a comparison.
"""

from __future__ import annotations

import dataclasses
import math
import random
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support.campaigns import seeds
from support.traps import READ, SETUPS, Case, cases
from translation.test_traps import difference, trace
from translation.test_traps_proved import OF_BOTH, terms_of, traced
from translation.test_traps_proved import _traced as fresh_trace

from gproof.ir.verdict import Verdict
from gproof.verify.translation.compare import compare

TARGETS = [(case, name) for case in cases() for name in case.programs("target") if case.dialect(name) in READ]
MUTANTS = 6
"""Of each target and seed; two in every run."""
FURTHER = (
    {"start": [-11.0, 2.5, -0.5], "work": [3.75, -61.0, -18.5], "second": [-7.25, 44.0, -3.0]},
    {"start": [1.0, 1.0, -2.0], "work": [-250.0, 7.5, -55.0], "second": [19.0, 90.5, -27.0]},
)
"""Setups besides those of the case."""

MEANT = frozenset(
    "op to feed center turns plane seconds channel value dir rpm mist flood tool name optional axes".split()
)
"""What rows say of the machine; ``synchronised`` is left out: where the axes rest anyway it makes no difference."""

Lines = list[str]
Mutation = Callable[[random.Random, Lines, int], Lines]


def replaced(pattern: str, by: Callable[[random.Random, re.Match[str]], str]) -> Mutation:
    """One place of a line that fits a pattern, anew."""

    def change(rng: random.Random, lines: Lines, n: int) -> Lines:
        found = list(re.finditer(pattern, lines[n]))
        if not found:
            return lines
        match = rng.choice(found)
        text = lines[n][: match.start()] + by(rng, match) + lines[n][match.end() :]
        return [*lines[:n], text, *lines[n + 1 :]]

    return change


def number(letters: str, change: Callable[[float], float]) -> Mutation:
    """The number of a word."""
    return replaced(rf"(?<![A-Z.])([{letters}])\s*(-?\d+\.?\d*)", lambda _, m: f"{m[1]}{change(float(m[2])):.10g}")


def word(one: str, other: str) -> Mutation:
    """One code for another, either way."""
    pair = {one: other, other: one}
    return replaced(rf"(?<![A-Z0-9.])(?:{one}|{other})(?![0-9.])", lambda _, m: pair[m[0]])


def added(*texts: str) -> Mutation:
    return lambda rng, lines, n: [*lines[:n], rng.choice(texts), *lines[n:]]


MUTATIONS: dict[str, Mutation] = {
    "lost": lambda _, lines, n: [*lines[:n], *lines[n + 1 :]],
    "doubled": lambda _, lines, n: [*lines[: n + 1], *lines[n:]],
    "swapped": lambda _, lines, n: [*lines[:n], *lines[n : n + 2][::-1], *lines[n + 2 :]],
    "sign": number("XYZIJKR", lambda v: -v),
    "unit": number("XYZIJKR", lambda v: v / 25.4),
    "a bit": number("XYZIJKR", lambda v: v + 0.001),
    "ten times": number("XYZIJKF", lambda v: v * 10),
    "feed": number("F", lambda v: v * 1.01),
    "speed": number("S", lambda v: v + 1),
    "seconds": number("PX", lambda v: v * 2),
    "channel": number("CP", lambda v: v + 1),
    "channel of an axis": replaced(r"(?<=M2[67] )\d+", lambda _, m: str(int(m[0]) + 1)),
    "tool": number("T", lambda v: v + 1),
    "axis": replaced(r"X|Y", lambda _, m: "Y" if m[0] == "X" else "X"),
    "sense": replaced(r"G0?[23](?![0-9.])", lambda _, m: m[0][:-1] + ("3" if m[0][-1] == "2" else "2")),
    "rapid": replaced(r"G0?[01](?![0-9.])", lambda _, m: m[0][:-1] + ("1" if m[0][-1] == "0" else "0")),
    "distances": word("G90", "G91"),
    "units": word("G20", "G21"),
    "plane": word("G17", "G18"),
    "zero": word("G54", "G55"),
    "turn": word("M3", "M4"),
    "return": word("G98", "G99"),
    "length": word("G43", "G49"),
    "restore": word("G92.2", "G92.3"),
    "stop": added("M0", "G4"),
    "mode": added("G91", "G20", "G55", "G92 X1", "G18", "M5", "M9"),
}


def mutant(case: Case, name: str, rng: random.Random) -> tuple[str, Case]:
    """A kind of mistake, and the case with the program in which it is."""
    text = case.section.files[name].decode()
    lines = text.splitlines()
    kind = rng.choice(list(MUTATIONS))
    for n in rng.sample(range(len(lines)), len(lines)):
        wrong = MUTATIONS[kind](rng, lines, n)
        # After another end there is no next job that shows what is left.
        if wrong != lines and wrong.count("M30") == lines.count("M30"):
            files = case.section.files | {name: ("\n".join(wrong) + "\n").encode()}
            section = dataclasses.replace(case.section, files=files)
            return f"{kind} (line {n + 1})", Case(case.name, section)
    return kind, case


def plain(rows: list[dict[str, Any]], start: list[float]) -> list[dict[str, Any]]:
    """What rows do: without places in the source, commands that repeat what is on, and cuts of straight moves."""
    found: list[dict[str, Any]] = []
    on: dict[object, object] = {}
    at, before = start, start
    for row in rows:
        now = {key: value for key, value in row.items() if key in MEANT}
        if now["op"] in ("spindle", "coolant", "output"):
            device = now["op"], now.get("channel"), "dir" in now
            if on.get(device) == now:
                continue
            on[device] = now
        if "to" in now:
            last = found[-1] if found else {}
            alike = {k: v for k, v in last.items() if k != "to"} == {k: v for k, v in now.items() if k != "to"}
            if now["op"] in ("feed", "traverse") and alike and between(before, last["to"], now["to"]):
                found[-1] = now
                at = now["to"]
                continue
            before, at = at, now["to"]
        if (
            now["op"] == "dwell"
            and found
            and found[-1]["op"] == "dwell"
            and "seconds" in now
            and "seconds" in found[-1]
        ):
            found[-1] = found[-1] | {"seconds": found[-1]["seconds"] + now["seconds"]}
            continue
        found.append(now)
    return found


def between(one: list[float], middle: list[float], other: list[float]) -> bool:
    """Whether a place is on the straight line between two."""
    if None in (*one, *middle, *other):
        return False
    return abs(math.dist(one, middle) + math.dist(middle, other) - math.dist(one, other)) < 1e-9


def is_proven(case: Case, name: str, folder: Path) -> bool:
    """Whether the validator proves a mutant, in each state of the setup that it may rest on."""
    for state in {str({k: v for k, v in state.items() if k not in OF_BOTH}): state for state in case.setups()}.values():
        source, one, is_open = traced(case, case.source, state, folder)
        target, other, is_bad = fresh_trace(case, name, state, folder)
        if one is None or other is None or is_open or is_bad:
            return False
        if compare(one, other, terms_of(case, name, source, target)).verdict is not Verdict.SAFE:
            return False
    return True


@pytest.mark.parametrize("seed", seeds(1, 40))
@pytest.mark.parametrize("part", range(8))
def test_what_is_proven_agrees_everywhere(part: int, seed: int, tmp_path: Path) -> None:
    for case, name in TARGETS[part::8]:
        rng = random.Random(f"{case.name} {seed}")
        for n in range(MUTANTS if seed else 2):
            kind, wrong = mutant(case, name, rng)
            if wrong is case:
                continue
            folder = tmp_path / f"{seed}-{n}"
            if not is_proven(wrong, name, folder / "forms"):
                continue
            states = [*case.setups(), *(case.setups()[0] | further for further in FURTHER)]
            for k, state in enumerate(states):
                there = plain(trace(case, name, state, folder / f"right{k}")[0], state["start"])
                rows = plain(trace(wrong, name, state, folder / f"wrong{k}")[0], state["start"])
                text = wrong.section.files[name].decode()
                assert difference(there, rows) == "" == difference(rows, there), (case.name, name, kind, state, text)


assert len(SETUPS) + len(FURTHER) >= 4
