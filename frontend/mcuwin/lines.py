"""One line of DIN 66025 blocks of a McuWIN program: words, assignments, labels, jumps, calls, messages.

What is no expression ends a line's reading with a Refusal; what a code does with its words is the executor's. Sections
are those of the manual of V 2.5.3.133: words and codes 3 to 5, comments 6, parameters 11, names 12.
"""

from __future__ import annotations

import re

from gproof.frontend.common.comment_hints import comment_hint
from gproof.frontend.mcuwin.comments import COMMENTS
from gproof.frontend.mcuwin.cursor import QUALIFIER, LineCursor
from gproof.frontend.mcuwin.language import DinLine, Language
from gproof.frontend.mcuwin.names import LABEL, NAME, label_name
from gproof.frontend.mcuwin.pascal_text import MODE
from gproof.ir import codes
from gproof.ir.dialects.mcuwin.persistence import Persistence
from gproof.ir.dialects.mcuwin.rules import has_code
from gproof.ir.dialects.mcuwin.settings import FIRST_USER_CODE, LAST_USER_CODE
from gproof.ir.finding import Span
from gproof.ir.notes import NoteKind
from gproof.ir.program import (
    PARAMETER,
    Block,
    Call,
    Expr,
    Jump,
    Label,
    Message,
    Number,
    Return,
    Statement,
    Text,
    Unsupported,
    Word,
)

_LINE_NUMBER = re.compile(r"[Nn][ \t]*([0-9]*)")
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)
_CALCULATION = re.compile(r"C[DI][0-9]", re.ASCII | re.IGNORECASE)
_WRITE = re.compile(r"write(?:ln)?(?![A-Za-z0-9_])", re.ASCII | re.IGNORECASE)
_DIGITS = re.compile(r"[0-9]+", re.ASCII)
_STRING = re.compile(r'"([^"]*)"')
VALUE_LETTERS = "FST"
CENTERS = "IJK"


class LineReader:
    """Reads the lines of a program in the order of the source."""

    def __init__(self, language: Language, persistence: Persistence) -> None:
        self.language = language
        self.persistence = persistence

    def read(self, text: str, file: str, line: int, at: int = 0) -> DinLine:
        """A line from character ``at``; Refusal for a mistake."""
        return _Line(self.language, self.persistence, text, file, line, at).read()


class _Line(LineCursor):
    def __init__(self, language: Language, persistence: Persistence, text: str, file: str, line: int, at: int) -> None:
        super().__init__(language, text, file, line, at)
        self.persistence = persistence

    def read(self) -> DinLine:
        self.blanks()
        self._line_number()
        self.blanks()
        first = self.text[self.at : self.at + 1]
        if first == "%":
            self._module()
        elif first == "$":
            self.found.says, self.found.pascal = True, self.at
            return self.found
        elif first == "{":
            found = MODE.match(self.text, self.at)
            if found is None:
                hint = comment_hint(COMMENTS, self.text, self.at)
                what = "braces are for lines of rw_SymPas"
                raise self.error(codes.SYNTAX, self.at, len(self.text), what=what, hint=hint)
            self.found.says, self.found.starts = True, found.span()
            return self.found
        while self.comments():
            self.found.says = True
            if self.found.module is not None:
                raise self.error(
                    codes.SYNTAX, self.at, len(self.text), what="there is text after a percent sign and its name"
                )
            self._item()
            self.items += 1
        self._flush()
        return self.found

    def _line_number(self) -> None:
        found = _LINE_NUMBER.match(self.text, self.at)
        if found is None or self.assigned(self.at):
            return
        if not found[1]:
            raise self.error(codes.SYNTAX, self.at, found.end(), what="a line number must be N and digits")
        self.found.number, self.at = found[1], found.end()
        self.note(NoteKind.LINE_NUMBER, found.start(), found[1])

    def _module(self) -> None:
        begin = self.at
        self.at += 1
        self.blanks()
        name = NAME.match(self.text, self.at)
        self.found.says = True
        self.found.module = ""
        if name is not None:
            self.found.module, self.at = name[0], name.end()
        self.found.module_span = self.span(begin)
        self.note(NoteKind.MARK, begin, self.found.module)

    def _item(self) -> None:
        char = self.text[self.at]
        if self.assigned(self.at):
            self._assignment()
        elif _WRITE.match(self.text, self.at):
            self._message()
        elif self.code is not None and self.begins_value(self.at):
            self._parameter()
        elif char.isascii() and char.isalpha():
            self._word(char)
        else:
            end = self.at + 1
            what = f"{char!r} does not start a word or a comment"
            if self.text.startswith("//", self.at):
                what = "two slashes start a comment only in lines of rw_SymPas"
            hint = comment_hint(COMMENTS, self.text, self.at)
            raise self.error(codes.SYNTAX, self.at, end, what=what, hint=hint)

    def _flush(self, behind: Statement | None = None) -> None:
        """End the block of the words so far; then ``behind``."""
        if self.words:
            span = Span(self.file, self.line, self.words[0].span.column, self.words[-1].span.end_column)
            words = tuple(self.words)
            before = self._out_of_order()
            block = Block(
                words=words,
                assigns=(),
                span=span,
                comment=self.comment,
                continued=self.persistence.state,
                distances=self.persistence.distances_of(words),
            )
            if before is None:
                self.found.statements.append(block)
            else:
                # In front of it: after a jump or a return nobody would come by.
                text = self.text[span.column - 1 : span.end_column - 1]
                what = "words after a jump, call or return, or another word that must be alone"
                self.found.statements.insert(before, Unsupported(what=what, span=span, text=text))
            for word in words:
                if word.letter in "GM" and isinstance(word.value, Number):
                    self.persistence.code(word.letter, int(word.value.value))
            self.words = []
        self.code = None
        if behind is not None:
            self.found.statements.append(behind)

    def _out_of_order(self) -> int | None:
        """Which statement of the line is before words, where it is not known whether they act in that order."""
        for at, node in enumerate(self.found.statements):
            if isinstance(node, (Jump, Call, Return)) or (isinstance(node, Block) and node.words):
                return at
        return None

    def _assignment(self) -> None:
        begin = self.at
        self._flush()
        if QUALIFIER.match(self.text, begin):
            self._axis_assignment()
            return
        assign, self.at = self.language.expressions.assignment(self.text, begin, self.file, self.line)
        if assign is not None:
            state = self.persistence.state
            self._flush(Block(words=(), assigns=(assign,), span=assign.span, continued=state))

    def _axis_assignment(self) -> None:
        """To a variable of an axis, such as X.zerooffset (3.26): what it does, the manual does not say."""
        begin = self.at
        name = self.assigned(begin)
        assert name is not None
        self.at = self.text.index(":=", begin) + 2
        self.value()
        what = f"the assignment to {name[0]}"
        self._flush(Unsupported(what=what, span=self.span(begin), text=self.text[begin : self.at]))

    def _message(self) -> None:
        """WRITE and WRITELN (5.7): texts in double quotes and values, after one another."""
        begin = self.at
        if self.language.old:
            raise self.error(codes.SYNTAX, begin, len(self.text), what="WRITE and WRITELN came with version 2.5.3.38")
        self._flush()
        kind = _WRITE.match(self.text, self.at)
        assert kind is not None
        self.at = kind.end()
        parts: list[Expr] = []
        while True:
            self.blanks()
            text = _STRING.match(self.text, self.at)
            if text is not None:
                start, self.at = self.at, text.end()
                parts.append(Text(text[1], self.span(start)))
            elif parts and self.text[self.at : self.at + 1] == ",":
                self.at += 1
            elif self.begins_value(self.at):
                self.no_comment(kind[0].upper())
                value, self.at = self.language.expressions.any(self.text, self.at, self.file, self.line)
                parts.append(value)
            else:
                break
        self._flush(Message(kind=kind[0].lower(), parts=tuple(parts), span=self.span(begin)))
        self.persistence.doubt()

    def _parameter(self) -> None:
        assert self.code is not None
        begin = self.at
        letter, number = self.code
        self.no_comment(f"{letter}{number:02d}")
        value = self.value()
        takes = (letter == "M" and number not in (17, 96, 98)) or number == 4
        if not takes and not FIRST_USER_CODE <= number <= LAST_USER_CODE:
            raise self.error(codes.UNUSED_WORD, begin, self.at, word=self.text[begin : self.at])
        if self.language.old and (letter, number) == ("G", 4) and not isinstance(value, Number):
            what = "this version reads only a number after G04"
            raise self.error(codes.BAD_EXPRESSION, begin, self.at, what=what)
        self.words.append(Word(PARAMETER, value, self.span(begin)))

    def _word(self, char: str) -> None:
        begin = self.at
        letter = char.upper()
        if char != letter and self.language.din.case_sensitive:
            what = f"{char!r} is not a word on a machine that is case-sensitive"
            raise self.error(codes.SYNTAX, begin, begin + 1, what=what)
        if _CALCULATION.match(self.text, begin):
            raise self.error(codes.SYNTAX, begin, len(self.text), what="a calculation parameter has no := after it")
        if QUALIFIER.match(self.text, begin):
            raise self.error(codes.SYNTAX, begin, len(self.text), what="a value has no word before it")
        if letter in "GM":
            self._code(letter)
        elif letter == "L":
            self._label()
        elif letter in self.language.axes or letter in VALUE_LETTERS + CENTERS + "D":
            self.at += 1
            self._axis_or_value(letter, begin)
        else:
            name = _NAME.match(self.text, begin)
            end = name.end() if name is not None else begin + 1
            if letter in "ABCUVW":
                raise self.error(codes.AXIS_NOT_THERE, begin, end, axis=letter)
            what = f"{self.text[begin:end]!r} is not a word of this controller"
            raise self.error(codes.SYNTAX, begin, end, what=what)

    def _axis_or_value(self, letter: str, begin: int) -> None:
        self.code = None
        if self.begins_value(self.at):
            value = self.value()
            if letter == "T" and self.language.old and not isinstance(value, Number):
                what = "this version reads only a number after T (14, 2.5.3.108)"
                raise self.error(codes.BAD_EXPRESSION, begin, self.at, what=what)
            self.words.append(Word(letter, value, self.span(begin)))
            return
        if letter not in self.language.axes:
            raise self.error(codes.MISSING_VALUE, begin, begin + 1, letter=letter)
        span = self.span(begin, begin + 1)
        self.words.append(Word(letter, Number(0.0, span), span, bare=True))

    def _code(self, letter: str) -> None:
        begin = self.at
        self.at += 1
        self.blanks()
        digits = _DIGITS.match(self.text, self.at)
        if digits is None:
            raise self.error(codes.MISSING_VALUE, begin, begin + 1, letter=letter)
        span = self.span(self.at, digits.end())
        self.at = digits.end()
        number = int(digits[0]) if len(digits[0]) < 1000 else 10**9
        name = self.text[begin : self.at]
        if self.text[self.at : self.at + 1] == ".":
            end = _DIGITS.match(self.text, self.at + 1)
            name = self.text[begin : end.end() if end else self.at + 1]
            raise self.error(codes.UNKNOWN_CODE, begin, begin + len(name), code=name)
        self._known(letter, number, name, begin)
        if letter == "M" and number in (17, 96, 98):
            self._flow(number, begin)
            return
        self.words.append(Word(letter, Number(float(number), span), self.span(begin)))
        self.code = (letter, number)
        if self.code == ("G", 4) and not self.begins_value(self.behind_comments()):
            needed = "its time (compiler error 2075)"
            raise self.error(codes.WORD_MISSING, begin, self.at, code=name, needed=needed)

    def _known(self, letter: str, number: int, name: str, begin: int) -> None:
        """Error 1 of the manual (13.1.1.1) for a code that neither it nor the machine file has."""
        din = self.language.din
        known = has_code(letter, number, din.version) or FIRST_USER_CODE <= number <= LAST_USER_CODE
        if not known and din.task(f"{letter}{number}") is None:
            hint = "state it in [din.task0] if the machine's own Task 0 has it; otherwise it is error 1"
            raise self.error(codes.UNKNOWN_CODE, begin, self.at, code=name, hint=hint)

    def _label(self) -> None:
        begin = self.at
        found = LABEL.match(self.text, begin)
        if found is None:
            name = _NAME.match(self.text, begin)
            end = name.end() if name is not None else begin + 1
            raise self.error(codes.SYNTAX, begin, end, what="a label must be L and digits")
        if self.words or any(not isinstance(node, Label) for node in self.found.statements):
            raise self.error(codes.SYNTAX, begin, found.end(), what="a label must come before its line")
        self.at = found.end()
        self._flush(Label(name=label_name(found[1]), span=self.span(begin)))

    def _target(self, code: str, begin: int) -> str:
        """The label or module that M96 or M98 names."""
        self.blanks()
        label = LABEL.match(self.text, self.at)
        if label is not None:
            self.at = label.end()
            return label_name(label[1])
        name = _NAME.match(self.text, self.at)
        if name is None:
            raise self.error(codes.WORD_MISSING, begin, self.at, code=code, needed="a label after it")
        self.at = name.end()
        return label_name(name[0])

    def _flow(self, number: int, begin: int) -> None:
        self._flush()
        if number == 17:
            self._flush(Return(span=self.span(begin), code="M17"))
        elif number == 96:
            name = self._target("M96", begin)
            self._flush(Jump(name=name, span=self.span(begin)))
        else:
            name, count = self._target("M98", begin), None
            self.blanks()
            if self.text[self.at : self.at + 1] in ("O", "o") and not self.assigned(self.at):
                start = self.at
                self.at += 1
                if not self.begins_value(self.at):
                    raise self.error(codes.MISSING_VALUE, start, start + 1, letter="O")
                count = self.value()
            self._flush(Call(name=name, span=self.span(begin), count=count))
        self.persistence.code("M", number)
        self.code = ("M", number)
