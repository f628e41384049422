"""Reading execution records back: strict, so that what is read is what was written."""

from __future__ import annotations

import dataclasses
import json
from fractions import Fraction
from pathlib import Path
from typing import Any

from gproof.backend.boards.board import Observed
from gproof.backend.record_data import (
    ANY_SIGNER,
    FIRST_SCHEMA,
    SCHEMA,
    UNPROVED,
    BoardRecord,
    ExecutionRecord,
    Result,
    Retiming,
    SectionRecord,
    canonical,
)

LARGEST = 256 << 20
"""Bytes of a record that are worth reading."""


def parse_record(data: bytes) -> ExecutionRecord:
    """The record that ``to_json`` wrote; ValueError when it is none or its hash is wrong. The signature is not read."""
    return parse_signed(data)[0]


def parse_signed(data: bytes) -> tuple[ExecutionRecord, dict[str, str] | None]:
    """The record and its signature, which is not checked (None: unsigned); ValueError as of ``parse_record``."""
    try:
        value = _json(data)
        if not isinstance(value, dict) or value.get("schema") not in (SCHEMA, FIRST_SCHEMA):
            raise ValueError(f"it is not of schema {SCHEMA}")
        if data.removesuffix(b"\n") != canonical(value):
            raise ValueError("it is not in canonical form (keys sorted, none twice, no blanks)")
        claimed = value.pop("sha256", None)
        signature = value.pop("signature", None)
        if signature is not None and (
            value["schema"] == FIRST_SCHEMA
            or not isinstance(signature, dict)
            or not all(isinstance(text, str) for text in signature.values())
        ):
            raise ValueError("a signature is an object of texts")
        record = _record(value)
    except (KeyError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
        raise ValueError(f"not an execution record: {error}") from None
    if claimed != record.sha256:
        raise ValueError("the hash of the record does not fit its contents")
    return record, signature


def _json(data: bytes) -> Any:
    try:
        return json.loads(data)
    except ValueError as error:
        raise ValueError(f"it is not JSON ({error})") from None


def is_record(data: bytes) -> bool:
    """True when it is a record of any schema, whole or not: what ``--record`` may replace."""
    try:
        value = json.loads(data)
    except (ValueError, RecursionError):
        return False
    return isinstance(value, dict) and str(value.get("schema")).startswith("gproof-record/")


def read_record(path: Path) -> ExecutionRecord:
    """``parse_record`` of a file; OSError when it cannot be read."""
    return parse_record(path.read_bytes())


def _record(value: dict[str, Any]) -> ExecutionRecord:
    first = value["schema"] == FIRST_SCHEMA
    if first:
        value["accepted"] = ANY_SIGNER
    elif value.pop("unproved", None) != list(UNPROVED):
        raise ValueError("the list of what is not proved was changed")
    _only(value, ExecutionRecord)
    position = value["position"]
    return ExecutionRecord(
        certificate=hex_of(value["certificate"]),
        job=text_of(value["job"]),
        board=board_of(value["board"]),
        motors=tuple(text_of(v) for v in value["motors"]),
        start=ints_of(value["start"]),
        sections=tuple(section_of(v) for v in value["sections"]),
        steps=ints_of(value["steps"]),
        position=None if position is None and not first else ints_of(position),
        observed=observed_of(value["observed"]),
        result=Result(value["result"]),
        reason=text_of(value["reason"]),
        accepted=text_of(value["accepted"]),
        schema=text_of(value["schema"]),
    )


def observed_of(value: dict[str, Any]) -> Observed:
    """What a board measured; ValueError."""
    return Observed(**{k: ints_of(v) for k, v in value.items()})


def board_of(value: dict[str, Any]) -> BoardRecord:
    """What a board said it is; ValueError."""
    _only(value, BoardRecord)
    numbers = ("motors", "tick_frequency", "fifo_runs", "step_pulse", "direction_setup")
    return BoardRecord(
        name=text_of(value["name"]), real_time=_bool(value["real_time"]), **{n: int_of(value[n]) for n in numbers}
    )


def section_of(value: dict[str, Any]) -> SectionRecord:
    """One section; ValueError."""
    _only(value, SectionRecord)
    events = [ints_of(v) for v in value["events"]]
    if any(len(e) != 3 for e in events):
        raise ValueError("an event has a tick, a row and an op")
    return SectionRecord(
        number=int_of(value["number"]),
        outcome=Result(value["outcome"]),
        ticks=int_of(value["ticks"]),
        retimings=tuple(retiming_of(v) for v in value["retimings"]),
        steps=ints_of(value["steps"]),
        position=ints_of(value["position"]),
        accepted=ints_of(value["accepted"]),
        events=tuple((e[0], e[1], e[2]) for e in events),
        wait=text_of(value["wait"]),
        answer=text_of(value["answer"]),
        target=int_of(value["target"]),
    )


def retiming_of(value: dict[str, Any]) -> Retiming:
    """One retiming; ValueError."""
    _only(value, Retiming)
    if value["kind"] not in ("override", "hold"):
        raise ValueError(f"unknown retiming {value['kind']!r}")
    return Retiming(
        kind=value["kind"],
        factor=str(Fraction(text_of(value["factor"]))),
        asked=int_of(value["asked"]),
        rest_begins=int_of(value["rest_begins"]),
        rest=int_of(value["rest"]),
        exact=_bool(value["exact"]),
        source=ints_of(value["source"]),
        target=ints_of(value["target"]),
    )


def _only(value: dict[str, Any], cls: type) -> None:
    names = {f.name for f in dataclasses.fields(cls)}
    if set(value) != names:
        raise ValueError(f"{cls.__name__}: fields {sorted(set(value) ^ names)} missing or unknown")


def int_of(value: object) -> int:
    """A whole number of 64 bits; ValueError."""
    if isinstance(value, bool) or not isinstance(value, int) or abs(value) >= 2**63:
        raise ValueError(f"{value!r} is not a whole number")
    return value


def ints_of(value: list[Any]) -> tuple[int, ...]:
    """A list of them; ValueError or TypeError."""
    return tuple(int_of(v) for v in value)


def text_of(value: object) -> str:
    """A text; ValueError."""
    if not isinstance(value, str):
        raise ValueError(f"{value!r} is not text")
    return value


def _bool(value: object) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"{value!r} is neither true nor false")
    return value


def hex_of(value: object) -> str:
    """A SHA-256 in hexadecimal digits; ValueError."""
    text = text_of(value)
    if len(bytes.fromhex(text)) != 32 or text != text.lower():
        raise ValueError("a SHA-256 has 64 lower-case hexadecimal digits")
    return text
