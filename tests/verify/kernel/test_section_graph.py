"""What waits ends its section, sections follow one another to an end: forged graphs are refused, right ones pass.

The streams are right, step for step, in every case: only rows that wait and edges are changed, so that nothing but
the graph can be to blame.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable

import pytest
from verify.reference_stepper import Job, machine, step, stream_of

from gproof.ir.machine import Machine
from gproof.ir.machine_drives import drives_of
from gproof.ir.setup import NOTHING, HeightMap, Setup
from gproof.ir.stream import StepStream
from gproof.ir.trace import HEIGHT_MAP, Edge, Op, State, Trace, TraceSection, Wait
from gproof.ir.verdict import Verdict
from gproof.verify.kernel.section_graph import NOTES, WAITS, problems
from gproof.verify.stream import validate

KINDS = {
    Wait.OPERATOR: Op.STOP,
    Wait.TOOL_CHANGE: Op.TOOL_CHANGE,
    Wait.INPUT: Op.INPUT_WAIT,
    Wait.HOME: Op.HOME,
    Wait.END: Op.END,
}
ARTICLES = {Op.END: "the", Op.INPUT_WAIT: "an"}
GO_ON = [wait for wait in KINDS if wait is not Wait.END]


def made(*jobs: Job, edges: Iterable[tuple[Edge, ...]] = ()) -> tuple[StepStream, Trace]:
    """Each job a section; edges by section, those of its last row where none are given."""
    traces = [job.trace() for job in jobs]
    trace = traces[0]
    trace.texts.append("x y z a")
    stream = stream_of(step(jobs[0], machine()), machine())
    for number, (job, other) in enumerate(zip(jobs[1:], traces[1:], strict=True), start=1):
        trace.sections.append(dataclasses.replace(other.sections[0], number=number))
        stream.sections.append(step(job, machine()).section(number))
    for section, given in zip(trace.sections, edges, strict=False):
        section.edges = given
    return stream, trace


def edge(wait: Wait, target: int, outcome: str = "go on") -> Edge:
    return Edge(wait=wait, outcome=outcome, target=target)


def ways(count: int, *, wait: Wait = Wait.OPERATOR) -> list[Job]:
    """Sections to and fro that begin and end at the same place, so that any order of them fits."""
    jobs = [Job().rapid(x=1 + k).rapid(x=0).event(KINDS[wait], *([1.0, 0.0] if wait is Wait.TOOL_CHANGE else []))
            for k in range(count - 1)]  # fmt: skip
    return [*jobs, Job().rapid(y=1).rapid(y=0).add(Op.END)]


def line(count: int, wait: Wait = Wait.OPERATOR) -> list[tuple[Edge, ...]]:
    return [*((edge(wait, k + 1),) for k in range(count - 1)), (edge(Wait.END, -1, "end"),)]


def judged(jobs: list[Job], edges: list[tuple[Edge, ...]], on: Machine | None = None, setup: Setup = NOTHING) -> str:
    stream, trace = made(*jobs, edges=edges)
    report = validate(stream, trace, machine() if on is None else on, setup)
    if report.verdict is Verdict.SAFE:
        assert report.findings == ()
        return ""
    assert {f.code.label for f in report.findings} == {"GP810"}
    return " | ".join(f.message for f in report.findings)


# --- right ones ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("wait", GO_ON)
@pytest.mark.parametrize("count", [1, 2, 4])
def test_sections_in_a_line_pass(count: int, wait: Wait) -> None:
    assert judged(ways(count, wait=wait), line(count, wait)) == ""


def test_outcomes_may_part_and_meet() -> None:
    edges = [(edge(Wait.OPERATOR, 1, "yes"), edge(Wait.OPERATOR, 2, "no"), edge(Wait.OPERATOR, -1, "stop")),
             (edge(Wait.OPERATOR, 3),), (edge(Wait.OPERATOR, 3),), (edge(Wait.END, -1, "end"),)]  # fmt: skip
    assert judged(ways(4), edges) == ""


@pytest.mark.parametrize("note", sorted(NOTES))
def test_rows_that_only_note_something_may_follow_a_wait(note: Op) -> None:
    jobs = ways(2)
    jobs[0].add(note)
    jobs[0].rows[-1]["text"] = 0
    assert judged(jobs, line(2)) == ""


def test_a_question_needs_no_row_of_its_own() -> None:
    for wait in Wait:
        trace = Job().rapid(x=1).trace()
        rows = trace.sections[0].rows
        trace.sections[0].rows = rows.slice(0, 1)
        trace.sections[0].edges = (edge(wait, -1),)
        assert (list(problems(trace, drives_of(machine(), NOTHING))) == []) is (wait is Wait.OPERATOR)


def test_a_changer_goes_on_after_a_change_where_the_machine_has_one() -> None:
    job = Job().rapid(x=1).event(Op.TOOL_CHANGE, 3.0).rapid(x=0)
    by_hand = machine()
    changer = dataclasses.replace(by_hand, controller=dataclasses.replace(by_hand.controller, auto_tool_change=True))
    assert judged([job], line(1), changer) == ""
    assert "goes on after a tool change" in judged([job], line(1), by_hand)


# --- forged ones --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "after"),
    [(kind, after) for kind in WAITS if kind is not Op.PROBE
     for after in (Op.TRAVERSE, Op.DWELL, Op.COOLANT, Op.STOP, Op.END, Op.TOOL_CHANGE) if kind is not after],
)  # fmt: skip
def test_a_wait_that_was_merged_into_a_section_is_refused(kind: Op, after: Op) -> None:
    job = Job().rapid(x=1).event(kind)
    job = job.rapid(x=0) if after is Op.TRAVERSE else job.event(after)
    name = kind.name.lower().replace("_", " ")
    assert f"the section goes on after {ARTICLES.get(kind, 'a')} {name}" in judged([job], line(1))


@pytest.mark.parametrize("row", sorted(WAITS))
@pytest.mark.parametrize("wait", list(Wait))
def test_row_and_edge_are_of_one_kind(row: Op, wait: Wait) -> None:
    """Every wait beside every edge: only the edge of its kind passes."""
    job = Job().rapid(x=1).rapid(x=0)
    job = job.add(Op.PROBE, to=job.target(x=0), feed=60.0) if row is Op.PROBE else job.event(row)
    trace = job.trace()
    trace.sections[0].edges = (edge(wait, -1),)
    found = [problem.kind for problem in problems(trace, drives_of(machine(), NOTHING))]
    assert bool(found) is (WAITS[row] is not wait), found


@pytest.mark.parametrize("number", range(3))
def test_an_end_in_the_middle_is_refused(number: int) -> None:
    """Both the edge alone and the row with it."""
    edges = line(4)
    edges[number] = (edge(Wait.END, -1, "end"),)
    found = judged(ways(4), edges)
    assert "no row of it says so" in found and "nothing leads to this section" in found
    jobs = ways(4)
    jobs[number].rows[-1] |= {"op": Op.END}
    assert "nothing leads to this section" in judged(jobs, edges)
    jobs = ways(4)
    jobs[number].rows[-1] |= {"op": Op.END}
    assert "after the end comes operator" in judged(jobs, line(4))


def test_the_last_section_ends_the_program() -> None:
    assert judged(ways(2), [*line(2)[:1], (edge(Wait.OPERATOR, -1),)]) != ""
    assert "goes on with section 0" in judged(ways(2), [*line(2)[:1], (edge(Wait.END, 0),)])
    assert "what follows is not known" in judged(ways(2), [*line(2)[:1], ()])
    both = (edge(Wait.END, -1, "end"), edge(Wait.END, -1, "other"))
    assert judged(ways(2), [*line(2)[:1], both]) != ""


@pytest.mark.parametrize("back", [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)])
@pytest.mark.parametrize("wait", GO_ON)
def test_a_way_back_is_refused(back: tuple[int, int], wait: Wait) -> None:
    """Alone and as one of several outcomes."""
    here, there = back
    edges = line(4, wait)
    edges[here] = (edge(wait, there),)
    assert f"leads back to section {there}" in judged(ways(4, wait=wait), edges)
    edges[here] = (edge(wait, here + 1), edge(wait, there, "again"))
    assert f"leads back to section {there}" in judged(ways(4, wait=wait), edges)


@pytest.mark.parametrize("lost", [1, 2, 3])
def test_a_section_that_is_jumped_over_is_refused(lost: int) -> None:
    edges = line(5)
    edges[lost - 1] = (edge(Wait.OPERATOR, lost + 1),)
    assert f"section {lost}: nothing leads to this section" in judged(ways(5), edges)


@pytest.mark.parametrize("wait", [Wait.BRANCH, Wait.UNKNOWN])
def test_what_nobody_can_decide_is_refused(wait: Wait) -> None:
    jobs = [Job().rapid(x=1).rapid(x=0), *ways(2)]
    edges = [(edge(wait, 1, "yes"), edge(wait, 2, "no")), (edge(Wait.OPERATOR, 2),), (edge(Wait.END, -1, "end"),)]
    assert "cannot decide what follows" in judged(jobs, edges)


def test_two_kinds_or_two_equal_outcomes_are_refused() -> None:
    edges = [(edge(Wait.OPERATOR, 1), edge(Wait.TOOL_CHANGE, 1, "other")), (edge(Wait.END, -1, "end"),)]
    assert "at once" in judged(ways(2), edges)
    edges = [(edge(Wait.OPERATOR, 1), edge(Wait.OPERATOR, 1)), (edge(Wait.END, -1, "end"),)]
    assert "two continuations for one outcome" in judged(ways(2), edges)


def test_a_probing_move_is_no_feed() -> None:
    job = Job().line(x=1)
    probing = dataclasses.replace(job, rows=[dict(row) for row in job.rows])
    probing.rows[0] |= {"op": Op.PROBE}
    assert judged([job], line(1)) == ""
    assert "after a probe comes end" in judged([probing], line(1))
    assert "goes on after a probe" in judged([probing.add(Op.END)], line(1))


def test_no_sections_are_nothing_to_run() -> None:
    empty = Trace(files=["job.cnc"], states=[State()])
    stream = dataclasses.replace(made(Job())[0], sections=[])
    report = validate(stream, empty, machine(), NOTHING)
    assert report.verdict is Verdict.UNSAFE
    assert [f.message for f in report.findings] == [
        "damaged step stream: there is no section, so there is nothing to run"
    ]


# --- what passes refuse to lower ----------------------------------------------------------------------------

SPINDLE: dict[str, Callable[[Job], Job]] = {
    "follows the turns": lambda job: job.state(State(synchronised=True)),
    "speed follows the tool": lambda job: job.state(State(surface_speed=120.0)),
    "not a number": lambda job: job.state(State(surface_speed=float("nan"))),
    "another head": lambda job: job.state(State(head=2)),
    "velocities": lambda job: job.state(State(retimed=("L7",))),
    "backlash": lambda job: job.state(State(backlash=((0, 0.1),))),
    "orientation": lambda job: job.event(Op.ORIENT),
    "head row": lambda job: job.event(Op.HEAD, 1.0),
}


@pytest.mark.parametrize("name", SPINDLE)
def test_what_is_no_path_of_the_motors_alone_is_refused(name: str) -> None:
    assert judged([SPINDLE[name](Job().rapid(x=1)).line(x=0)], line(1)) != ""
    assert judged([Job().rapid(x=1).event(Op.HEAD, 0.0).line(x=0)], line(1)) == ""


def test_commands_that_no_board_carries_out_are_an_assumption() -> None:
    job = Job().rapid(x=1).add(Op.DEVICE, text=0).rapid(x=0)
    stream, trace = made(job)
    trace.texts[0] = "M210"
    report = validate(stream, trace, machine(), NOTHING)
    assert report.verdict is Verdict.SAFE
    told = [text for p in report.properties if p.name == "stream-event" for text in p.assumptions]
    assert told == ["no board executes M210: whoever runs the stream has to do it"]
    plain = validate(*made(Job().rapid(x=1)), machine(), NOTHING)
    assert [p.assumptions for p in plain.properties if p.name == "stream-event"] == [()]


def test_a_state_that_no_move_has_does_not_matter() -> None:
    job = Job().rapid(x=1).rapid(x=0).state(State(surface_speed=120.0)).add(Op.END)
    assert judged([job], line(1)) == ""


def test_a_map_that_is_on_is_followed() -> None:
    flat = HeightMap(x=0.0, y=0.0, size=10.0, heights=((0.0, 0.0), (0.0, 0.0)))
    job = Job().rapid(x=1).rapid(x=0)
    said = judged([job], line(1), setup=Setup(height_map=flat))
    assert "no move follows it" in said
    assert "on = false" in said, "what to do where the job itself switches it off"
    assert judged([job], line(1), setup=Setup(height_map=dataclasses.replace(flat, on=False))) == ""
    following = Job(states=[State(following=(HEIGHT_MAP,))]).rapid(x=1).rapid(x=0)
    assert judged([following], line(1), setup=Setup(height_map=flat)) == ""


def test_long_graphs_are_walked_without_recursion() -> None:
    """3,000 sections one after the other, and the same with a way back at the very end."""
    first = Job().event(Op.STOP)
    section = first.trace().sections[0]
    count = 3000
    sections = [
        TraceSection(
            number=k, start=section.start, start_frame=0, rows=section.rows, edges=(edge(Wait.OPERATOR, k + 1),)
        )
        for k in range(count)
    ]
    sections.append(dataclasses.replace(Job().trace().sections[0], number=count))
    trace = dataclasses.replace(first.trace(), sections=sections)
    assert list(problems(trace, drives_of(machine(), NOTHING))) == []
    sections[count - 1].edges = (edge(Wait.OPERATOR, 0),)
    found = [problem.kind for problem in problems(trace, drives_of(machine(), NOTHING))]
    assert found == ["graph.back", "graph.no-way"]
