"""Macros and parameters by the manual's words, worked out by hand: 3.1.1, 3.4.10, 3.5, 4.1 to 4.4."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from passes.interpret.core.programs import labels, run, ways

from gproof.ir.machine import NO_MACHINE, Area, Controller, Machine, Tool
from gproof.ir.setup import NOTHING, ZERO, Interval, Setup
from gproof.ir.trace import Op, Trace, Wait

# Tool k is 10 k mm long and 2 k mm thick.
RACK = dataclasses.replace(
    NO_MACHINE, controller=Controller(auto_tool_change=True),
    tools=tuple(Tool(number=k, length=10.0 * k, diameter=2.0 * k) for k in range(1, 7)),
)  # fmt: skip
BY_HAND = dataclasses.replace(RACK, controller=Controller())


def rows(trace: Trace, *wanted: Op) -> list[tuple[str, float, float]]:
    """(op, arguments) of rows, in order of sections."""
    return [
        (Op(op).name.lower(), *arg)
        for section in trace.sections
        for op, arg in zip(section.rows["op"].tolist(), section.rows["arg"].tolist(), strict=True)
        if op in wanted
    ]


def only(trace: Trace) -> list[tuple[float, ...]]:
    """Where the moves of the only way end."""
    (way,) = ways(trace)
    return [to for _, to in way]


def told(trace: Trace) -> list[list[tuple[float, float]]]:
    """Of every move, in order of sections: the range of X, Y and Z."""
    out = []
    for section in trace.sections:
        for row in range(len(section.rows)):
            if section.rows["op"][row] >= Op.DWELL:
                continue
            frame = trace.frames[int(section.rows["frame"][row])]
            here = []
            for axis in range(3):
                low = high = float(section.rows["to"][row][axis])
                for symbol, factor in frame[axis]:
                    known = trace.symbols.get(symbol)
                    ends = (-1e99, 1e99) if known is None else (known.low * factor, known.high * factor)
                    low, high = low + min(ends), high + max(ends)
                here.append((low, high))
            out.append(here)
    return out


def values(
    folder: Path, text: str, *asked: str, setup: Setup = ZERO, machine: Machine = NO_MACHINE, macro: str | None = None
) -> list[float]:
    """Values of expressions behind a program: B turns to each of them, in machine coordinates."""
    lines = "".join(f"G53 G0 B[{expression}]\n" for expression in asked)
    trace, findings = run(folder, f"{text}{lines}M30\n", setup=setup, machine=machine, macro=macro)
    assert not [f for f in findings.kept if f.code.severity.name == "ERROR"], findings.kept
    last = trace.sections[-1].rows
    moves = [i for i in range(len(last)) if last["op"][i] < Op.DWELL][-len(asked) :]
    assert all(trace.frames[int(last["frame"][i])][4] == () for i in moves), "not known"
    return [float(last["to"][i][4]) for i in moves]


# -- change_tool with six places (3.5.3, 4.3)

CHANGER = """; six places, 60 mm apart, the first at X100; tools stand at Z30
sub put_away
  G53 G0 Z120
  G53 G0 X[40 + 60 * #5008] Y500
  G53 G1 Z30 F300
  M54 P2
  G4 P0.5
  M55 P2
  G53 G0 Z120
endsub
sub fetch
  G53 G0 Z120
  G53 G0 X[40 + 60 * #5011] Y500
  M54 P2
  G53 G1 Z30 F300
  M55 P2
  G53 G0 Z120
endsub
sub change_tool
  tcaguard off
  M5
  if [[#5011 < 0] or [#5011 > 6]]
    errmsg "the rack has six places"
  endif
  if [#5011 <> #5008]
    if [#5008 <> 0]
      gosub put_away
    endif
    if [#5011 <> 0]
      gosub fetch
    endif
    M6 T[#5011]
  endif
  if [#5011 <> 0]
    G43
  else
    G49
  endif
  tcaguard on
endsub
"""


def test_six_slot_rack(tmp_path: Path) -> None:
    """Tool 2 is put away at X160, tool 5 fetched at X340, its 50 mm are in force; then the same tool, then none."""
    job = "S900 M3\nT5 M6\nG0 Z5\nM6 T5\nG0 X1\nT0\nM6\nG0 Z3\nM30\n"
    trace, findings = run(tmp_path, job, machine=RACK, macro=CHANGER, setup=dataclasses.replace(ZERO, tool=2))
    assert labels(findings) == []
    assert only(trace) == [
        (0, 0, 120), (160, 500, 120), (160, 500, 30), (160, 500, 120),
        (160, 500, 120), (340, 500, 120), (340, 500, 30), (340, 500, 120),
        (340, 500, 55),
        (1, 500, 55),
        (1, 500, 120), (340, 500, 120), (340, 500, 30), (340, 500, 120),
        (340, 500, 3),
    ]  # fmt: skip
    assert rows(trace, Op.TOOL_CHANGE) == [("tool_change", 5.0, 0.0), ("tool_change", 0.0, 0.0)]
    # One pulse of the output for each putting away or fetching, and 0.5 s in the first.
    assert rows(trace, Op.OUTPUT) == [("output", 2.0, v) for v in (1.0, 0.0) * 3]
    assert rows(trace, Op.DWELL) == [("dwell", 0.5, 0.0)] * 2
    # The change itself happens with the guard off, and the job goes on with it on.
    guards = [
        trace.states[int(s)].guards_off
        for section in trace.sections
        for op, s in zip(section.rows["op"].tolist(), section.rows["state"].tolist(), strict=True)
        if op == Op.TOOL_CHANGE
    ]
    assert guards == [("tool_change_area",)] * 2
    assert trace.states[int(trace.sections[-1].rows["state"][-1])].guards_off == ()


def test_rack_refuses_the_seventh_tool(tmp_path: Path) -> None:
    """errmsg is an error: the program is over, and nothing was moved."""
    trace, findings = run(tmp_path, "T7 M6\nG0 X1\nM30\n", machine=RACK, macro=CHANGER)
    assert "GP245" in labels(findings)
    assert ways(trace) == [[]]


def test_words_behind_the_change_act_after_it(tmp_path: Path) -> None:
    """3.7: tool change is step 6, motion step 20; feed and speed are set before the change."""
    trace, _ = run(tmp_path, "S500 F80 T1 M6 M3 G1 X9\nM30\n", machine=RACK, macro=CHANGER)
    last = trace.sections[-1].rows
    moves = [i for i in range(len(last)) if last["op"][i] < Op.DWELL]
    assert last["to"][moves[-1]].tolist()[:3] == [9, 500, 120]
    # F80 came before the change, the macro's own F300 after it.
    assert last["feed"][moves[-1]] == 300
    assert rows(trace, Op.SPINDLE)[-2:] == [("spindle", 1.0, 500.0), ("spindle", 0.0, 0.0)]


def test_modes_of_the_changer_stay(tmp_path: Path) -> None:
    """Nothing puts G91 or the motion mode back."""
    macro = "sub change_tool\nM6 T#5011\nG91\nG53 G1 Z7 F60\nendsub\n"
    trace, _ = run(tmp_path, "G0 X4\nT1 M6\nX4\nM30\n", machine=RACK, macro=macro)
    assert [(op, to) for op, to in ways(trace)[0]] == [
        ("traverse", (4, 0, 0)), ("feed", (4, 0, 7)), ("feed", (8, 0, 7)),
    ]  # fmt: skip


def test_numbers_of_the_tools_during_a_change(tmp_path: Path) -> None:
    """3.1.1: #5008 is the old tool until the real M6, #5011 the new one all along."""
    macro = "sub change_tool\n#100=#5008\n#101=#5011\nM6 T[#5011]\n#102=#5008\n#103=#5010\nendsub\n"
    got = values(
        tmp_path, "T3 M6\n", "#100", "#101", "#102", "#103", machine=RACK, macro=macro,
        setup=dataclasses.replace(ZERO, tool=1),
    )  # fmt: skip
    assert got == [1, 3, 3, 30]


# -- replaced M codes and their arguments (4.4, 3.1.1)

LETTERS = {"A": 1, "B": 2, "C": 3, "D": 4, "E": 5, "H": 8, "I": 9, "J": 10, "K": 11, "L": 12, "P": 16, "Q": 17,
           "R": 18, "X": 24, "Y": 25, "Z": 26}  # fmt: skip


def test_every_letter_has_its_parameter(tmp_path: Path) -> None:
    words = " ".join(f"{letter}{number + 0.5}" for letter, number in LETTERS.items())
    macro = "sub m777\n" + "".join(f"#{100 + k}=#{k}\n" for k in range(1, 27)) + "endsub\n"
    got = values(tmp_path, f"M777 {words}\n", *(f"#{100 + n}" for n in LETTERS.values()), macro=macro)
    assert got == [n + 0.5 for n in LETTERS.values()]


@pytest.mark.parametrize("number", list(LETTERS.values()))
def test_a_word_that_is_missing_is_minus_ten_thousand_million(tmp_path: Path, number: int) -> None:
    assert values(tmp_path, f"#{number}=4\nM777\n", f"#{number} + 10000000000", macro="sub m777\nM9\nendsub\n") == [0]


def test_arguments_are_expressions_of_the_line(tmp_path: Path) -> None:
    """3.2.2.3: values are found when the line is read, before the call puts its arguments there."""
    assert values(tmp_path, "#24=7\n#25=1\nM777 X[#25+1] Y#24\n", "#24", "#25", macro="sub m777\nM9\nendsub\n") == [
        2,
        7,
    ]


def test_the_real_spindle_inside_m3(tmp_path: Path) -> None:
    """4.4: the call starts the real spindle at S and then waits for an input."""
    macro = "sub m3\nM3 S#19\nM56 P1 L1 Q60\nif [#5399 <> 1]\nG4 P2\nendif\nendsub\n"
    trace, findings = run(tmp_path, "M3 S1200\nG0 X1\nM30\n", macro=macro)
    assert [c for c in labels(findings) if c != "GP118"] == []
    assert ("spindle", 1.0, 1200.0) in rows(trace, Op.SPINDLE)
    assert all(way == [("traverse", (1.0, 0.0, 0.0))] for way in ways(trace))
    assert len(ways(trace)) >= 2


def test_m5_in_a_replacement_of_m3_is_the_replaced_m5(tmp_path: Path) -> None:
    """Only the code whose subprogram is running is the real one."""
    macro = "sub m3\nM5\nendsub\nsub m5\nG0 Z8\nendsub\n"
    trace, _ = run(tmp_path, "M3 S100\nG0 X1\nM30\n", macro=macro)
    assert only(trace)[:2] == [(0, 0, 8), (1, 0, 8)]
    assert not [row for row in rows(trace, Op.SPINDLE) if row[1] == 1.0]


def test_replacement_in_the_job_itself(tmp_path: Path) -> None:
    """4.1, 4.4: a subprogram is a subprogram, wherever it stands; the numbers need not exist."""
    trace, _ = run(tmp_path, "sub m123\nG0 X#24\nendsub\nM123 X6\nM30\n")
    assert only(trace) == [(6, 0, 0)]


def test_user_codes_reach_999_and_unknown_ones_are_errors(tmp_path: Path) -> None:
    trace, findings = run(tmp_path, "M999 X1\nM30\n", macro="sub m999\nG0 X#24\nendsub\n")
    assert only(trace) == [(1, 0, 0)] and labels(findings) == []
    assert "GP112" in labels(run(tmp_path, "M998 X1\nM30\n", macro="sub m999\nM9\nendsub\n")[1])


def test_a_line_number_may_stand_before_the_code(tmp_path: Path) -> None:
    trace, findings = run(tmp_path, "N2000 M3 S1000 (go)\nM30\n", macro="sub m3\nM3 S[#19/2]\nendsub\n")
    assert labels(findings) == []
    assert rows(trace, Op.SPINDLE)[0] == ("spindle", 1.0, 500.0)


# -- subprograms (4.1)


def test_subprograms_share_the_parameters(tmp_path: Path) -> None:
    macro = "sub step\n#30=[#30 + 5]\nG0 X#30\nendsub\n"
    job = "#30=1\ngosub step\ngosub STEP\nsub twice\ngosub step\ngosub step\nendsub\ngosub twice\nM30\n"
    assert [to[0] for to in only(run(tmp_path, job, macro=macro)[0])] == [6, 11, 16, 21]


def test_a_subprogram_stands_before_or_behind_its_call_and_is_not_run_by_itself(tmp_path: Path) -> None:
    trace, _ = run(tmp_path, "gosub late\nsub late\nG0 X2\nendsub\nG0 X3\nM30\n")
    assert [to[0] for to in only(trace)] == [2, 3]


def test_m30_in_a_subprogram_ends_the_job(tmp_path: Path) -> None:
    trace, _ = run(tmp_path, "sub done\nM30\nendsub\ngosub done\nG0 X3\n")
    assert only(trace) == []


# -- dialogs (4.2)


def test_a_dialog_changes_what_it_asks_for_and_nothing_else(tmp_path: Path) -> None:
    setup = dataclasses.replace(ZERO, parameter_ranges={100: Interval(2.0, 3.0), 101: Interval(-1.0, 1.0)})
    job = '#100=50\n#101=60\n#102=70\ndlgmsg "how" "a" 100 "b" 101\nif [#5398 == 1]\nG0 X#100 Y#101 Z#102\nendif\nM30\n'
    trace, _ = run(tmp_path, job, setup=setup)
    assert told(trace) == [[pytest.approx((2, 3)), pytest.approx((-1, 1)), pytest.approx((70, 70))]]


def test_cancel_is_minus_one(tmp_path: Path) -> None:
    job = 'dlgmsg "go on?" "a" 100\nG0 Y[#5398 + 1]\nM30\n'
    trace, _ = run(tmp_path, job)
    here = sorted(told(trace))
    low, high = min(h[1][0] for h in here), max(h[1][1] for h in here)
    assert (low, high) == pytest.approx((0, 2))


def test_a_dialog_nobody_bounded_is_not_safe(tmp_path: Path) -> None:
    _, findings = run(tmp_path, 'dlgmsg "how" "a" 100\nG0 X#100\nM30\n', setup=NOTHING)
    assert "GP225" in labels(findings)


# -- inputs (3.5.9)


@pytest.mark.parametrize("line", ["M56 P3", "M56 P3 L0", "M56 P51", "M56 P61", "M56 P67", "M56 P103", "M56 P208"])
def test_a_digital_input_is_zero_or_one(tmp_path: Path, line: str) -> None:
    trace, findings = run(tmp_path, f"{line}\nG0 X#5399\nM30\n")
    assert labels(findings) == []
    low, high = min(m[0][0] for m in told(trace)), max(m[0][1] for m in told(trace))
    assert (low, high) == pytest.approx((0, 1))


@pytest.mark.parametrize("line", ["M56 P3 L1 Q30", "M56 P3 L2 Q0.5"])
def test_waiting_for_an_input_ends_a_section_and_may_time_out(tmp_path: Path, line: str) -> None:
    """3.5.9: after the wait the program asks whether it was in vain; both answers are there."""
    job = f"{line}\nif [#5399 == 1]\nG0 X1\nelse\nG0 X2\nendif\nM30\n"
    trace, _ = run(tmp_path, job)
    assert sorted(way[0][1][0] for way in ways(trace)) == [1, 2]
    assert Wait.INPUT in [e.wait for s in trace.sections for e in s.edges]


def test_an_analogue_input_is_no_digital_one(tmp_path: Path) -> None:
    """Its range is not told: both outcomes of any comparison are open."""
    trace, _ = run(tmp_path, "M56 E3\nif [#5399 > 1]\nG0 X1\nelse\nG0 X2\nendif\nM30\n")
    assert sorted(way[0][1][0] for way in ways(trace)) == [1, 2]
    assert "GP225" in labels(run(tmp_path, "M56 E3\nG0 X#5399\nM30\n")[1])


@pytest.mark.parametrize("line", ["M56", "M56 P3 E3", "M56 P1.5", "M56 P-1", "M56 P3 L3 Q1", "M56 E1 L1 Q3"])
def test_wrong_ways_to_ask_for_an_input(tmp_path: Path, line: str) -> None:
    _, findings = run(tmp_path, f"{line}\nM30\n")
    assert [f for f in findings.kept if f.code.severity.name == "ERROR"], labels(findings)


def test_two_readings_of_one_input_may_differ(tmp_path: Path) -> None:
    job = "M56 P3\n#1=#5399\nM56 P3\nif [#1 <> #5399]\nG0 X1\nelse\nG0 X2\nendif\nM30\n"
    assert sorted(way[0][1][0] for way in ways(run(tmp_path, job)[0])) == [1, 2]


def test_one_reading_asked_twice_is_one_answer(tmp_path: Path) -> None:
    """Ways on which an input is 1 and 0 at once are allowed (they only add), but the two real ones must be there."""
    job = "M56 P3\n#1=#5399\nG0 X[#1*3]\nG0 Y[#1*3]\nM30\n"
    trace, _ = run(tmp_path, job)
    box = told(trace)
    assert min(m[0][0] for m in box) == pytest.approx(0) and max(m[0][1] for m in box) == pytest.approx(3)


# -- probing (3.4.10)


def test_probe_results_under_offsets(tmp_path: Path) -> None:
    """Work zero at machine Z40, tool 1 (10 mm) in force: Z-20 is machine 30; the start Z5 is machine 55."""
    job = "G10 L2 P1 Z40\nT1 M6\nG43\nG0 Z5\nF50\nG38.2 Z-20\nG53 G0 X[#5053] Y[#5063]\nM30\n"
    trace, _ = run(tmp_path, job, machine=BY_HAND)
    x, y, z = told(trace)[-1]
    assert x == pytest.approx((30, 55)) and y == pytest.approx((-20, 5)) and z == pytest.approx((30, 55))


def test_machine_and_work_result_are_one_place(tmp_path: Path) -> None:
    """#5053 less #5063 is the sum of the offsets, wherever the contact was."""
    job = "G10 L2 P1 Z40\nG0 Z5\nF50\nG38.2 Z-20\nG53 G0 X[#5053 - #5063]\nM30\n"
    trace, _ = run(tmp_path, job)
    x = told(trace)[-1][0]
    assert x[0] <= 40 <= x[1]


def test_axes_that_do_not_move_are_known_after_probing(tmp_path: Path) -> None:
    assert values(tmp_path, "G92 X100\nF50\nG38.2 Z-20\n", "#5051", "#5061", "#5052") == [0, 100, 0]


def test_an_old_result_stays_until_the_next_probe(tmp_path: Path) -> None:
    """A move changes positions, not results: after G0 X9 the result is still that of the contact."""
    job = "F50\nG38.2 X-20\nG0 X9\nG53 G0 Y[#5051]\nM30\n"
    assert told(run(tmp_path, job)[0])[-1][1] == pytest.approx((-20, 0))


def test_probe_in_increments(tmp_path: Path) -> None:
    trace, findings = run(tmp_path, "G0 Z5\nG91\nF50\nG38.2 Z-20\nG90 G53 G0 X[#5063]\nM30\n")
    assert labels(findings) == []
    assert told(trace)[-1][0] == pytest.approx((-15, 5))


# -- the tool table (3.1.1, 3.4.12)


@pytest.mark.parametrize("number", [1, 42, 99])
def test_a_length_that_the_program_writes(tmp_path: Path, number: int) -> None:
    job = f"#[5400 + {number}] = 12.5\nT{number} M6\nG43\nG0 Z1\nG49\nG43 H{number}\nG0 Z2\nG43 H1\nM30\n"
    trace, _ = run(tmp_path, job, machine=BY_HAND)
    assert [m[2] for m in only(trace)] == [13.5, 14.5]


def test_the_table_can_be_read(tmp_path: Path) -> None:
    assert values(tmp_path, "", "#5403", "#5503", machine=BY_HAND) == [30, 6]


def test_written_entries_are_read_back(tmp_path: Path) -> None:
    job = "#5407=1.5\n#5507=2.5\n#5607=3.5\n#5707=4\n"
    assert values(tmp_path, job, "#5407", "#5507", "#5607", "#5707", machine=BY_HAND) == [1.5, 2.5, 3.5, 4]


def test_another_tool_is_not_touched(tmp_path: Path) -> None:
    trace, _ = run(tmp_path, "T1 M6\nG43\n#5402=99\nG0 Z1\nM30\n", machine=BY_HAND)
    assert only(trace)[-1][2] == 11


def test_length_measured_with_the_probe(tmp_path: Path) -> None:
    """Contact at machine 20 ... 55; the tool is as long as the contact lies above 20: 0 ... 35 mm."""
    job = "G53 G0 Z55\nF50\nG53 G38.2 Z20\n#5402=[#5053 - 20]\nG53 G0 Z60\nG43 H2\nG0 Z0\nM30\n"
    trace, _ = run(tmp_path, job, machine=BY_HAND)
    assert told(trace)[-1][2] == pytest.approx((0, 35))


def test_table_entries_in_inches(tmp_path: Path) -> None:
    """3.4.12 names no unit: the table is in mm, or what is read and written is not taken as known."""
    trace, findings = run(tmp_path, "G20\n#5401=1\nG43 H1\nG0 Z1\nM30\n", machine=BY_HAND)
    low, high = told(trace)[-1][2]
    assert (low <= 50.8 <= high and low <= 26.4 <= high) or "GP225" in labels(findings)


# -- persistent values (3.1.1)


def test_what_an_earlier_job_left_is_not_known(tmp_path: Path) -> None:
    _, findings = run(tmp_path, "G0 X#4000\nM30\n", setup=NOTHING)
    assert "GP225" in labels(findings)
    assert values(tmp_path, "#4999=6\n", "#4999", setup=NOTHING) == [6]
    setup = dataclasses.replace(NOTHING, parameters={4123: 7.5})
    assert values(tmp_path, "", "#4123", setup=setup) == [7.5]


# -- live positions (3.1.1)


def test_positions_under_every_offset(tmp_path: Path) -> None:
    """Work zero at X10, then the place is called 5, then a move to 20: machine 20 - 15 + 10 = 15."""
    assert values(tmp_path, "G10 L2 P1 X10 Y20\n", "#5001", "#5002", "#5071") == [-10, -20, 0]
    got = values(tmp_path, "G10 L2 P1 X10\nG92 X5\n", "#5001", "#5211", "#5071")
    assert got == [5, -15, 0]
    got = values(tmp_path, "G10 L2 P1 X10\nG92 X5\nG0 X20\n", "#5001", "#5071", "#5221")
    assert got == [20, 15, 10]
    got = values(tmp_path, "G10 L2 P2 X3\nG0 X10\nG55\n", "#5001", "#5220", "#5241")
    assert got == [7, 2, 3]


def test_positions_with_a_tool(tmp_path: Path) -> None:
    """10 mm of tool: Z1 is axis position 11; the program's place is 1, and 11 again without the length."""
    got = values(tmp_path, "G43 H1\nG0 Z1\n", "#5003", "#5073", "#5013", machine=BY_HAND)
    assert got == [1, 11, 10]
    assert values(tmp_path, "G43 H1\nG0 Z1\nG49\n", "#5003", "#5013", machine=BY_HAND) == [11, 0]


def test_positions_of_turning_axes(tmp_path: Path) -> None:
    assert values(tmp_path, "G92 A30\nG0 A45 C7\n", "#5004", "#5074", "#5006", "#5214") == [45, 15, 7, -30]


def test_position_is_the_one_before_the_line(tmp_path: Path) -> None:
    """3.2.2.3: a line's values are found before anything on it is done."""
    trace, _ = run(tmp_path, "G0 X4\nG0 X[#5001 + 1] Y#5001\nG91 G0 X#5001\nM30\n")
    assert only(trace) == [(4, 0, 0), (5, 4, 0), (10, 4, 0)]


def test_positions_in_inches(tmp_path: Path) -> None:
    """The place where the axis stands is 1 in the program's numbers after G0 X1, whatever the unit: no move."""
    trace, findings = run(tmp_path, "G20\nG0 X1\nG0 X#5001\nM30\n")
    assert told(trace)[-1][0] == pytest.approx((25.4, 25.4)) or "GP225" in labels(findings)


def test_g92_in_the_table(tmp_path: Path) -> None:
    """At 4, G92 X7 makes the offset -3, then X9 makes it -5. G92.2 keeps the numbers, G92.1 does not (3.4.23)."""
    assert values(tmp_path, "G0 X4\nG92 X7\n", "#5211", "#5001") == [-3, 7]
    assert values(tmp_path, "G0 X4\nG92 X7\nG92 X9\n", "#5211") == [-5]
    assert values(tmp_path, "G0 X4\nG92 X7\nG92.2\n", "#5211", "#5001") == [-3, 4]
    assert values(tmp_path, "G0 X4\nG92 X7\nG92.1\n", "#5211", "#5001") == [0, 4]
    assert values(tmp_path, "G0 X4\nG92 X7\nG92.2\nG92.3\n", "#5211", "#5001") == [-3, 7]


# -- places to return to (3.4.8)


@pytest.mark.parametrize(("code", "first"), [("G28", 5161), ("G30", 5181)])
def test_home_places(tmp_path: Path, code: str, first: int) -> None:
    """By way of the programmed point, in machine coordinates, of all axes."""
    job = f"G92 X100\n#{first}=12 #{first + 1}=13 #{first + 2}=14\n{code} Z5\nM30\n"
    assert only(run(tmp_path, job)[0]) == [(0, 0, 5), (12, 13, 14)]
    job = f"#{first}=12 #{first + 1}=13 #{first + 2}=14\nG0 X1\n{code}\nM30\n"
    assert only(run(tmp_path, job)[0]) == [(1, 0, 0), (12, 13, 14)]


def test_home_places_of_nobody(tmp_path: Path) -> None:
    _, findings = run(tmp_path, "G28\nM30\n", setup=NOTHING)
    assert "GP225" in labels(findings)


# -- coordinate systems as parameters (3.1.1)


@pytest.mark.parametrize("system", range(1, 10))
def test_each_system_has_its_numbers(tmp_path: Path, system: int) -> None:
    code = ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"][system - 1]
    first = 5201 + 20 * system
    assert values(tmp_path, f"G10 L2 P{system} X7 B8\n{code}\n", f"#{first}", "#5220", f"#{first + 4}") == [
        7,
        system,
        8,
    ]


def test_a_system_written_before_it_is_chosen(tmp_path: Path) -> None:
    trace, _ = run(tmp_path, "#5241=7\n#5242=8\nG55\nG0 X1 Y1\nM30\n")
    assert only(trace) == [(8, 9, 0)]


def test_a_system_written_while_it_is_in_force_is_not_guessed(tmp_path: Path) -> None:
    """Whether the zero moves at once is not told: both places are inside what is said, or it is unknown."""
    trace, findings = run(tmp_path, "#5221=7\nG0 X1\nM30\n")
    low, high = told(trace)[-1][0]
    assert (low <= 1 and high >= 8) or "GP225" in labels(findings) or "GP304" in labels(findings)


def test_setup_values_are_in_the_table(tmp_path: Path) -> None:
    setup = dataclasses.replace(ZERO, work={(1, "x"): Interval(31.0, 31.0)}, g92={"x": Interval(2.0, 2.0)})
    assert values(tmp_path, "", "#5221", "#5211", "#5001", setup=setup) == [31, 2, -33]


@pytest.mark.parametrize("number", [5001, 5009, 5051, 5067, 5071, 5397])
def test_live_values_can_not_be_written(tmp_path: Path, number: int) -> None:
    assert "GP227" in labels(run(tmp_path, f"#{number}=1\nM30\n")[1])


@pytest.mark.parametrize("number", [5069, 5121, 5131])
def test_state_that_nobody_gave_is_not_guessed(tmp_path: Path, number: int) -> None:
    assert "GP225" in labels(run(tmp_path, f"G0 X#{number}\nM30\n")[1])


def test_the_probe_touches_or_not(tmp_path: Path) -> None:
    assert told(run(tmp_path, "G0 X#5068\nM30\n")[0])[-1][0] == pytest.approx((0, 1))


def test_running_is_not_drawing(tmp_path: Path) -> None:
    assert values(tmp_path, "", "#5397", "#5380") == [0, 0]


def test_limits_and_areas_in_the_table(tmp_path: Path) -> None:
    machine = dataclasses.replace(
        NO_MACHINE,
        axes=tuple(dataclasses.replace(a, lower=-1.0 - a.index, upper=100.0 + a.index) for a in NO_MACHINE.axes),
        tool_change_area=Area(name="rack", box=((1.0, 2.0), (3.0, 4.0), (5.0, 6.0))),
    )
    asked = ["#5101", "#5113", "#5131", "#5132", "#5133", "#5141", "#5142", "#5143"]
    assert values(tmp_path, "", *asked, machine=machine) == [-1, 102, 1, 3, 5, 2, 4, 6]


# -- what a second pair of eyes found


@pytest.mark.parametrize("text", ["home x\n", "F50\nhome x\nG38.2 X50\n", "home x\n#1=#5071\n"])
def test_no_setup_states_what_arises_in_the_run(tmp_path: Path, text: str) -> None:
    """Setup zero knows offsets and parameters; where an axis stands after homing it does not know."""
    trace, _ = run(tmp_path, f"{text}if [#5071 < 40]\nG91 G0 Y1\nelse\nG91 G0 Y2\nendif\nM30\n")
    assert {way[-1][1][1] for way in ways(trace)} == {1, 2}


def test_a_variable_whose_number_is_not_known(tmp_path: Path) -> None:
    """The bounds of its number are not bounds of its value, and it may be any of too many to look at."""
    setup = dataclasses.replace(ZERO, parameter_ranges={4001: Interval(1.0, 2000.0)})
    _, findings = run(tmp_path, "#1=900\n#2=900\nG0 X#[#4001]\nM30\n", setup=setup)
    assert {"GP225", "GP299"} <= set(labels(findings))


@pytest.mark.parametrize(
    "text", ["[1 / #4001]", "[7 mod #4001]", "sqrt[#4001]", "ln[#4001]", "acos[#4001 * 2]", "[2 band #4001]"]
)
def test_an_operator_that_may_stop_the_job_is_told(tmp_path: Path, text: str) -> None:
    setup = dataclasses.replace(ZERO, parameter_ranges={4001: Interval(-1.0, 2.0)})
    assert "GP299" in labels(run(tmp_path, f"if [{text} > 3]\nG4 P1\nendif\nM30\n", setup=setup)[1])


def test_behind_cancel_the_old_value_may_be_there(tmp_path: Path) -> None:
    setup = dataclasses.replace(ZERO, parameter_ranges={100: Interval(1.0, 2.0)})
    trace, _ = run(tmp_path, '#100=50\ndlgmsg "size" "a" 100\nG0 X#100\nM30\n', setup=setup)
    assert max(move[0][1] for move in told(trace)) >= 50
    assert min(move[0][0] for move in told(trace)) <= 1


def test_ask_until_ok(tmp_path: Path) -> None:
    """The loop is a cycle of sections; behind it the operator has typed something within the stated bounds."""
    setup = dataclasses.replace(ZERO, parameter_ranges={100: Interval(1.0, 2.0)})
    job = '#5398=0\nwhile [#5398 <> 1]\n#100=50\ndlgmsg "size" "a" 100\nendwhile\nG0 X#100\nM30\n'
    trace, findings = run(tmp_path, job, setup=setup)
    assert labels(findings) == []
    assert all(move[0] == pytest.approx((1, 2)) for move in told(trace))


def test_a_dialog_for_a_length_that_is_in_use(tmp_path: Path) -> None:
    job = 'T1 M6\nG43\ndlgmsg "length" "L" 5401\nG0 Z1\nM30\n'
    assert "GP298" in labels(run(tmp_path, job, machine=BY_HAND)[1])


def test_what_is_left_of_a_calling_line_belongs_to_the_state(tmp_path: Path) -> None:
    """The same question inside the changer, in the same state, but the line that called goes on to X1 or to X2."""
    macro = "sub change_tool\n#1=0\nG53 G0 X0\nM56 P1\nif [#5399 == 1]\nM9\nendif\n#5399=0\nM6 T1\nendsub\n"
    job = "#1=1\n#2=0\nwhile [#2 == 0]\nM56 P2\n#2=#5399\nT1 M6 G0 X[#1 * 3 + 1]\nendwhile\nM30\n"
    trace, _ = run(tmp_path, job, machine=RACK, macro=macro)
    assert {move[0] for move in told(trace)} == {(0, 0), (4, 4), (1, 1)}


def test_an_unknown_tool_is_no_other_tool(tmp_path: Path) -> None:
    job = "T1 M6\nT[#4001] M6\nG43\nG0 Z1\nM30\n"
    _, findings = run(tmp_path, job, machine=BY_HAND, setup=dataclasses.replace(ZERO, default_parameter=None))
    assert "GP225" in labels(findings)
    trace, findings = run(tmp_path, "T1 M6\nT[#4001]\nM6\nG43\nG0 Z1\nM30\n", machine=BY_HAND,
                          setup=dataclasses.replace(ZERO, default_parameter=None))  # fmt: skip
    assert told(trace)[-1][2] == (-1e99, 1e99)


def test_a_wait_without_a_time_may_end_both_ways(tmp_path: Path) -> None:
    """3.5.9 does not say what a wait without Q does."""
    trace, _ = run(tmp_path, "M56 P3 L1\nif [#5399 == 1]\nG0 X1\nelse\nG0 X2\nendif\nM30\n")
    assert sorted(way[0][1][0] for way in ways(trace)) == [1, 2]


def test_stated_bounds_go_before_the_usual_zero(tmp_path: Path) -> None:
    setup = dataclasses.replace(ZERO, parameter_ranges={30: Interval(5.0, 6.0)})
    assert told(run(tmp_path, "G0 X#30\nM30\n", setup=setup)[0])[0][0] == pytest.approx((5, 6))


def test_a_length_among_the_stated_parameters(tmp_path: Path) -> None:
    setup = dataclasses.replace(ZERO, parameters={5401: 44.0})
    trace, _ = run(tmp_path, "G43 H1\nG0 Z1\nM30\n", machine=BY_HAND, setup=setup)
    assert only(trace)[-1][2] == 45


def test_written_zeros_act_when_they_are_chosen(tmp_path: Path) -> None:
    trace, findings = run(tmp_path, "#5221=7\nG54\nG0 X1\n#5211=3\nG92.3\nG0 X1\nM30\n")
    assert [to[0] for to in only(trace)] == [8, 11]
    assert set(labels(findings)) == {"GP298"}
