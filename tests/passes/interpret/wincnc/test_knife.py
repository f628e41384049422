"""L30: the knife follows the path, is lifted and put down; what the manual leaves open is between its readings."""

from __future__ import annotations

import json
import math
import random
from pathlib import Path
from typing import Any

import pytest

from gproof.driver.judge import judge
from gproof.driver.pipeline import lower
from gproof.driver.running import begin
from gproof.driver.session import Running, Session, open_session
from gproof.ir.finding import Severity
from gproof.ir.verdict import Verdict
from gproof.report.trace_jsonl import chunk_lines
from gproof.verify.stream import validate

INI = """unit=MM
axischar=XYZC
axisspec=p0 s0 d0 r100 a6000 t1
axisvel=r6000 f3000
axisspec=p0 s1 d1 r100 a6000 t2
axisvel=r6000 f3000
axisspec=p0 s2 d2 r100 a6000 t3
axisvel=r3000 f1000
axisspec=p0 s3 d3 r10 a60000 t4
axisvel=r9000 f9000
vgroup=FXY
vgroup=XY
vgroup=Z
vgroup=C
lolim=X-500 Y-500 Z-60
hilim=X500 Y500 Z20
portout=7,0300
auxout=c2 p7 b6
"""
PLAIN = "t0 a30 l0 n3 z5 p-2 m0 r0"
ROOM = "[axes.c]\nmin = -100000\nmax = 100000\n"


def opened(tmp_path: Path, text: str, knife: str = PLAIN, more: str = "", own: str = ROOM, head: str = INI) -> Session:
    line = f"knifemode={knife}\n" if knife else ""
    (tmp_path / "WINCNC.INI").write_text(f"{head}{line}{more}")
    (tmp_path / "CNC.MAC").write_text("")
    (tmp_path / "m.toml").write_text(f'schema = "gproof-machine/1"\nunits = "mm"\nbase = "WINCNC.INI"\n{own}')
    job = tmp_path / "job.tap"
    job.write_text(text)
    return open_session(job, machine=tmp_path / "m.toml", setup="zero", dialect=None)


def rows_of(session: Session) -> list[dict[str, Any]]:
    """Rows of moves and dwells; `at`: (low, high) by axis."""
    assert session.program is not None
    ex = begin(session.program, session.setup, session.machine, session.findings)
    found = []
    for chunk in ex.chunks():
        for n, line in enumerate(chunk_lines(chunk, session.machine, "job.tap")):
            row = json.loads(line)
            if "to" in row:
                frame = chunk.trace.frames[int(chunk.rows["frame"][n])]
                row["at"] = {}
                for name, k in (("x", 0), ("y", 1), ("z", 2), ("c", 5)):
                    low = high = row["to"][name]
                    for symbol, times in frame[k]:
                        ends = chunk.trace.symbols.get(symbol)
                        low += -math.inf if ends is None else min(ends.low * times, ends.high * times)
                        high += math.inf if ends is None else max(ends.low * times, ends.high * times)
                    row["at"][name] = (low, high)
            found.append(row)
    return [row for row in found if row["op"] in ("traverse", "feed", "arc", "dwell")]


def boxes(tmp_path: Path, text: str, knife: str = PLAIN, more: str = "") -> list[tuple[tuple[float, float], ...]]:
    rows = rows_of(opened(tmp_path, text, knife, more))
    return [tuple((round(a, 6), round(b, 6)) for a, b in row["at"].values()) for row in rows if "at" in row]


def bad(session: Session) -> dict[str, str]:
    return {f.code.label: f.message for f in session.findings.kept if f.severity in (Severity.ERROR, Severity.UNKNOWN)}


def test_the_knife_points_along_the_path(tmp_path: Path) -> None:
    session = opened(tmp_path, "G90\nL30\nG0 X10 Y10\nG1 X20\nY30\nG3 X10 Y40 I-10 J0\nL31\nG1 X0\n", "t0 a20 n3 c2 m1")
    found = [tuple(round(row["to"][name], 6) for name in "xyc") for row in rows_of(session)]
    assert bad(session) == {}
    # Along +X at 0; then up Y: a quarter turn at the corner; the arc turns it by another quarter; L31 leaves it there.
    ends = [(10, 10, 0), (20, 10, 0), (20, 10, 90), (20, 30, 90), (10, 40, 180), (0, 40, 180)]
    assert list(dict.fromkeys(found)) == ends


# ---- what nobody can follow


@pytest.mark.parametrize(
    ("knife", "more", "reason"),
    [
        ("", "", "GP285"),
        ("n2 z5 p-1", "", "which is not an axis of its own"),
        ("n1 z5 p-1", "", "which is not an axis of its own"),
        (PLAIN, "knifeangle=a45\n", "a tilted blade"),
        (PLAIN, "knifeangle=m1\n", "a tilted blade"),
        (PLAIN, "knifeangle=a0 x1\n", "a blade off its axis"),
    ],
)  # fmt: skip
def test_knives_that_are_not_followed(tmp_path: Path, knife: str, more: str, reason: str) -> None:
    session = opened(tmp_path, "G90\nL30\nG1 X20\n", knife, more)
    rows_of(session)
    assert any(reason in f"{label} {message}" for label, message in bad(session).items()), bad(session)


def test_the_axis_has_to_turn(tmp_path: Path) -> None:
    session = opened(tmp_path, "G90\nL30\nG1 X20\n", own="", head=INI.replace("a60000 t4", "a6000 t3"))
    rows_of(session)
    assert "which counts lengths" in bad(session)["GP113"]


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("L30\nG1 X20\nG1 X30 C5", "the program turns C itself"),
        ("L300 Z\nL30\nG1 Y20", "while L300 locks"),
        ("L300 C\nL30\nG1 Y20", "while L300 locks"),
        ("L13 XZ\nL30\nG1 Y20", "while L13 couples"),
        ("L30\nG51 Z2\nG1 Y20", "while G51 scales"),
        ("M28 G0 C50\nL30\nG1 Y20", ""),
    ],
)  # fmt: skip
def test_what_can_not_be_followed_is_told(tmp_path: Path, text: str, reason: str) -> None:
    session = opened(tmp_path, f"G90\nG1 Z-2\n{text}\nG1 X40\n")
    rows_of(session)
    assert (reason in bad(session).get("GP323", "")) if reason else bad(session) == {}, bad(session)


@pytest.mark.parametrize(
    ("knife", "reason"),
    [("n3 a30 p-2 r0", "the lift height"), ("n3 a30 z5 r0", "the cutting depth")],
)  # fmt: skip
def test_settings_that_are_missing(tmp_path: Path, knife: str, reason: str) -> None:
    session = opened(tmp_path, "G90\nL30\nG1 X10\nY10\n", knife)
    rows_of(session)
    assert reason in bad(session)["GP323"]
    session = opened(tmp_path, "G90\nL30.1 Z5 P0\nL30\nG1 X10\nY10\n", knife)
    rows_of(session)
    assert bad(session) == {}


def test_without_an_angle_it_may_lift_at_any_turn(tmp_path: Path) -> None:
    found = boxes(tmp_path, "G90\nG1 Z-2\nL30\nG1 X10\nG1 X20 Y1\n", "n3 z5 p-2")
    assert [row[2] for row in found] == [(-2, -2), (-2, -2), (-2, 5), (-2, 5), (-2, -2), (-2, -2)]


# ---- where lifts count from


def test_positions_of_the_machine_or_of_the_work(tmp_path: Path) -> None:
    text = "G90\nG0 Z-20\nG92 Z0\nG1 Z-2\nL30\nG1 X20\nY20\n"
    for own, top, bottom in (
        ("machine", (5, 5), (-22, -2)), ("work", (-15, -15), (-22, -22)), ("", (-15, 5), (-22, -2))
    ):  # fmt: skip
        stated = f'[controls]\nknife_positions = "{own}"\n' if own else ""
        session = opened(tmp_path, text, own=ROOM + stated)
        found = [row["at"]["z"] for row in rows_of(session) if row["line"] == 7]
        assert found == [top, top, bottom, bottom] and bad(session) == {}
    # A zero that nobody knows.
    (tmp_path / "s.toml").write_text('schema = "gproof-setup/1"\nunits = "mm"\n[start]\nz = 0\nc = 0\n')
    for own in ("", "work"):
        stated = f'[controls]\nknife_positions = "{own}"\n' if own else ""
        opened(tmp_path, "G90\nG1 Z-2\nL30\nG1 X20\nY20\n", own=ROOM + stated)
        unknown = open_session(
            tmp_path / "job.tap", machine=tmp_path / "m.toml", setup=str(tmp_path / "s.toml"), dialect=None
        )  # fmt: skip
        rows_of(unknown)
        assert ("an unknown zero" in bad(unknown).get("GP323", "")) is not bool(own), bad(unknown)


# ---- verdicts


@pytest.mark.parametrize(
    ("knife", "more", "verdict", "code"),
    [
        (PLAIN, "", Verdict.SAFE, ""),
        ("t0 a30 n3 z25 p-2", "", Verdict.UNSAFE, "GP301"),  # up past the limit 20
        ("t0 a30 n3 z5 p-2", "hibound=z4\n", Verdict.UNSAFE, "GP330"),
        ("t0 a30 n3 z5 p-70", "", Verdict.UNKNOWN, "GP304"),  # down to -70 or back to -2
        ("t0 a30 n3 z25 p-2 m1", "", Verdict.UNSAFE, "GP301"),
        ("t1 a30 n3 z25 p-2", "", Verdict.UNKNOWN, "GP304"),  # whether it lifts on the way is not said
        ("t1 a30 n3 z5 p-2", "", Verdict.SAFE, ""),
        ("t0 a30 l3 n3 z5 p-2", "", Verdict.SAFE, ""),
    ],
)  # fmt: skip
def test_verdicts(tmp_path: Path, knife: str, more: str, verdict: Verdict, code: str) -> None:
    session = opened(tmp_path, "G90\nG1 Z-2\nL30\nG1 X20\nY20\nL31\n", knife, more)
    found = judge(session, running=Running())
    labels = {f.code.label for f in found.findings.kept if f.severity in (Severity.ERROR, Severity.UNKNOWN)}
    assert found.verdict is verdict and (code in labels if code else labels == set()), labels
    said = [text for known in found.properties for text in known.assumptions]
    assert any("points along +X" in text for text in said)


# ---- gproof's own [knife] in place of knifemode=


def test_a_knife_of_the_own_file_replaces_it(tmp_path: Path) -> None:
    own = ROOM + '[knife]\naxis = "c"\nangle = 20\nlift = 7\n'
    session = opened(tmp_path, "G90\nG1 Z-2\nL30\nG1 X20\nY20\nL31\n", own=own)
    low = judge(session, running=Running())
    assert low.verdict is Verdict.SAFE
    assert [box for box in low.summary.box if box[0] == "z"] == [("z", "", -2.0, 5.0)]


# ---- streams


STREAMS = {
    "square": "G0 X10 Y10\nG1 Z-2 F300\nL30\nG1 X60 F1200\nY40\nX10 Y30\nY10\nL31\nG0 Z5\n",
    "arcs": "G0 X10 Y10\nG1 Z-2 F300\nL30\nG1 X20 F600\nG3 X20 Y30 I0 J10 F600\nG1 X10\nG2 I0 J5\nG1 Y10\nL31\nG0 Z5\n",
    "spiral": "G1 Z-2\nL30\nG1 X20 F600\nX30 Y3\nX35 Y12\nX33 Y20\nX20 Y25\nX0 Y22\nX-8 Y10\nX-4 Y1\nX20 Y0\n",
}


@pytest.mark.parametrize("name", STREAMS)
def test_what_is_determined_is_stepped_and_validated(tmp_path: Path, name: str) -> None:
    session = opened(tmp_path, f"G90\n{STREAMS[name]}")
    lowered = lower(session, Running(), "stream")
    assert lowered.stream is not None and lowered.trace is not None, session.findings.kept
    report = validate(lowered.stream, lowered.trace, session.machine, session.setup)
    assert report.verdict is Verdict.SAFE, report.findings
    # C is a motor like the others: ten steps a degree, from 0 to where the last cut points.
    (section,) = lowered.stream.sections
    turned = {m.axis: n for n, m in enumerate(lowered.stream.motors)}[5]
    assert section.runs[turned]["count"].sum() >= 10 * 200


@pytest.mark.parametrize(
    ("knife", "text", "code", "what"),
    [
        ("t0 a30 n3 c2", "G1 X20\nY20\n", "GP520", "an output lifts the knife"),
        ("t1 a30 n3 z5 p-2", "G1 X20\nY1\n", "GP503", "depends on"),
        ("t1 a170 n3 z5 p-2", "G1 X20\n", "GP520", "while X and Y move"),
        ("t0 a30 l1 n3 z5 p-2", "G1 X20\nX40 Y1\n", "GP520", "blended"),
        ("t0 a30 n3 z5 p-2", "G3 X20 Y20 I0 J20\n", "GP503", "depends on"),
        ("t0 a30 n3 z5 p-2 m1", "G1 X20\nG0 X0\n", "GP503", "depends on"),
    ],
)  # fmt: skip
def test_what_is_not_is_refused(tmp_path: Path, knife: str, text: str, code: str, what: str) -> None:
    session = opened(tmp_path, f"G90\nG1 Z-2\nL30\n{text}", knife)
    assert lower(session, Running(), "stream").stream is None
    assert any(f.code.label == code and what in f.message for f in session.findings.kept), session.findings.kept


# ---- the same job, written otherwise


def random_lines(rng: random.Random, count: int = 10) -> list[tuple[str, float, float]]:
    lines = []
    for _ in range(count):
        kind = rng.choice(["G1", "G1", "G1", "G0"])
        lines.append((kind, round(rng.uniform(-40, 40), 3), round(rng.uniform(-40, 40), 3)))
    return lines


def near(one: list[Any], other: list[Any], turned: float = 0.0) -> bool:
    """The same boxes; the knife of the second turned by so many degrees, the first turn to it left out."""
    return len(one) == len(other) and all(
        abs(a - b + (turned if axis == 3 else 0.0)) < 1e-3
        for left, right in zip(one, other, strict=True)
        for axis, (p, q) in enumerate(zip(left, right, strict=True))
        for a, b in zip(p, q, strict=True)
    )


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("knife", [PLAIN, "t0 a30 n3 z5 p-2 m1", "t1 a30 n3 z5 p-2", "t0 a30 n3 z5 p-1"])
def test_other_spellings_turn_it_the_same_way(seed: int, knife: str, tmp_path: Path) -> None:
    rng = random.Random(seed)
    lines = random_lines(rng)
    absolute = "G90\nG1 Z-2\nL30\n" + "".join(f"{k} X{x} Y{y}\n" for k, x, y in lines) + "L31\n"
    plain = boxes(tmp_path, absolute, knife)
    # The settings of the file said again; an expression in each line, which no table holds.
    p = knife.split("p")[1].split(maxsplit=1)[0]
    again = absolute.replace("L30\n", f"L30.1 A30 Z5 P{p}\nL30\n")
    assert boxes(tmp_path, again, knife) == plain
    braced = absolute.replace(" X", " X{0+").replace(" Y", "} Y")
    assert boxes(tmp_path, braced, knife) == plain
    # In inches, and step by step from where it is.
    inches = "G20\nG90\nG1 Z{-2/25.4}\nL30\n"
    inches += "".join(f"{k} X{{{x}/25.4}} Y{{{y}/25.4}}\n" for k, x, y in lines) + "L31\n"
    assert near(boxes(tmp_path, inches, knife), plain)
    steps, at = "G91\nG1 Z-2\nL30\n", (0.0, 0.0)
    for k, x, y in lines:
        steps += f"{k} X{x - at[0]:.9f} Y{y - at[1]:.9f}\n"
        at = x, y
    assert near(boxes(tmp_path, steps + "L31\n", knife), plain)
    # Each cut in two: no turn where it was cut in two.
    at, halves = (0.0, 0.0), "G90\nG1 Z-2\nL30\n"
    for k, x, y in lines:
        halves += f"{k} X{(at[0] + x) / 2:.9f} Y{(at[1] + y) / 2:.9f}\n{k} X{x} Y{y}\n"
        at = x, y
    if "t1" not in knife:
        more = boxes(tmp_path, halves + "L31\n", knife)
        assert len(more) == len(plain) + len(lines)
        assert {tuple(row[2:]) for row in more} == {tuple(row[2:]) for row in plain} or near(
            sorted({row[2:] for row in more}), sorted({row[2:] for row in plain}), 0.0
        )


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("knife", [PLAIN, "t0 a30 n3 z5 p-2 m1", "t1 a30 n3 z5 p-2"])
def test_a_rotated_job_turns_it_from_a_rotated_place(seed: int, knife: str, tmp_path: Path) -> None:
    rng = random.Random(100 + seed)
    by = rng.choice([37.0, -112.5, 90.0])
    cuts = "".join(f"{k} X{x} Y{y}\n" for k, x, y in random_lines(rng, 8))
    head = "G90\nG1 Z-2\n"
    plain = boxes(tmp_path, f"{head}L30\n{cuts}L31\n", knife)
    rotated = boxes(tmp_path, f"{head}G0 C{by}\nL30\nG52 I0 J0 A{by}\n{cuts}L31\n", knife)
    kept = [((0.0, 0.0), (0.0, 0.0), *row[2:]) for row in plain]
    other = [((0.0, 0.0), (0.0, 0.0), *row[2:]) for row in rotated if row[3] != (0.0, 0.0)]
    assert near(kept[1:], other[1:], by), (kept, other)


def test_findings_are_told_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from gproof.cli.main import main

    session = opened(tmp_path, "G90\nG1 Z-2\nL30\nG1 X20 C5\nG1 X40\nY20\nX0\nG2 X20 I10 J0\n")
    rows_of(session)
    assert [f.code.label for f in session.findings.kept if f.severity is Severity.UNKNOWN] == ["GP323"]
    words = ["dump", "--stage", "trace", "--format", "jsonl", str(tmp_path / "job.tap"), "--machine"]
    assert main([*words, str(tmp_path / "m.toml"), "--setup", "zero"]) in (1, 2)
    assert '"GP323"' in capsys.readouterr().out
