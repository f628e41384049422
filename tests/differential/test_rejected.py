"""Programs that both refuse: LinuxCNC's interpreter with an error, gproof with the code that its page names."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from differential import gproof_side, rs274_peer
from differential.traces import REJECTED, codes

CODES = codes("rejected")


@pytest.mark.usefixtures("peer")
@pytest.mark.parametrize("program", REJECTED, ids=lambda path: path.stem)
def test_peer_refuses(program: Path) -> None:
    assert rs274_peer.refusal(program, rs274_peer.situation_of(None)) is not None


@pytest.mark.usefixtures("gproof")
@pytest.mark.parametrize("program", REJECTED, ids=lambda path: path.stem)
def test_gproof_refuses(program: Path) -> None:
    said = gproof_side.in_process(gproof_side.check_arguments(program))
    assert said.code == 1, f"{program.read_text()}\n{said}"
    if CODES[program.stem] != "any":
        assert any(code in said.output for code in CODES[program.stem].split(" or ")), (
            f"{CODES[program.stem]} expected\n{program.read_text()}\n{said}"
        )


def test_pages_hold_every_program() -> None:
    assert sorted(CODES) == sorted(path.stem for path in REJECTED)
    assert all(re.fullmatch(r"any|GP\d{3}( or GP\d{3})*", code) for code in CODES.values())
