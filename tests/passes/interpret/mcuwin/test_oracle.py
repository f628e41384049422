"""Random DIN programs, read from text: what gproof makes of them is what a second reading of the manual makes."""

from __future__ import annotations

import dataclasses
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hand.compare import open_or_wrong
from passes.interpret.mcuwin.mcuwin_oracle import AXES, OLD, Oracle, Shop, random_program
from passes.interpret.mcuwin.mcuwin_programs import TASKS, machine
from support.campaigns import seeds

from gproof.driver.running import begin, collect
from gproof.frontend.mcuwin.load import load_program
from gproof.ir.dialects.mcuwin.settings import RadiusTool
from gproof.ir.finding import Findings, Severity
from gproof.ir.machine import Machine
from gproof.ir.setup import ZERO
from gproof.ir.trace import Op, Trace, chunks
from gproof.ir.verdict import Verdict
from gproof.passes.checks.limits.work_boundaries import Boundaries

TOOLS = tuple(RadiusTool(number=0, plane=plane, radius=0.0, length=0.0) for plane in ("xy", "yz", "zx"))
COLUMNS = [0, 1, 2, 5]
CLOSE = 2e-5
"""mm: the texts have six decimals, and steps add up."""


def machine_of(shop: Shop) -> Machine:
    table = tuple((row[0], row[1], row[2], 0.0, 0.0, row[3]) for row in shop.table)
    on = machine(
        version=shop.version, position_unit=25.4 if shop.inch else 1.0, time_unit=shop.seconds,
        absolute_centers=shop.absolute, interpolation_axes=shop.axes, zero_offsets=table, keeps_over_codes=shop.keep,
        tools=TOOLS if shop.tools else (), tasks=TASKS, line_numbers=False, case_sensitive=True, unstated=(), g60="run",
    )  # fmt: skip
    axes = (dataclasses.replace(axis, position_unit=shop.own_x if axis.word == "X" else 1.0) for axis in on.axes)
    return dataclasses.replace(on, axes=tuple(axis for axis in axes if axis.word in AXES))


def shop_of(rand: random.Random) -> Shop:
    return Shop(
        version=OLD if rand.random() < 0.15 else "2.5.3.133", inch=rand.random() < 0.15,
        seconds=rand.choice([60.0, 60.0, 1.0]), absolute=rand.choice([False, False, True, None]),
        axes=rand.choice([AXES, AXES, "XYZ"]), keep=rand.random() < 0.5, tools=rand.random() < 0.8,
        own_x=25.4 if rand.random() < 0.15 else 1.0,
    )  # fmt: skip


def moves(trace: Trace) -> list[tuple[Any, ...]]:
    """(line, op, place of all axes, centre, turns, feed, whether every place is known) of rows that lead somewhere."""
    found = []
    for section in trace.sections:
        before, r = np.array(section.start), section.rows
        for n in range(len(r)):
            op = Op(int(r["op"][n]))
            if op >= Op.DWELL:
                continue
            to = np.array(r["to"][n])
            if op is Op.ARC or np.abs(to - before).max() > 1e-9:
                known = trace.frames[int(r["frame"][n])] == ((),) * 6
                found.append(
                    (int(r["line"][n]), op, to, r["center"][n], int(r["turns"][n]), float(r["feed"][n]), known)
                )
            before = to
    return found


def same(row: tuple[Any, ...], wanted: tuple[Any, ...]) -> bool:
    """Whether a row is the move that the second reading has."""
    line, motion, to, arc, feed = wanted
    at, op, place, center, turns, its_feed, known = row
    alike = at == line and known and (op is Op.ARC) == (arc is not None) and (op is Op.TRAVERSE) == (motion == "G0")
    alike = alike and np.abs(place[COLUMNS] - np.array(to)).max() < CLOSE
    if alike and arc is not None:
        columns = [AXES.index(letter) for letter in arc[0]]
        alike = turns == arc[3] and np.abs(center[columns] - np.array(arc[1:3])).max() < CLOSE
    return alike and (feed is None or abs(its_feed - feed) < 1e-6 * (1.0 + feed))


def agree(text: list[str], shop: Shop, path: Path) -> None:
    """Rows up to where the second reading stops, and what is said there."""
    oracle = Oracle(text, shop)
    stop = oracle.run()
    path.write_text("\n".join(text) + "\n")
    findings = Findings(limit=10_000)
    on = machine_of(shop)
    program = load_program(path, findings, on)
    assert program is not None
    trace = collect(begin(program, ZERO, on, findings))
    trace.verify()
    edges = Boundaries(on, ZERO, findings)
    for chunk in chunks(trace):
        edges.feed(chunk)
    limits = edges.finish()
    told = [(f.span.line, f.severity, f.code.label) for f in open_or_wrong(findings.kept)]
    what = "\n".join([str(shop), *(f"{n:3} {line}" for n, line in enumerate(text, 1)), str(stop), str(told), ""])
    rows = moves(trace)
    for n, wanted in enumerate(oracle.rows):
        assert n < len(rows), what + f"no row for {wanted}"
        assert same(rows[n], wanted), what + f"{rows[n]} in place of {wanted}"
    if any(stop is None or n < stop.line for n in oracle.outside):
        assert limits.verdict is Verdict.UNSAFE, what + f"lines {oracle.outside} leave the limits"
    if stop is None:
        assert len(rows) == len(oracle.rows), what + "more rows"
        expected = {"GP518", "GP301"} if oracle.outside else {"GP518"}
        expected |= {"GP302"} if oracle.doubtful_limit else set()
        assert ("GP302" in {label for _, _, label in told}) == oracle.doubtful_limit, what
        assert {label for _, _, label in told} <= expected, what + "a false alarm"
    elif stop.kind != "long":
        if stop.kind == "both":
            # Two readings, both followed: the place is one of an unknown between them.
            at = [known for line, _, _, _, _, _, known in rows if line == stop.line + 1]
            if not all(at):
                return
        kinds = {"error": (Severity.ERROR,), "open": (Severity.UNKNOWN,), "both": (Severity.UNKNOWN,)}.get(
            stop.kind, tuple(Severity)
        )
        assert any(line == stop.line + 1 and severity in kinds for line, severity, _ in told), what + "not told"


@pytest.mark.parametrize("seed", seeds(20, 1000))
def test_random_programs_mean_what_the_manual_says(seed: int, tmp_path: Path) -> None:
    rand = random.Random(f"din {seed}")
    shop = shop_of(rand)
    agree(random_program(rand, shop), shop, tmp_path / "job.din")
