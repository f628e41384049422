"""LanguageRules: what a dialect's manual decides, as data that the executor follows.

A code is a letter and its number in tenths (G38.2 is ("G", 382)). Its ``Function`` is neutral: the executor
knows functions, never dialects. Each rule names the section of the manual that it is from.
"""

from __future__ import annotations

import enum

from gproof.ir.record import field, record

LINE_LETTERS = "XYZWUVABCIJKRFSPHTN"
"""Words that a line without a command may start with, where a line has one command; N may number it."""


def only_a_macro(name: str) -> str:
    """What findings call a code or word that the language does not have, and that a file of macros may define."""
    return f"{name}, which only a macro file can define,"


class Function(enum.IntEnum):
    """Neutral machine functions. Motion that a kernel executes has the numbers 1 to 4."""

    TRAVERSE = 1
    FEED = 2
    ARC_CW = 3
    ARC_CCW = 4
    MOTION_CANCEL = 5
    DRILL = 6
    DRILL_DWELL = 7
    DRILL_PECK = 8
    DRILL_CHIP_BREAK = 9
    BORE = 10
    BORE_STOP = 11
    BORE_DWELL = 12
    PROBE = 13
    DWELL = 20
    SET_COORDINATES = 21
    PLANE_XY = 22
    PLANE_XZ = 23
    PLANE_YZ = 24
    UNITS_INCH = 25
    UNITS_MM = 26
    PARK_1 = 27
    PARK_2 = 28
    COMPENSATION_OFF = 29
    COMPENSATION_LEFT = 30
    COMPENSATION_RIGHT = 31
    TOOL_OFFSET_ON = 32
    TOOL_OFFSET_DYNAMIC = 33
    TOOL_OFFSET_OFF = 34
    MACHINE_COORDINATES = 35
    SELECT_COORDINATES = 36
    EXACT_PATH = 37
    EXACT_STOP = 38
    CONTINUOUS = 39
    ABSOLUTE = 40
    INCREMENTAL = 41
    AXIS_OFFSET_SET = 42
    AXIS_OFFSET_RESET = 43
    AXIS_OFFSET_SUSPEND = 44
    AXIS_OFFSET_RESTORE = 45
    FEED_INVERSE_TIME = 46
    FEED_PER_MINUTE = 47
    FEED_PER_REVOLUTION = 48
    RETRACT_INITIAL = 49
    RETRACT_R = 50
    STOP = 60
    OPTIONAL_STOP = 61
    END = 62
    END_RESET = 63
    STOP_KEEP = 64
    SPINDLE_CW = 65
    SPINDLE_CCW = 66
    SPINDLE_OFF = 67
    TOOL_CHANGE = 68
    MIST_ON = 69
    FLOOD_ON = 70
    COOLANT_OFF = 71
    OVERRIDES_ON = 72
    OVERRIDES_OFF = 73
    OUTPUT_ON = 74
    OUTPUT_OFF = 75
    INPUT_READ = 76
    ROTATION_ON = 80
    ROTATION_OFF = 81
    SCALING_ON = 82
    SCALING_OFF = 83
    HEIGHT_CONTROL = 84
    HEIGHT_SETPOINT = 85
    CLAMP_ON = 86
    CLAMP_OFF = 87
    DRIVES_ON = 88
    DRIVES_OFF = 89
    AXIS_RESOLUTION = 90
    TEMPERATURE = 91
    TEMPERATURE_WAIT = 92
    FAN_ON = 93
    FAN_OFF = 94
    SYNCHRONISED = 100
    SYNCHRONISED_RETURN = 101
    THREADING = 102
    TAP_RIGHT = 103
    TAP_LEFT = 104
    BORE_BACK = 105
    BORE_MANUAL = 106
    SURFACE_SPEED = 107
    SPINDLE_RPM = 108
    FEED_OVERRIDE = 109
    SPEED_OVERRIDE = 110
    FEED_OVERRIDE_INPUT = 111
    FEED_HOLD_INPUT = 112
    DIRECTION_OUTPUT_ON = 113
    DIRECTION_OUTPUT_OFF = 114
    SPEED_OUTPUT_ON = 115
    SPEED_OUTPUT_OFF = 116
    HEAD = 117
    UNSUPPORTED = 99
    TRAVERSE_LIFTED = 120
    SMOOTHING = 121
    UNITS_CM = 122
    UNITS_LAST = 123
    HOME = 124
    STOP_PARSING = 125
    TRANSFORM_OFF = 126
    ROTATION_LINE = 127
    MACHINE_TRAVERSE = 128
    WORKSPACE = 129
    LOCAL_SET = 130
    LOCAL_SHIFT_MACHINE = 131
    LOCAL_SHIFT = 132
    LOCAL_SWITCH = 133
    LOCAL_CROSSING = 134
    FEED_ROTARY = 135
    DIALOG = 136
    STORE_REGISTER = 137
    STORE_HOME = 138
    RETURN_HOME = 139
    DYNAMICS = 140
    ARRAY = 141
    MAP_WORDS = 142
    MAP_HEADS = 143
    MAP_PULSES = 144
    LIMITS_ON = 145
    LIMITS_OFF = 146
    LOW_BOUNDARY = 147
    HIGH_BOUNDARY = 148
    LOW_BOUNDARY_RESTORE = 149
    HIGH_BOUNDARY_RESTORE = 150
    SET_MACHINE = 151
    WRAP_ROTARY = 152
    KNIFE_ON = 153
    KNIFE_OFF = 154
    KNIFE_SETTING = 155
    SAW_ON = 156
    SAW_OFF = 157
    AUTO_OUTPUT_ON = 158
    AUTO_OUTPUT_OFF = 159
    HEIGHT_ON = 160
    HEIGHT_OFF = 161
    TORCH_ON = 162
    TORCH_OFF = 163
    DEVICE = 164
    ANALOG = 165
    LEVEL_HEADS = 166
    VIRTUAL_ON = 167
    VIRTUAL_OFF = 168
    MEASURE_SURFACE = 169
    MEASURE_DEPTH = 170
    ABSOLUTE_ONCE = 171
    INCREMENTAL_ONCE = 172
    KEEP_LOCAL = 173
    TOOL_NUMBER = 174
    CONDITION = 175
    LOCK_AXIS = 176
    UNLOCK_AXIS = 177
    RECALL_POSITIONS = 178
    STORE_POSITION = 179
    STORE_TOOL = 180
    STORE_LOCAL_POSITION = 181
    OUTPUT_ON_MOVING = 182
    OUTPUT_OFF_MOVING = 183
    WAIT_ON = 184
    WAIT_OFF = 185
    LIMIT_STOPS_AXIS = 186
    LIMIT_STOPS_LINE = 187
    MEASURE_TOOL = 188
    MEASURE_SWITCH = 189
    SHIFT_MEASURES = 190
    CALL = 191
    RETURN = 192
    ABORT = 193
    PROBE_ON = 194
    PROBE_OFF = 195
    SHELL = 196
    COMPENSATE = 197
    REFLECT = 198
    REFLECT_OFF = 199
    POSITION_FACTOR = 200
    EFFECTIVE_RADIUS = 201
    ZERO_OFFSET_OFF = 202
    ZERO_OFFSET_SET = 203
    INTERPOLATION_AXES = 204
    LIMIT_LEFT = 205
    LIMIT_RIGHT = 206
    SPLINE_OFF = 207
    SPLINE_ON = 208
    ZERO_OFFSET_READ = 209
    ZERO_OFFSET_RESTORE = 210
    CENTERS_ABSOLUTE = 211
    CENTERS_RELATIVE = 212
    OUTPUT_WORD = 213
    APPLICATION = 214
    SAVE_VARIABLE = 215
    RESTORE_VARIABLE = 216
    JUMP = 217
    MAP_ADJUSTMENT = 228
    LOAD_REGISTERS = 218
    BACKLASH = 219


CHECKED_ONLY = frozenset(
    (
        Function.MIST_ON, Function.FLOOD_ON, Function.COOLANT_OFF, Function.OVERRIDES_ON, Function.OVERRIDES_OFF,
        Function.OUTPUT_ON, Function.OUTPUT_OFF, Function.HEIGHT_SETPOINT, Function.TEMPERATURE,
        Function.TEMPERATURE_WAIT, Function.FAN_ON, Function.FAN_OFF, Function.FEED_HOLD_INPUT,
        Function.DIRECTION_OUTPUT_ON, Function.DIRECTION_OUTPUT_OFF, Function.SPEED_OUTPUT_ON,
        Function.SPEED_OUTPUT_OFF, Function.SMOOTHING, Function.STOP_PARSING, Function.DYNAMICS, Function.DEVICE,
        Function.ANALOG, Function.OUTPUT_ON_MOVING, Function.OUTPUT_OFF_MOVING, Function.SHELL,
        Function.AUTO_OUTPUT_ON, Function.AUTO_OUTPUT_OFF,
    )
)  # fmt: skip
"""Functions of which the words are checked and noted in the Trace, and whose device nothing else depends on."""


@record(frozen=True, slots=True, kw_only=True)
class CodeRule:
    """One code. group: modal group, as the manual names it ("" for codes it lists in none);
    uses_axes: takes the line's axis words; value: argument of the function (coordinate system, head);
    source: section of the manual; open: of a code that is not modelled, what the manual leaves open.
    Where a line has one command: takes: letters of the words it takes besides those of the axes, needs: those it must
    have; companion: it can be next to another command; device: what must be set up for it; has_text: its line has a
    name or another text after it; ranges: (letter, least, most) of words."""

    letter: str
    tenths: int
    function: Function
    group: str
    source: str
    uses_axes: bool = False
    value: int = 0
    open: str = ""
    takes: str = ""
    needs: str = ""
    companion: bool = False
    device: str = ""
    has_text: bool = False
    ranges: tuple[tuple[str, float, float], ...] = ()

    @property
    def text(self) -> str:
        """As written: ``G38.2``, ``M6``."""
        whole, tenth = divmod(self.tenths, 10)
        return f"{self.letter}{whole}.{tenth}" if tenth else f"{self.letter}{whole}"


@record(frozen=True, slots=True, kw_only=True)
class ParameterRange:
    """Numbered variables first..last: meaning, whether a program may write them, section of the manual.

    kind: how the executor finds the live value, a key of the table in ``passes/interpret/core/modal_state.py``;
    ``free``, ``persistent``, ``park_1`` and ``park_2`` are what the program or the setup put there, any other what the
    setup states; ``system``: the controller itself may change it at any time. prefix: programs name it by this and its
    place in the range, from base on.
    """

    first: int
    last: int
    kind: str
    meaning: str
    source: str
    writable: bool = True
    prefix: str = ""
    base: int = 0


@record(frozen=True, slots=True, kw_only=True)
class LanguageRules:
    """Everything the executor must know about a language; see the module's text.

    argument_base: number of the variable that holds the A word of a code which a subprogram replaces, B to Z follow;
    argument_missing: what the variable of a letter holds that the line does not have.
    code_letters: letters of codes; variables: the named ones and what they are. unit_of_machine: the controller's own
    file says in what numbers count where no code does. workspaces_select_heads: a workspace other than the first has a
    head and a spindle of its own; arcs_keep_feed: the F of arcs may be kept apart from that of lines
    (``Settings.arcs_share_feed``). straight_traverse: a traverse of several axes is a straight line, None: the manual
    does not say; measured_tools: what is stored of a tool is no length, but the machine position at which its tip is
    at the work's zero; zeros_end_contours: motion with feed stops where the zero changes. later:
    codes that the manual lacks and other versions of the controller have.
    """

    name: str
    codes: dict[tuple[str, int], CodeRule] = field(repr=False)
    parameters: tuple[ParameterRange, ...] = field(repr=False)
    highest_parameter: int
    arc_tolerance_mm: float
    arc_tolerance_inch: float
    line_length: int
    m_codes_in_line: int
    highest_tool: int
    integer_tolerance: float
    peck_clearance_mm: float
    call_depth: int
    argument_base: int = 1
    argument_missing: float = -1e10
    code_letters: frozenset[str] = frozenset("GM")
    workspaces_select_heads: bool = False
    unit_of_machine: bool = False
    arcs_keep_feed: bool = False
    straight_traverse: bool | None = None
    measured_tools: bool = False
    zeros_end_contours: bool = False
    later: frozenset[tuple[str, int]] = frozenset()
    variables: dict[str, str] = field(default_factory=dict, repr=False)

    def name_of(self, number: int) -> str:
        """What programs call a numbered variable."""
        for entry in self.parameters:
            if entry.prefix and entry.first <= number <= entry.last:
                return f"{entry.prefix}{number - entry.first + entry.base}"
        return f"#{number}"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, LanguageRules) and other.name == self.name

    def __hash__(self) -> int:
        return hash(self.name)


UNARY = (
    "neg", "pos", "abs", "acos", "asin", "atan", "cos", "exp", "fix", "fup", "int", "ln", "round", "sin", "sqrt",
    "tan", "not", "rsin", "rcos", "rtan", "rasin", "racos", "ratan", "sqr", "frac", "bnot", "odd", "bool",
    "trunc", "nearest",
)  # fmt: skip
"""Unary operators; angles in degrees, of those that start with ``r`` (but ``round``) in radians. ``int`` and ``trunc``
drop the fraction (the latter gives a whole number where numbers have types), ``nearest`` rounds, and of a half it is
not known which way; ``sqr`` is the square, ``bnot`` turns the bits of a whole number round, ``bool`` is 1 for all but
0."""

BINARY = (
    "+", "-", "*", "/", "**", "mod", "atan", "and", "or", "xor", ">", ">=", "<", "<=", "==", "<>", "band", "bor",
    "bxor", "<<", ">>", "div", "rem", "shr",
)  # fmt: skip
"""Binary operators; ``div`` and ``rem`` are of whole numbers, towards zero; ``shr`` shifts
as ``>>``, but what moves into a negative number is not known; ``atan`` is the two-argument arc tangent of
left over right, in degrees."""

DEVICES: dict[str, tuple[int, int, str]] = {
    "home": (1, 6, "home axes, one after the other"),
    "home_tandem": (1, 1, "home an axis with two motors and set its bridge straight"),
    "prepare_tandem_home": (1, 1, "move both motors of an axis onto their home sensors"),
    "align_slave": (1, 1, "move a second motor to the place of the first"),
    "home_is_stop": (1, 1, "switch on or off: a home sensor is an emergency stop"),
    "store_position": (1, 2, "write the position to a file; 0: a new file, 1: add to it"),
    "log_file": (1, 2, "open a log; 1: add to it, 0: a new one"),
    "laf_angle": (1, 1, "set the look-ahead feed angle, degrees"),
    "knife_on": (0, 1, "tangential knife on; side to which a bent one is bent, 90 or -90"),
    "knife_off": (0, 0, "tangential knife off"),
    "knife_axis": (1, 1, "axis output of the knife, b or c"),
    "knife_calibrate": (1, 1, "lo or hi: the present height is the knife's lowest or highest"),
    "height_map_init": (3, 3, "start a height map: grid size, points in X, points in Y"),
    "height_map_add": (0, 0, "add the last probed point to the height map"),
    "height_map_save": (1, 1, "write the height map to a file"),
    "height_map_load": (1, 1, "read the height map from a file"),
    "height_map_on": (0, 0, "height compensation on"),
    "height_map_off": (0, 0, "height compensation off"),
    "wait": (1, 1, "wait for so many seconds, in the unit of the controller's wait function"),
    "own_tool_change": (
        1,
        9,
        "the machine's own tool change, whatever its macros do: the tool, outputs that it switches "
        "off; no program has it",
    ),
    "nesting": (2, 2, "preset of the dialog that repeats a job in rows, and its value; nothing moves by it"),
}
"""Commands of ``Device`` nodes: (least, most arguments, meaning)."""
