"""macro.cnc: tool changes, M codes that subprograms replace, their arguments. Manual 4.3, 4.4, 3.5.3."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from passes.interpret.core.programs import labels, run, ways

from gproof.ir.machine import NO_MACHINE, Controller, Tool
from gproof.ir.setup import ZERO
from gproof.ir.trace import Op, Trace, Wait

AUTO = dataclasses.replace(
    NO_MACHINE, controller=Controller(auto_tool_change=True),
    tools=(Tool(number=1, length=10.0, diameter=6.0), Tool(number=2, length=25.0, diameter=3.0)),
)  # fmt: skip


def ops(trace: Trace, *wanted: Op) -> list[tuple[str, float, float]]:
    """(op, arguments) of rows in order of sections."""
    return [
        (Op(op).name.lower(), *arg)
        for s in trace.sections
        for op, arg in zip(s.rows["op"].tolist(), s.rows["arg"].tolist(), strict=True)
        if op in wanted
    ]


def test_arguments_of_a_user_code(tmp_path: Path) -> None:
    """3.1.1: #1 to #26 are the words A to Z, -1e10 where the line has none."""
    macro = "sub m120\nG0 X#24 Y#19\nif [#2 < -1]\nG0 Z3\nendif\nendsub\n"
    trace, findings = run(tmp_path, "M120 X7 S2.5\nM30\n", macro=macro)
    assert labels(findings) == []
    assert ways(trace)[0] == [("traverse", (7.0, 2.5, 0.0)), ("traverse", (7.0, 2.5, 3.0))]


def test_the_real_function_inside_its_own_replacement(tmp_path: Path) -> None:
    """4.4: m3 inside the subprogram m3 is the controller's own."""
    macro = "sub m3\nm3 s#19\nG4 P1.5\nendsub\n"
    trace, findings = run(tmp_path, "N10 M3 S1000\nG0 X1\nM30\n", macro=macro)
    assert labels(findings) == []
    assert ops(trace, Op.SPINDLE, Op.DWELL) == [("spindle", 1.0, 1000.0), ("dwell", 1.5, 0.0), ("spindle", 0.0, 0.0)]


def test_inside_a_deeper_call_it_is_still_the_real_one(tmp_path: Path) -> None:
    macro = "sub m8\ngosub deeper\nendsub\nsub deeper\nM8\nendsub\n"
    trace, _ = run(tmp_path, "M8\nM9\nM30\n", macro=macro)
    assert ops(trace, Op.COOLANT) == [("coolant", 0.0, 1.0), ("coolant", 0.0, 0.0)]


@pytest.mark.parametrize("line", ["M120 G1 X1", "M120 M8", "M8 M120", "G4 P1 M120"])
def test_other_codes_on_the_line_are_an_error(tmp_path: Path, line: str) -> None:
    """4.4: nothing else may stand beside such a code."""
    trace, findings = run(tmp_path, f"F100\n{line}\nM30\n", macro="sub m120\nG0 X5\nendsub\n")
    assert labels(findings) == ["GP290"]
    assert ways(trace) == [[]]


def test_user_code_inside_a_long_plain_stretch(tmp_path: Path) -> None:
    """The call stands in a table of plain lines: those before and after it are executed once each, in order."""
    before = "".join(f"G1 X{k} F100\n" for k in range(50))
    after = "".join(f"G1 Y{k}\n" for k in range(50))
    trace, _ = run(tmp_path, f"{before}M120\n{after}M30\n", macro="sub m120\nG0 Z9\nendsub\n")
    moves = ways(trace)[0]
    assert [to for _, to in moves] == (
        [(float(k), 0.0, 0.0) for k in range(50)]
        + [(49.0, 0.0, 9.0)]
        + [(49.0, float(k), 9.0) for k in range(50)]
    )  # fmt: skip


CHANGER = """sub change_tool
  tcaguard off
  m5
  if [[#5011] <> [#5008]]
    if [[#5011] > 2]
      errmsg "no such tool"
    endif
    G53 G0 Z90
    G53 G0 X[100 * #5011] Y300
    m6t[#5011]
    G43
  endif
  tcaguard on
endsub
"""


def test_change_tool_runs_instead_of_m6(tmp_path: Path) -> None:
    """3.5.3, 4.3: T first, then the subprogram, then the rest of the line; #5011 is the new tool."""
    trace, findings = run(tmp_path, "G0 X5\nS900 M3\nT2 M6 G0 X7\nG0 Z1\nT2 M6\nM30\n", machine=AUTO, macro=CHANGER)
    assert labels(findings) == []
    assert ways(trace)[0] == [
        ("traverse", (5.0, 0.0, 0.0)),
        ("traverse", (5.0, 0.0, 90.0)),
        ("traverse", (200.0, 300.0, 90.0)),
        ("traverse", (7.0, 300.0, 90.0)),
        ("traverse", (7.0, 300.0, 26.0)),
    ]
    assert ops(trace, Op.TOOL_CHANGE) == [("tool_change", 2.0, 0.0)]


def test_change_tool_by_hand_stops_for_the_operator(tmp_path: Path) -> None:
    """2.1.13: without AutoToolChange the job stops at the change; the subprogram's moves are made all the same."""
    machine = dataclasses.replace(AUTO, controller=Controller(auto_tool_change=False))
    trace, findings = run(tmp_path, "T1 M6\nG0 Z1\nM30\n", machine=machine, macro=CHANGER)
    assert labels(findings) == ["GP243"]
    assert [e.wait for s in trace.sections for e in s.edges] == [Wait.TOOL_CHANGE, Wait.END]


def test_errmsg_in_the_changer_ends_that_way(tmp_path: Path) -> None:
    trace, findings = run(tmp_path, "T3 M6\nG0 Z1\nM30\n", machine=AUTO, macro=CHANGER)
    assert "GP245" in labels(findings)
    assert ways(trace) == [[]]


def test_an_unknown_tool_in_the_spindle_is_both_ways(tmp_path: Path) -> None:
    """Nobody said which tool is in the spindle: the change may be needed or not."""
    setup = dataclasses.replace(ZERO, tool=None, default_parameter=None)
    trace, _ = run(tmp_path, "T1 M6\nG0 X1\nM30\n", machine=AUTO, macro=CHANGER, setup=setup)
    assert sorted(len(way) for way in ways(trace)) == [1, 3]


def test_recursion_is_told(tmp_path: Path) -> None:
    _, findings = run(tmp_path, "gosub a\nM30\n", macro="sub a\ngosub b\nendsub\nsub b\ngosub a\nendsub\n")
    assert labels(findings) == ["GP117"]


def test_arguments_stay_until_the_next_call(tmp_path: Path) -> None:
    """4.4: #1 to #26 are overwritten by the call, and not put back."""
    trace, _ = run(tmp_path, "#24=3\nM120 X8\nG0 X#24\nM30\n", macro="sub m120\nM9\nendsub\n")
    assert ways(trace)[0] == [("traverse", (8.0, 0.0, 0.0))]


# -- the tool table as parameters (3.1.2, 3.4.12)


def test_tool_table_is_read_and_written(tmp_path: Path) -> None:
    text = "T1 M6\nG43\nG0 Z1\n#5401=12.5\nG43\nG0 Z1\nG0 X#5401 Y#5501\n#[5500+2]=8\nG0 X#5502\nM30\n"
    trace, _ = run(tmp_path, text, machine=dataclasses.replace(AUTO, controller=Controller()))
    moves = [to for _, to in ways(trace)[0]]
    assert [to[2] for to in moves[:2]] == [11.0, 13.5]
    assert moves[2][:2] == (12.5, 6.0)
    assert moves[3][0] == 8.0


def test_tool_parameters_of_the_spindle(tmp_path: Path) -> None:
    """3.1.1: #5008 tool, #5009 radius, #5010 length, #5013 the active offset."""
    machine = dataclasses.replace(AUTO, controller=Controller())
    trace, _ = run(tmp_path, "T2 M6\nG0 X#5008 Y#5009\nG0 X#5010 Y#5013\nG43\nG0 X#5013\nM30\n", machine=machine)
    assert [to[:2] for _, to in ways(trace)[0]] == [(2.0, 1.5), (25.0, 0.0), (25.0, 0.0)]


def test_a_length_written_while_it_is_in_use_is_not_guessed(tmp_path: Path) -> None:
    """3.4.12 does not say whether G43 takes a new length at once: until the next G43 the height is not known."""
    machine = dataclasses.replace(AUTO, controller=Controller())
    trace, findings = run(tmp_path, "T1 M6\nG43\n#5401=12.5\nG0 Z1\nG43\nG0 Z1\nM30\n", machine=machine)
    assert labels(findings) == ["GP243", "GP298"]
    rows = trace.sections[-1].rows
    z = [
        trace.frames[f][2]
        for f, op in zip(rows["frame"].tolist(), rows["op"].tolist(), strict=True)
        if op == Op.TRAVERSE
    ]
    assert z == [(("?", 1),), ()]
