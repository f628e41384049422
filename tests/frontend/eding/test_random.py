"""Nothing raises: random bytes, and programs of the language's own pieces put together at random.

A seed is in each test's name; the failing program is written to the test's folder and its text printed.
"""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from frontend.eding.programs import load
from support.campaigns import seeds

from gproof.ir.text import parse_ir, print_ir

PIECES = """
G0|G1|G2|g53|M3|m 6|X1.5|Y-2|z.5|I0 J1|F300|S1000|T1|R5|X|Y#1|Z[#2+1]|x#[1+#3]|##4|#5=6|#7=[8 mod 3]|#1|=|[|]|(c)
|(MSG, hi)|(open|)|;rest|N10|N123456|/|%|1.2.3|-|+|*|**|==|<>|<=|<<|band|xor|atan[1]/[2]|atan[1]|sin[30]|sqrt 4|foo
|foo[1]|\t|  |é|“|"|\x07|if [#1 == 2]|if [1] then|if|IF[|else|endif|end if|while [#1 < 3]|while|endwhile|end  while
|sub a|sub b|sub|sub 1|endsub|gosub a|gosub c|gosub|msg "a"#1|msg "a|errmsg “b” [2+1]|dlgmsg "a" b 100 "c" 101|dlgmsg
|logfile "x" 1|logmsg "y"#2|tcaguard off|mcaguard on|tcaguard|tanknife on|zhcaddpoint|home x|sp "a.txt" 1|sp1
|setlafangle 3|homeisestop on|then|U5|O100|E2
""".replace("\n", "").split("|")


def random_line(rng: random.Random) -> str:
    line = rng.choice(["", "", " "]).join(rng.choice(PIECES) for _ in range(rng.choice([0, 1, 1, 1, 2, 3, 5, 8])))
    if rng.random() < 0.15 and line:  # one character goes wrong
        at = rng.randrange(len(line))
        line = line[:at] + rng.choice('[]()#=;/%.-+xnu1 \té“"') + line[at + rng.randint(0, 1) :]
    return line


def random_program(rng: random.Random) -> bytes:
    lines = [random_line(rng) for _ in range(rng.randint(0, 25))]
    text = rng.choice(["\n", "\n", "\r\n"]).join(lines)
    return text.encode(rng.choice(["utf-8", "cp1252"]), "replace")


def random_bytes(rng: random.Random) -> bytes:
    if rng.random() < 0.5:
        return rng.randbytes(rng.randint(0, 200)).replace(b"\0", b"\n")
    alphabet = b'GXYZMNifsubend#[]()=+-*/.<>0123456789 \t\r\n;%"\xe9\x80'
    return bytes(rng.choice(alphabet) for _ in range(rng.randint(0, 300)))


def never_raises(folder: Path, data: bytes) -> None:
    try:
        program, findings = load(folder, data)
        if program is not None:
            program.verify()
            assert parse_ir(print_ir(program)) == program
        lines = data.split(b"\n")
        for finding in findings.kept:
            span = finding.span
            assert finding.message
            assert 0 <= span.line <= max(len(lines), 1)
            if span.column:
                assert span.column < span.end_column <= len(lines[span.line - 1]) + 2
    except Exception:
        print(data)
        raise


@pytest.mark.parametrize("seed", seeds(4, 10))
def test_random_bytes(tmp_path: Path, seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(100):
        never_raises(tmp_path, random_bytes(rng))


@pytest.mark.parametrize("seed", seeds(4, 10))
def test_random_programs(tmp_path: Path, seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(100):
        never_raises(tmp_path, random_program(rng))


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(100, 120))
def test_soak(tmp_path: Path, seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(500):
        never_raises(tmp_path, random_bytes(rng))
        never_raises(tmp_path, random_program(rng))
