"""Loops: the fast way through blocks gives what the evaluator gives, bit for bit, and memory stays bounded."""

from __future__ import annotations

import random
import tracemalloc
from pathlib import Path

import pytest
from passes.interpret.core.programs import HEAD, labels, run

from gproof.driver.running import begin
from gproof.frontend.eding.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.machine import NO_MACHINE
from gproof.ir.setup import ZERO
from gproof.ir.text import print_ir
from gproof.ir.trace import Op, Trace
from gproof.passes.interpret.core import hot_blocks as module


def both(folder: Path, text: str, monkeypatch: pytest.MonkeyPatch) -> tuple[Trace, Findings]:
    """Execute with and without the fast way: equal traces and equal findings."""
    fast, told = run(folder, text)
    with monkeypatch.context() as patch:
        patch.setattr(module, "compile_block", lambda *_: None)
        patch.setattr(module, "compile_condition", lambda *_: None)
        slow, said = run(folder, text)
    assert print_ir(fast) == print_ir(slow)
    assert sorted(map(str, told.kept)) == sorted(map(str, said.kept))
    assert told.counts == said.counts
    return fast, told


LOOPS = [
    "#1=0\nwhile [#1 < 40]\n#2=[10*sin[#1*9]]\nG1 X#2 Y[#1/3] F100\n#1=[#1+1]\nendwhile\n",
    "#1=0\nwhile [#1 <> 20]\nif [[#1 mod 3] == 0]\nG2 X[#1+1] Y0 I0.5\nelse\nG0 X[#1+1] Y#5002\nendif\n"
    "#1=[#1+1]\nendwhile\n",
    "#1=5\nwhile [#1 > -5]\n#1=[#1-1]\nG0 X[10/#1]\nendwhile\n",  # division by zero in the middle
    "#1=1\nwhile [#1 < 1e0]\nendwhile\n",
    "#1=0\nwhile [#1 < 6]\n#1=[#1+0.5]\nif [#1 == 2.5]\nG0 X#1\nendif\nendwhile\n",  # inexact comparisons
    "#1=0\nwhile [#1 < 9]\n#1=[#1+1] #1=[#1+2]\nG1 X#1 F#1\nendwhile\n",
    "#1=1\nwhile [#1 < 9]\n#2=[#2+#1]\nG1 X#2 F50\n#1=[#1+1]\nendwhile\n",  # #2 comes from the setup
    "#1=1\nwhile [#1 < 9]\nG91 G1 X#1 F50\nG90\nG1 Y#5001\n#1=[#1+1]\nendwhile\n",
    "sub s\n#3=[#3+1]\nG1 X[#3 ** 2] F9\nendsub\n#3=0\n#1=0\nwhile [#1<7]\ngosub s\n#1=[#1+1]\nendwhile\n",
    "#1=0\nwhile [#1 < 5]\n/G0 X#1\n#1=[#1+1]\nendwhile\n",
    "#1=1\nwhile [#1 < 400]\n#2=[#1 ** 130]\nG0 X[#2 / #2]\n#1=[#1*3]\nendwhile\n",  # far beyond every machine
    "#1=0\nwhile [#1 < 8]\nG1 X#1\n#1=[#1+1]\nendwhile\n",  # no feed: an error each time
    "#1=0\nwhile [#1 < 8]\nG1 X#1 Q3 F1\nG0 W1\n#1=[#1+1]\nendwhile\n",
    "#1=0\nwhile [#1 < 8]\nG1 X[#1 band 3] Y[#1 << 1] F50\n#1=[#1+1]\nendwhile\n",
    "#1=0\nwhile [#1 < 8]\nG1 X[-#1] Y[0 * -1] Z[fix[#1 / 2]] F50\n#1=[#1+1]\nendwhile\n",
    "#1=0\nwhile [#1 < 8]\nG4 P0.1\nG1 A[#1 * 10] F50\nG1 X#1 A0\n#1=[#1+1]\nendwhile\n",
    "#1=0\nwhile [#1 < 4]\n#[50+#1]=#1\nG0 X#51 Y##1\n#1=[#1+1]\nendwhile\n",
]


@pytest.mark.parametrize("loop", LOOPS)
def test_fast_equals_evaluated(tmp_path: Path, loop: str, monkeypatch: pytest.MonkeyPatch) -> None:
    both(tmp_path, loop + "M30\n", monkeypatch)


def test_random_loops(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = random.Random(99)
    for _ in range(30):
        body = "".join(_statement(rng, 2) for _ in range(rng.randrange(2, 7)))
        text = f"F200\n#1=1\n#2=2\n#3=3\n#9=0\nwhile [#9 < {rng.randrange(2, 9)}]\n{body}#9=[#9+1]\nendwhile\nM30\n"
        both(tmp_path, text, monkeypatch)


def _statement(rng: random.Random, depth: int) -> str:
    match rng.randrange(6):
        case 0 | 1:
            words = " ".join(f"{axis}{_value(rng)}" for axis in rng.sample("XYZ", rng.randrange(1, 4)))
            return f"{rng.choice(['G0', 'G1', ''])} {words}\n".lstrip()
        case 2 | 3:
            return f"#{rng.randrange(1, 4)}={_value(rng)}\n"
        case 4 if depth:
            return f"if [{_value(rng)} > {_value(rng)}]\n{_statement(rng, depth - 1)}else\n{_statement(rng, 0)}endif\n"
        case _:
            return rng.choice(["G91\n", "G90\n", "M8\n", "G0 X#5001\n", "G2 X[#1] Y[#2] R500\n", 'msg "at "#5001\n'])


def _value(rng: random.Random, depth: int = 2) -> str:
    if depth == 0 or rng.random() < 0.4:
        return rng.choice([f"#{rng.randrange(1, 4)}", f"{rng.uniform(-9, 9):.3f}", str(rng.randrange(9))])
    if rng.random() < 0.3:
        return f"{rng.choice(['sin', 'cos', 'abs', 'fix', 'sqrt', 'round', 'not', 'ln'])}[{_value(rng, depth - 1)}]"
    operator = rng.choice("+ - * / mod and or < >= == **".split())
    return f"[{_value(rng, depth - 1)} {operator} {_value(rng, depth - 1)}]"


def test_long_loop_in_bounded_memory(tmp_path: Path) -> None:
    """Motion of a loop is columns, handed out as it runs: no object for each move."""
    job = tmp_path / "job.cnc"
    job.write_text(HEAD + "F900\n#1=0\nwhile [#1 < 60000]\n#1=[#1+1]\nG1 X[#1 / 100] Y[#1 mod 7]\nendwhile\nM30\n")
    findings = Findings()
    program = load_program(job, findings)
    assert program is not None
    ex = begin(program, ZERO, NO_MACHINE, findings)
    rows, peak = 0, 0
    tracemalloc.start()
    for chunk in ex.chunks():
        rows += int((chunk.rows["op"] == Op.FEED).sum())
        peak = max(peak, tracemalloc.get_traced_memory()[1])
    tracemalloc.stop()
    assert rows == 60000 and not labels(findings)
    assert peak < 24e6  # one buffer of 32,768 rows has 5.5 MB
