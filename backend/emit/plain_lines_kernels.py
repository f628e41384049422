"""Plain lines as text: words and notes of a table, merged line by line into one buffer of bytes."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from gproof.ir.kernel import kernel

LINE_NUMBER = 1
DELETE = 2
MARK = 3
COMMENT = 4
REMARK = 5
SIGNED = 7
LEFT_OUT = 8
"""Kinds of notes; equal to those of ``ir/notes.py`` NoteKind."""

FLAG_POINT = 1
FLAG_DELETE = 2
FLAG_BARE = 4
"""Flags of words; equal to those of ``ir/program.py``."""

EXACT = 1e15
"""Numbers of up to 15 digits: no two of them round to the same float64, and digits / power of ten gives it."""
MOST_DECIMALS = 15


@kernel(seconds_per_unit=6e-7, compile_seconds=0.5)
def count_decimals(values: Any, powers: Any, decimals: Any) -> int:
    """How many decimals the shortest text of each value has; -1 for those of more than 15 digits.

    powers: 10**0 .. 10**15 as floats. Returns how many are -1.
    """
    hard = 0
    for n in range(len(values)):
        value = abs(values[n])
        found = -1
        d = 0
        while d <= MOST_DECIMALS:
            scaled = value * powers[d] + 0.5
            if scaled >= EXACT:
                break
            digits = math.floor(scaled)
            if digits / powers[d] == value:
                found = d
                break
            d += 1
        decimals[n] = found
        if found < 0:
            hard += 1
    return hard


class Layout(NamedTuple):
    """indent: blanks before the first word or comment; limit: bytes that a line may have; returns: 1 for lines that end
    in CR LF; two_digits: 1 where a G code has two digits at least; kept: ``kept_size`` bytes with which no line may
    start."""

    indent: int
    limit: int
    returns: int
    two_digits: int
    kept: Any
    kept_size: int


class PrintedWords(NamedTuple):
    """Columns of WORD, and of each word's number its decimals, or -1 - n where its text is
    hard_text[hard_begin[n]:hard_begin[n + 1]]; powers: 10**0 .. 10**15 as integers."""

    line: Any
    letter: Any
    flags: Any
    value: Any
    decimals: Any
    powers: Any
    hard_begin: Any
    hard_text: Any


class PrintedNotes(NamedTuple):
    """Columns of notes; text: where their texts are, from ``begin`` on, so many bytes."""

    line: Any
    place: Any
    kind: Any
    column: Any
    begin: Any
    size: Any
    text: Any


class LongLines(NamedTuple):
    """Gets number, start and end in the text of lines that are too long, or that start with what none may."""

    line: Any
    begin: Any
    end: Any


@kernel(seconds_per_unit=4e-7, compile_seconds=2.0)
def print_lines(
    first: int, last: int, layout: Layout, printed: PrintedWords, noted: PrintedNotes, out: Any, long: LongLines
) -> tuple[int, int]:  # fmt: skip
    """Print the lines first..last with their words and notes; a line with neither is empty.

    out: room for everything. Returns (bytes printed, long lines).
    """
    indent, limit, returns, two_digits, kept, kept_size = layout
    word_line, word_letter, word_flags, word_value, decimals, powers, hard_begin, hard_text = printed
    note_line, note_place, note_kind, note_column, note_begin, note_size, note_text = noted
    long_line, long_begin, long_end = long
    size = 0
    longs = 0
    w = 0
    n = 0
    words = len(word_line)
    notes = len(note_line)
    for line in range(first, last + 1):
        start = size
        place = 0
        begun = False  # something is in the line
        slash = False  # the last thing is the slash
        while True:
            is_note = n < notes and note_line[n] == line
            is_word = w < words and word_line[w] == line
            if is_note and is_word and note_place[n] > place:
                is_note = False
            if not is_note and not is_word:
                break
            kind = int(note_kind[n]) if is_note else 0
            if kind == DELETE and slash:
                n += 1
                continue
            if is_note and (kind < LINE_NUMBER or (kind > REMARK and kind not in (SIGNED, LEFT_OUT))):
                n += 1
                continue
            if not begun:
                if kind != MARK:
                    for _ in range(indent):
                        out[size] = 32
                        size += 1
            elif not slash:
                out[size] = 32
                size += 1
                if is_note and not is_word and place > 0:
                    at_column = 0
                    for j in range(start, size):
                        at_column += 8 - at_column % 8 if out[j] == 9 else 1
                    while at_column < note_column[n]:
                        out[size] = 32
                        size += 1
                        at_column += 1
            if kind == DELETE or (is_word and not begun and word_flags[w] & FLAG_DELETE):
                out[size] = 47
                size += 1
                begun = True
                slash = True
                if kind == DELETE:
                    n += 1
                continue
            begun = True
            slash = False
            if is_note:
                if kind == LINE_NUMBER:
                    out[size] = 78
                    size += 1
                elif kind == MARK:
                    out[size] = 37
                    size += 1
                elif kind == COMMENT:
                    out[size] = 40
                    size += 1
                elif kind == REMARK:
                    out[size] = 59
                    size += 1
                at = int(note_begin[n])
                for i in range(at, at + int(note_size[n])):
                    out[size] = note_text[i]
                    size += 1
                if kind == COMMENT:
                    out[size] = 41
                    size += 1
                n += 1
                continue
            out[size] = word_letter[w]
            size += 1
            d = int(decimals[w])
            if word_flags[w] & FLAG_BARE:
                pass
            elif d < 0:
                for i in range(int(hard_begin[-1 - d]), int(hard_begin[-d])):
                    out[size] = hard_text[i]
                    size += 1
            else:
                value = word_value[w]
                if math.copysign(1.0, value) < 0.0:
                    out[size] = 45
                    size += 1
                    value = -value
                power = int(powers[d])
                digits = math.floor(value * power + 0.5)
                whole = digits // power
                if two_digits and whole < 10 and word_letter[w] == 71:
                    out[size] = 48
                    size += 1
                rest = digits - whole * power
                p = 1
                k = 0
                while k < MOST_DECIMALS and whole >= p * 10:
                    p *= 10
                    k += 1
                while p > 0:
                    digit = whole // p
                    out[size] = 48 + digit
                    size += 1
                    whole -= digit * p
                    p //= 10
                if d > 0:
                    out[size] = 46
                    size += 1
                    p = power // 10
                    while p > 0:
                        digit = rest // p
                        out[size] = 48 + digit
                        size += 1
                        rest -= digit * p
                        p //= 10
                elif word_flags[w] & FLAG_POINT:
                    out[size] = 46
                    out[size + 1] = 48
                    size += 2
            w += 1
            place += 1
        stays = size - start > limit
        for j in range(kept_size):
            if size > start and out[start] == kept[j]:
                stays = True
        if stays:
            long_line[longs] = line
            long_begin[longs] = start
            long_end[longs] = size
            longs += 1
        if returns:
            out[size] = 13
            size += 1
        out[size] = 10
        size += 1
    return size, longs
