"""Programs of moves that follow the spindle, from a seed: threads, taps, G33 and G33.1, back boring.

python -m differential.random_spindle 42        # in tests/: the program of a seed
"""

from __future__ import annotations

import random
import sys

_AXES = {"G17": ("X", "Y", "Z"), "G18": ("X", "Z", "Y"), "G19": ("Y", "Z", "X")}
_OFFSETS = {"X": "I", "Y": "J", "Z": "K"}


def program(seed: int) -> str:
    """A program in the language that Eding CNC and LinuxCNC share; feed per revolution, which both give a tap."""
    r = random.Random(seed)
    inch = r.random() < 0.3
    lines = [
        f"(seed {seed})",
        f"{'G20' if inch else 'G21'} G17 G40 G49 G54 G80 G90 G95 G98",
        f"G10 L2 P1 X{_n(r, -9, 9)} Y{_n(r, -9, 9)} Z{_n(r, -9, 9)}",
        f"S{r.randint(10, 50)} M3 F{_n(r, 0.1, 2)}",
        "G0 X0 Y0 Z0",
    ]
    for _ in range(r.randint(3, 8)):
        lines += r.choice((_synchronised, _thread, _tap, _back_bore))(r)
    return "\n".join([*lines, "M2", ""])


def _n(r: random.Random, low: float, high: float) -> str:
    return f"{r.uniform(low, high):.3f}"


def _synchronised(r: random.Random) -> list[str]:
    words = [f"{letter}{_n(r, -20, 20)}" for letter in "XYZ" if r.random() < 0.6] or ["Z1.5"]
    code = r.choice(("G33", "G33.1"))
    distance = r.choice(("G90", "G91"))
    return [f"{distance} {code} {' '.join(words)} K{_n(r, 0.2, 3)}", "G90 G0 Z5"]


def _thread(r: random.Random) -> list[str]:
    start, length = r.uniform(-5, 5), r.uniform(8, 30) * r.choice((1, -1))
    full = r.uniform(0.3, 1.5)
    words = [
        f"P{_n(r, 0.3, 3)}", f"Z{start + length:.3f}", f"I{r.choice((1, -1)) * r.uniform(0.5, 6):.3f}",
        f"J{_n(r, 0.1 * full, 0.9 * full)}", f"K{full:.3f}",
    ]  # fmt: skip
    if r.random() < 0.6:
        words.append(f"R{_n(r, 1, 2.5)}")
    if r.random() < 0.5:
        words.append(f"Q{_n(r, 0, 35)}")
    if r.random() < 0.5:
        words.append(f"H{r.randint(0, 3)}")
    if r.random() < 0.5:
        # A taper whose slope has few digits: LinuxCNC prints the pitch along it with six.
        words += [f"E{full:.3f}", f"L{r.randint(0, 3)}"]
    return [f"G18 G0 X{_n(r, 5, 40)} Z{start:.3f}", "G76 " + " ".join(words), "G17"]


def _tap(r: random.Random) -> list[str]:
    code, way = r.choice((("G84", "M3"), ("G74", "M4")))
    top = r.uniform(1, 4)
    # LinuxCNC knows no L beside G74.
    repeats = f" L{r.randint(2, 3)}" if code == "G84" and r.random() < 0.4 else ""
    lines = [way, f"G0 Z{_n(r, -4, 8)}"]
    level, depth = r.choice(("G98", "G99")), top - r.uniform(1, 9)
    lines.append(f"{level} {code} X{_n(r, -9, 9)} Y{_n(r, -9, 9)} Z{depth:.3f} R{top:.3f} F{_n(r, 0.2, 2)}{repeats}")
    return [*lines, "G80", "M3"]


def _back_bore(r: random.Random) -> list[str]:
    plane = r.choice(tuple(_AXES))
    one, two, drill = _AXES[plane]
    top, way = r.uniform(1, 4), r.choice(("M3", "M4"))
    depth = top - r.uniform(3, 12)
    bore = depth + r.uniform(0.1, 2)
    words = [f"{one}{_n(r, -9, 9)}", f"{two}{_n(r, -9, 9)}", f"{drill}{depth:.3f}", f"R{top:.3f}"]
    words += [f"{_OFFSETS[one]}{_n(r, -3, 3)}", f"{_OFFSETS[two]}{_n(r, -3, 3)}", f"{_OFFSETS[drill]}{bore:.3f}"]
    return [way, f"{plane} G0 {drill}{_n(r, -4, 8)}", f"{r.choice(('G98', 'G99'))} G87 {' '.join(words)}", "G80 G17"]


if __name__ == "__main__":
    sys.stdout.write(program(int(sys.argv[1])))
