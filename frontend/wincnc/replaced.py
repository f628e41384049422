"""Which settings of a WINCNC.INI a machine file that refines it (``base = "WINCNC.INI"``) states again.

What such a file states takes the place of the controller's setting: a mistake in the setting is nobody's then, and it
is not judged. ``*`` stands for the column of the axis, which the setting belongs to or whose letter the word has.
"""

from __future__ import annotations

from collections.abc import Mapping

ANY = "*"
Path = tuple[str, ...]

_OF_AXIS = {
    ("axisspec", "R"): "steps_per_unit", ("axisspec", "A"): "max_acceleration", ("axisspec", "F"): "max_acceleration",
    ("axisspec", "B"): "backlash", ("axisvel", "R"): "max_velocity", ("axisvel", "F"): "feed_velocity",
    ("altaxisspec", ANY): "slaves",
}  # fmt: skip
_BY_LETTER = {
    "lolim": "min", "hilim": "max", "lobound": "boundary_min", "hibound": "boundary_max", "g28coord": "home_place",
}  # fmt: skip
_OTHERS = {
    ("arc_err", ""): ("controls", "arc_tolerance"), ("arc_min", ""): ("controls", "smallest_arc"),
    ("nmode", ""): ("controls", "absolute"), ("softlim", "T"): ("controls", "soft_limits"),
    ("softlim", "B"): ("controls", "adjust_boundary"), ("softlim", "V"): ("controls", "adjust_vertical"),
    ("vgroup", ""): ("controls", "feed_groups"), ("arcs", "M"): ("controls", "arcs_modal"),
    ("g2modal", ""): ("controls", "arcs_modal"), ("arctype", "M"): ("controls", "arcs_modal"),
    ("arcs", "A"): ("controller", "absolute_arc_centers"), ("maxstepv", ""): ("controller", "max_step_frequency"),
    ("steppulse", "P"): ("board", "step_pulse"), ("steppulse", "D"): ("board", "direction_setup"),
    ("spindle", "R"): ("spindles", "0", "max_rpm"),
}  # fmt: skip


def is_replaced(stated: frozenset[Path], key: str, letter: str, column: str, columns: Mapping[str, str]) -> bool:
    """Whether a setting's letter ("" for its only value) is stated again.

    stated: see ``frontend/common/own_keys.py: key_paths``; column: of the axis that it belongs to, "" for none;
    columns: by letter.
    """
    if not stated:
        return False
    if key in _BY_LETTER:
        return letter in columns and ("axes", columns[letter], _BY_LETTER[key]) in stated
    own = _OF_AXIS.get((key, letter)) or _OF_AXIS.get((key, ANY))
    if own is not None:
        return ("axes", column, own) in stated
    return _OTHERS.get((key, letter)) in stated
