"""Both programs of a translation at a known place, by the interpreter alone: path, feeds and events side by side.

Nothing here is of ``verify/``. Each run is followed by every answer of its inputs; between two events the path of one
side is sampled and looked up on the other one by its length, so that it may be cut in other places.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from gproof.ir.program import SpindleOutputs
from gproof.ir.trace import Edge, Op, Trace, TraceSection, Wait

PAIRS = {1: (0, 1), 2: (2, 0), 3: (1, 2)}
"""Columns of the axes of a plane, so that counter-clockwise is from the first to the second."""
MOST_RUNS = 64
"""Runs of a program by what its inputs answer; the rest is left out on both sides."""
LOOKS_EVERY = 0.1
"""Seconds: a loop that looks for an input as often as this is the wait for it."""
SAMPLES = 3
"""Places within a part of the path, besides its end."""


class Part(NamedTuple):
    """A straight line or an arc; center None: a line. sweep: radians, signed."""

    rapid: bool
    feed: float
    start: np.ndarray
    end: np.ndarray
    center: np.ndarray | None
    pair: tuple[int, int]
    sweep: float
    length: float

    def at(self, share: float) -> np.ndarray:
        """The place after so much of it."""
        place = self.start + share * (self.end - self.start)
        if self.center is not None:
            u, v = self.pair
            x, y = self.start[u] - self.center[u], self.start[v] - self.center[v]
            cos, sin = math.cos(share * self.sweep), math.sin(share * self.sweep)
            place[u] = self.center[u] + x * cos - y * sin
            place[v] = self.center[v] + x * sin + y * cos
        return place


@dataclass
class Run:
    """Parts of the path, and events: (kind, numbers, parts before it)."""

    parts: list[Part] = field(default_factory=list)
    events: list[tuple[str, tuple[float, ...], int]] = field(default_factory=list)
    answers: tuple[str, ...] = ()
    state: dict[str, tuple[float, ...]] = field(default_factory=dict)

    def copy(self) -> Run:
        return Run(list(self.parts), list(self.events), self.answers, dict(self.state))


def runs(trace: Trace, outputs: SpindleOutputs, by: int) -> dict[tuple[str, ...], Run]:
    """The runs of a program by what its inputs answer. by: what numbers of channels have more than those of a plain
    controller."""
    found: dict[tuple[str, ...], Run] = {}
    rest: list[tuple[int, Run]] = [(0, Run())]
    while rest and len(found) < MOST_RUNS:
        number, run = rest.pop()
        section = trace.sections[number]
        _section(trace, section, run, outputs, by)
        ways = list(_ways(trace, section, run, by))
        if not ways:
            found[run.answers] = run
        rest += ways
    return found


def _ways(trace: Trace, section: TraceSection, run: Run, by: int) -> Iterator[tuple[int, Run]]:
    edges = section.edges
    asked = trace.questions.get(section.number)
    polled = [edge for edge in edges if asked is not None and _comes_back(trace, edge, section.number)]
    if asked is not None and len(polled) == 1 and len(edges) == 2:
        # An input that is read again and again is the wait for it.
        (left,) = [edge for edge in edges if edge is not polled[0]]
        on = asked.on == (left.outcome == "true")
        run.events.append(("input", (float(asked.channel - by), float(on)), len(run.parts)))
        yield left.target, run
        return
    for edge in edges:
        after = run.copy() if len(edges) > 1 else run
        if edge.wait is Wait.BRANCH and len(edges) > 1:
            assert asked is not None, "a branch that no input decides"
            on = asked.on == (edge.outcome == "true")
            after.answers = (*after.answers, f"{asked.kind} {asked.channel - by} {on}")
        elif edge.wait not in (Wait.END, Wait.BRANCH):
            name = "stop" if edge.wait is Wait.OPERATOR else edge.wait.value
            if edge.wait is Wait.OPERATOR:
                # The operator may have switched anything; the speed that is set is the controller's, and a command
                # for one device leaves the outputs of the others as they are.
                kept = {name: value for name, value in after.state.items() if name == "speed" or "channel" in name}
                after.state = kept
            if edge.wait is not Wait.INPUT:
                after.events.append((f"wait for {name}", (), len(after.parts)))
        if edge.target >= 0:
            yield edge.target, after


def _comes_back(trace: Trace, edge: Edge, to: int, *, again: bool = True) -> bool:
    """Whether nothing happens between an outcome of a section and that section, or one like it that is a loop. again:
    the loop may come after a first question."""
    seen: set[int] = set()
    rest = [edge.target]
    while rest:
        here = rest.pop()
        if here == to:
            return True
        if here < 0 or here in seen:
            continue
        seen.add(here)
        section = trace.sections[here]
        rows = zip(section.rows["op"].tolist(), section.rows["arg"].tolist(), strict=True)
        if any(
            (op < Op.INPUT_WAIT and not (op == Op.DWELL and arg[0] <= LOOKS_EVERY)) or op in (Op.STOP, Op.HOME)
            for op, arg in rows
        ):
            continue
        if here not in trace.questions:
            rest += [one.target for one in section.edges]
        elif again and trace.questions[here] == trace.questions[to]:
            same = [one for one in section.edges if one.outcome == edge.outcome]
            if any(_comes_back(trace, one, here, again=False) for one in same):
                return True
    return False


def _section(trace: Trace, section: TraceSection, run: Run, outputs: SpindleOutputs, by: int) -> None:
    rows = section.rows
    at = np.array(section.start[:3])
    for n, kind in enumerate(rows["op"].tolist()):
        op = Op(kind)
        if op >= Op.DWELL:
            _event(run, op, rows["arg"][n].tolist(), int(rows["text"][n]), outputs, by)
            continue
        to = np.array(rows["to"][n][:3])
        assert not any(trace.frames[int(rows["frame"][n])][:3]), "a place that is unknown"
        part = _part(
            op, at, to, rows["center"][n], int(rows["turns"][n]), int(rows["plane"][n]), float(rows["feed"][n])
        )
        if part.length > 1e-9:
            run.parts.append(part)
        at = to


def _part(op: Op, at: np.ndarray, to: np.ndarray, center: np.ndarray, turns: int, plane: int, feed: float) -> Part:
    if op is not Op.ARC:
        return Part(op is Op.TRAVERSE, feed, at, to, None, (0, 1), 0.0, float(np.linalg.norm(to - at)))
    u, v = PAIRS[plane]
    begin, stop = (math.atan2(place[v] - center[v], place[u] - center[u]) for place in (at, to))
    sweep = (stop - begin) * (1 if turns > 0 else -1) % math.tau
    sweep = (sweep if sweep > 1e-9 else math.tau) + (abs(turns) - 1) * math.tau
    rise = next(to[k] - at[k] for k in range(3) if k not in (u, v))
    length = math.hypot(sweep * math.hypot(at[u] - center[u], at[v] - center[v]), rise)
    return Part(False, feed, at, to, np.array(center), (u, v), sweep if turns > 0 else -sweep, length)


def _event(run: Run, op: Op, arg: list[float], text: int, outputs: SpindleOutputs, by: int) -> None:
    """Events, without what repeats the state in force."""
    here = len(run.parts)
    if op is Op.OUTPUT:
        channel = round(arg[0])
        spindle = {*outputs.forward, *outputs.backward}
        if channel in spindle | set(outputs.coolant):
            run.state[f"channel {channel}"] = (arg[1],)
            _device(run, outputs, channel in spindle, here, is_off=not arg[1])
        else:
            _switch(run, f"output {channel - by}", (arg[1],), here)
    elif op is Op.SPINDLE:
        run.state["speed"] = (arg[1],) if arg[0] else run.state.get("speed", (0.0,))
        _switch(run, "spindle", (arg[0], arg[1] if arg[0] else 0.0), here)
    elif op is Op.SETPOINT:
        run.state["speed"] = (arg[1],)
        turning = run.state.get("spindle") or (_direction(run, outputs),)
        if turning[0]:
            _switch(run, "spindle", (turning[0], arg[1]), here)
    elif op is Op.COOLANT:
        _switch(run, "coolant", (max(arg),), here)
    elif op is Op.DWELL:
        if run.events and run.events[-1][0] == "dwell" and run.events[-1][2] == here:
            arg[0] += run.events.pop()[1][0]
        if arg[0]:
            run.events.append(("dwell", (arg[0],), here))
    elif op is Op.TOOL_CHANGE:
        if run.events and run.events[-1] == ("tool", (arg[0],), here):
            return
        run.events.append(("tool", (arg[0],), here))
    elif op is Op.INPUT_WAIT and not math.isnan(arg[1]):
        run.events.append(("input", (arg[0] - by, arg[1]), here))
    elif op is Op.STOP:
        run.events.append(("stop", (arg[0],), here))
    elif op is Op.END and arg[1]:
        run.state["ended"] = (1.0,)


def _switch(run: Run, name: str, values: tuple[float, ...], here: int) -> None:
    last = run.events[-1] if run.events else None
    if name == "spindle":
        before = run.state.pop("spindle before", None)
        if before is not None and last is not None and last[0] == name and last[2] == here:
            # A speed right before a command for the spindle is part of it.
            run.events.pop()
            run.state[name] = before
        known = run.state.get(name)
        if known is not None and values[0] == known[0] != 0.0 and values != known:
            run.state["spindle before"] = known
    if run.state.get(name) != values:
        run.events.append((name, values, here))
    run.state[name] = values


def _on(run: Run) -> set[int]:
    """Channels that are on, of those that run a device."""
    return {int(name.split()[1]) for name, value in run.state.items() if name.startswith("channel ") and value[0]}


def _direction(run: Run, outputs: SpindleOutputs) -> float:
    """In which direction outputs let the spindle turn."""
    mine = _on(run) & {*outputs.forward, *outputs.backward}
    return 0.0 if not mine else 1.0 if mine == set(outputs.forward) else -1.0


def _device(run: Run, outputs: SpindleOutputs, spindle: bool, here: int, *, is_off: bool) -> None:
    """What outputs that run the spindle or a coolant have made of it. One that is switched off while another one is on,
    after a stop, is the first of two."""
    if not spindle:
        cools = bool(_on(run) & set(outputs.coolant))
        if not (cools and is_off and "coolant" not in run.state):
            _switch(run, "coolant", (float(cools),), here)
        return
    direction = _direction(run, outputs)
    if direction and is_off and "spindle" not in run.state:
        return
    _switch(run, "spindle", (direction, run.state.get("speed", (0.0,))[0] if direction else 0.0), here)


# ---- two runs


def difference(one: Run, other: Run, tolerance: float, chord: float) -> tuple[str, float]:
    """(what is not the same, "" for nothing, the largest distance that was seen, mm)."""
    if any("ended" in run.state for run in (one, other)):
        # The code for the end of one of them switches both off; the other one may do it right before.
        for run in (one, other):
            on = [name for name in ("spindle", "coolant") if run.state.get(name, (0.0,))[0]]
            if on and "ended" not in run.state:
                return f"{on[0]} on at the end of one alone", 0.0
            while run.events and run.events[-1][0] in ("spindle", "coolant") and run.events[-1][2] == len(run.parts):
                if any(run.events[-1][1]):
                    break
                run.events.pop()
    kinds = [[event[:2] for event in run.events] for run in (one, other)]
    for place, (a, b) in enumerate(zip(*kinds, strict=False)):
        close = len(a[1]) == len(b[1]) and all(
            abs(x - y) <= 1e-3 * max(1.0, abs(x)) for x, y in zip(a[1], b[1], strict=True)
        )
        if a[0] != b[0] or not close:
            return f"event {place}: {a} and {b}", 0.0
    if len(kinds[0]) != len(kinds[1]):
        return f"events: {kinds[0]} and {kinds[1]}", 0.0
    worst, before = 0.0, (0, 0)
    for a, b in [*((x[2], y[2]) for x, y in zip(one.events, other.events, strict=True)), (None, None)]:
        parts = one.parts[before[0] : a], other.parts[before[1] : b]
        text, far = _paths(*parts, tolerance, chord)
        worst = max(worst, far)
        if text:
            return text, worst
        before = (a or 0, b or 0)
    return "", worst


def _paths(one: list[Part], other: list[Part], tolerance: float, chord: float) -> tuple[str, float]:
    """Two paths between events."""
    if len(one) == len(other) and all(_alike(a, b, tolerance) for a, b in zip(one, other, strict=True)):
        return "", max((float(np.abs(a.end - b.end).max()) for a, b in zip(one, other, strict=True)), default=0.0)
    lengths = [np.cumsum([0.0, *(part.length for part in parts)]) for parts in (one, other)]
    total = [float(known[-1]) for known in lengths]
    # Each part may be longer by twice the rounding of its ends, an arc by its sweep.
    allowed = chord + tolerance * (4 + 8 * (len(one) + len(other)))
    longer = abs(total[0] - total[1])
    if longer > allowed + chord * 1e-2 * total[0]:
        return f"one path has {total[0]:.6f} mm, the other one {total[1]:.6f} mm", 0.0
    if not total[0] or not total[1]:
        return "", 0.0
    worst = 0.0
    allowed += longer
    for part, begin in zip(one, lengths[0].tolist(), strict=False):
        for share in [(n + 0.5) / SAMPLES for n in range(SAMPLES)]:
            along = (begin + share * part.length) / total[0] * total[1]
            n = min(int(np.searchsorted(lengths[1], along, "right")) - 1, len(other) - 1)
            there = other[n]
            place = there.at(min(1.0, (along - float(lengths[1][n])) / there.length)) if there.length else there.end
            far = float(np.linalg.norm(part.at(share) - place))
            worst = max(worst, far)
            if far > allowed:
                return f"{far:.6f} mm apart after {along:.3f} mm", worst
            edge = min(abs(along - float(lengths[1][n])), abs(along - float(lengths[1][n + 1])))
            if edge > allowed and (part.rapid != there.rapid or not _same_feed(part.feed, there.feed)):
                return f"feed {part.feed} and {there.feed} after {along:.3f} mm", worst
    return "", worst


def _alike(a: Part, b: Part, tolerance: float) -> bool:
    if a.rapid != b.rapid or (a.center is None) != (b.center is None) or not _same_feed(a.feed, b.feed):
        return False
    if np.abs(a.end - b.end).max() > tolerance or np.abs(a.start - b.start).max() > tolerance:
        return False
    if a.center is None or b.center is None:
        return True
    far = max(abs(a.center[k] - b.center[k]) for k in a.pair)
    return a.pair == b.pair and bool(far <= 4 * tolerance) and abs(a.length - b.length) <= 0.05 + 1e-3 * a.length


def _same_feed(one: float, other: float) -> bool:
    return (math.isnan(one) and math.isnan(other)) or abs(one - other) <= 2e-4 * max(one, other, 1e-9)
