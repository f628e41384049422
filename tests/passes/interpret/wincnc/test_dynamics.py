"""WinCNC: what a job says of feeds, accelerations, backlash reaches each answer that it touches, or makes it UNKNOWN.

WinCNC Users Guide: L5 to L9, L40, Feed Rate Override, WINCNC.INI Settings: override=, backlash=, axisspec= B. Numbers
are worked out by hand.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from passes.interpret.wincnc.test_transforms import SETUP, SHOP


def shop(folder: Path, program: str, settings: str = "", backlash: str = "") -> list[str]:
    (folder / "WINCNC.INI").write_text(SHOP.replace("r100a400t1", f"r100a400t1{backlash}") + settings, encoding="ascii")
    (folder / "CNC.MAC").write_text("", encoding="ascii")
    (folder / "setup.toml").write_text(SETUP, encoding="ascii")
    (folder / "job.tap").write_text(program, encoding="ascii")
    return [
        str(folder / "job.tap"), "--machine", str(folder / "WINCNC.INI"), "--setup", str(folder / "setup.toml")
    ]  # fmt: skip


def feeds(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> list[float | None]:
    """Feeds of the rows that cut, mm/min; None: not known."""
    from gproof.cli.main import main

    main(["dump", "--stage", "trace", "--format", "jsonl", *arguments])
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines() if line.startswith("{")]
    return [row.get("feed") for row in rows if row["op"] in ("feed", "arc")]


def answer(arguments: list[str], capsys: pytest.CaptureFixture[str], *also: str) -> dict[str, str]:
    """Answers by property, and the line of the time."""
    from gproof.cli.main import main

    main(["check", *arguments, *(f"--also={name}" for name in also)])
    lines = [line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines() if line.startswith("  ")]
    return {line[0]: line[1].split()[0] if line[0] != "time" else line[1] for line in lines if len(line) == 2}


def compiled(folder: Path, arguments: list[str]) -> int:
    from gproof.cli.main import main

    return main(["compile", *arguments, "-o", str(folder / "job.gpx")])


CUTS = "G1 X1 F100\n{}\nX2\nG2 X4 I1 J0 F100\nG3 X2 I-1 J0\nX3 F200\nG93\nX5 F10\nG94\n"


@pytest.mark.parametrize(
    ("lines", "settings", "expected"),
    [
        # A move of 2 mm in a tenth of a minute goes 20 mm/min.
        ("", "", [100, 100, 100, 100, 200, 20]),
        ("L40 P150", "", [100, 150, 150, 150, 300, 30]),
        ("L40 P50", "override=E1L50H150\n", [100, 50, 50, 50, 100, 10]),
        ("L40 P49", "override=E1L50H150\n", [100, 100, 100, 100, 200, 20]),
        ("L40 P201", "", [100, 100, 100, 100, 200, 20]),
        ("L40 P150\nL40 P100", "", [100, 100, 100, 100, 200, 20]),
        ("L40 P150", "override=E0\n", [100, None, None, None, None, None]),
        ("L40 P100", "override=E0\n", [100, 100, 100, 100, 200, 20]),
        ("L40 P{TP1}", "", [100, None, None, None, None, None]),
        ("L5 X50", "", [100, 100, 100, 100, 200, 20]),
    ],
)
def test_feeds(
    lines: str, settings: str, expected: list[float | None], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = shop(tmp_path, CUTS.format(lines), settings)
    if "{TP1}" in lines:
        (tmp_path / "setup.toml").write_text(SETUP.replace("tool = 0\n", ""), encoding="ascii")
    assert feeds(arguments, capsys) == [None if feed is None else pytest.approx(feed) for feed in expected]


def test_times_and_streams_follow_an_override(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """200 mm at 100 mm/min are two minutes; at half of it four."""
    slow = shop(tmp_path, "L40 P50\nG1 X100 F100\nX0\n")
    assert answer(slow, capsys)["time"].startswith("about 4 min")
    fast = shop(tmp_path, "L40 P100\nG1 X100 F100\nX0\n")
    assert answer(fast, capsys)["time"].startswith("about 2 min")
    assert compiled(tmp_path, slow) == 0


@pytest.mark.parametrize(
    ("lines", "known"), [("L40 P50", False), ("L40 P50\nL40 P100", True), ("L40 P100", True), ("", True)]
)
def test_an_override_where_rapids_may_be_changed(
    lines: str, known: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """rapid_lock=0: whether L40 changes rapids too is not said; with rapid_lock=1, as without it, it does not."""
    for lock, expected in (("rapid_lock=0\n", known), ("rapid_lock=1\n", True)):
        arguments = shop(tmp_path, f"{lines}\nG0 X40\nG1 X0 F1000\n", lock)
        found = answer(arguments, capsys)
        assert found["limits"] == "SAFE"
        assert ("about" in found.get("time", "")) is expected, found
        assert compiled(tmp_path, arguments) == (0 if expected else 2)
        capsys.readouterr()


CHANGED = {
    "L5": "L5 X50", "L6": "L6 X10", "L7": "L7 P50", "L7, then the whole of it": "L7 P50\nL7 P100",
    "L6 after L7": "L7 P50\nL6",
}  # fmt: skip


@pytest.mark.parametrize("what", CHANGED)
def test_velocities_that_the_job_changes(what: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Places stay; times are not told and no stream is made by the machine file's values."""
    arguments = shop(tmp_path, f"{CHANGED[what]}\nG1 X40 F1000\n")
    found = answer(arguments, capsys)
    assert found["limits"] == "SAFE" and "about" not in found.get("time", ""), found
    assert answer(arguments, capsys, "feeds")["feeds"] == ("UNKNOWN" if what == "L5" else "SAFE")
    assert compiled(tmp_path, arguments) == 2
    assert f"{CHANGED[what][:2]} in the job" in capsys.readouterr().out


@pytest.mark.parametrize("lines", ["L7 P100", "L6", "L7", "L7 P50\nL7", "L6 X10\nL6", "L8", "L9", "L8X"])
def test_what_stays_as_in_the_file(lines: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = shop(tmp_path, f"{lines}\nG1 X40 F1000\n")
    assert "about" in answer(arguments, capsys)["time"]
    assert compiled(tmp_path, arguments) == 0


@pytest.mark.parametrize(
    ("lines", "backlash", "settings", "reach", "limits"),
    [
        ("L8X.5", "", "", 99.4, "SAFE"),
        ("L8X.5", "", "", 99.6, "UNKNOWN"),
        ("G20\nL8X.05\nG22", "", "", 99.0, "UNKNOWN"),  # 1.27 mm
        ("L8X.5\nL9", "", "", 99.6, "UNKNOWN"),
        ("L8", "B.5", "backlash=B0\n", 99.6, "UNKNOWN"),
        ("L8Y", "B.5", "backlash=B0\n", 99.6, "UNKNOWN"),
        ("", "B.5", "backlash=B0\n", 99.6, "SAFE"),
        ("", "B.5", "", 99.6, "UNKNOWN"),
        ("L9", "B.5", "", 99.6, "UNKNOWN"),
        ("L9", "B.5", "", 99.4, "SAFE"),
        ("L8X{TP1}", "", "", 5.0, "UNKNOWN"),
    ],
)
def test_backlash_of_the_job_reaches_limits(
    lines: str, backlash: str, settings: str, reach: float, limits: str, tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    arguments = shop(tmp_path, f"{lines}\nG0 X{reach}\n", settings, backlash)
    if "{TP1}" in lines:
        (tmp_path / "setup.toml").write_text(SETUP.replace("tool = 0\n", ""), encoding="ascii")
    assert answer(arguments, capsys)["limits"] == limits
    if lines:
        assert compiled(tmp_path, arguments) == 2
