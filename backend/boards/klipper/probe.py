"""What the board on a port says of itself. Nothing is configured, cleared or moved: only questions are sent."""

from __future__ import annotations

from gproof.backend.boards.board import BoardError
from gproof.backend.boards.klipper.connection import Connection
from gproof.backend.boards.klipper.dictionary import Dictionary, DictionaryError
from gproof.backend.boards.klipper.lines import Line, SerialLine
from gproof.backend.boards.klipper.session import ANSWERS, CERTIFIED, EXTENSION, NEEDED, OUTPUTS, VERSION
from gproof.ir.record import record

STATES = ("no identity", "identity", "section", "shutdown")
"""Of the certification extension, docs/boards.md."""


@record(frozen=True, slots=True, kw_only=True)
class Probed:
    """A board as it is.

    identity: the chip that its dictionary names; firmware: the version; clock: Hz; uptime: ticks since it started;
    extension: the number of the certification extension, None: it has none; pins: names of the dictionary, by number;
    motors: how many have two pins each at most; moves: places of its pool, None: unknown before it is configured;
    configured: the checksum of its configuration, None: it has none; shutdown: one is in force; section: what the
    extension says of its state, "" without; window: bytes of its receive buffer; problems: why it cannot be used.
    """

    identity: str
    firmware: str
    clock: int
    uptime: int
    extension: int | None
    pins: tuple[str, ...]
    motors: int
    moves: int | None
    configured: int | None
    shutdown: bool
    section: str
    window: int
    problems: tuple[str, ...]

    @property
    def state(self) -> str:
        """One word for it."""
        return "shutdown" if self.shutdown else "not-configured" if self.configured is None else "configured"


def probe(port: str, baud: int) -> Probed:
    """Ask the board on a port; BoardError where there is none."""
    line = SerialLine(port, baud)
    try:
        return asked(line)
    finally:
        line.close()


def asked(line: Line) -> Probed:
    """Ask the board at the other end of a line; BoardError."""
    link = Connection(line, lambda _: None)
    link.synchronise()
    dictionary = link.identify()
    extension = dictionary.constants.get(EXTENSION)
    extension = extension if isinstance(extension, int) else None
    for name, fields in (("get_config", ()), ("get_uptime", ())):
        dictionary.command(name, fields)
    for name in ("config", "uptime"):
        dictionary.response(name, ANSWERS[name])
    config = link.query("get_config", "config").fields
    uptime = link.query("get_uptime", "uptime").fields
    pins = dictionary.enumerations.get("pin", {})
    configured = bool(config["is_config"])
    return Probed(
        identity=str(dictionary.constants.get("MCU", "")),
        firmware=dictionary.version,
        clock=dictionary.number("CLOCK_FREQ"),
        uptime=_number(uptime["high"]) << 32 | _number(uptime["clock"]),
        extension=extension,
        pins=tuple(sorted(pins, key=lambda name: pins[name])),
        motors=len(pins) // 2,
        moves=_number(config["move_count"]) if configured else None,
        configured=_number(config["crc"]) if configured else None,
        shutdown=bool(config["is_shutdown"]),
        section=_section(link, dictionary, extension),
        window=link.transport.window,
        problems=tuple(_problems(dictionary, extension)),
    )


def _number(value: object) -> int:
    if not isinstance(value, int):
        raise BoardError("the board answers a number with text")
    return value


def _section(link: Connection, dictionary: Dictionary, extension: int | None) -> str:
    """What firmware with the extension that is known here says of its state."""
    if extension != VERSION or "cert_get_state" not in dictionary.commands or "cert_state" not in dictionary.responses:
        return ""
    state = link.query("cert_get_state", "cert_state").fields.get("state")
    return STATES[state] if isinstance(state, int) and 0 <= state < len(STATES) else ""


def _problems(dictionary: Dictionary, extension: int | None) -> list[str]:
    """Why a run would be refused, whatever is wired."""
    found = []
    if extension not in (None, VERSION):
        found.append(f"the firmware has version {extension} of the extension, and {VERSION} is known here")
    needed = NEEDED | OUTPUTS | (CERTIFIED if extension == VERSION else {})
    for name, fields in needed.items():
        try:
            dictionary.command(name, fields)
        except DictionaryError as error:
            found.append(f"{error}, which outputs need" if name in OUTPUTS else str(error))
    for name, fields in ANSWERS.items():
        try:
            dictionary.response(name, fields)
        except DictionaryError as error:
            found.append(str(error))
    return found
