"""`gproof keys`: made, shown, trusted, listed, revoked; what can not be done is one line and leaves all as it was."""

import base64
import os
import re
import stat
from pathlib import Path

import pytest
from cli.packages import Shop
from cli.test_trust import refused, rsa

from gproof.verify.certificate.keys import load_public_key
from gproof.verify.certificate.signers import Signer, fingerprint, signed_by

FINGERPRINT = r"[a-z2-7]{4}(-[a-z2-7]{4}){3}"


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Shop:
    return Shop(tmp_path, monkeypatch.setenv)


def state(shop: Shop) -> dict[str, bytes]:
    return {str(p.relative_to(shop.folder)): p.read_bytes() for p in shop.folder.rglob("*") if p.is_file()}


def test_a_new_key_is_private_and_its_public_half_can_be_given_away(shop: Shop) -> None:
    done = shop("keys", "list")
    assert (done.exit, done.out) == (0, "")
    refused(shop("keys", "show"), "no key of your own yet")
    done = shop("keys", "new")
    assert done.exit == 0
    private = shop.keys / "signing-key.pem"
    assert stat.S_IMODE(private.stat().st_mode) == 0o600
    assert stat.S_IMODE(shop.keys.stat().st_mode) == 0o700
    before = private.read_bytes()
    refused(shop("keys", "new"), "you already have a key")
    assert private.read_bytes() == before
    shown = shop("keys", "show")
    assert "PRIVATE" not in shown.out
    (shop.folder / "mine.pem").write_text(shown.out)
    mine = fingerprint(load_public_key(shop.folder / "mine.pem"))
    assert re.fullmatch(FINGERPRINT, mine)
    assert shown.err == f"fingerprint {mine}\n"
    assert mine in done.out
    assert shop("keys", "list").out == f"own  {mine}  your own key\n"
    assert shop("keys", "show", "own").out == shown.out
    assert shop("keys", "show", "mine.pem").out == shown.out
    assert shop("keys", "show", str(private)).out == shown.out, "of a private key the public half"


def test_a_key_for_somewhere_else(shop: Shop) -> None:
    done = shop("keys", "new", "-o", "robot.pem")
    assert done.exit == 0
    assert stat.S_IMODE((shop.folder / "robot.pem").stat().st_mode) == 0o600
    assert not shop.keys.exists()
    shop.compile("--key", "robot.pem")
    assert shop("verify", "made.gpx").exit == 2, "it is not one's own"
    refused(shop("keys", "new", "-o", "robot.pem"), "already exists")
    refused(shop("keys", "new", "-o", "no/where.pem"), "no such folder")
    refused(shop("keys", "new", "-o", "."), "is a folder")


def test_what_is_kept_is_a_key_for_every_tool(shop: Shop) -> None:
    _, public = shop.key("bench")
    assert shop("keys", "trust", "bench.pem", "--expires", shop.day(40)).exit == 0
    kept = shop.keys / "keys" / "bench.pem"
    assert load_public_key(kept) == load_public_key(public)
    assert kept.read_text().splitlines()[1] == f"expires: {shop.day(40)}"
    listed = shop("keys", "list").out
    assert re.fullmatch(rf"bench  {FINGERPRINT}  trusted until {shop.day(40)}\n", listed)
    assert shop("keys", "trust", "bench.pem").exit == 0, "the same key under the same name: another last day"
    assert shop("keys", "list").out.endswith("  trusted\n")
    assert shop("keys", "show", "bench").out == public.read_text()
    assert shop("keys", "revoke", "bench").exit == 0
    assert shop("keys", "list").out.endswith(f"  revoked on {shop.day(0)}\n")
    refused(shop("keys", "revoke", "bench"), "revoked on")


def test_a_key_that_was_never_trusted_can_be_revoked(shop: Shop) -> None:
    shop.key("stolen")
    assert shop("keys", "revoke", "stolen.pem").exit == 0
    assert "stolen" in shop("keys", "list").out
    refused(shop("keys", "trust", "stolen.pem"), "revoked")
    _, second = shop.key("second")
    assert shop("keys", "trust", second.name, "--name", "alias").exit == 0
    assert shop("keys", "revoke", second.name).out.startswith("alias: revoked"), "known under its name"


def test_words_that_do_not_fit_are_one_line_and_change_nothing(shop: Shop) -> None:
    _, _ = shop.key("bench")
    _, _ = shop.key("other")
    (shop.folder / "rsa.pem").write_text(rsa())
    (shop.folder / "garbage.pem").write_bytes(b"\xff\x00")
    assert shop("keys", "new").exit == 0
    (shop.folder / "mine.pem").write_text(shop("keys", "show").out)
    assert shop("keys", "trust", "bench.pem").exit == 0
    before = state(shop)
    for words, said in (
        (("trust", "nothere.pem"), "no such file"),
        (("trust", "."), "is a folder"),
        (("trust", "rsa.pem"), "not an Ed25519 key"),
        (("trust", "garbage.pem"), "not a public key"),
        (("trust", "bench-private.pem"), "is a private key"),
        (("trust", "other.pem", "--name", "bench"), "another key"),
        (("trust", "other.pem", "--name", "BENCH"), "another key"),
        (("trust", "bench.pem", "--name", "alias"), "already trusted (as bench)"),
        (("trust", "mine.pem"), "already trusted (as own)"),
        (("trust", "other.pem", "--name", "own"), "your own key"),
        (("trust", "other.pem", "--name", "Own"), "your own key"),
        (("trust", "other.pem", "--name", "../up"), "use letters"),
        (("trust", "other.pem", "--name", ".hidden"), "use letters"),
        (("trust", "other.pem", "--name", ""), "use letters"),
        (("trust", "other.pem", "--name", "x" * 65), "use letters"),
        (("trust", "other.pem", "--name", "a\x1b[2J"), "use letters"),
        (("trust", "other.pem", "--name", "\u202eneb"), "use letters"),
        (("trust", "other.pem", "--expires", "soon"), "is not a date"),
        (("trust", "other.pem", "--expires", "2027-02-29"), "no such day"),
        (("trust", "other.pem", "--expires", "20270131"), "is not a date"),
        (("trust", "other.pem", "--expires", "2027-W05"), "is not a date"),
        (("trust", "other.pem", "--expires", "\u0662027-01-31"), "is not a date"),
        (("trust", "other.pem", "--expires", "2001-01-01"), "in the past"),
        (("trust", "other.pem", "--expires", ""), "is not a date"),
        (("revoke", "nobody"), "there is no key"),
        (("revoke", "."), "is a folder"),
        (("revoke", "mine.pem"), "your own key"),
        (("revoke", "bench-private.pem"), "is a private key"),
        (("show", "nobody"), "there is no key"),
        (("show", "."), "is a folder"),
        (("show", "job.cnc"), "not a public key"),
        (("trust",), "FILE"),
        (("revoke",), "NAME"),
        (("sign",), "sign"),
    ):
        refused(shop("keys", *words), said)
        assert state(shop) == before, words
    assert shop("keys").exit == 3


def test_a_damaged_key_stops_every_command_that_asks(shop: Shop) -> None:
    """Or one that was revoked would come back."""
    shop.key("bench")
    assert shop("keys", "revoke", "bench.pem").exit == 0
    kept = shop.keys / "keys" / "bench.pem"
    whole = kept.read_text()
    shop.compile()
    assert shop("verify", "made.gpx").exit == 0
    for spoilt, said in (
        ("", "not a public key"),
        (whole.replace("revoked:", "revokd:"), "not a line of a key"),
        (whole.replace("revoked: 2", "revoked: x"), "is not a date"),
        (whole.replace("revoked:", "revoked: 2020-01-01\nrevoked:"), "there twice"),
        (whole.replace("fingerprint: ", "fingerprint: a"), "another key"),
        ("x" * 70_000, "not a public key"),
    ):
        kept.write_text(spoilt)
        for words in (("keys", "list"), ("verify", "made.gpx"), ("run", "made.gpx", "--board", "virtual")):
            refused(shop(*words), "bench.pem", said)
    kept.write_text(whole)
    if os.geteuid() != 0:
        kept.chmod(0)
        refused(shop("keys", "list"), "bench.pem")
        kept.chmod(0o600)


@pytest.mark.skipif(os.name != "posix", reason="modes of files")
@pytest.mark.parametrize("place", ["", "keys", "keys/bench.pem"])
def test_where_others_can_write_nobody_is_trusted(place: str, shop: Shop) -> None:
    shop.key("bench")
    assert shop("keys", "trust", "bench.pem").exit == 0
    path = shop.keys / place
    path.chmod(path.stat().st_mode | 0o020)
    refused(shop("keys", "list"), "others can")


def test_ones_own_key_that_others_can_read_is_none(shop: Shop) -> None:
    assert shop("keys", "new").exit == 0
    (shop.keys / "signing-key.pem").chmod(0o640)
    refused(shop("keys", "list"), "others can read or write")


def test_what_stands_above_a_key_counts_wherever_the_file_is_named(shop: Shop) -> None:
    """A key that was revoked, or has expired, is the same key when its file is handed on."""
    private, public = shop.key("bench")
    shop.compile("--key", str(private))
    plain = public.read_text()
    board = ("--board", "virtual")
    for above, exit_, said in (
        ("", 0, "signed by"),
        ("made with some tool: 3.1\n\n", 0, "signed by"),
        (f"expires: {shop.day(0)}\n", 0, "signed by"),
        (f"expires: {shop.day(-1)}\n", 2, "which expired on"),
        (f"revoked: {shop.day(0)}\n", 1, "which was revoked on"),
        (f"expires: {shop.day(9)}\nrevoked: {shop.day(0)}\n", 1, "which was revoked on"),
    ):
        (shop.folder / "given.pem").write_text(above + plain)
        for done in (
            shop("verify", "made.gpx", "--trust", "given.pem"),
            shop("run", "made.gpx", *board, "--trust", "given.pem"),
        ):
            assert (done.exit, said in done.out or exit_ == 0) == (exit_, True), (above, done)
        if exit_:
            refused(shop("keys", "trust", "given.pem"), "according to the file; it cannot be trusted")
    for above, said in (
        ("expires: soon\n", "is not a date"),
        ("revoked: 2020-01-01\nrevoked: 2020-01-01\n", "there twice"),
    ):
        (shop.folder / "given.pem").write_text(above + plain)
        refused(shop("verify", "made.gpx", "--trust", "given.pem"), "given.pem", said)
        refused(shop("keys", "trust", "given.pem"), "given.pem", said)
    for of_file, asked, counts in ((9, 20, 9), (20, 9, 9), (None, 9, 9), (9, None, 9)):
        (shop.folder / "given.pem").write_text((f"expires: {shop.day(of_file)}\n" if of_file else "") + plain)
        words = ("--expires", shop.day(asked)) if asked else ()
        assert f"trusted until {shop.day(counts)}" in shop("keys", "trust", "given.pem", *words).out


def test_a_last_day_that_was_said_is_not_lifted_by_naming_the_key(shop: Shop) -> None:
    private, public = shop.key("bench")
    shop.compile("--key", str(private))
    assert shop("keys", "trust", public.name, "--expires", shop.day(0)).exit == 0
    entry = shop.keys / "keys" / "bench.pem"
    entry.write_text(entry.read_text().replace(shop.day(0), shop.day(-1)))
    for file in (public, entry):
        assert shop("run", "made.gpx", "--board", "virtual", "--trust", str(file)).exit == 2
    assert shop("keys", "trust", public.name).exit == 0
    assert shop("run", "made.gpx", "--board", "virtual").exit == 0, "it is trusted anew"


def test_two_keys_in_a_file_are_none(shop: Shop) -> None:
    (_, one), (_, two) = shop.key("one"), shop.key("two")
    (shop.folder / "both.pem").write_text(one.read_text() + two.read_text())
    shop.compile()
    refused(shop("verify", "made.gpx", "--trust", "both.pem"), "more than one key")
    refused(shop("keys", "trust", "both.pem"), "more than one key")
    refused(shop("keys", "revoke", "both.pem"), "more than one key")


def test_no_other_key_passes_for_ones_own(shop: Shop) -> None:
    _, public = shop.key("bench")
    assert shop("keys", "trust", public.name).exit == 0
    for name in ("own", "Own"):
        there = (shop.keys / "keys" / "bench.pem").rename(shop.keys / "keys" / f"{name}.pem")
        refused(shop("keys", "list"), "the name of your own key")
        there.rename(shop.keys / "keys" / "bench.pem")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes")
@pytest.mark.parametrize("place", ["keys/bench.pem", "signing-key.pem"])
def test_a_pipe_among_the_keys_keeps_nobody_waiting(place: str, shop: Shop) -> None:
    assert shop("keys", "trust", shop.key("bench")[1].name).exit == 0
    (shop.keys / place).unlink(missing_ok=True)
    os.mkfifo(shop.keys / place, 0o600)
    refused(shop("keys", "list"), "not a regular file")


def test_revoked_counts_before_all_else_and_the_earliest_last_day() -> None:
    import datetime

    day = datetime.date(2027, 1, 31)
    raw = b"k" * 32
    gone = Signer(raw=raw, name="gone", revoked=day)
    for others in ([raw, gone], [gone, raw], [Signer(raw=raw, expires=day), gone]):
        assert signed_by(raw, others) == gone
    for others in ([Signer(raw=raw, expires=day), raw], [raw, Signer(raw=raw, expires=day)]):
        assert signed_by(raw, others) == Signer(raw=raw, expires=day)
    later = Signer(raw=raw, expires=day + datetime.timedelta(days=1))
    assert signed_by(raw, [later, Signer(raw=raw, expires=day), later]) == Signer(raw=raw, expires=day)
    assert signed_by(raw, [b"x" * 32]) is None


def test_what_is_shown_is_the_standard_form(shop: Shop) -> None:
    """A SubjectPublicKeyInfo with the object identifier of Ed25519 and 32 bytes (RFC 8410, 4)."""
    assert shop("keys", "new").exit == 0
    first, *body, last = shop("keys", "show").out.split()
    lines = f"{first} {' '.join(body)} {last}".replace("-----BEGIN PUBLIC KEY-----", "").split("-----END")
    raw = base64.b64decode("".join(lines[0].split()), validate=True)
    assert raw[:12] == bytes.fromhex("302a300506032b6570032100")
    assert len(raw) == 12 + 32
