"""Words of a machinist, and what shows of the inside: how ``test_codes`` tells them apart."""

from __future__ import annotations

import pytest
from corpus.expectations import strange

from gproof.ir import codes
from gproof.ir.finding import Span


@pytest.mark.parametrize(
    "text",
    [
        "holds for work.1.x in 20 to 100",
        "made for start.x 3; now it is None",
        "Interval(low=0.0, high=1.0)",
        "a limit of inf mm",
        "feed nan",
        "0.0000 past its limit",
        "0.0000 mm past",
        "X-0.0000 Y1".replace("X", "X "),
        "Function.TRAVERSE is not known",
        "reached {over} mm",
        "0.30000000000000004 mm",
    ],
)
def test_what_is_strange_is_found(text: str) -> None:
    assert strange(text)


@pytest.mark.parametrize(
    "text", ["T1.x = 3", "WINCNC.INI", "3.0000 past its lower travel limit of 0.000 mm", "tool 1.5 mm", "-0.5 mm"]
)
def test_what_a_machinist_says_is_not(text: str) -> None:
    assert not strange(text)


def test_no_number_of_a_message_is_a_zero_with_a_sign() -> None:
    where = Span("job", 1)
    finding = codes.SOFT_LIMIT.at(where, axis="X", reached=-0.0, unit="mm", over=4e-6, side="lower", limit=-0.0)
    assert not strange(finding.message) and "0.0000040 mm past" in finding.message, finding.message
