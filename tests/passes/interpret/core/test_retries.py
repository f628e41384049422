"""Subprograms that call themselves until an outcome or a counter ends it: followed as deep as calls may be (GP117)."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.campaigns import share
from support.command import Done, in_this_process

MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = 0
max = 100
[axes.y]
min = 0
max = 100
[axes.z]
min = -50
max = 0
[controller]
dialect = "eding"
"""
AGAIN = {
    "probe": ("G0 Z0\nG38.2 Z-10 F50\n", "if [#5067 == 0]"),
    "dialog": ('dlgmsg "again?"\n', "if [#5398 == 1]"),
    "typed": ('dlgmsg "again?" "once more" 60\n', "if [#60 > 0]"),
    "input": ("M56 P1 L0 Q1\n", "if [#5399 == 1]"),
    "nothing": ("", "if [1 == 1]"),
}
"""What decides about another try: lines before it, and the question."""
DEEPEST = 50


def retry(way: str, tries: int, step: float, *, through: bool = False) -> str:
    """A job whose subprogram goes ``step`` in X and tries again at most until ``tries`` tries are made."""
    lines, question = AGAIN[way]
    call = "gosub between" if through else "gosub again"
    return (
        "G21 G90\n#1 = 0\nG0 X0 Y5 Z0\ngosub again\nM30\n"
        f"sub between\ngosub again\nendsub\nsub again\n#1 = [#1 + 1]\nG0 X[#1 * {step}]\n{lines}{question}\n"
        f"if [#1 < {tries}]\n{call}\nelse\n#2 = 1\nendif\nendif\nendsub\n"
    )


def check(folder: Path, job: str) -> Done:
    (folder / "mill.toml").write_text(MACHINE)
    (folder / "job.cnc").write_text(job)
    return in_this_process(["check", "job.cnc", "--machine", "mill.toml", "--setup", "zero"], folder)


TRIES = [(way, tries) for way in AGAIN for tries in (1, 9)]
DEEP = [(way, DEEPEST) for way in AGAIN]


@pytest.mark.parametrize(("way", "tries"), [*TRIES, *share(DEEP, len(DEEP))])
def test_tries_that_are_counted_are_followed_to_their_end(way: str, tries: int, tmp_path: Path) -> None:
    done = check(tmp_path, retry(way, tries, 2.0))
    assert done.exit == 0 and "GP117" not in done.out, done.out
    furthest = f"{2.0 * tries:.3f}"
    assert f"... {furthest} mm" in done.out, done.out
    # The last try is one too far: 100.001 mm.
    done = check(tmp_path, retry(way, tries, 100.001 / tries))
    assert done.exit == 1 and "GP301" in done.out, done.out


@pytest.mark.parametrize("way", AGAIN)
@pytest.mark.parametrize("tries", [20])
def test_tries_by_way_of_another_subprogram(way: str, tries: int, tmp_path: Path) -> None:
    done = check(tmp_path, retry(way, tries, 1.0, through=True))
    assert done.exit == 0 and "GP117" not in done.out, done.out


@pytest.mark.parametrize("way", share([way for way in AGAIN if way != "nothing"], 2))
def test_more_tries_than_calls_may_be_deep_are_unknown(way: str, tmp_path: Path) -> None:
    done = check(tmp_path, retry(way, DEEPEST + 1, 1.0))
    assert (
        done.exit == 2 and f"unknown GP117 [recursion] subprogram calls are nested deeper than {DEEPEST}" in done.out
    ), done.out


@pytest.mark.parametrize("way", [way for way in AGAIN if way != "nothing"])
def test_tries_that_nothing_counts_are_unknown_soon(way: str, tmp_path: Path) -> None:
    lines, question = AGAIN[way]
    job = f"G21 G90\nG0 X5 Y5 Z0\ngosub again\nM30\nsub again\n{lines}{question}\ngosub again\nendif\nendsub\n"
    done = check(tmp_path, job)
    assert done.exit == 2 and "unknown GP117 [recursion] subprogram calls are nested deeper than 8" in done.out, (
        done.out
    )


def test_a_counter_that_ends_nothing_does_not_make_it_safe(tmp_path: Path) -> None:
    done = check(tmp_path, retry("probe", 100_000, 0.5))
    assert done.exit == 2 and "unknown GP117" in done.out, done.out
