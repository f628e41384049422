"""Markdown on a terminal: headings at the left, programs in colours, indented.

rich is imported by the time that there is something to show.
"""

from __future__ import annotations

import os
from typing import ClassVar


def show_markdown(text: str, widest: int) -> None:
    """Print a page as wide as the terminal is, at most ``widest``; without colours where ``NO_COLOR`` is set."""
    from rich.console import Console, ConsoleOptions, RenderResult
    from rich.markdown import CodeBlock, Heading, Markdown
    from rich.padding import Padding
    from rich.syntax import Syntax
    from rich.text import Text
    from rich.theme import Theme

    class Program(CodeBlock):
        """Indented, on the terminal's own background."""

        def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
            plain = bool(os.environ.get("NO_COLOR"))
            code = str(self.text).rstrip("\n")
            shown = Syntax(code, "text" if plain else self.lexer_name, theme="ansi_dark", word_wrap=True)
            yield Padding(shown, (0, 0, 0, 4))

    class Title(Heading):
        """At the left."""

        def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
            style = {"h1": "bold cyan", "h2": "bold underline"}.get(self.tag, "bold")
            yield Text(self.text.plain, style=style)

    class Page(Markdown):
        elements: ClassVar = {**Markdown.elements, "fence": Program, "code_block": Program, "heading_open": Title}

    console = Console(highlight=False, theme=Theme({"markdown.code": "cyan"}))
    console.print(Page(text, code_theme="ansi_dark", hyperlinks=False), width=min(widest, console.width))
