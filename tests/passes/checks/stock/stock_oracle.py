"""What the check of stock has to say of a random job, and what it must not say."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from passes.checks.stock.stock_jobs import MACHINE, Judged
from passes.checks.stock.stock_scenes import Scene
from passes.checks.stock.stock_solid import Floats, Told

from passes.checks.stock import stock_solid as solid

NEEDED = {
    solid.THROUGH: {435, 436}, solid.NEAR: {435, 436}, solid.PARTS: {441, 442}, solid.FLUTES: {437, 439},
    solid.DEPTH: {438, 439},
}  # fmt: skip
CERTAIN = {435: solid.THROUGH, 437: solid.FLUTES, 438: solid.DEPTH, 441: solid.PARTS}


def judge(scene: Scene, folder: Path) -> Judged:
    machine = MACHINE + f"[controller]\nstraight_traverse = {str(scene.straight).lower()}\n"
    return Judged(
        folder, scene.text, tools=tuple(tool for tool, _ in scene.tools), stock=tuple(b for b, _ in scene.bodies),
        cell=scene.cell, clearance=scene.clearance, start="", setup="active_work = 1\ntool = 1\n", machine=machine,
    )  # fmt: skip


def spread(scene: Scene, many: int) -> Floats:
    """Places all over the stock, most of them where tools pass."""
    draw = np.random.default_rng(scene.seed)
    out = [draw.uniform((0.0, 0.0), (scene.wide, scene.deep), (many, 2))]
    for way in {id(w.steps): w for ways in scene.ways for w in ways}.values():
        step = way.steps[draw.integers(len(way.steps))]
        wide = max([way.tool.cutter.radius, *(p.radius for p in way.tool.others[:1])])
        out.append(step.at(draw.uniform(0, 1, 30))[:, :2] + draw.normal(0, 0.7, (30, 2)) * wide)
    points = np.concatenate(out)
    return points[((points >= 0.0) & (points <= (scene.wide, scene.deep))).all(axis=1)]


def met(scene: Scene, points: Floats, only: set[int] | None = None, *, certain: bool) -> Told:
    """What happens on any outcome, to any body."""
    total: Told = {}
    same = len(scene.ways[0]) == len(scene.ways[1]) and all(
        a.steps is b.steps for a, b in zip(*scene.ways, strict=True)
    )
    for ways in scene.ways[:1] if same else scene.ways:
        for _, body in scene.bodies:
            found = solid.follow(ways, body, points, scene.cell, scene.clearance, certain=certain, only=only)
            for key, mm in found.items():
                total[key] = max(total.get(key, 0.0), mm)
    return total


def around(scene: Scene, line: int, many: int) -> Floats:
    """Many places where the tool of a line passes, the corners and edges of cells among them."""
    draw = np.random.default_rng(line)
    out = []
    for way in (w for ways in scene.ways for w in ways if w.line == line):
        wide = max([way.tool.cutter.radius, *(p.radius for p in way.tool.others)])
        t = np.linspace(0.0, 1.0, max(2, 400 // len(way.steps)))
        at = np.concatenate([step.at(t) for step in way.steps])[:, :2]
        spots = np.repeat(at, 40, axis=0)
        out.append(spots + draw.uniform(-1, 1, spots.shape) * way.tool.cutter.radius)
        out.append(spots + draw.uniform(-1, 1, spots.shape) * wide)
        out.append(spots)
        low, high = at.min(axis=0) - wide, at.max(axis=0) + wide
        for size in (scene.cell,):
            nets = []
            for axis, length in enumerate((scene.wide, scene.deep)):
                h = length / max(1, math.ceil(length / size - 1e-9))
                k = np.arange(max(0, math.floor(low[axis] / h)), math.floor(min(high[axis], length) / h) + 2) * h
                nets.append(np.concatenate([k - 1e-7, k + 1e-7]))
            x, y = np.meshgrid(*nets)
            out.append(np.stack([x.ravel(), y.ravel()], axis=1))
            for net, axis in ((nets[0], 0), (nets[1], 1)):
                some = at[:: max(1, len(at) // 60)]
                edge = np.repeat(some, len(net), axis=0)
                edge[:, axis] = np.tile(net, len(some))
                out.append(edge)
    points = np.concatenate(out)
    points = points[((points >= 0.0) & (points <= (scene.wide, scene.deep))).all(axis=1)]
    return points[draw.permutation(len(points))[:many]]


def retraced(scene: Scene, line: int) -> bool:
    """Whether the traverses of a line go straight up or down, or where a feed has cut: no clearance is asked."""
    for ways in scene.ways:
        for k, way in enumerate(ways):
            if way.line != line or way.feed:
                continue
            a, b = way.ends
            if (a[:2] == b[:2]).all():
                continue
            t = np.linspace(0.0, 1.0, 41)
            places = np.concatenate([step.at(t) for step in way.steps])
            free = np.zeros(len(places), dtype=np.bool_)
            for other in ways[:k]:
                if not other.feed or other.tool is not way.tool or other.steps[0].arc is not None:
                    continue
                for step in other.steps:
                    along = step.end[:2] - step.start[:2]
                    square = max(float(along @ along), 1e-30)
                    s = np.clip((places[:, :2] - step.start[:2]) @ along / square, 0.0, 1.0)
                    gap = np.hypot(*(places[:, :2] - step.start[:2] - s[:, None] * along).T)
                    free |= (gap < 1e-6) & (places[:, 2] >= step.start[2] + s * (step.end[2] - step.start[2]) - 1e-6)
            if not free.all():
                return False
    return True


def lifted(scene: Scene, line: int, told: set[int]) -> bool:
    """Whether a line only goes straight up or down where the job was told of that tool as deep before."""
    for ways in scene.ways:
        for k, way in enumerate(ways):
            if way.line != line:
                continue
            (x, y, z), to = way.ends
            if (to[:2] != (x, y)).any():
                return False
            before = [(w, e) for w in ways[:k] if w.tool is way.tool and w.line in told for e in w.ends[1:]]
            if not any((e[:2] == (x, y)).all() and e[2] <= min(z, to[2]) for _, e in before):
                return False
    return True


def followed(scene: Scene, line: int, told: set[int]) -> bool:
    """Whether a cut goes on from one that is told: what no flute reached stands above it."""
    return any(
        way.line == line and k > 0 and ways[k - 1].line in told for ways in scene.ways for k, way in enumerate(ways)
    )


def wrong(scene: Scene, judged: Judged, many: int = 600) -> list[str]:
    """What the check says that is not so, or does not say that is."""
    told: dict[int, set[int]] = {}
    for line, code in judged.told():
        told.setdefault(line, set()).add(code)
    points = spread(scene, many)
    out = []
    for (kind, line), mm in sorted(met(scene, points, certain=True).items(), key=lambda item: item[0][1]):
        if told.get(line, set()) & (NEEDED[kind] | {443}):
            continue
        if kind in (solid.FLUTES, solid.DEPTH):
            excused = followed(scene, line, {n for n, codes in told.items() if codes & {437, 438, 439}})
        else:
            excused = kind == solid.NEAR and retraced(scene, line)
        excused |= kind != solid.NEAR and lifted(scene, line, set(told))
        if not excused:
            out.append(f"line {line}: {kind} by {mm:.4f} mm is not told")
    open_ = {(CERTAIN[code], line): code for line, codes in told.items() for code in codes & set(CERTAIN)}
    for k in range(3):
        lines = {line for _, line in open_}
        for one in [lines] if k == 0 else [{line} for line in lines]:
            if k:
                points = around(scene, min(one), (3000, 100_000)[k - 1])
            for key in met(scene, points, one, certain=False) if one else ():
                open_.pop(key, None)
    out += [f"line {line}: GP{code} is not so" for (_, line), code in open_.items()]
    if judged.verdict == "SAFE" and out:
        out.append("and the job is SAFE")
    return out


def report(scene: Scene, judged: Judged) -> str:
    """What to paste back."""
    numbered = "\n".join(f"{n:4} {line}" for n, line in enumerate(scene.lines, 1))
    said = "\n".join(f"{f.span.line} {f.code.number} {f.message}" for f in judged.findings.kept)
    entries = "\n".join(repr(tool) for tool, _ in scene.tools)
    stock = [repr(b)[:200] for b, _ in scene.bodies]
    head = f"seed {scene.seed} cell {scene.cell} clearance {scene.clearance} straight {scene.straight}"
    return "\n".join([head, entries, *stock, numbered, said])
