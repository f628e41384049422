"""Conditions that rest on what only the machine knows: both outcomes are followed and come together again."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from passes.interpret.core.programs import labels, run, ways

from gproof.ir.setup import ZERO, Interval
from gproof.ir.trace import Op, Wait


def xs(way: list[tuple[str, tuple[float, ...]]]) -> list[float]:
    return [to[0] for _, to in way]


def test_both_outcomes_of_an_input_are_followed(tmp_path: Path) -> None:
    """3.5.9: nobody knows before the job runs what M56 will read."""
    trace, findings = run(tmp_path, "M56 P3\nif [#5399 == 1]\nG0 X1\nelse\nG0 X2\nendif\nG0 Y5\nM30\n")
    assert sorted(xs(way) for way in ways(trace)) == [[1.0, 1.0], [2.0, 2.0]]
    assert labels(findings) == []
    assert [e.wait for s in trace.sections for e in s.edges].count(Wait.BRANCH) == 4  # two ways, two joins


def test_outcomes_that_end_in_the_same_state_are_joined(tmp_path: Path) -> None:
    """Twenty questions in a row: not a million ways, but one section behind each."""
    question = 'M56 P3\nif [#5399 == 1]\nmsg "on"\nelse\nmsg "off"\nendif\n'
    trace, findings = run(tmp_path, question * 20 + "G0 X1\nM30\n")
    assert "GP232" not in labels(findings)
    rows = sum(int((s.rows["op"] == Op.TRAVERSE).sum()) for s in trace.sections)
    assert rows == 1
    assert len(trace.sections) == 1 + 20 * 4


def test_a_loop_that_waits_for_an_input_is_a_cycle_of_sections(tmp_path: Path) -> None:
    """The way back leads to a section that is there already: no endless run, nothing left open."""
    trace, findings = run(tmp_path, "#1=0\nwhile [#1 == 0]\nM56 P2\n#1 = #5399\nG4 P0.1\nendwhile\nG0 X7\nM30\n")
    assert labels(findings) == []
    assert len(trace.sections) < 12
    assert any(e.target <= s.number for s in trace.sections for e in s.edges if e.target >= 0)
    assert all(xs(way) in ([7.0], []) for way in ways(trace))
    assert [7.0] in [xs(way) for way in ways(trace)]


def test_a_counter_in_an_unknown_loop_is_cut_off_as_unknown(tmp_path: Path) -> None:
    """Every turn is another state: so many are followed, and the rest is told."""
    text = "#2=0\nM56 P2\nwhile [#5399 == 0]\n#2=[#2+1]\nG0 X#2\nM56 P2\nendwhile\nM30\n"
    trace, findings = run(tmp_path, text, max_branches=8)
    assert labels(findings).count("GP232") == 1
    assert max(max(xs(way), default=0.0) for way in ways(trace)) == 4.0


def test_no_branches_allowed_is_unknown_at_the_first(tmp_path: Path) -> None:
    _, findings = run(tmp_path, "M56 P3\nif [#5399 == 1]\nG0 X1\nendif\nM30\n", max_branches=0)
    assert labels(findings) == ["GP232"]


def test_state_of_one_outcome_does_not_leak_into_the_other(tmp_path: Path) -> None:
    """Offsets, modes, parameters and the tool: each outcome has its own."""
    text = """M56 P3
if [#5399 == 1]
  G91
  #5 = 40
  G92 X100
  G20
  T3 M6
else
  #5 = 7
endif
G0 X1
G90 G21
G0 Y#5
M30
"""
    trace, _ = run(tmp_path, text)
    assert sorted(way[-1][1][:2] for way in ways(trace)) == [(1.0, 7.0), (25.4, 40.0)]


def test_what_bounds_decide_is_no_question(tmp_path: Path) -> None:
    """A digital input is 0 or 1: it is never above 1, and never negative."""
    trace, _ = run(tmp_path, "M56 P3\nif [#5399 > 1]\nG0 X900\nendif\nif [#5399 >= 0]\nG0 X1\nendif\nM30\n")
    assert [xs(way) for way in ways(trace)] == [[1.0]]


@pytest.mark.parametrize(
    ("condition", "expected"),
    [
        ("[#4001 < 5] or [#4001 > 1]", [[1.0]]),
        ("#4001 < 11", [[1.0]]),
        ("[#4001 * 2] > 30", [[2.0]]),
        ("#4001 == 3", [[1.0], [2.0]]),
        ("[#4001 - #4001] < 9", [[1.0]]),
        ("abs[#4001] >= 2", [[1.0]]),
        ("[#4001 >= 2] and [#4001 <= 10]", [[1.0]]),
        ("not[#4001]", [[2.0]]),
    ],
)
def test_stated_bounds(tmp_path: Path, condition: str, expected: list[list[float]]) -> None:
    """A persistent value that the setup states as 2 ... 10."""
    setup = dataclasses.replace(ZERO, parameter_ranges={4001: Interval(2.0, 10.0)}, default_parameter=None)
    trace, _ = run(tmp_path, f"if [{condition}]\nG0 X1\nelse\nG0 X2\nendif\nM30\n", setup=setup)
    assert sorted(xs(way) for way in ways(trace)) == expected


def test_an_axis_word_that_is_only_bounded(tmp_path: Path) -> None:
    """The place is an unknown of its own, and the trace tells its range."""
    setup = dataclasses.replace(ZERO, parameter_ranges={4001: Interval(2.0, 10.0)}, default_parameter=None)
    trace, findings = run(tmp_path, "G0 X[#4001 + 1] Y1\nG91 G0 X5\nM30\n", setup=setup)
    assert "GP225" not in labels(findings)
    rows = trace.sections[0].rows
    moves = [i for i, op in enumerate(rows["op"].tolist()) if op == Op.TRAVERSE]
    forms = [trace.frames[rows["frame"][i]][0] for i in moves]
    assert len(forms[0]) == 1 and forms[0] == forms[1]
    known = trace.symbols[forms[0][0][0]]
    assert known.low == pytest.approx(3.0) and known.high == pytest.approx(11.0)
    assert [rows["to"][i][0] for i in moves] == [0.0, 5.0]


def test_dialog_answers_follow_the_setup(tmp_path: Path) -> None:
    """4.2: OK or cancel are both followed; the value is what the setup bounds."""
    setup = dataclasses.replace(ZERO, parameter_ranges={100: Interval(1.0, 2.0)})
    text = 'dlgmsg "size" "width" 100\nif [#5398 == 1]\nG0 X#100\nelse\nG0 X-1\nendif\nM30\n'
    trace, findings = run(tmp_path, text, setup=setup)
    assert "GP225" not in labels(findings)
    assert len(ways(trace)) == 2
    (known,) = trace.symbols.values()
    assert (known.low, known.high) == pytest.approx((1.0, 2.0))


def test_render_takes_the_answers_of_the_controllers_drawing(tmp_path: Path) -> None:
    """4.2: when it draws, #5397 is 1, dialogs do not appear, #5398 is 1."""
    text = '#100=4\ndlgmsg "size" "width" 100\nif [#5398 == 1]\nG0 X#100\nendif\nG0 Y#5397\nM30\n'
    trace, _ = run(tmp_path, text, render=True)
    assert ways(trace) == [[("traverse", (4.0, 0.0, 0.0)), ("traverse", (4.0, 1.0, 0.0))]]


def test_the_machine_runs_it_not_the_drawing(tmp_path: Path) -> None:
    """3.1.1: #5397 is 0 when the job runs, #5380 is 0 without simulation."""
    trace, _ = run(tmp_path, "if [#5397 == 0]\nG0 X1\nelse\nG0 X2\nendif\nG0 Y[#5380+3]\nM30\n")
    assert [xs(way) for way in ways(trace)] == [[1.0, 1.0]]


def test_a_loop_that_goes_on_elsewhere_meets_the_budget(tmp_path: Path) -> None:
    from passes.interpret.core.programs import load_program

    from gproof.driver.running import execute
    from gproof.ir.finding import Findings
    from gproof.ir.machine import NO_MACHINE

    job = tmp_path / "job.cnc"
    job.write_text("G21 G91\nwhile [1 == 1]\nG0 X0.1\nendwhile\nM30\n")
    findings = Findings()
    program = load_program(job, findings)
    assert program is not None
    execute(program, ZERO, NO_MACHINE, findings, budget=1000).verify()
    assert labels(findings)[-1] == "GP233"
    assert findings.kept[-1].span.line == 2
    assert findings.kept[-1].hint.startswith("check the loop here, at pass 5")


def test_random_programs_agree_with_runs_that_know_the_inputs(tmp_path: Path) -> None:
    """Whatever an input turns out to be, the run that knows it is one of the ways that were found."""
    import random

    rng = random.Random(20261121)
    for case in range(40):
        text = _random_program(rng, depth=3)
        trace, findings = run(tmp_path, text + "M30\n")
        if "GP232" in labels(findings):
            continue
        found = [tuple(way) for way in ways(trace, limit=5000)]
        for _ in range(6):
            answers = {500 + k: float(rng.random() < 0.5) for k in range(4)}
            known = text.replace("#5399", "#599")
            for k in range(4):
                known = known.replace(f"M56 P{k}\n", f"#599 = #{500 + k}\n")
            setup = dataclasses.replace(ZERO, parameters=answers)
            straight, _ = run(tmp_path, known + "M30\n", setup=setup)
            (way,) = ways(straight)
            assert tuple(way) in found, f"case {case}\n{text}\n{answers}"


def _random_program(rng: object, depth: int) -> str:
    import random

    assert isinstance(rng, random.Random)
    out = ""
    for _ in range(rng.randrange(1, 4)):
        match rng.randrange(4):
            case 0:
                out += f"G{rng.choice('01')} X{rng.randrange(9)} F100\n"
            case 1:
                out += f"#1 = [#1 + {rng.randrange(3)}]\nG0 Y#1\n"
            case 2:
                out += rng.choice(["G90\n", "G91\n"])
            case 3 if depth:
                inner, other = _random_program(rng, depth - 1), _random_program(rng, depth - 1)
                # Each input is asked once, so that runs that know it agree with themselves.
                out += f"M56 P{3 - depth}\nif [#5399 == 1]\n{inner}else\n{other}endif\n"
                return out
    return out


GRID = """#1=0 #2=0 #3=0
while [#1 < 30]
  #1 = [#1 + 1]
  G0 Z5
  G38.2 Z-5 F50
  if [#5067 == 1]
    #2 = [#2 + 1]
  else
    #3 = [#3 + 1]
    msg "missed "#3
  endif
endwhile
G0 Z5
G0 X#2 Y[#2 + #3]
M30
"""


def test_counters_of_many_outcomes_become_bounds(tmp_path: Path) -> None:
    """Thirty points that are touched or missed: not 2 to the 30 ways, and the counts lie between 0 and 30."""
    trace, findings = run(tmp_path, GRID)
    assert "GP232" not in labels(findings) and "GP225" not in labels(findings)
    assert len(trace.sections) < 3000
    ends = [
        (trace.frames[int(s.rows["frame"][row])][0], float(s.rows["to"][row][0]))
        for s in trace.sections
        for row in range(len(s.rows))
        if s.edges[0].wait is Wait.END and s.rows["op"][row] == Op.TRAVERSE
    ]
    low, high = 30.0, 0.0
    for form, value in ends:
        ranges = [trace.symbols[symbol] for symbol, _ in form]
        low = min(low, value + sum(r.low for r in ranges))
        high = max(high, value + sum(r.high for r in ranges))
    assert low <= 0.0 and 30.0 <= high < 30.1


def test_few_outcomes_stay_exact(tmp_path: Path) -> None:
    """Three questions, eight ways: arcs and areas behind them are judged for the numbers themselves."""
    question = "M56 P1\nif [#5399 == 1]\n#1=[#1*2]\nelse\n#1=[#1*3]\nendif\n"
    trace, _ = run(tmp_path, "#1=1\n" + question * 3 + "G0 X#1\nM30\n")
    assert sorted({xs(way)[0] for way in ways(trace)}) == [8.0, 12.0, 18.0, 27.0]


def test_ends_inside_outcomes_release_the_others(tmp_path: Path) -> None:
    """An errmsg, an M30 and a mistake in one outcome do not keep the other waiting."""
    for ending in ('errmsg "no"', "M30", "G0 X[1/0]\nM30"):
        inner = f"M56 P2\nif [#5399 == 1]\n{ending}\nendif\nG0 X1\n"
        text = f"M56 P1\nif [#5399 == 1]\n{inner}else\n{ending}\nendif\nG0 X5\nM30\n"
        trace, _ = run(tmp_path, text)
        assert [1.0, 5.0] in [xs(way) for way in ways(trace)]


def test_questions_inside_loops_inside_questions(tmp_path: Path) -> None:
    text = """#1=0
M56 P1
if [#5399 == 1]
  while [#1 < 5]
    #1=[#1+1]
    M56 P2
    if [#5399 == 0]
      G0 X#1
    endif
  endwhile
endif
G0 Y9
M30
"""
    trace, findings = run(tmp_path, text)
    assert "GP232" not in labels(findings)
    found = {tuple(xs(way)) for way in ways(trace)}
    assert (0.0,) in found and (1.0, 2.0, 3.0, 4.0, 5.0, 5.0) in found and (2.0, 4.0, 4.0) in found
    assert all(way[-1][1][1] == 9.0 for way in ways(trace))


def test_an_answer_that_the_setup_fixes_is_followed_alone(tmp_path: Path) -> None:
    """A list of two equal ends: the operator will type ten, and say OK."""
    ranges = {100: Interval(10.0, 10.0), 5398: Interval(1.0, 1.0)}
    setup = dataclasses.replace(ZERO, parameter_ranges=ranges)
    text = 'dlgmsg "size" "width" 100\nif [#5398 == 1]\nG0 X#100\nelse\nG0 X-1\nendif\nM30\n'
    trace, _ = run(tmp_path, text, setup=setup)
    assert [xs(way) for way in ways(trace)] == [[10.0]]
