"""Another value for one stated fact of a machine or a setup.

A path leads from a record to a field of it or of a record inside: ``("axes", 0, "lower")``.
"""

from __future__ import annotations

import dataclasses
from typing import Any

Path = tuple[Any, ...]


def is_record(value: object) -> bool:
    """An instance of a record of ``ir/``."""
    return dataclasses.is_dataclass(value) and not isinstance(value, type)


def put(value: Any, path: Path, new: Any) -> Any:
    """The same with another value at the end of a path."""
    if not path:
        return new
    step, rest = path[0], path[1:]
    if is_record(value):
        return dataclasses.replace(value, **{step: put(getattr(value, step), rest, new)})
    if isinstance(value, dict):
        return {**value, step: put(value[step], rest, new)}
    return (*value[:step], put(value[step], rest, new), *value[step + 1 :])
