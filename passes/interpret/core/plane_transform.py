"""Rotation (G68) and scaling (G51) of X and Y about one point, between program and machine coordinates.

machine = offset + center + M (program - center), M = rotation x factors: the offset itself is neither rotated nor
scaled, so what an unknown offset does to a position is what it did without a transform. The point is given in
program coordinates (Eding CNC manual 3.4.13, 3.4.18: "in current coordinate system"), its place on the machine
therefore follows the offsets that were in force when it was given: ``origin``.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir.dialects.accepts import SCALED_Z, UNSCALED_Z
from gproof.ir.record import field, record
from gproof.ir.symbolic import NOWHERE, Position, Unknown, Value
from gproof.passes.interpret.core import line_kernels as k

if TYPE_CHECKING:
    from gproof.ir.machine import Machine
    from gproof.passes.interpret.core.modal_state import Modal
    from gproof.passes.interpret.core.run import Run

Pair = tuple[float, float]
_QUARTERS = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}


def cos_sin(angle: float) -> Pair:
    """Cosine and sine of degrees, exact for quarter turns."""
    turn = math.fmod(angle, 360.0)
    exact = _QUARTERS.get(turn + 360.0 if turn < 0 else turn)
    return exact if exact is not None else (math.cos(math.radians(turn)), math.sin(math.radians(turn)))


@record(frozen=True, slots=True, kw_only=True)
class Transform:
    """What is in force of G68 and G51.

    rotated, scaled: whether each is on; angle: degrees, counter-clockwise; factors: of X and Y; center: mm in
    program coordinates; origin: offsets of X and Y under which the center was given; open: why it is not known what
    the axes do now, "" when it is known; doubt: why it will not be as soon as X or Y move; uniform: P of ``G51 P``, NaN
    where it is not known; tall: whether that scales Z as well, None: 3.4.13 names no axes, and it is not stated.

    Made of these: loose, columns of axes other than X and Y that count by ``uniform`` or as they are, which is not
    known (the rotary ones among them: 3.4.13 has nothing of these either); upright: the factor of Z where it is known.
    """

    rotated: bool = False
    scaled: bool = False
    angle: float = 0.0
    factors: Pair = (1.0, 1.0)
    center: Pair = (0.0, 0.0)
    origin: tuple[Position, Position] = (Position(0.0), Position(0.0))
    open: str = ""
    doubt: str = ""
    uniform: float = 1.0
    tall: bool | None = None

    kind: int = field(init=False, repr=False, compare=False)
    on: bool = field(init=False, repr=False, compare=False)
    numbers: tuple[float, ...] = field(init=False, repr=False, compare=False)
    loose: tuple[int, ...] = field(init=False, repr=False, compare=False)
    upright: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        cosine, sine = cos_sin(self.angle)
        fx, fy = self.factors
        matrix = (cosine * fx, -sine * fy, sine * fx, cosine * fy)
        inverse = (cosine / fx, sine / fx, -sine / fy, cosine / fy)
        radius = abs(fx) if fx == fy else 0.0
        kind = k.TURN_SWAPPED if cosine == 0.0 else k.TURN_MIXED
        if sine == 0.0:
            kind = k.TURN_NONE if cosine == 1.0 and self.factors == (1.0, 1.0) else k.TURN_SEPARATE
        object.__setattr__(self, "kind", kind)
        object.__setattr__(self, "on", bool(self.open) or kind != k.TURN_NONE)
        object.__setattr__(self, "numbers", (*self.center, *matrix, *inverse, radius))
        settled = self.tall is False or (self.tall is True and math.isfinite(self.uniform))
        loose = () if self.uniform == 1.0 else (3, 4, 5) if settled else (2, 3, 4, 5)
        object.__setattr__(self, "loose", loose)
        object.__setattr__(self, "upright", self.uniform if self.tall is True and settled else 1.0)

    @property
    def arc_tolerance(self) -> float:
        """Factor of what the radii of an arc may differ: the stricter of before and after scaling."""
        return min(1.0, *(abs(factor) for factor in self.factors))

    def acts(self, axis: int) -> tuple[int, ...]:
        """Which program axes decide where machine axis X (0) or Y (1) goes."""
        if self.kind == k.TURN_SWAPPED:
            return (1 - axis,)
        return (0, 1) if self.kind == k.TURN_MIXED else (axis,)

    def program(
        self, position: tuple[Position, Position], offset: tuple[Position, Position]
    ) -> tuple[Position, Position]:
        """Program coordinates of a place, mm; NOWHERE where they depend on something unknown."""
        if self.kind == k.TURN_NONE and not self.open:
            return position[0].minus(offset[0]), position[1].minus(offset[1])
        if self.open or self.origin != offset:
            return NOWHERE, NOWHERE
        away = [p.minus(o) for p, o in zip(position, offset, strict=True)]
        found = k.program_xy(
            position[0].value, position[1].value, offset[0].value, offset[1].value, self.kind, self.numbers, 0
        )
        # The inverse mixes as the matrix does: a quarter turn swaps, a half turn does not.
        return tuple(  # type: ignore[return-value]
            NOWHERE if any(away[j].form for j in self.acts(axis)) else Position(found[axis]) for axis in (0, 1)
        )

    def absolute(
        self, words: tuple[Value | None, Value | None], position: tuple[Position, Position],
        offset: tuple[Position, Position],
    ) -> tuple[Position, Position]:  # fmt: skip
        """Where X and Y words in mm send the axes; None: a word left out, its program coordinate stays."""
        if self.open or self.origin != offset:
            return NOWHERE, NOWHERE
        given = sum(bit for bit, word in zip((1, 2), words, strict=True) if word is not None)
        x, y = (0.0 if word is None or isinstance(word, Unknown) else word for word in words)
        at = k.place_xy(
            given, x, y, position[0].value, position[1].value, offset[0].value, offset[1].value, self.kind,
            self.numbers, 0,
        )  # fmt: skip
        now = self.program(position, offset)
        out = []
        for axis in (0, 1):
            by = self.acts(axis)
            if all(words[j] is None for j in by):
                out.append(position[axis])
            elif any(isinstance(words[j], Unknown) or (words[j] is None and now[j].form) for j in by):
                out.append(NOWHERE)
            else:
                out.append(Position(at[axis], offset[axis].form))
        return out[0], out[1]

    def incremental(
        self, words: tuple[Value | None, Value | None], position: tuple[Position, Position]
    ) -> tuple[Position, Position]:
        """Where increments in mm send the axes."""
        if self.open:
            return NOWHERE, NOWHERE
        x, y = (0.0 if word is None or isinstance(word, Unknown) else word for word in words)
        steps = self.step(x, y)
        unknown = [axis for axis in (0, 1) if any(isinstance(words[j], Unknown) for j in self.acts(axis))]
        return tuple(  # type: ignore[return-value]
            NOWHERE if axis in unknown else position[axis].moved(steps[axis]) for axis in (0, 1)
        )

    def step(self, x: float, y: float) -> Pair:
        """A distance of the program as one of the machine, mm."""
        return k.step_xy(x, y, self.numbers, 0)


NO_TRANSFORM = Transform()


def at_start(modal: Modal) -> Transform:
    """What the setup states to be in force when the job starts."""
    stated = modal.setup.transform
    if stated is None:
        return NO_TRANSFORM
    modal.stated |= {"rotation"} if stated.angle is not None else set()
    modal.stated |= {"scaling"} if stated.factor_x is not None else set()
    angle = math.fmod(stated.angle or 0.0, 360.0)
    factors = (stated.factor_x or 1.0, stated.factor_y or 1.0)
    if angle == 0.0 and factors == (1.0, 1.0):
        return NO_TRANSFORM
    origin, doubt = (modal.offset(0), modal.offset(1)), ""
    uniform = factors[0] if factors[0] == factors[1] else 1.0
    if modal.machine.controller.diameter_programming:
        origin, doubt = (NOWHERE, NOWHERE), "the effect of the setup's rotation or scaling on diameters"
    return Transform(
        rotated=angle != 0.0, scaled=factors != (1.0, 1.0), angle=angle, factors=factors,
        center=(stated.x, stated.y), origin=origin, doubt=doubt, uniform=uniform,
        # Equal factors may be those of X and Y, which leave Z as it is on every controller.
        tall=is_tall(modal.machine) and None,
    )  # fmt: skip


def is_tall(machine: Machine) -> bool | None:
    """Whether ``G51 P`` scales Z, as the shop states it; None: nobody did."""
    accepts = machine.controller.accepts
    return True if SCALED_Z.name in accepts else False if UNSCALED_Z.name in accepts else None


def noted(run: Run) -> bool:
    """Whether Z is as it is written, and nothing has to be said of that any more."""
    now = run.modal.transform
    return now.uniform == 1.0 or (now.tall is False and UNSCALED_Z.assumption in run.assumed)
