"""Just enough of JSON Schema (draft 2020-12) for the schemas in docs/; an unknown keyword is an error."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

_TYPES: dict[str, Any] = {
    "object": dict, "array": list, "string": str, "boolean": bool, "null": type(None),
}  # fmt: skip
_SILENT = {"$schema", "$id", "$defs", "title", "description"}


def violations(value: Any, schema: dict[str, Any], root: dict[str, Any] | None = None, at: str = "$") -> Iterator[str]:
    """What is wrong with a value, with its path."""
    root = schema if root is None else root
    for keyword, wanted in schema.items():
        if keyword in _SILENT:
            continue
        yield from _RULES[keyword](value, wanted, root, at, schema)


def _is(value: Any, name: str) -> bool:
    if name in ("integer", "number"):
        return not isinstance(value, bool) and isinstance(value, int if name == "integer" else (int, float))
    return isinstance(value, _TYPES[name])


def _ref(value: Any, wanted: str, root: dict[str, Any], at: str, _: Any) -> Iterator[str]:
    target: Any = root
    for part in wanted.removeprefix("#/").split("/"):
        target = target[part]
    yield from violations(value, target, root, at)


def _type(value: Any, wanted: Any, _root: Any, at: str, _: Any) -> Iterator[str]:
    names = [wanted] if isinstance(wanted, str) else wanted
    if not any(_is(value, name) for name in names):
        yield f"{at}: {value!r} is not of type {wanted}"


def _required(value: Any, wanted: list[str], _root: Any, at: str, _: Any) -> Iterator[str]:
    yield from (f"{at}: {name} is missing" for name in wanted if isinstance(value, dict) and name not in value)


def _properties(value: Any, wanted: dict[str, Any], root: dict[str, Any], at: str, schema: Any) -> Iterator[str]:
    for name, inner in value.items() if isinstance(value, dict) else ():
        if name in wanted:
            yield from violations(inner, wanted[name], root, f"{at}.{name}")


def _additional(value: Any, wanted: dict[str, Any], root: dict[str, Any], at: str, schema: Any) -> Iterator[str]:
    for name, inner in value.items() if isinstance(value, dict) else ():
        if name not in schema.get("properties", {}):
            yield from violations(inner, wanted, root, f"{at}.{name}")


def _items(value: Any, wanted: dict[str, Any], root: dict[str, Any], at: str, _: Any) -> Iterator[str]:
    for n, inner in enumerate(value if isinstance(value, list) else ()):
        yield from violations(inner, wanted, root, f"{at}[{n}]")


def _one_of(value: Any, wanted: Any, _root: Any, at: str, _: Any) -> Iterator[str]:
    if value not in (wanted if isinstance(wanted, list) else [wanted]):
        yield f"{at}: {value!r} is not one of {wanted}"


def _pattern(value: Any, wanted: str, _root: Any, at: str, _: Any) -> Iterator[str]:
    if isinstance(value, str) and not re.search(wanted, value):
        yield f"{at}: {value!r} does not match {wanted}"


def _minimum(value: Any, wanted: float, _root: Any, at: str, _: Any) -> Iterator[str]:
    if isinstance(value, int | float) and value < wanted:
        yield f"{at}: {value} is below {wanted}"


def _any_of(value: Any, wanted: list[dict[str, Any]], root: dict[str, Any], at: str, _: Any) -> Iterator[str]:
    found = [list(violations(value, one, root, at)) for one in wanted]
    if sum(not one for one in found) != 1:
        yield f"{at}: is not exactly one of {len(wanted)} forms: {min(found, key=len)[:3]}"


_RULES: dict[str, Any] = {
    "oneOf": _any_of,
    "$ref": _ref, "type": _type, "required": _required, "properties": _properties, "additionalProperties": _additional,
    "items": _items, "enum": _one_of, "const": _one_of, "pattern": _pattern, "minimum": _minimum,
}  # fmt: skip
