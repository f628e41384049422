"""More than 60 kinds of wrong translation, planted in the target's text: each is refused, and for the right reason.

A kind is an edit of a target that was proven to mean the same as its source. UNSAFE where the two can be seen to
differ; UNKNOWN where the edit takes away what a proof rests on.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from verify.translation.support import STRAIGHT, Shop

from gproof.ir.verdict import Verdict
from gproof.verify.translation.words import sentence
from verify.translation import test_dialects as three

FULL = """\
G21 G90 G17 G94
G54
G64 P0.1
M3 S8000
M7
G0 Z20
G0 X10 Y10
G1 Z-1 F100
G2 X20 Y20 I10 J0 F200
G3 X20 Y20 I0 J5 Z-2
G1 X40 Y20 F300
G4 P0.5
M54 P1
G1 X60 Y20
M55 P1
G0 Z20
G18
G1 X60 F150
G2 X70 Z10 I0 K-10
G17
G55
G0 X5 Y5
G54
G92 X0
G1 X7 F120
G92.1
M49
G1 X9
M48
M9
M5
M6 T2
G43
M4 S500
G0 Z5
G81 X3 Y3 Z-4 R1 F90
X6
G80
G41 D2
G1 X20 Y0 F80
G1 X40 Y0
G40
G1 X50 Y10
M0
M56 P3 L1 Q4
M56 P4
IF [#5399 == 1] THEN
G0 X1
ELSE
G0 X2
ENDIF
G38.2 Z-20 F50
G92 Z3
G0 Z20
#1=0
WHILE [#1 < 3]
G91 G1 X4 F70
G90 G0 X0
#1=[#1+1]
ENDWHILE
G93 G1 X30 F2
G94 G1 X32 F60
G92.1
M30
"""

Edit = tuple[str, str]
KINDS: dict[str, tuple[Edit, str]] = {
    "sign of a coordinate": (("G1 X60 Y20\n", "G1 X-60 Y20\n"), "place"),
    "sign of a depth": (("G1 Z-1 F100", "G1 Z1 F100"), "place"),
    "two axes changed for one another": (("G1 X60 Y20\n", "G1 X20 Y60\n"), "place"),
    "unit": (("G1 X60 Y20\n", "G20\nG1 X60 Y20\nG21\n"), "place"),
    "unit of a number": (("G1 X60 Y20\n", "G1 X6.0 Y20\n"), "place"),
    "a rounded number": (("G1 X60 Y20\n", "G1 X60.0001 Y20\n"), "place"),
    "distance mode": (("G1 X60 Y20\n", "G91\nG1 X60 Y20\nG90\n"), "place"),
    "distance mode that stays": (("G90 G0 X0\n", "G0 X0\n"), ""),
    "sense of an arc": (("G2 X20 Y20 I10 J0", "G3 X20 Y20 I10 J0"), "sense"),
    "sense of a full circle": (("G3 X20 Y20 I0 J5 Z-2", "G2 X20 Y20 I0 J5 Z-2"), "sense"),
    "centre": (("I0 J5 Z-2", "I0 J5.01 Z-2"), "center"),
    "centre absolute": (("I10 J0 F200", "I20 J10 F200"), ""),
    "no rise of a helix": (("I0 J5 Z-2", "I0 J5"), "place"),
    "a full circle that is lost": (("G3 X20 Y20 I0 J5 Z-2\n", "G1 Z-2\n"), "kind"),
    "an arc as a line": (("G2 X20 Y20 I10 J0 F200", "G1 X20 Y20 F200"), "kind"),
    "plane": (("G18\n", "G17\n"), ""),
    "plane of an arc turned": (("G2 X70 Z10", "G3 X70 Z10"), "sense"),
    "a rapid that cuts": (("G0 X5 Y5\n", "G1 X5 Y5\n"), "kind"),
    "a cut that is rapid": (("G1 X7 F120\n", "G0 X7\n"), "kind"),
    "feed": (("F300", "F301"), "feed"),
    "feed in inches": (("G1 X7 F120\n", "G1 X7 F4.724\n"), "feed"),
    "feed that is lost": (("G1 X60 F150\n", "G1 X60\n"), ""),
    "feed of a cycle": (("R1 F90", "R1 F80"), "feed"),
    "inverse time as feed": (("G93 G1 X30 F2\n", "G1 X30 F2\n"), "feed"),
    "feed a minute as inverse time": (("G94 G1 X32 F60\n", "G1 X32 F60\n"), "feed"),
    "dwell that is lost": (("G4 P0.5\n", ""), "dwell lost"),
    "dwell in other units": (("G4 P0.5\n", "G4 P500\n"), "dwell"),
    "dwell that is doubled": (("G4 P0.5\n", "G4 P0.5\nG4 P0.5\n"), "dwell"),
    "dwell that is moved": (("G4 P0.5\nM54 P1\nG1 X60 Y20\n", "M54 P1\nG1 X60 Y20\nG4 P0.5\n"), ""),
    "spindle direction": (("M3 S8000", "M4 S8000"), "spindle"),
    "spindle speed": (("M3 S8000", "M3 S800"), "spindle"),
    "spindle that is lost": (("M3 S8000\n", ""), ""),
    "spindle that starts late": (("M4 S500\nG0 Z5\n", "G0 Z5\nM4 S500\n"), "event moved"),
    "spindle that stops": (("M4 S500\n", "M4 S500\nM5\n"), "spindle added"),
    "mist for flood": (("M7\n", "M8\n"), "coolant"),
    "coolant that is lost": (("M7\n", ""), "coolant lost"),
    "coolant that stays on": (("M9\n", ""), ""),
    "channel off by one": (("M54 P1\n", "M54 P2\n"), "output"),
    "channel on for off": (("M55 P1\n", "M54 P1\n"), "output lost"),
    "output that is lost": (("M54 P1\n", ""), "output lost"),
    "output before the move": (("G1 X60 Y20\nM55 P1\n", "M55 P1\nG1 X60 Y20\n"), "event moved"),
    "a line that is lost": (("G1 X60 Y20\n", ""), ""),
    "a line that is doubled": (("G91 G1 X4 F70\n", "G91 G1 X4 F70\nG1 X4\n"), ""),
    "a retract that is lost": (("M55 P1\nG0 Z20\n", "M55 P1\n"), ""),
    "lines changed for one another": (("G0 X5 Y5\nG54\n", "G54\nG0 X5 Y5\n"), "place"),
    "another coordinate system": (("G55\n", "G56\n"), "place"),
    "a coordinate system that is not restored": (("G0 X5 Y5\nG54\n", "G0 X5 Y5\n"), "place"),
    "an offset that is lost": (("G92 X0\n", ""), "place"),
    "an offset of another axis": (("G92 X0\n", "G92 Y0\n"), "place"),
    "an offset that is not taken back": (("F120\nG92.1\n", "F120\n"), "place"),
    "an offset that is left": (("F60\nG92.1\n", "F60\n"), "offset left"),
    "an offset as a number": (("G92 Z3\nG0 Z20\n", "G0 Z37\n"), "place"),
    "a machine place for one of the work": (("G0 X5 Y5\n", "G53 G0 X5 Y5\n"), "place"),
    "path mode": (("G64 P0.1\n", "G61\n"), "path_mode"),
    "tolerance of the path": (("G64 P0.1\n", "G64 P0.2\n"), "path_mode"),
    "overrides that act": (("M49\n", ""), "overrides"),
    "overrides that stay off": (("M48\nM9\n", "M9\n"), "overrides"),
    "another tool": (("M6 T2\n", "M6 T3\n"), "tool"),
    "a tool change that is lost": (("M6 T2\n", ""), ""),
    "tool length that is lost": (("G43\n", ""), "place"),
    "side of the contour": (("G41 D2", "G42 D2"), "place"),
    "compensation that is lost": (("G41 D2\n", ""), "place"),
    "a stop that is lost": (("M0\n", ""), ""),
    "a stop before a move": (("G1 X50 Y10\nM0\n", "M0\nG1 X50 Y10\n"), ""),
    "an optional stop": (("M0\n", "M1\n"), "stop"),
    "another input": (("M56 P3 L1", "M56 P5 L1"), "input"),
    "input off for on": (("M56 P3 L1", "M56 P3 L2"), "input"),
    "the wrong branch": (("[#5399 == 1]", "[#5399 == 0]"), ""),
    "branches changed for one another": (("G0 X1\nELSE\nG0 X2\n", "G0 X2\nELSE\nG0 X1\n"), "place"),
    "a branch for all": (("IF [#5399 == 1] THEN\nG0 X1\nELSE\nG0 X2\nENDIF\n", "G0 X1\n"), "one question"),
    "the channel of a question": (("M56 P4\n", "M56 P5\n"), "condition"),
    "depth of a probe move": (("G38.2 Z-20", "G38.2 Z-21"), "place"),
    "a probe move as a feed move": (("G38.2 Z-20 F50", "G1 Z-20 F50"), ""),
    "one pass less": (("[#1 < 3]", "[#1 < 2]"), ""),
    "one pass more": (("[#1 < 3]", "[#1 <= 3]"), ""),
    "return height of a cycle": (("G81 X3", "G99 G81 X3"), "place"),
    "a hole that is lost": (("X6\nG80\n", "G80\n"), ""),
    "an end before the end": (("G93 G1 X30 F2\n", "M30\n"), ""),
    "an end that resets less": (("M30\n", "M2\n"), ""),
    "a line that is refused": (("G1 X60 Y20\n", "G1 X60 Y20 Q1 Q2\n"), ""),
}  # fmt: skip
"""By name the edit, and what it is found as, "" where several are right."""

WINCNC_KINDS: dict[str, tuple[Edit, str]] = {
    "a local zero for this job only": (("G90\nS8000", "G92.2 X5\nG90\nS8000"), "place"),
    "milliseconds": (("G4X0.5", "G4X500"), "dwell"),
    "F of lines for an arc": (("J0 F200", "J0"), "feed unknown"),
    "the spindle's output off by one": (("M11C2", "M11C3"), ""),
    "the spindle stays on": (("M12C2\n", ""), ""),
    "the other line is skipped": (("M17.1C3", "M18.1C3"), "move lost"),
    "two lines for one that is skipped": (("M17.1C3\nG0 X0\n", "M17.1C3\nG91\nG0 X0\nG90\n"), ""),
    "an input of another number": (("M17.1C3", "M17.1C4"), "condition"),
    "a wait for a time": (("G4\n", "G4X1\n"), ""),
    "inches": (("G90\n", "G90\nG20\n"), "place"),
    "the speed comes late": (("S8000\nM11C2\n", "M11C2\nS8000\n"), ""),
    "L92 is missing after G92": (("G0 X0\nG4\n", "G92 X0\nG0 X0\nG4\n"), ""),
}  # fmt: skip
MCUWIN_KINDS: dict[str, tuple[Edit, str]] = {
    "G92 as a name of the place": (("G90 G71\n", "G90 G71\nG92 X0 Y0 Z0\n"), "place"),
    "G21 as millimetres": (("G90 G71\n", "G90 G71 G21\n"), ""),
    "inches": (("G90 G71\n", "G90 G70\n"), ""),
    "a feed after the arc": (("F200\nG01 X40 F100", "F200\nG01 X40"), "feed"),
    "an output that motion does not stop for": (("M26 101\nG04 0\n", "M26 101\n"), "output timing"),
    "the output of another axis": (("M26 101", "M26 201"), "output"),
    "all outputs of the axis": (("M27 101", "M27 100"), "output"),
    "the input of another axis": (("X.digib.3", "Y.digib.3"), "condition"),
    "not": (("(X.digib.3)", "(not (X.digib.3))"), "move lost"),
    "absolute centres": (("I10 J0", "I20 J10"), ""),
    "G54 of another table": (("G90 G71\n", "G90 G71 G54\n"), "place"),
    "spindle without a speed": (("S8000 M03", "M03"), ""),
}  # fmt: skip


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Shop:
    return Shop(Path(tmp_path_factory.mktemp("shop")))


def test_there_are_sixty() -> None:
    assert len(KINDS) >= 60


def test_the_clean_target_is_proven(shop: Shop) -> None:
    answer = shop.compared(FULL, "; the same\n" + FULL)
    assert answer.verdict is Verdict.SAFE, answer


def refused(shop: Shop, source: str, target: tuple[str, ...], edit: Edit, kind: str, terms: object) -> None:
    old, new = edit
    assert target[0].count(old) >= 1
    wrong = (target[0].replace(old, new, 1), *target[1:])
    answer = shop.compared(source, wrong, terms)  # type: ignore[arg-type]
    assert answer.verdict is not Verdict.SAFE, answer
    assert answer.verdict is (Verdict.UNSAFE if answer.differences else Verdict.UNKNOWN)
    kept = answer.differences or answer.unknown
    assert not kind or kept[0].kind == kind, answer
    words = [sentence(found, is_open=not answer.differences) for found in kept]
    assert all(len(text) > 8 and "{" not in text for text in words), words
    assert kept[0].source is not None and kept[0].target is not None


@pytest.mark.parametrize("name", KINDS)
def test_a_wrong_target_is_refused(shop: Shop, name: str) -> None:
    refused(shop, FULL, (FULL,), *KINDS[name], STRAIGHT)


@pytest.mark.parametrize("name", WINCNC_KINDS)
def test_a_wrong_target_for_wincnc_is_refused(shop: Shop, name: str) -> None:
    refused(shop, three.EDING, (three.WINCNC, "wincnc"), *WINCNC_KINDS[name], three.TO_WINCNC)


@pytest.mark.parametrize("name", MCUWIN_KINDS)
def test_a_wrong_target_for_mcuwin_is_refused(shop: Shop, name: str) -> None:
    refused(shop, three.EDING, (three.MCUWIN, "mcuwin", three.DIN), *MCUWIN_KINDS[name], three.TO_MCUWIN)
