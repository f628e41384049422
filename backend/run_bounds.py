"""What a run has executed, as far as its journal, its mark and the board itself say: at least, and at most.

Takes the trail of a journal, the mark beside it, the section of the stream where the package is at hand, and what the
board answers where it was asked. Nothing is guessed: a bound that nobody vouches for is none.
"""

from __future__ import annotations

import enum
from collections.abc import Sequence

from gproof.backend.boards.board import Executed, Known
from gproof.backend.mark import Given
from gproof.backend.record_data import ExecutionRecord, SectionRecord
from gproof.backend.record_proof import derived
from gproof.backend.trail import Trail
from gproof.ir.record import record
from gproof.ir.stream import StreamSection


class Source(enum.Enum):
    """Whose word the bounds are: of the journal alone, of the mark beside it, of the board that was asked now."""

    JOURNAL = "journal"
    MARK = "mark"
    BOARD = "board"


@record(frozen=True, slots=True, kw_only=True)
class Bounds:
    """Steps of the last section that was started, by motor.

    least: certainly made; most: made at most, None where no number is known; source: whose word ``most`` is; proved:
    the board's CRCs are those of the stream; contradiction: why sources do not fit together, "" where they do.
    """

    least: tuple[int, ...]
    most: tuple[int, ...] | None
    source: Source
    proved: bool = False
    contradiction: str = ""

    @property
    def exact(self) -> bool:
        """True where the steps are known to the step."""
        return self.least == self.most and not self.contradiction


def bounds_of(trail: Trail, mark: Given | None, whole: Sequence[int] | None) -> Bounds:
    """Of the section that is open in a journal. whole: its steps in the stream, by motor, where that is at hand."""
    section = trail.open_section
    assert section is not None
    least, most, source = section.steps, tuple(whole) if whole is not None else None, Source.JOURNAL
    if section.most:
        most = section.most
    if mark is not None and mark.place > trail.started:
        what = f"the mark speaks of section {mark.place} of the run, the journal of {trail.started}: it lost lines"
        return Bounds(least=least, most=None, source=Source.MARK, contradiction=what)
    if mark is not None and len(mark.given) == len(mark.steps) == len(least):
        here = mark.place == trail.started
        given = mark.given if here else (0,) * len(least)
        least = tuple(map(max, least, mark.steps)) if here else least
        most = given if most is None else tuple(map(min, most, given))
        source = Source.MARK
    if trail.damaged:
        # What follows the damage may have been further motion.
        most = tuple(whole) if whole is not None else None
        source = Source.JOURNAL
    what = ""
    if most is not None and any(a > b for a, b in zip(least, most, strict=True)):
        what = f"{list(least)} steps were acknowledged, and {list(most)} sent"
    return Bounds(least=least, most=most, source=source, contradiction=what)


@record(frozen=True, slots=True, kw_only=True)
class Told:
    """What a board with the certification extension says when it is asked after a run.

    moving: it is in a section; section: number of the last one (None: none since it was reset); identity: of the stream
    presented last; executed: by motor.
    """

    moving: bool
    section: int | None
    identity: bytes
    executed: tuple[Executed, ...]


def of_this_run(told: Told, identity: bytes, section: int, motors: int) -> str:
    """Why what a board says is not of a section of this run; "" when it can be."""
    if told.section is None or not told.identity:
        return "the board knows no stream: it was reset since, or this one had not been presented to it"
    if told.identity != identity:
        return "the board has executed another stream since"
    if told.section != section:
        return f"the board speaks of section {told.section}, not of {section}"
    if len(told.executed) != motors:
        return f"the board counts {len(told.executed)} motors, not {motors}"
    return ""


def merged(
    before: Bounds, told: Told, done: SectionRecord, section: StreamSection | None, record: ExecutionRecord, *,
    begun: bool,
) -> Bounds:  # fmt: skip
    """Bounds with what the board says of this section; section: as it was sent, where that is known.

    begun: the board has acknowledged something of it in this run, so that it does not mean an earlier run of the same.
    """
    counts = tuple(one.steps for one in told.executed)
    low = any(count < least for count, least in zip(counts, before.least, strict=True))
    high = before.most is not None and any(count > most for count, most in zip(counts, before.most, strict=True))
    if low or high:
        most = "" if before.most is None else f" to {list(before.most)}"
        what = f"the board counts {list(counts)} steps, and they are {list(before.least)}{most} by the journal"
        return Bounds(least=before.least, most=before.most, source=before.source, contradiction=what)
    if not begun:
        return Bounds(least=before.least, most=counts, source=Source.BOARD)
    proved = section is not None
    if section is not None:
        from dataclasses import replace

        asked = replace(done, executed=told.executed, known=Known.EXACT)
        for motor, made in enumerate(told.executed):
            sums = derived(asked, section, record, motor)
            proved &= sums is not None and sums.steps == made.steps and made.crc in sums.crcs
    if section is not None and record.board.counting is not None and not proved and not told.moving:
        # Other runs than the journal knows of: how far they lead in those is not known.
        return before
    if told.moving and counts != before.most:
        return Bounds(least=counts, most=before.most, source=before.source)
    return Bounds(least=counts, most=counts, source=Source.BOARD, proved=proved)
