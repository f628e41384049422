"""Finding codes 1xx: language."""

from __future__ import annotations

from gproof.ir.codes.declared import code
from gproof.ir.finding import Severity

_E, _U, _W, _N = Severity.ERROR, Severity.UNKNOWN, Severity.WARNING, Severity.NOTE

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
