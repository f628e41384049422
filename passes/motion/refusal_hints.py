"""What to state or change where no steps can be made: hints of GP503 and GP504.

A form (``ir/trace.py``, Frames) names what a place depends on; the hints say where each kind of it is stated, in the
setup file (docs/setup-files.md) or the machine file (docs/machine-files.md).
"""

from __future__ import annotations

from collections.abc import Iterable

from gproof.ir.machine import Axis
from gproof.ir.trace import UNKNOWN, Affine, Wait

LATER = "run the job on the controller itself: this is known only when the job runs, and steps are made before"

WAITS: dict[Wait, tuple[str, str]] = {
    Wait.BRANCH: (
        "the path depends on an input",
        "state it in [inputs], answers or [parameters] of the setup file: then one path is left",
    ),
    Wait.INPUT: ("the job waits for an input here", LATER),
    Wait.PROBE: ("a probe ends a move here", LATER),
    Wait.HOME: ("the axes are homed here", "home the axes before the job, and state homed = [...] in the setup file"),
}
"""What no stream of steps can wait for: why, and what helps."""

ENDLESS = (
    "the program never ends: from here it repeats for ever",
    "give the loop an end, for example a pass count",
)

FEED_FORGOTTEN = "program F as a plain number, on this line or before it"
ARCS_FEED = (
    "state arcs_share_feed under [controls] of the "
    "machine file, or program F on each such line: it is unknown whether F of lines applies to arcs, and the reverse"
)
OWN_FEED = "program F on this arc or on one before it: arcs keep their own feed (arcs_share_feed = false)"

_SETUP = "of the setup file, as one number"


def of_forms(forms: Iterable[Affine]) -> str:
    """Where what these positions depend on is stated; two hints at most."""
    hints = dict.fromkeys(_of_symbol(symbol) for form in forms for symbol, _ in form if form != UNKNOWN)
    return "; ".join(list(hints)[:2]) or "see the findings of gproof check: they say what is unknown"


def _of_symbol(symbol: str) -> str:
    kind, *rest = symbol.split(".")
    axis = rest[-1] if rest else ""
    stated = {
        "start": f"start = {{{axis} = ...}}",
        "work": f"{axis} of [work.{rest[0]}]" if rest and rest[0] != "0" else "active_work and its [work.N]",
        "g92": f"{axis} of [g92]",
        "tool": f"length of [tools.{rest[0]}]" if rest and rest[0] != "0" else "tool, and the length of its [tools.N],",
        "head": f"{axis} of [heads.{rest[0]}]" if rest else "",
    }.get(kind)
    if stated is not None:
        return f"state {stated} {_SETUP}"
    if kind in ("probe", "home"):
        return LATER
    if kind == "beside":
        return (
            "use a tool of radius 0, "
            "or program the path of the tool centre without G41 and G42: the manual does not give the corrected path"
        )
    return "use a number in its place, in the job or in [parameters] of the setup file"


def arises(form: Affine) -> bool:
    """True for places that depend only on where probing or homing has ended."""
    return form != UNKNOWN and bool(form) and all(symbol.split(".")[0] in ("probe", "home") for symbol, _ in form)


def of_motor(axis: Axis | None, name: str, missing: Iterable[str]) -> str:
    """Which keys of the machine file an axis lacks, and where they belong."""
    keys = {
        "maximum velocity": "max_velocity", "maximum acceleration": "max_acceleration",
        "steps per unit": "steps_per_unit",
    }  # fmt: skip
    needed = [keys[what] for what in missing if what in keys] or list(keys.values())
    word = name if axis is None else axis.name
    keys_of = f"{', '.join(needed)} under [axes.{word}]"
    return f"state {keys_of} of a TOML machine file; with base = ... that file refines the controller's own file"


ON_ITS_CONTROLLER = "run it on the controller itself: gproof checks such a job but makes no steps for it"
TOO_FAST = "set a lower max_velocity for this axis, or use a board with shorter pulses (step_pulse under [board])"
TOO_FAR = "check units and scaling: no machine is that long"
