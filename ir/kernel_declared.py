"""A kernel as it is declared: the function, and how numba is to compile it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


class Declared(Generic[P, R]):
    """python: the function as it is written.

    inline: put into every kernel that calls it, before compiling: a call costs more than it does.
    borrows: it makes and returns no array, nor does a kernel that it calls, so its arrays stay its caller's and numba
    need not count who holds them, which it does otherwise at every call and for every name, in the loop too.
    digest: the name of what it compiles to, once that is known.
    """

    def __init__(self, function: Callable[P, R], inline: bool, borrows: bool) -> None:
        self.python = function
        self.inline = inline
        self.borrows = borrows
        self.digest = ""
