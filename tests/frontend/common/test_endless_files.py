"""Files that a few bytes make endless: each is answered with its finding in seconds."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from support.command import in_this_process
from support.guarded import alarm

from gproof.driver.dialects import load_machine, load_setup
from gproof.frontend.common.dxf import DxfError, layers, open_drawing
from gproof.ir.finding import Findings

HEAD = {"machine": 'schema = "gproof-machine/1"\nunits = "mm"\n', "setup": 'schema = "gproof-setup/1"\n'}
TEXTS = {
    "a dotted key": "a." * 20_000 + "b = 1\n",
    "a dotted key with blanks": "a . " * 20_000 + "b = 1\n",
    "a quoted key": '"a".' * 20_000 + "b = 1\n",
    "a dotted table": "[" + "a." * 20_000 + "b]\n",
    "a dotted key in a table": "x = {" + "a." * 20_000 + "b = 1}\n",
    "brackets": "a = " + "[" * 100_000 + "\n",
    "braces": "a = " + "{a=" * 100_000 + "\n",
    "digits": "a = " + "9" * 5000 + "\n",
    "digits of a fraction": "a = 0." + "9" * 1_000_000 + "\n",
    "an exponent": "a = 1e999999999\n",
    "hexadecimal digits": "a = 0x" + "f" * 1_000_000 + "\n",
}


@pytest.mark.parametrize("kind", HEAD)
@pytest.mark.parametrize("name", TEXTS)
def test_files_of_toml(kind: str, name: str, tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(HEAD[kind] + TEXTS[name])
    findings = Findings()
    with alarm(10):
        found, _ = load_machine(path, findings) if kind == "machine" else load_setup(path, findings)
    assert found is None
    assert findings.kept[0].code.label in ("GP601", "GP611")


def test_keys_of_ours_and_long_texts_are_no_such_keys(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(HEAD["setup"] + "name = '" + "a.b " * 1000 + "'\n# " + "." * 1000 + "\nwork.1.x = 1.5\n")
    findings = Findings()
    assert load_setup(path, findings)[0] is not None, findings.kept


def drawing(
    path: Path, *, columns: int = 1, rows: int = 1, depth: int = 1, twice: bool = False, empty: bool = False
) -> Path:
    import ezdxf

    document = ezdxf.new()
    for level in range(depth):
        block = document.blocks.new(f"B{level}")
        if level == 0 and not empty:
            block.add_circle((0, 0), 1)
        for at in range((2 if twice else 1) if level else 0):
            block.add_blockref(f"B{level - 1}", (at, 0))
    document.modelspace().add_blockref(
        f"B{depth - 1}", (0, 0),
        dxfattribs={"column_count": columns, "row_count": rows, "column_spacing": 3, "row_spacing": 3},
    )  # fmt: skip
    document.saveas(path)
    return path


@pytest.mark.parametrize("empty", [False, True])
@pytest.mark.parametrize(
    "shape", [{"columns": 10_000, "rows": 10_000}, {"columns": 32_000}, {"depth": 16, "twice": True}]
)
def test_arrays_of_blocks(shape: dict[str, int], empty: bool, tmp_path: Path) -> None:
    sheet = open_drawing(drawing(tmp_path / "a.dxf", empty=empty, **shape))  # type: ignore[arg-type]
    began = time.process_time()
    with alarm(30):
        try:
            layers(sheet, None, 0.1, 0.01)
        except DxfError as error:
            assert "copies" in str(error) or "corners" in str(error)
    assert time.process_time() - began < 20


def test_a_panel_is_read(tmp_path: Path) -> None:
    sheet = open_drawing(drawing(tmp_path / "a.dxf", columns=20, rows=10))
    assert sum(len(layer.rings) for layer in layers(sheet, None, 0.1, 0.01).values()) == 200


CALLS = {
    "eding": ("".join(f"SUB s{n}\nGOSUB s{n + 1}\nGOSUB s{n + 1}\nENDSUB\n" for n in range(1, 41)),
              "SUB s41\nG1 X1 F100\nENDSUB\nGOSUB s1\nM30\n"),
    "one line that calls itself": ("SUB s1\nGOSUB s1\nGOSUB s1\nENDSUB\n", "GOSUB s1\nM30\n"),
}  # fmt: skip


@pytest.mark.parametrize("name", CALLS)
def test_subprograms_that_double(name: str, tmp_path: Path) -> None:
    (tmp_path / "a.cnc").write_text("".join(CALLS[name]))
    began = time.process_time()
    with alarm(40):
        done = in_this_process(("check", "a.cnc", "--dialect", "eding"), tmp_path)
    assert done.exit in (1, 2)
    assert "GP233" in done.out or "GP232" in done.out or "recursion" in done.out, done.out[:500]
    assert time.process_time() - began < 20
