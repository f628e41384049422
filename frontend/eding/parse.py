"""Lines that are not plain, through the grammar, to statements.

``parse_line`` takes one raw line and gives the statements it holds; a mistake is one ``LineError`` with
its code and place. lark is imported and the grammar built when the first such line is met.
"""

from __future__ import annotations

import functools
from pathlib import Path
from typing import TYPE_CHECKING, cast

from gproof.frontend.common.grammar import parser
from gproof.frontend.common.source import decode
from gproof.frontend.eding.build import Builder, Parsed, written
from gproof.frontend.eding.diagnose import diagnose
from gproof.frontend.eding.newer import meaning
from gproof.frontend.eding.prepare import STRUCTURE, Line, LineError, prepare
from gproof.ir.finding import Span
from gproof.ir.program import Unsupported

if TYPE_CHECKING:
    from lark import Lark


@functools.cache
def _grammar() -> tuple[Builder, Lark]:
    """The parser and the object whose methods are its actions."""
    builder = Builder()
    return builder, parser(Path(__file__).with_name("grammar.lark"), ("block", "flow"), builder)


def foreign(line: Line, file: str, number: int) -> Unsupported:
    """A command that the manual does not have, as another version of the controller may."""
    end = line.places[-1]
    text = written(line)
    span = Span(file, number, line.keyword_at + 1, max(end, line.keyword_at + 1) + 1)
    deleted = line.text.lstrip(" \t").startswith("/")
    what = f"{line.keyword!r}, which is not in the manual,"
    entry, means = meaning(text, span) or (None, ())
    name = entry.name if entry else ""
    return Unsupported(what=what, span=span, deleted=deleted, text=text, accepted=name, means=means)


def parse_line(raw: bytes, file: str, number: int) -> list[Parsed]:
    """The statements of line ``number`` (at most a message and a block, in that order), or LineError."""
    line = prepare(decode(raw))
    if not line.code:
        return []
    if line.rule == "foreign":
        return [foreign(line, file, number)]
    builder, lark = _grammar()
    from lark.exceptions import UnexpectedInput

    builder.file, builder.row, builder.line = file, number, line
    try:
        return cast("list[Parsed]", lark.parse(line.code, start=line.rule))
    except UnexpectedInput as error:
        found = diagnose(line, error)
    except LineError as error:
        found = error
    found.structure = found.structure or (line.keyword if line.keyword in STRUCTURE else "")
    raise found from None
