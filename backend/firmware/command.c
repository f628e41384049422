#include "command.h"

#include <avr/pgmspace.h>

#include "block.h"
#include "messages.h"
#include "stop.h"
#include "uart.h"
#include "vlq.h"

static bool read_arguments(uint8_t *at, uint8_t end, uint8_t shape, uint32_t *to)
{
    for (uint8_t left = shape & 0x0f; left > 0; left--)
        if (!vlq_read(at, end, to++))
            return false;
    if (shape & HAS_BYTES) {
        if (*at >= end)
            return false;
        uint8_t length = rx_at((*at)++);
        if (length > end - *at)
            return false;
        *to++ = *at;
        *to = length;
        *at += length;
    }
    return true;
}

void execute(uint8_t at, uint8_t end)
{
    uint32_t arguments[MOST_ARGUMENTS];
    while (at < end) {
        uint32_t number;
        if (!vlq_read(&at, end, &number)) {
            stop(STOP_PARSER);
            return;
        }
        if (number >= COMMANDS) {
            stop(STOP_COMMAND_UNKNOWN);
            return;
        }
        uint8_t shape = pgm_read_byte(&commands[number].arguments);
        void (*run)(uint32_t *) = (void (*)(uint32_t *))pgm_read_word(&commands[number].execute);
        if (run == 0) { /* the number of a response */
            stop(STOP_COMMAND_UNKNOWN);
            return;
        }
        if (!read_arguments(&at, end, shape, arguments)) {
            stop(STOP_PARSER);
            return;
        }
        if (stopped && !(shape & WHILE_STOPPED)) {
            reply(RESPONSE_is_shutdown);
            reply_number(stopped);
            reply_end();
            continue;
        }
        run(arguments);
    }
}
