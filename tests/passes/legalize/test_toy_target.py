"""A target that has moves only is a table and a printer (tests/additions/toy_target.py), without another edit.

Jobs of the corpus with loops, subprograms, variables, arcs and helices are brought down to it. A small reader of its
text gives the same moves, one by one, as the interpreter gives of the source.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from additions.toy_target import TARGET, write
from hand.compare import rows_of
from support.goldens import ROOT

from gproof.driver.running import begin
from gproof.driver.session import Session, open_session
from gproof.driver.translation import raised
from gproof.ir.finding import Findings
from gproof.ir.job import Job, Node, SwitchCoolant, TurnSpindle
from gproof.passes.legalize.legalize import legalize
from gproof.passes.legalize.options import Options
from gproof.passes.legalize.registry import PATTERNS

EDING = ROOT / "corpus" / "eding"
PRINTED = 1e-5
"""mm: half of the last digit that is printed, twice."""
CHORD = 0.01


def session_of(name: str) -> Session:
    """A job of the corpus at machine zero."""
    machine = EDING / "machines" / "bench-mill.toml"
    return open_session(EDING / name / "job.cnc", machine=machine, setup="zero", dialect=None)


def without_devices(job: Job) -> Job:
    """A plotter has no spindle and no coolant."""

    def kept(body: tuple[Node, ...]) -> tuple[Node, ...]:
        return tuple(node for node in body if not isinstance(node, TurnSpindle | SwitchCoolant))

    routines = {name: replace(one, body=kept(one.body)) for name, one in job.routines.items()}
    return replace(job, body=kept(job.body), routines=routines)


def read(text: str) -> list[tuple[bool, tuple[float, float, float], float]]:
    """(rapid, place, feed) of each move of a text; a word that is unknown is an error."""
    place, feed, found, ended = {"x": 0.0, "y": 0.0, "z": 0.0}, math.nan, [], False
    for line in text.splitlines():
        if line.startswith("#"):
            continue
        assert not ended
        kind, *words = line.split()
        ended = kind == "end"
        if ended:
            continue
        assert kind in ("rapid", "cut")
        for word in words:
            if word[0] == "f":
                feed = float(word[1:])
            else:
                assert word[0] in place
                place[word[0]] = float(word[1:])
        found.append((kind == "rapid", (place["x"], place["y"], place["z"]), feed))
    assert ended
    return found


def target_moves(name: str) -> tuple[list[tuple[bool, tuple[float, float, float], float]], set[str]]:
    """What the toy's text does, and the patterns that made it."""
    session = session_of(name)
    legal = legalize(without_devices(raised(session)), TARGET, Options(chord_tolerance=CHORD))
    assert legal.refused == []
    files = write(legal.job, TARGET, session.machine, TARGET.style)
    return read(files[""].decode()), {one.pattern for one in legal.lowered}


def source_moves(name: str) -> list[dict[str, Any]]:
    """Rapids, feeds and arcs of the source, as the interpreter has them."""
    session = session_of(name)
    assert session.program is not None
    findings = Findings()
    rows = rows_of(begin(session.program, session.setup, session.machine, findings), session.machine, (), session.job)
    return [row for row in rows if row["op"] in {"traverse", "feed", "arc"}]


def same_moves(source: list[dict[str, Any]], target: list[tuple[bool, tuple[float, float, float], float]]) -> None:
    """Each row of the source in turn: one move of the target, or for an arc as many as its chords are."""
    at, before = 0, (0.0, 0.0, 0.0)
    for row in source:
        end = tuple(row["to"][axis] for axis in "xyz")
        if row["op"] != "arc":
            is_rapid, place, feed = target[at]
            assert is_rapid == (row["op"] == "traverse"), row
            assert math.dist(place, end) < PRINTED, row
            assert is_rapid or feed == pytest.approx(row["feed"])
            at, before = at + 1, place
            continue
        at, before = at + follow(row, before, target[at:]), end
    assert at == len(target)


def follow(
    row: dict[str, Any], before: tuple[float, ...], target: list[tuple[bool, tuple[float, float, float], float]]
) -> int:
    """How many moves are the chords of an arc in XY: on its circle, in its sense, with even steps in Z, to its end."""
    (u, v), end = row["center"], tuple(row["to"][axis] for axis in "xyz")
    radius = math.dist(before[:2], (u, v))
    angle = turned = 0.0
    whole = math.atan2(end[1] - v, end[0] - u) - math.atan2(before[1] - v, before[0] - u)
    whole %= math.copysign(2 * math.pi, row["turns"])
    if abs(whole) < 1e-6 or abs(abs(whole) - 2 * math.pi) < 1e-6:
        whole = math.copysign(2 * math.pi, row["turns"])
    last, angle = before, math.atan2(before[1] - v, before[0] - u)
    for count, (is_rapid, place, feed) in enumerate(target, 1):
        assert not is_rapid and feed == pytest.approx(row["feed"]), row
        assert math.dist(place[:2], (u, v)) == pytest.approx(radius, abs=2e-3), row
        middle = math.dist(((last[0] + place[0]) / 2, (last[1] + place[1]) / 2), (u, v))
        assert radius - middle < CHORD + PRINTED, row
        now = math.atan2(place[1] - v, place[0] - u)
        turned += (now - angle + math.pi) % (2 * math.pi) - math.pi
        angle, last = now, place
        assert turned * row["turns"] > 0.0, row
        assert place[2] == pytest.approx(before[2] + (end[2] - before[2]) * turned / whole, abs=1e-3), row
        if abs(turned - whole) < 1e-4:
            assert math.dist(place, end) < PRINTED, row
            return count
    raise AssertionError(f"no end of {row}")


JOBS = {
    "pocket-in-steps": {"subprogram -> what it does", "loop -> its passes", "relative places -> absolute places"},
    "thread-milling": {"arc -> chords", "expression -> number", "message -> comment"},
}


@pytest.mark.parametrize("name", JOBS)
def test_a_job_of_the_corpus_comes_down_to_moves(name: str) -> None:
    moves, patterns = target_moves(name)
    assert patterns >= JOBS[name]
    assert patterns <= {pattern.name for pattern in PATTERNS}
    same_moves(source_moves(name), moves)


def test_a_move_that_is_left_out_or_wrong_is_seen() -> None:
    name = "thread-milling"
    source, (moves, _) = source_moves(name), target_moves(name)
    (is_rapid, (x, y, z), feed) = moves[40]
    for wrong in (
        moves[:-1], moves[:40] + moves[41:], [*moves[:40], (is_rapid, (x, -y, z), feed), *moves[41:]],
        [*moves[:40], (is_rapid, (x, y, z), feed / 2), *moves[41:]], [*moves, moves[-1]],
    ):  # fmt: skip
        with pytest.raises((AssertionError, IndexError)):
            same_moves(source, wrong)


def test_the_table_is_one_that_can_be() -> None:
    TARGET.verify()
    assert Path(write.__code__.co_filename).is_relative_to(ROOT / "tests")
