"""Blocks and conditions of loops as Python functions: the same values as ``expressions.py``, without its trees.

``compile_block`` and ``compile_condition`` make a function of a node whose values rest on literals and on freely usable
variables alone. The function takes the dict of variables and raises ``Slow`` wherever the evaluator would do anything
but compute: a variable that is not set or not known, a value that does not exist or is very large, a warning. The
executor then takes the evaluator's way, so that there is one place where findings are made.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from gproof.ir.program import Binary, Block, Constant, DeferredBlock, Expr, Number, Unary, Variable
from gproof.ir.record import record
from gproof.ir.rules import LanguageRules
from gproof.passes.interpret.core.expressions import (
    BINARY_FUNCTIONS,
    LEAST_WHOLE,
    MOST_WHOLE,
    UNARY_FUNCTIONS,
    open_mod,
    open_rem,
)

HOT_LETTERS = frozenset("GFXYZABCIJKRP")
"""Words of lines that ``line_kernels.run_lines`` may take; P is that of G4."""

LARGE = 1e150
"""Beyond this the evaluator decides: products and sums of anything smaller are finite or raise here."""

_KINDS = ("free", "persistent")


class Slow(Exception):
    """Not for this way: the evaluator decides."""


@record(frozen=True, slots=True)
class FastBlock:
    """run: variables -> values of the words, then of the settings; letters of the words; numbers that are set; reads:
    numbers of the variables; is_motion: only words that ``run_lines`` may take; node: the block."""

    run: Callable[[dict[int, Any]], tuple[float, ...]]
    letters: tuple[str, ...]
    targets: tuple[int, ...]
    reads: tuple[int, ...]
    is_motion: bool
    node: Block


def compile_block(node: Block, rules: LanguageRules) -> FastBlock | None:
    """A function for a block; None when something in it needs the evaluator every time."""
    node = node.made() if isinstance(node, DeferredBlock) else node
    code = Code(rules)
    try:
        targets = tuple(code.number(a.target) for a in node.assigns)
        values = [code.expr(w.value) for w in node.words] + [code.expr(a.value) for a in node.assigns]
    except Slow:
        return None
    letters = tuple(w.letter for w in node.words)
    is_motion = HOT_LETTERS.issuperset(letters)
    run = code.function(f"({', '.join(values)},)", many=True)
    return FastBlock(run, letters, targets, tuple(code.reads), is_motion, node)


Condition = tuple[Callable[[dict[int, Any]], float], list[int]]
"""Function from the variables to the value; numbers of the variables."""


def compile_condition(condition: Expr, rules: LanguageRules) -> Condition | None:
    """A function for a condition; None when something in it needs the evaluator every time."""
    code = Code(rules)
    try:
        value = code.expr(condition)
    except Slow:
        return None
    return code.function(value, many=False), list(code.reads)


def _checked(value: float) -> float:
    if not -LARGE < value < LARGE:
        raise Slow
    return value


def _whole(value: float) -> float:
    if not LEAST_WHOLE <= value <= MOST_WHOLE:
        raise Slow
    return value


def _all_checked(values: tuple[float, ...]) -> tuple[float, ...]:
    for value in values:
        if not -LARGE < value < LARGE:
            raise Slow
    return values


def _compare(operator: str) -> Callable[[float, float], float]:
    compute = BINARY_FUNCTIONS[operator]

    def compared(x: float, y: float) -> float:
        # Comparing computed numbers exactly is worth a warning, which is the evaluator's.
        if x != math.floor(x) or y != math.floor(y):
            raise Slow
        return compute(x, y)

    return compared


def _guarded(compute: Callable[..., float]) -> Callable[..., float]:
    def guarded(*values: float) -> float:
        result = compute(*values)
        if not -LARGE < result < LARGE:
            raise Slow
        return result

    return guarded


def _sure_mod(x: float, y: float) -> float:
    if open_mod(x, y) is not None:
        raise Slow
    return BINARY_FUNCTIONS["mod"](x, y)


def _sure_rem(x: float, y: float) -> float:
    if open_rem(x, y) is not None:
        raise Slow
    return BINARY_FUNCTIONS["rem"](x, y)


_OPERATORS: dict[str, Callable[..., float]] = {
    **{op: BINARY_FUNCTIONS[op] for op in ("and", "or", "xor", ">", ">=", "<", "<=", "atan")},
    **{op: _compare(op) for op in ("==", "<>")},
    "**": _guarded(math.pow),
    "mod": _guarded(_sure_mod),
    "div": _guarded(BINARY_FUNCTIONS["div"]),
    "rem": _sure_rem,
    "*": _guarded(BINARY_FUNCTIONS["*"]),
    "/": _guarded(BINARY_FUNCTIONS["/"]),
}
_FUNCTIONS = {name: _guarded(function) for name, function in UNARY_FUNCTIONS.items()}
NAMES: dict[str, Any] = {
    "Slow": Slow, "checked": _checked, "all_checked": _all_checked, "whole": _whole,
    **{f"b{n}": f for n, f in enumerate(_OPERATORS.values())},
    **{f"u{n}": f for n, f in enumerate(_FUNCTIONS.values())},
}  # fmt: skip
_BINARY_NAMES = {op: f"b{n}" for n, op in enumerate(_OPERATORS)}
_UNARY_NAMES = {op: f"u{n}" for n, op in enumerate(_FUNCTIONS)}


def loading(name: str, number: int) -> tuple[str, str]:
    """Source that takes a variable's value into a name; Slow for what is no number, or large."""
    return f"{name} = p[{number}]", f"if not {-LARGE!r} < {name} < {LARGE!r}: raise Slow"


class Code:
    """Source of one function; ``reads`` are the variables it loads first."""

    def __init__(self, rules: LanguageRules) -> None:
        self.rules = rules
        self.reads: dict[int, str] = {}

    def number(self, variable: Variable) -> int:
        """The number of a variable that a program may use as it likes; Slow for any other."""
        if not isinstance(variable.number, Number) or variable.number.value != round(variable.number.value):
            raise Slow
        whole = round(variable.number.value)
        if any(e.first <= whole <= e.last and e.kind in _KINDS for e in self.rules.parameters):
            return whole
        raise Slow

    def expr(self, node: Expr) -> str:
        """Its source; Slow for what the evaluator must do."""
        if isinstance(node, Number | Constant):
            if not -LARGE < node.value < LARGE:
                raise Slow
            return f"({node.value!r})"
        if isinstance(node, Variable):
            return self.reads.setdefault(self.number(node), f"v{len(self.reads)}")
        if isinstance(node, Unary):
            inner = self.expr(node.operand)
            if node.operator in ("neg", "pos") and not node.whole:
                return f"(-{inner})" if node.operator == "neg" else inner
            found = f"{_UNARY_NAMES[node.operator]}({inner})"
            return f"whole({found})" if node.whole else found
        if isinstance(node, Binary) and not node.doubtful and not node.readings:
            return self._spine(node)
        raise Slow

    def _spine(self, node: Binary) -> str:
        """A chain of operators of one group is a deep left spine: walked, not recursed."""
        spine = [node]
        while isinstance(spine[-1].left, Binary):
            spine.append(spine[-1].left)
        if len(spine) > 50 or any(one.doubtful for one in spine):
            raise Slow
        source = self.expr(spine[-1].left)
        for one in reversed(spine):
            right = self.expr(one.right)
            if one.operator in ("+", "-"):
                source = f"({source} {one.operator} {right})"
            elif one.operator in _BINARY_NAMES:
                source = f"{_BINARY_NAMES[one.operator]}({source}, {right})"
            else:
                raise Slow
            if one.whole:
                source = f"whole({source})"
        return source

    def function(self, value: str, *, many: bool) -> Callable[[dict[int, Any]], Any]:
        """The function that loads the variables, checks them, and gives the value."""
        lines = ["def run(p):"]
        for number, name in self.reads.items():
            lines += [f"    {text}" for text in loading(name, number)]
        lines.append(f"    return {'all_checked' if many else 'checked'}({value})")
        scope = dict(NAMES)
        exec("\n".join(lines), scope)  # made of numbers and names of this module alone
        made: Callable[[dict[int, Any]], Any] = scope["run"]
        return made


FALLS_BACK = (Slow, KeyError, TypeError, ValueError, ZeroDivisionError, OverflowError)
"""What a function raises where the evaluator decides."""
