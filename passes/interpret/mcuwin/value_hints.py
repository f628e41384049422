"""What to state for a value of a program that is not known."""

from __future__ import annotations

import re

_COMMON = re.compile(r"C([DI])(\d{1,3})")


def of_value(cause: str) -> str:
    """What to state for a value of a program that is not known, by its cause (``values.Unknown``); "" for others."""
    common = _COMMON.fullmatch(cause)
    if common is not None:
        number = int(common[2]) + (1000 if common[1] == "I" else 0)
        return f"{number} = ... under [parameters] of the setup file states it, or an assignment before"
    if cause.endswith(".RP"):
        return f"the target, {cause[0]}.tp, is known where no zero offset and no reflection is in force"
    if cause.startswith("what an earlier job kept"):
        return "[resident] of the setup file states what was kept; or a value that this job assigns"
    return "[inputs] of the setup file states it" if ".digib." in cause else ""
