"""Whether two Traces mean the same: docs/translation-proof.md says what that is.

Both graphs of sections are walked together from their starts. A pair of sections is compared once in each state of the
devices; what follows a pair is a pair for each outcome of its wait. A loop leads back to a pair that was compared: then
it holds for every pass, because the pair stands for all states that come by it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping

import numpy as np

from gproof.ir.end_state import EndState
from gproof.ir.record import record
from gproof.ir.trace import Affine, Op, Trace, Wait
from gproof.ir.translation_terms import TranslationTerms
from gproof.verify.translation import align_kernels as k
from gproof.verify.translation import outcomes
from gproof.verify.translation.comparison import Comparison, Place, Places, divergence
from gproof.verify.translation.ends import compare_ends
from gproof.verify.translation.events import Devices, Event, same
from gproof.verify.translation.paths import Alignment, aligned, bounds_of
from gproof.verify.translation.sides import BLURRED, Shared, Side, is_own
from gproof.verify.translation.stretches import Stretch, agree_on_ends, agree_on_stops, is_joint, stretch_from

KINDS = {
    k.KIND: "kind", k.PLACE: "place", k.FORM: "place", k.CENTER: "center", k.SENSE: "sense", k.PLANE: "plane",
    k.FEEDS: "feed", k.FACT: "fact", k.MORE_IN_SOURCE: "move lost", k.MORE_IN_TARGET: "move added", k.CHORD: "chord",
}  # fmt: skip
"""What the kernel finds, by the name of the difference."""
MOST_VISITS = 64
"""Times that a pair of sections is compared, each time with other devices on, before the answer is UNKNOWN."""


@record(frozen=True, slots=True)
class Pair:
    """Where both programs are: sections, and what is switched on."""

    source: int
    target: int
    source_devices: Devices = Devices()
    target_devices: Devices = Devices()


def compare(
    source: Trace, target: Trace, terms: TranslationTerms, source_end: Mapping[int, EndState] | None = None,
    target_end: Mapping[int, EndState] | None = None,
) -> Comparison:  # fmt: skip
    """Whether ``target`` means the same as ``source``.

    source_end, target_end: by number of the section that ends the program what it leaves; None: those of the Trace.
    Findings of the interpreter that make a Trace incomplete are the caller's: they are not in it.
    """
    ends = (source.ends if source_end is None else source_end, target.ends if target_end is None else target_end)
    return _Walk(source, target, terms, ends).run()


class _Walk:
    """The walk over pairs of sections."""

    def __init__(
        self, source: Trace, target: Trace, terms: TranslationTerms,
        ends: tuple[Mapping[int, EndState], Mapping[int, EndState]],
    ) -> None:  # fmt: skip
        shared = Shared()
        self.terms, self.ends = terms, ends
        self.sides = Side(source, 0, terms, shared), Side(target, 1, terms, shared)
        self.bounds = bounds_of(terms)
        self.result = Comparison()
        self.drift = np.zeros(2)
        self.visits: dict[tuple[int, int], int] = {}
        self.seen: dict[Pair, frozenset[str]] = {}
        self.ways_into = [outcomes.ways_into(trace) for trace in (source, target)]
        self.counted = [set[int](), set[int]()]
        self.came_from: list[dict[int, Place | None]] = [{}, {}]

    def run(self) -> Comparison:
        """Walk until nothing is left, or both part."""
        traces = [side.trace for side in self.sides]
        if not all(trace.sections for trace in traces):
            self.result.open(divergence("nothing there", (None, None)))
            return self.result.concluded()
        todo = deque([(Pair(0, 0), frozenset[str]())])
        while todo and not self.result.differences:
            pair, arisen = todo.popleft()
            if pair in self.seen:
                if self.seen[pair] != arisen:
                    # Sections that are reached again name what arose on the first way to them: the unknowns of another
                    # way have those names here, on either side, and nobody says which has which.
                    self.result.open(
                        divergence("names", (self.came_from[0].get(pair.source), self.came_from[1].get(pair.target)))
                    )
                continue
            if not self._may_visit(pair):
                continue
            self.seen[pair] = arisen
            todo.extend((following, arisen | new) for following, new in self._pair(pair))
        outcomes.say_assumptions(self.sides, self.result)
        self.result.rows = self._rows(0), self._rows(1)
        self.result.drift = float(self.drift[0]), float(self.drift[1])
        return self.result.concluded()

    def _rows(self, which: int) -> int:
        trace = self.sides[which].trace
        return sum(int((trace.sections[n].rows["op"] < 10).sum()) for n in self.counted[which])

    def _may_visit(self, pair: Pair) -> bool:
        key = pair.source, pair.target
        self.visits[key] = self.visits.get(key, 0) + 1
        if self.visits[key] > MOST_VISITS:
            self.result.open(divergence("too many states", (None, None)))
            return False
        return True

    def _pair(self, pair: Pair) -> list[tuple[Pair, frozenset[str]]]:
        """Compare two stretches, and give the pairs that follow, with the unknowns that arise on the way there."""
        self.result.sections += 1
        one, other = self._stretches(pair)
        agree_on_stops(one, other)
        agree_on_ends(one, other)
        for which, stretch in enumerate((one, other)):
            self.counted[which].update(stretch.sections)
            stretch.before = self.came_from[which].get(stretch.sections[0])
            for edge in stretch.edges:
                self.came_from[which].setdefault(edge.target, stretch.last_place)
        if not self._starts_agree(one, other) or not self._moves_agree(one, other):
            return []
        if not outcomes.waits_agree(one, other, self.result):
            return []
        return list(self._followed(one, other))

    def _followed(self, one: Stretch, other: Stretch) -> Iterator[tuple[Pair, frozenset[str]]]:
        """The pairs that follow two stretches that agree."""
        for a, b in outcomes.matched(one, other, self.result):
            if a.wait is Wait.END:
                compare_ends(self.sides, (one, other), self.ends, self.result)
                continue
            if a.target < 0 or b.target < 0:
                if a.target != b.target:
                    self.result.differs(divergence("end", (one.last_place, other.last_place)))
                continue
            new = frozenset[str]()
            if a.wait in (Wait.PROBE, Wait.HOME):
                self._bind(a.target, b.target)
                starts = (self.sides[n].forms(self._start_frame(n, s)) for n, s in ((0, a.target), (1, b.target)))
                new = frozenset(name for six in starts for form in six for name, _ in form if is_own(name))
            mine, theirs = one.devices, other.devices
            if a.wait in (Wait.OPERATOR, Wait.TOOL_CHANGE):
                mine = mine.after_operator(self.sides[0].device_channels)
                theirs = theirs.after_operator(self.sides[1].device_channels)
            yield Pair(a.target, b.target, mine, theirs), new

    def _start_frame(self, which: int, section: int) -> int:
        return self.sides[which].trace.sections[section].start_frame

    def _stretches(self, pair: Pair) -> tuple[Stretch, Stretch]:
        """Both from here to their next wait; places where outcomes come together end both or neither."""
        one = stretch_from(self.sides[0], pair.source, pair.source_devices, self.ways_into[0])
        other = stretch_from(self.sides[1], pair.target, pair.target_devices, self.ways_into[1])
        if outcomes.is_same_wait(one, other):
            return one, other
        if outcomes.is_joint(one.edges):
            one = stretch_from(self.sides[0], pair.source, pair.source_devices, set())
        if outcomes.is_joint(other.edges):
            other = stretch_from(self.sides[1], pair.target, pair.target_devices, set())
        return one, other

    # -- places and moves

    def _starts_agree(self, one: Stretch, other: Stretch) -> bool:
        """Whether both stretches start at the same place."""
        away = np.abs(one.start - other.start)
        near = (away[:3] <= self.terms.tolerance_mm).all() and (away[3:] <= self.terms.tolerance_deg).all()
        if one.start_frame == other.start_frame and (near or one.start_frame < 0):
            return True
        places = one.place(0) or one.last_place, other.place(0) or other.last_place
        found = divergence("start", places)
        if _rests_on_one_side(self._start_forms(one), self._start_forms(other)):
            self.result.open(divergence("place", places))
        else:
            self.result.differs(found)
        return False

    def _start_forms(self, stretch: Stretch) -> tuple[tuple[tuple[str, int], ...], ...]:
        return stretch.side.forms(stretch.side.trace.sections[stretch.sections[0]].start_frame)

    def _moves_agree(self, one: Stretch, other: Stretch) -> bool:
        """Whether events and moves of two stretches are the same; what is open is kept, and then they may be."""
        wrong = self._first_wrong_event(one, other)
        matched = len(one.events) if wrong is None else wrong
        last = self._until(one, matched), self._until(other, matched)
        barriers = np.array(
            [*((a.at, b.at) for a, b in zip(one.events[:matched], other.events[:matched], strict=True)), last], np.int64
        )
        found = aligned(one.moves, other.moves, barriers, np.stack([one.start, other.start]), self.bounds)
        self.drift = np.maximum(self.drift, found.drift)
        self._keep_notes(one, other, found)
        if found.found != k.AGREES:
            self._keep_difference(one, other, found, barriers, wrong)
            return False
        if wrong is not None:
            self._keep_event(one, other, wrong)
            return False
        return not self.result.differences

    def _until(self, stretch: Stretch, event: int) -> int:
        return stretch.events[event].at if event < len(stretch.events) else len(stretch.moves.op)

    def _first_wrong_event(self, one: Stretch, other: Stretch) -> int | None:
        """The first event that differs, by its number; None where all are the same."""
        for n, (a, b) in enumerate(zip(one.events, other.events, strict=False)):
            answer = same(a, b, self.terms.feed_relative, self.terms.seconds)
            if answer and a.kind == "device" and self.terms.source != self.terms.target:
                return n
            if answer is None:
                self.result.open(divergence(f"{a.kind} unknown", (a.place, b.place)))
            elif not answer:
                return n
            moving = a.flying and a.at not in one.rests, b.flying and b.at not in other.rests
            if a.flying != b.flying and moving[0] != moving[1]:
                return n
        shorter = min(len(one.events), len(other.events))
        return None if len(one.events) == len(other.events) else shorter

    def _keep_event(self, one: Stretch, other: Stretch, n: int) -> None:
        a = one.events[n] if n < len(one.events) else None
        b = other.events[n] if n < len(other.events) else None
        kind, names, numbers = event_difference(one.events, other.events, n, self.terms)
        places = a.place if a else one.last_place, b.place if b else other.last_place
        ended = [stretch for stretch, event in ((one, a), (other, b)) if event is None]
        if ended and self._is_open_end(ended[0], places):
            return
        found = divergence(kind, places, names=names, numbers=numbers)
        (self.result.open if kind.startswith("device") else self.result.differs)(found)

    def _is_open_end(self, stretch: Stretch, places: Places) -> bool:
        """Whether a side stops where nobody can say how it goes on; that is kept."""
        wait = stretch.edges[0].wait if stretch.edges else Wait.UNKNOWN
        if wait is Wait.UNKNOWN or (wait is Wait.BRANCH and not is_joint(stretch.edges)):
            self.result.open(divergence("not followed" if wait is Wait.UNKNOWN else "one question", places))
            return True
        return False

    def _cut_short(self, one: Stretch, i: int, other: Stretch, j: int, found: int, places: Places) -> bool:
        """Whether a move is missing only because its side stops before it, and nobody can say how that goes on."""
        if found == k.MORE_IN_TARGET:
            return i >= len(one.places) and self._is_open_end(one, places)
        return found == k.MORE_IN_SOURCE and j >= len(other.places) and self._is_open_end(other, places)

    def _keep_difference(
        self, one: Stretch, other: Stretch, found: Alignment, barriers: np.ndarray[tuple[int, int], np.dtype[np.int64]],
        wrong: int | None,
    ) -> None:  # fmt: skip
        i, j = found.source, found.target
        kind = KINDS[found.found]
        if (
            kind in ("move lost", "move added")
            and wrong is not None
            and max(i - barriers[-1, 0], j - barriers[-1, 1]) >= 0
        ):
            # The next event on one side comes before a move that the other one has: that is what is wrong.
            self._keep_event(one, other, wrong)
            return
        if kind in ("move lost", "move added") and len(one.places) == len(other.places):
            kind = "event moved"
        places = one.place(i), other.place(j)
        names: tuple[str, ...] = ()
        numbers: tuple[float, ...] = ()
        if kind == "fact":
            names = (self._fact(one, i, other, j),)
            kind = names[0]
        elif kind == "feed":
            numbers = float(one.moves.feed[i]), float(other.moves.feed[j])
        elif kind in ("place", "center", "sense", "kind", "chord", "plane"):
            numbers = (*one.moves.to[i].tolist(), *other.moves.to[j].tolist())
            names = Op(int(one.moves.op[i])).name, Op(int(other.moves.op[j])).name
        difference = divergence(kind, places, names=names, numbers=numbers)
        rows = [(one, i), (other, j)]
        forms = [s.side.forms(self._raw_frame(s, n)) for s, n in rows if n < len(s.places)]
        if self._cut_short(one, i, other, j, found.found, places):
            return
        if kind == "place" and len(forms) == 2 and _rests_on_one_side(*forms):
            self.result.open(divergence("place", places))
        else:
            self.result.differs(difference)

    def _raw(self, stretch: Stretch, move: int, column: str) -> int:
        """A column of the row of a move, in its Trace."""
        for number in stretch.sections:
            rows = stretch.side.trace.sections[number].rows
            kept = stretch.kept[number]
            if move < len(kept):
                return int(rows[column][kept[move]])
            move -= len(kept)
        raise IndexError(move)

    def _raw_frame(self, stretch: Stretch, move: int) -> int:
        return self._raw(stretch, move, "frame")

    def _fact(self, one: Stretch, i: int, other: Stretch, j: int) -> str:
        a, b = (s.side.facts_of(s.side.trace.states[self._raw(s, n, "state")]) for s, n in ((one, i), (other, j)))
        return next(name for name in a if a[name] != b[name])

    def _keep_notes(self, one: Stretch, other: Stretch, found: Alignment) -> None:
        for what, kind in ((k.UNKNOWN_FEED, "feed unknown"), (k.UNKNOWN_PLACE, "place"), (k.RAPID_PATH, "rapid")):
            count, i, j = found.notes[what].tolist()
            if not count:
                continue
            if kind == "rapid" and self.terms.rapids_assumed:
                self.result.assume("rapid moves of several axes take the same path on both machines")
                continue
            self.result.open(divergence(kind, (one.place(i), other.place(j)), numbers=(float(count),)))
        at_machine = tuple(s.place(s.at_machine) if s.at_machine >= 0 else None for s in (one, other))
        if at_machine != (None, None):
            if self.terms.machine_zero_shared:
                self.result.assume("machine coordinates count from the same place on both machines")
            else:
                self.result.open(divergence("machine place", (at_machine[0], at_machine[1])))
        for stretch in (one, other):
            if len(stretch.jumps):
                place = stretch.place(int(stretch.jumps[0]))
                places = (place, None) if stretch is one else (None, place)
                self.result.open(divergence("place", places))

    # -- unknowns that arise in the run

    def _bind(self, source: int, target: int) -> None:
        """What a probe move or a reference run has found is the same on both sides: both did the same before it."""
        starts = (self.sides[n].forms(self._start_frame(n, s)) for n, s in ((0, source), (1, target)))
        for one, other in zip(*starts, strict=True):
            mine, theirs = set(one) - set(other), set(other) - set(one)
            if len(mine) != 1 or len(theirs) != 1:
                continue
            (a, times), (b, count) = mine.pop(), theirs.pop()
            kinds = a.split(":")[-1].split("."), b.split(":")[-1].split(".")
            is_fresh = is_own(a) and is_own(b) and a not in self.sides[1].bound.values()
            if is_fresh and times == count and kinds[0][0] == kinds[1][0] and kinds[0][-1] == kinds[1][-1]:
                self.sides[1].bind(b.split(":", 1)[1], a)


def _rests_on_one_side(one: tuple[Affine, ...], other: tuple[Affine, ...]) -> bool:
    """Whether places differ by an unknown that arose in one run alone, or are nowhere."""
    apart = [name for a, b in zip(one, other, strict=True) for name, _ in {*a} ^ {*b}]
    return any(is_own(name) for name in apart) or any(n.split(".")[0] in BLURRED for f in (*one, *other) for n, _ in f)


def event_difference(
    one: list[Event], other: list[Event], n: int, terms: TranslationTerms
) -> tuple[str, tuple[str, ...], tuple[float, ...]]:
    """Kind, words and numbers of the first event that is not the same on both sides."""
    a = one[n] if n < len(one) else None
    b = other[n] if n < len(other) else None
    values = [[v for v in event.values if isinstance(v, float)] if event else [] for event in (a, b)]
    numbers = (*values[0], *values[1])
    names = tuple(event.kind if event else "" for event in (a, b))
    if a is None or (n + 1 < len(other) and same(a, other[n + 1], terms.feed_relative, terms.seconds)):
        assert b is not None
        return f"{b.kind} added", names, tuple(values[1])
    if b is None or (n + 1 < len(one) and same(one[n + 1], b, terms.feed_relative, terms.seconds)):
        return f"{a.kind} lost", names, tuple(values[0])
    if a.kind == b.kind and a.values == b.values:
        return "output timing", names, numbers
    if a.kind == b.kind:
        return a.kind, names, numbers
    return "event", names, numbers
