"""Lines of WinCNC as statements: commands, calls, conditions on the next line, arrays, lines that macros replace.

Manual: Command Reference; Macro File Configuration. A line has one command; what may be next to it is in the table
of the dialect (``ir/dialects/wincnc/rules.py``).
"""

from __future__ import annotations

import contextlib
import dataclasses
import math
import re
from typing import Any, Protocol

from gproof.frontend.wincnc.line import Items, LineError, LineReader, NumberedLine, line_number
from gproof.frontend.wincnc.mac_file import Macro
from gproof.frontend.wincnc.mac_file import code_name as macro_name
from gproof.ir import codes
from gproof.ir.finding import Severity, Span
from gproof.ir.program import (
    Binary,
    Block,
    Call,
    Expr,
    Input,
    Message,
    Named,
    Number,
    Replaced,
    Statement,
    Text,
    Unary,
    Word,
)
from gproof.ir.record import record
from gproof.ir.rules import LINE_LETTERS, CodeRule, LanguageRules, only_a_macro
from gproof.ir.rules import Function as F

DEEPEST_MACRO = 20


@record(frozen=True, slots=True)
class Head:
    """A line that decides whether the next one runs: then when it runs for a true condition, else for a false one."""

    statement: Statement
    condition: Expr


@record(frozen=True, slots=True)
class ArrayLine:
    """L10; without words it ends an array."""

    words: tuple[Word, ...]
    span: Span
    comment: str
    line: Block | None


Parsed = Statement | Head | ArrayLine


def code_name(letter: str, tenths: int) -> str:
    """``M6``, ``L91``, ``G92.1``."""
    whole, tenth = divmod(tenths, 10)
    return f"{letter}{whole}.{tenth}" if tenth else f"{letter}{whole}"


class Lines:
    """Reads lines of any file of a program.

    macros: by the names that ``read_macros`` gives them; files: where subprograms are; changers: how many tool changers
    the machine has; open_codes: where CNC.MAC may define further names, why, else ""; open_files: where the
    folder of the subprograms is not given, what to give, else "".
    """

    def __init__(
        self, reader: LineReader, rules: LanguageRules, macros: dict[str, Macro], files: FileFinder, changers: int,
        open_codes: str = "", open_files: str = "",
    ) -> None:  # fmt: skip
        self.reader = reader
        self.rules = rules
        self.macros = macros
        self.files = files
        self.changers = changers
        self.open_codes = open_codes
        self.open_files = open_files
        self.questions = 0
        self.limit = rules.line_length

    def parse(self, text: str, file: str, line: int, depth: int = 0) -> Parsed | None:
        """What a line says; None for a comment or an empty line; LineError for a mistake."""
        code, comment = self.reader.cut(text)
        control = CONTROL.search(code) or _RETURN.search(text)
        if control is not None:
            what = f"control character U+{ord(control.group()):04X} in the line"
            raise LineError(codes.SYNTAX, control.start(), control.end(), what=what)
        if not code.strip(" \t"):
            return None
        macro = self._macro(code)
        if macro is not None:
            return self._replaced(macro, code, comment, file, line, depth)
        begin, end = self._number(code, file, line)
        if end:
            if not self.reader.numbered:
                raise NumberedLine(codes.UNSUPPORTED_CODE, begin, end)
            self.reader.has_numbers = True
            if code[end:].strip(" \t"):
                return self.parse(" " * end + text[end:], file, line, depth)
            span = Span(file, line, begin + 1, end + 1)
            return Replaced(written=code.strip(), body=(), span=span, comment=comment)
        try:
            items = self.reader.read(text, file, line)
            if not items.words and not items.texts:
                raise LineError(codes.SYNTAX, items.begin, items.begin + 1, what="there is no command after the tilde")
            if self.macros:
                self._no_macro_inside(items)
            return self._statement(items, text, file, line)
        except LineError as error:
            name = self._open_name(code) if error.code.severity is Severity.ERROR else ""
            if not name:
                raise
            begin, what = len(code) - len(code.lstrip()), only_a_macro(name)
            end = len(code.rstrip())
            raise LineError(codes.UNSUPPORTED_CODE, begin, end, code=what, hint=self.open_codes) from None

    def _open_name(self, code: str) -> str:
        """The name that starts a line and that CNC.MAC may define without our knowing, "" where it cannot.

        A code that the controller has keeps its meaning: that CNC.MAC may replace it is a finding of its own (GP607).
        """
        if not self.open_codes:
            return ""
        begin = len(code) - len(code.lstrip())
        found = _BEGINS_WITH_CODE.match(code, begin)
        if found is not None:
            name = re.sub(r"[ \t+]", "", found.group()).upper()
            if name[0] in "GLM":
                tenths = float(name[1:]) * 10
                is_whole = math.isfinite(tenths) and abs(tenths - round(tenths)) < 1e-6
                return "" if is_whole and (name[0], round(tenths)) in self.rules.codes else name
            if name[0] not in LINE_LETTERS:
                return name
        word = _BEGINS_WITH_WORD.match(code, begin)
        return word.group().upper() if word is not None and word.group()[1:2].isalpha() else ""

    def _number(self, code: str, file: str, line: int) -> tuple[int, int]:
        """Where the number of a line starts and ends; 0, 0 where it has none, or where N is a word of its command."""
        found = line_number(code)
        if found is None or "N" in self.macros:
            return 0, 0
        with contextlib.suppress(LineError):
            items = self.reader.read(code, file, line)
            command = self._command(items)
            if command is not None and "N" in command[0].takes and sum(w.letter == "N" for w in items.words) == 1:
                return 0, 0
        return len(code) - len(code.lstrip(" \t")), found.end()

    def _macro(self, code: str) -> tuple[Macro, int, int] | None:
        """The macro whose name starts the line, and where the name starts and ends."""
        begin = len(code) - len(code.lstrip())
        if not self.macros or code[begin : begin + 1] == "~":
            return None
        for found in (_BEGINS_WITH_CODE.match(code, begin), _BEGINS_WITH_WORD.match(code, begin)):
            if found is not None:
                name = macro_name(re.sub(r"[ \t+]", "", found.group()))
                macro = self.macros.get(name) if name is not None else None
                if macro is not None:
                    return macro, begin, found.end()
        return None

    def _no_macro_inside(self, items: Items) -> None:
        """LineError GP113 for a name of CNC.MAC that does not start its line: whether it is replaced is not known."""
        command = self._command(items)
        for n, word in enumerate(items.words):
            value = word.value
            if word.letter in self.macros:
                name = word.letter
            elif word.letter not in "GLM" or (items.own and not n):
                continue
            elif isinstance(value, Number):
                tenths = round(value.value * 10)
                known = self.rules.codes.get((word.letter, tenths))
                is_parameter = command is not None and command[1] is not word and word.letter in command[0].takes
                name = code_name(word.letter, tenths)
                if name not in self.macros or (is_parameter and (known is None or not known.companion)):
                    continue
            elif command is not None and word.letter in command[0].takes:
                continue
            else:
                name = f"{word.letter} with a number in braces"
            what = f"{name} inside a line, which CNC.MAC may replace"
            raise LineError(codes.UNSUPPORTED_CODE, word.span.column - 1, word.span.end_column - 1, code=what)

    def _replaced(
        self, found: tuple[Macro, int, int], code: str, comment: str, file: str, line: int, depth: int
    ) -> Parsed:
        macro, begin, end = found
        span = Span(file, line, begin + 1, len(code.rstrip()) + 1)
        written = code.strip()
        rest = code[end:].rstrip()
        if depth >= DEEPEST_MACRO:
            raise LineError(codes.RECURSION, begin, end, allowed=DEEPEST_MACRO, chain=f"{macro.name} > {macro.name}")
        if not macro.text:
            as_line = self._replaced_line(macro, code, begin, end, span, None)
            return Replaced(written=written, body=(), span=span, comment=comment, line=as_line)
        self.reader.has_continued |= macro.continued
        self.reader.has_numbers |= macro.numbered
        text = macro.text + (f" {rest.strip()}" if rest.strip() else "")
        if len(text) > self.limit:
            raise LineError(codes.MACRO_TOO_LONG, begin, end, length=len(text), name=macro.name, allowed=self.limit)
        try:
            inner = self.parse(text, file, line, depth + 1)
        except LineError as error:
            raise type(error)(error.code, begin, len(code.rstrip()), **error.values) from None
        length = max(len(text), inner.length if isinstance(inner, Replaced) else 0)
        as_line = self._replaced_line(macro, code, begin, end, span, inner)
        if isinstance(inner, Head):
            inner = _at(inner, span)
            body: tuple[Statement, ...] = (inner.statement,)
            head = Replaced(written=written, body=body, span=span, comment=comment, line=as_line, length=length)
            return Head(head, inner.condition)
        if isinstance(inner, ArrayLine):
            return ArrayLine(inner.words, span, comment, as_line)
        body = () if inner is None else (_at(inner, span),)
        return Replaced(written=written, body=body, span=span, comment=comment, line=as_line, length=length)

    def _replaced_line(self, macro: Macro, code: str, begin: int, end: int, span: Span, inner: Parsed | None) -> Block:
        """The line of a macro to be printed: its name, and words where nothing but words follows."""
        name = Text(code[begin:end].rstrip(), Span(span.file, span.line, begin + 1, end + 1))
        rest = code[end:].strip()
        at = end + len(code[end:]) - len(code[end:].lstrip())
        items = Items(rest=rest, rest_at=at)
        if not _takes_text(inner, macro.text):
            with contextlib.suppress(LineError):
                items = self.reader.read(" " * at + rest, span.file, span.line)
        if items.own or items.rest:
            items = Items(rest=rest, rest_at=at)
        block = self._block(items, span)
        return dataclasses.replace(block, texts=(("", name), *block.texts))

    def _statement(self, items: Items, text: str, file: str, line: int) -> Parsed:
        span = Span(file, line, items.begin + 1, items.end + 1)
        command = self._command(items)
        if command is not None:
            rule, word = command
            if rule.function in (F.CALL, F.CONDITION, F.DIALOG):
                _require_only(items, rule, word)
            if rule.function is F.CALL:
                return self._call(items, rule, word, span)
            if rule.function is F.CONDITION:
                return Head(self._block(items, span), self._condition(items, rule, word))
            if rule.function is F.ARRAY:
                words = tuple(w for w in items.words if w is not word)
                return ArrayLine(words, span, items.comment, self._block(items, span))
            if rule.function is F.DIALOG:
                return self._dialog(items, span)
        return self._block(items, span)

    def _block(self, items: Items, span: Span) -> Block:
        texts = list(items.texts)
        if items.rest:
            at = items.rest_at
            where = Span(span.file, span.line, at + 1, at + len(items.rest) + 1)
            texts.append(("", Text(items.rest, where)))
        return Block(
            words=tuple(items.words), assigns=(), span=span, comment=items.comment, own=items.own, texts=tuple(texts)
        )

    def _command(self, items: Items) -> tuple[CodeRule, Word] | None:
        """The first code of a line that is no companion; None where there is none, or none that is known."""
        for word in items.words:
            if word.letter in "GLM" and isinstance(word.value, Number):
                rule = self.rules.codes.get((word.letter, round(word.value.value * 10)))
                if rule is None or not rule.companion:
                    return None if rule is None else (rule, word)
        return None

    def _call(self, items: Items, rule: CodeRule, word: Word, span: Span) -> Statement:
        rest = items.rest or ""
        if not rest:
            raise LineError(codes.MISSING_VALUE, word.span.column - 1, word.span.end_column - 1, letter=rule.text)
        name, after = rest, len(rest)
        if rest[0] == '"' and '"' in rest[1:]:
            after = rest.index('"', 1) + 1
            name = rest[:after]
        elif self.files.find(rest) is None and re.search(r"[ \t]", rest):
            name = re.split(r"[ \t]", rest, maxsplit=1)[0]
            after = len(name)
        arguments: list[Word] = []
        if rest[after:].strip():
            shift = " " * (items.rest_at + after)
            more = self.reader.read(shift + rest[after:], span.file, span.line)
            if more.texts or any(w.letter in "GM" and not w.bare for w in more.words):
                raise LineError(
                    codes.SYNTAX, items.rest_at + after, items.end, what="there are words after a file name"
                )
            arguments = more.words
        key = self.files.find(name)
        if key is None:
            at = items.rest_at
            if self.open_files:
                # Where the controller's own folder is not given, a file that is not found may be in it.
                what = f"the file {name}, which is not next to the job,"
                raise LineError(codes.UNSUPPORTED_CODE, at, at + len(name), code=what, hint=self.open_files)
            raise LineError(codes.FILE_NOT_FOUND, at, at + len(name), name=name, where=self.files.where)
        where = Span(span.file, span.line, items.rest_at + 1, items.rest_at + len(name) + 1)
        as_line = self._block(dataclasses.replace(items, rest=None), span)
        as_line = dataclasses.replace(as_line, words=(word, *arguments), texts=(("", Text(name, where)),))
        return Call(
            name=key, span=span, arguments=tuple(arguments), text=name.strip('"'), counted=rule.value == 1,
            line=as_line,
        )  # fmt: skip

    def _dialog(self, items: Items, span: Span) -> Parsed:
        values = {word.letter: word.value for word in items.words}
        kind = values.get("T")
        number = 0.0 if kind is None else kind.value if isinstance(kind, Number) else -1.0
        kinds = {0.0: "ok", 1.0: "abort", 2.0: "continue", 3.0: "run_next", 4.0: "skip_next"}
        if number not in kinds:
            raise LineError(
                codes.PARAMETER_RANGE, span.column - 1, span.end_column - 1, code="G5", word="T", allowed="0 to 4"
            )
        parts = tuple(text for letter, text in items.texts if letter == "M")
        self.questions += number > 0
        question = self.questions if number else 0
        message = Message(
            kind=kinds[number], parts=parts, span=span, question=question, line=self._block(items, span)
        )  # fmt: skip
        if number < 3:
            return message
        asked = Input("answer", Number(float(self.questions), span), span)
        return Head(message, asked if number == 3 else Unary("not", asked, span))

    def _condition(self, items: Items, rule: CodeRule, word: Word) -> Expr:
        """True when the next line runs."""
        values = {w.letter: w.value for w in items.words if w is not word}
        span = word.span
        for letter in rule.needs:
            if letter not in values:
                raise LineError(
                    codes.MISSING_VALUE, span.column - 1, span.end_column - 1, letter=f"{letter} of {rule.text}"
                )
        if rule.letter == "M":
            return self._input_condition(values, rule, span)
        tool = values.get("T")
        if isinstance(tool, Number) and abs(tool.value - round(tool.value)) > self.rules.integer_tolerance:
            at = tool.span
            raise LineError(codes.NOT_AN_INTEGER, at.column - 1, at.end_column - 1, word="T", value=tool.value)
        if rule.text == "L113":
            above = Binary(">", values["V"], values["L"], span)
            below = Binary("<", values["V"], values["H"], span)
            return Binary("and", above, below, span)
        one, two = (Binary("==", Named(f"TP{n}", span), values["T"], span) for n in (1, 2))
        if rule.text == "L111.1":
            return Binary("and", one, two, span)
        if rule.text == "L112":
            return Unary("not", one, span)
        which = values.get("A")
        number = 0.0 if which is None else which.value if isinstance(which, Number) else -1.0
        if number not in (0.0, 1.0, 2.0):
            raise LineError(
                codes.PARAMETER_RANGE, span.column - 1, span.end_column - 1, code=rule.text, word="A", allowed="0 to 2"
            )
        if number == 2.0:
            return two
        return one if number == 1.0 or self.changers < 2 else Binary("or", one, two, span)

    def _input_condition(self, values: dict[str, Expr], rule: CodeRule, span: Span) -> Expr:
        simulated = values.get("D")
        answer = simulated.value if isinstance(simulated, Number) else None
        if answer is not None and answer not in (0.0, 1.0):
            at = values["D"].span
            raise LineError(
                codes.PARAMETER_RANGE, at.column - 1, at.end_column - 1, code=rule.text, word="D", allowed="0 or 1"
            )
        kinds = {1: "input", 2: "output", 3: "virtual", 4: "given"}
        point = rule.tenths % 10
        if point == 4:
            channel = values["C"]
            if isinstance(channel, Number) and channel.value not in (0.0, 1.0):
                at = channel.span
                raise LineError(
                    codes.PARAMETER_RANGE, at.column - 1, at.end_column - 1, code=rule.text, word="C", allowed="0 or 1"
                )
        condition: Expr = Input(kinds[point], values["C"], span, answer)
        return condition if rule.tenths // 10 == 17 else Unary("not", condition, span)


CONTROL = re.compile(r"[\x00-\x08\x0a-\x1f\x7f]")
_RETURN = re.compile(r"\r")
_BEGINS_WITH_CODE = re.compile(r"[A-Za-z][ \t]*\+?[0-9]+(?:\.[0-9]*)?(?![0-9.])")
_BEGINS_WITH_WORD = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


class FileFinder(Protocol):
    """Subprogram files by the names that programs give them. where: words for a message, such as " in jobs/"."""

    where: str

    def find(self, name: str) -> str | None:
        """The name of the subprogram that a file is, loaded now or later; None when there is no such file."""


def _require_only(items: Items, rule: CodeRule, word: Word) -> None:
    """LineError for what is in the line of a command and is not one of its words."""
    at = word.span.column - 1
    has_texts = rule.function is F.DIALOG
    for other in items.words:
        if other is not word and (other.letter not in rule.takes or rule.function is F.CALL):
            what = f"{other.letter} together with {rule.text}"
            raise LineError(codes.SYNTAX, other.span.column - 1, other.span.end_column - 1, what=what)
    if any(not has_texts or letter != "M" for letter, _ in items.texts):
        raise LineError(codes.SYNTAX, at, items.end, what=f"a text, which {rule.text} does not read")


def _takes_text(parsed: Parsed | None, macro: str) -> bool:
    """Whether what comes after a macro may be read as a text, or as part of one."""
    if isinstance(parsed, Replaced):
        return any(_takes_text(node, macro) for node in parsed.body)
    if isinstance(parsed, Call):
        return parsed.text not in macro
    return isinstance(parsed, Block) and any(not letter for letter, _ in parsed.texts)


def _at(value: Any, span: Span) -> Any:
    """What a macro stands for, at the place of the line that has the macro."""
    if isinstance(value, tuple):
        return tuple(_at(item, span) for item in value)
    if isinstance(value, Span):
        return span
    if not dataclasses.is_dataclass(value) or isinstance(value, type):
        return value
    return type(value)(**{f.name: _at(getattr(value, f.name), span) for f in dataclasses.fields(value)})


def text_codes(rules: LanguageRules) -> frozenset[tuple[str, int]]:
    """Codes with a text after them that is no word."""
    quoted = (F.DIALOG, F.STORE_POSITION, F.STORE_LOCAL_POSITION)
    return frozenset(code for code, rule in rules.codes.items() if rule.has_text and rule.function not in quoted)
