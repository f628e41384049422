/* Motors. A motor's runs are a list in the shared store: executed ones that the main loop has not accounted for yet, the one
 * that is executed now, and those to come. */
#ifndef STEPPER_H
#define STEPPER_H

#include <stdbool.h>
#include <stdint.h>

#include "proof.h"
#include "runs.h"
#include "schedule.h"

#define LONG_PULSE 160 /* ticks; a shorter pulse is waited for */

/* flags */
#define FORWARD 0x01 /* the direction pin says: count up */
#define TURN 0x02    /* the direction pin has to change */
#define HALTED 0x04  /* nothing is executed before reset_step_clock */
#define HIGH 0x08    /* in a long pulse, until `wake` */
#define LONG 0x10    /* pulses are long */

struct stepper {
    struct timer timer; /* first; `wake` is the tick of the next step, or of the last one when idle */
    port_t step_pin;
    uint8_t step_mask;
    volatile uint8_t flags;
    uint16_t fired; /* when the pulse began, low half of the clock; in a long pulse by how much `wake` was put off */
    uint16_t pulse; /* ticks */
    uint16_t left;  /* steps of the current run not made yet */
    uint32_t interval;
    int16_t add;
    link_t current; /* NONE when idle */
    link_t first, last;
    port_t direction_pin;
    uint8_t direction_mask;
    bool next_forward;
    int32_t position; /* after all runs accounted for */
#ifdef CERTIFIED
    struct account account;
#endif
    struct stepper *other; /* list of all */
    struct stepper *stopped_with;
};

/* The pulse begins. */
static inline __attribute__((always_inline)) void stepper_fire(struct stepper *stepper)
{
    *stepper->step_pin = stepper->step_mask; /* a one written to PINx toggles the pin */
    if (!(stepper->flags & HIGH))
        stepper->fired = TCNT1;
}

/* Works out the next step and ends the pulse; true when there is a next step. */
bool stepper_finish(struct stepper *stepper) __attribute__((noinline));

/* Interrupts off: no motor steps any more, what was executed stays known. */
void steppers_halt(void);
void stepper_halt(struct stepper *stepper);

/* Main loop: accounts for executed runs and gives their places back. */
void steppers_settle(void);

/* Main loop: steps made by the current run, after accounting for all before; 0 when idle. */
struct stepper *stepper_of(uint8_t oid);
uint16_t stepper_made(struct stepper *stepper);

/* True when no motor has anything to do. */
bool steppers_idle(void);
/* The one after, or the first after NULL; NULL at the end. */
struct stepper *stepper_next(struct stepper *after);
void steppers_reset(void);

#endif
