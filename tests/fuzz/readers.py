"""Every reader of files that somebody else wrote: which file is spoilt, with which seeds, and how it is read.

``read`` is the function of the library that commands call; ``words`` the command that judges a whole job with it.
What a reader may raise for a bad file is caught here; anything else is the test's failure.
"""

from __future__ import annotations

import functools
import hashlib
import io
import json
import random
import struct
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass, field
from pathlib import Path

from support.bundles import unpacked
from support.spoiling import spoilt
from verify.forgery import spoilt_package

from gproof.backend.record_parse import is_record, parse_signed
from gproof.cli.dump import loaded
from gproof.cli.telling import tell, tell_findings_of
from gproof.driver.dialects import load_machine, load_setup
from gproof.driver.errors import UsageError
from gproof.driver.jobs import find_jobs
from gproof.driver.policy import load_policy
from gproof.driver.suppressions import read_baseline
from gproof.frontend.eding.load import load_program as load_eding
from gproof.frontend.mcuwin.load import load_program as load_mcuwin
from gproof.frontend.mcuwin.machine import NO_MCUWIN
from gproof.frontend.wincnc.load import load_program as load_wincnc
from gproof.frontend.wincnc.mac_program import load_macro_file
from gproof.frontend.wincnc.machine import NO_SHOP
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine
from gproof.ir.program import Program
from gproof.verify.certificate.package import CertificateError, canonical, read_package

ROOT = Path(__file__).resolve().parents[2]
SMALL = 6_000
"""Bytes of a seed at most."""


@functools.cache
def _files(*patterns: str) -> tuple[bytes, ...]:
    """Right files of the corpus and of the documented programs."""
    found = (path for pattern in patterns for path in sorted(_root(pattern).glob(pattern)))
    return tuple(dict.fromkeys(path.read_bytes() for path in found if 0 < path.stat().st_size < SMALL))


def _root(pattern: str) -> Path:
    """Where its files are: pages as folders (support/bundles.py)."""
    trees = [tree for tree in ("tests/hand", "docs/codes") if pattern.startswith(f"{tree}/")]
    return unpacked(trees[0]).parents[len(Path(trees[0]).parts) - 1] if trees else ROOT


@dataclass(frozen=True)
class Reader:
    """One kind of file.

    name: of the file that is spoilt; cases: of a million; seeds: right files; around: the files beside it; words: a
    command that reads it; make: spoils one (default: any of the changes of support/spoiling.py).
    """

    name: str
    cases: int
    seeds: Callable[[], Sequence[bytes]]
    read: Callable[[Path], None]
    around: dict[str, bytes] = field(default_factory=dict)
    words: tuple[str, ...] = ()
    make: Callable[[random.Random, Sequence[bytes]], bytes] = spoilt


def _told(findings: Findings) -> None:
    """Each finding has words and a place, and none is an endless list."""
    for finding in findings.kept:
        assert finding.message
        assert finding.span.line >= 0


def _program(program: Program | None, findings: Findings) -> None:
    if program is not None:
        program.verify()
        loaded(program)
    _told(findings)


def _eding(path: Path) -> None:
    findings = Findings()
    _program(load_eding(path.with_name("job.cnc"), findings), findings)


def _wincnc(path: Path) -> None:
    findings = Findings()
    _program(load_wincnc(path.with_name("job.tap"), findings, NO_SHOP), findings)


def _wincnc_macros(path: Path) -> None:
    _wincnc(path)
    findings = Findings()
    _program(load_macro_file(path, findings), findings)


def _mcuwin(path: Path) -> None:
    findings = Findings()
    _program(load_mcuwin(path.with_name("job.src"), findings, NO_MCUWIN), findings)


def _of_machine(machine: Machine | None, findings: Findings) -> None:
    if machine is not None:
        machine.verify()
    else:
        assert findings.kept, "refused without a finding"
    _told(findings)


def _machine(path: Path) -> None:
    findings = Findings()
    top = path.with_name("machine.toml")
    machine, files = load_machine(top if top.exists() else path, findings)
    _of_machine(machine, findings)
    assert all(len(digest) in (0, 64) for _, digest in files)


def _setup(path: Path) -> None:
    findings = Findings()
    setup, _ = load_setup(path.with_name("setup.toml"), findings)
    assert setup is not None or findings.kept, "refused without a finding"
    _told(findings)


def _quietly(read: Callable[[Path], object]) -> Callable[[Path], None]:
    """A reader of the command line, which prints its findings and raises what ends the command in one line."""

    def quiet(path: Path) -> None:
        out = io.StringIO()
        with redirect_stderr(out), redirect_stdout(out):
            try:
                read(path)
            except UsageError as error:
                tell_findings_of(error)

    return quiet


def _policy(path: Path) -> object:
    return load_policy(path, tell)


def _job_file(path: Path) -> object:
    return find_jobs([str(path)], tell, machine=None, setup=None, dialect=None)


def _package(path: Path) -> None:
    try:
        read_package(path)
    except CertificateError as error:
        assert error.finding.code.label in ("GP820", "GP821", "GP822", "GP857")
        assert "MemoryError" not in error.finding.message


def _record(path: Path) -> None:
    data = path.read_bytes()
    is_record(data)
    with suppress(ValueError):
        parse_signed(data)


# -- the files around, and seeds that the corpus has none of

MACHINE = b"""schema = "gproof-machine/1"
units = "mm"
[axes]
x = {min = -100, max = 300, max_velocity = 100, max_acceleration = 500, steps_per_unit = 320}
y = {min = -100, max = 200, max_velocity = 100, max_acceleration = 500, steps_per_unit = 320}
z = {min = -100, max = 100, travel_min = -110, travel_max = 110}
a = {min = -360, max = 360}
[areas.tool_change]
x = [40, 60]
y = [40, 60]
[tools.1]
length = 12.5
diameter = 6.0
"""
BASED = b'schema = "gproof-machine/1"\nunits = "mm"\nbase = "cnc.ini"\n'
PITCHED = b"[JOINT_0]\nname = X\npitchCompensationOn = 1\npitchCompensationFileName = x.cor\n"
SETUP = b"""schema = "gproof-setup/1"
start = {x = 1.0, y = 2.0, z = 30.0}
active_work = 1
tool = 1
work.1 = {x = 10.0, y = [5.0, 8.0], z = 0.0}
[parameters]
1 = 5.0
5161 = [0.0, 1.0]
[height_map]
file = "map.txt"
[stock]
box = [[0, 0, -10], [60, 50, 0]]
[[part]]
dxf = "plate.dxf"
layers = {OUTLINE = {bottom = -10, top = 0}}
[[fixtures]]
stl = "body.stl"
rotate = 30
shift = [1, 2, 3]
"""
POLICY = b"""schema = "gproof-policy/1"
properties = ["language", "limits", "areas", "arcs", "feeds"]
fail_on = "warning"
strict = true
[severity]
GP243 = "off"
"GP304" = "error"
"""
JOB_FILE = b"""schema = "gproof-job/1"
job = ["job.cnc", "*.tap"]
machine = "machine.toml"
setup = "zero"
also = ["cutting", "feeds"]
strict = false
[[jobs]]
job = "job.cnc"
dialect = "eding"
policy = "policy.toml"
"""
BASELINE = json.dumps({
    "schema": "gproof-baseline/1",
    "files": {"job.cnc": [{"fingerprint": "0123abcd", "code": "GP243", "message": "a word"}], "b.tap": []},
}).encode()  # fmt: skip
JOB = b"G21 G90 G94\nG0 X1 Y2\nG1 Z-1 F100\ngosub user_1\nG2 X3 Y2 I1 J0\nM30\n"
TAP = b"G21 G90\nL21\nG0 X1 Y2\nMYMACRO X5\nG1 Z-1 F100\nM98 Phole.tap\nG53 Z\nM30\n"
SRC = b"{$I names.inc}\n%MAIN\nG0 X1 Y2\nG1 Z-1 F100\nM98 L7\nM30\n%\n%7\nG0 X0\nM17\n%\n"
MAP = b"; x y z\n0 0 0.1\n10 0 0.2\n0 10 0.0\n10 10 -0.1\n"
COMPENSATION = b"; position calibrated\n0 0\n100 100.02\n200.5 200.4\n"
STEPS = b"facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 10 0 0\nvertex 0 10 0\nendloop\nendfacet\n"
TRIANGLES = [((0, 0, 0), (0, 10, 0), (10, 0, 0)), ((0, 0, 0), (10, 0, 0), (0, 0, 10)),
             ((10, 0, 0), (0, 10, 0), (0, 0, 10)), ((0, 0, 0), (0, 0, 10), (0, 10, 0))]  # fmt: skip
BINARY = bytes(80) + struct.pack("<I", 4) + b"".join(
    struct.pack("<12fH", 0, 0, 0, *(value for corner in facet for value in corner), 0) for facet in TRIANGLES
)  # fmt: skip
ASCII = b"solid a\n" + b"".join(
    b"facet normal 0 0 0\nouter loop\n" + b"".join(b"vertex %g %g %g\n" % corner for corner in facet)
    + b"endloop\nendfacet\n" for facet in TRIANGLES
) + b"endsolid a\n"  # fmt: skip
_PAIRS = {
    "LINE": "8 OUTLINE 10 {0} 20 {1} 11 {2} 21 {3}", "ARC": "8 OUTLINE 10 0 20 0 40 5 50 0 51 180",
    "CIRCLE": "8 OUTLINE 10 {0} 20 {1} 40 4", "ELLIPSE": "8 OUTLINE 10 1 20 2 11 4 21 1 40 0.5 41 0 42 6.283185307",
    "LWPOLYLINE": "8 OUTLINE 90 3 70 1 10 0 20 0 42 0.3 10 9 20 0 10 9 20 9",
    "SPLINE": "8 OUTLINE 70 8 71 3 72 8 73 4" + " 40 0" * 4 + " 40 1" * 4 + " 10 0 20 0 10 3 20 4 10 6 20 4 10 9 20 0",
    "INSERT": "8 OUTLINE 2 B 10 5 20 5 41 2 42 2 50 30 70 2 71 2 44 20 45 20",
    "POLYLINE": "8 OUTLINE 66 1 70 1 0 VERTEX 8 OUTLINE 10 0 20 0 0 VERTEX 8 OUTLINE 10 5 20 0 42 1 0 SEQEND",
}  # fmt: skip


def _drawing(*entities: str) -> bytes:
    head = (
        "0 SECTION 2 HEADER 9 $INSUNITS 70 4 0 ENDSEC 0 SECTION 2 BLOCKS 0 BLOCK 2 B 10 0 20 0 0 CIRCLE 8 0 10 0 20 0"
    )
    head += " 40 1 0 ENDBLK 0 ENDSEC 0 SECTION 2 ENTITIES"
    square = [_PAIRS["LINE"].format(*ends) for ends in ((0, 0, 50, 0), (50, 0, 50, 40), (50, 40, 0, 40), (0, 40, 0, 0))]
    body = " ".join(f"0 LINE {line}" for line in square) if not entities else ""
    body += "".join(f" 0 {name} {_PAIRS[name].format(20, 20, 30, 30)}" for name in entities)
    return ("\n".join(f"{head} {body} 0 ENDSEC 0 EOF".split()) + "\n").encode()


@functools.cache
def _drawings() -> tuple[bytes, ...]:
    return (*_files("corpus/**/*.dxf"), _drawing(), *(_drawing(name) for name in _PAIRS), _drawing(*_PAIRS))


@functools.cache
def _toml(schema: str) -> tuple[bytes, ...]:
    return tuple(text for text in _files("corpus/**/*.toml", "docs/codes/**/*.toml") if schema.encode() in text)


@functools.cache
def _inis(word: bytes) -> tuple[bytes, ...]:
    return tuple(text for text in _files("corpus/**/*.ini", "corpus/**/*.INI", "docs/codes/**/*.ini",
                                         "docs/codes/**/*.INI", "tests/hand/**/*.INI", "tests/hand/**/*.ini")
                 if word.lower() in text.lower())  # fmt: skip


@functools.cache
def _records() -> tuple[bytes, ...]:
    return tuple(path.read_bytes() for path in sorted((ROOT / "tests/backend/records").glob("*.json")))


def spoilt_record(rng: random.Random, seeds: Sequence[bytes]) -> bytes:
    """A record with a hash that fits what it says now, where it is still an object."""
    data = spoilt(rng, seeds)
    if rng.random() < 0.7:
        with suppress(ValueError, RecursionError, AttributeError, TypeError, KeyError):
            value = json.loads(data)
            del value["sha256"]
            certificate = bytes.fromhex(value["certificate"])
            value["sha256"] = hashlib.sha256(certificate + canonical(value)).hexdigest()
            data = canonical(value)
    return data


CHECK = ("check", "--max-blocks", "400", "--max-branches", "16")
WITH_SETUP = (*CHECK, "job.cnc", "--machine", "machine.toml", "--setup", "setup.toml", "--dialect", "eding")
READERS: dict[str, Reader] = {
    "eding program": Reader(
        "job.cnc", 140_000, lambda: _files("docs/codes/*/*.cnc", "corpus/eding/*/job.cnc"), _eding,
        {"machine.toml": MACHINE, "macro.cnc": b"sub user_1\nG0 X5\nendsub\n"},
        (*CHECK, "job.cnc", "--machine", "machine.toml", "--setup", "zero", "--dialect", "eding", "--also", "feeds"),
    ),
    "eding macros": Reader(
        "macro.cnc", 80_000, lambda: _files("docs/codes/*/macro.cnc", "corpus/eding/*/macro.cnc", "docs/codes/*/*.cnc"),
        _eding, {"job.cnc": JOB}, (*CHECK, "job.cnc", "--dialect", "eding"),
    ),
    "wincnc program": Reader(
        "job.tap", 140_000,
        lambda: _files("docs/codes/*/*.tap", "tests/hand/wincnc/**/*.TAP", "corpus/wincnc/**/*.tap"),
        _wincnc, {"WINCNC.INI": b"Version=2.5.08\nAxis1=X\n"}, (*CHECK, "job.tap", "--dialect", "wincnc"),
    ),
    "wincnc macros": Reader(
        "CNC.MAC", 60_000, lambda: _files("docs/codes/**/*.MAC", "tests/hand/**/*.MAC", "corpus/wincnc/**/*.MAC"),
        _wincnc_macros, {"job.tap": TAP}, (*CHECK, "job.tap", "--dialect", "wincnc"),
    ),
    "wincnc macro file": Reader(
        "hole.tap", 40_000, lambda: _files("docs/codes/*/*.tap", "corpus/wincnc/**/*.mac", "corpus/wincnc/**/*.MAC"),
        _wincnc, {"job.tap": TAP, "CNC.MAC": b"[mymacro]\nM98 Phole.tap\n"}, (*CHECK, "job.tap", "--dialect", "wincnc"),
    ),
    "mcuwin program": Reader(
        "job.src", 140_000,
        lambda: _files("docs/codes/*/*.src", "tests/hand/mcuwin/**/*.din", "corpus/mcuwin/**/*.din"),
        _mcuwin, {"names.inc": b"const a = 3;\n"}, (*CHECK, "job.src", "--dialect", "mcuwin"),
    ),
    "mcuwin include": Reader(
        "names.inc", 60_000,
        lambda: _files("corpus/**/*.inc", "tests/hand/**/*.inc", "docs/codes/**/*.inc", "docs/codes/*/*.src",
                       "tests/hand/mcuwin/**/*.din"),
        _mcuwin, {"job.src": SRC}, (*CHECK, "job.src", "--dialect", "mcuwin"),
    ),
    "eding ini": Reader(
        "cnc.ini", 50_000, lambda: _inis(b"[JOINT_"), _machine, {"job.cnc": JOB},
        (*CHECK, "job.cnc", "--machine", "cnc.ini", "--dialect", "eding"),
    ),
    "wincnc ini": Reader(
        "WINCNC.INI", 50_000, lambda: _inis(b"axisspec") + _files("docs/codes/**/WINCNC.INI"), _machine,
        {"job.tap": TAP}, (*CHECK, "job.tap", "--machine", "WINCNC.INI"),
    ),
    "mcuwin ini": Reader(
        "McuWIN.ini", 30_000, lambda: _files("corpus/**/McuWIN.ini", "docs/codes/**/McuWIN.ini"), _machine,
        {"job.src": SRC},
        (*CHECK, "job.src", "--machine", "McuWIN.ini"),
    ),
    "mcuwin tools": Reader(
        "ToolComp.INI", 20_000,
        lambda: _files("corpus/**/ToolComp.INI", "docs/codes/**/ToolComp.INI", "tests/hand/**/ToolComp.INI"), _machine,
        {"job.src": SRC, "machine.toml": b'schema = "gproof-machine/1"\nunits = "mm"\n'
         b'[controller]\ndialect = "mcuwin"\n[din]\ntool_file = "ToolComp.INI"\n'},
        (*CHECK, "job.src", "--machine", "machine.toml"),
    ),
    "machine": Reader(
        "machine.toml", 40_000, lambda: (MACHINE, *_toml("gproof-machine/1")), _machine,
        {"job.cnc": JOB, "cnc.ini": b"[JOINT_0]\nname = X\n"},
        (*CHECK, "job.cnc", "--machine", "machine.toml", "--setup", "zero", "--dialect", "eding", "--also", "all"),
    ),
    "setup": Reader(
        "setup.toml", 40_000, lambda: (SETUP, *_toml("gproof-setup/1")), _setup,
        {"job.cnc": JOB, "machine.toml": MACHINE, "map.txt": MAP, "plate.dxf": _drawing(), "body.stl": ASCII},
        (*WITH_SETUP, "--also", "all"),
    ),
    "policy": Reader("policy.toml", 15_000, lambda: (POLICY,), _quietly(_policy), {"job.cnc": JOB},
                     (*CHECK, "job.cnc", "--dialect", "eding", "--policy", "policy.toml")),
    "job file": Reader("list.toml", 15_000, lambda: (JOB_FILE,), _quietly(_job_file),
                       {"job.cnc": JOB, "job.tap": TAP, "machine.toml": MACHINE, "policy.toml": POLICY},
                       (*CHECK, "list.toml")),
    "baseline": Reader("known.json", 15_000, lambda: (BASELINE,), _quietly(read_baseline), {"job.cnc": JOB},
                       (*CHECK, "job.cnc", "--dialect", "eding", "--baseline", "known.json")),
    "height map": Reader("map.txt", 5_000, lambda: (MAP,), _setup, {
        "setup.toml": b'schema = "gproof-setup/1"\n[height_map]\nfile = "map.txt"\n'}),
    "correction table": Reader("x.cor", 5_000, lambda: (COMPENSATION,), _machine, {
        "machine.toml": BASED, "cnc.ini": PITCHED}),
    "drawing": Reader("plate.dxf", 10_000, _drawings, _setup, {
        "job.cnc": JOB, "machine.toml": MACHINE,
        "setup.toml": b'schema = "gproof-setup/1"\n[stock]\ndxf = "plate.dxf"\nbottom = -10\ntop = 0\n'}, WITH_SETUP),
    "mesh": Reader("body.stl", 10_000, lambda: (ASCII, BINARY, STEPS), _setup, {
        "job.cnc": JOB, "machine.toml": MACHINE,
        "setup.toml": b'schema = "gproof-setup/1"\n[[fixtures]]\nstl = "body.stl"\n'}, (*WITH_SETUP, "--also", "all")),
    "package": Reader("job.gpx", 25_000, lambda: (b"",), _package, {}, ("verify", "job.gpx"), spoilt_package),
    "record": Reader("record.json", 10_000, _records, _record, {}, (), spoilt_record),
}  # fmt: skip
"""Every reader, a million cases together."""
