"""Execution records: canonical, chained, read back strictly, compared with the job."""

import hashlib
import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from backend.jobs import job
from backend.test_runtime import TWO, Tap

from gproof.backend import runtime
from gproof.backend.boards.board import Observed
from gproof.backend.record import parse_record, problems, read_record
from gproof.backend.record_data import ExecutionRecord, Result, canonical
from gproof.backend.runtime import Hold


@pytest.fixture(scope="module")
def record() -> ExecutionRecord:
    return runtime.walk(TWO, Tap(2), override=Fraction(1, 2), hold_at=Hold(at=300_000, rest=1000))


@pytest.fixture(scope="module")
def stopped() -> ExecutionRecord:
    return runtime.walk(TWO, Tap(2), estop_at=300_000)


def test_the_file_is_canonical_json_with_its_hash(record: ExecutionRecord) -> None:
    data = record.to_json()
    value = json.loads(data)
    assert canonical(value) + b"\n" == data
    claimed = value.pop("sha256")
    chained = hashlib.sha256(bytes.fromhex(TWO.certificate) + canonical(value)).hexdigest()
    assert claimed == chained == record.sha256
    assert value["schema"] == "gproof-record/3"
    assert value["certificate"] == TWO.certificate


def test_a_record_is_written_whole_and_read_back(record: ExecutionRecord, tmp_path: Path) -> None:
    path = tmp_path / "job.record.json"
    path.write_text("old")
    record.write(path)
    assert read_record(path) == record
    assert [p.name for p in tmp_path.iterdir()] == ["job.record.json"]
    with pytest.raises(OSError, match="missing"):
        record.write(tmp_path / "missing" / "x.json")


def test_any_changed_byte_is_noticed(record: ExecutionRecord) -> None:
    data = record.to_json()
    for place in range(0, len(data) - 1, 97):
        other = data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :]
        try:
            assert parse_record(other) != record
        except ValueError:
            continue


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"[]",
        b"{}",
        b'{"schema":"gproof-record/1"}',
        b'{"schema":"gproof-record/2"}',
        b'{"schema":"gproof-record/4"}',
        b"\xff",
        b"[" * 100_000,
        b'"x"',
    ],
)
def test_what_is_no_record_is_refused(data: bytes) -> None:
    with pytest.raises(ValueError, match=r".+"):
        parse_record(data)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("certificate", "zz"),
        ("certificate", "AB" * 32),
        ("start", [0.5, 0]),
        ("start", [True, 0]),
        ("start", [2**63, 0]),
        ("steps", 3),
        ("result", "fine"),
        ("observed", []),
        ("observed", {"colour": [1]}),
        ("board", None),
        ("motors", [1]),
        ("sections", [{}]),
        ("surprise", 1),
    ],
)
def test_wrong_fields_are_refused(record: ExecutionRecord, field: str, value: object) -> None:
    body = json.loads(record.to_json())
    body[field] = value
    with pytest.raises(ValueError, match=r".+"):
        parse_record(canonical(body))


def test_wrong_retimings_are_refused(record: ExecutionRecord) -> None:
    for field, value in [("factor", "1/0"), ("kind", "faster"), ("exact", 1), ("source", "abc")]:
        body = json.loads(record.to_json())
        body["sections"][0]["retimings"][0][field] = value
        with pytest.raises(ValueError, match=r".+"):
            parse_record(canonical(body))


def section(record: ExecutionRecord, place: int, /, **more: object) -> ExecutionRecord:
    sections = list(record.sections)
    sections[place] = replace(sections[place], **more)
    return replace(record, sections=tuple(sections))


def test_true_records_fit(record: ExecutionRecord, stopped: ExecutionRecord) -> None:
    assert record.result is Result.COMPLETED
    assert stopped.result is Result.EMERGENCY_STOP
    assert list(problems(record, TWO)) == []
    assert list(problems(stopped, TWO)) == []


def test_tampered_records_do_not_fit(record: ExecutionRecord, stopped: ExecutionRecord) -> None:
    first, last = record.sections[0], record.sections[-1]
    override, held = first.retimings
    bad = {
        "other certificate": replace(record, certificate="00" * 32),
        "other motors": replace(record, motors=("x", "z")),
        "other clock": replace(record, board=replace(record.board, tick_frequency=5)),
        "other start": replace(record, start=(1, 0)),
        "missing motor": replace(record, steps=(1,)),
        "more steps": section(record, 1, steps=(1401, 1400)),
        "other position": section(record, 1, position=(1, 0)),
        "other total": replace(record, steps=(0, 0)),
        "other end": replace(record, position=(9, 9)),
        "other ticks": section(record, 0, ticks=first.ticks - 1),
        "no events": section(record, 0, events=()),
        "other events": section(record, 0, events=((1, 2, 3),)),
        "section left out": replace(record, sections=record.sections[:1] + record.sections[2:]),
        "ended early": replace(record, sections=record.sections[:-1]),
        "nothing done": replace(record, sections=()),
        "other answer": section(record, 0, answer="off"),
        "other target": section(record, 0, target=2),
        "end denied": section(record, 2, wait="", answer=""),
        "stopped, they say": replace(record, result=Result.STOPPED),
        "section stopped": section(record, 2, outcome=Result.STOPPED),
        "number out of range": section(record, 2, number=7),
        "early pulses": replace(record, observed=Observed(overlaps=(0, 3), setups=(0, 0))),
        "no override": section(record, 0, retimings=(held,)),
        "other factor": section(record, 0, retimings=(replace(override, factor="3/5"), held)),
        "factor out of range": section(record, 0, retimings=(replace(override, factor="2"), held)),
        "faster": section(record, 0, retimings=(replace(override, target=(0, 1), source=(0, 5)), held)),
        "after the end": replace(record, sections=(*record.sections, last)),
    }
    for what, other in bad.items():
        assert parse_record(other.to_json()) == other, what
        assert list(problems(other, TWO)), what
    at = stopped.sections[-1]
    for what, other in {
        "one step less": section(stopped, -1, steps=(at.steps[0] - 1, at.steps[1])),
        "later": section(stopped, -1, ticks=at.ticks + 50_000),
        "completed": section(replace(stopped, result=Result.COMPLETED), -1, outcome=Result.COMPLETED),
        "underrun": replace(stopped, result=Result.UNDERRUN),
        "underrun elsewhere": section(
            replace(stopped, result=Result.UNDERRUN),
            -1,
            outcome=Result.UNDERRUN,
            steps=(at.steps[0] - 1, at.steps[1]),
        ),
    }.items():
        assert list(problems(other, TWO)), what


def test_an_empty_section_is_recorded() -> None:
    empty = job([], [(1.0, 1.0)])
    done = runtime.walk(empty, Tap(2))
    assert done.result is Result.COMPLETED
    assert done.sections[0].steps == (0, 0)
    assert list(problems(done, empty)) == []
