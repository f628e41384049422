"""What each part of ``ControlFlow`` has: the run, and the flow that holds the other parts."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gproof.passes.interpret.core.control_flow import ControlFlow


class FlowPart:
    """A part of ``ControlFlow``, which knows one thing."""

    def __init__(self, flow: ControlFlow) -> None:
        self.flow = flow
        self.run = flow.run
