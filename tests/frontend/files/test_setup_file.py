"""Setup files: every key, intervals, units, and every mistake with its line."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pytest

from gproof.driver.dialects import load_setup
from gproof.ir.finding import Findings
from gproof.ir.setup import CylinderMap, HeightMap, InForce, Interval, Setup
from gproof.ir.text import parse_ir, print_ir

HEAD = 'schema = "gproof-setup/1"\n'
WHOLE = """\
schema = "gproof-setup/1"
name = "Tuesday"
homed = ["z", "x", "y"]
start = {x = 0.0, y = 1, a = 90}
tool = 1
active_work = 2
block_delete = true
optional_stop = false

[work.1]
x = 10.0
y = [5.0, 8.0]

[work.9]
z = -5.5

[g92]
x = 0.5

[parameters]
100 = 5.0
4001 = -2

[tools.3]
length = [12, 12.5]
"""


def setup_of(folder: Path, text: str) -> Setup:
    path = folder / "setup.toml"
    path.write_text(text)
    findings = Findings()
    setup, files = load_setup(path, findings)
    assert [f.message for f in findings.kept] == []
    assert setup is not None
    assert files == [(str(path), hashlib.sha256(path.read_bytes()).hexdigest())]
    assert parse_ir(print_ir(setup)) == setup
    return setup


def test_every_key(tmp_path: Path) -> None:
    setup = setup_of(tmp_path, WHOLE)
    assert setup == Setup(
        name="Tuesday",
        homed=("x", "y", "z"),
        start={"x": Interval(0.0, 0.0), "y": Interval(1.0, 1.0), "a": Interval(90.0, 90.0)},
        work={
            (1, "x"): Interval(10.0, 10.0),
            (1, "y"): Interval(5.0, 8.0),
            (9, "z"): Interval(-5.5, -5.5),
        },
        g92={"x": Interval(0.5, 0.5)},
        tool_lengths={3: Interval(12.0, 12.5)},
        parameters={100: 5.0, 4001: -2.0},
        active_work=2,
        tool=1,
        block_delete=True,
        optional_stop=False,
    )


def test_everything_is_optional(tmp_path: Path) -> None:
    assert setup_of(tmp_path, HEAD) == Setup(name="setup.toml")


def test_inches(tmp_path: Path) -> None:
    text = WHOLE.replace('name = "Tuesday"', 'units = "inch"')
    setup = setup_of(tmp_path, text)
    assert setup.start["y"] == Interval(25.4, 25.4)
    assert setup.start["a"] == Interval(90.0, 90.0)
    assert setup.work[1, "y"] == Interval(127.0, 203.2)
    assert setup.tool_lengths[3] == Interval(304.8, 317.5)
    assert setup.parameters == {100: 5.0, 4001: -2.0}


@pytest.mark.parametrize(
    ("text", "code", "line", "message"),
    [
        ("", "GP604", 1, "schema is missing"),
        ('schema = "gproof-machine/1"\n', "GP603", 1, "schema"),
        (HEAD + "x =\n", "GP601", 2, "not TOML"),
        (HEAD + "tools = 3\n", "GP603", 2, "tools: 3 is not a table"),
        (HEAD + "tool = 100\n", "GP603", 2, "tool: 100 is not a whole number from 0 to 99"),
        (HEAD + "active_work = 0\n", "GP603", 2, "active_work"),
        (HEAD + "block_delete = 1\n", "GP603", 2, "block_delete"),
        (HEAD + 'homed = "x"\n', "GP603", 2, "homed"),
        (HEAD + 'homed = ["w"]\n', "GP603", 2, "homed"),
        (HEAD + "[start]\nx = [2, 1]\n", "GP603", 3, "start.x: the lower end 2 is above the upper end 1"),
        (HEAD + "[start]\nw = 1\n", "GP611", 3, "start.w"),
        (HEAD + "[work.10]\nx = 1\n", "GP603", 2, "'10' is not a number from 1 to 9"),
        (HEAD + "[work.1]\nx = true\n", "GP603", 3, "work.1.x"),
        (HEAD + "[parameters]\n0 = 1\n", "GP603", 3, "'0' is not a parameter number"),
        (HEAD + "[parameters]\n6000 = 1\n", "GP603", 3, "'6000' is not a parameter number"),
        (HEAD + "[parameters]\n1 = [2, 1]\n", "GP603", 3, "parameters.1"),
        (HEAD + "[parameters]\n5221 = 1\n", "GP603", 3, "#5221 comes from [work.1] to [work.9]"),
        (HEAD + "[parameters]\n5001 = [1, 2]\n", "GP603", 3, "#5001 comes from [start]"),
        (HEAD + "[parameters]\n5211 = [0, 1]\n", "GP603", 3, "#5211 must be one number"),
        *(
            (HEAD + f"[parameters]\n{number} = 1\n", "GP603", 3, f"#{number} {said}")
            for number, said in (
                (5008, "comes from tool"),
                (5010, "comes from tool and the tool table"),
                (5011, "comes from tool"),
                (5013, "comes from the tool table and G43"),
                (5051, "changes while the job runs"),
                (5068, "changes while the job runs"),
                (5069, "changes while the job runs"),
                (5081, "comes from #5051"),
                (5101, "comes from the machine file"),
                (5150, "comes from [cylinder]"),
                (5151, "comes from [height_map]"),
                (5230, "other than 0 turns"),
                (5380, "comes from how"),
                (5397, "comes from --render"),
            )
        ),
        (HEAD + "[parameters]\n5390 = 3\n", "GP603", 3, "#5390 must be 0 (M90), 1 (M91) or 2 (M92)"),
        (HEAD + "[parameters]\n5390 = [0, 1]\n", "GP603", 3, "#5390 must be one number"),
        (HEAD + "[parameters]\n5230 = [0, 0]\n", "GP603", 3, "#5230 other than 0"),
        (HEAD + "[heads.0]\nx = 1\n", "GP603", 2, "'0' is not a number from 1 to 5"),
        (HEAD + "[heads.1]\na = 1\n", "GP611", 3, "heads.1.a"),
        (HEAD + "[heads.1]\nx = [2, 1]\n", "GP603", 3, "above the upper end"),
        (HEAD + "[transform]\nangle = 30\ny = 0\n", "GP604", 2, "transform.x is missing"),
        (HEAD + "[transform]\nfactor = 2\nx = 0\n", "GP604", 2, "transform.y is missing"),
        (HEAD + "[transform]\nfactor_x = 2\nx = 0\ny = 0\n", "GP604", 2, "transform.factor_y is missing"),
        (HEAD + "[transform]\nfactor = 0\nx = 0\ny = 0\n", "GP603", 3, "moves every point to one place"),
        (
            HEAD + "[transform]\nfactor_x = 1\nfactor_y = 0\nx = 0\ny = 0\n",
            "GP603",
            4,
            "moves every point to one place",
        ),
        (HEAD + "[transform]\nfactor = 1\nfactor_x = 1\nfactor_y = 1\n", "GP603", 3, "given together with"),
        (HEAD + "[transform]\nangle = 30\nfactor_x = 1\nfactor_y = 2\nx = 0\ny = 0\n", "GP603", 4, "which comes first"),
        (HEAD + "[transform]\nangle = [1, 2]\nx = 0\ny = 0\n", "GP603", 3, "is not a number"),
        (HEAD + "[transform]\nr = 2\n", "GP611", 3, "transform.r"),
        (HEAD + "[tools.1]\ndiameter = 1\n", "GP611", 3, "tools.1.diameter"),
        (HEAD + "offsets = 1\n", "GP611", 2, "offsets"),
    ],
)
def test_mistakes_have_their_line(tmp_path: Path, text: str, code: str, line: int, message: str) -> None:
    path = tmp_path / "setup.toml"
    path.write_text(text)
    findings = Findings()
    setup, _ = load_setup(path, findings)
    (finding,) = findings.kept
    assert (finding.code.label, finding.span.line) == (code, line)
    assert message in finding.message
    assert setup is None


GRID = "[height_map]\nx = 10\ny = 5\nsize = 20\nheights = [[0.0, 0.1, 0.2], [0.05, 0.15, 0.25]]\n"


def test_a_cylinder_and_a_grid(tmp_path: Path) -> None:
    setup = setup_of(tmp_path, HEAD + 'units = "inch"\n[cylinder]\nradius = 2\ny = 1\nzero = -1\n' + GRID)
    assert setup.cylinder == CylinderMap(radius=50.8, y=25.4, z=None, zero=-25.4)
    assert setup.height_map is not None
    assert (setup.height_map.x, setup.height_map.y, setup.height_map.size, setup.height_map.on) == (254, 127, 508, True)
    assert setup.height_map.heights[1][2] == 0.25 * 25.4
    off = setup_of(tmp_path, HEAD + GRID + "on = false\n").height_map
    assert off is not None and not off.on


def test_a_height_map_from_points_in_any_order(tmp_path: Path) -> None:
    points = "; board\n10 5 -8.2\n30 5 -8.1 ; second\n30, 25, -8.05\n10.05 25 -8.3\n"
    (tmp_path / "heights.txt").write_text(points)
    (tmp_path / "setup.toml").write_text(HEAD + '[height_map]\nfile = "heights.txt"\n')
    findings = Findings()
    setup, files = load_setup(tmp_path / "setup.toml", findings)
    assert findings.kept == [] and setup is not None
    assert [Path(name).name for name, _ in files] == ["setup.toml", "heights.txt"]
    assert setup.height_map == HeightMap(
        x=10.0, y=5.0, size=20.0, heights=((-8.2, -8.1), (-8.3, -8.05)), name="heights.txt"
    )


@pytest.mark.parametrize(
    ("points", "what"),
    [
        ("1 2\n", "X, Y and Z"), ("1 2 three\n", "X, Y and Z"), ("; none\n", "no points"),
        ("1 1 1\n", "not make a grid"),
        ("0 0 1\n10 0 1\n0 10 1\n", "1 points of the grid are missing"),
        ("0 0 1\n10 0 1\n0 10 1\n14 10 1\n", "off the grid"), ("0 0 1\n10 0 1\n0 10 1\n10 0 2\n", "given twice"),
        ("0 0 1\n10 0 1\n20 0 1\n", "at least 2 rows"),
    ],
)  # fmt: skip
def test_mistakes_in_points(tmp_path: Path, points: str, what: str) -> None:
    (tmp_path / "heights.txt").write_text(points)
    (tmp_path / "setup.toml").write_text(HEAD + '[height_map]\nfile = "heights.txt"\n')
    findings = Findings()
    setup, _ = load_setup(tmp_path / "setup.toml", findings)
    assert setup is None
    assert what in findings.kept[0].message


@pytest.mark.parametrize(
    ("text", "line", "what"),
    [
        ("[cylinder]\nradius = 0\n", 3, "greater than 0"), ("[cylinder]\nradios = 3\n", 3, "radios"),
        ("[height_map]\nx = 1\n", 2, "height_map.y is missing"),
        ("[height_map]\nfile = \"none.txt\"\n", 3, "no such file"),
        ("[height_map]\nfile = \"" + "n" * 400 + "\"\n", 3, "no such file"),
        ("[height_map]\nfile = \"a\\u0000b\"\n", 3, "no such file"),
        (GRID.replace("0.2]", "]"), 6, "of one length"), (GRID.replace("0.2]", '"a"]'), 6, "list of numbers"),
    ],
)  # fmt: skip
def test_mistakes_in_cylinder_and_height_map(tmp_path: Path, text: str, line: int, what: str) -> None:
    (tmp_path / "setup.toml").write_text(HEAD + text)
    findings = Findings()
    load_setup(tmp_path / "setup.toml", findings)
    assert any(f.span.line == line and what in f.message for f in findings.kept), [f.message for f in findings.kept]


def test_heads_and_what_is_in_force(tmp_path: Path) -> None:
    text = 'units = "inch"\n[heads.1]\nx = 2\ny = [-1, 1]\n[heads.4]\nz = -3\n'
    setup = setup_of(tmp_path, HEAD + text + "[transform]\nangle = -390\nfactor = 0.5\nx = 1\ny = -2\n")
    assert setup.heads == {
        (1, "x"): Interval(50.8, 50.8), (1, "y"): Interval(-25.4, 25.4), (4, "z"): Interval(-76.2, -76.2),
    }  # fmt: skip
    assert setup.transform == InForce(angle=-390.0, factor_x=0.5, factor_y=0.5, x=25.4, y=-50.8)
    assert setup.interval("head.1.y") == Interval(-25.4, 25.4)
    assert setup.interval("head.2.x") is None


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("[transform]\n", InForce()),
        ("[transform]\nangle = 0\n", InForce(angle=0.0)),
        ("[transform]\nangle = 720\nfactor = 1\n", InForce(angle=720.0, factor_x=1.0, factor_y=1.0)),
        (
            "[transform]\nangle = 180\nfactor_x = 1\nfactor_y = -2\nx = 0\ny = 1\n",
            InForce(angle=180.0, factor_x=1.0, factor_y=-2.0, y=1.0),
        ),
    ],
)
def test_forms_of_what_is_in_force(tmp_path: Path, text: str, expected: InForce) -> None:
    assert setup_of(tmp_path, HEAD + text).transform == expected


def test_parameters_that_the_setup_may_state(tmp_path: Path) -> None:
    text = "5051 = [1, 2]\n5061 = 3\n5067 = 1\n5068 = [0, 0]\n5069 = [0, 9]\n5220 = 2\n5230 = 0\n5390 = 2\n"
    text += "5391 = 4\n5394 = 9\n"
    setup = setup_of(tmp_path, HEAD + "[parameters]\n" + text)
    assert setup.parameters == {5061: 3.0, 5067: 1.0, 5220: 2.0, 5230: 0.0, 5390: 2.0, 5391: 4.0, 5394: 9.0}
    assert sorted(setup.parameter_ranges) == [5051, 5068, 5069]
