/* Commands: their table (made by dictionary.py from messages.txt) and their execution. */
#ifndef COMMAND_H
#define COMMAND_H

#include <stdint.h>

#define MOST_ARGUMENTS 8
#define WHILE_STOPPED 0x80 /* in `arguments`: executed in a shutdown too */
#define HAS_BYTES 0x40     /* the last argument is a string of bytes: its place and its length */

struct command {
    void (*execute)(uint32_t *arguments);
    uint8_t arguments; /* how many numbers, and the flags above */
};

/* Executes the commands between two places of the received bytes. */
void execute(uint8_t at, uint8_t end);

#endif
