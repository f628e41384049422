"""``gproof boards``: which boards and ports there are, what the board on a port is, the reference firmware."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gproof.backend.boards.board import EMULATOR, VIRTUAL, BoardError
from gproof.backend.boards.registry import BOARDS, REAL
from gproof.driver.errors import UsageError
from gproof.driver.escape import in_one_line
from gproof.driver.files import require_place, write_bytes

if TYPE_CHECKING:
    from gproof.backend.boards.klipper.probe import Probed

LISTED, PROBED = "gproof-boards/1", "gproof-probe/1"
"""Schemas, docs/boards.md."""


def run_list(as_json: bool) -> int:
    """The kinds of boards, and the ports."""
    kinds = [{"name": name, "kind": _kind(name), "about": _about(name)} for name in BOARDS]
    ports = list(_ports())
    if as_json:
        click.echo(json.dumps({"schema": LISTED, "boards": kinds, "ports": ports}, indent=2))
        return 0
    click.echo("boards")
    width = max(len(one["name"]) for one in kinds)
    for one in kinds:
        click.echo(f"  {one['name']:<{width}}  {one['about']}")
    click.echo("ports" if ports else "ports: none found")
    width = max((len(one["port"]) for one in ports), default=0)
    for one in ports:
        click.echo(in_one_line(f"  {one['port']:<{width}}  {one['description'] or 'no description'}"))
    return 0


def _kind(name: str) -> str:
    if name in REAL:
        return "real"
    return name if name in (VIRTUAL, EMULATOR) else "model"


def _about(name: str) -> str:
    """What the registry says of a board."""
    return (BOARDS[name].__doc__ or "").strip().partition("\n")[0].rstrip(".")


def _ports() -> Iterator[dict[str, str]]:
    """Ports that the system knows; pseudo-terminals and addresses are none of them."""
    from serial.tools import list_ports

    for one in sorted(list_ports.comports()):
        description = "" if one.description in (None, "n/a") else str(one.description)
        hardware = "" if one.hwid in (None, "n/a") else str(one.hwid)
        yield {"port": str(one.device), "description": description, "hardware": hardware}


def run_probe(port: str, baud: int | None, as_json: bool) -> int:
    """What the board on a port says of itself; UsageError where there is none."""
    from gproof.backend.boards.klipper.lines import BAUD
    from gproof.backend.boards.klipper.probe import probe

    rate = baud or BAUD
    try:
        found = probe(port, rate)
    except BoardError as error:
        raise UsageError(_named(port, str(error))) from None
    if as_json:
        click.echo(json.dumps(_json(port, rate, found), indent=2))
        return 0
    for line in _lines(port, rate, found):
        click.echo(in_one_line(line))
    return 0


def _named(port: str, what: str) -> str:
    """A text about a port, which names it."""
    return what if what.startswith(f"{port}:") else f"{port}: {what}"


def _json(port: str, baud: int, found: Probed) -> dict[str, Any]:
    return {
        "schema": PROBED,
        "port": port,
        "baud": baud,
        "board": "klipper",
        "identity": found.identity,
        "firmware": found.firmware,
        "clock_hz": found.clock,
        "uptime_ticks": found.uptime,
        "extension": found.extension,
        "state": found.state,
        "section": found.section or None,
        "configuration_crc": found.configured,
        "move_pool": found.moves,
        "receive_window": found.window,
        "motors_at_most": found.motors,
        "pins": list(found.pins),
        "problems": list(found.problems),
    }


def _lines(port: str, baud: int, found: Probed) -> Iterator[str]:
    certified = "none: no step is refused for want of a certificate, and none is counted"
    if found.extension is not None:
        certified = f"version {found.extension}"
    pool = "known when it is configured" if found.moves is None else f"{found.moves} runs"
    states = {
        "shutdown": "in a shutdown",
        "configured": f"configured (checksum {found.configured or 0:08x})",
        "not-configured": "not configured",
    }
    yield f"{port}: {found.identity or 'a board of no name'}"
    yield f"  board       klipper, {baud} baud, receive buffer of {found.window} bytes"
    yield f"  firmware    {found.firmware or 'of no version'}"
    yield f"  clock       {found.clock / 1e6:g} MHz, on for {found.uptime / found.clock:.1f} s"
    yield f"  extension   {certified}"
    yield f"  state       {states[found.state]}" + (f", {found.section}" if found.section else "")
    yield f"  move pool   {pool}"
    yield f"  motors      {found.motors} at most, by its {len(found.pins)} pins"
    yield f"  pins        {', '.join(_ranges(found.pins))}"
    for problem in found.problems:
        yield f"  problem     {problem}"


def _ranges(pins: Sequence[str]) -> list[str]:
    """``PA0 to PA7`` for names that follow one another."""
    found: list[str] = []
    for _, run in itertools.groupby(enumerate(pins), key=lambda pair: _series(pair[1], pair[0])):
        names = [name for _, name in run]
        found.append(names[0] if len(names) == 1 else f"{names[0]} to {names[-1]}")
    return found


def _series(name: str, place: int) -> tuple[str, int]:
    """The same for names that differ by as much as their places."""
    stem = name.rstrip("0123456789")
    digits = name[len(stem) :][:9]
    return (stem, int(digits) - place) if digits else (name, -1)


def run_firmware(chip: str, output: Path) -> int:
    """Write the shipped image of a chip; never over another file."""
    from gproof.backend.firmware import image

    require_place(output, "output")
    if output.exists():
        raise UsageError(f"output {output}: already exists; choose another name")
    data = image(chip)
    write_bytes(output, data, "output")
    click.echo(in_one_line(f"{output}: reference firmware for the ATmega{chip.upper()}, {len(data)} bytes"))
    click.echo("  flash it with avrdude (see gproof boards firmware --help), then: gproof boards probe PORT")
    return 0
