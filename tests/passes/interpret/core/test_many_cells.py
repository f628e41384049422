"""Many cells of an array at once give what they give one by one: rows, findings, counts, in both speeds.

The manual asks for a G92 X Y in each cell; cells without one, or with one elsewhere, are run one by one.
"""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from support.campaigns import seeds

from gproof.driver.running import begin, collect
from gproof.driver.session import Running, open_session
from gproof.ir.text import print_ir
from gproof.passes.interpret.wincnc import part_arrays as arrays
from gproof.passes.interpret.wincnc.state import WinCncRun

INI = """[m]
unit=mm
axischar=XYZ
axisspec=p0 s0 d0 r320 a12000 t1
axisvel=r6000 f1500
axisspec=p0 s1 d1 r320 a12000 t2
axisvel=r6000 f1500
axisspec=p0 s2 d2 r320 a12000 t3
axisvel=r6000 f1500
vgroup=FXYZ
vgroup=XYZ
lolim=x-5000 y-5000 z-5000
hilim=x5000 y5000 z5000
softlim=t1
arc_err=.01
"""


def told(folder: Path, text: str, budget: int | None) -> tuple[str, list[str], object]:
    job, ini = folder / "job.tap", folder / "WINCNC.INI"
    job.write_text(text)
    ini.write_text(INI)
    session = open_session(job, machine=ini, setup="zero", dialect="wincnc")
    assert session.program is not None
    findings = session.findings
    ex = begin(session.program, session.setup, session.machine, findings, **session.options(Running(budget)))
    trace = collect(ex)
    beside = findings.counts, ex.blocks, list(ex.assumed), ex.refused, ex.modal.absolute, repr(ex.modal.own)
    return print_ir(trace), sorted(f"{f.span} {f}" for f in findings.kept), beside


def both(folder: Path, text: str, monkeypatch: pytest.MonkeyPatch, budget: int | None = None) -> int:
    """How many cells were run with others."""
    many = 0
    run = arrays._many_cells

    def counted(ex: WinCncRun, cells_of: arrays.PlainCells, frame: arrays.Frame, cells: arrays.Cells) -> None:
        nonlocal many
        before = frame.cell
        run(ex, cells_of, frame, cells)
        many += frame.cell - before

    answers = []
    for mode in ("python", "numba"):
        with monkeypatch.context() as patch:
            patch.setenv("GPROOF_KERNELS", mode)
            patch.setattr(arrays, "_many_cells", counted)
            answers.append(told(folder, text, budget))
    with monkeypatch.context() as patch:
        patch.setenv("GPROOF_KERNELS", "python")
        patch.setattr(arrays, "FEW_CELLS", 1 << 40)
        answers.append(told(folder, text, budget))
    assert answers[0] == answers[1] == answers[2], text
    return many


HEAD = "G90\nG0 X1 Y1\nG0 Z2\nF100\n"
SQUARE = "G91\nG1 Z-1 F50\nG1 X0.1\nY0.1\nX-0.1\nG1 Z1\nG90\n"


G92 = "G92 X0 Y0\n"


@pytest.mark.parametrize(
    ("text", "is_many"),
    [
        (f"{HEAD}L10 R500 C1 X0 Y3\n{G92}{SQUARE}", True),
        (f"{HEAD}L10 R1 C500 X3 Y0 E\nG92XY\n{SQUARE}", True),
        (f"{HEAD}L10 R500 C1 X0 Y3\n{G92}G91 G1 X0.1 F20\nG90 G1 Z1\n", True),
        (f"{HEAD}G91\nL10 R500 C1 X0 Y0\n{G92}X{{1/8}}\n", True),
        (f"{HEAD}L10 R500 C1 X0 Y0\n{G92}G1 Z1\nG1 Z2\n", True),  # the axes are there
        (f"{HEAD}L10 R500 C1 X0 Y3\n{G92}G91\nG2 X1 Y0 I0.5 J0\nG90\n", True),
        (f"{HEAD}L10 R500 C1 X0 Y3\n{G92}G91\nG2 X1 Y0 I0.7 J0\nG90\n", False),  # no circle
        (f"{HEAD}L10 R500 C1 X0 Y30\n{G92}{SQUARE}", True),  # beyond the limits
        (f"{HEAD}L10 R60 C1 X0 Y3\n{G92}G4 X1\n{SQUARE}", False),
        (f"{HEAD}L10 R500 C1 X0 Y3\nG92 X1 Y-2 Z5\nG1 X3 F50\nG1 Z4\nG1 X1 Y-1\n", True),
        (f"{HEAD}G92.1 X5 Z3\nG20\nL10 R500 C1 X0 Y0.1\nG92 Y.1 X.2\nG1 X.3 F50\nZ.1\n", True),
        (f"{HEAD}M37 Z1\nL10 R500 C1 X0 Y.1\nG92 XYZ\nG1 X.3 F50\nZ.1\nG1 Z0\n", True),
        (f"{HEAD}L10 R60 C1 X0 Y3\n{SQUARE}", False),  # without its G92
        (f"{HEAD}L10 R60 C1 X0 Y3\nG92 X\n{SQUARE}", False),
        (f"{HEAD}L10 R60 C1 X0 Y3\nG1 Z1\n{G92}{SQUARE}", False),
        (f"{HEAD}L10 R60 C1 X0 Y3\n{G92}{SQUARE}G92\n", False),
        (f"{HEAD}L10 R60 C1 X0 Y3\nG51 Z2 K0\n{G92}{SQUARE}", False),
        (f"{HEAD}L10 R60 C1 X0 Y3\n{G92}F50\nG1 X\nZ{{2}}\n", True),
    ],
)
def test_cells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, is_many: bool) -> None:
    many = both(tmp_path, text, monkeypatch)
    assert (many > 0) is is_many
    both(tmp_path, text, monkeypatch, 333)


@pytest.mark.parametrize("seed", seeds(5, 300))
def test_random(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    rng = random.Random(seed)
    lines = []
    for _ in range(rng.randrange(1, 7)):
        words = [f"{axis}{rng.choice([f'{rng.uniform(-2, 2):.2f}', '0', '1'])}" for axis in rng.sample("XYZ", 2)]
        code = rng.choice(["G1", "G0", "G2", "", "", "G90", "G91", "G91 G1", "G90 G0", "F"])
        arc = f"I{words[0][1:]} J0" if code == "G2" else ""
        feed = rng.choice(["", "", f"F{rng.randrange(10, 90)}", "F0" if rng.random() < 0.1 else ""])
        lines.append(rng.choice([f"{code} {words[0]} {words[1]} {arc} {feed}", f"{code} {words[0]} {feed}", "F75"]))
    shape = rng.choice(["R1 C90 X3 Y0", "R200 C1 X0 Y-0.5 E", "R1 C30 X0 Y0"])
    zero = rng.choice(("G92 X Y", "G92 X1 Y.5", "G92 Z2 Y X-1", "G92XY[cell]", "G92 X"))
    text = "\n".join([HEAD + f"L10 {shape}", zero, *lines, ""])
    both(tmp_path, text, monkeypatch, rng.choice((None, 300)))
