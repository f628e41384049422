"""Which steps of a record are proved by what the board counted, which were only acknowledged, and what is not known.

Firmware with the certification extension counts the steps that it executed and states a CRC-32 of their runs. Both are
derived again from the certified stream and the retimings (``verify/execution``, which shares no code with the driver).
"""

from __future__ import annotations

import enum
from collections.abc import Iterator

from gproof.backend.boards.board import Known
from gproof.backend.job import CertifiedJob, identity_of
from gproof.backend.override_change import changed
from gproof.backend.record_data import ExecutionRecord, Result, SectionRecord
from gproof.backend.retime import Spacing, retime, slow_map
from gproof.ir.record import record
from gproof.ir.stream import StreamSection
from gproof.verify.execution.run_sums import Given, RunSums, run_sums


class Proof(enum.Enum):
    """PROVED: the board's count and CRC are those of the stream. ACKNOWLEDGED: the board took the runs, its clock
    passed their ticks, and it counts no more than that. UNKNOWN: it may have made more, or others."""

    PROVED = "proved"
    ACKNOWLEDGED = "acknowledged"
    UNKNOWN = "unknown"


@record(frozen=True, slots=True)
class MotorProof:
    """What is known of a motor in a section: ``steps`` made at least, and by which word; most: at most (None: no number
    is known), where that is more."""

    section: int
    motor: str
    steps: int
    proof: Proof
    most: int | None


def sent(done: SectionRecord, planned: StreamSection, job: CertifiedJob) -> StreamSection:
    """The section as it was sent, made again from the record's retimings; ValueError when they make none."""
    section = planned
    for change in done.retimings:
        times = change.times()
        if change.kind == "override":
            meant = slow_map(section, job.stream.tick_frequency, change.factor_value())
            if meant.source.tolist() != times.source.tolist() or meant.target.tolist() != times.target.tolist():
                raise ValueError(f"the time map does not fit an override of {change.factor}")
        spacing = Spacing.of(job.machine, job.stream.tick_frequency, exact=change.exact)
        if change.kind == "change":
            section = changed(planned, section, change, spacing)
            continue
        section = retime(section, times, spacing)
    return section


def derived(done: SectionRecord, section: StreamSection, record: ExecutionRecord, motor: int) -> RunSums | None:
    """The count and CRCs that a board may state of a motor; section: as it was sent. None where it was not counted."""
    counting = record.board.counting
    if counting is None or motor >= len(done.executed) or motor >= len(counting.levels):
        return None
    given = Given(
        level=counting.levels[motor],
        rest=counting.rest,
        lead=counting.lead,
        most_add=record.board.most_add,
        longest=max(record.board.longest, 1),
    )
    identity = identity_of(record.certificate)
    return run_sums(section.runs[motor], done.executed[motor].steps, given, identity=identity, section=done.number)


def executed_problems(
    done: SectionRecord, section: StreamSection, record: ExecutionRecord, where: str
) -> Iterator[str]:  # fmt: skip
    """What the board counted that is not of the stream."""
    if not done.executed:
        return
    counting = record.board.counting
    if counting is None or len(done.executed) != len(section.runs) or len(counting.levels) != len(section.runs):
        yield f"{where}: the board counts {len(done.executed)} motors, which it cannot or the stream does not have"
        return
    for motor, (name, made) in enumerate(zip(record.motors, done.executed, strict=True)):
        if made.steps != done.steps[motor]:
            yield f"{where}: motor {name} made {done.steps[motor]} steps, and the board counts {made.steps}"
            continue
        sums = derived(done, section, record, motor)
        if sums is None or sums.steps != made.steps or made.crc not in sums.crcs:
            wanted = "" if sums is None else " or ".join(f"{crc:08x}" for crc in sums.crcs)
            yield f"{where}: the board's CRC of {made.steps} steps of motor {name} is {made.crc:08x}, not {wanted}"


def proofs(record: ExecutionRecord, job: CertifiedJob) -> list[MotorProof]:
    """What is known of each section and motor of a record that fits its job; ValueError where it does not."""
    found: list[MotorProof] = []
    for done in record.sections:
        found += proof_of(done, sent(done, job.stream.sections[done.number], job), record)
    return found


def proof_of(done: SectionRecord, section: StreamSection, record: ExecutionRecord) -> Iterator[MotorProof]:
    """What is known of each motor in a section; section: as it was sent."""
    whole = [int(runs["count"].sum()) for runs in section.runs]
    for motor, name in enumerate(record.motors):
        steps = done.steps[motor]
        sums = derived(done, section, record, motor)
        if sums is not None and sums.steps == steps and done.executed[motor].crc in sums.crcs:
            yield MotorProof(done.number, name, steps, Proof.PROVED, None)
        elif done.known is Known.UNKNOWN:
            yield MotorProof(done.number, name, steps, Proof.UNKNOWN, None)
        elif done.outcome is Result.INTERRUPTED or done.known is Known.BETWEEN or done.most:
            most = done.most[motor] if done.most else whole[motor]
            proof = Proof.UNKNOWN if most != steps else Proof.ACKNOWLEDGED
            yield MotorProof(done.number, name, steps, proof, most if most != steps else None)
        else:
            yield MotorProof(done.number, name, steps, Proof.ACKNOWLEDGED, None)
