"""Plain lines: index and scanner against a slow tokenizer written from the manual, plain Python against numba."""

from __future__ import annotations

import contextlib
import math
import random
import re
import struct
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.campaigns import examples, seeds
from support.each import each

from gproof.frontend.common import lines
from gproof.frontend.common.words import LONGEST_LINE
from gproof.frontend.eding import scan
from gproof.frontend.eding.parse import parse_line
from gproof.frontend.eding.prepare import LineError
from gproof.ir.program import FLAG_DELETE, FLAG_POINT, Block, Number

LIMIT = 256
LINE = re.compile(r"/?(?:N[0-9]{1,5})?((?:[ABCDEFGHIJKLMPQRSTXYZ][-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)|\|)*)")
WORD = re.compile(r"([A-Z])([-+]?[0-9.]+)")

Words = list[tuple[int, int, str, int, float]]


def words_of_line(raw: bytes, line: int, offset: int) -> Words | None:
    """The words of a plain line by the manual's rules (3.2), one rule after the other; None: not plain."""
    raw = raw.removesuffix(b"\r")
    if len(raw) > LIMIT or any((byte < 32 and byte != 9) or byte == 127 for byte in raw):
        return None
    text = raw.decode("latin-1")
    kept, at = [], 0  # what is left without comments and blanks: (position, character)
    while at < len(text) and text[at] != ";":
        if text[at] == "(":
            end = text.find(")", at)
            inside = text[at + 1 : end]
            if end < 0 or "(" in inside or re.sub(r"[ \t]", "", inside).upper().startswith("MSG,"):
                return None
            kept.append((at, "|"))
            at = end
        elif text[at] == "|":
            return None
        elif text[at] not in " \t":
            kept.append((at, text[at]))
        at += 1
    code = "".join(character.upper() if character.isascii() else "?" for _, character in kept)
    if code == "%":
        return []
    match = LINE.fullmatch(code)
    if match is None:
        return None
    flags = FLAG_DELETE if code.startswith("/") else 0
    return [
        (line, offset + kept[word.start()][0], word[1], flags | (FLAG_POINT if "." in word[2] else 0), float(word[2]))
        for word in WORD.finditer(code, match.start(1))
    ]


def reference(data: bytes) -> tuple[list[int], Words]:
    """Numbers of the lines that are not plain, and the words of the others."""
    special, words, offset = [], [], 0
    lines = data.split(b"\n")
    if lines[-1] == b"":
        lines.pop()
    for number, raw in enumerate(lines, 1):
        found = words_of_line(raw, number, offset)
        if found is None:
            special.append(number)
        else:
            words += found
        offset += len(raw) + 1
    return special, words


def bits(value: float) -> bytes:
    return struct.pack("d", value)


def scanned(data: bytes) -> tuple[list[int], Words]:
    """The same by index and scanner, as the loader uses them."""
    found = scan.index(data, 0, LIMIT)
    words: Words = []
    begin, line = 0, 1
    runs = [*zip(found.line.tolist(), found.begin.tolist(), found.end.tolist(), strict=True)]
    befores = [*map(bool, found.words_before.tolist()), found.words_after]
    for (number, first, after), has_words in zip([*runs, (0, len(data), len(data))], befores, strict=True):
        run: Words = []
        at = begin
        while at < first:
            columns, following, next_line = scan.scan(data, at, first, line, 50)
            for row, offset, letter, flags, value in columns.rows():
                run.append((row, at + offset, chr(letter), flags, value))
            assert following > at
            at, line = following, next_line
        assert has_words == bool(run)
        words += run
        begin, line = after, number + 1
    assert found.line_count == data.count(b"\n") + (not data.endswith(b"\n") and data != b"")
    return found.line.tolist(), words


def assert_same(data: bytes) -> None:
    special, words = reference(data)
    found_special, found_words = scanned(data)
    assert found_special == special
    assert found_words == words
    assert [bits(word[4]) for word in found_words] == [bits(word[4]) for word in words]


def by_grammar(line: bytes, offset: int) -> Words:
    """The words of a plain line as the grammar reads them; offsets only of lines in one-byte characters."""
    words: Words = []
    for block in parse_line(line, "job.cnc", 1):
        assert isinstance(block, Block)
        for word in block.words:
            assert isinstance(word.value, Number)
            written = line.decode("latin-1")[word.span.column - 1 : word.span.end_column - 1]
            flags = (FLAG_DELETE if block.deleted else 0) | (FLAG_POINT if "." in written else 0)
            words.append((1, offset + word.span.column - 1, word.letter, flags, word.value.value))
    return words


NUMBERS = st.one_of(
    st.from_regex(r"[-+]?([0-9]{1,20}\.?[0-9]{0,25}|\.[0-9]{1,25})", fullmatch=True),
    st.sampled_from(["0", "-0", "-.0", "9007199254740992", "9007199254740993", "90071992547409925", "1." + "0" * 23]),
)
BLANKS = st.text(" \t", max_size=2)
COMMENTS = st.one_of(
    st.from_regex(r"\([^()\x00-\x08\x0a-\x1f\x7f]{0,8}\)", fullmatch=True),
    st.from_regex(r"\( ?[mM] ?[sS][gG] ?,?.?\)", fullmatch=True),
)
WORDS = st.builds(str.__add__, st.sampled_from([*"ABCDEFGHIJKLMNOPQRSTUVWXYZxyzgm"]), NUMBERS)
ITEMS = st.one_of(WORDS, WORDS, COMMENTS, st.sampled_from(["/", "%", "#1", "[", "=", "é", "N5", "n12345", "n123456"]))
LINES = st.builds(
    lambda slash, number, items, blanks, rest: slash + number + blanks.join(items) + rest,
    st.sampled_from(["", "", "/", " /"]),
    st.sampled_from(["", "", "N10 ", "n 1 2", "N"]),
    st.lists(ITEMS, max_size=5),
    BLANKS,
    st.sampled_from(["", "", ";", "; rest (MSG,", ";é\x00", " ", "\r", "(open"]),
)
FILES = st.builds(
    lambda lines, end: ("\n".join(lines) + end).encode("latin-1", "replace"),
    st.lists(LINES, max_size=6),
    st.sampled_from(["", "\n", "\n\n"]),
)


@examples(200, 4000)
@given(FILES)
def test_index_and_scan_equal_the_slow_tokenizer(data: bytes) -> None:
    assert_same(data)


@examples(100, 1600)
@given(LINES)
def test_the_grammar_reads_a_plain_line_alike(text: str) -> None:
    line = text.encode("ascii", "replace").removesuffix(b"\r")
    words = words_of_line(line, 1, 0)
    if words is not None and b"%" not in line:
        assert by_grammar(line, 0) == words
        assert [bits(word[4]) for word in by_grammar(line, 0)] == [bits(word[4]) for word in words]
    elif words is None and b"MSG," not in re.sub(rb"[ \t]", b"", line).upper():
        with contextlib.suppress(LineError):  # a mistake, or more than literal words
            assert any(has_more(node) for node in parse_line(line, "job.cnc", 1) if isinstance(node, Block))


def has_more(block: Block) -> bool:
    """Something that makes a line of words not plain: a setting or an expression."""
    return bool(block.assigns) or not all(isinstance(word.value, Number) for word in block.words)


@examples(100, 1600)
@given(st.text("GXNMSg01.-+ \t()/;%,|#\r\né\x7f\x00E", max_size=60))
def test_any_characters_equal_the_slow_tokenizer(text: str) -> None:
    assert_same(text.encode("latin-1"))


@examples(125, 2000)
@given(NUMBERS, st.data())
def test_values_equal_float_of_the_text(number: str, data: st.DataObject) -> None:
    spaced = "".join(character + data.draw(BLANKS) for character in number)
    (word,) = scan.scan(f"x{spaced}\n".encode(), 0, len(spaced) + 2, 1, 1000)[0].rows()
    assert bits(word[4]) == bits(float(number))


def test_random_numbers_equal_float_of_the_text() -> None:
    rng = random.Random(20141112)
    texts = []
    for _ in range(20_000):
        digits = "".join(rng.choice("0123456789") for _ in range(rng.randint(1, 30)))
        point = rng.randint(0, len(digits))
        texts.append(rng.choice(["", "-", "+"]) + digits[:point] + "." + digits[point:])
    data = "\n".join("X" + text for text in texts).encode()
    columns, _, _ = scan.scan(data, 0, len(data), 1, len(data))
    assert columns["value"].view(np.int64).tolist() == np.array([float(t) for t in texts]).view(np.int64).tolist()


@each(
    "line,plain",
    [
        ("g0x +0. 12 34y 7", True),
        ("/N10 G1 X1", True),
        ("N10/G1", False),
        ("N99999", True),
        ("N000009", False),
        ("N 1 2 3 G1", True),
        ("N10 N20", False),
        ("G1 (a) X2 (b) ; c", True),
        ("G (a) 1", False),
        ("X1 (a) 2", False),
        ("(MSG, hello)", False),
        ("( m s g , hello)", False),
        ("(MSG hello)", True),
        ("(MS)", True),
        ("(M(SG)", False),
        ("(a (b) c)", False),
        ("(open", False),
        ("; (open", True),
        ("%", True),
        (" % ", True),
        ("% ; b", True),
        ("% (a)", False),
        ("%(a)X1", False),
        ("(a) %", False),
        ("% 1", False),
        ("%%", False),
        ("x.", False),
        ("x.5", True),
        ("x5.", True),
        ("x-.5", True),
        ("x--5", False),
        ("x1.2.3", False),
        ("x1-2", False),
        ("xy1", False),
        ("u1", False),
        ("e1", True),
        ("#1=3", False),
        ("x#1", False),
        ("x[1]", False),
        ("(é)", True),
        ("é", False),
        ("X1\x07", False),
        ("(\x07)", False),
        ("X1\rY2", False),
        ("; a\rY2", False),
        ("X1\r", True),
        ("X1 (a)\r", True),
        ("", True),
        ("/", True),
        ("X1" + " " * 254, True),
        ("X1" + " " * 255, False),
        ("X1" + " " * 254 + "\r", True),
    ],
)
def test_which_lines_are_plain(line: str, plain: bool) -> None:
    for end in ("\n", ""):
        for before in ("", " "):  # the automaton goes by pairs of bytes: both alignments
            if plain and len((before + line).removesuffix("\r")) > LIMIT:
                continue
            data = (before + line + end).encode()
            assert (scan.index(data, 0, LIMIT).line.tolist() == []) is plain
            assert (words_of_line((before + line).encode(), 1, 0) is not None) is plain


def random_data(seed: int, size: int) -> bytes:
    rng = random.Random(seed)
    pieces = [
        "G1 X{:.4f} Y{:.3f}",
        "X{:.17f}",
        "N{:.0f} g0 z-{:.2f} ; rest",
        "/m3 s{:.1f} (c)",
        "#1=[{:.2f}]",
        "(open",
        "",
    ]
    lines = []
    while sum(map(len, lines)) < size:
        lines.append(rng.choice(pieces).format(rng.uniform(-1e5, 1e5), rng.uniform(0, 9)))
    return "\n".join(lines).encode()


def both_ways(monkeypatch: pytest.MonkeyPatch, run: Any) -> list[Any]:
    results = []
    for mode in ("python", "numba"):
        monkeypatch.setenv("GPROOF_KERNELS", mode)
        results.append(run())
    return results


@pytest.mark.parametrize("seed", range(5))
def test_plain_python_and_compiled_agree_bit_for_bit(monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    data = random_data(seed, 20_000)

    def run() -> Any:
        found = scan.index(data, 0, LIMIT)
        parts = []
        begin, line = 0, 1
        runs = [*zip(found.line.tolist(), found.begin.tolist(), found.end.tolist(), strict=True), (0, len(data), 0)]
        for number, first, after in runs:
            columns, _, _ = scan.scan(data, begin, first, line, len(data))
            parts.append([columns[name].tobytes() for name in ("line", "offset", "letter", "flags", "value")])
            begin, line = after, number + 1
        columns_of_index = [found.line, found.begin, found.end, found.words_before]
        return [a.tolist() for a in columns_of_index], found.words_after, found.line_count, parts

    plain, compiled = both_ways(monkeypatch, run)
    assert plain == compiled


def test_index_goes_on_where_its_columns_were_full(monkeypatch: pytest.MonkeyPatch) -> None:
    data = b"g1 x1\n#1=1\n(c)\n#2=2\n#3=3\ng1\n(c)\n" * 40
    whole = scan.index(data, 0, LIMIT)
    monkeypatch.setattr(lines, "_ROOM", 3)
    parts = scan.index(data, 0, LIMIT)
    assert parts.words_before.tolist() == whole.words_before.tolist()
    assert parts.begin.tolist() == whole.begin.tolist()
    assert (parts.words_after, parts.line_count) == (whole.words_after, whole.line_count)


def test_chunks_are_bounded_and_join() -> None:
    data = b"".join(b"G1 X%d Y%d.5\n" % (n, n) for n in range(5000))
    begin, line, rows = 0, 1, 0
    while begin < len(data):
        columns, after, line = scan.scan(data, begin, len(data), line, 4096)
        assert after - begin <= 4096 + LONGEST_LINE
        rows += len(columns)
        begin = after
    assert (rows, line) == (15_000, 5001)


def test_negative_zero_keeps_its_sign() -> None:
    (word,) = scan.scan(b"x-0", 0, 3, 1, 10)[0].rows()
    assert math.copysign(1.0, word[4]) == -1.0


@pytest.mark.soak
@pytest.mark.parametrize("seed", seeds(8, 20))
def test_soak(seed: int) -> None:
    rng = random.Random(seed)
    pieces = 'G1 X Y-2.5 n10 N123456 ( ) (c) (MSG , ; % / . - + #1 [2] é 0 00.10 U1 E1 " ='.split()
    pieces += ["m s g", " ", "\t", "\r", "\r\n", "\n", "\n", "\n", "\x07", "9" * 18]
    for _ in range(500):
        text = "".join(rng.choice(pieces) for _ in range(rng.randint(0, 60)))
        assert_same(text.encode("latin-1"))
