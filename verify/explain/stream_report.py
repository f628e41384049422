"""What the stream checker answers: one verdict a property, findings with their places, the steps checked."""

from __future__ import annotations

from gproof.ir.codes import (
    STREAM_ACCELERATION,
    STREAM_END,
    STREAM_EVENT,
    STREAM_LIMIT,
    STREAM_MALFORMED,
    STREAM_ORDER,
    STREAM_POSITION,
    STREAM_PULSE,
    STREAM_STEP_RATE,
    STREAM_VELOCITY,
)
from gproof.ir.finding import Code, Finding
from gproof.ir.record import field, record
from gproof.ir.verdict import PropertyResult, Verdict, worst

CHECKER = "gproof.verify.stream"
CHECKER_VERSION = "1"

PROPERTIES: tuple[tuple[str, Code, str], ...] = (
    ("stream-form", STREAM_MALFORMED, "motors, resolutions and ticks are the machine's; every number is in range"),
    (
        "stream-position",
        STREAM_POSITION,
        "every motor within 1 step of one path point after each step (1.02 on arcs, 1.11 over a height map; its "
        "backlash more for a short time after a turn), path points never going back",
    ),
    ("stream-order", STREAM_ORDER, "no motor turns round more often between two rests than the path does"),
    ("stream-end", STREAM_END, "each section starts and ends at the steps nearest to the traced positions"),
    ("stream-event", STREAM_EVENT, "each event once, in order, at its path point, motors still for its time"),
    ("stream-limit", STREAM_LIMIT, "every position within the soft limits rounded to the nearest step"),
    (
        "stream-step-rate",
        STREAM_STEP_RATE,
        "steps of a motor at least one period of the greatest step frequency apart, less one tick of rounding",
    ),
    (
        "stream-pulse",
        STREAM_PULSE,
        "steps of a motor at least two pulse widths apart, direction changes at least the set-up time",
    ),
    (
        "stream-velocity",
        STREAM_VELOCITY,
        "|n| <= vmax h + 2 steps, and no faster than the feed, in all windows of 1, 4, 16 interpolation times",
    ),
    (
        "stream-acceleration",
        STREAM_ACCELERATION,
        "|n' - n| <= amax h (h + 2 T) + 4 steps in all neighbouring windows h of 1, 4, 16 interpolation times T",
    ),
)
"""Name, code of its refutation, bound; docs/verification.md has the propositions."""

BOUNDS = {name: bound for name, _, bound in PROPERTIES}


@record(frozen=True, slots=True, kw_only=True)
class StreamReport:
    """The answer of ``validate``.

    findings: the first of each kind, in order; counts: all, by code number; properties: in the order of
    ``PROPERTIES``; steps: how many step pulses were checked.
    """

    findings: tuple[Finding, ...]
    counts: dict[int, int]
    properties: tuple[PropertyResult, ...]
    steps: int

    @property
    def verdict(self) -> Verdict:
        """The worst of all properties."""
        return worst(p.verdict for p in self.properties)

    def result(self) -> PropertyResult:
        """All properties as the one property ``stream``."""
        assumptions = dict.fromkeys(a for p in self.properties for a in p.assumptions)
        return PropertyResult(name="stream", verdict=self.verdict, assumptions=tuple(assumptions))


@record(slots=True)
class Collector:
    """Findings while the checker runs. open: properties that could not be judged to the end, and why."""

    findings: list[Finding] = field(default_factory=list)
    counts: dict[int, int] = field(default_factory=dict)
    open: dict[str, list[str]] = field(default_factory=dict)
    assumed: dict[str, list[str]] = field(default_factory=dict)
    steps: int = 0

    def add(self, finding: Finding, times: int = 1) -> None:
        """Keep a finding that stands for ``times`` occurrences."""
        number = finding.code.number
        self.counts[number] = self.counts.get(number, 0) + times
        self.findings.append(finding)

    def leave_open(self, why: str, *names: str) -> None:
        """Say that properties (all: none named) were not judged to the end."""
        for name in names or BOUNDS:
            if why not in self.open.setdefault(name, []):
                self.open[name].append(why)

    def assume(self, name: str, what: str) -> None:
        """Note what a property's verdict stands on."""
        if what not in self.assumed.setdefault(name, []):
            self.assumed[name].append(what)

    def report(self) -> StreamReport:
        """The finished answer."""
        results = []
        for name, code, _ in PROPERTIES:
            verdict = Verdict.SAFE
            if code.number in self.counts:
                verdict = Verdict.UNSAFE
            elif name in self.open:
                verdict = Verdict.UNKNOWN
            said = (*self.assumed.get(name, ()), *(f"not judged: {why}" for why in self.open.get(name, ())))
            results.append(PropertyResult(name=name, verdict=verdict, assumptions=said))
        return StreamReport(
            findings=tuple(self.findings), counts=dict(self.counts), properties=tuple(results), steps=self.steps
        )
