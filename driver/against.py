"""``gproof verify PACKAGE --against SOURCE``: the source compiled again, and the first part in which they differ.

A signature says who made a package; this shows that it is what the source gives, part by part, by the very code of
``gproof compile``. Names of files are not compared: a job is the same wherever it is.
"""

from __future__ import annotations

import dataclasses
import json
import tempfile
from collections.abc import Callable
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from gproof.driver.escape import shown
from gproof.driver.pipeline import Compiled, Request, compile_job
from gproof.driver.progress import Watcher
from gproof.driver.session import Running
from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.finding import Finding, Span
from gproof.ir.record import record
from gproof.ir.trace import Trace
from gproof.ir.verdict import DEFAULT_POLICY, Verdict
from gproof.passes.checks.registry import added
from gproof.verify.certificate.package import EVENT_TABLE, TRACE_TABLE, Package, parts_of, read_package, run_table
from gproof.verify.explain.stream_report import BOUNDS

_BODY = ("policy", "properties", "not_judged", "assumptions", "steps", "duration_ticks", "reference")


@record(frozen=True, slots=True, kw_only=True)
class Against:
    """What to compile: a program, with machine, setup, dialect and how far it is executed as ``gproof compile`` takes
    them."""

    source: Path
    machine: Path
    setup: str | None
    dialect: str | None
    running: Running


Why = Callable[[Compiled], str]
"""The first line of what ``gproof compile`` says of a job of which it makes no package."""


def other_than_anew(package: Package, of: Against, why: Why) -> list[Finding]:
    """GP851 with the first part that differs, GP852 where that has no answer; none: all parts are the same."""
    from importlib.metadata import version

    where = Span(package.path, 0)
    made, said = _compiled(package, of, why)
    if isinstance(made, Verdict):
        code = codes.CERTIFICATE_NOT_ANEW if made is Verdict.UNKNOWN else codes.CERTIFICATE_AGAINST
        return [code.at(where, what=f"{shown(of.source)} does not compile now ({made.value}): {said}")]
    difference = _first(package, made)
    if not difference:
        return []
    by, here = str(package.body.get("gproof")), version("gproof")
    if by == here:
        return [
            codes.CERTIFICATE_AGAINST.at(where, what=f"{shown(of.source)} compiles to another package: {difference}")
        ]
    what = f"{shown(of.source)} compiles to another package with gproof {here} instead of {shown(by)}: {difference}"
    return [codes.CERTIFICATE_NOT_ANEW.at(where, what=what)]


def _compiled(package: Package, of: Against, why: Why) -> tuple[Package | Verdict, str]:
    """The package that the source gives now; or the verdict that keeps it from one, and the first line of why."""
    listed = package.body.get("properties")
    names = [one.get("name") for one in listed if isinstance(one, dict)] if isinstance(listed, list) else []
    also = tuple(name for name in added() if name in names and name not in DEFAULT_POLICY)
    with tempfile.TemporaryDirectory(prefix="gproof-") as folder:
        request = Request(
            job=of.source, machine=of.machine, setup=of.setup, dialect=of.dialect, running=of.running,
            output=Path(folder) / "anew.gpx", unsigned=True, also=also,
        )  # fmt: skip
        made = compile_job(request, Watcher())
        if made.package is None:
            return Verdict.UNSAFE if made.verdict is Verdict.UNSAFE else Verdict.UNKNOWN, shown(why(made))
        return read_package(request.output), ""


def _first(said: Package, made: Package) -> str:
    """The first part that differs, in words; an empty text when there is none."""
    ours, theirs = (parts_of(p.machine, p.setup, _placeless(p.trace), p.stream) for p in (made, said))

    def text(name: str) -> str:
        return _line(name, theirs[name].decode(), ours[name].decode()) if ours[name] != theirs[name] else ""

    if found := text("machine.ir") or text("setup.ir"):
        return found
    # Rows before the tables that they point into: a row has a line of the program.
    for one, other in zip(said.trace.sections, made.trace.sections, strict=False):
        if found := _row(TRACE_TABLE, one.number, "row", one.rows, other.rows):
            return found
    if found := text("trace.ir") or text("stream.ir"):
        return found
    for part, anew in zip(said.stream.sections, made.stream.sections, strict=True):
        for motor, (runs, new) in enumerate(zip(part.runs, anew.runs, strict=True)):
            if found := _row(run_table(motor), part.number, "run", runs, new):
                return found
        if found := _row(EVENT_TABLE, part.number, "event", part.events, anew.events):
            return found
    return _body(said.body, made.body)


def _placeless(trace: Trace) -> Trace:
    return dataclasses.replace(trace, files=[str(number) for number in range(len(trace.files))])


def _line(name: str, said: str, made: str) -> str:
    for number, (one, other) in enumerate(zip_longest(said.splitlines(), made.splitlines(), fillvalue=""), 1):
        if one != other:
            at = next(
                (k for k, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), min(len(one), len(other))
            )
            begin = max(0, at - 20)
            return f"{name} differs in line {number}: {_short(one[begin:])}, now {_short(other[begin:])}"
    return f"{name} differs in its line ends"


def _row(name: str, section: int, what: str, said: Columns, made: Columns) -> str:
    """The first row that is another one, counted from 0 in its section, with the column; of a Trace the line of the
    program too."""
    where = f"section {section}, "
    rows = min(len(said), len(made))
    columns = said.schema.columns
    firsts = [(_unlike(said[c.name][:rows], made[c.name][:rows]), n) for n, c in enumerate(columns)]
    at, column = min(firsts)
    if at < rows:
        line = f" (line {int(said['line'][at])})" if "line" in (c.name for c in columns) else ""
        key = columns[column].name
        return f"{name} differs in {where}{what} {at}{line}: {key} {said[key][at]}, now {made[key][at]}"
    if len(said) != len(made):
        return f"{name} has {len(said)} {what}s in section {section}, now {len(made)}"
    return ""


def _unlike(said: np.ndarray[Any, Any], made: np.ndarray[Any, Any]) -> int:
    """Index of the first row that is not the same, bit by bit; their number when all are."""
    if not len(said):
        return 0
    one, other = (np.ascontiguousarray(a).view(np.uint8).reshape(len(a), -1) for a in (said, made))
    wrong = (one != other).any(axis=1)
    return int(wrong.argmax()) if wrong.any() else len(said)


def _body(said: dict[str, Any], made: dict[str, Any]) -> str:
    """What the body says apart from the parts; of properties only what they are, not which gproof said so."""
    for key in _BODY:
        one, other = (_plain(key, body.get(key)) for body in (said, made))
        if one != other:
            listed = (_short(_unlike_item(a, b)) for a, b in ((one, other), (other, one)))
            return f"{key} of the body differs: {', now '.join(listed)}"
    digests = [sorted({i["sha256"] for i in body["inputs"] if i["role"] == "source"}) for body in (said, made)]
    if digests[0] != digests[1]:
        return "the source files have other SHA-256s than the body says"
    return ""


def _plain(key: str, value: Any) -> Any:
    if key != "properties" or not isinstance(value, list):
        return value
    return [{k: v for k, v in one.items() if k != "version" or one["name"] in BOUNDS} for one in value]


def _unlike_item(one: Any, other: Any) -> Any:
    if isinstance(one, list) and isinstance(other, list):
        return next((item for item in one if item not in other), one)
    return one


def _short(value: Any) -> str:
    text = value if isinstance(value, str) else json.dumps(value)
    return shown(text.strip(), 120) if text.strip() else "nothing"
