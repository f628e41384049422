#include "block.h"

#include <stdbool.h>
#include <util/crc16.h>

#include "command.h"
#include "uart.h"
#include "vlq.h"

#define SHORTEST 5
#define LONGEST 64
#define END 0x7e
#define SEQUENCE 0x0f
#define TO_BOARD 0x10

static uint8_t expected = TO_BOARD; /* sequence byte of the next block */
static bool lost;    /* no block begins here: skip to the next end mark */
static bool refused; /* the host was told; once is enough until something valid comes */

static uint8_t answer[LONGEST];
static uint8_t answer_length;

static void send(uint8_t length)
{
    answer[0] = length;
    answer[1] = expected;
    uint16_t crc = 0xffff;
    tx_begin(length);
    for (uint8_t i = 0; i < length - 3; i++) {
        crc = _crc_ccitt_update(crc, answer[i]);
        tx_put(answer[i]);
    }
    tx_put(crc >> 8);
    tx_put(crc);
    tx_put(END);
    tx_send();
}

void reply(uint8_t response)
{
    answer[2] = response;
    answer_length = 3;
}

void reply_raw(uint8_t byte)
{
    if (answer_length < LONGEST - 3)
        answer[answer_length++] = byte;
}

void reply_number(uint32_t value)
{
    if (answer_length < LONGEST - 3 - VLQ_LONGEST)
        answer_length += vlq_write(answer + answer_length, value);
}

void reply_byte_string(uint8_t length)
{
    reply_raw(length);
}

void reply_end(void)
{
    send(answer_length + 3);
}

static bool crc_fits(uint8_t length)
{
    uint16_t crc = 0xffff;
    for (uint8_t i = 0; i < length - 3; i++)
        crc = _crc_ccitt_update(crc, rx_at(i));
    return rx_at(length - 3) == crc >> 8 && rx_at(length - 2) == (crc & 0xff);
}

/* Skips to behind the next end mark; the host hears once that something is missing. */
static void skip(uint8_t count)
{
    uint8_t taken = 0;
    lost = true;
    while (taken < count && lost)
        lost = rx_at(taken++) != END;
    rx_take(taken);
    if (!lost && !refused) {
        refused = true;
        send(SHORTEST);
    }
}

void block_task(void)
{
    uint8_t count = rx_count();
    if (count == 0)
        return;
    if (lost) {
        skip(count);
        return;
    }
    uint8_t length = rx_at(0);
    if (length == END) {
        rx_take(1);
        return;
    }
    if (length < SHORTEST || length > LONGEST || (count > 1 && (rx_at(1) & ~SEQUENCE) != TO_BOARD)) {
        skip(count);
        return;
    }
    if (count < length)
        return;
    if (rx_at(length - 1) != END || !crc_fits(length)) {
        skip(count);
        return;
    }
    refused = false;
    if (rx_at(1) == expected) {
        expected = ((expected + 1) & SEQUENCE) | TO_BOARD;
        execute(2, length - 3);
    }
    rx_take(length);
    send(SHORTEST); /* as acknowledgement; or, with the sequence unchanged, as the wish to hear it again */
}
