"""One solid as a keep-out zone and as a fixture: two properties look at one thing, and agree.

Random jobs of all dialects (`support.made_jobs`), tools and places: where one property says UNSAFE the other never says
SAFE. They may differ in what they leave open: zones ask for what the table places of a tool, fixtures for all of it.
"""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
from passes.checks.zones.test_zone_truth import Tool, Zone, zone_near
from shapely.affinity import translate
from support.campaigns import seeds
from support.judging import UNBOUNDED, answer
from support.made_jobs import MAKERS, machine_of, opened

from gproof.driver.judge import judge
from gproof.driver.session import Running
from gproof.ir.verdict import Verdict


def tool_text(tool: Tool) -> str:
    """The tool with a shape, so that nothing of it is open up to its stickout."""
    text = tool.text()
    return text + ('shape = "flat"\n' if tool.diameter else "")


def fixture_text(zone: Zone) -> str:
    rings = [[list(p) for p in list(ring.coords)[:-1]] for ring in (zone.region.exterior, *zone.region.interiors)]
    work = repr(zone.work or "machine").replace("'", '"')
    return (
        f'[[fixtures]]\nname = "clamp"\npolygon = {rings[0]}\nholes = {rings[1:]}\nbottom = {zone.z[0]!r}\n'
        f"top = {zone.z[1]!r}\nwork = {work}\n"
    )


@pytest.mark.parametrize("name", MAKERS)
@pytest.mark.parametrize("seed", seeds(1, 40))
def test_a_zone_and_a_fixture_agree(name: str, seed: int, tmp_path: Path) -> None:
    seen: set[tuple[Verdict, Verdict]] = set()
    for case in range(20):
        rng = random.Random(f"both {name} {seed} {case}")
        made = MAKERS[name](rng)
        tool = Tool(rng.choice((1.0, 6.0, 12.5)), 80.0, rng.choice((None, 3.0)), rng.choice((80.0, 200.0)))
        if rng.random() < 0.2:
            tool = Tool(0.0)
        zone = zone_near(rng, made, tool)
        away = rng.choice((0.0, 20.0, 60.0))
        region = translate(zone.region, rng.uniform(-away, away), rng.uniform(-away, away))
        zone = Zone(region, (max(zone.z[0], zone.z[1] - 60.0), zone.z[1]), zone.work)
        points = made.points()
        limits = np.array([points.min(axis=0) - 500.0, points.max(axis=0) + 500.0])
        machine = machine_of(made, limits, tool_text(tool) + zone.text())
        made.setup += fixture_text(zone)
        judgement = judge(
            opened(tmp_path, made, machine), running=Running(UNBOUNDED), properties=("areas", "collisions")
        )
        told = "".join(f"{f.span.line}: {f.code.label} {f.message}\n" for f in judgement.findings.kept)
        both = answer(judgement, "areas").verdict, answer(judgement, "collisions").verdict
        where = f"{both} {name} seed {seed} case {case}\n{made.program}{machine}{made.setup}{told}"
        assert set(both) != {Verdict.SAFE, Verdict.UNSAFE}, where
        seen.add(both)
    assert (Verdict.SAFE, Verdict.SAFE) in seen
    assert Verdict.UNSAFE in {one for both in seen for one in both}
