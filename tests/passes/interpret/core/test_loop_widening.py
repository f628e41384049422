"""Loops of more passes than anybody follows: counters without a part, passes that are alike, and the block budget."""

from __future__ import annotations

import itertools
import random
from pathlib import Path
from typing import Any

import pytest
from passes.interpret.mcuwin.mcuwin_programs import labels, moves, program, run
from passes.interpret.mcuwin.test_flow import Maker, _without_calls
from support.campaigns import seeds

from gproof.driver.running import begin
from gproof.ir.finding import Findings
from gproof.ir.machine import NO_MACHINE
from gproof.ir.setup import ZERO
from gproof.ir.trace import Op, Trace
from gproof.passes.interpret.core.run import FIRST_BEAT, LEAST_BEAT, MOST_BEAT
from passes.interpret.core import programs

BUDGET = 2_000
MANY = "2000000000"
Way = list[tuple[float, ...]]


def all_labels(findings: Findings) -> list[str]:
    """Codes in order, notes too."""
    return [f.code.label for f in findings.kept]


def steps(trace: Trace) -> dict[int, Way]:
    """Places of each section, in order."""
    return {
        s.number: [tuple(s.rows["to"][n][:3].tolist()) for n in range(len(s.rows)) if s.rows["op"][n] < Op.DWELL]
        for s in trace.sections
    }


def some_way(trace: Trace, rng: random.Random) -> Way | None:
    """Places of one run to its end; None where that is too far."""
    made, at, way = steps(trace), 0, Way()
    edges = {s.number: s.edges for s in trace.sections}
    for _ in range(3_000):
        way += made[at]
        at = rng.choice(edges[at]).target
        if at < 0:
            return way
    return None


def has_way(trace: Trace, way: Way) -> bool:
    """Whether a run of the graph makes these places and ends behind them."""
    made = steps(trace)
    edges = {s.number: [edge.target for edge in s.edges] for s in trace.sections}
    todo, seen = [(0, 0)], set[tuple[int, int]]()
    while todo:
        section, done = todo.pop()
        if (section, done) in seen:
            continue
        seen.add((section, done))
        own = made[section]
        if way[done : done + len(own)] != own:
            continue
        done += len(own)
        for target in edges[section]:
            if target < 0 and done == len(way):
                return True
            if target >= 0:
                todo.append((target, done))
    return False


def alike_program(rng: random.Random) -> tuple[list[Any], list[Any], dict[str, list[Any]]]:
    """What is in front of a loop and its body, which ends where it began; subprograms."""
    maker = Maker(rng.randrange(10**6), inputs=rng.random() < 0.5)
    body = [f"G00 X{rng.randint(1, 3)}", *maker.body(1, [], size=3), "G00 X0"]
    if rng.random() < 0.7:
        body += ["CI600 := 0", "CI601 := 1", "CI602 := 2"]
    if rng.random() < 0.4:
        body.append("CI603 := CI603 + 1")
    subs = {name: _without_calls([*maker.body(0, [], size=2), "M17"]) for name in ("900", "901")}
    return ["G90", "CI600 := 0", "CI601 := 1", "CI602 := 2", "CI603 := 0"], body, subs


def looped(kind: str, count: str, body: list[Any]) -> tuple[list[Any], dict[str, list[Any]]]:
    if kind == "call":
        return [f"M98 L7 O{count}"], {"7": [*_without_calls(body), "M17"]}
    return [("for", "V0", "1", count, False, body) if kind == "for" else ("for", "V0", count, "1", True, body)], {}


def test_a_loop_that_is_left_open_holds_the_loop_of_any_count() -> None:
    opened = 0
    for seed in range(30):
        rng = random.Random(seed)
        head, body, subs = alike_program(rng)
        kind = rng.choice(["call", "for", "downto"])
        loop, more = looped(kind, MANY, body)
        many, findings = run([*head, *loop, "G00 X77"], *subs.items(), *more.items(), max_branches=100, budget=BUDGET)
        if "GP522" not in all_labels(findings) or {"GP232", "GP233"} & set(labels(findings)):
            continue
        opened += 1
        for count in (17, 24):
            loop, more = looped(kind, str(count), body)
            some, _ = run([*head, *loop, "G00 X77"], *subs.items(), *more.items(), max_branches=400)
            for _ in range(3):
                way = some_way(some, rng)
                assert way is None or has_way(many, way), (seed, kind, count, head, body, subs, way)
    assert opened > 10


@pytest.mark.parametrize("kind", ["call", "for", "downto"])
def test_alike_passes_are_told_and_all_that_follows_is_judged(kind: str) -> None:
    loop, more = looped(kind, MANY, ["G90 G00 X5", "CI601 := CI601 + 1", "G00 X0"])
    trace, findings = run(["CI601 := 0", *loop, "G00 X9"], *more.items(), budget=BUDGET)
    assert all_labels(findings).count("GP522") == 1
    assert labels(findings) == []
    assert 9 in {move[1] for move in moves(trace)}


def test_a_loop_of_few_passes_is_followed_to_its_end() -> None:
    trace, findings = run(["G90", ("for", "V0", "1", "400", False, ["G00 X5", "X0"])], budget=BUDGET)
    assert all_labels(findings) == []
    assert len(moves(trace)) == 800


def test_a_variable_that_counts_alike_passes_is_anything_it_may_be() -> None:
    body = ["G90 G00 X(V0)", "X0"]
    trace, findings = run([("for", "V0", "1", MANY, False, body), "G00 X9"], budget=BUDGET)
    assert "GP522" in all_labels(findings)
    symbol = next(reversed(trace.symbols.values()))
    assert symbol.low <= 17
    assert symbol.high == 2e9


# ---- counters that have no part in what happens


@pytest.mark.parametrize("more", [
    [], ["CI601 := 5 - CI602"], ["CD600 := CD600 + 0.25"], ["CI602 := CI601 - 1000"],
])  # fmt: skip
def test_a_counter_does_not_keep_a_loop_from_being_endless(more: list[str]) -> None:
    items = ["CI601 := 0", "CI602 := 0", "CD600 := 0", "L1", "G90 G00 X1", "X0", "CI601 := CI601 + 1", *more, "M96 L1"]
    assert labels(run(items, budget=BUDGET)[1]) == ["GP506"]


def test_a_counter_of_32_bits_is_told_when_it_is_full() -> None:
    _, findings = run(["CI601 := 0", "L1", "CI601 := CI601 + 1000", "M96 L1"], budget=BUDGET)
    assert findings.kept[0].hint == "check CI601: it counts passes and exceeds 32 bits after 2147466 passes"


@pytest.mark.parametrize("body", [
    # It ends the loop; where it goes; in a subprogram; what it becomes grows by itself; a count of a call.
    [("if", "CI601 > 999", ["M96 L2"])],
    ["G00 X(CI601)"],
    ["M98 L7"],
    ["CI603 := CI601 * 2", "CI604 := CI603 + 1", ("if", "CI604 > 1999", ["M96 L2"])],
    ["M901 601"],
])  # fmt: skip
def test_a_counter_that_has_a_part_keeps_passes_apart(body: list[Any]) -> None:
    items = ["CI601 := 0", "L1", "G90 G00 X1", "X0", "CI601 := CI601 + 1", *body, "M96 L1", "L2", "G00 X9"]
    _, findings = run(items, ("7", [("if", "CI601 > 999", ["G00 X3"]), "M17"]), budget=BUDGET)
    assert "GP506" not in labels(findings)
    assert "GP233" in labels(findings)


FAST = ["G04 1", "CI601 := CI601 + 100000000"]
ASSUMED = "CI601 only counts and stays within 32 bits (11)"


@pytest.mark.parametrize("loop", [
    # It leaves its 32 bits in the 22nd pass.
    [("while", "IN5 == 1", FAST)],
    [("repeat", FAST, "IN5 == 1")],
    ["L1", *FAST, "M96 L1"],
    [("while", "1 == 1", FAST)],
    [("while", "IN5 == 1", [("if", "IN6 == 1", FAST)])],
    # And in the first ones, from near their end.
    ["CI601 := 2147483600", ("while", "IN5 == 1", ["G04 1", "CI601 := CI601 + 2"])],
    ["CI601 := 2147483600", "L1", "G04 1", "CI601 := CI601 + 2", "M96 L1"],
])  # fmt: skip
def test_a_counter_that_is_full_before_long_has_a_part(loop: list[Any]) -> None:
    assert "GP228" in labels(run(["CI601 := 0", *loop, "G00 X9"], budget=BUDGET, max_branches=400)[1])


def test_that_a_slow_counter_is_never_full_is_assumed() -> None:
    for loop in (["L1", "G04 1", "CI601 := CI601 + 1", "M96 L1"], [("while", "IN5 == 1", ["CI601 := CI601 + 1"])]):
        ex = begin(program(["CI601 := 0", *loop, "M30"]), ZERO, NO_MACHINE, Findings(), max_branches=400)
        list(ex.chunks())
        assert ASSUMED in ex.assumed


def test_a_number_that_doubles_is_no_counter() -> None:
    """It leaves its 32 bits in the 32nd pass, which is an error."""
    assert "GP228" in labels(run(["CI601 := 1", "L1", "CI601 := CI601 * 2", "M96 L1"], budget=BUDGET)[1])


def test_alike_passes_that_fill_a_counter_are_followed() -> None:
    loop = ("for", "V0", "1", MANY, False, ["G04 5", "CI601 := CI601 + 2"])
    assert labels(run(["CI601 := 0", loop], budget=BUDGET)[1]) == ["GP233"]


@pytest.mark.parametrize("loop", [
    ["L1", "CI601 := CI601 + 1", ("if", "IN5 == 1", ["M96 L2"]), "M96 L1", "L2"],
    [("while", "IN5 == 1", ["CI601 := CI601 + 1"])],
    [("repeat", ["CI601 := CI601 + 1", "G04 5"], "IN5 == 1")],
    [("for", "V0", "1", "5000", False, [("if", "IN5 == 1", ["G00 X1"], ["G00 X2"]), "X0"])],
])  # fmt: skip
def test_counting_while_one_waits_for_an_input(loop: list[Any]) -> None:
    trace, findings = run(["G90", "CI601 := 0", *loop, "G00 X9"], max_branches=400)
    assert labels(findings) == []
    assert 9 in {move[1] for move in moves(trace)}
    assert len(trace.sections) < 200


# ---- loops that only count, at once


def counted(operator: str, value: int, steps: int, goal: int) -> int | None:
    """What a while loop that adds ``steps`` leaves; None where it does not end soon."""
    holds = {"<": lambda a: a < goal, "<=": lambda a: a <= goal, ">": lambda a: a > goal, ">=": lambda a: a >= goal,
             "!=": lambda a: a != goal, "==": lambda a: a == goal}[operator]  # fmt: skip
    for _ in range(3_000):
        if not holds(value):
            return value
        value += steps
    return None


def test_a_loop_that_counts_holds_what_its_passes_make() -> None:
    rng = random.Random(5)
    opposite = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "!=": "==", "==": "!="}
    ended = 0
    for _ in range(150):
        operator = rng.choice(sorted(opposite))
        step, passes = rng.choice([-7, -2, -1, 1, 3, 10]), rng.randint(0, 300)
        value = rng.randint(-50, 50)
        goal = value + step * passes + rng.choice([0, 0, 0, 1, -1])
        wanted = counted(operator, value, step, goal)
        sign = "+" if step > 0 else "-"
        body = [f"CI601 := CI601 {sign} {abs(step)}", "CI602 := 2 + CI602"]
        head = [f"CI601 := {value}", "CI602 := 0", f"CI603 := {goal}", "G90"]
        test = rng.choice([f"CI601 {operator} {goal}", f"CI601 {operator} CI603"])
        trace, findings = run([*head, ("while", test, body), "G00 X(CI601) Y(CI602)"], budget=100)
        if wanted is None:
            assert {"GP228", "GP233"} & set(labels(findings))
            continue
        ended += 1
        place = ("TRAVERSE", wanted, 2 * (wanted - value) // step, 0)
        assert (moves(trace) or [("TRAVERSE", 0, 0, 0)]) == [place], (operator, value, step, goal)
        if wanted != value:
            test = test.replace(operator, opposite[operator], 1)
            trace, _ = run([*head, ("repeat", body, test), "G00 X(CI601) Y(CI602)"], budget=100)
            assert moves(trace) == [place]
    assert ended > 60


@pytest.mark.parametrize(("first", "last", "down"), [(1, 1_000_000, False), (500, -499_500, True)])
def test_a_counted_loop_that_counts(first: int, last: int, down: bool) -> None:
    loop = ("for", "V0", str(first), str(last), down, ["CI601 := CI601 + 3", "CD600 := CD600 - 1"])
    trace, findings = run(["CI601 := 7", "CD600 := 0", loop, "G90 G00 X(CI601) Y(CD600)"], budget=200)
    passes = abs(last - first) + 1
    assert moves(trace) == [("TRAVERSE", 7 + 3 * passes, -passes, 0)]
    assert all_labels(findings) == []


def test_counting_past_32_bits_is_found_at_its_end() -> None:
    found = run(["CI601 := 5", ("while", "CI601 > 0", ["CI601 := CI601 + 1"]), "G00 X9"], budget=300)[1]
    assert labels(found)[0] == "GP228"


def test_eding_counts_to_two_thousand_millions(tmp_path: Path) -> None:
    trace, findings = programs.run(tmp_path, "#1 = 0\nwhile [#1 < 2000000000]\n#1 = [#1 + 3]\nendwhile\nG0 X#1\nM30\n")
    assert trace.sections[0].rows["to"][-1][0] == 2000000001
    assert not {"GP233", "GP522"} & set(all_labels(findings))


# ---- other ways to write a loop


def same(items: list[Any], others: list[Any], *subs: tuple[str, list[Any]]) -> None:
    one, first = run(items, *subs)
    other, second = run(others, *subs)
    assert moves(one) == moves(other)
    assert set(labels(first)) == set(labels(second)) <= {"GP519"}


@pytest.mark.parametrize("seed", seeds(4, 12))
def test_a_loop_is_its_passes_one_behind_the_other(seed: int) -> None:
    rng = random.Random(seed)
    maker = Maker(seed, inputs=False)
    count = rng.randint(2, 5)
    body = [*maker.body(0, [], size=3), "G00 X(CI601)"]
    head = ["G91", "CI600 := 0", "CI601 := 1", "CI602 := 2", "CI605 := 0"]
    plain = [item for item in _without_calls(body) if item[0] != "L" and "M96" not in str(item)]
    passes = [line for _ in range(count) for line in plain]
    same([*head, *passes], [*head, ("for", "V0", "1", str(count), False, plain)])
    same([*head, *passes], [*head, ("for", "V0", str(count), "1", True, plain)])
    counting = [*plain, "CI605 := CI605 + 1"]
    same([*head, *passes], [*head, ("while", f"CI605 < {count}", counting)])
    same([*head, *passes], [*head, ("repeat", counting, f"CI605 >= {count}")])
    same([*head, *passes], [*head, "L50", *counting, ("if", f"CI605 < {count}", ["M96 L50"])])
    same([*head, *passes], [*head, "L50", ("if", f"CI605 == {count}", ["M96 L51"]), *counting, "M96 L50", "L51"])
    same([*head, *passes], [*head, f"M98 L7 O{count}"], ("7", [*plain, "M17"]))


# ---- the same in programs of Eding


def test_an_endless_loop_of_eding_is_told(tmp_path: Path) -> None:
    text = '#1 = 0\nwhile [1 == 1]\nG1 X1 F100\nX0\n#1 = [#1 + 1]\nmsg "part " #1\nendwhile\nM30\n'
    _, findings = programs.run(tmp_path, text)
    assert [f.code.label for f in findings.kept if f.severity.name != "NOTE"][-1:] == ["GP506"]


def test_eding_counts_while_it_waits(tmp_path: Path) -> None:
    text = "#1 = 0\nM56 P3\nwhile [#5399 == 1]\n#1 = [#1 + 1]\nM56 P3\nendwhile\nG0 X9\nM30\n"
    trace, findings = programs.run(tmp_path, text, max_branches=200)
    assert not {"GP232", "GP233"} & set(all_labels(findings))
    assert len(trace.sections) < 200


@pytest.mark.parametrize(
    "use", ["G1 X[#1 / 100]", "#[#2] = #1", "if [#1 > 500]\nG1 X3\nendif", "#3 = [1 / [500 - #1]]"]
)
def test_a_counter_of_eding_that_has_a_part(tmp_path: Path, use: str) -> None:
    text = f"#1 = 0\n#2 = 7\nM56 P3\nwhile [#5399 == 1]\n#1 = [#1 + 1]\nG1 X0 F100\n{use}\nM56 P3\nendwhile\nM30\n"
    _, findings = programs.run(tmp_path, text, max_branches=200)
    assert "GP232" in all_labels(findings)


def test_a_long_loop_gives_signs_of_life() -> None:
    items = ["CD600 := 1", ("while", "CD600 > 0", ["CD600 := CD600 + CD600 / CD600"]), "M30"]
    ex = begin(program(items), ZERO, NO_MACHINE, Findings(), budget=20_000)
    heard: list[int] = []
    ex.on_beat = lambda blocks, span: heard.append(blocks)
    list(ex.chunks())
    assert heard[0] <= FIRST_BEAT and heard[-1] > 20_000 - MOST_BEAT
    assert all(0 < after - before <= MOST_BEAT for before, after in itertools.pairwise(heard))


def test_signs_of_life_come_more_often_where_blocks_take_long(monkeypatch: pytest.MonkeyPatch) -> None:
    items = ["CD600 := 1", ("while", "CD600 > 0", ["CD600 := CD600 + CD600 / CD600"]), "M30"]
    ex = begin(program(items), ZERO, NO_MACHINE, Findings(), budget=5000)
    clock = itertools.count()
    monkeypatch.setattr("gproof.passes.interpret.core.run.time.monotonic", lambda: float(next(clock)))
    heard: list[int] = []
    ex.on_beat = lambda blocks, span: heard.append(blocks)
    list(ex.chunks())
    assert heard[-1] - heard[-2] == LEAST_BEAT


# ---- arrays of WinCNC


def wincnc(folder: Path, text: str, budget: int) -> tuple[Trace, Findings]:
    from gproof.driver.running import execute
    from gproof.frontend.wincnc.load import load_program
    from gproof.frontend.wincnc.machine import NO_SHOP
    from gproof.ir.setup import ZERO

    job = folder / "job.tap"
    job.write_text(text)
    findings = Findings()
    made = load_program(job, findings, NO_SHOP)
    assert made is not None
    trace = execute(made, ZERO, NO_SHOP, findings, budget=budget)
    trace.verify()
    return trace, findings


PART = ("G0 X1 Y2", "G1 X3 F10", "X1 Y5", "G91", "X1 Y1", "G90")


def test_an_array_of_wincnc_is_its_cells_one_behind_the_other(tmp_path: Path) -> None:
    lines = ["G90", "G0 X0 Y0"]
    array, _ = wincnc(tmp_path, "\n".join([*lines, "L10 C3 X7 E", "G92 X0 Y0", *PART, "L10", "G92", ""]), 1000)
    cells = [line for n in range(3) for line in (f"G0 X{7 * n} Y0", "G92 X0 Y0", *PART, "G92")]
    other, _ = wincnc(tmp_path, "\n".join([*lines, *cells, ""]), 1000)
    feeds = [row[1:] for row in moves(array) if row[0] == "FEED"]
    assert feeds == [row[1:] for row in moves(other) if row[0] == "FEED"]
    assert len(feeds) == 9


def test_an_array_of_too_many_cells_ends_with_the_budget(tmp_path: Path) -> None:
    lines = ["G90", "G0 X0 Y0", "L10 C1000000 X.001 E", "G92 X0 Y0", *PART, "L10", ""]
    _, findings = wincnc(tmp_path, "\n".join(lines), 500)
    assert labels(findings)[-1] == "GP233"
