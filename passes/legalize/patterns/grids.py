"""Arrays of rows and columns -> the cells one after the other."""

from __future__ import annotations

from gproof.passes.legalize.pattern import Pattern

PATTERNS: tuple[Pattern, ...] = ()
