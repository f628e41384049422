"""How help is laid out: options under titles, their defaults in words, examples at the end of a command.

``Option`` and ``Command`` are those of click with a title, and with examples. Nothing here decides what a command does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import click

_Decorated = TypeVar("_Decorated", bound=Callable[..., Any])

GENERAL = "Other options"
CHOICES = "{choices}"
"""In the help of an option: the names that it takes."""


class Option(click.Option):
    """An option with the title that it is listed under. Its help says itself what is taken when it is not given."""

    def __init__(self, *names: Any, title: str = GENERAL, **attributes: Any) -> None:
        super().__init__(*names, **attributes)
        self.title = title

    def get_help_record(self, ctx: click.Context) -> tuple[str, str] | None:
        """Names and help, without the ranges of numbers that click adds."""
        shown = super().get_help_record(ctx)
        if shown is None:
            return None
        text = self.help or ""
        if CHOICES in text:
            text = text.replace(CHOICES, ", ".join(self._names(ctx)))
        return shown[0], text + (" [required]" if self.required else "")

    def _names(self, ctx: click.Context) -> Iterable[str]:
        return [item.value for item in self.type.shell_complete(ctx, self, "")]


def option(*names: str, **attributes: Any) -> Callable[[_Decorated], _Decorated]:
    """``click.option`` with a title."""
    return click.option(*names, cls=Option, **attributes)


class Command(click.Command):
    """A command whose options are under titles, in the order in which the titles come; examples: command lines."""

    def __init__(self, *names: Any, examples: Iterable[str] = (), **attributes: Any) -> None:
        super().__init__(*names, **attributes)
        self.examples = tuple(examples)

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Print the options; all their columns start at one place."""
        print_options(self, ctx, formatter)

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Print the examples."""
        print_examples(self.examples, formatter)


def print_options(command: click.Command, ctx: click.Context, formatter: click.HelpFormatter) -> None:
    """Options under their titles."""
    titled: dict[str, list[tuple[str, str]]] = {}
    for one in command.get_params(ctx):
        shown = one.get_help_record(ctx) if isinstance(one, click.Option) else None
        if shown is not None:
            titled.setdefault(getattr(one, "title", GENERAL), []).append((shown[0], shown[1].rstrip(".")))
    titled[GENERAL] = titled.pop(GENERAL)
    width = max(len(names) for rows in titled.values() for names, _ in rows)
    for title, rows in titled.items():
        with formatter.section(title if len(titled) > 1 else "Options"):
            formatter.write_dl([(f"{names:<{width}}", text) for names, text in rows])


def print_examples(examples: Iterable[str], formatter: click.HelpFormatter) -> None:
    """Command lines under a title, each as it is."""
    lines = tuple(examples)
    if lines:
        with formatter.section("Examples"):
            for line in lines:
                formatter.write(f"{'':>{formatter.current_indent}}{line}\n")


class Group(click.Group):
    """Commands of one name; examples: command lines."""

    def __init__(self, *names: Any, examples: Iterable[str] = (), **attributes: Any) -> None:
        super().__init__(*names, **attributes)
        self.examples = tuple(examples)

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Print the options, then the commands."""
        print_options(self, ctx, formatter)
        self.format_commands(ctx, formatter)

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Print the examples."""
        print_examples(self.examples, formatter)
