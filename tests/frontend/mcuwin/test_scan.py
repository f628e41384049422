"""Plain lines of McuWIN: the automaton and the scanner against the reader of single lines, tables against blocks."""

from __future__ import annotations

import random
import struct
from pathlib import Path

import numpy as np
import pytest
from frontend.mcuwin.mcuwin_programs import OLD, load, machine
from hypothesis import example, given
from hypothesis import strategies as st
from support.campaigns import examples, seeds

from gproof.frontend.common.source import decode
from gproof.frontend.mcuwin.expressions import Expressions
from gproof.frontend.mcuwin.language import Language
from gproof.frontend.mcuwin.lines import LineReader
from gproof.frontend.mcuwin.pascal import Symbols
from gproof.frontend.mcuwin.scan import Scanner
from gproof.ir.dialects import rules_named
from gproof.ir.dialects.mcuwin.persistence import Persistence
from gproof.ir.dialects.mcuwin.settings import NO_MCUWIN_SETTINGS, mcuwin_settings
from gproof.ir.finding import Findings, Refusal
from gproof.ir.machine import Machine
from gproof.ir.notes import NoteKind
from gproof.ir.program import FLAG_POINT, Block, BlockTable, For, If, Number, Program, Repeat, Statement, While

Word = tuple[str, bytes, bool, int]
"""Letter, value, decimal point, column from 0."""


def bits(value: float) -> bytes:
    return struct.pack("d", value)


def reader(small: bool) -> LineReader:
    din = NO_MCUWIN_SETTINGS if small else mcuwin_settings(machine(case_sensitive=True))
    assert din is not None
    expressions = Expressions(Symbols(Findings(), axes="XYZABC"))
    language = Language(rules=rules_named("mcuwin"), din=din, axes="XYZABC", expressions=expressions)
    return LineReader(language, Persistence(din))


READERS = {small: reader(small) for small in (False, True)}


def words_of(block: Block) -> list[Word]:
    found = []
    for word in block.words:
        assert isinstance(word.value, Number)
        found.append((word.letter, bits(word.value.value), word.value.point, word.span.column - 1))
    return found


def read(line: bytes, how: Scanner) -> list[Word] | None:
    """The words of a line by the reader of single lines; None: a mistake, or more than plain words."""
    text = decode(line.removesuffix(b"\n").removesuffix(b"\r"))
    if "\r" in text:
        return None
    try:
        found = READERS[how.small].read(text, "job.din", 1)
    except Refusal:
        return None
    nodes = found.statements
    if found.module is not None or found.pascal >= 0 or found.starts is not None:
        return None
    if not nodes:
        return []
    block = nodes[0]
    if len(nodes) > 1 or not isinstance(block, Block) or block.assigns:
        return None
    if how.numbered and not found.number:
        return None
    for word in block.words:
        plain_code = word.letter == "G" and isinstance(word.value, Number) and word.value.value <= 3
        if not (plain_code or word.letter in "XYZABCIJKF") or word.bare or not isinstance(word.value, Number):
            return None
    return words_of(block)


def scanned(line: bytes, how: Scanner) -> list[Word]:
    columns, after, _ = how.scan(line, 0, len(line), 1, 1000)
    assert after == len(line)
    text = decode(line)
    assert len(text) == len(line) or not line.isascii()
    return [
        (chr(letter), bits(value), bool(flags & FLAG_POINT), offset)
        for _, offset, letter, flags, value in columns.rows()
    ]


def is_plain(line: bytes, how: Scanner) -> bool:
    return how.index(line, 0).line.tolist() == []


PIECES = st.sampled_from(
    [
        "G0", "g01", "G002", "G3", "G 1", "G4 1", "G90", "X1", "x-.5", "Y+2.25", "Z 3", "A1.", "C123456789012345678",
        "I1", "J-0", "K.000000000000000000000001", "F100", "N10", "n 5", "N", " ", "\t", "(a)", "(a (b))", "(it's)",
        "(", "'", "' x (y", "%", "$x", "L5", "M3", "S1", "T1", "D1", "X", "X(1)", "XCD600", "+", "-", "*", "/", "1",
        ".", "e5", "div", "and 1", "xor 2", ";", "//", "{}", "\r", "ä", "\x1a", ",", "step", "X1.5.5", ":=",
    ]
)  # fmt: skip
HOWS = [Scanner(), Scanner(small=False), Scanner(numbered=True)]


@examples(375, 6000)
@given(st.lists(PIECES, max_size=7), st.sampled_from(HOWS), st.sampled_from(["\n", "\r\n", ""]))
@example(["N10", " ", "G01", "X1", "Y+2.25", "F100", "(a)", "(a)", "'"], HOWS[2], "\n")
@example(["X1", " ", "-", "1"], HOWS[0], "\n")
@example(["G0", "1"], HOWS[0], "\n")
def test_a_plain_line_is_what_the_reader_says(pieces: list[str], how: Scanner, end: str) -> None:
    line = ("".join(pieces) + end).encode()
    if not line:
        return
    if is_plain(line, how):
        assert read(line, how) == scanned(line, how)


COMMON = st.sampled_from(
    ["G0", "G01", "G3", "X1", "Y-2.5", "Z.5", "A+3", "I1", "F100", " ", "\t", "(note)", "N10 "]
)  # fmt: skip


@examples(125, 2000)
@given(st.lists(COMMON, max_size=7), st.sampled_from(HOWS))
def test_what_posts_write_is_plain(pieces: list[str], how: Scanner) -> None:
    """Whatever the reader gives plain words of is plain, but for comments that words follow."""
    line = ("".join(pieces) + "\n").encode()
    expected = read(line, how)
    if expected is not None and b"(note)" not in line.rstrip(b"(note) \t\n"):
        assert is_plain(line, how)


def expanded(program: Program, body: tuple[Statement, ...]) -> list[object]:
    """Statements with tables as the blocks that they stand for: (line, words, what the first goes on with)."""
    found: list[object] = []
    for node in body:
        if isinstance(node, BlockTable):
            found += table_blocks(program, node)
        elif isinstance(node, Block) and node.words and all(isinstance(w.value, Number) for w in node.words):
            found.append((node.span.line, words_of(node), node.continued, node.distances))
        elif isinstance(node, If):
            found.append(("if", expanded(program, node.then), expanded(program, node.otherwise)))
        elif isinstance(node, While | Repeat | For):
            found.append((type(node).__name__, expanded(program, node.body)))
        else:
            found.append(node)
    return found


def table_blocks(program: Program, table: BlockTable) -> list[object]:
    at, line, state = table.begin, table.first_line, table.continued
    data = program.files[table.file].data
    found: list[object] = []
    while at < table.end:
        columns, after, next_line = program.load(table, at, line, 100)
        base = at
        for number in dict.fromkeys(columns["line"].tolist()):
            rows = [row for row in columns.rows() if row[0] == number]
            start = data.rfind(b"\n", 0, base + rows[0][1]) + 1
            words = [(chr(r[2]), bits(r[4]), bool(r[3] & FLAG_POINT), base + r[1] - start) for r in rows]
            found.append((number, words, state, table.distances))
            codes = [int(row[4]) for row in rows if chr(row[2]) == "G"]
            state = f"G{codes[-1]}" if codes else state
        at, line = after, next_line
    return found


def random_text(random_: random.Random, lines: int) -> str:
    plain = ["X{:.3f}", "Y-{:.1f}", "Z{:.0f}", "I{:.2f}", "F{:.0f}", "G0 X{:.0f}", "G1 Y{:.2f}", "N7 X{:.0f}"]
    other = [
        "",
        "' note",
        "M8",
        "G90",
        "G91",
        "G4 1",
        "L{}",
        "CD600 := 1",
        "$CD601 := 2;",
        "X(1)",
        "(note) X1",
        "%",
        "N9",
        "X1X",
    ]
    out = []
    for number in range(lines):
        if random_.random() < 0.7:
            out.append(
                " ".join(random_.choice(plain).format(random_.uniform(0, 99)) for _ in range(random_.randint(1, 3)))
            )
        else:
            out.append(random_.choice(other).format(number))
    return "\n".join([*out, "M30", ""])


@pytest.mark.parametrize("seed", seeds(10, 25))
def test_tables_stand_for_the_same_blocks(tmp_path: Path, seed: int) -> None:
    text = random_text(random.Random(seed), 60)
    on = OLD if seed % 2 else machine()
    with_tables, first = load(tmp_path, text, on)
    without, second = load(tmp_path, text, on, tables=False)
    assert [str(f) for f in first.kept] == [str(f) for f in second.kept], text
    assert with_tables is not None and without is not None
    assert expanded(with_tables, with_tables.body) == expanded(without, without.body), text
    assert with_tables.subprograms.keys() == without.subprograms.keys()
    for name, sub in with_tables.subprograms.items():
        assert expanded(with_tables, sub.body) == expanded(without, without.subprograms[name].body), text
    for limit in (1, 40, 10**6):
        assert notes_of(with_tables, limit) == notes_of(without, 10**6), text


def notes_of(program: Program, limit: int) -> list[tuple[int, int, int, int, bytes]]:
    at, line, found = 0, 1, []
    while line <= program.files[0].line_count:
        notes, at, line = program.load_notes(0, at, line, limit)
        notes.verify()
        found += list(notes)
    return found


def test_notes(tmp_path: Path) -> None:
    text = (
        "' head\n%MAIN (name)\nN10 G0 X1   ' go\nN20 G90 (a) X1(b) 'c\n$if (CI600 = 1) then begin // ask {x}\n$end\n"
        "$DINEND\n{ one\n  two } CI600 := 1; // three\n{$DINSTART}\nM30 ' \x84\nN500 %\n"
    )
    program, _ = load(tmp_path, text.encode("latin-1"))
    assert program is not None
    n = NoteKind
    assert notes_of(program, 1) == [
        (1, 0, n.SIGNED, 0, b"' head"),
        (2, 0, n.MARK, 0, b"MAIN"),
        (2, 0, n.SIGNED, 0, b"(name)"),
        (3, 0, n.LINE_NUMBER, 0, b"10"),
        (3, 2, n.SIGNED, 12, b"' go"),
        (4, 0, n.LINE_NUMBER, 0, b"20"),
        (4, 1, n.SIGNED, 0, b"(a)"),
        (4, 2, n.SIGNED, 0, b"(b)"),
        (4, 2, n.SIGNED, 0, b"'c"),
        (5, 0, n.PASCAL, 0, b""),
        (5, 1, n.SIGNED, 0, b"// ask {x}"),
        (6, 0, n.PASCAL, 0, b""),
        (7, 0, n.PASCAL, 0, b""),
        (8, 0, n.PASCAL, 0, b""),
        (8, 0, n.SIGNED, 0, b"{ one"),
        (9, 0, n.PASCAL, 0, b""),
        (9, 0, n.SIGNED, 0, b"  two }"),
        (9, 1, n.SIGNED, 0, b"// three"),
        (10, 0, n.PASCAL, 0, b""),
        (11, 0, n.ENCODING, 0, b"cp1252"),
        (11, 1, n.SIGNED, 0, b"' \x84"),
        (12, 0, n.LINE_NUMBER, 0, b"500"),
        (12, 0, n.MARK, 0, b""),
    ]


def test_large_tables_are_read_when_they_run(tmp_path: Path) -> None:
    """More lines than a table holds: what follows goes on with the last code in it, wherever that is."""
    lines = ["G1 X0 F9", *(f"X{n}.5 Y-{n}" for n in range(9000)), "G90", "X1", "M30"]
    program, findings = load(tmp_path, "\n".join(lines))
    assert [f.code.label for f in findings.kept if f.severity.value == "error"] == []
    assert program is not None
    table = program.body[0]
    assert isinstance(table, BlockTable) and table.words is None
    assert (table.first_line, table.last_line, table.continued) == (1, 9001, "")
    blocks = [node for node in program.body if isinstance(node, Block)]
    assert blocks[0].continued == "G1"
    tail = program.body[2]
    assert isinstance(tail, BlockTable) and tail.continued == "?"
    assert table_blocks(program, table)[-1] == (
        9001, [("X", bits(8999.5), True, 0), ("Y", bits(-8999.0), False, 8)], "G1", "",
    )  # fmt: skip


@pytest.mark.parametrize("on", [machine(), machine(case_sensitive=True), machine(line_numbers=True)])
def test_both_speeds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, on: Machine) -> None:
    """Plain Python and compiled code give the same words and notes, bit for bit."""
    from gproof.frontend.mcuwin import scan_kernels as k
    from gproof.ir.notes import NOTE

    text = random_text(random.Random(7), 300).encode()
    how = Scanner(small=not mcuwin_settings(on).case_sensitive, numbered=mcuwin_settings(on).line_numbers)
    plain = b"".join(line for line in text.splitlines(keepends=True) if is_plain(line, how))
    results = []
    for speed in ("python", "numba"):
        monkeypatch.setenv("GPROOF_KERNELS", speed)
        words, *ended = how.scan(plain, 0, len(plain), 1, len(plain))
        notes = {c.name: np.zeros(len(plain), np.dtype(c.dtype)) for c in NOTE.columns}
        out = np.zeros(len(plain), np.uint8)
        data = plain if speed == "python" else np.frombuffer(plain, np.uint8)
        noted = k.scan_notes.pick(len(plain))(data, 0, len(plain), 1, 0, 0, *notes.values(), out)
        columns = [column.tobytes() for column in (*notes.values(), out)]
        results.append((list(words.rows()), ended, tuple(noted), columns))
    assert results[0] == results[1]
