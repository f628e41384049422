"""``gproof run``: a certified stream on a board, with an execution record."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gproof.cli.run_progress import AUTO, Asking, Shown, shown
from gproof.cli.signals import INTERRUPTED, ends_with_its_command
from gproof.cli.telling import warn
from gproof.driver.at_hand import other_source, read_at_hand, require_files
from gproof.driver.boards import (
    made,
    plugged_in,
    require_for,
    require_pins,
    require_port,
    unread,
    unusable_board,
    wiring_finding,
)
from gproof.driver.escape import in_one_line
from gproof.driver.files import require_file
from gproof.driver.key_ring import trusted_with
from gproof.ir.finding import Finding, Findings, Severity
from gproof.ir.verdict import Verdict
from gproof.report.text import print_findings

if TYPE_CHECKING:
    from gproof.backend.operators import Operator, WaitRequest
    from gproof.backend.record_data import ExecutionRecord
    from gproof.cli.run_journal import Keeper
    from gproof.ir.setup import Setup
    from gproof.verify.certificate.package import Package


def run_run(
    path: Path, *, board: str, record: Path | None, real_time: bool, hold_at: float | None, estop_at: float | None,
    override: float | None, ask: bool, runs: Path | None = None, after_interruption: bool = False,
    replace_record: bool = False, trust: tuple[Path, ...] = (), machine: Path | None = None, setup: str | None = None,
    source: Path | None = None, allow_untrusted: bool = False, port: str | None = None, baud: int | None = None,
    progress: str = AUTO, vcd: Path | None = None,
) -> int:  # fmt: skip
    """Check the package again, run it, print what came back; exit 0 only for a completed run.

    trust, machine, setup, source: whom to believe besides the own keys, and what is at hand; allow_untrusted: nobody
    has to be believed, on a board that moves nothing. port, baud: where the board is, instead of where the machine file
    says. vcd: for a modelled board's pins. runs: where the journal is kept; after_interruption, replace_record: answers
    given beforehand (``run_journal.settled``, ``require_record_place``). progress: how it is shown (``run_progress``).
    """
    from gproof.backend.control import Control
    from gproof.backend.interrupts import interrupts
    from gproof.backend.record_data import Result
    from gproof.backend.runtime import run
    from gproof.cli.run_journal import Keeper, require_record_place, runs_folder, settled
    from gproof.verify.certificate.package import CertificateError, read_package

    require_file(path, "package")
    require_files(machine, setup, source)
    require_port(board, port, baud)
    require_pins(board, vcd, (path, machine, setup, source, *trust), record)
    replace = record is not None and require_record_place(record, path, replace_record)
    trusted = trusted_with(trust, warn)
    require_for(board, machine=machine, setup=setup, trusted=bool(trusted), allow_untrusted=allow_untrusted)
    try:
        package = read_package(path)
    except CertificateError as error:
        return _refused([error.finding])
    of_files = Findings()
    at_hand = read_at_hand(package, of_files, machine=machine, setup=setup, source=source)
    print_findings(of_files)
    if wrong := other_source(package, at_hand):
        return _refused(wrong)
    frequency = package.stream.tick_frequency
    folder = runs_folder(runs)
    if not settled(folder, board, after_interruption):
        return Verdict.UNKNOWN.exit_code
    for line in unread(board, at_hand.machine):
        warn(line)
    control = Control()
    keeper = Keeper(folder, board, path, record, replace)
    began = time.monotonic()
    show = shown(progress)
    with interrupts(control, for_good=ends_with_its_command()), keeper:
        if show is not None:
            show.start(str(package.body.get("job", path)), board, [motor.name for motor in package.stream.motors])
        done = _attempted(
            lambda: run(
                package,
                lambda: made(
                    board, plugged_in(at_hand.machine or package.machine, port, baud), len(package.stream.motors),
                    real_time, vcd,
                ),
                operator=_operator(ask, board, show), on_moment=None if show is None else show.moment,
                hold_at=None if hold_at is None else round(hold_at * frequency),
                estop_at=None if estop_at is None else round(estop_at * frequency),
                override=Fraction(1) if override is None else Fraction(override).limit_denominator(1000),
                machine=at_hand.machine, setup=at_hand.setup, trusted_keys=trusted,
                allow_untrusted=allow_untrusted, control=control, journal=keeper.journal, announce=_announce,
            ),
            board, keeper, of_files, machine, show,
        )  # fmt: skip
        if isinstance(done, int):
            return done
        took = time.monotonic() - began
        where, lost = keeper.keep(done)
        findings = Findings()
        for finding in (*done.findings(), *lost):
            findings.add(finding)
        lines = list(_lines(path, package, done, at_hand.setup, None if done.board.real_time else took))
        told = where is not None and (record is not None or bool(lost))
        lines.append(f"  record      {done.sha256}" + (f", in {where}" if told else ""))
        _say(findings, lines)
    if done.result is Result.COMPLETED:
        return 0
    return INTERRUPTED if control.signalled else Verdict.UNSAFE.exit_code


def _operator(ask: bool, board: str, show: Shown | None) -> Operator:
    """Who answers: a person, for a board that moves a machine always."""
    from gproof.backend.boards.board import MOVES_NOTHING
    from gproof.backend.operators import AutoContinue, Terminal

    asked = ask or board not in MOVES_NOTHING
    operator: Operator = Terminal(ask=_ask, tell=_tell) if asked else AutoContinue()
    return operator if show is None else Asking(operator, show.asks)


def _attempted(
    start: Callable[[], ExecutionRecord], board: str, keeper: Keeper, files: Findings, machine: Path | None,
    show: Shown | None,
) -> ExecutionRecord | int:  # fmt: skip
    """The record of a run, or the exit code where nothing was moved; UsageError where the board cannot be used."""
    from gproof.backend.boards.board import BoardError
    from gproof.backend.runtime import RunFailed, RunRefused

    done: ExecutionRecord | None = None
    try:
        done = start()
        return done
    except RunRefused as refused:
        return _refused(list(refused.findings))
    except RunFailed as failed:
        done = failed.record
        return done
    except BoardError as error:
        if (found := wiring_finding(error, files, machine)) is not None:
            return _refused([found])
        raise unusable_board(board, error) from None
    except OSError as error:
        raise keeper.unusable(error) from None
    finally:
        if show is not None:
            show.end(done)


def _lines(
    path: Path, package: Package, done: ExecutionRecord, setup: Setup | None, took: float | None
) -> Iterator[str]:
    """What the board acknowledged, where it left the motors, what measured offsets were taken for; took: seconds, of a
    run that need not keep time."""
    from gproof.backend.record_data import ALLOWED
    from gproof.verify.certificate.measured import taken

    frequency = package.stream.tick_frequency
    yield f"{path}: {done.result.value}" + (f": {done.reason}" if done.reason else "")
    yield f"  board       {done.board.name}, {frequency / 1e6:g} MHz, FIFO of {done.board.fifo_runs} runs"
    yield f"  sections    {len(done.sections)} of {len(package.stream.sections)}"
    ends = "ends at" if done.position is not None else "position not known, last acknowledged at"
    for name, motor, steps, position in zip(
        done.motors, package.stream.motors, done.steps, done.last_position, strict=True
    ):
        place = float(Fraction(position) / motor.steps_per_unit)
        yield f"  motor {name:<5} {steps} steps, {ends} step {position} ({place:.4f})"
    ticks = sum(section.ticks for section in done.sections)
    yield f"  time        {ticks / frequency:.1f} s of motion" + ("" if took is None else f", run in {took:.1f} s")
    yield from (f"  taken       {said}" for said in taken(package, setup))
    if done.accepted == ALLOWED:
        yield "  trusted     no: not signed with a trusted key, run with --allow-untrusted"


def _say(findings: Findings, lines: list[str]) -> None:
    """Print how it went; OSError where standard output takes nothing: the positions are on standard error then."""
    try:
        print_findings(findings)
        for line in lines:
            click.echo(in_one_line(line))
    except OSError:
        with suppress(OSError):
            for line in lines:
                click.echo(in_one_line(line), err=True)
        raise


def _tell(line: str) -> None:
    """A line of what the job asks; its texts are the program's."""
    click.echo(in_one_line(line))


MOST_SAID = 20
"""Things that no pin does which are said before a run, at most."""


def _announce(waits: Sequence[WaitRequest]) -> None:
    """What the operator will be asked to do, before anything moves."""
    _tell("No pin of the board does the following; the machine rests there, and you are asked:")
    for wait in waits[:MOST_SAID]:
        where = f"{wait.file}, " if wait.file else ""
        _tell(f"  {where}line {wait.line}: {wait.text}")
    if len(waits) > MOST_SAID:
        _tell(f"  and {len(waits) - MOST_SAID} more")


def _ask(prompt: str) -> str:
    if sys.stdin is None:  # Closed by whoever started it: nobody answers.
        raise EOFError
    return input(in_one_line(prompt))


def _refused(found: list[Finding]) -> int:
    findings = Findings()
    for finding in found:
        findings.add(finding)
    print_findings(findings)
    click.echo("gproof: nothing was moved: the package was refused", err=True)
    errors = any(f.severity is Severity.ERROR for f in found)
    return (Verdict.UNSAFE if errors else Verdict.UNKNOWN).exit_code
