"""What words the readers know, by language. What is not here is refused.

Sources: LinuxCNC user manual 2.9 (G-Codes, M-Codes, O Codes, G-Code Overview); grbl 1.1, Supported G-Codes, Interface.
Codes are numbers in tenths.
"""

from __future__ import annotations

from gproof.ir.record import record


class Unread(Exception):
    """A line that the reader does not know. line: its number; why: a reason."""

    def __init__(self, why: str, line: int = 0) -> None:
        super().__init__(why)
        self.why = why
        self.line = line


GROUPS: dict[str, tuple[int, ...]] = {
    "motion": (0, 10, 20, 30, 382, 800, 810, 820, 860),
    "plane": (170, 180, 190),
    "distance": (900, 910),
    "centers": (911,),
    "per": (930, 940, 950),
    "unit": (200, 210),
    "compensation": (400,),
    "length": (430, 431, 490),
    "retract": (980, 990),
    "offset": (540, 550, 560, 570, 580, 590, 591, 592, 593),
    "path": (610, 611, 640),
    "once": (40, 100, 280, 300, 530, 920, 921, 922, 923),
}
"""Modal groups of G codes: one of each may be on a line (Overview, Modal Groups)."""
GROUP_OF = {code: name for name, codes in GROUPS.items() for code in codes}

M_GROUPS: dict[str, tuple[int, ...]] = {
    "stop": (0, 10, 20, 300), "spindle": (30, 40, 50), "change": (60,), "coolant": (70, 80, 90),
    "overrides": (480, 490), "output": (620, 630, 640, 650, 660),
}  # fmt: skip
M_GROUP_OF = {code: name for name, codes in M_GROUPS.items() for code in codes}


MOST_CHANNEL = 63
"""The highest number of an output or input of LinuxCNC (M-Codes M62-M65, M66)."""


@record(frozen=True, slots=True, kw_only=True)
class Language:
    """title: as people write it; g, m: codes; axes: letters; structured: it has O words, variables and expressions;
    line_length: most characters that count, 0 for any; real_time: characters that it never reads as text;
    arc_needs_axis: an arc names an axis of its plane; chord_slack: mm that a chord may be longer than the diameter of
    R; arc_slack: mm that both radii of an arc may differ, whatever it is; arc_share: above that by which share;
    arc_most: never more; circle_fuzz: radians behind its start that an arc may end and go all round (both controllers'
    sources)."""

    title: str
    g: frozenset[int]
    m: frozenset[int]
    axes: str
    offsets: int
    structured: bool
    line_length: int
    real_time: str
    arc_needs_axis: bool
    chord_slack: float
    arc_slack: float
    arc_share: float
    arc_most: float
    circle_fuzz: float


LINUXCNC = Language(
    title="LinuxCNC", g=frozenset(GROUP_OF) - {431}, m=frozenset(M_GROUP_OF), axes="XYZABC", offsets=9,
    structured=True, line_length=255, real_time="", arc_needs_axis=False, chord_slack=1e-4, arc_slack=0.00127,
    arc_share=0.001, arc_most=0.127, circle_fuzz=1e-6,
)  # fmt: skip
"""Arcs: Overview and G-Codes G2 G3; the tolerances are those that the controller has without an entry in its INI."""

GRBL = Language(
    title="grbl 1.1",
    g=frozenset((
        0, 10, 20, 30, 382, 800, 170, 180, 190, 900, 910, 911, 930, 940, 200, 210, 400, 431, 490, 540, 550, 560, 570,
        580, 590, 610, 40, 100, 280, 300, 530, 920, 921,
    )),
    m=frozenset((0, 20, 300, 30, 40, 50, 80, 90)), axes="XYZ", offsets=6, structured=False, line_length=79,
    real_time="?!~", arc_needs_axis=True, chord_slack=0.0, arc_slack=0.005, arc_share=0.001, arc_most=0.5,
    circle_fuzz=5e-7,
)  # fmt: skip
