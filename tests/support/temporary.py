"""Where tests write: in memory where there is room, each in a folder of its own.

Twenty thousand tests write small files again and again. A disk takes a millisecond for each, memory a few hundredths;
and pytest's own `tmp_path` looks through all folders before it for a free number.
"""

from __future__ import annotations

import itertools
import os
import re
import shutil
import tempfile
from collections.abc import Generator, Iterator
from pathlib import Path

import pytest

MEMORY = "/dev/shm"  # of Linux; elsewhere the usual folder stays
ROOM = 4_000_000_000
"""Bytes that have to be free there; tests of large files and packages use some hundred million at a time."""

_FAILED: pytest.StashKey[bool] = pytest.StashKey()
_numbers = itertools.count()


def use_memory() -> None:
    """Temporary files of the tests and of processes that they start go into memory, unless the user names a folder."""
    if "TMPDIR" in os.environ or not os.access(MEMORY, os.W_OK | os.X_OK):
        return
    about = os.statvfs(MEMORY)
    if about.f_bavail * about.f_frsize >= ROOM and not about.f_flag & os.ST_NOEXEC:
        os.environ["TMPDIR"] = MEMORY
        tempfile.tempdir = None


@pytest.fixture
def tmp_path(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A new folder of this test; it stays where the test fails."""
    name = re.sub(r"\W", "_", request.node.name)[:30]
    folder = tmp_path_factory.getbasetemp() / f"{name}{next(_numbers)}"
    folder.mkdir(mode=0o700)
    yield folder
    if not request.node.stash.get(_FAILED, False):
        shutil.rmtree(folder, ignore_errors=True)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Remember which tests fail."""
    report = yield
    if report.failed:
        item.stash[_FAILED] = True
    return report
