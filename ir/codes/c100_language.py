"""Finding codes 1xx: language."""

from __future__ import annotations

from gproof.ir.codes.declared import code
from gproof.ir.finding import Severity

_E, _U, _W, _N = Severity.ERROR, Severity.UNKNOWN, Severity.WARNING, Severity.NOTE

SYNTAX = code(101, "syntax", _E, "syntax error: {what}")
BAD_NUMBER = code(102, "bad-number", _E, "{text!r} is not a number")
UNCLOSED_COMMENT = code(103, "unclosed-comment", _E, "the comment has no closing parenthesis on its line")
NESTED_COMMENT = code(104, "nested-comment", _E, "comment inside a comment")
BAD_LINE_NUMBER = code(
    105, "bad-line-number", _E, "line number {text!r} must be one to five digits at the start of the line"
)
LINE_TOO_LONG = code(
    106, "line-too-long", _E, "the line has {length} characters; the controller reads at most {allowed}"
)
BAD_EXPRESSION = code(107, "bad-expression", _E, "error in the expression: {what}")
MISSING_VALUE = code(108, "missing-value", _E, "{letter} has no value")
REPEATED_WORD = code(109, "repeated-word", _E, "{letter} is programmed twice on this line")
MODAL_GROUP_CONFLICT = code(
    110, "modal-group-conflict", _E, "{first} and {second} cannot be on one line: same modal group ({group})"
)
TOO_MANY_M_CODES = code(
    111, "too-many-m-codes", _E, "{count} M codes on one line; the controller takes at most {allowed}"
)
UNKNOWN_CODE = code(112, "unknown-code", _E, "{code} is not a code of this controller")
UNSUPPORTED_CODE = code(
    113, "unsupported-code", _U, "{code} is not modelled: the state of the machine after it is unknown"
)
UNBALANCED_BLOCK = code(114, "unbalanced-block", _E, "unbalanced block: {what}")
UNKNOWN_SUBPROGRAM = code(115, "unknown-subprogram", _E, "there is no subprogram {name!r}")
DUPLICATE_SUBPROGRAM = code(116, "duplicate-subprogram", _E, "subprogram {name!r} is defined twice")
RECURSION = code(117, "recursion", _E, "subprogram calls are nested deeper than {allowed} levels: {chain}")
NO_PROGRAM_END = code(118, "no-program-end", _W, "the program does not end with M2 or M30")
NOT_TEXT = code(119, "not-text", _E, "the file is not text: byte {byte} at offset {offset}")
EMPTY_PROGRAM = code(120, "empty-program", _E, "the program contains no code")
UNUSED_WORD = code(121, "unused-word", _E, "{word} is not used by any code on this line")
FLOW_WORD_MISPLACED = code(122, "flow-word-misplaced", _E, "flow control word in the wrong place: {what}")
TEXT_AFTER_END = code(123, "text-after-end", _W, "code after {code} is never executed")
UNDECODABLE_NAME = code(124, "undecodable-name", _U, "unclear name or text: {what}")
NESTING_PRESET = code(
    125, "nesting-preset", _N, "a value of the nesting dialog: only one part, at its programmed place, is checked"
)
UNREACHED_MISTAKE = code(126, "unreached-mistake", _W, "this job never runs this line, {where}: {message} ({label})")
MULTIPLE_COMMANDS = code(
    127, "multiple-commands", _E, "{first} and {second} are two commands; this controller takes one command on a line"
)
PARAMETER_RANGE = code(128, "parameter-range", _E, "{code}: {word} is out of range; allowed: {allowed}")
ILLEGAL_VALUE = code(129, "illegal-value", _E, "illegal value for {word}: {what}")
FILE_NOT_FOUND = code(130, "file-not-found", _E, "file {name!r} not found{where}")
ARRAY_IN_SUBPROGRAM = code(131, "array-in-subprogram", _E, "{code} cuts an array, which is not allowed in a subprogram")
ARRAY_PARAMETERS = code(132, "array-parameters", _E, "wrong parameter of {code}: {what}")
MACRO_TOO_LONG = code(
    133,
    "macro-too-long",
    _E,
    "the line has {length} characters once {name} is replaced; the controller reads at most {allowed}",
)
TEXT_BEHIND_COMMENT = code(
    134,
    "text-behind-comment",
    _U,
    "text after a comment ({text!r}): the manual does not say whether it is executed",
)
TYPE_MISMATCH = code(135, "type-mismatch", _E, "wrong type: {what}")
UNDECLARED_NAME = code(136, "undeclared-name", _E, "unknown name: {what}")
DECLARATION = code(137, "declaration", _E, "error in the declaration: {what}")
SYSTEM_VARIABLE = code(
    138, "system-variable", _W, "{name} is outside {prefix}600 to {prefix}699: it may be a system variable"
)
PASCAL_OPEN = code(139, "pascal-open", _U, "{what}: the manual does not say what the controller does")
BRACKET_PARAMETER = code(
    140,
    "bracket-parameter",
    _E,
    "the bracket after {code} holds a parameter, but this is not an expression (compiler error 2074)",
)
NO_MODULE_END = code(141, "no-module-end", _E, "{what} has no M02, M30 or M17 (compiler error 190)")
DUPLICATE_LABEL = code(142, "duplicate-label", _E, "label {name!r} exists twice")
UNKNOWN_LABEL = code(143, "unknown-label", _E, "there is no label {name!r}")
JUMP_INTO_BLOCK = code(144, "jump-into-block", _U, "{what}: the manual does not say what the controller does")
INCLUDE_CYCLE = code(145, "include-cycle", _E, "the include file {name!r} {what}: {chain}")
PROGRAM_SIZE = code(
    146,
    "program-size",
    _W,
    "the compiled program may have {low} to {high} bytes (estimate); the controller takes at most {allowed} (error 21)",
)
PROGRAM_TOO_LARGE = code(
    147,
    "program-too-large",
    _E,
    "the compiled program has at least {low} bytes (estimate); the controller takes at most {allowed} (error 21)",
)
LINE_NUMBER_MISSING = code(148, "line-number-missing", _E, "this machine requires line numbers, and this line has none")
LOOP_VARIABLE = code(
    149, "loop-variable", _W, "{name} is read after its for loop: it holds its last value, or one past it"
)
MIRRORED_JOB = code(
    169, "mirrored-job", _W,
    "{code} mirrors {axes} from the first move to the end of the job; on other controllers it is a unit or a zone",
)  # fmt: skip
# 15x: what makes no sense, reported when the property sense is required (docs/cutting-sense.md)
UNITS_NEVER_SET = code(
    150,
    "units-never-set",
    _N,
    "no code for the unit before the first move: numbers are in the controller's own unit",
    "sense",
)
UNIT_MIX_UP = code(
    151, "unit-mix-up", _W, "the numbers of this job look like {other}, but are read as {unit}: {why}", "sense"
)
FOREIGN_DIALECT = code(
    152,
    "foreign-dialect",
    _W,
    "this job looks like a program for {controller}: {what}; {lines} such lines are refused",
    "sense",
)
DEAD_CODE = code(153, "dead-code", _W, "this line is never reached: {what}", "sense")
UNUSED_LABEL = code(154, "unused-label", _N, "label {name!r} is never used: nothing jumps to it", "sense")
UNCALLED_SUBPROGRAM = code(155, "uncalled-subprogram", _N, "subprogram {name!r} is never called", "sense")
READ_BEFORE_SET = code(
    156,
    "read-before-set",
    _W,
    "{name} is read here, but on at least one path to this line it is not set before",
    "sense",
)
NEVER_READ = code(157, "never-read", _N, "{name} is set, but never read in this job", "sense")
CONSTANT_CONDITION = code(158, "constant-condition", _N, "this condition is always {value}", "sense")
DISTANCES_NEVER_SET = code(
    159,
    "distances-never-set",
    _N,
    "no code for absolute or incremental distances before the first move",
    "sense",
)
