"""Target: what a controller has, of the operations of a Job, and how people write its programs.

A target's table is ``ir/dialects/<name>/target.py``. Each feature that is legal names the section of the manual that
says so; what is not named is rewritten by a pattern of ``passes/legalize/``, or the job is refused.
"""

from __future__ import annotations

from gproof.ir.record import field, record

FEATURES: dict[str, str] = {
    "not_raised": "a construct without a neutral form",
    "grid": "array of rows and columns",
    "routine_count": "routine that runs several times",
    "routine_arguments": "arguments of a routine",
    "optional_part": "block delete",
    "question": "question to the operator",
    "choice_else": "choice with two ways",
    "choice": "choice",
    "count_loop": "counted loop",
    "repeat": "loop with the condition at its end",
    "while": "loop with the condition at its start",
    "jump": "jump to a label",
    "routine": "subprogram",
    "indirect": "variable whose number is computed",
    "system_variable": "variable that the controller sets",
    "input_value": "state of an input in an expression",
    "operator": "operator of an expression",
    "variable": "variable",
    "expression": "expression",
    "cycle_repeats": "drilling cycle with repeats",
    "cycle_plane": "drilling cycle in XZ or YZ",
    "cycle_relative": "drilling cycle with relative places",
    "cycle_return": "drilling cycle that ends at the height before it",
    "cycle_peck_dwell": "peck drilling with dwell",
    "cycle_clearance": "drilling cycle with a clearance of its own",
    "cycle_straight": "drilling cycle whose rapid to the hole must be straight",
    "cycle_drill": "drilling cycle",
    "cycle_dwell": "drilling cycle with dwell",
    "cycle_peck": "peck drilling",
    "cycle_chip_break": "chip breaking",
    "cycle_bore": "boring, feed out",
    "cycle_bore_dwell": "boring with dwell, feed out",
    "cycle_bore_stop": "boring, spindle stop, rapid out",
    "cycle_tap_right": "right-hand tapping",
    "cycle_tap_left": "left-hand tapping",
    "arc_turns": "arc of more than one turn",
    "arc_radius": "arc by its radius",
    "arc_full": "full circle that does not name its end",
    "arc_helix": "helix",
    "arc_xz": "arc in XZ",
    "arc_yz": "arc in YZ",
    "arc_place": "arc whose centre is a place",
    "arc": "arc by its centre",
    "unit_cm": "centimetres",
    "unit_inch": "inches",
    "unit_mm": "millimetres",
    "relative": "relative places",
    "probe": "probing move",
    "rapid_straight": "rapid of several axes that must be straight",
    "inverse_time": "inverse time feed",
    "per_revolution": "feed per revolution",
    "machine_feed": "move with feed in machine coordinates",
    "machine_move": "move in machine coordinates",
    "park": "parking place of the controller",
    "home": "reference run",
    "frame_rotate": "rotation of coordinates",
    "frame_scale_axis": "scaling of one axis, or of Z",
    "frame_scale": "scaling of coordinates",
    "frame_mirror": "mirrored coordinates",
    "frame_beyond": "work offset whose number the target does not have",
    "frame_select_axes": "work offset selected for some axes",
    "frame_store_here": "work offset set at the present place",
    "frame_store": "work offset stored",
    "frame_select": "work offset selected",
    "frame_select_local": "work offset selected while a local offset is in force",
    "frame_local_restore": "local offset restored",
    "frame_local_suspend": "local offset suspended",
    "frame_local_add": "local offset added to",
    "frame_local_at": "local offset at a place",
    "frame_local_here": "local offset set at the present place",
    "frame_local_off": "local offset off",
    "frame_zero_recall": "work zero brought back",
    "frame_zero_keep": "work zero kept",
    "frame_zero_register": "work zero kept in one of several places",
    "frame_zero_shift": "work zero moved",
    "frame_zero_at": "work zero at a machine place",
    "frame_length": "work zero set while a tool length is in force",
    "path_filter": "path mode with a filter",
    "path_continuous": "continuous path",
    "path_tolerance": "tolerance of continuous path",
    "path_exact_stop": "exact stop",
    "path_exact_path": "exact path",
    "compensation_open": "cutter compensation whose path the manual leaves open",
    "compensation_plane": "cutter compensation in XZ or YZ",
    "compensation": "cutter compensation",
    "compensation_diameter": "cutter compensation with a diameter of its own",
    "length": "tool length offset",
    "tool_select": "tool selected before the change",
    "tool_change_selected": "change to the tool that was selected before",
    "tool_change_rests": "tool change that stops the spindle",
    "tool_change_running": "tool change that leaves the spindle as it is",
    "tool_change": "tool change",
    "spindle_speed": "spindle speed",
    "spindle_reverse": "spindle from one direction straight into the other",
    "spindle": "spindle on and off",
    "mist": "mist coolant",
    "flood": "flood coolant",
    "output_moving": "output without stopping motion",
    "output": "output",
    "input_read": "input that is read into a variable",
    "wait_timeout": "wait for an input, with a time limit",
    "wait_open": "wait for an input whose limit the manual does not say",
    "wait": "wait for an input",
    "dwell": "dwell",
    "optional_stop": "optional stop",
    "stop": "program stop",
    "guard": "guard of the controller on or off",
    "overrides": "overrides allowed or not",
    "message": "message",
    "feed_alone": "feed on a line of its own",
    "straight": "straight move with feed",
    "rapid": "rapid",
    "end_reset_running": "end of program with reset that leaves spindle or coolant on",
    "end_running": "end of program that leaves spindle or coolant on",
    "end_rests": "end of program that stops spindle and coolant",
    "end_reset": "end of program with reset",
    "end": "end of program",
    "comment": "comment",
}
"""Every feature of a Job, in words; those that others are rewritten into come after them, so that rewriting ends."""

NOWHERE: dict[str, str] = {
    "arc_turns": "an arc is at most one turn",
    "frame_local_add": "a local offset is set, never added to",
    "frame_local_at": "a local offset is the name of the present place",
    "compensation_open": "which path the source takes its manual does not say (McuWIN 2.7)",
    "compensation_plane": "which path a controller takes next to a contour in XZ or YZ is its own",
    "compensation_diameter": "the tool table has the diameter",
    "not_raised": "it has no neutral form",
}
"""Why constructs are refused for every target, in the same words."""

RANK = {name: len(FEATURES) - place for place, name in enumerate(FEATURES)}
"""Patterns may only produce features of a lower rank than the one that they remove."""


@record(frozen=True, slots=True, kw_only=True)
class Style:
    """How programs are written. decimals: most places after the point of mm, inches, degrees and other numbers;
    extension: of files; header, footer: lines of every program; newline; indent: blanks a block; numbers: step of line
    numbers, 0 for none; line_length: most characters, 0 for any; taken: names in upper case that subprogram files may
    not have."""

    decimals_mm: int = 4
    decimals_inch: int = 5
    decimals_deg: int = 4
    decimals: int = 4
    extension: str = ".nc"
    header: tuple[str, ...] = ()
    footer: tuple[str, ...] = ()
    newline: str = "\n"
    indent: int = 2
    numbers: int = 0
    line_length: int = 0
    taken: frozenset[str] = frozenset()


@record(frozen=True, slots=True, kw_only=True)
class Target:
    """legal: feature -> section of the manual; variables: numbers that a program may use freely;
    operators: of expressions, by the names of ``ir.rules`` UNARY and BINARY, none: its writer knows; axes: names of
    those that programs have; path_modes: whether programs say how corners are taken; straight_rapids: rapids of several
    axes are straight lines, None: the manual does not say; offsets: numbers of work offsets; tools: highest number;
    peck_clearance: mm above the last peck at which cycles go on, None: not the same on every machine;
    ends_with_file: a program may end without a code, which leaves everything as it is;
    spare_offset: the work offset that zeros in machine places use, 0 for none; cycle_returns: cycles can
    end at the height before them; two_ways: a choice can have an other way, too; guards: names of those that it has;
    lacks: feature -> why a construct that nothing rewrites is refused, with the section;
    axis_channels: the number of an output is that of an axis and two digits;
    length_numbers: programs give a tool's length as a number, because there is no tool table; one_way: directions
    (``cw``, ``ccw``) whose command leaves on what turns the spindle the other way; channels: the section that
    says the highest number of outputs and inputs, and that number; "": any."""

    name: str
    title: str
    legal: dict[str, str] = field(repr=False)
    style: Style = Style()
    variables: tuple[int, int] = (0, -1)
    operators: frozenset[str] = frozenset()
    axes: tuple[str, ...] = ("x", "y", "z", "a", "b", "c")
    path_modes: bool = False
    straight_rapids: bool | None = None
    offsets: int = 9
    tools: int = 99
    peck_clearance: float | None = None
    spare_offset: int = 0
    cycle_returns: bool = True
    ends_with_file: bool = False
    two_ways: bool = True
    axis_channels: bool = False
    guards: frozenset[str] = frozenset()
    lacks: dict[str, str] = field(default_factory=dict, repr=False)
    length_numbers: bool = False
    one_way: frozenset[str] = frozenset()
    channels: tuple[str, int] = ("", 0)

    def verify(self) -> None:
        """Features are those that there are; ValueError otherwise."""
        for feature, source in self.legal.items():
            if feature not in FEATURES or not source:
                raise ValueError(f"{self.name}: {feature!r} is no feature, or has no source")
        for feature, why in self.lacks.items():
            if feature not in FEATURES or not why:
                raise ValueError(f"{self.name}: {feature!r} is no feature, or has no reason")

    def why_not(self, feature: str) -> str:
        """Why it does not have a feature, in words."""
        return self.lacks.get(feature) or NOWHERE.get(feature) or f"{self.title} does not have it"
