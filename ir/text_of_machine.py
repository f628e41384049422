"""How a Machine prints while format 3 of packages is written: with the settings inside its Controller."""

from __future__ import annotations

from typing import Any, NamedTuple

from gproof.ir.dialects.eding_settings import EdingSettings
from gproof.ir.dialects.mcuwin_settings import McuWinSettings
from gproof.ir.dialects.wincnc_settings import NO_WINCNC_SETTINGS, WinCncSettings
from gproof.ir.machine import Controller, Machine
from gproof.ir.settings import Settings

ORDER = {
    "Machine": """
        name axes tool_change_area keep_out tools spindles controller board unit not_modelled
        unknown_keys kinematics knife z_down_tool_length kept spindle_started tool_change_clearance
        clearance_at_start
    """.split(),
    "Controller": """
        dialect version accepts limits_hold laf_angle interpolation_time fifo_time
        max_step_frequency auto_tool_change absolute_arc_centers diameter_programming extruder
        xz_seen_from spindle_ramp_time macro_file super_long_file homing_mandatory safety_feed
        home_is_stop turning thread_peak straight_traverse controls din
    """.split(),
    "Controls": """
        lexical start end abort unit_stated coolant absolute arc_tolerance smallest_arc arcs_modal
        feed_groups command_group soft_limits limits_available adjust_boundary adjust_vertical
        forced shift_sign knife_positions helical_arcs arcs_share_feed inputs outputs
        unsteady_outputs drill_banks devices positions homes tool_positions nesting around_files
        array_order highest_channel rotation_sign virtual_on workspaces changers measure drill
        auto_output auto_output_on auto_dwell auto_pausing axis_order smoothing homing knife saw
        torch probe_input probe_axis compensation_entry compensation_swapped override
        override_enabled rapids_unlocked backlash
    """.split(),
    "Din": """
        version case_sensitive line_numbers position_unit time_unit absolute_centers
        interpolation_axes zero_offsets tools tasks angle_unit wait_unit arc_tolerance program_size
        pre_include post_include keeps_over_codes channels g60 unstated
    """.split(),
}


class Named(NamedTuple):
    """What prints as an object of that name."""

    name: str
    parts: list[Any]


class Whole(NamedTuple):
    """A Controller as it was: with the settings."""

    controller: Controller
    settings: Settings


_OF_EDING = ("macro_file", "super_long_file", "thread_peak")


def parts(value: Any) -> Named | None:
    """What a value prints as; None: as it is."""
    if isinstance(value, Machine):
        of = {name: getattr(value, name) for name in ORDER["Machine"]} | {
            "controller": Whole(value.controller, value.settings)
        }
        return Named("Machine", list(of.values()))
    if isinstance(value, Whole):
        settings = value.settings
        own = {name: getattr(settings, name, None) for name in _OF_EDING}
        own["controls"] = settings if isinstance(settings, WinCncSettings) else NO_WINCNC_SETTINGS
        own["din"] = settings if isinstance(settings, McuWinSettings) else None
        return Named("Controller", [own[n] if n in own else getattr(value.controller, n) for n in ORDER["Controller"]])
    for name, kind in (("Controls", WinCncSettings), ("Din", McuWinSettings)):
        if isinstance(value, kind):
            return Named(name, [getattr(value, field) for field in ORDER[name]])
    return None


def read(name: str, values: list[Any]) -> Any:
    """What an object of that name was made from; None: no such."""
    if name not in ORDER:
        return None
    if len(values) != len(ORDER[name]):
        raise ValueError(f"text form: {name} has {len(ORDER[name])} fields, {len(values)} given")
    given = dict(zip(ORDER[name], values, strict=True))
    if name == "Controls":
        return WinCncSettings(**given)
    if name == "Din":
        return McuWinSettings(**given)
    if name == "Controller":
        of_eding = {one: given.pop(one) for one in _OF_EDING}
        controls, din = given.pop("controls"), given.pop("din")
        settings: Settings = Settings()
        if din is not None:
            settings = din
        elif controls != NO_WINCNC_SETTINGS or given["dialect"] == "wincnc":
            settings = controls
        elif given["dialect"] == "eding" or any(v is not None for v in of_eding.values()):
            settings = EdingSettings(**of_eding)
        return Whole(Controller(**given), settings)
    whole = given.pop("controller")
    if not isinstance(whole, Whole):
        raise ValueError("text form: a Machine without a Controller")
    return Machine(**given, controller=whole.controller, settings=whole.settings)
