"""docs/trace-jsonl.md lists every operation and key that `dump --stage trace --format jsonl` prints."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from corpus.expectations import around, jobs
from support.goldens import ROOT

from gproof.cli.main import main
from gproof.ir.trace import Op

JOBS = [job.parent for job in jobs("eding") if job.parent.name != "raster-surface"]
EVERYWHERE = {"op", "line", "file"}


def listed() -> dict[str, set[str]]:
    """Keys by op: the words in backticks of a row before an explanation, or between them."""
    out = {}
    for row in re.findall(
        r"^\| (`.*?) \|(.*)\|$", (ROOT / "docs" / "trace-jsonl.md").read_text(encoding="utf-8"), re.M
    ):
        keys = set(re.findall(r"`([a-z_]+)`", row[1]))
        out |= dict.fromkeys(re.findall(r"`([a-z_]+)`", row[0]), keys)
    return out


@pytest.mark.parametrize("folder", JOBS, ids=lambda folder: folder.name)
def test_rows_have_the_listed_keys(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = folder / "job.cnc"
    words = ["dump", str(job), "--stage", "trace", "--format", "jsonl", *around(job)]
    code = main(words)
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    keys = listed()
    for row in rows:
        assert set(row) <= keys[row["op"]] | EVERYWHERE, row
        assert {"op", "line"} <= set(row)
    assert [n for n, row in enumerate(rows) if row["op"] == "error"] in ([], [len(rows) - 1])
    assert code != 0 or rows[-1]["op"] != "error"


def test_every_operation_is_listed() -> None:
    assert {op.name.lower() for op in Op} | {"error", "section", "branch"} == set(listed())
