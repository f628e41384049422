"""Public keys that no private key has: each of the points of small order and each second spelling, by its bytes."""

import base64
import dataclasses
import random
from pathlib import Path

import pytest
from verify.certificate.test_certificate import codes, members_of, raw_public, rebuilt, refusal, write

from gproof.verify.certificate.check import check_package
from gproof.verify.certificate.ed25519_points import ORDER, P, weakness
from gproof.verify.certificate.keys import create_key, load_public_key
from gproof.verify.certificate.package import canonical, read_package

SMALL = {
    1: ("0100000000000000000000000000000000000000000000000000000000000000",),
    2: ("ecffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff7f",),
    4: (
        "0000000000000000000000000000000000000000000000000000000000000000",
        "0000000000000000000000000000000000000000000000000000000000000080",
    ),
    8: (
        "26e8958fc2b227b045c3f489f2ef98f0d5dfac05d3c63339b13802886d53fc05",
        "26e8958fc2b227b045c3f489f2ef98f0d5dfac05d3c63339b13802886d53fc85",
        "c7176a703d4dd84fba3c0b760d10670f2a2053fa2c39ccc64ec7fd7792ac037a",
        "c7176a703d4dd84fba3c0b760d10670f2a2053fa2c39ccc64ec7fd7792ac03fa",
    ),
}
"""All eight points whose order divides 8, by their order."""
SECOND_SPELLINGS = (
    "0100000000000000000000000000000000000000000000000000000000000080",  # x = 0 with a sign
    "ecffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff",
    "edffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff7f",  # y = p
    "edffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff",
    "eeffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff7f",  # y = p + 1
    "eeffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff",
)
"""Of points of small order."""
WEAK = [bytes.fromhex(text) for texts in (*SMALL.values(), SECOND_SPELLINGS) for text in texts]
D = -121665 * pow(121666, -1, P) % P


def affine_sum(a: tuple[int, int], b: tuple[int, int]) -> tuple[int, int]:
    """The law of the curve as it is written, with fractions."""
    t = D * a[0] * b[0] * a[1] * b[1]
    x = (a[0] * b[1] + b[0] * a[1]) * pow(1 + t, -1, P)
    y = (a[1] * b[1] + a[0] * b[0]) * pow(1 - t, -1, P)
    return x % P, y % P


def point(raw: bytes) -> tuple[int, int]:
    """The affine point of a canonical spelling, by trying roots."""
    number = int.from_bytes(raw, "little")
    y, sign = number % 2**255, number >> 255
    square = (y * y - 1) * pow(D * y * y + 1, -1, P) % P
    root = pow(square, (P + 3) // 8, P)
    x = next(r for r in (root, root * pow(2, (P - 1) // 4, P) % P) if (r * r - square) % P == 0)
    return (x if x & 1 == sign else -x % P), y


def spelled(of: tuple[int, int]) -> bytes:
    return (of[1] | (of[0] & 1) << 255).to_bytes(32, "little")


@pytest.mark.parametrize("order", SMALL)
def test_the_list_is_that_of_the_points_of_small_order(order: int) -> None:
    """By adding each to itself until the neutral element (0, 1) comes."""
    for text in SMALL[order]:
        one = point(bytes.fromhex(text))
        there, count = one, 1
        while there != (0, 1):
            there, count = affine_sum(there, one), count + 1
        assert count == order
    assert sum(len(texts) for texts in SMALL.values()) == 8


@pytest.mark.parametrize("raw", WEAK, ids=bytes.hex)
def test_points_of_small_order_are_refused_in_each_spelling(raw: bytes, tmp_path: Path) -> None:
    wanted = "canonical form" if raw.hex() in SECOND_SPELLINGS else "small order"
    assert wanted in weakness(raw)
    # In a file for --trust: the fixed beginning of a public key of this kind, then its bytes (RFC 8410).
    der = bytes.fromhex("302a300506032b6570032100") + raw
    pem = tmp_path / "weak.pem"
    pem.write_text(f"-----BEGIN PUBLIC KEY-----\n{base64.b64encode(der).decode()}\n-----END PUBLIC KEY-----\n")
    with pytest.raises(ValueError, match=r"weak\.pem"):
        load_public_key(pem)


@pytest.mark.parametrize("above", range(19))
def test_numbers_past_the_field_are_second_spellings(above: int) -> None:
    for sign in (0, 1 << 255):
        assert "canonical form" in weakness((P + above | sign).to_bytes(32, "little"))


@pytest.mark.parametrize("raw", WEAK, ids=bytes.hex)
def test_a_signature_that_fits_everything_is_refused(raw: bytes, tmp_path: Path) -> None:
    """R the neutral element and S = 0: under the key 01 00 ... it fits every message, under others every eighth."""
    path = write(tmp_path / "job.gpx")
    members = members_of(path)
    forged = base64.b64encode(bytes([1]) + bytes(63)).decode()
    label = {"public_key": base64.b64encode(raw).decode(), "signature": forged, "created": "", "comment": ""}
    signature = {**label, "label_signature": forged}
    members["signature.json"] = canonical(signature)
    assert refusal(rebuilt(tmp_path / "forged.gpx", members)) == "GP822"
    # Not while reading only: a package that was made in memory is asked too.
    package = dataclasses.replace(read_package(path), signature=signature)
    for trusted in (None, [raw]):
        check = check_package(package, trusted_keys=trusted)
        assert codes(check) == {"GP822"}
        assert check.signer is None


def test_keys_of_private_keys_are_keys_and_their_neighbours_are_none(tmp_path: Path) -> None:
    eighth = point(bytes.fromhex(SMALL[8][0]))
    for k in range(20):
        raw = raw_public(create_key(tmp_path / f"{k}.pem"))
        assert weakness(raw) == ""
        assert "outside the group" in weakness(spelled(affine_sum(point(raw), eighth)))


def test_anything_else_is_on_the_curve_or_not() -> None:
    """Of random numbers, half are no y of a point, and seven of eight of the others lie outside the group."""
    seed = 17
    rng = random.Random(seed)
    found = [weakness(rng.randbytes(32)) for _ in range(200)]
    assert 60 < sum("not a point" in one for one in found) < 140
    assert sum(one == "" for one in found) < 40
    assert weakness(b"") and weakness(bytes(33))
    assert ORDER.bit_length() == 253
