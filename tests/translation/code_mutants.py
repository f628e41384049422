"""Mistakes in gproof's own code: one change of a module's syntax tree, and the modules that rest on it loaded anew.

``changes`` counts what can be changed in a module, ``changed`` makes one change, ``planted`` has it in force.
"""

from __future__ import annotations

import ast
import copy
import importlib.util
import re
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

from support.bundles import ROOT

AREA = re.compile(r"gproof\.(?:frontend\.\w+\.(?:raising\w*|move_tables)|backend\.emit\.[\w.]+)")
"""Modules that a translator is made of: those that raise, with what rests on them, and those that write."""
_OTHER: dict[type[ast.AST], type[ast.AST]] = {
    ast.Eq: ast.NotEq, ast.NotEq: ast.Eq, ast.Lt: ast.GtE, ast.GtE: ast.Lt, ast.Gt: ast.LtE, ast.LtE: ast.Gt,
    ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.And: ast.Or, ast.Or: ast.And,
    ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult,
}  # fmt: skip
_CODE = re.compile(r"([GMLKIJ])(\d+)")


class _Change(ast.NodeTransformer):
    """Changes what comes as number ``wanted``; ``said`` is what was done."""

    def __init__(self, wanted: int) -> None:
        self.wanted = wanted
        self.count = 0
        self.said = ""
        self.depth = 0

    def _is_now(self, node: ast.AST, what: str) -> bool:
        self.count += 1
        if self.count - 1 != self.wanted:
            return False
        self.said = f"line {getattr(node, 'lineno', 0)}: {what}"
        return True

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        """The body alone: no annotation, default or decorator, and no docstring."""
        self.depth += 1
        docs = [node.body[0]] if ast.get_docstring(node) is not None else []
        body = [self.visit(one) for one in node.body[len(docs) :]]
        node.body = [*docs, *body]
        self.depth -= 1
        return node

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AST:
        if node.value is not None:
            node.value = self.visit(node.value)
        return node

    def visit_Raise(self, node: ast.Raise) -> ast.AST:
        return node

    def visit_Expr(self, node: ast.Expr) -> ast.AST:
        if not self.depth:
            return node
        if self._is_now(node, f"lost: {ast.unparse(node)[:80]}"):
            return ast.copy_location(ast.Pass(), node)
        return self.generic_visit(node)

    def visit_Assign(self, node: ast.Assign) -> ast.AST:
        is_state = self.depth and not isinstance(node.targets[0], ast.Name)
        if is_state and self._is_now(node, f"lost: {ast.unparse(node)[:80]}"):
            return ast.copy_location(ast.Pass(), node)
        node.value = self.visit(node.value)
        return node

    def visit_If(self, node: ast.If) -> ast.AST:
        if self._is_now(node, f"not: if {ast.unparse(node.test)[:80]}"):
            node.test = ast.copy_location(ast.UnaryOp(ast.Not(), node.test), node.test)
            return node
        return self.generic_visit(node)

    def visit_IfExp(self, node: ast.IfExp) -> ast.AST:
        if self._is_now(node, f"exchanged: {ast.unparse(node)[:80]}"):
            node.body, node.orelse = node.orelse, node.body
            return node
        return self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> ast.AST:
        kind = _OTHER.get(type(node.ops[0]))
        if len(node.ops) == 1 and kind is not None and self._is_now(node, f"other: {ast.unparse(node)[:80]}"):
            node.ops = [kind()]  # type: ignore[list-item]
            return node
        return self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.AST:
        if self._is_now(node, f"other: {ast.unparse(node)[:80]}"):
            node.op = _OTHER[type(node.op)]()  # type: ignore[assignment]
            return node
        return self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        kind = _OTHER.get(type(node.op))
        if kind is not None and self._is_now(node, f"other: {ast.unparse(node)[:80]}"):
            node.op = kind()  # type: ignore[assignment]
            return node
        return self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.AST:
        if self._is_now(node, f"without its sign: {ast.unparse(node)[:80]}"):
            return node.operand
        return self.generic_visit(node)

    def visit_Dict(self, node: ast.Dict) -> ast.AST:
        if len(node.values) > 1 and self._is_now(node, f"values one further: {ast.unparse(node)[:80]}"):
            node.values = [*node.values[1:], node.values[0]]
            return node
        return self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        value = node.value
        if isinstance(value, bool) and self._is_now(node, f"not {value}"):
            return ast.copy_location(ast.Constant(not value), node)
        if isinstance(value, int | float) and not isinstance(value, bool) and self._is_now(node, f"{value} + 1"):
            return ast.copy_location(ast.Constant(value + 1), node)
        if isinstance(value, str) and _CODE.fullmatch(value) and self._is_now(node, f"{value} + 1"):
            return ast.copy_location(ast.Constant(_CODE.sub(lambda m: f"{m[1]}{int(m[2]) + 1}", value)), node)
        return node


def file_of(name: str) -> Path:
    """The file of a module."""
    place = ROOT.joinpath(*name.split(".")[1:])
    return place / "__init__.py" if place.is_dir() else place.with_suffix(".py")


def changes(name: str) -> int:
    """How many changes a module has."""
    change = _Change(-1)
    change.visit(ast.parse(file_of(name).read_text("utf-8")))
    return change.count


def changed(name: str, number: int) -> tuple[str, ast.Module]:
    """A change in words, and the module with it."""
    change = _Change(number)
    tree = change.visit(copy.deepcopy(ast.parse(file_of(name).read_text("utf-8"))))
    return change.said, ast.fix_missing_locations(tree)


def _resting_on(name: str) -> set[str]:
    """Modules of the area that import a module, themselves or by others, and the module."""
    texts = {one: file_of(one).read_text("utf-8") for one in list(sys.modules) if AREA.fullmatch(one)}
    found = {name}
    while True:
        more = {one for one, text in texts.items() if any(_imports(text, other) for other in found)} - found
        if not more:
            return found
        found |= more


def _imports(text: str, name: str) -> bool:
    package, _, own = name.rpartition(".")
    direct = rf"\b(?:from|import) {re.escape(name)}\b"
    return bool(re.search(rf"{direct}|\bfrom {re.escape(package)} import [^)]*?\b{own}\b", text))


@contextmanager
def planted(name: str, tree: ast.Module) -> Iterator[None]:
    """A changed module in force, and those that rest on it with it."""
    before = {one: sys.modules[one] for one in _resting_on(name) if one in sys.modules}
    _forget(before)
    spec = importlib.util.spec_from_file_location(name, file_of(name))
    assert spec is not None
    module: ModuleType = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        exec(compile(tree, str(file_of(name)), "exec"), module.__dict__)
        _as_attribute(name, module)
        yield
    finally:
        _forget(before)
        for one, old in before.items():
            sys.modules[one] = old
            _as_attribute(one, old)


def _forget(names: Iterable[str]) -> None:
    """The next import of a module reads it again: it is an attribute of its package, too."""
    for one in names:
        sys.modules.pop(one, None)
        package, _, own = one.rpartition(".")
        vars(sys.modules[package]).pop(own, None)


def _as_attribute(name: str, module: ModuleType) -> None:
    package, _, own = name.rpartition(".")
    setattr(sys.modules[package], own, module)
