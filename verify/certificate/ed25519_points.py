"""Public keys of Ed25519 that no private key has: refused before a signature of theirs is looked at.

Under a point of small order signatures fit that anybody can write, some of them for every message, and libraries
differ in which of them they take. What is asked here is more than RFC 8032 5.1.3 asks: the one spelling of a point,
on the curve, in the group that the base point makes, and not its neutral element.
"""

from __future__ import annotations

P = 2**255 - 19
ORDER = 2**252 + 27742317777372353535851937790883648493
"""Of the base point: RFC 8032, 5.1."""
_D = -121665 * pow(121666, -1, P) % P
_ROOT = pow(2, (P - 1) // 4, P)
"""A square root of -1."""
_SIZE = 32

_Point = tuple[int, int, int, int]
"""X, Y, Z and T with x = X / Z, y = Y / Z, x y = T / Z."""
_NEUTRAL: _Point = (0, 1, 1, 0)


def weakness(raw: bytes) -> str:
    """Why 32 bytes are no public key, in words that follow "the key"; "" for one that they can be."""
    if len(raw) != _SIZE:
        return f"has {len(raw)} bytes, not {_SIZE}"
    number = int.from_bytes(raw, "little")
    y, sign = number & ((1 << 255) - 1), number >> 255
    if y >= P:
        return "is not in its canonical form"
    x = _root_of(y)
    if x is None:
        return "is not a point of the curve"
    if x == 0 and sign:
        return "is not in its canonical form"
    if x & 1 != sign:
        x = P - x
    point = (x, y, 1, x * y % P)
    if _is_neutral(_times(8, point)):
        return "is of small order: anybody could sign with it"
    return "" if _is_neutral(_times(ORDER, point)) else "is outside the group of the base point"


def _root_of(y: int) -> int | None:
    """The x of -x² + y² = 1 + d x² y², one of the two; None where there is none."""
    square = (y * y - 1) * pow(_D * y * y + 1, -1, P) % P
    x = pow(square, (P + 3) // 8, P)
    if (x * x - square) % P:
        x = x * _ROOT % P
    return None if (x * x - square) % P else x


def _add(a: _Point, b: _Point) -> _Point:
    """RFC 8032, 5.1.4: complete, also for a point and itself."""
    e = (a[1] - a[0]) * (b[1] - b[0]) % P
    f = (a[1] + a[0]) * (b[1] + b[0]) % P
    c, d = 2 * a[3] * b[3] * _D % P, 2 * a[2] * b[2] % P
    h, g, k, m = f - e, d - c, d + c, f + e
    return h * g % P, k * m % P, g * k % P, h * m % P


def _times(count: int, point: _Point) -> _Point:
    out = _NEUTRAL
    while count:
        if count & 1:
            out = _add(out, point)
        point = _add(point, point)
        count >>= 1
    return out


def _is_neutral(point: _Point) -> bool:
    return point[0] % P == 0 and (point[1] - point[2]) % P == 0
