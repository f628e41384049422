"""CNC.MAC: commands that a shop has defined, replaced or switched off.

A line is ``NAME=command [comment]``. NAME is that of a code (``M3``, ``G28``, ``L5.1``) or a word of one's own; what
is after the equals sign is one command, ``[`` alone for none: the code is then passed over.
Source: WinCNC manual, "Macro File Configuration"; comments as in programs ("Parameters: Comment", comchars=). "Braces"
says that variables are defined in this file too, and not how: what can be no command is UNKNOWN.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from gproof.frontend.common.source import UTF8_MARK, decode, read_source
from gproof.frontend.wincnc.file_names import MACRO_FILE
from gproof.frontend.wincnc.ini_file import ENDS_OF_QUOTES
from gproof.ir import codes
from gproof.ir.dialects.accepts import LINE_NUMBERS
from gproof.ir.dialects.wincnc.settings import Lexical, wincnc_settings
from gproof.ir.finding import Findings, Related, Span
from gproof.ir.machine import Machine
from gproof.ir.program import SourceFile
from gproof.ir.record import record

COMMENT_SIGNS = "[(%"
"""Signs that start a comment wherever they are, besides those of comchars=."""

_END_OF_LINE = re.compile(rb"\r\n|\r|\n")
_CLOSED_BY = {"[": "]", "(": ")"}
_CODE = re.compile(r"(?P<letter>[A-Za-z])[ \t]*(?P<whole>[0-9]{1,6})(?:\.(?P<part>[0-9]{0,6}))?", re.ASCII)
_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)
_COMMAND = re.compile(r"~?[ \t]*[A-Za-z]", re.ASCII)
_NUMBERED = re.compile(r"[ \t]*[Nn][ \t]*[0-9]+(?=[ \t]+[A-Za-z_])", re.ASCII)
_NAME_FIRST = re.compile(r"[ \t]*[A-Za-z0-9_]")
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f]")


@record(frozen=True, slots=True)
class Macro:
    """A definition.

    name: upper case, a code without leading zeros: ``M3`` for ``m03``; label: as written; text: its command as written,
    "" for a code that is switched off; span: of the line, its columns those of the text; column: where the text starts,
    from 1; continued: words of the text are after a closed comment, numbered: the line has a number of its own, both
    of which the shop's controller takes.
    """

    name: str
    text: str
    span: Span
    column: int
    label: str
    continued: bool = False
    numbered: bool = False


def read_macros(source: SourceFile, findings: Findings, lexical: Lexical) -> tuple[dict[str, Macro], list[int]]:
    """The definitions of a file by their names; a line that can be none is a finding at its place.

    With them come the lines that say something and define nothing here: a controller may read a definition there.
    """
    macros: dict[str, Macro] = {}
    unread: list[int] = []
    for macro in each_macro(source, findings, lexical, unread):
        macros.setdefault(macro.name, macro)
    return macros, unread


def commands_next_to(files: Sequence[Path], machine: Machine) -> dict[str, str] | None:
    """What CNC.MAC next to the files of a machine has for each name; None where there is none, or a line may define
    another."""
    folders = dict.fromkeys(path.parent for path in files)
    found = next((one for folder in folders for one in folder.iterdir() if one.name.lower() == MACRO_FILE), None)
    if found is None:
        return None
    macros, unread = read_macros(read_source(found, dos=True), Findings(), wincnc_settings(machine).lexical)
    return None if unread else {name: macro.text for name, macro in macros.items() if macro.text}


def each_macro(
    source: SourceFile, findings: Findings, lexical: Lexical, unread: list[int] | None = None
) -> Iterator[Macro]:  # fmt: skip
    """The definitions of a file in order, the same one again included; findings and ``unread``: see ``read_macros``."""
    unread = [] if unread is None else unread
    macros: dict[str, Macro] = {}
    signs = COMMENT_SIGNS + lexical.comment_signs
    for number, raw in enumerate(_END_OF_LINE.split(bytes(source.data).removeprefix(UTF8_MARK)), 1):
        line = decode(raw)
        after = behind_comments(line, len(line) - len(line.lstrip()), signs) if lexical.continued else 0
        leads = is_comment(line, signs) and 0 < after < len(line)
        line = " " * after + line[after:] if leads else line
        if is_comment(line, signs):
            if _tell_what_follows(source.name, number, line, len(line) - len(line.lstrip()), findings, signs):
                unread.append(number)
            continue
        macro = _macro(
            source.name, number, line, findings, signs, continued=lexical.continued, numbers=lexical.numbered
        )  # fmt: skip
        if macro is None:
            unread.append(number)
            continue
        macro = replace(macro, continued=True) if leads else macro
        before = macros.setdefault(macro.name, macro)
        if before is not macro and before.text != macro.text:
            what = f"defined again with another command than in line {before.span.line}"
            related = (Related(before.span, "the other definition"),)
            findings.add(codes.BAD_VALUE.at(macro.span, key=macro.name, what=what, related=related))
        yield macro


def is_comment(line: str, signs: str) -> bool:
    """Whether a line has nothing but comments, or nothing at all."""
    return not line.strip() or line.lstrip()[0] in signs


def code_name(text: str) -> str | None:
    """The name of a code or word as macros are looked up by it; None for what is none."""
    code = _CODE.fullmatch(text)
    if code is not None:
        part = (code["part"] or "").rstrip("0")
        return f"{code['letter'].upper()}{int(code['whole'])}" + (f".{part}" if part else "")
    return text.upper() if _WORD.fullmatch(text) else None


def _macro(
    file: str, number: int, line: str, findings: Findings, signs: str, *, continued: bool = False, numbers: bool = False
) -> Macro | None:  # fmt: skip
    control = _CONTROL.search(line)
    if control is not None:
        what = f"control character U+{ord(control.group()):04X} in the line"
        findings.add(codes.SYNTAX.at(Span(file, number, control.start() + 1, control.end() + 1), what=what))
        return None
    written, equals, rest = line.partition("=")
    at = len(written) - len(written.lstrip())
    name = code_name(written.strip()) if equals else None
    numbered = _NUMBERED.match(written) if equals and name is None else None
    if numbered is not None and numbers:
        name = code_name(written[numbered.end() :].strip())
    if name is None and equals and _NAME_FIRST.match(written) is not None:
        # The manual shows names that are codes: what else may be one, and whether lines have numbers, it does not say.
        what = f"the definition of {written.strip()[:30]!r}, a name that is not in the manual,"
        hint = ""
        if numbered is not None:
            what, hint = "an N at the start of a definition, which is not in the manual,", LINE_NUMBERS.hint
        span = Span(file, number, at + 1, len(written.rstrip()) + 1)
        findings.add(codes.UNSUPPORTED_CODE.at(span, code=what, hint=hint))
        return None
    if name is None:
        what = "neither NAME=command nor a comment"
        findings.add(codes.SYNTAX.at(Span(file, number, at + 1, len(line.rstrip()) + 1), what=what))
        return None
    begin = len(line) - len(rest.lstrip())
    end = end_of_command(line, begin, signs)
    goes_on = continued and end < len(line) and behind_comments(line, end, signs) < len(line)
    while continued and end < len(line) and (after := behind_comments(line, end, signs)) < len(line):
        # The shop's controller takes what is there: as if the comment were blanks.
        line = line[:end] + " " * (after - end) + line[after:]
        begin = len(line) - len(line.partition("=")[2].lstrip())
        end = end_of_command(line, begin, signs)
    text = line[begin:end].rstrip()
    span = Span(file, number, begin + 1, max(begin + len(text), begin + 1) + 1)
    if end < len(line):
        _tell_what_follows(file, number, line, end, findings, signs)
    elif not text:
        span = Span(file, number, at + 1, at + len(written.strip()) + 1)
        findings.add(codes.BAD_VALUE.at(span, key=name, what="no command after the equals sign; write [ for none"))
        return None
    if text and _COMMAND.match(text) is None:
        what = f"{name}={text[:30]}: a variable (the manual does not say how it is defined)"
        findings.add(codes.UNSUPPORTED_CODE.at(span, code=what))
        return None
    return Macro(name, text, span, begin + 1, written.strip(), continued=goes_on, numbered=numbered is not None)


def end_of_command(line: str, begin: int, signs: str) -> int:
    """Where a comment starts, at ``begin`` or after; a sign within a text in quotes is none."""
    at = begin
    while at < len(line):
        sign = line[at]
        if sign in signs:
            return at
        if sign in ENDS_OF_QUOTES:
            closing = next((i for i in range(at + 1, len(line)) if line[i] in ENDS_OF_QUOTES[sign]), -1)
            at = max(closing, at)
        at += 1
    return at


def _tell_what_follows(file: str, number: int, line: str, at: int, findings: Findings, signs: str) -> bool:
    """GP134 for words after a closed comment; whether there are any."""
    at = behind_comments(line, at, signs)
    if at < len(line):
        span = Span(file, number, at + 1, len(line.rstrip()) + 1)
        findings.add(codes.TEXT_BEHIND_COMMENT.at(span, text=line[at:].strip()[:40]))
    return at < len(line)


def behind_comments(line: str, at: int, signs: str) -> int:
    """Where words are after the closed comments that start at ``at``; the line's length where there are none."""
    while at < len(line) and line[at] in _CLOSED_BY:
        closing = line.find(_CLOSED_BY[line[at]], at)
        if closing < 0:
            return len(line)
        at = closing + 1
        while at < len(line) and line[at].isspace():
            at += 1
    return len(line) if line[at : at + 1] in signs else at
