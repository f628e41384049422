"""Boundaries against a dense walk of the path: nothing beyond them is missed, nothing inside them is told.

WinCNC Users Guide, Soft Limit / Boundaries; L20 to L23.1; M37. The walk follows rows of the trace, which other tests
compare with the manual; which boundaries are in force at a line is read from the program's own lines.
"""

from __future__ import annotations

import math
import random
from dataclasses import replace
from pathlib import Path

import pytest
from metamorphic.jobs import Run
from metamorphic.wincnc_jobs import AXES, Job, run
from metamorphic.wincnc_programs import Can, Line, Maker, Program, Word, code, flat, number, text_of

from gproof.driver.judge import judge
from gproof.driver.session import Running, open_session
from gproof.ir import codes
from gproof.ir.trace import Chunk, Op
from gproof.ir.verdict import Condition, Verdict

STEPS = 720
SAMPLED = 320.0 * 1.5 * (1 - math.cos(math.pi / STEPS))
"""mm: by how much an arc of the largest radius here may go past its samples."""
NEAR = 1e-6

Row = tuple[int, int, list[float], list[float], list[float], int]
"""Line, op, from, to, centre, turns."""


def rows_of(folder: Path, job: Job) -> list[Row]:
    """The rows that move, as run() has left the job in the folder."""
    session = open_session(
        folder / "job.tap", machine=folder / "machine.toml", setup=str(folder / "setup.toml"), dialect="wincnc"
    )
    out: list[Row] = []

    def observe(chunk: Chunk) -> None:
        rows = chunk.rows
        for n, before in enumerate(chunk.starts().tolist()):
            if rows["op"][n] < 10:
                to, center = rows["to"][n].tolist(), rows["center"][n].tolist()
                out.append((int(rows["line"][n]), int(rows["op"][n]), before, to, center, int(rows["turns"][n])))

    judge(session, running=Running(), observe=observe)
    return out


def reach(row: Row) -> tuple[list[float], list[float]]:
    """The least and the largest machine place of each axis, by samples of the way, for lines at their ends."""
    _, op, before, to, center, turns = row
    points = [to[:4]]
    if op == Op.ARC:
        points.append([*before[:2], *to[2:4]])
        a = math.atan2(before[1] - center[1], before[0] - center[0])
        b = math.atan2(to[1] - center[1], to[0] - center[0])
        sweep = (b - a) % (2 * math.pi) if turns > 0 else -((a - b) % (2 * math.pi))
        if abs(sweep) < 1e-9 or 2 * math.pi - abs(sweep) < 1e-9:
            sweep = math.copysign(2 * math.pi, turns)
        radius = math.hypot(before[0] - center[0], before[1] - center[1])
        for n in range(1, STEPS):
            angle = a + sweep * n / STEPS
            points.append([center[0] + radius * math.cos(angle), center[1] + radius * math.sin(angle), to[2], to[3]])
    return [min(p[n] for p in points) for n in range(4)], [max(p[n] for p in points) for n in range(4)]


class Fence:
    """Boundaries as lines of a program set them, and whether they are checked."""

    def __init__(self, job: Job) -> None:
        self.given = {n: job.bounds.get(n, (None, None)) for n in AXES}
        self.now = dict(self.given)
        self.on = True
        self.shift = dict.fromkeys(AXES, 0.0) | {n: float(v) for n, v in job.measures.items()}  # type: ignore[arg-type]
        self.spaces = {54: (0.0, 0.0)} | {n: (job.sign * x, job.sign * y) for n, (x, y) in job.shifts.items()}  # type: ignore[operator]

    def read(self, line: str) -> None:
        name, *words = line.split()
        if name in ("L22", "L23", "L22.1", "L23.1"):
            side = 0 if name.startswith("L22") else 1
            for word in words or [n.upper() for n in AXES]:
                axis = word[0].lower()
                new = self.given[axis][side] if name.endswith(".1") or not words else float(word[1:])
                old = self.now[axis]
                self.now[axis] = (new, old[1]) if side == 0 else (old[0], new)
        elif name in ("L20", "L21"):
            self.on = name == "L20" and words != ["X2"]
        elif name in ("G54", "G55", "G56"):
            self.shift["x"], self.shift["y"] = self.spaces[int(name[1:])]

    def over(self, row: Row) -> list[float]:
        """By axis and side how far a row goes beyond what is in force; negative inside, samples only."""
        low, high = reach(row)
        out = []
        for n, axis in enumerate(AXES):
            least, most = self.now[axis]
            out.append(-math.inf if least is None else least + self.shift[axis] - low[n])
            out.append(-math.inf if most is None else high[n] - most - self.shift[axis])
        return out


EVENTS = ("L20", "L20 X1", "L20 X2", "L21", "L22", "L23", "L22.1 X Z", "L23.1 Y W", "G54", "G55", "G56")


def random_job(rng: random.Random, folder: Path) -> Job:
    """Moves, with boundaries, guards and workspaces that change on the way; boundaries near what is reached."""
    can = Can(calls=False, measures=False, turns=rng.random() < 0.3, local=rng.random() < 0.5)
    maker = Maker(rng, can)
    sign = rng.choice((1, -1))
    shifts = {n: (rng.randrange(-320, 320) / 16, rng.randrange(-320, 320) / 16) for n in (55, 56)}
    measures = {n: rng.randrange(-320, 320) / 16 for n in "zw"}
    maker.tool |= {n.upper(): v for n, v in measures.items()}
    program: Program = maker.program(1)
    for _ in range(rng.randrange(1, 7)):
        if rng.random() < 0.5:
            event = rng.choice(EVENTS)
            program.append((Line(text=event),))
            if event.startswith("G5"):
                # To the maker a workspace is what is added to X and Y, as a measure is to Z.
                x, y = shifts.get(int(event[1:]), (0.0, 0.0))
                maker.tool |= {"X": sign * x, "Y": sign * y}
        if rng.random() < 0.4:
            side = rng.choice((22, 23))
            words = [Word(n, (1 if side == 23 else -1) * rng.randrange(0, 640) / 16) for n in maker.axes()]
            program.append((Line((*code(f"L{side}"), *words)),))
        program.append((maker.arc(),) if rng.random() < 0.4 else maker.group())
    job = Job(text_of(["G22", *flat(program)]), shifts=shifts, sign=sign, measures=dict(measures))
    run(folder, job)
    rows = rows_of(folder, job)
    fence = Fence(replace(job, bounds={}))
    reached: list[tuple[float, float]] = []
    for n, axis in enumerate(AXES):
        ends = [reach(row) for row in rows]
        low, high = min(e[0][n] for e in ends), max(e[1][n] for e in ends)
        reached.append((low - fence.shift[axis], high - fence.shift[axis]))
    sizes = rng.choice(((0.02, 0.5, 30.0), (0.02, 0.5, 30.0, -0.02, -0.5)))
    bounds = {}
    for axis, (low, high) in zip(AXES, reached, strict=True):
        a, b = round(low - rng.choice(sizes), 4), round(high + rng.choice(sizes), 4)
        bounds[axis] = (rng.choice((a, a, None)), rng.choice((b, b, None)))
        if bounds[axis] == (None, None) or a > b:
            bounds[axis] = (a, None)
    return replace(job, bounds=bounds)


def told(seed: int, job: Job, one: Run) -> str:
    return f"seed {seed}\n{job.told()}{one.told()}"


@pytest.mark.parametrize("group", range(3))
def test_boundaries_agree_with_a_dense_walk(group: int, tmp_path: Path) -> None:
    """UNSAFE where a point of the walk lies beyond, told line by line; and only there, or within the samples' error."""
    seen = set()
    for seed in range(group * 1000, group * 1000 + 12):
        rng = random.Random(seed)
        job = random_job(rng, tmp_path)
        one = run(tmp_path, job)
        where = told(seed, job, one)
        assert one.clean, where
        lines = job.program.splitlines()
        fence, at = Fence(job), 0
        beyond: dict[tuple[int, bool], float] = {}
        for row in rows_of(tmp_path, job):
            while at < row[0]:
                fence.read(lines[at])
                at += 1
            key = row[0], fence.on
            beyond[key] = max(beyond.get(key, -math.inf), *fence.over(row))
        found = {
            (f.span.line, f.code is codes.BOUNDARY_EXCEEDED)
            for f in one.judgement.findings.kept
            if f.code in (codes.BOUNDARY_EXCEEDED, codes.BOUNDARY_GUARD_OFF)
        }
        for key, over in beyond.items():
            if over > NEAR:
                assert key in found, f"{key} by {over}\n{where}"
            if over < -SAMPLED:
                assert key not in found, f"{key} by {over}\n{where}"
        worst = max((over for (_, on), over in beyond.items() if on), default=-math.inf)
        if not -SAMPLED <= worst <= NEAR:
            assert one.answer("limits") is (Verdict.UNSAFE if worst > 0 else Verdict.SAFE), where
        seen.add(one.answer("limits"))
    assert seen == {Verdict.SAFE, Verdict.UNSAFE}


def job(text: str, **changes: object) -> Job:
    return replace(Job("G22\nG90\nG94\n" + text), **changes)  # type: ignore[arg-type]


def answer(folder: Path, made: Job) -> tuple[Verdict, list[tuple[str, int]], tuple[Condition, ...]]:
    one = run(folder, made)
    result = next(p for p in one.judgement.properties if p.name == "limits")
    findings = sorted((f.code.label, f.span.line) for f in one.judgement.findings.kept)
    return result.verdict, findings, result.conditions


@pytest.mark.parametrize(
    ("arc", "axis", "side", "reaches"),
    [
        # From X0 Y0 about (10, 0): the half turns reach Y 10 or -10, the quarter over the top no more than its end.
        ("G2 X20 I10 J0 F500", "y", 1, 10.0),
        ("G3 X20 I10 J0 F500", "y", 0, -10.0),
        ("G2 X10 Y10 I10 J0 F500", "y", 1, 10.0),
        ("G3 X10 Y10 I10 J0 F500", "x", 1, 20.0),
        ("G3 X10 Y10 I10 J0 F500", "y", 0, -10.0),
        ("G2 I10 J0 F500", "x", 1, 20.0),
        ("G2 I10 J0 F500", "y", 0, -10.0),
        ("G3 I10 J0 Z-5 F500", "y", 1, 10.0),
        ("G3 I10 J0 Z-5 F500", "z", 0, -5.0),
        # 3-4-5: centre (6, -8), the top lies at Y 2.
        ("G2 X12 R10 F500", "y", 1, 2.0),
        ("G3 X12 R10 F500", "y", 0, -2.0),
    ],
)
def test_an_arc_reaches_between_its_ends(arc: str, axis: str, side: int, reaches: float, tmp_path: Path) -> None:
    """What an arc reaches is exact: a boundary there is touched, one a thousandth nearer is passed."""
    outward = 1.0 if side else -1.0
    for room, wanted in ((0.0, Verdict.SAFE), (0.001, Verdict.SAFE), (-0.001, Verdict.UNSAFE)):
        end = reaches + outward * room
        made = job(arc + "\n", bounds={axis: (None, end) if side else (end, None)})
        verdict, findings, _ = answer(tmp_path, made)
        assert verdict is wanted, (end, findings)
        assert findings == ([] if wanted is Verdict.SAFE else [("GP330", 4)])


def test_a_place_on_a_boundary_is_inside(tmp_path: Path) -> None:
    made = job("G0 X25.4 Y-12.7\n", bounds={"x": (None, 25.4), "y": (-12.7, None)})
    assert answer(tmp_path, made)[:2] == (Verdict.SAFE, [])


def test_boundaries_that_change_on_the_way(tmp_path: Path) -> None:
    """L22, L23 hold from their line on; L22.1, L23.1 and those without words bring back those of the machine's file."""
    text = "G0 X40\nL23 X30\nG0 X20\nG0 X35\nL23.1 X\nG0 X35\nL23 X30\nL23\nG0 X45\nG0 X51\nL22 X52\nG0 X20\n"
    verdict, findings, _ = answer(tmp_path, job(text, bounds={"x": (-5.0, 50.0)}))
    assert verdict is Verdict.UNSAFE
    assert findings == [("GP330", 7), ("GP330", 13), ("GP330", 15)]


def test_a_guard_that_is_off(tmp_path: Path) -> None:
    """L21 and L20 X2: a warning, the stretch a note, and SAFE; L20 and L20 X1: past a boundary is UNSAFE again."""
    bounds = {"x": (0.0, 50.0)}
    for off in ("L21", "L20 X2"):
        made = job(f"{off}\nG0 X60\nG0 X10\n", bounds=bounds)
        verdict, findings, _ = answer(tmp_path, made)
        assert (verdict, findings) == (Verdict.SAFE, [("GP332", 5), ("GP338", 4)])
        for on in ("L20", "L20 X1"):
            made = job(f"{off}\nG0 X60\n{on}\nG0 X10\nG0 X60\n", bounds=bounds)
            verdict, findings, _ = answer(tmp_path, made)
            # L20 X1 leaves the soft limits off: another stretch.
            told = [("GP330", 8), ("GP332", 5), ("GP338", 4), *([("GP338", 6)] if on == "L20 X1" else [])]
            assert (verdict, findings) == (Verdict.UNSAFE, told)


UNMEASURED = {"z": None, "w": None}


@pytest.mark.parametrize("measure", [{"z": 0.0, "w": 0.0}, {"z": -133.35, "w": 20.0}, {"z": (-50.0, 4.0), "w": 0.0}])
def test_a_measure_that_nobody_knows_cancels(measure: dict[str, float | None], tmp_path: Path) -> None:
    """The tip stays above the boundary whatever the tool measures; a thousandth deeper it does not."""
    bounds = {"z": (-1.5, 60.0)}
    inside = job("G0 Z5\nG0 X10\nG1 Z-1.5 F500\nL91 G1 Z3\n", bounds=bounds, measures=measure)
    assert answer(tmp_path, inside)[0] is Verdict.SAFE
    deeper = job("G0 Z5\nG0 X10\nG1 Z-1.501 F500\n", bounds=bounds, measures=measure)
    verdict, findings, _ = answer(tmp_path, deeper)
    assert verdict is Verdict.UNSAFE
    assert ("GP330", 6) in findings
    # G92 where the tip stands: words count from there, boundaries do not.
    local = job("G0 Z5\nG92 Z0\nG1 Z-6.5 F500\n", bounds=bounds, measures=measure)
    assert answer(tmp_path, local)[0] is Verdict.SAFE
    assert answer(tmp_path, replace(local, program=local.program.replace("6.5", "6.51")))[0] is Verdict.UNSAFE


def test_a_measure_that_nobody_states_is_none(tmp_path: Path) -> None:
    """A low boundary of Z counts once M37 is used: a warning before, an error behind it."""
    bounds = {"z": (-1.5, 60.0)}
    inside = job("G0 Z5\nG0 X10\nG1 Z-1.5 F500\nL91 G1 Z3\n", bounds=bounds, measures=UNMEASURED)
    assert answer(tmp_path, inside)[0] is Verdict.SAFE
    deeper = job("G0 Z5\nG0 X10\nG1 Z-1.501 F500\n", bounds=bounds, measures=UNMEASURED)
    verdict, findings, _ = answer(tmp_path, deeper)
    assert verdict is not Verdict.UNSAFE
    assert ("GP332", 6) in findings and "GP330" not in dict(findings)
    measured = replace(deeper, program=deeper.program + "M37 Z0\nG1 Z-1.501\n")
    assert answer(tmp_path, measured)[0] is Verdict.UNSAFE


def test_a_measure_taken_on_the_way(tmp_path: Path) -> None:
    """M37 Z0 where nobody knows how high the tip is: from there on the boundary is as far below as its number says."""
    made = job("M37 Z0\nG0 Z5\nG1 Z-1.5 F500\n", bounds={"z": (-1.5, None)}, measures=UNMEASURED)
    made = replace(made, start={**made.start, "z": None})
    assert answer(tmp_path, made)[0] is Verdict.SAFE
    assert answer(tmp_path, replace(made, program=made.program.replace("Z-1.5", "Z-1.6")))[0] is Verdict.UNSAFE


def test_machine_places_do_not_cancel(tmp_path: Path) -> None:
    """G53 Z-10 above a boundary of -100 in the workspace: for measures of at most 90, which is printed and exact."""
    made = job("G53 Z-10\n", bounds={"z": (-100.0, None)}, measures=UNMEASURED)
    verdict, _, conditions = answer(tmp_path, made)
    assert verdict is Verdict.SAFE
    (condition,) = [c for c in conditions if any(symbol == "tool.0.z" for symbol, _ in c.terms)]
    ((_, factor),) = condition.terms
    ends = sorted((condition.low / factor, condition.high / factor))
    assert ends[1] == pytest.approx(90.0)
    for measure, wanted in ((89.999, Verdict.SAFE), (90.0, Verdict.SAFE), (90.001, Verdict.UNSAFE)):
        assert answer(tmp_path, replace(made, measures={"z": measure, "w": 0.0}))[0] is wanted
    ranges = ((10.0, 90.0), Verdict.SAFE), ((10.0, 91.0), Verdict.UNKNOWN), ((90.5, 91.0), Verdict.UNSAFE)
    for span, wanted in ranges:
        assert answer(tmp_path, replace(made, measures={"z": span, "w": 0.0}))[0] is wanted, span


def test_two_boundaries_that_no_measure_keeps(tmp_path: Path) -> None:
    """A machine place for measures up to 10, another for 20 and more: no measure suits both."""
    made = job("G53 Z-10\nG53 Z40\n", bounds={"z": (-20.0, 20.0)}, measures=UNMEASURED)
    assert answer(tmp_path, made)[0] is not Verdict.SAFE
    for measure in (-40.0, 0.0, 9.0, 15.0, 21.0, 60.0):
        assert answer(tmp_path, replace(made, measures={"z": measure, "w": 0.0}))[0] is Verdict.UNSAFE


def test_a_job_taller_than_its_boundaries_is_unsafe_whatever_the_measure(tmp_path: Path) -> None:
    """41 mm between two boundaries 40 mm apart: refuted, as with soft limits; 40 mm fit one measure."""
    verdict, findings, _ = answer(
        tmp_path, job("G53 Z-10\nG53 Z31\n", bounds={"z": (-20.0, 20.0)}, measures=UNMEASURED)
    )
    assert (verdict, "GP303" in [code for code, _ in findings]) == (Verdict.UNSAFE, True)
    verdict, _, conditions = answer(
        tmp_path, job("G53 Z-10\nG53 Z30\n", bounds={"z": (-20.0, 20.0)}, measures=UNMEASURED)
    )
    assert verdict is Verdict.SAFE
    assert [(round(c.low, 9), round(c.high, 9)) for c in conditions if "tool" in c.terms[0][0]] == [(10.0, 10.0)]


def test_boundaries_one_after_the_other_that_no_measure_keeps(tmp_path: Path) -> None:
    """Z-10 over a boundary of -20 is for measures up to 10, Z40 below one of 20 for 20 and more: refuted (GP303)."""
    text = "G53 Z-10\nL23 Z20\nG53 Z{}\n"
    made = job(text.format(40), bounds={"z": (-20.0, None)}, measures=UNMEASURED)
    verdict, findings, conditions = answer(tmp_path, made)
    assert (verdict, findings) == (Verdict.UNSAFE, [("GP303", 6)])
    assert not [c for c in conditions if "tool" in c.terms[0][0]]
    for measure in (-40.0, 0.0, 9.0, 15.0, 21.0, 60.0):
        assert answer(tmp_path, replace(made, measures={"z": measure, "w": 0.0}))[0] is Verdict.UNSAFE
    # Z30 below 20 asks for a measure of 10 or more: the one that both take.
    verdict, _, conditions = answer(tmp_path, replace(made, program=made.program.replace("Z40", "Z30")))
    assert verdict is Verdict.SAFE
    assert [(round(c.low, 9), round(c.high, 9)) for c in conditions if "tool" in c.terms[0][0]] == [(10.0, 10.0)]


def test_what_arises_on_the_way_may_save_a_job(tmp_path: Path) -> None:
    """Measures up to 14; behind a switch within 8 mm, 30 more below 20 need 10 to 18, 35 more at least 15."""
    text = "G53 Z0\nL91 G1 Z8 F100 M28\nL23 Z20\nL91 G1 Z{}\n"
    for high, wanted in ((30, Verdict.UNKNOWN), (35, Verdict.UNSAFE)):
        made = job(text.format(high), bounds={"z": (-14.0, None)}, measures=UNMEASURED)
        verdict, findings, _ = answer(tmp_path, made)
        assert verdict is wanted, findings


def test_a_shift_of_a_workspace_moves_the_boundary(tmp_path: Path) -> None:
    """G55 with a shift of 100: the boundary of 50 stands at machine 150, or at -50 where the shift is taken away."""
    for sign in (1, -1):
        made = job(f"G55\nG0 X50\nG53 X{number(sign * 100.0)}\n", shifts={55: (100.0, 0.0)}, sign=sign,
                   bounds={"x": (0.0, 50.0)})  # fmt: skip
        assert answer(tmp_path, made)[:2] == (Verdict.SAFE, [])
        past = replace(made, program=made.program.replace("G0 X50", "G0 X50.01"))
        assert answer(tmp_path, past)[:2] == (Verdict.UNSAFE, [("GP330", 5)])
        home = replace(made, program=made.program + "G53 X0\n")
        assert answer(tmp_path, home)[0] is Verdict.UNSAFE


@pytest.mark.parametrize("turned", [False, True], ids=["lower first", "upper first"])
@pytest.mark.parametrize(
    ("bounds", "measure", "code", "low"),
    [
        # Machine places Z-10 and Z40, the tip lower by the measure: the one passes -100, the other 100.
        ((-100.0, None), (10.0, 91.0), "GP304", True),
        ((-100.0, None), (90.5, 91.0), "GP330", True),
        ((None, 100.0), (-61.0, 0.0), "GP304", False),
        ((None, 100.0), (-80.0, -70.0), "GP330", False),
    ],
)
def test_a_finding_stands_at_the_move_that_passes_the_boundary(
    bounds: tuple[float | None, float | None], measure: tuple[float, float], code: str, low: bool, turned: bool,
    tmp_path: Path,
) -> None:  # fmt: skip
    """Of two moves the one that passes the side, not the one that goes highest."""
    moves = ["G53 Z-10", "G53 Z40"]
    text = "\n".join(reversed(moves) if turned else moves) + "\n"
    made = job(text, bounds={"z": bounds}, measures={"z": measure, "w": 0.0})
    _, findings, _ = answer(tmp_path, made)
    assert findings == [(code, 4 if low != turned else 5)], findings
