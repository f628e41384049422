"""Compiled kernels on disk: one file a signature, whole or not there, for any number of processes at once.

numba's own cache keeps an index next to numbered files. Two processes that compile two signatures of one function
at the same time can both take number 1; the index then names machine code for other arguments, which fails when it is
called, or worse. Here a file's name is what it holds, it appears in one step, and whoever reads it compares its
digest and its signature first; whatever does not fit counts as not there and is compiled again.

Machine code from here becomes the checker, so it is read and kept in private folders alone (``private_folder``).

The folder of a kernel is named by its code and by all that numba freezes into it, of whatever files: constants, and the
kernels that it calls, with theirs. The source file does not decide, it may have changed since it was imported.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib
import os
import pickle
import sys
import types
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from gproof.ir.private_folder import make_private, not_private, read_own

_DIGEST_BYTES = 32


def code_digest(kernel: Any, follow: Callable[[Any], tuple[Any, str] | None]) -> str:
    """A name for what a kernel compiles to: its code, the values of the globals it reads, its callees, and how.

    follow: of a global that is compiled too the plain function and how it is compiled, None for any other value.
    """
    digest = hashlib.blake2b(sys.version.encode(), digest_size=8)
    for part in _function(kernel, follow, set()):
        digest.update(part.encode("utf-8", "surrogatepass") + b"\0")
    return digest.hexdigest()


def _function(kernel: Any, follow: Callable[[Any], tuple[Any, str] | None], seen: set[object]) -> Iterator[str]:
    function, how = follow(kernel) or (kernel, "")
    code = function.__code__
    yield f"{function.__qualname__} {how}"
    # By the function: two of different files can have equal code and read different constants.
    if function in seen:
        return
    seen.add(function)
    yield from _code(code)
    yield from _value(function.__defaults__)
    for name in code.co_names:
        if name not in function.__globals__:
            continue
        value = function.__globals__[name]
        yield name
        yield from _value(value) if follow(value) is None else _function(value, follow, seen)


def _code(code: types.CodeType) -> Iterator[str]:
    yield code.co_code.hex()
    yield repr((code.co_argcount, code.co_flags, code.co_names, code.co_varnames))
    for constant in code.co_consts:
        yield from _value(constant)


def _value(value: Any) -> Iterator[str]:
    """Text that differs when what numba makes of a constant or a global differs."""
    if isinstance(value, types.CodeType):
        yield from _code(value)
    elif isinstance(value, tuple):
        yield f"tuple of {len(value)}"
        for part in value:
            yield from _value(part)
    elif hasattr(value, "tobytes"):  # arrays and numpy's numbers
        yield repr((value.dtype.str, value.shape, value.tobytes().hex()))
    elif isinstance(value, types.ModuleType):
        yield value.__name__
    elif callable(value):
        yield f"{getattr(value, '__module__', '')}.{getattr(value, '__qualname__', '')}"
    else:
        yield f"{type(value).__name__} {value!r}"


class FileCache:
    """What numba requests under the name of a cache: compile results by signature, in one folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    cache_path = property(lambda self: str(self.folder))

    def enable(self) -> None:
        """Always on."""

    disable = flush = enable

    def _place(self, arguments: tuple[Any, ...], magic: object) -> tuple[Path, str]:
        """The file for a signature on this processor, and the key that it has to hold."""
        import numba

        key = repr((numba.__version__, magic, [_kind(kind) for kind in arguments]))
        return self.folder / f"{hashlib.sha256(key.encode()).hexdigest()[:24]}.nbc", key

    def load_overload(self, signature: Any, target: Any) -> Any:
        """The compile result, None when there is none that fits."""
        arguments = _arguments(signature)
        place, key = self._place(arguments, target.codegen().magic_tuple())
        try:
            raw = read_own(place)
            if raw is None:
                return None
            payload = memoryview(raw)[_DIGEST_BYTES:]
            if hashlib.sha256(payload).digest() != raw[:_DIGEST_BYTES]:
                return None
            held, parts = pickle.loads(payload)
            if held != key:
                return None
            # Machine code needs the runtime's symbols and no more. ``target.refresh``, which compiling does, imports
            # all that numba can compile, and scipy where it is installed: that takes longer than a million lines.
            nrt: Any = importlib.import_module("numba.core.runtime")
            nrt.rtsys.initialize(target)
            compiler: Any = importlib.import_module("numba.core.compiler")
            result = compiler.CompileResult._rebuild(target, *parts)
        except Exception:  # Machine code of another numba, or no longer readable: it is compiled again.
            return None
        return result if tuple(result.signature.args) == arguments else None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep a compile result; without room or right to write it is simply not kept."""
        if result.library.has_dynamic_globals or any(not lifted.can_cache for lifted in result.lifted):
            return
        serialize: Any = importlib.import_module("numba.core.serialize")
        place, key = self._place(_arguments(signature), result.library.codegen.magic_tuple())
        if not_private(self.folder):
            return
        payload = serialize.dumps((key, result._reduce()))
        write_whole(place, hashlib.sha256(payload).digest() + payload)


def _kind(kind: Any) -> str:
    """What an argument is; of a named tuple the order of its fields too, which numba's own name of it does not tell."""
    return f"{kind} {getattr(kind, 'fields', '')}"


def _arguments(signature: Any) -> tuple[Any, ...]:
    return tuple(signature if isinstance(signature, tuple) else signature.args)


def write_whole(path: Path, content: bytes) -> None:
    """Write a file in one step, or not at all: the cache is never worth an error."""
    draft = path.with_name(f"{path.name}.{os.urandom(6).hex()}")
    try:
        make_private(path.parent)
        handle = os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o600)
        with os.fdopen(handle, "wb") as out:
            out.write(content)
        os.replace(draft, path)
    except OSError:
        with contextlib.suppress(OSError):
            draft.unlink()
