"""The table of ``docs/translation.md`` as the code gives it: what becomes of each construct on each target."""

from __future__ import annotations

from collections.abc import Callable

from support.goldens import ROOT

from gproof.driver.targets import TARGETS
from gproof.ir.target import FEATURES, Target
from gproof.passes.legalize.pattern import Pattern
from gproof.passes.legalize.registry import PATTERNS

PAGE = ROOT / "docs" / "translation.md"
BEGIN, END = "<!-- made by make goldens, from here -->", "<!-- made by make goldens, to here -->"
LEFT_OUT = {"not_raised", "operator"}
"""What is no construct of a program."""
JUMPS = "loops and choices"
"""What jumps become before any pattern (passes/legalize/structured.py)."""


def has(*features: str) -> Callable[[Target], bool]:
    """A target with these features."""
    return lambda target: all(feature in target.legal for feature in features)


NEEDS: dict[str, Callable[[Target], bool]] = {
    "arguments -> variables": has("variable"),
    "wait for an input -> loop that looks": lambda target: (
        "while" in target.legal and bool({"input_read", "input_value"} & target.legal.keys())
    ),
    "input in a condition -> read before": has("input_read"),
    "counted loop -> loop with a condition": has("variable"),
    "zero at a machine place -> spare work offset": lambda target: target.spare_offset > 0,
    "unit -> another unit": has("unit_mm"),
    "path mode -> a setting of the controller": lambda target: not target.path_modes,
    "filter of a path mode -> every place": has("path_continuous"),
    "continuous path -> exact path": has("path_exact_path"),
    "work offset with a local offset -> with a shift": has("frame_zero_shift"),
    "stored work offset -> zero at its place": has("frame_zero_at"),
    "work offset after a shift -> shift off, work offset": has("frame_local_here"),
    "local offset -> shift of the zero": has("frame_zero_shift"),
    "tool change -> stop": lambda target: "tool_change" not in target.legal,
    "change that stops the spindle -> spindle off, change": lambda target: (
        "tool_change_running" in target.legal or "tool_change" not in target.legal
    ),
    "change that leaves the spindle as it is -> change, where it rests": has("tool_change_rests"),
    "end that leaves spindle or coolant on -> end of the file": lambda target: (
        target.ends_with_file or "end_running" in target.legal
    ),
    "zero in one of several places -> its work offset": has("frame_zero_at"),
    "tool length -> shift of the zero": has("frame_zero_shift"),
    "zero while a tool length is in force -> moved by it": has("frame_zero_shift"),
    "machine coordinates -> zero there and back": has("frame_zero_keep", "frame_zero_at", "frame_zero_recall"),
}
"""What a pattern needs of a target; the others fit every target."""


def _clearance(target: Target) -> str:
    known = target.peck_clearance is not None and "cycle_peck" in target.legal
    return f"{target.legal['cycle_peck']}, where it is {target.peck_clearance:g} mm" if known else ""


OTHERWISE: dict[str, Callable[[Target], str]] = {
    "choice_else": lambda target: target.legal.get("choice", "") if target.two_ways else "",
    "cycle_return": lambda target: target.legal.get("cycle_drill", "") if target.cycle_returns else "",
    "cycle_clearance": _clearance,
    "frame_length": lambda target: target.legal.get("length", ""),
    "frame_select_local": lambda target: (
        target.legal.get("frame_select", "") if "frame_local_here" in target.legal else ""
    ),
}
"""Constructs that a field of a target decides, no row of its table: the section, "" where it does not have them."""


def fits(pattern: Pattern, feature: str, target: Target) -> bool:
    """Whether a pattern may remove a feature for a target."""
    return feature in pattern.removes and NEEDS.get(pattern.name, has())(target)


def cell(feature: str, target: Target) -> str:
    """Of one construct on one target."""
    if feature in OTHERWISE:
        source = OTHERWISE[feature](target)
        if source:
            return f"kept: {source}"
    if feature in target.legal:
        return f"kept: {target.legal[feature]}".replace("|", "\\|")
    if feature == "jump":
        return f"→ {JUMPS}"
    numbers = [str(n) for n, pattern in enumerate(PATTERNS, 1) if fits(pattern, feature, target)]
    return f"→ {', '.join(numbers)}" if numbers else f"refused: {target.why_not(feature)}"


def table() -> str:
    """The table and the list of patterns."""
    targets = [entry.target() for entry in TARGETS.values()]
    lines = [
        f"| construct | {' | '.join(target.title for target in targets)} |",
        f"|---|{'---|' * len(targets)}",
    ]
    for feature, title in FEATURES.items():
        if feature not in LEFT_OUT:
            lines.append(f"| {title} | {' | '.join(cell(feature, target) for target in targets)} |")
    lines += ["", *(f"{n}. {pattern.name.replace('->', '→')}" for n, pattern in enumerate(PATTERNS, 1))]
    return "\n".join(lines)


def page() -> str:
    """The page with the table anew."""
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    after = rest.partition(END)[2]
    return f"{before}{BEGIN}\n\n{table()}\n\n{END}{after}"
