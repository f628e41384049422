"""What `gproof verify` prints: what was judged here, what is stated, what is open; docs/verify-json.md has its JSON."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from cli.packages import Shop
from support.goldens import ROOT

from gproof.ir.verdict import DEFAULT_POLICY
from gproof.verify.explain.stream_report import BOUNDS


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Shop:
    return Shop(tmp_path, monkeypatch.setenv)


def documented() -> list[set[str]]:
    """The keys of the two tables."""
    text = (ROOT / "docs" / "verify-json.md").read_text(encoding="utf-8")
    first, second = text.split("A package that cannot be read has only these")
    return [
        {key for row in re.findall(r"^\| (`[^|]*) \|", part, re.M) for key in re.findall(r"`(\w+)`", row)}
        for part in (first, second)
    ]


def test_the_text_names_everything(shop: Shop) -> None:
    shop.compile()
    done = shop("verify", "made.gpx", "--machine", "machine.toml", "--source", "job.cnc")
    assert done.exit == 0
    lines = done.out.splitlines()
    assert lines[0] == "made.gpx: SAFE"
    assert "  compared    with machine, source" in lines
    for name in (*DEFAULT_POLICY, *BOUNDS):
        assert any(re.search(rf"\b{name} +SAFE$", line) for line in lines), name
    assert any(line.startswith("  proved here stream-form") for line in lines)
    assert any(line.startswith("  stated      language") for line in lines)
    assert any(line.startswith("  unchecked   collisions, cutting") for line in lines)
    assert any(line.startswith("  assuming    setup zero") for line in lines)
    assert "with nothing; use --machine, --setup and --source" in shop("verify", "made.gpx").out


def test_the_json_report_has_the_keys_that_are_documented(shop: Shop) -> None:
    shop.compile()
    always, more = documented()
    done = shop("verify", "made.gpx", "--format", "json", "--setup", "zero")
    report = json.loads(done.out)
    assert set(report) == always | more
    assert (report["schema"], report["verdict"], report["exit_code"]) == ("gproof-verify/1", "SAFE", 0)
    assert report["judged"] == dict.fromkeys(BOUNDS, "SAFE")
    assert set(report["stated"]) == set(DEFAULT_POLICY)
    assert report["compared"] == ["setup"]
    assert report["signer"]["name"] == "own"
    (shop.folder / "bad.gpx").write_bytes(b"PK")
    done = shop("verify", "bad.gpx", "--format", "json")
    report = json.loads(done.out)
    assert set(report) == always
    assert (done.exit, report["verdict"], report["findings"][0]["code"]) == (1, "UNSAFE", "GP821")
    shop.compile("--unsigned", output="unsigned.gpx")
    done = shop("verify", "unsigned.gpx", "--format", "json")
    report = json.loads(done.out)
    assert (done.exit, report["verdict"], report["signer"]) == (2, "UNKNOWN", None)
    assert [one["code"] for one in report["findings"]] == ["GP827"]


PURE = """
import sys
from gproof.cli.main import main
try:
    code = main()
except SystemExit as end:
    code = end.code
print(code, sorted({"numba", "llvmlite"} & set(sys.modules)))
"""


def test_pure_loads_no_numba_and_says_so(shop: Shop, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the environment says."""
    (shop.folder / "job.cnc").write_text("G21 G90\n" + "G0 X100\nG0 X0\n" * 2 + "M30\n")
    shop.compile()
    monkeypatch.setenv("GPROOF_KERNELS", "numba")
    words = [sys.executable, "-c", PURE, "verify", "made.gpx"]

    def said(*more: str) -> list[str]:
        return subprocess.run(
            [*words, *more], cwd=shop.folder, capture_output=True, text=True, check=True
        ).stdout.splitlines()  # fmt: skip

    pure = said("--pure")
    assert pure[-1] == "0 []"
    row = "  proved      in plain Python: no compiled code, no numba"
    plain = said()
    assert plain[-1] != "0 []", "steps enough"
    assert row in pure and [line for line in pure[:-1] if line != row] == plain[:-1]
    report = json.loads("\n".join(said("--pure", "--format", "json")[:-1]))
    assert report["pure"] is True and report["verdict"] == "SAFE"
    assert json.loads("\n".join(said("--format", "json")[:-1])) == report | {"pure": False}


def test_pure_is_for_packages(shop: Shop) -> None:
    shop.compile()
    assert shop("run", "made.gpx", "--board", "virtual", "--record", "r.json").exit == 0
    assert shop("verify", "r.json", "--pure").exit == 3


def test_a_format_is_for_packages(shop: Shop) -> None:
    shop.compile()
    assert shop("run", "made.gpx", "--board", "virtual", "--record", "r.json").exit == 0
    done = shop("verify", "r.json", "--format", "json")
    assert (done.exit, done.out) == (3, "")
