"""Which jobs a command line means: files, folders, patterns, and job files that say what each job is judged with."""

from __future__ import annotations

import glob
import re
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from gproof.driver.dialects import DIALECTS, frontends
from gproof.driver.errors import Tell, UsageError
from gproof.driver.files import require_file
from gproof.frontend.common.paths import is_there
from gproof.frontend.common.toml_table import LARGEST_FILE, TomlFile, TomlTable
from gproof.ir.finding import Findings
from gproof.ir.record import record
from gproof.passes.checks.registry import added

SCHEMA = "gproof-job/1"
HEAD = 1000
"""Bytes of a file that is too large, in which its schema is looked for."""


@record(frozen=True, slots=True, kw_only=True)
class ListedJob:
    """A job and what it is judged with.

    also: properties requested beyond the policy's; strict: a SAFE with conditions counts as UNKNOWN; source: the job
    file that says so, None for the command line.
    """

    path: Path
    machine: Path | None = None
    setup: str | None = None
    dialect: str | None = None
    policy: Path | None = None
    also: tuple[str, ...] = ()
    strict: bool = False
    source: Path | None = None


def find_jobs(
    names: Sequence[str], tell: Tell, *, machine: Path | None, setup: str | None, dialect: str | None,
    exclude: Sequence[str] = (),
) -> list[ListedJob]:  # fmt: skip
    """The jobs that are meant, each once, in the order of the names and by path within one.

    What the command line states goes before what a job file says. UsageError for a name that is no file, for a
    pattern or folder with no job in it, and for a job file with an error. tell: takes the findings of each job file
    that can be used all the same.
    """
    found: dict[tuple[Path, Path | None], ListedJob] = {}
    for name in names:
        for job in _of_name(name, tell):
            if any(job.path.match(pattern) for pattern in exclude):
                continue
            stated = replace(
                job,
                machine=job.machine if machine is None else machine,
                setup=job.setup if setup is None else setup,
                dialect=job.dialect if dialect is None else dialect,
            )
            found.setdefault((job.path.resolve(), job.source), stated)
    if not found:
        raise UsageError("no jobs left: --exclude leaves out all of them")
    return list(found.values())


def is_several(names: Sequence[str]) -> bool:
    """Whether names may be for more than, or for other things than, one file with a program."""
    path = Path(names[0])
    if not names[0]:
        return True
    is_pattern = glob.has_magic(names[0]) and not path.exists()
    return len(names) != 1 or is_pattern or path.is_dir() or _is_job_file(path)


def _of_name(name: str, tell: Tell) -> Iterator[ListedJob]:
    path = Path(name)
    if not name:
        raise UsageError("the name of a job is empty")
    if path.is_dir():
        jobs = sorted(_in_folder(path, tell), key=lambda job: job.path.as_posix())
        if not jobs:
            raise UsageError(f"{path}: no programs in this folder ({', '.join(sorted(_extensions()))})")
        yield from jobs
    elif path.exists() or not glob.has_magic(name):
        if _is_job_file(path):
            yield from read_job_file(path, tell)
        else:
            yield ListedJob(path=path)
    else:
        files = sorted(Path(one) for one in glob.glob(name, recursive=True) if Path(one).is_file())
        if not files:
            raise UsageError(f"{name}: no file matches this pattern")
        for file in files:
            yield from read_job_file(file, tell) if _is_job_file(file) else [ListedJob(path=file)]


def _extensions() -> set[str]:
    """Of programs, but for macros, includes, and what may be anything: a folder is not searched for these."""
    return {extension for one in frontends() for extension in one.extensions if extension not in one.no_jobs}


def _never() -> set[str]:
    """Names of files that are no jobs, in lower case."""
    return {name for one in frontends() for name in one.never}


def _in_folder(folder: Path, tell: Tell) -> Iterator[ListedJob]:
    """Job files of a folder and those below it, and programs of which no job file speaks; nothing that is hidden."""
    told: list[ListedJob] = []
    programs: list[Path] = []
    wanted, never = _extensions(), _never()
    for path in sorted(folder.rglob("*")):
        if any(part.startswith(".") for part in path.relative_to(folder).parts) or not path.is_file():
            continue
        if _is_job_file(path):
            told += read_job_file(path, tell)
        elif path.suffix.lower() in wanted and path.name.lower() not in never:
            programs.append(path)
    known = {job.path.resolve() for job in told}
    yield from told
    yield from (ListedJob(path=path) for path in programs if path.resolve() not in known)


def _is_job_file(path: Path) -> bool:
    """Whether a TOML file says that it is a job file."""
    if path.suffix.lower() != ".toml":
        return False
    try:
        with path.open("rb") as file:
            text = file.read(LARGEST_FILE + 1)
        if len(text) > LARGEST_FILE:  # said where it is read
            return b"gproof-job/" in text[:HEAD]
        return str(tomllib.loads(text.decode()).get("schema", "")).startswith("gproof-job/")
    except (OSError, ValueError, RecursionError):
        return False


def read_job_file(path: Path, tell: Tell) -> list[ListedJob]:
    """The jobs of a job file; docs/job-files.md defines the keys. UsageError, with its findings, for a bad one.

    tell: takes those of one that can be used all the same.
    """
    require_file(path, "job file")
    findings = Findings()
    file = TomlFile(path, SCHEMA, findings)
    root = file.root
    jobs: list[ListedJob] = []
    if root is not None:
        defaults = _settings(root, path, ListedJob(path=path, source=path))
        for name in _names(root):
            jobs += _named(root, "job", path, name, defaults)
        for table in root.tables("jobs"):
            own = _settings(table, path, defaults)
            for name in _names(table):
                jobs += _named(table, "job", path, name, own)
            table.finish()
        root.finish()
        if not jobs and not file.errors:
            root.missing("job")
    if file.errors:
        raise UsageError(f"job file {path}: cannot be used, see the errors above", findings)
    if findings.kept:
        tell(findings)
    return jobs


def _names(table: TomlTable) -> list[str]:
    value = table.take("job")
    names = value if isinstance(value, list) else [] if value is None else [value]
    if not all(isinstance(name, str) for name in names):
        table.bad("job", "must be a path or a list of paths")
        return []
    return list(names)


def _named(table: TomlTable, key: str, source: Path, name: str, settings: ListedJob) -> list[ListedJob]:
    """The files of a path or pattern, seen from the folder of the job file."""
    folder = source.parent
    if "\0" in name:
        table.bad(key, f"{name!r} is not a file name")
        return []
    if not glob.has_magic(name) or is_there(folder / name):
        return [replace(settings, path=folder / name)]
    files = sorted(folder / one for one in _matching(name, folder))
    if not files:
        table.bad(key, f"no file matches {name!r}")
    return [replace(settings, path=file) for file in files if file.is_file()]


def _matching(pattern: str, folder: Path) -> list[str]:
    """What a pattern matches; nothing for what cannot be one."""
    try:
        return glob.glob(pattern, root_dir=folder, recursive=True)
    except (OSError, ValueError, re.error, OverflowError, RecursionError):
        return []


def _also(table: TomlTable, base: ListedJob) -> tuple[str, ...]:
    """``also = ["cutting"]``: names of properties, or "all"."""
    value = table.take("also")
    if value is None:
        return base.also
    if not isinstance(value, list) or not all(isinstance(name, str) for name in value):
        table.bad("also", "must be a list of names of properties")
        return base.also
    for name in value:
        if name not in (*added(), "all"):
            table.bad("also", f"{name!r} is not one of {', '.join(added())}, all")
    return tuple(value)


def _settings(table: TomlTable, source: Path, base: ListedJob) -> ListedJob:
    machine, setup, policy = table.text("machine"), table.text("setup"), table.text("policy")
    strict = table.boolean("strict")
    dialect = table.text("dialect", tuple(DIALECTS))
    folder = source.parent
    return replace(
        base,
        machine=base.machine if machine is None else folder / machine,
        setup=base.setup if setup is None else setup if setup == "zero" else str(folder / setup),
        dialect=base.dialect if dialect is None else dialect,
        policy=base.policy if policy is None else folder / policy,
        also=_also(table, base),
        strict=base.strict if strict is None else strict,
    )
