"""The tables of docs/reach.md, and the fields of the types that they are about."""

from __future__ import annotations

import ast
import dataclasses
import re
from dataclasses import dataclass
from types import ModuleType

from corpus.expectations import ROOT
from reach.answers import TARGETS

from gproof.ir import drives, machine, settings, setup, trace, workpiece
from gproof.ir.dialects import settings_modules
from gproof.passes.interpret.mcuwin.state import McuWinState
from gproof.passes.interpret.wincnc.state import WinCncState

PAGE = ROOT / "docs" / "reach.md"
STATED: tuple[ModuleType, ...] = (
    machine, setup, drives, settings, *settings_modules(), workpiece,
)  # fmt: skip
_ROW = re.compile(r"^\| (`.*`) \| (.*) \| (.*) \|$")
_NAME = re.compile(r"`([\w.]+)`")
_REF = re.compile(r"`((?:\w+/)+\w+\.py)(?:: ([\w.]+))?`")


@dataclass(frozen=True)
class Row:
    """What the page says of a field. reaches: targets; unknown: those with ``?``."""

    field: str
    reaches: frozenset[str]
    unknown: frozenset[str]
    text: str

    @property
    def places(self) -> list[tuple[str, str]]:
        """(file, function or "") that the row names."""
        return _REF.findall(self.text)


def rows() -> dict[str, Row]:
    """By field, ``Axis.lower``; ValueError for a field with two rows or a target that is none."""
    found: dict[str, Row] = {}
    section = ""
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        if line.startswith("## "):
            section = line.removeprefix("## ").split(",")[0].strip()
        match = _ROW.match(line)
        if match is None:
            continue
        words = [word.strip() for word in match[2].split(",")] if match[2] != "-" else []
        plain = [word.strip("?") for word in words]
        if set(plain) - set(TARGETS):
            raise ValueError(f"{line}: {sorted(set(plain) - set(TARGETS))} are no targets")
        for name in _NAME.findall(match[1]):
            field = name if "." in name else f"{section}.{name}"
            if field in found:
                raise ValueError(f"{field} has two rows")
            found[field] = Row(
                field,
                frozenset(plain),
                frozenset(word.strip("?") for word in words if word.startswith("?")),
                match[3],
            )
    return found


def stated_fields() -> set[str]:
    """Fields of every record that a setup file or a machine file can fill."""
    return {name for module in STATED for name in _fields(module)} | _of(trace.State)


def words_of_readers() -> set[str]:
    """Names and words in the readers of files: a field that is none of them is stated by no file."""
    found: set[str] = set()
    for file in sorted((ROOT / "frontend").rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.keyword) and node.arg:
                found.add(node.arg)
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                found |= {node.value, *node.value.split()}
    return found


def run_fields() -> set[str]:
    """Fields of what a running program carries."""
    tree = ast.parse((ROOT / "passes" / "interpret" / "core" / "modal_state.py").read_text(encoding="utf-8"))
    classes = (node for node in ast.walk(tree) if isinstance(node, ast.ClassDef) and node.name == "Modal")
    starts = [
        node
        for node in next(classes).body
        if isinstance(node, ast.FunctionDef) and (node.name == "__init__" or node.name.startswith("_begin_"))
    ]
    names = {
        node.attr
        for start in starts
        for node in ast.walk(start)
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store) and node.value.id == "self"
    }
    return {f"Modal.{name}" for name in names} | _of(WinCncState) | _of(McuWinState)


def _fields(module: ModuleType) -> set[str]:
    found: set[str] = set()
    for value in vars(module).values():
        if isinstance(value, type) and dataclasses.is_dataclass(value) and value.__module__ == module.__name__:
            found |= _of(value)
    return found


def _of(cls: type) -> set[str]:
    """Its own fields: those of the class that it is made from have rows of their own."""
    return {f"{cls.__name__}.{field.name}" for field in dataclasses.fields(cls) if field.name in cls.__annotations__}
