"""The option `--refresh-goldens` (`make goldens`) and the fixture through which tests reach golden files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from support import goldens

Golden = Callable[[Path, str], None]


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
