"""Blocks, comments, messages and the statements of chapter 4: which forms are accepted and what they become."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from frontend.eding.programs import program_of, table_words, without_places

from gproof.frontend.eding.parse import parse_line
from gproof.ir.program import (
    Binary,
    Block,
    BlockTable,
    Call,
    Device,
    Guard,
    If,
    Message,
    Number,
    Text,
    Unsupported,
    Variable,
    While,
)
from gproof.ir.rules import DEVICES


def parse(line: str | bytes) -> list[object]:
    return list(parse_line(line.encode() if isinstance(line, str) else line, "job.cnc", 7))


def test_a_block_has_words_settings_and_its_comment() -> None:
    (block,) = parse("/N10 g1 #1 = 3 x#1 (first) y[2] (last) ; rest")
    assert isinstance(block, Block)
    assert [word.letter for word in block.words] == ["G", "X", "Y"]
    assert [without_places(a.value) for a in block.assigns] == [without_places(Number(3.0, block.span))]
    assert block.comment == "last"
    assert block.deleted
    assert (block.span.line, block.span.column, block.span.end_column) == (7, 1, 39)
    spans = [(word.span.column, word.span.end_column) for word in block.words]
    assert spans == [(6, 8), (16, 19), (28, 32)]


def test_a_comment_behind_a_semicolon_is_the_comment_when_there_is_no_other() -> None:
    (block,) = parse("x#1 ; to the left")
    assert isinstance(block, Block)
    assert block.comment == "to the left"


def test_a_message_comment_comes_before_the_block_of_its_line() -> None:
    message, block = parse("g1 x1 ( m sg, Spindle on? )")
    assert isinstance(message, Message)
    assert (message.kind, [part.value for part in message.parts if isinstance(part, Text)]) == ("msg", ["Spindle on?"])
    assert isinstance(block, Block)
    assert len(block.words) == 2


def test_only_the_last_comment_of_a_line_counts() -> None:
    (block,) = parse("g1 x#1 (msg, no) (yes)")
    assert isinstance(block, Block)
    assert block.comment == "yes"


@pytest.mark.parametrize(
    ("line", "kind", "parts"),
    [
        ('msg "Done"', "msg", ["Done"]),
        ('Msg"a="#1" b="#[2+1]', "msg", ["a=", Variable, " b=", Variable]),
        ('msg "nx="[#110 +1]" added" ; note', "msg", ["nx=", object, " added"]),
        ('MSG "x ; y (z"', "msg", ["x ; y (z"]),
        ("errmsg “Timeout”", "error", ["Timeout"]),
        ("msg “this is X=”#1” S=”#11", "msg", ["this is X=", Variable, " S=", Variable]),
        ("warnmsg „unten“", "warning", ["unten"]),
        ('logmsg "Hi" #5001', "log", ["Hi", Variable]),
        ("msg", "msg", []),
        ('dlgmsg "Give" par1 100 "B 2" 101', "dialog", ["Give", "par1", 100.0, "B 2", 101.0]),
        ('N10 (c) msg "a" (d)', "msg", ["a"]),
        ('/msg "a"', "msg", ["a"]),
    ],
)
def test_messages(line: str, kind: str, parts: list[object]) -> None:
    (message,) = parse(line)
    assert isinstance(message, Message)
    assert message.kind == kind
    assert len(message.parts) == len(parts)
    for part, wanted in zip(message.parts, parts, strict=True):
        if isinstance(wanted, type):
            assert isinstance(part, wanted)
        else:
            assert isinstance(part, Text | Number)
            assert part.value == wanted


def test_quotes_and_texts_in_windows_1252() -> None:
    (message,) = parse("msg “grün”".encode("cp1252"))
    assert isinstance(message, Message)
    assert [part.value for part in message.parts if isinstance(part, Text)] == ["grün"]


@pytest.mark.parametrize(
    ("line", "name", "on"),
    [
        ("TCAGuard off", "tool_change_area", False),
        ("tcaguard on ; now", "tool_change_area", True),
        ("MCAGuard ON", "machine_area", True),
        ("mcaguard\toff (c)", "machine_area", False),
    ],
)
def test_guards(line: str, name: str, on: bool) -> None:
    (guard,) = parse(line)
    assert isinstance(guard, Guard)
    assert (guard.name, guard.on) == (name, on)


@pytest.mark.parametrize(
    "line",
    [
        "zhc on", 'zhcload "map.txt"', "ZHCSAVE x", "/zhc on",
    ],
)  # fmt: skip
def test_statements_that_are_not_understood(line: str) -> None:
    (statement,) = parse(line)
    assert isinstance(statement, Unsupported)
    assert statement.what


@pytest.mark.parametrize(
    "line", ["/gosub part", "/ tcaguard off", '/N10 errmsg "no"', "/home x", "/zhc on", '/msg "a"']
)
def test_a_slash_belongs_to_its_statement(line: str) -> None:
    (statement,) = parse(line)
    (plain,) = parse(line.replace("/", " "))
    assert isinstance(statement, Call | Guard | Message | Device | Unsupported)
    assert not plain.deleted  # type: ignore[union-attr]
    assert statement == dataclasses.replace(plain, deleted=True)  # type: ignore[type-var]


@pytest.mark.parametrize(
    ("line", "name", "arguments"),
    [
        ("HomeIsEstop on", "home_is_stop", ["on"]),
        ("homeisestop OFF ;safe", "home_is_stop", ["off"]),
        ("SetLafAngle 3", "laf_angle", [3.0]),
        ("setlafangle -2.5", "laf_angle", [-2.5]),
        ("SetLafAngle [#4 + 1]", "laf_angle", [Binary]),
        ("setlafangle #4", "laf_angle", [Variable]),
        ('SP "positions.txt" 1', "store_position", ["positions.txt", 1.0]),
        ("sp positions.txt", "store_position", ["positions.txt"]),
        ("LogFile “text.txt” 1", "log_file", ["text.txt", 1.0]),
        (r"logfile C:\logs\t.txt", "log_file", [r"C:\logs\t.txt"]),
        ('/logfile "text.txt" #1', "log_file", ["text.txt", Variable]),
        ("Tanknife on", "knife_on", []),
        ("tanknife\ton 90", "knife_on", [90.0]),
        ("TANKNIFE ON -90 (bent)", "knife_on", [-90.0]),
        ("tanknife on [#1]", "knife_on", [Variable]),
        ("Tanknife off", "knife_off", []),
        ("tanknife B", "knife_axis", ["b"]),
        ("tanknife c ;standard", "knife_axis", ["c"]),
        ("tanknife LO", "knife_calibrate", ["lo"]),
        ("tanknife hi", "knife_calibrate", ["hi"]),
        ("home X", "home", ["x"]),
        ("N20 Home c", "home", ["c"]),
        ("HomeTandem X", "home_tandem", ["x"]),
        ("PrepareTandemHome y", "prepare_tandem_home", ["y"]),
        ("MoveSlaveToMaster A", "align_slave", ["a"]),
        ("MoveStaveToMaster A", "align_slave", ["a"]),
        ("ZHCINIT [#4104] #4100 [#4101 + 1]", "height_map_init", [Variable, Variable, Binary]),
        ("zhcinit .5 10 7", "height_map_init", [0.5, 10.0, 7.0]),
        ("ZHCADDPOINT", "height_map_add", []),
        ("zhcs map.txt", "height_map_save", ["map.txt"]),
        ('ZHCS "a map.txt" ;kept', "height_map_save", ["a map.txt"]),
        ("%mx=200", "nesting", ["mx", 200.0]),
        ("% D Y = -1 0.5 ; pitch", "nesting", ["dy", -10.5]),
    ],
)
def test_commands_to_the_controller(line: str, name: str, arguments: list[object]) -> None:
    (device,) = parse(line)
    assert isinstance(device, Device)
    assert device.name == name
    least, most, _ = DEVICES[name]
    assert least <= len(device.arguments) <= most
    for found, wanted in zip(device.arguments, arguments, strict=True):
        if isinstance(wanted, type):
            assert isinstance(found, wanted)
        else:
            assert isinstance(found, Text | Number)
            assert found.value == wanted


def test_every_command_of_a_file_is_a_device_of_the_table(tmp_path: Path) -> None:
    """Also in a whole file: a nesting line looks like the ``%`` of a plain line at its start."""
    program = program_of(tmp_path, "%\n%mx=200\n%my=100\ng0 x1\nzhcaddpoint\nhome z\nm30\n")
    assert [type(node).__name__ for node in program.body] == [
        "Device", "Device", "BlockTable", "Device", "Device", "BlockTable",
    ]  # fmt: skip


STRUCTURED = """\
IF[#1 == 1]
  g0 x1
Else ; otherwise
\tg0 x2
end if
if [#1 > 2] then (why)
  while[#2<3]
    #2 = [#2 + 1]
  end while
endif
N100 GoSub Part
SUB part ;the part
  g1 y1
  if [#3]
    gosub Other
  endif
End Sub
sub Other (another)
endsub
m30
"""


def test_structure(tmp_path: Path) -> None:
    program = program_of(tmp_path, STRUCTURED)
    first, second, call, end = program.body
    assert isinstance(first, If)
    assert [type(node) for node in (*first.then, *first.otherwise)] == [BlockTable, BlockTable]
    assert first.span.line == 1
    assert isinstance(second, If)
    (loop,) = second.then
    assert isinstance(loop, While)
    assert isinstance(loop.body[0], Block)
    assert second.otherwise == ()
    assert isinstance(call, Call)
    assert (call.name, call.span.column) == ("part", 6)
    assert isinstance(end, BlockTable)
    assert (end.first_line, end.last_line) == (20, 20)
    assert sorted(program.subprograms) == ["other", "part"]
    assert [type(node) for node in program.subprograms["part"].body] == [BlockTable, If]
    assert program.subprograms["other"].body == ()
    assert program.subprograms["part"].span.line == 12


def test_tables_are_maximal_runs_with_words(tmp_path: Path) -> None:
    text = "(top)\n\n#1=1\ng0 x1\n(c)\n/ y2\n\n#2=2\n%\n(nothing)\n#3=3\n%\ng1z1"
    program = program_of(tmp_path, text)
    tables = [node for node in program.body if isinstance(node, BlockTable)]
    assert [(t.first_line, t.last_line, t.begin, t.end) for t in tables] == [(4, 7, 12, 28), (12, 13, 50, 56)]
    assert table_words(program, tables[0]) == [(4, "G", 0.0, 0), (4, "X", 1.0, 0), (6, "Y", 2.0, 2)]
    assert table_words(program, tables[1]) == [(13, "G", 1.0, 0), (13, "Z", 1.0, 0)]
    assert program.line_count == 13


def test_plain_lines_and_the_grammar_give_the_same_words() -> None:
    line = "/N10 g0x +0. 12 34y 7 (c) z-.5"
    (block,) = parse(line)
    assert isinstance(block, Block)
    found = [(w.letter, w.value.value, w.span.column) for w in block.words if isinstance(w.value, Number)]
    assert found == [("G", 0.0, 6), ("X", 0.1234, 8), ("Y", 7.0, 19), ("Z", -0.5, 27)]
