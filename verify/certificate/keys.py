"""Keys that sign certificates: Ed25519 in PEM files, private ones readable by their owner alone."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from gproof.verify.certificate.ed25519_points import weakness

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey


def raw_public(key: Ed25519PrivateKey) -> bytes:
    """The 32 bytes of the public half."""
    from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat

    return key.public_key().public_bytes(Encoding.Raw, PublicFormat.Raw)


def load_key(path: Path) -> Ed25519PrivateKey:
    """An Ed25519 private key from a PEM file; ValueError when it is none."""
    from cryptography.exceptions import UnsupportedAlgorithm
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
    from cryptography.hazmat.primitives.serialization import load_pem_private_key

    try:
        key = load_pem_private_key(path.read_bytes(), password=None)
    except (ValueError, TypeError, UnsupportedAlgorithm):
        raise ValueError(f"{path}: not a private key in PEM form without a password") from None
    if not isinstance(key, Ed25519PrivateKey):
        raise ValueError(f"{path}: not an Ed25519 key")
    return key


def load_or_create_key(path: Path) -> Ed25519PrivateKey:
    """The key at ``path``; a new one is made there, readable by its owner alone, when there is none.

    ValueError for a file that is no such key, or that others may read.
    """
    if path.exists():
        if not path.is_file():
            raise ValueError(f"{path}: is not a regular file")
        if os.name == "posix" and path.stat().st_mode & 0o077:
            raise ValueError(f"{path}: others can read or write this key; chmod 600 it, or make a new key")
        return load_key(path)
    return create_key(path)


def create_key(path: Path) -> Ed25519PrivateKey:
    """A new key, readable by its owner alone; OSError where there is a file already."""
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
    from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat

    key = Ed25519PrivateKey.generate()
    text = key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())
    path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    with os.fdopen(handle, "wb") as out:
        out.write(text)
    return key


def public_key_text(key: Ed25519PrivateKey | bytes) -> str:
    """The public half of a key, or a raw public one, in PEM, to hand out."""
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey
    from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat

    public = Ed25519PublicKey.from_public_bytes(key) if isinstance(key, bytes) else key.public_key()
    return public.public_bytes(Encoding.PEM, PublicFormat.SubjectPublicKeyInfo).decode()


def load_public_key(path: Path) -> bytes:
    """The raw public key of a PEM file; ValueError when it is none, or when it holds more than that."""
    from cryptography.exceptions import UnsupportedAlgorithm
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey
    from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat, load_pem_public_key

    data = path.read_bytes()
    if b"PRIVATE KEY" in data:
        raise ValueError(f"{path}: this is a private key; use its public half (gproof keys show)")
    if data.count(b"-----BEGIN ") > 1:
        raise ValueError(f"{path}: more than one key; keep one in the file")
    try:
        key = load_pem_public_key(data)
    except (ValueError, TypeError, UnsupportedAlgorithm):
        raise ValueError(f"{path}: not a public key in PEM form") from None
    if not isinstance(key, Ed25519PublicKey):
        raise ValueError(f"{path}: not an Ed25519 key")
    raw = key.public_bytes(Encoding.Raw, PublicFormat.Raw)
    if weak := weakness(raw):
        raise ValueError(f"{path}: the key {weak}")
    return raw
