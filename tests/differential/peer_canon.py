"""Runs LinuxCNC's interpreter on programs and prints its canonical calls; for the *system* Python only.

Debian ships the interpreter as the Python module `gcode` of /usr/bin/python3, which the project's own Python
can not import. `rs274_peer.py` starts this file under /usr/bin/python3, so it uses nothing of this project.

Takes, as JSON on stdin, a list of jobs `{"program": path, "parameters": path, "tool_table": path, "tools":
[[number, length, diameter], ...], "block_delete": bool}` (the tools twice, in the same order: `T` looks them
up in the file, `G43` asks for the n-th of them). Gives, for each job, one JSON line `{"calls": [[name, line,
[arguments]], ...], "error": text or null, "error_line": n}`, in the order of the jobs. Every number is as the
interpreter passes it: lengths in inches, angles in degrees, feeds in inches a minute (`gcode` divides those
of metric programs by 25.4), full double precision. `line` is the line of the file.

Each job runs in its own forked child, because the module keeps one interpreter for the whole process.
"""

from __future__ import annotations

import ctypes
import json
import os
import sys
from typing import Any

LISTENED = frozenset(
    "straight_traverse straight_feed straight_probe arc_feed rigid_tap dwell set_feed_rate set_plane "
    "tool_offset set_g5x_offset set_g92_offset set_xy_rotation user_defined_function".split()
)
ALL_AXES = 0b111111  # X Y Z A B C
INCHES_PER_MM = 1 / 25.4  # the interpreter's word for "an inch machine", as rs274 is one
NO_TOOL = (-1, *([0.0] * 12), 0)  # number, nine offsets, diameter, front and back angle, orientation


class Listener:
    """The canon object: records calls with the line they come from, answers the interpreter's questions."""

    def __init__(self, job: dict[str, Any]) -> None:
        self.parameter_file: str = job["parameters"]
        self.calls: list[tuple[str, int, list[Any]]] = []
        self._line = 0
        self._block_delete = bool(job.get("block_delete", False))
        self._tools = [NO_TOOL] + [
            (int(number), 0.0, 0.0, length, *([0.0] * 6), diameter, 0.0, 0.0, 0)
            for number, length, diameter in job["tools"]
        ]  # [0] is the tool in the spindle

    def __getattr__(self, name: str) -> Any:
        def call(*arguments: Any) -> None:
            if name in LISTENED:
                self.calls.append((name, self._line, list(arguments)))

        return call

    def next_line(self, state: Any) -> None:
        self._line = int(state.sequence_number)

    def check_abort(self) -> None:
        """Asked for regularly; anything but an exception lets the interpreter go on."""

    def change_tool(self, index: int) -> None:
        self.calls.append(("change_tool", self._line, [index]))
        self._tools[0] = self._tools[index] if index else NO_TOOL

    def get_tool(self, index: int) -> tuple[Any, ...]:
        return self._tools[index] if index < len(self._tools) else NO_TOOL

    def get_external_angular_units(self) -> float:
        return 1.0

    def get_external_length_units(self) -> float:
        return INCHES_PER_MM

    def get_axis_mask(self) -> int:
        return ALL_AXES

    def get_block_delete(self) -> bool:
        return self._block_delete


def load_tool_table(path: str) -> None:
    """Give this process the tool table that `T` and `M6` look into; without one, `T` ends in a crash.

    LinuxCNC's I/O controller shares the table through `$HOME/.tool.mmap`; `rs274` does the same.
    """
    tooldata = ctypes.CDLL("libtooldata.so.0")
    tooldata._Z17tool_mmap_creatorPK13EMC_TOOL_STATi(None, 0)  # tool_mmap_creator(status, random changer)
    tooldata._Z13tooldata_initb(False)  # tooldata_init(random changer)
    if tooldata._Z13tooldata_loadPKcPPc(path.encode(), None) != 0:  # tooldata_load(file, comments)
        raise OSError(f"tool table {path} can not be loaded")


def run(job: dict[str, Any]) -> dict[str, Any]:
    """The calls of one program."""
    import gcode

    load_tool_table(job["tool_table"])
    listener = Listener(job)
    status, line = gcode.parse(job["program"], listener, "", "")
    failed = status > gcode.MIN_ERROR
    return {
        "calls": listener.calls,
        "error": gcode.strerror(status) if failed else None,
        "error_line": int(line) if failed else 0,
    }


def main() -> int:
    """Loads the interpreter once; only children use it, so that each starts with a fresh one."""
    import gcode  # type: ignore[import-not-found]  # noqa: F401

    for job in json.load(sys.stdin):
        sys.stdout.flush()
        child = os.fork()
        if child == 0:
            sys.stdout.write(json.dumps(run(job)) + "\n")
            sys.stdout.flush()
            os._exit(0)
        status = os.waitpid(child, 0)[1]
        if status != 0:
            died = {"calls": [], "error": f"the interpreter died with status {status}", "error_line": 0}
            sys.stdout.write(json.dumps(died) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
