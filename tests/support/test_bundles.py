"""Files go into a page and come out as they were."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.bundles import block, files_of, unpacked

TEXTS = st.text(alphabet="GX1 `~#é\n\r\t\x00\x0c", max_size=40).map(str.encode)


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
