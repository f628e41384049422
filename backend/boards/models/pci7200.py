"""The PCI-7200 timer card of WinCNC, modelled: one image of all outputs, written at interrupts of its timer.

What comes from where in the WinCNC manual is in ``FIGURES``. Each step comes with the first count of the timer
at or after its tick; the steps of one count are one image. A stop by the ESC key or a limit switch runs on for a
cushion of steps. How the timer is programmed is not public: an interrupt for each change is the model's choice, and the
manual promises a microsecond.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

from gproof.backend.boards.board import PCI7200, BoardError, BoardState, Capabilities
from gproof.backend.boards.models.model import FIFO_RUNS, ModelBoard, capabilities
from gproof.backend.boards.models.pins import PinNames
from gproof.backend.boards.simulated import HostDelay
from gproof.backend.runs import done_by, step_tick
from gproof.ir.machine import Machine
from gproof.ir.record import record
from gproof.ir.trace import Op

FIGURES = {
    "six step outputs at 75 kHz, accurate to a microsecond": "introduction",
    "step and direction bits of port 0, each 0 to 5": "System Configuration: axisspec=, S D",
    "a step is the falling edge of its pin, with E1 the rising one": "System Configuration: axisspec=, E",
    "direction of the motor, 0 or 1, usually 1": "System Configuration: axisspec=, O",
    "pulses of 5 µs, direction set 5 µs before a step": "System Configuration: steppulse=",
    "30,000 steps a second, 50,000 are safe": "System Configuration: maxstepv=",
    "two channels A and B instead of step and direction, on all pins": "System Configuration: quadmode=",
    "steps after the ESC key, 200 suggested": "System Configuration: esc_step=",
    "steps after a limit switch": "System Configuration: lim_step=",
    "outputs 1 to 32": "System Configuration: auxout=, C",
    "clock of 4 MHz": "System Configuration: keyfact=",
}
"""Figures of the manual, and its settings and sections that have them."""

TIMER = 4_000_000
"""Hz of the card's clock."""
STEP_OUTPUTS = 6
AUXILIARY = 32


@record(frozen=True, slots=True, kw_only=True)
class AxisSpec:
    """Letters of axisspec= of one motor. step, direction: bits of port 0; forward: the direction pin's level where the
    motor counts up (O); rising: a step is the rising edge (E1)."""

    step: int
    direction: int
    forward: int = 1
    rising: bool = False


def pin_names(specs: Sequence[AxisSpec], quadrature: bool = False) -> PinNames:
    """Names of the pins; ValueError for a bit that the port does not have, or has twice. Channels have no edge (E)."""
    for what, bits in (("step", [s.step for s in specs]), ("direction", [s.direction for s in specs])):
        if len(set(bits)) != len(bits) or not all(0 <= bit < STEP_OUTPUTS for bit in bits):
            raise BoardError(f"{what} bits {bits}: port 0 has one of each number from 0 to {STEP_OUTPUTS - 1}")
    step, direction = tuple(f"P0S{s.step}" for s in specs), tuple(f"P0D{s.direction}" for s in specs)
    low = {name for name, s in zip(step, specs, strict=True) if not (s.rising or quadrature)}
    low |= {name for name, s in zip(direction, specs, strict=True) if not s.forward}
    outputs = tuple(f"AUX{n}" for n in range(1, AUXILIARY + 1))
    return PinNames(step=step, direction=direction, outputs=outputs, low=frozenset(low))


class Pci7200(ModelBoard):
    """See the module's text.

    specs: by motor; quadrature: quadmode=1; esc_step, lim_step: steps of the cushions, of the motor that makes most.
    Inputs: ``esc``, ``limit``.
    """

    def __init__(
        self,
        is_: Capabilities,
        specs: Sequence[AxisSpec] | None = None,
        *,
        quadrature: bool = False,
        esc_step: int = 0,
        lim_step: int = 0,
        delay: HostDelay | None = None,
        speed: float = 1.0,
    ) -> None:
        if is_.motors > STEP_OUTPUTS:
            raise BoardError(f"{is_.motors} motors, the card has {STEP_OUTPUTS} step outputs")
        specs = specs or [AxisSpec(step=m, direction=m) for m in range(is_.motors)]
        grid = max(1, -(-is_.tick_frequency // TIMER))
        super().__init__(is_, pin_names(specs, quadrature), grid=grid, quadrature=quadrature, delay=delay, speed=speed)
        self.esc_step, self.lim_step = esc_step, lim_step

    @classmethod
    def for_machine(cls, machine: Machine, motors: int, *, real_time: bool = False) -> Pci7200:
        """A board with the pulses of a machine file, and the cushions that a WINCNC.INI has."""
        stated = {name.rstrip("=").lower(): text for name, text in machine.kept}
        return cls(
            capabilities(machine, PCI7200, motors, fifo_runs=FIFO_RUNS, real_time=real_time),
            quadrature=_whole(stated, "quadmode") == 1,
            esc_step=_whole(stated, "esc_step"), lim_step=_whole(stated, "lim_step"),
        )  # fmt: skip

    def _switched(self, op: Op, first: float, second: float) -> list[tuple[str, bool]]:
        return [(f"AUX{first:g}", bool(second))] if op is Op.OUTPUT else []

    def emergency_stop(self) -> None:
        """As the ESC key: motion ends after its cushion of steps."""
        self._pass_time()
        if not self._board_state.over:
            self._run(self._up_to_count())
        if not self._board_state.over:
            self._run_out(self._cushion(self.esc_step), BoardState.STOPPED, "emergency stop")

    def _input(self, name: str) -> Callable[[], None]:
        if name == "esc":
            return lambda: self._run_out(self._cushion(self.esc_step), BoardState.STOPPED, "ESC key")
        if name == "limit":
            return lambda: self._run_out(self._cushion(self.lim_step), BoardState.FAULT, "limit switch")
        return super()._input(name)

    def _stop(self, state: BoardState, reason: str) -> None:
        # An interrupt that is under way writes its image.
        if self._board_state is BoardState.RUNNING:
            self._execute(self._up_to_count())
            self._now = self._up_to_count()
        super()._stop(state, reason)

    def _up_to_count(self) -> int:
        return -(-self._now // self._grid) * self._grid

    def _cushion(self, steps: int) -> int:
        """Ticks of the path in which no motor makes more than so many steps."""
        if steps <= 0:
            return 0
        ends, last = [], 0
        for runs, counts_from in self._rest():
            due = done_by(runs, self._now + self._path_known() - counts_from)
            if due.steps >= steps:
                ends.append(counts_from + step_tick(runs, steps) - self._now)
            elif due.steps:
                last = max(last, counts_from + due.last - self._now)
        return min(ends, default=last)


def _whole(stated: dict[str, str], name: str) -> int:
    """A whole number of the INI; 0 where it is not there."""
    try:
        return max(0, int(Fraction(stated.get(name, "0").strip() or "0")))
    except (ValueError, ZeroDivisionError):
        return 0
