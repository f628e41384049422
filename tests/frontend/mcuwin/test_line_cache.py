"""Lines of McuWIN whose shape is known, and blocks that are made when they run, are what reading each line gives."""

from __future__ import annotations

import random
import re
from pathlib import Path
from typing import Any

import pytest
from frontend.mcuwin.mcuwin_programs import OLD, machine
from frontend.mcuwin.test_fuzz import LINES, PROGRAMS
from support.campaigns import seeds

from gproof.frontend.mcuwin import line_cache as shapes
from gproof.frontend.mcuwin import text
from gproof.frontend.mcuwin.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine
from gproof.ir.program import Block, DeferredBlock, Program
from gproof.ir.text import print_ir

NUMBERS = ["0", "1", "7", "42", "2147483648", "123456", "1.", ".5", "0.25", "3.75000", "00012.50", "1e5", "5.5.5", ""]
COMMENTS = ["", "a", " pass 2", "'", " it's", "//", "(", ")", "$", '"', "é", "{", "}", ";", "% 3", "\t "]
MACHINES = [
    machine(), machine(case_sensitive=True, line_numbers=True), machine(keeps_over_codes=True),
    machine(angle_unit="degrees"), OLD,
]  # fmt: skip


def outcome(path: Path, on: Machine, held: int | None) -> Any:
    """What loading gives: the program as text, with what blocks go on with; notes; findings."""
    findings = Findings(limit=100_000)
    program = load_program(path, findings, on, tables=False, held=held)
    said = [(finding.code.label, finding.span, finding.message) for finding in findings.kept]
    if program is None:
        return said, findings.counts
    blocks = [
        (node.continued, node.distances, node.comment, node.span)
        for body in (program.body, *(sub.body for sub in program.subprograms.values()))
        for node in body
        if isinstance(node, Block)
    ]
    noted = [list(notes(program, number)) for number in range(len(program.files))]
    return said, findings.counts, print_ir(program), blocks, noted


def notes(program: Program, number: int) -> Any:
    found, _, _ = program.load_notes(number, 0, 1, len(program.files[number].data) + 1)
    return found


def same(folder: Path, source: str, on: Machine) -> None:
    path = folder / "job.din"
    path.write_bytes(source.encode())
    expected = outcome(path, on, None)
    for held in (0, 20, 100_000):
        assert outcome(path, on, held) == expected, (held, source)


def varied(rng: random.Random, line: str) -> str:
    """The same line with other numbers, and perhaps another comment at its end."""
    parts = re.split(r"([0-9]+\.?[0-9]*|\.[0-9]+)", line)
    for k in range(1, len(parts), 2):
        draw = rng.random()
        if draw < 0.3:
            parts[k] = re.sub("[0-9]", lambda _: str(rng.randrange(10)), parts[k]) + rng.choice(["", "", "3"])
        elif draw < 0.34:
            parts[k] = rng.choice(NUMBERS)
    line = "".join(parts)
    draw = rng.random()
    if draw < 0.1:
        line += rng.choice(["'", "//", " '", " // ", "("]) + rng.choice(COMMENTS)
    elif draw < 0.3:
        line = re.sub(r"('|//).*", lambda found: found[1] + rng.choice(COMMENTS), line)
    return line


NAMES = ["CD601", "CI602", "CD650", "Depth", "count", "X.tp", "pi", "cd601", "DEPTH", "i", "CD5", "none", "X.digib.2"]


def value(rng: random.Random, depth: int) -> str:
    draw = rng.random()
    if depth == 0 or draw < 0.25:
        names = NAMES if rng.random() < 0.05 else NAMES[:3]
        return rng.choice([rng.choice(names), "12.5", "3", "0.25", "-7", "- 2", "1000"])
    inner = [value(rng, depth - 1) for _ in range(2)]
    blank = rng.choice(["", " ", "\t"])
    if draw < 0.6:
        return f"({inner[0]}{blank}{rng.choice(['+', '-', '*', '/', '+', '*', ' div ', '<'])}{blank}{inner[1]})"
    if draw < 0.8:
        return f"{rng.choice(['sin', 'abs', 'round', 'sqr'])}({inner[0]})"
    return f"{inner[0]}{blank}{rng.choice('+-*')}{blank}{inner[1]}"


def din_line(rng: random.Random) -> str:
    items = [rng.choice(["", "", "", "N10 ", "n5", "L5 ", "N7 L12 "])]
    for _ in range(rng.randint(1, 4)):
        draw = rng.random()
        if draw < 0.3:
            items.append(rng.choice(["G01", "G0 ", "g1", "G90", "G91", "G04 5", "G92", "M03", "G02", "M210 4 5"]))
        elif draw < 0.8:
            items.append(rng.choice("XYZFSTIJxyD") + rng.choice(["", " "]) + value(rng, rng.randint(0, 2)))
        elif draw < 0.9:
            items.append(f"{rng.choice(NAMES)} := {value(rng, 2)}")
        else:
            forms = ["(note 3)", "M17", "M30", "M96 L5", "M98 L12 O3", "M98L5", "M96 UP1", 'WRITE "a 5" CD601']
            items.append(rng.choice([*forms, "X.zerooffset := 5"]))
    items.append(rng.choice(["", "", "", " 'end 5", " // c", "(a)", "  "]))
    return rng.choice(["", " "]).join(items)


def dollar_line(rng: random.Random) -> str:
    form = rng.choice(
        [
            "${n} := {v};", "${n} := {v}; {n} := {v}", "$if ({v} < {v}) then begin", "$end", "$end else begin",
            "$wt({v});",
            "$while ({v} > 3.5) do begin", "$for CI601 := 1 to 5 do begin", "$drill({v});", "$repeat begin",
            "$end until ({v} = 2);", "N10 ${n} := {v}; // note 4", "$write('a 5', {v});", "$if {v} = 3 then {n} := 2;",
            "${n} := {v}; {{ b 3 }}", "$goto 5;", "$foo 5;", "$ 5: {n} := 3;",
        ]
    )  # fmt: skip
    return re.sub(r"\{[nv]\}", lambda f: rng.choice(NAMES) if f[0] == "{n}" else value(rng, 1), form).replace("{{", "{")


HEAD = (
    "var Depth : double; count, i : integer;\nconst half = 0.5;\nlabel 5;\n"
    "procedure drill(N : integer; g : double);\nbegin\nCD600 := g;\nend;\n%UP1\n"
)


@pytest.mark.parametrize("seed", seeds(4, 10))
def test_lines_of_one_shape(tmp_path: Path, seed: int) -> None:
    """Lines that come again and again with other numbers and comments, right and wrong ones."""
    rng = random.Random(seed)
    on = MACHINES[seed % len(MACHINES)]
    forms = [rng.choice([din_line, din_line, dollar_line])(rng) for _ in range(20)]
    lines = [varied(rng, line) for line in forms * 8]
    if seed % 3 == 2:
        lines.insert(70, "$DINEND\nvar late : double;\n{$DINSTART}")
    same(tmp_path, HEAD * (seed % 2) + "\n".join(lines) + "\nM30\n", on)


@pytest.mark.parametrize("seed", range(5))
def test_lines_of_real_programs(tmp_path: Path, seed: int) -> None:
    rng = random.Random(seed)
    lines = [line for line in rng.sample(LINES, 40) if not re.match(r"[ \t]*[{%]|\$(DIN|I )", line, re.IGNORECASE)]
    same(tmp_path, "\n".join(varied(rng, line) for line in lines * 4), MACHINES[seed])


@pytest.mark.parametrize("seed", range(3))
def test_whole_programs(tmp_path: Path, seed: int) -> None:
    """Each program twice over, as one text."""
    for number, path in enumerate(random.Random(seed).sample(PROGRAMS, 12)):
        data = path.read_bytes().decode("cp1252").removesuffix("\x1a")
        same(tmp_path, data + "\n" + data, MACHINES[number % 5])


SHAPED = [
    "G01 X(CD601*{}) Y(sin(CD602 + {}))", "N{} X CD601+{}", "$CD601 := CD601 + {}.5; // pass {}",
    "G04 {}", "L{} X(CD601-{}.25) F{}", "M96 L{}", "M98 L{} O{}", "X2*CD601 'step {}, {}",
    "$if (CI601 > {}) then begin",
    "CD601 := {} * CD602", "G1 X-{}.5 S(CD603)", "N{} $wt({});", "T{} M6", "X Y({})",
]  # fmt: skip


@pytest.mark.parametrize("form", SHAPED)
def test_a_known_shape_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, form: str) -> None:
    """The third line of a shape on is neither read when the file is, nor when its block runs."""
    lines = [form.format(*(str(k * 7 + n) for n in range(3))) for k in range(1, 30)]
    path = tmp_path / "job.din"
    path.write_text("\n".join(lines) + "\nM30\n")
    counted = []
    read = text.LineReader.read

    def counting(self: Any, *args: Any) -> Any:
        counted.append(args[0])
        return read(self, *args)

    monkeypatch.setattr(text.LineReader, "read", counting)
    program = load_program(path, Findings(), held=0)
    assert program is not None
    assert counted[2:] in (["M30"], []), counted
    for node in program.body:
        assert not isinstance(node, DeferredBlock) or node.words is not None
    assert {line for line in counted[2:] if line not in lines[:2]} <= {"M30"}


def test_patterns_and_shapes_are_few(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """When there are too many it starts again, with the same result."""
    monkeypatch.setattr(shapes, "KEPT_PATTERNS", 3)
    monkeypatch.setattr(shapes, "KEPT_SHAPES", 5)
    rng = random.Random(1)
    forms = [form.replace("{}", "5") for form in SHAPED if "begin" not in form]
    same(tmp_path, "\n".join(varied(rng, rng.choice(forms)) for _ in range(150)), machine())


def test_names_are_those_that_were_declared_before(tmp_path: Path) -> None:
    """A block is made with the names of its place, also when others follow, and a shape is forgotten with them."""
    lines = ["G1 X(sizes*2)"] * 3
    source = "\n".join(["%A", *lines, "$DINEND", "var sizes : double;", "{$DINSTART}", *lines, "M30"])
    same(tmp_path, source, machine())
    same(tmp_path, source.replace("sizes*2", "pi*2").replace("sizes", "more"), machine())
