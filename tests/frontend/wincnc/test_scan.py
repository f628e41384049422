"""Plain lines of WinCNC: automaton and scanner against the reader of single lines, plain Python against numba."""

from __future__ import annotations

import random
import struct
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from support.campaigns import examples
from support.each import each

from gproof.frontend.common.source import decode
from gproof.frontend.wincnc.line import LineError, LineReader
from gproof.frontend.wincnc.scan import AXIS_LETTERS, NO_LEXICAL, Scanner, scanner
from gproof.frontend.wincnc.statements import text_codes
from gproof.ir.dialects import rules_named
from gproof.ir.dialects.wincnc.settings import Lexical
from gproof.ir.program import FLAG_BARE, FLAG_POINT, Number

LIMIT = 256
TEXT_CODES = text_codes(rules_named("wincnc"))

Words = list[tuple[int, str, int, float]]


def bits(value: float) -> bytes:
    return struct.pack("d", value)


def is_plain(line: bytes, how: Scanner) -> bool:
    return how.index(line, 0, LIMIT).line.tolist() == []


def scanned(line: bytes, how: Scanner) -> Words:
    """Words of one plain line: (column from 0, letter, flags, value)."""
    columns, after, _ = how.scan(line, 0, len(line), 1, 1000)
    assert after == len(line)
    return [(offset, chr(letter), flags, value) for _, offset, letter, flags, value in columns.rows()]


def read(line: bytes, lexical: Lexical) -> Words | None:
    """The same by the reader of single lines; None: a mistake, or more than letters with literal numbers."""
    text = decode(line.removesuffix(b"\n").removesuffix(b"\r"))
    if any(text[:1].upper() in signs.upper() for signs, _ in lexical.skips if text):
        return None
    try:
        items = LineReader(lexical, TEXT_CODES).read(text, "job.tap", 1)
    except LineError:
        return None
    if items.texts or items.own or items.rest is not None:
        return None
    words: Words = []
    for word in items.words:
        if not isinstance(word.value, Number):
            return None
        if word.letter == "G":
            if word.value.value not in (0.0, 1.0, 2.0, 3.0):
                return None
        elif word.letter not in AXIS_LETTERS + "IJKRF":
            return None
        flags = (FLAG_BARE if word.bare else 0) | (FLAG_POINT if word.value.point else 0)
        words.append((word.span.column - 1, word.letter, flags, word.value.value))
    return words


def assert_alike(line: bytes, lexical: Lexical) -> None:
    """A plain line has the same words by both; one without expressions is most often plain."""
    how = Scanner(lexical)
    if not is_plain(line, how):
        return
    words = read(line, lexical)
    assert words is not None, line
    found = scanned(line, how)
    assert found == words
    assert [bits(word[3]) for word in found] == [bits(word[3]) for word in words]


NUMBERS = st.one_of(
    st.just(""),
    st.from_regex(r"[-+]?([0-9]{1,4}[.,]?[0-9]{0,5}|[.,][0-9]{1,5})", fullmatch=True),
    st.from_regex(r"[-+]?([0-9]{1,20}\.?[0-9]{0,25}|\.[0-9]{1,25})", fullmatch=True),
    st.sampled_from(["0", "-0", "-.0", "9007199254740993", "1." + "0" * 23, "-", ".", "1.2.3", "+", "1-2"]),
)
BLANKS = st.sampled_from(["", "", " ", "\t", "  "])
WORDS = st.tuples(st.sampled_from("XYZWUVABCIJKRFxyzfGgGMLTSE"), BLANKS, NUMBERS).map("".join)
CODES = st.sampled_from(["G0", "g01", "G2", "G003", "G3.", "G1.0", "G4", "G 1", "G90", "G", "G10"])
COMMENTS = st.one_of(
    st.sampled_from(
        ["[a]", "(b)", "[open", "(open", "% rest", "[a] (b)", "[a] x", "[(]", "(])", "'note", ";note", "[é]"]
    ),
    st.from_regex(r"\[[^\n\]]{0,6}\]?", fullmatch=True),
)
LINES = st.builds(
    lambda first, items, blanks, comments, end: first + blanks.join(items) + blanks.join(["", *comments]) + end,
    st.sampled_from(["", "", "", " ", "~", "$", "/", "'"]),
    st.lists(st.one_of(WORDS, WORDS, CODES, st.sampled_from(['X"a"', "X{F}", "{", "-", ",", "X1,5"])), max_size=5),
    BLANKS,
    st.lists(COMMENTS, max_size=2),
    st.sampled_from(["", "", " ", "\r", "\n", "\r\n", " \r\n", "\rX1"]),
)
LEXICALS = st.one_of(
    st.sampled_from([NO_LEXICAL, Lexical(comma=True), Lexical(comment_signs=";'"), Lexical(skips=(("$/", 1),))]),
    st.builds(
        Lexical,
        comment_signs=st.text("[](){}%;'/,.-+xX1gG\"Fé", max_size=3),
        skips=st.lists(
            st.tuples(st.text("$/[])(xXnN1 %.é", min_size=1, max_size=2), st.just(1)), max_size=1
        ).map(tuple),
        comma=st.booleans(),
    ),
)  # fmt: skip


@examples(150, 4000)
@given(LINES, LEXICALS)
@example("[a] X1", Lexical(comment_signs="["))
@example("[a] X1", Lexical(comment_signs="]"))
@example("[a] X1", Lexical(skips=(("]", 1),)))
@example("x1", Lexical(comment_signs="x"))
@example("ç", Lexical(comment_signs="Ã"))
def test_a_plain_line_has_the_words_that_the_reader_finds(text: str, lexical: Lexical) -> None:
    assert_alike(text.encode("utf-8"), lexical)
    assert_alike(text.encode("latin-1", "replace"), lexical)


@examples(200, 3200)
@given(st.text("GXYFIgx0123.,-+ \t()[]%;'\"{}~$\r\né\x00", max_size=40), LEXICALS)
def test_any_characters(text: str, lexical: Lexical) -> None:
    for line in text.split("\n"):
        assert_alike(line.encode("latin-1"), lexical)


@examples(125, 2000)
@given(LINES)
def test_what_is_read_as_literal_words_is_most_often_plain(text: str) -> None:
    """Otherwise jobs would be right, and slow: only codes that are written with a point are left to the reader."""
    line = text.encode("utf-8")
    words = read(line, NO_LEXICAL)
    codes = [word for word in words or [] if word[1] == "G"]
    if words is None or b"\r" in line.removesuffix(b"\n").removesuffix(b"\r") or any(code[2] for code in codes):
        return
    spaced = any(line[at + 1 : at + 2] in (b" ", b"\t", b"+", b"-") for at, *_ in codes)
    assert spaced or is_plain(line, Scanner())


@examples(100, 1600)
@given(st.from_regex(r"[-+]?([0-9]{1,20}\.?[0-9]{0,25}|\.[0-9]{1,25})", fullmatch=True), st.booleans())
def test_values_equal_float_of_the_text(number: str, comma: bool) -> None:
    text = number.replace(".", ",") if comma else number
    (word,) = scanned(f"x{text}\n".encode(), Scanner(Lexical(comma=comma)))
    assert bits(word[3]) == bits(float(number))


@each(
    "line,plain",
    [
        ("G0X1", True),
        ("g01 x+1.5y-.5 z 7", True),
        ("X1 G1", True),
        ("G2 I1 J2 K0 F100 [arc]", True),
        ("X Y", True),
        ("G1X Y5", True),
        ("W1U2V3A4B5C6", True),
        ("F100", True),
        ("", True),
        ("   ", True),
        ("[only a comment]", True),
        ("% rest [ (", True),
        ("X1 [a] (b) % c", True),
        ("X1 [never closed", True),
        ("X1 [a] Y2", False),
        ("[a] X1", False),
        ("X1,5", False),
        ("X1.2.3", False),
        ("X1 2", False),
        ("X-", False),
        ("X.", False),
        ("5", False),
        ("G4 X1", False),
        ("G10", False),
        ("G1.0", False),
        ("G", False),
        ("L91 G1 X1", False),
        ("M12C1", False),
        ("T1", False),
        ("P3", False),
        ("X{T}", False),
        ('X"a"', False),
        ("~G1 X1", False),
        ("/X1", False),
        ("N10 X1", False),
        ("X1;", False),
        ("X1\x07", False),
        ("[\x07]", True),
        ("X1\rY2", False),
        ("X1\r", True),
        ("é", False),
        ("X1 [é]", True),
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
            assert is_plain((before + line + end).encode(), Scanner()) is plain


@pytest.mark.parametrize(
    ("macros", "line", "plain"),
    [
        (["G1"], "G1 X1", False),
        (["G28", "M3"], "G1 X1", True),
        (["G28"], "G01X1", True),
        (["BACK"], "BACK", False),
        (["BACK"], "B1", False),
        (["BACK"], "X1 B1", True),
        (["PARK"], "A1 R", True),
        (["X1"], "X1.5 Y2", False),
        (["G1X5"], "G1X5", False),
        (["F"], "F100", False),
        (["F"], "G1 F100", True),
    ],
)
def test_a_line_that_begins_with_the_name_of_a_macro_is_not_plain(macros: list[str], line: str, plain: bool) -> None:
    """Macro File Configuration: names are codes or words, and words may be made of axis letters."""
    assert is_plain(line.encode(), scanner(NO_LEXICAL, macros)) is plain


def test_signs_that_the_machine_reads_otherwise() -> None:
    assert is_plain(b"X1,5", Scanner(Lexical(comma=True)))
    assert scanned(b"X1,5", Scanner(Lexical(comma=True))) == [(0, "X", FLAG_POINT, 1.5)]
    assert is_plain(b"X1 ; note", Scanner(Lexical(comment_signs=";")))
    assert not is_plain(b"$X1", Scanner(Lexical(skips=(("$", 2),))))
    assert is_plain(b"X1 [$]", Scanner(Lexical(skips=(("$", 2),))))
    assert not is_plain(b"G1 X1", Scanner(codes=False))


def random_data(seed: int, size: int) -> bytes:
    rng = random.Random(seed)
    pieces = [
        "G1 X{:.4f} Y{:.3f}",
        "X{:.17f}",
        "g2 x{:.0f} i-{:.2f} [rest",
        "M3 S{:.1f} (c)",
        "x{:.9f}y",
        "% {}",
        "",
        "F",
    ]
    lines: list[str] = []
    while sum(map(len, lines)) < size:
        lines.append(rng.choice(pieces).format(rng.uniform(-1e5, 1e5), rng.uniform(0, 9)))
    return rng.choice(["\n", "\r\n"]).join(lines).encode()


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("lexical", [NO_LEXICAL, Lexical(comment_signs=";", comma=True, skips=(("g", 1),))])
def test_plain_python_and_compiled_agree_bit_for_bit(
    monkeypatch: pytest.MonkeyPatch, seed: int, lexical: Lexical
) -> None:
    data = random_data(seed, 20_000)

    def run() -> Any:
        how = Scanner(lexical)
        found = how.index(data, 0, LIMIT)
        parts = []
        begin, line = 0, 1
        runs = [*zip(found.line.tolist(), found.begin.tolist(), found.end.tolist(), strict=True), (0, len(data), 0)]
        for number, first, after in runs:
            columns, _, _ = how.scan(data, begin, first, line, len(data))
            parts.append([columns[name].tobytes() for name in ("line", "offset", "letter", "flags", "value")])
            begin, line = after, number + 1
        at = [found.line, found.begin, found.end, found.words_before]
        return [column.tolist() for column in at], found.words_after, found.line_count, parts

    ways = []
    for mode in ("python", "numba"):
        monkeypatch.setenv("GPROOF_KERNELS", mode)
        ways.append(run())
    assert ways[0] == ways[1]


def test_chunks_join() -> None:
    data = b"".join(b"X%d Y%d.5 [n]\n" % (n, n) for n in range(5000))
    how = Scanner()
    begin, line, values = 0, 1, []
    while begin < len(data):
        columns, after, line = how.scan(data, begin, len(data), line, 4096)
        values.append(columns["value"])
        assert after - begin <= 4096 + 1024
        begin = after
    assert line == 5001
    assert np.concatenate(values)[::2].tolist() == [float(n) for n in range(5000)]
