"""The forgery kit: a right package with one thing changed, hashes and signature renewed, so that only meaning refuses.

Kinds are made from tables and types, not written one by one: every leaf of the Machine, the Setup, the Trace, the
stream and the body, with each change that fits its type; every column of every kind of row and of the runs; containers
and JSON spoilt on purpose. The forger's key is trusted here, and the machine and the setup are at hand, as on a board.
"""

from __future__ import annotations

import base64
import dataclasses
import enum
import json
import math
import random
import struct
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat
from support.spoiling import spoilt
from verify.package_files import BODY, SIGNATURE, Members, members_of, packed, rehashed, write, write_parts
from verify.reference_stepper import Job, machine, step, stream_of

from gproof.ir.columns import Columns
from gproof.ir.machine import Machine
from gproof.ir.setup import ZERO, Interval, Setup
from gproof.ir.stream import StepStream
from gproof.ir.trace import Edge, Op, State, Trace, Wait
from gproof.verify.certificate.check import check_package
from gproof.verify.certificate.keys import load_or_create_key
from gproof.verify.certificate.package import FORMAT, CertificateError, canonical, parts_of, read_package

FORGER = Ed25519PrivateKey.from_private_bytes(bytes(range(32)))
RAW = FORGER.public_key().public_bytes(Encoding.Raw, PublicFormat.Raw)
Path_ = tuple[Any, ...]
"""A place in a value: names of fields, numbers in sequences, keys of tables."""


@dataclass
class Parts:
    """What a package is made of; everything may be changed. order: (section, motor) tables stay where they are."""

    machine: Machine
    setup: Setup
    trace: Trace
    stream: StepStream
    body: dict[str, Any]


@dataclass(frozen=True)
class Kind:
    """One kind of damage. part: machine, setup, trace, ...; name: place and change; forge: changes the parts."""

    part: str
    name: str
    forge: Callable[[Parts], None]

    def __str__(self) -> str:
        return f"{self.part}: {self.name}"


# -- the right package: two sections, events of several kinds, lines, arcs, a helix, two frames, two states


def jobs() -> list[Job]:
    first = Job(states=[State(), State(tool=1, spindle=8000.0)])
    first.event(Op.SPINDLE, 1.0, 8000.0).event(Op.COOLANT, 0.0, 1.0).rapid(x=2, y=1).event(Op.DWELL, 0.05)
    first.line(z=-1, feed=600).event(Op.OUTPUT, 3.0, 1.0).line(x=4, y=2.2, a=10.0)
    first.arc((4.0, 1.2), -1, x=5, y=1.2).arc((4.0, 1.2), 1, x=4, y=2.2, z=-1.5)
    first.event(Op.SETPOINT, 2.0, 0.25).line(x=4.1).rapid(z=2).event(Op.STOP, 0.0)
    last = Job(first.here, states=list(first.states)).line(x=3, y=1).line(x=5).event(Op.SPINDLE, 0.0, 0.0)
    return [first, last.rapid(x=0, y=0, z=0, a=0.0).add(Op.END)]


SETUP = dataclasses.replace(
    ZERO, work={(1, "x"): Interval(0.0, 0.0), (2, "y"): Interval(1.0, 2.0)}, parameters={100: 2.0}, tool=1,
    tool_lengths={1: Interval(12.0, 12.0)}, optional_stop=False,
)  # fmt: skip


@cache
def right_members() -> Members:
    """The members of the right package, signed by the forger."""
    first, last = jobs()
    on, trace, other = machine(), first.trace(), last.trace()
    stream = stream_of(step(first, on), on)
    trace.sections[0].edges = (Edge(wait=Wait.OPERATOR, outcome="go on", target=1, line=1),)
    trace.sections.append(dataclasses.replace(other.sections[0], number=1))
    stream.sections.append(step(last, on).section(1))
    with tempfile.TemporaryDirectory() as folder:
        path = write_parts(Path(folder) / "right.gpx", on, SETUP, trace, stream, key=FORGER, created="now")
        return members_of(path)


def right() -> Parts:
    """Its parts, fresh as far as kinds change them in place."""
    kept = _kept()
    trace = dataclasses.replace(kept.trace, sections=[dataclasses.replace(one) for one in kept.trace.sections])
    stream = dataclasses.replace(kept.stream, sections=[dataclasses.replace(one) for one in kept.stream.sections])
    return Parts(kept.machine, kept.setup, trace, stream, dict(kept.body))


@cache
def _kept() -> Parts:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "right.gpx"
        path.write_bytes(packed(right_members(), how=zipfile.ZIP_STORED))
        package = read_package(path)
    return Parts(package.machine, package.setup, package.trace, package.stream, dict(package.body))


def signed(members: Members, **label: str) -> Members:
    """The members with a signature of the forger over the body as it is."""
    said = {
        "public_key": encoded(RAW),
        "signature": encoded(FORGER.sign(members[BODY])),
        "created": "now",
        "comment": "",
        **label,
    }
    return members | {SIGNATURE: canonical({**said, "label_signature": encoded(FORGER.sign(canonical(said)))})}


def encoded(raw: bytes) -> str:
    return base64.b64encode(raw).decode()


def forged(kind: Kind) -> bytes:
    """The bytes of the forged package; ValueError where the parts can not even be written."""
    parts = right()
    kind.forge(parts)
    members = parts_of(parts.machine, parts.setup, parts.trace, parts.stream)
    members[BODY] = canonical(parts.body)
    return packed(signed(rehashed(members)), how=zipfile.ZIP_STORED)


def answer(path: Path) -> set[str]:
    """Labels of all findings that keep the package at ``path`` from running; empty: it would run."""
    try:
        package = read_package(path)
    except CertificateError as error:
        return {error.finding.code.label}
    kept = _kept()
    check = check_package(package, kept.machine, kept.setup, [RAW])
    return set() if check.valid else {f.code.label for f in check.findings}


# -- changes by type


def leaves(value: Any, where: Path_ = ()) -> Iterator[tuple[Path_, Any]]:
    """Every place of a value that has no parts, and every sequence and table, with what stands there."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        for one in dataclasses.fields(value):
            yield from leaves(getattr(value, one.name), (*where, one.name))
    elif isinstance(value, Columns | np.ndarray):
        return
    elif isinstance(value, list | tuple):
        yield where, value
        for number, item in enumerate(value):
            yield from leaves(item, (*where, number))
    elif isinstance(value, dict):
        yield where, value
        for key, item in value.items():
            yield from leaves(item, (*where, key))
    else:
        yield where, value


def put(value: Any, where: Path_, new: Any) -> Any:
    """A copy of the value with another thing at a place."""
    if not where:
        return new
    head, rest = where[0], where[1:]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return dataclasses.replace(value, **{head: put(getattr(value, head), rest, new)})
    if isinstance(value, dict):
        return {key: put(item, rest, new) if key == head else item for key, item in value.items()}
    items = [put(item, rest, new) if number == head else item for number, item in enumerate(value)]
    return type(value)(items)


def changes(value: Any) -> dict[str, Any]:
    """What else may stand where this stands, by what the change is called; none is what was there."""
    out: dict[str, Any] = {}
    if isinstance(value, bool):
        out = {"flipped": not value}
    elif isinstance(value, enum.Enum):
        out = {f"is {other.name}": other for other in type(value) if other is not value}
    elif isinstance(value, int):
        out = {"one more": value + 1, "negated": -value, "zero": 0, "huge": 2**70, "2**63": 2**63}
    elif isinstance(value, float):
        out = {"half more": value + 0.5, "negated": -value, "zero": 0.0, "nan": math.nan, "inf": math.inf,
               "1e308": 1e308, "tiny": 1e-300}  # fmt: skip
    elif isinstance(value, Fraction):
        out = {"doubled": 2 * value, "negated": -value, "zero": Fraction(0), "huge": Fraction(10**400),
               "a part": value / 10**30}  # fmt: skip
    elif isinstance(value, str):
        out = {"other": value + "x", "empty": "", "escapes": "\x1b[31mSAFE", "long": "n" * 10_000}
    elif isinstance(value, list | tuple):
        kind = type(value)
        out = {"emptied": kind(()), "first lost": kind(value[1:]), "last twice": kind((*value, *value[-1:])),
               "turned round": kind(tuple(value)[::-1])}  # fmt: skip
    elif isinstance(value, dict):
        out = {"emptied": {}, "first lost": dict(list(value.items())[1:])}
    elif value is None:
        out = {"stated": 1.0, "named": "other", "true": True}
    if value is not None:
        out["lost"] = None
    return {name: new for name, new in out.items() if not _same(new, value)}


def _same(new: Any, old: Any) -> bool:
    """Equal, or both NaN; minus nothing is nothing."""
    return type(new) is type(old) and (new == old or repr(new) == repr(old))


def _at(where: Path_) -> str:
    return ".".join(str(one) for one in where) or "all"


def _of_type(part: str, value: Any) -> Iterator[Kind]:
    """Every change of every leaf of one part, an attribute of Parts."""
    for where, old in leaves(value):
        for name, new in changes(old).items():

            def forge(parts: Parts, where: Path_ = where, new: Any = new) -> None:
                setattr(parts, part, put(getattr(parts, part), where, new))

            yield Kind(part, f"{_at(where)} {name}", forge)


# -- tables: rows of the trace, runs and events of the stream

NUMBERS: dict[str, Callable[[Any], Any]] = {
    "one more": lambda v: v + 1,
    "one less": lambda v: v - 1,
    "a little more": lambda v: v + 0.25,
    "negated": lambda v: -v,
    "zero": lambda v: 0 * v,
    "largest": lambda v: np.iinfo(v.dtype).max if v.dtype.kind in "iu" else 1e308,
    "smallest": lambda v: np.iinfo(v.dtype).min if v.dtype.kind in "iu" else -1e308,
    "nan": lambda v: math.nan,
    "inf": lambda v: math.inf,
}
ROWS: dict[str, Callable[[int, int], list[int]]] = {
    "lost": lambda n, k: [i for i in range(n) if i != k],
    "twice": lambda n, k: [*range(k + 1), *range(k, n)],
    "before its neighbour": lambda n, k: [*range(max(k - 1, 0)), *[k, k - 1][: 1 + (k > 0)], *range(k + 1, n)],
}


def _taken(table: Columns, rows: list[int]) -> Columns:
    return Columns(table.schema, {c.name: table[c.name][rows] for c in table.schema.columns})


def _with(table: Columns, column: str, place: Any, value: Any) -> Columns:
    arrays = {c.name: table[c.name].copy() for c in table.schema.columns}
    with np.errstate(all="ignore"):
        arrays[column][place] = value
    return Columns(table.schema, arrays)


def _table_kinds(part: str, name: str, table: Columns, rows: list[tuple[str, int]], set_: Any) -> Iterator[Kind]:
    """Kinds for some rows of one table; set_(parts, table) puts a changed one where it belongs."""
    for label, row in rows:
        for how, order in ROWS.items():
            picked = order(len(table), row)
            if picked != list(range(len(table))):
                changed = _taken(table, picked)
                yield Kind(part, f"{name} {label} {how}", lambda p, t=changed: set_(p, t))  # type: ignore[misc]
        for column in table.schema.columns:
            for part_of in range(column.width):
                place = (row, part_of) if column.width > 1 else row
                old = table[column.name][place]
                for how, change in NUMBERS.items():
                    with np.errstate(all="ignore"):
                        new = change(old)
                    if old.dtype.kind in "iu":
                        bounds = np.iinfo(old.dtype)
                        if not math.isfinite(new) or int(new) != new or not bounds.min <= new <= bounds.max:
                            continue
                    if new == old:
                        continue
                    at = f"{column.name}[{part_of}]" if column.width > 1 else column.name
                    changed = _with(table, column.name, place, new)
                    yield Kind(part, f"{name} {label} {at} {how}", lambda p, t=changed: set_(p, t))  # type: ignore[misc]


def _rows(section: int) -> Iterator[Kind]:
    table = right().trace.sections[section].rows
    seen: dict[int, int] = {}
    for row, op in enumerate(table["op"].tolist()):
        seen.setdefault(op, row)

    def set_(parts: Parts, new: Columns) -> None:
        parts.trace.sections[section].rows = new

    yield from _table_kinds("rows", f"{section}", table, [(Op(op).name, row) for op, row in seen.items()], set_)
    for label, row in ((Op(op).name, row) for op, row in seen.items()):
        for op in Op:
            if int(op) != int(table["op"][row]):
                changed = _with(table, "op", row, int(op))
                yield Kind("rows", f"{section} {label} is {op.name}", lambda p, t=changed: set_(p, t))  # type: ignore[misc]


def _runs(section: int) -> Iterator[Kind]:
    stream = right().stream.sections[section]
    for motor, table in enumerate(stream.runs):
        picked = sorted({0, len(table) // 2, len(table) - 1}) if len(table) else []

        def set_(parts: Parts, new: Columns, motor: int = motor) -> None:
            runs = list(parts.stream.sections[section].runs)
            runs[motor] = new
            parts.stream.sections[section].runs = tuple(runs)

        yield from _table_kinds("runs", f"{section}/{motor}", table, [(f"run {k}", k) for k in picked], set_)

    def events(parts: Parts, new: Columns) -> None:
        parts.stream.sections[section].events = new

    found = [(f"event {k}", k) for k in range(len(stream.events))]
    yield from _table_kinds("events", f"{section}", stream.events, found, events)


# -- whole parts against one another


def _wholes() -> Iterator[Kind]:
    def swapped(parts: Parts) -> None:
        one, two = parts.stream.sections
        parts.stream.sections = [dataclasses.replace(two, number=0), dataclasses.replace(one, number=1)]

    def motors(parts: Parts) -> None:
        for section in parts.stream.sections:
            section.runs = section.runs[1::-1] + section.runs[2:]

    def merged(parts: Parts) -> None:
        parts.trace.sections = parts.trace.sections[:1]
        parts.stream.sections = parts.stream.sections[:1]

    def nothing(parts: Parts) -> None:
        parts.trace.sections, parts.stream.sections = [], []

    def still(parts: Parts) -> None:
        for section in parts.stream.sections:
            section.runs = tuple(_taken(table, []) for table in section.runs)

    def silent(parts: Parts) -> None:
        for section in parts.stream.sections:
            section.events = _taken(section.events, [])

    def mirrored(parts: Parts) -> None:
        for section in parts.stream.sections:
            section.runs = tuple(
                Columns(
                    t.schema, {c.name: -t[c.name] if c.name == "direction" else t[c.name] for c in t.schema.columns}
                )
                for t in section.runs
            )

    def faster(parts: Parts) -> None:
        for section in parts.stream.sections:
            section.runs = tuple(
                Columns(t.schema, {c.name: t[c.name] // 2 if c.name in ("interval", "add") else t[c.name]
                                   for c in t.schema.columns})
                for t in section.runs
            )  # fmt: skip

    wholes = (swapped, motors, merged, nothing, still, silent, mirrored, faster)
    yield from (Kind("stream", f"whole {one.__name__}", one) for one in wholes)


@cache
def kinds() -> tuple[Kind, ...]:
    """All kinds of semantic damage, in one order."""
    parts = right()
    body = {key: value for key, value in parts.body.items() if key not in ("members", "sizes")}
    found = [
        *_of_type("machine", parts.machine), *_of_type("setup", parts.setup), *_of_type("trace", parts.trace),
        *_of_type("stream", parts.stream), *_of_body(body), *_rows(0), *_rows(1), *_runs(0), *_runs(1), *_wholes(),
    ]  # fmt: skip
    return tuple({str(kind): kind for kind in found}.values())


def _of_body(body: dict[str, Any]) -> Iterator[Kind]:
    """Every leaf of the body, and keys more or less."""
    for where, old in leaves(body):
        for name, new in changes(old).items():
            if isinstance(new, float) and not math.isfinite(new):
                continue

            def forge(parts: Parts, where: Path_ = where, new: Any = new) -> None:
                parts.body = put(parts.body, where, new) if where else {"members": {}, **(new or {})}

            yield Kind("body", f"{_at(where)} {name}", forge)
    for key in body:
        yield Kind("body", f"without {key}", lambda p, key=key: p.body.pop(key))  # type: ignore[misc]
    yield Kind("body", "with a key more", lambda p: p.body.update(more=1))
    yield Kind("body", "an older format", lambda p: p.body.update(format="gproof-certificate/0"))
    yield Kind("body", "a newer format", lambda p: p.body.update(format=FORMAT[:-1] + "9"))


# -- containers, signatures and JSON


def _json(name: str, change: Callable[[dict[str, Any]], object]) -> Callable[[Members], bytes]:
    def forge(members: Members) -> bytes:
        value = json.loads(members[name])
        change(value)
        return packed(members | {name: canonical(value)})

    return forge


def _raw(name: str, change: Callable[[bytes], bytes], *, rehash: bool = True) -> Callable[[Members], bytes]:
    def forge(members: Members) -> bytes:
        changed = members | {name: change(members[name])}
        return packed(signed(rehashed(changed)) if rehash and name not in (BODY, SIGNATURE) else changed)

    return forge


RAWS: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda d: b"", "half": lambda d: d[: len(d) // 2], "a byte less": lambda d: d[:-1],
    "a byte more": lambda d: d + b"\n", "twice": lambda d: d * 2, "zeros": lambda d: bytes(len(d)),
    "UTF-16": lambda d: d.decode("latin-1").encode("utf-16"), "a mark": lambda d: b"\xef\xbb\xbf" + d,
    "not UTF-8": lambda d: b"\xff" + d[1:], "deep brackets": lambda d: b"[" * 100_000,
    "deep parentheses": lambda d: b"(" * 100_000, "a number without end": lambda d: b"9" * 100_000,
    "another case": lambda d: d.swapcase(),
}  # fmt: skip


@cache
def containers() -> dict[str, Callable[[Members], bytes]]:
    """Kinds of damage to container, signature and JSON, from the members of the right package to bytes of a file."""
    found: dict[str, Callable[[Members], bytes]] = {}
    members = right_members()
    for name in (BODY, SIGNATURE, "machine.ir", "setup.ir", "trace.ir", "stream.ir"):
        for how, change in RAWS.items():
            found[f"{name} {how}"] = _raw(name, change)
    for name in ("trace.bin", "stream/0.bin", "stream/events.bin"):
        for how in ("empty", "a byte less", "a byte more", "half"):
            found[f"{name} {how}"] = _raw(name, RAWS[how])
    for name in sorted(members):
        found[f"{name} missing"] = lambda m, name=name: packed({k: v for k, v in m.items() if k != name})  # type: ignore[misc]
        if name not in (BODY, SIGNATURE):
            found[f"{name} changed, the hash not"] = lambda m, name=name: packed(m | {name: m[name] + b" " * 46})  # type: ignore[misc]
    for key in ("public_key", "signature", "label_signature"):
        for how, text in {
            "empty": "", "no base64": "??", "zeros": encoded(bytes(32)), "short": encoded(bytes(5)),
            "long": encoded(bytes(4000)), "one": encoded(b"\1" + bytes(31)),
        }.items():  # fmt: skip
            found[f"{key} {how}"] = _json(SIGNATURE, lambda v, key=key, text=text: v.update({key: text}))  # type: ignore[misc]
        found[f"{key} missing"] = _json(SIGNATURE, lambda v, key=key: v.pop(key))  # type: ignore[misc]
        for what in (None, 7, [], {}):
            found[f"{key} is {what!r}"] = _json(SIGNATURE, lambda v, key=key, what=what: v.update({key: what}))  # type: ignore[misc]
    for key in ("created", "comment"):
        found[f"{key} changed"] = _json(SIGNATURE, lambda v, key=key: v.update({key: "2099"}))  # type: ignore[misc]
    found["a key more beside the signature"] = _json(SIGNATURE, lambda v: v.update(more="x"))
    found["the body changed, signature kept"] = _json(BODY, lambda v: v.update(job="other.cnc"))
    for name, text in {
        "keys twice": b'{"a":1,"a":2}', "blanks": b'{ "members": {} }', "NaN": b'{"members":NaN}',
        "no object": b"[]", "text": b'"x"', "null": b"null", "members a list": b'{"members":[]}',
        "members a number": b'{"members":1}', "no members": b"{}", "infinity": b'{"members":Infinity}',
        "a surrogate": b'{"members":"\\ud800"}', "1e999": b'{"members":1e999}',
    }.items():  # fmt: skip
        found[f"body {name}"] = lambda m, text=text: packed(m | {BODY: text})  # type: ignore[misc]
        found[f"signature {name}"] = lambda m, text=text: packed(m | {SIGNATURE: text})  # type: ignore[misc]
    for name in ("x.bin", "trace/0.bin", "stream/00.bin", "../up.ir", "/etc/passwd", "BODY.JSON", "a" * 5000,
                 "stream/9.bin"):  # fmt: skip
        found[f"a member {name[:20]} more"] = lambda m, name=name: packed(signed(rehashed(m | {name: b"x"})))  # type: ignore[misc]
        found[f"a member {name[:20]} unlisted"] = lambda m, name=name: packed(m | {name: b"x"})  # type: ignore[misc]
    for how, method in {"bzip2": zipfile.ZIP_BZIP2, "lzma": zipfile.ZIP_LZMA}.items():
        found[f"packed by {how}"] = lambda m, method=method: packed(m, how=method)  # type: ignore[misc]
    found["nothing"] = lambda m: b""
    found["an unsealed zip"] = lambda m: packed(m)[:-64] + b"0" * 64
    found["a byte of the seal"] = lambda m: packed(m)[:-1] + b"x"
    found["bytes before the zip"] = lambda m: b"#!/bin/sh\n" + packed(m)
    found["bytes behind the zip"] = lambda m: packed(m) + b"\n"
    found["a directory cut short"] = lambda m: packed(m)[:-200] + packed(m)[-64:]
    return found


# -- random damage


@cache
def packages() -> tuple[Members, ...]:
    """The members of a few right packages."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        key = load_or_create_key(folder / "key.pem")
        made = [write(folder / f"{job}.gpx", name=job, key=key) for job in ("events", "square", "arcs")]
        return tuple(members_of(path) for path in made)


def spoilt_package(rng: random.Random, seeds: Sequence[bytes]) -> bytes:
    """A member changed, lost, doubled or exchanged, with hashes and seal that fit; sometimes the container itself."""
    kept = rng.choice(packages())
    members = dict(kept)
    for _ in range(rng.choice((1, 1, 2, 4))):
        name = rng.choice(sorted(members)) if members else BODY
        kind = rng.randrange(12)
        if kind == 0:
            members.pop(name, None)
        elif kind == 1:
            members[name] = rng.choice(list(kept.values()))
        elif kind == 2:
            members[rng.choice((name + "x", "../x", " ", "trace/1.bin", "stream/9.bin", "a" * 300))] = b"x"
        elif name.endswith(".bin"):
            members[name] = spoilt_table(rng, members[name])
        else:
            others = [one[name] for one in packages() if name in one] or [b"{}"]
            members[name] = spoilt(rng, [members.get(name, b""), *others])
            if name.endswith(".json") and rng.random() < 0.8:
                with suppress(ValueError, RecursionError):
                    members[name] = canonical(json.loads(members[name]))
    if rng.random() < 0.85:
        with suppress(Exception):
            members = rehashed(members)
    if rng.random() < 0.6:
        members.pop(SIGNATURE, None)
    elif rng.random() < 0.7 and BODY in members:
        members = signed(members)
    data = packed(members, how=0)
    if rng.random() < 0.1:
        data = spoilt_table(rng, data)
    return data


WORDS = [
    struct.pack("<d", value)
    for value in (float("nan"), float("inf"), -float("inf"), 1e308, -1e308, 5e-324, -0.0, 1.0, 1e15, 1e-300)
] + [
    struct.pack("<q", value) for value in (0, 1, -1, 2**31, 2**31 - 1, -(2**31), 2**53 + 1, 2**62, 2**63 - 1, -(2**63))
]


def spoilt_table(rng: random.Random, data: bytes) -> bytes:
    """A table of numbers with another number at an aligned place, or rows more or less, or any bytes changed."""
    kind = rng.randrange(6)
    if kind < 3 and len(data) >= 8:
        at = rng.randrange(len(data) // 8) * 8
        return data[:at] + rng.choice(WORDS) + data[at + 8 :]
    if kind == 3:
        return data * 2 if rng.random() < 0.5 else data[: len(data) // 2]
    if kind == 4:
        return data[: rng.randrange(len(data) + 1)]
    out = bytearray(data or b"x")
    for _ in range(rng.choice((1, 3, 20))):
        out[rng.randrange(len(out))] = rng.randrange(256)
    return bytes(out)
