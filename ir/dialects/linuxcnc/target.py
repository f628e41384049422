"""LinuxCNC as a target of translation; sections are those of its user manual 2.9: "G-Codes", "M-Codes", "O Codes",
"G-Code Overview" (short: Overview).

What it has, and is not in the table because it is not the same thing on every machine or not surely the same path:
peck cycles (their clearance is a setting of the controller from 2.10 on, with other defaults), boring that feeds out
(G85 and G89 feed up to the height of G98, other controllers only to R), tapping (it follows the
spindle's encoder), cutter compensation (its entry moves are its own).
"""

from __future__ import annotations

from gproof.ir.target import Style, Target

LACKS = {
    "question": "its messages wait for nothing (Overview, Messages)",
    "cycle_tap_right": "G33.1 follows an encoder of the spindle, G84 of other controllers need not (G-Codes G33.1)",
    "cycle_tap_left": "G33.1 follows an encoder of the spindle, G74 of other controllers need not (G-Codes G33.1)",
    "home": "no code homes an axis (G-Codes)",
    "frame_beyond": "work offsets are G54 to G59.3 (G-Codes G54-G59.3)",
    "frame_zero_register": "nothing keeps a work zero apart (G-Codes G92)",
    "compensation": "its entry moves are its own (G-Codes G41 G42)",
    "input_read": "what M66 reads is known in the run alone, and the text is read back without one (M-Codes M66)",
    "system_variable": "what a variable of the controller holds is known in the run alone (Overview, Parameters)",
}
"""Why constructs that nothing rewrites are refused."""

TARGET = Target(
    name="linuxcnc",
    title="LinuxCNC",
    legal={
        "choice": "O Codes, Conditional", "while": "O Codes, Looping", "repeat": "O Codes, Looping",
        "routine": "O Codes, Subroutines", "variable": "Overview, Parameters", "indirect": "Overview, Parameters",
        "expression": "Overview, Expressions",
        "cycle_drill": "G-Codes G81", "cycle_dwell": "G-Codes G82", "cycle_bore_stop": "G-Codes G86",
        "arc": "G-Codes G2 G3", "arc_radius": "G-Codes G2 G3", "arc_full": "G-Codes G2 G3",
        "arc_helix": "G-Codes G2 G3", "arc_xz": "G-Codes G17-G19.1", "arc_yz": "G-Codes G17-G19.1",
        "unit_mm": "G-Codes G20 G21", "unit_inch": "G-Codes G20 G21", "relative": "G-Codes G90 G91",
        "probe": "G-Codes G38.n", "inverse_time": "G-Codes G93 G94 G95", "per_revolution": "G-Codes G93 G94 G95",
        "machine_move": "G-Codes G53", "machine_feed": "G-Codes G53",
        "park": "G-Codes G28 G30", "frame_store": "G-Codes G10 L2",
        "frame_store_here": "G-Codes G10 L20", "frame_select": "G-Codes G54-G59.3", "frame_local_here": "G-Codes G92",
        "frame_local_off": "G-Codes G92.1", "frame_local_suspend": "G-Codes G92.2",
        "frame_local_restore": "G-Codes G92.3", "path_continuous": "G-Codes G64", "path_tolerance": "G-Codes G64",
        "path_exact_path": "G-Codes G61", "path_exact_stop": "G-Codes G61.1", "length": "G-Codes G43 G49",
        "tool_select": "M-Codes T", "tool_change": "M-Codes M6", "tool_change_rests": "M-Codes M6",
        "tool_change_selected": "M-Codes M6",
        "spindle_speed": "M-Codes S",
        "spindle": "M-Codes M3 M4 M5", "spindle_reverse": "M-Codes M3 M4 M5",
        "mist": "M-Codes M7", "flood": "M-Codes M8", "output": "M-Codes M62-M65",
        "output_moving": "M-Codes M62-M65", "wait": "M-Codes M66", "wait_timeout": "M-Codes M66", "dwell": "G-Codes G4",
        "stop": "M-Codes M0 M1", "optional_stop": "M-Codes M0 M1", "overrides": "M-Codes M48 M49",
        "message": "Overview, Messages", "feed_alone": "Overview, F", "straight": "G-Codes G1", "rapid": "G-Codes G0",
        "rapid_straight": "G-Codes G0", "cycle_straight": "G-Codes G81",
        "end": "M-Codes M2 M30", "end_reset": "M-Codes M2 M30", "end_rests": "M-Codes M2 M30",
        "comment": "Overview, Comments",
    },
    lacks=LACKS,
    style=Style(extension=".ngc", line_length=255),
    variables=(31, 5000),
    path_modes=True,
    straight_rapids=True,
    ends_with_file=True,  # between percent signs: Overview, File Requirements
    offsets=9,
    spare_offset=9,
    tools=99999,
    channels=("M-Codes M62-M65, M66", 63),
)  # fmt: skip
