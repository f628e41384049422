#include "output.h"

#include <stddef.h>

#include "config.h"
#include "schedule.h"
#include "stop.h"

struct output {
    struct timer timer; /* first; `wake` is the tick of the next change, or the latest when one is missing */
    port_t pin;
    uint8_t mask;
    bool value, at_rest;
    uint32_t longest; /* ticks away from `at_rest` without news; 0: any time */
    link_t first, current, last;
    struct output *other;
};

static struct output *all;

static void write(struct output *output, bool high)
{
    if (high)
        output->pin[2] |= output->mask;
    else
        output->pin[2] &= ~output->mask;
    output->value = high;
}

/* True when the output has to hear of a next change in time. */
static bool guard(struct output *output)
{
    if (output->longest == 0 || output->value == output->at_rest)
        return false;
    output->timer.wake += output->longest;
    return true;
}

static bool fire(struct timer *timer)
{
    struct output *output = (struct output *)timer;
    if (output->current == NONE) {
        stop_from_interrupt(STOP_MISSED);
        return false;
    }
    struct run *run = &runs[output->current];
    write(output, run->count);
    output->current = run->next;
    if (output->current == NONE)
        return guard(output);
    timer->wake = runs[output->current].interval;
    return true;
}

void outputs_halt(void)
{
    for (struct output *output = all; output != NULL; output = output->other) {
        schedule_remove(&output->timer);
        output->current = NONE;
        write(output, output->at_rest);
    }
}

void outputs_reset(void)
{
    all = NULL;
}

void outputs_settle(void)
{
    for (struct output *output = all; output != NULL; output = output->other)
        for (;;) {
            uint8_t before = lock();
            link_t place = output->first;
            bool ended = place != NONE && place != output->current;
            if (ended) {
                if (place == output->last)
                    output->first = output->last = NONE;
                else
                    output->first = runs[place].next;
            }
            unlock(before);
            if (!ended)
                break;
            run_return(place);
        }
}

void command_config_digital_out(uint32_t *arguments)
{
    struct output *output = object_new(arguments[0], KIND_OUTPUT, sizeof *output);
    if (output == NULL || !output_pin(arguments[1], arguments[2] & 1))
        return;
    output->timer.fire = fire;
    output->pin = pin_port(arguments[1]);
    output->mask = pin_mask(arguments[1]);
    output->value = arguments[2] & 1;
    output->at_rest = arguments[3] & 1;
    output->longest = arguments[4];
    output->first = output->current = output->last = NONE;
    output->other = all;
    all = output;
}

void command_queue_digital_out(uint32_t *arguments)
{
    struct output *output = object_of(arguments[0], KIND_OUTPUT);
    if (output == NULL)
        return;
    link_t place = place_take();
    if (place == NONE)
        return;
    runs[place].interval = arguments[1];
    runs[place].count = arguments[2] != 0;
    runs[place].next = NONE;
    uint8_t before = lock();
    if (arguments[1] - clock_locked() > FURTHEST)
        stop_from_interrupt(STOP_TOO_CLOSE);
    if (output->first == NONE)
        output->first = place;
    else
        runs[output->last].next = place;
    output->last = place;
    if (output->current == NONE && !stopped) {
        output->current = place;
        schedule_remove(&output->timer);
        output->timer.wake = arguments[1];
        schedule_add(&output->timer);
    }
    unlock(before);
}

void command_update_digital_out(uint32_t *arguments)
{
    struct output *output = object_of(arguments[0], KIND_OUTPUT);
    if (output == NULL)
        return;
    uint8_t before = lock();
    schedule_remove(&output->timer);
    output->current = NONE;
    write(output, arguments[1] & 1);
    output->timer.wake = clock_locked();
    if (guard(output))
        schedule_add(&output->timer);
    unlock(before);
    outputs_settle();
}

void command_set_digital_out(uint32_t *arguments)
{
    output_pin(arguments[0], arguments[1] & 1);
}
