"""Faults on request: what the board's log and its answers show after each."""

from __future__ import annotations

import pytest
from support.emulated import X_STEP, Host, in_section, ready

from gproof.backend.boards.emulator.emulator import Options
from gproof.backend.boards.emulator.faults import Noise, Wire, noise, parsed
from gproof.backend.boards.emulator.log import MAGIC, ROW
from gproof.backend.boards.emulator.log_reader import read

BASE = 10_000_000


def faulty(text: str, **options: object) -> Options:
    return Options(faults=tuple(parsed(text)), **options)  # type: ignore[arg-type]


def moving(text: str) -> Host:
    """A motor makes a step each 1000 ticks from BASE for 20,000,000 ticks."""
    host = in_section(BASE, faulty(text))
    host.send(("queue_step", 0, 1000, 20_000, 0))
    host.listen()
    return host


def test_a_schedule_is_read_line_by_line() -> None:
    told = parsed("# nothing\n\n2 reset\nmotion+0.5 close 1 # gone\n1.5 drop to-board 3\n0.25 delay to-host 0.1\n")
    assert [(f.at, f.motion, f.kind, f.amount, f.to) for f in told] == [
        (250_000_000, False, "delay", 100_000_000, "to-host"),
        (500_000_000, True, "close", 1_000_000_000, ""),
        (1_500_000_000, False, "drop", 3, "to-board"),
        (2_000_000_000, False, "reset", 0, ""),
    ]
    for wrong in ("1", "x reset", "-1 reset", "nan reset", "1 drop 3", "1 drop to-moon 3", "1 close", "1 reset 2",
                  "1 drop to-host -1", "1 explode", "1e9 reset"):  # fmt: skip
        with pytest.raises(ValueError, match="line 2: no fault"):
            parsed("1 reset\n" + wrong)
    for wrong in ("drop", "drop=2", "drop=nan", "rain=1", "drop=0.1,drop=0.1", "burst=1e9"):
        with pytest.raises(ValueError):
            noise(wrong)
    assert noise("drop=0.5,bursts=0.1,burst=7") == Noise(drop=0.5, bursts=0.1, burst=7)


def test_bytes_that_are_lost_turned_or_doubled_are_noticed_by_the_checksum() -> None:
    for fault in ("drop", "flip", "double"):
        host = ready(faulty(f"0.1 {fault} to-board 1"))
        host.listen(0.1)
        (data,) = host.frames(("get_clock",))
        host.blocks.clear()
        host.board.write(data)
        host.board.write(b"\x7e" * 64)  # whatever the board still waits for has come
        assert host.listen() == []
        assert host.blocks and not any(payload for _, payload in host.blocks), fault
        host.board.write(data)
        assert [name for name, *_ in host.listen()] == ["clock"]


def test_answers_suffer_too() -> None:
    for fault in ("drop", "flip", "double"):
        host = ready(faulty(f"0.1 {fault} to-host 1"))
        host.listen(0.1)
        assert host.ask(("get_clock",)) == [], fault
        # A wrong length swallows the block behind it too.
        assert "clock" in [name for name, *_ in host.ask(("get_clock",)) + host.ask(("get_clock",))], fault


def test_delay_keeps_the_order() -> None:
    host = ready(faulty("0.1 delay to-host 0.2\n0.16 delay to-host 0"))
    host.listen(0.1)
    assert host.ask(("get_clock",), seconds=0.1) == []
    host.send(("get_uptime",))
    assert host.listen(0.05) == []
    assert [name for name, *_ in host.listen(0.1)] == ["clock", "uptime"]
    host = ready(faulty("0.1 delay to-board 0.5"))
    host.listen(0.1)
    assert host.ask(("get_clock",), seconds=0.4) == []
    ((_, clock),) = host.listen(0.2)
    assert int(clock) >= 16_000_000 * 0.6


def test_noise_is_seeded_and_as_frequent_as_told() -> None:
    data = bytes(100_000)
    first, again, other = (Wire("to-board", Noise(drop=0.01), seed).through(data) for seed in (1, 1, 2))
    assert first == again and len(first) != len(other)
    assert 98_700 < len(first) < 99_300
    assert 1_500 < sum(byte != 0 for byte in Wire("to-host", Noise(flip=0.02), 1).through(data)) < 2_500
    lost = 100_000 - len(Wire("to-host", Noise(bursts=0.001, burst=30), 1).through(data))
    assert 2_200 < lost < 3_700


def test_a_closed_link_loses_what_is_on_its_way_and_the_board_goes_on() -> None:
    host = moving("motion+0.7 close 0.5")
    host.listen(0.75)
    assert not host.board.connected
    host.send(("get_clock",))
    assert host.listen(0.3) == []
    host.listen(0.2)
    assert host.board.connected
    host.sequence = (host.sequence - 1) & 15  # the board never saw that block
    assert [name for name, *_ in host.ask(("get_clock",))] == ["clock"]
    host.listen(3)
    assert len(host.steps(X_STEP)) == 20_000
    assert [(e.kind, e.value) for e in host.log().events if e.kind == "L"] == [("L", 0), ("L", 1)]


def test_a_shutdown_by_itself_stops_motion() -> None:
    host = moving("motion+0.8 shutdown")
    assert [name for name, *_ in host.listen(1)] == ["shutdown"]
    stop = host.log().stops()[0]
    assert stop.reason == "Requested by a fault schedule"
    assert len(host.steps(X_STEP)) == (stop.tick - BASE) // 1000 > 0


def test_a_reset_forgets_everything_and_the_clock_starts_again() -> None:
    for fault, off in (("reset", 0.0), ("brown-out 0.25", 0.25)):
        host = moving(f"motion+0.8 {fault}")
        host.listen(1.5)
        told = host.log()
        assert [e.kind for e in told.events if e.kind in "BX"] == ["B", "B"]
        at = next(e.at for e in told.events if e.kind == "B" and e.boot == 1)
        made = len(host.steps(X_STEP))
        # Steps due by then were made, and none after: the board's clock counts 16 a microsecond from 0.
        assert made == (at * 16 // 1000 - BASE) // 1000 > 0
        assert set(told.steps.boot.tolist()) == {0}
        host.sequence = 0
        assert host.ask(("get_config",)) == [("config", 0, 0, 0, 0)]
        ((_, high, clock),) = host.ask(("get_uptime",))
        passed = host.board.now - at - round(off * 1e9)
        assert high == 0 and 0 < int(clock) <= passed * 16 // 1000
        assert host.board.state()["mechanics"] == {X_STEP: made} and host.board.state()["boots"] == 2


def test_a_stalled_board_answers_later_and_loses_what_it_cannot_keep() -> None:
    host = ready(faulty("0.1 stall 0.3"))
    host.listen(0.06)
    assert host.ask(("get_clock",), seconds=0.2) == []
    assert [name for name, *_ in host.listen(0.2)] == ["clock"]
    host = ready(faulty("0.1 stall 0.3"))
    host.listen(0.06)
    began = host.sequence
    for _ in range(10):
        host.send(*[("get_clock",)] * 50)  # 55 bytes each, and it keeps 192
    host.listen(1)
    assert host.board._sequence == (began + 3) & 15


def test_a_busy_main_loop_falls_behind() -> None:
    quick, slow = (ready(Options(busy=busy)) for busy in (0, 16_000))
    for host, most in ((quick, 0.0035), (slow, 0.02)):
        began = host.board.now
        host.send(("get_clock",), ("get_clock",), ("get_clock",), ("get_clock",))
        host.send(("get_uptime",))
        while not any(name == "uptime" for name, *_ in host.heard()):
            host.board.advance(host.board.now + 100_000)
        assert most / 10 < (host.board.now - began) / 1e9 < most
    # Four commands of a millisecond were before it.
    assert (host.board.now - began) / 1e9 > 0.004


def test_a_log_that_was_cut_or_is_none_is_told() -> None:
    host = moving("")
    host.listen(3)
    host.board.finish()
    data = bytes(host.board.log.held)
    assert (len(data) - len(MAGIC)) % ROW.size == 0
    assert read(data).complete and len(read(data).steps.tick) == 20_000
    cut = read(data[:-5])
    assert not cut.complete and len(cut.steps.tick) < 20_000
    for wrong in (b"", b"gproof", data[1:]):
        with pytest.raises(ValueError, match="no log"):
            read(wrong)
