"""One side of a comparison: its Trace with unknowns, tools and channels in the names that both sides share.

Forms, frames and facts are numbered in tables that both sides have in common (``Shared``), so that columns of numbers
can be compared.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from gproof.ir.drives import AXES
from gproof.ir.program import SpindleOutputs
from gproof.ir.trace import OTHER_UNIT, Affine, State, Trace
from gproof.ir.translation_terms import SymbolMeaning, TranslationTerms

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

STATED = ("start", "work", "g92", "tool", "head", "unhomed", "stored", "mirrored")
"""Kinds of unknowns that have the same value wherever their name occurs; all others arise in a run, and are the same on
both sides only where the walk has bound them (``Side.bind``)."""
BLURRED = ("?", "beside")
"""Kinds that do not say where the axes are: two places with equal forms may be different places."""

OWN = "source:", "target:"
"""What unbound unknowns of a run start with."""


class Shared:
    """Numbers of frames and facts, the same on both sides."""

    def __init__(self) -> None:
        self._frames: dict[tuple[Affine, ...], int] = {}
        self._facts: dict[tuple[Any, ...], int] = {}
        self.fact_names: tuple[str, ...] = ()

    def frame(self, forms: tuple[Affine, ...], *, blurred: bool) -> int:
        """From 1; negative where a part is nowhere."""
        number = self._frames.setdefault(forms, len(self._frames) + 1)
        return -number if blurred else number

    def fact(self, values: tuple[Any, ...]) -> int:
        """The number of a state's facts."""
        return self._facts.setdefault(values, len(self._facts))


class Side:
    """A Trace and how its names are read. which: 0 source, 1 target; polls: it waits for an input by a loop."""

    def __init__(self, trace: Trace, which: int, terms: TranslationTerms, shared: Shared) -> None:
        self.trace, self.which, self.terms, self.shared = trace, which, terms, shared
        is_target = which == 1
        meanings = terms.target_symbols if is_target else terms.source_symbols
        self.meanings: dict[str, SymbolMeaning] = {m.symbol: m for m in meanings}
        self.bound: dict[str, str] = {}
        self.polls = False
        self.outputs: SpindleOutputs = terms.target_outputs if is_target else terms.source_outputs
        self.channels: dict[int, int] = {} if is_target else dict(terms.outputs)
        self.inputs: dict[int, int] = {} if is_target else dict(terms.inputs)
        self.tools: dict[int, int] = {} if is_target else dict(terms.tools)
        self.spindle_channels = frozenset((*self.outputs.forward, *self.outputs.backward))
        self.device_channels = self.spindle_channels | set(self.outputs.coolant)
        self._begin_tables()

    def _begin_tables(self) -> None:
        count = len(self.trace.frames)
        self._ids: Ints = np.zeros(count, np.int64)
        self._shift: Floats = np.zeros((count, AXES))
        self._forms: dict[int, tuple[Affine, ...]] = {}
        self._form_ids: dict[Affine, int] = {}
        self._axis_forms: Ints = np.zeros((count, AXES), np.int64)
        self._arising: set[int] = set()
        self._facts: Ints = np.full(len(self.trace.states), -1, np.int64)

    # -- places

    def form(self, form: Affine) -> tuple[float, Affine]:
        """A form in shared names, and what its unknowns have as numbers."""
        mm, total = 0.0, dict[str, int]()
        for symbol, count in form:
            meaning = self.meanings.get(symbol)
            if meaning is not None:
                mm += count * meaning.mm
                for name, times in meaning.form:
                    total[name] = total.get(name, 0) + count * times
                continue
            name = self._shared_name(symbol)
            total[name] = total.get(name, 0) + count
        return mm, tuple(sorted((name, count) for name, count in total.items() if count))

    def _shared_name(self, symbol: str) -> str:
        kind, _, rest = symbol.partition(".")
        if kind == "tool":
            number, _, axis = rest.partition(".")
            return f"tool.{self.tools.get(int(number), int(number))}.{axis}"
        if kind in STATED or kind in BLURRED:
            return symbol
        return self.bound.get(symbol) or OWN[self.which] + symbol

    def bind(self, symbol: str, name: str) -> None:
        """An unknown of this side's run has a name of the other side's from now on."""
        self.bound[symbol] = name
        for frame in self._arising:
            self._ids[frame] = 0

    def forms(self, frame: int) -> tuple[Affine, ...]:
        """The six forms of a frame in shared names."""
        if self._ids[frame] == 0:
            self._make(frame)
        return self._forms[frame]

    def shift(self, frame: int) -> Floats:
        """(6,): what is added to the numbers of positions in a frame."""
        if self._ids[frame] == 0:
            self._make(frame)
        return np.asarray(self._shift[frame])

    def _make(self, frame: int) -> None:
        made = [self.form(form) for form in self.trace.frames[frame]]
        self._shift[frame] = [mm for mm, _ in made]
        forms = tuple(form for _, form in made)
        self._forms[frame] = forms
        for axis, form in enumerate(forms):
            self._axis_forms[frame, axis] = self._form_ids.setdefault(form, len(self._form_ids))
        blurred = any(name.split(".")[0] in BLURRED for form in forms for name, _ in form)
        self._ids[frame] = self.shared.frame(forms, blurred=blurred)
        if any(is_own(name) or name in self.bound.values() for form in forms for name, _ in form):
            self._arising.add(frame)

    def placed(self, frame: Ints, to: Floats) -> tuple[Ints, Floats]:
        """Numbers of frames (n,) and positions (n, 6), in shared names."""
        used = self._used(frame)
        if self._shift[used].any():
            to = to + self._shift[frame]
        return self._ids[frame], to

    def _used(self, frame: Ints) -> Ints:
        """The frames that occur, whose numbers are known then."""
        used = np.flatnonzero(np.bincount(frame, minlength=1)) if len(frame) else np.zeros(0, np.int64)
        for number in used[self._ids[used] == 0].tolist():
            self._make(number)
        return used

    def forms_of(self, frame: Ints) -> Ints:
        """(n, 6): numbers of the forms of frames that ``placed`` has seen; of this side alone."""
        return np.asarray(self._axis_forms[frame])

    def at_known(self, frame: Ints) -> npt.NDArray[np.bool_]:
        """(n, 6): whether the axes are at numbers in machine coordinates; (1, 6), all False, where none ever is."""
        known = self._axis_forms == self._form_ids.get((), -1)
        if not known[self._used(frame)].any():
            return np.zeros((1, AXES), np.bool_)
        return np.asarray(known[frame])

    def shifted(self, center: Floats, frame: Ints) -> Floats:
        """Centres of arcs in shared names: they count in the frame of their row."""
        if not self._shift[self._used(frame)].any():
            return center
        return np.asarray(center + self._shift[frame][:, :3])

    # -- facts

    def facts(self, state: Ints) -> Ints:
        """(n,): numbers of the facts of states."""
        for number in np.flatnonzero(np.bincount(state, minlength=1)).tolist() if len(state) else ():
            if self._facts[number] < 0:
                self._facts[number] = self.shared.fact(tuple(self.facts_of(self.trace.states[number]).values()))
        return self._facts[state]

    def facts_of(self, state: State) -> dict[str, Any]:
        """What of a state must be the same on both sides, by the names of ``ROW_FACTS``; NaN is ``unknown`` here."""
        found: dict[str, Any] = {
            "tool": self.tools.get(state.tool, state.tool),
            "path_mode": (int(state.path_mode), _number(state.path_tolerance), *self._filter(state)),
            "overrides": state.overrides,
            "head": state.head,
            "surface_speed": (_number(state.surface_speed), _number(state.spindle_limit)),
            "synchronised": state.synchronised,
            "following": state.following,
            "guards": self.terms.shared_guards(state.guards_off),
            "dynamics": tuple(one for one in state.retimed if one != OTHER_UNIT),
            "backlash": state.backlash,
            "limits": self._limits(state),
        }
        if self.terms.source_outputs == self.terms.target_outputs:
            found["spindle"] = _number(state.spindle)
        if self.terms.tool_by_stop:
            del found["tool"]  # the number may be in a text alone; the changes are compared as events
        return {name: value for name, value in found.items() if name not in self.terms.left_out}

    def _filter(self, state: State) -> tuple[float | str, ...]:
        """Tolerance of simplified moves and angle that is passed without a stop; those of a source that the target need
        not have are none: then the target may have none."""
        if self.terms.filter_left_out and self.which == 0:
            return 0.0, _number(math.nan)
        return _number(state.simplify), _number(state.laf_angle)

    def _limits(self, state: State) -> tuple[Any, ...]:
        """Limits of the work that the program has changed: those of the start are the machine's own."""
        now, first = (
            tuple((b.axis, b.low, b.high, b.limit, b.open) for b in one.boundaries) if one is not None else ()
            for one in (state, self.trace.first)
        )
        return () if now == first else now


def is_own(name: str) -> bool:
    """Whether an unknown arose in the run of one side, and nothing says what it is on the other."""
    return name.startswith(OWN)


def _number(value: float) -> float | str:
    return "unknown" if math.isnan(value) else value
