"""What the stream checker answers: one verdict a property, findings with their places, the steps checked."""

from __future__ import annotations

from dataclasses import replace

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
from gproof.ir.machine import Machine
from gproof.ir.record import record
from gproof.ir.setup import Setup
from gproof.ir.trace import Trace
from gproof.ir.verdict import PropertyResult, Verdict, worst
from gproof.verify.explain.stream_words import Words
from gproof.verify.kernel.proof import Proof

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
_CODES = {name: code for name, code, _ in PROPERTIES}


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


def report_of(proof: Proof, trace: Trace, machine: Machine, setup: Setup) -> StreamReport:
    """The report of a proof of these."""
    words = Words(proof.seen, trace, machine, setup)
    charged = replace(proof, problems=[words.charged(problem) for problem in proof.problems])
    findings, counts = [], dict[int, int]()
    for problem in charged.problems:
        code = _CODES[problem.property]
        counts[code.number] = counts.get(code.number, 0) + problem.times
        findings.append(code.at(words.place(problem), what=words.what(problem)))
    results = []
    for name in BOUNDS:
        said = dict.fromkeys(words.remark(remark) for remark in proof.assumed if remark.property == name)
        open_ = dict.fromkeys(words.remark(one) for one in proof.left_open if one.property in ("", name))
        assumptions = (*said, *(f"not judged: {why}" for why in open_))
        results.append(PropertyResult(name=name, verdict=charged.verdict_of(name), assumptions=assumptions))
    return StreamReport(findings=tuple(findings), counts=counts, properties=tuple(results), steps=proof.steps)
