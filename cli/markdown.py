"""Markdown on a terminal: headings at the left, programs indented, the line that a finding is about in red.

rich is imported by the time that there is something to show.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, ClassVar

if TYPE_CHECKING:
    from rich.text import Text

EXPECTED = re.compile(r"\bexpect: *GP\d")
"""What marks a line of a bad program."""

COMMENTS = {".cnc": r";.*|\([^)]*\)", ".tap": r"\[.*", ".mac": r"\[.*", ".src": r"'.*", ".inc": r"'.*"}
"""Where a comment is, by the suffix of a program; enough for colours."""


def show_markdown(text: str, widest: int) -> None:
    """Print a page as wide as the terminal is, at most ``widest``; without colours where ``NO_COLOR`` is set."""
    from markdown_it.token import Token
    from rich.console import Console, ConsoleOptions, RenderResult
    from rich.markdown import CodeBlock, Heading, Markdown
    from rich.padding import Padding
    from rich.syntax import Syntax
    from rich.text import Text
    from rich.theme import Theme

    class Block(CodeBlock):
        """Indented, on the terminal's own background."""

        def __init__(self, language: str, name: str) -> None:
            super().__init__(language, "ansi_dark")
            self.name = name

        @classmethod
        def create(cls, markdown: Markdown, token: Token) -> Block:
            language, name, *_ = [*token.info.split(), "text", ""]
            return cls(language, name)

        def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
            code = str(self.text).rstrip("\n")
            is_program = self.lexer_name == "gcode"
            shown = _program(code, self.name) if is_program else Syntax(code, self.lexer_name, theme=self.theme)
            yield Padding(shown, (0, 0, 0, 4))

    class Title(Heading):
        """At the left."""

        def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
            yield Text(self.text.plain, style={"h1": "bold cyan", "h2": "bold underline"}.get(self.tag, "bold"))

    class Page(Markdown):
        elements: ClassVar = {**Markdown.elements, "fence": Block, "code_block": Block, "heading_open": Title}

    text = re.sub(r"^\|.*", lambda row: re.sub(r"\[([^]]+)\]\([^)]+\)", r"`\1`", row[0]), text, flags=re.MULTILINE)
    console = Console(highlight=False, theme=Theme({"markdown.code": "cyan"}))
    console.print(Page(text, hyperlinks=False), width=min(widest, console.width))


def _program(code: str, name: str) -> Text:
    """A program with its comments faint."""
    from rich.text import Text

    out = Text(overflow="fold")
    comment = COMMENTS.get(name[name.rfind(".") :].lower())
    for n, line in enumerate(code.split("\n")):
        shown = Text(line, style="bold red" if EXPECTED.search(line) else "")
        if comment:
            shown.highlight_regex(comment, "dim")
        out.append("\n" if n else "").append_text(shown)
    return out
