"""Execution against results worked out by hand from the manual (sections in each case's name or comment)."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from gproof.driver.running import execute
from gproof.frontend.eding.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.machine import NO_MACHINE, Controller
from gproof.ir.setup import NOTHING, ZERO, Setup
from gproof.ir.trace import Op, Trace, Wait

Moves = list[tuple[str, float, float, float]]


def run(tmp_path: Path, text: str, setup: Setup = ZERO) -> tuple[Trace, Findings]:
    job = tmp_path / "job.cnc"
    job.write_text(text)
    findings = Findings()
    program = load_program(job, findings)
    assert program is not None
    program.verify()
    trace = execute(program, setup, NO_MACHINE, findings)
    trace.verify()
    return trace, findings


def moves(trace: Trace) -> Moves:
    out = []
    for section in trace.sections:
        for op, to in zip(section.rows["op"].tolist(), section.rows["to"].tolist(), strict=True):
            if op < Op.DWELL:
                out.append((Op(op).name.lower(), *(round(v, 6) + 0.0 for v in to[:3])))
    return out


def codes_of(findings: Findings) -> list[str]:
    return [f.code.label for f in findings.kept if f.code.label != "GP243"]


HEAD = "G21 G17 G90 G94 G54 G40 G49 G80\n"

CASES = {
    # 4.1: WHILE with a counter, three passes
    "while": (
        "#1 = 0\nwhile [#1 < 3]\nG0 X[#1 * 10]\n#1 = [#1 + 1]\nendwhile\nM30\n",
        [("traverse", 0, 0, 0), ("traverse", 10, 0, 0), ("traverse", 20, 0, 0)],
    ),
    # 4.1: IF, ELSE, nested
    "if-else": (
        "#1 = 5\nif [#1 > 3]\nif [#1 == 5]\nG0 X1\nelse\nG0 X2\nendif\nelse\nG0 X3\nendif\nM30\n",
        [("traverse", 1, 0, 0)],
    ),
    # 4.1: a sub is run where it is called, not where it stands; modal state stays
    "sub": (
        "sub corner\nG91\nG0 X5\nG90\nendsub\nG0 Y2\ngosub corner\ngosub corner\nX0\nM30\n",
        [("traverse", 0, 2, 0), ("traverse", 5, 2, 0), ("traverse", 10, 2, 0), ("traverse", 0, 2, 0)],
    ),
    # 3.2.3: the word reads the old value, the setting takes effect behind the line
    "setting-after-line": (
        "#3 = 15\n#3 = 6 G0 X#3\nY#3\nM30\n",
        [("traverse", 15, 0, 0), ("traverse", 15, 6, 0)],
    ),
    # 3.2.3: two settings of a line both read the old values (a swap)
    "swap": ("#1=3 #2=8\n#1=#2 #2=#1\nG0 X#1 Y#2\nM30\n", [("traverse", 8, 3, 0)]),
    # 3.2.2.2: ## and #[...]
    "indirect": ("#7=9\n#9=4\nG0 X##7 Y#[8+1]\nM30\n", [("traverse", 4, 4, 0)]),
    # 3.2.2.3: power first, then * / mod, then + -; left to right: 2+(2**3)*2 = 18; (7-2)-1 = 4
    "precedence": ("G0 X[2+2**3*2] Y[7-2-1] Z[7 mod 4 * 2]\nM30\n", [("traverse", 18, 4, 6)]),
    # 3.2.2.4: FIX down, FUP up, also below zero; ATAN of two; degrees
    "functions": (
        "G0 X[fix[-2.8]] Y[fup[-2.8]] Z[atan[1]/[1]]\nX[sin[30]] Y[round[2.6]] Z[abs[-4]]\nM30\n",
        [("traverse", -3, -2, 45), ("traverse", 0.5, 3, 4)],
    ),
    # 3.4.8: through the point, then every axis to the park position (parameters in machine mm)
    "park": (
        "#5161=1 #5162=2 #5163=3\nG0 X10 Y10 Z-5\nG28 Z5\nM30\n",
        [("traverse", 10, 10, -5), ("traverse", 10, 10, 5), ("traverse", 1, 2, 3)],
    ),
    # 3.4.21.4 with G98: pecks 4 and 4 and 2 from R 2 to -8; out to the clear position (old Z 10), back 0.254 above
    "peck-g98": (
        "F100\nG0 Z10\nG98 G83 X5 Y0 Z-8 R2 Q4\nG80\nM30\n",
        [
            ("traverse", 0, 0, 10), ("traverse", 5, 0, 10), ("traverse", 5, 0, 2), ("feed", 5, 0, -2),
            ("traverse", 5, 0, 10), ("traverse", 5, 0, -1.746), ("feed", 5, 0, -6), ("traverse", 5, 0, 10),
            ("traverse", 5, 0, -5.746), ("feed", 5, 0, -8), ("traverse", 5, 0, 10),
        ],
    ),
    # 3.4.21.2, second example of the manual in other numbers: G91 with L3, R above the start
    "cycle-g91-l": (
        "F100\nG0 X1 Y2 Z3\nG91 G81 G98 X2 Y1 Z-0.5 R1.5 L2\nG90 G80\nM30\n",
        [
            ("traverse", 1, 2, 3), ("traverse", 1, 2, 4.5), ("traverse", 3, 3, 4.5), ("feed", 3, 3, 4),
            ("traverse", 3, 3, 4.5), ("traverse", 5, 4, 4.5), ("feed", 5, 4, 4), ("traverse", 5, 4, 4.5),
        ],
    ),
    # 3.4.23: the current point gets the number; a second G92 adds to the first
    "g92": (
        "G0 X4\nG92 X7\nG0 X8\nG92 X9\nG0 X9\nG92.1\nG0 X0\nM30\n",
        [("traverse", 4, 0, 0), ("traverse", 5, 0, 0), ("traverse", 5, 0, 0), ("traverse", 0, 0, 0)],
    ),
    # 3.4.5: G10 L20 makes the current point the given one
    "g10-l20": (
        "G0 X30 Y40\nG10 L20 P1 X10 Y0\nG0 X0 Y0\nM30\n",
        [("traverse", 30, 40, 0), ("traverse", 20, 40, 0)],
    ),
    # 3.4.14: machine coordinates whatever the offsets, not modal
    "g53": (
        "G10 L2 P1 X100\nG0 X1\nG53 G0 X1\nX2\nM30\n",
        [("traverse", 101, 0, 0), ("traverse", 1, 0, 0), ("traverse", 102, 0, 0)],
    ),
    # 3.4.7: inches
    "inch": ("G20\nG0 X1 Y-0.5\nG21\nX1\nM30\n", [("traverse", 25.4, -12.7, 0), ("traverse", 1, -12.7, 0)]),
    # 3.2: spaces inside numbers, lower case
    "spaces": ("g0x +0. 12 34y 7\nm30\n", [("traverse", 0.1234, 7, 0)]),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_moves_worked_out_by_hand(name: str, tmp_path: Path) -> None:
    text, expected = CASES[name]
    trace, findings = run(tmp_path, HEAD + text)
    assert codes_of(findings) == []
    got = moves(trace)
    assert [m[0] for m in got] == [m[0] for m in expected]
    assert np.allclose([m[1:] for m in got], [m[1:] for m in expected], atol=1e-9)


def test_order_of_execution_on_a_crowded_line(tmp_path: Path) -> None:
    """3.7: speed, tool change, spindle, coolant, dwell, plane, units, distance, motion, stop."""
    trace, _ = run(tmp_path, HEAD + "M0 G1 X1 G91 G20 G18 G4 P2 M8 M3 M6 T5 S900 F10\nM30\n")
    rows = [Op(op) for s in trace.sections for op in s.rows["op"].tolist()]
    crowded = rows[rows.index(Op.TOOL_CHANGE) :]
    wanted = [Op.TOOL_CHANGE, Op.SPINDLE, Op.COOLANT, Op.DWELL, Op.PLANE, Op.UNITS, Op.FEED, Op.STOP]
    assert [op for op in crowded if op in wanted][: len(wanted)] == wanted
    feed = next(
        (s.rows["feed"][i], s.rows["to"][i][0])
        for s in trace.sections for i in range(len(s.rows)) if s.rows["op"][i] == Op.FEED
    )  # fmt: skip
    # F is taken in the old unit (mm), the word X in the new one.
    assert feed == (10.0, 25.4)


def test_waits_are_edges(tmp_path: Path) -> None:
    trace, _ = run(tmp_path, HEAD + "G0 X1\nM0\nG0 X2\nM6 T1\nG0 X3\nM30\n")
    assert [[e.wait for e in s.edges] for s in trace.sections] == [[Wait.OPERATOR], [Wait.TOOL_CHANGE], [Wait.END]]
    assert [s.edges[0].target for s in trace.sections] == [1, 2, -1]
    assert [s.start[0] for s in trace.sections] == [0.0, 1.0, 2.0]


def test_nothing_stated_is_unknown_never_zero(tmp_path: Path) -> None:
    trace, _ = run(tmp_path, HEAD + "G0 X5\nG91 X1\nG53 G90 X2\nM30\n", NOTHING)
    rows = trace.sections[0].rows
    frames = [trace.frames[f][0] for f, op in zip(rows["frame"], rows["op"], strict=True) if op == Op.TRAVERSE]
    work = (("g92.x", 1), ("work.1.x", 1))
    assert frames == [work, work, ()]
    assert trace.frames[rows["frame"][-1]][1] == (("start.y", 1),)


def test_a_g92_on_an_unknown_start_keeps_the_start(tmp_path: Path) -> None:
    """The current point gets 0; 10 further on is the start plus 10, wherever that was."""
    trace, _ = run(tmp_path, HEAD + "G92 X0\nG0 X10\nM30\n", NOTHING)
    rows = trace.sections[0].rows
    last = int(np.flatnonzero(rows["op"] == Op.TRAVERSE)[-1])
    assert trace.frames[rows["frame"][last]][0] == (("start.x", 1),)
    assert rows["to"][last][0] == 10.0


def test_unknown_parameter_in_motion_is_reported(tmp_path: Path) -> None:
    _, findings = run(tmp_path, HEAD + "G0 X#500\nM30\n", NOTHING)
    assert codes_of(findings) == ["GP234", "GP225"]


def test_a_loop_beyond_the_budget_is_unknown(tmp_path: Path) -> None:
    job = tmp_path / "job.cnc"
    job.write_text(HEAD + "G91\n#1=1\nwhile [#1 == 1]\nG0 X1\nendwhile\nM30\n")
    findings = Findings()
    program = load_program(job, findings)
    assert program is not None
    trace = execute(program, ZERO, NO_MACHINE, findings, budget=500)
    assert codes_of(findings) == ["GP233"]
    assert trace.sections[-1].edges[0].wait is Wait.UNKNOWN


def test_recursion_is_found(tmp_path: Path) -> None:
    _, findings = run(tmp_path, HEAD + "sub a\ngosub a\nendsub\ngosub a\nM30\n")
    assert codes_of(findings) == ["GP117"]


def test_arc_geometry_in_every_plane(tmp_path: Path) -> None:
    """G3 a quarter turn from the first axis of the right-handed pair: XY X to Y, ZX Z to X, YZ Y to Z."""
    text = (
        HEAD
        + "F100\nG0 X10 Y0\nG17 G3 X0 Y10 I-10\nG0 X0 Y0 Z10\nG18 G3 X10 Z0 K-10\n"
        + "G0 X0 Y10 Z0\nG19 G3 Y0 Z10 J-10\nM30\n"
    )
    trace, findings = run(tmp_path, text)
    assert codes_of(findings) == []
    rows = trace.sections[0].rows
    arcs = np.flatnonzero(rows["op"] == Op.ARC)
    assert rows["turns"][arcs].tolist() == [1, 1, 1]
    assert rows["plane"][arcs].tolist() == [1, 2, 3]
    assert np.allclose(rows["center"][arcs], 0)


@pytest.mark.parametrize(("radius", "long"), [(10.0, False), (-10.0, True)])
def test_sign_of_r_chooses_the_arc(radius: float, long: bool, tmp_path: Path) -> None:
    """3.4.3.1: a clockwise quarter from (0,10) to (10,0) has its centre at 0,0; the long way at 10,10."""
    trace, _ = run(tmp_path, HEAD + f"F100\nG0 Y10\nG2 X10 Y0 R{radius}\nM30\n")
    rows = trace.sections[0].rows
    center = rows["center"][rows["op"] == Op.ARC][0]
    assert np.allclose(center[:2], (10, 10) if long else (0, 0), atol=1e-12)


def test_inverse_time_feed(tmp_path: Path) -> None:
    """3.4.24: F6 finishes a move in 10 s: 30 mm at 180 mm/min, a half circle of radius 10 at 6 * 10 pi."""
    trace, _ = run(tmp_path, HEAD + "G93\nG1 X30 F6\nG3 X10 I-10 F6\nM30\n")
    feeds = trace.sections[0].rows["feed"]
    feeds = feeds[feeds > 0]
    assert np.allclose(feeds, [180.0, 60 * math.pi])


def test_tool_length_follows_the_tool(tmp_path: Path) -> None:
    """3.4.12: G43 alone takes the tool in the spindle, and the new one after the next change; H stays."""
    setup = Setup(
        default_start=0.0, default_offset=0.0, default_parameter=0.0, active_work=1, tool=0,
        tool_lengths={1: _exact(10.0), 2: _exact(25.0)},
    )  # fmt: skip
    trace, _ = run(tmp_path, HEAD + "M6 T1\nG43\nG0 Z1\nM6 T2\nZ1\nG43 H1\nZ1\nG49\nZ1\nM30\n", setup)
    assert [m[3] for m in moves(trace)] == [11.0, 26.0, 11.0, 1.0]


def _exact(value: float):  # type: ignore[no-untyped-def]
    from gproof.ir.setup import Interval

    return Interval(value, value)


def test_what_an_operator_types_is_unknown(tmp_path: Path) -> None:
    """4.2.4: a dialog changes its variables and #5398."""
    trace, findings = run(tmp_path, HEAD + '#1=5\ndlgmsg "size" "length" 1\nG0 X#1\nM30\n')
    assert "GP225" in codes_of(findings)
    assert trace.sections[0].edges[0].wait is Wait.OPERATOR


def test_replaced_m_code_is_not_taken_for_the_real_one(tmp_path: Path) -> None:
    """4.4: a subprogram m8 runs instead of M8."""
    trace, findings = run(tmp_path, HEAD + "sub m8\nG0 X900\nendsub\nM8\nM30\n")
    assert codes_of(findings) == []
    assert [m[1] for m in moves(trace)] == [900.0]


def test_missing_subprogram_is_told_once(tmp_path: Path) -> None:
    _, findings = run(tmp_path, HEAD + "gosub nowhere\nM30\n")
    assert codes_of(findings) == ["GP115"]


def test_rounding_beside_a_rotary_move_is_no_motion(tmp_path: Path) -> None:
    """0.1 + 0.2 is not 0.3: the tiny X step must not turn degrees a minute into mm a minute."""
    trace, _ = run(tmp_path, HEAD + "F90\nG1 X[0.1+0.2]\nX0.3 A45\nG93\nX[0.1+0.2] A90 F2\nM30\n")
    rows = trace.sections[0].rows
    assert rows["feed"][rows["op"] == Op.FEED].tolist() == [90.0, 90.0, 90.0]
    assert len(set(rows["to"][rows["op"] == Op.FEED][:, 0].tolist())) == 1


def test_an_automatic_tool_change_of_unknown_motion_is_unknown(tmp_path: Path) -> None:
    """3.5.3: M6 may move the axes; where the changer goes by itself and nobody said how, nothing is proved."""
    job = tmp_path / "job.cnc"
    job.write_text(HEAD + "M6 T1\nG0 X1\nM30\n")
    findings = Findings()
    program = load_program(job, findings)
    assert program is not None
    machine = dataclasses.replace(NO_MACHINE, controller=Controller(auto_tool_change=True))
    execute(program, ZERO, machine, findings)
    assert codes_of(findings) == ["GP113"]
