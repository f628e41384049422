"""Signatures of execution records: Ed25519, in the form of a certificate's ``signature.json``.

The signature covers the body of the record, which holds no times and no names of people; a second one covers the
label next to it: when the run was started, and who had signed the package. A signature says who made the record.
"""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING

from gproof.backend.record_data import ExecutionRecord, canonical
from gproof.verify.certificate.ed25519_points import weakness

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

FIELDS = {"public_key", "signature", "created", "comment", "package_signer", "label_signature"}


def sign(
    record: ExecutionRecord, key: Ed25519PrivateKey, *, created: str = "", package_signer: str = "", comment: str = ""
) -> dict[str, str]:
    """The signature of a record. created: when the run was started; package_signer: who signed what was run."""
    from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat

    label = {
        "public_key": _encode(key.public_key().public_bytes(Encoding.Raw, PublicFormat.Raw)),
        "signature": _encode(key.sign(canonical(record.body()))),
        "created": created,
        "comment": comment,
        "package_signer": package_signer,
    }
    return {**label, "label_signature": _encode(key.sign(canonical(label)))}


def signer_of(record: ExecutionRecord, signature: dict[str, str]) -> bytes:
    """The raw public key of who signed a record; ValueError when the signature does not fit."""
    from cryptography.exceptions import InvalidSignature
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey

    if set(signature) != FIELDS:
        raise ValueError(f"fields {sorted(set(signature) ^ FIELDS)} of the signature are missing or unknown")
    label = {name: text for name, text in signature.items() if name != "label_signature"}
    raw = _decode(signature["public_key"])
    if weak := weakness(raw):
        raise ValueError(f"the key of the signature {weak}")
    try:
        public = Ed25519PublicKey.from_public_bytes(raw)
        public.verify(_decode(signature["signature"]), canonical(record.body()))
        public.verify(_decode(signature["label_signature"]), canonical(label))
    except InvalidSignature:
        raise ValueError("the signature does not fit the record") from None
    return raw


def _encode(raw: bytes) -> str:
    return base64.b64encode(raw).decode()


def _decode(text: str) -> bytes:
    """ValueError for any spelling but the one of ``_encode``."""
    raw = base64.b64decode(text, validate=True)
    if _encode(raw) != text:
        raise ValueError("base64 with bits left over")
    return raw
