"""EdingSettings: what an Eding CNC controller is set up to do, where it changes a job (manual 4.01)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gproof.ir.record import record
from gproof.ir.settings import Settings

if TYPE_CHECKING:
    from gproof.ir.machine import Machine


@record(frozen=True, slots=True, kw_only=True)
class EdingSettings(Settings):
    """See the module's text.

    macro_file: name of the file of subprograms that is loaded with each job, next to the machine file; None: the usual
    one.
    super_long_file: kB beyond which a job is executed without flow control; None: not stated.
    thread_peak: what I of a threading cycle is, "position" or "offset"; None: not stated.
    """

    macro_file: str | None = None
    super_long_file: float | None = None
    thread_peak: str | None = None


NO_EDING_SETTINGS = EdingSettings()


def eding_settings(machine: Machine) -> EdingSettings:
    """The settings of an Eding CNC machine; the usual ones where the machine's files state those of none."""
    own = machine.settings
    return own if isinstance(own, EdingSettings) else NO_EDING_SETTINGS
