"""Expressions and assignments in DIN lines, by the parser of rw_SymPas (McuWIN manual 3.5, 6, 11, 12)."""

from __future__ import annotations

from gproof.frontend.mcuwin.pascal import Place, Symbols, Type, begins_expression, parse_assignment, parse_expression
from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.program import Assign, Expr
from gproof.ir.record import record


@record(slots=True)
class Expressions:
    """Reads expressions with the names of a job. Mistakes of types are reported; what is no expression is a Refusal."""

    symbols: Symbols

    def number(self, text: str, at: int, file: str, line: int) -> tuple[Expr, int]:
        """The longest expression from ``at``, which must be a number, and where it ends."""
        value, type_, end = parse_expression(text, at, Place(file, line), self.symbols)
        if not type_.numeric:
            what = f"the value of a word must be a number; this is {type_.value}"
            raise Refusal(codes.TYPE_MISMATCH.at(Span(file, line, at + 1, end + 1), what=what))
        return value, end

    def any(self, text: str, at: int, file: str, line: int) -> tuple[Expr, int]:
        """The longest expression from ``at``, and where it ends."""
        value, _, end = parse_expression(text, at, Place(file, line), self.symbols)
        return value, end

    def assignment(self, text: str, at: int, file: str, line: int) -> tuple[Assign | None, int]:
        """An assignment, None for one to something that cannot be written (reported), and where it ends."""
        return parse_assignment(text, at, Place(file, line), self.symbols)

    def fits(self, text: str, at: int) -> bool:
        """Whether a number without mistakes starts at ``at``."""
        trial = self.symbols.trial()
        try:
            _, type_, _ = parse_expression(text, at, Place("", 0), trial)
        except Refusal:
            return False
        return not trial.findings.counts and type_ is not Type.STRING

    def begins(self, text: str, at: int) -> bool:
        """Whether an expression may start at ``at``."""
        return begins_expression(text, at, self.symbols)
