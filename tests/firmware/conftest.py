"""Simulated chips with the shipped images, for tests that tell them how much time passes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from support.simulated_board import Simulation, build_runner

from gproof.backend.firmware import CHIPS, image


@pytest.fixture(scope="session")
def tools(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the runner and the shipped images."""
    folder = tmp_path_factory.mktemp("simulator")
    build_runner(folder)
    for chip in CHIPS:
        (folder / f"{chip}.hex").write_bytes(image(chip))
    return folder


@pytest.fixture
def chip_of(tools: Path, tmp_path: Path) -> Iterator[Callable[[str], Simulation]]:
    """Starts a chip whose time is told."""
    running: list[Simulation] = []

    def start(chip: str) -> Simulation:
        running.append(Simulation(tools / "runner", chip, tools / f"{chip}.hex", tmp_path, "told"))
        return running[-1]

    yield start
    for one in running:
        one.end()
