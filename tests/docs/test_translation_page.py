"""The page about translation: its table is what the code gives, and it has every key of a map."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from docs.translation_table import BEGIN, END, NEEDS, PAGE, cell, page

from gproof.driver.targets import TARGETS
from gproof.frontend.common.own_keys import KEYS
from gproof.ir.target import FEATURES
from gproof.passes.legalize.registry import PATTERNS


def test_the_table_is_what_the_code_gives(golden: Callable[[Path, str], None]) -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert text.count(BEGIN) == text.count(END) == 1
    golden(PAGE, page())


def test_conditions_are_those_of_patterns() -> None:
    assert set(NEEDS) <= {pattern.name for pattern in PATTERNS}


def test_every_feature_of_a_target_and_of_a_pattern_is_one() -> None:
    for entry in TARGETS.values():
        entry.target().verify()
    assert {feature for pattern in PATTERNS for feature in pattern.removes} <= set(FEATURES)


def test_cells_say_what_a_target_has() -> None:
    """Of the manuals: Eding has G81, G54 and no centimetres; grbl has no cycles and no program can change its tools."""
    eding, grbl = (TARGETS[name].target() for name in ("eding", "grbl"))
    assert cell("cycle_drill", eding).startswith("kept") and cell("frame_select", eding).startswith("kept")
    assert cell("unit_cm", eding).startswith("→") and cell("cycle_drill", grbl).startswith("→")
    assert cell("question", grbl) == "refused: no code asks the operator (Supported G-Codes)"


def test_the_page_has_every_key_of_a_map() -> None:
    keys = KEYS["gproof-translation/1"]
    named = set(re.findall(r"`\[?([a-z_]+)\]?`", PAGE.read_text(encoding="utf-8")))
    tables = {inner for table in keys.tables.values() for inner in table.own}
    assert {*keys.own, *keys.tables, *tables} - {"schema"} <= named
