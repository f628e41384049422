"""Who has signed what, and what is at hand: what `gproof verify` and `gproof run` believe of a package."""

import json
import re
from pathlib import Path

import pytest
from cli.packages import BOARD, JOB, MACHINE, Shop, resigned
from support.command import Done

from gproof.backend.boards import registry as boards
from gproof.backend.boards.virtual import VirtualBoard
from gproof.verify.certificate.keys import create_key

ONE_LINE = re.compile(r"gproof(?: \w+)*: error: [^\n]+\n\Z")


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Shop:
    return Shop(tmp_path, monkeypatch.setenv)


def refused(done: Done, *words: str) -> None:
    assert done.exit == 3, done
    assert done.out == ""
    assert ONE_LINE.match(done.err), done.err
    for word in words:
        assert word in done.err


def both(shop: Shop, package: str, *words: str) -> list[Done]:
    """Verified and run; they agree in their exit codes, and what is not SAFE does not move."""
    done = [shop("verify", package, *words), shop("run", package, *BOARD, *words)]
    assert done[0].exit == done[1].exit, done
    assert ("completed" in done[1].out) == (done[1].exit == 0)
    assert ("nothing was moved" in done[1].err) == (done[1].exit != 0)
    return done


# -- who signed


def test_what_one_has_signed_oneself_is_safe_without_options(shop: Shop) -> None:
    shop.compile()
    verified, _ = both(shop, "made.gpx")
    assert verified.exit == 0
    assert re.search(r"signed by   own \(\w{4}-\w{4}-\w{4}-\w{4}\)", verified.out)


def test_unsigned_and_strangers_are_unknown_until_they_are_trusted(shop: Shop) -> None:
    private, public = shop.key("stranger")
    shop.compile("--unsigned", output="unsigned.gpx")
    shop.compile("--key", str(private), output="strange.gpx")
    for name in ("unsigned.gpx", "strange.gpx"):
        for done in both(shop, name):
            assert done.exit == 2
            assert "GP827" in done.out
    assert "made.gpx: SAFE" not in shop("verify", "strange.gpx").out
    assert [done.exit for done in both(shop, "strange.gpx", "--trust", public.name)] == [0, 0]
    assert [done.exit for done in both(shop, "unsigned.gpx", "--trust", public.name)] == [2, 2]
    _, other = shop.key("other")
    assert [done.exit for done in both(shop, "strange.gpx", "--trust", other.name)] == [2, 2]
    assert [done.exit for done in both(shop, "strange.gpx", "--trust", other.name, "--trust", public.name)] == [0, 0]
    assert shop("keys", "trust", public.name).exit == 0
    verified, _ = both(shop, "strange.gpx")
    assert (verified.exit, "signed by   stranger (" in verified.out) == (0, True)


def test_another_users_package_is_a_strangers(shop: Shop) -> None:
    shop.compile()
    given = shop("keys", "show").out
    (shop.folder / "from-me.pem").write_text(given)
    shop.home("you")
    assert [done.exit for done in both(shop, "made.gpx")] == [2, 2]
    assert shop("keys", "trust", "from-me.pem", "--name", "colleague").exit == 0
    verified, _ = both(shop, "made.gpx")
    assert (verified.exit, "signed by   colleague (" in verified.out) == (0, True)


def test_a_signature_that_does_not_fit_is_an_error_whoever_is_trusted(shop: Shop) -> None:
    private, public = shop.key("bench")
    shop.compile("--key", str(private))
    other, _ = shop.key("other")
    package = shop.folder / "made.gpx"
    original = package.read_bytes()
    resigned(package, other, lambda body: body.update(gproof="9"))
    from cli.packages import members_of

    from gproof.verify.certificate.package import SIGNATURE, write_members

    members = members_of(package)
    package.write_bytes(original)
    write_members(package, members | {SIGNATURE: members_of(package)[SIGNATURE]})
    for words in ((), ("--trust", public.name)):
        for done in both(shop, "made.gpx", *words):
            assert (done.exit, "GP822" in done.out) == (1, True)
    done = shop("run", "made.gpx", *BOARD, "--allow-untrusted")
    assert (done.exit, "GP822" in done.out) == (1, True)


def test_a_key_that_expired_counts_no_more_whatever_date_the_signature_says(
    shop: Shop, monkeypatch: pytest.MonkeyPatch
) -> None:
    private, public = shop.key("bench")
    shop.compile("--key", str(private))
    assert shop("keys", "trust", public.name, "--expires", shop.day(0)).exit == 0
    assert [done.exit for done in both(shop, "made.gpx")] == [0, 0], "its last day is today"
    entry = shop.keys / "keys" / "bench.pem"
    entry.write_text(entry.read_text().replace(shop.day(0), shop.day(-1)))
    for done in both(shop, "made.gpx"):
        assert done.exit == 2
        assert f"which expired on {shop.day(-1)} (the date " in done.out
        assert "is only the signer's word" in done.out
    assert f"expired on {shop.day(-1)}" in shop("keys", "list").out


def test_a_revoked_key_is_refused_by_name_and_nothing_brings_it_back(shop: Shop) -> None:
    private, public = shop.key("bench")
    shop.compile("--key", str(private))
    assert shop("keys", "trust", public.name).exit == 0
    assert shop("keys", "revoke", "bench").exit == 0
    for words in ((), ("--trust", public.name)):
        for done in both(shop, "made.gpx", *words):
            assert done.exit == 1
            assert "signed by the key 'bench' (" in done.out
            assert "was revoked on" in done.out
    assert shop("run", "made.gpx", *BOARD, "--allow-untrusted").exit == 1
    refused(shop("keys", "trust", public.name), "revoked")
    refused(shop("keys", "trust", public.name, "--name", "again"), "revoked")


def test_ones_own_key_can_be_revoked_and_a_new_one_is_made(shop: Shop) -> None:
    shop.compile()
    assert shop("keys", "revoke", "own").exit == 0
    assert [done.exit for done in both(shop, "made.gpx")] == [1, 1]
    shop.compile(output="new.gpx")
    assert [done.exit for done in both(shop, "new.gpx")] == [0, 0]
    assert [done.exit for done in both(shop, "made.gpx")] == [1, 1]


# -- allowed all the same


def test_only_the_virtual_board_runs_what_nobody_trusted_has_signed_and_the_record_says_so(shop: Shop) -> None:
    private, public = shop.key("stranger")
    shop.compile("--unsigned", output="unsigned.gpx")
    shop.compile("--key", str(private), output="strange.gpx")
    for name in ("unsigned.gpx", "strange.gpx"):
        done = shop("run", name, *BOARD, "--allow-untrusted", "--record", f"{name}.json")
        assert done.exit == 0, done
        assert "run with --allow-untrusted" in done.out
        assert json.loads((shop.folder / f"{name}.json").read_text())["accepted"] == "allow-untrusted"
    done = shop("run", "strange.gpx", *BOARD, "--allow-untrusted", "--trust", public.name, "--record", "trusted.json")
    assert "run with --allow" not in done.out
    assert json.loads((shop.folder / "trusted.json").read_text())["accepted"] == "trusted-key"


# -- a board that moves something


@pytest.fixture
def mill(monkeypatch: pytest.MonkeyPatch) -> None:
    """The next board, as a later version may add it: an emulator behind a port."""

    def made(machine, motors, real_time):
        board = VirtualBoard.for_machine(machine, motors, real_time=real_time)
        opened = board.open
        import dataclasses

        board.open = lambda: dataclasses.replace(opened(), name="mill")  # type: ignore[method-assign]
        return board

    monkeypatch.setitem(boards.BOARDS, "mill", made)


HAND = {"--machine": "machine.toml", "--setup": "zero"}


@pytest.mark.usefixtures("mill")
def test_the_next_board_asks_for_machine_setup_and_trusted_keys(shop: Shop) -> None:
    shop.compile()
    at_hand = [word for option in HAND.items() for word in option]
    assert shop("run", "made.gpx", "--board", "mill", *at_hand).exit == 0
    refused(shop("run", "made.gpx", "--board", "mill"), "--machine and --setup")
    for option in HAND:
        left = [word for one in HAND.items() if one[0] != option for word in one]
        refused(shop("run", "made.gpx", "--board", "mill", *left), f"also needs {option}")
    refused(shop("run", "made.gpx", "--board", "mill", *at_hand, "--allow-untrusted"), "virtual only")
    shop.home("nobody")
    refused(shop("run", "made.gpx", "--board", "mill", *at_hand), "a trusted key")
    _, other = shop.key("other")
    assert shop("run", "made.gpx", "--board", "mill", *at_hand, "--trust", other.name).exit == 2


# -- what is at hand


def test_machine_setup_and_source_at_hand(shop: Shop) -> None:
    shop.compile()
    (shop.folder / "sister.toml").write_text(MACHINE.replace("max = 100\n", "max = 99\n"))
    (shop.folder / "moved.toml").write_text('schema = "gproof-setup/1"\nhomed = ["x"]\n[work.1]\nx = 5.0\n')
    (shop.folder / "newer.cnc").write_text(JOB.replace("X1", "X2"))
    (shop.folder / "copy.cnc").write_text(JOB)
    assert both(shop, "made.gpx", "--machine", "machine.toml", "--setup", "zero", "--source", "copy.cnc")[0].exit == 0
    for words, code in (
        (("--machine", "sister.toml"), "GP823"),
        (("--setup", "moved.toml"), "GP825"),
        (("--source", "newer.cnc"), "GP829"),
        (("--source", "machine.toml"), "GP829"),
    ):
        for done in both(shop, "made.gpx", *words):
            assert (done.exit, code in done.out) == (1, True), words
        assert shop("run", "made.gpx", *BOARD, "--allow-untrusted", *words).exit == 1


@pytest.mark.parametrize(
    "inputs", [[], 7, [7], [{"name": "job.cnc"}], [{"name": "other.cnc", "role": "source"}], "absent"], ids=str
)
def test_a_certificate_that_names_no_source_is_of_no_file(inputs: object, shop: Shop) -> None:
    private, public = shop.key("bench")
    shop.compile("--key", str(private))

    def change(body):
        body.update(inputs=inputs) if inputs != "absent" else body.pop("inputs")

    resigned(shop.folder / "made.gpx", private, change)
    for done in both(shop, "made.gpx", "--trust", public.name, "--source", "job.cnc"):
        assert (done.exit, "GP829" in done.out) == (1, True)


def test_an_included_file_is_not_the_source(shop: Shop) -> None:
    private, public = shop.key("bench")
    shop.compile("--key", str(private))
    (shop.folder / "part.cnc").write_text("G0 X2\n")
    import hashlib

    digest = hashlib.sha256(b"G0 X2\n").hexdigest()
    more = {"name": "part.cnc", "role": "source", "sha256": digest}
    resigned(shop.folder / "made.gpx", private, lambda body: body["inputs"].append(more))
    assert both(shop, "made.gpx", "--trust", public.name, "--source", "part.cnc")[0].exit == 1
    assert both(shop, "made.gpx", "--trust", public.name, "--source", "job.cnc")[0].exit == 0


# -- wrong words


def rsa() -> str:
    from cryptography.hazmat.primitives.asymmetric import rsa
    from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat

    key = rsa.generate_private_key(65537, 2048).public_key()
    return key.public_bytes(Encoding.PEM, PublicFormat.SubjectPublicKeyInfo).decode()


@pytest.mark.parametrize("command", ["verify", "run"])
def test_words_that_do_not_fit_are_one_line_and_exit_3(command: str, shop: Shop) -> None:
    shop.compile()
    (shop.folder / "rsa.pem").write_text(rsa())
    (shop.folder / "garbage.pem").write_bytes(b"\xff\x00garbage")
    (shop.folder / "empty.pem").write_bytes(b"")
    create_key(shop.folder / "private.pem")
    more = BOARD if command == "run" else ()
    for words, said in (
        (("--trust", "nothere.pem"), "no such file"),
        (("--trust", "."), "is a folder"),
        (("--trust", "rsa.pem"), "not an Ed25519 key"),
        (("--trust", "garbage.pem"), "not a public key"),
        (("--trust", "empty.pem"), "not a public key"),
        (("--trust", "job.cnc"), "not a public key"),
        (("--trust", "private.pem"), "is a private key"),
        (("--source", "nothere.cnc"), "no such file"),
        (("--source", "."), "is a folder"),
        (("--setup", "nothere.toml"), "no such file"),
        (("--setup", "."), "is a folder"),
        (("--machine", "."), "is a folder"),
        (("--machine", "a", "--machine", "b"), "given twice, as a and as b"),
        (("--setup", "a", "--setup", "b"), "given twice, as a and as b"),
    ):
        refused(shop(command, "made.gpx", *more, *words), said)
    for name in ("machine", "setup"):
        (shop.folder / "bad.toml").write_text("schema = 7\n")
        done = shop(command, "made.gpx", *more, f"--{name}", "bad.toml")
        assert done.exit == 3
        assert "cannot be used" in done.err
    damaged = shop.keys / "keys" / "x.pem"
    damaged.parent.mkdir()
    damaged.write_text("not a key")
    damaged.parent.chmod(0o700)
    refused(shop(command, "made.gpx", *more), "x.pem")
