"""Loops of every kind against a second reading that runs each pass of them: never SAFE where that finds an error.

Budgets are small, so that states that come again, alike passes and outcomes that join decide most of the answers.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from passes.interpret.core.loop_programs import Maker, Run, Tale, print_eding, print_mcuwin
from support.campaigns import sizes

from gproof.driver.judge import Judgement, judge
from gproof.driver.session import Running, open_session
from gproof.ir import codes
from gproof.ir.finding import Severity
from gproof.ir.verdict import Verdict

BUDGETS = ((60, 4), (300, 40), (3000, 200))
CLOSE = 1e-6
DIN = """[din]
case_sensitive = false
line_numbers = false
position_unit = "mm"
time_unit = "min"
absolute_centers = false
interpolation_axes = "XYZ"
zero_offsets = [[0, 0, 0], [3, -2, 0]]
[din.task0]
M30 = "end"
"""
EDING = '[controller]\ndialect = "eding"\n'


def machine_file(folder: Path, room: float, *, pascal: bool) -> Path:
    """Three axes of so many mm on both sides of 0."""
    path = folder / "machine.toml"
    axis = f'kind = "linear"\nmin = {-room}\nmax = {room}\ntravel_min = {-room}\ntravel_max = {room}\n'
    axis += 'position_unit = "mm"\n' if pascal else ""
    text = 'schema = "gproof-machine/1"\nunits = "mm"\nname = "m"\n' + "".join(f"[axes.{n}]\n{axis}" for n in "xyz")
    path.write_text(text + (DIN if pascal else EDING))
    return path


@dataclass(frozen=True)
class Case:
    """A program of one controller."""

    tale: Tale
    pascal: bool

    @property
    def asks(self) -> bool:
        return "'input'" in str(self.tale)

    @property
    def text(self) -> str:
        return print_mcuwin(self.tale) if self.pascal else print_eding(self.tale)

    def judged(self, folder: Path, budget: tuple[int, int]) -> Judgement:
        job = folder / ("job.src" if self.pascal else "job.cnc")
        job.write_text(self.text)
        machine = machine_file(folder, self.tale.room, pascal=self.pascal)
        session = open_session(job, machine=machine, setup="zero", dialect="mcuwin" if self.pascal else "eding")
        return judge(session, running=Running(*budget))

    def runs(self, rng: random.Random) -> Iterator[tuple[Run, str]]:
        """Runs with all kinds of inputs, and how each ended."""
        for answer in answers(rng) if self.asks else [lambda: True]:
            run = Run(self.tale, self.pascal, answer)
            yield run, run.go()


def case(seed: int) -> Case:
    rng = random.Random(seed)
    pascal, inputs = rng.random() < 0.65, rng.random() < 0.5
    return Case(Maker(rng, pascal=pascal, inputs=inputs).tale(), pascal)


def answers(rng: random.Random) -> Iterator[Callable[[], bool]]:
    """Inputs that stay, that come by chance, that come once, go once, and come again and again."""
    yield lambda: True
    yield lambda: False
    for often in (0.5, 0.5, 0.05, 0.95, 0.2, 0.8):
        yield lambda often=often: rng.random() < often  # type: ignore[misc]
    for late in (2, 3, 7, 20, 40):
        for comes in (lambda n, late: n % late != 0, lambda n, late: n > late, lambda n, late: n <= late):
            yield counting(comes, late)


def counting(comes: Callable[[int, int], bool], late: int) -> Callable[[], bool]:
    asked = 0

    def answer() -> bool:
        nonlocal asked
        asked += 1
        return comes(asked, late)

    return answer


def within(run: Run, told: Judgement, *, exact: bool = False) -> bool:
    """Whether the told box holds what a run did, and where it is to be exact, nothing else but where the job began."""
    box = {name: (low, high) for name, relative, low, high in told.summary.box if not relative}
    for axis in "XY":
        if run.low[axis] > run.high[axis]:
            continue
        low, high = box.get(axis.lower(), (0.0, 0.0))
        if run.low[axis] < low - CLOSE or run.high[axis] > high + CLOSE:
            return False
        wide = min(run.low[axis], 0.0) - min(low, 0.0) + max(high, 0.0) - max(run.high[axis], 0.0)
        if exact and wide > CLOSE:
            return False
    return True


@pytest.mark.parametrize(("first", "count", "least"), sizes((0, 24, 8), (24, 6_000, 2_000)))
def test_no_pass_of_a_loop_is_worse_than_the_answer(tmp_path: Path, first: int, count: int, least: int) -> None:
    safe = 0
    for seed in range(first, first + count):
        one = case(seed)
        runs = list(one.runs(random.Random(seed)))
        wrong = next((end for run, end in runs if end.startswith("wrong") or run.outside()), None)
        for budget in BUDGETS:
            told = one.judged(tmp_path, budget)
            shown = f"seed {seed}, {budget}\n{one.text}"
            if told.verdict is Verdict.SAFE:
                safe += 1
                assert wrong is None, f"SAFE, but {wrong}: {shown}"
                assert all(within(run, told) for run, _ in runs), f"box {told.summary.box}: {shown}"
                if not one.asks and runs[0][1] == "done" and codes.ALIKE_PASSES.number not in told.findings.counts:
                    assert within(runs[0][0], told, exact=True), f"box {told.summary.box}: {shown}"
            elif told.verdict is Verdict.UNSAFE and not one.asks and runs[0][1] == "done":
                errors = [f.message for f in told.findings.kept if f.severity is Severity.ERROR]
                assert wrong is not None, f"UNSAFE, but no pass is: {errors}, {shown}"
    assert safe > least


@pytest.mark.parametrize(("body", "verdict"), [
    ("CI602 := turn * turn", Verdict.UNKNOWN),
    ("CI602 := 0 - 2147400000 - turn - turn", Verdict.UNKNOWN),
    ("CI602 := turn + 2147400000", Verdict.SAFE),
])  # fmt: skip
def test_what_is_computed_from_alike_passes_may_leave_its_32_bits(tmp_path: Path, body: str, verdict: Verdict) -> None:
    """In one of 50000 passes it does, and nothing else depends on it."""
    text = f"$DINEND\nvar turn : integer;\n{{$DINSTART}}\n%A\nG53\nG90\n$for turn := 1 to 50000 do begin\n{body}\n"
    job = tmp_path / "job.src"
    job.write_text(f"{text}G00 X1\nG00 X0\n$end;\nM30\n%\n")
    session = open_session(job, machine=machine_file(tmp_path, 9.0, pascal=True), setup="zero", dialect="mcuwin")
    told = judge(session, running=Running(2_000, 100))
    assert told.verdict is verdict, [f.message for f in told.findings.kept]
