"""Lines of RS274NGC as Eding CNC runs them: many commands a line, in the order of a table (manual 3.7)."""

from __future__ import annotations

from typing import Any

from gproof.ir.end_state import EndState
from gproof.ir.finding import Span
from gproof.ir.program import Block, Device, Message
from gproof.passes.interpret.core.call_stack import Frame
from gproof.passes.interpret.core.line_decoder_kernels import WordColumns, letter_slots
from gproof.passes.interpret.core.notes_of_sections import common_modes, end_state
from gproof.passes.interpret.core.run import Run
from gproof.passes.interpret.core.semantics import Dialect, Word, cold_words, settings_of
from gproof.passes.interpret.eding.commands import run_command
from gproof.passes.interpret.eding.fast_path import run_hot
from gproof.passes.interpret.eding.line_order import execute_line, execute_own
from gproof.passes.interpret.eding.written_variables import write_setting

_HOT = letter_slots({letter: axis for axis, letter in enumerate("XYZABC")}, "IJKRFG")
"""Letters that ``run_lines`` takes."""


class EdingDialect(Dialect[Run]):
    """Lines of many commands, in the order of table 3-7."""

    def end_state(self, run: Run) -> EndState:
        """M30 selects G17, G90, G94, M48, ends compensation and leaves coordinate systems; M2 ends nothing (3.5.1)."""
        modes = dict(common_modes(run.modal, "eding"))
        modes["eding: retract"] = "G98" if run.modal.retract_initial else "G99"
        modes["eding: compensation"] = "off" if run.modal.compensation is None else "on"
        if run.ended_by is not None and run.ended_by[0] == "M30":
            modes |= {
                "eding: plane": "XY", "eding: distances": "absolute", "eding: feed mode": "94",
                "eding: overrides": "on", "eding: compensation": "off",
            }  # fmt: skip
        return end_state(run, tuple(modes.items()))

    def block(self, run: Run, node: Block, words: list[Word]) -> None:
        """Execute a line."""
        settings = settings_of(run, node)
        # Settings take effect once every value of the line is found, before anything moves (3.2.3).
        for number, value, span in settings:
            write_setting(run, number, value, span)
        if words:
            execute_line(run, node.span, words)

    def line(self, run: Run, span: Span, words: list[Word], bare: frozenset[str]) -> None:
        """Execute a line of a table."""
        execute_line(run, span, words)

    def rest_of_line(self, run: Run, span: Span, words: list[Word]) -> None:
        """Execute what a line has after a code that a subprogram replaces."""
        execute_own(run, span, words)

    def cold(self, run: Run, frame: Frame, columns: WordColumns, count: int) -> set[int]:
        """Lines with a word that the kernel certainly leaves to Python."""
        return set(cold_words(columns, count, _HOT)[0])

    def hot(self, run: Run, kernel: Any, columns: WordColumns, count: int, at: int, compiled: bool) -> int:
        """Run lines in the kernel from word ``at``; returns the first word it left over."""
        return run_hot(run, kernel, columns, count, at, compiled)

    def hot_lines(
        self, run: Run, kernel: Any, columns: WordColumns, count: int, at: int, compiled: bool, stops: list[int],
        motion: str, numbers: Any,
    ) -> int:  # fmt: skip
        """As ``hot``, for lines of a loop."""
        before = run.rows.count
        at = run_hot(run, kernel, columns, count, at, compiled, distances=True)
        made = run.rows.arrays["line"][before : run.rows.count]
        made[:] = numbers[made]
        return at

    def takes_lost_feed(self, run: Run, open_feeds: bool) -> bool:
        """Whether an F is taken: in the unit of feeds, where there was one before."""
        return run.modal.feed_unit == run.modal.unit and run.modal.feed != 0.0

    def take_lost_feed(self, run: Run, feed: float, last: float) -> None:
        """The last of some F is the one in force."""
        run.modal.feed = feed

    def device(self, run: Run, node: Device) -> None:
        """Homing, logs, the look-ahead angle (4.2)."""
        run_command(run, node)

    def dialog(self, run: Run, node: Message) -> None:
        """A dialog (4.2)."""
        from gproof.passes.interpret.eding.dialogs import run_dialog

        run_dialog(run, node)
