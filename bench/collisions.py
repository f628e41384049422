"""``gproof check --also collisions`` beside the public peer ``gcode-collision-check`` 0.1.0: the same moves and boxes.

Used by run.py; ``make bench`` installs the peer, ``pip install -e .[peers]`` does without make. A pocket is cut in rows
between two clamps and a bar, which a few moves come too near to.
"""

from __future__ import annotations

import json
import re
import struct
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from measure import Runs, run_once

PEER = "gcode-collision-check"
MOVES = (100, 1_000, 5_000)
BOXES = {
    "left": ((-40.0, 20.0, -20.0), (-10.0, 60.0, 6.0)),
    "right": ((110.0, 20.0, -20.0), (140.0, 60.0, 6.0)),
    "bar": ((-40.0, 88.0, -20.0), (140.0, 100.0, 25.0)),
}
TOOL = {"diameter": 6.0, "flute-length": 15.0, "shank-diameter": 6.0, "shank-length": 15.0}
HOLDER = {"holder-diameter": 30.0, "holder-length": 30.0}
_FACES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def write_program(path: Path, moves: int) -> None:
    """Rows of short moves, each row deeper into Y until the holder meets the bar, and the left clamp at the end."""
    lines = ["G21 G90 G17 G49", "G0 Z40", "G0 X0 Y0", "G1 Z-5 F300"]
    columns = 40
    rows = max(1, moves // columns)
    for row in range(rows):
        y = 78.0 * (row + 1) / rows
        for n in range(columns):
            x = 100.0 * (n if row % 2 == 0 else columns - 1 - n) / (columns - 1)
            lines.append(f"G1 X{x:.3f} Y{y:.3f} Z{-5.0 - (n % 5) * 0.1:.3f}")
    path.write_text("\n".join([*lines, "G1 X-9 Y40", "G0 Z40", "M30", ""]), encoding="utf-8")


def write_scene(folder: Path) -> list[Path]:
    """The boxes as STL files; machine and setup for gproof beside them."""
    files = []
    for name, ends in BOXES.items():
        corners = [tuple(ends[n >> axis & 1][axis] for axis in range(3)) for n in range(8)]
        triangles = [t for a, b, c, d in _FACES for t in ((a, b, c), (a, c, d))]
        rows = [struct.pack("<12fH", 0, 0, 0, *(v for n in t for v in corners[n]), 0) for t in triangles]
        files.append(folder / f"{name}.stl")
        files[-1].write_bytes(b"\0" * 80 + struct.pack("<I", len(rows)) + b"".join(rows))
    axes = "".join(f'[axes.{axis}]\nkind = "linear"\nmin = -500.0\nmax = 500.0\n' for axis in "xyz")
    stickout = TOOL["flute-length"] + TOOL["shank-length"]
    wide, long = HOLDER["holder-diameter"], HOLDER["holder-length"]
    (folder / "machine.toml").write_text(
        f'schema = "gproof-machine/1"\nname = "bench"\nunits = "mm"\n[controller]\nstraight_traverse = true\n{axes}'
        f'[tools.1]\nshape = "flat"\ndiameter = {TOOL["diameter"]}\nflute_length = {TOOL["flute-length"]}\n'
        f'shank_diameter = {TOOL["shank-diameter"]}\nstickout = {stickout}\nholder = [[{wide}, {wide}, {long}]]\n',
        encoding="utf-8",
    )  # fmt: skip
    fixtures = "".join(f'[[fixtures]]\nname = "{path.stem}"\nstl = "{path.name}"\n' for path in files)
    zero = "x = 0.0\ny = 0.0\nz = 0.0\n"
    (folder / "setup.toml").write_text(
        f'schema = "gproof-setup/1"\ntool = 1\nactive_work = 1\nstart = {{x = 0.0, y = 0.0, z = 40.0}}\n'
        f"[work.1]\n{zero}[g92]\n{zero}{fixtures}",
        encoding="utf-8",
    )
    return files


def compare(
    folder: Path, environment: Mapping[str, str], gproof: list[str], repeat: int
) -> list[dict[str, Any]]:  # fmt: skip
    """For each size both commands in turn; found: bodies that each found the tool in."""
    beside = Path(sys.executable).parent
    places = (beside.parent / "peers" / "bin" / PEER, beside / PEER)
    peer = next((place for place in places if place.exists()), places[0])
    files = write_scene(folder)
    rows = []
    for moves in MOVES:
        job = folder / f"moves-{moves}.nc"
        write_program(job, moves)
        ours, theirs = Runs(), Runs()
        words = [str(job), "--machine", str(folder / "machine.toml"), "--setup", str(folder / "setup.toml")]
        told = folder / "peer.json"
        said = ""
        for _ in range(repeat):
            command = [*gproof, "check", *words, "--dialect", "eding", "--also", "collisions", "--format", "json"]
            said = run_once(command, environment, ours, (0, 1))
            if peer.exists():
                options = [w for name, mm in (TOOL | HOLDER).items() for w in (f"--tool-{name}", str(mm))]
                scene = [w for path in files for w in ("--scene", str(path))]
                run_once(
                    [str(peer), "verify", str(job), *scene, *options, "--quiet", "--output", str(told)],
                    environment, theirs, (0, 1),
                )  # fmt: skip
        row: dict[str, Any] = {"moves": moves, "gproof": ours.as_json(), "found": _found(said)}
        if peer.exists():
            pairs = [
                pair for event in json.loads(told.read_text(encoding="utf-8"))["events"] for pair in event["pairs"]
            ]
            row |= {"peer": theirs.as_json(), "peer_found": sorted({n for pair in pairs for n in pair if n in BOXES})}
        rows.append(row)
    return rows


def _found(report: str) -> list[str]:
    findings = json.loads(report)["findings"] if report else []
    said = " ".join(f["message"] for f in findings if f["severity"] == "error" and f["property"] == "collisions")
    return sorted({name for name in BOXES if re.search(rf"\b{name}\b", said)})


def show(rows: list[dict[str, Any]]) -> None:
    """A line for each size."""
    print("\nCollisions with fixtures beside gcode-collision-check 0.1.0, seconds of the whole process")
    print(f"  {'moves':>6} {'peer':>8} {'gproof':>8} {'ratio':>6}  found by the peer -> by gproof")
    for row in rows:
        best = min(row["gproof"]["wall_s"])
        peer = min(row["peer"]["wall_s"]) if "peer" in row else None
        told = f"{peer:8.3f} {best:8.3f} {best / peer:6.2f}" if peer else f"{'-':>8} {best:8.3f} {'-':>6}"
        missed = sorted(set(row.get("peer_found", ())) - set(row["found"]))
        print(f"  {row['moves']:6,} {told}  {', '.join(row.get('peer_found', ['(not installed)']))} -> "
              f"{', '.join(row['found'])}  {'MISS: ' + ', '.join(missed) if missed else 'PASS'}")  # fmt: skip
        for name in ("gproof", "peer"):
            if "problem" in row.get(name, {}):
                print(f"         ! {name}: {row[name]['problem']}")
