"""Feed and speed overrides, M48 to M53. Eding CNC manual 3.5.5.

M48 and M49 say whether the operator's switches act; gproof takes those at 100%. M50 to M52 change the feed or the speed
by a factor of their own, and the manual gives no unit for it (1 or 100 for "as programmed"): from there on
feeds, or speeds, are not known.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import Unknown, bounds
from gproof.ir.trace import Op
from gproof.passes.interpret.core.parsed_line import Line
from gproof.passes.interpret.eding.ambiguous_words import owned

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run


def overrides(run: Run, line: Line) -> None:
    """Step 9 of table 3-7."""
    s = run.modal
    for rule in line.rules:
        if rule.function in (F.OVERRIDES_ON, F.OVERRIDES_OFF):
            s.overrides = rule.function is F.OVERRIDES_ON
        elif rule.function in (F.FEED_OVERRIDE, F.SPEED_OVERRIDE):
            _set(run, line, rule)
        elif rule.function is F.FEED_OVERRIDE_INPUT:
            s.feed_input = _switch(line, rule)
            if s.feed_input:
                run.findings.add(
                    codes.OVERRIDE_FACTOR.at(line.where_code(rule), code=rule.text, what="feeds follow an input")
                )
        elif rule.function is F.FEED_HOLD_INPUT:
            _switch(line, rule)  # the feed may be held, which moves nothing
        else:
            continue
        run.state_changed()
        run.event(Op.OVERRIDE, line.span, arg=(float(s.overrides), 0.0))


def _set(run: Run, line: Line, rule: CodeRule) -> None:
    s = run.modal
    owned(line, rule, "P")
    value = line.values.get("P")
    line.used.add("P")
    if value is None:
        raise Refusal(codes.WORD_MISSING.at(line.where_code(rule), code=rule.text, needed="P"))
    if bounds(value)[1] < 0:
        # M50: "the value remains as is"; M51: the override is off, so the speed is the programmed one.
        s.speed_override_known = s.speed_override_known or rule.function is F.SPEED_OVERRIDE
        return
    what = (
        f"P depends on {value.cause}, whose value is unknown"
        if isinstance(value, Unknown)
        else f"the manual does not say whether P1 or P100 leaves it as it is, and so what P{value:g} does"
    )
    run.findings.add(codes.OVERRIDE_FACTOR.at(line.where("P"), code=rule.text, what=what))
    if rule.function is F.FEED_OVERRIDE:
        s.feed_override = math.nan
    else:
        s.speed_override_known = False
        if s.spindle_direction:
            run.spindle_row(line)


def _switch(line: Line, rule: CodeRule) -> bool:
    """P1, the same without P, or P0."""
    owned(line, rule, "P")
    value = line.number("P")
    if value not in (None, 0.0, 1.0):
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where("P"), code=f"{rule.text} P{value:g}"))
    return value != 0.0
