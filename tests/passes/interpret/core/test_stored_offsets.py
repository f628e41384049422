"""G92.3 with some of #5211 to #5216 known (Eding CNC manual 3.4.23): each axis has its own, and is judged by it.

Places are worked out on paper: every axis starts at 0, the limits are 100 to either side, all zeros are the machine's.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.command import Done, in_this_process

AXES = "xyzabc"
LINEAR = "xyz"
MACHINE = (
    'schema = "gproof-machine/1"\nunits = "mm"\n'
    + "".join(
        f"[axes.{a}]\nmin = -100.0\nmax = 100.0\nmax_velocity = 50.0\nmax_acceleration = 500.0\nsteps_per_unit = 100\n"
        for a in AXES
    )
    + '[controller]\ndialect = "eding"\n'
)
HEAD = "G17 G21 G90 G94 G40 G49 G54 G69 G50 G80 G98\n"


def setup(parameters: dict[int, float], in_force: dict[str, float] | None = None) -> str:
    """Everything is stated but #5211 to #5216, of which `parameters` has some."""

    def row(values: dict[str, float]) -> str:
        return "{" + ", ".join(f"{a} = {values.get(a, 0.0)}" for a in AXES) + "}"

    lines = [
        'schema = "gproof-setup/1"', f"homed = {json.dumps(list(AXES))}", f"start = {row({})}", "tool = 0",
        "active_work = 1", "tool_length = 0.0", f"g92 = {row(in_force or {})}", f"work.1 = {row({})}", "[parameters]",
        *(f"{number} = {value}" for number, value in parameters.items()),
    ]  # fmt: skip
    return "\n".join(lines) + "\n"


def run(folder: Path, job: str, state: str, command: str = "check", *words: str) -> Done:
    (folder / "machine.toml").write_text(MACHINE)
    (folder / "setup.toml").write_text(state)
    (folder / "job.cnc").write_text(f"{HEAD}{job}\nM30\n")
    return in_this_process([command, "job.cnc", "--machine", "machine.toml", "--setup", "setup.toml", *words], folder)


def report(folder: Path, job: str, state: str) -> tuple[str, dict[str, float | None], list[dict[str, object]]]:
    """Verdict, ends and findings."""
    found = json.loads(run(folder, job, state, "check", "--format", "json").out)
    return found["verdict"], found["summary"]["end"], found["findings"]


@pytest.mark.parametrize("restore", ["G92.3", "G92.2\nG92.3", "G92.3\nG92.3", "G92.3\nG92.2\nG92.3"])
@pytest.mark.parametrize("known", AXES)
def test_the_axis_whose_parameter_is_known_has_its_offset(known: str, restore: str, tmp_path: Path) -> None:
    word, state = known.upper(), setup({5211 + AXES.index(known): 7.0})
    verdict, end, _ = report(tmp_path, f"{restore}\nG0 {word}5", state)
    assert verdict == "SAFE" and end[known] == 12.0
    assert report(tmp_path, f"{restore}\nG0 {word}95", state)[0] == "UNSAFE"
    assert report(tmp_path, f"{restore}\nG0 {word}93", state)[0] == "SAFE"


@pytest.mark.parametrize("moved", AXES)
@pytest.mark.parametrize("known", AXES)
def test_another_axis_is_unknown_only_where_it_goes_with_its_offset(known: str, moved: str, tmp_path: Path) -> None:
    if known == moved:
        return
    state = setup({5211 + AXES.index(known): 7.0})
    word, own = moved.upper(), known.upper()
    number = 5211 + AXES.index(moved)
    verdict, end, findings = report(tmp_path, f"G92.3\nG0 {own}1\n{word}5", state)
    assert verdict == "UNKNOWN" and end[known] == 8.0
    (told,) = (f for f in findings if f["severity"] == "unknown")
    assert told["code"] == "GP304" and f"#{number}, which G92.3 brings back" in str(told["message"])
    assert told["line"] == 4 and "under [parameters]" in str(told["hint"])
    # What does not count from the offset is judged as ever, to the end.
    for free, place in ((f"G53 G0 {word}5", 5.0), (f"G91 G0 {word}5\nG90", 5.0), (f"G92.2\nG0 {word}5", 5.0)):
        verdict, end, _ = report(tmp_path, f"G92.3\nG0 {own}1\n{free}", state)
        assert verdict == "SAFE" and end[moved] == place and end[known] == 8.0
    assert report(tmp_path, f"G92.3\nG53 G0 {word}101", state)[0] == "UNSAFE"
    # An error of the known axis stays one beside what is not known.
    assert report(tmp_path, f"G92.3\nG0 {word}5 {own}95", state)[0] == "UNSAFE"


@pytest.mark.parametrize("moved", AXES)
def test_with_none_known_a_job_without_them_is_judged(moved: str, tmp_path: Path) -> None:
    word, state = moved.upper(), setup({})
    assert report(tmp_path, f"G92.3\nG53 G0 {word}5", state)[0] == "SAFE"
    assert report(tmp_path, f"G92.3\nG0 {word}5", state)[0] == "UNKNOWN"
    verdict, end, _ = report(tmp_path, f"G92.3\n#{5211 + AXES.index(moved)} = 3\nG92.3\nG0 {word}5", state)
    assert verdict == "SAFE" and end[moved] == 8.0


@pytest.mark.parametrize("moved", AXES)
def test_what_the_parameter_says_counts_beside_an_offset_in_force(moved: str, tmp_path: Path) -> None:
    """#5211 can be written after G92: what is stated of it is no less than what is concluded from the offset."""
    word, number = moved.upper(), 5211 + AXES.index(moved)
    in_force = setup({number: 20.0}, dict.fromkeys(AXES, 50.0))
    assert report(tmp_path, f"G0 {word}5", in_force)[1][moved] == 55.0
    verdict, end, _ = report(tmp_path, f"G92.3\nG0 {word}5", in_force)
    assert verdict == "SAFE" and end[moved] == 25.0
    other = AXES[AXES.index(moved) - 1]
    assert report(tmp_path, f"G92.3\nG0 {other.upper()}5", in_force)[1][other] == 55.0


@pytest.mark.parametrize("known", LINEAR)
def test_a_stream_needs_only_what_its_moves_count_from(known: str, tmp_path: Path) -> None:
    state = setup({5211 + AXES.index(known): 7.0})
    done = run(tmp_path, f"G92.3\nG0 {known.upper()}5", state, "compile", "-o", "job.gpx")
    assert done.exit == 0, done.out + done.err
    other = "y" if known == "x" else "x"
    done = run(tmp_path, f"G92.3\nG0 {other.upper()}5", state, "compile", "-o", "other.gpx")
    assert done.exit == 2 and not (tmp_path / "other.gpx").exists(), done.out + done.err


@pytest.mark.parametrize("known", LINEAR)
def test_a_zone_that_the_known_axis_clears_is_clear(known: str, tmp_path: Path) -> None:
    """Whatever the unknown offset of another axis is; where the known one may be in it, that decides and is unknown."""
    other = "y" if known == "x" else "x"
    zone = f'[[keep_out]]\nname = "vise"\n{known} = [50.0, 60.0]\n{other} = [-100.0, 100.0]\n'
    if known == "z":
        zone = '[[keep_out]]\nname = "vise"\nx = [-100.0, 100.0]\ny = [-100.0, 100.0]\nz = [50.0, 60.0]\n'
    state = setup({5211 + AXES.index(known): 7.0})
    for place, verdict in ((5, "SAFE"), (46, "UNSAFE")):
        (tmp_path / "setup.toml").write_text(state)
        (tmp_path / "job.cnc").write_text(f"{HEAD}G92.3\nG0 {known.upper()}{place}\n{other.upper()}5\nM30\n")
        (tmp_path / "machine.toml").write_text(MACHINE + zone)
        words = ["check", "job.cnc", "--machine", "machine.toml", "--setup", "setup.toml", "--format", "json"]
        areas = json.loads(in_this_process(words, tmp_path).out)["properties"]["areas"]
        assert areas["verdict"] == verdict, (known, place)
