"""Modules, labels, jumps and calls of a McuWIN program as subprograms (manual 4.10, 4.15, 4.16, 5.1, 9).

Labels are of the whole text, with its includes. A call runs a module, or what follows a label up to M17; a jump goes on
after a label of its own module. What the manual does not have (a jump into a block or another module) is UNKNOWN.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from gproof.frontend.mcuwin.structure import Section, does_something
from gproof.ir import codes
from gproof.ir.finding import Findings, Related, Span
from gproof.ir.program import (
    Block,
    Call,
    DeferredBlock,
    For,
    If,
    Jump,
    Label,
    Number,
    Repeat,
    Return,
    Statement,
    Subprogram,
    Unsupported,
    While,
)
from gproof.ir.record import field, record

Body = tuple[Statement, ...]
Path = tuple[tuple[int, str], ...]
"""Where a list of statements is within a module: the blocks around it, by index and part."""

ENDS = (2.0, 30.0)


@record(slots=True)
class _Unit:
    """A module, or a procedure. key: its name among the subprograms, "" of the one that runs first; name: as labels
    have it; broken: a line of it was refused."""

    key: str
    name: str
    span: Span
    body: Body
    end_span: Span | None = None
    broken: bool = False
    procedure: Subprogram | None = None
    labels: dict[str, Path] = field(default_factory=dict)


@record(frozen=True, slots=True)
class Modules:
    """What a program is made of. unended: see ``Program``."""

    body: Body
    subprograms: dict[str, Subprogram]
    unended: frozenset[str] = frozenset()


def assemble(
    sections: Sequence[Section], procedures: Sequence[Subprogram], job: str, findings: Findings, *, old: bool
) -> Modules:  # fmt: skip
    """The modules of a source. job: the file that runs; old: names of modules are no labels (version 2.5.3.32)."""
    units = _units(sections, {sub.name for sub in procedures}, job, old=old)
    units += [_Unit(sub.name, "", sub.span, sub.body, procedure=sub) for sub in procedures]
    return _Assembly(units, findings, old).modules()


def _units(sections: Sequence[Section], taken: set[str], job: str, *, old: bool) -> list[_Unit]:
    """The module that runs first, then the others; sections without anything in them are none.

    taken: names of procedures, which no module has as its key. Where names of modules are no labels, a label of the
    same name may be anywhere, and has the key.
    """
    leading, rest = sections[0], list(sections[1:])
    main = _Unit("", "", leading.span, tuple(leading.body), leading.end_span, leading.broken)
    if rest and (not leading.says or (rest[0].says and not any(_ends(n) for n, _ in _walk(main.body)))):
        first = rest.pop(0)
        broken = leading.broken or first.broken
        main = _Unit("", first.name, first.span, (*leading.body, *first.body), first.end_span, broken)
        doubt = ""
        if leading.says:
            doubt = "text before the first percent sign that is not a declaration"
        elif first.span.file != job:
            doubt = "an included file with a module before those of the job (the manual does not say which runs first)"
        if doubt:
            main.body = (Unsupported(what=doubt, span=first.span), *main.body)
    units = [main]
    for number, section in enumerate(rest, 2):
        if section.name or section.body:
            own = section.name and section.name not in taken and not old
            key = section.name if own else f"%{number}"
            taken = {*taken, key}
            body = tuple(section.body)
            units.append(_Unit(key, section.name, section.span, body, section.end_span, section.broken))
    return units


class _Assembly:
    def __init__(self, units: list[_Unit], findings: Findings, old: bool) -> None:
        self.units = units
        self.findings = findings
        self.old = old
        self.procedures = {unit.procedure.name for unit in units if unit.procedure is not None}
        self.places: dict[str, tuple[_Unit, Span]] = {}
        self.named: dict[str, _Unit] = {}
        self.called: dict[str, _Unit] = {}
        self.unended: set[str] = set()

    def modules(self) -> Modules:
        for unit in self.units:
            self._name(unit)
        self._start_labels()
        for unit in self.units:
            self._labels(unit)
        for unit in self.units:
            unit.body = self._resolved(unit, unit.body, ())
            self._end(unit)
        main, *others = self.units
        subprograms = {unit.key: _subprogram(unit) for unit in others}
        for name, unit in self.called.items():
            if name not in subprograms:
                span = self.places[name][1]
                subprograms[name] = Subprogram(name=name, body=_tail(unit, name), span=span)
                if unit.key in self.unended:
                    self.unended.add(name)
        return Modules(main.body, subprograms, frozenset(self.unended))

    def _duplicate(self, name: str, span: Span, earlier: Span) -> None:
        related = (Related(earlier, "it is here too"),)
        self.findings.add(codes.DUPLICATE_LABEL.at(span, name=name, related=related))

    def _name(self, unit: _Unit) -> None:
        """A module's name is a label of its start (5.1)."""
        if not unit.name:
            return
        if unit.name in self.named:
            self._duplicate(unit.name, unit.span, self.named[unit.name].span)
            return
        self.named[unit.name] = unit

    def _start_labels(self) -> None:
        """A label at the start of modules that somebody jumps to by name, or calls though they run first."""
        if self.old:
            return
        wanted: set[tuple[str, int]] = set()
        for unit in self.units:
            for node, _ in _walk(unit.body):
                if isinstance(node, Jump | Call):
                    target = self.named.get(self._known(node.name))
                    if target is not None and (isinstance(node, Jump) or not target.key):
                        wanted.add((target.name, id(target)))
        for unit in self.units:
            has = any(isinstance(node, Label) and node.name == unit.name for node in unit.body)
            if (unit.name, id(unit)) in wanted and not has:
                unit.body = (Label(name=unit.name, span=unit.span), *unit.body)

    def _labels(self, unit: _Unit) -> None:
        for node, path in _walk(unit.body):
            if not isinstance(node, Label):
                continue
            name = node.name
            module = self.named.get(name)
            if name in self.places:
                self._duplicate(name, node.span, self.places[name][1])
                continue
            if module is not None and not self.old and not (module is unit and _at_beginning(unit.body, name)):
                self._duplicate(name, node.span, module.span)
                continue
            self.places[name] = (unit, node.span)
            unit.labels[name] = path

    def _known(self, name: str) -> str:
        """A name as labels and modules have it: ``LUP114`` may be the module UP114."""
        known = self.places if self.old else {**self.named, **self.places}
        return name[1:] if name not in known and name.startswith("l") and name[1:] in known else name

    def _resolved(self, unit: _Unit, body: Body, path: Path) -> Body:
        """Jumps and calls with targets, in all blocks."""
        out: list[Statement] = []
        for index, node in enumerate(body):
            if isinstance(node, Jump):
                node = self._jump(unit, node, path)
            elif isinstance(node, Call):
                node = node if node.text and node.name in self.procedures else self._call(node)
            elif isinstance(node, If | While | Repeat | For):
                node = _with_parts(node, self._part(unit, path, index))
            out.append(node)
        return tuple(out)

    def _part(self, unit: _Unit, path: Path, index: int) -> Callable[[str, Body], Body]:
        return lambda part, inner: self._resolved(unit, inner, (*path, (index, part)))

    def _jump(self, unit: _Unit, node: Jump, path: Path) -> Statement:
        name = self._known(node.name)
        if name in unit.labels:
            inside = unit.labels[name]
            if path[: len(inside)] == inside:
                return replace(node, name=name)
            return self._open(f"the jump to label {name} within a block", node.span)
        if name in self.places or (name in self.named and not self.old):
            return self._open(f"the jump to {name} in another module", node.span)
        if not self._undeclared(node.span):
            self.findings.add(codes.UNKNOWN_LABEL.at(node.span, name=name))
        return Unsupported(what=f"the jump to {name}", span=node.span, told=True)

    def _undeclared(self, span: Span) -> bool:
        """Whether the label of a goto, which is nowhere, is reported as one that is not declared."""
        return any(
            told.code is codes.UNDECLARED_NAME
            and (told.span.file, told.span.line) == (span.file, span.line)
            and span.column <= told.span.column < span.end_column
            for told in self.findings.kept
        )

    def _call(self, node: Call) -> Statement:
        name = self._known(node.name)
        module = None if self.old else self.named.get(name)
        if module is not None and module.key:
            return replace(node, name=module.key)
        if name not in self.places:
            self.findings.add(codes.UNKNOWN_SUBPROGRAM.at(node.span, name=name))
            return Unsupported(what=f"the call of {name}", span=node.span, told=True)
        unit, _ = self.places[name]
        if unit.labels[name]:
            return self._open(f"the call of label {name} within a block", node.span)
        self.called[name] = unit
        return replace(node, name=name)

    def _open(self, what: str, span: Span) -> Statement:
        self.findings.add(codes.JUMP_INTO_BLOCK.at(span, what=what))
        return Unsupported(what=what, span=span, told=True)

    def _end(self, unit: _Unit) -> None:
        """Compiler error 190 for a module without an end (14, 2.5.3.90); the older version had none."""
        if unit.procedure is not None or unit.broken:
            return
        says = any(does_something(node) for node in unit.body)
        if not (says or (unit.key and unit.name)) or any(_ends(node) for node, _ in _walk(unit.body)):
            return
        if not self.old:
            what = f"module {unit.name}" if unit.name else "the program" if not unit.key else "this module"
            self.findings.add(codes.NO_MODULE_END.at(unit.span, what=what))
            self.unended.add(unit.key)
        elif not unit.key:
            self.findings.add(codes.NO_PROGRAM_END.at(unit.span))


def _subprogram(unit: _Unit) -> Subprogram:
    if unit.procedure is not None:
        return replace(unit.procedure, body=unit.body)
    return Subprogram(name=unit.key, body=unit.body, span=unit.span, end_span=unit.end_span, is_module=True)


def _ends(node: Statement) -> bool:
    """Whether a statement is M02, M30 or M17."""
    if isinstance(node, Return):
        return True
    if not isinstance(node, Block) or isinstance(node, DeferredBlock):
        return False  # blocks that are made when they run never end a module (``line_cache.py``)
    return any(
        word.letter == "M" and isinstance(word.value, Number) and word.value.value in ENDS for word in node.words
    )


def _at_beginning(body: Body, name: str) -> bool:
    """Whether a label is before everything that does something."""
    for node in body:
        if isinstance(node, Label) and node.name == name:
            return True
        if does_something(node) and not isinstance(node, Label):
            return False
    return False


def _tail(unit: _Unit, label: str) -> Body:
    """What a call of a label runs: what follows it; the whole module from there when it jumps back before it."""
    at = next(i for i, node in enumerate(unit.body) if isinstance(node, Label) and node.name == label)
    before = {node.name for node in unit.body[:at] if isinstance(node, Label)}
    tail = unit.body[at:]
    if before and any(isinstance(node, Jump) and node.name in before for node, _ in _walk(tail)):
        return (Jump(name=label, span=tail[0].span if isinstance(tail[0], Label) else unit.span), *unit.body)
    return tail


def _walk(body: Body, path: Path = ()) -> Iterator[tuple[Statement, Path]]:
    """Every statement with the path of its list."""
    for index, node in enumerate(body):
        yield node, path
        if isinstance(node, If):
            yield from _walk(node.then, (*path, (index, "then")))
            yield from _walk(node.otherwise, (*path, (index, "otherwise")))
        elif isinstance(node, While | Repeat | For):
            yield from _walk(node.body, (*path, (index, "body")))


def _with_parts(node: If | While | Repeat | For, part: Callable[[str, Body], Body]) -> Statement:
    if isinstance(node, If):
        return replace(node, then=part("then", node.then), otherwise=part("otherwise", node.otherwise))
    return replace(node, body=part("body", node.body))
