"""`gproof resume`: a program that goes on in the middle; what is left of the job is compared line by line, by hand.

`places` walks a program of plain words on its own: no row of gproof's Trace is asked what a line does.
"""

from __future__ import annotations

import errno
import json
import os
import random
import re
import tomllib
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest
from support.campaigns import sizes
from support.command import Done, in_this_process

from gproof.backend import journal as journals
from gproof.backend import runtime
from gproof.driver import resume as resuming
from gproof.verify.certificate.keys import create_key

AXIS = "\nmin = {low}\nmax = {high}\nsteps_per_unit = 100\nmax_velocity = 50\nmax_acceleration = 2000\n"
MACHINE = 'schema = "gproof-machine/1"\nunits = "mm"\n' + "".join(
    f"[axes.{axis}]" + AXIS.format(low=low, high=high)
    for axis, low, high in (("x", -200, 200), ("y", -200, 200), ("z", -50, 60))
)
PART = """(a part)
G21 G90 G17
G64 P0.05
T2
S8000 M3
G4 P0.5
M8
G0 Z20
X10 Y10
G1 Z-1 F300
X50 F600
Y50
G91
X-10
Y-10
G90
X10
Y10
G0 Z20
M9
M5
M30
"""
SET = ("--machine", "machine.toml", "--setup", "zero")

Place = tuple[float, ...]


def places(lines: list[str]) -> Iterator[tuple[int, tuple[Place, float, str]]]:
    """(line, (machine place after it, feed, motion code)) of each line that moves; work zero is machine zero."""
    at, absolute, motion, feed = [0.0, 0.0, 0.0], True, "", 0.0
    for number, text in enumerate(lines, 1):
        words = re.findall(r"([A-Z])([+-]?[\d.]+)", re.sub(r"\(.*?\)", "", text))
        codes = [value for letter, value in words if letter == "G"]
        absolute = "90" in codes or (absolute and "91" not in codes)
        motion = next((code for code in codes if code in ("0", "1")), motion)
        feed = next((float(value) for letter, value in words if letter == "F"), feed)
        moved = False
        for letter, value in words:
            if letter in "XYZ":
                axis = "XYZ".index(letter)
                at[axis] = float(value) + (0 if absolute or "53" in codes else at[axis])
                moved = True
        if moved:
            yield number, (tuple(round(value, 6) for value in at), feed if motion == "1" else 0.0, motion)


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    (tmp_path / "config" / "gproof").mkdir(parents=True, mode=0o700)
    create_key(tmp_path / "config" / "gproof" / "signing-key.pem")
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "part.cnc").write_text(PART)
    return tmp_path


def resume(shop: Path, line: int, *more: str, out: str = "rest.cnc") -> Done:
    (shop / out).unlink(missing_ok=True)
    return in_this_process(["resume", "part.cnc", "--from-line", str(line), *SET, "-o", out, *more], shop)


def rest_of(text: str, line: int) -> list[tuple[Place, float, str]]:
    return [place for number, place in places(text.splitlines()) if number >= line]


def same(mine: list[tuple[Place, float, str]], job: list[tuple[Place, float, str]]) -> bool:
    return len(mine) == len(job) and all(
        a[1:] == b[1:] and all(abs(p - q) < 1e-5 for p, q in zip(a[0], b[0], strict=True))
        for a, b in zip(mine, job, strict=True)
    )


def test_from_each_line_the_rest_is_the_job_and_the_way_there_comes_from_above(shop: Path) -> None:
    at = dict(places(PART.splitlines()))
    for line in range(1, 23):
        done = resume(shop, line)
        assert done.exit == 0, (line, done.err)
        text = (shop / "rest.cnc").read_text()
        added = len(text.splitlines()) - (len(PART.splitlines()) - line + 1)
        own = [place for number, place in places(text.splitlines()) if number > added]
        assert same(own, rest_of(PART, line)), line
        there = [place for number, place in places(text.splitlines()) if number <= added]
        before = [place[0] for number, place in at.items() if number < line]
        here = before[-1] if before else (0.0, 0.0, 0.0)
        assert there[0][0][2] == 60, "up first"
        assert there[-1][0] == here, line
        # Across only while it is up, and the last of the way down no faster than the job went down.
        assert all(a[0][:2] == b[0][:2] or a[0][2] == b[0][2] == 60 for a, b in pairwise(there))
        assert all(feed <= 300 for place, feed, motion in there if motion == "1" and line < 18)
        head = "\n".join(text.splitlines()[:added])
        assert ("S8000 M3" in head) == (5 < line <= 21), line
        assert ("M8" in head) == (7 < line <= 20), line
        assert ("G4 P0.5" in text) == (line <= 21)


def test_the_new_program_is_checked_and_certified_anew(shop: Path) -> None:
    done = resume(shop, 12, "--package", "rest.gpx")
    assert done.exit == 0, done.err
    assert "rest.gpx: certified" in done.out
    assert in_this_process(["verify", "rest.gpx"], shop).exit == 0


@pytest.mark.parametrize(
    ("lines", "line", "why"),
    [
        (["G41 D1 X1 F100"], 4, "cutter radius compensation is on since line 2"),
        (["G92.3"], 3, "line 2: G92.3 cannot be taken up again"),
        (["M54 P1 E2"], 3, "line 2: M54 cannot be taken up again but with a number in P alone"),
        (["#1=[#2+3]", "G1 X#1 F100"], 4, "line 2: #2 has its value from outside of the job"),
        (["#1=3", "G1 X1 F[#1*100]"], 4, "F, S or T before line 4 is an expression"),
        (["/G0 X4"], 3, "line 2: a block that may be deleted"),
        (["G68 X0 Y0 R30"], 3, "the plane is rotated since line 2"),
        (["G2 X10 Y0 I5 J0 F100", "X20 I5"], 3, "line 3 continues an arc of line 2"),
        (["G95 F0.1"], 3, "the feed is not in units a minute"),
    ],
)
def test_what_is_not_supported_is_refused_by_name(shop: Path, lines: list[str], line: int, why: str) -> None:
    (shop / "part.cnc").write_text("\n".join(["G21 G90", *lines, "G0 X7", "G0 X8", "M30", ""]))
    done = resume(shop, line)
    assert done.exit == 3, done.out
    assert done.err.count("\n") == 1
    if "has errors" not in done.err:
        assert why in done.err
    assert not (shop / "rest.cnc").exists()


def test_what_runs_elsewhere_is_refused(shop: Path) -> None:
    (shop / "part.cnc").write_text("G21 G90\ngosub cut\nG0 X8\nM30\nsub cut\nG0 X5\nendsub\n")
    done = resume(shop, 3)
    assert (done.exit, (shop / "rest.cnc").exists()) == (3, False)
    for words, why in (
        (["--from-line", "99"], "line 6 is in a subprogram"),
        ([], "give one of --from-line and --from-journal"),
        (["--from-journal", "none"], "none"),
        (["--from-journal", "machine.toml"], "machine.toml: not a journal"),
        (["--from-line", "3", "--package", "./rest.cnc"], "output rest.cnc: the same file as --package"),
    ):
        done = in_this_process(["resume", "part.cnc", *words, *SET, "-o", "rest.cnc"], shop)
        assert done.exit == 3 and why in done.err, done.err
        assert not (shop / "rest.cnc").exists()


def test_nothing_is_under_the_name_before_it_is_compared(shop: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    there = []
    other = resuming._other
    monkeypatch.setattr(resuming, "_other", lambda *of: there.append((shop / "rest.cnc").exists()) or other(*of))
    assert resume(shop, 9).exit == 0
    assert there == [False]
    monkeypatch.setattr(Path, "write_text", full)
    done = resume(shop, 9)
    assert (done.exit, done.err) == (3, "gproof: error: output rest.cnc: No space left on device\n")
    assert sorted(place.name for place in shop.iterdir()) == ["config", "machine.toml", "part.cnc"]


def full(*_: object, **__: object) -> int:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def made_up(chance: random.Random) -> str:
    """A straight-line job, in both distance modes, some lines without a motion code."""
    lines = ["G21 G90 G61", "S5000 M3", "G0 Z10", "G1 Z-1 F2000"]
    for _ in range(chance.randrange(5, 14)):
        if chance.random() < 0.2:
            lines.append(chance.choice(["G90", "G91", "F1500", "M8", "M9"]))
        if chance.random() < 0.15:
            lines += ["G90", "G0 Z10", f"X{chance.randint(-40, 40)} Y{chance.randint(-40, 40)}", "G1 Z-1 F1800"]
        code = chance.choice(["G1 ", "", "G1 "])
        lines.append(f"{code}X{chance.randint(-9, 9)} Y{chance.randint(-9, 9)}.{chance.randint(0, 9)}")
    return "\n".join([*lines, "G90", "G0 Z10", "M5", "M30", ""])


@pytest.mark.parametrize("many", sizes(6, 100))
def test_after_a_loss_the_rest_is_machined_and_the_overlap_is_stated(
    many: int, shop: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runtime, "NOTED", 0.05)
    for seed in range(many):
        chance = random.Random(seed)
        job = made_up(chance)
        (shop / "part.cnc").write_text(job)
        for name in ("part.gpx", "rest.cnc"):
            (shop / name).unlink(missing_ok=True)
        assert in_this_process(["compile", "part.cnc", *SET, "-o", "part.gpx"], shop).exit == 0, job
        runs = f"runs{seed}"
        assert in_this_process(["run", "part.gpx", "--board", "virtual", "--runs", runs], shop).exit == 0
        (ended,) = (shop / runs).glob("*.ended")
        lines = ended.read_bytes().splitlines(keepends=True)
        entries = [json.loads(line[65:]) for line in lines]
        noted = [k for k, entry in enumerate(entries) if entry["kind"] == "at"]
        last = chance.choice(noted)
        path = ended.with_suffix(journals.SUFFIX)
        path.write_bytes(b"".join(lines[: last + 1]))
        words = ["resume", "part.cnc", "--from-journal", str(path), *SET, "-o", "rest.cnc"]
        done = in_this_process(words, shop)
        assert done.exit == 0, (seed, done.err, job)
        line = int(re.search(r"at line (\d+)", done.out)[1])  # type: ignore[index]
        assert f"line{'s' * (f'lines {line}' in done.out)} {line}" in done.out and "overlap" in done.out
        assert "home the machine" in done.out
        # What was left out was made: all steps of the lines before are among those that the board acknowledged.
        at, pulses = (0.0, 0.0, 0.0), [0, 0, 0]
        for number, (place, _, _) in places(job.splitlines()):
            if number < line:
                pulses = [n + round(abs(b - a) * 100) for n, a, b in zip(pulses, at, place, strict=True)]
                at = place
        assert all(n <= made + 1 for n, made in zip(pulses, entries[last]["steps"], strict=True)), (seed, line)
        # And what is left is machined.
        text = (shop / "rest.cnc").read_text()
        added = len(text.splitlines()) - (len(job.splitlines()) - line + 1)
        own = [place for number, place in places(text.splitlines()) if number > added]
        assert same(own, rest_of(job, line)), (seed, line, job)


def rest_text(shop: Path, lines: list[str], line: int) -> list[str]:
    (shop / "part.cnc").write_text("\n".join([*lines, ""]))
    done = resume(shop, line)
    assert done.exit == 0, done.err
    return (shop / "rest.cnc").read_text().splitlines()


def test_a_hole_of_a_row_is_taken_up_with_all_words_of_its_cycle(shop: Path) -> None:
    lines = ["G21 G90 G17", "S900 M3", "G0 X0 Y0 Z10", "G99 G82 X1 Y2 Z-1.5 R2 P0.2 F240", "N5 X5", "Y7", "G80", "M30"]
    # G99 leaves the tool at R, Z2, over the first hole; the whole way down to it was rapid.
    assert rest_text(shop, lines, 5) == [
        "(part.cnc from line 5, by gproof)", "G21 G90 G94 G40 G49 G80 G17", "G0 G53 Z60", "G99", "G0 G53 X1 Y2",
        "S900 M3", "G0 G53 Z2", "G1 G53 Z2 F240", "N5 G82 Z-1.5 R2 P0.2 X5", "Y7", "G80", "M30",
    ]  # fmt: skip


def test_zeros_are_stated_again_and_a_shift_from_where_the_axes_are_now(shop: Path) -> None:
    lines = ["G21 G90 G54", "G10 L2 P1 X120 Y90", "G53 G0 Z20", "G0 X1 Y1", "G92 X10", "G0 X15 Y3", "G0 X0", "M30"]
    # Machine X was 121 when it was called 10, so it is 126 at line 7, which is called 15.
    assert rest_text(shop, lines, 7) == [
        "(part.cnc from line 7, by gproof)", "G21 G90 G94 G40 G49 G80 G17", "G10 L2 P1 X120 Y90", "G54", "G0 G53 Z60",
        "G0 G53 X126 Y93", "G0 G53 Z20", "G0 G53 Z20", "G92 X15", "G0 X0", "M30",
    ]  # fmt: skip


def test_outputs_and_variables_are_taken_up_after_the_way_across(shop: Path) -> None:
    lines = ["G21 G90", "#1=3", "#2=[#1*2]", "M54 P1", "M54 P2", "M55 P2", "G0 X[#2+1] Y#1", "G0 X#2", "M30"]
    assert rest_text(shop, lines, 8) == [
        "(part.cnc from line 8, by gproof)", "#1=3", "#2=[#1*2]", "G21 G90 G94 G40 G49 G80 G17", "G0 G53 Z60",
        "G0 G53 X7 Y3", "M54 P1", "M55 P2", "G0 G53 Z0", "G0 G53 Z0", "G0 X#2", "M30",
    ]  # fmt: skip


def test_a_shift_or_a_zero_that_the_run_may_have_reached_is_not_forgotten(shop: Path) -> None:
    assert "G92.1" in rest_text(shop, ["G21 G90", "G0 X1", "G0 X2", "G92 X0", "G0 X5", "M30"], 3)
    (shop / "part.cnc").write_text("G21 G90\nG0 X1\nG0 X2\nG10 L2 P1 X5\nG0 X5\nM30\n")
    assert "the run may have reached line 4, which stores others" in resume(shop, 3).out
    (shop / "part.cnc").write_text("G21 G90\nG0 X#1\nG0 X#1\n#1=4\nM30\n")
    assert "line 3 reads #1, which line 4 sets" in resume(shop, 3).err or "has errors" in resume(shop, 3).err


def test_a_line_before_that_can_is_named(shop: Path) -> None:
    (shop / "part.cnc").write_text("G21 G90\nG0 X7\nG2 X10 Y0 I1.5 J0 F100\nX20 I5\nM30\n")
    done = resume(shop, 4)
    assert "; line 3 can" in done.err and not (shop / "rest.cnc").exists()
    assert resume(shop, 3).exit == 0


def test_where_the_zero_is_not_known_the_way_there_is_said_in_work_coordinates(shop: Path) -> None:
    (shop / "setup.toml").write_text('schema = "gproof-setup/1"\nunits = "mm"\n')
    lines = ["G21 G90 G49", "G10 L2 P1 X7", "G0 G53 Z60", "G0 Z12", "G0 X5 Y6", "G1 Z1 F100", "G1 X9 F200", "Y9", "M30"]
    (shop / "part.cnc").write_text("\n".join([*lines, ""]))
    done = in_this_process(
        ["resume", "part.cnc", "--from-line", "8", "--machine", "machine.toml", "--setup", "setup.toml", "-o", "r.cnc"],
        shop,
    )
    assert done.exit == 0, done.err
    assert "from a zero that is not known" in done.out
    assert (shop / "r.cnc").read_text().splitlines() == [
        "(part.cnc from line 8, by gproof)", "G21 G90 G94 G40 G49 G80 G17", "G10 L2 P1 X7", "G0 G53 Z60",
        "G0 X9 Y6", "G0 Z12", "G1 Z1 F100", "F200", "Y9", "M30",
    ]  # fmt: skip


CORPUS = Path(__file__).resolve().parents[2] / "corpus" / "eding"
TAKEN_UP = (
    "drilled-plate",
    "bored-and-reamed",
    "drill-rows",
    "inch-bracket",
    "tapped-flange",
    "gantry-slave",
    "clamped-bracket",
)


@pytest.mark.parametrize("many", sizes(1, 30))
def test_at_lines_of_jobs_the_rest_has_the_places_of_the_job(many: int, tmp_path: Path) -> None:
    """What comes after the way there has the job's own text; in a row of holes its first line names the cycle again."""
    told = tomllib.loads((CORPUS / "expect.toml").read_text())
    for name in TAKEN_UP:
        chance, job = random.Random(name), CORPUS / name / "job.cnc"
        lines = job.read_text().splitlines()
        setup = told[name].get("setup", "zero")
        setup = setup if setup == "zero" else str(CORPUS / setup)
        taken = 0
        for _ in range(3 * many):
            line, out = chance.randint(1, len(lines) - 1), tmp_path / "rest.cnc"
            out.unlink(missing_ok=True)
            words = ["resume", str(job), "--from-line", str(line), "--machine", str(CORPUS / told[name]["machine"])]
            done = in_this_process([*words, "--setup", setup, "-o", str(out)], tmp_path)
            assert done.exit in (0, 3) and done.err.count("\n") == (done.exit == 3), done.err
            assert out.exists() == (done.exit == 0)
            if done.exit:
                assert "cannot go on at line" in done.err or "nothing of" in done.err, done.err
                continue
            taken += 1
            rest = out.read_text().splitlines()[-(len(lines) - line + 1) :]
            changed = [(a, b) for a, b in zip(lines[line - 1 :], rest, strict=True) if a != b]
            assert len(changed) <= 1
            for a, b in changed:
                named = re.search(r"G[78]\d(?: [ZRQP][-+.\d]+)* ", b)
                assert named and b.replace(named[0], "", 1) == a, (a, b)
                assert all(word in " ".join(lines[: line - 1]) for word in named[0].split()), (a, b)
        assert taken, name
