"""The tables of McuWIN's language have what the two manuals name, section by section, and nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.each import each

from gproof.ir.codes import CODES
from gproof.ir.dialects.mcuwin.messages import MESSAGES, ControllerMessage
from gproof.ir.dialects.mcuwin.words import TABLES

HERE = Path(__file__).parent
ENTRIES = [entry for table in TABLES.values() for entry in table]
Named = set[tuple[str, str]]


def named(version: str) -> Named:
    """(section, name) pairs of a list made from a manual."""
    lines = (HERE / f"mcuwin_{version}.txt").read_text("utf-8").splitlines()
    rows = [line.split() for line in lines if line and not line.startswith("#")]
    return {(row[0], name) for row in rows for name in row[1:]}


def sections(text: str) -> list[str]:
    """``4.16, 14 (2.5.3.30)``: 4.16 and 14."""
    return [part.split()[0] for part in text.split(", ") if part and not part.startswith(".")]


def own(old: bool) -> Named:
    """What the code's tables have of a manual."""
    rows = [(entry.old if old else entry.section, entry.name.replace(" ", "-")) for entry in ENTRIES]
    if not old:
        rows += [(message.section, f"{message.kind}:{message.number}") for message in MESSAGES]
    return {(section, name) for text, name in rows for section in sections(text)}


@pytest.mark.parametrize(("version", "old"), [("2.5.3.133", False), ("2.5.3.32", True)])
def test_the_tables_have_what_the_manual_names_and_nothing_else(version: str, old: bool) -> None:
    listed, have = named(version), own(old)
    assert listed - have == set()
    assert {name for _, name in have} == {name for _, name in listed}


def test_every_row_says_what_it_means() -> None:
    assert len({entry.name for entry in ENTRIES}) == len(ENTRIES)
    for entry in ENTRIES:
        assert entry.meaning
        assert entry.section


@each("message", MESSAGES, ids=lambda m: m.name)
def test_a_message_has_a_finding_or_a_reason_why_not(message: ControllerMessage) -> None:
    assert bool(message.codes) != bool(message.why)
    assert all(CODES[code.number] is code for code in message.codes)
    assert message.text
