"""Pictures: well-formed whatever the job, honest about what is not known, nothing written over something else."""

from __future__ import annotations

import dataclasses
import math
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from corpus.expectations import around, expectation, jobs
from support.campaigns import seeds, share
from support.goldens import ROOT

from gproof.cli.main import main
from gproof.ir.columns import Columns
from gproof.ir.machine import NO_MACHINE, Tool
from gproof.ir.trace import TRACE_ROW, Chunk, Op, Plane, State, Trace
from gproof.passes.checks.registry import every_property
from gproof.report.picture import path_points
from gproof.report.picture.path_points import PathPoints
from gproof.report.picture.words import wide, wrapped

JOBS = [job.parent for job in jobs("eding") if job.parent.name != "raster-surface"]
SVG = "{http://www.w3.org/2000/svg}"
MACHINE = str(ROOT / "corpus" / "eding" / "drilled-plate" / "machine.toml")
HEAD = "G21 G17 G90 G94 G40 G49 G80 G54\n"


def draw(words: list[str], to: Path) -> ET.Element:
    main(["check", *words, "--picture", str(to)])
    return ET.parse(to).getroot()


def texts(root: ET.Element) -> list[str]:
    return [element.text or "" for element in root.iter(f"{SVG}text")]


def program(folder: Path, text: str) -> str:
    path = folder / "job.cnc"
    path.write_text(text, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("folder", share(JOBS, 3), ids=lambda folder: folder.name)
def test_every_corpus_job_can_be_drawn(folder: Path, tmp_path: Path) -> None:
    job = folder / "job.cnc"
    expect = expectation(job)
    words = [str(job), *around(job)]
    root = draw(words, tmp_path / "job.svg")
    said = texts(root)
    assert expect["verdict"] in said
    assert f"{folder.name}/job.cnc" in said
    for code in expect["findings"]:
        assert any(code in line for line in said) or any(re.match(r"and \d+ more", line) for line in said), code
    width, height = float(root.get("width", "0")), float(root.get("height", "0"))
    for element in root.iter(f"{SVG}text"):
        assert 0 <= float(element.get("x", "nan")) <= width
        assert 0 <= float(element.get("y", "nan")) <= height
    assert not re.search(r"\b(nan|inf)\b", (tmp_path / "job.svg").read_text(encoding="utf-8"))


def test_nothing_to_draw_is_said(tmp_path: Path) -> None:
    root = draw([program(tmp_path, "M5\nM30\n"), "--machine", MACHINE, "--setup", "zero"], tmp_path / "a.svg")
    assert "There is no motion to draw." in texts(root)


def test_without_a_machine_only_the_cut_is_drawn(tmp_path: Path) -> None:
    root = draw([program(tmp_path, f"{HEAD}G0 X0 Y0\nG1 X30 Y20 F500\nM30\n"), "--setup", "zero"], tmp_path / "a.svg")
    said = texts(root)
    assert any(line.startswith("The cut from above (30.0 x 20.0 mm)") for line in said)
    assert not any(line.startswith("On the machine") for line in said)


def test_an_unknown_zero_is_named_and_placed(tmp_path: Path) -> None:
    folder = ROOT / "corpus" / "eding" / "unknown-offsets"
    said = texts(draw([str(folder / "job.cnc"), *around(folder / "job.cnc")], tmp_path / "a.svg"))
    assert "work zero can be here" in said
    assert any("G54 X offset" in line for line in said)


def test_where_a_limit_is_crossed_is_marked_where_it_is_worst(tmp_path: Path) -> None:
    folder = ROOT / "corpus" / "eding" / "over-limit-arc-bulge"
    root = draw(
        [str(folder / "job.cnc"), "--machine", str(folder / "machine.toml"), "--setup", "zero"], tmp_path / "a.svg"
    )
    said = texts(root)
    assert "GP301 line 11" in said
    rings = [c for c in root.iter(f"{SVG}circle") if c.get("r") == "6"]
    limit = [r for r in root.iter(f"{SVG}rect") if r.get("stroke-dasharray") == "9 4"]
    right = float(limit[0].get("x", "0")) + float(limit[0].get("width", "0"))
    assert float(rings[0].get("cx", "0")) > right


def test_all_that_lies_outside_is_painted(tmp_path: Path) -> None:
    moves = "".join(f"G1 X{700 + i} Y{i % 5}\n" for i in range(60))
    job = program(tmp_path, f"{HEAD}G0 X0 Y0\nF500\n{moves}M30\n")
    root = draw([job, "--machine", MACHINE, "--setup", "zero"], tmp_path / "a.svg")
    said = texts(root)
    assert "GP301 at its worst" in said
    assert "and 56 more" in said
    red = {p.get("d") for p in root.iter(f"{SVG}path") if p.get("stroke") == "#d50000" and "h26" not in p.get("d", "")}
    blue = [p.get("d", "") for p in root.iter(f"{SVG}path") if p.get("stroke") == "#0d47a1"]
    assert any(len(d or "") >= len(max(blue, key=len)) for d in red)


def test_labels_and_rings_do_not_overlap(tmp_path: Path) -> None:
    moves = "".join(f"G1 X{601 + 3 * (i % 4)} Y{7 * i}\n" for i in range(15))
    job = program(tmp_path, f"{HEAD}G0 X0 Y0\nF500\n{moves}M30\n")
    root = draw([job, "--machine", MACHINE, "--setup", "zero"], tmp_path / "a.svg")
    rings = [(float(c.get("cx", "0")), float(c.get("cy", "0"))) for c in root.iter(f"{SVG}circle")]
    boxes = [
        tuple(float(r.get(k, "0")) for k in ("x", "y", "width", "height"))
        for r in root.iter(f"{SVG}rect")
        if r.get("fill-opacity") == "0.85"
    ]
    assert rings
    assert boxes
    for x, y, width, height in boxes:
        assert not any(x - 6 < cx < x + width + 6 and y - 6 < cy < y + height + 6 for cx, cy in rings)
    for i, (x, y, width, height) in enumerate(boxes):
        for a, b, other_width, other_height in boxes[:i]:
            assert x >= a + other_width or a >= x + width or y >= b + other_height or b >= y + height


def test_text_of_a_job_can_not_break_the_drawing(tmp_path: Path) -> None:
    folder = tmp_path / 'x<&"\x01y'
    folder.mkdir()
    root = draw([program(folder, f"{HEAD}G0 X1\nG1 X<5 F100\nM30\n"), "--machine", MACHINE], tmp_path / "a.svg")
    assert 'x<&"?y/job.cnc' in texts(root)


def test_same_job_same_bytes(tmp_path: Path) -> None:
    words = [program(tmp_path, f"{HEAD}G0 X5 Y5\nG2 X15 I5 F300\nM30\n"), "--machine", MACHINE, "--setup", "zero"]
    draw(words, tmp_path / "a.svg")
    draw(words, tmp_path / "b.svg")
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


def chunk(rows: list[dict[str, object]], begin: int = 0) -> Chunk:
    arrays = {
        c.name: np.zeros((len(rows), c.width) if c.width > 1 else len(rows), dtype=c.dtype) for c in TRACE_ROW.columns
    }
    for i, row in enumerate(rows):
        for name, value in row.items():
            arrays[name][i] = value
    trace = Trace(files=["job.cnc"], states=[State()])
    start = (0.0,) * 6
    return Chunk(trace=trace, section=0, begin=begin, start=start, start_frame=0, rows=Columns(TRACE_ROW, arrays))


@pytest.mark.parametrize(
    ("plane", "center", "end", "turns", "middle"),
    [
        (Plane.XY, (5, 0, 0), (10, 0, 0), -1, (5, 5, 0)),
        (Plane.XY, (5, 0, 0), (10, 0, 0), 1, (5, -5, 0)),
        (Plane.XZ, (5, 0, 0), (10, 0, 0), 1, (5, 0, 5)),
        (Plane.YZ, (0, 5, 0), (0, 10, 0), 1, (0, 5, -5)),
    ],
)
def test_arcs_turn_the_right_way(
    plane: Plane, center: tuple[float, ...], end: tuple[float, ...], turns: int, middle: tuple[float, ...]
) -> None:
    path = PathPoints(NO_MACHINE)
    path.add(chunk([{"op": Op.ARC, "to": (*end, 0, 0, 0), "center": center, "turns": turns, "plane": plane}]))
    points = path.points()
    assert points.at[-1].tolist() == list(end)
    assert min(math.dist(p, middle) for p in points.at.tolist()) < 0.1
    assert max(abs(math.dist(p, center) - 5) for p in points.at.tolist()) < 1e-3


def test_long_paths_are_thinned_and_keep_their_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(path_points, "MOST", 100)
    path = PathPoints(NO_MACHINE)
    for part in range(50):
        rows = [{"op": Op.FEED, "to": (part + i / 40, 1, 0, 0, 0, 0), "line": part} for i in range(40)]
        path.add(chunk(rows, begin=part * 40))
    points = path.points()
    assert 50 <= len(points) <= 102
    assert points.at[-1, 0] > 49


def test_keep_out_zones_are_drawn_where_they_stand(tmp_path: Path) -> None:
    folder = ROOT / "corpus" / "eding" / "clamped-plate"
    words = [str(folder / "job.cnc"), "--machine", str(folder / "machine.toml"), "--setup", str(folder / "setup.toml")]
    root = draw(words, tmp_path / "job.svg")
    assert "keep-out zone" in texts(root)
    shapes = [element.get("d", "") for element in root.iter(f"{SVG}path") if element.get("fill-rule") == "evenodd"]
    # From above the rear clamp has its eight corners; from the front it is a box.
    assert any(shape.count("L") == 7 for shape in shapes)
    assert any(shape.count("L") == 3 for shape in shapes)
    known = program(tmp_path, HEAD + "G0 X10\nM30\n")
    assert "keep-out zone" not in texts(draw([known, "--machine", MACHINE, "--setup", "zero"], tmp_path / "other.svg"))


def test_as_many_properties_as_there_are_stay_inside_the_picture(tmp_path: Path) -> None:
    """Their line is broken before the right edge."""
    job = program(tmp_path, HEAD + "G0 Z0\nG1 X10 F100\nM30\n")
    root = draw([job, "--machine", MACHINE, "--setup", "zero", "--also", "all"], tmp_path / "job.svg")
    found = [(t.text or "", float(t.get("x", 0)), float(t.get("y", 0))) for t in root.iter(f"{SVG}text")]
    places = [place for place in found if place[0] in every_property()]
    assert {name for name, *_ in places} >= set(every_property())
    assert all(x + 8 * len(name) + 60 < 1000 for name, x, _ in places)
    assert len({y for *_, y in places}) > 1


def test_an_inch_machine_is_drawn_in_inches(tmp_path: Path) -> None:
    """Titles, rulers, conditions and findings; ``--units`` says otherwise."""
    axes = "".join(f"[axes.{axis}]\nmin = -2.0\nmax = 10.0\n" for axis in "xyz")
    (tmp_path / "m.toml").write_text(f'schema = "gproof-machine/1"\nunits = "inch"\nname = "Shop"\n{axes}')
    job = program(tmp_path, "G20 G17 G90 G94 G40 G49 G80 G54\nG0 X0 Y0\nG1 Z-1 F10\nX4 Y2\nX12\nM30\n")
    words = [job, "--machine", str(tmp_path / "m.toml"), "--setup", "zero"]
    said = texts(draw(words, tmp_path / "a.svg"))
    assert "The cut from above (12.00 x 2.000 inch)" in said
    assert {"X inch", "Y inch"} <= set(said)
    assert any("X would reach 12.0000 inch, 2.0000 inch past" in line for line in said)
    assert not any(" mm" in line for line in said)
    assert {"X mm", "Y mm"} <= set(texts(draw([*words, "--units", "mm"], tmp_path / "a.svg")))


@pytest.mark.parametrize("length", [3, 40, 120, 200])
def test_titles_are_whole(length: int, tmp_path: Path) -> None:
    name = ("plate " * 60)[:length].strip() + ".cnc"
    machine = "A router with a long name, which somebody gave it " * 4
    (tmp_path / name).write_text(HEAD + "G0 X0 Y0\nG1 X30 Y20 F500\nM30\n")
    axes = "".join(f"[axes.{axis}]\nmin = -2.0\nmax = 3.0\n" for axis in "xyz")
    (tmp_path / "m.toml").write_text(f'schema = "gproof-machine/1"\nunits = "mm"\nname = "{machine}"\n{axes}')
    for command in ("check", "fit"):
        main(
            [command, str(tmp_path / name), "--machine", str(tmp_path / "m.toml"), "--picture", str(tmp_path / "a.svg")]
        )
        root = ET.parse(tmp_path / "a.svg").getroot()
        said = "".join(texts(root)).replace(" ", "")
        assert f"{tmp_path.name}/{name}".replace(" ", "") in said
        assert machine.replace(" ", "") in said
        assert "…" not in said
        for element in root.iter(f"{SVG}text"):
            assert float(element.get("y", "0")) <= float(root.get("height", "0"))


@pytest.mark.parametrize("seed", seeds(4, 10))
def test_wrapped_lines_fit_and_lose_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    letters = list("abcWM ,./:-0") + [" "] * 4
    for _ in range(50):
        text = "".join(rng.choice(letters, int(rng.integers(0, 200))))
        room = float(rng.integers(20, 500))
        lines = wrapped(text, 13, room)
        assert "".join(lines).replace(" ", "") == text.replace(" ", ""), (seed, text)
        assert lines
        assert all(wide(line, 13) <= room for line in lines), (seed, text, lines)


@pytest.mark.parametrize(("lines", "width"), [("", 6.0), ("#5501 = 16\n", 16.0), ("#5501 = 0\n", 0.0)])
def test_a_picture_draws_tools_as_wide_as_the_checks_take_them(lines: str, width: float, tmp_path: Path) -> None:
    """What the job writes over the tool table counts here too (Eding CNC manual 3.4.12)."""
    from gproof.driver.running import begin
    from gproof.driver.session import open_session
    from gproof.report.picture.path_points import PathPoints

    job = tmp_path / "job.cnc"
    job.write_text(f"{lines}T1 M6\nG1 X10 F100\nM30\n")
    machine = dataclasses.replace(NO_MACHINE, tools=(Tool(number=1, diameter=6.0),))
    session = open_session(job, machine=None, setup="zero", dialect="eding")
    assert session.program is not None
    path = PathPoints(machine)
    for chunk in begin(session.program, session.setup, machine, session.findings).chunks():
        path.add(chunk)
    assert float(path.points().diameter[-1]) == width
