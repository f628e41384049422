"""An interrupt in the middle of work that must not be cut: heard at once, raised behind it, by nobody swallowed."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

import numpy as np
import pytest

from gproof.ir.kernel import Kernel
from gproof.ir.kernel_cache import FileCache
from gproof.ir.uninterrupted import uninterrupted

SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]


@pytest.fixture
def heard() -> Iterator[list[int]]:
    """What a handler heard, that then interrupts."""
    numbers: list[int] = []

    def handler(number: int, _frame: FrameType | None) -> None:
        numbers.append(number)
        raise KeyboardInterrupt

    before = {number: signal.signal(number, handler) for number in SIGNALS}
    yield numbers
    for number, old in before.items():
        assert signal.getsignal(number) is handler, "put back as it was"
        signal.signal(number, old)


@pytest.mark.parametrize("number", SIGNALS)
def test_it_is_heard_at_once_and_raised_at_the_end(number: int, heard: list[int]) -> None:
    done = False
    with pytest.raises(KeyboardInterrupt), uninterrupted():
        signal.raise_signal(number)
        done = heard == [number]
    assert done


def test_a_second_one_is_raised_at_once(heard: list[int]) -> None:
    with pytest.raises(KeyboardInterrupt), uninterrupted():
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGTERM)
        pytest.fail("it went on")
    assert heard == [signal.SIGINT, signal.SIGTERM]


def test_one_in_another(heard: list[int]) -> None:
    done = False
    with pytest.raises(KeyboardInterrupt), uninterrupted():
        with uninterrupted():
            signal.raise_signal(signal.SIGINT)
        done = True
    assert done
    assert heard == [signal.SIGINT]


def test_ignored_signals_and_other_threads_change_nothing(heard: list[int]) -> None:
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    with uninterrupted():
        signal.raise_signal(signal.SIGHUP)
    handler = signal.getsignal(signal.SIGINT)
    seen = []

    def other() -> None:
        with uninterrupted():
            seen.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=other)
    thread.start()
    thread.join()
    assert seen == [handler]
    assert heard == []
    signal.signal(signal.SIGHUP, signal.getsignal(signal.SIGTERM))


def doubled(values):  # type: ignore[no-untyped-def]
    """Each twice."""
    return values * 2.0


def test_a_kernel_is_loaded_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, heard: list[int]) -> None:
    monkeypatch.setenv("GPROOF_CACHE_DIR", str(tmp_path))
    look = FileCache.load_overload

    def interrupted(self: FileCache, signature: object, target: object) -> object:
        signal.raise_signal(signal.SIGINT)
        return look(self, signature, target)

    for _ in ("compiled", "loaded"):
        one = Kernel(doubled, 1e-6, 1.0)
        with monkeypatch.context() as patch:
            patch.setattr(FileCache, "load_overload", interrupted)
            with pytest.raises(KeyboardInterrupt):
                one.compiled()(np.array([1.0]))
        assert heard.pop() == signal.SIGINT
        assert list(tmp_path.rglob("*.nbc")), "finished and kept"
        assert one.compiled()(np.array([1.0, 2.5])).tolist() == [2.0, 5.0]
