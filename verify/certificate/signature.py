"""Whether a signature is one of the bytes of a certificate, by the key that it names; whose key that is, others ask."""

from __future__ import annotations

import base64
import json
from typing import Any

from gproof.verify.certificate.ed25519_points import weakness


def fits(signature: dict[str, Any], body: bytes) -> bool:
    """True for the signature of ``body`` and of its own label, in the form of docs/certificate.md.

    False for a key that no private key has, whatever the library says of its signatures.
    """
    from cryptography.exceptions import InvalidSignature
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey

    try:
        label = dict(signature)
        over_label = _decode(label.pop("label_signature"))
        raw = _decode(label["public_key"])
        if weakness(raw):
            return False
        public = Ed25519PublicKey.from_public_bytes(raw)
        public.verify(_decode(label["signature"]), body)
        text = json.dumps(label, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
        public.verify(over_label, text.encode())
    except (KeyError, ValueError, TypeError, InvalidSignature):
        return False
    return True


def _decode(text: str) -> bytes:
    """ValueError for any spelling but the one of base64 without bits left over."""
    raw = base64.b64decode(text, validate=True)
    if base64.b64encode(raw).decode() != text:
        raise ValueError("base64 with bits left over")
    return raw
