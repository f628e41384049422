"""G68 rotation and G51 scaling (manual 3.4.18, 3.4.13) against complex numbers; diameters (2.1.14).

The rule that everything here rests on: a program under G68 R X Y and G51 P I J traces the points that it would
trace without them, turned and scaled about the point, in coordinates of the active system.
"""

from __future__ import annotations

import cmath
import dataclasses
import math
import random
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from support.campaigns import examples

from gproof.driver.running import begin, execute
from gproof.frontend.eding.load import load_program
from gproof.ir.finding import Findings, Severity
from gproof.ir.machine import NO_MACHINE, Controller, Machine
from gproof.ir.setup import NOTHING, ZERO, InForce, Interval, Setup
from gproof.ir.text import print_ir
from gproof.ir.trace import Op, Trace, chunks
from gproof.passes.checks.limits.soft_limits import Limits
from gproof.passes.interpret.core.plane_transform import cos_sin

HEAD = "G21 G17 G90 G94 G54 G40 G49 G80\nF500 S1000\n"
RANDOM = examples(30, 400, suppress_health_check=list(HealthCheck))
LATHE = dataclasses.replace(NO_MACHINE, controller=Controller(diameter_programming=True))
FIXTURE = dataclasses.replace(
    ZERO, work={(1, "x"): Interval(100.0, 100.0), (1, "y"): Interval(-40.0, -40.0), (1, "z"): Interval(7.0, 7.0)}
)


def run(folder: Path, text: str, setup: Setup = ZERO, machine: Machine = NO_MACHINE) -> tuple[Trace, Findings]:
    job = folder / "job.cnc"
    job.write_text(text)
    findings = Findings()
    program = load_program(job, findings)
    assert program is not None
    trace = execute(program, setup, machine, findings)
    trace.verify()
    return trace, findings


def codes_of(findings: Findings) -> list[str]:
    return [f.code.label for f in findings.kept if f.code.severity in (Severity.ERROR, Severity.UNKNOWN)]


def motions(trace: Trace) -> list[dict[str, object]]:
    """The moving rows, X and Y as one complex number."""
    out = []
    for section in trace.sections:
        r = section.rows
        for i in np.flatnonzero(r["op"] < Op.DWELL).tolist():
            to, center = r["to"][i].tolist(), r["center"][i].tolist()
            out.append({
                "op": int(r["op"][i]), "at": complex(to[0], to[1]), "rest": to[2:], "line": int(r["line"][i]),
                "center": complex(center[0], center[1]), "turns": int(r["turns"][i]), "feed": float(r["feed"][i]),
            })  # fmt: skip
    return out


def unknown(trace: Trace) -> list[str]:
    """For each moving row the axes of X Y Z of which nothing is known."""
    out = []
    for section in trace.sections:
        r = section.rows
        for i in np.flatnonzero(r["op"] < Op.DWELL).tolist():
            frame = trace.frames[int(r["frame"][i])]
            out.append("".join(n for n, form in zip("XYZ", frame, strict=False) if form == (("?", 1),)))
    return out


# --- worked out by hand -------------------------------------------------------------------------------------

CASES = {
    # a quarter turn about the origin: X10 becomes Y10; the Y left out is the program's, 0
    "quarter": ("G0 X0 Y0\nG68 R90 X0 Y0\nX10\nG69\nX1\n", [(0, 0), (0, 10), (1, 10)]),
    # half a turn about 10,5: (0,0) is (20,10)
    "point": ("G0 X0 Y0\nG68 R180 X10 Y5\nX0 Y0\n", [(0, 0), (20, 10)]),
    # clockwise is negative
    "clockwise": ("G0 X0 Y0\nG68 R-90 X0 Y0\nX10 Y3\n", [(0, 0), (3, -10)]),
    # 36.869...: the 3-4-5 triangle
    "oblique": (f"G0 X0 Y0\nG68 R{math.degrees(math.atan2(3, 4))} X0 Y0\nX5\nY5\n", [(0, 0), (4, 3), (1, 7)]),
    # increments turn too; the machine point at which G68 stands does not move
    "incremental": ("G0 X7 Y8\nG68 R90 X0 Y0\nG91 X2\nY1\nG90 X0 Y0\n", [(7, 8), (7, 10), (6, 10), (0, 0)]),
    # machine coordinates are not turned; behind them the words left out are where the axes then stand
    "g53": ("G0 X0 Y0\nG68 R90 X0 Y0\nG53 G0 X3 Y4\nX5\n", [(0, 0), (3, 4), (3, 5)]),
    # Z alone moves Z alone, to the last bit
    "z": ("G0 X0.1 Y0.2\nG68 R33 X1 Y1\nZ5\n", [(0.1, 0.2), (0.1, 0.2)]),
    # uniform scaling about 10,10: (20,0) is (30,-10)
    "scale": ("G0 X0 Y0\nG51 P2 I10 J10\nX20\nY0\nG50\nX20\n", [(0, 0), (30, 0), (30, -10), (20, -10)]),
    "scale-xy": ("G0 X0 Y0\nG51 X2 Y-1 I0 J0\nX20 Y3\n", [(0, 0), (40, -3)]),
    # both about one point: (12,10) is 2 right of it, scaled 4, turned up
    "both": ("G0 X0 Y0\nG68 R90 X10 Y10\nG51 P2\nX12 Y10\nG69\nX12\n", [(0, 0), (10, 14), (14, 14)]),
    "both-stated": ("G0 X0 Y0\nG51 P2 I10 J10\nG68 R90 X10 Y10\nX12 Y10\nG50\nX12 Y10\n", [(0, 0), (10, 14), (10, 12)]),
    # G68 on a line of its own is no motion, though G0 is in force
    "suspends": ("G0 X1 Y1\nG68 X5 Y5 R0\nX2\n", [(1, 1), (2, 1)]),
    "inch": ("G0 X0 Y0\nG20\nG68 R180 X1 Y0\nG0 X0 Y0\n", [(0, 0), (50.8, 0)]),
    # G28 by way of a turned point, then to the park position, which is the machine's
    "park": ("#5161=1 #5162=2\nG0 X0 Y0\nG68 R90 X0 Y0\nG28 X5 Y0\n", [(0, 0), (0, 5), (1, 2)]),
    # the angle may be any number
    "turns": ("G0 X0 Y0\nG68 R810 X0 Y0\nX10 Y0\n", [(0, 0), (0, 10)]),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_moves_worked_out_by_hand(name: str, tmp_path: Path) -> None:
    text, expected = CASES[name]
    trace, findings = run(tmp_path, HEAD + text + "M30\n")
    assert codes_of(findings) == []
    got = [m["at"] for m in motions(trace)]
    assert np.allclose(got, [complex(*p) for p in expected], atol=1e-12)


def test_quarter_turns_are_exact(tmp_path: Path) -> None:
    trace, _ = run(tmp_path, HEAD + "G0 X0 Y0\nG68 R-270 X0 Y0\nX0.1 Y0.7\nM30\n")
    assert motions(trace)[-1]["at"] == complex(-0.7, 0.1)
    assert [cos_sin(a) for a in (-90.0, 720.0, 180.0, 1e9 * 360 + 90)] == [(0, -1), (1, 0), (-1, 0), (0, 1)]


def test_arcs_turn_with_the_program(tmp_path: Path) -> None:
    """A counter-clockwise quarter about 0,0 from 10,0; turned by 90 it runs from 0,10 to -10,0; scaled it doubles."""
    arc = "G0 X10 Y0\nG3 X0 Y10 {}\nM30\n"
    for words in ("I-10", "R10"):
        trace, findings = run(tmp_path, HEAD + "G68 R90 X0 Y0\nG51 P2 I0 J0\n" + arc.format(words))
        assert codes_of(findings) == []
        row = motions(trace)[-1]
        assert np.allclose([row["at"], row["center"]], [-20, 0], atol=1e-12)
        assert row["turns"] == 1


def test_a_negative_factor_is_half_a_turn(tmp_path: Path) -> None:
    trace, findings = run(tmp_path, HEAD + "G51 P-1 I0 J0\nG0 X10 Y0\nG3 X0 Y10 R10\nM30\n")
    assert codes_of(findings) == []
    row = motions(trace)[-1]
    assert (row["op"], row["turns"]) == (Op.ARC, 1)
    assert np.allclose([row["at"], row["center"]], [-10j, 0], atol=1e-12)


def test_unknown_offsets_stay_what_they_are(tmp_path: Path) -> None:
    """The offset is not turned: positions keep the sum of unknown offsets, at any angle."""
    for angle in (30, 90):
        trace, findings = run(tmp_path, HEAD + f"G0 X1 Y2\nG68 R{angle} X0 Y0\nX3 Y4\nX7\nM30\n", NOTHING)
        assert codes_of(findings) == []
        rows = trace.sections[0].rows
        frames = {trace.frames[f][:2] for f in rows["frame"][rows["op"] == Op.TRAVERSE].tolist()}
        assert frames == {((("g92.x", 1), ("work.1.x", 1)), (("g92.y", 1), ("work.1.y", 1)))}
        assert (
            abs(
                motions(trace)[-1]["at"]
                - 7 * cmath.rect(1, math.radians(angle))
                - 4 * cmath.rect(1, math.radians(angle + 90))
            )
            < 1e-12
        )  # type: ignore[operator]


def test_a_word_left_out_needs_to_know_where_the_axis_is(tmp_path: Path) -> None:
    """At 30 degrees X3 alone moves both axes by where Y is, which nobody said; at 90 it moves Y alone, to 3."""
    trace, _ = run(tmp_path, HEAD + "G68 R30 X0 Y0\nG0 X3\nM30\n", NOTHING)
    assert unknown(trace) == ["XY"]
    trace, _ = run(tmp_path, HEAD + "G68 R90 X0 Y0\nG0 X3\nM30\n", NOTHING)
    assert unknown(trace) == [""]
    frame = trace.frames[trace.sections[0].rows["frame"][-1]]
    assert frame[:2] == ((("start.x", 1),), (("g92.y", 1), ("work.1.y", 1)))


def test_positions_read_under_a_rotation(tmp_path: Path) -> None:
    """#5001 and #5002 are program coordinates, #5071 and #5072 the machine's (3.1.1)."""
    text = (
        "G0 X0 Y0\nG68 R90 X5 Y0\nX1 Y2\n#1=#5001 #2=#5002 #3=#5071 #4=#5072\nG69\nG53 G0 X#1 Y#2\nG53 X#3 Y#4\nM30\n"
    )
    trace, findings = run(tmp_path, HEAD + text, FIXTURE)
    assert codes_of(findings) == []
    at = [m["at"] for m in motions(trace)]
    there = complex(100, -40) + 5 + (complex(1, 2) - 5) * 1j
    assert np.allclose(at[1:], [there, complex(1, 2), there], atol=1e-12)


# --- findings -----------------------------------------------------------------------------------------------

REFUSED = {
    # "It is an error if a required item is omitted" (3.4)
    "G68 X1 Y1": "GP275",
    "G51 I0 J0": "GP275",
    "G51 P2": "GP275",
    "G51 X2 I0 J0": "GP275",
    "G51 P0 I0 J0": "GP278",
    "G51 X1 Y0 I0 J0": "GP278",
    "G68 R30 X0 Y0 Z1": "GP121",
    "G68 R30 X0 Y0 K1": "GP121",
    "G0 G68 R30 X0 Y0": "GP224",
    "G68 R30 X0 Y0 G51 P2 I0 J0": "GP224",
    "G68 R30 X0 Y0 G28": "GP224",
    "G68 R30 X0 Y0 G69": "GP110",
    # open in the manual
    "G68 R30": "GP276",
    "G68 R30 X1": "GP276",
    "G68 R30 X0 Y0 G4 P1": "GP276",
    "G68 R30 X0 Y0 G64 R2": "GP109",
    "G51 P2 I0 J0 M54": "GP276",
    "G51 P2 I0 J0 M26": "GP276",
    "G51 P2 I0 J0 M56": "GP276",
    "G51 P2 X1 Y1 I0 J0": "GP276",
    "G68 R#200 X0 Y0": "GP276",
}  # fmt: skip


@pytest.mark.parametrize("line", REFUSED)
def test_what_is_no_rotation_or_scaling(line: str, tmp_path: Path) -> None:
    setup = dataclasses.replace(ZERO, default_parameter=None)
    _, findings = run(tmp_path, HEAD + f"G0 X1 Y1\n{line}\nM30\n", setup)
    assert codes_of(findings) == [REFUSED[line]]


OPEN = {
    "incremental": "G91\nG68 R30 X0 Y0\nG90\nG0 X1 Y1",
    "units beside it": "G20 G68 R30 X1 Y0\nG0 X1 Y1",
    "another point": "G68 R30 X0 Y0\nG68 R40 X1 Y0\nG0 X1 Y1",
    "another point for the scale": "G68 R30 X0 Y0\nG51 P2 I1 J0\nG0 X1 Y1",
    "order of both": "G68 R30 X0 Y0\nG51 X2 Y1\nG0 X1 Y1",
    "another system": "G10 L2 P2 X5\nG68 R30 X0 Y0\nG55\nG0 X1 Y1",
    "again in another system": "G10 L2 P2 X5\nG68 R30 X0 Y0\nG55\nG68 R40 X0 Y0\nG0 X1 Y1",
    "the scale in another system": "G10 L2 P2 X5\nG68 R0 X0 Y0\nG55\nG51 P2\nG0 X1 Y1",
    "the same numbers in another system": "G10 L2 P2 X5\nG51 P2 I0 J0\nG55\nG68 R9 X0 Y0\nG0 X1 Y1",
    "an offset that moves": "G68 R30 X0 Y0\nG10 L2 P1 X5\nG0 X1 Y1",
    "G92": "G68 R30 X0 Y0\nG92 X5\nG0 X1 Y1",
    "G10 L20": "G68 R30 X0 Y0\nG10 L20 P1 Y5\nG0 X1 Y1",
    "the end beside words": "G68 R30 X0 Y0\nG0 G69 X1 Y1",
}


@pytest.mark.parametrize("name", OPEN)
def test_what_the_manual_leaves_open_is_unknown_until_it_is_off(name: str, tmp_path: Path) -> None:
    trace, findings = run(tmp_path, HEAD + f"G0 X1 Y1\n{OPEN[name]}\nG21\nG69\nG50\nG92.1\nG53 G0 X2 Y2\nG91 X1\nM30\n")
    assert codes_of(findings) == ["GP276"]
    assert unknown(trace)[1] == "XY"
    assert unknown(trace)[-2:] == ["", ""]
    assert motions(trace)[-1]["at"] == 3 + 2j


def test_what_a_g92_under_a_rotation_set_stays_unknown(tmp_path: Path) -> None:
    for line in ("G92 X5", "G10 L20 P1 X5"):
        trace, _ = run(tmp_path, HEAD + f"G0 X1 Y1\nG68 R30 X0 Y0\n{line}\nG69\nG0 X0 Y0\nM30\n")
        assert unknown(trace)[-1] == "XY"


def test_the_same_system_again_changes_nothing(tmp_path: Path) -> None:
    trace, findings = run(tmp_path, HEAD + "G0 X1 Y1\nG68 R90 X0 Y0\nG54\nG92 Z0\nX1 Y0\nG55 G0 Z1\nG54\nX2\nM30\n")
    assert codes_of(findings) == []
    assert motions(trace)[-1]["at"] == 2j


def test_no_arcs_under_unequal_factors(tmp_path: Path) -> None:
    """3.4.13: "only applicable when NO Arcs"."""
    for words in ("I-10", "R10"):
        _, findings = run(tmp_path, HEAD + f"G51 X1 Y2 I0 J0\nG0 X10 Y0\nG3 X0 Y10 {words}\nM30\n")
        assert codes_of(findings) == ["GP277"]


def test_other_planes(tmp_path: Path) -> None:
    """Table 3-3 calls it a rotation of X and Y: arcs and cycles elsewhere are not known."""
    text = "G68 R30 X0 Y0\nG0 X0 Y10 Z0\nG18\nG2 X10 Z0 R10\nG19 G81 X-5 R1 Y0\nM30\n"
    _, findings = run(tmp_path, HEAD + text)
    assert codes_of(findings) == ["GP405", "GP276"]


def test_arc_tolerance_is_the_stricter_one(tmp_path: Path) -> None:
    """0.0015 mm apart: allowed as written (3.4.3.2: 0.002), 0.003 when doubled; 0.003 is not, though halved."""
    for off, factor, allowed in ((0.0015, 1.0, True), (0.0015, 2.0, False), (0.003, 0.5, False)):
        text = f"G51 P{factor} I0 J0\nG0 X10 Y0\nG3 X0 Y{10 + off} I-10\nM30\n"
        trace, _ = run(tmp_path, HEAD + text)
        rows = trace.sections[0].rows
        row = int(np.flatnonzero(rows["op"] == Op.ARC)[0])
        apart = abs(abs(motions(trace)[-1]["at"]) - 10 * factor)  # type: ignore[arg-type]
        assert (apart <= trace.states[rows["state"][row]].arc_tolerance) is allowed


# --- any program, against the definition ----------------------------------------------------------------------


def random_lines(rng: random.Random, *, arcs: bool = True, cycles: bool = True, bracketed: bool = False) -> list[str]:
    """Lines, arcs, cycles, in G90 and G91, words left out, on a grid and off it."""
    at = complex(rng.randint(-9, 9), rng.randint(-9, 9))
    lines = [f"G0 X{at.real:.4f} Y{at.imag:.4f}"]
    absolute = True

    def words(to: complex, some: bool = True) -> str:
        nonlocal at
        keep = rng.choice("XYB") if some else "B"
        x = to.real if keep in "XB" else at.real
        y = to.imag if keep in "YB" else at.imag
        x, y = round(x, 4), round(y, 4)
        out = []
        if keep in "XB":
            out.append(f"X{x if absolute else x - at.real:.4f}")
        if keep in "YB":
            out.append(f"Y{y if absolute else y - at.imag:.4f}")
        at = complex(x, y)
        return " ".join(out)

    for _ in range(rng.randint(2, 14)):
        kind = rng.choice(["line", "line", "arc", "radius", "mode", "z", "full", "cycle", "rotary"])
        to = complex(rng.uniform(-30, 30), rng.uniform(-30, 30))
        if kind == "line":
            lines.append(f"G{rng.choice('01')} {words(to)}" + rng.choice(["", f" Z{rng.randint(-5, 5)}"]))
        elif kind == "rotary":
            lines.append(f"G1 {words(to)} A{rng.randint(0, 9)}")
        elif kind == "z":
            lines.append(f"G1 Z{rng.randint(-5, 5)}")
        elif kind == "mode":
            absolute = not absolute
            lines.append("G90" if absolute else "G91")
        elif kind == "cycle":
            if absolute and cycles:
                lines += [f"G81 {words(to)} Z-3 R2", words(to + 1), "G80"]
        elif arcs and kind == "full":
            lines.append(f"G{rng.choice('23')} {words(at, False)} I{to.real:.4f} J{to.imag:.4f}")
        elif arcs:
            center = at + cmath.rect(rng.uniform(1, 9), rng.uniform(-3, 3))
            i, j = round(center.real - at.real, 4), round(center.imag - at.imag, 4)
            radius = abs(complex(i, j))
            begin = at
            end = at + complex(i, j) + cmath.rect(radius, rng.uniform(-3, 3))
            code = f"G{rng.choice('23')} {words(end, False)}"
            if kind == "arc":
                lines.append(f"{code} I{i:.4f} J{j:.4f}")
            else:
                lines.append(f"{code} R{max(radius, abs(at - begin) / 2 * 1.001):.4f}")
    if bracketed:
        lines = [" ".join(w if w[0] == "G" else f"{w[0]}[{w[1:]}]" for w in line.split()) for line in lines]
    return lines


def mapped(m: dict[str, object], turn: complex, point: complex, origin: complex, factor: float) -> dict[str, object]:
    to_machine = lambda z: origin + point + factor * turn * (z - origin - point)  # noqa: E731
    arc = m["op"] == Op.ARC
    return m | {"at": to_machine(m["at"]), "center": to_machine(m["center"]) if arc else m["center"]}


@RANDOM
@given(
    st.integers(0, 10**9), st.one_of(st.floats(-400, 400), st.sampled_from([0.0, 30.0, 45.0, 90.0, 180.0, -90.0])),
    st.integers(-20, 20), st.integers(-20, 20), st.sampled_from([1.0, 1.0, 2.0, 0.5, -1.5]), st.booleans(),
)  # fmt: skip
def test_a_program_under_a_transform_is_the_program_transformed(
    tmp_path: Path, seed: int, angle: float, x: int, y: int, factor: float, fixture: bool
) -> None:
    lines = random_lines(random.Random(seed))
    body = "\n".join(lines) + "\nM30\n"
    on = f"G68 R{angle:.9f} X{x} Y{y}\n" + (f"G51 X{factor} Y{factor} I{x} J{y}\n" if factor != 1.0 else "")
    setup, origin = (FIXTURE, complex(100, -40)) if fixture else (ZERO, 0j)
    plain, told = run(tmp_path, HEAD + body, setup)
    turned, told_turned = run(tmp_path, HEAD + on + body, setup)
    shift = on.count("\n")
    turn = cmath.rect(1, math.radians(round(angle, 9)))
    want = [mapped(m, turn, complex(x, y), origin, factor) for m in motions(plain)]
    got = motions(turned)
    assert codes_of(told) == codes_of(told_turned) == []
    assert [(m["op"], m["turns"], m["line"]) for m in got] == [(m["op"], m["turns"], m["line"] + shift) for m in want]  # type: ignore[operator]
    for key in ("at", "center"):
        assert np.allclose([m[key] for m in got], [m[key] for m in want], atol=1e-9), lines
    assert [m["rest"] for m in got] == [m["rest"] for m in want]
    assert np.allclose([m["feed"] for m in got], [m["feed"] for m in want])


@RANDOM
@given(st.integers(0, 10**9), st.sampled_from([(2.0, 0.5), (-1.0, 1.0), (3.0, -2.0)]), st.sampled_from([0, 180]))
def test_unequal_factors(tmp_path: Path, seed: int, factors: tuple[float, float], angle: int) -> None:
    body = "\n".join(random_lines(random.Random(seed), arcs=False)) + "\nM30\n"
    on = f"G68 R{angle} X3 Y4\nG51 X{factors[0]} Y{factors[1]} I3 J4\n"
    plain, _ = run(tmp_path, HEAD + body)
    turned, told = run(tmp_path, HEAD + on + body)
    assert codes_of(told) == []
    sign = -1 if angle else 1
    for before, after in zip(motions(plain), motions(turned), strict=True):
        away = before["at"] - (3 + 4j)  # type: ignore[operator]
        want = (3 + 4j) + complex(sign * factors[0] * away.real, sign * factors[1] * away.imag)
        assert abs(after["at"] - want) < 1e-9  # type: ignore[operator]


@settings(deadline=None, max_examples=25, suppress_health_check=list(HealthCheck))
@given(st.integers(0, 10**9), st.sampled_from([30.0, 90.0, 180.0, -57.3]), st.sampled_from([1.0, 2.0, -0.3]))
def test_every_way_of_execution_gives_the_same_bits(tmp_path: Path, seed: int, angle: float, factor: float) -> None:
    """The compiled loop, the same loop in Python, and line by line (expressions are no plain lines)."""
    on = f"G68 R{angle} X3.3 Y-1.7\nG51 X{factor} Y{factor} I3.3 J-1.7\n"
    traces = []
    for mode, bracketed in (("python", False), ("numba", False), ("python", True)):
        lines = random_lines(random.Random(seed), bracketed=bracketed)
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("GPROOF_KERNELS", mode)
            trace, told = run(tmp_path, HEAD + on + "\n".join(lines) + "\nM30\n", FIXTURE)
        assert codes_of(told) == []
        traces.append(print_ir(trace))
    assert traces[0] == traces[1]
    assert traces[0] == traces[2]


@settings(deadline=None, max_examples=15, suppress_health_check=list(HealthCheck))
@example(10111954, True)  # an inch feed to where the axes are: no rotary move, so its feed is a length
@given(st.integers(0, 10**9), st.booleans())
def test_diameters_are_the_same_bits_in_every_way(tmp_path: Path, seed: int, inch: bool) -> None:
    traces = []
    for mode, bracketed in (("python", False), ("numba", False), ("python", True)):
        lines = random_lines(random.Random(seed), arcs=False, bracketed=bracketed)
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("GPROOF_KERNELS", mode)
            text = HEAD + ("G20\nF20\n" if inch else "") + "\n".join(lines) + "\nM30\n"
            trace, told = run(tmp_path, text, FIXTURE, LATHE)
        assert codes_of(told) == []
        traces.append(print_ir(trace))
    assert traces[0] == traces[1] == traces[2]


def test_extents_of_turned_arcs(tmp_path: Path) -> None:
    """The box of a turned half circle, beside that of many points on it."""
    half = np.array([20 + 10 * cmath.rect(1, math.pi * n / 3600) for n in range(3601)])
    for angle in range(0, 360, 23):
        trace, _ = run(tmp_path, HEAD + f"G68 R{angle} X5 Y6\nG51 P1.5\nG0 X30 Y0\nG3 X10 Y0 I-10\nM30\n")
        section = trace.sections[0]
        section.start = tuple(section.rows["to"][section.rows["op"] == Op.TRAVERSE][0].tolist())
        limits = Limits(NO_MACHINE, ZERO, Findings())
        for chunk in chunks(trace):
            limits.feed(chunk)
        box = {name: (low, high) for name, _, low, high in limits.box()}
        shape = 5 + 6j + 1.5 * cmath.rect(1, math.radians(angle)) * (half - (5 + 6j))
        left, low, right, high = shape.real.min(), shape.imag.min(), shape.real.max(), shape.imag.max()
        assert box["x"][0] <= left + 1e-9 and box["x"][1] >= right - 1e-9
        assert box["y"][0] <= low + 1e-9 and box["y"][1] >= high - 1e-9
        assert np.allclose([*box["x"], *box["y"]], [left, right, low, high], atol=1e-4)


# --- with cutter radius compensation ----------------------------------------------------------------------------


def contour(rng: random.Random) -> list[str]:
    """A convex polygon walked with the tool outside, words left out where they do not change."""
    count, radius = rng.randint(3, 7), rng.uniform(20, 40)
    corners = [cmath.rect(radius, 2 * math.pi * k / count) for k in range(count)]
    corners = [complex(round(c.real, 3), round(c.imag, 3)) for c in corners]
    along = (corners[1] - corners[0]) / abs(corners[1] - corners[0])
    begin = corners[0] - (30 - 8j) * along  # so that the first corner is convex
    lines = [f"G0 X{begin.real:.3f} Y{begin.imag:.3f}", "G42.1 D6", f"G1 X{corners[0].real} Y{corners[0].imag}"]
    lines += [f"G1 X{c.real} Y{c.imag}" for c in corners[1:]]
    return [*lines, "G40", "G0 Z9"]


@settings(deadline=None, max_examples=25, suppress_health_check=list(HealthCheck))
@given(st.integers(0, 10**9), st.floats(-360, 360), st.integers(-9, 9))
def test_a_compensated_contour_turns_as_a_whole(tmp_path: Path, seed: int, angle: float, x: int) -> None:
    body = "\n".join(contour(random.Random(seed))) + "\nM30\n"
    plain, told = run(tmp_path, HEAD + body)
    turned, told_turned = run(tmp_path, HEAD + f"G68 R{angle:.9f} X{x} Y3\n" + body)
    assert codes_of(told) == codes_of(told_turned) == []
    turn = cmath.rect(1, math.radians(round(angle, 9)))
    want = [mapped(m, turn, complex(x, 3), 0j, 1.0) for m in motions(plain)]
    got = motions(turned)
    assert [m["turns"] for m in got] == [m["turns"] for m in want]
    for key in ("at", "center"):
        assert np.allclose([m[key] for m in got], [m[key] for m in want], atol=1e-9)


def test_compensation_and_scaling_is_open(tmp_path: Path) -> None:
    """Whether the radius of the tool is scaled, and what a rotation within a contour does, the manual does not say."""
    contour = "G0 X50 Y0\nG41.1 D6\nG1 X20 Y0\nG1 X20 Y20\n{}G40\nM30\n"
    for before, within in (("G51 P2 I0 J0\n", ""), ("", "G68 R30 X0 Y0\n"), ("G68 R30 X0 Y0\n", "G69\n")):
        _, findings = run(tmp_path, HEAD + before + contour.format(within))
        assert codes_of(findings) == ["GP276"]


# --- diameters (2.1.14, 3.4.11.2) -----------------------------------------------------------------------------

BY_DIAMETER = "G18 G0 X-20 Z20\nG1 X-20 Z10\nG3 X0 Z0 {0}\nG1 X20\nG2 X40 Z-10 {1}\nG1 Z-20\nG3 X60 Z-30 {2}\n"
BY_RADIUS = "G18 G0 X-10 Z20\nG1 X-10 Z10\nG3 X0 Z0 {0}\nG1 X10\nG2 X20 Z-10 {1}\nG1 Z-20\nG3 X30 Z-30 {2}\n"


@pytest.mark.parametrize("words", [("R10", "R10", "R10"), ("I10 K0", "I0 K-10", "I10 K0")])
def test_a_contour_by_diameter_is_the_one_by_radius(words: tuple[str, str, str], tmp_path: Path) -> None:
    """The manual gives one contour in four ways: X halves, R and I are radii. Arcs: the half of each is a quarter."""
    # The first arc runs from x -10, z 10: with I10 its centre is 0, 10, and 0, 0 lies on it.
    first, told = run(tmp_path, HEAD + BY_DIAMETER.format(*words) + "M30\n", machine=LATHE)
    second, told_second = run(tmp_path, HEAD + BY_RADIUS.format(*words) + "M30\n")
    assert codes_of(told) == codes_of(told_second)
    assert [m | {"line": 0} for m in motions(first)] == [m | {"line": 0} for m in motions(second)]


DIAMETERS = {
    "absolute and incremental": ("G0 X20\nG91 X10\nG90 X0\n", [10, 15, 0]),
    "inch": ("G20\nG0 X1\n", [12.7]),
    "g53": ("G0 X20\nG53 G0 X30\n", [10, 15]),
    "g92 makes the present point the diameter given": ("G0 X20\nG92 X0\nG0 X10\n", [10, 15]),
    "g10 l20": ("G0 X20\nG10 L20 P1 X0\nG0 X10\n", [10, 15]),
    "#5001 is what an X word would be": ("G0 X20\nG0 X[#5001+2]\nG53 G0 X#5071\n", [10, 11, 11]),
    "g28": ("#5161=7\nG0 X20\nG28\n", [10, 7]),
    "scale of one axis only": ("G0 X20 Y4\n", [10]),
}


@pytest.mark.parametrize("name", DIAMETERS)
def test_diameters(name: str, tmp_path: Path) -> None:
    text, expected = DIAMETERS[name]
    for bracketed in (False, True):
        body = text.replace("X20", "X[20]") if bracketed else text
        trace, findings = run(tmp_path, HEAD + body + "M30\n", machine=LATHE)
        assert codes_of(findings) == []
        assert np.allclose([m["at"].real for m in motions(trace)], expected, atol=1e-12)  # type: ignore[attr-defined]


def test_what_nobody_knows_of_diameters(tmp_path: Path) -> None:
    absolute = dataclasses.replace(LATHE, controller=Controller(diameter_programming=True, absolute_arc_centers=True))
    cases = (
        ("G18 G0 X20 Z0\nG3 X0 Z10 I10 K10\n", absolute, "GP405"),
        ("G68 R30 X0 Y0\n", LATHE, "GP276"),
        ("G19 G81 X-5 R1 Y0\n", LATHE, "GP113"),
    )
    for text, machine, code in cases:
        _, findings = run(tmp_path, HEAD + text + "M30\n", machine=machine)
        assert codes_of(findings) == [code]


def test_a_rotation_that_was_there_before_is_an_assumption(tmp_path: Path) -> None:
    """2.2.4.3: the zeroing menu measures how the work lies and leaves a G68; only G69 takes it away."""
    said = "no rotation (G68) and no scaling (G51) is active at the start"
    cases = (
        (HEAD + "G0 X1\n", NOTHING, [said]),
        (HEAD + "G68 R30 X0 Y0\nG51 P2\nG0 X1 Y1\n", NOTHING, [said]),
        ("G69 G50\n" + HEAD + "G0 X1\n", NOTHING, []),
        ("G69\n" + HEAD + "G0 X1\n", NOTHING, ["no scaling (G51) is active at the start"]),
        (HEAD + "G0 X1\n", ZERO, []),
    )
    for text, setup, expected in cases:
        job = tmp_path / "job.cnc"
        job.write_text(text + "M30\n")
        program = load_program(job, Findings())
        assert program is not None
        executor = begin(program, setup, NO_MACHINE, Findings())
        list(executor.chunks())
        assert [text for text in executor.assumed if "start" in text] == expected


# --- in force when the job begins (setup) ---------------------------------------------------------------------

IN_FORCE = [
    (InForce(angle=30.0, x=5.0, y=-2.0), "G68 R30 X5 Y-2"),
    (InForce(angle=-90.0, factor_x=1.0, factor_y=1.0, x=5.0), "G68 R-90 X5 Y0"),
    (InForce(angle=0.0, factor_x=2.0, factor_y=2.0, y=3.0), "G51 P2 I0 J3"),
    (InForce(factor_x=-1.0, factor_y=3.0, x=4.0, y=3.0), "G51 X-1 Y3 I4 J3"),
    (InForce(angle=400.0, factor_x=0.5, factor_y=0.5, x=1.0, y=1.0), "G68 R40 X1 Y1\nG51 P0.5 I1 J1"),
]
BODY = "G0 X10 Y3 Z5\nG1 X20\nG91 Y4\nG90\nG0 Z7\nG1 X#5001 Y[#5002 + 1]\nG69 G50\nX1 Y1\nX3\n"


@pytest.mark.parametrize(("stated", "line"), IN_FORCE)
@pytest.mark.parametrize("setup", [ZERO, FIXTURE])
def test_what_the_setup_states_is_as_if_the_job_began_with_it(
    stated: InForce, line: str, setup: Setup, tmp_path: Path
) -> None:
    there, findings = run(tmp_path, f"{line}\nF500\n{BODY}", setup)
    assert codes_of(findings) == []
    here, findings = run(tmp_path, f"F500\n{BODY}", dataclasses.replace(setup, transform=stated))
    assert codes_of(findings) == []
    wanted, found = motions(there), motions(here)
    assert len(wanted) == len(found) == 7
    for one, other in zip(wanted, found, strict=True):
        assert (one["at"], one["rest"], one["feed"]) == (other["at"], other["rest"], other["feed"])


def test_what_is_stated_is_no_assumption(tmp_path: Path) -> None:
    def assumed(stated: InForce | None) -> str:
        job = tmp_path / "job.cnc"
        job.write_text("G0 X1 Y1\n")
        findings = Findings()
        program = load_program(job, findings)
        assert program is not None
        run = begin(program, dataclasses.replace(NOTHING, transform=stated), NO_MACHINE, findings)
        list(run.chunks())
        return " ".join(run.assumed)

    assert "no rotation (G68)" in assumed(None) and "no scaling (G51)" in assumed(None)
    assert "no scaling (G51)" in assumed(InForce(angle=0.0)) and "G68" not in assumed(InForce(angle=0.0))
    assert "G51" not in assumed(InForce(angle=0.0, factor_x=1.0, factor_y=1.0))


def test_other_offsets_than_at_the_start_leave_its_point_open(tmp_path: Path) -> None:
    setup = dataclasses.replace(FIXTURE, transform=IN_FORCE[0][0])
    trace, findings = run(tmp_path, "G0 X1 Y1\nG55\nG0 X2 Y2\nG69\nG0 X3 Y3\n", setup)
    assert codes_of(findings) == ["GP276"]
    assert unknown(trace) == ["", "XY", ""]


def test_stated_over_diameters_is_open_until_it_is_switched_off(tmp_path: Path) -> None:
    setup = dataclasses.replace(ZERO, transform=IN_FORCE[0][0])
    trace, findings = run(tmp_path, "G0 Z1\nG0 X1 Y1\nG69\nG0 X3 Y3\n", setup, LATHE)
    assert codes_of(findings) == ["GP276"]
    assert unknown(trace) == ["", "XY", ""]
    _, findings = run(tmp_path, "G69\nG0 X3 Y3\n", setup, LATHE)
    assert codes_of(findings) == []
