"""The parser that is kept on disk is the parser that lark would make."""

from pathlib import Path

import pytest

from gproof.frontend.common.grammar import parser

GRAMMAR = """
sum: NUMBER ("+" NUMBER)*
NUMBER: /[0-9]+/
%ignore " "
"""


class Adder:
    def sum(self, numbers: list[str]) -> int:
        return sum(map(int, numbers))


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("GPROOF_CACHE_DIR", str(tmp_path / "cache"))
    (tmp_path / "sum.lark").write_text(GRAMMAR)
    return tmp_path / "cache" / "grammars"


def total(folder: Path, text: str) -> object:
    made: object = parser(folder.parent.parent / "sum.lark", ["sum"], Adder()).parse(text)
    return made


def test_a_kept_parser_answers_as_the_one_that_was_made(cache: Path) -> None:
    assert total(cache, "1 + 2 + 39") == 42
    (kept,) = cache.iterdir()
    before = kept.read_bytes()
    assert total(cache, "20+22") == 42
    assert kept.read_bytes() == before


@pytest.mark.parametrize("damage", ["empty", "cut", "changed"])
def test_a_damaged_file_counts_as_not_there(cache: Path, damage: str) -> None:
    assert total(cache, "1+2") == 3
    (kept,) = cache.iterdir()
    whole = kept.read_bytes()
    middle = len(whole) // 2
    changed = whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1 :]
    kept.write_bytes({"empty": b"", "cut": whole[:-7], "changed": changed}[damage])
    assert total(cache, "1+2") == 3
    assert len(kept.read_bytes()) > middle


def test_another_grammar_has_its_own_file(cache: Path) -> None:
    assert total(cache, "1+2") == 3
    (cache.parent.parent / "sum.lark").write_text(GRAMMAR.replace('"+"', '"&"'))
    assert total(cache, "1&2") == 3
    assert len(list(cache.iterdir())) == 2


def test_no_cache_is_no_error(cache: Path) -> None:
    cache.parent.write_text("a file where the folder would be")
    assert total(cache, "1+2") == 3
