"""The comparator notices every seeded difference and lets pass what its rules allow, and nothing else."""

from __future__ import annotations

import copy
import itertools
from collections.abc import Iterator
from pathlib import Path

import pytest
from differential.compare import A_BIT, LENGTH, MOVES, Row, first_difference, normal
from differential.traces import EXPECTED, hand_rows

TO = {"x": 0.0, "y": 0.0, "z": 0.0, "a": 0.0, "b": 0.0, "c": 0.0}


def to(**axes: float) -> dict[str, float]:
    return {**TO, **axes}


def move(op: str, line: int = 1, feed: float = 100.0, **axes: float) -> Row:
    return {"op": op, "line": line, "to": to(**axes), **({"feed": feed} if op != "traverse" else {})}


def spindle(line: int, direction: str, rpm: float) -> Row:
    return {"op": "spindle", "line": line, "dir": direction, "rpm": rpm}


def coolant(line: int, mist: bool, flood: bool) -> Row:
    return {"op": "coolant", "line": line, "mist": mist, "flood": flood}


def mutants(rows: list[Row]) -> Iterator[tuple[str, list[Row]]]:
    """Every trace that differs from the given one in one thing of one row, with what was changed."""

    def changed(k: int, **values: object) -> list[Row]:
        copied = copy.deepcopy(rows)
        copied[k].update(values)
        return copied

    for k, row in enumerate(rows):
        yield f"row {k} missing", rows[:k] + rows[k + 1 :]
        yield f"row {k} on another line", changed(k, line=row["line"] + 1)
        if k and rows[k - 1] != row:
            yield f"rows {k - 1} and {k} swapped", [*rows[: k - 1], row, rows[k - 1], *rows[k + 1 :]]
        if row["op"] in MOVES:
            for axis in TO:
                beside = row["to"].get(axis, 0.0) - 2 * LENGTH  # below: rule 6 lets a bit above pass
                yield f"row {k} {axis}", changed(k, to={**row["to"], axis: beside})
            yield f"row {k} nowhere", changed(k, to={**row["to"], "x": float("nan")})
            yield f"row {k} another kind", changed(k, op="feed" if row["op"] != "feed" else "traverse")
        if "feed" in row:
            yield f"row {k} feed", changed(k, feed=row["feed"] * 1.0001)
            yield f"row {k} no feed", changed(k, feed=None)
        if row["op"] == "arc":
            p, q = row["center"]
            yield f"row {k} centre", changed(k, center=[p + 2 * LENGTH, q])
            yield f"row {k} other centre", changed(k, center=[p, q - 2 * LENGTH])
            yield f"row {k} sense", changed(k, turns=-row["turns"])
            yield f"row {k} two turns", changed(k, turns=2 * row["turns"])
            yield f"row {k} plane", changed(k, plane={"XY": "XZ", "XZ": "YZ", "YZ": "XY"}[row["plane"]])
            yield f"row {k} tilted", changed(k, normal=[0.0, 0.6, 0.8])
        if row["op"] == "spindle":
            turned = {"cw": "ccw", "ccw": "off", "off": "cw"}[row["dir"]]
            yield f"row {k} direction", changed(k, dir=turned, rpm=row["rpm"] or 100.0)
            if row["dir"] != "off":
                yield f"row {k} speed", changed(k, rpm=row["rpm"] + 1.0)
        if row["op"] == "coolant":
            yield f"row {k} mist", changed(k, mist=not row["mist"])
            yield f"row {k} flood", changed(k, flood=not row["flood"])
        for key, value in (("seconds", 0.001), ("tool", 1)):
            if key in row:
                yield f"row {k} {key}", changed(k, **{key: row[key] + value})
        if row["op"] == "stop":
            yield f"row {k} optional", changed(k, optional=not row["optional"])
    yield "an error at the end", [*rows[:-1], {"op": "error", "line": 1, "code": "GP101", "text": ""}]
    yield "something after the end", [*rows, move("traverse", rows[-1]["line"], x=-77.0)]


@pytest.mark.parametrize("path", EXPECTED, ids=lambda path: path.stem)
def test_every_mutant_is_noticed(path: Path) -> None:
    rows = normal(hand_rows(path))
    assert first_difference(rows, rows) is None
    tried = 0
    for what, mutant in mutants(rows):
        difference = first_difference(mutant, rows)
        assert difference is not None, f"not noticed: {what}"
        assert first_difference(rows, mutant) is not None, f"not noticed the other way round: {what}"
        tried += 1
    assert tried > 3 * len(rows)


def test_message_names_both_rows_and_lines() -> None:
    difference = first_difference([move("feed", 3, x=1.0)], [move("feed", 4, x=1.0)])
    assert difference is not None
    assert "line 3 against 4" in str(difference)
    assert "gproof (line 3)" in str(difference)
    assert "peer (line 4)" in str(difference)
    missing = first_difference([], [move("feed", 4, x=1.0)], ("left", "right"))
    assert missing is not None and "left: no more rows" in str(missing)


def test_rounding_passes_and_no_more() -> None:
    rows = [move("feed", x=1.0)]
    assert first_difference([move("feed", x=1.0 + 0.9 * LENGTH)], rows) is None
    assert first_difference([move("feed", x=1.0 + 1.1 * LENGTH)], rows) is not None


def test_rows_without_effect_and_moves_without_length_do_not_count() -> None:
    rows = [move("traverse", x=1.0), {"op": "plane", "line": 2, "plane": "XZ"}, move("feed", 3, x=1.0)]
    assert normal(rows) == [move("traverse", x=1.0)]
    assert normal([move("traverse")]) == []


def test_whole_circle_counts() -> None:
    arc = {**move("arc"), "plane": "XY", "center": [5.0, 0.0], "turns": -1}
    assert normal([arc]) == [arc]


def test_many_tiny_moves_are_not_lost() -> None:
    creeping = [move("feed", line, x=line * 4e-7) for line in range(1, 1001)]
    assert abs(normal(creeping)[-1]["to"]["x"] - 4e-4) < 2e-6


def test_spindle_and_coolant_are_states() -> None:
    assert normal([spindle(1, "cw", 600.0), spindle(1, "ccw", 600.0)]) == [spindle(1, "ccw", 600.0)]
    assert len(normal([spindle(1, "cw", 600.0), spindle(2, "ccw", 600.0)])) == 2
    assert normal([spindle(1, "off", 600.0), coolant(1, False, False)]) == []
    assert normal([spindle(1, "cw", 0.0), spindle(2, "cw", 500.0)]) == [spindle(2, "cw", 500.0)]
    assert len(normal([coolant(1, True, False), coolant(1, True, True), coolant(2, False, False)])) == 2
    run = [spindle(1, "cw", 600.0), spindle(2, "cw", 600.0), spindle(3, "cw", 700.0)]
    assert [row["line"] for row in normal(run)] == [1, 3]


def test_tool_change_rests_the_spindle() -> None:
    change = {"op": "tool_change", "line": 5, "tool": 2}
    start, again = spindle(1, "cw", 600.0), spindle(6, "cw", 600.0)
    ways = [
        [start, change, again],
        [start, spindle(5, "off", 0.0), change, again],
        [start, change, spindle(5, "off", 0.0), again],
        [start, spindle(5, "cw", 700.0), spindle(5, "off", 0.0), change, again],
    ]
    for one, other in itertools.combinations(ways, 2):
        assert first_difference(one, other) is None
    stopped_before = [start, spindle(4, "off", 0.0), change, again]
    assert first_difference(stopped_before, ways[0]) is not None


def test_end_rests_spindle_and_coolant() -> None:
    end = {"op": "end", "line": 9}
    start = [spindle(1, "cw", 600.0), coolant(2, False, True)]
    rests = [spindle(9, "off", 0.0), coolant(9, False, False)]
    assert first_difference([*start, *rests, end], [*start, end]) is None
    assert first_difference([*start, end, *rests], [*start, end]) is None
    assert first_difference([*start, spindle(8, "off", 0.0), end], [*start, end]) is not None


def test_pecks_may_back_off_by_a_bit_and_no_more() -> None:
    def peck(back: float, bottom: float = -3.0) -> list[Row]:
        return [
            move("feed", 4, z=-1.5),
            move("traverse", 4, z=1.0),
            move("traverse", 4, z=-1.5 + back),
            move("feed", 4, z=bottom),
        ]

    assert first_difference(peck(0.254), peck(0.5)) is None
    assert first_difference(peck(0.254), peck(0.0)) is None
    assert first_difference(peck(0.254), peck(1.01 * A_BIT)) is not None
    assert first_difference(peck(0.254), peck(-0.1)) is not None
    assert first_difference(peck(0.254), peck(0.254, -3.001)) is not None
