"""Plain lines of one command: the kernel, in Python and compiled, against the Python path alone, bit for bit."""

from __future__ import annotations

import dataclasses
import math
import random
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from support.campaigns import examples, seeds

from gproof.driver.running import begin, collect
from gproof.frontend.wincnc.load import load_program
from gproof.frontend.wincnc.machine import NO_SHOP
from gproof.ir.dialects.wincnc.settings import WinCncSettings
from gproof.ir.finding import Findings
from gproof.ir.machine import Axis, AxisKind, Controller, Machine
from gproof.ir.program import FLAG_BARE
from gproof.ir.settings import Workspace
from gproof.ir.setup import NOTHING, ZERO, Setup
from gproof.ir.text import print_ir
from gproof.passes.interpret.core.run import Run
from gproof.passes.interpret.wincnc import fast_path as single_plain
from gproof.passes.interpret.wincnc import line_kernels as k
from gproof.passes.interpret.wincnc.semantics import WinCncDialect

RANDOM = examples(60, 1000, suppress_health_check=list(HealthCheck))
CONSTANT = ("rules", "setup", "machine", "ranges")


def state_of(ex: Run) -> list[str]:
    """Everything a line may change, every bit of it."""
    modal = [f"{name}: {value!r}" for name, value in sorted(vars(ex.modal).items()) if name not in CONSTANT]
    return [*modal, repr((ex.blocks, list(ex.assumed), ex.moves, ex.moved, ex.refused))]


def everything(text: str, machine: Machine, setup: Setup) -> list[str]:
    """Trace, final state and findings of a job."""
    findings = Findings()
    with tempfile.TemporaryDirectory() as folder:
        job = Path(folder) / "job.tap"
        job.write_text(text)
        program = load_program(job, findings, machine)
        assert program is not None
        ex = begin(program, setup, machine, findings)
        trace = collect(ex)
    trace.verify()
    rows = [section.rows[name].tobytes().hex() for section in trace.sections for name in section.rows.arrays]
    found = [finding.message.replace(folder, "") for finding in findings.kept]
    return [*rows, print_ir(trace).replace(folder, ""), *(text.replace(folder, "") for text in state_of(ex)), *found]


def three_ways(text: str, machine: Machine, setup: Setup) -> tuple[list[str], list[str], list[str]]:
    """The same with the kernel in Python, compiled, and without it."""
    ways = []
    for mode in ("python", "numba"):
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("GPROOF_KERNELS", mode)
            ways.append(everything(text, machine, setup))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(single_plain, "is_plain", lambda s: False)
        patch.setenv("GPROOF_KERNELS", "python")
        ways.append(everything(text, machine, setup))
    return ways[0], ways[1], ways[2]


def assert_same(text: str, machine: Machine, setup: Setup = ZERO) -> None:
    plain, compiled, slow = three_ways(text, machine, setup)
    for way in (plain, compiled):
        different = [pair for pair in zip(way, slow, strict=True) if pair[0] != pair[1]]
        assert not different, f"{text}\n{machine}"


LINEAR, ROTARY = AxisKind.LINEAR, AxisKind.ROTARY


@st.composite
def machines(draw: st.DrawFn) -> Machine:
    kinds = draw(st.sampled_from(["", "W", "WA", "AC", "AWC", "WAC", "WUV"]))
    velocities = st.sampled_from([None, 10.0, 25.4, 100.0 / 60.0])
    low = draw(st.sampled_from([None, None, -20.0]))
    axes = [Axis(name=name, kind=LINEAR, feed_velocity=draw(velocities), boundary_lower=low) for name in "xyz"]
    for name, letter in zip("abc", kinds, strict=False):
        kind = ROTARY if letter in "AC" else LINEAR
        axes.append(Axis(name=name, kind=kind, letter=letter, feed_velocity=draw(velocities)))
    if draw(st.integers(0, 5)) == 0:
        axes.pop(2)
    groups = [("xy",), ("xy", "z"), ("xyz",), (), ("xy", "zab"), ("x", "y", "z", "a", "b", "c")]
    controls = WinCncSettings(
        feed_groups=draw(st.sampled_from(groups)),
        command_group=draw(st.sampled_from(["", "xy", "xyz", "z", "xa"])),
        arcs_modal=draw(st.booleans()),
        helical_arcs=draw(st.integers(0, 4)) > 0,
        arcs_share_feed=draw(st.sampled_from([None, True, False])),
        smallest_arc=draw(st.sampled_from([None, 0.0, 0.254, 3.0])),
        absolute=draw(st.sampled_from([None, True, False])),
        workspaces=(Workspace(number=55, x=12.5, y=-3.0),),
        shift_sign=draw(st.sampled_from([None, 1, -1])),
        arc_tolerance=draw(st.sampled_from([None, 0.01, 100.0])),
        auto_output=draw(st.sampled_from([None, None, 3])),
        auto_output_on=draw(st.booleans()),
        adjust_boundary=draw(st.integers(0, 4)) == 0,
        adjust_vertical=draw(st.integers(0, 4)) == 0,
    )
    absolute = draw(st.integers(0, 4)) == 0
    return dataclasses.replace(
        NO_SHOP,
        axes=tuple(axes),
        controller=Controller(dialect="wincnc", absolute_arc_centers=absolute),
        settings=controls,
        unit=draw(st.sampled_from([1.0, 10.0, 25.4])),
    )


NUMBERS = st.one_of(
    st.sampled_from(["", "0", "-0", "1", "2", "-1", "1.5", ".5", "-.25", "0.1", "3", "0.0000000005", "1000000000001"]),
    st.decimals(-50, 50, places=3).map(str).filter(lambda text: "E" not in text),
)  # fmt: skip
CENTERS = st.sampled_from(["I1J0", "I0J1", "I-1 J0", "I.5J.5", "I2 J-1", "I0J0", "I1", "J-2", "I1J0K0", "I1J1K1"])
RADII = st.sampled_from(["R1", "R5", "R100", "R-5", "R0", "R1.5"])


@st.composite
def plain_lines(draw: st.DrawFn) -> str:
    code = draw(st.sampled_from(["", "", "", "G0", "G1", "G01", "g1 ", "G2", "G3", "G2", "G3"]))
    letters = draw(st.lists(st.sampled_from("XXXYYYZZWACU"), max_size=4))
    if draw(st.integers(0, 9)):
        letters = list(dict.fromkeys(letters))
    words = [letter + draw(NUMBERS) for letter in letters]
    if code[-1:] in ("2", "3") or draw(st.integers(0, 12)) == 0:
        words.append(draw(st.one_of(CENTERS, CENTERS, RADII, st.just(""))))
    if draw(st.integers(0, 3)) == 0:
        feed = "F" + draw(st.sampled_from(["100", "60.5", "", "0", "-5", "1200", "100"]))
        words.insert(draw(st.integers(0, len(words))), feed)
    words.insert(draw(st.sampled_from([0, 0, 0, len(words)])), code)
    return draw(st.sampled_from(["", " "])).join(words) + draw(st.sampled_from(["", "", " [a]", " % b"]))


OTHERS = st.sampled_from([
    "G90", "G91", "G20", "G21", "G22", "G54", "G55", "G92", "G92 X1 Y2", "G92Z0", "L90 G1 X5", "L91 G1 Y1", "G53 Z0",
    "G53", "G93", "G94", "G28 Z", "L11 XY", "L13 ZW", "L300 Z", "L301 Z", "L300 X", "G52 A30", "G51 I2J2", "G50", "G43",
    "G49", "P3", "G0 H2", "S1000", "G81 X1 Y1 Z-1 R1", "X2 Y3", "G80", "G28X", "L28 X5", "M37 Z1", "L4", "G91 G1 X-1",
    "G90 G0 X0 Y0", "M28 G1 Z-5 G91", "G4X1",
    "L34", "L35", "G51 I2", "G51 K.5", "G23", "G81", "L11",
])  # fmt: skip
LINES = st.one_of(plain_lines(), plain_lines(), plain_lines(), plain_lines(), plain_lines(), OTHERS)
JOBS = st.lists(LINES, min_size=1, max_size=25).map(lambda lines: "".join(f"{line}\n" for line in lines))


@RANDOM
@given(JOBS, machines(), st.sampled_from([ZERO, ZERO, NOTHING]))
def test_kernel_and_python_path_agree_bit_for_bit(text: str, machine: Machine, setup: Setup) -> None:
    assert_same(text, machine, setup)


SHOP = dataclasses.replace(
    NO_SHOP, unit=1.0,
    controller=Controller(dialect="wincnc"), settings=WinCncSettings(feed_groups=("xy", "z"), smallest_arc=0.254),
)  # fmt: skip


@pytest.mark.parametrize(
    "text",
    [
        "G91\nF100\nG1 X1\nG2 X.0000004 Y0 I1 J0\nX1\n",
        "G91\nF100\nG1 X1\nG2 X.0000004 Y0 I1 J0 C1\nX1\n",
        "F100\nG1 X1\nG2 X1 Y1 R5\nG2 X2 Y1\nX1\n",
        "F100\nG1 X1\nG2 I5 J0\nG3\nG2 F50\nX1\n",
        "G0 X1 F100\nG1\nF50 G0\nX1 Y\nX Y Z\n",
    ],
)
def test_small_jobs_agree_bit_for_bit(text: str) -> None:
    assert_same(text, SHOP)


def number(rng: random.Random, reach: float) -> str:
    if rng.random() < 0.1:
        return rng.choice(["", "0", "-0", "1", ".0000000004", "-.0000000003"])
    return f"{rng.uniform(-reach, reach):.{rng.randint(0, 5)}f}"


def good_line(rng: random.Random, letters: list[str]) -> str:
    """A line that most often is what a program may have."""
    kind = rng.random()
    words = [letter + number(rng, 40) for letter in letters if rng.random() < 0.5]
    feed = [f"F{rng.choice([100, 250.5, 1200, 100])}"] if rng.random() < 0.2 else []
    if kind < 0.05:
        return feed[0] if feed else "F77"
    if kind < 0.5:
        return " ".join([*rng.choice([[], ["G1"], ["G1"], ["G0"]]), *words, *feed])
    if kind < 0.65:
        return " ".join(["G1", rng.choice(letters) + ".0000000002", letters[-1] + number(rng, 9), *feed])
    code = rng.choice(["G2", "G3"])
    center = f"I{number(rng, 20)} J{number(rng, 20)}"
    if kind < 0.75:
        center = f"R{rng.uniform(1, 90):.2f}"
    elif kind < 0.8:
        center = ""
    elif kind < 0.85:
        words = [word for word in words if word[0] not in "XY"]
    return " ".join([code, *words, center, *feed])


@pytest.mark.parametrize("seed", seeds(4, 12))
def test_long_jobs_agree_bit_for_bit(seed: int) -> None:
    rng = random.Random(9000 + seed)
    for _ in range(4):
        more = rng.choice(["", "W", "WA", "AC", "AWC", "WAC"])
        axes = [Axis(name=name, kind=LINEAR, feed_velocity=rng.choice([10.0, None])) for name in "xyz"]
        for name, letter in zip("abc", more, strict=False):
            kind = ROTARY if letter in "AC" else LINEAR
            axes.append(Axis(name=name, kind=kind, letter=letter, feed_velocity=rng.choice([8.0, None])))
        controls = WinCncSettings(
            feed_groups=rng.choice([("xy",), ("xy", "z"), ("xyz",), ("xy", "za")]),
            command_group=rng.choice(["", "xyz"]),
            arcs_modal=rng.random() < 0.3, helical_arcs=rng.random() < 0.9,
            arcs_share_feed=rng.choice([None, True, False]), smallest_arc=rng.choice([None, 0.254, 9.0]),
            absolute=True, arc_tolerance=rng.choice([1e4, 1e4, None]),
        )  # fmt: skip
        machine = dataclasses.replace(
            NO_SHOP, axes=tuple(axes), unit=rng.choice([1.0, 25.4]),
            controller=Controller(dialect="wincnc", absolute_arc_centers=rng.random() < 0.2),
        settings=controls,
        )  # fmt: skip
        lines = [rng.choice(["G90", "G91"]), "G92 X1 Y-2 Z.5", "F300 Z", "F100 X"]
        letters = [axis.word for axis in axes]
        lines += [good_line(rng, letters) for _ in range(80)]
        for _ in range(4):
            other = rng.choice(["G90", "G91", "G20", "G22", "G92", "L91 G1 X1", "G54", "G93", "G94", "G0 X0 Y0 Z0"])
            lines.insert(rng.randint(4, 40), other)
        assert_same("\n".join(lines) + "\n", machine)


def test_the_kernel_runs_long_jobs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every line but the modes goes through the kernel, and more rows than a buffer has."""
    lines = ["G90", "F1000", "G0X0Y0"]
    for n in range(3600):
        lines += [
            f"G1 X{n / 7:.4f} Y{n % 50}",
            f"Y{n % 40}.5 Z-{n % 3}",
            f"G3 X{n / 7 + 1:.4f} Y{n % 40}.5 I.5 J.1",
            "F900",
        ]
    text = "\n".join(lines)
    assert_same(text, SHOP)
    cold = []
    monkeypatch.setattr(
        "gproof.passes.interpret.wincnc.line.run_line", lambda ex, span, *a, **b: cold.append(span.line)
    )
    everything(text.removeprefix("G90\n"), SHOP, ZERO)
    assert cold == []


def refused(text: str, **changes: Any) -> list[str]:
    """The state before and behind a call of the kernel with the words of one line, and how many rows it made."""
    findings = Findings()
    machine = dataclasses.replace(SHOP, **changes)
    with tempfile.TemporaryDirectory() as folder:
        job = Path(folder) / "job.tap"
        job.write_text("G1 X1 Y1 F100\nG3 X2 Y2 R5 F200\nG2 X3 Y3 I.5 J.5\nG1 Z1\n")
        program = load_program(job, findings, machine)
        assert program is not None
        ex = begin(program, ZERO, machine, findings)
        collect(ex)
        before = state_of(ex)
        words = program.scan(text.encode(), 0, len(text), 1, 1000)[0] if program.scan else None
    assert words is not None
    columns = tuple(words[name].tolist() for name in ("line", "letter", "value", "flags"))
    manner = ex.dialect
    assert isinstance(manner, WinCncDialect)
    assert manner.plain is not None
    rows = ex.rows.count
    at = manner.plain.run(ex, k.run_moves.python, columns, len(words), 0, False)
    assert (at, ex.rows.count) == (0, rows)
    after = state_of(ex)
    compiled = tuple(words[name] for name in ("line", "letter", "value", "flags"))
    assert manner.plain.run(ex, k.run_moves.compiled(), compiled, len(words), 0, True) == 0
    assert state_of(ex) == after
    assert not any(ex.rows.arrays[name][rows:].any() for name in ex.rows.arrays)
    assert before == after
    return after


@pytest.mark.parametrize(
    "line",
    [
        "G1 X1 X2",
        "G1 X1 G2",
        "G1 U5",
        "F-1 X5",
        "G1 X5 F0",
        "G1 X5 F",
        "F0",
        "F100 X Y",
        "X1 I2",
        "G0 R3",
        "G2 X5 Y5 I1 F300",
        "G2 X5 Y5 J1 F300",
        "G2 X5 Y5 R1 F300",
        "G2 R1",
        "G2 X5 Y5 R-9",
        "G2 X5 Y5 R9 I1",
        "G2 X5 Y5 I0 J0 F100",
        "G2 X5 Y5 I1 J1 K1",
        "G1 X2000000000000",
    ],
)
def test_a_line_that_is_handed_back_leaves_no_trace(line: str) -> None:
    refused(line)


def test_a_forgotten_helix_is_handed_back() -> None:
    controls = WinCncSettings(helical_arcs=False)
    refused("G2 X5 Z2 I1 J1 F50", controller=Controller(dialect="wincnc"), settings=controls)


def test_feed_of_the_axes_that_move() -> None:
    """Feedrates: of linear axes; else of all; where they differ nobody knows."""
    feeds = [10.0, 10.0, 20.0, math.nan, 5.0, 5.0]
    for way in (k.agreed.python, k.agreed.compiled()):
        numbers: Any = feeds if way is k.agreed.python else np.array(feeds)
        assert way(numbers, 0, 0b000011, 0b001111) == 10.0
        assert math.isnan(way(numbers, 0, 0b000111, 0b001111))
        assert way(numbers, 0, 0b010100, 0b001111) == 20.0
        assert way(numbers, 0, 0b110000, 0b001111) == 5.0
        assert math.isnan(way(numbers, 0, 0b001000, 0b001111))
        assert math.isnan(way(numbers, 0, 0, 0b001111))


def test_bare_axes_behind_a_feed_are_told_apart(tmp_path: Path) -> None:
    """ "F100 X Y" gives a feed to X and Y; whether it moves them to 0 besides, the manual leaves open."""
    findings = Findings()
    job = tmp_path / "job.tap"
    job.write_text("G1 X5 Y5 F50\nF100 X Y\n")
    program = load_program(job, findings, SHOP)
    assert program is not None
    words = program.body[0].words  # type: ignore[union-attr]
    assert words is not None
    assert (words["flags"] & FLAG_BARE).tolist() == [0, 0, 0, 0, 0, 4, 4]  # type: ignore[call-overload]
    collect(begin(program, ZERO, SHOP, findings))
    assert [finding.span.line for finding in findings.kept if finding.code.label == "GP113"] == [2]
