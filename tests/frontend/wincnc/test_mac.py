"""CNC.MAC by hand from the manual, "Macro File Configuration"."""

from __future__ import annotations

import hashlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gproof.frontend.wincnc.mac_file import Macro, code_name, read_macros
from gproof.ir.dialects.wincnc.settings import Lexical
from gproof.ir.finding import Finding, Findings
from gproof.ir.program import SourceFile


def read(text: str | bytes, lexical: Lexical | None = None) -> tuple[dict[str, Macro], list[Finding]]:
    data = text if isinstance(text, bytes) else text.encode()
    findings = Findings()
    source = SourceFile(name="CNC.MAC", sha256=hashlib.sha256(data).hexdigest(), data=data)
    return read_macros(source, findings, lexical or Lexical())[0], findings.kept


def texts(text: str | bytes, lexical: Lexical | None = None) -> dict[str, str]:
    macros, kept = read(text, lexical)
    assert kept == []
    return {name: macro.text for name, macro in macros.items()}


def test_a_shop_s_file() -> None:
    text = "[outputs]\nM3 = M98 Spin.mac   [up to speed]\nm4=M11C2\n\nM2=[\nG28=M98 HOME.MAC\nPark=G53 Z\nL5.1=~L5XY\n"
    assert texts(text) == {
        "M3": "M98 Spin.mac", "M4": "M11C2", "M2": "", "G28": "M98 HOME.MAC", "PARK": "G53 Z", "L5.1": "~L5XY",
    }  # fmt: skip


def test_empty_and_blank_files_define_nothing() -> None:
    assert texts("") == texts("\r\n \r\n") == texts("[nothing here]\n(nor here)\n% nor here\n") == {}


def test_the_place_of_a_command() -> None:
    macros, kept = read("\n  M05 =  M12 C1 [off]\n")
    assert kept == []
    macro = macros["M5"]
    assert (macro.text, macro.column) == ("M12 C1", 10)
    assert (macro.span.line, macro.span.column, macro.span.end_column) == (2, 10, 16)


@pytest.mark.parametrize(
    ("written", "name"),
    [("m03", "M3"), ("G28", "G28"), ("g 28", "G28"), ("L5.10", "L5.1"), ("G92.0", "G92"), ("spin_up", "SPIN_UP"),
     ("T1", "T1"), ("M", "M"), ("3M", None), ("", None), ("G28 X", None), ("µ", None)],
)  # fmt: skip
def test_names(written: str, name: str | None) -> None:
    assert code_name(written) == name


def test_comment_signs_of_the_machine_file_end_a_command() -> None:
    lexical = Lexical(comment_signs=";'")
    assert texts("; M1=M2\nM1=M11C1 ; on\nM6=M98 T.TAP 'change", lexical) == {"M1": "M11C1", "M6": "M98 T.TAP"}
    assert texts("M1=M11C1 (on\nM2=M12C1 % off\n") == {"M1": "M11C1", "M2": "M12C1"}


def test_a_bracket_in_a_text_in_quotes_is_no_comment() -> None:
    assert texts('ASK=G5 T1 M"Clamp [left] shut?" [ask]') == {"ASK": 'G5 T1 M"Clamp [left] shut?"'}


def test_braces_and_case_stay() -> None:
    assert texts("M6=M98 Change.mac t{t}\nDOWN=G92.2 Z{TH1+2}") == {
        "M6": "M98 Change.mac t{t}", "DOWN": "G92.2 Z{TH1+2}",
    }  # fmt: skip


def test_windows_1252_and_a_utf8_mark() -> None:
    assert texts(b"M1=G5 M\x93T\xfcr\x94\r\n") == {"M1": "G5 M“Tür”"}
    assert texts(b"\xef\xbb\xbfM1=M11C1\n") == {"M1": "M11C1"}


@pytest.mark.parametrize(
    ("text", "label", "line", "column"),
    [
        ("M1=M11C1\nspindle on\n", "GP101", 2, 1),
        ("  3X=M11C1", "GP113", 1, 3),
        ("?=M11C1", "GP101", 1, 1),
        ("N10 M7=M11C2", "GP113", 1, 1),
        ("M1=", "GP603", 1, 1),
        ("M1=M11C1\nM01=M11C2", "GP603", 2, 5),
        ("DEPTH=12.5", "GP113", 1, 7),
        ("DEPTH={TH1+1}", "GP113", 1, 7),
        ("M1=M11C1 [on] C2", "GP134", 1, 15),
        ("  [on] G28=M98 HOME.MAC", "GP134", 1, 8),
        ("M1=M11\x00C1", "GP101", 1, 7),
    ],
)
def test_lines_that_define_nothing(text: str, label: str, line: int, column: int) -> None:
    _, kept = read(text)
    assert [(f.code.label, f.span.line, f.span.column) for f in kept] == [(label, line, column)]


def test_the_same_definition_twice_is_one() -> None:
    assert texts("M1=M11C1 [a]\nm1 = M11C1") == {"M1": "M11C1"}


@given(st.binary(max_size=200))
def test_no_bytes_end_in_a_traceback(data: bytes) -> None:
    macros, _ = read(data)
    for name, macro in macros.items():
        assert code_name(name) == name == macro.name
        assert macro.text == macro.text.strip()


@given(
    name=st.sampled_from(["M3", "g28", "L5.1", "park"]),
    text=st.sampled_from(["M98 A.TAP", "M11C2", 'G5 M"[a]"', "~G28X"]),
    blanks=st.lists(st.sampled_from(["", " ", "\t", "  "]), min_size=4, max_size=4),
    comment=st.sampled_from(["", "[x]", "[x", "(y) [z]", "% w"]),
)
def test_blanks_and_comments_change_nothing(name: str, text: str, blanks: list[str], comment: str) -> None:
    line = f"{blanks[0]}{name}{blanks[1]}={blanks[2]}{text}{blanks[3]}{comment}"
    assert texts(line) == {name.upper(): text}
