"""The certificate and its package: whole and unaltered, or refused with a finding; never anything else."""

import base64
import dataclasses
import io
import json
import os
import random
import re
import stat
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from corpus.expectations import strange
from verify.jobs import JOBS
from verify.package_files import SAFE, Members, members_of, rebuilt, write
from verify.reference_stepper import machine, step, stream_of

from gproof.ir.machine import Machine
from gproof.ir.setup import NOTHING, ZERO, CylinderMap, HeightMap, InForce, Interval, Setup
from gproof.ir.text import print_ir
from gproof.ir.verdict import DEFAULT_POLICY, Condition, PropertyResult, Verdict
from gproof.verify.certificate import package as packages
from gproof.verify.certificate.check import Check, check_package
from gproof.verify.certificate.conform import misfit
from gproof.verify.certificate.keys import load_key, load_or_create_key, load_public_key, public_key_text
from gproof.verify.certificate.package import CertificateError, Package, canonical, read_package, seal


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("certificates")


@pytest.fixture(scope="module")
def key(folder: Path) -> Any:
    return load_or_create_key(folder / "key.pem")


@pytest.fixture(scope="module")
def signed(folder: Path, key: Any) -> Path:
    return write(folder / "signed.gpx", key=key, created="2024-01-01T00:00:00+00:00", comment="bench 3")


@pytest.fixture(scope="module")
def unsigned(folder: Path) -> Path:
    return write(folder / "unsigned.gpx")


def codes(check: Check) -> set[str]:
    return {f.code.label for f in check.findings}


def refusal(path: Path) -> str:
    with pytest.raises(CertificateError) as caught:
        read_package(path)
    assert str(path) == caught.value.finding.span.file
    assert caught.value.finding.message
    return caught.value.finding.code.label


def raw_public(key: Any) -> bytes:
    from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat

    raw: bytes = key.public_key().public_bytes(Encoding.Raw, PublicFormat.Raw)
    return raw


# --- what is right ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", JOBS)
def test_everything_is_read_back_bit_for_bit(name: str, tmp_path: Path) -> None:
    job = JOBS[name]()
    stream = stream_of(step(job, machine()), machine())
    package = read_package(write(tmp_path / "job.gpx", name=name, setup=NOTHING))
    assert package.machine == machine()
    assert package.setup == NOTHING
    assert print_ir(package.trace) == print_ir(job.trace())
    assert print_ir(package.stream) == print_ir(stream)
    for ours, theirs in zip(stream.sections, package.stream.sections, strict=True):
        assert ours.events == theirs.events
        assert ours.runs == theirs.runs
    assert check_package(package).valid


def test_body_says_what_was_proved(signed: Path) -> None:
    package = read_package(signed)
    body = package.body
    assert body["format"] == "gproof-certificate/4"
    assert body["schemas"] == {"machine": 1, "setup": 1, "stream": 1, "trace": 1}
    assert body["gproof"] == "1.2.3"
    assert [p["name"] for p in body["properties"]][:4] == list(DEFAULT_POLICY)
    assert {p["name"] for p in body["properties"]} > {"stream-position", "stream-velocity", "stream-event"}
    assert all(p["verdict"] == "SAFE" and p["checker"] and p["version"] for p in body["properties"])
    assert all(p["bound"] for p in body["properties"] if p["name"].startswith("stream-"))
    assert body["not_judged"] == ["feeds", "gouges"]
    assert body["inputs"][1] == {"name": "job.cnc", "sha256": "ab" * 32, "role": "source"}
    assert set(body["members"]) == set(members_of(signed)) - {"body.json", "signature.json"}
    assert package.body_bytes == canonical(body)


def test_same_inputs_same_bytes(tmp_path: Path, key: Any) -> None:
    first, second = (write(tmp_path / name, key=key, created="now").read_bytes() for name in ("a.gpx", "b.gpx"))
    assert first == second
    later = write(tmp_path / "c.gpx", key=key, created="later")
    assert read_package(later).sha256 == read_package(tmp_path / "a.gpx").sha256


def test_any_zip_program_can_open_it(signed: Path) -> None:
    with zipfile.ZipFile(signed) as archive:
        assert archive.testzip() is None
        assert archive.comment.startswith(b"sha256:")
        assert archive.namelist() == sorted(archive.namelist())
        assert json.loads(archive.read("signature.json"))["comment"] == "bench 3"


def test_signature_and_signers(signed: Path, unsigned: Path, key: Any) -> None:
    raw = raw_public(key)
    package = read_package(signed)
    check = check_package(package)
    assert check.valid
    assert check.signer == base64.b64encode(raw).decode()
    assert check.findings == ()
    assert check_package(package, trusted_keys=[b"x" * 32, raw]).valid
    assert codes(check_package(package, trusted_keys=[b"x" * 32])) == {"GP827"}
    assert codes(check_package(package, trusted_keys=[])) == {"GP827"}
    nobody = check_package(read_package(unsigned))
    assert nobody.valid
    assert codes(nobody) == {"GP826"}
    assert codes(check_package(read_package(unsigned), trusted_keys=[raw])) == {"GP827"}


def test_keys_are_private_and_kept(tmp_path: Path) -> None:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

    path = tmp_path / "new" / "key.pem"
    made = load_or_create_key(path)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert isinstance(made, Ed25519PrivateKey)
    assert raw_public(load_or_create_key(path)) == raw_public(made) == raw_public(load_key(path))
    (tmp_path / "public.pem").write_text(public_key_text(made))
    assert load_public_key(tmp_path / "public.pem") == raw_public(made)
    path.chmod(0o644)
    with pytest.raises(ValueError, match="others"):
        load_or_create_key(path)
    for text in (b"", b"-----BEGIN PRIVATE KEY-----\nnonsense\n-----END PRIVATE KEY-----\n", bytes(100)):
        path.write_bytes(text)
        path.chmod(0o600)
        for load in (load_or_create_key, load_key, load_public_key):
            with pytest.raises(ValueError, match=r"key\.pem"):
                load(path)


def test_nothing_half_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write(tmp_path / "job.gpx")
    before = path.read_bytes()

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        write(path, name="square")
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["job.gpx"]


# --- machine, setup, verdicts -------------------------------------------------------------------------------


def test_another_machine_is_refused(unsigned: Path) -> None:
    package = read_package(unsigned)
    assert check_package(package, machine()).valid
    for other in (
        dataclasses.replace(machine(), name="its neighbour"),
        dataclasses.replace(machine(), axes=(dataclasses.replace(machine().axes[0], upper=299.0), *machine().axes[1:])),
    ):
        check = check_package(package, other)
        assert "GP823" in codes(check)
        assert not check.valid


@pytest.mark.parametrize("verdict", [Verdict.UNSAFE, Verdict.UNKNOWN])
def test_only_safe_verdicts_are_accepted(verdict: Verdict, tmp_path: Path) -> None:
    for k, name in enumerate(DEFAULT_POLICY):
        results = [dataclasses.replace(p, verdict=verdict if p.name == name else p.verdict) for p in SAFE]
        check = check_package(read_package(write(tmp_path / f"{k}.gpx", properties=results)))
        assert "GP824" in codes(check)
        assert not check.valid


def test_a_property_missing_or_said_twice_is_refused(tmp_path: Path) -> None:
    twice = (*SAFE, dataclasses.replace(SAFE[0], verdict=Verdict.UNSAFE), SAFE[0])
    also = (*SAFE, PropertyResult(name="gouges", verdict=Verdict.UNSAFE))
    for k, properties in enumerate((SAFE[1:], twice, (*twice[::-1],), also)):
        check = check_package(read_package(write(tmp_path / f"{k}.gpx", properties=properties)))
        assert "GP824" in codes(check)
        assert not check.valid
    unknown = (*SAFE, PropertyResult(name="gouges", verdict=Verdict.UNKNOWN))
    left = {"properties": unknown, "not_judged": ["feeds"]}
    assert check_package(read_package(write(tmp_path / "unknown.gpx", **left))).valid


def test_conditions_are_held_against_the_setup(tmp_path: Path) -> None:
    condition = Condition(terms=(("g92.x", -1), ("work.1.x", 2)), low=-1.0, high=float("inf"))
    properties = (*SAFE[:1], dataclasses.replace(SAFE[1], conditions=(condition,)), *SAFE[2:])

    def check(setup: Setup) -> set[str]:
        return codes(check_package(read_package(write(tmp_path / "c.gpx", properties=properties, setup=setup))))

    def offsets(low: float, high: float, g92: float) -> Setup:
        return Setup(work={(1, "x"): Interval(low, high)}, g92={"x": Interval(g92, g92)})

    assert "GP825" not in check(offsets(0.0, 1.0, 1.0))
    assert "GP825" in check(offsets(-0.1, 1.0, 1.0))
    assert "GP825" in check(Setup(g92={"x": Interval(0.0, 0.0)}))


@pytest.mark.parametrize(
    ("condition", "setup", "told"),
    [
        (
            Condition(terms=(("work.1.x", 1),), low=20.0, high=100.0),
            {},
            "valid for G54 X offset from 20 to 100; now it is not in the setup",
        ),
        (
            Condition(terms=(("g92.x", -1), ("work.1.x", 2)), low=-1.0, high=float("inf")),
            {"work": {(1, "x"): Interval(-4.0, -3.5)}, "g92": {"x": Interval(0.0, 0.0)}},
            "valid for 2 x G54 X offset - G92 X offset at least -1; now it is from -8 to -7",
        ),
        (
            Condition(terms=(("tool.3.z", 1),), low=-1e9, high=40.125),
            {"tool_lengths": {3: Interval(50.0, 50.0)}},
            "valid for length of tool 3 from -1000000000 to 40.125; now it is 50",
        ),
    ],
)
def test_a_condition_that_does_not_hold_is_told_in_words(
    condition: Condition, setup: dict[str, Any], told: str, tmp_path: Path
) -> None:
    properties = (*SAFE[:1], dataclasses.replace(SAFE[1], conditions=(condition,)), *SAFE[2:])
    check = check_package(read_package(write(tmp_path / "c.gpx", properties=properties, setup=Setup(**setup))))
    assert any(told in finding.message for finding in check.findings if finding.code.number == 825)


@pytest.mark.parametrize(
    ("then", "now", "told"),
    [
        ({"active_work": 1}, {"active_work": 2}, "made for the active work offset G54; now it is G55"),
        ({"optional_stop": False}, {"optional_stop": True}, "made for the optional stop switch off; now it is on"),
        ({"tool": 3}, {"tool": None}, "made for the tool in the spindle 3; now it is not in the setup"),
        ({"parameters": {100: 2.5}}, {"parameters": {}}, "made for variable 100 2.5; now it is not in the setup"),
        (
            {"resident": {5: Interval(1.0, 2.0)}},
            {},
            "made for variable 5 from the previous job from 1 to 2; now it is not in the setup",
        ),
        (
            {"transform": InForce(angle=1.25, x=10.0)},
            {"transform": None},
            "made for the rotation and scaling of X and Y angle 1.25, factor of X not given, factor of Y not given, "
            "about X10 Y0; now it is not in the setup",
        ),
        ({"cylinder": CylinderMap(radius=5.0)}, {}, "made for the mapping onto a cylinder radius 5; now it is none"),
        ({"start": {"x": Interval(3.0, 3.0)}}, {}, "made for the start position of X 3; now it is not in the setup"),
    ],
)
def test_a_setup_that_differs_is_told_in_words(
    then: dict[str, Any], now: dict[str, Any], told: str, tmp_path: Path
) -> None:
    package = read_package(write(tmp_path / "job.gpx", setup=Setup(**then)))
    check = check_package(package, setup=Setup(**now))
    messages = [finding.message for finding in check.findings if finding.code.number == 825]
    assert any(told in message for message in messages), messages


def test_a_stream_runs_only_with_the_setup_it_was_made_for(tmp_path: Path) -> None:
    made_for = dataclasses.replace(
        ZERO, work={(1, "x"): Interval(5.0, 6.0)}, parameters={100: 2.0}, heads={(1, "x"): Interval(50.0, 50.5)},
        transform=InForce(angle=1.25, x=10.0, y=5.0), optional_stop=False,
    )  # fmt: skip
    package = read_package(write(tmp_path / "job.gpx", setup=made_for))
    assert check_package(package, setup=made_for).valid
    assert check_package(package, setup=dataclasses.replace(made_for, work={(1, "x"): Interval(5.5, 5.5)})).valid
    for change in (
        {"work": {(1, "x"): Interval(5.0, 6.5)}},
        {"work": {(1, "x"): Interval(5.0, 6.0), (2, "y"): Interval(1.0, 1.0)}},
        {"work": {}},
        {"g92": {"z": Interval(0.5, 0.5)}},
        {"tool_lengths": {4: Interval(1.0, 1.0)}},
        {"parameters": {100: 3.0}},
        {"parameters": {}},
        {"active_work": 2},
        {"heads": {(1, "x"): Interval(51.0, 51.0)}},
        {"heads": {}},
        {"transform": InForce(angle=1.25, x=10.0, y=6.0)},
        {"transform": None},
        {"default_offset": None},
        {"optional_stop": True},
    ):
        check = check_package(package, setup=dataclasses.replace(made_for, **change))
        assert "GP825" in codes(check), change
        assert not check.valid
        for finding in check.findings:
            assert not strange(finding.message), finding.message
    open_ = read_package(write(tmp_path / "open.gpx", setup=NOTHING))
    assert check_package(open_, setup=NOTHING).valid
    assert not check_package(open_, setup=made_for).valid, "what its setup left open stood for a default"


def test_a_height_map_or_a_mapping_is_the_one_that_the_stream_was_made_for(tmp_path: Path) -> None:
    level = HeightMap(x=0.0, y=0.0, size=10.0, heights=((1.0, 1.0), (1.0, 1.0)))
    other = dataclasses.replace(level, heights=((1.0, 1.0), (1.0, 1.1)))
    # Not followed by the job: on from its beginning, the map would have to be.
    level, other = (dataclasses.replace(one, on=False) for one in (level, other))
    with_map, without = dataclasses.replace(ZERO, height_map=level), ZERO
    package = read_package(write(tmp_path / "map.gpx", setup=with_map))
    assert package.setup.height_map == level
    assert check_package(package, setup=with_map).valid
    for now in (other, dataclasses.replace(level, on=True), None):
        assert "GP825" in codes(check_package(package, setup=dataclasses.replace(ZERO, height_map=now)))
    package = read_package(write(tmp_path / "none.gpx", setup=without))
    assert check_package(package, setup=without).valid
    assert "GP825" in codes(check_package(package, setup=with_map))
    assert "GP825" in codes(check_package(package, setup=dataclasses.replace(ZERO, cylinder=CylinderMap(radius=5.0))))


# --- damage -------------------------------------------------------------------------------------------------


def damage(data: bytes, rng: random.Random) -> bytes:
    kind = rng.random()
    if kind < 0.25:
        return data[: rng.randrange(len(data))]
    out = bytearray(data)
    if kind < 0.75:
        for _ in range(rng.choice((1, 1, 1, 3, 20))):
            out[rng.randrange(len(out))] ^= 1 << rng.randrange(8)
    elif kind < 0.85:
        at = rng.randrange(len(out))
        del out[at : at + rng.randrange(1, 40)]
    elif kind < 0.95:
        at = rng.randrange(len(out))
        out[at:at] = rng.randbytes(rng.randrange(1, 40))
    else:
        out += rng.randbytes(rng.randrange(1, 200))
    return bytes(out)


def fuzz(source: Path, path: Path, seeds: range) -> None:
    data = source.read_bytes()
    for seed in seeds:
        spoilt = damage(data, random.Random(seed))
        if spoilt == data:
            continue
        path.write_bytes(spoilt)
        with pytest.raises(CertificateError) as caught:
            read_package(path)
        assert caught.value.finding.code.label in ("GP820", "GP821"), seed


def test_damaged_files_are_refused(signed: Path, tmp_path: Path) -> None:
    fuzz(signed, tmp_path / "spoilt.gpx", range(300))


@pytest.mark.soak
def test_damaged_files_are_refused_for_long(signed: Path, tmp_path: Path) -> None:
    fuzz(signed, tmp_path / "spoilt.gpx", range(300, 10_300))


def fuzz_sealed(source: Path, path: Path, seeds: range) -> int:
    """Damage below the seal and the hashes: what a forger without the key can do. How many could be read."""
    clean = members_of(source)
    readable = 0
    for seed in seeds:
        rng = random.Random(seed)
        members = dict(clean)
        name = rng.choice(sorted(members))
        members[name] = damage(members[name], rng) if members[name] else b"x"
        if members[name] == clean[name]:
            continue
        unsigned = rng.random() < 0.5 and name != "signature.json"
        if unsigned:
            del members["signature.json"]
        rebuilt(path, members, rehash=name not in ("body.json", "signature.json"))
        try:
            package = read_package(path)
        except CertificateError as error:
            assert error.finding.code.label in ("GP820", "GP821", "GP822", "GP857"), seed
            continue
        readable += 1
        check = check_package(package)
        # Unsigned, some damage is harmless within the bounds: a step a few ticks later, a name.
        assert unsigned or not check.valid, seed
    return readable


def test_forged_parts_are_refused(signed: Path, tmp_path: Path) -> None:
    assert fuzz_sealed(signed, tmp_path / "forged.gpx", range(400)) > 15


@pytest.mark.soak
def test_forged_parts_are_refused_for_long(signed: Path, tmp_path: Path) -> None:
    assert fuzz_sealed(signed, tmp_path / "forged.gpx", range(300, 10_300)) > 20


def edit(what: str, find: str, put: str) -> Callable[[Members], None]:
    def apply(members: Members) -> None:
        text = members[what].decode()
        assert find in text, text[:300]
        members[what] = text.replace(find, put, 1).encode()

    return apply


def counted(change: Callable[[list[int]], object]) -> Callable[[Members], None]:
    """Other numbers of runs in the first section."""

    def apply(members: Members) -> None:
        text = members["stream.ir"].decode()
        found = re.search(r"(\(StreamSection\s+number: 0\s+start: \[[^\]]*\]\s+runs: \[)([0-9 ]+)\]", text)
        assert found is not None, text
        counts = [int(word) for word in found[2].split()]
        change(counts)
        members["stream.ir"] = text.replace(found[0], f"{found[1]}{' '.join(map(str, counts))}]").encode()

    return apply


def edited_body(change: Callable[[dict[str, Any]], object]) -> Callable[[Members], None]:
    def apply(members: Members) -> None:
        body = json.loads(members["body.json"])
        change(body)
        members["body.json"] = canonical(body)

    return apply


def stream_of_other_job(members: Members) -> None:
    job = JOBS["square"]()
    stream = stream_of(step(job, machine()), machine())
    for name in [n for n in members if n.startswith("stream")]:
        del members[name]
    parts = packages.parts_of(machine(), ZERO, job.trace(), stream)
    members.update({n: d for n, d in parts.items() if n.startswith("stream")})


def run_changed(members: Members) -> None:
    """All steps of X a second later."""
    table = bytearray(members["stream/0.bin"])
    table[:8] = (int.from_bytes(table[:8], "little") + 16_000_000).to_bytes(8, "little")
    members["stream/0.bin"] = bytes(table)


EDITS: dict[str, Callable[[Members], None]] = {
    "limit widened": edit("machine.ir", "300.0", "400.0"),
    "resolution": edit("machine.ir", "80/1", "81/1"),
    "another start": edit("stream.ir", "[0 0 0 0]", "[0 0 0 1]"),
    "setup": edit("setup.ir", "0.0", "0.5"),
    "stream of another job": stream_of_other_job,
    "one interval": run_changed,
    "verdict": edited_body(lambda body: body["properties"][1].update(verdict="UNKNOWN")),
    "inputs": edited_body(lambda body: body.update(inputs=[])),
    "gproof version": edited_body(lambda body: body.update(gproof="9")),
    "format": edited_body(lambda body: body.update(format="other-certificate/2")),
    "properties no list": edited_body(lambda body: body.update(properties=7)),
    "property no object": edited_body(lambda body: body["properties"].append("limits")),
    "conditions no list": edited_body(lambda body: body["properties"][0].update(conditions=3)),
    "absurd condition": edited_body(
        lambda body: body["properties"][0].update(conditions=[{"terms": [["x", "y"]], "low": "1e999", "high": []}])
    ),
    "endless coefficient": edited_body(
        lambda body: body["properties"][0].update(
            conditions=[{"terms": [["g92.x", 10**400]], "low": "0", "high": "nan"}]
        )
    ),
    "comment": edit("signature.json", "bench 3", "bench 4"),
    "created": edit("signature.json", "2024", "2034"),
    "another spelling of the same signature": edit("signature.json", '=="', '=9"'),
    "a key more": edit("signature.json", '"comment"', '"a":1,"comment"'),
    "no signature left": edit("signature.json", '"signature"', '"sygnature"'),
}


@pytest.mark.parametrize("name", EDITS)
def test_edited_parts_with_fitting_hashes_are_refused(name: str, signed: Path, tmp_path: Path) -> None:
    members = members_of(signed)
    EDITS[name](members)
    assert refusal(rebuilt(tmp_path / "edited.gpx", members)) == ("GP820" if name == "format" else "GP822")


@pytest.mark.parametrize(
    "name", [n for n in EDITS if n not in ("inputs", "format", "gproof version", "setup", "limit widened")]
)
def test_edited_parts_are_refused_without_a_signature_too(name: str, signed: Path, tmp_path: Path) -> None:
    """Inputs, versions and the assumptions of who ran the checks are somebody's word: that is what the signature
    is for. All else is found out."""
    members = members_of(signed)
    EDITS[name](members)
    edited = members.pop("signature.json") == members_of(signed)["signature.json"]
    path = rebuilt(tmp_path / "edited.gpx", members)
    assert check_package(read_package(path)).valid != edited


MALFORMED: dict[str, tuple[Callable[[Members], object], str]] = {
    "no body": (lambda m: m.pop("body.json"), "GP820"),
    "no machine": (lambda m: m.pop("machine.ir"), "GP820"),
    "no table": (lambda m: m.pop("trace.bin"), "GP820"),
    "a table too many": (lambda m: m.update({"trace/0.bin": b""}), "GP820"),
    "half a row": (lambda m: m.update({"trace.bin": m["trace.bin"][:-1]}), "GP820"),
    "body no JSON": (lambda m: m.update({"body.json": b"{"}), "GP820"),
    "body no object": (lambda m: m.update({"body.json": b"[]"}), "GP820"),
    "body not canonical": (lambda m: m.update({"body.json": m["body.json"] + b"\n"}), "GP820"),
    "body deep": (lambda m: m.update({"body.json": b"[" * 100_000}), "GP820"),
    "body not UTF-8": (lambda m: m.update({"body.json": b"\xff\xfe"}), "GP820"),
    "body NaN": (lambda m: m.update({"body.json": b'{"members":NaN}'}), "GP820"),
    "body huge number": (lambda m: m.update({"body.json": b'{"members":' + b"9" * 5000 + b"}"}), "GP820"),
    "members no object": (lambda m: m.update({"body.json": b'{"members":[1]}'}), "GP820"),
    "a hash of the wrong kind": (
        edited_body(lambda body: body["members"].update({"trace.ir": 3})),
        "GP821",
    ),
    "signature no JSON": (lambda m: m.update({"signature.json": b"x"}), "GP820"),
    "machine of another type": (lambda m: m.update({"machine.ir": m["setup.ir"]}), "GP820"),
    "machine no text form": (lambda m: m.update({"machine.ir": b"(("}), "GP820"),
    "machine deep": (lambda m: m.update({"machine.ir": b"[" * 100_000}), "GP820"),
    "field of the wrong type": (edit("machine.ir", "AxisKind.LINEAR", '"linear"'), "GP820"),
    "an unknown enumeration": (edit("machine.ir", "AxisKind.LINEAR", "AxisKind.SPIRAL"), "GP857"),
    "division by zero": (edit("machine.ir", "80/1", "80/0"), "GP820"),
    "a field that has to be there": (edit("machine.ir", "kind: AxisKind.LINEAR", ""), "GP820"),
    "a field twice": (edit("machine.ir", "kind:", "kind: AxisKind.LINEAR kind:"), "GP820"),
    "a field without a name": (edit("machine.ir", "kind:", ""), "GP820"),
    "a field that is none": (edit("machine.ir", "kind:", "sort:"), "GP857"),
    "a type that is none": (edit("machine.ir", "(Axis", "(Achse"), "GP857"),
    "sections of numbers": (lambda m: m.update({"trace.ir": b'(Trace files: ["f"] sections: [1 2 3])'}), "GP820"),
    **{
        f"{what} for a table": (
            edit("trace.ir", "rows: 16", f"rows: {what}"), "GP857" if "nothing" in what else "GP820"
        )
        for what in (
            "(columns trace 99999999999)", "(columns nothing 0)", "(columns trace 0)", "15", "17", "0", "-16", "none",
            "16.0", "true", '"16"', "[16]", "99999999999", "9" * 600,
        )
    },
    "another number of runs": (counted(lambda counts: counts.__setitem__(0, counts[0] + 1)), "GP820"),
    "a table of runs less": (counted(lambda counts: counts.pop()), "GP820"),
    "a table of runs more": (counted(lambda counts: counts.append(0)), "GP820"),
}  # fmt: skip


@pytest.mark.parametrize("name", MALFORMED)
def test_malformed_packages_are_refused(name: str, unsigned: Path, tmp_path: Path) -> None:
    change, code = MALFORMED[name]
    members = members_of(unsigned)
    change(members)
    by_hand = name.startswith(("body", "members", "a hash"))
    assert refusal(rebuilt(tmp_path / "bad.gpx", members, rehash=not by_hand)) == code


def test_containers_that_are_none(unsigned: Path, tmp_path: Path) -> None:
    path = tmp_path / "bad.gpx"
    for data in (b"", b"PK", bytes(100), b"PK\x05\x06" + bytes(18), random.Random(1).randbytes(5000)):
        path.write_bytes(data)
        assert refusal(path) == "GP821"
    assert refusal(tmp_path / "nowhere.gpx") == "GP820"
    assert refusal(tmp_path) == "GP820"
    sealed = io.BytesIO(b"no zip at all" + b"0" * 64)
    seal(sealed)
    path.write_bytes(sealed.getvalue())
    assert refusal(path) == "GP820"
    with pytest.warns(UserWarning, match="Duplicate name"):
        rebuilt(path, members_of(unsigned), extra=("body.json", b"{}"))
    assert refusal(path) == "GP820"
    other = io.BytesIO()
    with zipfile.ZipFile(other, "w", zipfile.ZIP_LZMA) as archive:
        for name, data in members_of(unsigned).items():
            archive.writestr(name, data)
        archive.comment = b"sha256:" + b"0" * 64
    seal(other)
    path.write_bytes(other.getvalue())
    assert refusal(path) == "GP820"


def test_zip_bombs_are_not_unpacked(unsigned: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packages, "MEMBER_LIMIT", 1 << 20)
    monkeypatch.setattr(packages, "TEXT_LIMIT", 1 << 16)
    path = tmp_path / "bomb.gpx"
    for name, size in (("trace.bin", 2 << 20), ("machine.ir", 1 << 17)):
        assert refusal(rebuilt(path, members_of(unsigned) | {name: bytes(size)})) == "GP820"
    # A member that says it is small and is not: the local and the central header claim 10 bytes.
    rebuilt(path, members_of(unsigned) | {"machine.ir": bytes(1 << 15)})
    data = path.read_bytes().replace(struct.pack("<I", 1 << 15), struct.pack("<I", 10))
    buffer = io.BytesIO(data)
    seal(buffer)
    path.write_bytes(buffer.getvalue())
    assert refusal(path) == "GP820"


def test_a_stolen_signature_does_not_fit(signed: Path, tmp_path: Path, key: Any) -> None:
    other = write(tmp_path / "other.gpx", name="square", key=key)
    members = members_of(other) | {"signature.json": members_of(signed)["signature.json"]}
    assert refusal(rebuilt(tmp_path / "stolen.gpx", members)) == "GP822"


def test_types_are_checked_all_the_way_down() -> None:
    assert misfit(machine(), Machine) == ""
    assert "axes[0].name" in misfit(
        dataclasses.replace(machine(), axes=(dataclasses.replace(machine().axes[0], name=3),)),  # type: ignore[arg-type]
        Machine,
    )
    assert misfit(dataclasses.replace(machine(), unit=True), Machine)
    assert misfit(1, float) == ""
    assert misfit((("a", 1),), tuple[tuple[str, int], ...]) == ""
    assert misfit((("a", 1, 2),), tuple[tuple[str, int], ...])
    assert misfit({"a": 1.5}, dict[str, int])
    assert [bool(misfit(frozenset(one), frozenset[str])) for one in ((), ("a",), ("a", "b"), (1,))] == [
        False,
        False,
        False,
        True,
    ]


def test_package_keeps_what_was_hashed(signed: Path) -> None:
    package = read_package(signed)
    assert isinstance(package, Package)
    assert len(package.sha256) == 64
