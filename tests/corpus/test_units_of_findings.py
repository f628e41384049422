"""Everything that a person reads follows ``--units``: the texts of all findings that the programs of docs/codes give.

A text in inches is the one in millimetres with every length divided by 25.4, and nothing else: seen by comparing the
two number by number, knowing nothing of how they came about.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from corpus.pages import FOLDERS, dialects, settings
from support.campaigns import share
from support.each import each

from gproof.cli.main import main
from gproof.ir.codes import CODES
from gproof.ir.finding import Finding, Findings, pattern
from gproof.report.units import INCH, MM

NUMBER = re.compile(r"(?<![\w.#$])[XYZ]?-?\d+(?:\.\d+)?(?:e-?\d+)?")
BOTH = ("in mm or in inches", "millimetres")
"""Words about units that are no lengths."""
ROUNDED = re.compile(r"\d\.\d{3,4}(?!\d)(?! degrees| s\b| decimals| deg\b)")
"""Lengths are told with three or four decimals."""
PLACES = {310}
"""Codes whose places have no unit behind them."""
NOT_MM = {
    # Numbers of the program, in its own unit.
    217, 263, 267,
    # The second number of degrees.
    408,
}  # fmt: skip


def texts(finding: Finding) -> list[tuple[str, str]]:
    """What is read of a finding, in millimetres and in inches."""
    pairs = [(MM.message(finding), INCH.message(finding)), (finding.hint, INCH.sentence(finding.hint))]
    return pairs + [(other.message, INCH.sentence(other.message)) for other in finding.related]


def require_same_in_inches(mm: str, inch: str, number: int) -> None:
    """AssertionError unless ``inch`` says of lengths what ``mm`` says."""
    for words in BOTH:
        mm, inch = mm.replace(words, ""), inch.replace(words, "")
    assert not re.search(r"\d ?mm\b", inch), (mm, inch)
    assert NUMBER.sub("#", inch).replace("# inch", "# mm") == NUMBER.sub("#", mm), (mm, inch)
    for one, other in zip(NUMBER.finditer(mm), NUMBER.finditer(inch), strict=True):
        before, after = (float(n[0].lstrip("XYZ")) for n in (one, other))
        places = len(other[0].partition(".")[2])
        is_length = (" mm" in mm or number in PLACES) and abs(
            after - before / 25.4
        ) <= 0.51 * 10.0**-places + 1e-5 * abs(after)
        assert is_length or one[0] == other[0], (mm, inch)
        if re.match(r" mm\b", mm[one.end() :]) or (" mm" in mm and ROUNDED.search(mm[one.start() : one.end() + 9])):
            assert is_length or number in NOT_MM, (one[0], mm, inch)


@pytest.mark.parametrize("folder", share(FOLDERS, 4), ids=lambda folder: folder.name)
def test_texts_of_the_examples(folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    found: list[Findings] = []

    def keep(findings: Findings, **_: Any) -> None:
        found.append(findings)

    monkeypatch.setattr("gproof.report.summary.print_findings", keep)
    for dialect in dialects(folder)[:1]:
        run = settings(folder, dialect, "bad")
        words = ["check", str(folder / run["program"]), "--machine", str(folder / run["machine"]), *run["options"]]
        if run["command"] != "check" or run["setup"] == "none":
            continue
        setup = run["setup"]
        main([*words, "--setup", setup if setup == "zero" else str(folder / setup), "--units", "inch"])
    for finding in (finding for findings in found for finding in findings.kept):
        for mm, inch in texts(finding):
            require_same_in_inches(mm, inch, finding.code.number)
        # Groups of reports that people read are found by the pattern of their messages.
        assert pattern(INCH.message(finding)) == pattern(finding.message).replace("# mm", "# inch")


PLAIN = frozenset((
    "seconds", "degrees", "digits", "factor", "rpm", "value", "moves", "lines", "line", "last", "times", "number",
    "tool", "budget", "highest", "steps", "low", "high", "velocity", "needed", "allowed", "feed", "x", "y", "other",
    "position", "offset", "r", "depth", "top", "over",
))  # fmt: skip
"""Names of numbers in templates that speak of no unit."""


@each("number", CODES)
def test_templates(number: int) -> None:
    """A number with a format is a length that is converted, or of another kind; a unit stands behind a number."""
    template = CODES[number].template
    numbers = set(re.findall(r"\{(\w+):[^}]*[fg]\}", template))
    finding = CODES[number].at
    assert finding is not None
    if "mm" not in template and "{unit}" not in template and "X{x:" not in template:
        assert numbers <= PLAIN
        return
    assert not re.search(r"(?<!\}) mm\b", template)
