"""What a board with the certification extension says that it executed, asked after a run that nobody ended.

Only questions are sent: nothing is configured, cleared or moved, and a shutdown stays in force.
"""

from __future__ import annotations

from gproof.backend.boards.board import Executed
from gproof.backend.boards.klipper.connection import Connection
from gproof.backend.boards.klipper.dictionary import DictionaryError
from gproof.backend.boards.klipper.lines import Line, SerialLine
from gproof.backend.boards.klipper.messages import Fields
from gproof.backend.boards.klipper.session import ANSWERS, EXTENSION, IN_SECTION, VERSION
from gproof.backend.run_bounds import Told

QUESTIONS = {
    "cert_get_state": ("cert_state", ("state", "section", "promise", "stopped")),
    "cert_get_motor": ("cert_motor", ("oid", "steps", "pos", "crc")),
    "cert_get_identity": ("cert_identity", ("identity",)),
}
"""Source: docs/boards.md, "The certification extension"."""

NONE = 0xFFFFFFFF

PATIENCE, PAUSE = 5.0, 0.1
"""Seconds that a board is waited for that still carries out what it has stored, and between two questions."""


def told(port: str, baud: int, motors: int, identity: bytes) -> Told | None:
    """Ask the board on a port about so many motors of a stream; None where its firmware does not count.

    BoardError where there is none.
    """
    line = SerialLine(port, baud)
    try:
        return asked(line, motors, identity)
    finally:
        line.close()


def asked(line: Line, motors: int, identity: bytes) -> Told | None:
    """Ask the board at the other end of a line; BoardError. Motors are asked for only where it knows the stream: its
    numbers are those of another wiring otherwise, and a wrong one would stop it."""
    link = Connection(line, lambda _: None)
    link.synchronise()
    dictionary = link.identify()
    if dictionary.constants.get(EXTENSION) != VERSION:
        return None
    dictionary.command("get_config", ())
    dictionary.response("config", ANSWERS["config"])
    for question, (answer, fields) in QUESTIONS.items():
        dictionary.command(question, ("oid",) if question == "cert_get_motor" else ())
        dictionary.response(answer, fields)
    if not link.query("get_config", "config").fields["is_config"]:
        return Told(moving=False, section=None, identity=b"", executed=())
    until = line.now() + PATIENCE
    state = link.query("cert_get_state", "cert_state").fields
    while state["state"] == IN_SECTION and line.now() < until:
        pause = line.now() + PAUSE
        while line.now() < pause:
            link.pump(pause)
        state = link.query("cert_get_state", "cert_state").fields
    section = _number(state, "section")
    presented = link.query("cert_get_identity", "cert_identity").fields["identity"]
    executed = []
    for oid in range(motors if presented == identity else 0):
        made = link.query("cert_get_motor", "cert_motor", key="oid", oid=oid).fields
        executed.append(Executed(_number(made, "steps"), _number(made, "crc")))
    return Told(
        moving=state["state"] == IN_SECTION,
        section=None if section == NONE else section,
        identity=presented if isinstance(presented, bytes) else b"",
        executed=tuple(executed),
    )


def _number(fields: Fields, name: str) -> int:
    value = fields[name]
    if not isinstance(value, int):
        raise DictionaryError(f"{name} is no number")
    return value
