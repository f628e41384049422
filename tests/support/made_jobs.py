"""Random jobs of each controller together with the path that their words mean, by formulas of this file alone.

Nothing here comes from gproof; positions are millimetres of the machine. Eding: `support.paths`, and G68 and G51
(manual 3.4.13, 3.4.18). McuWIN: manual 3.1 to 3.4, 3.18, 3.19, 3.26. WinCNC: G0 to G3, G22, G90 to G92.
"""

from __future__ import annotations

import cmath
import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt
from support.paths import Offsets, RandomPath

from gproof.driver.session import Session, open_session

Points = npt.NDArray[np.float64]
LENGTH = 17.25
SUFFIXES = {"eding": "cnc", "wincnc": "tap", "mcuwin": "src"}


@dataclass
class Move:
    """One move of the machine, mm. at: of t in 0 ... 1, (n,), to (n, 3); free: only its ends are certain."""

    at: Callable[[Points], Points]
    free: bool = False
    length: float = 0.0
    """By which the tip is below; 0 where the job uses no length."""
    arc: tuple[complex, complex, float] | None = None
    """Centre and start in the plane of X and Y, and the turn, radians; None: a line, or one of `support.paths`."""

    @property
    def ends(self) -> Points:
        return self.at(np.array([0.0, 1.0]))


@dataclass
class Made:
    """A job and what it means. zeros: of the systems that zones count from, when the job begins."""

    dialect: str
    program: str
    setup: str
    machine: str
    moves: list[Move]
    zeros: dict[int, list[float]]
    records: list[list[float]] = field(default_factory=list)
    """The zero offset table of a McuWIN machine."""

    def points(self, count: int = 1501) -> Points:
        """Of the whole path, close to one another."""
        return np.concatenate([move.at(np.linspace(0.0, 1.0, count)) for move in self.moves])


# -- the three dialects


class Tracked(RandomPath):
    """Keeps by how much the tip is below: where lengths are used anywhere, the tool stands out without G43 too."""

    def __init__(self, rng: random.Random, start: list[float], offsets: Offsets) -> None:
        self.out = 0.0
        super().__init__(rng, start, offsets, LENGTH)

    def change_state(self) -> None:
        super().change_state()
        self.out = max(self.out, self.offsets.tool)


def eding(rng: random.Random) -> Made:
    """Lines, arcs and helices in all planes, drill cycles, offsets, lengths, units: `support.paths`."""
    start = [round(rng.uniform(-30, 30), 3) for _ in range(3)]
    work = {n: [round(rng.uniform(-40, 40), 3) for _ in range(3)] for n in (1, 2)}
    g92 = [round(rng.uniform(-10, 10), 3) if rng.random() < 0.3 else 0.0 for _ in range(3)]
    zeros = {n: [a + b for a, b in zip(work[n], g92, strict=True)] for n in work}
    setup = tables(start=start, g92=g92, **{f"work.{n}": list(row) for n, row in work.items()})
    path = Tracked(rng, start, Offsets({n: list(row) for n, row in work.items()}, list(g92)))
    for _ in range(rng.randrange(1, 6)):
        path.random_move()
    moves = [Move(at, length=path.out) for at in path.pieces][1:]
    return Made("eding", path.text, setup, "", moves, zeros)


def turned(rng: random.Random) -> Made:
    """Lines and arcs under G68 and G51 about one point: O + C + f e^(i angle) (p - C) (manual 3.4.13, 3.4.18)."""
    origin = complex(round(rng.uniform(-30, 30), 3), round(rng.uniform(-30, 30), 3))
    about = complex(round(rng.uniform(-20, 20), 3), round(rng.uniform(-20, 20), 3))
    angle, factor = round(rng.uniform(-180, 180), 2), rng.choice((1.0, 0.5, 1.75))
    turn = factor * cmath.exp(1j * math.radians(angle))
    lines = ["G21 G90 G17 G94 G40 G49 G54 F500"]
    start = [round(rng.uniform(-30, 30), 3) for _ in range(3)]
    lines.append(f"G68 R{angle} X{about.real} Y{about.imag}")
    if factor != 1.0:
        lines.append(f"G51 X{factor} Y{factor} I{about.real} J{about.imag}")
    moves: list[Move] = []
    at, z = complex(start[0], start[1]), start[2]
    point: complex | None = None

    def place(p: complex) -> complex:
        return origin + about + turn * (p - about)

    for _ in range(rng.randrange(2, 6)):
        up = round(rng.uniform(-20, 20), 3) if rng.random() < 0.5 else None
        to_z = z if up is None else up
        word = "" if up is None else f" Z{up}"
        if point is None or rng.random() < 0.5:
            point = complex(round(rng.uniform(-60, 60), 3), round(rng.uniform(-60, 60), 3))
            lines.append(f"{rng.choice(('G0', 'G1'))} X{point.real} Y{point.imag}{word}")
            moves.append(Move(straight([at.real, at.imag, z], [place(point).real, place(point).imag, to_z])))
        else:
            ij = complex(round(rng.uniform(1, 30), 3), round(rng.uniform(-30, 30), 3))
            ccw = rng.random() < 0.5
            lines.append(f"{'G3' if ccw else 'G2'} X{point.real} Y{point.imag}{word} I{ij.real} J{ij.imag}")
            middle = place(point + ij)
            moves.append(round_about(at, z, middle, math.tau if ccw else -math.tau, to_z))
        at, z = place(point), to_z
    setup = tables(start=start, g92=[0.0] * 3, **{"work.1": [origin.real, origin.imag, 0.0]})
    return Made("eding", "\n".join([*lines, "G69", "G50", "M30", ""]), setup, "", moves,
                {1: [origin.real, origin.imag, 0.0]})  # fmt: skip


def din(rng: random.Random, *, sets: bool = True) -> Made:
    """G00 to G03 in G90 and G91, zero offsets by table and by G92 (McuWIN manual 3.1 to 3.4, 3.18, 3.19, 3.26).

    sets: the program gives offsets of its own, and stands anywhere when it chooses one; else all axes go there first.
    """
    table = [[round(rng.uniform(-30, 30), 3) for _ in range(3)] for _ in range(2)]
    at = [round(rng.uniform(-30, 30), 3) for _ in range(3)]
    # No record of the table is in force: what [g92] states is the zero offset here (3.19).
    setup = tables(start=at, g92=[0.0] * 3).replace("active_work = 1\n", "")
    zeros = {n + 1: list(row) for n, row in enumerate(table)}
    offset, absolute = [0.0] * 3, True
    lines, moves = ["%", "G90"], list[Move]()
    count = rng.randrange(2, 6)
    while len(moves) < count:
        kind = rng.random()
        if kind < 0.12 or not (sets or moves):
            number = rng.randrange(2)
            lines.append(f"G{54 + number}")
            offset = list(table[number])
            if not sets:
                place = [round(rng.uniform(-50, 50), 3) for _ in "xyz"]
                lines += ["G90", "G00 " + " ".join(f"{axis}{v}" for axis, v in zip("XYZ", place, strict=True))]
                to = [a + b for a, b in zip(offset, place, strict=True)]
                moves.append(Move(straight(at, to), free=True))
                at, absolute = to, True
        elif kind < 0.2 and sets:
            axis, value = rng.randrange(3), round(rng.uniform(-20, 20), 3)
            lines.append(f"G92 {'XYZ'[axis]}{value}")
            offset[axis] = value if absolute else offset[axis] + value
        elif kind < 0.3:
            absolute = not absolute
            lines.append("G90" if absolute else "G91")
        elif kind < 0.65:
            code = rng.choice(("G00", "G01"))
            words, to = axis_words(rng, at, offset, absolute)
            lines.append(f"{code} {words}{' F900' if code == 'G01' else ''}")
            moves.append(Move(straight(at, to), free=code == "G00" and several(at, to)))
            at = to
        else:
            line, move, at = arc_words(rng, at, offset, absolute, ("G02", "G03"))
            lines.append(f"{line} F900")
            moves.append(move)
    machine = '[din]\nabsolute_centers = false\ntime_unit = "min"\ntool_file = ""\n'
    machine += 'interpolation_axes = "XYZ"\nposition_unit = "mm"\n'
    return Made("mcuwin", "\n".join([*lines, "M30", "%", ""]), setup, machine, moves, zeros, table)


def single(rng: random.Random, *, sets: bool = True) -> Made:
    """G0 to G3 in G90 and G91 with local coordinates (WinCNC manual: G0 to G3, G90, G91, G92, G22).

    sets: as for ``din``.
    """
    local = [round(rng.uniform(-30, 30), 3) for _ in range(3)]
    at = [round(rng.uniform(-30, 30), 3) for _ in range(3)]
    setup = tables(start=at, g92=list(local), measures=[math.nan, math.nan, 0.0])
    zeros = {1: list(local)}
    absolute = True
    lines, moves = ["G90", "G22"], list[Move]()
    count = rng.randrange(2, 6)
    while len(moves) < count:
        kind = rng.random()
        if not (sets or moves):
            place = [round(rng.uniform(-50, 50), 3) for _ in "xyz"]
            lines.append("G0 " + " ".join(f"{axis}{v}" for axis, v in zip("XYZ", place, strict=True)))
            to = [a + b for a, b in zip(local, place, strict=True)]
            moves.append(Move(straight(at, to), free=True))
            at = to
        elif kind < 0.15 and sets:
            axis, value = rng.randrange(3), round(rng.uniform(-20, 20), 3)
            lines.append(f"G92 {'XYZ'[axis]}{value}")
            local[axis] = at[axis] - value
        elif kind < 0.3:
            absolute = not absolute
            lines.append("G90" if absolute else "G91")
        elif kind < 0.65:
            code = rng.choice(("G0", "G1"))
            words, to = axis_words(rng, at, local, absolute)
            lines.append(f"{code} {words}")
            moves.append(Move(straight(at, to), free=code == "G0" and several(at, to)))
            at = to
        else:
            line, move, at = arc_words(rng, at, local, absolute, ("G2", "G3"))
            lines.append(line)
            moves.append(move)
    return Made("wincnc", "\n".join([*lines, ""]), setup, "", moves, zeros)


def axis_words(rng: random.Random, at: list[float], offset: list[float], absolute: bool) -> tuple[str, list[float]]:
    """Words for some axes, and where they lead."""
    words, to = [], list(at)
    for axis in sorted(rng.sample(range(3), rng.randrange(1, 4))):
        value = round(rng.uniform(-50, 50), 3)
        words.append(f"{'XYZ'[axis]}{value}")
        to[axis] = (offset[axis] if absolute else at[axis]) + value
    return " ".join(words), to


def arc_words(
    rng: random.Random, at: list[float], offset: list[float], absolute: bool, names: tuple[str, str]
) -> tuple[str, Move, list[float]]:
    """An arc or helix of X and Y about a centre that counts from its start; full circles, and ends on an axis too."""
    i, j = round(rng.uniform(-30, 30), 3), round(rng.uniform(-30, 30), 3)
    if rng.random() < 0.3:
        i, j = rng.choice(((i, 0.0), (0.0, j)))
    ccw = rng.random() < 0.5
    turn = math.tau if rng.random() < 0.25 else rng.choice((math.pi, math.pi / 2, rng.uniform(0.2, 6.0)))
    turn = turn if ccw else -turn
    base = offset if absolute else at
    middle = complex(at[0] + i, at[1] + j)
    end = middle + cmath.exp(1j * turn) * (complex(at[0], at[1]) - middle)
    to = list(at)
    words = []
    for axis, goal in ((0, end.real), (1, end.imag)):
        value = round((at[axis] if abs(turn) == math.tau else goal) - base[axis], 9)
        words.append(f"{'XY'[axis]}{value:.9f}")
        to[axis] = base[axis] + value
    if rng.random() < 0.4:
        value = round(rng.uniform(-20, 20), 3)
        words.append(f"Z{value}")
        to[2] = base[2] + value
    line = f"{names[ccw]} {' '.join(words)} I{i} J{j}"
    return line, round_about(complex(at[0], at[1]), at[2], middle, turn, to[2]), to


def straight(start: list[float], end: list[float]) -> Callable[[Points], Points]:
    a, b = np.array(start), np.array(end)
    return lambda t: a + np.outer(t, b - a)


def round_about(start: complex, z: float, middle: complex, turn: float, to_z: float) -> Move:
    def at(t: Points) -> Points:
        spot = middle + (start - middle) * np.exp(1j * turn * t)
        return np.column_stack([spot.real, spot.imag, z + (to_z - z) * t])

    return Move(at, arc=(middle, start, turn))


def several(a: list[float], b: list[float]) -> bool:
    return sum(x != y for x, y in zip(a, b, strict=True)) > 1


# -- files


def tables(**values: list[float]) -> str:
    """Tables of a setup file, without what is not a number."""
    out = 'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\nactive_work = 1\ntool = 1\n'
    for name, row in values.items():
        out += f"[{name}]\n"
        out += "".join(f"{axis} = {v!r}\n" for axis, v in zip("xyz", row, strict=True) if not math.isnan(v))
    return out


def machine_of(made: Made, limits: Points, more: str = "") -> str:
    """The machine's file; limits: (2, 3); more: tables at its end."""
    own = 'position_unit = "mm"\n' if made.dialect == "mcuwin" else ""
    axes = "".join(
        f"[axes.{n}]\nmin = {a!r}\nmax = {b!r}\n{own}" for n, (a, b) in zip("xyz", limits.T.tolist(), strict=True)
    )
    controller = f'[controller]\ndialect = "{made.dialect}"\n'
    records = f"zero_offsets = {made.records}\n" if made.records else ""
    return f'schema = "gproof-machine/1"\nunits = "mm"\n{axes}{controller}{made.machine}{records}{more}'


def opened(folder: Path, made: Made, machine: str) -> Session:
    """The job in a folder, read."""
    job = folder / f"job.{SUFFIXES[made.dialect]}"
    texts = {job.name: made.program, "machine.toml": machine, "setup.toml": made.setup, "CNC.MAC": ""}
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    return open_session(job, machine=folder / "machine.toml", setup=str(folder / "setup.toml"), dialect=made.dialect)


MAKERS = {"eding": eding, "turned": turned, "mcuwin": din, "wincnc": single}
