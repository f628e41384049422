"""Statements of chapter 4 of the Eding manual as text: calls, messages, guards, commands."""

from __future__ import annotations

from collections.abc import Callable

from gproof.backend.emit.eding.expressions import inside, part, quoted, value, variable
from gproof.backend.emit.printer import Unprintable
from gproof.ir.program import Call, Device, Expr, Guard, Message, Number, Statement, Text, Unsupported, Variable

_MESSAGES = {"msg": "msg", "warning": "warnmsg", "error": "errmsg", "log": "logmsg"}
_GUARDS = {"tool_change_area": "tcaguard", "machine_area": "mcaguard"}


def statement_text(node: Statement) -> str:
    """A statement that fills its line; Unprintable when Eding has none like it."""
    if isinstance(node, Call):
        return f"gosub {node.name}"
    if isinstance(node, Guard):
        return f"{_GUARDS[node.name]} {'on' if node.on else 'off'}"
    if isinstance(node, Message) and node.kind == "dialog":
        return " ".join(["dlgmsg", *(_label(label) for label in node.parts)])
    if isinstance(node, Message):
        return " ".join([_MESSAGES[node.kind], *(part(one) for one in node.parts)])
    if isinstance(node, Unsupported) and node.text:
        return node.text
    if isinstance(node, Unsupported):
        raise Unprintable(node.what)
    assert isinstance(node, Device)
    if node.name not in _DEVICES:
        raise Unprintable(f"the command {node.name!r}")
    words, forms = _DEVICES[node.name]
    if node.name == "nesting":
        name, amount = node.arguments
        return f"%{_name(name)} = {_amount(amount)}"
    arguments = zip(forms * len(node.arguments) if len(forms) == 1 else forms, node.arguments, strict=False)
    return " ".join([words, *(form(argument) for form, argument in arguments)])


def _name(node: Expr) -> str:
    """The name of an axis, a switch or a setting."""
    if isinstance(node, Text):
        return node.value
    raise Unprintable("an expression in the place of a name")


def _amount(node: Expr) -> str:
    """A value that may follow another one, so that it has no sign outside brackets."""
    if isinstance(node, Number):
        return value(node, grouped=inside(node).startswith("-"))
    return variable(node) if isinstance(node, Variable) else f"[{inside(node)}]"


def _label(node: Expr) -> str:
    """A name in quotes, or a number."""
    if isinstance(node, Text):
        return quoted(node.value)
    if isinstance(node, Number):
        return inside(node)
    raise Unprintable("an expression in a dialog")


_DEVICES: dict[str, tuple[str, tuple[Callable[[Expr], str], ...]]] = {
    "home": ("home", (_name,)),
    "home_tandem": ("hometandem", (_name,)),
    "prepare_tandem_home": ("preparetandemhome", (_name,)),
    "align_slave": ("moveslavetomaster", (_name,)),
    "home_is_stop": ("homeisestop", (_name,)),
    "store_position": ("sp", (_label, value)),
    "log_file": ("logfile", (_label, value)),
    "laf_angle": ("setlafangle", (value,)),
    "knife_on": ("tanknife on", (value,)),
    "knife_off": ("tanknife off", ()),
    "knife_axis": ("tanknife", (_name,)),
    "knife_calibrate": ("tanknife", (_name,)),
    "height_map_init": ("zhcinit", (_amount,)),
    "height_map_add": ("zhcaddpoint", ()),
    "height_map_save": ("zhcs", (_label,)),
    "nesting": ("%", (_name, _amount)),
}
"""Commands (``DEVICES`` in ir/rules.py): the words, and the form of each argument; a single form is that of all."""
