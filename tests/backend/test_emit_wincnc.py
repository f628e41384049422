"""WinCNC text printed back: the same Program, the same Trace, the same lines; printing twice changes nothing."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import pytest
from support.goldens import ROOT

from gproof.backend.emit.wincnc import emit
from gproof.frontend.machine_file import load_machine
from gproof.frontend.wincnc.load import load_alone
from gproof.frontend.wincnc.machine import NO_SHOP
from gproof.ir.controls import Lexical
from gproof.ir.finding import Findings, Severity, Span
from gproof.ir.machine import Machine
from gproof.ir.program import BlockTable, DeferredBlock, Program
from gproof.ir.same import difference

SHOPS = [
    folder
    for parent in ("tests/hand/wincnc", "corpus/wincnc", "docs/codes")
    for folder in sorted((ROOT / parent).iterdir())
    if any(folder.glob("*.tap")) or any(folder.glob("*/*.tap"))
]


def with_lexical(lexical: Lexical) -> Machine:
    controller = NO_SHOP.controller
    controls = dataclasses.replace(controller.controls, lexical=lexical)
    return dataclasses.replace(NO_SHOP, controller=dataclasses.replace(controller, controls=controls))


def machine_of(shop: Path) -> Machine:
    path = shop / "WINCNC.INI"
    machine = load_machine(path, Findings())[0] if path.is_file() else NO_SHOP
    assert machine is not None
    return machine


def read(folder: Path, data: bytes, machine: Machine, folders: list[Path], name: str = "job.tap") -> Program | None:
    """The program in ``data``, or None when it has mistakes."""
    path = folder / name
    path.write_bytes(data)
    findings = Findings()
    program = load_alone(path, findings, "job.tap", machine=machine, folders=folders)
    return None if findings.has(Severity.ERROR) else program


def printed(program: Program, machine: Machine = NO_SHOP) -> bytes:
    return b"".join(emit(program, machine.controller.controls.lexical))


def formatted(folder: Path, data: bytes, machine: Machine = NO_SHOP, folders: list[Path] | None = None) -> bytes | None:
    """``data`` in its printed form, after every property that holds for all; None when it has mistakes."""
    folders = folders or [folder]
    program = read(folder, data, machine, folders)
    if program is None:
        return None
    program.verify()
    try:
        text = printed(program, machine)
        again = read(folder, text, machine, folders, "again.tap")
        assert again is not None, "the printed text has mistakes"
        assert difference(program, again) is None
        assert comparable(program) == comparable(again)
        assert printed(again, machine) == text, "printing twice changes something"
        lines = len(data.replace(b"\r\n", b"\n").split(b"\n"))
        assert len(text.split(b"\n")) - 1 == lines - (data.endswith(b"\n") or not data.removeprefix(b"\xef\xbb\xbf"))
    except Exception:
        print(data)
        raise
    return text


def comparable(program: Program) -> str:
    """Everything but names, columns and byte offsets: a comparison that does not use ``ir/same.py``."""

    def plain(value: Any) -> Any:
        value = value.made() if isinstance(value, DeferredBlock) else value
        if isinstance(value, Span):
            return value.line
        if isinstance(value, BlockTable):
            words, begin, line = [], value.begin, value.first_line
            while line <= value.last_line:
                part, begin, line = program.load(value, begin, line, 5000)
                words += [(row, letter, flags, repr(number)) for row, _, letter, flags, number in part.rows()]
            return value.first_line, value.last_line, words
        if dataclasses.is_dataclass(value):
            names = [f.name for f in dataclasses.fields(value)]
            if getattr(value, "line", None) is not None:
                names = [name for name in names if name != "written"]
            return type(value).__name__, [plain(getattr(value, name)) for name in names]
        if isinstance(value, tuple | list):
            return [plain(item) for item in value]
        return repr(value)

    return repr((plain(program.body), program.line_count, notes_of(program)))


def notes_of(program: Program) -> list[tuple[int, int, int, bytes]]:
    found, begin, line = [], 0, 1
    while line <= program.line_count:
        notes, begin, line = program.load_notes(0, begin, line, 5000)
        notes.verify()
        found += [(row, place, kind, text) for row, place, kind, _, text in notes]
    assert (line, begin) == (program.line_count + 1, len(program.files[0].data))
    return found


# -- the form


FORM = [
    ("g0x1y2", "G0 X1 Y2"),
    ("  G01   X1.50 Y-.5 z5. F0100", "G1 X1.5 Y-0.5 Z5.0 F100"),
    ("G 1 X+12.5", "G1 X12.5"),
    ("G+1x-0y-0.", "G1 X-0 Y-0.0"),
    ("g92xy", "G92 X Y"),
    ("X Y", "X Y"),
    ("G0X{5}Y{ TH1 + 2. }Z{q*-.5}", "G0 X{5} Y{TH1+2.0} Z{Q*-0.5}"),
    ("G0 X{tp1}", "G0 X{TP1}"),
    ("~g28x y", "~G28 X Y"),
    ("~ G28 X", "~G28 X"),
    ("l91 g1 x.25", "L91 G1 X0.25"),
    ("m11c2", "M11 C2"),
    ("M17.10C1", "M17.1 C1"),
    ('g5t1m"Clamp [left]  shut?"', 'G5 T1 M"Clamp [left]  shut?"'),
    ("G5 M“shut?”", 'G5 M"shut?"'),
    ('g5 t2 m"a" m"b"', 'G5 T2 M"a" M"b"'),
    ("m98 Texas.tap", "M98 Texas.tap"),
    ("M98  part.tap  x.5 t{t}", "M98 part.tap X0.5 T{T}"),
    ('M98.1 "my part.tap"x1', 'M98.1 "my part.tap" X1'),
    ("L41  copy  a.txt b", "L41 copy  a.txt b"),
    ("L10 r1 c4 x6 y0", "L10 R1 C4 X6 Y0"),
    ("L010", "L10"),
    ("%", "%"),
    ("  [a]  (b)  % rest \t", "[a] (b) % rest"),
    ("[ a ](b)", "[ a ] (b)"),
    ("X1[no blank", "X1 [no blank"),
    ("X1     [kept apart]", "X1     [kept apart]"),
    ("x1.000   [kept where it was]", "X1.0     [kept where it was]"),
    ("m11 c2\t[by a tab]", "M11 C2  [by a tab]"),
    ("X.1234567890123456789", "X0.12345678901234568"),
    # What only a macro of some machine can mean stays as it is.
    ("m06t1", "m06t1"),
    ("m06t1  [tool]", "m06t1  [tool]"),
    ("Park", "Park"),
    ("xy [park?]", "xy [park?]"),
    ("n10 g0x1", "n10 g0x1"),
    # Read by nobody.
    ("X1 [a] Y2", "X1 [a] Y2"),
    ("  x1 [a]y2 ", "  x1 [a]y2"),
]


@pytest.mark.parametrize(("line", "becomes"), FORM)
def test_form_of_a_line(tmp_path: Path, line: str, becomes: str) -> None:
    assert formatted(tmp_path, line.encode()) == becomes.encode() + b"\n"


def files_of(shop: Path) -> list[Path]:
    paths = sorted(path for path in shop.rglob("*") if path.suffix.lower() in (".tap", ".mac"))
    return [path for path in paths if path.name != "CNC.MAC"]


@pytest.mark.parametrize("shop", SHOPS, ids=lambda path: path.name)
def test_files_of_shops(tmp_path: Path, shop: Path) -> None:
    machine = machine_of(shop)
    for path in files_of(shop):
        program = load_alone(path, findings := Findings(), machine=machine, folders=[shop, path.parent])
        text = formatted(tmp_path, path.read_bytes(), machine, [shop, path.parent])
        assert (text is None) == findings.has(Severity.ERROR), path
        assert program is not None, path
