/* Memory for objects, and what it leaves over: places for runs, shared by all motors and outputs. */
#ifndef RUNS_H
#define RUNS_H

#include <stdbool.h>
#include <stdint.h>

#include "board.h"

#define NONE ((link_t)-1)
#define BACKWARD 0x80000000UL /* in `interval`: the run counts down */

/* A run: its first step `interval` ticks after the motor's last step, which grows by `add` before each further one.
 * Of an output: `interval` is the tick of a change, `count` the new value. */
struct run {
    uint32_t interval;
    uint16_t count;
    int16_t add;
    link_t next;
};

extern struct run *runs;
extern uint16_t run_places;

/* Memory that stays taken until `arena_reset`, zeroed; NULL when there is too little. */
void *arena_take(uint16_t size);
void arena_reset(void);
bool arena_finish(void);

/* Only the main loop takes and returns places. */
link_t run_take(void);
void run_return(link_t place);
void runs_reset(void);

#endif
