"""Which outputs run the spindle, as CNC.MAC says it: its M3, or M4, switches them on and its M5 off.

The language has no code for a spindle; shops define the codes that post processors write (manual: Macro File
Configuration, whose example is an M3 that calls a file with M11C1). Nothing is taken from a definition with conditions,
braces or lines that cannot be read: what it leaves switched is not certain then, and ``output`` of the machine file
has to say it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from gproof.frontend.common.source import decode, read_source
from gproof.frontend.wincnc.line import LineError
from gproof.frontend.wincnc.notes import skip_count
from gproof.frontend.wincnc.statements import ArrayLine, Head, Lines, Parsed
from gproof.ir.dialects.wincnc.settings import WinCncSettings
from gproof.ir.finding import Refusal
from gproof.ir.program import NO_OUTPUTS, Block, Call, Number, Replaced, SourceFile, SpindleOutputs
from gproof.ir.record import field, record

_OTHERS = frozenset(("knife", "saw", "laser", "thc", "bevel", "pump"))
"""Devices of machines whose M3 may start another tool than a spindle."""
_SWITCHES = {11.0: True, 13.0: True, 12.0: False, 14.0: False}
"""M codes that switch an output (manual, M11 to M14), and which way."""
_RETURN, _ABORT = 99.0, 99.1
_MOST_LINES, _DEEPEST = 200, 5
"""A file with more lines, or with files within files within files, does more than to start a spindle."""

Switched = dict[int, bool]
"""Channels, as a definition leaves them."""


class _OpenError(Exception):
    """What a definition switches is not certain."""


@record(slots=True)
class SpindleReader:
    """Reads what CNC.MAC has for M3, M4 and M5.

    lines: as lines of jobs are read; paths: of the files that they have named, by key; is_clear: whether a file is the
    only one of its name; read: files that were opened.
    """

    lines: Lines
    paths: dict[str, Path]
    is_clear: Callable[[Path], bool]
    controls: WinCncSettings
    read: list[SourceFile] = field(default_factory=list)

    def outputs(self) -> SpindleOutputs:
        """The outputs that M3 and M4 switch on and M5 off, and those of coolant; none where that is not certain."""
        if not _OTHERS.isdisjoint(self.controls.devices or ()):
            return NO_OUTPUTS
        forward, backward = self._switched("M3", "M4", "M5")
        mist, flood = self._switched("M7", "M8", "M9")
        return SpindleOutputs(forward, backward, tuple(sorted({*mist, *flood})), tuple(sorted({*mist} - {*flood})))

    def one_way(self) -> frozenset[str]:
        """Of ``cw`` (M3) and ``ccw`` (M4) those that leave an output on by which the other one turns the spindle."""
        try:
            first, second, stopped = (self._definition(name) for name in ("M3", "M4", "M5"))
        except _OpenError:
            return frozenset()
        ends = {channel for channel, on in stopped.items() if not on} - {self.controls.auto_output}
        ways = [{channel for channel, on in way.items() if on and channel in ends} for way in (first, second)]
        if not all(ways):
            return frozenset()
        return frozenset(
            name for name, own, other in (("cw", first, ways[1]), ("ccw", second, ways[0])) if other - own.keys()
        )

    def _switched(self, one: str, other: str, stop: str) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """The outputs that each of two codes leaves on and a third one switches off; none where that is not certain."""
        try:
            first, second, stopped = (self._definition(name) for name in (one, other, stop))
        except _OpenError:
            return (), ()
        # The output that is on during feed moves is switched by these.
        ends = {channel for channel, on in stopped.items() if not on} - {self.controls.auto_output}
        begun, other_way = (tuple(sorted(c for c, on in way.items() if on and c in ends)) for way in (first, second))
        return begun, other_way

    def _definition(self, name: str) -> Switched:
        """What a code leaves switched; nothing for one that is not defined, or passed over."""
        macro = self.lines.macros.get(name)
        found: Switched = {}
        if macro is not None and macro.text:
            self._line(macro.text, macro.span.file, macro.span.line, found, 0)
        return found

    def _line(self, text: str, file: str, number: int, found: Switched, depth: int) -> bool:
        """Add what a line switches; False where it ends its file."""
        try:
            parsed = self.lines.parse(text, file, number)
        except LineError:
            raise _OpenError from None
        return self._statement(parsed, found, depth)

    def _statement(self, node: Parsed | None, found: Switched, depth: int) -> bool:
        if node is None:
            return True
        if isinstance(node, Replaced):
            return all(self._statement(one, found, depth) for one in node.body)
        if isinstance(node, Call):
            self._file(node.name, found, depth + 1)
            return True
        if isinstance(node, Head | ArrayLine) or not isinstance(node, Block):
            raise _OpenError
        codes = [word.value.value for word in node.words if word.letter == "M" and isinstance(word.value, Number)]
        if _ABORT in codes:
            raise _OpenError
        switches = [code for code in codes if code in _SWITCHES]
        if switches:
            channels = [word.value for word in node.words if word.letter == "C"]
            if len(switches) != 1 or len(channels) != 1 or len(node.words) != 2 or not isinstance(channels[0], Number):
                raise _OpenError
            found[round(channels[0].value)] = _SWITCHES[switches[0]]
        return _RETURN not in codes

    def _file(self, key: str, found: Switched, depth: int) -> None:
        path = self.paths.get(key)
        if path is None or depth > _DEEPEST or not self.is_clear(path):
            raise _OpenError
        try:
            source = read_source(path, dos=True)
        except Refusal:
            raise _OpenError from None
        self.read.append(source)
        lines = decode(bytes(source.data)).lstrip("\ufeff").splitlines()
        if len(lines) > _MOST_LINES:
            raise _OpenError
        for number, line in enumerate(lines, 1):
            if skip_count(line, self.controls.lexical):
                raise _OpenError
            if not self._line(line, source.name, number, found, depth):
                return
