"""What moves nothing and changes no place: an event with the text of the command."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gproof.ir.rules import CodeRule
from gproof.ir.symbolic import Unknown
from gproof.ir.trace import Op

if TYPE_CHECKING:
    from gproof.passes.interpret.wincnc.command import Command
    from gproof.passes.interpret.wincnc.state import (
        WinCncRun,
    )


def note(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """What moves nothing and changes no place: an event with the command's text."""
    words = " ".join(f"{k}{'?' if isinstance(v, Unknown) else format(v, 'g')}" for k, v in line.values.items())
    texts = " ".join(text.value for text in line.texts.values())
    run.event(Op.DEVICE, line.span, text=run.text_number(" ".join(f"{rule.text} {words} {texts}".split())))
