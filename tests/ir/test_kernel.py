"""Which of its two speeds a kernel chooses: costs, the shared import, and what earlier processes lost."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from gproof.ir.kernel import kernel
from gproof.ir.kernel_copies import folder_of

SOURCE = """
from gproof.ir.kernel import kernel

@kernel(seconds_per_unit={unit}, compile_seconds={compile})
def total(values):
    result = 0.0
    for n in range(len(values)):
        result += values[n]
    return result
"""

CHOOSE = """
import sys
import numpy as np
from gproof.ir.kernel import Kernel
sys.path.insert(0, sys.argv[1])
from total_kernels import total
Kernel.forecast(float(sys.argv[2]))
for work in sys.argv[3:]:
    run = total.pick(float(work))
    assert run(np.array([0.5, 0.25, 4.0])) == 4.75
    print("python" if run is total.python else "numba")
"""


@pytest.fixture
def choose(tmp_path: Path):  # type: ignore[no-untyped-def]
    """A function: the choices for calls of so many units, one second of plain Python each, in a fresh process."""

    def run(*work: float, compile_seconds: float = 1.0, forecast: float = 0.0) -> list[str]:
        source = SOURCE.format(unit=1.0, compile=compile_seconds)
        (tmp_path / "total_kernels.py").write_text(source, encoding="utf-8")
        environment = {k: v for k, v in os.environ.items() if k != "GPROOF_KERNELS"}
        environment["GPROOF_CACHE_DIR"] = str(tmp_path / "cache")
        command = [sys.executable, "-c", CHOOSE, str(tmp_path), str(forecast), *map(str, work)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout.split()

    return run


def test_little_work_stays_in_python_and_leaves_nothing_behind(choose, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    assert choose(0.001, 0.001) == ["python", "python"]
    assert not (tmp_path / "cache").exists()


def test_much_work_is_compiled_and_then_loaded_for_less(choose) -> None:  # type: ignore[no-untyped-def]
    assert choose(0.9) == ["python"]
    assert choose(10.0) == ["numba"]
    assert choose(0.2, 0.3) == ["python", "numba"]


def test_many_small_calls_add_up(choose) -> None:  # type: ignore[no-untyped-def]
    assert choose(*[0.5] * 4) == ["python", "python", "numba", "numba"]


def test_what_earlier_processes_lost_counts(choose) -> None:  # type: ignore[no-untyped-def]
    assert choose(0.9) == ["python"]
    assert choose(0.9) == ["numba"]


def test_a_forecast_shares_the_import(choose) -> None:  # type: ignore[no-untyped-def]
    choose(10.0)
    assert choose(0.2) == ["python"]
    assert choose(0.2, forecast=2.0) == ["numba"]


@pytest.mark.parametrize("way", ["inline", "borrows"])
def test_how_a_kernel_is_compiled_names_its_copy(way: str) -> None:
    """Also how its callee is: a copy of the other kind would be loaded, with other speed and other counting."""

    scope: dict[str, Any] = {}
    exec("def callee(x): return x + 1\ndef caller(x): return callee(x)", scope)
    plain, caller, folders = scope["callee"], scope["caller"], set()
    for options in ({}, {way: True}):
        scope["callee"] = kernel(**options)(plain)
        folders |= {folder_of(scope["callee"]), folder_of(kernel()(caller))}
    assert len(folders) == 4
