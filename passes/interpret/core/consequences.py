"""What follows from a line that could not be read: one cause is reported once.

A line that is no code of the language is not executed, with its feed and its motion code. That a feed or a motion is
missing after it is the same mistake again, not another one: the job is UNSAFE by the line itself.
"""

from __future__ import annotations

from gproof.ir import codes
from gproof.ir.finding import Finding, Findings, Severity
from gproof.ir.program import Program

_NEEDS = {
    codes.FEED_MISSING.number: b"F",
    codes.INVERSE_TIME_FEED_MISSING.number: b"F",
    codes.AXIS_WORDS_UNUSED.number: b"G",
}
"""By code of a finding, the word that would have made it none."""
_LONGEST = 1 << 16


class Consequences:
    """Findings of a run that lines have caused which the frontend refused."""

    def __init__(self, program: Program, findings: Findings) -> None:
        lines: dict[str, set[int]] = {}
        for finding in findings.kept:
            if finding.severity is Severity.ERROR and finding.code.decides == "language":
                lines.setdefault(finding.span.file, set()).add(finding.span.line)
        self._words = {file.name: _words(file.data, lines[file.name]) for file in program.files if file.name in lines}

    def follows(self, finding: Finding) -> bool:
        """Whether a line before this one, in the same file, was to give what is missing here."""
        word = _NEEDS.get(finding.code.number)
        found = self._words.get(finding.span.file)
        if word is None or found is None:
            return False
        return any(word in text for line, text in found.items() if line < finding.span.line)


def _words(data: bytes, wanted: set[int]) -> dict[int, bytes]:
    """The text of some lines, in capitals."""
    found: dict[int, bytes] = {}
    begin, number = 0, 1
    for line in sorted(wanted - {0}):
        while number < line and begin >= 0:
            begin, number = data.find(b"\n", begin) + 1 or -1, number + 1
        if begin < 0:
            break
        end = data.find(b"\n", begin)
        found[line] = bytes(data[begin : min(end if end >= 0 else len(data), begin + _LONGEST)]).upper()
    return found
