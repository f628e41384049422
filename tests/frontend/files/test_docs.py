"""The examples in the pages on machine and setup files are read without a finding, and name every key."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import ezdxf
import pytest

from gproof.driver.dialects import load_machine, load_setup
from gproof.frontend.eding.prepare import FUNCTIONS
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import Findings
from gproof.ir.rules import UNARY

DOCS = Path(__file__).resolve().parents[3] / "docs"


def examples(page: str) -> list[str]:
    return re.findall(r"```toml\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.DOTALL)


def of_any_controller(page: str) -> list[str]:
    """The complete files of a page that need no controller file: a small one, and one with every key."""
    return [text for text in examples(page) if text.startswith("schema") and 'base = "' not in text[:80]]


FILES = [
    pytest.param(text, load, id=f"{page}-{at}")
    for page, load in (("machine-files.md", load_machine), ("setup-files.md", load_setup))
    for at, text in enumerate(of_any_controller(page))
]


@pytest.mark.parametrize(("text", "load"), FILES)
def test_examples_are_read(tmp_path: Path, text: str, load: Any) -> None:
    path = tmp_path / "example.toml"
    path.write_text(re.sub(r"^base = .*$", "", text, flags=re.MULTILINE), encoding="utf-8")
    findings = Findings()
    value, _ = load(path, findings)
    assert [f.message for f in findings.kept] == []
    assert value is not None


def test_the_example_of_wincnc_is_read(tmp_path: Path) -> None:
    path = tmp_path / "router.toml"
    text = next(text for text in examples("machine-files.md") if "\n[controls]" in text)
    path.write_text(text.replace('base = "WINCNC.INI"\n', ""), encoding="utf-8")
    findings = Findings()
    machine, _ = load_machine(path, findings)
    assert not findings.kept
    assert machine is not None
    assert wincnc_settings(machine).nesting == 8


def test_the_example_of_mcuwin_is_read(tmp_path: Path) -> None:
    path = tmp_path / "mill.toml"
    path.write_text(next(text for text in examples("machine-files.md") if "\n[din]" in text), encoding="utf-8")
    (tmp_path / "McuWIN.ini").write_text("[MCU]\nMessageTask0Continue=1\n")
    (tmp_path / "ToolComp.INI").write_text("[ToolsXY]\nR1=5,0\n")
    findings = Findings()
    machine, files = load_machine(path, findings)
    assert not findings.kept
    assert machine is not None
    assert len(files) == 3


def test_the_example_of_a_workpiece_is_read(tmp_path: Path) -> None:
    text = next(text for text in examples("setup-files.md") if "\n[stock]" in text)
    path = tmp_path / "setup.toml"
    path.write_text('schema = "gproof-setup/1"\n' + text, encoding="utf-8")
    drawing = ezdxf.new(units=4)  # type: ignore[attr-defined]
    for layer, radius in (("OUTLINE", 40), ("POCKETS", 10), ("HOLES", 3)):
        drawing.modelspace().add_circle((50, 50), radius, {"layer": layer})
    drawing.saveas(tmp_path / "bracket.dxf")
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
    lines = ["facet\n" + "".join("vertex {} {} {}\n".format(*corners[k]) for k in face) + "endfacet" for face in faces]
    (tmp_path / "vise.stl").write_text("\n".join(["solid", *lines, "endsolid"]))
    findings = Findings()
    setup, files = load_setup(path, findings)
    assert [f.message for f in findings.kept] == []
    assert setup is not None and setup.workpiece is not None
    assert len(files) == 3
    assert [len(bodies) for bodies in (setup.workpiece.stock, setup.workpiece.part, setup.workpiece.fixtures)] == [
        1,
        4,
        3,
    ]


def test_every_key_of_the_code_is_on_its_page() -> None:
    for source, page in (
        ("files/machine.py", "machine-files.md"), ("mcuwin/machine_table.py", "machine-files.md"),
        ("files/setup.py", "setup-files.md"), ("files/tool_table.py", "machine-files.md"),
        ("files/workpiece.py", "setup-files.md"),
    ):  # fmt: skip
        code = (DOCS.parent / "frontend" / source).read_text(encoding="utf-8")
        readers = r"\.(?:text|number|positive|ratio|interval|whole|boolean|table|numbered|take)\(\"(\w+)\""
        keys = set(re.findall(readers, code))
        assert keys - set(re.findall(r"\w+", "\n".join(examples(page)))) == set()


def test_functions_are_those_of_the_rules() -> None:
    assert set(UNARY) >= FUNCTIONS
