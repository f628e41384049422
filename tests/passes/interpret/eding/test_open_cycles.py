"""Cycles that begin at a height of the machine while nobody knows the work offset (Eding CNC manual 3.4.21.1).

Whether the tool rises to R first rests on the offset. What the answer for all offsets says is held against the same job
with offsets that are stated, which knows.
"""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from passes.checks.zones.test_zones import CLAMP, HEAD, MACHINE, found, run
from support.campaigns import seeds
from support.judging import answer

from gproof.driver.judge import Judgement
from gproof.ir.verdict import Verdict

OPEN = (
    'schema = "gproof-setup/1"\nactive_work = 1\ntool = 2\nstart = {x = 0.0, y = 0.0, z = 0.0}\n'
    "g92 = {x = 0.0, y = 0.0, z = 0.0}\n"
)
"""Z of the machine is -200 to 100."""
ASSUMED = "R of canned cycles is within the limits of its axis"
DRILL = f"{HEAD}G53 G0 Z{{z}}\nG98 G81 X10 Y0 Z-5 R2\nX20\nX30 R4\nG80\nG53 G0 Z{{z}}\nM30\n"


def at(x: float, y: float, z: float) -> str:
    return f"[work.1]\nx = {x!r}\ny = {y!r}\nz = {z!r}\n"


def room(judgement: Judgement) -> dict[str, tuple[float, float]]:
    """By axis what the answer asks of the offset."""
    out: dict[str, tuple[float, float]] = {}
    for name in ("limits", "areas"):
        for c in answer(judgement, name).conditions:
            ((symbol, count),) = c.terms
            assert count == 1
            low, high = out.get(symbol[-1], (c.low, c.high))
            out[symbol[-1]] = max(low, c.low), min(high, c.high)
    return out


@pytest.mark.parametrize("z", [100, 50, -60])
def test_z_of_the_offset_has_room_for_the_hole_and_for_r(tmp_path: Path, z: float) -> None:
    """The hole is 5 deep, R at most 4 above: -195 to 96, wherever the tool comes from."""
    judgement = run(tmp_path, DRILL.format(z=z), MACHINE, OPEN)
    assert judgement.verdict is Verdict.SAFE
    assert room(judgement)["z"] == (-195.0, 96.0)
    assert judgement.assumptions.count(ASSUMED) == 1
    assert ASSUMED not in run(tmp_path, DRILL.format(z=z), MACHINE, OPEN + at(0.0, 0.0, 0.0)).assumptions


def test_what_a_machine_needs_is_not_more_for_it(tmp_path: Path) -> None:
    """The heights that count are 50 of the machine, and -5 to 4 of the work: not those up to the limit."""
    judgement = run(tmp_path, DRILL.format(z=50), MACHINE, OPEN)
    heights = [(form, low, high) for axis, form, low, high in judgement.summary.box if axis == "z"]
    assert sorted(heights) == [("", 50.0, 50.0), ("G54 Z offset", -5.0, 4.0)]


def test_without_a_limit_above_or_without_its_guard_it_is_not_known(tmp_path: Path) -> None:
    for machine, job in (
        (MACHINE.replace("max = 100.0\n", ""), DRILL),
        (MACHINE, DRILL.replace(HEAD, f"{HEAD}MCAGuard off\n")),
    ):
        labels = {f.code.label for f in run(tmp_path, job.format(z=50), machine, OPEN).findings.kept}
        assert "GP304" in labels


def test_the_way_to_the_next_hole_is_anywhere_up_to_the_limit(tmp_path: Path) -> None:
    """A clamp up to 60 stands between the holes; the tool comes from 50, or from as high as R is."""
    clamp = CLAMP.replace("-50.0]", "60.0]")
    job = DRILL.replace("X30 R4", "X100 R4")
    low = run(tmp_path, job.format(z=50), MACHINE + clamp, OPEN)
    # Beside it, then: from X0 on the machine the way to any other side of it would cross.
    assert low.verdict is Verdict.SAFE
    assert room(low)["y"][1] <= -10.0 or room(low)["y"][0] >= 10.0 or room(low)["x"][1] <= -60.0
    high = run(tmp_path, job.format(z=60), MACHINE + clamp, OPEN + at(0.0, 0.0, -100.0))
    assert found(high) == []
    assert found(run(tmp_path, job.format(z=59), MACHINE + clamp, OPEN + at(0.0, 0.0, -100.0))) == [("GP336", 5)]


@pytest.mark.parametrize("seed", seeds(3, 60))
def test_what_holds_for_all_offsets_holds_for_each(seed: int, tmp_path: Path) -> None:
    rng = random.Random(seed)
    answered = 0
    for case in range(6):
        top = round(rng.uniform(20, 100), 2)
        machine = MACHINE.replace("max = 100.0", f"max = {top}")
        if rng.random() < 0.4:
            machine += CLAMP.replace("-50.0]", f"{rng.uniform(-100, 60):.2f}]")
        lines = [HEAD.strip(), rng.choice(("G17", "G17", "G18"))]
        for _ in range(rng.randrange(1, 4)):
            lines.append(f"G53 G0 Z{rng.choice((top, round(rng.uniform(-100, top), 2)))}")
            lines.append("G53 G0 Y20" if rng.random() < 0.3 else "G0 Y0")
            code = rng.choice(("G81", "G82 P1", "G73 Q4", "G83 Q9"))
            deep = "Z" if "G17" in lines else "Y"
            words = f"X{rng.uniform(-30, 60):.2f} {'Y' if deep == 'Z' else 'Z'}{rng.uniform(-9, 9):.2f}"
            heights = f"{deep}-{rng.uniform(1, 20):.2f} R{rng.uniform(0, 5):.2f}"
            lines.append(f"G{rng.choice((98, 99))} {code} {words} {heights}")
            lines += [f"X{rng.uniform(-30, 60):.2f}" for _ in range(rng.randrange(3))]
            lines.append("G80")
        program = "\n".join([*lines, "M30", ""])
        unknown = run(tmp_path, program, machine, OPEN)
        where = f"seed {seed} case {case}\n{program}{machine}"
        assert answer(unknown, "language").verdict is Verdict.SAFE, where
        if unknown.verdict is not Verdict.SAFE:
            continue
        answered += 1
        ends = {axis: room(unknown).get(axis, (-50.0, 50.0)) for axis in "xyz"}
        for beyond in (None, None, *ends):
            places = {axis: rng.choice((*pair, rng.uniform(*pair))) for axis, pair in ends.items()}
            if beyond is not None:
                side = rng.randrange(2)
                places[beyond] = ends[beyond][side] + (side * 2 - 1) * rng.choice((1e-6, 3.0))
            stated = run(tmp_path, program, machine, OPEN + at(**places))
            if beyond is None:
                assert stated.verdict is Verdict.SAFE, f"{places}\n{where}"
            elif "keep_out" not in machine:
                assert stated.verdict is Verdict.UNSAFE, f"{places}\n{where}"
    assert answered >= 2
