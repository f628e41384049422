"""The compiled copies of kernels: made by numba, or loaded from the cache. Nothing of it is needed in plain Python."""

from __future__ import annotations

import os
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

from gproof.ir.kernel_cache import FileCache, code_digest, write_whole
from gproof.ir.kernel_declared import Declared
from gproof.ir.private_folder import private_or_other
from gproof.ir.uninterrupted import uninterrupted

P = ParamSpec("P")
R = TypeVar("R")


def cache_root() -> Path:
    """The folder for compiled kernels: next to nothing else of the user's, created on demand, private."""
    named = os.environ.get("GPROOF_CACHE_DIR")
    if not named:
        base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
        named = os.path.join(base, "gproof")
    return private_or_other(named)


def folder_of(kernel: Declared[P, R]) -> Path:
    """Where its compiled copies lie: another folder for other code, constants, callees, or options."""
    if not kernel.digest:
        kernel.digest = code_digest(kernel, _behind)
    return cache_root() / "kernels" / f"{kernel.python.__name__}-{kernel.digest}"


def is_ready(kernel: Declared[P, R]) -> bool:
    """True when a compiled copy for its source is on disk."""
    return _marker(kernel).exists()


def lost_before(kernel: Declared[P, R]) -> float:
    """Seconds that earlier processes lost in plain Python while there was no compiled copy."""
    try:
        return float((folder_of(kernel) / "lost").read_text(encoding="ascii"))
    except (OSError, ValueError):
        return 0.0


def note_loss(kernel: Declared[P, R], seconds: float) -> None:
    """Keep them for later ones."""
    write_whole(folder_of(kernel) / "lost", f"{seconds:.3f}".encode("ascii"))


def compiled(kernel: Declared[P, R], take: Callable[[Callable[P, R]], None]) -> Callable[P, R]:
    """The numba version; take: is given what to call instead once there is a copy on disk."""
    with uninterrupted():
        made = dispatcher(kernel, {})
    marker = _marker(kernel)

    def first(*args: P.args, **kwargs: P.kwargs) -> R:
        result: R = made(*args, **kwargs)
        write_whole(marker, b"")
        take(made)
        return result

    return made if marker.exists() else first


def _marker(kernel: Declared[P, R]) -> Path:
    return folder_of(kernel) / "ready"


def dispatcher(kernel: Declared[Any, Any], done: dict[Declared[Any, Any], Any]) -> Any:
    """What numba makes of a kernel and of those that it calls; done: those that are made already."""
    import numba

    if kernel in done:
        return done[kernel]
    function = kernel.python
    scope = dict(function.__globals__)
    for used in function.__code__.co_names:
        value = scope.get(used)
        if isinstance(value, Declared):
            scope[used] = dispatcher(value, done)
    # The copy sees compiled callees; the original keeps the plain ones.
    copy = types.FunctionType(function.__code__, scope, function.__name__, function.__defaults__)
    copy.__module__ = function.__module__
    copy.__qualname__ = function.__qualname__
    # `_nrt` is numba's own name for the counting; the unicode functions of numba are made without it too.
    options: dict[str, Any] = {"inline": "always" if kernel.inline else "never", "_nrt": not kernel.borrows}
    made: Any = numba.njit(error_model="numpy", nogil=True, **options)(copy)
    made._cache = FileCache(folder_of(kernel))
    made._compile_for_args = uninterrupted()(made._compile_for_args)
    made.get_call_template = _without_literals(made.get_call_template)
    done[kernel] = made
    return made


def _without_literals(find: Callable[..., Any]) -> Callable[..., Any]:
    """One copy for calls with constants and without: numba would make one for each constant."""
    import numba

    plain: Callable[[Any], Any] = numba.types.unliteral

    def found(args: tuple[Any, ...], kws: dict[str, Any]) -> Any:
        return find(tuple(map(plain, args)), {name: plain(kind) for name, kind in kws.items()})

    return found


def _behind(value: object) -> tuple[Any, str] | None:
    if not isinstance(value, Declared):
        return None
    return value.python, f"{'inline' if value.inline else ''} {'borrows' if value.borrows else ''}"
