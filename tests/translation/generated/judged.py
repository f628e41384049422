"""What becomes of a generated program: its translation, both programs at known places, and the way back."""

from __future__ import annotations

import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from support.known_zeros import at_known_zero

from gproof.driver.dialects import DIALECTS as LANGUAGES
from gproof.driver.dialects import load_machine
from gproof.driver.session import Session
from gproof.driver.translation import Translation
from gproof.frontend.common.frontend import Reading
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine
from gproof.ir.program import Program
from gproof.ir.setup import NOTHING, Setup
from gproof.ir.verdict import Verdict

from .cases import WRITERS, machine_of, made, translated, written
from .known import difference, runs

PLACES = 3
"""Setups that a proven pair is run under."""
CHORD = 0.012
"""mm that the path may be off where arcs have become chords, with what rounding adds."""
KEEPS = frozenset((
    "end of a compensation that never starts -> nothing", "end of a tool length that is never used -> nothing",
    "end -> the end that there is", "message -> comment", "setting of a variable -> remembered value",
    "expression -> number", "stored work offset -> zero at its place", "work offset -> the only one",
    "zero in one of several places -> its work offset", "tool selected early -> at the change",
    "change -> change with a number", "unit -> another unit", "radius -> centre", "full circle -> its end by name",
    "end that stops spindle and coolant -> both off, end", "change that stops the spindle -> spindle off, change",
    "change that leaves the spindle as it is -> change, where it rests", "coolant -> the other coolant",
    "path mode -> a setting of the controller", "centre at a place -> from the start",
    "input in a condition -> read before", "relative places -> absolute places",
))  # fmt: skip
"""Patterns that leave every construct as long as it is."""


@dataclass
class Figures:
    """Counts of a direction. drift: mm of a way there and back; lines: of programs that both sides have the constructs
    of, there and back again; wrong: what is a failure, with the program."""

    programs: int = 0
    proven: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    back: int = 0
    not_back: Counter[str] = field(default_factory=Counter)
    drift: float = 0.0
    exact_drift: float = 0.0
    lines: int = 0
    lines_back: int = 0
    wrong: list[str] = field(default_factory=list)

    def text(self, dialect: str, to: str) -> str:
        most = "; ".join(f"{count} {what}" for what, count in self.refused.most_common(4))
        found = (
            f"{dialect} -> {to}: {self.programs} programs, {self.proven} proven, {self.refused.total()} refused "
            f"({most}), {len(self.wrong)} failures"
        )
        if self.back:
            ratio = self.lines_back / self.lines if self.lines else 0.0
            found += f"; {self.back} there and back: drift {self.drift:.1e} mm, exact {self.exact_drift:.1e} mm"
            found += f", {ratio:.2f} times as long"
            told = "; ".join(f"{count} {what}" for what, count in self.not_back.most_common(4))
            found += f"; {self.not_back.total()} refused ({told})" if told else ""
        return found


def judge(dialect: str, to: str, seed: int, figures: Figures) -> Translation | None:
    """One program for one controller; the translation where it is proven."""
    job = made(dialect, to, seed)
    exact = bool(seed % 2)
    figures.programs += 1
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        source = written(job, folder)
        try:
            text, done = _judged(source, dialect, to, exact, folder / "there", figures)
            if done is not None and not text and to in WRITERS:
                text = _back(done, dialect, to, exact, folder, figures)
        except Exception as error:
            text, done = f"{type(error).__name__}: {error}", None
    if text:
        files = "\n".join(f"--- {inner}\n{lines}" for inner, lines in job.files.items())
        figures.wrong.append(f"{dialect} -> {to}, seed {seed}: {text}\n{job.text}{files}")
    return done


def _judged(
    source: Path, dialect: str, to: str, exact: bool, folder: Path, figures: Figures
) -> tuple[str, Translation | None]:  # fmt: skip
    """(what is wrong, the translation where it is proven)."""
    done = translated(source, dialect, to, exact=exact)
    if done.verdict is not Verdict.SAFE:
        first = done.findings.kept[0]
        if first.code.label != "GP703":
            return f"{first.code.label} line {first.span.line}: {first.message}", None
        figures.refused[first.message.partition(" cannot be translated")[0]] += 1
        return "", None
    figures.proven += 1
    if to not in WRITERS:
        return "", done
    program, machine = read(done, to, folder)
    session = done.session
    assert session.program is not None
    sides = (session.program, session.machine, session.setup), (program, machine, NOTHING)
    stated: dict[str, Any] = {"lengths": lengths(done), "only": done.only}
    return apart(sides, session, (dialect, to), 1e-6 if exact else 1e-4, _chord(done), stated)[0], done


def lengths(done: Translation) -> dict[int, float]:
    """mm of the tools: as the translation takes them, where it does, and else all alike."""
    return dict(done.lengths) or dict.fromkeys(range(4), 0.0)


def _chord(done: Translation) -> float:
    return CHORD if any(one.pattern == "arc -> chords" for one in done.lowered) else 0.0


def read(done: Translation, to: str, folder: Path) -> tuple[Program, Machine]:
    """A translation as the other controller reads it."""
    folder.mkdir()
    job = saved(done, folder)
    loaded, _ = load_machine(machine_of(to), Findings())
    assert loaded is not None
    program, machine = LANGUAGES[to].frontend.load_program(
        Reading(job=job, findings=Findings(), machine=loaded, machine_file=machine_of(to))
    )
    assert program is not None
    return program, machine


def saved(done: Translation, folder: Path) -> Path:
    """The files of a translation; its own."""
    job = folder / f"job{done.target.style.extension}"
    for name, text in done.files.items():
        (folder / name if name else job).write_bytes(text)
    return job


Side = tuple[Program, Machine, Setup]


def apart(
    sides: tuple[Side, Side], session: Session, names: tuple[str, str], tolerance: float, chord: float,
    stated: dict[str, Any],
) -> tuple[str, float]:  # fmt: skip
    """(what is not the same at known places, the largest distance, mm)."""
    worst = 0.0
    for seed in range(PLACES):
        one, other = (
            runs(
                at_known_zero(program, machine, setup, session, seed, **stated),
                program.spindle_outputs,
                100 * (name == "mcuwin"),
            )
            for (program, machine, setup), name in zip(sides, names, strict=True)
        )
        if one.keys() != other.keys():
            return f"place {seed}: answers {sorted(one)[:3]} and {sorted(other)[:3]}", worst
        for answers, run in one.items():
            text, far = difference(run, other[answers], tolerance, chord)
            worst = max(worst, far)
            if text:
                return f"place {seed}, {answers}: {text}", worst
    return "", worst


def _back(done: Translation, dialect: str, to: str, exact: bool, folder: Path, figures: Figures) -> str:
    """From the other controller to the first: "" where it is proven, or refused by a construct."""
    again = translated(saved(done, folder / "there"), to, dialect, exact=exact)
    if again.verdict is not Verdict.SAFE:
        first = again.findings.kept[0]
        if first.code.label != "GP703":
            return f"back: {first.code.label} line {first.span.line}: {first.message}"
        figures.not_back[first.message.partition(" cannot be translated")[0]] += 1
        return ""
    program, machine = read(again, dialect, folder / "back")
    session = done.session
    assert session.program is not None
    figures.back += 1
    sides = (session.program, session.machine, session.setup), (program, machine, NOTHING)
    chord = 2 * max(_chord(done), _chord(again))
    stated: dict[str, Any] = {"lengths": lengths(done), "only": done.only}
    text, far = apart(sides, session, (dialect, dialect), 1e-6 if exact else 2e-4, chord, stated)
    if not chord and exact:
        figures.exact_drift = max(figures.exact_drift, far)
    elif not chord:
        figures.drift = max(figures.drift, far)
    if not {one.pattern for one in (*done.lowered, *again.lowered)} - KEEPS:
        figures.lines += sum(map(_lines, _sources(session)))
        figures.lines_back += sum(map(_lines, again.files.values()))
    return text and f"there and back: {text}"


def _sources(session: Session) -> Iterator[bytes]:
    assert session.program is not None
    for file in session.program.files:
        if Path(file.name).suffix.lower() in {".cnc", ".tap", ".src"}:
            yield Path(file.name).read_bytes()


def _lines(text: bytes) -> int:
    return sum(bool(line.strip()) for line in text.splitlines())
