"""A source of which nobody knows what it does from a place on: a difference after it is open, one before it refutes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from support.traps import machine_files

from gproof.driver import translation
from gproof.driver.translation import Translation, Wanted, translate
from gproof.ir import codes
from gproof.ir.finding import Findings, Span
from gproof.ir.verdict import Verdict

TEXT = "G17 G21 G90 G94 G40 G49 G54\nG0 X0 Y0 Z5\nG1 X1 F100\nG1 X2\nG1 X3\nM30\n"
UNKNOWN = codes.TRANSLATION_OPEN


def translated(folder: Path, monkeypatch: pytest.MonkeyPatch, *, wrong: bytes, opened: int) -> Translation:
    """A translation whose text goes aside at a place, and whose source is open from a line on."""
    machine = folder / "machine.toml"
    machine.write_bytes(machine_files("eding")["machine.toml"])
    job = folder / "job.cnc"
    job.write_text(TEXT)
    to = folder / "to.toml"
    to.write_text(machine.read_text().partition("[controller]")[0])
    entry = translation.TARGETS["linuxcnc"]

    def write(*given: object) -> dict[str, bytes]:
        files = entry.write(*given)  # type: ignore[arg-type]
        assert wrong in files[""]
        return files | {"": files[""].replace(wrong, wrong + b" Y0.5")}

    monkeypatch.setitem(translation.TARGETS, "linuxcnc", replace(entry, write=write))
    run = translation.trace_of

    def trace_of(program: object, setup: object, machine: object, findings: Findings, *rest: object, **more: object):  # type: ignore[no-untyped-def]
        if opened:
            findings.add(UNKNOWN.at(Span(str(job), opened), what="a line of the source"))
        return run(program, setup, machine, findings, *rest, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(translation, "trace_of", trace_of)
    return translate(Wanted(job=job, to="linuxcnc", machine=machine, machine_to=to, dialect="eding"))


def test_only_what_comes_before_is_refuted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for wrong, opened, verdict in (
        (b"X3", 0, Verdict.UNSAFE), (b"X3", 4, Verdict.UNKNOWN), (b"X1", 4, Verdict.UNSAFE),
        (b"X1", 2, Verdict.UNKNOWN),
    ):  # fmt: skip
        with monkeypatch.context() as patch:
            done = translated(tmp_path, patch, wrong=wrong, opened=opened)
        assert done.verdict is verdict, (wrong, opened, [one.message for one in done.findings.kept])
