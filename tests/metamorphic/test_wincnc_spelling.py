"""WinCNC: one job written in two ways that the manual says mean the same: the same moves, the same answer."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from metamorphic.jobs import Run, same_moves
from metamorphic.wincnc_jobs import Job, fitted, run, without_standing
from metamorphic.wincnc_programs import (
    AXES,
    Can,
    Line,
    Maker,
    Program,
    Word,
    code,
    flat,
    mapped,
    number,
    plain_spell,
    relative,
    show,
    text_of,
    written_out,
)

FAST = 4
SEEDS = [pytest.param(0, FAST, id="0")]
MORE = [pytest.param(10_000 + n * 40, 40, id=f"soak-{n}", marks=pytest.mark.soak) for n in range(10)]
seeds = pytest.mark.parametrize(("first", "count"), [*SEEDS, *MORE])
ROOMS = (0.01, 1.0, -0.01, -1.0)
NEAR = 1e-6


def compare(folder: Path, job: Job, other: Job, where: str, tolerance: float = 0.0) -> tuple[Run, Run]:
    """Both jobs make the same moves and get the same answer; moves that go nowhere do not count."""
    one = without_standing(run(folder, job))
    two = without_standing(run(folder, other))
    texts = f"{where}\n{job.told()}{one.told()}\n======\n{other.told()}{two.told()}"
    assert one.clean, texts
    assert one.verdict is two.verdict, f"{one.verdict} and {two.verdict}\n{texts}"
    if tolerance and one.feed.shape == two.feed.shape:
        # Whether two feeds are one hangs on their last bit, where the unit changes on the way.
        doubtful = np.isnan(one.feed) | np.isnan(two.feed)
        one, two = (replace(it, feed=np.where(doubtful, np.nan, it.feed)) for it in (one, two))
    difference = same_moves(one, two, tolerance)
    assert not difference, f"{difference}\n{texts}"
    return one, two


def random_job(rng: random.Random, can: Can) -> tuple[Program, Maker]:
    maker = Maker(rng, can)
    return maker.program(rng.randrange(3, 10)), maker


def job_of(program: Program, **changes: object) -> Job:
    files: dict[str, str] = {}
    text = text_of(["G22", *flat(program, files)])
    return replace(Job(text, files=files), **changes)  # type: ignore[arg-type]


def judged_near(folder: Path, rng: random.Random, job: Job) -> Job:
    """The job with limits near what it reaches."""
    return fitted(job, run(folder, job), rng.choice(ROOMS))


# ---- units


def in_unit(words: tuple[Word, ...], size: float) -> tuple[Word, ...]:
    """size: mm."""
    return tuple(w if w.plain else replace(w, text=f"{w.value / size:.13f}") for w in words)


UNITS = {"G20": 25.4, "G21": 10.0, "G22": 1.0}


@seeds
def test_units(first: int, count: int, tmp_path: Path) -> None:
    """G20, G21, G22: every length, and every feed of one, in inches, centimetres, millimetres."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        program, _ = random_job(rng, Can())
        job = judged_near(tmp_path, rng, job_of(program))
        for unit in ("G20", "G21"):
            made = mapped(program, lambda line, size=UNITS[unit]: (replace(line, words=in_unit(line.words, size)),))
            files: dict[str, str] = {}
            other = replace(job, program=text_of([unit, *flat(made, files)]), files=files)
            compare(tmp_path, job, other, f"seed {seed}", NEAR)


@seeds
def test_units_that_change(first: int, count: int, tmp_path: Path) -> None:
    """G20 to G23 before any line: what is set keeps its length; G23 goes back to the unit before."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        program, _ = random_job(rng, Can(calls=False))
        now, last, is_back = "G22", "", False
        centre: tuple[Word, ...] = ()
        is_old = False

        def whole(line: Line) -> Line:
            """The line with its I and J, where those that are kept are of another unit: they are left open."""
            nonlocal centre, is_old
            own = tuple(word for word in line.words if word.letter in "IJR")
            if line.kind != "arc" or (not own and not is_old):
                return line
            if own:
                centre, is_old = own, False
                return line
            is_old = False
            return replace(line, words=(*line.words, *centre))

        def change(line: Line, rng: random.Random = rng) -> tuple[Line, ...]:
            nonlocal now, last, is_back, is_old
            if rng.random() < 0.6 or line.kind == "hole":
                return (replace(line, words=in_unit(whole(line).words, UNITS[now])),)
            new = rng.choice([unit for unit in UNITS if unit != now])
            # Twice back: to which of the two is left open.
            is_back = new == last and not is_back
            switch = Line(text="G23" if is_back else new)
            now, last = new, now
            is_old = True
            return switch, replace(line, words=in_unit(whole(line).words, UNITS[now]))

        job = judged_near(tmp_path, rng, job_of(program))
        other = replace(job, program=text_of(["G22", *flat(mapped(program, change))]))
        compare(tmp_path, job, other, f"seed {seed}", NEAR)


# ---- distances


@seeds
def test_distances(first: int, count: int, tmp_path: Path) -> None:
    """G91, or L91 on a line: the distance to a place; L90 on a line: the place. I and J are distances always."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        program, _ = random_job(rng, Can())
        job = judged_near(tmp_path, rng, job_of(program))

        def once(line: Line, rng: random.Random = rng) -> tuple[Line, ...]:
            if line.kind not in ("go", "arc") or rng.random() < 0.3:
                return (line,)
            return (replace(relative(line), words=(*code("L91"), *relative(line).words)),)

        def always(line: Line, rng: random.Random = rng) -> tuple[Line, ...]:
            if line.kind in ("cycle", "hole", "machine") and any(w.letter in AXES for w in line.words):
                return (replace(line, words=(*line.words, *code("L90"))),)
            if line.kind in ("go", "arc") and rng.random() < 0.3:
                return (replace(line, words=(*code("L90"), *line.words)),)
            if line.words[:1] == code("G90"):
                return (Line(code("G91")),)
            return (relative(line),)

        def modes(line: Line, rng: random.Random = rng) -> tuple[Line, ...]:
            if line.kind not in ("go", "arc") or rng.random() < 0.5:
                return (line,)
            distance = relative(line)
            if rng.random() < 0.5:
                return (replace(distance, words=(*code("G91"), *distance.words)), Line(code("G90")))
            return (Line(code("G91")), distance, Line(code("G90")))

        for change in (once, always, modes):
            files: dict[str, str] = {}
            other = replace(job, program=text_of(["G22", *flat(mapped(program, change), files)]), files=files)
            compare(tmp_path, job, other, f"seed {seed}")


# ---- files and macros


@seeds
def test_files_written_out(first: int, count: int, tmp_path: Path) -> None:
    """M98: the lines of the file; its G92 ends with it, unless L92 stands in it. A macro is its one command."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        maker = Maker(rng, Can())
        program = [*maker.program(rng.randrange(2, 5)), maker.call(), *maker.groups(2), maker.call(), maker.group()]
        job = job_of(program)
        job = judged_near(tmp_path, rng, replace(job, files=dict(job.files)))
        compare(tmp_path, job, replace(job, program=text_of(["G22", *flat(program)]), files={}), f"seed {seed}")
        # Calls and lines behind commands of one's own, of which some replace commands of the controller.
        macros, lines = ["[of this shop]"], []
        names = iter(("M50", "SWEEP", "L31", "M3", "M6", "PART_A", "M90.1", "G28", "M2", "CUT7"))
        for line in job.program.splitlines():
            name = next(names, "") if rng.random() < 0.5 and not line.startswith("G22") else ""
            if name:
                macros.append(f"{name}={line} [{len(macros)}]")
            lines.append(name or line)
        compare(tmp_path, job, replace(job, program=text_of(lines), macros=text_of(macros)), f"seed {seed}, macros")


@seeds
def test_words_for_files(first: int, count: int, tmp_path: Path) -> None:
    """Words behind the name of a file: what {X} is in it; braces take one operator and a number."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        maker = Maker(rng, Can(calls=False, turns=False, local=False))
        before = maker.program(2)
        body = maker.groups(rng.randrange(1, 6), 0)
        behind = maker.groups(2, 0)
        given = {letter: rng.randrange(-480, 480) / 16 for letter in rng.sample("XYZIJRQ", 3)}

        def braces(line: Line, rng: random.Random = rng, given: dict[str, float] = given) -> tuple[Line, ...]:
            def put(word: Word) -> Word:
                letter, value = rng.choice(list(given.items()))
                rest = word.value - value
                if word.plain or line.kind not in ("go", "arc", "cycle", "hole") or rng.random() < 0.4:
                    return word
                options = [f"{{{letter}+{number(rest)}}}", f"{{{letter} + {number(rest)}}}"] if rest >= 0 else []
                options += [f"{{{letter}-{number(-rest)}}}"] if rest < 0 else []
                options += [f"{{{letter.lower()}}}"] * 3 if rest == 0 else []
                return replace(word, text=rng.choice(options))

            return (replace(line, words=tuple(put(w) for w in line.words)),)

        job = judged_near(tmp_path, rng, job_of([*before, *body, *behind]))
        call = " ".join(f"{letter}{number(value)}" for letter, value in given.items())
        lines = ["G22", *flat(before), f"M98 part.tap {call}", *flat(behind)]
        other = replace(job, program=text_of(lines), files={"PART.TAP": text_of(flat(mapped(body, braces)))})
        compare(tmp_path, job, other, f"seed {seed}")
        by_macro = replace(other, program=text_of(["G22", *flat(before), f"M77 {call}", *flat(behind)]))
        compare(tmp_path, job, replace(by_macro, macros="M77=M98 PART.TAP [a part]\n"), f"seed {seed}, a macro")


# ---- characters


def respelled(rng: random.Random) -> Callable[[Word], str]:
    """Zeros in front and behind, a plus, either case, blanks, a zero left out."""

    def spell(word: Word) -> str:
        letter = rng.choice((word.letter, word.letter.lower()))
        text = number(word.value) if word.text is None else word.text
        is_code = word.plain and word.letter in "GLM"
        if not is_code and word.value == 0 and rng.random() < 0.6:
            return letter
        sign = "-" if text.startswith("-") else ""
        text = text.removeprefix("-")
        kind = rng.randrange(6)
        if kind == 0:
            text = rng.choice("0 00 000".split()) + text
        if kind == 1 and not is_code:
            text = text + ("0" if "." in text else rng.choice((".", ".0", ".000")))
        if kind == 2 and text.startswith("0."):
            text = text.removeprefix("0")
        if kind == 3 and not sign and not is_code:
            sign = "+"
        return letter + rng.choice(("", "", " ", "  ")) + sign + text

    return spell


@seeds
def test_other_spellings(first: int, count: int, tmp_path: Path) -> None:
    """Axis Specification, Comments: blanks, case, zeros, signs, comments mean nothing; a letter alone has 0."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        can = Can()
        maker = Maker(rng, can, size=rng.choice((2, 480)))
        program = maker.program(rng.randrange(3, 10))
        job = judged_near(tmp_path, rng, job_of(program))
        spell = respelled(rng)
        files: dict[str, str] = {}
        lines = flat(program, files, spell)
        out = ["G22"]
        for line in lines:
            if rng.random() < 0.2:
                out.append(rng.choice(("", "[note]", "(G0 X500", "% G91", "   ", "\t")))
            named = '"' in line or line.startswith("M98")
            text = rng.choice(("", " ", "\t")) + (line if named or rng.random() < 0.5 else line.replace(" ", ""))
            out.append(text + rng.choice(("", "", " ", " [done]", "(X5", " % Z-500", "[")))
        compare(tmp_path, job, replace(job, program=text_of(out), files=files), f"seed {seed}")
        ends = "\r\n".join(out) + rng.choice(("", "\r\n"))
        compare(tmp_path, job, replace(job, program=ends, files=files), f"seed {seed}, other line ends")


@seeds
def test_tables_against_single_lines(first: int, count: int, tmp_path: Path) -> None:
    """Braces around a number are the number: lines that go through tables mean what they mean one by one."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        program, _ = random_job(rng, Can())
        job = judged_near(tmp_path, rng, job_of(program))
        often = rng.choice((0.1, 1.0))

        def braced(line: Line, rng: random.Random = rng, often: float = often) -> tuple[Line, ...]:
            if rng.random() > often:
                return (line,)

            def put(w: Word) -> Word:
                if w.letter in "GLM" and w.plain:
                    return w
                text = f"{{{number(w.value)}}}" if w.value >= 0 else f"{{0-{number(-w.value)}}}"
                return replace(w, text=text)

            return (replace(line, words=tuple(put(w) for w in line.words)),)

        files: dict[str, str] = {}
        lines = ["G22", *flat(mapped(program, braced), files)]
        compare(tmp_path, job, replace(job, program=text_of(lines), files=files), f"seed {seed}")


@seeds
def test_every_line_with_its_code(first: int, count: int, tmp_path: Path) -> None:
    """G0, G1: a line without a command is executed as the last of both; arcs leave them alone."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        program, _ = random_job(rng, Can())
        job = judged_near(tmp_path, rng, job_of(program))
        motion = ""

        def explicit(line: Line) -> tuple[Line, ...]:
            nonlocal motion
            if line.kind != "go":
                return (line,)
            first = line.words[0]
            if first.letter == "G":
                motion = plain_spell(first)
                return (line,)
            return (replace(line, words=(*code(motion), *line.words)),)

        files: dict[str, str] = {}
        lines = ["G22", *flat(mapped(program, explicit), files)]
        compare(tmp_path, job, replace(job, program=text_of(lines), files=files), f"seed {seed}")


# ---- arcs


@seeds
def test_arcs_by_radius(first: int, count: int, tmp_path: Path) -> None:
    """G2, G3: R names the shorter arc with this radius; I and J name its centre; I and J that are kept."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        program, _ = random_job(rng, Can())

        def centred(line: Line) -> tuple[Line, ...]:
            values = {w.letter: w.value for w in line.words}
            if line.kind != "arc" or "R" not in values:
                return (line,)
            before = dict(line.before)
            dx, dy = values["X"] - before["X"], values["Y"] - before["Y"]
            # The centre lies beside the middle of the chord, 0.8 of the radius away, left of a short G3.
            side = (1.0 if values["G"] == 3.0 else -1.0) * 4.0 / 6.0
            centre = Word("I", dx / 2 - side * dy), Word("J", dy / 2 + side * dx)
            return (replace(line, words=(*(w for w in line.words if w.letter != "R"), *centre)),)

        job = judged_near(tmp_path, rng, job_of(program))
        files: dict[str, str] = {}
        # An arc by R forgets the centre of the one before, so nothing behind it keeps one.
        lines = ["G22", *flat(mapped(program, centred), files)]
        compare(tmp_path, job, replace(job, program=text_of(lines), files=files), f"seed {seed}", NEAR)


@seeds
def test_kept_centres(first: int, count: int, tmp_path: Path) -> None:
    """G2, G3: without I and J those of the arc before are kept."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        program, _ = random_job(rng, Can(turns=False, radius=False))
        kept: tuple[Word, ...] = ()

        def explicit(line: Line) -> tuple[Line, ...]:
            nonlocal kept
            if line.kind != "arc":
                return (line,)
            own = tuple(w for w in line.words if w.letter in "IJ")
            kept = own or kept
            return (line if own else replace(line, words=(*line.words, *kept)),)

        job = judged_near(tmp_path, rng, job_of(program))
        files: dict[str, str] = {}
        lines = ["G22", *flat(mapped(program, explicit), files)]
        compare(tmp_path, job, replace(job, program=text_of(lines), files=files), f"seed {seed}")


@seeds
def test_arcs_in_halves(first: int, count: int, tmp_path: Path) -> None:
    """A full circle without X and Y is two halves: the same extent, the same answer."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        program, _ = random_job(rng, Can(turns=False, radius=False))
        kept = 0.0, 0.0

        def halves(line: Line) -> tuple[Line, ...]:
            nonlocal kept
            values = {w.letter: w.value for w in line.words}
            if line.kind != "arc":
                return (line,)
            if "I" in values:
                kept = values["I"], values["J"]
            if "X" in values or "Y" in values:
                return (line,)
            (i, j), before = kept, dict(line.before)
            turn, feed = line.words[0], Word("F", values["F"])
            z = before["Z"], values.get("Z", before["Z"])
            there = Word("X", before["X"] + 2 * i), Word("Y", before["Y"] + 2 * j), Word("Z", (z[0] + z[1]) / 2)
            back = Word("X", before["X"]), Word("Y", before["Y"]), Word("Z", z[1])
            one = replace(line, words=(turn, *there, Word("I", i), Word("J", j), feed))
            # Kept by what follows are the I and J of the program, so those of the second half are put back.
            two = replace(line, words=(turn, *back, Word("I", -i), Word("J", -j), feed))
            return (one, two)

        job = judged_near(tmp_path, rng, job_of(mapped(program, _with_centres())))
        other_program = mapped(mapped(program, _with_centres()), halves)
        files: dict[str, str] = {}
        other = replace(job, program=text_of(["G22", *flat(other_program, files)]), files=files)
        one, two = run(tmp_path, job), run(tmp_path, other)
        where = f"seed {seed}\n{job.told()}{one.told()}\n======\n{other.told()}{two.told()}"
        assert one.clean, where
        assert one.verdict is two.verdict, where
        for name, span in one.box.items():
            assert two.box[name] == pytest.approx(span, abs=NEAR), where


def _with_centres() -> Callable[[Line], tuple[Line, ...]]:
    kept: tuple[Word, ...] = ()

    def explicit(line: Line) -> tuple[Line, ...]:
        nonlocal kept
        if line.kind != "arc":
            return (line,)
        own = tuple(w for w in line.words if w.letter in "IJ")
        kept = own or kept
        return (line if own else replace(line, words=(*line.words, *kept)),)

    return explicit


# ---- rotation


@seeds
def test_turned_by_hand(first: int, count: int, tmp_path: Path) -> None:
    """G52: every place and every centre turned about I and J, which count as the program's places do."""
    for seed in range(first, first + count):
        rng = random.Random(seed)
        maker = Maker(rng, Can(bare=False))
        program = [*maker.program(rng.randrange(2, 6)), maker.turn(), maker.group(), maker.turn(), *maker.groups(2)]
        job = judged_near(tmp_path, rng, job_of(program))
        files: dict[str, str] = {}
        lines = ["G22", *flat(mapped(program, lambda line: (written_out(line),)), files)]
        compare(tmp_path, job, replace(job, program=text_of(lines), files=files), f"seed {seed}", NEAR)
        distances = mapped(program, lambda line: (replace(relative(line), words=_once(relative(line))),))
        other = text_of(["G22", *flat(distances, files)])
        compare(tmp_path, job, replace(job, program=other, files=files), f"seed {seed}, distances", NEAR)


def _once(line: Line) -> tuple[Word, ...]:
    return (*line.words, *code("L91")) if line.kind in ("go", "arc") else line.words


def test_a_program_can_be_shown() -> None:
    """What the generator prints is what a person would write."""
    line = Line((*code("G1"), Word("X", 2.5), Word("Y", -0.0625)))
    assert show(line) == "G1 X2.5 Y-0.0625"
    assert show(relative(replace(line, kind="go", before=(("X", 2.0), ("Y", 1.0))))) == "G1 X0.5 Y-1.0625"
