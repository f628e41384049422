"""Rules that the bodies of all kernels keep, so that a compiled copy is named by everything that went into it."""

from __future__ import annotations

import importlib
import math
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gproof.ir
from gproof.ir.kernel import Kernel

ROOT = Path(gproof.ir.__file__).parents[1]
FOLDERS = ("ir", "frontend", "passes", "verify", "backend")


def files() -> list[str]:
    found = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*_kernels.py")]
    return sorted(".".join(path.relative_to(ROOT).with_suffix("").parts) for path in found)


def kernels(module: str) -> Iterator[tuple[str, Kernel[Any, Any]]]:
    for name, value in vars(importlib.import_module(f"gproof.{module}")).items():
        if isinstance(value, Kernel):
            yield name, value


def test_there_are_kernels_that_call_those_of_other_files() -> None:
    """Or the next test says little."""
    called = set()
    for module in files():
        for name, kernel in kernels(module):
            used = (kernel.python.__globals__.get(word) for word in kernel.python.__code__.co_names)
            elsewhere = {k for k in used if isinstance(k, Kernel) and k.python.__module__ != kernel.python.__module__}
            called |= {(name, k.python.__name__) for k in elsewhere}
    assert ("scan_notes", "note_column") in called


@pytest.mark.parametrize("module", files())
def test_what_a_kernel_uses_has_a_name_of_its_own(module: str) -> None:
    found = dict(kernels(module))
    assert found, "a file of kernels has one at least"
    for name, kernel in found.items():
        code, scope = kernel.python.__code__, kernel.python.__globals__
        inner = [part.co_name for part in code.co_consts if isinstance(part, types.CodeType)]
        assert not inner, f"{name}: {inner} in its body is not seen by the cache"
        modules = {used for used in code.co_names if isinstance(scope.get(used), types.ModuleType)}
        assert all(scope[used] in (math, np) for used in modules), f"{name}: what it takes from {modules} is not seen"
        plain = {used for used in code.co_names if isinstance(scope.get(used), types.FunctionType)}
        assert not plain, f"{name}: {plain} are no kernels"
