"""The WinCNC dialect: G, L and M codes, what words they take, named variables.

Source: WinCNC Users Guide, Command Reference; ``source`` of a row is the part of it ("G Codes", "L Codes", "M Codes")
under which the code has its heading. docs/dialects/wincnc.md says how what the manual leaves open is read.
"""

from __future__ import annotations

import math

from gproof.ir.rules import CodeRule, LanguageRules
from gproof.ir.rules import Function as F

_ANY = math.inf
_PARTS = {"G": "G Codes", "L": "L Codes", "M": "M Codes"}


def _c(
    letter: str, number: float, function: F, takes: str = "", *, axes: bool = False, needs: str = "", value: int = 0,
    companion: bool = False, device: str = "", has_text: bool = False, group: str = "", reason: str = "",
    ranges: tuple[tuple[str, float, float], ...] = (),
) -> CodeRule:  # fmt: skip
    return CodeRule(
        letter=letter, tenths=round(number * 10), function=function, group=group, source=_PARTS[letter],
        uses_axes=axes, value=value, open=reason, takes=takes, needs=needs, companion=companion, device=device,
        has_text=has_text, ranges=ranges,
    )  # fmt: skip


def _open(
    letter: str, number: float, reason: str, takes: str = "", *, axes: bool = False, text: bool = False,
    device: str = "",
) -> CodeRule:  # fmt: skip
    return _c(letter, number, F.UNSUPPORTED, takes, axes=axes, reason=reason, has_text=text, device=device)


_MOTION = "motion"
_DRILL = "RQPFL"
_POWER = (("L", 1.0, 100.0),)
_STORED = (("P", 0, _ANY), ("H", 0, _ANY), ("T", 0, _ANY), ("L", 0, 1))
_NO_METHOD = "how the controller does it is not described"

_G = (
    _c("G", 0, F.TRAVERSE, "FPHT", axes=True, group=_MOTION),
    _c("G", 0.1, F.TRAVERSE_LIFTED, "F", axes=True),
    _c("G", 1, F.FEED, "FLPHT", axes=True, group=_MOTION, ranges=_POWER),
    _c("G", 2, F.ARC_CW, "IJKRFL", axes=True, group=_MOTION, ranges=_POWER),
    _c("G", 3, F.ARC_CCW, "IJKRFL", axes=True, group=_MOTION, ranges=_POWER),
    _c("G", 4, F.DWELL, "X"),
    _c("G", 5, F.DIALOG, "T", has_text=True),
    _c("G", 9, F.SMOOTHING, "SA"),
    _c("G", 20, F.UNITS_INCH),
    _c("G", 21, F.UNITS_CM),
    _c("G", 22, F.UNITS_MM),
    _c("G", 23, F.UNITS_LAST),
    _c("G", 28, F.HOME, axes=True),
    _c("G", 31, F.STOP_PARSING, companion=True),
    _c("G", 40, F.COMPENSATION_OFF),
    _c("G", 41, F.COMPENSATION_LEFT, "O"),
    _c("G", 42, F.COMPENSATION_RIGHT, "O"),
    _c("G", 43, F.TOOL_OFFSET_ON, axes=True),
    _c("G", 49, F.TOOL_OFFSET_OFF, axes=True),
    _c("G", 50, F.TRANSFORM_OFF),
    _c("G", 51, F.SCALING_ON, "IJKC", axes=True),
    _c("G", 52, F.ROTATION_ON, "IJA"),
    _c("G", 52.1, F.ROTATION_LINE, "AB", needs="AB"),
    _c("G", 53, F.MACHINE_TRAVERSE, "PHT", axes=True),
    *(_c("G", n, F.WORKSPACE, axes=True, value=n - 53) for n in range(54, 60)),
    _c("G", 73, F.DRILL_CHIP_BREAK, _DRILL, axes=True, group=_MOTION),
    _c("G", 80, F.MOTION_CANCEL),
    _c("G", 81, F.DRILL, _DRILL, axes=True, group=_MOTION),
    _c("G", 82, F.DRILL_DWELL, _DRILL, axes=True, group=_MOTION),
    _c("G", 83, F.DRILL_PECK, _DRILL, axes=True, group=_MOTION),
    _c("G", 90, F.ABSOLUTE, companion=True),
    _c("G", 91, F.INCREMENTAL, companion=True),
    _c("G", 92, F.LOCAL_SET, axes=True),
    _c("G", 92.1, F.LOCAL_SHIFT_MACHINE, axes=True),
    _c("G", 92.2, F.LOCAL_SHIFT, axes=True),
    _c("G", 92.3, F.LOCAL_SWITCH),
    _c("G", 92.4, F.LOCAL_CROSSING, "ABCDO", needs="ABCD"),
    _c("G", 93, F.FEED_INVERSE_TIME),
    _c("G", 94, F.FEED_PER_MINUTE),
    _c("G", 95, F.FEED_ROTARY, "F", ranges=(("F", 0, _ANY),)),
)

_SCAN = "the path of a scan depends on the scanned object"
_BITMAP = "the moves of bitmap engraving come from a picture file and are not described"

_L = (
    _c("L", 1, F.STORE_REGISTER, "NV", needs="NV"),
    _c("L", 1.1, F.DEVICE, "H"),
    _c("L", 1.2, F.LOAD_REGISTERS, "H"),
    _c("L", 3, F.STORE_HOME, axes=True),
    _c("L", 4, F.RETURN_HOME, axes=True),
    _c("L", 5, F.DYNAMICS, axes=True),
    _c("L", 6, F.DYNAMICS, axes=True),
    _c("L", 7, F.DYNAMICS, "P", ranges=(("P", 1, 100),)),
    _c("L", 8, F.BACKLASH, axes=True),
    _c("L", 9, F.BACKLASH, axes=True),
    _c("L", 10, F.ARRAY, "RCXYE"),
    _c("L", 11, F.MAP_WORDS, axes=True),
    _c("L", 12, F.MAP_HEADS, axes=True),
    _c("L", 13, F.MAP_PULSES, axes=True),
    _c("L", 20, F.LIMITS_ON, "X"),
    _c("L", 21, F.LIMITS_OFF),
    _c("L", 22, F.LOW_BOUNDARY, axes=True),
    _c("L", 22.1, F.LOW_BOUNDARY_RESTORE, axes=True),
    _c("L", 23, F.HIGH_BOUNDARY, axes=True),
    _c("L", 23.1, F.HIGH_BOUNDARY_RESTORE, axes=True),
    _c("L", 28, F.SET_MACHINE, axes=True),
    _c("L", 28.1, F.WRAP_ROTARY),
    _c("L", 29, F.DEVICE, axes=True),
    _c("L", 29.1, F.DEVICE),
    _c("L", 30, F.KNIFE_ON, device="knife"),
    _c("L", 30.1, F.KNIFE_SETTING, "AZP", device="knife"),
    _c("L", 31, F.KNIFE_OFF, device="knife"),
    _c("L", 32, F.SAW_ON, device="saw"),
    _c("L", 33, F.SAW_OFF, device="saw"),
    _c("L", 34, F.AUTO_OUTPUT_ON, "D", device="autoaux", ranges=(("D", 0, _ANY),)),
    _c("L", 35, F.AUTO_OUTPUT_OFF, "D", device="autoaux", ranges=(("D", 0, _ANY),)),
    _c("L", 36, F.HEIGHT_ON, device="thc"),
    _c("L", 36.1, F.DEVICE, device="thc"),
    _c("L", 36.2, F.DEVICE, device="thc"),
    _c("L", 37, F.HEIGHT_OFF, device="thc"),
    _c("L", 37.1, F.DEVICE, device="thc"),
    _c("L", 38, F.TORCH_ON, "A", device="thc"),
    _c("L", 39, F.TORCH_OFF, device="thc"),
    _c("L", 40, F.FEED_OVERRIDE, "P", needs="P"),
    _c("L", 41, F.SHELL, has_text=True),
    _c("L", 48, F.DEVICE),
    _c("L", 51, F.ANALOG, "VPS", device="da", ranges=(("V", 0, _ANY), ("P", 0, 100), ("S", 0, _ANY))),
    _c("L", 53, F.LEVEL_HEADS),
    *(_c("L", n, F.DEVICE, device="pump") for n in (55, 56, 57, 58)),
    _c("L", 59, F.DEVICE, "M", device="pump"),
    _c("L", 60, F.VIRTUAL_OFF, "C", needs="C"),
    _c("L", 61, F.VIRTUAL_ON, "C", needs="C"),
    _c("L", 70, F.DEVICE),
    _c("L", 82, F.MEASURE_SURFACE, "Z", device="probe"),
    _open("L", 82.1, "it rests on a calibration that an earlier job left", axes=True),
    _open("L", 82.2, "it rests on a calibration that an earlier job left", axes=True),
    _c("L", 82.3, F.DEVICE, device="probe"),
    _c("L", 83, F.MEASURE_DEPTH, "XY", device="probe"),
    _c("L", 90, F.ABSOLUTE_ONCE, companion=True),
    _c("L", 91, F.INCREMENTAL_ONCE, companion=True),
    _c("L", 92, F.KEEP_LOCAL),
    _c("L", 101, F.TOOL_NUMBER, "TR", needs="T", value=1, device="atc1"),
    _c("L", 102, F.TOOL_NUMBER, "TR", needs="T", value=2, device="atc2"),
    _c("L", 110, F.TOOL_NUMBER, "T", needs="T", value=1, device="atc1"),
    _c("L", 111, F.CONDITION, "TA", needs="T"),
    _c("L", 111.1, F.CONDITION, "T", needs="T"),
    _c("L", 112, F.CONDITION, "T", needs="T"),
    _c("L", 113, F.CONDITION, "LHV", needs="LHV"),
    _c("L", 120, F.TOOL_NUMBER, "T", needs="T", value=2, device="atc2"),
    _c("L", 201, F.DEVICE, has_text=True),
    _c("L", 202, F.DEVICE, has_text=True),
    _c("L", 204, F.DEVICE, "C"),
    _c("L", 205, F.DEVICE, "C"),
    _c("L", 210, F.DEVICE, axes=True),
    _c("L", 210.1, F.DEVICE, "C", axes=True),
    _c("L", 211, F.DEVICE, axes=True),
    _c("L", 211.1, F.DEVICE, "C", axes=True),
    _c("L", 212, F.DEVICE),
    *(
        _open("L", n, "how an axis is whose two motors no longer move together is not modelled", axes=True)
        for n in (213, 214)
    ),
    _c("L", 215, F.DEVICE, axes=True),
    _c("L", 249, F.DEVICE, "PIF", device="laser"),
    _c("L", 250, F.DEVICE, device="laser"),
    _c("L", 251, F.DEVICE, "PDL", device="laser", ranges=(("P", 1, 100),)),
    _c("L", 251.1, F.DWELL, "D", device="laser"),
    *(_open("L", n, _BITMAP, text=True, device="laser") for n in (252, 253, 254, 255)),
    *(_c("L", n + 0.1, F.DEVICE, device="laser") for n in (252, 253, 254, 255)),
    _c("L", 256, F.DEVICE, "R", device="laser"),
    _c("L", 300, F.LOCK_AXIS, axes=True),
    _c("L", 301, F.UNLOCK_AXIS, axes=True),
    _c("L", 400, F.DEVICE, has_text=True),
    _c("L", 401, F.RECALL_POSITIONS),
    _open("L", 402, "its heading says that it saves, its text that it moves all axes", text=True),
    _c("L", 500, F.STORE_POSITION, "PHTLCN", axes=True, has_text=True, ranges=_STORED),
    _c("L", 500.2, F.STORE_TOOL, "TNACOHM", needs="T", ranges=tuple((letter, 0, _ANY) for letter in "TNAM")),
    _c("L", 501, F.STORE_LOCAL_POSITION, "PHTLCN", axes=True, has_text=True, ranges=_STORED),
    _c("L", 502, F.DEVICE, "XYWH"),
    *(_c("L", n, F.MAP_ADJUSTMENT, axes=True, reason="the map of an axis is in no file that is described")
      for n in (600, 601)),
    *(_open("L", n, "it moves along a map that is not in the machine file", "NPSEV", axes=True)
      for n in (602, 603, 604, 605, 606)),
    _c("L", 800, F.PROBE_OFF, device="probe"),
    _c("L", 801, F.PROBE_ON, device="probe"),
    *(_open("L", n, _SCAN, "IK", axes=True, text=True, device="probe") for n in (802, 803, 810)),
    _open("L", 820, "where adjustment has moved the axis is not known"),
    _open("L", 821, "keys and inputs move the axis while the job runs"),
    _c("L", 901, F.DEVICE, "D", needs="D", ranges=(("D", 1, 30),)),
    _c("L", 910, F.DEVICE),
    _c("L", 911, F.DEVICE),
)  # fmt: skip

_M = (
    _c("M", 11, F.OUTPUT_ON, "CD"),
    _c("M", 12, F.OUTPUT_OFF, "CD"),
    _c("M", 13, F.OUTPUT_ON_MOVING, "C", needs="C"),
    _c("M", 14, F.OUTPUT_OFF_MOVING, "C", needs="C"),
    _c("M", 17, F.WAIT_ON, "C", needs="C"),
    _c("M", 18, F.WAIT_OFF, "C", needs="C"),
    *(_c(
        "M", n + k / 10, F.CONDITION, "DC", needs="C") for n in (17, 18) for k in (1, 2, 3, 4)),
    _c("M", 28, F.LIMIT_STOPS_AXIS, companion=True),
    _c("M", 29, F.LIMIT_STOPS_LINE, companion=True),
    _c("M", 37, F.MEASURE_TOOL, "OHT", axes=True),
    _c("M", 37.1, F.MEASURE_SWITCH, axes=True, value=1),
    _c("M", 37.2, F.MEASURE_SWITCH, axes=True, value=2),
    _c("M", 37.3, F.SHIFT_MEASURES, "SHTM", axes=True),
    _c("M", 98, F.CALL, has_text=True, value=1),
    _c("M", 98.1, F.CALL, has_text=True),
    _c("M", 99, F.RETURN),
    _c("M", 99.1, F.ABORT),
)  # fmt: skip

VARIABLES = {
    **{f"TP{n}": f"tool number of changer {n}" for n in (1, 2)},
    **{f"TN{n}": f"tool number of changer {n} plus {10 * n}" for n in (1, 2)},
    **{f"TS{n}": f"tool number of changer {n} plus its sensor offset" for n in (1, 2)},
    **{f"TH{n}": f"tool height of changer {n}" for n in (1, 2)},
    "TM1": "height of the tool measure switch", "TM2": "height of the second tool measure switch",
    "TMX": "X of the tool measure switch", "TMY": "Y of the tool measure switch",
    "TMI": "X of the second tool measure switch", "TMJ": "Y of the second tool measure switch",
    "TMD": "rapid way of tool measuring", "TMF": "feed of tool measuring",
    **{f"LZ{n}": f"local coordinate offset (G92) of axis {n}" for n in range(6)},
    "THM": "torch height control holds a voltage by hand", "THA": "torch height control sets its voltage by itself",
    "THO": "output of the torch", "THI": "input that reports the arc", "THP": "pierce height is on",
    "THC": "cut height is on", "THZ": "pierce height", "THR": "cut height", "THS": "pierce delay", "THE": "end delay",
    "THD": "way of the touch-off switch", "THL": "lift of the torch", "THF": "feed of torch height control",
}  # fmt: skip
"""Names in braces (Command Reference, Internally Defined Variables)."""

REGISTERS = 30
"""H registers that L1 writes, from 0."""

VIRTUAL_INPUTS = 64

WINCNC = LanguageRules(
    name="wincnc",
    codes={(rule.letter, rule.tenths): rule for rule in (*_G, *_L, *_M)},
    parameters=(),
    highest_parameter=0,
    arc_tolerance_mm=0.254,  # arc_err=, 0.01 inch where no file says otherwise
    arc_tolerance_inch=0.01,
    line_length=256,  # Messages and Error Codes: Line Too Long
    m_codes_in_line=2,
    highest_tool=999,
    integer_tolerance=1e-6,
    peck_clearance_mm=1.27,  # G Codes: G73, G83
    call_depth=20,
    workspaces_select_heads=True,
    unit_of_machine=True,
    code_letters=frozenset("GLM"),
    measured_tools=True,  # M37
    straight_traverse=None,  # G0: the manual names the place and the velocity, not the path
    arcs_keep_feed=True,  # Parameters: Feed Velocity
    variables=VARIABLES,
)
