"""WinCNC jobs for the metamorphic tests: a job with its machine, macros, files and setup, judged in this process.

The machine: X, Y and two vertical heads Z and W, in millimetres. Numbers are millimetres.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from metamorphic.jobs import Job as EdingJob
from metamorphic.jobs import Known, Run, Span, table
from support.judging import UNBOUNDED

from gproof.driver.judge import judge
from gproof.driver.session import Running, open_session
from gproof.ir.trace import Chunk

AXES = "xyzw"
INI = """\
unit=MM
timertype=7200
axischar=XYZW
[X]
axisspec=p0 s0 d0 r80 a6000 t1
axisvel=r12000 f2000
[Y]
axisspec=p0 s1 d1 r80 a6000 t2
axisvel=r12000 f2000
[Z]
axisspec=p0 s2 d2 r160 a3000 t3
axisvel=r4000 f2000
[W]
axisspec=p0 s3 d3 r160 a3000 t3
axisvel=r4000 f2000
vgroup=FXYZW
vgroup=XYZW
softlim=T1
atc1=H0 O0 Z0 A2 M0
positions=P30 H10 T10
portin=2, 8000
portout=7, 8002
auxin=C1 P2 B0 O1 D20
auxin=C2 P2 B1 O1 D20
auxout=C1 P7 B0 O0 S0 E0 X0
auxout=C2 P7 B1 O0 S0 E0 X0
"""
WIDE = 1e6

Move = tuple[float, ...]
"""What a move is (``Op``), turns of an arc, and X Y Z W of where it goes."""
Sides = dict[str, tuple[float | None, float | None]]


def wide(size: float = WIDE) -> dict[str, Span]:
    """Limits that nothing reaches."""
    return dict.fromkeys(AXES, (-size, size))


def nowhere_beyond() -> Sides:
    """No boundaries."""
    return {}


@dataclass(frozen=True)
class Job:
    """What decides a verdict.

    limits: lolim= and hilim=; bounds: lobound= and hibound=; shifts: X and Y of g55= and so on; moves: M of them; sign:
    how they count; files: by name, called by M98; macros: lines of CNC.MAC. Of the setup: start, local (G92), measures
    (M37), by axis: a number, a range, or None: not stated; inputs, outputs, virtual, answers: those that are stated.
    """

    program: str
    limits: dict[str, Span] = field(default_factory=wide)
    bounds: Sides = field(default_factory=nowhere_beyond)
    shifts: dict[int, tuple[float, float]] = field(default_factory=dict)
    moves: int = 0
    sign: int | None = None
    files: dict[str, str] = field(default_factory=dict)
    macros: str = ""
    start: Known = field(default_factory=lambda: dict.fromkeys(AXES, 0.0))
    local: Known = field(default_factory=lambda: dict.fromkeys(AXES, 0.0))
    measures: Known = field(default_factory=lambda: dict.fromkeys("zw", 0.0))
    inputs: dict[int, int] = field(default_factory=dict)
    outputs: dict[int, int] = field(default_factory=dict)
    virtual: dict[int, int] = field(default_factory=dict)
    answers: tuple[str, ...] = ()
    zero: bool = False

    def ini(self) -> str:
        out = [INI.rstrip()]
        out += [f"g54=X0 Y0 T0 M{self.moves}"]
        out += [f"g{n}=X{x} Y{y} T0 M{self.moves}" for n, (x, y) in self.shifts.items()]
        for side, low, high in ((self.limits, "lolim", "hilim"), (self.bounds, "lobound", "hibound")):
            for k, key in enumerate((low, high)):
                words = " ".join(f"{n.upper()}{_number(ends[k])}" for n, ends in side.items() if ends[k] is not None)
                out += [f"{key}={words}"] if words else []
        return "\n".join(out) + "\n"

    def machine_text(self) -> str:
        sign = "" if self.sign is None else f"[controls]\nshift_sign = {self.sign}\n"
        return f'schema = "gproof-machine/1"\nunits = "mm"\nbase = "WINCNC.INI"\n{sign}'

    def setup_text(self) -> str:
        homed = ", ".join(f'"{n}"' for n in AXES)
        out = ['schema = "gproof-setup/1"', 'units = "mm"', f"homed = [{homed}]", "tool = 1", "active_work = 1"]
        if self.answers:
            out.append("answers = [" + ", ".join(f'"{word}"' for word in self.answers) + "]")
        out += table("start", self.start) + table("g92", self.local) + table("measures", self.measures)
        for name in ("inputs", "outputs", "virtual"):
            stated = getattr(self, name)
            key = "virtual_inputs" if name == "virtual" else name
            out += [f"[{key}]", *(f"{n} = {on}" for n, on in stated.items())] if stated else []
        return "\n".join(out) + "\n"

    def told(self) -> str:
        """All of it, to be pasted back."""
        files = "".join(f"--- {name}\n{text}" for name, text in self.files.items())
        macros = f"--- CNC.MAC\n{self.macros}" if self.macros else ""
        ini = self.ini().removeprefix(INI)
        return f"{ini}{self.machine_text()}{self.setup_text()}--- job\n{self.program}{files}{macros}"


@dataclass
class Section:
    """Moves of a section, and the sections that may follow it; None: the end."""

    moves: list[Move] = field(default_factory=list)
    targets: list[int | None] = field(default_factory=list)


@dataclass(frozen=True)
class Sections(Run):
    """A run with its sections."""

    sections: dict[int, Section] = field(default_factory=dict)


def paths(one: Run) -> set[tuple[Move, ...]]:
    """Every way through the sections of a run: its moves, those left out that go nowhere."""
    assert isinstance(one, Sections)
    done: set[tuple[Move, ...]] = set()
    open_: list[tuple[int, tuple[Move, ...]]] = [(0, ())]
    while open_:
        number, moves = open_.pop()
        section = one.sections.get(number, Section())
        for move in section.moves:
            if not moves or move[0] > 2 or move[2:] != moves[-1][2:]:
                moves = (*moves, move)
        following = [target for target in section.targets if target is not None and target >= 0]
        open_ += [(target, moves) for target in following]
        if not following:
            done.add(moves)
    return done


def _number(value: float | None) -> str:
    assert value is not None
    return f"{value:.9f}".rstrip("0").rstrip(".")


def run(folder: Path, job: Job, *, call: str | None = None) -> Run:
    """Judge a job."""
    for path in folder.iterdir():
        path.unlink()
    texts = {"job.tap": job.program, "WINCNC.INI": job.ini(), "CNC.MAC": job.macros, "machine.toml": job.machine_text()}
    for name, text in ({"setup.toml": job.setup_text()} | texts | job.files).items():
        (folder / name).write_text(text, encoding="utf-8")
    setup = "zero" if job.zero else str(folder / "setup.toml")
    session = open_session(
        folder / "job.tap", machine=folder / "machine.toml", setup=setup, dialect="wincnc", call=call
    )  # fmt: skip
    rows: list[np.ndarray] = []
    forms: list[object] = []

    sections: dict[int, Section] = {}

    def observe(chunk: Chunk) -> None:
        moving = chunk.rows["op"] < 10
        section = sections.setdefault(chunk.section, Section())
        section.targets += [edge.target for edge in chunk.edges]
        for op, turns, to in zip(*(chunk.rows[name][moving].tolist() for name in ("op", "turns", "to")), strict=True):
            section.moves.append((op, turns, *(round(value, 6) for value in to[:4])))
        rows.append(
            np.column_stack([
                chunk.rows["to"][moving], chunk.rows["center"][moving], chunk.rows["op"][moving],
                chunk.rows["turns"][moving], chunk.rows["plane"][moving], chunk.rows["feed"][moving],
            ])
        )  # fmt: skip
        forms.extend(chunk.trace.frames[frame][: len(AXES)] for frame in chunk.rows["frame"][moving].tolist())

    judgement = judge(session, running=Running(UNBOUNDED), observe=observe)
    made = np.concatenate(rows) if rows else np.zeros((0, 13))
    same = EdingJob("", {}, start=dict(job.start))
    return Sections(
        same, judgement, made[:, :6], made[:, 6:9], made[:, 9:12].astype(np.int64), made[:, 12], forms, sections
    )


def without_standing(one: Run) -> Run:
    """Without moves that go nowhere: places before and behind are the same, and they are no arcs."""
    if not len(one.to):
        return one
    start = [one.job.start.get(n) for n in AXES]
    first = [value if isinstance(value, float) else np.nan for value in start] + [0.0, 0.0]
    before = np.vstack([first, one.to[:-1]])
    forms = [None, *one.forms[:-1]]
    stands = (np.abs(one.to - before) < 1e-9).all(axis=1) & (one.kind[:, 0] < 3)
    stands &= np.array([n == 0 or a == b for n, (a, b) in enumerate(zip(forms, one.forms, strict=True))])
    keep = ~stands
    return replace(
        one, to=one.to[keep], center=one.center[keep], kind=one.kind[keep], feed=one.feed[keep],
        forms=[form for form, kept in zip(one.forms, keep, strict=True) if kept],
    )  # fmt: skip


def fitted(job: Job, one: Run, room: float, *, axes: str = AXES) -> Job:
    """Limits that lie so far beyond what a job reaches, for the axes whose places rest on nothing unknown."""
    limits = dict(job.limits)
    for name in axes:
        known = [span for (axis, form), span in one.box.items() if axis == name and form == ""]
        if known:
            low, high = known[0][0] - room, known[0][1] + room
            limits[name] = (min(low, high), max(low, high))
    return replace(job, limits=limits)
