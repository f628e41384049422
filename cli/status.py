"""``gproof status``: what was executed of a run that ended, or did not, and what to do next."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gproof.backend.boards.board import BoardError
from gproof.driver.errors import UsageError
from gproof.driver.escape import in_one_line
from gproof.ir.verdict import Verdict

if TYPE_CHECKING:
    from gproof.backend.run_bounds import Told
    from gproof.driver.run_status import RunStatus

SCHEMA = "gproof-status/1"
"""docs/execution-record.md."""


def run_status(
    of: Path | None, *, package: Path | None, runs: Path | None, port: str | None, baud: int | None, as_json: bool
) -> int:
    """Print the status of runs; exit 0 where all is known to the step, 2 where not, 1 where what is read contradicts
    itself."""
    from gproof.driver.run_status import status_of

    if port is not None and not port.strip():
        raise UsageError("--port is empty")
    folder = runs or Path(click.get_app_dir("gproof")) / "runs"
    try:
        paths, package = _journals(of, folder, package)
        if not paths:
            raise UsageError(f"no run is noted in {of if of is not None and of.is_dir() else folder}")
        # A board can only be asked about the last run on it.
        statuses = [
            status_of(path, package, _asking(port, baud) if port and path == paths[-1] else None) for path in paths
        ]
    except BoardError as error:
        said = str(error)
        raise UsageError(said if said.startswith(f"{port}:") else f"{port}: {said}") from None
    except OSError as error:
        raise UsageError(f"{error.filename or folder}: {error.strerror or error}") from None
    if as_json:
        click.echo(json.dumps({"schema": SCHEMA, "runs": [_json(status) for status in statuses]}, indent=2))
    else:
        for status in statuses:
            for line in _lines(status):
                click.echo(in_one_line(line))
    return max((_exit_code(status) for status in statuses), key=(0, 2, 1).index)


def _journals(of: Path | None, folder: Path, package: Path | None) -> tuple[list[Path], Path | None]:
    """The journals that are meant, and the package where that is what was named; UsageError, OSError."""
    from gproof.driver.run_status import journals_in
    from gproof.verify.certificate.package import CertificateError, read_package

    if of is None:
        return journals_in(folder), package
    if of.is_dir():
        return journals_in(of), package
    if not of.exists():
        raise UsageError(f"{of}: no such file or folder")
    if of.suffix in (".journal", ".ended", ".damaged"):
        return [of], package
    try:
        certificate = read_package(of).sha256
    except CertificateError as error:
        raise UsageError(f"{of}: neither a folder of runs, nor a journal, nor a package: {error}") from None
    return journals_in(folder, certificate), of


def _asking(port: str, baud: int | None) -> Any:
    """Asks the board on a port."""
    from gproof.backend.boards.klipper.counts import told
    from gproof.backend.boards.klipper.lines import BAUD

    def ask(motors: int, identity: bytes) -> Told | None:
        return told(port, baud or BAUD, motors, identity)

    return ask


def _exit_code(status: RunStatus) -> int:
    if status.contradiction:
        return Verdict.UNSAFE.exit_code
    return 0 if status.exact else Verdict.UNKNOWN.exit_code


def _lines(status: RunStatus) -> Iterator[str]:
    yield f"{status.journal}: {status.state.replace('-', ' ')}"
    record = status.record
    if record is not None:
        board = record.board
        firmware = f", firmware {board.firmware}" if board.firmware else ""
        yield f"  run         {record.job}, started {status.started}, certificate {record.certificate[:16]}…"
        yield f"  board       {f'{board.name} {board.identity}'.rstrip()}{firmware}"
        if (
            status.state != "running"
        ):  # Until it ends, the record of what is there so far is that of a run that broke off.
            yield f"  result      {record.result.value}" + (f": {record.reason}" if record.reason else "")
        yield from _where(status)
        most = status.most
        for motor, name in enumerate(record.motors):
            least = status.least[motor]
            steps = f"at least {least} steps, at most not known"
            if most is not None:
                steps = f"{least} steps" if most[motor] == least else f"{least} to {most[motor]} steps"
            at = "position not known" if status.position is None else f"at step {status.position[motor]}"
            yield f"  motor {name:<5} {steps}, {at}"
        for number, loss in status.losses():
            found = f"found again, position {loss.known.value}" if loss.found else "not found again"
            yield f"  lost        in section {number} at tick {loss.tick}: {loss.reason}; {found}"
    if status.board:
        yield f"  asked       the board: {status.board}"
    if status.contradiction:
        yield f"  wrong       {status.contradiction}"
    for note in status.notes:
        yield f"  unknown     {note}"
    for hint in status.hints:
        yield f"  next        {hint}"


def _where(status: RunStatus) -> Iterator[str]:
    """How far the program came."""
    record, place = status.record, status.place
    assert record is not None
    if not record.sections:
        yield "  executed    nothing: no section was started"
        return
    last = record.sections[-1]
    whole = "complete" if last.outcome.value == "completed" else "not complete"
    said = f"  executed    {len(record.sections)} sections started, section {last.number} {whole}"
    if place is not None and whole != "complete":
        file, first = place.from_line
        other, to = place.to_line
        lines = f"line {first} of {file}" if (file, first) == (other, to) else f"line {first} of {file} to line {to}"
        hertz = record.board.tick_frequency
        time = f"{place.begin / hertz:.3f} s to {place.end / hertz:.3f} s of its planned time"
        said += f": {lines}{f' of {other}' if other != file else ''}, {time}"
    yield said


def _json(status: RunStatus) -> dict[str, Any]:
    record, bounds, place = status.record, status.bounds, status.place
    told: dict[str, Any] = {
        "journal": str(status.journal),
        "state": status.state,
        "started": status.started,
        "damaged_line": status.damaged or None,
        "exact": status.exact,
        "contradiction": status.contradiction or None,
        "board_said": status.board or None,
        "unknown": list(status.notes),
        "next": list(status.hints),
    }
    if record is None:
        return told
    most, board = status.most, record.board
    told |= {
        "job": record.job,
        "certificate": record.certificate,
        "board": {"name": board.name, "identity": board.identity, "firmware": board.firmware},
        "result": record.result.value,
        "reason": record.reason,
        "sections": len(record.sections),
        "motors": [
            {
                "name": name,
                "least": status.least[k],
                "most": None if most is None else most[k],
                "position": None if status.position is None else status.position[k],
            }
            for k, name in enumerate(record.motors)
        ],
        "section": None,
        "lines": None,
        "losses": [
            {"section": number, "tick": loss.tick, "reason": loss.reason, "found": loss.found}
            for number, loss in status.losses()
        ],
    }
    if bounds is not None:
        told["section"] = {
            "number": record.sections[-1].number,
            "least": list(bounds.least),
            "most": None if bounds.most is None else list(bounds.most),
            "source": bounds.source.value,
            "proved": bounds.proved,
        }
    if place is not None:
        told["lines"] = {
            "from": {"file": place.from_line[0], "line": place.from_line[1]},
            "to": {"file": place.to_line[0], "line": place.to_line[1]},
            "from_tick": place.begin,
            "to_tick": place.end,
        }
    return told
