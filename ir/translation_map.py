"""What no program and no machine file says of a translation: which output, tool and word of one machine is which of
the other, and how the target's programs are written."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.record import field, record
from gproof.ir.target import Style

STYLE_KEYS = ("decimals_mm", "decimals_inch", "decimals_deg", "decimals", "numbers", "indent")
"""Whole numbers of a style that a map may state."""


@record(frozen=True, slots=True, kw_only=True)
class TranslationMap:
    """outputs, inputs, tools, offsets: number of the source -> of the target; coolant: ``mist`` or ``flood`` of the
    source -> the word of the target; tool_change: ``stop``: where the target has no tool change, the program stops;
    lengths: mm of tools of the target, for a controller that has no tool lengths;
    style: fields of ``Style`` by name. given: a file states it: what it lacks is not the same number then."""

    outputs: dict[int, int] = field(default_factory=dict)
    inputs: dict[int, int] = field(default_factory=dict)
    tools: dict[int, int] = field(default_factory=dict)
    offsets: dict[int, int] = field(default_factory=dict)
    coolant: dict[str, str] = field(default_factory=dict)
    tool_change: str = ""
    lengths: dict[int, float] = field(default_factory=dict)
    style: dict[str, object] = field(default_factory=dict)
    given: bool = False

    def styled(self, style: Style) -> Style:
        """A target's style with what the map states of it."""
        return replace(style, **self.style)  # type: ignore[arg-type]


NO_MAP = TranslationMap()
