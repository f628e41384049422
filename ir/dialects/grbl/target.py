"""grbl 1.1 as a target of translation; sources: the list of supported G-codes on the first page of its documentation
("Supported G-Codes"), its wiki's pages "Interface" and "Settings", and NIST IR 6556 by section where these refer to it.

It has no variables, choices, loops, subprograms, cycles, messages or outputs, has no M6 (T is allowed), has M7 only
in builds that switch it on, and does not stop at M1. An arc needs an axis of its plane: a full circle names its end.
Programs cannot say how corners are taken: that is setting $11.
"""

from __future__ import annotations

from gproof.ir.target import Style, Target

_LIST = "Supported G-Codes"

TARGET = Target(
    name="grbl",
    title="grbl 1.1",
    legal={
        "arc": _LIST, "arc_radius": _LIST, "arc_helix": _LIST, "arc_xz": _LIST, "arc_yz": _LIST,
        "unit_mm": _LIST, "unit_inch": _LIST, "relative": _LIST, "probe": _LIST, "inverse_time": _LIST,
        "machine_move": _LIST, "machine_feed": _LIST,
        "park": _LIST, "frame_store": _LIST, "frame_store_here": _LIST, "frame_select": _LIST,
        "frame_local_here": _LIST, "frame_local_off": _LIST, "length": _LIST,
        "spindle_speed": "Supported G-Codes, S", "spindle": _LIST, "flood": _LIST, "dwell": _LIST, "stop": _LIST,
        "feed_alone": "Supported G-Codes, F", "straight": _LIST, "rapid": _LIST, "end": _LIST, "end_reset": _LIST,
        "end_rests": _LIST, "tool_change_running": "a stop (M0) where the map says so: the spindle stays as it is",
        "comment": "Interface, Comments",
    },
    style=Style(extension=".nc", decimals_mm=4, line_length=70),
    axes=("x", "y", "z"),
    path_modes=False,
    straight_rapids=True,
    offsets=6,
    spare_offset=6,
    tools=255,
    length_numbers=True,
)  # fmt: skip
