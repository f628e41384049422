"""What to state or change where no steps can be made: hints of GP503 and GP504.

A form (``ir/trace.py``, Frames) names what a place depends on; the hints say where each kind of it is stated, in the
setup file (docs/setup-files.md) or the machine file (docs/machine-files.md).
"""

from __future__ import annotations

from collections.abc import Iterable

from gproof.ir.machine import Axis
from gproof.ir.trace import UNKNOWN, Affine, Wait

LATER = "this is known only when the job runs, and steps are made before: the controller itself can run the job"

WAITS: dict[Wait, tuple[str, str]] = {
    Wait.BRANCH: (
        "which way it goes depends on an input",
        "[inputs], answers or [parameters] of the setup file state it; then one way is left",
    ),
    Wait.INPUT: ("the job waits for an input here", LATER),
    Wait.PROBE: ("a probe ends a move here", LATER),
    Wait.HOME: ("the axes are homed here", "home before the job, and state homed = [...] in the setup file"),
}
"""What no stream of steps can wait for: why, and what helps."""

ENDLESS = (
    "the program never ends: from here it goes on as before, for ever",
    "give the loop an end, a counted one for example",
)

FEED_FORGOTTEN = "an F in plain numbers, on this line or before it"
ARCS_FEED = (
    "whether an F of lines holds for arcs, and the reverse, is not stated: arcs_share_feed under [controls] of the "
    "machine file says it, or an F on each such line"
)
OWN_FEED = "arcs keep a feed of their own (arcs_share_feed = false): an F on this arc or on one before it"

_SETUP = "of the setup file state{s} it, as one number"


def of_forms(forms: Iterable[Affine]) -> str:
    """Where what these positions depend on is stated; two hints at most."""
    hints = dict.fromkeys(_of_symbol(symbol) for form in forms for symbol, _ in form if form != UNKNOWN)
    return "; ".join(list(hints)[:2]) or "the findings of gproof check say what nobody stated"


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
        return f"{stated} {_SETUP.format(s='s')}"
    if kind in ("probe", "home"):
        return LATER
    if kind == "beside":
        return (
            "which path the controller takes beside a corrected contour is not documented: a tool of radius 0, "
            "or a program of the tool's centre without G41 and G42"
        )
    return "a number in its place, in the job or in [parameters] of the setup file"


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
    return f"{keys_of} of a TOML machine file; with base = ... that file refines a controller's own"


ON_ITS_CONTROLLER = "gproof checks such a job, and makes no steps for it: the controller itself can run it"
TOO_FAST = "a lower max_velocity of this axis, or a board with shorter pulses (step_pulse under [board])"
TOO_FAR = "no machine is that long: a wrong unit, or a scale?"
