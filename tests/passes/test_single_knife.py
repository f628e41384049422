"""L30 with a knife that an output lifts: its axis points along the path, worked out by hand."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from gproof.cli.jsonl import chunk_lines
from gproof.cli.session import open_session
from gproof.ir.finding import Severity
from gproof.passes.execute import Executor
from gproof.passes.knife import follow_knife

INI = """unit=MM
axischar=XYZC
axisspec=p0 s0 d0 r100 a100 t1
axisvel=r6000 f3000
axisspec=p0 s1 d1 r100 a100 t2
axisvel=r6000 f3000
axisspec=p0 s2 d2 r100 a100 t3
axisvel=r3000 f1000
axisspec=p0 s3 d3 r10 a100 t4
axisvel=r9000 f9000
portout=7,0300
auxout=c2 p7 b6
knifemode=t0 a20 l{blend} n3 {lift} m1
"""


def places(tmp_path: Path, text: str, blend: str = "0", lift: str = "c2") -> tuple[list[tuple], set[str]]:
    (tmp_path / "WINCNC.INI").write_text(INI.format(blend=blend, lift=lift))
    (tmp_path / "CNC.MAC").write_text("")
    job = tmp_path / "job.tap"
    job.write_text(text)
    session = open_session(job, machine=tmp_path / "WINCNC.INI", setup="zero", dialect=None)
    assert session.program is not None
    ex = Executor(session.program, session.setup, session.machine, session.findings)
    found = []
    for chunk in follow_knife(ex.run(), session.machine, session.findings):
        for line in chunk_lines(chunk, session.machine, str(job)):
            row = json.loads(line)
            if "to" in row:
                found.append(tuple(round(row["to"][name], 6) for name in "xyc"))
    bad = (Severity.ERROR, Severity.UNKNOWN)
    return found, {f.code.label for f in session.findings.kept if f.severity in bad}


def test_the_knife_points_along_the_path(tmp_path: Path) -> None:
    found, findings = places(tmp_path, "G90\nL30\nG0 X10 Y10\nG1 X20\nY30\nG3 X10 Y40 I-10 J0\nL31\nG1 X0\n")
    assert findings == set()
    # Along +X at 0; then up Y: a quarter turn at the corner; the arc turns it by another quarter; L31 leaves it there.
    ends = [(10, 10, 0), (20, 10, 0), (20, 30, 90), (10, 40, 180), (0, 40, 180)]
    assert [row for row in dict.fromkeys(found) if row in ends] == ends
    assert (20, 10, 90) in found


@pytest.mark.parametrize(("blend", "lift"), [("2", "c2"), ("0", "z5 p-1")])
def test_other_knives_are_unknown(tmp_path: Path, blend: str, lift: str) -> None:
    assert "GP113" in places(tmp_path, "G90\nL30\nG1 X20\n", blend, lift)[1]
