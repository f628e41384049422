"""G38.2: the contact is anywhere on the segment; what follows rests on it. Manual 3.4.10, 3.1.1."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from passes.interpret.core.programs import labels, run, ways

from gproof.ir.trace import Op, Trace, Wait


def place(trace: Trace, section: int, row: int, axis: int) -> tuple[float, float]:
    """The range of an axis at a row."""
    s = trace.sections[section]
    low = high = float(s.rows["to"][row][axis])
    for symbol, coefficient in trace.frames[int(s.rows["frame"][row])][axis]:
        known = trace.symbols[symbol]
        ends = known.low * coefficient, known.high * coefficient
        low, high = low + min(ends), high + max(ends)
    return low, high


def test_the_contact_lies_on_the_segment(tmp_path: Path) -> None:
    trace, findings = run(tmp_path, "G0 Z5\nF50\nG38.2 Z-20\nG91 G0 Z3\nM30\n")
    assert labels(findings) == []
    assert [e.wait for s in trace.sections for e in s.edges] == [Wait.PROBE, Wait.END]
    first = trace.sections[0].rows
    assert Op(first["op"][-1]) is Op.PROBE and first["to"][-1][2] == -20.0 and first["feed"][-1] == 50.0
    assert place(trace, 1, 0, 2) == pytest.approx((-17.0, 8.0))


def test_zero_at_the_contact(tmp_path: Path) -> None:
    """G92 Z0 where the axis stands: what follows is known relative to that place, and only so."""
    trace, findings = run(tmp_path, "G0 Z5\nF50\nG38.2 Z-20\nG92 Z0\nG0 Z10\nG0 Z-2\nM30\n")
    assert "GP225" not in labels(findings)
    rows = trace.sections[1].rows
    moves = [i for i, op in enumerate(rows["op"].tolist()) if op == Op.TRAVERSE]
    assert [place(trace, 1, i, 2) for i in moves] == [pytest.approx((-10.0, 15.0)), pytest.approx((-22.0, 3.0))]


def test_probe_results_in_parameters(tmp_path: Path) -> None:
    """#5051 machine, #5061 work coordinates; #5067 says whether it touched: both are followed."""
    text = "G92 Z100\nG0 Z105\nF50\nG38.2 Z80\nif [#5067 == 1]\nG53 G0 Z#5053\nelse\nG0 Z#5063\nendif\nM30\n"
    trace, findings = run(tmp_path, text)
    assert "GP232" not in labels(findings)
    ranges = sorted(
        place(trace, s.number, i, 2)
        for s in trace.sections[1:]
        for i, op in enumerate(s.rows["op"].tolist())
        if op == Op.TRAVERSE
    )
    assert ranges == [pytest.approx((-20.0, 5.0)), pytest.approx((-20.0, 5.0))]


def test_middle_of_a_bore(tmp_path: Path) -> None:
    """Right wall at 10 ... 20, left wall at -20 ... -10 or anywhere between: the middle is bounded."""
    text = "F50\nG38.2 X20\n#1=#5061\nG0 X0\nG38.2 X-20\n#2=[[#1+#5061]/2]\nG0 X#2\nM30\n"
    trace, findings = run(tmp_path, text)
    assert labels(findings) == []
    last = trace.sections[-1]
    row = [i for i, op in enumerate(last.rows["op"].tolist()) if op == Op.TRAVERSE][-1]
    assert place(trace, last.number, row, 0) == pytest.approx((-10.0, 10.0))


@pytest.mark.parametrize(
    ("lines", "code"),
    [
        ("G0 Z5\nF50\nG38.2 Z4.8\n", "GP291"),
        ("G20\nF50\nG38.2 Z0.0099\n", "GP291"),
        ("G93\nG38.2 Z-20 F2\n", "GP292"),
        ("F50\nG38.2 Z-20 A5\n", "GP293"),
        ("F50\nG38.2 A0\n", "GP294"),
        ("F50\nG38.2\n", "GP201"),
        ("G38.2 Z-20\n", "GP204"),
    ],
)
def test_errors(tmp_path: Path, lines: str, code: str) -> None:
    """3.4.10.1, "It is an error if"."""
    _, findings = run(tmp_path, lines + "M30\n")
    assert labels(findings) == [code]


def test_just_long_enough(tmp_path: Path) -> None:
    assert labels(run(tmp_path, "F50\nG38.2 Z-0.254 A0\nM30\n")[1]) == []


def test_machine_coordinates(tmp_path: Path) -> None:
    """3.4.10.1: with G53 the point is in machine coordinates."""
    trace, findings = run(tmp_path, "G92 Z100\nF50\nG53 G38.2 Z-20\nM30\n")
    assert labels(findings) == []
    probe = [
        tuple(r)
        for o, r in zip(*(trace.sections[0].rows[c].tolist() for c in ("op", "to")), strict=True)
        if o == Op.PROBE
    ]
    assert probe[0][2] == -20.0


def test_render_runs_to_the_end(tmp_path: Path) -> None:
    """3.1.1: when the controller draws, a probe move always ends at its end point."""
    trace, _ = run(tmp_path, "F50\nG38.2 Z-20\nG0 X#5063 Y#5067\nM30\n", render=True)
    assert ways(trace)[0][-1] == ("traverse", (-20.0, 1.0, -20.0))


def test_any_contact_is_inside_the_told_range(tmp_path: Path) -> None:
    """Random segments and contacts: the run with the contact as a programmed place ends inside the ranges."""
    rng = random.Random(7)
    for _ in range(25):
        start, end = [rng.uniform(-9, 9) for _ in range(3)], [rng.uniform(-9, 9) for _ in range(3)]
        offset = rng.uniform(-5, 5)
        way = f"G92.1\nG0 X{start[0]:.4f} Y{start[1]:.4f} Z{start[2]:.4f}\nF50\n"
        after = f"G92 X{offset:.3f}\nG91 G0 X2 Z1\nG90 G0 X[#5061 * 2] Y3\nM30\n"
        trace, _ = run(tmp_path, way + f"G38.2 X{end[0]:.4f} Y{end[1]:.4f} Z{end[2]:.4f}\n" + after)
        last = trace.sections[-1]
        moves = [i for i, op in enumerate(last.rows["op"].tolist()) if op == Op.TRAVERSE]
        for t in (0.0, 0.3, 1.0):
            contact = [round(a, 4) + t * (round(b, 4) - round(a, 4)) for a, b in zip(start, end, strict=True)]
            text = way + "G1 " + " ".join(f"{n}{v:.12f}" for n, v in zip("XYZ", contact, strict=True)) + "\n"
            text += after.replace("#5061", f"{contact[0]:.12f}")
            straight, _ = run(tmp_path, text.replace("[-", "[0 - "))
            for (_, to), row in zip(ways(straight)[0][-2:], moves, strict=True):
                for axis in range(3):
                    low, high = place(trace, last.number, row, axis)
                    assert low - 1e-6 <= to[axis] <= high + 1e-6


def test_summary_shows_all_the_places_a_contact_may_mean(tmp_path: Path) -> None:
    from support.judging import judged

    job = tmp_path / "job.cnc"
    job.write_text("G21 G17 G90 G94 G54\nG0 Z5\nF50\nG38.2 Z-20\nG0 X1\nG91 G0 Z3\nM30\n")
    box = judged(job, None, "zero").summary.box
    assert ("x", "", 0.0, 1.0) in box
    assert ("z", "", -20.0, 8.0) in box


def test_the_setup_bounds_contacts(tmp_path: Path) -> None:
    """A touch plate whose height is about known: contact within it, the axis between it and the start."""
    import dataclasses

    from gproof.ir.setup import ZERO, Interval

    setup = dataclasses.replace(ZERO, parameter_ranges={5053: Interval(-4.0, -3.0)})
    trace, _ = run(tmp_path, "G0 Z5\nF50\nG38.2 Z-20\nG53 G0 Z#5053\nG0 X1\nM30\n", setup=setup)
    first = trace.symbols["probe.1.z"]
    assert (5 + first.low, 5 + first.high) == pytest.approx((-4.0, -3.0))
    rest = trace.symbols["probe.2.z"]
    assert (5 + rest.low, 5 + rest.high) == pytest.approx((-4.0, 5.0))
    assert place(trace, 1, 0, 2) == pytest.approx((-4.0, -3.0))
