"""O words of LinuxCNC: subprograms, choices and loops of a file (LinuxCNC user manual, O Codes)."""

from __future__ import annotations

import re

from gproof.ir.record import field, record
from gproof.verify.translation.rs274.language import Unread

_O_WORD = re.compile(r"o\s*(?P<name>\d+|<[a-z0-9_]+>)\s*(?P<word>[a-z]+)\s*(?P<rest>.*)", re.IGNORECASE)


@record(slots=True)
class Step:
    """kind: ``lines`` (plain ones, from line ``first`` to before ``last``), ``line``, ``if``, ``while``, ``do``,
    ``call`` or ``return``; text: of a line or a condition; name: of a subprogram."""

    kind: str
    first: int
    last: int = 0
    text: str = ""
    name: str = ""
    body: list[Step] = field(default_factory=list)
    otherwise: list[Step] = field(default_factory=list)


@record(slots=True)
class Open:
    """An O word that waits for its end. where: the list that its steps go to."""

    name: str
    word: str
    step: Step | None
    where: list[Step]


class Structure:
    """Lines, one after the other, as steps within steps."""

    def __init__(self) -> None:
        self.top: list[Step] = []
        self.subs: dict[str, list[Step]] = {}
        self.stack: list[Open] = []
        self.used: set[str] = set()

    @property
    def here(self) -> list[Step]:
        """Where the next step goes."""
        return self.stack[-1].where if self.stack else self.top

    def add(self, step: Step) -> None:
        """A step that holds no others."""
        self.here.append(step)

    def o_word(self, text: str, line: int) -> bool:
        """Whether a line is one of an O word; Unread for one that is not known."""
        if text[:1].lower() != "o":
            return False
        found = _O_WORD.fullmatch(text)
        if found is None:
            raise Unread(f"{text[:20]!r}", line)
        name, word, rest = found["name"].lower(), found["word"].lower(), found["rest"].strip()
        if word in ("sub", "if", "do") or (word == "while" and not self._is_open(name, "do")):
            self._opens(name, word, rest, line)
        elif word in ("call", "return"):
            self._jumps(name, word, rest, line)
        else:
            self._closes(name, word, rest, line)
        return True

    def _is_open(self, name: str, word: str) -> bool:
        return bool(self.stack) and (self.stack[-1].name, self.stack[-1].word) == (name, word)

    def _opens(self, name: str, word: str, rest: str, line: int) -> None:
        if name in self.used or (word in ("sub", "do")) == bool(rest):
            raise Unread(f"o{name} {word}", line)
        self.used.add(name)
        if word == "sub":
            if self.stack:
                raise Unread("a subprogram within another block", line)
            body: list[Step] = []
            self.stack.append(Open(name, word, None, body))
            return
        step = Step(word, line, text=rest)
        self.here.append(step)
        self.stack.append(Open(name, word, step, step.body))

    def _jumps(self, name: str, word: str, rest: str, line: int) -> None:
        if rest:
            raise Unread(f"o{name} {word} {rest}", line)
        if word == "call":
            if name not in self.subs and name not in self.used:
                raise Unread(f"o{name}, which is not defined before its call", line)
            self.here.append(Step("call", line, name=name))
            return
        if not any(one.word == "sub" and one.name == name for one in self.stack):
            raise Unread("return outside of its subprogram", line)
        self.here.append(Step("return", line))

    def _closes(self, name: str, word: str, rest: str, line: int) -> None:
        if not self.stack or self.stack[-1].name != name:
            raise Unread(f"o{name} {word}, which closes nothing", line)
        top = self.stack[-1]
        if (top.word, word) == ("if", "else") and top.step is not None and not rest:
            top.word, top.where = "else", top.step.otherwise
            return
        pairs = {"sub": "endsub", "if": "endif", "else": "endif", "while": "endwhile", "do": "while"}
        if pairs[top.word] != word or (word == "while") != bool(rest):
            raise Unread(f"o{name} {word}", line)
        self.stack.pop()
        if top.word == "sub":
            self.subs[name] = top.where
        elif word == "while" and top.step is not None:
            top.step.text = rest

    def close(self, line: int) -> None:
        """The end of the file."""
        if self.stack:
            raise Unread(f"o{self.stack[-1].name} has no end", line)
