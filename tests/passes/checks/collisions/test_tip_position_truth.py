"""What is known of the tip without an offset being stated holds for every value of the offset: random programs.

Each program runs once with offsets that nobody stated, and again with numbers for all of them. Where the first run
knows the tip, the others find it at the same place, and they know no less.
"""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
from passes.checks.collisions.test_tip_position import DIN, TABLE, Placed, wincnc
from support.campaigns import seeds

from gproof.ir.trace import Op
from gproof.ir.workpiece import ACTIVE, MACHINE

WORKS = (1, 2, ACTIVE, MACHINE)


def number(rng: random.Random) -> str:
    return f"{rng.randint(-400, 400) / 8:g}"


def words(rng: random.Random, letters: str = "XYZ") -> str:
    chosen = [letter for letter in letters if rng.random() < 0.6] or [rng.choice(letters)]
    return " ".join(letter + number(rng) for letter in chosen)


def eding(rng: random.Random) -> str:
    lines = ["G21 G17 G90 G94 G40 G80", rng.choice(["G54", "G55", ""])]
    for _ in range(rng.randint(8, 30)):
        lines.append(rng.choice([
            f"G0 {words(rng)}", f"G0 {words(rng)}", f"G1 {words(rng)} F500", f"G92 {words(rng)}", "G92.1", "G92.2",
            "G92.3", "G54", "G55", f"G10 L2 P{rng.randint(1, 2)} {words(rng)}",
            f"G10 L20 P{rng.randint(1, 2)} {words(rng)}", "G43", f"G43 H{rng.randint(1, 3)}", "G49",
            f"G43.1 K{number(rng)}", f"T{rng.randint(1, 3)} M6", "G90", "G91", f"G53 G0 {words(rng)}",
        ]))  # fmt: skip
    return "\n".join([*lines, "M30", ""])


def single(rng: random.Random) -> str:
    lines = ["G90"]
    for _ in range(rng.randint(8, 30)):
        lines.append(rng.choice([
            f"G0 {words(rng)}", f"G0 {words(rng)}", f"G1 {words(rng)}", f"G92 {words(rng)}", "G92",
            f"G92.1 {words(rng)}", f"G92.2 {words(rng)}", "G92.3", f"M37 Z{number(rng)}", "G43", "G49",
            f"L101 T{rng.randint(1, 3)}", "G90", "G91", f"G53 {words(rng)}",
        ]))  # fmt: skip
    return "\n".join([*lines, ""])


def blocks(rng: random.Random) -> str:
    lines = ["% P", "G90"]
    for _ in range(rng.randint(8, 30)):
        lines.append(rng.choice([
            f"G00 {words(rng)}", f"G00 {words(rng)}", f"G54\nG90\nG00 {words(rng)}", "G55", "G90", "G91", "G53\nG90",
            f"G92 {words(rng)}",
        ]))  # fmt: skip
    return "\n".join([*lines, "M30", ""])


def stated(rng: random.Random, dialect: str) -> str:
    """Numbers for all that a setup can state of zeros."""

    def axes(name: str) -> str:
        return f"[{name}]\n" + "".join(f"{axis} = {float(number(rng))}\n" for axis in "xyz")

    text = ("" if dialect == "mcuwin" else "active_work = 1\n") + axes("start") + axes("g92")
    if dialect == "eding":
        text += axes("work.1") + axes("work.2")
    return text + "".join(f"[tools.{n}]\nlength = {float(number(rng))}\n" for n in (2, 3))


def table_of(rng: random.Random) -> str:
    rows = [[float(number(rng)) for _ in range(3)] for _ in range(5)]
    return f"zero_offsets = {rows}\n"


def run(folder: Path, dialect: str, text: str, setup: str, rng: random.Random | None) -> Placed:
    folder.mkdir()
    if dialect == "wincnc":
        return wincnc(folder, text, setup)
    if dialect == "mcuwin":
        (folder / "McuWIN.ini").write_text("[MCU]\n")
        return Placed(folder, "job.src", text, DIN + ("" if rng is None else table_of(rng)), setup)
    unmeasured = TABLE.replace("length = 65.0\n", "")
    return Placed(folder, "job.cnc", text, unmeasured, setup)


def table(job: Placed, work: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows that move of all sections: lines, whether their ends are known by axis, and the ends."""
    lines, known, ends = [], [], []
    for chunk, tips in zip(job.chunks, job.tips(work), strict=True):
        moves = chunk.rows["op"] < Op.DWELL
        lines.append(chunk.rows["line"][moves])
        known.append(tips.end_known[moves])
        ends.append(tips.end[moves])
    return np.concatenate(lines), np.concatenate(known), np.concatenate(ends)


@pytest.mark.parametrize("dialect", ["eding", "wincnc", "mcuwin"])
@pytest.mark.parametrize("seed", seeds(4, 300))
def test_known_without_offsets_is_so_with_any(tmp_path: Path, seed: int, dialect: str) -> None:
    rng = random.Random(f"{dialect} {seed}")
    text = {"eding": eding, "wincnc": single, "mcuwin": blocks}[dialect](rng)
    base = "" if rng.random() < 0.5 or dialect == "mcuwin" else "active_work = 1\n"
    bare = run(tmp_path / "bare", dialect, text, base, None)
    for turn in range(2):
        exact = run(tmp_path / f"exact{turn}", dialect, text, stated(rng, dialect), rng)
        for work in WORKS:
            lines, known, ends = table(bare, work)
            others, more, places = table(exact, work)
            if not base and work == ACTIVE and dialect == "eding":
                continue  # which system is active is another statement
            assert lines.tolist() == others.tolist(), text
            assert (more | ~known).all(), text
            assert np.allclose(ends[known], places[known], rtol=0.0, atol=1e-9), text
