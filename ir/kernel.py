"""The one decorator for hot loops: plain Python on small inputs, numba on large ones.

A kernel is a plain function over numpy arrays (or bytes) in a file named ``*_kernels.py``. It runs
unchanged in both modes, so tests run both and compare bit for bit. ``kernel.pick(work)`` chooses by
estimated cost, counting the import of numba and, when no compiled copy is cached, its compile time: that is
spent once plain Python has lost as much, in this process and earlier ones together, so that nobody waits
for the compiler on a first job that is done sooner without it, nor for ever without it.

Rules for kernel bodies: + - * / and ``math`` functions only, no division by zero, int64 and float64 arithmetic. Other
kernels may be called and constants read, of any file, by a name of their own (``from ... import ...``): what is
after the dot of a module, or in a function within the body, is not seen when the compiled copy is made and named.

``GPROOF_KERNELS=python`` or ``numba`` forces one mode; ``GPROOF_CACHE_DIR`` moves the compile cache, which is used
only where nobody else can write (``private_folder``).
"""

from __future__ import annotations

import atexit
import functools
import os
import sys
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from gproof.ir.kernel_declared import Declared

P = ParamSpec("P")
R = TypeVar("R")

_IMPORT_SECONDS = 0.35
_LOAD_SECONDS = 0.01
_NOTED_SECONDS = 0.02
"""Measured by bench/kernels.py. Import: with what numba sets up on its first call; load: one compiled copy;
noted: a loss smaller than this is not worth a file."""


class Kernel(Declared[P, R]):
    """A function in two speeds.

    seconds_per_unit: cost in plain Python of one unit of the caller's ``work``.
    compile_seconds: what numba needs for it without a cache, about.
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
        super().__init__(function, inline, borrows)
        functools.update_wrapper(self, function)
        self.seconds_per_unit = seconds_per_unit
        self.compile_seconds = compile_seconds
        self._compiled: Callable[P, R] | None = None
        self._spent = 0.0
        self._lost_before: float | None = None

    @classmethod
    def forecast(cls, seconds: float) -> None:
        """Tell, before the first kernel runs, what all of them together would take in plain Python.

        They share the import of numba; without a forecast the first one has to be worth it alone.
        """
        Kernel._forecast = seconds

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        """The plain Python run; callers with much work use ``pick``."""
        return self.python(*args, **kwargs)

    def is_cached(self) -> bool:
        """True when a compiled copy for this source is on disk."""
        from gproof.ir import kernel_copies

        return kernel_copies.is_ready(self)

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
            from gproof.ir import kernel_copies

            self._lost_before = kernel_copies.lost_before(self)
            atexit.register(self._note)
        return self.compiled() if self._lost_before + lost > self.compile_seconds else self.python

    def _lost(self) -> float:
        """Seconds by which a compiled copy on disk would have been sooner than plain Python, so far."""
        start = _LOAD_SECONDS
        if "numba" not in sys.modules:
            start += _IMPORT_SECONDS * self._spent / max(self._spent, self._forecast, _LOAD_SECONDS)
        return self._spent - start

    def _note(self) -> None:
        lost = self._lost()
        if self._compiled is None and lost > _NOTED_SECONDS:
            from gproof.ir import kernel_copies

            kernel_copies.note_loss(self, (self._lost_before or 0.0) + lost)

    def compiled(self) -> Callable[P, R]:
        """The numba version, compiled on its first call or loaded from the cache."""
        if self._compiled is None:
            from gproof.ir import kernel_copies

            self._compiled = kernel_copies.compiled(self, self._take)
        return self._compiled

    def _take(self, compiled: Callable[P, R]) -> None:
        """From its first call on, without what else that one does."""
        self._compiled = compiled


def kernel(
    *, seconds_per_unit: float = 2e-6, compile_seconds: float = 3.0, inline: bool = False, borrows: bool = False
) -> Callable[[Callable[P, R]], Kernel[P, R]]:
    """Mark a function as a kernel; see the module's text for the rules its body keeps."""

    def wrap(function: Callable[P, R]) -> Kernel[P, R]:
        return Kernel(function, seconds_per_unit, compile_seconds, inline, borrows)

    return wrap
