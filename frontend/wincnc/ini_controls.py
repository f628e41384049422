"""What a WINCNC.INI says apart from its axes: how lines are read, arcs, limits, workspaces, tools, devices.

Source: WinCNC manual, "WINCNC.INI Settings", by the name of the key.
"""

from __future__ import annotations

from fractions import Fraction

from gproof.frontend.wincnc.ini_check import Sheet, number
from gproof.frontend.wincnc.ini_file import Setting
from gproof.frontend.wincnc.ini_keys import KEYS
from gproof.ir.dialects.wincnc.settings import (
    HIGHEST_CHANNEL,
    Changer,
    DrillSettings,
    Lexical,
    MeasureSwitch,
    WinCncSettings,
)
from gproof.ir.finding import Span
from gproof.ir.settings import HomingLine, KnifeMode, SawMode, TorchControl, Workspace

ARC_ERROR = Fraction(1, 100)
COMMENT_SIGNS = "[(%"
"""Signs that start a comment without comchars= too."""
SMALLEST_ARC = Fraction(2, 1000)
"""Defaults of arc_err= and arc_min=, in the file's unit."""

WORKSPACE_KINDS = (0, 3, 5)
LIMITS_OFF, LIMITS_ON = 0, 1

_DEVICES = (
    ("knifemode", "knife"), ("sawmode", "saw"), ("laser", "laser"), ("laserscan", "laserscan"), ("thc", "thc"),
    ("torchbevel", "bevel"), ("pumpcont", "pump"), ("da", "da"), ("spindle", "spindle"), ("autoaux", "autoaux"),
    ("scan", "probe"), ("drillbank", "drillbank"),
)  # fmt: skip
"""The key that sets a feature up, and its name in ``Settings.devices``."""


def read_controls(sheet: Sheet) -> WinCncSettings:
    """Everything that is not of one axis."""
    groups, command = _feed_groups(sheet)
    on, available = _soft_limits(sheet)
    auto = sheet.one("autoaux")
    devices = [name for key, name in _DEVICES if sheet.all(key)]
    devices += [key for key in ("axisadj", "axismap") if any(own.get(key) for own in sheet.axes)]
    speed = sheet.one("spindle")
    kind = None if speed is None else speed.word("T")
    if kind is not None and kind.value == 2:
        devices.append("spinmac")
    scan = sheet.one("scan")
    if scan is not None and (scan.word("T") is None or scan.word("C") is None):
        sheet.ini.bad(scan, "T and C are missing")
    mode = sheet.bare("nmode")
    return WinCncSettings(
        lexical=_lexical(sheet),
        start=sheet.text("cmdstart"),
        end=sheet.text("cmdend"),
        abort=sheet.text("cmdabort"),
        places=_places(sheet, start="cmdstart", end="cmdend", abort="cmdabort"),
        unit_stated=any(setting.key == "unit" for setting in sheet.ini.settings),
        absolute=None if mode is None else mode == 90,
        arc_tolerance=sheet.scaled(_or(sheet.bare("arc_err"), ARC_ERROR), sheet.unit),
        smallest_arc=sheet.scaled(_or(sheet.bare("arc_min"), SMALLEST_ARC), sheet.unit),
        arcs_modal=_arcs_modal(sheet),
        feed_groups=groups,
        command_group=command,
        soft_limits=on,
        limits_available=available,
        adjust_boundary=sheet.switch("softlim", "B") or False,
        adjust_vertical=sheet.switch("softlim", "V") or False,
        forced=_forced(sheet),
        inputs=_channels(sheet, "auxin"),
        outputs=_channels(sheet, "auxout"),
        highest_channel=HIGHEST_CHANNEL,
        unsteady_outputs=_unsteady(sheet),
        drill_banks=_drill_banks(sheet),
        devices=tuple(devices),
        positions=_count(sheet, "P"),
        homes=_count(sheet, "H"),
        tool_positions=_count(sheet, "T"),
        workspaces=tuple(filter(None, (_workspace(sheet, n) for n in range(54, 60)))),
        changers=tuple(filter(None, (_changer(sheet, n) for n in (1, 2)))),
        measure=_measure(sheet),
        drill=DrillSettings(
            dwell=sheet.plain("g81set", "D"),
            other_dwell=sheet.scaled(sheet.bare("g81dwell"), Fraction(1)),
            approach=sheet.length("g81set", "R"),
            lift=sheet.length("g81set", "L"),
        ),
        auto_output=sheet.channel("autoaux", "C"),
        auto_output_on=sheet.switch("autoaux", "I") or False,
        auto_dwell=(sheet.plain("autoaux", "S") or 0.0, sheet.plain("autoaux", "E") or 0.0),
        auto_pausing=not (number(auto, "T") or 0),
        axis_order="".join(sheet.columns[letter] for letter in sheet.letters),
        smoothing=_smoothing(sheet),
        homing=tuple(_homing(sheet, setting) for setting in sheet.all("g28move")),
        knife=_knife(sheet),
        saw=_saw(sheet),
        torch=_torch(sheet),
        probe_input=sheet.channel("scan", "C"),
        probe_axis=sheet.axis("scan", "A") or "z",
        compensation_entry=sheet.switch("cutcomp", "T") or False,
        compensation_swapped=(sheet.value("cutcomp", "D") or 0) < 0,
        override=_override(sheet),
        override_enabled=sheet.switch("override", "E") is not False,
        rapids_unlocked=sheet.bare("rapid_lock") == 0,
        backlash=_switched_off(sheet),
    )


def _switched_off(sheet: Sheet) -> tuple[tuple[str, float], ...]:
    """By column the backlash of axisspec= that backlash= B0 leaves out at the start, and L8 switches on."""
    if sheet.switch("backlash", "B") is not False:
        return ()
    found = []
    for letter, own in zip(sheet.letters, sheet.axes, strict=False):
        spec = own["axisspec"][0]
        amount = number(spec, "B")
        if amount:
            length = Fraction(1) if sheet.turns(letter) else sheet.unit
            found.append((sheet.columns[letter], float(abs(amount) * length)))
    return tuple(found)


def _places(sheet: Sheet, **keys: str) -> tuple[tuple[str, Span], ...]:
    """Where the values of keys are, by the names that these have in ``WinCncSettings``."""
    found = [(name, setting) for name, key in keys.items() if (setting := sheet.one(key)) is not None]
    return tuple(
        (name, Span(sheet.ini.name, s.line, s.value_column, s.value_column + len(s.text))) for name, s in found
    )  # fmt: skip


def _or(value: Fraction | None, usual: Fraction) -> Fraction:
    return usual if value is None else value


# -- how lines are read


def _lexical(sheet: Sheet) -> Lexical:
    signs = "".join(
        sign for sign in dict.fromkeys("".join(sheet.text("comchars").split())) if sign not in COMMENT_SIGNS
    )
    setting = sheet.one("comchars")
    if setting is not None and any(sign.isalnum() or sign in '+-.=~{}"' for sign in signs):
        sheet.open(setting, "a character of commands starts a comment")
    skips = []
    for skip in sheet.all("skipchars"):
        sign, count = skip.word("C"), number(skip, "N")
        if sign is None or not sign.text or count is None:
            sheet.ini.bad(skip, 'C"signs" and N are missing')
        else:
            skips.append((sign.text, int(count)))
    return Lexical(comment_signs=signs, skips=tuple(skips), comma=sheet.bare("commatodec") == 1)


# -- arcs, feeds, velocities


def _arcs_modal(sheet: Sheet) -> bool:
    """By g2modal=, arcs= M or arctype= M; where they contradict one another, the meaning of a line is open."""
    values = {key: sheet.value(key, "M") for key in ("arcs", "arctype")} | {"g2modal": sheet.bare("g2modal")}
    given = [
        (setting, value != 0)
        for key, value in values.items()
        if value is not None and (setting := sheet.one(key)) is not None
    ]
    for setting, modal in given[1:]:
        if modal != given[0][1]:
            sheet.open(setting, f"{given[0][0].shown}= says something else about whether G2 and G3 are modal")
    chords, setting = sheet.value("arctype", "I"), sheet.one("arctype")
    if chords and setting is not None:
        sheet.open(setting, "arcs are broken up into straight segments")
    return any(modal for _, modal in given)


def absolute_centers(sheet: Sheet) -> bool:
    """I and J are positions (arcs= A)."""
    return sheet.switch("arcs", "A") or False


def _feed_groups(sheet: Sheet) -> tuple[tuple[str, ...], str]:
    """Columns of the axes that share a feed, and those whose feed an F without axes sets (vgroup=)."""
    groups: list[str] = []
    command: str | None = None
    for setting in sheet.all("vgroup"):
        letters = "".join(setting.text.split()).upper()
        of_command = letters.startswith("F")
        columns = ""
        for letter in letters.removeprefix("F"):
            column = sheet.columns.get(letter)
            if column is None and letter in "XYZABCWUV":
                sheet.ini.report_unknown(setting, what=f"there is no axis {letter}")
            elif column is None or column in columns:
                what = f"{letter!r} is not an axis" if column is None else f"{letter} is given twice"
                sheet.ini.bad(setting, what)
            else:
                columns += column
        if of_command:
            if command is not None and set(command) != set(columns):
                sheet.ini.bad(setting, "the command group is given again with other axes")
            command = columns
        elif columns:
            twice = next((column for column in columns if any(column in group for group in groups)), None)
            if twice is not None and not any(set(columns) == set(group) for group in groups):
                sheet.ini.bad(setting, "an axis is in two groups")
            elif twice is None:
                groups.append(columns)
    return tuple(groups), command or ""


def _smoothing(sheet: Sheet) -> bool:
    corners = any(number(setting, "C") for own in sheet.axes for setting in own.get("axisvel", ()))
    others = any(sheet.all(key) for key in ("accel", "vmatch", "autoarcfeed"))
    # What a letter that the manual lacks does to velocities is not known.
    others = others or any(sheet.odd(key) for key, rule in KEYS.items() if rule.touches == "corners")
    return corners or others or bool(sheet.value("g08", "E")) or bool(sheet.value("g09", "S"))


def _override(sheet: Sheet) -> tuple[float | None, float | None] | None:
    """Percent, lowest and highest."""
    setting = sheet.one("override")
    if setting is None:
        return None
    low, high = sheet.plain("override", "L"), sheet.plain("override", "H")
    if low is not None and high is not None and low >= high:
        sheet.ini.bad(setting, "L must be lower than H", setting.word("L"))
    return low, high


# -- limits


def _soft_limits(sheet: Sheet) -> tuple[bool | None, bool]:
    """Whether limits and boundaries are on at the start, and whether they can be switched on (softlim= T)."""
    if sheet.one("softlim") is None:
        return None, True
    kind = sheet.value("softlim", "T")
    return kind is None or kind == LIMITS_ON, kind != LIMITS_OFF


def _forced(sheet: Sheet) -> tuple[tuple[float | None, float | None], tuple[float | None, float | None]] | None:
    """The lower corner; whether it counts from the lower limits is open, so the higher reading is taken."""
    setting = sheet.one("forcelim")
    if setting is None:
        return None
    sides: list[tuple[float | None, float | None]] = []
    for letter in "XY":
        corner = _or(number(setting, letter), Fraction(-1))
        limit = number(sheet.one("lolim"), letter)
        sides.append((float(max(corner, corner + (limit or 0)) * sheet.unit), None))
    return sides[0], sides[1]


# -- inputs, outputs, places


def _channels(sheet: Sheet, key: str) -> tuple[int, ...]:
    """The channels of auxin= or auxout=, in rising order."""
    found: set[int] = set()
    for setting in sheet.all(key):
        channel = number(setting, "C")
        if channel is None:
            sheet.ini.bad(setting, "C, the channel, is missing")
        elif int(channel) in found:
            sheet.ini.bad(setting, f"channel {channel} is given again", setting.word("C"))
        else:
            found.add(int(channel))
    return tuple(sorted(found))


def _unsteady(sheet: Sheet) -> tuple[int, ...]:
    """Outputs that motion (auxout= T2, T3) or a pause (W) switches, whatever the job has said before.

    A letter that the manual does not name may be another such thing.
    """
    found = set()
    for key in ("auxout", "autoaux"):
        known = KEYS[key].letters
        for setting in sheet.all(key):
            odd = any(word.letter not in known for word in setting.words)
            moved = key == "auxout" and (number(setting, "T") in (2, 3) or number(setting, "W") is not None)
            channel = number(setting, "C")
            if channel is not None and (odd or moved):
                found.add(int(channel))
    return tuple(sorted(found))


def _drill_banks(sheet: Sheet) -> tuple[tuple[int, int], ...]:
    found = []
    for setting in sheet.all("drillbank"):
        first, count = number(setting, "C"), number(setting, "N")
        if first is None or count is None:
            sheet.ini.bad(setting, "C and N are missing")
        else:
            found.append((int(first), int(count)))
    return tuple(found)


def _count(sheet: Sheet, letter: str) -> int | None:
    value = sheet.value("positions", letter)
    return None if value is None else int(value)


def _workspace(sheet: Sheet, number_: int) -> Workspace | None:
    key = f"g{number_}"
    setting = sheet.one(key)
    if setting is None:
        return None
    kind = int(sheet.value(key, "T") or 0)
    if kind not in WORKSPACE_KINDS:
        sheet.ini.bad(setting, f"{kind} is not one of 0, 3 and 5", setting.word("T"))
    if sheet.value(key, "A"):
        sheet.open(setting, "the manual does not say what A is", word=setting.word("A"))
    return Workspace(
        number=number_,
        x=sheet.length(key, "X") or 0.0,
        y=sheet.length(key, "Y") or 0.0,
        kind=kind,
        radius=sheet.length(key, "R"),
        offset=sheet.plain(key, "O") or 0.0,
        moves=sheet.switch(key, "M"),
    )


def _changer(sheet: Sheet, number_: int) -> Changer | None:
    key = f"atc{number_}"
    if sheet.one(key) is None:
        return None
    return Changer(
        number=number_,
        height=sheet.length(key, "H"),
        sensor=sheet.length(key, "O"),
        spindle_height=sheet.length(key, "Z"),
        axis=sheet.axis(key, "A") or "z",
        in_library=sheet.switch(key, "M") or False,
    )


def _measure(sheet: Sheet) -> MeasureSwitch | None:
    if sheet.one("g37") is None:
        return None
    x, y, i, j, descent = (sheet.length("g37", letter) for letter in "XYIJD")
    return MeasureSwitch(x=x, y=y, i=i, j=j, descent=descent, feed=sheet.feed("g37", "F"))


def _homing(sheet: Sheet, setting: Setting) -> HomingLine:
    """One g28move= line; letters that it uses for other things than axes are those other things."""
    own = ("R", "F", "T", "A", "M", "L")
    minute = sheet.unit / 60
    return HomingLine(
        distances=tuple(
            (sheet.columns[word.letter], float(word.value * _length(sheet, word.letter)))
            for word in setting.words
            if word.letter in sheet.columns and word.letter not in own and word.value is not None
        ),
        retreat=sheet.scaled(number(setting, "R"), sheet.unit),
        feed=sheet.scaled(number(setting, "F"), minute),
        second_feed=sheet.scaled(number(setting, "T"), minute),
        longest=sheet.scaled(number(setting, "L"), sheet.unit),
        alternate=bool(number(setting, "A")),
        singly=bool(number(setting, "M")),
    )


def _length(sheet: Sheet, letter: str) -> Fraction:
    """Of an axis: millimetres in a unit, 1 when it turns."""
    return Fraction(1) if sheet.turns(letter) else sheet.unit


# -- devices


def _knife(sheet: Sheet) -> KnifeMode | None:
    setting = sheet.one("knifemode")
    if setting is None:
        return None
    axis = sheet.axis("knifemode", "N")
    if axis is None:
        sheet.ini.bad(setting, "N, the axis that turns the knife, is missing")
        return None
    output = sheet.channel("knifemode", "C")
    return KnifeMode(
        axis=axis,
        target=sheet.switch("knifemode", "T") or False,
        angle=sheet.plain("knifemode", "A"),
        blend=sheet.length("knifemode", "L") or 0.0,
        lifted=sheet.length("knifemode", "Z"),
        lowered=sheet.length("knifemode", "P"),
        vertical=(sheet.axis("knifemode", "V") or _third(sheet)) if output is None else "",
        output=output,
        dwell=sheet.plain("knifemode", "D") or 0.0,
        automatic=sheet.switch("knifemode", "M") or False,
        lifts_in_arcs=sheet.switch("knifemode", "R") is not False,
        blade=sheet.plain("knifeangle", "A") or 0.0,
        both_ways=sheet.switch("knifeangle", "M") or False,
        x=sheet.length("knifeangle", "X") or 0.0,
        y=sheet.length("knifeangle", "Y") or 0.0,
    )


def _third(sheet: Sheet) -> str:
    """The column of axis number 2, which is V by default."""
    return sheet.columns[sheet.letters[2]] if len(sheet.letters) > 2 else "z"


def _saw(sheet: Sheet) -> SawMode | None:
    setting = sheet.one("sawmode")
    if setting is None:
        return None
    axis = sheet.axis("sawmode", "A")
    if axis is None:
        sheet.ini.bad(setting, "A, the axis that turns the saw, is missing")
        return None
    return SawMode(
        axis=axis,
        radius=sheet.length("sawmode", "R"),
        offset=sheet.plain("sawmode", "O") or 0.0,
        lift=sheet.length("sawmode", "Z"),
    )


def _torch(sheet: Sheet) -> TorchControl | None:
    if sheet.one("thc") is None:
        return None
    return TorchControl(
        axis=sheet.axis("thc", "A") or "",
        feed=sheet.feed("thc", "F"),
        output=sheet.channel("thc", "O"),
        input=sheet.channel("thc", "I"),
        start_delay=sheet.plain("thc", "S"),
        end_delay=sheet.plain("thc", "E"),
        compression=sheet.length("thc", "D"),
        lift=sheet.length("thc", "L"),
    )
