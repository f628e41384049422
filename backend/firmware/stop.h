/* Shutdown: everything that moves ends at once, and nothing moves again before the host clears it. */
#ifndef STOP_H
#define STOP_H

#include <stdbool.h>
#include <stdint.h>

#include "messages.h" /* STOP_...: the reasons, numbers of the dictionary's strings */

extern volatile uint8_t stopped; /* 0, or the reason */

/* The first reason counts. */
void stop(uint8_t reason);
void stop_from_interrupt(uint8_t reason) __attribute__((noinline));
/* The clock of the last stop; 0 when there was none. */
uint32_t stop_clock(void);
/* From the main loop: tells the host of a stop that it was not told of. */
void stop_task(void);

#endif
