"""Dialect facts that several parts need, as data."""

from __future__ import annotations

from gproof.ir.rules import LanguageRules


def rules_named(name: str) -> LanguageRules:
    """The rules of a dialect by name; ValueError when there is none."""
    if name == "eding":
        from gproof.ir.dialects.eding import EDING

        return EDING
    if name == "wincnc":
        from gproof.ir.dialects.wincnc import WINCNC

        return WINCNC
    if name == "mcuwin":
        from gproof.ir.dialects.mcuwin import MCUWIN

        return MCUWIN
    raise ValueError(f"no dialect is named {name!r}")
