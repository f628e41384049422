"""What to state for a value of a program that is not known."""

from __future__ import annotations

import re

_COMMON = re.compile(r"C([DI])(\d{1,3})")


def of_value(cause: str) -> str:
    """What to state for a value of a program that is not known, by its cause (``values.Unknown``); "" for others."""
    common = _COMMON.fullmatch(cause)
    if common is not None:
        number = int(common[2]) + (1000 if common[1] == "I" else 0)
        return f"state {number} = ... under [parameters] of the setup file, or assign a value before"
    if cause.endswith(".RP"):
        return f"read the target, {cause[0]}.tp: it is known where no zero offset and no mirroring is active"
    if cause.startswith("what an earlier job kept"):
        return "state what was kept in [resident] of the setup file, or assign a value in this job"
    return "state it in [inputs] of the setup file" if ".digib." in cause else ""
