"""McuWIN: everything that the manuals name, with what it means and where it is.

What a code does to axes and modes is in the rules of the dialect. Source: APCI-8001 G-code manual, McuWIN V 2.5.3.133
(``section``) and V 2.5.3.32 (``old``); a section ``14 (2.5.3.47)`` is an entry of the version information.
"""

from __future__ import annotations

from gproof.ir.record import record


@record(frozen=True, slots=True)
class Entry:
    """One thing that a program may hold. name: as programs write it; section, old: of the two manuals, "" for none."""

    name: str
    meaning: str
    section: str
    old: str = ""


_E = Entry

G_CODES = (
    _E("G00", "rapid move of each axis at its own velocity; continues on lines without a code", "3.1", "4.1"),
    _E("G01", "straight feed move of the interpolation axes; continues", "3.2", "4.2"),
    _E("G02", "arc or helix, clockwise; I and J its centre; continues", "3.3", "4.3"),
    _E("G03", "arc or helix, counter-clockwise; continues", "3.4", "4.4"),
    _E("G04", "stand still for so many seconds: a number, a variable or an expression", "3.5", "4.5"),
    _E("G17", "plane X-Y for arcs and tool radius correction, as after the start", "3.6", "4.6"),
    _E("G18", "plane Z-X", "3.7", "4.7"),
    _E("G19", "plane Y-Z", "3.8", "4.8"),
    _E("G21", "reflect Y", "3.9", "4.9"),
    _E("G22", "reflect X", "3.10", "4.10"),
    _E("G23", "reflect X and Y", "3.11", "4.11"),
    _E("G24", "no reflection", "3.12", "4.12"),
    _E("G39", "factors of reflected axes; without words -1 for all", "3.13", "4.13"),
    _E("G40", "tool radius correction off", "3.14", "4.14"),
    _E("G41", "tool radius correction, left", "3.15", "4.15"),
    _E("G42", "tool radius correction, right", "3.16", "4.16"),
    _E("G51", "effective radius of rotary axes: their words are then lengths on the surface", "3.17", "4.17"),
    _E("G53", "no zero offset for the interpolation axes", "3.18", "4.18"),
    _E("G54", "zero offset: record 0 of the table", "3.19", "4.19"),
    _E("G55", "zero offset: record 1", "3.19", "4.19"),
    _E("G56", "zero offset: record 2", "3.19", "4.19"),
    _E("G57", "zero offset: record 3", "3.19", "4.19"),
    _E("G58", "zero offset: record 4", "3.19", "4.19"),
    _E("G60", "choose the interpolation axes", "3.20", "4.20"),
    _E("G70", "positions and velocities in inches", "3.21", "4.21"),
    _E("G71", "positions and velocities in mm", "3.22", "4.22"),
    _E("G74", "reference run, by Task 0", "3.23", "4.23"),
    _E("G90", "absolute positions", "3.24", "4.24"),
    _E("G91", "relative positions", "3.25", "4.25"),
    _E("G92", "zero offset of the named axes", "3.26", "4.26"),
    _E("G93", "inverse time feed, not implemented", "3.27", "4.27"),
    _E("G94", "feeds by the minute", "3.28", "4.28"),
    _E("G96", "constant cutting speed on", "3.28"),
    _E("G97", "constant cutting speed off", "3.28"),
    _E("G98", "place of the left software limit", "3.29", "4.29"),
    _E("G99", "place of the right software limit", "3.30", "4.30"),
    _E("G150", "splines off", "3.31", "4.31"),
    _E("G151", "splines on", "3.32", "4.32"),
    _E("G153", "zero offset into CD50 and on", "3.33", "4.33"),
    _E("G154", "zero offset from CD50 and on", "3.34", "4.34"),
    _E("G161", "centres in G90 absolute", "3.35", "4.35"),
    _E("G162", "centres relative", "3.36", "4.36"),
)
"""G codes that the manual describes; codes of the application are in ``APPLICATION``."""

M_CODES = (
    _E("M00", "program stop", "4.1", "5.1"),
    _E("M01", "stop if the operator has requested it", "4.2", "5.2"),
    _E("M02", "program end; outputs stay", "4.3", "5.3"),
    _E("M03", "spindle clockwise, by Task 0", "4.4", "5.4"),
    _E("M04", "spindle anti-clockwise, by Task 0", "4.5", "5.5"),
    _E("M05", "spindle off, by Task 0", "4.6", "5.6"),
    _E("M06", "change the tool, by Task 0", "4.7", "5.7"),
    _E("M08", "coolant on, by Task 0", "4.8", "5.8"),
    _E("M09", "coolant off, by Task 0", "4.9", "5.9"),
    _E("M17", "end of a subprogram", "4.10", "5.10"),
    _E("M26", "set an output: axis number and two digits, 00 for all", "4.11", "5.11"),
    _E("M27", "reset an output", "4.12", "5.12"),
    _E("M30", "program end, back to its start, then Task 0", "4.13", "5.13"),
    _E("M80", "write the outputs of an axis channel as a word", "4.14"),
    _E("M96", "jump to a label", "4.15", "5.14"),
    _E("M98", "call a subprogram, O times", "4.16", "5.15"),
    _E("M100", "reset the output that tells the end, by Task 0", "4.17", "5.16"),
    _E("M150", "record positions for five seconds", "4.18", "5.17"),
    _E("M901", "keep an integer variable", "4.19"),
    _E("M902", "bring an integer variable back", "4.20"),
    _E("M903", "keep a floating point variable", "4.21"),
    _E("M904", "bring a floating point variable back", "4.22"),
    _E("M910", "switch the PC off after the program's end", "4.23"),
    _E("M911", "leave McuWIN after the program's end", "4.24"),
)

APPLICATION = (
    _E("G200", "to G299: codes of the application", "14 (2.5.3.47)"),
    _E("M200", "to M299: codes of the application", "14 (2.5.3.47)"),
    _E("G59", "no longer a code: the table has five records", "14 (2.5.3.23)", "1.2"),
)

LETTERS = (
    _E("N", "number of a line; whether it must be there is a setting", "14 (2.5.3.24)", "1.2"),
    _E("L", "label; its name after M96 and M98", "5.1", "6.1"),
    _E("O", "how often M98 calls", "4.16", "5.15"),
    _E("I", "centre of an arc, first axis of X-Y", "3.3", "4.3"),
    _E("J", "centre of an arc, second axis of X-Y", "3.3", "4.3"),
    _E("F", "feed of G01, G02, G03", "5.3", "6.3"),
    _E("S", "spindle speed, by Task 0", "5.4", "6.4"),
    _E("T", "tool change by Task 0, and the record of the tool table", "5.5", "6.5"),
    _E("D", "tool correction table, by Task 0", "5.6", "6.6"),
)

STATEMENTS = (
    _E("%", "starts a module, with or without a name", "4.16, 5.1", "1.2"),
    _E("()", "comment", "6", "7"),
    _E("'", "comment up to the end of the line", "6", "7"),
    _E("(())", "comment within a comment", "6", "7"),
    _E("//", "comment of rw_SymPas up to the end of the line", "7", "8"),
    _E("{}", "comment of rw_SymPas", "7"),
    _E("$if", "if … then `begin` … $end", "7", "8"),
    _E("$end else", "else branch", "7", "8"),
    _E("$end else if", "chain of conditions", "7", "8"),
    _E("$while", "loop, condition first", "8.1", "9.1"),
    _E("$repeat", "loop, condition last", "8.2", "9.2"),
    _E("$for to", "loop that counts up", "8.3", "9.3"),
    _E("$for downto", "loop that counts down", "8.3", "9.3"),
    _E("$I", "another file's text in this place", "9", "10"),
    _E("$DINEND", "rw_SymPas starts", "10", "11"),
    _E("{$DINSTART}", "DIN blocks start again", "10", "11"),
    _E("$", "one line of rw_SymPas", "10"),
    _E("var", "declares variables: integer, double, boolean", "10, 12"),
    _E("const", "declares constants", "10, 12"),
    _E("label", "declares labels", "10"),
    _E("procedure", "declares procedures", "10"),
    _E(":=", "assignment", "11", "12"),
    _E("WRITE", "text on the screen, to be continued", "5.7.1"),
    _E("WRITELN", "text on the screen, complete", "5.7.2"),
    _E("wt", "waits", "10"),
)

FUNCTIONS = (
    _E("sin", "sine", "12"),
    _E("BOOLEAN", "a number as a condition", "7", "8"),
)

OPERATORS = (
    _E("+", "sum; sign", "12, 14 (2.5.3.47)"),
    _E("-", "difference; sign", "6, 14 (2.5.3.47)", "7"),
    _E("*", "product", "11", "12"),
    _E("/", "quotient", "12"),
    _E("<", "comparison", "7", "8"),
)

VARIABLES = (
    _E("CD<n>", "floating point, 600 to 699 for the user", "11", "12"),
    _E("CI<n>", "integer, 600 to 699 for the user", "11", "12"),
    _E("CD0", "parameter of S, T and D for Task 0", "5.2, 5.6", "6.2"),
    _E("CI2", "number of the function for Task 0", "5.2, 5.6", "6.2"),
    _E("CI10", "error bits", "14 (2.5.3.103)"),
    _E("CI30", "bits: the tool radius correction is at hand", "2.7"),
    _E("CI48", "error bits of the application", "14 (2.5.3.103)"),
    _E("CI59", "counter that shows that McuWIN runs", "14 (2.5.2.117)"),
    _E("CI67", "kind of board", "14 (2.5.3.106)"),
    _E("CD50", "and on, by the axis: zero offset that G153 reads", "3.33", "4.33"),
    _E("CD60", "to CD67: reference positions", "14 (2.5.3.40)"),
)

QUALIFIERS = (
    _E(".tp", "target position of an axis", "12"),
    _E(".rp", "actual position of an axis", "5.7.1, 6", "7"),
    _E(".digib", "state of a digital input of an axis", "7", "8"),
    _E(".zerooffset", "zero offset of an axis", "3.26"),
)

TASK_NAMES = (
    _E("IPOLMODE", "which axes interpolate, written by tasks", "3.20"),
    _E("SwitchOffChecks", "register of a task: checks that are off", "14 (2.5.3.106)"),
    _E("MyTaskNr", "number of a task", "14 (2.5.3.110)"),
    _E("AXSEL", "axes of a code of the application", "14 (2.5.3.90)"),
    _E("NUMPARAMS", "number of parameters of a code of the application", "14 (2.5.3.90)"),
)
"""Names that belong to the programs of tasks, not to jobs."""

TABLES = {
    "G codes": G_CODES,
    "M codes": M_CODES,
    "Codes of the application": APPLICATION,
    "Letters": LETTERS,
    "Statements and comments": STATEMENTS,
    "Functions": FUNCTIONS,
    "Operators": OPERATORS,
    "Variables": VARIABLES,
    "Qualifiers of axes": QUALIFIERS,
    "Names of tasks": TASK_NAMES,
}
"""All of them, in the order of the page."""
