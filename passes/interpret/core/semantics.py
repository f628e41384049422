"""What a language decides of a run: one ``Dialect`` object per run, made by the registry of languages.

The class here is that of a plain RS274NGC: many commands a line, no state of its own. A language has a class of its own
in its room (``passes/interpret/<language>/semantics.py``), which says where it differs.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from gproof.ir import codes
from gproof.ir.end_state import EndState
from gproof.ir.finding import Refusal, Span
from gproof.ir.kernel import Kernel
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.program import Array, Block, Call, Device, Expr, Input, Message, Named, Number, Program, Unsupported
from gproof.ir.setup import Setup
from gproof.ir.symbolic import Position, Unknown, Value
from gproof.ir.trace import Op
from gproof.passes.interpret.core import line_kernels as k
from gproof.passes.interpret.core import moves
from gproof.passes.interpret.core.dead_variables import Idle, idle_variables
from gproof.passes.interpret.core.line_decoder_kernels import SLOTS, WordColumns
from gproof.passes.interpret.core.line_filter_kernels import cold_lines
from gproof.passes.interpret.core.modal_state import Modal
from gproof.passes.interpret.core.notes_of_sections import common_modes, end_state
from gproof.passes.interpret.core.parsed_line import gather
from gproof.passes.interpret.core.run import Run

if TYPE_CHECKING:
    from gproof.passes.interpret.core.call_stack import Frame, Kept, PlainCell

R_contra = TypeVar("R_contra", bound=Run, contravariant=True)
Word = tuple[str, Value, Span]
"""Letter, value and place of a word."""


def cold_words(columns: WordColumns, count: int, hot: list[int], *, pairs: bool = False) -> tuple[Any, Any]:
    """(line numbers, first words) of the lines that a kernel certainly hands back; see ``cold_lines``.

    columns: ``count`` words, as lists for plain Python; hot: see there.
    """
    lines, firsts = np.empty(count, np.int64), np.empty(count, np.int64)
    if isinstance(columns.line, list):
        found = cold_lines(columns, count, hot, [0.0] * SLOTS, int(pairs), lines, firsts)
    else:
        slots = np.array(hot, np.int64)
        found = cold_lines.pick(count)(columns, count, slots, np.zeros(SLOTS), int(pairs), lines, firsts)
    return lines[:found].tolist(), firsts[:found].tolist()


def settings_of(run: Run, node: Block) -> list[tuple[Value, Value, Span]]:
    """What the assignments of a line give: variable, value, place.

    Where one is refused, none takes place: what was to be written is not known then, and not what it was before.
    """
    try:
        return [run.setting(one) for one in node.assigns]
    except Refusal:
        for one in node.assigns:
            if isinstance(one.target.number, Number):
                number = round(one.target.number.value)
                lost = Unknown(f"{one.target.name or f'#{number}'} (its line is refused)")
                with contextlib.suppress(Refusal):
                    run.modal.write(number, lost, one.target.span)
        raise


class Dialect(Generic[R_contra]):
    """Lines of many commands, in no order but that of the text.

    kernel: runs the lines of a table. hot_blocks: lines that come again may be compiled and run together. fits: (number
    of a variable, value) -> whether the variable can hold it, None where each can hold all; keeps_motion: a line
    without a code goes on with the code before it in time, not in the text. has_own_feeds: feeds are kept next to the
    one of all; stored_places: letters that send axes to places which are stored; modules: subprograms end with a code
    of their own, and what is reported of them is reported of the file that runs.
    """

    kernel: Kernel[Any, Any] = k.run_lines
    hot_blocks: bool = True
    fits: Callable[[int, object], bool] | None = None
    keeps_motion: bool = True
    has_own_feeds: bool = False
    stored_places: frozenset[str] = frozenset()
    modules: bool = False
    run_type: type[Run] = Run

    def __init__(self, program: Program) -> None:
        self.program = program

    # ---- the start

    def first_state(self, program: Program, setup: Setup, machine: Machine) -> Modal:
        """The state in which a job starts."""
        return Modal(program.rules, setup, machine)

    def begin(self, run: R_contra) -> None:
        """Before anything runs: findings of what setup and machine state that the language does not have."""

    def nesting(self, machine: Machine) -> int:
        """How deep calls may be within calls."""
        return self.program.rules.call_depth

    def letters(self, machine: Machine) -> dict[str, int]:
        """Column of each letter that moves an axis."""
        return {name.upper(): axis for axis, name in enumerate(AXIS_NAMES)}

    # ---- lines

    def block(self, run: R_contra, node: Block, words: list[Word]) -> None:
        """Execute a line; words: of the node, evaluated."""
        raise NotImplementedError

    def judge_line(self, machine: Machine, span: Span, words: Sequence[Word], bare: frozenset[str]) -> None:
        """Refusal for a line that means nothing by itself, whatever runs before it; machine: whose axes it moves."""
        gather(self.program.rules, span, list(words))

    def line(self, run: R_contra, span: Span, words: list[Word], bare: frozenset[str]) -> None:
        """Execute a line of a table; bare: letters without a number."""
        raise NotImplementedError

    def rest_of_line(self, run: R_contra, span: Span, words: list[Word]) -> None:
        """Execute what is left of a line whose call is over."""
        raise NotImplementedError

    def cold(self, run: R_contra, frame: Frame, columns: WordColumns, count: int) -> set[int]:
        """Lines of a piece of a table with a word that the kernel certainly leaves to Python: not worth a call.

        columns: line, letter, value and flags of its ``count`` words.
        """
        return set()

    def hot(self, run: R_contra, kernel: Any, columns: WordColumns, count: int, at: int, compiled: bool) -> int:
        """Run lines in the kernel from word ``at``; returns the first word it left over.

        columns: line, letter, value and flags of the words.
        """
        return at

    def motion_of(self, letters: Sequence[str], values: Sequence[Expr], continued: str) -> tuple[str | None, bool]:
        """The code with which a line of a loop is to move, and whether it must be added to its words.

        None: the line is not for the kernel. continued: see ``ir.program.Block``.
        """
        return "", False

    def stops(self, run: R_contra, columns: WordColumns, count: int) -> list[int]:
        """First words of lines of a loop that the kernel must not run."""
        return []

    def hot_lines(
        self, run: R_contra, kernel: Any, columns: WordColumns, count: int, at: int, compiled: bool,
        stops: list[int], motion: str, numbers: Any,
    ) -> int:  # fmt: skip
        """As ``hot``, for lines of a loop, the first of which moves with ``motion``.

        numbers: where the lines are in the source, by the numbers that they have in ``columns``.
        """
        return at

    def again(self, run: R_contra, span: Span, words: list[Word], motion: str, distances: str) -> None:
        """Execute a line of a loop that the kernel left over."""
        self.line(run, span, words, frozenset())

    def cells(self, run: R_contra, cell: PlainCell, places: Any, line: int) -> int:
        """Run cells of an array, each of them ``cell``; returns how many. places, line: see ``run_cells``."""
        return 0

    def move(
        self, run: R_contra, op: Op, target: list[Position], span: Span, *, center: list[float] | None,
        turns: int, plane: int, length: float | None, programmed: tuple[float, float] | None,
    ) -> None:  # fmt: skip
        """A move of the job: see ``moves.go``."""
        moves.go(run, op, target, span, center=center, turns=turns, plane=plane, length=length, programmed=programmed)

    # ---- lines after a refused one (lost_lines.py)

    def motion_of_frame(self, run: R_contra, frame: Frame) -> int:
        """The motion with which the next line of a table goes on, as a function's number; 0 for none."""
        return run.modal.motion

    def takes_lost_feed(self, run: R_contra, open_feeds: bool) -> bool:
        """Whether an F is taken by a line whose path is lost; open_feeds: what F is measured in is lost too."""
        return False

    def take_lost_feed(self, run: R_contra, feed: float, last: float) -> None:
        """Lines whose ways are lost have had F. feed: what the kernel made of the last one; last: its number."""

    # ---- statements

    def call(self, run: R_contra, node: Call) -> None:
        """Run a subprogram with the words of its call."""
        run.flow.call_subprogram(node.name, node.span)

    def named(self, run: R_contra, node: Named) -> Value:
        """What the controller holds under a name; Refusal GP113 where it knows no names."""
        raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=node.name))

    def input(self, run: R_contra, node: Input) -> Value:
        """An input of the controller; Refusal GP113 where a program reads none."""
        if node.kind == "outside":
            return Unknown("the value from another device")
        raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=node.kind))

    def unsupported(self, run: R_contra, node: Unsupported) -> None:
        """What a statement that is not modelled leaves unknown, before it is refused: all places and variables."""
        run.modal.lose_all(node.what.rstrip(","))

    def device(self, run: R_contra, node: Device) -> None:
        """A command to the controller that is no line of words; Refusal GP113 for one that is not modelled."""
        raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=node.name))

    def dialog(self, run: R_contra, node: Message) -> None:
        """A question to the operator whose answer goes into variables; Refusal GP113 where there is none."""
        raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=node.kind))

    def array(self, run: R_contra, node: Array) -> None:
        """Enter statements that run once for each place of an array; Refusal GP113 where there are none."""
        raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code="an array"))

    def next_cell(self, run: R_contra, frame: Frame) -> bool:
        """After a cell of an array: to the next one, True; after the last one False."""
        return False

    def back_from_file(self, run: R_contra, kept: Kept | None) -> None:
        """A subprogram that is a file is over: what of the state is its caller's again."""

    # ---- the order of statements

    def at_jump(self, run: R_contra, span: Span, code: str) -> None:
        """A jump, call, return or label, before it is followed."""

    def looks_at_jumps(self, run: R_contra) -> bool:
        """Whether ``at_jump`` may have something to say in this run."""
        return False

    def end_state(self, run: R_contra) -> EndState:
        """What the program leaves for the job after it, where it ends now."""
        return end_state(run, common_modes(run.modal, self.program.rules.name))

    def is_unended(self, run: R_contra, frame: Frame) -> bool:
        """Whether statements are over without the code that has to end them (GP515)."""
        return False

    # ---- variables

    def is_whole(self, number: int) -> bool:
        """Whether a variable holds whole numbers of 32 bits."""
        return False

    def of_its_type(self, number: int, value: Value) -> Value:
        """What is known of a variable by its type besides."""
        return value

    def idle_variables(self) -> Idle:
        """Variables of the program that have no part in what it does."""
        return idle_variables(self.program, self.is_whole, self.by_number, self.always_read)

    def by_number(self, number: int) -> tuple[int, ...]:
        """Variables that a code may take by this number."""
        return (number,)

    @property
    def always_read(self) -> Iterable[int]:
        """Numbers of the variables that codes read themselves."""
        return ()
