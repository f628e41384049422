"""G68 of the manual beside the rotated coordinate system of LinuxCNC, `G10 L2 R`: other words, the same points.

LinuxCNC turns a coordinate system about its own zero; gproof's G68 R X Y turns the program about any point C. The two
agree where the zero of the peer's system is C - R C (in machine coordinates, with gproof's system at machine zero).
Each program is written twice, with the line that turns in the language of its reader, and compared move by move.
"""

from __future__ import annotations

import cmath
import math
import random
from pathlib import Path

import pytest
from differential import gproof_side, rs274_peer
from differential.compare import Row, first_difference
from differential.traces import report

HEAD = "G21 G17 G90 G94 G54 G40 G49 G80 G98\nF600\nG0 Z5\n"

BODIES = {
    "words-left-out": "G0 X0 Y0\n@\nX10\nY5\nG1 X3\nZ-1\nY8\n",
    "incremental": "G0 X3 Y4\n@\nG91\nG1 X10\nY5\nX-2 Y-3 Z1\nG90\nX0\n",
    "arcs": "@\nG0 X10 Y0\nG3 X0 Y10 I-10 J0\nG2 X5 Y5 R6\nG3 X5 Y5 I2 J1\nG2 X0 Y0 R-9 Z3\n",
    "cycle": "@\nG0 X1 Y1 Z10\nG81 X20 Y7 Z-3 R2\nG80\nG0 X0 Y0\n",
    "repeated-cycle": "@\nG0 X1 Y1 Z10\nG91\nG99 G81 X4 Y3 Z-1 R-6 L3\nG80\nG90\nG0 X0 Y0\n",
    "machine-coordinates": "G0 X1 Y1\n@\nX9 Y9\nG53 G0 X20 Y30\nX5 Y6\n",
    "inch": "@\nG20\nG0 X1 Y1\nG1 X2 F20\nG3 X1 Y2 I-1 J0\nG21\nG0 X7\n",
    "off-and-on": "G0 X1 Y1\n@\nX9 Y2\n-\nX9 Y2\nX4\n@\nX9 Y2\n",
    "synchronised": "S500 M3\n@\nG0 X1 Y1\nG33 X5 Y4 Z-1 K2\nG33.1 X3 Z-4 K0.5\nG0 X0 Y0 Z5\nM5\n",
    "rotary": "@\nG0 X1 Y1 A0\nG1 X5 Y5 A45\nG1 A90\n",
}
TURNS = ((30.0, 0j), (90.0, 0j), (-117.25, 0j), (180.0, 12 - 7j), (45.0, 10 + 5j), (-33.3, -20 + 4.5j))


def both(text: str, angle: float, point: complex) -> tuple[str, str]:
    """gproof's program and the peer's: `@` turns, `-` ends it."""
    zero = point - cmath.rect(1, math.radians(angle)) * point
    ours = {"@": f"G68 R{angle} X{point.real} Y{point.imag}", "-": "G69"}
    theirs = {"@": f"G10 L2 P1 X{zero.real:.12f} Y{zero.imag:.12f} R{angle}", "-": "G10 L2 P1 X0 Y0 R0"}
    lines = (HEAD + text + "M30\n").splitlines()
    # The peer's own units hold for its G10: it is only written in millimetres here.
    return tuple("\n".join(words.get(line, line) for line in lines) + "\n" for words in (ours, theirs))  # type: ignore[return-value]


def random_body(rng: random.Random) -> str:
    """Lines and arcs on a grid of 0.0001 mm, words left out, absolute and incremental."""
    from passes.interpret.core.test_plane_transform import random_lines

    lines = random_lines(rng, cycles=False)
    absolute, places = True, [0]
    for n, line in enumerate(lines):
        absolute = line == "G90" or (absolute and line != "G91")
        # The lines were made for the places that they name: behind the turn the first has to name both axes.
        if absolute and line[:2] in ("G0", "G1") and "X" in line and "Y" in line:
            places.append(n)
    place = rng.choice(places)
    return "\n".join([*lines[:place], "@", *lines[place:]]) + "\n"


def compare(folder: Path, programs: list[tuple[str, str]]) -> list[str]:
    """Reports of the programs on which the two disagree."""
    jobs, ours = [], []
    for k, (our_text, their_text) in enumerate(programs):
        our_file, their_file = folder / f"gproof-{k}.ngc", folder / f"peer-{k}.ngc"
        our_file.write_text(our_text)
        their_file.write_text(their_text)
        ours.append(our_file)
        jobs.append((their_file, rs274_peer.situation_of(None)))
    out = []
    for file, peer in zip(ours, rs274_peer.run_peers(jobs), strict=True):
        assert peer.accepted, f"{file.read_text()}\n{peer.error}"
        said = gproof_side.in_process(gproof_side.dump_arguments(file, None))
        assert said.code == 0, f"{file.read_text()}\n{said}"
        mine: list[Row] = said.rows()
        difference = first_difference(mine, peer.rows)
        if difference is not None:
            out.append(report(file, difference))
    return out


@pytest.mark.usefixtures("peer", "gproof")
@pytest.mark.parametrize("name", BODIES)
def test_a_rotation_is_the_peers_rotated_system(name: str, tmp_path: Path) -> None:
    assert compare(tmp_path, [both(BODIES[name], angle, point) for angle, point in TURNS]) == []


@pytest.mark.usefixtures("peer", "gproof")
def test_random_programs(tmp_path: Path) -> None:
    programs = []
    for seed in range(60):
        rng = random.Random(seed)
        angle = round(rng.uniform(-360, 360), rng.choice((0, 3)))
        point = complex(rng.randint(-20, 20), rng.randint(-20, 20)) * rng.choice((0, 1))
        programs.append(both(random_body(rng), angle, point))
    assert compare(tmp_path, programs) == []
