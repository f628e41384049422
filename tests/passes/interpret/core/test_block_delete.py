"""A slash before a statement: with the switch on the statement is not there, with it off the slash is not."""

from __future__ import annotations

from pathlib import Path

import pytest
from passes.interpret.core.programs import HEAD, codes_of

from gproof.backend.emit.eding.program import emit
from gproof.driver.running import begin, collect
from gproof.frontend.eding.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.machine import NO_MACHINE
from gproof.ir.program import Program
from gproof.ir.setup import ZERO
from gproof.ir.text import parse_ir, print_ir
from gproof.ir.trace import Trace

SUB = "sub far\nG0 X500\nendsub\n"
STATEMENTS = {
    "gosub far": True, 'msg "hello"': False, 'warnmsg "wait"': True, 'errmsg "stop here"': True,
    'logmsg "x" #1': False, 'dlgmsg "how much" "mm" 100': True, "TCAGuard off": True, "MCAGuard off": True,
    'logfile "a.txt" 1': False, "SetLafAngle 5": True, "HomeIsEstop on": True, "home x": True,
}  # fmt: skip
"""Statements of chapter 4, each alone on its line; whether the machine does something else without them."""


def loaded(folder: Path, line: str) -> Program:
    job = folder / "job.cnc"
    job.write_text(f"{HEAD}{SUB}{line}\nG0 Y7\nM30\n")
    program = load_program(job, Findings())
    assert program is not None
    program.verify()
    return program


def executed(program: Program, *, block_delete: bool) -> tuple[Trace, list[str], bool]:
    """Trace, codes of the findings, whether a slash was met that matters."""
    findings = Findings()
    executor = begin(program, ZERO, NO_MACHINE, findings, block_delete=block_delete)
    trace = collect(executor)
    trace.verify()
    return trace, codes_of(findings), executor.met_deleted


@pytest.mark.parametrize("statement", STATEMENTS)
def test_the_switch_passes_over_a_statement_with_a_slash(statement: str, tmp_path: Path) -> None:
    with_slash, without, absent = (loaded(tmp_path, line) for line in ("/" + statement, " " + statement, ""))
    trace, found, met = executed(with_slash, block_delete=True)
    assert (print_ir(trace), found) == (print_ir(executed(absent, block_delete=True)[0]), [])
    assert met == STATEMENTS[statement]
    trace, found, met = executed(with_slash, block_delete=False)
    plain, plain_found, plain_met = executed(without, block_delete=False)
    assert (print_ir(trace), found, met, plain_met) == (print_ir(plain), plain_found, STATEMENTS[statement], False)


@pytest.mark.parametrize("statement", STATEMENTS)
def test_the_slash_is_kept(statement: str, tmp_path: Path) -> None:
    program = loaded(tmp_path, "/ " + statement)
    assert parse_ir(print_ir(program)) == program
    text = b"".join(emit(program)).decode()
    (line,) = [line for line in text.splitlines() if line.startswith("/")]
    assert line.lower() == f"/{statement.lower()}"


def test_a_slash_in_a_loop_and_before_a_line_number(tmp_path: Path) -> None:
    text = f"{HEAD}{SUB}#1 = 0\nwhile [#1 < 3]\n#1 = [#1 + 1]\n/N20 gosub far\nG0 Z[#1]\nendwhile\nM30\n"
    job = tmp_path / "job.cnc"
    job.write_text(text)
    program = load_program(job, Findings())
    assert program is not None
    for on, x in ((True, {0.0}), (False, {0.0, 500.0})):
        trace, found, _ = executed(program, block_delete=on)
        assert found == []
        assert set(trace.sections[0].rows["to"][:, 0].tolist()) <= x
        assert (500.0 in trace.sections[0].rows["to"][:, 0]) is not on
