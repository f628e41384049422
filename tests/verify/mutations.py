"""Ways to spoil a right stream. Each takes a clean stream and a random generator and gives a wrong one.

Where a kind of damage can be harmless by definition, the mutation makes it larger than the bound that
docs/verification.md states, and says so; tests/verify/kernel/test_stream.py holds the other side, that what lies within
the bounds passes.
"""

import dataclasses
import random
from collections.abc import Callable
from dataclasses import dataclass, field

from verify.jobs import JOBS
from verify.reference_stepper import Job, Stepped, machine, step

from gproof.ir.machine import Controller, Machine
from gproof.ir.trace import Op


@dataclass
class Case:
    """A trace and machine to judge by, and the stream to judge."""

    job: Job
    done: Stepped
    on: Machine = field(default_factory=machine)


def clean(name: str) -> Case:
    job = JOBS[name]()
    return Case(job, step(job, machine()))


def _busy(done: Stepped, rng: random.Random, least: int = 20) -> int:
    return rng.choice([m for m, steps in enumerate(done.steps) if len(steps) >= least])


# --- steps --------------------------------------------------------------------------------------------------


def step_dropped(case: Case, rng: random.Random) -> None:
    """The end position is exact, so every single step counts."""
    steps = case.done.steps[_busy(case.done, rng)]
    del steps[rng.randrange(len(steps))]


def step_doubled(case: Case, rng: random.Random) -> None:
    steps = case.done.steps[_busy(case.done, rng)]
    k = rng.randrange(len(steps) - 1)
    steps.insert(k + 1, ((steps[k][0] + steps[k + 1][0]) // 2 + 1, steps[k][1]))


def step_reversed(case: Case, rng: random.Random) -> None:
    steps = case.done.steps[_busy(case.done, rng)]
    k = rng.randrange(len(steps))
    steps[k] = (steps[k][0], -steps[k][1])


def step_of_another_motor(case: Case, rng: random.Random) -> None:
    m = _busy(case.done, rng)
    taken = case.done.steps[m].pop(rng.randrange(len(case.done.steps[m])))
    other = case.done.steps[(m + 1) % len(case.done.steps)]
    other.append(taken)
    other.sort()


def steps_moved_in_time(case: Case, rng: random.Random) -> None:
    """Two successive steps of a motor 12 steps of the others later: the motor is 2 steps behind the path meanwhile,
    and going back along the path by the others' tolerance (1.5 steps) wins less than one of them back."""
    done = case.done
    while True:
        m = _busy(done, rng)
        k = rng.randrange(len(done.steps[m]) - 1)
        tick = done.steps[m][k + 1][0]
        others = sorted(t for o, s in enumerate(done.steps) if o != m for t, _ in s if t > tick)
        following = [t for t, _ in done.steps[m] if t > tick]
        if len(others) > 12 and not any(t <= others[11] for t in following):
            break
    (_, d0), (_, d1) = done.steps[m][k], done.steps[m][k + 1]
    done.steps[m][k : k + 2] = [(others[11] + 1, d0), (others[11] + 200, d1)]
    done.steps[m] = _apart(done.steps[m])


def steps_swapped_between_motors(case: Case, rng: random.Random) -> None:
    """Two steps of one motor for two of another, far apart: 2 steps off in both. (One pair is 1 step off in
    each, which the tolerance admits where the path happens to lie well.)"""
    done = case.done
    a, b = rng.sample([m for m, s in enumerate(done.steps) if len(s) > 60], 2)
    i = rng.randrange(len(done.steps[a]) // 3)
    j = rng.randrange(2 * len(done.steps[b]) // 3, len(done.steps[b]) - 2)
    of_a, of_b = done.steps[a][i : i + 2], done.steps[b][j : j + 2]
    del done.steps[a][i : i + 2], done.steps[b][j : j + 2]
    done.steps[a] = _apart(sorted(done.steps[a] + of_b))
    done.steps[b] = _apart(sorted(done.steps[b] + of_a))


def _apart(steps: list[tuple[int, int]]) -> list[tuple[int, int]]:
    out: list[tuple[int, int]] = []
    for tick, direction in steps:
        out.append((max(tick, out[-1][0] + 200) if out else tick, direction))
    return out


def steps_back_and_forth(case: Case, rng: random.Random) -> None:
    """Harmless to the position, but nobody asked for them."""
    done = case.done
    while True:
        m = _busy(done, rng)
        k = rng.randrange(1, len(done.steps[m]) - 1)
        (before, d), (after, e) = done.steps[m][k], done.steps[m][k + 1]
        if d == e and after - before > 900:
            break
    done.steps[m][k + 1 : k + 1] = [(before + 300, -d), (before + 600, d)]


def motors_exchanged(case: Case, rng: random.Random) -> None:
    a, b = rng.sample(range(3), 2)
    case.done.steps[a], case.done.steps[b] = case.done.steps[b], case.done.steps[a]


def motor_wired_the_other_way(case: Case, rng: random.Random) -> None:
    m = _busy(case.done, rng)
    case.done.steps[m] = [(t, -d) for t, d in case.done.steps[m]]


def last_step_missing(case: Case, rng: random.Random) -> None:
    case.done.steps[_busy(case.done, rng)].pop()


def one_step_more_at_the_end(case: Case, rng: random.Random) -> None:
    steps = case.done.steps[_busy(case.done, rng)]
    steps.append((case.done.duration, rng.choice((1, -1))))
    case.done.duration += 10


def start_off(case: Case, rng: random.Random) -> None:
    case.done.start[rng.randrange(4)] += rng.choice((1, -1, 7))


def start_off_and_made_good(case: Case, rng: random.Random) -> None:
    """The end fits again."""
    m = _busy(case.done, rng)
    direction = case.done.steps[m].pop(0)[1]
    case.done.start[m] += direction


# --- time ---------------------------------------------------------------------------------------------------


def _scaled(case: Case, factor: float) -> None:
    done = case.done
    done.steps = [[(max(1, int(t * factor)), d) for t, d in steps] for steps in done.steps]
    done.events = [(int(t * factor), row, op, arg) for t, row, op, arg in done.events]
    done.duration = int(done.duration * factor) + 1


def everything_faster(case: Case, rng: random.Random) -> None:
    """3 % and more above the feed; less may hide in the ends of the windows."""
    _scaled(case, 1 / rng.uniform(1.2, 3.0))


def acceleration_over_limit(case: Case, rng: random.Random) -> None:
    """A machine with half the acceleration and less: a ramp as long as a window has twice the allowed second
    difference, less 4 steps and two interpolation times."""
    share = rng.uniform(0.1, 0.3)
    case.on = _machine_with(lambda axis: {"max_acceleration": axis.max_acceleration * share})


def velocity_over_limit(case: Case, rng: random.Random) -> None:
    """Below 60 % of the velocity that a motor really has for 20 ms."""
    share = rng.uniform(0.02, 0.05)
    case.on = _machine_with(lambda axis: {"max_velocity": axis.max_velocity * share})


def time_squeezed(case: Case, rng: random.Random) -> None:
    """40 ms of motion in 10 ms: a jump to four times the velocity, or a ramp sixteen times as steep."""
    done, long = case.done, int(0.04 * 16e6)
    begin = rng.choice([t for t, _, _ in done.merged() if t + long < done.duration])

    def squeezed(t: int) -> int:
        return t if t <= begin else begin + (t - begin) // 4 if t < begin + long else t - long * 3 // 4

    done.steps = [[(squeezed(t), d) for t, d in steps] for steps in done.steps]
    done.duration = squeezed(done.duration)


def step_rate_over_limit(case: Case, rng: random.Random) -> None:
    """125 kHz at 16 MHz are 128 ticks; 127 may be rounding."""
    m = _busy(case.done, rng)
    steps = case.done.steps[m]
    k = rng.randrange(1, len(steps))
    steps[k] = (steps[k - 1][0] + rng.randrange(70, 127), steps[k][1])


def pulses_merged(case: Case, rng: random.Random) -> None:
    m = _busy(case.done, rng)
    steps = case.done.steps[m]
    k = rng.randrange(1, len(steps))
    steps[k] = (steps[k - 1][0] + rng.randrange(1, 64), steps[k][1])
    case.on = dataclasses.replace(machine(), controller=Controller(max_step_frequency=None))


def direction_set_up_violated(case: Case, rng: random.Random) -> None:
    """5 us are 80 ticks."""
    turns = [
        (m, k)
        for m, steps in enumerate(case.done.steps)
        for k in range(1, len(steps))
        if steps[k][1] != steps[k - 1][1]
    ]
    m, k = rng.choice(turns)
    steps = case.done.steps[m]
    steps[k] = (steps[k - 1][0] + rng.randrange(64, 80), steps[k][1])
    case.on = dataclasses.replace(machine(), controller=Controller(max_step_frequency=None))


def section_cut_short(case: Case, rng: random.Random) -> None:
    last = max(t for steps in case.done.steps for t, _ in steps)
    case.done.duration = last - rng.randrange(1, last // 2)


# --- events -------------------------------------------------------------------------------------------------


def _event(case: Case, rng: random.Random, before: bool) -> tuple[int, list[int]]:
    """An event with motion before (or after) it, and the ticks of that motion's steps."""
    done = case.done
    ticks = sorted(t for steps in done.steps for t, _ in steps)
    places = []
    for k, (tick, *_) in enumerate(done.events):
        low = done.events[k - 1][0] if k else -1
        high = done.events[k + 1][0] if k + 1 < len(done.events) else done.duration + 1
        near = [t for t in ticks if (low < t <= tick if before else tick < t <= high)]
        if near:
            places.append((k, near))
    return rng.choice(places)


def event_early(case: Case, rng: random.Random) -> None:
    """Before the last step of the motion that comes first."""
    k, ticks = _event(case, rng, before=True)
    _, *rest = case.done.events[k]
    case.done.events[k] = (rng.choice(ticks) - 1, *rest)  # type: ignore[assignment]


def event_late(case: Case, rng: random.Random) -> None:
    """After the first step of the motion that comes later."""
    k, ticks = _event(case, rng, before=False)
    _, *rest = case.done.events[k]
    case.done.events[k] = (rng.choice(ticks), *rest)  # type: ignore[assignment]


def event_missing(case: Case, rng: random.Random) -> None:
    del case.done.events[rng.randrange(len(case.done.events))]


def event_doubled(case: Case, rng: random.Random) -> None:
    k = rng.randrange(len(case.done.events))
    case.done.events.insert(k, case.done.events[k])


def event_changed(case: Case, rng: random.Random) -> None:
    k = rng.randrange(len(case.done.events))
    tick, row, op, arg = case.done.events[k]
    changed = rng.choice(((tick, row, op, (arg[0] + 1, arg[1])), (tick, row, int(Op.COOLANT) + int(op == 12), arg)))
    case.done.events[k] = changed


def events_in_wrong_order(case: Case, rng: random.Random) -> None:
    k = rng.randrange(len(case.done.events) - 1)
    first, second = case.done.events[k : k + 2]
    case.done.events[k : k + 2] = [(first[0], *second[1:]), (second[0], *first[1:])]


def dwell_shortened(case: Case, rng: random.Random) -> None:
    """Everything after it comes 1 to 99 % of the dwell too early (it is 0.05 s, far beyond the row's own ramp)."""
    done = case.done
    tick = next(t for t, _, op, arg in done.events if op == Op.DWELL and arg[0] > 0)
    less = int(0.05 * 16e6 * rng.uniform(0.01, 0.99))
    first = min(t for steps in done.steps for t, _ in steps if t > tick)
    less = max(less, first - tick - int(0.05 * 16e6) + 1)
    done.steps = [[(t - less if t > tick else t, d) for t, d in steps] for steps in done.steps]
    done.events = [(t - less if t > tick else t, *rest) for t, *rest in done.events]  # type: ignore[misc]
    done.duration -= less


# --- path ---------------------------------------------------------------------------------------------------


def _rows_changed(case: Case, rows: list[dict[str, object]]) -> None:
    """Step other rows than the trace has."""
    other = Job(case.job.start, rows, case.job.states)
    case.done = step(other, machine())


def row_skipped(case: Case, rng: random.Random) -> None:
    """A corner of the path that lies many steps off the straight way; a row without length may be left out."""
    rows = list(case.job.rows)
    before = [case.job.start, *(row["to"] for row in rows)]
    corners = [k for k in range(len(rows) - 2) if rows[k]["op"] == Op.ARC or rows[k]["to"] != before[k]]
    del rows[rng.choice(corners)]
    _rows_changed(case, rows)


def rows_in_wrong_order(case: Case, rng: random.Random) -> None:
    rows = list(case.job.rows)
    k = rng.randrange(len(rows) - 3)
    rows[k], rows[k + 1] = rows[k + 1], rows[k]
    _rows_changed(case, rows)


def row_twice_back(case: Case, rng: random.Random) -> None:
    """A row made, taken back and made again."""
    rows = list(case.job.rows)
    k = rng.randrange(1, len(rows) - 2)
    rows[k + 1 : k + 1] = [dict(rows[k], op=Op.TRAVERSE, to=rows[k - 1]["to"], feed=0.0), dict(rows[k])]
    rows[k + 1] = dict(rows[k + 1], plane=0, turns=0)
    _rows_changed(case, rows)


def arc_by_its_chord(case: Case, rng: random.Random) -> None:
    rows = list(case.job.rows)
    k = rng.choice([k for k, row in enumerate(rows) if row["op"] == Op.ARC])
    rows[k] = dict(rows[k], op=Op.FEED)
    _rows_changed(case, rows)


def arc_mirrored(case: Case, rng: random.Random) -> None:
    rows = list(case.job.rows)
    k = rng.choice([k for k, row in enumerate(rows) if row["op"] == Op.ARC])
    rows[k] = dict(rows[k], turns=-rows[k]["turns"])  # type: ignore[operator]
    _rows_changed(case, rows)


def arc_with_another_turn(case: Case, rng: random.Random) -> None:
    """One turn more or, where there are several, one less; the positions at the ends are the same."""
    rows = list(case.job.rows)
    k = rng.choice([k for k, row in enumerate(rows) if row["op"] == Op.ARC])
    turns = int(rows[k]["turns"])  # type: ignore[call-overload]
    sign = 1 if turns > 0 else -1
    rows[k] = dict(rows[k], turns=turns - sign if abs(turns) > 1 and rng.random() < 0.5 else turns + sign)
    _rows_changed(case, rows)


def arc_of_another_radius(case: Case, rng: random.Random) -> None:
    """The centre pushed along the chord's middle line so that the arc bulges 2 steps and more elsewhere."""
    rows = list(case.job.rows)
    halves = [
        k for k, row in enumerate(rows) if row["op"] == Op.ARC and row["plane"] == 1 and rows[k - 1]["to"] != row["to"]
    ]
    k = rng.choice(halves)
    center = list(rows[k]["center"])  # type: ignore[call-overload]
    before = case.job.start if k == 0 else rows[k - 1]["to"]
    to = rows[k]["to"]
    assert isinstance(before, tuple)
    assert isinstance(to, tuple)
    along = (to[0] - before[0], to[1] - before[1])
    push = rng.choice((-0.2, 0.2)) / max(1e-9, (along[0] ** 2 + along[1] ** 2) ** 0.5)
    rows[k] = dict(rows[k], center=(center[0] - along[1] * push, center[1] + along[0] * push, center[2]))
    _rows_changed(case, rows)


def corner_cut(case: Case, rng: random.Random) -> None:
    """The square's corner left out by 4 steps and more of each axis; 1 step would be admitted."""
    rows = list(case.job.rows)
    k = rng.choice((1, 2, 3))
    to, before, after = rows[k]["to"], rows[k - 1]["to"], rows[k + 1]["to"]
    assert isinstance(to, tuple)
    assert isinstance(before, tuple)
    assert isinstance(after, tuple)
    off = rng.uniform(5, 40) / 80

    def towards(other: tuple[float, ...]) -> tuple[float, ...]:
        length = max(abs(b - a) for a, b in zip(to, other, strict=True))
        return tuple(a + (b - a) * off / length for a, b in zip(to, other, strict=True))

    rows[k : k + 1] = [dict(rows[k], to=towards(before)), dict(rows[k], to=towards(after))]
    _rows_changed(case, rows)


def path_shifted(case: Case, rng: random.Random) -> None:
    """All of the path between start and end, 2 steps and more aside."""
    by = rng.uniform(2.1, 9) / 80 * rng.choice((1, -1))
    rows = [dict(row, to=(row["to"][0] + by, *row["to"][1:])) for row in case.job.rows[:-2]]  # type: ignore[index]
    _rows_changed(case, rows + case.job.rows[-2:])


# --- machine ------------------------------------------------------------------------------------------------


def _machine_with(change: Callable[..., dict[str, object]]) -> Machine:
    on = machine()
    return dataclasses.replace(on, axes=tuple(dataclasses.replace(a, **change(a)) for a in on.axes))  # type: ignore[arg-type]


def limit_crossed(case: Case, rng: random.Random) -> None:
    """A limit one step or more inside the travel; within half a step is the limit's own nearest step."""
    done = case.done
    axis = rng.choice([k for k in range(3) if done.steps[k]])
    spu = machine().axes[axis].steps_per_unit
    assert spu is not None
    n, reached = done.start[axis], [done.start[axis]]
    for _, d in done.steps[axis]:
        n += d
        reached.append(n)
    places = [r / float(spu) for r in reached]
    inside = rng.uniform(1.0, 20.0) / abs(float(spu))
    side = rng.choice(("upper", "lower"))
    limit = max(places) - inside if side == "upper" else min(places) + inside
    case.on = _machine_with(lambda a: {side: limit} if a.index == axis else {})


def another_resolution(case: Case, rng: random.Random) -> None:
    axis = rng.choice([k for k in range(4) if case.done.steps[k]])
    factor = rng.choice((2, -1, 1 / 4))
    case.on = _machine_with(
        lambda a: {"steps_per_unit": a.steps_per_unit * int(4 * factor) / 4} if a.index == axis else {}
    )


def another_clock(case: Case, rng: random.Random) -> None:
    board = dataclasses.replace(machine().board, tick_frequency=rng.choice((8_000_000, 20_000_000)))
    case.on = dataclasses.replace(machine(), board=board)


Mutation = Callable[[Case, random.Random], None]
ALL = ("square", "slopes", "arcs", "events")

TABLE: dict[Mutation, tuple[tuple[str, ...], set[str]]] = {
    step_dropped: (ALL, {"GP801", "GP808", "GP807"}),
    step_doubled: (ALL, {"GP801", "GP808", "GP807"}),
    step_reversed: (ALL, {"GP801", "GP808", "GP807"}),
    step_of_another_motor: (ALL, {"GP801", "GP808", "GP807"}),
    steps_moved_in_time: (("slopes", "arcs"), {"GP801", "GP802"}),
    steps_swapped_between_motors: (("slopes", "arcs", "square"), {"GP801", "GP802"}),
    steps_back_and_forth: (ALL, {"GP802"}),
    motors_exchanged: (ALL, {"GP801", "GP802"}),
    motor_wired_the_other_way: (ALL, {"GP801", "GP802"}),
    last_step_missing: (ALL, {"GP808", "GP801", "GP807"}),
    one_step_more_at_the_end: (ALL, {"GP808", "GP801"}),
    start_off: (ALL, {"GP808"}),
    start_off_and_made_good: (ALL, {"GP808"}),
    everything_faster: (("slopes", "arcs"), {"GP805"}),
    acceleration_over_limit: (("slopes", "square"), {"GP806"}),
    velocity_over_limit: (("slopes", "arcs", "square"), {"GP805"}),
    time_squeezed: (("square", "slopes"), {"GP806"}),
    step_rate_over_limit: (ALL, {"GP803"}),
    pulses_merged: (ALL, {"GP804"}),
    direction_set_up_violated: (("slopes", "arcs"), {"GP804"}),
    section_cut_short: (ALL, {"GP808", "GP807"}),
    event_early: (("events",), {"GP807"}),
    event_late: (("events",), {"GP807", "GP801", "GP802"}),
    event_missing: (("events",), {"GP807"}),
    event_doubled: (("events",), {"GP807"}),
    event_changed: (("events",), {"GP807"}),
    events_in_wrong_order: (("events",), {"GP807"}),
    dwell_shortened: (("events",), {"GP807"}),
    row_skipped: (("slopes", "arcs", "square"), {"GP801", "GP802"}),
    rows_in_wrong_order: (("slopes", "arcs", "square"), {"GP801", "GP802"}),
    row_twice_back: (("slopes", "square"), {"GP801", "GP802"}),
    arc_by_its_chord: (("arcs",), {"GP801", "GP802", "GP808"}),
    arc_mirrored: (("arcs",), {"GP801", "GP802"}),
    arc_with_another_turn: (("arcs",), {"GP801", "GP802", "GP808"}),
    arc_of_another_radius: (("arcs",), {"GP801"}),
    corner_cut: (("square",), {"GP801", "GP802"}),
    path_shifted: (("slopes", "square"), {"GP801", "GP802"}),
    limit_crossed: (ALL, {"GP809"}),
    another_resolution: (ALL, {"GP810"}),
    another_clock: (ALL, {"GP810"}),
}
"""The jobs a mutation is meant for, and the codes of which at least one must be among the findings."""
