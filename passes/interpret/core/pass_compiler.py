"""Passes of a loop as one Python function: what ``hot_blocks.py`` does block by block, with nothing in between.

``compile_passes`` takes the statements of a pass and the condition of the next one, and makes a function that runs
passes until one of them needs the evaluator: that pass it takes back, so that the executor starts it again. Moves
become values of ``frames.Stretch``es, in the order of the words; the executor turns them into rows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from gproof.ir.program import (
    Block,
    BlockTable,
    Call,
    Declare,
    DeferredBlock,
    Expr,
    If,
    Label,
    Mode,
    Statement,
    Variable,
)
from gproof.ir.record import record
from gproof.ir.rules import LanguageRules
from gproof.passes.interpret.core.block_compiler import FALLS_BACK, LARGE, NAMES, Code, FastBlock, Slow, loading
from gproof.passes.interpret.core.call_stack import HotLine, Passes, Stretch
from gproof.passes.interpret.core.expressions import LEAST_WHOLE, MOST_WHOLE
from gproof.passes.interpret.core.hot_blocks import MOST_BLOCKS

_DEEPEST = 20

Known = FastBlock | None


@record(frozen=True, slots=True, kw_only=True)
class Source:
    """What the executor knows of a program.

    known: the compiled form of a block, None where it has none or was never executed; line: a block as a line of
    motion, None where it is none; table: the lines of a table with their values, None where they are not all plain;
    is_whole: whether a variable holds whole numbers of 32 bits; called: (call, names of the calls around it within the
    pass) -> the statements that run for it, its index in ``Trace.calls``, how many blocks calling and returning are,
    and as how many more it counts; None where the executor has to do it.
    """

    rules: LanguageRules
    known: Callable[[Block], Known]
    line: Callable[[Block], HotLine | None]
    table: Callable[[BlockTable], Sequence[tuple[HotLine, list[float]]] | None]
    is_whole: Callable[[int], bool]
    called: Callable[[Call, tuple[str, ...]], tuple[Sequence[Statement], int, int, int] | None]


def compile_passes(
    body: Sequence[Statement], source: Source, *, condition: Expr | None, until: bool = False,
    counts: tuple[Variable, float] | None = None,
) -> Passes | None:  # fmt: skip
    """A function for the passes of a loop; None when something in it needs the executor in every pass.

    condition: of another pass, None: always; until: it is the condition of no other one; counts: variable of a counted
    loop and its step.
    """
    code = _PassCode(source)
    try:
        most = code.body(body, 2)
        code.flush(2)
        test = "" if condition is None else code.expr(condition)
        step = ""
        if counts is not None:
            number = code.number(counts[0])
            if number in code.written:
                return None  # an error, which the executor tells
            name = code.name(number)
            step = f"{name} = {name} + {counts[1]!r}"
            code.written[number] = name
    except Slow:
        return None
    if not 0 < most <= MOST_BLOCKS:
        return None
    return Passes(code.function_of(test, step, until=until), most, frozenset(code.modes), tuple(code.reads))


class _PassCode(Code):
    """Source of a pass; ``written``: the names of variables that it changes."""

    def __init__(self, source: Source) -> None:
        super().__init__(source.rules)
        self.source = source
        self.lines: list[str] = []
        self.written: dict[int, str] = {}
        self.modes: set[str] = set()
        self.scope: dict[str, Any] = {}
        self._made = 0
        self._values: list[str] = []
        self._stretch: list[HotLine] = []
        self._blocks = self._charged = 0
        self._call = -1
        self._inside: tuple[str, ...] = ()

    def name(self, number: int) -> str:
        return self.reads.setdefault(number, f"v{len(self.reads)}")

    def emit(self, depth: int, text: str) -> None:
        self.lines.append("    " * depth + text)

    def body(self, body: Sequence[Statement], depth: int) -> int:
        """Its source; returns the greatest number of blocks."""
        most = 0
        for node in body:
            if isinstance(node, Label | Mode | Declare):
                continue
            if isinstance(node, If):
                most += self.branch(node, depth)
            elif isinstance(node, BlockTable):
                most += self.table(node, depth)
            elif isinstance(node, Block):
                self.block(node, depth)
                most += 1
            elif isinstance(node, Call):
                most += self.call(node, depth)
            else:
                raise Slow
        return most

    def call(self, node: Call, depth: int) -> int:
        """A subprogram, as if its statements were here."""
        found = self.source.called(node, self._inside)
        if found is None:
            raise Slow
        body, index, cost, charge = found
        outer = self._call, self._inside
        self._call, self._inside = index, (*self._inside, node.name)
        self._blocks += cost + charge
        self._charged += charge
        most = cost + charge + self.body(body, depth)
        self._call, self._inside = outer
        return most

    def placed(self, line: HotLine) -> HotLine:
        """A line as one of the call that it is in."""
        return line if self._call < 0 else replace(line, call=self._call)

    def branch(self, node: If, depth: int) -> int:
        if node.head is not None or depth > _DEEPEST:
            raise Slow
        test = self.expr(node.condition)
        self._blocks += 1
        self.flush(depth)
        self.emit(depth, f"if checked({test}):")
        most = []
        for part in (node.then, node.otherwise):
            begin = len(self.lines)
            try:
                count = self.body(part, depth + 1)
                self.flush(depth + 1)
            except Slow:
                # A pass that comes here is the executor's.
                del self.lines[begin:]
                self._values, self._stretch, self._blocks, self._charged, count = [], [], 0, 0, 0
                self.emit(depth + 1, "raise Slow")
            most.append(count)
            if len(self.lines) == begin:
                self.emit(depth + 1, "pass")
            if part is node.then:
                self.emit(depth, "else:")
        return 1 + max(most)

    def table(self, node: BlockTable, depth: int) -> int:
        lines = self.source.table(node)
        if lines is None:
            raise Slow
        if node.distances:
            self.modes.add(node.distances)
        counted = 0
        for line, values in lines:
            self._stretch.append(self.placed(line))
            self._values.extend(f"({value!r})" for value in values)
            # The kernel counts rows: a feed alone makes none.
            counted += set(line.letters) != {"F"}
        self._blocks += counted
        return counted

    def block(self, node: Block, depth: int) -> None:
        if self.source.known(node) is None:
            raise Slow
        node = node.made() if isinstance(node, DeferredBlock) else node
        targets = [self.number(a.target) for a in node.assigns]
        line = self.source.line(node) if node.words else None
        if node.words and line is None:
            raise Slow
        found = [self.expr(w.value) for w in node.words]
        made = [self.expr(a.value) for a in node.assigns]
        self._blocks += 1
        if line is not None:
            if node.distances:
                self.modes.add(node.distances)
            self._stretch.append(self.placed(line))
            if line.added:
                self._values.append(f"({float(line.motion[1:])!r})")
            self._values.extend(self.temporary(text, depth) for text in found)
        temporaries = [self.temporary(text, depth) for text in made]
        for number, value in zip(targets, temporaries, strict=True):
            if self.source.is_whole(number):
                self.emit(depth, f"if not {LEAST_WHOLE!r} <= {value} <= {MOST_WHOLE!r} or {value} % 1.0: raise Slow")
            name = self.name(number)
            self.emit(depth, f"{name} = {value}")
            self.written[number] = name

    def temporary(self, text: str, depth: int) -> str:
        """A name that holds a value for as long as the pass runs, checked like those of a block."""
        name = f"t{self._made}"
        self._made += 1
        self.emit(depth, f"{name} = {text}")
        self.emit(depth, f"if not {-LARGE!r} < {name} < {LARGE!r}: raise Slow")
        return name

    def flush(self, depth: int) -> None:
        """What the lines so far leave for the executor."""
        if self._blocks:
            self.emit(depth, f"blocks += {self._blocks}")
        if self._charged:
            self.emit(depth, f"charged += {self._charged}")
        if self._stretch:
            name = f"s{len(self.scope)}"
            self.scope[name] = Stretch(self._stretch)
            self.emit(depth, f"values += ({', '.join(self._values)},)")
            self.emit(depth, f"stretches.append({name})")
        self._values, self._stretch, self._blocks, self._charged = [], [], 0, 0

    def function_of(
        self, test: str, step: str, *, until: bool
    ) -> Callable[[dict[int, Any], int, list[float], list[Stretch]], tuple[int, int, int, bool]]:
        loads = [text for number, name in self.reads.items() for text in loading(name, number)]
        names = list(self.written.values())
        old = [f"o{n}" for n in range(len(names))]
        keep = [f"{', '.join(old)}, = {', '.join(names)}," if names else "pass"]
        back = [f"{', '.join(names)}, = {', '.join(old)}," if names else "pass"]
        tests = []
        if test:
            holds = f"if checked({test}): break" if until else f"if not checked({test}): break"
            tests = ["try:", f"    {holds}", "except FALLS_BACK:", "    break"]
        text = "\n".join((
            "def run(p, most, values, stretches):",
            *(f"    {one}" for one in loads),
            "    done = blocks = charged = 0",
            "    at_end = True",
            "    while True:",
            *(f"        {one}" for one in keep),
            "        had = len(values), len(stretches), blocks, charged",
            "        try:",
            *("    " + one for one in self.lines),
            "            pass",
            "        except FALLS_BACK:",
            *(f"            {one}" for one in back),
            "            del values[had[0]:]",
            "            del stretches[had[1]:]",
            "            blocks, charged = had[2:]",
            "            at_end = False",
            "            break",
            "        if done >= most: break",
            *(f"        {one}" for one in tests),
            *([f"        {step}"] if step else []),
            "        done += 1",
            *(f"    p[{number}] = {name}" for number, name in self.written.items()),
            "    return done, blocks, charged, at_end",
        ))  # fmt: skip
        scope = {**NAMES, **self.scope, "FALLS_BACK": FALLS_BACK}
        exec(text, scope)  # made of numbers and names of this module alone
        made: Callable[[dict[int, Any], int, list[float], list[Stretch]], tuple[int, int, int, bool]] = scope["run"]
        return made
