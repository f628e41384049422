"""``gproof keys``: the keys of the user, and whose signatures are believed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import click

from gproof.driver import key_ring
from gproof.driver.errors import UsageError
from gproof.driver.escape import shown
from gproof.driver.files import require_file, require_place
from gproof.driver.key_ring import OWN, KeyRing, given_key, own_key_path, read_ring, require_name, write_entry
from gproof.verify.certificate.signers import Signer, fingerprint, today


def run_new(output: Path | None) -> int:
    """Make the own key, or one for another place; never over another."""
    from gproof.verify.certificate.keys import create_key, raw_public

    if output is not None:
        require_place(output, "output")
    path = output or own_key_path()
    if path.exists():
        if output is not None:
            raise UsageError(f"{path}: already exists; choose another name")
        raise UsageError(f"{path}: you already have a key; revoke it first: gproof keys revoke {OWN}")
    raw = raw_public(create_key(path))
    click.echo(f"{shown(str(path))}: a new key, {fingerprint(raw)}")
    said = (
        "give others its public half (gproof keys show)"
        if output is None
        else "give others its public half (gproof keys show FILE)"
    )
    click.echo(f"  {said}, never this file")
    return 0


def run_list() -> int:
    """One line a key: name, fingerprint, what it is worth today."""
    ring = read_ring()
    rows = [(one.name, fingerprint(one.raw), _state(one)) for one in ring.signers]
    width = max((len(name) for name, _, _ in rows), default=0)
    for name, finger, state in rows:
        click.echo(f"{shown(name):<{width}}  {finger}  {state}")
    if ring.own is None:
        click.echo("no key of your own yet: gproof keys new makes it, and so does the first gproof compile", err=True)
    return 0


def _state(one: Signer) -> str:
    if one.revoked is not None:
        return f"revoked on {one.revoked}"
    if one.expires is not None:
        return f"expired on {one.expires}" if today() > one.expires else f"trusted until {one.expires}"
    return "your own key" if one.name == OWN else "trusted"


def run_show(name: str) -> int:
    """The public key, alone on standard output; its fingerprint with it."""
    from gproof.verify.certificate.keys import load_key, public_key_text, raw_public

    found = next((one for one in read_ring().signers if one.name == name), None)
    if found is not None:
        raw = found.raw
    elif name != OWN and Path(name).exists():
        path = Path(name)
        require_file(path, "key")
        try:
            raw = raw_public(load_key(path)) if b"PRIVATE KEY" in path.read_bytes() else _public(path)
        except ValueError as error:
            raise UsageError(str(error)) from None
    elif name == OWN:
        raise UsageError("you have no key of your own yet; make it with gproof keys new")
    else:
        raise UsageError(f"there is no key {name!r}; gproof keys list shows all keys")
    click.echo(public_key_text(raw), nl=False)
    click.echo(f"fingerprint {fingerprint(raw)}", err=True)
    return 0


def run_trust(path: Path, name: str | None, expires: str | None) -> int:
    """Believe from now on what a key signs."""
    given = given_key(path, "key")
    raw = given.raw
    name = path.stem if name is None else name
    require_name(name)
    try:
        asked = None if expires is None else key_ring.date_of(expires)
    except ValueError as error:
        raise UsageError(f"--expires: {error}") from None
    if asked is not None and asked < today():
        raise UsageError(f"--expires {asked}: this day is in the past")
    if given.revoked is not None:
        raise UsageError(f"key {path}: revoked on {given.revoked} according to the file; it cannot be trusted")
    if given.expires is not None and given.expires < today():
        raise UsageError(f"key {path}: expired on {given.expires} according to the file; it cannot be trusted")
    last = min((day for day in (asked, given.expires) if day is not None), default=None)
    ring = read_ring()
    _not_otherwise(ring, raw, name)
    write_entry(Signer(raw=raw, name=name, expires=last))
    until = "" if last is None else f" until {last}"
    click.echo(f"{name}: trusted{until}, {fingerprint(raw)}")
    click.echo("  what it signs can run here: compare this fingerprint with the one that the owner reads to you")
    return 0


def _not_otherwise(ring: KeyRing, raw: bytes, name: str) -> None:
    """UsageError where the key is kept already in another way, or the name is another key's."""
    for one in ring.signers:
        if one.raw == raw and one.revoked is not None:
            raise UsageError(f"this key was revoked on {one.revoked} (as {one.name}); it cannot be trusted again")
    for one in ring.signers:
        if one.raw == raw and one.name != name:
            raise UsageError(f"this key is already trusted (as {one.name})")
        if one.raw != raw and one.name.lower() == name.lower():
            raise UsageError(f"name {name}: another key has it ({fingerprint(one.raw)}); choose one with --name")


def run_revoke(name: str, new_name: str | None) -> int:
    """Refuse from now on what a key signs, whoever names it, and whenever it was signed."""
    ring = read_ring()
    known = next((one for one in ring.signers if one.name == name), None)
    if name == OWN:
        if ring.own is None:
            raise UsageError("you have no key of your own")
        kept = _revoke_own(ring.own)
        click.echo(f"{kept.name}: revoked, {fingerprint(kept.raw)}; what you signed with it is refused from now on")
        return 0
    if known is None:
        path = Path(name)
        if not path.exists():
            raise UsageError(f"there is no key {name!r}; gproof keys list shows all keys")
        raw = _public(path)
        known = next((one for one in ring.signers if one.raw == raw), None)
        if known is None:
            new_name = path.stem if new_name is None else new_name
            require_name(new_name)
            _not_otherwise(ring, raw, new_name)
            known = Signer(raw=raw, name=new_name)
        elif known.name == OWN:
            raise UsageError(f"this is your own key; revoke it with gproof keys revoke {OWN}")
    if known.revoked is not None:
        raise UsageError(f"{known.name}: already revoked on {known.revoked}")
    write_entry(replace(known, revoked=today()))
    click.echo(f"{known.name}: revoked, {fingerprint(known.raw)}; what it signed is refused from now on")
    return 0


def _revoke_own(own: Signer) -> Signer:
    """Keep the public half as revoked, and set the private one aside: nothing is signed with it any more."""
    kept = Signer(raw=own.raw, name=f"own-{fingerprint(own.raw)}", revoked=today())
    write_entry(kept)
    path = own_key_path()
    path.rename(path.with_name(f"revoked-{fingerprint(own.raw)}.pem"))
    return kept


def _public(path: Path) -> bytes:
    """The key alone, whatever its file says of it."""
    from gproof.verify.certificate.keys import load_public_key

    require_file(path, "key")
    try:
        return load_public_key(path)
    except (ValueError, OSError) as error:
        raise UsageError(str(error)) from None
