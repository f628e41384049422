"""How fast programs are read, measured inside one process: lines a second and memory, for three kinds of lines.

``python bench/parse.py`` prints one JSON object: for ``plain`` (literal words), ``repeat`` (expressions in a few shapes
that come again) and ``different`` (no two lines of one shape) the lines, the processor seconds of loading them, and the
memory that a line more costs, in bytes: what the peak grows by when the program has twice as many. ``grammar``: the
lines of ``different`` through the grammar alone, which is the reference for all of them; nothing of them is kept.
"""

from __future__ import annotations

import json
import random
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

LINES = {"plain": 1_000_000, "repeat": 200_000, "different": 10_000, "grammar": 10_000}
OPERATORS = ("+", "-", "*", "/", "mod", "and", "or")
FUNCTIONS = ("sin", "cos", "abs", "sqrt", "round", "int")


def plain(rng: random.Random) -> str:
    return f"G1 X{rng.uniform(0, 500):.4f} Y{rng.uniform(0, 500):.4f} Z-{rng.uniform(0, 5):.4f}"


def repeat(rng: random.Random) -> str:
    x, y = rng.uniform(0, 500), rng.uniform(0, 500)
    forms = (
        f"G1 X[#1+{x:.4f}] Y[#2+{y:.4f}]",
        f"G1 X[{x:.4f}] Y[{y:.4f}] Z[#3-{rng.uniform(0, 5):.2f}] F#4",
        f"N{rng.randint(1, 99999)} X[#1 + {x:.3f}]",
        f"#5 = [#5 + {rng.uniform(0, 1):.3f}] (pass {rng.randint(1, 99)})",
    )
    return forms[rng.choice((0, 0, 0, 1, 1, 2, 3))]


def value(rng: random.Random, depth: int) -> str:
    if depth == 0 or rng.random() < 0.3:
        return rng.choice((f"#{rng.randint(1, 99)}", f"{rng.uniform(0, 100):.3f}"))
    if rng.random() < 0.7:
        return f"[{value(rng, depth - 1)} {rng.choice(OPERATORS)} {value(rng, depth - 1)}]"
    return f"{rng.choice(FUNCTIONS)}[{value(rng, depth - 1)}]"


def different(seen: set[str]) -> Callable[[random.Random], str]:
    def line(rng: random.Random) -> str:
        while True:
            text = f"G{rng.randint(0, 3)} X[{value(rng, 2)}] Y[{value(rng, 1)}]"
            shape = re.sub(r"[0-9]+\.?[0-9]*", "0", text)
            if shape not in seen:
                seen.add(shape)
                return text

    return line


def write(kind: str, lines: int, path: Path) -> None:
    rng = random.Random(1)
    make = {"plain": plain, "repeat": repeat}.get(kind) or different(set())
    with path.open("w", encoding="ascii") as file:
        file.writelines(f"{make(rng)}\n" for _ in range(lines))


def measure(path: Path) -> dict[str, float]:
    """Processor seconds and peak memory, bytes, of loading a program; kernels and grammar are there before."""
    from gproof.frontend.eding.load import load_program
    from gproof.ir.finding import Findings

    small = path.with_name("small.cnc")
    small.write_bytes(b"x[#1]\n" + path.read_bytes()[:500_000].rpartition(b"\n")[0] + b"\n")
    load_program(small, Findings())
    began = time.process_time()
    findings = Findings()
    load_program(path, findings)
    seconds = time.process_time() - began
    assert not findings.kept, findings.kept
    scale = 1 if sys.platform == "darwin" else 1024
    return {"seconds": seconds, "peak": float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * scale)}


def measure_grammar(path: Path) -> dict[str, float]:
    """As ``measure``, of the grammar alone."""
    from gproof.frontend.eding.parse import parse_line

    lines = path.read_bytes().splitlines()
    parse_line(lines[0], "", 1)
    began = time.process_time()
    for number, line in enumerate(lines, 1):
        parse_line(line, "", number)
    return {"seconds": time.process_time() - began, "peak": 0.0}


def main() -> None:
    if sys.argv[1:]:
        kind, path = sys.argv[1], Path(sys.argv[2])
        print(json.dumps(measure_grammar(path) if kind == "grammar" else measure(path)))
        return
    out = {}
    with tempfile.TemporaryDirectory() as folder:
        for kind, lines in LINES.items():
            found = []
            for count in (lines, 2 * lines):
                path = Path(folder) / f"{kind}-{count}.cnc"
                write(kind, count, path)
                said = subprocess.run([sys.executable, __file__, kind, str(path)], capture_output=True, check=True)
                found.append(json.loads(said.stdout))
            grown = max(0.0, (found[1]["peak"] - found[0]["peak"]) / lines)
            out[kind] = {"lines": lines, "seconds": found[0]["seconds"], "bytes_a_line": grown}
    print(json.dumps(out))


if __name__ == "__main__":
    main()
