#include "stepper.h"

#include <stddef.h>

#include "block.h"
#include "config.h"
#include "stop.h"

static struct stepper *all;

/* The next run becomes the current one; false when there is none. */
static __attribute__((noinline)) bool load(struct stepper *stepper, link_t place)
{
    stepper->current = place;
    if (place == NONE)
        return false;
    struct run *run = &runs[place];
    uint32_t interval = run->interval;
    int16_t add = run->add;
    bool forward = !(interval & BACKWARD);
    interval &= ~BACKWARD;
    stepper->left = run->count;
    stepper->timer.wake += interval;
    stepper->add = add;
    stepper->interval = interval + add;
    if (forward != (stepper->flags & FORWARD))
        stepper->flags |= TURN;
    return true;
}

static __attribute__((noinline)) bool load_next(struct stepper *stepper)
{
    return load(stepper, runs[stepper->current].next);
}

static inline __attribute__((always_inline)) void turn(struct stepper *stepper)
{
    if (stepper->flags & TURN) {
        *stepper->direction_pin = stepper->direction_mask;
        stepper->flags ^= TURN | FORWARD;
    }
}

/* Counts the step that was made, works out the next one. */
static inline __attribute__((always_inline)) bool advance(struct stepper *stepper)
{
    uint16_t left = stepper->left - 1;
    stepper->left = left;
    if (left == 0)
        return load_next(stepper);
    uint32_t interval = stepper->interval;
    stepper->timer.wake += interval;
    stepper->interval = interval + stepper->add;
    return true;
}

/* A pulse too long to wait for: `wake` is its end for a while. */
static __attribute__((noinline)) bool finish_long(struct stepper *stepper)
{
    if (!(stepper->flags & HIGH)) {
        stepper->flags |= HIGH;
        stepper->fired += stepper->pulse + EARLY - (uint16_t)stepper->timer.wake;
        stepper->timer.wake += stepper->fired;
        return true;
    }
    stepper->flags &= ~HIGH;
    stepper->timer.wake -= stepper->fired;
    if (stepper->flags & HALTED) {
        stepper->left--;
        return false;
    }
    bool more = advance(stepper);
    turn(stepper);
    return more;
}

/* The board stopped while a pulse was given. */
static __attribute__((noinline)) bool finish_halted(struct stepper *stepper)
{
    stepper->left--;
    while ((uint16_t)(TCNT1 - stepper->fired) < stepper->pulse) {
    }
    *stepper->step_pin = stepper->step_mask;
    return false;
}

bool stepper_finish(struct stepper *stepper)
{
    if (stepper->flags & (LONG | HALTED))
        return stepper->flags & LONG ? finish_long(stepper) : finish_halted(stepper);
    bool more = advance(stepper);
    uint16_t pulse = stepper->pulse, fired = stepper->fired;
    while ((uint16_t)(TCNT1 - fired) < pulse) {
    }
    *stepper->step_pin = stepper->step_mask;
    turn(stepper); /* never before the pulse is over */
    return more;
}

void stepper_halt(struct stepper *stepper)
{
    if (!(stepper->flags & HIGH))
        schedule_remove(&stepper->timer);
    stepper->flags |= HALTED;
}

void steppers_halt(void)
{
    for (struct stepper *stepper = all; stepper != NULL; stepper = stepper->other)
        stepper_halt(stepper);
}

void steppers_reset(void)
{
    all = NULL;
}

struct stepper *stepper_next(struct stepper *after)
{
    return after == NULL ? all : after->other;
}

bool steppers_idle(void)
{
    for (struct stepper *stepper = all; stepper != NULL; stepper = stepper->other) {
        uint8_t before = lock();
        bool idle = stepper->current == NONE;
        unlock(before);
        if (!idle)
            return false;
    }
    return true;
}

static void account(struct stepper *stepper, struct run *run, uint16_t made)
{
    bool forward = !(run->interval & BACKWARD);
    stepper->position += forward ? (int32_t)made : -(int32_t)made;
#ifdef CERTIFIED
    proof_made(&stepper->account, run, made);
#endif
}

/* Accounts for the runs before the current one. Interrupts may end runs meanwhile. */
static void settle_ended(struct stepper *stepper)
{
    for (;;) {
        uint8_t before = lock();
        link_t place = stepper->first;
        bool ended = place != NONE && place != stepper->current;
        unlock(before);
        if (!ended)
            return;
        struct run *run = &runs[place];
        account(stepper, run, run->count);
        before = lock();
        if (place == stepper->last) {
            stepper->first = stepper->last = NONE;
        } else {
            stepper->first = run->next;
        }
        unlock(before);
        run_return(place);
    }
}

/* After a halt: the run that was cut short, and those that never began. */
static void settle_cut(struct stepper *stepper)
{
    link_t place = stepper->first;
    if (place == NONE)
        return;
    uint16_t made = runs[place].count - stepper->left;
    if (made > 0)
        account(stepper, &runs[place], made);
    while (place != NONE) {
        link_t next = runs[place].next;
        run_return(place);
        place = next;
    }
    stepper->first = stepper->last = stepper->current = NONE;
}

static void settle(struct stepper *stepper)
{
    settle_ended(stepper);
    if ((stepper->flags & (HALTED | HIGH)) == HALTED)
        settle_cut(stepper);
}

void steppers_settle(void)
{
    for (struct stepper *stepper = all; stepper != NULL; stepper = stepper->other)
        settle(stepper);
}

uint16_t stepper_made(struct stepper *stepper)
{
    for (;;) {
        settle(stepper);
        uint8_t before = lock();
        link_t first = stepper->first, current = stepper->current;
        uint16_t left = stepper->left;
        unlock(before);
        if (first == current)
            return first == NONE ? 0 : runs[first].count - left;
    }
}

struct stepper *stepper_of(uint8_t oid)
{
    return object_of(oid, KIND_STEPPER);
}

void command_config_stepper(uint32_t *arguments)
{
    struct stepper *stepper = object_new(arguments[0], KIND_STEPPER, sizeof *stepper);
    if (stepper == NULL)
        return;
    if (arguments[4] > 0x3000) {
        stop(STOP_PULSE);
        return;
    }
    if (!output_pin(arguments[1], arguments[3] & 1) || !output_pin(arguments[2], false))
        return;
    stepper->step_pin = pin_port(arguments[1]);
    stepper->step_mask = pin_mask(arguments[1]);
    stepper->direction_pin = pin_port(arguments[2]);
    stepper->direction_mask = pin_mask(arguments[2]);
    stepper->pulse = arguments[4];
    stepper->first = stepper->last = stepper->current = NONE;
    stepper->flags = HALTED | (stepper->pulse > LONG_PULSE ? LONG : 0); /* halted until the clock was set */
#ifdef CERTIFIED
    stepper->account.crc = 0xffffffff; /* of nothing */
#endif
    stepper->other = all;
    all = stepper;
}

void command_set_next_step_dir(uint32_t *arguments)
{
    struct stepper *stepper = stepper_of(arguments[0]);
    if (stepper != NULL)
        stepper->next_forward = arguments[1] & 1;
}

void command_reset_step_clock(uint32_t *arguments)
{
    struct stepper *stepper = stepper_of(arguments[0]);
    if (stepper == NULL)
        return;
    settle(stepper);
    uint8_t before = lock();
    bool idle = stepper->current == NONE;
    if (idle) {
#ifdef CERTIFIED
        proof_base(&stepper->account, arguments[1]);
#endif
        stepper->timer.wake = arguments[1];
        stepper->flags &= ~HALTED;
    }
    unlock(before);
    if (!idle)
        stop(STOP_ACTIVE);
}

/* Interrupts off: the first run after a rest. */
static void begin(struct stepper *stepper, link_t place)
{
    load(stepper, place);
    uint32_t ahead = stepper->timer.wake - clock_locked();
    if (ahead > FURTHEST) {
        stop_from_interrupt(STOP_TOO_CLOSE);
        return;
    }
    turn(stepper);
    schedule_add(&stepper->timer);
}

void command_queue_step(uint32_t *arguments)
{
    struct stepper *stepper = stepper_of(arguments[0]);
    if (stepper == NULL)
        return;
    if ((uint16_t)arguments[2] == 0) {
        stop(STOP_COUNT);
        return;
    }
    if (arguments[1] > FURTHEST) {
        stop(STOP_TOO_CLOSE);
        return;
    }
    if (!proof_allows() || (stepper->flags & HALTED))
        return;
    link_t place = place_take();
    if (place == NONE)
        return;
    struct run *run = &runs[place];
    run->interval = arguments[1] | (stepper->next_forward ? 0 : BACKWARD);
    run->count = arguments[2];
    run->add = arguments[3];
    run->next = NONE;
    uint8_t before = lock();
    if (stepper->first == NONE)
        stepper->first = place;
    else
        runs[stepper->last].next = place;
    stepper->last = place;
    if (stepper->current == NONE)
        begin(stepper, place);
    unlock(before);
}

void command_stepper_get_position(uint32_t *arguments)
{
    struct stepper *stepper = stepper_of(arguments[0]);
    if (stepper == NULL)
        return;
    uint16_t made = stepper_made(stepper);
    int32_t position = stepper->position;
    if (made > 0)
        position += runs[stepper->first].interval & BACKWARD ? -(int32_t)made : (int32_t)made;
    reply(RESPONSE_stepper_position);
    reply_number(arguments[0]);
    reply_number(position);
    reply_end();
}
