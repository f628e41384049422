"""Traces worked out by hand from the manual: the peer agrees with them, and so does gproof.

They keep the two from being wrong together, and say which of them is wrong where they differ.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from differential.compare import first_difference
from differential.traces import EXPECTED, gproof_rows, hand_rows, peer_run, report
from support.campaigns import share


def program_of(path: Path) -> Path:
    return path.with_suffix(".ngc")


@pytest.mark.usefixtures("peer")
@pytest.mark.parametrize("path", share(EXPECTED, 8), ids=lambda path: path.stem)
def test_peer_is_as_by_hand(path: Path) -> None:
    """A share: gproof is as by hand in all of them, and as the peer (test_rs274.py)."""
    program = program_of(path)
    difference = first_difference(peer_run(program).rows, hand_rows(path), ("peer", "by hand"))
    assert difference is None, report(program, difference)


@pytest.mark.usefixtures("gproof")
@pytest.mark.parametrize("path", EXPECTED, ids=lambda path: path.stem)
def test_gproof_is_as_by_hand(path: Path) -> None:
    program = program_of(path)
    difference = first_difference(gproof_rows(program), hand_rows(path), ("gproof", "by hand"))
    assert difference is None, report(program, difference)
