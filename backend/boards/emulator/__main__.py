"""``python -m gproof.backend.boards.emulator``: arguments in; the addresses on standard output, a line each.

Exit 0: it ended as it was asked to; 3: it could not start, with one line that says why.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import NoReturn

from gproof.backend.boards.emulator.dictionary import CHIPS
from gproof.backend.boards.emulator.emulator import Emulator, Options
from gproof.backend.boards.emulator.faults import noise, parsed
from gproof.backend.boards.emulator.log import Log
from gproof.backend.boards.emulator.objects import Switch
from gproof.backend.boards.emulator.ports import Port, Tcp, Terminal
from gproof.backend.boards.emulator.process import Life, Process

LARGEST_SCHEDULE = 1 << 24


class _Arguments(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise ValueError(message)


def _parser() -> argparse.ArgumentParser:
    parser = _Arguments(prog="python -m gproof.backend.boards.emulator", description="A board that exists only here.")
    add = parser.add_argument
    add("--profile", choices=("certified", "plain"), default="certified", help="with or without the cert_ commands")
    add("--chip", choices=sorted(CHIPS), default="atmega2560")
    add("--baud", type=int, default=250_000)
    add("--frequency", type=int, default=16_000_000, metavar="HZ", help="what the clock says that it counts")
    add("--drift", type=float, default=0.0, metavar="PPM", help="how far the clock's rate is off")
    add("--wander", type=float, default=0.0, metavar="PPM", help="how far it moves around that, second by second")
    add("--jitter", type=float, default=0.0, metavar="µS", help="how late an answer is at most")
    add("--start-clock", type=int, default=0, metavar="TICK", help="what the clock shows first")
    add("--busy", type=int, default=0, metavar="TICKS", help="what a command takes of the main loop")
    add("--window", type=int, default=192, metavar="BYTES", help="receive buffer")
    add("--without", action="append", default=[], metavar="COMMAND", help="a command that the firmware lacks")
    add("--seed", type=int, default=0, help="of noise, jitter and wander")
    add("--noise", default="", metavar="drop=P,flip=P,double=P,bursts=P,burst=N", help="chances of a byte")
    add("--faults", type=Path, metavar="FILE", help="a schedule of faults (docs/boards.md)")
    add(
        "--switch", action="append", default=[], metavar="PIN:STEP_PIN<=N", help="a limit switch: closed at or beyond N"
    )
    add("--input", action="append", default=[], metavar="PIN=LEVEL", help="an input's level")
    add("--log", type=Path, metavar="FILE", help="every step made, every output, every stop")
    add("--link", type=Path, metavar="PATH", help="a symbolic link to the pseudo-terminal")
    add("--tcp", type=int, nargs="?", const=0, metavar="NUMBER", help="a local TCP port instead")
    add("--control", type=int, nargs="?", const=0, metavar="NUMBER", help="a control channel on a local TCP port")
    add("--simulated", action="store_true", help="time and line are the control channel's")
    add("--linger", type=float, default=10.0, metavar="S", help="goes on so long after its host has gone")
    add("--stay", action="store_true", help="goes on until it is stopped")
    return parser


def _pin(name: str) -> int:
    if len(name) < 3 or name[0] != "P" or not "A" <= name[1] <= "Z" or name[2:] not in map(str, range(8)):
        raise ValueError(f"{name[:20]!r} is no pin")
    return 8 * (ord(name[1]) - 65) + int(name[2])


def _switch(text: str) -> Switch:
    """``PB4:PA0<=-200``: the pin is high where the motor with that step pin is at -200 or below."""
    pin, _, rest = text.partition(":")
    sign = "<=" if "<=" in rest else ">="
    step_pin, found, position = rest.partition(sign)
    if not found:
        raise ValueError(f"{text[:40]!r} is no switch like PB4:PA0<=-200")
    return Switch(_pin(pin), _pin(step_pin), sign == ">=", int(position))


def _input(text: str) -> tuple[int, int]:
    name, _, level = text.partition("=")
    if level not in ("0", "1"):
        raise ValueError(f"{text[:40]!r} is no input like PB4=1")
    return _pin(name), int(level)


def _within(name: str, value: float, low: float, high: float) -> float:
    if not low <= value <= high:
        raise ValueError(f"{name} is {value:g}, not {low:g} to {high:g}")
    return value


def _options(given: argparse.Namespace) -> Options:
    schedule = ""
    if given.faults is not None:
        if given.faults.stat().st_size > LARGEST_SCHEDULE:
            raise ValueError(f"{given.faults} is too long for a schedule")
        schedule = given.faults.read_text(encoding="utf-8")
    return Options(
        chip=given.chip,
        certified=given.profile == "certified",
        baud=int(_within("--baud", given.baud, 300, 10_000_000)),
        frequency=int(_within("--frequency", given.frequency, 10_000, 1_000_000_000)),
        window=int(_within("--window", given.window, 64, 1 << 16)),
        busy=int(_within("--busy", given.busy, 0, 1 << 24)),
        drift=round(1000 * _within("--drift", given.drift, -20_000, 20_000)),
        wander=round(1000 * _within("--wander", given.wander, 0, 1000)),
        jitter=round(1000 * _within("--jitter", given.jitter, 0, 1_000_000)),
        start=int(_within("--start-clock", given.start_clock, 0, 1 << 60)),
        seed=given.seed,
        noise=noise(given.noise),
        faults=tuple(parsed(schedule)),
        switches=tuple(map(_switch, given.switch)),
        without=frozenset(given.without),
    )


def _port(given: argparse.Namespace) -> Port | None:
    if given.simulated:
        return None
    if given.tcp is not None or not hasattr(os, "openpty"):
        return Tcp(int(_within("--tcp", given.tcp or 0, 0, 65_535)))
    return Terminal(given.baud, given.link)


def main(arguments: list[str]) -> int:
    """Run it; the exit code."""
    try:
        given = _parser().parse_args(arguments)
        inputs = list(map(_input, given.input))
        options, port = _options(given), _port(given)
        control = None
        if given.control is not None or given.simulated:
            control = Tcp(int(_within("--control", given.control or 0, 0, 65_535)))
        life = Life(None if given.stay else _within("--linger", given.linger, 0, 1e6))
        emulator = Emulator(options, Log(given.log.open("wb")) if given.log is not None else Log(keep=False))
        for pin, level in inputs:
            emulator.set_input(pin, level)
        Process(emulator, port, control, life).run(lambda line: print(line, flush=True))
    except (ValueError, OSError) as error:
        why = str(error)
        if isinstance(error, OSError) and error.strerror:
            why = f"{error.filename}: {error.strerror}" if error.filename else error.strerror
        print(f"board emulator: {why.splitlines()[0] if why else 'it cannot start'}", file=sys.stderr)
        return 3
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
