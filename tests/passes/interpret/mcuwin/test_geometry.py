"""Arcs, reflections and cylinders: places against geometry that is computed another way, with complex numbers."""

from __future__ import annotations

import cmath
import math
import random

import pytest
from passes.interpret.mcuwin.mcuwin_programs import labels, machine, moves, run
from support.campaigns import seeds

from gproof.ir.dialects.mcuwin.settings import RadiusTool
from gproof.ir.trace import Op, Trace

TOOLS = tuple(RadiusTool(plane=plane, number=0, radius=0.0, length=0.0) for plane in ("xy", "yz", "zx"))


def arcs(trace: Trace) -> list[tuple[complex, complex, int, int]]:
    """(end, centre, turns, plane) of arcs in XY, XZ as Z + iX, YZ as Y + iZ: counter-clockwise is positive."""
    found = []
    pairs = {1: (0, 1), 2: (2, 0), 3: (1, 2)}
    for section in trace.sections:
        rows = section.rows
        for n in range(len(rows)):
            if rows["op"][n] == Op.ARC:
                a, b = pairs[int(rows["plane"][n])]
                to, center = rows["to"][n], rows["center"][n]
                found.append((complex(to[a], to[b]), complex(center[a], center[b]), int(rows["turns"][n]),
                              int(rows["plane"][n])))  # fmt: skip
    return found


def word(letter: str, number: float) -> str:
    return f"{letter}{number:.12f}"


PLANES = {"G17": ("XY", "IJ", 1), "G18": ("ZX", "KI", 2), "G19": ("YZ", "JK", 3)}


@pytest.mark.parametrize("seed", seeds(16, 40))
def test_arcs_in_every_plane_lie_on_their_circle(seed: int) -> None:
    rand = random.Random(seed)
    code = rand.choice(sorted(PLANES))
    (first, second), (one, other), number = PLANES[code]
    start = complex(rand.uniform(-50, 50), rand.uniform(-50, 50))
    center = start + cmath.rect(rand.uniform(1, 40), rand.uniform(0, 6))
    sweep = rand.uniform(0.1, 6.1)
    ccw = rand.random() < 0.5
    end = center + (start - center) * cmath.exp(1j * (sweep if ccw else -sweep))
    steps = rand.random() < 0.5
    places = rand.random() < 0.5 and not steps
    there, about = (end - start if steps else end), (center if places else center - start)
    trace, findings = run(
        [code, f"G90 G00 {word(first, start.real)} {word(second, start.imag)}", "G161" if places else "G162",
         "G91" if steps else "G90",
         f"{'G03' if ccw else 'G02'} {word(first, there.real)} {word(second, there.imag)} {word(one, about.real)} "
         f"{word(other, about.imag)} F100"],
        on=machine(tools=TOOLS, absolute_centers=places),
    )  # fmt: skip
    assert labels(findings) == []
    ((to, middle, turns, plane),) = arcs(trace)
    assert abs(to - end) < 1e-9
    assert abs(middle - center) < 1e-9
    assert (turns, plane) == (1 if ccw else -1, number)


@pytest.mark.parametrize("seed", seeds(24, 60))
def test_reflected_arcs_are_mirror_images(seed: int) -> None:
    """Every point of the reflected arc is the image of a point of the plain one."""
    rand = random.Random(seed)
    factors = rand.choice([-1.0, 2.0, -2.5, 0.5]), None
    x, y = rand.choice([(1, 0), (0, 1), (1, 1)])
    fx, fy = (factors[0] if x else 1.0), (factors[0] if y else 1.0)
    if abs(fx) != abs(fy):
        fx, fy = math.copysign(1, fx), math.copysign(1, fy)
    image = lambda p: complex(p.real * fx, p.imag * fy)  # noqa: E731
    start = complex(rand.uniform(-50, 50), rand.uniform(-50, 50))
    center = start + cmath.rect(rand.uniform(1, 40), rand.uniform(0, 6))
    sweep, ccw = rand.uniform(0.1, 6.1), rand.random() < 0.5
    end = center + (start - center) * cmath.exp(1j * (sweep if ccw else -sweep))
    about = center - start
    modes = [f"G{20 + y + 2 * x}", f"G39{f' X{fx}' if x else ''}{f' Y{fy}' if y else ''}"]
    trace, findings = run(
        [*modes, f"G90 G00 {word('X', start.real)} {word('Y', start.imag)}",
         f"{'G03' if ccw else 'G02'} {word('X', end.real)} {word('Y', end.imag)} {word('I', about.real)} "
         f"{word('J', about.imag)} F100"]
    )  # fmt: skip
    assert labels(findings) == []
    ((to, middle, turns, _),) = arcs(trace)
    assert abs(to - image(end)) < 1e-9
    # A quarter of the way along, both ways.
    part = center + (start - center) * cmath.exp(1j * (sweep if ccw else -sweep) / 4)
    begin = image(start)
    whole = (cmath.phase((to - middle) / (begin - middle)) * turns) % (2 * math.pi)
    assert abs(middle + (begin - middle) * cmath.exp(1j * turns * whole / 4) - image(part)) < 1e-7


def test_factors_that_make_ellipses_are_refused() -> None:
    assert labels(run(["G22", "G39 X2", "G02 X10 I5 J0 F100"])[1]) == ["GP415"]
    assert labels(run(["G23", "G39 X2 Y-2", "G02 X10 I5 J0 F100"])[1]) == []


def test_circles_and_radii() -> None:
    trace, findings = run(["G90 G00 X10", "G02 I5 J0 F100", "G03 X10 Y0 I0 J3", "G02 X20 I5 J0 Z-3"])
    assert [a[2] for a in arcs(trace)] == [-1, 1, -1]
    assert moves(trace)[-1] == ("ARC", 20, 0, -3)
    assert labels(findings) == []
    # Off its circle: the row stays, and the check of arcs tells it (test_din_plain.py).
    trace, findings = run(["G02 X10 I5.01 J0 F100"])
    assert moves(trace)[-1] == ("ARC", 10, 0, 0) and labels(findings) == []
    assert labels(run(["G02 X10 I0 J0 F100"])[1]) == ["GP402"]
    assert labels(run(["G02 X10 F100"])[1]) == ["GP203"]
    assert labels(run(["G02 X10 I5 K1 F100"])[1]) == ["GP121"]


def test_a_centre_word_that_is_left_out() -> None:
    assert labels(run(["G02 X10 I5 F100"])[1]) == []
    assert labels(run(["G02 X10 Y10 I0 J10 F100", "G02 X20 I5"])[1]) == ["GP405"]
    assert labels(run(["G161", "G02 X10 I5 F100"])[1]) == ["GP405"]


def test_centres_and_planes_that_nobody_stated() -> None:
    some = machine(absolute_centers=None)
    assert labels(run(["G00 X10", "G02 X20 I5 J0 F100"], on=some)[1]) == ["GP405"]
    assert labels(run(["G02 X10 I5 J0 F100"], on=some)[1]) == []  # at zero both are one
    assert labels(run(["G91", "G00 X10", "G02 X10 I5 J0 F100"], on=some)[1]) == []
    assert labels(run(["G18", "G02 X10 I5 K0 F100"], on=machine(tools=()))[1]) == ["GP405"]
    assert labels(run(["G18", "G17", "G02 X10 I5 J0 F100"], on=machine(tools=()))[1]) == []


@pytest.mark.parametrize("seed", seeds(12, 30))
def test_words_of_a_cylinder_are_lengths(seed: int) -> None:
    rand = random.Random(seed)
    radius, unit = rand.uniform(1, 200), rand.choice([("G71", 1.0), ("G70", 25.4)])
    way, x, feed = rand.uniform(-300, 300), rand.uniform(-50, 50), rand.uniform(10, 900)
    move = f"G01 {word('X', x)} {word('C', way)} {word('F', feed)}"
    trace, findings = run([unit[0], f"G51 {word('C', radius)}", move, "G00 C90"])
    assert labels(findings) == []
    rows = trace.sections[0].rows
    fed = next(n for n in range(len(rows)) if rows["op"][n] == Op.FEED)
    angle = float(rows["to"][fed][5])
    assert math.isclose(2 * math.pi * radius * angle / 360.0, way, rel_tol=1e-9)
    # The row's feed is that of X alone: the whole way at F takes as long.
    seconds = math.hypot(way, x) / feed
    assert math.isclose(abs(x) * unit[1] / float(rows["feed"][fed]), seconds, rel_tol=1e-9)
    assert math.isclose(float(rows["to"][fed + 1][5]), 90.0)  # G00 counts in degrees


def test_feeds() -> None:
    def feeds(*lines: str, **din: object) -> tuple[list[float], list[str]]:
        trace, findings = run(list(lines), on=machine(**din))
        rows = trace.sections[0].rows
        return [float(rows["feed"][n]) for n in range(len(rows)) if rows["op"][n] == Op.FEED], labels(findings)

    assert feeds("G01 X1 F10", time_unit=1.0) == ([600.0], [])
    assert feeds("G94 G01 X1 F10", time_unit=1.0) == ([10.0], [])
    assert feeds("G70 G01 X1 F10") == ([254.0], [])
    assert feeds("G01 X1 F10", "G70", "G01 X5")[1] == ["GP204"]
    assert feeds("G01 X1 F10", "G71", "G01 X5") == ([10.0, 10.0], [])
    assert feeds("G01 X1")[1] == ["GP518"]
    assert feeds("G01 X1 F0")[1] == ["GP505"]
    assert feeds("G01 C10 F100")[1] == ["GP518"]
    assert feeds("F(0-5)")[1] == ["GP241"]
