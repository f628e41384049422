"""The neutral job: what is none is refused, and its text form is the job."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.each import each
from support.goldens import ROOT
from support.jobs_by_hand import PLACE, cut, job, mm, number, run

from gproof.driver.session import open_session
from gproof.driver.translation import raised
from gproof.ir.columns import Columns
from gproof.ir.job import (
    ARC_CW,
    MOVE,
    STRAIGHT,
    Choice,
    DwellFor,
    GoTo,
    Job,
    Mark,
    Moves,
    Node,
    Routine,
    SetFrame,
)
from gproof.ir.text import parse_ir, print_ir


def table(kind: int = STRAIGHT, rows: int = 1, file: int = 0, **cells: float) -> Moves:
    """A table of equal rows."""
    arrays = MOVE.empty(rows)
    arrays["kind"][:], arrays["file"][:], arrays["feed"][:] = kind, file, np.nan
    for name, value in cells.items():
        arrays[name][:] = value
    return Moves(rows=Columns(MOVE, arrays), unit="mm", span=PLACE)


def choice(*then: Node) -> Choice:
    return Choice(condition=number(1), then=then, otherwise=(), span=PLACE)


MARK, TO_IT = Mark(name="1", span=PLACE), GoTo(name="1", span=PLACE)
GOOD = {
    "nothing": (),
    "a table": (table(axes=1, to=2.5),),
    "an arc by its centre": (table(ARC_CW, centred=1, center=1.0),),
    "an arc by its radius": (table(ARC_CW, radius=-2.0),),
    "a jump out of a choice": (MARK, choice(TO_IT)),
    "a jump forward": (TO_IT, cut(x=1), MARK),
}
BAD: dict[str, tuple[tuple[Node, ...], str]] = {
    "no operation": (("G0 X1",), "no operation of a job"),  # type: ignore[dict-item]
    "a jump into a choice": ((choice(MARK), TO_IT), "cannot reach"),
    "a routine that is not there": ((run("b"),), "'b' is not there"),
    "an action of no frame": ((SetFrame(action="turn", span=PLACE),), "'turn'"),
    "a unit that there is not": ((DwellFor(time=mm(1, "minutes"), span=PLACE),), "'minutes'"),
    "a bad operation inside": ((choice(SetFrame(action="", span=PLACE)),), "''"),
    "no rows": ((table(rows=0),), "no moves"),
    "an unknown kind": ((table(5),), "unknown kind"),
    "no kind": ((table(0),), "unknown kind"),
    "no finite place": ((table(to=np.nan),), "not finite"),
    "no finite centre": ((table(ARC_CW, centred=1, center=np.inf),), "not finite"),
    "a straight move with a centre": ((table(centred=1),), "with a centre"),
    "a straight move with a radius": ((table(radius=1.0),), "with a centre"),
    "an arc without a centre": ((table(ARC_CW),), "without a centre"),
    "a file that is not there": ((table(file=1),), "file that is not there"),
    "a unit of no length": ((replace(table(), unit="deg"),), "'deg'"),
    "a plane that there is not": ((replace(table(), plane="zx"),), "'zx'"),
    "a feed per what is nothing": ((replace(table(), per="tooth"),), "'tooth'"),
}


@each("name", GOOD)
def test_what_is_a_job_is_accepted(name: str) -> None:
    Job(source="eding", files=["job"], body=GOOD[name]).verify()


@each("name", BAD)
def test_what_is_no_job_is_refused(name: str) -> None:
    body, reason = BAD[name]
    inside = {"a": Routine(name="a", body=body, span=PLACE)}
    for bad in (
        Job(source="eding", files=["job"], body=body),
        Job(source="eding", files=["job"], body=(), routines=inside),
    ):
        with pytest.raises(ValueError, match=reason):
            bad.verify()


def test_a_routine_is_listed_under_its_name() -> None:
    found = job(run(), a=[cut(x=1)])
    found.routines["b"] = found.routines.pop("a")
    with pytest.raises(ValueError, match="listed as 'b'"):
        found.verify()


CORPUS = (
    ("eding/drilled-plate/job.cnc", "eding/drilled-plate/machine.toml"),
    ("eding/parametric-bolt-circle/job.cnc", "eding/machines/bench-mill.toml"),
    ("eding/rotated-pattern/job.cnc", "eding/machines/bench-mill.toml"),
    ("eding/ask-the-operator/job.cnc", "eding/machines/bench-mill.toml"),
    ("eding/language-errors/job.cnc", "eding/machines/bench-mill.toml"),
    ("wincnc/router-atc/jobs/name-plates.tap", "wincnc/router-atc/WINCNC.INI"),
    ("wincnc/router-atc/jobs/left-or-right.tap", "wincnc/router-atc/WINCNC.INI"),
    ("mcuwin/engraver/jobs/four-plates.src", "mcuwin/engraver/McuWIN.ini"),
)


@each("path,machine", CORPUS)
def test_the_text_of_a_job_is_the_job(path: str, machine: str) -> None:
    corpus = ROOT / "corpus"
    session = open_session(corpus / path, machine=corpus / machine, setup="zero", dialect=None)
    found = raised(session)
    found.verify()
    written = print_ir(found)
    again = parse_ir(written)
    assert isinstance(again, Job)
    again.verify()
    assert again == found
    assert print_ir(again) == written
    assert Path(path).name in written
