"""Dialect facts that several parts need, as data."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

from gproof.ir.rules import LanguageRules


def _eding() -> LanguageRules:
    from gproof.ir.dialects.eding.rules import EDING

    return EDING


def _wincnc() -> LanguageRules:
    from gproof.ir.dialects.wincnc.rules import WINCNC

    return WINCNC


def _mcuwin() -> LanguageRules:
    from gproof.ir.dialects.mcuwin.rules import MCUWIN

    return MCUWIN


RULES: dict[str, Callable[[], LanguageRules]] = {"eding": _eding, "wincnc": _wincnc, "mcuwin": _mcuwin}
"""The rules of each dialect, loaded when somebody asks."""


def rules_named(name: str) -> LanguageRules:
    """The rules of a dialect by name; ValueError when there is none."""
    if name not in RULES:
        raise ValueError(f"no dialect is named {name!r}")
    return RULES[name]()


def settings_modules() -> tuple[ModuleType, ...]:
    """Where the settings of each controller are (``ir/settings.py``), for who looks for types by name."""
    from gproof.ir.dialects.eding import settings as eding
    from gproof.ir.dialects.mcuwin import settings as mcuwin
    from gproof.ir.dialects.wincnc import settings as wincnc

    return eding, mcuwin, wincnc
