"""What a program leaves for the job after it, and what an undecided condition asks: notes of a Trace."""

from __future__ import annotations

from gproof.ir.record import record

Form = tuple[tuple[str, int], ...]
"""A sum of unknowns, as in a frame of the Trace."""

Left = tuple[tuple[str, float, Form], ...]
"""Places by name: mm or degrees and unknowns."""


@record(frozen=True, slots=True, kw_only=True)
class EndState:
    """Facts in force where a program ends that outlive it on its controller; None: they do not, or it has no such fact.

    What is switched on is not here: the Trace has it as events.

    zero: by axis what the numbers of the next job count from, with the tool length in force; table: entries of the
    table of zero offsets that the program has changed, ``work.1.x``; length: by axis the tool length in force, where it
    is not that of the start; guards_off: as of ``State``; modes: (name, text) of modes that the next job meets, whose
    names start with that of the language: other languages do not have them.
    assumed: sentences that these facts rest on.
    """

    zero: Left | None = None
    table: Left | None = None
    length: Left | None = None
    guards_off: tuple[str, ...] | None = None
    modes: tuple[tuple[str, str], ...] = ()
    assumed: tuple[str, ...] = ()


@record(frozen=True, slots=True, kw_only=True)
class Question:
    """What the two outcomes ``true`` and ``false`` of a section rest on: whether a channel is on.

    kind: ``input``, ``output``, ``virtual`` or ``answer`` (to a question of the job, by its number); channel: its
    number; on: the outcome ``true`` is that the channel is on.
    """

    kind: str
    channel: int
    on: bool = True
