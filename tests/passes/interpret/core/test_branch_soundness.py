"""A run with unknown inputs holds every run that knows them: places, rows and verdicts."""

from __future__ import annotations

import dataclasses
import math
import random
from pathlib import Path

import pytest
from passes.interpret.core.programs import HEAD, run
from support.campaigns import seeds
from support.judging import judged

from gproof.ir import intervals as ranges
from gproof.ir.rules import BINARY, UNARY
from gproof.ir.setup import ZERO, Interval
from gproof.ir.trace import Op, Trace
from gproof.ir.verdict import Verdict
from gproof.passes.interpret.core import path_exploration as branches
from gproof.passes.interpret.core.expressions import BINARY_FUNCTIONS, UNARY_FUNCTIONS

BITS = ("band", "bor", "bxor", "<<", ">>", "shr")


def number(rng: random.Random) -> float:
    return rng.choice([
        0.0, 1.0, -1.0, 0.5, 90.0, -90.0, rng.uniform(-3, 3), rng.uniform(-400, 400), float(rng.randrange(-9, 9)),
        rng.uniform(-1e-6, 1e-6), 10.0 ** rng.uniform(-12, 12),
    ])  # fmt: skip


def within(rng: random.Random, low: float, high: float) -> float:
    return min(high, max(low, rng.choice([low, high, rng.uniform(low, high), float(round(rng.uniform(low, high)))])))


@pytest.mark.parametrize("operator", sorted({*UNARY, *BINARY} - {*BITS}))
def test_the_range_of_an_operator_holds_its_values(operator: str) -> None:
    """Operands within their ranges give a value within the told range, or one was told that there may be none."""
    rng = random.Random(operator)
    for _ in range(1500):
        x, y = sorted((number(rng), number(rng))), sorted((number(rng), number(rng)))
        if rng.random() < 0.3:
            y[1] = y[0]
        a, b = within(rng, *x), within(rng, *y)
        two = operator in BINARY and not (operator in UNARY and rng.random() < 0.5)
        if two:
            told = ranges.binary(operator, (x[0], x[1]), (y[0], y[1]))
            may_fail = ranges.binary_may_fail(operator, (x[0], x[1]), (y[0], y[1]))
        else:
            told = ranges.unary(operator, (x[0], x[1]))
            may_fail = ranges.unary_may_fail(operator, (x[0], x[1]))
        try:
            if operator in ("/", "mod") and b == 0:
                raise ZeroDivisionError
            if two:
                value = math.pow(a, b) if operator == "**" else BINARY_FUNCTIONS[operator](a, b)
            else:
                value = UNARY_FUNCTIONS[operator](a)
        except (ValueError, OverflowError, ZeroDivisionError):
            # A half has two neighbours, and the range holds both.
            assert may_fail or operator in ("nearest", "round"), (operator, x, y, a, b)
            continue
        assert told[0] <= value <= told[1], (operator, x, y, a, b, value, told)


# -- programs

BOUNDS = {100: (1.0, 4.0), 101: (-2.0, 2.0), 4001: (-3.0, 5.0)}


class Maker:
    """Random programs with questions; ``known`` is the same program with one set of answers, line by line."""

    def __init__(self, rng: random.Random) -> None:
        self.rng = rng
        self.lines: list[str] = []
        self.asked: list[int] = []
        self.counters = 20

    def make(self, depth: int) -> None:
        rng = self.rng
        for _ in range(rng.randrange(2, 5)):
            match rng.randrange(12):
                case 0 | 1:
                    self.lines.append(f"G{rng.choice('01')} {rng.choice('XYZ')}{rng.randrange(-9, 9)} F100")
                case 2:
                    value = rng.choice(
                        ["#100", "#4001", "#1", "#5399", "#101 * 2", "#5001", "abs[#4001] + #1", "#5061"]
                    )
                    self.lines.append(f"G0 {rng.choice('XYZ')}[{value}]")
                case 3:
                    self.lines.append(
                        f"#1 = [{rng.choice(['#1 + 1', '#4001', '#5399 * 3', '#5002 / 2', '#100 - #1'])}]"
                    )
                case 4:
                    self.lines.append(
                        rng.choice(["G90", "G91", "G20", "G21", "G92 X#101", "G92.1", "G55", "G54", "G43 H1", "G49"])
                    )
                case 5:
                    self.ask("M56 P3")
                case 6:
                    self.ask('dlgmsg "d" "a" 100 "b" 101')
                case 7:
                    self.ask(f"G38.2 X{rng.randrange(20, 40)} F50")
                case 8:
                    self.lines.append("gosub deep")
                case 9 if depth:
                    self.counters += 1
                    n = self.counters
                    bound = rng.choice(["#100", "#4001", "3"])
                    self.lines += [f"#{n} = 0", f"while [#{n} < {bound}]", f"#{n} = [#{n} + 1]"]
                    self.make(depth - 1)
                    self.lines.append("endwhile")
                case _ if depth:
                    test = rng.choice(
                        ["#5399 == 1", "#4001 > 1", "#5398 == 1", "#100 < 2", "#1 > #4001", "#5067 == 1", "#5001 > 3"]
                    )
                    self.lines.append(f"if [{test}]")
                    self.make(depth - 1)
                    if rng.random() < 0.6:
                        self.lines.append("else")
                        self.make(depth - 1)
                    self.lines.append("endif")

    def ask(self, line: str) -> None:
        self.asked.append(len(self.lines))
        self.lines.append(line)

    def text(self) -> str:
        sub = ["sub deep", "#2 = [#2 + #5399]", "if [#2 > 1]", "G0 Y#2", "endif", "endsub"]
        return "\n".join(["#100 = 2", "#101 = 0", "#5399 = 0", "#5398 = 1", *sub, *self.lines, "M30", ""])


def concrete(text: str, rng: random.Random) -> str:
    """The program with one set of answers; every question of a line is answered alike each time it comes by."""
    out = []
    for line in text.replace("#5061", "#151").replace("#5067", "#152").splitlines():
        if line.startswith("M56"):
            line = f"#5399 = {rng.randrange(2)}"
        elif line.startswith("dlgmsg"):
            typed = " ".join(f"#{n} = {within(rng, *BOUNDS[n]):.6f}" for n in (100, 101))
            line = rng.choice([f"#5398 = 1 {typed}", "#5398 = [0 - 1]", f"#5398 = [0 - 1] {typed}"])
        elif line.startswith("G38.2"):
            # A contact where the move begins.
            line = f"#151 = #5001 #152 = {rng.randrange(2)}"
        out.append(line)
    return "\n".join(out) + "\n"


def boxes(trace: Trace) -> dict[int, list[list[tuple[float, float]]]]:
    """By line: of each motion row the range of X, Y and Z."""
    out: dict[int, list[list[tuple[float, float]]]] = {}
    for section in trace.sections:
        for row in range(len(section.rows)):
            if section.rows["op"][row] >= Op.DWELL:
                continue
            here = []
            for axis in range(3):
                low = high = float(section.rows["to"][row][axis])
                for symbol, factor in trace.frames[int(section.rows["frame"][row])][axis]:
                    known = trace.symbols.get(symbol, Interval(-math.inf, math.inf))
                    ends = known.low * factor, known.high * factor
                    low, high = low + min(ends), high + max(ends)
                here.append((low, high))
            out.setdefault(int(section.rows["line"][row]), []).append(here)
    return out


def machine_file(folder: Path, room: float) -> Path:
    path = folder / "machine.toml"
    axis = f'kind = "linear"\nmin = {-room}\nmax = {room}\n'
    path.write_text(
        'schema = "gproof-machine/1"\nname = "m"\nunits = "mm"\n' + "".join(f"[axes.{n}]\n{axis}" for n in "xyz")
        + "[tools.1]\nlength = 5.0\n[areas.tool_change]\nx = [12.0, 14.0]\ny = [-3.0, 30.0]\nz = [-50.0, 50.0]\n"
    )  # fmt: skip
    return path


@pytest.mark.parametrize("exact", [branches.EXACT, 0])
@pytest.mark.parametrize("seed", seeds(4, 600))
def test_a_run_that_knows_lies_within_the_one_that_does_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int, exact: int
) -> None:
    """exact: so many outcomes are followed apart, before they are joined."""
    monkeypatch.setattr(branches, "EXACT", exact)
    rng = random.Random(seed)
    maker = Maker(rng)
    while len(maker.lines) < 6 or not maker.asked:
        maker = Maker(rng)
        maker.make(2)
    text = maker.text()
    setup = dataclasses.replace(
        ZERO, default_parameter=0.0, parameter_ranges={n: Interval(*b) for n, b in BOUNDS.items()}
    )
    trace, findings = run(tmp_path, text, setup=setup, max_branches=48 if exact else 400)
    told = boxes(trace)
    is_cut = any(f.severity.name in ("UNKNOWN", "ERROR") for f in findings.kept)

    room = rng.choice([15.0, 40.0, 90.0, 1000.0])
    machine = machine_file(tmp_path, room)
    stated = tmp_path / "setup.toml"
    base = ('schema = "gproof-setup/1"\nname = "s"\nhomed = ["x", "y", "z"]\nactive_work = 1\ntool = 0\n'
            "block_delete = false\noptional_stop = false\nstart = {x = 0.0, y = 0.0, z = 0.0}\n"
            "g92 = {x = 0.0, y = 0.0, z = 0.0}\n"
            + "".join(f"[work.{k}]\nx = 0.0\ny = 0.0\nz = 0.0\n" for k in (1, 2))
            + "[parameters]\n1 = 0.0\n2 = 0.0\n")  # fmt: skip
    stated.write_text(base + "".join(f"{n} = [{a}, {b}]\n" for n, (a, b) in BOUNDS.items()))
    job = tmp_path / "job.cnc"
    job.write_text(HEAD + text)
    symbolic = judged(job, machine, str(stated), budget=200_000)
    for _ in range(4):
        known = concrete(text, rng)
        value = within(rng, *BOUNDS[4001])
        straight, _ = run(tmp_path, known, setup=dataclasses.replace(ZERO, parameters={4001: value}))
        if not is_cut:
            for line, rows in boxes(straight).items():
                for row in rows:
                    assert any(
                        all(a - 1e-9 <= p[0] <= b + 1e-9 for p, (a, b) in zip(row, box, strict=True))
                        for box in told.get(line, [])
                    ), f"line {line}: {row} not in {told.get(line)}\n{text}\n{known}\n#4001={value}"
        if symbolic.verdict is Verdict.SAFE:
            stated.write_text(f"{base}4001 = {value}\n")
            job.write_text(HEAD + known)
            assert judged(job, machine, str(stated), budget=200_000).verdict is not Verdict.UNSAFE, f"{text}\n{known}"
