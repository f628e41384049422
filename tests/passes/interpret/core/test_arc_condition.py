"""Arcs that rounding changes: how far a centre can move, and which arcs nearly close; both worked out another way."""

from __future__ import annotations

import cmath
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.goldens import ROOT

from gproof.ir.kernel import Kernel
from gproof.passes.geometry.extent_kernels import CLOSES, IS_HUGE, MISMATCH, odd_arcs
from gproof.passes.interpret.core.arc_condition import badly_determined, centre_error, sweep_of

MACHINE = ROOT / "docs" / "codes" / "machine.toml"


def centre(end: complex, radius: float) -> complex | None:
    """Of the counter-clockwise arc from 0: a triangle with two sides of ``radius``, by the law of cosines."""
    chord = abs(end)
    if chord == 0.0 or chord > 2.0 * abs(radius):
        return None
    corner = math.acos(min(1.0, chord / (2.0 * abs(radius))))
    return abs(radius) * cmath.rect(1.0, cmath.phase(end) + math.copysign(corner, radius))


def test_a_centre_never_moves_further_than_is_said() -> None:
    random = np.random.default_rng(406)
    reached = 0.0
    for _ in range(3000):
        radius = float(random.choice([-1, 1])) * 10.0 ** random.uniform(-0.5, 2.5)
        chord = 2.0 * abs(radius) * (1.0 - 10.0 ** random.uniform(-7, -0.01))
        rounding = 10.0 ** random.uniform(-5, -2.5)
        before = centre(complex(chord, 0.0), radius)
        assert before is not None
        allowed = centre_error(chord, radius, rounding)
        for _ in range(8):
            dx, dy, dr = random.uniform(-rounding, rounding, 3)
            after = centre(complex(chord + dx, dy), radius + math.copysign(1.0, radius) * dr)
            if after is not None:
                assert abs(after - before) <= allowed * (1 + 1e-9)
                reached = max(reached, abs(after - before) / allowed)
    assert reached > 0.6, "the bound says something"


@pytest.mark.parametrize(
    ("degrees", "bad"),
    [
        (1, False),
        (164.9, False),
        (165.1, True),
        (180, True),
        (194.9, True),
        (195.1, False),
        (344.9, False),
        (345.1, True),
    ],
)
def test_the_manual_s_ranges(degrees: float, bad: bool) -> None:
    """3.4.3.1: tiny to 165 and 195 to 345 degrees are fine."""
    radius = 10.0 if degrees <= 180 else -10.0
    chord = 2 * 10.0 * math.sin(math.radians(degrees) / 2)
    assert sweep_of(chord, radius) == pytest.approx(degrees, abs=1e-6)
    assert badly_determined(sweep_of(chord, radius)) is bad


def told(kernel: Any, arcs: list[dict[str, Any]], tolerance: float, made: int) -> list[tuple[int, int]]:
    """(kind, row) of what ``odd_arcs`` finds among arcs that follow one another, traverses between them."""
    op, to, center, turns, plane = [], [], [], [], []
    for arc in arcs:
        for what in ("start", "end"):
            op.append(1 if what == "start" else 3)
            to.append([*arc[what], 0.0, 0.0, 0.0])
            center.append(arc["center"] if what == "end" else [0.0, 0.0, 0.0])
            turns.append(arc["turns"] if what == "end" else 0)
            plane.append(arc["plane"] if what == "end" else 0)
    counts, rows = np.zeros(3, np.int64), np.full((3, 500), -1, np.int64)
    floats = [np.zeros((3, 500)) for _ in range(3)]
    kernel(
        np.array(op), np.array(to), np.array(center), np.array(turns), np.array(plane), np.zeros(len(op), np.int64),
        np.array([tolerance]), np.array([made]), np.zeros(6), counts, rows, *floats,
    )  # fmt: skip
    return [(kind, int(rows[kind, n]) // 2) for kind in range(3) for n in range(int(counts[kind]))]


def arc_in(plane: int, middle: complex, start: complex, end: complex, turns: int) -> dict[str, Any]:
    first, second = {1: (0, 1), 2: (2, 0), 3: (1, 2)}[plane]
    out: dict[str, Any] = {"turns": turns, "plane": plane}
    for name, place in (("start", start), ("end", end), ("center", middle)):
        point = [0.0, 0.0, 0.0]
        point[first], point[second] = place.real, place.imag
        out[name] = [*point, 0.0][:4] if name != "center" else point
    return out


@pytest.mark.parametrize("made", [0, 1])
def test_what_is_told_of_random_arcs(made: int) -> None:
    random = np.random.default_rng(408)
    arcs, expected = [], []
    for n in range(300):
        radius = 10.0 ** random.uniform(-1, 7)
        begin = random.uniform(-math.pi, math.pi)
        turns = int(random.choice([-2, -1, 1, 2]))
        chord = 10.0 ** random.uniform(-5.5, 0) if n % 2 else min(radius, 10.0 ** random.uniform(-1, 2))
        ahead = bool(random.integers(2))
        angle = 2 * math.asin(min(1.0, chord / (2 * radius))) * (1 if ahead else -1) * math.copysign(1, turns)
        other = radius + float(random.choice([0.0, 0.0, 0.01]))
        middle = complex(*random.uniform(-50, 50, 2)) if radius < 1e4 else 0j
        plane = int(random.integers(1, 4))
        start, end = middle + cmath.rect(radius, begin), middle + cmath.rect(other, begin + angle)
        arcs.append(arc_in(plane, middle, start, end, turns))
        apart = abs(end - start)
        if other != radius:
            expected.append((MISMATCH, n))
        if 0 < apart <= 0.005 and abs(turns) == 1 and (not ahead or (apart <= 1e-4 and not made)):
            expected.append((CLOSES, n))
        if radius >= 1e6:
            expected.append((IS_HUGE, n))
    assert isinstance(odd_arcs, Kernel)
    answers = [told(kernel, arcs, 0.002, made) for kernel in (odd_arcs.python, odd_arcs.compiled())]
    assert answers[0] == answers[1] == sorted(expected)
    assert {kind for kind, _ in expected} == {MISMATCH, CLOSES, IS_HUGE}


def test_an_arc_rounded_past_its_start_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """0.001 mm onwards is a short arc, 0.001 mm back a whole circle but for that: only the second is told."""
    from gproof.cli.main import main

    for end, angle in (("0.001", None), ("-0.001", "359.9943")):
        job = tmp_path / "job.cnc"
        job.write_text(f"G21 G17 G90 G94 G40 G49 G54\nF300\nG0 X0 Y0\nG2 X0 Y{end} I10 J0\nM30\n", encoding="utf-8")
        main(["check", str(job), "--machine", str(MACHINE), "--setup", "zero"])
        printed = capsys.readouterr().out
        assert ("GP408" in printed) is (angle is not None)
        assert angle is None or f"after {angle} degrees; rounded otherwise it would be 0.0057" in printed
