"""Questions about rows and forms of a Trace that passes, checks and reports ask alike."""

from __future__ import annotations

from gproof.ir.columns import Columns
from gproof.ir.finding import Span
from gproof.ir.setup import Interval, Setup
from gproof.ir.trace import UNKNOWN, Affine, Trace


def row_span(trace: Trace, rows: Columns, row: int) -> Span:
    """The source line of a row; of what no line says, the first."""
    return Span(trace.files[int(rows["file"][row])], max(1, int(rows["line"][row])))


def form_interval(form: Affine, setup: Setup, trace: Trace) -> Interval | None:
    """The range of a sum of unknowns by what setup and trace tell; None when some part is not bounded."""
    low = high = 0.0
    for symbol, coefficient in form:
        if form == UNKNOWN:
            return None
        known = trace.symbols.get(symbol) or setup.interval(symbol)
        if known is None:
            return None
        ends = (known.low * coefficient, known.high * coefficient)
        low, high = low + min(ends), high + max(ends)
    return Interval(low, high)


_STATED = ("start", "work", "g92", "tool", "head")


def split_form(form: Affine) -> tuple[Affine, Affine]:
    """(unknowns that arise in the run, those that a setup can state): only the second can be a condition of a verdict.

    Nobody can promise before the job runs where a probe will touch.
    """
    arising = tuple(term for term in form if term[0].split(".")[0] not in _STATED)
    return arising, tuple(term for term in form if term not in arising)
