"""What the emulated chip does with runs, outputs, inputs and sections; ticks worked out by hand."""

from __future__ import annotations

import random
import zlib

from support.emulated import FAN, IDENTITY, LIMIT, SETUP, X_STEP, Y_STEP, Host, in_section, ready

from gproof.backend.boards.emulator.emulator import Options
from gproof.backend.boards.emulator.objects import Switch

BASE = 10_000_000
PLAIN = Options(certified=False)
SPLIT_AND_WHOLE = (
    (("queue_step", 0, 2000, 3, 10), ("queue_step", 0, 2030, 2, 10)),
    (("queue_step", 0, 2000, 5, 10),),
    tuple(("queue_step", 0, 2000 + 10 * k, 1, 10) for k in range(5)),
)


def plain(base: int = BASE, options: Options = PLAIN) -> Host:
    host = ready(options)
    host.send(("reset_step_clock", 0, base), ("reset_step_clock", 1, base), ("set_next_step_dir", 0, 1))
    assert host.listen() == []
    return host


def reason(host: Host, *commands: tuple[object, ...], seconds: float = 0.05) -> str:
    """Why the board shuts down after commands; empty: it does not."""
    told = {number: text for text, number in host.board._language.reasons.items()}
    for name, *values in host.ask(*commands, seconds=seconds):
        if name == "shutdown":
            assert host.log().stops()[-1].reason == told[int(values[1])]
            return told[int(values[1])]
    return ""


def test_steps_are_where_the_runs_say() -> None:
    host = plain()
    host.send(("queue_step", 0, 1000, 3, 10), ("set_next_step_dir", 0, 0), ("queue_step", 0, 500, 2, -100))
    host.send(("queue_step", 1, 20_000, 1, 0), ("stepper_get_position", 0))
    assert ("stepper_position", 0, 0) in host.listen()
    host.until(BASE + 30_000)
    assert host.steps(X_STEP) == [
        (BASE + 1000, 1), (BASE + 2010, 1), (BASE + 3030, 1), (BASE + 3530, -1), (BASE + 3930, -1),
    ]  # fmt: skip
    assert host.steps(Y_STEP) == [(BASE + 20_000, -1)]
    assert ("stepper_position", 0, 1) in host.ask(("stepper_get_position", 0))
    # Idle: the next interval counts from the last step, a long time ago: too late.
    assert reason(host, ("queue_step", 0, 500, 1, 0)) == "Timer too close"


def test_an_emergency_stop_leaves_exactly_the_steps_due() -> None:
    host = plain()
    host.send(("queue_step", 0, 3000, 60_000, 0), ("queue_step", 0, 3000, 60_000, 0))
    host.listen()
    host.until(BASE + 1_000_000)
    ((_, clock, number),) = host.ask(("emergency_stop",))
    assert isinstance(clock, int) and number == host.board._language.reasons["Command request"]
    made = (clock - BASE) // 3000
    assert 333 < made < 1000
    assert host.steps(X_STEP) == [(BASE + 3000 * k, 1) for k in range(1, made + 1)]
    # In a shutdown a query is refused, the position is known after it was cleared, runs are dropped without a base.
    assert host.ask(("stepper_get_position", 0)) == [("is_shutdown", number)]
    assert host.ask(("clear_shutdown",), ("stepper_get_position", 0)) == [("stepper_position", 0, made)]
    assert host.ask(("queue_step", 0, 3000, 5, 0)) == []
    assert host.ask(("get_config",)) == [("config", 1, 77, 0, 678)]
    assert len(host.steps(X_STEP)) == made
    assert reason(host, ("clear_shutdown",)) == "Shutdown cleared when not shutdown"


def test_reasons_of_a_shutdown() -> None:
    half = 1 << 31
    cases = {
        "Timer too close": (
            [("reset_step_clock", 0, 100), ("queue_step", 0, 1000, 1, 0)],  # past
            [("queue_step", 0, half, 1, 0)],  # more than half the clock ahead of the base
            [("queue_step", 0, 1000, 1, 0), ("queue_step", 0, half, 1, 0)],  # when the step before is made
            [("queue_step", 0, 100, 3, -60)],  # the third interval is -20
            [("queue_digital_out", 2, 100, 1)],
        ),
        "Can't reset time when stepper active": ([("queue_step", 0, 1000, 1, 0), ("reset_step_clock", 0, BASE)],),
        "Invalid count parameter": ([("queue_step", 0, 1000, 0, 0)],),
        "Invalid oid type": ([("queue_step", 2, 1000, 1, 0)], [("stepper_get_position", 63)]),
        "Command request": ([("emergency_stop",)],),
        "Already finalized": ([("finalize_config", 1)], [("config_trsync", 1)]),
        "oids already allocated": ([("allocate_oids", 2)],),
        "config_reset only available when shutdown": ([("config_reset",)],),
        "Not a free pin": ([("set_digital_out", FAN, 1)], [("set_digital_out", 200, 1)]),
    }
    for text, programs in cases.items():
        for program in programs:
            assert reason(plain(), *program, seconds=1.0) == text, program
    unset = Host()
    assert reason(unset, ("allocate_oids", 1), ("config_trsync", 1)) == "Can't assign oid"
    assert reason(Host(), ("allocate_oids", 1), ("queue_step", 0, 1, 1, 0)) == "Invalid oid type"
    assert reason(Host(), *SETUP[:2], ("config_stepper", 1, X_STEP, 7, 0, 32)) == "Not a free pin"


def test_a_bad_interval_ends_motion_at_the_step_before_it() -> None:
    host = plain()
    host.send(("queue_step", 0, 1000, 5, -400))  # 1000, 600, 200, -200
    host.listen(1)
    assert host.steps(X_STEP) == [(BASE + 1000, 1), (BASE + 1600, 1), (BASE + 1800, 1)]
    assert host.log().stops()[0].tick == BASE + 1800


def test_the_move_pool_is_shared_and_counted() -> None:
    for chip, moves in (("atmega2560", 678), ("atmega328p", 122)):
        host = Host(Options(certified=False, chip=chip))
        host.send(("allocate_oids", 2), ("config_stepper", 0, 8, 9, 0, 32), ("config_stepper", 1, 10, 11, 0, 32))
        host.send(("finalize_config", 1), *(("reset_step_clock", oid, 80_000_000) for oid in (0, 1)))
        for k in range(moves):
            host.send(("queue_step", k % 2, 9000, 1, 0))
            host.listen(0.002)
        assert host.ask(("get_config",)) == [("config", 1, 1, 0, moves)]
        assert reason(host, ("queue_step", 0, 9000, 1, 0)) == "Move queue overflow"
        assert host.steps(8) == []


def test_the_clock_wraps_and_nothing_else_happens() -> None:
    start = 2**32 - 4_000_000
    host = ready(Options(certified=False, start=start))
    base = (start + 3_500_000) % 2**32
    host.send(("reset_step_clock", 0, base), ("set_next_step_dir", 0, 1), ("queue_step", 0, 400_000, 4, 0))
    host.listen(0.5)
    # The third is past the wrap; the log's ticks go on.
    assert host.steps(X_STEP) == [(start + 3_500_000 + 400_000 * k, 1) for k in range(1, 5)]
    (clock,), (uptime,) = host.ask(("get_clock",)), host.ask(("get_uptime",))
    assert clock[0] == "clock" and int(clock[1]) < 2**27 and uptime[1] == 1


def test_a_new_base_carries_a_motor_over_a_long_wait() -> None:
    host = plain()
    host.send(("queue_step", 0, 1000, 1, 0))
    host.listen(200)  # 3.2e9 ticks
    assert host.ask(("get_config",))[0][3] == 0
    now = host.board.chip.now
    host.send(("reset_step_clock", 0, (now + 2_000_000) % 2**32), ("queue_step", 0, 5000, 1, 0))
    host.listen(1)
    assert host.steps(X_STEP) == [(BASE + 1000, 1), (now + 2_005_000, 1)]


def test_the_clock_drifts_as_it_was_told() -> None:
    for drift in (-200_000, 0, 200_000):  # parts in a thousand million
        host = Host(Options(drift=drift))
        host.listen(1000)
        assert host.board.chip.now == 16_000_000_000 + 16 * drift
    first, again = (Host(Options(wander=100_000, seed=5)) for _ in range(2))
    for host in (first, again):
        host.listen(100)
    assert first.board.chip.now == again.board.chip.now != 1_600_000_000
    assert abs(first.board.chip.now - 1_600_000_000) < 160_000


def test_outputs_switch_at_their_tick_and_fall_back_in_a_shutdown() -> None:
    host = plain()
    host.send(("queue_digital_out", 2, BASE + 700, 1), ("update_digital_out", 2, 0))
    host.send(("queue_digital_out", 2, BASE, 1), ("queue_digital_out", 2, BASE + 500, 0))
    host.send(("queue_digital_out", 2, BASE + 900, 1))
    host.listen(1)
    host.ask(("emergency_stop",))
    told = [(e.tick, e.value) for e in host.log().events if e.kind == "O" and e.what == FAN and e.tick >= BASE]
    # What was queued before the update has gone with it.
    assert told[:3] == [(BASE, 1), (BASE + 500, 0), (BASE + 900, 1)]
    assert [value for _, value in told[3:]] == [0]


def test_homing_stops_at_the_sample_that_saw_the_switch() -> None:
    at = -120
    host = in_section(BASE, Options(switches=(Switch(LIMIT, X_STEP, False, at),)))
    host.send(
        ("set_next_step_dir", 0, 0), ("trsync_start", 4, BASE, 3_000_000, 9), ("trsync_set_timeout", 4, 60_000_000)
    )
    host.send(("stepper_stop_on_trigger", 0, 4), ("endstop_home", 3, BASE, 400, 4, 1000, 1, 4, 1))
    host.send(("queue_step", 0, 5000, 1000, 0))
    answers = host.listen(1)
    # Step 120 is made at BASE + 600000, a sample is at that tick; three more at 400 ticks each: 601200 stops it.
    assert ("trsync_state", 4, 1, 0, BASE) in answers
    assert ("trsync_state", 4, 0, 1, BASE + 601_200) in answers
    assert host.steps(X_STEP)[-1] == (BASE + 600_000, -1)
    found = host.ask(("stepper_get_position", 0), ("endstop_query_state", 3), ("queue_step", 0, 5000, 1, 0))
    assert found == [("stepper_position", 0, at), ("endstop_state", 3, 0, BASE + 601_000, 1)]
    # Nobody came back for the promise: it was a rest, so the section can be finished.
    assert host.ask(("cert_finish", host.board.chip.now + 1000), ("cert_get_state",))[0][1] in (1, 2)


def test_a_trigger_without_a_host_expires() -> None:
    host = plain()
    host.send(
        ("trsync_start", 4, 0, 0, 9), ("trsync_set_timeout", 4, BASE + 100_000), ("stepper_stop_on_trigger", 0, 4)
    )
    host.send(("queue_step", 0, 1000, 500, 0))
    assert ("trsync_state", 4, 0, 9, BASE + 100_000) in host.listen(1)
    assert len(host.steps(X_STEP)) == 100


# Sections.


def crc(*records: str) -> int:
    return zlib.crc32(IDENTITY + b"".join(map(bytes.fromhex, records)))


HEAD, FIRST_BASE = "07000000", "4200000000"
RUN_OF_5 = "52 d0070000 05000000 0a00 01"
RUN_OF_2 = "52 d0070000 02000000 0a00 01"
BACK = "52 88130000 01000000 0000 00"


def test_the_example_of_the_page() -> None:
    told = [crc(HEAD), crc(HEAD, FIRST_BASE), *(crc(HEAD, FIRST_BASE, run) for run in (RUN_OF_2, RUN_OF_5))]
    assert [f"{value:08x}" for value in told] == ["24ced456", "90adb27d", "8028d150", "458fefde"]


def test_counts_and_checksums_of_executed_runs() -> None:
    for runs in SPLIT_AND_WHOLE:
        host = in_section(BASE)
        host.send(*runs, ("set_next_step_dir", 0, 0), ("queue_step", 0, 5000, 1, 0))
        host.listen()
        assert host.ask(("cert_get_motor", 0)) == [("cert_motor", 0, 0, 0, crc(HEAD, FIRST_BASE))]
        host.listen(1)
        assert host.ask(("cert_get_motor", 0)) == [("cert_motor", 0, 6, 4, 0x8E12422E)]
        assert crc(HEAD, FIRST_BASE, RUN_OF_5, BACK) == 0x8E12422E
        assert host.ask(("cert_get_motor", 1)) == [("cert_motor", 1, 0, 0, crc(HEAD, FIRST_BASE))]


def test_a_run_that_was_cut_counts_to_its_last_step() -> None:
    host = in_section(BASE)
    host.send(("cert_commit", BASE + 5000), ("queue_step", 0, 2000, 5, 10))
    answers = host.listen(1)
    assert answers == [("shutdown", BASE + 5000, host.board._language.reasons["Promise expired"])]
    # Steps at 2000 and 4010; the third would be at 6030.
    assert host.steps(X_STEP) == [(BASE + 2000, 1), (BASE + 4010, 1)]
    wanted = [("cert_motor", 0, 2, 2, crc(HEAD, FIRST_BASE, RUN_OF_2)), ("cert_state", 3, 7, BASE + 5000, BASE + 5000)]
    assert host.ask(("cert_get_motor", 0), ("cert_get_state",)) == wanted
    # Also when the shutdown is over; a step needs the identity again.
    assert host.ask(("clear_shutdown",), ("cert_get_motor", 0)) == [wanted[0]]
    assert host.ask(("cert_get_identity",)) == [("cert_identity", IDENTITY)]
    assert reason(host, ("cert_section", 8, BASE * 20)) == "Not certified"


def test_a_step_at_the_promise_is_made_and_all_motors_stop_together() -> None:
    host = in_section(BASE)
    host.send(("queue_step", 0, 1000, 50, 0), ("queue_step", 1, 777, 50, 0), ("cert_commit", BASE + 7000))
    host.listen(1)
    assert host.steps(X_STEP)[-1] == (BASE + 7000, 1) and host.steps(Y_STEP)[-1] == (BASE + 9 * 777, 1)
    assert [event.tick for event in host.log().stops()] == [BASE + 7000]


def test_nothing_moves_before_the_identity_is_presented() -> None:
    base = ("reset_step_clock", 0, BASE)
    step = ("queue_step", 0, 1000, 1, 0)
    begin = ("cert_begin", IDENTITY)
    section = ("cert_section", 1, BASE)
    for program in (
        (base, step),
        (base, begin, step),
        (section, base, step),
        (("cert_begin", IDENTITY[:31]), section, base, step),
        (begin, section, base, ("cert_finish", BASE + 10), step),
        (begin, section, section),
        (begin, section, begin),
        (("cert_commit", BASE),),
        (("cert_rest",),),
        (("cert_finish", BASE),),
    ):
        host = ready()
        assert reason(host, *program, seconds=0.7) == "Not certified", program
        assert host.steps(X_STEP) == []
    # A section of which nothing is promised ends at its first tick.
    host = ready()
    assert reason(host, begin, section, base, step, seconds=1) == "Promise expired"
    assert host.steps(X_STEP) == []


def test_sections_follow_one_another() -> None:
    host = in_section(BASE)
    host.send(("queue_step", 0, 1000, 10, 0), ("cert_finish", BASE + 5000))
    host.listen()
    host.until(BASE + 9000)
    assert host.board.chip.sections is not None and host.board.chip.sections.state == 2
    host.until(BASE + 10_000)
    assert host.ask(("cert_get_state",))[0][:3] == ("cert_state", 1, 7)
    host.send(("cert_section", 8, BASE + 9_000_000), ("cert_get_motor", 0))
    assert host.listen() == [("cert_motor", 0, 0, 10, crc("08000000"))]
    assert [(e.kind, e.value, e.tick) for e in host.log().events if e.kind in "CE"] == [
        ("C", 7, BASE), ("E", 7, BASE + 10_000), ("C", 8, BASE + 9_000_000),
    ]  # fmt: skip


def test_random_runs_cut_anywhere_equal_steps_made_one_by_one() -> None:
    random.seed(2100)
    for _ in range(40):
        host = in_section(BASE)
        runs, tick, steps = [], BASE, []
        for _ in range(random.randrange(1, 8)):
            count, add = random.randrange(1, 40), random.randrange(-20, 20)
            interval, direction = random.randrange(900, 4000), random.randrange(2)
            runs += [("set_next_step_dir", 0, direction), ("queue_step", 0, interval, count, add)]
            for k in range(count):
                tick += interval + k * add
                steps.append((tick, 1 if direction else -1))
        stop = random.randrange(BASE, tick + 3000)
        host.send(*runs, ("cert_commit", stop))
        host.listen(1)
        made = [step for step in steps if step[0] <= stop]
        assert host.steps(X_STEP) == made
        position = sum(direction for _, direction in made)
        (answer,) = host.ask(("cert_get_motor", 0))
        assert answer[:4] == ("cert_motor", 0, len(made), position)
