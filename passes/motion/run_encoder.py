"""A motor's steps on their way to runs: buffers of bounded size, and the steps that take up backlash.

``Encoder`` takes steps as they come and covers them with runs; ``BacklashEncoder`` puts those between them that the
motor of an axis with backlash makes where it turns round. Times are ticks of one section; docs/stream.md has the rules.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gproof.ir.columns import Columns, concatenate
from gproof.ir.machine import Drive
from gproof.ir.stream import RUN
from gproof.passes.geometry.backlash import backlash_steps, take_up_rates
from gproof.passes.motion import run_kernels as r
from gproof.passes.motion import step_kernels as k

Ints = npt.NDArray[np.int64]

BUFFER = 1 << 19
"""Steps of a motor that wait to become runs."""

ANY = 1 << 62


class Spacing(NamedTuple):
    """Ticks: least between two steps, and across a change of direction; how far compression may move a step."""

    near: int
    turn: int
    tolerance: int


class Loops(NamedTuple):
    """The kernels of one section, at the speed that suits its number of steps."""

    step_times: Callable[..., tuple[int, int]]
    take_up: Callable[..., tuple[int, int]]
    bounds: Callable[..., None]
    compress: Callable[..., tuple[int, int]]

    @classmethod
    def pick(cls, steps: float) -> Loops:
        """For about so many steps."""
        return cls(k.step_times.pick(steps), k.take_up.pick(steps), r.bounds.pick(steps), r.compress.pick(steps))


PLAIN = Loops(k.step_times, k.take_up, r.bounds, r.compress)


class Buffer:
    """Steps that wait: ``ticks[:count]``, ``signs[:count]``; state: S_* of ``step_kernels``."""

    def __init__(self, size: int) -> None:
        self.count = 0
        self.state = np.zeros(k.STATE_WIDTH, dtype=np.int64)
        self.ticks: Ints = np.empty(size, dtype=np.int64)
        self.signs: npt.NDArray[np.int8] = np.empty(size, dtype=np.int8)

    def grow(self, size: int) -> None:
        """Room for ``size`` steps."""
        ticks, signs = np.empty(size, dtype=np.int64), np.empty(size, dtype=np.int8)
        ticks[: self.count] = self.ticks[: self.count]
        signs[: self.count] = self.signs[: self.count]
        self.ticks, self.signs = ticks, signs

    def drop(self, done: int) -> None:
        """Forget the first ``done`` steps."""
        if done:
            self.state[k.S_OLD_TICK] = self.ticks[done - 1]
            self.state[k.S_OLD_SIGN] = self.signs[done - 1]
        rest = self.count - done
        self.ticks[:rest] = self.ticks[done : self.count].copy()
        self.signs[:rest] = self.signs[done : self.count].copy()
        self.count = rest

    def late(self, spacing: Spacing) -> bool:
        """True when steps had to give way by more than what rounding and starts from rest explain."""
        return bool(self.state[k.S_NESTED] or self.state[k.S_LATE] > 4 * spacing.turn + spacing.tolerance)


class Encoder:
    """Steps of one motor into runs. ``steps`` is filled by ``step_times`` and emptied by ``flush``."""

    def __init__(self, spacing: Spacing, size: int) -> None:
        self.spacing = spacing
        self.steps = Buffer(size)
        self.loops = PLAIN
        self._encoder = np.zeros(r.ENCODER_WIDTH, dtype=np.int64)
        self._tables: list[Columns] = []
        self._allocate()

    def _allocate(self) -> None:
        size = len(self.steps.ticks)
        self._low, self._high = np.empty(size, dtype=np.int64), np.empty(size, dtype=np.int64)
        self._runs = np.empty((min(size, 1 << 16), 4), dtype=np.int64)

    @property
    def last(self) -> int:
        """The tick of the motor's last step."""
        return int(self.steps.state[k.S_TICK])

    @property
    def late(self) -> bool:
        """True when steps had to give way by more than the rules explain."""
        return self.steps.late(self.spacing)

    def begin(self, floor: int) -> None:
        """Nothing comes before tick ``floor`` from here on."""
        self.steps.state[k.S_FLOOR] = floor

    def make_room(self, floor: int) -> None:
        """Some steps into runs, or a larger buffer."""
        waiting = self.steps.count
        self._encode(floor, ANY, final=False)
        if self.steps.count == waiting:
            self.steps.grow(2 * len(self.steps.ticks))
            self._allocate()

    def flush(self, floor: int, ceiling: int) -> None:
        """All steps into runs, none of them before ``floor`` or after ``ceiling`` unless it is there already."""
        self._encode(floor, ceiling, final=True)

    def rest(self, now: int) -> None:
        """The section ends, not before tick ``now``."""

    def _encode(self, floor: int, ceiling: int, *, final: bool) -> None:
        """Steps of the buffer into runs: all of them, or those that no further step can matter to."""
        steps, (near, turn, tolerance), done, filled = self.steps, self.spacing, 0, 0
        if not steps.count:
            return
        self.loops.bounds(
            steps.ticks, steps.signs, steps.count, int(steps.state[k.S_OLD_TICK]), tolerance, near, turn, floor,
            ceiling, self._low, self._high,
        )  # fmt: skip
        while done < steps.count:
            covered, filled = self.loops.compress(
                steps.ticks[done:], steps.signs[done:], self._low[done:], self._high[done:], steps.count - done, final,
                near, turn, self._encoder, self._runs, 0,
            )  # fmt: skip
            self._keep(filled)
            done += covered
            if filled < len(self._runs):
                break
        steps.drop(done)
        if final:
            # What comes next keeps its distance from the last step as it was encoded.
            steps.state[k.S_TICK] = steps.state[k.S_OLD_TICK] = self._encoder[r.E_TICK]

    def _keep(self, filled: int) -> None:
        if filled:
            part = self._runs[:filled]
            arrays = {c.name: part[:, at].astype(c.dtype) for at, c in enumerate(RUN.columns)}
            self._tables.append(Columns(RUN, arrays))

    def columns(self) -> Columns:
        """The motor's runs."""
        return concatenate(RUN, self._tables)


class BacklashEncoder(Encoder):
    """Steps of an axis into runs of a motor that takes up its backlash.

    ``steps`` is what the axis needs; the motor's own steps wait in a buffer of their own. Where a section starts
    and ends, the motor is as it does when its axis came from below.
    """

    def __init__(self, spacing: Spacing, size: int, drive: Drive, start: int, tick_frequency: int) -> None:
        assert drive.steps_per_unit is not None
        self.amount = backlash_steps(drive)
        super().__init__(spacing, size + 8 * self.amount + 64)
        self._axis, self._up = Buffer(size), 1 if drive.steps_per_unit > 0 else -1
        rate = abs(float(drive.steps_per_unit))
        velocity, acceleration = take_up_rates(drive)
        self._fastest = velocity * rate / tick_frequency
        self._acceleration = acceleration * rate / tick_frequency**2
        self._way = np.zeros(k.BACKLASH_WIDTH)
        self._way[[k.B_AXIS, k.B_COUNT, k.B_MOTOR]] = start
        # ``step_times`` fills the buffer of the axis, ``_encode`` empties that of the motor.
        self._motor, self.steps = self.steps, self._axis

    @property
    def last(self) -> int:
        """The tick of the motor's last step."""
        return int(self._motor.state[k.S_TICK])

    @property
    def late(self) -> bool:
        """Of the axis or of the motor."""
        return self._axis.late(self.spacing) or self._motor.late(self.spacing)

    def begin(self, floor: int) -> None:
        """Nothing comes before tick ``floor`` from here on."""
        self._axis.state[k.S_FLOOR] = self._motor.state[k.S_FLOOR] = floor

    def make_room(self, floor: int) -> None:
        """Some steps into runs, or a larger buffer."""
        # The last step may still be left out with the one that undoes it.
        if self._axis.count <= 1:
            self._axis.grow(2 * len(self._axis.ticks))
        else:
            self._take_up(self._axis.count - 1, floor)

    def flush(self, floor: int, ceiling: int) -> None:
        """All steps into runs, backlash taken up: the axis rests."""
        self._take_up(self._axis.count, floor)
        self._rest(0)
        self._write(floor, ceiling, final=True)

    def rest(self, now: int) -> None:
        """The motor goes where it is when its axis came from below."""
        self._way[k.B_GOAL] = 0.0
        self._motor.state[k.S_FLOOR] = 0
        self._rest(max(now, self.last + self.spacing.turn))
        self._write(0, ANY, final=True)

    def _take_up(self, many: int, floor: int) -> None:
        done = 0
        while done < many:
            motor, (near, turn, _) = self._motor, self.spacing
            before = done
            done, motor.count = self.loops.take_up(
                self._axis.ticks, self._axis.signs, done, many, self.amount, self._up, self._fastest,
                self._acceleration, near, turn, self._way, motor.state, motor.ticks, motor.signs, motor.count,
            )  # fmt: skip
            if done < many:
                self._write(floor, ANY, final=False)
                if done == before:
                    motor.grow(2 * len(motor.ticks))
        self._axis.drop(many)

    def _rest(self, begin: int) -> None:
        motor, (near, turn, _) = self._motor, self.spacing
        if len(motor.ticks) - motor.count < 4 * self.amount + 16:
            motor.grow(2 * len(motor.ticks))
        motor.count = k.take_up_rest(
            begin, self._fastest, self._acceleration, near, turn, self._way, motor.state, motor.ticks, motor.signs,
            motor.count,
        )  # fmt: skip

    def _write(self, floor: int, ceiling: int, *, final: bool) -> None:
        axis, self.steps = self.steps, self._motor
        if len(self._low) < len(self.steps.ticks):
            self._allocate()
        self._encode(floor, ceiling, final=final)
        self.steps = axis
