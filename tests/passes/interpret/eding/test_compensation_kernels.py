"""Compensated lines in the hot loop of ``passes/interpret/core/cutter_compensation_kernels.py`` and line by line: the
same bits."""

from __future__ import annotations

import dataclasses
import math
import random
from pathlib import Path

import pytest
from passes.interpret.eding.compensated_jobs import HEAD, MILL, Stretch, contour
from support.campaigns import sizes

from gproof.driver import running as execute
from gproof.frontend.eding.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.machine import Controller, Machine
from gproof.ir.setup import NOTHING, ZERO, InForce, Interval, Setup
from gproof.ir.text import print_ir
from gproof.ir.trace import Trace
from gproof.passes.interpret.core import cutter_compensation_kernels as k
from gproof.passes.interpret.eding import compensation_codes as compensated

LATHE = dataclasses.replace(
    MILL,
    controller=Controller(xz_seen_from="+y"),
    tools=tuple(dataclasses.replace(tool, orientation=2) for tool in MILL.tools),
)
FIXTURE = dataclasses.replace(
    NOTHING, active_work=1, tool=1, work={(1, "x"): Interval(3.0, 8.0), (1, "z"): Interval(7.0, 7.0)}
)
TURNED = dataclasses.replace(ZERO, transform=InForce(angle=33.0, x=4.0, y=-1.0))


def random_job(rng: random.Random, plane: str) -> str:
    """A contour of lines and arcs, some of them against the rules, with what may stand between and beside them."""
    u, v, across = ("X", "Y", "Z") if plane == "G17" else ("Z", "X", "Y")
    side = rng.choice((1, -1))
    stretches = contour(rng, side, 3.0, sharp=rng.random() < 0.5)
    stretches += [moved(stretch, stretches[-1].end) for stretch in contour(rng, side, 3.0, sharp=True)]
    incremental = rng.random() < 0.3
    tool = rng.choice(("D1", "D1", "D2", "D3")) if plane == "G17" else "D1"
    text = [HEAD + plane, f"G0 {u}-20 {v}-20", f"{'G41' if side > 0 else 'G42'} {tool}", f"G1 {u}-8 {v}-4"]
    at = stretches[0].begin
    text.append(f"G1 {u}{at[0]:.6f} {v}{at[1]:.6f}")
    if incremental:
        text.append("G91")
    for stretch in stretches:
        begin, end = stretch.begin, stretch.end
        if incremental:
            words = f"{u}{end[0] - begin[0]:.4f} {v}{end[1] - begin[1]:.4f}"
        else:
            words = f"{u}{end[0]:.4f} {v}{end[1]:.4f}"
        if rng.random() < 0.15:
            words += f" {across}{rng.uniform(-2, 2):.3f}"
        if rng.random() < 0.15:
            words += f" F{rng.randint(1, 900)}"
        if rng.random() < 0.05:
            words += f" A{rng.randint(0, 90)}"
        if stretch.sense:
            assert stretch.center is not None
            i, j = stretch.center[0] - begin[0], stretch.center[1] - begin[1]
            code, names = "G3" if stretch.sense > 0 else "G2", ("I", "J") if plane == "G17" else ("K", "I")
            radius = math.dist(stretch.center, begin)
            form = f"{names[0]}{i:.4f} {names[1]}{j:.4f}" if rng.random() < 0.7 else f"R{radius:.4f}"
            text.append(f"{code} {words} {form}")
        else:
            text.append(f"{rng.choice(('G1', 'G1', 'G1', 'G0'))} {words}")
        extra = rng.random()
        if extra < 0.05:
            text.append(f"G1 {across}{rng.uniform(-1, 1):.3f}")
        elif extra < 0.1:
            text.append(f"F{rng.randint(1, 900)}")
        elif extra < 0.13:
            text.append(rng.choice(("G4 P0.1", "S500 M3", "M8", "G61", "G2 I0 J1", "G1 X#7", "G1")))
        elif extra < 0.15:
            text.append("(nothing)")
    return "\n".join([*text, "G40", "G90 G1 X0 Y0", "M30"]) + "\n"


def moved(stretch: Stretch, by: tuple[float, float]) -> Stretch:
    points = [None if p is None else (p[0] + by[0], p[1] + by[1]) for p in (stretch.begin, stretch.end, stretch.center)]
    assert points[0] is not None and points[1] is not None
    return Stretch(points[0], points[1], points[2], stretch.sense)


def told(text: str, setup: Setup, machine: Machine, folder: Path) -> tuple[str, list[str], Trace]:
    job = folder / "job.cnc"
    job.write_text(text)
    findings = Findings()
    program = load_program(job, findings)
    assert program is not None
    trace = execute.execute(program, setup, machine, findings)
    trace.verify()
    return print_ir(trace), [f"{f.code.label}:{f.span}:{f.message}" for f in findings.kept], trace


@pytest.mark.parametrize("speed", ["python", "numba"])
@pytest.mark.parametrize("plane", ["G17", "G18"])
@pytest.mark.parametrize("setup", [ZERO, FIXTURE, TURNED], ids=["zero", "fixture", "turned"])
@pytest.mark.parametrize("count", sizes(10, 250))
def test_the_hot_loop_is_the_python_path(
    count: int, speed: str, plane: str, setup: Setup, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if plane == "G18":
        setup = dataclasses.replace(ZERO if setup is TURNED else setup, tool=1)
    machine = MILL if plane == "G17" else LATHE
    taken = 0

    def counted(*args: object) -> tuple[int, int]:
        nonlocal taken
        done, row = offset(*args)
        taken += int(done)
        return done, row

    monkeypatch.setenv("GPROOF_KERNELS", speed)
    offset = k.offset_rows.pick(1)
    monkeypatch.setattr(type(k.offset_rows), "pick", _picker(counted))
    for seed in range(count):
        text = random_job(random.Random(seed * 7 + (plane == "G18")), plane)
        with monkeypatch.context() as here:
            here.setattr(compensated, "is_plain", lambda modal: False)
            slow = told(text, setup, machine, tmp_path)
        fast = told(text, setup, machine, tmp_path)
        assert fast[1] == slow[1], text
        assert fast[0] == slow[0], text
    assert taken > 2.4 * count


def _picker(counted: object) -> object:
    from gproof.ir.kernel import Kernel

    usual = Kernel.pick

    def pick(self: Kernel[..., object], work: float) -> object:
        return counted if self is k.offset_rows else usual(self, work)

    return pick


def test_long_contours_and_small_buffers(tmp_path: Path) -> None:
    """Thousands of corners, each row in its place wherever a batch or a buffer ends, errors among them."""
    at, angle, lines = (0.0, 0.0), 0.0, [HEAD, "G0 X-20 Y0", "G41 D2", "G1 X-5", "G1 X0"]
    for n in range(9000):
        angle -= 0.05 if n % 700 else -0.4
        at = at[0] + 3 * math.cos(angle), at[1] + 3 * math.sin(angle)
        lines.append(f"X{at[0]:.4f} Y{at[1]:.4f}")
    text = "\n".join([*lines, "G40", "M30"]) + "\n"
    fast = told(text, ZERO, MILL, tmp_path)
    with pytest.MonkeyPatch.context() as here:
        here.setattr(compensated, "is_plain", lambda modal: False)
        slow = told(text, ZERO, MILL, tmp_path)
    assert fast == slow or (fast[0], fast[1]) == (slow[0], slow[1])
    assert any(line.startswith("GP410") for line in fast[1])
