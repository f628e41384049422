"""WinCNC: the messages that the manual names, and which finding stands for each.

Source: the WinCNC manual, heading "Messages and Error Codes". A message without a finding is one that only the
running controller can give; ``why`` says what it depends on.
"""

from __future__ import annotations

from gproof.ir import codes
from gproof.ir.finding import Code
from gproof.ir.record import record


@record(frozen=True, slots=True)
class ControllerMessage:
    """What the controller can say. codes: findings that say the same before the job runs; why: there is none."""

    text: str
    codes: tuple[Code, ...] = ()
    why: str = ""


_M = ControllerMessage
_NOT_ENABLED = (codes.NOT_ENABLED,)
_LICENCE = "what the controller's licence key allows, which no file says"
_OPERATOR = "what the operator does"
_PROGRESS = "reports the progress of the job"
_BITMAP = "the bitmap is chosen at the machine; bitmap engraving is UNKNOWN"

MESSAGES = (
    _M("Line Too Long", (codes.LINE_TOO_LONG,)),
    _M("Unsupported G Code", (codes.UNKNOWN_CODE,)),
    _M("Unsupported L Code", (codes.UNKNOWN_CODE,)),
    _M("Unsupported M Code", (codes.UNKNOWN_CODE,)),
    _M("Multiple Commands", (codes.MULTIPLE_COMMANDS,)),
    _M("Syntax - Command or File Not Found", (codes.SYNTAX, codes.FILE_NOT_FOUND)),
    _M("Arc Radius", (codes.ARC_RADIUS_MISMATCH,)),
    _M("Soft Limit Exceeded", (codes.SOFT_LIMIT,)),
    _M("Boundary Exceeded", (codes.BOUNDARY_EXCEEDED,)),
    _M("Acceleration Out of Bounds", (codes.ACCELERATION_BOUNDS,)),
    _M("Illegal Value", (codes.ILLEGAL_VALUE,)),
    _M("Unknown Position Specified", (codes.STORED_POSITION_MISSING,)),
    _M("Subprogram Nesting Too Deep", (codes.RECURSION,)),
    _M("L10 in Subprogram", (codes.ARRAY_IN_SUBPROGRAM,)),
    _M("File Not Found", (codes.FILE_NOT_FOUND,)),
    _M("Parameter Not Specified", (codes.WORD_MISSING,)),
    _M("Unknown", why="whatever the controller has no name for"),
    _M("Memory Error", why="the controller's memory"),
    _M("User Level 5 Required", why=_LICENCE),
    _M("Invalid L10 Command", (codes.ARRAY_PARAMETERS,)),
    _M("Invalid P1 Command", (codes.STORED_POSITION_COMMAND,)),
    _M("Command Not Implemented", why="the controller's version; the manual names no such command"),
    _M("Tool Changer Not Enabled", _NOT_ENABLED),
    _M("Parameter Out of Range", (codes.PARAMETER_RANGE,)),
    _M("D/A Not Enabled", _NOT_ENABLED),
    _M("Arc Too Small", (codes.ARC_RADIUS_ZERO,)),
    _M("Device Not Enabled", _NOT_ENABLED),
    _M("Could Not Open File", why="another program of the controller's computer holds the file"),
    _M("Pump Control Not Enabled", _NOT_ENABLED),
    _M("Soft Limits Not Enabled", _NOT_ENABLED),
    _M("Tangential Knife Not Enabled", _NOT_ENABLED),
    _M("Forced Limit Exceeded", (codes.FORCED_LIMIT_EXCEEDED,)),
    _M("Digitizer Probe Not Enabled", _NOT_ENABLED),
    _M("Arcs Disabled When X or Y Scaled", (codes.ARC_SCALED,)),
    _M("Rotating Saw Not Enabled", _NOT_ENABLED),
    _M("Macro Expansion Error", (codes.MACRO_TOO_LONG,)),
    _M("Aborted - Limit Switch", why="a switch that is met although the path is within the limits"),
    _M("Aborted - Aborted By User", why=_OPERATOR),
    _M("Key Not Found", why=_LICENCE),
    _M("Wrong Key Found", why=_LICENCE),
    _M("Key Error #", why=_LICENCE),
    _M("Errors Reading WINCNC.INI", (codes.BAD_VALUE, codes.MISSING_KEY, codes.FILE_UNREADABLE)),
    _M(
        "Errors Reading CNCSCRN.INI", why="the file draws the screen; no job depends on it, and gproof does not read it"
    ),
    _M("CNC.MAC Not Found", (codes.MACRO_FILE_MISSING,)),
    _M("Upgrade needed for Key Version 5, or 6 Axis card", why="the controller's hardware"),
    _M("Pausing", why=_PROGRESS),
    _M("Continuing", why=_PROGRESS),
    _M("Finished Running", why=_PROGRESS),
    _M("Runtime", why="reports how long the job took; `gproof check` estimates the time"),
    _M("Demo Count Exceeded", why=_LICENCE),
    _M("Helical Interpolation Not Supported", (codes.HELIX_NOT_SUPPORTED,)),
    _M("Escape Button Pushed While Running", why=_OPERATOR),
    _M("Not a BMP File", why=_BITMAP),
    _M("BMP File Invalid Header", why=_BITMAP),
    _M("2-Bit Bitmap Engrave Not Enabled", why=_LICENCE),
    _M("8-Bit Bitmap Engrave Not Enabled", why=_LICENCE),
    _M("Vector Laser Not Enabled", _NOT_ENABLED),
    _M("Auto-AuxOut Not Enabled", _NOT_ENABLED),
    _M("Depth Must Be Lower Than Retract", (codes.CYCLE_R_BELOW_DEPTH,)),
)
"""In the manual's order; "File Not Found" and "Unknown", which are there twice, once."""
