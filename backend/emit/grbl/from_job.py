"""A legal Job as text of grbl 1.1. Source: grbl's documentation, pages "Interface" and "Supported G-Codes"."""

from __future__ import annotations

import textwrap

from gproof.backend.emit.printer import Unprintable
from gproof.backend.emit.rs274.writer import LENGTH, Rs274Writer
from gproof.ir.finding import Span
from gproof.ir.job import ChangeTool, Job, PauseJob, Quantity, Remark, SetFrame, SwitchCoolant, UseLength
from gproof.ir.machine import Machine
from gproof.ir.program import Expr, Number
from gproof.ir.target import Style, Target

_REAL_TIME = str.maketrans({"?": ".", "!": ".", "~": "-", "(": "[", ")": "]", "\t": " "})
"""Characters that grbl takes out of the stream at once and acts on, in comments too (Interface, Real-Time Commands)."""


class GrblWriter(Rs274Writer):
    """Lines of at most ``style.line_length`` characters: grbl's buffer of a line is short (Interface)."""

    both_coolants = False
    inserted: Expr | None = None
    """The tool that the operator has put in at the last stop for one."""

    def pause(self, node: PauseJob) -> None:
        """M0, with T for a tool."""
        super().pause(node)
        self.inserted = self.inserted if node.tool is None else node.tool

    def write(self) -> bytes:
        """Lines that grbl takes; Unprintable for a longer one."""
        text = super().write()
        most = self.style.line_length
        if most and any(len(line) > most for line in text.splitlines()):
            raise Unprintable(f"a line of more than {most} characters")
        return text

    def comment(self, text: str) -> str:
        """``(text)``, in ASCII."""
        plain = text.translate(_REAL_TIME).encode("ascii", "replace").decode().replace("?", ".")
        return f"({plain.strip()})"

    def remark(self, node: Remark) -> None:
        """A comment, in pieces that fit; at the end of a line where there is room."""
        if not self.style.line_length or (node.trailing and len(self.comment(node.text)) < self.room()):
            super().remark(node)
            return
        width = self.style.line_length - 2 - self.style.indent * self.depth
        for piece in textwrap.wrap(node.text, width) or [""]:
            self.line(self.comment(piece))

    def room(self) -> int:
        """Characters that the line before has left."""
        used = self.style.indent * self.depth + sum(len(word) + 1 for _, word in self.pending)
        if not self.pending and self.out:
            text = self.out[-1]
            used = len(text) - 1 - text.rfind(b"\n", 0, len(text) - 1)
        return self.style.line_length - used

    def coolant(self, node: SwitchCoolant) -> None:
        """M8, M9: there is only flood."""
        super().coolant(SwitchCoolant(span=node.span, flood=node.flood))

    def tool(self, node: ChangeTool) -> None:
        """There is no M6."""
        raise Unprintable("a tool change")

    def length(self, node: UseLength) -> None:
        """G49, or G43.1 with the length that the machine file has of the tool: grbl has no tool table."""
        if not node.on:
            self.put(LENGTH, ["G49"], node.span)
            return
        named = self.inserted if node.tool is None else node.tool
        number = round(named.value) if isinstance(named, Number) else None
        tool = next((one for one in self.machine.tools if one.number == number), None)
        if tool is None or tool.length is None:
            raise Unprintable("the length of a tool that the machine file does not have")
        self.line(f"G43.1 Z{self.millimetres(tool.length)}")

    def millimetres(self, value: float) -> str:
        """A length in the unit of the text."""
        if "unit" not in self.state:
            self.line("G21")
            self.state["unit"] = "mm"
        return self.amount(Quantity(Number(value, Span("", 0)), "mm"))

    def frame(self, node: SetFrame) -> None:
        """G54 to G59, G10, G92, G92.1."""
        if node.number is not None:
            number = round(node.number.value) if isinstance(node.number, Number) else 0
            if not 1 <= number <= self.target.offsets:
                raise Unprintable(f"work offset {number}")
        super().frame(node)


def write(job: Job, target: Target, machine: Machine, style: Style) -> dict[str, bytes]:
    """The files of a job: text by name, "" for its own; Unprintable."""
    return {"": GrblWriter(job, target, machine, style).write()}
