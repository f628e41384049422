"""WinCNC: the keys of WINCNC.INI and the variables in braces that the manual names.

Source: the WinCNC manual, headings "WINCNC.INI Settings" and "Internally Defined Variables". A key's letters are in
the manual's order; ``default`` is the one that the manual gives, "" where it gives none.
"""

from __future__ import annotations

from gproof.ir.dialects.wincnc.words import Parameter
from gproof.ir.record import record


@record(frozen=True, slots=True, kw_only=True)
class Key:
    """One line of the machine file.

    form: what comes after the equals sign: "letters" with numbers, a "number", "text", a "command", "axes" (letters
    of axes, with a number where the key sets one each); kind: what it belongs to; moves: it changes where axes go or
    how fast, in a job that runs as written (what only stops or delays one does not); of: the key on whose axis it acts,
    for keys that are below it.
    """

    name: str
    meaning: str
    kind: str
    moves: bool
    form: str = "letters"
    parameters: tuple[Parameter, ...] = ()
    default: str = ""
    of: str = ""

    @property
    def letters(self) -> str:
        """Its letters, in the manual's order."""
        return "".join(p.letter for p in self.parameters)

    @property
    def heading(self) -> str:
        """Where the manual describes it."""
        return f"WINCNC.INI Settings: {self.name}="


_P = Parameter


def _key(
    name: str, meaning: str, kind: str, *parameters: Parameter, form: str = "", default: str = "", of: str = ""
) -> Key:
    """A key that changes how axes go."""
    form = form or ("letters" if parameters else "number")
    return Key(
        name=name, meaning=meaning, kind=kind, moves=True, form=form, parameters=parameters, default=default, of=of
    )


def _aside(name: str, meaning: str, kind: str, *parameters: Parameter, form: str = "", default: str = "") -> Key:
    """A key that does not."""
    form = form or ("letters" if parameters else "number")
    return Key(name=name, meaning=meaning, kind=kind, moves=False, form=form, parameters=parameters, default=default)


_SWITCH = (
    _P("P", "input port", 0, 3), _P("B", "bit", 0, 7), _P("O", "polarity", 0, 1), _P("A", "alternate bit", 0, 7),
    _P("D", "debounce", 0),
)  # fmt: skip
_EXTRA_SWITCH = (
    _P("C", "channel"), _P("P", "input port"), _P("A", "alternate bit"), _P("B", "bit"), _P("O", "polarity", 0, 1),
)  # fmt: skip
_CHANGER = (
    _P("H", "height at which the tool is released"), _P("O", "offset to the tool sensor"),
    _P("Z", "height of the spindle's lower end"), _P("A", "axis that carries it, 0 X, 1 Y, …", 0),
    _P("M", "measures kept: 0 by the controller, 1 in the tool library", 0, 1),
)  # fmt: skip
_WORKSPACE = (
    _P("X", "shift"), _P("Y", "shift"), _P("T", "0 heads, 3 turning spindle, 5 two points of rotation"),
    _P("R", "radius of rotation, type 3"), _P("O", "correction of 0 degrees"),
    _P("M", "1: axes move to their new positions when it is selected", 0, 1),
)  # fmt: skip
_CURVE_ANGLE = _P("A", "degrees below which it does not act")
_TOP = _P("A", "axis, 0 X, 1 Y, …", 0)

AXIS_KEYS = (
    _key("unit", "unit of the file: IN, CM or MM; only on its first line", "axes", form="text", default="IN"),
    _aside("timertype", "timer card; must be 7200", "hardware"),
    _key("axischar", "letters of the axes, in their order; the first two are X and Y", "axes", form="text"),
    _key(
        "axisspec", "an axis and its motor", "axes",
        _P("P", "port; 0"), _P("S", "bit of the steps", 0, 5), _P("D", "bit of the direction", 0, 5),
        _P("R", "steps a unit"), _P("A", "acceleration, units a minute a second", 0),
        _P("F", "acceleration of feed moves; else A", 0), _P("O", "direction", 0, 1), _P("E", "edge of a step", 0, 1),
        _P("T", "1 first horizontal, 2 second horizontal, 3 vertical, 4 rotary", 1, 4), _P("B", "backlash", 0),
        _P("K", "keys of the keyboard", -12, 12),
        default="O1 E0, K1 to K4 for X, Y, Z, W",
    ),
    _key(
        "axisvel", "velocities of an axis", "axes",
        _P("R", "rapid, and the highest feed", 0), _P("F", "first feed", 0), _P("S", "slow transit", 0),
        _P("M", "medium transit", 0), _P("H", "fast transit", 0), _P("A", "factor of acceleration in transit", 0),
        _P("C", "lowest velocity in corners", 0),
        default="C0", of="axisspec",
    ),
    _key(
        "axisadj", "an axis that keys or inputs move while a job runs", "axes",
        _P("T", "1: by transit keys", 0, 1), _TOP, _P("V", "highest velocity", 0), _P("U", "input that moves it up"),
        _P("D", "input that moves it down"), _P("I", "1: on at the start", 0, 1), _P("B", "other axis", 0),
        _P("S", "input that selects the other axis"),
        of="axisspec",
    ),
    _key(
        "axismap", "pitch map of an axis", "axes",
        _P("S", "its start"), _P("E", "its end"), _P("M", "increment", 0), of="axisspec",
    ),
    _key(
        "altaxisspec", "second motor of an axis", "axes",
        _P("P", "port; 0"), _P("S", "bit of the steps", 0, 5), _P("D", "bit of the direction", 0, 5),
        _P("O", "direction", 0, 1), _P("E", "edge of a step", 0, 1), of="axisspec",
    ),
    *(
        _key(name, f"{which} limit switch of {whose}", "limits", *_SWITCH, of="axisspec")
        for name, which, whose in (
            ("axishi", "high", "an axis"), ("axislo", "low", "an axis"), ("altaxishi", "high", "its second motor"),
            ("altaxislo", "low", "its second motor"),
        )
    ),
    *(
        _key(name, f"further {which} limit switches of an axis, for L21{n}.1", "limits", *_EXTRA_SWITCH, of="axisspec")
        for name, which, n in (("exaltaxislo", "low", 0), ("exaltaxishi", "high", 1))
    ),
)  # fmt: skip

OTHER_KEYS = (
    _key("accel", "steepness of the S-curve", "motion", _P("S", "step of velocity", 0, 200), default="S50"),
    _aside(
        "ad", "analogue input for the spindle's current", "device",
        _P("L", "low volts"), _P("H", "high volts"), _P("X", "low amperes"), _P("Y", "high amperes"),
        _P("A", "low alarm, amperes"), _P("B", "high alarm, amperes"),
    ),
    _aside(
        "anykey", "any free key stops the job", "screen", _P("A", "1: abort", 0, 1), _P("P", "1: pause", 0, 1),
        default="off",
    ),
    _key("arc_err", "how far the radii of an arc may differ", "arcs", default="0.01"),
    _key("arc_min", "radius below which an arc becomes a line", "arcs", default="0.002"),
    _key(
        "arcs", "arcs: modal, centre", "arcs",
        _P("M", "1: G2 and G3 are modal", 0, 1), _P("A", "1: I and J are absolute", 0, 1), default="M0 A0",
    ),
    _key(
        "arctype", "arcs as lines", "arcs",
        _P("I", "length of a line", 0), _P("M", "1: G2 and G3 are modal", 0, 1), _P("O", "no check for too small arcs"),
    ),
    _key("atc1", "first tool changer", "tools", *_CHANGER),
    _key("atc2", "second tool changer", "tools", *_CHANGER),
    _key(
        "autoarcfeed", "slows down in arcs by the force in them", "arcs",
        _P("F", "factor of the force", 0), _P("S", "radius up to which the lowest velocity holds", 0),
        _P("L", "radius from which nothing is slowed", 0), _P("M", "lowest velocity", 0),
        _P("A", "degrees of an arc from which all of it holds", 0),
        default="F30, S0.05 in, L10 in, M20 in/min, A0",
    ),
    _aside(
        "autoaux", "an output that is on during cuts", "io",
        _P("C", "channel"), _P("I", "1: at the start", 0, 1), _P("S", "seconds after on", 0),
        _P("E", "seconds after off", 0), _P("T", "0 as M11 and M12, 1 as M13 and M14", 0, 1),
    ),
    _aside("autodir", "folder of files to run by themselves", "screen", form="text"),
    _aside("autofdir", "folder that they are moved to afterwards", "screen", form="text"),
    _aside(
        "autogas", "serial line to a plasma source", "device",
        _P("T", "1 or 2", 1, 2), _P("C", "serial port"), _P("B", "baud"), _P("N", "N2 mix"), _P("G", "G2 mix"),
        _P("D", "delay"),
    ),
    _aside("automode", "0 no files by themselves, 1 names them, 2 runs them", "screen"),
    _aside(
        "auxin", "an input", "io",
        _P("C", "channel", 1, 32), _P("P", "port of portin="), _P("B", "bit", 0, 7), _P("O", "polarity", 0, 1),
        _P("D", "debounce", 0), _P("F", "0, 1 enable, 100 to 110, 201, 202 signals"), _P("L", "201 or 202", 201, 202),
        _P("I", "0: active at the start", 0, 1), _P("M", "message in quotes"), _P("A", "axes to home, in quotes"),
    ),
    _aside(
        "auxout", "an output", "io",
        _P("C", "channel", 1, 32), _P("P", "port of portout="), _P("B", "bit", 0, 7), _P("O", "polarity", 0, 1),
        _P("S", "state at the start", 0, 1), _P("E", "state at the end", 0, 1),
        _P("T", "2 only while axes move, 3 by their velocity", 2, 3), _P("X", "state after an abort", 0, 1),
        _P("W", "state during a pause", 0, 1), _P("R", "state at a restart", 0, 1),
    ),
    _aside("auxoutvel", "percent of velocity at which outputs of type 3 switch", "io"),
    _key(
        "backlash", "backlash compensation", "motion",
        _P("B", "1: on", 0, 1), _P("S", "smoothing"), _P("F", "velocity in arcs", 0),
    ),
    _aside("bitmapdir", "folder of pictures", "screen", form="text"),
    _aside("bmpeditor", "editor of pictures", "screen", form="text"),
    _key("bmpend", "command after each bitmap", "commands", form="command"),
    _key("bmpstart", "command before each bitmap", "commands", form="command"),
    _aside(
        "bmpoffset", "shift of bitmap rows", "device",
        _P("L", "low shift"), _P("H", "high shift"), _P("S", "low velocity"), _P("F", "high velocity"),
    ),
    _aside("btnoptions", "0: no menu of buttons", "screen", default="1"),
    _key("cmdabort", "command after an abort", "commands", form="command"),
    _key("cmdend", "command at the end of a file", "commands", form="command"),
    _key("cmdrestart", "command when a file is started in its middle", "commands", form="command"),
    _key("cmdrestartfeed", "the same, before a feed move", "commands", form="command"),
    _key("cmdrestartrapid", "the same, before a rapid move", "commands", form="command"),
    _key("cmdstart", "command at the start of a file", "commands", form="command"),
    _key("commatodec", "1: a comma is a decimal point", "language", default="0"),
    _key("comchars", "characters that start a comment", "language", form="text", default="[(%"),
    _aside("comdll", "library for serial lines", "screen", form="text"),
    _aside("contdelay", "seconds before going on after a pause", "screen"),
    _key(
        "cutcomp", "cutter compensation", "tools",
        _P("T", "1: a move of its own to start it", 0, 1), _P("D", "negative: left and right exchanged"), default="T0",
    ),
    *(
        _aside(f"ctrlf{n}", "command of a function key", "screen", form="command") for n in range(1, 9)
    ),
    _aside(
        "da", "analogue output", "device",
        _P("T", "0 parallel port, 1 daughter board, 2 serial port", 0, 2), _P("A", "parallel port"),
        _P("V", "highest volts", 0), _P("I", "volts at the start", 0), _P("C", "serial port"),
        _P("R", "milliseconds between outputs", 0),
    ),
    _aside("drillbank", "outputs that lower drills", "io", _P("C", "first channel"), _P("N", "channels", 1)),
    _aside("editor", "editor of programs", "screen", form="text"),
    _aside(
        "enab", "an input without which the machine does not run", "io",
        _P("C", "channel"), _P("M", "message in quotes"), _P("T", "1 all, 2 motion, 3 pauses, 4 all but transit", 1, 4),
        _P("L", "201 or 202", 201, 202), _P("I", "1: active at the start", 0, 1), _P("A", "axes to home, in quotes"),
        default="T1",
    ),
    _aside("esc_step", "steps of the stop after the ESC key", "motion"),
    _aside("filetype", "names of programs", "screen", form="text"),
    _key("forcelim", "corner from which a machine of limited size counts", "limits", form="axes", default="X-1 Y-1"),
    _aside("fslock", "1: some settings of digitizing are locked", "screen"),
    _key(
        "g08", "finds curves made of short lines", "motion",
        _P("E", "1: on", 0, 1), _P("L", "longest line", 0), _P("N", "lines looked at", 0), _P("T", "degrees", 0),
        default="E0, L0.05 in, N10, T5",
    ),
    _key("g09", "smoothing of corners", "motion", _P("S", "factor: higher slows less"), _CURVE_ANGLE),
    _key("g2modal", "1: G2 and G3 are modal", "arcs", default="0"),
    _key("g28altmove", "squares a gantry with two motors", "homing", form="axes"),
    _aside("g28check", "1: asks before new home positions are taken", "homing", default="0"),
    _aside("g28checktol", "differences that need no question", "homing", form="axes"),
    _key("g28coord", "position after G28, unless all are 0", "homing", form="axes"),
    _aside("g28_lim_cnt", "debounce of limit switches while homing", "homing", default="lim_cnt="),
    _key(
        "g28move", "how axes home; the order of the lines is that of homing", "homing",
        _P("R", "distance off the switch after the first contact", 0), _P("F", "velocity of the first contact", 0),
        _P("T", "velocity of the second contact", 0), _P("A", "other limit switch"), _P("M", "axes home one by one"),
        _P("L", "longest way", 0),
        form="axes", default="T10",
    ),
    _key(
        "g37", "tool measure switches", "tools",
        _P("X", "X of the first"), _P("Y", "Y of the first"), _P("I", "X of the second"), _P("J", "Y of the second"),
        _P("D", "rapid way down"), _P("F", "feed of the rest", 0),
    ),
    *(_key(f"g5{n}", f"workspace {n - 3}", "workspaces", *_WORKSPACE) for n in range(4, 10)),
    _key("g81dwell", "seconds at the bottom of a hole", "cycles", default="0"),
    _key(
        "g81set", "drill cycles", "cycles",
        _P("D", "seconds of dwell", 0), _P("R", "distance from the last peck where the rapid ends", 0),
        _P("L", "lift above the hole between pecks", 0),
    ),
    _aside("helpfile", "folder of help", "screen", form="text"),
    _key("hibound", "high boundaries, in workspaces", "limits", form="axes"),
    _key("hilim", "high soft limits, in machine coordinates", "limits", form="axes"),
    _aside("homedir", "folder of home files", "screen", form="text"),
    _aside("keyfact", "delay of the licence key", "hardware", default="4"),
    _aside(
        "keypad", "a keypad", "screen",
        _P("C", "serial port"), _P("B", "baud"), _P("P", "type", 1, 3), _P("S", "order of files", -4, 4),
    ),
    _aside("keypaddir", "folder of files for the keypad", "screen", form="text"),
    _key(
        "knifeangle", "knife with an angled blade", "knife",
        _P("A", "degrees of the blade", -89, 89), _P("M", "1: cuts each line to and fro", 0, 1),
        _P("X", "X offset of the blade"), _P("Y", "Y offset of the blade"), default="M0",
    ),
    _key(
        "knifemode", "tangential knife", "knife",
        _P("T", "0 normal, 1 target mode", 0, 1), _P("A", "degrees from which it lifts", 0),
        _P("L", "way of blending", 0), _P("Z", "height of the lift"), _P("P", "depth of the cut"),
        _P("N", "axis that turns it, 0 X, 1 Y, …", 0), _P("C", "output that lifts it"),
        _P("D", "seconds of the lift", 0),
        _P("M", "1: up and down by itself", 0, 1), _P("R", "1: lifts in arcs", 0, 1), _P("V", "vertical axis", 0),
        default="M0 R1 V2",
    ),
    _aside(
        "laser", "laser engraving", "device",
        _P("P", "first power"), _P("D", "duty"), _P("S", "1: smart engraving", 0, 1), _P("M", "margin", 0),
        _P("O", "shift of rows"), _P("A", "axis along a row", 0), _P("B", "axis across rows", 0), _P("R", "radius"),
    ),
    _aside(
        "laserscan", "scanning with a laser", "device",
        _P("S", "bit that triggers", 0, 5), _P("M", "margin", 0), _P("U", "size of its own margin"),
        _P("W", "readings before a pass", 0), _P("A", "0 X, 1 Y", 0, 1), _P("T", "1 Ethernet, 0 parallel port", 0, 1),
    ),
    _aside("lim_cnt", "debounce of limit switches, up to 30", "limits"),
    _aside("lim_mode", "0 or 2: any switch aborts, 1 or 3: the one in the direction of the move", "limits"),
    _aside("lim_step", "steps of the stop after a switch", "limits"),
    _key("lobound", "low boundaries, in workspaces", "limits", form="axes"),
    _aside("logdir", "folder of the log", "screen", form="text"),
    _aside("logfile", "log", "screen", form="text"),
    _key("lolim", "low soft limits, in machine coordinates", "limits", form="axes"),
    _key("mapping", "how pitch maps act", "motion", _P("I", "increment", 0), _P("R", "1: in rapid moves too", 0, 1)),
    _key("maxstepv", "steps a second of an axis", "motion", default="30000"),
    _aside("maxtrans", "longest transit move", "screen"),
    _aside("numkp", "0: the keys + and - are free", "screen", default="1"),
    _key("nmode", "90 or 91: mode at the start", "language", default="the last one"),
    _key(
        "override", "feed override", "motion",
        _P("E", "1: on", 0, 1), _P("L", "lowest percent", 1, 200), _P("H", "highest percent", 1, 200),
        _P("D", "input for less"), _P("U", "input for more"), default="E1",
    ),
    _aside("portin", "an input port and its address", "io", form="text"),
    _aside("portout", "an output port and its address", "io", form="text"),
    _aside("pci48h", "directions of further ports", "io", _P("A", "ports 1", 0, 15), _P("B", "ports 2", 0, 15)),
    _aside("pci24h", "directions of further ports", "io", _P("A", "ports 1", 0, 15)),
    _key(
        "positions", "how many positions can be stored", "tools",
        _P("P", "positions", 0), _P("H", "home positions", 0), _P("T", "tool positions", 0), _P("W", "1: warns", 0, 1),
        default="W0",
    ),
    _aside(
        "pumpcont", "a pump that follows the velocity", "device",
        _P("T", "kind of output", 0, 3), _P("L", "low velocity"), _P("H", "high velocity"), _P("A", "low frequency"),
        _P("B", "high frequency"), _P("I", "first output", 0, 99), _P("R", "first reverse output", 0, 15),
    ),
    _aside("pwm", "pulse width output", "device", _P("F", "frequency"), _P("M", "percent"), default="F75 M100"),
    _key("quadmode", "1: quadrature in place of steps and directions", "motion"),
    _aside("rapid_lock", "0: the operator may change rapid velocities", "motion", default="1"),
    _aside("rapidjog", "1: jogs at rapid velocity", "screen", default="0"),
    _aside("restart", "a file started in its middle", "screen", _P("V", "1: vertical axes too", 0, 1), default="V1"),
    _key(
        "sawmode", "rotating saw", "knife",
        _P("T", "kind; 1", 1, 1), _P("A", "axis that turns it, 0 X, 1 Y, …", 0), _P("R", "radius", 0),
        _P("O", "degrees from home to the first direction"), _P("Z", "lift"),
    ),
    _key(
        "scan", "touch probe", "device",
        _P("T", "1 up and down, 2 sideways too", 1, 2, needed=True), _P("A", "axis", 0, needed=True),
        _P("C", "input channel", needed=True), _P("S", "steps of the stop", 0), _P("H", "lift", 0), _P("F", "feed", 0),
        _P("P", "feed downwards"), _P("D", "debounce", 0), default="A2 S50 H.005 F30 P30 D0",
    ),
    _aside(
        "signal", "an input that acts like a button", "io",
        _P("C", "channel"), _P("M", "message in quotes"), _P("T", "100 to 104, 110, 201, 202"),
        _P("I", "1: active at the start", 0, 1),
    ),
    _key(
        "skipchars", "lines to skip", "language",
        _P("C", "characters that mark them, in quotes"), _P("N", "how many", 0),
    ),
    _key(
        "softlim", "soft limits and boundaries", "limits",
        _P("T", "0 off, 1 on, 2 off at the start", 0, 2), _P("M", "1: shown", 0, 1),
        _P("B", "1: a move ends at the boundary, with no abort", 0, 1), _P("V", "1: the same for vertical axes", 0, 1),
        default="V0",
    ),
    _aside("spinchar", "letter of the spindle's speed", "language", form="text"),
    _aside(
        "spindle", "speed of the spindle", "device",
        _P("T", "1 D/A, 2 outputs, 3 frequency", 1, 3), _P("R", "highest speed", 0), _P("I", "first speed", 0),
    ),
    _key(
        "steppulse", "step pulses", "motion",
        _P("P", "microseconds of a pulse", 0), _P("D", "microseconds of the direction before it", 0), default="P5 D5",
    ),
    _aside(
        "table", "what the viewer shows", "screen",
        _P("X", "X of its corner"), _P("Y", "Y of its corner"), _P("W", "width", 0), _P("H", "height", 0),
        _P("B", "border"), _P("Z", "zoom", 1, 3), default="Z1",
    ),
    _key(
        "thc", "torch height control", "device",
        _P("A", "axis, 0 X, 1 Y, …", 0), _P("F", "velocity of the axis", 0), _P("V", "voltage", 20, 250),
        _P("S", "seconds of piercing", 0), _P("E", "seconds at the end", 0), _P("P", "percent of velocity", 1, 100),
        _P("O", "output of the torch"), _P("I", "input of the arc"), _P("D", "way of the touch-off switch"),
        _P("L", "lift"), _P("T", "tolerance of the voltage", 0), _P("C", "seconds until a piercing is cold", 0),
        _P("W", "seconds of a cold piercing", 0), _P("M", "2 or 3: divider", 2, 3), default="F100",
    ),
    _aside("thcauto", "0: no button for its own voltage", "screen", default="1"),
    _aside("thcdiv", "voltage divider", "device", _P("M", "divider", 0), _P("B", "readings", 0), default="B20"),
    _aside("thcdisab", "jump of the voltage: off", "device", _P("V", "volts", 0), _P("T", "seconds", 0)),
    _aside("thclim", "voltages that count", "device", _P("L", "low", 0), _P("H", "high", 0), default="L20 H350"),
    _aside("thcvel", "velocity at a voltage difference", "device", _P("F", "velocity", 0), _P("V", "volts", 0)),
    _key(
        "torchbevel", "torch that tilts", "device",
        _P("B", "axis about Y", 0), _P("C", "axis about Z", 0), _P("R", "pivot to tip", 0),
    ),
    _aside("tranadj", "distance from limits at which transit moves end", "screen"),
    _key("vgroup", "axes that have one feed; with F the command group", "motion", form="text"),
    _key(
        "vmatch", "matching of velocities with rotary axes", "motion",
        _P("P", "share", 0.9, 1.0), _P("T", "1 old, 2 new", 1, 2), default="P1.0",
    ),
    _aside(
        "watch", "a sign that the controller runs", "io",
        _P("T", "type", 1, 10), _P("D", "delay", 0), _P("C", "output"),
    ),
    _aside(
        "xhc", "wireless pendant", "screen",
        _P("T", "kind; 1", 1, 1), _P("D", "milliseconds of the display", 0),
        _P("S", "milliseconds of the wheel", 0), default="D500 S200",
    ),
)  # fmt: skip

NAMED_ONLY = (
    _key("axismode", "named among the lines of an axis, and not described", "axes", form="text", of="axisspec"),
)

KEYS = {key.name: key for key in (*AXIS_KEYS, *OTHER_KEYS, *NAMED_ONLY)}
"""Every key by its name, in lower case."""


@record(frozen=True, slots=True)
class Variable:
    """A name in braces that the controller defines; known: what its value comes from."""

    name: str
    meaning: str
    known: str

    @property
    def heading(self) -> str:
        """Where the manual describes it."""
        return f"Internally Defined Variables: {self.name}"


_TOOL, _LIBRARY, _G37, _G92, _THC = "the tool in the spindle", "tool library", "g37=", "local coordinates", "thc="

VARIABLES = {
    v.name: v
    for v in (
        Variable("TP1", "tool of the first changer", _TOOL),
        Variable("TP2", "tool of the second changer", _TOOL),
        Variable("TN1", "tool of the first changer, plus 10", _TOOL),
        Variable("TN2", "tool of the second changer, plus 20", _TOOL),
        Variable("TS1", "tool of the first changer, plus its offset", "atc1="),
        Variable("TS2", "tool of the second changer, plus its offset", "atc2="),
        Variable("TH1", "tool height of the first changer", _LIBRARY),
        Variable("TH2", "tool height of the second changer", _LIBRARY),
        Variable("TM1", "height of the first tool measure switch", "M37.1"),
        Variable("TM2", "height of the second tool measure switch", "M37.2"),
        Variable("TMX", "X of the first tool measure switch", _G37),
        Variable("TMI", "X of the second tool measure switch", _G37),
        Variable("TMY", "Y of the first tool measure switch", _G37),
        Variable("TMJ", "Y of the second tool measure switch", _G37),
        Variable("TMD", "rapid way of a tool measure", _G37),
        Variable("TMF", "feed of a tool measure", _G37),
        *(Variable(f"LZ{n}", f"local zero of axis {n}", _G92) for n in range(6)),
        Variable("THM", "1: a voltage set by hand", _THC),
        Variable("THA", "1: the controller's own voltage", _THC),
        Variable("THO", "output of the torch", _THC),
        Variable("THI", "input of the arc", _THC),
        Variable("THP", "1: pierce height on", _THC),
        Variable("THC", "1: cut height on", _THC),
        Variable("THZ", "pierce height", _THC),
        Variable("THR", "cut height", _THC),
        Variable("THS", "seconds of piercing", _THC),
        Variable("THE", "seconds at the end", _THC),
        Variable("THD", "way of the touch-off switch", _THC),
        Variable("THL", "lift of the torch", _THC),
        Variable("THF", "velocity of the height control", _THC),
    )
}
"""Every variable of the controller by its name."""
