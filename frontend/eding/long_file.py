"""Jobs so long that the controller executes them from the disk, without flow control (Eding CNC manual 4.01, 2.1.14).

From SuperLongFileModeCriterion on a job can have no while, if and subroutines, and what the controller does with
one the manual does not say. What macro.cnc holds, such as the change of tools, still runs.
"""

from __future__ import annotations

from gproof.ir import codes
from gproof.ir.finding import Findings
from gproof.ir.program import Call, If, Program, While

USUAL = 20_000.0
"""kB from which on the manual calls this mode required; what counts where no file states the criterion."""
_BYTES = 1000
"""Of a kB: the manual does not say whether 1000 or 1024, and the smaller one tells of more."""


def judge_length(program: Program, criterion: float | None, findings: Findings) -> None:
    """GP113 at the first flow control of a job that is longer than ``criterion`` kB; None: not stated."""
    source = program.files[0]
    allowed = USUAL if criterion is None else criterion
    size = len(source.data) / _BYTES
    if size <= allowed:
        return
    places = [(node.span, _name(node)) for node in program.body if isinstance(node, If | While | Call)]
    places += [(sub.span, "sub") for sub in program.subprograms.values()]
    own = [(span, name) for span, name in places if span.file == source.name]
    if not own:
        return
    span, name = min(own, key=lambda place: place[0].line)
    what = f"{name} in a file of {size:g} kB, which runs in super long file mode from {allowed:g} kB on (2.1.14)"
    hint = (
        "state super_long_file of [controller]: from how many kB"
        if criterion is None
        else "write the lines without flow control"
    )
    findings.add(codes.UNSUPPORTED_CODE.at(span, code=what, hint=hint))


def _name(node: If | While | Call) -> str:
    return "if" if isinstance(node, If) else "while" if isinstance(node, While) else "gosub"
