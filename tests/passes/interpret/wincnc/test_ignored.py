"""What WinCNC ignores without a message (GP200), and values that its commands do not take (WinCNC manual, by heading).

Expected lines and codes are read off the manual: L300 ("any motion commanded to a locked axis will be ignored"), L40
(bounds of override=, 1 to 200 percent by Feed Rate Override), the ranges beside each command's letters.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.command import in_this_process

INI = "unit=MM\ntimertype=7200\naxischar=XYZW\n" + "".join(
    f"axisspec=p0 s{n} d{n} r80 a30000 t{min(n + 1, 3)}\naxisvel=r6000 f2000\n" for n in range(4)
)
LIMITS = "lolim=X0 Y0 Z-100 W-100\nhilim=X500 Y500 Z0 W0\nsoftlim=T1\nnmode=90\nauxin=c1 p2 b2\nauxout=c1 p7 b1 o0\n"
STATE = """schema = "gproof-setup/1"
units = "mm"
homed = ["x", "y", "z", "w"]
active_work = 1
tool = 1
start = {x = 50.0, y = 50.0, z = -10.0, w = -10.0}
g92 = {x = 0.0, y = 0.0, z = 0.0, w = 0.0}
measures = {z = 0.0, w = 0.0}
"""


def told(folder: Path, text: str, ini: str = "", also: str = "sense", top: str = INI) -> list[tuple[str, int]]:
    """(code, line) of the findings of a job; the stops for an operator are left out."""
    (folder / "WINCNC.INI").write_text(top + LIMITS + ini, encoding="ascii")
    (folder / "CNC.MAC").write_text("", encoding="ascii")
    (folder / "setup.toml").write_text(STATE, encoding="ascii")
    (folder / "job.tap").write_text(text, encoding="ascii")
    words = ["check", "job.tap", "--machine", "WINCNC.INI", "--setup", "setup.toml", "--format", "json", "--also", also]
    found = json.loads(in_this_process(words, folder).out)["findings"]
    return [(f["code"], f["line"]) for f in found if f["code"] != "GP243"]


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("L300 Z\nG0 Z-5\nG0 Z-2\nG0 X60\n", [3]),  # once for each lock
        ("L300 Z\nG0 Z-5\nL301 Z\nG0 Z-5\nL300 Z\nG0 Z-2\n", [3, 7]),
        ("L300 ZW\nG0 X60 W-5\nG0 Z-2\nG0 W-1 Z-1\n", [3, 4]),  # ... and for each axis
        ("L300 Z\nG0 X60 Z-10\nG1 X70 F500\n", []),  # it is there already
        ("L300 Z\nG53\n", [3]),  # G53 alone lifts the heads
        ("L300 Z\nG0.1 X60\n", [3]),  # so does G0.1
        ("L300 Y\nG81 X60 Y60 Z-20 R-5 F100\n", [3]),
        ("L300 Z\nG81 X60 Y50 Z-20 R-5 F100\n", [3]),
        ("L300 W\nL13 ZW\nG0 Z-5\n", [4]),  # a follower that is locked
        ("L300 W\nL301 W\nG0 W-5\n", []),
    ],
)
def test_moves_of_locked_axes(text: str, lines: list[int], tmp_path: Path) -> None:
    assert [line for code, line in told(tmp_path, f"G90\n{text}") if code == "GP200"] == lines


@pytest.mark.parametrize(
    ("percent", "ini", "ignored"),
    [
        ("200", "", False), ("201", "", True), ("1", "", False), (".5", "", True),
        ("49", "override=E1 L50 H150\n", True), ("150", "override=E1 L50 H150\n", False),
        ("150.5", "override=E1 L50 H150\n", True),
    ],
)  # fmt: skip
def test_an_override_out_of_range(percent: str, ini: str, ignored: bool, tmp_path: Path) -> None:
    found = told(tmp_path, f"G90\nL40 P{percent}\nG1 X60 F500\n", ini)
    assert found == ([("GP200", 2)] if ignored else [])


DEVICES = "laser=P50\nda=T1 V10 I0\nautoaux=C1\n"


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("L51 P100", ""), ("L51 P101", "GP128"), ("L51 V-1", "GP128"), ("L51 V5 S100", "GP283"), ("L51 V5", ""),
        ("L34 D-1", "GP128"), ("L35 D.5", ""), ("G1 L100 X60 F500", ""), ("G1 L101 X60 F500", "GP128"),
        ("L500 P1 L1", ""), ("L500 P1 L2", "GP128"), ("L501 P-1", "GP128"), ("L500.2 T1 N-3", "GP128"),
        ("M17.1 C1 D1\nG0 X60", ""), ("M17.1 C1 D2\nG0 X60", "GP128"), ("M18.1 C1 D.5\nG0 X60", "GP128"),
        ("L111 T1.5\nG0 X60", "GP229"), ("L111 T1\nG0 X60", ""), ("G95 F-5", "GP128"),
    ],
)  # fmt: skip
def test_values_that_a_command_does_not_take(line: str, code: str, tmp_path: Path) -> None:
    assert [one for one, _ in told(tmp_path, f"G90\n{line}\n", DEVICES)] == ([code] if code else [])


@pytest.mark.parametrize(
    ("line", "found"),
    [("M17.4 C1", True), ("M18.4 C0", True), ("M17.4 C{TP1}", False), ("M17.1 C1", False), ("L113 L1 H5 V3", True),
     ("L113 L1 H5 V{TP1}", False)],
)  # fmt: skip
def test_conditions_that_always_hold(line: str, found: bool, tmp_path: Path) -> None:
    assert (("GP158", 2) in told(tmp_path, f"G90\n{line}\nG0 X60\n")) is found


def test_units_that_no_file_states(tmp_path: Path) -> None:
    """unit= of WINCNC.INI says it; without it the Units menu (manual, Unit Settings), or the job."""
    assert told(tmp_path, "G90\nG0 X10\n") == []
    bare = INI.removeprefix("unit=MM\n")
    assert told(tmp_path, "G90\nG0 X10\n", top=bare) == [("GP150", 2)]
    assert told(tmp_path, "G22\nG90\nG0 X60\n", top=bare) == []


HEADS = "auxout=c2 p7 b2 o0\nspindle=T1 R18000\ng54=X0 Y0 T0\ng55=X-80 Y0 T0 M0\n"


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("G1 Z-20 F300\nG0 Z0\n", 0),
        ("G1 W-20 F300\nG0 W0\n", 5),  # W goes down, whatever G54 selects
        ("L12 WZ\nG1 Z-20 F300\nG0 Z0\n", 6),  # the words of Z move W
        ("G55\nG0 X200\nG1 X220 F300\n", 7),  # W is selected
        ("G55\nG54\nG0 X60\nG1 X90 F300\n", 0),
    ],
)
def test_the_spindle_of_another_head(text: str, line: int, tmp_path: Path) -> None:
    """M3 runs the spindle of Z: that of W turns or not (manual: G54, G55, Head Swap)."""
    definitions = "M3=M11C1\nM5=M12C1\n"
    job = f"G90\nS9000\nM3\nG0 X60\n{text}M5\n"
    told(tmp_path, job, HEADS)
    (tmp_path / "CNC.MAC").write_text(definitions, encoding="ascii")
    top = 'schema = "gproof-machine/1"\nunits = "mm"\nbase = "WINCNC.INI"\n[controls]\nshift_sign = 1\n'
    for stated, expected in (("", [line] if line else []), ("[spindles.1]\noutput = 1\n", [])):
        (tmp_path / "m.toml").write_text(top + stated, encoding="ascii")
        words = ["check", "job.tap", "--machine", "m.toml", "--setup", "setup.toml", "--format", "json"]
        found = json.loads(in_this_process([*words, "--also", "cutting"], tmp_path).out)["findings"]
        assert [f["line"] for f in found if f["code"] == "GP531"] == expected
        assert "GP530" not in {f["code"] for f in found}
