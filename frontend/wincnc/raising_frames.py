"""WinCNC: units, distances and where numbers count from, as operations of a Job.

Manual: Coordinate System; Workspace; G Codes: G20 to G23, G28, G43, G49 to G59, G90 to G95; L Codes: L92; M Codes: M98.
"""

from __future__ import annotations

from dataclasses import replace

from gproof.frontend.common.raising import Unraisable
from gproof.frontend.wincnc.raising_feeds import unknown
from gproof.frontend.wincnc.raising_line import Command, LineRaiser
from gproof.frontend.wincnc.raising_motion import OPEN
from gproof.ir.finding import Span
from gproof.ir.job import AxisPlace, HomeAxes, Node, Quantity, SetFrame, SwitchGuard, UseLength
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.program import Expr, Number, Unary
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F

_UNITS = {F.UNITS_INCH: "inch", F.UNITS_CM: "cm", F.UNITS_MM: "mm"}


def units(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G20, G21, G22; G23: the one before."""
    new = _UNITS.get(rule.function) or raiser.own_mode("unit_before")
    if new is None or unknown(new) or unknown(raiser.now.unit):
        raise Unraisable(rule.text, "which unit was used before is not known")
    if new != raiser.now.unit:
        # Whether numbers that are kept are numbers or lengths is not said.
        raiser.modes = replace(raiser.now, sticky=())
        if raiser.own_mode("center") is not None:
            raiser.set_own("center", OPEN)
    raiser.set_own("unit_before", raiser.now.unit)
    raiser.modes = replace(raiser.now, unit=str(new))
    return []


def feed_mode(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G93 and G94."""
    raiser.modes = replace(raiser.now, per="move" if rule.function is F.FEED_INVERSE_TIME else "minute")
    return []


# ---- local coordinates


def slot(raiser: LineRaiser, name: str, span: Span) -> Number:
    """The number under which a file keeps the zero that it gives back at its end, or G92.3 puts it away."""
    slots: dict[str, int] = raiser.__dict__.setdefault("slots", {})
    return Number(float(slots.setdefault(name, len(slots))), span)


def _zero(raiser: LineRaiser, line: Command, action: str, places: tuple[AxisPlace, ...]) -> list[Node]:
    """A local zero of axes, which the end of the file takes back."""
    if raiser.own_mode("turn", "") != "":
        raise Unraisable(f"{line.name} while G51 or G52 is on", "what they turn and scale about then is open")
    raiser.set_own("moved", True)
    # Whether kept words of a cycle are numbers or places is not said.
    raiser.modes = replace(raiser.now, sticky=())
    raiser.forget_height()
    return [SetFrame(action=action, places=places, span=line.span)]


def everywhere(raiser: LineRaiser, span: Span) -> tuple[AxisPlace, ...]:
    """0 of each axis of the machine."""
    columns = sorted(axis.index for axis in raiser.machine.axes)
    return tuple(
        AxisPlace(AXIS_NAMES[n], Quantity(Number(0.0, span), "mm" if raiser.linear[n] else "deg")) for n in columns
    )


def local_set(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G92: the present place gets these numbers; alone: machine coordinates."""
    if not line.axes():
        return _zero(raiser, line, "zero_at", everywhere(raiser, line.span))
    if line.mask & 3 == 3:
        raiser.set_own("cell", False)
    return _zero(raiser, line, "local_here", raiser.places(line))


def local_at(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G92.1: zero is at these machine places."""
    return _zero(raiser, line, "zero_at", raiser.places(line)) if line.axes() else []


def local_shift(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G92.2: zero is shifted by so much."""
    return _zero(raiser, line, "zero_shift", raiser.places(line)) if line.axes() else []


def local_switch(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G92.3: the first one puts the zero away, the next one takes it out again."""
    stored = raiser.own_mode("stored", False)
    if unknown(stored):
        raise Unraisable(rule.text, "whether a zero is put away depends on the way that the program took")
    number = slot(raiser, rule.text, line.span)
    raiser.set_own("stored", not stored)
    if stored:
        return [replace_number(node, number) for node in _zero(raiser, line, "zero_recall", ())]
    kept = SetFrame(action="zero_keep", number=number, span=line.span)
    return [kept, *_zero(raiser, line, "zero_at", everywhere(raiser, line.span))]


def replace_number(node: Node, number: Expr) -> Node:
    """The same with a number."""
    assert isinstance(node, SetFrame)
    return replace(node, number=number)


def keep_local(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """L92: the zero outlives this file."""
    raiser.set_own("keep", True)
    return []


def zero_back(raiser: LineRaiser, name: str, span: Span) -> list[Node]:
    """The end of a file: the zero of its start is back, unless L92 was there; Unraisable where that is not known."""
    if raiser.modes is None or raiser.own_mode("moved", False) is False:
        return []
    keep = raiser.own_mode("keep", False)
    if unknown(keep):
        raise Unraisable("L92", "whether the zero outlives the file depends on the way that the program took")
    if keep is True:
        return []
    raiser.set_own("moved", False)
    raiser.modes = replace(raiser.now, sticky=())
    raiser.forget_height()
    return [SetFrame(action="zero_recall", number=slot(raiser, name, span), span=span)]


# ---- workspaces, lengths, homing


def workspace(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G54 to G59: another head, at the same X and Y of the program."""
    if line.axes():
        raise Unraisable(f"{rule.text} with X or Y", "which only workspaces of type 3 have")
    space = next((one for one in raiser.controls.workspaces if one.number == rule.value + 53), None)
    if space is not None and space.kind:
        raise Unraisable(f"{rule.text} of type {space.kind}", "how the spindle turns is not described")
    if rule.value != 1 and space is None:
        raise Unraisable(rule.text, "the machine file has no such workspace")
    moves = space is not None and space.moves is not False and (space.x, space.y) != (0.0, 0.0)
    moves = moves or any((one.x, one.y) != (0.0, 0.0) for one in raiser.controls.workspaces if one.moves is not False)
    if moves and raiser.own_mode("work", 1) != rule.value:
        raise Unraisable(rule.text, "the axes move to the same place of the other workspace")
    raiser.set_own("work", rule.value)
    raiser.forget_height()
    return [SetFrame(action="select", number=Number(float(rule.value), line.span), span=line.span)]


def lengths(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G43, G49: tool lengths on and off."""
    if line.axes():
        raise Unraisable(f"{rule.text} of some axes", "a length of one head alone")
    raiser.forget_height()
    raiser.set_own("lengths", rule.function is F.TOOL_OFFSET_ON)
    return [UseLength(on=rule.function is F.TOOL_OFFSET_ON, span=line.span)]


def limit_guards(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """L20, L21: soft limits and boundaries on and off; X1 boundaries alone, X2 soft limits alone."""
    on = rule.function is F.LIMITS_ON
    which = line.number("X") if on else None
    if which not in (None, 1.0, 2.0):
        raise Unraisable(rule.text, "X is 1 or 2")
    states = (("machine_area", on and which != 1.0), ("boundaries", on and which != 2.0))
    return [SwitchGuard(name=name, on=state, span=line.span) for name, state in states]


def home(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G28: axes run to their switches, in the order of the lines g28move=."""
    listed = [name for one in raiser.controls.homing for name, _ in one.distances]
    columns = sorted(line.axes()) or sorted(axis.index for axis in raiser.machine.axes)
    names = sorted(
        (AXIS_NAMES[n] for n in columns), key=lambda name: listed.index(name) if name in listed else len(listed)
    )
    raiser.set_own("settled", False)
    raiser.forget_height()
    return [HomeAxes(axes=tuple(names), span=line.span)]


# ---- scaling, rotation


def _begin(raiser: LineRaiser, line: Command, turn: str) -> None:
    before = raiser.own_mode("turn", "")
    if before not in ("", turn):
        raise Unraisable(f"{line.name} while G51 or G52 is on", "which comes first the manual does not say")
    raiser.set_own("turn", turn)
    raiser.set_own("settled", False)
    raiser.modes = replace(raiser.now, sticky=())
    raiser.forget_height()


def scaling(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G51: factors of axes about a fixed point."""
    words = line.axes()
    if not words:
        return []
    if raiser.own_mode("turn", "") == "scale":
        raise Unraisable("G51 after G51", "whether an axis that the second one does not name stays scaled")
    _begin(raiser, line, "scale")
    zero = Number(0.0, line.span)
    common = line.value("C") or zero
    middle = {0: line.value("I") or common, 1: line.value("J") or common, 2: line.value("K") or common}
    factors, places = [], []
    for column, word in sorted(words.items()):
        if word.number is None or word.number == 0.0:
            raise Unraisable("G51", "a factor that is computed, or 0")
        factors.append(AxisPlace(AXIS_NAMES[column], Quantity(word.value, "1")))
        places.append(AxisPlace(AXIS_NAMES[column], raiser.amount(column, middle.get(column, common))))
    return [SetFrame(action="scale", factors=tuple(factors), places=tuple(places), span=line.span)]


def rotation(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G52: by A degrees about I and J."""
    _begin(raiser, line, "rotate")
    zero = Number(0.0, line.span)
    angle = line.value("A") or zero
    if raiser.controls.rotation_sign < 0:
        angle = Number(-angle.value, angle.span) if isinstance(angle, Number) else Unary("neg", angle, angle.span)
    places = tuple(
        AxisPlace(axis, raiser.length(line.value(letter) or zero)) for axis, letter in (("x", "I"), ("y", "J"))
    )
    return [SetFrame(action="rotate", angle=Quantity(angle, "deg"), places=places, span=line.span)]


def transform_off(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G50: neither; nothing moves."""
    turn = raiser.own_mode("turn", "")
    raiser.set_own("turn", "")
    raiser.modes = replace(raiser.now, sticky=())
    raiser.forget_height()
    names = {"rotate": ("rotate_off",), "scale": ("scale_off",), "": ()}.get(str(turn), ("rotate_off", "scale_off"))
    return [SetFrame(action=name, span=line.span) for name in names]
