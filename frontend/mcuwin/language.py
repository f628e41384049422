"""What decides how DIN lines of McuWIN are read, and a line that was read."""

from __future__ import annotations

from gproof.frontend.mcuwin.expressions import Expressions
from gproof.frontend.mcuwin.notes import Found
from gproof.ir.dialects.mcuwin.settings import VERSIONS, McuWinSettings
from gproof.ir.finding import Span
from gproof.ir.program import Statement
from gproof.ir.record import field, record
from gproof.ir.rules import LanguageRules


@record(slots=True)
class DinLine:
    """A line that was read.

    number: its digits, "" without; statements: in order; module: what comes after a percent sign, None without one;
    module_span: of that; pascal: where a ``$`` is, -1 without; starts: where ``{$DINSTART}`` is, and after;
    says: there is more than blanks and comments; notes: see ``notes.py``.
    """

    number: str = ""
    statements: list[Statement] = field(default_factory=list)
    module: str | None = None
    module_span: Span | None = None
    pascal: int = -1
    starts: tuple[int, int] | None = None
    says: bool = False
    notes: list[Found] = field(default_factory=list)

    @property
    def asks_number(self) -> bool:
        """Whether a machine with line numbers asks this line for one: not percent signs and ``$`` lines."""
        return bool(self.statements)


@record(frozen=True, slots=True, kw_only=True)
class Language:
    """What decides how lines are read. axes: letters of the machine's axes, upper case."""

    rules: LanguageRules
    din: McuWinSettings
    axes: str
    expressions: Expressions

    @property
    def old(self) -> bool:
        """The older version, whose M codes take no brackets and whose modules are no labels."""
        return self.din.version == VERSIONS[1]
