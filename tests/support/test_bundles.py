"""Files go into a page and come out as they were."""

from __future__ import annotations

import os
import time
import zipfile
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from support import bundles
from support.bundles import CODE, MANUAL, block, files_of, pages_of, sections, unpacked
from support.campaigns import examples

TEXTS = st.text(alphabet="GX1 `~#é\n\r\t\x00\x0c", max_size=40).map(str.encode)


@examples(100, 5000, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.one_of(TEXTS, st.binary(max_size=300)), max_size=4), st.text(alphabet="a #\n", max_size=20))
def test_a_file_comes_out_as_it_went_in(contents: list[bytes], between: str) -> None:
    files = {f"part/{n}.cnc": content for n, content in enumerate(contents)}
    page = f"# Title\n{between}\n" + f"\n{between}\n".join(block(*one) for one in files.items())
    assert files_of(page) == files


def test_a_block_reads_as_one() -> None:
    assert block("a.toml", b"x = 1\r\n") == "```toml a.toml crlf\nx = 1\n```\n"
    assert files_of("```console\n$ gproof\n```\n\n```gcode a.tap no-end\nG0\n\n```\n") == {"a.tap": b"G0\n"}


@pytest.mark.parametrize(
    ("page", "why"),
    [
        ("```gcode a\nG0\n", "a block is not closed"),
        ("```gcode a\n```\n```gcode a\n```\n", "two files are named a"),
        ("```gcode a strange\n```\n", "a fence has no word strange"),
    ],
)
def test_a_page_that_is_none(page: str, why: str) -> None:
    with pytest.raises(ValueError, match=why):
        files_of(page)


def test_a_tree_is_unpacked_once() -> None:
    assert unpacked("tests/support") is unpacked("tests/support")


def test_a_trace_begins_with_the_text_of_its_section() -> None:
    page = "# Arcs\n\n## half\n\nTwice the\nradius.\n\n"
    page += 'Manual: G2; G3\n\nSetup: `{"inputs": {"1": true}}`\n\nCode: GP401\n\n'
    page += "```gcode half.tap\nG2\n```\n\n```jsonl half.jsonl about\n{}\n```\n"
    _, half = sections(page)
    row = b'{"op": "about", "manual": ["G2", "G3"], "why": "Twice the radius.", "setup": {"inputs": {"1": true}}}'
    assert half.files == {"half.tap": b"G2\n", "half.jsonl": row + b"\n{}\n"}
    assert (half.heading, half.said(MANUAL), half.said(CODE)) == ("half", "G2; G3", "GP401")


def test_pages_of_topics_hold_one_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bundles, "ROOT", tmp_path)
    monkeypatch.setattr(bundles, "BUILT", tmp_path / "build")
    texts = {"mill.md": block("m.toml", b"x"), "mill.arcs.md": block("arc.cnc", b"G2"), "README.md": "", "x.py": ""}
    texts["_two.md"] = block("saw/s.toml", b"1") + block("spoil/s.toml", b"2")
    for tree in ("first", "second"):
        tmp_path.joinpath(tree).mkdir()
        for name, text in texts.items():
            tmp_path.joinpath(tree, name).write_text(text)
        with zipfile.ZipFile(tmp_path / tree / "old.zip", "w") as archive:
            archive.writestr("a.gpx", b"package")
    made = unpacked("first")
    found = {path.relative_to(made).as_posix() for path in made.rglob("*") if path.is_file()}
    assert found == {"README.md", "mill/m.toml", "mill/arc.cnc", "saw/s.toml", "spoil/s.toml", "old/a.gpx"}
    assert [page.name for page in pages_of("first/mill")] == ["mill.arcs.md", "mill.md"]
    tmp_path.joinpath("second", "mill.lines.md").write_text(block("arc.cnc", b"G1"))
    with pytest.raises(ValueError, match=r"two pages hold mill/arc\.cnc"):
        unpacked("second")


def test_states_that_nothing_uses_are_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bundles, "ROOT", tmp_path)
    monkeypatch.setattr(bundles, "BUILT", tmp_path / "build")
    made = {}
    for age in (8, 1, 0):
        for tree in ("pages", "others"):
            tmp_path.joinpath(tree).mkdir(exist_ok=True)
            tmp_path.joinpath(tree, "a.md").write_text(block("a.cnc", str(age).encode()))
            unpacked.cache_clear()
            made[tree, age] = unpacked(tree)
            used = time.time() - age * 24 * 3600
            os.utime(made[tree, age], (used, used))
    unpacked.cache_clear()
    # A tree forgets its own states, when it makes a new one.
    assert [key for key, path in made.items() if not path.exists()] == [("pages", 8), ("others", 8)]
