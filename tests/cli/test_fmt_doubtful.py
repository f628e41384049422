"""``gproof fmt`` leaves a line that gproof does not understand as it was, byte for byte, in every language.

Which lines these are is told by ``check``, not by fmt: the bad programs of docs/codes, and random lines with mistakes.
"""

from __future__ import annotations

import json
import random
from pathlib import Path

import pytest
from support.bundles import unpacked
from support.campaigns import share
from support.command import in_this_process

OF_READING = {"GP101", "GP109", "GP110", "GP111", "GP112", "GP121", "GP127", "GP134", "GP228", "GP275"}
"""What a line has because of its words alone, whatever ran before it."""
BAD = sorted(path for suffix in ("cnc", "tap", "src") for path in unpacked("docs/codes").glob(f"*/*bad*.{suffix}"))
SUFFIX = {"eding": "cnc", "wincnc": "tap", "mcuwin": "src"}
SEEDS = range(2)
LINES = 40

IDIOMS = [
    "g53 t{t}z+3.5", "g53t2y-2", "g53  t2 x+0.50", "g0 p1  z+1", "t2x5.", "g53 h1  z-.5", "m6=g53t{t}  z+3.5",
]  # fmt: skip


def refused(job: Path, dialect: str) -> set[int]:
    """Lines of which ``check`` says that it does not understand them."""
    done = in_this_process(["check", job.name, "--dialect", dialect, "--format", "json"], job.parent)
    if not done.out.startswith("{"):
        return set()
    found = json.loads(done.out)["findings"]
    # Whether an argument is taken hangs on the modes in force there (Eding, G83).
    of_reading = OF_READING - {"GP121"} if dialect == "eding" else OF_READING
    weighty = [one for one in found if one["severity"] in ("error", "unknown") and one["code"] in of_reading]
    return {one["line"] for one in weighty if one.get("file") and Path(one["file"]).name == job.name}


def formatted(job: Path, dialect: str) -> bytes | None:
    done = in_this_process(["fmt", job.name, "--dialect", dialect, "--stdout"], job.parent)
    return done.out.encode() if done.exit == 0 else None


def dialect_of(job: Path) -> str:
    return next(name for name, suffix in SUFFIX.items() if job.suffix == f".{suffix}")


@pytest.mark.parametrize("bad", share(BAD, 12), ids=lambda path: f"{path.parent.name}-{path.suffix[1:]}-{path.stem}")
def test_bad_programs_of_the_codes_keep_their_lines(bad: Path, tmp_path: Path) -> None:
    raw = bad.read_bytes()
    if not raw.isascii():
        return
    job = tmp_path / f"job{bad.suffix}"
    job.write_bytes(raw)
    out = formatted(job, dialect_of(bad))
    if out is None:
        return
    before, after = raw.split(b"\n"), out.split(b"\n")
    for line in sorted(refused(job, dialect_of(bad))):
        assert after[line - 1].rstrip(b"\r") == before[line - 1].rstrip(b"\r"), line


@pytest.mark.parametrize("line", IDIOMS)
def test_a_sign_in_an_idiom_stays(line: str, tmp_path: Path) -> None:
    name = "cnc.mac" if "=" in line else "job.tap"
    (tmp_path / name).write_text(f"g90  g0x1\n{line}\n" if name == "job.tap" else f"{line}\n", "utf-8")
    done = in_this_process(["fmt", name, "--dialect", "wincnc", "--stdout"], tmp_path)
    assert done.exit == 0
    assert done.out.splitlines()[-1] == line


WORDS = {
    "eding": "g0 G1 g17 g18 g90 m3 m5 m999 g12 x1.50 x2 y-.5 z3 f100 q4 s5".split(),
    "wincnc": "g0 G1 g53 g92 l82 m11 m999 g17 c1 x1.50 x2 y-.5 z+3 f100 t2 q4".split(),
    "mcuwin": "G00 G01 g04 G90 G91 M03 G17 G12 X1.50 X2 Y-.5 Z3 F100 D1 S5 L2".split(),
}


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("dialect", SUFFIX)
def test_random_lines_with_mistakes_stay(dialect: str, seed: int, tmp_path: Path) -> None:
    rng = random.Random(seed)
    job = tmp_path / f"job.{SUFFIX[dialect]}"
    kept = 0
    for _ in range(LINES):
        words = rng.choices(WORDS[dialect], k=rng.randrange(1, 5))
        text = rng.choice(["", " ", "  "]).join(words)
        job.write_text(text + "\n", "utf-8")
        out = formatted(job, dialect)
        if out is not None and 1 in refused(job, dialect):
            kept += 1
            assert out == job.read_bytes(), f"seed {seed}\n{text}"
    assert kept > 3 or dialect == "mcuwin"
