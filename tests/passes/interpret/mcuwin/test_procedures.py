"""Procedures of rw_SymPas from their text to the trace: parameters, what goes back to the caller, local variables."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from gproof.driver.running import execute
from gproof.frontend.mcuwin.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.setup import ZERO, Interval, Setup
from passes.interpret.mcuwin import mcuwin_programs as din

HEAD = """$DINEND
var
    depth, rest : double;
    holes : integer;
procedure reckon(d : double; var many : integer; var out : double);
var
    turn : integer;
begin
    for turn := 1 to 3 do many := many + 1;
    d := d * 2;
    out := d + 0.5;
end;
procedure outer(var many : integer);
begin
    reckon(1, many, rest);
    many := many * 10;
end;
procedure forget;
var
    kept : double;
begin
    if holes = 0 then kept := 7;
    holes := 1;
    depth := kept;
end;
{$DINSTART}
%MAIN
G90 F100
"""


def run(text: str, tmp_path: Path, setup: Setup = ZERO) -> tuple[list[Any], list[str]]:
    """Moves, and what was found."""
    path = tmp_path / "job.src"
    path.write_text(f"{HEAD}{text}\nM30\n%\n", encoding="utf-8")
    findings = Findings()
    program = load_program(path, findings, din.machine())
    assert program is not None
    program.verify()
    trace = execute(program, setup, din.machine(), findings)
    return din.moves(trace), din.labels(findings)


def test_var_parameters_go_back(tmp_path: Path) -> None:
    moves, found = run(
        "holes := 4\ndepth := 20\n$reckon(depth / 10, holes, rest);\nG01 X(holes) Y(rest) Z(depth)", tmp_path
    )
    assert moves == [("FEED", 7.0, 4.5, 20.0)]
    assert found == []


def test_common_variables_go_back(tmp_path: Path) -> None:
    moves, found = run(
        "CI600 := 0\n$reckon(2, CI600, CD600);\n$reckon(CD600, CI600, CD600);\nG01 X(CI600) Y(CD600)", tmp_path
    )
    assert moves == [("FEED", 6.0, 9.5, 0.0)]
    assert found == []


def test_calls_within_procedures(tmp_path: Path) -> None:
    moves, found = run("holes := 2\n$outer(holes);\nG01 X(holes) Y(rest)", tmp_path)
    assert moves == [("FEED", 50.0, 2.5, 0.0)]
    assert found == []


def test_local_variables_do_not_live_from_call_to_call(tmp_path: Path) -> None:
    """The second call reads its own variable before it sets it: nobody knows what it holds."""
    moves, found = run("holes := 0\n$forget;\nG01 X(depth)", tmp_path)
    assert (moves, found) == ([("FEED", 7.0, 0.0, 0.0)], [])
    start = {axis: Interval(0.0, 0.0) for axis in "xyz"}
    known = Setup(homed=("x", "y", "z"), start=start, g92=start)
    assert run("holes := 0\n$forget;\nG01 X(depth)", tmp_path, known) == (moves, found)
    _, found = run("holes := 0\n$forget; forget;\nG01 X(depth)", tmp_path, known)
    assert "GP225" in found


@pytest.mark.parametrize(("value", "nearest", "count"), [("2.4", 2, 2), ("2.5", 3, 3), ("-0.5", 0, 3), ("3.75", 4, 2)])
def test_a_rounded_half_is_not_known(value: str, nearest: int, count: int, tmp_path: Path) -> None:
    """The manual does not say whether halves go up, or to the even number: both outcomes are followed."""
    once = f"rest := {value}\nholes := round(rest)"
    again = f"$for CI600 := 1 to 4 do begin\n{once}\n$end"  # where expressions are compiled
    for text in (once, again):
        moves, _ = run(f"{text}\n$if holes = {nearest} then begin\nG01 X5\n$end\nG01 X9", tmp_path)
        assert len(moves) == count
        assert ("FEED", 5.0, 0.0, 0.0) in moves


@pytest.mark.parametrize("text", [
    "holes := 2147483647\nholes := holes + 1", "holes := 1\n$for CI600 := 1 to 40 do holes := holes * 2;",
    "holes := 2000000000\n$outer(holes);",
])  # fmt: skip
def test_integers_have_32_bits(text: str, tmp_path: Path) -> None:
    """What the controller would make of more is not known: the job is refused."""
    _, found = run(text, tmp_path)
    assert found == ["GP228"]


def test_doubles_have_more(tmp_path: Path) -> None:
    moves, found = run(
        "depth := 2147483647\n$for CI600 := 1 to 5 do depth := depth * 2;\nG01 X(depth / depth)", tmp_path
    )
    assert (moves, found) == ([("FEED", 1.0, 0.0, 0.0)], [])
