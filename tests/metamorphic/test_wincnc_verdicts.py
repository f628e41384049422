"""WinCNC: conditions, limits, boundaries, and what happens to answers when less is known."""

from __future__ import annotations

import itertools
import random
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest
from metamorphic.jobs import WORSE, Known, Run, same_moves
from metamorphic.test_wincnc_spelling import compare, job_of, judged_near
from metamorphic.wincnc_jobs import AXES, Job, fitted, paths, run, without_standing
from metamorphic.wincnc_programs import Can, Choice, Group, Item, Line, Maker, Program, flat, number, text_of

from gproof.ir.verdict import Verdict, worst

FAST = 8
SEEDS = [pytest.param(0, FAST, id="0")]
MORE = [pytest.param(30_000 + n * 40, 40, id=f"soak-{n}", marks=pytest.mark.soak) for n in range(10)]
seeds = pytest.mark.parametrize(("first", "count"), [*SEEDS, *MORE])


# ---- conditions


@dataclass
class Asking(Maker):
    """A maker of lines that decide about the next one. facts: what the setup may state, by kind and number."""

    facts: dict[tuple[str, int], int] = field(default_factory=dict)
    asked: int = 0

    def choice(self, *, known: bool) -> Group:
        rng = self.rng
        on = rng.random() < 0.5
        kind = rng.choice(("input", "output", "virtual", "answer", "number", "speed", "tool"))
        if not known and kind in ("number", "speed", "tool"):
            kind = "answer"
        runs_when = rng.random() < 0.5
        channel = sum(name == kind for name, _ in self.facts) + 1
        if kind in ("input", "output") and channel > 2:
            kind = "answer"
            channel = sum(name == kind for name, _ in self.facts) + 1
        if kind in ("input", "output", "virtual"):
            point = {"input": 1, "output": 2, "virtual": 3}[kind]
            simulated = rng.choice(("", " D0", " D1")) if kind == "input" else ""
            head = f"M{17 if runs_when else 18}.{point} C{channel}{simulated}"
        elif kind == "answer":
            head = f'G5 T{3 if runs_when else 4} M"{"run" if runs_when else "leave out"} the next line?"'
        elif kind == "number":
            head = f"M{17 if runs_when else 18}.4 C{int(on)}"
        elif kind == "speed":
            runs_when = True
            head = f"L113 L500 H{900 if on else 400} V{rng.choice((600, 700)) if on else 600}"
        else:
            runs_when = rng.random() < 0.5
            head = f"{'L111' if runs_when else 'L112'} T{1 if on else 2}"
        if kind not in ("number", "speed", "tool"):
            self.facts[kind, channel] = int(on)
        runs = on if runs_when else not on
        saved = dict(self.at)
        line = self.go(rng.choice(("G0", "G1")), feed=True)
        if not runs:
            self.at = saved
        # The motion in force depends on which way was taken.
        self.motion = ""
        items: tuple[Item, ...] = (Choice(head, line, runs if known else None),)
        return items if known and self.rng.random() < 0.5 else (*items, self.everywhere())

    def stated(self, job: Job, facts: dict[tuple[str, int], int]) -> Job:
        def of(kind: str) -> dict[int, int]:
            return {n: on for (name, n), on in facts.items() if name == kind}

        answers = tuple("yes" if on else "no" for _, on in sorted(of("answer").items()))
        return replace(job, inputs=of("input"), outputs=of("output"), virtual=of("virtual"), answers=answers)


CALM = Can(calls=False, turns=False, events=False, bare=False, measures=False)


@seeds
def test_conditions_that_are_decided(first: int, count: int, tmp_path: Path) -> None:
    """M17.1 to M18.4, L111 to L113, G5: the next line runs, or it is as if it were not there."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        maker = Asking(rng, CALM)
        program = maker.program(1)
        for _ in range(rng.randrange(1, 7)):
            program.append(maker.choice(known=True))
            program += maker.groups(rng.randrange(3))
        job = maker.stated(job_of(program), maker.facts)

        def taken(group: Group) -> Group:
            out: list[Item] = []
            for item in group:
                if not isinstance(item, Choice):
                    out.append(item)
                elif item.runs:
                    out.append(item.line)
            return tuple(out)

        job = judged_near(tmp_path, rng, job)
        compare(tmp_path, job, replace(job, program=text_of(["G22", *flat(map(taken, program))])), f"seed {seed}")


@seeds
def test_conditions_nobody_knows(first: int, count: int, tmp_path: Path) -> None:
    """What is not stated may be either: the paths are those of all cases, the answer is the worst of theirs."""
    seen = set()
    for seed in range(first, first + count):
        rng = random.Random(seed)
        maker = Asking(rng, replace(CALM, local=False, homes=False, cycles=False))
        program = maker.program(1)
        for _ in range(rng.randrange(1, 4)):
            program.append(maker.choice(known=False))
            program += maker.groups(rng.randrange(2))
        job = job_of(program)
        job = fitted(job, run(tmp_path, job), rng.choice((1.0, 1.0, -1.0)))
        either = run(tmp_path, job)
        cases = []
        for values in itertools.product((0, 1), repeat=len(maker.facts)):
            cases.append(run(tmp_path, maker.stated(job, dict(zip(maker.facts, values, strict=True)))))
        where = f"seed {seed}\n{job.told()}{either.told()}\n" + "".join(f"---\n{case.told()}\n" for case in cases)
        assert all(case.clean for case in cases), where
        assert either.verdict is worst(case.verdict for case in cases), where
        assert paths(either) == {path for case in cases for path in paths(case)}, where
        seen.add(either.verdict)
    assert seen == {Verdict.SAFE, Verdict.UNSAFE}


# ---- less is known


def blurred(rng: random.Random, values: Known) -> Known:
    out: Known = {}
    for name, value in values.items():
        assert isinstance(value, float)
        kind = rng.random()
        out[name] = value
        if kind < 0.3:
            out[name] = None
        elif kind < 0.5:
            out[name] = (value - rng.choice((0.0, 0.5, 30.0)), value + rng.choice((0.0, 0.5, 30.0)))
    return out


def truth(job: Job, symbol: str) -> float:
    """What an unknown really is."""
    kind, *rest = symbol.split(".")
    name = {"a": "w"}.get(rest[-1], rest[-1])
    values = {"start": job.start, "g92": job.local, "tool": job.measures}[kind]
    value = values.get(name, 0.0)
    assert isinstance(value, float), symbol
    return value


@seeds
def test_less_known(first: int, count: int, tmp_path: Path) -> None:
    """What holds for less holds for what is true, where that meets the conditions that are printed."""
    seen = set()
    for seed in range(first, first + count):
        rng = random.Random(seed)
        maker = Asking(rng, replace(CALM, measures=True, turns=rng.random() < 0.3, boundaries=rng.random() < 0.3))
        for n in "XYZW":
            maker.at[n], maker.local[n] = maker.number(), maker.number(160)
        maker.tool |= {n: maker.number(320) for n in "ZW"}
        maker.stored |= maker.tool
        given = {
            "start": {n.lower(): v for n, v in maker.at.items()},
            "local": {n.lower(): v for n, v in maker.local.items()},
            "measures": {n.lower(): maker.tool[n] for n in "ZW"},
        }
        maker.can = replace(maker.can, arcs=rng.random() < 0.5)
        program = maker.program(rng.randrange(2, 8))
        if rng.random() < 0.5:
            program += [maker.choice(known=True), *maker.groups(2)]
        job = replace(maker.stated(job_of(program), maker.facts), **given)  # type: ignore[arg-type]
        job = judged_near(tmp_path, rng, job)
        known = run(tmp_path, job)
        assert known.clean, f"seed {seed}\n{job.told()}{known.told()}"
        for _ in range(3):
            which = rng.randrange(1, 16)
            less = replace(
                job,
                start=blurred(rng, job.start) if which & 1 else job.start,
                local=blurred(rng, job.local) if which & 2 else job.local,
                measures=blurred(rng, job.measures) if which & 4 else job.measures,
            )
            if which & 8:
                less = replace(less, inputs={}, outputs={}, virtual={}, answers=())
            unknown = run(tmp_path, less)
            where = f"seed {seed}\n{job.told()}{known.told()}\n======\n{less.setup_text()}{unknown.told()}"
            conditions = [c for p in unknown.judgement.properties for c in p.conditions]
            sums = [(sum(k * truth(job, s) for s, k in c.terms), c) for c in conditions]
            meets = all(c.low - 1e-9 <= value <= c.high + 1e-9 for value, c in sums)
            if unknown.verdict is Verdict.SAFE and meets:
                assert known.verdict is Verdict.SAFE, where
            if unknown.verdict is Verdict.UNSAFE and not which & 8:
                assert known.verdict is Verdict.UNSAFE, where
            seen.add((known.verdict, unknown.verdict))
    assert (Verdict.SAFE, Verdict.SAFE) in seen
    assert (Verdict.UNSAFE, Verdict.UNSAFE) in seen or count == FAST


@seeds
def test_wider_limits(first: int, count: int, tmp_path: Path) -> None:
    """Limits and boundaries that lie further away never make an answer worse."""
    changed = 0
    for seed in range(first, first + count):
        rng = random.Random(seed)
        job = job_of(Maker(rng, Can()).program(rng.randrange(3, 9)))
        job = judged_near(tmp_path, rng, job)
        job = replace(job, bounds={n: (rng.choice((a, None)), b) for n, (a, b) in job.limits.items()})
        if rng.random() < 0.5:
            job = replace(job, start=blurred(rng, job.start), measures=blurred(rng, job.measures))
        least = rng.choice((0.0, 3.0))
        limits = {
            n: (a - max(least, rng.choice((0.0, 3.0, 40.0))), b + max(least, rng.choice((0.0, 3.0))))
            for n, (a, b) in job.limits.items()
        }
        bounds = {
            n: (None if a is None else a - rng.choice((0.0, 3.0)), None if b is None else b + rng.choice((0.0, 40.0)))
            for n, (a, b) in job.bounds.items()
        }
        runs = [
            run(tmp_path, made)
            for made in (job, replace(job, limits=limits), replace(job, bounds=bounds),
                         replace(job, limits=limits, bounds=bounds), replace(job, limits=limits, bounds={}))
        ]  # fmt: skip
        order = [WORSE[one.verdict] for one in runs]
        where = f"seed {seed}\n{job.told()}{limits}{bounds}\n{order}\n" + "---\n".join(one.told() for one in runs)
        for better, than in ((1, 0), (2, 0), (3, 1), (3, 2), (4, 3)):
            assert order[better] <= order[than], f"{better} {than} {where}"
        changed += len(set(order)) > 1
    assert changed


# ---- what nobody understands

NOT_UNDERSTOOD = (
    "L82 Z0", "L82.1", "L82.2", "L83 X5 Y5", "L401", "L602", "L213", "L802", "L810", "M37 O2", "G41 O1", "G42 O.5",
    "M37.3 S1 T0", "P7", "G0 P12", "G53 H3", "L252", "L820 X1", "L10 R2 C2 X5 Y5", "M999", "G0 Q5", "M98 NOWHERE.TAP",
    "G1 X5 X6", "G17", "T5", "N10", "N10 G0 X1", "G0 X5 G1", "{X}", "G0 X{FOO}", "G0 X{1+2+3}", "G0 X5 [a] Y7", "X5=3",
    "#1=5", "M2", "G12", "G59 X5", "L12 XY", "L13 Z", "G92.4 A1 B2 C3 D4", "G2 X0 Y0 R-5", "G3 I5 J5 R2", "M17.1 C9",
    "M18.2 C77", "M17.3 C65", "M18.4 C2", "L11 YZXW",
    "M11 C77", "L60 C99", "G5 T7", "L1.2", "M37", "G51 X0", "G81 X1 Z-5",
)  # fmt: skip


@seeds
def test_what_nobody_understands(first: int, count: int, tmp_path: Path) -> None:
    """A line that has a mistake, or no meaning that the manual gives, keeps the whole job from being SAFE."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        maker = Maker(rng, Can(bare=False))
        program = maker.program(rng.randrange(2, 5))
        job = job_of(program)
        before = run(tmp_path, job)
        assert before.verdict is Verdict.SAFE, f"seed {seed}\n{job.told()}{before.told()}"
        for text in rng.sample(NOT_UNDERSTOOD, 6):
            files = dict(job.files)
            lines = job.program.splitlines()
            name = rng.choice(["", *files])
            inside = files[name].splitlines() if name else lines
            # Not into a hole's lines: there words alone are the next hole. Behind L10 nothing would be repeated.
            inside.insert(rng.randrange(4, len(inside) + 1) if not name else 0, text)
            macros = ""
            if name:
                files[name] = text_of(inside)
            elif rng.random() < 0.3:
                macros, inside[inside.index(text)] = f"M70={text}\n", "M70"
            made = replace(job, program=text_of(lines), files=files, macros=macros)
            one = run(tmp_path, made)
            assert one.verdict is not Verdict.SAFE, f"seed {seed}: {text}\n{made.told()}{one.told()}"


# ---- boundaries


def sides(job: Job, one: Run, rng: random.Random) -> dict[str, tuple[float, float]]:
    """Near what the job reaches, with the start inside; before it on one side now and then."""
    out = {}
    for name in AXES:
        low, high = one.box.get((name, ""), (0.0, 0.0))
        out[name] = min(low - rng.choice((0.01, 1.0)), -0.5), max(high + rng.choice((0.01, 1.0)), 0.5)
    if rng.random() < 0.5:
        name, over = rng.choice(AXES), rng.choice((0.02, 1.02))
        low, high = out[name]
        out[name] = (min(low + over, -0.5), high) if rng.random() < 0.5 else (low, max(high - over, 0.5))
    return out


@seeds
def test_boundaries_are_limits_where_nothing_is_shifted(first: int, count: int, tmp_path: Path) -> None:
    """lobound=, hibound= against lolim=, hilim=: G92 does not shift either, workspace and measures are 0."""
    seen = set()
    for seed in range(first, first + count):
        rng = random.Random(seed)
        job = job_of(Maker(rng, Can(measures=False)).program(rng.randrange(2, 9)))
        near = sides(job, run(tmp_path, job), rng)
        if rng.random() < 0.4:
            job = replace(job, local=blurred(rng, job.local))
        one, two = run(tmp_path, replace(job, limits=near)), run(tmp_path, replace(job, bounds=dict(near)))
        where = f"seed {seed}\n{job.told()}{near}\n{one.told()}\n======\n{two.told()}"
        answers = one.answer("limits"), two.answer("limits")
        # Where no value of a G92 that nobody knows suits the whole job, boundaries do not say that it is UNSAFE.
        is_known = all(isinstance(value, float) for value in job.local.values())
        assert answers[0] is answers[1] or (answers == (Verdict.UNSAFE, Verdict.UNKNOWN) and not is_known), where
        if answers[0] is Verdict.SAFE:
            rooms = [{c.terms: (c.low, c.high) for c in _limits(it).conditions} for it in (one, two)]
            for terms, room in rooms[0].items():
                low, high = rooms[1].get(terms, (-1e6, 1e6))
                assert (max(low, -1e6), min(high, 1e6)) == pytest.approx(
                    (max(room[0], -1e6), min(room[1], 1e6)), abs=70.0 if room[0] < -9e5 or room[1] > 9e5 else 1e-6
                ), where
        seen.add(one.answer("limits"))
    assert {Verdict.SAFE, Verdict.UNSAFE} <= seen


def _limits(one: Run) -> object:
    return next(p for p in one.judgement.properties if p.name == "limits")


@seeds
def test_boundaries_move_with_the_measure(first: int, count: int, tmp_path: Path) -> None:
    """M37: whatever the tools measure, the answer about boundaries of work that is set by words is the same."""
    seen = set()
    for seed in range(first, first + count):
        rng = random.Random(seed)
        can = Can(machine=False, measures=False, homes=False, calls=rng.random() < 0.5, boundaries=rng.random() < 0.5)
        maker = Maker(rng, can)
        head: Program = [(maker.go("G0", axes="XYZW"),)]
        program: Program = []
        for _ in range(rng.randrange(2, 7)):
            program.append(maker.group())
            if rng.random() < 0.2:
                axis = rng.choice("ZW")
                value = maker.number(80)
                maker.tool[axis] = maker.at[axis] - value
                program.append((Line(text=f"M37 {axis}{number(value)}"),))
        job = job_of([*head, *program])
        job = replace(job, bounds=dict(sides(job, run(tmp_path, job), rng)))
        one = run(tmp_path, job)
        some = {n: rng.randrange(-2000, 2000) / 16 for n in "zw"}
        others: tuple[Known, ...] = (some, {"z": None, "w": None}, {"z": (-50.0, 80.0), "w": None})
        for measures in others:
            other = replace(job, measures=measures)
            if rng.random() < 0.5:
                other = replace(other, start={**other.start, "z": None})
            two = run(tmp_path, other)
            where = f"seed {seed}\n{job.told()}{one.told()}\n======\n{other.setup_text()}{two.told()}"
            assert one.answer("limits") is two.answer("limits"), where
        seen.add(one.answer("limits"))
    assert seen == {Verdict.SAFE, Verdict.UNSAFE}


# ---- the command line


@seeds
def test_setup_zero(first: int, count: int, tmp_path: Path) -> None:
    """``--setup zero`` is a setup in which everything is stated to be 0."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        job = job_of(Maker(rng, Can()).program(rng.randrange(2, 8)))
        job = judged_near(tmp_path, rng, job)
        compare(tmp_path, job, replace(job, zero=True), f"seed {seed}")


@seeds
def test_one_file_alone(first: int, count: int, tmp_path: Path) -> None:
    """``--call``: a file of the job alone is a job of one M98."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        maker = Maker(rng, Can(bare=False))
        program = [*maker.program(1), maker.call()]
        job = job_of(program)
        # What the job has in force before the call is not in force for the file.
        alone = replace(job, program="M98 part1.tap\n")
        one = without_standing(run(tmp_path, alone))
        two = without_standing(run(tmp_path, job, call="part1.tap"))
        where = f"seed {seed}\n{alone.told()}{one.told()}\n======\n{two.told()}"
        assert one.verdict is two.verdict, where
        assert not same_moves(one, two), f"{same_moves(one, two)}\n{where}"


@pytest.mark.parametrize("words", ["P7", "H2", "T3", "X5 I3", "X5 J2", "X5 K1", "X5 H3", "X5 T1", "X5 W2"])
def test_words_behind_a_cycle(words: str, tmp_path: Path) -> None:
    """G80: lines without a command are holes until then; words that a hole does not have are no holes."""
    hole = Job(f"G22\nG90\nG94\nG1 X1 Y1 F500\nG81 X5 Z-5 R2 F300\n{words}\nX6\n")
    assert run(tmp_path, hole).verdict is not Verdict.SAFE
    assert run(tmp_path, replace(hole, program=hole.program.replace(words, "X5 Y2"))).verdict is Verdict.SAFE
