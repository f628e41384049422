"""The answer of ``gproof fit`` for a job that is read: with its work offsets open, and as the setup states them."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from typing import Any

from gproof.driver.fit.answer import Fit, Travel, fit_of, travel_of
from gproof.driver.fit.open_offsets import opened
from gproof.driver.fit.zones import ZoneWatch
from gproof.driver.judge import Judgement, judge
from gproof.driver.progress import Watcher
from gproof.driver.session import Running, Session
from gproof.ir.record import record
from gproof.ir.verdict import Verdict


@record(frozen=True, slots=True, kw_only=True)
class Fitted:
    """All that a report is made from. judgement: of the job with its offsets open; stated: with those stated."""

    session: Session
    judgement: Judgement
    stated: Judgement | None
    fit: Fit
    travel: tuple[Travel, ...] | None


def fit_session(session: Session, running: Running, shown: Watcher | None = None) -> Fitted:
    """The answer for a job that is read.

    Where no region near zones is found, the one side of them that ``check`` finds is the answer, if it does.
    """
    seen: dict[str, Any] = {}
    if shown is not None and shown.wanted:
        shown.phase("fitting", None if session.program is None else session.program.line_count)
        seen = {"observe": shown.see, "beat": shown.beat}
    other, asked = opened(session)
    watch = ZoneWatch(asked)
    judged = judge(other, running=running, hears=watch, **seen)
    stated = judge(session, running=running, **seen) if asked.anything and session.program is not None else None
    if shown is not None:
        shown.phase("searching work zeros")
    fit = fit_of(session.machine, asked, judged, stated, watch)
    if fit.kind == "unknown" and fit.reason:
        again = judge(opened(session)[0], running=running)
        one_side = fit_of(session.machine, asked, again, stated, ZoneWatch(asked))
        if one_side.kind == "ranges":
            fit, judged = dataclasses.replace(one_side, complete=False), again
    travel = travel_of(session.machine, asked, judged)
    if travel is None and stated is not None:
        travel = travel_of(session.machine, asked, stated)
    return Fitted(session=session, judgement=judged, stated=stated, fit=fit, travel=travel)


def of_machines(verdicts: Iterable[Verdict]) -> Verdict:
    """Of several machines: SAFE where one takes the job, UNKNOWN where one may."""
    seen = set(verdicts)
    return next((one for one in (Verdict.SAFE, Verdict.UNKNOWN) if one in seen), Verdict.UNSAFE)
