"""Eding CNC as a target of translation; sections are those of the Eding CNC manual 4.01."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.target import Style, Target

# 3.2.2.3 and 3.2.2.4, under the names of ir/rules.py.
OPERATORS = (
    "neg", "pos", "abs", "acos", "asin", "atan", "cos", "exp", "fix", "fup", "int", "ln", "round", "sin", "sqrt", "tan",
    "not", "+", "-", "*", "/", "**", "mod", "and", "or", "xor", ">", ">=", "<", "<=", "==", "<>", "<<", ">>",
)  # fmt: skip

LACKS = {
    "question": "DlgMsg needs numbers (4.2), and there is no question with yes and no",
    "home": "reference runs belong to macro.cnc (sub home_x) and its buttons",
    "frame_beyond": "work offsets are G54 to G59.3 (3.4.15)",
    "frame_zero_register": "nothing keeps a work zero apart (3.4.15, 3.4.23)",
    "output_moving": "M54 and M55 let the axes come to rest (3.5.9)",
}
"""Why constructs that nothing rewrites are refused."""

TARGET = Target(
    name="eding",
    title="Eding CNC",
    legal={
        "choice": "4.1", "while": "4.1", "routine": "4.1", "variable": "3.2.2.2", "indirect": "3.2.2.2",
        "expression": "3.2.2.3", "system_variable": "3.1.1",
        "cycle_drill": "3.4.21.2", "cycle_dwell": "3.4.21.3", "cycle_peck": "3.4.21.4", "cycle_chip_break": "3.4.21.5",
        "cycle_bore": "3.4.21.8", "cycle_bore_stop": "3.4.21.9", "cycle_bore_dwell": "3.4.21.12",
        "cycle_tap_right": "3.4.21.6", "cycle_tap_left": "3.4.21.7", "cycle_repeats": "3.4.21",
        "cycle_relative": "3.4.21", "cycle_plane": "3.4.21",
        "arc": "3.4.3.2", "arc_radius": "3.4.3.1", "arc_helix": "3.4.3", "arc_xz": "3.4.6",
        "arc_yz": "3.4.6", "unit_mm": "3.4.7", "unit_inch": "3.4.7", "relative": "3.4.22", "probe": "3.4.10",
        "inverse_time": "3.4.24", "per_revolution": "3.4.24", "machine_move": "3.4.14", "machine_feed": "3.4.14",
        "park": "3.4.8",
        "frame_rotate": "3.4.18", "frame_scale": "3.4.13", "frame_store": "3.4.5", "frame_store_here": "3.4.5",
        "frame_select": "3.4.15", "frame_local_here": "3.4.23", "frame_local_off": "3.4.23",
        "frame_local_suspend": "3.4.23", "frame_local_restore": "3.4.23",
        "path_continuous": "3.4.16", "path_tolerance": "3.4.16",
        "path_filter": "3.4.16", "input_read": "3.5.9", "guard": "4.2", "path_exact_path": "3.4.16",
        "path_exact_stop": "3.4.16", "compensation": "3.4.11", "compensation_diameter": "3.4.11", "length": "3.4.12",
        "tool_select": "3.1.2", "tool_change": "3.5.3", "tool_change_rests": "3.5.3",
        "tool_change_selected": "3.5.3",
        "spindle_speed": "3.5.2", "spindle": "3.5.2", "spindle_reverse": "3.5.2", "mist": "3.5.4",
        "flood": "3.5.4", "output": "3.5.9", "wait_open": "3.5.9", "wait_timeout": "3.5.9", "dwell": "3.4.4",
        "stop": "3.5.1", "optional_stop": "3.5.1", "overrides": "3.5.5", "message": "4.2", "feed_alone": "3.7",
        "straight": "3.4.2", "rapid": "3.4.1", "rapid_straight": "3.4.1", "cycle_straight": "3.4.21",
        "end": "3.5.1", "end_running": "3.5.1",
        "end_reset": "3.5.1", "end_rests": "3.5.1",
        "comment": "3.2.4",
    },
    lacks=LACKS,
    style=Style(extension=".cnc"),
    variables=(1, 3999),
    operators=frozenset(OPERATORS),
    path_modes=True,
    straight_rapids=True,
    peck_clearance=0.254,
    spare_offset=9,
    guards=frozenset(("tool_change_area", "machine_area")),
)  # fmt: skip


def adapted(target: Target, source: str) -> Target:
    """A wait of its own programs is the same here; how long M56 waits without Q the manual does not say (3.5.9)."""
    return replace(target, legal=target.legal | {"wait": "3.5.9"}) if source == target.name else target
