"""Campaigns: so many random cases in every run, and the rest of the same seeded row in `make soak`."""

from __future__ import annotations

import os
import random
from collections.abc import Callable, Sequence
from typing import Any

import pytest
from hypothesis import settings

SOAK = bool(os.environ.get("GPROOF_SOAK"))


def seeds(usual: int, soak: int) -> list[object]:
    """Seeds 0 .. soak - 1 for `parametrize`; those from `usual` on only in a soak."""
    return [*range(usual), *(pytest.param(n, marks=pytest.mark.soak) for n in range(usual, soak) if SOAK)]


def share(cases: Sequence[Any], one_in: int) -> list[object]:
    """One in so many of a long list for `parametrize`, the same ones in each run; the others only in a soak.

    A tuple is several arguments.
    """
    chosen = set(random.Random(len(cases)).sample(range(len(cases)), -(-len(cases) // one_in)))
    rest = {
        n: pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=pytest.mark.soak)
        for n, case in enumerate(cases)
        if SOAK and n not in chosen
    }
    return [rest.get(n, case) for n, case in enumerate(cases) if n in chosen or n in rest]


def sizes(usual: object, soak: object) -> list[object]:
    """One campaign in two sizes: the small one always, the whole in a soak; a tuple is several arguments."""
    few, many = (value if isinstance(value, tuple) else (value,) for value in (usual, soak))
    return [
        pytest.param(*few, id="few"),
        *(pytest.param(*many, id="soak", marks=pytest.mark.soak) for _ in [0] if SOAK),
    ]


def examples(usual: int, soak: int, **more: Any) -> Callable[[Any], Any]:
    """So many examples of hypothesis in every run; in a soak the test is run with as many as that asks for."""
    sized = settings(max_examples=soak if SOAK else usual, deadline=None, **more)
    return lambda test: pytest.mark.soak(sized(test)) if SOAK else sized(test)
