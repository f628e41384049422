"""How far the tool may be off the programmed path, for every check that looks at where the tool is.

Takes a Machine and the ``State`` of rows. Backlash moves the tool: an axis whose motor turns round stays after until
it is taken up, or for good where nothing compensates it (Eding CNC manual 2.1.5; WinCNC, L8, L9, backlash=).
P and Q of G64 and Q of G61 let the controller leave the path (Eding CNC manual 3.4.16). All of that need not be.
Zones, part, fixtures and stock ask here, so that they agree; pitch tables bring an axis to where it is meant to be and
add nothing.
"""

from __future__ import annotations

import math

from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.record import record
from gproof.ir.trace import PathMode, State

BACKLASH = "axis backlash"
NO_TOLERANCE = "G64 without P does not round corners"
ROUNDED = "the corner rounding of the controller (P, Q)"
_AS_FAR = 1e5
"""mm: further than any machine goes, for a tolerance that is not known."""


@record(frozen=True, slots=True)
class OffPath:
    """mm that the tool may be off its path.

    around: in X and Y together; above: in Z, up or down; distance: in space; causes: why, in words.
    """

    around: float = 0.0
    above: float = 0.0
    distance: float = 0.0
    causes: tuple[str, ...] = ()


def off_path(machine: Machine, state: State) -> OffPath:
    """What machine and program let the tool be off the path in rows of a state."""
    x, y, z = (_backlash(machine, state, column) for column in range(3))
    around, distance = math.hypot(x, y), math.hypot(x, y, z)
    blend = max(0.0, state.simplify)
    if state.path_mode is PathMode.CONTINUOUS:
        blend += max(0.0, state.path_tolerance)
    blend = min(blend, _AS_FAR)
    causes = ((BACKLASH,) if distance else ()) + ((ROUNDED,) if blend else ())
    return OffPath(around + blend, z + blend, distance + blend, causes)


def blends_by_nothing(state: State) -> bool:
    """Whether the controller blends moves with a tolerance of 0, which is taken for none at all."""
    return state.path_mode is PathMode.CONTINUOUS and state.path_tolerance == 0.0


def _backlash(machine: Machine, state: State, column: int) -> float:
    """mm of an axis: of its motors, of the controller's file though nothing compensates it, or what the job sets."""
    name = AXIS_NAMES[column]
    axis = machine.axis(name)
    found = [drive.backlash for drive in axis.drives()] if axis is not None else []
    found += [amount for which, amount in machine.settings.backlash if which == name]
    found += [amount for which, amount in state.backlash if which == column]
    return max(map(abs, found), default=0.0)
