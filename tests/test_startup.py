"""Small jobs stay instant: heavy libraries are imported where they are needed, not before."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from gproof.driver.dialects import DIALECTS

ROOT = Path(__file__).resolve().parent.parent
PLATE = "corpus/eding/drilled-plate"
GASKET = "corpus/wincnc/knife-twohead/jobs/gasket.tap"
DOTS = "corpus/mcuwin/engraver/jobs/dots.src"
NEVER_FOR_SMALL_JOBS = {"numba", "llvmlite", "z3", "shapely", "ezdxf", "serial"}
NOT_AT_START = NEVER_FOR_SMALL_JOBS | {"cryptography", "lark", "rich"}
RUN = """
import sys
from gproof.cli.main import main
try:
    code = main()
except SystemExit as end:
    code = end.code
assert not code, code
"""


def modules_after(statements: str, *arguments: str) -> set[str]:
    """Top-level names in ``sys.modules`` of a fresh Python that ran the statements."""
    return {name.partition(".")[0] for name in all_modules_after(statements, *arguments)}


def all_modules_after(statements: str, *arguments: str) -> set[str]:
    """Names in ``sys.modules`` of a fresh Python that ran the statements."""
    report = "\nimport sys; print('modules:', *sys.modules)"
    environment = {name: value for name, value in os.environ.items() if name != "GPROOF_KERNELS"}
    done = subprocess.run(
        [sys.executable, "-c", statements + report, *arguments],
        cwd=ROOT,
        env=environment,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return set(done.stdout.splitlines()[-1].removeprefix("modules: ").split())


def test_the_command_line_starts_without_heavy_libraries() -> None:
    loaded = modules_after("import gproof.cli.main")
    assert "gproof" in loaded
    assert sorted(loaded & NOT_AT_START) == []


@pytest.mark.parametrize("arguments", [["--version"], ["--help"], ["explain", "GP301"]], ids=" ".join)
def test_plain_answers_need_no_heavy_library(arguments: list[str]) -> None:
    loaded = modules_after(RUN, *arguments)
    assert sorted(loaded & NOT_AT_START) == []


def test_a_small_job_is_checked_without_heavy_libraries() -> None:
    job = [f"{PLATE}/job.cnc", "--machine", f"{PLATE}/machine.toml", "--setup", "zero"]
    loaded = modules_after(RUN, "check", *job)
    assert sorted(loaded & NEVER_FOR_SMALL_JOBS) == []


LISTED = {"gproof.frontend.wincnc.file_names", "gproof.frontend.mcuwin.names"}
"""Modules that say what files of a dialect are called: the registry has them of all dialects."""


@pytest.mark.parametrize(
    ("dialect", "job", "machine", "setup"),
    [
        ("eding", f"{PLATE}/job.cnc", "machine.toml", "zero"),
        ("wincnc", GASKET, "../machine.toml", "../setup.toml"),
        ("mcuwin", DOTS, "../machine.toml", "../setup.toml"),
    ],
)
def test_a_job_of_one_dialect_needs_no_rooms_of_another(dialect: str, job: str, machine: str, setup: str) -> None:
    beside = Path(job).parent
    stated = setup if setup == "zero" else str(beside / setup)
    loaded = all_modules_after(RUN, "check", job, "--machine", str(beside / machine), "--setup", stated)
    rooms = [f"gproof.{room}." for room in ("frontend", "passes.interpret", "backend.emit", "ir.dialects")]
    others = [f"{room}{name}." for room in rooms for name in DIALECTS if name != dialect]
    assert sorted(name for name in loaded - LISTED if name.startswith(tuple(others))) == []
    assert {f"gproof.frontend.{dialect}.load", f"gproof.passes.interpret.{dialect}.line_order"} & loaded
