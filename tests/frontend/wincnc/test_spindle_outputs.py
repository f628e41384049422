"""What CNC.MAC tells of the spindle: the outputs that its M3 and M4 switch on and its M5 off.

What each definition leaves switched is read off it by hand (manual: Macro File Configuration; M11 to M14; M17; M99).
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from gproof.frontend.wincnc.load import load_program
from gproof.frontend.wincnc.machine import NO_SHOP
from gproof.ir.dialects.wincnc.settings import WinCncSettings
from gproof.ir.finding import Findings
from gproof.ir.program import SpindleOutputs

SPIN = "M11C1   [spindle]\n\nM17C5   [until it has its speed]\n"


def outputs(folder: Path, definitions: str, controls: WinCncSettings | None = None, **files: str) -> SpindleOutputs:
    (folder / "CNC.MAC").write_text(definitions, encoding="ascii")
    for name, text in files.items():
        (folder / f"{name}.MAC").write_text(text, encoding="ascii")
    (folder / "job.tap").write_text("G0 X1\n", encoding="ascii")
    machine = dataclasses.replace(NO_SHOP, settings=controls or WinCncSettings())
    program = load_program(folder / "job.tap", Findings(), machine)
    assert program is not None
    assert not program.subprograms  # what the job does not call is no part of it
    named = {Path(file.name).name for file in program.files}
    assert {"job.tap", "CNC.MAC"} <= named
    return program.spindle_outputs


@pytest.mark.parametrize(
    ("definitions", "forward", "backward"),
    [
        ("M3=M11C1\nM5=M12C1\n", (1,), ()),
        ("M03 = M13 C2 [SPINDLE ON]\nM05=M14C2\n", (2,), ()),
        ("M3=M98 SPIN.MAC [SPINDLE ON]\nM5=M12C1\n", (1,), ()),
        ('M3=M98 "spin.mac"\nM5=M98 OFF.MAC\n', (1,), ()),
        ("M3=M98 TWO.MAC\nM5=M98 OFF.MAC\n", (1, 7), ()),
        # The dust collector stays on behind M5: it is not what M5 stops.
        ("M3=M98 TWO.MAC\nM5=M12C1\n", (1,), ()),
        # The other direction by an output of its own, by one more, or by the same.
        ("M3=M11C1\nM4=M11C2\nM5=M98 OFF2.MAC\n", (1,), (2,)),
        ("M3=M11C1\nM4=M98 TWO.MAC\nM5=M98 OFF.MAC\n", (1,), (1, 7)),
        ("M3=M11C1\nM4=M11C1\nM5=M12C1\n", (1,), (1,)),
        ("M3=M11C1\nM4=[\nM5=M12C1\n", (1,), ()),
        # Definitions within definitions; what the last one leaves counts.
        ("M100=M11C3\nM3=M100\nM5=M12C3\n", (3,), ()),
        ("M3=M98 AGAIN.MAC\nM5=M12C1\n", (1,), ()),
        # Behind M99 nothing of a file runs.
        ("M3=M98 ENDS.MAC\nM5=M98 OFF.MAC\n", (1,), ()),
        # Nothing switches it off, or on, or both is left to something else.
        ("M3=M11C1\n", (), ()),
        ("M3=M11C1\nM5=[\n", (), ()),
        ("M3=[\nM5=M12C1\n", (), ()),
        ("M3=M11C1\nM5=M12C2\n", (), ()),
        ("M5=M12C1\n", (), ()),
        # A pulse leaves nothing on; conditions, braces, an abort and a file that is not there leave it open.
        ("M3=M98 PULSE.MAC\nM5=M12C1\n", (), ()),
        ("M3=M98 ASKS.MAC\nM5=M12C1\n", (), ()),
        ("M3=M98 BRACES.MAC\nM5=M12C1\n", (), ()),
        ("M3=M98 ABORTS.MAC\nM5=M12C1\n", (), ()),
        ("M3=M98 GONE.MAC\nM5=M12C1\n", (), ()),
        ("M3=M98 ITSELF.MAC\nM5=M12C1\n", (), ()),
        ("M3=M98 LONG.MAC\nM5=M12C1\n", (), ()),
        ("M3=M11C1\nM4=M98 ASKS.MAC\nM5=M12C1\n", (), ()),
    ],
)
def test_definitions(definitions: str, forward: tuple[int, ...], backward: tuple[int, ...], tmp_path: Path) -> None:
    files = {
        "SPIN": SPIN, "OFF": "M12C1\nM12C7\n", "OFF2": "M12C1\nM12C2\n", "TWO": "M11C1\nG4 X.5\nM11C7\n",
        "AGAIN": "M11C1\nM12C1\nG4 X1\nM11C1\n", "ENDS": "M11C1\nM99\nM12C1\n", "PULSE": "M11C1\nG4 X.2\nM12C1\n",
        "ASKS": "M17.1 D0 C3\nM11C1\nM11C1\n", "BRACES": "M11C{c}\n", "ABORTS": "M11C1\nM99.1\n",
        "ITSELF": "M11C1\nM98 ITSELF.MAC\n", "LONG": "M11C1\n" * 201,
    }  # fmt: skip
    assert outputs(tmp_path, definitions, **files) == SpindleOutputs(forward, backward)


@pytest.mark.parametrize("device", ["thc", "laser", "knife", "saw", "bevel", "pump"])
def test_another_tool_may_be_what_m3_starts(device: str, tmp_path: Path) -> None:
    assert outputs(tmp_path, "M3=M11C1\nM5=M12C1\n", WinCncSettings(devices=("spindle", device))) == SpindleOutputs()


def test_the_output_of_feed_moves_is_no_spindle(tmp_path: Path) -> None:
    controls = WinCncSettings(devices=("autoaux",), auto_output=1)
    assert outputs(tmp_path, "M3=M11C1\nM5=M12C1\n", controls) == SpindleOutputs()


def test_two_files_of_one_name(tmp_path: Path) -> None:
    """Which of them is meant nobody says, unless they are the same."""
    shop, jobs = tmp_path / "shop", tmp_path / "jobs"
    for folder in (shop, jobs):
        folder.mkdir()
        (folder / "SPIN.MAC").write_text(SPIN, encoding="ascii")
    (shop / "CNC.MAC").write_text("M3=M98 SPIN.MAC\nM5=M12C1\n", encoding="ascii")
    (jobs / "job.tap").write_text("G0 X1\n", encoding="ascii")
    for text, found in ((SPIN, SpindleOutputs((1,))), ("M11C2\n", SpindleOutputs())):
        (jobs / "SPIN.MAC").write_text(text, encoding="ascii")
        program = load_program(jobs / "job.tap", Findings(), NO_SHOP, shop / "WINCNC.INI")
        assert program is not None
        assert program.spindle_outputs == found
        assert (shop / "SPIN.MAC" in {Path(f.name) for f in program.files}) == (found != SpindleOutputs()) or (
            jobs / "SPIN.MAC" in {Path(f.name) for f in program.files}
        )
