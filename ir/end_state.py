"""What a program leaves for the job after it, and what an undecided condition asks: notes of a Trace."""

from __future__ import annotations

from gproof.ir.record import record

Form = tuple[tuple[str, int], ...]
"""A sum of unknowns, as in a frame of the Trace."""


@record(frozen=True, slots=True, kw_only=True)
class EndState:
    """Facts in force where a program ends that outlive it on its controller; None: they do not, or it has no such fact.

    offsets: (name, mm or degrees, form) of zero offsets that the program has changed: name is ``work.1.x`` or
    ``g92.x``; those that it left alone are not listed. tool: the tool in the spindle, -1: the one of the start;
    tool_offset: by
    axis, as ``offsets``, the tool length in force; work: the coordinate system in force, 0: that of the start.
    spindle: direction and speed, NaN unknown; coolant: mist and flood. modes: (name, text) of modes that the next job
    meets. guards_off: as of ``State``. line, file: of the end.
    """

    offsets: tuple[tuple[str, float, Form], ...] | None = None
    work: int | None = None
    tool: int | None = None
    tool_offset: tuple[tuple[str, float, Form], ...] | None = None
    spindle: tuple[int, float] | None = None
    coolant: tuple[bool, bool] | None = None
    guards_off: tuple[str, ...] | None = None
    modes: tuple[tuple[str, str], ...] | None = None
    line: int = 0
    file: int = 0


@record(frozen=True, slots=True, kw_only=True)
class Question:
    """What the two outcomes ``true`` and ``false`` of a section rest on: whether a channel is on.

    kind: ``input``, ``output``, ``virtual`` or ``answer`` (to a question of the job, by its number); channel: its
    number; on: the outcome ``true`` is that the channel is on.
    """

    kind: str
    channel: int
    on: bool = True
