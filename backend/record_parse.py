"""Reading execution records back: strict, so that what is read is what was written."""

from __future__ import annotations

import dataclasses
import json
from fractions import Fraction
from pathlib import Path
from typing import Any

from gproof.backend.boards.board import Observed
from gproof.backend.record_data import (
    SCHEMA,
    BoardRecord,
    ExecutionRecord,
    Result,
    Retiming,
    SectionRecord,
)


def parse_record(data: bytes) -> ExecutionRecord:
    """The record that ``to_json`` wrote; ValueError when it is none or its hash is wrong."""
    try:
        value = json.loads(data)
        if not isinstance(value, dict) or value.pop("schema", None) != SCHEMA:
            raise ValueError(f"not of schema {SCHEMA}")
        claimed = value.pop("sha256", None)
        record = _record(value)
    except (KeyError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
        raise ValueError(f"not an execution record: {error}") from None
    if claimed != record.sha256:
        raise ValueError("the record's hash does not fit its contents")
    return record


def read_record(path: Path) -> ExecutionRecord:
    """``parse_record`` of a file; OSError when it can not be read."""
    return parse_record(path.read_bytes())


def _record(value: dict[str, Any]) -> ExecutionRecord:
    _only(value, ExecutionRecord)
    return ExecutionRecord(
        certificate=_hex(value["certificate"]),
        job=_text(value["job"]),
        board=_board(value["board"]),
        motors=tuple(_text(v) for v in value["motors"]),
        start=_ints(value["start"]),
        sections=tuple(_section(v) for v in value["sections"]),
        steps=_ints(value["steps"]),
        position=_ints(value["position"]),
        observed=Observed(**{k: _ints(v) for k, v in value["observed"].items()}),
        result=Result(value["result"]),
        reason=_text(value["reason"]),
    )


def _board(value: dict[str, Any]) -> BoardRecord:
    _only(value, BoardRecord)
    numbers = ("motors", "tick_frequency", "fifo_runs", "step_pulse", "direction_setup")
    return BoardRecord(
        name=_text(value["name"]), real_time=_bool(value["real_time"]), **{n: _int(value[n]) for n in numbers}
    )


def _section(value: dict[str, Any]) -> SectionRecord:
    _only(value, SectionRecord)
    events = [_ints(v) for v in value["events"]]
    if any(len(e) != 3 for e in events):
        raise ValueError("an event has a tick, a row and an op")
    return SectionRecord(
        number=_int(value["number"]),
        outcome=Result(value["outcome"]),
        ticks=_int(value["ticks"]),
        retimings=tuple(_retiming(v) for v in value["retimings"]),
        steps=_ints(value["steps"]),
        position=_ints(value["position"]),
        accepted=_ints(value["accepted"]),
        events=tuple((e[0], e[1], e[2]) for e in events),
        wait=_text(value["wait"]),
        answer=_text(value["answer"]),
        target=_int(value["target"]),
    )


def _retiming(value: dict[str, Any]) -> Retiming:
    _only(value, Retiming)
    if value["kind"] not in ("override", "hold"):
        raise ValueError(f"unknown retiming {value['kind']!r}")
    return Retiming(
        kind=value["kind"],
        factor=str(Fraction(_text(value["factor"]))),
        asked=_int(value["asked"]),
        rest_begins=_int(value["rest_begins"]),
        rest=_int(value["rest"]),
        exact=_bool(value["exact"]),
        source=_ints(value["source"]),
        target=_ints(value["target"]),
    )


def _only(value: dict[str, Any], cls: type) -> None:
    names = {f.name for f in dataclasses.fields(cls)}
    if set(value) != names:
        raise ValueError(f"{cls.__name__}: fields {sorted(set(value) ^ names)} missing or unknown")


def _int(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or abs(value) >= 2**63:
        raise ValueError(f"{value!r} is not a whole number")
    return value


def _ints(value: list[Any]) -> tuple[int, ...]:
    return tuple(_int(v) for v in value)


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise ValueError(f"{value!r} is not text")
    return value


def _bool(value: object) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"{value!r} is neither true nor false")
    return value


def _hex(value: object) -> str:
    text = _text(value)
    if len(bytes.fromhex(text)) != 32 or text != text.lower():
        raise ValueError("a SHA-256 has 64 lower-case hexadecimal digits")
    return text
