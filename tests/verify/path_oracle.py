"""What the position check decides, by brute force: every path point, every step, no cleverness.

The path is sampled so finely that neighbours are at most ``FINE`` steps apart; a sample is reachable when it
can be come to without going back and without any sample or step between being more than ``tolerance`` away.
"""

import numpy as np
from verify.reference_stepper import Job, Stepped, motors_of, path_of

from gproof.ir.machine import Machine
from gproof.ir.trace import Op

FINE = 0.02


def samples(job: Job, on: Machine) -> np.ndarray:
    """(n, motors): the path in steps."""
    motors = motors_of(on)
    spu = np.array([float(m.steps_per_unit) for m in motors])
    axes = [m.axis for m in motors]
    place, parts = job.start, [np.array([job.start])[:, axes] * spu]
    for row in job.rows:
        to = row["to"]
        assert isinstance(to, tuple)
        if row["op"] in (Op.TRAVERSE, Op.FEED, Op.ARC, Op.PROBE) and (to != place or row["op"] == Op.ARC):
            at, _, length = path_of(row, place)
            turn = 2 * np.pi if row["op"] == Op.ARC else 1.0
            longest = max(length, *(abs(b - a) for a, b in zip(place, to, strict=True)))
            count = int(np.ceil(longest * turn * np.abs(spu).max() / FINE)) + 1
            shares = np.linspace(0, 1, count)[1:].tolist()
            parts.append(np.array([[at(u, axis) for axis in axes] for u in shares]) * spu)
            place = to
    return np.concatenate(parts)


def follows(path: np.ndarray, done: Stepped, tolerance: float) -> bool:
    """True when the steps follow the sampled path to its end."""
    n = np.array(done.start, dtype=float)
    reach = np.zeros(len(path), dtype=bool)
    reach[0] = True
    first, last = 0, 0  # where reachable samples are

    def flood() -> bool:
        nonlocal first, last
        ahead = 256
        while True:
            part = slice(first, last + ahead)
            near = np.abs(path[part] - n).max(axis=1) <= tolerance
            index = np.arange(len(near))
            blocked = np.maximum.accumulate(np.where(near, -1, index))
            seed = np.maximum.accumulate(np.where(near & reach[part], index, -1))
            now = near & (seed > blocked)
            if not now[-1] or last + ahead >= len(path):
                break
            ahead *= 2
        reach[part] = now
        found = np.flatnonzero(now)
        if not len(found):
            return False
        first, last = first + int(found[0]), first + int(found[-1])
        return True

    if not flood():
        return False
    for _, motor, direction in done.merged():
        n[motor] += direction
        if not flood():
            return False
    return bool(reach[-1])
