"""The schema number of a part rises when an older text would say something else: tests/ir/schemas has each number."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from ir.schema_shapes import ROOTS, shape

from gproof.verify.certificate.package import SCHEMAS

FOLDER = Path(__file__).parent / "schemas"


def test_each_part_has_a_number() -> None:
    assert SCHEMAS.keys() == ROOTS.keys()


@pytest.mark.parametrize("part", ROOTS)
def test_a_schema_says_what_it_said(part: str, golden: Callable[[Path, str], None]) -> None:
    """Fields, members and defaults stay as they are under one number; what is added has a default."""
    path, now = FOLDER / f"{part}-{SCHEMAS[part]}.txt", shape(part)
    before = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
    gone = [line for line in before if line not in now]
    assert gone == [], f"an older text of {part}.ir would say something else: raise SCHEMAS[{part!r}]"
    types = {line.partition(".")[0] for line in before}
    added = [line for line in now if line not in before and line.partition(".")[0] in types]
    needed = [line for line in added if line.endswith("= required")]
    assert needed == [], f"an older text of {part}.ir lacks them: give them a default, or raise SCHEMAS[{part!r}]"
    golden(path, "\n".join(now) + "\n")
