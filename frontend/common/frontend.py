"""What a dialect's folder gives: its ``__init__.py`` exports a ``Frontend``, and ``driver/dialects.py`` lists it.

Everything heavy is after functions that import it when they are called, so that all frontends can be listed while
one reads a job.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gproof.ir.record import record

if TYPE_CHECKING:
    from gproof.frontend.common.alone import Alone
    from gproof.frontend.common.resuming import Resumed, Start
    from gproof.frontend.common.toml_table import TomlTable
    from gproof.ir.finding import Findings
    from gproof.ir.job import Job
    from gproof.ir.machine import Machine
    from gproof.ir.program import Program
    from gproof.ir.settings import Settings
    from gproof.ir.setup import Setup

Files = list[tuple[str, str]]
"""(name, sha256) of the files that were read, in order."""


@record(frozen=True, slots=True, kw_only=True)
class Marker:
    """A text that only programs of one controller have. rank: markers of all dialects are looked for by it, the lowest
    first; reason: as reports say it; pattern: of bytes."""

    rank: int
    reason: str
    pattern: bytes


@record(frozen=True, slots=True, kw_only=True)
class Alike:
    """A text of this dialect that another one's marker would take for its own. reason: of that marker, which says
    nothing then where the folder is one of this dialect; by_extension: nor where the file's extension says so."""

    reason: str
    by_extension: bool = False


@record(frozen=True, slots=True, kw_only=True)
class Reading:
    """What a job is read with. machine: of the machine file, or of none; read: the files that it came from; call: the
    subprogram that is judged, "" for the job itself."""

    job: Path
    findings: Findings
    machine: Machine
    machine_file: Path | None
    read: Sequence[Path] = ()
    call: str = ""


@record(frozen=True, slots=True, kw_only=True)
class OwnTable:
    """What gproof's machine file may state that only one controller has.

    name: its table, "" for none; keys: those of its own of ``[controller]``; read_keys: takes them out of that table.
    usual: its settings where nothing is stated; read: its settings with what a file states, the machine as the file has
    it without: (the file's tables, machine, mm in a unit, its keys).
    whole: the whole machine, of a file that is of this controller wherever it has the table, with the files that were
    read for it: (the file's tables, machine, mm in a unit, tables that state settings of another controller).
    """

    name: str = ""
    keys: tuple[str, ...] = ()
    read_keys: Callable[[TomlTable], dict[str, Any]] = lambda table: {}
    usual: Callable[[], Settings]
    read: Callable[[TomlTable, Machine, Fraction, dict[str, Any]], Settings] | None = None
    whole: Callable[[TomlTable, Machine, Fraction, tuple[str, ...]], tuple[Machine, Files]] | None = None


FileOf = Callable[["Machine", Path | None, Path | None, Path], "Alone"]
"""How a file by itself is read: (machine, its file, the folder that the file is in or None, the file)."""

Read = tuple["Program | None", "Machine"]
"""The program, None where the job's file is refused, and the machine that it is judged on."""


@record(frozen=True, slots=True, kw_only=True)
class Frontend:
    """name: as ``--dialect`` has it; title: as people have it.

    extensions: of programs, which decide when their text says nothing; no_jobs: those among them that a folder is not
    searched for; never: names of files that are no jobs either.
    shop_files: names of files that only a folder of this controller has; settings: what files of settings are called,
    with what they are, in words.
    markers, alike: how a program is distinguished from those of other dialects.
    open_offsets: kinds of symbols that an operator sets to move the zero (``ir/trace.py``, Frames).
    load_program: reads a job with all that it calls. raise_program: makes a Job of it, for translation, with what
    the setup states;
    resumed: writes the program that goes on with the lines of one in its middle; CannotResume.
    plain_devices: leaves out what its machine's macros do at a tool change.
    alone: how one file is read to be printed again; definitions: name
    of a file of the folder that holds what lines stand for; lines_of_machine: whether settings of a machine say how
    lines are read; folder_machine: name of its file, which is looked for next to a program then.
    load_machine: reads the controller's own machine file: (path, findings, whether no other file refines it, the keys
    that such a file states again). machine_files: names of it; knows_machine: whether a file of another name is one,
    None: whatever nobody else knows. own_table: what gproof's machine file may state for it alone.
    completed: what a machine of this dialect has that no file names.
    setup_table: a table of setup files that only this dialect has, "" for none; setup_fields: what it states, as fields
    of a Setup.
    """

    name: str
    title: str
    extensions: tuple[str, ...]
    no_jobs: tuple[str, ...] = ()
    never: tuple[str, ...] = ()
    shop_files: tuple[str, ...] = ()
    settings: tuple[tuple[str, str], ...] = ()
    markers: tuple[Marker, ...] = ()
    alike: tuple[Alike, ...] = ()
    open_offsets: tuple[str, ...] = ("work",)
    load_program: Callable[[Reading], Read]
    alone: FileOf
    definitions: str = ""
    lines_of_machine: bool = True
    folder_machine: str = ""
    load_machine: Callable[[Path, Findings, bool, frozenset[tuple[str, ...]]], tuple[Machine | None, Files]]
    machine_files: tuple[str, ...] = ()
    knows_machine: Callable[[Path], bool] | None = None
    own_table: OwnTable | None = None
    completed: Callable[[Machine], Machine] = lambda machine: machine
    setup_table: str = ""
    setup_fields: Callable[[TomlTable], dict[str, Any]] = lambda root: {}
    raise_program: Callable[[Program, Machine, Setup], Job] | None = None
    resumed: Callable[[Sequence[str], Start], Resumed] | None = None
    plain_devices: Callable[[Program], Program] = lambda program: program
