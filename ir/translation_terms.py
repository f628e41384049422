"""What two sides of a translation agree on, so that a program for one machine can be compared with one for another.

Numbers and names that no program says: which output of the target does what an output of the source does, which
unknown offset is which, how far numbers may differ because they are printed with so many digits. The driver makes them
of the two machine files, the map (docs/translation.md) and the target's style; ``verify/translation`` reads them.
"""

from __future__ import annotations

from gproof.ir.program import NO_OUTPUTS, SpindleOutputs
from gproof.ir.record import field, record
from gproof.ir.trace import UNMEASURED, Affine


@record(frozen=True, slots=True, kw_only=True)
class SymbolMeaning:
    """What an unknown of one side is: mm (or degrees) and a sum of unknowns that both sides know by these names.

    Where a controller has one zero and another one adds two, the zero of the first is the sum of the others: both are
    set at the same place of the material.
    """

    symbol: str
    mm: float = 0.0
    form: Affine = ()


@record(frozen=True, slots=True, kw_only=True)
class TranslationTerms:
    """What both sides agree on.

    source, target: names of the languages; where they are equal, equal commands to devices are the same.
    tolerance_mm, tolerance_deg: by how much coordinates of the same place may differ; chord_mm: how far straight moves
    may be from an arc that they replace, 0: arcs must stay arcs; feed_relative: by which share of the greater one feeds
    and speeds may differ; seconds: by how much dwells may differ.
    outputs, inputs: (source channel, target channel); a channel that is not listed has the same number on both sides.
    tools: (source number, target number), likewise.
    source_outputs, target_outputs: channels that run the spindle or the coolant on that side; they are compared with
    the codes of the other side.
    source_symbols, target_symbols: what unknowns of each side are, in names that both share.
    source_straight, target_straight: rapids of several axes are straight lines; None: the manual does not say.
    rapids_assumed: they are taken to be the same path all the same, and that is printed.
    rapid_rates: (axis, mm/min) that a target's axis can go at: a straight rapid of the source may be a feed
    move, not faster than each axis that moves, and not slower than the slowest of all; (): rapids stay rapids.
    left_out: facts (``ROW_FACTS``, ``EndState``) that one of the controllers cannot have; where they differ that is
    printed.
    silent: texts of commands to devices that need no counterpart, because they move and switch nothing.
    axes: that the job moves: what is left in the offsets of others is not compared.
    coolant: (source word, target word) of ``mist`` and ``flood``, where the map has one of them for the other.
    scratch: offsets of the target that the translation itself uses (``work.9.x``): what they hold is not compared.
    stops_on: the switch for optional stops is stated to be on.
    machine_zero_shared: machine coordinates of both machines count from the same place.
    tool_by_stop: a stop of the target that names a tool, by its number after it or in its text, is the tool change.
    filter_left_out: the source may let its controller join short moves within a tolerance, and choose how fast it
    passes small angles; the target goes to every place, which is within that tolerance; this is printed.
    guards: names of those that both controllers have, None: all.
    tool_change_waits: a wait for the operator at a tool change is compared; else a machine that changes the tool by
    itself does the same as one that waits for somebody who does.
    """

    source: str = ""
    target: str = ""
    tolerance_mm: float = 1e-6
    tolerance_deg: float = 1e-6
    chord_mm: float = 0.0
    feed_relative: float = 1e-6
    seconds: float = 1e-6
    outputs: tuple[tuple[int, int], ...] = ()
    inputs: tuple[tuple[int, int], ...] = ()
    tools: tuple[tuple[int, int], ...] = ()
    source_outputs: SpindleOutputs = NO_OUTPUTS
    target_outputs: SpindleOutputs = NO_OUTPUTS
    source_symbols: tuple[SymbolMeaning, ...] = ()
    target_symbols: tuple[SymbolMeaning, ...] = ()
    source_straight: bool | None = None
    target_straight: bool | None = None
    rapids_assumed: bool = False
    rapid_rates: tuple[tuple[str, float], ...] = ()
    left_out: frozenset[str] = field(default_factory=frozenset)
    silent: frozenset[str] = field(default_factory=frozenset)
    guards: frozenset[str] | None = None
    tool_change_waits: bool = True
    tool_by_stop: bool = False
    stops_on: bool = False
    filter_left_out: bool = False
    machine_zero_shared: bool = True
    axes: frozenset[str] = frozenset("xyzabc")
    coolant: tuple[tuple[str, str], ...] = ()
    scratch: frozenset[str] = field(default_factory=frozenset)

    def shared_guards(self, names: tuple[str, ...]) -> tuple[str, ...]:
        """Those of guards that are off which both controllers have; measures of tools are none."""
        own = (name for name in names if name != UNMEASURED)
        return tuple(name for name in own if self.guards is None or name in self.guards)


ROW_FACTS: dict[str, str] = {
    "tool": "the tool in the spindle",
    "path_mode": "how corners are taken (G61, G64)",
    "overrides": "whether the operator's overrides act",
    "head": "the head that is selected",
    "surface_speed": "constant surface speed",
    "synchronised": "the move follows the turns of the spindle",
    "following": "what the controller adds to the path (height map, knife)",
    "guards": "guards that are off",
    "dynamics": "velocities and accelerations that the program has set",
    "backlash": "backlash that the program has set",
    "limits": "limits that the program has set",
    "spindle": "speed and direction of the spindle",
}
"""Facts of a row that must be the same on both sides, by the names that differences and ``left_out`` have."""
