"""What both sides of a comparison agree on, made of the two machines, the map and the style of the text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from gproof.driver.dialects import DIALECTS
from gproof.driver.targets import TARGETS
from gproof.ir.dialects import rules_named
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.program import SpindleOutputs
from gproof.ir.target import Style
from gproof.ir.translation_terms import SymbolMeaning, TranslationTerms

if TYPE_CHECKING:
    from gproof.driver.translation import Translation, Wanted

ROUNDING = 1.02
"""Rounding of sums besides that of the printed digits."""


def terms_of(
    done: Translation, outputs: SpindleOutputs, source: Machine, target: Machine, wanted: Wanted, style: Style
) -> TranslationTerms:
    """What both sides agree on."""
    own = done.session.program
    assert own is not None
    half = 0.5 * max(10.0**-style.decimals_mm, 25.4 * 10.0**-style.decimals_inch) * ROUNDING
    chords = any(one.pattern == "arc -> chords" for one in done.lowered)
    left_out = frozenset(
        name for name, had in (("path_mode", done.target.path_modes), ("guards", "guard" in done.target.legal),
            ("table", "frame_store" in done.target.legal),)
        if not had
    )  # fmt: skip
    given = done.map
    back = {new: old for old, new in given.tools.items()}
    spare = done.target.spare_offset if done.spare_used else 0
    axes = frozenset(name for name in AXIS_NAMES if source.axis(name) and target.axis(name))
    return TranslationTerms(
        axes=axes,
        scratch=frozenset(f"work.{spare}.{axis}" for axis in AXIS_NAMES if spare),
        source=done.session.dialect, target=done.target.name, tolerance_mm=half + 1e-9,
        tolerance_deg=0.5 * 10.0**-style.decimals_deg * ROUNDING + 1e-9,
        chord_mm=wanted.chord_tolerance if chords else 0.0, feed_relative=1e-4, seconds=1e-4,
        source_outputs=own.spindle_outputs, target_outputs=outputs,
        source_straight=own.rules.straight_traverse, target_straight=done.target.straight_rapids,
        outputs=tuple(sorted(given.outputs.items())), inputs=tuple(sorted(given.inputs.items())),
        tools=tuple(sorted(given.tools.items())),
        source_symbols=only_local(done.session.dialect, done.target.name)
        + _measured(done.session.dialect, done.target.name, target, back)
        + tuple(
            SymbolMeaning(symbol=f"work.{old}.{axis}", form=((f"work.{new}.{axis}", 1),))
            for old, new in given.offsets.items() for axis in AXIS_NAMES
        ),
        target_symbols=(
            *only_local(done.target.name, done.session.dialect),
            *_measured(done.target.name, done.session.dialect, source, given.tools),
            *_lengths_in_zeros(done),
        ),
        coolant=tuple(sorted(given.coolant.items())),
        rapids_assumed=not wanted.straight_rapids, left_out=left_out, machine_zero_shared=same_travel(source, target),
        tool_by_stop=given.tool_change == "stop",
    )  # fmt: skip


def _measured(name: str, other: str, machine: Machine, numbers: Mapping[int, int]) -> tuple[SymbolMeaning, ...]:
    """Measures of tools where one controller has them instead of lengths, of tools whose length the other's file says.

    numbers: of tools of the other controller, as this one has them.
    """
    if not {name, other} <= DIALECTS.keys():
        return ()
    if not rules_named(name).measured_tools or rules_named(other).measured_tools:
        return ()
    lengths = {numbers.get(tool.number, tool.number): tool.length for tool in machine.tools if tool.length is not None}
    return tuple(SymbolMeaning(symbol=f"tool.{number}.z", mm=length) for number, length in sorted(lengths.items()))


def only_local(name: str, other: str) -> tuple[SymbolMeaning, ...]:
    """The zero of a controller whose only one is a local offset, set up where another one has its first work offset.
    name: of that controller; other: of the one that its programs are compared with."""
    if not _has_only_local(name) or _has_only_local(other):
        return ()
    return tuple(SymbolMeaning(symbol=f"g92.{axis}", form=((f"work.1.{axis}", 1),)) for axis in AXIS_NAMES)


def _has_only_local(name: str) -> bool:
    return name in DIALECTS and "work" not in DIALECTS[name].frontend.open_offsets


def _lengths_in_zeros(done: Translation) -> tuple[SymbolMeaning, ...]:
    """Work zeros of a controller without tool lengths: a length that the job leaves as it is, is in them."""
    own = TARGETS.get(done.session.dialect)
    has_lengths = own is None or "length" in own.target().legal
    if not has_lengths or "length" in done.target.legal or any(one.feature == "length" for one in done.lowered):
        return ()
    return tuple(
        SymbolMeaning(symbol=f"work.{n}.z", form=(("tool.0.z", 1), (f"work.{n}.z", 1)))
        for n in range(1, done.target.offsets + 1)
    )


def same_travel(one: Machine, other: Machine) -> bool:
    """Whether machine coordinates of two machines can count from the same place: their limits are the same."""
    return all(_limits(one, name) == _limits(other, name) for name in AXIS_NAMES)


def _limits(machine: Machine, name: str) -> tuple[float | None, float | None]:
    axis = machine.axis(name)
    return (None, None) if axis is None else (axis.lower, axis.upper)
