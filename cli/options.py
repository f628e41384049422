"""What options of the command line take: names of files, files that are given once, names of properties.

Built on click; a value that does not fit is one line on standard error and exit code 3 (``cli/main.py``).
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from gproof.passes.checks.registry import added

_Command = TypeVar("_Command", bound=Callable[..., Any])


class FileName(click.Path):
    """The name of a file or folder; an empty one is none (it would be the current folder)."""

    def __init__(self, *, allow_dash: bool = False) -> None:
        super().__init__(path_type=Path, allow_dash=allow_dash)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The path; a usage error for an empty name."""
        if value == "":
            self.fail("an empty name is no file.", param, ctx)
        return super().convert(value, param, ctx)


def _one(context: click.Context, parameter: click.Parameter, values: tuple[Any, ...]) -> Any:
    different = list(dict.fromkeys(values))
    if len(different) > 1:
        raise click.BadParameter(
            f"given as {different[0]} and as {different[1]}; a job is judged with one.", context, parameter
        )
    if different and different[0] == "":
        raise click.BadParameter("an empty name is no file.", context, parameter)
    return different[0] if different else None


def once(*names: str, **attributes: Any) -> Callable[[_Command], _Command]:
    """An option that decides what a job is judged with: two different ones are a mistake, and no last one counts."""
    return click.option(*names, multiple=True, callback=_one, **attributes)


def _properties(context: click.Context, parameter: click.Parameter, values: tuple[str, ...]) -> tuple[str, ...]:
    known = (*added(), "all")
    names = tuple(dict.fromkeys(name.strip() for value in values for name in value.split(",")))
    for name in names:
        if name not in known:
            from difflib import get_close_matches

            near = get_close_matches(name.lower(), known, 1, 0.7)
            said = f"{name!r} is not one of {', '.join(map(repr, known))}."
            raise click.BadParameter(said + (f" Did you mean {near[0]!r}?" if near else ""), context, parameter)
    return names


ALSO = click.option(
    "--also",
    multiple=True,
    callback=_properties,
    metavar="PROPERTY,...",
    help=f"Judge these too: {', '.join(added())}, or all; repeatable.",
)
