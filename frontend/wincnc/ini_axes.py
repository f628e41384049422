"""The axes of a WINCNC.INI.

Source: WinCNC manual, "WINCNC.INI Settings: Axis Settings", lolim=, hilim=, lobound=, hibound=, backlash=, g28coord=,
g28move=; "Homing the Machine"; "Soft Limit / Boundaries".
"""

from __future__ import annotations

from fractions import Fraction

from gproof.frontend.wincnc.ini_check import SECONDS_IN_MINUTE, Sheet, number
from gproof.frontend.wincnc.ini_file import Setting
from gproof.ir import codes
from gproof.ir.machine import Axis, AxisKind, Slave

VERTICAL = "ZWUV"
"""Letters of heads that go up and down, where T does not say otherwise (Tool Length Offset; M37, G43)."""
TYPE_VERTICAL = 3
MOST_STEPS = 65535
"""Highest product of acceleration and resolution (Messages and Error Codes: Acceleration Out of Bounds), taken as steps
a second squared: counted by the minute, the manual's own example would be out of bounds. A warning: the manual names no
time, and files of machines that run exceed it."""


def read_axes(sheet: Sheet) -> tuple[Axis, ...]:
    """The axes in the order of their columns."""
    if sheet.letters:
        _count(sheet)
    axes = [_axis(sheet, letter, own) for letter, own in zip(sheet.letters, sheet.axes, strict=False)]
    _check_outputs(sheet)
    return tuple(sorted(axes, key=lambda axis: axis.index))


def _count(sheet: Sheet) -> None:
    """Each axisspec= has its letter; a letter without one keeps its number, and is an axis that is not there."""
    named = sheet.one("axischar")
    for at, letter in enumerate(sheet.letters[len(sheet.axes) :], len(sheet.axes)):
        place = (0,) if named is None else (named.line, named.value_column, named.value_column + len(named.text))
        hint = f"add axisspec= for it: without it a job that moves {letter} is refused"
        sheet.ini.add(codes.MISSING_KEY.as_note(), *place, key=f"axisspec= of {letter}, axis number {at},", hint=hint)
    for own in sheet.axes[len(sheet.letters) :]:
        setting = own["axisspec"][0]
        sheet.ini.bad(setting, f"axischar= has only {len(sheet.letters)} letters")


def _axis(sheet: Sheet, letter: str, own: dict[str, list[Setting]]) -> Axis:
    column = sheet.columns[letter]
    spec = own["axisspec"][0]
    speeds = next(iter(own.get("axisvel", ())), None)
    kind = number(spec, "T")
    turning = sheet.turns(letter)
    length = Fraction(1) if turning else sheet.unit
    steps = _positive(sheet, spec, "R", Fraction(1))
    lower, upper = _pair(sheet, "lolim", "hilim", letter, length)
    boundary_lower, boundary_upper = _pair(sheet, "lobound", "hibound", letter, length)
    _not_modelled(sheet, own, column)
    _check_steps(sheet, letter, spec)
    return Axis(
        name=column,
        kind=AxisKind.ROTARY if turning else AxisKind.LINEAR,
        steps_per_unit=None if steps is None else steps / length,
        lower=lower,
        upper=upper,
        max_velocity=_rounded(_positive(sheet, speeds, "R", length / SECONDS_IN_MINUTE)),
        max_acceleration=_acceleration(sheet, spec, length),
        backlash=_backlash(sheet, spec, length),
        slaves=tuple(Slave(joint=_output(setting)) for setting in own.get("altaxisspec", ())),
        letter="" if letter.lower() == column else letter,
        vertical=kind == TYPE_VERTICAL if kind is not None else letter in VERTICAL,
        boundary_lower=boundary_lower,
        boundary_upper=boundary_upper,
        feed_velocity=_rounded(_positive(sheet, speeds, "F", length / SECONDS_IN_MINUTE, zero=True)) or None,
        home_place=_rounded((number(sheet.one("g28coord"), letter) or Fraction(0)) * length),
        home_velocity=_home_velocity(sheet, letter, length),
    )


def _positive(
    sheet: Sheet, setting: Setting | None, letter: str, unit: Fraction, *, zero: bool = False
) -> Fraction | None:
    """A letter that is greater than 0 (or 0, when ``zero``), times ``unit``."""
    value = number(setting, letter)
    if value is None or setting is None:
        return None
    if value < 0 or (value == 0 and not zero):
        sheet.ini.bad(setting, f"{value} is not greater than 0", setting.word(letter))
        return None
    return value * unit


def _rounded(value: Fraction | None) -> float | None:
    return None if value is None else float(value)


def _acceleration(sheet: Sheet, spec: Setting, length: Fraction) -> float | None:
    """Units a minute a second: A for every move, F for feed moves; the lower one counts for all."""
    unit = length / SECONDS_IN_MINUTE
    given = [_positive(sheet, spec, "A", unit), _positive(sheet, spec, "F", unit, zero=True) or None]
    return _rounded(min((value for value in given if value is not None), default=None))


def _check_steps(sheet: Sheet, letter: str, spec: Setting) -> None:
    """GP606 for an acceleration that the controller may not be able to count."""
    steps = number(spec, "R") or Fraction(0)
    for word in (spec.word("A"), spec.word("F")):
        product = Fraction(0) if word is None else (word.value or 0) * steps / SECONDS_IN_MINUTE
        if word is not None and product > MOST_STEPS and not sheet.ini.is_replaced(spec, word.letter):
            place = (spec.line, word.column, word.end_column)
            allowed = float(MOST_STEPS)
            sheet.ini.add(codes.ACCELERATION_BOUNDS, *place, axis=letter, steps=float(product), allowed=allowed)


def _check_outputs(sheet: Sheet) -> None:
    """Two axes on one step output go together, whichever of them a program moves."""
    users: dict[tuple[Fraction, Fraction], str] = {}
    for letter, own in zip(sheet.letters, sheet.axes, strict=False):
        for setting in (*own["axisspec"], *own.get("altaxisspec", ())):
            step = number(setting, "S")
            first = letter if step is None else users.setdefault((number(setting, "P") or Fraction(0), step), letter)
            if first != letter:
                for axis in (first, letter):
                    sheet.open(setting, f"{first} and {letter} have the same step output", sheet.columns[axis])


def _backlash(sheet: Sheet, spec: Setting, length: Fraction) -> float:
    """Of axisspec= B, unless backlash= switches its compensation off."""
    amount = _positive(sheet, spec, "B", length, zero=True)
    return 0.0 if amount is None or sheet.switch("backlash", "B") is False else float(amount)


def _pair(sheet: Sheet, low: str, high: str, letter: str, length: Fraction) -> tuple[float | None, float | None]:
    """The lower and upper end of an axis by two keys."""
    lower, upper = number(sheet.one(low), letter), number(sheet.one(high), letter)
    first, last = sheet.one(low), sheet.one(high)
    if first is not None and sheet.ini.is_replaced(first, letter):
        lower = None
    if lower is not None and upper is not None and lower > upper and last is not None:
        sheet.ini.bad(last, f"is below {low}= {letter}{lower}", last.word(letter))
        return None, None
    return _rounded(None if lower is None else lower * length), _rounded(None if upper is None else upper * length)


def _output(setting: Setting) -> str:
    """The pins of a second motor."""
    return " ".join(f"{word.letter}{word.text}" for word in setting.words if word.letter in "PSD")


def _home_velocity(sheet: Sheet, letter: str, length: Fraction) -> float | None:
    """Towards the switch: away from where g28move= goes afterwards, else down for X and Y, up for heads (G28)."""
    for setting in sheet.all("g28move"):
        way, feed = number(setting, letter), number(setting, "F")
        if way is None or letter in ("A",) or feed is None or not feed > 0:
            continue
        up = way < 0 if way else letter in VERTICAL
        return float(feed * length / SECONDS_IN_MINUTE) * (1.0 if up else -1.0)
    return None


def _not_modelled(sheet: Sheet, own: dict[str, list[Setting]], column: str) -> None:
    """What moves an axis, or bends its way, as no file tells."""
    for setting in own.get("axismode", ()):
        sheet.open(setting, "the manual gives only the name of this key", column)
    for setting in own.get("axismap", ()):
        sheet.open(setting, "the adjustments of the map are in a file that is not in the manual")
    for setting in own.get("axisadj", ()):
        if number(setting, "I") == 0:
            continue
        named = [number(setting, letter) for letter in "AB"]
        moved = {sheet.columns[sheet.letters[int(value)]] for value in named if value is not None}
        for axis in sorted(moved | ({column} if named[0] is None else set())):
            sheet.open(setting, "keys and inputs move the axis while a job runs", axis)
