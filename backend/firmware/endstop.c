/* Homing and probing in the board. A trsync is a group of motors that stops on one cause: an endstop's edge, a clock that ran
 * out, the host's word. Names and order of the messages are Klipper's. */
#include "endstop.h"

#include <stddef.h>

#include "block.h"
#include "config.h"
#include "schedule.h"
#include "stepper.h"
#include "stop.h"

struct trsync {
    struct timer report; /* first */
    struct timer expiry;
    uint32_t period; /* ticks between reports; 0: none */
    uint32_t at;     /* tick of the cause */
    uint8_t oid;
    uint8_t reason, expiry_reason;
    volatile bool armed;
    volatile bool report_due;
    struct stepper *group;
    struct trsync *other;
};

struct endstop {
    struct timer timer; /* first; `wake` is the tick of the next sample */
    port_t pin;
    uint8_t mask;
    uint8_t wanted;  /* the pin's level, as `mask` or 0 */
    uint8_t samples; /* that many in a row */
    uint8_t missing;
    uint8_t reason;
    bool homing;
    uint32_t between; /* ticks between samples once the level was seen */
    uint32_t rest;    /* ticks until the next look */
    uint32_t next_look; /* after a trigger: `rest` after the first sample that saw the level */
    struct trsync *trsync;
    struct endstop *other;
};

static struct trsync *all_trsyncs;
static struct endstop *all_endstops;

/* Interrupts off. */
static void trigger(struct trsync *trsync, uint8_t reason)
{
    if (!trsync->armed)
        return;
    trsync->armed = false;
    trsync->reason = reason;
    trsync->at = clock_locked();
    for (struct stepper *stepper = trsync->group; stepper != NULL; stepper = stepper->stopped_with)
        stepper_halt(stepper);
    schedule_remove(&trsync->report);
    schedule_remove(&trsync->expiry);
    trsync->report_due = true;
}

static bool report(struct timer *timer)
{
    struct trsync *trsync = (struct trsync *)timer;
    trsync->report_due = true;
    timer->wake += trsync->period;
    return true;
}

static bool expire(struct timer *timer)
{
    struct trsync *trsync = (struct trsync *)((uint8_t *)timer - offsetof(struct trsync, expiry));
    trigger(trsync, trsync->expiry_reason);
    return false;
}

static bool sample(struct timer *timer)
{
    struct endstop *endstop = (struct endstop *)timer;
    if ((*endstop->pin & endstop->mask) != endstop->wanted) {
        if (endstop->missing != endstop->samples) {
            endstop->missing = endstop->samples;
            timer->wake = endstop->next_look;
            /* it may have passed while samples were taken */
            uint32_t now = clock_locked();
            if ((int32_t)(timer->wake - now) < 0)
                timer->wake = now + endstop->rest;
        } else {
            timer->wake += endstop->rest;
        }
        return true;
    }
    if (endstop->missing == endstop->samples)
        endstop->next_look = timer->wake + endstop->rest;
    if (--endstop->missing == 0) {
        endstop->homing = false;
        trigger(endstop->trsync, endstop->reason);
        return false;
    }
    timer->wake += endstop->between;
    return true;
}

void endstops_halt(void)
{
    for (struct endstop *endstop = all_endstops; endstop != NULL; endstop = endstop->other) {
        schedule_remove(&endstop->timer);
        endstop->homing = false;
    }
    for (struct trsync *trsync = all_trsyncs; trsync != NULL; trsync = trsync->other) {
        schedule_remove(&trsync->report);
        schedule_remove(&trsync->expiry);
        trsync->armed = trsync->report_due = false;
    }
}

void endstops_reset(void)
{
    all_endstops = NULL;
    all_trsyncs = NULL;
}

static void tell(struct trsync *trsync)
{
    uint8_t before = lock();
    bool armed = trsync->armed;
    uint8_t reason = trsync->reason;
    uint32_t at = armed ? clock_locked() : trsync->at;
    trsync->report_due = false;
    unlock(before);
    reply(RESPONSE_trsync_state);
    reply_number(trsync->oid);
    reply_number(armed);
    reply_number(reason);
    reply_number(at);
    reply_end();
}

void endstops_task(void)
{
    for (struct trsync *trsync = all_trsyncs; trsync != NULL; trsync = trsync->other)
        if (trsync->report_due)
            tell(trsync);
}

void command_config_endstop(uint32_t *arguments)
{
    struct endstop *endstop = object_new(arguments[0], KIND_ENDSTOP, sizeof *endstop);
    if (endstop == NULL)
        return;
    if (!pin_claim(arguments[1])) {
        stop(STOP_PIN);
        return;
    }
    pin_listen(arguments[1], arguments[2] & 1);
    endstop->pin = pin_port(arguments[1]);
    endstop->mask = pin_mask(arguments[1]);
    endstop->timer.fire = sample;
    endstop->other = all_endstops;
    all_endstops = endstop;
}

void command_endstop_home(uint32_t *arguments)
{
    struct endstop *endstop = object_of(arguments[0], KIND_ENDSTOP);
    if (endstop == NULL)
        return;
    uint8_t before = lock();
    schedule_remove(&endstop->timer);
    endstop->homing = false;
    unlock(before);
    if (arguments[3] == 0) /* no samples: homing is over */
        return;
    struct trsync *trsync = object_of(arguments[6], KIND_TRSYNC);
    if (trsync == NULL)
        return;
    endstop->between = arguments[2];
    endstop->samples = endstop->missing = arguments[3];
    endstop->rest = arguments[4];
    endstop->wanted = arguments[5] & 1 ? endstop->mask : 0;
    endstop->trsync = trsync;
    endstop->reason = arguments[7];
    before = lock();
    endstop->timer.wake = arguments[1];
    if (arguments[1] - clock_locked() > FURTHEST) {
        stop_from_interrupt(STOP_TOO_CLOSE);
    } else {
        endstop->homing = true;
        schedule_add(&endstop->timer);
    }
    unlock(before);
}

void command_endstop_query_state(uint32_t *arguments)
{
    struct endstop *endstop = object_of(arguments[0], KIND_ENDSTOP);
    if (endstop == NULL)
        return;
    uint8_t before = lock();
    bool homing = endstop->homing;
    uint32_t next_look = homing ? endstop->timer.wake : endstop->next_look;
    unlock(before);
    reply(RESPONSE_endstop_state);
    reply_number(arguments[0]);
    reply_number(homing);
    reply_number(next_look);
    reply_number((*endstop->pin & endstop->mask) != 0);
    reply_end();
}

void command_config_trsync(uint32_t *arguments)
{
    struct trsync *trsync = object_new(arguments[0], KIND_TRSYNC, sizeof *trsync);
    if (trsync == NULL)
        return;
    trsync->oid = arguments[0];
    trsync->report.fire = report;
    trsync->expiry.fire = expire;
    trsync->other = all_trsyncs;
    all_trsyncs = trsync;
}

void command_trsync_start(uint32_t *arguments)
{
    struct trsync *trsync = object_of(arguments[0], KIND_TRSYNC);
    if (trsync == NULL)
        return;
    uint8_t before = lock();
    schedule_remove(&trsync->report);
    schedule_remove(&trsync->expiry);
    trsync->group = NULL;
    trsync->reason = 0;
    trsync->expiry_reason = arguments[3];
    trsync->period = arguments[2];
    trsync->report_due = false;
    trsync->armed = true;
    trsync->report.wake = arguments[1];
    if (arguments[2] != 0) {
        if (arguments[1] - clock_locked() > FURTHEST)
            stop_from_interrupt(STOP_TOO_CLOSE);
        else
            schedule_add(&trsync->report);
    }
    unlock(before);
}

void command_trsync_set_timeout(uint32_t *arguments)
{
    struct trsync *trsync = object_of(arguments[0], KIND_TRSYNC);
    if (trsync == NULL)
        return;
    uint8_t before = lock();
    schedule_remove(&trsync->expiry);
    if (trsync->armed) {
        trsync->expiry.wake = arguments[1];
        if (arguments[1] - clock_locked() > FURTHEST)
            stop_from_interrupt(STOP_TOO_CLOSE);
        else
            schedule_add(&trsync->expiry);
    }
    unlock(before);
}

void command_trsync_trigger(uint32_t *arguments)
{
    struct trsync *trsync = object_of(arguments[0], KIND_TRSYNC);
    if (trsync == NULL)
        return;
    uint8_t before = lock();
    trigger(trsync, arguments[1]);
    unlock(before);
    tell(trsync);
}

void command_stepper_stop_on_trigger(uint32_t *arguments)
{
    struct stepper *stepper = stepper_of(arguments[0]);
    struct trsync *trsync = object_of(arguments[1], KIND_TRSYNC);
    if (stepper == NULL || trsync == NULL)
        return;
    uint8_t before = lock();
    if (trsync->armed) {
        struct stepper *other = trsync->group;
        while (other != NULL && other != stepper)
            other = other->stopped_with;
        if (other == NULL) {
            stepper->stopped_with = trsync->group;
            trsync->group = stepper;
        }
    } else {
        stepper_halt(stepper); /* the cause came before this message */
    }
    unlock(before);
}
