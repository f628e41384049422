"""McuWIN as a target of translation; sections are those of the manual of V 2.5.3.133.

Left out is what the manual leaves open: the path that G41 and G42 make (2.7), about which zero places are mirrored
(3.9, 3.26), how F counts while a rotary axis turns (3.17). G00 has the axes' own units (3.1), so that programs are
written in millimetres.
"""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.dialects.mcuwin.pascal import ANGULAR, FUNCTIONS, RELATIONS
from gproof.ir.dialects.mcuwin.settings import mcuwin_settings
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.target import Style, Target

LACKS = {
    "rapid_straight": "each axis has its own velocity in a rapid (3.1)",
    "frame_rotate": "no code turns coordinates (3)",
    "system_variable": "what a variable of the controller holds is known in the run alone (12)",
    "question": "no command asks the operator (5.7)",
    "cycle_tap_right": "no cycle and no move follows the turns of the spindle (3)",
    "cycle_tap_left": "no cycle and no move follows the turns of the spindle (3)",
    "probe": "no move ends at a switch (3)",
    "per_revolution": "F is a feed in a unit of time (3.28, 5.3)",
    "park": "it has no parking places (3)",
    "home": "what G74 runs to the machine file has to state (3.23, 4)",
    "frame_store_here": "the table of zero offsets belongs to mcfg (3.19)",
    "path_exact_stop": "how corners are taken is a setting (3, 14)",
    "compensation": "which path G41 and G42 take is open (2.7)",
    "input_read": "an input is a condition, no number (7)",
    "wait_timeout": "a program has no clock (10)",
}
"""Why constructs that nothing rewrites are refused."""

TARGET = Target(
    name="mcuwin",
    title="McuWIN",
    legal={
        "choice": "7", "count_loop": "8.3", "repeat": "8.2", "while": "8.1", "jump": "4.15", "routine": "4.16",
        "routine_count": "4.16", "variable": "12", "expression": "12", "input_value": "7",
        "arc": "3.3", "arc_place": "3.35", "arc_full": "3.3", "arc_helix": "3.3", "unit_mm": "3.22", "relative": "3.25",
        "frame_select": "3.19", "frame_select_axes": "3.19",
        "frame_zero_at": "3.26", "frame_zero_shift": "3.26", "frame_zero_keep": "3.33",
        "frame_zero_recall": "3.34",
        "tool_select": "5.5", "tool_change": "4.7", "tool_change_running": "4.7",
        "tool_change_selected": "4.7",
        "spindle_speed": "5.4", "spindle": "4.4", "spindle_reverse": "4.4", "flood": "4.8",
        "output": "4.11", "output_moving": "4.11", "dwell": "3.5", "stop": "4.1", "optional_stop": "4.2",
        "message": "5.7.2", "feed_alone": "5.3", "straight": "3.2", "rapid": "3.1", "end": "4.3", "end_reset": "4.13",
        "end_running": "4.3", "end_reset_running": "4.13",
        "comment": "6",
    },
    lacks=LACKS,
    style=Style(extension=".src"),
    variables=(600, 699),
    path_modes=False,
    straight_rapids=False,
    offsets=5,
    tools=999_999,
    axis_channels=True,
    operators=frozenset((
        *RELATIONS.values(), "+", "-", "*", "/", "**", "and", "or", "xor", "not", "neg", "pos", "div", "rem", "band",
        "bor", "bxor", "bnot", "<<", "shr", *FUNCTIONS.values(), *ANGULAR, *(f"r{name}" for name in ANGULAR),
    )),
)  # fmt: skip


OWN = {"frame_mirror": "3.9", "frame_scale": "3.13", "frame_scale_axis": "3.13"}
"""What only a program of this controller can have: about which zero places are mirrored is open (3.9, 3.26)."""


def adapted(target: Target, machine: Machine, source: str) -> Target:
    """What a machine has besides, or has not: planes with a tool table (2.7), what Task 0 does (4, 5.5). source: the
    language of the job."""
    din = mcuwin_settings(machine)
    legal = target.legal | (OWN if source == target.name else {})
    if din.tools:
        legal |= {"arc_xz": "3.7", "arc_yz": "3.8"}
    if din.tools and source == target.name:
        legal |= {"compensation": "2.7", "compensation_plane": "2.7", "compensation_open": "2.7"}
    tool = din.task("T")
    if tool is None or tool.action == "unknown":
        legal = {name: source for name, source in legal.items() if name not in ("tool_select", "tool_change")}
    elif tool.action == "tool_change":
        for feature in ("tool_select", "tool_change_selected"):
            legal.pop(feature)
    home = din.task("G74")
    if home is not None and home.action == "home":
        legal["home"] = "3.23"
    axes = tuple(AXIS_NAMES[axis.index] for axis in machine.axes)
    return replace(target, legal=legal, axes=axes)
