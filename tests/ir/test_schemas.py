"""The schema number of a part rises when an older text would say something else; schemas.md has each number."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from ir.schema_shapes import ROOTS, shape
from support.goldens import expected

from gproof.verify.certificate.package import SCHEMAS

PAGE = Path(__file__).parent / "schemas.md"


def test_each_part_has_a_number() -> None:
    assert SCHEMAS.keys() == ROOTS.keys()


@pytest.mark.parametrize("part", ROOTS)
def test_a_schema_says_what_it_said(part: str, golden: Callable[[Path, str], None]) -> None:
    """Fields, members and defaults stay as they are under one number; what is added has a default."""
    path, now = PAGE / f"{part}-{SCHEMAS[part]}.txt", shape(part)
    before = (expected(path) or "").splitlines()
    gone = [line for line in before if line not in now]
    assert gone == [], f"an older text of {part}.ir would say something else: raise SCHEMAS[{part!r}]"
    types = {line.partition(".")[0] for line in before}
    added = [line for line in now if line not in before and line.partition(".")[0] in types]
    needed = [line for line in added if line.endswith("= required")]
    assert needed == [], f"an older text of {part}.ir lacks them: give them a default, or raise SCHEMAS[{part!r}]"
    golden(path, "\n".join(now) + "\n")
