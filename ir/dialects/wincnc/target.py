"""WinCNC as a target of translation; the manual has no section numbers: headings and codes are named instead."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.machine import Machine
from gproof.ir.target import Style, Target

LACKS = {
    "frame_select": "it has one zero (G92), and the job selects several work offsets (Workspace)",
    "frame_select_axes": "it has one zero (G92), and the job selects several work offsets (Workspace)",
    "choice_else": "an input decides about one line (M17.1)",
    "while": "the only loop is an array (L10)",
    "repeat": "the only loop is an array (L10)",
    "variable": "a job has no variables of its own (Braces)",
    "system_variable": "a job has no variables of its own (Braces)",
    "cycle_tap_right": "no cycle and no move follows the turns of the spindle (G Codes)",
    "cycle_tap_left": "no cycle and no move follows the turns of the spindle (G Codes)",
    "probe": "only a limit switch ends a move, with M28 (G31, M28)",
    "per_revolution": "F is a feed a minute, or inverse time (F; G93)",
    "park": "stored positions are numbers of this controller (P, H)",
    "path_exact_stop": "how corners are taken is a setting (G9)",
    "compensation": "O of G41 is a difference of diameters, and the entry is open (G41, G42)",
    "input_read": "an input decides about the next line alone (M17.1)",
    "wait_timeout": "M17 waits without a limit (M17, M18)",
    "rapid_straight": "the manual does not say that rapids are straight (G0)",
    "spindle_reverse": "its M3 or M4 leaves the output of the other one on (CNC.MAC): write M5 before it",
}
"""Why constructs that nothing rewrites are refused."""

TARGET = Target(
    name="wincnc",
    title="WinCNC",
    legal={
        "choice": "M Codes: M17.1, M18.1", "question": "G Codes: G5", "input_value": "M Codes: M17.1, M18.1",
        "routine": "M Codes: M98", "grid": "L Codes: L10",
        "cycle_drill": "G Codes: G81", "cycle_dwell": "G Codes: G82", "cycle_peck": "G Codes: G83",
        "cycle_chip_break": "G Codes: G73",
        "arc": "G Codes: G2, G3", "arc_full": "G Codes: G2, G3", "arc_helix": "G Codes: G2, G3",
        "unit_mm": "G Codes: G22", "unit_inch": "G Codes: G20", "unit_cm": "G Codes: G21", "relative": "G Codes: G91",
        "inverse_time": "G Codes: G93", "machine_move": "G Codes: G53", "home": "G Codes: G28",
        "frame_rotate": "G Codes: G52, G50", "frame_local_here": "G Codes: G92", "frame_zero_at": "G Codes: G92.1",
        "frame_zero_shift": "G Codes: G92.2", "frame_zero_keep": "G Codes: G92.3; L Codes: L92",
        "frame_zero_recall": "G Codes: G92.3; L Codes: L92",
        "frame_zero_register": "L Codes: L92", "length": "G Codes: G43, G49",
        "tool_change": "Macro File Configuration", "tool_change_running": "Macro File Configuration",
        "spindle": "Macro File Configuration",
        "spindle_reverse": "Macro File Configuration, where M3 and M4 switch off the output of the other one",
        "spindle_speed": "Parameters in [Brackets]: S",
        "mist": "Macro File Configuration", "flood": "Macro File Configuration",
        "output": "M Codes: M11, M12", "output_moving": "M Codes: M13, M14",
        "wait": "M Codes: M17, M18", "dwell": "G Codes: G4", "stop": "G Codes: G4",
        "feed_alone": "Parameters in [Brackets]: F", "straight": "G Codes: G1", "rapid": "G Codes: G0",
        "end": "M Codes: M99", "end_reset": "M Codes: M99", "end_running": "M Codes: M99",
        "end_reset_running": "M Codes: M99", "comment": "Parameters in [Brackets]: Comment",
    },
    lacks=LACKS,
    style=Style(extension=".tap", line_length=256),
    straight_rapids=None,
    peck_clearance=1.27,
    cycle_returns=False,
    guards=frozenset(("machine_area", "boundaries")),
    two_ways=False,
)  # fmt: skip
"""The clearance of chip breaking is always .05 inch, that of pecking is what g81set= R says, else the same."""


USUAL_CLEARANCE = 1.27


_SWITCH = re.compile(r"M(11|12|13|14)C(\d+)", re.IGNORECASE)
BY_MACROS = {"spindle": ("M3", "M5"), "mist": ("M7", "M9"), "flood": ("M8", "M9")}


def adapted(
    target: Target, machine: Machine, macros: Mapping[str, str] | None, one_way: frozenset[str] = frozenset()
) -> Target:
    """The table for a machine: its settings change what cycles and arcs do (g81set=, g81dwell=, arcs=), and what has
    no code here is what CNC.MAC defines. macros: commands by name, None: they are not known; one_way: see Target."""
    settings = wincnc_settings(machine)
    lost: set[str] = set()
    if settings.drill.dwell or settings.drill.other_dwell:
        lost |= {"cycle_drill", "cycle_peck", "cycle_chip_break"}
    if settings.drill.lift:
        lost.add("cycle_peck")
    if not settings.helical_arcs:
        lost.add("arc_helix")
    if machine.controller.absolute_arc_centers:
        lost |= {"arc", "arc_full", "arc_helix"}
    approach = settings.drill.approach
    same = approach is None or approach == USUAL_CLEARANCE
    legal = {name: source for name, source in target.legal.items() if name not in lost}
    if macros is not None:
        for name, codes in BY_MACROS.items():
            if not macros.keys() >= set(codes) or not _ends(*(macros[code] for code in codes)):
                legal.pop(name, None)
        if "M6" not in macros:
            legal.pop("tool_change", None)
    return replace(target, legal=legal, peck_clearance=USUAL_CLEARANCE if same else None, one_way=one_way)


def _ends(start: str, end: str) -> bool:
    """Whether a command may switch off what another one switches on: two that name one output each have the same."""
    found = [_SWITCH.fullmatch(re.sub(r"[ \t]", "", text)) for text in (start, end)]
    return None in found or len({one.group(2) for one in found if one is not None}) == 1
