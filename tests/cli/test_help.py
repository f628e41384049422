"""The help of every command: it fits a terminal, every option says what it is for, its examples are command lines."""

import shlex
from collections.abc import Iterator

import click
import pytest

from gproof.cli.help import Command, Group, Option
from gproof.cli.main import cli, main

COLUMNS = 80


def commands(group: click.Group, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], click.Command]]:
    """Every command with its words, the groups too."""
    yield path, group
    for name, command in group.commands.items():
        if isinstance(command, click.Group):
            yield from commands(command, (*path, name))
        else:
            yield (*path, name), command


ALL = dict(commands(cli))


@pytest.mark.parametrize("path", ALL, ids=lambda path: " ".join(path) or "gproof")
def test_the_help_fits_a_terminal(
    path: tuple[str, ...], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "300")  # click takes at most 80 of them
    assert main([*path, "--help"]) == 0
    shown = capsys.readouterr().out
    assert max(map(len, shown.splitlines())) <= COLUMNS
    assert [line for line in shown.splitlines() if line != line.rstrip()] == []
    assert "{" not in shown, "a name that nothing has filled in"
    assert "INTEGER" not in shown
    assert "RANGE" not in shown
    assert shown.index("Examples:") > shown.index("--help")


@pytest.mark.parametrize("path", ALL, ids=lambda path: " ".join(path) or "gproof")
def test_every_option_says_what_it_is_for(path: tuple[str, ...]) -> None:
    command = ALL[path]
    for one in command.params:
        if isinstance(one, click.Option):
            assert isinstance(one, Option), f"{one.opts}: of cli/help.py, so that it has a title"
            assert one.help is not None
            assert one.help[:1].isupper(), one.opts
            assert not one.help.endswith("."), one.opts
            assert one.is_flag or one.metavar or isinstance(one.type, click.Choice) or one.name == "board", one.opts
    assert not path or not command.get_short_help_str(200).endswith(".")
    for name in command.list_commands(click.Context(command)) if isinstance(command, click.Group) else ():
        assert "..." not in ALL[(*path, name)].get_short_help_str(64)


@pytest.mark.parametrize("path", ALL, ids=lambda path: " ".join(path) or "gproof")
def test_the_examples_are_command_lines(path: tuple[str, ...]) -> None:
    command = ALL[path]
    assert isinstance(command, Command | Group)
    assert command.examples
    for line in command.examples:
        words = shlex.split(line)
        cut = next((n for n, word in enumerate(words) if word in "<>"), len(words))
        name, *words = words[:cut]
        assert name == "gproof"
        assert tuple(words[: len(path)]) == path
        there: click.Command = cli
        while isinstance(there, click.Group):
            there = there.commands[words.pop(0)]
        there.make_context("gproof", words)
