"""Commands (``Device`` nodes) for what the controller adds to the path: height maps and tangential knives.

``DEVICES`` maps a command of ``ir/rules.py`` to a function that takes the emitter and the node; a handler changes
``emitter.modal`` and appends rows, or raises a Refusal for what is not understood.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal
from gproof.ir.program import Device, Text
from gproof.ir.symbolic import Unknown
from gproof.ir.trace import HEIGHT_MAP, KNIFE

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

Handler = Callable[["Run", Device], None]


def _text(node: Device, place: int = 0) -> str:
    """An argument that is a name, in lower case; "" when it is none."""
    part = node.arguments[place] if place < len(node.arguments) else None
    return part.value.strip().lower() if isinstance(part, Text) else ""


def _follow(emitter: Run, name: str, *, on: bool) -> None:
    """Switch something that the controller adds to the path."""
    others = {n for n in emitter.modal.following if n != name and not n.startswith(f"{name}:")}
    emitter.modal.following = tuple(sorted(others | ({name} if on else set())))
    emitter.state_changed()


# -- height map (Eding manual 2.2.5.5)


def height_map_on(emitter: Run, node: Device) -> None:
    """Compensation on: with the setup's map, without one it is not known what is added to Z."""
    if not emitter.modal.height_map_known:
        raise Refusal(
            codes.HEIGHT_MAP_UNKNOWN.at(node.span, what="switched on, but the setup file gives no height map")
        )
    _follow(emitter, HEIGHT_MAP, on=True)


def height_map_off(emitter: Run, node: Device) -> None:
    """Compensation off."""
    _follow(emitter, HEIGHT_MAP, on=False)


def height_map_init(emitter: Run, node: Device) -> None:
    """A new map starts: what will be measured is not known."""
    emitter.modal.height_map_known = False
    if HEIGHT_MAP in emitter.modal.following:
        raise Refusal(codes.HEIGHT_MAP_UNKNOWN.at(node.span, what="it is on while the map is measured again"))


def height_map_add(emitter: Run, node: Device) -> None:
    """A measured point changes the map in the same way."""
    height_map_init(emitter, node)


def height_map_save(emitter: Run, node: Device) -> None:
    """Writes a file; nothing else changes."""


def height_map_load(emitter: Run, node: Device) -> None:
    """The map of a file: the setup's, when that came from a file of this name."""
    stated = emitter.modal.setup.height_map
    name = _text(node)
    emitter.modal.height_map_known = stated is not None and name != "" and stated.name.lower() == name
    if not emitter.modal.height_map_known and HEIGHT_MAP in emitter.modal.following:
        what = f"it is on while the map {name!r} is loaded, which is not the map of the setup file"
        raise Refusal(codes.HEIGHT_MAP_UNKNOWN.at(node.span, what=what))


# -- tangential knife (Eding manual 2.1.9)


def knife_on(emitter: Run, node: Device) -> None:
    """The knife follows the path from here on; a bent one moves X and Y too, which is not modelled."""
    if node.arguments:
        value = emitter.evaluator.value(node.arguments[0])
        if isinstance(value, Unknown) or value != 0.0:
            raise Refusal(
                codes.KNIFE_UNKNOWN.at(node.span, what="a bent knife moves X and Y with Z, which is not modelled")
            )
    if emitter.machine.knife is None:
        raise Refusal(codes.KNIFE_UNKNOWN.at(node.span, what="the machine file has no knife"))
    if emitter.machine.axis(emitter.machine.knife.axis) is None:
        what = f"the machine has no axis {emitter.machine.knife.axis.upper()}"
        raise Refusal(codes.KNIFE_UNKNOWN.at(node.span, what=what))
    _follow(emitter, KNIFE, on=True)


def knife_off(emitter: Run, node: Device) -> None:
    """The knife stays where it is."""
    _follow(emitter, KNIFE, on=False)


def knife_axis(emitter: Run, node: Device) -> None:
    """Another output for the knife: followed only when it is the one that the machine file names."""
    knife = emitter.machine.knife
    name = _text(node)
    if knife is None or name != knife.axis:
        what = f"moved to the output of {name.upper() or 'another axis'}, which is not in the machine file"
        raise Refusal(codes.KNIFE_UNKNOWN.at(node.span, what=what))


def knife_calibrate(emitter: Run, node: Device) -> None:
    """Heights of a bent knife; a straight one does not use them."""


DEVICES: dict[str, Handler] = {
    "height_map_on": height_map_on,
    "height_map_off": height_map_off,
    "height_map_init": height_map_init,
    "height_map_add": height_map_add,
    "height_map_save": height_map_save,
    "height_map_load": height_map_load,
    "knife_on": knife_on,
    "knife_off": knife_off,
    "knife_axis": knife_axis,
    "knife_calibrate": knife_calibrate,
}
