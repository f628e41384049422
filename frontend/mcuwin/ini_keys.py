"""The keys of McuWIN.ini that the manual names, and what gproof makes of each.

Source: APCI-8001 G-code manual, McuWIN V 2.5.3.133. The manual names few keys, and of many settings only that they can
be set in IniCfg; ``SETTINGS`` are those. What a setting without a key is, ``[din]`` of gproof's own file states.
"""

from __future__ import annotations

import re

from gproof.ir.record import record


@record(frozen=True, slots=True)
class IniKey:
    """A key. shown: as the manual writes it, ``?`` for a digit, with its section where the manual gives one."""

    shown: str
    meaning: str
    source: str

    def fits(self, section: str, key: str) -> bool:
        """True for a folded section and key that this row is about."""
        where, _, name = self.shown.casefold().rpartition("] ")
        if len(key) != len(name) or where not in ("", f"[{section}"):
            return False
        return all(one == other or (other == "?" and one in "0123456789") for one, other in zip(key, name, strict=True))


KEPT = (
    IniKey("[MCU] ProtocolFileName", "file of error messages and warnings", "14 (2.5.3.107)"),
    IniKey("[MCU] MessageTask?Continue", "OK in a task's window goes on from single steps", "5.7"),
    IniKey("[EDITOR] EditorFontSize", "size of characters in the editor", "14 (2.5.3.107)"),
    IniKey("[Project data] SelectedCardNr", "the board that is used", "14 (2.5.3.99)"),
    IniKey("ReferenceSwitchLatch", "check of the latch of the reference switch", "14 (2.5.3.24)"),
    IniKey("NoRefToLimitSwitch", "reference run on the index track only", "14 (2.5.3.24)"),
    IniKey("FreeingVelFactor", "velocity of freeing moves of the reference run", "14 (2.5.3.24)"),
    IniKey("InhibitProfileRefuse", "a warning is shown for a velocity or acceleration of 0", "14 (2.5.3.95)"),
)
"""Keys that change nothing of where a job moves the axes."""

KEPT_SECTIONS = r"fehlertexte.*|errortexts.*"
"""Texts of error messages (14, 2.5.3.103 and 2.5.3.107)."""
_KEPT_SECTION = re.compile(KEPT_SECTIONS)


@record(frozen=True, slots=True)
class IniSetting:
    """A setting of IniCfg that the manual describes without a key.

    stated_by: the key of ``[din]`` that states it; names: a pattern of what a folded key that may hold it has in it.
    usual: left unsaid, gproof takes the usual value for it and not "not known", so that a key which may hold it makes
    the answer UNKNOWN until the setting is stated.
    """

    what: str
    stated_by: str
    names: str
    source: str
    usual: bool = False


SETTINGS = (
    IniSetting("the file of the tool table", "tool_file", r"tool_?(?:comp)?_?file", "2.7, 14 (2.5.3.96)", True),
    IniSetting("the file compiled before each job", "pre_include", r"pre_?include", "12, 14 (2.5.3.90)", True),
    IniSetting("the file compiled after each job", "post_include", r"post_?include", "12, 14 (2.5.3.90)", True),
    IniSetting("the path of rotary axes, shortest or not", "shortest_path", r"short", "14 (2.5.3.75)", True),
    IniSetting("the need for line numbers", "line_numbers", r"line_?num", "14 (2.5.3.24)", True),
    IniSetting("the unit of positions", "position_unit", r"pos\w*_?unit", "14 (2.5.3.30)", True),
    IniSetting("the unit of time", "time_unit", r"time_?unit", "14 (2.5.3.30)"),
    IniSetting("case-insensitive mode", "case_sensitive", r"case_?(?:in)?sens", "14 (2.5.3.30)"),
    IniSetting("centres in G90, relative or absolute", "absolute_centers", r"cent(?:er|re)", "3.3, 3.35"),
    IniSetting("depth of look-ahead", "", r"look_?ahead|no_?triangle", "14 (2.5.3.16, .31)"),
    IniSetting("axes in open loop", "", r"open_?loop", "14 (2.5.3.76)"),
)


def kept(section: str, key: str) -> bool:
    """True for a folded section and key that the manual names and that has no bearing on a job's moves."""
    return _KEPT_SECTION.fullmatch(section) is not None or any(row.fits(section, key) for row in KEPT)


def setting_of(key: str) -> IniSetting | None:
    """The setting that a folded key may hold by its name."""
    return next((row for row in SETTINGS if re.search(row.names, key)), None)
