"""Settings for what the WinCNC manual leaves open: both values of each, and none, worked out by hand.

L Codes: L10; WINCNC.INI Settings: cmdstart=, cmdend=, auxin=, auxout=; M99.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from gproof.cli.main import main

INI = "unit=MM\naxischar=XYZ\n"
INI += "".join(f"axisspec=p0 s{n} d{n} r100 a400 t{n + 1}\naxisvel=r600f150s50m200h450\n" for n in range(3))
INI += "portout=7, 8002\nlolim=X0 Y0 Z-50\nhilim=X400 Y300 Z50\nsoftlim=T1\nauxout=C1 P7 B0\nauxout=C40 P7 B1\n"
HEAD = 'schema = "gproof-machine/1"\nunits = "mm"\nbase = "WINCNC.INI"\n[controls]\n'
Place = tuple[str, int, float, float]


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("CNC.MAC").write_text("")
    return tmp_path


def moves(job: str, controls: str, capsys: pytest.CaptureFixture[str], ini: str = "") -> list[Place]:
    """(file, line, X, Y) of each rapid move."""
    Path("WINCNC.INI").write_text(INI + ini)
    Path("shop.toml").write_text(HEAD + controls)
    Path("job.tap").write_text(job)
    words = ["--machine", "shop.toml", "--setup", "zero", "--stage", "trace", "--format", "jsonl"]
    capsys.readouterr()
    assert main(["dump", "job.tap", *words]) == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    return [
        (row.get("file", "job.tap"), row["line"], row["to"]["x"], row["to"]["y"])
        for row in rows
        if row["op"] == "traverse"
    ]


def check(job: str, controls: str, capsys: pytest.CaptureFixture[str], ini: str = "") -> tuple[str, list[str]]:
    """The verdict, and the codes that are no notes or warnings."""
    Path("WINCNC.INI").write_text(INI + ini)
    Path("shop.toml").write_text(HEAD + controls)
    Path("job.tap").write_text(job)
    capsys.readouterr()
    main(["check", "job.tap", "--machine", "shop.toml", "--setup", "zero", "--format", "json"])
    report = json.loads(capsys.readouterr().out)
    return report["verdict"], [f["code"] for f in report["findings"] if f["severity"] in ("error", "unknown")]


# L10: two rows 50 apart and three columns 10 apart. Each cell goes 1 to the right of its zero.
GRID = "G90\nL10 R2 C3 X10 Y50\nG92 X0 Y0\nG0 X1\n"


@pytest.mark.parametrize(
    ("order", "cells"),
    [
        ("rows", [(0, 0), (10, 0), (20, 0), (0, 50), (10, 50), (20, 50)]),
        ("columns", [(0, 0), (0, 50), (10, 0), (10, 50), (20, 0), (20, 50)]),
    ],
)
def test_the_order_of_a_grid(
    shop: Path, capsys: pytest.CaptureFixture[str], order: str, cells: list[tuple[int, int]]
) -> None:
    expected: list[Place] = []
    for n, (x, y) in enumerate(cells):
        if n:
            expected.append(("job.tap", 2, float(x), float(y)))
        expected.append(("job.tap", 4, x + 1.0, float(y)))
    expected.append(("job.tap", 2, 0.0, 0.0))  # no E: back to where it began
    assert moves(GRID, f'array_order = "{order}"\n', capsys) == expected
    assert check(GRID, f'array_order = "{order}"\n', capsys) == ("SAFE", [])


@pytest.mark.parametrize("order", ["rows", "columns"])
def test_every_cell_of_a_grid_counts(shop: Path, capsys: pytest.CaptureFixture[str], order: str) -> None:
    """The last row begins at 6 * 50 = 300, which is the limit; 1 above it is beyond, and told once."""
    job = "G90\nL10 R7 C2 X10 Y50 E\nG92 X0 Y0\nG0 Y1\n"
    assert check(job, f'array_order = "{order}"\n', capsys) == ("UNSAFE", ["GP301"])


def test_a_grid_without_an_order(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    verdict, codes = check(GRID, "", capsys)
    assert verdict == "UNKNOWN"
    assert codes[0] == "GP113"


def test_a_distance_across_one_row(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Rows are Y apart: with one row there is no second one to go to. Without an order nobody says so."""
    job = "G90\nL10 R1 C2 X10 Y50 E\nG92 X0 Y0\nG0 X1\n"
    expected = [("job.tap", 4, 1.0, 0.0), ("job.tap", 2, 10.0, 0.0), ("job.tap", 4, 11.0, 0.0)]
    for order in ("rows", "columns"):
        assert moves(job, f'array_order = "{order}"\n', capsys) == expected
    assert check(job, "", capsys)[1][0] == "GP113"


CALLS = "G90\nG0 X1\nM98 A.TAP\nG0 X2\n"
AROUND = "cmdstart=M98 S.TAP\ncmdend=G0 Y0\n"


def files() -> None:
    Path("A.TAP").write_text("G0 X5\nM98 B.TAP\nM99\nG0 X399\n")
    Path("B.TAP").write_text("G0 X7\n")
    Path("S.TAP").write_text("G0 Y9\n")


def test_commands_around_each_file(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files()
    start, end = INI.count("\n") + 1, INI.count("\n") + 2
    assert start + 1 == end
    expected = [
        ("S.TAP", 1, 0.0, 9.0),
        ("job.tap", 2, 1.0, 9.0),
        ("S.TAP", 1, 1.0, 9.0),
        ("A.TAP", 1, 5.0, 9.0),
        ("S.TAP", 1, 5.0, 9.0),
        ("B.TAP", 1, 7.0, 9.0),
        ("WINCNC.INI", end, 7.0, 0.0),  # behind B.TAP
        ("WINCNC.INI", end, 7.0, 0.0),  # behind A.TAP, which M99 ends
        ("job.tap", 4, 2.0, 0.0),
        ("WINCNC.INI", end, 2.0, 0.0),
    ]
    found = moves(CALLS, "around_files = true\n", capsys, AROUND)
    assert [m for n, m in enumerate(found) if not n or m[2:] != found[n - 1][2:]] == [
        m for n, m in enumerate(expected) if not n or m[2:] != expected[n - 1][2:]
    ]
    assert check(CALLS, "around_files = true\n", capsys, AROUND) == ("SAFE", [])


def test_commands_around_the_job_only(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files()
    found = moves(CALLS, "around_files = false\n", capsys, AROUND)
    assert [m[2:] for m in found] == [(0.0, 9.0), (1.0, 9.0), (5.0, 9.0), (7.0, 9.0), (2.0, 9.0), (2.0, 0.0)]
    assert check(CALLS, "around_files = false\n", capsys, AROUND) == ("SAFE", [])


def test_commands_around_files_that_nobody_stated(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files()
    assert check(CALLS, "", capsys, AROUND) == ("UNKNOWN", ["GP113"])
    # Outputs may be switched once or often: the axes go nowhere else.
    assert check(CALLS, "", capsys, "cmdstart=M11 C1\ncmdend=M98 OFF.TAP\n")[1] == ["GP130"]
    Path("OFF.TAP").write_text("[off]\nM12 C1\n")
    assert check(CALLS, "", capsys, "cmdstart=M11 C1\ncmdend=M98 OFF.TAP\n") == ("SAFE", [])
    Path("OFF.TAP").write_text("M12 C1\nG91\n")
    assert check(CALLS, "", capsys, "cmdstart=M11 C1\ncmdend=M98 OFF.TAP\n") == ("UNKNOWN", ["GP113"])
    # A job without files has nothing that this could be open for.
    assert check("G90\nG0 X1\n", "", capsys, AROUND) == ("SAFE", [])


def test_a_command_around_each_file_goes_beyond_a_limit(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """G91 of the command behind B.TAP and A.TAP makes X2 of the job 5 + 7 + 2 on from there; 390 more is beyond."""
    Path("A.TAP").write_text("G0 X200\n")
    job = "G90\nM98 A.TAP\nX250\n"
    assert check(job, "around_files = false\n", capsys, "cmdend=G91\n") == ("SAFE", [])
    assert check(job, "around_files = true\n", capsys, "cmdend=G91\n")[0] == "UNSAFE"


@pytest.mark.parametrize(
    ("controls", "channel", "verdict"),
    [
        ("", 40, "SAFE"),
        ("highest_channel = 40\n", 40, "SAFE"),
        ("highest_channel = 32\n", 40, "UNSAFE"),
        ("highest_channel = 32\n", 1, "SAFE"),
        ("", 65, "UNSAFE"),
        ("highest_channel = 200\noutputs = [1, 65]\n", 65, "SAFE"),
    ],
)
def test_the_highest_channel(
    shop: Path, capsys: pytest.CaptureFixture[str], controls: str, channel: int, verdict: str
) -> None:
    found, codes = check(f"G90\nM11 C{channel}\nG0 X1\n", controls, capsys)
    assert (found, codes) == (verdict, [] if verdict == "SAFE" else ["GP128"])


@pytest.mark.parametrize(("controls", "y"), [("", 1.0), ("rotation_sign = 1\n", 1.0), ("rotation_sign = -1\n", -1.0)])
def test_the_sign_of_a_rotation(shop: Path, capsys: pytest.CaptureFixture[str], controls: str, y: float) -> None:
    """From 10, 20, about that place: 1 along X becomes 1 along Y, up or down."""
    job = "G90\nG0 X10 Y20\nG52 I10 J20 A90\nG0 X11 Y20\n"
    found = [(x, round(y, 9)) for _, _, x, y in moves(job, controls, capsys)]
    assert [(round(a, 9), b) for a, b in found] == [(10.0, 20.0), (10.0, 20.0 + y)]


@pytest.mark.parametrize(("controls", "line"), [("", 61), ("virtual_on = 61\n", 61), ("virtual_on = 60\n", 60)])
def test_which_command_switches_a_virtual_input_on(
    shop: Path, capsys: pytest.CaptureFixture[str], controls: str, line: int
) -> None:
    """M17.3: the next line runs only when the virtual input is on."""
    for code in (60, 61):
        job = f"G90\nL{code} C5\nM17.3 C5\nG0 X9\n"
        assert [m[2] for m in moves(job, controls, capsys)] == ([9.0] if code == line else [])
