"""How corners are taken, and overrides: what a target's programs cannot say is a setting of its controller."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.job import AllowOverrides, Node, SetPathMode
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern


def left_to_the_controller(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A path mode, for a target without any; never exact stop, which a corner may need."""
    if not isinstance(node, SetPathMode) or context.target.path_modes or node.mode == "exact_stop":
        return None
    context.assume(f"how corners are taken is a setting of {context.target.title}, not of the program")
    return []


def without_tolerance(node: Node, feature: str, context: Context) -> list[Node] | None:
    """Continuous path with a tolerance -> exact path, which is within every tolerance."""
    if not isinstance(node, SetPathMode) or "path_exact_path" not in context.target.legal:
        return None
    context.assume("exact path instead of continuous path: the same places, slower at corners")
    return [replace(node, mode="exact_path", tolerance=None)]


def usual_overrides(node: Node, feature: str, context: Context) -> list[Node] | None:
    """Overrides allowed: what every controller does."""
    return [] if isinstance(node, AllowOverrides) and node.on else None


PATTERNS = (
    Pattern(
        name="path mode -> a setting of the controller", apply=left_to_the_controller,
        removes=("path_continuous", "path_tolerance", "path_exact_path"),
    ),
    Pattern(
        name="continuous path -> exact path", removes=("path_continuous", "path_tolerance"), apply=without_tolerance
    ),
    Pattern(name="overrides allowed -> as always", removes=("overrides",), apply=usual_overrides),
)  # fmt: skip
