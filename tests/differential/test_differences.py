"""Where LinuxCNC's interpreter departs from the manual: it does, and gproof follows the manual.

Keeps the list of known differences honest: a program that the two come to share belongs into `programs/`.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from differential import gproof_side
from differential.compare import first_difference
from differential.traces import DIFFERENCES, codes, gproof_rows, hand_rows, peer_run, report
from support.bundles import ROOT

CODES = codes("differences")
BY_HAND = [path for path in DIFFERENCES if not CODES.get(path.stem)]
REFUSED = [path for path in DIFFERENCES if CODES.get(path.stem)]


@pytest.mark.usefixtures("peer")
@pytest.mark.parametrize("program", BY_HAND, ids=lambda path: path.stem)
def test_peer_departs(program: Path) -> None:
    rows = hand_rows(program.with_suffix(".jsonl"))
    assert first_difference(peer_run(program).rows, rows) is not None, "no difference: move it to programs/"


@pytest.mark.usefixtures("gproof")
@pytest.mark.parametrize("program", BY_HAND, ids=lambda path: path.stem)
def test_gproof_follows_the_manual(program: Path) -> None:
    rows = hand_rows(program.with_suffix(".jsonl"))
    difference = first_difference(gproof_rows(program), rows, ("gproof", "by hand"))
    assert difference is None, report(program, difference)


@pytest.mark.usefixtures("peer")
@pytest.mark.parametrize("program", REFUSED, ids=lambda path: path.stem)
def test_peer_accepts(program: Path) -> None:
    assert peer_run(program).accepted, "refused by both: move it to rejected/"


@pytest.mark.usefixtures("gproof")
@pytest.mark.parametrize("program", REFUSED, ids=lambda path: path.stem)
def test_gproof_refuses(program: Path) -> None:
    said = gproof_side.in_process(gproof_side.check_arguments(program))
    assert said.code == 1, f"{program.read_text()}\n{said}"
    assert any(code in said.output for code in CODES[program.stem].split(" or ")), f"{program.read_text()}\n{said}"


def test_pages_hold_every_program() -> None:
    assert sorted(CODES) == sorted(path.stem for path in DIFFERENCES)
    assert all(path.with_suffix(".jsonl").exists() for path in BY_HAND)


def test_page_of_the_dialect_lists_every_program() -> None:
    page = (ROOT / "docs" / "dialects" / "eding.md").read_text().split("\n## Compared with LinuxCNC\n")[1]
    rows = [row.split("|")[-2] for row in page.splitlines() if row.startswith("| ")][1:]
    assert sorted(re.findall(r"`([a-z0-9-]+)`", "".join(rows))) == sorted(CODES)
