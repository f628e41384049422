"""What is known of a WinCNC machine when no file says anything."""

from __future__ import annotations

from gproof.ir.dialects.wincnc.settings import WinCncSettings
from gproof.ir.machine import Axis, AxisKind, Controller, Machine

_LINEAR, _ROTARY = AxisKind.LINEAR, AxisKind.ROTARY

NO_SHOP = Machine(
    name="(no machine file)",
    axes=(
        *(Axis(name=name, kind=_LINEAR) for name in "xyz"),
        Axis(name="a", kind=_LINEAR, letter="W"),
        Axis(name="b", kind=_ROTARY, letter="A"),
        Axis(name="c", kind=_ROTARY, letter="C"),
    ),
    controller=Controller(dialect="wincnc"),
    settings=WinCncSettings(unit_stated=False),
    unit=25.4,
)
"""Six axes of which nothing is known; inches, as WINCNC.INI has them when it says nothing (Unit Settings)."""
