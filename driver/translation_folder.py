"""The programs of a folder that are translated by themselves, and those that others of them call."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from gproof.driver.errors import Tell, UsageError
from gproof.driver.jobs import find_jobs
from gproof.driver.session import open_session
from gproof.driver.translation import Wanted, map_in, unused_entries
from gproof.driver.translation_machines import machine_to, require_source
from gproof.ir.record import record


@record(frozen=True, slots=True, kw_only=True)
class FolderPrograms:
    """jobs: what to translate, in the order of their paths; called: files that are part of another job, by whom."""

    jobs: tuple[Wanted, ...]
    called: dict[Path, Path]


def folder_programs(wanted: Wanted, tell: Tell) -> FolderPrograms:
    """UsageError for a folder without programs, a side without a machine, an entry of the map that nothing needs."""
    found = find_jobs(
        [str(wanted.job)], tell, machine=wanted.machine, setup=wanted.setup, dialect=wanted.dialect
    )  # fmt: skip
    for job in found:
        require_source(job.path, job.machine)
    machine_to(wanted.to, wanted.machine_to)
    jobs = [
        replace(wanted, job=job.path, machine=job.machine, setup=job.setup, dialect=job.dialect, several=True)
        for job in found
    ]  # fmt: skip
    called = _called([one for one, job in zip(jobs, found, strict=True) if job.source is None])
    jobs = [one for one in jobs if one.job not in called]
    given = map_in(wanted.map)
    if given.given and jobs:
        for table, number in sorted(set.intersection(*(unused_entries(one, given) for one in jobs))):
            raise UsageError(f"map file {wanted.map}: [{table}] {number}: nothing in {wanted.job} needs it")
    return FolderPrograms(jobs=tuple(jobs), called=called)


def _called(jobs: Iterable[Wanted]) -> dict[Path, Path]:
    """Programs that another one calls or includes, and which; not those that call each other."""
    by_place = {one.job.resolve(): one.job for one in jobs}
    reads: dict[Path, set[Path]] = {}
    for one in jobs:
        session = open_session(one.job, machine=one.machine, setup=one.setup, dialect=one.dialect)
        files = () if session.program is None else session.program.files
        reads[one.job] = {by_place[at] for at in (Path(file.name).resolve() for file in files) if at in by_place}
    found: dict[Path, Path] = {}
    for caller, files_of in reads.items():
        for file in files_of - {caller}:
            if caller not in reads[file]:
                found.setdefault(file, caller)
    return found


def output_places(programs: FolderPrograms, folder: Path, output: Path, extension: str) -> list[Path]:
    """Where each program goes: the same folders below ``output``; two of one name keep their extensions in it."""
    names = [one.job.relative_to(folder).with_suffix(extension) for one in programs.jobs]
    counts = Counter(str(name).lower() for name in names)
    return [
        output / (name if counts[str(name).lower()] == 1 else name.with_stem(one.job.name.replace(".", "_")))
        for name, one in zip(names, programs.jobs, strict=True)
    ]
