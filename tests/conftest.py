"""The option `--refresh-goldens` (`make goldens`), how tests reach golden files, and the figures of campaigns."""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from support import goldens, temporary
from support.campaigns import SOAK
from support.temporary import pytest_runtest_makereport, tmp_path  # noqa: F401

ROOT = Path(__file__).resolve().parents[1]
# `python -m pytest` puts the root on the path, where `passes` and others would shadow the folders of the tests.
sys.path[:] = [entry for entry in sys.path if Path(entry).resolve() != ROOT]
temporary.use_memory()

Golden = Callable[[Path, str], None]

LONG = ("test_packaging.py", "test_action.py", "test_pre_commit.py", "test_walkthrough.py", "test_forgery.py")
"""Tests of ten seconds and more are begun first: at the end no process is left alone with one."""

# What a random test of hypothesis asks for itself counts; the others make this many examples in every run.
# How long it takes to make one is a matter of what else the machine does.
settings.register_profile("every run", max_examples=12, suppress_health_check=[HealthCheck.too_slow])
if not SOAK:
    settings.load_profile("every run")


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection() -> Iterator[None]:
    """Twenty thousand tests and their modules stay to the end: the garbage collector looks at none of them again."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """A name that another process would give another test (a set, an address in memory) stops the run."""
    for item in items:
        if "set({" in item.nodeid or " at 0x" in item.nodeid:
            raise pytest.UsageError(f"{item.nodeid}: its name differs from run to run: give it `ids`")
    items.sort(key=lambda item: item.path.name not in LONG)


@pytest.fixture(scope="session", autouse=True)
def own_folder(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Keys, journals and records of the tests, and of processes that they start, are not among the user's own."""
    os.environ["XDG_CONFIG_HOME"] = str(tmp_path_factory.mktemp("config"))


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--refresh-goldens",
        action="store_true",
        help="rewrite expected texts (golden files, console blocks of the pages); never `; expect:` markers",
    )


@pytest.fixture(scope="session")
def refresh_goldens(request: pytest.FixtureRequest) -> bool:
    """True under `--refresh-goldens`."""
    return bool(request.config.getoption("--refresh-goldens"))


@pytest.fixture(scope="session")
def golden(refresh_goldens: bool) -> Golden:
    """`golden(path, text)`: the text is what the file holds; `.svg` files by coordinates."""

    def compare(path: Path, actual: str) -> None:
        judge = goldens.check_drawing if path.suffix == ".svg" else goldens.check
        judge(path, actual, refresh=refresh_goldens)

    return compare


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """The figures that campaigns record (`record_property("figures", text)`), whether they passed or not."""
    told = [
        str(value)
        for outcome in ("passed", "failed")
        for report in terminalreporter.stats.get(outcome, [])
        for name, value in getattr(report, "user_properties", ())
        if name == "figures"
    ]
    if told:
        terminalreporter.section("figures of the campaigns")
        terminalreporter.write_line("\n".join(told))
