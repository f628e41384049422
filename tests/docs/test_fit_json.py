"""docs/fit.schema.json and docs/fit.md say what `fit --format json` prints; the corpus gets the verdicts it expects."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

import pytest
from corpus.jobs import all_jobs, job_of
from support.campaigns import share
from support.command import in_this_process
from support.goldens import ROOT
from support.json_schema import violations

SCHEMA = json.loads((ROOT / "docs" / "fit.schema.json").read_text(encoding="utf-8"))
VERDICTS = ("SAFE", "UNSAFE", "UNKNOWN")
JOBS = [(name, verdict) for verdict in VERDICTS for name in all_jobs(verdict)]


def refuse(text: str) -> None:
    raise AssertionError(f"{text} is no JSON")


def words_for(name: str) -> list[str]:
    job, expect = job_of(name)
    words = [
        "fit",
        str(job),
        "--machine",
        expect["machine"],
        "--dialect",
        name.split("/", maxsplit=1)[0],
    ]
    if "setup" in expect:
        words += ["--setup", expect["setup"]]
    return words


@pytest.mark.parametrize(("name", "verdict"), share(JOBS, 8))
def test_every_job_of_the_corpus(name: str, verdict: str) -> None:
    """The verdict that its file expects, by the schema, and what goes with it."""
    done = in_this_process([*words_for(name), "--format", "json"], ROOT)
    assert done.err == ""
    report = json.loads(done.out, parse_constant=refuse)
    assert list(violations(report, SCHEMA)) == []
    assert report["verdict"] == verdict
    assert done.exit == report["exit_code"] == {"SAFE": 0, "UNSAFE": 1, "UNKNOWN": 2}[verdict]
    assert report["stated"] in (None, verdict)
    assert (report["kind"] == "regions") == bool(report["regions"])
    if report["kind"] not in ("ranges", "regions"):
        assert report["findings"] or report["reason"]
        assert not report["offsets"]
    elif report["stated"] == "SAFE":
        assert all(one["fits"] is not False and one["short"] == 0.0 for one in report["offsets"])
        assert all(one["inside"] is not False for one in report["regions"])
    elif verdict == "UNSAFE" and report["complete"]:
        outside = [one for one in report["regions"] if one["inside"] is False]
        assert outside or any(one["fits"] is False and one["short"] != 0.0 for one in report["offsets"])


def test_the_same_files_give_the_same_bytes() -> None:
    words = [*words_for("eding/over-limit-work-offset"), "--format", "json"]
    assert in_this_process(words, ROOT).out == in_this_process(words, ROOT).out


def keys(schema: dict[str, Any]) -> Iterator[str]:
    for name, inner in schema.get("properties", {}).items():
        yield name
        yield from keys(inner)
    for inner in [schema.get("items"), schema.get("additionalProperties"), *schema.get("$defs", {}).values()]:
        if inner is not None:
            yield from keys(inner)


def test_every_key_is_explained() -> None:
    pages = "".join((ROOT / "docs" / name).read_text(encoding="utf-8") for name in ("fit.md", "check-json.md"))
    assert set(keys(SCHEMA)) - set(re.findall(r"`([a-z0-9_]+)`", pages)) == set()


@pytest.mark.parametrize(
    ("path", "value"),
    [(("verdict",), "PERHAPS"), (("schema",), "gproof-fit/2"), (("kind",), "boxes"), (("machine",), None),
     (("offsets", 0, "low"), "12"), (("travel", 0, "size"), -1.0), (("smallest_machine", "X"), None)],
)  # fmt: skip
def test_the_schema_refuses(path: tuple[Any, ...], value: Any) -> None:
    report = json.loads(in_this_process([*words_for("eding/over-limit-work-offset"), "--format", "json"], ROOT).out)
    inner: Any = report
    for part in path[:-1]:
        inner = inner[part]
    inner[path[-1]] = value
    assert list(violations(report, SCHEMA)) != []
