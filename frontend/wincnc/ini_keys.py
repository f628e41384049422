"""What gproof makes of each key of a WINCNC.INI, and what its letters are measured in.

What the manual says of a key (meaning, letters, ranges, defaults) is in ``ir/dialects/wincnc/keys.py``. Both tables
drive the reader (``machine_ini``) and the documentation (docs/dialects/wincnc-tables.md).

Kinds of values: ``length`` (in the file's unit), ``feed`` (units a minute), ``acceleration`` (units a minute a
second), ``steps`` (a unit), ``degrees``, ``seconds``, ``percent``, ``number``, ``whole``, ``switch`` (0 or 1),
``channel`` (of an input or output), ``axis`` (number of an axis, 0 for the first of axischar=), ``text`` and
``letters`` (in quotes). A range after a kind (``whole 0..3``), else that of the manual, is checked, except in keys
that are only kept. Of an axis that turns, ``length`` means degrees.

``touches`` says which jobs a letter that the manual does not name makes UNKNOWN (names of ``ir/machine.py: TOUCHES``;
``axis``: those that move its axis; ``all``: every one; ``corners``: none, but corners are then not known to be sharp;
``state``: none, but the state of its output is then not known; "": none, a warning GP602).

Treatments: ``modelled``: what a job does rests on it, and gproof follows it; ``checked``: its values are judged, and
nothing else rests on it; ``kept``: as text in ``Machine.kept``; ``unmodelled``: gproof does not follow it: where it is
on, jobs are UNKNOWN (GP605).

Source: WinCNC manual, "System Configuration", by the heading and the key.
"""

from __future__ import annotations

from collections.abc import Mapping

from gproof.ir.dialects.wincnc import keys as known
from gproof.ir.dialects.wincnc.keys import Key
from gproof.ir.record import field, record

ONCE, EACH_AXIS, MANY = "once", "each axis", "many"
"""How often a key may be in a file: with one value, with one for each axisspec= above it, as often as you like."""


@record(frozen=True, slots=True, kw_only=True)
class KeyRule:
    """A key.

    letters: kinds by letter; bare: what a value without letters is: a kind, ``=T`` for a number that stands for that
    letter's, "" where there is none; times: see ONCE; treatment: see the module; reason: what gproof does with it, or
    why nothing; touches: see the module.
    """

    key: str
    letters: Mapping[str, str] = field(default_factory=dict)
    bare: str = ""
    times: str = ONCE
    treatment: str = "kept"
    reason: str = ""
    touches: str = ""

    @property
    def named(self) -> Key:
        """What the manual says of it."""
        return known.KEYS[self.key]


def _letters(text: str) -> dict[str, str]:
    """``"P whole 0..3, O switch"`` as a table."""
    pairs = (part.strip().partition(" ") for part in text.split(","))
    return {letter: kind for letter, _, kind in pairs}


_SWITCH_AT_LIMIT = "a limit switch does not end the travel: where the axis stops is unknown"
_SHOWN = "what is shown"
_WORKSPACE = _letters("X length, Y length, T whole, R length, O degrees, M switch, A number")
_CHANGER = _letters("H length, O length, Z length, A axis, M switch")
_LIMIT = _letters("P whole, B whole, O switch, A whole, D whole")
_EXTRA_LIMIT = _letters("C whole, P whole, A whole, B whole, O switch")

_RULES = (
    KeyRule(
        key="unit", bare="text", treatment="modelled",
        reason="IN, CM or MM; the first setting of the file; without it inches",
    ),
    KeyRule(key="timertype", bare="whole 7200..7200", treatment="checked", reason="must be 7200"),
    KeyRule(
        key="axischar", bare="text", treatment="modelled",
        reason="X, Y and Z have the columns x, y, z; A, B and C theirs; W, U and V what is left of a, b, c",
    ),
    KeyRule(
        key="axisspec", touches="axis", times=EACH_AXIS, treatment="modelled",
        letters=_letters(
            "P whole, S whole, D whole, R steps, A acceleration, F acceleration, O switch, E switch,"
            " T whole, B length, K number"
        ),
        reason="R, A, F, T, B; of A and F the lower one for every move; O and E are wiring: steps count as they are",
    ),
    KeyRule(
        key="axisvel", touches="corners", times=EACH_AXIS, treatment="modelled",
        letters=_letters("R feed, F feed, S feed, M feed, H feed, A number, C feed"),
        reason="R, F; with C corners are rounded; S, M, H and A are of the keyboard",
    ),
    KeyRule(
        key="axismode", touches="axis", times=EACH_AXIS, bare="text", treatment="unmodelled",
        reason="the manual has only its name",
    ),
    KeyRule(
        key="axisadj", touches="axis", times=EACH_AXIS, treatment="unmodelled",
        letters=_letters(
            "T switch, A axis, V feed, U channel, D channel, I switch, B axis, S channel"
        ),
        reason="keys and inputs move the axis while a job runs, from the start unless I is 0",
    ),
    KeyRule(
        key="axismap", touches="moves", times=EACH_AXIS, treatment="unmodelled",
        letters=_letters("S length, E length, M length"),
        reason="the adjustments themselves are in no file that is described",
    ),
    KeyRule(
        key="altaxisspec", touches="axis", times=EACH_AXIS, treatment="modelled",
        letters=_letters("P whole, S whole, D whole, O switch, E switch"),
        reason="a second motor, for the rest like the first",
    ),
    *(
        KeyRule(key=key, times=EACH_AXIS, letters=_LIMIT, reason=_SWITCH_AT_LIMIT)
        for key in ("axislo", "axishi", "altaxislo", "altaxishi")
    ),
    *(
        KeyRule(key=key, times=MANY, letters=_EXTRA_LIMIT, reason=_SWITCH_AT_LIMIT)
        for key in ("exaltaxislo", "exaltaxishi")
    ),
    KeyRule(
        key="accel", touches="corners", letters=_letters("S number"), bare="=S", treatment="modelled",
        reason="velocities are not planned as gproof does",
    ),
    KeyRule(
        key="ad", letters=_letters("L number, H number, X number, Y number, A number, B number"),
        reason="shows the spindle's current",
    ),
    KeyRule(key="anykey", letters=_letters("A switch, P switch"), reason="keyboard"),
    KeyRule(
        key="arc_err", bare="length 0..", treatment="modelled",
        reason="the allowed difference of the radii; without it .01 in the file's unit",
    ),
    KeyRule(
        key="arc_min", bare="length 0..", treatment="modelled",
        reason="smaller arcs are lines; without it .002 in the file's unit",
    ),
    KeyRule(
        key="arcs", touches="arcs", letters=_letters("M switch, A switch"), treatment="modelled",
        reason="M1: G2 and G3 are modal; A1: I and J are positions",
    ),
    KeyRule(
        key="arctype", touches="arcs", letters=_letters("I length, M switch, O number"), treatment="modelled",
        reason="M1: G2 and G3 are modal; with I other than 0 arcs are chords, which gproof does not follow",
    ),
    *(
        KeyRule(
            key=key, letters=_CHANGER, treatment="modelled", reason="the height, sensor, axis and storage of its tools",
            touches="tools",
        )
        for key in ("atc1", "atc2")
    ),
    KeyRule(
        key="autoarcfeed", touches="corners", letters=_letters("F number, S length, L length, M feed, A degrees"),
        treatment="modelled",
        reason="velocities are not planned as gproof does",
    ),
    KeyRule(
        key="autoaux", touches="state", letters=_letters("C channel 1..64, I switch, S seconds, E seconds, T switch"),
        treatment="modelled", reason="an output that is on during feed moves",
    ),
    KeyRule(key="autodir", bare="text", reason="a folder for automatic runs"),
    KeyRule(key="autofdir", bare="text", reason="a folder for automatic runs"),
    KeyRule(
        key="autogas", letters=_letters("T whole, C whole, B whole, N number, G number, D number"),
        reason="the plasma supply's gas",
    ),
    KeyRule(key="automode", bare="whole 0..2", treatment="checked", reason="starts files that appear in a folder"),
    KeyRule(
        key="auxin", times=MANY, treatment="modelled",
        letters=_letters(
            "C channel 1..64, P whole, B whole, O switch, D whole, F whole, L whole, I switch, M text, A letters"
        ),
        reason="C: the inputs that are there; pins, debounce and the function of push buttons move nothing",
    ),
    KeyRule(
        key="auxout", touches="state", times=MANY, treatment="modelled",
        letters=_letters(
            "C channel 1..64, P whole, B whole, O switch, S switch, E switch, T whole, X switch, W switch, R switch"
        ),
        reason="C: the outputs that are there; states at start, pause and abort are not judged",
    ),
    KeyRule(key="auxoutvel", bare="percent 0..100", treatment="checked", reason="an output that follows the velocity"),
    KeyRule(
        key="backlash", touches="moves", letters=_letters("B switch, S number, F feed"), treatment="modelled",
        reason="with B0 the backlash of axisspec= is not compensated at the start; without the line it counts",
    ),
    KeyRule(key="bitmapdir", bare="text", reason=_SHOWN),
    KeyRule(key="bmpeditor", bare="text", reason=_SHOWN),
    KeyRule(key="bmpend", bare="text", reason="engraving of bitmaps is not followed"),
    KeyRule(key="bmpstart", bare="text", reason="engraving of bitmaps is not followed"),
    KeyRule(
        key="bmpoffset", letters=_letters("L number, H number, S feed, F feed"),
        reason="engraving of bitmaps is not followed",
    ),
    KeyRule(key="btnoptions", bare="switch", treatment="checked", reason=_SHOWN),
    KeyRule(key="cmdabort", bare="text", treatment="modelled", reason="a command after a job that is aborted"),
    KeyRule(key="cmdend", bare="text", treatment="modelled", reason="a command after each job"),
    KeyRule(key="cmdstart", bare="text", treatment="modelled", reason="a command before each job"),
    *(
        KeyRule(key=key, bare="text", reason="jobs are judged from their first line on")
        for key in ("cmdrestart", "cmdrestartfeed", "cmdrestartrapid")
    ),
    KeyRule(key="commatodec", bare="switch", treatment="modelled", reason="a comma is a decimal point"),
    KeyRule(
        key="comchars", touches="all", bare="text", treatment="modelled", reason="further signs that start a comment"
    ),
    KeyRule(key="comdll", bare="text", reason="a file of the program"),
    KeyRule(key="contdelay", bare="seconds 0..", treatment="checked", reason="a pause after a pause"),
    KeyRule(
        key="cutcomp", touches="compensation", letters=_letters("T switch, D number"), treatment="modelled",
        reason="neither changes that compensation by anything but nothing is UNKNOWN (G41, G42)",
    ),
    *(KeyRule(key=f"ctrlf{n}", bare="text", reason="a command of the keyboard") for n in range(1, 9)),
    KeyRule(
        key="da", letters=_letters("T whole, A number, V number, I number, C whole, R number"),
        treatment="modelled", reason="the device da: its voltage is not judged",
    ),
    KeyRule(
        key="drillbank", touches="drills", times=MANY, letters=_letters("C channel 1..64, N whole"),
        treatment="modelled", reason="the first output of a row of drills and their number",
    ),
    KeyRule(key="editor", bare="text", reason=_SHOWN),
    KeyRule(
        key="enab", times=MANY, treatment="checked",
        letters=_letters("C channel 1..64, M text, T whole, L whole, I switch, A letters"),
        reason="an input that stops the machine: jobs are judged as they run without it",
    ),
    KeyRule(key="esc_step", bare="whole 0..", treatment="checked", reason="how the escape key stops the machine"),
    KeyRule(key="filetype", bare="text", reason="names that dialogs show"),
    KeyRule(
        key="forcelim", touches="limits", treatment="modelled",
        reason="the lower corner of what a limited machine can reach; the higher value of this and lolim= counts",
    ),
    KeyRule(key="fslock", bare="switch", treatment="checked", reason="digitizing"),
    KeyRule(
        key="g08", touches="corners", letters=_letters("E switch, L length, N whole, T degrees"), treatment="modelled",
        reason="with E1 velocities are not planned as gproof does",
    ),
    KeyRule(
        key="g09", touches="corners", letters=_letters("S number, A degrees"), bare="=S", treatment="modelled",
        reason="velocities are not planned as gproof does",
    ),
    KeyRule(key="g2modal", touches="arcs", bare="switch", treatment="modelled", reason="G2 and G3 are modal"),
    KeyRule(key="g28altmove", reason="squares a gantry while homing"),
    KeyRule(key="g28check", bare="switch", treatment="checked", reason="asks the operator after homing"),
    KeyRule(key="g28checktol", reason="asks the operator after homing"),
    KeyRule(
        key="g28coord", touches="homing", treatment="modelled",
        reason="the machine position after homing; 0 where it is not given or all are 0",
    ),
    KeyRule(key="g28_lim_cnt", bare="whole 0..", treatment="checked", reason="debounce of switches"),
    KeyRule(
        key="g28move", touches="homing", times=MANY, treatment="modelled",
        letters=_letters("R length, F feed, T feed, A number, M number, L length"),
        reason="the order of homing, the path from each switch and the velocities",
    ),
    KeyRule(
        key="g37", letters=_letters("X length, Y length, I length, J length, D length, F feed"), treatment="modelled",
        reason="where tools are measured",
    ),
    *(
        KeyRule(
            key=f"g{n}", letters=_WORKSPACE, treatment="modelled", touches=f"workspaces.{n}",
            reason="type 0: its shift and whether axes move; what selects type 3 or 5 is UNKNOWN; A is not explained",
        )
        for n in range(54, 60)
    ),
    KeyRule(
        key="g81set", touches="cycles", letters=_letters("D seconds, R length, L length"), treatment="modelled",
        reason="dwell, approach and lift of drilling cycles",
    ),
    KeyRule(key="g81dwell", bare="seconds 0..", treatment="modelled", reason="dwell of drilling cycles"),
    KeyRule(key="helpfile", bare="text", reason=_SHOWN),
    KeyRule(
        key="hibound", touches="limits", treatment="modelled", reason="upper boundaries, which count workspace offsets"
    ),
    KeyRule(key="hilim", touches="limits", treatment="modelled", reason="upper limits of machine positions"),
    KeyRule(key="homedir", bare="text", reason="a folder"),
    KeyRule(key="keyfact", bare="number", reason="the licence key"),
    KeyRule(key="keypad", times=MANY, letters=_letters("C whole, B whole, P whole, S number"), reason="a hand panel"),
    KeyRule(key="keypaddir", bare="text", reason="a hand panel"),
    KeyRule(
        key="knifeangle", touches="knife", letters=_letters("A degrees, M switch, X length, Y length"),
        treatment="modelled", reason="a tilted blade, or one off its axis: L30 is then UNKNOWN",
    ),
    KeyRule(
        key="knifemode", touches="knife", treatment="modelled",
        letters=_letters(
            "T whole, A degrees, L length, Z length, P length, N axis, C channel, D seconds,"
            " M switch, R switch, V axis"
        ),
        reason="the settings of the knife, the device knife",
    ),
    KeyRule(
        key="laser", treatment="modelled",
        letters=_letters(
            "P number, D number, S switch, M length, O number, A axis, B axis, R length"
        ),
        reason="the device laser; engraving of bitmaps is not followed",
    ),
    KeyRule(
        key="laserscan", treatment="modelled",
        letters=_letters("S whole, M length, U number, W number, A axis, T whole"),
        reason="the device laserscan; scans are not followed",
    ),
    KeyRule(key="lim_cnt", bare="whole 0..", treatment="checked", reason="debounce of switches"),
    KeyRule(key="lim_mode", bare="whole 0..3", treatment="checked", reason="what a limit switch stops"),
    KeyRule(key="lim_step", bare="whole 0..", treatment="checked", reason="how a limit switch stops the machine"),
    KeyRule(
        key="lobound", touches="limits", treatment="modelled", reason="lower boundaries, which count workspace offsets"
    ),
    KeyRule(key="logdir", bare="text", reason="a folder"),
    KeyRule(key="logfile", bare="text", reason="a file"),
    KeyRule(key="lolim", touches="limits", treatment="modelled", reason="lower limits of machine positions"),
    KeyRule(key="mapping", letters=_letters("I length, R switch"), reason="of axismap=, which is not followed"),
    KeyRule(
        key="maxstepv", bare="number 1..", treatment="modelled", reason="pulses a second of an axis; without it 30000"
    ),
    KeyRule(key="maxtrans", bare="length", treatment="checked", reason="moves by hand"),
    KeyRule(key="numkp", bare="switch", treatment="checked", reason="keyboard"),
    KeyRule(
        key="nmode", bare="whole 90..91", treatment="modelled",
        reason="the distance mode at the start; without it that of the job before",
    ),
    KeyRule(
        key="override", letters=_letters("E switch, L percent, H percent, D channel, U channel"),
        treatment="modelled", reason="the range that L40 may set",
    ),
    KeyRule(key="portin", times=MANY, bare="port", treatment="checked", reason="addresses of the computer"),
    KeyRule(key="portout", times=MANY, bare="port", treatment="checked", reason="addresses of the computer"),
    KeyRule(
        key="pci48h", letters=_letters("A whole, B whole"), treatment="checked", reason="pins of a card"
    ),
    KeyRule(key="pci24h", letters=_letters("A whole"), treatment="checked", reason="pins of a card"),
    KeyRule(
        key="positions", touches="stored", letters=_letters("P whole, H whole, T whole, W switch"),
        treatment="modelled", reason="how many positions can be stored",
    ),
    KeyRule(
        key="pumpcont", letters=_letters("T whole, L feed, H feed, A number, B number, I number, R number"),
        treatment="modelled", reason="the device pump: what it delivers is not judged",
    ),
    KeyRule(key="pwm", letters=_letters("F number, M percent"), reason="a signal of the laser"),
    KeyRule(key="quadmode", bare="whole 0..1", treatment="checked", reason="the form of the drives' signals"),
    KeyRule(
        key="rapid_lock", bare="switch", treatment="modelled",
        reason="0: with L40 the times of rapids are not known; the operator may slow down G0",
    ),
    KeyRule(key="rapidjog", bare="switch", treatment="checked", reason="moves by hand"),
    KeyRule(key="restart", letters=_letters("V switch"), reason="jobs are judged from their first line on"),
    KeyRule(
        key="sawmode", touches="saw", letters=_letters("T whole, A axis, R length, O degrees, Z length"),
        treatment="modelled", reason="the device saw; L32 is UNKNOWN",
    ),
    KeyRule(
        key="scan", touches="probe", treatment="modelled",
        letters=_letters(
            "T whole, A axis, C channel 1..64, S whole, H length, F feed, P number, D whole"
        ),
        reason="the device probe and its input; scans are not followed",
    ),
    KeyRule(
        key="signal", times=MANY, treatment="checked",
        letters=_letters("C channel 1..64, M text, T whole, I switch"),
        reason="a push button: jobs are judged as they run without it",
    ),
    KeyRule(
        key="skipchars", touches="all", times=MANY, letters=_letters("C text, N whole"), treatment="modelled",
        reason="signs at the start of a line that make lines be left out",
    ),
    KeyRule(
        key="softlim", touches="limits", letters=_letters("T whole, M switch, B switch, V switch"), bare="=T",
        treatment="modelled", reason="limits and boundaries at the start, and what is done beyond them",
    ),
    KeyRule(
        key="spinchar", touches="all", bare="text", treatment="unmodelled",
        reason="another letter than S sets the spindle",
    ),
    KeyRule(
        key="spindle", letters=_letters("T whole, R number, I number"), treatment="modelled",
        reason="the device spindle; R: its highest speed",
    ),
    KeyRule(
        key="steppulse", letters=_letters("P number, D number"), treatment="modelled",
        reason="microseconds of a pulse, and of the direction before it; 5 and 5 without it",
    ),
    KeyRule(
        key="table", letters=_letters("X length, Y length, W length, H length, B length, Z whole"), reason=_SHOWN
    ),
    KeyRule(
        key="thc", touches="torch", treatment="modelled",
        letters=_letters(
            "A axis, F feed, V number, S seconds, E seconds, P percent, O channel, I channel,"
            " D length, L length, T number, C seconds, W seconds, M number"
        ),
        reason="the settings of the torch, the device thc; the path of the torch by voltage is not modelled",
    ),
    KeyRule(key="thcauto", bare="switch", treatment="checked", reason=_SHOWN),
    KeyRule(key="thcdiv", letters=_letters("M number, B number"), reason="the torch's voltage"),
    KeyRule(key="thcdisab", times=MANY, letters=_letters("V number, T seconds"), reason="the torch's voltage"),
    KeyRule(key="thclim", letters=_letters("L number, H number"), reason="the torch's voltage"),
    KeyRule(key="thcvel", times=MANY, letters=_letters("F feed, V number"), reason="the torch's voltage"),
    KeyRule(
        key="torchbevel", touches="torch", letters=_letters("B axis, C axis, R length"), treatment="modelled",
        reason="the device bevel; bevelled cuts are not followed",
    ),
    KeyRule(key="tranadj", bare="number 0..", treatment="checked", reason="moves by hand"),
    KeyRule(
        key="vgroup", times=MANY, bare="text", treatment="modelled",
        reason="axes that share a feed; after F: those whose feed an F without axes sets",
    ),
    KeyRule(
        key="vmatch", touches="corners", letters=_letters("P number, T number"), treatment="modelled",
        reason="velocities are not planned as gproof does",
    ),
    KeyRule(key="watch", times=MANY, letters=_letters("T whole, D number, C channel"), reason="a signal of life"),
    KeyRule(key="xhc", letters=_letters("T whole, D number, S number"), reason="a hand panel"),
)  # fmt: skip

KEYS: dict[str, KeyRule] = {rule.key: rule for rule in _RULES}
"""By key, lower case, in the manual's order."""

OF_AXIS = frozenset(name for name, key in known.KEYS.items() if key.of == "axisspec")
"""Keys that belong to the axisspec= above them (the manual marks them with an asterisk)."""
