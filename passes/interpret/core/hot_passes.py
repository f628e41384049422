"""Loops of plain words and arithmetic: many passes by one compiled function, with the same rows, counts and findings.

``pass_compiler.py`` makes the function. It runs passes between those at whose end there is something to look at: the
state (``_lap``), where a loop leads (``_stop_away``), how far it is (``_ring``). Those ends, and every pass that holds
anything but numbers, are the executor's.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from gproof.ir.program import (
    Block,
    Call,
    Declare,
    Expr,
    For,
    If,
    Jump,
    Repeat,
    Return,
    Statement,
    Subprogram,
    Variable,
    While,
)
from gproof.passes.interpret.core.block_compiler import FALLS_BACK
from gproof.passes.interpret.core.call_stack import Frame, Hot, Passes
from gproof.passes.interpret.core.flow_part import FlowPart
from gproof.passes.interpret.core.hot_blocks import PENDING_LINES
from gproof.passes.interpret.core.loop_widening import AWAY_PASSES, FIRST_LOOK, SPARSE, call_blocks
from gproof.passes.interpret.core.pass_compiler import Source, compile_passes

if TYPE_CHECKING:
    from gproof.passes.interpret.core.control_flow import ControlFlow

_FEW = 8
"""So many passes at once are worth the call."""
_RETRIES = 24
"""Passes that a function takes back before it is given up, where it does little between them."""


class HotPasses(FlowPart):
    """What is run many passes at once; each method is called where a pass starts."""

    def __init__(self, flow: ControlFlow) -> None:
        super().__init__(flow)
        self._hots: dict[object, Hot] = {}

    def hot_loop(self, frame: Frame, node: While | Repeat) -> None:
        """Passes of a loop that asks."""
        place = id(node), "loop"
        free = self._free(place)
        if free < _FEW:
            return
        hot = self._hots.get((place, self.run.call))
        if hot is None:
            hot = self._compiled(
                place, node.body, 0, len(node.body), node.condition, until=isinstance(node, Repeat), cost=1
            )
        done = self._run_hot(hot, free, frame)
        self._go_over(place, done)

    def hot_jump(self, frame: Frame, node: Jump, at: int) -> None:
        """Passes of statements at whose end a jump leads back."""
        place = id(node), "jump"
        free = self._free(place)
        if free < _FEW or self._ends_contours():
            return
        hot = self._hots.get((place, self.run.call))
        if hot is None:
            body = frame.body
            end = next((n for n in range(at, len(body)) if _leads_back(body[n], node)), -1)
            if end < 0:
                hot = self._hots[place, self.run.call] = Hot(_nothing)
            else:
                last = body[end]
                condition = last.condition if isinstance(last, If) else None
                hot = self._compiled(place, body, at, end, condition, cost=2 if isinstance(last, If) else 1)
        done = self._run_hot(hot, free, frame)
        self._go_over(place, done)

    def hot_for(self, frame: Frame, node: For) -> None:
        """Passes of a counted loop."""
        place = id(node), "for"
        least, most = self.flow.widening.ends_of(frame, node)
        step = -1.0 if node.down else 1.0
        left = most - frame.counter * step
        if frame.is_open or least != most or left < _FEW or self.flow.widening.leaps.get(id(node)) is not None:
            return
        free = self._free_of_counted(place, left)
        if free < _FEW:
            return
        hot = self._hots.get((place, self.run.call))
        if hot is None:
            hot = self._compiled(place, node.body, 0, len(node.body), None, counts=(node.variable, step), cost=1)
        done = self._run_hot(hot, free, frame)
        frame.counter += step * done
        if left >= FIRST_LOOK and place in self.flow.widening.counted:
            self.flow.widening.counted[place].count += done

    def hot_call(self, frame: Frame, node: Subprogram) -> None:
        """Cycles of a call that has several."""
        place = id(node), "call"
        if frame.again < _FEW or self._ends_contours():
            return
        free = self._free_of_counted(place, float(frame.again))
        if free < _FEW:
            return
        hot = self._hots.get((place, self.run.call))
        if hot is None:
            end = next((n for n, one in enumerate(node.body) if isinstance(one, Return)), -1)
            if end < 0 or frame.body is not node.body:
                hot = self._hots[place, self.run.call] = Hot(_nothing)
            else:
                hot = self._compiled(place, node.body, 0, end, None, cost=1)
        looked = frame.again >= FIRST_LOOK
        done = self._run_hot(hot, free, frame)
        frame.again -= done
        if looked and place in self.flow.widening.counted:
            self.flow.widening.counted[place].count += done

    # ---- how many passes nobody looks at

    def _free(self, place: object) -> int:
        """Passes of a loop at whose ends nobody looks."""
        lap, passes = self.flow.widening.laps.get(place), self.flow.widening.pass_counts.get(place, 0)
        if lap is None or lap.count < SPARSE:
            return 0
        free = min(SPARSE - 1 - lap.count % SPARSE, AWAY_PASSES - 1 - passes % AWAY_PASSES)
        if self.run.branches > 2 * FIRST_LOOK:
            free = min(free, FIRST_LOOK - 1 - passes % FIRST_LOOK)
        return free

    def _free_of_counted(self, place: object, left: float) -> int:
        """The same of a loop that has so many passes more; where it has few, nobody looks at any."""
        if left < FIRST_LOOK:
            return int(left)
        lap = self.flow.widening.counted.get(place)
        if lap is None or lap.count < SPARSE:
            return 0
        return int(min(left - FIRST_LOOK, SPARSE - 1 - lap.count % SPARSE))

    def _go_over(self, place: object, done: int) -> None:
        self.flow.widening.laps[place].count += done
        self.flow.widening.pass_counts[place] += done

    # ---- running

    def _ends_contours(self) -> bool:
        """Whether jumps and returns end a contour, and have that to tell (``_not_spooled``)."""
        return self.run.dialect.looks_at_jumps(self.run)

    def _compiled(
        self, place: object, body: Sequence[Statement], begin: int, end: int, condition: Expr | None, *,
        cost: int, until: bool = False, counts: tuple[Variable, float] | None = None,
    ) -> Hot:  # fmt: skip
        blocks, is_whole = self.flow.hot_blocks, self.run.dialect.is_whole
        source = Source(
            rules=self.run.program.rules, known=blocks.known_block, line=blocks.hot_line, table=blocks.hot_table,
            is_whole=is_whole, called=self._hot_sub,
        )  # fmt: skip
        part = body[begin:end]
        if not self.run.dialect.hot_blocks or not self._is_one_file(part):
            hot = Hot(_nothing)
        else:

            def make() -> Passes | None:
                return compile_passes(part, source, condition=condition, until=until, counts=counts)

            hot = Hot(make, make(), end, cost)
        self._hots[place, self.run.call] = hot
        return hot

    def _hot_sub(self, node: Call, inside: tuple[str, ...]) -> tuple[Sequence[Statement], int, int, int] | None:
        """A call that runs its subprogram once and gives it nothing: see ``pass_code.Source``."""
        sub, modules = self.run.program.subprograms.get(node.name), self.run.dialect.modules
        chain = [*self.flow.called, *inside, node.name]
        if sub is None or node.deleted or node.arguments or node.count is not None or sub.parameters:
            return None
        if node.name in chain[:-1] or len(chain) > self.run.dialect.nesting(self.run.machine) or self._ends_contours():
            return None
        text = f"{' > '.join(chain)} (from line {node.span.line})"
        number = self.flow.call_texts.get(text)
        if number is None or any(isinstance(one, Declare) for one in sub.body):
            return None  # it was not executed here yet, or has variables of its own
        body, cost = sub.body, 1
        if body and isinstance(body[-1], Return):
            body, cost = body[:-1], 2
        elif modules:
            return None  # it has no end, which the executor tells
        if modules and sub.span.file != self.run.trace.files[self.run.file]:
            return None  # what is reported of its moves is reported of the file that runs
        return body, number, cost, call_blocks(len(chain) - 1)

    def _is_one_file(self, body: Sequence[Statement]) -> bool:
        """Whether lines of a pass are in the file that runs."""
        name = self.run.trace.files[self.run.file]
        return all(node.span.file == name for node in body if isinstance(node, Block))

    def _run_hot(self, hot: Hot, free: int, frame: Frame) -> int:
        """Passes from the start of one on; returns how many ends were gone over."""
        passes = hot.passes
        if passes is None or not all(map(self.flow.hot_blocks.in_mode, passes.modes)):
            return 0
        room = self.run.alarm - 1 - self.run.blocks - passes.most
        free = min(free, room // (passes.most + hot.cost))
        if free < 1:
            return 0
        pending, parts = self.flow.hot_blocks.pending, len(self.flow.hot_blocks.pending.parts)
        try:
            done, blocks, charged, at_end = passes.run(self.run.modal.parameters, free, pending.value, pending.parts)
        except FALLS_BACK:
            # Before anything was done: a variable without a number.
            self.flow.hot_blocks.settle(passes.reads)
            return 0
        pending.lines += sum(len(part.lines) for part in pending.parts[parts:])
        self.run.blocks += blocks + done * hot.cost
        self.run.charged += charged
        hot.done += done
        if at_end:
            frame.at = hot.at
        else:
            hot.back += 1
            if hot.back in (1, 3, 8):
                # Blocks that were not executed then may have been by now.
                hot.passes = hot.make()
            elif hot.back > _RETRIES and hot.done < 4 * hot.back:
                hot.passes = None
        if pending.lines >= PENDING_LINES:
            self.flow.hot_blocks.run_pending()
        return done


def _nothing() -> None:
    return None


def _leads_back(node: Statement, jump: Jump) -> bool:
    """Whether a statement is a jump, or asks whether to jump and does nothing more."""
    return node is jump or (isinstance(node, If) and not node.otherwise and node.head is None and node.then == (jump,))
