"""Jobs for the metamorphic tests: a program with its machine and setup, judged inside this process."""

from __future__ import annotations

import random
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
from support.judging import UNBOUNDED

from gproof.driver.judge import Judgement, judge
from gproof.driver.session import Running, open_session
from gproof.ir.trace import Chunk
from gproof.ir.verdict import Verdict

AXES = "xyza"
WORSE = {Verdict.SAFE: 0, Verdict.UNKNOWN: 1, Verdict.UNSAFE: 2}

Span = tuple[float, float]
Known = dict[str, float | Span | None]


@dataclass(frozen=True)
class Job:
    """What decides a verdict. A value of the setup is a number, a range, or None: not stated."""

    program: str
    limits: dict[str, Span]
    start: Known = field(default_factory=lambda: dict.fromkeys(AXES, 0.0))
    work: dict[int, Known] = field(default_factory=lambda: {n: dict.fromkeys(AXES, 0.0) for n in (1, 2, 3)})
    g92: Known = field(default_factory=lambda: dict.fromkeys(AXES, 0.0))
    tools: dict[int, float] = field(default_factory=lambda: {1: 12.5, 2: 40.25, 3: 7.75})
    lengths: dict[int, Span | None] = field(default_factory=dict)
    parks: dict[int, float] = field(default_factory=dict)
    parameters: dict[int, float | Span] = field(default_factory=dict)
    area: dict[str, Span] | None = None
    block_delete: bool | None = False
    active: int | None = 1
    controller: dict[str, str] = field(default_factory=dict)
    unit: str = "mm"

    def machine_text(self) -> str:
        out = ['schema = "gproof-machine/1"', f'units = "{self.unit}"']
        for name, (low, high) in self.limits.items():
            out += [f"[axes.{name}]", f"min = {low!r}", f"max = {high!r}"]
        if self.area is not None:
            out += ["[areas.tool_change]", *(f"{n} = [{a!r}, {b!r}]" for n, (a, b) in self.area.items())]
        for tool, length in self.tools.items():
            if tool not in self.lengths:
                out += [f"[tools.{tool}]", f"length = {length!r}"]
        out += ["[controller]", *(f"{key} = {value}" for key, value in self.controller.items())]
        return "\n".join(out) + "\n"

    def setup_text(self) -> str:
        out = ['schema = "gproof-setup/1"', f'units = "{self.unit}"', 'homed = ["x", "y", "z", "a"]', "tool = 1"]
        if self.active is not None:
            out.append(f"active_work = {self.active}")
        if self.block_delete is not None:
            out.append(f"block_delete = {str(self.block_delete).lower()}")
        out += table("start", self.start)
        for n, values in self.work.items():
            out += table(f"work.{n}", values)
        out += table("g92", self.g92)
        out.append("[parameters]")
        out += [f"{n} = {_text(v)}" for n, v in (self.parks | self.parameters).items()]
        for tool, span in self.lengths.items():
            if span is not None:
                out += [f"[tools.{tool}]", f"length = {_text(span)}"]
        return "\n".join(out) + "\n"


def _text(value: float | Span) -> str:
    return repr(list(value)) if isinstance(value, tuple) else repr(value)


def table(name: str, values: Known) -> list[str]:
    return [f"[{name}]", *(f"{n} = {_text(v)}" for n, v in values.items() if v is not None)]


@dataclass(frozen=True)
class Run:
    """What a job gave: the answer, and its moves as columns."""

    job: Job
    judgement: Judgement
    to: npt.NDArray[np.float64]
    center: npt.NDArray[np.float64]
    kind: npt.NDArray[np.int64]  # op, turns, plane
    feed: npt.NDArray[np.float64]
    forms: list[object]

    @property
    def verdict(self) -> Verdict:
        return self.judgement.verdict

    def answer(self, name: str) -> Verdict:
        return next(p.verdict for p in self.judgement.properties if p.name == name)

    @property
    def clean(self) -> bool:
        """The language and the arcs of the program are as its maker meant them."""
        return self.answer("language") is Verdict.SAFE and self.answer("arcs") is Verdict.SAFE

    @property
    def box(self) -> dict[tuple[str, str], Span]:
        """Extents by axis and what they rest on, where known with the start."""
        out = {(name, form): (low, high) for name, form, low, high in self.judgement.summary.box}
        for (name, form), (low, high) in out.items():
            start = self.job.start[name]
            if form == "" and isinstance(start, float):
                start *= 25.4 if self.job.unit == "inch" and name != "a" else 1.0
                out[name, form] = min(low, start), max(high, start)
        return out

    def told(self) -> str:
        return "\n".join(f"{f.span.line}: {f.code.label} {f.message}" for f in self.judgement.findings.kept)


def run(folder: Path, job: Job) -> Run:
    """Judge a job."""
    (folder / "job.cnc").write_text(job.program, encoding="utf-8")
    (folder / "machine.toml").write_text(job.machine_text(), encoding="utf-8")
    (folder / "setup.toml").write_text(job.setup_text(), encoding="utf-8")
    session = open_session(
        folder / "job.cnc", machine=folder / "machine.toml", setup=str(folder / "setup.toml"), dialect="eding"
    )
    rows: list[np.ndarray] = []
    forms: list[object] = []

    def observe(chunk: Chunk) -> None:
        moving = chunk.rows["op"] < 10
        rows.append(
            np.column_stack([
                chunk.rows["to"][moving], chunk.rows["center"][moving], chunk.rows["op"][moving],
                chunk.rows["turns"][moving], chunk.rows["plane"][moving], chunk.rows["feed"][moving],
            ])
        )  # fmt: skip
        forms.extend(chunk.trace.frames[frame] for frame in chunk.rows["frame"][moving].tolist())

    judgement = judge(session, running=Running(UNBOUNDED), observe=observe)
    table = np.concatenate(rows) if rows else np.zeros((0, 13))
    return Run(job, judgement, table[:, :6], table[:, 6:9], table[:, 9:12].astype(np.int64), table[:, 12], forms)


def same_moves(one: Run, other: Run, tolerance: float = 0.0) -> str:
    """ "" when both make the same moves, else what differs first."""
    if len(one.to) != len(other.to):
        return f"{len(one.to)} moves and {len(other.to)}"
    for name in ("kind", "to", "center", "feed"):
        a, b = getattr(one, name), getattr(other, name)
        near = tolerance * (1000.0 if name == "feed" else 1.0)
        close = np.isclose(a, b, rtol=0.0, atol=near, equal_nan=True)
        wrong = np.flatnonzero(~(close if close.ndim == 1 else close.all(axis=1)))
        if len(wrong):
            return f"move {wrong[0]}: {name} {a[wrong[0]].tolist()} and {b[wrong[0]].tolist()}"
    if one.forms != other.forms:
        return "what positions rest on"
    return ""


def wide(size: float = 1e6) -> dict[str, Span]:
    return dict.fromkeys(AXES, (-size, size))


def random_setup(rng: random.Random, job: Job) -> Job:
    """A start, offsets and park positions, all known, multiples of 1/16."""

    def some(most: int = 480) -> Known:
        return {n: rng.randrange(-most, most) / 16 if rng.random() < 0.6 else 0.0 for n in AXES}

    parks = {base + k: rng.randrange(-480, 480) / 16 for base in (5161, 5181) for k in range(4)}
    return replace(job, start=some(), work={n: some() for n in (1, 2, 3)}, g92=some(160), parks=parks)


def fitted(rng: random.Random, job: Job, run: Run, sizes: tuple[float, ...]) -> Job:
    """Limits a little beyond what the job reaches, or a little before it; what is unknown gets wide ones."""
    limits = dict(job.limits)
    for (name, form), (low, high) in run.box.items():
        if form == "":
            a, b = low - rng.choice(sizes), high + rng.choice(sizes)
            limits[name] = (min(a, b), max(a, b))
    return replace(job, limits=limits)
