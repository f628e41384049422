"""Jobs of McuWIN for other controllers: which zero they count from and leave, by the manual of V 2.5.3.133."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.target_machines import machine_like
from support.traps import machine_files

from gproof.driver.translation import Translation, Wanted, translate
from gproof.ir.verdict import Verdict


def translated(folder: Path, text: str, to: str, more: str = "") -> Translation:
    """A program for the machine of the traps, with more lines in its file, on a machine like it."""
    machine = folder / "machine.toml"
    machine.write_text(machine_files("mcuwin")["machine.toml"].decode() + more, encoding="utf-8")
    job = folder / "job.src"
    job.write_text(text, encoding="utf-8")
    machine_to = machine_like(machine, to, folder / to)
    return translate(Wanted(job=job, to=to, machine=machine, machine_to=machine_to, dialect="mcuwin"))


def proven(done: Translation) -> list[str]:
    """The lines of what is proven."""
    assert done.verdict is Verdict.SAFE, [f"{one.span.line}: {one.message}" for one in done.findings.kept]
    return done.files[""].decode().splitlines()


@pytest.mark.parametrize("to", ["eding", "wincnc", "linuxcnc", "grbl"])
def test_a_job_without_a_zero_counts_from_the_one_in_force(to: str, tmp_path: Path) -> None:
    """Nothing takes the zero back before a G53 to G58 [3.18, 3.19]: it is that of G54 at the start, as is printed."""
    done = translated(tmp_path, "%P\nG90\nG00 X10 Y20\nG01 Z-1 F100\nM30\n%\n", to)
    assert any("X10 Y20" in line for line in proven(done))
    assert any("first work offset (G54)" in text for text in done.assumed)


def test_machine_zero_is_left_to_the_next_job(tmp_path: Path) -> None:
    """WinCNC takes the zero back at the end of a file, but for L92 [L Codes: L92]."""
    lines = proven(translated(tmp_path, "%P\nG53\nG90\nG00 X10 Y20 Z5\nG01 Z-1 F100\nM30\n%\n", "wincnc"))
    assert "G92.1 X0 Y0 Z0" in lines and "L92" in lines


C_AXIS = '\n[axes.c]\nkind = "rotary"\nmin = -3600.0\nmax = 3600.0\nposition_unit = "deg"\n'


def test_an_axis_that_does_not_interpolate_keeps_its_zero(tmp_path: Path) -> None:
    """G53 takes the offset of the interpolation axes [3.18]: C counts from where it did, and is left so. #5226 is C of
    G54 (Eding CNC 3.1.1)."""
    for more in ("", " C90"):
        lines = proven(translated(tmp_path, f"%P\nG53\nG90\nG00 X10{more}\nG01 Z-1 F100\nM30\n%\n", "eding", C_AXIS))
        assert any("C[#5226]" in line or "C#5226" in line for line in lines), lines


def test_a_job_may_be_larger_than_its_own_controller_loads(tmp_path: Path) -> None:
    """13.1.1.13: another controller gets it. A McuWIN that does not load it is no target."""
    moves = "".join(f"G01 X{n % 90}.5 Y{n % 70}.25 Z{n % 7}.125 F300\n" for n in range(9000))
    text = f"%P\nG54\nG90\nG00 X10 Y20\n{moves}M30\n%\n"
    done = translated(tmp_path, text, "eding")
    assert len(proven(done)) > 9000
    assert any("does not load so much" in sentence for sentence in done.assumed)
    (tmp_path / "again").mkdir()
    done = translated(tmp_path / "again", text, "mcuwin")
    assert done.verdict is Verdict.UNKNOWN and not done.files
    assert "a program of this length cannot be translated" in done.findings.kept[0].message
