#include "stop.h"

#include "block.h"
#include "board.h"
#include "endstop.h"
#include "output.h"
#include "proof.h"
#include "schedule.h"
#include "stepper.h"

volatile uint8_t stopped;
static volatile uint32_t stopped_at;
static volatile bool untold;

void stop_from_interrupt(uint8_t reason)
{
    if (stopped)
        return;
    stopped = reason;
    stopped_at = clock_locked();
    untold = true;
    steppers_halt();
    outputs_halt();
    endstops_halt();
    proof_halt();
}

void stop(uint8_t reason)
{
    uint8_t before = lock();
    stop_from_interrupt(reason);
    unlock(before);
}

uint32_t stop_clock(void)
{
    return stopped_at;
}

void stop_task(void)
{
    if (!untold)
        return;
    untold = false;
    reply(RESPONSE_shutdown);
    reply_number(stopped_at);
    reply_number(stopped);
    reply_end();
}

void command_emergency_stop(uint32_t *arguments)
{
    (void)arguments;
    stop(STOP_COMMAND);
}

void command_clear_shutdown(uint32_t *arguments)
{
    (void)arguments;
    if (!stopped)
        stop(STOP_NOTHING_TO_CLEAR);
    else {
        steppers_settle();
        stopped = 0;
    }
}
