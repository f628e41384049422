"""How corners are taken, and overrides: what a target's programs cannot say is a setting of its controller."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.job import AllowOverrides, Node, SetPathMode, SwitchGuard
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


def without_filter(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A path mode without leave to drop places: all of them are kept."""
    if not isinstance(node, SetPathMode) or f"path_{node.mode}" not in context.target.legal:
        return None
    return [replace(node, simplify=None, angle=None)]


def no_guard(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A guard that the target does not have."""
    if not isinstance(node, SwitchGuard) or node.name in context.target.guards:
        return None
    context.assume(f"{context.target.title} has no guard that the program switches: {node.name.replace('_', ' ')}")
    return []


def usual_overrides(node: Node, feature: str, context: Context) -> list[Node] | None:
    """Overrides allowed: what every controller does."""
    return [] if isinstance(node, AllowOverrides) and node.on else None


PATTERNS = (
    Pattern(
        name="path mode -> a setting of the controller", apply=left_to_the_controller,
        removes=("path_filter", "path_continuous", "path_tolerance", "path_exact_path"),
    ),
    Pattern(name="filter of a path mode -> every place", removes=("path_filter",), apply=without_filter),
    Pattern(name="guard -> none", removes=("guard",), apply=no_guard),
    Pattern(
        name="continuous path -> exact path", removes=("path_continuous", "path_tolerance"), apply=without_tolerance
    ),
    Pattern(name="overrides allowed -> as always", removes=("overrides",), apply=usual_overrides),
)  # fmt: skip
