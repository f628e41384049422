"""WinCNC: every command that the manual names, with its letters and their ranges.

What a command does to axes and modes is in the rules of the dialect; here is what is allowed on its line. Source:
the WinCNC manual, chapter Command Reference; a row's heading is the command under "Parameters in [Brackets]", "G
Codes", "L Codes" or "M Codes". Ranges are those that the manual gives, and None where it gives none.
"""

from __future__ import annotations

import enum

from gproof.ir.record import record


class Axes(enum.Enum):
    """What the axis letters of a command's line are to it."""

    NONE = "none"
    NAMES = "names"
    """Letters choose axes; a number after one has no meaning."""
    VALUES = "values"
    """Each letter has a number: a place, a distance, a rate, a factor."""


@record(frozen=True, slots=True)
class Parameter:
    """A letter of a command: meaning, lowest and highest value, whether it must be there.

    letter: one, or "text": what comes after the command, up to the end of the line.
    """

    letter: str
    meaning: str
    low: float | None = None
    high: float | None = None
    needed: bool = False


@record(frozen=True, slots=True)
class Command:
    """One command. name: as programs write it; parameters: besides the axis words."""

    name: str
    meaning: str
    axes: Axes = Axes.NONE
    parameters: tuple[Parameter, ...] = ()

    @property
    def letters(self) -> str:
        """Its parameters' letters, in the manual's order."""
        return "".join(p.letter for p in self.parameters if len(p.letter) == 1)

    @property
    def heading(self) -> str:
        """Where the manual describes it."""
        return f"{self.name[0]} Codes: {self.name}" if len(self.name) > 1 else f"Parameters in [Brackets]: {self.name}"


_NO, _NAMES, _VALUES = Axes.NONE, Axes.NAMES, Axes.VALUES
_P = Parameter
_POWER = _P("L", "power of a vector laser, percent", 1, 100)
_FEED = _P("F", "feed velocity of the groups that move", 0)
_ARC = (
    _POWER, _P("I", "X distance to the centre"), _P("J", "Y distance to the centre"),
    _P("K", "distance to the centre on a third axis"), _P("R", "radius, instead of I, J and K", 0), _FEED,
)  # fmt: skip
_HOLE = (
    _P("X", "position of the hole"), _P("Y", "position of the hole"), _P("Z", "bottom of the hole"),
    _P("R", "height from which the drill feeds"),
)  # fmt: skip
_PECK = _P("Q", "depth of one peck", 0)
_O_CUTTER = _P("O", "amount of compensation on a machine without a tool changer")
_TURN = (_P("X", "place to turn towards, type 3"), _P("Y", "place to turn towards, type 3"))
_TEXT_FILE = _P("text", "file", needed=True)
_TOOL = _P("T", "tool number", 0, needed=True)
_REGISTER = _P("R", "register of the tool's measure")
_OUTPUT = _P("C", "channel of auxout=", needed=True)
_INPUT = _P("C", "channel of auxin=", needed=True)
_VIRTUAL = _P("C", "virtual input", 1, 64, needed=True)
_BIT = _P("C", "0 or 1", 0, 1, needed=True)
_SIMULATED = _P("D", "value of the condition in a simulation", 0, 1)
_STORED = (
    _P("P", "store a position, under this number", 0), _P("H", "store a home position", 0),
    _P("T", "store a tool position", 0), _P("L", "1: lift the vertical heads on the way there", 0, 1),
    _P("C", "clearance of the lift"), _P("N", "name in quotes, fewer than 16 characters"),
)  # fmt: skip
_MAP_STEP = (_P("N", "next place"), _P("P", "previous place"), _P("S", "first place"), _P("E", "last place"))

LETTERS = (
    Command("X", "axis words: a letter without a number counts as 0", _VALUES),
    Command("F", "feed velocity of the groups of the axes on its line, or of the command group", _NAMES),
    Command("P", "move to a stored position"),
    Command("H", "move to a stored home position"),
    Command("S", "spindle speed"),
    Command("[", "comment; its closing bracket may be missing"),
    Command("{", "a value, computed from the controller's variables, in place of a number or an axis"),
)
"""Commands of one letter, and the brackets; ``X`` stands for the letters of axischar= and I, J, K."""

G_CODES = (
    Command("G0", "rapid move, modal", _VALUES),
    Command("G0.1", "lift all vertical heads, rapid move, lower them to where they were", _NO, (
        _P("X", "place"), _P("Y", "place"),
    )),
    Command("G1", "feed move, modal", _VALUES, (_POWER, _FEED)),
    Command("G2", "arc, clockwise", _VALUES, _ARC),
    Command("G3", "arc, counter-clockwise", _VALUES, _ARC),
    Command("G4", "wait; without a time until the operator continues", _NO, (_P("X", "seconds", 0),)),
    Command("G5", "message box, which may offer an abort or decide about the next line", _NO, (
        _P("T", "0 tells, 1 yes: abort, 2 yes: go on, 3 yes: run the next line, 4 yes: skip it", 0, 4),
        _P("M", "text in quotes"),
    )),
    Command("G9", "smoothing of corners", _NO, (
        _P("S", "factor: higher slows less"), _P("A", "degrees below which it does not act"),
    )),
    Command("G20", "unit: inch"),
    Command("G21", "unit: centimetre"),
    Command("G22", "unit: millimetre"),
    Command("G23", "unit: the one used last"),
    Command("G28", "home axes on their switches; all without letters", _NAMES),
    Command("G31", "stop reading ahead, so that a position met by M28 can be measured"),
    Command("G40", "cutter compensation off"),
    Command("G41", "cutter compensation, tool left of the path", _NO, (_O_CUTTER,)),
    Command("G42", "cutter compensation, tool right of the path", _NO, (_O_CUTTER,)),
    Command("G43", "tool length offsets on, as measured last; all without letters", _NAMES),
    Command("G49", "tool length offsets off; all without letters", _NAMES),
    Command("G50", "scaling and rotation off"),
    Command("G51", "scale", _VALUES, (
        _P("I", "X of the centre"), _P("J", "Y of the centre"), _P("K", "Z of the centre"),
        _P("C", "centre on all axes"),
    )),
    Command("G52", "rotate about a point", _NO, (
        _P("I", "X of the centre"), _P("J", "Y of the centre"), _P("A", "degrees"),
    )),
    Command("G52.1", "rotate about the origin, to the direction of a line between stored positions", _NO, (
        _P("A", "number of the first position", 0), _P("B", "number of the second position", 0),
    )),
    Command("G53", "rapid move without tool lengths and local coordinates; alone: lift the vertical axes", _VALUES),
    Command("G54", "workspace 1: head Z", _NO, _TURN),
    Command("G55", "workspace 2: head W", _NO, _TURN),
    Command("G56", "workspace 3: head U", _NO, _TURN),
    Command("G57", "workspace 4: head V", _NO, _TURN),
    Command("G58", "workspace 5", _NO, _TURN),
    Command("G59", "workspace 6", _NO, _TURN),
    Command("G73", "drill with pecks, a short lift between them", _NO, (*_HOLE, _PECK, _FEED)),
    Command("G80", "drill cycle off"),
    Command("G81", "drill", _NO, (*_HOLE, _FEED)),
    Command("G82", "drill, stand still at the bottom", _NO, (*_HOLE, _P("P", "milliseconds", 0), _FEED)),
    Command("G83", "drill with pecks, out of the hole between them", _NO, (*_HOLE, _PECK, _FEED)),
    Command("G90", "absolute positions; I and J stay relative"),
    Command("G91", "relative positions"),
    Command("G92", "name the present place; alone: machine coordinates", _VALUES),
    Command("G92.1", "local coordinates that many units from the machine's", _VALUES),
    Command("G92.2", "shift the local coordinates", _VALUES),
    Command("G92.3", "put local coordinates away, or take them out again"),
    Command("G92.4", "local zero where two lines between stored positions meet", _NO, (
        _P("A", "first position of the first line", 0), _P("B", "second position of the first line", 0),
        _P("C", "first position of the second line", 0), _P("D", "second position of the second line", 0),
        _P("O", "shift of all positions"),
    )),
    Command("G93", "F is one over the minutes of the move"),
    Command("G94", "F is units a minute again"),
    Command("G95", "feed of rotary axes from a linear feed, Z being the radius; without F off", _NO, (_FEED,)),
)  # fmt: skip

L_CODES = (
    Command("L1", "store a number in a register H", _NO, (
        _P("N", "register", 0, 29, needed=True), _P("V", "number", needed=True),
    )),
    Command("L1.1", "save the registers H to a file"),
    Command("L1.2", "load the registers H from a file"),
    Command("L3", "store where the axes are", _NAMES),
    Command("L4", "move to the position that L3 stored last", _NAMES),
    Command("L5", "contouring velocity, units a minute", _VALUES),
    Command("L6", "acceleration, units a minute a second; alone: that of the machine file", _VALUES),
    Command("L7", "acceleration, percent of the present; alone: the original", _NO, (_P("P", "percent", 1, 100),)),
    Command("L8", "backlash compensation on, with new values where a letter has a number", _VALUES),
    Command("L9", "backlash compensation off"),
    Command("L10", "repeat what follows over a grid; alone: end of the grid", _NO, (
        _P("R", "rows", 1), _P("C", "columns", 1), _P("X", "X distance of cells"), _P("Y", "Y distance of cells"),
        _P("E", "stay at the last cell"),
    )),
    Command("L11", "axes that take the words X, Y, Z, W, in that order; alone: none re-mapped", _NAMES),
    Command("L12", "axes that take the words Z, W, in that order; alone: none re-mapped", _NAMES),
    Command("L13", "the second axis takes each step of the first; alone: none follows", _NAMES),
    Command("L20", "soft limits and boundaries on", _NO, (_P("X", "1 boundaries only, 2 soft limits only", 1, 2),)),
    Command("L21", "soft limits and boundaries off"),
    Command("L22", "low boundaries; alone: those of the machine file", _VALUES),
    Command("L22.1", "low boundaries of axes back to the machine file's", _NAMES),
    Command("L23", "high boundaries; alone: those of the machine file", _VALUES),
    Command("L23.1", "high boundaries of axes back to the machine file's", _NAMES),
    Command("L28", "name the present place in machine coordinates", _VALUES),
    Command("L28.1", "bring the positions of rotary axes into one turn"),
    Command("L29", "forget that axes must be homed", _NAMES),
    Command("L29.1", "this file runs without homed axes"),
    Command("L30", "tangential knife on"),
    Command("L30.1", "how the knife turns", _NO, (
        _P("A", "degrees from which it lifts"), _P("Z", "height of the lift"), _P("P", "depth of the cut"),
    )),
    Command("L31", "tangential knife off"),
    Command("L32", "rotating saw on"),
    Command("L33", "rotating saw off"),
    Command("L34", "switch an output with cuts; with D only its delay changes", _NO, (_P("D", "seconds after on", 0),)),
    Command("L35", "no longer so; with D only its delay changes", _NO, (_P("D", "seconds after off", 0),)),
    Command("L36", "torch height control on"),
    Command("L36.1", "torch height control measures its own voltage"),
    Command("L36.2", "it forgets the voltage it measured"),
    Command("L37", "torch height control off"),
    Command("L37.1", "torch height control keeps the voltage that was set"),
    Command("L38", "torch on", _NO, (_P("A", "degrees of a bevel, with torchbevel="),)),
    Command("L39", "torch off"),
    Command("L40", "feed override; no effect outside of override=", _NO, (_P("P", "percent", needed=True),)),
    Command("L41", "run a program of the computer", _NO, (_P("text", "path", needed=True),)),
    Command("L48", "take the present voltage as that of laser height control"),
    Command("L51", "D/A output; one letter only", _NO, (
        _P("V", "volts", 0), _P("P", "percent", 0, 100), _P("S", "spindle speed", 0),
    )),
    Command("L53", "lift all vertical heads, the tips at one height"),
    Command("L55", "pump follows the velocity"),
    Command("L56", "pump purges"),
    Command("L57", "pump off"),
    Command("L58", "pump off, turning back first"),
    Command("L59", "highest output of the pump", _NO, (_P("M", "output", needed=True),)),
    Command("L60", "virtual input off", _NO, (_VIRTUAL,)),
    Command("L61", "virtual input on", _NO, (_VIRTUAL,)),
    Command("L70", "enter the last command again when the file has ended"),
    Command("L82", "touch the surface with the probe and name its height", _NO, (_P("Z", "height of the surface"),)),
    Command("L82.1", "local coordinates of vertical axes from the probe's calibration"),
    Command("L82.2", "correct the local coordinates of L82.1 by a new measurement"),
    Command("L82.3", "calibrate the probe on the table"),
    Command("L83", "move to a position, touch it and write it to a file", _NO, (_P("X", "place"), _P("Y", "place"))),
    Command("L90", "this line has absolute positions"),
    Command("L91", "this line has relative positions"),
    Command("L92", "local coordinates outlive the file"),
    Command("L101", "first tool changer holds a tool, with its measure", _NO, (_TOOL, _REGISTER)),
    Command("L102", "second tool changer holds a tool, with its measure", _NO, (_TOOL, _REGISTER)),
    Command("L110", "first tool changer holds a tool, with its measure", _NO, (_TOOL,)),
    Command("L111", "run the next line if a tool is in the spindle", _NO, (
        _TOOL, _P("A", "0 both changers, 1 or 2 that one", 0, 2),
    )),
    Command("L111.1", "run the next line if both spindles have a tool", _NO, (_TOOL,)),
    Command("L112", "skip the next line if a tool is in the spindle", _NO, (_TOOL,)),
    Command("L113", "skip the next line unless a value is between two others", _NO, (
        _P("L", "low", needed=True), _P("H", "high", needed=True), _P("V", "value", needed=True),
    )),
    Command("L120", "second tool changer holds a tool", _NO, (_TOOL,)),
    Command("L201", "file that a signal of type 201 runs", _NO, (
        _TEXT_FILE, _P("T", "not described"), _P("C", "not described"), _P("S", "not described"),
    )),
    Command("L202", "command that a signal of type 202 runs", _NO, (_P("text", "command", needed=True),)),
    Command("L204", "signals and enables on", _NO, (_P("C", "input channel; all without"),)),
    Command("L205", "signals and enables off", _NO, (_P("C", "input channel; all without"),)),
    Command("L210", "axes with their other low limit switch", _NAMES),
    Command("L210.1", "axes with the low limit switch of a channel", _NAMES, (_P("C", "channel; else the first"),)),
    Command("L211", "axes with their other high limit switch", _NAMES),
    Command("L211.1", "axes with the high limit switch of a channel", _NAMES, (_P("C", "channel; else the first"),)),
    Command("L212", "all axes with their first limit switches"),
    Command("L213", "only the first motor of axes with two", _NAMES),
    Command("L214", "only the second motor of axes with two", _NAMES),
    Command("L215", "both motors of axes with two", _NAMES),
    Command("L249", "power of the laser", _NO, (
        _P("P", "power"), _P("I", "exchange black and white"), _P("F", "power"),
    )),
    Command("L250", "vector laser off"),
    Command("L251", "vector laser on", _NO, (
        _P("P", "power, percent", 1, 100), _P("D", "distance of shots"), _P("L", "distance without, when perforating"),
    )),
    Command("L251.1", "laser stays at one place", _NO, (_P("D", "seconds", 0, needed=True),)),
    Command("L252", "engrave a bitmap"),
    Command("L252.1", "later bitmaps as they are"),
    Command("L253", "engrave a bitmap, turned by 90 degrees clockwise"),
    Command("L253.1", "later bitmaps turned so"),
    Command("L254", "engrave a bitmap, turned by 180 degrees"),
    Command("L254.1", "later bitmaps turned so"),
    Command("L255", "engrave a bitmap, turned by 270 degrees clockwise"),
    Command("L255.1", "later bitmaps turned so"),
    Command("L256", "shift of the rows of a bitmap", _NO, (_P("R", "radius when the work turns"),)),
    Command("L300", "axes stay where they are, whatever is commanded", _NAMES),
    Command("L301", "axes move again", _NAMES),
    Command("L400", "write a home file of the present place"),
    Command("L401", "move to the positions before the last file"),
    Command("L402", "write the positions to a file", _NO, (_TEXT_FILE,)),
    Command("L500", "store machine positions under a number", _NAMES, _STORED),
    Command("L500.2", "enter a tool into the tool library", _NO, (
        _P("T", "tool number", 0, needed=True), _P("N", "nominal diameter", 0), _P("A", "actual diameter", 0),
        _P("C", "diameter compensation"), _P("O", "height offset"), _P("H", "height"), _P("M", "highest current", 0),
    )),
    Command("L501", "store local positions under a number", _NAMES, _STORED),
    Command("L502", "the material that the viewer draws; alone: shown or not", _NO, (
        _P("X", "X of its corner"), _P("Y", "Y of its corner"), _P("W", "width", 0), _P("H", "height", 0),
    )),
    Command("L600", "pitch maps of axes off; all without letters", _NAMES),
    Command("L601", "pitch maps of axes on; all without letters", _NAMES),
    Command("L602", "start to map an axis: which, and which is corrected; moves to the first place", _NAMES),
    Command("L603", "store the correction of the map and go on", _NO, _MAP_STEP),
    Command("L604", "go on in the map", _NO, _MAP_STEP),
    Command("L605", "store the correction of the map"),
    Command("L606", "store a correction of the map", _NO, (
        _P("N", "place in the map", needed=True), _P("V", "correction", needed=True),
    )),
    Command("L800", "probe off"),
    Command("L801", "probe on: it stops motion like a limit switch"),
    Command("L802", "scan a rectangle, up, down and sideways", _NO, (
        _P("X", "length"), _P("Y", "length"), _P("I", "increment"),
    )),
    Command("L803", "scan a rectangle, up and down", _NO, (_P("X", "length"), _P("Y", "length"), _P("I", "increment"))),
    Command("L810", "scan a line up to an edge, into a file", _NO, (
        _TEXT_FILE, _P("X", "distance"), _P("Y", "distance"), _P("I", "increment"), _P("K", "height of the lift"),
    )),
    Command("L820", "the axis adjustment of axisadj= off"),
    Command("L821", "the axis adjustment of axisadj= on"),
    Command("L901", "debounce of the limit switches", _NO, (_P("D", "readings", 1, 30, needed=True),)),
    Command("L910", "do not show the lines of the program"),
    Command("L911", "show the lines of the program"),
)  # fmt: skip
"""The stored text of the manual has lost the numbers of two headings: L82.2 is between L82.1 and L82.3, L820
before L821, of which it is the opposite."""

M_CODES = (
    Command("M11", "output on, at rest", _NO, (
        _P("C", "channel of auxout="), _P("D", "drills of drillbank=, as a binary number", 0),
    )),
    Command("M12", "output off, at rest", _NO, (_OUTPUT,)),
    Command("M13", "output on, without stopping", _NO, (_OUTPUT,)),
    Command("M14", "output off, without stopping", _NO, (_OUTPUT,)),
    Command("M17", "wait until an input is on", _NO, (_INPUT,)),
    Command("M17.1", "run the next line if an input is on", _NO, (_SIMULATED, _INPUT)),
    Command("M17.2", "run the next line if an output is on", _NO, (_SIMULATED, _OUTPUT)),
    Command("M17.3", "run the next line if a virtual input is on", _NO, (_VIRTUAL,)),
    Command("M17.4", "run the next line if C is 1", _NO, (_BIT,)),
    Command("M18", "wait until an input is off", _NO, (_INPUT,)),
    Command("M18.1", "run the next line if an input is off", _NO, (_SIMULATED, _INPUT)),
    Command("M18.2", "run the next line if an output is off", _NO, (_OUTPUT,)),
    Command("M18.3", "run the next line if a virtual input is off", _NO, (_VIRTUAL,)),
    Command("M18.4", "run the next line if C is 0", _NO, (_BIT,)),
    Command("M28", "a limit switch stops its axis on this line; the other axes and the job continue"),
    Command("M29", "a limit switch stops this line; the job continues"),
    Command("M37", "measure the tool: its tip is at the places given", _VALUES, (
        _P("O", "height offset"), _P("H", "tool number, M0 of atc1="), _P("T", "tool number, M1 of atc1="),
    )),
    Command("M37.1", "measure the first tool length switch", _VALUES),
    Command("M37.2", "measure the second tool length switch", _VALUES),
    Command("M37.3", "shift workspaces, tool measures and switch heights", _VALUES, (
        _P("S", "amount"), _P("H", "register; 0 all", 0), _P("T", "tool; 0 all", 0), _P("M", "switch; 0 both", 0, 2),
    )),
    Command("M98", "call a file", _NO, (_TEXT_FILE,)),
    Command("M98.1", "call a file without counting its lines", _NO, (_TEXT_FILE,)),
    Command("M99", "end of a called file"),
    Command("M99.1", "abort the program"),
)  # fmt: skip

COMMANDS = {command.name: command for command in (*LETTERS, *G_CODES, *L_CODES, *M_CODES)}
"""Every command by its name."""
