"""Records and journals with fields that nobody wrote: read or refused, compared or refused, never a crash."""

from __future__ import annotations

import hashlib
import json
import random
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from backend.streams import FREQUENCY
from backend.test_runtime import TWO, Tap
from support.campaigns import sizes

from backend.boards.emulator import link_campaign as links
from gproof.backend import journal as journals
from gproof.backend import runtime
from gproof.backend.boards.emulator.emulator import Options
from gproof.backend.boards.emulator.faults import parsed
from gproof.backend.control import Control
from gproof.backend.job import CertifiedJob
from gproof.backend.journal import Found, read_journal
from gproof.backend.record import parse_record, problems
from gproof.backend.record_data import ExecutionRecord, canonical
from gproof.backend.runtime import Hold

VALUES: list[Any] = [
    0, 1, -1, 2, 5, 10**7, 10**12, -(10**9), 2**31, 2**62, 2**63 - 1, 1 - 2**63, 2**63, 1e308, 0.5, [], [0], [1, 2, 3],
    [0, 2**62], {}, "", "x", "1/1000000000000000", "1/3", "9/10", "0", "-1", "1e400", "1/0", "completed", "interrupted",
    "fault", "stopped", "hold", "override", "change", "end", "operator", "é\x1b[2J", None, True,
]  # fmt: skip


def of_boards() -> list[tuple[ExecutionRecord, CertifiedJob]]:
    """True records: of the virtual board, held and overridden, of one that counts what it made, of one lost."""
    control = Control()
    control.override(0.8)

    def wish(part: float) -> None:
        control.override(0.5 if part < 0.6 else 1)

    changed = runtime.walk(TWO, Tap(2), control=control, on_progress=wish)
    assert any(r.kind == "change" for s in changed.sections for r in s.retimings)
    held = runtime.walk(TWO, Tap(2), override=Fraction(1, 2), hold_at=Hold(at=300_000, rest=1000))
    found = [(held, TWO), (changed, TWO)]
    for fault in ("", "motion+0.2 close 0.3"):
        options = Options(frequency=FREQUENCY, baud=1_000_000, faults=tuple(parsed(fault)))
        record = links.ran(links.jobs()[0], links.Schedule("", options, links.FrailHost()))[0].record
        assert record is not None
        found.append((record, links.jobs()[0]))
    assert found[2][0].sections[0].executed and found[3][0].sections[0].losses
    return found


def places(value: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Where something stands in a JSON value; of long lists the first six."""
    out = [at] if at else []
    if isinstance(value, dict):
        for key in value:
            out += places(value[key], (*at, key))
    elif isinstance(value, list):
        for key in range(min(len(value), 6)):
            out += places(value[key], (*at, key))
    return out


def changed(value: Any, chance: random.Random) -> Any:
    """A copy with one to three values of another kind or size."""
    other = json.loads(json.dumps(value))
    everywhere = places(value)
    for _ in range(chance.choice([1, 1, 2, 3])):
        at = chance.choice(everywhere)
        inner = other
        try:
            for key in at[:-1]:
                inner = inner[key]
            inner[at[-1]] = chance.choice(VALUES)
        except (KeyError, IndexError, TypeError):
            continue
    return other


@pytest.mark.parametrize("many", sizes(300, 20_000))
def test_records_with_other_values(many: int) -> None:
    boards = of_boards()
    compared = 0
    for seed in range(many):
        good, job = boards[seed % len(boards)]
        body = changed(good.body(), random.Random(seed))
        try:
            # A forger makes the hash fit.
            chained = hashlib.sha256(bytes.fromhex(body["certificate"]) + canonical(body)).hexdigest()
            record = parse_record(canonical({**body, "sha256": chained}))
        except (ValueError, TypeError, KeyError):
            continue
        assert parse_record(record.to_json()) == record, seed
        wrong = list(problems(record, job))
        compared += 1
        if record.position != good.position or record.steps != good.steps:
            assert wrong, (seed, body)
    assert compared > many // 20


@pytest.mark.parametrize("many", sizes(300, 20_000))
def test_journals_with_other_values(many: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runtime, "NOTED", 0.2)
    journal = journals.begin(tmp_path, "virtual", {})
    runtime.walk(TWO, Tap(2), journal=journal, hold_at=100_000)
    good = [[kind, fields] for kind, fields in read_journal(journal.path).entries]
    for seed in range(many):
        chance = random.Random(seed)
        entries = changed(good[: chance.randrange(1, len(good) + 1)], chance)
        if not all(isinstance(e, list) and len(e) == 2 and isinstance(e[1], dict) for e in entries):
            continue
        trail = Found(path=journal.path, entries=tuple((str(kind), fields) for kind, fields in entries)).trail()
        if trail.begun:
            record = trail.record()
            assert parse_record(record.to_json()) == record, seed
            list(problems(record, TWO))
