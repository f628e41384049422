"""A feed that is kept over a change of the unit: no manual says whether the number or the length stays.

A trace of Eding has the speed that it was (as RS274NGC has it), and states that it was given in another unit.

Eding CNC manual 3.4.7; WinCNC Users Guide, G20 to G23; McuWIN 3.21, 3.28, 5.3 ask for another F (GP204).
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from reach.witness import m
from reach.worlds import EDING, MCUWIN, WINCNC, World, answered

from gproof.cli.main import main

CASES = [
    (EDING, "cnc", "G21 G1 X1 F100; G20; G1 X0.1", [100.0, 100.0]),
    (EDING, "cnc", "G21 G1 X1 F100; G20; G1 X0.1 F10", [100.0, 254.0]),
    (EDING, "cnc", "G21 G1 X1 F100; G20; G21; G1 X2", [100.0, 100.0]),
    (EDING, "cnc", "G20 F10; G1 X1; F10; X2", [10.0, 254.0]),
    (EDING, "cnc", "G20 F10; F10; G1 X2", [254.0]),
    (WINCNC, "tap", "G20; G1 X1 Y1 F10; G22; G1 X2; G1 X3 F20; X4", [254.0, None, 20.0, 20.0]),
    (WINCNC, "tap", "G20; G1 X1 Y1 F10; G22; G1 X2; G23; G1 X3", [254.0, None, 254.0]),
    (WINCNC, "tap", "G20; G1 X1 Y1 F10; G22; G1 X2 F20; G23; G1 X3; G23; X4", [254.0, 20.0, None, 20.0]),
    # In braces a line is none of a table.
    (WINCNC, "tap", "G20; G1 X{1} Y1 F10; X{1+1}; G2 X{3} Y1 I.5 J0 F{10}", [254.0, 254.0, 254.0]),
    (MCUWIN, "src", "G90 G71 F300; CD600 := 5; G01 X(CD600); M30", [300.0]),
    (MCUWIN, "src", "G90 G70 F10; CD600 := 1; G01 X(CD600); M30", [254.0]),
    (WINCNC, "tap", "G20; G2 X1 Y1 I1 J0 F10; G22; G2 X50.8 Y25.4 I12.7 J0", [254.0, None]),
]


@pytest.mark.parametrize(("world", "ending", "program", "expected"), CASES)
def test_feeds_are_lengths_of_their_unit(
    world: World, ending: str, program: str, expected: list[float | None], tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    from corpus.jobs import CORPUS

    job = tmp_path / f"job.{ending}"
    job.write_text(program.replace("; ", "\n") + "\n")
    main(
        [
            "dump",
            "--stage",
            "trace",
            "--format",
            "jsonl",
            str(job),
            "--machine",
            str(CORPUS / world.machine),
            "--setup",
            "zero",
        ]
    )
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines() if line.startswith("{")]
    feeds = [row.get("feed") for row in rows if row["op"] in ("feed", "arc")]
    assert feeds == [None if feed is None else pytest.approx(feed) for feed in expected]


def test_feeds_of_another_unit_are_not_judged(tmp_path: Path) -> None:
    """254 mm/min or 10: below or above what the tool stands."""
    world = EDING.but(*m(("machine.tools.0.max_feed", 1.0)))
    known = answered(world, "G20\nG43 H1 G1 X1 F1\nG1 X2\nM30\n", tmp_path, ())
    kept = answered(world, "G21 F10\nG20\nG43 H1 G1 X1\nG1 X2\nM30\n", tmp_path, ())
    assert known["feeds"].startswith("SAFE") and kept["feeds"].startswith("UNKNOWN")
    assert kept["limits"] == known["limits"] and kept["plan"].startswith("none")


def test_mcuwin_asks_for_another(tmp_path: Path) -> None:
    found = answered(MCUWIN, "G90 G71\nG01 X10 F300\nG70\nG01 X1\nM30\n", tmp_path, ())
    assert "GP204" in found["language"] + found["feeds"]
