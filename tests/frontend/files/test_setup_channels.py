"""Setup files of WinCNC machines: channels, stored places, answers, measures, letters of axes; mistakes by line."""

from __future__ import annotations

from pathlib import Path

import pytest

from gproof.driver.dialects import load_setup
from gproof.frontend.files.setup_channels import columns_of
from gproof.ir.finding import Findings
from gproof.ir.machine import NO_MACHINE, Axis, AxisKind, Machine
from gproof.ir.setup import Interval, Setup, StoredPosition
from gproof.ir.text import parse_ir, print_ir

TWO_HEADS = Machine(
    name="two heads",
    axes=(
        *(Axis(name=name, kind=AxisKind.LINEAR) for name in "xyz"),
        Axis(name="a", kind=AxisKind.LINEAR, letter="W"),
        Axis(name="c", kind=AxisKind.ROTARY),
    ),
)
HEAD = 'schema = "gproof-setup/1"\n'
WHOLE = f"""{HEAD}units = "inch"
homed = ["w", "x"]
start = {{w = 1.0, c = 90.0}}
answers = ["yes", "no", "yes"]

[measures]
z = -5.25
w = [-2.0, -1.0]

[contacts]
z = [-3.5, -2.25]

[positions.P4]
x = 12.5
w = -1.0
c = 45.0
lift = true
clearance = -0.5

[positions.H07]
y = 1.0
lift = false

[inputs]
6 = 0
7 = true

[outputs]
1 = 1

[virtual_inputs]
64 = false
"""


def load(folder: Path, text: str, machine: Machine = TWO_HEADS) -> tuple[Setup | None, list[str]]:
    path = folder / "setup.toml"
    path.write_text(text, encoding="utf-8")
    findings = Findings()
    setup, _ = load_setup(path, findings, machine)
    return setup, [f"{f.span.line} {f.code.label} {f.message}" for f in findings.kept]


def test_every_key(tmp_path: Path) -> None:
    setup, found = load(tmp_path, WHOLE)
    assert found == []
    assert setup == Setup(
        name="setup.toml",
        homed=("x", "a"),
        start={"a": Interval(25.4, 25.4), "c": Interval(90.0, 90.0)},
        measures={"z": Interval(-133.35, -133.35), "a": Interval(-50.8, -25.4)},
        contacts={"z": Interval(-88.9, -57.15)},
        positions={
            "P4": StoredPosition(axes={"x": 317.5, "a": -25.4, "c": 45.0}, lift=True, clearance=-12.7),
            "H7": StoredPosition(axes={"y": 25.4}),
        },
        inputs={6: 0.0, 7: 1.0},
        outputs={1: 1.0},
        virtual={64: 0.0},
        answers={1: 1.0, 2: 0.0, 3: 1.0},
    )
    assert parse_ir(print_ir(setup)) == setup


def test_digital_inputs_of_axes_go_by_the_names_that_programs_have(tmp_path: Path) -> None:
    """McuWIN manual 4.11, 7: by the place of the axis in the machine; the second head is the fourth one here."""
    setup, found = load(tmp_path, f'{HEAD}[inputs]\n"X.digib.5" = 1\n"w.digib.12" = 0\n')
    assert found == []
    assert setup is not None
    assert setup.inputs == {105: 1.0, 412: 0.0}


def test_measures_are_those_in_force_at_the_start() -> None:
    setup = Setup(measures={"z": Interval(-5.0, -5.0)}, tool_lengths={3: Interval(-6.0, -6.0)})
    assert setup.interval("tool.0.z") == Interval(-5.0, -5.0)
    assert setup.interval("tool.0.a") is None
    assert setup.interval("tool.3.z") == Interval(-6.0, -6.0)


def test_without_a_machine_axes_go_by_their_columns() -> None:
    assert [name for name, _ in columns_of(NO_MACHINE).items()] == list("xyzabc")
    assert columns_of(TWO_HEADS)["w"] == ("a", False)
    assert "a" not in columns_of(TWO_HEADS)
    assert columns_of(TWO_HEADS)["c"] == ("c", True)


@pytest.mark.parametrize(
    ("text", "finding"),
    [
        ('homed = ["a"]', "2 GP603 homed"),
        ("start = {a = 1.0}", "2 GP611 there is no key 'start.a'"),
        ('answers = "yes"', "2 GP603 answers"),
        ('answers = ["yes", "maybe"]', "2 GP603 answers"),
        ("answers = [true]", "2 GP603 answers"),
        ("[inputs]\n65 = 1", "3 GP603 inputs.65"),
        ("[inputs]\n0 = 1", "3 GP603 inputs.0"),
        ("[inputs]\n3 = 2", "3 GP603 inputs.3"),
        ('[inputs]\n"V.digib.1" = 1', "3 GP603 inputs.V.digib.1"),
        ('[inputs]\n"X.digib.0" = 1', "3 GP603 inputs.X.digib.0"),
        ('[inputs]\n"X.digib.1" = 1\n"x.DIGIB.1" = 1', "4 GP603 inputs.x.DIGIB.1"),
        ('[outputs]\n"X.digib.1" = 1', "3 GP603 outputs.X.digib.1"),
        ("[inputs]\nx.digib.1 = 1", "3 GP603 inputs.x"),
        ('[outputs]\n3 = "on"', "3 GP603 outputs.3"),
        ("[virtual_inputs]\nx = 1", "3 GP603 virtual_inputs.x"),
        ("[positions.X4]\nx = 1.0", "2 GP603 positions.X4"),
        ("[positions]\nP4 = 1.0", "3 GP603 positions.P4"),
        ("[positions.P4]\nx = 1.0", "2 GP604 positions.P4.lift"),
        ("[positions.P4]\nlift = false\na = 1.0", "4 GP611 there is no key 'positions.P4.a'"),
        ("[positions.P4]\nlift = 1", "3 GP603 positions.P4.lift"),
        ("[measures]\nz = [2.0, 1.0]", "3 GP603 measures.z"),
        ("[contacts]\na = 1.0", "3 GP611 there is no key 'contacts.a'"),
    ],
)
def test_mistakes(tmp_path: Path, text: str, finding: str) -> None:
    setup, found = load(tmp_path, f"{HEAD}{text}\n")
    assert found
    assert found[0].startswith(finding)
    assert setup is None
