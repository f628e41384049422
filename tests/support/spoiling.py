"""Files as no program writes them: one of several right ones with bytes, words, lines, numbers or nesting changed."""

from __future__ import annotations

import random
import re
from collections.abc import Sequence

MOST = 60_000
"""Bytes of a spoilt file at most: what is long is tested elsewhere, and a case is to take a millisecond."""

NUMBERS = [
    b"nan", b"inf", b"-inf", b"+nan", b"1e308", b"-1e308", b"1e309", b"1e-308", b"1e-324", b"5e-324", b"-0", b"-0.0",
    b"0", b"-1", b"1", b"00", b"1e5", b"0x10", b"1_000", b".", b"-", b"+", b"", b"1.5.2", b"--1", b"1e", b"1e+", b"1/0",
    b"1/3", b"0/1", b"0.1", b"1e15", b"1e16", b"123456789012", b"2147483647", b"2147483648", b"-2147483649",
    b"4294967296", b"9007199254740993", b"9223372036854775807", b"9223372036854775808", b"-9223372036854775809",
    b"18446744073709551616", b"9" * 40, b"9" * 300, b"9" * 400, b"-" + b"9" * 310, b"0." + b"0" * 330 + b"1",
    b"1" + b"0" * 308, b"9" * 4400, b"1e9999999", b"1e-9999999", b"true", b"none", b'"1"', b"[1]", b"\xd9\xa1\xd9\xa2",
    b"\xc2\xb2", b"1,5",
]  # fmt: skip
"""What stands where a number stood. 4,400 digits are more than Python reads as an int."""
STRANGE = [
    b"\0", b"\0\0\0\0", b"\r", b"\n", b"\r\n", b"\t", b"\x0b", b"\x0c", b"\x1a", b"\x1b[31m", b"\x7f", b"\x85", b"\xff",
    b"\xff\xfe", b"\xc3", b"\xc3\xa4", b"\xe4", b"\xe2\x80\xa8", b"\xe2\x80\xae", b"\xed\xa0\x80", b"\xf0\x9f\x98\x80",
    b"\xef\xbb\xbf", b"\xcc\x81", b"\xc4\xb1", b"\xc5\xbf", b"\xe2\x84\xaa", b"'", b'"', b"\\", b"\\u", b"\\ud800",
    b"%", b"%s", b"{}", b"{0}", b"$", b"#", b";", b"=", b":", b"(", b")", b"[", b"]", b"{", b"}", b"<", b">", b"/",
    b"*", b",", b".", b"..", b"../../..", b"/dev/zero", b"/", b"~", b"@", b"!", b"|", b"&", b" ",
]  # fmt: skip
NESTS = [
    (b"(", b")"), (b"[", b"]"), (b"{", b"}"), (b"[[", b"]]"), (b"a.", b""), (b"-", b""), (b"sin(", b")"),
    (b"sin[", b"]"), (b"#[", b"]"), (b"#", b""), (b'{"a":', b"}"), (b"{a=", b"}"), (b"not ", b""),
]  # fmt: skip
_NUMBER = re.compile(rb"(?<![A-Za-z0-9_.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|(?<=[A-Za-z])[-+]?\d+\.?\d*")
_WORD = re.compile(rb"[A-Za-z_][A-Za-z_0-9]*|[-+]?\d+\.?\d*|[^\sA-Za-z_0-9]")


def spoilt(rng: random.Random, seeds: Sequence[bytes]) -> bytes:
    """One of the seeds, or a part of it, with one to many changes; the same for the same state of ``rng``."""
    data = rng.choice(seeds)
    if len(data) > 3000 or rng.random() < 0.2:
        lines = data.splitlines(keepends=True)
        first = rng.randrange(len(lines)) if lines and rng.random() < 0.7 else 0
        data = b"".join(lines[first : first + rng.choice((1, 3, 10, 40, 80))])[:6000]
    for _ in range(rng.choice((1, 1, 1, 2, 2, 3, 5, 12))):
        change = rng.choices(_CHANGES, _WEIGHTS)[0]
        data = change(rng, data, seeds)
        if len(data) > MOST:
            data = data[:MOST]
    return data


def _bytes(rng: random.Random, data: bytes, seeds: Sequence[bytes]) -> bytes:
    out = bytearray(data or b"x")
    for _ in range(rng.choice((1, 1, 4))):
        out[rng.randrange(len(out))] = rng.randrange(256)
    return bytes(out)


def _somewhere(rng: random.Random, pattern: re.Pattern[bytes], data: bytes) -> re.Match[bytes] | None:
    """A match from a random place on, else the first."""
    return pattern.search(data, rng.randrange(len(data) + 1)) or pattern.search(data)


def _number(rng: random.Random, data: bytes, seeds: Sequence[bytes]) -> bytes:
    spot = _somewhere(rng, _NUMBER, data)
    if spot is None:
        return data + rng.choice(NUMBERS)
    put = rng.choice(NUMBERS)
    if rng.random() < 0.3:
        put = rng.choice(
            (b"-" + spot[0], spot[0] * 2, spot[0] + b"e9", spot[0] + b".5", b"%g" % rng.uniform(-1e4, 1e4))
        )
    return data[: spot.start()] + put + data[spot.end() :]


def _word(rng: random.Random, data: bytes, seeds: Sequence[bytes]) -> bytes:
    """A word of another file, or of this one, in place of one, before one, or none."""
    spot, second, other = (_somewhere(rng, _WORD, text) for text in (data, data, rng.choice(seeds)))
    others = [b"", *(found[0] for found in (second, other) if found)]
    if spot is None:
        return data + rng.choice(others)
    put = rng.choice(others)
    end = spot.start() if rng.random() < 0.3 else spot.end()
    return data[: spot.start()] + put + data[end:]


def _lines(rng: random.Random, data: bytes, seeds: Sequence[bytes]) -> bytes:
    lines = data.splitlines(keepends=True) or [b"\n"]
    at, kind = rng.randrange(len(lines)), rng.randrange(5)
    if kind == 0:
        del lines[at : at + rng.choice((1, 1, 3, 20))]
    elif kind == 1:
        lines.insert(at, rng.choice(lines))
    elif kind == 2:
        other = rng.randrange(len(lines))
        lines[at], lines[other] = lines[other], lines[at]
    elif kind == 3:
        lines[at] = lines[at].rstrip(b"\r\n")
    else:
        others = rng.choice(seeds).splitlines(keepends=True) or [b"\n"]
        first = rng.randrange(len(others))
        lines[at:at] = others[first : first + rng.choice((1, 1, 3))]
    return b"".join(lines)


def _strange(rng: random.Random, data: bytes, seeds: Sequence[bytes]) -> bytes:
    at = rng.randrange(len(data) + 1)
    return data[:at] + rng.choice(STRANGE) + data[at:]


def _cut(rng: random.Random, data: bytes, seeds: Sequence[bytes]) -> bytes:
    at = rng.randrange(len(data) + 1)
    return data[:at] if rng.random() < 0.5 else data[:at] + data[at + rng.randrange(1, 30) :]


def _nest(rng: random.Random, data: bytes, seeds: Sequence[bytes]) -> bytes:
    opening, closing = rng.choice(NESTS)
    spot = _somewhere(rng, _WORD, data)
    if spot is None:
        return data
    deep = rng.choice((2, 5, 40, 150, 400, 1500))
    inside = opening * deep + spot[0] + closing * (deep if rng.random() < 0.8 else deep - 1)
    return data[: spot.start()] + inside + data[spot.end() :]


def _many(rng: random.Random, data: bytes, seeds: Sequence[bytes]) -> bytes:
    """A line, a word or a few bytes over and over."""
    lines = data.splitlines(keepends=True) or [b"\n"]
    kind = rng.randrange(3)
    if kind == 0:
        at = rng.randrange(len(lines))
        lines[at:at] = [lines[at]] * min(rng.choice((10, 100, 500)), 8000 // (len(lines[at]) + 1) + 1)
        return b"".join(lines)
    spot = _somewhere(rng, _WORD, data)
    if kind == 1 and spot:
        return data[: spot.start()] + spot[0] * rng.choice((10, 300, 2000)) + data[spot.end() :]
    at = rng.randrange(len(data) + 1)
    return data[:at] + data[at : at + rng.randrange(1, 12)] * rng.choice((10, 100, 800)) + data[at:]


def _encoding(rng: random.Random, data: bytes, seeds: Sequence[bytes]) -> bytes:
    text, kind = data.decode("latin-1"), rng.randrange(8)
    if kind < 4:
        return text.encode(("utf-16", "utf-16-le", "utf-8-sig", "utf-32")[kind])
    if kind < 6:
        return data.replace(b"\n", (b"\r\n", b"\r")[kind - 4])
    return text.swapcase().encode("latin-1", "replace") if kind == 6 else b"" if rng.random() < 0.05 else data * 2


_CHANGES = [_bytes, _number, _word, _lines, _strange, _cut, _nest, _many, _encoding]
_WEIGHTS = [12, 28, 20, 14, 10, 6, 4, 3, 3]
