/* Blocks on the line, after Klipper's public protocol page: length, sequence, payload, CRC-16, 0x7E; answers and
 * acknowledgements. */
#ifndef BLOCK_H
#define BLOCK_H

#include <stdint.h>

/* Takes at most one block from the line, executes and acknowledges it. */
void block_task(void);

/* One answer: its number, its values in the order of the dictionary, the end. */
void reply(uint8_t response);
void reply_number(uint32_t value);
void reply_byte_string(uint8_t length); /* `length` calls of reply_raw follow */
void reply_raw(uint8_t byte);
void reply_end(void);

#endif
