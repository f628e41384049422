"""Plain lines in the kernel: the same rows, findings and state as line by line."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
from passes.interpret.mcuwin.mcuwin_programs import machine
from support.campaigns import seeds, sizes

from gproof.driver.running import begin, collect
from gproof.frontend.mcuwin.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.program import BlockTable, Repeat
from gproof.ir.setup import ZERO
from gproof.ir.trace import Op, chunks
from gproof.passes.checks.arc_radius import ArcRadius
from gproof.passes.interpret.mcuwin import fast_path as din_plain


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
    ex = begin(program, ZERO, on, findings)
    trace = collect(ex)
    trace.verify()
    rows = [(s.number, *s.rows.rows()) for s in trace.sections]
    return rows, sorted(str(f) for f in findings.kept), ex.modal.own.but(told=frozenset())


@pytest.mark.parametrize("seed", seeds(24, 60))
def test_the_kernel_does_what_the_lines_say(seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "job.src"
    path.write_text(text_of(seed))
    seconds = random.Random(seed).choice([60.0, 60.0, 1.0, None])
    fast = outcome(path, seconds)
    with monkeypatch.context() as patch:
        patch.setattr(din_plain, "is_plain", lambda ex: False)
        slow = outcome(path, seconds)
    assert repr(fast) == repr(slow), path.read_text()


@pytest.mark.parametrize("seed", seeds(8, 20))
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
    trace = collect(begin(program, ZERO, on, Findings()))
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


ARCS = {
    "on its circle": "G02 X4 Y0 I2 J0",
    "within the tolerance": "G02 X4.0009 Y0 I2 J0",
    "at the tolerance": "G02 X4.001 Y0 I2 J0",
    "just off": "G02 X4.0011 Y0 I2 J0",
    "far off": "G03 X4.5 Y0 I2 J0",
    "off, a helix": "G03 X4.5 Y0 Z3 I2 J0",
    "off towards the centre": "G03 X3 Y0 I2 J0",
    "its end is the centre": "G03 X2 Y0 I2 J0",
    "a full circle": "G03 X0 Y0 I2 J0",
    "a full circle without ends": "G03 I2 J0",
    "a full circle of a helix": "G03 Z4 I2 J0",
    "nearly a full circle": "G03 X0.0000001 Y0 I2 J0",
    "nearly a full circle, off": "G03 X0.01 Y0 I2 J0",
    "one axis": "G02 X4 I2 J0",
    "one axis, off": "G02 X4.2 I2 J0",
    "no radius": "G02 X4 Y0 I0 J0",
    "no radius and no end": "G02 I0 J0",
    "hardly a radius": "G02 X0 Y0 I0.0000000001 J0",
    "no centre": "G02 X4 Y0",
    "half a centre": "G02 X4 Y0 I2",
    "half a centre, off": "G02 X4.5 Y0 I2",
    "the other half": "G02 X0 Y4 J2",
    "huge": "G02 X4 Y0 I2 J90000",
    "huge and off": "G02 X4 Y1 I2 J90000",
    "out of its plane": "G02 X4 Y0 I2 K0",
    "a radius word": "G02 X4 Y0 R2",
    "a feed": "G02 X4.5 Y0 I2 J0 F700",
}
AFTER = ("G01 X5 Y5", "G00 X1", "X4 Y0 I2 J0", "G03 X4 Y0 I2 J0", "G91\nG01 X1", "Z1", "G01 X500")


@pytest.mark.parametrize("modes", ["G91", "G90\nG162"])
@pytest.mark.parametrize("kind", ARCS)
@pytest.mark.parametrize("count", sizes(2, len(AFTER)))
def test_arcs_of_every_kind_are_the_same_both_ways(
    count: int, kind: str, modes: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Rows, findings of the run and of ``arcs``, state: whether the kernel takes an arc or a line by itself does."""
    path = tmp_path / "job.src"
    some = random.Random(kind + modes).sample(AFTER, count)
    for after in (*some, "\n".join(AFTER)):
        path.write_text(f"%1\nG90\nG00 X0 Y0 Z0\n{modes}\nG01 F300 X1 Y1\nX0 Y0\n{ARCS[kind]}\n{after}\nM30\n%\n")
        fast = (outcome(path, 60.0), told_by_arcs(path))
        with monkeypatch.context() as patch:
            patch.setattr(din_plain, "is_plain", lambda ex: False)
            slow = (outcome(path, 60.0), told_by_arcs(path))
        assert repr(fast) == repr(slow), path.read_text()
        off = "off" in kind or kind in {"its end is the centre", "a feed"}
        if modes != "G91" and "half" not in kind and kind != "at the tolerance":
            assert bool(fast[1]) is off, path.read_text()


def told_by_arcs(path: Path) -> list[str]:
    """The lines of which ``arcs`` says that no controller takes them."""
    on, findings = machine(time_unit=60.0), Findings()
    program = load_program(path, Findings(), on)
    assert program is not None
    check = ArcRadius(on, ZERO, findings)
    for chunk in chunks(collect(begin(program, ZERO, on, Findings()))):
        check.feed(chunk)
    return sorted(str(f) for f in findings.kept if f.code.number == 401)
