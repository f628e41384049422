"""A copy of what a build of the distribution reads, and the environment in which pip builds it without a network."""

from __future__ import annotations

import shutil
import sys
import tomllib
from pathlib import Path

from support.goldens import ROOT

OFFLINE = {
    "PIP_NO_INDEX": "1",
    "PIP_NO_DEPS": "1",
    "PIP_NO_BUILD_ISOLATION": "0",  # as pip reads it: no isolation
    "PYTHONPATH": ":".join(path for path in sys.path if path.endswith("-packages")),
}
"""Libraries and setuptools are those of this environment: no index is asked, and none of gproof is found there."""


def copy_of_the_source(folder: Path) -> Path:
    """Packages, scripts and what stands beside them; a build leaves its traces in the copy."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    for name in ("scripts", *settings["tool"]["setuptools"]["package-dir"].values()):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in (
        "pyproject.toml",
        "setup.py",
        "README.md",
        "LICENSE",
        "requirements.lock",
        "action.yml",
        ".pre-commit-hooks.yaml",
    ):
        shutil.copy(ROOT / name, folder / name)
    return folder
