"""Fixtures of the tests of translation."""

from __future__ import annotations

from differential.conftest import peer

__all__ = ["peer"]
