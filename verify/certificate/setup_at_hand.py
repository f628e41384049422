"""The setup at hand against the one that a package was made for: by exclusion, every field of every type.

Which positions and verdicts rest on which statement only the passes know, so a package holds for the setup that it
was made for, and for another one only where a rule of ``RULES`` says why that changes nothing. Fields are those that
the types have (``dataclasses.fields``): one that no rule names, and that is added tomorrow, has to be the same. What
was stated has to be stated now. What was left open meant a default, an assumption or an unknown: stated now, it
has to be that default, or the Trace has to show that nothing rests on it. docs/certificate.md has the table.
"""

from __future__ import annotations

import dataclasses
import enum
import functools
import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from gproof.ir.columns import Columns
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.record import record
from gproof.ir.setup import InForce, Interval, Setup
from gproof.ir.symbols import describe
from gproof.ir.trace import Affine, Op, Trace
from gproof.ir.workpiece import Workpiece
from gproof.verify.explain import certificate_words as words


class How(enum.Enum):
    """How a field is compared."""

    SAME = "same"
    LABEL = "not compared"
    WITHIN = "within"
    FEWER = "not more"
    HOMED = "the same axes of the machine"
    IN_FORCE = "the same transform"


@record(frozen=True, slots=True)
class Rule:
    """how: a field is compared; why: that is enough."""

    how: How
    why: str


_BOUNDED = Rule(How.WITHIN, "what was bounded was judged for all of its range, and what was exact has no other value")

RULES: dict[str, Rule] = {
    "Setup.name": Rule(How.LABEL, "names the setup in reports"),
    "HeightMap.name": Rule(How.LABEL, "names its file in findings"),
    "Area.name": Rule(How.LABEL, "names the zone in findings"),
    "Placed.name": Rule(How.LABEL, "names the body in findings"),
    "Mesh.source": Rule(How.LABEL, "names its file in findings"),
    "Setup.start": _BOUNDED,
    "Setup.work": _BOUNDED,
    "Setup.g92": _BOUNDED,
    "Setup.tool_lengths": _BOUNDED,
    "Setup.parameter_ranges": _BOUNDED,
    "Setup.resident": _BOUNDED,
    "Setup.heads": _BOUNDED,
    "Setup.contacts": _BOUNDED,
    "Setup.homed": Rule(How.HOMED, "an axis that was not stated was taken to be homed, and says so as an assumption"),
    "Setup.transform": Rule(How.IN_FORCE, "what was not stated of it was taken for none, and says so as an assumption"),
    "Setup.keep_out": Rule(How.FEWER, "what stays clear of all zones stays clear of some of them"),
    "Workpiece.fixtures": Rule(How.FEWER, "what stays clear of all fixtures stays clear of some of them"),
}
"""By type and field; a field that is not here is compared as ``How.SAME``."""

_HOLDS_FOR_NONE = {"block_delete": False, "optional_stop": True}
"""What a stream has where a switch was left open: skipped blocks are executed, and optional stops stop."""

_ENTRIES = {
    "measures": "the tool measure of {0}", "contacts": "the contact of {0}", "parameters": "variable {0}",
    "parameter_ranges": "the value that variable {0} will get", "resident": "variable {0} from the previous job",
    "positions": "the stored position {0}", "inputs": "input {0}", "outputs": "output {0}",
    "virtual": "virtual input {0}", "answers": "the answer to question {0}",
}  # fmt: skip
"""Entries of tables in words; those that have a symbol have its words."""


def how_compared(kind: type, name: str) -> How:
    """How a field of a type is compared."""
    rule = RULES.get(f"{kind.__name__}.{name}")
    return How.SAME if rule is None else rule.how


def differences(
    then: Setup, now: Setup, machine: Machine, trace: Trace, measured: frozenset[str] = frozenset()
) -> list[str]:
    """What keeps a package made for ``then`` from holding for ``now``, each a whole sentence; empty when it holds.

    measured: symbols that the package has conditions for, or a stream that is moved by them: what they are is judged
    with these, where ``then`` left them open.
    """
    if type(then) is not type(now):
        return [f"made for a {type(then).__name__}, now a {type(now).__name__}"]
    pair = _Pair(then, now, machine, trace, measured)
    return [said for field in dataclasses.fields(then) for said in pair.field(field.name)]


def same(then: object, now: object) -> bool:
    """Whether two values are one, names apart; NaN is none, and neither is a value of a kind that is not known here."""
    if dataclasses.is_dataclass(then) and not isinstance(then, type):
        kind = type(then)
        return type(now) is kind and all(_same_field(kind, f.name, then, now) for f in dataclasses.fields(then))
    if isinstance(then, Columns):
        return isinstance(now, Columns) and _same_columns(then, now)
    if isinstance(then, dict):
        return isinstance(now, dict) and then.keys() == now.keys() and all(same(then[key], now[key]) for key in then)
    if isinstance(then, tuple | list):
        return type(now) is type(then) and len(then) == len(now) and all(map(same, then, now))
    if isinstance(then, bool | str) or then is None:
        return type(now) is type(then) and now == then
    return _is_number(then) and _is_number(now) and then == now


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _same_field(kind: type, name: str, then: object, now: object) -> bool:
    how = how_compared(kind, name)
    was, is_ = getattr(then, name), getattr(now, name)
    if how is How.LABEL:
        return True
    return not _added(was, is_) if how is How.FEWER else same(was, is_)


def _same_columns(then: Columns, now: Columns) -> bool:
    return then.arrays.keys() == now.arrays.keys() and all(
        np.array_equal(array, now.arrays[name]) for name, array in then.arrays.items()
    )


def _added(then: object, now: object) -> list[Any]:
    """The entries that are there now and were not then."""
    if not (isinstance(then, tuple) and isinstance(now, tuple)):
        return [now]
    return [entry for entry in now if not any(same(one, entry) for one in then)]


class _Pair:
    """The two setups."""

    def __init__(
        self, then: Setup, now: Setup, machine: Machine, trace: Trace, measured: frozenset[str]
    ) -> None:  # fmt: skip
        self.then, self.now = then, now
        self.measured = measured
        self.machine, self.trace = machine, trace
        self.by_field: dict[str, Callable[[str], Iterator[str]]] = {
            "start": self._symbols, "work": self._symbols, "g92": self._symbols, "tool_lengths": self._symbols,
            "heads": self._symbols,
        }  # fmt: skip

    def field(self, name: str) -> Iterator[str]:
        """The differences of one field."""
        was, is_ = getattr(self.then, name), getattr(self.now, name)
        how = how_compared(Setup, name)
        if how is How.LABEL:
            return
        if how is How.HOMED:
            yield from self._homed()
        elif how is How.IN_FORCE:
            yield from self._in_force()
        elif how is How.FEWER:
            for entry in _added(was, is_):
                zone = getattr(entry, "name", "?")
                yield f"the job was checked without this keep-out zone of the setup at hand ({zone!r})"
        elif isinstance(was, dict) and isinstance(is_, dict):
            yield from self.by_field.get(name, self._table)(name)
        elif was is None and is_ is not None and same(_HOLDS_FOR_NONE.get(name), is_):
            return
        elif not same(was, is_):
            yield self._other(name, was, is_)

    def _other(self, name: str, was: object, is_: object) -> str:
        if isinstance(was, Workpiece) or isinstance(is_, Workpiece):
            return _other_workpiece(was, is_)
        said, found = words.setting(name, was), words.setting(name, is_)
        if type(was) is type(is_) and dataclasses.is_dataclass(was):
            found = f"another one ({found})"
        return f"{_made(words.SETTINGS.get(name, name), was, said)}; now it is {found}"

    # -- what a rule of its own compares

    def _homed(self) -> Iterator[str]:
        gone = self.now.unhomed(self.machine) - self.then.unhomed(self.machine)
        come = self.then.unhomed(self.machine) - self.now.unhomed(self.machine)
        if self.then.homed is not None and self.now.homed is None:
            said = " ".join(name.upper() for name in self.then.homed) or "none"
            yield f"made for homed axes {said}; now the setup does not say which axes are homed"
            return
        for axis in sorted(gone):
            yield f"made for {AXIS_NAMES[axis].upper()} homed; now it is not homed"
        for axis in sorted(come):
            yield f"made for {AXIS_NAMES[axis].upper()} not homed; now it is homed"

    def _in_force(self) -> Iterator[str]:
        was, is_ = self.then.transform, self.now.transform
        if same(was, is_):
            return
        left_out = was is not None and (
            is_ is None
            or any(getattr(was, f.name) is not None and getattr(is_, f.name) is None for f in dataclasses.fields(was))
        )
        if left_out or not same(_acting(was), _acting(is_)):
            yield self._other("transform", was, is_)

    # -- tables

    def _table(self, name: str) -> Iterator[str]:
        """A table without defaults: every entry, those of one side alone too."""
        was, is_ = getattr(self.then, name), getattr(self.now, name)
        within = how_compared(Setup, name) is How.WITHIN
        for key in _keys(was, is_):
            yield from self._entry(self._called(name, key), was.get(key), is_.get(key), within)

    def _symbols(self, name: str) -> Iterator[str]:
        """Offsets, lengths and the start, where other files and the setup's own defaults say what is not listed."""
        was, is_ = getattr(self.then, name), getattr(self.now, name)
        for key in _keys(was, is_):
            symbol = _symbol(name, key)
            before, after = was.get(key), is_.get(key)
            if before is None and after is not None and self._may_be_stated(symbol, name, key):
                continue
            before = self._default(self.then, name, key) if before is None else before
            after = self._default(self.now, name, key) if after is None else after
            # Whether a length is in force when the job starts decides where heights of bodies count from.
            within = symbol != "tool.0.z"
            yield from self._entry(describe(((symbol, 1),), self.machine), before, after, within)

    def _entry(self, called: str, was: object, is_: object, within: bool) -> Iterator[str]:
        if within and isinstance(was, Interval) and isinstance(is_, Interval):
            if not was.low <= is_.low <= is_.high <= was.high:
                yield f"{_made(called, was, _said(was))}; now it is {_said(is_)}"
        elif not same(was, is_) or (was is None and is_ is None):
            yield f"{_made(called, was, _said(was))}; now it is {_said(is_)}"

    def _called(self, name: str, key: object) -> str:
        return _ENTRIES.get(name, f"{name} {{0}}").format(str(key).upper() if name in ("measures", "contacts") else key)

    # -- what replaced an entry that is not listed

    def _default(self, setup: Setup, name: str, key: Any) -> Interval | None:
        """What an entry is taken for that a setup does not list; None: unknown, or two files say two things."""
        usual = setup.default_start if name == "start" else setup.default_offset
        from_file = self._of_machine(setup, name, key)
        if from_file is not None and usual is not None and name != "heads" and from_file != usual:
            return None
        value = usual if from_file is None else from_file
        return None if value is None or not math.isfinite(value) else Interval(value, value)

    def _of_machine(self, setup: Setup, name: str, key: Any) -> float | None:
        """What the machine file says of an entry; None: nothing, NaN: nothing that counts."""
        if name == "tool_lengths" and key != 0:
            tool = self.machine.tool(key)
            if tool is None or tool.length is None:
                return None
            # Some controllers have lengths as variables too, which come before the table.
            return math.nan if setup.parameters or setup.parameter_ranges else tool.length
        table = self.machine.settings.zero_offsets
        if name == "work" and table is not None:
            record_, axis = key[0], AXIS_NAMES.index(key[1])
            row = table[record_ - 1] if 1 <= record_ <= len(table) else ()
            return row[axis] if axis < len(row) else math.nan
        there = self.machine.spindle(key[0]) if name == "heads" and key[1] in AXIS_NAMES[:3] else None
        offset = None if there is None else there.offset[AXIS_NAMES.index(key[1])]
        return math.nan if there is not None and there.unsigned and offset else offset

    def _may_be_stated(self, symbol: str, name: str, key: Any) -> bool:
        """Whether what was left open is judged with what the package asks of it, or is used nowhere."""
        open_ = self.then.interval(symbol) is None and self._of_machine(self.then, name, key) is None
        return (open_ and symbol in self.measured) or self._not_used(name, key)

    def _not_used(self, name: str, key: Any) -> bool:
        """Whether an entry that was left open to everybody is one that no row of the Trace can rest on."""
        if self.then.default_offset is not None:
            return False
        if name == "work":
            number, _ = key
            return self.machine.settings.zero_offsets is None and number not in self._systems_used
        if name == "tool_lengths":
            if key == 0 or self._of_machine(self.then, name, key) is not None:
                return False
            if self.then.parameters or self.then.parameter_ranges:
                return False
            used = self._tools_used
            return used is not None and key not in used
        return False

    @functools.cached_property
    def _systems_used(self) -> set[int]:
        """Coordinate systems that a row, a zone, a body or a sum of unknowns names."""
        trace, workpiece = self.trace, self.then.workpiece
        used = {state.work for state in trace.states} | set(_arguments(trace, Op.OFFSET))
        used |= {self.then.active_work or 0}
        zones = (*self.machine.keep_out, *self.then.keep_out, self.machine.tool_change_area)
        used |= {getattr(zone, "work", 0) or 0 for zone in zones}
        for bodies in (workpiece.stock, workpiece.part, workpiece.fixtures) if workpiece is not None else ():
            used |= {placed.work for placed in bodies}
        used |= {int(symbol.split(".")[1]) for symbol in _symbols_of(trace) if symbol.startswith("work.")}
        # 0 is the active one if it is unknown which that is: it may be any.
        return used if 0 not in {state.work for state in trace.states} else set(range(10))

    @functools.cached_property
    def _tools_used(self) -> set[int] | None:
        """Tools that a row or a sum of unknowns names; None: some row has an unknown tool."""
        trace = self.trace
        rows = [*_arguments(trace, Op.TOOL_CHANGE), *_arguments(trace, Op.TOOL_OFFSET)]
        states = [state.tool for state in trace.states]
        if self.then.tool is None or any(tool < 0 for tool in (*states, *rows)):
            return None
        used = {*rows, *states, self.then.tool, *(one.tool for state in trace.states for one in state.diameters)}
        return used | {int(symbol.split(".")[1]) for symbol in _symbols_of(trace) if symbol.startswith("tool.")}


def _acting(transform: InForce | None) -> InForce:
    """A transform as it acts: what is not stated is none, and the point of none means nothing."""
    if transform is None:
        return InForce(angle=0.0, factor_x=1.0, factor_y=1.0)
    taken = dataclasses.replace(
        transform, angle=0.0 if transform.angle is None else transform.angle,
        factor_x=1.0 if transform.factor_x is None else transform.factor_x,
        factor_y=1.0 if transform.factor_y is None else transform.factor_y,
    )  # fmt: skip
    none = taken.angle == 0.0 and taken.factor_x == taken.factor_y == 1.0
    return dataclasses.replace(taken, x=0.0, y=0.0) if none else taken


def _other_workpiece(was: object, is_: object) -> str:
    if not (isinstance(was, Workpiece) and isinstance(is_, Workpiece)):
        now = "the setup has none" if is_ is None else "the setup has them"
        return f"made {'without' if was is None else 'for'} stock, part and fixtures; now {now}"
    others = [f.name for f in dataclasses.fields(was) if not _same_field(Workpiece, f.name, was, is_)]
    added = [repr(placed.name) for placed in _added(was.fixtures, is_.fixtures)] if "fixtures" in others else []
    named = f" ({', '.join(added)})" if added else ""
    return f"made for another workpiece: {', '.join(others)} differ{'s' if len(others) == 1 else ''} now{named}"


def _keys(was: dict[Any, Any], is_: dict[Any, Any]) -> list[Any]:
    return sorted({*was, *is_}, key=lambda key: (str(type(key)), str(key)))


def _symbol(name: str, key: Any) -> str:
    if name in ("start", "g92"):
        return f"{name}.{key}"
    if name == "tool_lengths":
        return f"tool.{key}.z"
    return f"{'head' if name == 'heads' else name}.{key[0]}.{key[1]}"


def _made(called: str, value: object, said: str) -> str:
    return f"made without {called}" if value is None else f"made for {called} {said}"


def _said(value: object) -> str:
    if value is None:
        return "not in the setup"
    if isinstance(value, Interval):
        return words.between(value.low, value.high)
    return words.number(value) if isinstance(value, int | float) else "another one"


def _arguments(trace: Trace, op: Op) -> Iterator[int]:
    """The first argument of every such row; -1 where it is not known."""
    for section in trace.sections:
        found = section.rows["arg"][section.rows["op"] == op, 0]
        yield from (int(value) if math.isfinite(value) else -1 for value in np.unique(found).tolist())


def _symbols_of(trace: Trace) -> Iterator[str]:
    """Every symbol that a frame or a state names, or that has a range."""
    forms: list[Affine] = [form for frame in trace.frames for form in frame]
    for state in trace.states:
        forms += [offset.form for offset in (*state.tip, *(state.machine_tip or ()))]
        forms += [boundary.form for boundary in state.boundaries]
    yield from trace.symbols
    yield from (symbol for form in forms for symbol, _ in form)
