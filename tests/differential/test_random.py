"""Random programs mean the same to gproof and to LinuxCNC's interpreter; a failure prints seed and program.

Two hundred in every run, two thousand more in `make soak`. GPROOF_SOAK_SEED moves the latter elsewhere.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from differential import gproof_side, rs274_peer
from differential.compare import Difference, first_difference
from differential.random_programs import random_program, shrink

BATCH = 25  # programs for one process of the peer
FIRST = int(os.environ.get("GPROOF_SOAK_SEED", "100000"))


def difference(path: Path, text: str) -> Difference | str | None:
    """What tells gproof and the peer apart on a program; a text where one of them does not finish it."""
    path.write_text(text)
    run = rs274_peer.run_peer(path, rs274_peer.situation_of(None))
    return judge(path, run) if run.accepted else f"the peer refuses: {run.error}"


def differs(path: Path, text: str) -> bool:
    """Whether a shortened program still tells them apart; one that left the shared language does not count."""
    try:
        found = difference(path, text)
    except rs274_peer.PeerError:
        return False
    return found is not None and not str(found).startswith("the peer")


def judge(path: Path, run: rs274_peer.PeerRun) -> Difference | str | None:
    said = gproof_side.in_process(gproof_side.dump_arguments(path, None))
    try:
        return first_difference(said.rows(), run.rows)
    except AssertionError as silent:
        return str(silent)


def check(seeds: range, folder: Path) -> None:
    """Compare the programs of some seeds; the first that differs fails, with a smaller program beside it."""
    paths = []
    for seed in seeds:
        paths.append(folder / f"{seed}.ngc")
        paths[-1].write_text(random_program(seed).text)
    runs = rs274_peer.run_peers([(path, rs274_peer.situation_of(None)) for path in paths])
    for seed, path, run in zip(seeds, paths, runs, strict=True):
        assert run.accepted, f"seed {seed}: the generator left the shared language: {run.error}\n{path.read_text()}"
        found = judge(path, run)
        if found:
            text = path.read_text()
            small = shrink(text, lambda smaller: differs(folder / "smaller.ngc", smaller))
            rest = difference(folder / "smaller.ngc", small)
            pytest.fail(f"seed {seed}: {found}\n\n{text}\nsmaller, with {rest}\n\n{small}")


@pytest.mark.usefixtures("peer", "gproof")
@pytest.mark.parametrize("first", range(0, 50, BATCH))
def test_random_programs(first: int, tmp_path: Path) -> None:
    check(range(first, first + BATCH), tmp_path)


@pytest.mark.soak
@pytest.mark.usefixtures("peer", "gproof")
@pytest.mark.parametrize("first", range(FIRST, FIRST + 2000, BATCH))
def test_many_random_programs(first: int, tmp_path: Path) -> None:
    check(range(first, first + BATCH), tmp_path)


@pytest.mark.soak
@pytest.mark.usefixtures("peer", "gproof")
@pytest.mark.parametrize("seed", range(FIRST, FIRST + 4))
@pytest.mark.parametrize("kernels", ["python", "numba"])
def test_long_random_program(seed: int, kernels: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Many statements, in both speeds of gproof's hot loops."""
    monkeypatch.setenv("GPROOF_KERNELS", kernels)
    path = tmp_path / f"{seed}.ngc"
    path.write_text(random_program(seed, 5000).text)
    found = difference(path, path.read_text())
    assert found is None, f"seed {seed}, 5000 statements: {found}"


@pytest.mark.usefixtures("peer")
def test_generator_knows_where_it_is(tmp_path: Path) -> None:
    """The generator's own model and the peer agree where each program ends: a third opinion."""
    programs = [random_program(seed) for seed in range(40)]
    paths = [tmp_path / f"{program.seed}.ngc" for program in programs]
    for path, program in zip(paths, programs, strict=True):
        path.write_text(program.text)
    runs = rs274_peer.run_peers([(path, rs274_peer.situation_of(None)) for path in paths])
    for program, run in zip(programs, runs, strict=True):
        moves = [row for row in run.rows if "to" in row]
        reached = moves[-1]["to"] if moves else dict.fromkeys("xyzabc", 0.0)
        for axis, end in program.end.items():
            assert reached[axis.lower()] == pytest.approx(end, abs=1e-4), f"{axis}\n{program.text}"


def test_seed_decides_everything() -> None:
    assert random_program(7) == random_program(7)
    assert random_program(7).text != random_program(8).text


def test_programs_are_varied() -> None:
    """What the generator is for occurs, and often."""
    text = "\n".join(random_program(seed).text.upper() for seed in range(200))
    for wanted in "G2 G3 G17 G18 G19 G20 G21 G28 G30 G43 G49 G53 G55 G59.3 G61 G64 G80 G81 G82 G83 G85".split():
        assert wanted in text
    for wanted in "G86 G89 G90 G91 G92 G92.1 G92.2 G92.3 G93 G94 G98 G99 L20 M0 M1 M3 M4 M5 M6 M7 M8 M9".split():
        assert wanted in text


def test_shrinking_keeps_the_failure() -> None:
    text = random_program(3).text + "M0\n"
    small = shrink(text + "M2\n", lambda smaller: "M0" in smaller)
    assert "M0" in small and len(small.splitlines()) <= 4
