"""docs/check.schema.json and docs/check-json.md say what `check --format json` prints."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from corpus.expectations import around, jobs
from support.bundles import unpacked
from support.campaigns import share
from support.goldens import ROOT
from support.json_schema import violations

from gproof.cli.main import main

SCHEMA = json.loads((ROOT / "docs" / "check.schema.json").read_text(encoding="utf-8"))
JOBS = [job.parent for job in jobs("eding")]
CODES = sorted(unpacked("docs/codes").glob("GP[1234]*/bad.cnc"))


def refuse(text: str) -> None:
    raise AssertionError(f"{text} is no JSON")


def report(words: list[str], capsys: pytest.CaptureFixture[str]) -> tuple[int, dict[str, Any]]:
    code = main(["check", *words, "--format", "json", "--max-blocks", "25000"])
    printed = capsys.readouterr()
    assert code in {0, 1, 2}, f"exit {code}: {printed.err}"
    assert printed.err == ""
    return code, json.loads(printed.out, parse_constant=refuse)


@pytest.mark.parametrize("folder", JOBS, ids=lambda folder: folder.name)
def test_reports_of_the_corpus_follow_the_schema(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = folder / "job.cnc"
    words = [str(job), *around(job)]
    code, found = report(words, capsys)
    assert list(violations(found, SCHEMA)) == []
    assert code == {"SAFE": 0, "UNSAFE": 1, "UNKNOWN": 2}[found["verdict"]]
    assert {entry["role"] for entry in found["inputs"]} >= {"source", "machine"}


@pytest.mark.parametrize("program", share(CODES, 4), ids=lambda program: program.parent.name)
def test_reports_without_a_machine_follow_the_schema(program: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _, found = report([str(program)], capsys)
    assert list(violations(found, SCHEMA)) == []
    assert found["machine"] is None
    assert found["setup"] == "(none)"


def test_the_same_files_give_the_same_bytes(capsys: pytest.CaptureFixture[str]) -> None:
    folder = ROOT / "corpus" / "eding" / "drilled-plate"
    printed = []
    for _ in range(2):
        main(["check", str(folder / "job.cnc"), "--machine", str(folder / "machine.toml"), "--format", "json"])
        printed.append(capsys.readouterr().out)
    assert printed[0] == printed[1]


def test_nothing_is_printed_when_the_command_can_not_run(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "no-such-file.cnc", "--format", "json"]) == 3
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "no-such-file.cnc" in printed.err


def keys(schema: dict[str, Any]) -> Iterator[str]:
    for name, inner in schema.get("properties", {}).items():
        yield name
        yield from keys(inner)
    for inner in [schema.get("items"), schema.get("additionalProperties"), *schema.get("$defs", {}).values()]:
        if inner is not None:
            yield from keys(inner)


def test_every_key_is_explained() -> None:
    page = (ROOT / "docs" / "check-json.md").read_text(encoding="utf-8")
    assert set(keys(SCHEMA)) - set(re.findall(r"`([a-z0-9_]+)`", page)) == set()


@pytest.mark.parametrize(
    ("path", "value"),
    [(("verdict",), "PERHAPS"), (("schema",), "gproof-check/2"), (("counts",), {"GP301": 0}), (("machine",), 3),
     (("summary", "lines"), True), (("inputs", 0, "sha256"), "12"), (("properties", "arcs"), {})],
)  # fmt: skip
def test_the_schema_refuses(path: tuple[Any, ...], value: Any, capsys: pytest.CaptureFixture[str]) -> None:
    _, found = report([str(ROOT / "corpus" / "eding" / "drilled-plate" / "job.cnc")], capsys)
    inner: Any = found
    for part in path[:-1]:
        inner = inner[part]
    inner[path[-1]] = value
    assert list(violations(found, SCHEMA)) != []
