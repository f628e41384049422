"""The chip behind the line: commands executed at a tick of its clock, answers, shutdown, timers.

It knows no nanoseconds: whoever drives it says which tick it is (``advance``), gives it payloads and takes the answers.
Source: Klipper's MCU_Commands.md; docs/boards.md; the certification extension there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from gproof.backend.boards.emulator.dictionary import IN_SHUTDOWN, Chip, Language
from gproof.backend.boards.emulator.log import Log
from gproof.backend.boards.emulator.motors import Motor, Refused
from gproof.backend.boards.emulator.objects import MISSED, QUICKEST, Endstop, Output, Switch, Trigger
from gproof.backend.boards.emulator.sections import NEVER_STARTED, Sections
from gproof.backend.boards.emulator.wire import MASK, Short, signed, take_number

Thing = Motor | Output | Endstop | Trigger


@dataclass(slots=True)
class World:
    """What outlives a reset. mechanics: steps by step pin; inputs: levels that somebody set, by pin."""

    switches: tuple[Switch, ...] = ()
    mechanics: dict[int, int] = field(default_factory=dict)
    inputs: dict[int, int] = field(default_factory=dict)


class ChipState:
    """A chip from reset to reset. log_at: the nanosecond of the world, for the log."""

    def __init__(self, chip: Chip, language: Language, certified: bool, world: World, log: Log) -> None:
        self.chip = chip
        self.language = language
        self.world = world
        self.log = log
        self.log_at = 0
        self.now = 0
        self.answers: list[bytes] = []
        self.wants_reset = False
        self.stop_reason: str | None = None
        self.stopped_at = 0
        self.motion_began = False
        self.sections = Sections() if certified else None
        self._oids: list[Thing | None] | None = None
        self._crc: int | None = None
        self._pins: set[int] = set()
        self._reset_things()
        table: dict[str, Callable[..., None]] = {
            name: getattr(self, f"_{name}") for name in (f.name for f in language.commands.values())
        }
        self._does = {told: (form, table[form.name]) for told, form in language.commands.items()}

    def _reset_things(self) -> None:
        self._motors: list[Motor] = []
        self._outputs: list[Output] = []
        self._endstops: list[Endstop] = []
        self._triggers: list[Trigger] = []
        self._oids = None
        self._crc = None
        self._pins.clear()

    # Time.

    def next_timer(self) -> int | None:
        """The tick of the next thing that happens without a command; not before the present one."""
        found = [m.dead_at for m in self._motors if m.dead_at is not None]
        for thing in self._timed:
            due = thing.at if isinstance(thing, Endstop) else thing.due()
            if due is not None:
                found.append(due)
        if self.sections is not None and (due := self.sections.due()) is not None:
            found.append(due)
        return min(found, default=None)

    @property
    def _timed(self) -> Sequence[Output | Endstop | Trigger]:
        return [*self._outputs, *self._endstops, *self._triggers]

    def advance(self, tick: int) -> None:
        """Let time pass until the clock shows a tick."""
        while (due := self.next_timer()) is not None and due <= tick:
            self._fire(max(due, self.now))
        self._run(tick)

    def _run(self, tick: int) -> None:
        for motor in self._motors:
            motor.run(tick)
        self.now = max(self.now, tick)

    def _fire(self, tick: int) -> None:
        """Everything that is due at a tick."""
        if self.sections is not None and self.sections.expired(tick):
            # Steps due at the promise itself are made, and none after it.
            self._run(tick - 1)
            self._stop("Promise expired", self.now)
            return
        self._run(tick)
        if any(m.dead_at is not None and m.dead_at <= tick for m in self._motors):
            self._stop("Timer too close", tick)
            return
        try:
            for output in self._outputs:
                self._fire_output(output)
            for endstop in self._endstops:
                if endstop.at is not None and endstop.at <= tick and endstop.take(self.level(endstop)):
                    assert endstop.trigger is not None
                    self._trigger(endstop.trigger, endstop.reason)
            for trigger in self._triggers:
                self._fire_trigger(trigger)
        except Refused as refused:
            self._stop(str(refused), tick)
        if self.sections is not None and self.sections.over(
            tick, max((m.end for m in self._motors if m.active), default=0)
        ):
            self.log.row(b"E", self.log_at, count=self.sections.number, tick=tick)

    def _fire_output(self, output: Output) -> None:
        while output.queue and output.queue[0][0] <= self.now:
            output.set(self.now, output.queue.popleft()[1])
            self._log_output(output)
        if output.deadline is not None and output.deadline <= self.now:
            raise Refused(MISSED)

    def _fire_trigger(self, trigger: Trigger) -> None:
        if trigger.expires is not None and trigger.expires <= self.now:
            self._trigger(trigger, trigger.expire_reason)
        if trigger.report_at is not None and trigger.report_at <= self.now:
            self._report(trigger)
            trigger.report_at += trigger.report_every

    def _log_output(self, output: Output) -> None:
        self.log.row(b"O", self.log_at, index=output.pin, count=output.value, tick=self.now)

    def _active(self) -> bool:
        return any(motor.active for motor in self._motors)

    def settle(self) -> None:
        """Put every step made so far into the log."""
        for motor in self._motors:
            motor.settle(self.now)

    # Motors and inputs in the world.

    def _steps_logged(self, motor: Motor, last: int, interval: int, add: int, count: int, direction: int) -> None:
        sign = 1 if direction else -1
        self.log.row(
            b"S", self.log_at, index=motor.step_pin, direction=sign, count=count, tick=last, interval=interval & MASK,
            add=add,
        )  # fmt: skip
        mechanics = self.world.mechanics
        mechanics[motor.step_pin] = mechanics.get(motor.step_pin, 0) + sign * count

    def mechanical(self, step_pin: int) -> int:
        """Steps of a motor since the emulator was started."""
        closed = self.world.mechanics.get(step_pin, 0)
        open_steps = sum(m.position_at(self.now) - m.position for m in self._motors if m.step_pin == step_pin)
        return closed + open_steps

    def level(self, endstop: Endstop) -> int:
        """What an input pin shows now."""
        for switch in self.world.switches:
            if switch.pin == endstop.pin:
                at = self.mechanical(switch.step_pin)
                beyond = at >= switch.position if switch.above else at <= switch.position
                return switch.level if beyond else 1 - switch.level
        return self.world.inputs.get(endstop.pin, endstop.pull_up)

    # Commands.

    def block(self, payload: bytes) -> int:
        """Execute the commands of a block; their number. The clock is that of ``advance``."""
        place = count = 0
        while place < len(payload):
            count += 1
            try:
                told, place = take_number(payload, place)
                found = self._does.get(signed(told))
                if found is None:
                    raise Refused("Invalid command")
                form, does = found
                values, place = form.decoded(payload, place)
            except Short:
                self._stop("Command parser error", self.now)
                return count
            except Refused as refused:
                self._stop(str(refused), self.now)
                return count
            if self.stop_reason is not None and form.name not in IN_SHUTDOWN:
                self._say("is_shutdown", self.language.reasons[self.stop_reason])
                continue
            try:
                does(*values)
            except Refused as refused:
                self._stop(str(refused), self.now)
        return count

    def _say(self, name: str, *values: int | bytes) -> None:
        self.answers.append(self.language.answer(name, *values))

    def shut_down(self, reason: str) -> None:
        """Stop for a reason of the dictionary."""
        self._stop(reason, self.now)

    def _stop(self, reason: str, tick: int) -> None:
        """All motors stop after the steps due at a tick. The first reason counts."""
        if self.stop_reason is not None:
            return
        for motor in self._motors:
            motor.stop(tick)
        for endstop in self._endstops:
            endstop.at = None
        for trigger in self._triggers:
            trigger.can, trigger.report_at, trigger.expires = False, None, None
        self.stop_reason, self.stopped_at = reason, tick & MASK
        self.log.stop(self.log_at, tick, reason)
        for output in self._outputs:
            output.queue.clear()
            output.deadline = None
            if output.value != output.safe:
                output.value = output.safe
                self._log_output(output)
        if self.sections is not None:
            self.sections.forget()
        self._say("shutdown", tick & MASK, self.language.reasons[reason])

    def _identify(self, offset: int, count: int) -> None:
        self._say("identify_response", offset, self.language.packed[offset : offset + min(count, 50)])

    def _get_clock(self) -> None:
        self._say("clock", self.now & MASK)

    def _get_uptime(self) -> None:
        self._say("uptime", self.now >> 32 & MASK, self.now & MASK)

    def _get_config(self) -> None:
        configured = self._crc is not None
        moves = self.chip.moves if configured else 0
        self._say("config", int(configured), self._crc or 0, int(self.stop_reason is not None), moves)

    def _emergency_stop(self) -> None:
        self._stop("Command request", self.now)

    def _clear_shutdown(self) -> None:
        if self.stop_reason is None:
            raise Refused("Shutdown cleared when not shutdown")
        self.stop_reason = None

    def _reset(self) -> None:
        self.wants_reset = True

    def _config_reset(self) -> None:
        if self.stop_reason is None:
            raise Refused("config_reset only available when shutdown")
        self.settle()
        self._reset_things()

    # Configuration.

    def _allocate_oids(self, count: int) -> None:
        if self._oids is not None:
            raise Refused("oids already allocated")
        if count > self.chip.most_oids:
            raise Refused("Can't assign oid")
        self._oids = [None] * count

    def _finalize_config(self, crc: int) -> None:
        if self._oids is None or self._crc is not None:
            raise Refused("Already finalized" if self._crc is not None else "Not finalized")
        self._crc = crc

    def _assign(self, oid: int, *pins: int) -> None:
        """Check that an oid and pins are free, and take the pins."""
        if self._crc is not None:
            raise Refused("Already finalized")
        if self._oids is None or oid >= len(self._oids) or self._oids[oid] is not None:
            raise Refused("Can't assign oid")
        for pin in pins:
            self._check_pin(pin)
            self._pins.add(pin)

    def _check_pin(self, pin: int) -> None:
        port = chr(65 + pin // 8)
        if pin in self._pins or pin // 8 > 25 or port not in self.chip.ports:
            raise Refused("Not a free pin")

    def _put(self, oid: int, thing: Thing) -> None:
        assert self._oids is not None
        self._oids[oid] = thing

    def _config_stepper(self, oid: int, step_pin: int, dir_pin: int, invert_step: int, pulse: int) -> None:
        self._assign(oid, step_pin, dir_pin)
        motor = Motor(len(self._motors), step_pin, dir_pin, self._steps_logged)
        self._put(oid, motor)
        self._motors.append(motor)

    def _config_digital_out(self, oid: int, pin: int, value: int, default_value: int, max_duration: int) -> None:
        self._assign(oid, pin)
        output = Output(pin, int(value != 0), int(default_value != 0), max_duration)
        output.set(self.now, output.value)
        self._put(oid, output)
        self._outputs.append(output)
        self._log_output(output)

    def _config_endstop(self, oid: int, pin: int, pull_up: int) -> None:
        self._assign(oid, pin)
        endstop = Endstop(pin, int(pull_up != 0))
        self._put(oid, endstop)
        self._endstops.append(endstop)

    def _config_trsync(self, oid: int) -> None:
        self._assign(oid)
        trigger = Trigger(oid)
        self._put(oid, trigger)
        self._triggers.append(trigger)

    def _thing(self, oid: int) -> Thing | None:
        return self._oids[oid] if self._oids is not None and oid < len(self._oids) else None

    def _motor(self, oid: int) -> Motor:
        thing = self._thing(oid)
        if not isinstance(thing, Motor):
            raise Refused("Invalid oid type")
        return thing

    def _output(self, oid: int) -> Output:
        thing = self._thing(oid)
        if not isinstance(thing, Output):
            raise Refused("Invalid oid type")
        return thing

    def _endstop(self, oid: int) -> Endstop:
        thing = self._thing(oid)
        if not isinstance(thing, Endstop):
            raise Refused("Invalid oid type")
        return thing

    def _trigger_of(self, oid: int) -> Trigger:
        thing = self._thing(oid)
        if not isinstance(thing, Trigger):
            raise Refused("Invalid oid type")
        return thing

    # Motion.

    def _place(self) -> None:
        """One more place of the move pool is needed."""
        if self._crc is None:
            raise Refused("Move queue overflow")
        used = sum(m.stored for m in self._motors) + sum(len(o.queue) for o in self._outputs)
        if used >= self.chip.moves:
            raise Refused("Move queue overflow")

    def _queue_step(self, oid: int, interval: int, count: int, add: int) -> None:
        motor = self._motor(oid)
        if self.sections is not None:
            self.sections.check_step()
        self._place()
        motor.queue(self.now, interval, count, add)
        self.motion_began |= motor.active

    def _set_next_step_dir(self, oid: int, dir: int) -> None:
        self._motor(oid).direction = int(dir != 0)

    def _reset_step_clock(self, oid: int, clock: int) -> None:
        motor = self._motor(oid)
        motor.reset_clock(self.now + signed(clock - self.now))
        if self.sections is not None:
            motor.proof.base(clock - self.sections.base)

    def _stepper_get_position(self, oid: int) -> None:
        self._say("stepper_position", oid, self._motor(oid).position_at(self.now))

    def _stepper_stop_on_trigger(self, oid: int, trsync_oid: int) -> None:
        motor, trigger = self._motor(oid), self._trigger_of(trsync_oid)
        if motor not in trigger.motors:
            trigger.motors.append(motor)

    # Outputs.

    def _queue_digital_out(self, oid: int, clock: int, on_ticks: int) -> None:
        output = self._output(oid)
        self._place()
        output.schedule(self.now, clock, int(on_ticks != 0))

    def _update_digital_out(self, oid: int, value: int) -> None:
        output = self._output(oid)
        output.queue.clear()
        output.set(self.now, int(value != 0))
        self._log_output(output)

    def _set_digital_out(self, pin: int, value: int) -> None:
        self._check_pin(pin)
        self.log.row(b"O", self.log_at, index=pin, count=int(value != 0), tick=self.now)

    # Homing.

    def _endstop_home(
        self, oid: int, clock: int, sample_ticks: int, sample_count: int, rest_ticks: int, pin_value: int,
        trsync_oid: int, trigger_reason: int,
    ) -> None:  # fmt: skip
        endstop = self._endstop(oid)
        endstop.at, endstop.first = None, 0
        if not sample_count:
            return
        endstop.trigger = self._trigger_of(trsync_oid)
        endstop.at = self.now + signed(clock - self.now)
        if endstop.at < self.now or rest_ticks < QUICKEST or (sample_count > 1 and sample_ticks < QUICKEST):
            raise Refused("Timer too close")
        endstop.every, endstop.sample = rest_ticks, sample_ticks
        endstop.count = endstop.left = sample_count
        endstop.wanted, endstop.reason = int(pin_value != 0), trigger_reason

    def _endstop_query_state(self, oid: int) -> None:
        endstop = self._endstop(oid)
        clock = endstop.at if endstop.at is not None else endstop.fired
        self._say("endstop_state", oid, int(endstop.at is not None), clock & MASK, self.level(endstop))

    def _trsync_start(self, oid: int, report_clock: int, report_ticks: int, expire_reason: int) -> None:
        trigger = self._trigger_of(oid)
        trigger.motors.clear()
        trigger.can, trigger.reason, trigger.expires = True, 0, None
        trigger.report_every, trigger.expire_reason = report_ticks, expire_reason
        trigger.report_at = None
        if report_ticks:
            trigger.report_at = self.now + signed(report_clock - self.now)
            if trigger.report_at < self.now or report_ticks < QUICKEST:
                raise Refused("Timer too close")

    def _trsync_set_timeout(self, oid: int, clock: int) -> None:
        trigger = self._trigger_of(oid)
        if not trigger.can:
            return
        trigger.expires = self.now + signed(clock - self.now)
        if trigger.expires < self.now:
            raise Refused("Timer too close")

    def _trsync_trigger(self, oid: int, reason: int) -> None:
        trigger = self._trigger_of(oid)
        fired = self._trigger(trigger, reason)
        if not fired:
            self._report(trigger)

    def _trigger(self, trigger: Trigger, reason: int) -> bool:
        if not trigger.can:
            return False
        trigger.can, trigger.reason = False, reason
        trigger.report_at = trigger.expires = None
        for motor in trigger.motors:
            motor.stop(self.now)
        self._report(trigger)
        return True

    def _report(self, trigger: Trigger) -> None:
        self._say("trsync_state", trigger.oid, int(trigger.can), trigger.reason, self.now & MASK)

    # Certification.

    def _proving(self) -> Sections:
        assert self.sections is not None
        if self._crc is None:
            raise Refused("Not certified")
        return self.sections

    def _cert_begin(self, identity: bytes) -> None:
        self._proving().begin(identity, self._active())

    def _cert_section(self, number: int, clock: int) -> None:
        head = self._proving().start(number, self.now + signed(clock - self.now), self._active())
        for motor in self._motors:
            motor.start_proof(head)
        self.log.row(b"C", self.log_at, count=number, tick=self.now + signed(clock - self.now))
        self._watch()

    def _cert_commit(self, clock: int) -> None:
        self._proving().commit(self.now + signed(clock - self.now))
        self._watch()

    def _watch(self) -> None:
        """A promise that has passed already."""
        assert self.sections is not None
        if self.sections.expired(self.now):
            raise Refused("Promise expired")

    def _cert_rest(self) -> None:
        self._proving().commit(None)

    def _cert_finish(self, clock: int) -> None:
        self._proving().finish(self.now + signed(clock - self.now))

    def _cert_get_state(self) -> None:
        assert self.sections is not None
        state = 3 if self.stop_reason is not None else self.sections.state
        self._say("cert_state", state, self.sections.number, self.sections.last_promise & MASK, self.stopped_at)

    def _cert_get_motor(self, oid: int) -> None:
        motor = self._motor(oid)
        motor.settle(self.now)
        proof = motor.proof
        started = self.sections is not None and self.sections.number != NEVER_STARTED
        self._say("cert_motor", oid, proof.steps & MASK, motor.position & MASK, proof.crc if started else 0)

    def _cert_get_identity(self) -> None:
        assert self.sections is not None
        self._say("cert_identity", self.sections.identity)
