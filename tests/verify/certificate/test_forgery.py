"""Forged packages are refused: every kind of damage to what a package says, to its container, signature and JSON.

``WITHIN`` lists the kinds that pass, each with the reason why nothing harmful is in them; docs/security.md points here.
"""

from __future__ import annotations

import random
import re
from collections import Counter
from pathlib import Path

import pytest
from support.campaigns import SOAK, sizes
from support.command import in_this_process
from support.guarded import alarm, memory
from verify.forgery import Kind, answer, containers, forged, kinds, packed, right_members, spoilt_package

SECONDS, BYTES = 10, 500 << 20
ONE_IN = 16
"""So many of all kinds are tried in every run, all of them in a soak."""

WITHIN: dict[str, str] = {
    # The trace is where the proof starts from: what it says beyond the path, the speeds, the events and the waits is
    # the word of who compiled the job. A trusted signature, or verify --against SOURCE, is what speaks for that.
    r"trace: files.*|trace: calls.*|trace: macro_files.*": "names of files and subprograms, for messages",
    r"trace: texts last twice|rows: \d (?!SETPOINT|OUTPUT)\w+ text .*": "texts of messages",
    r"rows: \d OUTPUT text .*": "the form of the command; its channel and value are in the event",
    r"trace: (states|frames) (last twice|turned round)": "states alike for every move, or a copy that no row uses",
    r"trace: states\.\d\.(spindle|spindle_limit|tool|work|laf_angle|path_tolerance|simplify|arc_tolerance|feed_mode|"
    r"path_mode|feed_override|overrides|compensation) .*": "what the checks of the trace judged",
    r"trace: states\.0\..*": "no row of the job is in this state",
    r"trace: sections\.\d\.edges\.\d\.(outcome|line|file) .*": "the name of an answer, the place of its line",
    r"rows: \d \w+ (line|file|call) .*": "places in the source, for messages",
    r"rows: \d \w+ state .*": "states that differ in tool and spindle speed alone",
    r"rows: \d (FEED|ARC|TRAVERSE) arg.*": "the programmed point, where no radius compensation is on",
    r"rows: \d END arg.*": "whether a code says that the program ends here",
    r"rows: \d SPINDLE arg\[1\] nan": "the speed of a spindle that is switched off",
    r"rows: \d (?!ARC)\w+ center.*|rows: \d ARC center\[2\].*": "arcs alone have a centre, in their plane",
    r"rows: \d (?!FEED|ARC)\w+ feed .*": "rows that are no feeds have none",
    r"rows: \d (FEED|ARC) feed (one more|a little more|largest)": "the steps are slower than this feed",
    r"rows: \d (FEED|ARC) feed one less": "within the bound of the speed: 2 steps in a window",
    r"rows: \d (TRAVERSE|FEED) twice": "a move to where it already is",
    # docs/verification.md, "The bounds are not zero": a tick, or fewer steps than a bound has.
    r"runs: \d/\d run \d+ (interval|add) (one (more|less)|a little more|negated|zero)": "a few ticks",
    r"runs: \d/\d run \d+ (before its neighbour)": "two runs that differ in ticks alone",
    r"events: \d event \d tick one (more|less)": "a tick",
    r"machine: board\.(port|baud) .*": "where the board is plugged in today: another port is the same machine",
    # docs/certificate.md, "The setup at hand".
    r"setup: name .*|setup: homed\.[45] .*|setup: homed (last twice|turned round)":
        "a name; axes that the machine does not have, or the same in another order",
    r"setup: homed lost": "where no setup states it the axes are taken to be homed, which is an assumption",
    r"setup: (work|tool_lengths)\..*\.(high (half more|inf|1e308|tiny)|low (negated|zero|tiny))":
        "the package was judged for more than is at hand",
    r"setup: work first lost|setup: block_delete lost": "what is not stated stands for what is at hand",
    # docs/certificate.md, "body.json": whoever signs says it; the runtime decides by the parts.
    r"body: (job|inputs|assumptions|not_judged)\b.*|body: with a key more|body: without "
    r"(job|inputs|assumptions|not_judged)":
        "what the author says of sources and of what stayed open: his signature stands for it, --source compares it",
    r"body: properties turned round": "the same properties",
    r"(machine|setup|trace|stream)\.ir a byte (less|more)": "the blank at the end of a text form",
}  # fmt: skip
"""What passes, as a pattern of names of kinds, and why."""

EXPECTED = {
    "machine": {"GP820", "GP823"},
    "setup": {"GP820", "GP825", "GP810"},
    "trace": {"GP820", "GP824", "GP825", *(f"GP{number}" for number in range(801, 811))},
    "body": {"GP820", "GP824", "GP825", "GP850", "GP857"},
}
"""Findings that refuse a kind, by part; the trace's stand for rows, runs, events and the stream too."""

CONTAINER = {"GP820", "GP821", "GP822", "GP824", "GP827", "GP857"}

PARTS = ("machine", "setup", "trace", "stream", "body", "rows", "runs", "events")


def within(name: str) -> str:
    """Why a kind may pass; empty: it may not."""
    return next((why for pattern, why in WITHIN.items() if re.fullmatch(pattern, name)), "")


def chosen(part: str) -> list[Kind]:
    mine = [kind for kind in kinds() if kind.part == part]
    return mine if SOAK else mine[:: max(1, min(ONE_IN, len(mine) // 40))]


def judged(data: bytes, path: Path) -> set[str]:
    path.write_bytes(data)
    with alarm(SECONDS), memory(BYTES):
        return answer(path)


def test_the_right_package_runs(tmp_path: Path) -> None:
    assert judged(packed(right_members()), tmp_path / "right.gpx") == set()


def test_there_are_hundreds_of_kinds() -> None:
    assert sum(len(chosen(part)) for part in PARTS) >= 300
    assert len(kinds()) >= 3000
    assert len(containers()) >= 100


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("part", PARTS)
def test_each_kind_is_refused_or_within_the_bounds(part: str, tmp_path: Path) -> None:
    wrong, answers = [], Counter[str]()
    for kind in chosen(part):
        try:
            data = forged(kind)
        except (ValueError, TypeError, AttributeError, OverflowError, LookupError):
            continue  # what no writer can write is no package
        found = judged(data, tmp_path / "forged.gpx")
        answers.update(found or {"within"})
        if not found and not within(str(kind)):
            wrong.append(f"{kind}: would run")
        elif found and not found & EXPECTED.get(part, EXPECTED["trace"]):
            wrong.append(f"{kind}: {sorted(found)}")
    assert not wrong, "\n".join(wrong)
    assert sum(answers.values()) >= 20, answers
    assert set(answers) - {"within"}


def test_damaged_containers_signatures_and_json_are_refused(tmp_path: Path) -> None:
    wrong = []
    for name, forge in containers().items():
        try:
            data = forge(right_members())
        except ValueError:
            continue
        found = judged(data, tmp_path / "forged.gpx")
        if not found and not within(name):
            wrong.append(f"{name}: would run")
        elif found and not found & (CONTAINER | (EXPECTED["trace"] if ".bin" in name else set())):
            wrong.append(f"{name}: {sorted(found)}")
    assert not wrong, "\n".join(wrong)


def test_each_reason_is_needed() -> None:
    names = [*map(str, kinds()), *containers()]
    for pattern in WITHIN:
        assert any(re.fullmatch(pattern, name) for name in names), pattern


def test_the_command_refuses_what_the_library_refuses(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("GPROOF_TRACEBACK", "1")
    path = tmp_path / "forged.gpx"
    for kind in random.Random(17).sample(kinds(), 400 if SOAK else 20):
        try:
            path.write_bytes(forged(kind))
        except (ValueError, TypeError, AttributeError, OverflowError, LookupError):
            continue
        with alarm(SECONDS), memory(BYTES):
            done = in_this_process(["verify", "forged.gpx"], tmp_path)
        assert done.exit in (0, 1, 2), (str(kind), done)
        assert "\x1b" not in done.out + done.err, str(kind)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("count", sizes(150, 20_000))
def test_random_corruptions_are_answered(count: int, tmp_path: Path) -> None:
    path, refused = tmp_path / "spoilt.gpx", 0
    for number in range(count):
        path.write_bytes(spoilt_package(random.Random(f"corruption {number}"), ()))
        try:
            with alarm(SECONDS), memory(BYTES):
                refused += bool(answer(path))
        except BaseException:
            print(f"corruption {number}\n{path.read_bytes()!r}")
            raise
    assert refused > count * 0.8
