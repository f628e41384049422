"""The one decorator for hot loops: plain Python on small inputs, numba on large ones.

A kernel is a plain function over numpy arrays (or bytes) in a file named ``*_kernels.py``. It runs
unchanged in both modes, so tests run both and compare bit for bit. ``kernel.pick(work)`` chooses by
estimated cost, counting the import of numba and, when no compiled copy is cached, its compile time: that is
spent once plain Python has lost as much, in this process and earlier ones together, so that nobody waits
for the compiler on a first job that is done sooner without it, nor for ever without it.

Rules for kernel bodies: + - * / and ``math`` functions only, no division by zero, int64 and float64 arithmetic. Other
kernels may be called and constants read, of any file, by a name of their own (``from ... import ...``): what stands
behind the dot of a module, or in a function within the body, is not seen when the compiled copy is made and named.

``GPROOF_KERNELS=python`` or ``numba`` forces one mode; ``GPROOF_CACHE_DIR`` moves the compile cache, which is used
only where nobody else can write (``private_folder``).
"""

from __future__ import annotations

import atexit
import functools
import os
import sys
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any, Generic, ParamSpec, TypeVar

from gproof.ir.kernel_cache import FileCache, code_digest, write_whole
from gproof.ir.private_folder import private_or_other
from gproof.ir.uninterrupted import uninterrupted

P = ParamSpec("P")
R = TypeVar("R")

_IMPORT_SECONDS = 0.35
_LOAD_SECONDS = 0.01
_NOTED_SECONDS = 0.02
"""Measured by bench/kernels.py. Import: with what numba sets up on its first call; load: one compiled copy;
noted: a loss smaller than this is not worth a file."""


def cache_root() -> Path:
    """The folder for compiled kernels: next to nothing else of the user's, created on demand, private."""
    named = os.environ.get("GPROOF_CACHE_DIR")
    if not named:
        base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
        named = os.path.join(base, "gproof")
    return private_or_other(named)


class Kernel(Generic[P, R]):
    """A function in two speeds.

    seconds_per_unit: cost in plain Python of one unit of the caller's ``work``.
    compile_seconds: what numba needs for it without a cache, about.
    inline: put into every kernel that calls it, before compiling: a call costs more than it does.
    borrows: it makes and returns no array, nor does a kernel that it calls, so its arrays stay its caller's and numba
    need not count who holds them, which it does otherwise at every call and for every name, in the loop too.
    """

    _forecast = 0.0

    def __init__(
        self,
        function: Callable[P, R],
        seconds_per_unit: float,
        compile_seconds: float,
        inline: bool = False,
        borrows: bool = False,
    ) -> None:
        self.python = function
        self.inline = inline
        self.borrows = borrows
        self.seconds_per_unit = seconds_per_unit
        self.compile_seconds = compile_seconds
        self._compiled: Callable[P, R] | None = None
        self._spent = 0.0
        self._lost_before: float | None = None
        self._digest = ""
        functools.update_wrapper(self, function)

    @classmethod
    def forecast(cls, seconds: float) -> None:
        """Tell, before the first kernel runs, what all of them together would take in plain Python.

        They share the import of numba; without a forecast the first one has to be worth it alone.
        """
        Kernel._forecast = seconds

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        """The plain Python run; callers with much work use ``pick``."""
        return self.python(*args, **kwargs)

    def _folder(self) -> Path:
        """Where its compiled copies lie: another folder for other code, constants, callees, or options."""
        if not self._digest:
            self._digest = code_digest(self, _behind)
        return cache_root() / "kernels" / f"{self.python.__name__}-{self._digest}"

    def _marker(self) -> Path:
        return self._folder() / "ready"

    def is_cached(self) -> bool:
        """True when a compiled copy for this source is on disk."""
        return self._marker().exists()

    def pick(self, work: float) -> Callable[P, R]:
        """The implementation that finishes ``work`` units first.

        What earlier calls cost in Python counts too, so that many small calls end up compiled as well.
        """
        mode = os.environ.get("GPROOF_KERNELS", "")
        if mode == "python":
            return self.python
        if mode == "numba" or self._compiled is not None:
            return self.compiled()
        self._spent += work * self.seconds_per_unit
        lost = self._lost()
        if lost <= 0.0:
            return self.python
        if self.is_cached():
            return self.compiled()
        if self._lost_before is None:
            self._lost_before = self._noted()
            atexit.register(self._note)
        return self.compiled() if self._lost_before + lost > self.compile_seconds else self.python

    def _lost(self) -> float:
        """Seconds by which a compiled copy on disk would have been sooner than plain Python, so far."""
        start = _LOAD_SECONDS
        if "numba" not in sys.modules:
            start += _IMPORT_SECONDS * self._spent / max(self._spent, self._forecast, _LOAD_SECONDS)
        return self._spent - start

    def _noted(self) -> float:
        """What earlier processes lost in plain Python while there was no compiled copy."""
        try:
            return float((self._folder() / "lost").read_text(encoding="ascii"))
        except (OSError, ValueError):
            return 0.0

    def _note(self) -> None:
        lost = self._lost()
        if self._compiled is None and lost > _NOTED_SECONDS:
            write_whole(self._folder() / "lost", f"{(self._lost_before or 0.0) + lost:.3f}".encode("ascii"))

    def compiled(self) -> Callable[P, R]:
        """The numba version, compiled on its first call or loaded from the cache."""
        if self._compiled is None:
            with uninterrupted():
                self._compiled = self._with_marker(self._dispatcher({}))
        return self._compiled

    def _with_marker(self, dispatcher: Any) -> Callable[P, R]:
        marker = self._marker()

        def first(*args: P.args, **kwargs: P.kwargs) -> R:
            result: R = dispatcher(*args, **kwargs)
            write_whole(marker, b"")
            self._compiled = dispatcher
            return result

        return dispatcher if marker.exists() else first

    def _dispatcher(self, done: dict[Kernel[Any, Any], Any]) -> Any:
        import numba

        if self in done:
            return done[self]
        function = self.python
        scope = dict(function.__globals__)
        for used in function.__code__.co_names:
            value = scope.get(used)
            if isinstance(value, Kernel):
                scope[used] = value._dispatcher(done)
        # The copy sees compiled callees; the original keeps the plain ones.
        copy = types.FunctionType(function.__code__, scope, function.__name__, function.__defaults__)
        copy.__module__ = function.__module__
        copy.__qualname__ = function.__qualname__
        # `_nrt` is numba's own name for the counting; the unicode functions of numba are made without it too.
        options: dict[str, Any] = {"inline": "always" if self.inline else "never", "_nrt": not self.borrows}
        dispatcher: Any = numba.njit(error_model="numpy", nogil=True, **options)(copy)
        dispatcher._cache = FileCache(self._folder())
        dispatcher._compile_for_args = uninterrupted()(dispatcher._compile_for_args)
        done[self] = dispatcher
        return dispatcher


def _behind(value: object) -> tuple[Any, str] | None:
    if not isinstance(value, Kernel):
        return None
    return value.python, f"{'inline' if value.inline else ''} {'borrows' if value.borrows else ''}"


def kernel(
    *, seconds_per_unit: float = 2e-6, compile_seconds: float = 3.0, inline: bool = False, borrows: bool = False
) -> Callable[[Callable[P, R]], Kernel[P, R]]:
    """Mark a function as a kernel; see the module's text for the rules its body keeps."""

    def wrap(function: Callable[P, R]) -> Kernel[P, R]:
        return Kernel(function, seconds_per_unit, compile_seconds, inline, borrows)

    return wrap
