"""A line that was not understood, anywhere in a job: nothing about motion is SAFE, and what is UNSAFE stays so."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from corpus.expectations import expectation, jobs

from gproof.driver.judge import Judgement, judge
from gproof.driver.session import Running, open_session
from gproof.ir.finding import Severity
from gproof.ir.verdict import Verdict

MOTION = ("limits", "areas", "arcs")
SMALL = 12_000
FLOW = ("sub", "if", "while", "gosub", "endsub", "dlgmsg")
FOLDERS = {job.parent.name: job.parent for job in jobs("eding")}

LINES = [
    # no word, no code, no command of the controller
    "U5", "X", "[", "G999", "M999", "G1 X1 X2", "nonsense", "gosub nobody_wrote_this", "if [1", "(open", "#70 = ",
    # understood, and refused
    "T1.5 M6", "G4", "G10 L2 P77 X0", "G43 H900", "S-5 M3", "G92", "G28 G92 X0",
    # refused with an error of another property than language
    "G17 G91 G2 X5 Y0 F100", "G17 G91 G2 X5 Y0 R0 F100", "G17 G91 G2 X5 Y0 R1 F100", "G17 G91 G2 X0 Y0 R4 F100",
    # values that nobody stated: the line is refused, or its axis is anywhere
    "G10 L2 P[#3999] X0", "G10 L[#3999] P1 X0", "G0 G53 X[1/0]", "G[#3999] X1", "M[#3999]",
    "G17 G91 G2 X5 I[#3999] F100", "G17 G91 G2 X5 R[#3999] F100", "G81 X1 Y1 Z-1 R[#3999] F100", "#[#3999] = 1",
    "G81 X1 Y1 Z-1 R1 L[#3999] F100", "M54 P[#3999]", "T[#3999] M6 L5", "zhcon", "tkon", "M6 T900", "G93 G1 X1",
]  # fmt: skip


def judged(folder: Path, job: Path, *, stated: bool = True) -> Judgement:
    """The corpus job's machine, and its setup where that is to be stated."""
    expect = expectation(folder / "job.cnc")
    setup = expect.get("setup") if stated else None
    session = open_session(job, machine=Path(expect["machine"]), setup=setup, dialect="eding")
    return judge(session, running=Running(max_blocks=20_000))


def straight(folder: Path) -> bool:
    """Jobs small enough to run many times, every line of which is executed."""
    text = (folder / "job.cnc").read_text(encoding="utf-8").lower()
    return len(text) < SMALL and not any(word in text for word in FLOW)


STRAIGHT = [name for name, folder in FOLDERS.items() if straight(folder)]


def places(lines: list[str]) -> int:
    """The lines before the job's end."""
    for n, line in enumerate(lines):
        if line.split("(")[0].split(";")[0].strip().lower().endswith(("m30", "m2", "m02")):
            return n
    return len(lines)


def test_there_are_jobs_to_try() -> None:
    assert len(STRAIGHT) >= 12


@pytest.mark.parametrize("text", LINES)
def test_nothing_about_motion_is_safe_behind_it(text: str, tmp_path: Path) -> None:
    seed = random.randrange(1 << 32)
    choose = random.Random(seed)
    counted = 0
    for name in choose.sample(STRAIGHT, 4):
        folder = FOLDERS[name]
        lines = (folder / "job.cnc").read_text(encoding="utf-8").splitlines()
        at = choose.randint(0, places(lines))
        changed = [*lines[:at], text, *lines[at:]]
        job = tmp_path / "job.cnc"
        job.write_text("\n".join(changed) + "\n", encoding="utf-8")
        found = judged(folder, job, stated="#3999" not in text)
        said = f"seed {seed}: {text!r} before line {at + 1} of {name}"
        if not any(f.span.line == at + 1 and f.severity in (Severity.ERROR, Severity.UNKNOWN)
                   for f in found.findings.kept):  # fmt: skip
            continue
        counted += 1
        assert found.verdict is not Verdict.SAFE, said
        safe = [p.name for p in found.properties if p.name in MOTION and p.verdict is Verdict.SAFE]
        assert safe == [], said
    assert counted >= 1, f"{text!r} is understood"


def test_nothing_about_motion_is_safe_on_a_machine_that_is_not_modelled(tmp_path: Path) -> None:
    folder = FOLDERS["drilled-plate"]
    machine = tmp_path / "machine.toml"
    machine.write_text('kinematics = "hexapod"\n' + (folder / "machine.toml").read_text(encoding="utf-8"), "utf-8")
    session = open_session(folder / "job.cnc", machine=machine, setup="zero", dialect="eding")
    found = {p.name: p.verdict for p in judge(session, running=Running()).properties}
    assert found == {"language": Verdict.SAFE} | dict.fromkeys(MOTION, Verdict.UNKNOWN)


@pytest.mark.parametrize(
    "name", [n for n in STRAIGHT if n.startswith(("over-limit", "arc-", "magazine-crossed", "rack"))]
)
def test_what_was_found_before_it_stays(name: str, tmp_path: Path) -> None:
    folder = FOLDERS[name]
    lines = (folder / "job.cnc").read_text(encoding="utf-8").splitlines()
    before = judged(folder, folder / "job.cnc")
    for text in ("U5", "G4", "G17 G91 G2 X5 Y0 F100"):
        job = tmp_path / "job.cnc"
        end = places(lines)
        job.write_text("\n".join([*lines[:end], text, *lines[end:]]) + "\n", encoding="utf-8")
        after = {p.name: p.verdict for p in judged(folder, job).properties}
        for p in before.properties:
            if p.name != "language" and p.verdict is Verdict.UNSAFE:
                assert after[p.name] is Verdict.UNSAFE, (text, p.name)
