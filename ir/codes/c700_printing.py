"""Finding codes 7xx: printing and translation."""

from __future__ import annotations

from gproof.ir.codes.declared import code
from gproof.ir.finding import Severity

_E = Severity.ERROR

FORMAT_DIFFERS = code(
    701, "format-differs", _E, "formatting would change the program: {what}; nothing was written", "printing"
)
NOT_PRINTABLE = code(702, "not-printable", _E, "the controller's language has no text for {what}", "printing")
