"""The pictures in the pages are those that `check --picture` draws."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from support.goldens import ROOT

from gproof.cli.main import main

JOBS = {
    "drilled-plate": ["zero"],
    "over-limit-arc-bulge": ["zero"],
    "clamped-bracket": ["setup.toml", "--also", "gouges", "--also", "collisions"],
}
"""With what setup and options."""


@pytest.mark.parametrize("name", JOBS)
def test_picture_is_fresh(
    name: str, golden: Callable[[Path, str], None], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = ROOT / "corpus" / "eding" / name
    picture = tmp_path / f"{name}.svg"
    setup, *options = JOBS[name]
    setup = setup if setup == "zero" else str(folder / setup)
    words = [str(folder / "job.cnc"), "--machine", str(folder / "machine.toml"), "--setup", setup, *options]
    main(["check", *words, "--picture", str(picture)])
    capsys.readouterr()
    golden(ROOT / "docs" / "images" / picture.name, picture.read_text(encoding="utf-8"))


def test_every_image_of_a_page_is_drawn_here() -> None:
    assert {path.stem for path in (ROOT / "docs" / "images").iterdir()} == set(JOBS)
