"""grbl 1.1 as a target of translation; sources: the list of supported G-codes on the first page of its documentation
("Supported G-Codes"), its wiki's pages "Interface" and "Settings", and NIST IR 6556 by section where these refer to it.

It has no variables, choices, loops, subprograms, cycles, messages or outputs, has no M6 (T is allowed), has M7 only
in builds that switch it on, and does not stop at M1. An arc needs an axis of its plane: a full circle names its end.
Programs cannot say how corners are taken: that is setting $11.
"""

from __future__ import annotations

from gproof.ir.target import Style, Target

_LIST = "Supported G-Codes"

LACKS = {
    "while": "its programs have no loops (Interface)",
    "repeat": "its programs have no loops (Interface)",
    "variable": "its programs have no variables (Interface)",
    "system_variable": "its programs have no variables (Interface)",
    "question": "no code asks the operator (Supported G-Codes)",
    "choice": "its programs have no conditions (Interface)",
    "cycle_tap_right": "no code follows the turns of the spindle (Supported G-Codes)",
    "cycle_tap_left": "no code follows the turns of the spindle (Supported G-Codes)",
    "per_revolution": "G95 is not in its list of codes (Supported G-Codes)",
    "home": "$H is a command of its own, no code of a program (Interface)",
    "frame_beyond": "work offsets are G54 to G59 (Supported G-Codes)",
    "frame_local_restore": "G92.3 is not in its list of codes (Supported G-Codes)",
    "frame_local_suspend": "G92.2 is not in its list of codes (Supported G-Codes)",
    "frame_zero_register": "nothing keeps a work zero apart (Supported G-Codes)",
    "path_exact_stop": "how corners are taken is setting $11 (Settings)",
    "compensation": "G41 and G42 are not in its list of codes (Supported G-Codes)",
    "output_moving": "M62 to M65 are not in its list of codes (Supported G-Codes)",
    "output": "M62 to M65 are not in its list of codes (Supported G-Codes)",
    "input_read": "M66 is not in its list of codes (Supported G-Codes)",
    "wait_timeout": "M66 is not in its list of codes (Supported G-Codes)",
    "wait": "M66 is not in its list of codes (Supported G-Codes)",
}
"""Why constructs that nothing rewrites are refused."""

TARGET = Target(
    name="grbl",
    title="grbl 1.1",
    legal={
        "arc": _LIST, "arc_radius": _LIST, "arc_helix": _LIST, "arc_xz": _LIST, "arc_yz": _LIST,
        "unit_mm": _LIST, "unit_inch": _LIST, "relative": _LIST, "probe": _LIST, "inverse_time": _LIST,
        "machine_move": _LIST, "machine_feed": _LIST,
        "park": _LIST, "frame_store": _LIST, "frame_store_here": _LIST, "frame_select": _LIST,
        "frame_local_here": _LIST, "frame_local_off": _LIST, "length": _LIST,
        "spindle_speed": "Supported G-Codes, S", "spindle": _LIST, "spindle_reverse": _LIST,
        "flood": _LIST, "dwell": _LIST, "stop": _LIST,
        "feed_alone": "Supported G-Codes, F", "straight": _LIST, "rapid": _LIST, "rapid_straight": _LIST,
        "end": _LIST, "end_reset": _LIST,
        "end_rests": _LIST, "tool_change_running": "a stop (M0) where the map says so: the spindle stays as it is",
        "comment": "Interface, Comments",
    },
    lacks=LACKS,
    style=Style(extension=".nc", decimals_mm=4, line_length=70),
    axes=("x", "y", "z"),
    path_modes=False,
    straight_rapids=True,
    ends_with_file=True,  # a stream of lines (Interface)
    offsets=6,
    spare_offset=6,
    tools=255,
    length_numbers=True,
)  # fmt: skip
