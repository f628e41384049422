"""How fast programs are read, measured inside one process: lines a second and memory, for three kinds of lines.

``python bench/parse.py [eding|mcuwin]`` prints one JSON object: for ``plain`` (literal words), ``repeat`` (expressions
in a few shapes that come again) and ``different`` (no two lines of one shape) the lines, the processor seconds of
loading them, and the memory that a line more costs, in bytes: by which the peak grows when the program is twice as
long. ``grammar`` (of Eding): the lines of ``different`` through the grammar alone, the reference for all of them.
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
KINDS = {"eding": tuple(LINES), "mcuwin": ("plain", "repeat", "different")}
SUFFIX = {"eding": ".cnc", "mcuwin": ".din"}
OPERATORS = {"eding": ("+", "-", "*", "/", "mod", "and", "or"), "mcuwin": ("+", "-", "*", "/")}
FUNCTIONS = {
    "eding": ("sin", "cos", "abs", "sqrt", "round", "int"), "mcuwin": ("sin", "cos", "abs", "sqrt", "sqr", "exp"),
}  # fmt: skip
Make = Callable[[random.Random], str]


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


def repeat_din(rng: random.Random) -> str:
    x, y = rng.uniform(0, 500), rng.uniform(0, 500)
    forms = (
        f"G01 X(CD601+{x:.4f}) Y(CD602+{y:.4f})",
        f"G01 X({x:.4f}) Y({y:.4f}) Z(CD603-{rng.uniform(0, 5):.2f}) F(CD604)",
        f"N{rng.randint(1, 99999)} G01 X(CD601 + {x:.3f})",
        f"$CD605 := CD605 + {rng.uniform(0, 1):.3f}; // pass {rng.randint(1, 99)}",
    )
    return forms[rng.choice((0, 0, 0, 1, 1, 2, 3))]


def value(rng: random.Random, depth: int, dialect: str) -> str:
    if depth == 0 or rng.random() < 0.3:
        variable = f"#{rng.randint(1, 99)}" if dialect == "eding" else f"CD{rng.randint(600, 699)}"
        return rng.choice((variable, f"{rng.uniform(0, 100):.3f}"))
    opening, closing = "[]" if dialect == "eding" else "()"
    if rng.random() < 0.7:
        operator = rng.choice(OPERATORS[dialect])
        return f"{opening}{value(rng, depth - 1, dialect)} {operator} {value(rng, depth - 1, dialect)}{closing}"
    return f"{rng.choice(FUNCTIONS[dialect])}{opening}{value(rng, depth - 1, dialect)}{closing}"


def different(seen: set[str], dialect: str) -> Make:
    def line(rng: random.Random) -> str:
        while True:
            x, y = value(rng, 2, dialect), value(rng, 1, dialect)
            code = rng.randint(0, 3)
            text = f"G{code} X[{x}] Y[{y}]" if dialect == "eding" else f"G{code} X({x}) Y({y})"
            shape = re.sub(r"[0-9]+\.?[0-9]*", "0", text)
            if shape not in seen:
                seen.add(shape)
                return text

    return line


def write(kind: str, lines: int, path: Path) -> None:
    """A program of that many lines; for McuWIN when the file's name ends so (.din)."""
    rng = random.Random(1)
    dialect = "mcuwin" if path.suffix == ".din" else "eding"
    repeating = repeat if dialect == "eding" else repeat_din
    make = {"plain": plain, "repeat": repeating}.get(kind) or different(set(), dialect)
    with path.open("w", encoding="ascii") as file:
        file.writelines(f"{make(rng)}\n" for _ in range(lines))
        file.writelines(["M30\n"] if dialect == "mcuwin" else [])


def load(path: Path) -> None:
    """Load a program, which must have no mistake."""
    from gproof.frontend.eding.load import load_program as load_eding
    from gproof.frontend.mcuwin.load import load_program as load_mcuwin
    from gproof.ir.finding import Findings

    findings = Findings()
    if path.suffix == ".din":
        load_mcuwin(path, findings)
    else:
        load_eding(path, findings)
    found = [finding for finding in findings.kept if not finding.code.name.startswith("program-")]
    assert not found, found


def measure(path: Path) -> dict[str, float]:
    """Processor seconds and peak memory, bytes, of loading a program; kernels and grammar are there before."""
    small = path.with_name(f"small{path.suffix}")
    first = b"x[#1]\n" if path.suffix == ".cnc" else b"X(CD601)\n"
    last = b"\n" if path.suffix == ".cnc" else b"\nM30\n"
    small.write_bytes(first + path.read_bytes()[:500_000].rpartition(b"\n")[0] + last)
    load(small)
    began = time.process_time()
    load(path)
    seconds = time.process_time() - began
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


def figures(dialect: str, kind: str, lines: int) -> dict[str, float]:
    """Lines, seconds of loading them, bytes that a line more costs."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for count in (lines, 2 * lines):
            path = Path(folder) / f"{kind}-{count}{SUFFIX[dialect]}"
            write(kind, count, path)
            command = [sys.executable, __file__, "--child", kind, str(path)]
            said = subprocess.run(command, capture_output=True, check=True)
            found.append(json.loads(said.stdout))
    grown = max(0.0, (found[1]["peak"] - found[0]["peak"]) / lines)
    return {"lines": lines, "seconds": found[0]["seconds"], "bytes_a_line": grown}


def main() -> None:
    if sys.argv[1:2] == ["--child"]:
        kind, path = sys.argv[2], Path(sys.argv[3])
        print(json.dumps(measure_grammar(path) if kind == "grammar" else measure(path)))
        return
    dialect = sys.argv[1] if len(sys.argv) > 1 else "eding"
    print(json.dumps({kind: figures(dialect, kind, LINES[kind]) for kind in KINDS[dialect]}))


if __name__ == "__main__":
    main()
