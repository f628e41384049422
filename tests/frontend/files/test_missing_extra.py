"""Without the extra `dxf`: a drawing is refused in a line that says what to install, and nothing else changes."""

from __future__ import annotations

import shutil
import sys
import tomllib
from pathlib import Path

import pytest
from support.command import in_this_process
from support.goldens import ROOT

from gproof.frontend.common.dxf import NO_READER

BRACKET = ROOT / "corpus" / "eding" / "clamped-bracket"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
JOB = ("job.cnc", "--machine", "machine.toml")


@pytest.fixture
def without_ezdxf(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.split(".")[0] == "ezdxf"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "ezdxf", None)


@pytest.fixture
def shop(tmp_path: Path) -> Path:
    return shutil.copytree(BRACKET, tmp_path / "shop")


@pytest.mark.usefixtures("without_ezdxf")
@pytest.mark.parametrize(
    "words",
    [("check", "--also", "all"), ("check", "--format", "json"), ("check", "--format", "sarif"), ("fit",),
     ("compile", "-o", "out.gpx"), ("dump", "--stage", "trace")],
    ids=" ".join,
)  # fmt: skip
def test_a_drawing_needs_the_extra(words: tuple[str, ...], shop: Path) -> None:
    done = in_this_process([*words, *JOB, "--setup", "setup.toml"], shop)
    assert done.exit == 3
    said = done.out + done.err
    (line,) = [line for line in said.splitlines() if "gproof[dxf]" in line]
    assert line.startswith("setup.toml:26:")
    assert line.endswith(f"bracket.dxf: {NO_READER}")
    assert "Traceback" not in said
    assert not (shop / "out.gpx").exists()


@pytest.mark.usefixtures("without_ezdxf")
def test_a_job_without_a_drawing_does_not_notice(shop: Path) -> None:
    setup = shop / "setup.toml"
    head, tail = setup.read_text(encoding="utf-8").split('dxf = "bracket.dxf"\n')
    setup.write_text(f"{head}box = [[0, 0, -15], [10, 10, 0]]\n{tail[tail.index(chr(10)) :]}", encoding="utf-8")
    done = in_this_process(["check", *JOB, "--setup", "setup.toml", "--also", "all", "--quiet"], shop)
    assert done.exit in (0, 1), done.err
    assert done.out.startswith("job.cnc: ")


def test_ezdxf_is_an_extra_and_developers_have_every_extra() -> None:
    extras = PROJECT["optional-dependencies"]
    assert [name for name in PROJECT["dependencies"] if name.startswith("ezdxf")] == []
    assert any(name.startswith("ezdxf") for name in extras["dxf"])
    for_users = set(extras) - {"dev", "peers"}
    assert {f"gproof[{name}]" for name in for_users} <= set(extras["dev"])
    locked = (ROOT / "requirements.lock").read_text(encoding="utf-8")
    for extra in for_users:
        for needed in extras[extra]:
            assert f"\n{needed.split('>')[0]}==" in locked
