"""Small jobs for the stream checker's tests, and random ones."""

import math
import random

from verify.reference_stepper import Job

from gproof.ir.trace import Op


def square() -> Job:
    return Job().rapid(x=3, y=2).line(x=8).line(y=7).line(x=3).line(y=2).rapid(x=0, y=0).add(Op.END)


def slopes() -> Job:
    """Diagonals of many slopes, all axes moving, and a retraced line."""
    job = Job((1.0, -2.0, 0.5, 10.0, 0.0, 0.0))
    for k in range(7):
        job.line(x=1.0 + 0.71 * k, y=-2.0 + 0.13 * k * k, z=0.5 - 0.11 * k, a=10.0 + 9 * math.sin(k))
    return job.line(x=0.3, y=0.4).line(x=4.1, y=1.7).line(x=0.3, y=0.4).rapid(z=2)


def arcs() -> Job:
    """Quarter, half, full and several turns, both ways, in all planes, helices, a small spiral."""
    job = Job((5.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    job.arc((3.0, 0.0), 1, x=3, y=2).arc((3.0, 0.0), -1, x=1, y=0).arc((1.5, 0.0), 1, x=1, y=0)
    job.arc((2.0, 0.0), -3, x=3, y=0, z=-1, a=20.0)
    job.arc((1.0, 0.0), 2, plane=2, z=0.0, x=3 - 4e-4).arc((1.0, 0.5), -1, plane=3, y=0.0, z=0.0)
    return job.line(x=0, y=0, z=0, a=0)


def tiny_rows() -> Job:
    """A curve of rows shorter than a step, duplicate rows, and rows that go back and forth within a step."""
    job = Job()
    for k in range(400):
        job.line(x=0.004 * k, y=0.2 * math.sin(k / 60), feed=3000)
        if k % 50 == 0:
            job.line(feed=3000).line(y=job.here[1] + 0.004).line(y=job.here[1] - 0.004)
    return job.rapid(x=0, y=0)


def events() -> Job:
    """Events of several kinds between, before and after motion."""
    job = Job().event(Op.SPINDLE, 1.0, 8000.0).event(Op.COOLANT, 0.0, 1.0).rapid(x=2, y=1)
    job.event(Op.DWELL, 0.05).line(z=-1, feed=600).event(Op.OUTPUT, 3.0, 1.0).line(x=4, y=2.2).event(Op.DWELL, 0.0)
    job.event(Op.SETPOINT, 2.0, 0.25).line(x=4.1).line(x=4)
    job.add(Op.PLANE, arg=(1.0, 0.0)).arc((4.0, 1.2), -1, x=5, y=1.2).event(Op.SPINDLE, 0.0, 0.0).rapid(z=0)
    return job.event(Op.STOP, 0.0)


JOBS = {"square": square, "slopes": slopes, "arcs": arcs, "tiny_rows": tiny_rows, "events": events}


def random_job(seed: int, rows: int = 12, size: float = 3.0) -> Job:
    """Lines, rapids and arcs; some rows tiny, some on a coarse grid so that ties and retraced paths happen."""
    rng = random.Random(seed)
    job = Job((*(round(rng.uniform(-1, 1), rng.choice((0, 1, 3))) for _ in range(4)), 0.0, 0.0))
    for _ in range(rows):
        digits = rng.choice((0, 1, 3, 12))
        near = rng.choice((1.0, 1.0, 0.02))
        here = job.here
        kind = rng.random()
        to = [round(h + near * rng.uniform(-size, size) / 2, digits) for h in here[:3]]
        if kind < 0.35:
            plane = rng.choice((1, 2, 3))
            first, second = {1: (0, 1), 2: (2, 0), 3: (1, 2)}[plane]
            radius, angle = near * rng.uniform(0.05, size / 3), rng.uniform(-math.pi, math.pi)
            if rng.random() < 0.3:
                angle = rng.choice((0.0, math.pi / 2, math.pi, -math.pi / 2))
            center = (here[first] + radius * math.cos(angle), here[second] + radius * math.sin(angle))
            out = rng.uniform(-math.pi, math.pi)
            to[first], to[second] = center[0] + radius * math.cos(out), center[1] + radius * math.sin(out)
            if rng.random() < 0.25:
                to[first], to[second] = here[first], here[second]
            if rng.random() < 0.6:
                third = 3 - first - second
                to[third] = here[third]
            turns = rng.choice((1, -1, 1, -1, 2, -2))
            job.arc(center, turns, plane, feed=rng.uniform(200, 4000), **dict(zip("xyz", to, strict=True)))
            continue
        axes = {name: value for name, value in zip("xyz", to, strict=True) if rng.random() < 0.7}
        if rng.random() < 0.3:
            axes["a"] = round(here[3] + rng.uniform(-20, 20), digits)
        if kind < 0.45:
            job.rapid(**axes)
        else:
            job.line(feed=rng.uniform(200, 6000), **axes)
    return job
