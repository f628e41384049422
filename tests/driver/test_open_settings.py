"""A letter that the manual does not name, in every key of WINCNC.INI: UNKNOWN for the jobs it touches, for no other.

The table of keys says which (``KeyRule.touches``); each kind has a job here that touches it, and one that does not.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from frontend.wincnc.test_ini import SAMPLES
from support.command import in_this_process

from gproof.frontend.wincnc.ini_keys import KEYS
from gproof.ir.machine import TOUCHES

INI = """\
unit=mm
axischar=XYZWC
axisspec=p0s0d0r100a6000
axisvel=r6000f1200
axisspec=p0s1d1r100a6000
axisvel=r6000f1200
axisspec=p0s2d2r200a3000
axisvel=r3000f600
axisspec=p0s3d3r200a3000
axisvel=r3000f600
axisspec=p0s4d4r50a3000
lolim=x-9y-9z-200w-200
hilim=x900y900z9w9
auxin=c8p2b2
auxout=c1p7b1
auxout=c3p7b2
"""
NEEDED = {"knifeangle": ("knifemode",), "torchbevel": ("thc",)}
"""Keys without which the one that is tested says nothing."""
VALUES = {"drillbank": "C1 N2", "arctype": "I0 M0", "softlim": "T1", "hibound": "X900"}
"""Other values than those of the sample: nothing else of the line is open."""
QUIET = "G90\nG92\nG0 X10 Y10\nG1 X20 Y15 F600\n"
"""Moves X and Y along lines: touches none of the kinds but those of every job that moves."""
JOBS = {
    "axis": QUIET + "G0 C5\n",
    "moves": QUIET,
    "limits": QUIET,
    "all": QUIET,
    "arcs": QUIET + "G2 X30 I5 J0\n",
    "cycles": QUIET + "G81 X30 Y30 Z-10 R-2 F100\n",
    "homing": QUIET + "G28 Z\n",
    "tools": QUIET + "M37 Z0\n",
    "workspaces.54": QUIET,
    **{f"workspaces.{n}": QUIET + f"G{n}\nG0 X20\n" for n in range(55, 60)},
    "compensation": QUIET + "G41 O0\n",
    "knife": QUIET + "L30\nG1 X40\n",
    "saw": QUIET + "L32\n",
    "torch": QUIET + "L37\nL38\n",
    "probe": QUIET + "L801\n",
    "stored": QUIET + "G53 P1\n",
    "drills": QUIET + "M11 D1\n",
}
OF_EVERY_JOB = ("moves", "limits", "all", "workspaces.54")
LEFT_OPEN = ("kept", "checked", "unmodelled")


def odd_letter(key: str) -> str:
    return next(letter for letter in "QJEGN" if letter not in KEYS[key].letters)


def machine_with(key: str, folder: Path) -> str:
    """WINCNC.INI with a letter too many in one key: behind its last line, or one that is there."""
    odd = f" {odd_letter(key)}3"
    there = next((line for line in reversed(INI.splitlines()) if line.startswith(f"{key}=")), None)
    if there is not None:
        text = INI.replace(there, there + odd)
    else:
        needed = "".join(f"{other}={SAMPLES[other]}\n" for other in NEEDED.get(key, ()))
        text = f"{INI}{needed}{key}={VALUES.get(key, SAMPLES[key])}{odd}\n"
    (folder / "WINCNC.INI").write_text(text, "utf-8")
    (folder / "CNC.MAC").write_text("", "utf-8")
    return text


def judged(job: str, folder: Path) -> tuple[dict[str, str], dict[str, str]]:
    """Verdicts by property, and severities by code."""
    (folder / "job.tap").write_text(job, "utf-8")
    (folder / "setup.toml").write_text(SETUP, "utf-8")
    words = ["check", "job.tap", "--machine", "WINCNC.INI", "--setup", "setup.toml", "--format", "json"]
    done = in_this_process(words, folder)
    assert done.out, done.err
    report = json.loads(done.out)
    verdicts = {name: one["verdict"] for name, one in report["properties"].items()}
    return verdicts, {one["code"]: one["severity"] for one in report["findings"]}


SETUP = """\
schema = "gproof-setup/1"
units = "mm"
homed = ["x", "y", "z", "w", "c"]
active_work = 1
tool = 0
start = {x = 0, y = 0, z = 0, w = 0, c = 0}
g92 = {x = 0, y = 0, z = 0, w = 0, c = 0}

[positions.P1]
x = 5
y = 5
lift = false
"""
WITH_LETTERS = [key for key, rule in KEYS.items() if rule.letters or (rule.named.form == "axes" and key != "axischar")]


@pytest.mark.parametrize("key", WITH_LETTERS)
def test_a_letter_that_the_manual_lacks_touches_the_jobs_of_its_kind_alone(key: str, tmp_path: Path) -> None:
    text = machine_with(key, tmp_path)
    touches = KEYS[key].touches
    verdicts, codes = judged(QUIET, tmp_path)
    if touches in ("", "corners", "state"):
        assert codes.get("GP602") == "warning", (text, codes)
        assert "GP605" not in codes
        assert set(verdicts.values()) == {"SAFE"}
        return
    if touches not in OF_EVERY_JOB:
        assert "GP605" not in codes, text
        assert set(verdicts.values()) == {"SAFE"}, (text, codes)
    verdicts, codes = judged(JOBS[touches], tmp_path)
    assert codes.get("GP605") == "unknown", (text, codes)
    assert "error" not in codes.values(), codes
    assert verdicts["limits"] == "UNKNOWN"
    assert verdicts["areas"] == ("SAFE" if touches == "limits" else "UNKNOWN")


def test_every_key_that_is_followed_says_which_jobs_rest_on_it() -> None:
    known = {*TOUCHES, "", "all", "axis", "corners", "state"}
    for key, rule in KEYS.items():
        assert rule.touches.partition(".")[0] in known, key
        nothing_rests = rule.treatment in ("kept", "checked")
        assert not (nothing_rests and rule.touches), key
    quiet = {key for key, rule in KEYS.items() if rule.treatment == "modelled" and rule.letters and not rule.touches}
    # Their letters set pins, voltages, pulses and what an override may be: nothing that places rest on.
    assert quiet == {"auxin", "da", "g37", "laser", "laserscan", "override", "pumpcont", "spindle", "steppulse"}
    assert set(JOBS) >= {rule.touches for rule in KEYS.values()} - {"", "corners", "state"}


@pytest.mark.parametrize("line", ["axismap=s0e100m10", "arcs=m0\ng2modal=1", "arctype=i.5"])
def test_what_is_on_and_not_followed_touches_no_other_job(line: str, tmp_path: Path) -> None:
    machine_with("auxin", tmp_path)
    ini = tmp_path / "WINCNC.INI"
    ini.write_text(INI + line + "\n", "utf-8")
    _, codes = judged("G90\nG92\nG4 X1\n", tmp_path)
    assert "GP605" not in codes
    _, codes = judged(JOBS["arcs"], tmp_path)
    assert codes["GP605"] == "unknown"


def test_an_axis_without_its_line_is_refused_in_the_jobs_that_move_it(tmp_path: Path) -> None:
    machine_with("auxin", tmp_path)
    (tmp_path / "WINCNC.INI").write_text(INI.replace("axisspec=p0s4d4r50a3000\n", ""), "utf-8")
    verdicts, codes = judged(QUIET, tmp_path)
    assert (codes["GP604"], set(verdicts.values())) == ("note", {"SAFE"})
    verdicts, codes = judged(QUIET + "G0 C5\n", tmp_path)
    assert (codes["GP296"], verdicts["language"]) == ("error", "UNSAFE")


ABORTS = ["abort.mac", "M98 nothere.mac", "M12 C99", "?"]
"""What cmdabort= may hold that can not be run: a file's name, a file that is not there, no channel, no command."""


@pytest.mark.parametrize("key", ["cmdabort", "cmdstart", "cmdend"])
@pytest.mark.parametrize("command", ABORTS)
def test_a_command_of_the_machine_concerns_the_jobs_that_run_it(key: str, command: str, tmp_path: Path) -> None:
    machine_with("auxin", tmp_path)
    (tmp_path / "WINCNC.INI").write_text(f"{INI}{key}={command}\n", "utf-8")
    jobs = {QUIET: key != "cmdabort", QUIET + "M99.1\n": key != "cmdend", QUIET + 'G5 T1 M"Stop?"\n': True}
    for job, runs in jobs.items():
        verdicts, codes = judged(job, tmp_path)
        if not runs:
            assert set(verdicts.values()) == {"SAFE"}, (job, codes)
            continue
        # A name may be that of a file, which is not there: never refuted. The others are mistakes.
        assert verdicts["language"] == ("UNKNOWN" if command == "abort.mac" else "UNSAFE"), (job, codes)


@pytest.mark.parametrize(("key", "verdict"), [("cmdabort", "UNSAFE"), ("cmdend", "SAFE"), ("cmdstart", "UNKNOWN")])
def test_a_file_that_a_setting_names_is_followed_where_both_readings_are_judged(
    key: str, verdict: str, tmp_path: Path
) -> None:
    """Behind the job the file runs, or nothing does; before it the job rests on which of the two."""
    machine_with("auxin", tmp_path)
    (tmp_path / "WINCNC.INI").write_text(f"{INI}{key}=last.mac\n", "utf-8")
    (tmp_path / "last.mac").write_text("G53 X950\n" if key == "cmdabort" else "G53 X90\n", "utf-8")
    job = QUIET + ("M99.1\n" if key == "cmdabort" else "")
    verdicts, _ = judged(job, tmp_path)
    assert verdicts["limits"] == verdict
