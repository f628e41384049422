"""Settings of the machine that gproof cannot follow, and which of them a job touches: GP605 for these alone.

``Unmodelled.touches`` names the jobs (``ir/machine.py: TOUCHES``). What commands show is met by the executor, arcs by
the rows that it makes; settings of an axis, and of every axis that moves, are noted by the limits.
"""

from __future__ import annotations

import numpy as np

from gproof.ir import codes
from gproof.ir.finding import Findings, Related, Span
from gproof.ir.machine import Machine, Unmodelled
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.trace import Chunk, Op
from gproof.ir.trace_rows import row_span

FUNCTIONS: dict[F, str] = {
    F.ARC_CW: "arcs", F.ARC_CCW: "arcs",
    F.DRILL: "cycles", F.DRILL_DWELL: "cycles", F.DRILL_PECK: "cycles", F.DRILL_CHIP_BREAK: "cycles",
    F.HOME: "homing",
    F.TOOL_NUMBER: "tools", F.MEASURE_TOOL: "tools", F.MEASURE_SWITCH: "tools", F.SHIFT_MEASURES: "tools",
    F.STORE_TOOL: "tools", F.TOOL_OFFSET_ON: "tools", F.TOOL_OFFSET_OFF: "tools",
    F.COMPENSATION_LEFT: "compensation", F.COMPENSATION_RIGHT: "compensation",
    F.KNIFE_ON: "knife", F.KNIFE_SETTING: "knife", F.SAW_ON: "saw",
    F.TORCH_ON: "torch", F.HEIGHT_ON: "torch",
    F.PROBE_ON: "probe", F.MEASURE_SURFACE: "probe", F.MEASURE_DEPTH: "probe",
}  # fmt: skip
"""What commands show that a job touches."""


class OpenSettings:
    """What a run has met. noted: settings that were reported, each once; waiting: those that no line has met yet."""

    def __init__(self, machine: Machine, findings: Findings) -> None:
        self.machine = machine
        self.findings = findings
        self.noted: list[Unmodelled] = []
        self.waiting: dict[str, list[Unmodelled]] = {}
        for setting in machine.not_modelled:
            if setting.touches:
                self.waiting.setdefault(setting.touches, []).append(setting)

    def line(self, rule: CodeRule, span: Span) -> None:
        """A command is executed."""
        if self.waiting and rule.function in FUNCTIONS:
            self.meet(FUNCTIONS[rule.function], span)

    def meet(self, touches: str, span: Span | None = None) -> None:
        """A line of the job touches settings of this kind; span: None for the job as a whole."""
        for setting in self.waiting.pop(touches, ()):
            note(setting, self.machine, self.findings, span)
            self.noted.append(setting)

    def feed(self, chunk: Chunk) -> None:
        """Arcs among rows, which plain lines make without a word to anybody; a small one is a line, with GP407."""
        if "arcs" not in self.waiting:
            return
        arcs = np.flatnonzero(chunk.rows["op"] == Op.ARC)
        if len(arcs):
            self.meet("arcs", row_span(chunk.trace, chunk.rows, int(arcs[0])))
        elif codes.ARC_UNDER_MINIMUM.number in self.findings.counts:
            self.meet("arcs")


def note(setting: Unmodelled, machine: Machine, findings: Findings, met: Span | None = None) -> None:
    """GP605 at the place of a setting; met: the line of the job that touches it."""
    span = Span(setting.file or machine.name, max(1, setting.line))
    related = () if met is None else (Related(met, "this line depends on it"),)
    findings.add(codes.NOT_MODELLED_SETTING.at(span, key=setting.text, related=related))
