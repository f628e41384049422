"""``[resident]`` of setup files: what variables keep from one job to the next (McuWIN manual 4.19 to 4.22)."""

from __future__ import annotations

import math
import re
from typing import Any

from gproof.frontend.common.toml_table import TomlTable
from gproof.ir.dialects.mcuwin.rules import COMMON, PROTECTED
from gproof.ir.setup import Interval

_RESIDENT = re.compile(r"C([ID])([1-9][0-9]{2})", re.ASCII)


def setup_fields(root: TomlTable) -> dict[str, Any]:
    """The fields of a Setup that the table states."""
    return {"resident": _resident(root.table("resident"))}


def _resident(table: TomlTable | None) -> dict[int, Interval]:
    """``[resident]``: what M901 and M903 of an earlier job have kept, by the names of McuWIN: ``CI601``, ``CD601``."""
    found: dict[int, Interval] = {}
    for name in table.values if table else ():
        assert table is not None
        written = _RESIDENT.fullmatch(name.upper())
        ends = table.interval(name)
        if written is None or not PROTECTED <= int(written[2]) < COMMON:
            table.bad(name, f"{name!r} is not CI or CD and a number from {PROTECTED} to {COMMON - 1}")
            continue
        if ends is None:
            continue
        whole = written[1] == "I"
        if whole and not all(end == math.floor(end) and abs(end) < 2.0**31 for end in ends):
            table.bad(name, f"{name} is a whole number of 32 bits")
            continue
        found[int(written[2]) + COMMON * whole] = Interval(*ends)
    return found
