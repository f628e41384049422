"""Fixtures of the differential test: who can run here, and whether that is allowed to be nobody.

Where LinuxCNC is not installed the tests that need it are skipped; with GPROOF_REQUIRE_PEER=1 they fail.
"""

from __future__ import annotations

import os

import pytest
from differential import gproof_side, rs274_peer


@pytest.fixture(scope="session")
def peer() -> None:
    """The peer can run."""
    _need(rs274_peer.missing())


@pytest.fixture(scope="session")
def gproof() -> None:
    """gproof's command can run."""
    _need(gproof_side.missing())


def _need(missing: str | None) -> None:
    if missing is None:
        return
    if os.environ.get("GPROOF_REQUIRE_PEER"):
        pytest.fail(missing)
    pytest.skip(missing)
