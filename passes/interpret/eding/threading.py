"""G76: a thread in many passes. Eding CNC manual 3.4.19.

The manual names the words and what each bounds; how a pass is between them is that of RS274/NGC's threading cycle,
whose text it shares. Depths are measured across the drive line, from the thread's peak into the material; a pass at
depth d starts and ends (full depth - d) outside the drive line, so that every pass is the same, only shifted.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.eding.settings import eding_settings
from gproof.ir.finding import Refusal
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.record import record
from gproof.ir.rules import CodeRule
from gproof.ir.symbolic import NOBODY, Position
from gproof.ir.trace import Op, Plane
from gproof.passes.interpret.core.parsed_line import Line
from gproof.passes.interpret.eding.ambiguous_words import owned
from gproof.passes.interpret.eding.axis_targets import place_of
from gproof.passes.interpret.eding.canned_cycles import MAX_MOVES
from gproof.passes.interpret.eding.spindle import need_turning, note_speed_unknown
from gproof.passes.interpret.eding.spindle_synchronised import synchronised_move

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

_X, _Z = 0, 2
_MOVES_OF_A_PASS = 6
_ENTRY, _EXIT = 1, 2


@record(frozen=True, slots=True, kw_only=True)
class _Thread:
    """One line, in mm. start, end: the drive line along Z; x: where it is; inward: +1 when the material is at higher
    X; peak: from the drive line to the thread's peak; full: depth of the thread; slide: mm along Z for each
    mm of depth, towards the end; taper: mm along Z at the ends that ``tapers`` (bits 1 entry, 2 exit) names."""

    rule: CodeRule
    x: Position
    start: Position
    end: Position
    inward: float
    peak: float
    full: float
    pitch: float
    slide: float
    taper: float
    tapers: int

    @property
    def along(self) -> float:
        """+1 or -1: the direction of the thread along Z."""
        return math.copysign(1.0, self.end.value - self.start.value)


def run_threading(run: Run, line: Line, rule: CodeRule) -> None:
    """Execute one line of G76; Refusal with GP113, GP225, GP244, GP275 to GP262, GP266 or GP510."""
    s = run.modal
    if s.plane != Plane.XZ:
        raise Refusal(codes.THREAD_PLANE.at(line.where_code(rule), code=rule.text))
    for axis in line.axes():
        if axis != _Z:
            word = AXIS_NAMES[axis].upper()
            raise Refusal(codes.THREAD_WORD.at(line.where(word), code=rule.text, what=f"it takes no {word} word"))
    if s.transform.on:
        what = f"{rule.text} while G68 or G51 turns or scales X, along which it counts its depth"
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))
    missing = [letter for letter in "PZIJK" if letter not in line.values]
    if missing:
        raise Refusal(codes.WORD_MISSING.at(line.where_code(rule), code=rule.text, needed=" ".join(missing)))
    owned(line, rule, "PIJRKQHEL")
    words = {letter: line.number(letter) for letter in "PZIJRKQHEL"}
    first, degression, springs = _check_words(line, rule, words)
    need_turning(run, line, rule)
    thread = _thread(run, line, rule, words)
    depths = list(itertools.islice(_depths(first * s.scale(_X), thread.full, degression), MAX_MOVES))
    if (len(depths) + springs) * _MOVES_OF_A_PASS > MAX_MOVES:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"a thread of more than {MAX_MOVES} moves"))
    note_speed_unknown(run, line, rule.text)
    s.motion, s.cycle, s.cycle_code = rule.function, {}, 0
    for depth in depths + [thread.full] * springs:
        run.spend(line.span)
        _pass(run, line, thread, depth)
    run.moved = True


def _check_words(line: Line, rule: CodeRule, words: dict[str, float | None]) -> tuple[float, float, int]:
    """(first cut, degression, spring passes) after the errors of 3.4.19 that need no position."""

    def refuse(letter: str, what: str) -> Refusal:
        return Refusal(codes.THREAD_WORD.at(line.where(letter), code=rule.text, what=what))

    for letter in "PJKHE":
        value = words[letter]
        if value is not None and value < 0:
            raise refuse(letter, f"{letter}{value:g} is negative")
        if value == 0 and letter in "PJK":
            raise refuse(letter, f"{letter}0 makes no thread")
    degression = 1.0 if words["R"] is None else words["R"]
    if degression < 1.0:
        raise refuse("R", f"the degression R{degression:g} is less than 1")
    slide = words["Q"] or 0.0
    if not 0.0 <= slide < 90.0:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where("Q"), code=f"a compound slide angle of {slide:g} degrees"))
    for letter, allowed in (("H", None), ("L", (0, 1, 2, 3))):
        value = words[letter] or 0.0
        if value != round(value) or (allowed is not None and value not in allowed):
            raise refuse(letter, f"{letter}{value:g} is {'not 0, 1, 2 or 3' if allowed else 'not a whole number'}")
    first, full = words["J"] or 0.0, words["K"] or 0.0
    if first > full:
        raise refuse("J", f"the first cut J{first:g} is deeper than the thread, K{full:g}")
    return first, degression, round(words["H"] or 0.0)


def _thread(run: Run, line: Line, rule: CodeRule, words: dict[str, float | None]) -> _Thread:
    s = run.modal
    x, start = s.position[_X], s.position[_Z]
    end = place_of(run, _Z, words["Z"] or 0.0)
    if end.minus(start).form:
        raise Refusal(
            codes.UNKNOWN_VALUE.at(
                line.span, word="the length of the thread", cause="the start position of Z", why=NOBODY
            )
        )
    length = abs(end.value - start.value)
    peak = _peak(run, line, rule, x, words["I"] or 0.0)
    full = (words["K"] or 0.0) * s.scale(_X)
    slide = math.tan(math.radians(words["Q"] or 0.0))
    tapers = round(words["L"] or 0.0)
    taper = (words["E"] or 0.0) * s.scale(_Z)

    def refuse(letter: str, what: str) -> Refusal:
        return Refusal(codes.THREAD_WORD.at(line.where(letter), code=rule.text, what=what))

    if length == 0.0:
        raise refuse("Z", "the drive line has no length")
    if taper > length / 2.0:
        raise refuse("E", f"a taper of {taper:g} mm is more than half of the drive line, {length:g} mm")
    if taper == 0.0:
        tapers = 0
    ends = taper * (tapers & _ENTRY > 0) + taper * (tapers & _EXIT > 0)
    if full * slide + ends >= length:
        raise refuse("Q", "the compound slide angle leaves nothing of the thread")
    return _Thread(
        rule=rule, x=x, start=start, end=end, inward=math.copysign(1.0, peak), peak=abs(peak), full=full,
        pitch=(words["P"] or 0.0) * s.unit, slide=slide, taper=taper, tapers=tapers,
    )  # fmt: skip


def _peak(run: Run, line: Line, rule: CodeRule, x: Position, value: float) -> float:
    """mm from the drive line to the thread's peak, signed.

    3.4.19 calls I the outside diameter, always positive, and makes an example of it, and then an offset from the drive
    line, negative for an external thread. The machine file may say which it is (``thread_peak``).
    """
    s = run.modal
    at = s.offset(_X).moved(value * s.scale(_X))
    across = at.minus(x)
    offset = value * s.scale(_X)
    reading = eding_settings(run.machine).thread_peak
    if reading is None:
        place = s.program_position(_X)
        run.fail(
            codes.THREAD_PEAK_OPEN.at(
                line.where("I"), value=value, position=value, offset=(place.value + offset) / s.scale(_X),
                hint='state thread_peak = "position" or "offset" under [controller] in the machine file',
            )
        )  # fmt: skip
        reading = "position" if value > 0 else "offset"
    if reading == "offset":
        if offset == 0.0:
            raise Refusal(codes.THREAD_WORD.at(line.where("I"), code=rule.text, what="I0 is on the drive line"))
        return offset
    if value <= 0:
        raise Refusal(
            codes.THREAD_WORD.at(
                line.where("I"), code=rule.text, what=f"the outside diameter I{value:g} is not positive"
            )
        )
    if across.form:
        raise Refusal(
            codes.UNKNOWN_VALUE.at(line.where("I"), word="the depth to I", cause="the start position of X", why=NOBODY)
        )
    if across.value == 0.0:
        raise Refusal(
            codes.THREAD_WORD.at(line.where("I"), code=rule.text, what="the tool starts at the thread's peak")
        )
    return across.value


def _depths(first: float, full: float, degression: float) -> itertools.chain[float]:
    """Depths of the passes: first, then first x n ** (1 / degression), at last the full one.

    R1 is the same depth again and again, R2 the same area of chip, as 3.4.19 says.
    """
    growing = (first * n ** (1.0 / degression) for n in itertools.count(1))
    near = full * (1.0 - 1e-9)
    return itertools.chain(itertools.takewhile(lambda depth: depth < near, growing), (full,))


def _pass(run: Run, line: Line, thread: _Thread, depth: float) -> None:
    """Back along the drive line, in, along the thread, out."""
    t = thread
    shift = depth * t.slide * t.along  # deeper passes lie farther along: one flank cuts
    left = (t.full - depth) * t.slide * t.along
    outside = t.x.moved(-t.inward * (t.full - depth))
    crest = t.x.moved(t.inward * (t.peak + depth - t.full))
    bottom = t.x.moved(t.inward * (t.peak + depth))
    begin, end = t.start.moved(shift), t.end.moved(-left)
    taper = t.taper * t.along
    slope = math.hypot(t.taper, t.full) / t.taper if t.taper else 1.0
    _go(run, line, outside, begin)
    if t.tapers & _ENTRY:
        _cut(run, line, t, crest, begin, t.pitch * slope)
        _cut(run, line, t, bottom, begin.moved(taper), t.pitch * slope)
    else:
        _go(run, line, bottom, begin)
    if t.tapers & _EXIT:
        _cut(run, line, t, bottom, end.moved(-taper), t.pitch)
        _cut(run, line, t, crest, end, t.pitch * slope)
    else:
        _cut(run, line, t, bottom, end, t.pitch)
    _go(run, line, outside, end)


def _go(run: Run, line: Line, x: Position, z: Position) -> None:
    target = list(run.modal.position)
    target[_X], target[_Z] = x, z
    run.move(Op.TRAVERSE, target, line.span)


def _cut(run: Run, line: Line, thread: _Thread, x: Position, z: Position, pitch: float) -> None:
    target = list(run.modal.position)
    target[_X], target[_Z] = x, z
    synchronised_move(run, line, thread.rule, target, pitch)
