"""Whatever is in a file, the compiler answers: no exception, no endless run, findings with a code and a place.

Each case judges a program in this process as `gproof check` does, renders what was found, prints the stages, and
compares the verdict with the findings. A failure prints its seed and the program, ready to be pasted.
"""

from __future__ import annotations

import dataclasses
import io
import json
import random
from collections.abc import Callable
from contextlib import redirect_stdout
from itertools import islice
from pathlib import Path

import pytest
from support.campaigns import seeds
from support.guarded import alarm
from support.wild import ROOT, corpus_jobs, mutated, random_bytes, wild_program

from gproof.cli.dump import loaded
from gproof.driver.judge import Judgement, judge
from gproof.driver.running import begin
from gproof.driver.session import Running, open_session
from gproof.ir.codes import CODES
from gproof.ir.finding import Findings, Severity
from gproof.ir.text import print_lines
from gproof.ir.verdict import Verdict
from gproof.report.summary import print_summary, report_json
from gproof.report.text import print_findings
from gproof.report.trace_jsonl import chunk_lines

BUDGET = 1500
SECONDS = 30
CHUNKS = 4
"""Of rows that are printed: thousands of pecks are the same lines again."""
GROUP = 50
DEFAULT, MORE, SOAK = 100, 1_000, 10_000

MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes]
x = {min = -100, max = 300, max_velocity = 100, max_acceleration = 500, steps_per_unit = 320}
y = {min = -100, max = 200, max_velocity = 100, max_acceleration = 500, steps_per_unit = 320}
z = {min = -100, max = 100, travel_min = -110, travel_max = 110}
a = {min = -360, max = 360}
[areas.tool_change]
x = [40, 60]
y = [40, 60]
z = [-100, 50]
[tools.1]
length = 12.5
x_offset = 1.0
"""
SETUP = """schema = "gproof-setup/1"
start = {x = 1.0, y = 2.0, z = 30.0, a = 0, b = 0, c = 0}
active_work = 1
tool = 1
work.1 = {x = 10.0, y = [5.0, 8.0], z = 0.0}
g92 = {x = 0, y = 0, z = 0}
parameters = {1 = 5.0, 100 = 2.5, 5161 = 1.0}
"""
AROUND = [
    (machine, setup) for machine in (None, "machine.toml", "other.toml") for setup in (None, "zero", "setup.toml")
]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "machine.toml").write_text(MACHINE)
    other = MACHINE.partition("[areas")[0] + "[controller]\nauto_tool_change = true\nabsolute_arc_centers = true\n"
    (tmp_path / "other.toml").write_text(other)
    (tmp_path / "setup.toml").write_text(SETUP)
    return tmp_path


def answers(job: Path, machine: Path | None, setup: str | None, budget: int = BUDGET) -> Judgement:
    """Judge, render, print the stages; every assertion holds for any bytes."""
    session = open_session(job, machine=machine, setup=setup, dialect="eding")
    judgement = judge(session, running=Running(budget, 16))
    out = io.StringIO()
    with redirect_stdout(out):
        print_findings(judgement.findings)
        print_summary(session, judgement)
    report = json.loads(json.dumps(report_json(session, judgement), allow_nan=False))
    assert report["verdict"] == judgement.verdict.value
    sizes = {str(job): job.read_bytes().count(b"\n") + 1}
    for finding in judgement.findings.kept:
        where = finding.span
        known = CODES[finding.code.number]
        # A program that ends itself on one outcome of several is told as a note; of calls within themselves that an
        # outcome asks for nobody knows how many there are.
        others = {245: known.as_note(), 288: known.as_note(), 117: known.as_unknown()}
        said = dataclasses.replace(finding.code, template=known.template)  # a code may have several sentences
        assert said in (known, others.get(known.number))
        assert finding.message
        assert "None" not in finding.message, finding.message
        assert " nan" not in finding.message, finding.message
        assert where.file == str(job), finding
        assert 0 <= where.line <= sizes[where.file], finding
        assert 0 <= where.column <= where.end_column or where.end_column == 0, finding
    severities = {f.severity for f in judgement.findings.kept}
    if judgement.verdict is Verdict.UNSAFE:
        assert Severity.ERROR in severities
    if judgement.verdict is Verdict.UNKNOWN:
        assert Severity.UNKNOWN in severities
    if judgement.verdict is Verdict.SAFE:
        in_policy = [f for f in judgement.findings.kept if f.code.decides != "feeds"]
        assert not {Severity.ERROR, Severity.UNKNOWN} & {f.severity for f in in_policy}
    if session.program is not None:
        for _ in print_lines(loaded(session.program)):
            pass
        ex = begin(
            session.program, session.setup, session.machine, Findings(), budget=BUDGET, stop_at_error=True,
            max_branches=16,
        )  # fmt: skip
        for chunk in islice(ex.chunks(), CHUNKS):
            for line in chunk_lines(chunk, session.machine, str(job)):
                json.loads(line, parse_constant=lambda what: pytest.fail(f"{what} in the trace"))
    return judgement


def survive(group: int, folder: Path, make: Callable[[random.Random], bytes]) -> None:
    job = folder / "job.cnc"
    for seed in range(group * GROUP, (group + 1) * GROUP):
        rng = random.Random(seed)
        data = make(rng)
        machine, setup = rng.choice(AROUND)
        job.write_bytes(data)
        given = str(folder / setup) if setup == "setup.toml" else setup
        try:
            with alarm(SECONDS):
                answers(job, None if machine is None else folder / machine, given)
        except BaseException:
            print(
                f"seed {seed}, machine {machine}, setup {setup}\njob.write_bytes({data!r})\n\n{data.decode('latin-1')}"
            )
            raise


CORPUS = corpus_jobs()


def from_bytes(rng: random.Random) -> bytes:
    return random_bytes(rng) if rng.random() < 0.4 else mutated(rng, CORPUS)


@pytest.mark.parametrize("group", seeds(DEFAULT // GROUP, MORE // GROUP))
def test_any_bytes(group: int, folder: Path) -> None:
    survive(group, folder, from_bytes)


@pytest.mark.parametrize("group", seeds(DEFAULT // GROUP, MORE // GROUP))
def test_any_program(group: int, folder: Path) -> None:
    survive(group, folder, wild_program)


@pytest.mark.soak
@pytest.mark.parametrize("group", range(SOAK // GROUP))
def test_any_bytes_for_long(group: int, folder: Path) -> None:
    survive(10_000 + group, folder, from_bytes)


@pytest.mark.soak
@pytest.mark.parametrize("group", range(SOAK // GROUP))
def test_any_program_for_long(group: int, folder: Path) -> None:
    survive(10_000 + group, folder, wild_program)


def test_the_generator_makes_programs_of_every_kind(folder: Path) -> None:
    """A fuzzer whose programs all fail at once finds nothing."""
    job, seen, found = folder / "job.cnc", set(), set()
    for seed in range(100):
        job.write_bytes(wild_program(random.Random(seed)))
        judgement = answers(job, folder / "machine.toml", "zero" if seed % 2 else None)
        seen.add(judgement.verdict)
        found |= {f.code.label for f in judgement.findings.kept}
    assert seen == set(Verdict)
    assert len(found) > 35


# -- programs that once raised or never ended

NESTED = "G21\n" + "if [1]\n" * 3000 + "G0 X1\n" + "endif\n" * 3000 + "M30\n"
CALLS = "".join(
    f"sub part_{n}\n" + "if [1]\n" * 150 + f"gosub part_{n + 1}\n" + "endif\n" * 150 + "endsub\n" for n in range(3)
)
HARD = {
    "a position beyond all numbers": ("G21 G90 G94\nG1 A1" + "0" * 200 + " F100\nM30\n", "UNSAFE", "GP228"),
    "a code beyond all numbers": ("G21 G90\nG[10**308] X1\nM30\n", "UNSAFE", "GP228"),
    "inches beyond all numbers": ("G20 G90\nG0 X[10**308]\nG92 X[10**308]\nG0 X1\nM30\n", "UNSAFE", "GP228"),
    "a park position beyond all numbers": ("G21 G90\n#5161 = [10**308]\nG28\nM30\n", "UNSAFE", "GP228"),
    "a radius beyond all numbers": ("G21 G90 G94\nG0 X0\nG2 X1 R1" + "0" * 200 + " F9\nM30\n", "UNSAFE", "GP228"),
    "deep nesting": (NESTED, "UNKNOWN", "GP113"),
    "deep nesting over calls": ("gosub part_0\nM30\n" + CALLS + "sub part_3\nendsub\n", "UNKNOWN", "GP113"),
    "a cycle without end": ("G21 G90 G94\nG91 G81 X1 Z-1 R1 L100000000 F100\nM30\n", "UNKNOWN", "GP113"),
    "endless pecks": ("G21 G90 G94\nG83 X1 Z-9 R1 Q.0000000001 F100\nM30\n", "UNKNOWN", "GP113"),
    "a long loop": ("G21\n#1 = 1\nwhile [#1]\n#1 = [#1 + 1 / #1]\nendwhile\nM30\n", "UNKNOWN", "GP233"),
    "a long loop of moves": ("G21\n#1 = 1\nwhile [1]\n#1 = [#1 + 1]\nG90 G0 X[1 / #1]\nendwhile\nM30\n", "UNKNOWN",
                             "GP233"),
    "recursion": ("G21\ngosub a\nM30\nsub a\ngosub a\nendsub\n", "UNSAFE", "GP117"),
    "a radius of nearly no chord": ("G21 G90 G94\nG91 G1 X0.1 F100\nX0.2\nX-0.3\nG90\nG3 X0 Y0 R10\nM30\n",
                                    "UNSAFE", "GP404"),
    "a code that is not modelled": ("G21 G90 G94\nG0 X0 Y0\nM64 P1\nG1 X60 F9\nG3 X80 I10\nM30\n", "UNKNOWN", "GP113"),
}  # fmt: skip


@pytest.mark.parametrize("name", HARD)
def test_hard_programs_are_answered(name: str, folder: Path) -> None:
    text, verdict, code = HARD[name]
    job = folder / "job.cnc"
    job.write_text(text)
    with alarm(SECONDS):
        # Calls within six others count for more.
        judgement = answers(job, folder / "machine.toml", "zero", 20_000 if name == "recursion" else BUDGET)
    deciding = {f.code.label for f in judgement.findings.kept if f.severity in (Severity.ERROR, Severity.UNKNOWN)}
    assert code in deciding
    assert judgement.verdict.value == verdict, deciding


def test_columns_count_characters(folder: Path) -> None:
    job = folder / "job.cnc"
    job.write_bytes(b"\xef\xbb\xbfG21 (\xc3\xbc) G90 G1 X5\n(\xfc) G92 G1 X1\n(\xc3\xbc) G93 G92 G0 X1\n")
    judgement = answers(job, folder / "machine.toml", "zero")
    places = [(f.code.label, f.span.line, f.span.column, f.span.end_column) for f in judgement.findings.kept]
    assert ("GP204", 1, 1, 18) in places
    assert ("GP224", 2, 5, 8) in places
    assert ("GP224", 3, 9, 12) in places


def test_corpus_is_there() -> None:
    assert len(CORPUS) > 20
    assert (ROOT / "corpus").is_dir()
