"""A connection with a board that is known to be fit: its language, its clock, its shutdowns and resets.

Nothing is sent but the commands in NEEDED; those in OUTPUTS where outputs are wired; those in CERTIFIED where the
firmware has the certification extension (docs/boards.md).
"""

from __future__ import annotations

from gproof.backend.boards.board import BoardError, Executed
from gproof.backend.boards.klipper.clock import CRYSTAL, BoardClock, Steadiness
from gproof.backend.boards.klipper.connection import Answer, Connection, Shutdown
from gproof.backend.boards.klipper.dictionary import DictionaryError
from gproof.backend.boards.klipper.lines import Line, LineLost
from gproof.backend.boards.klipper.wiring import Wiring, configure

NEEDED = {
    "get_config": (),
    "get_clock": (),
    "get_uptime": (),
    "allocate_oids": ("count",),
    "config_stepper": ("oid", "step_pin", "dir_pin", "invert_step", "step_pulse_ticks"),
    "finalize_config": ("crc",),
    "queue_step": ("oid", "interval", "count", "add"),
    "set_next_step_dir": ("oid", "dir"),
    "reset_step_clock": ("oid", "clock"),
    "stepper_get_position": ("oid",),
    "emergency_stop": (),
    "clear_shutdown": (),
}
"""Commands with their fields. Source: docs/boards.md; Klipper's MCU_Commands.md."""

OUTPUTS = {
    "config_digital_out": ("oid", "pin", "value", "default_value", "max_duration"),
    "queue_digital_out": ("oid", "clock", "on_ticks"),
}
"""Commands that are needed where outputs are wired. Source: Klipper's MCU_Commands.md."""

ANSWERS = {
    "config": ("is_config", "crc", "is_shutdown", "move_count"),
    "clock": ("clock",),
    "uptime": ("high", "clock"),
    "stepper_position": ("oid", "pos"),
}

EXTENSION, VERSION = "GPROOF_CERT", 1
"""The constant by which firmware says that it has the certification extension, and the version that is known here."""

STEP_RATE, STEP_TICKS, RUN_TICKS = "GPROOF_STEP_RATE", "GPROOF_STEP_TICKS", "GPROOF_RUN_TICKS"
"""Constants by which firmware says how many steps a second of all motors together it makes on their ticks, and how many
ticks its processor takes for a step and for a run that comes."""

CERTIFIED = {
    "cert_begin": ("identity",),
    "cert_section": ("number", "clock"),
    "cert_commit": ("clock",),
    "cert_rest": (),
    "cert_finish": ("clock",),
    "cert_get_state": (),
    "cert_get_motor": ("oid",),
}
"""Commands of the extension. Source: docs/boards.md."""

CERTIFIED_ANSWERS = {
    "cert_state": ("state", "section", "promise", "stopped"),
    "cert_motor": ("oid", "steps", "pos", "crc"),
}

IN_SECTION = 2
"""State of the extension."""

FIRST_READINGS, FIRST_PAUSE = 8, 0.02
"""Readings of the clock when a board is opened, seconds apart."""

POLL, POLL_MOVING = 0.5, 0.1
"""Seconds between readings of the clock, at rest and in motion: they are what shows that the board goes on."""

STOP_TIME, HALT_PAUSE = 1.0, 0.05
"""Seconds of listening that a board has to say that it has stopped; between two looks at the line meanwhile."""


class Session:
    """A board from opening its line to losing it or letting go of it.

    clock: from ``reach`` on. shutdown: the message that said so, with its text, when one is in force. was_reset: the
    board said that it started. certified: its firmware has the extension.
    """

    def __init__(self, line: Line, wiring: Wiring, steadiness: Steadiness = CRYSTAL) -> None:
        self.wiring = wiring
        self.link = Connection(line, self._heard)
        self.clock = BoardClock(1, steadiness)
        self._steadiness = steadiness
        self.shutdown: tuple[Answer, str] | None = None
        self.was_reset = False
        self.certified = False
        self.step_rate = self.step_ticks = self.run_ticks = 0
        self._polled = 0.0

    def now(self) -> float:
        """Host seconds."""
        return self.link.line.now()

    def _stated(self, constant: str) -> int:
        """A number above 0 that the firmware states; 0 where it states none."""
        stated = self.link.dictionary.constants.get(constant)
        return stated if isinstance(stated, int) and stated > 0 else 0

    def reach(self) -> None:
        """Get in step, read the dictionary, leave a shutdown, read the clock; BoardError."""
        link = self.link
        link.synchronise()
        dictionary = link.identify()
        extension = dictionary.constants.get(EXTENSION)
        if extension not in (None, VERSION):
            raise DictionaryError(f"the firmware has version {extension} of the extension, and {VERSION} is known here")
        self.certified = extension == VERSION
        self.step_rate, self.step_ticks, self.run_ticks = map(self._stated, (STEP_RATE, STEP_TICKS, RUN_TICKS))
        needed = NEEDED | (OUTPUTS if self.wiring.outputs else {}) | (CERTIFIED if self.certified else {})
        for name, fields in needed.items():
            dictionary.command(name, fields)
        for name, fields in (ANSWERS | (CERTIFIED_ANSWERS if self.certified else {})).items():
            dictionary.response(name, fields)
        self.leave_shutdown()
        self._leave_section()
        self.was_reset = False
        self.clock = BoardClock(dictionary.number("CLOCK_FREQ"), self._steadiness)
        for _ in range(FIRST_READINGS):
            self.read_clock()
            until = self.now() + FIRST_PAUSE
            while self.now() < until:
                link.pump(until)

    def configure(self, pulse: int) -> int:
        """Configure the board, unless it is; the places that it has for runs. BoardError."""
        commands = self.wiring.commands(self.link, pulse)
        try:
            configure(self.link, commands)
        except Shutdown:
            why = self.shutdown[1] if self.shutdown is not None else "it shut down"
            wanted = f"{len(self.wiring.motors)} motors and {len(self.wiring.outputs)} outputs"
            raise BoardError(
                f"the board cannot be configured for {wanted}: {why}; it has to be reset (switched off and on)"
            ) from None
        return _number(self.link.query("get_config", "config"), "move_count")

    def leave_shutdown(self) -> None:
        """Clear a shutdown when one is in force: cleared when none is, it would be one."""
        for attempt in range(4):
            try:
                if not self.link.query("get_config", "config").fields["is_shutdown"]:
                    self.shutdown = None
                    return
            except Shutdown:
                pass
            if not attempt:
                self.link.send("clear_shutdown")
                self.link.settle()
        raise BoardError("the board does not leave its shutdown")

    def _leave_section(self) -> None:
        """Stop a board that a host which is gone left in a section: it starts no other before that is over."""
        if not self.certified:
            return
        if _number(self.link.query("cert_get_state", "cert_state"), "state") == IN_SECTION:
            self.halt()
            self.leave_shutdown()

    def read_clock(self) -> None:
        """Read all bits of the clock; ClockError when it is not the one that it was."""
        answer = self.link.query("get_uptime", "uptime")
        self.clock.read(answer.asked, answer.answered, _uptime(answer))
        self._polled = answer.answered

    def poll(self, *, moving: bool) -> None:
        """Ask for the clock when it is time to; the answer is heard whenever it comes."""
        now = self.now()
        if now >= self._polled + (POLL_MOVING if moving else POLL):
            self.link.send("get_uptime" if self.clock.stale(now) else "get_clock")
            self._polled = now

    def tick_in(self, seconds: float) -> int:
        """A tick that many seconds ahead at least."""
        return self.clock.upper(self.now()) + int(seconds * self.clock.frequency)

    def positions(self) -> list[int]:
        """What the board counts, steps that count up in the stream counted up; BoardError."""
        found = []
        for oid, pins in enumerate(self.wiring.motors):
            count = _number(self.link.query("stepper_get_position", "stepper_position", key="oid", oid=oid), "pos")
            found.append(-count if pins.inverted_direction else count)
        return found

    def executed(self, section: int) -> tuple[Executed, ...]:
        """What each motor made of the last section, by firmware that counts it; nothing where that is another one.

        BoardError.
        """
        if not self.certified or _number(self.link.query("cert_get_state", "cert_state"), "section") != section:
            return ()
        found = []
        for oid in range(len(self.wiring.motors)):
            answer = self.link.query("cert_get_motor", "cert_motor", key="oid", oid=oid)
            found.append(Executed(_number(answer, "steps"), _number(answer, "crc")))
        return tuple(found)

    def halt(self) -> None:
        """Stop the board, before anything that is still to be sent; BoardError when it does not say that it has."""
        self.link.transport.forget()
        self.link.send("emergency_stop")
        until = self.link.listened + STOP_TIME
        while self.shutdown is None:
            if self.link.listened >= until:
                raise LineLost("the board does not say that it has stopped")
            self.link.pump(self.now() + HALT_PAUSE)

    def _heard(self, answer: Answer) -> None:
        """A message that nobody waits for."""
        match answer.name:
            case "shutdown" | "is_shutdown":
                if self.shutdown is None or answer.name == "shutdown":
                    number = answer.fields.get("static_string_id", 0)
                    self.shutdown = (answer, self.link.dictionary.text(number) if isinstance(number, int) else "")
            case "starting":
                self.was_reset = True
            case "clock" if self.clock.known:
                self.clock.read_word(answer.asked, answer.answered, _number(answer, "clock"))
            case "uptime" if self.clock.known:
                self.clock.read(answer.asked, answer.answered, _uptime(answer))


def _number(answer: Answer, name: str) -> int:
    """A field that is a number; BoardError where the dictionary says that it is none."""
    value = answer.fields.get(name)
    if not isinstance(value, int):
        raise DictionaryError(f"{name} of {answer.name} is no number")
    return value


def _uptime(answer: Answer) -> int:
    return _number(answer, "high") << 32 | _number(answer, "clock")
