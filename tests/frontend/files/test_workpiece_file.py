"""Stock, part and fixtures of setup files: lists, DXF drawings and STL meshes; areas and volumes by hand."""

from __future__ import annotations

import hashlib
import math
import struct
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from ezdxf.document import Drawing
from hypothesis import given
from hypothesis import strategies as st
from support.campaigns import examples

from gproof.driver.dialects import load_setup
from gproof.ir.finding import Findings
from gproof.ir.setup import Setup
from gproof.ir.workpiece import ACTIVE, MACHINE, Box, Cylinder, Mesh, Placed, Prism, Workpiece

HEAD = 'schema = "gproof-setup/1"\n'


def load(folder: Path, text: str) -> tuple[Setup | None, list[tuple[str, int, str]], list[tuple[str, str]]]:
    """The setup, its findings as (code, line, message), and the files that were read."""
    path = folder / "setup.toml"
    path.write_text(HEAD + text)
    findings = Findings()
    setup, files = load_setup(path, findings)
    return setup, [(f.code.label, f.span.line, f.message) for f in findings.kept], files


def workpiece(folder: Path, text: str) -> Workpiece:
    setup, found, _ = load(folder, text)
    assert found == []
    assert setup is not None and setup.workpiece is not None
    return setup.workpiece


def mistake(folder: Path, text: str) -> tuple[str, int, str]:
    """The one finding of a bad file."""
    setup, found, _ = load(folder, text)
    assert setup is None
    assert len(found) == 1, found
    return found[0]


def area(prism: Prism) -> float:
    """By the shoelace formula, holes taken away."""
    return sum(_signed(ring) for ring in (prism.outline, *prism.holes))


def _signed(ring: tuple[tuple[float, float], ...]) -> float:
    return sum(x * v - u * y for (x, y), (u, v) in zip(ring, (*ring[1:], ring[0]), strict=True)) / 2.0


def volume(bodies: tuple[Placed, ...]) -> float:
    return sum(area(b.body) * (b.body.high - b.body.low) for b in bodies if isinstance(b.body, Prism))


# ---- bodies in numbers


def test_every_kind_of_body(tmp_path: Path) -> None:
    found = workpiece(
        tmp_path,
        """units = "inch"
[workpiece]
tolerance = 0.001
clearance = 0.1
cell = 0.02
[stock]
box = [[0, 0, -1], [4, 2, 0]]
[[part]]
name = "plate"
polygon = [[0, 0], [0, 2], [4, 2], [4, 0]]
bottom = -1
top = 0
[[fixtures]]
name = "left clamp"
box = [[0, 0, 0], [10, 20, 30]]
units = "mm"
work = "machine"
shift = [100, 0, 5]
[[fixtures]]
cylinder = {x = 1, y = 2, diameter = 0.5, bottom = -1, top = 0.25}
work = "active"
[[fixtures]]
box = [[0, 0, 0], [2, 1, 1]]
rotate = 90
work = 3
""",
    )
    assert (found.tolerance, found.clearance, found.cell) == (0.0254, 2.54, 0.508)
    assert found.stock == (Placed(name="stock", body=Box(low=(0.0, 0.0, -25.4), high=(101.6, 50.8, 0.0))),)
    corners = ((0.0, 0.0), (101.6, 0.0), (101.6, 50.8), (0.0, 50.8))
    (part,) = found.part
    assert isinstance(part.body, Prism)
    assert (part.name, set(part.body.outline), part.body.error) == ("plate", set(corners), 0.0)
    assert area(part.body) == pytest.approx(101.6 * 50.8)  # counter-clockwise
    assert found.fixtures == (
        Placed(name="left clamp", body=Box(low=(100.0, 0.0, 5.0), high=(110.0, 20.0, 35.0)), work=MACHINE),
        Placed(name="fixture 2", body=Cylinder(x=25.4, y=50.8, radius=6.35, low=-25.4, high=6.35), work=ACTIVE),
        Placed(name="fixture 3", body=Box(low=(-25.4, 0.0, 0.0), high=(0.0, 50.8, 25.4)), work=3),
    )


def test_nothing_is_stated(tmp_path: Path) -> None:
    setup, found, _ = load(tmp_path, "tool = 1\n")
    assert found == []
    assert setup is not None and setup.workpiece is None


def test_a_box_that_is_turned(tmp_path: Path) -> None:
    (placed,) = workpiece(tmp_path, "[stock]\nbox = [[0,0,0],[10,10,5]]\nrotate = 45\n").stock
    assert isinstance(placed.body, Prism)
    half = 10 / math.sqrt(2)
    assert np.allclose(sorted(placed.body.outline), sorted([(0, 0), (half, half), (0, 2 * half), (-half, half)]))
    assert (placed.body.low, placed.body.high) == (0.0, 5.0)


def test_pockets_stand_on_one_another(tmp_path: Path) -> None:
    """100 x 50 x 20, a pocket 40 x 30 x 5 with an island 10 x 10, a hole 10 x 10 through it."""
    text = """[[part]]
polygon = [[0, 0], [100, 0], [100, 50], [0, 50]]
holes = [[[80, 10], [90, 10], [90, 20], [80, 20]]]
bottom = -20
top = 0
[[part.pockets]]
polygon = [[10, 10], [50, 10], [50, 40], [10, 40]]
holes = [[[20, 20], [30, 20], [30, 30], [20, 30]]]
floor = -5
[[part.pockets]]
polygon = [[12, 12], [18, 12], [18, 18], [12, 18]]
floor = -8
[[part.pockets]]
polygon = [[90, 30], [110, 30], [110, 40], [90, 40]]
floor = -20
"""
    found = workpiece(tmp_path, text)
    expected = 5000 * 20 - 100 * 20 - (1200 - 100) * 5 - 36 * 3 - 100 * 20
    assert volume(found.part) == pytest.approx(expected)
    levels = sorted({(b.body.low, b.body.high) for b in found.part if isinstance(b.body, Prism)})
    assert levels == [(-20.0, -8.0), (-8.0, -5.0), (-5.0, 0.0)]


# ---- drawings


def drawing(folder: Path, units: int = 4, name: str = "plate.dxf") -> tuple[Drawing, Path]:
    doc = ezdxf.new(units=units)  # type: ignore[attr-defined]
    return doc, folder / name


PLATE = """[[part]]
dxf = "plate.dxf"
[part.layers]
OUTLINE = {bottom = -10, top = 0}
Pocket = {floor = -4}
"""


def test_layers_have_heights(tmp_path: Path) -> None:
    """A plate of lines and arcs, 100 x 50 with corners of radius 10; a round pocket; labels beside it."""
    doc, path = drawing(tmp_path)
    msp = doc.modelspace()
    for a, b in (((10, 0), (90, 0)), ((100, 40), (100, 10)), ((90, 50), (10, 50)), ((0, 10), (0, 40))):
        msp.add_line(a, b, {"layer": "OUTLINE"})
    for center, begin in (((90, 10), 270), ((90, 40), 0), ((10, 40), 90), ((10, 10), 180)):
        msp.add_arc(center, 10, begin, begin + 90, dxfattribs={"layer": "OUTLINE"})
    msp.add_circle((50, 25), 15, {"layer": "POCKET"})
    msp.add_text("plate", dxfattribs={"layer": "OUTLINE"})
    msp.add_line((0, 0), (7, 7), {"layer": "NOTES"})
    doc.saveas(path)
    found = workpiece(tmp_path, PLATE)
    outline = 100 * 50 - (4 - math.pi) * 100
    assert volume(found.part) == pytest.approx(outline * 10 - math.pi * 225 * 4, rel=2e-4)
    assert all(isinstance(b.body, Prism) and 0.001 <= b.body.error <= 0.001 + 1e-6 for b in found.part)
    assert [file for file, _ in load(tmp_path, PLATE)[2]] == [str(tmp_path / "setup.toml"), str(path)]
    assert load(tmp_path, PLATE)[2][1][1] == hashlib.sha256(path.read_bytes()).hexdigest()


@examples(25, 1000)
@given(
    radius=st.floats(0.5, 200), bulge=st.floats(-3, 3).filter(lambda b: abs(b) > 1e-3),
    at=st.tuples(st.floats(-500, 500), st.floats(-500, 500)), turn=st.floats(0, 6.28),
)  # fmt: skip
def test_chords_are_as_near_as_they_say(
    tmp_path_factory: pytest.TempPathFactory, radius: float, bulge: float, at: tuple[float, float], turn: float
) -> None:
    """A polyline of one arc and its chord: every corner is on the circle, every middle within the error of it."""
    folder = tmp_path_factory.mktemp("bulge")
    doc, path = drawing(folder)
    sweep = 4 * math.atan(bulge)
    one = (at[0] + radius * math.cos(turn), at[1] + radius * math.sin(turn))
    other = (at[0] + radius * math.cos(turn + sweep), at[1] + radius * math.sin(turn + sweep))
    doc.modelspace().add_lwpolyline([(*one, bulge), (*other, 0)], format="xyb", close=True)
    doc.saveas(path)
    (placed,) = workpiece(folder, '[[part]]\ndxf = "plate.dxf"\nbottom = 0\ntop = 1\n').part
    assert isinstance(placed.body, Prism)
    points = np.array(placed.body.outline)
    away = np.abs(np.hypot(points[:, 0] - at[0], points[:, 1] - at[1]) - radius)
    assert away.max() < 1e-8
    middles = (points + np.roll(points, -1, axis=0)) / 2
    inside = np.sort(np.abs(np.hypot(middles[:, 0] - at[0], middles[:, 1] - at[1]) - radius))
    # All but the one straight side.
    assert inside[:-1].max(initial=0.0) <= placed.body.error * (1 + 1e-6)
    segment = radius**2 * (abs(sweep) - math.sin(abs(sweep))) / 2
    assert area(placed.body) == pytest.approx(segment, abs=abs(sweep) * radius * placed.body.error + 1e-7)


def test_ellipses_splines_and_blocks(tmp_path: Path) -> None:
    """A spline through the control points of a quarter circle of cubics; an ellipse; a block that is turned twice."""
    doc, path = drawing(tmp_path)
    msp = doc.modelspace()
    msp.add_ellipse((0, 0), (30, 0), 0.5, dxfattribs={"layer": "E"})
    block = doc.blocks.new("SQUARE")
    block.add_lwpolyline([(0, 0), (10, 0), (10, 10), (0, 10)], close=True)
    msp.add_blockref("SQUARE", (100, 0), {"rotation": 30, "xscale": 2, "yscale": 2, "layer": "B"})
    k = 0.5522847498
    quarter = [(20, 0), (20, 20 * k), (20 * k, 20), (0, 20)]
    msp.add_open_spline(quarter, dxfattribs={"layer": "S"})
    msp.add_line((0, 20), (0, 0), {"layer": "S"})
    msp.add_line((0, 0), (20, 0), {"layer": "S"})
    doc.saveas(path)
    for layer, expected in (("E", math.pi * 30 * 15), ("B", 400.0), ("S", math.pi * 400 / 4)):
        text = f'[[part]]\ndxf = "plate.dxf"\nlayers = {{{layer} = {{bottom = 0, top = 1}}}}\n'
        assert volume(workpiece(tmp_path, text).part) == pytest.approx(expected, rel=5e-4), layer


def test_a_mirrored_entity(tmp_path: Path) -> None:
    """An extrusion of -Z: X counts the other way."""
    doc, path = drawing(tmp_path)
    doc.modelspace().add_circle((40, 5), 3, {"extrusion": (0, 0, -1)})
    doc.saveas(path)
    (placed,) = workpiece(tmp_path, '[[part]]\ndxf = "plate.dxf"\nbottom = 0\ntop = 1\n').part
    assert isinstance(placed.body, Prism)
    xs = [x for x, _ in placed.body.outline]
    assert (min(xs), max(xs)) == (pytest.approx(-43, abs=0.01), pytest.approx(-37, abs=0.01))


def test_rings_in_rings_are_holes_by_turns(tmp_path: Path) -> None:
    doc, path = drawing(tmp_path)
    for half in (10, 30, 20, 40):
        corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
        doc.modelspace().add_lwpolyline(corners, close=True)
    doc.saveas(path)
    found = workpiece(tmp_path, '[[part]]\ndxf = "plate.dxf"\nbottom = 0\ntop = 1\n')
    assert volume(found.part) == pytest.approx(80**2 - 60**2 + 40**2 - 20**2)
    assert len(found.part) == 2


@pytest.mark.parametrize(
    ("insunits", "keys", "scale"), [(1, "", 25.4), (0, "", 1.0), (0, 'units = "inch"', 25.4), (4, 'units = "mm"', 1.0)]
)
def test_units_of_drawings(tmp_path: Path, insunits: int, keys: str, scale: float) -> None:
    doc, path = drawing(tmp_path, insunits)
    doc.modelspace().add_lwpolyline([(0, 0), (2, 0), (2, 3), (0, 3)], close=True)
    doc.saveas(path)
    (placed,) = workpiece(tmp_path, f'[[part]]\ndxf = "plate.dxf"\n{keys}\nbottom = 0\ntop = 1\n').part
    assert isinstance(placed.body, Prism)
    assert area(placed.body) == pytest.approx(6 * scale**2)


def test_units_that_contradict(tmp_path: Path) -> None:
    doc, path = drawing(tmp_path, 1)
    doc.modelspace().add_circle((0, 0), 1)
    doc.saveas(path)
    text = '[[part]]\ndxf = "plate.dxf"\nunits = "mm"\nbottom = 0\ntop = 1\n'
    assert mistake(tmp_path, text) == ("GP603", 4, "part.units: mm, but plate.dxf says inch ($INSUNITS)")


def test_an_open_outline_says_where(tmp_path: Path) -> None:
    doc, path = drawing(tmp_path)
    for a, b in (((0, 0), (50, 0)), ((50, 0), (50, 30)), ((50, 30.5), (0, 0))):
        doc.modelspace().add_line(a, b, {"layer": "OUTLINE"})
    doc.saveas(path)
    text = '[[part]]\ndxf = "plate.dxf"\nlayers = {OUTLINE = {bottom = -1, top = 0}}\n'
    code, _, message = mistake(tmp_path, text)
    assert code == "GP601"
    assert "layer 'OUTLINE' is open at X 50.0000 Y 30.0000" in message
    assert "the nearest other end is 0.5000 away at X 50.0000 Y 30.5000" in message
    closed = workpiece(tmp_path, text + "join = 0.6\n")
    assert isinstance(closed.part[0].body, Prism)
    assert closed.part[0].body.error == pytest.approx(0.501)


def test_three_ends_at_a_point(tmp_path: Path) -> None:
    doc, path = drawing(tmp_path)
    for a, b in (((0, 0), (50, 0)), ((50, 0), (50, 30)), ((50, 30), (0, 0)), ((50, 0), (70, 7))):
        doc.modelspace().add_line(a, b)
    doc.saveas(path)
    message = mistake(tmp_path, '[[part]]\ndxf = "plate.dxf"\nbottom = 0\ntop = 1\n')[2]
    assert "3 ends meet at X 50.0000 Y 0.0000" in message


def test_entities_that_are_not_read(tmp_path: Path) -> None:
    doc, path = drawing(tmp_path)
    doc.modelspace().add_circle((0, 0), 5, {"extrusion": (1, 0, 0)})
    doc.saveas(path)
    text = '[[part]]\ndxf = "plate.dxf"\nbottom = 0\ntop = 1\n'
    assert "is not in the X-Y plane" in mistake(tmp_path, text)[2]
    doc, path = drawing(tmp_path)
    doc.modelspace().add_3dface([(0, 0), (1, 0), (1, 1), (0, 1)])
    doc.saveas(path)
    assert "3DFACE on layer '0' is not an outline that gproof reads" in mistake(tmp_path, text)[2]
    doc, path = drawing(tmp_path)
    doc.modelspace().add_rational_spline([(0, 0), (5, 9), (10, 0), (0, 0)], weights=[1, 2, 1, 1])
    doc.saveas(path)
    assert "weights" in mistake(tmp_path, text)[2]


def test_splines_that_are_no_certain_curve(tmp_path: Path) -> None:
    """Fit points have several curves through them; knots that are missing, do not rise or go around have none."""
    text = '[[part]]\ndxf = "plate.dxf"\nbottom = 0\ntop = 1\n'
    corners = [(0, 0, 0), (5, 9, 0), (10, 0, 0), (12, 3, 0), (0, 0, 0)]
    for knots, what in (
        ([], "knots that do not fit"), ([0, 0, 0, 0, 1, 1, 1], "knots that do not fit"),
        ([0, 0, 0, 0, 3, 1, 1, 1, 1], "knots that do not fit"),
        ([0, 1, 2, 3, 4, 5, 6, 7, 8], "outer control points"),
    ):  # fmt: skip
        doc, path = drawing(tmp_path)
        spline = doc.modelspace().add_spline(dxfattribs={"layer": "S"})
        spline.dxf.degree, spline.control_points, spline.knots = 3, corners, knots
        doc.saveas(path)
        assert (said := mistake(tmp_path, text)[2]) and "SPLINE on layer 'S'" in said and what in said, said
    doc, path = drawing(tmp_path)
    doc.modelspace().add_spline(fit_points=corners)
    doc.saveas(path)
    assert "no control points" in mistake(tmp_path, text)[2]


def test_a_curve_of_no_workpiece(tmp_path: Path) -> None:
    """Millions of chords are a slip of a coordinate: told at once."""
    doc, path = drawing(tmp_path)
    doc.modelspace().add_lwpolyline([(0, 0, 0.3), (1e12, 0, 0.3), (5, 5, 0.3)], format="xyb", close=True)
    doc.saveas(path)
    text = '[[part]]\ndxf = "plate.dxf"\nbottom = 0\ntop = 1\n'
    assert "a curve is too large" in mistake(tmp_path, text)[2]


def test_a_kind_misspelt_is_named(tmp_path: Path) -> None:
    _, found, _ = load(tmp_path, "[[part]]\npolygn = [[0, 0], [1, 0], [0, 1]]\nbottom = 0\ntop = 1\n")
    assert [(code, line) for code, line, _ in found] == [("GP604", 2), ("GP611", 3)] and "part.polygn" in found[1][2]


BROKEN = {
    "empty": b"",
    "text": b"this is no drawing\n",
    "cut": b"  0\nSECTION\n  2\nENTITIES\n  0\nLINE\n  8\n0\n 10\nx",
    "nan": b"  0\nSECTION\n  2\nENTITIES\n  0\nCIRCLE\n  8\n0\n 10\nnan\n 20\n0\n 40\n5\n  0\nENDSEC\n  0\nEOF\n",
    "nothing": b"  0\nSECTION\n  2\nENTITIES\n  0\nENDSEC\n  0\nEOF\n",
    "zero": b"\0" * 500,
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_drawings(tmp_path: Path, name: str) -> None:
    (tmp_path / "plate.dxf").write_bytes(BROKEN[name])
    code, _, _ = mistake(tmp_path, '[[part]]\ndxf = "plate.dxf"\nbottom = 0\ntop = 1\n')
    assert code in ("GP601", "GP603")
    code, _, _ = mistake(tmp_path, '[[part]]\ndxf = "plate.dxf"\nlayers = {A = {bottom = 0, top = 1}}\n')
    assert code in ("GP601", "GP603")


# ---- meshes

TETRA = np.array([[0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 10]], dtype=np.float64)
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]


def binary(faces: list[tuple[int, int, int]], points: np.ndarray = TETRA) -> bytes:
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *points[list(face)].ravel(), 0) for face in faces)
    return b"solid but binary".ljust(80, b" ") + struct.pack("<I", len(faces)) + body


def text_form(faces: list[tuple[int, int, int]]) -> bytes:
    lines = ["solid part"]
    for face in faces:
        lines += ["  facet normal 0 0 0", "    outer loop"]
        lines += [f"      vertex {x} {y:e} {z}" for x, y, z in TETRA[list(face)]]
        lines += ["    endloop", "  endfacet"]
    return "\r\n".join([*lines, "endsolid part", ""]).encode()


STL = '[[fixtures]]\nstl = "body.stl"\n'


def mesh_volume(mesh: Mesh) -> float:
    a, b, c = (mesh.triangles[name] for name in "abc")
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("form", [binary, text_form])
def test_meshes_of_both_forms(tmp_path: Path, form: object, turned: bool) -> None:
    faces = [face[::-1] for face in FACES] if turned else FACES
    (tmp_path / "body.stl").write_bytes(form(faces))  # type: ignore[operator]
    (placed,) = workpiece(tmp_path, STL + 'units = "inch"\nrotate = 90\nshift = [1, 2, 3]\n').fixtures
    assert isinstance(placed.body, Mesh)
    assert placed.body.closed
    assert mesh_volume(placed.body) == pytest.approx(1000 / 6 * 25.4**3, rel=1e-6)
    low = np.min([placed.body.triangles[name].min(axis=0) for name in "abc"], axis=0)
    assert low == pytest.approx([25.4 - 254, 50.8, 76.2])


def test_a_mesh_with_a_hole_is_told(tmp_path: Path) -> None:
    (tmp_path / "body.stl").write_bytes(binary(FACES[:3]))
    setup, found, _ = load(tmp_path, STL)
    assert setup is not None and setup.workpiece is not None
    assert [code for code, _, _ in found] == ["GP432"]
    assert "3 edges have one triangle only, such as X 0.0000 Y 0.0000 Z 0.0000" in found[0][2]
    body = setup.workpiece.fixtures[0].body
    assert isinstance(body, Mesh) and not body.closed
    (tmp_path / "body.stl").write_bytes(binary([*FACES[:3], FACES[3][::-1]]))
    assert "face different sides" in load(tmp_path, STL)[1][0][2]


BAD_MESHES = {
    "empty": (b"", "0 bytes are not an STL file"),
    "short": (binary(FACES)[:-3], "4 triangles take 284 bytes, the file has 281"),
    "none": (binary([]), "it has no triangle"),
    "many": (b"x" * 80 + struct.pack("<I", 2**32 - 1), "4294967295 triangles"),
    "nan": (binary(FACES, TETRA * math.nan), "triangle 1 has a coordinate that is not a finite number"),
    "far": (binary(FACES, TETRA * 1e8), "triangle 1 has a coordinate beyond 1e+07"),
    "points": (binary([(0, 0, 0), (1, 1, 2)]), "all its triangles are points or lines"),
    "text": (text_form(FACES).replace(b"endloop", b"endlop", 1), "this is not a line of a text STL file"),
    "number": (text_form(FACES).replace(b"10.0", b"1O.0", 1), "a coordinate is not a number"),
    "long": (
        text_form(FACES).replace(b"10.0", b"1." + b"0" * 70 + b"e1", 1),
        "a corner must be vertex and three numbers",
    ),
    "open": (text_form(FACES).replace(b"endsolid part", b""), "endsolid is missing"),
    "second": (text_form(FACES) + b"solid other\n", "endsolid is missing"),
    "end": (text_form(FACES) + b"endsolid\n", "endsolid without solid"),
    "corner": (text_form(FACES).replace(b"vertex 0.0 ", b"vertex ", 1), "a corner must be vertex and three numbers"),
}


@pytest.mark.parametrize("name", BAD_MESHES)
def test_bad_meshes(tmp_path: Path, name: str) -> None:
    raw, what = BAD_MESHES[name]
    (tmp_path / "body.stl").write_bytes(raw)
    code, _, message = mistake(tmp_path, STL)
    assert (code, what in message) == ("GP601", True), message


def test_a_line_of_a_text_mesh(tmp_path: Path) -> None:
    (tmp_path / "body.stl").write_bytes(BAD_MESHES["number"][0])
    assert mistake(tmp_path, STL)[1] == 6


# ---- mistakes of the tables

WRONG = [
    ("[stock]\n", 2, "GP604", "stock.box or .cylinder or .polygon or .dxf or .stl is missing"),
    ("[stock]\nbox = [[0,0,0],[1,1,0]]\n", 3, "GP603", "not above the lower one in Z"),
    ("[stock]\nbox = [[0,0],[1,1]]\n", 3, "GP603", "lower and its upper corner"),
    ("[stock]\nbox = [[0,0,0],[1,1,nan]]\n", 3, "GP603", "not a list of numbers"),
    ("[stock]\nbox = [[0,0,0],[1,1,1]]\nstl = 'a.stl'\n", 4, "GP603", "given together with box"),
    ("[stock]\nbox = [[0,0,0],[1,1,1]]\nwork = 10\n", 4, "GP603", "whole number from 1 to 9"),
    ("[stock]\nbox = [[0,0,0],[1,1,1]]\nwork = 'G54'\n", 4, "GP603", "not one of 1 to 9"),
    ("[stock]\nbox = [[0,0,0],[1,1,1]]\nshift = [1, 2]\n", 4, "GP603", "not X, Y and Z"),
    ("[stock]\nbox = [[0,0,0],[1,1,1]]\nrotate = 'x'\n", 4, "GP603", "not a number"),
    ("[stock]\nstl = 'none.stl'\n", 3, "GP603", "no such file"),
    ("[stock]\ncylinder = {x = 0, y = 0, diameter = 0, bottom = 0, top = 1}\n", 3, "GP603", "diameter"),
    ("[[part]]\npolygon = [[0,0],[1,1]]\nbottom = 0\ntop = 1\n", 3, "GP603", "2 corners has no area"),
    ("[[part]]\npolygon = [[0,0],[2,2],[2,0],[0,2]]\nbottom = 0\ntop = 1\n", 3, "GP603",
     "the outline crosses itself at X 1.0000 Y 1.0000"),
    ("[[part]]\npolygon = [[0,0],[1,0],[1,1]]\nbottom = 1\ntop = 1\n", 5, "GP603", "not above bottom"),
    ("[[part]]\npolygon = [[0,0],[1,0],[1,1]]\ntop = 1\n", 2, "GP604", "part.bottom is missing"),
    ("[[part]]\npolygon = [[0,0],[9,0],[9,9]]\nholes = [[[5,1],[11,1],[11,3]]]\nbottom = 0\ntop = 1\n", 3, "GP603",
     "two outlines cross at"),
    ("[[part]]\npolygon = [[0,0],[9,0],[9,9]]\nbottom=0\ntop=1\npockets = [{polygon = [[1,0],[2,0],[2,1]], floor=2}]\n",
     6, "GP603", "must be from 0 to 1 mm"),
    ("[[fixtures]]\nbox = [[0,0,0],[1,1,1]]\n[[fixtures]]\nbox = [[0,0,0],[1,0,1]]\n", 5, "GP603",
     "fixtures[2].box: the upper corner is not above the lower one in Y"),
    ("[workpiece]\ntolerance = 0\n", 3, "GP603", "tolerance"),
    ("[[part]]\ndxf = 'none.dxf'\nbottom = 0\ntop = 1\n", 3, "GP603", "no such file"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "line", "code", "what"), WRONG, ids=[str(n) for n in range(len(WRONG))])
def test_mistakes(tmp_path: Path, text: str, line: int, code: str, what: str) -> None:
    found = mistake(tmp_path, text)
    assert (found[0], found[1], what in found[2]) == (code, line, True), found


def test_unknown_keys_are_told(tmp_path: Path) -> None:
    text = "[stock]\nbox = [[0,0,0],[1,1,1]]\nbottem = 1\n[[fixtures]]\nbox = [[0,0,0],[1,1,1]]\nclearence = 1\n"
    _, found, _ = load(tmp_path, text)
    assert [(code, line) for code, line, _ in found] == [("GP611", 4), ("GP611", 7)]


def test_layers_that_are_not_there(tmp_path: Path) -> None:
    doc, path = drawing(tmp_path)
    doc.modelspace().add_circle((0, 0), 5, {"layer": "CUT"})
    doc.saveas(path)
    text = '[[part]]\ndxf = "plate.dxf"\nlayers = {CUTS = {bottom = 0, top = 1}}\n'
    assert mistake(tmp_path, text) == ("GP603", 4, "part.layers.CUTS: no such layer has an outline; the layers are CUT")
