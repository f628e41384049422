"""``--rapids straight``: a straight rapid of several axes becomes a feed move where the target has no straight ones.

Eding CNC: G0 is straight (3.4.1); McuWIN: each axis has its own velocity (3.1); WinCNC: the manual does not say (G0).
The machines of the traps: X and Y 100 mm/s, Z 50 mm/s, so 6000 and 3000 mm/min.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from support.target_machines import machine_like
from support.traps import machine_files

from gproof.driver.translation import Translation, Wanted, translate
from gproof.ir.verdict import Verdict

MODES = "G17 G21 G90 G94 G40 G49 G80 G54\n"
BODY = "G0 Z5\nG0 X0 Y0\nG1 Z-1 F100\nG1 X10\nG0 Z5\nG0 X20 Y20 Z6\nG1 Z-1\nG0 Z5\nG0 X0\nM30\n"
LINES = {
    "wincnc": ["G0 Z5", "G1 X0 Y0 F6000", "Z-1 F100", "X10 F100", "G0 Z5", "G1 X20 Y20 Z6 F3000", "Z-1 F100", "G0 Z5",
               "X0"],
    "mcuwin": ["G00 Z5", "G01 X0 Y0 F6000", "Z-1 F100", "X10", "G00 Z5", "G01 X20 Y20 Z6 F3000", "Z-1 F100", "G00 Z5",
               "X0"],
}  # fmt: skip


def translated(
    folder: Path, text: str, to: str, dialect: str = "eding", more: str = "", *, straight: bool = True
) -> Translation:
    """A program for the machine of the traps; more: lines of the source's machine file."""
    for name, data in machine_files(dialect).items():
        (folder / name).write_bytes(data)
    machine = folder / ("WINCNC.INI" if dialect == "wincnc" else "machine.toml")
    machine.write_bytes(machine.read_bytes() + more.encode())
    job = folder / {"eding": "job.cnc", "wincnc": "job.tap", "mcuwin": "job.din"}[dialect]
    job.write_text(text)
    to_files = machine_files(to) if to in ("wincnc", "mcuwin", "eding") else {}
    (folder / "to").mkdir(exist_ok=True)
    for name, data in to_files.items():
        (folder / "to" / name).write_bytes(data)
    machine_to = folder / "to" / ("WINCNC.INI" if to == "wincnc" else "machine.toml")
    if not to_files:
        machine_to = machine_like(machine, to, folder / "to")
    return translate(
        Wanted(
            job=job, to=to, machine=machine, machine_to=machine_to, dialect=dialect, straight_rapids=straight
        )
    )  # fmt: skip


@pytest.mark.parametrize("to", ["wincnc", "mcuwin"])
def test_it_is_a_feed_move_at_the_rate_of_its_axes(to: str, tmp_path: Path) -> None:
    done = translated(tmp_path, MODES + BODY, to)
    assert done.verdict is Verdict.SAFE, [one.message for one in done.findings.kept]
    text = done.files[""].decode().splitlines()
    first = text.index(LINES[to][0])
    assert [line.strip() for line in text[first : first + len(LINES[to])]] == LINES[to]
    assert [one.pattern for one in done.lowered].count("straight rapid -> feed move") >= 1
    assert not any("same path" in one for one in done.assumed)
    assert any("override for feeds" in one for one in done.assumed)


@pytest.mark.parametrize("to", ["eding", "linuxcnc", "grbl"])
def test_it_stays_where_it_is_straight_there_too(to: str, tmp_path: Path) -> None:
    done = translated(tmp_path, MODES + BODY, to)
    assert done.verdict is Verdict.SAFE, [one.message for one in done.findings.kept]
    assert b"F6000" not in done.files[""]
    assert not any("same path" in one for one in done.assumed)


def test_without_the_option_the_path_is_assumed(tmp_path: Path) -> None:
    done = translated(tmp_path, MODES + BODY, "wincnc", straight=False)
    assert done.verdict is Verdict.SAFE and b"\nX0 Y0\n" in done.files[""]
    assert any("same path" in one for one in done.assumed)


def test_a_rapid_that_is_not_straight_itself_is_refused_by_name(tmp_path: Path) -> None:
    """Of WinCNC nobody knows which way it goes: no move is the same."""
    done = translated(tmp_path, "G22\nG90\nG0 Z5\nG0 X10 Y20\nG1 Z-1 F100\n", "eding", "wincnc")
    assert done.verdict is Verdict.UNKNOWN and not done.files
    (finding,) = done.findings.kept
    assert finding.code.label == "GP703" and finding.span.line == 4 and "one axis at a time" in finding.message
    one = translated(tmp_path, "G22\nG90\nG0 Z5\nG0 X10\nG0 Y20\nG1 Z-1 F100\n", "eding", "wincnc")
    assert one.verdict is Verdict.SAFE, [one.message for one in one.findings.kept]


def test_what_a_machine_file_says_of_rapids_counts(tmp_path: Path) -> None:
    """Eding CNC whose machine file says that its rapids are not straight."""
    done = translated(tmp_path, MODES + BODY, "wincnc", more="straight_traverse = false\n")
    assert not done.files and "one axis at a time" in done.findings.kept[0].message
