"""The user's keys: the own private one, and the public ones of others that were trusted or revoked.

All in one folder of the user's: ``signing-key.pem`` (mode 0600), and in ``keys/`` one ``NAME.pem`` a key, which is
the public key as every tool reads it, below lines such as ``expires: 2027-01-31`` and ``revoked: 2026-11-23``. What
cannot be understood there is an error of every command that needs it: a key that was revoked must not come back because
its file was damaged.
"""

from __future__ import annotations

import datetime
import os
import re
import stat
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gproof.driver.errors import UsageError
from gproof.ir.private_folder import not_private
from gproof.ir.record import record
from gproof.verify.certificate.signers import Signer, fingerprint

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

OWN = "own"
"""What the user's own key is called."""
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")
_BEGIN = "-----BEGIN "
_LARGEST = 1 << 16
_DATE = re.compile(r"\d{4}-\d{2}-\d{2}")


@record(frozen=True, slots=True, kw_only=True)
class KeyRing:
    """own: the user's own key, None: there is none yet; others: trusted and revoked ones, by name."""

    own: Signer | None
    others: tuple[Signer, ...]

    @property
    def signers(self) -> tuple[Signer, ...]:
        """All that is known."""
        return (*((self.own,) if self.own is not None else ()), *self.others)


def own_key_path() -> Path:
    """Where a user's own signing key is kept; made on the first ``compile`` or by ``gproof keys new``."""
    return Path(click.get_app_dir("gproof")) / "signing-key.pem"


def ring_folder() -> Path:
    """Where the public keys of others are kept."""
    return own_key_path().parent / "keys"


Warn = Callable[[str], None]
"""What takes a line of warning."""


def read_ring(warn: Warn | None = None) -> KeyRing:
    """All keys of the user; UsageError for one that cannot be read, or that others may write.

    warn: takes why the own private key is such a one, which is not trusted then; None: that is an error too.
    """
    folder = ring_folder()
    others: list[Signer] = []
    try:
        for place in (folder.parent, folder):
            if place.exists() and (why := not_private(place)):
                raise UsageError(f"key folder {place}: others could change whom you trust: {why}")
        if folder.exists():
            others = [_entry(path) for path in sorted(folder.glob("*.pem"))]
        own = _own_key(warn)
    except OSError as error:
        raise UsageError(f"{error.filename}: {error.strerror}") from None
    return KeyRing(own=own, others=tuple(others))


def _own_key(warn: Warn | None) -> Signer | None:
    from gproof.verify.certificate.keys import load_or_create_key, raw_public

    path = own_key_path()
    if not path.exists():
        return None
    try:
        return Signer(raw=raw_public(load_or_create_key(path)), name=OWN)
    except ValueError as error:
        if warn is None:
            raise UsageError(str(error)) from None
        warn(f"gproof: warning: your own key is not trusted: {error}")
        return None


def trusted_with(files: tuple[Path, ...], warn: Warn) -> tuple[Signer, ...]:
    """The keys of the user and of the files of ``--trust``; UsageError for what is no public key.

    warn: takes why the own key is not among them.
    """
    return (*read_ring(warn).signers, *(given_key(path, "trusted key") for path in files))


def given_key(path: Path, what: str) -> Signer:
    """A public key from a file of somebody, with the dates that are above it as ``keys/NAME.pem`` has them.

    UsageError for what is no such file. Other lines above the key are anybody's: tools write some.
    """
    from gproof.driver.files import require_file
    from gproof.verify.certificate.keys import load_public_key

    require_file(path, what)
    try:
        raw = load_public_key(path)
        days, _ = _days(path.read_bytes())
    except ValueError as error:
        raise UsageError(_of(path, error)) from None
    except OSError as error:
        raise UsageError(f"{what} {path}: {error.strerror or error}") from None
    return Signer(raw=raw, expires=days.get("expires"), revoked=days.get("revoked"))


def _of(path: Path, error: ValueError) -> str:
    """What is wrong with a key, with its file named once."""
    said = str(error)
    return said if str(path) in said else f"key {path}: {said}"


def _days(data: bytes) -> tuple[dict[str, datetime.date], list[tuple[str, str]]]:
    """The dates that are above a key in PEM form, and the other lines there as (word, rest); ValueError."""
    days: dict[str, datetime.date] = {}
    others: list[tuple[str, str]] = []
    text = data.decode("ascii", "replace")
    for line in text[: text.index(_BEGIN)].splitlines():
        word, colon, rest = line.partition(":")
        if not colon or word not in ("expires", "revoked"):
            others.append((word if colon else "", rest if colon else line))
        elif word in days:
            raise ValueError(f"{line!r} is there twice")
        else:
            days[word] = date_of(rest.strip())
    return days, others


def name_of(raw: bytes, signers: tuple[Signer, ...]) -> str:
    """``own (k3ab-...)``: how messages name a key."""
    name = next((one.name for one in signers if one.raw == raw and one.name), "")
    return f"{name} ({fingerprint(raw)})" if name else fingerprint(raw)


def date_of(text: str) -> datetime.date:
    """A day as YYYY-MM-DD; ValueError."""
    if not _DATE.fullmatch(text) or not text.isascii():
        raise ValueError(f"{text!r} is not a date such as 2027-01-31")
    try:
        return datetime.date.fromisoformat(text)
    except ValueError:
        raise ValueError(f"there is no such day: {text}") from None


def require_name(name: str) -> None:
    """UsageError for what cannot be the name of a key."""
    if not _NAME.fullmatch(name) or not name.isascii():
        raise UsageError(f"name {name!r}: use letters, digits, '.', '_' and '-', at most 64; choose a name with --name")
    if name.lower() == OWN:
        raise UsageError(f"name {name}: this is the name of your own key; choose another with --name")


def write_entry(signer: Signer) -> Path:
    """Keep a key under its name, in the place of what was kept under it."""
    from gproof.verify.certificate.keys import public_key_text

    lines = [f"fingerprint: {fingerprint(signer.raw)}"]
    lines += [f"{word}: {day}" for word, day in (("expires", signer.expires), ("revoked", signer.revoked)) if day]
    folder = ring_folder()
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    path = folder / f"{signer.name}.pem"
    handle, draft = tempfile.mkstemp(dir=folder, prefix=".")
    try:
        with os.fdopen(handle, "w", encoding="ascii") as out:
            out.write("\n".join(lines) + "\n" + public_key_text(signer.raw))
            out.flush()
            os.fsync(out.fileno())
        os.replace(draft, path)
    except BaseException:
        Path(draft).unlink(missing_ok=True)
        raise
    return path


def own_private_key() -> Ed25519PrivateKey | None:
    """The private key, None where there is none yet; ValueError for a file that is none, or that others can read."""
    from gproof.verify.certificate.keys import load_or_create_key

    path = own_key_path()
    return load_or_create_key(path) if path.exists() else None


def _entry(path: Path) -> Signer:
    """A key as it is kept."""
    from gproof.verify.certificate.keys import load_public_key

    _own(path)
    if path.stat().st_size > _LARGEST:
        raise UsageError(f"key {path}: not a public key in PEM form")
    if path.stem.lower() == OWN:
        raise UsageError(f"key {path}: {OWN} is the name of your own key; rename the file")
    try:
        raw = load_public_key(path)
        days, others = _days(path.read_bytes())
        for word, rest in others:
            if word != "fingerprint":
                raise ValueError(f"{f'{word}:{rest}' if word else rest!r} is not a line of a key file")
            if rest.strip() != fingerprint(raw):
                raise ValueError("its fingerprint belongs to another key")
    except ValueError as error:
        raise UsageError(_of(path, error)) from None
    return Signer(raw=raw, name=path.stem, expires=days.get("expires"), revoked=days.get("revoked"))


def _own(path: Path) -> None:
    """UsageError for what is no file, and for a key that somebody else could have written."""
    found = path.stat()
    if not stat.S_ISREG(found.st_mode):
        raise UsageError(f"key {path}: is not a regular file")
    if os.name != "posix":
        return
    if found.st_uid not in (0, os.geteuid()) or found.st_mode & 0o022:
        raise UsageError(f"key {path}: others can write it; check that it is still your file, then chmod go-w it")
