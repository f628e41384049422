"""The compile cache: any number of processes at once, files that are damaged or swapped, code that changes."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import time
from collections import namedtuple
from collections.abc import Callable
from pathlib import Path

import numba
import pytest

from gproof.ir.kernel_cache import FileCache

KERNELS = """
from gproof.ir.kernel import kernel
from inner_kernels import FACTOR, shifted

@kernel()
def total(values):
    result = 0.0
    for n in range(len(values)):
        result += shifted(values[n]) * FACTOR
    return result
"""
INNER = """
from gproof.ir.kernel import kernel

FACTOR = {factor}

@kernel()
def shifted(value):
    return value + {shift}
"""
TOTAL = """
import os, sys, time
import numpy as np
import numba
from total_kernels import total
run = total.compiled()
open(f"ready-{os.getpid()}", "w").close()
while not os.path.exists("go"):
    time.sleep(0.001)
for kind in sys.argv[1:]:
    print(run(np.array([1, 2, 4]).astype(kind)))
if "numba.np.arraymath" in sys.modules:
    open("all-of-numba", "w").close()
"""
KINDS = ["float64", "float32", "int64", "uint64", "int32"]

Start = Callable[..., "subprocess.Popen[str]"]


def write(folder: Path, *, factor: float = 1.0, shift: float = 0.0) -> None:
    (folder / "total_kernels.py").write_text(KERNELS, encoding="utf-8")
    (folder / "inner_kernels.py").write_text(INNER.format(factor=factor, shift=shift), encoding="utf-8")


@pytest.fixture
def start(tmp_path: Path) -> Start:
    """A function: a process that adds 1, 2 and 4 in some types, once the file `go` is there."""
    write(tmp_path)
    environment = os.environ | {"GPROOF_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": str(tmp_path)}
    environment["PYTHONDONTWRITEBYTECODE"] = "1"

    def run(*kinds: str) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [sys.executable, "-c", TOTAL, *kinds], cwd=tmp_path, env=environment, text=True, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )  # fmt: skip

    return run


def answers(process: subprocess.Popen[str]) -> list[float]:
    out, err = process.communicate(timeout=120)
    assert process.returncode == 0, err
    return [float(line) for line in out.split()]


def answer(process: subprocess.Popen[str]) -> float:
    (only,) = answers(process)
    return only


def compiled(folder: Path) -> list[Path]:
    return sorted((folder / "cache").glob("kernels/total-*/*.nbc"))


def test_processes_that_compile_at_the_same_time(start: Start, tmp_path: Path) -> None:
    """Every signature keeps its own copy, none is lost, and the copies are whole: later processes load them."""
    kinds = KINDS[:4]
    together = [start(kind) for kind in kinds]
    while len(list(tmp_path.glob("ready-*"))) < len(kinds) and all(p.poll() is None for p in together):
        time.sleep(0.01)
    (tmp_path / "go").touch()
    assert [answer(process) for process in together] == [7.0] * len(kinds)
    files = compiled(tmp_path)
    assert len(files) == len(kinds)
    written = [path.stat().st_mtime_ns for path in files]
    assert answers(start(*KINDS[:3])) == [7.0] * 3
    assert [path.stat().st_mtime_ns for path in files] == written


def test_what_is_loaded_needs_no_compiler(start: Start, tmp_path: Path) -> None:
    """All that numba can compile, scipy's linear algebra with it, takes longer to import than a long job to check."""
    (tmp_path / "go").touch()
    imported = tmp_path / "all-of-numba"
    assert answer(start("float64")) == 7.0
    assert imported.exists()
    imported.unlink()
    assert answer(start("float64")) == 7.0
    assert not imported.exists()
    # One that is loaded and one that is compiled, in one process.
    assert answers(start("float64", "int64")) == [7.0, 7.0]
    assert imported.exists()


def test_what_does_not_fit_is_compiled_again(start: Start, tmp_path: Path) -> None:
    kinds = KINDS
    (tmp_path / "go").touch()
    assert answers(start(*kinds)) == [7.0] * len(kinds)
    files = compiled(tmp_path)
    whole = [path.read_bytes() for path in files]
    files[0].write_bytes(whole[1])
    files[1].write_bytes(whole[0])
    files[2].write_bytes(whole[2][: len(whole[2]) // 2])
    middle = len(whole[3]) // 2
    files[3].write_bytes(whole[3][:middle] + bytes([whole[3][middle] ^ 16]) + whole[3][middle + 1 :])
    files[4].unlink()
    files[4].mkdir()
    assert answers(start(*kinds)) == [7.0] * len(kinds)
    assert all(path.read_bytes()[:32] == hashlib.sha256(path.read_bytes()[32:]).digest() for path in files[:4])
    assert compiled(tmp_path) == files, "no draft was left behind"


def test_a_cache_that_can_not_be_written(start: Start, tmp_path: Path) -> None:
    (tmp_path / "go").touch()
    (tmp_path / "cache").write_text("in the way", encoding="utf-8")
    assert answer(start("float64")) == 7.0


def test_constants_and_callees_from_another_file(start: Start, tmp_path: Path) -> None:
    """They are frozen into compiled code, so another value is another copy."""
    (tmp_path / "go").touch()
    assert answer(start("float64")) == 7.0
    write(tmp_path, factor=10.0)
    assert answer(start("float64")) == 70.0
    write(tmp_path, factor=10.0, shift=1.0)
    assert answer(start("float64")) == 100.0
    write(tmp_path)
    assert answer(start("float64")) == 7.0
    assert len(compiled(tmp_path)) == 3


def test_callees_of_callees(start: Start, tmp_path: Path) -> None:
    """A kernel two files away, whose constant changes; and two with the same code and constants of their own."""
    (tmp_path / "go").touch()
    inner = """
from gproof.ir.kernel import kernel
from {left} import shifted as left
from {right} import shifted as right

FACTOR = 1.0

@kernel()
def shifted(value):
    return left(value) - right(value)
"""
    leaf = INNER.replace("return value + {shift}", "return value * FACTOR")

    def put(left: float, right: float) -> None:
        (tmp_path / "inner_kernels.py").write_text(inner.format(left="left_kernels", right="right_kernels"))
        (tmp_path / "left_kernels.py").write_text(leaf.format(factor=left))
        (tmp_path / "right_kernels.py").write_text(leaf.format(factor=right))

    for left, right in ((3.0, 1.0), (3.0, 2.0), (4.0, 2.0), (3.0, 1.0)):
        put(left, right)
        assert answer(start("float64")) == 7.0 * (left - right)
    assert len(compiled(tmp_path)) == 3


def test_a_source_that_changes_while_its_old_code_runs(start: Start, tmp_path: Path) -> None:
    old = start("float64")
    while not list(tmp_path.glob("ready-*")):
        assert old.poll() is None
        time.sleep(0.01)
    write(tmp_path, factor=10.0)
    (tmp_path / "go").touch()
    assert answer(old) == 7.0
    assert answer(start("float64")) == 70.0


def test_a_named_tuple_with_its_fields_in_another_order_is_another_argument(tmp_path: Path) -> None:
    """Machine code takes a field by its place."""
    cache = FileCache(tmp_path)
    kinds = [numba.typeof(namedtuple("Pair", fields)(1.0, 2.0)) for fields in ("low high", "high low", "low high")]
    places = [cache._place((kind,), "magic") for kind in kinds]
    assert str(kinds[0]) == str(kinds[1])
    assert places[0] == places[2] != places[1]
