"""What a line without a command goes on with: the last command before it in the source (McuWIN manual 3.1).

What ends that, the manual says of G04 (3.5), of DINEND and DINSTART (14, 2.5.3.106) and, by saying that they do not any
more, of M codes (14, 2.5.3.94). Of other G codes and of ``$`` lines it says nothing: there the state is OPEN.
"""

from __future__ import annotations

from gproof.ir.dialects.mcuwin.settings import VERSIONS, McuWinSettings
from gproof.ir.program import Number, Word
from gproof.ir.record import record

NONE = ""
OPEN = "?"
MOTIONS = ("G0", "G1", "G2", "G3")


@record(slots=True)
class Persistence:
    """Walks along the source.

    state: the code in force, NONE, or OPEN where the manual leaves it open; distances: see ``Block.distances``.
    """

    din: McuWinSettings
    state: str = NONE
    distances: str = ""

    @property
    def in_force(self) -> tuple[str, str]:
        """Code and distances."""
        return self.state, self.distances

    def distances_of(self, words: tuple[Word, ...]) -> str:
        """The distance mode of lines by the order of the source, which decided before 2.5.3.78; "" since (14)."""
        if self._old:
            codes = [w.value.value for w in words if w.letter == "G" and isinstance(w.value, Number)]
            modes = [f"G{code:g}" for code in codes if code in (90.0, 91.0)]
            self.distances = modes[-1] if modes else self.distances or "G90"
        return self.distances

    @property
    def _old(self) -> bool:
        return self.din.version == VERSIONS[1]

    def code(self, letter: str, number: int) -> None:
        """Pass a code. The older version kept nothing over M codes, and says less of G04 and G92."""
        name = f"{letter}{number}"
        if letter == "M":
            self.state = NONE if self._old else self.state
        elif name in MOTIONS or (name == "G92" and not self._old):
            self.state = name
        elif name == "G4" and not self._old:
            self.state = NONE
        else:
            self.doubt()

    def mode(self) -> None:
        """Pass DINEND or DINSTART."""
        if self._old:
            self.doubt()
        else:
            self.state = NONE

    def doubt(self) -> None:
        """Pass something of which the manual does not say whether it ends what is in force."""
        if not self.din.keeps_over_codes and self.state != NONE:
            self.state = OPEN

    def cut(self) -> None:
        """Pass the border of a module, or a line that was not understood: never taken as kept."""
        if self.state != NONE:
            self.state = OPEN
