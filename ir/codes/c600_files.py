"""Finding codes 6xx: machine files and setup."""

from __future__ import annotations

from gproof.ir.codes.declared import code
from gproof.ir.finding import Severity

_E, _U, _W = Severity.ERROR, Severity.UNKNOWN, Severity.WARNING

FILE_UNREADABLE = code(601, "file-unreadable", _E, "cannot read the file: {what}", "files")
UNKNOWN_KEY = code(602, "unknown-key", _W, "unknown key {key!r}: ignored", "files")
BAD_VALUE = code(603, "bad-value", _E, "{key}: {what}", "files")
MISSING_KEY = code(604, "missing-key", _E, "{key} is missing", "files")
NOT_MODELLED_SETTING = code(605, "not-modelled-setting", _U, "{key} is set, but gproof does not model it", "limits")
ACCELERATION_BOUNDS = code(
    606,
    "acceleration-bounds",
    _W,
    "{axis}: acceleration times resolution is {steps:.0f} steps per second squared; the manual allows {allowed:.0f}",
    "files",
)
MACRO_FILE_MISSING = code(
    607,
    "macro-file-missing",
    _U,
    "{name} is not next to {machine}: which commands it replaces is unknown",
    "files",
)
BAD_ALLOWANCE = code(608, "bad-allowance", _W, "this comment to gproof {what}; it accepts nothing", "policy")
UNUSED_ALLOWANCE = code(609, "unused-allowance", _W, "no {codes} here: the comment accepts nothing", "policy")
ERROR_NOT_ALLOWED = code(610, "error-not-allowed", _W, "{code} is an error here: no comment can accept it", "policy")
NO_SUCH_KEY = code(611, "no-such-key", _E, "there is no key {key!r}", "files")
FOREIGN_FACT = code(630, "foreign-fact", _U, "not used by this controller: {what}", "files")
