"""The text of a McuWIN program line by line: DIN lines, ``$`` lines, and sections of rw_SymPas (manual 7 to 12).

What is before the first percent sign may be declarations with ``$DINEND`` or without; a section ends with
``{$DINSTART}``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from gproof.frontend.mcuwin.expressions import Expressions
from gproof.frontend.mcuwin.include import INCLUDE
from gproof.frontend.mcuwin.language import DinLine, Language
from gproof.frontend.mcuwin.line_cache import Shapes, continued, size_of_deferred
from gproof.frontend.mcuwin.lines import CENTERS, VALUE_LETTERS, LineReader
from gproof.frontend.mcuwin.notes import Found
from gproof.frontend.mcuwin.pascal import Dollar, Place, Simple, Symbols, parse_section
from gproof.frontend.mcuwin.pascal_text import mode_sign, pascal_notes
from gproof.frontend.mcuwin.structure import Structure
from gproof.ir import codes
from gproof.ir.dialects.mcuwin.persistence import Persistence
from gproof.ir.dialects.mcuwin.settings import McuWinSettings
from gproof.ir.finding import Findings, Refusal, Span
from gproof.ir.notes import NoteKind
from gproof.ir.program import Block, Call, Declare, Include, Jump, Mode, Statement, Subprogram
from gproof.ir.rules import LanguageRules

DECLARES = re.compile(
    r"[ \t]*(?://|\{(?![ \t]*\$)|(?:var|const|label|procedure|function)(?![A-Za-z0-9_]))", re.IGNORECASE
)
DINEND = re.compile(r"\$DINEND(?![A-Za-z0-9_])", re.IGNORECASE)
PERCENT = re.compile(r"[ \t]*%")

PASCAL: Found = (0, NoteKind.PASCAL, 0, "")
"""Of a line with rw_SymPas."""

LineNotes = tuple[int, str, list[Found]]
"""Number, text and notes of a line."""

HELD_BLOCKS = 2_000
"""Blocks of a program that are made at once; later ones are made when they run."""


class Text:
    """Takes lines in the order of the source. include: reads a file in the place of its ``$I``."""

    def __init__(
        self, rules: LanguageRules, din: McuWinSettings, axes: str, findings: Findings,
        include: Callable[[str, Span], None], span: Span, *, held: int | None = HELD_BLOCKS,
    ) -> None:  # fmt: skip
        """held: how many blocks are made at once; None: all, and each line is read by itself.

        After the text, ``deferred`` has the words and nodes of the others.
        """
        self.findings = findings
        self.include = include
        self.numbered = din.line_numbers
        self.symbols = Symbols(findings, axes=axes, case_sensitive=din.case_sensitive, angle_unit=din.angle_unit)
        self.persistence = Persistence(din)
        language = Language(rules=rules, din=din, axes=axes, expressions=Expressions(self.symbols))
        self.old = language.old
        self.letters = axes + CENTERS + VALUE_LETTERS + "DGLMNO"
        self.language = language
        self.reader = LineReader(language, self.persistence)
        self.held = held or 0
        self.shapes = Shapes(language, self.symbols) if held is not None else None
        self.deferred = (0, 0)
        self.structure = Structure(self.symbols, self.persistence, findings, span)
        self.procedures: list[Subprogram] = []
        self.doubtful: dict[str, str] = {}
        self.spelled: dict[str, str] = {}
        """How names of modules are written, by the name in lower case."""
        self.pascal = False
        self.implied = False
        self.opened = False
        self.lines: list[str] = []
        self.first = Place("", 0)

    def finish(self) -> None:
        """The end of all files."""
        self._end_section()
        self.structure.finish()

    @contextmanager
    def aside(self) -> Iterator[None]:
        """Reads what gives names only: statements, findings and what is in force are as before after it."""
        kept = self.findings, self.structure, self.procedures, self.persistence.state
        self.findings = self.symbols.findings = Findings()
        self.structure = Structure(self.symbols, self.persistence, self.findings, self.structure.sections[0].span)
        self.procedures = []
        try:
            yield
            self._end_section()
        finally:
            self.findings, self.structure, self.procedures, self.persistence.state = kept
            self.symbols.findings = self.findings

    def leave_file(self, depth: int) -> None:
        """The end of a file; depth: blocks that were open before it."""
        self._read_section()
        self.structure.finish(depth)

    def line(self, text: str, file: str, number: int) -> list[LineNotes]:
        """Take a line; gives its notes, and those of a section that it ends."""
        found: list[LineNotes] = []
        try:
            self._line(text, file, number, found)
        except Refusal as refusal:
            self.findings.add(refusal.finding)
            self.structure.refused(refusal.finding, text)
            self.persistence.cut()
        return found

    def _line(self, text: str, file: str, number: int, found: list[LineNotes]) -> None:
        if "\r" in text:
            at = text.index("\r")
            what = "a carriage return without a line feed in the line"
            if self.pascal:
                # The lines of a section are counted: one that cannot be read is an empty one.
                self.first = self.first if self.lines else Place(file, number)
                self.lines.append("")
            raise Refusal(codes.SYNTAX.at(Span(file, number, at + 1, at + 2), what=what))
        if not self.pascal and self._may_declare() and DECLARES.match(text):
            self._begin_section(implied=True)
        if self.pascal:
            self._pascal_line(text, file, number, found)
        else:
            self._din(text, file, number, found)

    def _may_declare(self) -> bool:
        """Before the first percent sign, outside of blocks."""
        return len(self.structure.sections) == 1 and not self.structure.open

    def _begin_section(self, *, implied: bool) -> None:
        self.pascal, self.implied, self.opened, self.lines = True, implied, False, []

    def _pascal_line(self, text: str, file: str, number: int, found: list[LineNotes]) -> None:
        if not self.opened and PERCENT.match(text):
            if not self.implied:
                at = text.index("%")
                what = "a percent sign in rw_SymPas: {$DINSTART} is missing before it"
                self.findings.add(codes.SYNTAX.at(Span(file, number, at + 1, at + 2), what=what))
            self._end_section()
            self._din(text, file, number, found)
            return
        if not self.lines:
            self.first = Place(file, number)
        begins_in_comment = self.opened
        sign, self.opened = mode_sign(text, self.opened)
        own = text if sign is None else text[: sign[0]]
        found.append((number, text, [PASCAL, *pascal_notes(own, 0, begins_in_comment)]))
        self.lines.append(own)
        if sign is None:
            return
        self._end_section()
        self._start(Span(file, number, sign[0] + 1, sign[1] + 1))
        rest: list[LineNotes] = []
        self._din(text, file, number, rest, sign[1])
        found += [(line, written, [(note[0] + 1, *note[1:]) for note in notes]) for line, written, notes in rest]

    def _start(self, span: Span) -> None:
        self.structure.add([Mode(name="din", span=span)])
        self.persistence.mode()

    def _read_section(self) -> None:
        """Read the lines of a section that were collected."""
        if self.lines:
            section = parse_section(self.lines, self.first, self.symbols)
            self.structure.add(section.statements)
            self.procedures += section.subprograms
            self._refuse_words(section.statements)
            if self.shapes is not None and not self.symbols.same_names(self.shapes.symbols):
                self.shapes = Shapes(self.language, self.symbols)
        self.lines = []

    def _refuse_words(self, nodes: tuple[Statement, ...]) -> None:
        """Names that are words of DIN lines as well: ``X 5`` could be the variable X.

        One like I or F is only in doubt where a line has that word: real programs count with i, j and k.
        """
        for node in nodes:
            if not isinstance(node, Declare) or node.kind == "label":
                continue
            for name in node.names:
                if len(name) != 1:
                    continue
                if name.upper() in CENTERS + VALUE_LETTERS + "DN":
                    self.doubtful[name.upper()] = name
                elif name.upper() in self.letters:
                    what = f"{name!r} is a declared name, and also a word of DIN lines"
                    self.findings.add(codes.PASCAL_OPEN.at(node.span, what=what, hint="choose a longer name"))

    def _end_section(self) -> None:
        if self.pascal:
            self._read_section()
        self.pascal = False

    def _din(self, text: str, file: str, number: int, found: list[LineNotes], at: int = 0) -> None:
        if at == 0 and self.shapes is not None and self._known(self.shapes, text, file, number, found):
            return
        before = self.persistence.in_force
        findings = self._findings()
        line = self.reader.read(text, file, number, at)
        if line.notes or not text.isascii():
            found.append((number, text, line.notes))
        if self.numbered and not line.number and line.statements:
            self.findings.add(codes.LINE_NUMBER_MISSING.at(Span(file, number, 1, 2)))
        dollar = None
        for node in line.statements:
            if isinstance(node, Jump | Call):
                for name in (node.name, node.name.removeprefix("l")):  # ``M98 LUP1`` is ``M98 UP1`` too
                    self._spelled(name, text[: node.span.end_column - 1], node.span)
        if line.module is not None and line.module_span is not None:
            self._spelled(line.module.lower(), line.module, line.module_span)
            self.structure.module(line.module, line.module_span)
        elif line.starts is not None:
            begin, end = line.starts
            found.append((number, text, [PASCAL]))
            self._start(Span(file, number, begin + 1, end + 1))
            self._din(text, file, number, found, end)
        elif line.pascal >= 0:
            dollar = self._dollar(text, line, file, number, found)
        self._refuse_doubtful(line.statements)
        if line.number and "N" in self.doubtful:
            self._doubt("N", Span(file, number, at + 1, len(text) + 1))
        nodes: Sequence[Statement] = line.statements
        if isinstance(dollar, Simple):
            nodes = continued(dollar.statements, before[0])
        if at == 0 and self.shapes is not None:
            if findings == self._findings():
                notes = [note for _, _, notes in found for note in notes]
                self.shapes.learn(text, file, number, before, self.persistence.in_force, line, dollar, notes)
            blocks = sum(isinstance(node, Block) for node in nodes)
            if blocks and self.held <= 0:
                self._count(size_of_deferred(nodes))
                nodes = self.shapes.deferred(nodes, text.encode(), file, number, before)
            self.held -= blocks
        self.structure.add(nodes)

    def _spelled(self, name: str, text: str, span: Span) -> None:
        """The name of a module at the end of a text: written otherwise elsewhere it may be that of another one."""
        at = text.lower().rfind(name) if not name.isdigit() else -1
        if at < 0:
            return
        written = text[at : at + len(name)]
        other = self.spelled.setdefault(name, written)
        if other != written and self.symbols.case_sensitive is not False:
            why = (
                "and modules and calls are compared here regardless of case"
                if self.symbols.case_sensitive
                else "which is a setting"
            )
            what = f"{written!r} and {other!r} differ only in case, {why}"
            self.findings.add(codes.PASCAL_OPEN.at(span, what=what, hint="write the names in the same case"))

    def _count(self, size: tuple[int, int]) -> None:
        """Add to the words and nodes of deferred blocks."""
        self.deferred = self.deferred[0] + size[0], self.deferred[1] + size[1]

    def _findings(self) -> int:
        """How many there are."""
        return sum(self.findings.counts.values())

    def _known(self, shapes: Shapes, text: str, file: str, number: int, found: list[LineNotes]) -> bool:
        """Take a line whose shape is known; False when it must be read."""
        before = self.persistence.in_force
        line = shapes.find(text, before)
        if line is None:
            return False
        known = line.known
        if self.numbered and not known.number and known.says:
            return False
        if self.doubtful and ("N" in self.doubtful or not known.letters.isdisjoint(self.doubtful)):
            return False
        if known.notes or not text.isascii():
            found.append((number, text, line.notes()))
        if known.dollar == "head":
            self.structure.pascal(text, text.index("$") + 1, file, number, line.dollar(file, number))
        elif self.held > 0:
            self.structure.add(line.nodes(file, number))
            self.held -= sum(known.blocks)
        else:
            self._count(known.size)
            self.structure.add(shapes.deferred_known(line, text.encode(), file, number, before))
        self.persistence.state, self.persistence.distances = known.after
        return True

    def _refuse_doubtful(self, nodes: list[Statement]) -> None:
        """Words whose letter is a declared name too."""
        for node in nodes if self.doubtful else ():
            for word in node.words if isinstance(node, Block) else ():
                if word.letter in self.doubtful:
                    self._doubt(word.letter, word.span)

    def _doubt(self, letter: str, span: Span) -> None:
        name = self.doubtful.pop(letter)
        what = f"{letter} of a DIN line, where {name!r} is a declared name,"
        self.findings.add(codes.PASCAL_OPEN.at(span, what=what, hint="choose a longer name"))

    def _dollar(self, text: str, line: DinLine, file: str, number: int, found: list[LineNotes]) -> Dollar | None:
        """A ``$`` line; what it is of rw_SymPas, None for a mistake and for what it says to the compiler."""
        at = line.pascal
        end, include = DINEND.match(text, at), INCLUDE.match(text, at)
        if end is not None:
            self.structure.add([Mode(name="pascal", span=Span(file, number, at + 1, end.end() + 1))])
            self.persistence.mode()
            self._begin_section(implied=False)
            self._pascal_line(" " * end.end() + text[end.end() :], file, number, found)
        elif include is not None:
            name, span = include["name"], Span(file, number, at + 1, include.end() + 1)
            if not name or text[include.end() :].lstrip(" \t")[:1] not in ("", "'", "("):
                what = "$I must be followed by a file name without blanks, and nothing else but a comment"
                raise Refusal(codes.SYNTAX.at(Span(file, number, at + 1, len(text.rstrip()) + 1), what=what))
            rest = self.reader.read(text, file, number, include.end())
            if rest.says:
                what = "only a comment is allowed after $I and its name"
                raise Refusal(codes.SYNTAX.at(Span(file, number, include.end() + 1, len(text) + 1), what=what))
            found.append((number, text, [(1, *note[1:]) for note in rest.notes]))
            self.structure.add([Include(name=name, span=span)])
            self.persistence.doubt()
            self.include(name, span)
            self.persistence.doubt()
        else:
            found.append((number, text, [PASCAL, *pascal_notes(text, at + 1, opened=False)]))
            dollar = self.structure.pascal(text, at + 1, file, number)
            self.persistence.doubt()
            return dollar
        return None
