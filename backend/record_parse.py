"""Reading execution records back: strict, so that what is read is what was written."""

from __future__ import annotations

import dataclasses
import json
from fractions import Fraction
from pathlib import Path
from typing import Any

from gproof.backend.boards.board import Counting, Executed, Known, Observed
from gproof.backend.record_data import (
    ANY_SIGNER,
    EARLIER_UNPROVED,
    FIRST_SCHEMA,
    NEW_OF_BOARD,
    NEW_OF_SECTION,
    SCHEMA,
    SCHEMAS,
    UNPROVED,
    BoardRecord,
    ExecutionRecord,
    Loss,
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
        if not isinstance(value, dict) or value.get("schema") not in SCHEMAS:
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
    elif value.pop("unproved", None) != list(UNPROVED if value["schema"] == SCHEMA else EARLIER_UNPROVED):
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
    """What a board said it is, without the newer fields where an earlier gproof wrote it; ValueError."""
    earlier = _only(value, BoardRecord, NEW_OF_BOARD)
    told = BoardRecord(
        name=text_of(value["name"]),
        motors=int_of(value["motors"]),
        tick_frequency=int_of(value["tick_frequency"]),
        fifo_runs=int_of(value["fifo_runs"]),
        step_pulse=int_of(value["step_pulse"]),
        direction_setup=int_of(value["direction_setup"]),
        real_time=_bool(value["real_time"]),
    )
    if earlier:
        return told
    return dataclasses.replace(
        told,
        identity=text_of(value["identity"]),
        firmware=text_of(value["firmware"]),
        watched=_bool(value["watched"]),
        most_add=int_of(value["most_add"]),
        longest=int_of(value["longest"]),
        longest_rest=int_of(value["longest_rest"]),
        counting=None if value["counting"] is None else counting_of(value["counting"]),
    )


def counting_of(value: dict[str, Any]) -> Counting:
    """How a board was given the runs that it counts; ValueError."""
    _only(value, Counting)
    levels = ints_of(value["levels"])
    rest, lead = int_of(value["rest"]), int_of(value["lead"])
    if not set(levels) <= {0, 1} or not (0 < lead < rest or rest == lead == 0):
        raise ValueError("levels are 0 or 1, and a clock base is set within the rest before its step")
    return Counting(levels=levels, rest=rest, lead=lead)


def section_of(value: dict[str, Any]) -> SectionRecord:
    """One section, without the newer fields where an earlier gproof wrote it; ValueError."""
    earlier = _only(value, SectionRecord, NEW_OF_SECTION)
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
        known=Known.EXACT if earlier else Known(value["known"]),
        most=() if earlier else ints_of(value["most"]),
        executed=() if earlier else tuple(executed_of(v) for v in value["executed"]),
        losses=() if earlier else tuple(loss_of(v) for v in value["losses"]),
    )


def executed_of(value: dict[str, Any]) -> Executed:
    """What a board counted of one motor; ValueError."""
    _only(value, Executed)
    steps, crc = int_of(value["steps"]), int_of(value["crc"])
    if steps < 0 or not 0 <= crc < 2**32:
        raise ValueError("a count is not negative, and a CRC has 32 bits")
    return Executed(steps, crc)


def loss_of(value: dict[str, Any]) -> Loss:
    """One loss of the line; ValueError."""
    _only(value, Loss)
    return Loss(
        tick=int_of(value["tick"]),
        reason=text_of(value["reason"]),
        steps=ints_of(value["steps"]),
        most=ints_of(value["most"]),
        found=_bool(value["found"]),
        known=Known(value["known"]),
    )


def retiming_of(value: dict[str, Any]) -> Retiming:
    """One retiming; ValueError."""
    _only(value, Retiming)
    if value["kind"] not in ("override", "change", "hold"):
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


def _only(value: dict[str, Any], cls: type, newer: tuple[str, ...] = ()) -> bool:
    """ValueError unless it has the fields of a class; all or none of the newer ones. True: none of them."""
    names = {f.name for f in dataclasses.fields(cls)}
    earlier = bool(newer) and set(value) == names - set(newer)
    if set(value) != names and not earlier:
        raise ValueError(f"{cls.__name__}: fields {sorted(set(value) ^ names)} missing or unknown")
    return earlier


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
