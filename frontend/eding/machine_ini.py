"""The controller's own machine file, ``cnc.ini``: sections of ``key = value`` lines, and the tables next to it.

Source: Eding CNC manual 4.01, 2.1 (what the settings mean), 2.3 and 2.4 (tables), 2.1.11 and 2.1.14 (keys that are
only in the file), 3.5.6 (spindles). docs/machine-files.md lists every key and says which names the manual gives.
Keys that have nothing to do with positions are kept as they are; one that is not known at all is kept and reported
once (GP602); a setting that is on and that gproof cannot follow goes into ``Machine.not_modelled``.
"""

from __future__ import annotations

import hashlib
import itertools
import math
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from gproof.frontend.common.exact_numbers import MILLIMETRES, TINIEST
from gproof.frontend.common.paths import is_file
from gproof.frontend.common.source import decode
from gproof.frontend.eding.correction_table import load_table
from gproof.frontend.eding.ini_file import NUMBERED, Ini
from gproof.frontend.eding.spindles_ini import read_spindles
from gproof.ir import codes
from gproof.ir.dialects.eding.settings import EdingSettings
from gproof.ir.finding import Findings, Span
from gproof.ir.machine import (
    AXIS_NAMES,
    Area,
    Axis,
    AxisKind,
    Controller,
    Knife,
    Machine,
    PitchTable,
    Slave,
    Spindle,
    Tool,
    Unmodelled,
)

Files = list[tuple[str, str]]

_SETTINGS: dict[str, tuple[str, tuple[str, ...]]] = {
    "units": ("GENERAL", ("units",)),
    "inch": ("GENERAL", ("inchModeActive",)),
    "version": ("GENERAL", ("version", "softwareVersion")),
    "max_step_frequency": ("GENERAL", ("maxStepFrequency",)),
    "laf_angle": ("TRAJECTORY", ("lafMinimumAngle", "lafAngle")),
    "interpolation_time": ("TRAJECTORY", ("interpolationTime",)),
    "fifo_time": ("TRAJECTORY", ("fifoTime",)),
    "auto_tool_change": ("USERINTERFACE", ("autoToolChange", "noHaltForToolChange")),
    "turning": ("USERINTERFACE", ("isTurningMachine",)),
    "homing_mandatory": ("USERINTERFACE", ("homingMandatory", "mandatoryHoming")),
    "home_is_stop": ("SAFETY", ("homeSensorIsEStop", "homeIsEstopAfterHomingAllAxes")),
    "safety_feed": ("SAFETY", ("safetyFeed",)),
    "absolute_arc_centers": ("INTERPRETER", ("absoluteCenterCoords",)),
    "diameter_programming": ("INTERPRETER", ("diameterProgramming",)),
    "extruder": ("INTERPRETER", ("is3DPrinter",)),
    "macro_file": ("INTERPRETER", ("macroFileName",)),
    "super_long_file": ("USERINTERFACE", ("superLongFileModeCriterion",)),
    "knife_angle": ("TANKNIFE", ("tanKnifeAngle", "tanKnifeAngleForLiftUp")),
    "knife_lift": ("TANKNIFE", ("tanKnifeZUpDistance", "tanKnifeLiftUpDistance")),
    "knife_blend_angle": ("TANKNIFE", ("tanKnifeBlendAngle",)),
    "knife_blend_distance": ("TANKNIFE", ("tanKnifeBlendDistance",)),
    "z_down_tool_length": ("TCA", ("zDownToolLength",)),
}
"""Settings by our name: the section and the names under which a file may have them; any other section will do."""

_SWITCHES = {
    "is3DPrinter": "is3DPrinter",
    "g4InMilliseconds": "g4InMilliseconds",
    "initialString": "initialString",
    "crossCompensationOn": "crossCompensationOn",
}
"""Switches that change what words mean or where axes go, and that gproof does not follow."""

_KEPT = (
    "xnegativelimit xpositivelimit ynegativelimit ypositivelimit znegativelimit zpositivelimit showinprogspeed"
    " showinprogspeedanamulfactor homeinputsenselevel endofstrokeinputsenselevel usexhomeinputforallaxes"
    " useonlyhomexforallaxes estopinputsenselevel1 estopinputsenselevel2 exterrinputsenselevel"
    " exterrorinputsenselevel safetyinputportid feedoverrideinput feedholdinput speedoverrideinput speedholdinput"
    " longfilemodecriterion g0velocityfactor g0accelelerationfactor lafaccfilter"
    " mincirclesegmentsize usermacrofilename storeprobepoints storeprobetouchpoints usehomeinput4"
    " probeusehomeinput4 probetouchpointfilename language connection ethernet password setuppassword invertjogkeys"
    " showstartupscreen simplezeroing showmaximized showm7 showm8 shutdownonfatal favoriteeditor icondirectory"
    " opengl openglpensize useopengl watchfilechanged loadautomatically runautomatically filename correctionfactor"
    " restimateruntime timeestimatefactor stoponpause stopspindleonpause mistisspindledirection isstepper"
    " issteppermotor smoothstep countsperrev comportname"
).split()
"""Keys without any bearing on where the axes go in a job; kept as text."""

_NUMBERED_KEYS = {
    "JOINT": (
        "name visible isvisible portid cpuportindex resolution stepsperappunit positivelimit negativelimit maxvelocity"
        " maxacceleration homevelocity homevelocityslow homeposition backlash mode lowspeedjogpercent"
        " medspeedjogpercent highspeedjogpercent pitchcompensationon pitchcompensationfilename crosscompensationon"
        " crosscompensationfilename"
    ).split(),
    "SPINDLE": (
        "spindlenmax spindlenmin spindlerampuptime spindleuserpmsensor onoffoutputportid directionoutputportid"
        " pwmoutputportid spindlereadyportid pwmcompensationon pwmcompensationfilename xoffset yoffset zoffset"
        " issteppermotor smoothstep countsperrev stoponpause mistisspindledirection"
    ).split(),
    "TOOL": "zoffset xoffset diameter orientation id description".split(),
}

_PASSED_OVER = ("GPIO", "CAMERA", "HANDWHEEL", "IO", "TRAFFIC", "LANGUAGE", "SAFETY", "PROBING", "THC", "PRINTER")
"""Beginnings of section names with nothing about positions: names of inputs, colours, the hand wheel."""

_MODES = {
    "ROT": "",
    "0": "",
    "4THMILL": "tip_feed",
    "4TH MILL": "tip_feed",
    "TANGENTIAL KNIFE": "knife",
    "TANKNIFE": "knife",
    "TAN KNIFE": "knife",
}
"""Modes of A, B and C (2.1.3) that gproof follows; SLAVE X, Y and Z besides."""

_OTHER_MODES = {
    "FOAM CUT": ("A is the other side of the wire, and the manual does not say how it moves with them", "a"),
    "2ND Z": ("A is a second Z, and the manual does not say what tool lengths do to it", "a"),
    "TANGENTIAL KNIFE": ("only B and C can turn a knife", "a"),
    "TANKNIFE": ("only B and C can turn a knife", "a"),
    "TAN KNIFE": ("only B and C can turn a knife", "a"),
}
"""Modes of A (2.1.3) that gproof does not follow: why, and the axis whose place rests on it."""
_NO_MODE = "not one of the modes of 2.1.3"

_WHY = {"is3DPrinter": ("A is the extruder, which words E move", "a")}
"""Of ``_SWITCHES``: why gproof does not follow it, and the axis whose place rests on it."""

_KINEMATICS = {
    "2": "state [cylinder] in a setup file: Y is mapped onto A",
    "3": "virtual C (the manual gives only its name)",
}
"""Kinematics by their number (3.1.1, #5150)."""

MAX_TOOL = 99


def load_ini(path: Path, findings: Findings) -> tuple[Machine | None, Files]:
    """The machine in a ``cnc.ini``, and (name, sha256) of the files read; None, with findings, when one is bad."""
    name = str(path)
    try:
        raw = path.read_bytes()
    except OSError as error:
        findings.add(codes.FILE_UNREADABLE.at(Span(name, 0), what=f"{name}: {error.strerror or error}"))
        return None, []
    files = [(name, hashlib.sha256(raw).hexdigest())]
    if b"\0" in raw:
        findings.add(codes.FILE_UNREADABLE.at(Span(name, 0), what=f"{name}: not a text file"))
        return None, files
    ini = Ini(name, findings)
    ini.parse(decode(raw.removeprefix(b"\xef\xbb\xbf")))
    if not ini.sections and not ini.errors:
        ini.add(codes.MISSING_KEY, 0, key="[GENERAL] and [JOINT_0]")
    reader = _Reader(ini, path, files)
    machine = reader.machine()
    _report_unknown(ini)
    if ini.errors:
        return None, files
    machine = replace(machine, unknown_keys=tuple(ini.unknown), kept=_kept(ini))
    machine.verify()
    return machine, files


class _Reader:
    """From the values of a file to a Machine."""

    def __init__(self, ini: Ini, path: Path, files: Files) -> None:
        self.ini = ini
        self.path = path
        self.files = files
        self.not_modelled: list[Unmodelled] = []
        self.places = {name: ini.where(section, *keys) for name, (section, keys) in _SETTINGS.items()}
        units = (self.text("units") or ("inch" if self.switch("inch") else "mm")).lower()
        if units not in MILLIMETRES:
            place = self.places["units"]
            assert place is not None
            ini.bad(*place, f"{units!r} is not one of {', '.join(MILLIMETRES)}")
        self.unit = MILLIMETRES.get(units, Fraction(1))
        self.knife: str | None = None

    def text(self, name: str) -> str | None:
        """A setting of ``_SETTINGS`` as text; None when it is not there or empty."""
        place = self.places[name]
        return (self.ini.text(*place) or None) if place is not None else None

    def switch(self, name: str) -> bool:
        """A setting of ``_SETTINGS`` as a switch."""
        place = self.places[name]
        return place is not None and self.ini.switch(*place)

    def stated(self, name: str) -> bool | None:
        """A switch, or None when the file does not have it."""
        return None if self.places[name] is None else self.switch(name)

    def rate(self, name: str) -> float | None:
        """A setting that is greater than 0."""
        place = self.places[name]
        return None if place is None else self.ini.rate(*place)

    def at_least_0(self, name: str, unit: Fraction = Fraction(1)) -> float | None:
        """A setting that is not negative."""
        place = self.places[name]
        return None if place is None else self.ini.at_least(*place, 0.0, unit)

    def machine(self) -> Machine:
        ini = self.ini
        axes = self._axes()
        for section, values in ini.sections.items():
            for key, value in values.items():
                shown = next((shown for shown in _SWITCHES if shown.lower() == key), None)
                if shown is not None and value.text not in ("", "0"):
                    why, axis = _WHY.get(shown, ("", ""))
                    self._open(section, key, shown, why, axis)
        kinematics = self._kinematics()
        place = self.places["z_down_tool_length"]
        return Machine(
            name=self.path.name,
            axes=axes,
            tool_change_area=_tool_change_area(ini, self.unit),
            tools=_tools(ini, self.unit),
            spindles=self._spindles(),
            controller=self._controller(),
            settings=self._settings(),
            unit=float(self.unit),
            not_modelled=tuple(self.not_modelled),
            kinematics=kinematics,
            knife=self._knife(),
            z_down_tool_length=None if place is None else ini.number(*place, self.unit),
        )

    def _open(self, section: str, key: str, what: str, why: str = "", axis: str = "") -> None:
        """A setting that is on and that gproof does not follow."""
        value = self.ini.sections.get(section, {}).get(key.lower())
        self.not_modelled.append(
            Unmodelled(f"[{section}] {what}", why, axis, self.path.name, 0 if value is None else value.line)
        )

    def _kinematics(self) -> str:
        """The name of the kinematics when they are not trivial (2.1.7)."""
        for section, values in self.ini.sections.items():
            for key, value in values.items():
                trivial = value.text.lower() in ("", "0", "1", "trivial")
                if (section.startswith("KIN") or key.startswith("kin")) and not trivial:
                    why = _KINEMATICS.get(value.text, "the manual does not describe it")
                    self._open(section, key, f"{value.key} = {value.text}", why)
                    return value.text
        return "trivial"

    # -- axes

    def _axes(self) -> tuple[Axis, ...]:
        """The axes that are mapped to a port or visible; second motors go to the axes that they follow."""
        axes: dict[str, Axis] = {}
        slaves: list[tuple[str, int]] = []
        for index, name in enumerate(AXIS_NAMES):
            section = f"JOINT_{index}"
            if section not in self.ini.sections or not self._is_used(section):
                continue
            mode = " ".join((self.ini.text(section, "mode") or "ROT").upper().split()) if index >= 3 else "ROT"
            if mode.startswith("SLAVE"):
                slaves.append((mode.removeprefix("SLAVE").strip().lower(), index))
                continue
            what = _MODES.get(mode)
            if what is None or (what == "knife" and name == "a"):
                self._open(section, "mode", f"mode = {mode}", *_OTHER_MODES.get(mode, (_NO_MODE, "")))
            linear = index < 3 or mode in ("FOAM CUT", "2ND Z")
            axes[name] = self._axis(section, name, AxisKind.LINEAR if linear else AxisKind.ROTARY)
            if what == "tip_feed":
                axes[name] = replace(axes[name], tip_feed=True)
            elif what == "knife":
                self.knife = name
        for master, index in slaves:
            if master not in axes or axes[master].kind is not AxisKind.LINEAR:
                self.ini.bad(f"JOINT_{index}", "mode", f"there is no axis {master.upper() or '(none)'} to follow")
                continue
            slave = self._slave(f"JOINT_{index}", AXIS_NAMES[index], axes[master])
            axes[master] = replace(axes[master], slaves=(*axes[master].slaves, slave))
        return tuple(axes.values())

    def _is_used(self, section: str) -> bool:
        """Mapped to a port, or visible; an axis that is mapped and not visible can be used (2.1.3)."""
        ini = self.ini
        visible_key = "visible" if ini.text(section, "visible") is not None else "isVisible"
        visible = ini.switch(section, visible_key)
        if ini.text(section, "portID") is not None:
            value, first = ini.exact(section, "portID"), 1
        elif ini.text(section, "cpuPortIndex") is not None:
            value, first = ini.exact(section, "cpuPortIndex"), 0
        else:
            return visible or ini.text(section, visible_key) is None
        return visible or (value is not None and value >= first)

    def _axis(self, section: str, name: str, kind: AxisKind) -> Axis:
        """An axis with its own motor."""
        motor = self._slave(section, name, Axis(name=name, kind=kind))
        return Axis(
            name=name,
            kind=kind,
            steps_per_unit=motor.steps_per_unit,
            lower=motor.lower,
            upper=motor.upper,
            max_velocity=motor.max_velocity,
            max_acceleration=motor.max_acceleration,
            backlash=motor.backlash or 0.0,
            pitch=motor.pitch,
            home_position=motor.home_position,
            home_velocity=motor.home_velocity,
        )

    def _slave(self, section: str, joint: str, axis: Axis) -> Slave:
        """A motor in the units of its axis; what its own section does not say stays open."""
        ini = self.ini
        length = self.unit if axis.kind is AxisKind.LINEAR else Fraction(1)
        key = "resolution" if ini.text(section, "resolution") is not None else "stepsPerAppUnit"
        steps = ini.exact(section, key)
        if steps is not None and abs(steps) < TINIEST:
            ini.bad(section, key, "no steps per unit")
            steps = None
        slave = Slave(
            joint=joint,
            steps_per_unit=None if steps is None else steps / length,
            lower=ini.number(section, "negativeLimit", length),
            upper=ini.number(section, "positiveLimit", length),
            max_velocity=ini.rate(section, "maxVelocity", length),
            max_acceleration=ini.rate(section, "maxAcceleration", length),
            backlash=ini.at_least(section, "backLash", 0.0, length),
            pitch=self._pitch(section, axis, length),
            home_position=ini.number(section, "homePosition", length),
            home_velocity=ini.number(section, "homeVelocity", length),
        )
        lower = slave.lower if slave.lower is not None else axis.lower
        upper = slave.upper if slave.upper is not None else axis.upper
        if lower is not None and upper is not None and lower > upper:
            key = "negativeLimit" if slave.lower is not None else "positiveLimit"
            ini.bad(section, key, "is above positiveLimit" if slave.lower is not None else "is below negativeLimit")
        return slave

    def _pitch(self, section: str, axis: Axis, length: Fraction) -> PitchTable | None:
        """The correction table of a motor that has it switched on (2.3); a flat one with an axis with a table."""
        flat = None if axis.pitch is None else PitchTable(machine=(0.0,), calibrated=(0.0,))
        if not self.ini.switch(section, "pitchCompensationOn"):
            return flat
        rows = self._table(section, "pitchCompensationFileName")
        if rows is None:
            return flat
        table = PitchTable(
            machine=tuple(float(a * length) for a, _ in rows), calibrated=tuple(float(b * length) for _, b in rows)
        )
        problem = table.problem()
        if problem is not None:
            self.ini.bad(section, "pitchCompensationFileName", problem)
            return flat
        return table

    def _table(self, section: str, key: str) -> list[tuple[Fraction, Fraction]] | None:
        """The pairs in the file that ``key`` names, in the folder of the ini; None when there is none that is good.

        The controller writes an example where the file is missing (2.3, 2.4): what it will do is not known.
        """
        name = (self.ini.text(section, key) or "").replace("\\", "/").rpartition("/")[2].strip()
        target = self.path.parent / name
        if not name or not is_file(target):
            self._open(section, key, f"{key} = {name[:60] or 'nothing'}", "there is no such file")
            return None
        rows, digest = load_table(target, self.ini)
        self.files.append((str(target), digest))
        return rows

    # -- the rest

    def _spindles(self) -> tuple[Spindle, ...]:
        """The spindles, with the tables of those that have theirs switched on (2.4)."""
        found = []
        for spindle in read_spindles(self.ini, self.unit):
            section = f"SPINDLE_{spindle.number}"
            if self.ini.switch(section, "pwmCompensationOn"):
                rows = self._table(section, "pwmCompensationFileName") or []
                spindle = replace(spindle, pwm=tuple((float(rpm), float(percent)) for rpm, percent in rows))
                if any(b <= a for (a, _), (b, _) in itertools.pairwise(spindle.pwm)):
                    self.ini.bad(section, "pwmCompensationFileName", "speeds must rise from line to line")
            found.append(spindle)
        return tuple(found)

    def _knife(self) -> Knife | None:
        """The tangential knife when an axis is one (2.1.3, 2.1.9)."""
        if self.knife is None:
            return None
        return Knife(
            axis=self.knife,
            angle=self.at_least_0("knife_angle") or 0.0,
            lift=self.at_least_0("knife_lift", self.unit) or 0.0,
            blend_angle=self.at_least_0("knife_blend_angle") or 0.0,
            blend_distance=self.at_least_0("knife_blend_distance", self.unit) or 0.0,
        )

    def _controller(self) -> Controller:
        usual = Controller()
        interpolation, fifo = self.rate("interpolation_time"), self.rate("fifo_time")
        return Controller(
            dialect="eding",
            version=self.text("version"),
            laf_angle=self.at_least_0("laf_angle"),
            interpolation_time=usual.interpolation_time if interpolation is None else interpolation,
            fifo_time=usual.fifo_time if fifo is None else fifo,
            max_step_frequency=self.rate("max_step_frequency"),
            auto_tool_change=self.switch("auto_tool_change"),
            absolute_arc_centers=self.switch("absolute_arc_centers"),
            diameter_programming=self.switch("diameter_programming"),
            extruder=self.switch("extruder"),
            spindle_ramp_time=self.ini.at_least("SPINDLE_0", "spindleRampUpTime", 0.0) or 0.0,
            homing_mandatory=self.stated("homing_mandatory"),
            safety_feed=self.at_least_0("safety_feed"),
            home_is_stop=self.stated("home_is_stop"),
            turning=self.switch("turning"),
        )

    def _settings(self) -> EdingSettings:
        macro = (self.text("macro_file") or "").replace("\\", "/").rpartition("/")[2]
        return EdingSettings(macro_file=macro or None, super_long_file=self.at_least_0("super_long_file"))


def _report_unknown(ini: Ini) -> None:
    """A warning for each key that gproof has never heard of, one for each such section."""
    names = {key.lower() for _, keys in _SETTINGS.values() for key in keys}
    names |= {key.lower() for key in _SWITCHES} | set(_KEPT)
    for section, values in ini.sections.items():
        numbered = NUMBERED.match(section)
        known = set(_NUMBERED_KEYS[numbered[1]]) if numbered else names
        if section.startswith((*_PASSED_OVER, "KIN")):
            continue
        strange = [value for key, value in values.items() if key not in known and not key.startswith("kin")]
        if strange and len(strange) == len(values) and not numbered:
            ini.report_unknown(min(value.line for value in values.values()), f"[{section}]")
            continue
        for value in strange:
            ini.report_unknown(value.line, f"[{section}] {value.key}")


def _kept(ini: Ini) -> tuple[tuple[str, str], ...]:
    """Settings without a bearing on positions, as they are written."""
    return tuple(
        (f"[{section}] {value.key}", value.text)
        for section, values in ini.sections.items()
        for key, value in values.items()
        if (key in _KEPT and section != "TCA") or (section.startswith(_PASSED_OVER) and not NUMBERED.match(section))
    )


def _tool_change_area(ini: Ini, unit: Fraction) -> Area | None:
    """The area of [TCA], which is there when a limit is not 0 (2.1.8); an axis with both at 0 is not bounded."""
    sides: list[tuple[float, float]] = []
    for axis in "xyz":
        low = ini.number("TCA", f"{axis}NegativeLimit", unit) or 0.0
        high = ini.number("TCA", f"{axis}PositiveLimit", unit) or 0.0
        if low > high:
            key = f"{axis}NegativeLimit"
            ini.bad("TCA", key if ini.text("TCA", key) else f"{axis}PositiveLimit", "the limits are in the wrong order")
        sides.append((low, high))
    if all(side == (0.0, 0.0) for side in sides):
        return None
    box = [(-math.inf, math.inf) if side == (0.0, 0.0) else side for side in sides]
    return Area(name="tool_change", box=(box[0], box[1], box[2]))


def _tools(ini: Ini, unit: Fraction) -> tuple[Tool, ...]:
    tools: dict[int, Tool] = {}
    for section, values in ini.sections.items():
        numbered = NUMBERED.match(section)
        if not numbered or numbered[1] != "TOOL" or not 1 <= int(numbered[2]) <= MAX_TOOL:
            continue
        orientation = ini.exact(section, "orientation")
        if orientation is not None and (orientation.denominator != 1 or not 0 <= orientation <= 9):
            ini.bad(section, "orientation", "tool orientations are 1 to 9")
            orientation = None
        number = int(numbered[2])
        if number in tools:
            line = min((value.line for value in values.values()), default=0)
            ini.add(codes.BAD_VALUE, line, key=f"[{section}]", what=f"tool {number} is given twice")
        tools[number] = Tool(
            number=number,
            length=ini.number(section, "zOffset", unit),
            x_offset=ini.number(section, "xOffset", unit),
            diameter=ini.number(section, "diameter", unit),
            orientation=None if orientation is None else int(orientation),
        )
    return tuple(tools[number] for number in sorted(tools))
