"""`gproof fit`: values by hand, units, and one line for what can not be asked."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import pytest
from support.command import Done, in_this_process
from support.goldens import ROOT

MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = 0
max = 100
[axes.y]
min = -20
max = 60
backlash = 0.5
[[axes.y.slaves]]
min = -10
max = 60
[axes.z]
min = -50
max = 0
[axes.a]
min = -90
max = 90
[tools.1]
length = 12
diameter = 1e-9
"""
SETUP = """schema = "gproof-setup/1"
homed = ["x", "y", "z", "a"]
active_work = 1
tool = 1
start = {x = 0.0, y = 0.0, z = 0.0, a = 0.0}
g92 = {x = 0.0, y = 0.0, z = 0.0, a = 0.0}
"""
ANYWHERE = SETUP.replace("start = {x = 0.0, y = 0.0, z = 0.0, a = 0.0}\n", "")
JOB = "G21 G90 G17 G94 G40 G54 G43 H1\nG0 Z5\nG0 X-5 Y2\nG1 X30 Y-8 Z-1 F300\nG0 A45\nG0 Z5\nM30\n"
ONE_LINE = re.compile(r"gproof(?: \w+)?: error: [^\n]+\n\Z")


def put(folder: Path, job: str = JOB, machine: str = MACHINE, setup: str = SETUP) -> None:
    for name, text in (("job.cnc", job), ("machine.toml", machine), ("setup.toml", setup)):
        (folder / name).write_text(text, encoding="utf-8")


def fit(folder: Path, *more: str) -> Done:
    words = ["fit", "job.cnc", "--machine", "machine.toml", "--setup", "setup.toml", "--dialect", "eding"]
    return in_this_process([*words, *more], folder)


def report(folder: Path) -> dict[str, Any]:
    return json.loads(fit(folder, "--format", "json").out)


def test_ranges_by_hand(tmp_path: Path) -> None:
    """X: -5 … 30 in 0 … 100. Y: -8 … 2 in -10 … 60 of the slave less 0.5. Z with a tool of 12: 11 … 17. A: 45."""
    put(tmp_path, setup=SETUP + "[work.1]\nx = 3.0\ny = 0.0\nz = -20.0\na = 0.0\n")
    told = report(tmp_path)
    ranges = {one["name"]: (one["low"], one["high"]) for one in told["offsets"]}
    assert ranges == {"G54 X": (5.0, 70.0), "G54 Y": (-1.5, 57.5), "G54 Z": (-61.0, -17.0), "G54 A": (-135.0, 45.0)}
    assert (told["verdict"], told["kind"], told["complete"]) == ("UNSAFE", "ranges", True)
    x = told["offsets"][0]
    assert (x["fits"], x["short"], x["move"]) == (False, 2.0, {"low": 2.0, "high": 67.0})
    needs = {one["motor"]: (one["low"], one["high"]) for one in told["travel"]}
    # With the offsets as stated, from the start on: a motor with backlash needs as much more at both ends.
    assert needs == {"X": (-2.0, 33.0), "Y": (-8.5, 2.5), "Y2": (-8.5, 2.5), "Z": (-9.0, 0.0), "A": (0.0, 45.0)}
    assert told["smallest_machine"] == {"X": 35.0, "Y": 11.0, "Y2": 11.0, "Z": 9.0, "A": 45.0}


def test_text_says_what_to_type(tmp_path: Path) -> None:
    put(tmp_path, setup=SETUP + "[work.1]\nx = 3.0\ny = 0.0\nz = -20.0\na = 0.0\n")
    lines = fit(tmp_path).out.split("\n")
    assert lines[0] == "job.cnc: UNSAFE, the work zero is 2 mm short on G54 X"
    assert lines[1:5] == [
        "  safe for  G54 X     5.0000 ...  70.0000 mm   now 3.000    2.0000 short: move by +2.0000 ... +67.0000",
        "            G54 Y    -1.5000 ...  57.5000 mm   now 0.000    fits",
        "            G54 Z   -61.0000 ... -17.0000 mm   now -20.000  fits",
        "            G54 A  -135.0000 ...  45.0000 deg  now 0.000    fits",
    ]


def test_inches_are_rounded_inwards(tmp_path: Path) -> None:
    put(tmp_path, setup=SETUP + "[work.1]\nx = 3.0\ny = 0.0\nz = -20.0\na = 0.0\n")
    lines = fit(tmp_path, "--units", "inch").out.split("\n")
    # 5 and 70 mm are 0.196850... and 2.755905... inches.
    assert "G54 X     0.1969 ...  2.7559 inch  now 0.1181" in lines[1]


def test_without_offsets_there_are_some(tmp_path: Path) -> None:
    put(tmp_path)
    told = report(tmp_path)
    assert (told["verdict"], told["stated"], told["exit_code"]) == ("SAFE", None, 0)
    assert all(one["now"] is None and one["fits"] is None for one in told["offsets"])
    assert {tuple(t["symbol"] for t in one["relative_to"]) for one in told["travel"] if one["axis"] == "X"} == {
        (), ("work.1.x",)
    }  # fmt: skip


def test_an_offset_that_is_a_range(tmp_path: Path) -> None:
    put(tmp_path, setup=SETUP + "[work.1]\nx = [4.0, 80.0]\ny = [1.0, 2.0]\nz = -20.0\na = 0.0\n")
    x, y, *_ = report(tmp_path)["offsets"]
    assert (x["fits"], x["short"], x["move"]) == (False, 1.0, None)
    assert (y["fits"], y["move"]) == (True, {"low": -2.5, "high": 55.5})


def test_a_tool_length_that_is_a_range_holds_for_all_of_it(tmp_path: Path) -> None:
    setup = SETUP + "[tools.2]\nlength = [10.0, 14.0]\n"
    put(tmp_path, job=JOB.replace("H1", "H2"), setup=setup)
    z = next(one for one in report(tmp_path)["offsets"] if one["name"] == "G54 Z")
    assert (z["low"], z["high"]) == (-50.0 - 9.0, 0.0 - 19.0)


def test_moves_in_machine_coordinates_are_fixed(tmp_path: Path) -> None:
    put(tmp_path, job=JOB.replace("M30", "G53 G0 X90\nM30"))
    told = report(tmp_path)
    assert next((o["low"], o["high"]) for o in told["offsets"] if o["name"] == "G54 X") == (5.0, 70.0)
    put(tmp_path, job=JOB.replace("M30", "G53 G0 X101\nM30"))
    told = report(tmp_path)
    assert (told["kind"], told["verdict"]) == ("none", "UNSAFE")
    assert [f["code"] for f in told["findings"]] == ["GP301"]


def test_a_path_that_depends_on_the_offset_is_unknown(tmp_path: Path) -> None:
    job = JOB.replace("M30", "G53 G0 X[#5221 * 2]\nM30")
    put(tmp_path, job=job)
    told = report(tmp_path)
    assert (told["kind"], told["verdict"], told["offsets"]) == ("unknown", "UNKNOWN", [])
    assert "#5221" in told["findings"][0]["message"]
    put(tmp_path, job=job, setup=SETUP + "[work.1]\nx = 10.0\ny = 0.0\nz = -20.0\na = 0.0\n")
    told = report(tmp_path)
    assert (told["kind"], told["verdict"], told["stated"]) == ("unknown", "SAFE", "SAFE")
    assert fit(tmp_path).exit == 0
    assert "other work zeros are not known" in fit(tmp_path).out


def test_a_job_too_long_for_the_machine(tmp_path: Path) -> None:
    put(tmp_path, job=JOB.replace("X30", "X96"))
    told = report(tmp_path)
    assert (told["kind"], told["verdict"], told["exit_code"]) == ("none", "UNSAFE", 1)
    assert told["smallest_machine"]["X"] == 101.0
    assert "no work offset changes that" in fit(tmp_path).out


def test_limits_that_are_not_given_are_open_and_named(tmp_path: Path) -> None:
    put(tmp_path, machine=MACHINE.replace("min = 0\nmax = 100\n", "max = 100\n"))
    told = report(tmp_path)
    x = told["offsets"][0]
    assert (told["verdict"], told["exit_code"], x["low"], x["high"]) == ("UNKNOWN", 2, None, 70.0)
    out = fit(tmp_path).out
    assert "UNKNOWN, because travel limits are missing" in out
    assert re.search(r"G54 X +any \.\.\. +70\.0000 mm", out)
    assert "The machine file gives no lower travel limit for X: no limit on that side" in out


def test_a_switch_that_is_not_stated_is_judged_both_ways(tmp_path: Path) -> None:
    put(tmp_path, job=JOB.replace("M30", "/G0 X60\nM30"))
    told = report(tmp_path)
    assert (told["offsets"][0]["low"], told["offsets"][0]["high"]) == (5.0, 40.0)
    assert max(one["high"] for one in told["travel"] if one["relative_to"]) >= 60.0


WRONG = [
    (["fit", "job.cnc"], "--machine"),
    (["fit", "missing.cnc", "--machine", "machine.toml"], "missing.cnc"),
    (["fit", "job.cnc", "--machine", "missing.toml"], "missing.toml"),
    (["fit", "job.cnc", "--machine", "."], "is a folder"),
    (["fit", "job.cnc", "--machine", "job.cnc"], "job.cnc"),
    (["fit", "job.cnc", "--machine", "machine.toml", "--setup", "nothing.toml"], "nothing.toml"),
    (["fit", "job.cnc", "--machine", "machine.toml", "--setup", "."], "is a folder"),
    (["fit", "job.cnc", "--machine", "machine.toml", "--dialect", "fanuc"], "fanuc"),
    (["fit", "job.cnc", "--machine", "machine.toml", "--format", "sarif"], "sarif"),
    (["fit", "job.cnc", "--machine", "machine.toml", "--units", "yards"], "yards"),
    (["fit", "job.cnc", "--machine", "machine.toml", "--max-blocks", "0"], "0"),
    (["fit", "job.cnc", "--machine", "machine.toml", "--call", "nothing"], "nothing"),
    (["fit", "machine.toml", "--machine", "machine.toml"], "is not a program"),
    (["fit", "--machine", "machine.toml"], "JOB"),
    (["fit", "job.cnc", "job.cnc", "--machine", "machine.toml"], "job.cnc"),
    (["fit", "job.cnc", "--machine", "machine.toml", "--where"], "--where"),
    (["fit", "job.cnc", "--machine", "machine.toml", "--machine", "missing.toml"], "missing.toml"),
    (["fit", "job.cnc", *["--machine", "machine.toml"] * 2, "--picture", "p.svg"], "one machine"),
    (["fit", "job.cnc", "--machine", "machine.toml", "--picture", "job.cnc"], "would overwrite an input"),
    (["fit", "job.cnc", "--machine", "machine.toml", "--picture", "no/p.svg"], "no such folder"),
    (["fit", "job.cnc", "--machine", "machine.toml", "--picture", "p.png"], "p.svg"),
    (["fit", "job.cnc", "--machine", "machine.toml", "--picture", "."], "is a folder"),
]


@pytest.mark.parametrize(("words", "named"), WRONG, ids=[" ".join(words) for words, _ in WRONG])
def test_wrong_words_are_one_line(words: list[str], named: str, tmp_path: Path) -> None:
    put(tmp_path)
    done = in_this_process(words, tmp_path)
    assert done.exit == 3
    assert done.out == ""
    assert ONE_LINE.search(done.err), done.err
    assert named in done.err


def test_a_job_that_can_not_be_read_as_a_program(tmp_path: Path) -> None:
    put(tmp_path, job="")
    told = report(tmp_path)
    assert told["kind"] in ("none", "unknown")
    assert told["exit_code"] in (1, 2)


def test_several_machines_in_one_table(tmp_path: Path) -> None:
    put(tmp_path, setup=SETUP + "[work.1]\nx = 75.0\ny = 0.0\nz = -20.0\na = 0.0\n")
    (tmp_path / "long.toml").write_text(MACHINE.replace("max = 100", "max = 900"), encoding="utf-8")
    (tmp_path / "short.toml").write_text(MACHINE.replace("max = 100", "max = 30"), encoding="utf-8")
    words = [word for name in ("machine", "long", "short") for word in ("--machine", f"{name}.toml")]
    done = in_this_process(["fit", "job.cnc", *words, "--setup", "setup.toml", "--dialect", "eding"], tmp_path)
    assert done.exit == 0
    assert done.out.split("\n")[:3] == [
        "job.cnc: 1 of 3 machines can run it, 1 more with another work zero",
        "  machine.toml  UNSAFE  the work zero is 5 mm short on G54 X; room for the zero: "
        "X 65.000, Y 59.000, Z 44.000, A 180.000 deg",
        "  long.toml     SAFE    the work zero can stay where it is; room for the zero: "
        "X 865.000, Y 59.000, Z 44.000, A 180.000 deg",
    ]
    # The shortest one: 35 mm do not go into 30.
    assert re.match(r"  short.toml    UNSAFE  GP303 .* spans 35.000 mm", done.out.split("\n")[3])
    words += ["--setup", "setup.toml", "--dialect", "eding", "--format", "json"]
    told = json.loads(in_this_process(["fit", "job.cnc", *words], tmp_path).out)
    assert (told["schema"], told["exit_code"]) == ("gproof-fit-several/1", 0)
    assert [(m["machine_file"], m["verdict"]) for m in told["machines"]] == [
        ("machine.toml", "UNSAFE"), ("long.toml", "SAFE"), ("short.toml", "UNSAFE")
    ]  # fmt: skip


AREA = """
[areas.tool_change]
x = [60, 100]
y = [-20, 60]
z = [-50, -20]
"""


def test_a_region_by_hand(tmp_path: Path) -> None:
    """The tool's Z is 12 above G54 Z: at 5 and at -1 of the job, which is 17 and 11 above it.

    It goes up from -1 at X30, which is the farthest place: X may be 60 - 30 at most where -1 is below -20, for G54 Z
    below -31. From there on all of the job is above the area; the limit of Z leaves up to -17.
    """
    put(tmp_path, machine=MACHINE + AREA, setup=SETUP + "[work.1]\nx = 45.0\ny = 0.0\nz = -35.0\na = 0.0\n")
    told = report(tmp_path)
    assert (told["kind"], told["verdict"], told["complete"]) == ("regions", "UNSAFE", True)
    (region,) = told["regions"]
    assert region["zones"] == ["the tool change area"]
    boxes = [tuple(box[axis][end] for axis in "xyz" for end in ("low", "high")) for box in region["boxes"]]
    assert set(boxes) == {(5.0, 30.0, -1.5, 57.5, -61.0, -17.0), (5.0, 70.0, -1.5, 57.5, -31.0, -17.0)}
    assert (region["now"], region["inside"]) == ([45.0, 0.0, -35.0], False)
    # 4 up is nearer than 15 to the left.
    assert region["nearest"] == [45.0, 0.0, pytest.approx(-30.999)]
    out = fit(tmp_path).out
    assert out.startswith("job.cnc: UNSAFE, with this work zero, moves enter the tool change area\n")
    assert "now outside; the nearest place is G54 X 45.000, G54 Y 0.000, G54 Z -30.999" in out


def test_a_zone_around_everything_leaves_nothing(tmp_path: Path) -> None:
    around = '[[keep_out]]\nname = "all"\nx = [-500, 500]\ny = [-500, 500]\n'
    # With the backlash of Y it is not certain that the tool enters, and the answer is UNKNOWN.
    put(tmp_path, machine=MACHINE + around)
    assert report(tmp_path)["reason"] == "no work offset was found that keeps all moves out of the zone all"
    put(
        tmp_path,
        machine=MACHINE.replace("backlash = 0.5\n", "") + around,
        setup=ANYWHERE,
    )
    told = report(tmp_path)
    assert (told["kind"], told["verdict"]) == ("none", "UNSAFE")
    assert told["reason"] == "no work offset keeps all moves out of the zone all"
    assert "because   no work offset keeps all moves out of the zone all" in fit(tmp_path).out


def test_without_a_start_one_side_of_a_zone_is_told(tmp_path: Path) -> None:
    """The first move may come from anywhere: only X below the zone as a whole is certain, the start as well."""
    put(tmp_path, machine=MACHINE + '[[keep_out]]\nname = "wall"\nx = [70, 100]\n', setup=ANYWHERE)
    told = report(tmp_path)
    assert (told["kind"], told["verdict"], told["complete"]) == ("regions", "SAFE", False)
    # 70 less 30, less the backlash by which zones grow, to within the resolution.
    (box,) = told["regions"][0]["boxes"]
    assert box["x"]["low"] == 5.0
    assert box["x"]["high"] == pytest.approx(39.5, abs=2e-3)
    (beside,) = [one for one in told["assumptions"] if one.endswith("clear of all zones")]
    assert beside.startswith("the start position of X is between 0.0000 and 69.5")


def test_a_zone_that_moves_with_the_work_asks_nothing(tmp_path: Path) -> None:
    """A clamp beside the part, in G54: wherever the part lies, the tool passes beside it."""
    clamp = '[[keep_out]]\nname = "clamp"\nwork = 1\nx = [40, 60]\ny = [-20, 20]\n'
    put(tmp_path, setup=ANYWHERE + clamp)
    told = report(tmp_path)
    assert told["kind"] in ("ranges", "regions", "unknown")
    assert told["verdict"] in ("SAFE", "UNKNOWN")


def test_the_picture_shows_the_region(tmp_path: Path) -> None:
    put(tmp_path, machine=MACHINE + AREA, setup=SETUP + "[work.1]\nx = 45.0\ny = 0.0\nz = -35.0\na = 0.0\n")
    assert fit(tmp_path, "--picture", "p.svg").exit == 1
    first = (tmp_path / "p.svg").read_text(encoding="utf-8")
    assert fit(tmp_path, "--picture", "p.svg").exit == 1
    assert (tmp_path / "p.svg").read_text(encoding="utf-8") == first
    root = ET.fromstring(first)
    space = "{http://www.w3.org/2000/svg}"
    texts = [element.text for element in root.iter(f"{space}text")]
    assert "UNSAFE" in texts
    assert [t for t in texts if t and t.startswith("G54 X, G54 Y")] == [
        "G54 X, G54 Y, with G54 Z -31 ... -17", "G54 X, G54 Y, with G54 Z -61 ... -31"
    ]  # fmt: skip
    green = [e for e in root.iter(f"{space}path") if e.get("fill") == "#2e7d32"]
    wide = []
    for element in green:
        x = [float(point.split()[0]) for point in element.get("d", "").strip("MZ").split("L")]
        wide.append(max(x) - min(x))
    # 5 ... 70 and 5 ... 30, at one scale.
    assert wide[0] / wide[1] == pytest.approx(65 / 25, rel=5e-3)
    front = next(t for t in texts if t and "from the front" in t and t.startswith("G54 X"))
    assert front.startswith("G54 X, G54 Z, from the front, at G54 Y")


def test_a_picture_of_ranges_alone_and_of_nothing(tmp_path: Path) -> None:
    put(tmp_path, setup=SETUP + "[work.1]\nx = 3.0\ny = 0.0\nz = -20.0\na = 0.0\n")
    fit(tmp_path, "--picture", "p.svg")
    drawn = (tmp_path / "p.svg").read_text(encoding="utf-8")
    assert "G54 X, G54 Y" in drawn
    assert "from the front" not in drawn  # Z fits
    put(tmp_path, setup=SETUP + "[work.1]\nx = 3.0\ny = 0.0\nz = -70.0\na = 0.0\n")
    fit(tmp_path, "--picture", "p.svg")
    assert "G54 X, G54 Z, from the front" in (tmp_path / "p.svg").read_text(encoding="utf-8")
    put(tmp_path, job=JOB.replace("X30", "X96"))
    fit(tmp_path, "--picture", "p.svg")
    assert "There is no region" in (tmp_path / "p.svg").read_text(encoding="utf-8")


def test_limits_are_drawn_where_they_are(tmp_path: Path) -> None:
    """Also where the zero that is stated lies outside of them; from the front only where Z does not fit."""
    for x, z in ((3.0, -70.0), (150.0, -20.0)):
        put(tmp_path, setup=SETUP + f"[work.1]\nx = {x}\ny = 0.0\nz = {z}\na = 0.0\n")
        fit(tmp_path, "--picture", "p.svg")
        paths = ET.parse(tmp_path / "p.svg").getroot().iter("{http://www.w3.org/2000/svg}path")
        drawn = [e.get("d", "") for e in paths if e.get("stroke-dasharray") == "9 4" and e.get("d", "").endswith("Z")]
        ratios = []
        for corners in drawn:
            points = [tuple(map(float, point.split())) for point in corners.strip("MZ").split("L")]
            wide, high = (max(p[n] for p in points) - min(p[n] for p in points) for n in (0, 1))
            ratios.append(wide / high)
        # X and Y are 100 by 80 mm, X and Z 100 by 50.
        assert ratios == pytest.approx([100 / 80, 100 / 50] if z < -50 else [100 / 80], rel=5e-3)


def corpus(words: str) -> dict[str, Any]:
    """The report for a job of the corpus."""
    return json.loads(in_this_process(["fit", *words.split(), "--format", "json"], ROOT / "corpus").out)


def test_the_table_of_a_mcuwin_machine_is_asked_for() -> None:
    """Four plates in G54 to G57: the machine file states the records, and each of them may lie elsewhere."""
    told = corpus(
        "mcuwin/engraver/jobs/four-plates.src --machine mcuwin/engraver/machine.toml --setup mcuwin/engraver/setup.toml"
    )
    names = [f"G{n} {axis}" for n in (54, 55, 56, 57) for axis in "XYZ"]
    assert [one["name"] for one in told["offsets"]] == names
    stated = {one["name"]: one["now"]["low"] for one in told["offsets"]}
    assert [stated[f"G{n} X"] for n in (54, 55, 56, 57)] == [-80.0, 20.0, -80.0, 20.0]
    spans = {one["high"] - one["low"] for one in told["offsets"] if one["name"].endswith("X")}
    assert len(spans) == 1  # the same plate in each of them
    assert told["verdict"] == "SAFE"


def test_local_coordinates_of_wincnc_are_asked_for() -> None:
    told = corpus("wincnc/plasma/jobs/gussets.tap --machine wincnc/plasma/WINCNC.INI --setup wincnc/plasma/setup.toml")
    assert [one["name"] for one in told["offsets"]] == ["G92 X", "G92 Y"]
    assert told["verdict"] == "SAFE"
