"""What a printed LinuxCNC or grbl program does, as a Trace: for languages that gproof has no front end for.

It reads the words that translations have, with nothing taken for granted of what an earlier program left: modes are
unknown until the program says them. A line that it does not know ends the Trace with ``Wait.UNKNOWN`` and is in
``ReadBack.unread``; nothing is skipped. It shares no code with what writes these programs.
"""

from __future__ import annotations

import math

import numpy as np

from gproof.ir.machine import Machine
from gproof.ir.record import record
from gproof.ir.trace import Trace
from gproof.verify.translation.rs274.controller import Controller
from gproof.verify.translation.rs274.language import GRBL, LINUXCNC, Language, Unread
from gproof.verify.translation.rs274.moves import go
from gproof.verify.translation.rs274.plain_lines import LETTERS, PlainLines, plain_lines
from gproof.verify.translation.rs274.structure import Step, Structure
from gproof.verify.translation.rs274.values import FIRST_FREE, LAST_FREE, Values
from gproof.verify.translation.rs274.words import Words, without_comments, words_of

__all__ = ["GRBL", "LINUXCNC", "Language", "ReadBack", "read_back"]

MOST_STEPS = 2_000_000
"""Lines that are run before the answer is UNKNOWN: loops of a translation end."""
PIECE_ROWS = 1 << 15
"""Plain lines that are done at once."""
TIME_IS_OVER = "[#5399EQ-1]"
"""The condition of what M66 leaves when its time is over."""
DEEPEST = 40
"""Calls within calls."""


@record(frozen=True, slots=True, kw_only=True)
class ReadBack:
    """trace: as for any work zero; unread: (line, why) where reading ended, "" for nothing; assumed: sentences that it
    rests on."""

    trace: Trace
    unread: tuple[tuple[int, str], ...] = ()
    assumed: tuple[str, ...] = ()


def read_back(files: dict[str, bytes], name: str, language: Language, machine: Machine, work: int = 1) -> ReadBack:
    """The Trace of a program.

    files: texts by name, "" for the job's own, which is the only one that these languages have; name: what places in it
    are called; machine: whose tool table and axes count; work: number of the work offset at the start.
    """
    lengths = {tool.number: tool.length for tool in machine.tools if tool.length is not None}
    columns = tuple(axis.index for axis in machine.axes if axis.name.upper() in language.axes)
    reader = _Reader(name, language, work, lengths, columns)
    unread: tuple[tuple[int, str], ...]
    if set(files) != {""}:
        found = Unread("a file besides the job")
        reader.now.give_up(found, 0)
        unread = ((0, found.why),)
    else:
        unread = reader.run(files[""])
    trace = reader.now.rows.trace
    return ReadBack(trace=trace, unread=unread, assumed=tuple(reader.now.assumed))


class _Left(Exception):
    """``return``."""


class _Reader:
    def __init__(
        self, name: str, language: Language, work: int, lengths: dict[int, float], columns: tuple[int, ...]
    ) -> None:  # fmt: skip
        self.language = language
        self.now = Controller(name, language, work, lengths, columns)
        self.variables: dict[int, float] = {}
        self.structure = Structure()
        self.steps = 0
        self.depth = 0
        self.at = 0
        self.marked = False
        self.plain = PlainLines(*(np.zeros(0, np.int64),) * 4)  # type: ignore[arg-type]

    def run(self, text: bytes) -> tuple[tuple[int, str], ...]:
        """Everything; what could not be read."""
        try:
            text = text.replace(b"\r\n", b"\n")
            text = text if text.endswith(b"\n") or not text else text + b"\n"
            self.plain = plain_lines(text)
            last = self._structured(text)
            self._steps(self.structure.top)
            if not self.now.ended:
                if self.language.structured and not self.marked:
                    raise Unread("the end of the file without M2, M30 or %", last)
                self.now.finish(last, reset=False)
        except Unread as found:
            line = found.line or self.at
            self.now.give_up(found, line)
            return ((line, found.why),)
        return ()

    # ---- lines to steps

    def _structured(self, text: bytes) -> int:
        """Fills ``structure``; the number of the last line."""
        plain, starts = self.plain.plain, self.plain.starts
        most = self.language.line_length
        long = np.flatnonzero(np.diff(starts) - 1 > most) if most else starts[:0]
        if len(long):
            raise Unread("a line that is too long", int(long[0]) + 1)
        change = np.flatnonzero(np.diff(plain.astype(np.int8), prepend=-1))
        count = len(plain)
        marks = 0
        for begin, end in zip(change.tolist(), [*change[1:].tolist(), count], strict=True):
            if plain[begin]:
                self._in_file(marks, begin + 1)
                self.structure.add(Step("lines", begin + 1, end + 1))
                continue
            for place in range(begin, end):
                self.at = place + 1
                raw = text[starts[place] : starts[place + 1] - 1]
                marks = self._other_line(raw, place + 1, marks)
        if marks == 1:
            raise Unread("the second % is missing", count)
        self.marked = marks > 0
        self.structure.close(count)
        return count

    def _in_file(self, marks: int, line: int) -> None:
        if marks > 1:
            raise Unread("a line after the second %", line)

    def _other_line(self, raw: bytes, line: int, marks: int) -> int:
        """A line that is not plain; how many percent signs there were."""
        try:
            text = raw.decode("utf-8")
        except UnicodeDecodeError as error:
            raise Unread("a line that is no text", line) from error
        if text.strip() == "%":
            if not self.language.structured or (marks == 0 and line != 1) or marks > 1:
                raise Unread("%", line)
            return marks + 1
        if not text.strip():
            return marks
        self._in_file(marks, line)
        text = without_comments(text, self.language)
        if text and not (self.language.structured and self.structure.o_word(text, line)):
            self.structure.add(Step("line", line, text=text))
        return marks

    # ---- steps

    def _steps(self, steps: list[Step]) -> None:
        for step in steps:
            self.at = step.first
            self.steps += 1
            if self.steps > MOST_STEPS:
                raise Unread("a program that takes too long to follow")
            if step.kind == "lines":
                self._lines(step.first, step.last)
            elif step.kind == "line":
                self._line(step)
            elif step.kind == "if":
                self._steps(step.body if self._holds(step) else step.otherwise)
            elif step.kind == "while":
                while self._holds(step):
                    self._steps(step.body)
            elif step.kind == "do" and self._waits(step):
                continue
            elif step.kind == "do":
                self._steps(step.body)
                while self._holds(step):
                    self._steps(step.body)
            elif step.kind == "call":
                self._call(step)
            else:
                raise _Left

    def _waits(self, step: Step) -> bool:
        """Whether a loop is M66, as long as its time is over: a wait without a limit (M-Codes M66)."""
        if "".join(step.text.split()).upper() != TIME_IS_OVER or [one.kind for one in step.body] != ["line"]:
            return False
        inner = step.body[0]
        if inner.text.startswith("#"):
            return False
        return self.now.wait_for_ever(words_of(inner.text, self.language, self.variables), inner.first)

    def _holds(self, step: Step) -> bool:
        self.at = step.first
        reader = Values(step.text, self.variables)
        value = reader.bracketed()
        if reader.peek():
            raise Unread("something after a condition")
        self.steps += 1
        if self.steps > MOST_STEPS:
            raise Unread("a program that takes too long to follow")
        return value != 0.0

    def _call(self, step: Step) -> None:
        if self.depth >= DEEPEST:
            raise Unread("calls within calls that do not end")
        self.depth += 1
        try:
            self._steps(self.structure.subs[step.name])
        except _Left:
            pass
        finally:
            self.depth -= 1

    def _line(self, step: Step) -> None:
        if step.text.startswith("#") and self.language.structured:
            reader = Values(step.text, self.variables)
            reader.need("#")
            number = reader.variable()
            reader.need("=")
            value = reader.value()
            if reader.peek() or not FIRST_FREE <= number <= LAST_FREE:
                raise Unread(f"the setting of #{number}")
            self.variables[number] = value
            return
        self.now.line(words_of(step.text, self.language, self.variables), step.first)

    # ---- plain lines

    def _lines(self, first: int, last: int) -> None:
        """Lines of moves, from ``first`` to before ``last``: at once where no mode is open."""
        now = self.now
        if now.ended:
            raise Unread("a line after the end of the program")
        row = int(self.plain.row[first - 1])
        values = self.plain.values[row : row + last - first]
        self.steps += last - first
        done, few = 0, 1
        while done < len(values):
            piece = values[done : done + PIECE_ROWS]
            if now.per == 94 and (now.motion is None or now.motion < 40) and self._table(first + done, piece):
                done += len(piece)
                continue
            # A mode is open in the first of them: one by one, and then at once.
            for place in range(done, min(done + few, len(values))):
                self.at = first + place
                now.line(self._words(values[place]), first + place)
            done, few = done + few, 2 * few

    def _words(self, values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> Words:
        found = Words()
        for letter, value in zip(LETTERS, values.tolist(), strict=True):
            if math.isnan(value):
                continue
            if letter == "G":
                found.g["motion"] = round(value) * 10
            elif letter not in "FIJKR" and letter not in self.language.axes:
                raise Unread(f"the axis {letter}")
            else:
                found.values[letter] = value
        return found

    def _table(self, first: int, values: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> bool:
        """Whether a table of lines was done at once."""
        now = self.now
        g = values[:, 0]
        known = np.maximum.accumulate(np.where(np.isnan(g), -1, np.arange(len(g))))
        if known[0] < 0 and now.motion is None:
            return False
        code = np.where(known >= 0, g[np.maximum(known, 0)], (now.motion or 0) // 10).astype(np.int64)
        words = values[:, 1:10]
        axes = ~np.isnan(words[:, :6])
        centers = ~np.isnan(words[:, 6:]).all(axis=1) | ~np.isnan(values[:, 10])
        arcs = code >= 2
        moving = axes.any(axis=1) | (arcs & centers)
        if (centers & ~arcs).any() or (~moving & arcs & ~np.isnan(g)).any() or not moving.any():
            return False
        if any(axes[:, k].any() for k, letter in enumerate("XYZABC") if letter not in self.language.axes):
            return False
        by_center = arcs & np.isnan(values[:, 10])
        if (arcs.any() and now.plane is None) or (by_center.any() and not now.centers_known):
            return False
        fed = values[:, 11]
        named = np.maximum.accumulate(np.where(np.isnan(fed), -1, np.arange(len(fed))))
        feed = np.where(named >= 0, fed[np.maximum(named, 0)], now.feed)
        lines = np.arange(first, first + len(values))
        zero = [now.zeros.zero(axis) for axis in range(6)]
        go(now.rows, zero, now.manner(), lines[moving], code[moving], words[moving], values[moving, 10], feed[moving])
        now.motion, now.feed = int(code[-1]) * 10, float(feed[-1])
        now.waits_for_motion = False
        return True
