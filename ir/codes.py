"""Every finding code, in one table. Numbers and names are stable and never reused.

1xx language, 2xx meaning, 3xx limits and areas, 4xx geometry, 5xx motion and time, 6xx machine files and
setup, 7xx translation, 8xx boards and certificates. ``docs/codes/GPnnn/`` explains each with a program
that a test runs. The last column is the property that an error or unknown of this code decides.
"""

from __future__ import annotations

from gproof.ir.finding import Code, Severity

CODES: dict[int, Code] = {}
RETIRED: dict[int, tuple[str, str]] = {
    305: ("offset-box", "for which offsets a job is safe stands behind the verdict, and under conditions of a report"),
    414: ("arc-too-small", "an arc without a radius is GP402, one that a controller cuts as a line GP407"),
    516: ("jump-target", "a jump to nowhere is GP143, one into a block GP144"),
}
"""Numbers and names of codes that are no more, which no other code takes: what tells of the like now."""


def code(number: int, name: str, severity: Severity, template: str, prop: str = "language", hint: str = "") -> Code:
    """Declare a code; a number or name used twice, or of a code that was retired, is an error at import.

    hint: what to do, in findings that have no words of their own for it.
    """
    if number in CODES or any(known.name == name for known in CODES.values()):
        raise ValueError(f"finding code {number} {name} declared twice")
    if number in RETIRED or any(name == old for old, _ in RETIRED.values()):
        raise ValueError(f"finding code {number} {name} was retired")
    CODES[number] = Code(number, name, severity, template, prop, hint)
    return CODES[number]


_E, _U, _W, _N = Severity.ERROR, Severity.UNKNOWN, Severity.WARNING, Severity.NOTE

# 1xx language
SYNTAX = code(101, "syntax", _E, "{what}")
BAD_NUMBER = code(102, "bad-number", _E, "{text!r} is not a number")
UNCLOSED_COMMENT = code(103, "unclosed-comment", _E, "this comment has no closing parenthesis on its line")
NESTED_COMMENT = code(104, "nested-comment", _E, "a comment inside a comment")
BAD_LINE_NUMBER = code(
    105, "bad-line-number", _E, "line number {text!r} is not one to five digits at the start of the line"
)
LINE_TOO_LONG = code(106, "line-too-long", _E, "the line has {length} characters; the controller reads {allowed}")
BAD_EXPRESSION = code(107, "bad-expression", _E, "{what}")
MISSING_VALUE = code(108, "missing-value", _E, "{letter} has no value")
REPEATED_WORD = code(109, "repeated-word", _E, "{letter} is given twice on this line")
MODAL_GROUP_CONFLICT = code(
    110, "modal-group-conflict", _E, "{first} and {second} are of one modal group ({group}) on one line"
)
TOO_MANY_M_CODES = code(111, "too-many-m-codes", _E, "{count} M codes on one line; at most {allowed}")
UNKNOWN_CODE = code(112, "unknown-code", _E, "{code} is not a code of this controller")
UNSUPPORTED_CODE = code(113, "unsupported-code", _U, "{code} is not modelled; what follows it is not known")
UNBALANCED_BLOCK = code(114, "unbalanced-block", _E, "{what}")
UNKNOWN_SUBPROGRAM = code(115, "unknown-subprogram", _E, "there is no subprogram {name!r}")
DUPLICATE_SUBPROGRAM = code(116, "duplicate-subprogram", _E, "subprogram {name!r} is defined twice")
RECURSION = code(117, "recursion", _E, "calls are nested deeper than {allowed}: {chain}")
NO_PROGRAM_END = code(118, "no-program-end", _W, "the program has no M2 or M30")
NOT_TEXT = code(119, "not-text", _E, "the file is not text: byte {byte} at offset {offset}")
EMPTY_PROGRAM = code(120, "empty-program", _E, "the program has no code")
UNUSED_WORD = code(121, "unused-word", _E, "{word} is not used by any code on this line")
FLOW_WORD_MISPLACED = code(122, "flow-word-misplaced", _E, "{what}")
TEXT_AFTER_END = code(123, "text-after-end", _W, "code after {code} is never executed")
UNDECODABLE_NAME = code(124, "undecodable-name", _U, "{what}")
NESTING_PRESET = code(
    125, "nesting-preset", _N, "a value of the nesting dialog: what is judged is one part, at its programmed place"
)
UNREACHED_MISTAKE = code(126, "unreached-mistake", _W, "{message} ({label}), {where}, which this job never runs")
MULTIPLE_COMMANDS = code(
    127, "multiple-commands", _E, "{first} and {second} are two commands: a line of this controller has one"
)
PARAMETER_RANGE = code(128, "parameter-range", _E, "{code}: {word} is out of range; {allowed}")
ILLEGAL_VALUE = code(129, "illegal-value", _E, "{word}: {what}")
FILE_NOT_FOUND = code(130, "file-not-found", _E, "there is no file {name!r}{where}")
ARRAY_IN_SUBPROGRAM = code(131, "array-in-subprogram", _E, "{code} cuts an array, which a subprogram must not do")
ARRAY_PARAMETERS = code(132, "array-parameters", _E, "{code}: {what}")
MACRO_TOO_LONG = code(
    133,
    "macro-too-long",
    _E,
    "the line has {length} characters when {name} is replaced; the controller takes {allowed}",
)
TEXT_BEHIND_COMMENT = code(
    134,
    "text-behind-comment",
    _U,
    "{text!r} behind a closed comment: whether the controller reads it is not documented",
)
TYPE_MISMATCH = code(135, "type-mismatch", _E, "{what}")
UNDECLARED_NAME = code(136, "undeclared-name", _E, "{what}")
DECLARATION = code(137, "declaration", _E, "{what}")
SYSTEM_VARIABLE = code(
    138, "system-variable", _W, "{name} is outside of {prefix}600 to {prefix}699: it may be one of the system's own"
)
PASCAL_OPEN = code(139, "pascal-open", _U, "{what}: the manual leaves open what the controller makes of it")
BRACKET_PARAMETER = code(
    140,
    "bracket-parameter",
    _E,
    "a bracket behind {code} holds a parameter, and this is no expression (compiler error 2074)",
)
NO_MODULE_END = code(141, "no-module-end", _E, "{what} has none of M02, M30 and M17 (compiler error 190)")
DUPLICATE_LABEL = code(142, "duplicate-label", _E, "label {name!r} stands twice")
UNKNOWN_LABEL = code(143, "unknown-label", _E, "there is no label {name!r}")
JUMP_INTO_BLOCK = code(144, "jump-into-block", _U, "{what}: the manual does not say what it does")
INCLUDE_CYCLE = code(145, "include-cycle", _E, "{name!r} {what}: {chain}")
PROGRAM_SIZE = code(
    146,
    "program-size",
    _W,
    "the compiled program may have {low} to {high} bytes by estimate; the controller takes {allowed} (error 21)",
)
PROGRAM_TOO_LARGE = code(
    147,
    "program-too-large",
    _E,
    "the compiled program has {low} bytes at the least, by estimate; the controller takes {allowed} (error 21)",
)
LINE_NUMBER_MISSING = code(148, "line-number-missing", _E, "this machine asks for a line number, and the line has none")
LOOP_VARIABLE = code(
    149, "loop-variable", _W, "{name} is read behind its for loop, where it holds its last value, or one beyond it"
)

MIRRORED_JOB = code(
    169, "mirrored-job", _W,
    "{code} mirrors {axes} here, from the first move to the end of the job; elsewhere it is a unit or a zone",
)  # fmt: skip

# 15x: what makes no sense, told where the property sense is asked for (docs/cutting-sense.md)
UNITS_NEVER_SET = code(
    150,
    "units-never-set",
    _N,
    "the first move comes before any code of units: numbers count in the controller's own",
    "sense",
)
UNIT_MIX_UP = code(151, "unit-mix-up", _W, "numbers of this job look like {other}, and count as {unit}: {why}", "sense")
FOREIGN_DIALECT = code(
    152,
    "foreign-dialect",
    _W,
    "this job looks like one for {controller}: {what}; {lines} such lines are refused",
    "sense",
)
DEAD_CODE = code(153, "dead-code", _W, "nothing leads to this line: {what}", "sense")
UNUSED_LABEL = code(154, "unused-label", _N, "nothing goes to label {name!r}", "sense")
UNCALLED_SUBPROGRAM = code(155, "uncalled-subprogram", _N, "nothing calls subprogram {name!r}", "sense")
READ_BEFORE_SET = code(
    156, "read-before-set", _W, "{name} is read here, and on some way to this line nothing sets it", "sense"
)
NEVER_READ = code(157, "never-read", _N, "{name} is set, and nothing of this job reads it", "sense")
CONSTANT_CONDITION = code(158, "constant-condition", _N, "this condition is always {value}", "sense")
DISTANCES_NEVER_SET = code(
    159,
    "distances-never-set",
    _N,
    "the first move comes before any code of absolute or incremental distances",
    "sense",
)

# 2xx meaning
COMMAND_IGNORED = code(200, "command-ignored", _W, "{what}: the controller ignores it")
AXIS_WORDS_MISSING = code(201, "axis-words-missing", _E, "{code} without axis words")
AXIS_WORDS_UNUSED = code(202, "axis-words-unused", _E, "axis words, but no motion is active ({why})")
ARC_CENTER_MISSING = code(203, "arc-center-missing", _E, "{code} needs {needed}", "arcs")
FEED_MISSING = code(204, "feed-missing", _E, "{code} without a feed rate (F)")
INVERSE_TIME_FEED_MISSING = code(
    205, "inverse-time-feed-missing", _E, "in inverse time mode (G93) every feed move needs its own F"
)
DWELL_NEGATIVE = code(206, "dwell-negative", _E, "dwell of {seconds:g} s is negative")
DWELL_MISSING = code(207, "dwell-missing", _E, "{code} needs its time in P")
COORDINATE_SYSTEM_RANGE = code(208, "coordinate-system-range", _E, "G10 P{value:g}: coordinate systems are 1 to 9")
G10_KEY = code(209, "g10-key", _E, "G10 needs L2 or L20{given}")
G53_NEEDS_G0_G1 = code(210, "g53-needs-g0-g1", _E, "G53 with {mode} active; it needs G0 or G1")
G53_WITH_COMPENSATION = code(211, "g53-with-compensation", _E, "G53 while cutter radius compensation is on")
G92_AXIS_MISSING = code(212, "g92-axis-missing", _E, "G92 without axis words")
SPINDLE_SPEED_NEGATIVE = code(213, "spindle-speed-negative", _E, "spindle speed S{value:g} is negative")
TOOL_NUMBER = code(214, "tool-number", _E, "T{value:g}: tool numbers are whole, 0 to {highest}")
CYCLE_AXIS_MISSING = code(215, "cycle-axis-missing", _E, "{code}: X, Y and Z words are all missing")
CYCLE_DEPTH_MISSING = code(
    216, "cycle-depth-missing", _E, "{code}: the {letter} word is missing and the cycle was not active before"
)
CYCLE_R_BELOW_DEPTH = code(
    217, "cycle-r-below-depth", _E, "{code}: R {r:.4f} lies below the depth {letter} {depth:.4f}"
)
CYCLE_DWELL_NEGATIVE = code(218, "cycle-dwell-negative", _E, "{code}: dwell P{value:g} is negative")
CYCLE_REPEATS = code(219, "cycle-repeats", _E, "{code}: repeat count L{value:g} is not a positive whole number")
CYCLE_ROTARY_MOTION = code(220, "cycle-rotary-motion", _E, "{code} would move the rotary axis {axis}")
CYCLE_INVERSE_TIME = code(221, "cycle-inverse-time", _E, "{code} in inverse time mode (G93)")
CYCLE_PECK = code(222, "cycle-peck", _E, "{code} needs a positive Q{given}")
CYCLE_R_MISSING = code(223, "cycle-r-missing", _E, "{code}: the R word is missing and no cycle was active before")
TWO_AXIS_COMMANDS = code(224, "two-axis-commands", _E, "{first} and {second} both use the axis words of this line")
UNKNOWN_VALUE = code(225, "unknown-value", _U, "{word} depends on {cause}, {why}", "limits")
PARAMETER_NUMBER = code(226, "parameter-number", _E, "parameter #{value:g} does not exist; {allowed}")
READ_ONLY_PARAMETER = code(227, "read-only-parameter", _E, "parameter #{number} ({meaning}) can not be written")
ARITHMETIC = code(228, "arithmetic", _E, "{what}")
NOT_AN_INTEGER = code(229, "not-an-integer", _E, "{word} must be a whole number; {value!r} is not")
PRECEDENCE = code(230, "precedence", _W, "the value depends on an undocumented precedence of {operators}; add brackets")
INEXACT_COMPARISON = code(231, "inexact-comparison", _W, "{left!r} {operator} {right!r} compares computed numbers")
UNKNOWN_CONDITION = code(232, "unknown-condition", _U, "the condition depends on {cause}, which nobody stated")
STEP_BUDGET = code(233, "step-budget", _U, "the program did not end within {budget} executed blocks")
UNSET_PARAMETER = code(234, "unset-parameter", _W, "{name} is read before anything sets it")
STARTUP_COORDINATE_SYSTEM = code(
    235, "startup-coordinate-system", _E, "parameter 5220 is {value!r}; coordinate systems are 1 to 9"
)
TOOL_OFFSET_NUMBER = code(236, "tool-offset-number", _E, "H{value:g}: the tool table has 1 to {highest}")
TOOL_OFFSET_UNKNOWN = code(
    237,
    "tool-offset-unknown",
    _U,
    "the tool in the spindle is not known, so G43 can not know its length",
    "limits",
)
CYCLE_WITH_COMPENSATION = code(238, "cycle-with-compensation", _E, "{code} while cutter radius compensation is on")
SPINDLE_UNKNOWN = code(
    239, "spindle-unknown", _U, "{code}: feed per revolution, but the spindle speed is not known", "feeds"
)
FEED_IN_OLD_UNITS = code(
    240, "feed-in-old-units", _W, "F{value:g} is taken before {code} on this line, so in {units} a minute"
)
NEGATIVE_FEED = code(241, "negative-feed", _E, "feed rate F{value:g} is negative")
CYCLE_DWELL_MISSING = code(242, "cycle-dwell-missing", _E, "{code} needs a dwell time in P")
CYCLE_SPINDLE_STOPPED = code(244, "cycle-spindle-stopped", _E, "{code} needs a turning spindle")
WORD_MISSING = code(275, "word-missing", _E, "{code} needs {needed}")
TRANSFORM_OPEN = code(276, "transform-open", _U, "the manual leaves open: {what}", "limits")
ARC_UNEQUAL_SCALING = code(
    277, "arc-unequal-scaling", _E, "an arc while X is scaled by {x:g} and Y by {y:g} (G51 X Y)", "arcs"
)
SCALING_ZERO = code(278, "scaling-zero", _E, "{code} with a factor of 0 puts every point into one")
AXIS_CLAMPED = code(279, "axis-clamped", _E, "{axis} would move while it is clamped (M26)")
HEIGHT_CONTROL = code(
    280,
    "height-control",
    _U,
    "{code}: torch height control may be on from here, and the height Z is then its own",
    "limits",
)
DRIVES_WERE_OFF = code(
    281, "drives-were-off", _U, "the drives were off (M81): where the axes stand is not known any more", "limits"
)
AXIS_RESIZED = code(
    282, "axis-resized", _U, "{code} makes an axis move {factor:g} times as far: where it is is not known", "limits"
)
SYNCHRONISED_PITCH = code(
    284, "synchronised-pitch", _U, "{code} under G51: whether its pitch K is scaled with the way is not documented"
)
OUTPUT_VALUE = code(283, "output-value", _E, "{code}: {what}")
ERROR_MESSAGE = code(245, "error-message", _W, "the program ends itself here with the error {text!r}")
NOT_ENABLED = code(285, "not-enabled", _E, "{code} needs {device}, and the machine file has no {key}")
STORED_POSITION_MISSING = code(286, "stored-position-missing", _E, "{word}: no position is stored under this number")
STORED_POSITION_COMMAND = code(287, "stored-position-command", _E, "{code}: {what}")
ABORTED_BY_PROGRAM = code(288, "aborted-by-program", _W, "the program aborts itself here ({code})")
NEXT_LINE_OPEN = code(
    289, "next-line-open", _U, "{code} decides about the next line, and {what}: which line is meant is not documented"
)
OVERRIDE_WITH_CODES = code(
    290, "override-with-codes", _E, "{code} calls the subprogram {name!r}: {other} can not stand on its line"
)
PROBE_TOO_NEAR = code(
    291, "probe-too-near", _E, "the probe move is {distance:.4f} mm long; it must have at least {least:g} mm"
)
PROBE_INVERSE_TIME = code(292, "probe-inverse-time", _E, "probing (G38.2) in inverse time mode (G93)")
PROBE_ROTARY = code(293, "probe-rotary", _E, "the probe move would turn the rotary axis {axis}")
PROBE_AXIS_MISSING = code(294, "probe-axis-missing", _E, "{code} without an X, Y or Z word")
HOMING = code(295, "homing", _N, "{axes} homes here: the way to the sensor is not judged")
AXIS_NOT_THERE = code(296, "axis-not-there", _E, "the machine has no axis {axis}")
INPUT_CHANNEL = code(297, "input-channel", _E, "{what}")
OFFSET_IN_USE = code(
    298, "offset-in-use", _W, "{what} is written while it is in use: whether it acts at once is not stated", "limits"
)
OFFSETS_WITH_COMPENSATION = code(
    246, "offsets-with-compensation", _E, "{code} while cutter radius compensation is on: the origin may not change"
)
UNITS_WITH_COMPENSATION = code(
    247, "units-with-compensation", _E, "{code} while cutter radius compensation is on: the units may not change"
)
PROBE_WITH_COMPENSATION = code(248, "probe-with-compensation", _E, "{code} while cutter radius compensation is on")
COMPENSATION_PLANE = code(
    249, "compensation-plane", _E, "{code} in the {plane} plane; it works in XY, and in XZ for turning"
)
COMPENSATION_ALREADY_ON = code(
    250, "compensation-already-on", _E, "{code} while cutter radius compensation is on already"
)
PARK_WITH_COMPENSATION = code(251, "park-with-compensation", _E, "{code} while cutter radius compensation is on")
PLANE_WITH_COMPENSATION = code(
    252, "plane-with-compensation", _E, "{code} while cutter radius compensation is on in the {plane} plane"
)
COMPENSATION_TOOL_NEGATIVE = code(253, "compensation-tool-negative", _E, "D{value}: a tool number is not negative")
COMPENSATION_TOOL_RANGE = code(
    254, "compensation-tool-range", _E, "D{value}: the tool table has 1 to {highest}, and 0 means no radius"
)
COMPENSATION_RADIUS_UNKNOWN = code(
    255, "compensation-radius-unknown", _U, "the radius to compensate depends on {cause}, which nobody stated", "limits"
)
COMPENSATION_UNKNOWN = code(256, "compensation-unknown", _U, "the compensated path depends on {cause}", "limits")
COMPENSATION_LATHE_UNKNOWN = code(
    257, "compensation-lathe-unknown", _U, "compensation for turning depends on {cause}, which nobody stated", "limits"
)
COMPENSATION_WITHOUT_TOOL = code(
    258, "compensation-without-tool", _W, "cutter radius compensation without a tool in the spindle: the radius is 0"
)
CYCLE_WORD_IGNORED = code(259, "cycle-word-ignored", _W, "{word} is no word of {code}: it is taken to have no effect")
LOCAL_RESTORED_OVER = code(
    260,
    "local-restored-over",
    _W,
    "{code} brings back what it had put away, over local coordinates set since",
    "limits",
)
ONLY_SUBPROGRAMS = code(340, "only-subprograms", _W, "the file holds only subprograms: nothing of it was executed")
DOUBTFUL_ARITHMETIC = code(
    299, "doubtful-arithmetic", _U, "{operator} has no value for some of what {cause} can be: the program may stop here"
)
OPERATOR_STOP = code(243, "operator-stop", _N, "the job waits here for the operator ({code})")

# 26x, 27x: the spindle and what follows its turns
THREAD_PLANE = code(261, "thread-plane", _E, "{code} needs the ZX plane (G18)")
THREAD_WORD = code(262, "thread-word", _E, "{code}: {what}")
THREAD_PEAK_OPEN = code(
    263,
    "thread-peak-open",
    _U,
    "I{value:g} puts the thread's peak at X{position:g} when I is a diameter, at X{offset:g} when it is an offset "
    "from the drive line",
    "limits",
)
TAP_DIRECTION = code(264, "tap-direction", _E, "{code} needs the spindle to turn {needed}; it turns {turns}")
ORIENTED_STOP = code(265, "oriented-stop", _W, "{code} needs a spindle that can stop in a fixed orientation")
SPINDLE_STATE_UNKNOWN = code(
    266, "spindle-state-unknown", _U, "{code} needs a turning spindle, and nobody stated whether it turns"
)
BACK_BORE_TOP = code(
    267, "back-bore-top", _E, "{code}: the counter bore ends at {letter} {top:.4f}, outside {depth:.4f} to {r:.4f}"
)
SURFACE_SPEED_UNBOUNDED = code(
    268, "surface-speed-unbounded", _W, "{code} without D: towards the centre the spindle speed has no limit"
)
SURFACE_SPEED_LIMIT = code(269, "surface-speed-limit", _E, "D{value:g}: the highest spindle speed must be positive")
OVERRIDE_FACTOR = code(270, "override-factor", _U, "{code}: {what}", "feeds")
SPINDLE_RANGE = code(271, "spindle-range", _W, "S{value:g} is outside what the spindle can do, {low} to {high}")
HEAD_MOVE = code(272, "head-move", _U, "{code} {what}", "limits")
HEAD_OFFSET_OPEN = code(
    273,
    "head-offset-open",
    _W,
    "the {axis} offset of {code}, {value:g} mm, is given without its sign: it counts as not stated",
    "limits",
)
HEAD_WHILE_TURNING = code(
    274, "head-while-turning", _W, "{code} while a spindle turns: whether it goes on is not documented"
)

# 3xx limits and areas
SOFT_LIMIT = code(
    301,
    "soft-limit",
    _E,
    "{axis} would reach {reached:.4f} {unit}, {over:.4f} past its {side} limit {limit:.4f}",
    "limits",
)
LIMIT_UNKNOWN = code(302, "limit-unknown", _U, "no {side} limit of {axis} is known", "limits")
NO_SAFE_OFFSET = code(
    303,
    "no-safe-offset",
    _E,
    "{what} {extent:.4f} {unit} and {other} {room:.4f}",
    "limits",
)
POSITION_UNKNOWN = code(304, "position-unknown", _U, "the position of {axis} depends on {cause}", "limits")
START_OUTSIDE_LIMITS = code(
    306, "start-outside-limits", _E, "the stated start {axis} {value:.4f} {unit} lies outside its limits", "limits"
)
SOFT_LIMIT_GUARD_OFF = code(
    307,
    "soft-limit-guard-off",
    _W,
    "{axis} goes to {reached:.4f} {unit}, past its {side} limit {limit:.4f}, with the guard off",
    "limits",
)
TOOL_CHANGE_AREA = code(310, "tool-change-area", _E, "the path enters the tool change area at {where}", "areas")
KEEP_OUT_ZONE = code(
    336,
    "keep-out-zone",
    _E,
    "the path enters the keep-out zone {name} at {where}, and goes {depth:.4f} mm into it",
    "areas",
)
KEEP_OUT_UNKNOWN = code(
    337, "keep-out-unknown", _U, "whether the path enters the keep-out zone {name} depends on {cause}", "areas"
)
TOOL_CHANGE_AREA_UNKNOWN = code(
    311,
    "tool-change-area-unknown",
    _U,
    "whether the path enters the tool change area depends on {cause}",
    "areas",
)
TOOL_CHANGE_AREA_GUARD_OFF = code(
    312, "tool-change-area-guard-off", _N, "the path enters the tool change area with its guard off", "areas"
)
GUARD_OFF_STRETCH = code(
    338, "guard-off-stretch", _N, "{guards}: off from here to line {last}, for {moves}{where}", "limits"
)
TOOL_CHANGE_TOO_LOW = code(
    339,
    "tool-change-too-low",
    _E,
    "{what} at Z {z:.4f} mm, {under:.4f} mm under the clearance height {clear:.4f}",
    "areas",
)
TOOL_CHANGE_HEIGHT_UNKNOWN = code(
    341,
    "tool-change-height-unknown",
    _U,
    "{what} at a height that depends on {cause}; Z must be at {clear:.4f} mm at least",
    "areas",
)
MOTOR_LIMIT = code(
    320,
    "motor-limit",
    _U,
    "{axis} at {reached:.4f} {unit} is inside its {side} limit {limit:.4f}, but {what} may carry its motor past it",
    "limits",
)
MAPPED_AXIS = code(321, "mapped-axis", _U, "Y is mapped onto A, and {what}", "limits")
HEIGHT_MAP_UNKNOWN = code(322, "height-map-unknown", _U, "height compensation: {what}", "limits")
KNIFE_UNKNOWN = code(323, "knife-unknown", _U, "tangential knife: {what}", "limits")
BOUNDARY_EXCEEDED = code(
    330,
    "boundary-exceeded",
    _E,
    "{axis} would reach {reached:.4f} {unit} in its workspace, {over:.4f} past its {side} boundary {limit:.4f}",
    "limits",
)
FORCED_LIMIT_EXCEEDED = code(
    331,
    "forced-limit-exceeded",
    _E,
    "{axis} would reach {reached:.4f} {unit}, {over:.4f} past the forced {side} limit {limit:.4f}",
    "limits",
)
BOUNDARY_GUARD_OFF = code(
    332,
    "boundary-guard-off",
    _W,
    "{axis} goes to {reached:.4f} {unit} in its workspace, past its {side} boundary {limit:.4f}, {why}",
    "limits",
)
LIMIT_ADJUSTED = code(
    333,
    "limit-adjusted",
    _W,
    "the controller lets {axis} go to its {side} {kind} {limit:.4f} {unit} only, not to {wanted:.4f} as programmed",
    "limits",
)
OFFSET_KEPT = code(
    335, "offset-kept", _W, "{code} gives {axes} another machine zero, and {what} in force there: it is kept", "limits"
)

# 4xx geometry
ARC_RADIUS_MISMATCH = code(
    401,
    "arc-radius-mismatch",
    _E,
    "radius {start:.6f} at the start, {end:.6f} at the end: {off:.6f} {unit} apart, {allowed:g} allowed",
    "arcs",
)
ARC_RADIUS_ZERO = code(402, "arc-radius-zero", _E, "the arc has no radius", "arcs")
ARC_UNREACHABLE = code(
    403,
    "arc-unreachable",
    _E,
    "the end is {chord:.6f} {unit} away; an arc of radius {radius:.6f} can not reach it",
    "arcs",
)
ARC_SAME_POINT = code(
    404, "arc-same-point", _E, "an arc given by its radius must end somewhere else than it starts", "arcs"
)
ARC_UNKNOWN = code(405, "arc-unknown", _U, "the arc depends on {cause}", "arcs")
ARC_ILL_CONDITIONED = code(
    406,
    "arc-ill-conditioned",
    _W,
    "a radius arc of {degrees:.2f} degrees: rounding to {digits} decimals moves its centre by up to {off:.4f} {unit}, "
    "{factor:.0f} times as much",
    "arcs",
)
ARC_UNDER_MINIMUM = code(
    407,
    "arc-under-minimum",
    _N,
    "radius {radius:.6f} {unit} is under the smallest one for an arc, {allowed:g}: the controller cuts a straight line",
    "arcs",
)
ARC_CLOSES = code(
    408,
    "arc-nearly-closes",
    _W,
    "the arc ends {chord:.6f} {unit} from where it begins, after {degrees:.4f} degrees; rounded otherwise it would be "
    "{other:.4f}",
    "arcs",
)
ARC_HUGE = code(
    409,
    "arc-huge-radius",
    _W,
    "a radius of {radius:.0f} {unit}: over {chord:.4f} {unit} that is a line, within {off:.2g} {unit}",
    "arcs",
)
CONCAVE_CORNER = code(
    410,
    "concave-corner",
    _E,
    "a corner of {degrees:.2f} degrees towards a tool of radius {radius:.4f} mm, which does not fit into it",
)
CUTTER_GOUGING = code(
    411,
    "cutter-gouging",
    _E,
    "compensation begins {distance:.4f} mm from the programmed point, within the tool's radius of {radius:.4f} mm",
)
ARC_TOO_SMALL_FOR_TOOL = code(
    412,
    "arc-too-small-for-tool",
    _E,
    "a tool of radius {radius:.4f} mm does not fit into an arc of radius {arc:.4f} mm",
)
ENTRY_ARC = code(
    413,
    "entry-arc",
    _E,
    "compensation can not begin with this arc: the tool is at {distance:.4f} mm, and the arc asks for {needed:.4f} mm",
)
MACHINE_ZERO_MOVED = code(
    334,
    "machine-zero-moved",
    _U,
    "{code} of an axis that has followed another one: where machine zero and the limits are then is not known",
    "limits",
)
ARC_SCALED = code(415, "arc-scaled", _E, "an arc while {axes} is scaled ({code})", "arcs")
HELIX_NOT_SUPPORTED = code(
    416, "helix-not-supported", _E, "{axes} would move during an arc, which this machine does not do", "arcs"
)
ARC_MAPPED = code(417, "arc-mapped", _E, "an arc while the words of the axes are re-mapped ({code})", "arcs")

ARC_LEANING_KNIFE = code(
    419, "arc-with-leaning-knife", _E, "an arc with a blade that leans, which cuts only lines", "arcs"
)

ARC_FULL_CIRCLE = code(
    418,
    "arc-full-circle",
    _W,
    "X and Y end the arc where it begins: taken for a full circle; without X and Y it surely is one",
    "arcs",
)

OPEN_MESH = code(432, "open-mesh", _W, "{name} is not closed ({what}): what is inside of it is not known", "files")
TRAVERSE_IN_STOCK = code(
    435, "traverse-in-stock", _E, "a traverse enters stock that is still there, {depth:.4f} mm deep", "collisions"
)
TRAVERSE_NEAR_STOCK = code(
    436,
    "traverse-near-stock",
    _U,
    "a traverse may enter stock that is still there, by up to {depth:.4f} mm with the clearance that is asked for",
    "collisions",
)
DEEPER_THAN_FLUTES = code(
    437, "deeper-than-flutes", _E, "tool {tool} cuts {over:.4f} mm deeper than {limit}", "collisions"
)
DEEPER_THAN_ALLOWED = code(
    438, "deeper-than-allowed", _E, "tool {tool} cuts {over:.4f} mm deeper than {limit}", "collisions"
)
DEPTH_OPEN = code(439, "depth-open", _U, "tool {tool} may cut up to {over:.4f} mm deeper than {limit}", "collisions")
HOLDER_IN_STOCK = code(
    441,
    "holder-in-stock",
    _E,
    "{part} of tool {tool} enters stock that is still there, by {depth:.4f} mm",
    "collisions",
)
HOLDER_NEAR_STOCK = code(
    442,
    "holder-near-stock",
    _U,
    "{part} of tool {tool} may enter stock that is still there, by up to {depth:.4f} mm",
    "collisions",
)
STOCK_UNKNOWN = code(
    443, "stock-unknown", _U, "what is left of the stock is not known from here on: {cause}", "collisions"
)
GOUGE = code(420, "gouge", _E, "{what}, at X{x:.4f} Y{y:.4f} Z{z:.4f}", "gouges")
COLLISION = code(421, "collision", _E, "{what}, at X{x:.4f} Y{y:.4f} Z{z:.4f}", "collisions")
HOLDER_IN_PART = code(422, "shank-or-holder-in-part", _E, "{what}, at X{x:.4f} Y{y:.4f} Z{z:.4f}", "collisions")
GOUGE_POSSIBLE = code(
    423,
    "gouge-possible",
    _U,
    "{what}, at X{x:.4f} Y{y:.4f} Z{z:.4f}: {doubt}",
    "gouges",
)
COLLISION_POSSIBLE = code(
    424,
    "collision-possible",
    _U,
    "{what}, at X{x:.4f} Y{y:.4f} Z{z:.4f}: {doubt}",
    "collisions",
)
GOUGE_UNKNOWN = code(425, "gouge-unknown", _U, "{cause}", "gouges")
COLLISION_UNKNOWN = code(426, "collision-unknown", _U, "{cause}", "collisions")


# 5xx motion and time
FEED_OVER_MAXIMUM = code(
    501, "feed-over-maximum", _W, "feed {feed:g} {unit}/min is more than the axes allow here", "feeds"
)
STEP_FREQUENCY = code(
    502,
    "step-frequency",
    _W,
    "{axis} at {velocity:g} {unit}/s needs {needed:g} steps/s; {allowed:g} allowed",
    "motion",
)
PLAN_NEEDS_NUMBERS = code(503, "plan-needs-numbers", _U, "steps need exact numbers: {cause}", "motion")
NO_MOTOR_DATA = code(504, "no-motor-data", _U, "{axis} moves, but the machine file has no {missing} for it", "motion")
DRILL_SETTING_OPEN = code(512, "drill-setting-open", _W, "{code}: {what}", "motion")
VELOCITY_ZERO = code(505, "velocity-zero", _E, "{code} with a velocity of 0: the controller stops the program", "feeds")
SYNCHRONISED_TOO_FAST = code(
    510,
    "synchronised-too-fast",
    _E,
    "{code}: {pitch:g} mm a revolution at {rpm:g} rpm asks {axis} for {needed:g}/min, {over:g} more than its "
    "{allowed:g}/min",
)
SYNCHRONISED_STREAM = code(
    511, "synchronised-stream", _U, "{what}, which a step stream, fixed in time, can not do", "motion"
)
NOT_STEPPED = code(520, "not-stepped", _U, "{what}, and gproof makes no steps for that", "motion")
HEIGHT_JUMP = code(
    521, "height-jump", _U, "Z would have to jump by {jump:.4f} mm where the height map ends or is switched", "motion"
)

ENDLESS_LOOP = code(506, "endless-loop", _W, "the program comes by here in the same state again: it never ends")
ALIKE_PASSES = code(
    522,
    "alike-passes",
    _N,
    "from pass {done} on one pass of this loop is as the other: as there are too many to follow, it may end behind any",
)
CONTOUR_BREAK = code(513, "contour-break", _N, "{code} ends the contour: the axes stop before it", "motion")
TASK_UNKNOWN = code(
    514,
    "task-unknown",
    _U,
    "{code}: nobody stated what the application does for it (Task 0), so where the axes are behind it is not known",
    "limits",
)
MODULE_END = code(515, "module-end", _U, "{name} ends without M02, M30 or M17: what runs behind it is not documented")
MAINTAINED_OFFSET = code(
    517, "maintained-offset", _W, "axis words alone go on with {code}: they set the zero offset and move nothing"
)
FEED_UNKNOWN = code(518, "feed-unknown", _U, "{code}: the feed depends on {cause}", "feeds")
NO_WAY = code(
    519, "no-way", _W, "{code} leads nowhere: the controller reports a move without a way (status 80, 20 hex)"
)

# 53x, 54x: told where the properties cutting and feeds are asked for (docs/cutting-sense.md)
SPINDLE_AT_REST = code(530, "spindle-at-rest", _E, "feed moves while the spindle stands still: {moves}", "cutting")
SPINDLE_NOT_TOLD = code(
    531, "spindle-not-told", _U, "nothing tells whether a spindle turns; feed moves: {moves}", "cutting"
)
SPINDLE_SPEED_NOT_TOLD = code(
    532, "spindle-speed-not-told", _U, "nobody stated how fast the spindle turns; feed moves: {moves}", "cutting"
)
NO_TOOL = code(533, "no-tool", _E, "feed moves without a tool in the spindle: {moves}", "cutting")
TOOL_TOO_FAST = code(
    534, "tool-too-fast", _E, "tool {tool} turns at {rpm:g} rpm, {over:g} more than its {allowed:g}", "cutting"
)
TOOL_TOO_SLOW = code(
    535, "tool-too-slow", _W, "tool {tool} turns at {rpm:g} rpm, and should at {allowed:g} at the least", "cutting"
)
CUT_BEFORE_SPEED = code(
    536,
    "cut-before-speed",
    _W,
    "a feed move {seconds:.2f} s behind the start of the spindle at the earliest, which needs {needed:g} s",
    "cutting",
)
TURNS_BACKWARDS = code(
    537, "turns-backwards", _N, "feed moves with the spindle turning counter-clockwise: {moves}", "cutting"
)
DRY_TOOL = code(538, "dry-tool", _N, "tool {tool} cuts without coolant, which other tools of this job have", "cutting")
NOT_RETRACTED = code(
    539,
    "not-retracted",
    _W,
    "the job ends with Z at {reached:.4f} mm, {below:.4f} below where it traverses",
    "cutting",
)
SPINDLE_LEFT_ON = code(540, "spindle-left-on", _W, "the job ends while the spindle turns", "cutting")
END_MISSING = code(541, "end-missing", _N, "the job ends without a code that says so ({known})", "cutting")
TOOL_NOT_TOLD = code(
    542,
    "tool-not-told",
    _U,
    "tools have speeds of their own, and nobody stated which one is in the spindle; feed moves: {moves}",
    "cutting",
)
FEED_OVER_TOOL = code(
    545, "feed-over-tool", _E, "feed {feed:g} mm/min is {over:g} more than tool {tool} stands ({allowed:g})", "feeds"
)
PLUNGE_OVER_TOOL = code(
    546,
    "plunge-over-tool",
    _E,
    "tool {tool} goes down at {feed:g} mm/min, {over:g} more than it stands ({allowed:g})",
    "feeds",
)
PLUNGE_NOT_KNOWN = code(
    549,
    "plunge-not-known",
    _U,
    "how steep it goes down is not known, and the feed is over the tool's plunge; feed moves: {moves}",
    "feeds",
)
FEED_NOT_TOLD = code(547, "feed-not-told", _U, "nobody stated the feed; feed moves: {moves}", "feeds")
FEED_TOOL_NOT_TOLD = code(
    548,
    "feed-tool-not-told",
    _U,
    "tools have feeds of their own, and nobody stated which one is in the spindle; feed moves: {moves}",
    "feeds",
)

# 6xx files
FILE_UNREADABLE = code(601, "file-unreadable", _E, "{what}", "files")
UNKNOWN_KEY = code(602, "unknown-key", _W, "key {key!r} is not known and was ignored", "files")
BAD_VALUE = code(603, "bad-value", _E, "{key}: {what}", "files")
MISSING_KEY = code(604, "missing-key", _E, "{key} is missing", "files")
NOT_MODELLED_SETTING = code(605, "not-modelled-setting", _U, "{key} is set, and gproof does not model it", "limits")
ACCELERATION_BOUNDS = code(
    606,
    "acceleration-bounds",
    _W,
    "{axis}: acceleration times resolution is {steps:.0f} a second squared; the manual's highest is {allowed:.0f}",
    "files",
)
MACRO_FILE_MISSING = code(
    607,
    "macro-file-missing",
    _U,
    "{name} is not beside {machine}: which commands it would replace is not known",
    "files",
)

BAD_ALLOWANCE = code(608, "bad-allowance", _W, "this comment to gproof {what}; it accepts nothing", "policy")
UNUSED_ALLOWANCE = code(609, "unused-allowance", _W, "nothing here is {codes}: the comment accepts nothing", "policy")
ERROR_NOT_ALLOWED = code(610, "error-not-allowed", _W, "{code} is an error here, which no comment accepts", "policy")
NO_SUCH_KEY = code(611, "no-such-key", _E, "there is no key {key!r}", "files")

FOREIGN_FACT = code(630, "foreign-fact", _U, "{what}; what it says is not used", "files")

# 7xx printing and translation
FORMAT_DIFFERS = code(
    701, "format-differs", _E, "the formatted text would be another program: {what}; nothing was written", "printing"
)
NOT_PRINTABLE = code(702, "not-printable", _E, "the language has no text for {what}", "printing")

# 8xx boards and certificates
_DOUBT = "do not run it; compile the job again, and where that says the same, report it: it is a fault of gproof"
STREAM_POSITION = code(801, "stream-position", _E, "{what}", "stream", _DOUBT)
STREAM_ORDER = code(802, "stream-order", _E, "{what}", "stream", _DOUBT)
STREAM_STEP_RATE = code(803, "stream-step-rate", _E, "{what}", "stream", _DOUBT)
STREAM_PULSE = code(804, "stream-pulse", _E, "{what}", "stream", _DOUBT)
STREAM_VELOCITY = code(805, "stream-velocity", _E, "{what}", "stream", _DOUBT)
STREAM_ACCELERATION = code(806, "stream-acceleration", _E, "{what}", "stream", _DOUBT)
STREAM_EVENT = code(807, "stream-event", _E, "{what}", "stream", _DOUBT)
STREAM_END = code(808, "stream-end", _E, "{what}", "stream", _DOUBT)
STREAM_LIMIT = code(809, "stream-limit", _E, "{what}", "stream", _DOUBT)
STREAM_MALFORMED = code(
    810, "stream-malformed", _E, "{what}", "stream",
    "compile the job again: the file was damaged or changed",
)  # fmt: skip
CERTIFICATE_MALFORMED = code(
    820, "certificate-malformed", _E, "{what}", "certificate",
    "compile the job again: the file was damaged, or another program made it",
)  # fmt: skip
CERTIFICATE_HASH = code(
    821, "certificate-hash", _E, "{what}", "certificate",
    "compile the changed job again, or ask for the package once more",
)  # fmt: skip
CERTIFICATE_SIGNATURE = code(
    822, "certificate-signature", _E, "{what}", "certificate",
    "ask who made the package for it once more, or compile the job yourself",
)  # fmt: skip
CERTIFICATE_MACHINE = code(
    823, "certificate-machine", _E, "{what}", "certificate",
    "compile the job with the file of this machine and board",
)  # fmt: skip
CERTIFICATE_VERDICT = code(
    824, "certificate-verdict", _E, "{what}", "certificate",
    "gproof check names what the job is not SAFE for; mend that first",
)  # fmt: skip
CERTIFICATE_OFFSETS = code(
    825, "certificate-offsets", _E, "{what}", "certificate",
    "set the work zero inside the box, or compile the job again with the setup as it is",
)  # fmt: skip
CERTIFICATE_UNSIGNED = code(
    826, "certificate-unsigned", _W, "the certificate carries no signature", "certificate",
    "sign it: gproof run calls an unsigned package UNKNOWN (GP827)",
)  # fmt: skip
CERTIFICATE_UNTRUSTED = code(
    827, "certificate-untrusted", _U, "{what}", "certificate",
    "ask who made it for the public key, compare fingerprints, and name it with --trust; or compile the job yourself",
)  # fmt: skip
CERTIFICATE_REVOKED = code(
    828, "certificate-revoked", _E, "{what}", "certificate",
    "compile the job again, or ask for a package that another key has signed",
)  # fmt: skip
CERTIFICATE_SOURCE = code(
    829, "certificate-source", _E, "{what}", "certificate",
    "compile this file, or take the one that the package was made of; --against says what differs",
)  # fmt: skip
CERTIFICATE_FORMAT = code(
    857, "certificate-format", _U, "{what}", "certificate",
    "compile the job again with this version, or take the version that made the package",
)  # fmt: skip
FIFO_UNDERRUN = code(
    830, "fifo-underrun", _E, "{what}", "run",
    "give the board more of a buffer (fifo_time), and home the machine before it goes on",
)  # fmt: skip
EMERGENCY_STOP = code(
    831, "emergency-stop", _E, "{what}", "run",
    "clear the reason, home the machine, and begin the job again",
)  # fmt: skip
FEED_HOLD = code(832, "feed-hold", _N, "{what}", "run")
RECORD_MISMATCH = code(
    833, "record-mismatch", _E, "{what}", "run",
    "do not trust the position: home the machine, check cables and drives, measure the part",
)  # fmt: skip
RECORD_MALFORMED = code(
    834, "record-malformed", _E, "{what}", "run",
    "take the record from where gproof wrote it; the journal beside it says the same",
)  # fmt: skip
RECORD_SIGNATURE = code(
    835, "record-signature", _E, "{what}", "run",
    "do not believe it; ask who ran the job for the record as gproof wrote it",
)  # fmt: skip
RECORD_UNTRUSTED = code(
    836, "record-untrusted", _U, "{what}", "run",
    "ask who ran the job for the public key, and name it with --trust",
)  # fmt: skip
RUN_INTERRUPTED = code(
    837, "run-interrupted", _U, "{what}", "run",
    "home the machine, look at tool and part, and only then run a job again",
)  # fmt: skip
JOURNAL_LOST = code(
    838, "journal-lost", _W, "{what}", "run",
    "make room, and keep the record that was written",
)  # fmt: skip
CERTIFICATE_VERSION = code(
    850, "certificate-version", _U, "{what}", "certificate",
    "compile the job again with this version",
)  # fmt: skip
CERTIFICATE_AGAINST = code(
    851, "certificate-against", _E, "{what}", "certificate",
    "compare with the machine file and the setup of the package; where it still differs, compile the source yourself",
)  # fmt: skip
CERTIFICATE_NOT_ANEW = code(
    852, "certificate-not-anew", _U, "{what}", "certificate",
    "compile the source with this version, and run what that gives",
)  # fmt: skip
