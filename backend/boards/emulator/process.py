"""The emulator's process: its port, its control channel, real time; it ends with its host, its parent or a signal."""

from __future__ import annotations

import os
import select
import signal
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass

from gproof.backend.boards.emulator.control import Broken, Control
from gproof.backend.boards.emulator.emulator import Emulator
from gproof.backend.boards.emulator.ports import LARGEST_READ, Port, Tcp

GLANCE = 0.02
"""Seconds between two looks at a port that cannot be waited for."""

LONGEST_WAIT = 0.5
"""Seconds: so often it looks whether its parent is still there."""


@dataclass(frozen=True, slots=True)
class Life:
    """linger: seconds that it goes on after its host has gone; None: for ever, also without its parent."""

    linger: float | None


class Process:
    """One emulator and who talks to it. port: None in simulated time, where the control channel is the line."""

    def __init__(self, emulator: Emulator, port: Port | None, control: Tcp | None, life: Life) -> None:
        self._emulator = emulator
        self._port = port
        self._channel = control
        self._control = Control(emulator, simulated=port is None)
        self._life = life
        self._parent = os.getppid()
        self._gone_since: float | None = None
        self._wake, self._signalled = socket.socketpair()
        self._asked_to_end = False
        self._start = 0
        self._open = False
        self._had_host = False

    def run(self, say: Callable[[str], None]) -> None:
        """Until it ends; say: takes the addresses, a line each. OSError where a port cannot be opened."""
        self._take_signals()
        try:
            if self._channel is not None:
                say(f"control: {self._channel.open().removeprefix('socket://')}")
            if self._port is not None:
                say(f"port: {self._port.open()}")
                self._open = True
            self._start = time.monotonic_ns()
            while not self._ended():
                self._turn(say)
        finally:
            for part in (self._port, self._channel):
                if part is not None:
                    part.close()
            self._emulator.finish()

    def _take_signals(self) -> None:
        for part in (self._wake, self._signalled):
            part.setblocking(False)
        signal.set_wakeup_fd(self._signalled.fileno(), warn_on_full_buffer=False)
        for number in (signal.SIGTERM, signal.SIGINT, getattr(signal, "SIGHUP", signal.SIGTERM)):
            signal.signal(number, self._end)

    def _end(self, *_: object) -> None:
        self._asked_to_end = True

    def _ended(self) -> bool:
        if self._asked_to_end or self._control.ends:
            return True
        if self._life.linger is None:
            return False
        if os.getppid() != self._parent:
            return True
        return self._gone_since is not None and time.monotonic() - self._gone_since >= self._life.linger

    def _turn(self, say: Callable[[str], None]) -> None:
        """Wait for something, and let it happen."""
        waiting = [self._wake.fileno()]
        parts = [part for part in (self._port, self._channel) if part is not None]
        numbers = [part.waits_for() for part in parts]
        waiting += [number for number in numbers if number is not None]
        timeout = self._timeout()
        if None in numbers:
            timeout = min(timeout, GLANCE)
        select.select(waiting, [], [], timeout)
        if self._port is not None:
            self._emulator.advance(time.monotonic_ns() - self._start)
            self._serve(self._port, say)
        if self._channel is not None:
            self._serve_control(self._channel)

    def _timeout(self) -> float:
        if self._port is None:
            return LONGEST_WAIT
        due = [at for at in (self._emulator.next_event(), self._emulator.next_received()) if at is not None]
        if not due:
            return LONGEST_WAIT
        return min(LONGEST_WAIT, max(0.0, (min(due) - (time.monotonic_ns() - self._start)) / 1e9))

    def _serve(self, port: Port, say: Callable[[str], None]) -> None:
        emulator = self._emulator
        if self._open and not emulator.connected:
            port.close()
            self._open = False
        elif emulator.connected and not self._open:
            say(f"port: {port.open()}")
            self._open = True
        if not self._open:
            return
        if received := emulator.taken():
            port.write(received)
        data = port.read(emulator.room)
        self._host_seen(data is not None)
        if data:
            emulator.write(data)

    def _serve_control(self, channel: Tcp) -> None:
        data = channel.read(LARGEST_READ)
        if self._port is None:
            self._host_seen(data is not None)
        if data:
            try:
                answers = self._control.feed(data)
            except Broken:
                channel.drop()
                return
            if answers:
                channel.write_all(answers)

    def _host_seen(self, here: bool) -> None:
        """Whether the host has the port now; one that was never there has not gone."""
        if here:
            self._gone_since = None
            self._had_host = True
        elif self._gone_since is None and self._had_host:
            self._gone_since = time.monotonic()
