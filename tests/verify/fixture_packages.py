"""Makes the packages beside this file, which later versions read, or refuse as older: never UNSAFE.

``python tests/verify/fixture_packages.py FILE.zip`` compiles each job of ``JOBS`` with the gproof at hand into an
archive. It was run for each format when that was new; an archive that is there is never made again. Random in a
package are the key and the date of its signature.
"""

from __future__ import annotations

import contextlib
import sys
import tempfile
import zipfile
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
AXES = "".join(
    f"[axes.{name}]\nsteps_per_unit = 320\nmin = -200\nmax = 300\nmax_velocity = 100\nmax_acceleration = 500\n"
    for name in "xyz"
)
HEAD = 'schema = "gproof-machine/1"\nunits = "mm"\n'
PATH = "G0 Z20\nG0 X0 Y0\nG1 Z-1 F300\nG1 X40 F600\nG2 X60 Y20 I0 J20\nG0 Z20\n"
EDING = {"job.cnc": f"G21 G90 G94 G17 G40 G49 G54\n{PATH}M0\nM3 S1000\nM5\nM30\n"}
WINCNC = {"job.tap": "G22 G90\n" + PATH.replace("J20", "J20 F600"), "CNC.MAC": ""}
MCUWIN = {"job.src": f"G71 G90\n{PATH.replace('G0 ', 'G00 ')}M0\nM30\n"}
OPEN = 'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\nactive_work = 1\ntool = 0\ntool_length = 0.0\n'
"""Without the offset itself."""
MACHINES = {
    "eding": HEAD + '[controller]\ndialect = "eding"\nlaf_angle = 10\nthread_peak = "offset"\n'
    'macro_file = "macro.cnc"\n' + AXES,
    "wincnc": HEAD + '[controller]\ndialect = "wincnc"\n[controls]\nshift_sign = 1\nsoft_limits = true\n'
    "absolute = true\nsmallest_arc = 0.01\nnesting = 3\narcs_share_feed = true\n"
    + AXES.replace("max_vel", "feed_velocity = 20\nmax_vel"),
    "mcuwin": HEAD + '[din]\ncase_sensitive = false\nposition_unit = "mm"\ntime_unit = "min"\n'
    'absolute_centers = false\ninterpolation_axes = "XYZ"\n[din.task0]\nM0 = "stop"\nM30 = "end"\n'
    + AXES.replace("max_vel", 'position_unit = "mm"\nmax_vel'),
}  # fmt: skip


@dataclass(frozen=True)
class Job:
    """One package: files that are written beside the job, or a job of the corpus; setup: None: not stated."""

    name: str
    program: str
    machine: str
    setup: str | None
    files: dict[str, str] = field(default_factory=dict)
    signed: bool = False


def _own(dialect: str, files: dict[str, str], name: str, setup: str | None, *, signed: bool = False) -> Job:
    stated = {"setup.toml": setup} if setup is not None and setup != "zero" else {}
    given = "setup.toml" if stated else setup
    beside = {**files, **stated, "machine.toml": MACHINES[dialect]}
    return Job(f"{dialect}-{name}", next(iter(files)), "machine.toml", given, beside, signed)


def _corpus(name: str, folder: str, program: str, machine: str, setup: str) -> Job:
    given = setup if setup == "zero" else f"corpus/{folder}/{setup}"
    return Job(name, f"corpus/{folder}/{program}", f"corpus/{folder}/{machine}", given)


OWN = (("eding", EDING), ("wincnc", WINCNC), ("mcuwin", MCUWIN))
JOBS = (
    *(_own(dialect, files, "zero", "zero") for dialect, files in OWN),
    *(_own(dialect, files, "measured", OPEN) for dialect, files in OWN),
    *(_own(dialect, files, "signed", "zero", signed=True) for dialect, files in OWN),
    _corpus("eding-stops", "eding/operator-stops", "job.cnc", "../machines/router.toml", "setup.toml"),
    _corpus("eding-ini", "eding/facing", "job.cnc", "machine.toml", "zero"),
    _corpus("eding-workpiece", "eding/clamped-bracket", "job.cnc", "machine.toml", "setup.toml"),
    _corpus("wincnc-ini", "wincnc/vacuum-router", "jobs/ask-to-stop.tap", "WINCNC.INI", "setup.toml"),
    _corpus("mcuwin-ini", "mcuwin/engraver", "jobs/pocket.src", "machine.toml", "setup.toml"),
)


def make(job: Job, into: Path) -> None:
    """Compile a job into ``into / NAME.gpx``, with names of files as they are here; RuntimeError where that fails."""
    from gproof.cli.main import main
    from gproof.verify.certificate.keys import load_or_create_key

    with tempfile.TemporaryDirectory() as folder:
        for name, text in job.files.items():
            Path(folder, name).write_text(text)
        words = ["compile", job.program, "--machine", job.machine]
        if job.setup is not None:
            words += ["--setup", job.setup]
        key = Path(folder) / "key.pem"
        load_or_create_key(key)
        words += ["--key", str(key)] if job.signed else ["--unsigned"]
        with contextlib.chdir(folder if job.files else ROOT):
            code = main([*words, "-o", str(into / f"{job.name}.gpx")])
    if code != 0:
        raise RuntimeError(f"{job.name}: exit {code}")


if __name__ == "__main__":
    with zipfile.ZipFile(sys.argv[1], "x") as archive, tempfile.TemporaryDirectory() as made:
        for one in JOBS:
            make(one, Path(made))
            archive.write(Path(made, f"{one.name}.gpx"), f"{one.name}.gpx")
