"""A stranger's package: what it may cost to find out that it is none, and packages of other versions."""

from __future__ import annotations

import json
import random
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from support.campaigns import share
from support.goldens import ROOT
from verify.certificate.test_certificate import refusal
from verify.package_files import members_of, rebuilt, write

from gproof.cli.main import main
from gproof.ir.text import DEPTH, TOKENS, _Reader, parse_ir, parse_texts, print_ir, words_of
from gproof.verify.certificate.keys import load_or_create_key
from gproof.verify.certificate.package import canonical, read_package, write_members
from gproof.verify.certificate.package_zip import FREE, RATIO, Sealed

Members = dict[str, bytes]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("limits") / "whole.gpx")


@pytest.mark.parametrize(
    ("said", "code"),
    [
        ("gproof-certificate/3", "GP857"), ("gproof-certificate/5", "GP857"), ("gproof-certificate/", "GP820"),
        ("gproof-certificate/4 ", "GP820"), ("gproof-certificate/04", "GP820"),
        ("gproof-certificate/" + "9" * 5000, "GP820"), ("", "GP820"), (2, "GP820"),
        (None, "GP820"),
    ],
)  # fmt: skip
def test_other_formats(said: object, code: str, whole: Path, tmp_path: Path) -> None:
    members = members_of(whole)
    body = json.loads(members["body.json"]) | {"format": said}
    assert refusal(rebuilt(tmp_path / "a.gpx", members | {"body.json": canonical(body)}, rehash=False)) == code


def sized(change: Callable[[dict[str, object]], object]) -> Callable[[Members], Members]:
    def apply(members: Members) -> Members:
        body = json.loads(members["body.json"])
        change(body["sizes"])
        return members | {"body.json": canonical(body)}

    return apply


@pytest.mark.parametrize(
    "change",
    [
        sized(lambda sizes: sizes.update({"trace.bin": 0})),
        sized(lambda sizes: sizes.update({"trace.bin": sizes["trace.bin"] + 1})),  # type: ignore[operator]
        sized(lambda sizes: sizes.update({"trace.bin": sizes["trace.bin"] - 1})),  # type: ignore[operator]
        sized(lambda sizes: sizes.update({"trace.bin": -1})),
        sized(lambda sizes: sizes.update({"trace.bin": 10**400})),
        sized(lambda sizes: sizes.update({"trace.bin": 1.5})),
        sized(lambda sizes: sizes.update({"trace.bin": True})),
        sized(lambda sizes: sizes.update({"trace.bin": None})),
        sized(lambda sizes: sizes.update({"trace.bin": (2 << 30) - 1})),
        sized(lambda sizes: sizes.update({"other": 1})),
        sized(lambda sizes: sizes.pop("trace.bin")),
        sized(lambda sizes: sizes.clear()),
    ],
)
def test_sizes_that_are_not_those_of_the_parts(
    change: Callable[[Members], Members], whole: Path, tmp_path: Path
) -> None:
    assert refusal(rebuilt(tmp_path / "a.gpx", change(members_of(whole)), rehash=False)) == "GP820"


def test_nothing_is_unpacked_before_body_and_signature_are_judged(
    tmp_path: Path, whole: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    key = load_or_create_key(tmp_path / "key.pem")
    signed = members_of(write(tmp_path / "signed.gpx", key=key))
    opened: list[str] = []
    real = Sealed.member
    monkeypatch.setattr(Sealed, "member", lambda self, name, size: (opened.append(name), real(self, name, size))[1])
    body = json.loads(signed["body.json"])
    forged = signed | {"body.json": canonical(body | {"comment": "x"})}
    assert refusal(rebuilt(tmp_path / "a.gpx", forged, rehash=False)) == "GP822"
    assert opened == ["body.json", "signature.json"]
    opened.clear()
    huge = canonical(body | {"sizes": body["sizes"] | {"trace.bin": 2 * FREE}})
    assert refusal(rebuilt(tmp_path / "a.gpx", members_of(whole) | {"body.json": huge}, rehash=False)) == "GP820"
    assert opened == ["body.json"]


def bomb(path: Path, name: str, data: bytes, whole: Path) -> Path:
    """All hashes and sizes fit."""
    return rebuilt(path, members_of(whole) | {name: data})


BOMBS: dict[str, Callable[[Path, Path], Path]] = {
    "a table of zeros": lambda path, whole: bomb(path, "trace.bin", bytes(200 << 20), whole),
    "a table of zeros within the bounds": lambda path, whole: bomb(path, "stream/0.bin", bytes(47 << 20), whole),
    "a text of blanks": lambda path, whole: bomb(path, "machine.ir", b" " * (47 << 20), whole),
    "a text of numbers": lambda path, whole: bomb(path, "setup.ir", b"[" + b"1 " * (23 << 20) + b"]", whole),
    "a text of brackets": lambda path, whole: bomb(path, "setup.ir", b"[" * (40 << 20), whole),
    "a text of quotes": lambda path, whole: bomb(path, "setup.ir", b'"' + b"\\\\" * (20 << 20), whole),
    "a text of comments": lambda path, whole: bomb(path, "setup.ir", b";\n" * (20 << 20), whole),
    "a large table in a text": lambda path, whole: bomb(
        path, "setup.ir", b"(columns triangles 2000000 " + b"1 " * 18_000_000 + b")", whole
    ),
    "a table of whole numbers in a text": lambda path, whole: bomb(
        path, "setup.ir", b"(columns runs 1000000 " + b"1 " * 4_000_000 + b")", whole
    ),
    "a deep body": lambda path, whole: rebuilt(
        path, members_of(whole) | {"body.json": b'{"a":' + b"[" * (30 << 20)}, rehash=False
    ),
    "a wide body": lambda path, whole: rebuilt(
        path, members_of(whole) | {"body.json": b"[" + b"[]," * (4 << 20) + b"[]]"}, rehash=False
    ),
    "many members": lambda path, whole: rebuilt(
        path, members_of(whole) | {str(n): b"" for n in range(100_000)}, rehash=False
    ),
}  # fmt: skip

READ = """
import sys, time
from pathlib import Path
from gproof.verify.certificate.package import CertificateError, read_package
began = time.process_time()
try:
    read_package(Path(sys.argv[1]))
except CertificateError as error:
    # Of this program alone: what getrusage says has been that of the process which started it.
    status = Path("/proc/self/status").read_text()
    peak = status.split("VmHWM:")[1].split()[0] if "VmHWM:" in status else 0
    print(error.finding.code.label, time.process_time() - began, peak)
"""


@pytest.mark.parametrize("name", share(list(BOMBS), 6))
def test_bombs_cost_seconds_and_megabytes(name: str, whole: Path, tmp_path: Path) -> None:
    path = BOMBS[name](tmp_path / "bomb.gpx", whole)
    done = subprocess.run([sys.executable, "-c", READ, str(path)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    code, seconds, kilobytes = done.stdout.split()
    assert code in ("GP820", "GP821")
    assert float(seconds) < 10.0
    assert int(kilobytes) < 500_000


def test_parts_that_pack_too_well_are_stored(tmp_path: Path) -> None:
    path = tmp_path / "zeros.gpx"
    write_members(path, {"a": bytes(FREE + (8 << 20))})
    with zipfile.ZipFile(path) as archive:
        assert archive.getinfo("a").compress_type == zipfile.ZIP_STORED
    assert path.stat().st_size * RATIO > FREE
    write_members(path, {"a": bytes(1 << 20)})
    with zipfile.ZipFile(path) as archive:
        assert archive.getinfo("a").compress_type == zipfile.ZIP_DEFLATED


def test_texts_are_bounded() -> None:
    assert next(parse_texts(["[" * DEPTH + "]" * DEPTH]))
    with pytest.raises(ValueError, match="deep"):
        next(parse_texts(["[" * (DEPTH + 1) + "]" * (DEPTH + 1)]))
    with pytest.raises(ValueError, match="more than"):
        parse_ir("[" + "1 " * TOKENS + "]")


@pytest.mark.parametrize(
    "text", ["[" + "1 " * 1000 + "]", "[" * 1001, "[" + "1\n" * 1000 + "]", '["(columns" ' + "1 " * 1000 + "]"]
)
def test_so_many_words_and_no_more(text: str) -> None:
    words = words_of(text)
    with pytest.raises(ValueError, match="more than"):
        _Reader(text, 1000, DEPTH).whole()
    if text.endswith("]"):
        assert len(_Reader(text, words, DEPTH).whole()) >= 1000


def test_words_are_counted_as_they_are_read() -> None:
    """A writer that counts no more than TOKENS writes nothing that a reader refuses for its words."""
    rng = random.Random("words")
    for _ in range(60):
        value = tuple(("x" * rng.randrange(40), rng.random(), ()) for _ in range(rng.randrange(400)))
        text = print_ir(value).replace(
            "\n", "\n" * rng.choice((1, 1, 3)) + " " * rng.randrange(3)
        ) + " " * rng.randrange(3)
        words = words_of(text)
        reader = _Reader(text, words, DEPTH)
        assert reader.whole() == value
        assert 0 <= reader.left <= 3


@pytest.mark.parametrize(("limit", "said"), [("TOKENS", "words"), ("TEXT_LIMIT", "bytes"), ("LONGEST_TABLE", "rows")])
def test_what_nobody_would_read_is_not_written(
    limit: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(f"gproof.verify.certificate.package.{limit}", 3)
    job, made = ROOT / "corpus" / "eding" / "drilled-plate", tmp_path / "made.gpx"
    words = ["compile", str(job / "job.cnc"), "--machine", str(job / "machine.toml"), "--setup", "zero", "--unsigned"]
    assert main([*words, "-o", str(made)]) == 3
    told = capsys.readouterr().err.strip().splitlines()[-1]
    assert "nothing was written" in told and said in told, told
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "text",
    ["1e", "9" * 5000, "1/" + "9" * 5000, "1/0", "0x10", "1_000", "-", "Wait", "Wait.", "Wait.nothing", ".5", "nan1",
     '"', "b", 'b"', "(", "(columns", "(columns runs", "(columns runs 1 1 1 1)", "(columns runs -1 )",
     "(columns runs x)",
     "(columns triangles 1 1 2 3 4 5 6 7 8)", "(columns triangles 1 1 2 3 4 5 6 7 8 x)", "{1}", "", "[1] 2", "]"],
)  # fmt: skip
def test_words_that_are_no_values(text: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        parse_ir(text)


def test_reading_is_what_it_was(whole: Path) -> None:
    package = read_package(whole)
    for part in (package.machine, package.setup, package.trace, package.stream):
        assert parse_ir(print_ir(part)) == part or print_ir(parse_ir(print_ir(part))) == print_ir(part)
