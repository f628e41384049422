"""The table of finding codes: a number or a name is one code's for ever."""

from __future__ import annotations

import pytest

from gproof.ir.codes import CODES, RETIRED, code
from gproof.ir.finding import Severity, Span


def test_no_code_takes_what_was_retired() -> None:
    assert not set(RETIRED) & set(CODES)
    assert not {name for name, _ in RETIRED.values()} & {known.name for known in CODES.values()}
    for number, name in ((305, "something-new"), (999, "offset-box"), (301, "other"), (999, "soft-limit")):
        with pytest.raises(ValueError, match=f"{number}"):
            code(number, name, Severity.NOTE, "")
    assert 999 not in CODES


def test_what_a_package_or_a_record_may_say_comes_with_what_to_do() -> None:
    without = [known.label for known in CODES.values() if known.number >= 800 and not known.hint]
    assert without == ["GP832"]  # a feed hold that was asked for: nothing has to be done
    place = Span("a.gpx", 0)
    assert CODES[827].at(place, what="x").hint == CODES[827].hint
    assert CODES[827].at(place, what="x", hint="another one").hint == "another one"
