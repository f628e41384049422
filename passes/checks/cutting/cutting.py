"""The property cutting: a tool that turns as it should is in every cut, and the job ends clear of the work.

Wanted by ``--also cutting``. What a cut is: ``cut_rows``. Whether a spindle turns: by the program's own codes, or by
the output that the machine file names (``output`` of a spindle) where the language has no code for it.
``spindle = false`` of a machine file says that no program starts one. docs/cutting-sense.md has the codes, what each
weighs, and why.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from gproof.ir import codes
from gproof.ir.finding import Code, Findings, Span
from gproof.ir.machine import Machine
from gproof.ir.program import Program
from gproof.ir.rules import Function as F
from gproof.ir.setup import ZERO, Setup
from gproof.ir.trace import Affine, Chunk, Op, Wait
from gproof.ir.trace_rows import row_span
from gproof.ir.verdict import PropertyResult
from gproof.passes.checks.aggregate import Causes, answer
from gproof.passes.checks.base import Check
from gproof.passes.checks.cutting.other_heads import OtherHeads
from gproof.passes.checks.cutting.spin_up import BY_CODE, Flow, Started, reached, runs_of, waited
from gproof.passes.checks.tooling.cutting_rows import (
    SOMEWHERE,
    Bools,
    CutRows,
    Floats,
    Guarded,
    StateColumn,
    tool_column,
)

SLACK = 1e-9
NO_CODE, ABORTED = 1.0, 2.0
"""``arg`` of END rows that no code of the program has made."""
_ENDS = (F.END, F.END_RESET)
_OTHER_TOOLS = frozenset(("pwm", "height_control", "height_setpoint", "extruder_temperature"))
"""What a SETPOINT row sets where a job works with another tool than a spindle."""
_NONE = (
    "set spindle = false in the machine file if programs start no spindle (knife, torch, laser, spindle switched by "
    "hand)"
)


class Cutting(Check):
    """See the module's text."""

    name = "cutting"

    def __init__(self, program: Program, machine: Machine, setup: Setup, findings: Findings) -> None:
        super().__init__(machine, setup, findings)
        self._program = program
        self._rows = CutRows(program)
        self._spindle = StateColumn(lambda state: state.spindle)
        self._surface = StateColumn(lambda state: float(state.surface_speed != 0.0))
        self._at_most = StateColumn(lambda state: state.spindle_limit)
        self._follows = StateColumn(lambda state: float(state.synchronised))
        self._tool = StateColumn(lambda state: float(state.tool))
        self._fastest = tool_column(machine, lambda tool: tool.max_rpm)
        self._slowest = tool_column(machine, lambda tool: tool.min_rpm)
        self._limited = any(t.max_rpm is not None or t.min_rpm is not None for t in machine.tools)
        self._runs = runs_of(program, machine)
        devices = machine.settings.devices
        self._others = OtherHeads(program, machine, self._runs)
        pumps = machine.settings.coolant or program.spindle_outputs.coolant
        self._pumps = frozenset(pumps) - self._runs.channels
        self._by_hand = bool(self._runs.channels) and devices is not None and "spindle" not in devices
        on = frozenset(c for c in self._runs.channels if setup.outputs.get(c) == 1.0)
        self._flow: dict[int, Flow] = {0: Flow(on=on, turns=_known(self._runs.turns(on)))}
        self._now = Flow()
        self._causes, self._held = Causes(findings), Causes(findings)
        self._guarded = Guarded()
        self._switched: set[int] = set()
        self._starts = self._other_tool = self._names_tools = False
        self._wet: dict[int, list[bool]] = {}
        self._dry: dict[int, Span] = {}
        # By the unknowns of Z: the least height of moves across, the greatest of all, and of the ends of cuts.
        self._across: dict[Affine, float] = {}
        self._highest: dict[Affine, float] = {}
        self._cut_at: dict[Affine, float] = {}

    def feed(self, chunk: Chunk) -> None:
        """Some successive rows."""
        if chunk.begin == 0:
            self._now = self._flow.pop(chunk.section, Flow())
        way = self._rows.ways(chunk)
        cut, held, again = self._guarded.split(chunk, self._rows.cuts(chunk, way))
        on = self._now.on
        rpm = self._speeds(chunk)
        if again:
            self._held.clear()
        for rows, causes in ((cut, self._causes), (held, self._held)):
            if rows.any():
                self._judge(chunk, rows, rpm, self._others.rows(chunk, way), causes)
        self._events(chunk, cut, on, way)
        self._heights(chunk, cut, way)
        if chunk.last:
            self._close(chunk, rpm)

    def finish(self) -> PropertyResult:
        """The answer, after the last chunk."""
        # A guard that stays off is no tool change.
        self._causes.take_over(self._held)
        stated = self.machine.spindle_started
        assumed: tuple[str, ...] = ()
        if stated is False:
            for code in (codes.SPINDLE_AT_REST, codes.SPINDLE_NOT_TOLD, codes.SPINDLE_SPEED_NOT_TOLD):
                self._causes.forget(code)
            assumed = ("no program starts a spindle on this machine (spindle = false)",)
        elif not (self._starts or stated):
            found = self._causes.take(codes.SPINDLE_AT_REST)
            if found is not None and self._other_tool:
                assumed = ("the job uses a tool that does not turn: it starts no spindle, and switches another",)
            elif found is not None:
                self._causes.add(
                    codes.SPINDLE_NOT_TOLD, 0, found.first, found.last, found.count, self._when_not_told()
                )  # fmt: skip
        elif self._starts:
            by_hand = ("the spindle speed is set by hand",) if self._by_hand else ()
            assumed = (*((self._runs.told,) if self._runs.told else ()), *by_hand)
        if not self._names_tools:
            # Where the job changes no tool, its number means nothing: the operator's cutter is in the spindle.
            self._causes.forget(codes.NO_TOOL)
        if any(any(wet) for wet in self._wet.values()):
            for tool, wet in self._wet.items():
                if not any(wet):
                    self._causes.add(codes.DRY_TOOL, tool, self._dry[tool], self._dry[tool], tool=tool)
        self._causes.report()
        return answer(self.name, self.findings, assumed)

    def _when_not_told(self) -> str:
        """What would tell whether a spindle turns."""
        known = {rule.function for rule in self._program.rules.codes.values()}
        if F.SPINDLE_CW in known or self._runs.channels:
            return f"program M3 before the first of them; or {_NONE}"
        many = ", ".join(map(str, sorted(self._switched)))
        which = f" (this job switches on {many})" if many else ""
        return (
            "state output = ... under [spindles.0] in the machine file, the output that runs the "
            f"spindle{which}; or {_NONE}"
        )

    def _speeds(self, chunk: Chunk) -> Floats:
        """(n,): revolutions a minute of each row, signed; 0 at rest, NaN: it turns at a speed that is not known.

        Where only some of the outputs are on that run the spindle together, infinity.
        """
        if not self._runs.channels:
            return self._spindle.rows(chunk)
        rows, now = chunk.rows, self._now
        rpm = np.full(len(rows), self._by_outputs())
        set_speed = {k for k, text in enumerate(chunk.trace.texts) if text == "spindle_speed"}
        op = rows["op"]
        for at in np.flatnonzero((op == Op.OUTPUT) | (op == Op.SETPOINT)).tolist():
            if op[at] == Op.OUTPUT and rows["arg"][at, 0] in self._runs.channels:
                now.on = _switched(now.on, rows["arg"][at])
            elif op[at] == Op.SETPOINT and int(rows["text"][at]) in set_speed:
                now.rpm = float(rows["arg"][at, 1])
            else:
                continue
            rpm[at:] = self._by_outputs()
        by_code = self._spindle.rows(chunk)
        return np.where(by_code != 0.0, by_code, rpm)

    def _by_outputs(self) -> float:
        """The speed, signed, by the outputs that are on now."""
        turns = self._runs.turns(self._now.on)
        if turns == 0.0:
            return 0.0
        return math.inf if math.isnan(turns) else turns * (math.nan if self._by_hand else self._now.rpm)

    def _judge(self, chunk: Chunk, cut: Bools, rpm: Floats, other: Bools, causes: Causes) -> None:
        """Cuts by what their spindle does and which tool it holds."""
        surface = self._surface.rows(chunk) != 0.0
        tool = self._tool.rows(chunk)
        some = np.isinf(rpm) & ~other
        self._tell(causes, chunk, cut & other, codes.SPINDLE_NOT_TOLD, 2, self._others.hint)
        self._tell(causes, chunk, cut & some, codes.SPINDLE_NOT_TOLD, 1, self._which())
        rpm = np.where(some | other, np.nan, rpm)
        unsaid = cut & np.isnan(rpm) & ~surface & ~some & ~other
        if self._by_hand:
            # No program sets it: it counts where a tool has limits.
            unsaid &= ~(np.isnan(self._fastest.rows(chunk)) & np.isnan(self._slowest.rows(chunk)))
        self._tell(causes, chunk, cut & (rpm == 0.0), codes.SPINDLE_AT_REST, 0, "program M3 before the first of them")
        self._tell(
            causes,
            chunk,
            unsaid,
            codes.SPINDLE_SPEED_NOT_TOLD,
            0,
            "leave min_rpm and max_rpm out of the tool if its speed is set by hand"
            if self._by_hand
            else "program S as a plain number before M3",
        )
        if self._limited and surface.any():
            # At constant surface speed it may turn as fast as its limit, and at rest where the diameter is large.
            fastest, slowest = self._fastest.rows(chunk), self._slowest.rows(chunk)
            fits = np.isnan(slowest) & (np.isnan(fastest) | (self._at_most.rows(chunk) <= fastest * (1.0 + SLACK)))
            hint = "program a maximum spindle speed (D of G96) that the tool allows, and leave min_rpm out of the tool"
            self._tell(causes, chunk, cut & surface & ~fits, codes.SPINDLE_SPEED_NOT_TOLD, 3, hint)
        holds_none = cut & (tool == 0)
        if self.setup.name == ZERO.name and not self._names_tools:
            # The setup zero says tool 0 of any machine: only what the job itself puts away is gone.
            holds_none &= np.maximum.accumulate(chunk.rows["op"] == Op.TOOL_CHANGE)
        self._tell(
            causes,
            chunk,
            holds_none,
            codes.NO_TOOL,
            0,
            "program T and its tool change before, or state tool = ... in the setup file",
        )
        milling = cut & (self._follows.rows(chunk) == 0.0)
        if not self.machine.controller.turning:
            self._tell(
                causes, chunk, milling & (rpm < 0.0), codes.TURNS_BACKWARDS, 0, "check that the tool is left-hand"
            )
        if not self._limited:
            return
        self._tell(
            causes,
            chunk,
            cut & (tool < 0),
            codes.TOOL_NOT_TOLD,
            0,
            "program T before, or state tool = ... in the setup file",
        )
        speed = np.abs(rpm)
        for name, code, over, limit in (
            ("fast", codes.TOOL_TOO_FAST, speed - self._fastest.rows(chunk), self._fastest),
            ("slow", codes.TOOL_TOO_SLOW, self._slowest.rows(chunk) - speed, self._slowest),
        ):
            allowed = limit.rows(chunk)
            found = milling & (rpm != 0.0) & (over > SLACK * allowed)
            for number in np.unique(tool[found]).tolist():
                mine = found & (tool == number)
                at = int(np.argmax(np.where(mine, over, -math.inf)))
                values = {
                    "tool": int(number),
                    "rpm": float(speed[at]),
                    "allowed": float(allowed[at]),
                    "over": float(over[at]),
                }
                hint = (
                    f"program another S, or change {'max_rpm' if name == 'fast' else 'min_rpm'} of this tool in "
                    "the machine file"
                )
                self._tell(causes, chunk, mine, code, int(number), hint, **values)
                causes.worse(code, int(number), "over", float(over[at]), **values)

    def _events(self, chunk: Chunk, cut: Bools, on: frozenset[int], way: Floats) -> None:
        """What rows that do not move change: spindle, coolant, tools, outputs of other tools; and who cuts dry.

        on: outputs that run the spindle and are on before.
        """
        rows, now, op = chunk.rows, self._now, chunk.rows["op"]
        if now.started is not None:
            self._reach(chunk, cut, way, 0)
        before = now.turns
        for at in np.flatnonzero((op >= Op.SPINDLE) & (op != Op.PLANE)).tolist():
            kind = op[at]
            if kind == Op.SPINDLE or (kind == Op.OUTPUT and rows["arg"][at, 0] in self._runs.channels):
                # A program that stops a spindle, or starts one anywhere, has to start it before it cuts.
                self._starts = True
                if kind == Op.SPINDLE:
                    turns = float(np.sign(rows["arg"][at, 0]))
                else:
                    on = _switched(on, rows["arg"][at])
                    turns = _known(self._runs.turns(on))
                if turns and turns != before:
                    self._start(chunk, at, cut, way)
                elif not turns:
                    now.started = None
                elif now.started is not None:
                    # Another speed on the way to the first one.
                    self._reach(chunk, cut, way, at + 1)
                before = turns
            elif kind == Op.COOLANT:
                self._count_wet(chunk, cut, now.wet_from, at)
                others = now.wet - {BY_CODE}
                now.wet, now.wet_from = others | {BY_CODE} if rows["arg"][at].any() else others, at
            elif kind == Op.OUTPUT and rows["arg"][at, 0] in self._pumps:
                self._count_wet(chunk, cut, now.wet_from, at)
                now.wet, now.wet_from = _switched(now.wet, rows["arg"][at]), at
            elif kind == Op.TOOL_CHANGE:
                self._names_tools = True
            elif kind == Op.SETPOINT:
                self._other_tool = self._other_tool or chunk.trace.texts[int(rows["text"][at])] in _OTHER_TOOLS
            elif kind == Op.OUTPUT and rows["arg"][at, 1]:
                self._switched.add(int(rows["arg"][at, 0]))
                self._other_tool = self._other_tool or rows["arg"][at, 0] in self._channels()
        now.turns = before
        self._count_wet(chunk, cut, now.wet_from, len(rows))
        now.wet_from = 0

    def _which(self) -> str:
        """What to do where only some of the outputs are on that the shop's start code switches on."""
        many = ", ".join(map(str, sorted(self._runs.channels)))
        return f"state output = ... under [spindles.0] in the machine file: which of {many} runs the spindle"

    def _channels(self) -> tuple[int | None, ...]:
        """Outputs of a torch, or of what is on during feed moves."""
        controls = self.machine.settings
        return (None if controls.torch is None else controls.torch.output, controls.auto_output)

    def _start(self, chunk: Chunk, at: int, cut: Bools, way: Floats) -> None:
        """The spindle starts to turn, or turns round, in row ``at``."""
        spindle = self.machine.spindle(int(chunk.trace.states[int(chunk.rows["state"][at])].head))
        if spindle is None or spindle.spin_up is None:
            return
        ramp = self.machine.controller.spindle_ramp_time if chunk.rows["op"][at] == Op.SPINDLE else 0.0
        self._now.started = Started(spindle.spin_up, ramp)
        self._reach(chunk, cut, way, at + 1)

    def _reach(self, chunk: Chunk, cut: Bools, way: Floats, begin: int) -> None:
        """Go on with a start from row ``begin`` to the first cut, the next order to the spindle, or the chunk's end."""
        started = self._now.started
        assert started is not None
        end = reached(chunk, cut, begin, self._runs.channels)
        started.seconds += waited(chunk, way, begin, end, self.machine)
        if end < len(chunk.rows) and cut[end]:
            if started.seconds < started.needed * (1.0 - SLACK):
                place = row_span(chunk.trace, chunk.rows, end)
                hint = "program a dwell (G4) after the spindle start"
                values = {"seconds": started.seconds, "needed": started.needed}
                self._causes.add(codes.CUT_BEFORE_SPEED, place, place, place, 1, hint, **values)
            self._now.started = None

    def _count_wet(self, chunk: Chunk, cut: Bools, begin: int, end: int) -> None:
        """Remember of each tool that cuts in these rows whether coolant is on."""
        if begin >= end or not cut[begin:end].any():
            return
        tools = np.unique(self._tool.rows(chunk)[begin:end][cut[begin:end]])
        for tool in tools[tools > 0].astype(int).tolist():
            self._wet.setdefault(tool, []).append(bool(self._now.wet))
            if tool not in self._dry:
                at = begin + int(np.argmax(cut[begin:end] & (self._tool.rows(chunk)[begin:end] == tool)))
                self._dry[tool] = row_span(chunk.trace, chunk.rows, at)
            self._wet[tool] = [any(self._wet[tool])]

    def _heights(self, chunk: Chunk, cut: Bools, way: Floats) -> None:
        """How high the job traverses, cuts, and is at all, by what Z rests on; and whether its last move cuts."""
        rows = chunk.rows
        moves = rows["op"] < Op.DWELL
        across = (rows["op"] == Op.TRAVERSE) & ~(np.abs(way[:, :2]) < SOMEWHERE).all(axis=1)
        height, start = rows["to"][:, 2], rows["to"][:, 2] - way[:, 2]
        low = np.fmin(height, start)
        frames: npt.NDArray[np.int32] = rows["frame"]
        for frame in np.unique(frames[moves]).tolist():
            form = chunk.trace.frames[frame][2]
            here = moves & (frames == frame)
            self._highest[form] = max(self._highest.get(form, -math.inf), float(height[here].max()))
            if (here & across).any():
                self._across[form] = min(self._across.get(form, math.inf), float(low[here & across].min()))
            if (here & cut).any():
                self._cut_at[form] = max(self._cut_at.get(form, -math.inf), float(height[here & cut].max()))
        if moves.any():
            self._now.cutting = bool(cut[np.flatnonzero(moves)[-1]])

    def _close(self, chunk: Chunk, rpm: Floats) -> None:
        """The end of a section: what goes on after it, or how the job ends."""
        for edge in chunk.edges:
            if edge.target >= 0:
                passed = self._now.copy()
                if edge.wait is not Wait.BRANCH:
                    # Whoever waits here may take as long as a spindle needs.
                    passed.started = None
                known = self._flow.get(edge.target)
                self._flow[edge.target] = passed if known is None else known.joined(passed)
        count = len(chunk.rows)
        ended = count and chunk.rows["op"][-1] == Op.END and all(edge.outcome == "end" for edge in chunk.edges)
        if not ended or chunk.rows["arg"][-1, 0] == ABORTED:
            return
        last = count - 1
        where = row_span(chunk.trace, chunk.rows, last)
        if rpm[last] != 0.0 and self.machine.spindle_started is not False:
            self._causes.add(codes.SPINDLE_LEFT_ON, where, where, where, hint="program M5 before the end")
        known_ends = [rule.text for rule in self._program.rules.codes.values() if rule.function in _ENDS]
        if chunk.rows["arg"][last, 0] == NO_CODE and known_ends:
            self._causes.add(codes.END_MISSING, where, where, where, known=" or ".join(known_ends))
        if not self.machine.controller.turning:
            self._end_height(chunk, last, where)

    def _end_height(self, chunk: Chunk, last: int, where: Span) -> None:
        form = chunk.trace.frames[int(chunk.rows["frame"][last])][2]
        height = float(chunk.rows["to"][last, 2])
        if form not in self._highest:
            return
        clear = self._across.get(form, self._highest[form])
        in_cut = self._now.cutting or height < self._cut_at.get(form, -math.inf) - SOMEWHERE
        if in_cut and height < clear - SOMEWHERE:
            hint = "program a rapid move up before the end"
            self._causes.add(
                codes.NOT_RETRACTED, where, where, where, 1, hint, reached=height, below=clear - height
            )  # fmt: skip

    def _tell(
        self, causes: Causes, chunk: Chunk, rows: Bools, code: Code, key: int, hint: str, **values: object
    ) -> None:
        found = np.flatnonzero(rows)
        if found.size:
            first, last = (row_span(chunk.trace, chunk.rows, int(found[at])) for at in (0, -1))
            causes.add(code, key, first, last, found.size, hint, **values)


def _switched(on: frozenset[int], order: Floats) -> frozenset[int]:
    """Outputs that are on after an order to one of them: its channel, and whether it is on then."""
    channel = int(order[0])
    return on | {channel} if order[1] else on - {channel}


def _known(turns: float) -> float:
    """A direction; where only some outputs are on, the spindle counts as at rest."""
    return 0.0 if math.isnan(turns) else turns
