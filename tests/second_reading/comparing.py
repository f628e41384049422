"""A random job, its machine and setup as files, gproof's answer and the second reading's, held against each other.

A `Job` comes from a generator (`eding_jobs`, `wincnc_jobs`, `mcuwin_jobs`) without limits; `limits_for` puts them
beside the extents of the second reading, so that most jobs just fit or just do not.
"""

from __future__ import annotations

import json
import math
import random
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from support.command import in_this_process

from .walked import Limits, NotRead, Point, Walk

TOLERANCE = 0.005
"""mm, degrees: what counts as past a limit. Arcs that are a little off their circle and samples between need it."""
NEAREST = 0.02
"""No limit lies nearer to where the program goes."""
Sides = dict[str, tuple[float | None, float | None]]
Read = Callable[[Limits], Iterator[Walk]]


@dataclass
class Job:
    """A job before it has limits. read: the second reading under some; files: by name, made for some limits."""

    dialect: str
    program: str
    suffix: str
    axes: tuple[str, ...]
    start: Point
    read: Read
    files: Callable[[Limits], dict[str, str]]
    words: tuple[str, ...] = ()
    """Further words of the command line."""
    true: Mapping[str, float] = field(default_factory=dict)
    """Of the symbols that a condition of gproof's may name, by their beginning: what they are here."""


@dataclass
class Compared:
    """Both answers to one job.

    verdict: of language, limits and arcs; codes: of the findings that decide it; over: what the second reading says.
    """

    kind: str
    verdict: str
    codes: tuple[str, ...]
    text: str
    over: str = ""


def extents(walks: list[Walk], start: Point) -> dict[str, tuple[float, float]]:
    """How far each axis gets in any reading."""
    return {
        axis: (
            min([start[axis], *(p[axis] for walk in walks for p in walk.points)]),
            max([start[axis], *(p[axis] for walk in walks for p in walk.points)]),
        )
        for axis in start
    }


def limits_for(rng: random.Random, job: Job, walks: list[Walk]) -> Sides:
    """Limits beside the extents: mostly just outside, one side in twelve just inside."""
    sides: Sides = {}
    for axis, (low, high) in extents(walks, job.start).items():
        start = job.start[axis]
        ends = []
        for sign, extreme in ((-1, low), (1, high)):
            room = abs(extreme - start)
            if rng.random() < 1 / 12 and room > 0.2:
                move = -min(room - 0.1, 10 ** rng.uniform(-1.6, 1))
            else:
                move = 10 ** rng.uniform(-1.6, 1.3)
            end = extreme + sign * max(move, NEAREST) if move > 0 else extreme + sign * min(move, -NEAREST)
            ends.append(math.floor(end * 1e4) / 1e4)
        sides[axis] = (ends[0], ends[1])
    return sides


Box = tuple[tuple[float, float], tuple[float, float], tuple[float, float]]


def zone_beside(rng: random.Random, walks: list[Walk]) -> Box:
    """A box, X Y Z, with one face near to a place of the path, on either side of it."""
    at = rng.choice(rng.choice([w for w in walks if w.points]).points)
    sides = []
    facing = rng.choice("XYZ")
    for axis in "XYZ":
        width = rng.uniform(6, 40)
        low = at[axis] - width * rng.random()
        if axis == facing:
            away = rng.choice((-1, 1)) * 10 ** rng.uniform(-1, 0.8)
            low = at[axis] + away if rng.random() < 0.5 else at[axis] + away - width
        sides.append((round(low, 2), round(low + width, 2)))
    return sides[0], sides[1], sides[2]


def deepest(box: Box, walk: Walk) -> bool:
    """Whether a straight piece between two samples that follow one another has a point well within the box."""
    margin = 2 * TOLERANCE
    for start, end in zip(walk.points, walk.points[1:], strict=False):
        first, last = 0.0, 1.0
        for axis, (low, high) in zip("XYZ", box, strict=True):
            a, step = start[axis], end[axis] - start[axis]
            if abs(step) < 1e-12:
                if not low + margin < a < high - margin:
                    last = -1.0
                continue
            one, two = sorted(((low + margin - a) / step, (high - margin - a) / step))
            first, last = max(first, one), min(last, two)
        if last > first:
            return True
    return False


def answer(job: Job, limits: Limits, box: Box | None) -> tuple[dict[str, object], dict[str, str]]:
    """gproof's report as JSON, and the files that it judged."""
    files = {**job.files(limits), f"job.{job.suffix}": job.program}
    if box:
        sides = "\n".join(f"{axis} = [{low}, {high}]" for axis, (low, high) in zip("xyz", box, strict=True))
        files["setup.toml"] += f'[[keep_out]]\nname = "zone"\n{sides}\n'
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path, text in files.items():
            (folder / path).write_text(text)
        done = in_this_process(["check", f"job.{job.suffix}", *job.words, "--format", "json"], folder)
    if not done.out:
        raise AssertionError(f"gproof ended with {done.exit}: {done.err}\n{pasted(files)}")
    return json.loads(done.out), files


def pasted(files: Mapping[str, str]) -> str:
    """Files so that they can be pasted."""
    return "\n".join(f"--- {name}\n{text}" for name, text in files.items())


def holds(job: Job, limits: Mapping[str, object]) -> bool:
    """Whether the conditions of a SAFE hold for what the second reading takes as the truth."""
    for condition in limits["conditions"]:  # type: ignore[attr-defined]
        value = 0.0
        for term in condition["terms"]:
            known = [v for name, v in job.true.items() if str(term["symbol"]).startswith(name)]
            if not known:
                raise AssertionError(f"a condition on {term['symbol']}, which the setup states")
            value += term["coefficient"] * known[0]
        if not (condition["low"] is None or condition["low"] <= value + 1e-6):
            return False
        if not (condition["high"] is None or condition["high"] >= value - 1e-6):
            return False
    return True


def compared(seed: str, job: Job, rng: random.Random) -> Compared:
    """Both answers to one job."""
    sides: Sides
    try:
        sides = limits_for(rng, job, list(job.read(dict.fromkeys(job.axes, (None, None)))))
        walks = list(job.read(sides))
    except NotRead as why:
        sides = {a: (v - 10 ** rng.uniform(0, 2.5), v + 10 ** rng.uniform(0, 2.5)) for a, v in job.start.items()}
        walks, unread = [], str(why)
    box = zone_beside(rng, walks) if walks and rng.random() < 0.25 and any(w.points for w in walks) else None
    report, files = answer(job, sides, box)
    properties: dict[str, dict[str, object]] = report["properties"]  # type: ignore[assignment]
    limits = properties["limits"]
    judged = [str(properties[name]["verdict"]) for name in ("language", "limits", "arcs")]
    verdict = next((v for v in ("UNSAFE", "UNKNOWN") if v in judged), "SAFE")
    found: list[dict[str, str]] = report["findings"]  # type: ignore[assignment]
    decisive = {"UNSAFE": ("error",), "UNKNOWN": ("unknown", "error")}.get(verdict, ())
    codes = tuple(sorted({f["code"] for f in found if f["severity"] in decisive and f["property"] != "areas"}))
    if verdict == "SAFE" and not holds(job, limits):
        verdict = "CONDITION"
    past = [o for walk in walks for o in walk.over.values() if o.by > TOLERANCE]
    stopped = sorted({walk.refused for walk in walks if walk.refused})
    told = f"seed {seed}\n{pasted(files)}\n--- gproof: {verdict} {codes}\n"
    told += "".join(f"{f['line']}: {f['code']} {f['message']}\n" for f in found)
    for name, one in properties.items():
        told += "".join(f"{name} if {c['text']}\n" for c in one["conditions"])  # type: ignore[attr-defined]
    told += f"--- second reading: stops {stopped}\n"
    told += "".join(
        f"{w.answers}: "
        + "; ".join(f"{o.axis} {o.side} by {o.by:.4f} in line {o.line}" for o in w.over.values())
        + "\n"
        for w in walks[:8]
    )
    if not walks:
        return Compared("not read", verdict, codes, told, unread)
    why = ", ".join(reason.partition(": ")[2] for reason in stopped[:1])
    if (
        box
        and report["verdict"] == "SAFE"
        and holds(job, properties["areas"])
        and any(deepest(box, walk) for walk in walks)
    ):
        return Compared("wrong SAFE", verdict, codes, told + "--- in the zone\n", "zone")
    if past:
        kind = "wrong SAFE" if verdict == "SAFE" else "right"
        if verdict == "UNKNOWN":
            kind = "unknown, past"
    elif stopped:
        kind = "error not found" if verdict == "SAFE" and len(stopped) == len({w.refused for w in walks}) else "stops"
    else:
        kind = {"SAFE": "right", "CONDITION": "false alarm", "UNSAFE": "false alarm", "UNKNOWN": "unknown, inside"}[
            verdict
        ]
    return Compared(kind, verdict, codes, told, why if kind in {"stops", "error not found"} else "")


@dataclass
class Figures:
    """What a campaign counted."""

    kinds: Counter[str] = field(default_factory=Counter)
    verdicts: Counter[str] = field(default_factory=Counter)
    codes: dict[str, Counter[str]] = field(default_factory=dict)
    first: dict[tuple[str, str], str] = field(default_factory=dict)
    """The first example of each kind and code."""

    def add(self, one: Compared) -> None:
        self.kinds[one.kind] += 1
        self.verdicts[one.verdict] += 1
        for code in (one.over,) if one.over else one.codes:
            self.codes.setdefault(one.kind, Counter())[code] += 1
            self.first.setdefault((one.kind, code), one.text)

    def lines(self, name: str) -> list[str]:
        total = sum(self.kinds.values())
        said = [f"{name}: {total} programs, " + ", ".join(f"{n} {v}" for v, n in sorted(self.verdicts.items()))]
        for kind, count in sorted(self.kinds.items()):
            codes = ", ".join(f"{code} {n}" for code, n in self.codes.get(kind, Counter()).most_common(12))
            said.append(f"  {kind}: {count}" + (f" ({codes})" if codes else ""))
        return said
