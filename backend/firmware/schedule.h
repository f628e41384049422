/* The 32-bit clock (timer 1, one count a cycle) and the list of what is due at which tick. */
#ifndef SCHEDULE_H
#define SCHEDULE_H

#include <stdbool.h>
#include <stdint.h>

#include "board.h"

#define EARLY 104 /* cycles before its tick at which a step is begun; the pin changes up to 50 cycles before it */
#define FURTHEST 0x7fff0000UL /* ticks: further ahead, "before" and "after" lose their meaning */

/* Something due at tick `wake`. `fire` runs with interrupts off; true: again at the new `wake`. NULL: a stepper. */
struct timer {
    struct timer *next;
    uint32_t wake;
    bool (*fire)(struct timer *);
};

extern volatile uint16_t clock_middle; /* bits 16 to 31 of the clock */
extern volatile uint16_t clock_top;    /* bits 32 to 47 */

void clock_start(void);
uint32_t clock_now(void);
uint32_t clock_high(uint32_t *low);

/* Interrupts must be off for these. */
uint32_t clock_locked(void);
void schedule_add(struct timer *timer);
void schedule_add_before_equals(struct timer *timer);
void schedule_remove(struct timer *timer);

void schedule_clear(void);

#endif
