"""Who may sign what is run: keys with a name, a last day, or the word that they are revoked.

Whether a signature fits is ``certificate.py``'s question; here it is whose it is, and what that is worth today. Dates
are those of UTC. What a signature says of its own date is the signer's word, so that it saves no key that has expired.
"""

from __future__ import annotations

import base64
import datetime
import hashlib
from collections.abc import Iterable

from gproof.ir import codes
from gproof.ir.finding import Finding, Span
from gproof.ir.record import record
from gproof.verify.certificate.ed25519_points import weakness

_GROUP, _GROUPS = 4, 4


@record(frozen=True, slots=True, kw_only=True)
class Signer:
    """A public key that somebody has decided about.

    raw: its 32 bytes; name: what the user calls it; expires: the last day on which it counts, None: no such day;
    revoked: the day since which it counts no more, whoever names it, None: it does.
    """

    raw: bytes
    name: str = ""
    expires: datetime.date | None = None
    revoked: datetime.date | None = None


Trusted = Iterable[bytes | Signer] | None
"""Keys to accept: raw ones, or with what is known of them; None: nobody asks who signed, an empty one: nobody."""


def fingerprint(raw: bytes) -> str:
    """A key in 16 letters and digits that can be read out: the first 80 bits of its SHA-256 in base32.

    Made so that another key with the same one cannot be found; two that its maker chose together can.
    """
    text = base64.b32encode(hashlib.sha256(raw).digest()).decode().lower()
    return "-".join(text[at : at + _GROUP] for at in range(0, _GROUP * _GROUPS, _GROUP))


def called(signer: Signer) -> str:
    """``the key 'bench' (k3ab-...)``."""
    return f"the key {signer.name!r} ({fingerprint(signer.raw)})" if signer.name else fingerprint(signer.raw)


def today() -> datetime.date:
    """The day in UTC."""
    return datetime.datetime.now(datetime.UTC).date()


def signed_by(raw: bytes, signers: Iterable[bytes | Signer]) -> Signer | None:
    """What is known of a key: first of all that it is revoked, and the earliest last day; None: nothing."""
    known = [one if isinstance(one, Signer) else Signer(raw=one) for one in signers]
    mine = [one for one in known if one.raw == raw]
    for one in mine:
        if one.revoked is not None:
            return one
    last = datetime.date.max
    return min(mine, key=lambda one: one.expires or last, default=None)


def judge_signer(
    raw: bytes, signers: Trusted, where: Span, *, created: str = "", day: datetime.date | None = None
) -> list[Finding]:
    """Findings for who signed: revoked (GP828), expired or not known (GP827); none for who is trusted.

    created: when it was signed, as the signer says; day: the date at hand, by default that of the clock.
    """
    if weak := weakness(raw):
        return [codes.CERTIFICATE_SIGNATURE.at(where, what=f"signed with a key that {weak}")]
    if signers is None:
        return []
    known = signed_by(raw, signers)
    if known is None:
        said = f"signed by {fingerprint(raw)}, which is not a trusted key"
        return [codes.CERTIFICATE_UNTRUSTED.at(where, what=said)]
    if known.revoked is not None:
        said = f"signed by {called(known)}, which was revoked on {known.revoked}"
        return [codes.CERTIFICATE_REVOKED.at(where, what=said)]
    if known.expires is not None and (day or today()) > known.expires:
        said = f"signed by {called(known)}, which expired on {known.expires}"
        if created:
            said += f" (the date {created} in the package is only the signer's word)"
        return [codes.CERTIFICATE_UNTRUSTED.at(where, what=said)]
    return []
