"""Loops that do nothing but count: so many passes at once as are certainly alike.

A body of assignments ``v := v + c`` with whole literals alone, and a condition that compares one such variable with a
number: after n passes each variable holds v + n c, exactly, as long as all numbers are whole and below 2**53. Some
passes before the condition changes, or a number leaves its type, are left to the executor, which decides and tells.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from gproof.ir.program import Binary, Block, Constant, Expr, For, Label, Mode, Number, Repeat, Unary, Variable, While
from gproof.ir.record import record
from gproof.ir.rules import LanguageRules
from gproof.ir.symbolic import Value

LARGEST = 2.0**53
"""Whole numbers up to here are exact."""
LEFT = 2
"""Passes that are not leaped over."""
_KINDS = ("free", "persistent")
_TURNED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "==": "==", "<>": "<>"}
_NOT = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "<>", "<>": "=="}


@record(frozen=True, slots=True)
class Leap:
    """A loop that counts. steps: what a pass adds to variables, by number; it goes on while variable ``counter`` is
    ``operator`` ``goal``: a number, or where ``is_variable``, the number of a variable that no pass changes."""

    steps: tuple[tuple[int, float], ...]
    counter: int = -1
    operator: str = ""
    goal: float = 0.0
    is_variable: bool = False

    def passes(self, held: Mapping[int, Value], ends: Mapping[int, tuple[float, float]]) -> float:
        """How many passes follow for certain: 0 when that is not known, infinity when nothing ends them.

        held: the variables; ends: of those that hold not every number.
        """
        most = math.inf
        for number, step in self.steps:
            value = held.get(number)
            if not isinstance(value, float) or not value.is_integer():
                return 0.0
            low, high = ends.get(number, (-LARGEST, LARGEST))
            if not low <= value <= high:
                return 0.0
            if step:
                most = min(most, (high - value) // step if step > 0 else (value - low) // -step)
        if self.operator:
            goal = held.get(round(self.goal)) if self.is_variable else self.goal
            value = held.get(self.counter)
            if not isinstance(goal, float) or not isinstance(value, float) or not goal.is_integer():
                return 0.0
            if abs(goal) > LARGEST:
                return 0.0
            most = min(most, _holds_for(self.operator, value, dict(self.steps)[self.counter], goal))
        return max(most - LEFT, 0.0)


def _holds_for(operator: str, value: float, step: float, goal: float) -> float:
    """After how many steps a comparison that holds is still true, every one before included."""
    if operator in (">", ">="):
        operator, value, step, goal = _TURNED[operator], -value, -step, -goal
    away = goal - value
    if operator == "==":
        return 0.0 if step else math.inf
    if operator == "<>":
        meets = step != 0.0 and away / step > 0.0 and math.fmod(away, step) == 0.0
        return away // step - 1.0 if meets else math.inf
    if step <= 0.0:
        return math.inf
    return away // step - (1.0 if operator == "<" else 0.0)


def leap_of(node: While | Repeat | For, rules: LanguageRules) -> Leap | None:
    """How a loop counts; None for one that also does other things."""
    steps: dict[int, float] = {}
    for statement in node.body:
        if isinstance(statement, Label | Mode):
            continue
        if not isinstance(statement, Block) or statement.words or statement.texts or statement.deleted:
            return None
        for assign in statement.assigns:
            number, step = _number(assign.target, rules), _step(assign.value, rules)
            if number is None or step is None or step[0] != number or number in steps:
                return None
            steps[number] = step[1]
    if isinstance(node, For):
        own = _number(node.variable, rules)
        return None if own is None or own in steps else Leap(tuple(steps.items()))
    test = node.condition
    if not isinstance(test, Binary) or test.operator not in _NOT or test.doubtful or test.readings:
        return None
    operator, left, right = test.operator, test.left, test.right
    counter = _number(left, rules)
    if counter not in steps:
        operator, left, right = _TURNED[operator], right, left
        counter = _number(left, rules)
    goal = _literal(right)
    number = _number(right, rules)
    if counter is None or counter not in steps or (goal is None and (number is None or number in steps)):
        return None
    operator = _NOT[operator] if isinstance(node, Repeat) else operator
    if goal is not None:
        return Leap(tuple(steps.items()), counter, operator, goal)
    assert number is not None
    return Leap(tuple(steps.items()), counter, operator, float(number), is_variable=True)


def _number(node: Expr, rules: LanguageRules) -> int | None:
    """The number of a variable that a program may use as it likes."""
    if not isinstance(node, Variable) or not isinstance(node.number, Number):
        return None
    number = round(node.number.value)
    return number if any(e.first <= number <= e.last and e.kind in _KINDS for e in rules.parameters) else None


def _literal(node: Expr) -> float | None:
    if isinstance(node, Unary) and node.operator == "neg" and isinstance(node.operand, Number):
        return -node.operand.value
    return node.value if isinstance(node, Number | Constant) else None


def _step(value: Expr, rules: LanguageRules) -> tuple[int, float] | None:
    """(variable, what is added to it) of ``v + c``, ``c + v`` and ``v - c``."""
    if not isinstance(value, Binary) or value.operator not in ("+", "-") or value.doubtful or value.readings:
        return None
    number, step = _number(value.left, rules), _literal(value.right)
    if number is None and value.operator == "+":
        number, step = _number(value.right, rules), _literal(value.left)
    if number is None or step is None or not step.is_integer() or abs(step) > LARGEST:
        return None
    return number, -step if value.operator == "-" else step
