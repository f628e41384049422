/* The reference firmware: Klipper's public micro-controller protocol, and what a certified run needs beyond it (proof.h). */
#include <avr/interrupt.h>
#include <avr/wdt.h>

#include "block.h"
#include "endstop.h"
#include "output.h"
#include "proof.h"
#include "runs.h"
#include "schedule.h"
#include "stepper.h"
#include "stop.h"
#include "uart.h"

int main(void)
{
    MCUSR = 0; /* or a watchdog that fired goes on */
    wdt_disable();
    arena_reset();
    uart_start();
    clock_start();
    sei();
    reply(RESPONSE_starting);
    reply_end();
    for (;;) {
        block_task();
        stop_task();
        endstops_task();
        steppers_settle();
        outputs_settle();
        proof_task();
    }
}
