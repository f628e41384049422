"""Generated programs for every other controller: proven or refused by a construct, the same at known places, and back.

A program is made by its seed from the manuals alone (``generated/writer.py``). What is proven is run under three
setups by the interpreter alone (``generated/known.py``), translated back, and compared with the first program. Texts
for LinuxCNC and grbl go through LinuxCNC's own interpreter.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from differential import rs274_peer
from support.campaigns import sizes

from gproof.driver.running import execute
from gproof.driver.session import Session
from gproof.driver.translation import Translation
from gproof.driver.translation_traces import own_devices
from gproof.ir.finding import Findings
from gproof.ir.setup import ZERO, Interval

from .generated.cases import DIRECTIONS
from .generated.judged import Figures, judge
from .test_linuxcnc import moves_of, peer_move, without_rests

SHORTEST = 0.2
"""Of all programs of a direction, at least so many are proven."""
LONGER = 1.2
"""A program that went there and back is at most so many times as long."""
BY_MACHINES = 40.0
"""mm: the length of the tools of the machines (``traps/machines.md``)."""


def heading(value: object) -> str:
    return value if isinstance(value, str) else ""


@pytest.mark.parametrize(("first", "count"), sizes((0, 3), (0, 500)))
@pytest.mark.parametrize(("dialect", "to"), DIRECTIONS, ids=heading)
def test_a_generated_program_is_proven_and_the_same_or_refused(
    dialect: str, to: str, first: int, count: int, record_property: Callable[[str, Any], None]
) -> None:
    figures = Figures()
    for seed in range(first, first + count):
        judge(dialect, to, seed, figures)
    record_property("figures", figures.text(dialect, to))
    assert not figures.wrong, "\n\n".join(figures.wrong[:5])
    if count > 100:
        assert figures.proven >= SHORTEST * count
        assert figures.lines_back <= LONGER * figures.lines or not figures.lines


# ---- LinuxCNC's interpreter


@pytest.mark.parametrize(("first", "count"), sizes((0, 4), (0, 500)))
@pytest.mark.parametrize(
    ("dialect", "to"), [pair for pair in DIRECTIONS if pair[1] in ("linuxcnc", "grbl")], ids=heading
)
def test_linuxcnc_makes_the_same_moves(dialect: str, to: str, first: int, count: int, peer: None) -> None:
    proven = {}
    for seed in range(first, first + count):
        done = judge(dialect, to, 2 * seed + 1, Figures())
        if done is not None and peer_can(done.files[""]):
            proven[seed] = done
    assert proven
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for seed, (ours, theirs) in zip(proven, both(list(proven.values()), folder), strict=True):
            assert len(ours) == len(theirs), seed
            for (op, numbers), (other, said) in zip(ours, theirs, strict=True):
                assert op == other, seed
                assert numbers == pytest.approx(said, abs=1e-4), seed


def peer_can(text: bytes) -> bool:
    """Whether the peer reads a text as LinuxCNC and grbl do: it has no G43.1 of grbl, and its M6 moves Z while a tool
    length is in force (``rs274_peer.py``)."""
    return b"G43" not in text


Moves = list[tuple[str, tuple[float, ...]]]


def both(done: list[Translation], folder: Path) -> list[tuple[Moves, Moves]]:
    """Moves of each source at zero, and those of the peer."""
    tools = dict.fromkeys(range(1, 4), (BY_MACHINES, 0.0))
    jobs = []
    for n, one in enumerate(done):
        program = folder / f"job{n}.ngc"
        text = one.files[""]
        # The peer wants an end; a stream for grbl has none.
        program.write_bytes(text if text.startswith(b"%") or b"M2" in text or b"M30" in text else text + b"M2\n")
        jobs.append(rs274_peer._job(folder, n, program, rs274_peer.Situation(tools=tools)))
    found = []
    for one, answer in zip(done, rs274_peer._listen(folder, jobs), strict=True):
        assert answer["error"] is None, f"line {answer['error_line']}: {answer['error']}\n{one.files[''].decode()}"
        machine = rs274_peer._Machine([0, *sorted(tools)])
        for name, line, arguments in answer["calls"]:
            machine.take(name, line, arguments)
        theirs = [move for row in machine.rows if (move := peer_move(row)) is not None]
        found.append((source_moves(one.session), without_rests(theirs)))
    return found


def source_moves(session: Session) -> Moves:
    """The moves of a source at zero, with the devices of its machine left to the machine."""
    assert session.program is not None
    nothing = Interval(0.0, 0.0)
    setup = replace(
        ZERO, tool_lengths=dict.fromkeys(range(4), nothing), work={(n, a): nothing for n in range(1, 10) for a in "xyz"}
    )
    machine = replace(session.machine, settings=replace(session.machine.settings, zero_offsets=None))
    return moves_of(execute(own_devices(session.program, []), setup, machine, Findings()))
