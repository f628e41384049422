"""Numbers of a job's variables in a LinuxCNC program.

There, #1 to #30 belong to each call of a subprogram, and #31 to #5000 to the program (G-Code Overview, Parameters).
A job's variables are all of one kind, so those of low numbers get free ones; where a number is computed, all numbers
are moved by the same amount.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from gproof.backend.emit.printer import Unprintable
from gproof.ir.job import Node
from gproof.ir.job_features import expressions, parts_of_expression
from gproof.ir.program import Number, Variable
from gproof.ir.target import Target

SHIFT = 1000
"""What is added to all numbers where some are computed: the highest that Eding CNC lets programs use is 3999."""
FIRST_NEW = 101
"""The first number that a variable of a low number gets."""


class VariableNames:
    """shift: what is added to every number, 0: low ones have numbers of their own."""

    def __init__(self, nodes: Iterable[Node], target: Target) -> None:
        self.low, self.high = target.variables
        used, computed = set[int](), False
        for variable in _variables(nodes):
            if isinstance(variable.number, Number):
                used.add(round(variable.number.value))
            else:
                computed = True
        self.shift = SHIFT if computed else 0
        self.names: dict[int, int] = {}
        free = (n for n in range(FIRST_NEW, self.high + 1) if n not in used)
        if not computed:
            for number in sorted(used):
                self.names[number] = number if number >= self.low else next(free)

    def __call__(self, number: int) -> int:
        """The number in the text; Unprintable where there is none. 0: by how much computed numbers are moved."""
        if number == 0:
            return self.shift
        found = number + self.shift if self.shift else self.names.get(number, number)
        if not self.low <= found <= self.high:
            raise Unprintable(f"variable #{number}")
        return found

    def spare(self) -> int:
        """A number that the job does not use."""
        used = set(self.names.values())
        return next(n for n in range(self.high, self.low, -1) if n not in used)


def _variables(nodes: Iterable[Node]) -> Iterator[Variable]:
    for node in nodes:
        for expr in expressions(node):
            yield from (part for part in parts_of_expression(expr) if isinstance(part, Variable))
