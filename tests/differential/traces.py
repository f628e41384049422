"""What the tests of this folder share: the files, and the two sides' rows for one of them."""

from __future__ import annotations

import json
from pathlib import Path

from differential import compare, gproof_side, rs274_peer

HERE = Path(__file__).parent
PROGRAMS = sorted((HERE / "programs").glob("*.ngc"))
EXPECTED = sorted((HERE / "expected").glob("*.jsonl"))
DIFFERENCES = sorted((HERE / "differences").glob("*.ngc"))
REJECTED = sorted((HERE / "rejected").glob("*.ngc"))


def setup_of(program: Path) -> Path | None:
    """The setup file beside a program; None where it runs under `--setup zero`."""
    setup = program.with_suffix(".setup.toml")
    return setup if setup.exists() else None


def hand_rows(path: Path) -> list[compare.Row]:
    """The rows that were worked out by hand from the manual."""
    return [json.loads(line) for line in path.read_text().splitlines()]


def peer_run(program: Path) -> rs274_peer.PeerRun:
    return rs274_peer.run_peer(program, rs274_peer.situation_of(setup_of(program)))


def gproof_rows(program: Path, *, in_process: bool = False) -> list[compare.Row]:
    run = gproof_side.in_process if in_process else gproof_side.by_command
    return run(gproof_side.dump_arguments(program, setup_of(program))).rows()


def report(program: Path, difference: compare.Difference | None) -> str:
    """The message of a failed comparison: program, first differing rows, numbered lines."""
    text = program.read_text().splitlines()
    listing = "\n".join(f"{n:5} {line}" for n, line in enumerate(text[:400], start=1))
    return f"{program.name}: {difference}\n{listing}"
