"""What a run leaves on the disk: its journal while it goes on, its signed record afterwards, wherever there is room.

``backend/journal.py`` is the file itself. Here is where it is, what happens to one that an earlier run left open,
and how a record reaches the user: the requested place, else the folder of the runs, else the folder for temporary
files, else standard error.
"""

from __future__ import annotations

import contextlib
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gproof.backend.boards.board import MOVES_NOTHING, VIRTUAL
from gproof.driver.errors import UsageError
from gproof.driver.escape import in_one_line
from gproof.driver.files import require_place
from gproof.driver.key_ring import own_key_path
from gproof.ir import codes
from gproof.ir.finding import Finding, Findings, Span
from gproof.report.text import print_findings

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

    from gproof.backend.journal import Found, Journal, Left
    from gproof.backend.record_data import ExecutionRecord

RECORD = ".record.json"


def runs_folder(given: Path | None) -> Path:
    """Where journals and records are kept: the user's own folder for gproof, or another one that is given.

    UsageError for one that somebody else can write: the text of a journal is signed with the user's key.
    """
    from gproof.ir.private_folder import not_private

    folder = given or Path(click.get_app_dir("gproof")) / "runs"
    why = not_private(folder)
    if why:
        raise UsageError(
            f"nothing was moved: journals cannot be kept in {folder} ({why}); choose with --runs a folder that only "
            "you can write"
        )
    return folder


@contextlib.contextmanager
def alone(runs: Path | None, board: str) -> Iterator[None]:
    """One run at a time on a board; UsageError while another process has it.

    A board that moves nothing belongs to its process: as many may run as there are processes.
    """
    from gproof.backend.journal import held

    if board in MOVES_NOTHING:
        yield
        return
    folder = runs_folder(runs)
    with contextlib.ExitStack() as stack:
        try:
            mine = stack.enter_context(held(folder, board))
        except OSError as error:
            raise UsageError(
                f"board {board}: cannot be locked in {folder}: {error.strerror or error}; nothing was moved"
            ) from None
        if not mine:
            raise UsageError(f"board {board}: another run is using it; nothing was moved")
        yield


def require_record_place(path: Path, package: Path, replace: bool) -> bool:
    """UsageError where no record can be written, or where there is something that is not a record to be replaced.

    True when there is one that is.
    """
    require_place(path, "record", (package,))
    if not path.exists():
        return False
    try:
        known = _is_record(path)
    except OSError as error:
        raise UsageError(f"record {path}: {error.strerror}") from None
    if not known:
        raise UsageError(f"record {path}: this file exists and is not an execution record; choose another name")
    if replace:
        return True
    if not _somebody_is_there():
        raise UsageError(f"record {path}: already exists; use --replace-record to replace it")
    if not click.confirm(f"{path} is a record of an earlier run. Replace it?", err=True):
        raise UsageError(f"record {path}: not replaced; nothing was moved")
    return True


def _is_record(path: Path) -> bool:
    """True for a file that is an execution record; OSError."""
    from gproof.backend.record_parse import LARGEST, is_record

    return path.stat().st_size <= LARGEST and is_record(path.read_bytes())


def _somebody_is_there() -> bool:
    return sys.stdin.isatty() and sys.stderr.isatty()


def own_key() -> Ed25519PrivateKey | None:
    """The user's signing key; None, with a line on standard error, when there can be none."""
    from gproof.verify.certificate.keys import load_or_create_key

    try:
        return load_or_create_key(own_key_path())
    except (ValueError, OSError) as error:
        _tell(f"gproof: warning: the record will not be signed: {error}")
        return None


def _tell(line: str) -> None:
    """A line on standard error, if there is anybody to read it."""
    with contextlib.suppress(OSError):
        click.echo(in_one_line(line), err=True)


class Keeper:
    """The journal and the record of one run."""

    def __init__(self, folder: Path, board: str, package: Path, record: Path | None, replace: bool = False) -> None:
        """Make the journal; UsageError when that cannot be done: nothing is run that leaves no trace.

        record: where the record is to go; replace: instead of one that is there.
        """
        from importlib.metadata import version

        from gproof.backend.journal import begin
        from gproof.backend.mark import marks_folder

        self.folder, self.package, self.wanted, self.replace = folder, package, record, replace
        self.key = own_key()
        heading = {
            "gproof": version("gproof"),
            "package": _said(package),
            "record": "" if record is None else _said(record),
        }
        try:
            real = board != VIRTUAL  # A virtual board ends with its process, and in simulated time nobody waits.
            self.journal: Journal = begin(
                folder, board, heading, marks=marks_folder() if real else None, behind=real
            )  # fmt: skip
        except OSError as error:
            raise self.unusable(error) from None

    def unusable(self, error: OSError) -> UsageError:
        """What to say when the journal cannot be started."""
        what = error.strerror or error
        return UsageError(f"the journal of the run cannot be written in {self.folder}: {what}; nothing was moved")

    def __enter__(self) -> Keeper:
        return self

    def __exit__(self, *_: object) -> None:
        """A journal in which nothing was started is removed; any other stays, for whoever looks at it next."""
        if self.journal.begun:
            self.journal.let_go()
        else:
            self.journal.discard()

    def keep(self, record: ExecutionRecord) -> tuple[Path | None, list[Finding]]:
        """Write the record, signed, and close the journal. Where it is, and what went wrong on the way."""
        found = _read(self.journal.path)
        own = self.journal.path.with_suffix(RECORD)
        where, lost = write_record(record, _signature(record, self.key, found), self.wanted, own, self.replace)
        if where is not None:
            try:
                self.journal.close(str(where))
            except OSError as error:
                what = f"the journal {self.journal.path} cannot be written ({error.strerror or error})"
                lost.append(codes.JOURNAL_LOST.at(Span(str(self.package), 0), what=what))
        return where, lost


def _said(path: Path) -> str:
    """A path as text of a journal, from wherever it is read."""
    return str(path.absolute()).encode("utf-8", "backslashreplace").decode()


def _read(path: Path) -> Found | None:
    """A journal, or None when it cannot be read."""
    from gproof.backend.journal import read_journal

    try:
        return read_journal(path)
    except OSError:
        return None


def _signature(
    record: ExecutionRecord, key: Ed25519PrivateKey | None, found: Found | None
) -> dict[str, str] | None:  # fmt: skip
    from gproof.backend.record_signature import sign

    if key is None:
        return None
    created, signer = (found.field("time"), found.field("signer")) if found else ("", "")
    return sign(record, key, created=created, package_signer=signer)


def write_record(
    record: ExecutionRecord, signature: dict[str, str] | None, wanted: Path | None, own: Path, replace: bool = False
) -> tuple[Path | None, list[Finding]]:
    """Write a record to the first place that takes it; None when it could only be printed. What went wrong.

    wanted: nothing there is replaced unless it is a record and ``replace`` says so. Elsewhere nothing is replaced.
    """
    lost: list[Finding] = []
    for place in (*([] if wanted is None else [wanted]), *_own_places(own)):
        try:
            if place.exists():
                if place != wanted and place.read_bytes() == record.to_json(signature):
                    return place, lost
                if place != wanted or not (replace and _is_record(place)):
                    raise FileExistsError(0, "a file with this name appeared during the run")
            record.write(place, signature)
        except OSError as error:
            what = f"the record cannot be written to {place} ({error.strerror or error})"
            lost.append(codes.JOURNAL_LOST.at(Span(record.job, 0), what=what))
            continue
        if lost:
            what = f"the record is in {place}"
            lost.append(codes.JOURNAL_LOST.at(Span(record.job, 0), what=what))
        return place, lost
    _tell("gproof: the record cannot be written to any folder; this is the record:")
    _tell(record.to_json(signature).decode().rstrip())
    return None, lost


def _own_places(own: Path) -> tuple[Path, Path]:
    """Where the record of a run goes that has no other place: into the folder of the runs, or to temporary files."""
    return own, Path(tempfile.gettempdir()) / own.name


# What an earlier run left.


def settled(folder: Path, board: str, go_on: bool) -> bool:
    """Deal with journals that were left open: True when a job may run now.

    The record of each is made and reported. A run that did not end must be answered for: at a terminal by a person,
    otherwise by ``--after-interruption`` (``go_on``). UsageError when the journals cannot be read.
    """
    from gproof.backend.journal import left_open

    try:
        lefts = left_open(folder, board)
        return _settled(lefts, board, go_on)
    except OSError as error:
        raise UsageError(f"journals in {folder}: {_named(error)}") from None


def _named(error: OSError) -> str:
    """What went wrong, with the file that it is about."""
    name = Path(error.filename).name if isinstance(error.filename, str) else ""
    return f"{name}: {error.strerror or error}" if name else f"{error.strerror or error}"


def _settled(lefts: list[Left], board: str, go_on: bool) -> bool:
    unanswered: list[Left] = []
    key: Ed25519PrivateKey | None = None
    try:
        for left in lefts:
            trail = left.found.trail()
            if not trail.begun and not left.found.damaged:
                left.remove()
                continue
            key = key or own_key()
            if _tell_of(left, key) or trail.ended:
                left.close()
            else:
                unanswered.append(left)
        if not unanswered:
            return True
        if not go_on and not (_somebody_is_there() and click.confirm("Run the job now?", err=True)):
            _tell(
                f"gproof: nothing was moved: the last run on board {board} was interrupted. Home the machine, check "
                "tool and part, then run with --after-interruption"
            )
            return False
        for left in unanswered:
            left.close()
        return True
    finally:
        for left in lefts:
            left.let_go()


def _tell_of(left: Left, key: Ed25519PrivateKey | None) -> bool:
    """Make the record of a run that left its journal open, unless that was done, and say what is known of it.

    True when the run itself had made one before it could not write its journal any more: it says how the run ended.
    """
    found = left.found
    trail = found.trail()
    if not trail.begun:
        what = (
            f"{found.path.name} is damaged from its first line: what was executed and where the axes are is not known"
        )
        _print([codes.RUN_INTERRUPTED.at(Span(str(found.path), 0), what=what)])
        return False
    record, where = trail.record(), found.recorded
    lost: list[Finding] = []
    made = None if where else _made_by_the_run(found, record, key)
    if made is not None:
        record, where = made[0], str(made[1])
    elif not where:
        own = found.path.with_suffix(RECORD)
        asked = Path(found.field("record")) if found.field("record") else None
        place, lost = write_record(
            record, _signature(record, key, found), None if asked and asked.exists() else asked, own
        )
        where = "" if place is None else str(place)
    if where and not found.recorded:
        with contextlib.suppress(OSError):
            left.note("recorded", {"path": where})
    _tell(f"gproof: the run of {found.field('package')} at {found.field('time')} did not close its journal")
    _print([*record.findings(), *lost])
    known = "at" if record.position is not None else "position not known, last acknowledged at"
    for name, steps, position in zip(record.motors, record.steps, record.last_position, strict=True):
        _tell(f"  motor {name:<5} {steps} steps acknowledged, {known} step {position}")
    _tell(f"  result      {record.result.value}" + (f", {record.reason}" if record.reason else ""))
    _tell(f"  record      {record.sha256}" + (f", in {where}" if where else ""))
    return made is not None


def _made_by_the_run(
    found: Found, told: ExecutionRecord, key: Ed25519PrivateKey | None
) -> tuple[ExecutionRecord, Path] | None:  # fmt: skip
    """The record that a run wrote itself when its journal took nothing more, and where; None when there is none.

    It is one that the own key has signed, of the run that started when the journal says, and that says how it ended.
    ``told``: what the journal alone says.
    """
    from gproof.backend.record_data import Result
    from gproof.backend.record_parse import LARGEST, parse_signed
    from gproof.backend.record_signature import signer_of
    from gproof.verify.certificate.keys import raw_public

    asked = [Path(found.field("record"))] if found.field("record") else []
    if key is None:
        return None
    for place in (*asked, *_own_places(found.path.with_suffix(RECORD))):
        try:
            if not place.is_file() or place.stat().st_size > LARGEST:
                continue
            record, signature = parse_signed(place.read_bytes())
            if signature is None or signer_of(record, signature) != raw_public(key):
                continue
        except (OSError, ValueError):
            continue
        of_it = signature["created"] == found.field("time") and record.start == told.start
        if of_it and record.certificate == told.certificate and record.result is not Result.INTERRUPTED:
            return record, place
    return None


def _print(found: list[Finding]) -> None:
    findings = Findings()
    for finding in found:
        findings.add(finding)
    with contextlib.suppress(OSError):
        print_findings(findings, err=True)
