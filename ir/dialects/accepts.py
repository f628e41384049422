"""What a controller takes beyond its manual, where a shop says so: ``accepts`` of a machine file's ``[controller]``.

One row for each name. The reader of machine files, the hints of findings and docs/machine-files.md use this table
(tests/docs/test_accepts.py). Without its entry a job is judged by the manual alone.
"""

from __future__ import annotations

from gproof.ir.record import record

MANUALS = {"eding": "Eding CNC manual 4.01", "wincnc": "WinCNC Users Guide", "mcuwin": "McuWIN manual 2.5.3.133"}
"""What judges a dialect; where a shop states another version of its controller, that is an assumption."""
ANY = ("eding", "wincnc")


@record(frozen=True, slots=True)
class Accepted:
    """A fact that a shop may state.

    name: as machine files have it; dialects: of whose controllers it may be said; means: what the controller then
    does, which is also the assumption that is printed where a job needed it; source: the place of the manual that does
    not have it, and who has; codes: numbers of the findings that name it in their hint; against: the entry that says
    the opposite, "" where none does.
    """

    name: str
    dialects: tuple[str, ...]
    means: str
    source: str
    codes: tuple[int, ...]
    against: str = ""

    @property
    def assumption(self) -> str:
        """How reports say that a job needed it."""
        return f"{self.means} (accepts {self.name})"

    @property
    def hint(self) -> str:
        """How findings name it."""
        return f'state accepts = ["{self.name}"] under [controller] of the machine file if this controller accepts it'


MOTION_ALONE = Accepted(
    "motion-alone",
    ("eding",),
    "a motion code without axis words sets the mode and moves nothing",
    "Eding 3.4.1, 3.4.2 require an axis word; change_tool of the macro files that come with V4.02 and V4.03 ends so",
    (201,),
)
MESSAGE_FORMATS = Accepted(
    "message-formats",
    ("eding",),
    "a format such as %d after the parts of a message only changes the form of its text",
    "Eding 4.2 has texts and values only",
    (101,),
)
DIGIT_NAMES = Accepted(
    "digit-names",
    ("eding",),
    "names of subprograms may start with a digit",
    "Eding 4.1 shows names that start with a letter",
    (124,),
)
USER_MACRO_FILE = Accepted(
    "user-macro-file",
    ("eding",),
    "user_macro.cnc is loaded with macro.cnc; of two subprograms with one name the one in user_macro.cnc counts",
    "Eding 4.3 has macro.cnc only; V4.03 has both",
    (115, 605),
)
USUAL_PRECEDENCE = Accepted(
    "usual-precedence",
    ("eding",),
    "operators are performed in this order: **, * / mod, + -, << >>, comparisons, band bor bxor, and or xor",
    "Eding 3.2.2.3 groups nine operators, and/or/xor with + and -; 4.2 lists the others without a place among them",
    (230,),
)
KEPT_MOTION = Accepted(
    "kept-motion",
    ANY,
    "axis words before the first motion code are straight moves, in the mode that the last job left; judged as G0",
    "Eding 3.3, WinCNC G0 and G1: modes stay; they do not mention the next file",
    (202,),
)
SHOWN_TOOLS = Accepted(
    "shown-tools",
    ("eding",),
    "a dialog that has #5008 or #5011 among its values only shows them; the operator does not change them there",
    "Eding 4.2 has dialogs for free variables; macros of real shops show the number of the tool to insert",
    (113,),
)
WRITTEN_TOOLS = Accepted(
    "written-tools",
    ("eding",),
    "a number that is written to #5011 is the new tool, one written to #5008 the tool in the spindle",
    "Eding 3.1.1 shows both, but no command that writes them; macros of V4.03 write them",
    (113,),
)
SCALED_Z = Accepted(
    "scaled-z",
    ("eding",),
    "G51 P scales Z as it scales X and Y, about the zero of the program",
    "Eding 3.4.13 names no axes, and no point for Z",
    (276, 304),
    "unscaled-z",
)
UNSCALED_Z = Accepted(
    "unscaled-z",
    ("eding",),
    "G51 P scales X and Y, and leaves Z as it is",
    "Eding 3.4.13 names no axes, and no point for Z",
    (276, 304),
    "scaled-z",
)
READINGS_OF_Z = (
    f'state accepts = ["{SCALED_Z.name}"] or accepts = ["{UNSCALED_Z.name}"] under [controller] of the machine file'
)
"""Hint of findings that rest on both."""
SHOWN_POSITION = Accepted(
    "l20-shown",
    ("eding",),
    "after G10 L20 positions read the numbers that it gave: an active G92 offset and tool length are taken out",
    'Eding 3.4.5 has "actual machine position", and "similar to G92", which takes both out',
    (304,),
    "l20-machine",
)
MACHINE_POSITION = Accepted(
    "l20-machine",
    ("eding",),
    "G10 L20 counts from the machine position, whatever G92 offset and tool length are active",
    'Eding 3.4.5 has "actual machine position", and "similar to G92", which takes both out',
    (304,),
    "l20-shown",
)
READINGS_OF_L20 = (
    f'state accepts = ["{SHOWN_POSITION.name}"] or accepts = ["{MACHINE_POSITION.name}"] under [controller] of the '
    "machine file"
)
"""Hint of findings that rest on both."""
TOOL_ZERO = Accepted(
    "tool-zero",
    ("eding",),
    "#5400, #5500, #5600 and #5700 are numbers of tool 0; the controller uses none of them",
    "Eding 3.1.1 lists the numbers of tools 1 to 99, and says below that the table has tools 0 to 99",
    (113,),
)
LONG_DIALOGS = Accepted(
    "long-dialogs",
    ("eding",),
    "a dialog may have more than 12 values",
    "Eding 4.2 has 12; the macro files that come with V4.03 have 15",
    (113,),
)
TOOL_INFO = Accepted(
    "tool-info",
    ("eding",),
    "GetToolInfo puts a number about the tools of the loaded job into a variable, and moves nothing",
    "not in Eding 4.2; the macro files that come with V4.03 use it",
    (113,),
)
MODBUS = Accepted(
    "modbus",
    ("eding",),
    "Modbus commands move no axis; the values that they read from other devices are unknown",
    "not in Eding 4.2; macro files of V4.03 use them",
    (113,),
)
PC_PROGRAMS = Accepted(
    "pc-programs",
    ("eding",),
    "Exec runs a program of the PC and puts its answer into #5399; no axis moves",
    "not in Eding 4.2; macro files of machine makers use it",
    (113,),
)
HEIGHT_COMMANDS = Accepted(
    "height-commands",
    ("eding",),
    "ZHC ON and ZHC OFF switch the height map, ZHCINITEX starts one with two steps, ZHCCHECK only shows it",
    "Eding 2.2.5.5 has zhcinit, zhcaddpoint and zhcs; the macro files that come with V4.03 use these, too",
    (113,),
)
REPEATED_CHANNEL = Accepted(
    "repeated-channel",
    ("wincnc",),
    "each C of an M11 or M12 is a channel that it switches",
    "WinCNC M11, M12 have one C; real installations have lines of the form M11 C1 C2",
    (109,),
)
TEXT_AFTER_COMMENT = Accepted(
    "text-after-comment",
    ("wincnc",),
    "words after a closed comment are executed",
    "WinCNC, Parameters in [Brackets]: the closing bracket is optional; nothing about the text after it",
    (134,),
)
LINE_NUMBERS = Accepted(
    "line-numbers",
    ("wincnc",),
    "an N with a whole number at the start of a line is its number and does nothing",
    "WinCNC has no N of its own; post-processors for it can number each line",
    (113,),
)

ACCEPTS = {
    row.name: row
    for row in (
        MOTION_ALONE,
        MESSAGE_FORMATS,
        DIGIT_NAMES,
        USER_MACRO_FILE,
        USUAL_PRECEDENCE,
        KEPT_MOTION,
        SHOWN_TOOLS,
        WRITTEN_TOOLS,
        SCALED_Z,
        UNSCALED_Z,
        SHOWN_POSITION,
        MACHINE_POSITION,
        TOOL_ZERO,
        LONG_DIALOGS,
        TOOL_INFO,
        MODBUS,
        PC_PROGRAMS,
        HEIGHT_COMMANDS,
        REPEATED_CHANNEL,
        TEXT_AFTER_COMMENT,
        LINE_NUMBERS,
    )
}
"""Name -> row, in the order of the documentation."""


def names_of(dialect: str | None) -> tuple[str, ...]:
    """The entries that a machine file may have for a dialect; all where it does not say which."""
    return tuple(name for name, row in ACCEPTS.items() if dialect is None or dialect in row.dialects)
