"""Every spoilt stream is refused: kinds of damage, each at many random places. The bounds are in mutations.py."""

import functools
import random

import pytest
from support.campaigns import sizes
from verify.mutations import TABLE, Case, Mutation, clean
from verify.reference_stepper import machine, stream_of

from gproof.ir.setup import NOTHING
from gproof.ir.verdict import Verdict
from gproof.verify.explain.stream_report import StreamReport
from gproof.verify.stream import validate

_cache: dict[str, Case] = {}


def fresh(name: str) -> Case:
    """A clean case whose parts may be changed."""
    if name not in _cache:
        _cache[name] = clean(name)
    kept = _cache[name]
    return Case(kept.job, kept.done.copy(), kept.on)


def judge(case: Case) -> StreamReport:
    """The stream says that it is for the machine that it was made for."""
    return validate(stream_of(case.done, machine()), case.job.trace(), case.on, NOTHING)


@functools.cache
def right(name: str) -> Verdict:
    """What is said of a job that nothing was done to."""
    return judge(fresh(name)).verdict


@pytest.mark.parametrize("places", sizes(range(1), range(1, 40)))
@pytest.mark.parametrize("mutation", TABLE, ids=lambda m: m.__name__)
def test_every_spoilt_stream_is_refused(mutation: Mutation, places: range) -> None:
    names, codes = TABLE[mutation]
    for name in names:
        assert right(name) is Verdict.SAFE
        for seed in places:
            case = fresh(name)
            mutation(case, random.Random(f"{mutation.__name__} {name} {seed}"))
            report = judge(case)
            labels = {f.code.label for f in report.findings}
            where = f"{mutation.__name__} on {name}, seed {seed}: {report.findings[:3]}"
            assert report.verdict is Verdict.UNSAFE, where
            assert labels & codes, where
            assert all(any(c.isdigit() for c in f.message) for f in report.findings), where


def test_there_are_many_kinds() -> None:
    assert len(TABLE) >= 16
