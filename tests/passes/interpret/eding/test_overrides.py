"""M48 to M53 against the Eding CNC manual 3.5.5: places stay, feeds are told only where they are known."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from passes.interpret.core.programs import HEAD, codes_of, run_whole, shown

from gproof.ir.trace import Op


def feeds(folder: Path, before: str) -> tuple[list[float | str | None], list[str]]:
    """Feeds of a straight job behind some lines, in both speeds of execution; codes."""
    lines = "".join(f"X{k}\n" for k in range(2, 8))
    trace, findings = run_whole(folder, f"{HEAD}S500 M3\nG1 X1 F100\n{before}\nG1 Y1 F100\n{lines}G0 Z1\nM5\n")
    found = [row[4] for row in shown(trace) if row[0] == "feed"]
    assert [row[1] for row in shown(trace) if row[0] == "feed"] == [1, 1, 2, 3, 4, 5, 6, 7]
    return found, codes_of(findings)


@pytest.mark.parametrize("line", ["M48", "M49", "M53", "M53 P0", "M53 P1", "M52 P0", "M50 P-1", "M51 P-1", "M51 P50"])
def test_feeds_stay_as_programmed(tmp_path: Path, line: str) -> None:
    found, codes = feeds(tmp_path, line)
    assert found == [100] * 8
    assert codes == (["GP270"] if line == "M51 P50" else [])


@pytest.mark.parametrize("line", ["M50 P1", "M50 P100", "M50 P0", "M52", "M52 P1", "M50 P50\nM50 P-1", "M50 P80\nM48"])
def test_feeds_are_not_known_behind_a_factor_of_the_program(tmp_path: Path, line: str) -> None:
    found, codes = feeds(tmp_path, line)
    assert found == [100] + [None] * 7
    assert codes == ["GP270"]


def test_the_input_switched_off_again(tmp_path: Path) -> None:
    found, codes = feeds(tmp_path, "M52\nM52 P0")
    assert found == [100] * 8
    assert codes == ["GP270"]


def test_speed_override(tmp_path: Path) -> None:
    trace, findings = run_whole(tmp_path, HEAD + "S500 M3\nM51 P120\nG95 G1 X5 F1\nM51 P-1\nG1 X6\nM5\n")
    assert codes_of(findings) == ["GP270", "GP239"]
    assert [row[4] for row in shown(trace) if row[0] == "feed"] == [None, 500]
    assert ("spindle", None) in shown(trace)


def test_rows_carry_the_override(tmp_path: Path) -> None:
    trace, _ = run_whole(tmp_path, HEAD + "G1 X1 F100\nM50 P80\nX2\nM30\n")
    rows = trace.sections[0].rows
    moved = [trace.states[k].feed_override for op, k in zip(rows["op"], rows["state"], strict=True) if op == Op.FEED]
    assert moved[0] == 1.0 and math.isnan(moved[1])


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("M50", "GP275"),
        ("M51", "GP275"),
        ("M52 P2", "GP113"),
        ("M53 P-1", "GP113"),
        ("M48 M49", "GP110"),  # 3.3: group 9
        ("M50 P1 M51 P1", "GP109"),
        ("M49 M50 P-1", "GP110"),
    ],
)
def test_errors(tmp_path: Path, line: str, code: str) -> None:
    _, findings = run_whole(tmp_path, f"{HEAD}{line}\nM30\n")
    assert codes_of(findings) == [code]
