"""The validator and the traps: each pair is proven for every work zero, no wrong translation is.

Nothing is known of work zero, start and inputs here. A case whose pair cannot be proven says why (``Proof:``).
"""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import pytest
from support.traps import AXES, READ, Case, cases
from translation.test_traps import CHANNELS_OF_AN_AXIS, session_of, setup_of

from gproof.driver.running import execute
from gproof.driver.session import Session
from gproof.ir.finding import Findings, Severity
from gproof.ir.setup import Interval, Setup
from gproof.ir.trace import Trace
from gproof.ir.translation_terms import SymbolMeaning, TranslationTerms
from gproof.ir.verdict import Verdict
from gproof.verify.translation.compare import compare

CASES = cases()
NO_OFFSET = {axis: Interval(0.0, 0.0) for axis in AXES}
OF_BOTH = frozenset(("inputs", "answers", "start", "work", "second"))
"""What a setup of a case states that a proof must not rest on."""
ZERO_OF_WINCNC = tuple(SymbolMeaning(symbol=f"g92.{axis}", form=((f"work.1.{axis}", 1),)) for axis in AXES)
"""The G92 of the operator and the G54 of the other controllers are set at the same place."""
SPARE = frozenset(f"work.9.{axis}" for axis in AXES)
"""The work offset of Eding CNC that translations may use."""
LEFT_OUT = frozenset(("path_mode", "guards", "limits"))


def anywhere(state: dict[str, Any], dialect: str) -> Setup:
    """The setup of a case without work zero, start, inputs and answers."""
    known = setup_of(state | {"inputs": {}, "answers": []}, dialect)
    return dataclasses.replace(
        known,
        start={},
        work={},
        g92={} if dialect == "wincnc" else NO_OFFSET,
        default_start=None,
        default_offset=None,
        tool_lengths=dict.fromkeys(range(4), Interval(0.0, 0.0)),
        measures={"z": Interval(0.0, 0.0)},
    )


KNOWN: dict[tuple[str, str, str], tuple[Session, Trace | None, bool]] = {}
"""Traces by case, program and state."""


def traced(case: Case, program: str, state: dict[str, Any], folder: Path) -> tuple[Session, Trace | None, bool]:
    """A program, its trace for any work zero, and whether something in it is an error or unknown."""
    key = case.name, program, str({name: value for name, value in state.items() if name not in OF_BOTH})
    if key not in KNOWN:
        KNOWN[key] = _traced(case, program, state, folder)
    return KNOWN[key]


def _traced(case: Case, program: str, state: dict[str, Any], folder: Path) -> tuple[Session, Trace | None, bool]:
    session = session_of(case, program, folder, alone=True)
    findings = Findings()
    for finding in session.findings.kept:
        findings.add(finding)
    found = None
    if session.program is not None:
        setup = anywhere(state, case.dialect(program))
        found = execute(session.program, setup, session.machine, findings, max_branches=64)
    return session, found, any(f.severity in (Severity.ERROR, Severity.UNKNOWN) for f in findings.kept)


def terms_of(case: Case, program: str, source: Session, target: Session) -> TranslationTerms:
    """What both sides agree on: README.md of the cases."""
    one, other = case.dialect(case.source), case.dialect(program)
    numbers = [(n, n + CHANNELS_OF_AN_AXIS) for n in range(1, 17)]
    channels = {"source": [(b, a) for a, b in numbers], "target": numbers, "": []}[
        "" if one == other else "source" if one == "mcuwin" else "target" if other == "mcuwin" else ""
    ]
    assert source.program is not None and target.program is not None
    return TranslationTerms(
        source=one,
        target=other,
        tolerance_mm=6e-5,
        feed_relative=1e-4,
        seconds=1e-4,
        outputs=tuple(channels),
        inputs=tuple(channels),
        source_outputs=source.program.spindle_outputs,
        target_outputs=target.program.spindle_outputs,
        source_symbols=ZERO_OF_WINCNC if one == "wincnc" else (),
        target_symbols=ZERO_OF_WINCNC if other == "wincnc" else (),
        rapids_assumed=True,
        left_out=LEFT_OUT,
        scratch=SPARE if other == "eding" else frozenset(),
    )


def verdicts(case: Case, program: str, folder: Path) -> list[tuple[Verdict, object]]:
    """What the validator says of a target, once for each state of the setup that it may rest on."""
    states = {str({k: v for k, v in state.items() if k not in OF_BOTH}): state for state in case.setups()}
    found: list[tuple[Verdict, object]] = []
    for state in states.values():
        source, one, is_open = traced(case, case.source, state, folder)
        target, other, is_bad = traced(case, program, state, folder)
        if one is None or other is None or is_open or is_bad:
            found.append((Verdict.UNKNOWN, "a finding"))
            continue
        comparison = compare(one, other, terms_of(case, program, source, target))
        found.append((comparison.verdict, comparison.differences or comparison.unknown))
    return found


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the programs of all cases are, each with its machine."""
    return tmp_path_factory.mktemp("traps")


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_pairs_are_proven(case: Case, shop: Path) -> None:
    for program in case.programs("target"):
        if case.dialect(program) in READ:
            found = verdicts(case, program, shop)
            is_proven = all(verdict is Verdict.SAFE for verdict, _ in found)
            assert is_proven != bool(case.unproven), (program, found)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_wrong_translations_are_refused(case: Case, shop: Path) -> None:
    for program in case.programs("wrong"):
        if case.dialect(program) in READ:
            found = verdicts(case, program, shop)
            assert any(verdict is not Verdict.SAFE for verdict, _ in found), program
