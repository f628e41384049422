"""What names of rw_SymPas mean, and which types its operators and functions take.

Integers, doubles and booleans are all floats when a job runs; types are checked here, once, by the source (McuWIN
manual 7, 8.3, 10 to 12).
"""

from __future__ import annotations

import copy
import enum
from typing import NamedTuple

from gproof.ir import codes
from gproof.ir.dialects.mcuwin.pascal import ANGULAR, BITWISE, FIRST_DECLARED, FUNCTIONS, PRODUCTS, RELATIONS, SUMS
from gproof.ir.finding import Finding, Findings, Related, Span
from gproof.ir.record import field, record


class Type(enum.Enum):
    """Of a value. UNKNOWN: of what was found to be wrong, or is not in the manual; it goes with every other."""

    INTEGER = "integer"
    DOUBLE = "double"
    BOOLEAN = "boolean"
    STRING = "string"
    UNKNOWN = "unknown"

    @property
    def numeric(self) -> bool:
        """A number, as far as anybody knows."""
        return self in (Type.INTEGER, Type.DOUBLE, Type.UNKNOWN)


DECLARABLE = {"integer": Type.INTEGER, "double": Type.DOUBLE, "boolean": Type.BOOLEAN}


class Parameter(NamedTuple):
    """Of a procedure. number: of the variable that holds it; by_reference: it is declared with ``var``."""

    name: str
    type: Type
    number: int
    by_reference: bool

    @property
    def written(self) -> str:
        """Its type as in ``Subprogram.parameters``: ``integer``, ``var integer``."""
        return f"var {self.type.value}" if self.by_reference else self.type.value


class Symbol(NamedTuple):
    """A declared name. kind: ``var``, ``const``, ``label``, ``procedure`` or ``function``; number: of the variable;
    value: of a constant, None where it is not known; text: of a constant that is a string; uses: numbers of variables
    in the body of a procedure and of those that it calls; open: its body is being read."""

    name: str
    kind: str
    span: Span
    type: Type = Type.UNKNOWN
    number: int = 0
    value: float | None = None
    text: str | None = None
    parameters: tuple[Parameter, ...] = ()
    uses: frozenset[int] = frozenset()
    open: bool = False


@record(slots=True)
class Symbols:
    """Declared names of a job, and the settings that decide how names and functions are read.

    findings: what takes the violations that reading goes on after; axes: letters of the machine's axes in its order;
    case_sensitive: None where it is not known: names are then found in any case, and one that is written in two ways
    is UNKNOWN; angle_unit: ``radians`` or ``degrees``.
    """

    findings: Findings
    axes: str = "XYZ"
    case_sensitive: bool | None = None
    angle_unit: str = "radians"
    count: int = 0
    _scopes: list[dict[str, Symbol]] = field(default_factory=lambda: [{}])

    def report(self, finding: Finding) -> None:
        """Takes a violation."""
        self.findings.add(finding)

    def trial(self) -> Symbols:
        """A copy whose findings and declarations go nowhere: to see whether a text can be read."""
        other = copy.copy(self)
        other.findings = Findings()
        other._scopes = [dict(scope) for scope in self._scopes]
        return other

    def same_names(self, other: Symbols) -> bool:
        """Whether the same is declared here as there."""
        return self._scopes == other._scopes

    def enter(self) -> None:
        """Start the names of a procedure."""
        self._scopes.append({})

    def leave(self) -> None:
        """They end."""
        self._scopes.pop()

    def add_var(self, name: str, type_: Type, span: Span) -> Symbol:
        """A variable, which gets the next number."""
        symbol = Symbol(name, "var", span, type_, FIRST_DECLARED + self.count)
        self.count += 1
        return self._add(symbol)

    def add_const(self, name: str, type_: Type, value: float | None, span: Span, text: str | None = None) -> Symbol:
        """A constant; text: of one that is a string."""
        return self._add(Symbol(name, "const", span, type_, value=value, text=text))

    def add_label(self, name: str, span: Span) -> Symbol:
        """A label of ``goto``."""
        return self._add(Symbol(name, "label", span))

    def declare_around(self, name: str, parameters: tuple[Parameter, ...], span: Span, kind: str = "procedure") -> bool:
        """Declares the procedure whose scope is entered, in the scope around it; False when it was declared before."""
        inner = self._scopes.pop()
        known = self._key(name) in self._scopes[-1]
        self._add(Symbol(name, kind, span, parameters=parameters, open=True))
        self._scopes.append(inner)
        return not known

    def close_procedure(self, name: str, uses: frozenset[int] | None) -> None:
        """The body of a procedure was read, whose scope is left; uses: None where it has none, nor then the name."""
        symbol = self._scopes[-1].pop(self._key(name), None)
        if symbol is not None and uses is not None:
            self._scopes[-1][self._key(name)] = symbol._replace(uses=uses, open=False)

    def uses(self, name: str) -> frozenset[int]:
        """Numbers of the variables that a procedure uses."""
        symbol = self.lookup(name)
        return symbol.uses if symbol is not None else frozenset()

    def lookup(self, name: str) -> Symbol | None:
        """What a name means, in the innermost scope that has it."""
        key = self._key(name)
        for scope in reversed(self._scopes):
            if key in scope:
                return scope[key]
        return None

    def resolve(self, name: str, span: Span) -> Symbol | None:
        """As ``lookup``, with a finding where the name is declared in another case; if that matters is not known."""
        symbol = self.lookup(name)
        if symbol is not None and symbol.name != name and self.case_sensitive is None:
            self.report(codes.PASCAL_OPEN.at(
                span, what=f"{name!r} is declared as {symbol.name!r}; McuWIN may be set to case-sensitive",
                hint="write the names in the same case, or state case_sensitive in the machine file",
                related=(Related(symbol.span, "declared here"),),
            ))  # fmt: skip
        return symbol

    def alike(self, name: str) -> str | None:
        """A declared name that differs from ``name`` only in case."""
        low = name.lower()
        return next((s.name for scope in reversed(self._scopes) for s in scope.values() if s.name.lower() == low), None)

    def _key(self, name: str) -> str:
        return name if self.case_sensitive else name.lower()

    def _add(self, symbol: Symbol) -> Symbol:
        name, scope = symbol.name, self._scopes[-1]
        digit = next((c for c in name if c.isdigit()), None)
        if digit is not None and symbol.kind in ("var", "const"):
            self.report(codes.DECLARATION.at(
                symbol.span, what=f"the name {name!r} has the digit {digit}, which names of variables and constants "
                                  "must not have",
                hint="use letters only (McuWIN manual 10)",
            ))  # fmt: skip
        earlier = scope.get(self._key(name))
        if earlier is not None and earlier.name != name and self.case_sensitive is None:
            self.report(codes.PASCAL_OPEN.at(
                symbol.span, what=f"{name!r} and {earlier.name!r} differ only in case; McuWIN may be set to ignore "
                                  "case",
                hint="choose another name", related=(Related(earlier.span, "declared here"),),
            ))  # fmt: skip
        elif earlier is not None:
            self.report(codes.DECLARATION.at(
                symbol.span, what=f"{name!r} is declared twice", related=(Related(earlier.span, "declared here"),),
                hint="remove one of them, or choose another name",
            ))  # fmt: skip
        scope[self._key(name)] = symbol
        return symbol


def binary_type(word: str, left: Type, right: Type) -> tuple[str, Type] | None:
    """(operator of the IR, type of the result) of ``left word right``; None where the types do not go with it."""
    if Type.STRING in (left, right):
        return None
    if word in RELATIONS:
        fits = (left.numeric and right.numeric) or left == right or Type.UNKNOWN in (left, right)
        return (RELATIONS[word], Type.BOOLEAN) if fits else None
    operator = PRODUCTS.get(word) or SUMS[word]
    if word in BITWISE:
        known = next((t for t in (left, right) if t is not Type.UNKNOWN), Type.UNKNOWN)
        if known is Type.DOUBLE or Type.DOUBLE in (left, right) or {left, right} == {Type.INTEGER, Type.BOOLEAN}:
            return None
        return (BITWISE[word], known) if known is Type.INTEGER else (operator, known)
    if not (left.numeric and right.numeric):
        return None
    if word in ("div", "mod", "shl", "shr"):
        return None if Type.DOUBLE in (left, right) else (operator, Type.INTEGER)
    if word == "/" or Type.DOUBLE in (left, right):
        return operator, Type.DOUBLE
    return operator, Type.UNKNOWN if Type.UNKNOWN in (left, right) else Type.INTEGER


def function_type(name: str, operand: Type, angle_unit: str) -> tuple[str, Type] | None:
    """(operator of the IR, type of the result) of a function of FUNCTIONS; None where it does not take the operand."""
    operator = FUNCTIONS[name]
    if name == "boolean":
        return (operator, Type.BOOLEAN) if operand is not Type.STRING else None
    if not operand.numeric or (name == "odd" and operand is Type.DOUBLE):
        return None
    if operator in ANGULAR and angle_unit == "radians":
        operator = f"r{operator}"
    if name in ("abs", "sqr"):
        return operator, operand
    results = {"odd": Type.BOOLEAN, "round": Type.INTEGER, "trunc": Type.INTEGER}
    return operator, results.get(name, Type.DOUBLE)


def assignable(target: Type, value: Type) -> bool:
    """Whether a variable of one type takes a value of the other: only integers become doubles by themselves."""
    return target == value or Type.UNKNOWN in (target, value) or (target is Type.DOUBLE and value is Type.INTEGER)
