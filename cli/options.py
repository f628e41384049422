"""What options of the command line take: names of files, files that are given once, names of properties.

Built on click; a value that does not fit is one line on standard error and exit code 3 (``cli/main.py``).
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from gproof.cli.help import option
from gproof.passes.checks.registry import added

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    _NameType = click.ParamType[str]
else:
    _NameType = click.ParamType  # which older versions of click do not have as a generic

_Command = TypeVar("_Command", bound=Callable[..., Any])

FILE = "FILE"
GIVEN, PROGRAM, REQUIRED = "Machine and setup", "Program", "Requirements"
REPORT, SEVERAL, PACKAGE, RECORD = "Output", "Several jobs", "Package", "Record of the run"
AGAIN, BOARD, READ, TRANSLATION = "Compile again", "Run", "Input", "Translation"
"""Titles of options in the help."""
MOST = 10**15
"""Of what is counted: whatever is larger says no more."""
NO_END = 10**9
"""From here on the upper end of a range of numbers is one that nobody meets."""


class FileName(click.Path):
    """The name of a file or folder; an empty one is none (it would be the current folder)."""

    def __init__(self, *, allow_dash: bool = False) -> None:
        super().__init__(path_type=Path, allow_dash=allow_dash)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The path; a usage error for an empty name."""
        if value == "":
            self.fail("the file name is empty.", param, ctx)
        return super().convert(value, param, ctx)


class Finite(click.FloatRange):
    """A range of numbers, NaN and infinity not among them; a thousand million at most where none is named."""

    def __init__(self, low: float, high: float = NO_END) -> None:
        super().__init__(low, high)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The number; a usage error for what is none."""
        with contextlib.suppress(TypeError, ValueError):
            if not math.isfinite(float(value)):
                self.fail(f"{value!r} is not a finite number.", param, ctx)
        return float(super().convert(value, param, ctx))


class OneOf(_NameType):
    """One of the names of a registry, which is read when it is needed: listing commands imports none."""

    name = "choice"

    def __init__(self, names: Callable[[], Iterable[str]]) -> None:
        self._names = names

    def _choice(self) -> click.Choice[str]:
        return click.Choice(list(self._names()))

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The name; a usage error for any other text."""
        return self._choice().convert(value, param, ctx)

    def get_metavar(self, *where: Any, **more: Any) -> str | None:
        """``[eding|wincnc|mcuwin]``."""
        return self._choice().get_metavar(*where, **more)

    def get_missing_message(self, *where: Any, **more: Any) -> str:
        """Which names there are."""
        return self._choice().get_missing_message(*where, **more)

    def shell_complete(self, ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
        """The names that start so."""
        return self._choice().shell_complete(ctx, param, incomplete)


def dialects() -> Iterable[str]:
    """What ``--dialect`` takes."""
    from gproof.driver.dialects import DIALECTS

    return DIALECTS


def boards() -> Iterable[str]:
    """What ``--board`` takes."""
    from gproof.backend.boards.registry import BOARDS

    return BOARDS


def chips() -> Iterable[str]:
    """What ``--chip`` takes."""
    from gproof.backend.firmware import CHIPS

    return CHIPS


def documents() -> Iterable[str]:
    """What ``--format`` of ``check`` takes."""
    from gproof.report.formats import DOCUMENTS

    return ("text", *DOCUMENTS)


def _one(context: click.Context, parameter: click.Parameter, values: tuple[Any, ...]) -> Any:
    different = list(dict.fromkeys(values))
    if len(different) > 1:
        raise click.BadParameter(f"given twice, as {different[0]} and as {different[1]}; give one.", context, parameter)
    if different and different[0] == "":
        raise click.BadParameter("the file name is empty.", context, parameter)
    return different[0] if different else None


def once(*names: str, **attributes: Any) -> Callable[[_Command], _Command]:
    """An option that decides what a job is judged with: two different ones are a mistake, and no last one counts."""
    return option(*names, multiple=True, callback=_one, **attributes)


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


ALSO = option(
    "--also",
    title=REQUIRED,
    multiple=True,
    callback=_properties,
    metavar="PROPERTY,...",
    help=f"Check these properties too: {', '.join(added())}, or all",
)
FORMAT = option(
    "--format", "form", title=REPORT, type=click.Choice(["text", "json"]), default="text",
    help="Format of the report [default: text]",
)  # fmt: skip
UNITS = option(
    "--units", title=REPORT, type=click.Choice(["mm", "inch"]),
    help="Unit of lengths in texts [default: that of the machine file]",
)  # fmt: skip
JOB = click.argument("job", type=FileName())


def job_options(command: Any, *, machines: bool = False) -> Any:
    """The options of every command that reads a job; machines: of one that takes several of them."""
    said = {"title": GIVEN, "metavar": FILE, "type": FileName()}
    text = "Machine file: TOML, or the controller's own"
    several = option("--machine", multiple=True, help=text + "; may be repeated", **said)
    for one in reversed(
        (
            several if machines else once("--machine", help=text, **said),
            once(
                "--setup", title=GIVEN, metavar=FILE,
                help='Setup file, or "zero": homed, at machine zero, no offsets, tool 0',
            ),
            option(
                "--dialect", title=GIVEN, metavar="NAME", type=OneOf(dialects),
                help="Controller of the program: {choices} [default: detected]",
            ),
            option(
                "--call", title=PROGRAM, metavar="NAME",
                help="Take this subprogram of JOB, such as user_1, as its button runs it",
            ),
            option(
                "--render", title=PROGRAM, is_flag=True,
                help="Run as in the controller's render mode: probes miss, dialogs get OK",
            ),
            option(
                "--max-blocks", title=PROGRAM, metavar="N", type=click.IntRange(1, MOST),
                help="Blocks to execute at most [default: 5 million and 4 a line]",
            ),
            option(
                "--max-branches", title=PROGRAM, metavar="N", type=click.IntRange(0, MOST), default=4096,
                help="Branches to explore at most where a condition is unknown [default: 4096]",
            ),
        )
    ):  # fmt: skip
        command = one(command)
    return command


def package_options(command: Any) -> Any:
    """The options of every command that believes, or does not believe, a package."""
    for one in reversed(
        (
            once(
                "--machine", title=REQUIRED, metavar=FILE, type=FileName(),
                help="Machine file that the package must have been made for",
            ),
            once(
                "--setup", title=REQUIRED, metavar=FILE,
                help='Setup that it must have been made for: a file, or "zero"',
            ),
            once(
                "--source", title=REQUIRED, metavar=FILE, type=FileName(),
                help="Program that it must have been made from",
            ),
            option(
                "--trust", title=REQUIRED, metavar=FILE, type=FileName(), multiple=True,
                help="Public key to trust (PEM); may be repeated",
            ),
        )
    ):  # fmt: skip
        command = one(command)
    return command
