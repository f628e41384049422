"""Finding codes 7xx: printing and translation."""

from __future__ import annotations

from gproof.ir.codes.declared import code
from gproof.ir.finding import Severity

_E, _U = Severity.ERROR, Severity.UNKNOWN

FORMAT_DIFFERS = code(
    701, "format-differs", _E, "formatting would change the program: {what}; nothing was written", "printing"
)
NOT_PRINTABLE = code(702, "not-printable", _E, "the controller's language has no text for {what}", "printing")
NOT_TRANSLATED = code(703, "not-translated", _U, "{construct} cannot be translated to {target}: {why}", "translation")
TRANSLATION_DIFFERS = code(704, "translation-differs", _E, "the translation is not the same: {what}", "translation")
TRANSLATION_OPEN = code(705, "translation-open", _U, "the translation is not proven: {what}", "translation")
