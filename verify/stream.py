"""Stream validation: from the StepStream, the Trace, the Machine and the Setup alone.

``validate`` takes from Machine and Setup what bounds the motors; ``verify/kernel`` proves, ``verify/explain`` says what
came of it. The propositions, their bounds and what they do not say are in docs/verification.md.
"""

from __future__ import annotations

from collections.abc import Callable, Collection

from gproof.ir.machine import Machine
from gproof.ir.machine_drives import drives_of
from gproof.ir.setup import Setup
from gproof.ir.stream import StepStream
from gproof.ir.trace import Trace
from gproof.verify.explain.stream_report import StreamReport, report_of
from gproof.verify.kernel.prove import prove, refused


def validate(
    stream: StepStream,
    trace: Trace,
    machine: Machine,
    setup: Setup,
    *,
    override: float = 1.0,
    stretched: bool = False,
    sections: Collection[int] | None = None,
    beat: Callable[[int], None] | None = None,
    pure: bool = False,
) -> StreamReport:
    """Judge a stream; never raises for a bad one.

    override: the highest feed override the stream may contain; stretched: the time in which backlash is taken up is
    not bounded, as in a section whose time the runtime has stretched; sections: only those (None: all), as when it
    has retimed one of them; beat: called now and then with the number of steps checked so far, and may raise; pure:
    nothing is compiled, and numba is not imported: slow.
    """
    try:
        machine.verify()
    except ValueError as error:
        return report_of(refused(type(machine).__name__, str(error)), trace, machine, setup)
    proof = prove(
        stream, trace, drives_of(machine, setup), override=override, stretched=stretched, sections=sections, beat=beat,
        pure=pure,
    )  # fmt: skip
    return report_of(proof, trace, machine, setup)
