"""A job with its work offsets left open: what ``gproof fit`` runs, and what was stated of them.

The open offsets are those that an operator sets to move the zero: the coordinate systems (G54 and on); on controllers
where no setup has those, or others count as well, the offset that G92 shows (WinCNC local coordinates, McuWIN zero
offset). Tool lengths, heads and everything else stay as stated.
"""

from __future__ import annotations

import dataclasses
from copy import deepcopy

from gproof.driver.dialects import DIALECTS
from gproof.driver.session import Session
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.record import record
from gproof.ir.setup import Interval, Setup
from gproof.ir.trace import Affine


@record(frozen=True, slots=True, kw_only=True)
class OpenSetup(Setup):
    """A setup of which some kinds of offsets count as not stated, whatever it says of them.

    kinds: such as ``work``.
    """

    kinds: tuple[str, ...] = ()

    def interval(self, symbol: str) -> Interval | None:
        """As the setup has it; None for an open offset."""
        return None if symbol.split(".", maxsplit=1)[0] in self.kinds else Setup.interval(self, symbol)


@record(frozen=True, slots=True)
class Asked:
    """The open offsets, and what is given for them: the setup, and the zero offset table of a McuWIN machine."""

    kinds: tuple[str, ...]
    setup: Setup
    machine: Machine

    def is_open(self, symbol: str) -> bool:
        """Whether the symbol is one of the open offsets."""
        return symbol.split(".", maxsplit=1)[0] in self.kinds

    def stated(self, symbol: str) -> Interval | None:
        """What was stated of any symbol."""
        table = self.machine.settings.zero_offsets
        kind, *rest = symbol.split(".")
        if kind == "work" and table is not None:
            number, axis = int(rest[0]), AXIS_NAMES.index(rest[1])
            row = table[number - 1] if 0 < number <= len(table) else ()
            return Interval(row[axis], row[axis]) if axis < len(row) else None
        return self.setup.interval(symbol)

    def interval(self, form: Affine) -> Interval | None:
        """What was stated of a sum; None where some part of it is not."""
        low = high = 0.0
        for symbol, count in form:
            known = self.stated(symbol)
            if known is None:
                return None
            ends = known.low * count, known.high * count
            low, high = low + min(ends), high + max(ends)
        return Interval(low, high)

    @property
    def anything(self) -> bool:
        """Whether a value is given for any open offset."""
        setup = self.setup
        return bool(
            setup.default_offset is not None
            or ("work" in self.kinds and (setup.work or self.machine.settings.zero_offsets))
            or ("g92" in self.kinds and setup.g92)
        )


def opened(session: Session) -> tuple[Session, Asked]:
    """The same job with its work offsets open and findings of its own, and what was stated of them."""
    kinds = DIALECTS[session.dialect].frontend.open_offsets
    stated = {f.name: getattr(session.setup, f.name) for f in dataclasses.fields(Setup)}
    machine = session.machine
    if machine.settings.zero_offsets is not None:
        machine = dataclasses.replace(machine, settings=dataclasses.replace(machine.settings, zero_offsets=None))
    other = dataclasses.replace(
        session,
        setup=OpenSetup(kinds=kinds, **stated),
        machine=machine,
        findings=deepcopy(session.findings),
    )
    return other, Asked(kinds, session.setup, session.machine)
