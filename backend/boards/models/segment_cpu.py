"""A CPU of Eding CNC, modelled: segments of motion of one length of time, in a FIFO between it and the PC.

What comes from where in the manual (4.01) is in ``FIGURES``. The PC cuts time into segments of InterpolationTime and
keeps the FIFO full of those for which nothing is missing; a segment that is not there when its time comes is an
underrun, and ends motion. The PC does this while the host waits as planned; when the host is held up, the CPU has only
its FIFO. What a segment holds is not public: here the steps due in it, on their ticks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from gproof.backend.boards import run_kernels as rk
from gproof.backend.boards.board import FIFO_CPU, BoardError, BoardState, Capabilities
from gproof.backend.boards.models.model import FIFO_RUNS, ModelBoard, capabilities, drives_of
from gproof.backend.boards.models.pins import PinNames
from gproof.backend.boards.simulated import Halt, HostDelay
from gproof.ir.machine import Machine
from gproof.ir.trace import Op

FIGURES = {
    "segments of InterpolationTime, 0.005 s, at least 0.0025 s": "2.1.6: InterpolationTime and FifoTime",
    "FIFO of FifoTime / InterpolationTime segments, 0.25 s: 50": "2.1.6: InterpolationTime and FifoTime",
    "a FIFO that runs empty is an error": "2.1.6: FIFO underrun error",
    "step frequency of at most 125 kHz, 90 kHz for some drives": "2.1.2: Max Step Frequency",
    "smooth stop: speed ramps down, no position is lost": "2.1.4: ExtErrInputSenseLevel; IO setup, GPIO rules, 2",
    "quick stop: at once, the position may be lost": "IO setup, GPIO rules, 3",
    "E-stop inputs": "2.1.4: EStopInputSenseLevel1 and 2",
    "outputs AUX1 to AUX9, tool and its direction, mist, flood": "3.5: M54, M55; spindle setup",
}
"""Figures of the manual, and its sections that have them."""

INTERPOLATION, LEAST_INTERPOLATION, FIFO = 0.005, 0.0025, 0.25
OUTPUTS = ("TOOL", "TOOL_DIR", "MIST", "FLOOD", *(f"AUX{n}" for n in range(1, 10)))


class SegmentCpu(ModelBoard):
    """See the module's text.

    segment: ticks of one; places: segments in the FIFO; accelerations: steps/s² by motor, None where that is unknown: a
    smooth stop is a quick one then. Inputs: ``estop`` (quick stop), ``error`` (smooth stop).
    """

    def __init__(
        self,
        is_: Capabilities,
        *,
        segment: int,
        places: int,
        accelerations: Sequence[float | None] = (),
        delay: HostDelay | None = None,
        speed: float = 1.0,
    ) -> None:
        least = int(LEAST_INTERPOLATION * is_.tick_frequency)
        if segment < max(1, least) or places < 1:
            raise BoardError(f"segments of {segment} ticks, {places} in the FIFO: at least {least} ticks and 1")
        motors = range(is_.motors)
        names = PinNames(
            step=tuple(f"STEP{m + 1}" for m in motors), direction=tuple(f"DIR{m + 1}" for m in motors), outputs=OUTPUTS
        )
        super().__init__(is_, names, delay=delay, speed=speed)
        self.segment, self.places = segment, places
        self.accelerations = tuple(accelerations) or (None,) * is_.motors
        self._fed = 0
        self._attentive = False

    @classmethod
    def for_machine(cls, machine: Machine, motors: int, *, real_time: bool = False) -> SegmentCpu:
        """A CPU with the times and motors of a machine file."""
        frequency, controller = machine.board.tick_frequency, machine.controller
        segment = max(controller.interpolation_time, LEAST_INTERPOLATION)
        known = [
            None if drive is None or drive.max_acceleration is None or drive.steps_per_unit is None
            else float(drive.max_acceleration * abs(drive.steps_per_unit))
            for drive in drives_of(machine, motors)
        ]  # fmt: skip
        return cls(
            capabilities(machine, FIFO_CPU, motors, fifo_runs=FIFO_RUNS, real_time=real_time),
            segment=round(segment * frequency), places=max(1, round(controller.fifo_time / segment)),
            accelerations=known,
        )  # fmt: skip

    def start_section(self, number: int, start: tuple[int, ...], lead: int) -> int:
        """See Board."""
        self._fed = base = super().start_section(number, start, lead)
        return base

    # The FIFO.

    def _attended(self, until: int) -> None:
        self._attentive = True
        try:
            super()._attended(until)
        finally:
            self._attentive = False

    def _run(self, until: int) -> None:
        self._feed(self._now)
        super()._run(until)
        if self._attentive:
            self._feed(self._now)

    def _complete(self) -> int:
        """The tick up to which segments are complete; where nothing is missing, with that of the last step or event."""
        if self._horizon is not None:
            return self._base + (self._horizon - self._base) // self.segment * self.segment
        return self._base + -(-(self._last_due() - self._base) // self.segment) * self.segment

    def _last_due(self) -> int:
        events = [self._events[-1][0].tick] if self._events else []
        return max([int(self._state[:, rk.TAIL].max()), *events])

    def _feed(self, now: int) -> None:
        """Fill the FIFO: behind the segment that is being made there are ``places`` more."""
        if self._board_state is BoardState.RUNNING:
            last = self._base + ((now - self._base) // self.segment + 1 + self.places) * self.segment
            self._fed = max(self._fed, min(last, self._complete()))

    def _halts(self, until: int) -> list[Halt]:
        found = super()._halts(until)
        fed = self._complete() if self._attentive else self._fed
        if self._horizon is not None or fed < self._last_due():
            found.append(Halt(fed, fed + 1, self._underrun))
        return found

    def _underrun(self) -> None:
        tick = self._now - self._base
        if self._moving(self.segment):
            self._lose()
        self._stop(BoardState.UNDERRUN, f"FIFO underrun: no segment after tick {tick}")

    # Outputs and stops.

    def _switched(self, op: Op, first: float, second: float) -> list[tuple[str, bool]]:
        if op is Op.SPINDLE:
            return [("TOOL", first != 0), ("TOOL_DIR", first < 0)]
        if op is Op.COOLANT:
            return [("MIST", bool(first)), ("FLOOD", bool(second))]
        return [(f"AUX{first:g}", bool(second))] if op is Op.OUTPUT else []

    def _input(self, name: str) -> Callable[[], None]:
        if name == "estop":
            return lambda: self._quick_stop("E-stop input")
        if name == "error":
            return self._smooth_stop
        return super()._input(name)

    def emergency_stop(self) -> None:
        """A quick stop: at once, and the position is lost where a motor moves."""
        self._pass_time()
        if not self._board_state.over:
            self._quick_stop("emergency stop")

    def _quick_stop(self, why: str) -> None:
        if self._moving(self.segment):
            self._lose()
        self._stop(BoardState.STOPPED, why)

    def _smooth_stop(self) -> None:
        """Slow down along the path, no motor faster than its acceleration; a quick stop where that is not possible."""
        span = self._ramp()
        if span is None or span > self._path_known():
            self._quick_stop("external error, too little motion known to slow down")
        else:
            self._run_out(span, BoardState.STOPPED, "external error, smooth stop")

    def _ramp(self) -> int | None:
        """Ticks of the path's time until all motors have slowed down; None where an acceleration is unknown.

        Slowing from full speed in T seconds changes a motor's speed v by v/T a second: T is v/a of the one that needs
        most, at the highest speeds of what is stored.
        """
        seconds = 0.0
        for (runs, _), acceleration in zip(self._rest(), self.accelerations, strict=True):
            if not len(runs):
                continue
            if not acceleration:
                return None
            first, count, add = runs["interval"].copy(), runs["count"], runs["add"]
            least = int(first.min() if not add.any() else min(int(first.min()), int((first + add * (count - 1)).min())))
            seconds = max(seconds, self._is.tick_frequency / max(1, least) / acceleration)
        return int(seconds * self._is.tick_frequency / 2)
