"""``G51 P`` of Eding CNC: whether it scales Z, and rotary axes, 3.4.13 does not say (``accepts`` can for Z).

Programs with their answers by each reading, worked out on paper before they were run. Axes, limits, zeros as in
test_eding_worked.py: Z stands at -20 between -150 and 0, G55 is at X10 Z-5, tool 2 is 25 mm long.
"""

from __future__ import annotations

import json
import random
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from passes.interpret.core.worked_programs import agree
from passes.interpret.eding.test_worked import MACHINE, SETUP, START
from support.command import in_this_process

from gproof.driver.running import execute
from gproof.frontend.eding.load import load_program
from gproof.ir.dialects.accepts import SCALED_Z, UNSCALED_Z
from gproof.ir.finding import Findings
from gproof.ir.machine import NO_MACHINE, Controller
from gproof.ir.setup import ZERO
from gproof.ir.trace import Op

P2 = "G51 P2 I0 J0\n"
READINGS = (None, SCALED_Z.name, UNSCALED_Z.name)
ANSWERS = {
    # Program: where nothing is stated, where Z is scaled, where it is not.
    P2 + "G0 Z-80": ("!", "UNSAFE", "SAFE . . -80 ."),
    P2 + "G0 X1\nX2 Z-80": ("!", "UNSAFE", "SAFE 4 . -80 ."),
    P2 + "G0 Z-70": ("SAFE . . ? .", "SAFE . . -140 .", "SAFE . . -70 ."),
    P2 + "G0 Z-10\nZ-30\nX5\nZ-40": ("SAFE 10 . ? .", "SAFE 10 . -80 .", "SAFE 10 . -40 ."),
    "G51 P0.5 I0 J0\nG0 Z-160": ("!", "SAFE . . -80 .", "UNSAFE"),
    P2 + "G91 G0 Z-40": ("SAFE . . ? .", "SAFE . . -100 .", "SAFE . . -60 ."),
    P2 + "G91 G0 Z-70": ("!", "UNSAFE", "SAFE . . -90 ."),
    "G55\n" + P2 + "G0 Z-10": ("SAFE . . ? .", "SAFE . . -25 .", "SAFE . . -15 ."),
    "G43 H2\n" + P2 + "G0 Z-30": ("SAFE . . ? .", "SAFE . . -35 .", "SAFE . . -5 ."),
    P2 + "G43 H2\nG0 Z-30": ("SAFE . . ? .", "SAFE . . -35 .", "SAFE . . -5 ."),
    P2 + "G0 Z[#5003-50]": ("!", "SAFE . . -120 .", "SAFE . . -70 ."),
    P2 + "G53 G0 Z-80": ("SAFE . . -80 .", "SAFE . . -80 .", "SAFE . . -80 ."),
    P2 + "G28": ("SAFE 0 0 0 0", "SAFE 0 0 0 0", "SAFE 0 0 0 0"),
    P2 + "G0 Z-30\nG50\nG0 X5": ("SAFE 5 . ? .", "SAFE 5 . -60 .", "SAFE 5 . -30 ."),
    P2 + "G0 Z-30\nG50\nG91 Z-5": ("SAFE . . ? .", "SAFE . . -65 .", "SAFE . . -35 ."),
    P2 + "G50\nG0 Z-80": ("SAFE . . -80 .", "SAFE . . -80 .", "SAFE . . -80 ."),
    "G20\n" + P2 + "G0 Z-1": ("SAFE . . ? .", "SAFE . . -50.8 .", "SAFE . . -25.4 ."),
    P2 + "G2 X15 Y10 I5 J0 Z-30 F100": ("SAFE 30 20 ? .", "SAFE 30 20 -60 .", "SAFE 30 20 -30 ."),
    "G68 R90 X0 Y0\nG51 P2\nG0 Z-70": ("SAFE . . ? .", "SAFE . . -140 .", "SAFE . . -70 ."),
    P2 + "G81 X1 Y2 Z-30 R-15 F100": ("UNKNOWN", "SAFE 2 4 -20 .", "SAFE 2 4 -15 ."),
    P2 + "G99 G81 X1 Y2 Z-30 R-15 F100": ("UNKNOWN", "SAFE 2 4 -30 .", "SAFE 2 4 -15 ."),
    P2 + "G91 G99\nG81 X1 Y0 Z-10 R-5 F100": ("UNKNOWN", "SAFE 12 20 -30 .", "SAFE 12 20 -25 ."),
    P2 + "G81 X1 Y2 Z-80 R-5 F100": ("UNKNOWN", "UNSAFE", "SAFE 2 4 -5 ."),
    P2 + "G82 X1 Y2 Z-80 R-5 P1 F100": ("UNKNOWN", "UNSAFE", "SAFE 2 4 -5 ."),
    P2 + "G83 X1 Y2 Z-30 R-15 Q5 F100": ("UNKNOWN", "UNKNOWN", "SAFE 2 4 -15 ."),
    P2 + "G73 X1 Y2 Z-30 R-15 Q5 F100": ("UNKNOWN", "UNKNOWN", "SAFE 2 4 -15 ."),
    "G51 P-1 I0 J0\nG0 Z-5": ("!", "UNSAFE", "SAFE . . -5 ."),
    "G51 P-1 I0 J0\nG0 Z20": ("!", "SAFE . . -20 .", "UNSAFE"),
    "G51 P-1 I0 J0\nG81 X-1 Y-2 Z-30 R-25 F100": ("UNKNOWN", "UNKNOWN", "SAFE 1 2 -20 ."),
    P2 + "G92 Z0\nG0 Z-1": ("!", "!", "SAFE . . -21 ."),
    P2 + "G10 L20 P1 Z0\nG0 Z-1": ("!", "!", "SAFE . . -21 ."),
    P2 + "G38.2 Z-50 F100\nG50\nG0 Z-1": ("SAFE . . -1 .", "SAFE . . -1 .", "SAFE . . -1 ."),
    P2 + "G38.2 Z-80 F100": ("!", "UNSAFE", "SAFE"),
    "M3 S500\n" + P2 + "G33 Z-30 K1": ("!", "!", "SAFE . . -30 ."),
    "G51 X2 Y2 I0 J0\nG0 Z-80": ("SAFE . . -80 .", "SAFE . . -80 .", "SAFE . . -80 ."),
    P2 + "G51 X2 Y2 I0 J0\nG0 Z-80": ("SAFE . . -80 .", "SAFE . . -80 .", "SAFE . . -80 ."),
    "G51 P1 I0 J0\nG0 Z-80": ("SAFE . . -80 .", "SAFE . . -80 .", "SAFE . . -80 ."),
    "G51 P#110 I0 J0\nG0 Z-20": ("!", "!", "!"),
    "if [#2000>1]\n" + P2 + "endif\nG0 Z-80": ("!", "!", "SAFE"),
    "#1=0\n" + P2 + "while [#1<3]\nG0 Z[-10*#1]\n#1=[#1+1]\nendwhile": (
        "SAFE . . ? .", "SAFE . . -40 .", "SAFE . . -20 ."
    ),
    "#1=0\n" + P2 + "while [#1<3]\nG91 G0 Z-10\n#1=[#1+1]\nendwhile": (
        "SAFE . . ? .", "SAFE . . -80 .", "SAFE . . -50 ."
    ),
    "sub a\nG0 Z-30\nendsub\n" + P2 + "gosub a": ("SAFE . . ? .", "SAFE . . -60 .", "SAFE . . -30 ."),
    # Of rotary axes 3.4.13 has nothing at all, and no entry of a machine file either.
    P2 + "G0 A90": ("SAFE . . . ?",) * 3,
    P2 + "G0 A200": ("!",) * 3,
    P2 + "G91 G0 A200": ("!",) * 3,
    "G51 P0.5 I0 J0\nG0 A500": ("!",) * 3,
    P2 + "G0 X5\nX6 A200": ("!",) * 3,
    P2 + "G92 A5\nG50\nG0 A1": ("!",) * 3,
    P2 + "G0 A[#5004+10]\nG50\nG0 A1": ("SAFE . . . 1",) * 3,
    P2 + "G0 A10\nG0 A[#5004+10]": ("!",) * 3,
    P2 + "G53 G0 A200": ("SAFE . . . 200",) * 3,
    P2 + "G0 A0": ("SAFE . . . 0",) * 3,
    "G51 P1 I0 J0\nG0 A200": ("SAFE . . . 200",) * 3,
    "G51 X2 Y2 I0 J0\nG0 A200": ("SAFE . . . 200",) * 3,
    P2 + "G50\nG0 A200": ("SAFE . . . 200",) * 3,
    "G17\n" + P2 + "G81 X1 Y2 Z-30 R-15 A90 F100": ("UNKNOWN",) * 3,
    "G17\n" + P2 + "G81 X1 Y2 Z-30 R-15 A0 F100": ("UNKNOWN", "SAFE 2 4 -20 0", "SAFE 2 4 -15 0"),
}  # fmt: skip


def machine(entry: str | None) -> str:
    """The machine file of a shop that states a reading, or none."""
    return MACHINE + (f'accepts = ["{entry}"]\n' if entry else "")


@pytest.mark.parametrize("which", range(3), ids=("none", "scaled", "unscaled"))
@pytest.mark.parametrize("program", ANSWERS)
def test_a_program_ends_where_the_reading_sends_it(program: str, which: int, tmp_path: Path) -> None:
    files = {
        "machine.toml": machine(READINGS[which]),
        "setup.toml": SETUP,
        "job.cnc": f"G17 G21 G90 G94 G40 G49 G54 G80 G98\n{program}\nM30\n",
    }
    agree(tmp_path, "job.cnc", files, ANSWERS[program][which], START)


@pytest.mark.parametrize(("which", "answer"), [(0, "!"), (1, "!"), (2, "SAFE . . -80 .")])
def test_equal_factors_of_the_setup_may_be_those_of_p(which: int, answer: str, tmp_path: Path) -> None:
    """Or of ``G51 X Y``, which leaves Z alone: with Z scaled under P it is open which of the two is in force."""
    files = {
        "machine.toml": machine(READINGS[which]),
        "setup.toml": SETUP.replace("factor = 1.0", "factor = 2.0"),
        "job.cnc": "G17 G21 G90 G94 G40 G49 G54 G80 G98\nG0 Z-80\nM30\n",
    }
    agree(tmp_path, "job.cnc", files, answer, START)


@pytest.mark.parametrize("row", [SCALED_Z, UNSCALED_Z], ids=lambda row: row.name)
@pytest.mark.parametrize(
    ("program", "needed"),
    [
        (P2 + "G0 X5 Y6\nG50\nZ-10", False),
        ("G51 X2 Y2 I0 J0\nG0 Z-10", False),
        ("G51 P1 I0 J0\nG0 Z-10", False),
        (P2 + "G53 G0 Z-10", False),
        (P2 + "G0 X5 Z-10", True),
        (P2 + "G0 X5\n" * 5 + "Z-10\n", True),
        (P2 + "G0 X5\nZ-10\nX6\nZ-11\n", True),
        (P2 + "G81 X1 Y2 Z-30 R-15 F100", True),
        (P2 + "#1=-10\nG0 Z#1", True),
    ],
)
def test_the_reading_is_an_assumption_where_z_needed_it(
    row: object, program: str, needed: bool, tmp_path: Path
) -> None:  # fmt: skip
    assert row in (SCALED_Z, UNSCALED_Z)
    (tmp_path / "machine.toml").write_text(machine(row.name))  # type: ignore[attr-defined]
    (tmp_path / "setup.toml").write_text(SETUP)
    (tmp_path / "job.cnc").write_text(f"G17 G21 G90 G94 G40 G49 G54 G80 G98\n{program}\nM30\n")
    words = ["check", "job.cnc", "--machine", "machine.toml", "--setup", "setup.toml", "--format", "json"]
    report = json.loads(in_this_process(words, tmp_path).out)
    assert report["verdict"] == "SAFE"
    assert (row.assumption in report["assumptions"]) is needed  # type: ignore[attr-defined]


def test_both_readings_at_once_are_an_error_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "machine.toml").write_text(MACHINE + 'accepts = ["unscaled-z", "modbus", "scaled_z"]\n')
    (tmp_path / "job.cnc").write_text("G0 X1\nM30\n")
    done = in_this_process(["check", "job.cnc", "--machine", "machine.toml"], tmp_path)
    assert done.exit == 3
    assert "'unscaled-z' and 'scaled-z' cannot both be true" in done.out + done.err


@pytest.mark.parametrize("which", range(3), ids=("none", "scaled", "unscaled"))
def test_a_stream_can_be_made_where_the_reading_is_stated(which: int, tmp_path: Path) -> None:
    text = machine(READINGS[which])
    for axis in "xyza":
        text = text.replace(f"[axes.{axis}]\n", f"[axes.{axis}]\nsteps_per_unit = 100\n")
    (tmp_path / "machine.toml").write_text(text)
    (tmp_path / "setup.toml").write_text(SETUP)
    (tmp_path / "job.cnc").write_text(
        f"G17 G21 G90 G94 G40 G49 G54 G80 G98\n{P2}G0 Z-10\nG1 Z-40 F500\nG2 X15 Y10 I5 J0 Z-45\nG50\nM30\n"
    )
    words = ["job.cnc", "--machine", "machine.toml", "--setup", "setup.toml"]
    done = in_this_process(["compile", *words, "-o", "job.gpx"], tmp_path)
    if READINGS[which] is None:
        assert done.exit == 2 and not (tmp_path / "job.gpx").exists(), done.out + done.err
        return
    assert done.exit == 0, done.out + done.err
    verified = in_this_process(["verify", "job.gpx"], tmp_path)
    assert verified.exit == 0, verified.out + verified.err


@pytest.mark.parametrize("factor", [2.0, 0.5, -1.0])
@pytest.mark.parametrize("seed", range(4))
def test_both_speeds_have_the_same_places(factor: float, seed: int, tmp_path: Path) -> None:
    """A long stretch of plain words against its words one by one; what each word sends Z to is computed here."""
    rng = random.Random(f"uniform {seed} {factor}")
    heights = [round(rng.uniform(-9, 9), 3) for _ in range(200)]
    lines = [rng.choice((f"Z{z}", f"X{n} Z{z}", f"Z{z} Y{n}")) for n, z in enumerate(heights)]
    text = f"G21 G90 G17 G54\nG51 P{factor:g} I0 J0\nG0 X0\n" + "\n".join(lines) + "\nM30\n"
    (tmp_path / "job.cnc").write_text(text)
    for entry, by in ((SCALED_Z.name, factor), (UNSCALED_Z.name, 1.0)):
        findings = Findings()
        program = load_program(tmp_path / "job.cnc", findings)
        assert program is not None
        on = replace(NO_MACHINE, controller=Controller(accepts=(entry,)))
        trace = execute(program, ZERO, on, findings)
        rows = np.concatenate([s.rows["to"][s.rows["op"] < Op.DWELL] for s in trace.sections])
        assert rows[1:, 2].tolist() == [z * by for z in heights], (seed, text)
