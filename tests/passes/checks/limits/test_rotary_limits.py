"""Limits of rotary axes: one without any turns without end, one with some keeps to them."""

from __future__ import annotations

from pathlib import Path

import pytest
from passes.checks.zones.test_zones import HEAD, MACHINE, run, stated
from support.judging import answer

from gproof.ir.verdict import Verdict

ENDLESS = "A turns without end and has no travel limits"


@pytest.mark.parametrize(
    ("axis", "turn", "verdict"),
    [
        ("[axes.a]\nmax_velocity = 90.0\n", 1e6, Verdict.SAFE),
        ("[axes.a]\nmin = -360.0\nmax = 360.0\n", 360.0, Verdict.SAFE),
        ("[axes.a]\nmin = -360.0\nmax = 360.0\n", 360.001, Verdict.UNSAFE),
        ("[axes.a]\nmin = -360.0\n", 10.0, Verdict.UNKNOWN),
        ("[axes.a]\ntravel_min = -360.0\n", 10.0, Verdict.UNKNOWN),
        ('[axes.a]\nkind = "linear"\n', 10.0, Verdict.UNKNOWN),
        ("[axes.a]\n[[axes.a.slaves]]\nmin = -5.0\nmax = 5.0\n", 10.0, Verdict.UNKNOWN),
        ("[axes.a]\nmin = -99.0\nmax = 99.0\n[[axes.a.slaves]]\nmin = -5.0\nmax = 5.0\n", 10.0, Verdict.UNSAFE),
    ],
)
def test_a_rotary_axis(tmp_path: Path, axis: str, turn: float, verdict: Verdict) -> None:
    setup = stated().replace("z = 0.0}", "z = 0.0, a = 0.0}").replace("[work.1]", "[work.1]\na = 0.0")
    setup = setup.replace('"z"]', '"z", "a"]')
    judgement = run(tmp_path, f"{HEAD}G1 A{turn!r}\nM30\n", MACHINE + axis, setup)
    limits = answer(judgement, "limits")
    assert limits.verdict is verdict, [f.message for f in judgement.findings.kept]
    assert (ENDLESS in limits.assumptions) == (turn == 1e6)


def test_where_an_endless_axis_stands_need_not_be_known(tmp_path: Path) -> None:
    judgement = run(tmp_path, f"{HEAD}G1 A10\nM30\n", MACHINE + "[axes.a]\n", stated())
    assert answer(judgement, "limits").verdict is Verdict.SAFE
    assert not answer(judgement, "limits").conditions
