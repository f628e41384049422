"""Campaigns: so many random cases in every run, and the rest of the same seeded row in `make soak`."""

from __future__ import annotations

import pytest


def seeds(usual: int, soak: int) -> list[object]:
    """Seeds 0 .. soak - 1 for `parametrize`; those from `usual` on only in a soak."""
    return [*range(usual), *(pytest.param(n, marks=pytest.mark.soak) for n in range(usual, soak))]


def sizes(usual: object, soak: object) -> list[object]:
    """One campaign in two sizes: the small one always, the whole in a soak."""
    return [pytest.param(usual, id="few"), pytest.param(soak, id="soak", marks=pytest.mark.soak)]
