"""What the kernel answers: problems and remarks as codes with numbers, and a verdict for each property.

Nothing here is worded: ``verify/explain`` has a sentence for each kind. ``Proof.verdict_of`` decides.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from gproof.ir.drives import Drives
from gproof.ir.record import field, record
from gproof.ir.stream import StepStream
from gproof.ir.trace import Trace
from gproof.ir.verdict import Verdict, worst

PROPERTIES = (
    "stream-form",
    "stream-position",
    "stream-order",
    "stream-end",
    "stream-event",
    "stream-limit",
    "stream-step-rate",
    "stream-pulse",
    "stream-velocity",
    "stream-acceleration",
)
"""What is proved of a stream; docs/verification.md has the propositions."""


class Job(NamedTuple):
    """What is proved, and of what."""

    stream: StepStream
    trace: Trace
    drives: Drives


class Problem(NamedTuple):
    """What refutes a property. section, row: of the trace, -1: none; values: by kind; times: it stands for so many."""

    property: str
    kind: str
    section: int
    row: int
    values: tuple[Any, ...]
    times: int


class Remark(NamedTuple):
    """What the verdict of a property depends on, or why it is open; property: "" for all."""

    property: str
    kind: str
    values: tuple[Any, ...]


@record(slots=True)
class Proof:
    """The answer, as it grows. seen: what was followed, of a cylinder its surface unrolled, None: nothing was; steps:
    how many step pulses were checked; assumed, left_open: in the order in which they came up, each once."""

    seen: Job | None = None
    problems: list[Problem] = field(default_factory=list)
    assumed: dict[Remark, None] = field(default_factory=dict)
    left_open: dict[Remark, None] = field(default_factory=dict)
    steps: int = 0

    def refute(self, prop: str, kind: str, section: int, row: int, *values: Any, times: int = 1) -> None:
        """Add a problem."""
        self.problems.append(Problem(prop, kind, section, row, values, times))

    def leave_open(self, prop: str, kind: str, *values: Any) -> None:
        """Say that a property, "" for all, was not judged to the end."""
        self.left_open[Remark(prop, kind, values)] = None

    def assume(self, prop: str, kind: str, *values: Any) -> None:
        """Note what the verdict of a property depends on."""
        self.assumed[Remark(prop, kind, values)] = None

    def verdict_of(self, prop: str) -> Verdict:
        """UNSAFE where a problem refutes it, UNKNOWN where it was not judged to the end."""
        if any(problem.property == prop for problem in self.problems):
            return Verdict.UNSAFE
        if any(remark.property in ("", prop) for remark in self.left_open):
            return Verdict.UNKNOWN
        return Verdict.SAFE

    @property
    def verdict(self) -> Verdict:
        """The worst of all properties."""
        return worst(self.verdict_of(prop) for prop in PROPERTIES)
