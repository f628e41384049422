"""G92.3 of WinCNC: the first one puts the zeros of all axes away, the next one takes them out again.

A Job keeps a zero at one place and brings it back at another, as often as it likes; until the zero changes, it stays
in force. So G92.3 is printed at the first change, which has to give all axes another zero.
"""

from __future__ import annotations

from typing import NamedTuple

from gproof.backend.emit.printer import Unprintable
from gproof.backend.emit.wincnc.job_walk import number
from gproof.ir.job import SetFrame


class Printed(NamedTuple):
    """says: G92.3 is printed; over: nothing more of the operation is."""

    says: bool = False
    over: bool = False


class ZerosAway:
    """axes: of the machine. keeps: the zero is to be put away at its first change; away: it is."""

    def __init__(self, axes: set[str]) -> None:
        self.axes = axes
        self.keeps = self.away = False

    def frame(self, node: SetFrame, enough: bool) -> Printed:
        """An operation on zeros. enough: axes that it does not name do not move before the zero is brought back."""
        if node.action == "zero_keep":
            if self.away:
                raise Unprintable("a zero that is kept while another one is")
            self.keeps = True
            return Printed(over=True)
        if node.action == "zero_recall":
            if not self.keeps and not self.away:
                raise Unprintable("a zero that is brought back a second time")
            was_away = self.away
            self.keeps = self.away = False
            return Printed(says=was_away, over=True)
        if not self.keeps:
            return Printed()
        if node.action != "zero_at" or not (enough or {place.axis for place in node.places} >= self.axes):
            raise Unprintable("a zero that is kept while only some axes get another one")
        self.keeps, self.away = False, True
        zeros = {place.axis for place in node.places if number(place.at.value) == 0.0}
        return Printed(says=True, over=zeros >= self.axes)
