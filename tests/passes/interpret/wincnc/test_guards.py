"""Guards and locks that a WinCNC machine's file or a bare command leaves open: never SAFE by them."""

from __future__ import annotations

from pathlib import Path

import pytest

from gproof.driver.judge import judge
from gproof.driver.session import Running, open_session
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


TWO_HEADS = INI.replace("axischar=XYZ", "axischar=XYZW").replace(
    "lolim=X0 Y0 Z-100\nhilim=X500 Y500 Z0\n",
    "axisspec=p0 s3 d3 r100 a100 t3\naxisvel=r3000 f1000\nlolim=X0 Y0 Z-100 W-100\nhilim=X500 Y500 Z0 W0\n",
)


@pytest.mark.parametrize(
    "move",
    [
        "L13 XW\nG2 I50 J0 F500",  # W goes up by 100 where X does
        "L13 ZW\nG81 X150 Y100 Z-60 R-1 F500",  # W follows the drill, to -100 and beyond
        "L13 XW\nL10 R1 C3 X50 Y0\nG92 X Y\nL10",  # the way between the cells
        "L13 XW\nG0 X200",
    ],
)
def test_what_follows_another_axis_follows_every_move(
    tmp_path: Path, move: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(globals(), "INI", TWO_HEADS)
    assert answer(tmp_path, f"G90\nG0 X100 Y100 W-45\n{move}\nL13\n")[0] is not Verdict.SAFE


def test_what_follows_within_its_travel_is_safe(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(globals(), "INI", TWO_HEADS)
    found, codes = answer(tmp_path, "G90\nG0 X100 Y100 Z-5 W-45\nL13 ZW\nG81 X150 Y100 Z-40 R-5 F500\nG80\nL13\n")
    assert (found, codes & {"GP301", "GP113"}) == (Verdict.SAFE, set())


OPEN_ARCS = {
    "K": "G2 X20 Y0 I10 J0 K1 F600\n",
    "one word left out": "G2 X20 Y0 I10 J0 F600\nG2 X10 Y10 J10\n",
    "other unit": "G2 X20 Y0 I10 J0 F600\nG20\nG22\n",
}


@pytest.mark.parametrize("text", OPEN_ARCS.values(), ids=OPEN_ARCS)
def test_an_open_arc_makes_no_error_of_the_next(tmp_path: Path, text: str) -> None:
    """What is not known of one arc is not known of those that go on with its centre, and no more than that."""
    assert answer(tmp_path, f"G90\n{text}G2 X40 Y0\nG2 X60 Y0\n")[0] is Verdict.UNKNOWN


@pytest.mark.parametrize("text", ["G2 X20 Y0 I10 J0 F600\n", "G2 X20 Y0 R10 F600\nG2 X40 Y0 I10 J0\n"])
def test_an_arc_from_anywhere_makes_no_error_of_the_next(tmp_path: Path, text: str) -> None:
    (tmp_path / "WINCNC.INI").write_text(INI.format(softlim=1))
    (tmp_path / "CNC.MAC").write_text("")
    (tmp_path / "setup.toml").write_text(
        'schema = "gproof-setup/1"\nunits = "mm"\nhomed = ["x", "y", "z"]\n[start]\nx = [0.0, 1.0]\ny = 50.0\nz = 0.0\n'
    )
    job = tmp_path / "job.tap"
    job.write_text(f"G90\n{text}G2 X40 Y0\n")
    session = open_session(
        job, machine=tmp_path / "WINCNC.INI", setup=str(tmp_path / "setup.toml"), dialect=None
    )  # fmt: skip
    found = judge(session, running=Running())
    assert not [f for f in found.findings.kept if f.code.label in {"GP203", "GP401"}], found.findings.kept


@pytest.mark.parametrize("code", ["M3 S1000", "M6", "G200 X1", "L77"])
def test_codes_of_a_macro_file_that_was_not_given(tmp_path: Path, code: str) -> None:
    """Without CNC.MAC nobody knows what it would define: not an error, and nobody knows where the axes are then."""
    job = tmp_path / "job.tap"
    job.write_text(f"G90\nG0 X1\n{code}\nG91\nG0 X1\n")
    session = open_session(job, machine=None, setup="zero", dialect="wincnc")
    found = judge(session, running=Running())
    assert found.verdict is Verdict.UNKNOWN
    assert "GP112" not in {finding.code.label for finding in found.findings.kept}
    assert any("CNC.MAC" in finding.hint for finding in found.findings.kept)
    assert answer(tmp_path, f"G90\n{code}\n")[1] >= {"GP112"}


BEHIND_R = [
    # J left out after R: 10, that of the arc before, or 0, or that of R's own centre
    ("G2 X0 Y20 I0 J10\nG2 X10 Y20 R20\nG2 I5\n", "GP405"),
    ("G2 X0 Y20 I0 J10\nG2 X10 Y20 R20\nG2 J5\n", "GP405"),
    # the circle about I and J before R, or about the centre that R had
    ("G2 X0 Y20 I0 J10\nG2 X10 Y20 R20\nG2\n", "GP405"),
    ("G2 X10 Y0 R20\nG3\n", "GP405"),
    ("G2 X10 Y0 R20\nG3 I5\n", "GP405"),
    # with both words nothing is open
    ("G2 X0 Y20 I0 J10\nG2 X10 Y20 R20\nG2 I5 J0\n", ""),
    ("G2 X0 Y20 I0 J10\nG2 X10 Y20 R20\nG2 I5 J0\nG2\n", ""),
    ("G2 X10 Y0 R20\nG3 X0 Y0 R20\n", ""),
]


@pytest.mark.parametrize(("text", "code"), BEHIND_R)
@pytest.mark.parametrize("between", ["", "[not a plain line]\nG4 X0.1\n"])
def test_i_and_j_after_a_radius_are_not_taken_to_be_zero(tmp_path: Path, text: str, code: str, between: str) -> None:
    """G2, G3: "previous I J values are kept" says nothing of an arc by R between them."""
    lines = text.splitlines()
    job = "\n".join([*lines[:-1], *between.splitlines(), lines[-1]])
    verdict, found = answer(tmp_path, f"G90\nG92\nG0 X100 Y100 Z-10\nG92 X0 Y0\n{job}\n")
    assert (verdict, found & {"GP405", "GP203"}) == (
        Verdict.UNKNOWN if code else Verdict.SAFE,
        {code} if code else set(),
    )


@pytest.mark.parametrize("modal", [0, 1])
@pytest.mark.parametrize("code", ["G0 X5", "G1 X5", "G2 I5 J0", "G3 I5 J0"])
def test_a_stored_place_is_gone_to_whatever_is_modal(tmp_path: Path, code: str, modal: int) -> None:
    """P#: "Move to the selected stored position"; g2modal= makes arcs modal, for lines with words of axes."""
    (tmp_path / "WINCNC.INI").write_text(INI.format(softlim=1) + f"g2modal={modal}\n")
    (tmp_path / "CNC.MAC").write_text("")
    (tmp_path / "setup.toml").write_text(
        'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\nstart = {x = 50.0, y = 50.0, z = -10.0}\n'
        "g92 = {x = 0.0, y = 0.0, z = 0.0}\nmeasures = {z = 0.0}\n"
        "positions.P1 = {x = 1.0, y = 2.0, z = -3.0, lift = false}\n"
        "positions.P2 = {x = 501.0, y = 2.0, z = -3.0, lift = false}\n"
    )
    for number, verdict in ((1, Verdict.SAFE), (2, Verdict.UNSAFE)):
        job = tmp_path / "job.tap"
        job.write_text(f"G90\nG0 X20 Y20\n{code}\nP{number}\nG0 X1\n")
        setup = str(tmp_path / "setup.toml")
        session = open_session(job, machine=tmp_path / "WINCNC.INI", setup=setup, dialect=None)
        found = judge(session, running=Running())
        assert found.verdict is verdict, found.findings.kept
        assert {f.code.label for f in found.findings.kept if f.severity.value == "error"} <= {"GP301", "GP303"}


@pytest.mark.parametrize("plain", ["", "G4 X0.1\n"])
def test_an_arc_after_moves_that_are_clear_begins_where_they_end(tmp_path: Path, plain: str) -> None:
    """Z rests on an unknown measure; the arc bulges to X36.65 at Y-17.76, over the zone, the rest is clear."""
    (tmp_path / "WINCNC.INI").write_text(INI.format(softlim=1).replace("X0 Y0", "X-100 Y-100"))
    (tmp_path / "CNC.MAC").write_text("")
    (tmp_path / "setup.toml").write_text(
        'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\nstart = {x = -0.09, y = 1.859, z = -13.59}\n'
        "g92 = {x = 0.0, y = 18.584, z = 0.0}\nactive_work = 1\ntool = 0\n"
        '[[keep_out]]\nname = "zone"\nx = [32.27, 53.89]\ny = [-12.75, 6.61]\nz = [-9.67, -1.85]\n'
    )
    job = tmp_path / "job.tap"
    path = "G0 X1.8392 Y-1.69 Z-0.8035\nG92 X Y\nG1 X-0.1702 Y-3.2008\n"
    job.write_text(f"G21\nG90\n{plain}{path}G3 X-0.87786 Y-2.41963 I0.60237 J1.2568\n")
    session = open_session(job, machine=tmp_path / "WINCNC.INI", setup=str(tmp_path / "setup.toml"), dialect=None)
    found = judge(session, running=Running())
    areas = next(one for one in found.properties if one.name == "areas")
    assert areas.verdict is not Verdict.SAFE or areas.conditions
