"""A legal Job as text of LinuxCNC. Sections are those of the LinuxCNC user manual 2.9."""

from __future__ import annotations

import re
from typing import Any

from gproof.backend.emit.job_numbers import text_of
from gproof.backend.emit.linuxcnc.expressions import inside, value, variable
from gproof.backend.emit.linuxcnc.names import VariableNames
from gproof.backend.emit.printer import Unprintable
from gproof.backend.emit.rs274.writer import LENGTH, PATH, Rs274Writer
from gproof.ir.job import (
    ArcTo,
    ChangeTool,
    Choice,
    DrillHole,
    DwellFor,
    EndJob,
    Job,
    LeaveRoutine,
    LoopWhile,
    Moves,
    MoveTo,
    Node,
    Nodes,
    PauseJob,
    Remark,
    Routine,
    RunRoutine,
    SetPathMode,
    SetVariable,
    ShowText,
    SwitchOutput,
    UseLength,
    WaitFor,
)
from gproof.ir.machine import Machine
from gproof.ir.program import Expr, Number, Text, Variable
from gproof.ir.target import Style, Target

FIRST_LABEL = 101
LONG_WAIT = 3600
"""Seconds of one M66 of a wait without a limit."""
_ACTIVE = re.compile(r"\s*(msg|debug|print|log\w*|probe\w*|py|abort)\b", re.IGNORECASE)
"""Comments that LinuxCNC acts on (Overview, Comments, Messages, Probe Logging)."""


class LinuxcncWriter(Rs274Writer):
    """labels: number of the O word that is open at each depth."""

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.naming = VariableNames(self.all_nodes(), self.target)
        self.labels: dict[int, int] = {}
        self.next_label = FIRST_LABEL
        self.inside = ""
        self.handlers |= {
            SetVariable: self.setting, RunRoutine: self.run, ShowText: self.message, SwitchOutput: self.output,
            WaitFor: self.wait, LeaveRoutine: self.leave,
        }  # fmt: skip

    def write(self) -> bytes:
        """A file that has no M2 or M30 at its end is between percent signs (Overview, File Requirements)."""
        text = super().write()
        last = next((node for node in reversed(self.job.body) if not isinstance(node, Remark)), None)
        if isinstance(last, EndJob):
            return text
        mark = b"%" + self.style.newline.encode()
        return mark + text + mark

    def header(self) -> list[str]:
        """Modes that a program before may have left otherwise: compensation, arc centres, corners."""
        modes = super().header()
        words = ["G40"]
        words += ["G80"] if any(isinstance(node, DrillHole) for node in self.job.body) else []
        if any(_has_arcs(node) for node in self.all_nodes()):
            words.append("G91.1")
        if not self.starts_with_path_mode():
            words.append("G61")
        return [*modes, " ".join(words)]

    def starts_with_path_mode(self) -> bool:
        """Whether the job says how corners are taken before its first move."""
        for node in self.job.body:
            if isinstance(node, SetPathMode):
                return True
            if not isinstance(node, Remark) and not _is_still(node):
                return False
        return False

    def expression(self, value_: Expr) -> str:
        """``5``, ``#101``, ``[#101 + 2]`` (Overview, Expressions)."""
        if isinstance(value_, Number):
            return text_of(value_.value, self.style.decimals)
        return value(value_, self.naming)

    def comment(self, text: str) -> str:
        """``(text)``, or after a semicolon where the text has brackets (Overview, Comments)."""
        if _ACTIVE.match(text):
            text = f"- {text}"
        return f"({text})" if "(" not in text and ")" not in text else f"; {text}"

    def routine_name(self, name: str) -> str:
        """Letters, digits and underscores in lower case (O Codes, Numbering)."""
        found = re.sub(r"[^a-z0-9_]", "_", self.plain_name(name).lower())
        return found if found[:1].isalpha() else f"s{found}"

    # ---- structure (O Codes)

    def open(self, node: Node) -> None:
        """``if``, ``while``, ``do``."""
        assert isinstance(node, Choice | LoopWhile)
        label = self.labels[self.depth] = self.next_label
        self.next_label += 1
        if isinstance(node, LoopWhile) and node.first:
            self.line(f"o{label} do")
            return
        word = "if" if isinstance(node, Choice) else "while"
        self.line(f"o{label} {word} [{inside(node.condition, self.naming)}]")

    def divide(self, node: Choice) -> None:
        """``else``."""
        self.line(f"o{self.labels[self.depth]} else")

    def close(self, node: Node) -> None:
        """``endif``, ``endwhile``, and the ``while`` at the end of ``do``."""
        assert isinstance(node, Choice | LoopWhile)
        label = self.labels[self.depth]
        if isinstance(node, LoopWhile) and node.first:
            self.line(f"o{label} while [{inside(node.condition, self.naming)}]")
        else:
            self.line(f"o{label} {'endif' if isinstance(node, Choice) else 'endwhile'}")

    def routine(self, routine: Routine) -> None:
        """``sub`` ... ``endsub``; it comes before the lines that call it."""
        self.inside = self.names[routine.name]
        self.line(f"o<{self.inside}> sub")
        body = routine.body
        if body and isinstance(body[-1], LeaveRoutine):
            body = body[:-1]
        self.indented(body)
        self.line(f"o<{self.inside}> endsub")
        self.line("")

    def leave(self, node: LeaveRoutine) -> None:
        """``return``."""
        self.line(f"o<{self.inside}> return")

    def run(self, node: RunRoutine) -> None:
        """``call``."""
        self.line(f"o<{self.names[node.name]}> call")
        self.state = dict(self.constant)

    def setting(self, node: SetVariable) -> None:
        """``#101 = [..]`` (Overview, Parameters)."""
        self.line(f"{variable(node.target, self.naming)} = {value(node.value, self.naming)}")

    # ---- operations

    def body(self, nodes: Nodes) -> None:
        """A list of operations; Unprintable for M62 and M63 without a motion after them, with which they act."""
        for place, node in enumerate(nodes):
            if isinstance(node, SwitchOutput) and node.moving:
                after = next((one for one in nodes[place + 1 :] if not _is_plain(one)), None)
                if not isinstance(after, Moves | MoveTo | ArcTo | DrillHole):
                    raise Unprintable("an output without stopping motion that no motion certainly follows")
        super().body(nodes)

    def message(self, node: ShowText) -> None:
        """``(MSG,..)``, with values ``(DEBUG,..)``, to the log ``(PRINT,..)`` (Overview, Messages)."""
        word, found = "MSG", []
        for part in node.parts:
            if isinstance(part, Text):
                found.append(part.value.replace("(", "[").replace(")", "]").replace("#", "No. "))
                continue
            word = "DEBUG"
            if not isinstance(part, Variable) or not isinstance(part.number, Number):
                spare = self.naming.spare()
                self.line(f"#{spare} = {value(part, self.naming)}")
                found.append(f"#{spare}")
            else:
                found.append(variable(part, self.naming))
        self.line(f"({'PRINT' if node.kind == 'log' else word}, {' '.join(found)})")

    def output(self, node: SwitchOutput) -> None:
        """M64, M65, with motion M62, M63 (M-Codes)."""
        if not isinstance(node.value, Number):
            raise Unprintable("an output whose state is computed")
        codes = ("M63", "M62") if node.moving else ("M65", "M64")
        self.line(f"{codes[bool(node.value.value)]} P{self.expression(node.channel)}")

    def wait(self, node: WaitFor) -> None:
        """M66 P L Q: L3 until it is on, L4 until it is off; #5399 is -1 when the time is over (M-Codes)."""
        if node.on is None:
            raise Unprintable("an input that is read")
        if node.timeout is None:
            self._wait_for_ever(node)
            return
        limit = self.scaled(node.timeout.value, 0.001) if node.timeout.unit == "ms" else node.timeout.value
        self.line(f"M66 P{self.expression(node.channel)} {'L3' if node.on else 'L4'} Q{self.expression(limit)}")

    def _wait_for_ever(self, node: WaitFor) -> None:
        """The same again and again: M66 always has a limit."""
        label = self.next_label
        self.next_label += 1
        self.line(f"o{label} do")
        blanks = " " * self.style.indent
        self.line(f"{blanks}M66 P{self.expression(node.channel)} {'L3' if node.on else 'L4'} Q{LONG_WAIT}")
        self.line(f"o{label} while [#5399 EQ -1]")

    def path(self, node: SetPathMode) -> None:
        """G61, G61.1, G64 P Q0: without Q0, P would be the tolerance of its filter too (G-Codes G64)."""
        if node.mode != "continuous" or node.tolerance is None:
            super().path(node)
            return
        self.flush()
        self.put(PATH, ["G64", f"P{self.amount(node.tolerance)}", "Q0"], node.span)
        self.flush()

    def hole(self, node: DrillHole) -> None:
        """A series counts its return height from its first hole (G-Codes G98 G99): a new cycle is a new series."""
        known = (node.kind, node.top, node.bottom, node.dwell, node.back)
        if self.state.get("cycle") is not None and self.state.get("series") != known:
            self.series_ends()
        super().hole(node)
        self.state["series"] = known

    def series_ends(self) -> None:
        """``G80``: the height of the next series is where the tool is."""
        if self.state.get("cycle") is not None:
            self.line("G80")
            self.state["cycle"], self.state["motion"] = None, None

    def length(self, node: UseLength) -> None:
        """G43 takes the length of the tool that is in the spindle now, and does not follow a change."""
        super().length(node)
        self.state["follows"] = node.on and node.tool is None

    def tool(self, node: ChangeTool) -> None:
        """T, M6; after it the length of the new tool, where it counts."""
        super().tool(node)
        if node.change and self.state.get("follows"):
            self.flush()
            self.put(LENGTH, ["G43"], node.span)


def _has_arcs(node: Node) -> bool:
    if isinstance(node, Moves):
        return bool((node.rows["centred"] != 0).any())
    return isinstance(node, ArcTo) and node.radius is None


def _is_still(node: Node) -> bool:
    """Whether an operation moves nothing and holds no others."""
    return not isinstance(node, Moves | MoveTo | ArcTo | DrillHole | Choice | LoopWhile | RunRoutine)


def _is_plain(node: Node) -> bool:
    """Whether an operation neither moves nor stops an axis, and holds no others."""
    return _is_still(node) and not isinstance(node, PauseJob | EndJob | WaitFor | DwellFor | ChangeTool)


def write(job: Job, target: Target, machine: Machine, style: Style) -> dict[str, bytes]:
    """The files of a job: text by name, "" for its own; Unprintable."""
    return {"": LinuxcncWriter(job, target, machine, style).write()}
