"""Signals while a job runs: who hears them, and what they ask for."""

import os
import signal
import threading
import time

import pytest
from backend.test_runtime import TWO, Person, Tap

from gproof.backend import runtime
from gproof.backend.control import Control
from gproof.backend.interrupts import interrupts
from gproof.backend.operators import WaitRequest
from gproof.backend.record_data import Result

ALL = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@pytest.mark.parametrize("number", ALL)
def test_before_the_run_a_signal_interrupts_and_after_it_nothing_is_left(number: signal.Signals) -> None:
    before = [signal.getsignal(n) for n in ALL]
    control = Control()
    with interrupts(control):
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), number)
        assert not control.signalled
        runtime.walk(TWO, Tap(2), control=control)
        os.kill(os.getpid(), number)
        assert not control.stop_asked
        assert not control.signalled
    assert [signal.getsignal(n) for n in ALL] == before


@pytest.mark.parametrize("number", ALL)
def test_a_signal_ends_a_question_at_rest(number: signal.Signals) -> None:
    class Asked(Person):
        def wait(self, request: WaitRequest):
            os.kill(os.getpid(), number)
            time.sleep(5)
            return "on"

    control = Control()
    record = runtime.walk(TWO, Tap(2), operator=Asked(), control=control)
    # Who had slept to the end would have gone on.
    assert record.result is Result.STOPPED
    assert record.position == TWO.stream.sections[0].end()
    assert control.signalled


def test_who_can_not_be_asked_answers_nothing() -> None:
    class Gone(Person):
        def wait(self, request: WaitRequest):
            raise BrokenPipeError

    record = runtime.walk(TWO, Tap(2), operator=Gone())
    assert record.result is Result.STOPPED
    assert "waiting" in record.reason


def test_somebody_who_watches_and_goes_away_stops_nothing() -> None:
    def gone(_: float) -> None:
        raise BrokenPipeError

    assert runtime.walk(TWO, Tap(2), on_progress=gone).result is Result.COMPLETED


def test_what_is_ignored_stays_ignored() -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with interrupts(Control()):
            assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
            assert signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL
    finally:
        signal.signal(signal.SIGHUP, before)


def test_another_thread_hears_nothing_and_changes_nothing() -> None:
    before = [signal.getsignal(n) for n in ALL]
    seen = []

    def work() -> None:
        with interrupts(Control()):
            seen.extend(signal.getsignal(n) for n in ALL)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen == before


def test_signals_while_a_signal_is_handled_hang_nothing() -> None:
    """Handlers interrupt one another: what they ask with must hold no lock."""
    control = Control()
    control.running()
    over = threading.Event()

    def storm() -> None:
        while not over.is_set():
            os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=storm, daemon=True)
    with interrupts(control):
        thread.start()
        until = time.monotonic() + 0.3
        while time.monotonic() < until:
            control.answered()
        over.set()
        thread.join()
        assert control.signalled
