"""The journal of a run: an append-only file that says what was started before it starts, whatever happens then.

Each line is a checksum, a blank and a JSON object; the checksum is SHA-256 over the checksum before it and the
object, so that no line can be lost, changed or moved without notice. What has to be on the disk before something
moves is synced. A journal is held by a lock that ends with its process: one that is open and not held belongs to a
run that did not end. ``trail.py`` makes the record from its entries; ``docs/execution-record.md`` defines the file.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import hashlib
import json
import os
import re
import secrets
import stat
import threading
from collections.abc import Callable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Protocol

from gproof.backend.mark import Given, Mark, read_mark
from gproof.backend.record_data import canonical, sync_folder
from gproof.backend.trail import Entry, Trail
from gproof.ir.private_folder import make_private
from gproof.ir.record import record

SCHEMA = "gproof-journal/2"
FIRST_SCHEMA = "gproof-journal/1"
"""Still read; it says nothing of losses and bounds."""

SUFFIX, ENDED, DAMAGED = ".journal", ".ended", ".damaged"
"""Of an open journal; of one that is closed; of one that could not be read to its end, after somebody was informed."""

KEPT = 50
"""Closed journals that are kept in a folder; their records say the same."""

LARGEST = 1 << 28
"""Bytes of a journal that are read; a day of motion takes a tenth of it."""

_FIRST = {schema: hashlib.sha256(schema.encode()).hexdigest() for schema in (SCHEMA, FIRST_SCHEMA)}
_DIGITS = 64
_BEGINS = re.compile(rb"[0-9a-f]{0,64}|[0-9a-f]{64} (\{[ -~]*)?")
"""What a line is that was being written."""


class Notes(Protocol):
    """What the runtime writes to."""

    def note(self, kind: str, fields: Mapping[str, Any], *, sync: bool) -> None:
        """Keep an entry; sync: it is on the disk when this returns. OSError when it cannot be kept."""

    def mark(self, fields: Mapping[str, Any]) -> None:
        """Say how much a board has been given at most, before it is; OSError when that cannot be said (``Given``)."""


class Journal:
    """A journal that is being written.

    heading: further fields of the entry ``begin``: who started the run, and for what. ``note`` keeps what could not be
    written, and the next ``note`` writes it first, never after half a line. marks: folder of its mark (None: it has
    none). behind: what need not be synced is written and synced by a thread, so that nobody waits for the disk; what
    went wrong there the next ``note`` raises.
    """

    def __init__(
        self, path: Path, board: str, heading: Mapping[str, Any], *, marks: Path | None = None, behind: bool = False
    ) -> None:
        """Make the file, which must not be there, and hold it; OSError."""
        self.path = path
        self._heading = {"schema": SCHEMA, "place": board, "mark": "", **heading}
        self._check = _FIRST[SCHEMA]
        self._size = 0
        self._mark: Mark | None = None
        self._writer = _Writer(self._flush_behind) if behind else None
        self._lock = threading.Lock()
        self._failed: OSError | None = None
        self._torn = False
        self._pending: list[bytes] = []
        self._handle = os.open(path, os.O_RDWR | os.O_APPEND | os.O_CREAT | os.O_EXCL, 0o600)
        try:
            fcntl.flock(self._handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            sync_folder(path.parent)
        except BaseException:
            self.discard()
            raise
        if marks is not None:
            # Without one less is known of a run that is killed, and no more.
            with contextlib.suppress(OSError):
                self._mark = Mark(marks, path.stem)
                self._heading["mark"] = str(self._mark.path)

    def note(self, kind: str, fields: Mapping[str, Any], *, sync: bool) -> None:
        """See ``Notes``."""
        entry = {**fields, **(self._heading if kind == "begin" else {})}
        line = _line(self._check, {"kind": kind, "time": _now(), **entry})
        self._check = line[:_DIGITS].decode()
        self._pending.append(line)
        if self._writer is not None and not sync:
            self._writer.wake()
            failed, self._failed = self._failed, None
            if failed is not None:
                raise failed
            return
        with self._lock:
            self._failed = None
            self._flush(sync)

    def mark(self, fields: Mapping[str, Any]) -> None:
        """See ``Notes``; nothing where there is no place for marks."""
        if self._mark is not None:
            mark = self._mark
            try:
                mark.write(fields)
            except OSError:
                self._mark = None
                raise

    def _flush_behind(self) -> None:
        """What the thread does: errors wait for the next ``note``."""
        with self._lock:
            try:
                if self._handle >= 0 and self._pending:
                    self._flush(True)
            except OSError as error:
                self._failed = error

    def _flush(self, sync: bool) -> None:
        if self._torn:
            os.ftruncate(self._handle, self._size)
            self._torn = False
        while self._pending:
            self._torn = True
            _write(self._handle, self._pending[0])
            self._torn = False
            self._size += len(self._pending.pop(0))
        if sync:
            os.fsync(self._handle)

    @property
    def begun(self) -> bool:
        """True when an entry was written: something may have moved since."""
        return self._size > 0

    def close(self, record: str) -> None:
        """Say where the record is, and that nothing is left to be done; OSError, and the journal stays open."""
        self.note("recorded", {"path": record}, sync=False)
        self.note("closed", {}, sync=True)
        os.replace(self.path, self.path.with_suffix(ENDED))
        if self._mark is not None:
            self._mark.remove()
        self.let_go()

    def let_go(self) -> None:
        """Close the file as it is."""
        if self._writer is not None:
            self._writer.end()
        if self._mark is not None:
            self._mark.let_go()
        if self._handle >= 0:
            handle, self._handle = self._handle, -1
            with contextlib.suppress(OSError):
                os.close(handle)

    def discard(self) -> None:
        """Remove the file: nothing was started."""
        if self._mark is not None:
            self._mark.remove()
        with contextlib.suppress(OSError):
            self.path.unlink()
        self.let_go()


class _Writer:
    """A thread that writes when it is woken, until it is ended."""

    def __init__(self, write: Callable[[], None]) -> None:
        self._write = write
        self._woken = threading.Event()
        self._over = False
        self._thread: threading.Thread | None = None

    def wake(self) -> None:
        """There is something to write."""
        if self._thread is None:
            self._thread = threading.Thread(target=self._run, name="journal", daemon=True)
            self._thread.start()
        self._woken.set()

    def _run(self) -> None:
        while not self._over:
            self._woken.wait()
            self._woken.clear()
            self._write()

    def end(self) -> None:
        """What there is to write is written."""
        self._over = True
        self._woken.set()
        if self._thread is not None:
            self._thread.join()


def _write(handle: int, data: bytes) -> None:
    while data:
        data = data[os.write(handle, data) :]


def _line(before: str, entry: Mapping[str, Any]) -> bytes:
    data = canonical(entry)
    return f"{_chained(before, data)} ".encode() + data + b"\n"


def _chained(before: str, data: bytes) -> str:
    return hashlib.sha256(before.encode() + data).hexdigest()


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def begin(
    folder: Path, board: str, heading: Mapping[str, Any], *, marks: Path | None = None, behind: bool = False
) -> Journal:
    """A new journal in a folder, which is made when it is not there; OSError. marks, behind: see ``Journal``."""
    make_private(folder)
    stamp = datetime.now(UTC).strftime("%Y%m%dT%H%M%SZ")
    for old in sorted(folder.glob(f"*{ENDED}"))[:-KEPT]:
        old.unlink(missing_ok=True)
    path = folder / f"{stamp}-{_plain(board)[:40]}-{secrets.token_hex(4)}{SUFFIX}"
    return Journal(path, board, heading, marks=marks, behind=behind)


def _plain(name: str) -> str:
    """A name as part of a file's name."""
    return re.sub("[^A-Za-z0-9_-]+", "-", name)


# Reading.


@record(frozen=True, slots=True, kw_only=True)
class Found:
    """A journal as read. entries: those before the first line that does not fit; damaged: the line number of it.

    A last line without its end is no damage where it starts as one does: what it says had not started when the
    writer died.
    """

    path: Path
    entries: tuple[Entry, ...]
    damaged: int = 0

    def field(self, name: str) -> str:
        """A text of the entry ``begin``; empty when it is not there."""
        value = self.entries[0][1].get(name) if self.entries else None
        return value if isinstance(value, str) else ""

    @property
    def closed(self) -> bool:
        """True when nothing is left to be done about it."""
        return bool(self.entries) and self.entries[-1][0] == "closed"

    @property
    def recorded(self) -> str:
        """Where its record was written; empty when there is none yet."""
        places = [fields.get("path") for kind, fields in self.entries if kind == "recorded"]
        return str(places[-1]) if places else ""

    def given(self) -> Given | None:
        """What its mark says; None where there is none that can be believed."""
        path = self.field("mark")
        return read_mark(Path(path), self.path.stem) if path else None

    def trail(self) -> Trail:
        """What it says of the run, up to what can be believed."""
        trail = Trail()
        for kind, fields in self.entries:
            if kind in ("recorded", "closed"):
                continue
            try:
                trail.add(kind, fields)
            except ValueError:
                trail.damaged = True
                break
        trail.damaged = trail.damaged or bool(self.damaged)
        return trail


def read_journal(path: Path) -> Found:
    """A journal, as far as it can be believed; OSError when it cannot be read, or is no regular file."""
    there = path.stat()
    if not stat.S_ISREG(there.st_mode) and not stat.S_ISDIR(there.st_mode):
        # A pipe would be waited for, and some devices never end.
        raise OSError(errno.EINVAL, "is not a regular file", str(path))
    return _parsed(path, path.read_bytes() if there.st_size <= LARGEST else b"\n")


def _parsed(path: Path, data: bytes) -> Found:
    entries: list[Entry] = []
    lines = data.split(b"\n")
    schema = SCHEMA
    if not lines[0].startswith(_chained(_FIRST[SCHEMA], lines[0][_DIGITS + 1 :]).encode()):
        schema = FIRST_SCHEMA
    check = _FIRST[schema]
    for number, line in enumerate(lines[:-1], start=1):
        text = line[_DIGITS + 1 :]
        if line[: _DIGITS + 1] != f"{_chained(check, text)} ".encode():
            return Found(path=path, entries=tuple(entries), damaged=number)
        check = line[:_DIGITS].decode()
        try:
            fields = json.loads(text)
            kind = str(fields.pop("kind"))
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            return Found(path=path, entries=tuple(entries), damaged=number)
        entries.append((kind, fields))
    if not _BEGINS.fullmatch(lines[-1]):
        return Found(path=path, entries=tuple(entries), damaged=len(lines))
    if entries and entries[0][1].get("schema") != schema:
        return Found(path=path, entries=(), damaged=1)
    return Found(path=path, entries=tuple(entries))


class Left:
    """A journal that a run left open, held so that nobody else deals with it."""

    def __init__(self, found: Found, handle: int) -> None:
        self.found = found
        self._handle = handle

    def note(self, kind: str, fields: Mapping[str, Any]) -> None:
        """Append an entry and sync it, after cutting off half a line; OSError. Nothing is added to a damaged one."""
        if self.found.damaged:
            return
        data = self.found.path.read_bytes()
        whole = data[: data.rfind(b"\n") + 1]
        last = whole[whole.rfind(b"\n", 0, len(whole) - 1) + 1 :]
        if len(whole) < len(data):
            os.ftruncate(self._handle, len(whole))
        before = last[:_DIGITS].decode() or _FIRST[SCHEMA]
        _write(self._handle, _line(before, {"kind": kind, "time": _now(), **fields}))
        os.fsync(self._handle)
        self.found = read_journal(self.found.path)

    def close(self) -> None:
        """Nothing is left to be done about it; OSError."""
        if not self.found.closed:
            self.note("closed", {})
        path = self.found.path
        os.replace(path, path.with_suffix(DAMAGED if self.found.damaged else ENDED))
        self._unmark()
        self.let_go()

    def _unmark(self) -> None:
        """Remove its mark, if that is one."""
        if self.found.given() is not None:
            with contextlib.suppress(OSError):
                Path(self.found.field("mark")).unlink()

    def let_go(self) -> None:
        """Let others have it."""
        if self._handle >= 0:
            handle, self._handle = self._handle, -1
            os.close(handle)

    def remove(self) -> None:
        """Remove the file: nothing was started."""
        self.found.path.unlink(missing_ok=True)
        self._unmark()
        self.let_go()


def left_open(folder: Path, board: str) -> list[Left]:
    """Journals of a board that no living process holds and that are not closed, the oldest first; OSError.

    One that says of no board is of every board.
    """
    out = []
    for path in sorted(folder.glob(f"*{SUFFIX}")) if folder.is_dir() else ():
        left = _left(path)
        if left is None:
            continue
        if left.found.field("place") in ("", board):
            out.append(left)
        else:
            left.let_go()
    return out


def _left(path: Path) -> Left | None:
    """The journal held, or None when another process holds it or has dealt with it."""
    try:
        handle = os.open(path, os.O_RDWR | os.O_APPEND | os.O_NONBLOCK)
    except FileNotFoundError:
        return None
    try:
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            raise OSError(errno.EINVAL, "is not a regular file", str(path))
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return Left(read_journal(path), handle)
    except (BlockingIOError, FileNotFoundError):
        os.close(handle)
        return None
    except BaseException:
        os.close(handle)
        raise


@contextlib.contextmanager
def held(folder: Path, board: str) -> Iterator[bool]:
    """One run at a time on a board that is there only once: False while another process holds it; OSError.

    The lock ends with its process, however that ends.
    """
    make_private(folder)
    handle = os.open(folder / (f"{_plain(board)}.lock"), os.O_RDWR | os.O_CREAT, 0o600)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            yield False
            return
        yield True
    finally:
        os.close(handle)


LOCKS = Path("/proc/locks")
"""Who holds which file, where the system says so."""


def is_held(path: Path) -> bool:
    """Whether a living process is writing a journal; nothing is held for it, where the system says it without."""
    try:
        number = f":{path.stat().st_ino}"
        words = [line.split() for line in LOCKS.read_text(encoding="ascii").splitlines()]
        return any("FLOCK" in line and any(word.endswith(number) for word in line) for line in words)
    except (OSError, ValueError):
        pass
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    except OSError:
        return False
    try:
        fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB)
        return False
    except OSError:
        return True
    finally:
        os.close(handle)
