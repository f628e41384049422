"""McuWinSettings: what a McuWIN controller is set up to do, where it changes a job. Units as of ``ir/settings.py``.

Sections are those of the APCI-8001 G-code manual, McuWIN V 2.5.3.133.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gproof.ir.record import record
from gproof.ir.settings import Settings

if TYPE_CHECKING:
    from gproof.ir.machine import Machine

VERSIONS = ("2.5.3.133", "2.5.3.32")
"""Versions of McuWIN that gproof knows, the default first."""

FIRST_USER_CODE, LAST_USER_CODE = 200, 299
"""Codes G200 to G299 and M200 to M299 are the application's own (4, 14)."""

ACTIONS = (
    "spindle_cw", "spindle_ccw", "spindle_off", "spindle_speed", "tool_select", "tool_change", "coolant_on",
    "coolant_off", "stop", "end", "home", "nothing", "unknown",
)  # fmt: skip
"""What a machine file may say that Task 0 does for a code; ``unknown``: it may move axes or change anything."""


USUAL = {
    "pre_include": "no file is compiled before the job (PreInclude, 12)",
    "post_include": "no file is compiled after the job (PostInclude, 12)",
    "shortest_path": "rotary axes do not take the shortest path to a place (14 (2.5.3.75))",
    "tool_file": "no tool table is loaded (2.7)",
    "error_compensation": "no compensation file of spindle or angle errors is in McuWIN's folder (2.8)",
}
"""Settings of IniCfg that change a job and of which the usual value is taken when no file states them: what that is."""


@record(frozen=True, slots=True, kw_only=True)
class TaskCode:
    """What the application code in Task 0 does for one code (4, 5.2).

    code: as written without leading zeros: ``M3``, ``G210``, ``S``; action: one of ACTIONS; breaks: it ends a contour
    of spooled moves, None: not stated; parameters: how many it takes, None: not stated.
    """

    code: str
    action: str = "unknown"
    breaks: bool | None = None
    parameters: int | None = None


@record(frozen=True, slots=True, kw_only=True)
class RadiusTool:
    """A record of ToolComp.INI (2.7). plane: ``xy``, ``yz`` or ``zx``; radius, length: mm, None: not in the file."""

    plane: str
    number: int
    radius: float | None = None
    length: float | None = None


@record(frozen=True, slots=True, kw_only=True)
class McuWinSettings(Settings):
    """See the module's text.

    version: one of VERSIONS.
    case_sensitive: names and words (14, 2.5.3.30), None: not stated.
    line_numbers: every line needs one.
    time_unit: seconds in the unit of feeds, 60 or 1 (IniCfg).
    absolute_centers: what IniCfg has for centres in G90 (3.3, 3.35).
    interpolation_axes: letters at the start, as programs have them, ``XYZ`` (3.20).
    tools: of ToolComp.INI; None: no machine file is given; (): there is none, or none with tools: no T, no G41 (2.7,
    5.5).
    tasks: what Task 0 does; None: nothing is stated.
    angle_unit: ``radians`` or ``degrees`` of the functions of rw_SymPas; wait_unit: seconds in the unit of wt.
    program_size: bytes that a compiled program may have (SZTSK3, 13.1.1.13).
    pre_include, post_include: files that are compiled before and after each job, relative to the machine file.
    keeps_over_codes: a bare line goes on with the last motion even after another G code or a ``$`` line.
    g60: a second G60, and one after moves, counts where it runs, ``run``, or not at all, ``once`` (3.20, 14
    (2.5.3.78)); empty: not stated.
    channels: axis channels of the board, which M26 and M27 number (4.11), None: not stated.
    unstated: those of ``USUAL`` that no file states.
    foreign: tables of the machine file that state settings of another controller.
    Of ``Settings``: position_unit is mm in one interpolation unit, usually 1 (3.22); zero_offsets the table of mcfg,
    columns of axes that the machine does not have 0 (3.19); arc_tolerance is always known.
    """

    version: str = VERSIONS[0]
    case_sensitive: bool | None = None
    line_numbers: bool = False
    time_unit: float | None = None
    absolute_centers: bool | None = None
    interpolation_axes: str | None = None
    tools: tuple[RadiusTool, ...] | None = None
    tasks: tuple[TaskCode, ...] | None = None
    angle_unit: str = "radians"
    wait_unit: float = 0.001
    arc_tolerance: float = 0.001
    program_size: int = 100_000
    pre_include: str = ""
    post_include: str = ""
    keeps_over_codes: bool = False
    channels: int | None = None
    g60: str = ""
    unstated: tuple[str, ...] = tuple(USUAL)
    foreign: tuple[str, ...] = ()

    def task(self, code: str) -> TaskCode | None:
        """What is stated of a code."""
        return next((task for task in self.tasks or () if task.code == code), None)


NO_MCUWIN_SETTINGS = McuWinSettings()


def mcuwin_settings(machine: Machine) -> McuWinSettings:
    """The settings of a McuWIN machine; the usual ones where the machine's files state those of none."""
    own = machine.settings
    return own if isinstance(own, McuWinSettings) else NO_MCUWIN_SETTINGS
