"""Files: encodings, ends of lines, sizes, the macro file, and the text form of loaded programs."""

from __future__ import annotations

import hashlib
import os
import threading
import time
import tracemalloc
from pathlib import Path

import pytest
from frontend.eding.programs import load, program_of, shown, table_words
from frontend.eding.test_statements import STRUCTURED

from gproof.frontend.eding import load as loading
from gproof.frontend.eding.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.program import BlockTable, Program, words_equal
from gproof.ir.text import parse_ir, print_ir

CORPUS = sorted((Path(__file__).resolve().parents[3] / "corpus" / "eding").glob("*/job.cnc"))


def table_of(program: Program, number: int = 0) -> BlockTable:
    table = [node for node in program.body if isinstance(node, BlockTable)][number]
    assert isinstance(table, BlockTable)
    return table


@pytest.mark.parametrize("end", ["\n", "\r\n"])
@pytest.mark.parametrize("last", [True, False])
def test_ends_of_lines(tmp_path: Path, end: str, last: bool) -> None:
    text = end.join(["g0 x1 (a)", "#1=2 ; b", "", 'msg "c"', "y2"]) + (end if last else "")
    program = program_of(tmp_path, text)
    assert program.line_count == 5
    assert table_words(program, table_of(program)) == [(1, "G", 0.0, 0), (1, "X", 1.0, 0)]
    assert table_words(program, table_of(program, 1)) == [(5, "Y", 2.0, 0)]


def test_a_byte_order_mark_is_passed_over(tmp_path: Path) -> None:
    program = program_of(tmp_path, b"\xef\xbb\xbfg0 x1\n#1=2\n")
    assert table_of(program).begin == 3
    assert len(table_words(program, table_of(program))) == 2
    _, findings = load(tmp_path, b"\xef\xbb\xbfg0 x\n")
    assert shown(findings) == [("GP108", 1, 4, 5)]


def test_comments_in_any_encoding(tmp_path: Path) -> None:
    program_of(tmp_path, b"g0 x1 (gr\xfcn)\n#1=2 (gr\xfcn \x81)\n#1=2 ; \xc3\xa9\n")


def test_columns_count_characters(tmp_path: Path) -> None:
    _, findings = load(tmp_path, "(é – ü) x\n".encode())
    assert shown(findings) == [("GP108", 1, 9, 10)]
    _, findings = load(tmp_path, "(é ü) x\n".encode("latin-1"))
    assert shown(findings) == [("GP108", 1, 7, 8)]


def test_names_and_hashes_of_files(tmp_path: Path) -> None:
    text = b"g0 x1\n"
    program = program_of(tmp_path, text)
    (source,) = program.files
    assert source.name == str(tmp_path / "job.cnc")
    assert source.sha256 == hashlib.sha256(text).hexdigest()


def test_the_macro_file_beside_the_job_gives_its_subprograms(tmp_path: Path) -> None:
    (tmp_path / "macro.cnc").write_text("g0 x99\nsub change_tool\n  m6 t[#5011]\nendsub\nsub other\nendsub\n")
    program = program_of(tmp_path, "gosub other\ng0 x1\nm30\n")
    assert sorted(program.subprograms) == ["change_tool", "other"]
    assert [type(node).__name__ for node in program.body] == ["Call", "BlockTable"]
    assert [Path(f.name).name for f in program.files] == ["job.cnc", "macro.cnc"]
    body = program.subprograms["change_tool"].body
    assert all(node.file == 1 for node in body if isinstance(node, BlockTable))


def test_the_macro_file_as_the_job_is_loaded_once(tmp_path: Path) -> None:
    (tmp_path / "macro.cnc").write_text("sub a\nx1\nendsub\ngosub a\n")
    findings = Findings()
    program = load_program(tmp_path / "macro.cnc", findings)
    assert program is not None
    assert findings.kept == []
    assert len(program.files) == 1


def test_a_named_macro_file_and_its_mistakes(tmp_path: Path) -> None:
    (tmp_path / "my.cnc").write_text("sub a\nx\nendsub\nsub b\nendsub\n")
    (tmp_path / "job.cnc").write_text("sub b\nendsub\ngosub a\ngosub b\nm30\n")
    findings = Findings()
    program = load_program(tmp_path / "job.cnc", findings, tmp_path / "my.cnc")
    assert program is not None
    found = sorted((f.code.label, Path(f.span.file).name, f.span.line) for f in findings.kept)
    assert found == [("GP108", "my.cnc", 2), ("GP116", "my.cnc", 4)]


MACRO = """\
x                       ; 1 outside: never runs with the job
sub a
  y                     ; 3
  if [1
    gosub b
  endif
endsub
sub b
  while [1]
    gosub none          ; 10
  endwhile
endsub
sub m100
  z                     ; 14
endsub
sub change_tool
  f                     ; 17
endsub
sub user_1
  s                     ; 20
  gosub none            ; 21
  gosub a
endsub
sub a-9
endsub
"""


@pytest.mark.parametrize(
    ("job", "reached"),
    [
        ("m30", set()),
        ("gosub b", {10}),
        ("if [#1]\nelse\nwhile [#1]\ngosub a\nendwhile\nendif", {3, 4, 10}),
        ("sub own\ngosub a\nendsub", set()),
        ("sub own\ngosub a\nendsub\ngosub own", {3, 4, 10}),
        ("sub m5\ngosub user_1\nendsub", set()),
        ("sub m5\ngosub user_1\nendsub\nm5", {3, 4, 10, 20, 21}),
        ("g0 x1\nt1 m6", {17}),
        ("m[5 + 1]", {14, 17}),
        ("g0 x[1] m100", {14}),
        ("if [#1]\ng1 x1 f100\nm06\nendif", {17}),
        ("sub own\nm6\nendsub\ngosub own", {17}),
    ],
)
def test_mistakes_of_the_macro_file_count_where_the_job_may_run_them(
    tmp_path: Path, job: str, reached: set[int]
) -> None:
    """GP126 elsewhere."""
    (tmp_path / "macro.cnc").write_text(MACRO)
    program, findings = load(tmp_path, job + "\n")
    assert program is not None
    found = {f.span.line: f.code.label for f in findings.kept if Path(f.span.file).name == "macro.cnc"}
    lines = {1: "GP108", 3: "GP108", 4: "GP107", 10: "GP115", 14: "GP108", 17: "GP108", 20: "GP108", 21: "GP115"}
    expected = {line: code if line in reached else "GP126" for line, code in lines.items()} | {24: "GP126"}
    assert found == expected


def test_the_job_itself_has_no_mistake_that_does_not_count(tmp_path: Path) -> None:
    _, findings = load(tmp_path, "sub a\nx\ngosub none\nendsub\nm30\n")
    assert [f.code.label for f in findings.kept] == ["GP108", "GP115"]


def test_a_macro_file_that_can_not_be_read_refuses_the_job(tmp_path: Path) -> None:
    (tmp_path / "job.cnc").write_text("m30\n")
    findings = Findings()
    assert load_program(tmp_path / "job.cnc", findings, tmp_path / "none.cnc") is None
    assert [f.code.label for f in findings.kept] == ["GP601"]


@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.parent.name)
def test_the_corpus_loads_and_its_text_form_reads_back(path: Path) -> None:
    program = load_program(path, Findings())
    assert program is not None
    program.verify()
    text = print_ir(program)
    again = parse_ir(text)
    assert again == program
    assert print_ir(again) == text


def test_the_text_form_of_a_structured_program(tmp_path: Path) -> None:
    program = program_of(tmp_path, STRUCTURED + '(MSG, a)\nmsg "x"#1\ntcaguard off\nzhcaddpoint\n#1=[1 < 2 + 3]\n')
    assert parse_ir(print_ir(program)) == program


def test_large_tables_are_scanned_when_they_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = "g0 x1.5 y-2\n" * 30
    small = program_of(tmp_path, text)
    monkeypatch.setattr(loading, "HELD_LINES", 10)
    large = program_of(tmp_path, text)
    held, bare = table_of(small), table_of(large)
    assert held.words is not None
    assert bare.words is None
    words, after, line = large.load(bare, bare.begin, bare.first_line, 10**6)
    assert (after, line) == (bare.end, 31)
    assert words_equal(words, held.words)
    assert table_words(large, bare) == table_words(small, held)


def test_tables_hold_words_only_up_to_a_sum(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loading, "HELD_IN_ALL", 3)
    program = program_of(tmp_path, "x1\n#1=1\n" * 5)
    held = [node.words is not None for node in program.body if isinstance(node, BlockTable)]
    assert held == [True, True, True, False, False]


def test_a_mapped_file_loads_as_a_read_one(tmp_path: Path) -> None:
    text = b"g1 x1 y2 f300\n" * 100_000 + b"#1=2\nx3\n"
    program = program_of(tmp_path, text)
    assert not isinstance(program.files[0].data, bytes)
    assert program.line_count == 100_002
    assert [type(node).__name__ for node in program.body] == ["BlockTable", "Block", "BlockTable"]
    assert table_of(program).words is None


def test_one_line_of_five_million_characters(tmp_path: Path) -> None:
    started = time.process_time()
    _, findings = load(tmp_path, b"g1 x1 " * 850_000)
    assert shown(findings) == [("GP106", 1, 257, 5_100_001)]
    assert time.process_time() - started < 2


def test_memory_does_not_grow_with_plain_lines(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GPROOF_KERNELS", "numba")
    program_of(tmp_path, b"g1 x1\n")  # numba is in memory
    path = tmp_path / "long.cnc"
    path.write_bytes(b"g1 x1.25 y2.5 f300\n" * 500_000)
    tracemalloc.start()
    program = load_program(path, Findings())
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert program is not None
    assert peak < 3_000_000


def test_a_job_from_a_pipe(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.cnc"
    os.mkfifo(pipe)
    writer = threading.Thread(target=pipe.write_bytes, args=(b"g0 x1\nm30\n",))
    writer.start()
    program = load_program(pipe, Findings())
    writer.join()
    assert program is not None
    assert program.line_count == 2


def test_flow_control_in_a_job_of_super_long_file_mode(tmp_path: Path) -> None:
    """2.1.14: files beyond SuperLongFileModeCriterion have no while, if and subroutines; macro.cnc goes on."""
    from gproof.frontend.eding.long_file import judge_length

    def told(text: str, criterion: float | None, macro: str = "") -> list[tuple[str, int]]:
        (tmp_path / "job.cnc").write_text(text, encoding="utf-8")
        (tmp_path / "macro.cnc").write_text(macro, encoding="utf-8")
        findings = Findings()
        program = load_program(tmp_path / "job.cnc", findings)
        assert program is not None
        judge_length(program, criterion, findings)
        return [(f.code.label, f.span.line) for f in findings.kept]

    plain = "G0 X1\n" * 20
    for flow in ("#1 = 0\nwhile [#1 < 1]\n#1 = 1\nendwhile\n", "#1 = 0\nif [#1 == 0]\nendif\n"):
        assert told(plain + flow, 0.1) == [("GP113", 22)]
        assert told(plain + flow, 1.0) == []
        assert told(plain + flow, None) == []
    assert told(plain + "gosub a\n", 0.1, "sub a\nendsub\n") == [("GP113", 21)]
    assert told(plain + "gosub a\nsub a\nendsub\n", 0.1) == [("GP113", 21)]
    assert told(plain, 0.1, "sub change_tool\nif [1 == 1]\nendif\nendsub\n") == []
