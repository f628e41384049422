"""The tables of the Eding page are what the code gives, and the code has everything that the manual names."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from docs.eding_tables import PAGE, is_unknown, page, rule_of

from docs import eding_manual as manual
from gproof.frontend.eding.prepare import FUNCTIONS
from gproof.ir.dialects.eding.operators import LEVEL
from gproof.ir.dialects.eding.rules import EDING, FREE
from gproof.ir.rules import BINARY, UNARY, Function

CODES = manual.G_CODES | manual.M_CODES


def test_the_page_is_what_the_code_gives(tmp_path: Path, golden: Callable[[Path, str], None]) -> None:
    golden(PAGE, page(tmp_path))


def test_the_rules_have_the_codes_of_the_manual_and_no_others() -> None:
    assert {rule.text for rule in EDING.codes.values()} == set(CODES)


@pytest.mark.parametrize("code", [code for code in CODES if rule_of(code).function is Function.UNSUPPORTED])
def test_a_code_that_is_not_modelled_is_unknown(code: str, tmp_path: Path) -> None:
    assert is_unknown(CODES[code][1], tmp_path)


def test_operators_are_those_of_the_manual() -> None:
    assert set(UNARY) >= set(manual.UNARY) == FUNCTIONS
    assert set(BINARY) >= set(manual.BINARY) == set(LEVEL)


def test_every_parameter_of_the_manual_has_a_meaning() -> None:
    named = {n for first, last in manual.PARAMETERS for n in range(first, last + 1)}
    others = (FREE, *(entry.meaning for entry in EDING.parameters if entry.kind in ("tool_zero", "later")))
    known = {n for entry in EDING.parameters if entry.meaning not in others for n in range(entry.first, entry.last + 1)}
    assert known == named


def test_all_other_parameters_are_free() -> None:
    """3.1.1 says so below its list, of numbers that 3.2.2.2 ends at 5399."""
    named = {n for first, last in manual.PARAMETERS for n in range(first, last + 1)}
    free = {n for entry in EDING.parameters if entry.meaning == FREE for n in range(entry.first, entry.last + 1)}
    assert free == set(range(1, 5400)) - named
