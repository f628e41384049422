"""What the tests of this folder share: the files, and the two sides' rows for one of them."""

from __future__ import annotations

import functools
import json
from pathlib import Path

from differential import compare, gproof_side, rs274_peer
from support.bundles import CODE, MANUAL, Section, pages_of, sections, unpacked

FOLDER = unpacked("tests/differential")
"""The folders that the pages `programs.*.md`, `differences.md` and `rejected.md` hold."""
PROGRAMS = sorted((FOLDER / "programs").glob("*.ngc"))
EXPECTED = sorted((FOLDER / "programs").glob("*.jsonl"))
DIFFERENCES = sorted((FOLDER / "differences").glob("*.ngc"))
REJECTED = sorted((FOLDER / "rejected").glob("*.ngc"))
BATCH = 10  # neighbouring programs for one process of the peer; a worker of pytest gets neighbouring tests


def cases(folder: str) -> dict[str, Section]:
    """By name of the program what the pages of a folder say: its section of the manual, gproof's code, its files."""
    found: dict[str, Section] = {}
    for page in pages_of(f"tests/differential/{folder}"):
        for case in sections(page.read_text(encoding="utf-8"))[1:]:
            assert case.heading not in found, f"two cases {case.heading}"
            assert f"{case.heading}.ngc" in case.files, f"{page.name}: {case.heading} has no program of its name"
            assert all(name.partition(".")[0] == case.heading for name in case.files), case.heading
            assert case.said(MANUAL), f"{page.name}: {case.heading} has no section of the manual"
            found[case.heading] = case
    return found


def codes(folder: str) -> dict[str, str]:
    """By name of the program the code that gproof refuses it with; "": it does not."""
    return {name: case.said(CODE) for name, case in cases(folder).items()}


def setup_of(program: Path) -> Path | None:
    """The setup file beside a program; None where it runs under `--setup zero`."""
    setup = program.with_suffix(".setup.toml")
    return setup if setup.exists() else None


def hand_rows(path: Path) -> list[compare.Row]:
    """The rows that were worked out by hand from the manual."""
    return [json.loads(line) for line in path.read_text().splitlines()]


def peer_run(program: Path) -> rs274_peer.PeerRun:
    """The peer's run of a program; those of `programs/` a batch at a time, each batch once in a process of pytest."""
    group = DIFFERENCES if program in DIFFERENCES else PROGRAMS
    first, place = divmod(group.index(program), BATCH)
    batch = tuple(group[first * BATCH : (first + 1) * BATCH])
    try:
        return _run_peers(batch)[place]
    except rs274_peer.PeerError:  # of which program? one alone says it, and the others go on
        return _run_peers((program,))[0]


@functools.cache
def _run_peers(programs: tuple[Path, ...]) -> list[rs274_peer.PeerRun]:
    return rs274_peer.run_peers([(program, rs274_peer.situation_of(setup_of(program))) for program in programs])


def gproof_rows(program: Path, *, by_command: bool = False) -> list[compare.Row]:
    run = gproof_side.by_command if by_command else gproof_side.in_process
    return run(gproof_side.dump_arguments(program, setup_of(program))).rows()


def report(program: Path, difference: compare.Difference | None) -> str:
    """The message of a failed comparison: program, first differing rows, numbered lines."""
    text = program.read_text().splitlines()
    listing = "\n".join(f"{n:5} {line}" for n, line in enumerate(text[:400], start=1))
    return f"{program.name}: {difference}\n{listing}"
