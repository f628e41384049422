"""What a machine file states over `base = "WINCNC.INI"` is not judged in the controller's file; the rest still is."""

from __future__ import annotations

from pathlib import Path

import pytest

from gproof.driver.dialects import load_machine
from gproof.frontend.common.own_keys import key_paths
from gproof.ir.finding import Findings, Severity

INI = """\
unit=mm
axischar=XYZW
axisspec=p0s0d0r100a6000
axisvel=r6000f1200
axisspec=p0s1d1r100a6000
axisvel=r6000f1200
axisspec=p0s2d2r200a3000
axisvel=r3000f600
axisspec=p0s3d3r200a3000
axisvel=r3000f600
"""
X, Z = "axisspec=p0s0d0r100a6000", "axisspec=p0s2d2r200a3000"
MISTAKES = {
    # What to put in place of a line (or below all), what states it anew, what does not.
    "resolution": (X, "axisspec=p0s0d0r-100a6000", "[axes.x]\nsteps_per_unit = 80\n", "[axes.y]\nbacklash = 1\n"),
    "acceleration": (X, "axisspec=p0s0d0r100a-1", "[axes.x]\nmax_acceleration = 5\n", "[axes.x]\nmax_velocity = 5\n"),
    "too much": (X, "axisspec=p0s0d0r9000a600000", "[axes.x]\nmax_acceleration = 5\n", "[axes.z]\nbacklash = 1\n"),
    "backlash": (Z, Z + "b-3", "[axes.z]\nbacklash = 0.1\n", "[axes.x]\nbacklash = 0.1\n"),
    "velocity": ("axisvel=r3000f600", "axisvel=r0f600", "[axes.z]\nmax_velocity = 9\n", "[axes.x]\nmax_velocity = 9\n"),
    "feed": ("axisvel=r3000f600", "axisvel=r3000f-6", "[axes.z]\nfeed_velocity = 9\n", "[axes.a]\nfeed_velocity = 9\n"),
    "second motor": (Z, Z + "\naltaxisspec=p0s4d4q9", "[axes.z]\nslaves = []\n", "[axes.x]\nslaves = []\n"),
    "limits": ("", "lolim=x5\nhilim=x1", "[axes.x]\nmin = 0\nmax = 10\n", "[axes.y]\nmin = 0\nmax = 10\n"),
    "one limit": ("", "lolim=x5\nhilim=x1", "[axes.x]\nmin = 0\n", "[axes.x]\nboundary_min = 0\n"),
    "limits of W": ("", "lolim=w5\nhilim=w1", "[axes.a]\nmin = 0\nmax = 10\n", "[axes.z]\nmin = 0\nmax = 10\n"),
    "boundaries": ("", "lobound=y5\nhibound=y1", "[axes.y]\nboundary_max = 10\n", "[axes.y]\nmax = 10\n"),
    "arc_err": ("", "arc_err=some", "[controls]\narc_tolerance = 0.1\n", "[controls]\nsmallest_arc = 0.1\n"),
    "arc_min": ("", "arc_min=-1", "[controls]\nsmallest_arc = 0.1\n", "[controls]\narc_tolerance = 0.1\n"),
    "nmode": ("", "nmode=92", "[controls]\nabsolute = true\n", "[controls]\nsoft_limits = true\n"),
    "softlim": ("", "softlim=t7", "[controls]\nsoft_limits = true\n", "[controls]\nadjust_boundary = true\n"),
    "softlim B": ("", "softlim=t1b4", "[controls]\nadjust_boundary = false\n", "[controls]\nsoft_limits = true\n"),
    "softlim V": ("", "softlim=t1v4", "[controls]\nadjust_vertical = false\n", "[controls]\nsoft_limits = true\n"),
    "arcs M": ("", "arcs=m5a0", "[controls]\narcs_modal = true\n", "[controller]\nabsolute_arc_centers = true\n"),
    "arcs A": ("", "arcs=m0a5", "[controller]\nabsolute_arc_centers = true\n", "[controls]\narcs_modal = true\n"),
    "g2modal": ("", "g2modal=6", "[controls]\narcs_modal = true\n", "[controls]\nabsolute = true\n"),
    "maxstepv": ("", "maxstepv=fast", "[controller]\nmax_step_frequency = 50000\n", "[board]\nstep_pulse = 1e-5\n"),
    "steppulse": ("", "steppulse=p-5d5", "[board]\nstep_pulse = 1e-5\n", "[board]\ndirection_setup = 1e-5\n"),
    "spindle": ("", "spindle=t1r0", "[spindles.0]\nmax_rpm = 9000\n", "[spindles.0]\nmin_rpm = 10\n"),
}  # fmt: skip


def told(folder: Path, what: str, stated: str) -> list[str]:
    old, new, *_ = MISTAKES[what]
    text = INI.replace(old, new, 1) if old else f"{INI}{new}\n"
    (folder / "WINCNC.INI").write_text(text, "ascii")
    (folder / "machine.toml").write_text(
        f'schema = "gproof-machine/1"\nunits = "mm"\nbase = "WINCNC.INI"\n{stated}', "utf-8"
    )
    findings = Findings()
    machine, _ = load_machine(folder / "machine.toml", findings)
    found = [f"{f.code} {f.message}" for f in findings.kept if f.severity is not Severity.NOTE]
    assert machine is not None or found
    if machine is not None:
        found += [f"not modelled: {one.what}" for one in machine.not_modelled]
    return found


@pytest.mark.parametrize("what", MISTAKES)
def test_what_is_stated_anew_is_not_judged(what: str, tmp_path: Path) -> None:
    assert told(tmp_path, what, MISTAKES[what][2]) == []
    assert told(tmp_path, what, MISTAKES[what][3]) != []
    assert told(tmp_path, what, "") != []


def test_paths() -> None:
    found = set(key_paths({"schema": "x", "axes": {"x": {"min": 1, "max-velocity": 2}}}))
    assert found == {("schema",), ("axes", "x", "min"), ("axes", "x", "max_velocity")}
