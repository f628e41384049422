"""Pairs of programs that a translation gets wrong easily, worked out by hand: the interpreter agrees with both traces.

Each case of ``traps/`` (its README says what one holds) is run under setups with different work zeros: source and
target give the rows of the page, no wrong translation does.
"""

from __future__ import annotations

import dataclasses
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from differential import rs274_peer
from hand.compare import rows_of
from support.traps import AXES, READ, Case, cases, placed

from gproof.driver.running import begin
from gproof.driver.session import Session, open_session
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import Findings, Severity
from gproof.ir.setup import ZERO, Interval, Setup, StoredPosition

CASES = cases()
LISTED = {"traverse", "feed", "arc", "dwell", "spindle", "setpoint", "coolant", "output", "input_wait", "stop", "home"}
LISTED |= {"tool_change", "error"}
SPEED = "spindle_speed", "wincnc"
"""The setpoint that is listed: of the controller that has no row for the spindle itself."""
TOLERANCE = 2e-4
"""mm, mm/min: programs print four decimals."""
CHANNELS_OF_AN_AXIS = 100
"""McuWIN counts outputs and inputs by axis: 102 is bit 2 of axis 1."""


def setup_of(state: dict[str, Any], dialect: str) -> Setup:
    """What a case knows at the start, in the terms of a controller."""

    def places(name: str) -> dict[str, Interval]:
        return {axis: Interval(v, v) for axis, v in zip(AXES, state[name], strict=True)}

    zero = places("work")
    systems = {(n, axis): place for n, name in ((1, "work"), (2, "second")) for axis, place in places(name).items()}
    by_axis = CHANNELS_OF_AN_AXIS if dialect == "mcuwin" else 0
    inputs = {int(n) + by_axis: float(on) for n, on in state.get("inputs", {}).items()}
    return dataclasses.replace(
        ZERO,
        start=places("start"),
        work={} if dialect == "wincnc" else systems,
        g92=zero if dialect == "wincnc" else {},
        inputs=inputs,
        outputs=dict.fromkeys(range(65), 0.0),
        answers={n: float(word == "yes") for n, word in enumerate(state.get("answers", []), 1)},
        parameters={int(n): float(v) for n, v in state.get("parameters", {}).items() if dialect == "eding"},
        positions={name: _stored(place) for name, place in state.get("positions", {}).items()},
        tool=state.get("tool", 0),
        default_parameter=None if dialect == "mcuwin" else 0.0,
    )


def _stored(machine: list[float]) -> StoredPosition:
    return StoredPosition(axes=dict(zip(AXES, machine, strict=True)))


@cache
def session_of(case: Case, program: str, folder: Path, *, alone: bool = False) -> Session:
    """A program of a case, read once for all its setups and tests; folder: of all of them."""
    place = folder / case.name / f"{program}{'.alone' * alone}"
    place.mkdir(parents=True)
    written, machine = case.written(program, place, alone=alone)
    session = open_session(written, machine=machine, setup="zero", dialect=case.dialect(program))
    if case.dialect(program) == "wincnc":
        settings = dataclasses.replace(wincnc_settings(session.machine), shift_sign=1)
        session = dataclasses.replace(session, machine=dataclasses.replace(session.machine, settings=settings))
    return session


def trace(case: Case, program: str, setup: dict[str, Any], folder: Path) -> tuple[list[dict[str, Any]], list[str]]:
    """Rows in the words of README.md, and what is an error or unknown."""
    session = session_of(case, program, folder)
    findings = Findings()
    for finding in session.findings.kept:
        findings.add(finding)
    rows: list[dict[str, Any]] = []
    if session.program is not None:
        stated = setup_of(setup, case.dialect(program))
        run = begin(session.program, stated, session.machine, findings)
        rows = rows_of(run, session.machine, (), session.job)
    start = dict(zip(AXES, setup["start"], strict=True))
    is_bad = {Severity.ERROR, Severity.UNKNOWN}
    bad = [f"{f.span.line}: {f.code.label} {f.message}" for f in findings.kept if f.severity in is_bad]
    return worded(rows, start, case.dialect(program)), bad


def worded(rows: list[dict[str, Any]], start: dict[str, float], dialect: str) -> list[dict[str, Any]]:
    """Rows in the words of README.md."""
    kept: list[dict[str, Any]] = []
    before = list(start.values())
    for found in rows:
        row = dict(found)
        if row["op"] not in LISTED or (row["op"] == "setpoint" and (row["name"], dialect) != SPEED):
            continue
        if row["op"] == "input_wait" and row.get("value") is None:
            continue  # read, not waited for
        if row["op"] == "dwell" and row.get("seconds") == 0.0:
            continue
        if row["op"] == "setpoint":
            row = {"op": "spindle", "rpm": row["value"]}
        if dialect == "mcuwin" and "channel" in row:
            row["channel"] -= CHANNELS_OF_AN_AXIS
        if "to" in row:
            ends = row.get("ranges") or {axis: (place, place) for axis, place in row["to"].items()}
            low, high = ([ends[axis][end] for axis in AXES] for end in (0, 1))
            row["to"] = low if _same(low, high) else [None] * len(AXES)
            if row["op"] != "arc" and _same(row["to"], before):
                continue
            before = row["to"]
        kept.append(row)
    return kept


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(_same, one, other))
    if isinstance(one, int | float) and isinstance(other, int | float):
        return abs(one - other) <= TOLERANCE
    return bool(one == other)


def _same_rate(one: Any, other: Any) -> bool:
    """Of feeds, with the digits that inches a minute are printed with."""
    numbers = isinstance(one, int | float) and isinstance(other, int | float)
    return numbers and abs(one - other) <= 1e-5 * abs(one)


def difference(expected: list[dict[str, Any]], found: list[dict[str, Any]]) -> str:
    """The first place where two traces part, "" for none."""
    for n, row in enumerate(expected):
        if n >= len(found):
            return f"nothing in place of {row}"
        made = found[n] if found[n]["op"] != "arc" else {"plane": "XY"} | found[n]
        wanted = {"plane": "XY"} | row if row["op"] == "arc" else row
        waits = row["op"] == "dwell" and "seconds" not in row and made["op"] in {"dwell", "stop"}
        if not waits and not all(
            _same(value, made.get(key)) or (key == "feed" and _same_rate(value, made.get(key)))
            for key, value in wanted.items()
            if key != "when"
        ):
            return f"{made} in place of {row}"
        if waits and "seconds" in made:
            return f"{made} in place of {row}"
    return f"{found[len(expected)]} in addition" if len(found) > len(expected) else ""


def against(case: Case, program: str, folder: Path) -> list[str]:
    """What a program does otherwise than its page, setup by setup."""
    found = []
    for setup in case.setups():
        rows, bad = trace(case, program, setup, folder)
        wanted = [placed(row, setup) for row in case.rows(program) if _is_of(row, setup)]
        found += [text for text in (difference(wanted, rows), *bad) if text]
    return found


def _is_of(row: dict[str, Any], setup: dict[str, Any]) -> bool:
    """Whether a row belongs to a setup: ``when`` has the state of the inputs or answers in which it is there."""
    return all(setup.get(key) == value for key, value in row.get("when", {}).items())


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the programs of all cases are, each with its machine."""
    return tmp_path_factory.mktemp("traps")


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_pair_does_what_the_manuals_say(case: Case, shop: Path) -> None:
    for program in (*case.programs("source"), *case.programs("target")):
        if case.dialect(program) in READ:
            assert against(case, program, shop) == [], program


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_wrong_translations_differ(case: Case, shop: Path) -> None:
    wrong = case.programs("wrong")
    assert len(wrong) >= 2
    for program in wrong:
        if case.dialect(program) in READ:
            assert against(case, program, shop) != [], program


BAKED = [(case, name) for case in CASES for name in case.programs("wrong") if name.startswith("wrong-baked")]


@pytest.mark.parametrize("case, program", BAKED, ids=lambda one: one.name if isinstance(one, Case) else one)
def test_baked_offsets_are_right_for_one_zero(case: Case, program: str, shop: Path) -> None:
    """The translations that were tried on one day: only another work zero shows that they are wrong."""
    setup = case.setups()[0]
    rows, bad = trace(case, program, setup, shop)
    assert bad == []
    moves = [placed(row, setup) for row in case.rows(program) if row["op"] != "left"]
    assert difference(moves, rows[: len(moves)]) == ""


OTHERS = [(case, name) for case in CASES for role in ("target", "wrong") for name in case.programs(role)]


@pytest.mark.skipif(rs274_peer.missing() is not None, reason="LinuxCNC's interpreter is not installed")
def test_texts_for_linuxcnc_and_grbl(shop: Path) -> None:
    """LinuxCNC's own interpreter reads them: the right ones give the rows of the page, the wrong ones do not."""
    jobs, questions = [], []
    for number, (case, name) in enumerate((c, n) for c, n in OTHERS if c.dialect(n) not in READ):
        program = shop / f"{number}.ngc"
        program.write_bytes(case.section.files[name])
        for setup in case.setups():
            zeros = {n: dict(zip(AXES, setup[key], strict=True)) for n, key in ((1, "work"), (2, "second"))}
            situation = rs274_peer.Situation(tools={1: (40.0, 6.0), 2: (40.0, 4.0)}, work=zeros)
            jobs.append((program, situation))
            questions.append((case, name, setup))
    differences: dict[tuple[str, str], list[str]] = {}
    for (case, name, setup), run in zip(questions, rs274_peer.run_peers(jobs), strict=True):
        rows = worded(run.rows, dict(zip(AXES, setup["start"], strict=True)), case.dialect(name))
        wanted = [placed(row, setup) for row in case.rows(name)]
        found = difference(wanted, rows)
        differences.setdefault((case.name, name), []).append(found)
    for (case_name, name), found in differences.items():
        assert any(found) == name.startswith("wrong"), (case_name, name, found)
