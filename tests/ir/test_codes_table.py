"""The table of finding codes: a number or a name is one code's for ever."""

from __future__ import annotations

import pytest

from gproof.ir.codes import CODES, RETIRED, code
from gproof.ir.finding import Severity


def test_no_code_takes_what_was_retired() -> None:
    assert not set(RETIRED) & set(CODES)
    assert not {name for name, _ in RETIRED.values()} & {known.name for known in CODES.values()}
    for number, name in ((305, "something-new"), (999, "offset-box"), (301, "other"), (999, "soft-limit")):
        with pytest.raises(ValueError, match=f"{number}"):
            code(number, name, Severity.NOTE, "")
    assert 999 not in CODES
