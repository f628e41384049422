"""Guards and locks that a WinCNC machine's file or a bare command leaves open: never SAFE by them."""

from __future__ import annotations

from pathlib import Path

import pytest

from gproof.cli.judge import judge
from gproof.cli.session import Running, open_session
from gproof.ir.verdict import Verdict

INI = """unit=MM
axischar=XYZ
axisspec=p0 s0 d0 r100 a100 t1
axisvel=r6000 f3000
axisspec=p0 s1 d1 r100 a100 t2
axisvel=r6000 f3000
axisspec=p0 s2 d2 r100 a100 t3
axisvel=r3000 f1000
lolim=X0 Y0 Z-100
hilim=X500 Y500 Z0
softlim=T{softlim}
"""


def answer(tmp_path: Path, text: str, softlim: int = 1) -> tuple[Verdict, set[str]]:
    (tmp_path / "WINCNC.INI").write_text(INI.format(softlim=softlim))
    (tmp_path / "CNC.MAC").write_text("")
    job = tmp_path / "job.tap"
    job.write_text(text)
    session = open_session(job, machine=tmp_path / "WINCNC.INI", setup="zero", dialect=None)
    found = judge(session, running=Running())
    return found.verdict, {finding.code.label for finding in found.findings.kept}


@pytest.mark.parametrize(
    ("softlim", "verdict", "code"), [(0, "UNKNOWN", "GP307"), (1, "UNSAFE", "GP301"), (2, "UNKNOWN", "GP307")]
)
def test_a_crossing_is_told_whatever_softlim_says(tmp_path: Path, softlim: int, verdict: str, code: str) -> None:
    found, codes = answer(tmp_path, "G90\nG0 X501\n", softlim)
    assert (found.value, code in codes) == (verdict, True)
    assert answer(tmp_path, "G90\nG0 X500\n", softlim)[0] is not Verdict.UNSAFE


def test_enabled_but_inactive_can_be_switched_on(tmp_path: Path) -> None:
    assert answer(tmp_path, "G90\nL20\nG0 X501\n", 2)[0] is Verdict.UNSAFE


@pytest.mark.parametrize("text", ["L300\nG0 X600\n", "L300 X\nL301\nG0 X600\n"])
def test_a_lock_without_axes_proves_nothing(tmp_path: Path, text: str) -> None:
    assert answer(tmp_path, f"G90\n{text}")[0] is not Verdict.SAFE


def test_a_locked_axis_stays(tmp_path: Path) -> None:
    assert answer(tmp_path, "G90\nL300 X\nG0 X600 Y100\nL301 X\nG0 X400\n")[0] is Verdict.SAFE
    assert answer(tmp_path, "G90\nL300 X\nL301 X\nG0 X600\n")[0] is Verdict.UNSAFE
