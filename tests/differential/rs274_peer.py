"""LinuxCNC's interpreter as the peer of the differential test: from a program to the rows of a trace.

Two programs of the same interpreter library are run and merged call by call:

- the Python module `gcode` (through `peer_canon.py` under the system's Python) gives motions, offsets and
  feeds with full precision, but is silent about spindle, coolant, stops and the end;
- the command `rs274 -g` prints every canonical call, but with four decimals. It gets a copy of the program
  with a comment before each line, so that each call it prints can be traced to a line.

Where both speak they must agree, call by call, and both must accept or both refuse; otherwise `PeerError`.
One such contradiction is a known defect of `gcode`: at M6 it takes the end of the last straight move for the
present position, in the units that are active now. So in a program the last move before M6 is a straight one,
in the units and with the offsets that hold at M6.

The interpreter runs as an inch machine: parameters 5161…, 5181…, 5221… and tool lengths are handed over in
inches, and what it says is turned into millimetres. Machine position = work offset + rotation × (said + G92
offset) + tool offset. Every run has its own temporary HOME (the tool table is shared through a file there). It
starts at coordinate 0 of the active system, which is machine 0 only where that system has no offset: under a
setup with one, the first move must name every axis that is offset.
"""

from __future__ import annotations

import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

Row = dict[str, Any]

HERE = Path(__file__).parent
MACHINE = HERE / "machine.toml"
SYSTEM_PYTHON = "/usr/bin/python3"
AXES = ("x", "y", "z", "a", "b", "c")
MM_PER_INCH = 25.4
TIMEOUT = 120.0  # seconds for one batch; a program takes some twenty milliseconds
NO_WAY = 1e-9  # mm and degrees: an axis that goes no farther rests
PRINTED = 6e-5  # half of the last digit that rs274 prints, and a little

# name that rs274 prints -> method that `gcode` calls
SAID_BY_BOTH = {
    "STRAIGHT_TRAVERSE": "straight_traverse",
    "STRAIGHT_FEED": "straight_feed",
    "STRAIGHT_PROBE": "straight_probe",
    "ARC_FEED": "arc_feed",
    "RIGID_TAP": "rigid_tap",
    "DWELL": "dwell",
    "SET_FEED_RATE": "set_feed_rate",
    "SELECT_PLANE": "set_plane",
    "USE_TOOL_LENGTH_OFFSET": "tool_offset",
    "SET_G5X_OFFSET": "set_g5x_offset",
    "SET_G92_OFFSET": "set_g92_offset",
    "SET_XY_ROTATION": "set_xy_rotation",
    "CHANGE_TOOL": "change_tool",
}
PLANES = {1: "XY", 2: "YZ", 3: "XZ"}
CALL = re.compile(r"^\s*\d+ N[\d. ]*([A-Z][A-Z0-9_]*)\((.*)\)\s*$")
MARK = re.compile(r'^"@line (\d+)"$')


class PeerError(Exception):
    """The peer is missing, broke, or contradicts itself; says nothing about gproof."""


@dataclass(frozen=True)
class Situation:
    """What the machine knows before the program starts, in mm and degrees: what is used of a setup file."""

    tools: Mapping[int, tuple[float, float]] = field(default_factory=dict)  # number -> length, diameter
    work: Mapping[int, Mapping[str, float]] = field(default_factory=dict)  # 1 = G54 … 9 = G59.3
    active_work: int = 1
    parameters: Mapping[int, float] = field(default_factory=dict)
    block_delete: bool = False

    def numbered(self) -> list[tuple[int, float]]:
        """The parameter file's content: ascending numbers, lengths in inches."""
        values = {5220: float(self.active_work)}
        for system, offsets in self.work.items():
            for axis, offset in offsets.items():
                values[5201 + 20 * system + AXES.index(axis)] = offset
        values.update(self.parameters)
        lengths = {base + axis for base in (5161, 5181, *range(5221, 5382, 20)) for axis in range(3)}
        return sorted((n, value / MM_PER_INCH if n in lengths else value) for n, value in values.items())


@dataclass(frozen=True)
class PeerRun:
    """What the peer made of a program: rows (the last one `error` if it refused), text of the refusal."""

    rows: list[Row]
    error: str | None = None

    @property
    def accepted(self) -> bool:
        return self.error is None


def missing() -> str | None:
    """Why the peer can not run here, or None."""
    if shutil.which("rs274") is None:
        return "rs274 is not installed (Debian: linuxcnc-uspace)"
    probe = subprocess.run([SYSTEM_PYTHON, "-c", "import gcode"], capture_output=True, check=False)
    return None if probe.returncode == 0 else f"{SYSTEM_PYTHON} has no module gcode (Debian: linuxcnc-uspace)"


def situation_of(setup: Path | None, machine: Path = MACHINE) -> Situation:
    """The situation that a gproof machine file and setup file (None: `--setup zero`) describe."""
    tools = {
        int(number): (float(tool["length"]), float(tool["diameter"]))
        for number, tool in tomllib.loads(machine.read_text())["tools"].items()
    }
    if setup is None:
        return Situation(tools=tools)
    given = tomllib.loads(setup.read_text())
    unknown = set(given) - set("schema homed start tool work g92 active_work parameters block_delete".split())
    moved = any(given.get("start", {}).values()) or any(given.get("g92", {}).values()) or given.get("tool", 0)
    if unknown or moved:
        raise PeerError(f"{setup}: the peer starts at machine 0 without tool and G92, and knows no {sorted(unknown)}")
    return Situation(
        tools=tools,
        work={int(system): dict(offsets) for system, offsets in given.get("work", {}).items()},
        active_work=given.get("active_work", 1),
        parameters={int(n): float(value) for n, value in given.get("parameters", {}).items()},
        block_delete=given.get("block_delete", False),
    )


def run_peer(program: Path, situation: Situation) -> PeerRun:
    """One program; `run_peers` is faster for many."""
    return run_peers([(program, situation)])[0]


def run_peers(programs: Sequence[tuple[Path, Situation]]) -> list[PeerRun]:
    """Each program under its situation, in one process of the system's Python and one `rs274` each."""
    with tempfile.TemporaryDirectory(prefix="gproof-peer-") as name:
        home = Path(name)
        jobs = [_job(home, k, program, situation) for k, (program, situation) in enumerate(programs)]
        answers = _listen(home, jobs)
        runs = []
        for k, (job, answer) in enumerate(zip(jobs, answers, strict=True)):
            printed, refused = _print(home, k, job)
            tools = [0, *(int(tool[0]) for tool in job["tools"])]
            runs.append(_merge(job["program"], answer, printed, refused, tools))
        return runs


def refusal(program: Path, situation: Situation) -> str | None:
    """What `rs274` says against the program as it stands; None if it accepts it."""
    with tempfile.TemporaryDirectory(prefix="gproof-peer-") as name:
        home = Path(name)
        job = _job(home, 0, program, situation)
        return _rs274(home, job, Path(job["program"]), home / "out.txt")


def _job(home: Path, k: int, program: Path, situation: Situation) -> dict[str, Any]:
    tools = [
        [n, length / MM_PER_INCH, diameter / MM_PER_INCH] for n, (length, diameter) in sorted(situation.tools.items())
    ]
    table = home / f"{k}.tbl"
    table.write_text("".join(f"T{n} P{n} Z{z!r} D{d!r}\n" for n, z, d in tools))
    parameters = home / f"{k}.var"
    parameters.write_text("".join(f"{n}\t{value!r}\n" for n, value in situation.numbered()))
    return {
        "program": str(program.resolve()),
        "parameters": str(parameters),
        "tool_table": str(table),
        "tools": tools,
        "block_delete": situation.block_delete,
    }


def _environment(home: Path) -> dict[str, str]:
    return {**os.environ, "HOME": str(home), "LC_ALL": "C"}


def _listen(home: Path, jobs: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Full precision from the module `gcode`, which writes parameters back, so into a copy of the file."""
    own = [{**job, "parameters": shutil.copy(job["parameters"], job["parameters"] + ".gcode")} for job in jobs]
    done = subprocess.run(
        [SYSTEM_PYTHON, str(HERE / "peer_canon.py")],
        input=json.dumps(own),
        capture_output=True,
        text=True,
        check=False,
        timeout=TIMEOUT + 0.5 * len(jobs),
        env=_environment(home),
        cwd=home,
    )
    if done.returncode != 0:
        raise PeerError(f"peer_canon.py ended with {done.returncode}: {done.stderr.strip()}")
    return [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]


@dataclass(frozen=True)
class _Printed:
    name: str
    line: int
    arguments: tuple[str, ...]


def _print(home: Path, k: int, job: dict[str, Any]) -> tuple[list[_Printed], str | None]:
    """Every canonical call from `rs274`, and its message if it refused the program."""
    own_home = home / f"home{k}"
    own_home.mkdir()
    marked = own_home / "marked.ngc"
    source = Path(job["program"]).read_text().splitlines()
    marked.write_text("".join(f"(@line {n})\n{text}\n" for n, text in enumerate(source, start=1)))
    output = own_home / "out.txt"
    refused = _rs274(own_home, job, marked, output)
    calls: list[_Printed] = []
    line = 0
    for text in output.read_text().splitlines() if output.exists() else ():
        found = CALL.search(text)
        if found is None:
            raise PeerError(f"rs274 printed what can not be read: {text!r}")
        name, arguments = found.groups()
        mark = MARK.match(arguments) if name == "COMMENT" else None
        if mark:
            line = int(mark[1])
        elif name not in {"COMMENT", "MESSAGE"}:
            calls.append(_Printed(name, line, tuple(re.split(r"[,\s]+", arguments.strip()))))
    return calls, refused


def _rs274(home: Path, job: dict[str, Any], program: Path, output: Path) -> str | None:
    """Run the command; its message if it refuses the program."""
    command = ["rs274", "-g", "-t", job["tool_table"], "-v", job["parameters"]]
    done = subprocess.run(
        [*command, *(["-b"] if job["block_delete"] else []), str(program), str(output)],
        capture_output=True,
        text=True,
        check=False,
        timeout=TIMEOUT,
        env=_environment(home),
        cwd=home,
    )
    if done.returncode == 0:
        return None
    return done.stderr.replace("executing", "").strip() or f"rs274 ended with {done.returncode}"


def _merge(
    program: str, answer: dict[str, Any], printed: list[_Printed], refused: str | None, tools: list[int]
) -> PeerRun:
    """Walk the printed calls; take the exact numbers of those that `gcode` said too from there."""
    if (answer["error"] is None) != (refused is None):
        raise PeerError(f"{program}: gcode says {answer['error']!r}, rs274 says {refused!r}")
    exact = [(name, line, arguments) for name, line, arguments in answer["calls"]]
    machine = _Machine(tools)
    k = 0
    for call in printed:
        name = SAID_BY_BOTH.get(call.name)
        if name is None:
            machine.event(call)
            continue
        if k == len(exact) or exact[k][0] != name:
            said = exact[k] if k < len(exact) else "nothing"
            raise PeerError(f"{program}:{call.line}: rs274 prints {call.name}, gcode says {said}")
        machine.check_printed(program, call, exact[k][2])
        machine.take(name, call.line, exact[k][2])
        k += 1
    if k != len(exact):
        raise PeerError(f"{program}: gcode says {exact[k]} and rs274 prints nothing of it")
    if refused is not None:
        machine.rows.append({"op": "error", "line": answer["error_line"], "text": answer["error"]})
    return PeerRun(machine.rows, refused)


class _Machine:
    """Follows the canonical calls and writes rows; lengths in inches inside, in millimetres in the rows."""

    def __init__(self, tools: list[int]) -> None:
        self.rows: list[Row] = []
        self.tools = tools
        self.work = [0.0] * 6
        self.g92 = [0.0] * 6
        self.tool = [0.0] * 6
        self.rotation = 0.0  # degrees
        self.plane = "XY"
        self.feed = 0.0  # inches a minute, or inches a revolution
        self.feed_number = 0.0  # the number of the program: degrees a minute where only rotary axes move
        self.per_revolution = False
        self.pitch = 0.0  # inches a revolution of a synchronised move, else 0
        self.printed_units = MM_PER_INCH  # what rs274 prints for one inch
        self.direction = "off"
        self.speed = 0.0
        self.mist = False
        self.flood = False
        self.at = [0.0] * 6  # the last position said, as it was said
        self.reached = dict.fromkeys(AXES, 0.0)  # the same in machine coordinates, mm and degrees

    def event(self, call: _Printed) -> None:
        """A call that only rs274 prints."""
        match call.name:
            case "USE_LENGTH_UNITS":
                self.printed_units = MM_PER_INCH if call.arguments[0] == "CANON_UNITS_MM" else 1.0
            case "SET_FEED_MODE":
                self.per_revolution = call.arguments[1] != "0"
            case "START_SPEED_FEED_SYNC":
                self.pitch = float(call.arguments[0]) / self.printed_units
            case "STOP_SPEED_FEED_SYNCH":
                self.pitch = 0.0
            case "START_SPINDLE_CLOCKWISE" | "START_SPINDLE_COUNTERCLOCKWISE":
                self._spindle(call.line, "cw" if call.name.endswith("_CLOCKWISE") else "ccw", self.speed)
            case "STOP_SPINDLE_TURNING":
                self._spindle(call.line, "off", self.speed)
            case "SET_SPINDLE_SPEED":
                self._spindle(call.line, self.direction, float(call.arguments[1]))
            case "MIST_ON" | "MIST_OFF":
                self._coolant(call.line, call.name == "MIST_ON", self.flood)
            case "FLOOD_ON" | "FLOOD_OFF":
                self._coolant(call.line, self.mist, call.name == "FLOOD_ON")
            case "PROGRAM_STOP" | "OPTIONAL_PROGRAM_STOP":
                self._row("stop", call.line, optional=call.name.startswith("OPTIONAL"))
            case "PROGRAM_END":
                self._row("end", call.line)
            case _ if call.name not in _NO_ROW:
                raise PeerError(f"line {call.line}: {call.name} is outside the language that the two share")

    def _row(self, op: str, line: int, **values: Any) -> None:
        self.rows.append({"op": op, "line": line, **values})

    def _spindle(self, line: int, direction: str, speed: float) -> None:
        turned = self.direction != "off" or direction != "off"
        self.direction, self.speed = direction, speed
        if turned:
            self._row("spindle", line, dir=direction, rpm=speed)

    def _coolant(self, line: int, mist: bool, flood: bool) -> None:
        self.mist, self.flood = mist, flood
        self._row("coolant", line, mist=mist, flood=flood)

    def take(self, name: str, line: int, arguments: list[Any]) -> None:
        """A call that both say, with its exact arguments."""
        match name:
            case "straight_traverse":
                self._row("traverse", line, to=self._position(arguments[:6]))
            case "straight_feed":
                self._straight_feed(line, arguments[:6])
            case "rigid_tap":
                self._rigid_tap(line, arguments)
            case "arc_feed":
                self._arc(line, arguments)
            case "dwell":
                self._row("dwell", line, seconds=float(arguments[0]))
            case "set_feed_rate":
                self.feed = float(arguments[0])
                self.feed_number = self.feed * self.printed_units
            case "set_plane":
                self.plane = PLANES[int(arguments[0])]
            case "tool_offset":
                self.tool = [float(value) for value in arguments[:6]]
            case "set_g5x_offset":
                self.work = [float(value) for value in arguments[1:7]]
            case "set_g92_offset":
                self.g92 = [float(value) for value in arguments[:6]]
            case "set_xy_rotation":
                self.rotation = float(arguments[0])
            case "change_tool":
                self._row("tool_change", line, tool=self.tools[int(arguments[0])])
            case _:
                raise PeerError(f"line {line}: {name} is outside the language that the two share")

    def _rigid_tap(self, line: int, arguments: list[Any]) -> None:
        """Out and, with the spindle reversed, back; the turns are restored at the end (LinuxCNC's manual, G33.1)."""
        before, direction = self.at, self.direction
        for to, turns in (([*arguments[:3], *before[3:]], {"cw": "ccw", "ccw": "cw"}[direction]), (before, direction)):
            self._row("feed", line, to=self._position(to), feed=self._rate())
            self._spindle(line, turns, self.speed)

    def _straight_feed(self, line: int, said: Sequence[float]) -> None:
        before = self.reached
        to = self._position(said)
        linear = any(abs(to[axis] - before[axis]) > NO_WAY for axis in AXES[:3])
        rotary = any(abs(to[axis] - before[axis]) > NO_WAY for axis in AXES[3:])
        self._row("feed", line, to=to, feed=self._rate(linear=linear or not rotary))

    def _rate(self, *, linear: bool = True) -> float:
        turning = self.speed if self.direction != "off" else 0.0
        if self.pitch:
            return self.pitch * MM_PER_INCH * turning
        feed = self.feed * MM_PER_INCH if linear else self.feed_number
        return feed * (turning if self.per_revolution else 1.0)

    def _in_machine(self, said: Sequence[float]) -> list[float]:
        """Program coordinates to machine coordinates, six values: mm and degrees."""
        moved = [value + offset for value, offset in zip(said, self.g92, strict=True)]
        if self.rotation:
            cos, sin = math.cos(math.radians(self.rotation)), math.sin(math.radians(self.rotation))
            moved[:2] = [moved[0] * cos - moved[1] * sin, moved[0] * sin + moved[1] * cos]
        reached = [value + w + t for value, w, t in zip(moved, self.work, self.tool, strict=True)]
        return [value * MM_PER_INCH for value in reached[:3]] + reached[3:]

    def _position(self, said: Sequence[float]) -> dict[str, float]:
        self.at = list(said)
        self.reached = dict(zip(AXES, self._in_machine(said), strict=True))
        return self.reached

    def _arc(self, line: int, arguments: list[Any]) -> None:
        first_end, second_end, first_axis, second_axis, rotation, axis_end, a, b, c = arguments[:9]
        # In G18 the first axis is Z and the second X, so that turns are seen from +Y in a right-handed frame.
        p, q, n = {"XY": (0, 1, 2), "XZ": (2, 0, 1), "YZ": (1, 2, 0)}[self.plane]
        end, center = [0.0, 0.0, 0.0, a, b, c], [0.0, 0.0, 0.0, a, b, c]
        end[p], end[q], end[n] = first_end, second_end, axis_end
        center[p], center[q], center[n] = first_axis, second_axis, axis_end
        at = dict(zip("XYZ", self._in_machine(center), strict=False))
        self._row(
            "arc",
            line,
            to=self._position(end),
            feed=self._rate(),
            plane=self.plane,
            center=[at[letter] for letter in self.plane],
            turns=int(rotation),
        )

    def check_printed(self, program: str, call: _Printed, exact: list[Any]) -> None:
        """What rs274 printed must be what gcode said, rounded: guards the merge and the units."""
        positions = {"STRAIGHT_TRAVERSE": range(3), "STRAIGHT_FEED": range(3), "ARC_FEED": (0, 1, 2, 3, 5)}
        for k in positions.get(call.name, ()):
            if abs(float(call.arguments[k]) - exact[k] * self.printed_units) > PRINTED:
                raise PeerError(f"{program}:{call.line}: {call.name} {call.arguments} is not {exact}")


# Calls that make no row of their own.
_NO_ROW = frozenset(
    "SET_FEED_REFERENCE ON_RESET START_CHANGE SELECT_TOOL SET_SPINDLE_MODE SET_MOTION_CONTROL_MODE "
    "SET_NAIVECAM_TOLERANCE ENABLE_FEED_OVERRIDE DISABLE_FEED_OVERRIDE ENABLE_SPEED_OVERRIDE "
    "DISABLE_SPEED_OVERRIDE PALLET_SHUTTLE ORIENT_SPINDLE WAIT_SPINDLE_ORIENT_COMPLETE".split()
)


def main(arguments: list[str]) -> int:
    """`python rs274_peer.py PROGRAM [SETUP]`: print the peer's rows as JSON Lines."""
    setup = Path(arguments[1]) if len(arguments) > 1 else None
    for row in run_peer(Path(arguments[0]), situation_of(setup)).rows:
        print(json.dumps(row))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
