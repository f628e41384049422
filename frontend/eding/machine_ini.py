"""The controller's own machine file, ``cnc.ini``: sections of ``key = value`` lines.

Source: Eding CNC manual 4.01, 2.1 (what the settings mean), 2.3 (pitch compensation), 2.1.11 and 2.1.14 (keys
that are only in the file). Keys that have nothing to do with positions are known and passed over; a key or
section that is not known at all is a warning (GP602), a setting that is on and that gproof can not follow goes
into ``Machine.not_modelled``.
"""

from __future__ import annotations

import hashlib
import math
import re
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from gproof.frontend.eding.prepare import decode
from gproof.frontend.toml_table import LARGEST, MILLIMETRES, TINIEST, exact_ratio
from gproof.ir import codes
from gproof.ir.finding import Code, Findings, Span
from gproof.ir.machine import AXIS_NAMES, Area, Axis, AxisKind, Controller, Machine, Tool

_LINE = re.compile(
    r"\s*(?:\[(?P<section>[^\]]*)\]|(?P<key>[^=;#\[\]]+?)\s*=\s*(?P<value>\"[^\"]*\"|[^;#]*))\s*(?:[;#].*)?$"
)
_NUMBERED = re.compile(r"(JOINT|SPINDLE|TOOL)_(\d{1,2})$")

_READ = {
    "GENERAL": "units maxstepfrequency",
    "TRAJECTORY": "lafminimumangle interpolationtime fifotime",
    "TCA": "xnegativelimit xpositivelimit ynegativelimit ypositivelimit znegativelimit zpositivelimit zdowntoollength",
    "USERINTERFACE": "autotoolchange homingmandatory showinprogspeed",
    "INTERPRETER": "diameterprogramming absolutecentercoords is3dprinter",
    "JOINT": "visible portid resolution stepsperappunit positivelimit negativelimit maxvelocity maxacceleration"
    " homevelocity homevelocityslow homeposition backlash mode pitchcompensationon pitchcompensationfilename",
    "SPINDLE": "spindlenmax spindlenmin spindlerampuptime spindleuserpmsensor onoffoutputportid"
    " directionoutputportid pwmoutputportid spindlereadyportid pwmcompensationon pwmcompensationfilename"
    " xoffset yoffset zoffset",
    "TOOL": "zoffset xoffset diameter orientation id description",
}
"""Keys by section that gproof reads, or knows to have no bearing on where the axes go."""

_PASSED_OVER = ("GPIO", "CAMERA", "HANDWHEEL", "IO", "TRAFFIC", "LANGUAGE", "SAFETY", "PROBING", "THC", "PRINTER")
"""Beginnings of section names with nothing about positions: names of inputs, colours, the hand wheel."""

_SWITCHES = {
    ("INTERPRETER", "is3dprinter"): "is3DPrinter",
}
"""Switches that change what words mean and that gproof does not follow."""

MAX_TOOL = 99


@dataclass(frozen=True, slots=True)
class _Value:
    text: str
    line: int
    key: str


class _Ini:
    """The values of a file by section and lower-case key, with findings at their lines."""

    def __init__(self, name: str, findings: Findings) -> None:
        self.name = name
        self.findings = findings
        self.errors = 0
        self.unknown: list[tuple[str, str]] = []
        self.sections: dict[str, dict[str, _Value]] = {}

    def add(self, code: Code, line: int, **values: Any) -> None:
        if code is not codes.UNKNOWN_KEY:
            self.errors += 1
        self.findings.add(code.at(Span(self.name, line), **values))

    def parse(self, text: str) -> None:
        section: dict[str, _Value] = {}
        for number, line in enumerate(text.splitlines(), 1):
            if not line.strip() or line.lstrip()[0] in ";#":
                continue
            found = _LINE.match(line)
            if found is None:
                self.add(codes.FILE_UNREADABLE, number, what="neither [section] nor key = value")
            elif found["section"] is not None:
                section = self.sections.setdefault(found["section"].strip().upper(), {})
            else:
                key, value = found["key"].strip(), found["value"].strip().strip('"').strip()
                before = section.setdefault(key.lower(), _Value(value, number, key))
                if before.text != value:
                    what = f"given again with another value than in line {before.line}"
                    self.add(codes.BAD_VALUE, number, key=key, what=what)

    def text(self, section: str, key: str) -> str | None:
        value = self.sections.get(section, {}).get(key.lower())
        return None if value is None else value.text

    def bad(self, section: str, key: str, what: str) -> None:
        value = self.sections[section][key.lower()]
        self.add(codes.BAD_VALUE, value.line, key=f"[{section}] {value.key}", what=what)

    def exact(self, section: str, key: str) -> Fraction | None:
        text = self.text(section, key)
        if text is None:
            return None
        value = exact_ratio(text) if "/" not in text else None
        if value is None or abs(value) > LARGEST:
            self.bad(section, key, f"{text!r} is not a number")
            return None
        return value

    def number(self, section: str, key: str, unit: Fraction = Fraction(1)) -> float | None:
        value = self.exact(section, key)
        return None if value is None else float(value * unit)

    def at_least(self, section: str, key: str, low: float, unit: Fraction = Fraction(1)) -> float | None:
        """A number not below ``low``."""
        value = self.number(section, key, unit)
        if value is not None and value < low:
            self.bad(section, key, f"{self.text(section, key)} is below {low:g}")
            return None
        return value

    def rate(self, section: str, key: str, unit: Fraction = Fraction(1)) -> float | None:
        value = self.number(section, key, unit)
        if value is not None and not value > 0:
            self.bad(section, key, f"{self.text(section, key)} is not greater than 0")
            return None
        return value

    def switch(self, section: str, key: str) -> bool:
        value = self.exact(section, key)
        return value is not None and value != 0

    def report_unknown(self) -> None:
        """A warning for each key that gproof has never heard of, one for each such section."""
        for section, values in self.sections.items():
            numbered = _NUMBERED.match(section)
            known = _READ.get(numbered[1] if numbered else section)
            if known is None:
                if not section.startswith(_PASSED_OVER) and values:
                    self._unknown(min(value.line for value in values.values()), f"[{section}]")
                continue
            for key, value in values.items():
                if key not in known.split():
                    self._unknown(value.line, f"[{section}] {value.key}")

    def _unknown(self, line: int, key: str) -> None:
        self.unknown.append((Path(self.name).name, key))
        self.add(codes.UNKNOWN_KEY, line, key=key)


def load_ini(path: Path, findings: Findings) -> tuple[Machine | None, list[tuple[str, str]]]:
    """The machine in a ``cnc.ini``, and (name, sha256) of the file; None, with findings, when it is bad."""
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
    ini = _Ini(name, findings)
    ini.parse(decode(raw.removeprefix(b"\xef\xbb\xbf")))
    if not ini.sections and not ini.errors:
        ini.add(codes.MISSING_KEY, 0, key="[GENERAL] and [JOINT_0]")
    machine = _machine(ini, path.name)
    ini.report_unknown()
    if ini.errors:
        return None, files
    machine = replace(machine, unknown_keys=tuple(ini.unknown))
    machine.verify()
    return machine, files


def _machine(ini: _Ini, name: str) -> Machine:
    units = (ini.text("GENERAL", "units") or "mm").lower()
    if units not in MILLIMETRES:
        ini.bad("GENERAL", "units", f"{units!r} is none of {', '.join(MILLIMETRES)}")
    unit = MILLIMETRES.get(units, Fraction(1))
    axes, not_modelled = _axes(ini, unit)
    for (section, key), shown in _SWITCHES.items():
        if ini.switch(section, key):
            not_modelled.append(f"[{section}] {shown}")
    for section, values in ini.sections.items():
        for key, value in values.items():
            trivial = value.text.lower() in ("", "0", "1", "trivial")
            if (section.startswith("KIN") or key.startswith("kin")) and not trivial:
                not_modelled.append(f"[{section}] {value.key}")
    return Machine(
        name=name,
        axes=axes,
        tool_change_area=_tool_change_area(ini, unit),
        tools=_tools(ini, unit),
        controller=_controller(ini),
        unit=float(unit),
        not_modelled=tuple(not_modelled),
    )


def _axes(ini: _Ini, unit: Fraction) -> tuple[tuple[Axis, ...], list[str]]:
    """The axes that are mapped to a port or visible, and what of them is not modelled."""
    axes: dict[str, Axis] = {}
    slaves: list[str] = []
    not_modelled: list[str] = []
    for index, name in enumerate(AXIS_NAMES):
        section = f"JOINT_{index}"
        if section not in ini.sections or not _is_used(ini, section):
            continue
        if ini.switch(section, "pitchCompensationOn"):
            not_modelled.append(f"[{section}] pitchCompensationOn")
        mode = " ".join((ini.text(section, "mode") or "ROT").upper().split())
        if index >= 3 and mode not in ("ROT", "0"):
            not_modelled.append(f"[{section}] mode = {mode}")
            if mode.startswith("SLAVE"):
                slaves.append(mode.removeprefix("SLAVE").strip().lower())
                continue
        linear = index < 3 or mode in ("FOAM CUT", "2ND Z")
        axes[name] = _axis(ini, section, name, AxisKind.LINEAR if linear else AxisKind.ROTARY, unit)
    for master in slaves:
        if master in axes:
            axes[master] = replace(axes[master], slaves=axes[master].slaves + 1)
    return tuple(axes.values()), not_modelled


def _is_used(ini: _Ini, section: str) -> bool:
    """Mapped to a port, or visible; an axis that is mapped and not visible can be used (2.1.3)."""
    port = ini.text(section, "portID")
    visible = ini.switch(section, "visible")
    if port is None:
        return visible or ini.text(section, "visible") is None
    value = ini.exact(section, "portID")
    return visible or (value is not None and value > 0)


def _axis(ini: _Ini, section: str, name: str, kind: AxisKind, unit: Fraction) -> Axis:
    length = unit if kind is AxisKind.LINEAR else Fraction(1)
    key = "resolution" if ini.text(section, "resolution") is not None else "stepsPerAppUnit"
    steps = ini.exact(section, key)
    if steps is not None and abs(steps) < TINIEST:
        ini.bad(section, key, "no steps per unit")
        steps = None
    axis = Axis(
        name=name,
        kind=kind,
        steps_per_unit=None if steps is None else steps / length,
        lower=ini.number(section, "negativeLimit", length),
        upper=ini.number(section, "positiveLimit", length),
        max_velocity=ini.rate(section, "maxVelocity", length),
        max_acceleration=ini.rate(section, "maxAcceleration", length),
        backlash=ini.at_least(section, "backLash", 0.0, length) or 0.0,
    )
    if axis.lower is not None and axis.upper is not None and axis.lower > axis.upper:
        ini.bad(section, "negativeLimit", "lies above positiveLimit")
    return axis


def _tool_change_area(ini: _Ini, unit: Fraction) -> Area | None:
    """The area of [TCA], which is there when a limit is not 0 (2.1.8); an axis with both at 0 is not bounded."""
    sides: list[tuple[float, float]] = []
    for axis in "xyz":
        low = ini.number("TCA", f"{axis}NegativeLimit", unit) or 0.0
        high = ini.number("TCA", f"{axis}PositiveLimit", unit) or 0.0
        if low > high:
            key = f"{axis}NegativeLimit"
            ini.bad("TCA", key if ini.text("TCA", key) else f"{axis}PositiveLimit", "the limits are in wrong order")
        sides.append((low, high))
    if all(side == (0.0, 0.0) for side in sides):
        return None
    box = [(-math.inf, math.inf) if side == (0.0, 0.0) else side for side in sides]
    return Area(name="tool_change", box=(box[0], box[1], box[2]))


def _tools(ini: _Ini, unit: Fraction) -> tuple[Tool, ...]:
    tools: dict[int, Tool] = {}
    for section, values in ini.sections.items():
        numbered = _NUMBERED.match(section)
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


def _controller(ini: _Ini) -> Controller:
    usual = Controller()
    interpolation = ini.rate("TRAJECTORY", "interpolationTime")
    fifo = ini.rate("TRAJECTORY", "fifoTime")
    return Controller(
        dialect="eding",
        laf_angle=ini.at_least("TRAJECTORY", "lafMinimumAngle", 0.0),
        interpolation_time=usual.interpolation_time if interpolation is None else interpolation,
        fifo_time=usual.fifo_time if fifo is None else fifo,
        max_step_frequency=ini.rate("GENERAL", "maxStepFrequency"),
        auto_tool_change=ini.switch("USERINTERFACE", "autoToolChange"),
        absolute_arc_centers=ini.switch("INTERPRETER", "absoluteCenterCoords"),
        diameter_programming=ini.switch("INTERPRETER", "diameterProgramming"),
        spindle_ramp_time=ini.at_least("SPINDLE_0", "spindleRampUpTime", 0.0) or 0.0,
    )
