"""Plain lines in the kernel: the same rows, findings and state as line by line."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
from passes.din_programs import machine

from gproof.frontend.mcuwin.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.program import BlockTable, Repeat
from gproof.ir.setup import ZERO
from gproof.ir.trace import Op
from gproof.passes import din_plain
from gproof.passes.execute import Executor, collect


def text_of(seed: int) -> str:
    """Lines of moves, feeds and arcs, also such as the kernel does not take."""
    rand = random.Random(seed)
    lines = ["%1", rand.choice(["G90", "G91"]), "G00 X1 Y1", rand.choice(["F300", "G01 X2 F100", "G71"])]
    for _ in range(rand.randint(5, 40)):
        draw = rand.random()
        words = "".join(f" {a}{rand.choice([-1, 0, 0.5, 2, 7])}" for a in "XYZ" if rand.random() < 0.6)
        if draw < 0.45:
            lines.append(f"{rand.choice(['G00', 'G01', 'G1', ''])}{words or ' X1'}".strip())
        elif draw < 0.75:
            size = rand.choice([1, 2.5])
            code = rand.choice(["G02", "G03"])
            if rand.random() < 0.5:
                lines.append(f"{code} I{size} J0")
            else:
                # Half a circle, in distances.
                lines.append("G91")
                lines.append(f"{code} X{2 * size} Y0 I{size}" + rand.choice([" J0", " J0", ""]))
        elif draw < 0.9:
            lines.append(f"{rand.choice(['G01', 'G00', ''])} F{rand.choice([0, 50, 700])}{words}".strip())
        else:
            lines.append(rand.choice(["G90", "G91", "G17", "M08", "G94"]))
            lines.append(f"G01{words or ' X1'}")
    return "\n".join([*lines, "M30", "%"]) + "\n"


def outcome(
    path: Path, seconds: float | None, *, version: str = "2.5.3.133", tables: bool = True
) -> tuple[list[tuple], list[str], object]:
    on = machine(time_unit=seconds, version=version)
    findings = Findings()
    program = load_program(path, findings, on, tables=tables)
    assert program is not None
    ex = Executor(program, ZERO, on, findings)
    trace = collect(ex)
    trace.verify()
    rows = [(s.number, *s.rows.rows()) for s in trace.sections]
    return rows, sorted(str(f) for f in findings.kept), ex.modal.din.but(told=frozenset())


@pytest.mark.parametrize("seed", range(60))
def test_the_kernel_does_what_the_lines_say(seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "job.src"
    path.write_text(text_of(seed))
    seconds = random.Random(seed).choice([60.0, 60.0, 1.0, None])
    fast = outcome(path, seconds)
    with monkeypatch.context() as patch:
        patch.setattr(din_plain, "is_plain", lambda ex: False)
        slow = outcome(path, seconds)
    assert repr(fast) == repr(slow), path.read_text()


@pytest.mark.parametrize("seed", range(20))
def test_tables_of_the_older_version(seed: int, tmp_path: Path) -> None:
    """Where the order of the source decides between places and distances, tables do what their blocks do."""
    rand = random.Random(seed)
    lines = text_of(seed).splitlines()
    first, last = sorted(rand.sample(range(2, len(lines) - 2), 2))
    lines.insert(last, rand.choice(["$end", "$end\nG91", "$end\nG01 X1\nM98 L5"]))
    lines.insert(first, rand.choice(["G90\n", "G91\n", ""]) + "$for CI600 := 1 to 2 do begin")
    lines += ["%", "L5", "G01 Y2", "X3", rand.choice(["G90", "G91"]), "G01 Y1", "M17", "%"]
    path = tmp_path / "job.src"
    path.write_text("\n".join(lines) + "\n")
    found = [outcome(path, 60.0, version="2.5.3.32", tables=tables) for tables in (True, False)]
    assert repr(found[0]) == repr(found[1]), path.read_text()


def test_tables_of_the_older_version_hold_distances(tmp_path: Path) -> None:
    """The second pass begins behind a G91 that the first one ran, and in the source behind a G90 (14, 2.5.3.78)."""
    path = tmp_path / "job.src"
    lines = ["%1", "G90", "G00 X10", "F300", "CI600 := 0", "$repeat begin", "G01 X5", "CI600 := CI600 + 1", "G01 X7"]
    path.write_text("\n".join([*lines, "G91", "G01 X1", "$end until (CI600 = 2);", "M30", "%", ""]))
    on = machine(version="2.5.3.32")
    program = load_program(path, Findings(), on)
    assert program is not None
    loop = next(node for node in program.body if isinstance(node, Repeat))
    assert [node.distances for node in loop.body if isinstance(node, BlockTable)] == ["G90", "G90", "G91"]
    trace = collect(Executor(program, ZERO, on, Findings()))
    rows = trace.sections[0].rows
    moved = [float(rows["to"][n][0]) for n in range(len(rows)) if rows["op"][n] < Op.DWELL]
    assert moved == [10, 5, 7, 8, 5, 7, 8]


def test_the_kernel_is_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "job.src"
    path.write_text("%1\nG90\nG00 X1\n" + "".join(f"G01 X{n} F300\n" for n in range(2, 600)) + "M30\n%\n")
    made: list[int] = []
    taken = din_plain.taken

    def counted(ex, start, before, *rest):  # type: ignore[no-untyped-def]
        made.append(ex.rows.count - before)
        return taken(ex, start, before, *rest)

    monkeypatch.setattr(din_plain, "taken", counted)
    rows, _, _ = outcome(path, 60.0)
    assert sum(made) > 590
    assert np.isclose(len(rows[0]) - 1, 600, atol=1)
